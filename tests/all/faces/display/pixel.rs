//! A pixel's ray tree on a real display: a step into a reflection, and an edit of what is found there.

use eframe::egui::accesskit::Role;
use eframe::egui::{Key, vec2};

use super::edits::handle;
use super::{Desk, REST};

/// The floor in the lower part of the ball, by both samples.
const REFLECTION: &str = "reflection → floor (tiles) ×2";

#[test]
fn a_reflection_is_stepped_into_and_the_material_there_is_edited() {
    let (mut desk, mut twin) = Desk::with_scene();
    twin.press(Key::I);
    desk.press("i");
    let text = twin.place("Click a pixel of the picture: its ray tree shows here");
    desk.until_part_like(&mut twin, text, "the panel opens");

    let at = twin.rect(Role::Image, "picture").center() + vec2(0.0, 20.0);
    twin.click(at);
    desk.point(at);
    // the picture does not light up
    desk.server.xdotool(&["mousedown", "1", "mouseup", "1"]);
    let line = twin.place(REFLECTION);
    desk.until_part_like(&mut twin, line, "the tree shows");
    desk.rest(&mut twin);

    let unmarked = desk.server.shot();
    let row = twin.rect(Role::Button, REFLECTION).center();
    twin.click(row);
    desk.click(row);
    let heading = twin.place("Material tiles");
    desk.until_part_like(&mut twin, heading, "the material in the reflection is selected");
    // the pointer of the twin goes away with the click
    twin.hover(row);
    let picture = twin.rect(Role::Image, "picture");
    desk.until_part_like(&mut twin, picture, "the way to it is marked in the picture");
    assert!(!desk.server.shot().differences(&unmarked, picture, &[], 0).is_empty());
    desk.rest(&mut twin);

    let before = desk.server.shot();
    let (from, to) = (handle(&twin, "diffuse", DIFFUSE), handle(&twin, "diffuse", 0.2));
    twin.drag(from, to);
    twin.until_exact();
    twin.hover(REST);
    desk.drag(from, to);
    desk.until_like(&mut twin, "the picture and the numbers show the edit");
    let values = twin.place("linear").translate(vec2(60.0, 0.0));
    let changed = desk.server.shot().differences(&before, values, &[], 0);
    assert!(!changed.is_empty(), "the pixel's numbers follow");
}

/// Of a material that does not say.
const DIFFUSE: f64 = 0.7;
