//! What every parameter of the scene of all kinds costs, value by value.

use rayforest::session::Class::{self, None as Nothing, Refold, Regrow, Reshade, Retrace};

/// A scene with every kind of light, material and solid.
pub(super) const SCENE: &str = r#"
version = 1
ambient_light = [0.9, 1.0, 0.8]

[picture]
size = [40, 26]
exposure = 0.25

[camera]
eye = [0.2, -7, 2.6]
target = [0, 0, 0.7]
up = [0, 0, 1]
fov_degrees = 40

[background]
color = [0.2, 0.3, 0.5]

[trace]
samples = 2
depth = 4
cutoff = 0.01

[lights]
key = { point = [-4, -5, 7], color = [1, 0.9, 0.8], intensity = 0.8 }
sun = { direction = [-0.5, 0.4, -1], intensity = [0.2, 0.25, 0.3] }

[materials.tiles]
texture = { checker = { a = [0.9, 0.8, 0.2], b = [0.5, 0.1, 0.1], size = 0.7 } }

[materials.plain]
color = [0.3, 0.6, 0.4]
specular = 0.3

[materials.mirror]
color = [0.9, 0.9, 0.95]
diffuse = 0.3
specular = 0.6
shininess = 80
reflect = 0.5

[materials.glass]
ambient = 0
diffuse = 0.02
specular = 0.8
shininess = 150
reflect = 0.12
transmit = 0.8
filter = [1, 0.7, 0.6]

[materials.lamp]
color = [1, 0.5, 0.2]
emission = [0.4, 0.3, 0.1]

[materials.brass]
color = [0.9, 0.65, 0.25]
specular = 0.7
metallic = 1
reflect = [0.2, 0.14, 0.05]

[solids]
floor = { plane = { normal = [0, 0, 1], offset = 0 }, material = "tiles" }
ball = { sphere = { center = [-1.4, 1.2, 0.9], radius = 0.9 }, material = "mirror" }
bulb = { sphere = { center = [0.2, -1.6, 0.8], radius = 0.7 }, material = "glass" }
cube = { box = { min = [0, 0, 0], max = [0.8, 0.8, 1.2] }, material = "plain" }
screen = { polygon = { points = [[-3, 3, 0], [3, 3, 0], [3, 3, 2], [-3, 3, 2]] }, material = "lamp" }
ring = { knot = { turns = [2, 3], tube = 0.3, segments = [30, 8] }, material = "brass", scale = 0.4, translate = [1.6, -1, 0.6] }
flake = { sphereflake = { center = [-1.15, -1.5, 0.8], radius = 0.3, levels = 2 }, material = "mirror" }
"#;

/// A scene with every kind of light that [`SCENE`] lacks, and with blurred rays.
pub(super) const LAMPS: &str = r#"
version = 1
ambient_light = [0.9, 1.0, 0.8]

[picture]
size = [40, 26]

[camera]
eye = [0.2, -7, 2.6]
target = [0, 0, 0.7]
up = [0, 0, 1]
fov_degrees = 40

[background]
color = [0.2, 0.3, 0.5]

[trace]
samples = 2
depth = 3
cutoff = 0.01

[lights]
panel = { area = { rectangle = { center = [-2, -3, 4], along = [1, 0.5, 0], across = [0, 1, 1] } }, samples = 5, intensity = 0.8 }
cone = { spot = { at = [3, -3, 5], towards = [0.3, 0, 0.5], angle_degrees = 20, edge = 0.5 }, falloff = 5 }
lamp = { area = { disc = { center = [0, 2, 1.5], normal = [0, -1, 0.3], radius = 0.8 } }, samples = 3, intensity = 0.4, falloff = 3 }
key = { point = [-4, -5, 7], color = [1, 0.9, 0.8], intensity = 0.3 }
ball = { area = { sphere = { center = [2, -2, 3], radius = 0.7 } }, color = [0.5, 1, 1], intensity = 0.3 }

[materials.tiles]
texture = { checker = { a = [0.9, 0.8, 0.2], b = [0.5, 0.1, 0.1], size = 0.7 } }
reflect = 0.3
gloss = 40

[materials.plain]
color = [0.3, 0.6, 0.4]
model = "hall"
specular = 0.3
transmit = 0.3
translucency = 15

[materials.mirror]
diffuse = 0.3
specular = 0.6
shininess = 80
reflect = 0.5
gloss = 200

[materials.glass]
diffuse = 0.02
specular = 0.8
reflect = 0.12
transmit = 0.8
filter = [1, 0.7, 0.6]
gloss = 9
translucency = 60

[solids]
floor = { plane = { normal = [0, 0, 1], offset = 0 }, material = "tiles" }
ball = { sphere = { center = [-1.4, 1.2, 0.9], radius = 0.9 }, material = "mirror" }
bulb = { sphere = { center = [0.2, -1.6, 0.8], radius = 0.7 }, material = "glass" }
cube = { box = { min = [0, 0, 0], max = [0.8, 0.8, 1.2] }, material = "plain" }
"#;

/// Solids of the kinds that [`SCENE`] lacks, to be added to it.
pub(super) const SOLIDS: &str = r#"
rod = { cylinder = { from = [-0.6, -2, 0.2], to = [0.4, -2.4, 0.9], radius = 0.2 }, material = "glass" }
hat = { cone = { from = [1.6, 0.6, 0], to = [1.6, 0.6, 1.1], radius = 0.5, tip = 0.1 }, material = "mirror" }
tyre = { torus = { major = 0.5, minor = 0.2 }, material = "brass", rotate_degrees = [70, 0, 20], translate = [-2.2, -0.5, 0.7] }
egg = { ellipsoid = { center = [0.9, -2, 0.4], radii = [0.3, 0.3, 0.45] }, material = "plain" }
spool = { quadric = { squares = [1, 1, -1], products = [0.1, 0, 0], linear = [0, 0, 0.1], constant = -0.1, min = [-0.6, -0.6, -0.5], max = [0.6, 0.6, 0.5] }, material = "glass", translate = [2, -2, 0.6], scale = 0.8 }
key = { prism = { outline = [[[0, 0], [0.8, 0], [0.8, 0.6], [0.4, 0.3], [0, 0.7]], [[0.1, 0.1], [0.3, 0.1], [0.2, 0.3]]], bottom = 0, top = 0.3 }, material = "plain", translate = [-1, -2.8, 0] }
"#;

/// What of [`SCENE`] is another illumination model, for [`GLOSSY`].
pub(super) const MODELS: [(&str, &str); 7] = [
    ("materials.plain.model", "blinn"),
    ("materials.glass.model", "hall"),
    ("materials.lamp.model", "hall"),
    ("materials.lamp.specular", "0.5"),
    ("materials.brass.model", "cook_torrance"),
    ("materials.brass.reflect", "1"),
    ("materials.brass.fresnel", "true"),
];

/// What of [`SCENE`] is an open lens, a moving solid and a filter with signs, for [`LENS`].
pub(super) const OPEN: [(&str, &str); 6] = [
    ("camera.aperture", "0.4"),
    ("camera.focus", "6.5"),
    ("camera.shutter", "0.8"),
    ("trace.filter", "mitchell"),
    ("trace.samples", "5"),
    ("solids.ball.motion.translate", "[0.5, 0, 0.2]"),
];

/// A parameter and what some values of it, set one after another, cost. `*` stands for any name,
/// `@` for the value it had at first. A value that it has already costs nothing and stands for
/// `Class::None`.
pub(super) struct Row {
    pub(super) path: &'static str,
    pub(super) steps: &'static [(&'static str, Class)],
}

pub(super) const fn row(path: &'static str, steps: &'static [(&'static str, Class)]) -> Row {
    Row { path, steps }
}

/// Light, colours and coefficients: instant whatever the value, zero included.
pub(super) const COLOR: &[(&str, Class)] = &[
    ("0", Reshade),
    ("0.004", Reshade),
    ("1", Reshade),
    ("[0.3, 0, 1.5]", Reshade),
    ("1e6", Reshade),
    ("@", Reshade),
];
/// An opaque material that lies between some point and a light: the least transmission lets light
/// through where there was shadow.
const LETS_LIGHT_THROUGH: &[(&str, Class)] = &[
    ("0.004", Regrow),
    ("0", Reshade),
    ("0.004", Reshade),
    ("0.5", Regrow),
    ("[0, 0.2, 0]", Reshade),
    ("0", Reshade),
    ("0.5", Reshade),
    ("@", Reshade),
];
/// A visible matt material: below the cut-off its mirror image stays out of the picture.
const BECOMES_MIRROR: &[(&str, Class)] = &[
    ("0.004", Reshade),
    ("0.01", Regrow),
    ("0.009", Reshade),
    ("0.5", Regrow),
    ("0", Reshade),
    ("[0, 0.004, 0]", Reshade),
    ("0.5", Reshade),
    ("@", Reshade),
];
const EXPONENT: &[(&str, Class)] =
    &[("0", Refold), ("1", Refold), ("7.5", Refold), ("1e6", Refold), ("@", Refold)];
/// Where colours fall: the kept trees say where surfaces are.
const CELL: &[(&str, Class)] = &[("0.25", Refold), ("1", Refold), ("1.5", Refold), ("@", Refold)];
/// Fresnel's weight makes branches fainter; without it some may come alive.
const WEIGHS_MIRROR: &[(&str, Class)] =
    &[("blinn", Refold), ("cook_torrance", Refold), ("hall", Refold), ("@", Regrow)];
const FALLOFF_FROM_NONE: &[(&str, Class)] =
    &[("3", Refold), ("4", Reshade), ("0.5", Reshade), ("@", Refold)];
const SHADOW_RAYS: &[(&str, Class)] = &[("2", Regrow), ("1", Regrow), ("7", Regrow), ("@", Regrow)];
const PLACE: &[(&str, Class)] = &[("[0.4, -0.6, 3]", Regrow), ("@", Regrow)];
/// The lobe of a ray that is cast.
const BLUR: &[(&str, Class)] =
    &[("20", Regrow), ("3", Regrow), ("1e6", Regrow), ("0", Regrow), ("@", Regrow)];
const VECTOR: &[(&str, Class)] = &[("[0.1, -0.3, 0.8]", Retrace), ("@", Retrace)];
const TURN: &[(&str, Class)] = &[("[0, 0, 15]", Retrace), ("@", Retrace)];
const SCALE: &[(&str, Class)] =
    &[("1.1", Retrace), ("[1, 0.9, 1]", Retrace), ("0.9", Retrace), ("@", Retrace)];
const LENGTH: &[(&str, Class)] =
    &[("0.25", Retrace), ("1", Retrace), ("1.5", Retrace), ("@", Retrace)];

/// Every parameter of [`SCENE`]; the row that names more of a path comes first.
pub(super) const ROWS: &[Row] = &[
    row("ambient_light", COLOR),
    row("background.color", COLOR),
    row("camera.eye", &[("[0.3, -7, 2.6]", Retrace), ("@", Retrace)]),
    row("camera.target", VECTOR),
    row("camera.up", &[("[0.1, 0, 1]", Retrace), ("@", Retrace)]),
    row("camera.fov_degrees", &[("50", Retrace), ("1", Retrace), ("@", Retrace)]),
    // A parallel view has no lens.
    row("camera.aperture", &[("0.3", Retrace), ("1.2", Retrace), ("0", Retrace), ("@", Nothing)]),
    // Neither has a pinhole.
    row("camera.focus", &[("5", Nothing), ("@", Nothing)]),
    // Nothing moves.
    row("camera.shutter", &[("0.5", Nothing), ("0", Nothing), ("@", Nothing)]),
    row("camera.height", &[("5", Retrace), ("0.5", Retrace), ("@", Retrace)]),
    row("picture.size", &[("[33, 20]", Retrace), ("[1, 1]", Retrace), ("@", Retrace)]),
    row(
        "picture.exposure",
        &[("0", Reshade), ("-30", Reshade), ("1", Reshade), ("30", Reshade), ("@", Reshade)],
    ),
    row("picture.tone", &[("neutral", Reshade), ("none", Reshade), ("@", Nothing)]),
    row("trace.samples", &[("1", Retrace), ("3", Retrace), ("@", Retrace)]),
    // With so few samples every pixel has all.
    row("trace.adaptive", &[("0.1", Nothing), ("1", Nothing), ("@", Nothing)]),
    row("trace.refine", &[("contrast", Nothing), ("trees", Nothing), ("@", Nothing)]),
    row(
        "trace.filter",
        &[
            ("tent", Retrace),
            ("mitchell", Retrace),
            ("gaussian", Retrace),
            ("box", Retrace),
            ("@", Nothing),
        ],
    ),
    row(
        "trace.depth",
        &[
            ("2", Reshade),
            ("0", Reshade),
            ("1", Reshade),
            ("@", Reshade),
            ("5", Regrow),
            ("@", Reshade),
            ("5", Reshade),
        ],
    ),
    row(
        "trace.cutoff",
        &[
            ("0.5", Reshade),
            ("1", Reshade),
            ("@", Reshade),
            ("0.0001", Regrow),
            ("@", Reshade),
            ("0.0001", Reshade),
            ("0", Reshade), // the depth of 4 is the tighter limit here
            ("@", Reshade),
        ],
    ),
    // A light that begins or ceases to fall off is read again from the kept trees.
    row("lights.panel.falloff", FALLOFF_FROM_NONE),
    row("lights.key.falloff", FALLOFF_FROM_NONE),
    row("lights.ball.falloff", FALLOFF_FROM_NONE),
    row("lights.sun.falloff", &[("3", Nothing), ("0", Nothing), ("@", Nothing)]),
    row(
        "lights.*.falloff",
        &[("2", Reshade), ("1e12", Reshade), ("0", Refold), ("4", Refold), ("@", Reshade)],
    ),
    row("lights.panel.samples", SHADOW_RAYS),
    row("lights.lamp.samples", SHADOW_RAYS),
    row("lights.ball.samples", SHADOW_RAYS),
    // Points and directions need no more than one ray.
    row("lights.*.samples", &[("2", Nothing), ("1024", Nothing), ("@", Nothing)]),
    row("lights.cone.spot.at", PLACE),
    row("lights.cone.spot.towards", PLACE),
    row("lights.cone.spot.angle_degrees", &[("9", Regrow), ("180", Regrow), ("@", Regrow)]),
    row("lights.cone.spot.edge", &[("0", Regrow), ("1", Regrow), ("@", Regrow)]),
    row("lights.panel.area.rectangle.center", PLACE),
    row("lights.panel.area.rectangle.along", PLACE),
    row("lights.panel.area.rectangle.across", PLACE),
    row("lights.lamp.area.disc.center", PLACE),
    row("lights.lamp.area.disc.normal", PLACE),
    row("lights.lamp.area.disc.radius", &[("0.1", Regrow), ("2", Regrow), ("@", Regrow)]),
    row("lights.ball.area.sphere.center", PLACE),
    row("lights.ball.area.sphere.radius", &[("0.1", Regrow), ("2", Regrow), ("@", Regrow)]),
    row("lights.*.color", COLOR),
    row("lights.*.intensity", COLOR),
    row("lights.*.on", &[("false", Reshade), ("true", Reshade)]),
    row("lights.key.point", &[("[-4, -5, 7.5]", Regrow), ("@", Regrow)]),
    row("lights.sun.direction", &[("[0.5, 0.4, -1]", Regrow), ("@", Regrow)]),
    row("materials.*.color", COLOR),
    row("materials.*.texture.checker.a", COLOR),
    row("materials.*.texture.checker.b", COLOR),
    row("materials.*.texture.checker.size", CELL),
    row("materials.*.kloc", COLOR),
    row("materials.*.ambient", COLOR),
    row("materials.*.diffuse", COLOR),
    row("materials.*.specular", COLOR),
    row("materials.*.emission", COLOR),
    row(
        "materials.*.metallic",
        &[("0", Reshade), ("0.5", Reshade), ("1", Reshade), ("@", Reshade)],
    ),
    row("materials.*.shininess", EXPONENT),
    // Only Cook-Torrance has facets.
    row("materials.*.roughness", &[("0.02", Nothing), ("1", Nothing), ("@", Nothing)]),
    // Hall's model shows lights behind what transmits.
    row(
        "materials.glass.model",
        &[("blinn", Refold), ("cook_torrance", Refold), ("hall", Regrow), ("@", Regrow)],
    ),
    row("materials.mirror.model", WEIGHS_MIRROR),
    row("materials.brass.model", WEIGHS_MIRROR),
    row(
        "materials.*.model",
        &[("blinn", Refold), ("cook_torrance", Refold), ("hall", Refold), ("@", Refold)],
    ),
    row("materials.glass.fresnel", &[("true", Refold), ("@", Regrow)]),
    row("materials.mirror.fresnel", &[("true", Refold), ("@", Regrow)]),
    row("materials.brass.fresnel", &[("true", Refold), ("@", Regrow)]),
    row("materials.*.fresnel", &[("true", Refold), ("@", Refold)]),
    row("materials.mirror.gloss", BLUR),
    row("materials.brass.gloss", BLUR),
    row("materials.glass.gloss", BLUR),
    row("materials.glass.translucency", BLUR),
    // What neither mirrors nor transmits has nothing to blur.
    row("materials.*.gloss", &[("20", Nothing), ("0.5", Nothing), ("@", Nothing)]),
    // Mass is not seen.
    row("materials.*.density", &[("7.85", Nothing), ("1e12", Nothing), ("@", Nothing)]),
    row("materials.*.translucency", &[("20", Nothing), ("0.5", Nothing), ("@", Nothing)]),
    // Which of two surfaces is there decides where rays go.
    row("materials.*.priority", &[("1", Retrace), ("1000", Retrace), ("@", Retrace)]),
    row("materials.glass.ior", &[("1", Regrow), ("0.8", Regrow), ("2.4", Regrow), ("@", Regrow)]),
    // Nothing passes through the others: only what is thinner than air or glass shows it.
    row(
        "materials.*.ior",
        &[("1.6", Nothing), ("2.4", Nothing), ("0.8", Refold), ("1", Refold), ("@", Refold)],
    ),
    row(
        "materials.mirror.reflect",
        &[
            ("0.2", Reshade),
            ("0", Reshade),
            ("0.004", Reshade),
            ("[0.5, 0, 0.01]", Reshade),
            ("@", Reshade),
            ("1", Regrow),
            ("10", Reshade), // as a weight not more than 1
            ("@", Reshade),
        ],
    ),
    row(
        "materials.brass.reflect",
        &[("0", Reshade), ("0.1", Reshade), ("@", Reshade), ("0.9", Regrow), ("@", Reshade)],
    ),
    row(
        "materials.glass.reflect",
        &[
            ("0.06", Reshade),
            ("0", Reshade),
            ("0.005", Reshade),
            ("@", Reshade),
            ("0.5", Regrow),
            ("@", Reshade),
            ("0.5", Reshade),
        ],
    ),
    row("materials.*.reflect", BECOMES_MIRROR),
    row(
        "materials.glass.transmit",
        &[
            ("0.4", Reshade),
            ("0.001", Reshade),
            ("0", Reshade),
            ("[0, 0.8, 0]", Reshade),
            ("@", Reshade),
            ("1", Regrow),
            ("0", Reshade),
            ("@", Reshade),
        ],
    ),
    // No solid lies below the floor or behind the screen as seen from a light.
    row(
        "materials.tiles.transmit",
        &[("0.004", Reshade), ("0.5", Regrow), ("0", Reshade), ("0.5", Reshade), ("@", Reshade)],
    ),
    row("materials.*.transmit", LETS_LIGHT_THROUGH),
    row(
        "materials.glass.filter",
        &[
            ("0.3", Reshade),
            ("0", Reshade),
            ("[0, 0, 0.6]", Reshade),
            ("@", Reshade),
            ("2", Regrow),
            ("@", Reshade),
            ("2", Reshade),
        ],
    ),
    // Nothing passes through the others, whatever its colour would be.
    row("materials.*.filter", COLOR),
    // Rays go on from the tiles and the lamp as they do from what is plain: not at all.
    row("solids.floor.material", &[("plain", Refold), ("glass", Regrow), ("@", Regrow)]),
    row("solids.screen.material", &[("plain", Refold), ("glass", Regrow), ("@", Regrow)]),
    row("solids.*.material", &[("plain", Regrow), ("glass", Regrow), ("@", Regrow)]),
    // A plane stands still: it is refused.
    row("solids.floor.motion.translate", &[]),
    row("solids.floor.motion.rotate_degrees", &[]),
    row("solids.*.motion.translate", VECTOR),
    row("solids.*.motion.rotate_degrees", TURN),
    row("solids.*.translate", VECTOR),
    row("solids.*.rotate_degrees", TURN),
    row("solids.*.scale", SCALE),
    row("solids.floor.plane.normal", &[("[0.1, 0, 1]", Retrace), ("@", Retrace)]),
    row("solids.floor.plane.offset", &[("-0.1", Retrace), ("1", Retrace), ("@", Retrace)]),
    row("solids.*.sphere.center", VECTOR),
    row("solids.*.sphere.radius", LENGTH),
    row("solids.rod.cylinder.from", &[("[-0.6, -2, 0.3]", Retrace), ("@", Retrace)]),
    row("solids.rod.cylinder.to", &[("[0.4, -2.3, 0.9]", Retrace), ("@", Retrace)]),
    row("solids.rod.cylinder.radius", LENGTH),
    row("solids.hat.cone.from", &[("[1.5, 0.6, 0]", Retrace), ("@", Retrace)]),
    row("solids.hat.cone.to", &[("[1.5, 0.6, 1]", Retrace), ("@", Retrace)]),
    row("solids.hat.cone.radius", LENGTH),
    row("solids.hat.cone.tip", &[("0", Retrace), ("0.7", Retrace), ("@", Retrace)]),
    row("solids.tyre.torus.major", LENGTH),
    row("solids.tyre.torus.minor", LENGTH),
    row("solids.egg.ellipsoid.center", VECTOR),
    row("solids.egg.ellipsoid.radii", &[("[0.2, 0.3, 0.3]", Retrace), ("@", Retrace)]),
    row("solids.spool.quadric.squares", &[("[1, 0.8, -1]", Retrace), ("@", Retrace)]),
    row("solids.spool.quadric.products", &[("[0, 0.5, 0]", Retrace), ("@", Retrace)]),
    row("solids.spool.quadric.linear", VECTOR),
    row("solids.spool.quadric.constant", &[("0", Retrace), ("-0.2", Retrace), ("@", Retrace)]),
    row("solids.spool.quadric.min", &[("[-0.5, -0.6, -0.5]", Retrace), ("@", Retrace)]),
    row("solids.spool.quadric.max", &[("[0.5, 0.6, 0.4]", Retrace), ("@", Retrace)]),
    row("solids.key.prism.outline", &[("[[0, 0], [0.8, 0], [0.4, 0.6]]", Retrace), ("@", Retrace)]),
    row("solids.key.prism.bottom", &[("0.1", Retrace), ("-0.5", Retrace), ("@", Retrace)]),
    row("solids.key.prism.top", &[("0.1", Retrace), ("1", Retrace), ("@", Retrace)]),
    row("solids.cube.box.min", &[("[-0.1, 0, 0]", Retrace), ("@", Retrace)]),
    row("solids.cube.box.max", &[("[0.8, 0.8, 1.5]", Retrace), ("@", Retrace)]),
    row(
        "solids.screen.polygon.points",
        &[("[[-3, 3, 0], [3, 3, 0], [0, 3, 2]]", Retrace), ("@", Retrace)],
    ),
    row("solids.ring.knot.turns", &[("[3, 2]", Retrace), ("@", Retrace)]),
    row("solids.ring.knot.tube", LENGTH),
    row("solids.ring.knot.segments", &[("[24, 9]", Retrace), ("@", Retrace)]),
    row("solids.flake.sphereflake.center", VECTOR),
    row("solids.flake.sphereflake.radius", LENGTH),
    row("solids.flake.sphereflake.levels", &[("1", Retrace), ("3", Retrace), ("@", Retrace)]),
];

/// Parameters of [`SCENE`] with [`MODELS`] whose cost the model decides.
pub(super) const GLOSSY: &[Row] = &[
    // Where Fresnel leaves too little, no parameter but the cut-off lets a branch live.
    row("trace.cutoff", &[("0.5", Refold), ("0.0001", Regrow), ("0", Regrow), ("@", Refold)]),
    row("materials.plain.shininess", EXPONENT),
    row("materials.glass.shininess", EXPONENT),
    row("materials.lamp.shininess", EXPONENT),
    row("materials.brass.shininess", &[("1", Nothing), ("@", Nothing)]),
    row(
        "materials.brass.roughness",
        &[("0.02", Refold), ("0.1", Refold), ("1", Refold), ("@", Refold)],
    ),
    row("materials.glass.roughness", &[("1", Nothing), ("@", Nothing)]),
    row("materials.brass.model", &[("hall", Refold), ("@", Refold)]),
    row("materials.brass.fresnel", &[("false", Regrow), ("@", Refold)]),
    // Hall's model weighs anyway.
    row("materials.glass.fresnel", &[("true", Nothing), ("@", Nothing)]),
    row(
        "materials.glass.transmit",
        &[("0.4", Reshade), ("0", Reshade), ("[0, 0.8, 0]", Reshade), ("@", Reshade)],
    ),
    row("materials.glass.specular", COLOR),
    row("materials.brass.ior", &[("1", Regrow), ("2.4", Regrow), ("@", Regrow)]),
    row("materials.plain.ior", &[("2.4", Nothing), ("@", Nothing)]),
    row("materials.brass.reflect", &[("0.5", Reshade), ("0", Reshade), ("@", Reshade)]),
    // Hall's model shows lights behind the screen as soon as it transmits anything.
    row(
        "materials.lamp.transmit",
        &[("0.004", Regrow), ("0", Reshade), ("0.004", Reshade), ("@", Reshade)],
    ),
];

/// Parameters of [`SCENE`] with [`OPEN`]: those of lens, shutter and filter, and some of all classes,
/// whose samples now have places, times and signs of their own.
pub(super) const LENS: &[Row] = &[
    row("camera.aperture", &[("0.2", Retrace), ("0", Retrace), ("@", Retrace)]),
    row("camera.focus", &[("4", Retrace), ("0", Retrace), ("@", Retrace)]),
    row("camera.shutter", &[("0.4", Retrace), ("0", Retrace), ("1", Retrace), ("@", Retrace)]),
    row("trace.filter", &[("gaussian", Retrace), ("box", Retrace), ("@", Retrace)]),
    row("trace.samples", &[("1", Retrace), ("4", Retrace), ("@", Retrace)]),
    row("trace.adaptive", &[("0.1", Retrace), ("0.02", Retrace), ("@", Retrace)]),
    row("trace.refine", &[("contrast", Nothing), ("trees", Nothing), ("@", Nothing)]),
    row("solids.ball.motion.translate", VECTOR),
    row("solids.ring.motion.rotate_degrees", TURN),
    row("solids.ball.motion.rotate_degrees", TURN),
    row("solids.ball.translate", VECTOR),
    row("materials.tiles.texture.checker.a", COLOR),
    row("materials.tiles.texture.checker.size", CELL),
    row("materials.plain.diffuse", COLOR),
    row("materials.mirror.shininess", EXPONENT),
    row("materials.glass.shininess", EXPONENT),
    row("materials.glass.fresnel", &[("true", Refold), ("@", Regrow)]),
    row("materials.glass.ior", &[("1", Regrow), ("2.4", Regrow), ("@", Regrow)]),
    row(
        "materials.mirror.reflect",
        &[("0.2", Reshade), ("0", Reshade), ("@", Reshade), ("1", Regrow)],
    ),
    row("materials.plain.reflect", BECOMES_MIRROR),
    row("materials.tiles.reflect", BECOMES_MIRROR),
    row("lights.key.point", &[("[-4, -5, 7.5]", Regrow), ("@", Regrow)]),
    row("lights.sun.on", &[("false", Reshade), ("true", Reshade)]),
    row("solids.ball.material", &[("plain", Regrow), ("glass", Regrow), ("@", Regrow)]),
    row("trace.depth", &[("2", Reshade), ("@", Reshade), ("5", Regrow), ("@", Reshade)]),
];
