//! How each kept thing is written and read: one pair of functions per struct, all fields named.

use super::codec::{Item, Section, Source, Unsound, record};
use crate::film::layout::LANES;
use crate::fold::transport::{BlockStart, HighlightList, Highlights, Plane, Single, TransportTile};
use crate::fold::trie::{Marks, Trie, TrieNode};
use crate::forest::grow::RayCounts;
use crate::forest::tree::{Ends, LightHit, Node, Start, TileTrees};
use crate::scene::factor::{Factor, Kind};
use crate::session::trace::TraceReport;

record!(TrieNode { parent: u32, factor: Factor, marks: Marks });
record!(BlockStart { plane: u32, single: u32 });
record!(Single { place: u32, coefficient: f32 });
record!(HighlightList { at: u32, material: u16, mask: u16 });
record!(Node { t: f64, primitive: u32, material: u16, lights: u16, slot: u8, ends: Ends });
record!(LightHit { light: u16, crossed: u16, n_dot_l: f32, one_minus_r_dot_v: f32 });
record!(Start { sample: u32, node: u32, light: u32, crossing: u32 });
record!(RayCounts { camera: u64, reflected: u64, transmitted: u64, shadow: u64 });
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
by_bits!(Ends as u8, else Ends::new(
    crate::forest::tree::Branch::Zero, crate::forest::tree::Branch::Zero, false));

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

/// Writes the terms.
pub(super) fn put_trie(trie: &Trie, out: &mut Section) {
    out.array(trie.nodes());
}

/// Reads the terms.
pub(super) fn take_trie(from: &mut Source) -> Result<Trie, Unsound> {
    Trie::from_canonical(from.array::<TrieNode>()?).ok_or("the terms are out of order")
}

/// Writes a tile's part of the matrix without its highlight lists.
pub(super) fn put_matrix(tile: &TransportTile, out: &mut Section) {
    let TransportTile { terms, starts, entries, planes, singles, highlights: _ } = tile;
    out.array(terms);
    out.array(starts);
    out.array(entries);
    out.array(planes);
    out.array(singles);
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
    })
}

/// Writes a tile's highlight lists.
pub(super) fn put_highlights(highlights: &Highlights, out: &mut Section) {
    let Highlights { lists, counts, log2_cosines } = highlights;
    out.array(lists);
    out.array(counts);
    out.array(log2_cosines);
}

/// Reads a tile's highlight lists.
pub(super) fn take_highlights(from: &mut Source) -> Result<Highlights, Unsound> {
    Ok(Highlights { lists: from.array()?, counts: from.array()?, log2_cosines: from.array()? })
}

/// Writes a tile's trees.
pub(super) fn put_trees(trees: &TileTrees, out: &mut Section) {
    let TileTrees { blocks, hits, nodes, lights, crossings } = trees;
    out.array(blocks);
    out.array(hits);
    out.array(nodes);
    out.array(lights);
    out.array(crossings);
}

/// Reads a tile's trees.
pub(super) fn take_trees(from: &mut Source) -> Result<TileTrees, Unsound> {
    Ok(TileTrees {
        blocks: from.array()?,
        hits: from.array()?,
        nodes: from.array()?,
        lights: from.array()?,
        crossings: from.array()?,
    })
}
