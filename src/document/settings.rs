//! What is remembered from run to run: recent files and how the window looks; never anybody's work.

use std::path::{Path, PathBuf};

use toml::de::{DeTable, DeValue};

use super::arrangement::Arrangement;
use super::recovery::set_aside;
use crate::film::write::durably;
use crate::scene::toml_text::{bare_or_quoted, quoted};

/// Remembered between runs. A file that cannot be read is set aside as `NAME.bad` and defaults are used.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// Scene files opened or saved, the latest first, at most ten.
    pub recent: Vec<PathBuf>,
    /// `system`, `light` or `dark`.
    pub theme: Theme,
    /// Size of all text and widgets, in per cent, 50 … 300.
    pub zoom_percent: u32,
    /// Whether a start without a scene shows the welcome.
    pub welcome: bool,
    /// Keys of another version of the program and their values, as TOML: kept for it.
    pub others: Vec<(String, String)>,
    /// The panels.
    pub arrangement: Arrangement,
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

/// The largest number of recent files.
pub const MOST_RECENT: usize = 10;
const THEMES: [(&str, Theme); 3] =
    [("system", Theme::System), ("light", Theme::Light), ("dark", Theme::Dark)];

impl Default for Settings {
    fn default() -> Settings {
        Settings {
            recent: Vec::new(),
            theme: Theme::default(),
            zoom_percent: 100,
            welcome: true,
            others: Vec::new(),
            arrangement: Arrangement::default(),
        }
    }
}

impl Settings {
    /// Reads the file; the second part says what was wrong with it, if anything was. No file is not
    /// wrong: the program never ran before.
    pub fn read(file: &Path) -> (Settings, Option<String>) {
        let wrong = match std::fs::read_to_string(file) {
            Ok(text) => match Settings::parse(&text) {
                Ok(settings) => return (settings, None),
                Err(wrong) => wrong,
            },
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => {
                return (Settings::default(), None);
            }
            Err(error) => error.to_string(),
        };
        let shown = file.display();
        let aside = match set_aside(file) {
            Ok(aside) => format!("it is kept as {}", aside.display()),
            Err(error) => format!("it could not be set aside: {error}"),
        };
        let message = format!("the settings in {shown} cannot be used ({wrong}); {aside}");
        (Settings::default(), Some(message))
    }

    /// Unknown keys are those of another version and are kept.
    fn parse(text: &str) -> Result<Settings, String> {
        let root = DeTable::parse(text).map_err(|error| error.message().to_owned())?;
        let mut settings = Settings::default();
        for (key, value) in root.get_ref() {
            let wrong = || format!("`{}` has a wrong value", key.get_ref());
            match (key.get_ref().as_ref(), value.get_ref()) {
                ("theme", DeValue::String(name)) => {
                    let theme = THEMES.iter().find(|(known, _)| known == name);
                    settings.theme = theme.ok_or_else(wrong)?.1;
                }
                ("zoom_percent", DeValue::Integer(percent)) => {
                    let percent: u32 = percent.as_str().parse().map_err(|_| wrong())?;
                    settings.zoom_percent = percent.clamp(50, 300);
                }
                ("recent", DeValue::Array(files)) => {
                    for file in files.iter().take(MOST_RECENT) {
                        let file = file.get_ref().as_str().ok_or_else(wrong)?;
                        settings.recent.push(PathBuf::from(file));
                    }
                }
                ("welcome", DeValue::Boolean(shows)) => settings.welcome = *shows,
                ("layout", DeValue::Table(table)) => {
                    settings.arrangement = Arrangement::parse(table).ok_or_else(wrong)?;
                }
                ("theme" | "zoom_percent" | "recent" | "welcome" | "layout", _) => {
                    return Err(wrong());
                }
                (other, value) => settings.others.push((other.to_owned(), inline(value))),
            }
        }
        Ok(settings)
    }

    /// Writes the file, whole or not at all; its folder is made if it is missing.
    pub fn write(&self, file: &Path) -> Result<(), String> {
        let name = THEMES.iter().find(|(_, theme)| *theme == self.theme);
        let name = name.expect("every theme has a name").0;
        let mut text = format!("theme = \"{name}\"\nzoom_percent = {}\n", self.zoom_percent);
        text.push_str("recent = [\n");
        // a name that is not text cannot stand in TOML and is forgotten
        for path in self.recent.iter().filter_map(|path| path.to_str()) {
            text.push_str(&format!("    {},\n", quoted(path)));
        }
        text.push_str(&format!("]\nwelcome = {}\n", self.welcome));
        for (key, value) in &self.others {
            text.push_str(&format!("{} = {value}\n", bare_or_quoted(key)));
        }
        text.push_str(&self.arrangement.text());
        if let Some(folder) = file.parent() {
            std::fs::create_dir_all(folder).map_err(|error| {
                format!("settings are not kept: cannot make {}: {error}", folder.display())
            })?;
        }
        durably(file, None, text.as_bytes())
            .map_err(|error| format!("settings are not kept: {error}"))
    }

    /// Puts a file at the head of the recent ones.
    pub fn remember(&mut self, path: &Path) {
        let path = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
        self.recent.retain(|known| *known != path);
        self.recent.insert(0, path);
        self.recent.truncate(MOST_RECENT);
    }
}

/// A value on one line.
fn inline(value: &DeValue<'_>) -> String {
    match value {
        DeValue::String(text) => quoted(text),
        DeValue::Integer(number) => number.to_string(),
        DeValue::Float(number) => number.to_string(),
        DeValue::Boolean(flag) => flag.to_string(),
        DeValue::Datetime(time) => time.to_string(),
        DeValue::Array(list) => {
            let items: Vec<String> = list.iter().map(|item| inline(item.get_ref())).collect();
            format!("[{}]", items.join(", "))
        }
        DeValue::Table(table) => {
            let item = |(key, value): (&toml::Spanned<_>, &toml::Spanned<DeValue<'_>>)| {
                let key: &std::borrow::Cow<'_, str> = key.get_ref();
                format!("{} = {}", bare_or_quoted(key), inline(value.get_ref()))
            };
            let items: Vec<String> = table.iter().map(item).collect();
            format!("{{ {} }}", items.join(", "))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::arrangement::Part;
    use super::*;

    #[test]
    fn settings_come_back_as_they_were_written() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("new/settings.toml");
        assert_eq!(Settings::read(&file), (Settings::default(), None));
        let mut settings =
            Settings { theme: Theme::Dark, zoom_percent: 125, ..Settings::default() };
        for number in 0..12 {
            settings.remember(&folder.path().join(format!("a \"{number}\" ü.toml")));
        }
        settings.arrangement.set_size(Part::Outline, 321);
        settings.remember(&folder.path().join("a \"5\" ü.toml"));
        assert_eq!(settings.recent.len(), 10);
        assert!(settings.recent[0].ends_with("a \"5\" ü.toml"));
        assert!(settings.recent[1].ends_with("a \"11\" ü.toml"));
        settings.write(&file).unwrap();
        assert_eq!(Settings::read(&file), (settings, None));
    }

    #[test]
    fn keys_of_another_version_are_kept() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("settings.toml");
        let later = "later = true\n\"odd key\" = [1, 0xff, 2.5, \"a\\\"b\"]\nday = 2026-01-02\n\
                     welcome = false\n[panels]\nleft = { width = 180 }\n[[tools]]\nname = \"x\"\n";
        std::fs::write(&file, later).unwrap();
        let (settings, wrong) = Settings::read(&file);
        assert!(wrong.is_none() && !settings.welcome);
        let keys: Vec<&str> = settings.others.iter().map(|(key, _)| key.as_str()).collect();
        assert_eq!(keys, ["later", "odd key", "day", "panels", "tools"]);
        assert_eq!(settings.others[1].1, r#"[1, 0xff, 2.5, "a\"b"]"#);
        assert_eq!(settings.others[3].1, "{ left = { width = 180 } }");
        settings.write(&file).unwrap();
        assert_eq!(Settings::read(&file), (settings, None));
    }

    #[test]
    fn what_cannot_be_read_is_set_aside_and_said() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("settings.toml");
        for (number, text) in
            ["zoom_percent = \"big\"", "theme = ", "theme = \"pink\""].iter().enumerate()
        {
            std::fs::write(&file, text).unwrap();
            let (settings, wrong) = Settings::read(&file);
            assert_eq!(settings, Settings::default());
            assert!(wrong.unwrap().contains("settings.toml.bad"));
            assert!(!file.exists());
            assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), number + 1);
        }
        std::fs::write(&file, "zoom_percent = 9000\nlater = true\n").unwrap();
        assert_eq!(Settings::read(&file).0.zoom_percent, 300);
    }
}
