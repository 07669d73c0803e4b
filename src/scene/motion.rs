//! What of a scene is seen through a lens that is open, and while something moves.

use glam::DVec3;

use super::{Camera, Lens, Placement, Scene, Shape, Solid};

/// `motion` of a solid: what its `translate` and `rotate_degrees` gain, evenly, from the beginning of
/// the motion (time 0) to its end (time 1). Lights and planes stand still.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Motion {
    /// World units.
    pub translate: DVec3,
    /// Added to the angles about x, then y, then z.
    pub rotate_degrees: DVec3,
}

impl Motion {
    /// Whether it leads nowhere.
    pub fn is_none(&self) -> bool {
        let Motion { translate, rotate_degrees } = self;
        *translate == DVec3::ZERO && *rotate_degrees == DVec3::ZERO
    }
}

impl Placement {
    /// The placement at a time of a motion that begins here.
    pub fn at(&self, motion: &Motion, time: f64) -> Placement {
        let Placement { translate, rotate_degrees, scale } = self;
        Placement {
            translate: *translate + motion.translate * time,
            rotate_degrees: *rotate_degrees + motion.rotate_degrees * time,
            scale: *scale,
        }
    }
}

impl Solid {
    /// Whether it stands elsewhere later.
    pub fn moves(&self) -> bool {
        !self.motion.is_none() && !matches!(self.shape, Shape::Plane { .. })
    }
}

/// A lens that is no pinhole.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Opening {
    /// Of the lens, world units, > 0.
    pub radius: f64,
    /// Distance of the plane in focus along the view, world units, > 0.
    pub focus: f64,
}

impl Camera {
    /// Its lens, unless it is a pinhole or a parallel view.
    pub fn opening(&self) -> Option<Opening> {
        let Camera { eye, target, up: _, lens, aperture, focus, shutter: _ } = self;
        let perspective = matches!(lens, Lens::Perspective { .. });
        let focus = if *focus > 0.0 { *focus } else { eye.distance(*target) };
        (perspective && *aperture > 0.0).then_some(Opening { radius: aperture / 2.0, focus })
    }
}

impl Scene {
    /// The time at which the shutter closes, > 0, if anything moves until then; it opens at 0.
    pub fn shutter_time(&self) -> Option<f64> {
        let open = self.camera.shutter;
        (open > 0.0 && self.solids.iter().any(Solid::moves)).then_some(open)
    }
}
