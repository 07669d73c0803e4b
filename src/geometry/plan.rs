//! How the binary tree becomes a wide one.

use super::binary::{BinaryNode, BinaryTree};
use super::compile::{Item, Kind};
use crate::progress::{Cancelled, Progress};

/// Cost of a node, of a leaf, and of each primitive in it, in one unit. A few tenths more or less
/// change visits and speed by less than 5 %; a low price of primitives makes full leaves and a
/// small tree.
const NODE_COST: f32 = 1.0;
const LEAF_COST: f32 = 1.0;
const PRIMITIVE_COST: f32 = 0.04;

/// How the binary tree is cut into nodes of `N` and leaves of up to `N` primitives of one kind:
/// the cheapest way, by dynamic programming (Ylitie, Karras and Laine, HPG 2017, section 3.1).
pub(super) struct Plan<'a, const N: usize> {
    pub(super) tree: &'a BinaryTree,
    items: &'a [Item],
    /// Per binary node: the cost of covering it with at most 1 … N − 1 children; `[0]` is unused.
    costs: Vec<[f32; N]>,
    /// Per binary node: of `k` children, how many go left; `[0]`: of the `N` of its own node.
    /// 0: the node itself is one child.
    left_share: Vec<[u8; N]>,
    /// Per binary node: the kind of a leaf made of it, if that is the cheapest single child.
    leaf: Vec<Option<Kind>>,
}

impl<const N: usize> Plan<'_, N> {
    /// Plans the whole tree.
    pub(super) fn new<'a>(
        tree: &'a BinaryTree,
        items: &'a [Item],
        progress: &Progress,
    ) -> Result<Plan<'a, N>, Cancelled> {
        let count = tree.nodes.len();
        let mut plan = Plan {
            tree,
            items,
            costs: vec![[0.0; N]; count],
            left_share: vec![[0; N]; count],
            leaf: vec![None; count],
        };
        for binary in (0..count).rev() {
            progress.check()?;
            plan.cover(binary);
        }
        Ok(plan)
    }

    /// Fills in a node whose descendants are filled in.
    fn cover(&mut self, binary: usize) {
        let node = &self.tree.nodes[binary];
        let area = node.bounds.area().max(f32::MIN_POSITIVE);
        let kind = self.kind_of(node);
        let count = (node.end - node.begin) as f32;
        let leaf_cost = area * (LEAF_COST + PRIMITIVE_COST * count);
        if node.left == 0 {
            self.leaf[binary] = kind;
            self.costs[binary] = [leaf_cost; N];
            return;
        }
        let (left, right) = (node.left as usize, node.left as usize + 1);
        let spread = |costs: &[[f32; N]], total: usize| {
            (1.max(total - (N - 1).min(total - 1))..total.min(N))
                .map(|k| (costs[left][k] + costs[right][total - k], k as u8))
                .fold((f32::INFINITY, 1), |best, new| if new.0 < best.0 { new } else { best })
        };
        let (below, share) = spread(&self.costs, N);
        let inner_cost = area * NODE_COST + below;
        self.left_share[binary][0] = share;
        let is_leaf = kind.is_some() && leaf_cost <= inner_cost;
        self.leaf[binary] = kind.filter(|_| is_leaf);
        self.costs[binary][1] = if is_leaf { leaf_cost } else { inner_cost };
        for total in 2..N {
            let (cost, share) = spread(&self.costs, total);
            let fewer = (self.costs[binary][total - 1], self.left_share[binary][total - 1]);
            // The share of fewer children is kept as it is: `children` may leave places empty.
            let (cost, share) = if cost < fewer.0 { (cost, share) } else { (fewer.0, 0) };
            self.costs[binary][total] = cost;
            self.left_share[binary][total] = share;
        }
    }

    /// The kind of up to `N` primitives of one kind.
    fn kind_of(&self, node: &BinaryNode) -> Option<Kind> {
        let order = &self.tree.order[node.begin as usize..node.end as usize];
        let kind = |i: u32| self.items[i as usize].kind;
        let first = kind(order[0]);
        (order.len() <= N && order.iter().all(|i| kind(*i) == first)).then_some(first)
    }

    /// The kind of the leaf that a node becomes as a child, if it becomes one.
    pub(super) fn leaf_kind(&self, binary: u32) -> Option<Kind> {
        self.leaf[binary as usize]
    }

    /// The items of a leaf.
    pub(super) fn items_under(&self, binary: u32) -> impl Iterator<Item = u32> {
        let node = &self.tree.nodes[binary as usize];
        let order = &self.tree.order[node.begin as usize..node.end as usize];
        order.iter().map(|i| self.items[*i as usize].index)
    }

    /// The children of the wide node made of a binary node.
    pub(super) fn children(&self, binary: u32) -> Vec<u32> {
        let halves = |binary: u32, share: u8, total: usize| {
            let left = self.tree.nodes[binary as usize].left;
            [(left + 1, total - share as usize), (left, share as usize)]
        };
        let mut children = Vec::with_capacity(N);
        let mut open = Vec::from(halves(binary, self.left_share[binary as usize][0], N));
        while let Some((part, mut total)) = open.pop() {
            while total > 1 && self.left_share[part as usize][total] == 0 {
                total -= 1;
            }
            match total {
                1 => children.push(part),
                _ => open.extend(halves(part, self.left_share[part as usize][total], total)),
            }
        }
        children
    }
}
