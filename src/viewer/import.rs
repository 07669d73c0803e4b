//! Importing: which file, where the scene of it goes, the work in a thread, and what is to be said.

use std::path::{Path, PathBuf};

use eframe::egui::{Context, RichText, Ui};

use super::app::App;
use super::dialog::{Purpose, Question, with_ending};
use super::files::{Done, For, Modal, Source};
use super::question::{first, scroll_up_to};
use crate::document::Document;
use crate::import::{self, MAPPING, Note};
use crate::scene::Scene;

/// What an import ended with.
pub(super) struct ImportDone {
    /// The scene file.
    target: PathBuf,
    /// The scene that was open when it began.
    before: Box<Scene>,
    /// The scene, opened, with the remarks; or what is wrong.
    result: Box<Result<(Document, Vec<Note>), String>>,
}

impl App {
    /// Asks which file to import.
    pub(super) fn ask_import(&mut self, ctx: &Context) {
        self.ask(ctx, Purpose::Import, String::new(), For::Import);
    }

    /// Asks where the scene of a file goes: beside it, if nobody minds.
    pub(super) fn ask_import_target(&mut self, ctx: &Context, source: PathBuf) {
        let name = source.with_extension("toml");
        let question = Question {
            purpose: Purpose::SaveImported,
            folder: source.parent().unwrap_or(Path::new("")).to_owned(),
            name: name.file_name().unwrap_or_default().to_string_lossy().into_owned(),
        };
        self.ask_question(ctx, question, For::ImportTo(source));
    }

    /// Converts a file in a thread and opens the scene.
    pub(super) fn import(&mut self, ctx: &Context, source: PathBuf, target: &Path) {
        let target = with_ending(target, Purpose::SaveImported);
        let before = Box::new(self.document.scene().clone());
        self.files.work(ctx, move || {
            let result = Box::new(converted(&source, &target));
            Done::Imported(ImportDone { target, before, result })
        });
    }

    /// Shows what was imported, and what is to be said about it.
    pub(super) fn imported(&mut self, done: ImportDone) {
        let ImportDone { target, before, result } = done;
        match *result {
            Ok((document, notes)) => {
                let name = target.display().to_string();
                self.opened(Source::File(target), &before, document);
                let lines = notes.iter().map(Note::to_string).collect::<Vec<_>>().join("\n");
                if lines.is_empty() {
                    self.notices.say(format!("imported to {name}"));
                } else {
                    self.files.show(Modal::Imported { failed: false, text: lines });
                }
            }
            Err(text) => self.files.show(Modal::Imported { failed: true, text }),
        }
    }
}

/// Reads another program's file, writes the scene, and opens it.
fn converted(source: &Path, target: &Path) -> Result<(Document, Vec<Note>), String> {
    let imported = import::file(source, target).map_err(|error| error.to_string())?;
    imported.write(target).map_err(|error| error.to_string())?;
    let document = Document::open(target).map_err(|error| error.message)?;
    Ok((document, imported.notes))
}

/// What an import has to say; whether it has been read.
pub(super) fn imported_ui(ui: &mut Ui, failed: bool, text: &str) -> bool {
    ui.set_max_width(760.0);
    if failed {
        ui.heading("The file cannot be imported");
    } else {
        ui.heading("The file is imported");
        ui.label("What was left out, guessed or added:");
    }
    scroll_up_to(360.0).show(ui, |ui| {
        ui.label(RichText::new(text).monospace());
    });
    if !failed {
        let header = ui.collapsing("What becomes of what", |ui| {
            ui.label(RichText::new(MAPPING).monospace());
        });
        header.header_response.on_hover_text("How each format is mapped to a scene");
    }
    let close = ui.button("Close").on_hover_text("Goes on with the scene that is open");
    first(ui, &close);
    close.clicked()
}
