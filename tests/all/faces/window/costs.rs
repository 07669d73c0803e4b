//! What the badges say, and what edits then cost.

use std::sync::Arc;

use rayforest::progress::Progress;
use rayforest::scene::{Scene, path};
use rayforest::session::cost::{Cost, Pixels, cost};
use rayforest::session::{Class, Session};

use super::*;

/// Materials, lights and solids of many kinds.
const KINDS: &str = r#"version = 1
[picture]
size = [32, 18]
[trace]
samples = 1
depth = 3
[lights]
key = { point = [-4, -5, 7], intensity = 0.8 }
fill = { direction = [-0.5, 0.4, -1], intensity = [0.2, 0.25, 0.3] }
[materials.tiles]
texture = { checker = { a = [0.9, 0.8, 0.2], b = 0.2, size = 0.7 } }
[materials.mirror]
color = [0.9, 0.9, 0.95]
diffuse = 0.3
specular = 0.6
reflect = 0.5
[materials.glass]
transmit = 0.9
filter = [0.9, 1, 0.9]
ior = 1.5
reflect = 0.003
[solids]
floor = { plane = { normal = [0, 0, 1], offset = -1 }, material = "tiles" }
ball = { sphere = { center = [-1, 0, 0], radius = 1 }, material = "mirror" }
pane = { polygon = { points = [[0.2, -1, -1], [2, -1, -1], [2, -1, 1]] }, material = "glass" }
block = { box = { min = [1, 0, -1], max = [2, 1, 0] }, material = "glass" }
"#;

/// The badge of a cost in the window's own words, with the value that it names.
fn words(cost: Cost) -> (String, Option<f64>) {
    let percent = |pixels: Pixels| {
        let percent = (pixels.count as f64 * 100.0 / pixels.of as f64).round();
        assert!(
            pixels.count == 0 || percent >= 1.0 && (percent < 100.0 || pixels.count == pixels.of)
        );
        format!("{percent} %")
    };
    match cost {
        Cost::Instant => ("instant".into(), None),
        Cost::InstantUpTo(x, _) => ("instant ≤ ".into(), Some(x)),
        Cost::InstantDownTo(x, _) | Cost::RereadBelow(x, _) => ("instant ≥ ".into(), Some(x)),
        Cost::InstantWithin(..) => panic!("sampling is not adaptive: {cost:?}"),
        Cost::InstantAboveZero(_) => ("instant > 0".into(), None),
        Cost::Refold => ("refold".into(), None),
        Cost::Reread(pixels) => (format!("rereads {}", percent(pixels)), None),
        Cost::Regrow(pixels) => (format!("traces {}", percent(pixels)), None),
        Cost::TraceAll => ("traces all".into(), None),
    }
}

/// What is wrong with a badge's text for the parameter at `path`.
fn fault(session: &mut Session, path: &str, text: &str) -> Option<String> {
    let scene = session.scene().clone();
    let (word, limit) = words(cost(session, path).expect("a cost"));
    let is_whole = path == "trace.depth";
    let class = |session: &mut Session, value: f64| {
        let mut edited = scene.clone();
        let value = if is_whole { format!("{value:.0}") } else { format!("{value:?}") };
        path::set(&mut edited, path, &value).ok()?;
        Some(session.class_of(&edited))
    };
    let Some(limit) = limit else {
        let altered = path::altered(&scene, path).expect("a parameter");
        let class = session.class_of(&altered);
        let told = match word.as_str() {
            "instant" | "instant > 0" => class <= Class::Reshade,
            "traces all" => class == Class::Retrace,
            traces if traces.starts_with("traces") => class == Class::Regrow,
            _ => class == Class::Refold,
        };
        return (!told || text != word).then(|| format!("{path}: `{text}`, but {class}"));
    };
    let Some(told) = text.strip_prefix(&word).and_then(|rest| rest.parse::<f64>().ok()) else {
        return Some(format!("{path}: `{text}`, but {word}{limit}"));
    };
    // Beyond the limit by more than the badge rounds.
    let beyond = match word.as_str() {
        _ if is_whole => limit + 1.0,
        "instant ≤ " => limit * 1.01 + 1e-6,
        _ => limit * 0.99,
    };
    let (inside, outside) = (class(session, told), class(session, beyond));
    let held = inside.is_some_and(|c| c <= Class::Reshade) && outside >= Some(Class::Refold);
    (!held).then(|| format!("{path}: `{text}`, but {inside:?} there, {outside:?} beyond"))
}

/// The parameters that a line of the outline shows.
fn shown_for(scene: &Scene, prefix: &str) -> Vec<String> {
    let all = path::parameters(scene).into_iter().map(|p| p.path);
    all.filter(|path| match prefix {
        "" => !["lights.", "materials.", "solids."].iter().any(|list| path.starts_with(list)),
        prefix => path.starts_with(prefix),
    })
    .collect()
}

impl Window {
    /// The badges that show, as (key, text), once all are known.
    fn badges(&mut self, count: usize) -> Vec<(String, String)> {
        let start = Instant::now();
        loop {
            let texts = self.texts();
            let badges: Vec<_> = texts
                .iter()
                .filter_map(|text| text.strip_prefix("cost of ")?.split_once(": "))
                .map(|(key, text)| (key.to_owned(), text.to_owned()))
                .collect();
            if badges.len() == count && badges.iter().all(|(_, text)| text != "…") {
                return badges;
            }
            assert!(start.elapsed() < PATIENCE, "{count} badges expected: {badges:?}");
            self.harness.step();
            std::thread::sleep(Duration::from_millis(3));
        }
    }
}

#[test]
fn every_control_says_before_it_is_touched_what_an_edit_costs() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("scene.toml");
    std::fs::write(&file, KINDS).unwrap();
    let mut window = Window::of_size(vec2(1280.0, 1600.0), folder, Some(file.clone()), Vec::new());
    window.until("the scene is open", |app| app.document().path() == Some(&file));
    window.until_exact();
    let scene = window.app().document().scene().clone();
    let options = Options { threads: 2, memory: 1 << 30 };
    let mut session =
        Session::open(Arc::new(scene.clone()), options, &Progress::default()).unwrap();

    let of = |list: &str, name: &str| (name.to_owned(), format!("{list}.{name}."));
    let mut lines = vec![("Scene".to_owned(), String::new())];
    lines.extend(scene.lights.iter().map(|l| of("lights", &l.name)));
    lines.extend(scene.materials.iter().map(|m| of("materials", &m.name)));
    lines.extend(scene.solids.iter().map(|s| of("solids", &s.name)));
    let (mut faults, mut kinds) = (Vec::new(), std::collections::BTreeSet::new());
    for (name, prefix) in lines {
        window.click(&name);
        if name == "pane" {
            window.click("points (3)");
        }
        let mut paths = shown_for(&scene, &prefix);
        assert!(!paths.is_empty(), "{prefix}");
        for (key, text) in window.badges(paths.len()) {
            // Two keys of one name, such as `color`, are told apart by which of them agrees.
            let same = |path: &String| path.rsplit('.').next() == Some(key.as_str());
            let mut tried = Vec::new();
            let found = paths.iter().position(|path| {
                same(path) && fault(&mut session, path, &text).map(|f| tried.push(f)).is_none()
            });
            match found {
                Some(i) => drop(paths.remove(i)),
                None => faults.push((name.clone(), key, text.clone(), tried)),
            }
            kinds.insert(text.split(' ').next().map(str::to_owned));
        }
    }
    assert!(faults.is_empty(), "{faults:#?}");
    assert!(kinds.len() >= 3, "the scene has instant, refold and traces: {kinds:?}");
    let wrong = fault(&mut session, "camera.eye", "instant");
    assert!(wrong.is_some(), "a wrong badge is found");
    assert!(fault(&mut session, "materials.glass.reflect", "instant ≤ 5").is_some());
}
