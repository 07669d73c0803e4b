//! Drivers that are missing: the window opens all the same and shows the same picture.

use super::Desk;
use super::twin::Twin;

/// Opens the window with drivers hidden by `variables`.
fn opens_with(variables: &[(&'static str, &'static str)]) {
    let mut desk = Desk::new(super::SIZE);
    desk.variables = variables.to_vec();
    desk.start();
    let mut twin = Twin::new(&desk.file("scene.toml"), None);
    desk.show_one_to_one(&mut twin);
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
