//! The thumbnails of the examples, and the icon, are what the program renders.
//!
//! A change that is meant: `RAYFOREST_UPDATE_GOLDENS=1 cargo test --test all -- faces::examples`, then
//! look at the pictures.

use std::path::{Path, PathBuf};

use rayforest::document::examples::{EXAMPLES, Example};
use rayforest::film::develop::Development;
use rayforest::film::write::{Format, picture};
use rayforest::progress::Progress;
use rayforest::scene::{Scene, read};
use rayforest::session::layers::Extras;
use rayforest::session::{Options, Session};

use super::decode_png;

/// Largest thumbnail, in pixels.
const MOST: [u32; 2] = [192, 108];
/// Bytes of all thumbnails together: they are part of the program.
const MOST_BYTES: u64 = 700_000;

fn place(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(name)
}

/// The scene of an example at the size of its thumbnail.
fn small(example: &Example) -> Scene {
    let file = place("scenes").join(example.name).with_extension("toml");
    let mut scene = read::text(example.text, &file).unwrap_or_else(|e| panic!("{e}"));
    let [width, height] = scene.picture.size.map(f64::from);
    let scale = (f64::from(MOST[0]) / width).min(f64::from(MOST[1]) / height);
    scene.picture.size = [width, height].map(|side| (side * scale).round() as u32);
    scene
}

/// What a scene shows, with alpha or without, as a file, decoded again.
fn render(scene: Scene, alpha: bool, to: &Path) -> ([u32; 2], Vec<u8>) {
    let options = Options { threads: 2, memory: 1 << 30 };
    let development = Development::of(&scene.picture);
    let session = Session::open(scene, options, &Progress::default());
    let session = session.unwrap_or_else(|e| panic!("{e}"));
    let plates = session.plates(Extras { alpha, ..Extras::default() }).unwrap();
    picture(to, Format::Png8, &plates, development, "").expect("a writable folder");
    let (size, _, bytes) = decode_png(to).unwrap();
    (size, bytes)
}

/// Whether the committed picture is the one that is rendered, which takes its place if that is wanted.
fn is_kept(scene: Scene, alpha: bool, committed: &Path) -> bool {
    let folder = tempfile::tempdir().unwrap();
    let ours = folder.path().join("ours.png");
    let shown = render(scene, alpha, &ours);
    if std::env::var_os("RAYFOREST_UPDATE_GOLDENS").is_some() {
        std::fs::copy(&ours, committed).unwrap();
    }
    let (size, _, bytes) = decode_png(committed).unwrap();
    shown == (size, bytes)
}

#[test]
fn every_thumbnail_is_what_its_example_shows() {
    let mut bytes = 0;
    for example in EXAMPLES {
        let file = place(&format!("assets/examples/{}.png", example.name));
        assert!(
            is_kept(small(example), false, &file),
            "{}: see this file's first lines",
            example.name
        );
        bytes += std::fs::metadata(&file).unwrap().len();
    }
    assert!(bytes <= MOST_BYTES, "{bytes} bytes");
}

#[test]
fn the_icon_is_what_its_scene_shows() {
    let scene = read::file(&place("assets/icon.toml")).unwrap_or_else(|e| panic!("{e}"));
    assert!(is_kept(scene, true, &place("assets/icon.png")), "see this file's first lines");
}

#[test]
fn a_scene_that_changed_is_seen() {
    if std::env::var_os("RAYFOREST_UPDATE_GOLDENS").is_some() {
        return;
    }
    let plain = EXAMPLES.iter().find(|example| example.name == "plain").unwrap();
    let mut scene = small(plain);
    scene.materials[0].diffuse = scene.materials[0].diffuse * 1.02;
    assert!(!is_kept(scene, false, &place("assets/examples/plain.png")));
}
