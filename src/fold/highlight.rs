//! Highlight coefficients from kept angles: the same code for a first fold and for a new exponent.

use fearless_simd::{Level, dispatch};

use super::transport::{HighlightList, Highlights, TransportTile};
use crate::film::layout::LANES;
use crate::math::{exp2_nonpositive, log2_of_cosine};

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
    /// Turns every 1 − cos β into log2 cos β.
    pub fn take_logarithms(&self, angles: &mut [f32]) {
        dispatch!(self.level, _simd => logarithms_of(angles));
    }

    /// Computes the highlight coefficients of a tile, of the materials that have an exponent in
    /// `shininess`: `weight · Σ cos^shininess β` per term and lane, samples summed in their order.
    /// cos^n counts as 0 below 2^−60. Gives whether there were any.
    pub fn fold(
        &mut self,
        tile: &mut TransportTile,
        highlights: &Highlights,
        shininess: &[Option<f32>],
        weight: f32,
    ) -> bool {
        let (mut lane_from, mut from, mut any) = (0, 0, false);
        for list in &highlights.lists {
            let lane_to = lane_from + list.mask.count_ones() as usize;
            let counts = &highlights.counts[lane_from..lane_to];
            let to = from + counts.iter().map(|&c| usize::from(c)).sum::<usize>();
            if let Some(exponent) = shininess[list.material as usize] {
                let sums = self.sums(&highlights.log2_cosines[from..to], counts, exponent, weight);
                put(tile, list, sums);
                any = true;
            }
            (lane_from, from) = (lane_to, to);
        }
        any
    }

    /// The coefficients of one list, packed.
    fn sums(
        &mut self,
        log2_cosines: &[f32],
        counts: &[u16],
        exponent: f32,
        weight: f32,
    ) -> [f32; LANES] {
        self.powers.clear();
        self.powers.resize(log2_cosines.len(), 0.0);
        let powers = &mut self.powers;
        dispatch!(self.level, _simd => powers_of(log2_cosines, exponent, powers));
        let mut sums = [0.0; LANES];
        let mut from = 0;
        for (sum, &count) in sums.iter_mut().zip(counts) {
            let to = from + usize::from(count);
            *sum = powers[from..to].iter().fold(0.0, |sum, p| sum + p) * weight;
            from = to;
        }
        sums
    }

    /// [`HighlightPower::fold`] from the lists that the tile keeps.
    ///
    /// # Panics
    /// If they were released.
    pub fn refold(
        &mut self,
        tile: &mut TransportTile,
        shininess: &[Option<f32>],
        weight: f32,
    ) -> bool {
        let highlights = tile.highlights.take().expect("highlight lists are kept");
        let any = self.fold(tile, &highlights, shininess, weight);
        tile.highlights = Some(highlights);
        any
    }
}

/// Writes packed coefficients to where the list's term is stored.
fn put(tile: &mut TransportTile, list: &HighlightList, packed: [f32; LANES]) {
    let count = list.mask.count_ones() as usize;
    if list.at & HighlightList::SINGLE != 0 {
        let at = (list.at & !HighlightList::SINGLE) as usize;
        for (single, value) in tile.singles[at..at + count].iter_mut().zip(packed) {
            single.coefficient = value;
        }
    } else {
        let plane = &mut tile.planes[list.at as usize].0;
        let lanes = plane.iter_mut().enumerate().filter(|(i, _)| list.mask >> i & 1 != 0);
        for ((_, lane), value) in lanes.zip(packed) {
            *lane = value;
        }
    }
}

#[inline(always)]
fn powers_of(log2_cosines: &[f32], exponent: f32, powers: &mut [f32]) {
    for (power, l) in powers.iter_mut().zip(log2_cosines) {
        *power = exp2_nonpositive(exponent * l);
    }
}

#[inline(always)]
fn logarithms_of(angles: &mut [f32]) {
    for angle in angles {
        *angle = log2_of_cosine(*angle);
    }
}
