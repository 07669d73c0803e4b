//! What every term adds to a pixel as it is shaded, and how much of that is every sample's.

use std::collections::HashMap;
use std::iter::Sum;
use std::ops::{Add, AddAssign, Mul};

use crate::color::Rgb;
use crate::film::layout::{LANES, Place};
use crate::fold::transport::TransportTile;
use crate::fold::{Folder, Names};
use crate::forest::tree::TileTrees;
use crate::scene::factor::Factor;
use crate::scene::model::Peak;

/// A part of a pixel's light, before exposure. In f64, so that all parts together, whatever their
/// order, round to the f32 that the picture holds.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Share(pub [f64; 3]);

impl Share {
    /// How bright it is: Rec. 709 luminance; below 0 where filters subtract.
    pub fn luminance(self) -> f64 {
        let [r, g, b] = self.0;
        0.2126 * r + 0.7152 * g + 0.0722 * b
    }

    /// As the picture holds it.
    pub fn rounded(self) -> Rgb {
        Rgb(self.0.map(|c| c as f32))
    }
}

impl Add for Share {
    type Output = Share;
    fn add(self, o: Share) -> Share {
        Share([self.0[0] + o.0[0], self.0[1] + o.0[1], self.0[2] + o.0[2]])
    }
}

impl AddAssign for Share {
    fn add_assign(&mut self, o: Share) {
        *self = *self + o;
    }
}

impl Mul<f64> for Share {
    type Output = Share;
    fn mul(self, k: f64) -> Share {
        Share(self.0.map(|c| c * k))
    }
}

impl Sum for Share {
    fn sum<I: Iterator<Item = Share>>(shares: I) -> Share {
        shares.fold(Share::default(), Add::add)
    }
}

/// A pixel's sum while it is carried out: as in shading, planes and single coefficients apart.
#[derive(Default)]
struct Running {
    planes: Rgb,
    singles: Rgb,
}

impl Running {
    fn total(&self) -> Rgb {
        self.planes + self.singles
    }

    /// Adds to one of the two sums and gives what the total grew by, rounding included: all that is
    /// given adds up to the total.
    fn add(&mut self, light: Rgb, single: bool) -> Share {
        let before = self.total();
        let sum = if single { &mut self.singles } else { &mut self.planes };
        *sum = *sum + light;
        let after = self.total();
        let grown = |i: usize| f64::from(after.0[i]) - f64::from(before.0[i]);
        // Light without bound has no parts.
        Share([0, 1, 2].map(|i| if grown(i).is_finite() { grown(i) } else { 0.0 }))
    }
}

/// A pixel's light, bit for bit as it is shaded, and what every term, by its id, adds to it.
pub(super) fn row(
    tile: &TransportTile,
    place: Place,
    values: &[[f32; 4]],
) -> (Rgb, Vec<(u32, Share)>) {
    let block = tile.block(place.block);
    let planes = block.entries.iter().zip(block.planes);
    let planes = planes.map(|(&entry, plane)| (entry as usize, plane.0[place.lane], false));
    let singles = block.singles.iter().filter(|s| s.lane() == place.lane);
    let singles = singles.map(|s| (s.entry(), s.coefficient, true));
    let mut sum = Running::default();
    let mut shares = Vec::new();
    for (entry, coefficient, single) in planes.chain(singles) {
        let id = tile.terms[entry];
        let [r, g, b, _] = values[id as usize];
        shares.push((id, sum.add(Rgb([r, g, b]) * coefficient, single)));
    }
    (sum.total(), shares)
}

/// What stands in front of the terms of single samples.
pub(super) struct Pieces {
    /// The factors of every term.
    pub(super) terms: Vec<Vec<Factor>>,
    /// Per sample the terms that it has, with their coefficients.
    samples: Vec<Vec<(usize, f32)>>,
}

impl Pieces {
    /// Folds every sample of a pixel for itself, as lanes of blocks that hold nothing else. `weight` is
    /// that of one sample.
    pub(super) fn fold(
        trees: &TileTrees,
        names: &Names,
        peaks: &[Option<Peak>],
        weight: f32,
    ) -> Pieces {
        let count = trees.hits.len();
        let mut folder = Folder::default();
        folder.begin_tile();
        let mut reader = trees.read(0);
        for first in (0..count).step_by(LANES) {
            let lanes = std::array::from_fn(|lane| u32::from(first + lane < count));
            folder.block(&mut reader, &lanes, names);
        }
        let folded = folder.finish_tile(weight, peaks);
        let mut samples = vec![Vec::new(); count];
        for (index, samples) in samples.chunks_mut(LANES).enumerate() {
            let block = folded.tile.block(index);
            for (&entry, plane) in block.entries.iter().zip(block.planes) {
                for (sample, &coefficient) in samples.iter_mut().zip(&plane.0) {
                    sample.push((entry as usize, coefficient));
                }
            }
            for single in block.singles {
                samples[single.lane()].push((single.entry(), single.coefficient));
            }
        }
        samples.iter_mut().for_each(|terms| terms.retain(|(_, c)| *c != 0.0));
        let terms = folded.tile.terms.iter().map(|&id| folded.trie.factors(id)).collect();
        Pieces { terms, samples }
    }

    /// Shares out what every term adds to the pixel: per sample its terms' shares. The shares of a term
    /// go as its samples' coefficients, and add up to what the term adds.
    pub(super) fn shared(&self, row: &HashMap<Vec<Factor>, Share>) -> Vec<Vec<(usize, Share)>> {
        let mut sums = vec![(0.0, 0u32); self.terms.len()];
        for &(term, coefficient) in self.samples.iter().flatten() {
            let (sum, count) = &mut sums[term];
            (*sum, *count) = (*sum + f64::from(coefficient), *count + 1);
        }
        let share = |&(term, coefficient): &(usize, f32)| {
            let whole = row.get(&self.terms[term]).copied().unwrap_or_default();
            let (sum, count) = sums[term];
            // Samples that cancel each other leave a rounding error, to which all have the same right.
            let part = match f64::from(coefficient) / sum {
                part if sum != 0.0 && part.is_finite() => part,
                _ => 1.0 / f64::from(count),
            };
            (term, whole * part)
        };
        self.samples.iter().map(|terms| terms.iter().map(share).collect()).collect()
    }
}
