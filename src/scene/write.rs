//! Writes a scene as text that reads back as the same value.

use std::collections::HashMap;

use super::fields::{self, LISTS, LOOK, LOOKS, Need, Visit};
use super::look::{Look, Setting};
use super::slot::Slot;
use super::toml_text::{bare_or_quoted, quoted};
use super::value::Names;
use super::{Light, Material, Scene, Shape, Solid};

/// The scene as TOML: what differs from the defaults, in a fixed order.
///
/// `read::text` gives back the same scene bit for bit, if it can find the same mesh files.
pub fn text(scene: &Scene) -> String {
    let nodes = tree(scene);
    let defaults = Defaults::new(&Names::of(scene));
    let mut out = "version = 1\n".to_owned();
    for node in &nodes {
        if let Content::Value(value) = &node.content
            && defaults.asks_for(&[], node)
        {
            out.push_str(&format!("{} = {value}\n", node.key));
        }
    }
    for node in &nodes {
        let Content::Table(children) = &node.content else { continue };
        if LISTS.contains(&node.key.as_str()) || node.key == LOOKS {
            for item in children {
                table(&[&node.key, &item.key], item, &defaults, &mut out);
            }
        } else if children.iter().any(|child| defaults.asks_for(&[&node.key], child)) {
            table(&[&node.key], node, &defaults, &mut out);
        }
    }
    out
}

/// What `body` visits, as the inside of an inline table: `center = [0, 0, 0], radius = 1`.
pub fn inline(names: &Names, body: &mut dyn FnMut(&mut dyn Visit)) -> String {
    line(&nodes(names, body))
}

/// Every value and table of a scene. Two scenes with equal trees are the same to the last bit, but for
/// what their mesh files held. Values are those without the worn look, which is named by the first
/// node; the looks are the last one, with a value per path.
pub(crate) fn tree(scene: &Scene) -> Vec<Node> {
    let names = Names::of(scene);
    let mut plain = scene.undressed();
    let mut all = nodes(&names, &mut |v| fields::scene(&mut plain, v));
    let node = |key: &str, content| Node { key: key.to_owned(), need: Need::Optional, content };
    if let Some(worn) = scene.looks.worn() {
        all.insert(0, node(LOOK, Content::Value(quoted(worn))));
    }
    if !scene.looks.list.is_empty() {
        let setting = |s: &Setting| node(&s.path, Content::Value(s.value.clone()));
        let look = |look: &Look| {
            node(&look.name, Content::Table(look.settings.iter().map(setting).collect()))
        };
        all.push(node(LOOKS, Content::Table(plain.looks.list.iter().map(look).collect())));
    }
    all
}

/// Writes an empty line, `[path]` and the lines below it.
pub(crate) fn table(path: &[&str], node: &Node, defaults: &Defaults, out: &mut String) {
    let header: Vec<String> = path.iter().map(|key| bare_or_quoted(key)).collect();
    out.push_str(&format!("\n[{}]\n", header.join(".")));
    let Content::Table(children) = &node.content else { return };
    for child in children.iter().filter(|child| defaults.asks_for(path, child)) {
        out.push_str(&format!("{} = {}\n", child.key, child.inline()));
    }
}

/// A visited value or table.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Node {
    pub(crate) key: String,
    pub(crate) need: Need,
    pub(crate) content: Content,
}

/// What a [`Node`] holds; a value is TOML.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Content {
    Value(String),
    Table(Vec<Node>),
}

impl Node {
    /// What stands behind the key; a table is written inline and whole.
    pub(crate) fn inline(&self) -> String {
        match &self.content {
            Content::Value(value) => value.clone(),
            Content::Table(children) => format!("{{ {} }}", line(children)),
        }
    }
}

fn line(nodes: &[Node]) -> String {
    let pairs = nodes.iter().map(|node| format!("{} = {}", node.key, node.inline()));
    pairs.collect::<Vec<_>>().join(", ")
}

/// Collects what it visits, in order.
struct Collect<'a> {
    names: &'a Names,
    nodes: Vec<Node>,
}

/// What `body` visits.
pub(crate) fn nodes(names: &Names, body: &mut dyn FnMut(&mut dyn Visit)) -> Vec<Node> {
    let mut collect = Collect { names, nodes: Vec::new() };
    body(&mut collect);
    collect.nodes
}

impl Visit for Collect<'_> {
    fn leaf(&mut self, key: &'static str, need: Need, slot: Slot<'_>) {
        let content = Content::Value(slot.text(self.names));
        self.nodes.push(Node { key: key.to_owned(), need, content });
    }

    fn group(&mut self, key: &str, need: Need, body: &mut dyn FnMut(&mut dyn Visit)) {
        let inside = nodes(self.names, body);
        // Where there is no bump, its table is not there either.
        if inside.is_empty() && !LISTS.contains(&key) {
            return;
        }
        let content = Content::Table(inside);
        self.nodes.push(Node { key: key.to_owned(), need, content });
    }
}

/// The text of every default value, by table and key; the table of a named thing is its list.
pub(crate) struct Defaults(HashMap<(String, String), String>);

impl Defaults {
    pub(crate) fn new(names: &Names) -> Defaults {
        let mut blank = Scene {
            lights: vec![Light::new("")],
            materials: vec![Material::new("")],
            solids: vec![Solid::new("", Shape::named("sphere"), 0)],
            ..Scene::default()
        };
        let mut texts = HashMap::new();
        for node in nodes(names, &mut |v| fields::scene(&mut blank, v)) {
            let Content::Table(children) = &node.content else {
                texts.insert((String::new(), node.key.clone()), node.inline());
                continue;
            };
            let named = LISTS.contains(&node.key.as_str());
            for child in children {
                match &child.content {
                    Content::Table(inner) if named => texts.extend(
                        inner.iter().map(|n| ((node.key.clone(), n.key.clone()), n.inline())),
                    ),
                    _ => {
                        texts.insert((node.key.clone(), child.key.clone()), child.inline());
                    }
                }
            }
        }
        Defaults(texts)
    }

    /// Whether `node` in the table `path` must be written.
    pub(crate) fn asks_for(&self, path: &[&str], node: &Node) -> bool {
        let table = path.first().map_or(String::new(), |key| (*key).to_owned());
        let default = self.0.get(&(table, node.key.clone()));
        node.need.must_be_written() || default != Some(&node.inline())
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use glam::DVec3;

    use super::*;
    use crate::color::Rgb;
    use crate::scene::filter::Filter;
    use crate::scene::tone::Tone;
    use crate::scene::{Background, Bump, Lens, LightPlace, Paint, read};

    /// Whether two scenes are the same to the last bit: `-0` is not `0`, unlike `==`.
    fn same_bits(a: &Scene, b: &Scene) -> bool {
        // `Debug` prints the shortest decimal of every number, with its sign
        a == b && format!("{a:?}") == format!("{b:?}")
    }

    /// Every variant, every field off its default, awkward numbers and names.
    fn everything() -> Scene {
        let mut scene = Scene { ambient_light: Rgb([0.1, 0.2, 0.3]), ..Scene::default() };
        scene.picture.size = [1280, 720];
        (scene.picture.exposure, scene.picture.tone) = (-1.3, Tone::Neutral);
        scene.camera.eye = DVec3::new(1e-7, -8.0, 1.0 / 3.0);
        scene.camera.target = DVec3::new(-0.0, 5e-324, 1e12);
        scene.camera.up = DVec3::new(0.1, 1.0, 0.0);
        scene.camera.lens = Lens::Parallel { height: 4.0 };
        scene.background = Background::Color(Rgb([0.0, -0.0, 1e-40]));
        scene.trace.samples = 4096;
        scene.trace.depth = 0;
        scene.trace.cutoff = 1e-9;
        scene.trace.filter = Filter::Mitchell;
        (scene.camera.focus, scene.camera.shutter) = (0.1, 1.0 / 3.0);
        scene.lights = vec![
            Light { place: LightPlace::Direction(DVec3::NEG_Y), on: false, ..Light::new("b.a") },
            Light { color: Rgb([1.0, 0.9, 0.8]), ..Light::new("a") },
        ];
        let paint = Paint::Checker { a: Rgb::grey(0.3), b: Rgb([1e6, 0.1, 0.7]), size: 0.1 };
        scene.materials = vec![
            Material { paint, ior: 1.0 / 1.5, ..Material::new("my \"tiles\"") },
            Material::new(""),
            Material { paint: Paint::Solid(Rgb([0.1; 3])), ..Material::new("glass") },
        ];
        for key in fields::TEXTURES.iter().filter(|key| **key != "image") {
            let bump = Bump::named(fields::BUMPS[scene.materials.len() % 2]);
            scene.materials.push(Material {
                paint: Paint::named(key),
                bump,
                ..Material::new(*key)
            });
        }
        scene.materials[2].reflect = Rgb::grey(f32::from_bits(0x3dcc_cccc));
        scene.materials[2].metallic = 0.5;
        for (index, key) in fields::SHAPES.iter().enumerate().filter(|(_, key)| **key != "mesh") {
            let shape = Shape::named(key);
            let material = if shape.is_composite() { 0 } else { index % 3 };
            let mut solid = Solid::new(format!("solid {key}"), shape, material);
            solid.placement.translate.x = index as f64 * 0.1;
            if *key != "plane" {
                solid.motion.rotate_degrees.y = index as f64 * 7.7;
            }
            solid.placement.scale = DVec3::new(1.0, 1.0, 1.0 + index as f64);
            scene.solids.push(solid);
        }
        scene
    }

    #[test]
    fn a_scene_with_everything_comes_back_bit_for_bit() {
        let scene = everything();
        let written = text(&scene);
        let back = read::text(&written, Path::new("s.toml")).unwrap_or_else(|e| panic!("{e}"));
        assert!(same_bits(&scene, &back), "{written}");
        assert_eq!(text(&back), written);
    }

    #[test]
    fn the_comparison_sees_the_last_bit_and_the_sign_of_zero() {
        let scene = everything();
        let mut other = everything();
        assert!(same_bits(&scene, &other));
        other.camera.eye.z = other.camera.eye.z.next_up();
        assert!(!same_bits(&scene, &other));
        let mut other = everything();
        other.camera.target.x = 0.0;
        assert!(scene == other && !same_bits(&scene, &other));
        other.camera.target.x = -0.0;
        other.background = Background::Color(Rgb([0.0, 0.0, 1e-40]));
        assert!(!same_bits(&scene, &other));
    }

    #[test]
    fn only_what_differs_from_the_defaults_is_written() {
        assert_eq!(text(&Scene::default()), "version = 1\n");
        let mut scene = Scene {
            lights: vec![Light::new("key")],
            materials: vec![Material::new("plain")],
            solids: vec![Solid::new("ball", Shape::named("sphere"), 0)],
            ..Scene::default()
        };
        scene.trace.depth = 3;
        scene.lights[0].intensity = Rgb::grey(0.5);
        let expected = "version = 1\n\n[trace]\ndepth = 3\n\n[lights.key]\npoint = [0, 0, 0]\n\
                        intensity = 0.5\n\n[materials.plain]\n\n[solids.ball]\n\
                        sphere = { center = [0, 0, 0], radius = 1 }\nmaterial = \"plain\"\n";
        assert_eq!(text(&scene), expected);
    }
}
