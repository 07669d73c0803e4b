//! `rayforest language`: the reference of scene files, from the program's own list of fields.

mod rows;
mod samples;
mod text;

use clap::Args;

use super::{Failure, print};
use crate::scene::csg::Operation;
use crate::scene::fields::{BACKGROUNDS, BUMPS, LENSES, PLACES, SHAPES, TEXTURES};
use crate::scene::problem::suggestion;
use crate::scene::{Background, Bump, Lens, LightPlace, Paint, Scene, Shape};
use crate::viewer::hints;
use rows::{Row, rows};

/// What to print.
#[derive(Debug, Args)]
pub(crate) struct Language {
    /// The scene of this kind of solid's picture instead, such as `torus`
    #[arg(long, value_name = "SOLID")]
    example: Option<String>,
}

impl Language {
    pub(crate) fn run(self) -> Result<(), Failure> {
        match self.example {
            None => print(document().trim_end()),
            Some(key) => match samples::sample(&key) {
                Some(sample) => print(samples::scene(sample).trim_end()),
                None => {
                    let help = suggestion(&key, "solids", SHAPES.iter().copied());
                    let message = format!("there is no solid `{key}`\n  help: {help}");
                    return Err(Failure::input(message));
                }
            },
        }
        Ok(())
    }
}

/// A table of keys with what is said above it.
struct Section {
    heading: String,
    text: String,
    /// What the paths of all keys begin with.
    from: &'static str,
    rows: Vec<Row>,
}

impl Section {
    /// The keys of a scene that begin with `from` and go on with none of `but`.
    fn of(heading: &str, from: &'static str, but: &[&str], make: &dyn Fn(&mut Scene)) -> Section {
        let mut rows = rows(make);
        rows.retain(|row| {
            let rest = row.path.strip_prefix(from);
            rest.is_some_and(|rest| !but.contains(&rest.split('.').next().unwrap_or(rest)))
        });
        Section { heading: heading.to_owned(), text: String::new(), from, rows }
    }

    fn saying(self, text: impl Into<String>) -> Section {
        Section { text: text.into(), ..self }
    }

    fn markdown(&self) -> String {
        let Section { heading, text, from, rows } = self;
        let mut all = format!("\n{heading}\n");
        if !text.is_empty() {
            all += &format!("\n{}\n", text.trim());
        }
        if !rows.is_empty() {
            all += "\n";
            all += "| key | value | range | default | an edit | what it is |\n";
            all += "|---|---|---|---|---|---|\n";
        }
        all + &rows.iter().map(|row| row.markdown(from)).collect::<String>()
    }
}

/// The whole reference, as Markdown.
fn document() -> String {
    let sections = sections();
    let body: String = sections.iter().map(Section::markdown).collect();
    format!("{}{body}", text::head())
}

fn sections() -> Vec<Section> {
    let mut all = vec![
        Section::of("## The scene", "", text::TABLES, &|_| {}).saying(text::SCENE),
        Section::of("## `[picture]`", "picture.", &[], &|_| {}).saying(text::picture()),
        Section::of("## `[camera]`", "camera.", &[], &|_| {}).saying(text::CAMERA),
    ];
    let (height, others) = (LENSES[1], ["eye", "target", "up", "aperture", "focus", "shutter"]);
    let parallel = |scene: &mut Scene| scene.camera.lens = Lens::named(height);
    all.push(Section::of("In place of `fov_degrees`:", "camera.", &others, &parallel));
    all.push(Section::of("## `[trace]`", "trace.", &[], &|_| {}).saying(text::trace()));
    all.extend(backgrounds());
    all.extend(lights());
    all.extend(materials());
    all.extend(solids());
    all.push(Section::of("## `[looks.NAME]`", "looks.NAME.", &[], &|_| {}).saying(text::LOOKS));
    all
}

fn backgrounds() -> Vec<Section> {
    let one = |(i, key): (usize, &&str)| {
        let heading = if i == 0 { "## `[background]`" } else { &format!("### `{key}`") };
        let section = Section::of(heading, "background.", &[], &|scene| {
            scene.background = Background::named(key);
        });
        section.saying(if i == 0 { text::BACKGROUND } else { hints::kind(key) })
    };
    BACKGROUNDS.iter().enumerate().map(one).collect()
}

fn lights() -> Vec<Section> {
    let from = "lights.NAME.";
    let general = Section::of("## `[lights.NAME]`", from, PLACES, &|_| {}).saying(text::LIGHTS);
    let kind = |kind: &&'static str| {
        let place = LightPlace::of_kind(kind);
        let area = matches!(place, LightPlace::Area(_));
        let heading = if area { format!("### `area.{kind}`") } else { format!("### `{kind}`") };
        let others = ["color", "intensity", "on", "falloff", "samples"];
        let make = |scene: &mut Scene| scene.lights[0].place = place.clone();
        Section::of(&heading, from, &others, &make).saying(hints::choice(kind))
    };
    [general].into_iter().chain(LightPlace::KINDS.iter().map(kind)).collect()
}

fn materials() -> Vec<Section> {
    let from = "materials.NAME.";
    let mut all = vec![
        Section::of("## `[materials.NAME]`", from, &[], &|_| {}).saying(text::materials()),
        Section::of("## Textures", from, &[], &|_| {}).saying(text::TEXTURES).without_rows(),
    ];
    all.extend(TEXTURES.iter().map(|key| {
        let heading = format!("### `texture.{key}`");
        let make = |scene: &mut Scene| scene.materials[0].paint = Paint::named(key);
        Section::of(&heading, from, &[], &make).only("texture.").saying(hints::kind(key))
    }));
    all.push(Section::of("## Bumps", from, &[], &|_| {}).saying(text::BUMPS).without_rows());
    all.extend(BUMPS.iter().map(|key| {
        let heading = format!("### `bump.{key}`");
        let make = |scene: &mut Scene| scene.materials[0].bump = Bump::named(key);
        Section::of(&heading, from, &[], &make).only("bump.").saying(hints::kind(key))
    }));
    all
}

fn solids() -> Vec<Section> {
    let from = "solids.NAME.";
    let general = Section::of("## `[solids.NAME]`", from, &["sphere"], &|_| {});
    let mut all = vec![general.saying(text::solids())];
    let shape = |key: &&'static str| {
        let make = |scene: &mut Scene| scene.solids[0].shape = Shape::named(key);
        let others = ["material", "rotate_degrees", "translate", "scale", "motion"];
        let section = Section::of(&format!("### `{key}`"), from, &others, &make);
        section.saying(samples::sample(key).map_or_else(String::new, |s| picture(key, s)))
    };
    let (operations, plain): (Vec<_>, Vec<_>) =
        SHAPES.iter().partition(|key| Operation::named(key).is_some());
    all.extend(plain.iter().map(shape));
    let heading = "## Solids made of others";
    all.push(Section::of(heading, from, &[], &|_| {}).saying(text::operations()).without_rows());
    all.extend(operations.iter().map(shape));
    all
}

/// What a sample is, its picture and its lines.
fn picture(key: &str, sample: samples::Sample) -> String {
    let samples::Sample { about, lines } = sample;
    format!("{about}\n\n![{key}](language/{key}.png)\n\n```toml\n[solids]\n{lines}\n```")
}

impl Section {
    fn without_rows(self) -> Section {
        Section { rows: Vec::new(), ..self }
    }

    /// Only the keys that go on with this table.
    fn only(mut self, table: &str) -> Section {
        let from = self.from;
        self.rows.retain(|row| row.path.strip_prefix(from).is_some_and(|r| r.starts_with(table)));
        self
    }
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use super::*;

    #[test]
    fn every_key_that_a_scene_file_may_have_is_in_the_reference() {
        let sections = sections();
        let told: HashSet<&str> =
            sections.iter().flat_map(|s| &s.rows).map(|row| row.path.as_str()).collect();
        let mut missing = Vec::new();
        let mut ask = |make: &dyn Fn(&mut Scene)| {
            let rows = rows(make).into_iter().map(|row| row.path);
            missing.extend(rows.filter(|path| !told.contains(path.as_str())));
        };
        LENSES.iter().for_each(|key| ask(&|s| s.camera.lens = Lens::named(key)));
        BACKGROUNDS.iter().for_each(|key| ask(&|s| s.background = Background::named(key)));
        TEXTURES.iter().for_each(|key| ask(&|s| s.materials[0].paint = Paint::named(key)));
        BUMPS.iter().for_each(|key| ask(&|s| s.materials[0].bump = Bump::named(key)));
        SHAPES.iter().for_each(|key| ask(&|s| s.solids[0].shape = Shape::named(key)));
        for kind in LightPlace::KINDS {
            ask(&|s| s.lights[0].place = LightPlace::of_kind(kind));
        }
        assert_eq!(missing, [""; 0]);
        assert!(told.len() > 100, "{} keys", told.len());
        assert!(!told.contains("materials.NAME.colour"));
    }

    #[test]
    fn every_key_is_explained_and_every_solid_has_a_sample() {
        for row in sections().iter().flat_map(|section| &section.rows) {
            assert!(!row.markdown("").contains("|  |"), "{}", row.path);
        }
        for key in SHAPES {
            assert!(samples::sample(key).is_some(), "{key}");
        }
        assert!(samples::sample("teapot").is_none());
    }
}
