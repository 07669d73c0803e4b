//! Ray trees: how they are grown, and how they are kept.

pub mod again;
mod blur;
pub mod camera;
mod cone;
pub mod counts;
mod eye;
pub mod filter;
pub mod grow;
pub mod kept;
mod lamp;
pub mod lobe;
pub mod located;
mod media;
mod pending;
mod rays;
pub mod sampling;
pub mod scope;
mod search;
mod sequence;
mod shadow;
pub mod signature;
pub mod sink;
mod surface;
pub mod thin;
mod tones;
pub mod tree;

use std::sync::Arc;

use crate::film::layout::Layout;
use crate::geometry::Geometry;
use crate::scene::Scene;
use crate::scene::model::Lobes;
use kept::KeptTrees;

/// What turns rays at every solid's surface: kept trees answer for rays that were turned alike.
#[derive(Clone, Debug, PartialEq)]
pub struct Before {
    /// Per solid the index of refraction.
    pub iors: Vec<f64>,
    /// Per solid the lobes that blur mirror and refracted rays.
    pub lobes: Vec<Lobes>,
}

impl Before {
    /// That of a scene.
    pub fn of(scene: &Scene, geometry: &Geometry) -> Before {
        let materials = || scene.materials.iter();
        let iors: Vec<f64> = materials().map(|m| m.ior).collect();
        let lobes: Vec<Lobes> = materials().map(|m| m.lobes()).collect();
        Before { iors: geometry.of_solids(&iors), lobes: geometry.of_solids(&lobes) }
    }
}

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
    /// That of a scene, without a place for any tile.
    pub fn of(scene: &Scene) -> Forest {
        let layout = Layout::new(scene.picture.size);
        Forest { layout, samples: scene.trace.samples, tiles: Vec::new() }
    }

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
