//! The commands with bad input: a clear message, an exit code, and nothing left behind.

use std::path::Path;

use super::{SCENE, folder_with_scene, names_in, run};

/// What a run that must fail says; it prints no result and leaves the folder as it was.
pub(super) fn refused(folder: &Path, arguments: &[&str], code: i32) -> String {
    let before = names_in(folder);
    let ran = run(folder, arguments);
    assert_eq!(ran.code, Some(code), "{arguments:?}: {}", ran.messages);
    assert_eq!(ran.results, "", "{arguments:?}: results of a failure");
    assert_eq!(names_in(folder), before, "{arguments:?} left something behind");
    assert!(ran.messages.starts_with("error: "), "{arguments:?}: {}", ran.messages);
    assert!(!ran.messages.contains("src/"), "{arguments:?}: {}", ran.messages);
    ran.messages
}

/// What `render` and `check` say about the small scene with `old` replaced by `new`.
fn mistake(old: &str, new: &str) -> String {
    mistake_beside(old, new, &[])
}

/// The same with some files beside it.
pub(super) fn mistake_beside(old: &str, new: &str, files: &[(&str, &[u8])]) -> String {
    assert_eq!(SCENE.matches(old).count(), 1, "`{old}` stands once in the scene");
    let folder = folder_with_scene();
    for (name, bytes) in files {
        std::fs::write(folder.path().join(name), bytes).unwrap();
    }
    std::fs::write(folder.path().join("scene.toml"), SCENE.replace(old, new)).unwrap();
    let checked = refused(folder.path(), &["check", "scene.toml"], 2);
    let rendered = refused(folder.path(), &["render", "scene.toml", "-o", "a.png"], 2);
    assert_eq!(checked, rendered);
    assert_eq!(checked, refused(folder.path(), &["scene.toml"], 2));
    assert_eq!(checked, refused(folder.path(), &["inspect", "scene.toml", "--pixel", "1,1"], 2));
    checked
}

pub(super) fn assert_says(message: &str, words: &[&str]) {
    for word in words {
        assert!(message.contains(word), "`{word}` is not in: {message}");
    }
}

#[test]
fn mistakes_in_a_scene_have_line_and_column() {
    assert_says(&mistake("[trace]", "[trace"), &["scene.toml:6:", "help: "]);
    assert_says(&mistake("size = [48, 27]", "size = [0, 0]"), &["scene.toml:4:9", "1 to 65536"]);
    let huge = mistake("size = [48, 27]", "size = [900000, 900000]");
    assert_says(&huge, &["scene.toml:4:9", "900000"]);
    let large = mistake("size = [48, 27]", "size = [65536, 65536]");
    assert_says(&large, &["scene.toml:4:", "too large"]);
    assert_says(&mistake("radius = 1", "radius = nan"), &["scene.toml:24:"]);
    assert_says(&mistake("reflect = 0.5", "reflect = 11"), &["scene.toml:20:11", "0 to 10"]);
    assert_says(&mistake("specular = 0.6", "specularity = 1"), &["scene.toml:19:1", "specular"]);
    assert_says(&mistake("\"mirror\" }", "\"miror\" }"), &["scene.toml:24:", "mirror"]);
    assert_says(&mistake("version = 1", "version = 99"), &["scene.toml:1:", "99"]);
}

#[test]
fn all_mistakes_are_told_at_once() {
    let folder = folder_with_scene();
    let text = SCENE.replace("reflect = 0.5", "reflect = -1").replace("samples = 2", "samples = 0");
    std::fs::write(folder.path().join("scene.toml"), text).unwrap();
    let message = refused(folder.path(), &["check", "scene.toml"], 2);
    assert_says(&message, &["scene.toml:7:", "scene.toml:20:"]);
}

#[test]
fn mesh_files_are_found_fault_with_in_their_place() {
    let mesh = |file: &str| format!("mesh = {{ file = \"{file}\" }}");
    let ball = "sphere = { center = [0, 0, 0], radius = 1 }";
    assert_says(&mistake(ball, &mesh("missing.obj")), &["scene.toml:24:", "missing.obj"]);
    let corners = "v 0 0 0\nv 1 0 0\nv 1 1 0\n";
    for (lines, place) in [
        ("v 1 nan 0\nf 1 2 3\n", "bad.obj:4:5"),
        ("v inf 0 0\nf 1 2 3\n", "bad.obj:4:3"),
        ("f 1 2 4\n", "bad.obj:4:7"),
        ("f 1 2 -9\n", "bad.obj:4:7"),
        ("f 1 2 99999999999999999999\n", "bad.obj:4:7"),
        ("", "bad.obj: there are no faces"),
    ] {
        let folder = folder_with_scene();
        let at = |name: &str| folder.path().join(name);
        std::fs::write(at("scene.toml"), SCENE.replace(ball, &mesh("bad.obj"))).unwrap();
        std::fs::write(at("bad.obj"), format!("{corners}{lines}")).unwrap();
        let message = refused(folder.path(), &["render", "scene.toml", "-o", "a.png"], 2);
        assert_says(&message, &["scene.toml:24:", place]);
    }
}

#[test]
fn files_that_are_no_scene_are_refused() {
    let folder = folder_with_scene();
    assert_says(&refused(folder.path(), &["check", "no.toml"], 2), &["no.toml"]);
    assert_says(&refused(folder.path(), &["no.toml"], 2), &["no.toml"]);
    std::fs::write(folder.path().join("b.toml"), [0xff, 0xfe, 0, 1, 2]).unwrap();
    assert_says(&refused(folder.path(), &["check", "b.toml"], 2), &["b.toml"]);
    std::fs::write(folder.path().join("empty.toml"), "").unwrap();
    assert_says(&refused(folder.path(), &["check", "empty.toml"], 2), &["empty.toml", "version"]);
    std::fs::create_dir(folder.path().join("folder.toml")).unwrap();
    assert_says(&refused(folder.path(), &["check", "folder.toml"], 2), &["folder.toml"]);
}

#[test]
fn options_out_of_range_are_refused_before_the_trace() {
    let folder = folder_with_scene();
    let render = |more: &[&str]| {
        let mut arguments = vec!["render", "scene.toml", "-o", "a.png"];
        arguments.extend(more);
        refused(folder.path(), &arguments, 2)
    };
    assert_says(&render(&["--size", "0x0"]), &["--size", "1 to 65536"]);
    assert_says(&render(&["--size", "900000x900000"]), &["--size", "900000"]);
    assert_says(&render(&["--size", "65536x65536"]), &["--size", "too large"]);
    assert_says(&render(&["--size", "99999999999x1"]), &["--size", "99999999999x1"]);
    assert_says(&render(&["--size", "wide"]), &["--size", "wide"]);
    assert_says(&render(&["--samples", "0"]), &["--samples", "1 to 4096"]);
    assert_says(&render(&["--samples=-1"]), &["--samples"]);
    assert_says(&render(&["--threads", "0"]), &["--threads"]);
    assert_says(&render(&["--memory", "nan"]), &["--memory"]);
    assert_says(&render(&["--bits", "12"]), &["--bits", "16"]);
    for option in ["--set", "--edit"] {
        let unknown = render(&[option, "materials.miror.reflect=0.5"]);
        assert_says(&unknown, &[option, "no such parameter", "materials.mirror.reflect"]);
        assert_says(&render(&[option, "trace.depth=65"]), &[option, "0 to 64"]);
        assert_says(&render(&[option, "trace.depth"]), &[option, "PATH=VALUE"]);
        assert_says(&render(&[option, "trace.depth=[[["]), &[option, "trace.depth"]);
        assert_says(&render(&[option, "camera.eye=[0, 0, 0]"]), &[option, "camera.eye"]);
        assert_says(&render(&[option, "=1"]), &[option, "no such parameter"]);
    }
}

#[test]
fn commands_that_do_not_exist_are_refused() {
    let folder = folder_with_scene();
    refused(folder.path(), &["rendr", "scene.toml", "-o", "a.png"], 2);
    let unknown = refused(folder.path(), &["rendr"], 2);
    assert_says(&unknown, &["rendr", "neither a command nor a scene file"]);
    refused(folder.path(), &["render", "scene.toml"], 2);
    refused(folder.path(), &["bench"], 2);
    refused(folder.path(), &["scene.toml", "check", "scene.toml"], 2);
    assert_says(&refused(folder.path(), &["check", "scene.toml", "--fast"], 2), &["--fast"]);
}

#[test]
fn pixels_outside_are_refused() {
    let folder = folder_with_scene();
    for pixel in ["48,0", "0,27", "4294967295,0"] {
        let message = refused(folder.path(), &["inspect", "scene.toml", "--pixel", pixel], 2);
        assert_says(&message, &[pixel, "outside the picture", "47,26"]);
    }
    for pixel in ["1", "a,b", "1,-1", "1,2,3", "4294967296,0"] {
        let argument = format!("--pixel={pixel}");
        let message = refused(folder.path(), &["inspect", "scene.toml", &argument], 2);
        assert_says(&message, &["--pixel", pixel]);
    }
}

#[test]
fn places_that_cannot_be_written_are_named() {
    let folder = folder_with_scene();
    let render =
        |output: &str, code| refused(folder.path(), &["render", "scene.toml", "-o", output], code);
    std::fs::create_dir(folder.path().join("folder.png")).unwrap();
    for output in ["no/such/a.png", "scene.toml/a.png", "folder.png"] {
        assert_says(&render(output, 1), &["cannot write", output]);
    }
    for output in ["a.jpg", "a", ".png", "a.png.txt"] {
        assert_says(&render(output, 2), &[".png, .exr or .hdr"]);
    }
    // Found before the trace: no picture without its statistics.
    let arguments = ["render", "scene.toml", "-o", "a.png", "--stats", "no/such/a.json"];
    assert_says(&refused(folder.path(), &arguments, 1), &["cannot write", "no/such/a.json"]);
    let arguments = ["bench", "scene.toml", "--json", "no/such/b.json"];
    assert_says(&refused(folder.path(), &arguments, 1), &["cannot write", "no/such/b.json"]);
}

#[test]
fn too_little_memory_is_told_and_leaves_no_picture() {
    let folder = folder_with_scene();
    let mut arguments = vec!["render", "scene.toml", "-o", "a.png", "--memory", "0.000001"];
    assert_says(&refused(folder.path(), &arguments, 1), &["memory", "budget"]);
    // The largest picture of all, within little memory.
    arguments.extend(["--size", "16384x16384", "--samples", "1"]);
    arguments[5] = "0.01";
    assert_says(&refused(folder.path(), &arguments, 1), &["memory", "0.01 GiB"]);
}

#[test]
#[should_panic(expected = "left something behind")]
fn what_is_left_behind_is_found() {
    let folder = folder_with_scene();
    let arguments = ["render", "scene.toml", "-o", "a.png"];
    let before = names_in(folder.path());
    run(folder.path(), &arguments);
    assert_eq!(names_in(folder.path()), before, "it left something behind");
}
