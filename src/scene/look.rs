//! Looks: named sets of differences from a scene, of which one may be worn.

use super::problem::suggestion;
use super::value::Names;
use super::{Scene, check, path};

/// One parameter and the value that it gets.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Setting {
    /// As in [`path::Parameter`].
    pub path: String,
    /// TOML, as the scene's writer spells it.
    pub value: String,
}

/// A named set of differences.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Look {
    /// Unique among the looks.
    pub name: String,
    /// No path twice, in the order of the scene's parameters.
    pub settings: Vec<Setting>,
}

/// The looks of a scene, in file order.
///
/// # Invariants
/// While a look is worn, the scene's values are those that show, with it; what they are without it is
/// kept here, for the same paths as the look has. Its values in `list` may be those of before an edit:
/// [`Scene::looks_now`] gives today's.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Looks {
    /// All of them.
    pub list: Vec<Look>,
    worn: Option<Worn>,
}

/// The look that is worn.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Worn {
    name: String,
    /// What its parameters are without it.
    base: Vec<Setting>,
}

impl Looks {
    /// The one with a name.
    pub fn find(&self, name: &str) -> Option<&Look> {
        self.list.iter().find(|look| look.name == name)
    }

    /// Name of the one that is worn.
    pub fn worn(&self) -> Option<&str> {
        self.worn.as_ref().map(|worn| worn.name.as_str())
    }

    /// What the parameters of the worn look are without it; empty if none is worn.
    pub fn base(&self) -> &[Setting] {
        self.worn.as_ref().map_or(&[], |worn| &worn.base)
    }

    /// Replaces what [`Looks::base`] gives; of no effect if none is worn.
    pub fn set_base(&mut self, base: Vec<Setting>) {
        if let Some(worn) = &mut self.worn {
            worn.base = base;
        }
    }

    /// Gives a look another name.
    pub fn rename(&mut self, from: &str, to: &str) {
        for look in self.list.iter_mut().filter(|look| look.name == from) {
            to.clone_into(&mut look.name);
        }
        if let Some(worn) = self.worn.as_mut().filter(|worn| worn.name == from) {
            to.clone_into(&mut worn.name);
        }
    }
}

impl Scene {
    /// The looks, the worn one with the values that show.
    pub fn looks_now(&self) -> Vec<Look> {
        let mut list = self.looks.list.clone();
        if let Some(look) = list.iter_mut().find(|look| Some(&*look.name) == self.looks.worn()) {
            look.settings = self.present(&look.settings);
        }
        list
    }

    /// The scene without the look that is worn; its looks are today's.
    pub fn undressed(&self) -> Scene {
        let mut scene = self.clone();
        if self.looks.worn.is_some() {
            scene.looks = Looks { list: self.looks_now(), worn: None };
            path::assign_all(&mut scene, self.looks.base());
        }
        scene
    }

    /// The scene with another look, or with none. The values of a look that is taken off are kept in
    /// it. The error says what is wrong, and a way out.
    pub fn dressed(&self, name: Option<&str>) -> Result<Scene, String> {
        let mut scene = self.undressed();
        let Some(name) = name else { return Ok(scene) };
        let Some(look) = scene.looks.find(name).cloned() else {
            let names = scene.looks.list.iter().map(|look| look.name.as_str());
            let help = match scene.looks.list.is_empty() {
                true => "write `[looks.NAME]` into the scene file".to_owned(),
                false => suggestion(name, "its looks", names),
            };
            return Err(format!("the scene has no look `{name}`\n  help: {help}"));
        };
        let before = check::relations(&scene);
        let base = scene.present(&look.settings);
        path::assign_all(&mut scene, &look.settings);
        if let Some(flaw) = check::relations(&scene).into_iter().find(|f| !before.contains(f)) {
            let flaw = format!("{}\n  help: {}", flaw.message, flaw.help);
            return Err(format!("the look `{name}` makes no sense here: {flaw}"));
        }
        scene.looks.worn = Some(Worn { name: name.to_owned(), base });
        Ok(scene)
    }

    /// What the parameters of some settings are here, in the order of the parameters.
    pub fn present(&self, settings: &[Setting]) -> Vec<Setting> {
        path::values(self, settings.iter().map(|setting| setting.path.as_str()))
    }

    /// Those of some settings that can be made here, in the order of the parameters.
    pub fn possible(&self, settings: &[Setting]) -> Vec<Setting> {
        path::assign_all(&mut self.clone(), settings)
    }

    /// The parameters that have another value in `other`: what they are here. Parameters that only one
    /// of the two has are left out, and so are things whose names differ.
    pub fn differences(&self, other: &Scene) -> Vec<Setting> {
        let (mut own, mut others) = (self.clone(), other.clone());
        let same = |a: &str, b: &str, equal: bool| equal || a != b;
        // What is equal need not be written to be compared.
        let names = (Names::of(self), Names::of(other));
        own.lights = pick(&self.lights, &other.lights, |a, b| !same(&a.name, &b.name, a == b));
        others.lights = pick(&other.lights, &self.lights, |a, b| !same(&a.name, &b.name, a == b));
        let differ = |a: &super::Material, b: &super::Material| !same(&a.name, &b.name, a == b);
        own.materials = pick(&self.materials, &other.materials, differ);
        others.materials = pick(&other.materials, &self.materials, differ);
        // A material of another index may be the same one, and the other way round.
        let material = |names: &Names, i: usize| names.materials().get(i).cloned();
        let assigned = |a: &super::Solid, b: &super::Solid| {
            let kept = material(&names.0, a.material) == material(&names.1, b.material);
            !same(&a.name, &b.name, a == b && kept)
        };
        own.solids = pick(&self.solids, &other.solids, assigned);
        others.solids = pick(&other.solids, &self.solids, |a, b| assigned(b, a));
        path::unequal((&mut own, &names.0), (&mut others, &names.1))
    }
}

/// The items of `own` that differ from those in the same place of `other`.
fn pick<T: Clone>(own: &[T], other: &[T], differs: impl Fn(&T, &T) -> bool) -> Vec<T> {
    let pairs = own.iter().zip(other).filter(|(a, b)| differs(a, b));
    pairs.map(|(a, _)| a.clone()).collect()
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::color::Rgb;
    use crate::scene::{read, write};

    const TEXT: &str = "version = 1\nambient_light = 0.5\n[background]\ncolor = 0.25\n\
        [lights.key]\npoint = [0, 0, 5]\n[materials.tiles]\ndiffuse = 0.75\n\
        [looks.night]\nlights.key.on = false\nmaterials.tiles.diffuse = 0.50\nambient_light = 0.1\n\
        [looks.day]\nbackground.color = [0.5, 0.5, 1]\n";

    fn scene() -> Scene {
        read::text(TEXT, Path::new("s.toml")).unwrap_or_else(|error| panic!("{error}"))
    }

    #[test]
    fn a_look_changes_what_it_names_and_taking_it_off_brings_all_back() {
        let plain = scene();
        assert_eq!(plain.looks.worn(), None);
        let paths: Vec<&str> = plain.looks.list[0].settings.iter().map(|s| &*s.path).collect();
        assert_eq!(paths, ["ambient_light", "lights.key.on", "materials.tiles.diffuse"]);
        let night = plain.dressed(Some("night")).unwrap();
        assert_eq!(night.looks.worn(), Some("night"));
        assert!(!night.lights[0].on && night.ambient_light == Rgb::grey(0.1));
        assert_eq!(night.materials[0].diffuse, Rgb::grey(0.5));
        assert_eq!(night.dressed(None).unwrap(), plain);
        let day = night.dressed(Some("day")).unwrap();
        assert!(day.lights[0].on && day.ambient_light == Rgb::grey(0.5));
        assert_eq!(day, plain.dressed(Some("day")).unwrap());
    }

    #[test]
    fn a_worn_look_comes_back_from_its_text_with_what_was_edited() {
        let mut night = scene().dressed(Some("night")).unwrap();
        night.materials[0].diffuse = Rgb::grey(0.125);
        night.materials[0].specular = Rgb::grey(0.5);
        let back = read::text(&write::text(&night), Path::new("s.toml")).unwrap();
        assert_eq!(back.materials, night.materials);
        assert_eq!(back.looks.worn(), Some("night"));
        let plain = back.dressed(None).unwrap();
        assert_eq!(plain.materials[0].diffuse, Rgb::grey(0.75), "the look's, not the scene's");
        assert_eq!(plain.materials[0].specular, Rgb::grey(0.5), "not in the look");
        assert_eq!(plain.looks.list[0].settings[2].value, "0.125");
        assert_eq!(write::text(&back), write::text(&night));
    }

    #[test]
    fn a_missing_look_has_a_way_out() {
        let error = scene().dressed(Some("nigt")).unwrap_err();
        assert_eq!(error, "the scene has no look `nigt`\n  help: did you mean `night`?");
        assert!(Scene::default().dressed(Some("x")).unwrap_err().contains("[looks.NAME]"));
    }

    #[test]
    fn differences_name_what_differs_and_nothing_else() {
        let (plain, night) = (scene(), scene().dressed(Some("night")).unwrap());
        assert_eq!(plain.differences(&night), night.looks.base());
        assert_eq!(plain.differences(&plain), []);
        let mut signed = plain.clone();
        signed.ambient_light = Rgb::grey(-0.0);
        let mut zero = plain.clone();
        zero.ambient_light = Rgb::grey(0.0);
        assert_eq!(zero.differences(&signed).len(), 1, "-0 is not 0");
    }

    #[test]
    fn mistakes_have_their_place() {
        let refused = |lines: &str| {
            let text = format!("version = 1\n[materials.tiles]\n{lines}");
            read::text(&text, Path::new("s.toml")).unwrap_err().to_string()
        };
        assert_eq!(
            refused("[looks.night]\nmaterials.tile.diffuse = 1"),
            "s.toml:4:16: there is no parameter `materials.tile.diffuse`\n  \
             materials.tile.diffuse = 1\n                 ^^^^^^^\n  \
             help: did you mean `materials.tiles.diffuse`?"
        );
        for (lines, expected) in [
            ("[looks.a]\nmaterials.tiles.diffuse = -1", "s.toml:4:27: `diffuse` is -1, out of"),
            (
                "[looks.a]\nmaterials.tiles = 1",
                "s.toml:4:11: there is no parameter `materials.tiles`",
            ),
            ("[looks]\na = 1", "s.toml:4:5: `a` must be a table"),
            ("looks = 1", "unknown key `looks` in `materials.tiles`"),
            (
                "[looks.a]\ncamera.eye = [0, 0, 9]\ncamera.target = [0, 0, 1]",
                "s.toml:3:8: the look",
            ),
        ] {
            let found = refused(lines);
            assert!(found.contains(expected), "{found}");
        }
        let refused = |line: &str| {
            let text = format!("version = 1\n{line}\n[looks.day]\nambient_light = 1\n");
            read::text(&text, Path::new("s.toml")).unwrap_err().to_string()
        };
        assert!(refused("look = \"dya\"").contains("s.toml:2:8: the scene has no look `dya`"));
        assert!(refused("look = 1").contains("`look` must be the name of a look, found the whole"));
    }
}
