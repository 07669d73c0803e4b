//! Kept caches: what a session has traced, in a file beside the scene, so that the next opening casts
//! no ray.
//!
//! A cache holds the matrix with its highlight lists, the trees if they are wanted, and the scene
//! that they were made from. Opening compares that scene with the one that is opened, and the
//! difference costs what any edit costs. The file is compressed part by part (a part is one array
//! group of one tile), every part has a checksum, and whatever is read is held to every invariant
//! before it is used: a cut, changed, foreign or stale file is an answer, never a panic, and never a
//! picture of something else.

pub(super) mod codec;
mod error;
pub(super) mod file;
mod lists;
mod open;
mod parts;
mod read;
mod sound;
#[cfg(test)]
mod tests;
mod write;

use std::path::{Path, PathBuf};

pub use error::{CacheError, Fault};
pub use open::OpenedCache;
pub use read::{Cached, read};
pub use write::{Writing, write};

/// Ending of a cache's name.
pub const ENDING: &str = "rayforest-cache";

/// To be raised whenever the same scene gives other bits than before: another tracer, kernel or
/// order of samples or terms. Caches of before are then stale.
const NUMBERS: u32 = 2;

/// Where the cache of a scene file is: `scenes/room.toml` has `scenes/room.rayforest-cache`.
pub fn path_of(scene: &Path) -> PathBuf {
    scene.with_extension(ENDING)
}

/// The program as far as its numbers depend on it. Bits are the same on every CPU of one
/// architecture.
pub(super) fn program() -> String {
    format!("{} {NUMBERS} {}", env!("CARGO_PKG_VERSION"), std::env::consts::ARCH)
}

/// What a cache file holds, and what it took to write or read it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CacheReport {
    /// Length of the file.
    pub file_bytes: u64,
    /// Length of what it holds before it is compressed.
    pub plain_bytes: u64,
    /// Tiles with highlight lists, written or taken.
    pub lists: usize,
    /// Tiles with trees, written or taken.
    pub trees: usize,
    /// Wall time.
    pub seconds: f64,
}
