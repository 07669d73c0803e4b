//! The thread that owns the pictures: takes wishes, shades what needs no ray, sends off the rest.

mod card;
mod clipping;
mod curious;
mod exports;
mod glances;
mod keep;
mod mend;
mod region;
mod running;
mod show;

use std::collections::VecDeque;
use std::path::PathBuf;
use std::sync::atomic::Ordering::Relaxed;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use rayon::ThreadPool;

use super::badges::Badges;
use super::board::{Board, Target};
use super::mending::Mending;
use super::tracer::{self, Compiled, Outcome, staged};
use super::{Event, Export, Glance, Stage, export, guarded, pool};
use crate::film::Film;
use crate::film::plates::Region;
use crate::progress::Progress;
use crate::scene::Scene;
use crate::scene::change::Change;
use crate::session::regrow::{Patch, Regrow};
use crate::session::{Class, EditReport, Options, Session, Work};
use crate::shade::gpu::{Gpu, Picture, Product};
use curious::Curiosity;
use glances::Glances;
use keep::{Keeping, Leaving};
use running::Running;

/// What the shader is told, by the window and by the other threads.
pub(super) enum Message {
    Want {
        scene: Arc<Scene>,
        /// How many wishes there were with it.
        number: u64,
        /// A cache that may hold it.
        cache: Option<PathBuf>,
    },
    /// What was traced, to be written there.
    Keep(PathBuf),
    /// The wishes from now on are another document's.
    Leave,
    Cancel(Target),
    Resume,
    Watch(Vec<String>),
    DrawOn(Option<Gpu>),
    /// Pixels to be taken apart.
    Inspect(Vec<[u32; 2]>),
    Glance(Vec<Glance>),
    MarkClipped(bool),
    /// The part of the picture that is traced first.
    LookFirst(Option<Region>),
    Export(Export),
    /// A stage before the whole picture.
    Staged {
        id: u64,
        stage: Stage,
        divisor: u32,
        session: Box<Session>,
    },
    /// A part of what is grown again.
    Grown {
        id: u64,
        patch: Box<Patch>,
    },
    /// A trace ended.
    Ended {
        id: u64,
        outcome: Outcome,
    },
    /// The oldest export ended.
    Exported(export::Outcome),
    Quit,
}

/// How long a trace stays paused after an edit.
const YIELD: Duration = Duration::from_millis(150);
/// How often the window is told of a job's progress.
const TICK: Duration = Duration::from_millis(50);

/// Why a scene is traced of which nothing is known.
const NEW: &str = "the scene is new";
const UNTRACED: &str =
    "the picture was not traced to its end: let it be traced, and export it again";

/// Sessions before the whole one, and what they show.
struct Preview {
    session: Session,
    stage: Stage,
    divisor: u32,
    /// The scene shown, at its full size.
    scene: Arc<Scene>,
    /// The preview before it, which shows where this one was not traced.
    behind: Option<Box<Preview>>,
}

/// A wish that is not traced.
struct Hold {
    scene: Arc<Scene>,
    /// Its trace failed: any other scene is tried. A cancelled one waits for other rays.
    failed: bool,
}

/// An export that was sent off.
struct Pending {
    what: String,
    progress: Arc<Progress>,
}

pub(super) struct Shader {
    options: Options,
    board: Arc<Board>,
    inbox: Receiver<Message>,
    traces: Sender<tracer::Task>,
    exporter: Sender<export::Task>,
    pool: Arc<ThreadPool>,
    wanted: Option<Arc<Scene>>,
    whole: Option<Session>,
    /// Draws the whole picture on a graphics card too.
    product: Option<Product>,
    /// What it drew last.
    on_card: Option<Arc<Picture>>,
    /// Whether clipped pixels are marked.
    marks: bool,
    /// Memory for it.
    film: Film,
    /// The part of the picture that is traced first.
    region: Option<Region>,
    /// Shown instead of the whole picture while there is one.
    preview: Option<Preview>,
    job: Option<Running>,
    jobs: u64,
    hold: Option<Hold>,
    /// A cache to be opened before the wanted scene is traced.
    cache: Option<PathBuf>,
    keeping: Option<Keeping>,
    /// The same of the document before; first in line.
    leaving: Option<Leaving>,
    /// What is wanted is another document than what was traced last.
    is_other: bool,
    last: Option<EditReport>,
    /// Whether that was the opening of a cache.
    opened: bool,
    /// Until when jobs leave the cores to edits.
    busy_until: Option<Instant>,
    /// Exports at the size of the picture, until it is whole.
    waiting: Vec<Export>,
    exports: VecDeque<Pending>,
    badges: Badges,
    curious: Curiosity,
    glances: Glances,
    /// The number of the newest wish.
    heard: u64,
    /// The progress last told, and when.
    told: (u64, u64),
    told_at: Instant,
    /// When a picture was shown last.
    shown_at: Option<Instant>,
}

impl Shader {
    /// To be run on the thread that it is for: the pool may be that thread.
    pub(super) fn new(
        options: Options,
        board: Arc<Board>,
        inbox: Receiver<Message>,
        traces: Sender<tracer::Task>,
        exporter: Sender<export::Task>,
    ) -> Shader {
        Shader {
            options,
            board,
            inbox,
            traces,
            exporter,
            pool: pool(options),
            wanted: None,
            whole: None,
            product: None,
            on_card: None,
            marks: false,
            film: Film::default(),
            region: None,
            preview: None,
            job: None,
            jobs: 0,
            hold: None,
            cache: None,
            keeping: None,
            leaving: None,
            is_other: false,
            last: None,
            opened: false,
            busy_until: None,
            waiting: Vec::new(),
            exports: VecDeque::new(),
            badges: Badges::default(),
            curious: Curiosity::default(),
            glances: Glances::default(),
            heard: 0,
            told: (0, 0),
            told_at: Instant::now(),
            shown_at: None,
        }
    }

    /// Works until it is told to quit.
    pub(super) fn run(mut self) {
        loop {
            let messages = match self.inbox.recv_timeout(self.patience()) {
                Ok(first) => newest_wish(std::iter::once(first).chain(self.inbox.try_iter())),
                Err(RecvTimeoutError::Timeout) => Vec::new(),
                Err(RecvTimeoutError::Disconnected) => break,
            };
            if messages.iter().any(|m| matches!(m, Message::Quit)) {
                break;
            }
            if let Err(text) = guarded(|| self.turn(messages)) {
                self.begin_anew(text);
            }
        }
        self.job.iter().for_each(|job| job.control.progress.cancel());
        self.exports.iter().for_each(|export| export.progress.cancel());
    }

    /// How long there is nothing to do, unless a message comes.
    fn patience(&self) -> Duration {
        if self.may_catch_up() {
            return Duration::ZERO;
        }
        let working = self.job.is_some() || !self.exports.is_empty();
        let yielded = self.busy_until.map(|t| t.saturating_duration_since(Instant::now()));
        let idle =
            [self.badges.wait(), self.keeping_wait(), self.curious_wait(), self.glance_wait()];
        let waits = [working.then_some(TICK), yielded].into_iter().chain(idle);
        waits.flatten().min().unwrap_or(Duration::from_secs(3600))
    }

    fn turn(&mut self, messages: Vec<Message>) {
        let idle = messages.is_empty();
        for message in messages {
            self.handle(message);
        }
        self.send_waiting();
        self.pace();
        if !idle {
            self.report();
            self.board.wake();
        } else if self.may_catch_up() {
            self.catch_up();
        } else if let Some(shown) =
            self.preview.as_mut().map(|p| &mut p.session).or(self.whole.as_mut())
        {
            self.badges.work(shown, &self.board);
            self.work_on_pixels();
            self.work_on_keeping();
            self.glance();
        }
        if self.in_step() {
            self.cache = None;
        }
        self.tell_progress();
    }

    fn handle(&mut self, message: Message) {
        match message {
            Message::Want { scene, number, cache } => {
                self.heard = self.heard.max(number);
                self.want(scene, cache);
            }
            Message::Keep(path) => self.keep(path),
            Message::Leave => self.leave(),
            Message::Cancel(target) => self.cancel(target),
            Message::Resume => self.resume(),
            Message::Watch(paths) => self.badges.watch(paths),
            Message::DrawOn(gpu) => self.draw_on(gpu),
            Message::Inspect(pixels) => self.curious.want(pixels),
            Message::Glance(wanted) => self.watch_glances(wanted),
            Message::MarkClipped(on) => self.mark_clipped(on),
            Message::LookFirst(region) => self.look_first(region),
            Message::Export(export) => self.export(export),
            Message::Staged { id, stage, divisor, session } => {
                self.staged(id, stage, divisor, *session);
            }
            Message::Grown { id, patch } => self.grown(id, *patch),
            Message::Ended { id, outcome } => self.ended(id, outcome),
            Message::Exported(outcome) => self.exported(outcome),
            Message::Quit => {}
        }
    }

    fn want(&mut self, scene: Arc<Scene>, cache: Option<PathBuf>) {
        let taken = Instant::now();
        let same = |wanted: &Arc<Scene>| Arc::ptr_eq(wanted, &scene) || *wanted == scene;
        if !self.wanted.as_ref().is_some_and(same) {
            self.wanted = Some(scene);
            self.cache = cache.or(self.cache.take());
            self.interrupt_keeping();
            self.opened = false;
            self.settle(taken);
        }
    }

    fn resume(&mut self) {
        self.hold = None;
        // A trace that still has to obey a cancel is followed by another one.
        self.job
            .iter_mut()
            .filter(|job| job.control.progress.is_cancelled())
            .for_each(Running::drop_it);
        self.settle(Instant::now());
    }

    /// Brings the picture in step with the wanted scene, with the least work.
    fn settle(&mut self, taken: Instant) {
        let Some(wanted) = self.wanted.clone() else { return };
        let Err(work) = self.reach_whole(&wanted, taken) else { return };
        self.reach_preview(&wanted, taken);
        if let Some(job) = &mut self.job {
            job.consider(&wanted);
            self.mend_for(wanted, work);
        } else if !self.is_held(&wanted) {
            self.begin(wanted, work, taken);
        }
    }

    /// Edits and shows the whole picture if that needs no ray; a trace is then for nothing.
    fn reach_whole(&mut self, wanted: &Arc<Scene>, taken: Instant) -> Result<(), Work> {
        let new = || Work::Trace(NEW.into());
        let whole = self.whole.as_mut().ok_or_else(new)?;
        whole.defer(self.product.is_some());
        let report = whole.edit_without_rays(wanted)?;
        self.preview = None;
        (self.hold, self.is_other) = (None, false);
        self.job.iter_mut().for_each(Running::drop_it);
        self.edited(report, taken);
        Ok(())
    }

    /// Edits and shows the preview, if there is one and that needs no ray.
    fn reach_preview(&mut self, wanted: &Arc<Scene>, taken: Instant) {
        let Some(preview) = &mut self.preview else { return };
        if let Some(behind) = &mut preview.behind {
            let scene = Arc::new(staged(wanted, behind.stage, behind.divisor));
            // What needs rays stays as it was: it is coarse.
            let _ = behind.session.edit_without_rays(&scene);
        }
        let scene = Arc::new(staged(wanted, preview.stage, preview.divisor));
        if let Ok(report) = preview.session.edit_without_rays(&scene) {
            preview.scene = wanted.clone();
            self.edited(report, taken);
        }
    }

    /// Shows the result of an edit without rays.
    fn edited(&mut self, mut report: EditReport, taken: Instant) {
        report.milliseconds = taken.elapsed().as_secs_f64() * 1e3;
        if report.class != Class::None {
            self.busy_until = Some(Instant::now() + YIELD);
        }
        self.last = Some(report);
        self.show();
    }

    /// Whether a scene that needs rays has to wait.
    fn is_held(&mut self, wanted: &Scene) -> bool {
        let held = self.hold.as_ref().is_some_and(|hold| match hold.failed {
            true => *hold.scene == *wanted,
            false => Change::between(&hold.scene, wanted).moves_rays.is_none(),
        });
        if !held {
            self.hold = None;
        }
        held
    }

    /// Sends a scene to the tracer, which is free.
    fn begin(&mut self, scene: Arc<Scene>, work: Work, taken: Instant) {
        if let Some(cache) = self.cache.take() {
            return self.begin_opening(scene, cache, taken);
        }
        let known = self.whole.as_ref().map(compiled);
        let reason = if self.is_other { NEW } else { work.reason() }.to_owned();
        let mending = match (work, &mut self.whole) {
            (Work::Regrow(plan), Some(whole)) => {
                // What a dropped trace of other surfaces left is no picture of this scene.
                let is_like = |p: &mut Preview| {
                    let change = Change::between(&p.scene, &scene);
                    p.stage == Stage::Coarse && !change.everything
                };
                self.preview = self.preview.take_if(is_like);
                let before = self.preview.as_ref().map(|p| p.session.shared_frame());
                let first = (self.region, self.board.cursor());
                Some(Mending::new(whole, scene.clone(), plan, first, before.as_deref()))
            }
            _ => None,
        };
        let trees = match mending {
            Some(_) => None,
            None => self.whole.as_mut().map(Session::take_trees),
        };
        let reuse = Arc::new(Mutex::new(trees));
        let regrow = mending.as_ref().map(|mending| mending.regrow.clone());
        let job = Running { reason, reuse, mending, ..Running::new(scene, taken) };
        self.send(job, known, regrow, None);
        if self.mending().is_some() {
            self.show();
        }
    }

    /// Sends a job to the tracer, which is free.
    fn send(
        &mut self,
        mut job: Running,
        known: Option<Compiled>,
        regrow: Option<Arc<Regrow>>,
        cache: Option<PathBuf>,
    ) {
        self.jobs += 1;
        job.id = self.jobs;
        let task = tracer::Task {
            id: job.id,
            scene: job.scene.clone(),
            control: job.control.clone(),
            known,
            reuse: job.reuse.clone(),
            regrow,
            cache,
            region: self.region,
        };
        self.traces.send(task).expect("the tracer lives as long as the shader");
        self.job = Some(job);
    }

    /// Takes a picture before the whole one.
    fn staged(&mut self, id: u64, stage: Stage, divisor: u32, mut session: Session) {
        let Some(job) = self.job.as_mut().filter(|job| job.id == id && !job.dropped) else {
            return;
        };
        if self.hold.is_some() && self.whole.is_some() {
            return;
        }
        session.move_to(&self.pool);
        let scene = job.scene.clone();
        let wanted = self.wanted.clone().unwrap_or_else(|| scene.clone());
        let newest = Arc::new(staged(&wanted, stage, divisor));
        let reached = session.edit_without_rays(&newest).is_ok();
        if Change::between(&scene, &wanted).moves_rays.is_some() {
            job.drop_it();
        }
        if let Some(mending) = job.mending.as_mut().filter(|_| !job.dropped) {
            mending.mark(Some(session.frame()));
        }
        let scene = if reached { wanted } else { scene };
        let behind = self.preview.take().filter(|before| before.stage <= Stage::OneSample);
        let behind = behind.map(Box::new);
        self.preview = Some(Preview { session, stage, divisor, scene, behind });
        self.show();
    }

    fn ended(&mut self, id: u64, outcome: Outcome) {
        let Some(job) = self.job.take_if(|job| job.id == id) else { return };
        let unused = job.reuse.lock().unwrap_or_else(PoisonError::into_inner).take();
        if let (Some(trees), Some(whole)) = (unused, &mut self.whole) {
            whole.give_trees(trees);
        }
        match outcome {
            Outcome::Whole(session) if !job.dropped && self.hold.is_none() => {
                self.take_whole(*session, job);
            }
            Outcome::Opened(session) if !job.dropped && self.hold.is_none() => {
                self.take_opened(*session, job.taken);
            }
            Outcome::NotOpened(error) if !job.dropped => self.not_opened(&error),
            Outcome::Regrown if !job.dropped && self.hold.is_none() => self.take_mended(job),
            Outcome::Cancelled if !job.dropped && self.hold.is_none() => self.put_on_hold(false),
            Outcome::Failed(text) if !job.dropped => {
                self.board.tell(Event::Failed(text));
                self.put_on_hold(true);
                self.hold = Some(Hold { scene: job.scene, failed: true });
            }
            _ => {}
        }
        if !self.in_step() {
            self.settle(Instant::now());
        }
    }

    /// Shows a whole picture, with the newest edits.
    fn take_whole(&mut self, mut session: Session, job: Running) {
        session.move_to(&self.pool);
        let mut report = session.trace_edit(job.reason);
        if let Some(wanted) = &self.wanted {
            // What needs rays is traced next.
            let _ = session.edit_without_rays(wanted);
        }
        report.milliseconds = job.taken.elapsed().as_secs_f64() * 1e3;
        (self.last, self.opened) = (Some(report), false);
        self.preview = None;
        self.replace_whole(session);
        self.show();
    }

    /// The wanted scene is not traced; the last whole picture is shown again.
    fn put_on_hold(&mut self, failed: bool) {
        let Some(scene) = self.wanted.clone() else { return };
        self.hold = Some(Hold { scene, failed });
        if self.whole.is_some() {
            self.preview = None;
            self.show();
        }
        for export in std::mem::take(&mut self.waiting) {
            self.refuse(&export, UNTRACED);
        }
        self.refuse_to_keep(UNTRACED);
    }

    fn cancel(&mut self, target: Target) {
        match (target, &self.job, self.exports.front()) {
            (Target::Trace, Some(job), _) => {
                job.control.progress.cancel();
                self.put_on_hold(false);
            }
            (Target::Export, _, Some(export)) => export.progress.cancel(),
            (Target::Keep, ..) if self.leaving.is_some() => self.leaving = None,
            (Target::Keep, ..) => self.keeping = None,
            _ => {}
        }
    }

    /// A panic left the pictures in an unknown state: nothing of them is kept.
    fn begin_anew(&mut self, text: String) {
        self.job.iter_mut().for_each(Running::drop_it);
        (self.whole, self.preview) = (None, None);
        (self.keeping, self.leaving) = (None, None);
        let scene = self.wanted.clone();
        self.hold = scene.map(|scene| Hold { scene, failed: true });
        self.board.tell(Event::Failed(text));
        self.report();
        self.board.wake();
    }

    /// Lets jobs wait while edits come, and exports while a scene is traced. A first stage does not
    /// wait: the picture after it is what edits are seen on.
    fn pace(&mut self) {
        self.busy_until = self.busy_until.filter(|t| *t > Instant::now());
        let busy = self.busy_until.is_some();
        if let Some(Running { control, .. }) = &self.job {
            control.progress.pause(busy && control.past_first.load(Relaxed));
        }
        for export in &self.exports {
            export.progress.pause(busy || self.job.is_some());
        }
    }

    /// Whether the picture shown is whole and of the newest wanted scene.
    fn in_step(&self) -> bool {
        let shown = self.whole.as_ref().filter(|_| self.preview.is_none());
        let wanted = self.wanted.as_ref();
        shown.zip(wanted).is_some_and(|(whole, w)| Arc::ptr_eq(&whole.shared_scene(), w))
    }
}

/// A session's geometry, with the scene that it was compiled of.
fn compiled(session: &Session) -> Compiled {
    Compiled(session.shared_scene(), session.shared_geometry())
}

/// The messages without wishes that newer ones follow.
fn newest_wish(messages: impl Iterator<Item = Message>) -> Vec<Message> {
    let mut messages: Vec<Message> = messages.collect();
    let is_wish = |message: &Message| matches!(message, Message::Want { .. });
    let newest = messages.iter().rposition(is_wish);
    let (mut at, mut latest) = (0, None);
    messages.retain_mut(|message| {
        at += 1;
        let Message::Want { cache, .. } = message else { return true };
        // An edit that follows an opening at once is an edit of what is opened.
        latest = cache.take().or(latest.take());
        let stays = Some(at - 1) == newest;
        if stays {
            *cache = latest.take();
        }
        stays
    });
    messages
}
