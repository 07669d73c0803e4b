//! Blurred rays: a direction drawn from a lobe around a sharp one.

use std::f64::consts::TAU;

use glam::DVec3;

/// A direction of the lobe (n+1)/2π · cosⁿα around the unit vector `axis`, drawn by importance, so
/// that every direction weighs 1: its length is 1. `exponent` n > 0; `u` and `v` in [0, 1).
///
/// 1 − cos α = −expm1(log(u)/(n+1)), which keeps the small angles of large exponents. Phong's lobe:
/// Lafortune & Willems, "Using the modified Phong reflectance model" (1994).
#[inline(always)]
pub(super) fn drawn(axis: DVec3, exponent: f32, [u, v]: [f64; 2]) -> DVec3 {
    let fall = -libm::expm1(libm::log(u) / (f64::from(exponent) + 1.0));
    let (cosine, sine) = (1.0 - fall, (fall * (2.0 - fall)).sqrt());
    let (sin, cos) = libm::sincos(TAU * v);
    let (a, b) = axis.any_orthonormal_pair();
    (axis * cosine + a * (sine * cos) + b * (sine * sin)).normalize()
}

/// The same, or `None` if it is not on the side of `up`. Out of line: few surfaces blur.
#[inline(never)]
pub(super) fn drawn_above(
    axis: DVec3,
    (exponent, up): (f32, DVec3),
    numbers: [f64; 2],
) -> Option<DVec3> {
    Some(drawn(axis, exponent, numbers)).filter(|direction| direction.dot(up) > 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::forest::sampling::{Effect, Sample};

    #[test]
    fn directions_are_of_length_one_and_never_behind() {
        let axis = DVec3::new(0.3, -0.4, 0.2).normalize();
        for exponent in [1e-3, 1.0, 100.0, 1e6] {
            for u in [0.0, 1e-300, 0.3, 0.999_999] {
                for v in [0.0, 0.7] {
                    let drawn = drawn(axis, exponent, [u, v]);
                    assert!((drawn.length() - 1.0).abs() < 1e-14 && drawn.dot(axis) > -1e-15);
                }
            }
        }
    }

    /// The mean over the lobe of cosᵏ is (n+1)/(n+k+1); across it, the lobe is round.
    #[test]
    fn moments_are_those_of_the_lobe() {
        let axis = DVec3::new(-0.1, 0.9, 0.4).normalize();
        let across = axis.any_orthonormal_vector();
        for n in [1.0f32, 10.0, 100.0] {
            let count = 4096;
            let (mut first, mut second, mut sum) = (0.0, 0.0, DVec3::ZERO);
            for index in 0..count {
                let sample = Sample { pixel: [3, 4], index };
                let drawn = drawn(axis, n, sample.numbers(Effect::Gloss, 5));
                first += drawn.dot(axis);
                second += drawn.dot(across) * drawn.dot(across);
                sum += drawn;
            }
            let n = f64::from(n);
            let [first, second] = [first, second].map(|sum| sum / f64::from(count));
            assert!((first - (n + 1.0) / (n + 2.0)).abs() < 1e-3, "{n}: {first}");
            let expected = (1.0 - (n + 1.0) / (n + 3.0)) / 2.0;
            assert!((second - expected).abs() < 2e-3, "{n}: {second} {expected}");
            assert!((sum.normalize() - axis).length() < 5e-3, "{n}: around its axis");
        }
    }

    #[test]
    fn a_large_exponent_is_as_good_as_sharp() {
        let off = (drawn(DVec3::X, 1e6, [0.5, 0.3]) - DVec3::X).length();
        // α = √(2·ln 2/(n+1))
        assert!((off / (2.0 * 2f64.ln() / 1e6).sqrt() - 1.0).abs() < 1e-4, "{off}");
    }
}
