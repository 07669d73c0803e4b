//! Ray trees: how they are grown, and how they are kept.

pub mod again;
pub mod camera;
pub mod counts;
mod eye;
pub mod filter;
pub mod grow;
pub mod kept;
pub mod lobe;
mod media;
mod rays;
pub mod sampling;
pub mod scope;
pub mod signature;
pub mod sink;
mod surface;
pub mod thin;
pub mod tree;

use std::sync::Arc;

use crate::film::layout::Layout;
use kept::KeptTrees;

/// The kept trees of a picture, tile by tile. Clones share them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Forest {
    /// The cut of the picture.
    pub layout: Layout,
    /// Samples per pixel.
    pub samples: u32,
    /// Per tile its trees, or `None` where they were released for memory.
    pub tiles: Vec<Option<Arc<KeptTrees>>>,
}

impl Forest {
    /// Allocated bytes of all trees.
    pub fn bytes(&self) -> usize {
        self.tiles.iter().flatten().map(|trees| trees.bytes()).sum()
    }

    /// Nodes of the kept trees.
    pub fn nodes(&self) -> usize {
        self.tiles.iter().flatten().map(|trees| trees.nodes.len()).sum()
    }

    /// Tiles whose trees were released.
    pub fn released(&self) -> usize {
        self.tiles.iter().filter(|t| t.is_none()).count()
    }
}
