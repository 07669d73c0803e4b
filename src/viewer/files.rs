//! Opening, saving, exporting, leaving: questions first, slow work in threads, answers as they come.

use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::time::{Duration, Instant};

use eframe::egui::{Context, ViewportCommand};

use super::Folders;
use super::app::App;
use super::command::Command;
use super::dialog::{Answer, Dialogs, Purpose, Question, with_ending};
use super::export::ExportForm;
use super::import::ImportDone;
use super::inspector::Selection;
use super::on_disk::{self, Changes};
use super::paints::ImageFor;
use super::path_field::PathField;
use crate::document::examples::EXAMPLES;
use crate::document::recovery::Found;
use crate::document::watch::{OnDisk, Watched};
use crate::document::{Document, DocumentError, Missing, Save, TEMPLATES};
use crate::scene::Scene;
use crate::scene::mesh::{Mesh, MeshError};
use crate::scene::texture::{Image, ImageError};
use crate::session::live::Export;

/// Unsaved work is kept after this much rest.
const REST: Duration = Duration::from_secs(1);

/// What is to be done once unsaved work is out of the way.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Next {
    /// Starts from a template.
    New(usize),
    /// Asks for a file and opens it.
    Ask,
    /// Opens a copy of an example.
    Example(usize),
    /// Opens a file.
    Open(PathBuf),
    /// Asks for another program's file and imports it.
    Import,
    /// Closes the window.
    Quit,
}

/// What a file is asked for.
#[derive(Clone, Debug)]
pub(super) enum For {
    /// To open it.
    Open,
    /// To save to it, and then to go on.
    Save(Option<Next>),
    /// To write a picture to it.
    Export(ExportForm),
    /// To use it in place of a mesh that a scene misses.
    Locate { source: Source, located: Located, missing: String },
    /// To show the image that it holds.
    Image(ImageFor),
    /// To make a solid of the mesh that it holds.
    Mesh,
    /// To import it.
    Import,
    /// To write the scene of this file of another program to it.
    ImportTo(PathBuf),
}

/// What a document is opened from.
#[derive(Clone, Debug)]
pub(super) enum Source {
    /// A scene file.
    File(PathBuf),
    /// An example, and the cache folder.
    Example(usize, PathBuf),
    /// Work of a run that ended without saving it.
    Found(Found),
}

/// Meshes that were not where the scene said, and where the person found them.
pub(super) type Located = Vec<(String, PathBuf)>;

impl Source {
    fn open(&self, located: &Located) -> Result<Document, DocumentError> {
        match self {
            Source::File(path) => Document::open_relocated(path, located),
            Source::Example(number, cache) => EXAMPLES[*number].open(cache),
            Source::Found(found) => found.open_relocated(located),
        }
    }
}

/// What waits for the person, over the window.
pub(super) enum Modal {
    /// Unsaved work, and what comes after it.
    Unsaved(Next),
    /// What to export.
    Export(ExportForm),
    /// A file, typed.
    Path(PathField, For),
    /// A scene that could not be opened; the last part names a file that may be located.
    BadScene { source: Source, located: Located, message: String, missing: Option<Missing> },
    /// The file to be replaced was changed by another program.
    Changed { save: Save, message: String, next: Option<Next> },
    /// Work of a run that ended without saving it.
    Recover(Vec<Found>),
    /// Remarks on an import, or why it failed.
    Imported { failed: bool, text: String },
}

/// What threads have done.
pub(super) enum Done {
    /// With the scene that was open when it began.
    Opened {
        source: Source,
        located: Located,
        before: Box<Scene>,
        result: Box<Result<Document, DocumentError>>,
    },
    Saved {
        save: Save,
        result: Result<(), DocumentError>,
        next: Option<Next>,
    },
    Kept(Result<(), DocumentError>),
    Image {
        path: PathBuf,
        place: ImageFor,
        result: Box<Result<Image, ImageError>>,
    },
    Mesh {
        path: PathBuf,
        result: Result<Mesh, MeshError>,
    },
    Imported(ImportDone),
    /// Another program changed a file.
    OnDisk(OnDisk),
}

/// Files, dialogs and threads of the window.
pub(super) struct Files {
    pub(super) folders: Folders,
    pub(super) dialogs: Box<dyn Dialogs>,
    /// What the dialog that shows is for.
    asking: Option<(Question, For)>,
    pub(super) modal: Option<Modal>,
    /// Work of runs that ended without saving it, until it is offered.
    pub(super) found: Vec<Found>,
    /// Work that was opened, until it is kept anew or no longer unsaved.
    recovered: Option<Found>,
    send: Sender<Done>,
    receive: Receiver<Done>,
    /// The latest edit that is not kept yet.
    touched: Option<Instant>,
    /// The window may close without a question.
    leaving: bool,
    /// The thread that looks at files, once there are some.
    watcher: Option<Sender<Watched>>,
}

impl Files {
    pub(super) fn new(folders: Folders, dialogs: Box<dyn Dialogs>) -> Files {
        let (send, receive) = channel();
        Files {
            folders,
            dialogs,
            asking: None,
            modal: None,
            found: Vec::new(),
            recovered: None,
            send,
            receive,
            touched: None,
            leaving: false,
            watcher: None,
        }
    }

    /// Offers what was found, if anything was, once no other question waits.
    pub(super) fn offer_recovery(&mut self, found: Vec<Found>) {
        self.found = found;
    }

    /// Asks a question. Found work that is being offered waits until it is answered.
    pub(super) fn show(&mut self, modal: Modal) {
        if let Some(Modal::Recover(found)) = self.modal.replace(modal) {
            self.found = found;
        }
    }

    /// Takes the question that waits.
    pub(super) fn take_modal(&mut self) -> Option<Modal> {
        self.modal.take().or_else(|| {
            let found = std::mem::take(&mut self.found);
            (!found.is_empty()).then_some(Modal::Recover(found))
        })
    }

    /// What was recovered is safe elsewhere, or given up: its old file goes.
    fn discard_recovered(&mut self) {
        if let Some(found) = self.recovered.take() {
            found.discard();
        }
    }

    /// Whether keys belong to a question and not to the window.
    pub(super) fn is_modal(&self) -> bool {
        self.modal.is_some() || self.asking.is_some() || !self.found.is_empty()
    }

    /// The document was edited.
    pub(super) fn touched(&mut self) {
        self.touched = Some(Instant::now());
    }

    /// Does slow work in a thread; the window hears of it.
    pub(super) fn work(&self, ctx: &Context, job: impl FnOnce() -> Done + Send + 'static) {
        let (send, ctx) = (self.send.clone(), ctx.clone());
        std::thread::spawn(move || {
            // A window that is closed meanwhile has no use for the result.
            let _ = send.send(job());
            ctx.request_repaint();
        });
    }
}

impl App {
    /// Reads a scene file in a thread.
    pub(super) fn open_in_background(&mut self, ctx: &Context, path: PathBuf) {
        self.open_source(ctx, Source::File(path), Vec::new());
    }

    /// Opens a document in a thread.
    pub(super) fn open_source(&mut self, ctx: &Context, source: Source, located: Located) {
        let before = Box::new(self.document.scene().clone());
        self.files.work(ctx, move || {
            let result = Box::new(source.open(&located));
            Done::Opened { source, located, before, result }
        });
    }

    pub(super) fn run_file_command(&mut self, ctx: &Context, command: Command) {
        match command {
            Command::New(template) => self.after_unsaved(ctx, Next::New(template)),
            Command::Example(number) => self.after_unsaved(ctx, Next::Example(number)),
            Command::Open => self.after_unsaved(ctx, Next::Ask),
            Command::OpenRecent(i) => {
                if let Some(path) = self.settings.recent.get(i).cloned() {
                    self.after_unsaved(ctx, Next::Open(path));
                }
            }
            Command::Import => self.after_unsaved(ctx, Next::Import),
            Command::Save => self.save(ctx, None),
            Command::SaveAs => self.ask_save(ctx, None),
            Command::Export => {
                let form = ExportForm::new(self.document.scene().picture.size);
                self.files.show(Modal::Export(form));
            }
            Command::Keep => self.keep_traced(),
            _ => {}
        }
    }

    /// Goes on, after asking about unsaved work if there is any.
    fn after_unsaved(&mut self, ctx: &Context, next: Next) {
        self.document.end_gesture();
        if self.document.is_unsaved() {
            self.files.show(Modal::Unsaved(next));
        } else {
            self.go_on(ctx, next);
        }
    }

    /// Goes on without a question.
    pub(super) fn go_on(&mut self, ctx: &Context, next: Next) {
        match next {
            Next::New(template) => {
                let (name, text) = TEMPLATES[template];
                match Document::untitled(name, text) {
                    Ok(document) => self.replace_document(document),
                    Err(error) => self.notices.error(error.message),
                }
            }
            Next::Ask => self.ask(ctx, Purpose::Open, String::new(), For::Open),
            Next::Example(number) => {
                let cache = self.files.folders.cache.clone();
                self.open_source(ctx, Source::Example(number, cache), Vec::new());
            }
            Next::Open(path) => self.open_in_background(ctx, path),
            Next::Import => self.ask_import(ctx),
            Next::Quit => {
                self.files.leaving = true;
                ctx.send_viewport_cmd(ViewportCommand::Close);
            }
        }
    }

    fn replace_document(&mut self, document: Document) {
        self.put_document(document);
        self.show_opened();
    }

    /// Takes another document, which is still to be shown.
    pub(super) fn put_document(&mut self, document: Document) {
        self.live.leave();
        self.document = document;
        self.changes = Changes::default();
        self.copied = None;
        self.welcome.close();
        self.selection = Selection::Scene;
        (self.picked, self.renaming) = (None, None);
        self.mixer.forget();
        self.strip.forget();
        self.compare.forget();
        self.chart.forget();
        self.mass.forget();
        self.pixel.forget();
    }

    /// Saves to the document's file, or asks for one.
    pub(super) fn save(&mut self, ctx: &Context, next: Option<Next>) {
        match self.document.path().map(Path::to_owned) {
            Some(path) => self.save_to(ctx, &path, next),
            None => self.ask_save(ctx, next),
        }
    }

    pub(super) fn ask_save(&mut self, ctx: &Context, next: Option<Next>) {
        let name = format!("{}.toml", self.document.title().trim_end_matches(".toml"));
        self.ask(ctx, Purpose::Save, name, For::Save(next));
    }

    fn save_to(&mut self, ctx: &Context, path: &Path, next: Option<Next>) {
        self.document.end_gesture();
        if self.copied.is_some()
            && let Err(error) = self.document.take_along(&self.files.folders.cache, path)
        {
            return self.notices.error(error.message);
        }
        match self.document.save(path) {
            Ok(save) => self.write(ctx, save, next),
            Err(error) => self.notices.error(error.message),
        }
    }

    /// Writes a scene file in a thread.
    pub(super) fn write(&mut self, ctx: &Context, save: Save, next: Option<Next>) {
        self.files.work(ctx, move || {
            let result = save.write();
            Done::Saved { save, result, next }
        });
    }

    /// Asks for a file by the system's dialog.
    pub(super) fn ask(&mut self, ctx: &Context, purpose: Purpose, name: String, what: For) {
        let folder = self.document.home().map(Path::to_owned);
        let folder = folder.filter(|f| !f.as_os_str().is_empty());
        let folder = folder.or_else(|| std::env::current_dir().ok()).unwrap_or_default();
        self.ask_question(ctx, Question { purpose, folder, name }, what);
    }

    /// The same with a folder to begin in.
    pub(super) fn ask_question(&mut self, ctx: &Context, question: Question, what: For) {
        self.files.dialogs.ask(&question, ctx);
        self.files.asking = Some((question, what));
    }

    /// A file was chosen.
    pub(super) fn chosen(&mut self, ctx: &Context, file: PathBuf, what: For) {
        match what {
            For::Open => self.open_in_background(ctx, file),
            For::Save(next) => self.save_to(ctx, &with_ending(&file, Purpose::Save), next),
            For::Export(form) => {
                let path = with_ending(&file, Purpose::Export);
                match form.format_for(&path) {
                    Ok(format) => {
                        let (size, extras) = (form.size, form.extras(format));
                        self.live.export(Export { path, format, size, extras });
                    }
                    Err(message) => self.notices.error(message),
                }
            }
            For::Image(place) => self.read_image(ctx, file, place),
            For::Mesh => self.read_mesh(ctx, file),
            For::Import => self.ask_import_target(ctx, file),
            For::ImportTo(source) => self.import(ctx, source, &file),
            For::Locate { source, mut located, missing } => {
                located.push((missing, file));
                self.open_source(ctx, source, located);
            }
        }
    }

    /// Takes what dialogs and threads have brought, dropped files, and the wish to close.
    pub(super) fn receive_files(&mut self, ctx: &Context) {
        self.receive_answer(ctx);
        while let Ok(done) = self.files.receive.try_recv() {
            self.receive_done(ctx, done);
        }
        let dropped = ctx.input(|i| {
            i.raw
                .dropped_files
                .iter()
                .map(|f| f.path().to_owned())
                .find(|p| !p.as_os_str().is_empty())
        });
        if let Some(path) = dropped {
            self.after_unsaved(ctx, Next::Open(path));
        }
        let close = ctx.input(|i| i.viewport().close_requested());
        if close && !self.files.leaving && !self.is_moving && self.document.is_unsaved() {
            ctx.send_viewport_cmd(ViewportCommand::CancelClose);
            self.files.show(Modal::Unsaved(Next::Quit));
        }
    }

    fn receive_answer(&mut self, ctx: &Context) {
        let Some((question, what)) = self.files.asking.take() else { return };
        let focused = ctx.input(|i| i.focused);
        match self.files.dialogs.answer(focused) {
            Answer::Waiting => {
                self.files.asking = Some((question, what));
                ctx.request_repaint_after(Duration::from_millis(100));
            }
            Answer::File(file) => self.chosen(ctx, file, what),
            Answer::Cancelled => {
                if let Some(modal) = what.back() {
                    self.files.show(modal);
                }
            }
            Answer::NoService => {
                self.files.show(Modal::Path(PathField::new(question, ctx), what));
            }
        }
    }

    fn receive_done(&mut self, ctx: &Context, done: Done) {
        match done {
            Done::Opened { source, located, before, result } => match *result {
                Ok(document) => self.opened(source, &before, document),
                Err(DocumentError { message, missing, changed_on_disk: _ }) => {
                    if self.shown.is_none() {
                        self.show_scene();
                    }
                    self.files.show(Modal::BadScene { source, located, message, missing });
                }
            },
            Done::Saved { save, result: Ok(()), next } => {
                let lost = if save.comments_lost { "; its comments could not be kept" } else { "" };
                self.notices.say(format!("saved {}{lost}", save.path.display()));
                self.remember_file(&save.path.clone());
                self.document.saved(save);
                // What was on disk is replaced, or the document is another file's.
                self.changes.forget_scene();
                // Another folder may have changed the paths of meshes, and nothing is unsaved now.
                self.show_scene();
                if let Some(next) = next {
                    // There may be edits since.
                    self.after_unsaved(ctx, next);
                }
            }
            Done::Saved { save, result: Err(error), next } if error.changed_on_disk => {
                self.files.show(Modal::Changed { save, message: error.message, next });
            }
            Done::Saved { result: Err(error), .. } => self.notices.error(error.message),
            Done::Image { path, place, result } => self.image_read(&path, &place, *result),
            Done::Mesh { path, result } => self.mesh_read(&path, result),
            Done::Imported(done) => self.imported(done),
            Done::OnDisk(change) => self.changed_on_disk(change),
            Done::Kept(Ok(())) => self.files.discard_recovered(),
            Done::Kept(Err(error)) => {
                self.notices.error(format!("unsaved work is not kept: {}", error.message));
            }
        }
    }

    fn remember_file(&mut self, path: &Path) {
        self.settings.remember(path);
        self.remember_settings();
    }

    /// Writes the settings; small, and at most once per click.
    pub(super) fn remember_settings(&mut self) {
        if let Err(message) = self.settings.write(&self.files.folders.settings_file()) {
            self.notices.error(message);
        }
    }

    /// After a moment's rest: watches the document's files, keeps unsaved work, and forgets it once it is
    /// saved.
    pub(super) fn autosave(&mut self, ctx: &Context) {
        let Some(touched) = self.files.touched else { return };
        if let Some(rest) = REST.checked_sub(touched.elapsed()) {
            ctx.request_repaint_after(rest);
            return;
        }
        self.files.touched = None;
        self.watch_files();
        let Some(recovery) = &self.recovery else { return };
        if self.document.is_unsaved() {
            let snapshot = recovery.snapshot(&self.document);
            self.files.work(ctx, move || Done::Kept(snapshot.write()));
        } else {
            recovery.clear();
            self.files.discard_recovered();
        }
    }

    /// Tells the thread that looks at files which ones they are.
    fn watch_files(&mut self) {
        let Files { watcher, send, .. } = &mut self.files;
        let orders =
            watcher.get_or_insert_with(|| on_disk::watcher(send.clone(), self.waker.clone()));
        // A thread that failed is not missed: saving looks at the file itself.
        let _ = orders.send(self.document.watched());
    }

    /// The window closes: nothing unsaved is left that the person did not give up.
    pub(super) fn leave(&mut self) {
        if let Some(recovery) = &self.recovery {
            recovery.clear();
        }
        self.files.discard_recovered();
    }

    /// Shows what was opened, unless there were edits since it was asked for: they are not lost.
    pub(super) fn opened(&mut self, source: Source, before: &Scene, document: Document) {
        let edited = self.document.is_unsaved() && self.document.scene() != before;
        match source {
            Source::File(path) if edited => self.files.show(Modal::Unsaved(Next::Open(path))),
            Source::Example(number, _) if edited => {
                self.files.show(Modal::Unsaved(Next::Example(number)));
            }
            Source::Found(found) if edited => self.files.show(Modal::Recover(vec![found])),
            Source::File(path) => {
                self.replace_document(document);
                self.remember_file(&path);
            }
            Source::Example(number, _) => self.show_example(number, document),
            Source::Found(found) => {
                self.replace_document(document);
                self.files.recovered = Some(found);
            }
        }
    }
}
