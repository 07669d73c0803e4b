//! Example scenes in the window: opened as copies, traced once, and from then on without a ray.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::SystemTime;

use super::app::App;
use super::keep::kept_text;
use crate::document::Document;
use crate::document::examples::{EXAMPLES, Example, folder};
use crate::scene::Scene;
use crate::session::cache::ENDING;

/// What would take more than this is traced every time.
const MOST_BYTES: u64 = 256 << 20;
/// All that is kept of examples together; the oldest goes first.
const BUDGET: u64 = 1 << 30;

/// The example that the document is a copy of.
pub(super) struct Copied {
    /// Where what is traced of it is kept.
    kept: PathBuf,
    /// As it was opened.
    scene: Arc<Scene>,
    /// Whether nothing remains to be kept.
    is_settled: bool,
}

impl Copied {
    fn of(example: &Example, document: &Document, cache: &Path) -> Copied {
        let kept = folder(cache).join(example.name).with_extension(ENDING);
        Copied { kept, scene: document.shared_scene(), is_settled: false }
    }
}

impl App {
    /// Shows a copy of an example.
    pub(super) fn show_example(&mut self, number: usize, document: Document) {
        self.put_document(document);
        self.show_copied(number);
    }

    /// Shows the document, which is an unchanged copy of an example, by what was kept of it.
    pub(super) fn show_copied(&mut self, number: usize) {
        let copied = Copied::of(&EXAMPLES[number], &self.document, &self.files.folders.cache);
        self.live.want_kept(copied.scene.clone(), copied.kept.clone());
        self.copied = Some(copied);
        self.files.touched();
    }

    /// Keeps what was traced of an example, once its picture is exact and if it was not opened from
    /// what is kept.
    pub(super) fn keep_example(&mut self) {
        let Some(copied) = self.copied.as_mut().filter(|copied| !copied.is_settled) else { return };
        let status = self.live.status();
        if !status.in_step || !Arc::ptr_eq(&copied.scene, &self.document.shared_scene()) {
            return;
        }
        copied.is_settled = true;
        if status.opened {
            // The most recently used are kept longest. One of another program's making stays as it is.
            let file = std::fs::File::options().append(true).open(&copied.kept);
            let _ = file.and_then(|file| file.set_modified(SystemTime::now()));
        } else if status.matrix_bytes <= MOST_BYTES {
            match std::fs::create_dir_all(copied.kept.parent().unwrap_or(Path::new(""))) {
                Ok(()) => self.live.keep(copied.kept.clone()),
                Err(error) => log::warn!("{}: {error}", copied.kept.display()),
            }
        }
    }

    /// What was traced is kept; of an example nobody asked for it, and nothing is said.
    pub(super) fn kept(&mut self, path: &Path, bytes: u64) {
        if !self.is_of_example(&path.display().to_string()) {
            return self.notices.say(kept_text(path, bytes));
        }
        log::info!("{}", kept_text(path, bytes));
        let cache = self.files.folders.cache.join("examples");
        std::thread::spawn(move || prune(&cache, BUDGET));
    }

    /// Something failed in the session; what is kept of an example is done without.
    pub(super) fn failed(&mut self, message: String) {
        match self.is_of_example(&message) {
            true => log::warn!("{message}"),
            false => self.notices.error(message),
        }
    }

    /// Whether a text names what is kept of an example, of the one shown or of another.
    fn is_of_example(&self, text: &str) -> bool {
        text.contains(&folder(&self.files.folders.cache).display().to_string())
    }
}

/// Deletes the oldest kept files below a folder until the others are within a budget of bytes.
fn prune(folder: &Path, budget: u64) {
    let mut files = Vec::new();
    gather(folder, &mut files);
    files.sort_by_key(|(modified, ..)| std::cmp::Reverse(*modified));
    let mut total = 0;
    for (_, bytes, path) in files {
        total += bytes;
        if total > budget && std::fs::remove_file(&path).is_ok() {
            total -= bytes;
        }
    }
}

/// Kept files in a folder and the folders in it.
fn gather(folder: &Path, files: &mut Vec<(SystemTime, u64, PathBuf)>) {
    for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        let (path, Ok(data)) = (entry.path(), entry.metadata()) else { continue };
        if data.is_dir() {
            gather(&path, files);
        } else if path.extension().is_some_and(|ending| ending == ENDING)
            && let Ok(modified) = data.modified()
        {
            files.push((modified, data.len(), path));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    #[test]
    fn the_oldest_go_until_the_rest_is_within_the_budget() {
        let folder = tempfile::tempdir().unwrap();
        let make = |name: &str, bytes: usize, age: u64| {
            let path = folder.path().join(name);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(&path, vec![0; bytes]).unwrap();
            let file = std::fs::File::options().append(true).open(&path).unwrap();
            file.set_modified(SystemTime::now() - Duration::from_secs(age)).unwrap();
            path
        };
        let new = make("2/new.rayforest-cache", 400, 1);
        let middle = make("2/middle.rayforest-cache", 500, 20);
        let old = make("1/old.rayforest-cache", 300, 30);
        let other = make("1/old.png", 3000, 99);
        prune(folder.path(), 1200);
        assert!([&new, &middle, &old, &other].iter().all(|path| path.exists()));
        prune(folder.path(), 1000);
        assert!(!old.exists() && [&new, &middle, &other].iter().all(|path| path.exists()));
        prune(folder.path(), 450);
        assert!(new.exists() && !middle.exists() && other.exists());
        prune(&folder.path().join("none"), 0);
    }
}
