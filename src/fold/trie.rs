//! Terms as a tree of factors: a term is a parent times one factor.

use crate::scene::factor::{Factor, Kind};

/// The empty product: the root of every trie.
pub const ROOT: u32 = 0;

/// What a node of the trie is there for, besides being a parent.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Marks(u8);

impl Marks {
    /// Coefficients stand in front of it.
    pub const TERM: Marks = Marks(1);
    /// A branch that ended here: its factor was zero, its weight too low, or it was too deep.
    pub const FRONTIER: Marks = Marks(2);
    /// An opaque material that stopped a shadow ray of the parent's node.
    pub const WITNESS: Marks = Marks(4);

    /// The marks with these bits, or `None` if there are none with some of them.
    pub const fn from_bits(bits: u8) -> Option<Marks> {
        if bits > 7 { None } else { Some(Marks(bits)) }
    }

    /// The bits, for files.
    pub const fn bits(self) -> u8 {
        self.0
    }

    /// Both sets of marks.
    pub const fn and(self, other: Marks) -> Marks {
        Marks(self.0 | other.0)
    }

    /// Whether it has any of the marks of `other`.
    #[inline(always)]
    pub fn has(self, other: Marks) -> bool {
        self.0 & other.0 != 0
    }

    /// Adds the marks of `other`.
    #[inline(always)]
    pub fn add(&mut self, other: Marks) {
        self.0 |= other.0;
    }
}

/// A node: the product of its parent and one factor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TrieNode {
    /// The parent's id, lower than the node's own; the root's parent is the root.
    pub parent: u32,
    /// What it multiplies; meaningless for the root.
    pub factor: Factor,
    /// What it is there for.
    pub marks: Marks,
}

impl TrieNode {
    /// What it is there for if trees end at it.
    pub fn end_mark(&self) -> Marks {
        match self.factor.kind() {
            Kind::Shadow => Marks::WITNESS,
            _ => Marks::FRONTIER,
        }
    }
}

/// Products of factors, each stored once, parents before children.
///
/// # Invariants
/// Node 0 is the root; a node's parent has a lower id; no two nodes have the same parent and factor.
#[derive(Clone, Debug)]
pub struct Trie {
    nodes: Vec<TrieNode>,
    /// Open addressing over ids; [`EMPTY`] marks a free place. A power of two long, at most half
    /// full; without any place in a renumbered trie, which nobody adds to.
    table: Vec<u32>,
}

const EMPTY: u32 = u32::MAX;
const NO_FACTOR: Factor = Factor::new(Kind::Background, 0, 0);

impl Default for Trie {
    fn default() -> Trie {
        let mut trie = Trie { nodes: Vec::new(), table: vec![EMPTY; 256] };
        trie.clear();
        trie
    }
}

impl PartialEq for Trie {
    fn eq(&self, other: &Trie) -> bool {
        self.nodes == other.nodes
    }
}

impl Trie {
    /// Leaves the root alone and keeps the memory.
    pub fn clear(&mut self) {
        self.nodes.clear();
        self.nodes.push(TrieNode { parent: ROOT, factor: NO_FACTOR, marks: Marks::default() });
        self.table.fill(EMPTY);
    }

    /// All nodes, parents first.
    #[inline(always)]
    pub fn nodes(&self) -> &[TrieNode] {
        &self.nodes
    }

    /// Allocated bytes.
    pub fn bytes(&self) -> usize {
        self.nodes.capacity() * size_of::<TrieNode>() + self.table.capacity() * 4
    }

    /// Adds marks to a node.
    #[inline(always)]
    pub fn mark(&mut self, id: u32, marks: Marks) {
        self.nodes[id as usize].marks.add(marks);
    }

    /// The id of `parent · factor`, made if it is new.
    #[inline(always)]
    pub fn intern(&mut self, parent: u32, factor: Factor) -> u32 {
        assert!(!self.table.is_empty(), "a renumbered trie is only read");
        let mask = self.table.len() - 1;
        let mut at = hash(parent, factor) as usize & mask;
        loop {
            let id = self.table[at];
            if id == EMPTY {
                return self.insert(parent, factor, at);
            }
            let node = &self.nodes[id as usize];
            if node.parent == parent && node.factor == factor {
                return id;
            }
            at = (at + 1) & mask;
        }
    }

    #[cold]
    fn insert(&mut self, parent: u32, factor: Factor, at: usize) -> u32 {
        let id = self.nodes.len() as u32;
        assert!(id < EMPTY, "fewer than 2^32 terms");
        self.nodes.push(TrieNode { parent, factor, marks: Marks::default() });
        self.table[at] = id;
        if self.nodes.len() * 2 > self.table.len() {
            self.rehash(self.table.len() * 2);
        }
        id
    }

    fn rehash(&mut self, places: usize) {
        self.table.clear();
        self.table.resize(places, EMPTY);
        for (id, node) in self.nodes.iter().enumerate().skip(1) {
            let mut at = hash(node.parent, node.factor) as usize & (places - 1);
            while self.table[at] != EMPTY {
                at = (at + 1) & (places - 1);
            }
            self.table[at] = id as u32;
        }
    }

    /// For every id its place in canonical order: depth first, children by factor. The order
    /// depends on the set of products alone, not on the order in which they were found.
    pub fn canonical_ranks(&self) -> Vec<u32> {
        let mut by_parent: Vec<u32> = (1..self.nodes.len() as u32).collect();
        let key = |&id: &u32| {
            let node = &self.nodes[id as usize];
            (node.parent, std::cmp::Reverse(node.factor))
        };
        by_parent.sort_unstable_by_key(key);
        let mut first = vec![0u32; self.nodes.len() + 1];
        for id in &by_parent {
            first[self.nodes[*id as usize].parent as usize + 1] += 1;
        }
        for i in 1..first.len() {
            first[i] += first[i - 1];
        }
        let mut ranks = vec![0; self.nodes.len()];
        let mut stack = vec![ROOT];
        let mut rank = 0;
        while let Some(id) = stack.pop() {
            ranks[id as usize] = rank;
            rank += 1;
            // Children lie in falling order, so that the lowest is popped first.
            let range = first[id as usize] as usize..first[id as usize + 1] as usize;
            stack.extend_from_slice(&by_parent[range]);
        }
        ranks
    }

    /// The same terms, only to be read.
    pub fn frozen(&self) -> Trie {
        Trie { nodes: self.nodes.clone(), table: Vec::new() }
    }

    /// Exchanges factors for others in the same order. The result cannot be added to.
    pub fn rename(&mut self, other: impl Fn(Factor) -> Factor) {
        self.nodes.iter_mut().skip(1).for_each(|node| node.factor = other(node.factor));
        self.table = Vec::new();
    }

    /// The same terms, to be added to.
    pub fn growing(&self) -> Trie {
        let mut trie = Trie { nodes: self.nodes.clone(), table: Vec::new() };
        trie.rehash((self.nodes.len() * 4).next_power_of_two().max(256));
        trie
    }

    /// The terms that `used` marks, and those that lead to them, with these marks; and the new id of
    /// every one of them. The order stays. The result cannot be added to.
    pub fn only(&self, used: &[Marks]) -> (Trie, Vec<u32>) {
        let none = Marks::default();
        let mut needed: Vec<bool> = used.iter().map(|&marks| marks != none).collect();
        needed[ROOT as usize] = true;
        for (id, node) in self.nodes.iter().enumerate().rev() {
            if needed[id] {
                needed[node.parent as usize] = true;
            }
        }
        let mut ids = vec![0; self.nodes.len()];
        let mut nodes = Vec::new();
        for (id, node) in self.nodes.iter().enumerate().filter(|(id, _)| needed[*id]) {
            ids[id] = nodes.len() as u32;
            let parent = ids[node.parent as usize];
            nodes.push(TrieNode { parent, marks: used[id], ..*node });
        }
        (Trie { nodes, table: Vec::new() }, ids)
    }

    /// Renumbers by `ranks` (from [`Trie::canonical_ranks`]). The result cannot be added to.
    pub fn renumbered(&self, ranks: &[u32]) -> Trie {
        let mut nodes = self.nodes.clone();
        for (node, &rank) in self.nodes.iter().zip(ranks) {
            nodes[rank as usize] = TrieNode { parent: ranks[node.parent as usize], ..*node };
        }
        Trie { nodes, table: Vec::new() }
    }

    /// A renumbered trie of these nodes, which stand in canonical order: the root, then depth first,
    /// children by rising factor. `None` if they do not.
    pub fn from_canonical(nodes: Vec<TrieNode>) -> Option<Trie> {
        let root = TrieNode { parent: ROOT, factor: NO_FACTOR, marks: Marks::default() };
        let (first, rest) = nodes.split_first()?;
        let mut path = vec![ROOT];
        for (id, node) in (1u32..).zip(rest) {
            // The last one left behind on the way back to the parent is its child before this one.
            let mut sibling = None;
            while *path.last()? != node.parent {
                sibling = path.pop();
            }
            if sibling.is_some_and(|s| nodes[s as usize].factor >= node.factor) {
                return None;
            }
            path.push(id);
        }
        (first.parent == root.parent && first.factor == root.factor)
            .then(|| Trie { nodes, table: Vec::new() })
    }

    /// The factors of a term from the eye on.
    pub fn factors(&self, mut id: u32) -> Vec<Factor> {
        let mut factors = Vec::new();
        while id != ROOT {
            let node = &self.nodes[id as usize];
            factors.push(node.factor);
            id = node.parent;
        }
        factors.reverse();
        factors
    }
}

#[inline(always)]
fn hash(parent: u32, factor: Factor) -> u32 {
    let key = (u64::from(parent) << 32 | u64::from(factor.bits())) ^ 0x9e37_79b9_7f4a_7c15;
    (key.wrapping_mul(0xd6e8_feb8_6659_fd93) >> 32) as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    fn f(kind: Kind, index: u16) -> Factor {
        Factor::new(kind, index, 0)
    }

    #[test]
    fn products_are_interned_once_and_spell_their_factors() {
        let mut trie = Trie::default();
        let mut ids = Vec::new();
        for i in 0..1000u16 {
            let a = trie.intern(ROOT, f(Kind::Reflect, i % 10));
            ids.push(trie.intern(a, f(Kind::Diffuse, i)));
        }
        assert_eq!(trie.nodes().len(), 1 + 10 + 1000);
        for (i, id) in ids.iter().enumerate() {
            let i = i as u16;
            assert_eq!(trie.factors(*id), [f(Kind::Reflect, i % 10), f(Kind::Diffuse, i)]);
        }
    }

    #[test]
    fn canonical_order_forgets_the_order_of_discovery() {
        let words: Vec<Vec<Factor>> = (0..300u16)
            .map(|i| vec![f(Kind::Reflect, i % 7), f(Kind::Transmit, i % 11), f(Kind::Diffuse, i)])
            .collect();
        let build = |order: &mut dyn Iterator<Item = usize>| {
            let mut trie = Trie::default();
            for i in order {
                let id = words[i].iter().fold(ROOT, |p, &w| trie.intern(p, w));
                trie.mark(id, Marks::TERM);
            }
            trie.renumbered(&trie.canonical_ranks())
        };
        let forward = build(&mut (0..300));
        let backward = build(&mut (0..300).rev());
        assert_eq!(forward, backward);
        let spelled: Vec<_> =
            (1..forward.nodes().len() as u32).map(|i| forward.factors(i)).collect();
        assert!(spelled.is_sorted(), "depth-first order is the order of the words");
        assert!(forward.nodes().iter().enumerate().skip(1).all(|(i, n)| (n.parent as usize) < i));
        assert_eq!(Trie::from_canonical(forward.nodes().to_vec()), Some(forward));
    }

    #[test]
    fn nodes_in_another_than_canonical_order_are_no_trie() {
        let mut trie = Trie::default();
        for i in 0..6u16 {
            let a = trie.intern(ROOT, f(Kind::Reflect, i % 3));
            trie.intern(a, f(Kind::Diffuse, i));
        }
        let sound = trie.renumbered(&trie.canonical_ranks()).nodes().to_vec();
        assert!(Trie::from_canonical(sound.clone()).is_some());
        assert_eq!(Trie::from_canonical(Vec::new()), None);
        for (id, node) in sound.iter().enumerate() {
            for parent in (0..=sound.len() as u32).filter(|p| *p != node.parent) {
                let mut other = sound.clone();
                other[id].parent = parent;
                // Only a child of a node moved below another one may still be in order.
                let moved = Trie::from_canonical(other);
                assert!(moved.is_none() || (parent as usize) < id, "{id} below {parent}");
            }
            let mut other = sound.clone();
            other.swap(id, (id + 1) % sound.len());
            assert_eq!(Trie::from_canonical(other), None, "{id} and the next one swapped");
        }
        let twice = [sound[0], sound[1], TrieNode { parent: 0, ..sound[1] }];
        assert_eq!(Trie::from_canonical(twice.to_vec()), None, "one product twice");
    }
}
