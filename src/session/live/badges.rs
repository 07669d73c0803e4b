//! The costs of the watched parameters, computed one by one while nothing else is to be done.

use std::collections::{BTreeMap, VecDeque};
use std::time::{Duration, Instant};

use super::board::Board;
use crate::session::Session;
use crate::session::cost::{Cost, cost};

/// How long edits must have rested.
const REST: Duration = Duration::from_millis(100);
/// How often costs are shown while more are computed.
const SHOW: Duration = Duration::from_millis(50);

/// What is known of the whole picture's scene, and what is still to be asked.
#[derive(Default)]
pub(super) struct Badges {
    watched: Vec<String>,
    known: BTreeMap<String, Cost>,
    open: VecDeque<String>,
    /// When to begin, if the picture is whole.
    due: Option<Instant>,
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

    /// The whole picture shows another scene now.
    pub(super) fn renew(&mut self) {
        self.known.clear();
        self.open = self.watched.iter().cloned().collect();
        self.due = Some(Instant::now() + REST);
    }

    /// The picture shown is not whole: its costs are not known.
    pub(super) fn withdraw(&mut self, board: &Board) {
        if self.due.take().is_some() {
            self.known.clear();
            board.price(BTreeMap::new());
        }
    }

    /// How long until there is something to compute.
    pub(super) fn wait(&self) -> Option<Duration> {
        let due = self.due.filter(|_| !self.open.is_empty())?;
        Some(due.saturating_duration_since(Instant::now()))
    }

    /// Computes one cost, if it is time, and shows what is known from time to time.
    pub(super) fn work(&mut self, session: &Session, board: &Board) {
        if self.wait() != Some(Duration::ZERO) {
            return;
        }
        if let Some(path) = self.open.pop_front()
            && let Some(cost) = cost(session, &path)
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
