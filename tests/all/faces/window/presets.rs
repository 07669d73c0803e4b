//! Materials to choose from: clicked, dropped on a solid, copied and pasted.

use eframe::egui::OutputCommand;
use rayforest::document::presets::{all, parse};
use rayforest::scene::{Material, Scene};

use super::*;
use crate::faces::SCENE;

impl Window {
    pub(super) fn scene(&self) -> &Scene {
        self.app().document().scene()
    }

    fn with_presets() -> Window {
        let mut window = Window::with_scene(SCENE, Vec::new());
        window.click("mirror");
        window.click("Presets");
        window
    }

    /// The window shows, to the byte, what a fresh render of its scene gives.
    fn is_fresh(&mut self) {
        self.until_exact();
        self.save();
        assert!(rgb(&self.picture()) == rendered(self.folder.path(), "scene.toml"));
    }
}

fn named(name: &str) -> Material {
    all().into_iter().find(|preset| preset.name == name).expect("a preset")
}

#[test]
fn a_click_gives_the_material_a_presets_values_as_one_step() {
    let mut window = Window::with_presets();
    let scene = window.scene().clone();
    window.click("preset gold");
    let expected = Material { name: "mirror".into(), ..named("gold") };
    assert_eq!(window.scene().materials[1], expected);
    assert_eq!(window.undo_name(), Some("gold for mirror"));
    window.is_fresh();
    window.click("preset glass");
    window.is_fresh();
    window.click("preset marble");
    window.is_fresh();
    for _ in 0..3 {
        window.key(Modifiers::COMMAND, Key::Z);
    }
    assert!(*window.scene() == scene && window.undo_name().is_none());
}

#[test]
fn a_preset_is_dropped_on_a_solid() {
    let mut window = Window::with_presets();
    let from = window.rect(Role::Button, "preset copper").center();
    let ball = window.rect(Role::Image, "picture").center();
    window.drag(from, ball);
    let scene = window.scene();
    assert_eq!(scene.solids[1].material, 2);
    assert_eq!(scene.materials[2], named("copper"));
    assert_eq!(scene.materials[1].name, "mirror", "which stays as it was");
    assert_eq!(window.undo_name(), Some("ball of copper"));
    assert!(window.shows("Material copper"), "it is selected");
    window.is_fresh();

    // The same once more: the material is there already.
    let saved = window.scene().clone();
    let from = window.rect(Role::Button, "preset copper").center();
    window.drag(from, ball);
    assert!(*window.scene() == saved);
    // Beside the picture nothing happens.
    let menu = window.rect(Role::Button, "Undo").center();
    window.drag(from, menu);
    assert!(*window.scene() == saved);
    window.key(Modifiers::COMMAND, Key::Z);
    assert_eq!(window.scene().materials.len(), 2, "one step");
}

#[test]
fn a_material_is_copied_and_pasted_as_text() {
    let mut window = Window::with_scene(SCENE, Vec::new());
    window.right_click("mirror");
    let at = window.settled("Copy material mirror");
    window.harness.event(Event::PointerMoved(at));
    let mut copied = None;
    for pressed in [true, false] {
        let (button, modifiers) = (PointerButton::Primary, Modifiers::NONE);
        window.harness.event(Event::PointerButton { pos: at, button, pressed, modifiers });
        for _ in 0..2 {
            window.harness.step();
            let commands = &window.harness.output().platform_output.commands;
            copied = commands
                .iter()
                .find_map(|command| match command {
                    OutputCommand::CopyText(text) => Some(text.clone()),
                    _ => None,
                })
                .or(copied);
        }
    }
    let copied = copied.expect("a copy");
    let file = window.file("scene.toml");
    assert_eq!(parse(&copied, &file).as_ref(), Ok(&window.scene().materials[1]), "{copied}");

    let paste = |window: &mut Window, text: &str| {
        window.harness.run_steps(3);
        window.right_click("tiles");
        window.click("Paste material tiles");
        window.harness.event(Event::Paste(text.to_owned()));
        window.harness.step();
        window.harness.run_steps(2);
    };
    let before = window.scene().clone();
    paste(&mut window, "no material at all");
    window.until_text("`no material at all` was not pasted: it is no material");
    assert!(*window.scene() == before);
    window.right_click("tiles");
    window.click("Paste material tiles");
    window.until_text("the clipboard holds no text");
    paste(&mut window, &copied);
    let expected = Material { name: "tiles".into(), ..before.materials[1].clone() };
    assert_eq!(window.scene().materials[0], expected);
    assert_eq!(window.undo_name(), Some("paste mirror on tiles"));
    window.is_fresh();
    window.key(Modifiers::COMMAND, Key::Z);
    assert!(*window.scene() == before);
}
