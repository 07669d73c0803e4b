//! Which panels of the window show, and how large they are.

use toml::de::{DeTable, DeValue};

/// A panel that can be hidden.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// The list of what the scene holds.
    Outline,
    /// The parameters of what is selected.
    Inspector,
    /// The status line.
    Status,
    /// The light mixer.
    Mixer,
    /// Looks and snapshots.
    Looks,
    /// The chart of speed against accuracy.
    Chart,
    /// Mass properties.
    Mass,
    /// A pixel and its rays.
    Pixel,
}

impl Part {
    /// All of them.
    pub const ALL: [Part; 8] = [
        Part::Outline,
        Part::Inspector,
        Part::Status,
        Part::Mixer,
        Part::Looks,
        Part::Chart,
        Part::Mass,
        Part::Pixel,
    ];

    /// Its name in the settings.
    fn key(self) -> &'static str {
        match self {
            Part::Outline => "outline",
            Part::Inspector => "inspector",
            Part::Status => "status",
            Part::Mixer => "mixer",
            Part::Looks => "looks",
            Part::Chart => "chart",
            Part::Mass => "mass",
            Part::Pixel => "pixel",
        }
    }

    /// Whether it shows before the person says anything.
    pub fn shows_at_first(self) -> bool {
        matches!(self, Part::Outline | Part::Inspector | Part::Status)
    }
}

/// Sizes that a panel may be given, in points.
const SIZES: std::ops::RangeInclusive<u32> = 20..=4000;

/// Which panels show, and the sizes that were given to them.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Arrangement {
    /// In the order of [`Part::ALL`].
    shows: [bool; Part::ALL.len()],
    /// In points; `None` where the size was never changed.
    sizes: [Option<u32>; Part::ALL.len()],
}

impl Default for Arrangement {
    fn default() -> Arrangement {
        Arrangement { shows: Part::ALL.map(Part::shows_at_first), sizes: Default::default() }
    }
}

impl Arrangement {
    /// Whether a panel shows.
    pub fn shows(&self, part: Part) -> bool {
        self.shows[part as usize]
    }

    /// Shows or hides a panel.
    pub fn set_shows(&mut self, part: Part, shows: bool) {
        self.shows[part as usize] = shows;
    }

    /// Width of a panel at the side, height of one below, in points, if it was changed.
    pub fn size(&self, part: Part) -> Option<u32> {
        self.sizes[part as usize]
    }

    /// Changes it.
    pub fn set_size(&mut self, part: Part, size: u32) {
        self.sizes[part as usize] = Some(size.clamp(*SIZES.start(), *SIZES.end()));
    }

    /// Reads `[layout]`; panels of another version are passed over. `None` for a wrong value.
    pub(super) fn parse(table: &DeTable<'_>) -> Option<Arrangement> {
        let mut arrangement = Arrangement::default();
        for (key, value) in table {
            let part = Part::ALL.into_iter().find(|part| part.key() == key.get_ref().as_ref());
            let Some(part) = part else { continue };
            let DeValue::Table(table) = value.get_ref() else { return None };
            for (key, value) in table {
                match (key.get_ref().as_ref(), value.get_ref()) {
                    ("shows", DeValue::Boolean(shows)) => arrangement.set_shows(part, *shows),
                    ("size", DeValue::Integer(size)) => {
                        arrangement.set_size(part, size.as_str().parse().ok()?);
                    }
                    ("shows" | "size", _) => return None,
                    _ => {}
                }
            }
        }
        Some(arrangement)
    }

    /// The same as text: what is not as it was at first.
    pub(super) fn text(&self) -> String {
        let mut text = String::new();
        for part in Part::ALL {
            let shows = self.shows(part) != part.shows_at_first();
            let shows = shows.then(|| format!("shows = {}", self.shows(part)));
            let size = self.size(part).map(|size| format!("size = {size}"));
            let values: Vec<_> = shows.into_iter().chain(size).collect();
            if !values.is_empty() {
                text.push_str(&format!("{} = {{ {} }}\n", part.key(), values.join(", ")));
            }
        }
        if text.is_empty() { text } else { format!("\n[layout]\n{text}") }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str) -> Option<Arrangement> {
        let root = DeTable::parse(text).unwrap();
        let DeValue::Table(table) = root.get_ref().get("layout")?.get_ref() else { return None };
        Arrangement::parse(table)
    }

    #[test]
    fn an_arrangement_comes_back_as_it_was_written() {
        let mut arrangement = Arrangement::default();
        assert_eq!(arrangement.text(), "", "nothing to say");
        for (i, part) in Part::ALL.into_iter().enumerate() {
            assert_eq!(part as usize, i);
            arrangement.set_shows(part, !part.shows_at_first());
            arrangement.set_size(part, 100 + i as u32);
            assert_eq!(parse(&arrangement.text()).as_ref(), Some(&arrangement), "{part:?}");
            assert_ne!(arrangement, Arrangement::default());
        }
    }

    #[test]
    fn odd_values_are_refused_or_made_harmless() {
        assert_eq!(parse("[layout]\nlater = 7\noutline = { later = 1 }"), Some(Default::default()));
        assert_eq!(parse("[layout]\noutline = 7"), None);
        assert_eq!(parse("[layout]\noutline = { size = -1 }"), None);
        assert_eq!(parse("[layout]\noutline = { shows = 1 }"), None);
        let huge = parse("[layout]\nchart = { size = 1000000 }").unwrap();
        assert_eq!(huge.size(Part::Chart), Some(4000));
    }
}
