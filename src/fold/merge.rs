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
        if self.highlights.is_some() && part.highlights.is_some() {
            tile.highlights = Some(Highlights::default());
        }
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
        tile.shrink();
        tile
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
        let TransportTile { terms, starts, entries, planes, singles, highlights, frontier } = self;
        terms.shrink_to_fit();
        starts.shrink_to_fit();
        entries.shrink_to_fit();
        planes.shrink_to_fit();
        singles.shrink_to_fit();
        if let Some(Highlights { lists, counts, log2_cosines }) = highlights {
            lists.shrink_to_fit();
            counts.shrink_to_fit();
            log2_cosines.shrink_to_fit();
        }
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
            list: 0,
            count: 0,
            sample: 0,
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
    /// Of the block's highlights.
    list: usize,
    count: usize,
    sample: usize,
}

impl Cursor<'_> {
    /// Appends the next block to `into`.
    fn copy(&mut self, into: &mut TransportTile) {
        let rows = self.tile.block(self.block);
        let to = into.end();
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
        let from = self.tile.starts[self.block];
        let [lists, counts, samples] = self.pass();
        if let (Some(own), Some(highlights)) = (&self.tile.highlights, &mut into.highlights) {
            let moved = own.lists[lists].iter().map(|list| list.moved(from, to));
            highlights.lists.extend(moved);
            highlights.counts.extend_from_slice(&own.counts[counts]);
            highlights.log2_cosines.extend_from_slice(&own.log2_cosines[samples]);
        }
    }

    /// Passes over the next block; the ranges of its highlights' lists, counts and samples.
    fn pass(&mut self) -> [std::ops::Range<usize>; 3] {
        let end = self.tile.starts[self.block + 1];
        self.block += 1;
        let from = [self.list, self.count, self.sample];
        if let Some(own) = &self.tile.highlights {
            while own.lists.get(self.list).is_some_and(|list| list.is_before(end)) {
                let lanes = own.lists[self.list].mask.count_ones() as usize;
                let counts = &own.counts[self.count..self.count + lanes];
                self.sample += counts.iter().map(|&count| usize::from(count)).sum::<usize>();
                self.count += lanes;
                self.list += 1;
            }
        }
        [from[0]..self.list, from[1]..self.count, from[2]..self.sample]
    }
}

impl HighlightList {
    /// Whether its term is stored before `end`.
    fn is_before(&self, end: BlockStart) -> bool {
        match self.at & HighlightList::SINGLE {
            0 => self.at < end.plane,
            _ => self.at & !HighlightList::SINGLE < end.single,
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
