//! What a report of a fault needs.

use eframe::egui::OutputCommand;

use super::*;
use crate::faces::SCENE;

impl Window {
    /// Presses a button and gives what it puts on the clipboard.
    fn copied_by(&mut self, name: &str) -> String {
        let at = self.settled(name);
        self.harness.event(Event::PointerMoved(at));
        for pressed in [true, false] {
            let (button, modifiers) = (PointerButton::Primary, Modifiers::NONE);
            self.harness.event(Event::PointerButton { pos: at, button, pressed, modifiers });
        }
        for _ in 0..5 {
            self.harness.step();
            for command in &self.harness.output().platform_output.commands {
                if let OutputCommand::CopyText(text) = command {
                    return text.clone();
                }
            }
        }
        panic!("nothing was copied")
    }
}

#[test]
fn diagnostics_hold_the_machine_and_the_log_and_nothing_of_the_scene() {
    let mut window = Window::with_scene(SCENE, Vec::new());
    std::fs::create_dir_all(window.file("log")).unwrap();
    let lines: Vec<String> = (0..100).map(|number| format!("line {number} of the log")).collect();
    std::fs::write(window.file("log/rayforest.log"), lines.join("\n")).unwrap();
    window.click("Help");
    let text = window.copied_by("Copy diagnostics");
    window.until_text("lines: paste them into your report");
    assert!(text.starts_with(concat!("Rayforest ", env!("CARGO_PKG_VERSION"))), "{text}");
    for part in ["MB of memory", "settings: theme system, zoom 100 %", "picture 48×27", "cache in "]
    {
        assert!(text.contains(part), "`{part}` is missing: {text}");
    }
    assert!(text.trim_end().ends_with("line 99 of the log"), "{text}");
    assert!(!text.contains("line 59 of") && text.contains("line 60 of"), "{text}");
    for secret in ["mirror", "tiles", "scene.toml"] {
        assert!(!text.contains(secret), "{text}");
    }
}

#[test]
fn the_log_folder_is_named_where_nobody_can_show_it() {
    let mut window = Window::with_scene(SCENE, Vec::new());
    window.menu(&["Help", "Show log folder"]);
    window.until_text(&window.file("log/rayforest.log").display().to_string());
}

#[test]
fn settings_that_cannot_be_read_are_set_aside_and_said() {
    let folder = tempfile::tempdir().unwrap();
    let config = folder.path().join("config");
    std::fs::create_dir(&config).unwrap();
    std::fs::write(config.join("settings.toml"), "theme = 7").unwrap();
    let mut window = Window::in_folder(folder, None, Vec::new());
    window.until_text(&format!("kept as {}", config.join("settings.toml.bad").display()));
    assert_eq!(std::fs::read_to_string(config.join("settings.toml.bad")).unwrap(), "theme = 7");
    window.key(Modifiers::NONE, Key::Escape);
    window.click("Close");
    // A second bad one takes another name.
    let folder = window.folder.path().to_owned();
    std::fs::write(config.join("settings.toml"), "theme = 8").unwrap();
    let copy = tempfile::tempdir().unwrap();
    std::fs::create_dir(copy.path().join("config")).unwrap();
    for name in ["settings.toml", "settings.toml.bad"] {
        std::fs::copy(folder.join("config").join(name), copy.path().join("config").join(name))
            .unwrap();
    }
    let mut window = Window::in_folder(copy, None, Vec::new());
    window.until_text("settings.toml.bad2");
    assert_eq!(
        std::fs::read_to_string(window.file("config/settings.toml.bad")).unwrap(),
        "theme = 7"
    );
}
