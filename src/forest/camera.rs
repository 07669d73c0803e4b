//! The ray that leaves the eye through a point of the picture.

use glam::DVec3;

use crate::geometry::Ray;
use crate::scene::{Camera, Lens};

/// A camera made ready: the picture plane in world space.
#[derive(Clone, Debug)]
pub struct View {
    eye: DVec3,
    forward: DVec3,
    /// Across the whole picture, from its left edge to its right one.
    across: DVec3,
    /// Down the whole picture, from its upper edge to its lower one.
    down: DVec3,
    parallel: bool,
    size: [f64; 2],
}

impl View {
    /// A view of `size` pixels. The camera's invariants (eye ≠ target, up not along the view) hold.
    pub fn new(camera: &Camera, size: [u32; 2]) -> View {
        let Camera { eye, target, up, lens } = camera;
        let forward = (*target - *eye).normalize();
        let right = forward.cross(*up).normalize();
        let up = right.cross(forward);
        let size = size.map(f64::from);
        let (height, parallel) = match lens {
            Lens::Perspective { fov_degrees } => {
                (2.0 * libm::tan(fov_degrees.to_radians() / 2.0), false)
            }
            Lens::Parallel { height } => (*height, true),
        };
        let across = right * (height * size[0] / size[1]);
        View { eye: *eye, forward, across, down: up * -height, parallel, size }
    }

    /// The ray through (x, y) in pixels from the upper left corner of the picture.
    #[inline(always)]
    pub fn ray(&self, x: f64, y: f64) -> Ray {
        let u = x / self.size[0] - 0.5;
        let v = y / self.size[1] - 0.5;
        let offset = self.across * u + self.down * v;
        if self.parallel {
            Ray { origin: self.eye + offset, direction: self.forward }
        } else {
            Ray { origin: self.eye, direction: (self.forward + offset).normalize() }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn camera(lens: Lens) -> Camera {
        Camera { eye: DVec3::new(0.0, -8.0, 1.0), target: DVec3::Z, up: DVec3::Z, lens }
    }

    #[test]
    fn centre_sees_the_target_and_edges_the_field_of_view() {
        let view = View::new(&camera(Lens::Perspective { fov_degrees: 90.0 }), [200, 100]);
        assert_eq!(view.ray(100.0, 50.0).direction, DVec3::Y);
        let top = view.ray(100.0, 0.0).direction;
        assert!((top - DVec3::new(0.0, 1.0, 1.0).normalize()).length() < 1e-15);
        let right = view.ray(200.0, 50.0).direction;
        assert!((right - DVec3::new(2.0, 1.0, 0.0).normalize()).length() < 1e-15);
    }

    #[test]
    fn parallel_rays_start_on_the_picture_plane() {
        let view = View::new(&camera(Lens::Parallel { height: 4.0 }), [200, 100]);
        let corner = view.ray(0.0, 0.0);
        assert_eq!(corner.direction, DVec3::Y);
        assert!((corner.origin - DVec3::new(-4.0, -8.0, 3.0)).length() < 1e-14);
    }
}
