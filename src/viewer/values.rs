//! The values of what is selected, as text: those of the scene, those that were saved, the defaults.

use std::cell::OnceCell;
use std::collections::HashMap;

use super::inspector::Selection;
use crate::scene::fields::{self, Need, Visit};
use crate::scene::path::join;
use crate::scene::slot::Slot;
use crate::scene::value::Names;
use crate::scene::{
    Background, Bump, Lens, Light, LightPlace, Material, Paint, Scene, Shape, Solid,
};

/// Visits what is selected, with the whole path of every key.
pub(super) fn visit(scene: &mut Scene, selection: Selection, v: &mut dyn Visit) {
    let optional = Need::Optional;
    match selection {
        Selection::Scene => {
            let Scene { ambient_light, picture, camera, background, trace, .. } = scene;
            v.group("picture", optional, &mut |v| fields::picture(picture, v));
            v.group("camera", optional, &mut |v| fields::camera(camera, v));
            v.group("trace", optional, &mut |v| fields::trace(trace, v));
            v.group("background", optional, &mut |v| fields::background(background, v));
            let ambient = Slot::Coefficient(ambient_light, fields::COEFFICIENT);
            v.leaf("ambient_light", optional, ambient);
        }
        Selection::Light(i) => {
            let light = &mut scene.lights[i];
            v.group("lights", optional, &mut |v| {
                v.group(&light.name.clone(), optional, &mut |v| fields::light(light, v));
            });
        }
        Selection::Material(i) => {
            let material = &mut scene.materials[i];
            v.group("materials", optional, &mut |v| {
                v.group(&material.name.clone(), optional, &mut |v| fields::material(material, v));
            });
        }
        Selection::Solid(i) => {
            let solid = &mut scene.solids[i];
            v.group("solids", optional, &mut |v| {
                v.group(&solid.name.clone(), optional, &mut |v| fields::solid(solid, v));
            });
        }
    }
}

/// The paths of all parameters of a selection.
pub(super) fn paths(scene: &Scene, selection: Selection) -> Vec<String> {
    texts(scene, selection).into_iter().map(|(path, _)| path).collect()
}

/// Path and value as TOML of every parameter of a selection.
pub(super) fn texts(scene: &Scene, selection: Selection) -> Vec<(String, String)> {
    collected(&mut scene.clone(), selection, false)
}

/// The same, of all parameters or of those that a scene file need not state.
fn collected(
    scene: &mut Scene,
    selection: Selection,
    only_optional: bool,
) -> Vec<(String, String)> {
    let names = Names::of(scene);
    let mut texts = Texts { prefix: String::new(), names: &names, only_optional, list: Vec::new() };
    visit(scene, selection, &mut texts);
    texts.list
}

struct Texts<'a> {
    prefix: String,
    names: &'a Names,
    only_optional: bool,
    list: Vec<(String, String)>,
}

impl Visit for Texts<'_> {
    fn leaf(&mut self, key: &'static str, need: Need, slot: Slot<'_>) {
        if !(self.only_optional && need.must_be_written()) {
            self.list.push((join(&self.prefix, key), slot.text(self.names)));
        }
    }

    fn group(&mut self, key: &str, _: Need, body: &mut dyn FnMut(&mut dyn Visit)) {
        let inner = join(&self.prefix, key);
        let outer = std::mem::replace(&mut self.prefix, inner);
        body(self);
        self.prefix = outer;
    }
}

/// The defaults of a selection's parameters, found when the first of them is asked for.
pub(super) struct Defaults {
    blank: Scene,
    selection: Selection,
    texts: OnceCell<HashMap<String, String>>,
}

impl Defaults {
    /// Of a thing of the same kind, shape, paint and bump.
    pub(super) fn new(scene: &Scene, selection: Selection) -> Defaults {
        let mut blank = Scene::default();
        let selection = match selection {
            Selection::Scene => {
                let mut keys = FirstKey::default();
                fields::background(&mut scene.background.clone(), &mut keys);
                blank.background = Background::named(keys.0.unwrap_or_default());
                blank.camera.lens = match scene.camera.lens {
                    Lens::Perspective { .. } => Lens::named("fov_degrees"),
                    Lens::Parallel { .. } => Lens::named("height"),
                };
                Selection::Scene
            }
            Selection::Light(i) => {
                let Light { name, place, .. } = &scene.lights[i];
                let place = LightPlace::of_kind(place.kind());
                blank.lights.push(Light { place, ..Light::new(name) });
                Selection::Light(0)
            }
            Selection::Material(i) => {
                let Material { name, paint, bump, .. } = &scene.materials[i];
                let paint = Paint::named(fields::texture_key(paint));
                let bump = Bump::named(fields::bump_key(bump));
                blank.materials.push(Material { paint, bump, ..Material::new(name) });
                Selection::Material(0)
            }
            Selection::Solid(i) => {
                let Solid { name, shape, .. } = &scene.solids[i];
                let shape = Shape::named(fields::shape_key(shape));
                blank.solids.push(Solid::new(name, shape, 0));
                Selection::Solid(0)
            }
        };
        Defaults { blank, selection, texts: OnceCell::new() }
    }

    /// The default of the parameter at a path; `None` if a scene file must state it.
    pub(super) fn get(&self, path: &str) -> Option<String> {
        let all = || collected(&mut self.blank.clone(), self.selection, true).into_iter().collect();
        self.texts.get_or_init(all).get(path).cloned()
    }
}

/// Notes the first key that it visits.
#[derive(Default)]
struct FirstKey(Option<&'static str>);

impl Visit for FirstKey {
    fn leaf(&mut self, key: &'static str, _: Need, _: Slot<'_>) {
        self.0 = self.0.or(Some(key));
    }

    fn group(&mut self, key: &str, _: Need, _: &mut dyn FnMut(&mut dyn Visit)) {
        let key = fields::BACKGROUNDS.iter().find(|known| **known == key);
        self.0 = self.0.or(key.copied());
    }
}

/// The thing of the same name in another scene; the whole scene if there is none.
pub(super) fn same_name(scene: &Scene, other: &Scene, selection: Selection) -> Selection {
    let found = match selection {
        Selection::Scene => Some(Selection::Scene),
        Selection::Light(i) => {
            let name = &scene.lights[i].name;
            other.lights.iter().position(|l| l.name == *name).map(Selection::Light)
        }
        Selection::Material(i) => {
            let name = &scene.materials[i].name;
            other.materials.iter().position(|m| m.name == *name).map(Selection::Material)
        }
        Selection::Solid(i) => {
            let name = &scene.solids[i].name;
            other.solids.iter().position(|s| s.name == *name).map(Selection::Solid)
        }
    };
    found.unwrap_or(Selection::Scene)
}

/// What is selected in a scene after an edit of which it is not known what it did: the thing of the
/// same name, or in the same place under a new name; the whole scene if it is gone.
pub(super) fn followed(before: &Scene, after: &Scene, selection: Selection) -> Selection {
    let name = |scene: &Scene| {
        let thing = selection.within(scene).thing()?;
        Some(thing.name(scene).to_owned())
    };
    let Some(old) = name(before) else { return selection.within(after) };
    let Some(new) = name(after) else { return same_name(before, after, selection) };
    let found = if old == new { selection } else { same_name(before, after, selection) };
    // A name that was another thing's is no new one.
    let is_renamed = || same_name(after, before, selection) == Selection::Scene;
    if found == Selection::Scene && is_renamed() { selection } else { found }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::color::Rgb;

    #[test]
    fn defaults_are_those_of_a_thing_of_the_same_kind() {
        let mut scene = Scene::default();
        let paint = Paint::Wood {
            a: Rgb::BLACK,
            b: Rgb::BLACK,
            size: 3.0,
            center: glam::DVec3::ONE,
            axis: glam::DVec3::X,
            turbulence: 9.0,
        };
        let matt = Material { diffuse: Rgb::grey(0.1), paint, ..Material::new("a b") };
        scene.materials = vec![Material::new("other"), matt];
        scene.lights = vec![Light { intensity: Rgb::grey(7.0), ..Light::new("key") }];
        scene.solids = vec![Solid::new("ball", Shape::named("cone"), 1)];
        let get = |selection, path| Defaults::new(&scene, selection).get(path);
        let wood = Selection::Material(1);
        assert_eq!(get(wood, "materials.\"a b\".diffuse").as_deref(), Some("0.7"));
        let turbulence = "materials.\"a b\".texture.wood.turbulence";
        assert_eq!(get(wood, turbulence).as_deref(), Some("0.5"));
        assert_eq!(get(wood, "materials.\"a b\".texture.wood.size"), None, "it must be stated");
        assert_eq!(get(Selection::Light(0), "lights.key.intensity").as_deref(), Some("1"));
        assert_eq!(get(Selection::Light(0), "lights.key.point"), None);
        assert_eq!(get(Selection::Solid(0), "solids.ball.cone.tip").as_deref(), Some("0"));
        assert_eq!(get(Selection::Scene, "camera.fov_degrees").as_deref(), Some("45"));
        assert_eq!(get(Selection::Scene, "background.color").as_deref(), Some("0"));
        scene.background = Background::named("gradient");
        let up = Defaults::new(&scene, Selection::Scene).get("background.gradient.up");
        assert_eq!(up.as_deref(), Some("[0, 0, 1]"));
    }

    #[test]
    fn what_is_selected_is_followed_by_its_name() {
        let scene = |names: &[&str]| {
            let solid = |name: &&str| Solid::new(*name, Shape::named("sphere"), 0);
            Scene { solids: names.iter().map(solid).collect(), ..Scene::default() }
        };
        let (all, some, other) = (scene(&["a", "b", "c"]), scene(&["a", "c"]), scene(&["a", "x"]));
        let solid = Selection::Solid;
        let cases = [
            (&all, &some, solid(2), solid(1), "one before it is gone"),
            (&some, &all, solid(1), solid(2), "one before it is back"),
            (&all, &some, solid(1), Selection::Scene, "it is gone, and another one is there"),
            (&all, &some, solid(0), solid(0), "what is behind it is gone"),
            (&some, &other, solid(1), solid(1), "it has another name"),
            (&all, &scene(&["a"]), solid(2), Selection::Scene, "it and others are gone"),
            (&all, &some, solid(7), Selection::Scene, "it never was"),
            (&all, &some, Selection::Scene, Selection::Scene, "the scene stays"),
        ];
        for (before, after, selection, expected, why) in cases {
            assert_eq!(followed(before, after, selection), expected, "{why}");
        }
    }
}
