//! What every parameter means, in one sentence, and the part of its range that a slider covers.

use std::ops::RangeInclusive;

use crate::scene::range::Range;

/// What the parameter with this key is for, with its unit; `table` is the key of the table in which it
/// stands, empty for that of a light, a material or a solid.
pub(crate) fn about(table: &str, key: &str) -> &'static str {
    match (table, key) {
        ("picture", "size") => "Width and height of the picture in pixels",
        ("checker", "size") => "Side of a cube, in units of the scene",
        ("marble", "size") => "Distance of veins, in units of the scene",
        ("wood", "size") => "Width of a ring, in units of the scene",
        ("image", "size") => "What the image covers, in units of the scene",
        ("camera", "height") => "Height of the view of a parallel camera, in units of the scene",
        ("noise" | "waves" | "image", "height") => "Height of its tops, in units of the scene",
        ("noise" | "waves", "scale") => "Length of its bumps, in units of the scene",
        ("trace", "samples") => "Rays from the eye through every pixel: more give smoother edges",
        ("", "samples") => {
            "Rays from every point to a light with an area: more give smoother shadows"
        }
        ("", "direction") => "The direction in which the light shines",
        ("marble", "direction") => "Across its veins",
        ("trace", "filter") => "How a pixel weighs its surroundings",
        ("", "filter") => "Colour that light takes on at every surface that it passes",
        ("camera", "up") => "Which way is up in the picture",
        ("gradient", "up") => "Which way is up in the sky",
        ("wood" | "waves", "center") => "Where rings begin, in the world",
        ("rectangle" | "disc", "center") => "Its middle, in the world",
        ("plane", "normal") => "Points out of the solid; its length does not matter",
        ("disc", "normal") => "Stands on the disc; its length does not matter",
        ("cone", "radius") => "Radius at from",
        ("gradient", "from") => "Where the first colour is",
        ("gradient", "to") => "Where the second colour is",
        ("cylinder" | "cone", "from") => "Middle of one end",
        ("cylinder" | "cone", "to") => "Middle of the other end",
        ("mesh", "file") => "An OBJ file, sought beside the scene file; it is changed there alone",
        ("image", "file") => "A PNG, JPEG or HDR file, sought beside the scene file",
        ("motion", "rotate_degrees") => "How much farther it turns",
        ("motion", "translate") => "How far it goes from there",
        ("", "rotate_degrees") => "Turns about x, then y, then z, in degrees",
        ("", "translate") => "Moves the solid, after scale and turn",
        ("", "scale") => "Makes the solid larger or smaller, first of all",
        (_, key) => about_key(key),
    }
}

/// The same of what means one thing wherever it stands.
fn about_key(key: &str) -> &'static str {
    match key {
        "ambient_light" => "Light that reaches every surface from everywhere, times its ambient",
        "eye" => "Where the eye is, in units of the scene",
        "target" => "The point in the middle of the picture",
        "fov_degrees" => "Vertical angle of view, in degrees",
        "aperture" => {
            "Diameter of the lens, in units of the scene: 0 is a pinhole, which blurs nothing; needs \
             several samples"
        }
        "focus" => {
            "Distance in focus, along the view, in units of the scene; 0: that of the target"
        }
        "shutter" => "Share of the solids' motion that the picture sees; 0: it stands still",
        "exposure" => "Brightness of the picture in stops: +1 doubles it",
        "tone" => "How light brighter than white is shown: cut off, or compressed",
        "refine" => {
            "What of neighbouring samples is compared: trees: what rays met, and cosines; contrast: \
             colours, decided again after every edit"
        }
        "adaptive" => {
            "0: every pixel gets all samples; above: pixels whose samples differ less than this get fewer"
        }
        "depth" => "Longest chain of reflections and refractions that is followed",
        "cutoff" => "Branches that weigh less than this are not followed",
        "color" => "Colour, linear Rec. 709",
        "point" => "Where the light is",
        "at" => "Where the light is",
        "towards" => "A point that the light shines at",
        "angle_degrees" => "Angle between the middle and the rim of the cone of light, in degrees",
        "edge" => "The outer part of the angle in which the light fades: 0 for a sharp rim",
        "along" => "One edge of the rectangle, from corner to corner",
        "across" => "The other edge of the rectangle",
        "falloff" => {
            "The distance at which the light has its intensity, beyond which it weakens with the \
             square of the distance; 0: equally strong everywhere"
        }
        "intensity" => "Strength of the light: a surface that faces it shows diffuse times this",
        "on" => "Whether the light shines",
        "kloc" => {
            "Weight of all light of the surface itself against what it reflects and transmits"
        }
        "ambient" => "Share of the ambient light that the surface shows",
        "diffuse" => "Matte light: the surface's colour under each light (Lambert)",
        "model" => "How highlights spread: Phong, Blinn, Cook-Torrance or Hall",
        "specular" => "Strength of the highlights",
        "shininess" => {
            "Exponent of Phong, Blinn and Hall: higher makes highlights smaller (Blinn's and \
             Hall's are as wide as Phong's at four times the exponent)"
        }
        "roughness" => "Slope of the facets of Cook-Torrance: higher makes highlights larger",
        "fresnel" => {
            "Whether reflect and transmit depend on the angle and ior as in nature: more is \
             mirrored at grazing angles"
        }
        "metallic" => "0: white highlights; 1: highlights in the colour of the surface",
        "gloss" => {
            "How sharp the mirror image is: an exponent, lower is blurrier; 0 is perfectly sharp"
        }
        "translucency" => {
            "How sharp what shines through is: an exponent, lower is blurrier; 0 is perfectly sharp"
        }
        "emission" => "Light that the surface gives off by itself",
        "reflect" => "Share of the mirror image",
        "transmit" => "Share of what is seen through the surface",
        "ior" => "Index of refraction: air 1, water 1.33, glass 1.5, diamond 2.42",
        "density" => {
            "Mass per cubic unit of length, for the mass of solids; the picture does not show it"
        }
        "material" => "The material of the solid",
        _ => about_form(key),
    }
}

/// The same of the keys of solids, cameras and lights' places.
fn about_form(key: &str) -> &'static str {
    match key {
        "center" => "Its centre, of a solid in its own coordinates",
        "radius" => "Its radius",
        "offset" => "Distance of the plane from the origin along its normal",
        "min" => "Lowest corner",
        "max" => "Highest corner",
        "points" => "Corners in order",
        "major" => "Radius of the circle in the middle of the tube",
        "minor" => "Radius of the tube; above major there is no hole",
        "tip" => "Radius at the end; 0 is a point",
        "radii" => "Radius along each axis",
        "squares" => "How much of x², y² and z²",
        "products" => "How much of yz, zx and xy",
        "linear" => "How much of x, y and z",
        "constant" => "What the function is at the origin; the solid is where it is not above 0",
        "outline" => "Corners in order, of the outline and of its holes",
        "bottom" => "Lower height",
        "top" => "Upper height",
        "turns" => "Turns around the axis and through the hole: no common divisor",
        "tube" => "Radius of the tube; the knot's own radius is 1",
        "segments" => "Segments along and around the tube",
        "levels" => "Generations of spheres",
        "priority" => "Where solids overlap, the one with the highest priority is there",
        "union" => "The solids that it groups; each keeps its whole surface",
        "merge" => "The solids that it joins: surfaces inside of others are not there",
        "intersection" => "The solids that it is the common part of",
        "difference" => "A solid, and those that are cut out of it",
        "complement" => "The solids that it is everything but",
        key => about_pattern(key),
    }
}

/// The same of what only patterns, bumps and backgrounds have.
fn about_pattern(key: &str) -> &'static str {
    match key {
        "a" => "First colour: of every other square, of stone, of early wood, of the start",
        "b" => "Second colour: of the other squares, of veins, of late wood, of the end",
        "axis" => "Along the trunk that the wood is of",
        "turbulence" => "How much veins and rings are folded: 0 is even",
        "tint" => "Colour that the image is multiplied by",
        "below" => "Colour of the sky opposite to up",
        "level" => "Colour of the sky at the horizon",
        "above" => "Colour of the sky along up",
        "turn_degrees" => "Turns the panorama to the left, in degrees",
        _ => "",
    }
}

/// What choosing the thing of this name does.
pub(crate) fn choice(name: &str) -> &'static str {
    match name {
        "phong" => "Highlights around the mirrored lights: (R·V)^shininess",
        "blinn" => "Highlights that stretch at grazing angles: (N·H)^shininess",
        "cook_torrance" => "Highlights of rough facets: roughness and ior shape them",
        "hall" => {
            "Blinn's highlights weighted by Fresnel, lights shining through, Fresnel's mirror"
        }
        "box" => "The pixel's own square, evenly: as sharp as its samples",
        "tent" => "Nearer light counts more, up to the next pixel's centre: smooth",
        "mitchell" => "Sharp and smooth; beside strong edges it may overshoot a little",
        "gaussian" => "Very smooth, a little soft",
        "trees" => "What rays met and how they met it: colours do not matter",
        "contrast" => "The colours that samples show",
        "none" => "Light as it is; what is brighter than white is cut off",
        "neutral" => {
            "Khronos PBR Neutral: colours as they are up to 0.8, highlights compressed instead of cut off"
        }
        "point" => "A light at a point, in all directions",
        "direction" => "A light infinitely far away",
        "spot" => "A light at a point, into a cone",
        "rectangle" => "A light all over a rectangle: soft shadows",
        "disc" => "A light all over a disc: soft shadows",
        "sphere" => "A light as large as a ball: soft shadows",
        _ => "",
    }
}

/// What choosing this kind of paint, bump, background or operation does.
pub(crate) fn kind(name: &str) -> &'static str {
    match name {
        "color" => "One colour everywhere",
        "checker" => "Cubes of two colours",
        "gradient" => "Colours that change evenly from one place or direction to another",
        "marble" => "Stone with veins",
        "wood" => "Rings of a trunk",
        "image" => "A PNG, JPEG or HDR file; you are asked for it",
        "none" => "A smooth surface",
        "noise" => "Irregular bumps",
        "waves" => "Rings as of a drop in water",
        "union" => "A group: every surface stays, inside of others too",
        "merge" => "One solid: surfaces inside of others are not there",
        "intersection" => "What is in every operand",
        "difference" => "The first operand without the others",
        "complement" => "All that is in no operand",
        _ => "",
    }
}

/// Whether a triple of numbers is looked at as a colour rather than as three strengths.
pub(super) fn is_color(key: &str) -> bool {
    let of_patterns = matches!(key, "a" | "b" | "tint" | "below" | "level" | "above");
    of_patterns || matches!(key, "color" | "filter" | "emission" | "ambient_light")
}

/// How a slider shows a number.
#[derive(Clone, Debug)]
pub(super) struct Scale {
    /// What the slider covers; typed values may lie outside, within the parameter's own range.
    pub(super) span: RangeInclusive<f64>,
    /// Whether equal ways are equal factors.
    pub(super) logarithmic: bool,
}

/// The slider for a parameter, wide enough for its present value.
pub(super) fn scale(key: &str, range: Range, value: f64) -> Scale {
    let (low, high, logarithmic) = match key {
        "shininess" | "gloss" | "translucency" => (0.0, 1000.0, true),
        "density" => (0.0, 25.0, false),
        "falloff" => (0.0, 20.0, false),
        "angle_degrees" => (1.0, 90.0, false),
        "ior" => (1.0, 2.5, false),
        "exposure" => (-5.0, 5.0, false),
        "intensity" => (0.0, 2.0, false),
        "samples" => (1.0, 64.0, true),
        "depth" => (0.0, 20.0, false),
        "cutoff" => (0.0, 0.1, false),
        "fov_degrees" => (5.0, 120.0, false),
        "levels" => (1.0, 6.0, false),
        "turbulence" => (0.0, 4.0, false),
        _ => (range.low.max(0.0), range.high.min(1.0), false),
    };
    Scale { span: low.min(value)..=high.max(value), logarithmic }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::fields::{BACKGROUNDS, BUMPS, LENSES, LISTS, SHAPES, TEXTURES};
    use crate::scene::filter::Filter;
    use crate::scene::model::Model;
    use crate::scene::path::parameters;
    use crate::scene::refine::Refine;
    use crate::scene::tone::Tone;
    use crate::scene::{
        Background, Bump, Lens, Light, LightPlace, Material, Paint, Scene, Shape, Solid,
    };

    #[test]
    fn every_parameter_is_explained() {
        let mut scene = Scene::default();
        for kind in LightPlace::KINDS {
            scene.lights.push(Light { place: LightPlace::of_kind(kind), ..Light::new(kind) });
            assert!(!choice(kind).is_empty(), "{kind}");
        }
        scene.materials.push(Material::new("plain"));
        for key in TEXTURES {
            scene.materials.push(Material { paint: Paint::named(key), ..Material::new(*key) });
            assert!(!kind(key).is_empty(), "{key}");
        }
        for key in BUMPS {
            let name = format!("bumpy {key}");
            scene.materials.push(Material { bump: Bump::named(key), ..Material::new(name) });
            assert!(!kind(key).is_empty(), "{key}");
        }
        for key in SHAPES {
            scene.solids.push(Solid::new(*key, Shape::named(key), 0));
        }
        for (lens, sky) in LENSES.iter().cycle().zip(BACKGROUNDS) {
            scene.camera.lens = Lens::named(lens);
            scene.background = Background::named(sky);
            assert!(!kind(sky).is_empty(), "{sky}");
            for parameter in parameters(&scene) {
                let keys: Vec<&str> = parameter.path.split('.').collect();
                let table = match keys[..] {
                    [list, _, _] if LISTS.contains(&list) => "",
                    [.., table, _] => table,
                    _ => "",
                };
                let key = keys[keys.len() - 1];
                assert!(!about(table, key).is_empty(), "{}", parameter.path);
            }
        }
        assert_eq!(about("", "no such key"), "");
    }

    #[test]
    fn every_choice_is_explained() {
        let names = [Model::NAMES, Filter::NAMES, Refine::NAMES, Tone::NAMES];
        for name in names.into_iter().flatten() {
            assert!(!choice(name).is_empty(), "{name}");
        }
        assert_eq!(choice("no such name"), "");
    }

    #[test]
    fn a_slider_covers_the_present_value() {
        let range = Range::closed(0.0, 1e6);
        assert_eq!(scale("diffuse", range, 0.5).span, 0.0..=1.0);
        assert_eq!(scale("diffuse", range, 7.5).span, 0.0..=7.5);
        assert_eq!(scale("exposure", Range::closed(-30.0, 30.0), -9.0).span, -9.0..=5.0);
        assert!(scale("shininess", range, 10.0).logarithmic);
    }
}
