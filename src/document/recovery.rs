//! Keeps unsaved work in a folder of its own until it is saved, and finds it after a crash.

use std::path::{Path, PathBuf};

use super::{Document, DocumentError};

/// Unsaved work of a run that ended without saving it.
#[derive(Clone, Debug)]
pub struct Found {
    /// The file in the recovery folder.
    pub file: PathBuf,
    /// The file that the work belongs to, if it had one.
    pub original: Option<PathBuf>,
    /// Title of the document.
    pub title: String,
    /// Seconds since it was kept.
    pub age_secs: u64,
}

/// The place where this run keeps its unsaved work. Locked while the run lives, so that another run
/// does not take it for lost; removed when there is nothing unsaved.
pub struct Recovery {}

impl Recovery {
    /// A place in `folder`, which is made if it is missing, and the work of dead runs found there.
    pub fn start(_folder: &Path) -> Result<(Recovery, Vec<Found>), DocumentError> {
        todo!()
    }

    /// What to keep of a document: plain data, for any thread.
    pub fn snapshot(&self, _document: &Document) -> Snapshot {
        todo!()
    }

    /// There is nothing unsaved any more.
    pub fn clear(&self) {
        todo!()
    }
}

/// Unsaved work on its way to the recovery folder.
pub struct Snapshot {}

impl Snapshot {
    /// Writes it, whole or not at all.
    pub fn write(&self) -> Result<(), DocumentError> {
        todo!()
    }
}

impl Found {
    /// Opens the work: unsaved, and belonging to its original file. Its own file stays until
    /// [`Found::discard`].
    pub fn open(&self) -> Result<Document, DocumentError> {
        todo!()
    }

    /// Removes the work.
    pub fn discard(self) {
        todo!()
    }
}
