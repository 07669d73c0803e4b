//! One import under way: the files that it reads, those that it will write, and its remarks.

use std::collections::{HashMap, HashSet};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::mesh_text;
use super::place::{At, ImportError, Note, Place};
use crate::scene::relative::{relative, resolved};
use crate::scene::texture::{self, Image};
use crate::scene::{ImageFile, Shape, mesh};

/// Reads a file whole.
pub(super) type Fetch<'a> = &'a dyn Fn(&Path) -> io::Result<Vec<u8>>;

/// A file that belongs to the imported scene and is not there yet.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// As the scene names it, relative to the scene's folder.
    pub name: String,
    /// What it holds.
    pub bytes: Vec<u8>,
}

/// An import under way.
pub(super) struct Job<'a> {
    /// The file that is imported.
    pub(super) source: &'a Path,
    /// The scene file that will be.
    target: &'a Path,
    fetch: Fetch<'a>,
    pub(super) notes: Vec<Note>,
    /// Where each remark stands in `notes`, by its text.
    said: HashMap<String, usize>,
    pub(super) parts: Vec<Part>,
    names: HashSet<String>,
    images: HashMap<PathBuf, Option<Arc<Image>>>,
}

impl<'a> Job<'a> {
    pub(super) fn new(source: &'a Path, target: &'a Path, fetch: Fetch<'a>) -> Job<'a> {
        Job {
            source,
            target,
            fetch,
            notes: Vec::new(),
            said: HashMap::new(),
            parts: Vec::new(),
            names: HashSet::new(),
            images: HashMap::new(),
        }
    }

    /// A place in the imported file.
    pub(super) fn place(&self, at: At) -> Place {
        Place::new(self.source, at)
    }

    /// An error in the imported file.
    pub(super) fn error(&self, at: At, cause: impl Into<String>, way_out: &str) -> ImportError {
        ImportError::new(self.place(at), cause, way_out)
    }

    /// Says something about the imported file. The same text in another place is only counted.
    pub(super) fn note(&mut self, at: At, text: impl Into<String>) {
        self.note_at(self.place(at), text);
    }

    /// Says something about a place in any file.
    pub(super) fn note_at(&mut self, place: Place, text: impl Into<String>) {
        let text = text.into();
        match self.said.get(&text) {
            Some(&index) => self.notes[index].more += 1,
            None => {
                self.said.insert(text.clone(), self.notes.len());
                self.notes.push(Note { place, text, more: 0 });
            }
        }
    }

    /// Where a file is that the imported one names; other systems write `\` between folders.
    pub(super) fn path_of(&self, name: &str) -> PathBuf {
        let folder = self.source.parent().unwrap_or(Path::new(""));
        folder.join(name.replace('\\', "/"))
    }

    /// What a file holds.
    pub(super) fn read(&self, path: &Path) -> io::Result<Vec<u8>> {
        (self.fetch)(path)
    }

    /// How the scene names a file that is already there.
    pub(super) fn name_of(&self, path: &Path) -> String {
        let folder = self.target.parent().filter(|folder| !folder.as_os_str().is_empty());
        relative(path, folder.unwrap_or(Path::new(".")))
            .unwrap_or_else(|| path.to_string_lossy().into_owned())
    }

    /// An image file named at `place`; `None`, with a remark, if it cannot be shown.
    pub(super) fn image(&mut self, name: &str, place: Place) -> Option<ImageFile> {
        let path = self.path_of(name);
        if !self.images.contains_key(&path) {
            let decoded = match self.read(&path) {
                Ok(bytes) => texture::of_bytes(&bytes),
                Err(error) => Err(format!("cannot be read: {error}")),
            };
            let image = match decoded {
                Ok(image) => Some(Arc::new(image)),
                Err(cause) => {
                    let text = format!("the image `{name}` is left out, {cause}");
                    self.note_at(place, text);
                    None
                }
            };
            self.images.insert(path.clone(), image);
        }
        let image = self.images.get(&path)?.clone()?;
        Some(ImageFile { file: self.name_of(&path), image })
    }

    /// An image that stands inside of the imported file, which becomes a file of its own.
    pub(super) fn image_inside(&mut self, stem: &str, bytes: &[u8], at: At) -> Option<ImageFile> {
        let ending = if bytes.starts_with(&[0xff, 0xd8]) { "jpg" } else { "png" };
        match texture::of_bytes(bytes) {
            Ok(image) => {
                let file = self.part(stem, ending, bytes.to_vec());
                Some(ImageFile { file, image: Arc::new(image) })
            }
            Err(cause) => {
                self.note(at, format!("the image is left out, {cause}"));
                None
            }
        }
    }

    /// A mesh in a file of its own, from the text of an OBJ file.
    pub(super) fn mesh(&mut self, stem: &str, text: String) -> Result<Shape, ImportError> {
        // What the scene holds is what will be read from the file.
        let mesh = mesh::of_bytes(text.as_bytes(), self.source).map_err(of_mesh)?;
        let file = self.part(stem, "obj", text.into_bytes());
        Ok(Shape::Mesh { file, mesh: Arc::new(mesh) })
    }

    /// The same from lists of points and triangles.
    pub(super) fn mesh_of(&mut self, stem: &str, mesh: &mesh::Mesh) -> Result<Shape, ImportError> {
        self.mesh(stem, mesh_text::text(mesh))
    }

    /// Adds a file to be written into the folder `STEM-parts` beside the scene; gives its name there.
    fn part(&mut self, stem: &str, ending: &str, bytes: Vec<u8>) -> String {
        let scene = self.target.file_stem().unwrap_or_default().to_string_lossy();
        let plain = |c: char| if c.is_alphanumeric() || "-_".contains(c) { c } else { '_' };
        let stem: String = stem.chars().map(plain).take(60).collect();
        let stem = if stem.is_empty() { "part".to_owned() } else { stem };
        let mut name = format!("{scene}-parts/{stem}.{ending}");
        let mut number = 2;
        // File systems may take `A` and `a` for one name.
        while self.is_source(&name) || !self.names.insert(name.to_lowercase()) {
            name = format!("{scene}-parts/{stem}-{number}.{ending}");
            number += 1;
        }
        self.parts.push(Part { name: name.clone(), bytes });
        name
    }
}

impl Job<'_> {
    /// Whether a file beside the scene is the imported one, which must not be written over.
    fn is_source(&self, name: &str) -> bool {
        let path = self.target.parent().unwrap_or(Path::new("")).join(name);
        path.file_name() == self.source.file_name() && resolved(&path) == resolved(self.source)
    }
}

/// The error of the reader of meshes as one of an import.
pub(super) fn of_mesh(error: mesh::MeshError) -> ImportError {
    let mesh::MeshError { file, line, column, cause, way_out } = error;
    let at = match (line, column) {
        (Some(line), Some(column)) => At::Column(line, column),
        (Some(line), None) => At::Line(line),
        (None, _) => At::File,
    };
    ImportError { place: Place { file, at }, cause, way_out }
}

/// Names that are taken: gives each new thing one of its own.
#[derive(Debug, Default)]
pub(super) struct Names {
    taken: HashSet<String>,
    /// Per wish the number that is tried next.
    next: HashMap<String, usize>,
}

impl Names {
    /// `wish`, or with a number behind it if that is taken; `kind` in place of an empty wish.
    pub(super) fn take(&mut self, wish: &str, kind: &str) -> String {
        let wish: String = wish.trim().chars().filter(|c| !c.is_control()).take(200).collect();
        let wish = if wish.is_empty() { kind.to_owned() } else { wish };
        let mut name = wish.clone();
        while !self.taken.insert(name.clone()) {
            let number = self.next.entry(wish.clone()).or_insert(2);
            name = format!("{wish} {number}");
            *number += 1;
        }
        name
    }
}
