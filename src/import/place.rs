//! What an import has to say: mistakes that end it, and remarks on what has no place in a scene.

use std::fmt;
use std::path::{Path, PathBuf};

/// Where something stands in a file that was read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum At {
    /// The file as a whole.
    File,
    /// A line, counted from 1.
    Line(usize),
    /// Line and column, both counted from 1; columns are characters.
    Column(usize, usize),
    /// A value of a JSON document, as `materials[3].name`.
    Key(String),
    /// A byte, counted from 0.
    Byte(usize),
}

/// A file and a place in it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Place {
    /// The file as it was named.
    pub file: PathBuf,
    /// Where in it.
    pub at: At,
}

impl Place {
    /// A place in a file.
    pub fn new(file: &Path, at: At) -> Place {
        Place { file: file.to_owned(), at }
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let file = self.file.display();
        match &self.at {
            At::File => write!(f, "{file}"),
            At::Line(line) => write!(f, "{file}:{line}"),
            At::Column(line, column) => write!(f, "{file}:{line}:{column}"),
            At::Key(key) => write!(f, "{file}: {key}"),
            At::Byte(byte) => write!(f, "{file}: byte {byte}"),
        }
    }
}

/// Why a file cannot be imported.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ImportError {
    /// Where the fault is.
    pub place: Place,
    /// What is wrong, one line.
    pub cause: String,
    /// A way out, one line.
    pub way_out: String,
}

impl ImportError {
    pub(super) fn new(place: Place, cause: impl Into<String>, way_out: &str) -> ImportError {
        ImportError { place, cause: cause.into(), way_out: way_out.to_owned() }
    }
}

impl fmt::Display for ImportError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}\n  help: {}", self.place, self.cause, self.way_out)
    }
}

impl std::error::Error for ImportError {}

/// Something that a scene cannot hold, that was guessed, or that was added.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Note {
    /// Where it was met first.
    pub place: Place,
    /// What became of it, one line.
    pub text: String,
    /// In how many more places.
    pub more: usize,
}

impl fmt::Display for Note {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.place, self.text)?;
        match self.more {
            0 => Ok(()),
            1 => write!(f, " (and in one more place)"),
            more => write!(f, " (and in {more} more places)"),
        }
    }
}
