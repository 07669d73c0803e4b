//! How far a long job has come, and the wish to stop it, for a while or for good.

use std::sync::atomic::{AtomicU8, AtomicU64, Ordering::Relaxed};
use std::sync::{Condvar, Mutex, PoisonError};

/// Shared by a job and whoever watches it. The job calls [`Progress::check`] often enough that a
/// cancel is obeyed within 100 ms.
#[derive(Debug, Default)]
pub struct Progress {
    /// [`CANCEL`], [`PAUSE`], both or neither.
    wishes: AtomicU8,
    /// Where a paused job waits. Wishes change while the lock is held.
    gate: Mutex<()>,
    changed: Condvar,
    done: AtomicU64,
    total: AtomicU64,
}

const CANCEL: u8 = 1;
const PAUSE: u8 = 2;

/// The job was cancelled; what it had made is dropped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cancelled;

impl Progress {
    /// Asks the job to stop, also if it is paused.
    pub fn cancel(&self) {
        self.wish(|wishes| wishes | CANCEL);
    }

    /// Asks the job to wait where it is, or to go on.
    pub fn pause(&self, wait: bool) {
        self.wish(|wishes| if wait { wishes | PAUSE } else { wishes & !PAUSE });
    }

    fn wish(&self, change: impl Fn(u8) -> u8) {
        let _gate = self.gate.lock().unwrap_or_else(PoisonError::into_inner);
        self.wishes.store(change(self.wishes.load(Relaxed)), Relaxed);
        self.changed.notify_all();
    }

    /// Whether a cancel was asked for.
    pub fn is_cancelled(&self) -> bool {
        self.wishes.load(Relaxed) & CANCEL != 0
    }

    /// `Err` once a cancel was asked for; does not return while the job is paused. Costs one load
    /// where nothing is asked for: call it in inner loops, but never with a lock held.
    #[inline(always)]
    pub fn check(&self) -> Result<(), Cancelled> {
        if self.wishes.load(Relaxed) == 0 { Ok(()) } else { self.obey() }
    }

    #[cold]
    fn obey(&self) -> Result<(), Cancelled> {
        let mut gate = self.gate.lock().unwrap_or_else(PoisonError::into_inner);
        while self.wishes.load(Relaxed) == PAUSE {
            gate = self.changed.wait(gate).unwrap_or_else(PoisonError::into_inner);
        }
        if self.is_cancelled() { Err(Cancelled) } else { Ok(()) }
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

#[cfg(test)]
mod tests {
    use std::sync::mpsc::{RecvTimeoutError, channel};
    use std::time::Duration;

    use super::*;

    /// Runs a job that checks for ever; `control` gets its steps and tells it what to do.
    fn with_job(control: impl FnOnce(&Progress, &std::sync::mpsc::Receiver<()>)) {
        let progress = Progress::default();
        let (step, steps) = channel();
        std::thread::scope(|scope| {
            let progress = &progress;
            scope.spawn(move || {
                while progress.check().is_ok() {
                    let _ = step.send(());
                }
            });
            control(progress, &steps);
            progress.cancel();
        });
    }

    /// Receives what was sent before the job obeyed; then it is quiet.
    fn falls_quiet(steps: &std::sync::mpsc::Receiver<()>) -> bool {
        let moment = Duration::from_millis(50);
        (0..100_000_000).find(|_| steps.recv_timeout(moment).is_err()).is_some()
    }

    #[test]
    fn a_paused_job_waits_and_goes_on() {
        with_job(|progress, steps| {
            steps.recv().unwrap();
            progress.pause(true);
            assert!(falls_quiet(steps));
            progress.pause(false);
            steps.recv_timeout(Duration::from_secs(60)).unwrap();
        });
    }

    #[test]
    fn a_paused_job_obeys_a_cancel() {
        with_job(|progress, steps| {
            progress.pause(true);
            assert!(falls_quiet(steps));
            progress.cancel();
            let last = steps.recv_timeout(Duration::from_secs(60));
            assert_eq!(last, Err(RecvTimeoutError::Disconnected));
        });
    }
}
