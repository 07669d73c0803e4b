//! Ray trees as they are kept: what rays met, from which everything else is computed again.

use super::tree::{BEHIND, BLOCKED, Branch, Ends, LightHit, Node, TileTrees, entries};
use crate::film::layout::{LANES, TILE_BLOCKS};

/// Where a ray of the seen path met a surface: 16 bytes. The ray itself follows from the pixel, the
/// sample and the nodes above, and so do normals, media and cosines.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KeptNode {
    /// Distance along the ray, world units.
    pub t: f64,
    /// The primitive of the geometry that was met.
    pub primitive: u32,
    /// Number of [`KeptLight`]s that belong to this node.
    pub lights: u16,
    /// What became of its branches.
    pub ends: Ends,
}

impl KeptNode {
    /// What is kept of a node.
    #[inline(always)]
    pub(super) fn of(node: &Node) -> KeptNode {
        let Node {
            t,
            primitive,
            material: _,
            lights,
            slot: _,
            whole: _,
            toned: _,
            ends,
            fresnel: _,
        } = *node;
        KeptNode { t, primitive, lights, ends }
    }
}

/// What the shadow ray towards a light met: 4 bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct KeptLight {
    /// The light's key: a light at another place has another key.
    pub key: u16,
    /// How many entries of `crossings` belong to it; or [`BLOCKED`], or [`BEHIND`].
    pub crossed: u16,
}

/// The kept trees of one tile, in the order of its blocks, their pixels and samples.
///
/// # Invariants
/// As those of [`TileTrees`], of which they are a part. Written by `session`, read by `grow`, which
/// takes from them the answers to the rays that it would otherwise cast.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct KeptTrees {
    /// Where sampling is adaptive, the number of samples of every lane of every block.
    pub counts: Vec<u16>,
    /// Where each of the tile's 64 blocks begins, and the end.
    pub blocks: Vec<KeptStart>,
    /// Per sample a bit, whether its ray met the scene: sample 0 of a block is bit 0 of its first
    /// word, sample 64 bit 0 of the next.
    pub hits: Vec<u64>,
    /// Nodes of all samples, in preorder.
    pub nodes: Vec<KeptNode>,
    /// Light records of all nodes.
    pub lights: Vec<KeptLight>,
    /// Solids that shadow rays crossed, or witnesses that stopped them.
    pub crossings: Vec<u32>,
}

/// A position in all arrays of a [`KeptTrees`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct KeptStart {
    /// Index into `hits`.
    pub word: u32,
    /// Index into `nodes`.
    pub node: u32,
    /// Index into `lights`.
    pub light: u32,
    /// Index into `crossings`.
    pub crossing: u32,
}

impl KeptTrees {
    /// Empties it, to be filled block by block.
    pub fn clear(&mut self) {
        let KeptTrees { counts, blocks, hits, nodes, lights, crossings } = self;
        counts.clear();
        blocks.clear();
        blocks.push(KeptStart::default());
        hits.clear();
        nodes.clear();
        lights.clear();
        crossings.clear();
    }

    /// Makes room for as much as `other` holds.
    pub fn reserve_as(&mut self, other: &KeptTrees) {
        let KeptTrees { counts, blocks, hits, nodes, lights, crossings } = other;
        self.counts.reserve_exact(counts.len());
        self.blocks.reserve_exact(blocks.len());
        self.hits.reserve_exact(hits.len());
        self.nodes.reserve_exact(nodes.len());
        self.lights.reserve_exact(lights.len());
        self.crossings.reserve_exact(crossings.len());
    }

    /// Whether every block is there.
    pub fn is_whole(&self) -> bool {
        self.blocks.len() == TILE_BLOCKS + 1
    }

    /// Allocated bytes of all arrays.
    pub fn bytes(&self) -> usize {
        let KeptTrees { counts, blocks, hits, nodes, lights, crossings } = self;
        counts.capacity() * 2
            + blocks.capacity() * size_of::<KeptStart>()
            + hits.capacity() * 8
            + nodes.capacity() * size_of::<KeptNode>()
            + lights.capacity() * size_of::<KeptLight>()
            + crossings.capacity() * 4
    }

    /// Bytes of what is stored, without room for more.
    pub fn used_bytes(&self) -> usize {
        let KeptTrees { counts, blocks, hits, nodes, lights, crossings } = self;
        size_of_val(&**counts)
            + size_of_val(&**blocks)
            + size_of_val(&**hits)
            + size_of_val(&**nodes)
            + size_of_val(&**lights)
            + size_of_val(&**crossings)
    }

    /// Notes how many samples each lane of the block appended next has, where they may differ.
    pub fn push_counts(&mut self, counts: &[u32; LANES]) {
        self.counts.extend(counts.map(|count| count as u16));
    }

    /// Appends a block just grown, the first one in `grown`. `keys` has one key per light.
    pub fn push_grown(&mut self, grown: &TileTrees, keys: &[u16]) {
        // Colours are found again from the points.
        let TileTrees { blocks: _, hits, weights: _, nodes, lights, crossings, tones: _, skies: _ } =
            grown;
        self.hits.extend(hits.chunks(64).map(|bits| {
            bits.iter().enumerate().fold(0u64, |word, (i, &hit)| word | u64::from(hit) << i)
        }));
        self.nodes.extend(nodes.iter().map(KeptNode::of));
        self.lights.extend(lights.iter().map(|hit| {
            let LightHit { light, crossed, n_dot_l: _, angle: _, weight: _ } = *hit;
            KeptLight { key: keys[light as usize], crossed }
        }));
        self.crossings.extend_from_slice(crossings);
        self.end_block();
    }

    /// Appends a block of other trees.
    pub fn push_block(&mut self, other: &KeptTrees, block: usize) {
        let [from, to] = [other.blocks[block], other.blocks[block + 1]];
        let range = |a: u32, b: u32| a as usize..b as usize;
        if !other.counts.is_empty() {
            self.counts.extend_from_slice(&other.counts[block * LANES..(block + 1) * LANES]);
        }
        self.hits.extend_from_slice(&other.hits[range(from.word, to.word)]);
        self.nodes.extend_from_slice(&other.nodes[range(from.node, to.node)]);
        self.lights.extend_from_slice(&other.lights[range(from.light, to.light)]);
        self.crossings.extend_from_slice(&other.crossings[range(from.crossing, to.crossing)]);
        self.end_block();
    }

    /// Appends a block of which nothing is known: no lane of it has a sample.
    pub fn push_unknown(&mut self) {
        self.push_counts(&[0; LANES]);
        self.end_block();
    }

    /// Appends what stands in other trees between two positions of a sample's tree.
    pub(super) fn push_range(&mut self, other: &KeptTrees, from: KeptStart, to: KeptStart) {
        let range = |a: u32, b: u32| a as usize..b as usize;
        self.nodes.extend_from_slice(&other.nodes[range(from.node, to.node)]);
        self.lights.extend_from_slice(&other.lights[range(from.light, to.light)]);
        self.crossings.extend_from_slice(&other.crossings[range(from.crossing, to.crossing)]);
    }

    /// Ends a block whose camera rays met what they met in `other`.
    pub(super) fn end_block_as(&mut self, other: &KeptTrees, block: usize) {
        let [from, to] = [other.blocks[block], other.blocks[block + 1]];
        if !other.counts.is_empty() {
            self.counts.extend_from_slice(&other.counts[block * LANES..(block + 1) * LANES]);
        }
        self.hits.extend_from_slice(&other.hits[from.word as usize..to.word as usize]);
        self.end_block();
    }

    fn end_block(&mut self) {
        self.blocks.push(KeptStart {
            word: self.hits.len() as u32,
            node: self.nodes.len() as u32,
            light: self.lights.len() as u32,
            crossing: self.crossings.len() as u32,
        });
    }

    /// The same trees, moved to smaller memory if they leave more than an eighth of theirs free.
    pub fn trimmed(mut self) -> KeptTrees {
        let KeptTrees { counts, blocks, hits, nodes, lights, crossings } = &mut self;
        trim(counts);
        trim(blocks);
        trim(hits);
        trim(nodes);
        trim(lights);
        trim(crossings);
        self
    }

    /// Reads a block's samples in order.
    pub fn recall(&self, block: usize) -> Recall<'_> {
        let at = self.blocks[block];
        Recall { trees: self, block, at, bit: 0, current: false }
    }

    /// The same of trees that were grown of the scene of today: every ray that is followed goes on as
    /// it did.
    pub fn recall_current(&self, block: usize) -> Recall<'_> {
        Recall { current: true, ..self.recall(block) }
    }
}

fn trim<T>(array: &mut Vec<T>) {
    if array.capacity() > array.len() + array.len() / 8 {
        array.shrink_to_fit();
    }
}

/// Reads kept trees in order.
pub struct Recall<'a> {
    trees: &'a KeptTrees,
    block: usize,
    at: KeptStart,
    bit: u32,
    current: bool,
}

/// What is known of a block's samples.
#[derive(Default)]
pub struct Recalls<'a> {
    /// Of the first samples, as many as it counts: trees of the scene of today.
    pub first: Option<Recall<'a>>,
    /// Of all others, and of those too where the above knows nothing.
    pub rest: Option<Recall<'a>>,
}

impl<'a> From<Option<Recall<'a>>> for Recalls<'a> {
    fn from(rest: Option<Recall<'a>>) -> Recalls<'a> {
        Recalls { first: None, rest }
    }
}

/// A kept node with what its shadow rays met.
#[derive(Clone, Copy)]
pub struct Recalled<'a> {
    /// The node.
    pub node: &'a KeptNode,
    /// Whether its rays go on as they did.
    pub(super) current: bool,
    lights: &'a [KeptLight],
    crossings: &'a [u32],
}

impl<'a> Recall<'a> {
    /// How many samples of a lane there are, if not as many as of every other.
    #[inline(always)]
    pub(super) fn count(&self, lane: usize) -> Option<u32> {
        self.trees.counts.get(self.block * LANES + lane).map(|&count| count.into())
    }

    /// Whether the next sample's ray met the scene; its nodes follow.
    #[inline(always)]
    pub fn sample(&mut self) -> bool {
        let word = self.trees.hits[self.at.word as usize];
        let hit = word >> self.bit & 1 != 0;
        self.bit += 1;
        if self.bit == 64 {
            (self.bit, self.at.word) = (0, self.at.word + 1);
        }
        hit
    }

    /// The next node.
    #[inline(always)]
    pub fn node(&mut self) -> Recalled<'a> {
        let trees = self.trees;
        let node = &trees.nodes[self.at.node as usize];
        let from = self.at.light as usize;
        let lights = &trees.lights[from..from + node.lights as usize];
        let crossings = &trees.crossings[self.at.crossing as usize..];
        self.at.node += 1;
        self.at.light += u32::from(node.lights);
        self.at.crossing += lights.iter().map(|light| light.entries() as u32).sum::<u32>();
        Recalled { node, current: self.current, lights, crossings }
    }

    /// The next node, which is still to be read.
    #[inline(always)]
    pub(super) fn peek(&self) -> &'a KeptNode {
        &self.trees.nodes[self.at.node as usize]
    }

    /// Passes over a node and all below it, and appends them to `into`.
    pub(super) fn copy(&mut self, into: &mut KeptTrees) {
        let from = self.at;
        self.skip();
        into.push_range(self.trees, from, self.at);
    }

    /// Passes over the next sample.
    #[inline(always)]
    pub(super) fn skip_sample(&mut self) {
        if self.sample() {
            self.skip();
        }
    }

    /// Passes over a node and all below it.
    pub fn skip(&mut self) {
        let mut open = 1;
        while open > 0 {
            let ends = self.node().node.ends;
            let below = [ends.reflected(), ends.transmitted()];
            open += below.iter().filter(|&&b| b == Branch::Grown).count();
            open -= 1;
        }
    }
}

impl KeptLight {
    /// How many entries of `crossings` belong to it.
    #[inline(always)]
    fn entries(self) -> usize {
        entries(self.crossed)
    }
}

/// What a shadow ray met.
pub enum Met<'a> {
    /// An opaque solid.
    Blocker(u32),
    /// These solids, each as often as it was crossed.
    Crossed(&'a [u32]),
    /// It was not cast: it had nothing to show.
    Uncast,
}

impl<'a> Recalled<'a> {
    /// All its records, and what all of them crossed.
    pub(super) fn records(&self) -> (&'a [KeptLight], &'a [u32]) {
        let entries = self.lights.iter().map(|light| light.entries()).sum();
        (self.lights, &self.crossings[..entries])
    }

    /// What the next shadow ray to the light with this key met; `None` if there is no record of it.
    /// Lights are asked for in the order in which they are kept, others in between.
    #[inline(always)]
    pub fn light(&mut self, key: u16) -> Option<Met<'a>> {
        let (light, entries) = self.record(key)?;
        Some(match light.crossed {
            BLOCKED => Met::Blocker(entries[0]),
            BEHIND => Met::Uncast,
            _ => Met::Crossed(entries),
        })
    }

    /// The record of that light, with its crossings.
    #[inline(always)]
    pub(super) fn record(&mut self, key: u16) -> Option<(KeptLight, &'a [u32])> {
        let at = self.lights.iter().position(|light| light.key == key)?;
        let before: usize = self.lights[..at].iter().map(|light| light.entries()).sum();
        let light = self.lights[at];
        let (entries, rest) = self.crossings[before..].split_at(light.entries());
        (self.lights, self.crossings) = (&self.lights[at + 1..], rest);
        Some((light, entries))
    }
}
