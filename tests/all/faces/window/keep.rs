//! What was traced is kept by a menu item and opened again; a file that does not fit is told.

use super::*;
use crate::faces::SCENE;
use rayforest::session::cache::path_of;

/// A window on the scene file that is in a folder, its picture exact.
fn reopened(folder: tempfile::TempDir) -> Window {
    let path = folder.path().join("scene.toml");
    let mut window = Window::in_folder(folder, Some(path.clone()), Vec::new());
    window.until("the scene is open", |app| app.document().path() == Some(&path));
    window.until_exact();
    window
}

/// The folder of a window that is closed.
fn closed(window: Window) -> tempfile::TempDir {
    let Window { harness, folder } = window;
    drop(harness);
    folder
}

fn keep(window: &mut Window) {
    window.menu(&["File", "Keep traced"]);
    window.until_text("kept traced in scene.rayforest-cache");
}

#[test]
fn what_was_kept_is_opened_again() {
    let mut window = Window::with_scene(SCENE, Vec::new());
    assert!(!window.shows("opened from what was kept"));
    keep(&mut window);
    let (picture, kept) = (window.picture(), path_of(&window.file("scene.toml")));
    assert!(kept.is_file());
    let mut window = reopened(closed(window));
    window.until_text("opened from what was kept · ");
    assert!(window.shows("· 0 rays") && window.picture() == picture);
    // A change that was saved since is an edit.
    window.click("mirror");
    window.type_into("diffuse value", "0.75");
    window.until_exact();
    window.save();
    let mut window = reopened(closed(window));
    window.until_text("opened from what was kept · ");
    assert!(window.shows("· 0 rays") && window.picture() != picture);
    assert!(rgb(&window.picture()) == rendered(window.folder.path(), "scene.toml"));
}

#[test]
fn a_damaged_file_is_told_and_the_scene_is_traced() {
    let mut window = Window::with_scene(SCENE, Vec::new());
    keep(&mut window);
    let (picture, kept) = (window.picture(), path_of(&window.file("scene.toml")));
    let mut bytes = std::fs::read(&kept).unwrap();
    bytes.truncate(bytes.len() - 5);
    std::fs::write(&kept, bytes).unwrap();
    let mut window = reopened(closed(window));
    window.until_text("what was kept is not used");
    assert!(window.shows("the file was cut") && window.shows("help: "));
    assert!(window.picture() == picture && !window.shows("opened from what was kept"));
    // Keeping it again makes it whole.
    keep(&mut window);
    let mut window = reopened(closed(window));
    window.until_text("opened from what was kept · ");
    assert!(window.picture() == picture);
}

#[test]
fn a_scene_without_a_file_cannot_be_kept() {
    let mut window = Window::with_scene(SCENE, Vec::new());
    let can_be_kept = |window: &mut Window| {
        window.click("File");
        let keep = window.harness.get_by_role_and_label(Role::Button, "Keep traced");
        let possible = !keep.accesskit_node().is_disabled();
        window.key(Modifiers::NONE, Key::Escape);
        possible
    };
    assert!(can_be_kept(&mut window));
    window.menu(&["File", "New", "Empty stage"]);
    window.until("the template", |app| app.document().path().is_none());
    window.until_exact();
    assert!(!can_be_kept(&mut window));
}
