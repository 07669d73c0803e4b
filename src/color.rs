//! Linear light as three numbers, the sRGB curve that pictures are stored with, and colour temperature.

pub mod notation;

use std::ops::{Add, Mul, RangeInclusive};

/// An amount of red, green and blue: scene-linear, Rec. 709 primaries, 1 = white of the picture.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Rgb(pub [f32; 3]);

impl Rgb {
    /// No light.
    pub const BLACK: Rgb = Rgb([0.0; 3]);
    /// One in every channel: the neutral factor.
    pub const WHITE: Rgb = Rgb([1.0; 3]);

    /// The same value in every channel.
    pub const fn grey(value: f32) -> Rgb {
        Rgb([value; 3])
    }

    /// Applies `f` to every channel.
    #[inline(always)]
    pub fn map(self, f: impl Fn(f32) -> f32) -> Rgb {
        Rgb([f(self.0[0]), f(self.0[1]), f(self.0[2])])
    }

    /// The largest channel.
    #[inline(always)]
    pub fn max_channel(self) -> f32 {
        self.0[0].max(self.0[1]).max(self.0[2])
    }

    /// Whether every channel is zero (of either sign).
    #[inline(always)]
    pub fn is_black(self) -> bool {
        self.0 == [0.0; 3]
    }
}

impl Add for Rgb {
    type Output = Rgb;
    #[inline(always)]
    fn add(self, o: Rgb) -> Rgb {
        Rgb([self.0[0] + o.0[0], self.0[1] + o.0[1], self.0[2] + o.0[2]])
    }
}

impl Mul for Rgb {
    type Output = Rgb;
    #[inline(always)]
    fn mul(self, o: Rgb) -> Rgb {
        Rgb([self.0[0] * o.0[0], self.0[1] * o.0[1], self.0[2] * o.0[2]])
    }
}

impl Mul<f32> for Rgb {
    type Output = Rgb;
    #[inline(always)]
    fn mul(self, k: f32) -> Rgb {
        self.map(|c| c * k)
    }
}

/// The sRGB curve of IEC 61966-2-1, 0 … 255 as a fraction of a code value; input clamped to 0 … 1.
///
/// Above the toe a polynomial of degree 5 in x^(1/4), within 0.005 code values of the exact curve.
/// Square roots round alike everywhere, so every CPU gives the same bytes. NaN gives 0.
#[inline(always)]
pub fn srgb_code(linear: f32) -> f32 {
    let x = if linear > 0.0 { linear } else { 0.0 };
    let x = if x < 1.0 { x } else { 1.0 };
    let y = x.sqrt().sqrt();
    let mut q = -0.068_147_32;
    q = q * y + 0.289_533_02;
    q = q * y - 0.577_482_7;
    q = q * y + 1.255_404_4;
    q = q * y + 0.162_026_27;
    q = q * y - 0.061_340_217;
    let curve = if x <= 0.003_130_8 { x * 12.92 } else { q };
    let curve = if curve < 1.0 { curve } else { 1.0 };
    curve * 255.0
}

/// [`srgb_code`] rounded to the nearest byte.
#[inline(always)]
pub fn srgb_byte(linear: f32) -> u8 {
    // Adding 2^23 rounds to a whole number and leaves it in the low bits.
    ((srgb_code(linear) + 8_388_608.0).to_bits() & 255) as u8
}

/// Linear light of an sRGB code in 0 … 1 (IEC 61966-2-1), the same bits on every CPU.
pub fn linear_of_srgb(code: f64) -> f32 {
    let linear =
        if code <= 0.040_45 { code / 12.92 } else { libm::pow((code + 0.055) / 1.055, 2.4) };
    linear as f32
}

/// The sRGB code, 0 … 1, of linear light (IEC 61966-2-1), exactly; what lies outside of 0 … 1 is cut,
/// and NaN gives 0. Undoes [`linear_of_srgb`] to the rounding of its `f32`.
pub fn srgb_of_linear(linear: f64) -> f64 {
    let x = if linear.is_nan() { 0.0 } else { linear.clamp(0.0, 1.0) };
    if x <= 0.003_130_8 { x * 12.92 } else { 1.055 * libm::pow(x, 1.0 / 2.4) - 0.055 }
}

/// Temperatures that [`blackbody`] knows, in kelvin.
pub const KELVINS: RangeInclusive<f64> = 1000.0..=15_000.0;
/// A colour that is farther than this from every glowing body, in CIE 1960 uv, has no temperature:
/// three times the distance from the locus to daylight, which is a little greener.
const OFF_LOCUS: f64 = 0.01;

/// XYZ to linear Rec. 709 with white D65 (IEC 61966-2-1).
const RGB_FROM_XYZ: [[f64; 3]; 3] = [
    [3.240_969_9, -1.537_383_2, -0.498_610_8],
    [-0.969_243_6, 1.875_967_5, 0.041_555_1],
    [0.055_630_1, -0.203_977_0, 1.056_971_5],
];
/// Its inverse.
const XYZ_FROM_RGB: [[f64; 3]; 3] = [
    [0.412_390_8, 0.357_584_3, 0.180_480_8],
    [0.212_639_0, 0.715_168_7, 0.072_192_3],
    [0.019_330_8, 0.119_194_8, 0.950_532_2],
];

fn transformed(matrix: &[[f64; 3]; 3], [a, b, c]: [f64; 3]) -> [f64; 3] {
    matrix.map(|[x, y, z]| x * a + y * b + z * c)
}

/// The colour in which a body of this temperature glows, its largest channel 1.
///
/// `kelvin` is clamped to [`KELVINS`]; NaN counts as the lowest. Below about 1900 K no mixture of the
/// three primaries is as red: blue is 0 then, instead of negative. What is not cut so is within
/// 2e-4 in CIE 1960 uv of the Planckian locus.
///
/// M. Krystek, "An algorithm to calculate correlated colour temperature", Color Research &
/// Application 10 (1985) 38-40.
pub fn blackbody(kelvin: f64) -> Rgb {
    Rgb(glow(kelvin).map(|channel| channel as f32))
}

fn glow(kelvin: f64) -> [f64; 3] {
    let [u, v] = planckian(kelvin.max(*KELVINS.start()).min(*KELVINS.end()));
    // CIE 1960 uv to XYZ with Y = 1
    let (x, y) = (3.0 * u, 2.0 * v);
    let z = 2.0 * u - 8.0 * v + 4.0 - x - y;
    let rgb = transformed(&RGB_FROM_XYZ, [x / y, 1.0, z / y]).map(|channel| channel.max(0.0));
    let most = rgb.into_iter().fold(0.0, f64::max);
    rgb.map(|channel| channel / most)
}

/// Krystek's u and v of the Planckian locus: |Δu| < 8e-5, |Δv| < 9e-5 for 1000 < T < 15000.
fn planckian(t: f64) -> [f64; 2] {
    let u = (0.860_117_757 + 1.541_182_54e-4 * t + 1.286_412_12e-7 * t * t)
        / (1.0 + 8.424_202_35e-4 * t + 7.081_451_63e-7 * t * t);
    let v = (0.317_398_726 + 4.228_062_45e-5 * t + 4.204_816_91e-8 * t * t)
        / (1.0 - 2.897_418_16e-5 * t + 1.614_560_53e-7 * t * t);
    [u, v]
}

/// CIE 1960 u and v of linear light that is not black.
fn uv(rgb: [f64; 3]) -> [f64; 2] {
    let [x, y, z] = transformed(&XYZ_FROM_RGB, rgb);
    let sum = x + 15.0 * y + 3.0 * z;
    [4.0 * x / sum, 6.0 * y / sum]
}

/// The temperature, in kelvin, of the glowing body whose [`blackbody`] colour is nearest in CIE 1960
/// uv, brightness aside; `None` for black, and for what is not near to any in [`KELVINS`].
///
/// Undoes [`blackbody`] within 1 K. Equal steps of the reciprocal are sought, which are about
/// equal steps to the eye.
pub fn temperature(color: Rgb) -> Option<f64> {
    if color.0.iter().any(|c| !c.is_finite() || *c < 0.0) || color.is_black() {
        return None;
    }
    let [u, v] = uv(color.0.map(f64::from));
    let away = |mired: f64| {
        let [a, b] = uv(glow(1e6 / mired));
        (a - u) * (a - u) + (b - v) * (b - v)
    };
    let (low, high) = (1e6 / KELVINS.end(), 1e6 / KELVINS.start());
    let step = (high - low) / 64.0;
    let coarse = (0..=64).map(|i| low + step * f64::from(i));
    let near = coarse.min_by(|a, b| away(*a).total_cmp(&away(*b)))?;
    let (mut left, mut right) = ((near - step).max(low), (near + step).min(high));
    for _ in 0..60 {
        let third = (right - left) / 3.0;
        if away(left + third) < away(right - third) {
            right -= third;
        } else {
            left += third;
        }
    }
    let mired = (left + right) / 2.0;
    (away(mired) <= OFF_LOCUS * OFF_LOCUS).then(|| 1e6 / mired)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Reciprocal megakelvin, u, v: Wyszecki & Stiles, Color Science (1982), table 1(3.11), after
    /// Robertson (1968), for c2 = 1.4388e-2 m K.
    const LOCUS: [[f64; 3]; 10] = [
        [70.0, 0.18611, 0.28342],
        [100.0, 0.19032, 0.29326],
        [150.0, 0.19962, 0.30921],
        [200.0, 0.21142, 0.32312],
        [250.0, 0.22511, 0.33439],
        [300.0, 0.24010, 0.34308],
        [350.0, 0.25591, 0.34951],
        [400.0, 0.27218, 0.35407],
        [500.0, 0.30505, 0.35907],
        [600.0, 0.33724, 0.36051],
    ];

    #[test]
    fn a_glowing_body_has_the_published_chromaticity() {
        for [mired, u, v] in LOCUS {
            let [a, b] = planckian(1e6 / mired);
            let away = (a - u).hypot(b - v);
            assert!(away < 2e-4, "{mired}: {a} {b}");
            let neighbour = planckian(1e6 / (mired + 5.0));
            assert!((neighbour[0] - u).hypot(neighbour[1] - v) > 2e-4, "5 mired are told apart");
            // in the gamut also after the way through the three channels
            if mired < 500.0 {
                let [a, b] = uv(blackbody(1e6 / mired).0.map(f64::from));
                assert!((a - u).hypot(b - v) < 2e-4, "{mired}: {a} {b}");
            }
        }
    }

    #[test]
    fn illuminants_have_their_correlated_temperatures() {
        // CIE 15: A is a body of 2856 K at x 0.44757, y 0.40745; D65, the white of Rec. 709, 6504 K.
        let [x, y] = [0.44757, 0.40745];
        let a = transformed(&RGB_FROM_XYZ, [x / y, 1.0, (1.0 - x - y) / y]);
        let a = temperature(Rgb(a.map(|channel| channel as f32))).expect("a glowing body");
        assert!((a - 2856.0).abs() < 10.0, "{a}");
        let white = temperature(Rgb::WHITE).expect("daylight is near the locus");
        assert!((white - 6504.0).abs() < 20.0, "{white}");
        assert_eq!(temperature(Rgb::grey(0.02)), temperature(Rgb::grey(0.5)), "brightness aside");
    }

    #[test]
    fn a_temperature_is_found_again_in_its_colour() {
        for kelvin in (1000..=15_000).step_by(250) {
            let color = blackbody(f64::from(kelvin));
            assert_eq!(color.max_channel(), 1.0);
            let found = temperature(color).expect("a glowing body");
            assert!((found - f64::from(kelvin)).abs() < 1.0, "{kelvin}: {found}");
        }
        assert_eq!(blackbody(1.0), blackbody(1000.0));
        assert_eq!(blackbody(f64::NAN), blackbody(1000.0));
    }

    #[test]
    fn what_glows_in_no_temperature_has_none() {
        let colors = [[0.0, 1.0, 0.0], [1.0, 0.0, 1.0], [0.0, 0.0, 1.0], [0.6, 1.0, 0.6], [0.0; 3]];
        for color in colors {
            assert_eq!(temperature(Rgb(color)), None, "{color:?}");
        }
        assert_eq!(temperature(Rgb([f32::NAN, 1.0, 1.0])), None);
    }

    #[test]
    fn the_two_matrices_undo_each_other() {
        for color in [[1.0, 0.0, 0.0], [0.2, 0.7, 0.4]] {
            let back = transformed(&RGB_FROM_XYZ, transformed(&XYZ_FROM_RGB, color));
            assert!((0..3).all(|i| (back[i] - color[i]).abs() < 1e-6), "{back:?}");
        }
    }

    fn exact(x: f64) -> f64 {
        255.0 * if x <= 0.0031308 { 12.92 * x } else { 1.055 * x.powf(1.0 / 2.4) - 0.055 }
    }

    #[test]
    fn srgb_is_within_a_two_hundredth_of_a_code_value() {
        let mut worst = 0.0f64;
        for i in 0..=1_000_000 {
            let x = i as f32 / 1e6;
            worst = worst.max((f64::from(srgb_code(x)) - exact(f64::from(x))).abs());
        }
        assert!(worst < 0.005, "worst error {worst} code values");
    }

    #[test]
    fn every_byte_decodes_and_encodes_to_itself() {
        for byte in 0..=255u8 {
            let v = f64::from(byte) / 255.0;
            let linear = if v <= 0.04045 { v / 12.92 } else { ((v + 0.055) / 1.055).powf(2.4) };
            assert_eq!(srgb_byte(linear as f32), byte);
            assert!((f64::from(linear_of_srgb(v)) - linear).abs() < 1e-7);
        }
        assert_eq!([srgb_byte(f32::NAN), srgb_byte(-1.0), srgb_byte(f32::INFINITY)], [0, 0, 255]);
    }
}
