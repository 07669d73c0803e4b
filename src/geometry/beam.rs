//! A ray in the hierarchy's frame, in f32: where it may meet boxes.

use fearless_simd::{Simd, f64x4, prelude::*};
use glam::DVec3;

use super::Ray;
use super::hierarchy::Frame;
use super::lanes::{Floats, Lanes, Width};
use super::wide::Node;

/// Direction components are kept at least this far from zero: over the few units that a ray has in
/// the frame, the change is far below the boxes' padding.
const LEAST_COMPONENT: f64 = 1e-12;

/// Padding of the boxes relative to the coordinates: eight half ulps, more than all roundings of a
/// box test together.
const PADDING: f64 = 8.0 * (f32::EPSILON as f64 / 2.0);

/// The ray in the hierarchy's frame. Numbers that belong to axes are x, y, z and one of no meaning.
pub(super) struct Beam {
    /// The origin, moved along the ray to the surroundings of the scene, and the direction, of unit
    /// length up to rounding.
    line: [f32; 8],
    /// (origin ± padding) · reciprocal, for the nearer and the farther plane.
    planes: [f32; 8],
    /// Of the direction's components; then 1 + the sum of the origin's components: no coordinate met
    /// on the way is larger.
    others: [f32; 8],
    /// Per axis: which plane of a box is the nearer one.
    nearer: [usize; 3],
    /// By how much the origin was moved.
    start: f64,
    scale: f64,
    /// The `t` in the frame beyond which there is nothing.
    longest: f32,
}

impl Beam {
    /// A ray of the world, its direction of unit length.
    #[inline(always)]
    pub(super) fn new<S: Simd>(simd: S, frame: &Frame, ray: &Ray) -> Beam {
        let lanes = |v: DVec3| f64x4::load_array(simd, [v.x, v.y, v.z, 0.0]);
        let o = (lanes(ray.origin) - lanes(frame.center)) * frame.scale;
        let d = lanes(ray.direction);
        // The frame's content is within √3 < 2 of its origin: skip the way to the ball of radius 2.
        let start = (-(o * d).reduce_sum() - 2.0).max(0.0);
        let moved = o + d * start;
        let size = 1.0 + moved.abs().reduce_sum();
        // f64 roundings count once the origin is very far away.
        let far_away = o.abs().reduce_sum();
        let padding = PADDING * size + far_away * 1e-14;
        let r = f64x4::splat(simd, 1.0) / d.abs().max(LEAST_COMPONENT).copysign(d);
        let (at, margin) = (moved * r, r.abs() * padding);
        let backward = r.simd_lt(0.0).to_bitmask() as usize;
        let sizes = f64x4::splat(simd, size + far_away * 1e-9);
        Beam {
            line: moved.narrow(d).to_array(),
            planes: (at + margin).narrow(at - margin).to_array(),
            others: r.narrow(sizes).to_array(),
            nearer: [backward & 1, backward >> 1 & 1, backward >> 2 & 1],
            start,
            scale: frame.scale,
            longest: (2.0 * size + 4.0) as f32,
        }
    }

    /// A world `t` in the frame, rounded up.
    #[inline(always)]
    pub(super) fn limit(&self, t: f64) -> f32 {
        let local = (t * self.scale - self.start) as f32;
        let limit = local + (local.abs() * 1e-6 + 1e-30);
        if limit < self.longest { limit } else { self.longest }
    }

    /// The moved origin, in every lane.
    #[inline(always)]
    pub(super) fn origin<S: Simd, const N: usize>(&self, simd: S) -> [Floats<S, N>; 3]
    where
        Lanes<N>: Width,
    {
        let [x, y, z, ..] = self.line;
        splat(simd, [x, y, z])
    }

    /// The direction, in every lane.
    #[inline(always)]
    pub(super) fn direction<S: Simd, const N: usize>(&self, simd: S) -> [Floats<S, N>; 3]
    where
        Lanes<N>: Width,
    {
        let [.., x, y, z, _] = self.line;
        splat(simd, [x, y, z])
    }

    /// What no coordinate met on the way exceeds.
    #[inline(always)]
    pub(super) fn size(&self) -> f32 {
        self.others[4]
    }

    /// The children of a node that the ray may meet up to `limit`, and how far away each is at least.
    #[inline(always)]
    pub(super) fn meet<S: Simd, const N: usize>(
        &self,
        simd: S,
        node: &Node<N>,
        limit: Floats<S, N>,
    ) -> (u32, Floats<S, N>)
    where
        Lanes<N>: Width,
    {
        let ([x, y, z], [nx, ny, nz]) = (&node.bounds, self.nearer);
        let [ox, oy, oz, _, px, py, pz, _] = self.planes;
        let [rx, ry, rz, ..] = self.others;
        let [rx, ry, rz]: [Floats<S, N>; 3] = splat(simd, [rx, ry, rz]);
        let at = |plane, r: Floats<S, N>, o: f32| {
            Floats::<S, N>::from_slice(simd, plane).mul_sub(r, Floats::<S, N>::splat(simd, o))
        };
        let (near_x, far_x) = (at(&x[nx & 1], rx, ox), at(&x[!nx & 1], rx, px));
        let (near_y, far_y) = (at(&y[ny & 1], ry, oy), at(&y[!ny & 1], ry, py));
        let (near_z, far_z) = (at(&z[nz & 1], rz, oz), at(&z[!nz & 1], rz, pz));
        let near = near_x.max(near_y).max(near_z.max(0.0));
        let far = far_x.min(far_y).min(far_z.min(limit));
        (near.simd_le(far).to_bitmask() as u32, near)
    }
}

#[inline(always)]
fn splat<S: Simd, const N: usize>(simd: S, numbers: [f32; 3]) -> [Floats<S, N>; 3]
where
    Lanes<N>: Width,
{
    numbers.map(|x| Floats::<S, N>::splat(simd, x))
}
