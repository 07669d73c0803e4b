//! Mass properties of plain primitives without any ray.

use std::f64::consts::PI;

use glam::{DMat3, DVec3};

use super::moments::{COUNT, Estimate, Moments, VOLUME, dense, second};
use crate::scene::Shape;

/// A solid by formulas, in object space.
struct Formula {
    volume: f64,
    /// Its centre of mass.
    center: DVec3,
    /// Second moments about the centre, per volume: the mean of x·xᵀ.
    spread: DMat3,
}

impl Formula {
    fn plain(volume: f64, center: DVec3, spread: DVec3) -> Formula {
        Formula { volume, center, spread: DMat3::from_diagonal(spread) }
    }

    /// Round about an axis: `along` and `across` it.
    fn round(volume: f64, center: DVec3, axis: DVec3, [along, across]: [f64; 2]) -> Formula {
        let on_axis = DMat3::from_cols(axis * axis.x, axis * axis.y, axis * axis.z);
        let spread = DMat3::IDENTITY * across + on_axis * (along - across);
        Formula { volume, center, spread }
    }
}

/// The exact moments of a shape of this density scaled along its axes, about `about` in that scaled
/// space; `None` of a shape without a formula here. Their covariance is zero.
pub(super) fn moments(shape: &Shape, density: f64, scale: DVec3, about: DVec3) -> Option<Estimate> {
    let Formula { volume, center, spread } = formula(shape)?;
    let volume = volume * scale.x * scale.y * scale.z;
    let center = center * scale - about;
    let stretch = DMat3::from_diagonal(scale);
    let spread = stretch * spread * stretch;
    let mut mean: Moments = [0.0; COUNT];
    mean[0] = volume;
    mean[VOLUME] = volume;
    for a in 0..3 {
        mean[1 + a] = volume * center[a];
        for b in [a, (a + 1) % 3] {
            mean[second(a, b)] = volume * (center[a] * center[b] + spread.col(a)[b]);
        }
    }
    Some(Estimate { mean: dense(mean, density), ..Estimate::ZERO })
}

fn formula(shape: &Shape) -> Option<Formula> {
    Some(match shape {
        // mean x² = r²/5
        Shape::Sphere { center, radius } => {
            let spread = DVec3::splat(radius * radius / 5.0);
            Formula::plain(4.0 / 3.0 * PI * radius.powi(3), *center, spread)
        }
        Shape::Ellipsoid { center, radii } => {
            let volume = 4.0 / 3.0 * PI * radii.x * radii.y * radii.z;
            Formula::plain(volume, *center, *radii * *radii / 5.0)
        }
        // mean x² = h²/3 with half sides h
        Shape::Box { min, max } => {
            let half = (*max - *min) / 2.0;
            Formula::plain(8.0 * half.x * half.y * half.z, *min + half, half * half / 3.0)
        }
        Shape::Cylinder { from, to, radius } => frustum(*from, *to, [*radius; 2]),
        Shape::Cone { from, to, radius, tip } => frustum(*from, *to, [*radius, *tip]),
        // A tube with a hole, or whose hole has just closed.
        Shape::Torus { major, minor } if minor <= major => {
            let [r, t] = [major * major, minor * minor];
            let volume = 2.0 * PI * PI * major * t;
            let across = r / 2.0 + 3.0 / 8.0 * t;
            Formula::round(volume, DVec3::ZERO, DVec3::Z, [t / 4.0, across])
        }
        _ => return None,
    })
}

/// A cone with its tip cut off, of radius a at one end and b at the other: integrals of π·r² and
/// π·r⁴/4 along the axis.
fn frustum(from: DVec3, to: DVec3, [a, b]: [f64; 2]) -> Formula {
    let height = from.distance(to);
    let axis = (to - from) / height;
    let grown = b - a;
    // ∫ r²·sᵏ ds over 0 … 1
    let moment =
        |k: f64| a * a / (k + 1.0) + 2.0 * a * grown / (k + 2.0) + grown * grown / (k + 3.0);
    let [zeroth, first, second] = [0.0, 1.0, 2.0].map(moment);
    let middle = first / zeroth;
    let along = height * height * (second / zeroth - middle * middle);
    let fourth = (a.powi(4) + a.powi(3) * b + a * a * b * b + a * b.powi(3) + b.powi(4)) / 5.0;
    let across = fourth / (4.0 * zeroth);
    Formula::round(PI * height * zeroth, from + axis * (height * middle), axis, [along, across])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formulas_of_the_books() {
        let cone = Shape::Cone { from: DVec3::ZERO, to: DVec3::Z * 2.0, radius: 3.0, tip: 0.0 };
        let Formula { volume, center, spread } = formula(&cone).unwrap();
        assert!((volume - 6.0 * PI).abs() < 1e-13);
        assert!((center - DVec3::Z * 0.5).length() < 1e-15, "a quarter of the height: {center}");
        // Axis 3/10 r²; across about the middle of the base 3/20 r² + h²/10.
        assert!((spread.x_axis.x + spread.y_axis.y - 2.7).abs() < 1e-13);
        let base = spread.x_axis.x + spread.z_axis.z + center.z * center.z;
        assert!((base - (0.15 * 9.0 + 0.4)).abs() < 1e-13, "{base}");
        let rod = Shape::Cylinder { from: DVec3::X, to: DVec3::X * 5.0, radius: 2.0 };
        let Formula { volume, center, spread } = formula(&rod).unwrap();
        assert!((volume - 16.0 * PI).abs() < 1e-13 && (center - DVec3::X * 3.0).length() < 1e-15);
        // Axis r²/2, across (3r² + h²)/12.
        assert!((spread.y_axis.y + spread.z_axis.z - 2.0).abs() < 1e-13);
        assert!((spread.x_axis.x + spread.y_axis.y - 28.0 / 12.0).abs() < 1e-13);
        let Formula { volume, spread, .. } =
            formula(&Shape::Torus { major: 1.0, minor: 0.3 }).unwrap();
        assert!((volume - 1.776_528_792_20).abs() < 1e-10);
        // Axis R² + ¾r², across R²/2 + ⅝r².
        assert!((spread.x_axis.x + spread.y_axis.y - (1.0 + 0.75 * 0.09)).abs() < 1e-14);
        assert!((spread.y_axis.y + spread.z_axis.z - (0.5 + 0.625 * 0.09)).abs() < 1e-14);
        assert!(formula(&Shape::Torus { major: 0.3, minor: 1.0 }).is_none());
    }
}
