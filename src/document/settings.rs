//! What is remembered from run to run: recent files and how the window looks; never anybody's work.

use std::path::{Path, PathBuf};

/// Remembered between runs. A file that cannot be read is set aside as `NAME.bad` and defaults are used.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Settings {
    /// Scene files opened or saved, the latest first, at most ten.
    pub recent: Vec<PathBuf>,
    /// `system`, `light` or `dark`.
    pub theme: Theme,
    /// Size of all text and widgets, in per cent, 50 … 300.
    pub zoom_percent: u32,
}

/// Colours of the window.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Theme {
    /// As the system has it.
    #[default]
    System,
    /// Dark text on light ground.
    Light,
    /// Light text on dark ground.
    Dark,
}

impl Settings {
    /// Reads the file; the second part says what was wrong with it, if anything was.
    pub fn read(_file: &Path) -> (Settings, Option<String>) {
        todo!()
    }

    /// Writes the file, whole or not at all.
    pub fn write(&self, _file: &Path) -> Result<(), String> {
        todo!()
    }

    /// Puts a file at the head of the recent ones.
    pub fn remember(&mut self, _path: &Path) {
        todo!()
    }
}
