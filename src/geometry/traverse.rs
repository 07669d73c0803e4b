//! The walk of a ray through the hierarchy: f32 boxes on the way, f64 decisions at the end.

use std::cell::RefCell;

use fearless_simd::{Level, Simd, prelude::*};

use super::beam::Beam;
use super::compile::Kind;
use super::hierarchy::{STACK, Stack};
use super::lanes::{self, Floats, Lanes, Width};
use super::motion::Moment;
use super::primitive::{Form, Roots, Start};
use super::query::Query;
use super::shear::Shear;
use super::wide::{Child, Node, Target, Wide};
use super::{Geometry, Leaving, Ray};

/// What a leaf needs beside the packet.
#[derive(Clone, Copy)]
pub(super) struct Walk<'a> {
    pub(super) ray: &'a Ray,
    pub(super) leaving: Departure,
    /// By how much the origin may be off beyond its own rounding, world units.
    slack: f64,
    /// For what moves.
    pub(super) moment: &'a RefCell<Moment>,
}

impl<'a> Walk<'a> {
    /// Of a ray that may leave a surface.
    #[inline(always)]
    pub(super) fn new(
        ray: &'a Ray,
        (leaving, slack): (Departure, f64),
        moment: &'a RefCell<Moment>,
    ) -> Walk<'a> {
        Walk { ray, leaving, slack, moment }
    }
}

/// The primitive that a ray leaves, looked up.
#[derive(Clone, Copy, Debug)]
pub(super) struct Departure {
    /// `u32::MAX` if there is none.
    primitive: u32,
    /// Among the triangles of the hierarchy that is walked; `u32::MAX` if it is none of them.
    triangle: u32,
    start: Start,
    /// The triangles of its mesh, as a range of primitives; empty if it is no triangle.
    mesh: (u32, u32),
    /// Whether the mesh is closed.
    closed: bool,
}

impl Geometry {
    /// Offers every crossing to the query that can matter to it.
    #[inline(always)]
    pub(super) fn traverse<S: Simd, Q: Query>(
        &self,
        simd: S,
        stack: &mut Stack,
        ray: &Ray,
        leaving: Option<Leaving>,
        query: &mut Q,
    ) {
        let Stack { entries, moment } = stack;
        let walk = Walk::new(ray, (self.departure(leaving), 0.0), moment);
        for plane in &self.primitives.planes {
            let t = plane.root(ray, walk.leaving.start_of(plane.primitive));
            // Of the nearest crossing an infinite one is none.
            if t > 0.0 && (!Q::ALL || t < f64::INFINITY) {
                query.offer(t, plane.primitive);
            }
        }
        for &index in &self.primitives.unbounded {
            let (composite, walk) = (&self.primitives.composites[index as usize], walk);
            query.lend(|query| composite.meet(simd.level(), &walk, query));
        }
        self.descend(simd, entries, &walk, query);
    }

    /// Offers every crossing with what the hierarchy holds.
    #[inline(always)]
    pub(super) fn descend<S: Simd, Q: Query>(
        &self,
        simd: S,
        entries: &mut [u64; STACK],
        walk: &Walk<'_>,
        query: &mut Q,
    ) {
        if query.is_done() {
            return;
        }
        if lanes::are_sixteen(simd) {
            self.descend_in(simd, self.hierarchy.sixteen(), entries, walk, query);
        } else {
            self.descend_in(simd, self.hierarchy.eight(), entries, walk, query);
        }
    }

    #[inline(always)]
    fn descend_in<S: Simd, Q: Query, const N: usize>(
        &self,
        simd: S,
        wide: &Wide<N>,
        entries: &mut [u64; STACK],
        walk: &Walk<'_>,
        query: &mut Q,
    ) where
        Lanes<N>: Width,
    {
        let Some(root) = wide.root else { return };
        let beam = Beam::new(simd, &self.hierarchy.frame, walk.ray);
        let mut limit = beam.limit(query.limit());
        let mut limits = Floats::<S, N>::splat(simd, limit);
        let mut top = 0;
        let mut current = root;
        loop {
            if current.target() == Target::Node {
                let node = &wide.nodes[current.index()];
                let (mask, near) = in_memory(&beam).meet(simd, node, limits);
                if mask != 0 {
                    current = next_child::<S, Q, N>(node, mask, near, entries, &mut top);
                    continue;
                }
            } else {
                self.leaf(simd, (wide, current), in_memory(&beam), limits, walk, query);
                if query.is_done() {
                    return;
                }
                if !Q::ALL {
                    limit = beam.limit(query.limit());
                    limits = Floats::<S, N>::splat(simd, limit);
                }
            }
            loop {
                if top == 0 {
                    return;
                }
                top -= 1;
                let entry = entries[top & (STACK - 1)];
                if f32::from_bits((entry >> 32) as u32) <= limit {
                    current = Child(entry as u32);
                    break;
                }
            }
        }
    }

    /// Decides the candidates of a leaf.
    #[inline(always)]
    fn leaf<S: Simd, Q: Query, const N: usize>(
        &self,
        simd: S,
        (wide, leaf): (&Wide<N>, Child),
        beam: &Beam,
        limits: Floats<S, N>,
        walk: &Walk<'_>,
        query: &mut Q,
    ) where
        Lanes<N>: Width,
    {
        let (packets, index) = (&wide.packets, leaf.index());
        match leaf.target() {
            Target::Node => {}
            Target::Spheres => {
                let packet = &packets.spheres[index];
                let mut mask = packet.candidates(simd, beam, limits);
                while mask != 0 && !query.is_done() {
                    let lane = mask.trailing_zeros() as usize & (N - 1);
                    mask &= mask - 1;
                    self.sphere(packet.items[lane] as usize, walk, query);
                }
            }
            Target::Triangles => {
                let packet = &packets.triangles[index];
                let mut mask = packet.candidates(simd, beam, limits);
                if mask == 0 {
                    return;
                }
                // The triangle that is left is met by nearly every ray that leaves it.
                mask &= !packet.lanes_of(simd, walk.leaving.triangle);
                if mask == 0 {
                    return;
                }
                let shear = Shear::new(walk.ray);
                while mask != 0 && !query.is_done() {
                    let lane = mask.trailing_zeros() as usize & (N - 1);
                    mask &= mask - 1;
                    self.triangle(packet.items[lane] as usize, &shear, walk, query);
                }
            }
            Target::Shapes => {
                let packet = &packets.shapes[index];
                for item in packet.items() {
                    self.shape(simd.level(), *item as usize, walk, query);
                }
            }
        }
    }

    #[inline(always)]
    fn sphere<Q: Query>(&self, item: usize, walk: &Walk<'_>, query: &mut Q) {
        let sphere = &self.primitives.spheres[item];
        let roots = sphere.roots(walk.ray, walk.leaving.start_of(sphere.primitive));
        offer_roots(roots, sphere.primitive, query);
    }

    #[inline(always)]
    fn triangle<Q: Query>(&self, item: usize, shear: &Shear, walk: &Walk<'_>, query: &mut Q) {
        let all = &self.primitives;
        let triangle = &all.triangles[item];
        let Some(crossing) = shear.triangle(all.triangle_corners(triangle)) else { return };
        let (t, primitive) = (crossing.t, triangle.primitive);
        if !(t > 0.0 && t <= query.limit()) {
            return;
        }
        let Departure { primitive: left, triangle: _, mesh, start, closed } = walk.leaving;
        if primitive >= mesh.0 && primitive < mesh.1 {
            let left_item = item.wrapping_add(left as usize).wrapping_sub(primitive as usize);
            let (pair, inside) = ([left_item, item], start == Start::Inside);
            let from = (walk.ray, walk.slack);
            if primitive == left || all.is_departure_noise(from, pair, inside, closed) {
                return;
            }
        }
        query.offer(t, primitive);
    }

    #[inline(always)]
    fn shape<Q: Query>(&self, level: Level, item: usize, walk: &Walk<'_>, query: &mut Q) {
        let shape = &self.primitives.shapes[item];
        if let Form::Moving(index) = shape.form {
            let moving = &self.primitives.moving[index as usize];
            let walk = *walk;
            query.lend(|query| moving.meet(level, index, &walk, query));
            return;
        }
        if let Form::Composite(index) = shape.form {
            let (composite, walk) = (&self.primitives.composites[index as usize], *walk);
            query.lend(|query| composite.meet(level, &walk, query));
            return;
        }
        let start = walk.leaving.start_of(shape.primitive);
        if let Form::Closed(closed) = &shape.form {
            query.lend(|query| closed.meet(walk.ray, start, shape.primitive, query));
            return;
        }
        offer_roots(shape.form.roots(walk.ray, start), shape.primitive, query);
    }

    #[inline(always)]
    fn departure(&self, leaving: Option<Leaving>) -> Departure {
        let Some(Leaving { primitive, inside }) = leaving else {
            return Departure::NONE;
        };
        let solid = self.primitives.solid(primitive);
        let triangle = match solid.item.kind {
            Kind::Triangle => solid.item.index + (primitive - solid.first),
            _ => u32::MAX,
        };
        Departure {
            primitive,
            triangle,
            start: if inside { Start::Inside } else { Start::Outside },
            mesh: if solid.mesh { (solid.first, solid.first + solid.count) } else { (0, 0) },
            closed: !solid.thin,
        }
    }

    /// Offers every crossing of every primitive at a time: the truth that the hierarchy is held to.
    pub(super) fn traverse_all<Q: Query>(
        &self,
        time: f64,
        ray: &Ray,
        leaving: Option<Leaving>,
        query: &mut Q,
    ) {
        let all = &self.primitives;
        let moment = RefCell::new(Moment::new(all, time));
        let walk = Walk::new(ray, (self.departure(leaving), 0.0), &moment);
        for plane in &all.planes {
            let t = plane.root(ray, walk.leaving.start_of(plane.primitive));
            if t > 0.0 && t < f64::INFINITY {
                query.offer(t, plane.primitive);
            }
        }
        for &index in &all.unbounded {
            all.composites[index as usize].meet(self.level(), &walk, query);
        }
        (0..all.spheres.len()).for_each(|i| self.sphere(i, &walk, query));
        let shear = Shear::new(ray);
        (0..all.triangles.len()).for_each(|i| self.triangle(i, &shear, &walk, query));
        (0..all.shapes.len()).for_each(|i| self.shape(self.level(), i, &walk, query));
    }
}

impl Departure {
    /// From nowhere.
    pub(super) const NONE: Departure = Departure {
        primitive: u32::MAX,
        triangle: u32::MAX,
        start: Start::Elsewhere,
        mesh: (0, 0),
        closed: false,
    };

    /// The same in a hierarchy of its own, of a single solid whose primitives are `count` from
    /// `first` on.
    #[inline(always)]
    pub(super) fn alone(self, first: u32, count: u32) -> Departure {
        let triangle = self.primitive.wrapping_sub(first);
        Departure { triangle: if triangle < count { triangle } else { u32::MAX }, ..self }
    }

    /// How the ray stands to a solid of `count` primitives from `first` on; `turned` if what it
    /// leaves is that solid's complement.
    #[inline(always)]
    pub(super) fn start_in(&self, first: u32, count: u32, turned: bool) -> Start {
        match self.start {
            _ if self.primitive.wrapping_sub(first) >= count => Start::Elsewhere,
            Start::Inside if turned => Start::Outside,
            Start::Outside if turned => Start::Inside,
            start => start,
        }
    }

    #[inline(always)]
    fn start_of(&self, primitive: u32) -> Start {
        if primitive == self.primitive { self.start } else { Start::Elsewhere }
    }
}

/// The beam, of which nothing is loaded ahead: spread over vectors before the walk, its numbers would
/// only be spilled.
#[inline(always)]
fn in_memory(beam: &Beam) -> &Beam {
    std::hint::black_box(beam)
}

/// Offers the crossings with `t > 0`; only the first one unless the query wants all.
#[inline(always)]
pub(super) fn offer_roots<Q: Query>(Roots { near, far }: Roots, primitive: u32, query: &mut Q) {
    if near > 0.0 {
        query.offer(near, primitive);
        if !Q::ALL {
            return;
        }
    }
    if far > 0.0 {
        query.offer(far, primitive);
    }
}

/// Of the children met, the nearest; the others wait on the stack, the nearest on top.
#[inline(always)]
fn next_child<S: Simd, Q: Query, const N: usize>(
    node: &Node<N>,
    mut mask: u32,
    near: Floats<S, N>,
    entries: &mut [u64; STACK],
    top: &mut usize,
) -> Child
where
    Lanes<N>: Width,
{
    let first = mask.trailing_zeros() as usize & (N - 1);
    mask &= mask - 1;
    if mask == 0 {
        return node.children[first];
    }
    let mut distances = [0.0; N];
    near.store_slice(&mut distances);
    let near = &distances;
    let base = *top;
    let mut best = entry(node, near, first);
    while mask != 0 {
        let mut other = entry(node, near, mask.trailing_zeros() as usize);
        mask &= mask - 1;
        if other < best {
            std::mem::swap(&mut other, &mut best);
        }
        let mut place = *top;
        // All children must be asked when everything counts: their order is of no use then.
        while !Q::ALL && place > base && entries[(place - 1) & (STACK - 1)] < other {
            entries[place & (STACK - 1)] = entries[(place - 1) & (STACK - 1)];
            place -= 1;
        }
        entries[place & (STACK - 1)] = other;
        *top += 1;
    }
    Child(best as u32)
}

#[inline(always)]
fn entry<const N: usize>(node: &Node<N>, near: &[f32; N], lane: usize) -> u64 {
    let lane = lane & (N - 1);
    u64::from(near[lane].to_bits()) << 32 | u64::from(node.children[lane].0)
}
