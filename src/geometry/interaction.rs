//! The surface at a hit, rebuilt from ray and primitive where it is used.

use glam::DVec3;

use super::compile::{Compiled, Kind, NO_NORMAL, Primitives};
use super::primitive::{Form, Plane, Sphere, cuboid_faces};
use super::shear::{Crossing, Shear, point};
use super::{Geometry, Hit, Interaction, Ray, Stack};

/// Point, geometric normal and, if it differs, a shading normal of any length and side.
pub(super) type Surface = (DVec3, DVec3, Option<DVec3>);

impl Geometry {
    /// The surface at a hit of this geometry by this ray, at the time that the stack is set to.
    #[inline(always)]
    pub fn interaction(&self, stack: &Stack, ray: &Ray, hit: Hit) -> Interaction {
        let all = &self.primitives;
        let solid = all.solid(hit.primitive);
        let mut body = all.solid_index(hit.primitive);
        let ((point, geometric_normal, smooth), rest) = match solid.item.kind {
            Kind::Moving => {
                let index = solid.item.index;
                let moving = &all.moving[index as usize];
                let (surface, rest) = moving.surface(index, &stack.moment, ray, hit);
                (in_registers(surface), rest)
            }
            Kind::Leaf => {
                let (whole, leaf) = all.leaf(hit.primitive);
                body = whole.solid;
                leaf.surface(stack.time(), ray, hit)
            }
            _ => {
                let surface = all.surface(solid, ray, hit);
                (surface, surface.0)
            }
        };
        let shading_normal =
            smooth.and_then(|n| on_side_of(geometric_normal, n)).unwrap_or(geometric_normal);
        let solid_index = all.solid_index(hit.primitive);
        let material = self.surfaces.materials[solid_index as usize];
        let checker = self.surfaces.checker_sizes[material as usize];
        Interaction {
            point,
            geometric_normal,
            shading_normal,
            solid: solid_index,
            body,
            material,
            rest,
            slot: checker.map_or(0, |size| checker_slot(rest, size)),
            bumped: false,
            thin: solid.thin,
            primitive: hit.primitive,
        }
    }
}

/// A surface that comes from a call, piece by piece: else every surface would be passed in memory.
#[inline(always)]
fn in_registers((point, normal, smooth): Surface) -> Surface {
    (point, normal, smooth)
}

/// The slot of the world-space cube that a point lies in; a point on a cube's boundary belongs to
/// the upper cube.
///
/// A surface that holds a coordinate constant holds it exactly in [`Interaction::point`], so a floor
/// on the boundary of two layers of cubes shows the upper layer everywhere, without speckles.
fn checker_slot(point: DVec3, size: f64) -> u8 {
    let cell = (point / size).floor();
    let odd = |x: f64| x.rem_euclid(2.0) == 1.0;
    u8::from(odd(cell.x) ^ odd(cell.y) ^ odd(cell.z))
}

/// `n` as a unit vector on the side of `geometric`; `None` if it has no side.
#[inline(always)]
fn on_side_of(geometric: DVec3, n: DVec3) -> Option<DVec3> {
    let n = unit(n)?;
    let side = n.dot(geometric);
    if side > 0.0 {
        Some(n)
    } else if side < 0.0 {
        Some(-n)
    } else {
        None
    }
}

/// `v` at unit length, if it has a direction that f64 can square.
#[inline(always)]
fn unit(v: DVec3) -> Option<DVec3> {
    let length2 = v.length_squared();
    (length2 > 0.0 && length2 < f64::INFINITY).then_some(v / length2.sqrt())
}

#[inline(always)]
fn sphere_surface(sphere: &Sphere, ray: &Ray, t: f64) -> Surface {
    let out = (ray.origin - sphere.center) + ray.direction * t;
    let normal = out / out.length_squared().sqrt();
    (sphere.center + normal * sphere.radius, normal, None)
}

#[inline(always)]
fn plane_surface(plane: &Plane, ray: &Ray, t: f64) -> Surface {
    let point = ray.origin + ray.direction * t;
    let n = plane.normal;
    (snap(point - n * (n.dot(point) - plane.offset), n, n * plane.offset), n, None)
}

/// `point` with the coordinate of `on_plane` along `normal`, if that is exactly an axis.
#[inline(always)]
fn snap(point: DVec3, normal: DVec3, on_plane: DVec3) -> DVec3 {
    DVec3::select(normal.abs().cmpeq(DVec3::ONE), on_plane, point)
}

#[inline(always)]
fn triangle_surface(all: &Primitives, index: usize, ray: &Ray, t: f64) -> Surface {
    let triangle = &all.triangles[index];
    let corners = all.triangle_corners(triangle);
    let (a, b, c) = (point(corners[0]), point(corners[1]), point(corners[2]));
    let (e1, e2) = (b - a, c - a);
    let normal = unit(e1.cross(e2)).unwrap_or(-ray.direction);
    let Some(Crossing { weights: [wa, wb, wc], .. }) = Shear::new(ray).triangle(corners) else {
        return (ray.origin + ray.direction * t, normal, None);
    };
    let at = snap(a + (e1 * wb + e2 * wc), normal, a);
    let normals = all.triangle_normals[index];
    if normals[0] == NO_NORMAL {
        return (at, normal, None);
    }
    let [na, nb, nc] = normals;
    let (na, nb, nc) =
        (all.normals[na as usize], all.normals[nb as usize], all.normals[nc as usize]);
    (at, normal, Some(na * wa + nb * wb + nc * wc))
}

fn form_surface(form: &Form, ray: &Ray, t: f64) -> Surface {
    match form {
        Form::Cuboid(corners) => {
            let (point, normal) = cuboid_surface(ray.origin, ray.direction, corners, t);
            (point, normal, None)
        }
        Form::PlacedCuboid(placed, corners) => {
            let (origin, direction) = placed.ray_to_object(ray.origin, ray.direction);
            let (point, normal) = cuboid_surface(origin, direction, corners, t);
            (placed.point(point), placed.normal(normal).normalize(), None)
        }
        Form::Ellipsoid(placed, center, radius) => {
            let (origin, direction) = placed.ray_to_object(ray.origin, ray.direction);
            let out = ((origin - center) + direction * t).normalize();
            (placed.point(center + out * *radius), placed.normal(out).normalize(), None)
        }
        Form::Polygon(corners, normal) => {
            let on_plane = point(&corners[0]);
            let from_corner = (ray.origin - on_plane) + ray.direction * t;
            let at = on_plane + (from_corner - *normal * normal.dot(from_corner));
            (snap(at, *normal, on_plane), *normal, None)
        }
        Form::Closed(closed) => {
            let (point, normal) = closed.surface(ray, t);
            (point, normal, None)
        }
        Form::Moving(_) | Form::Composite(_) => unreachable!("it has primitives of its own"),
    }
}

/// Point and outward normal of the face that the ray meets at `t`, both in the box's space.
pub(super) fn cuboid_surface(o: DVec3, d: DVec3, corners: &[DVec3; 2], t: f64) -> (DVec3, DVec3) {
    let (near, far) = cuboid_faces(o, d, corners);
    let [min, max] = *corners;
    let (axis, entering) = if t == near.0 { (near.1, true) } else { (far.1, false) };
    let upper = (d.to_array()[axis] > 0.0) != entering;
    let mut point = (o + d * t).clamp(min, max).to_array();
    point[axis] = if upper { max.to_array()[axis] } else { min.to_array()[axis] };
    let mut normal = [0.0; 3];
    normal[axis] = if upper { 1.0 } else { -1.0 };
    (point.into(), normal.into())
}

impl Primitives {
    /// The surface of a solid that does not move.
    #[inline(always)]
    pub(super) fn surface(&self, solid: &Compiled, ray: &Ray, hit: Hit) -> Surface {
        let index = (solid.item.index + (hit.primitive - solid.first)) as usize;
        match solid.item.kind {
            Kind::Sphere => sphere_surface(&self.spheres[index], ray, hit.t),
            Kind::Triangle => triangle_surface(self, index, ray, hit.t),
            Kind::Shape => in_registers(form_surface(&self.shapes[index].form, ray, hit.t)),
            Kind::Plane => plane_surface(&self.planes[index], ray, hit.t),
            Kind::Moving | Kind::Leaf => unreachable!("it has primitives of its own"),
        }
    }

    /// Whether a hit of the triangle `met`, by a ray that starts on the triangle `left` of the same
    /// mesh and goes to its `inside` or outside, is only the rounding of the ray's origin.
    ///
    /// It is if the triangle lies wholly on or behind the plane that the ray leaves. It also is if
    /// the origin lies on the triangle's plane as far as f64 can tell, and the triangle is met from
    /// the wrong side: a ray outside of a closed mesh cannot leave it, one inside cannot enter it. A
    /// mesh that is not closed has no sides; there the origin's place decides. Other solids are
    /// never taken for noise, however close they are. `slack` is what the origin may be off besides.
    #[cold]
    #[inline(never)]
    pub(super) fn is_departure_noise(
        &self,
        (ray, slack): (&Ray, f64),
        [left, met]: [usize; 2],
        inside: bool,
        closed: bool,
    ) -> bool {
        let corners = |index: usize| self.triangle_corners(&self.triangles[index]).map(point);
        let size = |v: DVec3| v.abs().element_sum();
        let [p, q, r] = corners(left);
        let left_size = size(q - p) + size(r - p);
        let met = corners(met);
        let ahead = (q - p).cross(r - p) * if inside { -1.0 } else { 1.0 };
        let is_behind = |v: DVec3| {
            ahead.dot(v - p) <= size(v - p) * left_size * left_size * (2.0 * f64::EPSILON)
        };
        if met.into_iter().all(is_behind) {
            return true;
        }
        let [a, b, c] = met;
        let (e1, e2, to_corner) = (b - a, c - a, a - ray.origin);
        let normal = e1.cross(e2);
        let facing = normal.dot(ray.direction);
        if closed && (if inside { facing > 0.0 } else { facing < 0.0 }) {
            return false;
        }
        // The origin was rounded once per coordinate, after sums over the edges it was taken from;
        // the factors 2 and 4 beyond half an ulp are margin.
        let rounding = left_size * (4.0 * f64::EPSILON) + slack;
        let origin_error = ray.origin.abs() * f64::EPSILON + rounding;
        let own_error = size(e1) * size(e2) * size(to_corner) * (4.0 * f64::EPSILON);
        normal.dot(to_corner).abs() <= normal.abs().dot(origin_error) + own_error
    }
}
