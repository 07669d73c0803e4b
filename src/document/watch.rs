//! Notices that another program changed the files of a document: its scene, its meshes, its images.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::SystemTime;

use super::{Document, DocumentError, FileKind};
use crate::scene::read::Known;
use crate::scene::{mesh, texture};

/// The files of a document, and what the program knows them to hold.
#[derive(Clone, Debug, Default)]
pub struct Watched {
    /// The scene's file and its text; `None` for a document without a file.
    scene: Option<(PathBuf, Arc<str>)>,
    /// Name in the scene, kind and place of each mesh and image file.
    parts: Vec<(String, FileKind, PathBuf)>,
    /// What they held when they were read.
    known: Known,
}

/// What another program did.
pub enum OnDisk {
    /// It wrote the scene's file: what is there now, or why that cannot be read.
    Scene(PathBuf, Box<Result<Document, DocumentError>>),
    /// It moved the scene's file away.
    Gone(PathBuf),
    /// The scene's file, which was gone or another one, holds again what it held.
    Back(PathBuf),
    /// It wrote meshes and images: what they hold now, by their names in the scene.
    Parts(Known),
    /// It wrote a mesh or an image that cannot be read: why.
    BadPart(String),
}

/// When a file was changed last, and its length; `None` where there is none.
type Stamp = Option<(SystemTime, u64)>;

/// Looks at files again and again. A change counts once a file stays the same from one look to the
/// next: who writes it has then come to an end.
#[derive(Default)]
pub struct Watch {
    watched: Watched,
    files: Vec<File>,
    /// The scene's file was told to be gone or another one.
    is_other: bool,
}

struct File {
    path: PathBuf,
    /// What it was like when its content was known last; `None` before the first look.
    known: Option<Stamp>,
    /// What it was like at the latest look, if it was different then.
    changing: Option<Stamp>,
}

impl File {
    /// Looks at it; whether it holds something else that is whole.
    fn look(&mut self) -> bool {
        let now = stamp(&self.path);
        if self.known == Some(now) {
            self.changing = None;
            return false;
        }
        let rests = self.known.is_none() || self.changing == Some(now);
        self.changing = (!rests).then_some(now);
        if rests {
            self.known = Some(now);
        }
        rests
    }
}

fn stamp(path: &Path) -> Stamp {
    let data = std::fs::metadata(path).ok()?;
    Some((data.modified().ok()?, data.len()))
}

impl Document {
    /// Its files, for a [`Watch`].
    pub fn watched(&self) -> Watched {
        let scene = self.path.clone().zip(self.disk.clone());
        let known = Known::of(self.scene());
        let folder = self.folder();
        let part = |name: &String, kind| (name.clone(), kind, folder.join(name));
        let meshes = known.meshes.keys().map(|name| part(name, FileKind::Mesh));
        let images = known.images.keys().map(|name| part(name, FileKind::Image));
        Watched { scene, parts: meshes.chain(images).collect(), known }
    }

    /// Whether `other` was read from the same text as this document was read from or saved as.
    pub fn is_of_same_text(&self, other: &Document) -> bool {
        self.disk.is_some() && self.disk == other.disk
    }

    /// Takes what another program wrote to the file: one step, so that undo brings back what was here
    /// before, with its edits.
    pub fn load_theirs(&mut self, theirs: Document) {
        let name = format!("load {} from disk", self.title());
        let Document {
            name: _,
            path: _,
            home: _,
            base,
            saved,
            disk,
            history,
            is_rescued,
            is_gone,
            is_unsaved: _,
        } = theirs;
        self.history.end_gesture();
        self.history.change((**history.scene()).clone());
        self.history.name_step(name);
        self.history.end_gesture();
        (self.base, self.saved, self.disk, self.is_rescued) = (base, saved, disk, is_rescued);
        self.is_gone = is_gone;
        self.refresh();
    }

    /// Takes what mesh and image files hold now. It is no step and leaves nothing unsaved: scenes name
    /// these files, and do not hold them.
    pub fn load_parts(&mut self, known: &Known) {
        self.history.edit_all(&mut |scene| known.put(scene));
        known.put(Arc::make_mut(&mut self.saved));
        known.put(Arc::make_mut(&mut self.base.scene));
        self.refresh();
    }
}

impl Watch {
    /// Watches these files from now on. What is known of those that were watched before stays known.
    pub fn follow(&mut self, watched: Watched) {
        let Watched { scene, parts, known: _ } = &watched;
        let is_same_text = *scene == self.watched.scene;
        self.is_other &= is_same_text;
        let mut before = std::mem::take(&mut self.files);
        let mut file = |path: &Path, is_known: bool, first: Option<Stamp>| {
            let at = before.iter().position(|file| is_known && file.path == path);
            let fresh = || File { path: path.to_owned(), known: first, changing: None };
            at.map_or_else(fresh, |at| before.swap_remove(at))
        };
        // The text of a scene is known: the first look compares it. Parts were read just now.
        let of_scene = scene.iter().map(|(path, _)| (path, is_same_text, None));
        let of_parts = parts.iter().map(|(_, _, path)| (path, true, Some(stamp(path))));
        self.files = of_scene
            .chain(of_parts)
            .map(|(path, is_known, first)| file(path, is_known, first))
            .collect();
        self.watched = watched;
    }

    /// What others have done since the last look.
    pub fn look(&mut self) -> Vec<OnDisk> {
        let mut found = Vec::new();
        let (mut fresh, is_saved) = (Known::default(), self.watched.scene.is_some());
        for (i, file) in self.files.iter_mut().enumerate() {
            if !file.look() {
                continue;
            }
            match (i, is_saved) {
                (0, true) => {
                    let change = self.watched.scene_changed(self.is_other);
                    self.is_other = matches!(change, Some(OnDisk::Scene(..) | OnDisk::Gone(_)));
                    found.extend(change);
                }
                _ => {
                    let part = &self.watched.parts[i - usize::from(is_saved)];
                    found.extend(self.watched.known.read_again(part, &mut fresh));
                }
            }
        }
        if !(fresh.meshes.is_empty() && fresh.images.is_empty()) {
            found.push(OnDisk::Parts(fresh.clone()));
            // Known from now on, whether or not they are loaded.
            self.watched.known.meshes.extend(fresh.meshes);
            self.watched.known.images.extend(fresh.images);
        }
        found
    }
}

impl Watched {
    /// What became of the scene's file, if it holds another text, or did when somebody last looked.
    fn scene_changed(&self, was_other: bool) -> Option<OnDisk> {
        let (path, text) = self.scene.as_ref()?;
        match std::fs::read(path) {
            Ok(bytes) if bytes == text.as_bytes() => was_other.then(|| OnDisk::Back(path.clone())),
            Ok(_) => Some(OnDisk::Scene(path.clone(), Box::new(Document::open(path)))),
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => {
                Some(OnDisk::Gone(path.clone()))
            }
            // Somebody who may not read it learns that when it is opened.
            Err(_) => None,
        }
    }
}

impl Known {
    /// Reads a part anew into `fresh`, if it holds something else than is known; an error if that cannot
    /// be read. A part that is not there is not an error: it was read before.
    fn read_again(&self, part: &(String, FileKind, PathBuf), fresh: &mut Known) -> Option<OnDisk> {
        let (name, kind, path) = part;
        if !path.exists() {
            return None;
        }
        let failed = match kind {
            FileKind::Mesh => match mesh::read_obj(path) {
                Ok(mesh) if self.meshes.get(name).is_some_and(|known| **known == mesh) => {
                    return None;
                }
                Ok(mesh) => {
                    fresh.meshes.insert(name.clone(), Arc::new(mesh));
                    return None;
                }
                Err(error) => error.to_string(),
            },
            FileKind::Image => match texture::read(path) {
                Ok(image) if self.images.get(name).is_some_and(|known| **known == image) => {
                    return None;
                }
                Ok(image) => {
                    fresh.images.insert(name.clone(), Arc::new(image));
                    return None;
                }
                Err(error) => error.to_string(),
            },
        };
        Some(OnDisk::BadPart(failed))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SCENE: &str = include_str!("../../scenes/plain.toml");

    /// A document of a file, watched, and the file.
    fn watched(folder: &Path) -> (Document, Watch, PathBuf) {
        let path = folder.join("scene.toml");
        std::fs::write(&path, SCENE).unwrap();
        let document = Document::open(&path).unwrap();
        let mut watch = Watch::default();
        watch.follow(document.watched());
        (document, watch, path)
    }

    /// What two looks find: the first sees a change, the second that it rests.
    fn two_looks(watch: &mut Watch) -> Vec<OnDisk> {
        watch.look().into_iter().chain(watch.look()).collect()
    }

    #[test]
    fn a_change_is_told_once_and_only_if_the_text_is_another() {
        let folder = tempfile::tempdir().unwrap();
        let (_, mut watch, path) = watched(folder.path());
        assert!(two_looks(&mut watch).is_empty());
        // A new time alone is no news.
        std::fs::write(&path, SCENE).unwrap();
        assert!(two_looks(&mut watch).is_empty());
        std::fs::write(&path, format!("{SCENE}# theirs\n")).unwrap();
        assert!(watch.look().is_empty(), "it may still be written");
        let found = watch.look();
        assert!(
            matches!(&found[..], [OnDisk::Scene(file, theirs)] if *file == path && theirs.is_ok())
        );
        assert!(two_looks(&mut watch).is_empty());
        std::fs::remove_file(&path).unwrap();
        assert!(matches!(&two_looks(&mut watch)[..], [OnDisk::Gone(file)] if *file == path));
        assert!(two_looks(&mut watch).is_empty());
    }

    #[test]
    fn a_change_before_the_first_look_is_found() {
        let folder = tempfile::tempdir().unwrap();
        let (mut document, mut watch, path) = watched(folder.path());
        std::fs::write(&path, SCENE.replace("version", "# theirs\nversion")).unwrap();
        let found = watch.look();
        let [OnDisk::Scene(_, theirs)] = &found[..] else { panic!("{} changes", found.len()) };
        assert!(!document.is_of_same_text(theirs.as_ref().as_ref().unwrap()));
        document.load_theirs(Document::open(&path).unwrap());
        assert!(document.is_of_same_text(theirs.as_ref().as_ref().unwrap()));
        // The same file with the text that is known now.
        watch.follow(document.watched());
        assert!(two_looks(&mut watch).is_empty());
    }

    #[test]
    fn their_version_is_a_step_and_saving_goes_on_from_their_text() {
        let folder = tempfile::tempdir().unwrap();
        let (mut document, _, path) = watched(folder.path());
        let mut mine = document.scene().clone();
        mine.materials[0].diffuse = crate::color::Rgb::grey(0.125);
        document.change(mine);
        std::fs::write(&path, format!("# theirs\n{SCENE}")).unwrap();
        document.load_theirs(Document::open(&path).unwrap());
        assert!(!document.is_unsaved() && document.undo());
        assert_eq!(document.scene().materials[0].diffuse, crate::color::Rgb::grey(0.125));
        assert!(document.is_unsaved());
        document.save(&path).unwrap().write().unwrap();
        let saved = std::fs::read_to_string(&path).unwrap();
        assert!(saved.starts_with("# theirs\n") && saved.contains("0.125"), "{saved}");
    }
}
