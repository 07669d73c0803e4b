//! The program's own way to name a file, for when the system has no dialog.

use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, channel};

use eframe::egui::{Context, Key, TextEdit, Ui};

use super::dialog::{Question, with_ending};
use super::question::scroll_up_to;

/// Most names shown.
const MOST_NAMES: usize = 500;

/// A path being typed, and what is in its folder.
pub(super) struct PathField {
    question: Question,
    text: String,
    /// The folder whose names are shown or being read.
    folder: Option<PathBuf>,
    reading: Option<Receiver<Vec<Entry>>>,
    entries: Vec<Entry>,
    /// An existing file that is about to be replaced: asked once more.
    replaces: Option<PathBuf>,
    focused: bool,
}

/// A name in a folder.
struct Entry {
    name: String,
    is_folder: bool,
}

/// What the person decided.
#[derive(Debug, PartialEq)]
pub(super) enum Choice {
    /// This file.
    File(PathBuf),
    /// None.
    Cancelled,
}

impl PathField {
    /// Begins where the question begins.
    pub(super) fn new(question: Question, ctx: &Context) -> PathField {
        let text = question.folder.join(&question.name).display().to_string();
        let mut field = PathField {
            folder: None,
            question,
            text,
            reading: None,
            entries: Vec::new(),
            replaces: None,
            focused: false,
        };
        field.read_folder(ctx);
        field
    }

    /// Reads the folder of the typed path in a thread: it may be on a slow disk.
    fn read_folder(&mut self, ctx: &Context) {
        let typed = Path::new(&self.text);
        let is_folder = self.text.ends_with(std::path::MAIN_SEPARATOR);
        let folder = if is_folder { typed } else { typed.parent().unwrap_or(Path::new("")) };
        if self.folder.as_deref() == Some(folder) {
            return;
        }
        self.folder = Some(folder.to_owned());
        // Names of one folder are not offered in another.
        self.entries.clear();
        let (send, receive) = channel();
        let (folder, ctx) = (folder.to_owned(), ctx.clone());
        let (_, endings) = self.question.purpose.filter();
        std::thread::spawn(move || {
            let _ = send.send(entries(&folder, endings));
            ctx.request_repaint();
        });
        self.reading = Some(receive);
    }

    /// Shows the field; gives the decision once it is made.
    pub(super) fn ui(&mut self, ui: &mut Ui) -> Option<Choice> {
        if let Some(entries) = self.reading.as_ref().and_then(|r| r.try_recv().ok()) {
            (self.entries, self.reading) = (entries, None);
        }
        ui.heading(self.question.purpose.title());
        ui.weak("The system offers no file dialog here: type a path, or choose a name below.");
        ui.set_width(520.0);
        let edit = TextEdit::singleline(&mut self.text).desired_width(f32::INFINITY);
        let edit = ui.add(edit).on_hover_text("A path, absolute or from the present folder");
        let edit = edit.accessible_name("file path");
        if !self.focused {
            edit.request_focus();
            self.focused = true;
        }
        if edit.changed() {
            self.replaces = None;
            self.read_folder(ui.ctx());
        }
        let entered = edit.lost_focus() && ui.input(|i| i.key_pressed(Key::Enter));
        self.names_ui(ui);
        if let Some(path) = &self.replaces {
            ui.colored_label(
                ui.visuals().error_fg_color,
                format!("{} exists: press again to replace it", path.display()),
            );
        }
        ui.add_space(6.0);
        let mut choice = None;
        ui.horizontal(|ui| {
            let verb = if self.question.purpose.writes() { "Save" } else { "Open" };
            let about = "Takes the file of this path";
            if ui.button(verb).on_hover_text(about).clicked() || entered {
                choice = self.decide();
                // Enter again answers what is asked once more.
                self.focused = choice.is_some() || !entered;
            }
            if ui.button("Cancel").on_hover_text("Leaves everything as it is").clicked() {
                choice = Some(Choice::Cancelled);
            }
        });
        choice
    }

    /// The names in the folder that begin as the typed one.
    fn names_ui(&mut self, ui: &mut Ui) {
        let typed = self.text.rsplit(std::path::MAIN_SEPARATOR).next().unwrap_or_default();
        let writes = self.question.purpose.writes();
        let folder = self.folder.clone().unwrap_or_default();
        let mut chosen = None;
        scroll_up_to(220.0).hscroll(false).auto_shrink([false, true]).show(ui, |ui| {
            if let Some(above) = folder.parent()
                && ui.selectable_label(false, "../").on_hover_text("The folder above").clicked()
            {
                chosen = Some(folder_text(above));
            }
            for entry in &self.entries {
                if !writes && !entry.name.starts_with(typed) {
                    continue;
                }
                let path = folder.join(&entry.name);
                let text =
                    if entry.is_folder { folder_text(&path) } else { path.display().to_string() };
                let label =
                    if entry.is_folder { format!("{}/", entry.name) } else { entry.name.clone() };
                if ui.selectable_label(self.text == text, label).on_hover_text(&text).clicked() {
                    chosen = Some(text);
                }
            }
        });
        if let Some(text) = chosen {
            (self.text, self.replaces) = (text, None);
            self.read_folder(ui.ctx());
        }
    }

    fn decide(&mut self) -> Option<Choice> {
        let purpose = self.question.purpose;
        if self.text.trim().is_empty() {
            return None;
        }
        let path = PathBuf::from(self.text.trim());
        if !purpose.writes() {
            return Some(Choice::File(path));
        }
        let path = with_ending(&path, purpose);
        if path.exists() && self.replaces.as_ref() != Some(&path) {
            self.replaces = Some(path);
            return None;
        }
        Some(Choice::File(path))
    }
}

/// A folder as text that asks for what is in it.
fn folder_text(path: &Path) -> String {
    let text = path.display().to_string();
    let end = std::path::MAIN_SEPARATOR;
    if text.ends_with(end) { text } else { format!("{text}{end}") }
}

/// Folders first, then files with one of the endings, each by name; hidden ones are left out.
fn entries(folder: &Path, endings: &[&str]) -> Vec<Entry> {
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let Ok(list) = std::fs::read_dir(folder) else { return Vec::new() };
    let mut entries: Vec<Entry> = list
        .flatten()
        .map(|item| Entry {
            name: item.file_name().to_string_lossy().into_owned(),
            is_folder: item.path().is_dir(),
        })
        .filter(|entry| !entry.name.starts_with('.'))
        .filter(|entry| {
            let ending = Path::new(&entry.name).extension().and_then(|e| e.to_str());
            entry.is_folder || ending.is_some_and(|e| endings.contains(&e))
        })
        .collect();
    entries.sort_by(|a, b| (!a.is_folder, &a.name).cmp(&(!b.is_folder, &b.name)));
    entries.truncate(MOST_NAMES);
    entries
}
