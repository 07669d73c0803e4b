//! The same scene in other units of length and elsewhere in the world: a power of two changes no bit
//! of the picture, a million units of translation hardly a pixel.

use glam::DVec3;

use std::sync::Arc;

use rayforest::film::Frame;
use rayforest::scene::{Camera, Lens, LightPlace, Paint, Placement, Scene, Shape};
use rayforest::session::Session;

use super::picture::Picture;
use super::stage::{open, shipped};

/// The shipped mesh scene with a coarse knot.
fn coarse_mesh() -> Scene {
    let mut scene = shipped("mesh");
    for solid in &mut scene.solids {
        if let Shape::Knot { turns: _, tube: _, segments } = &mut solid.shape {
            *segments = [120, 12];
        }
    }
    scene
}

fn scenes() -> [(&'static str, Scene); 3] {
    [("whitted", shipped("whitted")), ("mesh", coarse_mesh()), ("mirrors", shipped("mirrors"))]
}

/// The scene with every length multiplied by `by`.
fn scaled(scene: &Scene, by: f64) -> Scene {
    let mut scene = scene.clone();
    let Camera { eye, target, up: _, lens, aperture, focus, shutter: _ } = &mut scene.camera;
    *eye *= by;
    *target *= by;
    *aperture *= by;
    *focus *= by;
    if let Lens::Parallel { height } = lens {
        *height *= by;
    }
    for light in &mut scene.lights {
        if let LightPlace::Point(point) = &mut light.place {
            *point *= by;
        }
    }
    scale_checkers(&mut scene, by);
    for solid in &mut scene.solids {
        let Placement { translate, rotate_degrees: _, scale } = &mut solid.placement;
        *translate *= by;
        solid.motion.translate *= by;
        match &mut solid.shape {
            Shape::Sphere { center, radius } | Shape::Sphereflake { center, radius, levels: _ } => {
                *center *= by;
                *radius *= by;
            }
            Shape::Plane { normal: _, offset } => *offset *= by,
            Shape::Box { min, max } => {
                *min *= by;
                *max *= by;
            }
            Shape::Polygon { points } => points.iter_mut().for_each(|p| *p *= by),
            // What its operands are made of is scaled itself.
            Shape::Csg { .. } => {}
            Shape::Cylinder { from, to, radius } => {
                *from *= by;
                *to *= by;
                *radius *= by;
            }
            Shape::Cone { from, to, radius, tip } => {
                *from *= by;
                *to *= by;
                *radius *= by;
                *tip *= by;
            }
            Shape::Torus { major, minor } => {
                *major *= by;
                *minor *= by;
            }
            Shape::Ellipsoid { center, radii } => {
                *center *= by;
                *radii *= by;
            }
            Shape::Prism { outline, bottom, top } => {
                outline.iter_mut().flatten().for_each(|p| *p *= by);
                *bottom *= by;
                *top *= by;
            }
            Shape::Mesh { .. } | Shape::Knot { .. } | Shape::Quadric { .. } => *scale *= by,
        }
    }
    scene
}

fn scale_checkers(scene: &mut Scene, by: f64) {
    for material in &mut scene.materials {
        if let Paint::Checker { a: _, b: _, size } = &mut material.paint {
            *size *= by;
        }
    }
}

/// The scene moved by `by`, which must be an even multiple of every checker's size.
fn moved(scene: &Scene, by: DVec3) -> Scene {
    let mut scene = scene.clone();
    scene.camera.eye += by;
    scene.camera.target += by;
    for light in &mut scene.lights {
        if let LightPlace::Point(point) = &mut light.place {
            *point += by;
        }
    }
    for solid in &mut scene.solids {
        solid.placement.translate += by;
    }
    scene
}

/// Whether `larger` is the picture and the trees of `session` with all lengths times `by`, bit for
/// bit.
fn same_but_for_units(session: &Session, larger: &Session, by: f64) -> bool {
    let film = |s: &Session| -> Vec<u32> {
        let blocks = s.film().blocks;
        blocks.iter().flat_map(|b| b.0.as_flattened()).map(|c| c.to_bits()).collect()
    };
    let mut forest = session.forest().clone();
    for node in forest.tiles.iter_mut().flatten().flat_map(|trees| &mut Arc::make_mut(trees).nodes)
    {
        node.t *= by;
    }
    session.frame() == larger.frame() && film(session) == film(larger) && forest == *larger.forest()
}

/// Leaves the pictures of two sessions; gives where.
fn leave(ours: &Session, reference: &Session, name: &str) -> String {
    Picture::of_film(&ours.film()).leave(&Picture::of_film(&reference.film()), name)
}

/// The share of pixels of which a channel differs by more than one.
fn beyond_one(a: &Frame, b: &Frame) -> f64 {
    assert_eq!(a.size, b.size, "frames of one size");
    let pixels = a.bytes.chunks_exact(4).zip(b.bytes.chunks_exact(4));
    let differs = |(a, b): (&[u8], &[u8])| a.iter().zip(b).any(|(a, b)| a.abs_diff(*b) > 1);
    pixels.clone().filter(|pair| differs(*pair)).count() as f64 / pixels.len() as f64
}

#[test]
fn acne_a_power_of_two_changes_no_bit_of_a_picture() {
    for (name, scene) in scenes() {
        let session = open(scene.clone());
        for exponent in [-20, -7, 5, 20] {
            let by = 2f64.powi(exponent);
            let larger = open(scaled(&scene, by));
            if !same_but_for_units(&session, &larger, by) {
                let files = leave(&larger, &session, &format!("scaled-{name}"));
                panic!("{name} times 2^{exponent}: another picture, or other trees\n{files}");
            }
        }
    }
}

#[test]
fn acne_a_million_units_away_it_is_the_same_picture() {
    for (name, scene) in scenes() {
        let session = open(scene.clone());
        for by in [[1e6, 1e6, 1e6], [-1e6, 1e6, 0.0], [0.0, -1e6, -1e6]] {
            let away = open(moved(&scene, by.into()));
            let share = beyond_one(session.frame(), away.frame());
            if share > 0.01 {
                let files = leave(&away, &session, &format!("moved-{name}"));
                panic!("{name} by {by:?}: {} % of the pixels differ\n{files}", share * 100.0);
            }
        }
    }
}

#[test]
fn the_comparisons_see_what_is_not_the_same() {
    let scene = shipped("whitted");
    let session = open(scene.clone());
    assert!(same_but_for_units(&session, &session, 1.0));
    // A length that is not scaled: the checker, a light, a solid, the eye.
    for length in 0..4 {
        let mut wrong = scaled(&scene, 4.0);
        match length {
            0 => scale_checkers(&mut wrong, 0.25),
            1 => wrong.lights[0].place = scene.lights[0].place.clone(),
            2 => wrong.solids[2] = scene.solids[2].clone(),
            _ => wrong.camera.eye = scene.camera.eye,
        }
        let wrong = open(wrong);
        assert!(!same_but_for_units(&session, &wrong, 4.0), "{length}");
        assert!(beyond_one(session.frame(), wrong.frame()) > 0.01, "{length}");
    }
    // A factor that rounds shows in the trees, an odd number of checker cubes in the frame.
    assert!(!same_but_for_units(&session, &open(scaled(&scene, 3.0)), 3.0));
    let odd = open(moved(&scene, DVec3::new(1e6 + 1.0, 0.0, 0.0)));
    assert!(beyond_one(session.frame(), odd.frame()) > 0.01);
}
