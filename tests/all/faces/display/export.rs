//! Exports where no dialog service answers: by the program's own path field.

use eframe::egui::accesskit::Role;
use eframe::egui::{Key, vec2};

use super::edits::drag_diffuse;
use super::{Desk, rendered};
use crate::faces::decode_png;

#[test]
fn a_picture_is_exported_through_the_path_field() {
    let (mut desk, mut twin) = Desk::with_scene();
    drag_diffuse(&mut desk, &mut twin);
    desk.press("ctrl+s");
    desk.until("the scene is saved", |desk| desk.scene_text() != super::COMMENTED);
    twin.press_ctrl(Key::E);
    let button = twin.rect(Role::Button, "Choose file…");
    desk.press("ctrl+e");
    desk.until_part_like(&mut twin, button, "the export's question shows");
    // The button has the keyboard, although a slider had it before.
    desk.press("Return");
    twin.press(Key::Enter);
    let field = twin.rect(Role::TextInput, "file path");
    let heading = twin.place("Export the picture");
    desk.until_part_like(&mut twin, heading, "the path field shows");
    let start = field.left_center() + vec2(20.0, 0.0);
    desk.watched(start, "the path is selected", |desk| desk.press("ctrl+a"));
    desk.server.xdotool(&["type", &desk.file("typed.png").display().to_string()]);
    desk.press("Return");
    desk.until("the picture is written", |desk| desk.file("typed.png").exists());
    let (size, bits, bytes) = decode_png(&desk.file("typed.png")).unwrap();
    assert_eq!((size, bits), ([320, 180], 8));
    assert!(bytes == rendered(desk.folder.path(), "scene.toml"), "export and render differ");
}
