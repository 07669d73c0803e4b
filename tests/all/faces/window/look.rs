//! How the picture is looked at: exposure by keys, clipping marks, the region, tiles.

use eframe::egui::{Color32, Shape, TextureId};

use super::*;
use crate::faces::SCENE;

impl Window {
    /// Presses `]` three times; again, where the machine was too busy to do it without a rest.
    fn press_three_times_without_a_rest(&mut self) {
        for _ in 0..50 {
            let begun = Instant::now();
            for expected in [0.33, 0.67, 1.0] {
                self.harness.key_press(Key::CloseBracket);
                self.harness.step();
                assert_eq!(self.exposure(), expected);
            }
            if begun.elapsed() < Duration::from_millis(350) {
                return;
            }
            while self.undo_name().is_some() {
                self.key(Modifiers::COMMAND, Key::Z);
            }
        }
        panic!("the machine is too busy");
    }

    fn exposure(&self) -> f32 {
        self.app().document().scene().picture.exposure
    }

    /// The outline of the region on the screen, if one is drawn.
    fn outline(&mut self) -> Option<Rect> {
        self.harness.step();
        let view = self.rect(Role::Image, "picture");
        let shapes = self.harness.output().shapes.iter();
        let mut outlines = shapes.filter_map(|clipped| match &clipped.shape {
            Shape::Rect(rect)
                if rect.stroke.color == Color32::WHITE && view.contains_rect(rect.rect) =>
            {
                Some(rect.rect)
            }
            _ => None,
        });
        outlines.next()
    }
}

#[test]
fn brackets_change_the_exposure_and_a_run_of_presses_is_one_step() {
    let mut window = Window::with_scene(SCENE, Vec::new());
    window.press_three_times_without_a_rest();
    assert_eq!(window.undo_name(), Some("exposure 0 → 1"));
    // A rest ends the run.
    std::thread::sleep(Duration::from_millis(450));
    window.harness.run_steps(3);
    window.key(Modifiers::NONE, Key::OpenBracket);
    assert_eq!(window.undo_name(), Some("exposure 1 → 0.67"));
    window.until_exact();
    let shown = window.picture();
    window.save();
    assert_eq!(rgb(&shown), rendered(window.folder.path(), "scene.toml"));
    window.key(Modifiers::COMMAND, Key::Z);
    assert_eq!(window.exposure(), 1.0);
    window.key(Modifiers::COMMAND, Key::Z);
    assert_eq!(window.exposure(), 0.0, "three presses at once");
    window.key(Modifiers::COMMAND | Modifiers::SHIFT, Key::Z);
    window.key(Modifiers::NONE, Key::Num0);
    assert_eq!((window.exposure(), window.undo_name()), (0.0, Some("exposure 1 → 0")));
}

#[test]
fn an_edit_after_a_press_is_a_step_of_its_own() {
    let mut window = Window::with_scene(SCENE, Vec::new());
    window.click("mirror");
    window.key(Modifiers::NONE, Key::CloseBracket);
    window.drag_slider("diffuse", 0.9);
    window.key(Modifiers::COMMAND, Key::Z);
    assert_eq!(window.exposure(), 0.33);
    assert_eq!(window.undo_name(), Some("exposure 0 → 0.33"));
}

#[test]
fn clipped_pixels_are_marked_on_the_screen_and_counted() {
    let scene = SCENE.replace("[picture]\n", "[picture]\nexposure = 2\n");
    let mut window = Window::with_scene(&scene, Vec::new());
    let before = window.picture();
    assert!(!window.shows("clipped "));
    window.key(Modifiers::NONE, Key::X);
    window.until_text("clipped ");
    let marked = window.app().shown().unwrap().marked.clone().unwrap();
    assert!(marked.clipped.over > 20, "{:?}", marked.clipped);
    assert!(marked.frame.bytes != before);
    assert!(window.picture() == before, "the picture itself is as it was");
    window.key(Modifiers::NONE, Key::X);
    window.harness.run_steps(3);
    assert!(!window.shows("clipped "));
}

#[test]
fn a_tone_curve_is_chosen_in_the_inspector_and_shown_as_it_is_written() {
    let scene = SCENE.replace("[picture]\n", "[picture]\nexposure = 2\n");
    let mut window = Window::with_scene(&scene, Vec::new());
    let before = window.picture();
    window.click("tone");
    window.click("neutral");
    window.until_exact();
    assert_eq!(window.undo_name(), Some("tone none → neutral"));
    let shown = window.picture();
    assert!(shown != before);
    window.save();
    assert!(window.scene_text().contains("tone = \"neutral\""));
    assert_eq!(rgb(&shown), rendered(window.folder.path(), "scene.toml"));
}

#[test]
fn a_region_is_drawn_by_a_drag_and_goes_with_a_double_click() {
    let mut window = Window::with_scene(SCENE, Vec::new());
    assert_eq!(window.outline(), None);
    let (from, to) = (window.at(10.0, 5.0), window.at(30.0, 20.0));
    let place = window.place();
    window.drag(from, to);
    assert_ne!(window.place(), place, "without the tool a drag moves the picture");
    window.key(Modifiers::NONE, Key::F);
    window.key(Modifiers::NONE, Key::R);
    window.drag(from, to);
    assert_eq!(window.place(), place, "with it the picture stays");
    let drawn = window.outline().expect("an outline");
    let pixel = place.width() / 48.0;
    assert!(drawn.min.distance(from) < 2.0 * pixel && drawn.max.distance(to) < 2.0 * pixel);
    // The tool is done; the next drag moves the picture again.
    window.drag(from, to);
    assert_ne!(window.place(), place);
    window.key(Modifiers::NONE, Key::F);
    assert!(window.outline().is_some());
    let middle = window.at(20.0, 12.0);
    window.click("fill");
    window.double_click_at(middle);
    assert_eq!(window.outline(), None);
    assert!(window.shows("Light fill"), "two clicks that took the region away choose nothing");
    window.click_at(middle, Modifiers::NONE);
    assert!(!window.shows("Light fill"), "one does");

    window.key(Modifiers::NONE, Key::R);
    window.key(Modifiers::NONE, Key::Escape);
    window.drag(from, to);
    assert_eq!(window.outline(), None, "Escape left the tool");
    window.key(Modifiers::NONE, Key::F);
    window.key(Modifiers::NONE, Key::R);
    window.drag(from, to);
    assert!(window.outline().is_some());
    window.menu(&["Picture", "Clear the region"]);
    assert_eq!(window.outline(), None);
}

#[test]
fn a_picture_larger_than_a_texture_is_cut() {
    let scene = SCENE.replace("size = [48, 27]", "size = [2100, 40]");
    let scene = scene.replace("samples = 2", "samples = 1");
    let mut window = Window::with_scene(&scene, Vec::new());
    let pieces = |window: &Window| {
        let view = window.rect(Role::Image, "picture");
        let shapes = window.harness.output().shapes.iter();
        let pieces = shapes.filter_map(|clipped| match &clipped.shape {
            Shape::Mesh(mesh) if mesh.texture_id != TextureId::default() => {
                Some(mesh.calc_bounds())
            }
            _ => None,
        });
        pieces.filter(|bounds| view.expand(1.0).contains_rect(*bounds)).collect::<Vec<_>>()
    };
    assert_eq!(pieces(&window).len(), 2, "2048 pixels and the rest");
    let folder = window.folder.path().join("scene.toml");
    // A card that takes less.
    window.harness.input_mut().max_texture_side = Some(1024);
    window.harness.step();
    window.key(Modifiers::NONE, Key::CloseBracket);
    window.until_exact();
    let cut = pieces(&window);
    assert_eq!(cut.len(), 3, "{folder:?}");
    let whole = cut.iter().copied().reduce(Rect::union).unwrap();
    let area: f32 = cut.iter().map(|piece| piece.area()).sum();
    assert!((area - whole.area()).abs() < 0.01 * whole.area(), "side by side");
}
