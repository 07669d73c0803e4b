//! Traces and folds a whole picture, tile by tile on all threads, within a budget of memory.

use std::fmt;
use std::ops::{AddAssign, Range};
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};
use std::sync::{Arc, Mutex, MutexGuard};
use std::time::{Duration, Instant};

use rayon::ThreadPool;
use rayon::prelude::*;

use super::pilots::Pilots;
use crate::film::layout::{Layout, TILE_BLOCKS};
use crate::film::pixels::PixelSet;
use crate::film::plates::Region;
use crate::fold::transport::{Highlights, Transport, TransportTile};
use crate::fold::trie::Trie;
use crate::fold::{Folder, Names};
use crate::forest::Forest;
use crate::forest::counts::SampleMap;
use crate::forest::grow::{Grower, MOST_CROSSED, RayCounts, Stop, Worker};
use crate::forest::kept::{KeptTrees, Recalls};
use crate::forest::sink::Discard;
use crate::forest::tree::TileTrees;
use crate::geometry::Geometry;
use crate::progress::{Cancelled, Progress};
use crate::scene::Scene;
use crate::scene::model::Peak;

/// What a trace may keep.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Keep {
    /// What is of use afterwards.
    pub what: Kept,
    /// Bytes that all of it may take.
    pub bytes: u64,
}

/// What of a trace is kept, if the budget allows it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kept {
    /// Everything.
    Trees,
    /// Matrix and highlight lists: edits are as instant as with trees.
    Lists,
    /// The matrix alone: enough for a picture.
    Matrix,
}

/// Why a trace gave no picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TraceError {
    /// It was cancelled.
    Cancelled,
    /// The system does not give that many threads.
    Threads {
        /// How many were asked for.
        threads: usize,
    },
    /// A shadow ray crosses more transparent surfaces than a tree can record.
    Surfaces,
    /// The ray trees of sixteen pixels alone do not fit into the share of a thread.
    Branches {
        /// The budget in bytes.
        budget: u64,
    },
    /// The matrix alone, without trees and highlight lists, needs more than the budget.
    Memory {
        /// The budget in bytes.
        budget: u64,
    },
}

impl From<Cancelled> for TraceError {
    fn from(_: Cancelled) -> TraceError {
        TraceError::Cancelled
    }
}

impl TraceError {
    /// What a stop means to the whole trace.
    pub(super) fn of(stop: Stop, budget: usize) -> TraceError {
        match stop {
            Stop::Cancelled => TraceError::Cancelled,
            Stop::Surfaces => TraceError::Surfaces,
            Stop::Branches => TraceError::Branches { budget: budget as u64 },
        }
    }
}

impl fmt::Display for TraceError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            TraceError::Cancelled => write!(f, "cancelled"),
            TraceError::Threads { threads } => {
                write!(f, "the system does not give {threads} threads: ask for fewer (--threads)")
            }
            TraceError::Surfaces => write!(
                f,
                "a shadow ray crosses more than {MOST_CROSSED} transparent surfaces: make some of \
                 them opaque (transmit = 0) or leave some out"
            ),
            TraceError::Branches { budget } => write!(
                f,
                "the rays branch so often that the trees of sixteen pixels do not fit into their \
                 share of the budget of {:.2} GiB: lower trace.depth, raise trace.cutoff, or lower \
                 reflect or transmit",
                *budget as f64 / f64::from(1 << 30)
            ),
            TraceError::Memory { budget } => write!(
                f,
                "the picture needs more memory than the budget of {:.2} GiB: raise the budget, \
                 or lower picture.size or trace.depth",
                *budget as f64 / f64::from(1 << 30)
            ),
        }
    }
}

impl std::error::Error for TraceError {}

/// What a trace made.
pub struct Traced {
    /// The trees that fitted into the budget.
    pub forest: Forest,
    /// The matrix.
    pub transport: Transport,
    /// The pixels' numbers of samples, where sampling is adaptive.
    pub map: Option<Arc<SampleMap>>,
    /// How long it took and what it cast.
    pub report: TraceReport,
}

/// Times and counts of one trace.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TraceReport {
    /// Wall time of all of it, without building the geometry.
    pub seconds: f64,
    /// Of it folding: the mean over the threads.
    pub fold_seconds: f64,
    /// Rays cast.
    pub rays: RayCounts,
    /// Nodes of all trees, kept or not.
    pub nodes: u64,
}

impl AddAssign for TraceReport {
    /// One trace after the other.
    fn add_assign(&mut self, other: TraceReport) {
        let TraceReport { seconds, fold_seconds, rays, nodes } = other;
        self.seconds += seconds;
        self.fold_seconds += fold_seconds;
        self.rays += rays;
        self.nodes += nodes;
    }
}

/// Traces some tiles of `scene` without keeping anything: what the same rays cost by themselves. Where
/// sampling is adaptive, the first samples are kept for a while, as for a trace.
pub fn trace_only(
    (scene, tiles): (&Scene, &[usize]),
    geometry: &Geometry,
    pool: &ThreadPool,
    progress: &Progress,
) -> Result<TraceReport, TraceError> {
    let start = Instant::now();
    progress.begin(tiles.len() as u64);
    let wanted = PixelSet::of_tiles(Layout::new(scene.picture.size), tiles.iter().copied());
    let pilots = Pilots::trace((scene, &wanted), geometry, Some(pool), u64::MAX, progress)?;
    let grower = Grower::new(scene, geometry).with_map(pilots.map.as_deref());
    let next = AtomicUsize::new(0);
    let counts = pool.broadcast(|_| -> Result<RayCounts, TraceError> {
        let mut worker = grower.worker();
        while let Some(place) = claim(&next, tiles.len()) {
            let (tile, mut sink) = (tiles[place], Discard);
            let known = pilots.tree(tile);
            for block in 0..TILE_BLOCKS {
                let first = known.map(|trees| trees.recall_current(block));
                let known = Recalls { first, rest: None };
                let (at, most) = ((tile, block), usize::MAX);
                let grown = grower.block_again(&mut worker, at, known, &mut sink, most, progress);
                grown.map_err(|stop| TraceError::of(stop, most))?;
            }
            progress.step();
        }
        Ok(worker.rays)
    });
    let mut rays = pilots.rays;
    for count in counts {
        rays += count?;
    }
    Ok(TraceReport { seconds: start.elapsed().as_secs_f64(), rays, ..TraceReport::default() })
}

/// A part of the picture that is traced before the rest, and shown.
pub struct Ahead<'a, T> {
    /// The part: all tiles that it touches. It must lie within the picture.
    pub region: Region,
    /// Gets the picture as it is then, without trees: all other tiles have no terms. On an error the
    /// rest is not traced.
    pub show: &'a dyn Fn(T) -> Result<(), Cancelled>,
}

/// Traces and folds `scene`. The memory of `reuse`, an earlier forest, is filled anew.
///
/// Each tile is folded block by block while its trees are in cache. Beyond the budget trees are
/// released first, then highlight lists; the picture does not depend on what is kept, nor on the part
/// that is traced before the rest.
pub fn trace(
    (scene, ahead): (&Scene, Option<Ahead<Traced>>),
    geometry: &Geometry,
    pool: &ThreadPool,
    keep: Keep,
    reuse: Forest,
    progress: &Progress,
) -> Result<Traced, TraceError> {
    let start = Instant::now();
    let layout = Layout::new(scene.picture.size);
    let first = ahead.as_ref().map_or_else(Vec::new, |ahead| ahead.region.tiles(layout));
    let mut tiles: Vec<usize> = (0..layout.tiles()).collect();
    tiles.sort_by_key(|tile| first.binary_search(tile).is_err());
    progress.begin(tiles.len() as u64);
    let threads = pool.current_num_threads();
    let job = Job::new((scene, tiles.clone()), geometry, threads, keep, reuse, progress);
    let (mut pilots, mut report) = (Pilots::default(), TraceReport::default());
    if let Some(Ahead { region: _, show }) = ahead {
        (pilots, report) = job.run(0..first.len(), &pilots, pool)?;
        let transport = job.so_far(first.len(), pool)?;
        let forest = Forest { tiles: vec![None; first.len()], ..Forest::of(scene) };
        let traced = Traced { forest, transport, map: pilots.map.clone(), report };
        show(traced.spread(&first))?;
    }
    let (pilots, rest) = job.run(first.len()..tiles.len(), &pilots, pool)?;
    report += rest;
    Ok(job.traced(pilots, report, (start, pool))?.spread(&tiles))
}

impl Traced {
    /// Puts what was traced of some tiles into their places in the picture.
    fn spread(mut self, tiles: &[usize]) -> Traced {
        let count = self.transport.layout.tiles();
        let empty = Arc::new(TransportTile::black());
        let traced = std::mem::replace(&mut self.transport.tiles, vec![empty; count]);
        let trees = std::mem::replace(&mut self.forest.tiles, vec![None; count]);
        for (&tile, (transport, trees)) in tiles.iter().zip(traced.into_iter().zip(trees)) {
            (self.transport.tiles[tile], self.forest.tiles[tile]) = (transport, trees);
        }
        self
    }
}

/// The same of some tiles of the picture: forest and matrix hold theirs alone, in the order asked
/// for. Steps of `progress` are tiles; whoever calls begins it.
pub(super) fn trace_tiles(
    (scene, tiles): (&Scene, Vec<usize>),
    geometry: &Geometry,
    pool: &ThreadPool,
    keep: Keep,
    progress: &Progress,
) -> Result<Traced, TraceError> {
    let start = Instant::now();
    let (count, threads) = (tiles.len(), pool.current_num_threads());
    let job = Job::new((scene, tiles), geometry, threads, keep, Forest::default(), progress);
    let (pilots, report) = job.run(0..count, &Pilots::default(), pool)?;
    job.traced(pilots, report, (start, pool))
}

/// The next tile that nobody works on.
pub(super) fn claim(next: &AtomicUsize, tiles: usize) -> Option<usize> {
    let tile = next.fetch_add(1, Relaxed);
    (tile < tiles).then_some(tile)
}

/// All that the workers of one trace share.
struct Job<'a> {
    scene: &'a Scene,
    geometry: &'a Geometry,
    names: Names,
    layout: Layout,
    /// What is traced: the tile of every slot.
    tiles: Vec<usize>,
    peaks: Vec<Option<Peak>>,
    progress: &'a Progress,
    slots: Vec<Mutex<Slot>>,
    trie: Mutex<Trie>,
    ledger: Mutex<Ledger>,
    kept: Kept,
    budget: usize,
    /// A tile whose trees need more than this is not kept.
    tile_limit: usize,
}

/// Some of a job's tiles, which are traced together.
struct Round<'a> {
    grower: Grower<'a>,
    pilots: &'a Pilots,
    /// The place of the next tile.
    next: AtomicUsize,
    /// Behind the last one's.
    end: usize,
}

/// A block's trees may always take this many bytes while it is folded.
pub(super) const LEAST_BLOCK_LIMIT: usize = 1 << 26;

/// What is there of one tile.
#[derive(Default)]
struct Slot {
    /// Memory of an earlier trace, until the tile is traced.
    old: Option<KeptTrees>,
    trees: Option<Arc<KeptTrees>>,
    transport: TransportTile,
}

impl Slot {
    fn tree_bytes(&self) -> usize {
        self.trees.as_ref().map_or(0, |trees| trees.bytes())
    }

    fn list_bytes(&self) -> usize {
        self.transport.highlights.as_ref().map_or(0, Highlights::bytes)
    }
}

/// Bytes kept so far, and the tiles from which some may be taken back.
struct Ledger {
    /// Of trees, matrix and highlight lists, memory of the earlier trace included.
    bytes: usize,
    /// Tiles with memory of an earlier trace; some may have used it by now.
    old: Vec<usize>,
    /// Tiles whose trees are kept.
    trees: Vec<usize>,
    /// Tiles whose highlight lists are kept.
    lists: Vec<usize>,
}

impl Ledger {
    /// Takes back what may go, the latest tile first, until the rest fits into the budget.
    fn release(&mut self, slots: &[Mutex<Slot>], budget: usize) -> Result<(), TraceError> {
        let slot = |tile: usize| slots[tile].lock().expect("no worker panicked");
        while self.bytes > budget {
            if let Some(tile) = self.old.pop() {
                self.bytes -= slot(tile).old.take().map_or(0, |trees| trees.bytes());
            } else if let Some(tile) = self.trees.pop() {
                self.bytes -= slot(tile).trees.take().map_or(0, |trees| trees.bytes());
            } else if let Some(tile) = self.lists.pop() {
                let lists = slot(tile).transport.highlights.take();
                self.bytes -= lists.map_or(0, |lists| lists.bytes());
            } else {
                return Err(TraceError::Memory { budget: budget as u64 });
            }
        }
        Ok(())
    }
}

/// What one worker counted, and its scratch.
#[derive(Default)]
struct Outcome {
    grown: TileTrees,
    rays: RayCounts,
    nodes: u64,
    folding: Duration,
}

impl<'a> Job<'a> {
    fn new(
        (scene, tiles): (&'a Scene, Vec<usize>),
        geometry: &'a Geometry,
        threads: usize,
        keep: Keep,
        reuse: Forest,
        progress: &'a Progress,
    ) -> Job<'a> {
        let layout = Layout::new(scene.picture.size);
        // Tiles of another cut are of other sizes: their memory would not fit.
        let reuse = if reuse.layout == layout { reuse } else { Forest::default() };
        let old_tiles = (0..reuse.tiles.len()).collect();
        let ledger =
            Ledger { bytes: reuse.bytes(), old: old_tiles, trees: Vec::new(), lists: Vec::new() };
        let mut old = reuse.tiles;
        let mut slot = |&tile: &usize| {
            let old = old.get_mut(tile).and_then(Option::take).and_then(Arc::into_inner);
            Mutex::new(Slot { old, ..Slot::default() })
        };
        let budget = usize::try_from(keep.bytes).unwrap_or(usize::MAX);
        Job {
            kept: keep.what,
            scene,
            geometry,
            names: Names::new(geometry.materials(), scene.lights.len()),
            layout,
            peaks: scene.materials.iter().map(|m| Some(Peak::of(m))).collect(),
            progress,
            slots: tiles.iter().map(&mut slot).collect(),
            tiles,
            trie: Mutex::default(),
            ledger: Mutex::new(ledger),
            budget,
            tile_limit: budget / (4 * threads),
        }
    }

    /// Traces the tiles at some places on all threads; `known` are the first samples of tiles that were
    /// traced before, and those given are of all.
    fn run(
        &self,
        places: Range<usize>,
        known: &Pilots,
        pool: &ThreadPool,
    ) -> Result<(Pilots, TraceReport), TraceError> {
        let wanted = PixelSet::of_tiles(self.layout, self.tiles[places.clone()].iter().copied());
        let (asked, bytes) = ((self.scene, &wanted), self.budget as u64);
        let pilots = known.more(asked, self.geometry, Some(pool), bytes, self.progress)?;
        let grower = Grower::new(self.scene, self.geometry).with_map(pilots.map.as_deref());
        let next = AtomicUsize::new(places.start);
        let round = Round { grower, pilots: &pilots, next, end: places.end };
        let outcomes = pool.broadcast(|_| self.work(&round));
        let mut report = TraceReport { rays: pilots.rays, ..TraceReport::default() };
        let threads = outcomes.len() as f64;
        for outcome in outcomes {
            let Outcome { grown: _, rays, nodes, folding } = outcome?;
            report.rays += rays;
            report.nodes += nodes;
            report.fold_seconds += folding.as_secs_f64() / threads;
        }
        drop(round);
        Ok((pilots, report))
    }

    /// One thread's share of the tiles.
    fn work(&self, round: &Round) -> Result<Outcome, TraceError> {
        let mut worker = round.grower.worker();
        let mut folder = Folder::default();
        let mut scratch = KeptTrees::default();
        let mut outcome = Outcome::default();
        while let Some(place) = claim(&round.next, round.end) {
            // Memory of the earlier trace is written at once, new memory is taken when its size is
            // known.
            let mut old = self.take_old(place);
            let trees = old.as_mut().unwrap_or(&mut scratch);
            let tile = self.tiles[place];
            let whole = self.tile((tile, round), &mut worker, &mut folder, trees, &mut outcome)?;
            let folding = Instant::now();
            let transport = self.finish_tile(&mut folder);
            outcome.folding += folding.elapsed();
            // A clone takes no more memory than it needs.
            let kept = (whole && self.kept == Kept::Trees)
                .then(|| Arc::new(old.map_or_else(|| scratch.clone(), KeptTrees::trimmed)));
            self.store(place, kept, transport)?;
            self.progress.step();
        }
        outcome.rays = worker.rays;
        Ok(outcome)
    }

    /// Grows and folds the blocks of a tile; whether `trees` holds all of them in the end.
    fn tile(
        &self,
        (tile, Round { grower, pilots, next: _, end: _ }): (usize, &Round),
        worker: &mut Worker,
        folder: &mut Folder,
        trees: &mut KeptTrees,
        outcome: &mut Outcome,
    ) -> Result<bool, TraceError> {
        folder.begin_tile();
        trees.clear();
        let (grown, pilots) = (&mut outcome.grown, pilots.tree(tile));
        let mut whole = true;
        for block in 0..TILE_BLOCKS {
            grown.clear();
            let at = (tile, block);
            let most = self.tile_limit.max(LEAST_BLOCK_LIMIT);
            let first = pilots.map(|pilots| pilots.recall_current(block));
            let known = Recalls { first, rest: None };
            let stopped = grower.block_again(worker, at, known, grown, most, self.progress);
            stopped.map_err(|stop| TraceError::of(stop, self.budget))?;
            outcome.nodes += grown.nodes.len() as u64;
            let folding = Instant::now();
            let counts = grower.counts(at);
            folder.block(&mut grown.read(0), &counts, &self.names);
            outcome.folding += folding.elapsed();
            if whole {
                if grower.is_adaptive() {
                    trees.push_counts(&counts);
                }
                trees.push_grown(grown, grower.keys());
                whole = trees.used_bytes() <= self.tile_limit;
            }
        }
        Ok(whole)
    }

    /// The tile's part of the matrix, in ids of the picture's trie.
    fn finish_tile(&self, folder: &mut Folder) -> TransportTile {
        let weight = 1.0 / self.scene.trace.samples as f32;
        let folded = folder.finish_tile(weight, &self.peaks);
        let mut tile = folded.tile;
        if self.kept == Kept::Matrix {
            tile.highlights = None;
        }
        let mut global = vec![0u32; folded.trie.nodes().len()];
        let mut trie = self.trie.lock().expect("no worker panicked");
        for (id, node) in folded.trie.nodes().iter().enumerate().skip(1) {
            let known = trie.intern(global[node.parent as usize], node.factor);
            trie.mark(known, node.marks);
            global[id] = known;
        }
        tile.renumber(|id| global[id as usize]);
        tile
    }

    /// Keeps a tile. Where the budget asks for it, memory of the earlier trace goes first, then this
    /// tile's trees and those of others, then highlight lists: the matrix alone is always kept.
    fn store(
        &self,
        place: usize,
        trees: Option<Arc<KeptTrees>>,
        transport: TransportTile,
    ) -> Result<(), TraceError> {
        // Whoever holds the ledger may lock a slot, never the other way round.
        let mut ledger = self.ledger.lock().expect("no worker panicked");
        let mut slot = self.slot(place);
        (slot.trees, slot.transport) = (trees, transport);
        ledger.bytes += slot.transport.bytes() + slot.list_bytes() + slot.tree_bytes();
        if slot.trees.is_some() {
            ledger.trees.push(place);
        }
        ledger.lists.push(place);
        drop(slot);
        ledger.release(&self.slots, self.budget)
    }

    /// Memory of the earlier trace for a tile: from now on it counts as the tile's own need.
    fn take_old(&self, place: usize) -> Option<KeptTrees> {
        let mut ledger = self.ledger.lock().expect("no worker panicked");
        let old = self.slot(place).old.take();
        ledger.bytes -= old.as_ref().map_or(0, KeptTrees::bytes);
        old
    }

    fn slot(&self, place: usize) -> MutexGuard<'_, Slot> {
        self.slots[place].lock().expect("no worker panicked")
    }

    /// The matrix of the tiles at the first places, which are traced, in their order.
    fn so_far(&self, count: usize, pool: &ThreadPool) -> Result<Transport, Cancelled> {
        let trie = self.trie.lock().expect("no worker panicked").clone();
        let tiles = (0..count).map(|place| self.slot(place).transport.clone()).collect();
        put_together(self.scene, (&trie, tiles), pool, self.progress)
    }

    /// All of it, in the order of the places.
    fn traced(
        self,
        pilots: Pilots,
        mut report: TraceReport,
        (start, pool): (Instant, &ThreadPool),
    ) -> Result<Traced, TraceError> {
        let merging = Instant::now();
        let slots = self.slots.into_iter().map(|s| s.into_inner().expect("no worker panicked"));
        let (trees, tiles): (Vec<_>, Vec<_>) = slots.map(|s| (s.trees, s.transport)).unzip();
        let trie = self.trie.into_inner().expect("no worker panicked");
        let transport = put_together(self.scene, (&trie, tiles), pool, self.progress)?;
        let forest = Forest { tiles: trees, ..Forest::of(self.scene) };
        report.fold_seconds += merging.elapsed().as_secs_f64();
        report.seconds = start.elapsed().as_secs_f64();
        Ok(Traced { forest, transport, map: pilots.map, report })
    }
}

/// Numbers the terms canonically and puts tiles together, whose terms are those of `trie`.
fn put_together(
    scene: &Scene,
    (trie, mut tiles): (&Trie, Vec<TransportTile>),
    pool: &ThreadPool,
    progress: &Progress,
) -> Result<Transport, Cancelled> {
    progress.check()?;
    let ranks = trie.canonical_ranks();
    progress.check()?;
    let trie = trie.renumbered(&ranks);
    progress.check()?;
    pool.install(|| {
        tiles.par_iter_mut().for_each(|tile| tile.renumber(|id| ranks[id as usize]));
    });
    let (layout, samples) = (Layout::new(scene.picture.size), scene.trace.samples);
    Ok(Transport { layout, samples, trie, tiles: tiles.into_iter().map(Arc::new).collect() })
}
