//! The judge of classes: whether a fresh trace has anything that the kept trees lack.

use rayforest::forest::Forest;
use rayforest::forest::kept::KeptTrees;
use rayforest::forest::tree::{BLOCKED, Branch, entries};
use rayforest::scene::Scene;
use rayforest::scene::factor::FactorValues;
use rayforest::session::Session;

use super::{open, set, shipped};

/// Whether `fresh`, a trace of `scene`, needs a ray that `kept`, a trace with the same rays, has not
/// cast: a branch that was not grown, or a way past an opaque solid that is opaque no longer.
///
/// It reads trees alone, and knows nothing of terms, frontiers marked in them, or changes.
pub(super) fn comes_alive(kept: &Forest, fresh: &Forest, scene: &Scene) -> bool {
    let opaque = FactorValues::new(scene).opaque();
    let opaque: Vec<bool> = scene.solids.iter().map(|solid| opaque[solid.material]).collect();
    kept.tiles.iter().zip(&fresh.tiles).any(|(kept, fresh)| {
        let kept = kept.as_ref().expect("kept trees of every tile");
        let fresh = fresh.as_ref().expect("fresh trees of every tile");
        let mut pair = Pair { kept: Cursor::new(kept), fresh: Cursor::new(fresh), opaque: &opaque };
        assert_eq!(kept.hits, fresh.hits, "eye rays do not depend on parameters");
        let hits: u32 = kept.hits.iter().map(|word| word.count_ones()).sum();
        (0..hits).any(|_| pair.node())
    })
}

/// Reads a tile's trees in preorder.
struct Cursor<'a> {
    trees: &'a KeptTrees,
    node: usize,
    light: usize,
    crossing: usize,
}

impl<'a> Cursor<'a> {
    fn new(trees: &'a KeptTrees) -> Cursor<'a> {
        Cursor { trees, node: 0, light: 0, crossing: 0 }
    }

    /// The witness that stopped the next light's shadow ray, if one did.
    fn witness(&mut self) -> Option<u32> {
        let crossed = self.trees.lights[self.light].crossed;
        let blocked = crossed == BLOCKED;
        let count = entries(crossed);
        let first = self.trees.crossings.get(self.crossing).copied();
        self.light += 1;
        self.crossing += count;
        first.filter(|_| blocked)
    }

    /// Leaves out the next node and all below it.
    fn skip(&mut self) {
        let node = self.trees.nodes[self.node];
        self.node += 1;
        for _ in 0..node.lights {
            self.witness();
        }
        for branch in [node.ends.reflected(), node.ends.transmitted()] {
            if branch == Branch::Grown {
                self.skip();
            }
        }
    }
}

struct Pair<'a> {
    kept: Cursor<'a>,
    fresh: Cursor<'a>,
    opaque: &'a [bool],
}

impl Pair<'_> {
    /// Compares the next node of both and all below it, up to the first thing that is lacking.
    fn node(&mut self) -> bool {
        let (kept, fresh) =
            (self.kept.trees.nodes[self.kept.node], self.fresh.trees.nodes[self.fresh.node]);
        assert_eq!((kept.t, kept.primitive), (fresh.t, fresh.primitive), "the same rays");
        self.kept.node += 1;
        self.fresh.node += 1;
        for _ in 0..fresh.lights {
            self.fresh.witness();
        }
        for _ in 0..kept.lights {
            if self.kept.witness().is_some_and(|m| !self.opaque[m as usize]) {
                return true;
            }
        }
        let sides = [
            (kept.ends.reflected(), fresh.ends.reflected()),
            (kept.ends.transmitted(), fresh.ends.transmitted()),
        ];
        sides.into_iter().any(|(kept, fresh)| match (kept, fresh) {
            (Branch::Grown, Branch::Grown) => self.node(),
            (Branch::Grown, _) => {
                self.kept.skip();
                false
            }
            (Branch::Missed, _) => false,
            (_, Branch::Grown | Branch::Missed) => true,
            _ => false,
        })
    }
}

fn judged(before: &Session, path: &str, value: &str) -> bool {
    let mut scene = before.scene().clone();
    set(&mut scene, path, value);
    comes_alive(before.forest(), open(&scene, 1).forest(), &scene)
}

#[test]
fn the_judge_sees_what_comes_alive_and_what_does_not() {
    let before = open(&shipped("whitted", [40, 24], 1), 1);
    for (path, value) in [
        ("materials.tiles.reflect", "0.3"),
        ("materials.mirror.transmit", "0.001"), // lets light through to its shadow
        ("trace.cutoff", "0.0001"),
        ("materials.glass.reflect", "0.9"),
    ] {
        assert!(judged(&before, path, value), "{path} = {value}");
    }
    for (path, value) in [
        ("materials.tiles.reflect", "0.003"),
        ("materials.mirror.reflect", "0"),
        ("materials.glass.transmit", "0"),
        ("trace.cutoff", "0.5"),
        ("trace.depth", "1"),
        ("materials.tiles.diffuse", "0"),
    ] {
        assert!(!judged(&before, path, value), "{path} = {value}");
    }
}
