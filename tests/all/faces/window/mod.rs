//! The window without a display, driven by the accessible names of its widgets.

mod camera;
mod card;
mod chart;
mod controls;
mod costs;
mod diagnostics;
mod edits;
mod export;
mod files;
mod handles;
mod import;
mod keep;
mod keyboard;
mod kinds;
mod layout;
mod lists;
mod look;
mod looks;
mod mass;
mod mixer;
mod names;
mod on_disk;
mod operands;
mod palette;
mod paths;
mod picture;
mod pixel;
mod presets;
mod questions;
mod recovery;
mod solids;
mod welcome;

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use eframe::egui::accessibility::is_input;
use eframe::egui::accesskit::Role;
use eframe::egui::{Event, Key, Modifiers, PointerButton, Pos2, Rect, Vec2, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use rayforest::session::Options;
use rayforest::session::live::Shown;
use rayforest::viewer::dialog::{Answer, ScriptedDialogs};
use rayforest::viewer::{App, Folders, Setup};

/// Longest wait for anything: the machine may be busy.
const PATIENCE: Duration = Duration::from_secs(60);

/// A window with a folder of its own.
struct Window {
    harness: Harness<'static, App>,
    folder: tempfile::TempDir,
}

impl Window {
    /// A window with a scene in `scene.toml`, its first picture whole. Dialogs give `answers`, the
    /// last one first.
    fn with_scene(scene: &str, answers: Vec<Answer>) -> Window {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("scene.toml");
        std::fs::write(&path, scene).unwrap();
        let mut window = Window::in_folder(folder, Some(path.clone()), answers);
        window.until("the scene is open", |app| app.document().path() == Some(&path));
        window.until_exact();
        window
    }

    /// A window that keeps its settings in `folder`.
    fn in_folder(
        folder: tempfile::TempDir,
        scene: Option<PathBuf>,
        answers: Vec<Answer>,
    ) -> Window {
        Window::of_size(vec2(1280.0, 720.0), folder, scene, answers)
    }

    fn of_size(
        size: Vec2,
        folder: tempfile::TempDir,
        scene: Option<PathBuf>,
        answers: Vec<Answer>,
    ) -> Window {
        let root = folder.path().to_owned();
        let options = Options { threads: 2, memory: 1 << 30 };
        let harness =
            Harness::builder().with_size(size).with_max_steps(1000).build_eframe(|context| {
                let setup = Setup {
                    options,
                    folders: Folders::within(&root),
                    dialogs: Box::new(ScriptedDialogs { answers }),
                    scene,
                };
                App::new(&context.egui_ctx, setup)
            });
        Window { harness, folder }
    }

    /// A file of the window's folder.
    fn file(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn app(&self) -> &App {
        self.harness.state()
    }

    /// Turns until something holds.
    fn until(&mut self, what: &str, holds: impl Fn(&App) -> bool) {
        let start = Instant::now();
        loop {
            self.harness.step();
            if holds(self.app()) {
                return;
            }
            assert!(start.elapsed() < PATIENCE, "still not so: {what}");
            std::thread::sleep(Duration::from_millis(3));
        }
    }

    /// Turns until the picture shown is whole and shows the document's scene.
    fn until_exact(&mut self) {
        self.until("the picture is exact", |app| {
            let drawn = |s: &Shown| s.frame.is_some() && *s.scene == *app.document().scene();
            app.shown().is_some_and(drawn) && app.live().status().in_step
        });
        self.harness.run_steps(3);
    }

    /// Turns until a label holds a text.
    fn until_text(&mut self, text: &str) {
        let start = Instant::now();
        while !self.shows(text) {
            assert!(start.elapsed() < PATIENCE, "no label with `{text}` in {:#?}", self.texts());
            self.harness.step();
            std::thread::sleep(Duration::from_millis(3));
        }
    }

    /// The bytes of the picture shown.
    fn picture(&self) -> Vec<u8> {
        self.app().shown().expect("a picture is shown").frame.as_ref().expect("drawn").bytes.clone()
    }

    /// Presses the one button of this name; a shortcut may stand behind the name.
    fn click(&mut self, name: &str) {
        let at = self.settled(name);
        self.click_at(at, Modifiers::NONE);
    }

    /// Where a button is, once it no longer moves: a question finds its place in some turns.
    fn settled(&mut self, name: &str) -> Pos2 {
        let mut places = Vec::new();
        for _ in 0..100 {
            places.push(self.button(name).unwrap_or_else(|| panic!("no button `{name}`")));
            if places.iter().rev().take_while(|at| *at == &places[places.len() - 1]).count() == 3 {
                break;
            }
            self.harness.step();
        }
        places[places.len() - 1]
    }

    /// Turns until there is a button of this name, and nothing around it moves any more.
    fn until_button(&mut self, name: &str) {
        let start = Instant::now();
        while self.button(name).is_none() {
            assert!(start.elapsed() < PATIENCE, "no button `{name}` in {:#?}", self.texts());
            self.harness.step();
            std::thread::sleep(Duration::from_millis(3));
        }
        self.harness.run_steps(3);
    }

    /// Where the one button, or line of a list, of this name is.
    fn button(&self, name: &str) -> Option<Pos2> {
        let long = format!("{name} ");
        let typed = [Role::Slider, Role::SpinButton, Role::TextInput];
        let named = |node: &egui_kittest::Node<'_>, whole: bool| {
            let node = node.accesskit_node();
            let label = node.label().unwrap_or_default();
            let same = if whole { label == name } else { label.starts_with(&long) };
            is_input(node.role()) && !typed.contains(&node.role()) && !node.is_hidden() && same
        };
        let all = |whole| self.harness.root().children_recursive().filter(move |n| named(n, whole));
        let found: Vec<_> = all(true).collect();
        let found = if found.is_empty() { all(false).collect() } else { found };
        assert!(found.len() < 2, "{} buttons `{name}`", found.len());
        Some(found.first()?.rect().center())
    }

    /// One button after another: a menu, and what it opens.
    fn menu(&mut self, path: &[&str]) {
        for name in path {
            self.click(name);
        }
    }

    fn click_at(&mut self, at: Pos2, modifiers: Modifiers) {
        self.harness.event(Event::PointerMoved(at));
        self.harness.event(Event::ModifiersChanged(modifiers));
        for pressed in [true, false] {
            let button = PointerButton::Primary;
            self.harness.event(Event::PointerButton { pos: at, button, pressed, modifiers });
        }
        self.harness.event(Event::ModifiersChanged(Modifiers::NONE));
        self.harness.step();
        self.harness.run_steps(3);
    }

    /// Clicks twice within one turn.
    fn double_click_at(&mut self, at: Pos2) {
        self.harness.event(Event::PointerMoved(at));
        self.harness.step();
        let events = &mut self.harness.input_mut().events;
        for pressed in [true, false, true, false] {
            let (button, modifiers) = (PointerButton::Primary, Modifiers::NONE);
            events.push(Event::PointerButton { pos: at, button, pressed, modifiers });
        }
        self.harness.run_steps(3);
    }

    fn key(&mut self, modifiers: Modifiers, key: Key) {
        self.harness.key_press_modifiers(modifiers, key);
        self.harness.step();
        self.harness.run_steps(2);
    }

    fn write(&mut self, text: &str) {
        self.harness.event(Event::Text(text.to_owned()));
        self.harness.step();
    }

    /// Clicks a number field, types, and presses Enter.
    fn type_into(&mut self, name: &str, text: &str) {
        let at = self.rect(Role::SpinButton, name).center();
        self.click_at(at, Modifiers::NONE);
        self.write(text);
        self.key(Modifiers::NONE, Key::Enter);
    }

    /// Saves, and waits until nothing is unsaved.
    fn save(&mut self) {
        self.key(Modifiers::COMMAND, Key::S);
        self.until("the scene is saved", |app| !app.document().is_unsaved());
        self.harness.run_steps(2);
    }

    /// Names and texts of all that shows.
    fn texts(&self) -> Vec<String> {
        let text = |node: egui_kittest::Node<'_>| {
            let node = node.accesskit_node();
            let is_label = node.role() == Role::Label;
            if is_label { node.value() } else { node.label() }
        };
        self.harness.root().children_recursive().filter_map(text).collect()
    }

    fn shows(&self, text: &str) -> bool {
        self.texts().iter().any(|shown| shown.contains(text))
    }

    fn undo_name(&self) -> Option<&str> {
        self.app().document().undo_name()
    }

    fn rect(&self, role: Role, name: &str) -> Rect {
        self.harness.get_by_role_and_label(role, name).rect()
    }

    /// Presses at one point, moves in steps to another, releases there.
    fn drag(&mut self, from: Pos2, to: Pos2) {
        self.harness.hover_at(from);
        self.harness.drag_at(from);
        self.harness.step();
        for i in 1..=5 {
            self.harness.hover_at(from.lerp(to, i as f32 / 5.0));
            self.harness.step();
        }
        self.harness.drop_at(to);
        self.harness.run_steps(2);
    }

    /// Drags the handle of a slider to a share of its length.
    fn drag_slider(&mut self, name: &str, share: f32) {
        let rect = self.rect(Role::Slider, name);
        let to = Pos2::new(rect.left() + rect.width() * share, rect.center().y);
        self.drag(rect.center(), to);
    }

    fn scene_text(&self) -> String {
        std::fs::read_to_string(self.file("scene.toml")).unwrap()
    }
}

/// What a picture file without alpha holds of the bytes of a frame.
fn rgb(frame: &[u8]) -> Vec<u8> {
    let (pixels, _) = frame.as_chunks::<4>();
    pixels.iter().flat_map(|&[r, g, b, _]| [r, g, b]).collect()
}

/// The bytes that a fresh render of a scene file gives.
fn rendered(folder: &Path, file: &str) -> Vec<u8> {
    super::succeed(folder, &["render", file, "-o", "fresh.png"]);
    super::decode_png(&folder.join("fresh.png")).unwrap().2
}
