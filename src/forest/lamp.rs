//! Lights made ready: from where a surface's point is lit, how strongly, and how far away.

use glam::DVec3;

use super::sampling::on_disc;
use crate::scene::{Area, Light, LightPlace};

/// What 1/d² is at most: nearer than 10⁻⁹ units a light that falls off does not grow any more, so
/// that no sum of coefficients is infinite.
const MOST_NEAR: f64 = 1e18;

/// A light, its directions of length 1.
#[derive(Clone, Debug)]
pub(super) struct Lamp {
    source: Source,
    /// Rays to it from every point, and 1 over their number.
    pub(super) rays: u32,
    share: f64,
    falls_off: bool,
}

#[derive(Clone, Debug)]
enum Source {
    Point(DVec3),
    /// Towards the light.
    Direction(DVec3),
    Spot {
        at: DVec3,
        axis: DVec3,
        cone: Cone,
    },
    Area(Surface),
}

/// Where the points of a light with an area lie.
#[derive(Clone, Debug)]
enum Surface {
    /// The corner from which two edges leave, and the unit vector that stands on it.
    Rectangle {
        corner: DVec3,
        edges: [DVec3; 2],
        normal: DVec3,
    },
    /// Middle, two radii at right angles, and the unit vector that stands on it.
    Disc {
        center: DVec3,
        radii: [DVec3; 2],
        normal: DVec3,
    },
    Sphere {
        center: DVec3,
        radius: f64,
    },
}

/// Cosines of a spot's cone and of the one within which it does not fade.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Cone {
    outer: f64,
    inner: f64,
}

/// A light as seen from a point.
pub(super) enum Aim<'a> {
    /// One ray goes to it.
    Sharp(Beam),
    /// Its rays go to points that are drawn.
    Spread(Spread<'a>),
}

/// A light with an area as seen from a point: what its rays have in common.
pub(super) struct Spread<'a> {
    lamp: &'a Lamp,
    /// From the point to the light's middle, or, for a rectangle, its corner.
    arm: DVec3,
    /// Two edges, or two radii.
    across: [DVec3; 2],
    round: bool,
    /// What one ray weighs, without falloff.
    weight: f64,
    /// Unit, stands on its points.
    normal: DVec3,
}

/// One of the points of a light, as seen from a point of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Beam {
    /// Of length 1, or zero where the two points are one.
    pub(super) to_light: DVec3,
    /// World units; infinite for a direction.
    pub(super) distance: f64,
    /// Part of the light that arrives by it, apart from N·L: 0 outside of a cone.
    pub(super) weight: f32,
}

impl Lamp {
    pub(super) fn new(light: &Light) -> Lamp {
        let source = match &light.place {
            LightPlace::Point(point) => Source::Point(*point),
            LightPlace::Direction(along) => Source::Direction(-along.normalize()),
            LightPlace::Spot { at, towards, angle_degrees, edge } => Source::Spot {
                at: *at,
                axis: (*towards - *at).normalize(),
                cone: Cone::new(*angle_degrees, *edge),
            },
            LightPlace::Area(area) => Source::Area(Surface::new(area)),
        };
        let rays = light.rays();
        Lamp { source, rays, share: 1.0 / f64::from(rays), falls_off: light.falls_off() }
    }

    /// The light as seen from a point.
    #[inline(always)]
    pub(super) fn aim(&self, from: DVec3) -> Aim<'_> {
        match &self.source {
            Source::Point(point) => Aim::Sharp(self.beam(*point - from, self.share)),
            Source::Direction(to_light) => Aim::Sharp(Beam {
                to_light: *to_light,
                distance: f64::INFINITY,
                weight: self.share as f32,
            }),
            Source::Spot { at, axis, cone } => {
                let arm = *at - from;
                let weight = cone.weight(-arm.normalize_or_zero().dot(*axis));
                Aim::Sharp(self.beam(arm, weight))
            }
            Source::Area(surface) => Aim::Spread(self.spread(surface, from)),
        }
    }

    /// A ray to where `arm` points to, `weight` being its part of the light without falloff.
    #[inline(always)]
    fn beam(&self, arm: DVec3, weight: f64) -> Beam {
        let weight = match self.falls_off {
            false => weight,
            true => weight * (1.0 / arm.length_squared()).min(MOST_NEAR),
        };
        Beam { to_light: arm.normalize_or_zero(), distance: arm.length(), weight: weight as f32 }
    }

    /// Out of line, so that it is not made ready for lights that have no area.
    #[inline(never)]
    fn spread(&self, surface: &Surface, from: DVec3) -> Spread<'_> {
        let flat = |arm, across, round, normal| Spread {
            lamp: self,
            arm,
            across,
            round,
            weight: self.share,
            normal,
        };
        match surface {
            Surface::Rectangle { corner, edges, normal } => {
                flat(*corner - from, *edges, false, *normal)
            }
            Surface::Disc { center, radii, normal } => flat(*center - from, *radii, true, *normal),
            Surface::Sphere { center, radius } => self.spread_of_ball(*center - from, *radius),
        }
    }

    /// A ball as seen from a point: the disc that its tangents from there touch hides exactly as
    /// much as it does. From within it is the disc through its middle.
    fn spread_of_ball(&self, arm: DVec3, radius: f64) -> Spread<'_> {
        let normal = arm.normalize_or(DVec3::Z);
        let nearer = radius * radius / arm.length_squared();
        let (nearer, part) = if nearer < 1.0 { (nearer, 1.0 - nearer) } else { (0.0, 1.0) };
        Spread {
            lamp: self,
            arm: arm - arm * nearer,
            across: radii(normal, radius * part.sqrt()),
            round: true,
            weight: if self.falls_off { self.share * part } else { self.share },
            normal,
        }
    }
}

impl Spread<'_> {
    /// The ray to the point of the light with these numbers in [0, 1).
    #[inline(always)]
    pub(super) fn beam(&self, numbers: [f64; 2]) -> Beam {
        let [x, y] = if self.round { on_disc(numbers) } else { numbers };
        let [u, v] = self.across;
        let arm = self.arm + u * x + v * y;
        let weight = match self.lamp.falls_off {
            false => self.weight,
            true => self.weight * self.normal.dot(arm.normalize_or_zero()).abs(),
        };
        self.lamp.beam(arm, weight)
    }
}

impl Surface {
    fn new(area: &Area) -> Surface {
        match area {
            Area::Rectangle { center, along, across } => Surface::Rectangle {
                corner: *center - (*along + *across) / 2.0,
                edges: [*along, *across],
                normal: along.normalize().cross(across.normalize()).normalize_or_zero(),
            },
            Area::Disc { center, normal, radius } => {
                let normal = normal.normalize();
                Surface::Disc { center: *center, radii: radii(normal, *radius), normal }
            }
            Area::Sphere { center, radius } => Surface::Sphere { center: *center, radius: *radius },
        }
    }
}

impl Cone {
    fn new(angle_degrees: f64, edge: f64) -> Cone {
        let cosine = |degrees: f64| libm::cos(degrees.to_radians());
        Cone { outer: cosine(angle_degrees), inner: cosine(angle_degrees * (1.0 - edge)) }
    }

    /// 1 within, 0 without, and in between the cubic that is level at both ends, over the cosine.
    #[inline(always)]
    fn weight(self, cosine: f64) -> f64 {
        let Cone { outer, inner } = self;
        if cosine >= inner {
            return 1.0;
        }
        if cosine <= outer {
            return 0.0;
        }
        let t = (cosine - outer) / (inner - outer);
        t * t * (3.0 - 2.0 * t)
    }
}

/// Two radii at right angles of a disc on which the unit vector `normal` stands.
#[inline(always)]
fn radii(normal: DVec3, radius: f64) -> [DVec3; 2] {
    let (u, v) = normal.any_orthonormal_pair();
    [u * radius, v * radius]
}

#[cfg(test)]
mod tests {
    use super::*;

    const FROM: DVec3 = DVec3::new(0.5, -1.0, 0.25);

    fn lamp(place: LightPlace) -> Lamp {
        Lamp::new(&Light { place, samples: 4, ..Light::new("l") })
    }

    fn beams(lamp: &Lamp, from: DVec3) -> Vec<Beam> {
        let numbers = [0.0, 0.25, 0.5, 0.999].into_iter();
        let pairs = numbers.clone().flat_map(|u| numbers.clone().map(move |v| [u, v]));
        match lamp.aim(from) {
            Aim::Sharp(beam) => vec![beam],
            Aim::Spread(spread) => pairs.map(|pair| spread.beam(pair)).collect(),
        }
    }

    #[test]
    fn points_and_directions_weigh_one_whatever_is_drawn() {
        let point = DVec3::new(3.0, 2.0, 9.0);
        for beam in beams(&lamp(LightPlace::Point(point)), FROM) {
            let expected = Beam {
                to_light: (point - FROM).normalize_or_zero(),
                distance: (point - FROM).length(),
                weight: 1.0,
            };
            assert_eq!(beam, expected);
        }
        let along = DVec3::new(0.0, 0.0, -3.0);
        for beam in beams(&lamp(LightPlace::Direction(along)), FROM) {
            let expected = Beam { to_light: DVec3::Z, distance: f64::INFINITY, weight: 1.0 };
            assert_eq!(beam, expected);
        }
    }

    #[test]
    fn points_of_an_area_lie_on_it_and_share_its_light() {
        let center = DVec3::new(1.0, 2.0, 3.0);
        let (along, across) = (DVec3::new(2.0, 0.0, 1.0), DVec3::new(0.0, 0.5, 0.0));
        let normal = DVec3::new(1.0, 1.0, 4.0);
        for area in [
            Area::Rectangle { center, along, across },
            Area::Disc { center, normal, radius: 0.7 },
            Area::Sphere { center, radius: 0.7 },
        ] {
            let lamp = lamp(LightPlace::Area(area.clone()));
            assert!(matches!(lamp.aim(FROM), Aim::Spread(_)) && lamp.rays == 4);
            let mut farthest = 0.0f64;
            for Beam { to_light, distance, weight } in beams(&lamp, FROM) {
                let offset = FROM + to_light * distance - center;
                farthest = farthest.max(offset.length());
                assert_eq!(weight, 0.25);
                match area {
                    Area::Rectangle { .. } => {
                        let flat = along.cross(across).normalize();
                        assert!(offset.dot(flat).abs() < 1e-14);
                        let share = offset.dot(across) / across.length_squared();
                        assert!(share.abs() <= 0.5 + 1e-12);
                    }
                    Area::Disc { .. } => assert!(offset.dot(normal).abs() < 1e-14),
                    // On the circle of the tangents at most.
                    Area::Sphere { .. } => {
                        let arm = center - FROM;
                        let nearer = -offset.dot(arm.normalize());
                        assert!((nearer - 0.49 / arm.length()).abs() < 1e-14);
                    }
                }
            }
            let reach = match area {
                Area::Rectangle { .. } => (along + across).length() / 2.0,
                _ => 0.7,
            };
            assert!((farthest - reach).abs() < 1e-12, "{area:?}: {farthest}");
        }
    }

    #[test]
    fn a_light_where_the_point_is_gives_no_nan() {
        for kind in LightPlace::KINDS.into_iter().filter(|kind| *kind != "direction") {
            let place = LightPlace::of_kind(kind).anchored_at(FROM);
            let lamp = Lamp::new(&Light { place, falloff: 2.0, samples: 4, ..Light::new("l") });
            for Beam { to_light, distance, weight } in beams(&lamp, FROM) {
                assert!(to_light.is_finite() && distance.is_finite() && weight.is_finite());
            }
        }
    }

    #[test]
    fn light_falls_off_with_the_square_of_the_distance() {
        let point = Light { falloff: 3.0, ..Light::new("l") };
        let weight = |d: f64| beams(&Lamp::new(&point), DVec3::X * d)[0].weight;
        assert_eq!([weight(1.0), weight(2.0), weight(10.0)], [1.0, 0.25, 0.01]);
        assert_eq!(weight(1e-30), 1e18);
    }

    #[test]
    fn a_panel_that_falls_off_is_as_bright_as_it_looks_wide() {
        let area = Area::Disc { center: DVec3::ZERO, normal: DVec3::NEG_Z * 3.0, radius: 1e-9 };
        let panel = Light { place: LightPlace::Area(area), falloff: 1.0, ..Light::new("l") };
        let weight = |light: &Light, degrees: f64| {
            let (sin, cos) = degrees.to_radians().sin_cos();
            beams(&Lamp::new(light), DVec3::new(sin, 0.0, -cos) * 2.0)[0].weight
        };
        for (degrees, expected) in [(0.0, 0.25), (60.0, 0.125), (120.0, 0.125), (180.0, 0.25)] {
            assert!((weight(&panel, degrees) - expected).abs() < 1e-6, "{degrees}°");
        }
        assert!(weight(&panel, 90.0) < 1e-9);
        let even = Light { falloff: 0.0, ..panel };
        assert_eq!([weight(&even, 0.0), weight(&even, 75.0)], [1.0; 2]);
    }

    #[test]
    fn a_spot_fades_from_its_inner_cone_to_its_outer_one() {
        let spot = |edge: f64| LightPlace::Spot {
            at: DVec3::ZERO,
            towards: DVec3::NEG_Z * 7.0,
            angle_degrees: 60.0,
            edge,
        };
        let weight = |edge: f64, degrees: f64| {
            let (sin, cos) = degrees.to_radians().sin_cos();
            beams(&lamp(spot(edge)), DVec3::new(sin, 0.0, -cos))[0].weight
        };
        for edge in [0.0, 0.5, 1.0] {
            assert_eq!([weight(edge, 0.0), weight(edge, 60.5), weight(edge, 170.0)], [1., 0., 0.]);
            let sweep: Vec<f32> = (0..61).map(|d| weight(edge, f64::from(d))).collect();
            assert!(sweep.is_sorted_by(|a, b| a >= b), "{sweep:?}");
        }
        assert_eq!([weight(0.0, 59.5), weight(0.5, 29.5)], [1.0, 1.0]);
        // Half-way between the cosines of 30° and 60°.
        let half = ((30f64.to_radians().cos() + 0.5) / 2.0).acos().to_degrees();
        assert!((weight(0.5, half) - 0.5).abs() < 1e-6);
        let all = LightPlace::Spot {
            at: DVec3::ZERO,
            towards: DVec3::NEG_Z,
            angle_degrees: 180.0,
            edge: 0.0,
        };
        assert_eq!(beams(&lamp(all), DVec3::new(0.1, 0.0, 1.0))[0].weight, 1.0);
    }
}
