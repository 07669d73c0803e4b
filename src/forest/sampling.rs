//! The numbers of samples, which depend on the pixel, the sample's index, the effect and the branch alone.

use super::sequence::second;

/// One of the samples of a pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sample {
    /// The pixel.
    pub pixel: [u32; 2],
    /// Its place among the pixel's samples, < 4096.
    pub index: u32,
}

/// What numbers are drawn for: each effect has two dimensions of the pixel's point sequence.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum Effect {
    /// Where in the pixel.
    Position,
    /// Where on the lens.
    Lens,
    /// When, by the first number.
    Time,
    /// Where on a light.
    Light,
    /// Which way within a lobe.
    Gloss,
}

/// The branch of a sample at the eye: a tree's root.
pub const ROOT_PATH: u32 = 0;

impl Sample {
    /// Two numbers in [0, 1) for an effect at the branch with this hash.
    ///
    /// At the root they are two of ten dimensions of one Sobol sequence, so that they are stratified
    /// with those of the other effects, each dimension scrambled per pixel by a hashed nested
    /// permutation (Owen 1995 in the form of Laine and Karras 2011): any power of two of consecutive
    /// samples is stratified, and the first samples of a pixel are the same whatever their number.
    /// Farther down the tree the two dimensions are stratified with each other, and shuffled against
    /// all else (Burley, *Practical Hash-based Owen Scrambling*, JCGT 9(4), 2020).
    #[inline(always)]
    pub fn numbers(self, effect: Effect, path: u32) -> [f64; 2] {
        let Sample { pixel: [x, y], index } = self;
        let seed = hash(x ^ hash(y));
        if path != ROOT_PATH {
            return below_root(seed ^ hash(path), index, effect);
        }
        match effect {
            Effect::Position => {
                let u = scramble(index.reverse_bits(), hash(seed ^ 0x51ed_270b));
                let v = scramble(second(index), hash(seed ^ 0x2545_f491));
                [unit(u), unit(v)]
            }
            _ => {
                dimensions(effect).map(|d| unit(scramble(sobol(d, index), dimension_seed(seed, d))))
            }
        }
    }
}

/// The dimensions of an effect, counted from 0.
#[inline(always)]
fn dimensions(effect: Effect) -> [u32; 2] {
    let first = 2 * effect as u32;
    [first, first + 1]
}

#[inline(always)]
fn dimension_seed(seed: u32, dimension: u32) -> u32 {
    hash(seed ^ (dimension + 1).wrapping_mul(0x9e37_79b9))
}

/// Numbers of a branch: the first two dimensions in an order of their own.
fn below_root(seed: u32, index: u32, effect: Effect) -> [f64; 2] {
    let [a, b] = dimensions(effect).map(|d| dimension_seed(seed, d));
    let own = scramble(index, hash(a ^ b)) & (MOST_SAMPLES - 1);
    [unit(scramble(own.reverse_bits(), a)), unit(scramble(second(own), b))]
}

/// Samples of a pixel at most.
const MOST_SAMPLES: u32 = 1 << INDEX_BITS;
const INDEX_BITS: usize = 12;

/// Position of a sample within its pixel, each coordinate in [0, 1): with one sample per pixel the
/// centre.
#[inline(always)]
pub fn in_pixel(pixel: [u32; 2], index: u32, samples: u32) -> [f64; 2] {
    match samples {
        1 => [0.5, 0.5],
        _ => Sample { pixel, index }.numbers(Effect::Position, ROOT_PATH),
    }
}

/// The point of a disc of radius 1 with these numbers: squares around the middle become circles, so
/// that strata stay strata (Shirley and Chiu, *A Low Distortion Map*, 1997). [½, ½] is the centre.
pub fn on_disc([u, v]: [f64; 2]) -> [f64; 2] {
    let (a, b) = (2.0 * u - 1.0, 2.0 * v - 1.0);
    if a == 0.0 && b == 0.0 {
        return [0.0, 0.0];
    }
    let quarter = std::f64::consts::FRAC_PI_4;
    let (radius, angle) = match a.abs() > b.abs() {
        true => (a, quarter * (b / a)),
        false => (b, quarter * (2.0 - a / b)),
    };
    [radius * libm::cos(angle), radius * libm::sin(angle)]
}

/// A dimension of the Sobol sequence as a 32-bit fraction.
fn sobol(dimension: u32, mut index: u32) -> u32 {
    let directions = &DIRECTIONS[dimension as usize];
    let mut fraction = 0;
    for direction in directions {
        if index & 1 != 0 {
            fraction ^= direction;
        }
        index >>= 1;
    }
    fraction
}

/// Primitive polynomials (degree, inner coefficients) and first direction numbers of dimensions 3 to
/// 10 (Joe and Kuo, *Constructing Sobol sequences with better two-dimensional projections*, SIAM J.
/// Sci. Comput. 30, 2008: `new-joe-kuo-6`). The first two have forms of their own.
const POLYNOMIALS: [(usize, u32, [u32; 5]); 8] = [
    (2, 1, [1, 3, 0, 0, 0]),
    (3, 1, [1, 3, 1, 0, 0]),
    (3, 2, [1, 1, 1, 0, 0]),
    (4, 1, [1, 1, 3, 3, 0]),
    (4, 4, [1, 3, 5, 13, 0]),
    (5, 2, [1, 1, 5, 5, 17]),
    (5, 4, [1, 1, 5, 5, 5]),
    (5, 7, [1, 1, 7, 11, 19]),
];

/// What bit k of the index adds to a dimension.
static DIRECTIONS: [[u32; INDEX_BITS]; 10] = directions();

const fn directions() -> [[u32; INDEX_BITS]; 10] {
    let mut all = [[0; INDEX_BITS]; 10];
    let mut bit = 0;
    while bit < INDEX_BITS {
        all[0][bit] = 1 << (31 - bit);
        all[1][bit] = if bit == 0 { 1 << 31 } else { all[1][bit - 1] ^ all[1][bit - 1] >> 1 };
        bit += 1;
    }
    let mut dimension = 0;
    while dimension < POLYNOMIALS.len() {
        let (degree, inner, first) = POLYNOMIALS[dimension];
        let mut v = [0; INDEX_BITS];
        let mut k = 0;
        while k < INDEX_BITS {
            v[k] = if k < degree {
                first[k] << (31 - k)
            } else {
                let mut next = v[k - degree] ^ v[k - degree] >> degree;
                let mut i = 1;
                while i < degree {
                    next ^= (inner >> (degree - 1 - i) & 1) * v[k - i];
                    i += 1;
                }
                next
            };
            k += 1;
        }
        all[dimension + 2] = v;
        dimension += 1;
    }
    all
}

/// Nested uniform scrambling of a fraction's bits, from the highest down.
#[inline(always)]
pub(super) fn scramble(fraction: u32, seed: u32) -> u32 {
    let mut v = fraction.reverse_bits();
    v = v.wrapping_add(seed);
    v ^= v.wrapping_mul(0x6c50_b47c);
    v ^= v.wrapping_mul(0xb82f_1e52);
    v ^= v.wrapping_mul(0xc7af_e638);
    v ^= v.wrapping_mul(0x8d22_f6e6);
    v.reverse_bits()
}

/// A 32-bit mix (Wellons' lowbias32).
#[inline(always)]
pub(super) fn hash(mut v: u32) -> u32 {
    v ^= v >> 16;
    v = v.wrapping_mul(0x7feb_352d);
    v ^= v >> 15;
    v = v.wrapping_mul(0x846c_a68b);
    v ^ v >> 16
}

#[inline(always)]
pub(super) fn unit(fraction: u32) -> f64 {
    f64::from(fraction) / 4_294_967_296.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sixteen_samples_fill_every_row_column_and_square_once() {
        for pixel in [[0, 0], [17, 3], [1000, 2000]] {
            let cells = |columns: f64, rows: f64| {
                let mut seen: Vec<[u32; 2]> = (0..16)
                    .map(|i| in_pixel(pixel, i, 16))
                    .map(|[u, v]| [(u * columns) as u32, (v * rows) as u32])
                    .collect();
                seen.sort_unstable();
                seen.dedup();
                seen.len()
            };
            for (columns, rows) in [(16.0, 1.0), (8.0, 2.0), (4.0, 4.0), (2.0, 8.0), (1.0, 16.0)] {
                assert_eq!(cells(columns, rows), 16, "{pixel:?} {columns}×{rows}");
            }
        }
    }

    #[test]
    fn one_sample_is_the_centre_and_pixels_differ() {
        assert_eq!(in_pixel([5, 7], 0, 1), [0.5, 0.5]);
        assert_ne!(in_pixel([5, 7], 0, 16), in_pixel([6, 7], 0, 16));
        assert_ne!(in_pixel([5, 7], 0, 16), in_pixel([7, 5], 0, 16));
        assert_eq!(in_pixel([5, 7], 3, 16), in_pixel([5, 7], 3, 64));
    }

    const PIXELS: [[u32; 2]; 4] = [[0, 0], [17, 3], [1000, 2000], [4, 4]];
    const EFFECTS: [Effect; 5] =
        [Effect::Position, Effect::Lens, Effect::Time, Effect::Light, Effect::Gloss];

    #[test]
    fn closed_forms_are_the_sequence() {
        for index in 0..MOST_SAMPLES {
            assert_eq!(sobol(0, index), index.reverse_bits());
            assert_eq!(sobol(1, index), second(index));
        }
    }

    /// How unevenly points fill boxes of equal size: the greatest and the least number in any of
    /// `columns` × `rows` boxes.
    fn counts(points: &[[f64; 2]], [columns, rows]: [usize; 2]) -> (usize, usize) {
        let mut boxes = vec![0; columns * rows];
        for [u, v] in points {
            boxes[(u * columns as f64) as usize * rows + (v * rows as f64) as usize] += 1;
        }
        (*boxes.iter().min().unwrap(), *boxes.iter().max().unwrap())
    }

    #[test]
    fn every_effect_is_stratified_and_so_are_any_two_at_the_root() {
        for pixel in PIXELS {
            let of = |effect, path| -> Vec<[f64; 2]> {
                (0..256).map(|index| Sample { pixel, index }.numbers(effect, path)).collect()
            };
            for effect in EFFECTS {
                assert_eq!(counts(&of(effect, ROOT_PATH), [256, 1]), (1, 1), "{effect:?}");
                assert_eq!(counts(&of(effect, ROOT_PATH), [1, 256]), (1, 1), "{effect:?}");
                for path in [1, 77] {
                    assert_eq!(counts(&of(effect, path), [16, 16]), (1, 1), "{effect:?} {path}");
                    assert_eq!(counts(&of(effect, path), [64, 4]), (1, 1), "{effect:?} {path}");
                }
            }
            let columns: Vec<Vec<f64>> = EFFECTS
                .iter()
                .flat_map(|&e| [0, 1].map(|i| of(e, ROOT_PATH).iter().map(|n| n[i]).collect()))
                .collect();
            for (i, a) in columns.iter().enumerate() {
                for b in &columns[..i] {
                    let pairs: Vec<_> = a.iter().zip(b).map(|(a, b)| [*a, *b]).collect();
                    // At worst a net of quality 4: 2^4 points in each of 16 boxes.
                    assert_eq!(counts(&pairs, [4, 4]), (16, 16), "dimension {i}");
                }
            }
            // The helper must be able to fail: the same numbers twice fill a diagonal.
            let twice: Vec<_> = columns[2].iter().map(|a| [*a, *a]).collect();
            assert_eq!(counts(&twice, [4, 4]).0, 0);
        }
    }

    #[test]
    fn branches_are_independent_of_each_other() {
        // The sum over pixels of covariances, in units of its own deviation if they are independent:
        // consecutive samples lie on opposite sides in both, which at most doubles its variance.
        let deviation = |a: &dyn Fn(Sample) -> f64, b: &dyn Fn(Sample) -> f64| {
            let (count, mut sum) = (1 << 16, 0.0);
            for i in 0..count / 16 {
                let pixel = [i % 64, i / 64];
                sum += (0..16)
                    .map(|index| Sample { pixel, index })
                    .map(|s| (a(s) - 0.5) * (b(s) - 0.5))
                    .sum::<f64>();
            }
            (sum / ((2.0 * f64::from(count)).sqrt() / 12.0)).abs()
        };
        let number = |effect, path, i: usize| move |s: Sample| s.numbers(effect, path)[i];
        let position = number(Effect::Position, ROOT_PATH, 0);
        for (effect, path) in [(Effect::Light, 5), (Effect::Light, 6), (Effect::Gloss, 5)] {
            for i in [0, 1] {
                assert!(deviation(&position, &number(effect, path, i)) < 4.0, "{effect:?} {path}");
            }
        }
        let (one, other) = (number(Effect::Light, 5, 0), number(Effect::Light, 6, 0));
        assert!(deviation(&one, &other) < 4.0);
        assert!(deviation(&one, &one) > 4.0, "the measure must be able to fail");
    }

    #[test]
    fn a_disc_is_filled_evenly_from_its_centre() {
        assert_eq!(on_disc([0.5, 0.5]), [0.0, 0.0]);
        let n = 64;
        let grid = (0..n * n).map(|i| [i % n, i / n].map(|k| (f64::from(k) + 0.5) / f64::from(n)));
        let mut moment = 0.0;
        for point in grid {
            let [x, y] = on_disc(point);
            assert!(x.hypot(y) <= 1.0 + 1e-15);
            moment += x * x;
        }
        // Of a disc's diameter d: d²/16.
        assert!((moment / f64::from(n * n) / 0.25 - 1.0).abs() < 1e-3);
    }

    #[test]
    fn means_of_what_is_smooth_converge_faster_than_one_over_n() {
        // Root mean square over pixels of the error of a mean over the lens and the shutter.
        let rms = |samples: u32| {
            let pixels = 400;
            let error = |i: u32| {
                let value = |index| {
                    let at = Sample { pixel: [i % 20, i / 20], index };
                    let [u, v] = at.numbers(Effect::Lens, ROOT_PATH);
                    let [t, _] = at.numbers(Effect::Time, ROOT_PATH);
                    (1.0 + u * v) * (0.5 + t * t)
                };
                let mean = (0..samples).map(value).sum::<f64>() / f64::from(samples);
                (mean - 1.25 * (0.5 + 1.0 / 3.0)).powi(2)
            };
            ((0..pixels).map(error).sum::<f64>() / f64::from(pixels)).sqrt()
        };
        let slope = (rms(256) / rms(16)).log2() / 4.0;
        assert!(slope < -0.9, "{slope}");
    }
}
