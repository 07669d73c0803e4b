//! The palette of all commands, and the list of keys.

use super::*;
use crate::faces::SCENE;

impl Window {
    fn find(&mut self, text: &str) {
        self.key(Modifiers::COMMAND, Key::K);
        if !text.is_empty() {
            self.write(text);
        }
        self.harness.run_steps(3);
    }

    fn palette_is_open(&self) -> bool {
        self.harness.query_by_role_and_label(Role::TextInput, "find a command").is_some()
    }
}

#[test]
fn a_few_letters_and_enter_do_a_command() {
    let mut window = Window::with_scene(SCENE, Vec::new());
    assert!(!window.shows("Solo") && !window.palette_is_open());
    let before = window.rect(Role::Image, "picture");
    window.find("ltmx");
    assert!(window.palette_is_open() && window.shows("All lights side by side"));
    window.key(Modifiers::NONE, Key::Enter);
    assert!(!window.palette_is_open());
    assert!(window.rect(Role::Image, "picture").height() < before.height(), "the mixer is open");

    window.find("dark");
    window.key(Modifiers::NONE, Key::Enter);
    assert_eq!(window.harness.ctx.theme(), eframe::egui::Theme::Dark);
}

#[test]
fn arrows_choose_and_escape_leaves_without_a_command() {
    let mut window = Window::with_scene(SCENE, Vec::new());
    window.find("zoom");
    assert!(window.shows("Enlarges the picture"));
    window.key(Modifiers::NONE, Key::ArrowDown);
    assert!(window.shows("Shrinks the picture"));
    window.key(Modifiers::NONE, Key::ArrowDown);
    assert!(window.shows("Shrinks the picture"), "the last one");
    window.key(Modifiers::NONE, Key::ArrowUp);
    let fit = window.place();
    window.key(Modifiers::NONE, Key::Escape);
    assert!(!window.palette_is_open());
    assert_eq!(window.place(), fit);
    window.find("zoom");
    window.key(Modifiers::NONE, Key::ArrowDown);
    window.key(Modifiers::NONE, Key::Enter);
    assert!(window.place().width() < fit.width(), "zoomed out");
    // Letters are no shortcuts while the palette is open.
    window.find("c");
    window.key(Modifiers::NONE, Key::Escape);
    let camera = window.harness.get_by_role_and_label(Role::Button, "Move camera");
    assert_ne!(camera.accesskit_node().toggled(), Some(eframe::egui::accesskit::Toggled::True));
}

#[test]
fn what_cannot_be_done_says_why() {
    let mut window = Window::with_scene(SCENE, Vec::new());
    window.find("redo");
    assert!(window.shows("Nothing was taken back"));
    window.key(Modifiers::NONE, Key::Enter);
    assert!(window.palette_is_open(), "it stays");
    window.key(Modifiers::NONE, Key::Escape);
    window.find("open recent: sc");
    assert!(window.shows("Open recent: scene.toml"));
    window.key(Modifiers::NONE, Key::Escape);
    window.find("qqq");
    assert!(window.shows("No command has these letters"));
}

#[test]
fn a_question_mark_lists_keys_and_gestures() {
    let mut window = Window::with_scene(SCENE, Vec::new());
    window.key(Modifiers::NONE, Key::Questionmark);
    window.harness.run_steps(3);
    for text in ["Keys and gestures", "Take a snapshot", "Ctrl+Shift+S", "Alt-click"] {
        assert!(window.shows(text), "{text} in {:#?}", window.texts());
    }
    window.click("Close");
    assert!(!window.shows("Alt-click"));
    window.menu(&["Help", "Keys and gestures"]);
    assert!(window.shows("Alt-click"));
    window.key(Modifiers::NONE, Key::Escape);
    assert!(!window.shows("Alt-click"));
}

/// A long turn brings all keys at once.
#[test]
fn what_is_typed_before_the_palette_shows_is_not_lost() {
    let mut window = Window::with_scene(SCENE, Vec::new());
    let scene = window.app().document().scene().clone();
    let key = |key, modifiers, pressed| Event::Key {
        key,
        physical_key: None,
        pressed,
        repeat: false,
        modifiers,
    };
    let mut events = vec![key(Key::K, Modifiers::COMMAND, true)];
    for (letter, k) in "speed".chars().zip([Key::S, Key::P, Key::E, Key::E, Key::D]) {
        events.push(key(k, Modifiers::NONE, true));
        events.push(Event::Text(letter.to_string()));
        events.push(key(k, Modifiers::NONE, false));
    }
    events.push(key(Key::Enter, Modifiers::NONE, true));
    window.harness.input_mut().events.append(&mut events);
    window.harness.run_steps(4);
    assert!(!window.palette_is_open() && window.shows("Measure"), "the chart is open");
    assert!(*window.app().document().scene() == scene && !window.shows("snapshot 1"));
    window.find("");
    window.write("zoom");
    window.key(Modifiers::NONE, Key::Enter);
    assert!(!window.palette_is_open(), "typed one turn later");
}

#[test]
fn enter_alone_chooses_nothing() {
    let mut window = Window::with_scene(SCENE, Vec::new());
    window.find("");
    window.key(Modifiers::NONE, Key::Enter);
    assert!(window.palette_is_open());
    assert_eq!(window.app().document().title(), "scene.toml");
    window.key(Modifiers::NONE, Key::ArrowDown);
    window.key(Modifiers::NONE, Key::Enter);
    assert!(!window.palette_is_open(), "arrows choose");
}
