//! Hands pictures, status and progress to the window.

use std::sync::Arc;
use std::time::Instant;

use super::keep::Keeping;
use super::{Pending, Shader, TICK};
use crate::session::Session;
use crate::session::live::board::{self, Target};
use crate::session::live::mending::Mending;
use crate::session::live::{Shown, Stage, Status};
use crate::shade::gpu::{Picture, Product};

impl Shader {
    /// Hands the newest picture to the window.
    pub(super) fn show(&mut self) {
        self.glances.renew();
        self.shown_at = Some(Instant::now());
        self.curious.renew();
        if let Some((frame, scene, geometry)) = self.mending().map(|mending| {
            (mending.frame(), mending.scene.clone(), mending.regrow.geometry.clone())
        }) {
            self.board.show(
                Shown {
                    frame: Some(frame),
                    card: None,
                    scene,
                    stage: Stage::Mending,
                    map: None,
                    marked: None,
                },
                geometry,
            );
            self.badges.renew(Stage::Mending, &self.board);
            self.report();
            return self.board.wake();
        }
        let card = if self.preview.is_none() { self.on_card() } else { None };
        self.hand_over(card);
    }

    /// Hands the newest picture to the window, as the processor and the card have it.
    pub(super) fn hand_over(&mut self, card: Option<Arc<Picture>>) {
        if let Some(whole) = self.whole.as_mut().filter(|_| card.is_none() || self.marks) {
            whole.catch_up();
        }
        let marked = self.marked();
        let (session, scene, stage) = match (&self.preview, &self.whole) {
            (Some(p), _) => (&p.session, p.scene.clone(), p.stage),
            (None, Some(whole)) => (whole, whole.shared_scene(), Stage::Whole),
            (None, None) => return,
        };
        let shown = Shown {
            frame: match &self.preview {
                Some(preview) => Some(preview.frame()),
                None => (!session.owes_frame()).then(|| session.shared_frame()),
            },
            card,
            scene,
            stage,
            map: session.sample_map().filter(|_| stage == Stage::Whole),
            marked,
        };
        self.board.show(shown, session.shared_geometry());
        self.badges.renew(stage, &self.board);
        self.report();
        self.board.wake();
    }

    /// Hands the newest status to the window.
    pub(super) fn report(&self) {
        let shown = self.preview.as_ref().map(|p| &p.session).or(self.whole.as_ref());
        let status = Status {
            job: None,
            last: self.last.clone(),
            opened: self.opened,
            in_step: self.in_step(),
            held: self.hold.is_some(),
            pending: self.mending().map_or(0, Mending::pixels),
            bytes: self.whole.as_ref().or(shown).map_or(0, Session::kept_bytes),
            matrix_bytes: self.whole.as_ref().map_or(0, matrix_bytes),
            budget: self.options.memory,
            card_bytes: self.product.as_ref().map_or(0, Product::bytes),
        };
        let trace = self.job.as_ref().filter(|job| !job.dropped).map(|job| board::Work {
            what: format!("{}: {}", job.verb, job.reason),
            progress: job.control.progress.clone(),
            target: Target::Trace,
        });
        let export = || {
            let Pending { what, progress } = self.exports.front()?;
            let (what, progress) = (what.clone(), progress.clone());
            Some(board::Work { what, progress, target: Target::Export })
        };
        let leaving = || Some(self.leaving.as_ref()?.work());
        let kept = || Some(self.keeping.as_ref()?.work());
        let work = trace.or_else(export).or_else(leaving).or_else(kept);
        self.board.report(status, work, self.heard);
    }

    /// Wakes the window if a job has come further.
    pub(super) fn tell_progress(&mut self) {
        if self.told_at.elapsed() < TICK {
            return;
        }
        let trace = self.job.as_ref().map(|job| &job.control.progress);
        let progress = trace.or(self.exports.front().map(|export| &export.progress));
        let kept = || self.keeping.as_ref().map(Keeping::steps);
        let steps = progress.map(|progress| progress.steps()).or_else(kept).unwrap_or((0, 0));
        if std::mem::replace(&mut self.told, steps) != steps {
            self.told_at = Instant::now();
            self.board.wake();
        }
    }
}

/// Bytes of matrix and highlight lists.
fn matrix_bytes(session: &Session) -> u64 {
    let transport = session.transport();
    (transport.bytes() + transport.highlight_bytes()) as u64
}
