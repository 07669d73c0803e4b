//! Tests of saving: random edits of scenes in every spelling that TOML allows.

use std::collections::HashMap;
use std::path::Path;
use std::sync::Arc;

use glam::DVec3;

use super::history::same_bits;
use super::looks::follow;
use super::patch::patch;
use crate::color::Rgb;
use crate::scene::mesh::Mesh;
use crate::scene::path::{Parameter, parameters, set};
use crate::scene::range::Kind;
use crate::scene::read::{Known, text_with};
use crate::scene::write::{self, tree};
use crate::scene::{Area, Lens, Light, LightPlace, Material, Paint, Scene, Shape, Solid};
use crate::scene::{check, fields};

/// SplitMix64.
struct Random(u64);

impl Random {
    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ self.0 >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ z >> 31
    }

    fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1u64 << 53) as f64
    }

    fn below(&mut self, count: usize) -> usize {
        (self.unit() * count as f64) as usize
    }
}

/// Headers with spaces, dotted keys, inline tables, quoted names, odd numbers, comments everywhere.
const NASTY: &str = r##"# one
  version   =   1 # two
ambient_light = [ 1.0, +1.00, # three
  1e0 ]   # four
camera . eye = [
  0, # x, "quoted"
  -6.4, # y
  0x10, # z
] # five
"camera".'target' = [0,0,0]
picture = { size = [ 64 , 48 ], exposure=-0.0 } # six
trace.samples = 4

# seven
[ lights ] # eight
  key.point = [ -5, -6, 9 ] # nine
  key.intensity = 0.50
  # ten
  "a.b" = { direction = [0, 0, -1], on = false } # eleven
  'ü "x"' = { point = [
     1, # twelve
     2, 3,
  ], color = [1, 1, 1] }

# thirteen

# fourteen
[materials."my tiles".texture.checker] # fifteen
a = [0.9, 0.8, 0.7]
b = 0.1
# sixteen
size = 2
[materials.glass]
# seventeen
	transmit = 0.85	# eighteen
# nineteen

[materials]
plain = {} # twenty
"a.b" = { color.x = 1 }
[solids . ball]
sphere.center = [0, 0, 0]
sphere.radius = 1
material = 'my tiles' # twenty-one
[solids.ball-2.sphere]
center = [0, 0, 0]
radius = 1_0
[solids.ball-2]
material = """glass"""
scale = 2
[solids.sheet]
polygon = { points = [ # twenty-two
  [0, 0, 0], # twenty-three
  [1, 0, 0],
  [1, 1, 0], [0, 1, 0], # twenty-four
] }
material = "plain" # twenty-five
[solids.model]
mesh = { file = 'a b.obj' } # twenty-six
material = "a.b"
# the end"##;

/// All in inline tables, over several lines.
const INLINE: &str = r##"version = 1 # one
lights = { key = { point = [0, 0, 5] }, fill = { point = [0, 5, 5], on = true, }, }
materials = {
  red = { color = [1, 0, 0] }, # two
  # three
  tiles = { texture = { checker = { a = 1, b = 0, size = 1 } } , ior = 1.5 } # four
}
solids.ball = { sphere = { center = [0, 0, 0], radius = 1 }, material = "red" } # five
solids.box = { box = { min = [0, 0, 0], max = [1, 1, 1] }, material = "tiles" }
# six
"##;

/// Nothing to speak of.
const BARE: &str = "# only this\nversion = 1";

fn nasty() -> String {
    NASTY.replace("color.x = 1", "color = 1")
}

fn texts() -> Vec<String> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    let mut files: Vec<_> = std::fs::read_dir(folder).unwrap().map(|e| e.unwrap().path()).collect();
    files.sort();
    let mut texts: Vec<String> =
        files.iter().map(|file| std::fs::read_to_string(file).unwrap()).collect();
    texts.extend(super::TEMPLATES.iter().map(|(_, text)| (*text).to_owned()));
    texts.extend([nasty(), INLINE.to_owned(), BARE.to_owned()]);
    texts.push(nasty().replace('\n', "\r\n"));
    texts.push(format!("\u{feff}{}", INLINE.replace('\n', "\r\n")));
    texts
}

fn read(text: &str) -> Scene {
    let meshes = [("a b.obj".to_owned(), Arc::new(Mesh::default()))].into();
    let known = Known { meshes, ..Known::default() };
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/s.toml");
    text_with(text, &file, known).unwrap_or_else(|error| panic!("{error}\n{text}"))
}

/// The text of the edited scene, which must read back as that scene.
fn saved(text: &str, old: &Scene, new: &Scene) -> String {
    let patched = patch(text, old, new);
    let wanted = write::text(new);
    assert!(!patched.comments_lost, "{text}\n--- had to be written anew as ---\n{wanted}");
    let back = read(&patched.text);
    assert!(same_bits(&back, new) && tree(&back) == tree(new), "{}", patched.text);
    let newlines = |text: &str| (text.matches("\r\n").count(), text.matches('\n').count());
    let (with_return, all) = newlines(&patched.text);
    assert!(with_return == if newlines(text).0 > 0 { all } else { 0 }, "mixed ends of lines");
    assert_eq!(text.starts_with('\u{feff}'), patched.text.starts_with('\u{feff}'));
    patched.text
}

/// What follows the `#` of every line; no string of these texts has one.
fn comments(text: &str) -> Vec<&str> {
    text.lines().filter_map(|line| line.split_once('#').map(|(_, comment)| comment)).collect()
}

/// Lines of `old` that are not in `new`, counted.
fn lines_lost(old: &str, new: &str) -> usize {
    let mut left: HashMap<&str, usize> = HashMap::new();
    for line in new.split_inclusive('\n') {
        *left.entry(line.trim_end_matches(['\n', '\r'])).or_default() += 1;
    }
    let lines = old.split_inclusive('\n').map(|line| line.trim_end_matches(['\n', '\r']));
    let lost = |line: &str| match left.get_mut(line) {
        Some(count) if *count > 0 => {
            *count -= 1;
            false
        }
        _ => true,
    };
    lines.map(lost).filter(|lost| *lost).count()
}

fn random_value(parameter: &Parameter, scene: &Scene, random: &mut Random) -> String {
    let mut number = || match random.below(4) {
        0 => "0.5".to_owned(),
        1 => "-0.0".to_owned(),
        2 => "1".to_owned(),
        _ => format!("{}", random.unit() * 2.0 - 0.3),
    };
    match parameter.kind {
        Kind::Coefficient => match number().as_str() {
            "1" => "1".to_owned(),
            x => format!("[{x}, {}, 0.25]", number()),
        },
        Kind::Number => number(),
        Kind::Whole => random.below(9).to_string(),
        Kind::Pair => format!("[{}, {}]", 1 + random.below(9), 2 + random.below(300)),
        Kind::Flag => (random.below(2) == 0).to_string(),
        Kind::Vector | Kind::Scale => format!("[{}, {}, {}]", number(), number(), number()),
        Kind::Points => match random.below(3) {
            0 => "[[0, 0, 0], [1, 0, 0], [1, 2, 0]]".to_owned(),
            1 => "[[0, 0, 0], [1, 0, 0], [1, 1, 0], [0.5, 2, 0], [0, 1, 0]]".to_owned(),
            _ => parameter.value.replace("[1", "[3"),
        },
        Kind::Loops => match random.below(3) {
            0 => "[[0, 0], [1, 0], [1, 2]]".to_owned(),
            1 => "[[[0, 0], [9, 0], [9, 9], [0, 9]], [[1, 1], [2, 1], [2, 2]]]".to_owned(),
            _ => parameter.value.replace("[1", "[3"),
        },
        Kind::Choice(names) => names[random.below(names.len())].to_owned(),
        Kind::Material => scene.materials[random.below(scene.materials.len())].name.clone(),
        Kind::Solids => match random.below(2) {
            0 => format!("[\"{}\"]", scene.solids[random.below(scene.solids.len())].name),
            _ => parameter.value.clone(),
        },
        Kind::File => parameter.value.clone(),
    }
}

/// A shape that reads no file and is not made of others, which have no material to write.
fn some_shape(random: &mut Random) -> Shape {
    let plain = |key: &&&str| **key != "mesh" && !Shape::named(key).is_composite();
    let keys: Vec<&&str> = fields::SHAPES.iter().filter(plain).collect();
    Shape::named(keys[random.below(keys.len())])
}

/// Gives the operands of all solids other numbers.
fn renumber(scene: &mut Scene, number: impl Fn(usize) -> usize) {
    for solid in &mut scene.solids {
        if let Shape::Csg { operation: _, operands } = &mut solid.shape {
            operands.iter_mut().for_each(|operand| *operand = number(*operand));
        }
    }
}

/// Sets some random parameter to some value that it may have.
fn edit(scene: &mut Scene, random: &mut Random) {
    let list = parameters(scene);
    let parameter = &list[random.below(list.len())];
    let value = random_value(parameter, scene, random);
    // refused values change nothing
    let _ = set(scene, &parameter.path, &value);
}

#[test]
fn edits_of_values_touch_their_lines_only_and_keep_every_comment() {
    let mut random = Random(1);
    for text in texts() {
        let scene = read(&text);
        assert_eq!(patch(&text, &scene, &scene).text, text);
        for round in 0..60 {
            let mut edited = scene.clone();
            let edits = 1 + round % 4;
            for _ in 0..edits {
                edit(&mut edited, &mut random);
            }
            let new = saved(&text, &scene, &edited);
            let kept = comments(&new);
            for comment in comments(&text) {
                assert!(kept.contains(&comment), "`{comment}` is gone:\n{new}");
            }
            // a value of this many lines: the points and a camera's coordinates
            let most = if text.contains("polygon") { edits * 6 } else { edits };
            assert!(lines_lost(&text, &new) <= most, "{text}\n---\n{new}");
        }
    }
}

/// One change of names, numbers of things, order or variants.
fn restructure(scene: &mut Scene, random: &mut Random) {
    let name = format!("new.{} \"ö\"", random.below(100));
    let light = random.below(scene.lights.len() + 1);
    let material = random.below(scene.materials.len() + 1);
    let solid = random.below(scene.solids.len() + 1);
    let some = |count: usize, index: usize| index.min(count.saturating_sub(1));
    match random.below(13) {
        0 => scene.lights.insert(light, Light { on: false, ..Light::new(name) }),
        1 if light < scene.lights.len() => drop(scene.lights.remove(light)),
        2 if light < scene.lights.len() => scene.lights[light].name = name,
        3 if light < scene.lights.len() => {
            scene.lights[light].place = match scene.lights[light].place {
                LightPlace::Point(_) => LightPlace::Direction(DVec3::new(0.1, -0.0, 1.0)),
                LightPlace::Direction(_) => LightPlace::named("spot"),
                LightPlace::Spot { .. } => LightPlace::named("area"),
                LightPlace::Area(Area::Rectangle { .. }) => LightPlace::of_kind("disc"),
                LightPlace::Area(Area::Disc { .. }) => LightPlace::of_kind("sphere"),
                LightPlace::Area(Area::Sphere { .. }) => LightPlace::Point(DVec3::X),
            };
        }
        4 => insert_material(scene, material, Material { ior: 1.25, ..Material::new(name) }),
        5 if material < scene.materials.len() => scene.materials[material].name = name,
        6 if material < scene.materials.len() => {
            let paint = &mut scene.materials[material].paint;
            *paint = match paint {
                Paint::Solid(_) => Paint::named("texture"),
                Paint::Checker { .. } if random.below(2) == 0 => Paint::Solid(Rgb::WHITE),
                Paint::Checker { .. } => Paint::named(fields::TEXTURES[1 + random.below(3)]),
                _ => Paint::Solid(Rgb([0.1, 0.2, 0.3])),
            };
        }
        7 if !scene.materials.is_empty() => {
            let index = some(scene.materials.len(), material);
            let shape = some_shape(random);
            scene.solids.insert(solid, Solid::new(name, shape, index));
            renumber(scene, |i| i + usize::from(i >= solid));
        }
        8 if solid < scene.solids.len() && !scene.is_operand()[solid] => {
            scene.solids.remove(solid);
            renumber(scene, |i| i - usize::from(i > solid));
        }
        9 if solid < scene.solids.len() => scene.solids[solid].name = name,
        10 if solid < scene.solids.len() && !scene.solids[solid].shape.is_composite() => {
            scene.solids[solid].shape = some_shape(random);
        }
        11 => {
            scene.camera.lens = match scene.camera.lens {
                Lens::Perspective { .. } => Lens::Parallel { height: 3.5 },
                Lens::Parallel { .. } => Lens::Perspective { fov_degrees: 45.0 },
            };
        }
        _ => edit(scene, random),
    }
}

fn insert_material(scene: &mut Scene, at: usize, material: Material) {
    scene.materials.insert(at, material);
    for solid in scene.solids.iter_mut().filter(|solid| !solid.shape.is_composite()) {
        solid.material += usize::from(solid.material >= at);
    }
}

#[test]
fn things_are_added_removed_renamed_and_changed_in_kind() {
    let mut random = Random(2);
    for text in texts() {
        let scene = read(&text);
        for round in 0..60 {
            let mut edited = scene.clone();
            for _ in 0..1 + round % 5 {
                let before = edited.clone();
                restructure(&mut edited, &mut random);
                follow(&before, &mut edited);
            }
            if check::validate(&edited).is_empty() {
                let new = saved(&text, &scene, &edited);
                // and back: what was removed is written anew
                saved(&new, &edited, &scene);
            }
        }
    }
}

#[test]
fn things_change_places_with_their_comments() {
    let mut random = Random(3);
    for text in texts() {
        let scene = read(&text);
        // one of the spellings has a solid in two pieces and a list half in pairs, half in blocks
        let [materials, solids] = [text.contains("fourteen"), text.contains("ball-2.sphere")];
        for _ in 0..10 {
            let mut edited = scene.clone();
            if edited.lights.len() > 1 {
                let index = random.below(edited.lights.len());
                edited.lights.rotate_left(index);
            }
            if edited.solids.len() > 1 && !solids {
                let index = random.below(edited.solids.len());
                edited.solids.swap(0, index);
                renumber(&mut edited, |i| match i {
                    0 => index,
                    i if i == index => 0,
                    i => i,
                });
            }
            if edited.materials.len() > 1 && !materials {
                edited.materials.swap(0, 1);
                for solid in edited.solids.iter_mut().filter(|s| !s.shape.is_composite()) {
                    solid.material = [1, 0].get(solid.material).copied().unwrap_or(solid.material);
                }
            }
            follow(&scene, &mut edited);
            let new = saved(&text, &scene, &edited);
            let (mut old, mut new) = (comments(&text), comments(&new));
            old.sort_unstable();
            new.sort_unstable();
            assert_eq!(old, new);
        }
    }
}

#[test]
fn what_cannot_be_edited_in_place_is_written_anew_and_said() {
    let text = nasty();
    let scene = read(&text);
    let mut edited = scene.clone();
    edited.materials.swap(0, 2);
    let patched = patch(&text, &scene, &edited);
    assert!(patched.comments_lost);
    assert!(same_bits(&read(&patched.text), &edited));
}
