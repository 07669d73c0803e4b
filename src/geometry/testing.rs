//! Scenes as values, random numbers and queries on a chosen SIMD level, for the tests of this module.

use std::sync::Arc;

use fearless_simd::{Level, dispatch};
use glam::DVec3;

use super::{Geometry, Hit, Leaving, Ray, Stack};
use crate::color::Rgb;
use crate::progress::Progress;
use crate::scene::mesh::Mesh;
use crate::scene::{
    Background, Camera, Lens, Material, Paint, Picture, Scene, Shape, Solid, Trace,
};

/// A fixed stream of numbers (splitmix64).
pub(super) struct Random(pub(super) u64);

impl Random {
    pub(super) fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    pub(super) fn below(&mut self, n: usize) -> usize {
        (self.bits() % n as u64) as usize
    }

    /// In −1 … 1.
    pub(super) fn signed(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    pub(super) fn in_cube(&mut self) -> DVec3 {
        DVec3::new(self.signed(), self.signed(), self.signed())
    }

    pub(super) fn direction(&mut self) -> DVec3 {
        loop {
            let v = self.in_cube();
            if (1e-3..1.0).contains(&v.length_squared()) {
                return v.normalize();
            }
        }
    }
}

pub(super) fn scene(solids: Vec<Solid>) -> Scene {
    let material = |name: &str, paint| Material {
        bump: crate::scene::Bump::None,
        name: name.into(),
        paint,
        kloc: Rgb::WHITE,
        ambient: Rgb::WHITE,
        diffuse: Rgb::WHITE,
        specular: Rgb::BLACK,
        model: crate::scene::model::Model::Phong,
        shininess: 1.0,
        roughness: 1.0,
        metallic: 0.0,
        emission: Rgb::BLACK,
        reflect: Rgb::BLACK,
        transmit: Rgb::BLACK,
        filter: Rgb::WHITE,
        ior: 1.0,
        priority: 0,
        fresnel: false,
        gloss: 0.0,
        translucency: 0.0,
        density: 1.0,
    };
    let checker = Paint::Checker { a: Rgb::WHITE, b: Rgb::BLACK, size: 1.0 };
    Scene {
        ambient_light: Rgb::WHITE,
        picture: Picture { size: [1, 1], ..Picture::default() },
        camera: Camera {
            eye: DVec3::ZERO,
            target: DVec3::X,
            up: DVec3::Z,
            lens: Lens::Perspective { fov_degrees: 40.0 },
            ..Camera::default()
        },
        background: Background::Color(Rgb::BLACK),
        trace: Trace { samples: 1, depth: 1, cutoff: 0.0, ..Trace::default() },
        lights: vec![],
        materials: vec![
            material("plain", Paint::Solid(Rgb::WHITE)),
            material("checkered", checker),
        ],
        solids,
        ..Scene::default()
    }
}

pub(super) fn solid(shape: Shape) -> Solid {
    Solid::new("", shape, 0)
}

pub(super) fn mesh_solid(mesh: Mesh) -> Solid {
    solid(Shape::Mesh { file: String::new(), mesh: Arc::new(mesh) })
}

/// The scene moved by `offset`, after being scaled.
pub(super) fn moved(mut solids: Vec<Solid>, scale: f64, offset: DVec3) -> Vec<Solid> {
    for solid in &mut solids {
        solid.placement.translate = solid.placement.translate * scale + offset;
        solid.placement.scale *= scale;
    }
    solids
}

pub(super) fn build(solids: Vec<Solid>) -> Geometry {
    Geometry::build(&scene(solids), &Progress::default()).unwrap()
}

/// A cube from −1 to 1 as twelve triangles.
pub(super) fn triangle_cube() -> Mesh {
    let at = |i: usize, bit: usize| if i >> bit & 1 == 1 { 1.0 } else { -1.0 };
    let positions = (0..8).map(|i| DVec3::new(at(i, 0), at(i, 1), at(i, 2))).collect();
    let quads =
        [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles = quads.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).collect();
    Mesh { positions, triangles, ..Mesh::default() }
}

pub(super) fn closest(
    geometry: &Geometry,
    level: Level,
    stack: &mut Stack,
    ray: &Ray,
    leaving: Option<Leaving>,
) -> Option<Hit> {
    dispatch!(level, simd => geometry.closest_hit(simd, stack, ray, leaving))
}

/// The blocker, or the solids crossed in ascending order.
pub(super) fn shadow(
    geometry: &Geometry,
    level: Level,
    stack: &mut Stack,
    (ray, t_max): (&Ray, f64),
    leaving: Option<Leaving>,
    opaque: &[bool],
) -> Result<Vec<u32>, u32> {
    let mut crossed = vec![77];
    let blocker = dispatch!(level, simd =>
        geometry.occluded(simd, stack, ray, t_max, leaving, opaque, &mut crossed));
    crossed.sort_unstable();
    blocker.map_or(Ok(crossed), Err)
}
