//! Killed at any moment: under the output's name there is nothing, the old file, or a whole picture.

use std::path::Path;
use std::process::Stdio;
use std::thread;
use std::time::{Duration, Instant};

use super::{decode_png, folder_with_scene, names_in, rayforest, succeed};
use crate::exact::random::Random;

/// A picture that takes a while to write.
const LARGE: [&str; 10] =
    ["render", "scene.toml", "-o", "a.png", "--bits", "16", "--size", "800x500", "--samples", "1"];

/// What a kill left under the name of the output.
#[derive(Debug, PartialEq)]
enum Left {
    Nothing,
    Old,
    Whole,
    Broken(String),
}

fn left(output: &Path, old: &[u8]) -> Left {
    match std::fs::read(output) {
        Err(_) => Left::Nothing,
        Ok(bytes) if bytes == old => Left::Old,
        Ok(_) => match decode_png(output) {
            Ok(_) => Left::Whole,
            Err(error) => Left::Broken(error),
        },
    }
}

/// Renders a large picture, kills it after `delay`, and looks at the output.
fn kill_after(folder: &Path, delay: Duration) {
    let mut child =
        rayforest(folder, &LARGE).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    thread::sleep(delay);
    // The child may have ended by itself, which is as good.
    let _ = child.kill();
    child.wait().unwrap();
}

#[test]
fn killed_at_any_moment_it_leaves_no_half_picture() {
    let folder = folder_with_scene();
    let output = folder.path().join("a.png");
    let whole = whole_run(folder.path());
    let mut random = Random(7);
    let mut seen = [0; 3];
    for round in 0..16 {
        let old: &[u8] = if round % 2 == 0 { b"" } else { b"an older file" };
        match old {
            [] => drop(std::fs::remove_file(&output)),
            _ => std::fs::write(&output, old).unwrap(),
        }
        // Mostly towards the end, where it writes.
        let share = if round % 3 == 0 { random.unit() } else { 0.5 + 0.6 * random.unit() };
        kill_after(folder.path(), whole.mul_f64(share));
        match left(&output, old) {
            Left::Nothing => seen[0] += 1,
            Left::Old => seen[1] += 1,
            Left::Whole => seen[2] += 1,
            Left::Broken(error) => panic!("after {share:.3} of the time: {error}"),
        }
        for name in names_in(folder.path()) {
            let part = name.starts_with(".rayforest-") && name.ends_with(".part");
            assert!(part || ["a.png", "scene.toml"].contains(&name.as_str()), "{name}");
        }
    }
    eprintln!("nothing, the old file, the whole picture: {seen:?} times");
    assert!(seen[0] + seen[1] > 0, "no run was killed in time: {seen:?}");
}

/// How long the render takes that is killed.
fn whole_run(folder: &Path) -> Duration {
    let start = Instant::now();
    succeed(folder, &LARGE);
    start.elapsed()
}

#[test]
fn what_is_left_is_told_apart() {
    let folder = folder_with_scene();
    let output = folder.path().join("a.png");
    assert_eq!(left(&output, b"old"), Left::Nothing);
    std::fs::write(&output, "old").unwrap();
    assert_eq!(left(&output, b"old"), Left::Old);
    assert!(matches!(left(&output, b"older"), Left::Broken(_)));
    succeed(folder.path(), &["render", "scene.toml", "-o", "a.png"]);
    assert_eq!(left(&output, b"old"), Left::Whole);
    let bytes = std::fs::read(&output).unwrap();
    std::fs::write(&output, &bytes[..bytes.len() - 5]).unwrap();
    assert!(matches!(left(&output, b"old"), Left::Broken(_)));
}
