//! Drivers that are missing, chosen, or fail: the window opens all the same and shows the same picture.

use eframe::egui::Rect;
use eframe::egui::accesskit::Role;

use super::Desk;
use super::twin::Twin;

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

#[test]
fn a_window_whose_graphics_card_is_lost_opens_again_by_itself() {
    let mut desk = Desk::new(super::SIZE);
    desk.arguments = vec!["--renderer", "gpu", "--lose-graphics", "3"];
    desk.start();
    let first = desk.server.window();
    let second = desk.show_window(first);
    assert_ne!(Some(second), first);
    let mut twin = Twin::new(&desk.file("scene.toml"), None);
    let button = twin.place("1:1");
    desk.until_part_like(&mut twin, button, "the second window draws");
    twin.click(button.center());
    desk.click(button.center());
    // It tells what happened at the lower edge, far from the small picture.
    let middle = twin.rect(Role::Image, "picture").center();
    let around = Rect::from_center_size(middle, [340.0, 200.0].into());
    desk.until_part_like(&mut twin, around, "the picture is there again");
    assert_eq!(desk.messages(), "");
}
