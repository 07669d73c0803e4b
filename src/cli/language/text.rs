//! What the reference says between its tables.

use crate::scene::csg::{MOST_DEEP, MOST_PARTS};
use crate::scene::filter::Filter;
use crate::scene::light::MOST_LIGHT_RAYS;
use crate::scene::model::Model;
use crate::scene::refine::Refine;
use crate::scene::tone::Tone;
use crate::scene::{MAX_KNOT_FACES, MAX_NAMED, MAX_PIXELS, PILOTS};
use crate::viewer::hints;

/// The tables of a scene; what is none of them stands at its beginning.
pub(super) const TABLES: &[&str] =
    &["picture", "camera", "trace", "background", "lights", "materials", "solids"];

/// What stands before the first table.
pub(super) fn head() -> String {
    format!(
        "# The language of scene files\n\n\
         This is what `rayforest language` prints: its tables come from the list of fields by which \
         the program reads, writes and edits scenes, its pictures from `rayforest language --example \
         SOLID`.\n\n\
         A scene is a [TOML](https://toml.io) file in UTF-8 that begins with `version = 1`. A table \
         may be written as `[lights.key]` with a key per line, or inside of another one as `key = {{ \
         point = [0, 0, 3] }}`. A key that is not listed here is a mistake; `rayforest check FILE` \
         tells all mistakes with line, column and a way out.\n\n\
         * **Lengths** are in one unit of your choice, **angles** in degrees. Coordinates are \
         right-handed.\n\
         * **Colours** and all coefficients are linear Rec. 709: one number, or `[r, g, b]`.\n\
         * **Names** are any text, unique in their list; `\"quoted\"` where TOML asks for it. They \
         never influence the picture. At most {MAX_NAMED} lights and as many materials.\n\
         * **Files** are named relative to the scene file.\n\
         * On the command line a key is a path, such as `--set materials.glass.ior=1.33`.\n\n\
         **An edit** of a value in a scene that is open costs\n\n\
         | | what runs |\n|---|---|\n\
         | instant | shading alone: no ray is cast |\n\
         | instant up to a limit | shading, until a branch of the ray trees comes alive that was not \
         traced; the window shows the limit |\n\
         | refold | highlights are summed again from kept angles: no ray is cast |\n\
         | rereads | kept ray trees are read again: no ray is cast |\n\
         | traces some | new rays for the pixels concerned, the kept trees answer all others |\n\
         | traces all | the picture is traced anew |\n\
         | — | nothing: no picture shows it |\n\n\
         where it matters at all: an index of refraction of what neither transmits nor weighs costs \
         nothing. Two of them are the least and the most that it may cost. Whatever it is, the picture \
         is then the one that a fresh trace gives, byte for byte.\n"
    )
}

pub(super) const SCENE: &str = "At the beginning of the file, before the first table. `version = 1` \
    must be there.";

pub(super) const LOOKS: &str = "A look is a named set of differences from the scene: a table of lines \
    `path = value`, by the paths that the window and `--set` use. `look = \"NAME\"` at the beginning of the \
    file puts one on.\n\n```toml\n[looks.night]\nlights.key.on = false\nmaterials.tiles.diffuse = 0.4\n\
    background.color = [0.01, 0.02, 0.05]\n```\n\nPutting a look on costs what the edits of its lines \
    cost together; names of things and their kinds are not changed by it.";

pub(super) const CAMERA: &str = "A view from `eye` to `target`: a perspective, or a parallel view.";

pub(super) const BACKGROUND: &str =
    "What a ray sees that leaves the scene: one colour, or one of the tables below.";

pub(super) const LIGHTS: &str = "A light has exactly one of `point`, `direction`, `spot` and `area`, \
    and:";

pub(super) const TEXTURES: &str = "In place of `color`: a pattern in space, which a solid takes along when it moves, or an image.";

pub(super) const BUMPS: &str = "The shading normal is bent; the solid keeps its shape.";

/// What stands above the keys that every solid has.
pub(super) fn solids() -> String {
    format!(
        "A solid has exactly one of the shapes below, and the keys of this table. A knot has at most \
         {MAX_KNOT_FACES} faces."
    )
}

/// Each name with what it does.
fn choices(key: &str, names: &[&str]) -> String {
    let one = |name: &&str| format!("* `{key} = \"{name}\"`: {}\n", hints::choice(name));
    names.iter().map(one).collect()
}

/// What stands above the keys of the picture.
pub(super) fn picture() -> String {
    format!(
        "Its size, and how its light becomes what is shown and written as PNG: times 2^`exposure`, \
         through the `tone` curve, encoded as sRGB. OpenEXR files hold the light before that.\n\n{}",
        choices("tone", Tone::NAMES)
    )
}

pub(super) fn trace() -> String {
    format!(
        "How far and how finely rays are traced. Where `adaptive` is above 0 and `samples` above \
         {PILOTS}, a pixel gets {PILOTS} samples first, and more if they differ. A point takes at most \
         {MOST_LIGHT_RAYS} rays to all lights.\n\n{}{}",
        choices("filter", Filter::NAMES),
        choices("refine", Refine::NAMES)
    ) + &format!("\nA picture has at most {MAX_PIXELS} pixels.")
}

pub(super) fn materials() -> String {
    format!(
        "What is seen is `kloc`·(`ambient` + `diffuse` + highlights + `emission`) + `reflect`·(mirror \
         image) + `transmit`·`filter`·(what is behind). With `texture` in place of `color` it has a \
         pattern, with `bump` an uneven surface.\n\n{}",
        choices("model", Model::NAMES)
    )
}

pub(super) fn operations() -> String {
    format!(
        "Operands are named: `difference = [\"block\", \"bore\"]`. They are not seen by themselves and \
         keep their materials, placements and motions, to which those of the whole come on top; one \
         may serve several times, and be made of others itself, up to {MOST_DEEP} deep and of \
         {MOST_PARTS} plain solids in all. Polygons, sphereflakes and open meshes cannot be operands. For what is refracted the whole is one medium, \
         that of the operand by which it was entered."
    )
}
