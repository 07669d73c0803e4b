//! The whole picture while some of it is grown again.

use std::sync::Arc;

use super::{Hold, Running, Shader, TICK};
use crate::scene::Scene;
use crate::scene::change::Change;
use crate::session::live::Event;
use crate::session::live::mending::Mending;
use crate::session::regrow::Patch;
use crate::session::{EditReport, Work};

impl Shader {
    /// What is shown of the whole picture while some of it is grown again.
    pub(super) fn mending(&self) -> Option<&Mending> {
        let job = self.job.as_ref().filter(|job| !job.dropped && self.hold.is_none())?;
        job.mending.as_ref()
    }

    /// Shows a newer wish, for which `work` is to be done, in what is being mended, if the rays that
    /// are cast for it are also the wish's.
    pub(super) fn mend_for(&mut self, wanted: Arc<Scene>, work: Work) {
        let Some(job) = self.job.as_mut().filter(|job| !job.dropped) else { return };
        let moves = Change::between(&job.scene, &wanted).moves_rays.is_some();
        let (Some(mending), Some(whole), Work::Regrow(plan), false) =
            (&mut job.mending, &mut self.whole, work, moves)
        else {
            return;
        };
        let coarse = self.preview.as_ref().map(|preview| preview.session.shared_frame());
        mending.show(whole, wanted, &plan, coarse.as_deref());
        self.show();
    }

    /// Takes a part of what is grown again.
    pub(super) fn grown(&mut self, id: u64, patch: Patch) {
        let Some(job) = self.job.as_mut().filter(|job| job.id == id) else { return };
        let Some(mending) = &mut job.mending else { return };
        mending.take(patch);
        if self.shown_at.is_none_or(|at| at.elapsed() > TICK) && self.mending().is_some() {
            self.show();
        }
    }

    /// Puts what was grown into the whole picture, and shows it with the newest edits.
    pub(super) fn take_mended(&mut self, job: Running) {
        let (Some(mending), Some(whole)) = (job.mending, &mut self.whole) else { return };
        let regrow = mending.regrow.clone();
        match whole.take_patches(&regrow, mending.into_patches()) {
            Ok(report) => {
                if let Some(wanted) = &self.wanted {
                    // What needs more is done next.
                    let _ = whole.edit_without_rays(wanted);
                }
                let milliseconds = job.taken.elapsed().as_secs_f64() * 1e3;
                self.last = Some(EditReport { milliseconds, ..report });
                (self.opened, self.is_other) = (false, false);
                self.preview = None;
                self.show();
            }
            Err(error) => {
                self.board.tell(Event::Failed(format!("the scene was not traced: {error}")));
                self.put_on_hold(true);
                self.hold = Some(Hold { scene: job.scene, failed: true });
            }
        }
    }
}
