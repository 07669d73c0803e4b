//! A session behind threads: the newest wanted scene wins, pictures arrive coarse first, nothing blocks.

mod badges;
mod board;
mod export;
mod mending;
mod shader;
#[cfg(test)]
mod tests;
mod tracer;

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::mpsc::{Sender, channel};
use std::thread::JoinHandle;

use rayon::{ThreadPool, ThreadPoolBuilder};

use super::cost::Cost;
use super::inspect::PixelTree;
use super::layers::Extras;
use super::{Class, EditReport, Options};
use crate::film::Frame;
use crate::film::clipping::Clipped;
use crate::film::plates::Region;
use crate::film::write::Format;
use crate::forest::counts::SampleMap;
use crate::scene::Scene;
use crate::shade::gpu::{Gpu, Picture};
use board::Board;
pub use board::Eye;
use shader::{Message, Shader};

/// How fine a picture is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Stage {
    /// Fewer pixels, one sample each.
    Coarse,
    /// All pixels, one sample each.
    OneSample,
    /// What the scene asks for, in the part that [`Live::look_first`] names; coarse elsewhere.
    Region,
    /// What the scene asks for, but for some pixels that are being grown again: they are coarse, and
    /// one of sixteen is a mark.
    Mending,
    /// What the scene asks for.
    Whole,
}

/// A picture to show. `frame` is exactly what a fresh trace of `scene` gives if `stage` is
/// [`Stage::Whole`]; coarser stages show the same scene with fewer pixels or samples.
#[derive(Clone)]
pub struct Shown {
    /// The picture; at a coarse stage smaller than `scene.picture.size`. `None` where `card` shows it
    /// and edits come fast: it follows when they rest.
    pub frame: Option<Arc<Frame>>,
    /// The same on the graphics card that draws whole pictures, if one does: other in the last bits of
    /// its light, so that some pixels differ by a code value.
    pub card: Option<Arc<Picture>>,
    /// What it shows.
    pub scene: Arc<Scene>,
    /// How fine it is.
    pub stage: Stage,
    /// The pixels' numbers of samples, of a whole picture whose sampling is adaptive.
    pub map: Option<Arc<SampleMap>>,
    /// The picture with marks on what a screen cannot show, if they are wanted and nothing is being
    /// grown again; where the card draws, its picture has them too.
    pub marked: Option<Marked>,
}

/// A picture with marks on its clipped pixels.
#[derive(Clone)]
pub struct Marked {
    /// The picture; coarse beside a region that is traced first.
    pub frame: Arc<Frame>,
    /// How many pixels are marked.
    pub clipped: Clipped,
}

/// What the threads are doing, for the status line.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Status {
    /// The trace, opening, export or keeping that runs.
    pub job: Option<Job>,
    /// The latest finished edit.
    pub last: Option<EditReport>,
    /// Whether that was the opening of a kept cache, which needed no ray.
    pub opened: bool,
    /// Whether the picture shown is whole and shows the newest wanted scene.
    pub in_step: bool,
    /// Whether the newest wanted scene is not shown because its trace was cancelled or failed: the
    /// picture before it stays.
    pub held: bool,
    /// Pixels that are still to be grown again.
    pub pending: u64,
    /// Bytes of kept trees, matrix and highlight lists.
    pub bytes: u64,
    /// Bytes of matrix and highlight lists of the whole picture: what [`Live::keep`] writes, before
    /// it is compressed.
    pub matrix_bytes: u64,
    /// The budget for them.
    pub budget: u64,
    /// Bytes on the graphics card that draws the picture, if one does: the card sets their limit.
    pub card_bytes: u64,
}

/// A running trace, opening, export or keeping.
#[derive(Clone, Debug, PartialEq)]
pub struct Job {
    /// What it does and why: "tracing: camera.eye moves rays".
    pub what: String,
    /// Steps done and in all.
    pub steps: (u64, u64),
}

/// Something that happened once, for the person.
#[derive(Clone, Debug, PartialEq)]
pub enum Event {
    /// A picture file was written.
    Exported(PathBuf),
    /// What was traced was written to a cache.
    Kept {
        /// The cache.
        path: PathBuf,
        /// Its length.
        bytes: u64,
    },
    /// Something failed: what, why, and the way out.
    Failed(String),
}

/// A picture file that is wanted.
#[derive(Clone, Debug)]
pub struct Export {
    /// Where to.
    pub path: PathBuf,
    /// Its format.
    pub format: Format,
    /// Its size before a region is cut out; at the scene's own it holds the bytes that are shown.
    pub size: [u32; 2],
    /// What else it holds.
    pub extras: Extras,
}

/// Another scene that the person wants to see beside the one shown.
#[derive(Clone, Debug)]
pub struct Glance {
    /// The scene.
    pub scene: Arc<Scene>,
    /// How much smaller its picture is, per side; 1 for the whole picture.
    pub smaller: u32,
}

/// What there is to be seen of a [`Glance`].
#[derive(Clone, Debug)]
pub struct Glimpse {
    scene: Arc<Scene>,
    smaller: u32,
    /// Exactly what a fresh trace of the scene gives, made smaller; `None` where that needs rays.
    pub frame: Option<Arc<Frame>>,
    /// What showing the scene costs.
    pub class: Class,
}

impl Glimpse {
    /// Whether it is what was wanted: of the same scene, not only of an equal one.
    pub fn is_of(&self, glance: &Glance) -> bool {
        Arc::ptr_eq(&self.scene, &glance.scene) && self.smaller == glance.smaller
    }
}

/// A pixel taken apart, or why it cannot be.
pub type Inspected = Result<Arc<PixelTree>, String>;

/// What a pixel shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Picked {
    /// Index of the solid.
    pub solid: usize,
    /// Index of the material.
    pub material: usize,
    /// Distance of the point met from the eye's plane, along the view, world units.
    pub depth: f64,
}

/// A session that runs in threads of its own. All calls return at once.
///
/// One thread owns the pictures and shades, one traces, one writes files; the two that work hard
/// have a pool each, so that shading never queues behind rays. A lock is held only to move pointers.
/// Dropping it cancels what runs and waits for the threads.
pub struct Live {
    board: Arc<Board>,
    orders: Sender<Message>,
    threads: Vec<JoinHandle<()>>,
}

impl Live {
    /// Starts the threads. `wake` is called from them whenever there is something new.
    pub fn new(options: Options, wake: impl Fn() + Send + Sync + 'static) -> Live {
        let board = Arc::new(Board::new(options.memory, Box::new(wake)));
        let (orders, inbox) = channel();
        let (traces, trace_tasks) = channel();
        let (exports, export_tasks) = channel();
        let shading = {
            let board = board.clone();
            move || Shader::new(options, board, inbox, traces, exports).run()
        };
        let (traced, exported) = (orders.clone(), orders.clone());
        let threads = vec![
            thread("shader", shading),
            thread("tracer", move || tracer::run(options, trace_tasks, traced)),
            thread("exporter", move || export::run(options, export_tasks, exported)),
        ];
        Live { board, orders, threads }
    }

    /// Sends an order. The shader receives until it is told to quit.
    fn order(&self, message: Message) {
        let _ = self.orders.send(message);
    }

    /// Makes `scene` the wanted one. A running trace goes on if the edit does not concern its rays.
    pub fn want(&self, scene: Arc<Scene>) {
        self.wish(scene, None);
    }

    /// The same of a scene that is opened, for which `cache` may be kept: it is opened before
    /// anything is traced, and how it differs from the scene costs what an edit costs. If it does not
    /// fit, an event tells why, and the scene is traced; if there is no such file, it is just traced.
    pub fn want_kept(&self, scene: Arc<Scene>, cache: PathBuf) {
        self.wish(scene, Some(cache));
    }

    fn wish(&self, scene: Arc<Scene>, cache: Option<PathBuf>) {
        let number = self.board.wish();
        self.order(Message::Want { scene, number, cache });
    }

    /// Writes what was traced to a cache, without trees, once the picture is whole and while nothing
    /// else is to be done: an edit comes first, and the file then holds the edited picture.
    pub fn keep(&self, cache: PathBuf) {
        self.order(Message::Keep(cache));
    }

    /// Tells that what is wanted from now on is another document. What is being kept stays what it is,
    /// and is written beside the new one's trace; what was to be kept once it is traced is not.
    pub fn leave(&self) {
        self.order(Message::Leave);
    }

    /// The newest picture, if it is newer than the one taken before.
    pub fn take_shown(&self) -> Option<Shown> {
        self.board.take_shown()
    }

    /// What the threads are doing.
    pub fn status(&self) -> Status {
        self.board.status()
    }

    /// What has happened since the last call.
    pub fn take_events(&self) -> Vec<Event> {
        self.board.take_events()
    }

    /// Stops the job that [`Live::status`] tells of. After a trace the last whole picture comes
    /// back, and the wish is held: until it can be shown without rays, or another wish moves other
    /// rays, or [`Live::resume`].
    pub fn cancel(&self) {
        let target = self.board.cancel();
        self.order(Message::Cancel(target));
    }

    /// Tells where the person looks, in pixels of the picture: from there on it is grown again.
    pub fn look_at(&self, point: Option<[f64; 2]>) {
        self.board.look_at(point);
    }

    /// Traces the wanted scene after it was held.
    pub fn resume(&self) {
        self.order(Message::Resume);
    }

    /// Names the parameters whose costs are wanted from now on: those on the screen.
    pub fn watch_costs(&self, paths: Vec<String>) {
        self.order(Message::Watch(paths));
    }

    /// The newest known costs of the watched parameters, of the scene shown. While it is traced those
    /// are missing that only the frontier of the whole picture knows.
    pub fn costs(&self) -> Arc<BTreeMap<String, Cost>> {
        self.board.costs()
    }

    /// Marks pixels that a screen cannot show from now on, or no longer: in what is shown alone.
    pub fn mark_clipped(&self, on: bool) {
        self.order(Message::MarkClipped(on));
    }

    /// Names a part of the picture that is to be traced before the rest, from the next trace on: its
    /// tiles are shown as soon as they are whole, while all others still are coarse.
    pub fn look_first(&self, region: Option<Region>) {
        self.order(Message::LookFirst(region));
    }

    /// Draws whole pictures on a graphics card too from now on, or no longer. A card that fails is
    /// told of once, and not used any more.
    pub fn draw_on(&self, gpu: Option<Gpu>) {
        self.order(Message::DrawOn(gpu));
    }

    /// Names the pixels that are to be taken apart, now and after every edit: once the picture is
    /// whole, and while nothing else is to be done.
    pub fn inspect(&self, pixels: Vec<[u32; 2]>) {
        self.board.stop_inspection();
        self.order(Message::Inspect(pixels));
    }

    /// What is known of them: of the scene shown, or, for a moment, of the one before.
    pub fn inspected(&self) -> Arc<BTreeMap<[u32; 2], Inspected>> {
        self.board.pixels()
    }

    /// Names the other scenes that are to be seen from now on. They are shaded while nothing else is to
    /// be done, from the trees that are there: where those are not enough, only the cost is told.
    pub fn glance(&self, wanted: Vec<Glance>) {
        self.order(Message::Glance(wanted));
    }

    /// What is known of the scenes that are to be seen.
    pub fn glimpses(&self) -> Arc<Vec<Glimpse>> {
        self.board.glimpses()
    }

    /// Writes a picture of the newest wanted scene, after its trace if that still runs.
    ///
    /// A picture of another size than the scene's is traced by itself, beside what is shown; it
    /// pauses while the scene is traced or edited.
    pub fn export(&self, export: Export) {
        self.order(Message::Export(export));
    }

    /// The scene shown, for single rays of whoever asks.
    pub fn eye(&self) -> Option<Eye> {
        self.board.eye()
    }

    /// What lies under a point of the picture shown, in pixels of `picture.size`.
    pub fn pick(&self, point: [f64; 2]) -> Option<Picked> {
        self.board.eye()?.pick(point)
    }
}

impl Drop for Live {
    fn drop(&mut self) {
        self.board.cancel();
        self.order(Message::Quit);
        for thread in self.threads.drain(..) {
            // What a thread may have died of was said when it happened.
            let _ = thread.join();
        }
    }
}

fn thread(name: &str, body: impl FnOnce() + Send + 'static) -> JoinHandle<()> {
    let builder = std::thread::Builder::new().name(name.to_owned());
    builder.spawn(body).expect("the system gives a thread")
}

/// A pool of as many threads as the options say, or, where the system does not give them, of the
/// calling thread alone.
fn pool(options: Options) -> Arc<ThreadPool> {
    let wanted = ThreadPoolBuilder::new().num_threads(options.threads.max(1)).build();
    let alone = || ThreadPoolBuilder::new().num_threads(1).use_current_thread().build();
    Arc::new(wanted.or_else(|_| alone()).expect("a pool without new threads"))
}

/// Runs a job that must not take its thread down: a panic becomes text.
fn guarded<T>(job: impl FnOnce() -> T) -> Result<T, String> {
    let caught = std::panic::catch_unwind(std::panic::AssertUnwindSafe(job));
    caught.map_err(|cause| {
        let text = cause.downcast_ref::<String>().map(String::as_str);
        let text = text.or(cause.downcast_ref::<&str>().copied()).unwrap_or("unknown cause");
        format!("an error in the program ({text}): save your work, and please report it")
    })
}
