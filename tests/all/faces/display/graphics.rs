//! Drivers that are missing: the window opens all the same and shows the same picture.

use super::Desk;
use super::edits::show_one_to_one;
use super::server::Shot;
use super::twin::Twin;

/// Opens the window with drivers hidden by `variables`.
fn opens_with(variables: &[(&'static str, &'static str)]) {
    let mut desk = Desk::new(super::SIZE);
    desk.variables = variables.to_vec();
    desk.start();
    let mut twin = Twin::new(&desk.file("scene.toml"), None);
    let blank = Shot { size: [1280, 720], pixels: vec![[0; 3]; 1280 * 720] };
    desk.until_changed(&blank, twin.place("1:1"), "the window draws");
    // an enlarged picture is rounded to the screen's pixels by the driver, this one is not
    show_one_to_one(&mut desk, &mut twin);
    assert_eq!(desk.messages(), "", "{variables:?}");
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
