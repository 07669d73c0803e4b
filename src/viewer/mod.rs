//! The window: a picture, its scene beside it, and every control with its cost.

mod app;
mod badge;
mod carried;
mod carry;
mod chart;
mod chart_plot;
mod clip;
mod clipboard;
mod coefficient;
mod color_field;
mod color_picker;
mod command;
mod commands;
mod compare;
mod control;
mod corners;
mod crop;
mod diagnostics;
pub mod dialog;
mod examples;
mod export;
mod files;
mod gesture;
mod handles;
pub(crate) mod hints;
mod import;
mod inspector;
mod journal;
mod keep;
mod kelvin;
mod keys;
mod kind;
mod lists;
mod looks;
mod mass;
pub mod measure;
mod menu;
mod mixer;
mod modal;
mod navigate;
mod notice;
mod number;
mod on_disk;
mod operands;
mod outline;
mod paints;
mod palette;
mod panels;
mod path_field;
mod picture;
mod pixel;
mod pixel_bars;
mod pixel_lines;
mod pixel_marks;
mod pixel_rows;
mod presets;
mod question;
mod rename;
mod screen;
mod shapes;
mod slider;
mod start;
mod status;
mod style;
mod thumbs;
mod values;
mod welcome;

pub use app::App;
pub use screen::Graphics;
pub use start::{Opening, WindowError, run};

use std::path::{Path, PathBuf};

use crate::session::Options;
use dialog::Dialogs;

/// Where the window keeps what it remembers.
#[derive(Clone, Debug)]
pub struct Folders {
    /// Settings and recent files.
    pub settings: PathBuf,
    /// Unsaved work.
    pub recovery: PathBuf,
    /// The log.
    pub log: PathBuf,
    /// What can be made again: what was traced of examples, thumbnails.
    pub cache: PathBuf,
}

impl Folders {
    /// Where this platform wants them; beside the present folder if it does not say.
    pub fn of_platform() -> Folders {
        match directories::ProjectDirs::from("", "", "rayforest") {
            Some(dirs) => {
                let state = dirs.state_dir().unwrap_or(dirs.data_local_dir());
                Folders {
                    settings: dirs.config_dir().to_owned(),
                    recovery: state.join("unsaved"),
                    log: state.to_owned(),
                    cache: dirs.cache_dir().to_owned(),
                }
            }
            None => Folders::within(Path::new(".rayforest")),
        }
    }

    /// All of them in one folder.
    pub fn within(folder: &Path) -> Folders {
        let [settings, recovery, log, cache] =
            ["config", "unsaved", "log", "cache"].map(|name| folder.join(name));
        Folders { settings, recovery, log, cache }
    }

    fn settings_file(&self) -> PathBuf {
        self.settings.join("settings.toml")
    }
}

/// What a window starts with.
pub struct Setup {
    /// Threads and memory of its session.
    pub options: Options,
    /// Where it keeps what it remembers.
    pub folders: Folders,
    /// How it asks for files.
    pub dialogs: Box<dyn Dialogs>,
    /// The scene to open; the built-in one if there is none.
    pub scene: Option<PathBuf>,
}
