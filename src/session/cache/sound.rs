//! Whether what was read may be used: every invariant and every index that shading, folding and
//! reading trees rely on, as an answer instead of a panic.

use super::codec::Unsound;
use super::parts::State;
use crate::film::layout::{LANES, Layout, TILE_BLOCKS};
use crate::fold::transport::{
    BlockStart, Frontier, FrontierMark, Plane, SPARSE_LANES, Single, TransportTile,
};
use crate::fold::trie::{Marks, ROOT, Trie, TrieNode};
use crate::forest::kept::{KeptLight, KeptNode, KeptStart, KeptTrees};
use crate::forest::tree::{Branch, entries};
use crate::geometry::Geometry;
use crate::scene::Scene;
use crate::scene::factor::{Factor, Kind};
use crate::scene::fields::{DEPTH, EXPONENT};

/// `what` unless it holds.
pub(super) fn ensure(holds: bool, what: Unsound) -> Result<(), Unsound> {
    if holds { Ok(()) } else { Err(what) }
}

/// How many slots there are.
struct Slots {
    /// Per material those of its paint.
    paints: Vec<usize>,
    background: usize,
}

/// Whether the terms of a trie, which stand in canonical order, are products of a scene's factors.
pub(super) fn trie(trie: &Trie, scene: &Scene) -> Result<(), Unsound> {
    let slots = Slots {
        paints: scene.materials.iter().map(|m| m.paint.slots()).collect(),
        background: scene.background.slots(),
    };
    for node in &trie.nodes()[1..] {
        let TrieNode { parent, factor, marks } = *node;
        ensure(is_of(factor, &slots), "a term has a factor of nothing")?;
        let above = &trie.nodes()[parent as usize];
        let follows = parent == ROOT || above.factor.is_path();
        ensure(follows || !factor.is_path(), "a path goes on behind light")?;
        ensure(!marks.has(Marks::FRONTIER) || factor.is_path(), "a frontier that is no path")?;
        let shadow = follows && factor.kind() == Kind::Shadow;
        ensure(!marks.has(Marks::WITNESS) || shadow, "a witness that is no shadow")?;
    }
    Ok(())
}

/// Whether a scene with these slots has the factor. Lights that are gone have left
/// their places behind.
fn is_of(factor: Factor, Slots { paints: slots, background }: &Slots) -> bool {
    let (index, slot) = (factor.index(), factor.slot());
    match factor.kind() {
        Kind::Background => index == 0 && slot < *background,
        Kind::Reflect | Kind::Transmit | Kind::TotalReflect => index < slots.len() && slot == 0,
        Kind::Through | Kind::Shadow => index < slots.len() && slot == 0,
        Kind::Ambient | Kind::Diffuse | Kind::Specular => {
            slots.get(index).is_some_and(|slots| slot < *slots)
        }
        Kind::Light => slot == 0,
        Kind::Channel => index < 3 && slot == 0,
    }
}

/// Whether a session may know this of a scene.
pub(super) fn state(state: &State, scene: &Scene) -> Result<(), Unsound> {
    let State { keys, keys_in_trees, lights, iors, lobes, counts: _ } = state;
    let each = [keys.len(), lights.len()] == [scene.lights.len(); 2];
    let materials = [iors.len(), lobes.len()] == [scene.materials.len(); 2];
    ensure(each && materials, "of another scene")?;
    let exponent = |n: &f32| n.is_nan() || EXPONENT.contains(f64::from(*n));
    let exponents = lobes.iter().flatten().all(exponent);
    ensure(exponents, "a lobe has no exponent")?;
    let mut sorted = keys.clone();
    sorted.sort_unstable();
    ensure(sorted.is_sorted_by(|a, b| a < b), "two lights have one key")?;
    // There must be some left for lights to come.
    let most = usize::from(u16::MAX / 2).max(keys.len());
    ensure(keys_in_trees.len() <= most, "more keys than lights may have")?;
    let mut in_trees = keys_in_trees.clone();
    in_trees.sort_unstable();
    let known = keys.iter().all(|key| in_trees.binary_search(key).is_ok());
    ensure(known, "a light has a key that no tree has")?;
    ensure(lights.is_sorted_by(|a, b| a < b), "lights are out of order")?;
    // Not a number stands for several.
    ensure(
        iors.iter().all(|ior| ior.is_nan() || *ior > 0.0),
        "an index of refraction is not above 0",
    )
}

/// Whether a tile's part of a matrix of so many terms is sound. Its highlight lists are not looked
/// at.
pub(super) fn matrix(tile: &TransportTile, nodes: &[TrieNode]) -> Result<(), Unsound> {
    let TransportTile { terms, starts, entries, planes, singles, highlights: _, frontier } = tile;
    ends(frontier, nodes)?;
    ensure(terms.is_sorted_by(|a, b| a < b), "the dictionary is out of order")?;
    let last = terms.last().is_none_or(|last| (*last as usize) < nodes.len());
    ensure(last, "the dictionary has an unknown term")?;
    ensure(entries.len() == planes.len(), "not one plane per entry")?;
    positions(starts, planes.len(), singles.len())?;
    let known = |entry: usize| entry < terms.len();
    ensure(entries.iter().all(|&e| known(e as usize)), "an unknown entry")?;
    ensure(singles.iter().all(|s| known(s.entry())), "an unknown entry of a single")?;
    for pair in starts.windows(2) {
        let entries = &entries[pair[0].plane as usize..pair[1].plane as usize];
        ensure(entries.is_sorted_by(|a, b| a < b), "entries are out of order")?;
        let singles = &singles[pair[0].single as usize..pair[1].single as usize];
        ensure(singles.is_sorted_by(|a, b| a.place < b.place), "singles are out of order")?;
        let few = |s: &[Single]| s.len() <= SPARSE_LANES as usize;
        ensure(singles.chunk_by(|a, b| a.entry() == b.entry()).all(few), "singles of many lanes")?;
    }
    // No short cut inside of a plane, so that the loop vectorises.
    let finite = |plane: &Plane| plane.0.iter().fold(true, |all, c| all & c.is_finite());
    let all = planes.iter().all(finite) && singles.iter().all(|s| s.coefficient.is_finite());
    ensure(all, "a coefficient is not finite")
}

/// Whether the frontier of a tile is one of so many terms.
fn ends(frontier: &Frontier, nodes: &[TrieNode]) -> Result<(), Unsound> {
    let Frontier { terms, starts, marks } = frontier;
    ensure(terms.is_sorted_by(|a, b| a < b), "the frontier is out of order")?;
    let last = terms.last().is_none_or(|last| (*last as usize) < nodes.len());
    ensure(last, "the frontier has an unknown term")?;
    let ended = |id: &u32| nodes[*id as usize].marks.has(nodes[*id as usize].end_mark());
    ensure(terms.iter().all(ended), "the frontier has a term at which nothing ends")?;
    let whole = starts.len() == TILE_BLOCKS + 1 && starts.is_sorted() && starts[0] == 0;
    ensure(whole && starts[TILE_BLOCKS] as usize == marks.len(), "the frontier leaves out blocks")?;
    let sound = |mark: &FrontierMark| {
        let FrontierMark { entry, mask, rays } = *mark;
        (entry as usize) < terms.len() && mask != 0 && rays > 0
    };
    ensure(marks.iter().all(sound), "a mark of the frontier is of nothing")?;
    for pair in starts.windows(2) {
        let marks = &marks[pair[0] as usize..pair[1] as usize];
        ensure(marks.is_sorted_by(|a, b| a.entry < b.entry), "marks are out of order")?;
    }
    Ok(())
}

/// Whether the blocks of a tile begin where the ones before them end.
fn positions(starts: &[BlockStart], planes: usize, singles: usize) -> Result<(), Unsound> {
    ensure(starts.len() == TILE_BLOCKS + 1, "not 64 blocks")?;
    let rising = |a: &BlockStart, b: &BlockStart| a.plane <= b.plane && a.single <= b.single;
    ensure(starts.is_sorted_by(rising), "blocks are out of order")?;
    let ends = [starts[0], starts[TILE_BLOCKS]].map(|s| [s.plane as usize, s.single as usize]);
    ensure(ends == [[0, 0], [planes, singles]], "blocks leave something out")
}

/// What trees may refer to.
pub(super) struct Surroundings {
    layout: Layout,
    samples: usize,
    primitives: usize,
    solids: usize,
    /// By key, whether light records may have it.
    keys: Vec<bool>,
}

impl Surroundings {
    /// Those of a scene, its geometry, and the keys of its light records.
    pub(super) fn new(scene: &Scene, geometry: &Geometry, keys: &[u16]) -> Surroundings {
        let mut known = vec![false; 1 << 16];
        keys.iter().for_each(|key| known[usize::from(*key)] = true);
        Surroundings {
            keys: known,
            layout: Layout::new(scene.picture.size),
            samples: scene.trace.samples as usize,
            primitives: geometry.primitives(),
            solids: scene.solids.len(),
        }
    }

    /// Whether the trees of a tile are whole: whoever reads the samples of its pixels in order
    /// comes to the end of every array at once, and to nothing that the scene has not.
    pub(super) fn trees(&self, trees: &KeptTrees, tile: usize) -> Result<(), Unsound> {
        let KeptTrees { counts, blocks, hits, nodes, lights, crossings } = trees;
        let starts = blocks.split_last().filter(|_| trees.is_whole());
        let (end, starts) = starts.ok_or("not 64 blocks")?;
        let mut walk = Walk { trees, at: KeptStart::default(), depths: Vec::new() };
        for (block, start) in starts.iter().enumerate() {
            ensure(*start == walk.at, "a block starts elsewhere than its samples")?;
            let covered = self.layout.covered(tile, block).into_iter().enumerate();
            let count = |lane: usize| counts.get(block * LANES + lane);
            let samples = covered
                .filter(|(_, covered)| *covered)
                .map(|(lane, _)| count(lane).map_or(self.samples, |&count| usize::from(count)));
            walk.block(samples.sum(), self)?;
        }
        ensure(*end == walk.at, "the last block ends elsewhere than its samples")?;
        let KeptStart { word, node, light, crossing } = walk.at;
        let read = [word, node, light, crossing].map(|n| n as usize);
        let all = [hits.len(), nodes.len(), lights.len(), crossings.len()];
        ensure(read == all, "something is left over")
    }
}

/// Reads a tile's trees in order, and never beyond their ends.
struct Walk<'a> {
    trees: &'a KeptTrees,
    at: KeptStart,
    /// Depths of the nodes that are still to come of the present sample, the next one last.
    depths: Vec<u64>,
}

const CUT: Unsound = "trees end too early";

impl Walk<'_> {
    fn block(&mut self, samples: usize, within: &Surroundings) -> Result<(), Unsound> {
        for sample in 0..samples {
            let word = self.trees.hits.get(self.at.word as usize + sample / 64).ok_or(CUT)?;
            self.depths.clear();
            self.depths.extend((word >> (sample % 64) & 1 != 0).then_some(0));
            while let Some(depth) = self.depths.pop() {
                ensure(depth <= DEPTH.high as u64, "a tree deeper than the deepest limit")?;
                self.node(depth, within)?;
            }
        }
        self.at.word += samples.div_ceil(64) as u32;
        Ok(())
    }

    fn node(&mut self, depth: u64, within: &Surroundings) -> Result<(), Unsound> {
        let node = self.trees.nodes.get(self.at.node as usize).ok_or(CUT)?;
        let KeptNode { t, primitive, lights, ends } = *node;
        self.at.node += 1;
        ensure(t > 0.0 && t.is_finite(), "a distance is not above 0")?;
        ensure((primitive as usize) < within.primitives, "an unknown primitive")?;
        let total = ends.transmitted() == Branch::Absent;
        let both = ends.reflected() != Branch::Absent && ends.total() == total;
        ensure(both, "branches that no surface has")?;
        for branch in [ends.reflected(), ends.transmitted()] {
            self.depths.extend((branch == Branch::Grown).then_some(depth + 1));
        }
        for _ in 0..lights {
            let light = self.trees.lights.get(self.at.light as usize).ok_or(CUT)?;
            let KeptLight { key, crossed } = *light;
            ensure(within.keys[usize::from(key)], "a light record with an unknown key")?;
            let from = self.at.crossing as usize;
            let count = entries(crossed);
            let solids = self.trees.crossings.get(from..from + count).ok_or(CUT)?;
            let known = solids.iter().all(|&solid| (solid as usize) < within.solids);
            ensure(known, "an unknown solid")?;
            self.at.light += 1;
            self.at.crossing += count as u32;
        }
        Ok(())
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::forest::tree::{BEHIND, Ends};
    use crate::progress::Progress;
    use crate::scene::model::Model;
    use crate::scene::read;
    use crate::session::{Options, Session};

    pub(in super::super) fn session(size: [u32; 2], samples: u32) -> Session {
        let file = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/glass.toml");
        let mut scene = read::file(&file).unwrap();
        (scene.picture.size, scene.trace.samples) = (size, samples);
        // Highlights with weights and without.
        scene.materials[0].specular = crate::color::Rgb::grey(0.5);
        scene.materials[1].model = Model::Hall;
        scene.materials[2].fresnel = true;
        let options = Options { threads: 2, memory: 1 << 30 };
        Session::open(scene, options, &Progress::default()).unwrap()
    }

    /// A fault by its words, and what makes it.
    pub(in super::super) type Case<T> = (&'static str, fn(&mut T));

    /// Holds `check` to finding every fault in something sound.
    pub(in super::super) fn hold<T: Clone>(
        sound: &T,
        cases: &[Case<T>],
        check: impl Fn(&T) -> Result<(), Unsound>,
    ) {
        assert_eq!(check(sound), Ok(()));
        for (words, harm) in cases {
            let mut harmed = sound.clone();
            harm(&mut harmed);
            assert_eq!(check(&harmed), Err(*words));
        }
    }

    /// The singles of the first block that has five.
    fn five(tile: &mut TransportTile) -> &mut [Single] {
        let ends = tile.starts.windows(2).map(|s| s[0].single as usize..s[1].single as usize);
        let range = ends.into_iter().find(|range| range.len() >= 5).unwrap();
        &mut tile.singles[range]
    }

    #[test]
    fn faults_of_a_matrix_are_found() {
        let session = session([37, 9], 2);
        let nodes = session.transport().trie.nodes();
        let cases: [Case<TransportTile>; 14] = [
            ("the dictionary is out of order", |t| t.terms.swap(0, 1)),
            ("the dictionary has an unknown term", |t| t.terms.push(1 << 30)),
            ("not one plane per entry", |t| _ = t.planes.pop()),
            ("not 64 blocks", |t| _ = t.starts.pop()),
            ("blocks are out of order", |t| t.starts[3].plane = u32::MAX),
            ("blocks are out of order", |t| t.starts[0].single = u32::MAX),
            ("blocks leave something out", |t| t.starts[TILE_BLOCKS].single += 1),
            ("an unknown entry", |t| t.entries[0] = t.terms.len() as u32),
            ("an unknown entry of a single", |t| t.singles[0].place = u32::MAX),
            ("entries are out of order", |t| t.entries.swap(0, 1)),
            ("singles are out of order", |t| five(t).swap(2, 3)),
            ("singles of many lanes", |t| {
                let entry = five(t)[0].entry() as u32;
                let place = |lane| Single::new(entry, lane, 0.0).place;
                (0..5).for_each(|lane| five(t)[lane].place = place(lane));
            }),
            ("a coefficient is not finite", |t| t.planes[0].0[7] = f32::NAN),
            ("a coefficient is not finite", |t| t.singles[0].coefficient = f32::INFINITY),
        ];
        hold(&*session.transport().tiles[0], &cases, |tile| matrix(tile, nodes));
    }

    #[test]
    fn faults_of_terms_are_found() {
        let session = session([37, 9], 2);
        fn below_last(trie: &mut Trie, factor: Factor) {
            let mut nodes = trie.nodes().to_vec();
            let parent = nodes.len() as u32 - 1;
            nodes.push(TrieNode { parent, factor, marks: Marks::default() });
            *trie = Trie::from_canonical(nodes).unwrap();
        }
        let cases: [Case<Trie>; 7] = [
            ("a term has a factor of nothing", |t| {
                below_last(t, Factor::new(Kind::Diffuse, u16::MAX, 0));
            }),
            ("a term has a factor of nothing", |t| below_last(t, Factor::new(Kind::Light, 0, 1))),
            ("a term has a factor of nothing", |t| below_last(t, Factor::new(Kind::Ambient, 0, 9))),
            ("a term has a factor of nothing", |t| below_last(t, Factor::new(Kind::Channel, 3, 0))),
            ("a path goes on behind light", |t| below_last(t, Factor::new(Kind::Reflect, 0, 0))),
            ("a frontier that is no path", |t| {
                below_last(t, Factor::new(Kind::Shadow, 0, 0));
                t.mark(t.nodes().len() as u32 - 1, Marks::FRONTIER);
            }),
            ("a witness that is no shadow", |t| {
                below_last(t, Factor::new(Kind::Channel, 0, 0));
                t.mark(t.nodes().len() as u32 - 1, Marks::WITNESS);
            }),
        ];
        hold(&session.transport().trie, &cases, |terms| trie(terms, session.scene()));
    }

    #[test]
    fn faults_of_what_a_session_knows_are_found() {
        let session = session([37, 9], 2);
        let fault = |harm: fn(&mut State)| {
            let mut harmed = State::of(&session);
            harm(&mut harmed);
            state(&harmed, session.scene())
        };
        assert_eq!(fault(|_| ()), Ok(()));
        assert_eq!(fault(|s| s.iors[0] = f64::NAN), Ok(()));
        assert_eq!(fault(|s| s.iors[0] = 0.0), Err("an index of refraction is not above 0"));
        assert_eq!(fault(|s| s.iors.push(1.0)), Err("of another scene"));
        assert_eq!(fault(|s| _ = s.lobes.pop()), Err("of another scene"));
        assert_eq!(fault(|s| s.lobes[1] = [0.0, f32::NAN]), Ok(()));
        assert_eq!(fault(|s| s.lobes[1][1] = f32::INFINITY), Err("a lobe has no exponent"));
        assert_eq!(fault(|s| s.lobes[0][0] = -1.0), Err("a lobe has no exponent"));
        assert_eq!(fault(|s| _ = s.keys.pop()), Err("of another scene"));
        assert_eq!(fault(|s| s.keys[0] = s.keys[1]), Err("two lights have one key"));
        assert_eq!(fault(|s| s.keys_in_trees.extend([9, 7])), Ok(()));
        assert_eq!(fault(|s| s.keys_in_trees = vec![9]), Err("a light has a key that no tree has"));
        let many = fault(|s| s.keys_in_trees.extend(0..u16::MAX / 2));
        assert_eq!(many, Err("more keys than lights may have"));
        assert_eq!(fault(|s| s.lights.swap(0, 1)), Err("lights are out of order"));
    }

    #[test]
    fn faults_of_a_frontier_are_found() {
        let session = session([37, 9], 2);
        let nodes = session.transport().trie.nodes();
        let several = |tile: &&std::sync::Arc<TransportTile>| tile.frontier.terms.len() > 1;
        let tile = session.transport().tiles.iter().find(several).unwrap();
        fn two(frontier: &Frontier) -> usize {
            let pair = frontier.starts.windows(2).find(|pair| pair[1] > pair[0] + 1);
            pair.map_or(0, |pair| pair[0] as usize)
        }
        let cases: [Case<Frontier>; 8] = [
            ("the frontier is out of order", |f| f.terms.swap(0, 1)),
            ("the frontier has an unknown term", |f| f.terms.push(1 << 30)),
            ("the frontier leaves out blocks", |f| _ = f.starts.pop()),
            ("the frontier leaves out blocks", |f| f.starts[1] = u32::MAX),
            ("the frontier leaves out blocks", |f| _ = f.marks.pop()),
            ("a mark of the frontier is of nothing", |f| f.marks[0].mask = 0),
            ("a mark of the frontier is of nothing", |f| f.marks[0].entry = u32::MAX),
            ("marks are out of order", |f| {
                let at = two(f);
                f.marks.swap(at, at + 1);
            }),
        ];
        hold(&tile.frontier, &cases, |frontier| ends(frontier, nodes));
    }

    #[test]
    fn faults_of_trees_are_found() {
        let session = session([37, 9], 2);
        let cases: [Case<KeptTrees>; 15] = [
            ("not 64 blocks", |t| _ = t.blocks.pop()),
            ("a block starts elsewhere than its samples", |t| t.blocks[1].node += 1),
            ("the last block ends elsewhere than its samples", |t| t.blocks[64].word += 1),
            ("trees end too early", |t| _ = t.hits.pop()),
            ("trees end too early", |t| _ = t.nodes.pop()),
            ("trees end too early", |t| _ = t.lights.pop()),
            ("something is left over", |t| t.hits.push(0)),
            ("something is left over", |t| t.crossings.push(0)),
            ("a distance is not above 0", |t| t.nodes[5].t = f64::NAN),
            ("an unknown primitive", |t| t.nodes[5].primitive = u32::MAX),
            ("branches that no surface has", |t| {
                t.nodes[5].ends = Ends::new(Branch::Absent, Branch::Missed, false);
            }),
            ("branches that no surface has", |t| {
                t.nodes[5].ends = Ends::new(Branch::Missed, Branch::Missed, true);
            }),
            ("an unknown solid", |t| t.crossings[0] = u32::MAX),
            ("a light record with an unknown key", |t| t.lights[3].key = u16::MAX),
            ("trees end too early", |t| t.lights[0].crossed = BEHIND - 1),
        ];
        let within = Surroundings::new(session.scene(), session.geometry(), &session.keys_in_trees);
        let trees = session.forest().tiles[0].as_deref().unwrap();
        hold(trees, &cases, |trees| within.trees(trees, 0));
        // The second tile has fewer pixels.
        assert!(within.trees(trees, 1).is_err());
    }

    #[test]
    fn a_tree_deeper_than_any_limit_is_found() {
        let session = session([37, 9], 2);
        let kept = session.forest().tiles[1].as_deref().unwrap();
        assert_eq!(kept.hits[0] & 1, 1, "the first sample meets the scene");
        let ends = Ends::new(Branch::Grown, Branch::Zero, false);
        let first = KeptNode { lights: 0, ends, ..kept.nodes[0] };
        let trees = KeptTrees { nodes: vec![first; 100], ..kept.clone() };
        let within = Surroundings::new(session.scene(), session.geometry(), &session.keys_in_trees);
        assert_eq!(within.trees(&trees, 1), Err("a tree deeper than the deepest limit"));
    }
}
