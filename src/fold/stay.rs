//! Rows of an earlier fold that stay as they are while other terms of a tile are folded again.

use super::lists::Piece;
use super::transport::{HighlightList, Highlights, TransportTile};
use super::trie::{Trie, TrieNode};
use crate::forest::scope::{At, Scope};
use crate::scene::factor::{Factor, Kind};

/// Which terms of a matrix keep their coefficients, and how their factors are called from now on.
#[derive(Clone, Debug)]
pub struct Stay {
    /// Per id of the matrix's trie.
    terms: Vec<bool>,
    /// Per place of a light in the list of factors its new place; of those that are gone none.
    lights: Vec<Option<u16>>,
}

impl Stay {
    /// What a scope leaves alone. Where the scope has lights, what comes from one without a new place
    /// does not stay.
    pub fn beside(scope: &Scope, trie: &Trie, lights: Vec<Option<u16>>) -> Stay {
        // In `ats` a term that is no path stands where all of its own terms stand.
        let mut ats = vec![Scope::EYE; trie.nodes().len()];
        let mut terms = vec![true; ats.len()];
        for (id, node) in trie.nodes().iter().enumerate().skip(1) {
            let TrieNode { parent, factor, marks: _ } = *node;
            let above = ats[parent as usize];
            let shadowed = trie.nodes()[parent as usize].factor;
            let at_path = parent == super::trie::ROOT || shadowed.is_path();
            ats[id] = match factor.kind() {
                _ if factor.is_path() => scope.next(above, factor),
                Kind::Light if at_path && scope.has_lights(above) => {
                    match lights.get(factor.index()).copied().flatten() {
                        Some(light) if !scope.has_light(light.into()) => At::NONE,
                        _ => At::ALL,
                    }
                }
                // What stopped a shadow ray does not tell which light's.
                Kind::Shadow if at_path && scope.has_lights(above) => At::ALL,
                _ if above == At::ALL => At::ALL,
                _ => At::NONE,
            };
            terms[id] = ats[id] != At::ALL;
        }
        Stay { terms, lights }
    }

    fn place(&self, light: Factor) -> Option<u16> {
        self.lights.get(light.index()).copied().flatten()
    }

    fn renamed(&self, factor: Factor) -> Factor {
        match factor.kind() {
            // A light without a new place that is in no scope is gone, and black under any name.
            Kind::Light => match self.place(factor) {
                Some(place) => Factor::new(Kind::Light, place, 0),
                None => factor,
            },
            _ => factor,
        }
    }
}

/// A tile's rows that stay, and where they come to stand.
#[derive(Default)]
pub(super) struct Staying {
    /// Per entry of the tile's dictionary the term's id in the folder's trie, or [`GONE`].
    pub(super) terms: Vec<u32>,
    /// The same of the frontier's dictionary.
    pub(super) frontier: Vec<u32>,
    /// Per plane of the tile its new place, or [`GONE`].
    pub(super) planes: Vec<u32>,
    /// Per single coefficient.
    pub(super) singles: Vec<u32>,
}

/// It does not stay.
pub(super) const GONE: u32 = u32::MAX;

impl Staying {
    /// Prepares for a tile of a matrix with the terms of `trie`: adds those that stay to `own`.
    pub(super) fn begin(&mut self, tile: &TransportTile, trie: &Trie, stay: &Stay, own: &mut Trie) {
        let Staying { terms, frontier, planes, singles } = self;
        let mut id = |&term: &u32| match stay.terms[term as usize] {
            true => interned(trie, term, stay, own),
            false => GONE,
        };
        terms.clear();
        terms.extend(tile.terms.iter().map(&mut id));
        frontier.clear();
        frontier.extend(tile.frontier.terms.iter().map(&mut id));
        planes.clear();
        planes.resize(tile.planes.len(), GONE);
        singles.clear();
        singles.resize(tile.singles.len(), GONE);
    }

    /// The highlight lists of `old` that stay, at their new places, and those of `new`.
    pub(super) fn with_lists(&self, old: &Highlights, new: &Highlights) -> Highlights {
        let mut pieces = old.pieces();
        pieces.retain_mut(|piece| {
            let at = &mut piece.list.at;
            *at = match *at & HighlightList::SINGLE {
                0 => self.planes[*at as usize],
                _ => match self.singles[(*at & !HighlightList::SINGLE) as usize] {
                    GONE => GONE,
                    single => single | HighlightList::SINGLE,
                },
            };
            *at != GONE
        });
        pieces.extend(new.pieces());
        pieces.sort_by_key(Piece::key);
        Highlights::of_pieces(pieces.iter())
    }
}

/// The id in `own` of a term of `trie`.
fn interned(trie: &Trie, term: u32, stay: &Stay, own: &mut Trie) -> u32 {
    let factors = trie.factors(term).into_iter();
    factors.fold(super::trie::ROOT, |id, factor| own.intern(id, stay.renamed(factor)))
}
