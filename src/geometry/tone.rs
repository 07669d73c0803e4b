//! What colours a point: how much of which slots, or the texel that multiplies them.

use crate::color::Rgb;

/// The colour of a point of a surface or of a direction of the sky, apart from its parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Tone {
    /// Two neighbouring slots of a palette, whose shares make 1.
    Blend {
        /// The first.
        slot: u8,
        /// The share of the next one, 0 … 1.
        share: f32,
    },
    /// A texel of an image: linear light, ≥ 0.
    Texel(Rgb),
}
