//! The window's close button: unsaved work is asked about, and nothing else is.

use eframe::egui::Key;

use super::edits::drag_diffuse;
use super::{COMMENTED, Desk};

impl Desk {
    /// Presses the close button.
    fn ask_to_close(&self) {
        self.server.ask_to_close(self.server.window().expect("the window shows"));
    }
}

#[test]
fn without_unsaved_work_it_closes() {
    let (mut desk, _) = Desk::with_scene();
    desk.ask_to_close();
    assert_eq!(desk.until_ended().code(), Some(0));
    assert_eq!(desk.messages(), "");
    let log = std::fs::read_to_string(desk.file("state/rayforest/rayforest.log")).unwrap();
    for part in ["INFO  Rayforest ", "the window is drawn by ", "INFO  Rayforest ends"] {
        assert!(log.contains(part), "`{part}` is missing: {log}");
    }
}

#[test]
fn unsaved_work_is_asked_about() {
    let (mut desk, mut twin) = Desk::with_scene();
    drag_diffuse(&mut desk, &mut twin);
    desk.until("the work is kept", |desk| !desk.kept_work().is_empty());
    // the same question as before another scene is opened
    twin.press_ctrl(Key::O);
    for answer in ["Cancel", "Do not save"] {
        let button = twin.place(answer).center();
        desk.ask_to_close();
        desk.until_like(&mut twin, "the question shows");
        desk.click(button);
        if answer == "Cancel" {
            twin.click(button);
            let button = twin.place("1:1");
            desk.until_part_like(&mut twin, button, "the window stays");
            desk.rest(&mut twin);
            twin.press_ctrl(Key::O);
        }
    }
    assert_eq!(desk.until_ended().code(), Some(0));
    assert_eq!(desk.scene_text(), COMMENTED);
    assert!(desk.kept_work().is_empty(), "work that was given up is not offered again");
}

#[test]
fn the_question_saves_before_it_closes() {
    let (mut desk, mut twin) = Desk::with_scene();
    drag_diffuse(&mut desk, &mut twin);
    twin.press_ctrl(Key::O);
    desk.press("ctrl+q");
    desk.until_like(&mut twin, "the question shows");
    // The first answer has the keyboard.
    desk.press("Return");
    assert_eq!(desk.until_ended().code(), Some(0));
    assert_ne!(desk.scene_text(), COMMENTED);
    assert!(desk.kept_work().is_empty());
}
