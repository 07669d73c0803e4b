//! Colours that vary: what a surface, a bump and the background are made of.

use std::sync::Arc;

use glam::DVec3;

use super::texture::Image;
use crate::color::Rgb;

/// An image file and what it held when the scene was read.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ImageFile {
    /// As written in the scene, relative to the scene's file.
    pub file: String,
    /// What the file held.
    pub image: Arc<Image>,
}

/// Colour of a surface: one colour per *slot*; geometry decides which slots a point shows, and how
/// much of each.
///
/// All patterns but the image are solid: they are functions of the point in world space.
#[derive(Clone, Debug, PartialEq)]
pub enum Paint {
    /// One colour everywhere: slot 0.
    Solid(Rgb),
    /// World-space cubes of side `size` in two colours: `a` is slot 0, `b` slot 1. The cube that
    /// contains a point just above the origin on every axis is `a`.
    Checker {
        /// Colour of slot 0.
        a: Rgb,
        /// Colour of slot 1.
        b: Rgb,
        /// Side of a cube, world units, > 0.
        size: f64,
    },
    /// From one colour to another along a line; beyond its ends the colour stays.
    Gradient {
        /// Colour of slot 0, at `from`.
        a: Rgb,
        /// Colour of slot 1, at `to`.
        b: Rgb,
        /// World space.
        from: DVec3,
        /// World space; differs from `from`.
        to: DVec3,
    },
    /// Thin veins in a ground, in layers that turbulence folds.
    Marble {
        /// Colour of slot 0: the ground.
        a: Rgb,
        /// Colour of slot 1: the veins.
        b: Rgb,
        /// Distance of two veins, world units, > 0.
        size: f64,
        /// Across the layers; of any length, not zero.
        direction: DVec3,
        /// How far veins are moved, in units of `size`; 0 = flat layers.
        turbulence: f64,
    },
    /// Rings around an axis, light in spring and dark in autumn, with a fine grain along it.
    Wood {
        /// Colour of slot 0: early wood.
        a: Rgb,
        /// Colour of slot 1: late wood.
        b: Rgb,
        /// Width of a ring, world units, > 0.
        size: f64,
        /// A point of the axis, world space.
        center: DVec3,
        /// Along the trunk; of any length, not zero.
        axis: DVec3,
        /// How far rings are moved, in units of `size`; 0 = circles.
        turbulence: f64,
    },
    /// The texels of an image, times a tint, laid out by the surface's u-v.
    Image {
        /// What is shown.
        image: ImageFile,
        /// Multiplies every texel.
        tint: Rgb,
        /// What the image covers in u and in v, > 0; it is repeated beyond.
        size: f64,
    },
}

/// Small unevenness of a surface, which bends its shading normal and nothing else.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Bump {
    /// Smooth.
    #[default]
    None,
    /// Noise in world space.
    Noise {
        /// Half the height between valleys and tops, world units; negative turns them over.
        height: f64,
        /// Size of the largest bumps, world units, > 0.
        scale: f64,
    },
    /// Rings around a point, as where a drop fell into water.
    Waves {
        /// Half the height between valleys and crests, world units.
        height: f64,
        /// Length of a wave, world units, > 0.
        scale: f64,
        /// World space.
        center: DVec3,
    },
    /// The mean of an image's channels, laid out by the surface's u-v.
    Image {
        /// White is high.
        image: ImageFile,
        /// Height of white over black, world units; negative turns them over.
        height: f64,
        /// What the image covers in u and in v, > 0; it is repeated beyond.
        size: f64,
    },
}

/// `[background]`: what a ray sees that leaves the scene, by its direction.
#[derive(Clone, Debug, PartialEq)]
pub enum Background {
    /// One colour in every direction: slot 0.
    Color(Rgb),
    /// Three colours between two poles.
    Gradient {
        /// Colour of slot 0, opposite to `up`.
        below: Rgb,
        /// Colour of slot 1, at right angles to `up`.
        level: Rgb,
        /// Colour of slot 2, along `up`.
        above: Rgb,
        /// Of any length, not zero.
        up: DVec3,
    },
    /// A panorama of all directions (equirectangular): its upper edge is +z, its middle +y.
    Image {
        /// What is seen.
        image: ImageFile,
        /// Multiplies every texel.
        tint: Rgb,
        /// Turns what is seen about z, to the left.
        turn_degrees: f64,
    },
}

impl Background {
    /// The colour, if it is the same in every direction.
    pub fn color(&self) -> Option<Rgb> {
        match self {
            Background::Color(color) => Some(*color),
            Background::Gradient { .. } | Background::Image { .. } => None,
        }
    }

    /// How many slots it has. An image has one for what its texels multiply, and a black one that
    /// says where it is seen, were all texels there black.
    pub fn slots(&self) -> usize {
        match self {
            Background::Color(_) => 1,
            Background::Gradient { .. } => 3,
            Background::Image { .. } => 2,
        }
    }

    /// What a slot is called, for people; empty if there is nothing to tell apart.
    pub fn slot_name(&self, slot: usize) -> &'static str {
        match self {
            Background::Gradient { .. } => ["below", "level", "above"].get(slot).unwrap_or(&""),
            Background::Color(_) | Background::Image { .. } => "",
        }
    }
}

impl Paint {
    /// How many slots it has. An image has one for what its texels multiply, and one for the rest:
    /// emission, and white highlights.
    pub fn slots(&self) -> usize {
        match self {
            Paint::Solid(_) => 1,
            _ => 2,
        }
    }

    /// What a slot is called, for people; empty if there is nothing to tell apart.
    pub fn slot_name(&self, slot: usize) -> &'static str {
        match (self, slot) {
            (Paint::Solid(_), _) | (Paint::Image { .. }, 0) => "",
            (Paint::Image { .. }, _) => "plain",
            (_, 0) => "a",
            _ => "b",
        }
    }

    /// One colour that stands for all of them: their mean, or an image's tint.
    pub fn mean(&self) -> Rgb {
        match self {
            Paint::Solid(color) => *color,
            Paint::Image { tint, .. } => *tint,
            Paint::Checker { a, b, .. }
            | Paint::Gradient { a, b, .. }
            | Paint::Marble { a, b, .. }
            | Paint::Wood { a, b, .. } => (*a + *b) * 0.5,
        }
    }

    /// A paint of another kind, named as in a scene file, with this one's colours.
    pub fn turned_into(&self, kind: &str) -> Paint {
        let (first, second) = match self {
            Paint::Solid(color) => (*color, *color * 0.5),
            Paint::Image { tint, .. } => (*tint, *tint * 0.5),
            Paint::Checker { a, b, .. }
            | Paint::Gradient { a, b, .. }
            | Paint::Marble { a, b, .. }
            | Paint::Wood { a, b, .. } => (*a, *b),
        };
        let mut paint = Paint::named(kind);
        match &mut paint {
            Paint::Solid(color) => *color = first,
            // What the image shows has its own colours.
            Paint::Image { .. } => {}
            Paint::Checker { a, b, .. }
            | Paint::Gradient { a, b, .. }
            | Paint::Marble { a, b, .. }
            | Paint::Wood { a, b, .. } => (*a, *b) = (first, second),
        }
        paint
    }
}

impl Bump {
    /// The image that it reads.
    pub fn image(&self) -> Option<&ImageFile> {
        match self {
            Bump::Image { image, .. } => Some(image),
            Bump::None | Bump::Noise { .. } | Bump::Waves { .. } => None,
        }
    }

    /// Whether it bends normals as `other` does; of which file an image was read does not matter.
    pub fn bends_like(&self, other: &Bump) -> bool {
        match (self, other) {
            (
                Bump::Image { image, height, size },
                Bump::Image { image: image2, height: height2, size: size2 },
            ) => (&image.image, height, size) == (&image2.image, height2, size2),
            _ => self == other,
        }
    }

    /// The same, to be changed.
    pub(super) fn image_mut(&mut self) -> Option<&mut ImageFile> {
        match self {
            Bump::Image { image, .. } => Some(image),
            Bump::None | Bump::Noise { .. } | Bump::Waves { .. } => None,
        }
    }
}
