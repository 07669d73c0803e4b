//! `render --cache`: what is kept beside the scene is used if it fits, and is told about.

use std::path::Path;

use serde_json::Value;

use super::{Ran, SCENE, folder_with_scene, names_in, succeed};

/// Renders with the cache; the one line of messages, and the statistics of the cache.
fn render(folder: &Path, more: &[&str]) -> (String, Value) {
    let arguments = ["render", "scene.toml", "-o", "a.png", "--cache", "--stats", "a.json"];
    let Ran { messages, .. } = succeed(folder, &[&arguments, more].concat());
    assert_eq!(messages.lines().count(), 1, "{messages}");
    let stats = std::fs::read(folder.join("a.json")).unwrap();
    let stats: Value = serde_json::from_slice(&stats).unwrap();
    (messages, stats["cache"].clone())
}

/// Whether the picture of the scene file, traced without a cache, has the bytes of `a.png`.
fn is_exact(folder: &Path) -> bool {
    succeed(folder, &["render", "scene.toml", "-o", "fresh.png"]);
    let at = |name: &str| std::fs::read(folder.join(name)).unwrap();
    at("a.png") == at("fresh.png")
}

#[test]
fn the_second_run_casts_no_ray_and_neither_does_a_saved_colour() {
    let folder = folder_with_scene();
    let folder = folder.path();
    let (line, stats) = render(folder, &[]);
    assert!(
        line.contains("scene.rayforest-cache: not used: there is no such file; kept "),
        "{line}"
    );
    assert!(stats["written"]["file_bytes"].as_u64().unwrap() > 0 && stats["read"].is_null());
    assert!(names_in(folder).contains(&"scene.rayforest-cache".to_owned()));
    let first = std::fs::read(folder.join("scene.rayforest-cache")).unwrap();
    for (scene, class) in [
        (SCENE.to_owned(), "none"),
        (SCENE.replace("[0.9, 0.8, 0.2]", "[0.2, 0.9, 0.8]"), "reshade"),
        (SCENE.replace("specular = 0.6", "specular = 0.6\nshininess = 9"), "refold"),
    ] {
        std::fs::write(folder.join("scene.toml"), &scene).unwrap();
        let (line, stats) = render(folder, &[]);
        assert!(line.trim_end().ends_with(&format!("{class}, 0 rays")), "{line}");
        assert_eq!((&stats["class"], &stats["rays"]), (&class.into(), &0.into()));
        assert!(stats["written"].is_null());
        assert!(is_exact(folder), "{class}");
    }
    let now = std::fs::read(folder.join("scene.rayforest-cache")).unwrap();
    assert!(now == first, "what fits is not written again");
}

#[test]
fn what_does_not_fit_is_told_and_kept_anew() {
    let folder = folder_with_scene();
    let folder = folder.path();
    let cache = folder.join("scene.rayforest-cache");
    render(folder, &[]);
    let (line, _) = render(folder, &["--size", "50x20"]);
    assert!(line.contains("not used") && line.contains("48×27, it is 50×20; kept"), "{line}");
    let (line, _) = render(folder, &[]);
    assert!(line.contains("50×20, it is 48×27; kept"), "{line}");
    let moved = SCENE.replace("[-4, -5, 7]", "[-4, -5, 6]");
    std::fs::write(folder.join("scene.toml"), moved).unwrap();
    let (line, stats) = render(folder, &[]);
    assert!(line.contains(" rays; kept ") && stats["rays"].as_u64() > Some(0), "{line}");
    assert!(is_exact(folder), "a moved light");
    let (line, _) = render(folder, &[]);
    assert!(line.trim_end().ends_with("none, 0 rays"), "{line}");
    let mut bytes = std::fs::read(&cache).unwrap();
    let middle = bytes.len() / 2;
    bytes[middle] ^= 4;
    std::fs::write(&cache, bytes).unwrap();
    let (line, _) = render(folder, &[]);
    assert!(line.contains("not used: it is damaged") && line.contains("; kept "), "{line}");
    assert!(is_exact(folder), "a damaged file");
}

#[test]
fn a_file_of_someone_else_is_left_alone() {
    let folder = folder_with_scene();
    let cache = folder.path().join("scene.rayforest-cache");
    std::fs::write(&cache, "my own notes").unwrap();
    let (line, stats) = render(folder.path(), &[]);
    assert!(line.trim_end().ends_with("not used: this is no cache of Rayforest"), "{line}");
    assert!(stats["written"].is_null());
    assert_eq!(std::fs::read(&cache).unwrap(), b"my own notes");
    assert!(is_exact(folder.path()));
}
