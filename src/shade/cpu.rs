//! The matrix product on the CPU: tiles in parallel, vector lanes across pixels.
//!
//! A pixel is two sums, each from +0 in canonical order: its planes, then its single coefficients.
//! Planes of terms that are zero are skipped: adding zero changes no bit of a sum that began at +0,
//! because no coefficient in front of it is infinite and no partial sum is −0. A coefficient of −0
//! adds nothing either.

use std::sync::Arc;

use fearless_simd::{Level, dispatch};
use rayon::ThreadPool;
use rayon::prelude::*;

use crate::film::develop::{Development, FrameRows, tile_rows};
use crate::film::layout::{LANES, Layout, TILE_BLOCKS};
use crate::film::{Film, FilmBlock, Frame};
use crate::fold::merge::Blocks;
use crate::fold::transport::{Block, Plane, Single, Transport, TransportTile};

/// Which tiles to compute.
#[derive(Clone, Copy, Debug)]
pub enum Tiles<'a> {
    /// Every one.
    All,
    /// Those marked `true`.
    Marked(&'a [bool]),
}

impl Tiles<'_> {
    /// Whether this tile is one of them.
    pub fn has(self, tile: usize) -> bool {
        match self {
            Tiles::All => true,
            Tiles::Marked(marks) => marks[tile],
        }
    }
}

/// The linear picture of all tiles, into a film of the transport's layout.
pub fn film(pool: &ThreadPool, transport: &Transport, values: &[[f32; 4]], film: &mut Film) {
    assert_eq!(film.layout, transport.layout, "a film of the same cut");
    film_tiles(pool, &transport.tiles, values, &mut film.blocks);
}

/// The linear picture of some tiles, into 64 blocks for each.
pub fn film_tiles(
    pool: &ThreadPool,
    tiles: &[Arc<TransportTile>],
    values: &[[f32; 4]],
    blocks: &mut [FilmBlock],
) {
    assert_eq!(blocks.len(), tiles.len() * TILE_BLOCKS, "64 blocks for each tile");
    let level = Level::new();
    pool.install(|| {
        let parts = blocks.par_chunks_exact_mut(TILE_BLOCKS);
        parts.zip(tiles).for_each_init(Vec::new, |gathered, (blocks, tile)| {
            gather(tile, values, gathered);
            dispatch!(level, _simd => film_tile(tile, gathered, blocks));
        });
    });
}

/// The picture as shown, of the tiles asked for: product, development and sRGB in one pass.
pub fn frame(
    pool: &ThreadPool,
    transport: &Transport,
    values: &[[f32; 4]],
    development: Development,
    tiles: Tiles,
    frame: &mut Frame,
) {
    assert_eq!(frame.size, transport.layout.size, "a frame of the same size");
    let level = Level::new();
    let columns = transport.layout.grid()[0];
    let rows: Vec<FrameRows> = tile_rows(frame).collect();
    pool.install(|| {
        rows.into_par_iter().enumerate().for_each_init(Vec::new, |gathered, (row, mut rows)| {
            for column in 0..columns {
                let index = row * columns + column;
                if tiles.has(index) {
                    let tile = &transport.tiles[index];
                    gather(tile, values, gathered);
                    dispatch!(level, _simd => frame_tile(tile, gathered, development, column, &mut rows));
                }
            }
        });
    });
}

/// The same of some blocks of a tile: `part` holds the blocks of the set `blocks`, in rising order,
/// and nothing else.
pub fn frame_blocks(
    (tile, blocks): (usize, Blocks),
    part: &TransportTile,
    values: &[[f32; 4]],
    development: Development,
    frame: &mut Frame,
) {
    let columns = Layout::new(frame.size).grid()[0];
    let mut gathered = Vec::new();
    gather(part, values, &mut gathered);
    let mut rows = tile_rows(frame).nth(tile / columns).expect("a tile of the picture");
    let marked = (0..TILE_BLOCKS).filter(|block| blocks >> block & 1 != 0);
    for (index, block) in marked.enumerate() {
        rows.put(tile % columns, block, &sum(part.block(index), &gathered), development);
    }
}

/// The values of a tile's terms, in the order of its dictionary.
#[inline(always)]
fn gather(tile: &TransportTile, values: &[[f32; 4]], gathered: &mut Vec<[f32; 4]>) {
    gathered.clear();
    gathered.extend(tile.terms.iter().map(|&term| values[term as usize]));
}

#[inline(always)]
fn film_tile(tile: &TransportTile, values: &[[f32; 4]], blocks: &mut [FilmBlock]) {
    for (block, out) in blocks.iter_mut().enumerate() {
        *out = sum(tile.block(block), values);
    }
}

#[inline(always)]
fn frame_tile(
    tile: &TransportTile,
    values: &[[f32; 4]],
    development: Development,
    column: usize,
    rows: &mut FrameRows,
) {
    for block in 0..TILE_BLOCKS {
        rows.put(column, block, &sum(tile.block(block), values), development);
    }
}

/// Σ coefficient · value for the 16 pixels of a block: the sum over the planes plus, where there are
/// any, the sum over the single coefficients, each from +0 in canonical order.
#[inline(always)]
fn sum(block: Block, values: &[[f32; 4]]) -> FilmBlock {
    let mut red = [0.0f32; LANES];
    let mut green = [0.0f32; LANES];
    let mut blue = [0.0f32; LANES];
    for (&entry, Plane(plane)) in block.entries.iter().zip(block.planes) {
        let [r, g, b, lit] = values[entry as usize];
        if lit == 0.0 {
            continue;
        }
        for i in 0..LANES {
            red[i] += plane[i] * r;
            green[i] += plane[i] * g;
            blue[i] += plane[i] * b;
        }
    }
    if !block.singles.is_empty() {
        for (i, [r, g, b, _]) in sum_singles(block.singles, values).into_iter().enumerate() {
            red[i] += r;
            green[i] += g;
            blue[i] += b;
        }
    }
    FilmBlock([red, green, blue])
}

/// The terms of few pixels, pixel by pixel.
#[inline(always)]
fn sum_singles(singles: &[Single], values: &[[f32; 4]]) -> [[f32; 4]; LANES] {
    let mut sums = [[0.0f32; 4]; LANES];
    for single in singles {
        let value = values[single.entry()];
        for (sum, v) in sums[single.lane()].iter_mut().zip(value) {
            *sum += single.coefficient * v;
        }
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A number in [0, 1) from a counter.
    fn value(i: usize) -> f32 {
        ((i * 7919 + 13) % 1009) as f32 / 1009.0
    }

    #[test]
    fn every_simd_level_gives_the_same_bits() {
        let planes: Vec<Plane> =
            (0..40).map(|t| Plane(std::array::from_fn(|i| value(t * 16 + i) / 3.0))).collect();
        let entries: Vec<u32> = (0..40).map(|t| t * 2).collect();
        let singles: Vec<Single> =
            (0..30).map(|t| Single::new(t * 2 + 1, t as usize % 16, value(t as usize))).collect();
        let values: Vec<[f32; 4]> =
            (0..80).map(|t| [value(t), value(t + 1) * 1e-3, value(t + 2) * 7.0, 1.0]).collect();
        let block = Block { entries: &entries, planes: &planes, singles: &singles };
        let scalar = sum(block, &values);
        for level in [Level::baseline(), Level::new()] {
            let vectors = dispatch!(level, _simd => sum(block, &values));
            assert_eq!(vectors, scalar, "{level:?}");
        }
        // The helper above must be able to fail: another order of summation is another sum.
        let reversed: Vec<u32> = entries.iter().rev().copied().collect();
        assert_ne!(sum(Block { entries: &reversed, ..block }, &values), scalar);
    }

    #[test]
    fn terms_that_are_zero_change_no_bit() {
        let planes = [Plane([0.3; 16]), Plane([0.7; 16]), Plane([0.11; 16])];
        let values = [[0.1, 0.2, 0.3, 1.0], [0.0; 4], [0.5, 0.0, 0.9, 1.0]];
        let all = Block { entries: &[0, 1, 2], planes: &planes, singles: &[] };
        let lit = Block { entries: &[0, 2], planes: &[planes[0], planes[2]], singles: &[] };
        assert_eq!(sum(all, &values), sum(lit, &values));
    }
}
