//! Tone curves: how light that may be brighter than white is brought into what a screen shows.

use super::slot::Choice;

/// What happens to light between exposure and the sRGB curve (`tone`).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Tone {
    /// Nothing: channels are cut off at 1.
    #[default]
    None,
    /// Khronos PBR Neutral: colours as they are up to 0.8, brighter ones compressed.
    Neutral,
}

impl Tone {
    /// All of them, in the order of their names.
    pub const ALL: [Tone; 2] = [Tone::None, Tone::Neutral];
    /// As written in a scene file.
    pub const NAMES: &'static [&'static str] = &["none", "neutral"];
}

impl Choice for Tone {
    fn names(&self) -> &'static [&'static str] {
        Tone::NAMES
    }

    fn chosen(&self) -> usize {
        *self as usize
    }

    fn choose(&mut self, index: usize) {
        *self = Tone::ALL[index];
    }
}
