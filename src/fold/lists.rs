//! Gathers the highlight samples of a tile, list by list, and puts them together by material.

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
        self.found.sort_by_key(|f| (f.material, f.weighted));
        let weighted = self.found.iter().filter(|f| f.weighted).map(|f| f.samples).sum::<u32>();
        let mut highlights = Highlights {
            groups: Vec::new(),
            lists: Vec::with_capacity(self.found.len()),
            counts: Vec::with_capacity(self.counts.len()),
            logarithms: Vec::with_capacity(self.angles.len()),
            weights: Vec::with_capacity(weighted as usize),
        };
        let key = |f: &Found| (f.material, f.weighted);
        for group in self.found.chunk_by(|a, b| key(a) == key(b)) {
            let (material, weighted) = key(&group[0]);
            let (lists, before) = (group.len() as u32, highlights.counts.len());
            for found in group {
                self.copy(found, &mut highlights);
            }
            let lanes = (highlights.counts.len() - before) as u32;
            let samples = group.iter().map(|f| f.samples).sum();
            highlights.groups.push(HighlightGroup { material, weighted, lists, lanes, samples });
        }
        highlights.groups.shrink_to_fit();
        highlights
    }

    fn copy(&self, found: &Found, highlights: &mut Highlights) {
        let lanes = found.list.mask.count_ones();
        let lanes = found.lane as usize..(found.lane + lanes) as usize;
        let samples = found.sample as usize..(found.sample + found.samples) as usize;
        highlights.lists.push(found.list);
        highlights.counts.extend_from_slice(&self.counts[lanes]);
        highlights.logarithms.extend_from_slice(&self.angles[samples.clone()]);
        if found.weighted {
            highlights.weights.extend_from_slice(&self.weights[samples]);
        }
    }
}
