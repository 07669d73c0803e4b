//! Highlight coefficients from kept angles: the same code for a first fold and for a new exponent.

use fearless_simd::{Level, dispatch};

use super::transport::{HighlightList, Plane, TransportTile};
use crate::math::exp2_nonpositive;

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
    /// `weight · Σ cos^shininess β` for every lane of a list, samples summed in their order.
    ///
    /// `log2_cosines` holds just the samples of `list`. cos^n is 0 below 2^−60.
    pub fn plane(
        &mut self,
        list: &HighlightList,
        log2_cosines: &[f32],
        shininess: f32,
        weight: f32,
    ) -> Plane {
        self.powers.clear();
        self.powers.resize(log2_cosines.len(), 0.0);
        let powers = &mut self.powers;
        dispatch!(self.level, _simd => powers_of(log2_cosines, shininess, powers));
        let mut plane = Plane::default();
        let mut from = 0;
        for (lane, count) in plane.0.iter_mut().zip(list.counts) {
            let to = from + usize::from(count);
            *lane = powers[from..to].iter().fold(0.0, |sum, p| sum + p) * weight;
            from = to;
        }
        plane
    }

    /// Folds the highlights of the materials in `shininess` (one exponent per material, `None`
    /// where it did not change) of a tile again. Gives whether a coefficient may have changed.
    ///
    /// # Panics
    /// If the tile's highlight lists were released.
    pub fn refold(
        &mut self,
        tile: &mut TransportTile,
        shininess: &[Option<f32>],
        weight: f32,
    ) -> bool {
        let highlights = tile.highlights.as_ref().expect("highlight lists are kept");
        let (mut from, mut any) = (0, false);
        for list in &highlights.lists {
            let to = from + list.samples();
            if let Some(shininess) = shininess[list.material as usize] {
                let samples = &highlights.log2_cosines[from..to];
                tile.planes[list.plane as usize] = self.plane(list, samples, shininess, weight);
                any = true;
            }
            from = to;
        }
        any
    }
}

#[inline(always)]
fn powers_of(log2_cosines: &[f32], shininess: f32, powers: &mut [f32]) {
    for (power, l) in powers.iter_mut().zip(log2_cosines) {
        *power = exp2_nonpositive(shininess * l);
    }
}
