//! What every parameter means, in one sentence, and the part of its range that a slider covers.

use std::ops::RangeInclusive;

use crate::scene::range::Range;

/// What the parameter with this key is for, with its unit.
pub(super) fn about(key: &str) -> &'static str {
    match key {
        "ambient_light" => "Light that reaches every surface from everywhere, times its ambient",
        "eye" => "Where the eye is, in units of the scene",
        "target" => "The point in the middle of the picture",
        "up" => "Which way is up, in the picture or in the sky",
        "fov_degrees" => "Vertical angle of view, in degrees",
        "height" => {
            "Height of the view of a parallel camera; of a bump: of its tops; in units of the scene"
        }
        "aperture" => {
            "Diameter of the lens, in units of the scene: 0 is a pinhole, which blurs nothing; needs \
             several samples"
        }
        "focus" => {
            "Distance in focus, along the view, in units of the scene; 0: that of the target"
        }
        "shutter" => "Share of the solids' motion that the picture sees; 0: it stands still",
        "size" => {
            "Of the picture: width and height in pixels. Of a checker: side of a cube; of marble and \
             wood: distance of veins, width of rings; in units of the scene. Of an image: what it \
             covers"
        }
        "exposure" => "Brightness of the picture in stops: +1 doubles it",
        "samples" => {
            "Rays, of a picture from the eye through every pixel, of a light with an area from every \
             point to it: more give smoother edges"
        }
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
        "direction" => "The direction in which the light shines; of marble: across its veins",
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
        "filter" => {
            "Colour that light takes on at every surface that it passes; of the trace: how a pixel \
             weighs its surroundings"
        }
        "ior" => "Index of refraction: air 1, water 1.33, glass 1.5, diamond 2.42",
        "material" => "The material of the solid",
        _ => about_form(key),
    }
}

/// The same of the keys of solids, cameras and lights' places.
fn about_form(key: &str) -> &'static str {
    match key {
        "center" => {
            "Centre, of a solid in its own coordinates; of wood and waves, where rings begin, in the world"
        }
        "radius" => "Radius; of a cone at from",
        "normal" => "Points out of the solid, or stands on the disc; its length does not matter",
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
        "rotate_degrees" => {
            "Turns about x, then y, then z, in degrees; of a motion: how much farther it turns"
        }
        "translate" => {
            "Moves the solid, after scale and turn; of a motion: how far it goes from there"
        }
        "scale" => {
            "Makes the solid larger or smaller, first of all; of a bump: its length in units of the scene"
        }
        key => about_pattern(key),
    }
}

/// The same of what only patterns, bumps and backgrounds have.
fn about_pattern(key: &str) -> &'static str {
    match key {
        "a" => "First colour: of every other square, of stone, of early wood, of the start",
        "b" => "Second colour: of the other squares, of veins, of late wood, of the end",
        "file" => "The file; a mesh can be changed in the scene file",
        "from" => "Where it begins: one end of the solid, or the first colour",
        "to" => "Where it ends: the other end of the solid, or the second colour",
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
pub(super) fn choice(name: &str) -> &'static str {
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
        "point" => "A light at a point, in all directions",
        "direction" => "A light infinitely far away",
        "spot" => "A light at a point, into a cone",
        "rectangle" => "A light all over a rectangle: soft shadows",
        "disc" => "A light all over a disc: soft shadows",
        "sphere" => "A light as large as a ball: soft shadows",
        _ => "",
    }
}

/// What choosing this kind of paint, bump or background does.
pub(super) fn kind(name: &str) -> &'static str {
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
        _ => "",
    }
}

/// Whether a triple of numbers is looked at as a colour rather than as three strengths.
pub(super) fn is_color(key: &str) -> bool {
    let of_patterns = matches!(key, "a" | "b" | "tint" | "below" | "level" | "above");
    of_patterns || matches!(key, "color" | "filter" | "emission" | "ambient_light")
}

/// How a slider shows a number.
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
    use crate::scene::fields::{BACKGROUNDS, BUMPS, LENSES, SHAPES, TEXTURES};
    use crate::scene::filter::Filter;
    use crate::scene::model::Model;
    use crate::scene::path::parameters;
    use crate::scene::refine::Refine;
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
                let key = parameter.path.rsplit('.').next().unwrap();
                assert!(!about(key).is_empty(), "{}", parameter.path);
            }
        }
        assert_eq!(about("no such key"), "");
    }

    #[test]
    fn every_choice_is_explained() {
        for name in Model::NAMES.iter().chain(Filter::NAMES).chain(Refine::NAMES) {
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
