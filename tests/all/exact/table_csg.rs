//! What every parameter of solids that are made of others costs, value by value.

use std::path::Path;

use rayforest::scene::path::parameters;
use rayforest::scene::{Scene, read};
use rayforest::session::Class::{None as Nothing, Regrow, Retrace};

use super::classes::{edit_is, row_of, take_steps};
use super::table::{Row, row};
use super::{open, set};

/// A bored block with a ball merged to it, a lens of glass in water, and a moving cutter.
pub(super) const CSG: &str = r#"
version = 1

[picture]
size = [40, 26]

[camera]
eye = [0.2, -7, 2.6]
target = [0, 0, 0.7]
fov_degrees = 36

[background]
color = [0.2, 0.3, 0.5]

[trace]
samples = 2
depth = 4
cutoff = 0.01

[lights]
key = { point = [-4, -5, 7], intensity = 0.8 }

[materials]
tiles = { texture = { checker = { a = [0.9, 0.8, 0.2], b = [0.5, 0.1, 0.1], size = 0.7 } } }
steel = { color = [0.6, 0.6, 0.7], specular = 0.5, reflect = 0.3 }
brass = { color = [0.9, 0.65, 0.25], specular = 0.7 }
glass = { diffuse = 0.02, specular = 0.8, reflect = 0.1, transmit = 0.8, filter = [1, 0.7, 0.6], priority = 1 }
water = { diffuse = 0.02, transmit = 0.9, ior = 1.33, reflect = 0.05 }

[solids]
floor = { plane = { normal = [0, 0, 1], offset = 0 }, material = "tiles" }
block = { box = { min = [-1, -1, 0], max = [1, 1, 1.2] }, material = "steel" }
ball = { sphere = { center = [0, 0, 1.2], radius = 0.7 }, material = "brass" }
bore = { cylinder = { from = [0, -2, 0.6], to = [0, 2, 0.6], radius = 0.4 }, material = "brass" }
both = { merge = ["block", "ball"] }
part = { difference = ["both", "bore"], translate = [-1.2, 0.5, 0], rotate_degrees = [0, 0, 20] }
front = { sphere = { center = [0, -0.6, 0], radius = 1 }, material = "glass" }
back = { sphere = { center = [0, 0.6, 0], radius = 1 }, material = "glass" }
lens = { intersection = ["front", "back"], translate = [1.1, -1, 0.8] }
pool = { box = { min = [0.6, -1.8, 0], max = [1.6, -0.8, 0.8] }, material = "water" }
tube = { torus = { major = 0.6, minor = 0.2 }, material = "steel" }
below = { plane = { normal = [0, 0, 1], offset = 0 }, material = "brass" }
above = { complement = ["below"] }
arch = { intersection = ["tube", "above"], rotate_degrees = [90, 0, 0], translate = [1.3, 1, 0.2] }
"#;

/// What of [`CSG`] moves, for the same parameters with several times in a pixel.
const MOVING: [(&str, &str); 4] = [
    ("camera.shutter", "0.8"),
    ("solids.bore.motion.translate", "[0, 0, 0.4]"),
    ("solids.part.motion.rotate_degrees", "[0, 0, 10]"),
    ("solids.front.motion.rotate_degrees", "[20, 0, 0]"),
];

/// Parameters of [`CSG`]'s solids, and of its materials those that decide where rays go.
const ROWS: &[Row] = &[
    row(
        "solids.both.merge",
        &[("[\"ball\", \"block\"]", Retrace), ("[\"block\"]", Retrace), ("@", Retrace)],
    ),
    row(
        "solids.part.difference",
        &[("[\"both\", \"ball\"]", Retrace), ("[\"bore\", \"both\"]", Retrace), ("@", Retrace)],
    ),
    row("solids.*.intersection", &[("[\"tube\", \"back\"]", Retrace), ("@", Retrace)]),
    row("solids.above.complement", &[("[\"back\"]", Retrace), ("@", Retrace)]),
    // A plane stands still: it is refused.
    row("solids.floor.motion.translate", &[]),
    row("solids.floor.motion.rotate_degrees", &[]),
    row("solids.below.motion.translate", &[]),
    row("solids.below.motion.rotate_degrees", &[]),
    row("solids.*.motion.translate", &[("[0.1, -0.3, 0.2]", Retrace), ("@", Retrace)]),
    row("solids.*.motion.rotate_degrees", &[("[0, 25, 15]", Retrace), ("@", Retrace)]),
    row("solids.*.translate", &[("[0.1, -0.3, 0.1]", Retrace), ("@", Retrace)]),
    row("solids.*.rotate_degrees", &[("[0, 10, 15]", Retrace), ("@", Retrace)]),
    row("solids.*.scale", &[("1.1", Retrace), ("[1, 0.9, 1.2]", Retrace), ("@", Retrace)]),
    row("solids.*.plane.normal", &[("[0.1, 0, 1]", Retrace), ("@", Retrace)]),
    row("solids.*.plane.offset", &[("-0.1", Retrace), ("@", Retrace)]),
    row("solids.*.box.min", &[("[0.7, -1.9, -0.1]", Retrace), ("@", Retrace)]),
    row("solids.*.box.max", &[("[1.7, 1.1, 1]", Retrace), ("@", Retrace)]),
    row("solids.*.sphere.center", &[("[0.1, 0.3, 0.2]", Retrace), ("@", Retrace)]),
    row("solids.*.sphere.radius", &[("0.8", Retrace), ("1.3", Retrace), ("@", Retrace)]),
    row("solids.*.cylinder.from", &[("[0.2, -2, 0.6]", Retrace), ("@", Retrace)]),
    row("solids.*.cylinder.to", &[("[0.2, 0.5, 0.6]", Retrace), ("@", Retrace)]),
    row("solids.*.cylinder.radius", &[("0.1", Retrace), ("0.7", Retrace), ("@", Retrace)]),
    row("solids.*.torus.major", &[("0.3", Retrace), ("@", Retrace)]),
    row("solids.*.torus.minor", &[("0.1", Retrace), ("@", Retrace)]),
    row("materials.*.priority", &[("3", Retrace), ("0", Retrace), ("@", Retrace)]),
    row("materials.*.density", &[("7.85", Nothing), ("@", Nothing)]),
];

fn csg() -> Scene {
    read::text(CSG, Path::new("csg.toml")).unwrap_or_else(|e| panic!("{e}"))
}

fn hold(scene: &Scene, known: impl Fn(&str) -> bool) {
    let first = open(scene, 2);
    let mut taken = 0;
    for parameter in parameters(scene) {
        let path = &parameter.path;
        let of_solids = path.starts_with("solids.") && !path.ends_with(".material");
        if known(path) && (of_solids || path.ends_with(".priority") || path.ends_with(".density")) {
            take_steps(&first, &parameter, row_of(ROWS, path).unwrap_or_else(|e| panic!("{e}")));
            taken += 1;
        }
    }
    assert!(taken > 10, "{taken} parameters");
}

#[test]
fn solids_made_of_others_cost_what_the_table_says() {
    hold(&csg(), |_| true);
}

/// What moves is placed per time: the same histories with what moves.
#[test]
fn moving_operands_cost_what_the_table_says() {
    let mut scene = csg();
    for (path, value) in MOVING {
        set(&mut scene, path, value);
    }
    let moved = ["part", "bore", "front", "both", "lens", "block"];
    hold(&scene, |path| moved.iter().any(|name| path.starts_with(&format!("solids.{name}."))));
}

/// Surfaces keep the material of their operand, whatever it is cut out of.
#[test]
fn materials_of_operands_cost_what_those_of_plain_solids_do() {
    let mut scene = csg();
    let mut session = open(&scene, 2);
    for (path, value, class) in [
        ("solids.bore.material", "steel", Regrow),
        ("solids.block.material", "brass", Regrow),
        ("solids.ball.material", "water", Regrow),
        ("solids.ball.material", "glass", Retrace),
        ("solids.back.material", "water", Retrace),
        ("solids.front.material", "water", Retrace),
        ("solids.bore.material", "brass", Regrow),
        ("solids.ball.material", "brass", Retrace),
    ] {
        set(&mut scene, path, value);
        edit_is(&mut session, scene.clone(), class, &format!("{path} = {value}"));
    }
}
