//! A small scene for every kind of solid: what the reference shows of it.

/// What is around the solid of every sample.
pub(super) const STAGE: &str = r#"version = 1

[picture]
size = [160, 120]

[camera]
eye = [0.8, -6, 3]
target = [0, 0, -0.1]
fov_degrees = 28

[background]
gradient = { below = 0.3, level = [0.85, 0.9, 0.95], above = [0.35, 0.5, 0.75] }

[lights]
key = { point = [-4, -5, 7], intensity = 0.85 }
fill = { direction = [-1, 0.6, -0.5], intensity = [0.1, 0.12, 0.15] }

[materials]
floor = { color = [0.6, 0.58, 0.55] }
clay = { color = [0.8, 0.32, 0.18], specular = 0.25, shininess = 40 }
blue = { color = [0.16, 0.35, 0.7], specular = 0.25, shininess = 40 }
glass = { diffuse = 0.02, ambient = 0, specular = 0.7, shininess = 200, reflect = 1, transmit = 1, filter = [0.75, 0.95, 0.85], fresnel = true }

[solids]
floor = { plane = { normal = [0, 0, 1], offset = -1 }, material = "floor" }
"#;

/// What the reference says of a kind of solid.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sample {
    /// What it is, in one sentence or two.
    pub(super) about: &'static str,
    /// The lines of a scene file that make the one of the picture.
    pub(super) lines: &'static str,
}

/// The sample of the solid whose key is `key`, if there is such a kind.
pub(super) fn sample(key: &str) -> Option<Sample> {
    let (about, lines) = match key {
        "sphere" => (
            "A ball.",
            r#"ball = { sphere = { center = [0, 0, 0], radius = 1 }, material = "clay" }"#,
        ),
        "plane" => (
            "All that is behind an infinite plane. It cannot move.",
            r#"bank = { plane = { normal = [0.6, -1, 1.4], offset = -1 }, material = "blue" }"#,
        ),
        "box" => (
            "A box along the axes, between two corners.",
            r#"block = { box = { min = [-1, -0.7, -1], max = [1, 0.7, 0.2] }, material = "clay", rotate_degrees = [0, 0, 30] }"#,
        ),
        "cylinder" => (
            "A round rod with flat ends.",
            r#"rod = { cylinder = { from = [-0.8, -0.3, -0.5], to = [0.8, 0.3, 0.4], radius = 0.5 }, material = "clay" }"#,
        ),
        "cone" => (
            "A cone; with a `tip` above 0 its point is cut off.",
            r#"hat = { cone = { from = [0, 0, -1], to = [0, 0, 1], radius = 1, tip = 0.3 }, material = "clay" }"#,
        ),
        "torus" => (
            "A ring around the z axis. If `minor` is larger than `major` there is no hole, and what the tube covers twice is inside.",
            r#"ring = { torus = { major = 0.85, minor = 0.35 }, material = "clay", rotate_degrees = [25, 10, 0] }"#,
        ),
        "ellipsoid" => (
            "A ball with a radius of its own along each axis.",
            r#"egg = { ellipsoid = { center = [0, 0, 0], radii = [1.3, 0.7, 0.8] }, material = "clay", rotate_degrees = [0, 20, 20] }"#,
        ),
        "quadric" => (
            "Where a·x² + b·y² + c·z² + d·yz + e·zx + f·xy + g·x + h·y + i·z + constant ≤ 0, within a box: `squares` are a, b, c, `products` d, e, f, `linear` g, h, i.",
            r#"spool = { quadric = { squares = [1, 1, -1], constant = -0.15, min = [-1.2, -1.2, -1], max = [1.2, 1.2, 1] }, material = "clay" }"#,
        ),
        "prism" => (
            "A flat outline in x and y, swept from `bottom` to `top`: one loop of points, or a list of loops. A point around which an odd number of loops runs is inside, so further loops are holes. Loops do not cross.",
            r#"key = { prism = { outline = [[[-1, -1], [1, -1], [1, 0], [0, 0], [0, 1], [-1, 1]], [[-0.7, -0.7], [-0.2, -0.7], [-0.2, -0.2], [-0.7, -0.2]]], bottom = -1, top = -0.3 }, material = "clay", rotate_degrees = [0, 0, 20] }"#,
        ),
        "polygon" => (
            "A flat surface without thickness, which may be concave. It has no inside: it does not refract and is no operand.",
            r#"kite = { polygon = { points = [[-1, 0, -0.9], [0, 0.2, -0.3], [1, 0, -0.9], [0, 0.6, 0.9]] }, material = "clay" }"#,
        ),
        "mesh" => (
            "The triangles of all objects of an OBJ file. A closed one, in which every edge belongs to two triangles that run along it in opposite directions, has an inside.",
            r#"gem = { mesh = { file = "gem.obj" }, material = "clay" }"#,
        ),
        "knot" => (
            "A tube around a torus knot, as a closed mesh.",
            r#"knot = { knot = { turns = [2, 3], tube = 0.35, segments = [240, 40] }, material = "clay", scale = 0.75, rotate_degrees = [30, 0, 0] }"#,
        ),
        "sphereflake" => (
            "A ball that carries nine balls of a third of its radius, which carry nine each, and so on.",
            r#"flake = { sphereflake = { center = [0, 0, -0.4], radius = 0.6, levels = 3 }, material = "clay" }"#,
        ),
        _ => return operation(key),
    };
    Some(Sample { about, lines })
}

/// The same of what is made of other solids.
fn operation(key: &str) -> Option<Sample> {
    let (about, lines) = match key {
        "union" => (
            "A group of solids, which are placed and moved together. Every surface stays, inside of others too.",
            r#"left = { sphere = { center = [-0.5, 0, 0], radius = 0.8 }, material = "glass" }
right = { sphere = { center = [0.5, 0, 0], radius = 0.8 }, material = "glass" }
both = { union = ["left", "right"] }"#,
        ),
        "merge" => (
            "Solids made one: surfaces inside of others are not there.",
            r#"left = { sphere = { center = [-0.5, 0, 0], radius = 0.8 }, material = "glass" }
right = { sphere = { center = [0.5, 0, 0], radius = 0.8 }, material = "glass" }
both = { merge = ["left", "right"] }"#,
        ),
        "intersection" => (
            "What is in every operand.",
            r#"front = { sphere = { center = [0.4, -0.5, 0], radius = 1.1 }, material = "clay" }
back = { sphere = { center = [-0.4, 0.5, 0], radius = 1.1 }, material = "blue" }
lens = { intersection = ["front", "back"] }"#,
        ),
        "difference" => (
            "The first operand without the others; their order counts.",
            r#"block = { box = { min = [-0.9, -0.9, -1], max = [0.9, 0.9, 0.6] }, material = "clay" }
bore = { cylinder = { from = [0, -2, -0.2], to = [0, 2, -0.2], radius = 0.45 }, material = "blue" }
bite = { sphere = { center = [-0.9, -0.9, 0.6], radius = 0.7 }, material = "blue" }
part = { difference = ["block", "bore", "bite"], rotate_degrees = [0, 0, 20] }"#,
        ),
        "complement" => (
            "All that is in no operand; it has no end, and serves as an operand itself.",
            r#"block = { box = { min = [-0.9, -0.9, -1], max = [0.9, 0.9, 0.7] }, material = "clay" }
ball = { sphere = { center = [0.9, -0.9, 0.7], radius = 1.2 }, material = "blue" }
outside = { complement = ["ball"] }
part = { intersection = ["block", "outside"], rotate_degrees = [0, 0, -20] }"#,
        ),
        _ => return None,
    };
    Some(Sample { about, lines })
}

/// The whole scene of the picture.
pub(super) fn scene(sample: Sample) -> String {
    format!("{STAGE}{}\n", sample.lines)
}
