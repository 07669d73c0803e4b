//! Reads a cache: parts are checked, unpacked and validated on all threads, within the budget.

use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

use rayon::ThreadPool;
use rayon::prelude::*;

use super::file::{self, Numbers, Opened, Scratch};
use super::{CacheError, CacheReport, Fault, program};
use super::{lists, parts, sound};
use crate::film::layout::Layout;
use crate::fold::transport::{Transport, TransportTile};
use crate::fold::trie::Trie;
use crate::forest::Forest;
use crate::forest::counts::SampleMap;
use crate::forest::kept::KeptTrees;
use crate::geometry::Geometry;
use crate::progress::Progress;
use crate::scene::Scene;
use crate::scene::read::{Known, text_with};
use crate::session::trace::TraceReport;

/// The text of a scene and its terms may take this many bytes in any budget.
const LEAST_LIMIT: u64 = 1 << 26;

/// What a cache file held, sound in every respect.
pub struct Cached {
    /// The scene it was made from.
    pub scene: Scene,
    /// That scene made ready for rays.
    pub geometry: Geometry,
    /// Time to compile it.
    pub geometry_seconds: f64,
    /// Its trees, as far as they were kept and fit into the budget.
    pub forest: Forest,
    /// The pixels' numbers of samples, where sampling is adaptive.
    pub map: Option<Arc<SampleMap>>,
    /// The matrix, and the highlight lists that were kept and fit.
    pub transport: Transport,
    /// What else a session knows.
    pub(super) state: parts::State,
    /// The trace that made it.
    pub trace: TraceReport,
    /// What reading took, geometry included.
    pub report: CacheReport,
}

/// Reads the cache at `path` for a scene that is opened: the one it was made from must have the same
/// meshes and the same size and samples of the picture, or the file is stale.
///
/// `budget` limits matrix, highlight lists and trees together. Trees are left out first, then
/// highlight lists, those of the last tiles first.
pub fn read(
    path: &Path,
    opened: &Scene,
    pool: &ThreadPool,
    budget: u64,
    progress: &Progress,
) -> Result<Cached, CacheError> {
    let cached = || {
        let start = Instant::now();
        let file = Opened::open(path, &program())?;
        let mut cached = Reader::new(&file, path, opened, budget, progress)?.all(pool)?;
        cached.report.seconds = start.elapsed().as_secs_f64();
        Ok(cached)
    };
    cached().map_err(|fault: Fault| fault.of(path))
}

struct Reader<'a> {
    file: &'a Opened,
    numbers: Numbers,
    scene: Scene,
    budget: u64,
    progress: &'a Progress,
}

impl<'a> Reader<'a> {
    fn new(
        file: &'a Opened,
        path: &Path,
        opened: &Scene,
        budget: u64,
        progress: &'a Progress,
    ) -> Result<Reader<'a>, Fault> {
        let table = &file.header.parts;
        let most = budget.max(LEAST_LIMIT);
        if table.iter().take(2).any(|part| part.held > most) {
            return Err(Fault::Memory { budget });
        }
        let scene = scene(file, path, opened)?;
        let numbers = Numbers { tiles: Layout::new(scene.picture.size).tiles() };
        if table.len() != numbers.count() {
            return Err(Fault::damaged("the header", "the table is of another picture"));
        }
        Ok(Reader { file, numbers, scene, budget, progress })
    }

    fn all(self, pool: &ThreadPool) -> Result<Cached, Fault> {
        let numbers = self.numbers;
        let [lists, trees] = self.fitting()?;
        let start = Instant::now();
        let geometry = Geometry::build(&self.scene, self.progress)?;
        let geometry_seconds = start.elapsed().as_secs_f64();
        self.progress.begin((2 * numbers.tiles) as u64);
        let (trie, state) = self.terms()?;
        let layout = Layout::new(self.scene.picture.size);
        let samples = self.scene.trace.samples;
        let map = SampleMap::from_list(layout, samples, &state.counts).map(Arc::new);
        if map.is_some() != self.scene.trace.is_adaptive() {
            return Err(Fault::damaged("the terms", "numbers of samples of another picture"));
        }
        let tiles = self.each_tile(pool, |scratch, tile| self.tile(tile, lists, &trie, scratch))?;
        let keys = &state.keys_in_trees;
        let within = sound::Surroundings::new(&self.scene, &geometry, keys);
        let trees: Vec<Option<Arc<KeptTrees>>> = self.each_tile(pool, |scratch, tile| {
            let counts = map.as_ref().map_or(&[][..], |map| map.tile(tile));
            self.trees((tile, counts), trees, &within, scratch)
        })?;
        let report = CacheReport {
            file_bytes: self.file.length,
            plain_bytes: self.file.header.parts.iter().map(|part| part.plain).sum(),
            lists: tiles.iter().filter(|tile| tile.highlights.is_some()).count(),
            trees: trees.iter().flatten().count(),
            seconds: 0.0,
        };
        Ok(Cached {
            geometry,
            geometry_seconds,
            forest: Forest { layout, samples, tiles: trees },
            map,
            transport: Transport {
                layout,
                samples,
                trie,
                tiles: tiles.into_iter().map(Arc::new).collect(),
            },
            state,
            trace: self.file.header.trace,
            report,
            scene: self.scene,
        })
    }

    /// The first tiles whose highlight lists, and whose trees, fit into the budget.
    fn fitting(&self) -> Result<[usize; 2], Fault> {
        let table = &self.file.header.parts;
        let mut held = 0u64;
        let mut fit = |number: usize| {
            held = held.saturating_add(table[number].held);
            held <= self.budget
        };
        let tiles = 0..self.numbers.tiles;
        if !tiles.clone().all(|tile| fit(self.numbers.matrix(tile))) {
            return Err(Fault::Memory { budget: self.budget });
        }
        let lists = tiles.clone().take_while(|tile| fit(self.numbers.lists(*tile))).count();
        let trees = tiles.take_while(|tile| fit(self.numbers.trees(*tile))).count();
        Ok([lists, trees])
    }

    fn terms(&self) -> Result<(Trie, parts::State), Fault> {
        self.file.part(Numbers::TERMS, &mut Scratch::default(), |source| {
            let (trie, state) = parts::take_terms(source)?;
            sound::state(&state, &self.scene)?;
            sound::trie(&trie, &self.scene).map(|()| (trie, state))
        })
    }

    /// What `job` makes of every tile.
    fn each_tile<T: Send>(
        &self,
        pool: &ThreadPool,
        job: impl Fn(&mut Scratch, usize) -> Result<T, Fault> + Sync,
    ) -> Result<Vec<T>, Fault> {
        let one = |scratch: &mut Scratch, tile| {
            self.progress.check()?;
            let made = job(scratch, tile);
            self.progress.step();
            made
        };
        let tiles = (0..self.numbers.tiles).into_par_iter();
        pool.install(|| tiles.map_init(Scratch::default, one).collect())
    }

    /// A tile's part of the matrix, with its highlight lists if it is among the first `lists`.
    fn tile(
        &self,
        tile: usize,
        lists: usize,
        trie: &Trie,
        scratch: &mut Scratch,
    ) -> Result<TransportTile, Fault> {
        let mut transport = self.file.part(self.numbers.matrix(tile), scratch, |source| {
            let part = parts::take_matrix(source)?;
            sound::matrix(&part, trie.nodes()).map(|()| part)
        })?;
        let number = self.numbers.lists(tile);
        if tile < lists && self.file.header.parts[number].is_there() {
            let highlights = self.file.part(number, scratch, |source| {
                let lists = parts::take_highlights(source)?;
                lists::check(&lists, &transport, trie).map(|()| lists)
            })?;
            transport.highlights = Some(highlights);
        }
        Ok(transport)
    }

    /// A tile's trees if they were kept and it is among the first `trees`.
    fn trees(
        &self,
        (tile, counts): (usize, &[u16]),
        trees: usize,
        within: &sound::Surroundings,
        scratch: &mut Scratch,
    ) -> Result<Option<Arc<KeptTrees>>, Fault> {
        let number = self.numbers.trees(tile);
        if tile >= trees || !self.file.header.parts[number].is_there() {
            return Ok(None);
        }
        let trees = self.file.part(number, scratch, |source| {
            let trees = parts::take_trees(source, counts)?;
            within.trees(&trees, tile).map(|()| Arc::new(trees))
        })?;
        Ok(Some(trees))
    }
}

/// The scene that a cache was made from, with the meshes and images of the opened one: they must be those it
/// had.
fn scene(file: &Opened, path: &Path, opened: &Scene) -> Result<Scene, Fault> {
    let text = file.part(Numbers::SCENE, &mut Scratch::default(), |source| {
        String::from_utf8(source.array()?).map_err(|_| "it is no text")
    })?;
    let read = text_with(&text, path, Known::of(opened));
    let scene = read.map_err(|_| Fault::stale("its scene cannot be read any more"))?;
    if file::hashes(&scene) != file.header.meshes {
        return Err(Fault::stale("a mesh or an image has changed"));
    }
    if scene.picture.size != opened.picture.size {
        let [[a, b], [c, d]] = [scene.picture.size, opened.picture.size];
        return Err(Fault::stale(format!("the picture was {a}×{b}, it is {c}×{d}")));
    }
    if scene.trace.samples != opened.trace.samples {
        let [before, now] = [scene.trace.samples, opened.trace.samples];
        return Err(Fault::stale(format!("trace.samples was {before}, it is {now}")));
    }
    Ok(scene)
}
