//! Points around the parts of a solid that may be thin, for what looks for things thinner than a pixel.

use std::f64::consts::TAU;

use glam::DVec3;

use super::generate::knot_frame;
use super::placement::{Placed, box_corners, corners};
use crate::scene::{Shape, Solid};

/// Points around each part of a solid, in world space, at the beginning of its motion: the solid as a
/// whole, or the stretches of a knot's tube. None of an infinite plane and of a sphereflake, whose
/// spheres stand beside each other where they are small.
pub fn parts(solid: &Solid) -> Vec<Vec<DVec3>> {
    let placed = Placed::new(&solid.placement);
    match &solid.shape {
        Shape::Knot { turns, tube, segments: [along, _] } => {
            let ring = |i: u32| {
                let phi = TAU * f64::from(i) / f64::from(*along);
                let (center, normal, binormal) = knot_frame(*turns, phi);
                let corner = |a: f64, b: f64| center + (normal * a + binormal * b) * *tube;
                [corner(-1.0, -1.0), corner(-1.0, 1.0), corner(1.0, -1.0), corner(1.0, 1.0)]
                    .map(|point| placed.point(point))
            };
            (0..*along).map(|i| [ring(i), ring(i + 1)].concat()).collect()
        }
        Shape::Mesh { mesh, .. } => {
            let none = [DVec3::INFINITY, DVec3::NEG_INFINITY];
            let points = mesh.positions.iter();
            vec![box_corners(points.fold(none, |[a, b], p| [a.min(*p), b.max(*p)]), &placed)]
        }
        _ => corners(solid).into_iter().collect(),
    }
}
