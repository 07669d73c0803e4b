//! Adaptive sampling: every pixel's first samples are traced, and say which pixels need all.

use std::collections::BTreeSet;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};
use std::sync::{Arc, Mutex};

use rayon::ThreadPool;

use super::Session;
use super::trace::{LEAST_BLOCK_LIMIT, TraceError, claim};
use crate::color::Rgb;
use crate::film::layout::{LANES, Layout, TILE_BLOCKS};
use crate::fold::{Folder, Names};
use crate::forest::counts::{SampleMap, Signatures};
use crate::forest::grow::{Grower, RayCounts, Worker};
use crate::forest::kept::KeptTrees;
use crate::forest::signature::{PILOTS, Signature};
use crate::forest::thin::ThinPixels;
use crate::forest::tree::TileTrees;
use crate::geometry::Geometry;
use crate::progress::Progress;
use crate::scene::Scene;
use crate::scene::change::Change;
use crate::scene::factor::FactorValues;
use crate::scene::model::Peak;
use crate::scene::refine::Refine;
use crate::shade::terms::{TermProgram, TermValues};

/// What the first samples of some tiles' pixels gave; nothing where sampling is not adaptive.
#[derive(Default)]
pub(super) struct Pilots {
    /// How many samples each pixel gets.
    pub(super) map: Option<Arc<SampleMap>>,
    /// Per tile of the picture the pilots' trees, as far as the memory reached: tracing all samples
    /// takes their answers.
    trees: Vec<Option<Arc<KeptTrees>>>,
    /// Rays cast.
    pub(super) rays: RayCounts,
}

/// What the colours of samples are found with, if they are compared.
struct Palette {
    names: Names,
    peaks: Vec<Option<Peak>>,
    factors: FactorValues,
    /// Of one sample: the grower lets a pilot stand for several.
    weight: f32,
}

/// The pilots of one tile.
struct Found {
    tile: usize,
    signatures: Vec<Signature>,
    trees: KeptTrees,
}

impl Pilots {
    /// Traces the pilots of some tiles and of the tiles around them, and decides. At most half of
    /// `bytes` holds their trees.
    pub(super) fn trace(
        (scene, tiles): (&Scene, &[usize]),
        geometry: &Geometry,
        pool: &ThreadPool,
        bytes: u64,
        progress: &Progress,
    ) -> Result<Pilots, TraceError> {
        if !scene.trace.is_adaptive() {
            return Ok(Pilots::default());
        }
        let layout = Layout::new(scene.picture.size);
        let around: Vec<usize> = with_neighbours(layout, tiles).into_iter().collect();
        let map = SampleMap::of_pilots(layout);
        let grower = Grower::new(scene, geometry).with_map(Some(&map));
        let palette = Palette::of(scene, geometry);
        let budget = usize::try_from(bytes / 2).unwrap_or(usize::MAX);
        let (next, held) = (AtomicUsize::new(0), AtomicUsize::new(0));
        let signatures = Mutex::new(Signatures::new(layout));
        let trees = Mutex::new(vec![None; layout.tiles()]);
        let rays = pool.broadcast(|_| -> Result<RayCounts, TraceError> {
            let mut worker = grower.worker();
            while let Some(at) = claim(&next, around.len()) {
                let found = grow((&grower, palette.as_ref()), &mut worker, around[at], progress)?;
                signatures.lock().expect("no worker panicked").put(found.tile, &found.signatures);
                let kept = found.trees.trimmed();
                if held.fetch_add(kept.bytes(), Relaxed) + kept.bytes() <= budget {
                    trees.lock().expect("no worker panicked")[found.tile] = Some(Arc::new(kept));
                }
            }
            Ok(worker.rays)
        });
        let mut sum = RayCounts::default();
        for rays in rays {
            sum += rays?;
        }
        let signatures = signatures.into_inner().expect("no worker panicked");
        let map = Some(Arc::new(decide(scene, &signatures, tiles)));
        let trees = trees.into_inner().expect("no worker panicked");
        Ok(Pilots { map, trees, rays: sum })
    }

    /// The trees of a tile's pilots, if they are there.
    pub(super) fn tree(&self, tile: usize) -> Option<Arc<KeptTrees>> {
        self.trees.get(tile).cloned().flatten()
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

    /// Whether branches begin or cease to live, or lights are gone: then other pixels may need all
    /// samples.
    pub(super) fn redecides(&mut self, scene: &Scene, change: &Change) -> bool {
        let values = |scene: &Scene| FactorValues::new(scene).with_lights_at(&self.names.lights);
        let before = self.terms.lives(&self.program, &values(&self.scene));
        let colors = self.scene.trace.refine == Refine::Contrast;
        colors && (change.terms || !change.refold.is_empty())
            || change.lights.len() != self.names.lights.len()
            || change.terms
                && before != self.terms.lives(&self.program, &self.factors_ahead(scene, change))
    }
}

/// The numbers of samples of one tile's pixels, where sampling is adaptive.
pub(super) fn sample_map(
    scene: &Scene,
    geometry: &Geometry,
    tile: usize,
    progress: &Progress,
) -> Result<Option<SampleMap>, TraceError> {
    if !scene.trace.is_adaptive() {
        return Ok(None);
    }
    let layout = Layout::new(scene.picture.size);
    let map = SampleMap::of_pilots(layout);
    let grower = Grower::new(scene, geometry).with_map(Some(&map));
    let palette = Palette::of(scene, geometry);
    let (mut worker, mut signatures) = (grower.worker(), Signatures::new(layout));
    for near in with_neighbours(layout, &[tile]) {
        let found = grow((&grower, palette.as_ref()), &mut worker, near, progress)?;
        signatures.put(near, &found.signatures);
    }
    Ok(Some(decide(scene, &signatures, &[tile])))
}

fn decide(scene: &Scene, signatures: &Signatures, tiles: &[usize]) -> SampleMap {
    let thin = ThinPixels::of(scene);
    let is_thin = |pixel| thin.contains(pixel);
    signatures.decide(tiles, scene.trace.samples, scene.trace.adaptive, is_thin)
}

/// Grows the pilots of a tile.
fn grow(
    (grower, palette): (&Grower, Option<&Palette>),
    worker: &mut Worker,
    tile: usize,
    progress: &Progress,
) -> Result<Found, TraceError> {
    let mut trees = KeptTrees::default();
    trees.clear();
    let mut signatures = Vec::with_capacity(TILE_BLOCKS * LANES);
    let mut grown = TileTrees::default();
    let mut folder = Folder::default();
    folder.begin_tile();
    for block in 0..TILE_BLOCKS {
        grown.clear();
        let at = (tile, block);
        let stopped = grower.block(worker, at, &mut grown, LEAST_BLOCK_LIMIT, progress);
        stopped.map_err(|stop| TraceError::of(stop, LEAST_BLOCK_LIMIT))?;
        match palette {
            None => signatures.extend(grower.signatures(&grown, at)),
            Some(palette) => fold_samples(&mut folder, &grown, &grower.counts(at), &palette.names),
        }
        trees.push_counts(&grower.counts(at));
        trees.push_grown(&grown, grower.keys());
    }
    if let Some(palette) = palette {
        let counts = (0..TILE_BLOCKS).flat_map(|block| grower.counts((tile, block)));
        signatures = palette.signatures(&mut folder, counts);
    }
    Ok(Found { tile, signatures, trees })
}

/// Folds a block so that every sample has a lane of its own, sixteen samples after another.
fn fold_samples(folder: &mut Folder, grown: &TileTrees, counts: &[u32; LANES], names: &Names) {
    let mut reader = grown.read(0);
    let mut rest = counts.iter().sum::<u32>() as usize;
    for _ in 0..PILOTS {
        let here = rest.min(LANES);
        rest -= here;
        folder.block(&mut reader, &std::array::from_fn(|lane| u32::from(lane < here)), names);
    }
}

impl Palette {
    /// That of a scene; `None` if it does not compare colours.
    fn of(scene: &Scene, geometry: &Geometry) -> Option<Palette> {
        (scene.trace.refine == Refine::Contrast).then(|| Palette {
            names: Names::new(geometry.materials(), scene.lights.len()),
            peaks: scene.materials.iter().map(|m| Some(Peak::of(m))).collect(),
            factors: FactorValues::new(scene),
            weight: PILOTS as f32 / scene.trace.samples as f32,
        })
    }

    /// The signatures of a tile's pixels, of which [`fold_samples`] folded the samples.
    fn signatures(&self, folder: &mut Folder, counts: impl Iterator<Item = u32>) -> Vec<Signature> {
        let folded = folder.finish_tile(self.weight, &self.peaks);
        let mut terms = TermValues::default();
        terms.evaluate(&TermProgram::new(folded.trie), &self.factors);
        let value = |entry: usize| {
            let [r, g, b, _] = terms.values[folded.tile.terms[entry] as usize];
            Rgb([r, g, b])
        };
        let mut colors = vec![Rgb::BLACK; TILE_BLOCKS * LANES * PILOTS as usize];
        for (block, colors) in colors.chunks_exact_mut(LANES).enumerate() {
            let rows = folded.tile.block(block);
            for (&entry, plane) in rows.entries.iter().zip(rows.planes) {
                let value = value(entry as usize);
                colors.iter_mut().zip(plane.0).for_each(|(color, c)| *color = *color + value * c);
            }
            for single in rows.singles {
                let color = &mut colors[single.lane()];
                *color = *color + value(single.entry()) * single.coefficient;
            }
        }
        // The samples of a block stand one after another, those of the next begin anew.
        let mut blocks = colors.chunks_exact(LANES * PILOTS as usize);
        let counts: Vec<u32> = counts.collect();
        let mut signatures = Vec::with_capacity(counts.len());
        for counts in counts.chunks_exact(LANES) {
            let mut rest = blocks.next().expect("the samples of every block");
            for &count in counts {
                let (own, after) = rest.split_at(count as usize);
                signatures.push(Signature::of_colors(own));
                rest = after;
            }
        }
        signatures
    }
}

/// Some tiles and those that touch them.
fn with_neighbours(layout: Layout, tiles: &[usize]) -> BTreeSet<usize> {
    let [across, down] = layout.grid();
    let near = |tile: usize| {
        let (column, row) = (tile % across, tile / across);
        let columns = column.saturating_sub(1)..=(column + 1).min(across - 1);
        let rows = row.saturating_sub(1)..=(row + 1).min(down - 1);
        rows.flat_map(move |row| columns.clone().map(move |column| row * across + column))
    };
    tiles.iter().flat_map(|&tile| near(tile)).collect()
}
