//! Leaves: up to eight or sixteen primitives of one kind, in f32, to leave out what a ray surely misses.
//!
//! The tests here may keep too much but never drop a hit: every rounding, of the stored numbers, of
//! the ray and of the arithmetic, is covered by a margin per lane, whether or not a processor fuses
//! multiplications and additions. What they keep is decided in f64.

use fearless_simd::{Simd, prelude::*};

use super::beam::Beam;
use super::compile::Primitives;
use super::hierarchy::Frame;
use super::lanes::{Floats, Lanes, Width};
use super::shear::point;

/// Half an ulp of 1 in f32, times sixteen: more than twice the sum of all roundings in a test.
const MARGIN: f32 = 16.0 * (f32::EPSILON / 2.0);

/// Spheres; unused lanes are NaN, which no test keeps.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(super) struct SpherePacket<const N: usize> {
    center: [[f32; N]; 3],
    radius: [f32; N],
    /// Into `Primitives::spheres`.
    pub(super) items: [u32; N],
}

/// Triangles; unused lanes are NaN, which no test keeps.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(super) struct TrianglePacket<const N: usize> {
    corner: [[f32; N]; 3],
    edges: [[[f32; N]; 3]; 2],
    /// Sum of all edge components, times the margin.
    margin: [f32; N],
    /// Sum of all edge components.
    size: [f32; N],
    /// Into `Primitives::triangles`.
    pub(super) items: [u32; N],
}

/// Other shapes.
#[derive(Clone, Copy, Debug)]
pub(super) struct ShapePacket<const N: usize> {
    items: [u32; N],
    count: u32,
}

/// All leaves.
#[derive(Debug, Default)]
pub(super) struct Packets<const N: usize> {
    pub(super) spheres: Vec<SpherePacket<N>>,
    pub(super) triangles: Vec<TrianglePacket<N>>,
    pub(super) shapes: Vec<ShapePacket<N>>,
}

impl<const N: usize> Packets<N> {
    /// Memory held, in bytes.
    pub(super) fn bytes(&self) -> usize {
        size_of_val(&*self.spheres) + size_of_val(&*self.triangles) + size_of_val(&*self.shapes)
    }

    /// A leaf of spheres; returns its index.
    pub(super) fn add_spheres(
        &mut self,
        frame: &Frame,
        all: &Primitives,
        items: impl Iterator<Item = u32>,
    ) -> usize {
        let nan = [f32::NAN; N];
        let mut packet = SpherePacket { center: [nan; 3], radius: nan, items: [0; N] };
        for (k, item) in items.enumerate() {
            let sphere = &all.spheres[item as usize];
            let center = frame.local(sphere.center).to_array();
            for (lanes, x) in packet.center.iter_mut().zip(center) {
                lanes[k] = x as f32;
            }
            packet.radius[k] = ((sphere.radius * frame.scale) as f32).next_up();
            packet.items[k] = item;
        }
        self.spheres.push(packet);
        self.spheres.len() - 1
    }

    /// A leaf of triangles; returns its index.
    pub(super) fn add_triangles(
        &mut self,
        frame: &Frame,
        all: &Primitives,
        items: impl Iterator<Item = u32>,
    ) -> usize {
        let nan = [f32::NAN; N];
        let mut packet = TrianglePacket {
            corner: [nan; 3],
            edges: [[nan; 3]; 2],
            margin: nan,
            size: nan,
            items: [0; N],
        };
        for (k, item) in items.enumerate() {
            let corners = all.triangle_corners(&all.triangles[item as usize]);
            let [a, b, c] = corners.map(|c| frame.local(point(c)));
            let mut size = 0.0;
            for axis in 0..3 {
                packet.corner[axis][k] = a[axis] as f32;
                for (edge, end) in [b, c].into_iter().enumerate() {
                    packet.edges[edge][axis][k] = (end[axis] - a[axis]) as f32;
                    size += (end[axis] - a[axis]).abs();
                }
            }
            packet.size[k] = (size as f32).next_up();
            packet.margin[k] = MARGIN * packet.size[k];
            packet.items[k] = item;
        }
        self.triangles.push(packet);
        self.triangles.len() - 1
    }

    /// A leaf of other shapes; returns its index.
    pub(super) fn add_shapes(&mut self, items: impl Iterator<Item = u32>) -> usize {
        let mut packet = ShapePacket { items: [0; N], count: 0 };
        for (k, item) in items.enumerate() {
            packet.items[k] = item;
            packet.count += 1;
        }
        self.shapes.push(packet);
        self.shapes.len() - 1
    }
}

impl<const N: usize> ShapePacket<N> {
    /// Indices into `Primitives::shapes`.
    #[inline(always)]
    pub(super) fn items(&self) -> &[u32] {
        self.items.get(..self.count as usize).unwrap_or(&[])
    }
}

impl<const N: usize> SpherePacket<N>
where
    Lanes<N>: Width,
{
    /// A bit for every sphere that the beam may meet up to `limit`.
    #[inline(always)]
    pub(super) fn candidates<S: Simd>(&self, simd: S, beam: &Beam, limit: Floats<S, N>) -> u32 {
        let [x, y, z] = load3(simd, &self.center);
        let [ox, oy, oz] = beam.origin(simd);
        let (x, y, z) = (x - ox, y - oy, z - oz);
        let [dx, dy, dz] = beam.direction(simd);
        let along = x.mul_add(dx, y.mul_add(dy, z * dz));
        // From the centre to the line.
        let (lx, ly, lz) = (along.mul_sub(dx, x), along.mul_sub(dy, y), along.mul_sub(dz, z));
        let off2 = lx.mul_add(lx, ly.mul_add(ly, lz * lz));
        let radius = load(simd, &self.radius);
        // Error of any position or distance above: the ray's, the centre's, and the arithmetic's.
        let error = (x.abs() + y.abs() + z.abs() + radius + beam.size()) * MARGIN;
        let reach = radius + error;
        let half2 = reach.mul_sub(reach, off2);
        // The entry is no nearer than along − √half2 − error, the exit no farther than along + reach.
        let beyond = along - limit - error;
        let zero = Floats::<S, N>::splat(simd, 0.0);
        let near_enough = beyond.simd_le(zero) | (beyond * beyond).simd_le(half2);
        let hit = half2.simd_ge(zero) & (along + reach + error).simd_ge(zero) & near_enough;
        hit.to_bitmask() as u32
    }
}

impl<const N: usize> TrianglePacket<N>
where
    Lanes<N>: Width,
{
    /// A bit for every lane that holds a triangle.
    #[inline(always)]
    pub(super) fn lanes_of<S: Simd>(&self, simd: S, item: u32) -> u32 {
        <Floats<S, N> as SimdFloat<S>>::Bits::from_slice(simd, &self.items)
            .simd_eq(item)
            .to_bitmask() as u32
    }

    /// A bit for every triangle that the beam may meet up to `limit` (Möller and Trumbore's numbers,
    /// undivided).
    #[inline(always)]
    pub(super) fn candidates<S: Simd>(&self, simd: S, beam: &Beam, limit: Floats<S, N>) -> u32 {
        let ([dx, dy, dz], [ox, oy, oz]) = (beam.direction(simd), beam.origin(simd));
        let [cx, cy, cz] = load3(simd, &self.corner);
        let (ax, ay, az) = (ox - cx, oy - cy, oz - cz);
        let [px, py, pz] = load3(simd, &self.edges[0]);
        let [qx, qy, qz] = load3(simd, &self.edges[1]);
        // d × q, a × p
        let [ex, ey, ez] = cross([dx, dy, dz], [qx, qy, qz]);
        let [fx, fy, fz] = cross([ax, ay, az], [px, py, pz]);
        let det = px.mul_add(ex, py.mul_add(ey, pz * ez));
        let u = by_sign(ax.mul_add(ex, ay.mul_add(ey, az * ez)), det);
        let v = by_sign(dx.mul_add(fx, dy.mul_add(fy, dz * fz)), det);
        let t = by_sign(qx.mul_add(fx, qy.mul_add(fy, qz * fz)), det);
        let det = det.abs();
        let error = load(simd, &self.margin) * (ax.abs() + ay.abs() + az.abs() + beam.size());
        let t_error = error * load(simd, &self.size);
        let zero = Floats::<S, N>::splat(simd, 0.0);
        let low = zero - error;
        let inside = u.simd_ge(low) & v.simd_ge(low) & (u + v).simd_le(det + error);
        let in_reach = t.simd_ge(zero - t_error) & t.simd_le(limit.mul_add(det + error, t_error));
        (inside & in_reach).to_bitmask() as u32
    }
}

#[inline(always)]
fn load<S: Simd, const N: usize>(simd: S, lanes: &[f32; N]) -> Floats<S, N>
where
    Lanes<N>: Width,
{
    Floats::<S, N>::from_slice(simd, lanes)
}

#[inline(always)]
fn load3<S: Simd, const N: usize>(simd: S, lanes: &[[f32; N]; 3]) -> [Floats<S, N>; 3]
where
    Lanes<N>: Width,
{
    [load(simd, &lanes[0]), load(simd, &lanes[1]), load(simd, &lanes[2])]
}

#[inline(always)]
fn cross<S: Simd, F: SimdFloat<S, Element = f32>>(
    [ax, ay, az]: [F; 3],
    [bx, by, bz]: [F; 3],
) -> [F; 3] {
    [ay.mul_sub(bz, az * by), az.mul_sub(bx, ax * bz), ax.mul_sub(by, ay * bx)]
}

/// A number multiplied by the sign of another.
#[inline(always)]
fn by_sign<S: Simd, F: SimdFloat<S, Element = f32>>(number: F, sign: F) -> F {
    F::from_bits(number.to_bits() ^ (sign.to_bits() & (1 << 31)))
}
