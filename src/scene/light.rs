//! What shines: where a light is, how large it is, and how it weakens with distance.

use glam::DVec3;

use crate::color::Rgb;

/// `[lights.NAME]`. A light that is off is traced all the same.
///
/// A surface shows `diffuse · color · intensity · N·L` of every point that shines, and the mean over
/// the points of a light with an area. One with an area that falls off has the same radiance
/// everywhere and in every direction: a point of it counts cos θ · D²/d², θ between the arm and what
/// stands on the light, so that an area A shows as `diffuse · color · L · F` does, L = π·D²/A times
/// the intensity and F the form factor of what is seen of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Light {
    /// Unique among the lights.
    pub name: String,
    /// Tint of the light.
    pub color: Rgb,
    /// Strength: a surface facing the light shows `diffuse · color · intensity`.
    pub intensity: Rgb,
    /// Whether it shines.
    pub on: bool,
    /// The distance D at which it has its intensity, in world units: elsewhere (D/d)² of it. 0: the
    /// same at every distance, as a direction always is.
    pub falloff: f64,
    /// Shadow rays from every point seen to a light with an area, 1 … [`MOST_LIGHT_SAMPLES`]; to all
    /// others there is one.
    pub samples: u32,
    /// Where it is.
    pub place: LightPlace,
}

/// Largest number of shadow rays from a point to one light.
pub const MOST_LIGHT_SAMPLES: u32 = 1024;
/// Largest number of shadow rays from a point to all lights together, and of a pixel's camera rays
/// times the rays of a light.
pub const MOST_LIGHT_RAYS: u64 = 65_535;

/// Where a light is.
#[derive(Clone, Debug, PartialEq)]
pub enum LightPlace {
    /// At a point of the world (`point`).
    Point(DVec3),
    /// Infinitely far away, *shining along* this direction (`direction`); not zero.
    Direction(DVec3),
    /// At a point, into a cone (`spot`).
    Spot {
        /// The point.
        at: DVec3,
        /// A point on the cone's axis, not `at`.
        towards: DVec3,
        /// Between the axis and the cone, in (0, 180] degrees.
        angle_degrees: f64,
        /// The outer part of the angle in which the light fades, 0 … 1: 0 for a sharp edge.
        edge: f64,
    },
    /// All over a surface (`area`), to both of its sides; nobody sees the surface itself.
    Area(Area),
}

/// The surface of a light.
#[derive(Clone, Debug, PartialEq)]
pub enum Area {
    /// A parallelogram (`rectangle`).
    Rectangle {
        /// Its middle.
        center: DVec3,
        /// One of its edges, from corner to corner.
        along: DVec3,
        /// The other one.
        across: DVec3,
    },
    /// A flat disc (`disc`).
    Disc {
        /// Its middle.
        center: DVec3,
        /// Stands on it; of any length, not zero.
        normal: DVec3,
        /// World units, > 0.
        radius: f64,
    },
    /// A ball (`sphere`): for every point that it lights, the disc in its outline.
    Sphere {
        /// Its middle.
        center: DVec3,
        /// World units, > 0.
        radius: f64,
    },
}

impl Light {
    /// A white point light at the origin.
    pub fn new(name: impl Into<String>) -> Light {
        Light {
            name: name.into(),
            color: Rgb::WHITE,
            intensity: Rgb::WHITE,
            on: true,
            falloff: 0.0,
            samples: 1,
            place: LightPlace::Point(DVec3::ZERO),
        }
    }

    /// Shadow rays from every point to it: 1 unless it has an area.
    pub fn rays(&self) -> u32 {
        if self.place.is_spread() { self.samples } else { 1 }
    }

    /// Whether it weakens with distance.
    pub fn falls_off(&self) -> bool {
        self.falloff > 0.0 && !matches!(self.place, LightPlace::Direction(_))
    }
}

impl LightPlace {
    /// What a person chooses from, in this order.
    pub const KINDS: [&str; 6] = ["point", "direction", "spot", "rectangle", "disc", "sphere"];

    /// Which of [`LightPlace::KINDS`] it is.
    pub fn kind(&self) -> &'static str {
        match self {
            LightPlace::Point(_) => "point",
            LightPlace::Direction(_) => "direction",
            LightPlace::Spot { .. } => "spot",
            LightPlace::Area(Area::Rectangle { .. }) => "rectangle",
            LightPlace::Area(Area::Disc { .. }) => "disc",
            LightPlace::Area(Area::Sphere { .. }) => "sphere",
        }
    }

    /// A place of this kind, of unit size; a point for any other word.
    pub fn of_kind(kind: &str) -> LightPlace {
        match kind {
            "rectangle" | "disc" | "sphere" => LightPlace::Area(Area::named(kind)),
            key => LightPlace::named(key),
        }
    }

    /// The place whose key in the scene file is `key`; a point for any other word.
    pub fn named(key: &str) -> LightPlace {
        match key {
            "direction" => LightPlace::Direction(DVec3::NEG_Z),
            "spot" => LightPlace::Spot {
                at: DVec3::ZERO,
                towards: DVec3::NEG_Z,
                angle_degrees: 30.0,
                edge: 0.2,
            },
            "area" => LightPlace::Area(Area::named("rectangle")),
            _ => LightPlace::Point(DVec3::ZERO),
        }
    }

    /// The same light as another kind, where it is and, if it has one, in its direction.
    pub fn turned_into(&self, kind: &str) -> LightPlace {
        let along = match self {
            LightPlace::Direction(along) => along.normalize_or(DVec3::NEG_Z),
            LightPlace::Spot { at, towards, .. } => (*towards - *at).normalize_or(DVec3::NEG_Z),
            LightPlace::Area(Area::Disc { normal, .. }) => normal.normalize_or(DVec3::NEG_Z),
            LightPlace::Point(_) | LightPlace::Area(_) => DVec3::NEG_Z,
        };
        // A direction comes from this far above the origin.
        let anchor = self.anchor().unwrap_or(along * -5.0);
        match LightPlace::of_kind(kind).anchored_at(anchor) {
            LightPlace::Direction(_) => LightPlace::Direction(along),
            LightPlace::Spot { at, towards: _, angle_degrees, edge } => {
                LightPlace::Spot { at, towards: at + along, angle_degrees, edge }
            }
            LightPlace::Area(Area::Disc { center, normal: _, radius }) => {
                LightPlace::Area(Area::Disc { center, normal: along, radius })
            }
            place => place,
        }
    }

    /// Whether it has an area.
    pub fn is_spread(&self) -> bool {
        matches!(self, LightPlace::Area(_))
    }

    /// The point that stands for it; none of a direction.
    pub fn anchor(&self) -> Option<DVec3> {
        match self {
            LightPlace::Point(point) => Some(*point),
            LightPlace::Direction(_) => None,
            LightPlace::Spot { at, .. } => Some(*at),
            LightPlace::Area(
                Area::Rectangle { center, .. }
                | Area::Disc { center, .. }
                | Area::Sphere { center, .. },
            ) => Some(*center),
        }
    }

    /// The keys in the light's table that lead to [`LightPlace::anchor`], or to the direction.
    pub fn anchor_keys(&self) -> &'static [&'static str] {
        match self {
            LightPlace::Point(_) => &["point"],
            LightPlace::Direction(_) => &["direction"],
            LightPlace::Spot { .. } => &["spot", "at"],
            LightPlace::Area(Area::Rectangle { .. }) => &["area", "rectangle", "center"],
            LightPlace::Area(Area::Disc { .. }) => &["area", "disc", "center"],
            LightPlace::Area(Area::Sphere { .. }) => &["area", "sphere", "center"],
        }
    }

    /// The same with its anchor elsewhere; a spot keeps what it shines at. A direction stays.
    pub fn anchored_at(&self, anchor: DVec3) -> LightPlace {
        let mut moved = self.clone();
        match &mut moved {
            LightPlace::Point(point) => *point = anchor,
            LightPlace::Direction(_) => {}
            LightPlace::Spot { at, .. } => *at = anchor,
            LightPlace::Area(
                Area::Rectangle { center, .. }
                | Area::Disc { center, .. }
                | Area::Sphere { center, .. },
            ) => *center = anchor,
        }
        moved
    }
}

impl Area {
    /// The surface whose key in the scene file is `key`, of unit size; a rectangle for any other
    /// word.
    pub fn named(key: &str) -> Area {
        match key {
            "disc" => Area::Disc { center: DVec3::ZERO, normal: DVec3::NEG_Z, radius: 0.5 },
            "sphere" => Area::Sphere { center: DVec3::ZERO, radius: 0.5 },
            _ => Area::Rectangle { center: DVec3::ZERO, along: DVec3::X, across: DVec3::Y },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_kind_makes_a_place_of_that_kind_that_can_be_moved() {
        for kind in LightPlace::KINDS {
            let place = LightPlace::of_kind(kind);
            assert_eq!(place.kind(), kind);
            let moved = place.anchored_at(DVec3::new(1.0, 2.0, 3.0));
            assert_eq!(moved.anchor().is_none(), kind == "direction");
            assert!(moved.anchor().is_none_or(|at| at == DVec3::new(1.0, 2.0, 3.0)), "{kind}");
            assert_eq!((moved.kind(), moved.anchor_keys()), (kind, place.anchor_keys()));
        }
    }

    #[test]
    fn a_light_that_becomes_another_kind_stays_where_it_is() {
        for from in LightPlace::KINDS {
            let place = LightPlace::of_kind(from).anchored_at(DVec3::new(1.0, 2.0, 3.0));
            for to in LightPlace::KINDS {
                let turned = place.turned_into(to);
                assert_eq!(turned.kind(), to);
                let both = place.anchor().zip(turned.anchor());
                assert!(both.is_none_or(|(a, b)| a == b), "{from} to {to}");
            }
        }
        let spot = LightPlace::Direction(DVec3::X * 3.0).turned_into("spot");
        let LightPlace::Spot { at, towards, .. } = spot else { panic!("a spot") };
        assert_eq!((at, towards), (DVec3::X * -5.0, DVec3::X * -4.0));
        assert_eq!(spot.turned_into("direction"), LightPlace::Direction(DVec3::X));
    }

    #[test]
    fn only_an_area_takes_several_rays_and_a_direction_never_falls_off() {
        for kind in LightPlace::KINDS {
            let place = LightPlace::of_kind(kind);
            let light = Light { samples: 9, falloff: 2.0, place, ..Light::new("l") };
            assert_eq!(light.rays() == 9, ["rectangle", "disc", "sphere"].contains(&kind));
            assert_eq!(light.falls_off(), kind != "direction");
        }
    }
}
