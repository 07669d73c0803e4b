//! Text on its way to a file: written whole or not at all, with the file before it kept.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::DocumentError;
use crate::film::write::durably;
use crate::scene::Scene;

/// Text on its way to a file: plain data, written by any thread.
#[derive(Clone, Debug)]
pub struct Save {
    /// The file.
    pub path: PathBuf,
    /// What it will hold.
    pub text: String,
    /// The text could not be edited in place and was written anew: comments are lost. (No text is
    /// known for which this happens, other than things moved that stand in several pieces.)
    pub comments_lost: bool,
    /// Whether the file is replaced even if another program changed it since it was opened.
    pub overwrite: bool,
    /// The scene that `text` describes.
    pub(super) scene: Arc<Scene>,
    /// What the file should hold before; `None` if that does not matter.
    pub(super) expected: Option<Arc<str>>,
}

impl Save {
    /// Writes the file, whole or not at all; the file before it becomes `NAME~`. A link is followed,
    /// permissions stay.
    pub fn write(&self) -> Result<(), DocumentError> {
        let shown = self.path.display();
        let target = followed(&self.path);
        let earlier = match std::fs::read(&target) {
            Ok(bytes) => bytes,
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => {
                let written = durably(&target, None, self.text.as_bytes());
                return written.map_err(|error| failed(&error.to_string()));
            }
            Err(error) => return Err(failed(&format!("cannot write {shown}: {error}"))),
        };
        if earlier == self.text.as_bytes() {
            return Ok(());
        }
        let changed = self.expected.as_ref().is_some_and(|text| text.as_bytes() != earlier);
        if changed && !self.overwrite {
            let message = format!(
                "{shown} was changed by another program since it was opened\n  help: save under \
                 another name, or overwrite it (the other version is kept as {}~)",
                file_name(&self.path)
            );
            return Err(DocumentError { changed_on_disk: true, ..DocumentError::new(message) });
        }
        let permissions = std::fs::metadata(&target)
            .map_err(|error| failed(&format!("cannot write {shown}: {error}")))?
            .permissions();
        if permissions.readonly() {
            return Err(failed(&format!("cannot write {shown}: the file is read-only")));
        }
        let backup = backup(&target);
        durably(&backup, Some(permissions.clone()), &earlier).map_err(|error| {
            failed(&format!("{shown} is not saved, for its backup failed: {error}"))
        })?;
        durably(&target, Some(permissions), self.text.as_bytes())
            .map_err(|error| failed(&error.to_string()))
    }
}

fn failed(cause: &str) -> DocumentError {
    DocumentError::new(format!("{cause}\n  help: save in another place"))
}

/// `NAME~` beside a file.
fn backup(path: &Path) -> PathBuf {
    let mut name = OsString::from(path.file_name().unwrap_or_default());
    name.push("~");
    path.with_file_name(name)
}

/// The file that a chain of links leads to, whether or not it exists.
fn followed(path: &Path) -> PathBuf {
    const MOST_LINKS: usize = 40;
    let mut path = path.to_owned();
    for _ in 0..MOST_LINKS {
        match std::fs::read_link(&path) {
            Ok(next) => path = path.parent().unwrap_or(Path::new("")).join(next),
            Err(_) => break,
        }
    }
    path
}

pub(super) fn file_name(path: &Path) -> String {
    path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned()
}
