//! Solids made from a few numbers: the torus knot as a closed mesh and the sphereflake as spheres.

use std::f64::consts::{FRAC_PI_6, PI, TAU};

use glam::DVec3;

use crate::progress::{Cancelled, Progress};
use crate::scene::mesh::Mesh;

/// Distance of the knot's curve from the circle of radius 1 that it winds around.
const KNOT_WINDING_RADIUS: f64 = 0.5;

/// A tube around the torus knot `((1 + cos(qφ)/2)·(cos pφ, sin pφ), sin(qφ)/2)`, closed, outward
/// counter-clockwise, with smooth normals.
///
/// The cross-section's frame is the torus' own normal and its cross product with the tangent; both
/// depend on the place alone, so the tube closes without a twist.
pub(super) fn knot(
    turns: [u32; 2],
    tube: f64,
    segments: [u32; 2],
    progress: &Progress,
) -> Result<Mesh, Cancelled> {
    let [along, around] = segments;
    let mut mesh = Mesh::default();
    for i in 0..along {
        progress.check()?;
        let (center, normal, binormal) = knot_frame(turns, TAU * f64::from(i) / f64::from(along));
        for j in 0..around {
            let theta = TAU * f64::from(j) / f64::from(around);
            let out = normal * libm::cos(theta) + binormal * libm::sin(theta);
            mesh.positions.push(center + out * tube);
            mesh.normals.push(out);
        }
    }
    for i in 0..along {
        progress.check()?;
        for j in 0..around {
            let at = |i: u32, j: u32| (i % along) * around + j % around;
            let (a, b, c, d) = (at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
            mesh.triangles.extend([[a, d, c], [a, c, b]]);
        }
    }
    mesh.triangle_normals = mesh.triangles.clone();
    Ok(mesh)
}

/// Point, torus normal and binormal (tangent × normal) of the knot at `phi` radians.
pub(super) fn knot_frame([p, q]: [u32; 2], phi: f64) -> (DVec3, DVec3, DVec3) {
    let (p, q) = (f64::from(p), f64::from(q));
    let (sp, cp) = (libm::sin(p * phi), libm::cos(p * phi));
    let (sq, cq) = (libm::sin(q * phi), libm::cos(q * phi));
    let radial = DVec3::new(cp, sp, 0.0);
    let tangential = DVec3::new(-sp, cp, 0.0);
    let normal = radial * cq + DVec3::Z * sq;
    let center = radial + normal * KNOT_WINDING_RADIUS;
    let tangent = tangential * (p * (1.0 + KNOT_WINDING_RADIUS * cq))
        + (DVec3::Z * cq - radial * sq) * (q * KNOT_WINDING_RADIUS);
    (center, normal, tangent.cross(normal).normalize())
}

/// Centre and radius of every sphere of Haines' sphereflake, parents before children.
///
/// The axis of the largest sphere is +z. Relative to its parent's axis a sphere has six children on
/// the equator and three above; all nine touch it and each other's neighbours, and their axes point
/// away from it (E. Haines, "A Proposal for Standard Graphics Environments", 1987).
pub(super) fn sphereflake(center: DVec3, radius: f64, levels: u32) -> Vec<(DVec3, f64)> {
    let directions = flake_directions();
    let mut spheres = vec![(center, radius)];
    let mut axes = vec![DVec3::Z];
    let mut begin = 0;
    for _ in 1..levels {
        let end = spheres.len();
        for parent in begin..end {
            let ((center, radius), axis) = (spheres[parent], axes[parent]);
            for direction in directions {
                let out = turn_z_to(axis, direction);
                spheres.push((center + out * (radius * (4.0 / 3.0)), radius / 3.0));
                axes.push(out);
            }
        }
        begin = end;
    }
    spheres
}

/// The nine directions to the children of a sphere whose axis is +z.
fn flake_directions() -> [DVec3; 9] {
    std::array::from_fn(|i| {
        let set = PI / 4.0 + TAU / 3.0 * (i / 3) as f64;
        let at = |azimuth: f64| DVec3::new(libm::cos(azimuth), libm::sin(azimuth), 0.0);
        match i % 3 {
            0 => at(set) * (1.0f64 / 3.0).sqrt() + DVec3::Z * (2.0f64 / 3.0).sqrt(),
            1 => at(set - FRAC_PI_6),
            _ => at(set + FRAC_PI_6),
        }
    })
}

/// `v` turned by the smallest rotation that takes +z to the unit vector `axis`.
fn turn_z_to(axis: DVec3, v: DVec3) -> DVec3 {
    if axis.z <= -1.0 {
        return DVec3::new(-v.x, v.y, -v.z);
    }
    let k = DVec3::new(-axis.y, axis.x, 0.0);
    let turned = v * axis.z + k.cross(v) + k * (k.dot(v) / (1.0 + axis.z));
    turned.normalize()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn knot_normals_point_out_of_a_positive_volume() {
        let mesh = knot([2, 3], 0.2, [200, 16], &Progress::default()).unwrap();
        let corner = |t: &[u32; 3], k: usize| mesh.positions[t[k] as usize];
        let mut volume = 0.0;
        for t in &mesh.triangles {
            let (a, b, c) = (corner(t, 0), corner(t, 1), corner(t, 2));
            volume += a.dot(b.cross(c)) / 6.0;
            let normal = (b - a).cross(c - a);
            assert!(t.iter().all(|v| mesh.normals[*v as usize].dot(normal) > 0.0));
        }
        assert!(volume > 0.0);
    }

    #[test]
    fn flake_spheres_touch_their_parents() {
        let spheres = sphereflake(DVec3::new(1.0, 2.0, 3.0), 0.5, 4);
        assert_eq!(spheres.len(), 820);
        for (child, (center, radius)) in spheres.iter().enumerate().skip(1) {
            let (parent_center, parent_radius) = spheres[(child - 1) / 9];
            let gap = center.distance(parent_center) - radius - parent_radius;
            assert!(gap.abs() < 1e-14, "sphere {child} is {gap} from its parent");
        }
        // six on the equator, three at sin = √(2/3)
        let heights: Vec<f64> =
            (1..10).map(|i| (spheres[i].0.z - 3.0) / (0.5 * 4.0 / 3.0)).collect();
        assert_eq!(heights.iter().filter(|z| z.abs() < 1e-15).count(), 6);
        assert_eq!(heights.iter().filter(|z| (**z - (2f64 / 3.0).sqrt()).abs() < 1e-15).count(), 3);
    }
}
