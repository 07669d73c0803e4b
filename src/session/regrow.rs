//! Grows some pixels' trees again, from what is kept of them, and folds them into the matrix.

use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use rayon::ThreadPool;
use rayon::prelude::*;

use super::Session;
use super::pilots::{Pilots, Survey};
use super::plan::{Plan, PlanTile};
use super::trace::{LEAST_BLOCK_LIMIT, TraceError, claim};
use crate::film::Frame;
use crate::film::develop::Development;
use crate::film::layout::TILE_BLOCKS;
use crate::fold::merge::Blocks;
use crate::fold::stay::Stay;
use crate::fold::transport::{Transport, TransportTile};
use crate::fold::trie::{Marks, Trie};
use crate::fold::{Folded, Folder, Names};
use crate::forest::again::Again;
use crate::forest::counts::SampleMap;
use crate::forest::grow::{Grower, RayCounts, Worker};
use crate::forest::kept::{KeptTrees, Recalls};
use crate::forest::scope::Scope;
use crate::forest::tree::TileTrees;
use crate::forest::{Before, Forest};
use crate::geometry::Geometry;
use crate::progress::Progress;
use crate::scene::change::Change;
use crate::scene::factor::FactorValues;
use crate::scene::model::{Lobes, Peak};
use crate::scene::{Bump, Scene, Solid};
use crate::shade::cpu;
use crate::shade::terms::{TermProgram, TermValues};

/// A plan with all that it needs: it can be carried out beside the session that it is of.
pub struct Regrow {
    /// The scene that is wanted.
    pub(super) scene: Arc<Scene>,
    pub(super) plan: Plan,
    pub(super) geometry: Arc<Geometry>,
    /// Shared with the session.
    forest: Forest,
    keys: Vec<u16>,
    names: Names,
    /// What stays of the matrix, if the plan has a scope. Taken as the plan is carried out, so that the
    /// session alone has its tiles when it merges the patches.
    base: Mutex<Option<Base>>,
    /// With what the kept trees were grown.
    before: Before,
    /// Per solid whether the kept trees were grown with another bump; empty: none was.
    bent: Vec<bool>,
    /// The session's numbers of samples, where sampling is adaptive.
    map: Option<Arc<SampleMap>>,
    /// Those of the new scene, and the rays that it took to decide; empty as long as they are not
    /// known, and if they stay.
    decided: OnceLock<(Arc<SampleMap>, RayCounts)>,
    /// Per material of the new scene, of the trees when all is done.
    iors_after: Vec<f64>,
    /// The same of lobes.
    lobes_after: Vec<Lobes>,
    budget: usize,
    /// Bytes kept, those of the patches' trees included.
    kept: AtomicUsize,
    /// Bytes of the trees in whose place those of the patches come.
    replaced: AtomicUsize,
}

/// Blocks of a tile grown and folded again.
pub struct Patch {
    tile: usize,
    blocks: Blocks,
    /// The terms of `part`.
    trie: Trie,
    part: TransportTile,
    /// Of the whole tile, or `None` if trees of its other blocks are not kept.
    trees: Option<Arc<KeptTrees>>,
    /// Rays cast for it.
    pub(super) rays: RayCounts,
}

impl Session {
    /// Prepares to carry out a plan for `scene`.
    pub(super) fn regrow(&mut self, scene: Arc<Scene>, change: &Change, plan: Plan) -> Regrow {
        let geometry = match change.surfaces {
            true => Arc::new(self.geometry.with_surfaces_of(&scene)),
            false => self.geometry.clone(),
        };
        let keys = self.keys_after(change);
        let lights = match change.shadows {
            true => (0..).take(scene.lights.len()).collect(),
            false => self.light_places_after(change),
        };
        let stay = plan.scope.as_ref().map(|scope| {
            let mut places =
                vec![None; 1 + self.names.lights.iter().max().map_or(0, |&m| m as usize)];
            for (before, &place) in change.lights.iter().zip(&lights) {
                if let Some(before) = before {
                    places[usize::from(self.names.lights[*before as usize])] = Some(place);
                }
            }
            Stay::beside(scope, &self.transport.trie, places)
        });
        let base = stay.map(|stay| {
            let Transport { layout: _, samples: _, trie, tiles } = &self.transport;
            Base { tiles: tiles.clone(), trie: trie.clone(), stay }
        });
        Regrow {
            base: Mutex::new(base),
            names: Names { materials: geometry.materials().to_vec(), lights },
            keys,
            geometry,
            forest: self.forest.clone(),
            before: self.turns(),
            bent: self.bent(&scene),
            map: self.map.clone(),
            decided: OnceLock::new(),
            iors_after: self.iors_after(&scene, change),
            lobes_after: self.lobes_after(&scene, change),
            kept: AtomicUsize::new(self.kept_bytes() as usize),
            replaced: AtomicUsize::new(0),
            budget: usize::try_from(self.options.memory).unwrap_or(usize::MAX),
            scene,
            plan,
        }
    }

    /// Per solid whether its bump in `scene` is another one than in the kept trees; empty: none is.
    fn bent(&self, scene: &Scene) -> Vec<bool> {
        let even = |scene: &Scene| scene.materials.iter().all(|m| m.bump == Bump::None);
        if even(scene) && even(&self.scene) {
            return Vec::new();
        }
        let pairs = self.scene.solids.iter().zip(&scene.solids);
        let differs = |(old, new): (&Solid, &Solid)| {
            let before = &self.scene.materials[old.material].bump;
            !before.bends_like(&scene.materials[new.material].bump)
        };
        pairs.map(differs).collect()
    }

    /// Keys of the new scene's lights: a light that is new or elsewhere has a new one.
    fn keys_after(&mut self, change: &Change) -> Vec<u16> {
        let old = &self.keys;
        let mut taken = vec![false; usize::from(u16::MAX) + 1];
        self.keys_in_trees.iter().for_each(|&key| taken[usize::from(key)] = true);
        let mut free = (0..=u16::MAX).filter(|&key| !taken[usize::from(key)]);
        let key = |before: &Option<u16>| match before {
            Some(before) => old[*before as usize],
            None => free.next().expect("fewer lights than keys"),
        };
        change.lights.iter().map(key).collect()
    }

    /// Per material of the new scene the index of refraction with which its nodes stand in the trees
    /// when a plan was carried out. Where it does not matter, some may stand there with another one
    /// than others: not a number, which differs from every number.
    fn iors_after(&self, scene: &Scene, change: &Change) -> Vec<f64> {
        let pairs = scene.materials.iter().zip(&change.materials).enumerate();
        let after = pairs.map(|(i, (new, before))| match before {
            Some(before) if self.iors[*before as usize] != new.ior && !scene.ior_matters(i) => {
                f64::NAN
            }
            _ => new.ior,
        });
        after.collect()
    }

    /// The same of lobes.
    fn lobes_after(&self, scene: &Scene, change: &Change) -> Vec<Lobes> {
        let pairs = scene.materials.iter().zip(&change.materials);
        let after = pairs.map(|(new, before)| {
            let before = before.map_or(new.lobes(), |before| self.lobes[before as usize]);
            let (lobes, matter) = (new.lobes(), new.lobes_matter());
            let stands = |k: usize| matter[k] || before[k] == lobes[k];
            [0, 1].map(|k| if stands(k) { lobes[k] } else { f32::NAN })
        });
        after.collect()
    }

    /// Puts the patches of a plan that was carried out in place: from now on its scene is the
    /// session's. On an error nothing has changed, but for trees that were released.
    pub(super) fn commit(
        &mut self,
        regrow: &Regrow,
        patches: Vec<Patch>,
    ) -> Result<(), TraceError> {
        let replaced = |p: &Patch| self.transport.tiles[p.tile].bytes_of_blocks(p.blocks);
        let matrix = self.transport.bytes() as u64
            + patches.iter().map(|p| p.part.bytes_of_blocks(u64::MAX) as u64).sum::<u64>()
            - patches.iter().map(|p| replaced(p) as u64).sum::<u64>();
        if matrix > self.options.memory {
            return Err(TraceError::Memory { budget: regrow.budget as u64 });
        }
        let change = Change::between(&self.scene, &regrow.scene);
        self.rename_materials(&change);
        let mut marks = vec![false; self.transport.tiles.len()];
        self.refold(&regrow.scene, &change.refold, &mut marks);
        for patch in &patches {
            self.forest.tiles[patch.tile] = patch.trees.clone();
        }
        self.merge(patches);
        (self.scene, self.geometry) = (regrow.scene.clone(), regrow.geometry.clone());
        (self.keys, self.names) = (regrow.keys.clone(), regrow.names.clone());
        if change.shadows {
            self.keys_in_trees = self.keys.clone();
        }
        if let Some((map, _)) = regrow.decided.get() {
            self.map = Some(map.clone());
        }
        self.iors = regrow.iors_after.clone();
        self.lobes = regrow.lobes_after.clone();
        self.program = TermProgram::new(&self.transport.trie);
        self.release_to_budget();
        self.redraw();
        Ok(())
    }

    /// Releases the latest tiles' trees, then their highlight lists, until the rest fits into the
    /// budget.
    fn release_to_budget(&mut self) {
        let budget = self.options.memory;
        let mut bytes = self.kept_bytes();
        for trees in self.forest.tiles.iter_mut().rev() {
            if bytes <= budget {
                return;
            }
            bytes -= trees.take().map_or(0, |trees| trees.bytes() as u64);
        }
        for tile in self.transport.tiles.iter_mut().rev() {
            if bytes <= budget {
                return;
            }
            if let Some(lists) = &tile.highlights {
                bytes -= lists.bytes() as u64;
                Arc::make_mut(tile).highlights = None;
            }
        }
    }

    /// Merges patches into the matrix.
    fn merge(&mut self, patches: Vec<Patch>) {
        let mut trie = self.transport.trie.growing();
        let globals: Vec<Vec<u32>> = patches.iter().map(|patch| patch.intern(&mut trie)).collect();
        let ranks = trie.canonical_ranks();
        let trie = trie.renumbered(&ranks);
        let mut parts: Vec<Option<(Patch, Vec<u32>)>> = Vec::new();
        parts.resize_with(self.transport.tiles.len(), || None);
        for (patch, global) in patches.into_iter().zip(globals) {
            let tile = patch.tile;
            parts[tile] = Some((patch, global));
        }
        let tiles = self.transport.tiles.par_iter_mut().zip(parts);
        self.pool.install(|| {
            tiles.for_each(|(tile, part)| {
                let tile = Arc::make_mut(tile);
                tile.renumber(|id| ranks[id as usize]);
                if let Some((Patch { blocks, mut part, .. }, global)) = part {
                    part.renumber(|id| ranks[global[id as usize] as usize]);
                    *tile = tile.with_blocks(&part, blocks);
                }
            });
        });
        let mut used = vec![Marks::default(); trie.nodes().len()];
        for tile in &self.transport.tiles {
            tile.terms.iter().for_each(|&id| used[id as usize].add(Marks::TERM));
            for &id in &tile.frontier.terms {
                used[id as usize].add(trie.nodes()[id as usize].end_mark());
            }
        }
        let (trie, ids) = trie.only(&used);
        let tiles = &mut self.transport.tiles;
        self.pool.install(|| {
            tiles.par_iter_mut().for_each(|tile| {
                Arc::make_mut(tile).renumber(|id| ids[id as usize]);
            });
        });
        self.transport.trie = trie;
    }
}

impl Patch {
    /// The tile.
    pub fn tile(&self) -> usize {
        self.tile
    }

    /// Its blocks.
    pub fn blocks(&self) -> Blocks {
        self.blocks
    }

    /// Draws its blocks as the plan's scene shows them.
    pub(super) fn draw(&self, regrow: &Regrow, frame: &mut Frame) {
        let scene = &regrow.scene;
        let factors = FactorValues::new(scene).with_lights_at(&regrow.names.lights);
        let mut terms = TermValues::default();
        terms.evaluate(&TermProgram::new(&self.trie), &factors);
        let development = Development::of(&scene.picture);
        cpu::frame_blocks((self.tile, self.blocks), &self.part, &terms.values, development, frame);
    }

    /// The ids of its terms in `trie`, to which they are added.
    fn intern(&self, trie: &mut Trie) -> Vec<u32> {
        let mut global = vec![0u32; self.trie.nodes().len()];
        for (id, node) in self.trie.nodes().iter().enumerate().skip(1) {
            global[id] = trie.intern(global[node.parent as usize], node.factor);
        }
        global
    }
}

impl Regrow {
    /// Carries the plan out tile by tile, in its order, on all threads of the pool; `done` is given
    /// what is ready. Only rays that kept trees do not answer are cast.
    pub(super) fn run(
        &self,
        pool: &ThreadPool,
        progress: &Progress,
        done: &(dyn Fn(Patch) + Sync),
    ) -> Result<(), TraceError> {
        progress.begin(self.plan.tiles.len() as u64);
        let pilots = self.decide(pool, progress)?;
        let map = pilots.map.as_ref().or(self.map.as_ref());
        let base = self.base.lock().unwrap_or_else(PoisonError::into_inner).take();
        let grower =
            Grower::recalling(&self.scene, &self.geometry, self.keys.clone(), &self.before)
                .with_bent(self.bent.clone())
                .with_map(map.map(|map| &**map));
        let next = AtomicUsize::new(0);
        let results = pool.broadcast(|_| -> Result<(), TraceError> {
            let mut scratch = Scratch {
                worker: grower.worker(),
                folder: Folder::default(),
                grown: TileTrees::default(),
                again: Again::default(),
            };
            while let Some(at) = claim(&next, self.plan.tiles.len()) {
                let plan = &self.plan.tiles[at];
                let known = (pilots.tree(plan.tile), base.as_ref());
                done(self.tile((plan, known), &grower, &mut scratch, progress)?);
                progress.step();
            }
            Ok(())
        });
        results.into_iter().collect()
    }

    /// Decides again how many samples pixels get, as far as the plan asks for it.
    fn decide(&self, pool: &ThreadPool, progress: &Progress) -> Result<Pilots, TraceError> {
        let (Some(unsettled), Some(map)) = (&self.plan.unsettled, &self.map) else {
            return Ok(Pilots::default());
        };
        let survey = Survey {
            scene: &self.scene,
            geometry: &self.geometry,
            old: &self.forest.tiles,
            keys: &self.keys,
            before: &self.before,
            bent: &self.bent,
            bytes: self.budget / 4,
        };
        let pilots = survey.decide(&unsettled.widened(), (**map).clone(), Some(pool), progress)?;
        if let Some(map) = &pilots.map {
            // A plan is carried out once.
            let _ = self.decided.set((map.clone(), pilots.rays));
        }
        Ok(pilots)
    }

    /// Rays cast to decide how many samples pixels get.
    pub(super) fn rays_to_decide(&self) -> RayCounts {
        self.decided.get().map_or(RayCounts::default(), |(_, rays)| *rays)
    }

    fn tile(
        &self,
        (plan, (first, base)): (&PlanTile, (Option<&KeptTrees>, Option<&Base>)),
        grower: &Grower,
        scratch: &mut Scratch,
        progress: &Progress,
    ) -> Result<Patch, TraceError> {
        let old = self.forest.tiles[plan.tile].as_deref();
        let (trees, folded, rays) = match self.part_of(plan.tile, base) {
            Some(part) => self.grow_part(plan, &part, grower, scratch, progress)?,
            None => self.grow_all(plan, (first, old), grower, scratch, progress)?,
        };
        // They take the place of the old ones, which go when all is done.
        let replaced = old.map_or(0, KeptTrees::bytes);
        let bytes = self.kept.fetch_add(trees.bytes(), Relaxed) + trees.bytes();
        let bytes = bytes.saturating_sub(self.replaced.fetch_add(replaced, Relaxed) + replaced);
        let fits = trees.is_whole() && bytes <= self.budget;
        Ok(Patch {
            tile: plan.tile,
            blocks: plan.blocks(),
            trie: folded.trie.frozen(),
            part: folded.tile,
            trees: fits.then(|| Arc::new(trees.trimmed())),
            rays,
        })
    }

    /// Grows and folds a tile's blocks, of which the trees `first`, of the new scene, and `old` know.
    fn grow_all<'a>(
        &self,
        plan: &PlanTile,
        (first, old): (Option<&KeptTrees>, Option<&KeptTrees>),
        grower: &Grower,
        scratch: &'a mut Scratch,
        progress: &Progress,
    ) -> Result<(KeptTrees, Folded<'a>, RayCounts), TraceError> {
        let Scratch { worker, folder, grown, again: _ } = scratch;
        worker.rays = RayCounts::default();
        let mut trees = empty_as(old);
        folder.begin_tile();
        for block in 0..TILE_BLOCKS {
            if plan.lanes[block] == 0 {
                if let Some(old) = old {
                    trees.push_block(old, block);
                }
                continue;
            }
            grown.clear();
            let at = (plan.tile, block);
            let kept = Recalls {
                first: first.map(|first| first.recall_current(block)),
                rest: old.map(|old| old.recall(block)),
            };
            let stopped = grower.block_again(worker, at, kept, grown, self.most(), progress);
            stopped.map_err(|stop| TraceError::of(stop, self.budget))?;
            let counts = grower.counts(at);
            folder.block(&mut grown.read(0), &counts, &self.names);
            if grower.is_adaptive() {
                trees.push_counts(&counts);
            }
            trees.push_grown(grown, grower.keys());
        }
        let folded = folder.finish_tile(1.0 / self.samples() as f32, &self.peaks());
        Ok((trees, folded, worker.rays))
    }

    /// The same, but only of the terms in the plan's scope.
    fn grow_part<'a>(
        &self,
        plan: &PlanTile,
        part: &Part,
        grower: &Grower,
        scratch: &'a mut Scratch,
        progress: &Progress,
    ) -> Result<(KeptTrees, Folded<'a>, RayCounts), TraceError> {
        let Scratch { worker, folder, grown: _, again } = scratch;
        worker.rays = RayCounts::default();
        let Part { trees: old, matrix, scope, base } = *part;
        again.begin(empty_as(Some(old)), grower.keys());
        folder.begin_part(matrix, &base.trie, &base.stay);
        for block in 0..TILE_BLOCKS {
            if plan.lanes[block] == 0 {
                again.kept.push_block(old, block);
                continue;
            }
            let (at, kept) = ((plan.tile, block), (old, scope));
            let stopped = grower.block_part(worker, at, kept, again, self.most(), progress);
            stopped.map_err(|stop| TraceError::of(stop, self.budget))?;
            let (reader, counts) = (&mut again.grown.read(0), grower.counts(at));
            folder.block_part(reader, &counts, &self.names, (matrix, block));
        }
        let trees = std::mem::take(&mut again.kept);
        let folded = folder.finish_part(1.0 / self.samples() as f32, &self.peaks(), matrix);
        Ok((trees, folded, worker.rays))
    }

    fn most(&self) -> usize {
        (self.budget / 8).max(LEAST_BLOCK_LIMIT)
    }

    fn samples(&self) -> u32 {
        self.scene.trace.samples
    }

    fn peaks(&self) -> Vec<Option<Peak>> {
        self.scene.materials.iter().map(|m| Some(Peak::of(m))).collect()
    }

    /// What of a tile stays, if a part of it does.
    fn part_of<'a>(&'a self, tile: usize, base: Option<&'a Base>) -> Option<Part<'a>> {
        let trees = self.forest.tiles[tile].as_deref()?;
        let (scope, base) = (self.plan.scope.as_ref()?, base?);
        let matrix = &*base.tiles[tile];
        matrix.highlights.is_some().then_some(Part { trees, matrix, scope, base })
    }
}

/// A matrix of which something stays.
struct Base {
    tiles: Vec<Arc<TransportTile>>,
    trie: Trie,
    stay: Stay,
}

/// A tile of which something stays.
#[derive(Clone, Copy)]
struct Part<'a> {
    trees: &'a KeptTrees,
    matrix: &'a TransportTile,
    scope: &'a Scope,
    base: &'a Base,
}

/// Empty trees with room for as much as the old ones hold.
fn empty_as(old: Option<&KeptTrees>) -> KeptTrees {
    let mut trees = KeptTrees::default();
    trees.clear();
    if let Some(old) = old {
        trees.reserve_as(old);
    }
    trees
}

/// What a thread needs.
struct Scratch {
    worker: Worker,
    folder: Folder,
    grown: TileTrees,
    again: Again,
}
