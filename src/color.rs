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
