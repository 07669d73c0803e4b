//! The work of a person: a scene, its file, its history of edits, and what keeps it from being lost.

pub mod recovery;
pub mod settings;

use std::path::{Path, PathBuf};

use crate::scene::Scene;

/// A scene being edited, with its file and its history.
pub struct Document {}

/// A scene that could not be opened or saved: the place, the cause, and the way out.
#[derive(Clone, Debug)]
pub struct DocumentError {
    /// Several lines, for the person.
    pub message: String,
    /// A mesh file that was not found, as written in the scene: the person may locate it.
    pub missing: Option<String>,
}

/// Text on its way to a file: plain data, written by any thread.
#[derive(Clone, Debug)]
pub struct Save {
    /// The file.
    pub path: PathBuf,
    /// What it will hold.
    pub text: String,
}

/// Scenes to begin with: name and text.
pub const TEMPLATES: &[(&str, &str)] = &[];

impl Document {
    /// A document without a file, from a template or the built-in scene.
    pub fn untitled(_name: &str, _text: &str) -> Result<Document, DocumentError> {
        todo!()
    }

    /// The built-in scene.
    pub fn built_in() -> Document {
        todo!()
    }

    /// Opens a scene file.
    pub fn open(_path: &Path) -> Result<Document, DocumentError> {
        todo!()
    }

    /// Opens a scene file with a mesh file replaced: the text, so edited, counts as unsaved.
    pub fn open_with(
        _path: &Path,
        _missing: &str,
        _found: &Path,
    ) -> Result<Document, DocumentError> {
        todo!()
    }

    /// The scene as edited.
    pub fn scene(&self) -> &Scene {
        todo!()
    }

    /// Takes an edited scene; edits of one gesture, until [`Document::end_gesture`], are one step.
    pub fn change(&mut self, _scene: Scene) {
        todo!()
    }

    /// Ends a gesture: the next change begins a new step.
    pub fn end_gesture(&mut self) {
        todo!()
    }

    /// Takes the latest step back; whether there was one.
    pub fn undo(&mut self) -> bool {
        todo!()
    }

    /// Does the step again that was taken back last; whether there was one.
    pub fn redo(&mut self) -> bool {
        todo!()
    }

    /// Name of the step that [`Document::undo`] would take back, such as `diffuse of tiles 0.70 → 0.42`.
    pub fn undo_name(&self) -> Option<&str> {
        todo!()
    }

    /// Name of the step that [`Document::redo`] would do.
    pub fn redo_name(&self) -> Option<&str> {
        todo!()
    }

    /// Its file, if it has one.
    pub fn path(&self) -> Option<&Path> {
        todo!()
    }

    /// For the title bar: the file's name or the template's.
    pub fn title(&self) -> String {
        todo!()
    }

    /// Whether the scene differs from its file.
    pub fn is_unsaved(&self) -> bool {
        todo!()
    }

    /// The scene as it was opened or last saved, for marks beside changed values.
    pub fn saved_scene(&self) -> &Scene {
        todo!()
    }

    /// What saving to `path` would write; comments and order of the present text stay.
    pub fn save(&self, _path: &Path) -> Result<Save, DocumentError> {
        todo!()
    }

    /// `save` was written: the document now belongs to that file. Edits made since stay unsaved.
    pub fn saved(&mut self, _save: Save) {
        todo!()
    }
}

/// What makes an edited scene useless that was useful before, if anything does.
pub fn flaw(_before: &Scene, _after: &Scene) -> Option<String> {
    todo!()
}

impl Save {
    /// Writes the file, whole or not at all; the file before it becomes `NAME~`.
    pub fn write(&self) -> Result<(), DocumentError> {
        todo!()
    }
}
