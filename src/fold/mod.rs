//! Folds ray trees into the transport matrix: collects, per pixel, all that has the same product
//! of parameters.

pub mod highlight;
mod lists;
pub mod merge;
mod sign;
pub mod stay;
#[cfg(test)]
mod tests;
mod tones;
pub mod transport;
pub mod trie;

use highlight::HighlightPower;
use lists::{HighlightLists, HighlightSample};
use stay::{GONE, Stay, Staying};
use tones::MISSED;
use transport::{
    BlockStart, Frontier, FrontierMark, HighlightList, Plane, SPARSE_LANES, Single, TransportTile,
};
use trie::{Marks, ROOT, Trie};

use crate::film::layout::LANES;
use crate::forest::tree::{BLOCKED, Branch, LightHit, Node, Reader};
use crate::geometry::Tone;
use crate::scene::factor::{Factor, Kind};
use crate::scene::model::Peak;

/// Folds the blocks of one tile after another; one per thread, its memory reused.
///
/// The product of a term stands in this order: the path's factors from the eye on, then, for light
/// from a lamp, the light, the materials its shadow ray crossed (rising), and what the surface does
/// with it (diffuse or highlight).
#[derive(Default)]
pub struct Folder {
    trie: Trie,
    memo: Vec<Lookup>,
    position: usize,
    /// Paths still to be followed, with their geometric weights; with [`MISSED`] those whose ray saw a
    /// background that is not one colour.
    stack: Vec<(u32, f32)>,
    /// Per trie id the stamp of the block that last used it and its slot there.
    slots: Vec<(u32, u32)>,
    stamp: u32,
    /// Trie id and coefficients of every slot, block after block.
    ids: Vec<u32>,
    planes: Vec<Plane>,
    masks: Vec<u16>,
    /// Where a slot's coefficients were stored; filled as the tile is finished.
    places: Vec<u32>,
    starts: Vec<u32>,
    /// Whether samples may have weights below 0.
    signed: bool,
    highlights: Vec<HighlightSample>,
    highlight_starts: Vec<u32>,
    /// Where branches ended, block after block; `slots` finds them too.
    edges: Vec<Edge>,
    edge_starts: Vec<u32>,
    /// Materials that a shadow ray crossed, rising.
    filters: Vec<u16>,
    order: Vec<u32>,
    sorted: Vec<HighlightSample>,
    lists: HighlightLists,
    power: HighlightPower,
    staying: Staying,
    /// Blocks of the tile of which some rows stay, in the order in which they are folded.
    staying_blocks: Vec<usize>,
}

/// What a slot's coefficients are made of, or where coefficients that stay stand in the old tile.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Row {
    Slot(u32),
    Plane(u32),
    Singles(u32, u32),
}

/// An answer of the trie: most trees look up what the tree before them did, in the same order.
#[derive(Clone, Copy)]
struct Lookup {
    parent: u32,
    factor: Factor,
    id: u32,
    /// The slot of a term, if `stamp` is the present block's.
    slot: u32,
    stamp: u32,
}

/// A term of the frontier in a block, by its id in the tile's own trie.
#[derive(Clone, Copy)]
struct Edge {
    id: u32,
    mask: u16,
    rays: u16,
}

/// Which factors stand for a scene's solids and lights.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Names {
    /// Per solid its material.
    pub materials: Vec<u16>,
    /// Per light its place in the list of factors: rising, but not without gaps.
    pub lights: Vec<u16>,
}

impl Names {
    /// Of solids with these materials, and of a number of lights without gaps.
    pub fn new(materials: &[u16], lights: usize) -> Names {
        Names { materials: materials.to_vec(), lights: (0..).take(lights).collect() }
    }
}

/// A tile just folded: its part of the matrix in ids of its own trie, and that trie.
pub struct Folded<'a> {
    /// The tile's terms; `tile.terms` holds ids of this trie.
    pub trie: &'a Trie,
    /// Its rows.
    pub tile: TransportTile,
}

impl Folder {
    /// Begins a tile.
    pub fn begin_tile(&mut self) {
        self.trie.clear();
        self.memo.clear();
        self.slots.clear();
        self.stamp = 1;
        self.ids.clear();
        self.planes.clear();
        self.masks.clear();
        self.places.clear();
        self.starts.clear();
        self.starts.push(0);
        self.signed = false;
        self.highlights.clear();
        self.highlight_starts.clear();
        self.highlight_starts.push(0);
        self.edges.clear();
        self.edge_starts.clear();
        self.edge_starts.push(0);
        self.staying_blocks.clear();
    }

    /// Begins a tile of which some terms stay as they are in `old`, whose ids are of `trie`.
    pub fn begin_part(&mut self, old: &TransportTile, trie: &Trie, stay: &Stay) {
        self.begin_tile();
        self.staying.begin(old, trie, stay, &mut self.trie);
        for &id in self.staying.terms.iter().filter(|id| **id != GONE) {
            self.trie.mark(id, Marks::TERM);
        }
    }

    /// Folds what was grown again of the trees of a block, `block` of the tile `old`: all samples of
    /// every term that does not stay. A camera ray that left the scene shows what it showed.
    pub fn block_part(
        &mut self,
        reader: &mut Reader,
        counts: &[u32; LANES],
        names: &Names,
        (old, block): (&TransportTile, usize),
    ) {
        self.signed |= reader.is_weighted();
        for (lane, count) in counts.iter().enumerate() {
            for _ in 0..*count {
                self.position = 0;
                if reader.sample() {
                    self.tree(reader, lane, names);
                }
            }
        }
        for &FrontierMark { entry, mask, rays } in old.frontier.block(block) {
            let id = self.staying.frontier[entry as usize];
            if id != GONE {
                self.trie.mark(id, self.trie.nodes()[id as usize].end_mark());
                self.edges.push(Edge { id, mask, rays });
            }
        }
        self.staying_blocks.push(block);
        self.end_block();
    }

    /// Folds the trees of a block; `counts` has the number of samples of every lane, 0 without a pixel.
    pub fn block(&mut self, reader: &mut Reader, counts: &[u32; LANES], names: &Names) {
        self.signed |= reader.is_weighted();
        for (lane, count) in counts.iter().enumerate() {
            for _ in 0..*count {
                self.position = 0;
                if reader.sample() {
                    self.tree(reader, lane, names);
                } else {
                    self.sky(reader, ROOT, lane, reader.weight());
                }
            }
        }
        self.end_block();
    }

    /// Notes where the block ends, and in which lanes its terms occur; a highlight is known by its
    /// samples.
    fn end_block(&mut self) {
        self.stamp += 1;
        sign::note_lanes(&self.planes, self.signed, &mut self.masks);
        let from = self.highlight_starts[self.highlight_starts.len() - 1] as usize;
        for sample in &self.highlights[from..] {
            self.masks[sample.slot as usize] |= 1 << sample.lane;
        }
        self.places.resize(self.ids.len(), 0);
        self.starts.push(self.ids.len() as u32);
        self.highlight_starts.push(self.highlights.len() as u32);
        self.edge_starts.push(self.edges.len() as u32);
    }

    /// Adds the terms of one tree to a lane.
    #[inline(always)]
    fn tree(&mut self, reader: &mut Reader, lane: usize, names: &Names) {
        self.stack.push((ROOT, reader.weight()));
        let varied = !reader.is_sky_even();
        while let Some((path, weight)) = self.stack.pop() {
            if path & MISSED != 0 {
                self.sky(reader, path & !MISSED, lane, weight);
                continue;
            }
            let node = reader.node();
            let tone = if node.toned { Some(reader.tone()) } else { None };
            if let (Some(tone), true) = (tone, node.whole) {
                self.toned(path, (Kind::Ambient, node.material), tone, lane, weight);
            } else if node.whole {
                let ambient = Factor::new(Kind::Ambient, node.material, node.slot);
                self.add(path, ambient, lane, weight);
            }
            for _ in 0..node.lights {
                let (hit, crossed) = reader.light();
                self.light((path, weight), (node, tone), (hit, crossed), lane, names);
            }
            let [mirrored, passed] = node.weights().map(|w| w * weight);
            let mirror = if node.ends.total() { Kind::TotalReflect } else { Kind::Reflect };
            let transmit = Factor::new(Kind::Transmit, node.material, 0);
            self.branch((path, passed), (node.ends.transmitted(), varied), transmit, lane);
            let reflect = Factor::new(mirror, node.material, 0);
            self.branch((path, mirrored), (node.ends.reflected(), varied), reflect, lane);
        }
    }

    #[inline(always)]
    fn light(
        &mut self,
        (path, weight): (u32, f32),
        (node, tone): (&Node, Option<Tone>),
        (hit, crossed): (&LightHit, &[u32]),
        lane: usize,
        names: &Names,
    ) {
        if hit.crossed == BLOCKED {
            let material = names.materials[crossed[0] as usize];
            let witness = self.find(path, Factor::new(Kind::Shadow, material, 0));
            self.edge(witness, lane, Marks::WITNESS);
            return;
        }
        if hit.n_dot_l <= 0.0 && !hit.is_behind() {
            return;
        }
        let light = names.lights[hit.light as usize];
        let mut arriving = self.find(path, Factor::new(Kind::Light, light, 0));
        if !crossed.is_empty() {
            arriving = self.filtered(arriving, crossed, names);
        }
        if let Some(tone) = tone
            && !hit.is_behind()
        {
            return self.toned_light(arriving, (node, tone), hit, lane, weight);
        }
        let highlight = if hit.is_behind() {
            Factor::new(Kind::Through, node.material, 0)
        } else {
            let diffuse = Factor::new(Kind::Diffuse, node.material, node.slot);
            self.add(arriving, diffuse, lane, hit.n_dot_l * weight);
            Factor::new(Kind::Specular, node.material, node.slot)
        };
        if hit.weight > 0.0 {
            let slot = self.term(arriving, highlight);
            self.highlights.push(HighlightSample {
                slot,
                material: node.material,
                lane: lane as u16,
                angle: hit.angle,
                weight: hit.weight * weight,
            });
        }
    }

    /// `arriving` times what the solids let through, by rising material.
    fn filtered(&mut self, mut arriving: u32, crossed: &[u32], names: &Names) -> u32 {
        let mut filters = std::mem::take(&mut self.filters);
        filters.clear();
        filters.extend(crossed.iter().map(|&solid| names.materials[solid as usize]));
        filters.sort_unstable();
        for &material in &filters {
            arriving = self.find(arriving, Factor::new(Kind::Shadow, material, 0));
        }
        self.filters = filters;
        arriving
    }

    /// Notes that a branch or a shadow ray ended at a term.
    #[inline(always)]
    fn edge(&mut self, id: u32, lane: usize, marks: Marks) {
        if self.slots.len() <= id as usize {
            self.slots.resize(self.trie.nodes().len(), (0, 0));
        }
        let (stamp, slot) = &mut self.slots[id as usize];
        if *stamp != self.stamp {
            (*stamp, *slot) = (self.stamp, self.edges.len() as u32);
            self.edges.push(Edge { id, mask: 0, rays: 0 });
            self.trie.mark(id, marks);
        }
        let edge = &mut self.edges[*slot as usize];
        edge.mask |= 1 << lane;
        edge.rays = edge.rays.saturating_add(1);
    }

    #[inline(always)]
    fn branch(
        &mut self,
        (path, weight): (u32, f32),
        (branch, varied_sky): (Branch, bool),
        factor: Factor,
        lane: usize,
    ) {
        // No parameter brings a faint branch to life, or one that went astray: they are no terms of the
        // frontier.
        if matches!(branch, Branch::Absent | Branch::Faint | Branch::Astray) {
            return;
        }
        let child = self.find(path, factor);
        match branch {
            Branch::Grown => self.stack.push((child, weight)),
            // What it saw stands in the order in which branches were followed.
            Branch::Missed if varied_sky => self.stack.push((child | MISSED, weight)),
            Branch::Missed => self.background(child, lane, weight),
            _ => self.edge(child, lane, Marks::FRONTIER),
        }
    }

    #[inline(always)]
    fn background(&mut self, path: u32, lane: usize, weight: f32) {
        self.add(path, Factor::new(Kind::Background, 0, 0), lane, weight);
    }

    /// The id of `parent · factor`, first guessed from the tree before.
    #[inline(always)]
    fn find(&mut self, parent: u32, factor: Factor) -> u32 {
        match self.memo.get(self.position) {
            Some(known) if known.parent == parent && known.factor == factor => {
                self.position += 1;
                known.id
            }
            _ => self.look_up(parent, factor),
        }
    }

    /// The slot of the term `parent · factor` in the present block.
    #[inline(always)]
    fn term(&mut self, parent: u32, factor: Factor) -> u32 {
        let stamp = self.stamp;
        match self.memo.get(self.position) {
            Some(k) if k.parent == parent && k.factor == factor && k.stamp == stamp => {
                self.position += 1;
                k.slot
            }
            _ => self.find_slot(parent, factor),
        }
    }

    fn find_slot(&mut self, parent: u32, factor: Factor) -> u32 {
        let at = self.position;
        let id = self.find(parent, factor);
        let slot = self.slot(id);
        (self.memo[at].slot, self.memo[at].stamp) = (slot, self.stamp);
        slot
    }

    fn look_up(&mut self, parent: u32, factor: Factor) -> u32 {
        let id = self.trie.intern(parent, factor);
        let lookup = Lookup { parent, factor, id, slot: 0, stamp: 0 };
        match self.memo.get_mut(self.position) {
            Some(known) => *known = lookup,
            None => self.memo.push(lookup),
        }
        self.position += 1;
        id
    }

    /// The slot of an id in the present block, made if it is new there.
    fn slot(&mut self, id: u32) -> u32 {
        if self.slots.len() <= id as usize {
            self.slots.resize(self.trie.nodes().len(), (0, 0));
        }
        let (stamp, slot) = &mut self.slots[id as usize];
        if *stamp != self.stamp {
            (*stamp, *slot) = (self.stamp, self.ids.len() as u32);
            self.ids.push(id);
            self.planes.push(sign::empty(self.signed));
            self.trie.mark(id, Marks::TERM);
        }
        *slot
    }

    #[inline(always)]
    fn add(&mut self, parent: u32, factor: Factor, lane: usize, value: f32) {
        let slot = self.term(parent, factor);
        self.planes[slot as usize].0[lane & (LANES - 1)] += value;
    }

    /// Ends a tile: puts its terms in canonical order and computes its highlights.
    ///
    /// `weight` is that of one sample; `peaks` has that of every material.
    pub fn finish_tile(&mut self, weight: f32, peaks: &[Option<Peak>]) -> Folded<'_> {
        self.finish(weight, peaks, None)
    }

    /// Ends a tile that [`Folder::begin_part`] began, with what stays of `old`.
    ///
    /// # Panics
    /// If the highlight lists of `old` were released.
    pub fn finish_part(
        &mut self,
        weight: f32,
        peaks: &[Option<Peak>],
        old: &TransportTile,
    ) -> Folded<'_> {
        self.finish(weight, peaks, Some(old))
    }

    fn finish(
        &mut self,
        weight: f32,
        peaks: &[Option<Peak>],
        old: Option<&TransportTile>,
    ) -> Folded<'_> {
        let ranks = self.trie.canonical_ranks();
        let mut tile = TransportTile::default();
        let local = self.dictionary(&ranks, &mut tile);
        self.lists.clear();
        tile.starts.reserve_exact(self.starts.len());
        tile.starts.push(BlockStart::default());
        let lanes = self.masks.iter().map(|m| m.count_ones());
        let (few, many): (Vec<u32>, Vec<u32>) = lanes.partition(|&lanes| lanes <= SPARSE_LANES);
        tile.entries.reserve_exact(many.len());
        tile.planes.reserve_exact(many.len());
        tile.singles.reserve_exact(few.iter().sum::<u32>() as usize);
        let mut order: Vec<(u32, Row)> = Vec::new();
        tile.frontier = self.frontier(&ranks);
        for block in 0..self.starts.len() - 1 {
            let slots = self.starts[block]..self.starts[block + 1];
            order.clear();
            let row = |slot: u32| (local[self.ids[slot as usize] as usize], Row::Slot(slot));
            order.extend(slots.map(row));
            if let Some(old) = old {
                self.rows_that_stay(old, self.staying_blocks[block], &local, &mut order);
            }
            order.sort_unstable();
            for &(entry, row) in &order {
                match (row, old) {
                    (Row::Slot(slot), _) => {
                        let at = self.store(entry, slot as usize, weight, &mut tile);
                        self.places[slot as usize] = at;
                    }
                    (row, Some(old)) => self.keep(entry, row, old, &mut tile),
                    (_, None) => {}
                }
            }
            tile.starts.push(BlockStart {
                plane: tile.planes.len() as u32,
                single: tile.singles.len() as u32,
            });
            self.sort_highlights(block);
        }
        let mut highlights = self.lists.group();
        self.power.take_logarithms(&mut highlights, peaks);
        self.power.fold(&mut tile, &highlights, peaks, weight);
        tile.highlights = Some(match old.map(|old| old.highlights.as_ref()) {
            None => highlights,
            Some(old) => self.staying.with_lists(old.expect("lists are kept"), &highlights),
        });
        Folded { trie: &self.trie, tile }
    }

    /// Adds a block's rows that stay, by their entries in the new dictionary.
    fn rows_that_stay(
        &self,
        old: &TransportTile,
        block: usize,
        local: &[u32],
        order: &mut Vec<(u32, Row)>,
    ) {
        let entry = |term: usize| match self.staying.terms[term] {
            GONE => None,
            id => Some(local[id as usize]),
        };
        let (rows, start) = (old.block(block), old.starts[block]);
        for (&term, at) in rows.entries.iter().zip(start.plane..) {
            order.extend(entry(term as usize).map(|entry| (entry, Row::Plane(at))));
        }
        let mut at = start.single;
        for same in rows.singles.chunk_by(|a, b| a.entry() == b.entry()) {
            let end = at + same.len() as u32;
            let row = Row::Singles(at, end);
            order.extend(entry(same[0].entry()).map(|entry| (entry, row)));
            at = end;
        }
    }

    /// Stores a row that stays, and notes where.
    fn keep(&mut self, entry: u32, row: Row, old: &TransportTile, tile: &mut TransportTile) {
        match row {
            Row::Slot(_) => {}
            Row::Plane(at) => {
                self.staying.planes[at as usize] = tile.planes.len() as u32;
                tile.entries.push(entry);
                tile.planes.push(old.planes[at as usize]);
            }
            Row::Singles(from, to) => {
                self.staying.singles[from as usize] = tile.singles.len() as u32;
                let singles = &old.singles[from as usize..to as usize];
                let single = |s: &Single| Single::new(entry, s.lane(), s.coefficient);
                tile.singles.extend(singles.iter().map(single));
            }
        }
    }

    /// Stores a slot's coefficients as a plane or one by one; where they are.
    fn store(&self, entry: u32, slot: usize, weight: f32, tile: &mut TransportTile) -> u32 {
        let Plane(sums) = sign::settled(self.planes[slot], self.signed);
        let mask = u32::from(self.masks[slot]);
        if mask.count_ones() > SPARSE_LANES {
            tile.entries.push(entry);
            tile.planes.push(Plane(sums.map(|c| c * weight)));
            return tile.planes.len() as u32 - 1;
        }
        let at = tile.singles.len() as u32;
        let lanes = (0..LANES).filter(|i| mask >> i & 1 != 0);
        tile.singles.extend(lanes.map(|i| Single::new(entry, i, sums[i] * weight)));
        at | HighlightList::SINGLE
    }

    /// Where branches ended, in canonical order.
    fn frontier(&self, ranks: &[u32]) -> Frontier {
        let mut terms: Vec<u32> = self.edges.iter().map(|edge| edge.id).collect();
        terms.sort_unstable_by_key(|&id| ranks[id as usize]);
        terms.dedup();
        terms.shrink_to_fit();
        let mut local = vec![0; self.trie.nodes().len()];
        for (&id, index) in terms.iter().zip(0u32..) {
            local[id as usize] = index;
        }
        let mut marks: Vec<FrontierMark> = Vec::with_capacity(self.edges.len());
        for ends in self.edge_starts.windows(2) {
            let first = marks.len();
            marks.extend(self.edges[ends[0] as usize..ends[1] as usize].iter().map(|edge| {
                let Edge { id, mask, rays } = *edge;
                FrontierMark { entry: local[id as usize], mask, rays }
            }));
            marks[first..].sort_unstable_by_key(|mark| mark.entry);
        }
        Frontier { terms, starts: self.edge_starts.clone(), marks }
    }

    /// Fills `tile.terms` with the ids that have coefficients, in canonical order, and gives for
    /// every id its index there.
    fn dictionary(&self, ranks: &[u32], tile: &mut TransportTile) -> Vec<u32> {
        let marked = self.trie.nodes().iter().zip(0u32..).filter(|(n, _)| n.marks.has(Marks::TERM));
        tile.terms.extend(marked.map(|(_, id)| id));
        tile.terms.sort_unstable_by_key(|&id| ranks[id as usize]);
        tile.terms.shrink_to_fit();
        let mut local = vec![0; self.trie.nodes().len()];
        for (id, index) in tile.terms.iter().zip(0u32..) {
            local[*id as usize] = index;
        }
        local
    }
}
