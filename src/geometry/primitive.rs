//! What a ray can hit, and where it hits it: decided in f64 from the original numbers.
//!
//! Every test is scale-covariant: no constant has a length in it, so a scene scaled by a power of
//! two gives the same bits. Sphere: the discriminant
//! from the chord's distance to the centre (Haines, Günther, Akenine-Möller, *Ray Tracing Gems*, ch. 7).

use glam::DVec3;

use super::Ray;
use super::closed::Closed;
use super::placement::Placed;
use super::shear::{Corner, Shear, point};

/// How the ray stands to the primitive that is asked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Start {
    /// It starts elsewhere.
    Elsewhere,
    /// It starts on its surface and goes outside.
    Outside,
    /// It starts on its surface and goes inside.
    Inside,
}

/// Where a line meets a convex solid, `near ≤ far`; NaN: not there.
#[derive(Clone, Copy, Debug)]
pub(super) struct Roots {
    /// Entry.
    pub(super) near: f64,
    /// Exit.
    pub(super) far: f64,
}

impl Roots {
    /// No meeting at all.
    pub(super) const NONE: Roots = Roots { near: f64::NAN, far: f64::NAN };

    /// A surface without thickness.
    #[inline(always)]
    pub(super) fn one(t: f64) -> Roots {
        Roots { near: t, far: f64::NAN }
    }
}

/// A sphere in world space.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sphere {
    /// Centre.
    pub(super) center: DVec3,
    /// Radius, > 0.
    pub(super) radius: f64,
    /// Its number among all primitives.
    pub(super) primitive: u32,
}

/// The half-space `normal · p ≤ offset`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Plane {
    /// Unit, out of the solid.
    pub(super) normal: DVec3,
    /// Of the plane from the origin, along the normal.
    pub(super) offset: f64,
    /// Its number among all primitives.
    pub(super) primitive: u32,
}

/// A solid or surface that is neither sphere, plane nor triangle.
#[derive(Clone, Debug)]
pub(super) struct Shape {
    /// What it is.
    pub(super) form: Form,
    /// Its number among all primitives.
    pub(super) primitive: u32,
}

/// The rarer forms.
#[derive(Clone, Debug)]
pub(super) enum Form {
    /// An axis-parallel box in world space.
    Cuboid([DVec3; 2]),
    /// A box in object space: lowest and highest corner.
    PlacedCuboid(Box<Placed>, [DVec3; 2]),
    /// A sphere in object space that the placement stretches: centre and radius.
    Ellipsoid(Box<Placed>, DVec3, f64),
    /// A flat polygon in world space, with its unit normal.
    Polygon(Box<[Corner]>, DVec3),
    /// One of the solids with a frame and functions of their own.
    Closed(Box<Closed>),
    /// All of the solid with this index among those that move, which has primitives of its own.
    Moving(u32),
    /// All of the one with this index among those made of others.
    Composite(u32),
}

impl Sphere {
    /// Entry and exit of the ray; the direction is of unit length.
    #[inline(always)]
    pub(super) fn roots(&self, ray: &Ray, start: Start) -> Roots {
        sphere_roots(ray.origin - self.center, ray.direction, 1.0, self.radius, start)
    }
}

/// Roots of |o + t·d| = r for a direction of squared length `a`.
///
/// The discriminant is taken from the perpendicular distance l of the centre, once re-orthogonalised,
/// and factored; the smaller root from c/q with c factored: position error ≈ ε·distance, for far
/// spheres as for huge ones.
#[inline(always)]
pub(super) fn sphere_roots(o: DVec3, d: DVec3, a: f64, r: f64, start: Start) -> Roots {
    let b = o.dot(d);
    match start {
        Start::Outside => return Roots::NONE,
        Start::Inside => return Roots { near: f64::NAN, far: -2.0 * (b / a) },
        Start::Elsewhere => {}
    }
    let l = o - d * (b / a);
    let l = l - d * (l.dot(d) / a);
    let distance = l.length_squared().sqrt();
    if distance > r {
        return Roots::NONE;
    }
    let root = ((r + distance) * (r - distance) * a).sqrt();
    let outer = o.length_squared().sqrt();
    let c = (outer - r) * (outer + r);
    let q = if b > 0.0 { -b - root } else { root - b };
    let (t0, t1) = (c / q, q / a);
    if b > 0.0 { Roots { near: t1, far: t0 } } else { Roots { near: t0, far: t1 } }
}

impl Plane {
    /// Where the ray meets the plane, from either side.
    #[inline(always)]
    pub(super) fn root(&self, ray: &Ray, start: Start) -> f64 {
        if start != Start::Elsewhere {
            return f64::NAN;
        }
        (self.offset - self.normal.dot(ray.origin)) / self.normal.dot(ray.direction)
    }
}

impl Form {
    /// Entry and exit, or the one crossing of a surface.
    #[inline(always)]
    pub(super) fn roots(&self, ray: &Ray, start: Start) -> Roots {
        if start == Start::Outside {
            return Roots::NONE;
        }
        match self {
            Form::Cuboid(corners) => cuboid_roots(ray.origin, ray.direction, corners, start),
            Form::PlacedCuboid(placed, corners) => {
                let (origin, direction) = placed.ray_to_object(ray.origin, ray.direction);
                cuboid_roots(origin, direction, corners, start)
            }
            Form::Ellipsoid(placed, center, radius) => {
                let (origin, d) = placed.ray_to_object(ray.origin, ray.direction);
                sphere_roots(origin - center, d, d.length_squared(), *radius, start)
            }
            Form::Polygon(corners, normal) => match start {
                Start::Elsewhere => polygon_root(ray, corners, *normal),
                Start::Outside | Start::Inside => Roots::NONE,
            },
            // They meet rays themselves.
            Form::Closed(_) | Form::Moving(_) | Form::Composite(_) => Roots::NONE,
        }
    }
}

#[inline(always)]
fn polygon_root(ray: &Ray, corners: &[Corner], normal: DVec3) -> Roots {
    if !Shear::new(ray).polygon(corners) {
        return Roots::NONE;
    }
    let t = normal.dot(point(&corners[0]) - ray.origin) / normal.dot(ray.direction);
    if t.is_finite() { Roots::one(t) } else { Roots::NONE }
}

/// Entry and exit of a box. A ray that runs in a face or touches an edge meets the box, which is
/// closed; entry and exit may then be equal.
#[inline(always)]
fn cuboid_roots(o: DVec3, d: DVec3, corners: &[DVec3; 2], start: Start) -> Roots {
    let (near, far) = cuboid_faces(o, d, corners);
    match start {
        Start::Inside => Roots { near: f64::NAN, far: far.0 },
        _ if near.0 <= far.0 => Roots { near: near.0, far: far.0 },
        _ => Roots::NONE,
    }
}

/// `t` and axis of the last plane entered and of the first one left; the lowest axis if two are equal.
#[inline(always)]
pub(super) fn cuboid_faces(
    o: DVec3,
    d: DVec3,
    [min, max]: &[DVec3; 2],
) -> ((f64, usize), (f64, usize)) {
    let (o, d, min, max) = (o.to_array(), d.to_array(), min.to_array(), max.to_array());
    let (mut near, mut far) = ((f64::NEG_INFINITY, 0), (f64::INFINITY, 0));
    for axis in 0..3 {
        if d[axis] == 0.0 {
            if o[axis] < min[axis] || o[axis] > max[axis] {
                near.0 = f64::INFINITY;
                far.0 = f64::NEG_INFINITY;
            }
            continue;
        }
        let (first, last) =
            if d[axis] > 0.0 { (min[axis], max[axis]) } else { (max[axis], min[axis]) };
        let (enter, leave) = ((first - o[axis]) / d[axis], (last - o[axis]) / d[axis]);
        if enter > near.0 {
            near = (enter, axis);
        }
        if leave < far.0 {
            far = (leave, axis);
        }
    }
    (near, far)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quadrics_far_small_sphere() {
        // A unit sphere from 1e6 away: the textbook form is wrong by 5e-5.
        for distance in [1e2, 1e4, 1e6, 1e8] {
            for offset in [0.0, 0.5, 0.999, 1.001] {
                let o = DVec3::new(offset, 0.0, -distance);
                let roots = sphere_roots(o, DVec3::Z, 1.0, 1.0, Start::Elsewhere);
                let half = (1.0f64 - offset * offset).sqrt();
                assert_eq!(roots.near.is_nan(), offset > 1.0);
                if offset < 1.0 {
                    let bound = 4.0 * f64::EPSILON * distance;
                    assert!((roots.near - (distance - half)).abs() <= bound);
                    assert!((roots.far - (distance + half)).abs() <= bound);
                }
            }
        }
    }

    #[test]
    fn quadrics_huge_sphere_from_just_above() {
        // Height 1 over a sphere of radius 1e6, straight down and slanted.
        let (r, h) = (1e6, 1.0);
        let o = DVec3::new(0.0, 0.0, r + h);
        let down = sphere_roots(o, DVec3::NEG_Z, 1.0, r, Start::Elsewhere);
        assert!((down.near - h).abs() <= 16.0 * f64::EPSILON);
        let d = DVec3::new(0.6, 0.0, -0.8);
        let slanted = sphere_roots(o, d, d.length_squared(), r, Start::Elsewhere);
        // t = (h² + 2 r h)/(B + √(B² − (h² + 2 r h))), B = 0.8 (r + h)
        let (c, b) = (h * h + 2.0 * r * h, 0.8 * (r + h));
        let truth = c / (b + (b * b - c).sqrt());
        assert!((slanted.near - truth).abs() <= 16.0 * f64::EPSILON * truth);
    }

    #[test]
    fn acne_from_the_surface_only_the_far_root() {
        let o = DVec3::new(0.0, 0.0, -2.0);
        let d = DVec3::new(0.6, 0.0, 0.8);
        assert!(sphere_roots(o, d, 1.0, 2.0, Start::Outside).far.is_nan());
        let far = sphere_roots(o, d, 1.0, 2.0, Start::Inside).far;
        assert!(((o + d * far).length() - 2.0).abs() < 1e-15);
    }

    #[test]
    fn quadrics_boxes_meet_rays_in_their_faces() {
        let corners = [DVec3::ZERO, DVec3::ONE];
        for zero in [0.0, -0.0] {
            for y in [0.0, 0.5, 1.0] {
                let o = DVec3::new(-1.0, y, 1.0);
                let roots =
                    cuboid_roots(o, DVec3::new(1.0, zero, zero), &corners, Start::Elsewhere);
                assert_eq!((roots.near, roots.far), (1.0, 2.0));
            }
            let o = DVec3::new(-1.0, 1.0 + f64::EPSILON, 0.0);
            let roots = cuboid_roots(o, DVec3::new(1.0, zero, zero), &corners, Start::Elsewhere);
            assert!(roots.near.is_nan());
        }
        let inside = cuboid_roots(DVec3::splat(0.5), DVec3::X, &corners, Start::Elsewhere);
        assert_eq!((inside.near, inside.far), (-0.5, 0.5));
    }
}
