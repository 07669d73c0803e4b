//! The rows of the reference's tables, from the list of fields that reader, writer and inspector visit.

use crate::scene::change::Change;
use crate::scene::fields::{self, Need, Visit};
use crate::scene::model::Model;
use crate::scene::range::Kind;
use crate::scene::slot::Slot;
use crate::scene::value::Names;
use crate::scene::{Light, LightPlace, Material, Scene, Shape, Solid, path};
use crate::viewer::hints;

/// The name of every light, material and solid whose keys are listed.
pub(super) const NAME: &str = "NAME";

/// One key of a scene file.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Row {
    /// Its whole path, such as `lights.NAME.spot.at`.
    pub(super) path: String,
    value: String,
    range: String,
    default: String,
    cost: String,
    about: &'static str,
}

impl Row {
    /// The row of a table, its key counted from a path on.
    pub(super) fn markdown(&self, from: &str) -> String {
        let Row { path, value, range, default, cost, about } = self;
        let key = path.strip_prefix(from).unwrap_or(path);
        format!("| `{key}` | {value} | {range} | {default} | {cost} | {about} |\n")
    }
}

/// Every row of what `make` makes of a scene with one light, one material and one solid.
pub(super) fn rows(make: &dyn Fn(&mut Scene)) -> Vec<Row> {
    let scenes: Vec<Scene> = [plain(), clear(), weighed()]
        .into_iter()
        .map(|mut scene| {
            make(&mut scene);
            scene
        })
        .collect();
    let mut list = List { names: &Names::of(&scenes[0]), at: Vec::new(), rows: Vec::new() };
    fields::scene(&mut scenes[0].clone(), &mut list);
    for row in &mut list.rows {
        row.cost = cost(&scenes, &row.path);
    }
    list.rows
}

/// All defaults.
fn plain() -> Scene {
    Scene {
        lights: vec![Light::new(NAME)],
        materials: vec![Material::new(NAME)],
        solids: vec![Solid::new(NAME, Shape::named("sphere"), 0)],
        ..Scene::default()
    }
}

/// What everything matters in: clear and mirroring, moving, out of focus, lit by what falls off.
fn clear() -> Scene {
    let mut scene = plain();
    scene.camera.aperture = 0.1;
    scene.trace.adaptive = 0.1;
    scene.solids[0].motion.translate.x = 1.0;
    for light in &mut scene.lights {
        *light = Light { falloff: 3.0, place: LightPlace::of_kind("disc"), ..light.clone() };
    }
    for material in &mut scene.materials {
        (material.reflect.0, material.transmit.0) = ([0.5; 3], [0.4; 3]);
    }
    // Another one that a solid may get, which takes its place where solids overlap.
    scene.materials.push(Material { priority: 1, ..Material::new("OTHER") });
    scene
}

/// The same with Fresnel's weights, another highlight, and another material that leads rays alike.
fn weighed() -> Scene {
    let mut scene = clear();
    let material = &mut scene.materials[0];
    (material.fresnel, material.model) = (true, Model::CookTorrance);
    scene.materials[1] = Material { name: "OTHER".to_owned(), ..material.clone() };
    scene
}

/// What an edit runs, the cheapest first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Class {
    Instant,
    Limit,
    Refold,
    Rereads,
    Some,
    All,
}

impl Class {
    fn of(change: &Change) -> Option<Class> {
        let classes = [
            (change.everything, Class::All),
            (change.casts, Class::Some),
            (change.moves_rays.is_some(), Class::Rereads),
            (!change.refold.is_empty(), Class::Refold),
            (change.branches, Class::Limit),
            (change.terms || change.develop, Class::Instant),
        ];
        classes.into_iter().find(|(holds, _)| *holds).map(|(_, class)| class)
    }

    fn name(self) -> &'static str {
        match self {
            Class::Instant => "instant",
            Class::Limit => "instant up to a limit",
            Class::Refold => "refold",
            Class::Rereads => "rereads",
            Class::Some => "traces some",
            Class::All => "traces all",
        }
    }
}

/// What editing a parameter costs where it matters, there and back: the cheapest and the dearest.
fn cost(scenes: &[Scene], path: &str) -> String {
    let both = |scene: &Scene| {
        let altered = path::altered(scene, path)?;
        Some([Change::between(scene, &altered), Change::between(&altered, scene)])
    };
    let changes = scenes.iter().filter_map(both).flatten();
    let classes: Vec<Class> = changes.filter_map(|change| Class::of(&change)).collect();
    match (classes.iter().min(), classes.iter().max()) {
        (Some(least), Some(most)) if least == most => least.name().to_owned(),
        (Some(least), Some(most)) => format!("{} … {}", least.name(), most.name()),
        _ => "—".to_owned(),
    }
}

/// Makes a row of every value that it visits; costs are not known yet.
struct List<'a> {
    names: &'a Names,
    at: Vec<String>,
    rows: Vec<Row>,
}

impl Visit for List<'_> {
    fn leaf(&mut self, key: &'static str, need: Need, slot: Slot<'_>) {
        let value = match slot.kind() {
            Kind::Choice(names) => {
                let names: Vec<String> = names.iter().map(|name| format!("`\"{name}\"`")).collect();
                names.join(", ")
            }
            kind => kind.expected().to_owned(),
        };
        let default = match need {
            Need::Required | Need::OneOf(_) => "required".to_owned(),
            Need::EitherOf(keys) if keys[0] != key => "—".to_owned(),
            Need::Optional | Need::EitherOf(_) => format!("`{}`", slot.text(self.names)),
        };
        let named = self.at.len() == 2 && fields::LISTS.contains(&self.at[0].as_str());
        let table = self.at.last().filter(|_| !named).map_or("", String::as_str);
        self.rows.push(Row {
            path: self.at.iter().map(|key| format!("{key}.")).collect::<String>() + key,
            value,
            range: slot.range().map_or("—".to_owned(), |range| range.to_string()),
            default,
            cost: String::new(),
            about: hints::about(table, key),
        });
    }

    fn group(&mut self, key: &str, _: Need, body: &mut dyn FnMut(&mut dyn Visit)) {
        self.at.push(key.to_owned());
        body(self);
        self.at.pop();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_say_what_the_fields_and_the_changes_say() {
        let rows = rows(&|_| {});
        let row = |path: &str| rows.iter().find(|row| row.path == path).unwrap().markdown("");
        let exposure = "| `picture.exposure` | a number | -30 to 30 | `0` | instant | Brightness of \
                        the picture in stops: +1 doubles it |\n";
        assert_eq!(row("picture.exposure"), exposure);
        for (path, cost) in [
            ("camera.eye", "traces all"),
            ("camera.focus", "traces all"),
            ("camera.shutter", "traces all"),
            ("trace.adaptive", "traces all"),
            ("lights.NAME.color", "instant"),
            ("lights.NAME.falloff", "instant … rereads"),
            ("materials.NAME.diffuse", "instant"),
            ("materials.NAME.reflect", "instant up to a limit"),
            ("materials.NAME.shininess", "refold"),
            ("materials.NAME.roughness", "refold"),
            ("materials.NAME.ior", "traces some"),
            ("solids.NAME.material", "rereads … traces all"),
            ("materials.NAME.gloss", "traces some"),
            ("materials.NAME.priority", "traces all"),
        ] {
            assert!(row(path).contains(&format!("| {cost} |")), "{}", row(path));
        }
    }
}
