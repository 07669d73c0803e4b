//! Linear light as three numbers, and the sRGB curve that pictures are stored with.

use std::ops::{Add, Mul};

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

#[cfg(test)]
mod tests {
    use super::*;

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
        }
        assert_eq!([srgb_byte(f32::NAN), srgb_byte(-1.0), srgb_byte(f32::INFINITY)], [0, 0, 255]);
    }
}
