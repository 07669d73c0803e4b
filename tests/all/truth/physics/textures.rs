//! Bumps lose no light and lead no ray below the surface; a checker is grey at the horizon; a palette
//! and an image show what their colours say.

use std::sync::Arc;

use glam::DVec3;

use rayforest::color::Rgb;
use rayforest::scene::texture::Image;
use rayforest::scene::{
    Background, Bump, Camera, ImageFile, Lens, Material, Paint, Picture, Scene, Shape, Trace,
};

use super::super::preorder::pixels;
use super::super::stage::open;
use super::{clear, light, mirror, one_ray, solid, sphere};

/// A bumpy sphere in white surroundings.
fn furnace(material: Material) -> Scene {
    Scene {
        picture: Picture { size: [48, 36], ..Picture::default() },
        background: Background::Color(Rgb::WHITE),
        trace: Trace { samples: 4, depth: 12, cutoff: 0.0, ..Trace::default() },
        materials: vec![material],
        solids: vec![solid(sphere(DVec3::ZERO, 1.5), 0)],
        ..Scene::default()
    }
}

fn bumps(height: f64) -> [Bump; 2] {
    let (scale, center) = (0.2, DVec3::new(0.3, -1.4, 0.2));
    [Bump::Noise { height, scale }, Bump::Waves { height, scale, center }]
}

#[test]
fn bumpy_mirrors_vanish_in_a_white_furnace_at_every_height() {
    for bump in [0.0, 1e-3, 0.01, 0.1, 1.0, 100.0].into_iter().flat_map(bumps) {
        let session = open(furnace(Material { bump: bump.clone(), ..mirror(1.0) }));
        let film = session.film();
        let mut met = 0;
        for pixel in pixels(&session) {
            let [low, high] = [f32::min, f32::max]
                .map(|pick| film.pixel(pixel.pixel).0.into_iter().reduce(pick).unwrap());
            assert!(low >= 0.99 && high <= 1.0 + 1e-6, "{bump:?}: {low} to {high}");
            for tree in pixel.samples.iter().flatten() {
                // From a ball no ray that stays outside meets it again.
                assert_eq!(tree.chain().len(), 1, "{bump:?}: a ray went below the surface");
                met += 1;
            }
        }
        assert!(met > 1000);
    }
}

#[test]
fn bumpy_glass_never_shows_more_than_there_is() {
    for bump in [0.003, 0.05, 1.0].into_iter().flat_map(bumps) {
        let film = open(furnace(Material { bump: bump.clone(), ..clear(1.5) })).film();
        for y in 0..36 {
            for x in 0..48 {
                assert!(film.pixel([x, y]).0.iter().all(|c| *c <= 1.0 + 1e-6), "{bump:?}");
            }
        }
    }
}

/// An endless checkered floor, white and black, to its horizon.
#[test]
fn a_checker_is_grey_at_the_horizon() {
    let paint = Paint::Checker { a: Rgb::WHITE, b: Rgb::BLACK, size: 1.0 };
    let floor = Material { paint, ambient: Rgb::WHITE, diffuse: Rgb::BLACK, ..Material::new("m") };
    let session = open(Scene {
        picture: Picture { size: [96, 24], ..Picture::default() },
        camera: Camera {
            eye: DVec3::new(0.31, 0.17, 1.0),
            target: DVec3::new(0.9, 9.0, 0.6),
            up: DVec3::Z,
            lens: Lens::Perspective { fov_degrees: 6.0 },
            ..Camera::default()
        },
        trace: Trace { samples: 64, depth: 0, cutoff: 0.0, ..Trace::default() },
        materials: vec![floor],
        solids: vec![solid(Shape::Plane { normal: DVec3::Z, offset: 0.0 }, 0)],
        ..Scene::default()
    });
    let film = session.film();
    let mean = |rows: std::ops::Range<u32>| {
        let count = f64::from(rows.len() as u32 * 96);
        let row = |y: u32| (0..96).map(|x| f64::from(film.pixel([x, y]).0[0])).sum::<f64>();
        rows.map(row).sum::<f64>() / count
    };
    let horizon = (0..24).find(|y| film.pixel([0, *y]).0[0] > 0.0).unwrap();
    assert!(horizon < 12, "the horizon is at row {horizon}");
    // Row by row, from just below the horizon: the row itself may show sky.
    for y in horizon + 1..horizon + 6 {
        assert!((mean(y..y + 1) - 0.5).abs() < 0.01, "row {y}: {}", mean(y..y + 1));
    }
}

/// Light of a floor of this paint, seen from above at a point: ambient light 1, nothing else.
fn seen(paint: Paint, at: DVec3) -> [f64; 3] {
    let material =
        Material { paint, ambient: Rgb::WHITE, diffuse: Rgb::BLACK, ..Material::new("m") };
    let mut scene = one_ray(at + DVec3::Z * 3.0, -DVec3::Z);
    scene.camera.lens = Lens::Parallel { height: 1e-3 };
    scene.materials = vec![material];
    scene.solids = vec![solid(Shape::Plane { normal: DVec3::Z, offset: 0.0 }, 0)];
    light(&open(scene))
}

#[test]
fn a_gradient_shows_its_colours_mixed() {
    let (a, b) = (Rgb([1.0, 0.5, 0.0]), Rgb([0.0, 0.5, 2.0]));
    let paint = Paint::Gradient { a, b, from: DVec3::X, to: DVec3::X * 3.0 };
    for (x, expected) in [
        (0.0, [1.0, 0.5, 0.0]),
        (1.5, [0.75, 0.5, 0.5]),
        (2.5, [0.25, 0.5, 1.5]),
        (9.0, [0.0, 0.5, 2.0]),
    ] {
        let found = seen(paint.clone(), DVec3::new(x, 7.0, 0.0));
        assert!((0..3).all(|c| (found[c] - expected[c]).abs() < 1e-6), "{x}: {found:?}");
    }
}

#[test]
fn an_image_shows_its_texels_times_its_tint() {
    let texels = vec![[1.0, 0.0, 0.5], [0.0, 1.0, 0.25], [0.25, 0.25, 0.0], [0.5, 2.0, 4.0]];
    let image = Arc::new(Image::of_floats([2, 2], texels));
    let image = ImageFile { file: "a.hdr".into(), image };
    let paint = Paint::Image { image, tint: Rgb([1.0, 0.5, 2.0]), size: 4.0 };
    // The middles of the four texels on a floor whose u is x and whose v is y.
    for (x, y, expected) in [
        (1.0, 3.0, [1.0, 0.0, 1.0]),
        (3.0, 3.0, [0.0, 0.5, 0.5]),
        (1.0, 1.0, [0.25, 0.125, 0.0]),
        (3.0, 1.0, [0.5, 1.0, 8.0]),
        (7.0, -3.0, [0.5, 1.0, 8.0]),
    ] {
        let found = seen(paint.clone(), DVec3::new(x, y, 0.0));
        assert!((0..3).all(|c| (found[c] - expected[c]).abs() < 1e-6), "{x} {y}: {found:?}");
    }
}

/// The only sample of a pixel sees a moving solid half way through: as one that rests there, image and
/// its bump included.
#[test]
fn images_and_bumps_move_with_their_solid() {
    let texel = |i: u32| [i * 37 % 256, i * 91 % 256, i * i % 251].map(|c| c as u8);
    let image = Arc::new(Image::of_bytes([16, 8], (0..128).map(texel).collect()));
    let image = ImageFile { file: "a.png".into(), image };
    let bump = Bump::Image { image: image.clone(), height: 0.1, size: 0.5 };
    let paint = Paint::Image { image, tint: Rgb::WHITE, size: 1.0 };
    let scene = |shape: Shape, moves: bool| {
        let mut solid = solid(shape, 0);
        let (way, turn) = (DVec3::new(1.0, 0.5, 0.25), DVec3::new(0.0, 0.0, 40.0));
        if moves {
            (solid.motion.translate, solid.motion.rotate_degrees) = (way, turn);
        } else {
            (solid.placement.translate, solid.placement.rotate_degrees) = (way / 2.0, turn / 2.0);
        }
        let mut scene = furnace(Material { paint: paint.clone(), ..Material::new("m") });
        scene.materials[0].bump = bump.clone();
        scene.lights = vec![rayforest::scene::Light::new("key")];
        scene.lights[0].place = rayforest::scene::LightPlace::Point(DVec3::new(-4.0, -5.0, 6.0));
        scene.trace.samples = 1;
        scene.camera.shutter = 1.0;
        scene.solids = vec![solid];
        open(scene).film()
    };
    let cuboid = Shape::Box { min: DVec3::splat(-1.0), max: DVec3::ONE };
    let knot = Shape::Knot { turns: [2, 3], tube: 0.3, segments: [30, 8] };
    for shape in [sphere(DVec3::ZERO, 1.5), cuboid, knot] {
        let (moving, resting) = (scene(shape.clone(), true), scene(shape.clone(), false));
        let mut worst = 0.0f32;
        for at in (0..36).flat_map(|y| (0..48).map(move |x| [x, y])) {
            let (a, b) = (moving.pixel(at).0, resting.pixel(at).0);
            worst = (0..3).map(|c| (a[c] - b[c]).abs()).fold(worst, f32::max);
        }
        assert!(worst < 1e-4, "{shape:?}: {worst}");
    }
}
