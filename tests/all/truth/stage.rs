//! Scenes for tests: the shipped ones at a size that a test can afford, and sessions of any scene.

use std::path::{Path, PathBuf};

use rayforest::progress::Progress;
use rayforest::scene::{Scene, read};
use rayforest::session::{Options, Session};

/// Width and height of a shipped scene in a test: two tiles, the lower and right ones ragged.
pub(super) const SIZE: [u32; 2] = [64, 36];

/// The names of all scene files that are shipped.
pub(super) fn shipped_names() -> Vec<String> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    let entries = std::fs::read_dir(folder).expect("the scenes are shipped");
    let files = entries.map(|e| e.expect("a readable folder").path());
    let scenes = files.filter(|f| f.extension().is_some_and(|e| e == "toml"));
    let stem = |f: PathBuf| f.file_stem().expect("a name").to_string_lossy().into_owned();
    let mut names: Vec<String> = scenes.map(stem).collect();
    names.sort();
    assert!(names.len() >= 8, "the shipped scenes are {names:?}");
    names
}

/// A shipped scene in [`SIZE`] with 4 samples.
pub(super) fn shipped(name: &str) -> Scene {
    let mut scene = file(&format!("scenes/{name}.toml"));
    scene.picture.size = SIZE;
    scene.trace.samples = 4;
    scene
}

/// The scene in a file of the repository.
pub(super) fn file(path: &str) -> Scene {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(path);
    read::file(&path).unwrap_or_else(|error| panic!("{error}"))
}

/// Traces a scene.
pub(super) fn open(scene: Scene) -> Session {
    let options = Options { threads: 2, memory: 1 << 30 };
    Session::open(scene, options, &Progress::default()).unwrap_or_else(|error| panic!("{error}"))
}
