//! Adaptive sampling: pixels' first samples are traced, and say which pixels need more.

use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};
use std::sync::{Arc, Mutex, PoisonError};

use rayon::ThreadPool;

use super::Session;
use super::contrast::Palette;
use super::trace::{LEAST_BLOCK_LIMIT, TraceError, claim};
use crate::film::layout::{LANES, Layout};
use crate::film::pixels::{Lanes, PixelSet};
use crate::fold::Folder;
use crate::forest::Before;
use crate::forest::counts::{Rule, SampleMap, Signatures};
use crate::forest::grow::{Grower, RayCounts, Worker};
use crate::forest::kept::{KeptTrees, Recalls};
use crate::forest::signature::{PILOTS, Signature};
use crate::forest::thin::ThinPixels;
use crate::forest::tree::TileTrees;
use crate::geometry::Geometry;
use crate::progress::Progress;
use crate::scene::Scene;

/// What the first samples of some pixels gave; nothing where sampling is not adaptive.
#[derive(Default)]
pub(super) struct Pilots {
    /// How many samples each pixel gets.
    pub(super) map: Option<Arc<SampleMap>>,
    /// Per tile of the picture the trees of the samples traced so far, as far as the memory reached.
    trees: Trees,
    /// Rays cast.
    pub(super) rays: RayCounts,
}

/// Per tile its trees, if they are kept.
type Trees = Vec<Option<Arc<KeptTrees>>>;

/// A scene whose samples are traced to decide, and what is known of them.
pub(super) struct Survey<'a> {
    pub(super) scene: &'a Scene,
    pub(super) geometry: &'a Geometry,
    /// Trees that may answer, and with what they were grown; empty: there are none.
    pub(super) old: &'a [Option<Arc<KeptTrees>>],
    pub(super) keys: &'a [u16],
    pub(super) before: &'a Before,
    pub(super) bent: &'a [bool],
    /// Bytes that the samples' trees may take: without them tracing casts their rays again.
    pub(super) bytes: usize,
}

/// What one round of samples gave, with all of the rounds before.
struct Rounds {
    trees: Vec<Mutex<Option<Arc<KeptTrees>>>>,
    held: AtomicUsize,
    found: Mutex<Vec<Found>>,
}

/// The samples of a block.
struct Found {
    at: (usize, usize),
    signatures: [Signature; LANES],
}

impl Pilots {
    /// Traces the first samples of some tiles and of the pixels around them, and decides. At most half of
    /// `bytes` holds their trees. Without a pool it works on the thread that calls.
    pub(super) fn trace(
        wanted: (&Scene, &PixelSet),
        geometry: &Geometry,
        pool: Option<&ThreadPool>,
        bytes: u64,
        progress: &Progress,
    ) -> Result<Pilots, TraceError> {
        Pilots::default().more(wanted, geometry, pool, bytes, progress)
    }

    /// The same of other tiles of the same scene. What is decided stays, and rays that were cast answer.
    pub(super) fn more(
        &self,
        (scene, wanted): (&Scene, &PixelSet),
        geometry: &Geometry,
        pool: Option<&ThreadPool>,
        bytes: u64,
        progress: &Progress,
    ) -> Result<Pilots, TraceError> {
        if !scene.trace.is_adaptive() {
            return Ok(Pilots::default());
        }
        let keys: Vec<u16> = (0..).take(scene.lights.len()).collect();
        let held: usize = self.trees.iter().flatten().map(|trees| trees.bytes()).sum();
        let survey = Survey {
            scene,
            geometry,
            old: &self.trees,
            keys: &keys,
            before: &Before::of(scene, geometry),
            bent: &[],
            bytes: usize::try_from(bytes / 2).unwrap_or(usize::MAX).saturating_sub(held),
        };
        let unknown = || SampleMap::unknown(Layout::new(scene.picture.size), scene.trace.samples);
        let map = self.map.as_deref().map_or_else(unknown, SampleMap::clone);
        survey.decide(wanted, map, pool, progress)
    }

    /// The trees of a tile's first samples, if they are there.
    pub(super) fn tree(&self, tile: usize) -> Option<&KeptTrees> {
        self.trees.get(tile)?.as_deref()
    }
}

impl Session {
    /// Whether some pixels have fewer samples than others.
    pub fn is_adaptive(&self) -> bool {
        self.map.is_some()
    }

    /// The pixels' numbers of samples, where sampling is adaptive.
    pub fn sample_map(&self) -> Option<Arc<SampleMap>> {
        self.map.clone()
    }

    /// The number of samples of a pixel.
    pub fn samples_of(&self, pixel: [u32; 2]) -> u32 {
        match &self.map {
            Some(map) => map.of(self.transport.layout.place(pixel)),
            None => self.transport.samples,
        }
    }
}

impl Survey<'_> {
    /// Decides for the pixels of `wanted`; those of others stay in `map` as they are.
    ///
    /// All pixels begin with [`PILOTS`] samples. Those that need more and may do with fewer than all
    /// are asked again, with twice as many, round after round.
    pub(super) fn decide(
        &self,
        wanted: &PixelSet,
        mut map: SampleMap,
        pool: Option<&ThreadPool>,
        progress: &Progress,
    ) -> Result<Pilots, TraceError> {
        let layout = Layout::new(self.scene.picture.size);
        let rule = Rule { samples: self.scene.trace.samples, step: self.scene.trace.adaptive };
        let (mut traced, mut rays) = (SampleMap::of_pilots(layout), RayCounts::default());
        let rounds = Rounds {
            trees: (0..layout.tiles()).map(|_| Mutex::default()).collect(),
            held: AtomicUsize::new(0),
            found: Mutex::default(),
        };
        rays += self.round((&wanted.widened(), &traced), &rounds, pool, progress)?;
        let mut signatures = Signatures::new(layout);
        for Found { at, signatures: found } in rounds.take_found() {
            signatures.put(at, &found);
        }
        signatures.decide(wanted, rule, &ThinPixels::of(self.scene), &mut map);
        let (mut count, mut open) = (rule.after(PILOTS), PixelSet::new(layout));
        for place in wanted.places().filter(|&place| map.of(place) == count) {
            open.insert(place);
        }
        while count < rule.samples && !open.is_empty() {
            open.places().for_each(|place| traced.set(place, count));
            rays += self.round((&open, &traced), &rounds, pool, progress)?;
            let asked = std::mem::replace(&mut open, PixelSet::new(layout));
            for Found { at: (tile, block), signatures } in rounds.take_found() {
                for place in asked.places_of(tile, block) {
                    let verdict = rule.verdict(signatures[place.lane], count);
                    map.set(place, verdict);
                    if verdict == rule.after(count) {
                        open.insert(place);
                    }
                }
            }
            count = rule.after(count);
        }
        let trees = rounds.trees.into_iter();
        let trees = trees.map(|t| t.into_inner().unwrap_or_else(PoisonError::into_inner)).collect();
        Ok(Pilots { map: Some(Arc::new(map)), trees, rays })
    }

    /// Traces the blocks that hold some pixels, which have as many samples as `map` says.
    fn round(
        &self,
        (pixels, map): (&PixelSet, &SampleMap),
        rounds: &Rounds,
        pool: Option<&ThreadPool>,
        progress: &Progress,
    ) -> Result<RayCounts, TraceError> {
        let Survey { scene, geometry, old: _, keys, before, bent, bytes: _ } = *self;
        let grower = Grower::recalling(scene, geometry, keys.to_vec(), before)
            .with_bent(bent.to_vec())
            .with_map(Some(map));
        let palette = Palette::of(scene, geometry);
        let tiles: Vec<(usize, &Lanes)> = pixels.tiles().collect();
        let next = AtomicUsize::new(0);
        let work = || -> Result<RayCounts, TraceError> {
            let mut worker = grower.worker();
            let mut folder = Folder::default();
            while let Some(at) = claim(&next, tiles.len()) {
                let (tile, lanes) = tiles[at];
                let asked = Asked { grower: &grower, palette: palette.as_ref(), tile, lanes };
                asked.trace(self, rounds, (&mut worker, &mut folder), progress)?;
            }
            Ok(worker.rays)
        };
        let each = match pool {
            Some(pool) => pool.broadcast(|_| work()),
            None => vec![work()],
        };
        let mut sum = RayCounts::default();
        for rays in each {
            sum += rays?;
        }
        Ok(sum)
    }
}

impl Rounds {
    fn tree(&self, tile: usize) -> Option<Arc<KeptTrees>> {
        self.trees[tile].lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Keeps a tile's trees in place of those before, if all trees fit into `budget`.
    fn keep(&self, tile: usize, trees: KeptTrees, budget: usize) {
        let trees = trees.trimmed();
        let mut slot = self.trees[tile].lock().unwrap_or_else(PoisonError::into_inner);
        self.held.fetch_sub(slot.take().map_or(0, |before| before.bytes()), Relaxed);
        let bytes = trees.bytes();
        match self.held.fetch_add(bytes, Relaxed) + bytes <= budget {
            true => *slot = Some(Arc::new(trees)),
            false => drop(self.held.fetch_sub(bytes, Relaxed)),
        }
    }

    fn take_found(&self) -> Vec<Found> {
        std::mem::take(&mut self.found.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

/// A tile some of whose blocks are traced.
struct Asked<'a> {
    grower: &'a Grower<'a>,
    palette: Option<&'a Palette>,
    tile: usize,
    lanes: &'a Lanes,
}

impl Asked<'_> {
    fn trace(
        &self,
        survey: &Survey,
        rounds: &Rounds,
        (worker, folder): (&mut Worker, &mut Folder),
        progress: &Progress,
    ) -> Result<(), TraceError> {
        let Asked { grower, palette, tile, lanes } = *self;
        let first = rounds.tree(tile);
        let old = survey.old.get(tile).and_then(Option::as_deref);
        let (mut trees, mut grown) = (KeptTrees::default(), TileTrees::default());
        trees.clear();
        folder.begin_tile();
        let (mut blocks, mut signatures) = (Vec::new(), Vec::new());
        for (block, &lanes) in lanes.iter().enumerate() {
            if lanes == 0 {
                match &first {
                    Some(first) => trees.push_block(first, block),
                    None => trees.push_unknown(),
                }
                continue;
            }
            grown.clear();
            let (at, counts) = ((tile, block), grower.counts((tile, block)));
            let known = Recalls {
                first: first.as_ref().map(|first| first.recall_current(block)),
                rest: old.map(|old| old.recall(block)),
            };
            let stopped =
                grower.block_again(worker, at, known, &mut grown, LEAST_BLOCK_LIMIT, progress);
            stopped.map_err(|stop| TraceError::of(stop, LEAST_BLOCK_LIMIT))?;
            match palette {
                None => signatures.push(grower.signatures(&grown, at)),
                Some(palette) => palette.fold(folder, &grown, &counts),
            }
            blocks.push((block, counts));
            trees.push_counts(&counts);
            trees.push_grown(&grown, grower.keys());
        }
        if let Some(palette) = palette {
            signatures = palette.signatures(folder, &blocks);
        }
        let found = blocks.iter().zip(signatures);
        let found = found.map(|((block, _), signatures)| Found { at: (tile, *block), signatures });
        rounds.found.lock().unwrap_or_else(PoisonError::into_inner).extend(found);
        rounds.keep(tile, trees, survey.bytes);
        Ok(())
    }
}
