//! Killed with unsaved work: the next start offers it, and saving it keeps the file's comments.

use std::path::Path;
use std::time::Duration;

use eframe::egui::Key;
use eframe::egui::accesskit::Role;
use serde_json::Value;

use super::edits::{drag_diffuse, handle};
use super::twin::Twin;
use super::{COMMENTED, Desk};
use crate::exact::random::Random;

/// Makes the kept work ninety minutes old, so that its age is told in the same words for a while.
fn age(folder: &Path) {
    for file in std::fs::read_dir(folder).unwrap().map(|file| file.unwrap().path()) {
        if file.extension().is_some_and(|e| e == "json") {
            let mut work: Value = serde_json::from_slice(&std::fs::read(&file).unwrap()).unwrap();
            let kept = work["kept_unix_secs"].as_u64().expect("a time");
            work["kept_unix_secs"] = (kept - 90 * 60 - 15).into();
            std::fs::write(&file, work.to_string()).unwrap();
        }
    }
}

/// Starts the program again and answers its offer.
fn recover(desk: &mut Desk) -> Twin {
    let folder = desk.file("state/rayforest/unsaved");
    age(&folder);
    let mut twin = Twin::new(&desk.file("scene.toml"), Some(&folder));
    let button = twin.place("Recover");
    desk.start();
    let offer = twin.place("Unsaved work was found").union(button);
    desk.until_part_like(&mut twin, offer, "the work is offered");
    // The button has the keyboard.
    twin.press(Key::Enter);
    desk.press("Return");
    twin.until_exact();
    desk.show_one_to_one(&mut twin);
    twin
}

/// The value of `diffuse` of the mirror in a scene's text.
fn diffuse(text: &str) -> f64 {
    let line = text.lines().find(|line| line.starts_with("diffuse")).expect("a line");
    let value = line.split(['=', '#']).nth(1).expect("a value");
    value.trim().parse().unwrap()
}

#[test]
fn work_survives_a_kill_and_is_saved_with_the_comments() {
    let (mut desk, mut twin) = Desk::with_scene();
    drag_diffuse(&mut desk, &mut twin);
    desk.until("the work is kept", |desk| !desk.kept_work().is_empty());
    desk.kill();
    assert_eq!(desk.scene_text(), COMMENTED);
    let kept = desk.kept_work();
    let kept = kept[0]["scene"].as_str().expect("a text").to_owned();
    assert!(diffuse(&kept) > 0.6, "{kept}");

    recover(&mut desk);
    desk.press("ctrl+s");
    desk.until("the file is written", |desk| desk.scene_text() != COMMENTED);
    let changed = |(a, b): &(&str, &str)| a != b;
    let text = desk.scene_text();
    let lines: Vec<_> = COMMENTED.lines().zip(text.lines()).filter(changed).collect();
    assert_eq!(lines.len(), 1, "{text}");
    assert!(lines[0].1.ends_with(" # by a slider"), "{text}");
    assert_eq!(diffuse(&text), diffuse(&kept));
    desk.until("nothing is kept any more", |desk| desk.kept_work().is_empty());
}

#[test]
fn killed_at_any_moment_the_kept_work_is_whole() {
    let (mut desk, mut twin) = Desk::with_scene();
    drag_diffuse(&mut desk, &mut twin);
    desk.until("the work is kept", |desk| !desk.kept_work().is_empty());
    let mut random = Random(11);
    for round in 0..3 {
        let before = diffuse(desk.kept_work()[0]["scene"].as_str().expect("a text"));
        // never the saved value, of which nothing would have to be kept
        let to = handle(&twin, "diffuse", 0.15 + 0.1 * f64::from(round));
        desk.drag(handle(&twin, "diffuse", before), to);
        // work is kept a second after the edit, which is when this ends
        std::thread::sleep(Duration::from_millis(900 + (random.unit() * 200.0) as u64));
        desk.kill();
        let work = desk.kept_work();
        assert_eq!(work.len(), 1, "the work of this run, or of the one before");
        let after = diffuse(work[0]["scene"].as_str().expect("a text"));
        eprintln!("diffuse {before} in front of the edit, {after} kept");
        twin = recover(&mut desk);
        let material = twin.rect(Role::Button, "mirror").center();
        twin.click(material);
        desk.click(material);
        let heading = twin.place("Material mirror");
        desk.until_part_like(&mut twin, heading, "the material is selected");
        desk.rest(&mut twin);
    }
    assert_eq!(desk.scene_text(), COMMENTED);
}
