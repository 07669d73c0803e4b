//! Asking for a file: the system's dialog, and the program's own path field where there is none.

use std::path::{Path, PathBuf};
use std::pin::Pin;
use std::process::{Command, Stdio};
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use std::time::{Duration, Instant};

use eframe::egui;

use crate::import::ENDINGS;

/// What a file is wanted for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Purpose {
    /// A scene to open.
    Open,
    /// A scene file to write.
    Save,
    /// The scene file of an imported one.
    SaveImported,
    /// A picture file to write.
    Export,
    /// A mesh that was not found.
    LocateMesh,
    /// An image that was not found.
    LocateImage,
    /// An image to show on a surface or as the background.
    Image,
    /// A mesh to make a solid of.
    Mesh,
    /// Another program's file to import.
    Import,
}

impl Purpose {
    /// Title of the dialog.
    pub fn title(self) -> &'static str {
        match self {
            Purpose::Open => "Open a scene",
            Purpose::Save => "Save the scene",
            Purpose::SaveImported => "Save the imported scene as",
            Purpose::Export => "Export the picture",
            Purpose::LocateMesh => "Find the mesh",
            Purpose::LocateImage => "Find the image",
            Purpose::Image => "Pick an image",
            Purpose::Mesh => "Pick a mesh",
            Purpose::Import => "Import a file",
        }
    }

    /// Whether the file is written rather than read.
    pub fn writes(self) -> bool {
        matches!(self, Purpose::Save | Purpose::SaveImported | Purpose::Export)
    }

    /// What the files are called and how their names end.
    pub fn filter(self) -> (&'static str, &'static [&'static str]) {
        match self {
            Purpose::Open => ("Scenes, and pictures with theirs", &["toml", "png", "exr", "hdr"]),
            Purpose::Save | Purpose::SaveImported => ("Rayforest scenes", &["toml"]),
            Purpose::Export => ("Pictures", &["png", "exr", "hdr"]),
            Purpose::LocateMesh | Purpose::Mesh => ("Meshes", &["obj"]),
            Purpose::LocateImage | Purpose::Image => ("Images", &["png", "jpg", "jpeg", "hdr"]),
            Purpose::Import => ("OBJ, glTF and NFF", &ENDINGS),
        }
    }
}

/// A question for a file.
#[derive(Clone, Debug, PartialEq)]
pub struct Question {
    /// What for.
    pub purpose: Purpose,
    /// Where to begin.
    pub folder: PathBuf,
    /// A name to begin with, for files that are written.
    pub name: String,
}

/// What came of a question.
#[derive(Clone, Debug, PartialEq)]
pub enum Answer {
    /// Not yet decided.
    Waiting,
    /// This file.
    File(PathBuf),
    /// The person does not want to.
    Cancelled,
    /// Nobody can be asked: the path field is shown.
    NoService,
}

/// Asks for files without holding up the window. One question at a time.
pub trait Dialogs {
    /// Asks.
    fn ask(&mut self, question: &Question, ctx: &egui::Context);

    /// What came of it so far. `focused` says whether the window has the keyboard: a dialog that
    /// shows takes it away.
    fn answer(&mut self, focused: bool) -> Answer;

    /// Shows a folder to the person; whether there was somebody to ask.
    fn show_folder(&mut self, folder: &Path) -> bool;
}

/// An answer faster than this is nobody's: there is no service.
const INSTANT: Duration = Duration::from_millis(300);
/// After this time without an answer and without a lost focus there is no service.
const PATIENCE: Duration = Duration::from_secs(4);

/// A question that the system was asked.
struct Asked {
    start: Instant,
    /// The file, if there is one, and how long the system took.
    receive: Receiver<(Option<PathBuf>, Duration)>,
}

/// The dialogs of the system.
#[derive(Default)]
pub struct SystemDialogs {
    asked: Option<Asked>,
    /// The window lost the keyboard since the question: some dialog shows.
    seen: bool,
}

impl Dialogs for SystemDialogs {
    fn ask(&mut self, question: &Question, ctx: &egui::Context) {
        let (send, receive) = channel();
        let dialog = dialog(question);
        let ctx = ctx.clone();
        // The dialog is made here, as some systems want it, and waited for elsewhere.
        let future: Pin<Box<dyn Future<Output = Option<rfd::FileHandle>> + Send>> =
            if question.purpose.writes() {
                Box::pin(dialog.save_file())
            } else {
                Box::pin(dialog.pick_file())
            };
        let start = Instant::now();
        std::thread::spawn(move || {
            let file = pollster::block_on(future).map(|handle| handle.path().to_owned());
            // A window that is closed meanwhile has no use for the answer.
            let _ = send.send((file, start.elapsed()));
            ctx.request_repaint();
        });
        (self.asked, self.seen) = (Some(Asked { start, receive }), false);
    }

    fn answer(&mut self, focused: bool) -> Answer {
        let Some(Asked { start, receive }) = &self.asked else { return Answer::Cancelled };
        self.seen |= !focused;
        let answer = match receive.try_recv() {
            Ok((Some(file), _)) => Answer::File(file),
            // a busy machine may be slow to find out that there is nobody
            Ok((None, took)) if took < INSTANT || !self.seen => Answer::NoService,
            Ok((None, _)) => Answer::Cancelled,
            Err(TryRecvError::Disconnected) => Answer::NoService,
            Err(TryRecvError::Empty) if !self.seen && start.elapsed() > PATIENCE => {
                Answer::NoService
            }
            Err(TryRecvError::Empty) => return Answer::Waiting,
        };
        self.asked = None;
        answer
    }

    fn show_folder(&mut self, folder: &Path) -> bool {
        let opener = match std::env::consts::OS {
            "windows" => "explorer",
            "macos" => "open",
            _ => "xdg-open",
        };
        let started = Command::new(opener).arg(folder).stdin(Stdio::null()).spawn();
        // Waited for, so that the system may forget it.
        started.map(|mut child| std::thread::spawn(move || child.wait())).is_ok()
    }
}

fn dialog(question: &Question) -> rfd::AsyncFileDialog {
    let (kind, endings) = question.purpose.filter();
    let dialog = rfd::AsyncFileDialog::new()
        .set_title(question.purpose.title())
        .add_filter(kind, endings)
        .set_directory(&question.folder);
    if question.name.is_empty() { dialog } else { dialog.set_file_name(&question.name) }
}

/// Dialogs that give prepared answers, for tests.
#[derive(Default)]
pub struct ScriptedDialogs {
    /// The answers to come, the next one last.
    pub answers: Vec<Answer>,
}

impl Dialogs for ScriptedDialogs {
    fn ask(&mut self, _: &Question, _: &egui::Context) {}

    fn answer(&mut self, _: bool) -> Answer {
        self.answers.pop().unwrap_or(Answer::Cancelled)
    }

    fn show_folder(&mut self, _: &Path) -> bool {
        false
    }
}

/// `path` with the ending that the purpose asks for, if it has none. A scene's file has its own ending
/// behind any other, so that no file of another kind is written over. A picture with another ending
/// stays as it is: its format is refused.
pub(super) fn with_ending(path: &Path, purpose: Purpose) -> PathBuf {
    let (_, endings) = purpose.filter();
    match path.extension() {
        None => path.with_extension(endings[0]),
        Some(ending) if purpose == Purpose::Export || endings.iter().any(|e| ending == *e) => {
            path.to_owned()
        }
        Some(_) => PathBuf::from(format!("{}.{}", path.display(), endings[0])),
    }
}

#[cfg(test)]
mod tests {
    use std::sync::mpsc::Sender;

    use super::*;

    #[test]
    fn a_name_without_ending_gets_the_usual_one() {
        assert_eq!(with_ending(Path::new("a/b"), Purpose::Save), Path::new("a/b.toml"));
        assert_eq!(with_ending(Path::new("b.exr"), Purpose::Export), Path::new("b.exr"));
        assert_eq!(with_ending(Path::new("b.jpg"), Purpose::Export), Path::new("b.jpg"));
        let imported = with_ending(Path::new("b.obj"), Purpose::SaveImported);
        assert_eq!(imported, Path::new("b.obj.toml"));
        assert_eq!(with_ending(&imported, Purpose::Save), imported);
    }

    /// Dialogs that were asked `ago`, whether one took the keyboard, and the way to answer.
    fn asked(ago: Duration, seen: bool) -> (SystemDialogs, Sender<(Option<PathBuf>, Duration)>) {
        let (send, receive) = channel();
        let start = Instant::now() - ago;
        (SystemDialogs { asked: Some(Asked { start, receive }), seen }, send)
    }

    #[test]
    fn silence_and_haste_mean_that_nobody_can_be_asked() {
        let (mut dialogs, send) = asked(Duration::ZERO, false);
        assert_eq!(dialogs.answer(true), Answer::Waiting);
        send.send((None, INSTANT / 2)).unwrap();
        assert_eq!(dialogs.answer(true), Answer::NoService);
        let long = PATIENCE + INSTANT;
        let (mut dialogs, _silent) = asked(long, false);
        assert_eq!(dialogs.answer(true), Answer::NoService);
        let (mut dialogs, send) = asked(long, false);
        // A window that lost the keyboard shows its dialog: it may take all the time it wants.
        assert_eq!(dialogs.answer(false), Answer::Waiting);
        assert_eq!(dialogs.answer(true), Answer::Waiting);
        send.send((None, long)).unwrap();
        assert_eq!(dialogs.answer(true), Answer::Cancelled);
    }

    #[test]
    fn a_busy_machine_takes_its_time_to_find_out_that_nobody_can_be_asked() {
        // the system was quick, the window was slow to look
        let (mut dialogs, send) = asked(PATIENCE / 2, true);
        send.send((None, INSTANT / 2)).unwrap();
        assert_eq!(dialogs.answer(true), Answer::NoService);
        // the system was slow, but nothing ever took the keyboard
        let (mut dialogs, send) = asked(PATIENCE / 2, false);
        send.send((None, PATIENCE / 2)).unwrap();
        assert_eq!(dialogs.answer(true), Answer::NoService);
    }
}
