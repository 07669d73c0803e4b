//! A plate under a lamp in every illumination model, against the textbook's formulas.

use std::f64::consts::PI;

use glam::DVec3;

use rayforest::color::Rgb;
use rayforest::scene::model::Model;
use rayforest::scene::{Light, LightPlace, Material, Scene, Shape};

use super::super::stage::open;
use super::{light, mirror, one_ray, slab, solid};

/// At a height above the plate, seen from its normal and turned about it.
fn direction(from_normal: f64, turned: f64) -> DVec3 {
    let (theta, phi) = (from_normal.to_radians(), turned.to_radians());
    DVec3::new(theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos())
}

/// Fresnel's reflectance from air, by the sines and tangents of the angles.
fn reflectance(cosine: f64, ior: f64) -> f64 {
    let i = cosine.acos();
    if i < 1e-6 {
        return ((ior - 1.0) / (ior + 1.0)).powi(2);
    }
    let t = (i.sin() / ior).asin();
    let s = (i - t).sin() / (i + t).sin();
    let p = (i - t).tan() / (i + t).tan();
    (s * s + p * p) / 2.0
}

/// The textbook's highlight of a lamp of intensity 1, by angles, above a plate with normal z.
fn highlight(m: &Material, v: DVec3, l: DVec3) -> f64 {
    let h = (v + l) / (v + l).length();
    let n = f64::from(m.shininess);
    match m.model {
        Model::Phong => DVec3::new(-l.x, -l.y, l.z).dot(v).max(0.0).powf(n),
        Model::Blinn => h.z.powf(n),
        Model::Hall => reflectance(v.dot(h), m.ior) * h.z.powf(n),
        Model::CookTorrance => {
            let slope2 = f64::from(m.roughness).powi(2);
            let alpha = h.z.acos();
            let d = (-(alpha.tan().powi(2)) / slope2).exp() / (PI * slope2 * alpha.cos().powi(4));
            let masked = 2.0 * h.z * v.z / v.dot(h);
            let shadowed = 2.0 * h.z * l.z / v.dot(h);
            let g = masked.min(shadowed).min(1.0);
            PI * d * reflectance(v.dot(h), m.ior) * g / (4.0 * v.z)
        }
    }
}

fn plate(material: Material, to_eye: DVec3, to_light: DVec3) -> Scene {
    let lamp = Light { place: LightPlace::Direction(-to_light), ..Light::new("lamp") };
    Scene {
        materials: vec![material],
        solids: vec![solid(slab(-1.0, 0.0), 0)],
        lights: vec![lamp],
        ..one_ray(to_eye * 5.0, -to_eye)
    }
}

/// Every model with parameters from dull to sharp.
fn materials() -> Vec<Material> {
    let base = || Material { specular: Rgb::grey(0.8), diffuse: Rgb::grey(0.3), ..mirror(0.0) };
    let powers = [Model::Phong, Model::Blinn, Model::Hall].into_iter().flat_map(move |model| {
        [1.0, 7.5, 60.0].map(|shininess| Material { model, shininess, ior: 1.8, ..base() })
    });
    let model = Model::CookTorrance;
    let facets = [0.05, 0.3, 1.0].map(|roughness| Material { model, roughness, ..base() });
    powers.chain(facets).collect()
}

/// The largest relative difference of a picture from `formula`, over all materials and directions.
fn worst(formula: impl Fn(&Material, DVec3, DVec3) -> f64) -> f64 {
    let mut worst = 0.0f64;
    for material in materials() {
        for (eye, lamp, turned) in [(0.0, 5.0, 0.0), (30.0, 35.0, 178.0), (70.0, 60.0, 190.0)] {
            let (v, l) = (direction(eye, 0.0), direction(lamp, turned));
            let session = open(plate(material.clone(), v, l));
            let expected = formula(&material, v, l);
            worst =
                light(&session).iter().fold(worst, |w, x| w.max((x - expected).abs() / expected));
        }
    }
    worst
}

#[test]
fn a_plate_shows_what_every_model_says() {
    let local = |m: &Material, v, l: DVec3| {
        f64::from(m.diffuse.0[0]) * l.z + f64::from(m.specular.0[0]) * highlight(m, v, l)
    };
    let found = worst(local);
    assert!(found < 1e-5, "differs by {found:e}");
    // The comparison sees a hundredth of a highlight.
    assert!(worst(|m, v, l| local(m, v, l) + 0.01 * highlight(m, v, l)) > 1e-3);
}

#[test]
fn hall_s_model_shows_a_lamp_behind_a_pane() {
    let points = [(-9.0, -9.0), (9.0, -9.0), (9.0, 9.0), (-9.0, 9.0)];
    let pane = Shape::Polygon { points: points.map(|(x, y)| DVec3::new(x, y, 0.0)).to_vec() };
    let filter = Rgb([1.0, 0.5, 0.25]);
    let material = Material {
        specular: Rgb::grey(0.8),
        shininess: 9.0,
        transmit: Rgb::grey(0.6),
        filter,
        model: Model::Hall,
        ..mirror(0.0)
    };
    for (eye, lamp, turned) in [(0.0, 10.0, 0.0), (50.0, 40.0, 10.0), (20.0, 50.0, 70.0)] {
        let (v, l) = (direction(eye, 0.0), -direction(lamp, turned));
        let scene = Scene { solids: vec![solid(pane.clone(), 0)], ..plate(material.clone(), v, l) };
        let passed = 1.0 - reflectance(v.z, material.ior);
        let expected = 0.8 * 0.6 * passed * (-v).dot(l).max(0.0).powf(9.0);
        for (found, filter) in light(&open(scene.clone())).into_iter().zip(filter.0) {
            let expected = expected * f64::from(filter);
            assert!((found - expected).abs() < 1e-5 * expected, "{found} {expected}");
        }
        // Nobody else shows it.
        for model in [Model::Phong, Model::Blinn, Model::CookTorrance] {
            let mut other = scene.clone();
            other.materials[0].model = model;
            assert_eq!(light(&open(other)), [0.0; 3]);
        }
    }
}
