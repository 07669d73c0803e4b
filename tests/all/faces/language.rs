//! The reference of scene files in `assets` is what the program prints, and its pictures are what the
//! program renders.
//!
//! A change that is meant: `RAYFOREST_UPDATE_GOLDENS=1 cargo test language`, then look at the pictures.

use std::path::{Path, PathBuf};

use rayforest::film::develop::Development;
use rayforest::film::plates::Plates;
use rayforest::film::write::{Format, picture};
use rayforest::progress::Progress;
use rayforest::scene::fields::SHAPES;
use rayforest::scene::{Scene, read};
use rayforest::session::{Options, Session};

use super::{decode_png, run, succeed};

/// Bytes of all pictures together.
const MOST_BYTES: u64 = 400_000;

fn assets() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("assets")
}

pub(super) fn is_update() -> bool {
    std::env::var_os("RAYFOREST_UPDATE_GOLDENS").is_some()
}

/// The scene of a solid's picture.
fn example(key: &str) -> Scene {
    let folder = tempfile::tempdir().unwrap();
    let text = succeed(folder.path(), &["language", "--example", key]).results;
    // Beside the mesh that it names.
    read::text(&text, &assets().join("language/example.toml")).unwrap_or_else(|e| panic!("{e}"))
}

/// What a scene shows, as a file, decoded again.
pub(super) fn render(scene: Scene, to: &Path) -> Vec<u8> {
    let options = Options { threads: 2, memory: 1 << 30 };
    let session = Session::open(scene, options, &Progress::default());
    let film = session.unwrap_or_else(|e| panic!("{e}")).film();
    picture(to, Format::Png8, &Plates::of(film), Development::PLAIN, "")
        .expect("a writable folder");
    decode_png(to).unwrap().2
}

/// The share of the pixels that differ.
fn apart(a: &[u8], b: &[u8]) -> f64 {
    assert_eq!(a.len(), b.len(), "pictures of one size");
    let differ = a.chunks(3).zip(b.chunks(3)).filter(|(a, b)| a != b).count();
    differ as f64 / (a.len() / 3) as f64
}

#[test]
fn the_reference_is_what_the_program_prints() {
    let folder = tempfile::tempdir().unwrap();
    let printed = succeed(folder.path(), &["language"]).results;
    let file = assets().join("language.md");
    if is_update() {
        std::fs::write(&file, &printed).unwrap();
    }
    let committed = std::fs::read_to_string(&file).unwrap();
    let first = printed.lines().zip(committed.lines()).find(|(a, b)| a != b);
    assert!(printed == committed, "{first:?}: see the first lines of this test's file");
    for key in SHAPES {
        assert!(printed.contains(&format!("### `{key}`")), "{key}");
    }
}

#[test]
fn every_solid_of_the_reference_renders_to_its_picture() {
    let folder = tempfile::tempdir().unwrap();
    let ours = folder.path().join("ours.png");
    let mut bytes = 0;
    for key in SHAPES {
        let scene = example(key);
        let mut stage = scene.clone();
        stage.solids.truncate(1);
        let file = assets().join(format!("language/{key}.png"));
        if is_update() {
            render(scene.clone(), &file);
        }
        let shown = render(scene, &ours);
        let alone = render(stage, &ours);
        let share = apart(&shown, &alone);
        assert!(share > 0.05, "{key}: the solid is seen in {share} of the picture");
        let committed = decode_png(&file).unwrap().2;
        assert_eq!(apart(&shown, &committed), 0.0, "{key}: see the first lines of this file");
        bytes += std::fs::metadata(&file).unwrap().len();
    }
    assert!(bytes <= MOST_BYTES, "{bytes} bytes");
}

#[test]
fn another_scene_is_another_picture() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("a.png");
    let mut scene = example("sphere");
    let before = render(scene.clone(), &file);
    scene.materials[1].diffuse = scene.materials[1].diffuse * 1.02;
    assert!(apart(&before, &render(scene, &file)) > 0.01);
}

#[test]
fn a_solid_that_does_not_exist_has_no_example() {
    let folder = tempfile::tempdir().unwrap();
    let ran = run(folder.path(), &["language", "--example", "tours"]);
    assert_eq!((ran.code, ran.results.as_str()), (Some(2), ""));
    let message = "error: there is no solid `tours`\n  help: did you mean `torus`?\n";
    assert_eq!(ran.messages, message);
}
