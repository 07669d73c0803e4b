//! Reads scene text; every mistake is reported with its place and a way out.

use std::collections::{HashMap, HashSet};
use std::path::Path;
use std::sync::Arc;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::fields::{AREAS, BACKGROUNDS, BUMPS, LENSES, PAINTS, PLACES, SHAPES, TEXTURES};
use super::mesh::Mesh;
use super::problem::{Mistake, Problem, SceneError};
use super::reader;
use super::texture::Image;
use super::{
    Area, Background, Bump, ImageFile, Lens, Light, LightPlace, Material, Paint, Scene, Shape,
    Solid,
};

/// Reads the scene file at `path`; mesh and image files are sought beside it.
pub fn file(path: &Path) -> Result<Scene, SceneError> {
    let bytes = std::fs::read(path).map_err(|error| SceneError {
        file: path.to_owned(),
        problems: vec![Problem {
            place: None,
            message: format!("cannot be read: {error}"),
            help: "check the name of the file and its permissions".to_owned(),
        }],
        left_out: 0,
    })?;
    self::bytes(&bytes, path, Known::default())
}

/// Mesh and image files that need not be read again, by their names in the scene.
#[derive(Clone, Debug, Default)]
pub struct Known {
    /// Meshes.
    pub meshes: HashMap<String, Arc<Mesh>>,
    /// Images.
    pub images: HashMap<String, Arc<Image>>,
}

impl Known {
    /// The files that a scene holds.
    pub fn of(scene: &Scene) -> Known {
        let mesh = |solid: &Solid| match &solid.shape {
            Shape::Mesh { file, mesh } => Some((file.clone(), Arc::clone(mesh))),
            _ => None,
        };
        let image = |image: &ImageFile| (image.file.clone(), Arc::clone(&image.image));
        Known {
            meshes: scene.solids.iter().filter_map(mesh).collect(),
            images: scene.images().map(image).collect(),
        }
    }

    /// Puts the files into a scene, in place of what it holds of the same names.
    pub fn put(&self, scene: &mut Scene) {
        for solid in &mut scene.solids {
            if let Shape::Mesh { file, mesh } = &mut solid.shape
                && let Some(known) = self.meshes.get(file)
            {
                *mesh = Arc::clone(known);
            }
        }
        for image in scene.images_mut() {
            if let Some(known) = self.images.get(&image.file) {
                image.image = Arc::clone(known);
            }
        }
    }
}

/// Reads what a scene file held; `path` is named in errors, and mesh and image files that are not
/// in `known` are sought beside it.
pub fn bytes(bytes: &[u8], path: &Path, known: Known) -> Result<Scene, SceneError> {
    match str::from_utf8(bytes) {
        Ok(source) => text_with(source, path, known),
        Err(error) => {
            let start = error.valid_up_to();
            let mistake = Mistake {
                span: start..start + 1,
                message: "this is not UTF-8 text".to_owned(),
                help: "save the file in UTF-8".to_owned(),
            };
            let source = String::from_utf8_lossy(bytes);
            Err(SceneError::new(path.to_owned(), &source, vec![mistake]))
        }
    }
}

/// Reads scene text; `file` is named in errors, and mesh and image files are sought beside it.
pub fn text(source: &str, file: &Path) -> Result<Scene, SceneError> {
    text_with(source, file, Known::default())
}

/// [`text`] with some mesh and image files at hand.
pub fn text_with(source: &str, file: &Path, known: Known) -> Result<Scene, SceneError> {
    let source = source.strip_prefix('\u{feff}').unwrap_or(source);
    let (root, errors) = DeTable::parse_recoverable(source);
    if !errors.is_empty() {
        return Err(SceneError::new(file.to_owned(), source, broken_toml(source, &errors)));
    }
    let root = root.get_ref();
    let mut scene = skeleton(root);
    let folder = file.parent().unwrap_or(Path::new(""));
    let mistakes = reader::fill(&mut scene, root, folder, known);
    if mistakes.is_empty() {
        Ok(scene)
    } else {
        Err(SceneError::new(file.to_owned(), source, mistakes))
    }
}

/// The parser's complaints, the first of every line.
fn broken_toml(source: &str, errors: &[toml::de::Error]) -> Vec<Mistake> {
    let mut lines = HashSet::new();
    let mut mistakes = Vec::new();
    for error in errors {
        let span = error.span().unwrap_or(0..0);
        let line = source.get(..span.start).unwrap_or(source).matches('\n').count();
        if lines.insert(line) {
            mistakes.push(Mistake {
                span,
                message: format!("this is not TOML: {}", error.message()),
                help: "lines are `key = value` or `[table]`; text stands in \"quotes\"".to_owned(),
            });
        }
    }
    mistakes
}

/// A scene with the names and the variants of the text, and defaults everywhere else.
fn skeleton(root: &DeTable<'_>) -> Scene {
    let mut scene = Scene::default();
    if let Some(key) = chosen(root.get("camera"), LENSES) {
        scene.camera.lens = Lens::named(key);
    }
    for (name, table) in items(root, "lights") {
        let mut place = LightPlace::named(chosen(Some(table), PLACES).unwrap_or_default());
        if let LightPlace::Area(area) = &mut place {
            let within = table.get_ref().as_table().and_then(|table| table.get("area"));
            *area = Area::named(chosen(within, AREAS).unwrap_or_default());
        }
        scene.lights.push(Light { place, ..Light::new(name) });
    }
    if let Some(key) = chosen(root.get("background"), BACKGROUNDS) {
        scene.background = Background::named(key);
    }
    for (name, table) in items(root, "materials") {
        let (paint, bump) = (self::paint(table), self::bump(table));
        scene.materials.push(Material { paint, bump, ..Material::new(name) });
    }
    for (name, table) in items(root, "solids") {
        let shape = Shape::named(chosen(Some(table), SHAPES).unwrap_or_default());
        scene.solids.push(Solid::new(name, shape, 0));
    }
    scene
}

/// The paint of a material's table, with default colours.
fn paint(material: &Spanned<DeValue<'_>>) -> Paint {
    let key = chosen(Some(material), PAINTS).unwrap_or_default();
    let inner = chosen(inside(material, "texture"), TEXTURES);
    Paint::named(inner.filter(|_| key == "texture").unwrap_or(key))
}

/// The bump of a material's table; an empty one is none, one of unknown keys lacks a known one.
fn bump(material: &Spanned<DeValue<'_>>) -> Bump {
    let Some(table) = inside(material, "bump") else { return Bump::None };
    let is_empty = table.get_ref().as_table().is_none_or(DeTable::is_empty);
    let first = if is_empty { "" } else { BUMPS[0] };
    Bump::named(chosen(Some(table), BUMPS).unwrap_or(first))
}

/// What stands behind a key of a table.
fn inside<'a>(table: &'a Spanned<DeValue<'a>>, key: &str) -> Option<&'a Spanned<DeValue<'a>>> {
    table.get_ref().as_table()?.get(key)
}

/// The first of `keys` that stands in the table `value`.
fn chosen(
    value: Option<&Spanned<DeValue<'_>>>,
    keys: &'static [&'static str],
) -> Option<&'static str> {
    let table = value?.get_ref().as_table()?;
    keys.iter().copied().find(|key| table.contains_key(*key))
}

/// Names and tables of the list `key`; empty if it is no table.
fn items<'a>(
    root: &'a DeTable<'a>,
    key: &str,
) -> impl Iterator<Item = (&'a str, &'a Spanned<DeValue<'a>>)> {
    let list = root.get(key).and_then(|value| value.get_ref().as_table());
    list.into_iter().flat_map(DeTable::iter).map(|(name, value)| (name.get_ref().as_ref(), value))
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::color::Rgb;

    /// The example of the manual, with every kind of table.
    const EXAMPLE: &str = r#"
        version = 1
        ambient_light = [1, 1, 1]
        [camera]
        eye = [0, -8, 1.6]
        target = [0.2, 0, 0.5]
        up = [0, 0, 1]
        fov_degrees = 40
        [picture]
        size = [1280, 720]
        exposure = 0.5
        [trace]
        samples = 4
        depth = 5
        [background]
        color = [0.08, 0.16, 0.30]
        [lights.key]
        point = [-5, -6, 9]
        intensity = 0.9
        [lights.sun]
        direction = [0, 0, -1]
        on = false
        [materials.tiles]
        texture = { checker = { a = [0.95, 0.9, 0.2], b = 0.1, size = 2 } }
        diffuse = 0.6
        [materials.glass]
        [solids.floor]
        plane = { normal = [0, 0, 1], offset = -1.2 }
        material = "tiles"
        [solids.ball]
        sphere = { center = [0, 0, 0], radius = 1 }
        material = "glass"
        rotate_degrees = [0, 0, 30]
        scale = 2
    "#;

    fn read(source: &str) -> Result<Scene, SceneError> {
        text(source, Path::new("s.toml"))
    }

    /// Every problem of a scene with these lines after `version = 1`, as one text.
    fn refused(lines: &str) -> String {
        read(&format!("version = 1\n{lines}")).unwrap_err().to_string()
    }

    /// The messages alone, one a line.
    fn messages(lines: &str) -> Vec<String> {
        let error = read(&format!("version = 1\n{lines}")).unwrap_err();
        error.problems.into_iter().map(|problem| problem.message).collect()
    }

    #[test]
    fn the_example() {
        let scene = read(EXAMPLE).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(scene.camera.lens, Lens::Perspective { fov_degrees: 40.0 });
        assert_eq!((scene.picture.size, scene.picture.exposure), ([1280, 720], 0.5));
        assert_eq!((scene.trace.samples, scene.trace.cutoff), (4, 1.0 / 255.0));
        assert_eq!(scene.background, Background::Color(Rgb([0.08, 0.16, 0.30])));
        assert_eq!(scene.lights[0].intensity, Rgb::grey(0.9));
        assert_eq!(scene.lights[1].place, LightPlace::Direction(DVec3::NEG_Z));
        let checker = Paint::Checker { a: Rgb([0.95, 0.9, 0.2]), b: Rgb::grey(0.1), size: 2.0 };
        assert_eq!(
            (&scene.materials[0].paint, scene.materials[0].diffuse),
            (&checker, Rgb::grey(0.6))
        );
        assert_eq!(scene.materials[1], Material::new("glass"));
        assert_eq!((scene.solids[0].material, scene.solids[1].material), (0, 1));
        assert_eq!(scene.solids[1].placement.scale, DVec3::splat(2.0));
    }

    #[test]
    fn an_empty_scene_is_legal_and_a_byte_order_mark_too() {
        assert_eq!(read("\u{feff}version = 1\r\n"), Ok(Scene::default()));
    }

    #[test]
    fn a_mistake_is_shown_with_its_place_and_a_way_out() {
        let found = refused("[materials.ball]\n\tdifuse = 0.5\n  reflect = 12 # much");
        let expected = "s.toml:3:2: unknown key `difuse` in `materials.ball`\n  \tdifuse = 0.5\n  \
                        \t^^^^^^\n  help: did you mean `diffuse`?\n\
                        s.toml:4:13: `reflect` is 12, out of its range: 0 to 10\n    \
                        reflect = 12 # much\n              ^^\n  \
                        help: the nearest allowed value is 10";
        assert_eq!(found, expected);
        let found = refused("[camera]\n\"é\" = 1");
        let expected = "s.toml:3:1: unknown key `é` in `camera`\n  \"é\" = 1\n  ^^^\n  \
                        help: known keys: eye, target, up, fov_degrees, height, aperture, focus, shutter";
        assert_eq!(found, expected);
        let found = read("").unwrap_err().to_string();
        let expected = "s.toml:1:1: the scene needs the key `version`\n  \n  ^\n  \
                        help: add `version = 1`";
        assert_eq!(found, expected);
    }

    #[test]
    fn broken_toml() {
        let found = refused("[camera\neye = [0, 0\nup = 1");
        assert!(found.starts_with("s.toml:2:8: this is not TOML: "), "{found}");
        let found = refused("[camera]\neye = 1\neye = 2");
        assert!(found.starts_with("s.toml:4:1: this is not TOML: duplicate key"), "{found}");
    }

    #[test]
    fn every_kind_of_mistake_has_its_message() {
        for (lines, expected) in [
            (
                "ambient_light = \"x\"",
                "`ambient_light` must be a number or [r, g, b], found a string",
            ),
            (
                "ambient_light = [1, 2]",
                "`ambient_light` must be a number or [r, g, b], found an array of 2 values",
            ),
            ("ambient_light = [1, 2, nan]", "`ambient_light` is nan, not a finite number"),
            ("ambient_light = 1e39", "`ambient_light` is inf, not a finite number"),
            ("ambient_light = -0.1", "`ambient_light` is -0.1, out of its range: 0 to 1e6"),
            ("camera = 3", "`camera` must be a table, found the whole number 3"),
            ("[[lights]]", "`lights` must be a table, found an array of 1 value"),
            ("lights.key = 3", "`key` must be a table, found the whole number 3"),
            ("trace.depth = 1.5", "`depth` must be a whole number, found the number 1.5"),
            ("trace.depth = -1", "`depth` is -1, out of its range: 0 to 64"),
            (
                "trace.samples = 99999999999",
                "`samples` is 99999999999, out of its range: 1 to 4096",
            ),
            (
                "camera.fov_degrees = 180",
                "`fov_degrees` is 180, out of its range: above 0 and below 180",
            ),
            (
                "camera.eye = [0, 1e13, 0]",
                "`eye` is 10000000000000, out of its range: -1e12 to 1e12",
            ),
            (
                "camera = { height = 1, fov_degrees = 1 }",
                "`fov_degrees` and `height` exclude each other",
            ),
            ("camera.target = [0, -6, 2]", "`target` is where `eye` is: the camera looks nowhere"),
            ("camera = { eye = [0, 0, 9] }", "`up` is parallel to the view from `eye` to `target`"),
            ("camera.up = [0, 0, 0]", "`up` is zero, which is no direction"),
            (
                "camera = { height = 4, aperture = 0.1 }",
                "a parallel view has no lens: its `aperture` is 0",
            ),
            ("camera.shutter = 1.5", "`shutter` is 1.5, out of its range: 0 to 1"),
            ("trace.filter = \"boxx\"", "there is no filter `boxx`"),
            (
                "picture.size = [65536, 65536]",
                "a picture of 65536 × 65536 pixels is too large: at most 268435456 pixels",
            ),
            ("picture.size = [0, 5]", "`size` is 0, out of its range: 1 to 65536"),
            ("[lights.a]", "`lights.a` needs one of `point`, `direction`, `spot`, `area`"),
            (
                "[lights.a]\npoint = [0, 0, 0]\ndirection = [1, 0, 0]",
                "`point` and `direction` exclude each other",
            ),
            ("[lights.a]\ndirection = [0, 0, 0]", "`direction` is zero, which is no direction"),
            (
                "[lights.a]\nspot = {at=[1,2,3],towards=[1,2,3],angle_degrees=9,edge=0}",
                "`towards` is where `at` is: the light shines nowhere",
            ),
            (
                "[lights.a]\nspot = {at=[1,2,3],towards=[1,2,4],angle_degrees=0,edge=0}",
                "`angle_degrees` is 0, out of its range: above 0 and at most 180",
            ),
            (
                "[lights.a]\narea = {disc={center=[0,0,0],normal=[0,0,0],radius=1}}",
                "`normal` is zero, which is no direction",
            ),
            ("[lights.a]\narea = {}", "`lights.a.area` needs one of `rectangle`, `disc`, `sphere`"),
            (
                "[lights.a]\narea = {sphere={center=[0,0,0]}}",
                "`lights.a.area.sphere` needs the key `radius`",
            ),
            (
                "[lights.a]\npoint = [0, 0, 0]\nsamples = 1025",
                "`samples` is 1025, out of its range: 1 to 1024",
            ),
            (
                "trace.samples = 4096\n[lights.a]\nsamples = 16\n\
                 area = {sphere={center=[0,0,0],radius=1}}",
                "4096 camera rays with 16 rays to this light each are too many: at most 65535 \
                 together",
            ),
            (
                "[lights.a]\npoint = [0, 0, 0]\non = 1",
                "`on` must be true or false, found the whole number 1",
            ),
            (
                "[materials.a]\ncolor = 1\ntexture = {checker={a=1,b=1,size=1}}",
                "`color` and `texture` exclude each other",
            ),
            (
                "[materials.\"a b\"]\ntexture = {}",
                "`materials.\"a b\".texture` needs one of `checker`, `gradient`, `marble`, `wood`, `image`",
            ),
            (
                "[materials.a]\ntexture = {checker={a=1,b=1}}",
                "`materials.a.texture.checker` needs the key `size`",
            ),
        ] {
            assert_eq!(messages(lines), [expected], "{lines}");
        }
    }

    #[test]
    fn every_kind_of_mistake_of_a_solid_has_its_message() {
        for (lines, expected) in [
            (
                "",
                "`solids.a` needs one of `sphere`, `plane`, `box`, `cylinder`, `cone`, `torus`, `ellipsoid`, \
                 `quadric`, `prism`, `polygon`, `mesh`, `knot`, `sphereflake`, `union`, `merge`, \
                 `intersection`, `difference`, `complement`",
            ),
            ("sphere = 3", "`sphere` must be a table, found the whole number 3"),
            ("sphere = { center = [0, 0, 0] }", "`solids.a.sphere` needs the key `radius`"),
            (
                "plane = { normal = [0, 0, 0], offset = 1 }",
                "`normal` is zero, which is no direction",
            ),
            (
                "box = { min = [0, 0, 0], max = [1, 0, 1] }",
                "`max` must exceed `min` on every axis; on y they are 0 and 0",
            ),
            (
                "box = { min = [0, 0, 0], max = [1, 1, 1] }\nplane = { normal = [0, 0, 1], offset = 1 }",
                "`plane` and `box` exclude each other",
            ),
            (
                "polygon = { points = [[0, 0, 0], [1, 0, 0]] }",
                "a polygon needs at least 3 points, this one has 2",
            ),
            ("polygon = { points = [[0, 0, 0], [1, 0, 0], [2, 0, 0]] }", "the polygon has no area"),
            (
                "polygon = { points = [[0, 0, 0], [1, 0, 0], [1]] }",
                "`points` must be a list of points [[x, y, z], …], found an array of 1 value",
            ),
            (
                "knot = { turns = [4, 6], tube = 1, segments = [9, 9] }",
                "`turns` must have no common divisor; 4 and 6 have 2 in common",
            ),
            (
                "knot = { turns = [2, 3], tube = 0, segments = [9, 9] }",
                "`tube` is 0, out of its range: above 0 and at most 1e12",
            ),
            (
                "knot = { turns = [2, 3], tube = 1, segments = [9, 2] }",
                "`segments` is 2, out of its range: 3 to 65536",
            ),
            (
                "sphereflake = { center = [0, 0, 0], radius = 1, levels = 7 }",
                "`levels` is 7, out of its range: 1 to 6",
            ),
            (
                "plane = { normal = [0, 0, 1], offset = 0 }\nmotion = { translate = [1, 0, 0] }",
                "a plane has no end and stands still",
            ),
            ("mesh = { file = 3 }", "`file` must be the name of a file, found the whole number 3"),
        ] {
            let lines = format!("[materials.m]\n[solids.a]\nmaterial = \"m\"\n{lines}");
            assert_eq!(messages(&lines), [expected], "{lines}");
        }
        let ball = "[solids.a]\nsphere = { center = [0, 0, 0], radius = 1 }\n";
        assert_eq!(messages(ball), ["`solids.a` needs the key `material`"]);
        let found = refused(&format!("{ball}material = \"glas\"\n[materials.glass]"));
        assert!(found.contains("s.toml:4:12: there is no material `glas`\n"), "{found}");
        assert!(found.ends_with("help: did you mean `glass`?"), "{found}");
    }

    #[test]
    fn every_kind_of_mistake_of_what_is_made_of_others_has_its_message() {
        for (lines, expected) in [
            (
                "union = \"a\"",
                "`union` must be a list of names of solids [\"a\", \"b\", …], found a string",
            ),
            ("merge = [\"a\", \"b\"]", "there is no solid `b`"),
            ("difference = [\"a\"]", "a solid cannot be made of itself: `a` of `a`"),
            ("complement = []", "it has no operands"),
            ("merge = [\"ball\"]\nmaterial = \"m\"", "unknown key `material` in `solids.a`"),
        ] {
            let ball =
                "[solids.ball]\nsphere = { center = [0, 0, 0], radius = 1 }\nmaterial = \"m\"";
            let lines = format!("[materials.m]\n{ball}\n[solids.a]\n{lines}");
            assert_eq!(messages(&lines), [expected], "{lines}");
        }
    }

    #[test]
    fn versions() {
        let found = read("version = 2").unwrap_err().problems[0].message.clone();
        assert_eq!(
            found,
            "this program reads version 1 of the scene format, found the whole number 2"
        );
        assert!(read("version = \"1\"").is_err());
    }

    #[test]
    fn many_mistakes_are_reported_in_the_order_of_the_file() {
        let lines = "[solids.a]\nbox = { min = [1, 0, 0], max = [0, 1] }\nmaterial = \"m\"\n\
                     [lights.b]\nintensity = -1\n[camera]\nup = [0, 0, 0]\nfov = 3\n";
        let error = read(&format!("version = 1\n{lines}")).unwrap_err();
        let lines = error.problems.iter().map(|problem| problem.place.as_ref().unwrap().line);
        // the degenerate `up` is not looked at while `[camera]` has another mistake
        assert_eq!(lines.collect::<Vec<_>>(), [3, 4, 5, 6, 9]);
    }

    #[test]
    fn a_flood_of_mistakes_is_cut() {
        let keys: String = (0..150).map(|i| format!("key{i} = 1\n")).collect();
        let error = read(&format!("version = 1\n{keys}")).unwrap_err();
        assert_eq!((error.problems.len(), error.left_out), (100, 50));
        assert!(error.to_string().ends_with("\nand 50 more"));
    }

    #[test]
    fn no_text_makes_the_reader_panic() {
        let mut refused = 0;
        let mut attempt = |source: &str| {
            refused += usize::from(read(source).is_err_and(|error| !error.to_string().is_empty()))
        };
        for (at, found) in EXAMPLE.char_indices() {
            let (head, tail) = (&EXAMPLE[..at], &EXAMPLE[at + found.len_utf8()..]);
            attempt(head);
            for put in ["", "[", "}", "=", "\"", "é", "\n", "-9", ".", "\0"] {
                attempt(&format!("{head}{put}{tail}"));
            }
        }
        attempt(&format!("version = {}", "[".repeat(100_000)));
        attempt(&format!("version = {}", "{a=".repeat(100_000)));
        attempt(&format!("{} = 1", vec!["a"; 300_000].join(".")));
        assert!(refused > 1000);
    }

    #[test]
    fn more_lights_than_can_be_numbered() {
        let lights: String =
            (0..65_536).map(|i| format!("l{i} = {{point = [0,0,{i}]}}\n")).collect();
        assert_eq!(messages(&format!("[lights]\n{lights}")), ["there are more than 65535 lights"]);
    }

    #[test]
    fn files_and_their_meshes() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("s.toml");
        let error = file(&path).unwrap_err().to_string();
        assert!(error.contains("s.toml: cannot be read: "), "{error}");

        std::fs::write(&path, b"version = 1\n# \xff").unwrap();
        let error = file(&path).unwrap_err().to_string();
        assert!(error.contains("s.toml:2:3: this is not UTF-8 text\n"), "{error}");

        let scene = "version = 1\n[materials.m]\n[solids]\n\
                     a = { mesh = { file = \"m.obj\" }, material = \"m\" }\n\
                     b = { mesh = { file = \"m.obj\" }, material = \"m\" }\n";
        std::fs::write(&path, scene).unwrap();
        let error = file(&path).unwrap_err().to_string();
        assert!(error.contains("s.toml:4:23: the mesh \"m.obj\" cannot be used: "), "{error}");
        let mesh = folder.path().join("m.obj");
        std::fs::write(&mesh, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4").unwrap();
        let error = file(&path).unwrap_err().to_string();
        assert!(error.contains("m.obj:4:7: there is no vertex 4; the file has 3\n"), "{error}");

        std::fs::write(&mesh, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3").unwrap();
        let scene = file(&path).unwrap();
        let [Shape::Mesh { mesh: a, .. }, Shape::Mesh { mesh: b, .. }] =
            [&scene.solids[0].shape, &scene.solids[1].shape]
        else {
            panic!("two meshes")
        };
        assert!(a.triangles.len() == 1 && std::sync::Arc::ptr_eq(a, b));
        let written = crate::scene::write::text(&scene);
        assert_eq!(text(&written, &path).unwrap(), scene);
    }
}
