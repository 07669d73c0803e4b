//! A still in parts on the command line: merged files are those of one render.

use serde_json::Value;

use super::{folder_with_scene, names_in, run, succeed};

const SIZE: [&str; 2] = ["--size", "150x90"];

#[test]
fn merged_files_are_those_of_one_render() {
    let folder = folder_with_scene();
    for number in 1..=3 {
        let (share, file) = (format!("{number}/3"), format!("{number}.part"));
        let mut arguments = vec!["render", "scene.toml", "--tile", &share, "-o", &file];
        arguments.extend(SIZE);
        arguments.extend(["--set", "picture.exposure=0.5", "--threads", "1"]);
        let ran = succeed(folder.path(), &arguments);
        assert!(ran.results.starts_with(&format!("{file}: part {share}, 5 of 15 tiles")));
    }
    for (name, bits) in [("8.png", "8"), ("16.png", "16"), ("x.exr", "8")] {
        let (one, merged) = (format!("one-{name}"), format!("merged-{name}"));
        let mut arguments = vec!["render", "scene.toml", "-o", &one, "--bits", bits];
        arguments.extend(SIZE);
        arguments.extend(["--set", "picture.exposure=0.5"]);
        succeed(folder.path(), &arguments);
        let parts = ["merge", "3.part", "1.part", "2.part", "--bits", bits, "-o", &merged];
        let ran = succeed(folder.path(), &parts);
        assert_eq!(ran.results, format!("{merged}: 150×90 from 3 parts\n"));
        let bytes = |name: &str| std::fs::read(folder.path().join(name)).unwrap();
        assert!(bytes(&one) == bytes(&merged), "{name}");
    }
}

#[test]
fn a_part_tells_its_statistics() {
    let folder = folder_with_scene();
    let mut arguments = vec!["render", "scene.toml", "--tile", "2/7", "-o", "a.part"];
    arguments.extend(SIZE);
    arguments.extend(["--stats", "-"]);
    let stats: Value = serde_json::from_str(&succeed(folder.path(), &arguments).results).unwrap();
    assert_eq!((&stats["part"], &stats["of_tiles"]), (&"2/7".into(), &15.into()));
    let tiles = stats["tiles"].as_u64().unwrap();
    let camera = stats["rays"]["camera"].as_u64().unwrap();
    assert!((2..=3).contains(&tiles) && 0 < camera && camera <= tiles * 32 * 32 * 2);
}

#[test]
fn parts_that_cannot_be_are_refused() {
    let folder = folder_with_scene();
    let refused = |arguments: &[&str], words: &[&str]| {
        let before = names_in(folder.path());
        let ran = run(folder.path(), arguments);
        assert_eq!((ran.code, ran.results.as_str()), (Some(2), ""), "{arguments:?}");
        assert!(words.iter().all(|word| ran.messages.contains(word)), "{}", ran.messages);
        assert_eq!(names_in(folder.path()), before, "{arguments:?} left something behind");
    };
    let render = ["render", "scene.toml", "--tile", "1/2", "-o"];
    refused(&[&render[..], &["a.png"]].concat(), &["a.png", "must end in .part"]);
    for option in [["--edit", "trace.depth=3"], ["--bits", "16"]] {
        refused(&[&render[..], &["a.part"], &option].concat(), &[option[0], "--tile"]);
    }
    refused(&[&render[..], &["a.part", "--cache"]].concat(), &["--cache", "--tile"]);
    for share in ["0/2", "3/2", "half"] {
        refused(&["render", "scene.toml", "-o", "a.part", "--tile", share], &[share, "3/8"]);
    }
    succeed(folder.path(), &[&render[..], &["a.part"]].concat());
    refused(&["merge", "a.part", "-o", "b.png"], &["a.part", "part 2/2 is missing"]);
    refused(&["merge", "a.part", "scene.toml", "-o", "b.png"], &["scene.toml", "no part"]);
    refused(&["merge", "a.part", "no.part", "-o", "b.png"], &["no.part"]);
    refused(&["merge", "a.part", "-o", "b.gif"], &[".png, .exr or .hdr"]);
    refused(&["merge", "-o", "b.png"], &["PARTS"]);
}
