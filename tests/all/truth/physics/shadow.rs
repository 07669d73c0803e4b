//! Coloured shadows: straight through, times `transmit · filter` for every surface crossed.

use glam::DVec3;

use rayforest::color::Rgb;
use rayforest::scene::{Light, LightPlace, Material, Scene, Shape, Solid};

use super::super::stage::open;
use super::{clear, light, one_ray, slab, solid, sphere, tree};

/// Diffuse share of the floor.
const WHITE: f32 = 0.8;

/// Relative error of a dozen f32 products.
const EXACT: f64 = 1e-6;

/// Two glasses and what one surface of them leaves.
const GLASSES: [([f32; 3], [f32; 3]); 2] =
    [([0.9, 0.8, 0.7], [0.5, 1.0, 0.25]), ([0.6, 0.95, 1.0], [1.0, 0.75, 0.9])];

/// A white floor at the origin, seen from beside all that is above it, under a lamp. Material 0 is
/// the floor's, 1 and 2 are [`GLASSES`], 3 is opaque.
fn floor(place: LightPlace, above: &[Solid]) -> Scene {
    let eye = DVec3::new(4.0, 0.0, 1.0);
    let paint = Material { diffuse: Rgb::grey(WHITE), ..clear(1.0) };
    let paint = Material { transmit: Rgb::BLACK, ..paint };
    let glasses = GLASSES.map(|(transmit, filter)| {
        let (transmit, filter) = (Rgb(transmit), Rgb(filter));
        Material { transmit, filter, ..clear(1.5) }
    });
    let [first, second] = glasses;
    let floor = solid(Shape::Plane { normal: DVec3::Z, offset: 0.0 }, 0);
    Scene {
        lights: vec![Light { place, ..Light::new("lamp") }],
        materials: vec![paint.clone(), first, second, paint],
        solids: [&[floor], above].concat(),
        ..one_ray(eye, -eye.normalize())
    }
}

fn sun() -> LightPlace {
    LightPlace::Direction(DVec3::NEG_Z)
}

/// What `counts` crossings of each glass leave of the light on the floor.
fn left(counts: [i32; 2]) -> [f64; 3] {
    [0, 1, 2].map(|c| {
        let crossed = |(transmit, filter): ([f32; 3], [f32; 3]), n: i32| {
            (f64::from(transmit[c]) * f64::from(filter[c])).powi(n)
        };
        f64::from(WHITE) * crossed(GLASSES[0], counts[0]) * crossed(GLASSES[1], counts[1])
    })
}

/// The worst relative difference of the floor's light from a truth.
fn off(scene: Scene, truth: [f64; 3]) -> f64 {
    let ours = light(&open(scene));
    (0..3).map(|c| (ours[c] / truth[c] - 1.0).abs()).fold(0.0, f64::max)
}

#[test]
fn every_surface_crossed_colours_the_shadow() {
    let ball = |material| solid(sphere(DVec3::new(0.1, 0.2, 6.0), 1.0), material);
    let box_ = |material| solid(slab(2.0, 3.0), material);
    let corners = [[-9.0, -9.0], [9.0, -9.0], [9.0, 9.0], [-9.0, 9.0]];
    let points = corners.map(|[x, y]| DVec3::new(x, y, 9.0)).to_vec();
    let sheet = |material| solid(Shape::Polygon { points: points.clone() }, material);
    for (above, counts) in [
        (vec![], [0, 0]),
        (vec![box_(1)], [2, 0]),
        (vec![ball(2)], [0, 2]),
        (vec![sheet(1)], [1, 0]),
        (vec![box_(1), ball(2)], [2, 2]),
        (vec![box_(2), ball(1), sheet(2)], [2, 3]),
    ] {
        let scene = floor(sun(), &above);
        let off_by = off(scene, left(counts));
        assert!(off_by <= EXACT, "crossings {counts:?}: off by {off_by:e}");
        // The order of the solids, in space and in the file, is of no consequence.
        let reversed: Vec<Solid> = above.iter().rev().cloned().collect();
        let [a, b] = [&above, &reversed].map(|above| light(&open(floor(sun(), above))));
        assert_eq!(a, b);
    }
    assert!(off(floor(sun(), &[box_(1)]), left([1, 0])) > 0.1, "one surface is not two");
}

#[test]
fn a_lamp_within_glass_is_crossed_once() {
    let center = DVec3::new(0.0, 0.0, 4.0);
    let above = [solid(sphere(center, 1.0), 1)];
    assert!(off(floor(LightPlace::Point(center), &above), left([1, 0])) <= EXACT);
    // Beyond a lamp nothing is crossed.
    let nearer = LightPlace::Point(DVec3::new(0.0, 0.0, 2.0));
    assert!(off(floor(nearer, &above), left([0, 0])) <= EXACT);
}

#[test]
fn opaque_matter_leaves_nothing() {
    let above = [solid(slab(2.0, 3.0), 1), solid(sphere(DVec3::new(0.0, 0.0, 6.0), 1.0), 3)];
    for above in [&above[1..], &above] {
        assert_eq!(light(&open(floor(sun(), above))), [0.0; 3]);
    }
}

/// A shadow ray through a closed mesh crosses its surface an even number of times, and the light
/// is that of as many factors.
#[test]
fn a_knot_is_crossed_an_even_number_of_times() {
    let shape = Shape::Knot { turns: [2, 3], tube: 0.3, segments: [60, 8] };
    let mut counts = [0; 3];
    for i in 0..40 {
        let mut knot = solid(shape.clone(), 1);
        knot.placement.translate = DVec3::new(0.1 * f64::from(i) - 2.0, 0.2, 4.0);
        knot.placement.rotate_degrees = DVec3::new(90.0, 7.0 * f64::from(i), 0.0);
        let session = open(floor(sun(), &[knot]));
        let tree = tree(&session);
        let crossed = tree.lights[0].crossed.as_ref().expect("glass stops nothing").len();
        assert_eq!(crossed % 2, 0, "turn {i}");
        counts[(crossed / 2).min(2)] += 1;
        let truth = left([crossed as i32, 0]);
        for (ours, truth) in light(&session).iter().zip(truth) {
            assert!((ours / truth - 1.0).abs() <= EXACT, "turn {i}, {crossed} crossings");
        }
    }
    assert!(counts.iter().all(|&n| n > 0), "rays that cross 0, 1 and more tubes: {counts:?}");
}
