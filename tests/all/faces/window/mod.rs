//! The window without a display, driven by the accessible names of its widgets.

mod edits;

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use eframe::egui::accesskit::Role;
use eframe::egui::{Pos2, Rect, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use rayforest::session::Options;
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
        let root = folder.path().to_owned();
        let options = Options { threads: 2, memory: 1 << 30 };
        let harness = Harness::builder()
            .with_size(vec2(1280.0, 720.0))
            .with_max_steps(1000)
            .build_eframe(|context| {
                let setup = Setup {
                    options,
                    folders: Folders {
                        settings: root.join("config"),
                        recovery: root.join("unsaved"),
                    },
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
            let shown = app.shown().is_some_and(|s| *s.scene == *app.document().scene());
            shown && app.live().status().in_step
        });
        self.harness.run_steps(3);
    }

    /// Turns until a label holds a text.
    fn until_text(&mut self, text: &str) {
        let start = Instant::now();
        while self.harness.query_by_label_contains(text).is_none() {
            assert!(start.elapsed() < PATIENCE, "there is no label with `{text}`");
            self.harness.step();
            std::thread::sleep(Duration::from_millis(3));
        }
    }

    /// The bytes of the picture shown.
    fn picture(&self) -> Vec<u8> {
        self.app().shown().expect("a picture is shown").frame.bytes.clone()
    }

    fn click(&mut self, name: &str) {
        self.harness.get_by_label(name).click();
        self.harness.run_steps(3);
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

/// The bytes that a fresh render of a scene file gives.
fn rendered(folder: &Path, file: &str) -> Vec<u8> {
    super::succeed(folder, &["render", file, "-o", "fresh.png"]);
    super::decode_png(&folder.join("fresh.png")).unwrap().2
}
