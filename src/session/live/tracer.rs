//! The thread that traces: one scene at a time, coarse first.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::sync::mpsc::{Receiver, Sender};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;

use rayon::ThreadPool;

use super::shader::Message;
use super::{Stage, guarded, pool};
use crate::film::plates::Region;
use crate::forest::Forest;
use crate::geometry::Geometry;
use crate::progress::{Cancelled, Progress};
use crate::scene::Scene;
use crate::scene::change::Change;
use crate::session::cache::{CacheError, Fault};
use crate::session::regrow::Regrow;
use crate::session::trace::{Ahead, Kept, TraceError};
use crate::session::{Options, Session, Start};

/// A scene to trace.
pub(super) struct Task {
    pub(super) id: u64,
    pub(super) scene: Arc<Scene>,
    pub(super) control: Arc<Control>,
    /// A scene with its geometry, which may serve.
    pub(super) known: Option<Compiled>,
    /// Trees whose memory the whole picture fills anew; what is left there afterwards was not
    /// touched.
    pub(super) reuse: Arc<Mutex<Option<Forest>>>,
    /// What is grown instead of everything, after a coarse picture of everything.
    pub(super) regrow: Option<Arc<Regrow>>,
    /// What is opened instead of tracing anything.
    pub(super) cache: Option<PathBuf>,
    /// The part of the picture that is traced first.
    pub(super) region: Option<Region>,
}

/// A scene and what was compiled of its solids.
#[derive(Clone)]
pub(super) struct Compiled(pub(super) Arc<Scene>, pub(super) Arc<Geometry>);

impl Compiled {
    /// The geometry, if it is also that of `scene`.
    pub(super) fn of(&self, scene: &Scene) -> Option<Arc<Geometry>> {
        let change = Change::between(&self.0, scene);
        (!change.geometry).then(|| match change.surfaces {
            true => Arc::new(self.1.with_surfaces_of(scene)),
            false => self.1.clone(),
        })
    }
}

/// How the shader steers a running trace.
#[derive(Default)]
pub(super) struct Control {
    pub(super) progress: Arc<Progress>,
    /// Another scene waits: the first stage is finished, the others are not begun.
    pub(super) superseded: AtomicBool,
    /// Set by the tracer when the first stage was handed over.
    pub(super) past_first: AtomicBool,
}

/// How a trace ended.
pub(super) enum Outcome {
    /// With the whole picture.
    Whole(Box<Session>),
    /// With what a cache held: the session of a scene that may differ from the wanted one.
    Opened(Box<Session>),
    /// Without what a cache should hold.
    NotOpened(CacheError),
    /// With all patches of the plan, which were sent.
    Regrown,
    /// After its first stage, because another scene waits.
    Superseded,
    /// By a cancel.
    Cancelled,
    /// What went wrong.
    Failed(String),
}

/// Works until nobody sends tasks any more.
pub(super) fn run(options: Options, tasks: Receiver<Task>, results: Sender<Message>) {
    let mut tracer =
        Tracer { options, pool: pool(options), results, latest: None, divisor: FIRST_DIVISOR };
    for task in tasks {
        let outcome = match guarded(|| tracer.work(&task)) {
            Ok(Ok(outcome)) => outcome,
            Ok(Err(TraceError::Cancelled)) => Outcome::Cancelled,
            Ok(Err(error)) => Outcome::Failed(format!("the scene was not traced: {error}")),
            Err(text) => Outcome::Failed(format!("the scene was not traced: {text}")),
        };
        // Nobody receives once the shader has ended.
        let _ = tracer.results.send(Message::Ended { id: task.id, outcome });
    }
}

/// Of the first coarse picture, while nothing is known of the machine and the scene.
const FIRST_DIVISOR: f64 = 4.0;
const LARGEST_DIVISOR: f64 = 16.0;
/// What a coarse picture should take: a dragged camera shows fifteen a second.
const COARSE_SECONDS: f64 = 0.065;
/// Scenes of fewer camera rays are traced whole at once.
const TINY_RAYS: u64 = 1 << 15;
/// With fewer samples a picture of one sample is no quicker than the whole one.
const FEW_SAMPLES: u32 = 4;

struct Tracer {
    options: Options,
    pool: Arc<ThreadPool>,
    results: Sender<Message>,
    /// What was compiled last.
    latest: Option<Compiled>,
    /// Of a coarse picture that takes [`COARSE_SECONDS`].
    divisor: f64,
}

impl Tracer {
    fn work(&mut self, task: &Task) -> Result<Outcome, TraceError> {
        if let Some(cache) = &task.cache {
            return self.open(task, cache);
        }
        let outcome = self.trace(task)?;
        let (Some(regrow), true) = (&task.regrow, outcome.is_none()) else {
            return Ok(outcome.unwrap_or(Outcome::Superseded));
        };
        if task.control.superseded.load(Relaxed) {
            return Ok(Outcome::Superseded);
        }
        let id = task.id;
        regrow.run(&self.pool, &task.control.progress, &|patch| {
            let _ = self.results.send(Message::Grown { id, patch: Box::new(patch) });
        })?;
        Ok(Outcome::Regrown)
    }

    fn open(&self, task: &Task, cache: &Path) -> Result<Outcome, TraceError> {
        let (pool, progress) = (self.pool.clone(), &task.control.progress);
        match Session::recall(&task.scene, cache, pool, self.options, progress) {
            Ok((session, _)) => Ok(Outcome::Opened(Box::new(session))),
            Err(CacheError { fault: Fault::Stopped(error), .. }) => Err(error),
            Err(error) => Ok(Outcome::NotOpened(error)),
        }
    }

    /// The whole picture, or `None` if another scene waits, or only some of it is wanted.
    fn trace(&mut self, task: &Task) -> Result<Option<Outcome>, TraceError> {
        let Task { id, scene, control, known: _, reuse, regrow, cache: _, region } = task;
        let region = region.and_then(|region| region.within(scene.picture.size));
        let geometry = match regrow {
            Some(regrow) => regrow.geometry.clone(),
            None => self.geometry(task)?,
        };
        let divisor = self.divisor.round() as u32;
        // What the person waits for is handed over at once; then another scene may come first.
        let results = self.results.clone();
        let hand_over = |stage, session| {
            let session = Box::new(session);
            let _ = results.send(Message::Staged { id: *id, stage, divisor, session });
            control.past_first.store(true, Relaxed);
            if control.superseded.load(Relaxed) { Err(Cancelled) } else { Ok(()) }
        };
        let show = |session| hand_over(Stage::Region, session);
        for (number, stage) in stages(scene, divisor, region).into_iter().enumerate() {
            if regrow.as_ref().is_some_and(|regrow| !regrow.shows(stage)) {
                return Ok(None);
            }
            let whole = stage == Stage::Whole;
            let taken = || reuse.lock().unwrap_or_else(PoisonError::into_inner).take();
            let start = Start {
                scene: if whole { scene.clone() } else { Arc::new(staged(scene, stage, divisor)) },
                geometry: geometry.clone(),
                pool: self.pool.clone(),
                options: self.options,
                kept: if whole { Kept::Trees } else { Kept::Lists },
                reuse: if whole { taken().unwrap_or_default() } else { Forest::default() },
            };
            let begun = Instant::now();
            let ahead = region.filter(|_| whole && !is_tiny(scene));
            let ahead = ahead.map(|region| Ahead { region, show: &show });
            let session = match Session::begin_with(start, ahead, &control.progress) {
                // Only a scene that waits ends a trace that nobody cancelled.
                Err(TraceError::Cancelled) if !control.progress.is_cancelled() => return Ok(None),
                session => session?,
            };
            if number == 0 {
                self.adapt(scene, stage, divisor, begun.elapsed().as_secs_f64());
            }
            if whole {
                return Ok(Some(Outcome::Whole(Box::new(session))));
            }
            if hand_over(stage, session).is_err() {
                return Ok(None);
            }
        }
        Ok(None)
    }

    /// The geometry of a scene, compiled only if no known one fits.
    fn geometry(&mut self, task: &Task) -> Result<Arc<Geometry>, Cancelled> {
        let mut known = self.latest.iter().chain(&task.known);
        if let Some(geometry) = known.find_map(|compiled| compiled.of(&task.scene)) {
            return Ok(geometry);
        }
        let geometry = Arc::new(Geometry::build(&task.scene, &task.control.progress)?);
        self.latest = Some(Compiled(task.scene.clone(), geometry.clone()));
        Ok(geometry)
    }

    /// Learns from the time of a first stage how coarse the next one must be.
    fn adapt(&mut self, scene: &Scene, stage: Stage, divisor: u32, seconds: f64) {
        let (side, samples) = match stage {
            Stage::Coarse => (divisor, 1),
            Stage::OneSample => (1, 1),
            Stage::Region | Stage::Mending | Stage::Whole => (1, scene.trace.samples),
        };
        let seconds = seconds / f64::from(samples);
        let fitting = f64::from(side) * (seconds / COARSE_SECONDS).sqrt();
        self.divisor = fitting.clamp(1.0, LARGEST_DIVISOR);
    }
}

/// Fewer pixels than this are grown at once, without a coarse picture before them.
const FEW_PIXELS: u64 = 1 << 12;

impl Regrow {
    /// Whether a stage is traced before it.
    fn shows(&self, stage: Stage) -> bool {
        stage == Stage::Coarse && self.plan.pixels() >= FEW_PIXELS
    }
}

/// Whether a scene is traced whole at once, without anything before it.
fn is_tiny(scene: &Scene) -> bool {
    let [width, height] = scene.picture.size.map(u64::from);
    width * height * u64::from(scene.trace.samples) < TINY_RAYS
}

/// The stages in which a scene is traced: those before the whole picture that are much quicker. A region
/// is whole before the rest of the last one is traced; it waits for the second only if that is a small
/// part of all, as the rest is then seen in it for long.
fn stages(scene: &Scene, divisor: u32, region: Option<Region>) -> Vec<Stage> {
    let mut stages = Vec::new();
    if !is_tiny(scene) && divisor > 1 {
        stages.push(Stage::Coarse);
    }
    let few = if region.is_some() { 4 * FEW_SAMPLES } else { FEW_SAMPLES };
    if !is_tiny(scene) && scene.trace.samples >= few {
        stages.push(Stage::OneSample);
    }
    stages.push(Stage::Whole);
    stages
}

/// The scene as a stage shows it.
pub(super) fn staged(scene: &Scene, stage: Stage, divisor: u32) -> Scene {
    let mut staged = scene.clone();
    if stage <= Stage::OneSample {
        staged.trace.samples = 1;
    }
    if stage == Stage::Coarse {
        staged.picture.size = scene.picture.size.map(|side| (side / divisor).max(1));
    }
    staged
}

#[cfg(test)]
mod tests {
    use super::*;
    use Stage::{Coarse, OneSample, Whole};

    fn scene(size: [u32; 2], samples: u32) -> Scene {
        let mut scene = Scene::default();
        (scene.picture.size, scene.trace.samples) = (size, samples);
        scene
    }

    #[test]
    fn stages_that_would_not_help_are_left_out() {
        let at = |size, samples, divisor| stages(&scene(size, samples), divisor, None);
        assert_eq!(at([1280, 720], 16, 4), [Coarse, OneSample, Whole]);
        assert_eq!(at([1280, 720], 1, 4), [Coarse, Whole]);
        assert_eq!(at([1280, 720], 16, 1), [OneSample, Whole]);
        assert_eq!(at([48, 32], 16, 4), [Whole]);
        let part = Some(Region { corner: [10, 10], size: [50, 50] });
        assert_eq!(stages(&scene([1280, 720], 16), 4, part), [Coarse, OneSample, Whole]);
        assert_eq!(stages(&scene([1280, 720], 8), 4, part), [Coarse, Whole]);
        assert_eq!(stages(&scene([48, 32], 16), 4, part), [Whole]);
    }

    #[test]
    fn a_stage_shows_the_same_scene_with_fewer_rays() {
        let fine = scene([101, 3], 16);
        let coarse = staged(&fine, Coarse, 4);
        assert_eq!((coarse.picture.size, coarse.trace.samples), ([25, 1], 1));
        let one = staged(&fine, OneSample, 4);
        assert_eq!((one.picture.size, one.trace.samples), ([101, 3], 1));
        assert_eq!(staged(&fine, Whole, 4), fine);
        assert_eq!(staged(&fine, Stage::Region, 4), fine);
    }

    #[test]
    fn the_divisor_follows_the_time_of_the_first_stage() {
        let options = Options { threads: 1, memory: 1 << 30 };
        let (results, _inbox) = std::sync::mpsc::channel();
        let mut tracer =
            Tracer { options, pool: pool(options), results, latest: None, divisor: FIRST_DIVISOR };
        let scene = scene([1280, 720], 16);
        tracer.adapt(&scene, Coarse, 4, 4.0 * COARSE_SECONDS);
        assert_eq!(tracer.divisor, 8.0);
        tracer.adapt(&scene, Coarse, 8, COARSE_SECONDS / 16.0);
        assert_eq!(tracer.divisor, 2.0);
        tracer.adapt(&scene, OneSample, 9, 9.0 * COARSE_SECONDS);
        assert_eq!(tracer.divisor, 3.0);
        tracer.adapt(&scene, Whole, 9, 16.0 * COARSE_SECONDS);
        assert_eq!(tracer.divisor, 1.0);
    }
}
