//! The same window in this process: it knows where everything is, and what it has to look like.

use std::path::Path;
use std::time::{Duration, Instant};

use eframe::egui::accesskit::Role;
use eframe::egui::{Key, Modifiers, Pos2, Rect, vec2};
use eframe::egui_wgpu::RendererOptions;
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use rayforest::session::Options;
use rayforest::viewer::dialog::{Answer, ScriptedDialogs};
use rayforest::viewer::{App, Folders, Setup};

use super::server::Shot;
use super::{PATIENCE, SIZE};

/// A window without a display, to be driven as the real one is.
pub(super) struct Twin {
    harness: Harness<'static, App>,
    _folder: tempfile::TempDir,
}

impl Twin {
    /// A window of the screen's size with a scene, its picture whole. It knows of the unsaved work
    /// in `recovery`, and no dialog answers it.
    pub(super) fn new(scene: &Path, recovery: Option<&Path>) -> Twin {
        let folder = tempfile::tempdir().unwrap();
        let own = folder.path().join("unsaved");
        std::fs::create_dir(&own).unwrap();
        for file in recovery.into_iter().flat_map(|f| std::fs::read_dir(f).unwrap()) {
            let file = file.unwrap();
            std::fs::copy(file.path(), own.join(file.file_name())).unwrap();
        }
        let folders = Folders::within(folder.path());
        let path = scene.to_owned();
        let harness = Harness::builder()
            .with_size(vec2(f32::from(SIZE[0]), f32::from(SIZE[1])))
            .with_max_steps(1000)
            .with_render_cursor(false)
            .with_render_options(RendererOptions::default())
            .build_eframe(|context| {
                let setup = Setup {
                    options: Options::default(),
                    folders,
                    dialogs: Box::new(ScriptedDialogs { answers: vec![Answer::NoService; 9] }),
                    scene: Some(path),
                };
                App::new(&context.egui_ctx, setup)
            });
        let mut twin = Twin { harness, _folder: folder };
        twin.until("the scene is open", |app| app.document().path() == Some(scene));
        twin.until_exact();
        twin
    }

    fn until(&mut self, what: &str, holds: impl Fn(&App) -> bool) {
        let start = Instant::now();
        loop {
            self.harness.step();
            if holds(self.harness.state()) {
                return;
            }
            assert!(start.elapsed() < PATIENCE, "still not so: {what}");
            std::thread::sleep(Duration::from_millis(3));
        }
    }

    /// Turns until the picture shown is whole and shows the document's scene.
    pub(super) fn until_exact(&mut self) {
        self.until("the picture is exact", |app| {
            let shown = app.shown().is_some_and(|s| *s.scene == *app.document().scene());
            shown && app.live().status().in_step
        });
        self.rest();
    }

    /// Lets everything move to its place.
    fn rest(&mut self) {
        self.harness.run_steps(60);
    }

    pub(super) fn app(&self) -> &App {
        self.harness.state()
    }

    /// Where a widget is, in points.
    pub(super) fn rect(&self, role: Role, name: &str) -> Rect {
        self.harness.get_by_role_and_label(role, name).rect()
    }

    /// Where the only thing of a name is, in points.
    pub(super) fn place(&self, name: &str) -> Rect {
        self.harness.get_by_label(name).rect()
    }

    pub(super) fn click(&mut self, at: Pos2) {
        self.harness.hover_at(at);
        self.harness.step();
        self.harness.drag_at(at);
        self.harness.step();
        self.harness.drop_at(at);
        self.rest();
    }

    /// Presses at one point, moves to another, releases there.
    pub(super) fn drag(&mut self, from: Pos2, to: Pos2) {
        self.harness.hover_at(from);
        self.harness.step();
        self.harness.drag_at(from);
        self.harness.step();
        self.harness.hover_at(to);
        self.harness.step();
        self.harness.drop_at(to);
        self.rest();
    }

    pub(super) fn hover(&mut self, at: Pos2) {
        self.harness.hover_at(at);
        self.rest();
    }

    /// Presses a key.
    pub(super) fn press(&mut self, key: Key) {
        self.harness.key_press(key);
        self.rest();
    }

    /// Presses a key together with Ctrl.
    pub(super) fn press_ctrl(&mut self, key: Key) {
        self.harness.key_press_modifiers(Modifiers::COMMAND, key);
        self.rest();
    }

    /// What it looks like, now that more of it may have come: costs arrive by themselves.
    pub(super) fn shot(&mut self) -> Shot {
        self.harness.run_steps(2);
        let image = self.harness.render().expect("lavapipe is installed: tests/run installs it");
        let (pixels, _) = image.as_raw().as_chunks::<4>();
        let pixels = pixels.iter().map(|&[r, g, b, _]| [r, g, b]).collect();
        Shot { size: [image.width() as usize, image.height() as usize], pixels }
    }
}
