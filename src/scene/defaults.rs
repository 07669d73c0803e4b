//! What a scene, a light, a material or a shape is before the user says anything about it.

use std::sync::Arc;

use glam::{DVec2, DVec3};

use super::Placement;
use super::csg::Operation;
use super::filter::Filter;
use super::look::Looks;
use super::mesh::Mesh;
use super::model::Model;
use super::motion::Motion;
use super::refine::Refine;
use super::tone::Tone;
use super::{
    Background, Bump, Camera, ImageFile, Lens, Material, Paint, Picture, Scene, Shape, Solid, Trace,
};
use crate::color::Rgb;

impl Default for Scene {
    fn default() -> Scene {
        Scene {
            ambient_light: Rgb::WHITE,
            picture: Picture::default(),
            camera: Camera::default(),
            background: Background::default(),
            trace: Trace::default(),
            lights: Vec::new(),
            materials: Vec::new(),
            solids: Vec::new(),
            looks: Looks::default(),
        }
    }
}

impl Default for Picture {
    fn default() -> Picture {
        Picture { size: [640, 360], exposure: 0.0, tone: Tone::None }
    }
}

impl Default for Camera {
    fn default() -> Camera {
        Camera {
            eye: DVec3::new(0.0, -6.0, 2.0),
            target: DVec3::ZERO,
            up: DVec3::Z,
            lens: Lens::Perspective { fov_degrees: 45.0 },
            aperture: 0.0,
            focus: 0.0,
            shutter: 1.0,
        }
    }
}

impl Default for Background {
    fn default() -> Background {
        Background::Color(Rgb::BLACK)
    }
}

impl Default for Trace {
    fn default() -> Trace {
        Trace {
            samples: 16,
            depth: 10,
            cutoff: 1.0 / 255.0,
            filter: Filter::Box,
            adaptive: 0.0,
            refine: Refine::Trees,
        }
    }
}

impl Material {
    /// White, matt, opaque.
    pub fn new(name: impl Into<String>) -> Material {
        Material {
            name: name.into(),
            paint: Paint::Solid(Rgb::WHITE),
            bump: Bump::None,
            kloc: Rgb::WHITE,
            ambient: Rgb::grey(0.1),
            diffuse: Rgb::grey(0.7),
            model: Model::Phong,
            specular: Rgb::BLACK,
            shininess: 32.0,
            roughness: 0.3,
            metallic: 0.0,
            emission: Rgb::BLACK,
            reflect: Rgb::BLACK,
            transmit: Rgb::BLACK,
            filter: Rgb::WHITE,
            ior: 1.5,
            priority: 0,
            fresnel: false,
            gloss: 0.0,
            translucency: 0.0,
            density: 1.0,
        }
    }
}

impl Solid {
    /// A shape where it was defined, in the material with this index.
    pub fn new(name: impl Into<String>, shape: Shape, material: usize) -> Solid {
        let (placement, motion) = (Placement::default(), Motion::default());
        Solid { name: name.into(), shape, material, placement, motion }
    }
}

impl Lens {
    /// The lens whose key in the scene file is `key`; a perspective for any other word.
    pub fn named(key: &str) -> Lens {
        match key {
            "height" => Lens::Parallel { height: 4.0 },
            _ => Lens::Perspective { fov_degrees: 45.0 },
        }
    }
}

impl Paint {
    /// The paint whose key in the scene file, or in its `texture`, is `key`; one colour for any other
    /// word.
    pub fn named(key: &str) -> Paint {
        let (a, b, size) = (Rgb::WHITE, Rgb::BLACK, 1.0);
        match key {
            "texture" | "checker" => Paint::Checker { a, b, size },
            "gradient" => Paint::Gradient { a, b, from: DVec3::ZERO, to: DVec3::Z },
            "marble" => {
                let direction = DVec3::new(1.0, 0.5, 0.25);
                Paint::Marble { a, b, size, direction, turbulence: 1.0 }
            }
            "wood" => {
                let (center, axis) = (DVec3::ZERO, DVec3::Z);
                Paint::Wood { a, b, size: 0.1, center, axis, turbulence: 0.5 }
            }
            "image" => Paint::Image { image: ImageFile::default(), tint: Rgb::WHITE, size },
            _ => Paint::Solid(Rgb::WHITE),
        }
    }
}

impl Bump {
    /// The bump whose key in the scene file is `key`; none for any other word.
    pub fn named(key: &str) -> Bump {
        match key {
            "noise" => Bump::Noise { height: 0.02, scale: 0.2 },
            "waves" => Bump::Waves { height: 0.02, scale: 0.3, center: DVec3::ZERO },
            "image" => Bump::Image { image: ImageFile::default(), height: 0.02, size: 1.0 },
            _ => Bump::None,
        }
    }
}

impl Background {
    /// The background whose key in the scene file is `key`; one colour for any other word.
    pub fn named(key: &str) -> Background {
        match key {
            "gradient" => Background::Gradient {
                below: Rgb([0.12, 0.11, 0.1]),
                level: Rgb([0.75, 0.82, 0.9]),
                above: Rgb([0.12, 0.3, 0.7]),
                up: DVec3::Z,
            },
            "image" => Background::Image {
                image: ImageFile::default(),
                tint: Rgb::WHITE,
                turn_degrees: 0.0,
            },
            _ => Background::default(),
        }
    }
}

impl Shape {
    /// The shape whose key in the scene file is `key`, of unit size, or made of the first solid; a sphere
    /// for any other word.
    pub fn named(key: &str) -> Shape {
        if let Some(operation) = Operation::named(key) {
            return Shape::Csg { operation, operands: vec![0] };
        }
        match key {
            "plane" => Shape::Plane { normal: DVec3::Z, offset: 0.0 },
            "box" => Shape::Box { min: DVec3::NEG_ONE, max: DVec3::ONE },
            "cylinder" => Shape::Cylinder { from: DVec3::NEG_Z, to: DVec3::Z, radius: 1.0 },
            "cone" => Shape::Cone { from: DVec3::NEG_Z, to: DVec3::Z, radius: 1.0, tip: 0.0 },
            "torus" => Shape::Torus { major: 1.0, minor: 0.3 },
            "ellipsoid" => {
                Shape::Ellipsoid { center: DVec3::ZERO, radii: DVec3::new(1.0, 0.8, 0.6) }
            }
            "quadric" => Shape::Quadric {
                squares: DVec3::new(1.0, 1.0, -1.0),
                products: DVec3::ZERO,
                linear: DVec3::ZERO,
                constant: -0.2,
                min: DVec3::NEG_ONE,
                max: DVec3::ONE,
            },
            "prism" => {
                let outline = vec![vec![DVec2::ZERO, DVec2::X, DVec2::Y]];
                Shape::Prism { outline, bottom: 0.0, top: 1.0 }
            }
            "polygon" => Shape::Polygon { points: vec![DVec3::ZERO, DVec3::X, DVec3::Y] },
            "mesh" => Shape::Mesh { file: "mesh.obj".to_owned(), mesh: Arc::new(Mesh::default()) },
            "knot" => Shape::Knot { turns: [2, 3], tube: 0.3, segments: [400, 100] },
            "sphereflake" => Shape::Sphereflake { center: DVec3::ZERO, radius: 1.0, levels: 3 },
            _ => Shape::Sphere { center: DVec3::ZERO, radius: 1.0 },
        }
    }
}
