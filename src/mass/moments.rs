//! Sums of moments of mass, and of volume, over jittered rays, with their covariance from pairs of rays.

use std::ops::AddAssign;

/// How many moments there are: ∫ρ, ∫ρx, ∫ρy, ∫ρz, ∫ρxx, ∫ρyy, ∫ρzz, ∫ρyz, ∫ρzx, ∫ρxy and ∫1 over a
/// solid of density ρ.
pub(super) const COUNT: usize = 11;

/// Where the volume stands.
pub(super) const VOLUME: usize = 10;

/// One number per moment, in this order.
pub(super) type Moments = [f64; COUNT];

/// Where the second moment of two axes stands.
pub(super) const fn second(a: usize, b: usize) -> usize {
    if a == b { 4 + a } else { 10 - a - b }
}

/// The moments of the part of a line parallel to `axis` between two coordinates, for a density of 1;
/// `across` holds the two other coordinates, of the axes `axis + 1` and `axis + 2`. Exact but for
/// rounding.
pub(super) fn of_interval(axis: usize, across: [f64; 2], from: f64, to: f64) -> Moments {
    let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
    let [y, z] = across;
    let length = to - from;
    let middle = (from + to) / 2.0;
    let first = length * middle;
    let mut m = [0.0; COUNT];
    m[0] = length;
    m[VOLUME] = length;
    m[1 + axis] = first;
    m[1 + u] = length * y;
    m[1 + v] = length * z;
    // (b³ − a³)/3 without its cancellation.
    m[second(axis, axis)] = length * (middle * middle + length * length / 12.0);
    m[second(u, u)] = length * y * y;
    m[second(v, v)] = length * z * z;
    m[second(axis, u)] = first * y;
    m[second(axis, v)] = first * z;
    m[second(u, v)] = length * y * z;
    m
}

/// The same with another density.
pub(super) fn dense(moments: Moments, density: f64) -> Moments {
    let volume = moments[VOLUME];
    let mut moments = moments.map(|x| density * x);
    moments[VOLUME] = volume;
    moments
}

/// Moments estimated with their covariance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Estimate {
    pub(super) mean: Moments,
    /// Symmetric.
    pub(super) covariance: [Moments; COUNT],
}

impl Estimate {
    pub(super) const ZERO: Estimate =
        Estimate { mean: [0.0; COUNT], covariance: [[0.0; COUNT]; COUNT] };

    /// Adds a cell of a grid, of this area, that two independent rays met.
    ///
    /// The mean of the two is without bias, and so is a quarter of the square of their difference as
    /// its variance, whatever the cells hold (stratified sampling with two samples per stratum).
    pub(super) fn add_pair(&mut self, area: f64, a: &Moments, b: &Moments) {
        if a == b {
            for (sum, x) in self.mean.iter_mut().zip(a) {
                *sum += area * x;
            }
            return;
        }
        let mut half = [0.0; COUNT];
        for k in 0..COUNT {
            self.mean[k] += area * (a[k] + b[k]) / 2.0;
            half[k] = area * (a[k] - b[k]) / 2.0;
        }
        for (row, x) in self.covariance.iter_mut().zip(half) {
            for (sum, y) in row.iter_mut().zip(half) {
                *sum += x * y;
            }
        }
    }

    /// The mean of several independent estimates of the same moments.
    pub(super) fn mean_of(all: &[Estimate]) -> Estimate {
        let mut mean = Estimate::ZERO;
        all.iter().for_each(|one| mean += *one);
        let count = all.len() as f64;
        mean.mean.iter_mut().for_each(|x| *x /= count);
        mean.covariance.iter_mut().flatten().for_each(|x| *x /= count * count);
        mean
    }

    /// Variance of the sum of the moments with these weights.
    pub(super) fn variance(&self, weights: &Moments) -> f64 {
        let row = |row: &Moments| row.iter().zip(weights).map(|(c, w)| c * w).sum::<f64>();
        let rows = self.covariance.iter().zip(weights);
        rows.map(|(covariance, weight)| weight * row(covariance)).sum::<f64>().max(0.0)
    }
}

impl AddAssign for Estimate {
    fn add_assign(&mut self, other: Estimate) {
        let Estimate { mean, covariance } = other;
        self.mean.iter_mut().zip(mean).for_each(|(sum, x)| *sum += x);
        let rows = self.covariance.iter_mut().flatten().zip(covariance.into_iter().flatten());
        rows.for_each(|(sum, x)| *sum += x);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn intervals_are_integrated_exactly() {
        // Along y from 1 to 3, at z = 5, x = 7.
        let m = of_interval(1, [5.0, 7.0], 1.0, 3.0);
        assert_eq!(m[..4], [2.0, 14.0, 4.0, 10.0]);
        assert_eq!(m[VOLUME], 2.0);
        assert_eq!([m[second(0, 0)], m[second(2, 2)]], [98.0, 50.0]);
        assert!((m[second(1, 1)] - 26.0 / 3.0).abs() < 1e-14);
        assert_eq!([m[second(1, 2)], m[second(2, 0)], m[second(0, 1)]], [20.0, 70.0, 28.0]);
        assert_eq!(second(1, 2), second(2, 1));
        let places: Vec<usize> = [(1, 2), (2, 0), (0, 1)].map(|(a, b)| second(a, b)).to_vec();
        assert_eq!(places, [7, 8, 9]);
    }

    #[test]
    fn pairs_give_mean_and_variance() {
        let mut sum = Estimate::ZERO;
        let (mut a, mut b) = ([1.0; COUNT], [1.0; COUNT]);
        (a[0], b[0]) = (3.0, 5.0);
        sum.add_pair(0.5, &a, &b);
        assert_eq!((sum.mean[0], sum.mean[1]), (2.0, 0.5));
        let mut weights = [0.0; COUNT];
        weights[0] = 2.0;
        // (0.5·(3 − 5)/2)² = 0.25, times 2²
        assert_eq!(sum.variance(&weights), 1.0);
        let mean = Estimate::mean_of(&[sum, sum]);
        assert_eq!((mean.mean[0], mean.variance(&weights)), (2.0, 0.5));
    }
}
