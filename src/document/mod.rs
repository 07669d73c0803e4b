//! The work of a person: a scene, its file, its history of edits, and what keeps it from being lost.

pub mod arrangement;
pub mod examples;
mod history;
pub mod looks;
mod open;
mod outline;
mod patch;
mod patch_looks;
pub mod placing;
pub mod presets;
pub mod recovery;
mod relocate;
mod save;
pub mod settings;
mod splice;
mod step;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod tests_patch;
pub mod things;
pub mod watch;

use std::fmt;
use std::path::{Path, PathBuf};
use std::sync::Arc;

pub use save::Save;

use crate::scene::Scene;
use crate::scene::check::validate;
use crate::scene::relative::{relative, resolved};
use history::{History, same_bits};
use patch::patch;
use relocate::relocate;
use save::file_name;

/// A scene being edited, with its file and its history.
pub struct Document {
    /// For the title bar, as long as there is no file.
    name: String,
    /// Absolute.
    path: Option<PathBuf>,
    /// Where it came from, as long as there is no file: the folder of a picture. Absolute.
    home: Option<PathBuf>,
    base: Base,
    /// The scene as opened or saved last.
    saved: Arc<Scene>,
    /// What the file held when it was opened or saved last.
    disk: Option<Arc<str>>,
    history: History,
    /// Whether it was found after a crash and the scene of its file is not known.
    is_rescued: bool,
    /// Whether another program moved or deleted its file.
    is_gone: bool,
    is_unsaved: bool,
}

/// A text with the comments to keep, and the scene that it reads as.
#[derive(Clone)]
struct Base {
    text: Arc<str>,
    scene: Arc<Scene>,
}

/// A scene that could not be opened or saved: the place, the cause, and the way out.
#[derive(Clone, Debug, Default)]
pub struct DocumentError {
    /// Several lines, for the person.
    pub message: String,
    /// A file that was not found: the person may locate it.
    pub missing: Option<Missing>,
    /// The file was changed by another program: [`Save::overwrite`] replaces it all the same.
    pub changed_on_disk: bool,
}

/// A file that a scene names.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Missing {
    /// What it holds.
    pub kind: FileKind,
    /// As written in the scene.
    pub file: String,
}

/// What a file holds that a scene names.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FileKind {
    /// Triangles.
    Mesh,
    /// A picture to lay on a surface or around the scene.
    Image,
}

impl fmt::Display for FileKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            FileKind::Mesh => "mesh",
            FileKind::Image => "image",
        })
    }
}

impl DocumentError {
    fn new(message: impl fmt::Display) -> DocumentError {
        DocumentError { message: message.to_string(), ..DocumentError::default() }
    }
}

impl fmt::Display for DocumentError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl std::error::Error for DocumentError {}

/// The scene that is always there: name and text.
pub const BUILT_IN: (&str, &str) = ("Whitted's spheres", include_str!("../../scenes/whitted.toml"));

/// Scenes to begin with: name and text.
pub const TEMPLATES: &[(&str, &str)] = &[
    ("Empty stage", include_str!("templates/stage.toml")),
    ("Glass on a table", include_str!("templates/glass.toml")),
    ("Material ball", include_str!("templates/ball.toml")),
];

/// The first thing wrong with `after` that is not wrong with `before`, with a way out.
pub fn flaw(before: &Scene, after: &Scene) -> Option<String> {
    let flaws = validate(after);
    if flaws.is_empty() {
        return None;
    }
    let known = validate(before);
    let new = flaws.into_iter().find(|flaw| !known.contains(flaw))?;
    Some(format!("{}: {}\n  help: {}", new.path.join("."), new.message, new.help))
}

impl Document {
    /// The built-in scene.
    pub fn built_in() -> Document {
        let (name, text) = BUILT_IN;
        Document::untitled(name, text).expect("the built-in scene has no mistakes")
    }

    /// The scene as edited.
    pub fn scene(&self) -> &Scene {
        self.history.scene()
    }

    /// The same, to be kept: another edit makes another one.
    pub fn shared_scene(&self) -> Arc<Scene> {
        Arc::clone(self.history.scene())
    }

    /// The scene as it was opened or last saved, to be kept.
    pub fn shared_saved_scene(&self) -> Arc<Scene> {
        Arc::clone(&self.saved)
    }

    /// Takes an edited scene; edits of one gesture, until [`Document::end_gesture`], are one step.
    /// It must be valid: see [`flaw`].
    ///
    /// While a look is worn, edits of what it is about belong to it: see [`looks::follow`].
    pub fn change(&mut self, mut scene: Scene) {
        looks::follow(self.history.scene(), &mut scene);
        self.history.change(scene);
        self.refresh();
    }

    /// Gives the step that [`Document::change`] just made a name of its own, where what differs does
    /// not say what was meant.
    pub fn name_step(&mut self, name: String) {
        self.history.name_step(name);
    }

    /// Ends a gesture: the next change begins a new step.
    pub fn end_gesture(&mut self) {
        self.history.end_gesture();
    }

    /// Takes the latest step back; whether there was one.
    pub fn undo(&mut self) -> bool {
        let is_done = self.history.undo();
        self.refresh();
        is_done
    }

    /// Does the step again that was taken back last; whether there was one.
    pub fn redo(&mut self) -> bool {
        let is_done = self.history.redo();
        self.refresh();
        is_done
    }

    /// Name of the step that [`Document::undo`] would take back, such as `diffuse of tiles 0.70 → 0.42`.
    pub fn undo_name(&self) -> Option<&str> {
        self.history.undo_name()
    }

    /// Name of the step that [`Document::redo`] would do.
    pub fn redo_name(&self) -> Option<&str> {
        self.history.redo_name()
    }

    /// Its file, if it has one; absolute.
    pub fn path(&self) -> Option<&Path> {
        self.path.as_deref()
    }

    /// The folder of its file, or where it came from: where a dialog begins.
    pub fn home(&self) -> Option<&Path> {
        self.path.as_deref().and_then(Path::parent).or(self.home.as_deref())
    }

    /// For the title bar: the file's name or the template's.
    pub fn title(&self) -> String {
        self.path.as_deref().map_or_else(|| self.name.clone(), file_name)
    }

    /// Whether the scene differs from its file, or the file is gone.
    pub fn is_unsaved(&self) -> bool {
        self.is_unsaved
    }

    /// The scene as it was opened or last saved, for marks beside changed values.
    pub fn saved_scene(&self) -> &Scene {
        &self.saved
    }

    /// What saving to `path` would write; comments and order of the present text stay. Mesh files
    /// are named from the folder of `path`.
    pub fn save(&self, path: &Path) -> Result<Save, DocumentError> {
        let path = std::path::absolute(path).map_err(DocumentError::new)?;
        let mut scene = self.scene().clone();
        relocate(&mut scene, &self.folder(), folder_of(&path));
        let patched = patch(&self.base.text, &self.base.scene, &scene);
        let is_own = self.path.as_deref().is_some_and(|own| resolved(own) == resolved(&path));
        Ok(Save {
            path,
            text: patched.text,
            comments_lost: patched.comments_lost,
            overwrite: false,
            scene: Arc::new(scene),
            expected: self.disk.clone().filter(|_| is_own),
        })
    }

    /// `save` was written: the document now belongs to that file. Edits made since stay unsaved.
    pub fn saved(&mut self, save: Save) {
        let (from, to) = (self.folder(), folder_of(&save.path).to_owned());
        if resolved(&from) != resolved(&to) {
            self.history.edit_all(&mut |scene| relocate(scene, &from, &to));
        }
        let text: Arc<str> = save.text.into();
        self.disk = Some(Arc::clone(&text));
        self.saved = Arc::clone(&save.scene);
        self.base = Base { text, scene: save.scene };
        self.path = Some(save.path);
        (self.is_rescued, self.is_gone) = (false, false);
        self.refresh();
    }

    /// Whether another program moved or deleted its file.
    pub fn is_gone(&self) -> bool {
        self.is_gone
    }

    /// Notes whether its file is gone: what is here is then all there is, and counts as unsaved.
    pub fn set_gone(&mut self, is_gone: bool) {
        self.is_gone = is_gone;
        self.refresh();
    }

    /// How the scene names a mesh or image file: relative to its own file, if it has one.
    pub fn name_of(&self, file: &Path) -> String {
        let named = self.path.as_deref().and_then(|path| relative(file, folder_of(path)));
        let whole = || resolved(file).to_string_lossy().into_owned();
        named.unwrap_or_else(whole)
    }

    /// The folder that mesh and image files are relative to.
    fn folder(&self) -> PathBuf {
        self.path.as_deref().map_or_else(|| PathBuf::from("."), |path| folder_of(path).to_owned())
    }

    /// Compares with the file, once an edit rather than once a frame.
    fn refresh(&mut self) {
        let differs = || !same_bits(self.history.scene(), &self.saved);
        self.is_unsaved = self.is_rescued || self.is_gone || differs();
    }
}

fn folder_of(path: &Path) -> &Path {
    path.parent().unwrap_or(Path::new(""))
}
