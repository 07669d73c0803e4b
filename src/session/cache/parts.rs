//! How each kept thing is written and read: one pair of functions per struct, all fields named.

use super::codec::{Item, Section, Source, Unsound, record};
use crate::film::layout::LANES;
use crate::fold::transport::{
    BlockStart, Frontier, FrontierMark, HighlightGroup, HighlightList, Highlights, Plane, Single,
    TransportTile,
};
use crate::fold::trie::{Marks, Trie, TrieNode};
use crate::forest::grow::RayCounts;
use crate::forest::kept::{KeptLight, KeptNode, KeptStart, KeptTrees};
use crate::forest::tree::{Branch, Ends};
use crate::scene::factor::{Factor, Kind};
use crate::scene::model::Lobes;
use crate::session::Session;
use crate::session::trace::TraceReport;

record!(TrieNode { parent: u32, factor: Factor, marks: Marks });
record!(BlockStart { plane: u32, single: u32 });
record!(Single { place: u32, coefficient: f32 });
record!(FrontierMark { entry: u32, mask: u16, rays: u16 });
record!(HighlightGroup { material: u16, weighted: bool, lists: u32, lanes: u32, samples: u32 });
record!(HighlightList { at: u32, mask: u16, full: u16, peak: f32 });
record!(KeptNode { t: f64, primitive: u32, lights: u16, ends: Ends });
record!(KeptLight { key: u16, crossed: u16 });
record!(KeptStart { word: u32, node: u32, light: u32, crossing: u32 });
record!(RayCounts { camera: u64, reflected: u64, transmitted: u64, shadow: u64, lost: u64 });
record!(TraceReport { seconds: f64, fold_seconds: f64, rays: RayCounts, nodes: u64 });

/// Makes a type whose values have bits of their own an [`Item`].
macro_rules! by_bits {
    ($name:ident as $bits:ty, else $none:expr) => {
        impl Item for $name {
            const BYTES: usize = size_of::<$bits>();
            #[inline(always)]
            fn put(self, bytes: &mut [u8]) {
                self.bits().put(bytes);
            }
            #[inline(always)]
            fn take(bytes: &[u8]) -> Self {
                $name::from_bits(<$bits>::take(bytes)).unwrap_or($none)
            }
            #[inline(always)]
            fn sound(bytes: &[u8]) -> bool {
                $name::from_bits(<$bits>::take(bytes)).is_some()
            }
        }
    };
}
// What stands behind `else` is never seen: bytes that are not sound are not taken.
by_bits!(Factor as u32, else Factor::new(Kind::Background, 0, 0));
by_bits!(Marks as u8, else Marks::default());
by_bits!(Ends as u8, else Ends::new(Branch::Zero, Branch::Zero, false));

impl Item for Plane {
    const BYTES: usize = LANES * 4;
    #[inline(always)]
    fn put(self, bytes: &mut [u8]) {
        for (bytes, lane) in bytes.chunks_exact_mut(4).zip(self.0) {
            lane.put(bytes);
        }
    }
    #[inline(always)]
    fn take(bytes: &[u8]) -> Plane {
        let mut lanes = [0.0; LANES];
        for (lane, bytes) in lanes.iter_mut().zip(bytes.chunks_exact(4)) {
            *lane = f32::take(bytes);
        }
        Plane(lanes)
    }
}

/// What a session knows of its scene besides what the scene says.
#[derive(Clone)]
pub(super) struct State {
    /// Per light the key of its records in the trees.
    pub(super) keys: Vec<u16>,
    /// Keys of all records in the trees: also of lights that are gone.
    pub(super) keys_in_trees: Vec<u16>,
    /// Per light its place in the list of factors.
    pub(super) lights: Vec<u16>,
    /// Per material the index of refraction with which its nodes stand in the trees.
    pub(super) iors: Vec<f64>,
    /// Per material the lobes with which they stand there: of the mirror rays, of the refracted ones.
    pub(super) lobes: Vec<Lobes>,
    /// Where sampling is adaptive, the number of samples of every pixel, tile after tile.
    pub(super) counts: Vec<u16>,
}

impl State {
    /// What a session knows.
    pub(super) fn of(session: &Session) -> State {
        State {
            keys: session.keys.clone(),
            keys_in_trees: session.keys_in_trees.clone(),
            lights: session.names.lights.clone(),
            iors: session.iors.clone(),
            lobes: session.lobes.clone(),
            counts: session.map.as_ref().map_or(Vec::new(), |map| map.to_list()),
        }
    }
}

/// Writes the terms and what their factors stand for.
pub(super) fn put_terms(trie: &Trie, state: &State, out: &mut Section) {
    let State { keys, keys_in_trees, lights, iors, lobes, counts } = state;
    out.array(trie.nodes());
    out.array(keys);
    out.array(keys_in_trees);
    out.array(lights);
    out.array(iors);
    let [gloss, translucency] = [0, 1].map(|k| lobes.iter().map(|l| l[k]).collect::<Vec<_>>());
    out.array(&gloss);
    out.array(&translucency);
    out.array(counts);
}

/// Reads the terms and what their factors stand for.
pub(super) fn take_terms(from: &mut Source) -> Result<(Trie, State), Unsound> {
    let trie = Trie::from_canonical(from.array::<TrieNode>()?).ok_or("they are out of order")?;
    let (keys, keys_in_trees, lights) = (from.array()?, from.array()?, from.array()?);
    let (iors, gloss, translucency) = (from.array()?, from.array::<f32>()?, from.array::<f32>()?);
    if gloss.len() != translucency.len() {
        return Err("not both lobes of every material");
    }
    let lobes = gloss.into_iter().zip(translucency).map(|(g, t)| [g, t]).collect();
    let counts = from.array()?;
    let state = State { keys, keys_in_trees, lights, iors, lobes, counts };
    Ok((trie, state))
}

/// Writes a tile's part of the matrix without its highlight lists.
pub(super) fn put_matrix(tile: &TransportTile, out: &mut Section) {
    let TransportTile { terms, starts, entries, planes, singles, highlights: _, frontier } = tile;
    out.array(terms);
    out.array(starts);
    out.array(entries);
    out.array(planes);
    out.array(singles);
    let Frontier { terms, starts, marks } = frontier;
    out.array(terms);
    out.array(starts);
    out.array(marks);
}

/// Reads a tile's part of the matrix without its highlight lists.
pub(super) fn take_matrix(from: &mut Source) -> Result<TransportTile, Unsound> {
    Ok(TransportTile {
        terms: from.array()?,
        starts: from.array()?,
        entries: from.array()?,
        planes: from.array()?,
        singles: from.array()?,
        highlights: None,
        frontier: Frontier { terms: from.array()?, starts: from.array()?, marks: from.array()? },
    })
}

/// Writes a tile's highlight lists.
pub(super) fn put_highlights(highlights: &Highlights, out: &mut Section) {
    let Highlights { groups, lists, counts, logarithms, weights } = highlights;
    out.array(groups);
    out.array(lists);
    out.array(counts);
    out.array(logarithms);
    out.array(weights);
}

/// Reads a tile's highlight lists.
pub(super) fn take_highlights(from: &mut Source) -> Result<Highlights, Unsound> {
    Ok(Highlights {
        groups: from.array()?,
        lists: from.array()?,
        counts: from.array()?,
        logarithms: from.array()?,
        weights: from.array()?,
    })
}

/// Writes a tile's trees; how many samples pixels have is written once for all.
pub(super) fn put_trees(trees: &KeptTrees, out: &mut Section) {
    let KeptTrees { counts: _, blocks, hits, nodes, lights, crossings } = trees;
    out.array(blocks);
    out.array(hits);
    out.array(nodes);
    out.array(lights);
    out.array(crossings);
}

/// Reads a tile's trees, whose pixels have so many samples if they differ.
pub(super) fn take_trees(from: &mut Source, counts: &[u16]) -> Result<KeptTrees, Unsound> {
    Ok(KeptTrees {
        counts: counts.to_vec(),
        blocks: from.array()?,
        hits: from.array()?,
        nodes: from.array()?,
        lights: from.array()?,
        crossings: from.array()?,
    })
}
