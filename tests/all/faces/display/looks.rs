//! Looks, the wipe and snapshots on a real display, by keys and pointer.

use eframe::egui::accesskit::Role;
use eframe::egui::{Key, Pos2, Rect, pos2, vec2};

use super::twin::Twin;
use super::{COMMENTED, Desk, SIZE, TOLERANCE};

const NIGHT: &str = "
[looks.night]
lights.key.intensity = 0.2
materials.mirror.color = [0.9, 0.5, 0.3]
";

/// Where the pointer rests, since the strip takes the place below.
const ABOVE: Pos2 = Pos2::new(90.0, 420.0);

/// A desk and its twin with the strip of looks open.
fn with_strip() -> (Desk, Twin) {
    let mut desk = Desk::new(SIZE);
    std::fs::write(desk.file("scene.toml"), format!("{COMMENTED}{NIGHT}")).unwrap();
    desk.start();
    let mut twin = Twin::new(&desk.file("scene.toml"), None);
    desk.show_one_to_one(&mut twin);
    twin.press(Key::K);
    desk.press("k");
    let card = twin.place("look night");
    desk.until_part_like(&mut twin, card, "the strip shows the look and its thumbnail");
    rest(&mut desk, &mut twin);
    (desk, twin)
}

fn rest(desk: &mut Desk, twin: &mut Twin) {
    twin.hover(ABOVE);
    desk.point(ABOVE);
    desk.until_like(twin, "the pointer rests");
}

/// Clicks a card on the desk and on its twin, and waits until both show the same.
fn click(desk: &mut Desk, twin: &mut Twin, name: &str) {
    // Its caption lights up, its thumbnail does not.
    let at = twin.place(name).left_bottom() + vec2(16.0, -10.0);
    twin.click(at);
    desk.click(at);
    twin.until_exact();
    rest(desk, twin);
}

#[test]
fn a_look_is_put_on_and_wiped_against_what_was_saved() {
    let (mut desk, mut twin) = with_strip();
    let picture = twin.rect(Role::Image, "picture");
    let plain = desk.server.shot();
    click(&mut desk, &mut twin, "look night");
    let night = desk.server.shot();
    let changed = plain.differences(&night, picture, &[], TOLERANCE).len();
    assert!(changed > 10_000, "{changed} pixels of the picture changed");

    twin.press(Key::W);
    desk.press("w");
    let tag = twin.place("as saved | now");
    desk.until_part_like(&mut twin, tag, "the comparison begins");
    let from = twin.place("wipe").center();
    let to = pos2(from.x + 80.0, from.y);
    twin.drag(from, to);
    desk.drag(from, to);
    rest(&mut desk, &mut twin);
    let wiped = desk.server.shot();
    // Below the names of the sides, and beside the line.
    let rows = picture.center().y..=picture.center().y + 60.0;
    let saved = Rect::from_x_y_ranges(picture.left()..=to.x - 10.0, rows.clone());
    let worn = Rect::from_x_y_ranges(to.x + 10.0..=picture.right(), rows);
    assert!(wiped.differences(&plain, saved, &[], 0).is_empty(), "left of it as saved");
    assert!(wiped.differences(&night, worn, &[], 0).is_empty(), "right of it as it is worn");
    assert!(!wiped.differences(&night, saved, &[], TOLERANCE).is_empty());
}

#[test]
fn a_snapshot_brings_a_look_back_that_was_taken_off() {
    let (mut desk, mut twin) = with_strip();
    let picture = twin.rect(Role::Image, "picture");
    click(&mut desk, &mut twin, "look night");
    let night = desk.server.shot();
    twin.press(Key::S);
    desk.press("s");
    let card = twin.place("snapshot 1");
    desk.until_part_like(&mut twin, card, "the snapshot is in the strip");
    click(&mut desk, &mut twin, "no look");
    assert!(!desk.server.shot().differences(&night, picture, &[], TOLERANCE).is_empty());
    click(&mut desk, &mut twin, "snapshot 1");
    // A notice tells of the snapshot at the lower edge.
    let mut upper = picture;
    *upper.bottom_mut() = picture.center().y;
    assert!(desk.server.shot().differences(&night, upper, &[], 0).is_empty());
}
