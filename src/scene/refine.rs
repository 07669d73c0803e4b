//! By what adaptive sampling tells which pixels need all samples.

use super::slot::Choice;

/// What of a pixel's first samples, and of its neighbours', is compared (`refine`).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Refine {
    /// What their trees met, and cosines: an edit of colours changes no pixel's number of samples.
    #[default]
    Trees,
    /// Square roots of their colours, before exposure: decided again after every edit.
    Contrast,
}

impl Refine {
    /// All of them, in the order of their names.
    pub const ALL: [Refine; 2] = [Refine::Trees, Refine::Contrast];
    /// As written in a scene file.
    pub const NAMES: &'static [&'static str] = &["trees", "contrast"];
}

impl Choice for Refine {
    fn names(&self) -> &'static [&'static str] {
        Refine::NAMES
    }

    fn chosen(&self) -> usize {
        *self as usize
    }

    fn choose(&mut self, index: usize) {
        *self = Refine::ALL[index];
    }
}
