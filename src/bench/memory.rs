//! What the machine's memory allows: the time to read a matrix and write a film, and peaks.

use fearless_simd::{Level, dispatch};
use rayon::ThreadPool;
use rayon::prelude::*;

use crate::film::layout::{LANES, TILE_BLOCKS};
use crate::film::{Film, FilmBlock};
use crate::fold::transport::{Plane, Transport, TransportTile};

/// Reads every byte of the matrix once and writes every byte of the film once, with as little
/// arithmetic as keeps the compiler from leaving it out.
pub(super) fn read_and_write(pool: &ThreadPool, transport: &Transport, film: &mut Film) {
    let level = Level::new();
    pool.install(|| {
        let parts = film.blocks.par_chunks_exact_mut(TILE_BLOCKS).zip(&transport.tiles);
        parts.for_each(|(blocks, tile)| dispatch!(level, _simd => touch(tile, blocks)));
    });
}

#[inline(always)]
fn touch(tile: &TransportTile, blocks: &mut [FilmBlock]) {
    let ids = tile.entries.iter().chain(&tile.terms).fold(0u32, |a, b| a ^ b);
    let ids = tile.singles.iter().fold(ids, |a, s| a ^ s.entry() as u32 ^ s.coefficient.to_bits());
    for (block, out) in blocks.iter_mut().enumerate() {
        let mut sum = [0.0f32; LANES];
        for Plane(plane) in tile.block(block).planes {
            for (s, p) in sum.iter_mut().zip(plane) {
                *s += p;
            }
        }
        sum[0] += (ids & 1) as f32;
        *out = FilmBlock([sum; 3]);
    }
}

/// The largest resident memory of this process so far in MB, where the system tells (Linux).
pub(super) fn peak_resident_mb() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|l| l.starts_with("VmHWM:"))?;
    let kib: f64 = line.split_whitespace().nth(1)?.parse().ok()?;
    Some(kib * 1024.0 / 1e6)
}
