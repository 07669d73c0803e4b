//! Whether highlight lists that were read may be used: what folding and merging rely on.

use super::codec::Unsound;
use super::sound::ensure;
use crate::film::layout::{LANES, TILE_BLOCKS};
use crate::fold::transport::{
    BlockStart, HighlightGroup, HighlightList, HighlightPart, Highlights, TransportTile,
};
use crate::fold::trie::Trie;
use crate::scene::factor::Kind;

/// Whether highlight lists belong to a sound tile, whose terms are of a sound trie.
pub(super) fn check(lists: &Highlights, tile: &TransportTile, trie: &Trie) -> Result<(), Unsound> {
    groups(lists)?;
    for part in lists.parts() {
        check_part(&part, tile, trie)?;
    }
    // A filter's weights may be below 0.
    let sound = |weights: &[f32]| weights.iter().fold(true, |all, w| all & w.is_finite());
    ensure(lists.weights.chunks(LANES).all(sound), "a weight is not finite")
}

const INF: f32 = f32::INFINITY;

/// Whether the groups share out all of every array.
fn groups(lists: &Highlights) -> Result<(), Unsound> {
    let Highlights { groups, lists, counts, logarithms, weights } = lists;
    let key = |group: &HighlightGroup| (group.material, group.weighted);
    ensure(groups.is_sorted_by(|a, b| key(a) < key(b)), "groups are out of order")?;
    let sum = |of: &dyn Fn(&HighlightGroup) -> u32| -> u64 {
        groups.iter().map(|group| u64::from(of(group))).sum()
    };
    ensure(sum(&|g| g.lists) == lists.len() as u64, "groups of another number of lists")?;
    ensure(sum(&|g| g.lanes) == counts.len() as u64, "groups of another number of lanes")?;
    ensure(sum(&|g| g.samples) == logarithms.len() as u64, "groups of other samples")?;
    let weighted = sum(&|g| if g.weighted { g.samples } else { 0 });
    ensure(weighted == weights.len() as u64, "groups of another number of weights")
}

/// Whether the lists of a group share out its lanes and samples, and stand block by block.
fn check_part(part: &HighlightPart, tile: &TransportTile, trie: &Trie) -> Result<(), Unsound> {
    let HighlightPart { material, lists, mut counts, mut logarithms, weights: _ } = *part;
    let mut block = 0;
    for list in lists {
        let lanes = list.mask.count_ones() as usize;
        ensure(lanes > 0, "a highlight of no lane")?;
        let own;
        (own, counts) =
            counts.split_at_checked(lanes).ok_or("lists of more lanes than there are")?;
        ensure(own.iter().all(|&count| count > 0), "a lane without samples")?;
        ensure(list.full == 0 || own == [list.full; LANES], "a list that is not full")?;
        let count = own.iter().map(|&count| usize::from(count)).sum();
        let samples;
        (samples, logarithms) =
            logarithms.split_at_checked(count).ok_or("lists of more samples than there are")?;
        peak(list.peak, samples)?;
        block = target(list, material, tile, trie, block)?;
    }
    ensure(counts.is_empty(), "lanes of no list")?;
    ensure(logarithms.is_empty(), "samples of no list")
}

/// Whether the greatest of some logarithms is this: where its power is flushed to 0, all are.
fn peak(peak: f32, logarithms: &[f32]) -> Result<(), Unsound> {
    // No short cut, so that the loop vectorises.
    let (mut below, mut reached) = (true, false);
    for l in logarithms {
        below &= *l <= peak && *l > -INF;
        reached |= *l == peak;
    }
    ensure(peak <= 0.0, "a cosine above 1")?;
    ensure(below && reached, "a list has another peak")
}

/// The block in which a highlight's coefficients stand, where its list says: `block` or one after it.
fn target(
    list: &HighlightList,
    material: u16,
    tile: &TransportTile,
    trie: &Trie,
    block: usize,
) -> Result<usize, Unsound> {
    let HighlightList { at, mask, full: _, peak: _ } = *list;
    let single = at & HighlightList::SINGLE != 0;
    let start = |at: &BlockStart| if single { at.single } else { at.plane };
    let from = at & !HighlightList::SINGLE;
    let after = tile.starts.partition_point(|begin| start(begin) <= from);
    ensure(after <= TILE_BLOCKS, "a highlight of nothing")?;
    ensure(after > block, "highlights are not block by block")?;
    let entry = if single {
        let to = from + mask.count_ones();
        ensure(to <= tile.starts[after].single, "a highlight of several blocks")?;
        let singles = &tile.singles[from as usize..to as usize];
        let lanes = singles.iter().fold(0, |lanes, s| lanes | 1u16 << s.lane());
        let one = singles.iter().all(|s| s.entry() == singles[0].entry());
        ensure(lanes == mask && one, "a highlight of other lanes")?;
        singles[0].entry()
    } else {
        tile.entries[from as usize] as usize
    };
    // Where a texel colours it, each channel has a term of its own.
    let node = &trie.nodes()[tile.terms[entry] as usize];
    let factor = match node.factor.kind() {
        Kind::Channel => trie.nodes()[node.parent as usize].factor,
        _ => node.factor,
    };
    let lit = matches!(factor.kind(), Kind::Specular | Kind::Through);
    ensure(lit && factor.index() == usize::from(material), "a highlight of another term")?;
    Ok(after - 1)
}

#[cfg(test)]
mod tests {
    use super::super::sound::tests::{Case, hold, session};
    use super::*;

    /// Lists, and where they stand.
    #[derive(Clone)]
    struct Lit {
        tile: TransportTile,
        lists: Highlights,
    }

    /// Some tile's, with full lists, single coefficients and groups of both kinds.
    fn lit() -> (Lit, Trie) {
        let transport = session([96, 96], 1).transport().clone();
        let full = |tile: &&std::sync::Arc<TransportTile>| {
            let lists = tile.highlights.as_ref().unwrap();
            lists.lists.iter().filter(|list| list.full > 0).count()
        };
        let tile = transport.tiles.iter().max_by_key(full).unwrap();
        let lists = tile.highlights.clone().unwrap();
        (Lit { tile: TransportTile::clone(tile), lists }, transport.trie)
    }

    /// The two lists of a group that stand farthest from each other, both of whole blocks.
    fn ends(lists: &mut Highlights) -> [usize; 2] {
        let Highlights { groups, lists, .. } = lists;
        let mut at = 0;
        let ends = groups.iter().map(|group| {
            let own = at..at + group.lists as usize;
            at = own.end;
            let mut planes = own.filter(|&i| lists[i].at & HighlightList::SINGLE == 0);
            let first = planes.next()?;
            Some([first, planes.next_back()?])
        });
        ends.flatten().max_by_key(|[a, b]| lists[*b].at - lists[*a].at).unwrap()
    }

    fn single(lists: &mut Highlights) -> &mut HighlightList {
        let is_single = |list: &&mut HighlightList| list.at & HighlightList::SINGLE != 0;
        lists.lists.iter_mut().rfind(is_single).unwrap()
    }

    fn full(lists: &mut Highlights) -> &mut HighlightList {
        lists.lists.iter_mut().find(|list| list.full > 0).unwrap()
    }

    fn hold_all(cases: &[Case<Lit>]) {
        let (lit, trie) = lit();
        hold(&lit, cases, |lit| check(&lit.lists, &lit.tile, &trie));
    }

    #[test]
    fn faults_of_groups_are_found() {
        hold_all(&[
            ("groups are out of order", |l| l.lists.groups.swap(0, 1)),
            ("groups are out of order", |l| {
                let group = HighlightGroup { lists: 0, lanes: 0, samples: 0, ..l.lists.groups[0] };
                l.lists.groups.insert(0, group);
            }),
            ("groups of another number of lists", |l| l.lists.groups[0].lists += 1),
            ("groups of another number of lists", |l| l.lists.groups[1].lists = u32::MAX),
            ("groups of another number of lanes", |l| l.lists.groups[0].lanes -= 1),
            ("groups of other samples", |l| l.lists.groups[1].samples += 1),
            ("groups of other samples", |l| l.lists.logarithms.push(-1.0)),
            ("groups of another number of weights", |l| _ = l.lists.weights.pop()),
            ("groups of another number of weights", |l| l.lists.weights.push(1.0)),
        ]);
    }

    #[test]
    fn faults_between_groups_are_found() {
        hold_all(&[
            ("lists of more lanes than there are", |l| {
                l.lists.groups[0].lanes -= 1;
                l.lists.groups[1].lanes += 1;
            }),
            ("lanes of no list", |l| {
                l.lists.groups[0].lists -= 1;
                l.lists.groups[1].lists += 1;
            }),
            ("lists of more samples than there are", |l| {
                let [from, to] = alike(&l.lists);
                l.lists.groups[from].samples -= 1;
                l.lists.groups[to].samples += 1;
            }),
            ("samples of no list", |l| {
                let [from, to] = alike(&l.lists);
                l.lists.groups[from].samples += 1;
                l.lists.groups[to].samples -= 1;
            }),
        ]);
    }

    /// Two groups without weights.
    fn alike(lists: &Highlights) -> [usize; 2] {
        let groups = lists.groups.iter().enumerate();
        let mut plain = groups.filter(|(_, group)| !group.weighted).map(|(index, _)| index);
        [(); 2].map(|()| plain.next().unwrap())
    }

    #[test]
    fn faults_of_lists_are_found() {
        hold_all(&[
            ("a highlight of no lane", |l| l.lists.lists[0].mask = 0),
            ("a lane without samples", |l| l.lists.counts[0] = 0),
            ("a list that is not full", |l| full(&mut l.lists).full += 1),
            ("a list that is not full", |l| single(&mut l.lists).full = 1),
            ("a list has another peak", |l| l.lists.lists[0].peak /= 2.0),
            ("a list has another peak", |l| l.lists.lists[0].peak *= 2.0),
            ("a list has another peak", |l| l.lists.logarithms[9] = 0.1),
            ("a list has another peak", |l| l.lists.logarithms[9] = f32::NAN),
            ("a list has another peak", |l| l.lists.logarithms[9] = -INF),
            ("a cosine above 1", |l| l.lists.lists[0].peak = 0.1),
            ("a cosine above 1", |l| l.lists.lists[0].peak = f32::NAN),
            ("a weight is not finite", |l| l.lists.weights[9] = INF),
            ("a weight is not finite", |l| l.lists.weights[9] = f32::NAN),
        ]);
    }

    #[test]
    fn faults_of_where_lists_stand_are_found() {
        hold_all(&[
            ("a highlight of nothing", |l| l.lists.lists[0].at = u32::MAX >> 1),
            ("a highlight of nothing", |l| l.lists.lists[0].at = u32::MAX),
            ("highlights are not block by block", |l| {
                let [a, b] = ends(&mut l.lists);
                let lists = &mut l.lists.lists;
                (lists[a].at, lists[b].at) = (lists[b].at, lists[a].at);
            }),
            ("a highlight of several blocks", |l| {
                let lists = &mut l.lists;
                let at = single(lists).at & !HighlightList::SINGLE;
                let after = l.tile.starts.partition_point(|start| start.single <= at);
                single(lists).at = (l.tile.starts[after].single - 1) | HighlightList::SINGLE;
            }),
            ("a highlight of other lanes", |l| {
                let list = single(&mut l.lists);
                list.mask = list.mask.rotate_left(1);
            }),
            ("a highlight of another term", |l| {
                let group = l.lists.groups.last_mut().unwrap();
                group.material += 1;
            }),
            ("a highlight of another term", |l| {
                let list = full(&mut l.lists);
                let first = list.at as usize;
                l.tile.entries[first] = 0;
            }),
        ]);
    }
}
