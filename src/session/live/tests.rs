//! The live session, held to the session: same bytes, fewer rays, nothing that hangs.

mod card;
mod inspected;
mod keep;
mod view;

use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};

use super::*;
use crate::forest::grow::RayCounts;
use crate::progress::Progress;
use crate::scene::{path, read, write};
use crate::session::{Class, Session};

const OPTIONS: Options = Options { threads: 2, memory: 1 << 32 };
/// Longer than anything takes, on the busiest machine.
const PATIENCE: Duration = Duration::from_secs(120);

/// A live session and what woke its window.
struct Window {
    live: Live,
    woken: Receiver<()>,
    newest: Option<Shown>,
    /// Read before the newest picture was taken, so that what it says was shown is there.
    status: Status,
    /// Stages of all pictures taken.
    stages: Vec<Stage>,
    events: Vec<Event>,
}

impl Window {
    fn new(options: Options) -> Window {
        let (wake, woken) = channel();
        let live = Live::new(options, move || {
            let _ = wake.send(());
        });
        let status = live.status();
        Window { live, woken, newest: None, status, stages: Vec::new(), events: Vec::new() }
    }

    /// A window that shows the whole picture of a scene.
    fn showing(scene: &Scene) -> Window {
        let mut window = Window::new(OPTIONS);
        window.live.want(Arc::new(scene.clone()));
        window.wait("the first picture", |w| w.status.in_step);
        window
    }

    /// Takes pictures and events whenever woken, until something holds.
    fn wait(&mut self, what: &str, holds: impl Fn(&Window) -> bool) {
        let begun = Instant::now();
        loop {
            self.status = self.live.status();
            if let Some(shown) = self.live.take_shown() {
                self.stages.push(shown.stage);
                self.newest = Some(shown);
            }
            self.events.extend(self.live.take_events());
            if holds(self) {
                return;
            }
            let left = PATIENCE.saturating_sub(begun.elapsed());
            let state = || format!("{what}: {:?}, {:?}", self.live.status(), self.events);
            self.woken.recv_timeout(left).unwrap_or_else(|_| panic!("{}", state()));
        }
    }

    fn want(&self, scene: &Scene) {
        self.live.want(Arc::new(scene.clone()));
    }

    fn shown(&self) -> &Shown {
        self.newest.as_ref().unwrap()
    }

    /// The picture shown, of the processor's.
    fn frame(&self) -> Arc<Frame> {
        self.shown().frame.clone().expect("the processor has drawn it")
    }

    /// Holds the picture shown to a fresh session of the scene.
    fn shows_whole(&self, scene: &Scene) {
        let shown = self.shown();
        assert_eq!((shown.stage, &*shown.scene), (Stage::Whole, scene));
        assert!(
            shown.frame.as_deref() == Some(fresh(scene).frame()),
            "other bytes than a fresh session's"
        );
    }

    fn last(&self) -> EditReport {
        self.live.status().last.unwrap()
    }
}

fn fresh(scene: &Scene) -> Session {
    Session::open(scene.clone(), OPTIONS, &Progress::default()).unwrap()
}

fn scene(name: &str, size: [u32; 2], samples: u32) -> Scene {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("scenes/{name}.toml"));
    let mut scene = read::file(&file).unwrap();
    (scene.picture.size, scene.trace.samples) = (size, samples);
    scene
}

fn with(scene: &Scene, path: &str, value: &str) -> Scene {
    let mut scene = scene.clone();
    path::set(&mut scene, path, value).unwrap();
    scene
}

/// Traced in some tenths of a second: long enough to be met while it is traced.
fn slow() -> Scene {
    scene("glass", [240, 135], 32)
}

fn is_tracing(window: &Window) -> bool {
    window.status.job.is_some()
}

#[test]
fn the_first_picture_is_coarse_then_of_one_sample_then_whole() {
    let scene = scene("whitted", [320, 180], 16);
    let mut window = Window::new(OPTIONS);
    assert_eq!(window.live.take_shown().map(|s| s.stage), None);
    window.want(&scene);
    window.wait("coarse", |w| w.newest.is_some());
    window.wait("whole", |w| w.status.in_step);
    // A stage that nobody took before the next one is not shown.
    assert!(window.stages.is_sorted(), "{:?}", window.stages);
    assert_eq!(window.stages.last(), Some(&Stage::Whole));
    window.shows_whole(&scene);
    let report = window.last();
    assert_eq!((report.class, report.rays), (Class::Retrace, fresh(&scene).trace_report().rays));
    assert_eq!(report.reason.as_deref(), Some("the scene is new"));
    assert!(window.status.bytes > 0 && window.status.budget == OPTIONS.memory);
}

#[test]
fn an_edit_without_rays_is_shown_at_once_and_exactly() {
    let scene = scene("whitted", [64, 40], 4);
    let mut window = Window::showing(&scene);
    for (path, value, class) in [
        ("materials.tiles.diffuse", "0.3", Class::Reshade),
        ("materials.tiles.shininess", "7", Class::Refold),
        ("picture.exposure", "0.5", Class::Reshade),
    ] {
        let edited = with(&window.shown().scene.clone(), path, value);
        window.want(&edited);
        window.wait(path, |w| *w.shown().scene == edited && w.status.in_step);
        window.shows_whole(&edited);
        let report = window.last();
        assert_eq!((report.class, report.rays), (class, RayCounts::default()), "{path}");
        assert_eq!(window.status.job, None, "{path}");
    }
}

#[test]
#[should_panic(expected = "other bytes")]
fn a_picture_that_is_not_the_scenes_is_found() {
    let scene = scene("plain", [32, 20], 1);
    let mut window = Window::showing(&scene);
    let shown = window.newest.as_mut().unwrap();
    shown.frame = Some(Arc::new(Frame::new(scene.picture.size)));
    window.shows_whole(&scene);
}

#[test]
fn a_camera_move_is_traced_and_its_geometry_is_not_compiled_again() {
    let scene = scene("whitted", [320, 180], 4);
    let mut window = Window::showing(&scene);
    let geometry = window.live.board.eye().unwrap().geometry;
    let moved = with(&scene, "camera.eye", "[1, -6, 2]");
    window.want(&moved);
    window.wait("moved", |w| w.status.in_step && *w.shown().scene == moved);
    window.shows_whole(&moved);
    assert_eq!(window.last().reason.as_deref(), Some("camera.eye moves rays"));
    assert!(Arc::ptr_eq(&geometry, &window.live.board.eye().unwrap().geometry));
    let larger = with(&moved, "solids.mirror-ball.sphere.radius", "0.4");
    window.want(&larger);
    window.wait("larger", |w| w.status.in_step && *w.shown().scene == larger);
    window.shows_whole(&larger);
    assert!(!Arc::ptr_eq(&geometry, &window.live.board.eye().unwrap().geometry));
}

#[test]
fn a_storm_of_edits_while_tracing_ends_as_a_fresh_session() {
    let scene = slow();
    let mut window = Window::new(OPTIONS);
    window.want(&scene);
    window.wait("a preview", |w| w.newest.is_some());
    let edited = |i: u32| {
        let diffuse = with(&scene, "materials.tiles.diffuse", &format!("0.{i:03}"));
        with(&diffuse, "materials.ruby.shininess", &format!("{i}"))
    };
    for i in 1..=60 {
        window.want(&edited(i));
        window.wait("an edit", |w| w.shown().scene.materials == edited(i).materials);
    }
    assert!(window.shown().stage < Stage::Whole, "edits were shown while the trace waited");
    assert!(window.last().rays.total() == 0);
    window.wait("whole", |w| w.status.in_step);
    window.shows_whole(&edited(60));
    assert_eq!(window.last().rays, fresh(&scene).trace_report().rays, "one trace alone");
}

#[test]
fn the_newest_wish_wins() {
    let scene = scene("whitted", [320, 180], 16);
    let mut window = Window::showing(&scene);
    let at = |i: u32| with(&scene, "camera.eye", &format!("[0.{i:03}, -6, 2]"));
    for i in 0..200 {
        window.want(&at(i));
        std::thread::yield_now();
    }
    window.wait("the last", |w| w.status.in_step && *w.shown().scene == at(199));
    window.shows_whole(&at(199));
    assert!(window.stages.len() < 100, "{} pictures", window.stages.len());
}

#[test]
fn undo_during_a_trace_brings_the_same_bytes_back_without_rays() {
    let scene = slow();
    let mut window = Window::showing(&scene);
    let before = window.frame();
    window.want(&with(&scene, "camera.fov_degrees", "30"));
    window.wait("a preview", |w| w.shown().stage < Stage::Whole);
    window.want(&scene);
    window.wait("undone", |w| w.status.in_step);
    assert_eq!(window.shown().stage, Stage::Whole);
    assert!(*window.frame() == *before && *window.shown().scene == scene);
    let report = window.last();
    assert_eq!((report.class, report.rays.total()), (Class::None, 0));
    window.wait("no job", |w| !is_tracing(w));
}

#[test]
fn a_cancel_brings_the_whole_picture_back_and_the_wish_is_held() {
    let scene = slow();
    let mut window = Window::showing(&scene);
    let before = window.frame();
    let moved = with(&scene, "camera.fov_degrees", "30");
    window.want(&moved);
    window.wait("a preview", |w| w.shown().stage < Stage::Whole);
    let asked = Instant::now();
    window.live.cancel();
    window.wait("held", |w| w.status.held && w.shown().stage == Stage::Whole);
    // Promised are 100 ms; a busy machine is given a second.
    assert!(asked.elapsed() < Duration::from_secs(1), "{:?}", asked.elapsed());
    assert!(*window.frame() == *before && *window.shown().scene == scene);
    window.wait("no job", |w| !is_tracing(w));
    assert!(!window.status.in_step);
    // An edit of a colour does not trace what was cancelled; a wish that can be shown is shown.
    let moved = with(&moved, "materials.tiles.diffuse", "0.2");
    window.want(&moved);
    let edited = with(&scene, "materials.tiles.diffuse", "0.2");
    window.want(&edited);
    window.wait("shown", |w| w.status.in_step);
    assert_eq!((window.status.held, is_tracing(&window)), (false, false));
    window.shows_whole(&edited);
    window.want(&moved);
    window.wait("a preview again", |w| w.shown().stage < Stage::Whole);
    window.live.cancel();
    window.wait("held again", |w| w.status.held);
    window.live.resume();
    window.wait("resumed", |w| w.status.in_step);
    window.shows_whole(&moved);
    assert!(!window.status.held);
}

#[test]
fn a_cancelled_first_trace_leaves_a_preview_that_is_live() {
    let scene = slow();
    let mut window = Window::new(OPTIONS);
    window.want(&scene);
    window.wait("a preview", |w| w.newest.is_some());
    window.live.cancel();
    window.wait("held", |w| w.status.held && !is_tracing(w));
    let edited = with(&scene, "materials.tiles.diffuse", "0.2");
    let before = window.frame();
    window.want(&edited);
    window.wait("edited", |w| *w.shown().scene == edited);
    assert!(window.shown().stage < Stage::Whole && *window.frame() != *before);
    assert!(window.status.held && !is_tracing(&window));
}

#[test]
fn a_scene_that_cannot_be_traced_is_reported_and_the_old_picture_stays() {
    let scene = scene("whitted", [32, 20], 1);
    let budget = fresh(&scene).kept_bytes() * 2;
    let mut window = Window::new(Options { memory: budget, ..OPTIONS });
    window.want(&scene);
    window.wait("whole", |w| w.status.in_step);
    let before = window.frame();
    let large = with(&scene, "picture.size", "[640, 400]");
    window.want(&large);
    window.wait("failed", |w| !w.events.is_empty() && !is_tracing(w));
    assert!(matches!(&window.events[..], [Event::Failed(text)] if text.contains("budget")));
    let status = window.status.clone();
    assert!(status.held && !status.in_step);
    assert_eq!(window.shown().stage, Stage::Whole);
    assert!(*window.frame() == *before && *window.shown().scene == scene);
    let other = with(&scene, "camera.eye", "[1, -6, 2]");
    window.want(&other);
    window.wait("another wish", |w| w.status.in_step);
    window.shows_whole(&other);
}

#[test]
fn a_panic_becomes_text() {
    assert_eq!(guarded(|| 1), Ok(1));
    let text = guarded(|| panic!("number {}", 5)).unwrap_err();
    assert!(text.contains("(number 5)"), "{text}");
}

/// A folder for one test, removed in the end.
fn folder() -> tempfile::TempDir {
    tempfile::tempdir().unwrap()
}

/// Red, green and blue of a PNG of 8 bits, and the scene inside of it.
fn decoded(path: &Path) -> (Vec<u8>, String) {
    let file = std::io::BufReader::new(std::fs::File::open(path).unwrap());
    let mut reader = png::Decoder::new(file).read_info().unwrap();
    let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
    reader.next_frame(&mut bytes).unwrap();
    let text = reader.info().utf8_text[0].get_text().unwrap();
    (bytes, text)
}

fn opaque(frame: &Frame) -> Vec<u8> {
    frame.bytes.chunks_exact(4).flat_map(|p| [p[0], p[1], p[2]]).collect()
}

fn export(window: &mut Window, path: PathBuf, size: [u32; 2]) {
    window.live.export(Export {
        path: path.clone(),
        format: Format::Png8,
        size,
        extras: Extras::default(),
    });
    window.wait("exported", |w| w.events.contains(&Event::Exported(path.clone())));
}

#[test]
fn an_export_holds_the_bytes_of_the_view_after_its_trace() {
    let folder = folder();
    let scene = slow();
    let mut window = Window::new(OPTIONS);
    window.want(&scene);
    let edited = with(&scene, "materials.tiles.diffuse", "0.2");
    window.want(&edited);
    let path = folder.path().join("view.png");
    export(&mut window, path.clone(), scene.picture.size);
    assert!(window.status.in_step, "it waited for the picture");
    window.shows_whole(&edited);
    let (bytes, text) = decoded(&path);
    assert!(bytes == opaque(&window.frame()));
    assert_eq!(text, write::text(&edited));
}

#[test]
fn an_export_of_another_size_is_a_render_of_that_size() {
    let folder = folder();
    let scene = scene("whitted", [64, 40], 4);
    let mut window = Window::showing(&scene);
    let (shown, last) = (window.shown().clone(), window.last());
    let path = folder.path().join("large.png");
    export(&mut window, path.clone(), [150, 110]);
    let large = with(&scene, "picture.size", "[150, 110]");
    assert!(decoded(&path).0 == opaque(fresh(&large).frame()));
    assert!(
        Arc::ptr_eq(shown.frame.as_ref().unwrap(), &window.frame()),
        "the view was not disturbed"
    );
    assert_eq!((window.last(), window.status.in_step), (last, true));
}

#[test]
fn an_export_is_cancelled_or_fails_and_no_file_is_left() {
    let folder = folder();
    let scene = scene("glass", [64, 40], 64);
    let mut window = Window::showing(&scene);
    let path = folder.path().join("large.png");
    let wanted =
        Export { path, format: Format::Png8, size: [1600, 900], extras: Extras::default() };
    window.live.export(wanted.clone());
    window.wait("a job", is_tracing);
    assert!(window.status.job.clone().unwrap().what.contains("large.png"));
    window.live.cancel();
    window.wait("cancelled", |w| !is_tracing(w));
    assert!(window.status.in_step && !window.status.held);
    let path = folder.path().join("nowhere/large.png");
    window.live.export(Export { path, size: scene.picture.size, ..wanted });
    window.wait("failed", |w| !w.events.is_empty());
    assert!(matches!(&window.events[..], [Event::Failed(text)] if text.contains("no folder")));
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
}

#[test]
fn an_export_of_a_held_wish_is_refused() {
    let folder = folder();
    let scene = slow();
    let mut window = Window::new(OPTIONS);
    window.want(&scene);
    window.wait("a job", is_tracing);
    window.live.cancel();
    window.wait("held", |w| w.status.held);
    let path = folder.path().join("view.png");
    window.live.export(Export {
        path,
        format: Format::Png8,
        size: scene.picture.size,
        extras: Extras::default(),
    });
    window.wait("refused", |w| !w.events.is_empty());
    assert!(matches!(&window.events[..], [Event::Failed(text)] if text.contains("view.png")));
}

#[test]
fn a_point_of_the_picture_tells_its_solid_and_material() {
    let scene = scene("whitted", [64, 40], 1);
    let window = Window::showing(&scene);
    let name = |point| {
        let Picked { solid, material, depth } = window.live.pick(point)?;
        assert_eq!(material, scene.solids[solid].material);
        assert!((1.0..30.0).contains(&depth), "{depth}");
        Some(scene.solids[solid].name.as_str())
    };
    assert_eq!(name([32.0, 39.5]), Some("floor"));
    assert_eq!(name([1.0, 0.5]), None, "the sky");
    assert_eq!((name([-1.0, 39.5]), name([32.0, 40.0])), (None, None), "outside");
}

#[test]
fn watched_costs_follow_the_scene_shown() {
    let scene = scene("whitted", [64, 40], 2);
    let mut window = Window::showing(&scene);
    let paths = ["materials.glass.reflect", "camera.eye", "no.such"].map(String::from);
    window.live.watch_costs(paths.to_vec());
    window.wait("costs", |w| w.live.costs().len() == 2);
    // What is kept, and with it the limits, comes from the trace, not from the edits after it.
    let expected = |edited: &Scene| {
        let mut session = fresh(&scene);
        session.edit_without_rays(&Arc::new(edited.clone())).unwrap();
        let cost =
            |path: &String| Some((path.clone(), crate::session::cost::cost(&mut session, path)?));
        paths.iter().filter_map(cost).collect::<BTreeMap<_, _>>()
    };
    assert_eq!(*window.live.costs(), expected(&scene));
    let edited = with(&scene, "materials.glass.transmit", "0.3");
    window.want(&edited);
    assert_ne!(expected(&edited), expected(&scene));
    window.wait("other costs", |w| *w.live.costs() == expected(&edited));
    window.want(&with(&edited, "camera.fov_degrees", "31"));
    window.wait("costs of the traced scene", |w| w.status.in_step && w.live.costs().len() == 2);
}

#[test]
fn a_window_that_closes_during_a_trace_does_not_wait_for_its_end() {
    let mut window = Window::new(OPTIONS);
    let mut scene = slow();
    scene.trace.samples = 4096;
    window.want(&scene);
    window.wait("a preview", |w| w.newest.is_some());
    let closed = Instant::now();
    drop(window.live);
    assert!(closed.elapsed() < Duration::from_secs(2), "{:?}", closed.elapsed());
}

#[path = "tests_mending.rs"]
mod mending;
