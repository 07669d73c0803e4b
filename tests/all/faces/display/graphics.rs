//! Drivers that are missing, chosen, or fail: the window opens all the same and shows the same picture.

use eframe::egui::{Key, Pos2, Rect};

use super::edits::drag_diffuse;
use super::twin::Twin;
use super::{Desk, REST, TOLERANCE, status_line};

/// Opens the window with drivers hidden by `variables`.
fn opens_with(variables: &[(&'static str, &'static str)]) {
    let mut desk = Desk::new(super::SIZE);
    desk.variables = variables.to_vec();
    shows(desk);
}

/// Holds the window to its twin, whose picture is the processor's.
fn shows(mut desk: Desk) {
    desk.start();
    let mut twin = Twin::new(&desk.file("scene.toml"), None);
    desk.show_one_to_one(&mut twin);
    assert_eq!(desk.messages(), "", "{:?} {:?}", desk.variables, desk.arguments);
}

const NO_VULKAN: [(&str, &str); 2] =
    [("VK_ICD_FILENAMES", "/nonexistent"), ("VK_DRIVER_FILES", "/nonexistent")];

#[test]
fn without_vulkan_it_draws_by_opengl() {
    opens_with(&NO_VULKAN);
}

#[test]
fn without_anything_for_wgpu_it_draws_by_opengl_itself() {
    opens_with(&[NO_VULKAN[0], NO_VULKAN[1], ("WGPU_BACKEND", "vulkan")]);
}

#[test]
fn every_renderer_shows_the_same_picture() {
    for renderer in ["gpu", "cpu", "glow"] {
        let mut desk = Desk::new(super::SIZE);
        desk.arguments = vec!["--renderer", renderer];
        shows(desk);
    }
}

/// A desk where the graphics card draws the picture, and its twin, where the processor does.
fn drawn_by_the_card() -> (Desk, Twin) {
    let mut desk = Desk::new(super::SIZE);
    desk.arguments = vec!["--renderer", "gpu", "--lose-graphics", "lost"];
    desk.start();
    let mut twin = Twin::new(&desk.file("scene.toml"), None);
    desk.show_one_to_one(&mut twin);
    (desk, twin)
}

#[test]
fn the_cards_picture_follows_a_dragged_slider_and_is_taken_back() {
    let (mut desk, mut twin) = drawn_by_the_card();
    let (before, after, places) = drag_diffuse(&mut desk, &mut twin);
    assert!(!before.differences(&after, places[0], &[], TOLERANCE).is_empty());
    desk.press("ctrl+z");
    desk.until("undo gives back the same picture", |desk| {
        desk.server.shot().differences(&before, places[0], &[], 0).is_empty()
    });
}

#[test]
fn a_window_whose_graphics_card_is_lost_opens_again_with_all_that_was_done() {
    let (mut desk, mut twin) = drawn_by_the_card();
    let first = desk.server.window();
    drag_diffuse(&mut desk, &mut twin);
    std::fs::write(desk.file("lost"), "").unwrap();
    let second = desk.show_window(first);
    assert_ne!(Some(second), first);
    // No widget of the new window has the keyboard yet.
    twin.press(Key::Escape);
    // It tells what happened at the picture's lower edge; all else is as it was.
    let mut upper = Rect::from_min_max(Pos2::ZERO, status_line().right_top());
    *upper.bottom_mut() -= 80.0;
    desk.until_part_like(&mut twin, upper, "everything is there again");
    let told = Rect::from_min_max(Pos2::new(200.0, 640.0), Pos2::new(500.0, 680.0));
    let calm = twin.shot();
    let told = desk.server.shot().differences(&calm, told, &[], TOLERANCE);
    assert!(told.len() > 100, "a notice of {} pixels", told.len());
    // The new window is alive: the edit is taken back in it.
    desk.press("ctrl+z");
    twin.press_ctrl(Key::Z);
    twin.until_exact();
    twin.hover(REST);
    desk.until_part_like(&mut twin, upper, "the edit is taken back");
    // If its card is lost too, OpenGL draws.
    std::fs::write(desk.file("lost"), "").unwrap();
    let third = desk.show_window(Some(second));
    assert_ne!(third, second);
    desk.until_part_like(&mut twin, upper, "everything is there once more");
    assert_eq!(desk.messages(), "");
}

#[test]
fn a_card_that_is_lost_in_the_middle_of_a_turn_costs_no_work_either() {
    let (mut desk, mut twin) = drawn_by_the_card();
    let first = desk.server.window();
    drag_diffuse(&mut desk, &mut twin);
    // What draws the window panics.
    desk.panics = true;
    let (lost, begun) = (desk.file("lost"), desk.file("begun"));
    std::fs::write(&begun, "late").unwrap();
    std::fs::rename(begun, lost).unwrap();
    desk.show_window(first);
    twin.press(Key::Escape);
    let mut upper = Rect::from_min_max(Pos2::ZERO, status_line().right_top());
    *upper.bottom_mut() -= 80.0;
    desk.until_part_like(&mut twin, upper, "everything is there again");
    assert!(desk.messages().contains("panicked"), "it was in the middle: {}", desk.messages());
}
