//! Files of other programs in the window: imported, edited, saved.

use super::*;
use crate::faces::convert::folder_with;
use crate::faces::names_in;

/// A window with files of other programs in its folder, whose dialogs give these files of it.
fn importing(files: &[&str], answers: &[&str]) -> Window {
    let folder = folder_with(files);
    let root = folder.path().to_owned();
    let answers = answers.iter().rev().map(|name| Answer::File(root.join(name))).collect();
    let mut window = Window::in_folder(folder, None, answers);
    window.until("a picture is shown", |app| app.shown().is_some());
    window
}

#[test]
fn a_file_is_imported_shown_edited_and_saved() {
    // A scene without the ending of one gets it.
    let mut window = importing(&["spd_teapot.nff"], &["spd_teapot.nff", "new.obj"]);
    let source = window.file("spd_teapot.nff");
    let text = std::fs::read_to_string(&source).unwrap();
    let small = text.replace("resolution 512 512", "resolution 32 24");
    assert_ne!(small, text);
    std::fs::write(&source, small).unwrap();
    window.menu(&["File", "Import…"]);
    window.until_text("The file is imported");
    assert!(window.shows("`hither` is left out"));
    let target = window.file("new.obj.toml");
    assert!(window.app().document().path() == Some(&target));
    window.click("Close");
    window.until_exact();
    assert!(rgb(&window.picture()) == rendered(window.folder.path(), "new.obj.toml"));
    window.click("fill 3");
    window.type_into("shininess value", "12");
    window.save();
    assert!(std::fs::read_to_string(&target).unwrap().contains("shininess = 12"));
    window.until_exact();
    assert!(rgb(&window.picture()) == rendered(window.folder.path(), "new.obj.toml"));
}

#[test]
fn a_file_that_cannot_be_imported_is_explained() {
    let mut window = importing(&["assimp_scene.obj"], &["assimp_scene.obj", "new.toml"]);
    let scene = window.app().document().scene().clone();
    let before = names_in(window.folder.path());
    window.menu(&["File", "Import…"]);
    window.until_text("The file cannot be imported");
    window.until_text("the material file `assimp_scene.mtl` cannot be read");
    window.click("Close");
    assert!(!window.shows("The file cannot be imported"));
    assert!(*window.app().document().scene() == scene, "the scene stays");
    assert_eq!(names_in(window.folder.path()), before);
}
