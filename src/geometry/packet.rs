//! Leaves: up to eight primitives of one kind, in f32, to leave out what a ray surely misses.
//!
//! The tests here may keep too much but never drop a hit: every rounding, of the stored numbers, of
//! the ray and of the arithmetic, is covered by a margin per lane. What they keep is decided in f64.

use fearless_simd::{Simd, f32x8, prelude::*, u32x8};

use super::compile::Primitives;
use super::hierarchy::Frame;
use super::shear::point;
use super::traverse::Beam;

/// Lanes of a node or leaf.
pub(super) const WIDTH: usize = 8;

/// Half an ulp of 1 in f32, times sixteen: more than twice the sum of all roundings in a test.
const MARGIN: f32 = 16.0 * (f32::EPSILON / 2.0);

/// Eight spheres; unused lanes are NaN, which no test keeps.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(super) struct SpherePacket {
    center: [[f32; WIDTH]; 3],
    radius: [f32; WIDTH],
    /// Into `Primitives::spheres`.
    pub(super) items: [u32; WIDTH],
}

/// Eight triangles; unused lanes are NaN, which no test keeps.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(super) struct TrianglePacket {
    corner: [[f32; WIDTH]; 3],
    edges: [[[f32; WIDTH]; 3]; 2],
    /// Sum of all edge components, times the margin.
    margin: [f32; WIDTH],
    /// Sum of all edge components.
    size: [f32; WIDTH],
    /// Into `Primitives::triangles`.
    pub(super) items: [u32; WIDTH],
}

/// Up to eight other shapes.
#[derive(Clone, Copy, Debug)]
pub(super) struct ShapePacket {
    items: [u32; WIDTH],
    count: u32,
}

/// All leaves.
#[derive(Debug, Default)]
pub(super) struct Packets {
    pub(super) spheres: Vec<SpherePacket>,
    pub(super) triangles: Vec<TrianglePacket>,
    pub(super) shapes: Vec<ShapePacket>,
}

impl Packets {
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
        let nan = [f32::NAN; WIDTH];
        let mut packet = SpherePacket { center: [nan; 3], radius: nan, items: [0; WIDTH] };
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
        let nan = [f32::NAN; WIDTH];
        let mut packet = TrianglePacket {
            corner: [nan; 3],
            edges: [[nan; 3]; 2],
            margin: nan,
            size: nan,
            items: [0; WIDTH],
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
        let mut packet = ShapePacket { items: [0; WIDTH], count: 0 };
        for (k, item) in items.enumerate() {
            packet.items[k] = item;
            packet.count += 1;
        }
        self.shapes.push(packet);
        self.shapes.len() - 1
    }
}

impl ShapePacket {
    /// Indices into `Primitives::shapes`.
    #[inline(always)]
    pub(super) fn items(&self) -> &[u32] {
        self.items.get(..self.count as usize).unwrap_or(&[])
    }
}

impl SpherePacket {
    /// A bit for every sphere that the beam may meet up to `limit`.
    #[inline(always)]
    pub(super) fn candidates<S: Simd>(&self, simd: S, beam: &Beam<S>, limit: f32x8<S>) -> u32 {
        let [x, y, z] = load3(simd, &self.center);
        let [ox, oy, oz] = beam.origin;
        let (x, y, z) = (x - ox, y - oy, z - oz);
        let [dx, dy, dz] = beam.direction;
        let along = x * dx + y * dy + z * dz;
        let (lx, ly, lz) = (x - along * dx, y - along * dy, z - along * dz);
        let off2 = lx * lx + ly * ly + lz * lz;
        let radius = load(simd, &self.radius);
        // Error of any position or distance above: the ray's, the centre's, and the arithmetic's.
        let error = (x.abs() + y.abs() + z.abs() + radius + beam.size) * MARGIN;
        let reach = radius + error;
        let half2 = reach * reach - off2;
        // The entry is no nearer than along − √half2 − error, the exit no farther than along + reach.
        let beyond = along - limit - error;
        let zero = f32x8::splat(simd, 0.0);
        let near_enough = beyond.simd_le(zero) | (beyond * beyond).simd_le(half2);
        let hit = half2.simd_ge(zero) & (along + reach + error).simd_ge(zero) & near_enough;
        hit.to_bitmask() as u32
    }
}

impl TrianglePacket {
    /// A bit for every lane that holds a triangle.
    #[inline(always)]
    pub(super) fn lanes_of<S: Simd>(&self, simd: S, item: u32) -> u32 {
        u32x8::from_slice(simd, &self.items).simd_eq(item).to_bitmask() as u32
    }

    /// A bit for every triangle that the beam may meet up to `limit` (Möller and Trumbore's numbers,
    /// undivided).
    #[inline(always)]
    pub(super) fn candidates<S: Simd>(&self, simd: S, beam: &Beam<S>, limit: f32x8<S>) -> u32 {
        let ([dx, dy, dz], [ox, oy, oz]) = (beam.direction, beam.origin);
        let [cx, cy, cz] = load3(simd, &self.corner);
        let (ax, ay, az) = (ox - cx, oy - cy, oz - cz);
        let [px, py, pz] = load3(simd, &self.edges[0]);
        let [qx, qy, qz] = load3(simd, &self.edges[1]);
        // d × q, a × p
        let (ex, ey, ez) = (dy * qz - dz * qy, dz * qx - dx * qz, dx * qy - dy * qx);
        let (fx, fy, fz) = (ay * pz - az * py, az * px - ax * pz, ax * py - ay * px);
        let det = px * ex + py * ey + pz * ez;
        let u = (ax * ex + ay * ey + az * ez).copysign_by(det);
        let v = (dx * fx + dy * fy + dz * fz).copysign_by(det);
        let t = (qx * fx + qy * fy + qz * fz).copysign_by(det);
        let det = det.abs();
        let error = load(simd, &self.margin) * (ax.abs() + ay.abs() + az.abs() + beam.size);
        let t_error = error * load(simd, &self.size);
        let zero = f32x8::splat(simd, 0.0);
        let low = zero - error;
        let inside = u.simd_ge(low) & v.simd_ge(low) & (u + v).simd_le(det + error);
        let in_reach = t.simd_ge(zero - t_error) & t.simd_le(limit * (det + error) + t_error);
        (inside & in_reach).to_bitmask() as u32
    }
}

#[inline(always)]
fn load<S: Simd>(simd: S, lanes: &[f32; WIDTH]) -> f32x8<S> {
    f32x8::from_slice(simd, lanes)
}

#[inline(always)]
fn load3<S: Simd>(simd: S, lanes: &[[f32; WIDTH]; 3]) -> [f32x8<S>; 3] {
    [load(simd, &lanes[0]), load(simd, &lanes[1]), load(simd, &lanes[2])]
}

/// Multiplication by the sign of another number.
trait SignBy {
    fn copysign_by(self, sign: Self) -> Self;
}

impl<S: Simd> SignBy for f32x8<S> {
    #[inline(always)]
    fn copysign_by(self, sign: Self) -> Self {
        let bit = sign.to_bits() & 0x8000_0000u32;
        f32x8::from_bits(self.to_bits() ^ bit)
    }
}
