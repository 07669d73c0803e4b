//! The transport matrix: pixels times terms, in blocks of sixteen pixels.

use super::trie::Trie;
use crate::film::layout::{LANES, Layout, TILE_BLOCKS};

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

/// The rows of the matrix that belong to one tile.
///
/// # Invariants ([`TransportTile::validate`])
/// `terms` rises; the entries of a block rise; `planes` has one plane per entry; `starts` has one
/// more element than the tile has blocks.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TransportTile {
    /// Ids of the terms that occur in the tile: its dictionary.
    pub terms: Vec<u32>,
    /// Where each block's entries begin, and the end.
    pub starts: Vec<u32>,
    /// Indices into `terms`.
    pub entries: Vec<u32>,
    /// Coefficients, one plane per entry.
    pub planes: Vec<Plane>,
    /// What highlights need for another exponent; `None` where it was released for memory.
    pub highlights: Option<Highlights>,
}

/// The angles behind every highlight coefficient of a tile.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Highlights {
    /// In the order of the planes.
    pub lists: Vec<HighlightList>,
    /// log2 cos β of every sample with a highlight, list by list, lane by lane, in sample order.
    pub log2_cosines: Vec<f32>,
}

/// The samples behind one plane of highlights.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HighlightList {
    /// Index into `planes`.
    pub plane: u32,
    /// The material whose exponent applies.
    pub material: u16,
    /// How many samples each lane has.
    pub counts: [u16; LANES],
}

impl HighlightList {
    /// Number of samples of all lanes.
    #[inline(always)]
    pub fn samples(&self) -> usize {
        self.counts.iter().map(|&c| usize::from(c)).sum()
    }
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
        let TransportTile { terms, starts, entries, planes, highlights: _ } = self;
        (terms.capacity() + starts.capacity() + entries.capacity()) * 4
            + planes.capacity() * size_of::<Plane>()
    }

    /// Entries and planes of one block.
    #[inline(always)]
    pub fn block(&self, block: usize) -> (&[u32], &[Plane]) {
        let range = self.starts[block] as usize..self.starts[block + 1] as usize;
        (&self.entries[range.clone()], &self.planes[range])
    }

    fn validate(&self, terms: usize) {
        assert!(self.terms.is_sorted_by(|a, b| a < b), "dictionary out of order");
        assert!(self.terms.iter().all(|&t| (t as usize) < terms), "unknown term");
        assert_eq!(self.starts.len(), TILE_BLOCKS + 1, "64 blocks");
        assert_eq!(self.entries.len(), self.planes.len(), "a plane per entry");
        for block in 0..TILE_BLOCKS {
            let (entries, planes) = self.block(block);
            assert!(entries.is_sorted_by(|a, b| a < b), "entries out of order");
            assert!(entries.iter().all(|&e| (e as usize) < self.terms.len()), "unknown entry");
            let finite = planes.iter().flat_map(|p| p.0).all(f32::is_finite);
            assert!(finite, "a coefficient is not finite");
        }
        if let Some(Highlights { lists, log2_cosines }) = &self.highlights {
            assert!(lists.is_sorted_by(|a, b| a.plane < b.plane), "highlights out of order");
            let samples: usize = lists.iter().map(HighlightList::samples).sum();
            assert_eq!(samples, log2_cosines.len(), "highlight samples");
            assert!(log2_cosines.iter().all(|&l| l <= 0.0), "a cosine above 1");
        }
    }
}

impl Highlights {
    /// Allocated bytes.
    pub fn bytes(&self) -> usize {
        let Highlights { lists, log2_cosines } = self;
        lists.capacity() * size_of::<HighlightList>() + log2_cosines.capacity() * 4
    }
}
