//! Gathers the highlight samples of a tile, list by list, and puts them together by material.

use super::Folder;
use super::transport::{HighlightGroup, HighlightList, Highlights};
use crate::film::layout::LANES;

/// One sample's highlight, before it is sorted into its list.
#[derive(Clone, Copy, Default)]
pub(super) struct HighlightSample {
    pub(super) slot: u32,
    pub(super) material: u16,
    pub(super) lane: u16,
    pub(super) angle: f32,
    pub(super) weight: f32,
}

impl Folder {
    /// Sorts a block's highlight samples into lists, by slot, then lane, then sample.
    pub(super) fn sort_highlights(&mut self, block: usize) {
        let range = self.highlight_starts[block]..self.highlight_starts[block + 1];
        let samples = &self.highlights[range.start as usize..range.end as usize];
        let first = self.starts[block];
        // A counting sort by slot. Samples were found lane after lane, and it keeps their order.
        self.order.clear();
        self.order.resize((self.starts[block + 1] - first) as usize, 0);
        for s in samples {
            self.order[(s.slot - first) as usize] += 1;
        }
        let mut next = 0;
        for count in &mut self.order {
            (*count, next) = (next, next + *count);
        }
        self.sorted.clear();
        self.sorted.resize(samples.len(), HighlightSample::default());
        for s in samples {
            let at = &mut self.order[(s.slot - first) as usize];
            self.sorted[*at as usize] = *s;
            *at += 1;
        }
        for list in self.sorted.chunk_by(|a, b| a.slot == b.slot) {
            self.lists.add(self.places[list[0].slot as usize], list);
        }
    }
}

/// The lists of a tile in the order in which they were found; memory is kept from tile to tile.
#[derive(Default)]
pub(super) struct HighlightLists {
    found: Vec<Found>,
    counts: Vec<u16>,
    angles: Vec<f32>,
    weights: Vec<f32>,
}

/// A list and where its samples are.
struct Found {
    material: u16,
    weighted: bool,
    list: HighlightList,
    lane: u32,
    sample: u32,
    samples: u32,
}

impl HighlightLists {
    /// Empties it and keeps its memory.
    pub(super) fn clear(&mut self) {
        let HighlightLists { found, counts, angles, weights } = self;
        found.clear();
        counts.clear();
        angles.clear();
        weights.clear();
    }

    /// Adds the samples of one term in one block, sorted by lane; its coefficients are stored `at`.
    pub(super) fn add(&mut self, at: u32, samples: &[HighlightSample]) {
        let (lane, sample) = (self.counts.len() as u32, self.angles.len() as u32);
        let mut mask = 0u16;
        for same in samples.chunk_by(|a, b| a.lane == b.lane) {
            mask |= 1 << same[0].lane;
            self.counts.push(same.len() as u16);
        }
        let counts = &self.counts[lane as usize..];
        let equal = counts.iter().all(|&c| c == counts[0]);
        let full = if counts.len() == LANES && equal { counts[0] } else { 0 };
        if full == 0 {
            self.angles.extend(samples.iter().map(|s| s.angle));
            self.weights.extend(samples.iter().map(|s| s.weight));
        } else {
            // Sample by sample, so that whole vectors of lanes are added.
            let each = usize::from(full);
            for i in 0..each {
                self.angles.extend(samples.iter().skip(i).step_by(each).map(|s| s.angle));
                self.weights.extend(samples.iter().skip(i).step_by(each).map(|s| s.weight));
            }
        }
        self.found.push(Found {
            material: samples[0].material,
            weighted: samples.iter().any(|s| s.weight != 1.0),
            // The peak is known when angles are logarithms.
            list: HighlightList { at, mask, full, peak: 0.0 },
            lane,
            sample,
            samples: samples.len() as u32,
        });
    }

    /// The lists by material, those without weights before those with; angles are yet to be turned
    /// into logarithms.
    pub(super) fn group(&mut self) -> Highlights {
        let mut pieces: Vec<Piece> = self.found.iter().map(|found| self.piece(found)).collect();
        pieces.sort_by_key(Piece::key);
        Highlights::of_pieces(pieces.iter())
    }

    fn piece(&self, found: &Found) -> Piece<'_> {
        let lanes = found.lane + found.list.mask.count_ones();
        let samples = found.sample as usize..(found.sample + found.samples) as usize;
        Piece {
            material: found.material,
            weighted: found.weighted,
            list: found.list,
            counts: &self.counts[found.lane as usize..lanes as usize],
            logarithms: &self.angles[samples.clone()],
            weights: if found.weighted { &self.weights[samples] } else { &[] },
        }
    }
}

/// One list with its samples.
pub(super) struct Piece<'a> {
    material: u16,
    weighted: bool,
    pub(super) list: HighlightList,
    counts: &'a [u16],
    logarithms: &'a [f32],
    weights: &'a [f32],
}

impl Piece<'_> {
    /// By which pieces are grouped.
    pub(super) fn key(&self) -> (u16, bool) {
        (self.material, self.weighted)
    }
}

impl Highlights {
    /// Every list, in order.
    pub(super) fn pieces(&self) -> Vec<Piece<'_>> {
        let mut pieces = Vec::with_capacity(self.lists.len());
        for (group, part) in self.groups.iter().zip(self.parts()) {
            let (mut counts, mut logarithms, mut weights) =
                (part.counts, part.logarithms, part.weights);
            for list in part.lists {
                let (own_counts, own_logarithms, own_weights);
                (own_counts, counts) = counts.split_at(list.mask.count_ones() as usize);
                let samples: usize = own_counts.iter().map(|&c| usize::from(c)).sum();
                (own_logarithms, logarithms) = logarithms.split_at(samples);
                (own_weights, weights) = weights.split_at(if group.weighted { samples } else { 0 });
                pieces.push(Piece {
                    material: group.material,
                    weighted: group.weighted,
                    list: *list,
                    counts: own_counts,
                    logarithms: own_logarithms,
                    weights: own_weights,
                });
            }
        }
        pieces
    }

    /// Puts together lists that are sorted by their keys.
    pub(super) fn of_pieces<'a>(pieces: impl Iterator<Item = &'a Piece<'a>> + Clone) -> Highlights {
        let sum = |of: &dyn Fn(&Piece) -> usize| pieces.clone().map(of).sum::<usize>();
        let mut highlights = Highlights {
            groups: Vec::new(),
            lists: Vec::with_capacity(sum(&|_| 1)),
            counts: Vec::with_capacity(sum(&|p| p.counts.len())),
            logarithms: Vec::with_capacity(sum(&|p| p.logarithms.len())),
            weights: Vec::with_capacity(sum(&|p| p.weights.len())),
        };
        for piece in pieces {
            let Piece { material, weighted, list, counts, logarithms, weights } = piece;
            let group = highlights.group_of(*material, *weighted);
            group.lists += 1;
            group.lanes += counts.len() as u32;
            group.samples += logarithms.len() as u32;
            highlights.lists.push(*list);
            highlights.counts.extend_from_slice(counts);
            highlights.logarithms.extend_from_slice(logarithms);
            highlights.weights.extend_from_slice(weights);
        }
        highlights.groups.shrink_to_fit();
        highlights
    }

    /// The last group, made if the next list is of another.
    fn group_of(&mut self, material: u16, weighted: bool) -> &mut HighlightGroup {
        let same = |g: &HighlightGroup| (g.material, g.weighted) == (material, weighted);
        if !self.groups.last().is_some_and(same) {
            let empty = HighlightGroup { material, weighted, lists: 0, lanes: 0, samples: 0 };
            self.groups.push(empty);
        }
        let last = self.groups.len() - 1;
        &mut self.groups[last]
    }
}
