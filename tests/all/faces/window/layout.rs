//! Panels: hidden, made larger, brought back, and remembered.

use super::*;
use crate::faces::SCENE;

/// A command's key, what shows while its panel does.
const PANELS: [(Key, &str); 2] = [(Key::O, "floor"), (Key::N, "ambient_light")];

impl Window {
    /// The same folder in another window.
    fn again(self) -> Window {
        let Window { harness, folder } = self;
        let path = folder.path().join("scene.toml");
        drop(harness);
        let mut window = Window::in_folder(folder, Some(path.clone()), Vec::new());
        window.until("the scene is open", |app| app.document().path() == Some(&path));
        window.until_exact();
        window
    }

    fn view(&self) -> Rect {
        self.rect(Role::Image, "picture")
    }

    fn settings_text(&self) -> String {
        std::fs::read_to_string(self.file("config/settings.toml")).unwrap_or_default()
    }
}

#[test]
fn panels_are_hidden_by_keys_and_by_the_menu_and_the_picture_takes_their_place() {
    let mut window = Window::with_scene(SCENE, Vec::new());
    let all = window.view();
    for (key, text) in PANELS {
        assert!(window.shows(text), "{text}");
        let before = window.view();
        window.key(Modifiers::NONE, key);
        assert!(!window.shows(text), "{text}");
        assert!(window.view().width() > before.width() + 100.0);
    }
    window.menu(&["View", "Status line"]);
    assert!(!window.shows("exact"));
    assert!(window.view().height() > all.height());
    window.menu(&["View", "Reset layout"]);
    window.harness.run_steps(3);
    assert_eq!(window.view(), all);
    assert!(window.shows("exact"));
}

#[test]
fn a_name_is_changed_in_the_list_that_was_hidden() {
    let mut window = Window::with_scene(SCENE, Vec::new());
    window.click("fill");
    window.key(Modifiers::NONE, Key::O);
    assert!(!window.shows("mirror"));
    window.key(Modifiers::NONE, Key::F2);
    window.harness.run_steps(3);
    assert!(window.shows("mirror"));
    assert!(
        window.harness.query_by_role_and_label(Role::TextInput, "name of light fill").is_some()
    );
}

#[test]
fn sizes_and_hidden_panels_are_remembered_until_the_layout_is_reset() {
    let mut window = Window::with_scene(SCENE, Vec::new());
    let first = window.view();
    assert!(!window.settings_text().contains("[layout]"), "nothing was changed yet");
    // The divider is grabbed on the panel's side.
    let edge = first.left_center() - vec2(2.0, 0.0);
    window.drag(edge, edge + vec2(70.0, 0.0));
    let wide = window.view();
    assert!((wide.left() - first.left() - 70.0).abs() < 5.0, "{first} {wide}");
    window.key(Modifiers::NONE, Key::N);
    window.key(Modifiers::NONE, Key::L);
    window.harness.run_steps(3);
    let left = window.view();
    assert!(window.settings_text().contains("inspector = { shows = false }"));
    let text = window.settings_text();
    assert!(
        text.contains("mixer = { shows = true }") && text.contains("outline = { size ="),
        "{text}"
    );

    let mut window = window.again();
    assert!((window.view().left() - left.left()).abs() <= 1.0, "{} {left}", window.view());
    assert_eq!(window.view().bottom(), left.bottom());
    assert!(!window.shows("ambient_light") && window.shows("fill"));
    window.menu(&["View", "Reset layout"]);
    window.harness.run_steps(3);
    assert_eq!(window.view(), first);
    assert!(!window.settings_text().contains("[layout]"));
    assert_eq!(window.again().view(), first);
}

#[test]
fn colours_and_size_of_text_are_commands() {
    let mut window = Window::with_scene(SCENE, Vec::new());
    let is_dark = |window: &Window| window.harness.ctx.theme() == eframe::egui::Theme::Dark;
    for (name, dark) in [("Dark colours", true), ("Light colours", false)] {
        window.menu(&["View", "Colours and size", name]);
        assert_eq!(is_dark(&window), dark);
    }
    assert!(window.settings_text().contains("theme = \"light\""));
    window.menu(&["View", "Colours and size", "Size of text 125 %"]);
    window.harness.run_steps(3);
    assert_eq!(window.harness.ctx.zoom_factor(), 1.25);
    assert!(window.settings_text().contains("zoom_percent = 125"));
}

/// What shows while each panel below the picture does, and the palette's name of it.
const BELOW: [(&str, &str); 5] = [
    ("Light mixer", "Close the light mixer"),
    ("Speed and accuracy", "Close speed and accuracy"),
    ("Mass properties", "Close mass"),
    ("Pixel and its rays", "Close pixel"),
    ("Looks", "no look"),
];

/// Holds the panels that are open to be whole, one above the other, and the picture above them to have
/// room; which they are. `height` is the window's in points.
#[track_caller]
fn panels_fit(window: &Window, height: f32) -> Vec<usize> {
    let open: Vec<usize> =
        (0..BELOW.len()).filter(|i| window.button(BELOW[*i].1).is_some()).collect();
    let mut last = window.view();
    assert!(last.height() >= 99.0, "{last} of {height}");
    for i in open.iter().rev() {
        let mark = window.rect(Role::Button, BELOW[*i].1);
        assert!(mark.top() >= last.bottom() - 1.0, "{} at {mark} below {last}", BELOW[*i].0);
        // What can be resized begins at its edge: nothing is drawn over its heading.
        let mut edges = window.harness.query_all_by_role(Role::Splitter).map(|node| node.rect());
        let edge = edges.find(|edge| {
            edge.width() > 600.0 && (0.0..16.0).contains(&(mark.top() - edge.center().y))
        });
        assert!(edge.is_some() || BELOW[*i].0 == "Looks", "{} at {mark}", BELOW[*i].0);
        last = mark;
    }
    // The lowest shows a line of itself below its heading.
    assert!(last.bottom() < height - 48.0, "{last} of {height}");
    open
}

#[test]
fn every_panel_fits_below_the_picture_or_the_oldest_makes_room() {
    for (height, least, order) in
        [(720.0, 5, [0, 1, 2, 3, 4]), (560.0, 3, [0, 1, 2, 3, 4]), (576.0, 4, [2, 1, 0, 3, 4])]
    {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("scene.toml");
        std::fs::write(&path, SCENE).unwrap();
        let mut window =
            Window::of_size(vec2(1280.0, height), folder, Some(path.clone()), Vec::new());
        window.until("the scene is open", |app| app.document().path() == Some(&path));
        for i in order {
            window.menu(&["View", BELOW[i].0]);
            window.harness.run_steps(3);
        }
        let open = panels_fit(&window, height);
        assert!(open.len() >= least, "{open:?} at {height}");
        assert_eq!(open.last(), Some(&4), "the latest is open");
        assert_eq!(open.len() < 5, window.shows("made room"), "{open:?} at {height}");
    }
}

#[test]
fn panels_make_room_when_text_grows() {
    let mut window = Window::with_scene(SCENE, Vec::new());
    for i in [2, 1, 0, 3, 4] {
        window.menu(&["View", BELOW[i].0]);
        window.harness.run_steps(3);
    }
    assert_eq!(panels_fit(&window, 720.0).len(), 5);
    window.menu(&["View", "Colours and size", "Size of text 125 %"]);
    window.harness.run_steps(5);
    let height = window.harness.ctx.content_rect().height();
    assert_eq!(height, 576.0);
    assert_eq!(panels_fit(&window, height), [0, 1, 3, 4]);
}
