//! Where samples lie: numbers that depend on the pixel and the sample's index alone.

/// Position of a sample within its pixel, each coordinate in [0, 1).
///
/// With one sample per pixel the centre. With more, sample `index` of the two-dimensional Sobol
/// sequence, scrambled per pixel by a hashed nested permutation (Owen 1995 in the form of Laine and
/// Karras 2011): any power of two of consecutive samples is stratified along both axes, and the
/// first samples of a pixel are the same whatever their number.
pub fn in_pixel([x, y]: [u32; 2], index: u32, samples: u32) -> [f64; 2] {
    if samples == 1 {
        return [0.5, 0.5];
    }
    let seed = hash(x ^ hash(y));
    let u = scramble(index.reverse_bits(), hash(seed ^ 0x51ed_270b));
    let v = scramble(sobol_second(index), hash(seed ^ 0x2545_f491));
    [unit(u), unit(v)]
}

/// The second dimension of the Sobol sequence as a 32-bit fraction.
fn sobol_second(mut index: u32) -> u32 {
    let mut direction = 1u32 << 31;
    let mut fraction = 0;
    while index != 0 {
        if index & 1 != 0 {
            fraction ^= direction;
        }
        direction ^= direction >> 1;
        index >>= 1;
    }
    fraction
}

/// Nested uniform scrambling of a fraction's bits, from the highest down.
fn scramble(fraction: u32, seed: u32) -> u32 {
    let mut v = fraction.reverse_bits();
    v = v.wrapping_add(seed);
    v ^= v.wrapping_mul(0x6c50_b47c);
    v ^= v.wrapping_mul(0xb82f_1e52);
    v ^= v.wrapping_mul(0xc7af_e638);
    v ^= v.wrapping_mul(0x8d22_f6e6);
    v.reverse_bits()
}

/// A 32-bit mix (Wellons' lowbias32).
fn hash(mut v: u32) -> u32 {
    v ^= v >> 16;
    v = v.wrapping_mul(0x7feb_352d);
    v ^= v >> 15;
    v = v.wrapping_mul(0x846c_a68b);
    v ^ v >> 16
}

fn unit(fraction: u32) -> f64 {
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
}
