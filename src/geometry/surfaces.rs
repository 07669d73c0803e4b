//! What the compiled scene knows of materials: which solid has which, and where its colours fall.

use crate::scene::{Paint, Scene};

/// The part of a compiled scene that changes without its hierarchy.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Surfaces {
    /// Per solid an index into `Scene::materials`.
    pub(super) materials: Vec<u16>,
    /// Per material the side of its checker cubes; `None` for a plain one.
    pub(super) checker_sizes: Vec<Option<f64>>,
}

impl Surfaces {
    /// Those of a scene.
    pub(super) fn of(scene: &Scene) -> Surfaces {
        let index = |material| u16::try_from(material).expect("fewer than 65536 materials");
        Surfaces {
            materials: scene.solids.iter().map(|solid| index(solid.material)).collect(),
            checker_sizes: scene
                .materials
                .iter()
                .map(|material| match material.paint {
                    Paint::Solid(_) => None,
                    Paint::Checker { a: _, b: _, size } => Some(size),
                })
                .collect(),
        }
    }
}
