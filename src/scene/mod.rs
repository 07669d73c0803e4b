//! What the user wrote: a plain value, compared, cloned and edited freely, that knows nothing of rays.
//!
//! Every struct here is destructured without `..` in `fields.rs` (names, ranges, reading, writing)
//! and in `change.rs` (what an edit of the field costs): a new field does not compile until both
//! are decided.

pub mod change;
pub mod check;
pub mod csg;
mod defaults;
mod direction;
pub mod energy;
pub mod factor;
pub mod fields;
pub mod filter;
mod inside;
pub mod light;
pub mod look;
pub mod mesh;
pub mod model;
pub mod motion;
mod obj;
mod outline;
mod paint;
pub mod path;
pub mod problem;
pub mod range;
pub mod read;
mod read_looks;
mod reader;
pub mod refine;
pub(crate) mod relative;
pub mod seams;
pub mod slot;
pub mod texture;
pub(crate) mod toml_text;
pub mod tone;
pub mod value;
pub mod write;

use std::sync::Arc;

use glam::{DVec2, DVec3};

use crate::color::Rgb;
use csg::Operation;
use filter::Filter;
pub use light::{Area, Light, LightPlace};
use look::Looks;
use mesh::Mesh;
use model::Model;
use motion::Motion;
pub use paint::{Background, Bump, ImageFile, Paint};
use refine::Refine;
use tone::Tone;

/// A whole scene. Lengths are in one unit of the user's choice, colours linear Rec. 709.
///
/// The order of `lights`, `materials` and `solids` is the order of the scene file; materials are
/// referred to by their index. Names are unique within their list and never influence the picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Scene {
    /// Light that reaches every surface from everywhere; multiplies each material's `ambient`.
    pub ambient_light: Rgb,
    /// Size of the picture, and how its light is shown.
    pub picture: Picture,
    /// Where the eye is and what it sees.
    pub camera: Camera,
    /// What a ray sees that leaves the scene.
    pub background: Background,
    /// How far and how finely rays are traced.
    pub trace: Trace,
    /// Lights, in file order.
    pub lights: Vec<Light>,
    /// Materials, in file order.
    pub materials: Vec<Material>,
    /// Solids and surfaces, in file order.
    pub solids: Vec<Solid>,
    /// Named sets of differences, of which one may be worn: it is in all values above.
    pub looks: Looks,
}

impl Scene {
    /// The image files that it reads: the background's, then every material's colours and bump.
    pub fn images(&self) -> impl Iterator<Item = &ImageFile> {
        let sky = match &self.background {
            Background::Image { image, .. } => Some(image),
            Background::Color(_) | Background::Gradient { .. } => None,
        };
        fn of(material: &Material) -> impl Iterator<Item = &ImageFile> {
            let paint = match &material.paint {
                Paint::Image { image, .. } => Some(image),
                _ => None,
            };
            [paint, material.bump.image()].into_iter().flatten()
        }
        sky.into_iter().chain(self.materials.iter().flat_map(of))
    }

    /// Calls `each` with the name of every mesh and image file.
    pub fn each_file(&mut self, each: &mut dyn FnMut(&mut String)) {
        for solid in &mut self.solids {
            if let Shape::Mesh { file, mesh: _ } = &mut solid.shape {
                each(file);
            }
        }
        self.images_mut().for_each(|image| each(&mut image.file));
    }

    /// The image files, to be changed.
    fn images_mut(&mut self) -> impl Iterator<Item = &mut ImageFile> {
        let sky = match &mut self.background {
            Background::Image { image, .. } => Some(image),
            Background::Color(_) | Background::Gradient { .. } => None,
        };
        fn of(material: &mut Material) -> impl Iterator<Item = &mut ImageFile> {
            let paint = match &mut material.paint {
                Paint::Image { image, .. } => Some(image),
                _ => None,
            };
            [paint, material.bump.image_mut()].into_iter().flatten()
        }
        sky.into_iter().chain(self.materials.iter_mut().flat_map(of))
    }
}

/// `[picture]`.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Width and height in pixels, each 1 … [`MAX_SIDE`], at most [`MAX_PIXELS`] together.
    pub size: [u32; 2],
    /// Stops: the picture is multiplied by 2^exposure before it is encoded.
    pub exposure: f32,
    /// What is done with light that is brighter than white.
    pub tone: Tone,
}

/// Longest side of a picture, in pixels.
pub const MAX_SIDE: u32 = 65_536;
/// Largest number of pixels of a picture.
pub const MAX_PIXELS: u64 = 1 << 28;
/// Highest priority of a material.
pub const MAX_PRIORITY: u32 = 1000;
/// Largest number of materials, and of lights.
pub const MAX_NAMED: usize = 65_535;
/// Largest number of quadrangles of a knot: segments along times segments around.
pub const MAX_KNOT_FACES: u64 = 1 << 22;

/// `[camera]`: a right-handed view from `eye` towards `target`.
#[derive(Clone, Debug, PartialEq)]
pub struct Camera {
    /// Position of the eye, world space.
    pub eye: DVec3,
    /// The point in the middle of the picture; differs from `eye`.
    pub target: DVec3,
    /// Which way is up; not parallel to the view.
    pub up: DVec3,
    /// Perspective or parallel projection.
    pub lens: Lens,
    /// Diameter of the perspective's lens, world units, ≥ 0. 0 is a pinhole, and so is a parallel
    /// view.
    pub aperture: f64,
    /// Distance of the plane in focus from the eye's plane, along the view, world units, ≥ 0; 0
    /// stands for that of `target`.
    pub focus: f64,
    /// Share of the solids' motion during which the shutter is open, from its beginning, 0 … 1.
    pub shutter: f64,
}

/// How rays leave the eye.
#[derive(Clone, Debug, PartialEq)]
pub enum Lens {
    /// A pinhole with this *vertical* field of view, in (0, 180) degrees (`fov_degrees`).
    Perspective {
        /// Vertical field of view.
        fov_degrees: f64,
    },
    /// The eye at infinity; the picture is this high in world units (`height`).
    Parallel {
        /// Height of the picture in world units, > 0.
        height: f64,
    },
}

/// `[trace]`.
#[derive(Clone, Debug, PartialEq)]
pub struct Trace {
    /// Camera rays per pixel, 1 … 4096; one ray goes through the pixel's centre.
    pub samples: u32,
    /// Longest chain of reflections and refractions, 0 … 64.
    pub depth: u32,
    /// A branch whose weight is below this is not followed, 0 … 1.
    pub cutoff: f32,
    /// How a pixel weighs what is around its centre; heeded with several samples.
    pub filter: Filter,
    /// Adaptive sampling: how much cosines of neighbouring samples may differ where a pixel gets only
    /// its first few, 0 … 1; 0 gives every pixel all samples.
    pub adaptive: f32,
    /// What is compared where sampling is adaptive.
    pub refine: Refine,
}

impl Trace {
    /// Whether some pixels get fewer samples than others.
    pub fn is_adaptive(&self) -> bool {
        self.adaptive > 0.0 && self.samples > PILOTS
    }
}

/// Samples that every pixel gets where sampling is adaptive.
pub const PILOTS: u32 = 4;

/// `[materials.NAME]`: `kloc·I_local + reflect·I_reflected + transmit·filter·I_refracted`.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// Unique among the materials.
    pub name: String,
    /// Colour of the surface, possibly a pattern (`color` or `texture`).
    pub paint: Paint,
    /// Its unevenness (`bump`).
    pub bump: Bump,
    /// Weight of all local light: ambient, diffuse, highlight, emission.
    pub kloc: Rgb,
    /// Share of `ambient_light` shown, times the colour.
    pub ambient: Rgb,
    /// Lambert's coefficient, times the colour.
    pub diffuse: Rgb,
    /// How its highlights spread.
    pub model: Model,
    /// Strength of the highlight, white unless `metallic`.
    pub specular: Rgb,
    /// Exponent of the highlight of Phong, Blinn and Hall.
    pub shininess: f32,
    /// Root mean square slope m of Cook-Torrance's facets, 0.02 … 1.
    pub roughness: f32,
    /// 0 = white highlight, 1 = highlight in the colour of the surface.
    pub metallic: f32,
    /// Light given off by itself.
    pub emission: Rgb,
    /// Share of the mirror ray.
    pub reflect: Rgb,
    /// Share of the refracted ray, and of light that passes straight through as coloured shadow.
    pub transmit: Rgb,
    /// Colour of what passes through, once per surface crossed.
    pub filter: Rgb,
    /// Index of refraction.
    pub ior: f64,
    /// Which solid is there where several overlap: that of the highest priority; of equals, for what is
    /// refracted, the one entered last. 0 … [`MAX_PRIORITY`].
    pub priority: u32,
    /// Whether `reflect` and `transmit` are weighted by Fresnel's reflectance F and 1 − F, as in
    /// Hall's model they always are.
    pub fresnel: bool,
    /// Exponent n of the lobe cosⁿ around the mirror direction in which the mirror ray goes: lower
    /// is blurrier, 0 is sharp.
    pub gloss: f32,
    /// The same of the refracted ray.
    pub translucency: f32,
    /// Mass per cubic unit of length, > 0; no part of the picture.
    pub density: f64,
}

/// `[solids.NAME]`.
#[derive(Clone, Debug, PartialEq)]
pub struct Solid {
    /// Unique among the solids.
    pub name: String,
    /// The form, in object space.
    pub shape: Shape,
    /// Index into `Scene::materials`; of no meaning where the solid is made of others, whose surfaces
    /// keep their own.
    pub material: usize,
    /// world_from_object.
    pub placement: Placement,
    /// How it moves on from there; a plane stands still.
    pub motion: Motion,
}

/// Scale first, then rotation about x, y, z in this order, then translation.
#[derive(Clone, Debug, PartialEq)]
pub struct Placement {
    /// World units.
    pub translate: DVec3,
    /// About the axes x, then y, then z, right-handed.
    pub rotate_degrees: DVec3,
    /// Per axis, > 0.
    pub scale: DVec3,
}

impl Default for Placement {
    fn default() -> Placement {
        Placement { translate: DVec3::ZERO, rotate_degrees: DVec3::ZERO, scale: DVec3::ONE }
    }
}

/// A form in object space.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// All points within `radius` of `center`.
    Sphere {
        /// Centre.
        center: DVec3,
        /// > 0.
        radius: f64,
    },
    /// The half-space `normal · p ≤ offset` behind an infinite plane (`normal` of any length, not zero;
    /// the plane is `normal · p = offset · |normal|`).
    Plane {
        /// Points out of the solid.
        normal: DVec3,
        /// Distance of the plane from the origin along the normal.
        offset: f64,
    },
    /// An axis-parallel box; `min < max` on every axis.
    Box {
        /// Lowest corner.
        min: DVec3,
        /// Highest corner.
        max: DVec3,
    },
    /// A round rod with flat ends.
    Cylinder {
        /// Middle of one end.
        from: DVec3,
        /// Middle of the other end; differs from `from`.
        to: DVec3,
        /// > 0.
        radius: f64,
    },
    /// A cone, whose tip may be cut off: its radius changes evenly from one end to the other.
    Cone {
        /// Middle of one end.
        from: DVec3,
        /// Middle of the other end; differs from `from`.
        to: DVec3,
        /// Radius at `from`, > 0.
        radius: f64,
        /// Radius at `to`, ≥ 0; 0 is a point.
        tip: f64,
    },
    /// A tube around a circle around the z axis. If `minor` exceeds `major` it has no hole.
    Torus {
        /// Radius of the circle, > 0.
        major: f64,
        /// Radius of the tube, > 0.
        minor: f64,
    },
    /// A sphere with a radius of its own along each axis.
    Ellipsoid {
        /// Centre.
        center: DVec3,
        /// Each > 0.
        radii: DVec3,
    },
    /// All points of a box where a function of the second degree is not above zero.
    Quadric {
        /// Coefficients of x², y², z².
        squares: DVec3,
        /// Coefficients of yz, zx, xy.
        products: DVec3,
        /// Coefficients of x, y, z.
        linear: DVec3,
        /// What the function is at the origin.
        constant: f64,
        /// Lowest corner of the box.
        min: DVec3,
        /// Highest corner of the box; `min < max` on every axis.
        max: DVec3,
    },
    /// A flat outline in x and y, swept from one height to another.
    Prism {
        /// Loops of three or more points, which do not cross: the first one and its holes. A point is
        /// inside if an odd number of loops is around it.
        outline: Vec<Vec<DVec2>>,
        /// Lower z.
        bottom: f64,
        /// Upper z, > `bottom`.
        top: f64,
    },
    /// A flat polygon of three or more points: a surface without thickness, which does not refract.
    Polygon {
        /// Corners in order, possibly concave.
        points: Vec<DVec3>,
    },
    /// Triangles from an OBJ file.
    Mesh {
        /// As written in the scene, relative to the scene's file.
        file: String,
        /// What the file held when the scene was read.
        mesh: Arc<Mesh>,
    },
    /// A tube around a (p, q) torus knot, as a closed mesh made when the geometry is compiled.
    Knot {
        /// Turns around the axis and through the hole, both 1 … 1000, coprime.
        turns: [u32; 2],
        /// Radius of the tube, object units; the knot's own radius is 1.
        tube: f64,
        /// Segments along and around the tube, each 3 … 65 536, at most [`MAX_KNOT_FACES`] together.
        segments: [u32; 2],
    },
    /// What an operation makes of other solids, which are then not seen by themselves. The operands'
    /// world is this solid's object space: its placement and motion come on top of theirs.
    Csg {
        /// Which one.
        operation: Operation,
        /// Indices into `Scene::solids`, one or more; none of them is, in the end, made of this solid.
        operands: Vec<usize>,
    },
    /// A sphere carrying nine spheres of a third of its radius, recursively: (9^levels − 1)/8 spheres.
    Sphereflake {
        /// Centre of the largest sphere.
        center: DVec3,
        /// Radius of the largest sphere, > 0.
        radius: f64,
        /// 1 … 6.
        levels: u32,
    },
}
