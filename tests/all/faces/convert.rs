//! `rayforest convert`: a scene that renders, remarks on what it could not hold, and nothing on failure.

use std::path::{Path, PathBuf};

use rayforest::scene::read;

use super::{decode_png, names_in, run, succeed};

/// A file that another program wrote.
pub(super) fn sample(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/imports").join(name)
}

/// A folder with files that other programs wrote.
pub(super) fn folder_with(names: &[&str]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for name in names {
        std::fs::copy(sample(name), folder.path().join(name)).unwrap();
    }
    folder
}

#[test]
fn what_other_programs_wrote_is_converted_checked_and_rendered() {
    for (files, solids) in [
        (&["assimp_scene.obj", "assimp_scene.mtl"] as &[&str], 2),
        (&["assimp_scene.gltf", "assimp_scene.bin"], 2),
        (&["trimesh_two.glb"], 2),
        (&["spd_teapot.nff"], 2),
    ] {
        let folder = folder_with(files);
        let ran = succeed(folder.path(), &["convert", files[0], "-o", "scene.toml"]);
        assert!(
            ran.results.starts_with(&format!("wrote scene.toml: {solids} solids")),
            "{}",
            ran.results
        );
        assert!(ran.messages.contains(files[0]), "remarks name the file: {}", ran.messages);
        let size = ["--size", "32x24", "--samples", "1"];
        let render = [&["render", "scene.toml", "-o", "a.png"], &size as &[&str]].concat();
        succeed(folder.path(), &render);
        let (_, _, bytes) = decode_png(&folder.path().join("a.png")).unwrap();
        assert!(bytes.iter().any(|byte| *byte != bytes[0]), "{}: something is seen", files[0]);
        succeed(folder.path(), &["check", "scene.toml"]);
    }
}

#[test]
fn converting_again_and_elsewhere_gives_the_same_scene() {
    let folder = folder_with(&["assimp_scene.obj", "assimp_scene.mtl", "meshio_cube.obj"]);
    let root = folder.path();
    succeed(root, &["convert", "assimp_scene.obj", "-o", "scene.toml"]);
    let first = std::fs::read(root.join("scene.toml")).unwrap();
    succeed(root, &["convert", "assimp_scene.obj", "-o", "scene.toml"]);
    assert_eq!(std::fs::read(root.join("scene.toml")).unwrap(), first);
    assert_eq!(names_in(&root.join("scene-parts")).len(), 2, "a file for each solid");
    // A file of one solid stays where it is, and is named from where the scene stands.
    std::fs::create_dir(root.join("deep")).unwrap();
    succeed(root, &["convert", "meshio_cube.obj", "-o", "deep/cube.toml"]);
    assert_eq!(names_in(&root.join("deep")), ["cube.toml"]);
    let text = std::fs::read_to_string(root.join("deep/cube.toml")).unwrap();
    assert!(text.contains("\"../meshio_cube.obj\""), "{text}");
    read::file(&root.join("deep/cube.toml")).unwrap();
}

#[test]
fn the_imported_file_is_never_written_over() {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path();
    std::fs::create_dir(root.join("scene-parts")).unwrap();
    // Its own objects would take its name.
    let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\no a\nf 1 2 3\no b\nf 3 2 1\n";
    std::fs::write(root.join("scene-parts/a.obj"), text).unwrap();
    succeed(root, &["convert", "scene-parts/a.obj", "-o", "scene.toml"]);
    assert_eq!(std::fs::read_to_string(root.join("scene-parts/a.obj")).unwrap(), text);
    assert_eq!(names_in(&root.join("scene-parts")), ["a-2.obj", "a.obj", "b.obj"]);
}

#[test]
fn what_cannot_be_converted_leaves_nothing_behind() {
    let folder = folder_with(&["trimesh_two.glb", "assimp_scene.obj"]);
    let root = folder.path();
    let whole = std::fs::read(root.join("trimesh_two.glb")).unwrap();
    std::fs::write(root.join("half.glb"), &whole[..whole.len() / 2]).unwrap();
    std::fs::write(root.join("a.stl"), "solid").unwrap();
    let before = names_in(root);
    for (input, output, words) in [
        ("half.glb", "a.toml", "half.glb: byte 8: "),
        ("assimp_scene.obj", "a.toml", "the material file `assimp_scene.mtl` cannot be read"),
        ("a.stl", "a.toml", "are not read"),
        ("no.obj", "a.toml", "no.obj: cannot be read"),
        ("trimesh_two.glb", "a.obj", "ends in .toml"),
    ] {
        let ran = run(root, &["convert", input, "-o", output]);
        assert_eq!((ran.code, ran.results.as_str()), (Some(2), ""), "{input}: {}", ran.messages);
        assert!(ran.messages.contains(words), "{input}: {}", ran.messages);
        assert_eq!(names_in(root), before, "{input}");
    }
}
