//! The light mixer: switch, solo, stops, colour, kelvin.

use rayforest::color::{Rgb, blackbody};
use rayforest::scene::Light;

use super::*;
use crate::faces::SCENE;

/// The small scene with a third light, which is off, and green.
fn three() -> String {
    let rim =
        "rim = { direction = [0, 1, -0.2], color = [0, 1, 0], on = false }\n\n[materials.tiles]";
    SCENE.replace("\n[materials.tiles]", rim)
}

impl Window {
    fn mixed(scene: &str) -> Window {
        let mut window = Window::with_scene(scene, Vec::new());
        window.key(Modifiers::NONE, Key::L);
        assert!(window.shows("Close the light mixer"));
        window
    }

    fn light(&self, i: usize) -> &Light {
        &self.app().document().scene().lights[i]
    }

    fn switches(&self) -> Vec<bool> {
        self.app().document().scene().lights.iter().map(|light| light.on).collect()
    }

    /// The text of a number field.
    fn field(&self, name: &str) -> String {
        let node = self.harness.get_by_role_and_label(Role::SpinButton, name);
        node.accesskit_node().value().unwrap_or_default()
    }
}

#[test]
fn solo_is_a_step_and_gives_back_what_was() {
    let mut window = Window::mixed(&three());
    window.click("solo key");
    assert_eq!(window.switches(), [true, false, false]);
    assert_eq!(window.undo_name(), Some("solo key"));
    window.click("solo fill");
    assert_eq!(window.switches(), [false, true, false]);
    window.click("solo fill");
    assert_eq!(window.switches(), [true, true, false], "as it was before the first solo");
    assert_eq!(window.undo_name(), Some("end of solo fill"));

    window.key(Modifiers::COMMAND, Key::Z);
    window.key(Modifiers::COMMAND, Key::Z);
    window.key(Modifiers::COMMAND, Key::Z);
    assert!(window.switches() == [true, true, false] && !window.app().document().is_unsaved());

    window.click("solo rim");
    window.click("key on");
    assert_eq!(window.switches(), [true, false, true]);
    assert_eq!(window.undo_name(), Some("light key on"));
    window.click("solo key");
    window.click("solo key");
    assert_eq!(window.switches(), [true, false, true], "a light lit by hand ended the solo");
}

#[test]
fn what_the_mixer_does_costs_no_ray_and_is_what_a_fresh_render_gives() {
    let mut window = Window::mixed(&three());
    window.until_text("cost of key: instant");
    window.type_into("key stops value", "1");
    assert_eq!(window.light(0).intensity, Rgb::grey(2.0));
    window.type_into("fill stops value", "-1");
    let [r, g, b] = window.light(1).intensity.0;
    assert!(b == 0.5 && (r / b - 2.0 / 3.0).abs() < 1e-6 && (g / b - 5.0 / 6.0).abs() < 1e-6);
    window.click("rim on");
    window.type_into("rim kelvin value", "3000 K");
    assert_eq!(window.light(2).color, blackbody(3000.0));
    window.until_exact();
    window.until_text("· 0 rays");
    window.save();
    assert!(rgb(&window.picture()) == rendered(window.folder.path(), "scene.toml"));
    let text = window.scene_text();
    assert!(text.contains("key = { point = [-4, -5, 7], intensity = 2 }"), "{text}");
    assert!(text.contains("color = [1, ") && text.contains("on = true }"), "{text}");
}

#[test]
fn a_slider_of_stops_is_one_step_and_keeps_a_grey_light_grey() {
    let mut window = Window::mixed(SCENE);
    let scene = window.app().document().scene().clone();
    window.drag_slider("key stops", 0.9);
    let [r, g, b] = window.light(0).intensity.0;
    assert!(r > 4.0 && r == g && g == b, "{r} {g} {b}");
    assert!(window.undo_name().expect("a step").starts_with("intensity of light key 0.8"));
    window.key(Modifiers::COMMAND, Key::Z);
    assert!(*window.app().document().scene() == scene);
}

#[test]
fn a_colour_shows_its_temperature_or_none() {
    let mut window = Window::mixed(&three());
    let white = window.field("key kelvin value");
    assert!(white.starts_with("650") && white.ends_with(" K"), "D65: {white}");
    assert_eq!(window.field("rim kelvin value"), "—");
    window.drag_slider("key kelvin", 0.3);
    let text = window.field("key kelvin value");
    let kelvin: f64 = text.trim_end_matches(" K").parse().expect("a number");
    assert!((2000.0..2600.0).contains(&kelvin), "{text}");
    assert_eq!(window.light(0).color, blackbody(kelvin));
    assert!(window.undo_name().expect("a step").starts_with("color of light key"));
    for (typed, kelvin) in [("20", 1000.0), ("1e9", 15_000.0)] {
        window.type_into("key kelvin value", typed);
        assert_eq!(window.light(0).color, blackbody(kelvin), "{typed}");
    }
    let color = window.light(0).color;
    for text in ["", "hot", "nan"] {
        window.type_into("key kelvin value", text);
        assert_eq!(window.light(0).color, color, "{text}");
    }
}

#[test]
fn the_mixer_is_opened_and_closed_and_selects_lights() {
    let mut window = Window::with_scene(SCENE, Vec::new());
    window.click("Light mixer");
    window.click("show fill");
    assert!(window.shows("Light fill"));
    window.click("Close the light mixer");
    assert!(!window.shows("solo key"));
    assert!(!window.app().document().is_unsaved());
}
