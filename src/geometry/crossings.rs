//! Where a whole line is inside a solid: sorted crossings, as solids made of others need them.
//!
//! Every form appends the `t` at which the line enters the solid (even places) and leaves it (odd
//! places), sorted, −∞ and ∞ included: their number is even by construction. The direction may have
//! any length but zero. A ray that starts on the surface has one of them at exactly 0: where it
//! enters if it goes [inside](Start::Inside), where it leaves if it goes outside.

use glam::DVec3;

use super::Ray;
use super::primitive::{Form, Plane, Sphere, Start, cuboid_faces, sphere_roots};

impl Sphere {
    /// See the [module](self).
    pub(super) fn crossings(
        &self,
        origin: DVec3,
        direction: DVec3,
        start: Start,
        out: &mut Vec<f64>,
    ) {
        ball(origin - self.center, direction, self.radius, start, out);
    }
}

impl Plane {
    /// See the [module](self). A line in the boundary plane itself is inside.
    pub(super) fn crossings(
        &self,
        origin: DVec3,
        direction: DVec3,
        start: Start,
        out: &mut Vec<f64>,
    ) {
        let (height, climb) = (self.offset - self.normal.dot(origin), self.normal.dot(direction));
        let t = height / climb;
        out.extend(match start {
            Start::Inside => [0.0, f64::INFINITY],
            Start::Outside => [f64::NEG_INFINITY, 0.0],
            Start::Elsewhere if climb < 0.0 => [t, f64::INFINITY],
            Start::Elsewhere if climb > 0.0 => [f64::NEG_INFINITY, t],
            Start::Elsewhere if height >= 0.0 => [f64::NEG_INFINITY, f64::INFINITY],
            Start::Elsewhere => return,
        });
    }
}

impl Form {
    /// See the [module](self); a surface without thickness has none.
    pub(super) fn crossings(
        &self,
        origin: DVec3,
        direction: DVec3,
        start: Start,
        out: &mut Vec<f64>,
    ) {
        match self {
            Form::Cuboid(corners) => cuboid(origin, direction, corners, start, out),
            Form::PlacedCuboid(placed, corners) => {
                let (origin, direction) = placed.ray_to_object(origin, direction);
                cuboid(origin, direction, corners, start, out);
            }
            Form::Ellipsoid(placed, center, radius) => {
                let (origin, direction) = placed.ray_to_object(origin, direction);
                ball(origin - center, direction, *radius, start, out);
            }
            Form::Closed(closed) => closed.crossings(&Ray { origin, direction }, start, out),
            Form::Polygon(..) | Form::Moving(_) | Form::Composite(_) => {}
        }
    }
}

/// The two crossings of a convex solid, of which a ray that starts on it knows one.
fn convex(near: f64, far: f64, start: Start, out: &mut Vec<f64>) {
    match start {
        Start::Elsewhere if near <= far => out.extend([near, far]),
        Start::Elsewhere => {}
        Start::Inside => out.extend([0.0, far.max(0.0)]),
        Start::Outside => out.extend([near.min(0.0), 0.0]),
    }
}

fn ball(o: DVec3, d: DVec3, radius: f64, start: Start, out: &mut Vec<f64>) {
    let a = d.length_squared();
    if start == Start::Elsewhere {
        let roots = sphere_roots(o, d, a, radius, start);
        convex(roots.near, roots.far, start, out);
    } else {
        // One root is 0, the other opposite to it about the middle of the chord.
        let other = -2.0 * (o.dot(d) / a);
        convex(other, other, start, out);
    }
}

fn cuboid(o: DVec3, d: DVec3, corners: &[DVec3; 2], start: Start, out: &mut Vec<f64>) {
    let (near, far) = cuboid_faces(o, d, corners);
    convex(near.0, far.0, start, out);
}
