//! Highlight coefficients from kept angles: the same code for a first fold and for a new exponent.

use fearless_simd::{Level, dispatch};

use super::transport::{HighlightList, HighlightPart, Highlights, TransportTile};
use crate::film::layout::LANES;
use crate::math::{EXP2_FLUSH, exp2_nonpositive, log2_of_cosine};
use crate::scene::model::{Measure, Peak};

/// Turns kept angles into coefficients.
pub struct HighlightPower {
    level: Level,
    powers: Vec<f32>,
}

impl Default for HighlightPower {
    fn default() -> Self {
        HighlightPower { level: Level::new(), powers: Vec::new() }
    }
}

impl HighlightPower {
    /// Turns every angle into its l, by the measure of its material, and notes the peak of every
    /// list.
    ///
    /// # Panics
    /// If a material with highlights has no peak.
    pub fn take_logarithms(&self, highlights: &mut Highlights, peaks: &[Option<Peak>]) {
        let Highlights { groups, lists, counts, logarithms, weights: _ } = highlights;
        let mut rest = logarithms.as_mut_slice();
        for group in groups {
            let (angles, after) = rest.split_at_mut(group.samples as usize);
            rest = after;
            let peak = peaks[group.material as usize].expect("a peak of every material");
            match peak.measure {
                Measure::Cosine => dispatch!(self.level, _simd => of_cosines(angles)),
                Measure::Tangent => dispatch!(self.level, _simd => of_tangents(angles)),
            }
        }
        let (mut counts, mut logarithms) = (counts.as_slice(), logarithms.as_slice());
        for list in lists {
            let own;
            (own, counts) = counts.split_at(list.mask.count_ones() as usize);
            let samples;
            (samples, logarithms) = logarithms.split_at(samples_of(list, own));
            list.peak = samples.iter().copied().fold(f32::NEG_INFINITY, f32::max);
        }
    }

    /// Computes the highlight coefficients of a tile, of the materials that have a peak in `peaks`:
    /// `sample_weight · scale · Σ weight · 2^(exponent · l)` per term and lane, samples summed in
    /// their order from +0. A power counts as 0 below 2^−60. Gives whether any coefficient changed.
    pub fn fold(
        &mut self,
        tile: &mut TransportTile,
        highlights: &Highlights,
        peaks: &[Option<Peak>],
        sample_weight: f32,
    ) -> bool {
        let powers = &mut self.powers;
        let mut changed = false;
        for part in highlights.parts() {
            // A material that is gone has none: what showed it is about to be folded again.
            if let Some(Some(peak)) = peaks.get(part.material as usize) {
                changed |= dispatch!(self.level, _simd => {
                    fold_part(tile, &part, peak, sample_weight, powers)
                });
            }
        }
        changed
    }

    /// [`HighlightPower::fold`] from the lists that the tile keeps.
    ///
    /// # Panics
    /// If they were released.
    pub fn refold(
        &mut self,
        tile: &mut TransportTile,
        peaks: &[Option<Peak>],
        sample_weight: f32,
    ) -> bool {
        let highlights = tile.highlights.take().expect("highlight lists are kept");
        let changed = self.fold(tile, &highlights, peaks, sample_weight);
        tile.highlights = Some(highlights);
        changed
    }
}

/// Sums the powers of every list of a material and writes the coefficients to where the list's term
/// is stored.
#[inline(always)]
fn fold_part(
    tile: &mut TransportTile,
    part: &HighlightPart,
    peak: &Peak,
    sample_weight: f32,
    powers: &mut Vec<f32>,
) -> bool {
    let Peak { exponent, scale, measure: _ } = *peak;
    let HighlightPart { material: _, lists, mut counts, mut logarithms, mut weights } = *part;
    let factor = sample_weight * scale;
    let mut changed = false;
    for list in lists {
        let (lanes, ls, ws);
        (lanes, counts) = counts.split_at(list.mask.count_ones() as usize);
        let samples = samples_of(list, lanes);
        (ls, logarithms) = logarithms.split_at(samples);
        (ws, weights) = weights.split_at(samples.min(weights.len()));
        let sums = if exponent * list.peak < EXP2_FLUSH {
            [0.0; LANES]
        } else {
            powers.resize(powers.len().max(samples), 0.0);
            let powers = &mut powers[..samples];
            powers_of(ls, exponent, powers);
            weigh(powers, ws);
            if list.full == 0 { sums_of_lanes(lanes, powers) } else { sums_of_rows(powers) }
        };
        changed |= put(tile, list, sums.map(|sum| sum * factor));
    }
    changed
}

/// Samples of a list whose lanes have `counts`.
#[inline(always)]
fn samples_of(list: &HighlightList, counts: &[u16]) -> usize {
    match list.full {
        0 => counts.iter().map(|&c| usize::from(c)).sum(),
        each => usize::from(each) * LANES,
    }
}

/// The sums of a full list.
#[inline(always)]
fn sums_of_rows(powers: &[f32]) -> [f32; LANES] {
    let mut sums = [0.0; LANES];
    for row in powers.chunks_exact(LANES) {
        for (sum, power) in sums.iter_mut().zip(row) {
            *sum += power;
        }
    }
    sums
}

/// The sums of any other list, packed.
#[inline(always)]
fn sums_of_lanes(counts: &[u16], mut powers: &[f32]) -> [f32; LANES] {
    let mut sums = [0.0; LANES];
    for (sum, &count) in sums.iter_mut().zip(counts) {
        let own;
        (own, powers) = powers.split_at(count.into());
        *sum = own.iter().fold(0.0, |sum, power| sum + power);
    }
    sums
}

/// Writes packed coefficients; whether any is another than before.
#[inline(always)]
fn put(tile: &mut TransportTile, list: &HighlightList, packed: [f32; LANES]) -> bool {
    let mut changed = false;
    if list.at & HighlightList::SINGLE != 0 {
        let at = (list.at & !HighlightList::SINGLE) as usize;
        let count = list.mask.count_ones() as usize;
        for (single, value) in tile.singles[at..at + count].iter_mut().zip(packed) {
            changed |= single.coefficient != value;
            single.coefficient = value;
        }
        return changed;
    }
    let plane = &mut tile.planes[list.at as usize].0;
    if list.mask == u16::MAX {
        changed = *plane != packed;
        *plane = packed;
        return changed;
    }
    let mut mask = list.mask;
    for value in packed.into_iter().take(mask.count_ones() as usize) {
        let lane = &mut plane[mask.trailing_zeros() as usize & (LANES - 1)];
        changed |= *lane != value;
        *lane = value;
        mask &= mask - 1;
    }
    changed
}

#[inline(always)]
fn powers_of(logarithms: &[f32], exponent: f32, powers: &mut [f32]) {
    for (power, l) in powers.iter_mut().zip(logarithms) {
        *power = exp2_nonpositive(exponent * l);
    }
}

/// Does nothing where there are no weights.
#[inline(always)]
fn weigh(powers: &mut [f32], weights: &[f32]) {
    for (power, weight) in powers.iter_mut().zip(weights) {
        *power *= weight;
    }
}

#[inline(always)]
fn of_cosines(angles: &mut [f32]) {
    for angle in angles {
        *angle = log2_of_cosine(*angle);
    }
}

#[inline(always)]
fn of_tangents(angles: &mut [f32]) {
    for angle in angles {
        *angle *= -std::f32::consts::LOG2_E;
    }
}
