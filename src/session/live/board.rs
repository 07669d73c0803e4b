//! What the threads show: pointers under one lock, which nobody holds for longer than a move.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use fearless_simd::{Level, dispatch};

use super::{Event, Glimpse, Inspected, Job, Picked, Shown, Status};
use crate::forest::camera::View;
use crate::geometry::{Geometry, Stack};
use crate::progress::Progress;
use crate::scene::Scene;
use crate::session::cost::Cost;

/// Written by the shader thread, read by the window's.
pub(super) struct Board {
    face: Mutex<Face>,
    wake: Box<dyn Fn() + Send + Sync>,
}

#[derive(Default)]
struct Face {
    shown: Option<Shown>,
    eye: Option<Eye>,
    /// Without its job, whose steps are read when they are asked for.
    status: Status,
    work: Option<Work>,
    /// How many wishes were made, and up to which of them the status speaks.
    wishes: u64,
    heard: u64,
    events: Vec<Event>,
    costs: Arc<BTreeMap<String, Cost>>,
    glimpses: Arc<Vec<Glimpse>>,
    /// Where the person looks, in pixels of the picture.
    cursor: Option<[f64; 2]>,
    pixels: Arc<BTreeMap<[u32; 2], Inspected>>,
    /// Of the pixel that is being taken apart, or was.
    inspection: Arc<Progress>,
}

/// The job that the status tells of.
#[derive(Clone)]
pub(super) struct Work {
    pub(super) what: String,
    pub(super) progress: Arc<Progress>,
    pub(super) target: Target,
}

/// What a cancel stops.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Target {
    Trace,
    Export,
    Keep,
}

/// The scene shown, ready for single rays.
#[derive(Clone)]
pub struct Eye {
    pub(super) scene: Arc<Scene>,
    pub(super) geometry: Arc<Geometry>,
}

impl Eye {
    /// `picture.size` of the scene.
    pub fn size(&self) -> [u32; 2] {
        self.scene.picture.size
    }

    /// The name of the solid with this index.
    pub fn solid_name(&self, index: usize) -> Option<&str> {
        Some(&self.scene.solids.get(index)?.name)
    }

    /// What the ray through a point of the picture meets first.
    pub fn pick(&self, [x, y]: [f64; 2]) -> Option<Picked> {
        let size = self.scene.picture.size;
        let [width, height] = size.map(f64::from);
        if !((0.0..width).contains(&x) && (0.0..height).contains(&y)) {
            return None;
        }
        let view = View::new(&self.scene.camera, size);
        let ray = view.ray(x, y);
        let mut stack = Stack::new(&self.geometry);
        // What moves is picked where it is half way.
        stack.set_time(self.scene.shutter_time().unwrap_or_default() / 2.0);
        let hit = dispatch!(Level::new(), simd => {
            self.geometry.closest_hit(simd, &mut stack, &ray, None)
        })?;
        let solid = self.geometry.solid(hit.primitive) as usize;
        let [_, _, forward] = view.axes();
        let depth = hit.t * ray.direction.dot(forward);
        Some(Picked { solid, material: self.scene.solids[solid].material, depth })
    }
}

impl Board {
    pub(super) fn new(budget: u64, wake: Box<dyn Fn() + Send + Sync>) -> Board {
        let status = Status { budget, ..Status::default() };
        Board { face: Mutex::new(Face { status, ..Face::default() }), wake }
    }

    fn face(&self) -> MutexGuard<'_, Face> {
        self.face.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Tells the window that there is something new. No lock is held.
    pub(super) fn wake(&self) {
        (self.wake)();
    }

    pub(super) fn show(&self, shown: Shown, geometry: Arc<Geometry>) {
        let eye = Eye { scene: shown.scene.clone(), geometry };
        let mut face = self.face();
        let old = (face.shown.replace(shown), face.eye.replace(eye));
        drop(face);
        // Memory is given back without the lock.
        drop(old);
    }

    /// Counts a wish: until the status speaks of it, nothing is in step.
    pub(super) fn wish(&self) -> u64 {
        let mut face = self.face();
        face.inspection.cancel();
        face.wishes += 1;
        face.wishes
    }

    /// Takes a status that speaks of all wishes up to `heard`.
    pub(super) fn report(&self, status: Status, work: Option<Work>, heard: u64) {
        let mut face = self.face();
        (face.status, face.work, face.heard) = (status, work, heard);
    }

    pub(super) fn tell(&self, event: Event) {
        self.face().events.push(event);
        self.wake();
    }

    pub(super) fn price(&self, costs: BTreeMap<String, Cost>) {
        self.face().costs = Arc::new(costs);
        self.wake();
    }

    pub(super) fn glimpse(&self, glimpses: Vec<Glimpse>) {
        self.face().glimpses = Arc::new(glimpses);
    }

    pub(super) fn glimpses(&self) -> Arc<Vec<Glimpse>> {
        self.face().glimpses.clone()
    }

    /// Cancels the job that the status tells of, at once; gives what the rest of the cancel is for.
    pub(super) fn cancel(&self) -> Target {
        let work = self.face().work.clone();
        work.map_or(Target::Trace, |work| {
            work.progress.cancel();
            work.target
        })
    }

    pub(super) fn take_shown(&self) -> Option<Shown> {
        self.face().shown.take()
    }

    pub(super) fn status(&self) -> Status {
        let face = self.face();
        let job = face.work.as_ref();
        let job = job.map(|work| Job { what: work.what.clone(), steps: work.progress.steps() });
        let in_step = face.status.in_step && face.heard == face.wishes;
        Status { job, in_step, ..face.status.clone() }
    }

    pub(super) fn take_events(&self) -> Vec<Event> {
        std::mem::take(&mut self.face().events)
    }

    pub(super) fn costs(&self) -> Arc<BTreeMap<String, Cost>> {
        self.face().costs.clone()
    }

    /// The next wish, or other wanted pixels, interrupt what is begun.
    pub(super) fn begin_inspection(&self) -> Arc<Progress> {
        let begun = Arc::new(Progress::default());
        self.face().inspection = begun.clone();
        begun
    }

    pub(super) fn stop_inspection(&self) {
        self.face().inspection.cancel();
    }

    pub(super) fn show_pixels(&self, pixels: BTreeMap<[u32; 2], Inspected>) {
        let old = std::mem::replace(&mut self.face().pixels, Arc::new(pixels));
        drop(old);
        self.wake();
    }

    pub(super) fn pixels(&self) -> Arc<BTreeMap<[u32; 2], Inspected>> {
        self.face().pixels.clone()
    }

    pub(super) fn look_at(&self, point: Option<[f64; 2]>) {
        self.face().cursor = point;
    }

    pub(super) fn cursor(&self) -> Option<[f64; 2]> {
        self.face().cursor
    }

    pub(super) fn eye(&self) -> Option<Eye> {
        self.face().eye.clone()
    }
}
