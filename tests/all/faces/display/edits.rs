//! A slider dragged by the pointer: what changes on the screen, and what does not.

use eframe::egui::accesskit::Role;
use eframe::egui::{Pos2, Rect};

use super::server::Shot;
use super::twin::Twin;
use super::{Desk, REST, SIZE, status_line};

/// The middle of the handle of a slider from 0 to 1 when it stands at a value.
pub(super) fn handle(twin: &Twin, name: &str, value: f64) -> Pos2 {
    let rect = twin.rect(Role::Slider, name);
    let path = rect.shrink(rect.height() / 2.5);
    Pos2::new(path.left() + path.width() * value as f32, rect.center().y)
}

/// The row of a slider across the inspector.
fn row(twin: &Twin, name: &str) -> Rect {
    let inspector = twin.rect(Role::Image, "picture").right();
    let rows = twin.rect(Role::Slider, name).y_range();
    Rect::from_x_y_ranges(inspector..=f32::from(SIZE[0]), rows)
}

/// The document's name at the edge of the menu bar. A letter may stand out by part of a pixel.
fn title(twin: &Twin, text: &str) -> Rect {
    twin.place(text).expand(1.0)
}

/// Selects the mirror and drags its diffuse slider, on the desk and on its twin. Gives the screens
/// before and after, and all places where they may differ.
pub(super) fn drag_diffuse(desk: &mut Desk, twin: &mut Twin) -> (Shot, Shot, Vec<Rect>) {
    let material = twin.rect(Role::Button, "mirror").center();
    twin.click(material);
    desk.click(material);
    let heading = twin.place("Material mirror");
    desk.until_part_like(twin, heading, "the material is selected");
    desk.rest(twin);
    let before = desk.server.shot();
    let mut places = vec![twin.rect(Role::Image, "picture"), status_line()];
    places.extend([twin.place("Undo"), title(twin, "scene.toml")]);
    places.push(row(twin, "diffuse"));
    let (from, to) = (handle(twin, "diffuse", 0.3), handle(twin, "diffuse", 0.8));
    twin.drag(from, to);
    twin.until_exact();
    twin.hover(REST);
    places.push(title(twin, "scene.toml •"));
    desk.drag(from, to);
    desk.until_like(twin, "the picture shows the edit");
    (before, desk.server.shot(), places)
}

#[test]
fn a_dragged_slider_changes_the_picture_its_row_the_status_and_the_marks_alone() {
    let (mut desk, mut twin) = Desk::with_scene();
    let (before, after, places) = drag_diffuse(&mut desk, &mut twin);
    // The scroll bar of the inspector shows while the pointer is over it, and fades.
    let [width, height] = SIZE.map(f32::from);
    let bar = Rect::from_x_y_ranges(width - 16.0..=width, 30.0..=height - 30.0);
    let apart = [places.as_slice(), &[bar]].concat();
    let elsewhere = before.differences(&after, before.all(), &apart, 0);
    if !elsewhere.is_empty() {
        let (a, b) = (before.keep("display-before"), after.keep("display-after"));
        panic!("{} and {} differ at {:?} …", a.display(), b.display(), elsewhere[0]);
    }
    for place in &places {
        let changed = before.differences(&after, *place, &[], 0);
        assert!(!changed.is_empty(), "nothing changed in {place:?}");
    }
    let undo = twin.app().document().undo_name().expect("a step").to_owned();
    assert!(undo.starts_with("diffuse of mirror 0.3 → "), "{undo}");

    desk.press("ctrl+z");
    desk.until("undo gives back the same picture", |desk| {
        desk.server.shot().differences(&before, places[0], &[], 0).is_empty()
    });
}

#[test]
fn at_one_to_one_the_screen_shows_the_bytes_of_the_picture() {
    let (desk, twin) = Desk::with_scene();
    let shot = desk.server.shot();
    let view = twin.rect(Role::Image, "picture");
    let bytes = super::rendered(desk.folder.path(), "scene.toml");
    let wanted: Vec<[u8; 3]> = bytes.as_chunks::<3>().0.to_vec();
    let [left, top] = [view.center().x - 160.0, view.center().y - 90.0].map(|v| v.round() as usize);
    let row = |y: usize| &shot.pixels[(top + y) * shot.size[0] + left..][..320];
    for y in 0..180 {
        assert!(row(y) == &wanted[y * 320..][..320], "row {y} of the picture");
    }
}
