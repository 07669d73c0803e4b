//! The binary tree that the wide hierarchy is collapsed from: surface area heuristic, swept for few
//! primitives and binned for many (Wald, *On fast construction of SAH-based BVHs*, 2007).
//!
//! A large range is read twice per split: into bins along all axes at once, and when it is parted,
//! which also finds the bounds of the parts. A small one is sorted once along every axis; its parts
//! take their orders over.

use crate::progress::{Cancelled, Progress};

/// Above this many primitives splits are looked for between bins instead of all primitives.
const SWEEP_MAX: usize = 32;
/// Bins per axis.
const BINS: usize = 16;
/// A swept split must cost less than this share of no split.
const LEAST_SAVING: f32 = 0.9999;
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
            lo: std::array::from_fn(|k| lesser(self.lo[k], other.lo[k])),
            hi: std::array::from_fn(|k| -lesser(-self.hi[k], -other.hi[k])),
        }
    }

    /// Half of the surface; 0 for the empty box.
    pub(super) fn area(&self) -> f32 {
        let [x, y, z] = std::array::from_fn(|k| (self.hi[k] - self.lo[k]).max(0.0));
        x * y + y * z + z * x
    }

    /// Twice the middle.
    fn middle(&self) -> [f32; 3] {
        std::array::from_fn(|k| self.lo[k] + self.hi[k])
    }

    /// The smallest box around this one and a point.
    fn with(&self, point: [f32; 3]) -> Aabb {
        self.union(&Aabb { lo: point, hi: point })
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

/// A primitive while the tree is built.
#[derive(Clone, Copy)]
struct Entry {
    bounds: Aabb,
    /// Index of the box.
    item: u32,
}

/// A range of entries that is to be split.
struct Open {
    /// Its node.
    node: usize,
    depth: u32,
    /// Around the doubled middles of its entries.
    middles: Aabb,
    /// Whether `Builder::sorted` holds its places in order.
    is_sorted: bool,
}

/// What is known of a part when a range has been split.
struct Part {
    bounds: Aabb,
    middles: Aabb,
}

impl Part {
    const EMPTY: Part = Part { bounds: Aabb::EMPTY, middles: Aabb::EMPTY };

    fn add(&mut self, bounds: &Aabb) {
        self.bounds = self.bounds.union(bounds);
        self.middles = self.middles.with(bounds.middle());
    }
}

impl BinaryTree {
    /// Builds down to single primitives. Iterative, deterministic, and of bounded depth whatever the
    /// boxes are.
    pub(super) fn build(boxes: &[Aabb], progress: &Progress) -> Result<BinaryTree, Cancelled> {
        let mut tree = BinaryTree::default();
        if boxes.is_empty() {
            return Ok(tree);
        }
        tree.nodes.reserve_exact(2 * boxes.len());
        let mut builder = Builder::new(boxes);
        let mut all = Part::EMPTY;
        boxes.iter().for_each(|bounds| all.add(bounds));
        tree.push(&all, 0, boxes.len());
        let mut open = vec![Open { node: 0, depth: 0, middles: all.middles, is_sorted: false }];
        while let Some(Open { node, depth, middles, is_sorted }) = open.pop() {
            progress.check()?;
            let BinaryNode { bounds: _, begin, end, left: _ } = tree.nodes[node];
            let (begin, end) = (begin as usize, end as usize);
            if end - begin == 1 {
                continue;
            }
            let small = end - begin <= SWEEP_MAX;
            if small && !is_sorted {
                builder.sort(begin, end);
            }
            let (count, parts) = match small {
                true => builder.sweep(begin, end, depth),
                false => builder.bin(begin, end, depth, &middles),
            };
            let left = tree.push(&parts[0], begin, begin + count);
            tree.push(&parts[1], begin + count, end);
            tree.nodes[node].left = left as u32;
            let opened = |k: usize| Open {
                node: left + k,
                depth: depth + 1,
                middles: parts[k].middles,
                is_sorted: small,
            };
            open.extend([opened(1), opened(0)]);
        }
        tree.order = builder.order();
        Ok(tree)
    }

    fn push(&mut self, part: &Part, begin: usize, end: usize) -> usize {
        let bounds = part.bounds;
        self.nodes.push(BinaryNode { bounds, begin: begin as u32, end: end as u32, left: 0 });
        self.nodes.len() - 1
    }
}

/// The entries in the tree's order, as far as it is known, and scratch.
struct Builder {
    entries: Vec<Entry>,
    /// Per axis: in ranges that are swept, places of entries in the order of their middles.
    sorted: [Vec<u32>; 3],
    /// Of the part on the right while a range is parted.
    right: Vec<Entry>,
    right_places: Vec<u32>,
    /// By place: whether a swept entry goes left.
    goes_left: Vec<bool>,
    areas: Vec<f32>,
}

impl Builder {
    fn new(boxes: &[Aabb]) -> Builder {
        let entry = |(bounds, item): (&Aabb, u32)| Entry { bounds: *bounds, item };
        Builder {
            entries: boxes.iter().zip(0..).map(entry).collect(),
            sorted: std::array::from_fn(|_| (0..boxes.len() as u32).collect()),
            right: Vec::new(),
            right_places: Vec::new(),
            goes_left: vec![false; boxes.len()],
            areas: Vec::new(),
        }
    }

    /// The items in the tree's order.
    fn order(&self) -> Vec<u32> {
        self.sorted[0].iter().map(|place| self.entries[*place as usize].item).collect()
    }

    /// Sorts the places of a range along every axis; of equal middles the lower item comes first.
    fn sort(&mut self, begin: usize, end: usize) {
        for axis in 0..3 {
            let key = |place: &u32| {
                let Entry { bounds, item } = &self.entries[*place as usize];
                (ordered(bounds.lo[axis] + bounds.hi[axis]), *item)
            };
            self.sorted[axis][begin..end].sort_unstable_by_key(key);
        }
    }

    /// Parts a sorted range at the best of all places along all axes; at least one goes to each side.
    fn sweep(&mut self, begin: usize, end: usize, depth: u32) -> (usize, [Part; 2]) {
        let total = end - begin;
        let whole = self.entries[begin..end].iter();
        let whole = whole.fold(Aabb::EMPTY, |all, entry| all.union(&entry.bounds));
        // What does not even save this is halved by number.
        let (mut best_cost, mut best) =
            (whole.area() * total as f32 * LEAST_SAVING, (0, total / 2));
        if total > 2 && depth < HALVE_FROM_DEPTH {
            for axis in 0..3 {
                let places = &self.sorted[axis][begin..end];
                let bounds_of = |place: &u32| &self.entries[*place as usize].bounds;
                self.areas.clear();
                let mut bounds = Aabb::EMPTY;
                for place in places.iter().rev() {
                    bounds = bounds.union(bounds_of(place));
                    self.areas.push(bounds.area());
                }
                let mut bounds = Aabb::EMPTY;
                for (count, place) in (1..total).zip(places) {
                    bounds = bounds.union(bounds_of(place));
                    let rest = total - count;
                    let cost = bounds.area() * count as f32 + self.areas[rest - 1] * rest as f32;
                    if cost < best_cost {
                        (best_cost, best) = (cost, (axis, count));
                    }
                }
            }
        }
        let (axis, count) = best;
        let mut parts = [Part::EMPTY, Part::EMPTY];
        for (k, place) in self.sorted[axis][begin..end].iter().enumerate() {
            let is_left = k < count;
            self.goes_left[*place as usize] = is_left;
            let part = &mut parts[usize::from(!is_left)];
            part.bounds = part.bounds.union(&self.entries[*place as usize].bounds);
        }
        for other in (0..3).filter(|other| *other != axis) {
            let places = &mut self.sorted[other][begin..end];
            part_by(places, &mut self.right_places, |place| self.goes_left[*place as usize]);
        }
        (count, parts)
    }

    /// Parts a range between bins of equal width along the best axis; at least one goes to each side.
    fn bin(&mut self, begin: usize, end: usize, depth: u32, middles: &Aabb) -> (usize, [Part; 2]) {
        let entries = &mut self.entries[begin..end];
        let split = if depth < HALVE_FROM_DEPTH { best_bin(entries, middles) } else { None };
        let mut parts = [Part::EMPTY, Part::EMPTY];
        let Some((binning, axis, bin)) = split else {
            let count = entries.len() / 2;
            for (k, entry) in entries.iter().enumerate() {
                parts[usize::from(k >= count)].add(&entry.bounds);
            }
            return (count, parts);
        };
        // Both sides keep the order of the scene.
        let count = part_by(entries, &mut self.right, |entry| {
            let is_left = binning.bins(&entry.bounds)[axis] < bin;
            parts[usize::from(!is_left)].add(&entry.bounds);
            is_left
        });
        (count, parts)
    }
}

/// Moves what `goes_left` to the front, both parts in the order they had; returns how many those are.
fn part_by<T: Copy>(
    items: &mut [T],
    right: &mut Vec<T>,
    mut goes_left: impl FnMut(&T) -> bool,
) -> usize {
    right.clear();
    let mut count = 0;
    for i in 0..items.len() {
        let item = items[i];
        if goes_left(&item) {
            items[count] = item;
            count += 1;
        } else {
            right.push(item);
        }
    }
    items[count..].copy_from_slice(right);
    count
}

/// The best split between bins along any axis: what is in a bin below this one goes left. `None` if all
/// middles coincide.
fn best_bin(entries: &[Entry], middles: &Aabb) -> Option<(Binning, usize, usize)> {
    let binning = Binning::new(middles);
    let mut bins = [[(Aabb::EMPTY, 0usize); BINS]; 3];
    for Entry { bounds, item: _ } in entries {
        for (bins, bin) in bins.iter_mut().zip(binning.bins(bounds)) {
            let bin = &mut bins[bin];
            *bin = (bin.0.union(bounds), bin.1 + 1);
        }
    }
    let (mut best_cost, mut best) = (f32::INFINITY, None);
    for (axis, bins) in bins.iter().enumerate() {
        let mut suffix = [(Aabb::EMPTY, 0usize); BINS + 1];
        for k in (0..BINS).rev() {
            suffix[k] = (suffix[k + 1].0.union(&bins[k].0), suffix[k + 1].1 + bins[k].1);
        }
        let mut left = (Aabb::EMPTY, 0);
        for k in 1..BINS {
            left = (left.0.union(&bins[k - 1].0), left.1 + bins[k - 1].1);
            let cost = left.0.area() * left.1 as f32 + suffix[k].0.area() * suffix[k].1 as f32;
            if left.1 > 0 && suffix[k].1 > 0 && cost < best_cost {
                (best_cost, best) = (cost, Some((binning, axis, k)));
            }
        }
    }
    best
}

/// Equal bins along every axis; one bin along an axis on which all middles coincide.
#[derive(Clone, Copy, Debug)]
struct Binning {
    low: [f32; 3],
    scale: [f32; 3],
}

impl Binning {
    fn new(middles: &Aabb) -> Binning {
        let scale = |k: usize| BINS as f32 / (middles.hi[k] - middles.lo[k]);
        let finite = |scale: f32| if scale.is_finite() { scale } else { 0.0 };
        Binning { low: middles.lo, scale: std::array::from_fn(|k| finite(scale(k))) }
    }

    fn bins(&self, bounds: &Aabb) -> [usize; 3] {
        let middle = bounds.middle();
        std::array::from_fn(|k| {
            (((middle[k] - self.low[k]) * self.scale[k]) as usize).min(BINS - 1)
        })
    }
}

/// The smaller of two; `f32::min` also looks for NaN, which no box holds.
fn lesser(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// A number that grows with `x`, −0 below +0.
fn ordered(x: f32) -> u32 {
    let bits = x.to_bits();
    if bits >> 31 == 1 { !bits } else { bits | 1 << 31 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::testing::Random;

    fn tree(boxes: &[Aabb]) -> BinaryTree {
        BinaryTree::build(boxes, &Progress::default()).unwrap()
    }

    /// Checks that every primitive is in the order once, that children share the range of their node
    /// and follow it, and that bounds are those of what is below; returns the depth.
    fn checked(boxes: &[Aabb]) -> usize {
        let BinaryTree { nodes, order } = tree(boxes);
        let mut items = order.clone();
        items.sort_unstable();
        assert!(items.into_iter().eq(0..boxes.len() as u32));
        let mut depths = vec![0; nodes.len()];
        for (i, node) in nodes.iter().enumerate() {
            let BinaryNode { bounds, begin, end, left } = *node;
            let under = order[begin as usize..end as usize].iter();
            let around = under.fold(Aabb::EMPTY, |all, item| all.union(&boxes[*item as usize]));
            assert_eq!(bounds, around);
            if left == 0 {
                assert_eq!(end - begin, 1);
                continue;
            }
            let [a, b] = [&nodes[left as usize], &nodes[left as usize + 1]];
            assert!(left as usize > i && a.begin < a.end && b.begin < b.end);
            assert_eq!((a.begin, a.end, b.end), (begin, b.begin, end));
            depths[left as usize] = depths[i] + 1;
            depths[left as usize + 1] = depths[i] + 1;
        }
        depths.into_iter().max().unwrap_or(0)
    }

    fn cube(center: [f32; 3], half: f32) -> Aabb {
        Aabb { lo: center.map(|x| x - half), hi: center.map(|x| x + half) }
    }

    #[test]
    fn trees_hold_every_primitive_once_in_tight_boxes() {
        let mut random = Random(5);
        for count in [0, 1, 2, 3, 31, 32, 33, 34, 500, 5000] {
            let boxes: Vec<Aabb> = (0..count)
                .map(|_| cube(random.in_cube().to_array().map(|x| x as f32), 1e-2))
                .collect();
            let depth = checked(&boxes);
            assert!(depth <= 40, "{count}: {depth}");
        }
    }

    #[test]
    fn what_cannot_be_told_apart_is_halved() {
        assert_eq!(checked(&vec![cube([0.5; 3], 0.1); 4096]), 12);
        // Every split but the halving ones would take one away.
        let nested: Vec<Aabb> = (0..300).map(|i| cube([0.0; 3], 2f32.powi(-i / 3))).collect();
        assert!(checked(&nested) <= 60);
        let running: Vec<Aabb> =
            (0..3000).map(|i| cube([2f32.powi(-i / 25), 0.0, 0.0], 0.0)).collect();
        assert!(checked(&running) <= 60);
    }

    #[test]
    fn far_groups_are_parted_first() {
        let groups = [-1.0, 1.0].into_iter().flat_map(|x| (0..40).map(move |i| (x, i)));
        let boxes: Vec<Aabb> = groups.map(|(x, i)| cube([x, 0.0, i as f32 * 1e-4], 1e-3)).collect();
        let BinaryTree { nodes, order } = tree(&boxes);
        assert_eq!((nodes[1].begin, nodes[1].end), (0, 40));
        assert!(order[..40].iter().all(|item| *item < 40));
    }

    #[test]
    fn numbers_are_ordered_as_floats_are() {
        let rising = [f32::NEG_INFINITY, -2.5, -1e-40, -0.0, 0.0, 1e-40, 3.0, f32::INFINITY];
        assert!(rising.map(ordered).is_sorted_by(|a, b| a < b));
    }
}
