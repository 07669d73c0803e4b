//! Rules that tie several numbers of a scene together: whether every camera, box and polygon makes sense.

use std::collections::HashSet;

use glam::DVec3;

use super::csg;
use super::direction::{TINY, unit};
use super::fields::{self, Need, Visit};
use super::light::MOST_LIGHT_RAYS;
use super::outline;
use super::slot::Slot;
use super::toml_text::number;
use super::value::Names;
use super::{
    Area, Background, Camera, Lens, Light, LightPlace, MAX_KNOT_FACES, MAX_NAMED, MAX_PIXELS,
    Material, Paint, Picture, Scene, Shape, Solid,
};

/// Sine of the smallest angle between the view and `up`.
const PARALLEL: f64 = 1e-9;
/// Largest distance of a polygon's corner from its plane, as a share of the polygon's extent.
const FLAT: f64 = 1e-9;
/// Smallest area of a polygon, as a share of the square of its extent.
const AREA: f64 = 1e-12;

/// Something in a scene that makes no sense.
#[derive(Clone, Debug, PartialEq)]
pub struct Flaw {
    /// The keys that lead to it, from the root of the scene file.
    pub path: Vec<String>,
    /// What is wrong, one line.
    pub message: String,
    /// A way out, one line.
    pub help: String,
}

impl Flaw {
    pub(super) fn new(path: &[&str], message: impl Into<String>, help: impl Into<String>) -> Flaw {
        let path = path.iter().map(|key| (*key).to_owned()).collect();
        Flaw { path, message: message.into(), help: help.into() }
    }
}

/// Everything wrong with a scene, ranges included; empty for every scene that was read from a file.
pub fn validate(scene: &Scene) -> Vec<Flaw> {
    let names = Names::of(scene);
    let mut ranges =
        Ranges { path: Vec::new(), names, count: scene.materials.len(), flaws: Vec::new() };
    fields::scene(&mut scene.clone(), &mut ranges);
    ranges.flaws.extend(relations(scene));
    ranges.flaws
}

/// What is wrong with a scene whose numbers all keep to their ranges.
pub fn relations(scene: &Scene) -> Vec<Flaw> {
    let mut flaws = Vec::new();
    flaws.extend(too_many("lights", scene.lights.iter().map(|light| &light.name)));
    flaws.extend(too_many("materials", scene.materials.iter().map(|material| &material.name)));
    flaws.extend(twice("lights", scene.lights.iter().map(|light| &light.name)));
    flaws.extend(twice("materials", scene.materials.iter().map(|material| &material.name)));
    flaws.extend(twice("solids", scene.solids.iter().map(|solid| &solid.name)));
    flaws.extend(camera(&scene.camera));
    flaws.extend(picture(&scene.picture));
    flaws.extend(background(&scene.background));
    flaws.extend(scene.lights.iter().filter_map(light));
    flaws.extend(too_many_rays(scene));
    flaws.extend(scene.materials.iter().filter_map(material));
    flaws.extend(scene.solids.iter().filter_map(solid));
    flaws.extend(csg::flaws(scene));
    flaws
}

fn too_many<'a>(list: &str, mut names: impl Iterator<Item = &'a String>) -> Option<Flaw> {
    let name = names.nth(MAX_NAMED)?;
    let message = format!("there are more than {MAX_NAMED} {list}");
    Some(Flaw::new(&[list, name], message, "let several solids share, or leave some out"))
}

fn twice<'a>(list: &str, mut names: impl Iterator<Item = &'a String>) -> Option<Flaw> {
    let mut seen = HashSet::new();
    let name = names.find(|name| !seen.insert(*name))?;
    let message = format!("two {list} have the name `{name}`");
    Some(Flaw::new(&[list, name], message, "rename one of them"))
}

fn camera(camera: &Camera) -> Option<Flaw> {
    let Camera { eye, target, up, lens, aperture, focus: _, shutter: _ } = camera;
    if matches!(lens, Lens::Parallel { .. }) && *aperture > 0.0 {
        let message = "a parallel view has no lens: its `aperture` is 0";
        let help = "leave `aperture` out, or write `fov_degrees` in place of `height`";
        return Some(Flaw::new(&["camera", "aperture"], message, help));
    }
    let Some(view) = unit(*target - *eye) else {
        let message = "`target` is where `eye` is: the camera looks nowhere";
        return Some(Flaw::new(&["camera", "target"], message, "move one of the two"));
    };
    let help = if view.cross(DVec3::Z).length() > 0.5 { "[0, 0, 1]" } else { "[0, 1, 0]" };
    let help = format!("for example `up = {help}`");
    let Some(up) = unit(*up) else {
        return Some(Flaw::new(&["camera", "up"], "`up` is zero, which is no direction", help));
    };
    let parallel = view.cross(up).length() <= PARALLEL;
    let message = "`up` is parallel to the view from `eye` to `target`";
    parallel.then(|| Flaw::new(&["camera", "up"], message, help))
}

fn picture(picture: &Picture) -> Option<Flaw> {
    let [width, height] = picture.size.map(u64::from);
    let message =
        format!("a picture of {width} × {height} pixels is too large: at most {MAX_PIXELS} pixels");
    let help = "for example `size = [16384, 16384]`";
    (width * height > MAX_PIXELS).then(|| Flaw::new(&["picture", "size"], message, help))
}

fn background(background: &Background) -> Option<Flaw> {
    let Background::Gradient { up, .. } = background else { return None };
    let message = "`up` is zero, which is no direction";
    let help = "give the direction of `above`, for example `up = [0, 0, 1]`";
    unit(*up).is_none().then(|| Flaw::new(&["background", "gradient", "up"], message, help))
}

fn material(material: &Material) -> Option<Flaw> {
    let (key, message, help) = match &material.paint {
        Paint::Gradient { from, to, .. } if unit(*to - *from).is_none() => {
            ("to", "`to` is where `from` is: the gradient has no length", "move one of the two")
        }
        Paint::Marble { direction, .. } if unit(*direction).is_none() => {
            let help = "give the direction across the veins, for example `direction = [1, 0, 0]`";
            ("direction", "`direction` is zero, which is no direction", help)
        }
        Paint::Wood { axis, .. } if unit(*axis).is_none() => {
            let help = "give the direction of the trunk, for example `axis = [0, 0, 1]`";
            ("axis", "`axis` is zero, which is no direction", help)
        }
        _ => return None,
    };
    let pattern = fields::texture_key(&material.paint);
    Some(Flaw::new(&["materials", &material.name, "texture", pattern, key], message, help))
}

fn light(light: &Light) -> Option<Flaw> {
    let name = light.name.as_str();
    match light.place {
        LightPlace::Direction(along) if unit(along).is_none() => {
            let help = "give the direction in which the light shines, for example \
                        `direction = [0, 0, -1]`";
            let message = "`direction` is zero, which is no direction";
            Some(Flaw::new(&["lights", name, "direction"], message, help))
        }
        LightPlace::Spot { at, towards, .. } if unit(towards - at).is_none() => {
            let message = "`towards` is where `at` is: the light shines nowhere";
            Some(Flaw::new(&["lights", name, "spot", "towards"], message, "move one of the two"))
        }
        LightPlace::Area(Area::Disc { normal, .. }) if unit(normal).is_none() => {
            let help = "give a direction that stands on the disc, for example `normal = [0, 0, 1]`";
            let path = ["lights", name, "area", "disc", "normal"];
            Some(Flaw::new(&path, "`normal` is zero, which is no direction", help))
        }
        _ => None,
    }
}

/// Lights that take more rays than a point or a pixel can count.
fn too_many_rays(scene: &Scene) -> Option<Flaw> {
    let camera = u64::from(scene.trace.samples);
    let mut sum = 0;
    scene.lights.iter().find_map(|light| {
        let rays = u64::from(light.rays());
        sum += rays;
        let path = ["lights", &light.name, "samples"];
        let message = if rays > 1 && rays * camera > MOST_LIGHT_RAYS {
            format!(
                "{camera} camera rays with {rays} rays to this light each are too many: at most \
                 {MOST_LIGHT_RAYS} together"
            )
        } else if rays > 1 && sum > MOST_LIGHT_RAYS {
            format!("all lights take {sum} rays together: at most {MOST_LIGHT_RAYS}")
        } else {
            return None;
        };
        Some(Flaw::new(&path, message, "take fewer `samples`"))
    })
}

fn solid(solid: &Solid) -> Option<Flaw> {
    if matches!(solid.shape, Shape::Plane { .. }) && !solid.motion.is_none() {
        let message = "a plane has no end and stands still";
        let help = "leave `motion` out, or make it a box, which moves";
        return Some(Flaw::new(&["solids", &solid.name, "motion"], message, help));
    }
    let (key, message, help) = shape(&solid.shape)?;
    let path = ["solids", &solid.name, fields::shape_key(&solid.shape), key];
    Some(Flaw::new(&path, message, help))
}

/// Key, message and way out of what is wrong with a shape.
fn shape(shape: &Shape) -> Option<(&'static str, String, String)> {
    match shape {
        Shape::Plane { normal, .. } => unit(*normal).is_none().then(|| {
            let help = "give the direction out of the solid, for example `normal = [0, 0, 1]`";
            ("normal", "`normal` is zero, which is no direction".to_owned(), help.to_owned())
        }),
        Shape::Box { min, max } => boxed(*min, *max),
        Shape::Polygon { points } => {
            polygon(points).map(|(message, help)| ("points", message, help))
        }
        Shape::Knot { turns, tube: _, segments } => knot(*turns, *segments),
        Shape::Cylinder { from, to, radius: _ } | Shape::Cone { from, to, radius: _, tip: _ } => {
            unit(*to - *from).is_none().then(|| {
                let message = "`to` is where `from` is: the solid has no length";
                ("to", message.to_owned(), "move one of the two".to_owned())
            })
        }
        Shape::Quadric { squares, products, linear, constant: _, min, max } => {
            let flat = [squares, products, linear].iter().all(|c| **c == DVec3::ZERO);
            let message = "all coefficients but `constant` are zero: there is no surface";
            let help = "for example `squares = [1, 1, -1]`";
            let none = flat.then(|| ("squares", message.to_owned(), help.to_owned()));
            none.or_else(|| boxed(*min, *max))
        }
        Shape::Prism { outline, bottom, top } => {
            let (low, high) = (number(*bottom), number(*top));
            let message = format!("`top` must exceed `bottom`; they are {high} and {low}");
            let help = "exchange or move them".to_owned();
            let flat = (bottom >= top).then_some(("top", message, help));
            flat.or_else(|| outline::flaw(outline).map(|(what, how)| ("outline", what, how)))
        }
        Shape::Sphere { .. }
        | Shape::Torus { .. }
        | Shape::Ellipsoid { .. }
        | Shape::Mesh { .. }
        | Shape::Sphereflake { .. }
        | Shape::Csg { .. } => None,
    }
}

fn boxed(min: DVec3, max: DVec3) -> Option<(&'static str, String, String)> {
    let axis = (0..3).find(|&axis| min[axis] >= max[axis])?;
    let (low, high) = (number(min[axis]), number(max[axis]));
    let name = ["x", "y", "z"][axis];
    let message =
        format!("`max` must exceed `min` on every axis; on {name} they are {high} and {low}");
    Some(("max", message, "exchange or move the corners".to_owned()))
}

fn polygon(points: &[DVec3]) -> Option<(String, String)> {
    let Some((&first, rest)) = points.split_first().filter(|(_, rest)| rest.len() >= 2) else {
        let message = format!("a polygon needs at least 3 points, this one has {}", points.len());
        return Some((message, "add points, in order around the edge".to_owned()));
    };
    let extent = rest.iter().map(|&p| (p - first).abs().max_element()).fold(0.0, f64::max);
    let corners: Vec<DVec3> =
        points.iter().map(|&p| (p - first) / extent.max(f64::MIN_POSITIVE)).collect();
    // Newell: twice the area, along the normal
    let turn = |(a, b): (&DVec3, &DVec3)| a.cross(*b);
    let doubled: DVec3 = corners.iter().zip(corners.iter().cycle().skip(1)).map(turn).sum();
    if extent < TINY || doubled.length() <= 2.0 * AREA {
        let help = "move its points apart, in order around the edge";
        return Some(("the polygon has no area".to_owned(), help.to_owned()));
    }
    let normal = doubled.normalize();
    let off = |corner: &DVec3| corner.dot(normal).abs();
    let index = (0..corners.len()).find(|&i| off(&corners[i]) > FLAT)?;
    let distance = number((off(&corners[index]) * extent) as f32);
    let message =
        format!("the polygon is not flat: point {} lies {distance} off its plane", index + 1);
    Some((message, "split it into triangles, or move the point".to_owned()))
}

fn knot(turns: [u32; 2], segments: [u32; 2]) -> Option<(&'static str, String, String)> {
    let [p, q] = turns;
    if common_divisor(p, q) != 1 {
        let divisor = common_divisor(p, q);
        let message =
            format!("`turns` must have no common divisor; {p} and {q} have {divisor} in common");
        return Some(("turns", message, "for example `turns = [2, 3]`".to_owned()));
    }
    let [along, around] = segments.map(u64::from);
    let message = format!(
        "a knot of {along} × {around} segments is too large: at most {MAX_KNOT_FACES} together"
    );
    let help = "for example `segments = [400, 100]`".to_owned();
    (along * around > MAX_KNOT_FACES).then_some(("segments", message, help))
}

fn common_divisor(a: u32, b: u32) -> u32 {
    if b == 0 { a } else { common_divisor(b, a % b) }
}

/// Holds every number to its range.
struct Ranges {
    path: Vec<String>,
    names: Names,
    count: usize,
    flaws: Vec<Flaw>,
}

impl Visit for Ranges {
    fn leaf(&mut self, key: &'static str, _: Need, slot: Slot<'_>) {
        let dangling = || match &slot {
            Slot::Material(index) if **index >= self.count => Some((
                format!("there is no material number {index}"),
                "choose a material of the scene".to_owned(),
            )),
            _ => None,
        };
        if let Some((message, help)) = slot.fault(key, &self.names).or_else(dangling) {
            let mut path = self.path.clone();
            path.push(key.to_owned());
            self.flaws.push(Flaw { path, message, help });
        }
    }

    fn group(&mut self, key: &str, _: Need, body: &mut dyn FnMut(&mut dyn Visit)) {
        self.path.push(key.to_owned());
        body(self);
        self.path.pop();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::color::Rgb;
    use crate::scene::Material;

    #[test]
    fn the_default_scene_is_valid_and_every_default_shape_too() {
        let mut scene = Scene { materials: vec![Material::new("m")], ..Scene::default() };
        for key in fields::SHAPES {
            scene.solids.push(Solid::new(*key, Shape::named(key), 0));
        }
        assert_eq!(validate(&scene), []);
    }

    #[test]
    fn validate_finds_ranges_relations_and_dangling_materials() {
        let background = Background::Color(Rgb([0.0, -1.0, 0.0]));
        let mut scene = Scene { background, ..Scene::default() };
        scene.camera.eye = scene.camera.target;
        scene.solids.push(Solid::new("ball", Shape::named("sphere"), 3));
        scene.lights = vec![Light::new("a"), Light::new("b"), Light::new("a")];
        let flaws = validate(&scene);
        let paths: Vec<String> = flaws.iter().map(|flaw| flaw.path.join(".")).collect();
        assert_eq!(
            paths,
            ["background.color", "solids.ball.material", "lights.a", "camera.target"]
        );
        assert_eq!(flaws[0].message, "`color` is -1, out of its range: 0 to 1e6");
        assert_eq!(flaws[0].help, "the nearest allowed value is 0");
    }

    #[test]
    fn solids_without_an_inside_are_refused() {
        let of = |s: Shape| shape(&s).map(|(key, message, _)| (key, message));
        let (from, radius) = (DVec3::ONE, 1.0);
        let rod = of(Shape::Cylinder { from, to: from, radius }).unwrap();
        assert_eq!(rod, ("to", "`to` is where `from` is: the solid has no length".to_owned()));
        assert_eq!(of(Shape::Cone { from, to: from, radius, tip: 0.0 }).unwrap().0, "to");
        let Shape::Quadric { products, linear, constant, min, max, .. } = Shape::named("quadric")
        else {
            panic!()
        };
        let squares = DVec3::ZERO;
        let none = of(Shape::Quadric { squares, products, linear, constant, min, max }).unwrap();
        assert_eq!(none.0, "squares");
        let squares = DVec3::ONE;
        let (min, max) = (max, min);
        let inverted = of(Shape::Quadric { squares, products, linear, constant, min, max });
        assert_eq!(inverted.unwrap().0, "max");
        let Shape::Prism { outline, bottom, top } = Shape::named("prism") else { panic!() };
        let (top, bottom) = (bottom, top);
        let inverted = of(Shape::Prism { outline, bottom, top }).unwrap();
        assert_eq!(inverted.1, "`top` must exceed `bottom`; they are 0 and 1");
        let outline =
            vec![[[0., 0.], [2., 2.], [2., 0.], [0., 3.]].map(glam::DVec2::from).to_vec()];
        let crossed = of(Shape::Prism { outline, bottom: 0.0, top: 1.0 }).unwrap();
        assert_eq!(crossed.0, "outline");
        assert_eq!(crossed.1, "the outline crosses itself: edge 1 meets edge 3");
    }

    #[test]
    fn polygons_are_flat_relative_to_their_extent() {
        let square = |lift: f64, size: f64| {
            let corners = [[0., 0., 0.], [1., 0., 0.], [1., 1., lift], [0., 1., 0.]];
            polygon(&corners.map(|c| DVec3::from(c) * size)).map(|(message, _)| message)
        };
        for size in [1e-9, 1.0, 1e9] {
            assert_eq!(square(0.0, size), None);
            assert_eq!(square(1e-10, size), None);
            assert!(square(1e-7, size).unwrap().contains("not flat"));
        }
        assert_eq!(square(0.0, 0.0).unwrap(), "the polygon has no area");
        let line = [DVec3::ZERO, DVec3::X, DVec3::X * 2.0];
        assert_eq!(polygon(&line).unwrap().0, "the polygon has no area");
    }
}
