//! A picture without a session: some tiles at a time are traced and shaded, and only their light stays.

use rayon::ThreadPool;

use super::trace::{Keep, Kept, TraceError, TraceReport, trace_tiles};
use crate::film::layout::{Layout, TILE_BLOCKS};
use crate::film::{Film, FilmBlock};
use crate::fold::Names;
use crate::geometry::Geometry;
use crate::progress::Progress;
use crate::scene::Scene;
use crate::scene::factor::FactorValues;
use crate::shade::cpu;
use crate::shade::terms::{TermProgram, TermValues};

/// Tiles whose matrix is held at once: about four million pixels.
pub(super) const TILES_AT_ONCE: usize = 4096;

/// What a picture is traced from, and with.
#[derive(Clone, Copy)]
pub struct Still<'a> {
    /// What it shows.
    pub scene: &'a Scene,
    /// The scene made ready for rays.
    pub geometry: &'a Geometry,
    /// Threads.
    pub pool: &'a ThreadPool,
    /// Bytes that the matrix of the tiles held at once may take.
    pub memory: u64,
}

impl Still<'_> {
    /// The light of some tiles, 64 blocks for each, in the order asked for: bit for bit that of the
    /// whole picture, whatever the other tiles are. Steps of `progress` are tiles; whoever calls
    /// begins it.
    pub fn light(
        &self,
        tiles: &[usize],
        progress: &Progress,
    ) -> Result<(Vec<FilmBlock>, TraceReport), TraceError> {
        let Still { scene, geometry, pool, memory } = *self;
        let keep = Keep { what: Kept::Matrix, bytes: memory };
        let wanted = (scene, tiles.to_vec());
        let traced = trace_tiles(wanted, geometry, pool, keep, progress)?;
        let names = Names::new(geometry.materials(), scene.lights.len());
        let factors = FactorValues::new(scene).with_lights_at(&names.lights);
        let mut terms = TermValues::default();
        terms.evaluate(&TermProgram::new(&traced.transport.trie), &factors);
        let mut blocks = vec![FilmBlock::default(); tiles.len() * TILE_BLOCKS];
        cpu::film_tiles(pool, &traced.transport.tiles, &terms.values, &mut blocks);
        Ok((blocks, traced.report))
    }

    /// The whole picture.
    pub fn film(&self, progress: &Progress) -> Result<(Film, TraceReport), TraceError> {
        let layout = Layout::new(self.scene.picture.size);
        let tiles: Vec<usize> = (0..layout.tiles()).collect();
        progress.begin(tiles.len() as u64);
        let mut film = Film { layout, blocks: Vec::with_capacity(tiles.len() * TILE_BLOCKS) };
        let mut report = TraceReport::default();
        for some in tiles.chunks(TILES_AT_ONCE) {
            let (blocks, one) = self.light(some, progress)?;
            film.blocks.extend(blocks);
            report += one;
        }
        Ok((film, report))
    }
}
