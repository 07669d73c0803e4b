//! Tests of the document: history, files, recovery, templates.

use std::path::{Path, PathBuf};

use super::recovery::Recovery;
use super::*;
use crate::color::Rgb;
use crate::scene::path::set;
use crate::scene::{Light, Material, read};

const OBJ: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
const SCENE: &str = "# mine\nversion = 1\n\n[materials.tiles]\ndiffuse = 0.70 # matt\n\
                     \n[lights.key]\npoint = [0, 0, 5]\n";
const WITH_MESH: &str = "# mine\nversion = 1\n[materials.m]\n[solids.s]\n\
                         mesh = { file = \"parts/m.obj\" } # a mesh\nmaterial = \"m\"\n";

fn document() -> Document {
    Document::untitled("Stage", SCENE).unwrap()
}

fn edit(document: &mut Document, path: &str, value: &str) {
    let mut scene = document.scene().clone();
    set(&mut scene, path, value).unwrap_or_else(|error| panic!("{error}"));
    document.change(scene);
}

/// A folder with a scene of this text and a mesh in `parts`.
fn folder(text: &str) -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("s.toml");
    std::fs::create_dir(folder.path().join("parts")).unwrap();
    std::fs::write(folder.path().join("parts/m.obj"), OBJ).unwrap();
    std::fs::write(&path, text).unwrap();
    (folder, path)
}

fn text_of(path: &Path) -> String {
    std::fs::read_to_string(path).unwrap()
}

#[test]
fn a_gesture_is_one_step_with_a_name() {
    let mut document = document();
    for value in ["0.6", "0.5", "0.42"] {
        edit(&mut document, "materials.tiles.diffuse", value);
        assert!(document.is_unsaved());
    }
    assert_eq!(document.undo_name(), Some("diffuse of tiles 0.70 → 0.42"));
    document.end_gesture();
    edit(&mut document, "picture.exposure", "0.5");
    document.end_gesture();
    assert_eq!(document.undo_name(), Some("exposure 0 → 0.5"));
    assert!(document.undo());
    assert_eq!(document.redo_name(), Some("exposure 0 → 0.5"));
    assert_eq!(document.undo_name(), Some("diffuse of tiles 0.70 → 0.42"));
    assert!(document.undo() && !document.undo());
    assert_eq!((document.undo_name(), document.is_unsaved()), (None, false));
    assert_eq!(document.scene().materials[0].diffuse, Rgb::grey(0.7));
    assert!(document.redo() && document.redo() && !document.redo());
    assert_eq!(document.scene().picture.exposure, 0.5);
}

#[test]
fn a_gesture_that_ends_where_it_began_leaves_no_step_and_keeps_redo() {
    let mut document = document();
    edit(&mut document, "picture.exposure", "0.5");
    document.undo();
    edit(&mut document, "materials.tiles.diffuse", "0.6");
    assert_eq!(document.redo_name(), None);
    edit(&mut document, "materials.tiles.diffuse", "0.7");
    assert_eq!(document.undo_name(), None);
    document.end_gesture();
    assert_eq!((document.undo_name(), document.redo_name()), (None, Some("exposure 0 → 0.5")));
    let same = document.scene().clone();
    document.change(same);
    assert!(document.redo(), "a change of nothing is no step");
}

#[test]
fn steps_are_named_by_what_they_change() {
    let named = |change: &dyn Fn(&mut Scene)| {
        let before = document().scene().clone();
        let mut after = before.clone();
        change(&mut after);
        step::name(&before, &after)
    };
    let by_path = |path: &str, value: &str| {
        named(&|scene| set(scene, path, value).unwrap_or_else(|error| panic!("{error}")))
    };
    for (path, value, name) in [
        ("lights.key.intensity", "2", "intensity of light key 1 → 2"),
        ("lights.key.on", "false", "light key off"),
        ("materials.tiles.color", "[1, 0, 0.5]", "color of tiles #ffffff → #ff00bc"),
        ("materials.tiles.color", "[2, 0, 0]", "color of tiles 1 → [2, 0, 0]"),
        ("materials.tiles.color", "[1, 1, 0.9999]", "color of tiles 1 → [1, 1, 0.9999]"),
        ("materials.tiles.reflect", "[0.25, 0.5, 1]", "reflect of tiles 0 → [0.25, 0.50, 1]"),
        ("materials.tiles.diffuse", "0.7000001", "diffuse of tiles 0.7000000 → 0.7000001"),
        ("materials.tiles.shininess", "200", "shininess of tiles 32 → 200"),
        ("ambient_light", "0.5", "ambient_light #ffffff → #bcbcbc"),
        ("trace.samples", "64", "samples 16 → 64"),
        ("background.color", "[0, 0, 1]", "color of background #000000 → #0000ff"),
        ("camera.eye", "[0, -7, 2]", "eye [0, -6, 2] → [0, -7, 2]"),
    ] {
        assert_eq!(by_path(path, value), name);
    }
    let tiles = |change: &dyn Fn(&mut Material)| named(&|scene| change(&mut scene.materials[0]));
    let three = tiles(&|tiles| {
        tiles.reflect = Rgb::WHITE;
        tiles.ior = 1.1;
        tiles.metallic = 1.0;
    });
    assert_eq!(three, "3 parameters of tiles");
    assert_eq!(tiles(&|tiles| tiles.name = "slate".into()), "rename material tiles → slate");
    let both = named(&|scene| (scene.camera.eye.x, scene.camera.target.x) = (1.0, 1.0));
    assert_eq!(both, "camera");
    assert_eq!(named(&|scene| scene.lights.push(Light::new("rim"))), "add light rim");
    assert_eq!(named(&|scene| scene.materials.clear()), "remove material tiles");
    let texture = tiles(&|tiles| tiles.paint = crate::scene::Paint::named("texture"));
    assert_eq!(texture, "texture of tiles");
}

#[test]
fn saving_keeps_comments_the_file_before_and_the_history() {
    let (folder, path) = folder(SCENE);
    let mut document = Document::open(&path).unwrap();
    assert_eq!((document.title(), document.path()), ("s.toml".into(), Some(path.as_path())));
    edit(&mut document, "materials.tiles.diffuse", "0.42");
    document.end_gesture();
    let save = document.save(&path).unwrap();
    save.write().unwrap();
    assert_eq!(text_of(&path), SCENE.replace("0.70", "0.42"));
    assert_eq!(text_of(&folder.path().join("s.toml~")), SCENE);
    edit(&mut document, "materials.tiles.ior", "1.1");
    document.saved(save);
    assert!(document.is_unsaved(), "an edit made while the file was written stays unsaved");
    assert_eq!(document.saved_scene().materials[0].diffuse, Rgb::grey(0.42));
    document.undo();
    assert!(!document.is_unsaved());
    document.undo();
    assert!(document.is_unsaved());
    let save = document.save(&path).unwrap();
    save.write().unwrap();
    document.saved(save);
    assert_eq!(text_of(&path), SCENE.replace("0.70", "0.7"));
    assert!(document.redo() && document.redo() && document.is_unsaved());
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 3, "left-over files");
}

#[test]
fn a_file_that_another_program_changed_is_not_overwritten_unasked() {
    let (folder, path) = folder(SCENE);
    let mut document = Document::open(&path).unwrap();
    edit(&mut document, "picture.exposure", "1");
    std::fs::write(&path, "# theirs").unwrap();
    let mut save = document.save(&path).unwrap();
    let error = save.write().unwrap_err();
    assert!(error.changed_on_disk && error.message.contains("s.toml was changed by another"));
    assert_eq!(text_of(&path), "# theirs");
    save.overwrite = true;
    save.write().unwrap();
    assert!(text_of(&path).starts_with("# mine"));
    assert_eq!(text_of(&folder.path().join("s.toml~")), "# theirs");
    document.saved(save);
    edit(&mut document, "picture.exposure", "2");
    document.save(&path).unwrap().write().unwrap();
    let other = folder.path().join("other.toml");
    std::fs::write(&other, "old").unwrap();
    document.save(&other).unwrap().write().unwrap();
    assert_eq!(text_of(&folder.path().join("other.toml~")), "old");
}

#[test]
fn a_failed_backup_or_a_read_only_file_is_an_error_before_anything_is_touched() {
    let (folder, path) = folder(SCENE);
    let mut document = Document::open(&path).unwrap();
    edit(&mut document, "picture.exposure", "1");
    let save = document.save(&path).unwrap();
    std::fs::create_dir(folder.path().join("s.toml~")).unwrap();
    assert!(save.write().unwrap_err().message.contains("its backup failed"));
    std::fs::remove_dir(folder.path().join("s.toml~")).unwrap();
    let mut permissions = std::fs::metadata(&path).unwrap().permissions();
    permissions.set_readonly(true);
    std::fs::set_permissions(&path, permissions).unwrap();
    assert!(save.write().unwrap_err().message.contains("read-only"));
    assert_eq!(text_of(&path), SCENE);
    assert!(document.save(&folder.path().join("no/s.toml")).unwrap().write().is_err());
}

#[cfg(unix)]
#[test]
fn links_are_followed_and_permissions_kept() {
    use std::os::unix::fs::PermissionsExt;
    let (folder, path) = folder(SCENE);
    std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o640)).unwrap();
    let link = folder.path().join("link.toml");
    std::os::unix::fs::symlink("s.toml", &link).unwrap();
    let mut document = Document::open(&link).unwrap();
    edit(&mut document, "picture.exposure", "1");
    document.save(&link).unwrap().write().unwrap();
    assert!(std::fs::symlink_metadata(&link).unwrap().is_symlink());
    assert!(text_of(&path).contains("exposure = 1"));
    for file in ["s.toml", "s.toml~"] {
        let mode = std::fs::metadata(folder.path().join(file)).unwrap().permissions().mode();
        assert_eq!(mode & 0o777, 0o640, "{file}");
    }
}

#[test]
fn saved_elsewhere_a_scene_finds_its_meshes() {
    let (folder, path) = folder(WITH_MESH);
    let mut document = Document::open(&path).unwrap();
    edit(&mut document, "picture.exposure", "1");
    document.end_gesture();
    std::fs::create_dir(folder.path().join("other")).unwrap();
    let other = folder.path().join("other/t.toml");
    let save = document.save(&other).unwrap();
    save.write().unwrap();
    document.saved(save);
    assert!(!document.is_unsaved());
    assert!(text_of(&other).contains("mesh = { file = \"../parts/m.obj\" } # a mesh"));
    assert_eq!(Document::open(&other).unwrap().scene(), document.scene());
    document.undo();
    let save = document.save(&other).unwrap();
    assert_eq!(
        save.text,
        WITH_MESH
            .replace("parts/m.obj", "../parts/m.obj")
            .replace("# mine\nversion = 1\n", "# mine\nversion = 1\n\n[picture]\nexposure = 0\n\n")
    );
}

#[test]
fn a_missing_mesh_is_named_and_can_be_located() {
    let (folder, path) = folder(WITH_MESH);
    let moved = folder.path().join("moved.obj");
    std::fs::rename(folder.path().join("parts/m.obj"), &moved).unwrap();
    let error = Document::open(&path).err().unwrap();
    let missing = Missing { kind: FileKind::Mesh, file: "parts/m.obj".into() };
    assert_eq!(error.missing, Some(missing));
    let place = folder.path().join("parts/m.obj");
    assert!(error.message.contains(&format!("was sought at {}", place.display())), "{error}");
    assert!(error.message.contains("s.toml:5:17: "), "{error}");
    let document =
        Document::open_relocated(&path, &[("parts/m.obj".into(), moved.clone())]).unwrap();
    assert!(document.is_unsaved() && document.undo_name().is_none());
    let save = document.save(&path).unwrap();
    assert_eq!(save.text, WITH_MESH.replace("parts/m.obj", "moved.obj"));
    save.write().unwrap();
    assert!(!Document::open(&path).unwrap().is_unsaved());
    std::fs::write(&path, "version = 1\n[camera]\neye = 1\n").unwrap();
    let error = Document::open(&path).err().unwrap();
    assert!(error.missing.is_none() && error.message.contains("s.toml:3:7: "), "{error}");
    assert!(Document::open(Path::new("no/such.toml")).is_err());
}

#[test]
fn missing_images_are_named_and_one_that_is_located_leads_to_those_beside_it() {
    const IMAGES: &str = r#"version = 1
[camera]
eye = [3, -1, 1]
[background]
image = { file = "sky.png", tint = 1 }
[materials.m]
texture = { image = { file = "wood.png", tint = 1, size = 1 } }
bump = { image = { file = "wood.png", height = 0.1, size = 1 } }
"#;
    let (folder, path) = folder(IMAGES);
    std::fs::create_dir(folder.path().join("moved")).unwrap();
    for name in ["moved/sky.png", "moved/wood.png"] {
        std::fs::write(folder.path().join(name), include_bytes!("../../assets/globe.png")).unwrap();
    }
    let error = Document::open(&path).err().unwrap();
    let missing = Missing { kind: FileKind::Image, file: "sky.png".into() };
    assert_eq!(error.missing, Some(missing), "{error}");
    assert!(error.message.contains("the image file sky.png was sought at"), "{error}");
    let place = folder.path().join("moved/sky.png");
    let document = Document::open_relocated(&path, &[("sky.png".into(), place)]).unwrap();
    let text = document.save(&path).unwrap().text;
    let expected = IMAGES.replace("sky.png", "moved/sky.png").replace("wood.png", "moved/wood.png");
    assert_eq!(text, expected);
}

#[test]
fn work_of_a_dead_run_is_found_and_that_of_a_live_one_is_not() {
    let (folder, path) = folder(WITH_MESH);
    let place = folder.path().join("unsaved");
    let (live, found) = Recovery::start(&place).unwrap();
    assert!(found.is_empty());
    let mut document = Document::open(&path).unwrap();
    edit(&mut document, "materials.m.ior", "1.25");
    live.snapshot(&document).write().unwrap();
    let (other, found) = Recovery::start(&place).unwrap();
    assert!(found.is_empty(), "a live run's work is not lost");
    // two runs that end without saving: one by dropping, one leaves no lock at all
    drop(live);
    other.snapshot(&Document::untitled("Stage", SCENE).unwrap()).write().unwrap();
    drop(other);
    let (third, found) = Recovery::start(&place).unwrap();
    assert_eq!(found.len(), 2);
    let (fourth, again) = Recovery::start(&place).unwrap();
    assert!(again.is_empty(), "what one run has found is not offered to another");
    let work = found.iter().find(|work| work.title == "s.toml").unwrap();
    assert_eq!(work.original.as_deref(), Some(path.as_path()));
    assert!(work.age_secs < 60 && text_of(&work.file).contains("/parts/m.obj"));
    let back = work.open().unwrap();
    assert!(back.is_unsaved() && back.path() == Some(path.as_path()));
    assert_eq!(back.scene(), document.scene());
    assert_eq!(back.saved_scene(), &read::file(&path).unwrap());
    let save = back.save(&path).unwrap();
    assert_eq!(save.text, WITH_MESH.replace("[materials.m]\n", "[materials.m]\nior = 1.25\n"));
    std::fs::write(&path, "# theirs").unwrap();
    assert!(save.write().unwrap_err().changed_on_disk);
    for work in found {
        work.discard();
    }
    drop((third, fourth));
    assert_eq!(std::fs::read_dir(&place).unwrap().count(), 1, "only start.lock");
}

#[test]
fn damaged_work_is_set_aside_and_said() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("unsaved-1-1.json"), "{ half").unwrap();
    let (recovery, found) = Recovery::start(folder.path()).unwrap();
    assert!(found.is_empty());
    assert_eq!(recovery.damaged(), [folder.path().join("unsaved-1-1.json.bad")]);
    assert_eq!(text_of(&recovery.damaged()[0]), "{ half");
    assert!(Recovery::start(folder.path()).unwrap().0.damaged().is_empty());
}

#[test]
fn a_late_snapshot_does_not_bring_saved_work_back() {
    let folder = tempfile::tempdir().unwrap();
    let (recovery, _) = Recovery::start(folder.path()).unwrap();
    let early = recovery.snapshot(&document());
    let mut edited = document();
    edit(&mut edited, "picture.exposure", "3");
    let late = recovery.snapshot(&edited);
    late.write().unwrap();
    early.write().unwrap();
    let file = std::fs::read_dir(folder.path()).unwrap().map(|entry| entry.unwrap().path());
    let file = file.into_iter().find(|path| path.extension().unwrap() == "json").unwrap();
    assert!(text_of(&file).contains("exposure = 3"), "an older snapshot replaced a newer one");
    recovery.clear();
    late.write().unwrap();
    assert!(!file.exists());
    recovery.snapshot(&edited).write().unwrap();
    assert!(file.exists());
}

#[test]
fn flaws_of_an_edit_are_told_and_those_before_it_are_not() {
    let scene = document().scene().clone();
    let mut up = scene.clone();
    up.camera.up = up.camera.target - up.camera.eye;
    assert!(flaw(&scene, &up).unwrap().starts_with("camera.up: `up` is parallel"));
    assert_eq!(flaw(&up, &up), None);
    assert_eq!(flaw(&up, &scene), None);
    let mut dark = scene.clone();
    dark.materials[0].diffuse = Rgb::grey(-1.0);
    assert!(flaw(&scene, &dark).unwrap().starts_with("materials.tiles.diffuse: "));
}

#[test]
fn templates_are_valid_and_explained() {
    for (name, text) in TEMPLATES.iter().chain([&BUILT_IN]) {
        let document = Document::untitled(name, text).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!((document.title().as_str(), document.is_unsaved()), (*name, false));
        assert!(text.starts_with("# ") && document.path().is_none());
    }
    assert_eq!(TEMPLATES.len(), 3);
}
