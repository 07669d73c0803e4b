//! What every parameter of textures, bumps and backgrounds costs, value by value, both ways, and the
//! exact picture after each.

use std::path::Path;
use std::sync::Arc;

use rayforest::progress::Progress;
use rayforest::scene::path::parameters;
use rayforest::scene::read::{Known, text_with};
use rayforest::scene::texture::Image;
use rayforest::scene::{Background, Bump, ImageFile, Paint, Scene};
use rayforest::session::Class::{self, Refold, Regrow, Reshade};
use rayforest::session::Session;

use super::classes::{edit_is, row_of, take_steps};
use super::table::{COLOR, Row, row};
use super::{assert_same_picture, open, set};

/// Every texture, bump and background, on what reflects, transmits and does neither.
const SCENE: &str = r#"
version = 1
ambient_light = 0.9
picture = { size = [40, 26] }
camera = { eye = [0.2, -7, 2.6], target = [0, 0, 0.7], fov_degrees = 40 }
trace = { samples = 2, depth = 4, cutoff = 0.01 }
background = { gradient = { below = 0.2, level = [0.9, 0.8, 0.6], above = [0.2, 0.3, 0.8], up = [0.1, 0, 1] } }
lights.key = { point = [-4, -5, 7], intensity = 0.8 }
lights.sun = { direction = [-0.5, 0.4, -1], intensity = 0.3 }

[materials.floor]
texture = { marble = { a = 0.9, b = [0.2, 0.3, 0.2], size = 0.8, direction = [1, 0.5, 0], turbulence = 1 } }
bump = { noise = { height = 0.05, scale = 0.4 } }
specular = 0.3

[materials.wood]
texture = { wood = { a = [0.8, 0.5, 0.3], b = [0.3, 0.1, 0.05], size = 0.2, center = [0.4, 0.4, 0], axis = [0, 0.2, 1], turbulence = 0.5 } }
reflect = 0.3
bump = { waves = { height = 0.02, scale = 0.3, center = [0.4, 0.4, 1] } }

[materials.globe]
texture = { image = { file = "a.png", tint = [1, 0.9, 0.8], size = 0.5 } }
specular = 0.6
metallic = 0.5
emission = 0.05
reflect = 0.3

[materials.glass]
texture = { gradient = { a = 0.1, b = [0.2, 0, 0], from = [0, 0, 0], to = [0, 0, 1.5] } }
reflect = 0.2
transmit = 0.7
bump = { image = { file = "a.png", height = 0.02, size = 0.4 } }

[materials.screen]
texture = { image = { file = "a.png", tint = 1, size = 1 } }
bump = { image = { file = "a.png", height = 0.03, size = 0.5 } }

[materials.plain]

[solids]
floor = { plane = { normal = [0, 0, 1], offset = 0 }, material = "floor" }
ball = { sphere = { center = [-1.4, 1.2, 0.9], radius = 0.9 }, material = "globe" }
bulb = { sphere = { center = [0.2, -1.6, 0.8], radius = 0.7 }, material = "glass" }
cube = { box = { min = [0.4, 0, 0.01], max = [1.2, 0.8, 1.2] }, material = "wood" }
screen = { polygon = { points = [[-3, 3, 0.1], [3, 3, 0.1], [3, 3, 2], [-3, 3, 2]] }, material = "screen" }
ring = { knot = { turns = [2, 3], tube = 0.3, segments = [30, 8] }, material = "screen", scale = 0.4, translate = [1.9, -1, 0.6] }
"#;

/// 16 × 8 texels of every colour, black ones among them.
fn image(by: u32) -> Arc<Image> {
    let texel = |i: u32| [i * 37 * by % 256, i * 91 % 256, i * i % 251].map(|c| c as u8);
    let mut texels: Vec<[u8; 3]> = (0..128).map(texel).collect();
    texels[40..60].fill([0; 3]);
    Arc::new(Image::of_bytes([16, 8], texels))
}

fn scene() -> Scene {
    let known = Known { images: [("a.png".to_owned(), image(1))].into(), ..Known::default() };
    text_with(SCENE, Path::new("s.toml"), known).unwrap_or_else(|e| panic!("{e}"))
}

/// With the image all around.
fn panorama() -> Scene {
    let image = ImageFile { file: "a.png".into(), image: image(1) };
    let tint = rayforest::color::Rgb([1.0, 0.8, 0.6]);
    Scene { background: Background::Image { image, tint, turn_degrees: 30.0 }, ..scene() }
}

/// Where colours fall: the kept trees say where surfaces are.
const PLACE: &[(&str, Class)] =
    &[("[0.1, -0.3, 0.8]", Refold), ("[1, 2, 3]", Refold), ("@", Refold)];
const SIZE: &[(&str, Class)] = &[("0.1", Refold), ("3", Refold), ("0.15", Refold), ("@", Refold)];
const FOLDS: &[(&str, Class)] = &[("0", Refold), ("9", Refold), ("0.3", Refold), ("@", Refold)];
/// A bump of what neither reflects nor transmits bends no ray.
const MATT: &[(&str, Class)] =
    &[("0.2", Refold), ("0.3", Refold), ("1.5", Refold), ("0.25", Refold), ("@", Refold)];
const MATT_HEIGHT: &[(&str, Class)] =
    &[("0", Refold), ("0.3", Refold), ("-0.1", Refold), ("0", Refold), ("@", Refold)];
const HEIGHT: &[(&str, Class)] =
    &[("0", Regrow), ("0.3", Regrow), ("-0.1", Regrow), ("0", Regrow), ("@", Regrow)];
const WAVE: &[(&str, Class)] = &[("0.2", Regrow), ("2", Regrow), ("0.1", Regrow), ("@", Regrow)];

const ROWS: &[Row] = &[
    row("background.gradient.below", COLOR),
    row("background.gradient.level", COLOR),
    row("background.gradient.above", COLOR),
    row("background.gradient.up", PLACE),
    row("background.image.tint", COLOR),
    row("background.image.turn_degrees", &[("0", Refold), ("-90", Refold), ("@", Refold)]),
    row("materials.*.texture.*.a", COLOR),
    row("materials.*.texture.*.b", COLOR),
    row("materials.*.texture.*.tint", COLOR),
    row("materials.*.texture.*.size", SIZE),
    row("materials.*.texture.*.turbulence", FOLDS),
    row("materials.*.texture.*.direction", PLACE),
    row("materials.*.texture.*.center", PLACE),
    row("materials.*.texture.*.axis", PLACE),
    row("materials.*.texture.*.from", PLACE),
    row("materials.*.texture.*.to", PLACE),
    row("materials.floor.bump.*.height", MATT_HEIGHT),
    row("materials.screen.bump.*.height", MATT_HEIGHT),
    row("materials.floor.bump.*.scale", MATT),
    row("materials.screen.bump.*.size", MATT),
    row("materials.*.bump.*.height", HEIGHT),
    row("materials.*.bump.*.scale", WAVE),
    row("materials.*.bump.*.size", WAVE),
    row("materials.*.bump.*.center", &[("[0, 0, 2]", Regrow), ("@", Regrow)]),
    // What an image's texels do not multiply stays editable too.
    row("materials.globe.metallic", &[("0", Reshade), ("1", Reshade), ("@", Reshade)]),
    row("materials.globe.emission", COLOR),
    row("materials.globe.specular", COLOR),
    row("materials.globe.kloc", COLOR),
    row("materials.globe.shininess", &[("1", Refold), ("200", Refold), ("@", Refold)]),
    row("materials.globe.reflect", &[("0", Reshade), ("@", Reshade), ("0.5", Regrow)]),
];

fn hold_to_table(scene: &Scene, of: fn(&str) -> bool) -> usize {
    let first = open(scene, 2);
    let mut held = 0;
    for parameter in parameters(scene).into_iter().filter(|p| of(&p.path)) {
        match row_of(ROWS, &parameter.path) {
            Ok(row) => take_steps(&first, &parameter, row),
            // Everything else is in the table of all kinds.
            Err(why) => {
                let own = [".texture.", ".bump.", "background."];
                assert!(!own.iter().any(|part| parameter.path.contains(part)), "{why}");
                continue;
            }
        }
        held += 1;
    }
    held
}

#[test]
fn textures_and_bumps_cost_what_the_table_says() {
    let held = hold_to_table(&scene(), |path| !path.starts_with("background"));
    assert!(held > 30, "{held} parameters");
}

#[test]
fn backgrounds_cost_what_the_table_says() {
    assert_eq!(hold_to_table(&scene(), |path| path.starts_with("background")), 4);
    assert_eq!(hold_to_table(&panorama(), |path| path.starts_with("background")), 2);
}

/// What is done, what it costs, and how it is done.
type Exchange = (&'static str, Class, fn(&mut Scene));

/// Every step from one to another, there and back.
fn exchange(first: Scene, others: &[Exchange]) {
    let fresh = open(&first, 2);
    for (what, class, change) in others {
        let mut session = open(&first, 2);
        let mut edited = first.clone();
        change(&mut edited);
        edit_is(&mut session, edited, *class, what);
        let back = format!("{what}, and back");
        edit_is(&mut session, first.clone(), *class, &back);
        assert_same_picture(&session, &fresh, &back);
    }
}

#[test]
fn kinds_and_images_are_exchanged_without_rays_where_none_is_bent() {
    exchange(
        scene(),
        &[
            ("marble becomes wood", Refold, |s| s.materials[0].paint = Paint::named("wood")),
            ("wood becomes one colour", Refold, |s| s.materials[1].paint = Paint::named("color")),
            ("an image becomes a checker", Refold, |s| {
                s.materials[2].paint = Paint::named("checker");
            }),
            ("a gradient becomes an image", Refold, |s| {
                s.materials[3].paint = s.materials[2].paint.clone();
            }),
            ("another image", Refold, |s| {
                let image = ImageFile { file: "b.png".into(), image: image(3) };
                s.materials[2].paint =
                    Paint::Image { image, tint: rayforest::color::Rgb::WHITE, size: 0.5 };
            }),
            ("the same image in another file", Class::None, |s| {
                let Paint::Image { image, .. } = &mut s.materials[2].paint else { return };
                image.file = "b.png".into();
            }),
            ("no bump of the floor", Refold, |s| s.materials[0].bump = Bump::None),
            ("waves for noise on the floor", Refold, |s| {
                s.materials[0].bump = Bump::named("waves");
            }),
            ("no bump of wood that reflects", Regrow, |s| s.materials[1].bump = Bump::None),
            ("a bump of a mirror", Regrow, |s| s.materials[2].bump = Bump::named("noise")),
            ("a bump of glass", Regrow, |s| s.materials[3].bump = Bump::named("noise")),
            ("a bump of what no solid has", Refold, |s| {
                s.materials[5].bump = Bump::named("noise");
            }),
            ("one background", Refold, |s| s.background = Background::default()),
            ("a panorama", Refold, |s| s.background = panorama().background),
            ("a solid of another bump", Regrow, |s| s.solids[1].material = 1),
            ("a matt solid of another bump", Refold, |s| s.solids[4].material = 0),
        ],
    );
}

#[test]
fn a_height_of_zero_is_no_bump_in_bytes() {
    let mut flat = scene();
    flat.materials.iter_mut().for_each(|material| material.bump = Bump::None);
    let mut zero = scene();
    for path in ["floor.bump.noise", "wood.bump.waves", "glass.bump.image", "screen.bump.image"] {
        set(&mut zero, &format!("materials.{path}.height"), "0");
    }
    let (flat, zero, bumpy) = (open(&flat, 2), open(&zero, 2), open(&scene(), 2));
    assert_same_picture(&flat, &zero, "no height");
    assert!(flat.transport() == zero.transport() && flat.forest() == zero.forest());
    assert!(flat.film() != bumpy.film(), "a bump is seen");
}

/// A bump that was changed while its branches were dead: they are kept, and no longer theirs.
#[test]
fn dead_branches_do_not_outlive_their_bump() {
    let mut session = open(&scene(), 2);
    let mut edited = scene();
    for (path, value) in [
        ("materials.wood.reflect", "0"),
        ("materials.wood.bump.waves.height", "0.2"),
        ("materials.wood.reflect", "0.3"),
        ("materials.wood.bump.waves.height", "0"),
        ("materials.wood.bump.waves.height", "0.02"),
    ] {
        set(&mut edited, path, value);
        session.edit(edited.clone(), &Progress::default()).unwrap();
        assert_same_picture(&session, &open(&edited, 2), &format!("{path} = {value}"));
    }
}

/// Textures and bumps do not hide edits of what is not theirs, such as lights that are moved.
#[test]
fn parts_of_textured_trees_are_grown_again() {
    let mut session: Session = open(&panorama(), 2);
    let mut edited = panorama();
    for (path, value) in [
        ("lights.key.point", "[3, -5, 7]"),
        ("materials.floor.reflect", "0.4"),
        ("materials.screen.reflect", "0.4"),
        ("trace.depth", "6"),
        ("lights.sun.direction", "[0.5, 0.4, -1]"),
        ("materials.globe.reflect", "0.8"),
        ("materials.floor.transmit", "0.4"),
    ] {
        set(&mut edited, path, value);
        session.edit(edited.clone(), &Progress::default()).unwrap();
        assert_same_picture(&session, &open(&edited, 2), &format!("{path} = {value}"));
    }
}

/// With moving solids, a lens and a filter of signed weights.
#[test]
fn textures_that_move_are_read_again_exactly() {
    let mut first = panorama();
    for (path, value) in [
        ("camera.shutter", "1"),
        ("camera.aperture", "0.1"),
        ("trace.filter", "mitchell"),
        ("trace.samples", "4"),
    ] {
        set(&mut first, path, value);
    }
    for solid in &mut first.solids[1..] {
        solid.motion.translate.x = 0.3;
        solid.motion.rotate_degrees.z = 20.0;
    }
    let mut session = open(&first, 2);
    let mut edited = first;
    for (path, value) in [
        ("materials.wood.texture.wood.turbulence", "2"),
        ("materials.globe.texture.image.size", "0.3"),
        ("materials.screen.bump.image.height", "0.2"),
        ("materials.glass.bump.image.height", "0.1"),
        ("lights.key.point", "[3, -5, 7]"),
        ("background.image.turn_degrees", "80"),
        ("materials.screen.reflect", "0.4"),
        ("materials.glass.bump.image.height", "0"),
    ] {
        set(&mut edited, path, value);
        session.edit(edited.clone(), &Progress::default()).unwrap();
        assert_same_picture(&session, &open(&edited, 2), &format!("{path} = {value}"));
    }
}
