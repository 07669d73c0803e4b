//! Penumbrae of lights with an area against closed forms: means without bias, and errors that fall as
//! fast as stratified points allow.
//!
//! A point in the plane z = 0 below a horizontal light of area 1 at height 1 that falls off from
//! distance 1 shows `diffuse` times the mean of cos θ · N·L/d² over what it sees of the light, which
//! is π times the form factor of that part.

use glam::{DVec3, dvec3};

use rayforest::color::Rgb;
use rayforest::scene::{
    Area, Camera, Lens, Light, LightPlace, Material, Picture, Scene, Shape, Solid, Trace,
};

use super::super::stage::open;
use super::solid;

/// π times the form factor of a flat polygon seen from the origin in the plane z = 0 (Lambert 1760).
fn projected(corners: &[DVec3]) -> f64 {
    let next = corners.iter().cycle().skip(1);
    let edges = corners.iter().zip(next).map(|(a, b)| {
        let across = a.cross(*b);
        across.length().atan2(a.dot(*b)) * across.normalize().z
    });
    edges.sum::<f64>().abs() / 2.0
}

/// What is between the point and the light, and what part of the light it leaves.
enum Edge {
    /// Nothing.
    Open,
    /// All of x < 0.13 is hidden.
    Straight,
    /// All of y < 0.7·x − 0.1 is hidden.
    Oblique,
}

impl Edge {
    /// The part of the unit square at height 1 that is seen.
    fn seen(&self) -> Vec<DVec3> {
        let corners: &[[f64; 2]] = match self {
            Edge::Open => &[[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]],
            Edge::Straight => &[[0.13, -0.5], [0.5, -0.5], [0.5, 0.5], [0.13, 0.5]],
            Edge::Oblique => &[[-0.5, -0.45], [0.5, 0.25], [0.5, 0.5], [-0.5, 0.5]],
        };
        corners.iter().map(|[x, y]| dvec3(*x, *y, 1.0)).collect()
    }

    /// A screen half-way to the light, where everything is half as large.
    fn screen(&self) -> Option<Solid> {
        let far = 20.0;
        let corners = match self {
            Edge::Open => return None,
            Edge::Straight => [[0.065, -far], [0.065, far], [-far, far], [-far, -far]],
            Edge::Oblique => [
                [-far, -0.7 * far - 0.05],
                [far, 0.7 * far - 0.05],
                [far, -3. * far],
                [-far, -3. * far],
            ],
        };
        let points = corners.map(|[x, y]| dvec3(x, y, 0.5)).to_vec();
        Some(solid(Shape::Polygon { points }, 0))
    }
}

const SIDE: u32 = 64;

/// A picture all of whose pixels show the same point, each with numbers of its own.
fn scene(edge: &Edge, place: LightPlace, [camera, light]: [u32; 2]) -> Scene {
    let white = Material { ambient: Rgb::BLACK, diffuse: Rgb::WHITE, ..Material::new("white") };
    let floor = solid(Shape::Plane { normal: DVec3::Z, offset: 0.0 }, 0);
    // Beside every screen.
    let eye = dvec3(2.0, 3.0, 3.0);
    let lens = Lens::Parallel { height: 1e-9 };
    Scene {
        picture: Picture { size: [SIDE, SIDE], ..Picture::default() },
        camera: Camera { eye, target: DVec3::ZERO, lens, ..Camera::default() },
        trace: Trace { samples: camera, ..Trace::default() },
        lights: vec![Light { place, falloff: 1.0, samples: light, ..Light::new("panel") }],
        materials: vec![white],
        solids: [floor].into_iter().chain(edge.screen()).collect(),
        ..Scene::default()
    }
}

fn square() -> LightPlace {
    LightPlace::Area(Area::Rectangle { center: DVec3::Z, along: DVec3::X, across: DVec3::Y })
}

/// What the pixels show.
fn shown(scene: Scene) -> Vec<f64> {
    let film = open(scene).film();
    let pixels = (0..SIDE * SIDE).map(|i| film.pixel([i % SIDE, i / SIDE]));
    pixels.map(|light| light.0[0].into()).collect()
}

/// The mean's distance from the truth in standard errors, and the pixels' error, both relative.
fn errors(shown: &[f64], truth: f64) -> (f64, f64) {
    let count = shown.len() as f64;
    let mean = shown.iter().sum::<f64>() / count;
    let square = shown.iter().map(|x| (x - truth).powi(2)).sum::<f64>() / count;
    let spread = shown.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / count;
    // f32 sums round by up to 3e-7 of the truth.
    let standard = (spread / count).sqrt() + 3e-7 * truth;
    ((mean - truth).abs() / standard, square.sqrt() / truth)
}

#[test]
fn the_truths_are_those_found_with_twelve_digits() {
    for (edge, form_factor) in [
        (Edge::Open, 0.239456470461),
        (Edge::Straight, 0.084361533747),
        (Edge::Oblique, 0.145481926839),
    ] {
        let found = projected(&edge.seen()) / std::f64::consts::PI;
        assert!((found - form_factor).abs() < 1e-12, "{found} {form_factor}");
    }
}

#[test]
fn penumbrae_are_unbiased_and_converge() {
    for (name, edge, steepest) in [
        ("open", Edge::Open, -0.9),
        ("straight", Edge::Straight, -0.7),
        ("oblique", Edge::Oblique, -0.7),
    ] {
        let truth = projected(&edge.seen());
        // Rays of one sample of the camera, and one ray each of many.
        for split in [|n: u32| [1, n], |n: u32| [n, 1]] {
            let mut rms = Vec::new();
            for rays in [4, 64] {
                let pixels = shown(scene(&edge, square(), split(rays)));
                let (off, error) = errors(&pixels, truth);
                assert!(off < 3.0, "{name}, {:?}: mean is {off:.2} σ off", split(rays));
                rms.push(error);
            }
            let slope = (rms[1] / rms[0]).ln() / 16f64.ln();
            assert!(slope <= steepest, "{name}, {:?}: {rms:?}, slope {slope:.2}", split(64));
        }
    }
}

#[test]
fn a_wrong_truth_is_seen() {
    let pixels = shown(scene(&Edge::Straight, square(), [1, 16]));
    let truth = projected(&Edge::Straight.seen());
    assert!(errors(&pixels, truth).0 < 3.0 && errors(&pixels, truth * 1.01).0 > 3.0);
}

/// A disc of radius r at height 1 around the vertical: r²/(1 + r²) is its form factor, and r² that of a
/// ball there.
#[test]
fn discs_and_balls_are_as_bright_as_their_form_factors() {
    let radius = 0.6f64;
    // The mean over an area of πr².
    for (area, truth) in [
        (
            Area::Disc { center: DVec3::Z, normal: DVec3::Z * 3.0, radius },
            1.0 / (1.0 + radius * radius),
        ),
        (Area::Sphere { center: DVec3::Z, radius }, 1.0),
    ] {
        let place = LightPlace::Area(area.clone());
        let (off, rms) = errors(&shown(scene(&Edge::Open, place, [1, 64])), truth);
        assert!(off < 3.0 && rms < 0.01, "{area:?}: {off} σ, {rms}");
    }
}

/// One ray to the middle of a light without falloff is a point light.
#[test]
fn a_light_of_no_size_is_a_point() {
    let at = dvec3(0.3, -0.2, 2.0);
    let falls = |place| shown(scene(&Edge::Open, place, [1, 3]))[7];
    let point = falls(LightPlace::Point(at));
    let tiny = falls(LightPlace::Area(Area::Sphere { center: at, radius: 1e-9 }));
    assert!((tiny / point - 1.0).abs() < 1e-6, "{tiny} {point}");
    let truth = 2.0 / at.length().powi(3);
    assert!((point / truth - 1.0).abs() < 1e-6, "{point} {truth}");
}
