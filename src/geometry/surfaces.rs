//! What the compiled scene knows of materials: which solid has which, where its colours fall, and how
//! even it is.

use super::bump::Relief;
use super::pattern::Pattern;
use super::sky::Sky;
use crate::scene::{Background, Material, Paint, Scene};

/// The part of a compiled scene that changes without its hierarchy.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Surfaces {
    /// Per solid an index into `Scene::materials`.
    pub(super) materials: Vec<u16>,
    /// Per material the side of its checker cubes; `None` for any other paint.
    pub(super) checker_sizes: Vec<Option<f64>>,
    /// Per material; empty if all of them show whole slots and are even.
    looks: Vec<Look>,
    pub(super) sky: Sky,
}

/// What varies over the surfaces of a material.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Look {
    pub(super) pattern: Pattern,
    pub(super) relief: Relief,
}

impl Surfaces {
    /// Those of a scene.
    pub(super) fn of(scene: &Scene) -> Surfaces {
        let index = |material| u16::try_from(material).expect("fewer than 65536 materials");
        let checker = |material: &Material| match material.paint {
            Paint::Checker { a: _, b: _, size } => Some(size),
            _ => None,
        };
        let look = |material: &Material| Look {
            pattern: Pattern::of(&material.paint),
            relief: Relief::of(&material.bump),
        };
        let mut looks: Vec<Look> = scene.materials.iter().map(look).collect();
        let even = |look: &Look| look.pattern == Pattern::Slots && look.relief == Relief::Flat;
        if looks.iter().all(even) && matches!(scene.background, Background::Color(_)) {
            looks.clear();
        }
        Surfaces {
            materials: scene.solids.iter().map(|solid| index(solid.material)).collect(),
            checker_sizes: scene.materials.iter().map(checker).collect(),
            looks,
            sky: Sky::of(&scene.background),
        }
    }

    /// Whether nothing varies but checkers.
    #[inline(always)]
    pub(super) fn is_plain(&self) -> bool {
        self.looks.is_empty()
    }

    /// What varies over a material's surfaces; not to be asked where nothing does.
    pub(super) fn look(&self, material: u16) -> &Look {
        &self.looks[usize::from(material)]
    }
}
