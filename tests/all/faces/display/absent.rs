//! Without a display: one line about it, the scene rendered and re-shaded, both times printed.

use std::path::Path;
use std::process::Output;

use crate::faces::{SCENE, decode_png, names_in, rayforest};

/// Runs the program where `displays` are all the displays named, and gives its results. What it
/// says besides is one line.
fn run_without(folder: &Path, arguments: &[&str], displays: &[(&str, &str)]) -> String {
    let mut command = rayforest(folder, arguments);
    command.env("XDG_RUNTIME_DIR", folder).envs(displays.iter().copied());
    let Output { status, stdout, stderr } = command.output().unwrap();
    let messages = String::from_utf8(stderr).unwrap();
    assert_eq!(status.code(), Some(0), "{displays:?}: {messages}");
    assert_eq!(messages.lines().count(), 1, "{displays:?}: {messages}");
    assert!(messages.starts_with("no display to open a window on ("), "{messages}");
    assert!(messages.ends_with("): rendering to rayforest.png instead\n"), "{messages}");
    assert!(!messages.contains(".rs"), "{messages}");
    String::from_utf8(stdout).unwrap()
}

const PICTURES: [&str; 5] = [
    "rayforest-edit-1.png",
    "rayforest-edit-2.png",
    "rayforest-edit-3.png",
    "rayforest-edit-4.png",
    "rayforest.png",
];

#[test]
fn a_scene_is_rendered_and_re_shaded_and_both_times_are_printed() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("scene.toml"), SCENE).unwrap();
    let results = run_without(folder.path(), &["scene.toml"], &[]);
    let (wrote, lines): (Vec<&str>, Vec<&str>) =
        results.lines().partition(|line| line.starts_with("wrote "));
    assert_eq!(lines.len(), 5, "{results}");
    assert!(lines[0].starts_with("traced 48×27, 2 samples per pixel"), "{}", lines[0]);
    assert!(lines[0].ends_with(" ms"), "{}", lines[0]);
    for (line, class) in lines[1..].iter().zip(["reshade", "reshade", "refold", "reshade"]) {
        assert!(line.contains(&format!(": {class} in ")), "{line}");
        assert!(line.contains(" ms, 0 rays") && line.ends_with(" times faster"), "{line}");
    }
    let mut names = PICTURES.to_vec();
    names.push("scene.toml");
    assert_eq!(names_in(folder.path()), names);
    assert_eq!(wrote.len(), PICTURES.len(), "{results}");
    for name in PICTURES {
        decode_png(&folder.path().join(name)).unwrap();
        assert!(wrote.contains(&&*format!("wrote {name}")), "{results}");
    }
}

#[test]
fn without_anything_it_shows_the_built_in_scene() {
    let folder = tempfile::tempdir().unwrap();
    let results = run_without(folder.path(), &[], &[]);
    assert!(results.starts_with("traced 1280×720"), "{results}");
    assert_eq!(results.matches(" times faster").count(), 4, "{results}");
    assert_eq!(names_in(folder.path()), PICTURES);
    for name in PICTURES {
        assert_eq!(decode_png(&folder.path().join(name)).unwrap().0, [1280, 720], "{name}");
    }
}

#[test]
fn a_display_that_does_not_answer_is_none() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("scene.toml"), SCENE).unwrap();
    for displays in [
        [("DISPLAY", ":4077"), ("WAYLAND_DISPLAY", "")],
        [("DISPLAY", "no display"), ("WAYLAND_DISPLAY", "")],
        [("DISPLAY", ""), ("WAYLAND_DISPLAY", "nobody")],
    ] {
        let results = run_without(folder.path(), &["scene.toml"], &displays);
        assert!(results.starts_with("traced 48×27"), "{displays:?}: {results}");
    }
}
