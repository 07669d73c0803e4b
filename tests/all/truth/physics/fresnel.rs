//! Fresnel's reflectance in pictures: plates, panes, slabs and a sphere against closed forms.

use glam::DVec3;

use rayforest::color::Rgb;
use rayforest::forest::tree::Branch;
use rayforest::scene::{Background, Material, Scene, Shape};

use super::super::stage::open;
use super::{clear, light, mirror, one_ray, slab, solid, sphere, tree};

const ROUNDING: f64 = 1e-6;

/// Fresnel's reflectance from air into glass of this index, by Snell's angles.
fn reflectance(degrees: f64, ior: f64) -> f64 {
    let i = degrees.to_radians();
    if i == 0.0 {
        return ((ior - 1.0) / (ior + 1.0)).powi(2);
    }
    let t = (i.sin() / ior).asin();
    let s = (i - t).sin() / (i + t).sin();
    let p = (i - t).tan() / (i + t).tan();
    (s * s + p * p) / 2.0
}

/// A ray that meets the plane z = 0 from above at this angle.
fn towards_plane(degrees: f64) -> Scene {
    let i = degrees.to_radians();
    let eye = DVec3::new(-i.sin(), 0.0, i.cos()) * 3.0;
    Scene { background: Background::Color(Rgb::WHITE), ..one_ray(eye, -eye.normalize()) }
}

fn glass(ior: f64) -> Material {
    Material { reflect: Rgb::WHITE, fresnel: true, ..clear(ior) }
}

#[test]
fn an_opaque_plate_mirrors_by_the_angle() {
    for degrees in [0.0, 30.0, 56.31, 80.0, 89.0] {
        let plate = Material { fresnel: true, ..mirror(0.5) };
        let scene = Scene {
            materials: vec![plate],
            solids: vec![solid(slab(-1.0, 0.0), 0)],
            ..towards_plane(degrees)
        };
        let expected = 0.5 * reflectance(degrees, 1.5);
        let found = light(&open(scene.clone()))[0];
        assert!((found - expected).abs() < ROUNDING, "{degrees}°: {found} {expected}");
        let mut without = scene;
        without.materials[0].fresnel = false;
        assert_eq!(light(&open(without)), [0.5; 3]);
    }
}

#[test]
fn a_thin_pane_mirrors_and_lets_through_the_rest() {
    let corners = [(-9.0, -9.0), (9.0, -9.0), (9.0, 9.0), (-9.0, 9.0)];
    let pane = Shape::Polygon { points: corners.map(|(x, y)| DVec3::new(x, y, 0.0)).to_vec() };
    let lamp = Material { emission: Rgb::WHITE, ..mirror(0.0) };
    let scene = Scene {
        background: Background::default(),
        materials: vec![glass(1.5), lamp],
        solids: vec![solid(pane, 0), solid(slab(-9.0, -8.0), 1)],
        ..towards_plane(60.0)
    };
    let expected = 1.0 - reflectance(60.0, 1.5);
    assert!((light(&open(scene))[0] - expected).abs() < ROUNDING);
}

#[test]
fn a_slab_lets_through_what_all_its_reflections_leave() {
    // (1 − R)/(1 + R): 0.923076923 at right angles.
    for (degrees, known) in [(0.0, Some(0.923_076_923)), (45.0, None), (70.0, None)] {
        let lamp = Material { emission: Rgb::WHITE, ..mirror(0.0) };
        let scene = Scene {
            background: Background::default(),
            materials: vec![glass(1.5), lamp],
            solids: vec![solid(slab(-1.0, 0.0), 0), solid(slab(-9.0, -8.0), 1)],
            ..towards_plane(degrees)
        };
        let r = reflectance(degrees, 1.5);
        let expected = known.unwrap_or((1.0 - r) / (1.0 + r));
        let found = light(&open(scene))[0];
        assert!((found - expected).abs() < ROUNDING, "{degrees}°: {found} {expected}");
    }
}

#[test]
fn glass_vanishes_in_uniform_light() {
    let ball = |impact: f64| Scene {
        background: Background::Color(Rgb::WHITE),
        solids: vec![solid(sphere(DVec3::ZERO, 1.0), 0)],
        ..one_ray(DVec3::new(impact, 0.0, 5.0), DVec3::NEG_Z)
    };
    let panel =
        |degrees| Scene { solids: vec![solid(slab(-1.0, 0.0), 0)], ..towards_plane(degrees) };
    for scene in [ball(0.0), ball(0.5), ball(0.866), panel(0.0), panel(30.0), panel(70.0)] {
        for ior in [1.1, 1.5, 2.42] {
            let scene = Scene { materials: vec![glass(ior)], ..scene.clone() };
            let found = light(&open(scene))[0];
            assert!((found - 1.0).abs() < 4.0 * ROUNDING, "ior {ior}: {found}");
        }
    }
    // The furnace sees a share that is lost.
    let lossy = Material { reflect: Rgb::grey(0.99), ..glass(1.5) };
    let found = light(&open(Scene { materials: vec![lossy], ..ball(0.5) }))[0];
    assert!(found < 1.0 - 1e-4, "{found}");
}

#[test]
fn what_fresnel_leaves_below_the_cut_off_is_not_followed() {
    let at = |cutoff| {
        let mut scene = Scene {
            materials: vec![glass(1.5)],
            solids: vec![solid(slab(-1.0, 0.0), 0)],
            ..towards_plane(0.0)
        };
        scene.trace.cutoff = cutoff;
        open(scene)
    };
    // R = 0.04, then 0.96·0.04 inside, of which 0.04 goes on.
    let [coarse, fine] = [at(0.05), at(0.03)];
    assert!(tree(&coarse).has_cut(Branch::Faint));
    assert!((light(&coarse)[0] - 0.96 * 0.96).abs() < ROUNDING);
    let seen = 0.04 + 0.96 * 0.96 + 0.96 * 0.04 * 0.96;
    assert!((light(&fine)[0] - seen).abs() < ROUNDING);
    // Where both indices are equal there is no mirror image, at any cut-off.
    let air = Scene {
        materials: vec![glass(1.0)],
        solids: vec![solid(slab(-1.0, 0.0), 0)],
        ..towards_plane(40.0)
    };
    let air = open(air);
    assert!(tree(&air).has_cut(Branch::Faint));
    assert_eq!(light(&air), [1.0; 3]);
}
