//! The example scenes, which are part of the program: texts, the files that they name, and thumbnails.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::history::History;
use super::open::named_absolutely;
use super::{Document, DocumentError, folder_of};
use crate::film::write::atomically;
use crate::scene::read;
use crate::scene::relative::{relative, resolved};

/// A scene to look at and to change.
#[derive(Debug)]
pub struct Example {
    /// Name of its file in `scenes/`, without the ending.
    pub name: &'static str,
    /// What people call it.
    pub title: &'static str,
    /// What it shows, one sentence.
    pub about: &'static str,
    /// Its text.
    pub text: &'static str,
    /// Its picture, small, as PNG.
    pub thumbnail: &'static [u8],
}

macro_rules! example {
    ($name:literal, $title:literal, $about:literal) => {
        Example {
            name: $name,
            title: $title,
            about: $about,
            text: include_str!(concat!("../../scenes/", $name, ".toml")),
            thumbnail: include_bytes!(concat!("../../assets/examples/", $name, ".png")),
        }
    };
}

/// All of them; the first is what a window shows that nobody gave a scene.
pub const EXAMPLES: &[Example] = &[
    example!("whitted", "Whitted's spheres", "Glass and mirror above a checkered floor"),
    example!("still_life", "Still life", "A table laid for one, by a window on the left"),
    example!("glass", "Coloured glass", "Twelve coloured glasses, one inside another, two lamps"),
    example!("studio", "Studio", "Soft light, a spot, blurred mirrors and frosted ice"),
    example!("gallery", "Gallery", "Marble, wood, gradients, images and bumps at evening"),
    example!("chain", "Chain", "Twenty linked rings of gold, copper, steel and glass"),
    example!("gears", "Gears", "Glass gears of 144 corners each, on steel axles"),
    example!("csg_part", "Machined part", "A hub, bored, slotted and drilled: one solid of 26"),
    example!("mesh", "Knot", "A polished knot of 80 000 triangles"),
    example!("flake", "Sphereflake", "7381 mirror spheres under three lamps"),
    example!("motion", "Motion", "What moves while the shutter is open, through a lens"),
    example!("mirrors", "Two mirrors", "Two mirrors face to face, forty reflections deep"),
    example!("gems", "Gems", "Forty glass spheres, each of its own colour"),
    example!("plain", "Three matte solids", "The case with the least to gain"),
];

/// The files that examples name, by their places beside the folder of the scenes.
const FILES: [(&str, &[u8]); 2] = [
    ("assets/globe.png", include_bytes!("../../assets/globe.png")),
    ("assets/dunes.jpg", include_bytes!("../../assets/dunes.jpg")),
];

/// Where a cache folder has the examples of this version.
pub fn folder(cache: &Path) -> PathBuf {
    cache.join("examples").join(env!("CARGO_PKG_VERSION"))
}

impl Example {
    /// Opens it as a document without a file: saving asks where to. The files that it names are written to
    /// the cache folder first, if they are not there.
    pub fn open(&self, cache: &Path) -> Result<Document, DocumentError> {
        let root = folder(cache);
        let place = root.join("scenes").join(self.name).with_extension("toml");
        for (name, bytes) in FILES.iter().filter(|(name, _)| self.text.contains(name)) {
            write_if_other(&root.join(name), bytes)?;
            // The way from the scene to its files leads through its folder.
            std::fs::create_dir_all(folder_of(&place)).map_err(DocumentError::new)?;
        }
        let scene = read::text(self.text, &place).map_err(DocumentError::new)?;
        let mut document = Document::of(self.title, self.text, scene);
        let mut copy = document.scene().clone();
        named_absolutely(&mut copy, folder_of(&place));
        document.saved = Arc::new(copy.clone());
        document.history = History::new(copy);
        document.refresh();
        Ok(document)
    }
}

impl Document {
    /// Copies the files that the cache folder holds for an example to beside the scene file that the
    /// document is to be saved as, into `NAME-parts`, and names them there: a cache may be emptied. A
    /// document that is no copy of an example is left alone.
    pub fn take_along(&mut self, cache: &Path, target: &Path) -> Result<(), DocumentError> {
        let root = resolved(&folder(cache));
        let mut name = target.file_stem().unwrap_or_default().to_owned();
        name.push("-parts");
        let parts = target.with_file_name(name);
        let mut moved = Vec::new();
        let mut scene = self.scene().clone();
        scene.each_file(&mut |file| {
            if Path::new(&*file).starts_with(&root) && moved.iter().all(|(old, _)| old != file) {
                moved.push((
                    file.clone(),
                    parts.join(Path::new(&*file).file_name().unwrap_or_default()),
                ));
            }
        });
        for (old, new) in &moved {
            let bytes =
                std::fs::read(old).map_err(|e| DocumentError::new(format!("{old}: {e}")))?;
            write_if_other(new, &bytes)?;
        }
        let own_folder = self.folder();
        let mut edit = |scene: &mut crate::scene::Scene| {
            scene.each_file(&mut |file| {
                if let Some((_, new)) = moved.iter().find(|(old, _)| old == file)
                    && let Some(name) = relative(new, &own_folder)
                {
                    *file = name;
                }
            });
        };
        self.history.edit_all(&mut edit);
        edit(Arc::make_mut(&mut self.saved));
        self.refresh();
        Ok(())
    }
}

/// Writes a file, and its folder, unless it is there.
fn write_if_other(path: &Path, bytes: &[u8]) -> Result<(), DocumentError> {
    if std::fs::read(path).is_ok_and(|there| there == bytes) {
        return Ok(());
    }
    let failed = |cause: &dyn std::fmt::Display| {
        DocumentError::new(format!("cannot write {}: {cause}", path.display()))
    };
    std::fs::create_dir_all(folder_of(path)).map_err(|error| failed(&error))?;
    let written = atomically(path, |out| out.write_all(bytes).map_err(|e| e.to_string()));
    written.map_err(|error| failed(&error))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_shipped_scene_is_an_example_and_opens_unchanged() {
        let shipped = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
        let files = std::fs::read_dir(&shipped).unwrap().map(|file| file.unwrap().path());
        let mut names: Vec<String> = files
            .filter(|file| file.extension().is_some_and(|e| e == "toml"))
            .map(|file| file.file_stem().unwrap().to_string_lossy().into_owned())
            .collect();
        names.sort();
        let mut ours: Vec<&str> = EXAMPLES.iter().map(|example| example.name).collect();
        ours.sort_unstable();
        assert_eq!(ours, names);
        assert_eq!((EXAMPLES[0].title, EXAMPLES[0].text), super::super::BUILT_IN);
        let cache = tempfile::tempdir().unwrap();
        for example in EXAMPLES {
            let document = example.open(cache.path()).unwrap();
            assert!(!document.is_unsaved() && document.path().is_none(), "{}", example.name);
            let shipped =
                Document::open(&shipped.join(example.name).with_extension("toml")).unwrap();
            let plain = |document: &Document| {
                let mut scene = document.scene().clone();
                scene.each_file(&mut |file| file.clear());
                scene
            };
            assert!(plain(&document) == plain(&shipped), "{}", example.name);
        }
    }

    #[test]
    fn a_saved_example_needs_no_cache() {
        let [cache, folder] = [(); 2].map(|()| tempfile::tempdir().unwrap());
        let gallery = EXAMPLES.iter().find(|example| example.name == "gallery").unwrap();
        let mut document = gallery.open(cache.path()).unwrap();
        let target = folder.path().join("mine.toml");
        document.take_along(cache.path(), &target).unwrap();
        assert!(!document.is_unsaved(), "other names are no edit");
        let save = document.save(&target).unwrap();
        save.write().unwrap();
        document.saved(save);
        assert!(!document.is_unsaved());
        drop(cache);
        let text = std::fs::read_to_string(&target).unwrap();
        assert!(text.contains("\"mine-parts/globe.png\""), "{text}");
        let opened = Document::open(&target).unwrap();
        assert!(opened.scene() == document.scene());
        // Once it has a file, nothing is taken along.
        let before = document.scene().clone();
        document.take_along(folder.path(), &folder.path().join("other.toml")).unwrap();
        assert!(*document.scene() == before);
    }
}
