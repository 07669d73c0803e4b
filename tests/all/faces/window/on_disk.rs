//! Files that another program changes while the window shows them.

use super::files::{MESH, MESH_SCENE};
use super::*;
use crate::faces::SCENE;

/// The reflection of the scene's mirror.
fn reflect(app: &App) -> f32 {
    app.document().scene().materials[1].reflect.0[0]
}

/// What another program makes of the scene.
fn theirs() -> String {
    SCENE.replace("reflect = 0.5", "reflect = 0.25 # by hand")
}

/// A window with an edit that is not saved, and another program's edit of the same file.
fn both_edited() -> Window {
    let mut window = Window::with_scene(SCENE, Vec::new());
    window.click("mirror");
    window.type_into("diffuse value", "0.75");
    std::fs::write(window.file("scene.toml"), theirs()).unwrap();
    window.until_button("Load theirs");
    window
}

#[test]
fn what_is_not_edited_here_is_loaded_at_once_and_undone_by_undo() {
    let mut window = Window::with_scene(SCENE, Vec::new());
    std::fs::write(window.file("scene.toml"), theirs()).unwrap();
    window.until("their edit is here", |app| reflect(app) == 0.25);
    window.until_text("scene.toml was changed by another program: loaded");
    assert!(!window.app().document().is_unsaved() && window.button("Load theirs").is_none());
    window.until_exact();
    assert!(rgb(&window.picture()) == rendered(window.folder.path(), "scene.toml"));
    assert_eq!(window.undo_name(), Some("load scene.toml from disk"));
    window.key(Modifiers::COMMAND, Key::Z);
    assert_eq!(reflect(window.app()), 0.5);
    assert!(window.app().document().is_unsaved());
    // Saving does not ask: what is replaced was seen here.
    window.save();
    assert_eq!(window.scene_text(), SCENE.replace("reflect = 0.5", "reflect = 0.5 # by hand"));
}

#[test]
fn what_is_edited_here_too_is_offered_and_loading_it_loses_nothing() {
    let mut window = both_edited();
    assert!(window.shows("scene.toml was changed by another program, and here too."));
    assert_eq!(reflect(window.app()), 0.5, "nothing happens without an answer");
    window.click("Load theirs");
    assert_eq!(reflect(window.app()), 0.25);
    assert!(!window.app().document().is_unsaved() && window.button("Load theirs").is_none());
    window.until_exact();
    assert!(rgb(&window.picture()) == rendered(window.folder.path(), "scene.toml"));
    window.key(Modifiers::COMMAND, Key::Z);
    let mirror = &window.app().document().scene().materials[1];
    assert_eq!((mirror.reflect.0[0], mirror.diffuse.0[0]), (0.5, 0.75), "my version is back");
}

#[test]
fn my_version_may_be_kept_and_saving_it_asks() {
    let mut window = both_edited();
    window.click("Keep mine");
    assert!(window.button("Keep mine").is_none());
    assert_eq!(reflect(window.app()), 0.5);
    window.key(Modifiers::COMMAND, Key::S);
    window.until_text("The file was changed by another program");
    assert_eq!(window.scene_text(), theirs());
    window.click("Overwrite");
    window.until("it is saved", |app| !app.document().is_unsaved());
    assert_eq!(window.scene_text(), SCENE.replace("diffuse = 0.3", "diffuse = 0.75"));
    assert_eq!(std::fs::read_to_string(window.file("scene.toml~")).unwrap(), theirs());
    // The window's own save is no news.
    let start = Instant::now();
    while start.elapsed() < Duration::from_millis(3500) {
        window.harness.step();
        assert!(!window.shows("by another program") && window.button("Keep mine").is_none());
        std::thread::sleep(Duration::from_millis(50));
    }
}

#[test]
fn a_file_that_makes_no_sense_is_told_until_it_does() {
    let mut window = Window::with_scene(SCENE, Vec::new());
    std::fs::write(window.file("scene.toml"), "half a scene").unwrap();
    window.until_text("scene.toml was changed by another program and is not read: ");
    assert_eq!(reflect(window.app()), 0.5);
    std::fs::write(window.file("scene.toml"), theirs()).unwrap();
    window.until("their edit is here", |app| reflect(app) == 0.25);
    assert!(!window.shows("is not read"));
    std::fs::remove_file(window.file("scene.toml")).unwrap();
    window.until_text("was moved or deleted by another program");
}

#[test]
fn a_mesh_is_read_anew_and_edits_stay() {
    let folder = tempfile::tempdir().unwrap();
    let (scene, mesh) = (folder.path().join("scene.toml"), folder.path().join("m.obj"));
    std::fs::write(&scene, MESH_SCENE).unwrap();
    std::fs::write(&mesh, MESH).unwrap();
    let mut window = Window::in_folder(folder, Some(scene.clone()), Vec::new());
    window.until("the scene is open", |app| app.document().path() == Some(&scene));
    window.until_exact();
    // The files are watched after a moment's rest.
    let before = window.picture();
    let start = Instant::now();
    while start.elapsed() < Duration::from_millis(1500) {
        window.harness.step();
        std::thread::sleep(Duration::from_millis(20));
    }
    std::fs::write(&mesh, MESH.replace("v 0 0 9", "v 0 0 -8")).unwrap();
    window.until_text("m.obj changed on disk: loaded anew");
    window.until_exact();
    assert!(!window.app().document().is_unsaved() && window.undo_name().is_none());
    assert!(window.picture() != before);
    assert!(rgb(&window.picture()) == rendered(window.folder.path(), "scene.toml"));

    window.click("grey");
    window.type_into("diffuse value", "0.4");
    std::fs::write(&mesh, MESH).unwrap();
    window.until_button("Load it anew");
    window.click("Load it anew");
    window.until_exact();
    assert!(window.app().document().is_unsaved(), "the edit stays");
    window.save();
    window.until_exact();
    assert!(rgb(&window.picture()) == rendered(window.folder.path(), "scene.toml"));
}

#[test]
fn an_offer_moves_nothing_and_what_is_undone_here_is_loaded() {
    let mut window = Window::with_scene(SCENE, Vec::new());
    window.click("mirror");
    window.type_into("diffuse value", "0.75");
    let before = window.rect(Role::Slider, "diffuse");
    std::fs::write(window.file("scene.toml"), theirs()).unwrap();
    window.until_button("Load theirs");
    window.harness.run_steps(3);
    assert_eq!(window.rect(Role::Slider, "diffuse"), before);
    window.key(Modifiers::COMMAND, Key::Z);
    window.until("their edit is here", |app| reflect(app) == 0.25);
    assert!(window.button("Load theirs").is_none());
}

#[test]
fn a_scene_whose_file_is_gone_is_unsaved_until_it_is_back_or_saved() {
    let mut window = Window::with_scene(SCENE, Vec::new());
    let file = window.file("scene.toml");
    std::fs::remove_file(&file).unwrap();
    window.until_button("Save it again");
    assert!(window.app().document().is_unsaved());
    window.menu(&["File", "New", "Empty stage"]);
    window.until_text("Save scene.toml again?");
    window.click("Cancel");
    std::fs::write(&file, SCENE).unwrap();
    window.until("it is back", |app| !app.document().is_unsaved());
    window.harness.run_steps(2);
    assert!(window.button("Save it again").is_none());
    std::fs::remove_file(&file).unwrap();
    window.until_button("Save it again");
    window.click("Save it again");
    window.until("it is saved", |app| !app.document().is_unsaved());
    window.harness.run_steps(2);
    assert!(window.button("Save it again").is_none() && window.scene_text() == SCENE);
}
