//! Puts blocks that were folded again into a tile of the matrix.

use super::transport::{
    Block, BlockStart, Frontier, FrontierMark, HighlightList, Highlights, Single, TransportTile,
};
use crate::film::layout::TILE_BLOCKS;

/// A set of a tile's 64 blocks: bit i is block i.
pub type Blocks = u64;

impl TransportTile {
    /// This tile with the blocks of the set `blocks` in place of its own: `part` holds them, in
    /// rising order, and nothing else. Ids of both are of the same trie.
    ///
    /// Gives what folding the whole tile gives: terms that occur nowhere any more are forgotten.
    /// Highlight lists are kept if both have them.
    pub fn with_blocks(&self, part: &TransportTile, blocks: Blocks) -> TransportTile {
        let sources = [Source::new(self, !blocks), Source::new(part, u64::MAX)];
        let [old, new] = &sources;
        let mut tile = TransportTile {
            terms: union(&self.terms, &old.terms, &part.terms, &new.terms),
            starts: vec![BlockStart::default()],
            ..TransportTile::default()
        };
        tile.frontier.terms =
            union(&self.frontier.terms, &old.frontier, &part.frontier.terms, &new.frontier);
        tile.frontier.starts.push(0);
        let mut cursors = sources.map(|source| source.cursor(&tile));
        for block in 0..TILE_BLOCKS {
            let [old, new] = &mut cursors;
            if blocks >> block & 1 != 0 {
                new.copy(&mut tile);
                old.pass();
            } else {
                old.copy(&mut tile);
            }
        }
        tile.highlights = self.merged_highlights(part, blocks, &tile);
        tile.shrink();
        tile
    }

    /// The highlight lists of `into`, this tile with the blocks of `part`, if both have theirs.
    fn merged_highlights(
        &self,
        part: &TransportTile,
        blocks: Blocks,
        into: &TransportTile,
    ) -> Option<Highlights> {
        let (old, new) = (self.highlights.as_ref()?, part.highlights.as_ref()?);
        let new_blocks: Vec<usize> =
            (0..TILE_BLOCKS).filter(|block| blocks >> block & 1 != 0).collect();
        let mut pieces = Vec::new();
        for mut piece in old.pieces() {
            let block = piece.list.block(&self.starts);
            if blocks >> block & 1 == 0 {
                piece.list = piece.list.moved(self.starts[block], into.starts[block]);
                pieces.push((block, piece));
            }
        }
        for mut piece in new.pieces() {
            let own = piece.list.block(&part.starts);
            let block = new_blocks[own];
            piece.list = piece.list.moved(part.starts[own], into.starts[block]);
            pieces.push((block, piece));
        }
        // A block's lists are all of one source, and stay in their order.
        pieces.sort_by_key(|(block, piece)| (piece.key(), *block));
        Some(Highlights::of_pieces(pieces.iter().map(|(_, piece)| piece)))
    }

    /// Bytes of the rows of the blocks of a set.
    pub fn bytes_of_blocks(&self, blocks: Blocks) -> usize {
        let count = self.starts.len() - 1;
        let of = |block| {
            let Block { entries, planes, singles } = self.block(block);
            let marks = self.frontier.block(block);
            size_of_val(entries) + size_of_val(planes) + size_of_val(singles) + size_of_val(marks)
        };
        (0..count).filter(|block| blocks >> block & 1 != 0).map(of).sum()
    }

    fn shrink(&mut self) {
        let TransportTile { terms, starts, entries, planes, singles, highlights: _, frontier } =
            self;
        terms.shrink_to_fit();
        starts.shrink_to_fit();
        entries.shrink_to_fit();
        planes.shrink_to_fit();
        singles.shrink_to_fit();
        let Frontier { terms, starts, marks } = frontier;
        terms.shrink_to_fit();
        starts.shrink_to_fit();
        marks.shrink_to_fit();
    }
}

/// The terms that are used of two sorted dictionaries, sorted, each once.
fn union(a: &[u32], a_used: &[bool], b: &[u32], b_used: &[bool]) -> Vec<u32> {
    let used = |terms: &[u32], used: &[bool]| -> Vec<u32> {
        terms.iter().zip(used).filter(|(_, used)| **used).map(|(term, _)| *term).collect()
    };
    let mut terms = used(a, a_used);
    terms.extend(used(b, b_used));
    terms.sort_unstable();
    terms.dedup();
    terms
}

/// Which entries of a tile's dictionaries its blocks of a set use.
struct Source<'a> {
    tile: &'a TransportTile,
    terms: Vec<bool>,
    frontier: Vec<bool>,
}

impl<'a> Source<'a> {
    fn new(tile: &'a TransportTile, blocks: Blocks) -> Source<'a> {
        let mut terms = vec![false; tile.terms.len()];
        let mut frontier = vec![false; tile.frontier.terms.len()];
        let count = tile.starts.len() - 1;
        for block in (0..count).filter(|block| blocks >> block & 1 != 0) {
            let rows = tile.block(block);
            rows.entries.iter().for_each(|&entry| terms[entry as usize] = true);
            rows.singles.iter().for_each(|single| terms[single.entry()] = true);
            let marks = tile.frontier.block(block);
            marks.iter().for_each(|mark| frontier[mark.entry as usize] = true);
        }
        Source { tile, terms, frontier }
    }

    fn cursor(self, into: &TransportTile) -> Cursor<'a> {
        Cursor {
            tile: self.tile,
            terms: places(&self.tile.terms, &self.terms, &into.terms),
            frontier: places(&self.tile.frontier.terms, &self.frontier, &into.frontier.terms),
            block: 0,
        }
    }
}

/// Per term its place in a sorted list that holds those that are used. The others, which may be out of
/// order, have none.
fn places(terms: &[u32], used: &[bool], list: &[u32]) -> Vec<u32> {
    let mut next = 0;
    let place = |(term, used): (&u32, &bool)| {
        if *used {
            next += list[next..].partition_point(|t| t < term);
        }
        next as u32
    };
    terms.iter().zip(used).map(place).collect()
}

/// Reads a tile block by block.
struct Cursor<'a> {
    tile: &'a TransportTile,
    /// Per used entry of the dictionary its place in the merged one.
    terms: Vec<u32>,
    frontier: Vec<u32>,
    block: usize,
}

impl Cursor<'_> {
    /// Appends the next block to `into`.
    fn copy(&mut self, into: &mut TransportTile) {
        let rows = self.tile.block(self.block);
        into.entries.extend(rows.entries.iter().map(|&e| self.terms[e as usize]));
        into.planes.extend_from_slice(rows.planes);
        into.singles.extend(rows.singles.iter().map(|single| {
            let entry = self.terms[single.entry()];
            Single::new(entry, single.lane(), single.coefficient)
        }));
        into.starts.push(into.end());
        let marks = self
            .tile
            .frontier
            .block(self.block)
            .iter()
            .map(|mark| FrontierMark { entry: self.frontier[mark.entry as usize], ..*mark });
        into.frontier.marks.extend(marks);
        into.frontier.starts.push(into.frontier.marks.len() as u32);
        self.pass();
    }

    /// Passes over the next block.
    fn pass(&mut self) {
        self.block += 1;
    }
}

impl HighlightList {
    /// The block that its term is stored in, of blocks that begin at `starts`.
    fn block(&self, starts: &[BlockStart]) -> usize {
        let at = self.at & !HighlightList::SINGLE;
        let ends = &starts[1..];
        match self.at & HighlightList::SINGLE {
            0 => ends.partition_point(|end| end.plane <= at),
            _ => ends.partition_point(|end| end.single <= at),
        }
    }

    /// The same list, of a block that began at `from` and now begins at `to`.
    fn moved(&self, from: BlockStart, to: BlockStart) -> HighlightList {
        let at = match self.at & HighlightList::SINGLE {
            0 => self.at - from.plane + to.plane,
            _ => self.at - from.single + to.single,
        };
        HighlightList { at, ..*self }
    }
}
