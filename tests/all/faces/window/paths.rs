//! The window's own way to name a file, for when the system offers no dialog.

use super::*;
use crate::faces::SCENE;

/// A window whose system never has a dialog.
fn alone() -> Window {
    Window::with_scene(SCENE, vec![Answer::NoService; 8])
}

impl Window {
    /// Replaces what the path field holds.
    fn type_path(&mut self, path: &Path) {
        self.until_text("The system offers no file dialog here");
        self.key(Modifiers::COMMAND, Key::A);
        self.write(path.to_str().unwrap());
    }
}

#[test]
fn a_path_is_typed_and_an_existing_file_is_asked_for_twice() {
    let mut window = alone();
    window.click("mirror");
    window.drag_slider("diffuse", 0.9);
    let taken = window.file("taken.toml");
    std::fs::write(&taken, "not mine").unwrap();
    window.key(Modifiers::COMMAND | Modifiers::SHIFT, Key::S);
    window.type_path(&window.file("taken"));
    window.key(Modifiers::NONE, Key::Enter);
    window.until_text("exists: press again to replace it");
    assert_eq!(std::fs::read_to_string(&taken).unwrap(), "not mine");
    window.key(Modifiers::NONE, Key::Enter);
    window.until("it is saved", |app| app.document().path() == Some(&taken));
    assert!(std::fs::read_to_string(&taken).unwrap().contains("version = 1"));
    assert_eq!(std::fs::read_to_string(window.file("taken.toml~")).unwrap(), "not mine");
}

#[test]
fn leaving_the_path_goes_back_to_the_form_as_it_was() {
    let mut window = alone();
    for key in [None, Some(Key::Escape)] {
        window.key(Modifiers::COMMAND, Key::E);
        window.click("OpenEXR");
        window.click("Choose file…");
        window.until_text("The system offers no file dialog here");
        match key {
            Some(key) => window.key(Modifiers::NONE, key),
            None => window.click("Cancel"),
        }
        window.until_text("without exposure and tone");
        window.key(Modifiers::NONE, Key::Escape);
        assert!(!window.shows("Export the picture"));
    }
}

#[test]
fn a_path_is_typed_or_chosen_to_open() {
    let mut window = alone();
    let other = window.file("folder/other.toml");
    std::fs::create_dir(window.file("folder")).unwrap();
    std::fs::write(&other, SCENE).unwrap();
    std::fs::write(window.file("folder/notes.txt"), "").unwrap();
    window.key(Modifiers::COMMAND, Key::O);
    window.type_path(&other);
    window.key(Modifiers::NONE, Key::Enter);
    window.until("the typed file", |app| app.document().path() == Some(&other));

    window.key(Modifiers::COMMAND, Key::O);
    window.until_button("other.toml");
    assert!(!window.shows("notes.txt"), "only scenes are listed");
    window.click("../");
    window.until_button("folder/");
    window.click("scene.toml");
    window.click("Open");
    let scene = window.file("scene.toml");
    window.until("the chosen file", |app| app.document().path() == Some(&scene));

    window.key(Modifiers::COMMAND, Key::O);
    window.until_text("The system offers no file dialog here");
    window.click("Cancel");
    assert!(!window.shows("The system offers no file dialog here"));
    assert_eq!(window.app().document().path(), Some(&*scene));
}
