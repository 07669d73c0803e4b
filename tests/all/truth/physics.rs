//! The tracer against closed forms: uniform surroundings, facing mirrors, refraction, shadows.

mod corridor;
mod fresnel;
mod furnace;
mod gloss;
mod models;
mod nested;
mod penumbra;
mod refraction;
mod shadow;
mod textures;

use glam::DVec3;

use rayforest::color::Rgb;
use rayforest::scene::{Camera, Lens, Material, Picture, Scene, Shape, Solid, Trace};
use rayforest::session::Session;

use super::preorder::{Tree, pixels};

/// A picture of one pixel and one ray, from `eye` along `direction`; nothing is cut off before 64
/// branches. Materials and solids are to be added.
fn one_ray(eye: DVec3, direction: DVec3) -> Scene {
    let up = direction.any_orthonormal_vector();
    let lens = Lens::Parallel { height: 1.0 };
    Scene {
        picture: Picture { size: [1, 1], ..Picture::default() },
        camera: Camera { eye, target: eye + direction, up, lens, ..Camera::default() },
        trace: Trace { samples: 1, depth: 64, cutoff: 0.0, ..Trace::default() },
        ..Scene::default()
    }
}

/// The light of the one pixel.
fn light(session: &Session) -> [f64; 3] {
    session.film().pixel([0, 0]).0.map(f64::from)
}

/// The tree of the one ray.
fn tree(session: &Session) -> Tree {
    let pixel = pixels(session).into_iter().next();
    pixel.and_then(|p| p.samples.into_iter().next()).flatten().expect("the ray meets something")
}

/// Shows nothing but what it transmits, all of it.
fn clear(ior: f64) -> Material {
    Material { transmit: Rgb::WHITE, ior, ..mirror(0.0) }
}

/// Shows nothing but this share of what it reflects.
fn mirror(reflect: f32) -> Material {
    Material {
        ambient: Rgb::BLACK,
        diffuse: Rgb::BLACK,
        reflect: Rgb::grey(reflect),
        ..Material::new("material")
    }
}

/// A solid where it was defined.
fn solid(shape: Shape, material: usize) -> Solid {
    Solid::new("solid", shape, material)
}

fn sphere(center: DVec3, radius: f64) -> Shape {
    Shape::Sphere { center, radius }
}

/// The box between two heights, 200 wide.
fn slab(low: f64, high: f64) -> Shape {
    Shape::Box { min: DVec3::new(-100.0, -100.0, low), max: DVec3::new(100.0, 100.0, high) }
}
