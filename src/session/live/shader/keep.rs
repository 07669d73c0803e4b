//! Kept caches: opened before a scene is traced, written while nothing else is to be done.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

use super::{Running, Shader, UNTRACED};
use crate::progress::Progress;
use crate::scene::Scene;
use crate::session::Session;
use crate::session::cache::{CacheError, CacheReport, Fault, Writing};
use crate::session::live::Event;
use crate::session::live::board::{self, Target};

/// How long edits must have rested.
const REST: Duration = Duration::from_millis(300);
/// How long is written until the next look for edits.
const TURN: Duration = Duration::from_millis(8);

/// A cache that is wanted.
pub(super) struct Keeping {
    path: PathBuf,
    progress: Arc<Progress>,
    /// Not before then.
    due: Instant,
    /// What was written of it; an edit throws it away.
    writing: Option<Writing>,
}

impl Keeping {
    /// What the status tells of it.
    pub(super) fn work(&self) -> board::Work {
        board::Work {
            what: format!("keeping what was traced: {}", name(&self.path)),
            progress: self.progress.clone(),
            target: Target::Keep,
        }
    }

    /// Steps done and in all.
    pub(super) fn steps(&self) -> (u64, u64) {
        self.progress.steps()
    }

    /// Writes for a moment; gives a report when the file is whole.
    fn go_on(&mut self, session: &Session) -> Result<Option<CacheReport>, CacheError> {
        let begun = Instant::now();
        let own = self.writing.take().filter(|writing| writing.is_of(session));
        let mut writing = match own {
            Some(writing) => writing,
            None => {
                let writing = Writing::begin(session, &self.path, false)?;
                self.progress.begin(writing.parts());
                writing
            }
        };
        let some = session.pool().current_num_threads();
        while !writing.is_complete() {
            if begun.elapsed() > TURN {
                self.writing = Some(writing);
                return Ok(None);
            }
            for _ in 0..writing.go_on(session, some)? {
                self.progress.step();
            }
        }
        writing.finish().map(Some)
    }
}

/// What is to be kept of a document in whose place another one comes: the picture stays as it is.
pub(super) struct Leaving {
    keeping: Keeping,
    /// What is kept.
    scene: Arc<Scene>,
    /// Taken when another picture comes; until then it is the whole picture.
    session: Option<Session>,
}

impl Leaving {
    /// What the status tells of it.
    pub(super) fn work(&self) -> board::Work {
        self.keeping.work()
    }

    /// The session to be kept, unless it was edited.
    fn session<'a>(&'a self, whole: Option<&'a Session>) -> Option<&'a Session> {
        let same = |whole: &&Session| Arc::ptr_eq(&whole.shared_scene(), &self.scene);
        self.session.as_ref().or(whole.filter(same))
    }
}

impl Shader {
    /// What is wanted from now on is another document: what is to be kept is of the one before.
    pub(super) fn leave(&mut self) {
        self.is_other = true;
        if !self.in_step() {
            return self.refuse_to_keep("another scene was opened");
        }
        let Some(keeping) = self.keeping.take() else { return };
        self.finish_leaving();
        if let Some(whole) = &self.whole {
            self.leaving = Some(Leaving { keeping, scene: whole.shared_scene(), session: None });
        }
    }

    /// Shows another whole picture; the one before stays as long as it is being kept.
    pub(super) fn replace_whole(&mut self, session: Session) {
        self.is_other = false;
        let Some(mut old) = self.whole.replace(session) else { return };
        if let Some(leaving) = &mut self.leaving
            && leaving.session(Some(&old)).is_some()
        {
            drop(old.take_trees());
            leaving.session.get_or_insert(old);
        }
    }

    /// Writes some of what is kept of the document before. Where the other one needed no other picture,
    /// nothing is left of it.
    fn work_on_leaving(&mut self) {
        let Some(mut leaving) = self.leaving.take() else { return };
        if leaving.session(self.whole.as_ref()).is_none() {
            return;
        }
        let Leaving { scene: _, session, keeping } = &mut leaving;
        let Some(session) = session.as_ref().or(self.whole.as_ref()) else { return };
        match keeping.go_on(session) {
            Ok(None) => self.leaving = Some(leaving),
            written => self.tell_kept(leaving.keeping.path, written),
        }
    }

    /// The same to its end: for what is wanted again, or when the next document is left.
    fn finish_leaving(&mut self) {
        while self.leaving.is_some() {
            self.work_on_leaving();
        }
    }

    /// Wants the picture to be kept, as soon as it is whole.
    pub(super) fn keep(&mut self, path: PathBuf) {
        let (progress, due) = (Arc::default(), Instant::now());
        self.keeping = Some(Keeping { path, progress, due, writing: None });
        if self.wanted.is_none() {
            self.refuse_to_keep("no scene is open");
        } else if self.hold.is_some() {
            self.refuse_to_keep(UNTRACED);
        }
    }

    pub(super) fn refuse_to_keep(&mut self, cause: &str) {
        let Some(Keeping { path, .. }) = self.keeping.take() else { return };
        self.board.tell(Event::Failed(format!("{} was not written: {cause}", path.display())));
    }

    /// There was an edit: whatever is written waits until edits rest, and begins anew.
    pub(super) fn interrupt_keeping(&mut self) {
        if let Some(keeping) = &mut self.keeping {
            (keeping.writing, keeping.due) = (None, Instant::now() + REST);
            keeping.progress.begin(0);
        }
    }

    /// How long until something can be written.
    pub(super) fn keeping_wait(&self) -> Option<Duration> {
        if self.leaving.is_some() {
            return Some(Duration::ZERO);
        }
        let keeping = self.keeping.as_ref().filter(|_| self.in_step())?;
        Some(keeping.due.saturating_duration_since(Instant::now()))
    }

    /// Writes some of what is to be kept, if it is time.
    pub(super) fn work_on_keeping(&mut self) {
        if self.leaving.is_some() {
            return self.work_on_leaving();
        }
        if self.keeping_wait() != Some(Duration::ZERO) {
            return;
        }
        let (Some(mut keeping), Some(whole)) = (self.keeping.take(), &self.whole) else { return };
        match keeping.go_on(whole) {
            Ok(None) => self.keeping = Some(keeping),
            written => self.tell_kept(keeping.path, written),
        }
    }

    fn tell_kept(&mut self, path: PathBuf, written: Result<Option<CacheReport>, CacheError>) {
        self.board.tell(match written {
            Ok(report) => Event::Kept { path, bytes: report.map_or(0, |r| r.file_bytes) },
            Err(error) => Event::Failed(format!("what was traced is not kept: {error}")),
        });
        self.report();
        self.board.wake();
    }

    /// Sends a cache to the tracer, which is free: it may hold what is wanted, or nearly so.
    pub(super) fn begin_opening(&mut self, scene: Arc<Scene>, cache: PathBuf, taken: Instant) {
        if self.leaving.as_ref().is_some_and(|leaving| leaving.keeping.path == cache) {
            self.finish_leaving();
        }
        let reason = name(&cache);
        let job = Running { verb: "opening", reason, ..Running::new(scene, taken) };
        self.send(job, None, None, Some(cache));
    }

    /// Takes what a cache held. What it lacks to the wanted scene is an edit like any other.
    pub(super) fn take_opened(&mut self, mut session: Session, taken: Instant) {
        let Some(wanted) = self.wanted.clone() else { return };
        session.move_to(&self.pool);
        self.replace_whole(session);
        self.opened = true;
        self.opened = self.reach_whole(&wanted, taken).is_ok();
    }

    /// A cache did not hold what it should: the scene is traced.
    pub(super) fn not_opened(&self, error: &CacheError) {
        if error.fault != Fault::Absent {
            self.board.tell(Event::Failed(format!("what was kept is not used: {error}")));
        }
    }
}

fn name(path: &Path) -> String {
    path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned()
}
