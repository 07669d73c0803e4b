//! Why a kept cache cannot be used, or was not written.

use std::fmt;
use std::path::{Path, PathBuf};

use crate::progress::Cancelled;
use crate::session::trace::TraceError;

/// A cache file that was not used or not written. The scene can be opened without it.
#[derive(Clone, Debug, PartialEq)]
pub struct CacheError {
    /// The cache file.
    pub file: PathBuf,
    /// What is the matter with it.
    pub fault: Fault,
}

/// What is the matter with a cache file.
#[derive(Clone, Debug, PartialEq)]
pub enum Fault {
    /// There is no such file.
    Absent,
    /// It is no cache of this program.
    Foreign,
    /// It was made from something else.
    Stale {
        /// What differs.
        what: String,
    },
    /// Bytes of it are missing or are not what was written.
    Damaged {
        /// The part of the file.
        place: String,
        /// What is wrong there.
        what: String,
    },
    /// What it holds is larger than the budget.
    Memory {
        /// The budget in bytes.
        budget: u64,
    },
    /// The system did not read or write it.
    Io {
        /// What the system says.
        cause: String,
    },
    /// The work that the file left to do was cancelled or failed; without it that would too.
    Stopped(TraceError),
}

impl Fault {
    /// The same with the file's name.
    pub(super) fn of(self, file: &Path) -> CacheError {
        CacheError { file: file.to_owned(), fault: self }
    }

    pub(super) fn damaged(place: impl Into<String>, what: impl Into<String>) -> Fault {
        Fault::Damaged { place: place.into(), what: what.into() }
    }

    pub(super) fn stale(what: impl Into<String>) -> Fault {
        Fault::Stale { what: what.into() }
    }
}

impl From<std::io::Error> for Fault {
    fn from(error: std::io::Error) -> Fault {
        match error.kind() {
            std::io::ErrorKind::NotFound => Fault::Absent,
            std::io::ErrorKind::UnexpectedEof => Fault::damaged("the end", "the file was cut"),
            _ => Fault::Io { cause: error.to_string() },
        }
    }
}

impl From<TraceError> for Fault {
    fn from(error: TraceError) -> Fault {
        Fault::Stopped(error)
    }
}

impl From<Cancelled> for Fault {
    fn from(_: Cancelled) -> Fault {
        Fault::Stopped(TraceError::Cancelled)
    }
}

impl CacheError {
    /// What is wrong, one line without the file's name.
    pub fn cause(&self) -> String {
        match &self.fault {
            Fault::Absent => "there is no such file".into(),
            Fault::Foreign => "this is no cache of Rayforest".into(),
            Fault::Stale { what } => format!("it was made from something else: {what}"),
            Fault::Damaged { place, what } => format!("it is damaged: {place}: {what}"),
            Fault::Memory { budget } => format!(
                "what it holds does not fit into the memory budget of {:.2} GiB",
                *budget as f64 / f64::from(1 << 30)
            ),
            Fault::Io { cause } => cause.clone(),
            Fault::Stopped(error) => error.to_string(),
        }
    }

    /// What a person can do about it, one line.
    pub fn way_out(&self) -> &'static str {
        match &self.fault {
            Fault::Absent => "open the scene without it and keep the traced picture",
            Fault::Foreign => {
                "the scene is traced afresh, the file is left alone; move it away to keep a cache here"
            }
            Fault::Stale { .. } => "the scene is traced afresh; keep the traced picture again",
            Fault::Damaged { .. } => {
                "the scene is traced afresh; keep the traced picture again, or delete the file"
            }
            Fault::Memory { .. } => "raise the budget, or lower picture.size",
            Fault::Io { .. } => "check the file's permissions and the room on its disc",
            Fault::Stopped(_) => "open the scene again",
        }
    }
}

impl fmt::Display for CacheError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}\n  help: {}", self.file.display(), self.cause(), self.way_out())
    }
}

impl std::error::Error for CacheError {}
