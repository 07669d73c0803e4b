//! The hierarchy of boxes, eight wide: its nodes, its space, and how it is built.

use std::cell::RefCell;

use glam::DVec3;

use super::binary::{Aabb, BinaryNode, BinaryTree};
use super::compile::{Item, Kind, Primitives};
use super::motion::Moment;
use super::packet::{Packets, WIDTH};
use super::plan::Plan;
use super::primitive::Form;
use super::shear::point;
use crate::progress::{Cancelled, Progress};

/// Entries of a [`Stack`]; a power of two.
pub(super) const STACK: usize = 512;

/// Scratch for the queries of one thread, made once: zeroing one per ray costs a third.
#[derive(Debug)]
pub struct Stack {
    /// Distance bits above, child reference below: ordered by distance.
    pub(super) entries: Box<[u64; STACK]>,
    /// Where what moves is; only that asks.
    pub(super) moment: RefCell<Moment>,
}

impl Stack {
    /// Scratch for the queries of `geometry` alone: it remembers where what moves in it was.
    pub fn new(geometry: &super::Geometry) -> Stack {
        assert!(geometry.hierarchy.stack_needed() <= STACK, "build bounds the depth");
        let moment = RefCell::new(Moment::new(&geometry.primitives, 0.0));
        Stack { moment, ..Stack::default() }
    }

    /// The time of the rays that are asked about from now on, 0 … 1; 0 at first. Of no matter where
    /// nothing moves.
    pub fn set_time(&mut self, time: f64) {
        self.moment.get_mut().time = time;
    }

    /// The time of the rays that are asked about.
    pub(super) fn time(&self) -> f64 {
        self.moment.borrow().time
    }
}

impl Default for Stack {
    fn default() -> Stack {
        Stack { entries: Box::new([0; STACK]), moment: RefCell::default() }
    }
}

/// Eight boxes and what is in them.
///
/// # Invariants
/// Unused places have the box lo = +∞, hi = −∞, which no ray meets because planes are chosen by the
/// direction's sign and never sorted.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(super) struct Node {
    /// By axis, then lowest and highest.
    pub(super) bounds: [[[f32; WIDTH]; 2]; 3],
    /// What the boxes hold.
    pub(super) children: [Child; WIDTH],
}

/// A reference to a node or leaf: two bits of kind above thirty bits of index. `0x4000_0005` is
/// packet 5 of spheres.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Child(pub(super) u32);

/// What a [`Child`] refers to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Target {
    /// An index into `Hierarchy::nodes`.
    Node,
    /// An index into `Packets::spheres`.
    Spheres,
    /// An index into `Packets::triangles`.
    Triangles,
    /// An index into `Packets::shapes`.
    Shapes,
}

impl Child {
    const INDEX: u32 = (1 << 30) - 1;

    fn new(target: Target, index: usize) -> Child {
        assert!(index <= Child::INDEX as usize, "fewer than 2^30 nodes and leaves");
        Child((target as u32) << 30 | index as u32)
    }

    /// Which list.
    #[inline(always)]
    pub(super) fn target(self) -> Target {
        match self.0 >> 30 {
            0 => Target::Node,
            1 => Target::Spheres,
            2 => Target::Triangles,
            _ => Target::Shapes,
        }
    }

    /// Which element.
    #[inline(always)]
    pub(super) fn index(self) -> usize {
        (self.0 & Child::INDEX) as usize
    }
}

/// The space of the hierarchy: centred on what it holds and scaled by a power of two to coordinates
/// within −1 … 1, so that f32 boxes stay sharp at any offset and size.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame {
    /// World position of the origin.
    pub(super) center: DVec3,
    /// local = (world − center) · scale.
    pub(super) scale: f64,
}

/// Everything but the planes, ready for rays.
#[derive(Debug)]
pub(super) struct Hierarchy {
    pub(super) frame: Frame,
    /// The root, if there is anything.
    pub(super) root: Option<Child>,
    pub(super) nodes: Vec<Node>,
    pub(super) packets: Packets,
    bounds: Option<[DVec3; 2]>,
    depth: usize,
}

impl Hierarchy {
    /// Builds the hierarchy over all primitives but the planes.
    pub(super) fn build(all: &Primitives, progress: &Progress) -> Result<Hierarchy, Cancelled> {
        let items = items(all);
        let (frame, bounds) = Frame::around(all, &items);
        let mut boxes = Vec::with_capacity(items.len());
        for chunk in items.chunks(1 << 14) {
            progress.check()?;
            boxes.extend(chunk.iter().map(|item| frame.local_box(all, *item)));
        }
        let tree = BinaryTree::build(&boxes, progress)?;
        let plan = Plan::new(&tree, &items, progress)?;
        let mut hierarchy = Hierarchy {
            frame,
            root: None,
            nodes: Vec::new(),
            packets: Packets::default(),
            bounds,
            depth: 0,
        };
        hierarchy.emit(&plan, all, progress)?;
        assert!(hierarchy.stack_needed() <= STACK, "the binary tree's depth is bounded");
        Ok(hierarchy)
    }

    /// The most entries that a ray can have waiting.
    pub(super) fn stack_needed(&self) -> usize {
        self.depth * (WIDTH - 1) + WIDTH
    }

    /// World bounds of what it holds.
    pub(super) fn bounds(&self) -> Option<[DVec3; 2]> {
        self.bounds
    }

    /// Memory held, in bytes.
    pub(super) fn bytes(&self) -> usize {
        size_of_val(&*self.nodes) + self.packets.bytes()
    }

    /// Writes the planned nodes and leaves, depth first.
    fn emit(
        &mut self,
        plan: &Plan,
        all: &Primitives,
        progress: &Progress,
    ) -> Result<(), Cancelled> {
        if plan.tree.nodes.is_empty() {
            return Ok(());
        }
        // Binary node, depth, and the place of the reference to it.
        let mut open = vec![(0, 0, None)];
        while let Some((binary, depth, place)) = open.pop() {
            progress.check()?;
            let child = match plan.leaf_kind(binary) {
                Some(kind) => self.emit_leaf(kind, plan.items_under(binary), all),
                None => {
                    let child = Child::new(Target::Node, self.nodes.len());
                    let parts = plan.children(binary);
                    self.nodes.push(Node::around(&parts, &plan.tree.nodes));
                    let parts = parts.iter().enumerate().rev();
                    open.extend(parts.map(|(k, b)| (*b, depth + 1, Some((child.index(), k)))));
                    child
                }
            };
            self.depth = self.depth.max(depth);
            match place {
                Some((node, k)) => self.nodes[node].children[k] = child,
                None => self.root = Some(child),
            }
        }
        Ok(())
    }

    fn emit_leaf(
        &mut self,
        kind: Kind,
        items: impl Iterator<Item = u32>,
        all: &Primitives,
    ) -> Child {
        let (frame, packets) = (&self.frame, &mut self.packets);
        match kind {
            Kind::Sphere => Child::new(Target::Spheres, packets.add_spheres(frame, all, items)),
            Kind::Triangle => {
                Child::new(Target::Triangles, packets.add_triangles(frame, all, items))
            }
            Kind::Shape => Child::new(Target::Shapes, packets.add_shapes(items)),
            Kind::Plane | Kind::Moving | Kind::Leaf => {
                unreachable!("none is an item of the hierarchy")
            }
        }
    }
}

/// All items of the hierarchy, kind by kind.
fn items(all: &Primitives) -> Vec<Item> {
    let run = |kind, count| (0..count as u32).map(move |index| Item { kind, index });
    run(Kind::Sphere, all.spheres.len())
        .chain(run(Kind::Triangle, all.triangles.len()))
        .chain(run(Kind::Shape, all.shapes.len()))
        .collect()
}

impl Node {
    /// A node around the binary nodes `parts`, at most eight; the children are not yet known.
    fn around(parts: &[u32], binary: &[BinaryNode]) -> Node {
        let empty = [[f32::INFINITY; WIDTH], [f32::NEG_INFINITY; WIDTH]];
        let mut node = Node { bounds: [empty; 3], children: [Child(0); WIDTH] };
        for (k, part) in parts.iter().enumerate() {
            let Aabb { lo, hi } = binary[*part as usize].bounds;
            for axis in 0..3 {
                node.bounds[axis][0][k] = lo[axis];
                node.bounds[axis][1][k] = hi[axis];
            }
        }
        node
    }
}

impl Frame {
    /// The frame around some items, and their world bounds.
    fn around(all: &Primitives, items: &[Item]) -> (Frame, Option<[DVec3; 2]>) {
        let (mut lo, mut hi) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for item in items {
            let [a, b] = box_about(all, *item, DVec3::ZERO);
            (lo, hi) = (lo.min(a), hi.max(b));
        }
        if items.is_empty() {
            return (Frame { center: DVec3::ZERO, scale: 1.0 }, None);
        }
        let half = (hi - lo) * 0.5;
        (Frame { center: lo + half, scale: scale_to_one(half.max_element()) }, Some([lo, hi]))
    }

    /// A box in the frame around an item, rounded outward.
    fn local_box(&self, all: &Primitives, item: Item) -> Aabb {
        let [lo, hi] = box_about(all, item, self.center);
        let (lo, hi) = ((lo * self.scale).to_array(), (hi * self.scale).to_array());
        Aabb { lo: lo.map(|x| (x as f32).next_down()), hi: hi.map(|x| (x as f32).next_up()) }
    }

    /// A world point in the frame.
    pub(super) fn local(&self, p: DVec3) -> DVec3 {
        (p - self.center) * self.scale
    }
}

/// The power of two that brings `size` into 0.5 … 1.
fn scale_to_one(size: f64) -> f64 {
    if size == 0.0 || !size.is_finite() {
        return 1.0;
    }
    let (_, exponent) = libm::frexp(size);
    libm::ldexp(1.0, (-exponent).clamp(-1000, 1000))
}

/// Lowest and highest corner of an item, relative to `center`.
fn box_about(all: &Primitives, item: Item, center: DVec3) -> [DVec3; 2] {
    let index = item.index as usize;
    let around = |middle: DVec3, half: DVec3| [middle - center - half, middle - center + half];
    match item.kind {
        Kind::Sphere => {
            let sphere = &all.spheres[index];
            around(sphere.center, DVec3::splat(sphere.radius))
        }
        Kind::Triangle => {
            box_of_points(all.triangle_corners(&all.triangles[index]).map(|c| point(c) - center))
        }
        Kind::Shape => match &all.shapes[index].form {
            Form::Cuboid(corners) => corners.map(|c| c - center),
            Form::PlacedCuboid(placed, [min, max]) => {
                let half = (*max - *min) * 0.5;
                around(placed.point(*min + half), placed.box_extent(half))
            }
            Form::Ellipsoid(placed, middle, radius) => {
                around(placed.point(*middle), placed.sphere_extent(*radius))
            }
            Form::Polygon(corners, _) => box_of_points(corners.iter().map(|c| point(c) - center)),
            Form::Closed(closed) => closed.bounds().map(|c| c - center),
            Form::Moving(index) => all.moving[*index as usize].bounds().map(|c| c - center),
            Form::Composite(index) => all.composites[*index as usize].bounds().map(|c| c - center),
        },
        Kind::Plane | Kind::Moving | Kind::Leaf => {
            unreachable!("none is an item of the hierarchy")
        }
    }
}

fn box_of_points(points: impl IntoIterator<Item = DVec3>) -> [DVec3; 2] {
    points
        .into_iter()
        .fold([DVec3::INFINITY, DVec3::NEG_INFINITY], |[lo, hi], p| [lo.min(p), hi.max(p)])
}
