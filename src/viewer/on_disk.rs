//! Files that another program changed: taken at once where nothing is lost by it, else offered over
//! the picture.

use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex};
use std::time::Duration;

use eframe::egui::{Area, Context, Frame, Id, Order, Ui, vec2};

use super::app::App;
use super::files::Done;
use super::screen::wake;
use crate::document::Document;
use crate::document::watch::{OnDisk, Watch, Watched};
use crate::scene::read::Known;

/// How often files are looked at.
const PERIOD: Duration = Duration::from_secs(1);

/// What is on disk and not in the window, until somebody decides.
#[derive(Default)]
pub(super) struct Changes {
    scene: Option<Theirs>,
    parts: Option<Known>,
}

/// The scene's file as another program left it.
enum Theirs {
    Readable(Box<Document>),
    /// What is wrong with it, its first line.
    Bad(String),
    /// It was moved or deleted.
    Gone,
}

/// What was pressed.
enum Choice {
    TakeScene,
    KeepScene,
    SaveScene,
    TakeParts,
    KeepParts,
}

/// Starts a thread that looks at files; it ends when what is returned is dropped.
pub(super) fn watcher(send: Sender<Done>, window: Arc<Mutex<Context>>) -> Sender<Watched> {
    let (orders, inbox) = channel();
    std::thread::spawn(move || {
        let mut watch = Watch::default();
        loop {
            match inbox.recv_timeout(PERIOD) {
                Ok(watched) => watch.follow(watched),
                Err(RecvTimeoutError::Disconnected) => return,
                Err(RecvTimeoutError::Timeout) => {
                    let found = watch.look();
                    let is_new = !found.is_empty();
                    for change in found {
                        if send.send(Done::OnDisk(change)).is_err() {
                            return;
                        }
                    }
                    if is_new {
                        wake(&window);
                    }
                }
            }
        }
    });
    orders
}

impl Changes {
    /// The scene's file was replaced by what is in the window.
    pub(super) fn forget_scene(&mut self) {
        self.scene = None;
    }

    /// What is to be decided, if anything is, at the upper edge of `ui`'s space: nothing moves for it
    /// under a pointer that is about to press.
    fn ui(&self, ui: &Ui, title: &str) -> Option<Choice> {
        if self.scene.is_none() && self.parts.is_none() {
            return None;
        }
        let mut choice = None;
        let space = ui.max_rect().shrink(12.0);
        let area = Area::new(Id::unique("on disk")).order(Order::Foreground);
        area.fixed_pos(space.min).show(ui.ctx(), |ui| {
            ui.set_max_width(space.width().min(640.0));
            Frame::popup(ui.style()).show(ui, |ui| {
                ui.spacing_mut().item_spacing = vec2(6.0, 4.0);
                if let Some(theirs) = &self.scene {
                    choice = scene_ui(ui, title, theirs);
                }
                if let Some(parts) = &self.parts {
                    choice = parts_ui(ui, parts).or(choice.take());
                }
            });
        });
        choice
    }
}

fn scene_ui(ui: &mut Ui, title: &str, theirs: &Theirs) -> Option<Choice> {
    let mut choice = None;
    ui.horizontal_wrapped(|ui| {
        match theirs {
            Theirs::Readable(_) => {
                ui.label(format!("{title} was changed by another program, and here too."));
                let about = "Shows what is on disk; undo brings your version back";
                if ui.button("Load theirs").on_hover_text(about).clicked() {
                    choice = Some(Choice::TakeScene);
                }
            }
            Theirs::Bad(what) => {
                let text =
                    format!("{title} was changed by another program and is not read: {what}");
                ui.colored_label(ui.visuals().error_fg_color, text);
            }
            Theirs::Gone => {
                let text = format!("{title} was moved or deleted by another program.");
                ui.colored_label(ui.visuals().error_fg_color, text);
                let about = "Writes the file again";
                if ui.button("Save it again").on_hover_text(about).clicked() {
                    choice = Some(Choice::SaveScene);
                }
            }
        }
        let about = match theirs {
            Theirs::Gone => "Goes on with what is here, which is unsaved",
            _ => "Goes on with what is here; saving asks before it replaces the file",
        };
        if ui.button("Keep mine").on_hover_text(about).clicked() {
            choice = Some(Choice::KeepScene);
        }
    });
    choice
}

fn parts_ui(ui: &mut Ui, parts: &Known) -> Option<Choice> {
    let mut choice = None;
    ui.horizontal_wrapped(|ui| {
        ui.label(format!("{} changed on disk.", names(parts)));
        let about = "Reads it again; your edits stay";
        if ui.button("Load it anew").on_hover_text(about).clicked() {
            choice = Some(Choice::TakeParts);
        }
        let about = "Goes on with what was read before; the next opening reads it again";
        if ui.button("Not now").on_hover_text(about).clicked() {
            choice = Some(Choice::KeepParts);
        }
    });
    choice
}

/// The names of meshes and images, as scenes have them.
fn names(parts: &Known) -> String {
    let mut names: Vec<&str> =
        parts.meshes.keys().chain(parts.images.keys()).map(String::as_str).collect();
    names.sort_unstable();
    names.join(", ")
}

impl App {
    /// Shows what is to be decided about files on disk, and does what was chosen.
    pub(super) fn on_disk_ui(&mut self, ui: &Ui) {
        // A question comes first.
        if self.files.is_modal() {
            return;
        }
        // What was edited here was taken back: nothing is lost any more.
        if !self.document.is_unsaved()
            && let Some(Theirs::Readable(theirs)) =
                self.changes.scene.take_if(|theirs| matches!(theirs, Theirs::Readable(_)))
        {
            return self.load_theirs(*theirs);
        }
        let Some(choice) = self.changes.ui(ui, &self.document.title()) else { return };
        match choice {
            Choice::TakeScene => {
                if let Some(Theirs::Readable(theirs)) = self.changes.scene.take() {
                    self.load_theirs(*theirs);
                }
            }
            Choice::KeepScene => self.changes.scene = None,
            Choice::SaveScene => self.save(ui.ctx(), None),
            Choice::TakeParts => {
                if let Some(parts) = self.changes.parts.take() {
                    self.load_parts(&parts);
                }
            }
            Choice::KeepParts => self.changes.parts = None,
        }
    }

    /// Takes what the watcher found.
    pub(super) fn changed_on_disk(&mut self, change: OnDisk) {
        match &change {
            OnDisk::Scene(path, _) | OnDisk::Gone(path) | OnDisk::Back(path)
                if self.document.path() != Some(path.as_path()) =>
            {
                return;
            }
            OnDisk::Scene(..) | OnDisk::Back(_) => self.document.set_gone(false),
            OnDisk::Gone(_) | OnDisk::Parts(_) | OnDisk::BadPart(_) => {}
        }
        let is_edited = self.document.is_unsaved();
        match change {
            OnDisk::Scene(_, result) => match *result {
                // What was just saved.
                Ok(theirs) if self.document.is_of_same_text(&theirs) => {}
                Ok(theirs) if is_edited => {
                    self.changes.scene = Some(Theirs::Readable(Box::new(theirs)));
                }
                Ok(theirs) => self.load_theirs(theirs),
                Err(error) => {
                    let line = error.message.lines().next().unwrap_or_default().to_owned();
                    self.changes.scene = Some(Theirs::Bad(line));
                }
            },
            OnDisk::Back(_) => self.changes.scene = None,
            OnDisk::Gone(_) => {
                self.document.set_gone(true);
                self.changes.scene = Some(Theirs::Gone);
                self.files.touched();
            }
            OnDisk::Parts(parts) if is_edited => {
                let waiting = self.changes.parts.get_or_insert_default();
                waiting.meshes.extend(parts.meshes);
                waiting.images.extend(parts.images);
            }
            OnDisk::Parts(parts) => self.load_parts(&parts),
            OnDisk::BadPart(what) => {
                self.notices.error(format!("{what}\nwhat was read before stays"));
            }
        }
    }

    fn load_theirs(&mut self, theirs: Document) {
        let title = self.document.title();
        self.document.load_theirs(theirs);
        (self.picked, self.renaming) = (None, None);
        self.mixer.forget();
        self.changes = Changes::default();
        self.show_scene();
        self.notices.say(format!("{title} was changed by another program: loaded, undo goes back"));
    }

    fn load_parts(&mut self, parts: &Known) {
        self.document.load_parts(parts);
        self.show_scene();
        self.notices.say(format!("{} changed on disk: loaded anew", names(parts)));
    }
}
