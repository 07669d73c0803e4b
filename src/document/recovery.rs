//! Keeps unsaved work in a folder of its own until it is saved, and finds it after a crash.

use std::fs::File;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{SystemTime, UNIX_EPOCH};

use serde_json::{Value, json};

use super::history::History;
use super::open::{known, replaced, replacements, with_missing};
use super::patch::patch;
use super::{Base, Document, DocumentError, folder_of};
use crate::film::write::durably;
use crate::scene::{Scene, read};

/// The only version of the recovery files.
const VERSION: u64 = 1;
/// How the names of recovery files begin and end.
const PREFIX: &str = "unsaved-";
const ENDING: &str = "json";

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
    /// Held so that a third run does not find the work too; let go with the last clone.
    _lock: Arc<File>,
}

/// The place where this run keeps its unsaved work. Locked while the run lives, so that another run
/// does not take it for lost; removed when there is nothing unsaved.
pub struct Recovery {
    file: PathBuf,
    damaged: Vec<PathBuf>,
    gate: Arc<Mutex<Gate>>,
    /// The system lets go of it however the run ends.
    _lock: File,
}

/// What keeps a late snapshot from replacing a later one, or from coming back after all was saved.
#[derive(Debug, Default)]
struct Gate {
    /// Number of the latest snapshot taken.
    taken: u64,
    /// Snapshots up to this number are out of date.
    done: u64,
}

impl Recovery {
    /// A place in `folder`, which is made if it is missing, and the work of dead runs found there,
    /// the latest first. Files that cannot be read are set aside: [`Recovery::damaged`].
    pub fn start(folder: &Path) -> Result<(Recovery, Vec<Found>), DocumentError> {
        let failed = |error: std::io::Error| {
            let folder = folder.display();
            DocumentError::new(format!(
                "unsaved work cannot be kept in {folder}: {error}\n  help: save often"
            ))
        };
        std::fs::create_dir_all(folder).map_err(failed)?;
        // one run at a time looks around, so that none takes another's new place for an old one
        let start = open_lock(&folder.join("start.lock")).map_err(failed)?;
        start.lock().map_err(failed)?;
        let (found, damaged) = search(folder).map_err(failed)?;
        let (file, lock) = new_place(folder).map_err(failed)?;
        let gate = Arc::new(Mutex::new(Gate::default()));
        Ok((Recovery { file, damaged, gate, _lock: lock }, found))
    }

    /// Files of the folder that could not be read at the start: set aside as `NAME.bad`, not removed.
    pub fn damaged(&self) -> &[PathBuf] {
        &self.damaged
    }

    /// What to keep of a document: plain data, for any thread.
    pub fn snapshot(&self, document: &Document) -> Snapshot {
        let mut gate = self.gate.lock().unwrap_or_else(PoisonError::into_inner);
        gate.taken += 1;
        Snapshot {
            file: self.file.clone(),
            number: gate.taken,
            gate: Arc::clone(&self.gate),
            title: document.title(),
            original: document.path.clone(),
            base: document.base.clone(),
            disk: document.disk.clone(),
            scene: Arc::clone(document.history.scene()),
        }
    }

    /// There is nothing unsaved any more. Snapshots not yet written never will be.
    pub fn clear(&self) {
        let mut gate = self.gate.lock().unwrap_or_else(PoisonError::into_inner);
        gate.done = gate.taken;
        // it may never have been written
        let _ = std::fs::remove_file(&self.file);
    }
}

impl Drop for Recovery {
    fn drop(&mut self) {
        let _ = std::fs::remove_file(lock_of(&self.file));
    }
}

/// Unsaved work on its way to the recovery folder.
pub struct Snapshot {
    file: PathBuf,
    number: u64,
    gate: Arc<Mutex<Gate>>,
    title: String,
    original: Option<PathBuf>,
    base: Base,
    disk: Option<Arc<str>>,
    scene: Arc<Scene>,
}

impl Snapshot {
    /// Writes it, whole or not at all; nothing if it is out of date.
    pub fn write(&self) -> Result<(), DocumentError> {
        let Base { text, scene } = &self.base;
        let original = self.original.as_deref();
        // mesh and image files are named absolutely, so that the work stands for itself
        let mut absolute = (*self.scene).clone();
        let folder = original.map_or(Path::new("."), folder_of);
        let names = make_absolute(&mut absolute, folder);
        let kept = json!({
            "rayforest": "unsaved work",
            "version": VERSION,
            "title": self.title,
            "original": original.and_then(Path::to_str),
            "kept_unix_secs": now(),
            "scene": patch(text, scene, &absolute).text,
            "mesh_names": names,
            "base": &**text,
            "disk": self.disk.as_deref(),
        });
        let mut gate = self.gate.lock().unwrap_or_else(PoisonError::into_inner);
        if self.number <= gate.done {
            return Ok(());
        }
        durably(&self.file, None, kept.to_string().as_bytes()).map_err(|error| {
            DocumentError::new(format!("unsaved work is not kept: {error}\n  help: save it"))
        })?;
        gate.done = self.number;
        Ok(())
    }
}

/// Names the mesh and image files of a scene absolutely; returns the names they had, by their new ones.
fn make_absolute(scene: &mut Scene, folder: &Path) -> serde_json::Map<String, Value> {
    let mut names = serde_json::Map::new();
    scene.each_file(&mut |file| {
        let place = crate::scene::relative::resolved(&folder.join(&*file));
        if let Some(place) = place.to_str() {
            let old = std::mem::replace(file, place.to_owned());
            names.insert(place.to_owned(), Value::from(old));
        }
    });
    names
}

impl Found {
    /// Opens the work: unsaved, and belonging to its original file. Its own file stays until
    /// [`Found::discard`].
    pub fn open(&self) -> Result<Document, DocumentError> {
        self.open_relocated(&[])
    }

    /// [`Found::open`] with mesh files that were found elsewhere, by their missing names.
    pub fn open_relocated(&self, found: &[(String, PathBuf)]) -> Result<Document, DocumentError> {
        let unreadable = || {
            let file = self.file.display();
            DocumentError::new(format!("{file} does not hold unsaved work\n  help: it stays there"))
        };
        let kept = contents(&self.file).ok_or_else(unreadable)?;
        let text = kept["scene"].as_str().ok_or_else(unreadable)?;
        let folder = self.original.as_deref().map_or(Path::new("."), folder_of);
        let found = replacements(text, folder, found);
        let scene = read::text_with(text, &self.file, known(text, &found)?)
            .map_err(|error| with_missing(error.to_string(), text, folder, &found))?;
        let mut edited = replaced(&scene, &found, folder);
        rename_files(&mut edited, &kept["mesh_names"]);
        let mut document = Document::of(&self.title, text, scene);
        document.is_rescued = true;
        if let Some(base) = kept["base"].as_str()
            && let Some(scene) = base_scene(base, folder, &edited)
        {
            document.is_rescued = false;
            document.saved = Arc::clone(&scene);
            document.base = Base { text: base.into(), scene };
        }
        document.path.clone_from(&self.original);
        document.disk = kept["disk"].as_str().map(Arc::from);
        document.history = History::new(edited);
        document.refresh();
        Ok(document)
    }

    /// Removes the work.
    pub fn discard(self) {
        // a file that somebody else removed is gone all the same
        let _ = std::fs::remove_file(&self.file);
        let _ = std::fs::remove_file(lock_of(&self.file));
    }
}

/// The scene of the text that was opened, if it can still be read; meshes and images that the work holds too
/// are not read again.
fn base_scene(text: &str, folder: &Path, edited: &Scene) -> Option<Arc<Scene>> {
    let known = read::Known::of(edited);
    read::text_with(text, &folder.join("scene.toml"), known).ok().map(Arc::new)
}

/// Gives mesh and image files the names back that they had in the scene.
fn rename_files(scene: &mut Scene, names: &Value) {
    scene.each_file(&mut |file| {
        if let Some(name) = names[&*file].as_str() {
            *file = name.to_owned();
        }
    });
}

/// What a recovery file holds; `None` if it is damaged.
fn contents(file: &Path) -> Option<Value> {
    let bytes = std::fs::read(file).ok()?;
    let value: Value = serde_json::from_slice(&bytes).ok()?;
    (value["version"] == VERSION && value["scene"].is_string()).then_some(value)
}

/// The work of dead runs, and damaged files, which are set aside.
fn search(folder: &Path) -> std::io::Result<(Vec<Found>, Vec<PathBuf>)> {
    let (mut found, mut damaged) = (Vec::new(), Vec::new());
    for entry in std::fs::read_dir(folder)? {
        let file = entry?.path();
        let name = file.file_name().unwrap_or_default().to_string_lossy();
        let is_ours = name.starts_with(PREFIX);
        let ending = file.extension().unwrap_or_default();
        let is_work = ending == ENDING;
        if !is_ours || !(is_work || ending == "lock") {
            continue;
        }
        let lock = open_lock(&lock_of(&file))?;
        if lock.try_lock().is_err() {
            continue;
        }
        if !is_work {
            if !file.with_extension(ENDING).exists() {
                let _ = std::fs::remove_file(&file);
            }
            continue;
        }
        let Some(kept) = contents(&file) else {
            damaged.push(set_aside(&file)?);
            let _ = std::fs::remove_file(lock_of(&file));
            continue;
        };
        found.push(Found {
            original: kept["original"].as_str().map(PathBuf::from),
            title: kept["title"].as_str().unwrap_or("untitled").to_owned(),
            age_secs: now().saturating_sub(kept["kept_unix_secs"].as_u64().unwrap_or(0)),
            file,
            _lock: Arc::new(lock),
        });
    }
    found.sort_by_key(|found| found.age_secs);
    Ok((found, damaged))
}

/// Renames a file to `NAME.bad`, or to the first such name with a number that is free.
pub(super) fn set_aside(file: &Path) -> std::io::Result<PathBuf> {
    let mut number = 1;
    loop {
        let mut name = file.file_name().unwrap_or_default().to_owned();
        name.push(if number == 1 { ".bad".to_owned() } else { format!(".bad{number}") });
        let aside = file.with_file_name(name);
        if !aside.exists() {
            return std::fs::rename(file, &aside).map(|()| aside);
        }
        number += 1;
    }
}

/// A free name for this run's work, and its lock, taken.
fn new_place(folder: &Path) -> std::io::Result<(PathBuf, File)> {
    for number in 1.. {
        let name = format!("{PREFIX}{}-{number}.{ENDING}", std::process::id());
        let file = folder.join(name);
        let mut options = File::options();
        match options.write(true).create_new(true).open(lock_of(&file)) {
            Ok(lock) if !file.exists() => return lock.lock().map(|()| (file, lock)),
            Ok(_) => {}
            Err(error) if error.kind() == ErrorKind::AlreadyExists => {}
            Err(error) => return Err(error),
        }
    }
    Err(ErrorKind::AlreadyExists.into())
}

fn lock_of(file: &Path) -> PathBuf {
    file.with_extension("lock")
}

fn open_lock(path: &Path) -> std::io::Result<File> {
    File::options().write(true).create(true).truncate(false).open(path)
}

fn now() -> u64 {
    SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_secs())
}
