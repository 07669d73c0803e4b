//! `File → Keep traced`, and openings of what was kept.

use std::path::Path;
use std::sync::Arc;

use super::app::App;
use super::command::Command;
use crate::session::cache;

/// Whether what was traced can be kept now.
pub(super) struct KeepOffer {
    pub(super) possible: bool,
    /// What would be written and how large, or why it cannot be.
    pub(super) about: String,
}

impl App {
    /// What [`Command::Keep`] would do.
    pub(super) fn keep_offer(&self) -> KeepOffer {
        let about = Command::Keep.about();
        let refused = |cause| KeepOffer { possible: false, about: format!("{about}: {cause}") };
        let Some(path) = self.document.path() else {
            return refused("save the scene to a file first");
        };
        let status = self.live.status();
        if !status.in_step {
            return refused("once the picture is exact");
        }
        let file = name(&cache::path_of(path));
        let about = format!("{about}: {file}, at most {}", size(status.matrix_bytes));
        KeepOffer { possible: true, about }
    }

    /// Keeps what was traced beside the document's file.
    pub(super) fn keep_traced(&mut self) {
        if let Some(path) = self.document.path() {
            self.live.keep(cache::path_of(path));
        }
    }

    /// Passes the scene of another document to the session, with what may be kept of it.
    pub(super) fn show_opened(&mut self) {
        match self.document.path() {
            Some(path) => {
                let scene = Arc::new(self.document.scene().clone());
                self.live.want_kept(scene, cache::path_of(path));
                self.files.touched();
            }
            None => self.show_scene(),
        }
    }
}

/// What was kept, where, and how large it is.
pub(super) fn kept_text(path: &Path, bytes: u64) -> String {
    format!("kept traced in {}, {}", name(path), size(bytes))
}

fn name(path: &Path) -> String {
    path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned()
}

fn size(bytes: u64) -> String {
    match bytes as f64 {
        few if few < 1e6 => format!("{:.0} kB", few / 1e3),
        some if some < 9.95e6 => format!("{:.1} MB", some / 1e6),
        many => format!("{:.0} MB", many / 1e6),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_kept_is_told_with_name_and_size() {
        let text = |bytes| kept_text(Path::new("a/room.rayforest-cache"), bytes);
        assert_eq!(text(150_400_000), "kept traced in room.rayforest-cache, 150 MB");
        assert_eq!(text(9_960_000), "kept traced in room.rayforest-cache, 10 MB");
        assert_eq!(text(40_000), "kept traced in room.rayforest-cache, 40 kB");
    }
}
