//! Mass properties of plain primitives without any ray.

use std::f64::consts::PI;

use glam::DVec3;

use super::moments::{COUNT, Estimate, Moments, second};
use crate::scene::Shape;

/// The exact moments of a shape scaled along its axes, about `about` in that scaled space; `None` of a
/// shape without a formula here. Their covariance is zero.
pub(super) fn moments(shape: &Shape, scale: DVec3, about: DVec3) -> Option<Estimate> {
    let (volume, center, spread) = match shape {
        // ∫x² = V·r²/5
        Shape::Sphere { center, radius } => {
            (4.0 / 3.0 * PI * radius.powi(3), *center, DVec3::splat(radius * radius / 5.0))
        }
        // ∫x² = V·h²/3 with half sides h
        Shape::Box { min, max } => {
            let half = (*max - *min) / 2.0;
            (8.0 * half.x * half.y * half.z, *min + half, half * half / 3.0)
        }
        _ => return None,
    };
    let volume = volume * scale.x * scale.y * scale.z;
    let (center, spread) = (center * scale - about, spread * scale * scale);
    let mut mean: Moments = [0.0; COUNT];
    mean[0] = volume;
    for a in 0..3 {
        mean[1 + a] = volume * center[a];
        mean[second(a, a)] = volume * (center[a] * center[a] + spread[a]);
        let b = (a + 1) % 3;
        mean[second(a, b)] = volume * center[a] * center[b];
    }
    Some(Estimate { mean, ..Estimate::ZERO })
}
