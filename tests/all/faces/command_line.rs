//! The commands with sound input: files, statistics, results on standard output.

use std::path::Path;

use rayforest::progress::Progress;
use rayforest::scene::read;
use rayforest::session::{Options, Session};
use serde_json::Value;

use super::{SCENE, decode_png, folder_with_scene, names_in, run, succeed};

fn json(path: &Path) -> Value {
    serde_json::from_slice(&std::fs::read(path).unwrap()).unwrap()
}

#[test]
fn an_edit_gives_the_file_that_the_setting_gives() {
    let folder = folder_with_scene();
    let at = |name: &str| std::fs::read(folder.path().join(name)).unwrap();
    let changes = [
        "materials.tiles.texture.checker.b=[0.1, 0.4, 0.2]",
        "materials.mirror.shininess=7",
        "materials.mirror.reflect=0.8",
        "materials.tiles.reflect=0.2",
        "lights.fill.on=false",
        "picture.exposure=-0.5",
        "materials.tiles.reflect=0.1",
        "camera.fov_degrees=50",
        "lights.key.color = [1, 0.9, 0.5]",
    ];
    for (name, bits) in [("8.png", "8"), ("16.png", "16"), ("x.exr", "8")] {
        for option in ["--set", "--edit"] {
            let file = format!("{option}-{name}");
            let mut arguments = vec!["render", "scene.toml", "--bits", bits, "-o"];
            let relative = format!("./{file}");
            arguments.push(&relative);
            for change in changes {
                arguments.extend([option, change]);
            }
            let ran = succeed(folder.path(), &arguments);
            assert!(ran.results.contains(&file), "{}", ran.results);
            assert_eq!(ran.messages.lines().count(), if option == "--edit" { 9 } else { 0 });
        }
        let (set, edit) = (at(&format!("--set-{name}")), at(&format!("--edit-{name}")));
        assert!(set == edit, "{name}: {} and {} bytes", set.len(), edit.len());
        let inside = b"checker = { a = [0.9, 0.8, 0.2], b = [0.1, 0.4, 0.2]";
        assert!(set.windows(inside.len()).any(|w| w == inside), "{name} lacks its scene");
    }
    let depth = |name: &str| decode_png(&folder.path().join(name)).unwrap().1;
    assert_eq!((depth("--set-8.png"), depth("--edit-16.png")), (8, 16));
    succeed(folder.path(), &["render", "scene.toml", "-o", "plain.png"]);
    assert!(at("plain.png") != at("--set-8.png"), "the changes change the picture");
    assert_eq!(names_in(folder.path()).len(), 8, "nothing is left over");
}

#[test]
fn statistics_tell_class_rays_pixels_and_time_of_every_edit() {
    let folder = folder_with_scene();
    let edits = [
        ("materials.mirror.diffuse=0.1", "reshade", 0),
        ("materials.mirror.diffuse=0.1", "none", 0),
        ("materials.mirror.shininess=3", "refold", 0),
        // As many as see the tiles, whose glow would change them.
        ("materials.tiles.reflect=0.5", "regrow", 1146),
        ("materials.tiles.reflect=0.3", "reshade", 0),
        ("camera.eye=[0, -6, 3]", "retrace", 48 * 27),
    ];
    let mut arguments = vec!["render", "scene.toml", "-o", "a.png", "--stats", "a.json"];
    for (edit, ..) in &edits {
        arguments.extend(["--edit", *edit]);
    }
    succeed(folder.path(), &arguments);
    let stats = json(&folder.path().join("a.json"));
    assert_eq!(stats["size"], serde_json::json!([48, 27]));
    assert_eq!(stats["samples"], 2);
    assert_eq!(stats["primitives"], 2);
    assert_eq!(stats["rays"]["camera"], 48 * 27 * 2);
    assert!(stats["nodes"].as_u64().unwrap() > 0 && stats["trace_s"].as_f64().unwrap() > 0.0);
    assert_eq!(stats["edits"].as_array().unwrap().len(), edits.len());
    for ((edit, class, pixels), told) in edits.iter().zip(stats["edits"].as_array().unwrap()) {
        assert_eq!(told["edit"], *edit);
        assert_eq!(told["class"], *class, "{edit}");
        assert_eq!(told["pixels"], *pixels, "{edit}");
        let rays = &told["rays"];
        let kinds = ["camera", "reflected", "transmitted", "shadow"];
        let sum: u64 = kinds.iter().map(|kind| rays[kind].as_u64().unwrap()).sum();
        assert_eq!(rays["total"], sum);
        let grown = ["regrow", "retrace"].contains(class);
        assert_eq!(sum > 0, grown, "{edit}");
        assert_eq!(told["reason"].is_string(), grown, "{edit}");
        assert!(told["milliseconds"].as_f64().unwrap() >= 0.0);
    }
    let reason = stats["edits"][3]["reason"].as_str().unwrap();
    assert_eq!(reason, "the branch reflect(tiles) comes alive");
}

#[test]
fn statistics_on_standard_output_are_nothing_but_json() {
    let folder = folder_with_scene();
    let ran = succeed(folder.path(), &["render", "scene.toml", "-o", "a.png", "--stats", "-"]);
    let stats: Value = serde_json::from_str(&ran.results).unwrap();
    assert_eq!(stats["edits"], serde_json::json!([]));
    assert_eq!(names_in(folder.path()), ["a.png", "scene.toml"]);
}

#[test]
fn size_samples_threads_and_memory_are_obeyed() {
    let folder = folder_with_scene();
    let mut arguments = vec!["render", "scene.toml", "-o", "a.png", "--stats", "a.json"];
    arguments.extend(["--size", "70x40", "--samples", "3", "--threads", "3", "--memory", "0.5"]);
    succeed(folder.path(), &arguments);
    let stats = json(&folder.path().join("a.json"));
    assert_eq!(stats["size"], serde_json::json!([70, 40]));
    assert_eq!((&stats["samples"], &stats["threads"]), (&3.into(), &3.into()));
    assert_eq!(stats["memory_budget"], 1u64 << 29);
    assert_eq!(decode_png(&folder.path().join("a.png")).unwrap().0, [70, 40]);
}

#[test]
fn check_praises_a_sound_scene() {
    let folder = folder_with_scene();
    let ran = succeed(folder.path(), &["check", "scene.toml"]);
    assert_eq!(ran.results, "scene.toml: no mistakes; 2 solids, 2 materials, 2 lights\n");
    assert_eq!(ran.messages, "");
}

/// The three numbers before the word or the percentage that ends them.
fn three(words: &[&str]) -> [f64; 3] {
    [0, 1, 2].map(|i| words[i].parse().unwrap_or_else(|_| panic!("a number in {words:?}")))
}

/// Light of the pixel, and the sums of light and of percentages over its terms, as printed.
fn shares(text: &str) -> ([f64; 3], [f64; 3], f64) {
    let mut sum = [0.0; 3];
    let (mut percent, mut pixel) = (0.0, None);
    let lines = text.lines().skip_while(|line| !line.starts_with("terms:")).skip(1);
    for line in lines {
        let words: Vec<&str> = line.split_whitespace().collect();
        if words[0] == "pixel:" {
            pixel = Some(three(&words[1..]));
        } else {
            let light = three(&words[1..]);
            sum = [0, 1, 2].map(|i| sum[i] + light[i]);
            percent += words[4].parse::<f64>().unwrap();
            assert_eq!(words[5], "%", "{line}");
        }
    }
    (pixel.expect("a last line with the pixel"), sum, percent)
}

fn near(a: [f64; 3], b: [f64; 3], tolerance: f64) -> bool {
    (0..3).all(|i| (a[i] - b[i]).abs() <= tolerance)
}

#[test]
fn inspected_shares_add_up_to_the_pixel_of_the_film() {
    let folder = folder_with_scene();
    let scene = read::text(SCENE, Path::new("scene.toml")).unwrap();
    let session = Session::open(scene, Options::default(), &Progress::default()).unwrap();
    let film = session.film();
    for [x, y] in [[0, 0], [24, 13], [20, 24], [47, 26], [30, 9], [24, 5]] {
        let pixel = format!("{x},{y}");
        let ran = succeed(folder.path(), &["inspect", "scene.toml", "--pixel", &pixel]);
        let (told, sum, percent) = shares(&ran.results);
        let light = film.pixel([x, y]).0.map(f64::from);
        // Six decimals are printed, and there are fewer than forty terms.
        assert!(near(told, light, 1e-6), "{pixel}: printed {told:?}, the film has {light:?}");
        assert!(near(sum, light, 2e-5), "{pixel}: shares add up to {sum:?}, not {light:?}");
        let black = light.iter().all(|c| *c == 0.0);
        assert!(black || (percent - 100.0).abs() < 2.0, "{pixel}: {percent} %");
    }
}

#[test]
fn shares_that_do_not_add_up_are_found() {
    let text = "sample 1\nterms: …\n  0.5  0.1 0.2 0.3  40.0 %  a · b\n  0.5  0.1 0.2 0.3  60.0 %  c\n\
                pixel: 0.2 0.4 0.6 linear\n";
    let (pixel, sum, percent) = shares(text);
    assert_eq!(percent, 100.0);
    assert!(near(pixel, sum, 1e-9) && !near(pixel, [0.2, 0.4, 0.6001], 2e-5));
}

#[test]
fn inspect_shows_one_tree_or_all() {
    let folder = folder_with_scene();
    let arguments = ["inspect", "scene.toml", "--pixel", "24,13", "--all-samples"];
    let one = succeed(folder.path(), &arguments[..4]).results;
    let all = succeed(folder.path(), &arguments).results;
    assert!(one.contains("sample 1 of 2") && !one.contains("sample 2 of 2"), "{one}");
    assert!(all.contains("sample 1 of 2") && all.contains("sample 2 of 2"), "{all}");
    assert!(one.contains("eye ray → solid ball, material mirror"), "{one}");
    assert!(one.contains("light key: N·L"), "{one}");
    let scene = read::text(SCENE, Path::new("scene.toml")).unwrap();
    let session = Session::open(scene, Options::default(), &Progress::default()).unwrap();
    let [r, g, b, _] = session.frame().pixel([24, 13]);
    let shown = format!("shown: sRGB {r} {g} {b}, #{r:02X}{g:02X}{b:02X}; 2 samples");
    assert!(one.contains(&shown), "{one}");
}

#[test]
fn help_is_a_result_and_names_every_command() {
    let folder = tempfile::tempdir().unwrap();
    let ran = run(folder.path(), &["--help"]);
    assert_eq!((ran.code, ran.messages.as_str()), (Some(0), ""));
    for command in ["render", "merge", "chart", "bench", "inspect", "check", "language"] {
        assert!(ran.results.contains(command), "{command}");
    }
}
