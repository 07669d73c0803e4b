//! The window without a pointer.

use super::*;
use crate::faces::SCENE;

impl Window {
    fn is_focused(&self, role: Role, name: &str) -> bool {
        self.harness.query_by_role_and_label(role, name).is_some_and(|node| node.is_focused())
    }

    fn camera_moves(&self) -> bool {
        let node = self.harness.get_by_role_and_label(Role::Button, "Move camera");
        let toggled = node.accesskit_node().toggled();
        toggled == Some(eframe::egui::accesskit::Toggled::True)
    }
}

#[test]
fn the_arrows_move_a_slider_that_tab_reached() {
    let mut window = Window::with_scene(SCENE, Vec::new());
    let diffuse = |window: &Window| window.app().document().scene().materials[1].diffuse.0[0];
    window.click("mirror");
    let presses = (0..200).position(|_| {
        window.key(Modifiers::NONE, Key::Tab);
        window.is_focused(Role::Slider, "diffuse")
    });
    assert!(presses.is_some(), "Tab reaches the slider");
    window.key(Modifiers::NONE, Key::ArrowRight);
    let once = diffuse(&window);
    assert!((0.3..0.4).contains(&once) && once > 0.3, "{once}");
    let name = window.undo_name().expect("a step").to_owned();
    assert!(name.starts_with("diffuse of mirror 0.3"), "{name}");
    window.key(Modifiers::NONE, Key::ArrowRight);
    assert!(diffuse(&window) > once);
    window.key(Modifiers::COMMAND, Key::Z);
    assert_eq!(diffuse(&window), once, "each press is a step");
    window.key(Modifiers::COMMAND, Key::Z);
    assert!(diffuse(&window) == 0.3 && !window.app().document().is_unsaved());
    window.key(Modifiers::COMMAND | Modifiers::SHIFT, Key::Z);
    assert_eq!(diffuse(&window), once);
}

#[test]
fn shortcuts_are_letters_while_a_text_is_typed() {
    let mut window = Window::with_scene(SCENE, Vec::new());
    window.click("mirror");
    window.drag_slider("diffuse", 0.9);
    let edited = window.app().document().scene().clone();
    let field = window.rect(Role::SpinButton, "reflect value").center();
    window.click_at(field, Modifiers::NONE);
    window.key(Modifiers::NONE, Key::C);
    window.key(Modifiers::COMMAND, Key::Z);
    assert!(!window.camera_moves());
    assert!(*window.app().document().scene() == edited, "undo is the field's own");
    window.key(Modifiers::NONE, Key::Escape);
    assert!(*window.app().document().scene() == edited, "a field that is left changes nothing");

    window.key(Modifiers::NONE, Key::C);
    assert!(window.camera_moves(), "now it is a shortcut");
    window.key(Modifiers::COMMAND, Key::Z);
    assert!(*window.app().document().scene() != edited);
}

/// A long turn brings several presses of a key at once.
#[test]
fn every_press_of_a_key_counts() {
    let mut window = Window::with_scene(SCENE, Vec::new());
    let press = |window: &mut Window, key: Key, modifiers: Modifiers, count: usize| {
        for pressed in [true, false].repeat(count) {
            let physical_key = None;
            window.harness.event(Event::Key {
                key,
                physical_key,
                pressed,
                repeat: false,
                modifiers,
            });
        }
        window.harness.step();
    };
    press(&mut window, Key::CloseBracket, Modifiers::NONE, 6);
    assert_eq!(window.app().document().scene().picture.exposure, 2.0);
    window.until("the gesture ends", |app| app.document().undo_name().is_some());
    std::thread::sleep(Duration::from_millis(500));
    window.harness.run_steps(2);
    window.click("mirror");
    for value in ["0.1", "0.2", "0.4"] {
        window.type_into("diffuse value", value);
    }
    press(&mut window, Key::Z, Modifiers::COMMAND, 3);
    let diffuse = window.app().document().scene().materials[1].diffuse;
    assert_eq!(diffuse.0[0], 0.3, "three steps back");
}
