//! A surface as a ray meets it: which way it faces, and where its mirror and refracted rays go.

use glam::DVec3;

use super::lobe;
use crate::geometry::Interaction;

/// A surface as seen by the ray that met it: both normals on the ray's side.
pub(super) struct Surface {
    pub(super) normal: DVec3,
    pub(super) geometric: DVec3,
    /// Unit vector back along the ray.
    pub(super) to_eye: DVec3,
    /// Whether the ray comes from outside.
    pub(super) entering: bool,
    /// Ratio of the indices in front and behind, for Fresnel's reflectance, once it is known.
    pub(super) contrast: f64,
    /// Direction of the refracted ray, once it is known.
    pub(super) refracted: Option<DVec3>,
}

impl Surface {
    #[inline(always)]
    pub(super) fn new(at: &Interaction, direction: DVec3) -> Surface {
        let to_eye = -direction;
        let entering = at.geometric_normal.dot(to_eye) >= 0.0;
        let side = if entering { 1.0 } else { -1.0 };
        let geometric = at.geometric_normal * side;
        let smooth = at.shading_normal * side;
        let normal = if smooth.dot(to_eye) > 0.0 { smooth } else { geometric };
        Surface { normal, geometric, to_eye, entering, contrast: 1.0, refracted: None }
    }

    /// Fresnel's reflectance of the ray that met it.
    #[inline(always)]
    pub(super) fn reflectance(&self) -> f64 {
        match self.refracted {
            Some(_) => lobe::fresnel(self.normal.dot(self.to_eye).min(1.0), self.contrast),
            None => 1.0,
        }
    }

    /// Direction of the mirror ray, always above the geometric surface.
    #[inline(always)]
    pub(super) fn reflect(&self) -> DVec3 {
        let about = |n: DVec3| n * (2.0 * n.dot(self.to_eye)) - self.to_eye;
        let mirrored = about(self.normal);
        let above = mirrored.dot(self.geometric) > 0.0;
        if above { mirrored } else { about(self.geometric) }.normalize()
    }

    /// Direction of the refracted ray for `eta` = index in front / index behind, always below the
    /// geometric surface; `None` in total reflection. Snell's law in vector form (Heckbert 1989).
    #[inline(always)]
    pub(super) fn refract(&self, eta: f64) -> Option<DVec3> {
        let through = |n: DVec3| {
            let c = n.dot(self.to_eye);
            let radicand = 1.0 - eta * eta * (1.0 - c * c);
            (radicand >= 0.0).then(|| n * (eta * c - radicand.sqrt()) - self.to_eye * eta)
        };
        if eta == 1.0 {
            return Some(-self.to_eye);
        }
        let bent = through(self.normal)?;
        let below = bent.dot(self.geometric) < 0.0;
        if below { Some(bent.normalize()) } else { through(self.geometric).map(DVec3::normalize) }
    }
}
