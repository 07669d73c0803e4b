//! The camera moved in the picture: coarse first, whole in the end, and stopped.

use rayforest::scene::write;
use rayforest::session::live::Stage;

use super::*;
use crate::faces::SCENE;

/// Large enough that a trace has stages before the whole picture, and can be stopped.
fn large() -> String {
    SCENE.replace("[48, 27]", "[400, 225]").replace("samples = 2", "samples = 16")
}

impl Window {
    /// Drags in the picture by a share of its size.
    fn orbit(&mut self) {
        let rect = self.rect(Role::Image, "picture");
        self.drag(rect.center(), rect.center() + vec2(0.1, 0.05) * rect.size());
    }

    /// Stops what runs, and waits until it stopped, or ended.
    fn click_stop(&mut self) {
        let at = self.button("Stop").expect("something runs");
        self.click_at(at, Modifiers::NONE);
        self.until("it stopped or ended", |app| {
            let status = app.live().status();
            status.held || status.in_step
        });
    }

    fn stage(&self) -> Stage {
        self.app().shown().expect("a picture").stage
    }
}

#[test]
fn a_moved_camera_shows_a_coarse_picture_first_and_then_the_exact_one() {
    let mut window = Window::with_scene(&large(), Vec::new());
    let before = window.picture();
    window.click("Move camera");
    let middle = window.rect(Role::Image, "picture").center();
    window.harness.hover_at(middle);
    window.harness.drag_at(middle);
    window.harness.step();
    // A machine that traces one sample per pixel at once begins with that, not with fewer pixels. A
    // picture that came and went between two turns of the loop is waited for once more.
    let is_first = |window: &Window| match window.stage() {
        Stage::Coarse => window.shows("coarse"),
        Stage::OneSample => window.shows("one sample"),
        Stage::Region | Stage::Mending | Stage::Whole => false,
    };
    let mut seen = false;
    for i in 1..200 {
        window.harness.hover_at(middle + vec2(i as f32, 0.0));
        for _ in 0..10 {
            window.harness.step();
            seen |= is_first(&window);
            std::thread::sleep(Duration::from_millis(3));
        }
        if seen {
            break;
        }
    }
    assert!(seen, "a picture comes before the whole one");
    window.harness.drop_at(middle);
    window.harness.run_steps(2);
    let undo = window.undo_name().expect("one step").to_owned();
    assert!(undo.starts_with("eye") || undo.starts_with("camera"), "{undo}");
    window.until_exact();
    assert_eq!(window.stage(), Stage::Whole);
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
    // The last picture of a trace that ended sooner than undo came takes rays: look at another.
    let is_instant = (0..50).any(|_| {
        window.orbit();
        window.key(Modifiers::COMMAND, Key::Z);
        window.until_exact();
        assert!(window.picture() == before);
        window.shows("· 0 rays")
    });
    assert!(is_instant, "undo during a trace casts no ray");
}

#[test]
fn a_stop_keeps_the_old_picture_whole_until_it_is_traced() {
    let mut window = Window::with_scene(&large(), Vec::new());
    window.click("Move camera");
    // A trace that ended before it could be stopped is not the one to look at.
    let is_stopped = (0..50).any(|_| {
        window.orbit();
        match window.button("Stop") {
            Some(_) => window.click_stop(),
            None => window.until_exact(),
        }
        window.app().live().status().held
    });
    assert!(is_stopped, "a trace was stopped");
    window.until("an old picture is back", |app| {
        app.shown().is_some_and(|s| s.stage == Stage::Whole && *s.scene != *app.document().scene())
    });
    // The drag has several cameras: the picture may be of any before the one that was stopped.
    let old = window.app().shown().expect("a picture").scene.clone();
    std::fs::write(window.file("old.toml"), write::text(&old)).unwrap();
    let before = window.picture();
    assert!(rgb(&before) == rendered(window.folder.path(), "old.toml"), "the old picture is whole");
    window.until_text("stopped: the picture shows the scene before the last change");
    window.until_text("earlier scene");
    window.click("Trace now");
    window.until_exact();
    assert!(window.picture() != before);
    window.save();
    assert!(rgb(&window.picture()) == rendered(window.folder.path(), "scene.toml"));
}

#[test]
fn a_click_focuses_the_camera_once() {
    let mut window = Window::with_scene(SCENE, Vec::new());
    let before = window.picture();
    let middle = window.rect(Role::Image, "picture").center();
    window.key(Modifiers::NONE, Key::D);
    window.click_at(middle, Modifiers::NONE);
    let camera = window.app().document().scene().camera.clone();
    let target = camera.eye.distance(camera.target);
    assert!((0.5 * target..1.5 * target).contains(&camera.focus), "{}", camera.focus);
    let step = window.undo_name().expect("one step").to_owned();
    assert!(step.starts_with("focus"), "{step}");
    window.until_exact();
    assert!(window.picture() == before, "a pinhole has no focus");
    window.click_at(middle + vec2(3.0, 0.0), Modifiers::NONE);
    assert_eq!(window.app().document().scene().camera, camera, "the next click only selects");
    window.click("Undo");
    assert_eq!(window.undo_name(), None);
    assert_eq!(window.app().document().scene().camera.focus, 0.0);
}

#[test]
fn without_the_tool_a_drag_moves_no_camera() {
    let mut window = Window::with_scene(SCENE, Vec::new());
    window.orbit();
    assert!(!window.app().document().is_unsaved());
}
