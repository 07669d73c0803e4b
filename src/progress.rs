//! How far a long job has come, and the wish to stop it.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering::Relaxed};

/// Shared by a job and whoever watches it. The job calls [`Progress::check`] often enough that a
/// cancel is obeyed within 100 ms.
#[derive(Debug, Default)]
pub struct Progress {
    cancel: AtomicBool,
    done: AtomicU64,
    total: AtomicU64,
}

/// The job was cancelled; what it had made is dropped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cancelled;

impl Progress {
    /// Asks the job to stop.
    pub fn cancel(&self) {
        self.cancel.store(true, Relaxed);
    }

    /// `Err` once a cancel was asked for. Costs one load: call it in inner loops.
    #[inline(always)]
    pub fn check(&self) -> Result<(), Cancelled> {
        if self.cancel.load(Relaxed) { Err(Cancelled) } else { Ok(()) }
    }

    /// Begins a phase of `total` steps.
    pub fn begin(&self, total: u64) {
        self.done.store(0, Relaxed);
        self.total.store(total, Relaxed);
    }

    /// One step of the phase is done.
    pub fn step(&self) {
        self.done.fetch_add(1, Relaxed);
    }

    /// Steps done and steps in all, of the present phase.
    pub fn steps(&self) -> (u64, u64) {
        (self.done.load(Relaxed), self.total.load(Relaxed))
    }
}
