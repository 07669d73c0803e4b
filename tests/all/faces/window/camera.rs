//! The camera moved in the picture: coarse first, whole in the end, and stopped.

use rayforest::session::live::Stage;

use super::*;
use crate::faces::SCENE;

/// Large enough that a trace has stages before the whole picture, and can be stopped.
fn large() -> String {
    SCENE.replace("[48, 27]", "[640, 360]").replace("samples = 2", "samples = 16")
}

impl Window {
    /// Drags in the picture by a share of its size; the stages that showed until it is exact.
    fn orbit(&mut self) {
        let rect = self.rect(Role::Image, "picture");
        self.drag(rect.center(), rect.center() + vec2(0.1, 0.05) * rect.size());
    }

    /// The stages that show until the picture is exact.
    fn stages(&mut self) -> Vec<Stage> {
        let start = Instant::now();
        let mut seen = Vec::new();
        loop {
            self.harness.step();
            let stage = self.app().shown().map(|s| s.stage).expect("a picture");
            if seen.last() != Some(&stage) {
                seen.push(stage);
            }
            if stage == Stage::Whole && self.app().live().status().in_step {
                return seen;
            }
            assert!(start.elapsed() < PATIENCE, "{seen:?}");
            std::thread::sleep(Duration::from_millis(1));
        }
    }
}

#[test]
fn a_moved_camera_shows_a_coarse_picture_first_and_then_the_exact_one() {
    let mut window = Window::with_scene(&large(), Vec::new());
    let before = window.picture();
    window.click("Move camera");
    window.orbit();
    let undo = window.undo_name().expect("one step").to_owned();
    assert!(undo.starts_with("eye") || undo.starts_with("camera"), "{undo}");
    let stages = window.stages();
    assert!(stages.contains(&Stage::Coarse), "{stages:?}");
    assert_eq!(stages.last(), Some(&Stage::Whole));
    window.until_exact();
    let moved = window.picture();
    assert!(moved != before);
    window.save();
    assert!(rgb(&moved) == rendered(window.folder.path(), "scene.toml"), "live is fresh");

    window.click("Undo");
    assert_eq!(window.undo_name(), None, "the whole drag was one step");
    window.until_exact();
    assert!(window.picture() == before, "the old bytes come back");
}

#[test]
fn undo_during_the_trace_brings_the_old_picture_without_a_ray() {
    let mut window = Window::with_scene(&large(), Vec::new());
    let before = window.picture();
    window.click("Move camera");
    window.orbit();
    window.until("a trace runs", |app| app.live().status().job.is_some());
    window.key(Modifiers::COMMAND, Key::Z);
    window.until_exact();
    assert!(window.picture() == before);
    window.until_text("· 0 rays");
}

#[test]
fn a_stop_keeps_the_old_picture_whole_until_it_is_traced() {
    let mut window = Window::with_scene(&large(), Vec::new());
    let before = window.picture();
    window.click("Move camera");
    window.orbit();
    window.until_text("tracing: ");
    window.click("Stop");
    window.until("it stopped", |app| app.live().status().held);
    window.until("the old picture is back", |app| {
        app.shown().is_some_and(|s| s.stage == Stage::Whole && s.frame.bytes == before)
    });
    window.until_text("stopped: the picture shows the scene before the last change");
    window.until_text("earlier scene");
    window.click("Trace now");
    window.until_exact();
    assert!(window.picture() != before);
    window.save();
    assert!(rgb(&window.picture()) == rendered(window.folder.path(), "scene.toml"));
}

#[test]
fn without_the_tool_a_drag_moves_no_camera() {
    let mut window = Window::with_scene(SCENE, Vec::new());
    window.orbit();
    assert!(!window.app().document().is_unsaved());
}
