//! The transport matrix: pixels times terms, in blocks of sixteen pixels.

use std::sync::Arc;

use super::trie::Trie;
use crate::film::layout::{LANES, Layout, TILE_BLOCKS};
use crate::scene::factor::Factor;

/// The coefficients of one term for the 16 pixels of a block: 0 where the term does not occur, −0
/// where it does and samples of opposite weights cancel each other.
#[repr(align(64))]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Plane(pub [f32; LANES]);

/// The picture as a linear map: `pixel = Σ coefficient · term`.
///
/// Written by `fold`, read by `shade`, which never needs the trees.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Transport {
    /// The cut of the picture.
    pub layout: Layout,
    /// Samples per pixel.
    pub samples: u32,
    /// All terms of the picture in canonical order.
    pub trie: Trie,
    /// One part per tile, shared with what grows some of the picture again.
    pub tiles: Vec<Arc<TransportTile>>,
}

/// Pixels of a block in which a term may occur at most to be stored as single coefficients; with
/// more it is a [`Plane`]. Up to here single coefficients are smaller, and about as fast.
pub const SPARSE_LANES: u32 = 4;

/// The rows of the matrix that belong to one tile.
///
/// A term of a block is stored as a plane, or, if it occurs in at most [`SPARSE_LANES`] of the 16
/// pixels, as single coefficients. Which of the two depends on where samples found the term, not on
/// parameters, and so does the order of every pixel's sum.
///
/// # Invariants ([`Transport::validate`])
/// `terms` rises; the entries of a block rise, and so do the places of its single coefficients;
/// `planes` has one plane per entry; `starts` has one more element than the tile has blocks.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TransportTile {
    /// Ids of the terms that occur in the tile: its dictionary.
    pub terms: Vec<u32>,
    /// Where each block's parts begin, and the end.
    pub starts: Vec<BlockStart>,
    /// Indices into `terms`, of the planes.
    pub entries: Vec<u32>,
    /// Coefficients, one plane per entry.
    pub planes: Vec<Plane>,
    /// Terms of few pixels.
    pub singles: Vec<Single>,
    /// What highlights need for another exponent; `None` where it was released for memory.
    pub highlights: Option<Highlights>,
    /// Where its trees end.
    pub frontier: Frontier,
}

impl TransportTile {
    /// A tile that no ray was cast for.
    pub fn black() -> TransportTile {
        let frontier = Frontier { starts: vec![0; TILE_BLOCKS + 1], ..Frontier::default() };
        let starts = vec![BlockStart::default(); TILE_BLOCKS + 1];
        let highlights = Some(Highlights::default());
        TransportTile { starts, frontier, highlights, ..TransportTile::default() }
    }
}

/// Which pixels of a tile a term of the frontier concerns: were it alive, their trees would grow.
///
/// # Invariants
/// `terms` rises, and so do the entries of a block; `starts` has one more element than the tile has
/// blocks.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Frontier {
    /// Ids of the terms at which branches or shadow rays of the tile end.
    pub terms: Vec<u32>,
    /// Where each block's marks begin, and the end.
    pub starts: Vec<u32>,
    /// Block by block.
    pub marks: Vec<FrontierMark>,
}

/// The pixels of a block in which branches or shadow rays end at a term: 8 bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FrontierMark {
    /// Index into `terms`.
    pub entry: u32,
    /// Bit i is set for lane i.
    pub mask: u16,
    /// How many end there, 65 535 standing for more.
    pub rays: u16,
}

impl Frontier {
    /// The marks of one block.
    #[inline(always)]
    pub fn block(&self, block: usize) -> &[FrontierMark] {
        &self.marks[self.starts[block] as usize..self.starts[block + 1] as usize]
    }

    /// Allocated bytes.
    pub fn bytes(&self) -> usize {
        let Frontier { terms, starts, marks } = self;
        (terms.capacity() + starts.capacity()) * 4 + marks.capacity() * size_of::<FrontierMark>()
    }

    fn validate(&self, terms: usize) {
        assert!(self.terms.is_sorted_by(|a, b| a < b), "frontier out of order");
        assert!(self.terms.iter().all(|&t| (t as usize) < terms), "unknown term of the frontier");
        assert_eq!(self.starts.len(), TILE_BLOCKS + 1, "64 blocks");
        for marks in (0..TILE_BLOCKS).map(|b| self.block(b)) {
            assert!(marks.is_sorted_by(|a, b| a.entry < b.entry), "marks out of order");
            let known = |m: &FrontierMark| (m.entry as usize) < self.terms.len();
            assert!(marks.iter().all(|m| known(m) && m.mask != 0 && m.rays > 0), "empty mark");
        }
    }
}

/// A position in the arrays of a [`TransportTile`]; a graphics card reads it as it lies here.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct BlockStart {
    /// Index into `entries` and `planes`.
    pub plane: u32,
    /// Index into `singles`.
    pub single: u32,
}

/// One coefficient of a term that occurs in few pixels of a block: 8 bytes. A graphics card reads it as
/// it lies here.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Single {
    /// Index into `terms` in bits 4…31, lane in bits 0…3. Entry 5 at lane 9 is `0x59`.
    pub(crate) place: u32,
    /// The coefficient.
    pub coefficient: f32,
}

impl Single {
    /// A coefficient of the dictionary's `entry` at a lane.
    pub fn new(entry: u32, lane: usize, coefficient: f32) -> Single {
        assert!(entry < 1 << 28 && lane < LANES, "fewer than 2^28 terms in a tile");
        Single { place: entry << 4 | lane as u32, coefficient }
    }

    /// Index into the tile's dictionary.
    #[inline(always)]
    pub fn entry(self) -> usize {
        (self.place >> 4) as usize
    }

    /// Lane of the block.
    #[inline(always)]
    pub fn lane(self) -> usize {
        self.place as usize & (LANES - 1)
    }
}

/// The matrix rows of one block.
#[derive(Clone, Copy, Debug)]
pub struct Block<'a> {
    /// Indices into the dictionary, one per plane.
    pub entries: &'a [u32],
    /// Coefficients of all 16 pixels.
    pub planes: &'a [Plane],
    /// Coefficients of terms of few pixels.
    pub singles: &'a [Single],
}

/// The angles behind every highlight coefficient of a tile.
///
/// # Invariants ([`Transport::validate`])
/// Groups rise by material, and of each the one without weights comes first; the arrays hold the
/// groups one after another.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Highlights {
    /// The lists of each material.
    pub groups: Vec<HighlightGroup>,
    /// Per group in the order in which the blocks' terms were found.
    pub lists: Vec<HighlightList>,
    /// Per list and lane of its mask the number of samples.
    pub counts: Vec<u16>,
    /// l of every sample with a highlight, that is log2 cos β or −tan² α · log2 e: list by list, and
    /// in it lane by lane, in sample order; in a *full* list sample by sample, in lane order.
    pub logarithms: Vec<f32>,
    /// What multiplies each power, for the groups that have weights.
    pub weights: Vec<f32>,
}

/// Lists of one material: how many of each array's elements are theirs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HighlightGroup {
    /// The material whose peak applies.
    pub material: u16,
    /// Whether the samples have weights; otherwise each is 1.
    pub weighted: bool,
    /// Of `lists`.
    pub lists: u32,
    /// Of `counts`.
    pub lanes: u32,
    /// Of `logarithms`, and, if weighted, of `weights`.
    pub samples: u32,
}

/// The arrays of one [`HighlightGroup`].
#[derive(Clone, Copy, Debug)]
pub struct HighlightPart<'a> {
    /// Its material.
    pub material: u16,
    /// Its lists.
    pub lists: &'a [HighlightList],
    /// Per list and lane the number of samples.
    pub counts: &'a [u16],
    /// l of every sample.
    pub logarithms: &'a [f32],
    /// What multiplies each power; empty if every weight is 1.
    pub weights: &'a [f32],
}

/// The samples behind the coefficients of one highlight term in one block: 12 bytes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HighlightList {
    /// Index into `planes`, or, with [`HighlightList::SINGLE`] added, of the first of `singles`.
    pub at: u32,
    /// Bit i is set if lane i has samples.
    pub mask: u16,
    /// Samples of every lane, if all 16 lanes have equally many: a *full* list. Otherwise 0.
    pub full: u16,
    /// The greatest l of its samples: where its power is flushed to 0, all of them are.
    pub peak: f32,
}

impl HighlightList {
    /// Marks an index into `singles`.
    pub const SINGLE: u32 = 1 << 31;
}

impl Transport {
    /// Allocated bytes of the matrix and its terms, without highlights.
    pub fn bytes(&self) -> usize {
        self.trie.bytes() + self.tiles.iter().map(|tile| tile.bytes()).sum::<usize>()
    }

    /// Allocated bytes of all highlight lists.
    pub fn highlight_bytes(&self) -> usize {
        self.tiles.iter().filter_map(|t| t.highlights.as_ref()).map(Highlights::bytes).sum()
    }

    /// Gives materials other indices, in the same order: `index` has one for every index of today.
    pub fn rename_materials(&mut self, index: &[u16]) {
        self.trie.rename(|factor| match factor.is_of_material() {
            true => Factor::new(factor.kind(), index[factor.index()], factor.slot() as u8),
            false => factor,
        });
        let tiles = self.tiles.iter_mut().map(Arc::make_mut);
        for highlights in tiles.filter_map(|tile| tile.highlights.as_mut()) {
            for group in &mut highlights.groups {
                group.material = index[group.material as usize];
            }
        }
    }

    /// Checks every invariant. Panics with what is wrong.
    pub fn validate(&self) {
        assert_eq!(self.tiles.len(), self.layout.tiles(), "one part per tile");
        for tile in &self.tiles {
            tile.validate(self.trie.nodes().len());
        }
    }
}

impl TransportTile {
    /// Allocated bytes without highlights.
    pub fn bytes(&self) -> usize {
        let TransportTile { terms, starts, entries, planes, singles, highlights: _, frontier } =
            self;
        frontier.bytes()
            + (terms.capacity() + entries.capacity()) * 4
            + starts.capacity() * size_of::<BlockStart>()
            + planes.capacity() * size_of::<Plane>()
            + singles.capacity() * size_of::<Single>()
    }

    /// The rows of one block.
    #[inline(always)]
    pub fn block(&self, block: usize) -> Block<'_> {
        let (from, to) = (self.starts[block], self.starts[block + 1]);
        let planes = from.plane as usize..to.plane as usize;
        Block {
            entries: &self.entries[planes.clone()],
            planes: &self.planes[planes],
            singles: &self.singles[from.single as usize..to.single as usize],
        }
    }

    /// Gives its terms other ids, in the same order.
    pub fn renumber(&mut self, id: impl Fn(u32) -> u32) {
        let own = self.terms.iter_mut().chain(&mut self.frontier.terms);
        own.for_each(|term| *term = id(*term));
    }

    /// Where the next block's parts would begin.
    pub(super) fn end(&self) -> BlockStart {
        BlockStart { plane: self.planes.len() as u32, single: self.singles.len() as u32 }
    }

    fn validate(&self, terms: usize) {
        assert!(self.terms.is_sorted_by(|a, b| a < b), "dictionary out of order");
        assert!(self.terms.iter().all(|&t| (t as usize) < terms), "unknown term");
        assert_eq!(self.starts.len(), TILE_BLOCKS + 1, "64 blocks");
        assert_eq!(self.entries.len(), self.planes.len(), "a plane per entry");
        let known = |e: usize| e < self.terms.len();
        for Block { entries, planes, singles } in (0..TILE_BLOCKS).map(|b| self.block(b)) {
            assert!(entries.is_sorted_by(|a, b| a < b), "entries out of order");
            assert!(singles.is_sorted_by(|a, b| a.place < b.place), "singles out of order");
            assert!(entries.iter().all(|&e| known(e as usize)), "unknown entry");
            assert!(singles.iter().all(|s| known(s.entry())), "unknown entry of a single");
            let few = |s: &[Single]| s.len() <= SPARSE_LANES as usize;
            let each = singles.chunk_by(|a, b| a.entry() == b.entry());
            assert!(each.into_iter().all(few), "singles of many lanes");
            let coefficients = planes.iter().flat_map(|p| p.0);
            let mut all = coefficients.chain(singles.iter().map(|s| s.coefficient));
            assert!(all.all(f32::is_finite), "a coefficient is not finite");
        }
        self.frontier.validate(terms);
        if let Some(highlights) = &self.highlights {
            highlights.validate();
        }
    }
}

impl Highlights {
    /// The arrays of each group.
    pub fn parts(&self) -> impl Iterator<Item = HighlightPart<'_>> {
        let Highlights { groups, lists, counts, logarithms, weights } = self;
        let (mut list, mut lane, mut sample, mut weight) = (0, 0, 0, 0);
        groups.iter().map(move |group| {
            let weights_here = if group.weighted { group.samples } else { 0 };
            HighlightPart {
                material: group.material,
                lists: &lists[advance(&mut list, group.lists)],
                counts: &counts[advance(&mut lane, group.lanes)],
                logarithms: &logarithms[advance(&mut sample, group.samples)],
                weights: &weights[advance(&mut weight, weights_here)],
            }
        })
    }

    /// Allocated bytes.
    pub fn bytes(&self) -> usize {
        let Highlights { groups, lists, counts, logarithms, weights } = self;
        groups.capacity() * size_of::<HighlightGroup>()
            + lists.capacity() * size_of::<HighlightList>()
            + counts.capacity() * 2
            + (logarithms.capacity() + weights.capacity()) * 4
    }

    fn validate(&self) {
        let Highlights { groups, lists, counts, logarithms, weights } = self;
        let sum = |of: &dyn Fn(&HighlightGroup) -> u32| groups.iter().map(of).sum::<u32>() as usize;
        assert_eq!(sum(&|g| g.lists), lists.len(), "lists of groups");
        assert_eq!(sum(&|g| g.lanes), counts.len(), "lanes of groups");
        assert_eq!(sum(&|g| g.samples), logarithms.len(), "samples of groups");
        let weighted = sum(&|g| if g.weighted { g.samples } else { 0 });
        assert_eq!(weighted, weights.len(), "weights of groups");
        let key = |g: &HighlightGroup| (g.material, g.weighted);
        assert!(groups.is_sorted_by(|a, b| key(a) < key(b)), "groups out of order");
        for HighlightPart { material: _, lists, counts, logarithms, weights: _ } in self.parts() {
            let lanes: u32 = lists.iter().map(|l| l.mask.count_ones()).sum();
            assert_eq!(lanes as usize, counts.len(), "a count per lane of every highlight");
            assert!(counts.iter().all(|&c| c > 0), "a lane without samples");
            let samples: usize = counts.iter().map(|&c| usize::from(c)).sum();
            assert_eq!(samples, logarithms.len(), "highlight samples");
            let (mut lane, mut sample) = (0, 0);
            for list in lists {
                let own = &counts[advance(&mut lane, list.mask.count_ones())];
                let full = list.full == 0 || own == [list.full; LANES];
                assert!(full, "a list that is not full");
                let count = own.iter().map(|&c| u32::from(c)).sum();
                let logarithms = logarithms[advance(&mut sample, count)].iter().copied();
                let peak = logarithms.fold(f32::NEG_INFINITY, f32::max);
                assert_eq!(list.peak, peak, "the peak of a list");
            }
        }
        assert!(logarithms.iter().all(|&l| l <= 0.0), "a cosine above 1");
        assert!(weights.iter().all(|&w| w.is_finite()), "an odd weight");
    }
}

/// The next `count` indices.
fn advance(at: &mut usize, count: u32) -> std::ops::Range<usize> {
    let from = *at;
    *at += count as usize;
    from..*at
}
