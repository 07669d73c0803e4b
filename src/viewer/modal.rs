//! The questions over the window.

use eframe::egui::{Context, RichText, Ui};

use super::app::App;
use super::dialog::Purpose;
use super::export::ExportChoice;
use super::files::{For, Modal, Next, Source};
use super::import::imported_ui;
use super::path_field::Choice;
use super::question::{first, question, scroll_up_to};
use crate::document::recovery::Found;
use crate::document::{FileKind, Missing, Save};

/// What the person answered to unsaved work.
enum Unsaved {
    Save,
    Discard,
    Stay,
}

/// What the person answered to a file that another program changed.
enum Overwrite {
    Yes,
    Elsewhere,
    No,
}

impl App {
    /// Shows the question that waits, if any, and does what was answered.
    pub(super) fn modals(&mut self, ctx: &Context) {
        let Some(modal) = self.files.take_modal() else { return };
        let shown = question(ctx, "question", |ui| match modal {
            Modal::Unsaved(next) => self.unsaved_ui(ui, next),
            Modal::Export(mut form) => match form.ui(ui) {
                None => Some(Modal::Export(form)),
                Some(ExportChoice::Cancel) => None,
                Some(ExportChoice::GoOn) => {
                    let title = self.document.title();
                    let name = format!("{}.{}", title.trim_end_matches(".toml"), form.ending());
                    self.ask(ui.ctx(), Purpose::Export, name, For::Export(form));
                    None
                }
            },
            Modal::Path(mut field, what) => match field.ui(ui) {
                None => Some(Modal::Path(field, what)),
                Some(Choice::Cancelled) => what.back(),
                Some(Choice::File(file)) => {
                    self.chosen(ui.ctx(), file, what);
                    None
                }
            },
            Modal::BadScene { source, located, message, missing } => {
                let mut stays = true;
                bad_scene_ui(ui, &message);
                ui.horizontal(|ui| {
                    if let Some(Missing { kind, file }) = &missing
                        && ui
                            .button("Locate…")
                            .on_hover_text(format!("Shows where {file} is now"))
                            .clicked()
                    {
                        let (source, located) = (source.clone(), located.clone());
                        let what = For::Locate { source, located, missing: file.clone() };
                        let purpose = match kind {
                            FileKind::Mesh => Purpose::LocateMesh,
                            FileKind::Image => Purpose::LocateImage,
                        };
                        self.ask(ui.ctx(), purpose, String::new(), what);
                        stays = false;
                    }
                    let about = "Goes on with the scene that is open";
                    let close = ui.button("Close").on_hover_text(about);
                    first(ui, &close);
                    stays &= !close.clicked();
                });
                stays.then_some(Modal::BadScene { source, located, message, missing })
            }
            Modal::Changed { save, message, next } => self.changed_ui(ui, save, message, next),
            Modal::Recover(found) => self.recover_ui(ui, found),
            Modal::Imported { failed, text } => {
                let read = imported_ui(ui, failed, &text);
                (!read).then_some(Modal::Imported { failed, text })
            }
        });
        // What an answer itself opened comes before the question that was just answered.
        if self.files.modal.is_some() {
            return;
        }
        let beside = shown.backdrop_response.clicked();
        self.files.modal = match shown.should_close() {
            true if !(beside && holds_to_it(&shown.inner)) => shown.inner.and_then(Modal::back),
            _ => shown.inner,
        };
    }

    fn unsaved_ui(&mut self, ui: &mut Ui, next: Next) -> Option<Modal> {
        let title = self.document.title();
        if self.document.is_gone() {
            ui.heading(format!("Save {title} again?"));
            ui.label("Its file was moved or deleted: without saving the scene is lost.");
        } else {
            ui.heading(format!("Save the changes to {title}?"));
            ui.label("Without saving they are lost.");
        }
        let choices = [
            ("Save", "Saves, then goes on", Unsaved::Save),
            ("Do not save", "Gives the changes up and goes on", Unsaved::Discard),
            ("Cancel", "Goes on editing", Unsaved::Stay),
        ];
        match buttons_ui(ui, choices) {
            None => return Some(Modal::Unsaved(next)),
            Some(Unsaved::Save) => self.save(ui.ctx(), Some(next)),
            Some(Unsaved::Discard) => self.go_on(ui.ctx(), next),
            Some(Unsaved::Stay) => {}
        }
        None
    }

    fn changed_ui(
        &mut self,
        ui: &mut Ui,
        save: Save,
        message: String,
        next: Option<Next>,
    ) -> Option<Modal> {
        ui.heading("The file was changed by another program");
        ui.label(&message);
        let choices = [
            ("Save as…", "Asks for another file", Overwrite::Elsewhere),
            ("Overwrite", "Replaces the file; the one before it becomes NAME~", Overwrite::Yes),
            ("Cancel", "Saves nothing", Overwrite::No),
        ];
        match buttons_ui(ui, choices) {
            None => return Some(Modal::Changed { save, message, next }),
            Some(Overwrite::Yes) => {
                let mut save = save;
                save.overwrite = true;
                self.write(ui.ctx(), save, next);
            }
            Some(Overwrite::Elsewhere) => self.ask_save(ui.ctx(), next),
            Some(Overwrite::No) => {}
        }
        None
    }

    fn recover_ui(&mut self, ui: &mut Ui, mut found: Vec<Found>) -> Option<Modal> {
        ui.heading("Unsaved work was found");
        ui.label("The program ended before it was saved.");
        let mut opened = None;
        let mut discarded = None;
        for (i, item) in found.iter().enumerate() {
            ui.horizontal(|ui| {
                let recover = ui.button("Recover").on_hover_text("Opens it, still unsaved");
                if i == 0 {
                    first(ui, &recover);
                }
                if recover.clicked() {
                    opened = Some(i);
                }
                if ui.button("Discard").on_hover_text("Deletes it for good").clicked() {
                    discarded = Some(i);
                }
                ui.label(format!("{}, {} ago", item.title, age(item.age_secs)));
            });
        }
        let later = ui.button("Later").on_hover_text("Keeps it; asks again at the next start");
        if let Some(i) = opened {
            let item = found.remove(i);
            self.open_source(ui.ctx(), Source::Found(item), Vec::new());
            // The rest is found again at the next start.
            return None;
        }
        if let Some(i) = discarded {
            found.remove(i).discard();
        }
        (!later.clicked() && !found.is_empty()).then_some(Modal::Recover(found))
    }
}

/// Whether a click beside a question leaves it open: who found lost work shall not lose the question.
fn holds_to_it(modal: &Option<Modal>) -> bool {
    matches!(modal, Some(Modal::Recover(_)))
}

impl Modal {
    /// What is asked next after this was closed without an answer.
    fn back(self) -> Option<Modal> {
        match self {
            Modal::Path(_, what) => what.back(),
            _ => None,
        }
    }
}

impl For {
    /// What is asked next if no file was named: the form that asked for it, as it was filled in.
    pub(super) fn back(self) -> Option<Modal> {
        match self {
            For::Export(form) => Some(Modal::Export(form)),
            _ => None,
        }
    }
}

/// A row of buttons, each with its name, what it does, and what it means; what was pressed. Enter
/// presses the first.
fn buttons_ui<T>(ui: &mut Ui, choices: [(&str, &str, T); 3]) -> Option<T> {
    let mut pressed = None;
    ui.horizontal(|ui| {
        for (i, (name, about, meaning)) in choices.into_iter().enumerate() {
            let button = ui.button(name).on_hover_text(about);
            if i == 0 {
                first(ui, &button);
            }
            if button.clicked() {
                pressed = Some(meaning);
            }
        }
    });
    pressed
}

fn bad_scene_ui(ui: &mut Ui, message: &str) {
    ui.heading("The scene cannot be opened");
    ui.set_max_width(760.0);
    scroll_up_to(400.0).show(ui, |ui| {
        ui.label(RichText::new(message).monospace());
    });
}

/// A time in words.
fn age(seconds: u64) -> String {
    let (count, unit) = match seconds {
        s if s < 120 => (s, "seconds"),
        s if s < 2 * 3600 => (s / 60, "minutes"),
        s if s < 2 * 86_400 => (s / 3600, "hours"),
        s => (s / 86_400, "days"),
    };
    format!("{count} {unit}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ages_are_told_in_words() {
        assert_eq!(age(59), "59 seconds");
        assert_eq!(age(600), "10 minutes");
        assert_eq!(age(7200), "2 hours");
        assert_eq!(age(200_000), "2 days");
    }
}
