//! The costs of the watched parameters, computed one by one while nothing else is to be done.

use std::collections::{BTreeMap, VecDeque};
use std::time::{Duration, Instant};

use super::Stage;
use super::board::Board;
use crate::session::Session;
use crate::session::cost::{Cost, cost, cost_of_preview};

/// How long edits must have rested.
const REST: Duration = Duration::from_millis(100);
/// How often costs are shown while more are computed.
const SHOW: Duration = Duration::from_millis(50);

/// What is known of the scene shown, and what is still to be asked.
#[derive(Default)]
pub(super) struct Badges {
    watched: Vec<String>,
    known: BTreeMap<String, Cost>,
    open: VecDeque<String>,
    /// When to begin, if there is a picture.
    due: Option<Instant>,
    /// Whether the picture shown is whole.
    whole: bool,
    shown: Option<Instant>,
}

impl Badges {
    /// Names the parameters.
    pub(super) fn watch(&mut self, paths: Vec<String>) {
        if self.watched != paths {
            self.open = paths.iter().filter(|p| !self.known.contains_key(*p)).cloned().collect();
            self.watched = paths;
        }
    }

    /// The picture shows another scene now, or the same one at another stage.
    pub(super) fn renew(&mut self, stage: Stage, board: &Board) {
        self.known.clear();
        self.open = self.watched.iter().cloned().collect();
        self.due = Some(Instant::now() + REST);
        // What was said of a whole picture does not hold for one that is being traced.
        let was_whole = std::mem::replace(&mut self.whole, stage == Stage::Whole);
        if was_whole && !self.whole {
            board.price(BTreeMap::new());
        }
    }

    /// How long until there is something to compute.
    pub(super) fn wait(&self) -> Option<Duration> {
        let due = self.due.filter(|_| !self.open.is_empty())?;
        Some(due.saturating_duration_since(Instant::now()))
    }

    /// Computes one cost, if it is time, and shows what is known from time to time.
    pub(super) fn work(&mut self, session: &mut Session, board: &Board) {
        if self.wait() != Some(Duration::ZERO) {
            return;
        }
        if let Some(path) = self.open.pop_front()
            && let Some(cost) = match self.whole {
                true => cost(session, &path),
                false => cost_of_preview(session, &path),
            }
        {
            self.known.insert(path, cost);
        }
        let last = self.open.is_empty();
        if last || self.shown.is_none_or(|at| at.elapsed() > SHOW) && self.known.len() > 1 {
            self.shown = Some(Instant::now());
            board.price(self.known.clone());
        }
    }
}
