//! Pictures of the window: for the eye, in two sizes, zooms and themes, and for the README.

use std::path::Path;
use std::time::{Duration, Instant};

use eframe::egui::accesskit::Role;
use eframe::egui::{Key, Pos2, pos2, vec2};

use super::twin::Twin;
use super::{Desk, PATIENCE, SIZE};

/// A screen that is the same for this long has come to rest.
const REST: Duration = Duration::from_millis(1200);

/// Waits until the screen has been the same for a while; not for ever, as a text cursor blinks.
fn until_still(desk: &Desk) {
    let start = Instant::now();
    let (mut last, mut since) = (desk.server.shot(), start);
    while since.elapsed() < REST && start.elapsed() < 6 * REST {
        std::thread::sleep(Duration::from_millis(100));
        let shot = desk.server.shot();
        if shot != last {
            (last, since) = (shot, Instant::now());
        }
    }
}

/// Shows one window after the other: the scene, a material, a light, a solid, all panels, and
/// questions.
fn take_pictures(size: [u16; 2], zoom_percent: u32, theme: &str) {
    let mut desk = Desk::new(size);
    let scene =
        include_str!("../../../../scenes/whitted.toml").replace("[1280, 720]", "[640, 360]");
    std::fs::write(desk.file("scene.toml"), scene).unwrap();
    // The outline begins at the upper left, whatever the size of the window.
    let twin = Twin::new(&desk.file("scene.toml"), None);
    let settings = desk.file("config/rayforest");
    std::fs::create_dir_all(&settings).unwrap();
    let text = format!("theme = \"{theme}\"\nzoom_percent = {zoom_percent}\n");
    std::fs::write(settings.join("settings.toml"), text).unwrap();
    desk.start();
    let take = |name: &str, desk: &Desk| {
        until_still(desk);
        let [width, height] = size;
        let shot = desk.server.shot();
        shot.keep(&format!("window-{width}x{height}-{zoom_percent}-{theme}-{name}"));
    };
    let at = |p: Pos2| (p.to_vec2() * (zoom_percent as f32 / 100.0)).to_pos2();
    let rest = pos2(f32::from(size[0]) * 0.07, f32::from(size[1]) * 0.8);
    take("scene", &desk);
    for (name, line) in [("material", "glass"), ("light", "key"), ("solid", "glass-ball")] {
        desk.click(at(twin.rect(Role::Button, line).center()));
        until_still(&desk);
        desk.point(rest);
        take(name, &desk);
    }
    desk.click(at(pos2(20.0, 14.0)));
    take("menu", &desk);
    desk.press("Escape");
    until_still(&desk);
    desk.press("ctrl+e");
    take("export", &desk);
    desk.press("Escape");
    until_still(&desk);
    desk.press("ctrl+shift+s");
    take("path", &desk);
    desk.press("Escape");
    until_still(&desk);
    desk.press("i");
    until_still(&desk);
    let picture = pos2(f32::from(size[0]) * 0.4, f32::from(size[1]) * 0.35);
    desk.point(picture);
    desk.server.xdotool(&["mousedown", "1", "mouseup", "1"]);
    take("pixel", &desk);
    desk.point(pos2(f32::from(size[0]) * 0.32, f32::from(size[1]) - at(pos2(0.0, 150.0)).y));
    take("pixel-line", &desk);
    desk.press("i");
    for (name, command) in [
        ("mass", "Mass properties"),
        ("chart", "Speed and accuracy"),
        ("mixer", "Light mixer"),
        ("looks", "Looks"),
        ("keys", "Keys and gestures"),
    ] {
        let choose = |desk: &Desk| {
            desk.press("ctrl+k");
            until_still(desk);
            desk.server.xdotool(&["type", command]);
            until_still(desk);
            desk.press("Return");
        };
        choose(&desk);
        desk.point(rest);
        take(name, &desk);
        match name {
            "keys" => desk.press("Escape"),
            _ => choose(&desk),
        }
    }
}

#[test]
#[ignore = "makes pictures for the eye in target/test-pictures"]
fn the_window_in_all_sizes_zooms_and_themes() {
    for size in [[1280, 720], [1920, 1080]] {
        for zoom_percent in [100, 125] {
            for theme in ["light", "dark"] {
                take_pictures(size, zoom_percent, theme);
            }
        }
    }
}

/// Bytes of a picture of the README: it may be full of thumbnails.
const MOST_BYTES: u64 = 450_000;

/// Waits until the cache folder holds a file: the picture is then exact.
fn until_cached(desk: &Desk, folder: &str) {
    let (folder, start) = (desk.file("cache/rayforest").join(folder), Instant::now());
    while std::fs::read_dir(&folder).map_or(0, Iterator::count) == 0 {
        assert!(start.elapsed() < 10 * PATIENCE, "nothing is in {}", folder.display());
        std::thread::sleep(Duration::from_millis(100));
    }
}

/// Puts what the screen shows into the README's pictures, once it has come to rest.
fn put(desk: &Desk, name: &str) {
    until_still(desk);
    let shot = desk.server.shot().keep(name);
    let target = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("assets/{name}.png"));
    std::fs::copy(shot, &target).unwrap();
    let bytes = std::fs::metadata(&target).unwrap().len();
    assert!(bytes <= MOST_BYTES, "{name}: {bytes} bytes");
}

#[test]
#[ignore = "makes the README's pictures of the window in assets"]
fn the_pictures_of_the_readme() {
    let mut desk = Desk::new(SIZE);
    desk.start_with(&[]);
    until_cached(&desk, concat!("examples/", env!("CARGO_PKG_VERSION")));
    put(&desk, "welcome");
    desk.kill();
    let scene = include_str!("../../../../scenes/whitted.toml");
    std::fs::write(desk.file("scene.toml"), scene).unwrap();
    desk.start();
    // The same window with a smaller picture, which is traced at once.
    std::fs::write(desk.file("small.toml"), scene.replace("[1280, 720]", "[320, 180]")).unwrap();
    let mut twin = Twin::new(&desk.file("small.toml"), None);
    until_cached(&desk, "thumbnails");
    let line = twin.rect(Role::Button, "glass").center();
    twin.click(line);
    desk.click(line);
    let heading = twin.place("Material glass");
    desk.until_part_like(&mut twin, heading, "the material shows");
    desk.point(super::REST);
    put(&desk, "window");
    twin.press(Key::I);
    desk.press("i");
    until_still(&desk);
    let picture = twin.rect(Role::Image, "picture");
    desk.point(picture.lerp_inside(vec2(0.45, 0.5)));
    desk.server.xdotool(&["mousedown", "1", "mouseup", "1"]);
    until_still(&desk);
    desk.point(pos2(picture.center().x, picture.bottom() + 110.0));
    put(&desk, "pixel");
}
