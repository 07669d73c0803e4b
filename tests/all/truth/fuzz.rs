//! Scenes with odd numbers in them: no picture holds what is no number, nothing panics, nothing hangs.

use std::path::Path;

use rayforest::scene::path::{Parameter, parameters, set};
use rayforest::scene::range::Kind;
use rayforest::scene::{Scene, read};

use super::stage::open;
use crate::exact::random::Random;

/// A scene of most kinds of solids, lights, textures and models.
const SCENE: &str = r#"
version = 1

[picture]
size = [6, 4]

[camera]
eye = [0.2, -7, 2.6]
aperture = 0.1

[trace]
samples = 2
depth = 3

[background]
gradient = { below = 0.1, level = 0.7, above = [0.2, 0.4, 0.9] }

[lights]
key = { point = [-4, -5, 7], falloff = 9 }
sun = { direction = [-0.5, 0.4, -1], intensity = 0.2 }
cone = { spot = { at = [3, -3, 5], towards = [0.3, 0, 0.5], angle_degrees = 20, edge = 0.5 } }
panel = { area = { disc = { center = [0, 2, 4], normal = [0, -1, -1], radius = 0.8 } }, samples = 2 }

[materials]
tiles = { texture = { checker = { a = 0.9, b = 0.1, size = 0.7 } }, reflect = 0.2 }
stone = { texture = { marble = { a = 0.9, b = 0.1, size = 0.7 } }, bump = { noise = { height = 0.02, scale = 0.3 } }, specular = 0.3, model = "blinn" }
wood = { texture = { wood = { a = 0.9, b = 0.1, size = 0.2 } }, bump = { waves = { height = 0.02, scale = 0.3 } }, specular = 0.3, model = "cook_torrance" }
glass = { transmit = 0.8, reflect = 0.2, ior = 1.5, fresnel = true, translucency = 90 }
hall = { transmit = 0.2, reflect = 0.4, model = "hall", specular = 0.4, gloss = 50 }

[solids]
floor = { plane = { normal = [0, 0, 1], offset = -1 }, material = "tiles" }
ball = { sphere = { center = [-1.4, 1.2, 0.9], radius = 0.9 }, material = "glass" }
cube = { box = { min = [0, 0, 0], max = [0.8, 0.8, 1.2] }, material = "stone" }
rod = { cylinder = { from = [-0.6, -2, 0.2], to = [0.4, -2.4, 0.9], radius = 0.2 }, material = "hall" }
hat = { cone = { from = [1.6, 0.6, 0], to = [1.6, 0.6, 1.1], radius = 0.5, tip = 0.1 }, material = "wood" }
tyre = { torus = { major = 0.5, minor = 0.2 }, material = "glass", translate = [-2.2, -0.5, 0.7] }
egg = { ellipsoid = { center = [0.9, -2, 0.4], radii = [0.3, 0.3, 0.45] }, material = "stone" }
spool = { quadric = { squares = [1, 1, -1], constant = -0.1, min = [-0.6, -0.6, -0.5], max = [0.6, 0.6, 0.5] }, material = "wood", translate = [2, -2, 0.6] }
key = { prism = { outline = [[0, 0], [0.8, 0], [0.8, 0.6], [0, 0.7]], bottom = 0, top = 0.3 }, material = "hall", translate = [-1, -2.8, 0] }
pane = { polygon = { points = [[-3, 3, 0], [3, 3, 0], [3, 3, 2]] }, material = "glass" }
knot = { knot = { turns = [2, 3], tube = 0.3, segments = [12, 5] }, material = "glass", scale = 0.4 }
part = { difference = ["cube", "ball"], motion = { translate = [0.2, 0, 0] } }
both = { intersection = ["rod", "tyre"] }
"#;

/// Numbers that find what divides, cancels and overflows.
const ODD: [&str; 15] = [
    "0", "-0.0", "1", "-1", "1e-30", "-1e-30", "1e30", "1e12", "-1e12", "1e6", "1e-6", "0.5",
    "nan", "inf", "-inf",
];

/// Another value of a parameter, as TOML; `None` where numbers decide how long it takes alone.
fn odd(parameter: &Parameter, random: &mut Random) -> Option<String> {
    let mut one = || ODD[random.below(ODD.len())];
    match parameter.kind {
        Kind::Coefficient | Kind::Vector | Kind::Scale => {
            Some(format!("[{}, {}, {}]", one(), one(), one()))
        }
        Kind::Number => Some(one().to_owned()),
        Kind::Flag => Some(["true", "false"][random.below(2)].to_owned()),
        Kind::Choice(names) => Some(format!("\"{}\"", names[random.below(names.len())])),
        Kind::Points => {
            Some(format!("[[{}, 0, {}], [1, {}, 0], [0, {}, 1]]", one(), one(), one(), one()))
        }
        _ => None,
    }
}

fn scene() -> Scene {
    read::text(SCENE, Path::new("fuzz.toml")).unwrap_or_else(|error| panic!("{error}"))
}

/// The first channel that is no number, if one is.
fn not_a_number(scene: Scene) -> Option<[u32; 2]> {
    let size = scene.picture.size;
    let film = open(scene).film();
    let places = (0..size[1]).flat_map(|y| (0..size[0]).map(move |x| [x, y]));
    places.into_iter().find(|pixel| film.pixel(*pixel).0.iter().any(|c| c.is_nan()))
}

#[test]
fn fuzz_no_parameters_make_a_picture_of_what_is_no_number() {
    let (base, mut random) = (scene(), Random(43));
    let all = parameters(&base);
    let rounds = if std::env::var_os("RAYFOREST_LONG").is_some() { 100_000 } else { 1_500 };
    let (mut taken, mut refused) = (0, 0);
    for _ in 0..rounds {
        let mut scene = base.clone();
        let mut edits = vec![];
        for _ in 0..1 + random.below(6) {
            let parameter = &all[random.below(all.len())];
            let Some(value) = odd(parameter, &mut random) else { continue };
            match set(&mut scene, &parameter.path, &value) {
                Ok(()) => {
                    taken += 1;
                    edits.push(format!("{} = {value}", parameter.path));
                }
                Err(error) => {
                    refused += 1;
                    assert!(!error.message.is_empty() && !error.help.is_empty(), "{error}");
                }
            }
        }
        assert_eq!(not_a_number(scene), None, "{edits:?}");
    }
    assert!(taken > rounds && refused > rounds / 2, "{taken} taken, {refused} refused");
}
