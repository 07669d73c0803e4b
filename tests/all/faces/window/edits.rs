//! Edits in the window: exact, instant where the badge says so, and taken back whole.

use super::*;
use crate::faces::SCENE;

#[test]
fn a_dragged_slider_changes_the_picture_without_a_ray() {
    let mut window = Window::with_scene(SCENE, Vec::new());
    let before = window.picture();
    window.click("mirror");
    window.drag_slider("diffuse", 0.9);
    window.until_exact();
    let after = window.picture();
    assert_ne!(before, after);
    window.until_text("· 0 rays");
    let undo = window.app().document().undo_name().expect("a step").to_owned();
    assert!(undo.starts_with("diffuse of mirror 0.3 → "), "{undo}");

    window.click("Undo");
    window.until_exact();
    assert!(window.picture() == before, "undo gives back the same bytes");
    window.click("Redo");
    window.until_exact();
    assert!(window.picture() == after, "redo too");
}
