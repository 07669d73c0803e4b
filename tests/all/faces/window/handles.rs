//! Lights moved and turned by their handles in the picture.

use rayforest::scene::LightPlace;

use super::*;
use crate::faces::SCENE;

/// The small scene with its point light in the picture.
fn lit() -> String {
    SCENE.replace("[-4, -5, 7]", "[-1, 0, 1.5]")
}

impl Window {
    fn handle(&self, light: &str) -> Option<Pos2> {
        let name = format!("light {light} handle");
        let node = self.harness.query_by_role_and_label(Role::Button, &name);
        node.map(|node| node.rect().center())
    }

    /// Drags a handle by a way in points.
    fn drag_handle(&mut self, light: &str, way: Vec2, modifiers: Modifiers) {
        let from = self.handle(light).expect("the light has a handle");
        self.harness.event(Event::ModifiersChanged(modifiers));
        self.drag(from, from + way);
        self.harness.event(Event::ModifiersChanged(Modifiers::NONE));
        self.harness.run_steps(2);
    }

    fn light_place(&self, light: usize) -> LightPlace {
        self.app().document().scene().lights[light].place.clone()
    }
}

#[test]
fn a_light_is_dragged_in_the_picture_and_one_undo_takes_it_back() {
    let mut window = Window::with_scene(&lit(), Vec::new());
    let scene = window.app().document().scene().clone();
    let (picture, before) = (window.picture(), window.handle("key").expect("a handle"));
    let way = vec2(60.0, -35.0);
    window.drag_handle("key", way, Modifiers::NONE);
    let LightPlace::Point(point) = window.light_place(0) else { panic!("a point stays a point") };
    assert!(point.x > -0.9 && point.z > 1.6, "right and up: {point}");
    assert_eq!(window.light_place(1), scene.lights[1].place, "the other light stays");
    let after = window.handle("key").expect("a handle");
    assert!((after - before - way).length() < 1.0, "it lies under the pointer: {before} {after}");
    assert!(window.shows("Light key"), "the light that was taken is selected");
    let step = window.undo_name().expect("a step").to_owned();
    assert!(step.starts_with("point of light key [-1"), "{step}");
    window.until_exact();
    assert!(window.picture() != picture);
    window.save();
    let text = window.scene_text();
    let line = format!("key = {{ point = [{}, {}, {}], intensity", point.x, point.y, point.z);
    assert!(text.contains(&line), "{line}\n{text}");
    assert!(line.len() < 50, "few digits: {line}");
    assert!(rgb(&window.picture()) == rendered(window.folder.path(), "scene.toml"));

    window.click("Undo");
    assert!(*window.app().document().scene() == scene, "the whole drag was one step");
    assert_eq!(window.undo_name(), None);
    window.until_exact();
    assert!(window.picture() == picture);
    window.click("Redo");
    assert_eq!(window.light_place(0), LightPlace::Point(point));
}

#[test]
fn with_shift_a_light_goes_farther_and_nearer() {
    let mut window = Window::with_scene(&lit(), Vec::new());
    let eye = window.app().document().scene().camera.eye;
    let distance = |window: &Window| match window.light_place(0) {
        LightPlace::Point(point) => point.distance(eye),
        _ => panic!("a point stays a point"),
    };
    let start = distance(&window);
    window.drag_handle("key", vec2(0.0, -40.0), Modifiers::SHIFT);
    let farther = distance(&window);
    assert!(farther > start + 0.2, "{start} {farther}");
    window.drag_handle("key", vec2(0.0, 80.0), Modifiers::SHIFT);
    assert!(distance(&window) < start, "nearer than before");
}

#[test]
fn a_direction_is_turned_and_what_is_behind_the_eye_has_no_handle() {
    let mut window = Window::with_scene(SCENE, Vec::new());
    assert_eq!(window.handle("key"), None, "this one is behind the eye");
    let before = window.handle("fill").expect("a handle");
    let way = vec2(-70.0, 30.0);
    window.drag_handle("fill", way, Modifiers::NONE);
    let LightPlace::Direction(along) = window.light_place(1) else {
        panic!("it stays a direction")
    };
    assert!(along.x > -0.5, "it comes from farther left: {along}");
    let after = window.handle("fill").expect("a handle");
    assert!((after - before - way).length() < 1.0, "{before} {after}");
    window.save();
    let [x, y, z] = along.to_array();
    let line = format!("fill = {{ direction = [{x}, {y}, {z}], intensity");
    assert!(window.scene_text().contains(&line), "{line}\n{}", window.scene_text());
    window.until_exact();
    assert!(rgb(&window.picture()) == rendered(window.folder.path(), "scene.toml"));
}

#[test]
fn a_click_on_a_handle_selects_and_moves_nothing() {
    let mut window = Window::with_scene(&lit(), Vec::new());
    let at = window.handle("key").expect("a handle");
    window.click_at(at, Modifiers::NONE);
    assert!(window.shows("Light key") && !window.app().document().is_unsaved());
    window.click("mirror");
    let camera = window.app().document().scene().camera.clone();
    window.click("Move camera");
    window.drag_handle("key", vec2(20.0, 0.0), Modifiers::NONE);
    assert_eq!(window.app().document().scene().camera, camera, "the light moves, not the camera");
    assert!(window.undo_name().expect("a step").starts_with("point of light key"));
}

#[test]
fn the_handles_can_be_hidden() {
    let mut window = Window::with_scene(&lit(), Vec::new());
    assert!(window.handle("key").is_some() && window.handle("fill").is_some());
    window.menu(&["View", "Light handles"]);
    window.harness.run_steps(2);
    assert!(window.handle("key").is_none() && window.handle("fill").is_none());
    window.key(Modifiers::NONE, Key::H);
    assert!(window.handle("key").is_some());
    window.click("1:1");
    assert_eq!(window.handle("key"), None, "the picture is smaller than a few handles");
    for _ in 0..20 {
        window.key(Modifiers::NONE, Key::Plus);
    }
    assert_eq!(window.handle("key"), None, "it lies outside the view");
    window.click("Fit");
    assert!(window.handle("key").is_some());
}

#[test]
fn the_arrows_move_a_light_whose_handle_tab_reached() {
    let mut window = Window::with_scene(&lit(), Vec::new());
    let reached = (0..200).any(|_| {
        window.key(Modifiers::NONE, Key::Tab);
        let name = "light key handle";
        let node = window.harness.query_by_role_and_label(Role::Button, name);
        node.is_some_and(|node| node.is_focused())
    });
    assert!(reached, "Tab reaches the handle");
    let places: Vec<_> = [Key::ArrowRight, Key::ArrowUp]
        .into_iter()
        .map(|key| {
            window.key(Modifiers::NONE, key);
            window.light_place(0)
        })
        .collect();
    let [LightPlace::Point(right), LightPlace::Point(up)] = places[..] else { panic!("points") };
    assert!(right.x > -1.0 && right.z == 1.5, "{right}");
    assert!(up.x == right.x && up.z > 1.5, "{up}");
    window.key(Modifiers::SHIFT, Key::ArrowUp);
    let LightPlace::Point(farther) = window.light_place(0) else { panic!("a point") };
    assert!(farther.y > up.y, "{farther}");
    window.key(Modifiers::COMMAND, Key::Z);
    assert_eq!(window.light_place(0), LightPlace::Point(up), "each press is a step");
}

#[test]
fn a_tooltip_tells_what_a_move_costs() {
    let mut window = Window::with_scene(&lit(), Vec::new());
    let at = window.handle("key").expect("a handle");
    window.harness.hover_at(at + vec2(1.0, 0.0));
    window.harness.step();
    window.harness.hover_at(at);
    window.until_text("Shift-drag farther");
    // "traced anew", or "new rays" for a share of the pixels
    window.until_text("new");
}
