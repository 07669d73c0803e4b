//! Which pixels a plan names: all whose trees, or numbers of samples, become others, and no more.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;

use rayforest::film::layout::{LANES, Place, TILE_BLOCKS};
use rayforest::forest::counts::SampleMap;
use rayforest::forest::kept::{KeptStart, KeptTrees};
use rayforest::forest::tree::{Branch, Reader};
use rayforest::progress::Progress;
use rayforest::scene::Scene;
use rayforest::scene::change::Change;
use rayforest::scene::factor::Kind;
use rayforest::session::plan::Plan;
use rayforest::session::{Class, Session, Work};

use super::regrows::small;
use super::{open, set};

/// What is planned for an edit.
pub(super) fn plan(session: &mut Session, scene: &Scene) -> Option<Plan> {
    // An edit that shading is enough for would be made.
    match session.class_of(scene) {
        Class::Refold | Class::Regrow => {}
        _ => return None,
    }
    if Change::between(session.scene(), scene).moves_rays.is_none()
        && session.class_of(scene) == Class::Refold
    {
        return None;
    }
    match session.edit_without_rays(&Arc::new(scene.clone())) {
        Err(Work::Regrow(plan)) => Some(plan),
        other => panic!("{other:?} is not a plan"),
    }
}

/// The part of a tile's trees that belongs to one block, without where it lies in the tile.
fn block_of(trees: &KeptTrees, block: usize) -> impl PartialEq + use<> {
    let [from, to]: [KeptStart; 2] = [trees.blocks[block], trees.blocks[block + 1]];
    let range = |a: u32, b: u32| a as usize..b as usize;
    (
        trees.hits[range(from.word, to.word)].to_vec(),
        trees.nodes[range(from.node, to.node)].to_vec(),
        trees.lights[range(from.light, to.light)].to_vec(),
        trees.crossings[range(from.crossing, to.crossing)].to_vec(),
    )
}

/// Holds that trees of blocks that a plan does not name are as they were.
pub(super) fn untouched(
    before: &[Option<Arc<KeptTrees>>],
    session: &Session,
    plan: &Plan,
    what: &str,
) {
    for (tile, (old, new)) in before.iter().zip(&session.forest().tiles).enumerate() {
        let named = plan.tiles.iter().find(|planned| planned.tile == tile);
        let (Some(old), Some(new)) = (old, new) else { continue };
        for block in 0..TILE_BLOCKS {
            if named.is_none_or(|planned| planned.lanes[block] == 0) {
                let same = block_of(old, block) == block_of(new, block);
                assert!(same, "{what}: tile {tile}, block {block} was touched");
            }
        }
    }
}

/// Holds that pixels that a plan does not name have as many samples as before.
pub(super) fn counted_alike(
    before: Option<Arc<SampleMap>>,
    session: &Session,
    plan: &Plan,
    what: &str,
) {
    let (Some(before), Some(after)) = (before, session.sample_map()) else { return };
    for tile in 0..session.transport().layout.tiles() {
        let named = plan.tiles.iter().find(|planned| planned.tile == tile);
        let counts = before.tile(tile).iter().zip(after.tile(tile)).enumerate();
        for (at, _) in counts.filter(|(_, (old, new))| old != new) {
            let lanes = named.map_or(0, |planned| planned.lanes[at / LANES]);
            assert!(lanes >> (at % LANES) & 1 != 0, "{what}: tile {tile}, place {at}");
        }
    }
}
/// What samples of opposite signs cancel is there all the same: every pixel that shows a material is
/// named when its surfaces are read again.
#[test]
fn pixels_whose_samples_cancel_are_named() {
    let mut scene = small("motion");
    set(&mut scene, "picture.size", "[120, 90]");
    set(&mut scene, "trace.samples", "4");
    let mut session = open(&scene, 2);
    let blue = scene.materials.iter().position(|m| m.name == "blue").unwrap() as u16;
    let trie = &session.transport().trie;
    let ambient = |id: u32| {
        let factor = trie.nodes()[id as usize].factor;
        factor.kind() == Kind::Ambient && factor.index() == usize::from(blue)
    };
    let minus = |c: f32| c.to_bits() == (-0.0f32).to_bits();
    let mut cancelled = 0;
    for tile in &session.transport().tiles {
        let planes = tile.entries.iter().zip(&tile.planes);
        let planes = planes.filter(|(entry, _)| ambient(tile.terms[**entry as usize]));
        cancelled += planes.flat_map(|(_, plane)| plane.0).filter(|c| minus(*c)).count();
        let singles = tile.singles.iter().filter(|s| ambient(tile.terms[s.entry()]));
        cancelled += singles.filter(|single| minus(single.coefficient)).count();
    }
    assert!(cancelled > 0, "some samples cancel");
    set(&mut scene, "materials.blue.texture.checker.size", "0.5");
    let plan = plan(&mut session, &scene).unwrap();
    let layout = session.transport().layout;
    let mut shown = 0;
    for tile in 0..layout.tiles() {
        let trees = session.trees(tile, &Progress::default()).unwrap();
        let lanes = plan.tiles.iter().find(|t| t.tile == tile).map(|t| t.lanes.clone());
        let mut reader = trees.read(0);
        for block in 0..TILE_BLOCKS {
            let pixel = |lane: &usize| layout.pixel(Place { tile, block, lane: *lane }).is_some();
            for lane in (0..LANES).filter(pixel) {
                let nodes: Vec<_> = (0..4).flat_map(|_| nodes_of(&mut reader)).collect();
                let solid = |primitive| session.geometry().solid(primitive) as usize;
                let shows = nodes
                    .iter()
                    .any(|(p, _)| scene.solids[solid(*p)].material == usize::from(blue));
                let named = lanes.as_ref().is_some_and(|lanes| lanes[block] >> lane & 1 != 0);
                assert!(named || !shows, "tile {tile} block {block} lane {lane}");
                shown += u32::from(shows);
            }
        }
    }
    assert!(shown > 100, "{shown}");
}
#[test]
fn a_touched_block_is_found() {
    let mut session = open(&small("whitted"), 2);
    let mut scene = session.scene().clone();
    set(&mut scene, "materials.tiles.reflect", "0.4");
    let mut planned = plan(&mut session, &scene).unwrap();
    let before = session.forest().tiles.clone();
    session.edit(scene, &Progress::default()).unwrap();
    untouched(&before, &session, &planned, "all named");
    planned.tiles.pop();
    let look = AssertUnwindSafe(|| untouched(&before, &session, &planned, "one not"));
    assert!(catch_unwind(look).is_err());
}

/// The pixels that are named for a branch are those whose trees lack it, and no others.
#[test]
fn pixels_are_named_if_and_only_if_their_trees_grow() {
    for name in ["whitted", "glass", "mesh"] {
        let mut session = open(&small(name), 2);
        for path in
            ["materials.tiles.reflect", "materials.amber.reflect", "materials.slate.reflect"]
        {
            let mut scene = session.scene().clone();
            if rayforest::scene::path::set(&mut scene, path, "0.4").is_err() {
                continue;
            }
            let Some(plan) = plan(&mut session, &scene) else { continue };
            let fresh = open(&scene, 2);
            let layout = fresh.transport().layout;
            let (mut grown, mut named) = (0, 0);
            for tile in 0..layout.tiles() {
                let old = session.trees(tile, &Progress::default()).unwrap();
                let new = fresh.trees(tile, &Progress::default()).unwrap();
                let lanes = plan.tiles.iter().find(|t| t.tile == tile).map(|t| t.lanes.clone());
                let (mut at, mut old_at) = (new.read(0), old.read(0));
                for block in 0..TILE_BLOCKS {
                    for lane in 0..LANES {
                        if layout.pixel(Place { tile, block, lane }).is_none() {
                            continue;
                        }
                        let is_named =
                            lanes.as_ref().is_some_and(|lanes| lanes[block] >> lane & 1 != 0);
                        let mut pair = || (nodes_of(&mut at), nodes_of(&mut old_at));
                        let pairs = [(); 2].map(|()| pair());
                        let differs = pairs.iter().any(|(new, old)| new != old);
                        assert!(
                            is_named || !differs,
                            "{name} {path}: tile {tile} block {block} lane {lane} is not named"
                        );
                        named += u32::from(is_named);
                        grown += u32::from(differs);
                    }
                }
            }
            assert!(grown > 0, "{name} {path}");
            assert_eq!(named, grown, "{name} {path}: pixels named for nothing");
        }
    }
}

/// The next sample's nodes, and whether their branches were followed.
fn nodes_of(reader: &mut Reader<'_>) -> Vec<(u32, [bool; 2])> {
    let grows = |end: Branch| matches!(end, Branch::Grown | Branch::Missed);
    let mut list = Vec::new();
    let mut open = usize::from(reader.sample());
    while open > 0 {
        let node = reader.node();
        for _ in 0..node.lights {
            reader.light();
        }
        let ends = [node.ends.reflected(), node.ends.transmitted()];
        open += ends.iter().filter(|&&end| end == Branch::Grown).count();
        open -= 1;
        list.push((node.primitive, ends.map(grows)));
    }
    list
}
