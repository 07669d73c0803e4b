//! A camera and a light for files that have none.

use glam::DVec3;

use super::job::Job;
use super::place::At;
use crate::scene::{Camera, Light, LightPlace, Scene, Shape};

/// Distance of the eye in radii: the ball around the scene fits into the default field of view.
const DISTANCE: f64 = 2.7;

/// Adds what is missing so that something is seen, and says so.
pub(super) fn complete(job: &mut Job<'_>, scene: &mut Scene, up: DVec3) {
    let [low, high] = bounds(scene);
    let center = (low + high) / 2.0;
    let radius = ((high - low).length() / 2.0).max(1e-9);
    // To the right, above, in front.
    let front = if up == DVec3::Y { DVec3::Z } else { DVec3::NEG_Y };
    let right = front.cross(-up).normalize();
    if scene.camera == Camera::default() {
        let direction = (front + 0.5 * right + 0.5 * up).normalize();
        scene.camera.eye = center + direction * (DISTANCE * radius);
        scene.camera.target = center;
        scene.camera.up = up;
        job.note(At::File, "added: a camera that sees all of it, for the file has none");
    }
    if scene.lights.is_empty() {
        let Camera { eye, target, up, .. } = &scene.camera;
        let view = (*target - *eye).normalize_or(-front);
        let left = up.cross(view).normalize_or(-right);
        let at = *eye + (left + up.normalize_or(DVec3::Z)) * radius;
        scene.lights.push(Light { place: LightPlace::Point(at), ..Light::new("key") });
        job.note(At::File, "added: a light beside the camera, for the file has none");
    }
}

/// Lowest and highest corner of what has bounds; solids are where they were read, not placed.
fn bounds(scene: &Scene) -> [DVec3; 2] {
    let mut corners = [DVec3::INFINITY, DVec3::NEG_INFINITY];
    let mut take = |p: DVec3| corners = [corners[0].min(p), corners[1].max(p)];
    for solid in &scene.solids {
        match &solid.shape {
            Shape::Mesh { file: _, mesh } => {
                // Points that no triangle uses do not count.
                let used = mesh.triangles.iter().flatten();
                used.for_each(|index| take(mesh.positions[*index as usize]));
            }
            Shape::Sphere { center, radius } => {
                take(*center - *radius);
                take(*center + *radius);
            }
            Shape::Cylinder { from, to, radius } | Shape::Cone { from, to, radius, tip: _ } => {
                take(from.min(*to) - *radius);
                take(from.max(*to) + *radius);
            }
            _ => {}
        }
    }
    if corners[0].is_finite() { corners } else { [DVec3::NEG_ONE, DVec3::ONE] }
}
