//! Own noise: smooth random functions of space that give the same bits on every CPU.
//!
//! Only additions, multiplications and integer mixing: nothing of the platform, no table, no period
//! but that of 32-bit cells.

use glam::DVec3;

/// Octaves of [`fractal`].
const OCTAVES: u32 = 6;
/// Moves each octave against the one before, so that their zeros do not meet.
const SHIFT: DVec3 = DVec3::new(0.317, 0.731, 0.543);

/// Gradient noise: 0 in every corner of the lattice of whole numbers, within ±1.04, with continuous
/// first and second derivatives, and of mean 0. 0 for what is no finite point.
///
/// Ken Perlin, "Improving Noise" (2002), with hashed instead of tabulated gradients.
pub(super) fn noise(p: DVec3) -> f64 {
    if !p.is_finite() {
        return 0.0;
    }
    let floor = p.floor();
    let f = p - floor;
    // Beyond 2^53 a number has no fraction; the cell is then any, but the same everywhere.
    let [x, y, z] = floor.to_array().map(|c| c as i64 as u32);
    let fade = |t: f64| t * t * t * (t * (t * 6.0 - 15.0) + 10.0);
    let (u, v, w) = (fade(f.x), fade(f.y), fade(f.z));
    let plane = |dz: u32| {
        let at_z = hash(z.wrapping_add(dz));
        let line = |dy: u32| {
            let at_y = hash(y.wrapping_add(dy) ^ at_z);
            let corner = |dx: u32| {
                let gradient = hash(x.wrapping_add(dx) ^ at_y);
                slope(gradient, f - DVec3::new(dx.into(), dy.into(), dz.into()))
            };
            lerp(corner(0), corner(1), u)
        };
        lerp(line(0), line(1), v)
    };
    lerp(plane(0), plane(1), w)
}

/// Noise of ever finer and weaker octaves, each half as long as the one before and `gain` times as
/// high; within ±1.04 / (1 − gain).
///
/// An octave whose cells are smaller than what is looked at together, `footprint` wide, fades out:
/// its mean is 0.
pub(super) fn fractal(p: DVec3, gain: f64, footprint: f64) -> f64 {
    let (mut sum, mut height, mut frequency) = (0.0, 1.0, 1.0);
    for octave in 0..OCTAVES {
        let seen = seen(footprint * frequency);
        if seen == 0.0 {
            break;
        }
        sum += noise(p * frequency + SHIFT * f64::from(octave)) * (height * seen);
        height *= gain;
        frequency *= 2.0;
    }
    sum
}

/// How much is seen of a pattern of which so many periods are looked at together: all of it up to a
/// half, nothing from one on.
pub(super) fn seen(periods: f64) -> f64 {
    let share = 2.0 - 2.0 * periods;
    if share > 0.0 { share.min(1.0) } else { 0.0 }
}

fn lerp(a: f64, b: f64, t: f64) -> f64 {
    a + (b - a) * t
}

/// The scalar product with one of the twelve directions to a cube's edges, four of them twice.
fn slope(hash: u32, DVec3 { x, y, z }: DVec3) -> f64 {
    let h = hash >> 28;
    let a = if h < 8 { x } else { y };
    let b = match h {
        0..4 => y,
        12 | 14 => x,
        _ => z,
    };
    (if h & 1 == 0 { a } else { -a }) + (if h & 2 == 0 { b } else { -b })
}

/// A 32-bit mix (Wellons' lowbias32), begun beside its fixed point 0.
fn hash(v: u32) -> u32 {
    let mut v = v ^ 0x9e37_79b9;
    v ^= v >> 16;
    v = v.wrapping_mul(0x7feb_352d);
    v ^= v >> 15;
    v = v.wrapping_mul(0x846c_a68b);
    v ^ v >> 16
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Points all over a cube of side 200 around the origin.
    fn points() -> impl Iterator<Item = DVec3> {
        (0..60_000u32).map(|i| {
            let axis = |k: u32| f64::from(hash(i * 3 + k)) / 4_294_967_296.0 * 200.0 - 100.0;
            DVec3::new(axis(0), axis(1), axis(2))
        })
    }

    #[test]
    fn it_is_bounded_centred_and_uses_its_range() {
        let values: Vec<f64> = points().map(noise).collect();
        let largest = values.iter().fold(0.0f64, |m, v| m.max(v.abs()));
        assert!(largest < 1.04 && largest > 0.75, "{largest}");
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        assert!(mean.abs() < 0.005, "{mean}");
        for gain in [0.4, 0.5] {
            let worst = points().map(|p| fractal(p, gain, 0.0).abs()).fold(0.0, f64::max);
            assert!(worst < 1.04 / (1.0 - gain), "{worst}");
        }
    }

    #[test]
    fn it_is_zero_in_the_corners_and_smooth_across_cells() {
        for p in points().take(500) {
            assert_eq!(noise(p.floor()), 0.0);
            // Across a wall of two cells: value and slope agree from both sides.
            let wall = DVec3::new(p.x.floor(), p.y, p.z);
            let step = DVec3::X * 1e-6;
            let (before, at, after) = (noise(wall - step), noise(wall), noise(wall + step));
            assert!((after - before).abs() < 4e-6, "{before} {after}");
            assert!((before + after - 2.0 * at).abs() < 1e-10, "a kink at {wall}");
        }
    }

    #[test]
    fn cells_do_not_repeat_and_look_unlike() {
        // A table of 256 entries would repeat here.
        for period in [DVec3::X * 256.0, DVec3::Y * 256.0, DVec3::Z * 256.0, DVec3::ONE] {
            let product: f64 = points().map(|p| noise(p) * noise(p + period)).sum();
            let square: f64 = points().map(|p| noise(p) * noise(p)).sum();
            assert!((product / square).abs() < 0.03, "{period}: {}", product / square);
        }
    }

    #[test]
    fn the_bits_are_these_on_every_machine() {
        let at = DVec3::new(0.3, 1.7, -2.4);
        let bits = [noise(at).to_bits(), fractal(at, 0.5, 0.01).to_bits()];
        assert_eq!(bits, BITS);
        assert_ne!(noise(at.with_x(0.3 + 1e-12)).to_bits(), bits[0]);
    }

    const BITS: [u64; 2] = [13_812_356_667_024_023_992, 13_821_870_210_461_390_257];

    #[test]
    fn fine_octaves_fade_where_much_is_looked_at() {
        let at = DVec3::new(0.3, 1.7, -2.4);
        assert_eq!(fractal(at, 0.5, 1.0), 0.0);
        assert_eq!(fractal(at, 0.5, 0.5), noise(at));
        assert_eq!(fractal(at, 0.5, 0.0), fractal(at, 0.5, 1.0 / 64.0));
        assert_eq!([seen(0.0), seen(0.75), seen(2.0), seen(f64::NAN)], [1.0, 0.5, 0.0, 0.0]);
    }

    #[test]
    fn odd_points_give_numbers() {
        for x in [f64::NAN, f64::INFINITY, -1e300, 1e300, 1e12, -0.0, 4.5e15] {
            let value = noise(DVec3::new(x, 0.25, x));
            assert!(value.abs() < 1.04, "{x}: {value}");
        }
    }
}
