//! Thumbnails of recent files, kept in the cache folder.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use eframe::egui::{ColorImage, Context, TextureHandle, TextureOptions};
use twox_hash::XxHash3_64;

use super::app::App;
use crate::film::Frame;
use crate::film::sheet::reduced;
use crate::film::write;
use crate::scene::Scene;
use crate::session::live::Stage;

/// Largest thumbnail, in pixels.
pub(super) const THUMB: [u32; 2] = [192, 108];

/// The file whose thumbnail is up to date, and the scene that it shows.
pub(super) type Noted = (PathBuf, Arc<Scene>);

/// Where the thumbnail of a scene file is.
pub(super) fn thumb_of(cache: &Path, file: &Path) -> PathBuf {
    let name = XxHash3_64::oneshot(file.as_os_str().as_encoded_bytes());
    cache.join("thumbnails").join(format!("{name:016x}.png"))
}

/// A picture file on the graphics card; `None` if it is none.
pub(super) fn texture(ctx: &Context, name: &str, png: &[u8]) -> Option<TextureHandle> {
    let icon = eframe::icon_data::from_png_bytes(png).ok()?;
    let size = [icon.width as usize, icon.height as usize];
    let image = ColorImage::from_rgba_unmultiplied(size, &icon.rgba);
    Some(ctx.load_texture(name, image, TextureOptions::LINEAR))
}

impl App {
    /// Keeps the thumbnail of the document's file, once its picture is exact and saved.
    pub(super) fn note_thumb(&mut self) {
        let (Some(path), Some(shown)) = (self.document.path(), &self.shown) else { return };
        let saved = self.document.shared_saved_scene();
        let is_noted = |(noted, scene): &Noted| noted == path && Arc::ptr_eq(scene, &saved);
        if self.document.is_unsaved()
            || self.noted_thumb.as_ref().is_some_and(is_noted)
            || shown.stage != Stage::Whole
            || !self.live.status().in_step
            || *shown.scene != *saved
        {
            return;
        }
        let Some(frame) = shown.frame.clone() else { return };
        let cache = self.files.folders.cache.clone();
        let mut wanted = vec![thumb_of(&cache, path)];
        self.noted_thumb = Some((path.to_owned(), saved));
        wanted.extend(self.settings.recent.iter().map(|file| thumb_of(&cache, file)));
        std::thread::spawn(move || keep(&frame, &wanted));
    }
}

/// Writes a thumbnail as the first of the `wanted` files, and removes those that are not wanted. A cache
/// that cannot be written is done without.
fn keep(frame: &Frame, wanted: &[PathBuf]) {
    let [width, height] = frame.size;
    let small = reduced(frame, width.div_ceil(THUMB[0]).max(height.div_ceil(THUMB[1])));
    let Some((file, folder)) = wanted.first().and_then(|file| Some((file, file.parent()?))) else {
        return;
    };
    let written = std::fs::create_dir_all(folder).map_err(|error| error.to_string());
    let written = written.and_then(|()| write::frame(file, &small).map_err(|e| e.to_string()));
    if let Err(error) = written {
        log::warn!("no thumbnail is kept: {error}");
    }
    for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        let path = entry.path();
        if path.extension().is_some_and(|ending| ending == "png") && !wanted.contains(&path) {
            let _ = std::fs::remove_file(path);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thumbnails_of_files_that_are_not_recent_any_more_go() {
        let cache = tempfile::tempdir().unwrap();
        let [a, b] = ["/x/a.toml", "/x/b.toml"].map(|file| thumb_of(cache.path(), Path::new(file)));
        assert_ne!(a, b);
        keep(&Frame::new([400, 100]), std::slice::from_ref(&a));
        let icon = eframe::icon_data::from_png_bytes(&std::fs::read(&a).unwrap()).unwrap();
        assert_eq!([icon.width, icon.height], [134, 34]);
        keep(&Frame::new([4, 4]), &[b.clone(), a.clone()]);
        assert!(a.exists() && b.exists());
        keep(&Frame::new([4, 4]), std::slice::from_ref(&b));
        assert!(!a.exists() && b.exists());
    }
}
