//! Random histories of edits that grow trees again: every state is the picture of a fresh trace.

use std::path::Path;
use std::sync::Arc;

use rayforest::progress::Progress;
use rayforest::scene::refine::Refine;
use rayforest::scene::{Background, Bump, Light, LightPlace, Material, Paint, Scene, read, write};
use rayforest::session::cache;
use rayforest::session::trace::TraceError;
use rayforest::session::{Class, Options, Session};

use super::classes::solids;
use super::named::{counted_alike, plan, untouched};
use super::random::Random;
use super::table::LAMPS;
use super::{assert_same_picture, open, options, set, shipped};

const EDITS: usize = 30;

/// Histories per scene.
fn histories() -> u64 {
    if std::env::var_os("RAYFOREST_LONG").is_some() { 40 } else { 2 }
}

/// The scene with something changed that asks for no new camera rays, and the change in words.
fn edited(scene: &Scene, random: &mut Random) -> (Scene, String) {
    let mut edited = scene.clone();
    let lights = scene.lights.len();
    let material = random.below(scene.materials.len());
    let name = scene.materials[material].name.clone();
    let weights = ["0", "0.003", "0.02", "0.3", "[0.5, 0, 0.2]", "0.8", "1.2"];
    let blurs = scene.materials.iter().any(|m| m.lobes() != [0.0; 2]);
    // What only scenes that blur have is left out of the numbers elsewhere.
    let choice = match (blurs, random.below(if blurs { 25 } else { 20 })) {
        (false, choice @ 17..) => choice + 5,
        (_, choice) => choice,
    };
    let words = match choice {
        0 if lights > 0 => {
            let light = &mut edited.lights[random.below(lights)];
            let by = glam::DVec3::new(random.unit(), random.unit(), random.unit()) - 0.4;
            light.place = match &light.place {
                LightPlace::Direction(along) => LightPlace::Direction(*along + by),
                place => place.anchored_at(place.anchor().expect("it is no direction") + by),
            };
            format!("{} moved by {by}", light.name)
        }
        1 if lights < 4 => {
            let at = random.below(lights + 1);
            edited.lights.insert(at, Light::new(format!("light-{}", random.below(1000))));
            format!("a light at {at}")
        }
        2 if lights > 0 => format!("{} gone", edited.lights.remove(random.below(lights)).name),
        3 => {
            let plain = |i: &usize| !scene.solids[*i].shape.is_composite();
            let plain: Vec<usize> = (0..scene.solids.len()).filter(plain).collect();
            let solid = plain[random.below(plain.len())];
            edited.solids[solid].material = material;
            format!("solid {solid} of {name}")
        }
        4 => {
            let ior = [1.0, 1.2, 1.5, 2.4, 0.8][random.below(5)];
            edited.materials[material].ior = ior;
            format!("ior of {name} {ior}")
        }
        5 | 6 => set_to(&mut edited, &format!("materials.{name}.transmit"), random.pick(&weights)),
        7 | 8 => set_to(&mut edited, &format!("materials.{name}.reflect"), random.pick(&weights)),
        9 => set_to(&mut edited, "trace.depth", random.pick(&["0", "1", "2", "4", "5"])),
        10 => set_to(&mut edited, "trace.cutoff", random.pick(&["0.0039", "0.02", "0.3"])),
        11 | 22.. => repainted(&mut edited, material, choice, random),
        13 => {
            let models = ["phong", "blinn", "cook_torrance", "hall"];
            set_to(&mut edited, &format!("materials.{name}.model"), random.pick(&models))
        }
        14 => {
            let value = random.pick(&["true", "false"]);
            set_to(&mut edited, &format!("materials.{name}.fresnel"), value)
        }
        15 => {
            let value = random.pick(&["0.1", "0.5"]);
            set_to(&mut edited, &format!("materials.{name}.roughness"), value)
        }
        12 => {
            set_to(&mut edited, &format!("materials.{name}.shininess"), random.pick(&["3", "40"]))
        }
        17..=21 => lit_or_blurred(&mut edited, &name, random),
        _ => {
            let used = |m: usize| scene.solids.iter().any(|solid| solid.material == m);
            if used(material) {
                edited.materials.push(Material::new(format!("new-{}", random.below(1000))));
                "a material more".into()
            } else {
                edited.materials.remove(material);
                for solid in edited.solids.iter_mut().filter(|solid| solid.material > material) {
                    solid.material -= 1;
                }
                format!("{name} gone")
            }
        }
    };
    (edited, words)
}

/// Another falloff, number of rays or kind of a light, or another lobe of the material of this name.
fn lit_or_blurred(scene: &mut Scene, name: &str, random: &mut Random) -> String {
    let lights = scene.lights.len();
    if lights == 0 || random.below(5) < 2 {
        let key = random.pick(&["gloss", "translucency"]);
        let value = random.pick(&["0", "6", "90"]);
        return set_to(scene, &format!("materials.{name}.{key}"), value);
    }
    let light = &mut scene.lights[random.below(lights)];
    let name = light.name.clone();
    match random.below(3) {
        0 => set_to(scene, &format!("lights.{name}.falloff"), random.pick(&["0", "2.5", "6"])),
        1 => set_to(scene, &format!("lights.{name}.samples"), random.pick(&["1", "2", "5"])),
        _ => {
            light.place = match &light.place {
                LightPlace::Spot { at, towards, angle_degrees: _, edge } => {
                    let angle_degrees = 5.0 + 40.0 * random.unit();
                    LightPlace::Spot { at: *at, towards: *towards, angle_degrees, edge: *edge }
                }
                place => place.turned_into(random.pick(&LightPlace::KINDS)),
            };
            format!("{name} is a {:?}", light.place)
        }
    }
}

/// Another kind of paint, bump or background.
fn repainted(scene: &mut Scene, material: usize, choice: usize, random: &mut Random) -> String {
    let Scene { materials, background, .. } = scene;
    let Material { name, paint, bump, .. } = &mut materials[material];
    match choice {
        11 => {
            let size = 0.4 + random.unit();
            *paint = match &*paint {
                Paint::Solid(color) => Paint::Checker { a: *color, b: *color * 0.5, size },
                other => other.turned_into("color"),
            };
            format!("another texture of {name}")
        }
        22 => {
            let kind = random.pick(&["color", "checker", "gradient", "marble", "wood"]);
            *paint = paint.turned_into(kind);
            format!("{name} of {kind}")
        }
        23 => {
            let kind = random.pick(&["none", "noise", "waves"]);
            *bump = Bump::named(kind);
            format!("bump of {name}: {kind}")
        }
        _ => {
            let kind = random.pick(&["color", "gradient"]);
            *background = Background::named(kind);
            format!("background: {kind}")
        }
    }
}

fn set_to(scene: &mut Scene, path: &str, value: &str) -> String {
    set(scene, path, value);
    format!("{path} = {value}")
}

/// Makes an edit, sometimes cancelled first, and holds picture, class and pixels.
fn step(session: &mut Session, scene: &Scene, random: &mut Random, what: &str) -> Class {
    if random.below(4) == 0 {
        interrupt(session, scene, what);
    }
    let beforehand = session.class_of(scene);
    let planned = plan(session, scene);
    let (before, map) = (session.forest().tiles.clone(), session.sample_map());
    let whole = before.iter().all(Option::is_some);
    let old = session.shared_scene();
    let report = match session.edit(scene.clone(), &Progress::default()) {
        Ok(report) => report,
        Err(error) => {
            // What does not fit after a history does not fit afresh.
            let afresh = Session::open(scene.clone(), session.options(), &Progress::default());
            assert_eq!(afresh.err(), Some(error), "{what}");
            assert!(*session.scene() == *old, "{what}: the scene of an edit that failed");
            return Class::None;
        }
    };
    let fresh = open(scene, 2);
    assert_same_picture(session, &fresh, what);
    assert!(session.sample_map() == fresh.sample_map(), "{what}: numbers of samples");
    session.transport().validate();
    assert_eq!(report.class.max(Class::Refold), beforehand.max(Class::Refold), "{what}: class");
    match &planned {
        Some(plan) => {
            assert_eq!(report.pixels, plan.pixels(), "{what}: pixels");
            let eyes = !whole || plan.unsettled.is_some();
            assert!(eyes || report.rays.camera == 0, "{what}: {:?}", report.rays);
            // First samples of released trees that do not fit either are cast once to decide, and again.
            let times = if plan.unsettled.is_some() && !whole { 2 } else { 1 };
            assert!(report.rays.total() <= times * fresh.trace_report().rays.total(), "{what}");
            untouched(&before, session, plan, what);
            counted_alike(map, session, plan, what);
        }
        None if report.class == Class::Retrace => {}
        None => assert_eq!((report.pixels, report.rays.total()), (0, 0), "{what}"),
    }
    report.class
}

/// Begins an edit and cancels it: scene, picture and trees stay.
fn interrupt(session: &mut Session, scene: &Scene, what: &str) {
    let (old, frame) = (session.shared_scene(), session.frame().clone());
    let trees = session.forest().clone();
    let progress = Progress::default();
    let outcome = std::thread::scope(|scope| {
        scope.spawn(|| {
            std::thread::sleep(std::time::Duration::from_micros(700));
            progress.cancel();
        });
        session.edit(scene.clone(), &progress)
    });
    if let Err(error) = outcome {
        assert_eq!(error, TraceError::Cancelled, "{what}");
        assert!(*session.scene() == *old && *session.frame() == frame, "{what}: cancelled");
        assert!(*session.forest() == trees, "{what}: trees of a cancelled edit");
    } else {
        session.edit(old, &Progress::default()).unwrap();
    }
}

/// Random histories of a scene, all of whose states are compared with fresh traces. No edit asks for
/// a whole trace.
fn wander(name: &str, first: &Scene, memory: Option<f64>) {
    let counts = walk(name, first, memory);
    assert!(counts[..3].iter().all(|&n| n > 0) && counts[3] == 0, "{name}: {counts:?}");
}

/// The same where sampling is adaptive: what other scenes read again may cast rays here.
fn wander_adaptive(name: &str, first: &Scene, memory: Option<f64>) {
    let [reshade, _, regrow, retrace] = walk(name, first, memory);
    let colors = first.trace.refine == Refine::Contrast;
    assert!((colors || reshade > 0) && regrow > 10 && retrace == 0, "{name}");
}

/// How many edits were a re-shade, refold, regrow, retrace.
fn walk(name: &str, first: &Scene, memory: Option<f64>) -> [usize; 4] {
    let mut classes = Vec::new();
    for seed in 0..histories() {
        let mut random = Random(seed << 10 | name.len() as u64);
        let mut session = open(first, 2);
        if let Some(share) = memory {
            let bytes = session.kept_bytes() as f64 * share;
            let options = Options { memory: bytes as u64, ..options(2) };
            session = Session::open(first.clone(), options, &Progress::default()).unwrap();
            assert!(session.forest().released() > 0, "{name}: some trees do not fit");
        }
        let mut told = format!("{name}, seed {seed}");
        let mut past = vec![first.clone()];
        for _ in 0..EDITS {
            let (scene, words) = match random.below(5) {
                0 => (past[random.below(past.len())].clone(), "back to an earlier state".into()),
                _ => edited(session.scene(), &mut random),
            };
            told += &format!("\n  {words}");
            classes.push(step(&mut session, &scene, &mut random, &told));
            past.push(scene);
            if random.below(8) == 0 {
                told += "\n  saved, kept and opened again";
                session = reopened(&session, random.below(2) == 0);
                assert_same_picture(&session, &open(session.scene(), 2), &told);
            }
        }
    }
    let count = |class| classes.iter().filter(|c| **c == class).count();
    let counts = [Class::Reshade, Class::Refold, Class::Regrow, Class::Retrace].map(count);
    eprintln!("{name}: reshade, refold, regrow, retrace: {counts:?} times");
    counts
}

/// The session of a scene that was saved, with what was kept of it.
fn reopened(session: &Session, trees: bool) -> Session {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("kept");
    cache::write(session, &path, trees, &Progress::default()).unwrap();
    let saved = write::text(session.scene());
    let scene = read::text(&saved, Path::new("scenes/saved.toml")).unwrap();
    let (opened, report) =
        Session::open_cached(Arc::new(scene), &path, session.options(), &Progress::default())
            .unwrap();
    assert_eq!((report.edit.class, report.edit.rays.total()), (Class::None, 0));
    opened
}

/// With enough samples that their number differs from pixel to pixel.
fn adaptive(name: &str, samples: &str, refine: &str) -> Scene {
    let mut scene = small(name);
    set(&mut scene, "trace.samples", samples);
    set(&mut scene, "trace.adaptive", "0.15");
    set(&mut scene, "trace.refine", refine);
    let session = open(&scene, 2);
    let counts: Vec<u16> = session.sample_map().unwrap().to_list();
    let of = |samples: usize| counts.iter().filter(|&&count| usize::from(count) == samples).count();
    assert!(of(4) > 20 && of(8) > 20 && of(samples.parse().unwrap()) > 20, "{name}");
    scene
}

/// A shipped scene of few pixels and levels.
pub(super) fn small(name: &str) -> Scene {
    let mut scene = shipped(name, [56, 36], 2);
    scene.trace.depth = 4;
    scene
}

#[test]
fn whitted() {
    wander("whitted", &small("whitted"), None);
}

#[test]
fn glass() {
    wander("glass", &small("glass"), None);
}

#[test]
fn gems() {
    wander("gems", &small("gems"), None);
}

#[test]
fn flake() {
    wander("flake", &small("flake"), None);
}

#[test]
fn mesh() {
    wander("mesh", &small("mesh"), None);
}

#[test]
fn plain() {
    wander("plain", &small("plain"), None);
}

#[test]
fn mirrors() {
    wander("mirrors", &small("mirrors"), None);
}

#[test]
fn csg_part() {
    wander("csg_part", &small("csg_part"), None);
}

/// A tumbler cut from glass, water in it that shares its wall and reaches into it, ice that swims and
/// a bead of air, on a table whose top is the tumbler's bottom.
pub(super) const DRINK: &str = r#"
version = 1
[picture]
size = [56, 36]
[camera]
eye = [0.3, -6, 2.4]
target = [0, 0, 0.9]
fov_degrees = 26
[background]
gradient = { below = [0.2, 0.2, 0.2], level = [0.9, 0.9, 1], above = [0.3, 0.5, 0.9] }
[trace]
samples = 2
depth = 6
[lights]
key = { point = [-4, -5, 7], intensity = 0.8 }
[materials]
table = { texture = { checker = { a = [0.8, 0.7, 0.5], b = [0.3, 0.2, 0.2], size = 0.4 } }, reflect = 0.1 }
glass = { color = 0.1, reflect = 0.1, transmit = 0.9, ior = 1.5, priority = 2, filter = [0.9, 1, 0.95] }
water = { color = 0.1, reflect = 0.05, transmit = 0.95, ior = 1.33, filter = [0.9, 0.95, 1], fresnel = true }
ice = { color = 0.3, reflect = 0.05, transmit = 0.9, ior = 1.31, priority = 1 }
air = { color = 0.1, transmit = 1, ior = 1, priority = 3 }
[solids]
table = { plane = { normal = [0, 0, 1], offset = 0 }, material = "table" }
outside = { cylinder = { from = [0, 0, 0], to = [0, 0, 2], radius = 1 }, material = "glass" }
inside = { cylinder = { from = [0, 0, 0.2], to = [0, 0, 2], radius = 0.9 }, material = "glass" }
tumbler = { difference = ["outside", "inside"] }
water = { cylinder = { from = [0, 0, 0.2], to = [0, 0, 1.4], radius = 0.95 }, material = "water" }
cube = { box = { min = [-0.3, -0.3, -0.3], max = [0.3, 0.3, 0.3] }, material = "ice", translate = [0.1, -0.2, 1.35], rotate_degrees = [20, 30, 10] }
bead = { sphere = { center = [-0.4, 0, 0.3], radius = 0.2 }, material = "air" }
block = { box = { min = [1.3, -0.5, 0], max = [1.9, 0.5, 0.6] }, material = "water" }
upon = { box = { min = [1.4, -0.4, 0.6], max = [1.8, 0.4, 1.1] }, material = "glass" }
"#;

#[test]
fn drink() {
    let scene = read::text(DRINK, Path::new("drink.toml")).unwrap_or_else(|e| panic!("{e}"));
    let counts = walk("drink", &scene, None);
    assert!(counts[3] > 0, "other materials have other priorities: {counts:?}");
}

/// With an open lens, moving solids and a filter whose weights have signs.
#[test]
fn motion() {
    let mut scene = small("motion");
    set(&mut scene, "trace.samples", "6");
    wander("motion", &scene, None);
}

#[test]
fn studio() {
    wander("studio", &small("studio"), None);
}

#[test]
fn lamps() {
    let scene = read::text(LAMPS, Path::new("lamps.toml")).unwrap();
    wander("lamps", &scene, None);
}

#[test]
fn gallery() {
    wander("gallery", &small("gallery"), None);
}

#[test]
fn whitted_adaptive() {
    wander_adaptive("whitted, adaptive", &adaptive("whitted", "16", "trees"), None);
}

#[test]
fn glass_adaptive() {
    wander_adaptive("glass, adaptive", &adaptive("glass", "11", "trees"), None);
}

#[test]
fn mesh_adaptive() {
    wander_adaptive("mesh, adaptive", &adaptive("mesh", "16", "trees"), None);
}

/// With an open lens, moving solids and a filter whose weights have signs.
#[test]
fn motion_adaptive() {
    wander_adaptive("motion, adaptive", &adaptive("motion", "24", "trees"), None);
}

#[test]
fn gallery_adaptive() {
    wander_adaptive("gallery, adaptive", &adaptive("gallery", "9", "trees"), None);
}

#[test]
fn plain_by_contrast() {
    wander_adaptive("plain, by contrast", &adaptive("plain", "16", "contrast"), None);
}

#[test]
fn lamps_adaptive() {
    let mut scene = read::text(LAMPS, Path::new("lamps.toml")).unwrap();
    set(&mut scene, "trace.samples", "12");
    set(&mut scene, "trace.adaptive", "0.3");
    wander_adaptive("lamps, adaptive", &scene, None);
}

#[test]
fn adaptive_with_released_trees() {
    let mut scene = adaptive("whitted", "16", "trees");
    set(&mut scene, "picture.size", "[130, 70]");
    wander_adaptive("released, adaptive", &scene, Some(0.7));
}

#[test]
fn chain() {
    wander("chain", &small("chain"), None);
}

#[test]
fn gears() {
    wander("gears", &small("gears"), None);
}

#[test]
fn solids_of_all_kinds() {
    wander("solids", &solids(), None);
}

#[test]
fn with_released_trees() {
    let mut scene = small("whitted");
    set(&mut scene, "picture.size", "[130, 70]");
    wander("released", &scene, Some(0.7));
}
