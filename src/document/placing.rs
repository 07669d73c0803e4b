//! Where solids stand that are added or copied: where they are seen.

use std::sync::Arc;

use glam::{DVec2, DVec3};

use crate::forest::camera::{Seen, View};
use crate::geometry::{corners, rotation};
use crate::scene::csg::Operation;
use crate::scene::mesh::Mesh;
use crate::scene::{Camera, Placement, Scene, Shape, Solid};

/// Half the height of a new solid, in parts of the picture's height.
const HALF: f64 = 0.12;
/// Where a new solid may stand, from the middle of the picture, in parts of its height.
const PLACES: [[f64; 2]; 8] = [
    [0.0, 0.0],
    [0.33, 0.0],
    [-0.33, 0.0],
    [0.66, 0.0],
    [-0.66, 0.0],
    [0.0, -0.33],
    [0.33, -0.33],
    [-0.33, -0.33],
];
/// How far a copy stands from what it was copied from, in its widths.
const ASIDE: f64 = 1.1;
/// The same of a solid without a width, in parts of the distance between eye and target.
const ASIDE_UNKNOWN: f64 = 0.1;
/// Below this sine of the angle between view and floor, a floor would be seen from the side.
const FLAT: f64 = 0.05;

/// What products of short numbers may be off by.
const ROUNDING: f64 = 1e-9;

/// Where a new solid stands, and how large it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stand {
    /// Its middle, world space.
    pub at: DVec3,
    /// Half its size, world units, > 0.
    pub half: f64,
}

impl Stand {
    /// As far away as where the camera looks at: in the middle of the picture, or beside it where
    /// something hides that; in front of what is in the middle if all is hidden. `seen` gives the depth
    /// of what is seen at a point in pixels, if anything is.
    pub fn new(camera: &Camera, size: [u32; 2], seen: &dyn Fn([f64; 2]) -> Option<f64>) -> Stand {
        let view = View::new(camera, size);
        let [width, height] = size.map(f64::from);
        let half = |depth: f64| neat(view.height_at(depth) * HALF);
        let target = camera.eye.distance(camera.target);
        let places = PLACES.map(|[x, y]| [width / 2.0 + x * height, height / 2.0 + y * height]);
        // A floor that is level in the picture and goes through the place hides nothing; a ring does.
        let nearest = target - half(target) / 8.0;
        let clear = |at| seen(at).is_none_or(|depth| depth > nearest);
        let free = |[x, y]: &[f64; 2]| {
            [-HALF, 0.0, HALF].into_iter().all(|side| clear([x + side * height, *y]))
        };
        let inside = |at: &[f64; 2]| at[0] > 0.1 * width && at[0] < 0.9 * width;
        let place = places.into_iter().find(|at| inside(at) && free(at));
        if place == Some(places[0]) {
            return Stand { at: camera.target, half: half(target) };
        }
        let depth = match place {
            Some(_) => target,
            // With room for what is larger than its half, and never behind the eye.
            None => {
                seen(places[0]).map_or(target, |seen| (seen - 2.0 * half(seen)).max(0.5 * seen))
            }
        };
        let (at, half) = (place.unwrap_or(places[0]), half(depth));
        Stand { at: tidy(view.point(Seen { at, depth }), half / 4.0), half }
    }

    /// Gives a solid a mesh, and the place and size at which its box stands here.
    pub fn fit(self, solid: &mut Solid, file: String, mesh: Arc<Mesh>) {
        let Stand { at, half } = self;
        let [min, max] = bounds(mesh.positions.iter().copied()).unwrap_or_default();
        let scale = match (max - min).max_element() / 2.0 {
            radius if radius > 0.0 => neat(half / radius),
            _ => 1.0,
        };
        let middle = (min + max) / 2.0 * scale;
        let translate = tidy(at - middle, half / 4.0);
        solid.placement =
            Placement { translate, scale: DVec3::splat(scale), ..Placement::default() };
        solid.shape = Shape::Mesh { file, mesh };
    }
}

/// A shape of this key in a scene file as a new solid begins: of unit size around its origin, and what
/// places it. A plane lies where the camera looks at, with the eye outside; what is made of others stands
/// where they do.
pub fn fresh(key: &str, camera: &Camera, stand: Stand) -> (Shape, Placement) {
    let shape = match Shape::named(key) {
        Shape::Plane { .. } => Shape::Plane { normal: floor(camera), offset: 0.0 },
        Shape::Polygon { .. } => Shape::Polygon { points: sheet(camera) },
        Shape::Prism { .. } => {
            let outline = [[-1.0, -1.0], [1.0, -1.0], [0.0, 1.0]].map(DVec2::from);
            Shape::Prism { outline: vec![outline.to_vec()], bottom: -1.0, top: 1.0 }
        }
        shape => shape,
    };
    let Stand { at, half } = stand;
    let placement = match shape {
        Shape::Plane { .. } => Placement { translate: camera.target, ..Placement::default() },
        Shape::Csg { .. } => Placement::default(),
        _ => Placement { translate: at, scale: DVec3::splat(half), ..Placement::default() },
    };
    (shape, placement)
}

/// The way from a solid to a copy of it that is seen beside it, world space: along the axis that points
/// to the right of the picture, a little more than it is wide; a plane is moved out along the axis next
/// to its normal, for beside it there is itself.
pub fn aside(scene: &Scene, solid: usize) -> DVec3 {
    let Camera { eye, target, up, .. } = &scene.camera;
    let unknown = neat(ASIDE_UNKNOWN * eye.distance(*target));
    if let Shape::Plane { normal, offset: _ } = &scene.solids[solid].shape {
        let Placement { translate: _, rotate_degrees, scale } = &scene.solids[solid].placement;
        return next_axis(rotation(*rotate_degrees) * (*normal / *scale)) * unknown;
    }
    let right = next_axis((*target - *eye).cross(*up));
    let along = around(scene, solid).unwrap_or_default();
    let along = || along.iter().map(|corner| corner.dot(right));
    let width = along().fold(f64::MIN, f64::max) - along().fold(f64::MAX, f64::min);
    let wide = width.is_finite() && width > 0.0;
    right * if wide { neat_above(width * ASIDE) } else { unknown }
}

/// Corners of boxes around a solid, world space; `None` of what has no end.
fn around(scene: &Scene, solid: usize) -> Option<Vec<DVec3>> {
    let solid = &scene.solids[solid];
    let boxed = |min: DVec3, max: DVec3| {
        let shape = Shape::Box { min, max };
        corners(&Solid { shape, placement: solid.placement.clone(), ..bare() })
    };
    match &solid.shape {
        Shape::Mesh { file: _, mesh } => {
            let [min, max] = bounds(mesh.positions.iter().copied())?;
            boxed(min, max)
        }
        // A knot's middle line lies in a tube of this radius around its circle of radius 1.
        Shape::Knot { tube, .. } => boxed(DVec3::splat(-1.5 - tube), DVec3::splat(1.5 + tube)),
        // Every generation adds a third of what the one before it added.
        Shape::Sphereflake { center, radius, levels: _ } => {
            boxed(*center - 2.0 * *radius, *center + 2.0 * *radius)
        }
        Shape::Csg { operation, operands } => {
            let count = match operation {
                Operation::Union | Operation::Merge => operands.len(),
                Operation::Difference | Operation::Intersection => 1,
                Operation::Complement => return None,
            };
            let parts = operands.iter().take(count).map(|&operand| around(scene, operand));
            let parts: Option<Vec<_>> = parts.collect();
            let [min, max] = bounds(parts?.into_iter().flatten())?;
            boxed(min, max)
        }
        _ => corners(solid),
    }
}

/// A solid of which all is still to be said.
fn bare() -> Solid {
    Solid::new("", Shape::named("sphere"), 0)
}

fn bounds(points: impl Iterator<Item = DVec3>) -> Option<[DVec3; 2]> {
    points.fold(None, |bounds, point| match bounds {
        None => Some([point, point]),
        Some([min, max]) => Some([min.min(point), max.max(point)]),
    })
}

/// The way out of a new floor: the axis next to the camera's up, towards the eye; towards the camera
/// where that would be seen from the side.
fn floor(camera: &Camera) -> DVec3 {
    let arm = camera.eye - camera.target;
    let up = next_axis(camera.up);
    let side = if arm.dot(up) < 0.0 { -up } else { up };
    if arm.dot(side) < FLAT * arm.length() { next_axis(arm) } else { side }
}

/// A square of half size 1 across the axis next to the view.
fn sheet(camera: &Camera) -> Vec<DVec3> {
    let out = next_axis(camera.eye - camera.target);
    let across = DVec3::new(out.z, out.x, out.y);
    let above = out.cross(across);
    [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]
        // -0 becomes 0
        .map(|[x, y]| across * x + above * y + DVec3::ZERO)
        .to_vec()
}

/// The world's axis, or its opposite, that is nearest to a direction.
fn next_axis(direction: DVec3) -> DVec3 {
    let axes = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| (direction.dot(axis), axis));
    let nearer = |a: (f64, DVec3), b: (f64, DVec3)| if b.0.abs() > a.0.abs() { b } else { a };
    let (along, axis) = axes.into_iter().fold(axes[0], nearer);
    // -0 becomes 0
    if along < 0.0 { DVec3::ZERO - axis } else { axis }
}

/// The number of one decimal digit that is nearest to a positive number.
fn neat(number: f64) -> f64 {
    format!("{number:.0e}").parse().unwrap_or(number)
}

/// A number of two decimal digits that is not below a positive number, rounding aside.
fn neat_above(number: f64) -> f64 {
    let near: f64 = format!("{number:.1e}").parse().unwrap_or(number);
    if near >= number * (1.0 - ROUNDING) {
        return near;
    }
    // Half a step of the last digit more is rounded up.
    format!("{:.1e}", number * 1.05).parse().unwrap_or(number)
}

/// A point within a quarter of a pixel of this size, in few decimal digits: it will stand in the scene
/// file.
pub fn tidy(point: DVec3, pixel: f64) -> DVec3 {
    let digits = (4.0 / pixel).log10().ceil().clamp(-15.0, 15.0) as i32;
    let rounded = |x: f64| match usize::try_from(digits) {
        Ok(digits) => format!("{x:.digits$}").parse().unwrap_or(x),
        Err(_) => {
            let step = 10f64.powi(-digits);
            (x / step).round() * step
        }
    };
    // -0 becomes 0
    DVec3::from(point.to_array().map(|x| rounded(x) + 0.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::fields::{SHAPES, shape_key};

    const SIZE: [u32; 2] = [640, 360];

    fn cameras() -> Vec<Camera> {
        let eyes = [[0.0, -6.0, 2.0], [3.0, 0.0, 0.0], [0.0, 0.5, -40.0], [-0.02, 0.01, 0.03]];
        let camera = |eye: [f64; 3]| {
            let up = if eye[2].abs() > 10.0 { DVec3::Y } else { DVec3::Z };
            Camera { eye: DVec3::from(eye), up, ..Camera::default() }
        };
        eyes.into_iter().map(camera).collect()
    }

    /// A picture in which the same is seen everywhere, this far away.
    fn wall(seen: Option<f64>) -> impl Fn([f64; 2]) -> Option<f64> {
        move |_| seen
    }

    /// Where a new solid is seen from the middle of the picture, in its heights, and how far away.
    fn standing(camera: &Camera, seen: &dyn Fn([f64; 2]) -> Option<f64>) -> ([f64; 2], f64) {
        let view = View::new(camera, SIZE);
        let Stand { at, half } = Stand::new(camera, SIZE, seen);
        let place = view.project(at).expect("before the eye");
        let share = half / view.height_at(place.depth);
        assert!((0.08..0.18).contains(&share), "{share}");
        let [x, y] = place.at;
        ([(x - 320.0) / 360.0, (y - 180.0) / 360.0], place.depth)
    }

    #[test]
    fn a_new_solid_stands_where_the_camera_looks_at_or_before_what_is_everywhere() {
        for camera in cameras() {
            let target = camera.eye.distance(camera.target);
            for seen in [None, Some(3.0 * target), Some(target), Some(0.3 * target)] {
                let ([x, y], depth) = standing(&camera, &wall(seen));
                assert!(x.abs().max(y.abs()) < 0.02, "{camera:?} {seen:?}: {x} {y}");
                assert!(depth <= seen.unwrap_or(target) * 1.01, "{camera:?} {seen:?}: {depth}");
                let near = seen.is_some_and(|seen| seen < target);
                assert_eq!(depth < 0.9 * target, near, "{camera:?} {seen:?}: {depth}");
            }
        }
    }

    #[test]
    fn a_new_solid_stands_beside_what_is_in_the_middle() {
        for camera in cameras() {
            let target = camera.eye.distance(camera.target);
            let mut taken: Vec<[f64; 2]> = Vec::new();
            for [x, y] in PLACES {
                let near = |at: [f64; 2]| {
                    let off = |p: &[f64; 2]| (at[0] - p[0]).abs().max((at[1] - p[1]).abs());
                    taken.iter().any(|p| off(p) < 60.0).then_some(0.6 * target)
                };
                let (place, depth) = standing(&camera, &near);
                let off = (place[0] - x).abs().max((place[1] - y).abs());
                assert!(off < 0.02, "{camera:?}: {place:?}");
                assert!((depth / target - 1.0).abs() < 0.02, "{camera:?}: {depth}");
                taken.push([320.0 + x * 360.0, 180.0 + y * 360.0]);
            }
        }
        // Beside a ring through which one sees, too.
        let ring = |[x, _]: [f64; 2]| (30.0..60.0).contains(&(x - 320.0).abs()).then_some(6.2);
        let ([x, _], _) = standing(&Camera::default(), &ring);
        assert!((x - 0.33).abs() < 0.02, "{x}");
        // A narrow picture has room above the middle only.
        let hidden = |[_, y]: [f64; 2]| (y > 170.0).then_some(3.0);
        let stand = Stand::new(&Camera::default(), [60, 360], &hidden);
        assert!(stand.at.z > 0.5 && stand.at.x == 0.0, "{stand:?}");
    }

    #[test]
    fn every_new_shape_has_its_key_and_surrounds_where_it_stands() {
        for camera in cameras() {
            let stand = Stand::new(&camera, SIZE, &wall(None));
            for key in SHAPES {
                let (shape, placement) = fresh(key, &camera, stand);
                assert_eq!(shape_key(&shape), *key);
                let solid = Solid { shape, placement, ..bare() };
                let scene = Scene { solids: vec![solid], ..Scene::default() };
                if scene.solids[0].shape.is_composite() {
                    continue;
                }
                let Some(corners) = around(&scene, 0) else { continue };
                let [min, max] = bounds(corners.into_iter()).expect("corners");
                let middle = stand.at;
                assert!(min.cmple(middle).all() && max.cmpge(middle).all(), "{key}");
            }
        }
    }

    #[test]
    fn a_mesh_is_made_as_large_as_other_new_solids() {
        let stand = Stand { at: DVec3::new(1.0, 2.0, 3.0), half: 0.5 };
        let positions = [[10.0, 0.0, 0.0], [90.0, 40.0, 20.0]].map(DVec3::from).to_vec();
        let mut solid = bare();
        let fit = |solid: &mut Solid, positions| {
            stand.fit(solid, "a.obj".into(), Arc::new(Mesh { positions, ..Mesh::default() }));
        };
        fit(&mut solid, positions);
        assert_eq!(solid.placement.scale, DVec3::splat(0.01));
        let scene = Scene { solids: vec![solid.clone()], ..Scene::default() };
        let [min, max] = bounds(around(&scene, 0).unwrap().into_iter()).unwrap();
        assert!(((min + max) / 2.0 - stand.at).abs().max_element() < 0.05, "{min} {max}");
        fit(&mut solid, Vec::new());
        assert_eq!((solid.placement.translate, solid.placement.scale), (stand.at, DVec3::ONE));
    }

    #[test]
    fn a_new_plane_has_the_eye_outside_and_a_new_sheet_is_not_seen_from_the_side() {
        for camera in cameras() {
            let arm = camera.eye - camera.target;
            let out = floor(&camera);
            assert!(arm.dot(out) >= FLAT * arm.length(), "{camera:?}: {out}");
            let [a, b, c, _] = sheet(&camera)[..] else { panic!("a square") };
            let normal = (b - a).cross(c - b).normalize();
            assert!(normal.dot(arm.normalize()) > 0.5, "{camera:?}: {normal}");
        }
        assert_eq!(floor(&cameras()[0]), DVec3::Z);
        assert_eq!(floor(&cameras()[1]), DVec3::X, "Z would be seen from the side");
    }

    #[test]
    fn a_copy_stands_beside_the_original_and_a_plane_before_it() {
        let solid = |shape: Shape| Solid { shape, ..bare() };
        let merge = Shape::Csg { operation: Operation::Merge, operands: vec![0, 1] };
        let complement = Shape::Csg { operation: Operation::Complement, operands: vec![0] };
        let mut long = solid(Shape::named("box"));
        long.placement.scale.x = 3.0;
        long.placement.translate.x = 1.0;
        let all = [
            solid(Shape::named("sphere")),
            long,
            solid(merge),
            solid(complement),
            solid(Shape::named("plane")),
            solid(Shape::named("mesh")),
            solid(Shape::named("knot")),
        ];
        let mut scene = Scene { solids: all.to_vec(), ..Scene::default() };
        let way = |scene: &Scene| [0, 1, 2, 3, 4, 5, 6].map(|i| aside(scene, i));
        let [x, z] = [DVec3::X, DVec3::Z];
        let expected = [x * 2.2, x * 6.6, x * 6.6, x * 0.6, z * 0.6, x * 0.6, x * 4.0];
        assert_eq!(way(&scene), expected);
        // Seen from behind, right is the other way.
        scene.camera.eye.y = 6.0;
        assert_eq!(way(&scene), expected.map(|way| way * DVec3::new(-1.0, 1.0, 1.0)));
        scene.solids[4].placement.rotate_degrees.x = 90.0;
        assert_eq!(aside(&scene, 4), DVec3::NEG_Y * 0.6);
    }

    #[test]
    fn neat_numbers_have_few_digits() {
        let near = [(0.745, 0.7), (0.96, 1.0), (0.004, 0.004), (1234.0, 1000.0)];
        for (number, expected) in near {
            assert_eq!(neat(number), expected);
        }
        let above = [(2.2, 2.2), (2.2001, 2.3), (9.99, 10.0), (9.91, 10.0), (0.0123, 0.013)];
        for (number, expected) in above {
            assert_eq!(neat_above(number), expected);
        }
        assert_eq!(neat_above(1.01), 1.1);
    }

    #[test]
    fn numbers_have_no_more_digits_than_a_pixel_needs() {
        let third = DVec3::new(1.0 / 3.0, -2e5 / 3.0, -1e-9);
        assert_eq!(tidy(third, 0.01), DVec3::new(0.333, -66_666.667, 0.0));
        assert_eq!(tidy(third, 5000.0), DVec3::new(0.0, -67_000.0, 0.0));
        assert!(tidy(third, 0.01).z.is_sign_positive());
    }
}
