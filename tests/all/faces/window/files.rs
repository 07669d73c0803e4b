//! Scene files in the window: opened, saved, replaced, and bad ones.

use std::sync::Arc;

use eframe::egui::DroppedFile;

use super::*;
use crate::faces::{SCENE, names_in};

/// A scene of one mesh in `m.obj`.
pub(super) const MESH_SCENE: &str = "version = 1\n\n[picture]\nsize = [16, 9]\n\n[lights]\n\
    key = { point = [-4, -5, 7] }\n\n[materials.grey]\ndiffuse = 0.8\n\n[solids]\n\
    sheet = { mesh = { file = \"m.obj\" }, material = \"grey\" } # beside this file\n";
pub(super) const MESH: &str = "v -9 0 -9\nv 9 0 -9\nv 0 0 9\nf 1 2 3\n";

/// A file dropped on the window.
#[derive(Debug)]
struct Dropped(PathBuf);

impl DroppedFile for Dropped {
    fn path(&self) -> &Path {
        &self.0
    }

    fn bytes(&self) -> Result<Vec<u8>, String> {
        Err("the window reads files by their paths".into())
    }
}

/// A window with `scene.toml` and beside it another scene, whose answers are given by their names.
fn with_second(second: &str, text: &str, answers: &[&str]) -> Window {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path().to_owned();
    std::fs::write(root.join("scene.toml"), SCENE).unwrap();
    std::fs::write(root.join(second), text).unwrap();
    let answers = answers.iter().rev().map(|name| Answer::File(root.join(name))).collect();
    let mut window = Window::in_folder(folder, Some(root.join("scene.toml")), answers);
    window.until("the scene is open", |app| app.document().path().is_some());
    window.until_exact();
    window
}

#[test]
fn saving_keeps_comments_and_every_other_line() {
    let text = SCENE
        .replace("version = 1", "# the scene of a test\nversion   =  1   # spaced oddly")
        .replace("diffuse = 0.3", "diffuse   = 0.3  # matt, a little")
        .replace("[solids]", "\n\n# what there is\n[solids]");
    let mut window = Window::with_scene(&text, Vec::new());
    window.click("mirror");
    window.type_into("diffuse value", "0.75");
    window.save();
    let saved = window.scene_text();
    let changed: Vec<_> = text.lines().zip(saved.lines()).filter(|(a, b)| a != b).collect();
    let wanted = ("diffuse   = 0.3  # matt, a little", "diffuse   = 0.75  # matt, a little");
    assert_eq!(changed, [wanted]);
    assert_eq!(text.lines().count(), saved.lines().count());
    assert_eq!(std::fs::read_to_string(window.file("scene.toml~")).unwrap(), text);
    window.until_text("saved ");
}

#[test]
fn a_bad_file_shows_its_message_and_keeps_the_scene() {
    let bad = SCENE.replace("reflect = 0.5", "reflect = 7000000");
    let mut window = with_second("bad.toml", &bad, &["bad.toml"]);
    let (scene, picture) = (window.app().document().scene().clone(), window.picture());
    window.key(Modifiers::COMMAND, Key::O);
    window.until_text("The scene cannot be opened");
    let line = 1 + bad.lines().position(|l| l.contains("7000000")).unwrap();
    window.until_text(&format!("bad.toml:{line}:"));
    window.until_text("reflect = 7000000");
    assert!(window.texts().iter().any(|text| text.contains('^')), "a caret shows the place");
    window.click("Close");
    assert!(!window.shows("The scene cannot be opened"));
    assert!(*window.app().document().scene() == scene && window.picture() == picture);
    window.click("mirror");
    window.drag_slider("diffuse", 0.9);
    window.until_exact();
    assert!(window.picture() != picture, "the window goes on");
}

#[test]
fn a_missing_mesh_is_named_and_can_be_located() {
    let mut window = with_second("lost.toml", MESH_SCENE, &["lost.toml", "far/away.obj"]);
    std::fs::create_dir(window.file("far")).unwrap();
    std::fs::write(window.file("far/away.obj"), MESH).unwrap();
    window.key(Modifiers::COMMAND, Key::O);
    window.until_text("m.obj");
    window.click("Locate…");
    let lost = window.file("lost.toml");
    window.until("the scene is open", |app| app.document().path() == Some(&lost));
    assert!(window.app().document().is_unsaved(), "the place of the mesh is an edit");
    window.until_exact();
    window.save();
    let text = std::fs::read_to_string(&lost).unwrap();
    assert_eq!(text, MESH_SCENE.replace("m.obj", "far/away.obj"));
    assert!(rgb(&window.picture()) == rendered(window.folder.path(), "lost.toml"));
}

#[test]
fn a_missing_image_is_named_and_can_be_located() {
    let image = "texture = { image = { file = \"w.png\", tint = 1, size = 1 } }";
    let lost = SCENE.replace("color = [0.9, 0.9, 0.95]", image);
    assert!(lost.contains(image));
    let mut window = with_second("lost.toml", &lost, &["lost.toml", "far/away.png"]);
    std::fs::create_dir(window.file("far")).unwrap();
    let orange = image::RgbImage::from_pixel(2, 2, image::Rgb([250, 120, 10]));
    orange.save(window.file("far/away.png")).unwrap();
    window.key(Modifiers::COMMAND, Key::O);
    window.until_text("the image file w.png was sought at");
    window.click("Locate…");
    let lost_path = window.file("lost.toml");
    window.until("the scene is open", |app| app.document().path() == Some(&lost_path));
    window.until_exact();
    window.save();
    let text = std::fs::read_to_string(&lost_path).unwrap();
    assert_eq!(text, lost.replace("w.png", "far/away.png"));
    assert!(rgb(&window.picture()) == rendered(window.folder.path(), "lost.toml"));
}

#[test]
fn saving_to_another_folder_takes_relative_meshes_along() {
    let mut window = with_second("mesh.toml", MESH_SCENE, &["mesh.toml", "deep/copy"]);
    std::fs::write(window.file("m.obj"), MESH).unwrap();
    std::fs::create_dir(window.file("deep")).unwrap();
    window.key(Modifiers::COMMAND, Key::O);
    let opened = window.file("mesh.toml");
    window.until("the scene is open", |app| app.document().path() == Some(&opened));
    window.until_exact();
    window.key(Modifiers::COMMAND | Modifiers::SHIFT, Key::S);
    let copy = window.file("deep/copy.toml");
    window.until("the copy is the document", |app| app.document().path() == Some(&copy));
    window.until_exact();
    assert!(rgb(&window.picture()) == rendered(window.folder.path(), "deep/copy.toml"));
    let text = std::fs::read_to_string(&copy).unwrap();
    assert_eq!(text, MESH_SCENE.replace("m.obj", "../m.obj"));
    assert!(!window.app().document().is_unsaved());
}

#[test]
fn a_template_a_recent_file_and_a_dropped_file_are_opened() {
    let mut window = with_second("other.toml", &SCENE.replace("0.3\n", "0.4\n"), &[]);
    let (scene, other) = (window.file("scene.toml"), window.file("other.toml"));
    window.menu(&["File", "New", "Empty stage"]);
    window.until("the template", |app| app.document().path().is_none());
    assert_eq!(window.app().document().title(), "Empty stage");
    assert!(!window.app().document().is_unsaved());

    let file = Arc::new(Dropped(other.clone()));
    window.harness.input_mut().dropped_files.push(file);
    window.until("the dropped file", |app| app.document().path() == Some(&other));
    assert!(window.shows("other.toml"));

    window.menu(&["File", "Open recent", "scene.toml"]);
    window.until("the recent file", |app| app.document().path() == Some(&scene));
    window.until_exact();
    let (settings, fault) =
        rayforest::document::settings::Settings::read(&window.file("config/settings.toml"));
    assert_eq!((settings.recent, fault), (vec![scene, other], None));
    assert_eq!(names_in(&window.file("config")), ["settings.toml"]);
}
