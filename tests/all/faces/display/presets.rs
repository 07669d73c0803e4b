//! Presets on a real display: one is clicked, and one is dropped on a solid.

use eframe::egui::accesskit::Role;
use eframe::egui::{Pos2, Rect, vec2};

use super::twin::Twin;
use super::{Desk, TOLERANCE};

/// A desk and its twin with the mirror's presets open.
fn with_presets() -> (Desk, Twin) {
    let (mut desk, mut twin) = Desk::with_scene();
    for name in ["mirror", "Presets"] {
        let at = match name {
            "mirror" => twin.rect(Role::Button, name).center(),
            _ => twin.place(name).center(),
        };
        twin.click(at);
        desk.click(at);
        desk.rest(&mut twin);
    }
    (desk, twin)
}

/// Points at a preset, and waits for its frame.
fn point_at(desk: &mut Desk, preset: Rect) {
    let before = desk.server.shot();
    desk.point(preset.center());
    desk.until_changed(&before, preset, "it lights up");
}

/// Where the ball is in the picture.
fn ball(twin: &Twin) -> Pos2 {
    twin.rect(Role::Image, "picture").center()
}

#[test]
fn a_preset_is_clicked_and_taken_back() {
    let (mut desk, mut twin) = with_presets();
    let plain = desk.server.shot();
    let picture = twin.rect(Role::Image, "picture");
    let copper = twin.rect(Role::Button, "preset copper");
    point_at(&mut desk, copper);
    desk.server.xdotool(&["mousedown", "1", "mouseup", "1"]);
    twin.click(copper.center());
    twin.until_exact();
    desk.rest(&mut twin);
    let changed = desk.server.shot().differences(&plain, picture, &[], TOLERANCE).len();
    assert!(changed > 500, "{changed} pixels of the ball changed");
    desk.press("ctrl+z");
    desk.until("undo gives back the same picture", |desk| {
        desk.server.shot().differences(&plain, picture, &[], 0).is_empty()
    });
}

#[test]
fn a_preset_is_dropped_on_a_solid() {
    let (mut desk, mut twin) = with_presets();
    let (gold, to) = (twin.rect(Role::Button, "preset gold"), ball(&twin));
    point_at(&mut desk, gold);
    let lit = desk.server.shot();
    desk.server.xdotool(&["mousedown", "1"]);
    desk.until_changed(&lit, gold, "it is held");
    desk.point(to);
    let around = Rect::from_center_size(to, vec2(60.0, 60.0));
    desk.until_changed(&lit, around, "the solid below it is outlined");
    desk.server.xdotool(&["mouseup", "1"]);
    twin.drag(gold.center(), to);
    twin.until_exact();
    assert!(twin.app().document().scene().materials.iter().any(|m| m.name == "gold"));
    desk.rest(&mut twin);
}
