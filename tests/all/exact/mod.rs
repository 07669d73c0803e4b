//! Held bit for bit: pictures after edits, histories, threads and memory budgets; and the floors.

mod adaptive;
mod badges;
mod cache;
mod classes;
mod comes_alive;
mod floors;
mod gpu;
mod histories;
mod inspected;
mod lamps;
mod memory;
mod named;
mod parts;
mod presets;
pub(crate) mod random;
mod regrows;
mod stopped;
mod table;
mod table_csg;
mod textures;
mod threads;

use std::path::{Path, PathBuf};

use rayforest::film::Film;
use rayforest::film::layout::LANES;
use rayforest::progress::Progress;
use rayforest::scene::{Scene, path, read};
use rayforest::session::{Options, Session};

/// Scenes of all kinds of lights, materials, solids and operations.
pub(crate) fn texts_of_all_kinds() -> Vec<String> {
    let solids = format!("{}{}", table::SCENE, table::SOLIDS);
    vec![solids, table::LAMPS.to_owned(), table_csg::CSG.to_owned(), regrows::DRINK.to_owned()]
}

/// More than any test needs.
const PLENTY: u64 = 1 << 32;

fn options(threads: usize) -> Options {
    Options { threads, memory: PLENTY }
}

fn open(scene: &Scene, threads: usize) -> Session {
    let opened = Session::open(scene.clone(), options(threads), &Progress::default());
    opened.unwrap_or_else(|e| panic!("a trace within its budget: {e}"))
}

fn set(scene: &mut Scene, name: &str, value: &str) {
    path::set(scene, name, value).unwrap_or_else(|e| panic!("{name} = {value}: {e}"));
}

fn scenes() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes")
}

/// The shipped scenes by the stem of their file.
const SHIPPED: [&str; 14] = [
    "whitted",
    "plain",
    "glass",
    "gems",
    "flake",
    "mesh",
    "mirrors",
    "motion",
    "studio",
    "gallery",
    "chain",
    "gears",
    "csg_part",
    "still_life",
];

/// A shipped scene as a small picture; the knot with fewer triangles, the flake with fewer spheres.
fn shipped(name: &str, size: [u32; 2], samples: u32) -> Scene {
    let file = scenes().join(format!("{name}.toml"));
    let mut scene = read::file(&file).unwrap_or_else(|e| panic!("{e}"));
    set(&mut scene, "picture.size", &format!("[{}, {}]", size[0], size[1]));
    set(&mut scene, "trace.samples", &samples.to_string());
    match name {
        "mesh" | "studio" => set(&mut scene, "solids.knot.knot.segments", "[90, 12]"),
        "gallery" => set(&mut scene, "solids.ribbon.knot.segments", "[60, 8]"),
        "flake" => set(&mut scene, "solids.flake.sphereflake.levels", "4"),
        _ => {}
    }
    scene
}

/// The first bit in which two films differ, in words.
fn film_difference(a: &Film, b: &Film) -> Option<String> {
    if a.layout != b.layout {
        return Some(format!("layouts {:?} and {:?}", a.layout, b.layout));
    }
    for (index, (a, b)) in a.blocks.iter().zip(&b.blocks).enumerate() {
        for channel in 0..3 {
            for lane in 0..LANES {
                let (a, b) = (a.0[channel][lane], b.0[channel][lane]);
                if a.to_bits() != b.to_bits() {
                    return Some(format!(
                        "block {index}, channel {channel}, lane {lane}: {a:e} and {b:e}"
                    ));
                }
            }
        }
    }
    None
}

/// Holds two sessions to the same picture: bytes as shown, and bits of the light.
fn assert_same_picture(a: &Session, b: &Session, what: &str) {
    if let Some(difference) = film_difference(&a.film(), &b.film()) {
        panic!("{what}: films differ at {difference}");
    }
    assert!(a.frame() == b.frame(), "{what}: equal films, but other bytes as shown");
}

#[test]
fn every_scene_file_is_among_the_shipped_ones() {
    let mut found: Vec<String> = std::fs::read_dir(scenes())
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|e| e == "toml"))
        .map(|path| path.file_stem().unwrap().to_string_lossy().into_owned())
        .collect();
    found.sort();
    let mut listed = SHIPPED.map(str::to_owned);
    listed.sort();
    assert_eq!(found, listed);
}

#[test]
fn one_changed_bit_of_a_film_is_found() {
    let film = open(&shipped("plain", [40, 20], 1), 1).film();
    assert_eq!(film_difference(&film, &film.clone()), None);
    let mut other = film.clone();
    let value = &mut other.blocks[70].0[2][5];
    *value = f32::from_bits(value.to_bits() ^ 1);
    let found = film_difference(&film, &other).unwrap();
    assert!(found.starts_with("block 70, channel 2, lane 5"), "{found}");
    let mut negative = film.clone();
    let zero = negative.blocks.iter_mut().flat_map(|b| &mut b.0[0]).find(|v| **v == 0.0).unwrap();
    *zero = -0.0;
    assert!(film_difference(&film, &negative).is_some(), "the sign of zero counts");
}

#[test]
#[should_panic(expected = "films differ")]
fn pictures_that_differ_a_little_are_told_apart() {
    let scene = shipped("plain", [16, 9], 1);
    let mut brighter = scene.clone();
    set(&mut brighter, "materials.clay.diffuse", "0.7000001");
    assert_same_picture(&open(&scene, 1), &open(&brighter, 1), "on purpose");
}

#[test]
#[should_panic(expected = "other bytes as shown")]
fn pictures_that_are_only_shown_otherwise_are_told_apart() {
    let scene = shipped("plain", [16, 9], 1);
    let mut exposed = scene.clone();
    set(&mut exposed, "picture.exposure", "0.5");
    assert_same_picture(&open(&scene, 1), &open(&exposed, 1), "on purpose");
}
