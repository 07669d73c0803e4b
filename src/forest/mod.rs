//! Ray trees: how they are grown, and how they are kept.

pub mod camera;
pub mod grow;
pub mod lobe;
pub mod sampling;
pub mod tree;

use crate::film::layout::Layout;
use tree::TileTrees;

/// The kept trees of a picture, tile by tile.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Forest {
    /// The cut of the picture.
    pub layout: Layout,
    /// Samples per pixel.
    pub samples: u32,
    /// Per tile its trees, or `None` where they were released for memory.
    pub tiles: Vec<Option<TileTrees>>,
}

impl Forest {
    /// Allocated bytes of all trees.
    pub fn bytes(&self) -> usize {
        self.tiles.iter().flatten().map(TileTrees::bytes).sum()
    }

    /// Nodes of the kept trees.
    pub fn nodes(&self) -> usize {
        self.tiles.iter().flatten().map(|t| t.nodes.len()).sum()
    }

    /// Tiles whose trees were released.
    pub fn released(&self) -> usize {
        self.tiles.iter().filter(|t| t.is_none()).count()
    }

    /// Checks the invariants of every tile. Panics with what is wrong.
    pub fn validate(&self, materials: usize, lights: usize) {
        for trees in self.tiles.iter().flatten() {
            trees.validate(materials, lights);
        }
    }
}
