//! The binary tree that the wide hierarchy is collapsed from: surface area heuristic, swept for few
//! primitives and binned for many.

use crate::progress::{Cancelled, Progress};

/// Above this many primitives splits are looked for between bins instead of all primitives.
const SWEEP_MAX: usize = 256;
/// Bins per axis.
const BINS: usize = 16;
/// From this depth on ranges are halved by count, so that no input makes the tree deep.
const HALVE_FROM_DEPTH: u32 = 36;

/// An axis-parallel box in the hierarchy's f32 space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Aabb {
    /// Lowest corner.
    pub(super) lo: [f32; 3],
    /// Highest corner.
    pub(super) hi: [f32; 3],
}

impl Aabb {
    /// The box that holds nothing.
    pub(super) const EMPTY: Aabb = Aabb { lo: [f32::INFINITY; 3], hi: [f32::NEG_INFINITY; 3] };

    /// The smallest box around both.
    pub(super) fn union(&self, other: &Aabb) -> Aabb {
        Aabb {
            lo: std::array::from_fn(|k| self.lo[k].min(other.lo[k])),
            hi: std::array::from_fn(|k| self.hi[k].max(other.hi[k])),
        }
    }

    /// Half of the surface; 0 for the empty box.
    pub(super) fn area(&self) -> f32 {
        let [x, y, z] = std::array::from_fn(|k| (self.hi[k] - self.lo[k]).max(0.0));
        x * y + y * z + z * x
    }

    /// Twice the middle.
    fn middle(&self, axis: usize) -> f32 {
        self.lo[axis] + self.hi[axis]
    }
}

/// A node over `order[begin..end]`.
#[derive(Clone, Copy, Debug)]
pub(super) struct BinaryNode {
    /// Around all its primitives.
    pub(super) bounds: Aabb,
    /// First place in the order.
    pub(super) begin: u32,
    /// One past the last place.
    pub(super) end: u32,
    /// The left child, after its parent; the right one follows it. 0: a single primitive.
    pub(super) left: u32,
}

/// The tree, parents before children, and the order of the primitives under it.
#[derive(Debug, Default)]
pub(super) struct BinaryTree {
    /// The root is the first; empty without primitives.
    pub(super) nodes: Vec<BinaryNode>,
    /// Indices of the boxes that the tree was built over.
    pub(super) order: Vec<u32>,
}

impl BinaryTree {
    /// Builds down to single primitives. Iterative, deterministic, and of bounded depth whatever the
    /// boxes are.
    pub(super) fn build(boxes: &[Aabb], progress: &Progress) -> Result<BinaryTree, Cancelled> {
        let mut tree = BinaryTree { nodes: Vec::new(), order: (0..boxes.len() as u32).collect() };
        if boxes.is_empty() {
            return Ok(tree);
        }
        tree.nodes.reserve(2 * boxes.len());
        tree.push(boxes, 0, boxes.len());
        let mut splitter = Splitter { boxes, areas: Vec::new() };
        let mut open = vec![(0, 0)];
        while let Some((node, depth)) = open.pop() {
            progress.check()?;
            let BinaryNode { bounds: _, begin, end, left: _ } = tree.nodes[node];
            let (begin, end) = (begin as usize, end as usize);
            if end - begin == 1 {
                continue;
            }
            let count = splitter.split(&mut tree.order[begin..end], depth);
            let left = tree.push(boxes, begin, begin + count);
            tree.push(boxes, begin + count, end);
            tree.nodes[node].left = left as u32;
            open.extend([(left + 1, depth + 1), (left, depth + 1)]);
        }
        Ok(tree)
    }

    fn push(&mut self, boxes: &[Aabb], begin: usize, end: usize) -> usize {
        let bounds = self.order[begin..end]
            .iter()
            .fold(Aabb::EMPTY, |bounds, i| bounds.union(&boxes[*i as usize]));
        self.nodes.push(BinaryNode { bounds, begin: begin as u32, end: end as u32, left: 0 });
        self.nodes.len() - 1
    }
}

/// Finds splits; keeps its scratch.
struct Splitter<'a> {
    boxes: &'a [Aabb],
    areas: Vec<f32>,
}

impl Splitter<'_> {
    /// Reorders two or more primitives and returns how many go left, at least one on each side.
    fn split(&mut self, order: &mut [u32], depth: u32) -> usize {
        if depth >= HALVE_FROM_DEPTH {
            return order.len() / 2;
        }
        let count = if order.len() <= SWEEP_MAX { self.sweep(order) } else { self.bin(order) };
        if count == 0 || count == order.len() { order.len() / 2 } else { count }
    }

    fn sort(&self, order: &mut [u32], axis: usize) {
        let key = |i: u32| self.boxes[i as usize].middle(axis);
        order.sort_unstable_by(|a, b| key(*a).total_cmp(&key(*b)).then(a.cmp(b)));
    }

    /// The best of all splits along all axes; leaves the order sorted along the best axis.
    fn sweep(&mut self, order: &mut [u32]) -> usize {
        if order.len() == 2 {
            return 1;
        }
        let (mut best_cost, mut best) = (f32::INFINITY, (0, order.len() / 2));
        let mut sorted_by = 0;
        for axis in 0..3 {
            self.sort(order, axis);
            sorted_by = axis;
            self.areas.clear();
            let mut bounds = Aabb::EMPTY;
            for i in order.iter().rev() {
                bounds = bounds.union(&self.boxes[*i as usize]);
                self.areas.push(bounds.area());
            }
            let mut bounds = Aabb::EMPTY;
            for (count, i) in (1..order.len()).zip(order.iter()) {
                bounds = bounds.union(&self.boxes[*i as usize]);
                let rest = order.len() - count;
                let cost = bounds.area() * count as f32 + self.areas[rest - 1] * rest as f32;
                if cost < best_cost {
                    (best_cost, best) = (cost, (axis, count));
                }
            }
        }
        if sorted_by != best.0 {
            self.sort(order, best.0);
        }
        best.1
    }

    /// The best split between bins of equal width; 0 if all middles coincide.
    fn bin(&self, order: &mut [u32]) -> usize {
        let (mut best_cost, mut best) = (f32::INFINITY, None);
        for axis in 0..3 {
            let Some(binning) = Binning::new(self.boxes, order, axis) else { continue };
            let mut bins = [(Aabb::EMPTY, 0usize); BINS];
            for i in order.iter() {
                let bounds = &self.boxes[*i as usize];
                let bin = &mut bins[binning.bin(bounds)];
                *bin = (bin.0.union(bounds), bin.1 + 1);
            }
            let mut suffix = [(Aabb::EMPTY, 0usize); BINS + 1];
            for k in (0..BINS).rev() {
                suffix[k] = (suffix[k + 1].0.union(&bins[k].0), suffix[k + 1].1 + bins[k].1);
            }
            let mut left = (Aabb::EMPTY, 0);
            for k in 1..BINS {
                left = (left.0.union(&bins[k - 1].0), left.1 + bins[k - 1].1);
                let cost = left.0.area() * left.1 as f32 + suffix[k].0.area() * suffix[k].1 as f32;
                if left.1 > 0 && suffix[k].1 > 0 && cost < best_cost {
                    (best_cost, best) = (cost, Some((binning, k)));
                }
            }
        }
        let Some((binning, k)) = best else { return 0 };
        // Sorted by (side, index): deterministic, and runs stay in the order of the scene.
        let is_left = |i: &u32| binning.bin(&self.boxes[*i as usize]) < k;
        let (left, right): (Vec<u32>, Vec<u32>) = order.iter().partition(|i| is_left(i));
        order[..left.len()].copy_from_slice(&left);
        order[left.len()..].copy_from_slice(&right);
        left.len()
    }
}

/// Equal bins along an axis.
#[derive(Clone, Copy, Debug)]
struct Binning {
    axis: usize,
    low: f32,
    scale: f32,
}

impl Binning {
    fn new(boxes: &[Aabb], order: &[u32], axis: usize) -> Option<Binning> {
        let middles = order.iter().map(|i| boxes[*i as usize].middle(axis));
        let (low, high) =
            middles.fold((f32::INFINITY, f32::NEG_INFINITY), |(lo, hi), m| (m.min(lo), m.max(hi)));
        let scale = BINS as f32 / (high - low);
        (high > low && scale.is_finite()).then_some(Binning { axis, low, scale })
    }

    fn bin(&self, bounds: &Aabb) -> usize {
        (((bounds.middle(self.axis) - self.low) * self.scale) as usize).min(BINS - 1)
    }
}
