//! What a report of a fault needs: version, machine, card, settings and the end of the log, as text.

use std::path::Path;

use eframe::egui::Context;
use eframe::wgpu::AdapterInfo;

use super::app::App;
use super::journal::{file_in, last_lines};
use crate::document::settings::Theme;

/// Lines of the log that are copied.
const LINES: usize = 40;

impl App {
    /// Puts the text on the clipboard.
    pub(super) fn copy_diagnostics(&mut self, ctx: &Context) {
        let text = self.diagnostics(ctx);
        let lines = text.lines().count();
        ctx.copy_text(text);
        self.notices.say(format!("copied {lines} lines: paste them into your report"));
    }

    /// Shows the folder of the log file, or says where it is.
    pub(super) fn show_log_folder(&mut self) {
        let folder = self.files.folders.log.clone();
        // Without a log there is no folder yet.
        let _ = std::fs::create_dir_all(&folder);
        if !self.files.dialogs.show_folder(&folder) {
            self.notices.error(format!("the log is {}", file_in(&folder).display()));
        }
    }

    /// Nothing of any scene is in it, and the home folder is `~`.
    fn diagnostics(&self, ctx: &Context) -> String {
        let (status, folders) = (self.live.status(), &self.files.folders);
        let [width, height] = ctx.content_rect().size().into();
        let [picture_width, picture_height] = self.document.scene().picture.size;
        let megabytes = |bytes: u64| bytes / 1_000_000;
        let mut text = format!(
            "Rayforest {} for {} on {}\n{}\n",
            env!("CARGO_PKG_VERSION"),
            std::env::consts::ARCH,
            std::env::consts::OS,
            machine()
        );
        text += &match &self.screen {
            Some(screen) => card(&screen.adapter()),
            None => "drawn by OpenGL or not at all: no adapter is known\n".to_owned(),
        };
        let card = self.shown.as_ref().is_some_and(|shown| shown.card.is_some());
        text += &format!(
            "the picture is computed by the {}\nwindow {width:.0}×{height:.0} points at {:.2} dots each\n\
             picture {picture_width}×{picture_height}, kept {} MB of {} MB\n",
            if card { "card" } else { "processor" },
            ctx.pixels_per_point(),
            megabytes(status.bytes),
            megabytes(status.budget),
        );
        let settings = &self.settings;
        let theme = match settings.theme {
            Theme::System => "system",
            Theme::Light => "light",
            Theme::Dark => "dark",
        };
        text += &format!(
            "settings: theme {theme}, zoom {} %, {} recent files, welcome {}, {} unknown keys\n",
            settings.zoom_percent,
            settings.recent.len(),
            settings.welcome,
            settings.others.len()
        );
        for (what, folder) in [
            ("settings", &folders.settings),
            ("unsaved work", &folders.recovery),
            ("log", &folders.log),
            ("cache", &folders.cache),
        ] {
            text += &format!("{what} in {}\n", folder.display());
        }
        text += &format!("the last lines of the log:\n{}\n", log_end(&folders.log));
        let home = directories::BaseDirs::new().map(|dirs| dirs.home_dir().to_owned());
        home.map_or(text.clone(), |home| without_home(&text, &home))
    }
}

fn log_end(folder: &Path) -> String {
    let lines = last_lines(&file_in(folder), LINES);
    if lines.is_empty() { "(there is no log)".to_owned() } else { lines.join("\n") }
}

/// System, cores and memory.
fn machine() -> String {
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let mut memory = String::new();
    if let Ok(mut system) = sysinfo::System::new() {
        system.refresh_memory();
        let [total, free] = [system.total_memory(), system.available_memory()];
        memory = format!(", {} MB of memory, {} MB free", total / 1_000_000, free / 1_000_000);
    }
    let system = sysinfo::System::long_os_version();
    format!("{}, {threads} threads{memory}", system.unwrap_or_else(|_| "unknown system".into()))
}

fn card(info: &AdapterInfo) -> String {
    let AdapterInfo { name, device_type, driver, driver_info, backend, .. } = info;
    format!(
        "drawn by {name} ({device_type:?}) through {backend:?}, driver {driver} {driver_info}\n"
    )
}

/// The text with the home folder as `~`.
fn without_home(text: &str, home: &Path) -> String {
    match home.to_str().filter(|home| home.len() > 1) {
        Some(home) => text.replace(home, "~"),
        None => text.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_home_folder_is_not_told() {
        let told = |home: &str| without_home("log in /people/ada/.local/x", Path::new(home));
        assert_eq!(told("/people/ada"), "log in ~/.local/x");
        assert_eq!(told("/"), "log in /people/ada/.local/x");
    }
}
