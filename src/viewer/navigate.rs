//! Moves a camera by the pointer: orbit, pan, dolly.

use glam::{DQuat, DVec3};

use crate::scene::{Camera, Lens};
use crate::session::live::Picked;

/// Smallest angle between the view and the camera's `up`, in radians.
const STEEPEST: f64 = 0.02;

/// Turns the eye around the target: `across` radians about `up`, then `over` radians towards `up`,
/// stopping short of the poles.
pub(super) fn orbit(camera: &mut Camera, across: f64, over: f64) {
    let Camera { eye, target, up, .. } = camera;
    let arm = *eye - *target;
    let axis = up.normalize();
    let angle = arm.angle_between(axis);
    let wanted = (angle - over).clamp(STEEPEST, std::f64::consts::PI - STEEPEST);
    let side = axis.cross(arm).normalize();
    let tilt = DQuat::from_axis_angle(side, wanted - angle);
    let turn = DQuat::from_axis_angle(axis, -across);
    *eye = *target + turn * (tilt * arm);
}

/// Moves eye and target in the picture plane, so that the target follows a pointer that moves by
/// (`right`, `down`) in units of the picture's height.
pub(super) fn pan(camera: &mut Camera, right: f64, down: f64) {
    let height = match camera.lens {
        Lens::Perspective { fov_degrees } => {
            2.0 * (fov_degrees.to_radians() / 2.0).tan() * camera.eye.distance(camera.target)
        }
        Lens::Parallel { height } => height,
    };
    let forward = (camera.target - camera.eye).normalize();
    let across = forward.cross(camera.up).normalize();
    let above = across.cross(forward);
    let step: DVec3 = (above * down - across * right) * height;
    camera.eye += step;
    camera.target += step;
}

/// Moves the eye to `factor` times its distance from the target; a parallel view shows as much more.
pub(super) fn dolly(camera: &mut Camera, factor: f64) {
    match &mut camera.lens {
        Lens::Perspective { .. } => {
            camera.eye = camera.target + (camera.eye - camera.target) * factor;
        }
        Lens::Parallel { height } => *height *= factor,
    }
}

/// The focus of a camera on what was picked, in few decimal digits: it will stand in the scene file.
/// After an error, why there is none.
pub(super) fn focused(camera: &Camera, picked: Option<Picked>) -> Result<f64, String> {
    if matches!(camera.lens, Lens::Parallel { .. }) {
        return Err("a parallel view has no lens to focus".into());
    }
    let Some(Picked { solid: _, material: _, depth }) = picked else {
        return Err("there is nothing to focus on: click on a solid".into());
    };
    Ok(format!("{depth:.4e}").parse().unwrap_or(depth))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_focus_is_where_something_is() {
        let picked = Some(Picked { solid: 0, material: 0, depth: 7.123_456_789 });
        assert_eq!(focused(&camera(), picked), Ok(7.1235));
        assert!(focused(&camera(), None).is_err());
        let parallel = Camera { lens: Lens::Parallel { height: 3.0 }, ..camera() };
        assert!(focused(&parallel, picked).is_err());
    }

    fn camera() -> Camera {
        Camera {
            eye: DVec3::new(0.0, -4.0, 0.0),
            target: DVec3::ZERO,
            up: DVec3::Z,
            lens: Lens::Perspective { fov_degrees: 90.0 },
            ..Camera::default()
        }
    }

    fn near(a: DVec3, b: DVec3) -> bool {
        a.distance(b) < 1e-12
    }

    #[test]
    fn an_orbit_keeps_the_distance_and_never_reaches_the_pole() {
        let mut c = camera();
        orbit(&mut c, std::f64::consts::FRAC_PI_2, 0.0);
        assert!(near(c.eye, DVec3::new(-4.0, 0.0, 0.0)), "{}", c.eye);
        orbit(&mut c, 0.0, 0.5);
        assert!(c.eye.z > 0.0 && (c.eye.length() - 4.0).abs() < 1e-12);
        for _ in 0..100 {
            orbit(&mut c, 0.3, 1.0);
        }
        let angle = c.eye.angle_between(DVec3::Z);
        assert!((angle - STEEPEST).abs() < 1e-9, "{angle}");
        for _ in 0..100 {
            orbit(&mut c, 0.3, -1.0);
        }
        assert!(c.eye.z < 0.0 && c.eye.angle_between(DVec3::Z) < std::f64::consts::PI - 0.01);
    }

    #[test]
    fn a_pan_moves_what_lies_at_the_target_with_the_pointer() {
        let mut c = camera();
        pan(&mut c, 0.25, 0.5);
        // At the target the picture is 2·tan(45°)·4 = 8 high.
        assert!(near(c.target, DVec3::new(-2.0, 0.0, 4.0)), "{}", c.target);
        assert!(near(c.eye - c.target, DVec3::new(0.0, -4.0, 0.0)));
    }

    #[test]
    fn a_dolly_scales_the_distance_or_the_parallel_height() {
        let mut c = camera();
        dolly(&mut c, 0.5);
        assert!(near(c.eye, DVec3::new(0.0, -2.0, 0.0)));
        let mut parallel = Camera { lens: Lens::Parallel { height: 3.0 }, ..camera() };
        dolly(&mut parallel, 2.0);
        assert!(near(parallel.eye, camera().eye));
        assert_eq!(parallel.lens, Lens::Parallel { height: 6.0 });
    }
}
