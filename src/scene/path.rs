//! Names every parameter of a scene by a path such as `materials.glass.ior`, and sets it by that name.

use std::collections::{HashMap, HashSet};
use std::fmt;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::Scene;
use super::check;
use super::fields::{self, Need, Visit};
use super::look::Setting;
use super::problem::suggestion;
use super::range::{Kind, Range};
use super::slot::Slot;
use super::toml_text::bare_or_quoted;
use super::value::Names;

/// A value of a scene that can be set by its path.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    /// Its keys as in the scene file, joined by dots, quoted where TOML needs it.
    pub path: String,
    /// How its value is written.
    pub kind: Kind,
    /// What each of its numbers must keep to; `None` if it is not made of numbers.
    pub range: Option<Range>,
    /// Its present value as TOML.
    pub value: String,
}

/// Why a parameter could not be set.
#[derive(Clone, Debug, PartialEq)]
pub struct PathError {
    /// The path as it was given.
    pub path: String,
    /// What is wrong, one line.
    pub message: String,
    /// A way out, one line.
    pub help: String,
}

impl fmt::Display for PathError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}\n  help: {}", self.path, self.message, self.help)
    }
}

impl std::error::Error for PathError {}

/// Every parameter that can be set, in the order of the scene file.
pub fn parameters(scene: &Scene) -> Vec<Parameter> {
    let names = Names::of(scene);
    let mut list = Vec::new();
    walk(&mut scene.clone(), &mut |path, _, slot| {
        if slot.kind() != Kind::File {
            let (kind, range) = (slot.kind(), slot.range());
            list.push(Parameter { path: path.to_owned(), kind, range, value: slot.text(&names) });
        }
    });
    list
}

/// Sets the parameter at `path` to a TOML value; a name may lack its quotes.
///
/// After an error the scene is what it was; after success it is as valid as it was before.
pub fn set(scene: &mut Scene, path: &str, value: &str) -> Result<(), PathError> {
    let error = |message: String, help: String| PathError { path: path.to_owned(), message, help };
    let names = Names::of(scene);
    let wanted = canonical(path);
    let mut edited = scene.clone();
    let mut outcome = None;
    walk(&mut edited, &mut |path, key, mut slot| {
        if path == wanted {
            outcome = Some(assign(&mut slot, key, value.trim(), &names));
        }
    });
    match outcome {
        None => {
            let all = parameters(scene);
            let list = all.iter().map(|parameter| parameter.path.as_str());
            let help = suggestion(&wanted, "parameters", list);
            return Err(error("there is no such parameter".to_owned(), help));
        }
        Some(Err((message, help))) => return Err(error(message, help)),
        Some(Ok(())) => {}
    }
    let flaws = check::relations(&edited);
    if !flaws.is_empty() {
        let before = check::relations(scene);
        if let Some(flaw) = flaws.into_iter().find(|flaw| !before.contains(flaw)) {
            return Err(error(flaw.message, flaw.help));
        }
    }
    *scene = edited;
    Ok(())
}

/// The path of `key` in the table at `path`, which is empty for the scene itself.
pub fn join(path: &str, key: &str) -> String {
    let key = bare_or_quoted(key);
    if path.is_empty() { key } else { format!("{path}.{key}") }
}

/// The scene with another value of the parameter at `path`, which may not go together with the
/// rest: for comparison alone. `None` if there is no such parameter, or it cannot be set.
pub fn altered(scene: &Scene, path: &str) -> Option<Scene> {
    let wanted = canonical(path);
    let mut altered = scene.clone();
    let mut found = false;
    walk(&mut altered, &mut |path, _, mut slot| {
        if path == wanted && slot.kind() != Kind::File {
            slot.alter();
            found = true;
        }
    });
    found.then_some(altered)
}

/// The present values of some parameters, in the order of the scene file; unknown paths are left out.
pub(super) fn values<'a>(scene: &Scene, paths: impl Iterator<Item = &'a str>) -> Vec<Setting> {
    let (names, wanted) = (Names::of(scene), paths.collect::<HashSet<_>>());
    let mut found = Vec::new();
    walk_among(&mut scene.clone(), &wanted, &mut |path, _, slot| {
        found.push(Setting { path: path.to_owned(), value: slot.text(&names) });
    });
    found
}

/// Makes those settings that can be made, heeding no relation between them; gives them in the order of
/// the scene file, as the scene's writer spells them.
pub(super) fn assign_all(scene: &mut Scene, settings: &[Setting]) -> Vec<Setting> {
    let names = Names::of(scene);
    let wanted: HashSet<&str> = settings.iter().map(|setting| setting.path.as_str()).collect();
    let mut made = Vec::new();
    walk_among(scene, &wanted, &mut |path, key, mut slot| {
        let Some(setting) = settings.iter().find(|setting| setting.path == path) else { return };
        let before = slot.text(&names);
        if assign(&mut slot, key, &setting.value, &names).is_ok() {
            made.push(Setting { path: path.to_owned(), value: slot.text(&names) });
        } else {
            // A value out of its range may have been written.
            let _ = assign(&mut slot, key, &before, &names);
        }
    });
    made
}

/// The parameters that two scenes have and that differ, with their values in the first.
pub(super) fn unequal(a: (&mut Scene, &Names), b: (&mut Scene, &Names)) -> Vec<Setting> {
    let mut others = HashMap::new();
    walk(b.0, &mut |path, _, slot| {
        if slot.kind() != Kind::File {
            others.insert(path.to_owned(), slot.text(b.1));
        }
    });
    let mut found = Vec::new();
    walk(a.0, &mut |path, _, slot| {
        if let Some(other) = others.get(path) {
            let value = slot.text(a.1);
            if value != *other {
                found.push(Setting { path: path.to_owned(), value });
            }
        }
    });
    found
}

/// The keys of a path, without quotes; `None` if it is none.
pub(crate) fn segments(path: &str) -> Option<Vec<String>> {
    let line = format!("{path} = 0");
    let root = DeTable::parse(&line).ok()?;
    let mut keys = Vec::new();
    let mut table = root.get_ref();
    loop {
        let (key, value) = table.iter().next().filter(|_| table.len() == 1)?;
        keys.push(key.get_ref().to_string());
        match value.get_ref() {
            DeValue::Table(inner) => table = inner,
            _ => return Some(keys),
        }
    }
}

/// Parses `value` and writes it into the slot; after an error: what is wrong, and a way out.
fn assign(
    slot: &mut Slot<'_>,
    key: &str,
    value: &str,
    names: &Names,
) -> Result<(), (String, String)> {
    let named = matches!(slot.kind(), Kind::Material | Kind::Choice(_));
    let bare_name = named && !value.starts_with(['"', '\'']);
    let parsed = match DeValue::parse(value) {
        _ if bare_name => Spanned::new(0..value.len(), DeValue::String(value.into())),
        Ok(parsed) => parsed,
        Err(_) => {
            let message = format!("`{key}` must be {}, found {value}", slot.kind().expected());
            return Err((message, format!("for example `{key} = {}`", slot.text(names))));
        }
    };
    slot.assign(key, &parsed, names).map_err(|mistake| (mistake.message, mistake.help))
}

/// The path with quotes exactly where they are needed; unchanged if it is not a TOML key.
fn canonical(path: &str) -> String {
    let line = format!("{} = 0", path.trim());
    keys(&line).map_or_else(|| path.trim().to_owned(), |keys| keys.join("."))
}

/// The keys of `line`, if it holds nothing but one key and, as its last character, one value.
fn keys(line: &str) -> Option<Vec<String>> {
    let root = DeTable::parse(line).ok()?;
    let mut keys = Vec::new();
    let mut table = root.get_ref();
    loop {
        let (key, value) = table.iter().next().filter(|_| table.len() == 1)?;
        keys.push(bare_or_quoted(key.get_ref()));
        match value.get_ref() {
            DeValue::Table(inner) => table = inner,
            _ => return (value.span() == (line.len() - 1..line.len())).then_some(keys),
        }
    }
}

/// Calls `each` with path, key and slot of every value.
fn walk(scene: &mut Scene, each: &mut dyn FnMut(&str, &'static str, Slot<'_>)) {
    fields::scene(scene, &mut Walk { prefix: String::new(), wanted: None, each });
}

/// [`walk`] over some paths alone; nothing is looked into that holds none of them.
pub(super) fn walk_among(
    scene: &mut Scene,
    wanted: &HashSet<&str>,
    each: &mut dyn FnMut(&str, &'static str, Slot<'_>),
) {
    let mut each = |path: &str, key, slot: Slot<'_>| {
        if wanted.contains(path) {
            each(path, key, slot);
        }
    };
    fields::scene(
        scene,
        &mut Walk { prefix: String::new(), wanted: Some(wanted), each: &mut each },
    );
}

struct Walk<'a> {
    /// Ends with a dot, unless it is empty.
    prefix: String,
    /// The only paths that are looked for, if not all are.
    wanted: Option<&'a HashSet<&'a str>>,
    each: &'a mut dyn FnMut(&str, &'static str, Slot<'_>),
}

impl Visit for Walk<'_> {
    fn leaf(&mut self, key: &'static str, _: Need, slot: Slot<'_>) {
        (self.each)(&format!("{}{key}", self.prefix), key, slot);
    }

    fn group(&mut self, key: &str, _: Need, body: &mut dyn FnMut(&mut dyn Visit)) {
        let outer = self.prefix.len();
        self.prefix.push_str(&bare_or_quoted(key));
        self.prefix.push('.');
        let prefix = self.prefix.as_str();
        if self.wanted.is_none_or(|wanted| wanted.iter().any(|path| path.starts_with(prefix))) {
            body(self);
        }
        self.prefix.truncate(outer);
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use glam::DVec3;

    use super::*;
    use crate::color::Rgb;
    use crate::scene::model::Model;
    use crate::scene::{Light, Material, Paint, Shape, Solid, read};

    fn scene() -> Scene {
        let checker = Paint::Checker { a: Rgb::WHITE, b: Rgb([0.1, 0.2, 0.3]), size: 0.5 };
        let mut scene = Scene {
            lights: vec![Light::new("key"), Light::new("a.b")],
            materials: vec![
                Material::new("glass"),
                Material { paint: checker, ..Material::new("my tiles") },
            ],
            ..Scene::default()
        };
        for key in fields::SHAPES {
            scene.solids.push(Solid::new(*key, Shape::named(key), 0));
        }
        scene
    }

    fn refused(scene: &mut Scene, path: &str, value: &str) -> String {
        let before = scene.clone();
        let error = set(scene, path, value).unwrap_err();
        assert_eq!(*scene, before, "changed in spite of the error");
        error.to_string()
    }

    #[test]
    fn every_parameter_can_be_set_to_its_own_value() {
        let original = scene();
        let list = parameters(&original);
        let mut edited = scene();
        for Parameter { path, value, .. } in &list {
            set(&mut edited, path, value).unwrap_or_else(|error| panic!("{error}"));
        }
        assert_eq!(parameters(&edited), list);
        assert_eq!(edited, original);
        let paths: Vec<&str> = list.iter().map(|parameter| parameter.path.as_str()).collect();
        for path in [
            "ambient_light",
            "camera.fov_degrees",
            "picture.exposure",
            "trace.depth",
            "background.color",
            "lights.\"a.b\".intensity",
            "materials.glass.diffuse",
            "materials.\"my tiles\".texture.checker.a",
            "solids.sphere.sphere.radius",
            "solids.polygon.polygon.points",
            "solids.box.translate",
        ] {
            assert!(paths.contains(&path), "{path}");
        }
    }

    #[test]
    fn every_parameter_can_be_written_in_a_scene_file() {
        // without the mesh, which needs a file
        let mut scene = scene();
        scene.solids.retain(|solid| !matches!(solid.shape, Shape::Mesh { .. }));
        let mut lines = vec!["version = 1".to_owned()];
        for Parameter { path, value, .. } in parameters(&scene) {
            lines.push(format!("{path} = {value}"));
        }
        let read = read::text(&lines.join("\n"), Path::new("s.toml"));
        assert_eq!(read.unwrap_or_else(|error| panic!("{error}")), scene);
    }

    #[test]
    fn values_of_every_kind_are_set() {
        let mut scene = scene();
        for (path, value) in [
            ("materials.glass.diffuse", "0.4"),
            ("materials.'my tiles'.texture.checker.a", " [1, 0, 0.5] "),
            ("lights.key.on", "false"),
            ("trace.samples", "0x10"),
            ("picture.size", "[100, 50]"),
            ("camera.eye", "[1, 2, 3]"),
            ("solids.box.scale", "2"),
            ("solids.box.material", "my tiles"),
            ("materials.glass.model", "cook_torrance"),
            ("materials.glass.roughness", "0.02"),
            ("materials.glass.fresnel", "true"),
            ("solids.knot.material", "\"my tiles\""),
        ] {
            set(&mut scene, path, value).unwrap_or_else(|error| panic!("{error}"));
        }
        assert_eq!(scene.materials[0].diffuse, Rgb::grey(0.4));
        assert_eq!(scene.materials[0].model, Model::CookTorrance);
        assert!(scene.materials[0].fresnel && scene.materials[0].roughness == 0.02);
        assert!(matches!(scene.materials[1].paint, Paint::Checker { a: Rgb([1.0, 0.0, 0.5]), .. }));
        assert_eq!((scene.lights[0].on, scene.trace.samples), (false, 16));
        assert_eq!((scene.picture.size, scene.camera.eye.z), ([100, 50], 3.0));
        assert_eq!(
            (scene.solids[2].placement.scale, scene.solids[2].material),
            (DVec3::splat(2.0), 1)
        );
        let knot = scene.solids.iter().find(|solid| solid.name == "knot").unwrap();
        assert_eq!(knot.material, 1);
    }

    #[test]
    fn an_altered_parameter_differs_and_keeps_to_its_range() {
        let original = scene();
        for path in parameters(&original).iter().map(|p| p.path.as_str()) {
            let altered = altered(&original, path).unwrap();
            assert_ne!(altered, original, "{path}");
            let names = Names::of(&altered);
            let mut twice = altered.clone();
            walk(&mut twice, &mut |at, key, mut slot| {
                if at == path {
                    assert_eq!(slot.fault(key, &names), None, "{path}");
                    slot.alter();
                }
            });
            assert_ne!(twice, altered, "{path}");
        }
        assert_eq!(altered(&original, "camera.ear"), None);
        assert_eq!(altered(&original, "solids.mesh.mesh.file"), None);
    }

    #[test]
    fn mistakes_are_explained_and_change_nothing() {
        let mut scene = scene();
        assert_eq!(
            refused(&mut scene, "materials.glas.diffuse", "1"),
            "materials.glas.diffuse: there is no such parameter\n  \
             help: did you mean `materials.glass.diffuse`?"
        );
        assert_eq!(
            refused(&mut scene, "materials.glass.diffuse", "true"),
            "materials.glass.diffuse: `diffuse` must be a number or [r, g, b], found `true`\n  \
             help: for example `diffuse = 0.7`"
        );
        assert_eq!(
            refused(&mut scene, "materials.glass.diffuse", "0.4 0.5"),
            "materials.glass.diffuse: `diffuse` must be a number or [r, g, b], found 0.4 0.5\n  \
             help: for example `diffuse = 0.7`"
        );
        assert_eq!(
            refused(&mut scene, "materials.glass.metallic", "1.5"),
            "materials.glass.metallic: `metallic` is 1.5, out of its range: 0 to 1\n  \
             help: the nearest allowed value is 1"
        );
        assert_eq!(
            refused(&mut scene, "materials.glass.model", "blin"),
            "materials.glass.model: there is no model `blin`\n  help: did you mean `blinn`?"
        );
        assert_eq!(
            refused(&mut scene, "materials.glass.roughness", "0.01"),
            "materials.glass.roughness: `roughness` is 0.01, out of its range: 0.02 to 1\n  \
             help: the nearest allowed value is 0.02"
        );
        assert_eq!(
            refused(&mut scene, "solids.box.material", "glas"),
            "solids.box.material: there is no material `glas`\n  help: did you mean `glass`?"
        );
        assert_eq!(
            refused(&mut scene, "camera.eye", "[0, 0, 5]"),
            "camera.eye: `up` is parallel to the view from `eye` to `target`\n  \
             help: for example `up = [0, 1, 0]`"
        );
        assert_eq!(
            refused(&mut scene, "solids.mesh.mesh.file", "\"other.obj\""),
            "solids.mesh.mesh.file: `file` can only be changed in the scene file\n  \
             help: edit the scene file and open it again"
        );
        for path in [
            "",
            "camera",
            "camera.eye.x",
            "camera.eye = 1\nversion",
            "camera.eye = 1 #",
            "solids.box.sphere.radius",
        ] {
            assert!(refused(&mut scene, path, "1").contains("no such parameter"), "{path}");
        }
    }
}
