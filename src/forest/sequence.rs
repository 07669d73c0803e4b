//! The points of lights and lobes: one sequence of points per node of a tree, from which all of its
//! lights draw.

use super::sampling::{Effect, Sample, hash, scramble, unit};

/// The hash of a branch of the node with this hash: it stands for the string of reflections and
/// transmissions that leads there from the eye.
#[inline(always)]
pub(super) fn branch_path(path: u32, transmitted: bool) -> u32 {
    hash(path.wrapping_mul(2).wrapping_add(1 + u32::from(transmitted)))
}

/// A sequence of points of the unit square, every power of two of which is stratified: the first two
/// dimensions of Sobol's, scrambled, and visited in an order of its own, so that it knows nothing of
/// the pixel's other sequences (Burley, *Practical Hash-based Owen Scrambling*, JCGT 9(4), 2020).
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Sequence {
    order: u32,
    seeds: [u32; 2],
}

impl Sequence {
    /// The one that all lights at a node draw from: a light with n samples takes the points n·i to
    /// n·i + n − 1 for the pixel's sample i. It depends on the pixel and the node's path alone.
    ///
    /// Out of line, so that it is not made ready for lights that have no area.
    #[inline(never)]
    pub(super) fn of_lights(Sample { pixel: [x, y], index: _ }: Sample, path: u32) -> Sequence {
        let seed = hash(x ^ hash(y ^ hash(path ^ hash(Effect::Light as u32))));
        let [order, u, v] = [0x9e37_79b9, 0x3c6e_f372, 0xdaa6_6d2b].map(|salt| hash(seed ^ salt));
        Sequence { order, seeds: [u, v] }
    }

    /// A point, both coordinates in [0, 1).
    #[inline(always)]
    pub(super) fn point(self, index: u32) -> [f64; 2] {
        let own = scramble(index, self.order);
        [scramble(own.reverse_bits(), self.seeds[0]), scramble(second(own), self.seeds[1])]
            .map(unit)
    }
}

/// The second dimension of the Sobol sequence as a 32-bit fraction, for indices of all 32 bits: bit
/// 31 − i is the parity of the index' bits k with i ⊂ k, which is where Pascal's triangle is odd.
#[inline(always)]
pub(super) fn second(index: u32) -> u32 {
    let mut w = index;
    w ^= w >> 1 & 0x5555_5555;
    w ^= w >> 2 & 0x3333_3333;
    w ^= w >> 4 & 0x0f0f_0f0f;
    w ^= w >> 8 & 0x00ff_00ff;
    w ^= w >> 16 & 0x0000_ffff;
    w.reverse_bits()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::forest::sampling::{ROOT_PATH, in_pixel};

    #[test]
    fn the_second_dimension_is_sobol_s() {
        for index in (0..5000).chain([1 << 31, u32::MAX, 0x1234_5678]) {
            let (mut direction, mut fraction) = (1u32 << 31, 0);
            for bit in 0..32 {
                fraction ^= if index >> bit & 1 != 0 { direction } else { 0 };
                direction ^= direction >> 1;
            }
            assert_eq!(second(index), fraction, "{index}");
        }
    }

    /// How many of 64 boxes hold exactly one of 64 points.
    fn boxes([columns, rows]: [f64; 2], point: impl Fn(u32) -> [f64; 2]) -> usize {
        let mut seen: Vec<[u32; 2]> =
            (0..64).map(point).map(|[u, v]| [(u * columns) as u32, (v * rows) as u32]).collect();
        seen.sort_unstable();
        seen.dedup();
        seen.len()
    }

    #[test]
    fn the_points_of_a_node_fill_every_box_once() {
        let sample = Sample { pixel: [17, 3], index: 0 };
        for path in [ROOT_PATH, branch_path(ROOT_PATH, true), branch_path(ROOT_PATH, false)] {
            let sequence = Sequence::of_lights(sample, path);
            // 64 points of the pixel's first samples, or of one later sample of a light of 64.
            for first in [0, 64, 64 * 1000] {
                for shape in [[64.0, 1.0], [16.0, 4.0], [8.0, 8.0], [2.0, 32.0], [1.0, 64.0]] {
                    assert_eq!(boxes(shape, |i| sequence.point(first + i)), 64, "{path} {shape:?}");
                }
            }
        }
        assert!(boxes([8.0, 8.0], |i| [f64::from(i) / 64.0, 0.5]) < 64, "a line fills few");
    }

    #[test]
    fn places_in_the_pixel_do_not_foretell_points_of_lights() {
        let joint = |light: &dyn Fn([u32; 2], u32) -> f64| {
            let mut counts = [[0; 4]; 4];
            for pixel in (0..64).map(|i| [i % 8, i / 8]) {
                for i in 0..64 {
                    let [u, _] = in_pixel(pixel, i, 64);
                    counts[(u * 4.0) as usize][(light(pixel, i) * 4.0) as usize] += 1;
                }
            }
            // 256 in each, ± 16 if the two are independent.
            counts.iter().flatten().map(|n: &i32| (n - 256).abs()).max().unwrap()
        };
        let points =
            |pixel, i| Sequence::of_lights(Sample { pixel, index: 0 }, ROOT_PATH).point(i)[0];
        assert!(joint(&points) < 64, "{}", joint(&points));
        assert!(joint(&|pixel, i| in_pixel(pixel, i, 64)[0]) > 64, "the judge can fail");
    }

    #[test]
    fn branches_have_paths_of_their_own() {
        let mut paths = vec![ROOT_PATH];
        for depth in 0..10 {
            let last = paths[(1 << depth) - 1..].to_vec();
            paths.extend(last.iter().flat_map(|&p| [false, true].map(|side| branch_path(p, side))));
        }
        let count = paths.len();
        paths.sort_unstable();
        paths.dedup();
        assert_eq!(paths.len(), count);
    }
}
