//! Reconstruction filters: how a pixel weighs the light around its centre.

use super::slot::Choice;

/// A separable filter f(x)·f(y), x and y in pixels from the pixel's centre (`filter`).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Filter {
    /// The pixel's own square, evenly.
    #[default]
    Box,
    /// `1 − |x|` within one pixel.
    Tent,
    /// Mitchell and Netravali's cubic with B = C = ⅓ (SIGGRAPH 1988), which is below 0 from 8/7 to 2
    /// pixels: it sharpens, and may overshoot.
    Mitchell,
    /// A Gaussian of deviation ½, within 1½ pixels.
    Gaussian,
}

impl Filter {
    /// All of them, in the order of their names.
    pub const ALL: [Filter; 4] = [Filter::Box, Filter::Tent, Filter::Mitchell, Filter::Gaussian];
    /// As written in a scene file.
    pub const NAMES: &'static [&'static str] = &["box", "tent", "mitchell", "gaussian"];
}

impl Choice for Filter {
    fn names(&self) -> &'static [&'static str] {
        Filter::NAMES
    }

    fn chosen(&self) -> usize {
        *self as usize
    }

    fn choose(&mut self, index: usize) {
        *self = Filter::ALL[index];
    }
}
