//! Reconstruction filters by importance: samples lie where the filter is large, and weigh the same.
//!
//! A sample's position in and around its pixel is drawn from |f|; what remains of f is a sign. A
//! pixel is the mean of its samples, each times its sign, divided by the mean sign: a picture of one
//! light keeps it, up to rounding, and every sample belongs to one pixel.

use super::sampling::in_pixel;
use crate::scene::filter::Filter;

/// A filter made ready: where its samples lie.
#[derive(Clone, Debug)]
pub struct Reconstruction {
    kind: Kind,
    /// Whether some of its samples count as less than nothing.
    signed: bool,
}

#[derive(Clone, Debug)]
enum Kind {
    Box,
    Tent,
    /// From the centre outwards.
    Pieces(Vec<Piece>),
}

/// A part of |f| on one side of the centre.
#[derive(Clone, Debug)]
struct Piece {
    /// The share of the side's whole mass that lies here and nearer to the centre.
    end: f64,
    /// The same without this piece.
    begin: f64,
    /// Distances that cut it into [`CELLS`] parts of equal mass, and its ends.
    cuts: Vec<f64>,
    negative: bool,
}

/// Parts of a piece; |f| is taken as constant in each.
const CELLS: usize = 64;

/// Where the sides of filters are cut: at zeros, and so that |f| varies little in a cell. Moments of
/// what is sampled are then those of the filter to 3e-5.
const MITCHELL_ENDS: [f64; 8] = [0.0, 0.7, 1.0, 8.0 / 7.0, 1.3, 1.6, 1.85, 2.0];
const GAUSSIAN_ENDS: [f64; 5] = [0.0, 0.6, 1.0, 1.25, 1.5];

/// The weights of a pixel's samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Weights {
    positive: f32,
    negative: f32,
}

impl Weights {
    /// Every sample weighs 1.
    const EVEN: Weights = Weights { positive: 1.0, negative: 1.0 };

    /// The weight of a sample; those of a pixel have the mean 1.
    #[inline(always)]
    pub fn of(self, negative: bool) -> f32 {
        if negative { self.negative } else { self.positive }
    }
}

impl Reconstruction {
    /// Prepares a filter.
    pub fn new(filter: Filter) -> Reconstruction {
        let kind = match filter {
            Filter::Box => Kind::Box,
            Filter::Tent => Kind::Tent,
            Filter::Mitchell => Kind::Pieces(pieces(&MITCHELL_ENDS, mitchell_mass)),
            Filter::Gaussian => Kind::Pieces(pieces(&GAUSSIAN_ENDS, gaussian_mass)),
        };
        Reconstruction { kind, signed: filter == Filter::Mitchell }
    }

    /// Whether some samples have weights below 0.
    pub fn is_signed(&self) -> bool {
        self.signed
    }

    /// Where the sample with these numbers lies, in pixels from the pixel's upper left corner, and
    /// whether its sign is −.
    pub fn place(&self, numbers: [f64; 2]) -> ([f64; 2], bool) {
        let [(x, a), (y, b)] = numbers.map(|u| self.along(u));
        ([x, y], a != b)
    }

    fn along(&self, u: f64) -> (f64, bool) {
        // The share of the side's mass that is nearer to the centre.
        let (side, share) = if u < 0.5 { (-1.0, 1.0 - 2.0 * u) } else { (1.0, 2.0 * u - 1.0) };
        match &self.kind {
            Kind::Box => (u, false),
            Kind::Tent => (0.5 + side * (1.0 - (1.0 - share).sqrt()), false),
            Kind::Pieces(pieces) => {
                let last = &pieces[pieces.len() - 1];
                let piece = pieces.iter().find(|piece| share < piece.end).unwrap_or(last);
                (0.5 + side * piece.distance(share), piece.negative)
            }
        }
    }

    /// The weights of a pixel's samples: their signs, divided by the mean of all of them, which is
    /// an exact sum. Where fewer than three quarters are positive, as among a handful some pixel's
    /// are by chance, every one is.
    pub fn weights(&self, pixel: [u32; 2], samples: u32) -> Weights {
        if !self.signed || samples == 1 {
            return Weights::EVEN;
        }
        let negative = |index: &u32| self.place(in_pixel(pixel, *index, samples)).1;
        let below = (0..samples).filter(negative).count() as u32;
        if 4 * below > samples {
            return Weights::EVEN;
        }
        let weight = (f64::from(samples) / f64::from(samples - 2 * below)) as f32;
        Weights { positive: weight, negative: -weight }
    }
}

impl Piece {
    /// The distance from the centre within which this share of the mass lies.
    fn distance(&self, share: f64) -> f64 {
        let Piece { end, begin, cuts, negative: _ } = self;
        let at = ((share - begin) / (end - begin)).clamp(0.0, 1.0) * CELLS as f64;
        let cell = (at as usize).min(CELLS - 1);
        cuts[cell] + (cuts[cell + 1] - cuts[cell]) * (at - cell as f64)
    }
}

/// Cuts the side of a filter at `ends`, zeros among them, and each piece into cells; `mass` is its integral
/// from 0, which only rises or only falls in a piece.
fn pieces(ends: &[f64], mass: fn(f64) -> f64) -> Vec<Piece> {
    let masses: Vec<f64> = ends.windows(2).map(|e| mass(e[1]) - mass(e[0])).collect();
    let whole: f64 = masses.iter().map(|m| m.abs()).sum();
    let mut begin = 0.0;
    let mut pieces = Vec::new();
    for (ends, own) in ends.windows(2).zip(masses) {
        let end = begin + own.abs() / whole;
        let share = |x: f64| (mass(x) - mass(ends[0])) / own;
        let cut = |cell: usize| bisected([ends[0], ends[1]], cell as f64 / CELLS as f64, share);
        let mut cuts: Vec<f64> = (0..=CELLS).map(cut).collect();
        (cuts[0], cuts[CELLS]) = (ends[0], ends[1]);
        pieces.push(Piece { end, begin, cuts, negative: own < 0.0 });
        begin = end;
    }
    pieces
}

/// Where a rising function has a value.
fn bisected([mut low, mut high]: [f64; 2], value: f64, rising: impl Fn(f64) -> f64) -> f64 {
    // As often as an f64 between 0 and 2 has bits that count here.
    for _ in 0..48 {
        let middle = (low + high) / 2.0;
        if rising(middle) < value { low = middle } else { high = middle }
    }
    (low + high) / 2.0
}

/// Integral of Mitchell and Netravali's filter with B = C = ⅓ from 0 to x ≤ 2.
fn mitchell_mass(x: f64) -> f64 {
    let core = |x: f64| x * (16.0 / 18.0 + x * x * (-12.0 / 18.0 + x * (21.0 / 72.0)));
    let tail =
        |x: f64| x * (32.0 / 18.0 + x * (-30.0 / 18.0 + x * (12.0 / 18.0 - x * (7.0 / 72.0))));
    if x <= 1.0 { core(x) } else { core(1.0) + tail(x) - tail(1.0) }
}

/// Integral of a Gaussian of deviation ½, times a factor, from 0 to x.
fn gaussian_mass(x: f64) -> f64 {
    libm::erf(x * std::f64::consts::SQRT_2)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// ∫ x^n f from −2 to 2 over ∫ f, by many samples in a row.
    fn moment(filter: Filter, power: i32) -> f64 {
        let ready = Reconstruction::new(filter);
        let count = 1 << 18;
        let (mut sum, mut signs) = (0.0, 0.0);
        for i in 0..count {
            let (x, negative) = ready.along((f64::from(i) + 0.5) / f64::from(count));
            let sign = if negative { -1.0 } else { 1.0 };
            sum += sign * (x - 0.5).powi(power);
            signs += sign;
        }
        sum / signs
    }

    #[test]
    fn samples_have_the_moments_of_their_filter() {
        let gaussian = |n: i32| {
            let (mut sum, mut mass, steps) = (0.0, 0.0, 30_000);
            for i in 0..steps {
                let x = 1.5 * (f64::from(i) + 0.5) / f64::from(steps);
                let f = (-2.0 * x * x).exp();
                (sum, mass) = (sum + f * x.powi(n), mass + f);
            }
            sum / mass
        };
        for (filter, second, fourth, tolerance) in [
            (Filter::Box, 1.0 / 12.0, 1.0 / 80.0, 1e-6),
            (Filter::Tent, 1.0 / 6.0, 1.0 / 15.0, 1e-6),
            (Filter::Gaussian, gaussian(2), gaussian(4), 1e-4),
            (Filter::Mitchell, mitchell(2), mitchell(4), 1e-4),
        ] {
            for (power, truth) in [(1, 0.0), (2, second), (3, 0.0), (4, fourth)] {
                let found = moment(filter, power);
                assert!((found - truth).abs() < tolerance, "{filter:?} {power}: {found} {truth}");
            }
        }
    }

    /// Moment of the cubic itself.
    fn mitchell(power: i32) -> f64 {
        let f = |x: f64| match x < 1.0 {
            true => (7.0 * x.powi(3) - 12.0 * x * x + 16.0 / 3.0) / 6.0,
            false => (-7.0 / 3.0 * x.powi(3) + 12.0 * x * x - 20.0 * x + 32.0 / 3.0) / 6.0,
        };
        let steps = 40_000;
        let points = (0..steps).map(|i| 2.0 * (f64::from(i) + 0.5) / f64::from(steps));
        points.map(|x| 2.0 * f(x) * x.powi(power)).sum::<f64>() * 2.0 / f64::from(steps)
    }

    #[test]
    fn the_integrals_are_those_of_the_filters() {
        assert!((2.0 * mitchell_mass(2.0) - 1.0).abs() < 1e-15);
        assert!((mitchell(0) - 1.0).abs() < 1e-8);
        for x in [0.3, 1.0, 1.1, 8.0 / 7.0, 1.7] {
            let h = 1e-5;
            let slope = (mitchell_mass(x + h) - mitchell_mass(x - h)) / (2.0 * h);
            let f = match x < 1.0 {
                true => (7.0 * x.powi(3) - 12.0 * x * x + 16.0 / 3.0) / 6.0,
                false => (-7.0 / 3.0 * x.powi(3) + 12.0 * x * x - 20.0 * x + 32.0 / 3.0) / 6.0,
            };
            assert!((slope - f).abs() < 1e-9, "{x}: {slope} {f}");
        }
    }

    #[test]
    fn weights_of_a_pixel_have_the_mean_one() {
        let ready = Reconstruction::new(Filter::Mitchell);
        let mut fell_back = 0;
        for samples in [1, 2, 3, 4, 7, 16, 64] {
            for pixel in (0..200).map(|i| [i % 20, i / 20]) {
                let weights = ready.weights(pixel, samples);
                let sign = |i| ready.place(in_pixel(pixel, i, samples)).1;
                let sum: f64 = (0..samples).map(|i| f64::from(weights.of(sign(i)))).sum();
                assert!((sum / f64::from(samples) - 1.0).abs() < 1e-6, "{pixel:?} {samples}");
                fell_back += u32::from(samples == 64 && weights == Weights::EVEN);
            }
        }
        assert_eq!(fell_back, 0, "64 samples are enough for signs");
        assert_eq!(Reconstruction::new(Filter::Tent).weights([3, 4], 16), Weights::EVEN);
    }

    #[test]
    fn one_sample_is_the_centre_of_every_filter() {
        for filter in Filter::ALL {
            let (at, negative) = Reconstruction::new(filter).place([0.5, 0.5]);
            assert_eq!((at, negative), ([0.5, 0.5], false), "{filter:?}");
        }
    }
}
