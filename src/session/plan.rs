//! Which pixels an edit concerns: found in the matrix and the frontier, without a ray.

use std::collections::BTreeMap;
use std::sync::Arc;

use rayon::prelude::*;

use super::Session;
use crate::film::layout::{LANES, Layout, TILE_BLOCKS};
use crate::film::pixels::PixelSet;
use crate::fold::merge::Blocks;
use crate::fold::transport::TransportTile;
use crate::fold::trie::Trie;
use crate::forest::scope::Scope;
use crate::scene::Scene;
use crate::scene::change::Change;
use crate::scene::factor::{Factor, FactorValues, Kind};

/// The least work that makes the picture exact where shading alone does not.
#[derive(Clone, Debug)]
pub struct Plan {
    /// What asks for it.
    pub reason: String,
    /// The pixels whose trees are read again, in the order of the tiles. No tile is empty.
    pub tiles: Vec<PlanTile>,
    /// Whether rays may have to be cast; otherwise what is kept answers all of them.
    pub casts: bool,
    /// How many of the tiles have no kept trees: there every ray is cast.
    pub released: usize,
    /// The terms that get other coefficients, where the rest of the matrix stays: then no more of the
    /// kept trees is read than leads to them.
    pub scope: Option<Scope>,
    /// The pixels whose first samples may see something else, where sampling is adaptive: from them
    /// follows how many samples they and their neighbours get, all of which are among `tiles`.
    pub unsettled: Option<Arc<PixelSet>>,
}

/// Pixels of a tile.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PlanTile {
    /// Index of the tile.
    pub tile: usize,
    /// Per block bit i for lane i.
    pub lanes: Box<[u16; TILE_BLOCKS]>,
    /// How many branches and shadow rays begin in them that come alive.
    pub rays: u64,
}

impl Plan {
    /// How many pixels there are.
    pub fn pixels(&self) -> u64 {
        self.tiles.iter().map(PlanTile::pixels).sum()
    }

    /// How many branches and shadow rays come alive: at least so many rays are cast.
    pub fn rays(&self) -> u64 {
        self.tiles.iter().map(|tile| tile.rays).sum()
    }
}

impl PlanTile {
    /// How many pixels there are.
    pub fn pixels(&self) -> u64 {
        self.lanes.iter().map(|lanes| u64::from(lanes.count_ones())).sum()
    }

    /// The blocks that have any.
    pub fn blocks(&self) -> Blocks {
        let marked = self.lanes.iter().enumerate().filter(|(_, lanes)| **lanes != 0);
        marked.fold(0, |blocks, (block, _)| blocks | 1 << block)
    }
}

/// What is looked for, by the ids of the picture's terms.
pub(super) struct Concern {
    pub(super) layout: Layout,
    /// Terms in front of which a coefficient stands.
    pub(super) terms: Vec<Sought>,
    /// The same, in tiles without highlight lists.
    pub(super) unlisted: Vec<Sought>,
    /// Terms at which branches or shadow rays end.
    pub(super) frontier: Vec<bool>,
}

/// How the pixels of a term are found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Sought {
    /// Not at all.
    No,
    /// By their coefficients.
    Lanes,
    /// With all of a block that has the term: a highlight's coefficient may be 0 for this exponent.
    Block,
}

impl Sought {
    /// How the pixels of a term that ends in such a factor are found.
    pub(super) fn of(kind: Kind) -> Sought {
        if kind == Kind::Through { Sought::Block } else { Sought::Lanes }
    }
}

impl Session {
    /// What is to be grown again to make `scene` the session's; `None` if shading is enough.
    ///
    /// # Panics
    /// If the change asks for everything.
    pub(super) fn plan(&mut self, scene: &Scene, change: &Change) -> Option<Plan> {
        assert!(!change.everything, "only a trace does everything");
        let mut casts = change.casts;
        let mut reason = change.moves_rays.map(|what| match casts {
            true => format!("{what} moves rays"),
            false => format!("{what} is read from the kept trees"),
        });
        let trie = &self.transport.trie;
        let count = trie.nodes().len();
        let (mut nodes, stale) = (change.nodes.clone(), self.stale(scene, change));
        let gone = self.gone(change);
        if !gone.is_empty() {
            reason.get_or_insert_with(|| "a material is gone".into());
            nodes.extend(gone);
        }
        if !stale.is_empty() {
            reason.get_or_insert_with(|| "ior or a lobe moves rays".into());
            casts |= stale.iter().any(|(_, leads)| *leads);
            nodes.extend(stale.into_iter().map(|(before, _)| before));
        }
        let seeks = !nodes.is_empty() || change.shadows || change.sky;
        let mut concern = Concern {
            layout: self.transport.layout,
            terms: vec![Sought::No; if seeks { count } else { 0 }],
            unlisted: Vec::new(),
            frontier: vec![false; count],
        };
        if !concern.terms.is_empty() {
            mark_nodes(trie, &nodes, change, &mut concern);
        }
        let lists_missing = self.transport.tiles.iter().any(|tile| tile.highlights.is_none());
        if !change.refold.is_empty() && lists_missing {
            reason.get_or_insert_with(|| "highlight lists were released for memory".into());
            concern.unlisted = self.terms_of(&change.refold, change);
        }
        let mut alive = Vec::new();
        if change.terms || change.moves_rays.is_some() {
            let factors = self.factors_after(scene, change);
            alive.extend(self.terms.uncovered(&self.program, &factors));
            alive.iter().for_each(|&id| concern.frontier[id as usize] = true);
            if let Some(&id) = alive.first() {
                casts = true;
                reason.get_or_insert_with(|| self.comes_alive(id));
            }
        }
        let unsettled = self.unsettled(scene, change, &concern, reason.is_some()).map(Arc::new);
        let mut tiles = concern.find(self);
        let mut scope = self.scope(change, nodes.is_empty(), &alive);
        if let Some(unsettled) = &unsettled {
            casts = true;
            reason.get_or_insert_with(|| "adaptive sampling is decided again".into());
            tiles = with_others(tiles, &unsettled.widened());
            scope = None;
        }
        let reason = reason?;
        let is_released = |plan: &&PlanTile| self.forest.tiles[plan.tile].is_none();
        let released = tiles.iter().filter(is_released).count();
        Some(Plan { reason, tiles, casts: casts || released > 0, released, scope, unsettled })
    }

    /// The terms that get other coefficients, if all of the change is either branches that come alive
    /// or lights that are new or elsewhere; `surfaces_stay` says whether no surface is read again.
    fn scope(&self, change: &Change, surfaces_stay: bool, alive: &[u32]) -> Option<Scope> {
        let names = change.keeps_materials() && !change.surfaces;
        if !surfaces_stay || !names || !change.refold.is_empty() {
            return None;
        }
        match (change.shadows, change.moves_rays, alive) {
            (true, _, []) => Some(Scope::of_lights(change.relit.clone())),
            (false, None, _) => {
                let factors = |&id: &u32| self.transport.trie.factors(id);
                Some(Scope::below(alive.iter().map(factors)))
            }
            _ => None,
        }
    }

    /// Old materials whose index of refraction or lobes show in the new scene, and with which the trees
    /// were not grown, because they did not matter; and whether rays go on from them.
    pub(super) fn stale(&self, scene: &Scene, change: &Change) -> Vec<(u16, bool)> {
        let pairs = scene.materials.iter().zip(&change.materials).enumerate();
        let stale = pairs.filter_map(|(i, (new, &before))| {
            let before = before?;
            let leads = !new.transmit.is_black() || new.weighs_branches();
            let differs = new.ior != self.iors[before as usize] && scene.ior_matters(i);
            let (lobes, matter) = (self.lobes[before as usize], new.lobes_matter());
            let blurs = (0..2).any(|k| matter[k] && new.lobes()[k] != lobes[k]);
            (differs || blurs).then_some((before, leads || blurs))
        });
        stale.collect()
    }

    /// Old materials that the new scene lacks, and of which the matrix speaks.
    fn gone(&self, change: &Change) -> Vec<u16> {
        if change.keeps_materials() && self.iors.len() == change.materials.len() {
            return Vec::new();
        }
        let mut gone: Vec<u16> = (0..).take(self.iors.len()).collect();
        gone.retain(|material| !change.materials.contains(&Some(*material)));
        let nodes = self.transport.trie.nodes();
        let speaks_of = |material: &u16| {
            let of = |index| index == usize::from(*material);
            nodes.iter().skip(1).any(|n| n.factor.is_of_material() && of(n.factor.index()))
        };
        gone.retain(speaks_of);
        gone
    }

    /// The value of every factor in the new scene, under the names of the matrix of today.
    pub(super) fn factors_after(&self, scene: &Scene, change: &Change) -> FactorValues {
        if change.keeps_materials() && self.iors.len() <= change.materials.len() {
            return FactorValues::new(scene);
        }
        let mut renamed = Scene { materials: self.scene.materials.clone(), ..scene.clone() };
        for (material, before) in scene.materials.iter().zip(&change.materials) {
            if let Some(before) = before {
                renamed.materials[*before as usize] = material.clone();
            }
        }
        FactorValues::new(&renamed)
    }

    /// The same with the lights that stand where they stood; the others are dark.
    pub(super) fn factors_ahead(&self, scene: &Scene, change: &Change) -> FactorValues {
        let mut kept = scene.clone();
        let mut before = change.lights.iter();
        kept.lights.retain(|_| before.next().is_some_and(Option::is_some));
        self.factors_after(&kept, change).with_lights_at(&self.light_places_after(change))
    }

    /// Marks the terms that have coefficients of some of the new scene's materials' surfaces.
    fn terms_of(&self, materials: &[u16], change: &Change) -> Vec<Sought> {
        let old: Vec<usize> = materials
            .iter()
            .filter_map(|&m| change.materials[m as usize].map(usize::from))
            .collect();
        let sought = |factor: Factor| match factor.kind() == Kind::Ambient {
            true if old.contains(&factor.index()) => Sought::Lanes,
            _ => Sought::No,
        };
        self.transport.trie.nodes().iter().map(|node| sought(node.factor)).collect()
    }

    fn comes_alive(&self, id: u32) -> String {
        let factors = self.transport.trie.factors(id);
        let names: Vec<_> = factors.iter().map(|f| f.describe(&self.scene)).collect();
        format!("the branch {} comes alive", names.join(" · "))
    }
}

/// Marks the terms of the old `materials`' surfaces, of shadow rays through them or stopped by them,
/// and, as the change asks for, those of every surface and of the background.
fn mark_nodes(trie: &Trie, materials: &[u16], change: &Change, concern: &mut Concern) {
    for (id, node) in trie.nodes().iter().enumerate().skip(1) {
        let (kind, index) = (node.factor.kind(), node.factor.index());
        let named = || materials.contains(&(index as u16));
        let surface = kind == Kind::Ambient && (change.shadows || named());
        let sky = kind == Kind::Background && change.sky;
        let shadow = kind == Kind::Shadow && named();
        let above = concern.terms[node.parent as usize];
        concern.terms[id] = match surface || sky || shadow || above != Sought::No {
            true => Sought::of(kind),
            false => Sought::No,
        };
        concern.frontier[id] |= shadow;
    }
}

/// The pixels of a plan and others.
fn with_others(tiles: Vec<PlanTile>, others: &PixelSet) -> Vec<PlanTile> {
    let mut tiles: BTreeMap<usize, PlanTile> = tiles.into_iter().map(|t| (t.tile, t)).collect();
    for (tile, lanes) in others.tiles() {
        let none = || PlanTile { tile, lanes: Box::new([0; TILE_BLOCKS]), rays: 0 };
        let own = tiles.entry(tile).or_insert_with(none);
        own.lanes.iter_mut().zip(lanes).for_each(|(own, lanes)| *own |= lanes);
    }
    tiles.into_values().collect()
}

impl Concern {
    /// Whether nothing is looked for.
    pub(super) fn is_nothing(&self) -> bool {
        let Concern { layout: _, terms, unlisted, frontier } = self;
        let mut sought = terms.iter().chain(unlisted);
        sought.all(|&sought| sought == Sought::No) && !frontier.contains(&true)
    }

    /// The pixels in a session's matrix.
    pub(super) fn find(&self, session: &Session) -> Vec<PlanTile> {
        let tiles = session.transport.tiles.par_iter().enumerate();
        let find = |(tile, part): (usize, &Arc<TransportTile>)| self.of_tile(tile, part);
        session.pool.install(|| tiles.filter_map(find).collect())
    }

    fn of_tile(&self, tile: usize, transport: &TransportTile) -> Option<PlanTile> {
        let mut lanes = Box::new([0u16; TILE_BLOCKS]);
        let mut rays = 0;
        let place = (self.layout, tile);
        if !self.terms.is_empty() {
            find_terms(transport, &self.terms, place, &mut lanes);
        }
        if !self.unlisted.is_empty() && transport.highlights.is_none() {
            find_terms(transport, &self.unlisted, place, &mut lanes);
        }
        let frontier = &transport.frontier;
        let known = frontier.terms.iter().any(|&id| self.frontier[id as usize]);
        if known {
            for (block, lanes) in lanes.iter_mut().enumerate() {
                for mark in frontier.block(block) {
                    if self.frontier[frontier.terms[mark.entry as usize] as usize] {
                        *lanes |= mark.mask;
                        rays += u64::from(mark.rays);
                    }
                }
            }
        }
        lanes.iter().any(|&lanes| lanes != 0).then_some(PlanTile { tile, lanes, rays })
    }
}

/// Adds the lanes in which coefficients of the marked terms stand.
fn find_terms(
    transport: &TransportTile,
    sought: &[Sought],
    (layout, tile): (Layout, usize),
    lanes: &mut [u16; TILE_BLOCKS],
) {
    let local: Vec<Sought> = transport.terms.iter().map(|&id| sought[id as usize]).collect();
    if local.iter().all(|&sought| sought == Sought::No) {
        return;
    }
    for (block, lanes) in lanes.iter_mut().enumerate() {
        let rows = transport.block(block);
        for (&entry, plane) in rows.entries.iter().zip(rows.planes) {
            // −0 is a coefficient, too.
            let set = |mask: u16, i: usize| mask | u16::from(plane.0[i].to_bits() != 0) << i;
            match local[entry as usize] {
                Sought::Lanes if *lanes != u16::MAX => *lanes |= (0..LANES).fold(0, set),
                Sought::Block => *lanes |= layout.lanes(tile, block),
                Sought::No | Sought::Lanes => {}
            }
        }
        for single in rows.singles.iter().filter(|s| local[s.entry()] != Sought::No) {
            *lanes |= 1 << single.lane();
        }
    }
}
