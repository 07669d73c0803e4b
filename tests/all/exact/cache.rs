//! Kept caches: what is opened from a file is what is traced afresh, and the difference to the opened
//! scene costs what an edit costs.

use std::path::{Path, PathBuf};

use rayforest::progress::Progress;
use rayforest::scene::path::{Parameter, parameters};
use rayforest::scene::{Scene, read};
use rayforest::session::cache::{self, CacheReport, Fault, OpenedCache};
use rayforest::session::{Class, Options, Session};

use super::random::Random;
use super::table::SCENE;
use super::{SHIPPED, assert_same_picture, open, options, set, shipped};

/// A folder and the name of a cache in it.
fn place() -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = cache::path_of(&folder.path().join("scene.toml"));
    assert_eq!(path, folder.path().join("scene.rayforest-cache"));
    (folder, path)
}

fn keep(session: &Session, path: &Path, trees: bool) -> CacheReport {
    let kept = cache::write(session, path, trees, &Progress::default());
    kept.unwrap_or_else(|e| panic!("{e}"))
}

fn reopen(scene: &Scene, path: &Path, threads: usize) -> (Session, OpenedCache) {
    let opened = Session::open_cached(scene.clone(), path, options(threads), &Progress::default());
    opened.unwrap_or_else(|e| panic!("{e}"))
}

fn refused(scene: &Scene, path: &Path) -> Fault {
    match Session::open_cached(scene.clone(), path, options(2), &Progress::default()) {
        Err(error) => error.fault,
        Ok((_, opened)) => panic!("opened: {opened:?}"),
    }
}

/// Opens `scene` with the cache and holds it to a class and to the exact picture.
fn reopens_as(scene: &Scene, path: &Path, class: Class, what: &str) -> Session {
    let (mut session, opened) = reopen(scene, path, 2);
    assert_eq!(opened.edit.class, class, "{what}: {:?}", opened.edit.reason);
    assert!(class >= Class::Regrow || opened.edit.rays.total() == 0, "{what}: rays were cast");
    assert!(session.scene() == scene, "{what}: another scene");
    session.transport().validate();
    let fresh = open(scene, 2);
    assert_same_picture(&session, &fresh, what);
    // Whatever comes later is as exact.
    let mut later = scene.clone();
    later.materials[0].shininess = 7.0;
    later.background =
        rayforest::scene::Background::Color(rayforest::color::Rgb([0.25, 0.5, 0.125]));
    session.edit(later.clone(), &Progress::default()).unwrap();
    assert_same_picture(&session, &open(&later, 2), &format!("{what}, and an edit"));
    session
}

fn all_kinds() -> Scene {
    read::text(SCENE, Path::new("all-kinds.toml")).unwrap_or_else(|e| panic!("{e}"))
}

#[test]
fn every_scene_comes_back_as_it_was() {
    let scenes = SHIPPED.map(|name| (name, shipped(name, [70, 41], 2)));
    for (name, scene) in scenes.into_iter().chain([("all kinds", all_kinds())]) {
        let (_folder, path) = place();
        let session = open(&scene, 2);
        for (trees, threads) in [(true, 1), (false, 2)] {
            let kept = keep(&session, &path, trees);
            let (opened, OpenedCache { cache, edit }) = reopen(&scene, &path, threads);
            assert_eq!((edit.class, edit.rays.total()), (Class::None, 0), "{name}");
            assert_eq!(CacheReport { seconds: kept.seconds, ..cache }, kept, "{name}");
            assert!(opened.transport() == session.transport(), "{name}: another matrix");
            assert!(!trees || opened.forest() == session.forest(), "{name}: other trees");
            assert!(trees || opened.forest().released() == opened.forest().tiles.len());
            assert_eq!(opened.trace_report(), session.trace_report(), "{name}");
            assert_same_picture(&opened, &session, name);
        }
    }
}

#[test]
fn a_saved_edit_costs_what_the_edit_costs() {
    let (_folder, path) = place();
    let scene = shipped("whitted", [70, 41], 2);
    keep(&open(&scene, 2), &path, true);
    for (name, value, class) in [
        ("materials.mirror.diffuse", "0.31", Class::Reshade),
        ("materials.tiles.texture.checker.a", "[0.1, 0.7, 0.2]", Class::Reshade),
        ("lights.key.intensity", "[0, 2, 0.5]", Class::Reshade),
        ("picture.exposure", "-1.5", Class::Reshade),
        ("trace.depth", "1", Class::Reshade),
        ("materials.mirror.shininess", "11", Class::Refold),
    ] {
        let mut saved = scene.clone();
        set(&mut saved, name, value);
        reopens_as(&saved, &path, class, &format!("{name} = {value}"));
    }
    for (name, value) in [
        ("camera.eye", "[0.3, -6, 2]"),
        ("lights.key.point", "[1, -2, 6]"),
        ("materials.tiles.reflect", "0.4"),
        ("solids.floor.plane.offset", "-0.5"),
    ] {
        let mut saved = scene.clone();
        set(&mut saved, name, value);
        let (session, opened) = reopen(&saved, &path, 2);
        assert!(opened.edit.class >= Class::Regrow, "{name}: {:?}", opened.edit);
        assert_same_picture(&session, &open(&saved, 2), &format!("{name} = {value}"));
    }
    reopens_as(&scene, &path, Class::None, "the cache is as it was");
}

#[test]
fn what_is_kept_after_edits_is_as_good() {
    let random = &mut Random(21);
    let (_folder, path) = place();
    let mut session = open(&all_kinds(), 2);
    for step in 0..6 {
        let mut scene = session.scene().clone();
        let weights = ["reflect", "transmit", "filter", "color", "intensity", "diffuse"];
        // The filter of the trace has a name for a value.
        let numbers = |p: &Parameter| p.range.is_some();
        let all = parameters(&scene).into_iter().filter(numbers);
        let names: Vec<_> = all.map(|p| p.path).collect();
        let is_weight = |name: &&str| weights.iter().any(|weight| name.ends_with(weight));
        let names: Vec<&str> = names.iter().map(String::as_str).filter(is_weight).collect();
        for _ in 0..3 {
            set(&mut scene, random.pick(&names), &format!("{:.3}", random.unit()));
        }
        scene.materials[step % 3].shininess = 5.0 + step as f32;
        match step {
            1 => set(&mut scene, "materials.glass.ior", "1.4"),
            2 => set(&mut scene, "lights.sun.direction", "[-0.4, 0.5, -1]"),
            3 => drop(scene.lights.remove(0)),
            4 => scene.solids[1].material = 3,
            _ => {}
        }
        session.edit(scene, &Progress::default()).unwrap();
        keep(&session, &path, step % 2 == 0);
        let what = format!("step {step}");
        session = reopens_as(session.scene(), &path, Class::None, &what);
        // Trees that were kept answer the rays of an edit as those of the session would.
        let mut deeper = session.scene().clone();
        deeper.trace.depth += 1;
        session.edit(deeper.clone(), &Progress::default()).unwrap();
        assert_same_picture(&session, &open(&deeper, 2), &format!("{what}, and deeper"));
    }
}

#[test]
fn a_budget_that_released_tiles_is_kept_and_held() {
    let scene = shipped("whitted", [200, 120], 4);
    let whole = open(&scene, 2);
    let needs = |session: &Session| {
        let matrix: usize = session.transport().tiles.iter().map(|tile| tile.bytes()).sum();
        [matrix, session.transport().highlight_bytes(), session.forest().bytes()]
            .map(|bytes| bytes as u64)
    };
    let [matrix, lists, trees] = needs(&whole);
    let (_folder, path) = place();
    for memory in [matrix + lists + trees / 2, matrix + lists / 2, matrix] {
        let small = Options { threads: 2, memory };
        let session = Session::open(scene.clone(), small, &Progress::default()).unwrap();
        keep(&session, &path, true);
        let (opened, _) = reopen(&scene, &path, 2);
        assert!(opened.forest() == session.forest() && opened.transport() == session.transport());
        keep(&whole, &path, true);
        let opened = Session::open_cached(scene.clone(), &path, small, &Progress::default());
        let (opened, _) = opened.unwrap();
        assert!(needs(&opened).iter().sum::<u64>() <= memory, "{:?} of {memory}", needs(&opened));
        assert_same_picture(&opened, &whole, "within less memory");
    }
    let small = Options { threads: 2, memory: matrix - 1 };
    let error = Session::open_cached(scene, &path, small, &Progress::default()).err().unwrap();
    assert_eq!(error.fault, Fault::Memory { budget: matrix - 1 });
}

#[test]
fn another_size_and_other_samples_are_stale() {
    let (_folder, path) = place();
    let scene = shipped("plain", [40, 26], 2);
    keep(&open(&scene, 2), &path, false);
    for (name, value, words) in
        [("picture.size", "[41, 26]", "40×26"), ("trace.samples", "3", "samples was 2, it is 3")]
    {
        let mut other = scene.clone();
        set(&mut other, name, value);
        let Fault::Stale { what } = refused(&other, &path) else { panic!("{name}") };
        assert!(what.contains(words), "{what}");
    }
    std::fs::write(&path, "a note of mine").unwrap();
    assert_eq!(refused(&scene, &path), Fault::Foreign);
    std::fs::remove_file(&path).unwrap();
    assert_eq!(refused(&scene, &path), Fault::Absent);
}

#[test]
fn a_mesh_that_changed_is_stale() {
    let (folder, path) = place();
    let file = folder.path().join("scene.toml");
    let obj = |height: &str| {
        let text = format!("v -1 0 0\nv 1 0 0\nv 0 0 {height}\nv 0 1 0\nf 1 2 3\nf 2 4 3\n");
        std::fs::write(folder.path().join("a.obj"), text).unwrap();
        read::file(&file).unwrap_or_else(|e| panic!("{e}"))
    };
    let text = "version = 1\npicture = { size = [40, 26] }\n\
                lights = { key = { point = [-2, -5, 4] } }\nmaterials = { clay = {} }\n\
                solids = { m = { mesh = { file = \"a.obj\" }, material = \"clay\" } }\n";
    std::fs::write(&file, text).unwrap();
    let scene = obj("1");
    keep(&open(&scene, 2), &path, true);
    let mut dyed = obj("1");
    set(&mut dyed, "materials.clay.color", "[1, 0, 0]");
    reopens_as(&dyed, &path, Class::Reshade, "the same mesh, read again");
    let taller = obj("1.0000000000000002");
    assert_eq!(
        refused(&taller, &path),
        Fault::Stale { what: "a mesh or an image has changed".into() }
    );
}
