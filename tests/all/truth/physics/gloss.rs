//! Blurred mirror and refracted rays against closed forms: what a lobe sees of a white cap, and how
//! much of it stays on its side of the surface.

use glam::{DVec3, dvec3};

use rayforest::color::Rgb;
use rayforest::scene::{Background, Camera, Lens, Material, Picture, Scene, Shape, Solid, Trace};

use super::super::stage::open;
use super::{clear, mirror, solid, sphere};

const SIDE: u32 = 64;

/// A picture all of whose pixels look at the origin from `eye`, each with numbers of its own. Material
/// 0 is blurred, material 1 white and nothing else.
fn scene(blurred: Material, eye: DVec3, samples: u32, solids: Vec<Solid>) -> Scene {
    let white = Material { emission: Rgb::WHITE, ..mirror(0.0) };
    let up = eye.any_orthonormal_vector();
    let lens = Lens::Parallel { height: 1e-9 };
    Scene {
        picture: Picture { size: [SIDE, SIDE], ..Picture::default() },
        camera: Camera { eye, target: DVec3::ZERO, up, lens, ..Camera::default() },
        trace: Trace { samples, ..Trace::default() },
        materials: vec![blurred, white],
        solids,
        ..Scene::default()
    }
}

fn shown(scene: Scene) -> Vec<f64> {
    let film = open(scene).film();
    let pixels = (0..SIDE * SIDE).map(|i| film.pixel([i % SIDE, i / SIDE]));
    pixels.map(|light| light.0[0].into()).collect()
}

/// The mean's distance from the truth in standard errors, and the pixels' error.
fn errors(shown: &[f64], truth: f64) -> (f64, f64) {
    let count = shown.len() as f64;
    let mean = shown.iter().sum::<f64>() / count;
    let square = shown.iter().map(|x| (x - truth).powi(2)).sum::<f64>() / count;
    let spread = shown.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / count;
    ((mean - truth).abs() / ((spread / count).sqrt() + 1e-6), square.sqrt())
}

/// The cap of directions d with d·u > sin β: a ball that is seen under it. `u` is along x.
fn cap(beta_degrees: f64) -> Solid {
    solid(sphere(DVec3::X * 10.0, 10.0 * beta_degrees.to_radians().cos()), 1)
}

/// Exponent, β in degrees, and the share of the lobe around z that the cap around x takes.
const CAPS: [(f32, f64, f64); 5] = [
    (10.0, 5.0, 0.383_513_282_6),
    (10.0, 10.0, 0.276_358_147_1),
    (10.0, 30.0, 0.034_327_507_0),
    (100.0, 5.0, 0.189_497_142_7),
    (100.0, 10.0, 0.038_959_799_5),
];

#[test]
fn a_blurred_mirror_sees_its_share_of_a_cap() {
    let floor = || solid(Shape::Plane { normal: DVec3::Z, offset: 0.0 }, 0);
    for (gloss, beta, truth) in CAPS {
        let mut rms = Vec::new();
        for samples in [4, 64] {
            let blurred = Material { gloss, ..mirror(1.0) };
            let solids = vec![floor(), cap(beta)];
            let pixels = shown(scene(blurred, DVec3::Z * 5.0, samples, solids));
            let (off, error) = errors(&pixels, truth);
            assert!(off < 3.0, "n {gloss}, β {beta}°, {samples}: {off:.2} σ off");
            let seen = errors(&pixels, truth * 1.05).0 > 3.0;
            assert!(seen || samples < 64, "5 % too much is seen");
            rms.push(error);
        }
        let slope = (rms[1] / rms[0]).ln() / 16f64.ln();
        assert!(slope <= -0.7, "n {gloss}, β {beta}°: {rms:?}, slope {slope:.2}");
    }
}

/// The same through a sheet, behind which the ball is.
#[test]
fn a_frosted_sheet_sees_its_share_of_a_cap() {
    let corners = [[-9.0, -9.0], [9.0, -9.0], [9.0, 9.0], [-9.0, 9.0]];
    let points = corners.map(|[x, y]| dvec3(x, y, 0.0)).to_vec();
    for (translucency, beta, truth) in CAPS {
        let blurred = Material { translucency, ..clear(1.5) };
        let sheet = solid(Shape::Polygon { points: points.clone() }, 0);
        let pixels = shown(scene(blurred, DVec3::Z * 5.0, 16, vec![sheet, cap(beta)]));
        let (off, _) = errors(&pixels, truth);
        assert!(off < 3.0, "n {translucency}, β {beta}°: {off:.2} σ off");
    }
}

/// The share of the lobe cosⁿ above a surface that its axis leaves at an angle from the normal: over
/// α, the part of the circle around the axis that is above.
fn share_above(n: f64, degrees: f64) -> f64 {
    let (sin, cos) = degrees.to_radians().sin_cos();
    let steps = 200_000;
    let slice = |i: i32| {
        // In steps of equal probability.
        let cosine = ((f64::from(i) + 0.5) / f64::from(steps)).powf(1.0 / (n + 1.0));
        let sine = (1.0 - cosine * cosine).sqrt();
        // cos α·cos θ + sin α·sin θ·cos φ > 0
        let reach = -(cosine * cos) / (sine * sin);
        if reach <= -1.0 { 1.0 } else { reach.acos() / std::f64::consts::PI }
    };
    (0..steps).map(slice).sum::<f64>() / f64::from(steps)
}

/// What falls below the surface is black, not drawn again: the rest of white surroundings is left.
#[test]
fn what_falls_on_the_wrong_side_counts_nothing() {
    let (sin, cos) = 75f64.to_radians().sin_cos();
    let eye = dvec3(sin, 0.0, cos) * 5.0;
    let points = [[-9.0, -9.0], [9.0, -9.0], [9.0, 9.0], [-9.0, 9.0]];
    let points = points.map(|[x, y]| dvec3(x, y, 0.0)).to_vec();
    for (n, published) in [(1.0f32, 0.63), (10.0, 0.80)] {
        let truth = share_above(n.into(), 75.0);
        assert!((truth - published).abs() < 0.006, "n {n}: {truth}");
        for blurred in
            [Material { gloss: n, ..mirror(1.0) }, Material { translucency: n, ..clear(1.0) }]
        {
            let through = blurred.translucency > 0.0;
            let sheet = solid(Shape::Polygon { points: points.clone() }, 0);
            let scene = Scene {
                background: Background::Color(Rgb::WHITE),
                ..scene(blurred, eye, 16, vec![sheet])
            };
            let pixels = shown(scene);
            let (off, _) = errors(&pixels, truth);
            assert!(off < 3.0, "n {n}, through: {through}: {off:.2} σ off");
        }
    }
}
