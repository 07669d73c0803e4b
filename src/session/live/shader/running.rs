//! A trace that is under way, and when it is given up for another.

use std::sync::atomic::Ordering::Relaxed;
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use super::super::mending::Mending;
use super::super::tracer::Control;
use crate::forest::Forest;
use crate::scene::Scene;
use crate::scene::change::Change;

/// A first stage that takes longer than this is not finished for its own sake.
const PATIENCE: Duration = Duration::from_millis(500);

const TRACING: &str = "tracing";

/// A trace that the tracer works on, or a cache that it opens.
pub(super) struct Running {
    pub(super) id: u64,
    pub(super) scene: Arc<Scene>,
    /// What is done, and why.
    pub(super) verb: &'static str,
    pub(super) reason: String,
    pub(super) control: Arc<Control>,
    pub(super) reuse: Arc<Mutex<Option<Forest>>>,
    pub(super) taken: Instant,
    /// Cancelled for the sake of another scene; otherwise a cancel was the person's.
    pub(super) dropped: bool,
    /// What of the whole picture is grown again, instead of all.
    pub(super) mending: Option<Mending>,
}

impl Running {
    /// A trace whose number is not known yet.
    pub(super) fn new(scene: Arc<Scene>, taken: Instant) -> Running {
        Running {
            id: 0,
            scene,
            verb: TRACING,
            reason: String::new(),
            control: Arc::default(),
            reuse: Arc::default(),
            taken,
            dropped: false,
            mending: None,
        }
    }

    /// Whether it traces, and does not open a cache.
    pub(super) fn is_trace(&self) -> bool {
        self.verb == TRACING
    }

    /// Goes on if its rays are those of `wanted`.
    pub(super) fn consider(&mut self, wanted: &Scene) {
        if Change::between(&self.scene, wanted).moves_rays.is_some() {
            self.supersede();
        } else {
            self.control.superseded.store(false, Relaxed);
        }
    }

    /// Another scene waits. A first stage is finished all the same, so that a camera that is
    /// dragged without rest shows pictures.
    pub(super) fn supersede(&mut self) {
        if self.control.past_first.load(Relaxed) || self.taken.elapsed() > PATIENCE {
            self.drop_it();
        } else {
            self.control.superseded.store(true, Relaxed);
        }
    }

    pub(super) fn drop_it(&mut self) {
        self.dropped = true;
        self.control.progress.cancel();
    }
}
