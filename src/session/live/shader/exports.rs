//! Pictures to files: sent off when they are exact.

use std::sync::Arc;

use super::{Pending, Shader, UNTRACED, compiled};
use crate::progress::Progress;
use crate::session::live::{Event, Export, export};

impl Shader {
    pub(super) fn refuse(&self, export: &Export, cause: &str) {
        let text = format!("{} was not written: {cause}", export.path.display());
        self.board.tell(Event::Failed(text));
    }

    pub(super) fn export(&mut self, export: Export) {
        match &self.wanted {
            Some(_) => self.waiting.push(export),
            None => self.refuse(&export, "no scene is open"),
        }
    }

    /// Sends off the exports that need not wait any more.
    pub(super) fn send_waiting(&mut self) {
        let Some(wanted) = self.wanted.clone() else { return };
        for export in std::mem::take(&mut self.waiting) {
            let Export { path, format, size, extras } = export.clone();
            let progress = Arc::<Progress>::default();
            let what = format!("exporting {}", path.display());
            let task = if size != wanted.picture.size {
                let (scene, known) =
                    (export::Task::resized(&wanted, &export), self.whole.as_ref().map(compiled));
                let progress = progress.clone();
                export::Task::Render { path, format, extras, scene, known, progress }
            } else if let Some(whole) = self.whole.as_ref().filter(|_| self.in_step()) {
                let (plates, scene) = (whole.plates(extras), whole.shared_scene());
                match plates {
                    Ok(plates) => export::Task::Write { path, format, plates, scene },
                    Err(error) => {
                        self.refuse(&export, &error);
                        continue;
                    }
                }
            } else if self.hold.is_some() {
                self.refuse(&export, UNTRACED);
                continue;
            } else {
                self.waiting.push(export);
                continue;
            };
            self.exporter.send(task).expect("the exporter lives as long as the shader");
            self.exports.push_back(Pending { what, progress });
        }
    }

    pub(super) fn exported(&mut self, outcome: export::Outcome) {
        self.exports.pop_front();
        match outcome {
            Ok(Some(path)) => self.board.tell(Event::Exported(path)),
            Ok(None) => {}
            Err(text) => self.board.tell(Event::Failed(text)),
        }
    }
}
