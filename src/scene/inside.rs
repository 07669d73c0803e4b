//! Which indices of refraction can show: what surrounds the eye, and what light passes through.

use std::cell::Cell;

use glam::{DMat3, DVec2, DVec3};

use super::csg::{MOST_DEEP, MOST_PARTS, Operation};
use super::model::Model;
use super::{Lens, Material, Placement, Scene, Shape, Solid};

/// Beyond rounding: a point this much outside, relative to the solid's size, still counts as inside.
const MARGIN: f64 = 1e-6;

impl Scene {
    /// Whether the index of refraction of a material shows.
    ///
    /// What lets light through bends it; Fresnel and Cook-Torrance weigh by it. A surface that lets
    /// nothing through only tells total reflection from a mirror's, which needs a denser medium in
    /// front of it, or an eye inside it.
    pub fn ior_matters(&self, material: usize) -> bool {
        self.ior_matters_below(material).is_none_or(|limit| self.materials[material].ior < limit)
    }

    /// The index of refraction from which on, upwards, that of a material does not show; `None` if
    /// it shows whatever it is.
    pub fn ior_matters_below(&self, material: usize) -> Option<f64> {
        let surrounding = self.around_the_eye();
        if self.materials[material].bends_or_weighs() || surrounding.contains(&material) {
            return None;
        }
        let passed = self.materials.iter().filter(|m| !m.transmit.is_black()).map(|m| m.ior);
        let densest = passed.chain(surrounding.iter().map(|&m| self.materials[m].ior));
        Some(densest.fold(1.0, f64::max))
    }

    /// Materials of the solids that may contain the eye, or for a parallel view, any ray's origin.
    fn around_the_eye(&self) -> Vec<usize> {
        self.around(true)
    }

    /// Those of them that let light through, ascending; a mesh contains what its box contains. Rays
    /// from the eye begin in them.
    pub fn clear_around_the_eye(&self) -> Vec<usize> {
        let mut around = self.around(false);
        around.retain(|&material| !self.materials[material].transmit.is_black());
        around.sort_unstable();
        around.dedup();
        around
    }

    /// Materials of the solids that may contain the eye; `anywhere` if a mesh always may.
    fn around(&self, anywhere: bool) -> Vec<usize> {
        let [width, pixels] = self.picture.size.map(f64::from);
        let reach = match self.camera.lens {
            Lens::Perspective { fov_degrees: _ } => self.camera.opening().map_or(0.0, |o| o.radius),
            // Parallel rays begin on a rectangle around the eye.
            Lens::Parallel { height } => height / 2.0 * (width / pixels).hypot(1.0),
        };
        let question = Question { scene: self, anywhere, asked: Cell::new(0) };
        let mut known = Vec::new();
        for (solid, operand) in self.solids.iter().zip(self.is_operand()) {
            if !operand && question.may_contain(solid, self.camera.eye, (reach, 0)) {
                self.materials_of(solid, &mut known);
            }
        }
        known.retain(|material| *material < self.materials.len());
        known
    }

    /// Appends the material of a solid, or of all that it is made of.
    fn materials_of(&self, solid: &Solid, known: &mut Vec<usize>) {
        let (mut open, mut seen) = (vec![solid], vec![false; self.solids.len()]);
        while let Some(solid) = open.pop() {
            if !solid.shape.is_composite() {
                known.push(solid.material);
            }
            for &operand in solid.shape.operands() {
                if seen.get_mut(operand).is_some_and(|seen| !std::mem::replace(seen, true)) {
                    open.push(&self.solids[operand]);
                }
            }
        }
    }
}

impl Material {
    fn bends_or_weighs(&self) -> bool {
        let weighs = self.weighs_branches() || self.model == Model::CookTorrance;
        weighs || !self.transmit.is_black()
    }
}

/// What is asked about a point.
struct Question<'a> {
    scene: &'a Scene,
    /// Whether every mesh may contain every point.
    anywhere: bool,
    /// How many solids were asked: no scene that was checked has so many, or so deep, that the answer
    /// is given up.
    asked: Cell<u64>,
}

impl Question<'_> {
    /// Whether a point, or one at most `reach` from it, may lie in a solid: `false` only if none
    /// does.
    fn may_contain(&self, solid: &Solid, point: DVec3, (reach, depth): (f64, u64)) -> bool {
        self.asked.set(self.asked.get() + 1);
        let given_up = self.asked.get() > 2 * MOST_PARTS || depth > MOST_DEEP;
        if given_up {
            return true;
        }
        let way = match solid.moves() {
            true => solid.motion.translate.length(),
            false => 0.0,
        };
        let reach = reach + way;
        if solid.moves() && solid.motion.rotate_degrees != DVec3::ZERO {
            // However it turns, nothing of it comes nearer than its farthest point to its origin.
            let away = point.distance(solid.placement.translate);
            let size = solid.placement.scale.max_element();
            return farthest(&solid.shape)
                .is_none_or(|far| away <= far * size * (1.0 + MARGIN) + reach);
        }
        let Placement { translate, rotate_degrees, scale } = solid.placement;
        let [x, y, z] = rotate_degrees.to_array().map(f64::to_radians);
        let turned =
            DMat3::from_rotation_z(z) * DMat3::from_rotation_y(y) * DMat3::from_rotation_x(x);
        let p = (turned.transpose() * (point - translate)) / scale;
        let reach = reach / scale.min_element();
        let within = |center: DVec3, radius: f64| {
            (p - center).length() <= radius * (1.0 + MARGIN) + center.length() * MARGIN + reach
        };
        let around = |min: DVec3, max: DVec3| {
            let margin = DVec3::splat((min.abs() + max.abs()).max_element() * MARGIN + reach);
            p.cmpge(min - margin).all() && p.cmple(max + margin).all()
        };
        let rod = |from: DVec3, to: DVec3, radius: f64| {
            let half = (to - from) * 0.5;
            within(from + half, half.length() + radius)
        };
        match &solid.shape {
            Shape::Sphere { center, radius } => within(*center, *radius),
            Shape::Plane { normal, offset } => {
                let size = p.length() + offset.abs();
                normal.normalize_or_zero().dot(p) <= offset + size * MARGIN + reach
            }
            Shape::Box { min, max } => around(*min, *max),
            Shape::Cylinder { from, to, radius } => rod(*from, *to, *radius),
            Shape::Cone { from, to, radius, tip } => rod(*from, *to, radius.max(*tip)),
            Shape::Torus { major, minor } => within(DVec3::ZERO, major + minor),
            Shape::Ellipsoid { center, radii } => around(*center - *radii, *center + *radii),
            Shape::Quadric { squares: _, products: _, linear: _, constant: _, min, max } => {
                around(*min, *max)
            }
            Shape::Prism { outline, bottom, top } => {
                let corners = || outline.iter().flatten();
                let min = corners().fold(DVec2::INFINITY, |a, b| a.min(*b));
                let max = corners().fold(DVec2::NEG_INFINITY, |a, b| a.max(*b));
                around(min.extend(*bottom), max.extend(*top))
            }
            Shape::Polygon { points: _ } => false,
            Shape::Csg { operation, operands } => {
                let known = operands.iter().filter_map(|&operand| self.scene.solids.get(operand));
                let mut of = known.map(|operand| self.may_contain(operand, p, (reach, depth + 1)));
                match operation {
                    Operation::Union | Operation::Merge => of.any(|contains| contains),
                    Operation::Intersection => of.all(|contains| contains),
                    Operation::Difference => of.next().unwrap_or(false),
                    // A point that may be in an operand may as well be outside.
                    Operation::Complement => true,
                }
            }
            // A part of it may be turned inside out: seen from outside it is like an inside.
            Shape::Mesh { file: _, mesh } => {
                self.anywhere || {
                    let none = (DVec3::INFINITY, DVec3::NEG_INFINITY);
                    let around = |(lo, hi): (DVec3, DVec3), q: &DVec3| (lo.min(*q), hi.max(*q));
                    let (lo, hi) = mesh.positions.iter().fold(none, around);
                    let margin = DVec3::splat((lo.abs() + hi.abs()).max_element() * MARGIN + reach);
                    p.cmpge(lo - margin).all() && p.cmple(hi + margin).all()
                }
            }
            // The knot lies within a torus of radius 1 ½ and its own tube.
            Shape::Knot { turns: _, tube, segments: _ } => within(DVec3::ZERO, 2.0 + tube),
            // Radii 1, 1/3, 1/9 … one upon the other.
            Shape::Sphereflake { center, radius, levels: _ } => within(*center, 2.0 * radius),
        }
    }
}

/// The distance of a form's farthest point from its origin, at most; `None` if it is not known.
fn farthest(shape: &Shape) -> Option<f64> {
    let corner = |min: DVec3, max: DVec3| min.abs().max(max.abs()).length();
    let of =
        |points: &mut dyn Iterator<Item = DVec3>| points.map(DVec3::length).fold(0.0, f64::max);
    Some(match shape {
        Shape::Sphere { center, radius } => center.length() + radius,
        Shape::Box { min, max } | Shape::Quadric { min, max, .. } => corner(*min, *max),
        Shape::Cylinder { from, to, radius } => from.length().max(to.length()) + radius,
        Shape::Cone { from, to, radius, tip } => from.length().max(to.length()) + radius.max(*tip),
        Shape::Torus { major, minor } => major + minor,
        Shape::Ellipsoid { center, radii } => center.length() + radii.max_element(),
        Shape::Prism { outline, bottom, top } => {
            let height = bottom.abs().max(top.abs());
            of(&mut outline.iter().flatten().map(|corner| corner.extend(height)))
        }
        Shape::Polygon { points } => of(&mut points.iter().copied()),
        Shape::Mesh { file: _, mesh } => of(&mut mesh.positions.iter().copied()),
        Shape::Knot { turns: _, tube, segments: _ } => 2.0 + tube,
        Shape::Sphereflake { center, radius, levels: _ } => center.length() + 2.0 * radius,
        Shape::Plane { .. } | Shape::Csg { .. } => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::color::Rgb;
    use crate::scene::motion::Motion;

    fn scene(iors: [f64; 2], transmit: [f32; 2]) -> Scene {
        let mut scene = Scene::default();
        scene.camera.eye = DVec3::new(0.0, -5.0, 0.0);
        for (i, name) in ["a", "b"].into_iter().enumerate() {
            let mut material = Material::new(name);
            (material.ior, material.transmit) = (iors[i], Rgb::grey(transmit[i]));
            scene.materials.push(material);
            let center = DVec3::X * 3.0 * i as f64;
            scene.solids.push(Solid {
                name: name.into(),
                shape: Shape::Sphere { center, radius: 1.0 },
                material: i,
                placement: Placement::default(),
                motion: Motion::default(),
            });
        }
        scene
    }

    #[test]
    fn what_moves_contains_only_where_it_comes() {
        let mut scene = scene([1.5, 1.5], [0.8, 0.8]);
        let mut around = |eye: DVec3, motion: Motion| {
            (scene.camera.eye, scene.solids[0].motion) = (eye, motion);
            scene.clear_around_the_eye()
        };
        let none = DVec3::ZERO;
        let along = |z| Motion { translate: DVec3::Z * z, rotate_degrees: none };
        assert_eq!(around(DVec3::Z * 4.0, along(1.0)), [0usize; 0]);
        assert_eq!(around(DVec3::Z * 4.0, along(3.5)), [0]);
        let turning = Motion { translate: none, rotate_degrees: DVec3::X * 90.0 };
        assert_eq!(around(DVec3::Z * 4.0, turning.clone()), [0usize; 0]);
        assert_eq!(around(DVec3::Y * 0.9, turning), [0]);
    }

    #[test]
    fn only_what_bends_weighs_or_totally_reflects_matters() {
        let matters = |scene: &Scene| [0, 1].map(|m| scene.ior_matters(m));
        assert_eq!(matters(&scene([1.5, 1.5], [0.0, 0.0])), [false, false]);
        assert_eq!(matters(&scene([1.5, 0.9], [0.0, 0.0])), [false, true]);
        assert_eq!(matters(&scene([1.5, 1.5], [0.8, 0.0])), [true, false]);
        assert_eq!(matters(&scene([1.6, 1.5], [0.8, 0.0])), [true, true]);
        let mut weighed = scene([1.5, 1.5], [0.0, 0.0]);
        weighed.materials[1].fresnel = true;
        assert_eq!(matters(&weighed), [false, true]);
        let mut inside = scene([1.5, 1.5], [0.0, 0.0]);
        inside.camera.eye = DVec3::new(3.5, 0.0, 0.0);
        assert_eq!(matters(&inside), [false, true]);
        inside.materials[0].ior = 1.4;
        assert_eq!(matters(&inside), [true, true]);
    }

    #[test]
    fn placed_solids_contain_what_they_contain() {
        let solid = |shape| Solid {
            name: "s".into(),
            shape,
            material: 0,
            placement: Placement {
                translate: DVec3::new(1.0, 0.0, 0.0),
                rotate_degrees: DVec3::new(0.0, 0.0, 90.0),
                scale: DVec3::new(2.0, 1.0, 1.0),
            },
            motion: Motion::default(),
        };
        let scene = Scene::default();
        let may_contain = |solid: &Solid, point, reach| {
            let question = Question { scene: &scene, anywhere: true, asked: Cell::new(0) };
            question.may_contain(solid, point, (reach, 0))
        };
        let cube = solid(Shape::Box { min: DVec3::ZERO, max: DVec3::ONE });
        // x of the box, twice as long, points along y of the world, its y along −x.
        assert!(may_contain(&cube, DVec3::new(0.5, 1.9, 0.5), 0.0));
        assert!(!may_contain(&cube, DVec3::new(0.5, 2.1, 0.5), 0.0));
        assert!(may_contain(&cube, DVec3::new(0.5, 2.1, 0.5), 0.2));
        assert!(!may_contain(&cube, DVec3::new(1.1, 1.0, 0.5), 0.0));
        let floor = solid(Shape::Plane { normal: DVec3::Z, offset: 0.0 });
        assert!(may_contain(&floor, DVec3::new(9.0, 9.0, -0.1), 0.0));
        assert!(!may_contain(&floor, DVec3::new(9.0, 9.0, 0.1), 0.0));
    }

    #[test]
    fn what_is_made_of_others_contains_what_they_contain() {
        let mut scene = scene([1.5, 1.6], [0.5, 0.5]);
        let csg = |operation, operands: &[usize]| {
            let shape = Shape::Csg { operation, operands: operands.to_vec() };
            Solid::new("made", shape, 0)
        };
        let around = |scene: &Scene, solids: &[Solid]| {
            let mut scene = scene.clone();
            scene.solids.extend_from_slice(solids);
            scene.clear_around_the_eye()
        };
        assert_eq!(around(&scene, &[]), [0usize; 0]);
        // One ball is about the eye, the other 3 beside it.
        scene.camera.eye = DVec3::ZERO;
        assert_eq!(around(&scene, &[]), [0]);
        assert_eq!(around(&scene, &[csg(Operation::Union, &[0, 1])]), [0, 1]);
        assert_eq!(around(&scene, &[csg(Operation::Intersection, &[0, 1])]), [0usize; 0]);
        assert_eq!(around(&scene, &[csg(Operation::Difference, &[1, 0])]), [0usize; 0]);
        assert_eq!(around(&scene, &[csg(Operation::Complement, &[1])]), [0, 1]);
        let mut away = csg(Operation::Merge, &[0]);
        away.placement.translate.y = 9.0;
        assert_eq!(around(&scene, &[away]), [0usize; 0]);
        scene.materials[0].transmit = Rgb::BLACK;
        assert_eq!(around(&scene, &[csg(Operation::Union, &[0, 1])]), [1]);
        // What was never checked ends too.
        let knotted = [csg(Operation::Merge, &[2, 2, 1]), csg(Operation::Merge, &[2])];
        assert_eq!(around(&scene, &knotted), [1]);
    }
}
