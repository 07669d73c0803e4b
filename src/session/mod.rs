//! The program without a window: a scene in, a picture out, and the least work for every edit.

pub mod cache;
mod canvas;
mod class;
mod contrast;
pub mod cost;
mod draw;
pub mod inspect;
mod knob;
pub mod layers;
pub mod live;
mod options;
pub mod part;
mod pilots;
pub mod plan;
mod redecide;
pub mod regrow;
pub mod still;
#[cfg(test)]
mod tests_ahead;
pub mod trace;

use std::sync::{Arc, Mutex};
use std::time::Instant;

use rayon::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::film::Frame;
use crate::film::layout::TILE_BLOCKS;
use crate::fold::Names;
use crate::fold::highlight::HighlightPower;
use crate::fold::transport::Transport;
use crate::forest::counts::SampleMap;
use crate::forest::grow::{Grower, RayCounts};
use crate::forest::tree::TileTrees;
use crate::forest::{Before, Forest};
use crate::geometry::Geometry;
use crate::progress::Progress;
use crate::scene::change::Change;
use crate::scene::factor::FactorValues;
use crate::scene::model::{Lobes, Peak};
use crate::scene::{Material, Scene};
use crate::shade::cpu::Tiles;
use crate::shade::terms::{TermProgram, TermValues};
use canvas::Canvas;
pub use class::{Class, EditReport, Work};
pub use options::Options;
use plan::Plan;
use regrow::{Patch, Regrow};
use trace::{Ahead, Keep, Kept, TraceError, TraceReport, Traced, trace};

/// A scene, its kept trees, and its picture, always in step: after every successful call the frame
/// is what a fresh trace of [`Session::scene`] gives, bit for bit. A session that a graphics card shows
/// may put the drawing off: then it is so after `catch_up`, and nobody gets a frame before.
pub struct Session {
    scene: Arc<Scene>,
    options: Options,
    pool: Arc<ThreadPool>,
    geometry: Arc<Geometry>,
    forest: Forest,
    /// The pixels' numbers of samples, where sampling is adaptive.
    map: Option<Arc<SampleMap>>,
    transport: Transport,
    program: TermProgram,
    terms: TermValues,
    /// The terms before the latest edit, to find the tiles that changed.
    before: Vec<[f32; 4]>,
    canvas: Canvas,
    /// Per light the key of its records in the trees.
    keys: Vec<u16>,
    /// Keys of all records in the trees: also of lights that are gone.
    keys_in_trees: Vec<u16>,
    /// Which factors stand for the scene's solids and lights in the matrix.
    names: Names,
    /// Per material the index of refraction with which its nodes stand in the trees: another one than
    /// the scene's only where it does not matter.
    iors: Vec<f64>,
    /// Per material the lobes with which its nodes stand in the trees: other ones than the scene's only
    /// where they do not matter.
    lobes: Vec<Lobes>,
    trace: TraceReport,
    geometry_seconds: f64,
}

/// All that a session begins with.
pub(super) struct Start {
    /// What to trace.
    pub(super) scene: Arc<Scene>,
    /// What [`Geometry::build`] makes of the scene's solids; sessions of the same solids share it.
    pub(super) geometry: Arc<Geometry>,
    /// Threads to trace with.
    pub(super) pool: Arc<ThreadPool>,
    /// What the session may use.
    pub(super) options: Options,
    /// What of the trace is kept.
    pub(super) kept: Kept,
    /// Memory to fill anew.
    pub(super) reuse: Forest,
}

impl Session {
    /// Traces a scene.
    pub fn open(
        scene: impl Into<Arc<Scene>>,
        options: Options,
        progress: &Progress,
    ) -> Result<Session, TraceError> {
        assert!(options.threads > 0, "a session needs a thread");
        let scene = scene.into();
        let pool = ThreadPoolBuilder::new().num_threads(options.threads).build();
        let pool = pool.map_err(|_| TraceError::Threads { threads: options.threads })?;
        let start = Instant::now();
        let geometry = Arc::new(Geometry::build(&scene, progress)?);
        let geometry_seconds = start.elapsed().as_secs_f64();
        let (pool, reuse) = (Arc::new(pool), Forest::default());
        let start = Start { scene, geometry, pool, options, kept: Kept::Trees, reuse };
        Ok(Session { geometry_seconds, ..Session::begin(start, progress)? })
    }

    /// Traces and draws.
    pub(super) fn begin(start: Start, progress: &Progress) -> Result<Session, TraceError> {
        Session::begin_with(start, None, progress)
    }

    /// The same, a part of the picture before the rest, if one is named. The session that is shown of it
    /// has no trees; all but the part is black there, and knows of no edit.
    pub(super) fn begin_with(
        start: Start,
        ahead: Option<Ahead<Session>>,
        progress: &Progress,
    ) -> Result<Session, TraceError> {
        let Start { scene, geometry, pool, options, kept, reuse } = start;
        let keep = Keep { what: kept, bytes: options.memory };
        let of = |traced| Session::of_traced((&scene, &geometry), (&pool, options), traced);
        let show = |traced| ahead.as_ref().map_or(Ok(()), |ahead| (ahead.show)(of(traced)));
        let first = ahead.as_ref().map(|ahead| Ahead { region: ahead.region, show: &show });
        let traced = trace((&scene, first), &geometry, &pool, keep, reuse, progress)?;
        Ok(of(traced))
    }

    /// Draws what was traced.
    fn of_traced(
        (scene, geometry): (&Arc<Scene>, &Arc<Geometry>),
        (pool, options): (&Arc<ThreadPool>, Options),
        traced: Traced,
    ) -> Session {
        let mut session = Session {
            canvas: Canvas::new(scene.picture.size),
            keys: (0..).take(scene.lights.len()).collect(),
            keys_in_trees: (0..).take(scene.lights.len()).collect(),
            names: Names::new(geometry.materials(), scene.lights.len()),
            iors: scene.materials.iter().map(|m| m.ior).collect(),
            lobes: scene.materials.iter().map(Material::lobes).collect(),
            scene: scene.clone(),
            options,
            pool: pool.clone(),
            geometry: geometry.clone(),
            forest: traced.forest,
            map: traced.map,
            program: TermProgram::new(&traced.transport.trie),
            transport: traced.transport,
            terms: TermValues::default(),
            before: Vec::new(),
            trace: traced.report,
            geometry_seconds: 0.0,
        };
        session.evaluate_terms();
        session.draw(Tiles::All);
        session
    }

    /// Makes `scene` the session's, with the least work. On an error the session keeps its old
    /// scene and picture; trees may have been released.
    pub fn edit(
        &mut self,
        scene: impl Into<Arc<Scene>>,
        progress: &Progress,
    ) -> Result<EditReport, TraceError> {
        let start = Instant::now();
        let scene = scene.into();
        let change = Change::between(&self.scene, &scene);
        let mut report = match self.work(&scene, &change) {
            Work::Shade => self.shade(scene, &change),
            Work::Regrow(plan) => self.carry_out(scene, &change, plan, progress)?,
            Work::Trace(reason) => {
                self.retrace(scene, change.geometry, progress)?;
                self.trace_edit(reason)
            }
        };
        report.milliseconds = start.elapsed().as_secs_f64() * 1e3;
        Ok(report)
    }

    /// Makes `scene` the session's if shading is enough; otherwise the session stays as it is, and
    /// what is given says what else is to be done.
    pub fn edit_without_rays(&mut self, scene: &Arc<Scene>) -> Result<EditReport, Work> {
        let start = Instant::now();
        let change = Change::between(&self.scene, scene);
        match self.work(scene, &change) {
            Work::Shade => {
                let report = self.shade(scene.clone(), &change);
                let milliseconds = start.elapsed().as_secs_f64() * 1e3;
                Ok(EditReport { milliseconds, ..report })
            }
            work => Err(work),
        }
    }

    /// What is to be done for an edit.
    fn work(&mut self, scene: &Scene, change: &Change) -> Work {
        if change.everything {
            let what = change.moves_rays.unwrap_or("the scene");
            return Work::Trace(format!("{what} moves rays"));
        }
        // New keys and indices beside the old ones must not run out.
        let lights = self.keys_in_trees.len() + scene.lights.len();
        if lights.max(self.iors.len() + scene.materials.len()) > usize::from(u16::MAX)
            && (change.shadows || !change.keeps_materials())
        {
            return Work::Trace("there are so many lights or materials".into());
        }
        self.plan(scene, change).map_or(Work::Shade, Work::Regrow)
    }

    /// Grows what a plan names, and folds it.
    fn carry_out(
        &mut self,
        scene: Arc<Scene>,
        change: &Change,
        plan: Plan,
        progress: &Progress,
    ) -> Result<EditReport, TraceError> {
        let regrow = self.regrow(scene, change, plan);
        let patches = Mutex::new(Vec::new());
        let keep = |patch| patches.lock().expect("no worker panicked").push(patch);
        regrow.run(&self.pool, progress, &keep)?;
        let patches = patches.into_inner().expect("no worker panicked");
        self.take_patches(&regrow, patches)
    }

    /// Puts what a plan gave in place.
    pub(super) fn take_patches(
        &mut self,
        regrow: &Regrow,
        patches: Vec<Patch>,
    ) -> Result<EditReport, TraceError> {
        let mut rays = RayCounts::default();
        patches.iter().for_each(|patch| rays += patch.rays);
        rays += regrow.rays_to_decide();
        let (pixels, reason) = (regrow.plan.pixels(), Some(regrow.plan.reason.clone()));
        let class = match regrow.plan.casts || rays.total() > 0 {
            true => Class::Regrow,
            false => Class::Refold,
        };
        self.commit(regrow, patches)?;
        Ok(EditReport { class, reason, rays, pixels, milliseconds: 0.0 })
    }

    /// The report of an edit for which everything was just traced, its time still 0.
    pub(super) fn trace_edit(&self, reason: String) -> EditReport {
        EditReport {
            class: Class::Retrace,
            reason: Some(reason),
            rays: self.trace.rays,
            pixels: self.transport.layout.pixels(),
            milliseconds: 0.0,
        }
    }

    /// Makes an edit for which shading is enough.
    fn shade(&mut self, scene: Arc<Scene>, change: &Change) -> EditReport {
        self.rename_materials(change);
        let pairs = scene.materials.iter().zip(&change.materials);
        let ior = |(new, before): (&Material, &Option<u16>)| {
            before.map_or(new.ior, |before| self.iors[before as usize])
        };
        self.iors = pairs.clone().map(ior).collect();
        let lobes = |(new, before): (&Material, &Option<u16>)| {
            before.map_or(new.lobes(), |before| self.lobes[before as usize])
        };
        self.lobes = pairs.map(lobes).collect();
        let kept = change.lights.iter().flatten();
        self.keys = kept.map(|&before| self.keys[before as usize]).collect();
        self.names.lights = self.light_places_after(change);
        if change.surfaces {
            self.geometry = Arc::new(self.geometry.with_surfaces_of(&scene));
            self.names.materials = self.geometry.materials().to_vec();
        }
        let mut marks = vec![change.develop; self.transport.tiles.len()];
        self.refold(&scene, &change.refold, &mut marks);
        self.scene = scene;
        if change.terms {
            std::mem::swap(&mut self.before, &mut self.terms.values);
            self.evaluate_terms();
            self.mark_changed(&mut marks);
        }
        if marks.contains(&true) {
            self.draw(Tiles::Marked(&marks));
        }
        EditReport {
            class: class_without_rays(change),
            reason: None,
            rays: RayCounts::default(),
            pixels: 0,
            milliseconds: 0.0,
        }
    }

    /// Gives the materials of the matrix the indices that they have in the new scene. Those that are
    /// no more, and that only pixels show that are grown again, come after all others.
    fn rename_materials(&mut self, change: &Change) {
        let old = self.iors.len();
        let mut index: Vec<u16> = (0..old).map(|i| u16::MAX - (old - 1 - i) as u16).collect();
        for (&before, new) in change.materials.iter().zip(0..) {
            before.into_iter().for_each(|before| index[before as usize] = new);
        }
        if index.iter().zip(0..).any(|(&new, before)| new != before) {
            self.transport.rename_materials(&index);
            self.program = TermProgram::new(&self.transport.trie);
        }
    }

    /// Places of the new scene's lights in the list of factors, if all of them stay where they are.
    fn light_places_after(&self, change: &Change) -> Vec<u16> {
        let kept = change.lights.iter().flatten();
        kept.map(|&before| self.names.lights[before as usize]).collect()
    }

    /// Folds the highlights of some materials again and marks the tiles that they change.
    fn refold(&mut self, scene: &Scene, materials: &[u16], marks: &mut [bool]) {
        if materials.is_empty() {
            return;
        }
        let mut peaks = vec![None; scene.materials.len()];
        for &m in materials {
            peaks[m as usize] = Some(Peak::of(&scene.materials[m as usize]));
        }
        let weight = 1.0 / self.transport.samples as f32;
        let tiles = self.transport.tiles.par_iter_mut().zip(marks);
        self.pool.install(|| {
            tiles.for_each_init(HighlightPower::default, |power, (tile, mark)| {
                // Without lists its pixels are grown again.
                *mark |=
                    tile.highlights.is_some() && power.refold(Arc::make_mut(tile), &peaks, weight);
            });
        });
    }

    /// Marks the tiles whose dictionary holds a term with another value.
    fn mark_changed(&self, marks: &mut [bool]) {
        let pairs = self.before.iter().zip(&self.terms.values);
        let changed: Vec<bool> = pairs.map(|(a, b)| a != b).collect();
        let tiles = marks.par_iter_mut().zip(&self.transport.tiles);
        self.pool.install(|| {
            tiles.for_each(|(mark, tile)| {
                *mark = *mark || tile.terms.iter().any(|&t| changed[t as usize]);
            });
        });
    }

    /// Traces `scene`, after compiling its geometry if `compile` says that it differs.
    fn retrace(
        &mut self,
        scene: Arc<Scene>,
        compile: bool,
        progress: &Progress,
    ) -> Result<(), TraceError> {
        let start = Instant::now();
        let (geometry, geometry_seconds) = if compile {
            let geometry = Geometry::build(&scene, progress)?;
            (Arc::new(geometry), start.elapsed().as_secs_f64())
        } else {
            (Arc::new(self.geometry.with_surfaces_of(&scene)), self.geometry_seconds)
        };
        let (pool, options, reuse) = (self.pool.clone(), self.options, self.take_trees());
        let start = Start { scene, geometry, pool, options, kept: Kept::Trees, reuse };
        *self = Session { geometry_seconds, ..Session::begin(start, progress)? };
        Ok(())
    }

    /// Releases all trees and gives their memory.
    pub(super) fn take_trees(&mut self) -> Forest {
        let tiles = vec![None; self.forest.tiles.len()];
        let released = Forest { tiles, layout: self.forest.layout, samples: self.forest.samples };
        std::mem::replace(&mut self.forest, released)
    }

    /// Takes back what [`Session::take_trees`] gave.
    pub(super) fn give_trees(&mut self, trees: Forest) {
        assert_eq!(trees.layout, self.forest.layout, "the session's own trees");
        self.forest = trees;
    }

    /// Lets other threads do the work from now on.
    pub(super) fn move_to(&mut self, pool: &Arc<ThreadPool>) {
        self.pool = pool.clone();
    }

    /// Traces the same scene again, into the memory of the present trees.
    pub fn trace_again(&mut self, progress: &Progress) -> Result<(), TraceError> {
        self.retrace(self.scene.clone(), false, progress)
    }

    /// What making `scene` the session's would cost.
    pub fn class_of(&mut self, scene: &Scene) -> Class {
        let change = Change::between(&self.scene, scene);
        match self.work(scene, &change) {
            Work::Trace(_) => Class::Retrace,
            Work::Regrow(plan) if plan.casts => Class::Regrow,
            Work::Regrow(_) => Class::Refold,
            Work::Shade => class_without_rays(&change),
        }
    }

    /// Evaluates every term of the present scene.
    pub fn evaluate_terms(&mut self) {
        let factors = FactorValues::new(&self.scene).with_lights_at(&self.names.lights);
        self.terms.evaluate(&self.program, &factors);
    }

    /// What grows the trees of the present scene, with what is kept of them.
    fn grower(&self) -> Grower<'_> {
        let before = self.turns();
        let grower = Grower::recalling(&self.scene, &self.geometry, self.keys.clone(), &before);
        grower.with_map(self.map.as_deref())
    }

    /// With what the kept trees were grown.
    fn turns(&self) -> Before {
        let iors = self.geometry.of_solids(&self.iors);
        Before { iors, lobes: self.geometry.of_solids(&self.lobes) }
    }

    /// The trees of one tile, read from what is kept of them, or grown again.
    pub fn trees(&self, tile: usize, progress: &Progress) -> Result<TileTrees, TraceError> {
        let grower = self.grower();
        let mut worker = grower.worker();
        let mut trees = TileTrees::default();
        let most = usize::try_from(self.options.memory).unwrap_or(usize::MAX);
        for block in 0..TILE_BLOCKS {
            let at = (tile, block);
            let kept = self.forest.tiles[tile].as_ref().map(|kept| kept.recall(block));
            let grown = grower.block_again(&mut worker, at, kept, &mut trees, most, progress);
            grown.map_err(|stop| TraceError::of(stop, most))?;
        }
        Ok(trees)
    }

    /// The scene shown.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// What the session may use.
    pub fn options(&self) -> Options {
        self.options
    }

    /// Its threads.
    pub fn pool(&self) -> &ThreadPool {
        &self.pool
    }

    /// The scene made ready for rays.
    pub fn geometry(&self) -> &Geometry {
        &self.geometry
    }

    /// The kept trees.
    pub fn forest(&self) -> &Forest {
        &self.forest
    }

    /// The matrix.
    pub fn transport(&self) -> &Transport {
        &self.transport
    }

    /// The value of every term.
    pub fn terms(&self) -> &TermValues {
        &self.terms
    }

    /// Allocated bytes of the terms, as code and as values.
    pub fn term_bytes(&self) -> usize {
        self.program.bytes() + self.terms.bytes() + self.before.capacity() * size_of::<[f32; 4]>()
    }

    /// The picture as shown.
    pub fn frame(&self) -> &Frame {
        assert!(!self.canvas.owes(), "the frame is asked for when it is drawn");
        self.canvas.newest()
    }

    /// The same, to be kept: it stays what it is when the session is edited.
    pub fn shared_frame(&self) -> Arc<Frame> {
        assert!(!self.canvas.owes(), "the frame is asked for when it is drawn");
        self.canvas.newest().clone()
    }

    /// The scene shown, to be kept.
    pub fn shared_scene(&self) -> Arc<Scene> {
        self.scene.clone()
    }

    /// The compiled scene, to be kept.
    pub fn shared_geometry(&self) -> Arc<Geometry> {
        self.geometry.clone()
    }

    /// Allocated bytes of what [`Options::memory`] limits.
    pub fn kept_bytes(&self) -> u64 {
        let matrix = self.transport.bytes() + self.transport.highlight_bytes();
        (self.forest.bytes() + matrix) as u64
    }

    /// Times and counts of the latest trace.
    pub fn trace_report(&self) -> TraceReport {
        self.trace
    }

    /// Time to compile the geometry.
    pub fn geometry_seconds(&self) -> f64 {
        self.geometry_seconds
    }
}

fn class_without_rays(change: &Change) -> Class {
    match change {
        c if !c.refold.is_empty() => Class::Refold,
        c if c.terms || c.develop => Class::Reshade,
        _ => Class::None,
    }
}
