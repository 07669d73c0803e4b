//! A session behind threads: the newest wanted scene wins, pictures arrive coarse first, nothing blocks.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

use super::cost::Cost;
use super::{EditReport, Options};
use crate::film::Frame;
use crate::film::write::Format;
use crate::scene::Scene;

/// How fine a picture is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Stage {
    /// Fewer pixels, one sample each.
    Coarse,
    /// All pixels, one sample each.
    OneSample,
    /// What the scene asks for.
    Whole,
}

/// A picture to show. `frame` is exactly what a fresh trace of `scene` gives if `stage` is
/// [`Stage::Whole`]; coarser stages show the same scene with fewer pixels or samples.
#[derive(Clone)]
pub struct Shown {
    /// The picture; at a coarse stage smaller than `scene.picture.size`.
    pub frame: Arc<Frame>,
    /// What it shows.
    pub scene: Arc<Scene>,
    /// How fine it is.
    pub stage: Stage,
}

/// What the threads are doing, for the status line.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Status {
    /// The trace or export that runs.
    pub job: Option<Job>,
    /// The latest finished edit.
    pub last: Option<EditReport>,
    /// Whether the picture shown is whole and shows the newest wanted scene.
    pub in_step: bool,
    /// Whether the newest wanted scene is not shown because its trace was cancelled or failed: the
    /// picture before it stays.
    pub held: bool,
    /// Bytes of kept trees, matrix and highlight lists.
    pub bytes: u64,
    /// The budget for them.
    pub budget: u64,
}

/// A running trace or export.
#[derive(Clone, Debug, PartialEq)]
pub struct Job {
    /// What it does and why: "tracing: camera.eye moves rays".
    pub what: String,
    /// Steps done and in all.
    pub steps: (u64, u64),
}

/// Something that happened once, for the person.
#[derive(Clone, Debug, PartialEq)]
pub enum Event {
    /// A picture file was written.
    Exported(PathBuf),
    /// A trace or an export failed: what, why, and the way out.
    Failed(String),
}

/// A picture file that is wanted.
#[derive(Clone, Debug)]
pub struct Export {
    /// Where to.
    pub path: PathBuf,
    /// Its format.
    pub format: Format,
    /// Its size; at the scene's own it holds the bytes that are shown.
    pub size: [u32; 2],
}

/// What a pixel shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Picked {
    /// Index of the solid.
    pub solid: usize,
    /// Index of the material.
    pub material: usize,
}

/// A session that runs in threads of its own. All calls return at once.
pub struct Live {}

impl Live {
    /// Starts the threads. `wake` is called from them whenever there is something new.
    pub fn new(_options: Options, _wake: impl Fn() + Send + Sync + 'static) -> Live {
        todo!()
    }

    /// Makes `scene` the wanted one. A running trace goes on if the edit does not concern its rays.
    pub fn want(&self, _scene: Arc<Scene>) {
        todo!()
    }

    /// The newest picture, if it is newer than the one taken before.
    pub fn take_shown(&self) -> Option<Shown> {
        todo!()
    }

    /// What the threads are doing.
    pub fn status(&self) -> Status {
        todo!()
    }

    /// What has happened since the last call.
    pub fn take_events(&self) -> Vec<Event> {
        todo!()
    }

    /// Stops the running trace or export. The last whole picture stays or comes back.
    pub fn cancel(&self) {
        todo!()
    }

    /// Traces the wanted scene after it was held.
    pub fn resume(&self) {
        todo!()
    }

    /// Names the parameters whose costs are wanted from now on: those on the screen.
    pub fn watch_costs(&self, _paths: Vec<String>) {
        todo!()
    }

    /// The newest known costs of the watched parameters, of the scene shown.
    pub fn costs(&self) -> Arc<BTreeMap<String, Cost>> {
        todo!()
    }

    /// Writes a picture of the newest wanted scene, after its trace if that still runs.
    pub fn export(&self, _export: Export) {
        todo!()
    }

    /// What lies under a point of the picture shown, in pixels of `picture.size`.
    pub fn pick(&self, _point: [f64; 2]) -> Option<Picked> {
        todo!()
    }
}
