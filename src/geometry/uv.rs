//! The two coordinates that lay an image out over each kind of solid.

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use glam::{DVec2, DVec3};

use super::Interaction;
use super::compile::{Compiled, Kind, Primitives, exact_normalize, newell_normal};
use super::placement::Placed;
use super::primitive::Form;
use super::shear::point;
use crate::scene::mesh::Mesh;
use crate::scene::{Shape, Solid};

/// A place in an image: u to the right, v up, one image from 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Uv {
    /// u and v.
    pub(super) at: [f64; 2],
    /// The gradients of u and v along the surface, per world unit.
    pub(super) gradients: [DVec3; 2],
    /// Whether v ends at 0 and 1, as at a sphere's poles.
    pub(super) poles: bool,
}

/// How an image lies on a solid, in its object space.
#[derive(Clone, Debug)]
pub(super) struct Frame {
    placed: Placed,
    chart: Chart,
}

#[derive(Clone, Debug)]
enum Chart {
    /// Longitude from +x towards +y, and latitude, of the sphere that is met; +z is its north pole.
    Ball,
    /// Coordinates along two axes from an origin, each times a scale.
    Flat { origin: DVec3, axes: [DVec3; 2] },
    /// Each face of a box shows the whole image, upright as seen from outside.
    Block { min: DVec3, max: DVec3 },
    /// What the mesh file says.
    Mesh { mesh: Arc<Mesh>, order: [usize; 3] },
    /// What the solid says, in its own frame.
    Closed,
    /// Along a knot's tube and around it.
    Tube { along: u32, around: u32, order: [usize; 3] },
}

impl Frame {
    /// That of a solid; `order` is how the corners of its compiled triangles stand in its mesh.
    ///
    /// A mesh without texture coordinates of its own is laid out like the box around it.
    pub(super) fn new(solid: &Solid, placed: Placed, order: [usize; 3]) -> Frame {
        let chart = match &solid.shape {
            Shape::Sphere { .. } | Shape::Sphereflake { .. } => Chart::Ball,
            Shape::Ellipsoid { center, radii } => {
                return Frame { placed: placed.stretched(*center, *radii), chart: Chart::Ball };
            }
            Shape::Cylinder { .. }
            | Shape::Cone { .. }
            | Shape::Torus { .. }
            | Shape::Quadric { .. }
            | Shape::Prism { .. } => Chart::Closed,
            Shape::Plane { normal, offset } => {
                let normal = exact_normalize(*normal);
                Chart::Flat { origin: normal * *offset, axes: axes(normal) }
            }
            Shape::Box { min, max } => Chart::Block { min: *min, max: *max },
            Shape::Polygon { points } => flat(points),
            Shape::Mesh { file: _, mesh } if mesh.triangle_uvs.is_empty() => {
                let (min, max) = bounds(&mesh.positions);
                Chart::Block { min, max }
            }
            Shape::Mesh { file: _, mesh } => Chart::Mesh { mesh: Arc::clone(mesh), order },
            Shape::Knot { turns: _, tube: _, segments: [along, around] } => {
                Chart::Tube { along: *along, around: *around, order }
            }
            // Its operands have charts of their own.
            Shape::Csg { .. } => Chart::Ball,
        };
        Frame { placed, chart }
    }
}

/// A polygon shows the image in the smallest rectangle around it, upright.
fn flat(points: &[DVec3]) -> Chart {
    let axes = axes(exact_normalize(newell_normal(points)));
    let ends = axes.map(|axis| {
        let along = points.iter().map(|p| p.dot(axis));
        along.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)))
    });
    let origin = axes[0] * ends[0].0 + axes[1] * ends[1].0;
    let scaled = |i: usize| axes[i] / extent(ends[i].1 - ends[i].0);
    Chart::Flat { origin, axes: [scaled(0), scaled(1)] }
}

/// Unit vectors to the right and up on a plane that is looked at against its unit normal: up is as
/// near to z as can be, or y where the plane is level.
fn axes(normal: DVec3) -> [DVec3; 2] {
    let level = normal.x == 0.0 && normal.y == 0.0;
    let upright = if level { DVec3::Y } else { DVec3::Z };
    let up = exact_normalize(upright - normal * normal.dot(upright));
    [up.cross(normal), up]
}

fn bounds(points: &[DVec3]) -> (DVec3, DVec3) {
    let first = points.first().copied().unwrap_or_default();
    points.iter().fold((first, first), |(low, high), p| (low.min(*p), high.max(*p)))
}

/// A length to divide by: 1 where there is none.
fn extent(length: f64) -> f64 {
    if length > 0.0 { length } else { 1.0 }
}

impl Primitives {
    /// u and v at a point of the solid with this index, which does not move.
    pub(super) fn uv(&self, solid: u32, at: &Interaction) -> Uv {
        let solid = solid as usize;
        let Frame { placed, chart } = &self.frames[solid];
        let solid = &self.solids[solid];
        match chart {
            Chart::Ball => self.ball(solid, at, placed),
            Chart::Flat { origin, axes } => {
                let from = placed.point_to_object(at.point) - *origin;
                let gradients = axes.map(|axis| placed.normal(axis));
                Uv { at: axes.map(|axis| from.dot(axis)), gradients, poles: false }
            }
            Chart::Block { min, max } => {
                let p = placed.point_to_object(at.point);
                let normal = placed.normal_to_object(at.geometric_normal);
                block(p, normal, [*min, *max], placed)
            }
            Chart::Closed => {
                let index = (solid.item.index + (at.primitive - solid.first)) as usize;
                match &self.shapes[index].form {
                    Form::Closed(closed) => closed.uv(at.point, at.geometric_normal),
                    _ => unreachable!("the compiler made it so"),
                }
            }
            Chart::Mesh { mesh, order } => {
                let triangle = (at.primitive - solid.first) as usize;
                let corners = mesh.triangle_uvs[triangle].map(|i| mesh.uvs[i as usize]);
                self.triangle(solid, at, order.map(|k| corners[k]))
            }
            Chart::Tube { along, around, order } => {
                let triangle = at.primitive - solid.first;
                let corners = tube_corners(triangle, [*along, *around]);
                self.triangle(solid, at, order.map(|k| corners[k]))
            }
        }
    }

    fn ball(&self, solid: &Compiled, at: &Interaction, placed: &Placed) -> Uv {
        let index = (solid.item.index + (at.primitive - solid.first)) as usize;
        let out = match (solid.item.kind, self.shapes.get(index).map(|shape| &shape.form)) {
            (Kind::Shape, Some(Form::Ellipsoid(_, center, _))) => {
                placed.point_to_object(at.point) - *center
            }
            _ => placed.vector_to_object(at.point - self.spheres[index].center),
        };
        let flat2 = out.x * out.x + out.y * out.y;
        let flat = flat2.sqrt();
        let east = DVec3::new(-out.y, out.x, 0.0);
        let north = DVec3::new(-out.x * out.z, -out.y * out.z, flat2);
        // At a pole every longitude is as good: it does not change there.
        let (east, north) = match flat > 0.0 {
            true => (east / (TAU * flat2), north / (PI * flat * (flat2 + out.z * out.z))),
            false => (DVec3::ZERO, DVec3::ZERO),
        };
        Uv {
            at: longitude_latitude(out, flat),
            gradients: [placed.normal(east), placed.normal(north)],
            poles: true,
        }
    }

    /// u and v at a point of a triangle, from those of its corners.
    fn triangle(&self, solid: &Compiled, at: &Interaction, corners: [DVec2; 3]) -> Uv {
        let index = (solid.item.index + (at.primitive - solid.first)) as usize;
        let [a, b, c] = self.triangle_corners(&self.triangles[index]).map(point);
        let (e1, e2, from) = (b - a, c - a, at.point - a);
        let normal = e1.cross(e2);
        let size2 = normal.length_squared();
        let (d1, d2) = (corners[1] - corners[0], corners[2] - corners[0]);
        if size2 == 0.0 {
            return Uv { at: corners[0].to_array(), gradients: [DVec3::ZERO; 2], poles: false };
        }
        // The gradients of the weights of the second and the third corner.
        let (g1, g2) = (e2.cross(normal) / size2, normal.cross(e1) / size2);
        let gradients = [g1 * d1.x + g2 * d2.x, g1 * d1.y + g2 * d2.y];
        let place = corners[0] + d1 * g1.dot(from) + d2 * g2.dot(from);
        Uv { at: place.to_array(), gradients, poles: false }
    }
}

/// u and v of a direction whose distance from the z axis is `flat`: u is 0 at +x and grows towards +y,
/// v is 0 at −z.
pub(super) fn longitude_latitude(out: DVec3, flat: f64) -> [f64; 2] {
    let u = libm::atan2(out.y, out.x) / TAU;
    [if u < 0.0 { u + 1.0 } else { u }, 0.5 + libm::atan2(out.z, flat) / PI]
}

/// u around the z axis, 0 at +x and growing towards +y, with its gradient.
pub(super) fn longitude(out: DVec2) -> (f64, DVec3) {
    let u = libm::atan2(out.y, out.x) / TAU;
    let around = DVec3::new(-out.y, out.x, 0.0) / (TAU * out.length_squared());
    (if u < 0.0 { u + 1.0 } else { u }, if around.is_finite() { around } else { DVec3::ZERO })
}

/// u and v of a point of a box whose faces show the whole image each.
pub(super) fn block(p: DVec3, normal: DVec3, corners: [DVec3; 2], placed: &Placed) -> Uv {
    let [u, v] =
        face(normal, corners).map(|(from, axis)| ((p - from).dot(axis), placed.normal(axis)));
    Uv { at: [u.0, v.0], gradients: [u.1, v.1], poles: false }
}

/// The corner where u and v of a box's face begin, and their gradients, by the face's normal.
fn face(normal: DVec3, [min, max]: [DVec3; 2]) -> [(DVec3, DVec3); 2] {
    let size = normal.abs();
    let axis = match size {
        s if s.x >= s.y && s.x >= s.z => DVec3::X,
        s if s.y >= s.z => DVec3::Y,
        _ => DVec3::Z,
    };
    let outward = if normal.dot(axis) < 0.0 { -axis } else { axis };
    axes(outward).map(|axis| {
        let length = extent((max - min).dot(axis).abs());
        let from = DVec3::select(axis.cmplt(DVec3::ZERO), max, min);
        (from, axis / length)
    })
}

/// u and v of the corners of a knot's triangle, in the order in which they are made.
fn tube_corners(triangle: u32, [along, around]: [u32; 2]) -> [DVec2; 3] {
    let (i, j) = (triangle / 2 / around, triangle / 2 % around);
    let at = |i: u32, j: u32| {
        DVec2::new(f64::from(i) / f64::from(along), f64::from(j) / f64::from(around))
    };
    let (a, b, c, d) = (at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
    if triangle.is_multiple_of(2) { [a, d, c] } else { [a, c, b] }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Geometry, Ray};
    use crate::progress::Progress;
    use crate::scene::{Material, Placement, Scene};
    use fearless_simd::{Level, dispatch};

    fn geometry(solid: Solid) -> Geometry {
        let scene =
            Scene { materials: vec![Material::new("m")], solids: vec![solid], ..Scene::default() };
        Geometry::build(&scene, &Progress::default()).unwrap()
    }

    /// Where a ray from `from` towards `to` meets the solid.
    fn met(geometry: &Geometry, from: DVec3, to: DVec3) -> Interaction {
        let ray = Ray { origin: from, direction: (to - from).normalize() };
        let mut stack = crate::geometry::Stack::new(geometry);
        let level = Level::new();
        let hit = dispatch!(level, simd => geometry.closest_hit(simd, &mut stack, &ray, None));
        geometry.interaction(&stack, &ray, hit.expect("a hit"))
    }

    fn uv(geometry: &Geometry, from: DVec3, to: DVec3) -> Uv {
        geometry.primitives.uv(0, &met(geometry, from, to))
    }

    fn near(found: [f64; 2], expected: [f64; 2]) {
        let wrong = (0..2).map(|i| (found[i] - expected[i]).abs()).fold(0.0, f64::max);
        assert!(wrong < 1e-12, "{found:?}, not {expected:?}");
    }

    fn placed(shape: Shape, placement: Placement) -> Geometry {
        geometry(Solid { placement, ..Solid::new("s", shape, 0) })
    }

    fn turned(degrees: [f64; 3]) -> Placement {
        Placement { rotate_degrees: degrees.into(), ..Placement::default() }
    }

    #[test]
    fn a_sphere_is_a_globe_whatever_its_placement() {
        let globe = Shape::Sphere { center: DVec3::new(0.5, 0.0, 0.0), radius: 2.0 };
        let center = DVec3::new(0.5, 0.0, 0.0);
        let plain = placed(globe.clone(), Placement::default());
        let seen = |g: &Geometry, out: DVec3| uv(g, center + out * 9.0, center).at;
        for (out, expected) in [
            (DVec3::X, [0.0, 0.5]),
            (DVec3::Y, [0.25, 0.5]),
            (-DVec3::X, [0.5, 0.5]),
            (-DVec3::Y, [0.75, 0.5]),
            (DVec3::new(0.0, 1.0, 1.0), [0.25, 0.75]),
        ] {
            near(seen(&plain, out), expected);
        }
        assert_eq!((seen(&plain, DVec3::Z)[1], seen(&plain, -DVec3::Z)[1]), (1.0, 0.0));
        // Turned about z at the origin, and stretched: both take the image with them.
        let turn = placed(globe.clone(), turned([0.0, 0.0, 90.0]));
        let from = DVec3::new(0.0, 0.5, 0.0);
        near(uv(&turn, from + DVec3::Y * 9.0, from).at, [0.0, 0.5]);
        let stretched = Placement { scale: DVec3::new(1.0, 1.0, 3.0), ..Placement::default() };
        let stretched = placed(globe, stretched);
        let above = uv(&stretched, center + DVec3::new(9.0, 0.0, 0.0), center + DVec3::Z * 3.0);
        assert!(above.at[1] > 0.5 && above.at[0] == 0.0);
    }

    #[test]
    fn gradients_are_the_slopes_of_u_and_v() {
        let mesh = Shape::Knot { turns: [2, 3], tube: 0.3, segments: [40, 10] };
        let outline = [[-1.5, -1.4], [1.6, -1.2], [1.4, 1.5], [-1.3, 1.2]];
        let outline = vec![outline.map(DVec2::from).to_vec()];
        let shapes = [
            Shape::Cylinder { from: -DVec3::X, to: DVec3::new(1.2, 0.3, 0.9), radius: 1.0 },
            Shape::Cylinder { from: -DVec3::Z, to: DVec3::Z, radius: 2.0 },
            Shape::Cone { from: -DVec3::Z, to: DVec3::Z * 1.5, radius: 2.0, tip: 0.5 },
            Shape::Torus { major: 1.0, minor: 0.6 },
            Shape::Ellipsoid { center: DVec3::X * 0.2, radii: DVec3::new(1.5, 1.2, 0.9) },
            Shape::named("quadric"),
            Shape::Prism { outline: outline.clone(), bottom: -1.0, top: 1.0 },
            Shape::Prism { outline, bottom: -1.0, top: 9.0 },
            Shape::Sphere { center: DVec3::ZERO, radius: 1.3 },
            Shape::Box { min: DVec3::splat(-1.0), max: DVec3::new(1.0, 2.0, 1.5) },
            Shape::Plane { normal: DVec3::new(1.0, 2.0, 3.0), offset: 0.5 },
            mesh,
        ];
        let stretched = Placement {
            translate: DVec3::new(0.1, 0.2, 0.3),
            rotate_degrees: DVec3::new(20.0, 30.0, 40.0),
            scale: DVec3::new(1.0, 1.5, 0.7),
        };
        for shape in shapes {
            for placement in [turned([20.0, 30.0, 40.0]), stretched.clone()] {
                let geometry = placed(shape.clone(), placement);
                let from = DVec3::new(3.0, 4.0, 9.0);
                let to = DVec3::new(1.1, 0.4, 0.1);
                let step = DVec3::new(1e-6, -2e-6, 1e-6);
                let (a, b) = (met(&geometry, from, to), met(&geometry, from, to + step));
                let (at, next) = (geometry.primitives.uv(0, &a), geometry.primitives.uv(0, &b));
                for i in 0..2 {
                    let rise = next.at[i] - at.at[i];
                    let told = at.gradients[i].dot(b.point - a.point);
                    let wrong = (rise - told).abs();
                    let size = at.gradients[i].length() * (b.point - a.point).length();
                    assert!(wrong < 1e-4 * size, "{shape:?} {i}: {rise:e}, {told:e}");
                }
            }
        }
    }

    #[test]
    fn planes_and_boxes_are_upright_seen_from_outside() {
        let floor = geometry(Solid::new("f", Shape::Plane { normal: DVec3::Z, offset: 0.0 }, 0));
        near(uv(&floor, DVec3::Z, DVec3::new(0.25, 0.5, 0.0)).at, [0.25, 0.5]);
        let min = DVec3::new(0.0, 0.0, 0.0);
        let block =
            geometry(Solid::new("b", Shape::Box { min, max: DVec3::new(4.0, 2.0, 1.0) }, 0));
        // Seen from the front (−y) x is to the right, from the right (+x) y, from behind −x.
        let from = |at: [f64; 3], out: DVec3| uv(&block, DVec3::from(at) + out, at.into()).at;
        near(from([1.0, 0.0, 0.25], -DVec3::Y), [0.25, 0.25]);
        near(from([4.0, 0.5, 0.25], DVec3::X), [0.25, 0.25]);
        near(from([1.0, 2.0, 0.25], DVec3::Y), [0.75, 0.25]);
        near(from([0.0, 0.5, 0.25], -DVec3::X), [0.75, 0.25]);
        near(from([1.0, 0.5, 1.0], DVec3::Z), [0.25, 0.25]);
    }

    #[test]
    fn round_solids_are_wrapped_and_their_ends_are_flat() {
        let rod = Shape::Cylinder { from: DVec3::ZERO, to: DVec3::Z * 4.0, radius: 2.0 };
        let rod = geometry(Solid::new("r", rod, 0));
        let at = |out: DVec3, z: f64| uv(&rod, out * 9.0 + DVec3::Z * z, DVec3::Z * z).at;
        near(at(DVec3::Y, 1.0), [0.25, 0.25]);
        near(at(-DVec3::X, 3.0), [0.5, 0.75]);
        let end = DVec3::new(1.0, 0.0, 4.0);
        near(uv(&rod, end + DVec3::Z, end).at, [0.75, 0.5]);
        let other = DVec3::new(1.0, 1.0, 0.0);
        near(uv(&rod, other - DVec3::Z, other).at, [0.25, 0.75]);
        let ring = geometry(Solid::new("t", Shape::Torus { major: 2.0, minor: 0.5 }, 0));
        near(uv(&ring, DVec3::Y * 9.0, DVec3::ZERO).at, [0.25, 0.5]);
        let top = DVec3::new(-2.0, 0.0, 0.5);
        near(uv(&ring, top + DVec3::Z, top).at, [0.5, 0.75]);
    }

    #[test]
    fn a_prism_is_wrapped_along_its_outline() {
        let outline = vec![[[0., 0.], [4., 0.], [4., 1.], [0., 1.]].map(DVec2::from).to_vec()];
        let bar = Shape::Prism { outline, bottom: 1.0, top: 3.0 };
        let bar = geometry(Solid::new("p", bar, 0));
        let seen = |at: [f64; 3], out: DVec3| uv(&bar, DVec3::from(at) + out, at.into()).at;
        near(seen([1.0, 0.0, 1.5], -DVec3::Y), [0.1, 0.25]);
        near(seen([4.0, 0.5, 2.0], DVec3::X), [0.45, 0.5]);
        near(seen([0.0, 0.25, 2.0], -DVec3::X), [0.975, 0.5]);
        near(seen([1.0, 0.5, 3.0], DVec3::Z), [0.25, 0.5]);
        near(seen([1.0, 0.5, 1.0], -DVec3::Z), [0.75, 0.5]);
    }

    #[test]
    fn a_polygon_fits_the_image_into_its_rectangle() {
        let points = [[2.0, 3.0, 1.0], [6.0, 3.0, 1.0], [6.0, 3.0, 3.0], [2.0, 3.0, 3.0]];
        let screen = Shape::Polygon { points: points.map(DVec3::from).to_vec() };
        let screen = geometry(Solid::new("p", screen, 0));
        let seen = uv(&screen, DVec3::new(3.0, 0.0, 2.5), DVec3::new(3.0, 3.0, 2.5));
        near(seen.at, [0.25, 0.75]);
    }

    #[test]
    fn meshes_use_their_own_coordinates_wound_either_way() {
        let corner = |x: f64, y: f64, z: f64| DVec3::new(x, y, z);
        let positions =
            vec![DVec3::ZERO, corner(1.0, 0.0, 0.0), corner(0.0, 1.0, 0.0), corner(0.0, 0.0, 1.0)];
        let uvs: Vec<DVec2> =
            [[0.1, 0.2], [0.9, 0.3], [0.2, 0.8], [0.5, 0.5]].map(DVec2::from).to_vec();
        let outside = vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
        let inside: Vec<[u32; 3]> = outside.iter().map(|t: &[u32; 3]| [t[0], t[2], t[1]]).collect();
        for triangles in [outside, inside] {
            let mesh = Mesh {
                positions: positions.clone(),
                uvs: uvs.clone(),
                triangle_uvs: triangles.clone(),
                triangles,
                ..Mesh::default()
            };
            let shape = Shape::Mesh { file: "m.obj".into(), mesh: Arc::new(mesh) };
            let geometry = geometry(Solid::new("m", shape, 0));
            // On the face x + y + z = 1, by the weights of its corners.
            let to = corner(0.5, 0.3, 0.2);
            let expected = uvs[1] * 0.5 + uvs[2] * 0.3 + uvs[3] * 0.2;
            near(uv(&geometry, to + DVec3::ONE, to).at, expected.to_array());
        }
    }

    #[test]
    fn a_tube_closes_in_both_directions() {
        let knot = Shape::Knot { turns: [2, 3], tube: 0.3, segments: [40, 10] };
        let geometry = geometry(Solid::new("k", knot, 0));
        for triangle in 0..800 {
            let corners = tube_corners(triangle, [40, 10]);
            let [a, b, c] = corners;
            let area = (b - a).perp_dot(c - a).abs();
            assert!((area - 1.0 / 400.0).abs() < 1e-12);
            assert!(corners.iter().all(|c| c.cmple(DVec2::ONE).all()));
        }
        let seen = uv(&geometry, DVec3::new(1.5, 0.0, 9.0), DVec3::new(1.5, 0.001, 0.0)).at;
        assert!(seen.iter().all(|c| (0.0..=1.0).contains(c)), "{seen:?}");
    }
}
