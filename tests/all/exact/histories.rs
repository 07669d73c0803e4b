//! Random histories of edits: every state is the picture of a fresh trace, the last one also the
//! file of a fresh process.

use std::path::Path;
use std::process::Command;

use rayforest::color::Rgb;
use rayforest::film::develop::Development;
use rayforest::film::plates::Plates;
use rayforest::film::write::{Format, picture};
use rayforest::progress::Progress;
use rayforest::scene::change::Change;
use rayforest::scene::path::{self, Parameter, parameters};
use rayforest::scene::range::Kind;
use rayforest::scene::{Scene, write};
use rayforest::session::{Class, Session};

use super::comes_alive::comes_alive;
use super::random::Random;
use super::{assert_same_picture, open, shipped};

const EDITS: usize = 12;
/// Most nodes that a tree might have, so that no history takes hours.
const LARGEST_TREE: f64 = 20_000.0;

/// Histories per scene.
fn histories() -> u64 {
    if std::env::var_os("RAYFOREST_LONG").is_some() { 200 } else { 10 }
}

/// Values of coefficients: zero, around the default cut-off of 1/255, and around one.
const VALUES: [&str; 12] =
    ["0", "1e-7", "0.0039", "0.00393", "0.02", "0.1", "0.3", "0.7", "0.99", "1", "1.5", "40"];

fn one_value(random: &mut Random) -> String {
    match random.below(4) {
        0 => format!("{:.3}", random.unit()),
        _ => random.pick(&VALUES).to_owned(),
    }
}

/// Another value for a parameter, or `None` if it is left alone.
fn value(parameter: &Parameter, scene: &Scene, random: &mut Random) -> Option<String> {
    let near =
        |text: &str, by: f64| text.trim().parse::<f64>().ok().map(|x| format!("{:?}", x + by));
    let name = parameter.path.rsplit('.').next().unwrap_or_default();
    Some(match (parameter.kind, name) {
        (Kind::Coefficient, _) if random.below(3) == 0 => {
            let [r, g, b] = [0; 3].map(|_| one_value(random));
            format!("[{r}, {g}, {b}]")
        }
        (Kind::Coefficient, _) => one_value(random),
        (Kind::Number, "shininess") => {
            random.pick(&["0", "1", "3.5", "60", "900", "1e6"]).to_owned()
        }
        (Kind::Number, "metallic") => random.pick(&["0", "0.3", "1"]).to_owned(),
        (Kind::Number, "exposure") => format!("{:.2}", random.unit() * 6.0 - 3.0),
        (Kind::Number, "cutoff") => {
            random.pick(&["0", "0.0005", "0.00392", "0.004", "0.05", "0.4", "1"]).to_owned()
        }
        (Kind::Number, "ior") => random.pick(&["1", "1.33", "1.7", "0.8"]).to_owned(),
        (Kind::Number, "roughness") => random.pick(&["0.02", "0.1", "0.3", "1"]).to_owned(),
        (Kind::Number, _) => near(&parameter.value, random.unit() * 0.2)?,
        (Kind::Whole, "samples") => (1 + random.below(4)).to_string(),
        (Kind::Whole, "depth") => random.below(13).to_string(),
        (Kind::Flag, _) => random.pick(&["true", "false"]).to_owned(),
        (Kind::Vector, _) => {
            let inner = parameter.value.trim_matches(['[', ']']);
            let mut numbers: Vec<String> = inner.split(',').map(str::to_owned).collect();
            let axis = random.below(3);
            numbers[axis] = near(&numbers[axis], random.unit() * 0.3 - 0.15)?;
            format!("[{}]", numbers.join(", "))
        }
        (Kind::Scale, _) => format!("{:.2}", 0.8 + 0.4 * random.unit()),
        (Kind::Choice(names), _) => random.pick(names).to_owned(),
        (Kind::Material, _) => scene.materials[random.below(scene.materials.len())].name.clone(),
        (Kind::Pair, "size") => random.pick(&["[33, 18]", "[20, 21]", "[40, 9]"]).to_owned(),
        _ => return None,
    })
}

/// An upper bound of a tree's nodes, as if the strongest of every material met at every node.
fn largest_tree(scene: &Scene) -> f64 {
    let most = |part: &dyn Fn(usize) -> Rgb| {
        (0..scene.materials.len()).map(|m| part(m).max_channel().min(1.0)).fold(0.0, f32::max)
    };
    let reflect = f64::from(most(&|m| scene.materials[m].reflect));
    let transmit = f64::from(most(&|m| scene.materials[m].transmit * scene.materials[m].filter));
    let (depth, cutoff) = (scene.trace.depth, f64::from(scene.trace.cutoff));
    let mut nodes = 0.0;
    for reflected in 0..=depth {
        let mut ways = 1.0; // over the places of the reflections among all branches
        for transmitted in 0..=depth - reflected {
            let weight = reflect.powi(reflected as i32) * transmit.powi(transmitted as i32);
            if weight == 0.0 || weight < cutoff {
                break;
            }
            nodes += ways;
            ways *= f64::from(reflected + transmitted + 1) / f64::from(transmitted + 1);
        }
    }
    nodes
}

/// Another look put on, or taken off, and which.
fn dressed(scene: &Scene, random: &mut Random) -> Option<(Scene, String)> {
    let names: Vec<_> = scene.looks.list.iter().map(|look| Some(look.name.as_str())).collect();
    let name = names.iter().copied().chain([None]).nth(random.below(names.len() + 1))?;
    let dressed = scene.dressed(name).unwrap();
    let moves = Change::between(scene, &dressed).moves_rays.is_some();
    (!moves && largest_tree(&dressed) < LARGEST_TREE).then(|| (dressed, format!("look {name:?}")))
}

/// A scene with one parameter changed, or in another look, and the change in words.
fn edited(scene: &Scene, random: &mut Random, rays_left: &mut u32) -> (Scene, String) {
    if !scene.looks.list.is_empty()
        && random.below(3) == 0
        && let Some(found) = dressed(scene, random)
    {
        return found;
    }
    let all = parameters(scene);
    loop {
        let parameter = &all[random.below(all.len())];
        let mut edited = scene.clone();
        let Some(value) = value(parameter, scene, random) else { continue };
        if path::set(&mut edited, &parameter.path, &value).is_err() {
            continue;
        }
        let moves = Change::between(scene, &edited).moves_rays.is_some();
        let affordable = largest_tree(&edited) < LARGEST_TREE;
        if (moves && *rays_left == 0) || !affordable {
            continue;
        }
        *rays_left -= u32::from(moves);
        return (edited, format!("{} = {value}", parameter.path));
    }
}

/// Makes one edit and holds picture, class and rays to a fresh trace.
fn step(session: &mut Session, scene: Scene, what: &str) -> Class {
    let change = Change::between(session.scene(), &scene);
    let kept = session.forest().clone();
    let report = session.edit(scene, &Progress::default()).unwrap();
    let fresh = open(session.scene(), 1);
    assert_same_picture(session, &fresh, what);
    session.transport().validate();
    if change.moves_rays.is_some() {
        let expected = if change.everything { Class::Retrace } else { report.class };
        assert_eq!(report.class, expected, "{what}");
        assert!(report.class >= Class::Refold, "{what}: {report:?}");
        return report.class;
    }
    let lacking = comes_alive(&kept, fresh.forest(), session.scene());
    // A lobe or an index that did not matter, and for which the trees were left alone, is brought into
    // them as soon as it may matter, even where no branch turns out to have it.
    let deferred = report.reason.as_deref() == Some("ior or a lobe moves rays");
    assert!(deferred || (report.class == Class::Regrow) == lacking, "{what}: {report:?}");
    assert_eq!(report.rays.total() == 0, !lacking, "{what}: {report:?}");
    assert!(lacking || deferred || *session.forest() == kept, "{what}: trees were touched");
    report.class
}

/// Holds the files that the session's picture makes to those of a fresh process.
fn same_files_in_a_fresh_process(session: &Session, what: &str) {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let text = write::text(session.scene());
    std::fs::write(at("scene.toml"), &text).unwrap();
    for ending in ["png", "exr"] {
        let (ours, theirs) = (at(&format!("ours.{ending}")), at(&format!("theirs.{ending}")));
        let format = Format::of(&ours, false).unwrap();
        let development = Development::of(&session.scene().picture);
        picture(&ours, format, &Plates::of(session.film()), development, &text).unwrap();
        let run = Command::new(env!("CARGO_BIN_EXE_rayforest"))
            .args([
                "render".as_ref(),
                at("scene.toml").as_os_str(),
                "-o".as_ref(),
                theirs.as_os_str(),
            ])
            .args(["--threads", "2"])
            .output()
            .unwrap();
        assert!(run.status.success(), "{what}: {}", String::from_utf8_lossy(&run.stderr));
        assert!(same_file(&ours, &theirs), "{what}: the {ending} of a fresh process differs");
    }
}

fn same_file(a: &Path, b: &Path) -> bool {
    std::fs::read(a).unwrap() == std::fs::read(b).unwrap()
}

/// Random histories of a shipped scene.
fn wander(name: &str, size: [u32; 2], samples: u32) {
    wander_from(name, shipped(name, size, samples));
}

/// Random histories of a scene.
fn wander_from(name: &str, first: Scene) {
    assert!(largest_tree(&first) < LARGEST_TREE, "{name} could not be edited at all");
    let mut classes = Vec::new();
    for seed in 0..histories() {
        let mut random = Random(seed << 8 | name.len() as u64);
        let mut session = open(&first, 1 + seed as usize % 2);
        let mut rays_left = 2;
        let mut told = format!("scene {name}, seed {seed}");
        for _ in 0..EDITS {
            let (scene, words) = edited(session.scene(), &mut random, &mut rays_left);
            told += &format!("\n  {words}");
            classes.push(step(&mut session, scene, &told));
        }
        same_files_in_a_fresh_process(&session, &told);
    }
    let count = |class| classes.iter().filter(|c| **c == class).count();
    let counts =
        [Class::None, Class::Reshade, Class::Refold, Class::Regrow, Class::Retrace].map(count);
    eprintln!("{name}: none, reshade, refold, regrow, retrace: {counts:?} times");
    assert!(
        counts[1] > counts[4] && counts[2] > 0 && counts[3] > 0 && counts[4] > 0,
        "{name}: {counts:?}"
    );
}

#[test]
fn whitted() {
    wander("whitted", [64, 36], 4);
}

/// Every illumination model, with and without Fresnel.
#[test]
fn models() {
    let mut scene = shipped("whitted", [64, 36], 4);
    for (path, value) in [
        ("materials.tiles.model", "blinn"),
        ("materials.tiles.specular", "0.4"),
        ("materials.glass.model", "hall"),
        ("materials.mirror.model", "cook_torrance"),
        ("materials.mirror.reflect", "0.9"),
        ("materials.mirror.fresnel", "true"),
    ] {
        path::set(&mut scene, path, value).unwrap();
    }
    wander_from("models", scene);
}

/// Looks are put on and taken off, and what is edited meanwhile belongs to the one that is worn.
#[test]
fn looks() {
    let looks = "
[looks.night]
lights.key.intensity = 0.1
materials.mirror.reflect = [0.9, 0.6, 0.3]
materials.tiles.shininess = 3

[looks.opaque]
materials.glass.transmit = 0
trace.depth = 3
";
    let text = write::text(&shipped("whitted", [64, 36], 4)) + looks;
    let scene = rayforest::scene::read::text(&text, Path::new("looks.toml")).unwrap();
    wander_from("looks", scene);
}

#[test]
fn plain() {
    wander("plain", [64, 36], 4);
}

#[test]
fn glass() {
    wander("glass", [64, 36], 2);
}

#[test]
fn gems() {
    wander("gems", [64, 36], 1);
}

#[test]
fn flake() {
    wander("flake", [64, 36], 2);
}

#[test]
fn mesh() {
    wander("mesh", [64, 36], 2);
}

#[test]
fn mirrors() {
    wander("mirrors", [64, 36], 2);
}

#[test]
fn the_largest_tree_counts_every_way_of_branching() {
    let mut scene = shipped("plain", [4, 4], 1);
    assert_eq!(largest_tree(&scene), 1.0);
    scene.trace.depth = 3;
    scene.materials[0].reflect = Rgb::WHITE;
    assert_eq!(largest_tree(&scene), 4.0);
    scene.materials[0].transmit = Rgb::WHITE;
    assert_eq!(largest_tree(&scene), 15.0);
    scene.trace.cutoff = 0.3;
    scene.materials[0].transmit = Rgb::grey(0.5);
    assert_eq!(largest_tree(&scene), 4.0 + 6.0);
}

#[test]
fn files_that_differ_are_told_apart() {
    let folder = tempfile::tempdir().unwrap();
    let (a, b) = (folder.path().join("a"), folder.path().join("b"));
    std::fs::write(&a, [1, 2, 3]).unwrap();
    std::fs::write(&b, [1, 2, 4]).unwrap();
    assert!(same_file(&a, &a) && !same_file(&a, &b));
}
