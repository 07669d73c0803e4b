//! Own numeric kernels that give the same bits on every CPU: powers of two, powers of a cosine.
//!
//! Nothing here calls the platform's `pow`, `exp` or `log`, and nothing fuses a multiplication with
//! an addition, so that scalar code and every vector width round alike.

/// Exponents below this give 0: such a power is lost beside anything that can be seen, and the
/// flush keeps subnormal numbers, whose handling differs between CPUs, out of every picture.
pub const EXP2_FLUSH: f32 = -60.0;

/// 2^p for p ≤ 0, and 0 for p < [`EXP2_FLUSH`]; relative error below 2e-7 for p ≥ −1, growing with
/// the rounding of p itself. Branch-free: a loop over it vectorises.
///
/// Minimax polynomial of degree 6 on [−½, ½] (relative error 2e-9) times an exponent by bits.
#[inline(always)]
pub fn exp2_nonpositive(p: f32) -> f32 {
    // Adding and subtracting 1.5·2^23 rounds to the nearest whole number in every rounding mode's
    // default, without `round`, which is a call on CPUs below SSE4.1.
    const ROUND: f32 = 12_582_912.0;
    let clamped = if p > EXP2_FLUSH { p } else { EXP2_FLUSH };
    let shifted = clamped + ROUND;
    let whole = shifted - ROUND;
    let f = clamped - whole;
    let mut q = 1.534_581_2e-4;
    q = q * f + 1.339_993_1e-3;
    q = q * f + 9.618_489e-3;
    q = q * f + 5.550_328_6e-2;
    q = q * f + 2.402_264_6e-1;
    q = q * f + 6.931_472e-1;
    q = q * f + 1.0;
    // The low bits of `shifted` are the whole number: no conversion, whose saturation costs as much
    // as the polynomial.
    const BIAS: u32 = 127;
    let exponent = shifted.to_bits().wrapping_sub(ROUND.to_bits()).wrapping_add(BIAS);
    let scale = f32::from_bits(exponent << 23);
    if p >= EXP2_FLUSH { q * scale } else { 0.0 }
}

/// log2(cos β) from `x = 1 − cos β` in [0, 1): ≤ 0, and accurate for tiny angles too, where the
/// cosine itself would have lost them: relative error 2e-7 for x ≥ 1e-9, absolute below 2e-16
/// elsewhere. Branch-free: a loop over it vectorises.
///
/// In f64: 1 − x = m·2^e with m within √2 of 1, and log m by its series in s = (m − 1)/(m + 1).
#[inline(always)]
pub fn log2_of_cosine(one_minus_cosine: f32) -> f32 {
    const MANTISSA: u64 = (1 << 52) - 1;
    const ONE: u64 = 1023 << 52;
    let bits = (1.0 - f64::from(one_minus_cosine)).to_bits();
    let m = f64::from_bits(bits & MANTISSA | ONE);
    let large = m > std::f64::consts::SQRT_2;
    let exponent = (bits >> 52) as i32 - if large { 1022 } else { 1023 };
    let m = if large { m * 0.5 } else { m };
    let s = (m - 1.0) / (m + 1.0);
    let z = s * s;
    let mut q = 1.0 / 15.0;
    q = q * z + 1.0 / 13.0;
    q = q * z + 1.0 / 11.0;
    q = q * z + 1.0 / 9.0;
    q = q * z + 1.0 / 7.0;
    q = q * z + 1.0 / 5.0;
    q = q * z + 1.0 / 3.0;
    q = q * z + 1.0;
    (f64::from(exponent) + q * s * (2.0 * std::f64::consts::LOG2_E)) as f32
}

/// 2^stops, the factor of an exposure.
pub fn exposure_factor(stops: f32) -> f32 {
    libm::exp2(f64::from(stops)) as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exp2_is_accurate_from_one_to_the_flush() {
        let mut worst = 0.0f64;
        for i in 0..=600_000 {
            let p = -(i as f32) * 1e-4;
            let truth = f64::from(p).exp2();
            worst = worst.max((f64::from(exp2_nonpositive(p)) / truth - 1.0).abs());
        }
        assert!(worst < 2e-7, "worst relative error {worst:e}");
        assert_eq!(exp2_nonpositive(0.0), 1.0);
        assert_eq!(exp2_nonpositive(-60.001), 0.0);
        assert_eq!(exp2_nonpositive(f32::NEG_INFINITY), 0.0);
    }

    #[test]
    fn logarithm_of_a_cosine_is_accurate_to_an_f32() {
        let mut worst = 0.0f64;
        for i in 0..1_000_000 {
            let x = (i as f32 / 1e6).powi(3);
            let truth = f64::ln_1p(-f64::from(x)) / std::f64::consts::LN_2;
            let ours = f64::from(log2_of_cosine(x));
            assert!(ours <= 0.0, "x {x} gives {ours}");
            worst = worst.max((ours - truth).abs() / (truth.abs() + 1e-9));
        }
        assert!(worst < 2e-7, "worst relative error {worst:e}");
        assert_eq!(log2_of_cosine(0.0), 0.0);
    }

    #[test]
    fn power_of_a_cosine_keeps_small_angles() {
        for n in [1.0f64, 50.0, 1e4, 1e6] {
            for x in [0.0f32, 1e-8, 1e-6, 1e-4, 1e-2, 0.3] {
                let truth = (n * f64::ln_1p(-f64::from(x))).exp();
                let ours = f64::from(exp2_nonpositive(n as f32 * log2_of_cosine(x)));
                assert!((ours - truth).abs() < 1e-5 * truth + 1e-17, "n {n} x {x}: {ours} {truth}");
            }
        }
    }
}
