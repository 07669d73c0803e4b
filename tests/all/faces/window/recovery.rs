//! Unsaved work of a run that was killed.

use super::files::{MESH, MESH_SCENE};
use super::*;
use crate::faces::{SCENE, names_in};

/// The files of unsaved work in a window's folder.
fn kept(folder: &Path) -> Vec<PathBuf> {
    let unsaved = folder.join("unsaved");
    let files = names_in(&unsaved).into_iter().filter(|name| name.ends_with(".json"));
    files.map(|name| unsaved.join(name)).collect()
}

/// A window with work that is kept but not saved.
fn working() -> Window {
    worked(Window::with_scene(SCENE, Vec::new()), "mirror")
}

/// The window, once an edit of a material is kept.
fn worked(mut window: Window, material: &str) -> Window {
    window.click(material);
    window.drag_slider("diffuse", 0.9);
    let folder = window.folder.path().to_owned();
    window.until("the work is kept", |_| !kept(&folder).is_empty());
    window
}

/// A new run beside the work of a dead one: a copy of its file, without the lock that the living
/// window of this process still holds.
fn after_the_death_of(dead: &Window) -> Window {
    after_the_death_with(dead, Vec::new())
}

/// The same, with answers for dialogs.
fn after_the_death_with(dead: &Window, answers: Vec<Answer>) -> Window {
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("unsaved")).unwrap();
    for file in kept(dead.folder.path()) {
        std::fs::copy(&file, folder.path().join("unsaved/unsaved-1-1.json")).unwrap();
    }
    let mut window = Window::in_folder(folder, None, answers);
    window.until_text("Unsaved work was found");
    window.until_text("scene.toml, ");
    window
}

#[test]
fn work_of_a_killed_run_is_recovered_unsaved_and_belongs_to_its_file() {
    let dead = working();
    let mut window = after_the_death_of(&dead);
    let folder = window.folder.path().to_owned();
    window.click("Recover");
    let file = dead.file("scene.toml");
    window.until("it is open", |app| app.document().path() == Some(&file));
    assert!(window.app().document().scene() == dead.app().document().scene());
    assert!(window.app().document().is_unsaved());
    assert!(!kept(&folder).is_empty(), "the work is never without a copy");
    window.until_exact();
    assert!(window.picture() == dead.picture());

    window.save();
    window.until("nothing is kept any more", |_| kept(&folder).is_empty());
    assert!(rgb(&window.picture()) == rendered(dead.folder.path(), "scene.toml"));
}

#[test]
fn recovered_work_that_is_kept_anew_is_not_kept_twice() {
    let dead = working();
    let mut window = after_the_death_of(&dead);
    let folder = window.folder.path().to_owned();
    let old = folder.join("unsaved/unsaved-1-1.json");
    window.click("Recover");
    window.until("the old copy is gone", |_| !old.exists());
    assert_eq!(kept(&folder).len(), 1, "and a new one is there");
}

#[test]
fn a_mesh_that_is_lost_meanwhile_can_be_located() {
    let folder = tempfile::tempdir().unwrap();
    let (scene, mesh) = (folder.path().join("scene.toml"), folder.path().join("m.obj"));
    std::fs::write(&scene, MESH_SCENE).unwrap();
    std::fs::write(&mesh, MESH).unwrap();
    let mut dead = Window::in_folder(folder, Some(scene.clone()), Vec::new());
    dead.until("the scene is open", |app| app.document().path() == Some(&scene));
    dead.until_exact();
    let dead = worked(dead, "grey");
    let moved = dead.file("moved.obj");
    std::fs::rename(&mesh, &moved).unwrap();

    let mut window = after_the_death_with(&dead, vec![Answer::File(moved)]);
    window.click("Recover");
    window.until_text("m.obj");
    window.click("Locate…");
    window.until("it is open", |app| app.document().path() == Some(&scene));
    window.until_exact();
    assert!(window.app().document().is_unsaved());
    assert!(window.picture() == dead.picture());
}

#[test]
fn found_work_may_wait_or_be_discarded() {
    let dead = working();
    let mut window = after_the_death_of(&dead);
    let folder = window.folder.path().to_owned();
    window.click_at(eframe::egui::pos2(640.0, 700.0), Modifiers::NONE);
    assert!(window.shows("Unsaved work was found"), "a click beside it does not answer it");
    window.key(Modifiers::NONE, Key::Escape);
    assert!(!window.shows("Unsaved work was found"));
    assert!(!window.app().document().is_unsaved());
    assert_eq!(kept(&folder).len(), 1);

    let mut window = after_the_death_of(&dead);
    let folder = window.folder.path().to_owned();
    window.click("Discard");
    assert!(!window.shows("Unsaved work was found"));
    assert_eq!(kept(&folder).len(), 0);
}

#[test]
fn saved_work_is_not_kept() {
    let mut window = working();
    let folder = window.folder.path().to_owned();
    window.save();
    window.until("nothing is kept any more", |_| kept(&folder).is_empty());
}

#[test]
fn a_bad_scene_does_not_hide_found_work() {
    let dead = working();
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("unsaved")).unwrap();
    std::fs::copy(&kept(dead.folder.path())[0], folder.path().join("unsaved/unsaved-1-1.json"))
        .unwrap();
    let missing = folder.path().join("missing.toml");
    let mut window = Window::in_folder(folder, Some(missing), Vec::new());
    window.until_text("The scene cannot be opened");
    window.click("Close");
    window.until_text("Unsaved work was found");
    window.click("Later");
}
