//! World and object space of a placed solid: `world = linear · object + translation`.

use glam::{DMat3, DVec2, DVec3};

use super::compile::exact_normalize;
use crate::scene::{Placement, Shape, Solid};

/// A placement ready for points, normals and rays.
///
/// # Invariants
/// `inverse` is the inverse of `linear` up to rounding; quarter turns are exact, so that a solid
/// turned by multiples of 90° stays exactly axis-parallel.
#[derive(Clone, Copy, Debug)]
pub(super) struct Placed {
    /// The linear part of world_from_object.
    linear: DMat3,
    /// The linear part of object_from_world.
    inverse: DMat3,
    /// World position of the object's origin.
    translation: DVec3,
    /// The factor of all lengths, if it is the same in every direction.
    similarity: Option<f64>,
}

impl Placed {
    /// Scale first, then rotation about x, y, z, then translation.
    pub(super) fn new(placement: &Placement) -> Placed {
        let Placement { translate, rotate_degrees, scale } = placement;
        let rotation = rotation(*rotate_degrees);
        let inverse_scale = DMat3::from_diagonal(scale.recip());
        Placed {
            linear: rotation * DMat3::from_diagonal(*scale),
            inverse: inverse_scale * rotation.transpose(),
            translation: *translate,
            similarity: (scale.x == scale.y && scale.y == scale.z).then_some(scale.x),
        }
    }

    /// The placement of what is placed by `inner` in this one's object space.
    pub(super) fn of(&self, inner: &Placed) -> Placed {
        Placed {
            linear: self.linear * inner.linear,
            inverse: inner.inverse * self.inverse,
            translation: self.point(inner.translation),
            similarity: self.similarity.zip(inner.similarity).map(|(a, b)| a * b),
        }
    }

    /// The frame of an object's part whose z axis goes from one of its points to another, with the
    /// distance between them. Exactly parallel to the axes if the points' difference is.
    pub(super) fn along(&self, from: DVec3, to: DVec3) -> (Placed, f64) {
        let z = exact_normalize(to - from);
        let across = if z.y.abs() > z.x.abs() && z.y.abs() > z.z.abs() {
            z.cross(DVec3::Z) * z.y.signum()
        } else {
            DVec3::Y.cross(z)
        };
        let x = exact_normalize(across);
        let frame = DMat3::from_cols(x, exact_normalize(z.cross(x)), z);
        let placed = Placed {
            linear: self.linear * frame,
            inverse: frame.transpose() * self.inverse,
            translation: self.point(from),
            similarity: self.similarity,
        };
        (placed, (to - from).length())
    }

    /// The frame in which an ellipsoid of the object is the unit sphere.
    pub(super) fn stretched(&self, center: DVec3, radii: DVec3) -> Placed {
        let even = radii.x == radii.y && radii.y == radii.z;
        Placed {
            linear: self.linear * DMat3::from_diagonal(radii),
            inverse: DMat3::from_diagonal(radii.recip()) * self.inverse,
            translation: self.point(center),
            similarity: self.similarity.filter(|_| even).map(|scale| scale * radii.x),
        }
    }

    /// The factor of all lengths, if it is the same in every direction.
    pub(super) fn similarity(&self) -> Option<f64> {
        self.similarity
    }

    /// Whether axis-parallel things stay axis-parallel.
    pub(super) fn keeps_axes(&self) -> bool {
        [self.linear.row(0), self.linear.row(1), self.linear.row(2)]
            .iter()
            .all(|row| row.to_array().iter().filter(|x| **x != 0.0).count() == 1)
    }

    /// A point of the object in the world.
    pub(super) fn point(&self, object: DVec3) -> DVec3 {
        self.linear * object + self.translation
    }

    /// A point of the world in object space.
    pub(super) fn point_to_object(&self, world: DVec3) -> DVec3 {
        self.inverse * (world - self.translation)
    }

    /// A difference of two points of the world in object space.
    pub(super) fn vector_to_object(&self, world: DVec3) -> DVec3 {
        self.inverse * world
    }

    /// A surface normal in object space, not of unit length.
    pub(super) fn normal_to_object(&self, world: DVec3) -> DVec3 {
        self.linear.transpose() * world
    }

    /// A surface normal of the object in the world, not of unit length.
    pub(super) fn normal(&self, object: DVec3) -> DVec3 {
        self.inverse.transpose() * object
    }

    /// World half extents of the object's box of half extents `half`.
    pub(super) fn box_extent(&self, half: DVec3) -> DVec3 {
        self.rows().map(|row| (row * half).abs().element_sum()).into()
    }

    /// World half extents of the object's sphere of `radius`.
    pub(super) fn sphere_extent(&self, radius: f64) -> DVec3 {
        self.rows().map(|row| row.length() * radius).into()
    }

    /// World half extents of the object's disc of `radius` across z.
    pub(super) fn disc_extent(&self, radius: f64) -> DVec3 {
        self.rows().map(|row| row.truncate().length() * radius).into()
    }

    /// A ray in object space. The direction is *not* of unit length: `t` stays the world's.
    #[inline(always)]
    pub(super) fn ray_to_object(&self, origin: DVec3, direction: DVec3) -> (DVec3, DVec3) {
        (self.inverse * (origin - self.translation), self.inverse * direction)
    }

    fn rows(&self) -> [DVec3; 3] {
        [self.linear.row(0), self.linear.row(1), self.linear.row(2)]
    }
}

/// Rotation about x, then y, then z; quarter turns are exact.
pub fn rotation(degrees: DVec3) -> DMat3 {
    let (sx, cx) = sin_cos_degrees(degrees.x);
    let (sy, cy) = sin_cos_degrees(degrees.y);
    let (sz, cz) = sin_cos_degrees(degrees.z);
    let x = DMat3::from_cols_array(&[1.0, 0.0, 0.0, 0.0, cx, sx, 0.0, -sx, cx]);
    let y = DMat3::from_cols_array(&[cy, 0.0, -sy, 0.0, 1.0, 0.0, sy, 0.0, cy]);
    let z = DMat3::from_cols_array(&[cz, sz, 0.0, -sz, cz, 0.0, 0.0, 0.0, 1.0]);
    z * (y * x)
}

/// Sine and cosine of an angle in degrees, exact for every multiple of 90°.
fn sin_cos_degrees(degrees: f64) -> (f64, f64) {
    let turned = degrees % 360.0;
    let quarters = (turned / 90.0).round();
    let rest = (turned - 90.0 * quarters).to_radians();
    let (s, c) = (libm::sin(rest), libm::cos(rest));
    match quarters.rem_euclid(4.0) as u32 {
        0 => (s, c),
        1 => (c, -s),
        2 => (-s, -c),
        _ => (-c, s),
    }
}

/// Corners around a solid that has some: its box in its own frame, in world space, at the beginning
/// of its motion. `None` of an infinite plane and of what is made of many parts.
pub fn corners(solid: &Solid) -> Option<Vec<DVec3>> {
    let mut placed = Placed::new(&solid.placement);
    let [min, max] = match &solid.shape {
        Shape::Sphere { center, radius } => [*center - *radius, *center + *radius],
        Shape::Ellipsoid { center, radii } => [*center - *radii, *center + *radii],
        Shape::Box { min, max } | Shape::Quadric { min, max, .. } => [*min, *max],
        Shape::Cylinder { from, to, radius } => {
            let (frame, height) = placed.along(*from, *to);
            placed = frame;
            [DVec3::new(-radius, -radius, 0.0), DVec3::new(*radius, *radius, height)]
        }
        Shape::Cone { from, to, radius, tip } => {
            let (frame, height) = placed.along(*from, *to);
            placed = frame;
            let wide = radius.max(*tip);
            [DVec3::new(-wide, -wide, 0.0), DVec3::new(wide, wide, height)]
        }
        Shape::Torus { major, minor } => {
            let half = DVec3::new(major + minor, major + minor, *minor);
            [-half, half]
        }
        Shape::Prism { outline, bottom, top } => {
            let all = outline.iter().flatten();
            let [lo, hi] = all
                .fold([DVec2::INFINITY, DVec2::NEG_INFINITY], |[a, b], p| [a.min(*p), b.max(*p)]);
            [lo.extend(*bottom), hi.extend(*top)]
        }
        Shape::Polygon { points } => points
            .iter()
            .fold([DVec3::INFINITY, DVec3::NEG_INFINITY], |[a, b], p| [a.min(*p), b.max(*p)]),
        Shape::Plane { .. }
        | Shape::Mesh { .. }
        | Shape::Knot { .. }
        | Shape::Csg { .. }
        | Shape::Sphereflake { .. } => return None,
    };
    Some(box_corners([min, max], &placed))
}

/// The corners in world space of a box in a solid's own frame.
pub(super) fn box_corners([min, max]: [DVec3; 2], placed: &Placed) -> Vec<DVec3> {
    let corner = |i: u32| {
        let pick =
            |bit: u32, axis: fn(DVec3) -> f64| axis(if i >> bit & 1 == 0 { min } else { max });
        placed.point(DVec3::new(pick(0, |v| v.x), pick(1, |v| v.y), pick(2, |v| v.z)))
    };
    (0..8).map(corner).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quarter_turns_are_exact() {
        for (degrees, expected) in
            [(0.0, (0.0, 1.0)), (90.0, (1.0, 0.0)), (-90.0, (-1.0, 0.0)), (540.0, (0.0, -1.0))]
        {
            let (s, c) = sin_cos_degrees(degrees);
            assert_eq!((s + 0.0, c + 0.0), expected, "{degrees}°");
        }
        let (s, c) = sin_cos_degrees(30.0);
        assert!((s - 0.5).abs() < 1e-15 && (c - 0.75f64.sqrt()).abs() < 1e-15);
    }

    #[test]
    fn order_is_scale_x_y_z_translate() {
        let placed = Placed::new(&Placement {
            translate: DVec3::new(10.0, 0.0, 0.0),
            rotate_degrees: DVec3::new(90.0, 0.0, 90.0),
            scale: DVec3::new(1.0, 2.0, 3.0),
        });
        // y → 2y → 2z → 2z; x → x → y.
        assert_eq!(placed.point(DVec3::Y), DVec3::new(10.0, 0.0, 2.0));
        assert_eq!(placed.point(DVec3::X), DVec3::new(10.0, 1.0, 0.0));
        assert!(placed.keeps_axes());
        let (origin, direction) = placed.ray_to_object(DVec3::new(10.0, 1.0, 0.0), DVec3::Z);
        assert!((origin - DVec3::X).length() < 1e-15);
        assert!((direction - DVec3::new(0.0, 0.5, 0.0)).length() < 1e-15);
    }
}
