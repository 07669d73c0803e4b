//! Opens scene files, also when the mesh and image files that they name lie elsewhere.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use toml::de::DeTable;

use super::history::History;
use super::save::file_name;
use super::{Base, Document, DocumentError, FileKind, Missing};
use crate::film::embedded::{is_picture, scene_text};
use crate::scene::relative::{relative, resolved};
use crate::scene::{Scene, mesh, read, texture};

impl Document {
    /// A document without a file, from a template or the built-in scene.
    pub fn untitled(name: &str, text: &str) -> Result<Document, DocumentError> {
        let scene = read::text(text, Path::new(name)).map_err(DocumentError::new)?;
        Ok(Document::of(name, text, scene))
    }

    /// A document without a file whose text reads as `scene`.
    pub(super) fn of(name: &str, text: &str, scene: Scene) -> Document {
        let base = Base { text: text.into(), scene: Arc::new(scene.clone()) };
        Document {
            name: name.to_owned(),
            path: None,
            home: None,
            saved: Arc::clone(&base.scene),
            base,
            disk: None,
            history: History::new(scene),
            is_rescued: false,
            is_gone: false,
            is_unsaved: false,
        }
    }

    /// Opens a scene file.
    pub fn open(path: &Path) -> Result<Document, DocumentError> {
        Document::open_relocated(path, &[])
    }

    /// Opens a scene file with mesh and image files that were found elsewhere, by their missing names:
    /// the text, so edited, counts as unsaved. Others that are missing are also sought beside those
    /// found.
    pub fn open_relocated(
        path: &Path,
        found: &[(String, PathBuf)],
    ) -> Result<Document, DocumentError> {
        let path = &std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
        if is_picture(path) {
            return Document::of_picture(path, found);
        }
        let bytes = std::fs::read(path).map_err(|error| {
            let help = "check the name of the file and its permissions";
            DocumentError::new(format!(
                "{}: cannot be read: {error}\n  help: {help}",
                path.display()
            ))
        })?;
        let folder = path.parent().unwrap_or(Path::new(""));
        let text = String::from_utf8_lossy(&bytes);
        let found = replacements(&text, folder, found);
        let known = known(&text, &found)?;
        let scene = read::bytes(&bytes, path, known)
            .map_err(|error| with_missing(error.to_string(), &text, folder, &found))?;
        let edited = replaced(&scene, &found, folder);
        let mut document = Document::of(&file_name(path), &text, scene);
        document.path = Some(path.clone());
        document.disk = Some(Arc::clone(&document.base.text));
        document.history = History::new(edited);
        document.refresh();
        Ok(document)
    }
}

impl Document {
    /// The scene that an exported picture holds: a document without a file. Mesh and image files are
    /// sought beside the picture, and then named absolutely.
    fn of_picture(path: &Path, found: &[(String, PathBuf)]) -> Result<Document, DocumentError> {
        let text = scene_text(path).map_err(DocumentError::new)?;
        let folder = path.parent().unwrap_or(Path::new(""));
        let found = replacements(&text, folder, found);
        let scene = read::text_with(&text, path, known(&text, &found)?)
            .map_err(|error| with_missing(error.to_string(), &text, folder, &found))?;
        let mut edited = replaced(&scene, &found, folder);
        named_absolutely(&mut edited, folder);
        let mut document = Document::of(&file_name(&path.with_extension("")), &text, scene);
        document.home = Some(folder.to_owned());
        document.history = History::new(edited);
        document.refresh();
        Ok(document)
    }
}

/// Names the mesh and image files of a scene in `folder` absolutely.
pub(super) fn named_absolutely(scene: &mut Scene, folder: &Path) {
    scene.each_file(&mut |file| {
        if let Some(place) = resolved(&folder.join(&*file)).to_str() {
            *file = place.to_owned();
        }
    });
}

/// Files as the scene names them, and where they are instead.
type Found = Vec<(String, PathBuf)>;

/// Those that were given, and missing ones that lie beside them.
pub(super) fn replacements(text: &str, folder: &Path, given: &[(String, PathBuf)]) -> Found {
    let mut found = given.to_vec();
    for Missing { kind: _, file } in named_files(text) {
        if folder.join(&file).exists() || found.iter().any(|(known, _)| *known == file) {
            continue;
        }
        let name = Path::new(&file).file_name().unwrap_or_default();
        let beside = given.iter().map(|(_, place)| place.with_file_name(name));
        if let Some(place) = beside.into_iter().find(|place| place.is_file()) {
            found.push((file, place));
        }
    }
    found
}

/// Reads the files that were found.
pub(super) fn known(text: &str, found: &Found) -> Result<read::Known, DocumentError> {
    let mut known = read::Known::default();
    for Missing { kind, file } in named_files(text) {
        let Some((_, place)) = found.iter().find(|(missing, _)| *missing == file) else { continue };
        match kind {
            FileKind::Mesh => {
                let mesh = mesh::read_obj(place).map_err(DocumentError::new)?;
                known.meshes.insert(file, Arc::new(mesh));
            }
            FileKind::Image => {
                let image = texture::read(place).map_err(DocumentError::new)?;
                known.images.insert(file, Arc::new(image));
            }
        }
    }
    Ok(known)
}

/// The scene with the files named by where they were found.
pub(super) fn replaced(scene: &Scene, found: &Found, folder: &Path) -> Scene {
    let mut scene = scene.clone();
    scene.each_file(&mut |file| {
        if let Some((_, place)) = found.iter().find(|(missing, _)| missing == file)
            && let Some(name) = relative(place, folder)
        {
            *file = name;
        }
    });
    scene
}

/// The error with the first mesh or image file that is not there, if that may be the cause.
pub(super) fn with_missing(
    mut message: String,
    text: &str,
    folder: &Path,
    found: &Found,
) -> DocumentError {
    let is_missing = |Missing { kind: _, file }: &Missing| {
        !folder.join(file).exists() && found.iter().all(|(known, _)| known != file)
    };
    let missing = named_files(text).into_iter().find(is_missing);
    if let Some(Missing { kind, file }) = &missing {
        let place = folder.join(file);
        message.push_str(&format!(
            "\nthe {kind} file {file} was sought at {}\n  help: put it there, or say where it is",
            place.display()
        ));
    }
    DocumentError { missing, ..DocumentError::new(message) }
}

/// The mesh and image files that a text names, whatever else is wrong with it.
fn named_files(text: &str) -> Vec<Missing> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let (root, _) = DeTable::parse_recoverable(text);
    let mut files = Vec::new();
    gather(root.get_ref(), &mut files);
    files
}

/// Adds `mesh = { file = … }` and `image = { file = … }`, wherever they stand.
fn gather(table: &DeTable<'_>, files: &mut Vec<Missing>) {
    for (key, value) in table {
        let Some(inner) = value.get_ref().as_table() else { continue };
        let kind = match key.get_ref().as_ref() {
            "mesh" => Some(FileKind::Mesh),
            "image" => Some(FileKind::Image),
            _ => None,
        };
        let file = inner.get("file").and_then(|file| file.get_ref().as_str());
        match kind.zip(file) {
            Some((kind, file)) => files.push(Missing { kind, file: file.to_owned() }),
            None => gather(inner, files),
        }
    }
}
