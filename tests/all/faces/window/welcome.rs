//! The welcome, and examples that are traced once and then open without a ray.

use rayforest::document::examples::{EXAMPLES, folder};

use super::*;
use crate::faces::SCENE;

/// A window that was started without a scene.
fn started(folder: tempfile::TempDir, answers: Vec<Answer>) -> Window {
    let mut window = Window::in_folder(folder, None, answers);
    window.harness.run_steps(3);
    window
}

fn fresh() -> Window {
    started(tempfile::tempdir().unwrap(), Vec::new())
}

/// The folder of a window that is closed.
fn closed(window: Window) -> tempfile::TempDir {
    let Window { harness, folder } = window;
    drop(harness);
    folder
}

impl Window {
    fn welcomes(&self) -> bool {
        self.shows("Welcome to Rayforest")
    }

    /// Waits until an example is kept, longer than for other things: it is traced at full size.
    fn until_kept(&mut self, name: &str) -> PathBuf {
        let cache = folder(&self.file("cache"));
        let kept = cache.join(name).with_extension("rayforest-cache");
        self.until_written(&kept, 1);
        kept
    }

    /// Waits until a file has a length.
    fn until_written(&mut self, file: &Path, least: u64) {
        let start = Instant::now();
        while std::fs::metadata(file).map_or(0, |data| data.len()) < least {
            assert!(start.elapsed() < 5 * PATIENCE, "{} is not kept", file.display());
            self.harness.step();
            std::thread::sleep(Duration::from_millis(10));
        }
    }

    /// Opens an example by its card.
    fn open_example(&mut self, title: &str) {
        self.click(&format!("card {title}"));
        self.until("the example is open", |app| app.document().title() == title);
        self.until_exact();
    }
}

#[test]
fn a_start_without_a_scene_welcomes_and_the_picture_comes_all_the_same() {
    let mut window = fresh();
    assert!(window.welcomes());
    window.until("a picture shows", |app| app.shown().is_some());
    assert_eq!(window.app().document().title(), EXAMPLES[0].title);
    for example in EXAMPLES {
        assert!(window.button(&format!("card {}", example.title)).is_some(), "{}", example.title);
    }
    // Escape closes it and stops nothing.
    window.key(Modifiers::NONE, Key::Escape);
    assert!(!window.welcomes() && !window.app().live().status().held);
    window.menu(&["Help", "Welcome"]);
    assert!(window.welcomes());
    window.click("Close welcome");
    assert!(!window.welcomes());
}

#[test]
fn it_makes_room_for_work() {
    let mut window = fresh();
    window.until("a picture shows", |app| app.shown().is_some());
    window.click("mirror");
    window.drag_slider("diffuse", 0.7);
    window.harness.run_steps(3);
    assert!(window.app().document().is_unsaved() && !window.welcomes());
}

#[test]
fn it_can_be_done_without() {
    let mut window = fresh();
    window.click("Show at the start");
    assert!(window.welcomes(), "until it is closed");
    let mut window = started(closed(window), Vec::new());
    assert!(!window.welcomes());
    window.menu(&["Help", "Welcome"]);
    window.click("Show at the start");
    assert!(started(closed(window), Vec::new()).welcomes());
}

#[test]
fn the_first_scene_is_traced_at_the_first_start_alone() {
    let mut window = fresh();
    window.until_kept("whitted");
    window.until_exact();
    assert!(!window.shows("opened from what was kept"));
    let first = window.picture();
    let mut window = started(closed(window), Vec::new());
    window.until_text("opened from what was kept · ");
    window.until_exact();
    assert!(window.shows("· 0 rays") && window.picture() == first);
}

#[test]
fn what_was_traced_of_examples_opens_without_a_ray() {
    let mut window = fresh();
    window.open_example("Three matte solids");
    assert!(!window.shows("opened from what was kept"));
    let second = window.picture();
    let kept = window.until_kept("plain");
    assert!(!window.shows("kept traced in"), "nobody asked for it");
    // The next opening casts no ray.
    let mut window = started(closed(window), Vec::new());
    let time = std::fs::metadata(&kept).unwrap().modified().unwrap();
    window.open_example("Three matte solids");
    window.until_text("opened from what was kept · ");
    assert!(window.shows("· 0 rays") && window.picture() == second);
    window.until("it is the most recently used", |_| {
        std::fs::metadata(&kept).unwrap().modified().unwrap() > time
    });
    // What cannot be used is traced again, and kept again, without a word.
    let whole = std::fs::read(&kept).unwrap();
    std::fs::write(&kept, &whole[..whole.len() - 5]).unwrap();
    let mut window = started(closed(window), Vec::new());
    window.open_example("Three matte solids");
    window.until_written(&kept, whole.len() as u64 - 4);
    assert!(window.picture() == second && !window.shows("what was kept is not used"));
}

#[test]
fn an_example_that_is_opened_again_casts_no_ray() {
    let mut window = fresh();
    window.open_example("Three matte solids");
    let first = window.picture();
    for other in ["Machined part", "Whitted's spheres"] {
        window.menu(&["Help", "Welcome"]);
        window.open_example(other);
        window.menu(&["Help", "Welcome"]);
        window.open_example("Three matte solids");
        window.until_text("opened from what was kept · ");
        assert!(window.shows("· 0 rays") && window.picture() == first);
    }
}

#[test]
fn an_example_is_a_copy() {
    let folder = tempfile::tempdir().unwrap();
    let target = folder.path().join("mine.toml");
    let mut window = started(folder, vec![Answer::File(target.clone())]);
    window.open_example("Three matte solids");
    assert!(!window.welcomes() && window.app().document().path().is_none());
    window.click("clay");
    window.type_into("diffuse value", "0.125");
    window.menu(&["Help", "Welcome"]);
    window.click("card Whitted's spheres");
    window.until_text("Save the changes to Three matte solids?");
    window.click("Cancel");
    assert!(window.welcomes() && window.app().document().is_unsaved());
    window.save();
    assert!(window.app().document().path() == Some(&target));
    assert!(std::fs::read_to_string(&target).unwrap().contains("0.125"));
    window.open_example("Three matte solids");
    assert!(window.app().document().path().is_none() && !window.app().document().is_unsaved());
}

#[test]
fn recent_files_have_cards_with_thumbnails() {
    let mut window = Window::with_scene(SCENE, Vec::new());
    let thumbnails = window.file("cache/thumbnails");
    window.until("a thumbnail is kept", |_| {
        std::fs::read_dir(&thumbnails).is_ok_and(|files| files.count() == 1)
    });
    let path = window.file("scene.toml");
    let mut window = started(closed(window), Vec::new());
    window.click("card scene.toml");
    window.until("it is open", |app| app.document().path() == Some(&path));
    assert!(!window.welcomes());
    // One that is gone has none.
    std::fs::remove_file(path).unwrap();
    window.menu(&["Help", "Welcome"]);
    assert!(window.welcomes() && window.button("card scene.toml").is_none());
}

#[test]
fn escape_leaves_what_lies_over_the_welcome_first() {
    let mut window = fresh();
    for (modifiers, key, text) in [
        (Modifiers::COMMAND, Key::K, "Starts a scene from this template"),
        (Modifiers::NONE, Key::Questionmark, "Keys and gestures"),
    ] {
        window.key(modifiers, key);
        window.harness.run_steps(3);
        assert!(window.shows(text) && window.welcomes(), "{text}: {:#?}", window.texts());
        window.key(Modifiers::NONE, Key::Escape);
        window.harness.run_steps(3);
        assert!(!window.shows(text) && window.welcomes(), "{text}");
    }
    window.key(Modifiers::NONE, Key::Escape);
    assert!(!window.welcomes());
}
