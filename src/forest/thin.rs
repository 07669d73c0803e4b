//! Pixels that things thinner than a pixel pass through: the first few samples may miss them.

use std::collections::HashSet;

use glam::{DVec2, DVec3};

use super::camera::View;
use crate::geometry::parts;
use crate::scene::Scene;

/// A thing is thin if its picture's least width is less, in pixels: two samples of a pixel are about
/// half a pixel apart.
const THIN: f64 = 1.5;
/// Marks for one thing at most: a wire across the largest picture.
const MOST_MARKS: usize = 1 << 18;

/// The pixels where solids, or stretches of a knot's tube, are seen whose picture is thinner than 1½
/// pixels.
///
/// Parts of a mesh and spheres of a sphereflake are not looked for; nor is what is seen in mirrors.
#[derive(Clone, Debug, Default)]
pub struct ThinPixels {
    pixels: HashSet<[u32; 2]>,
}

impl ThinPixels {
    /// Finds them.
    pub fn of(scene: &Scene) -> ThinPixels {
        let view = View::new(&scene.camera, scene.picture.size);
        let mut pixels = HashSet::new();
        for solid in &scene.solids {
            for part in parts(solid) {
                let seen = project(&view, &part);
                if let Some(strip) = seen.and_then(|points| Strip::around(&points)) {
                    strip.mark(scene.picture.size, &mut pixels);
                }
            }
        }
        ThinPixels { pixels }
    }

    /// Whether a pixel is one of them.
    pub fn contains(&self, pixel: [u32; 2]) -> bool {
        self.pixels.contains(&pixel)
    }
}

/// Where all of these points are seen, in pixels; `None` if one is not in front of the eye.
fn project(view: &View, points: &[DVec3]) -> Option<Vec<DVec2>> {
    points.iter().map(|&point| view.project(point).map(|seen| DVec2::from(seen.at))).collect()
}

/// A narrow strip of the picture, in pixels.
struct Strip {
    from: DVec2,
    along: DVec2,
    length: f64,
    half_width: f64,
}

impl Strip {
    /// The narrowest strip that holds all points, if it is thin: it runs along two of them.
    fn around(points: &[DVec2]) -> Option<Strip> {
        let pairs =
            points.iter().flat_map(|&a| points.iter().map(move |&b| (b - a).normalize_or_zero()));
        // Points that are all the same have no direction: any will do.
        let along = pairs.filter(|along| *along != DVec2::ZERO).chain([DVec2::X]);
        let strip = |along: DVec2| {
            let (mut low, mut high) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
            for &point in points {
                let at = DVec2::new(along.dot(point), along.perp_dot(point));
                (low, high) = (low.min(at), high.max(at));
            }
            let (size, middle) = (high - low, (low.y + high.y) / 2.0);
            let from = along * low.x + along.perp() * middle;
            Strip { from, along, length: size.x, half_width: size.y / 2.0 }
        };
        let narrowest = along.map(strip).min_by(|a, b| a.half_width.total_cmp(&b.half_width));
        narrowest.filter(|strip| 2.0 * strip.half_width < THIN)
    }

    /// Adds the pixels whose square it may touch.
    fn mark(&self, [width, height]: [u32; 2], pixels: &mut HashSet<[u32; 2]>) {
        let Strip { from, along, length, half_width } = *self;
        // Half of a pixel's diagonal, and half a step.
        let reach = half_width + 1.0;
        let steps = (2.0 * length).ceil().min(MOST_MARKS as f64) as usize;
        for step in 0..=steps {
            let at = from + along * (step as f64 / 2.0).min(length);
            let side = |low: f64, most: u32| {
                let clamp = |x: f64| x.clamp(0.0, f64::from(most)) as u32;
                clamp((low - reach).floor())..clamp((low + reach).ceil())
            };
            for y in side(at.y, height) {
                pixels.extend(side(at.x, width).map(|x| [x, y]));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;

    use crate::scene::mesh::Mesh;
    use crate::scene::{Camera, Lens, Placement, Shape, Solid};

    /// A bar of this thickness, in pixels of a picture of 64 × 48, across the picture's middle.
    fn bar(thickness: f64) -> Scene {
        let mut scene = Scene::default();
        scene.picture.size = [64, 48];
        scene.camera = Camera {
            eye: DVec3::new(0.0, -10.0, 0.0),
            target: DVec3::ZERO,
            up: DVec3::Z,
            lens: Lens::Parallel { height: 48.0 },
            ..Camera::default()
        };
        let half = thickness / 2.0;
        scene.solids = vec![Solid {
            name: "bar".into(),
            shape: Shape::Box {
                min: DVec3::new(-20.0, -half, -half),
                max: DVec3::new(20.0, half, half),
            },
            material: 0,
            placement: Placement::default(),
            motion: Default::default(),
        }];
        scene
    }

    #[test]
    fn a_rod_across_the_picture_is_a_wire() {
        let mut scene = bar(0.1);
        let end = DVec3::new(20.0, 0.0, 15.0);
        scene.solids[0].shape = Shape::Cylinder { from: -end, to: end, radius: 0.05 };
        let thin = ThinPixels::of(&scene);
        assert!((12..52).all(|x| thin.contains([x, (24 - (3 * (x as i32 - 32) / 4 + 1)) as u32])));
        assert!(!thin.contains([32, 35]) && thin.pixels.len() < 400);
        scene.solids[0].shape = Shape::Cylinder { from: -end, to: end, radius: 2.0 };
        assert!(ThinPixels::of(&scene).pixels.is_empty());
    }

    #[test]
    fn a_wire_is_found_along_its_length_and_a_beam_is_not() {
        let thin = ThinPixels::of(&bar(0.1));
        assert!((12..52).all(|x| thin.contains([x, 23]) && thin.contains([x, 24])));
        assert!(!thin.contains([32, 30]) && !thin.contains([5, 24]));
        assert!(ThinPixels::of(&bar(4.0)).pixels.is_empty());
    }

    #[test]
    fn so_is_a_thin_tube_along_its_curve_and_a_thin_mesh() {
        let mut scene = bar(1.0);
        scene.camera.eye.y = -30.0;
        let knot = |tube| Shape::Knot { turns: [2, 3], tube, segments: [120, 8] };
        scene.solids[0].placement.scale = DVec3::splat(14.0);
        scene.solids[0].shape = knot(0.02);
        let thin = ThinPixels::of(&scene);
        // Seen along y: the curve (1 + cos(3φ)/2)·cos 2φ, sin(3φ)/2.
        for i in 0..500 {
            let phi = f64::from(i) * 0.012_57;
            let x = (1.0 + libm::cos(3.0 * phi) / 2.0) * libm::cos(2.0 * phi);
            let at = [32.0 + 14.0 * x, 24.0 - 7.0 * libm::sin(3.0 * phi)];
            assert!(thin.contains(at.map(|c| c as u32)), "{phi}: {at:?}");
        }
        assert!(!thin.contains([2, 2]) && !thin.contains([32, 2]));
        scene.solids[0].shape = knot(0.3);
        assert!(ThinPixels::of(&scene).pixels.is_empty());
        let positions = vec![DVec3::ZERO, DVec3::X, DVec3::new(0.5, 0.0, 0.01)];
        let mesh = Mesh { positions, triangles: vec![[0, 1, 2]], ..Mesh::default() };
        scene.solids[0].shape = Shape::Mesh { file: "blade.obj".into(), mesh: Arc::new(mesh) };
        let thin = ThinPixels::of(&scene);
        assert!((33..45).all(|x| thin.contains([x, 23])) && !thin.contains([20, 23]));
    }
}
