//! The ray that leaves the eye through a point of the picture, and the point at which something is seen.

use glam::DVec3;

use super::sampling::on_disc;
use crate::geometry::Ray;
use crate::scene::motion::Opening;
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

/// Where a point of the world is seen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Seen {
    /// Pixels from the upper left corner of the picture; beyond its edges for what lies beside it.
    pub at: [f64; 2],
    /// Distance from the eye's plane along the view, world units, > 0.
    pub depth: f64,
}

impl View {
    /// A view of `size` pixels. The camera's invariants (eye ≠ target, up not along the view) hold.
    pub fn new(camera: &Camera, size: [u32; 2]) -> View {
        let Camera { eye, target, up, lens, aperture: _, focus: _, shutter: _ } = camera;
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

    /// The ray of a perspective through (x, y) that crosses its lens at the point with these numbers:
    /// all of them meet in the plane in focus, where the pinhole's ray does.
    pub fn ray_through_lens(&self, [x, y]: [f64; 2], opening: Opening, numbers: [f64; 2]) -> Ray {
        let Opening { radius, focus } = opening;
        let [a, b] = on_disc(numbers).map(|n| n * radius);
        let [right, down, forward] = self.axes();
        let (u, v) = (x / self.size[0] - 0.5, y / self.size[1] - 0.5);
        let on_lens = right * a + down * b;
        let in_focus = (forward + (self.across * u + self.down * v)) * focus;
        Ray { origin: self.eye + on_lens, direction: (in_focus - on_lens).normalize() }
    }

    /// Where a point of the world is seen; `None` if it is not in front of the eye.
    ///
    /// [`View::point`] undoes it, and the ray through that pixel meets the point, both to some ulps of
    /// the distances in play.
    pub fn project(&self, point: DVec3) -> Option<Seen> {
        let arm = point - self.eye;
        let depth = arm.dot(self.forward);
        let offset = if self.parallel { arm } else { arm / depth };
        let share = |axis: DVec3| offset.dot(axis) / axis.length_squared() + 0.5;
        let at = [share(self.across) * self.size[0], share(self.down) * self.size[1]];
        (depth > 0.0 && at.iter().all(|x| x.is_finite())).then_some(Seen { at, depth })
    }

    /// The point of the world that is seen there.
    pub fn point(&self, seen: Seen) -> DVec3 {
        let Seen { at: [x, y], depth } = seen;
        let (u, v) = (x / self.size[0] - 0.5, y / self.size[1] - 0.5);
        let offset = self.across * u + self.down * v;
        let scale = if self.parallel { 1.0 } else { depth };
        self.eye + self.forward * depth + offset * scale
    }

    /// What the height of the picture covers at a depth, world units.
    pub fn height_at(&self, depth: f64) -> f64 {
        self.down.length() * if self.parallel { 1.0 } else { depth }
    }

    /// Directions of length 1 in world space: right and down in the picture, and into it.
    pub fn axes(&self) -> [DVec3; 3] {
        [self.across.normalize(), self.down.normalize(), self.forward]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn camera(lens: Lens) -> Camera {
        let (eye, target) = (DVec3::new(0.0, -8.0, 1.0), DVec3::Z);
        Camera { eye, target, up: DVec3::Z, lens, ..Camera::default() }
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

    /// A view whose axes are none of the world's.
    fn oblique(lens: Lens) -> View {
        let eye = DVec3::new(3.0, -8.0, 5.0);
        let target = DVec3::new(-1.0, 0.5, 1.0);
        let up = DVec3::new(0.1, 0.2, 1.0);
        View::new(&Camera { eye, target, up, lens, ..Camera::default() }, [640, 360])
    }

    /// How far a ray passes from a point.
    fn miss(ray: &Ray, point: DVec3) -> f64 {
        (point - ray.origin).cross(ray.direction).length()
    }

    #[test]
    fn a_point_is_seen_where_its_ray_leaves_the_picture() {
        for lens in [Lens::Perspective { fov_degrees: 50.0 }, Lens::Parallel { height: 7.0 }] {
            let view = oblique(lens);
            for seen in [[320.0, 180.0], [0.0, 0.0], [640.0, 360.0], [17.25, 301.5], [-90.0, 400.0]]
                .into_iter()
                .flat_map(|at| [1e-3, 1.0, 9.0, 1e4].map(|depth| Seen { at, depth }))
            {
                let point = view.point(seen);
                let back = view.project(point).expect("it is in front of the eye");
                let wrong = (0..2).map(|i| (back.at[i] - seen.at[i]).abs()).fold(0.0, f64::max);
                assert!(wrong < 1e-6 && (back.depth / seen.depth - 1.0).abs() < 1e-10, "{back:?}");
                let ray = view.ray(seen.at[0], seen.at[1]);
                assert!(miss(&ray, point) < 1e-11 * seen.depth.max(10.0), "{seen:?}");
                let beside = view.ray(seen.at[0] + 1.0, seen.at[1]);
                assert!(miss(&beside, point) > 1e-7, "another pixel's ray misses it");
            }
        }
    }

    #[test]
    fn rays_through_the_lens_meet_in_the_plane_in_focus() {
        let view = oblique(Lens::Perspective { fov_degrees: 50.0 });
        let opening = Opening { radius: 0.3, focus: 5.0 };
        let [right, down, forward] = view.axes();
        for at in [[320.0, 180.0], [3.5, 77.0], [600.0, 359.0]] {
            let point = view.point(Seen { at, depth: 5.0 });
            let nearer = view.point(Seen { at, depth: 4.0 });
            for numbers in [[0.5, 0.5], [0.0, 0.3], [0.9, 0.99]] {
                let ray = view.ray_through_lens(at, opening, numbers);
                assert!(miss(&ray, point) < 1e-12, "{at:?} {numbers:?}");
                let arm = ray.origin - view.eye;
                assert!(arm.length() <= 0.3 + 1e-15 && arm.dot(forward).abs() < 1e-15);
                let [a, b] = on_disc(numbers);
                assert!((arm - right * (0.3 * a) - down * (0.3 * b)).length() < 1e-15);
                let off = miss(&ray, nearer) > 1e-3;
                assert_eq!(off, numbers != [0.5, 0.5], "only the middle of the lens is a pinhole");
            }
            let pinhole = view.ray(at[0], at[1]);
            let middle = view.ray_through_lens(at, opening, [0.5, 0.5]);
            assert!((pinhole.direction - middle.direction).length() < 1e-15);
        }
    }

    #[test]
    fn the_target_is_in_the_middle_and_nothing_is_seen_behind_the_eye() {
        for lens in [Lens::Perspective { fov_degrees: 50.0 }, Lens::Parallel { height: 7.0 }] {
            let view = oblique(lens);
            let (eye, target) = (DVec3::new(3.0, -8.0, 5.0), DVec3::new(-1.0, 0.5, 1.0));
            let Seen { at: [x, y], depth } = view.project(target).unwrap();
            assert!((x - 320.0).abs() < 1e-9 && (y - 180.0).abs() < 1e-9, "{x} {y}");
            assert!((depth - eye.distance(target)).abs() < 1e-12);
            assert_eq!(view.project(eye), None);
            assert_eq!(view.project(eye * 2.0 - target), None);
        }
    }

    #[test]
    fn the_height_at_a_depth_reaches_from_edge_to_edge() {
        for lens in [Lens::Perspective { fov_degrees: 50.0 }, Lens::Parallel { height: 7.0 }] {
            let view = oblique(lens);
            let edge = |y: f64| view.point(Seen { at: [100.0, y], depth: 3.0 });
            let height = edge(360.0) - edge(0.0);
            assert!((height.length() - view.height_at(3.0)).abs() < 1e-12);
            let [right, down, forward] = view.axes();
            assert!((height.normalize() - down).length() < 1e-12);
            assert!((right.cross(forward) + down).length() < 1e-12, "right-handed");
        }
    }
}
