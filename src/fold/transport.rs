//! The transport matrix: pixels times terms, in blocks of sixteen pixels.

use super::trie::Trie;
use crate::film::layout::{LANES, Layout, TILE_BLOCKS};
use crate::scene::factor::Factor;

/// The coefficients of one term for the 16 pixels of a block.
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
    /// One part per tile.
    pub tiles: Vec<TransportTile>,
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

/// A position in the arrays of a [`TransportTile`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct BlockStart {
    /// Index into `entries` and `planes`.
    pub plane: u32,
    /// Index into `singles`.
    pub single: u32,
}

/// One coefficient of a term that occurs in few pixels of a block: 8 bytes.
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
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Highlights {
    /// In the order in which the blocks' terms were found.
    pub lists: Vec<HighlightList>,
    /// Per list and lane of its mask the number of samples.
    pub counts: Vec<u16>,
    /// log2 cos β of every sample with a highlight, list by list, lane by lane, in sample order.
    pub log2_cosines: Vec<f32>,
}

/// The samples behind the coefficients of one highlight term in one block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HighlightList {
    /// Index into `planes`, or, with [`HighlightList::SINGLE`] added, of the first of `singles`.
    pub at: u32,
    /// The material whose exponent applies.
    pub material: u16,
    /// Bit i is set if lane i has samples.
    pub mask: u16,
}

impl HighlightList {
    /// Marks an index into `singles`.
    pub const SINGLE: u32 = 1 << 31;
}

impl Transport {
    /// Allocated bytes of the matrix and its terms, without highlights.
    pub fn bytes(&self) -> usize {
        self.trie.bytes() + self.tiles.iter().map(TransportTile::bytes).sum::<usize>()
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
        for highlights in self.tiles.iter_mut().filter_map(|tile| tile.highlights.as_mut()) {
            for list in &mut highlights.lists {
                list.material = index[list.material as usize];
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
        if let Some(Highlights { lists, counts, log2_cosines }) = &self.highlights {
            let lanes: u32 = lists.iter().map(|l| l.mask.count_ones()).sum();
            assert_eq!(lanes as usize, counts.len(), "a count per lane of every highlight");
            assert!(counts.iter().all(|&c| c > 0), "a lane without samples");
            let samples: usize = counts.iter().map(|&c| usize::from(c)).sum();
            assert_eq!(samples, log2_cosines.len(), "highlight samples");
            assert!(log2_cosines.iter().all(|&l| l <= 0.0), "a cosine above 1");
        }
    }
}

impl Highlights {
    /// Allocated bytes.
    pub fn bytes(&self) -> usize {
        let Highlights { lists, counts, log2_cosines } = self;
        lists.capacity() * size_of::<HighlightList>()
            + counts.capacity() * 2
            + log2_cosines.capacity() * 4
    }
}
