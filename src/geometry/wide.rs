//! The tree of boxes, eight or sixteen wide, and its leaves.

use super::binary::{Aabb, BinaryNode};
use super::compile::{Kind, Primitives};
use super::hierarchy::{Frame, STACK};
use super::packet::Packets;
use super::plan::Plan;
use crate::progress::{Cancelled, Progress};

/// A tree with `N` children per node and as many primitives per leaf.
#[derive(Debug, Default)]
pub(super) struct Wide<const N: usize> {
    /// The root, if there is anything.
    pub(super) root: Option<Child>,
    pub(super) nodes: Vec<Node<N>>,
    pub(super) packets: Packets<N>,
    depth: usize,
}

/// Boxes and what is in them.
///
/// # Invariants
/// Unused places have the box lo = +∞, hi = −∞, which no ray meets because planes are chosen by the
/// direction's sign and never sorted.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(super) struct Node<const N: usize> {
    /// By axis, then lowest and highest.
    pub(super) bounds: [[[f32; N]; 2]; 3],
    /// What the boxes hold.
    pub(super) children: [Child; N],
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

impl<const N: usize> Wide<N> {
    /// Builds the tree that is planned.
    pub(super) fn build(
        plan: &Plan<'_, N>,
        of: (&Frame, &Primitives),
        progress: &Progress,
    ) -> Result<Wide<N>, Cancelled> {
        let mut wide = Wide::default();
        wide.emit(plan, of, progress)?;
        assert!(wide.stack_needed() <= STACK, "the binary tree's depth is bounded");
        Ok(wide)
    }

    /// The most entries that a ray can have waiting.
    pub(super) fn stack_needed(&self) -> usize {
        self.depth * (N - 1) + N
    }

    /// Memory held, in bytes.
    pub(super) fn bytes(&self) -> usize {
        size_of_val(&*self.nodes) + self.packets.bytes()
    }

    /// Writes the planned nodes and leaves, depth first.
    fn emit(
        &mut self,
        plan: &Plan<'_, N>,
        (frame, all): (&Frame, &Primitives),
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
                Some(kind) => self.emit_leaf(kind, plan.items_under(binary), (frame, all)),
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
        (frame, all): (&Frame, &Primitives),
    ) -> Child {
        let packets = &mut self.packets;
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

impl<const N: usize> Node<N> {
    /// A node around the binary nodes `parts`, at most `N`; the children are not yet known.
    fn around(parts: &[u32], binary: &[BinaryNode]) -> Node<N> {
        let empty = [[f32::INFINITY; N], [f32::NEG_INFINITY; N]];
        let mut node = Node { bounds: [empty; 3], children: [Child(0); N] };
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
