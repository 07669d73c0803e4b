//! A surface as a ray meets it: which way it faces, and where its mirror and refracted rays go.

use glam::DVec3;

use super::lobe;
use crate::geometry::Interaction;

/// Sine of the least angle between the surface and a ray that goes on from a bump, where the ray that
/// arrives is steeper (as Cycles' `ensure_valid_specular_reflection`).
const LEAST_RISE: f64 = 0.01;

/// A surface as seen by the ray that met it: both normals on the ray's side.
pub(super) struct Surface {
    pub(super) normal: DVec3,
    pub(super) geometric: DVec3,
    /// Unit vector back along the ray.
    pub(super) to_eye: DVec3,
    /// Whether the ray comes from outside.
    pub(super) entering: bool,
    /// Whether a bump bent the normal.
    bumped: bool,
    /// Ratio of the indices in front and behind, for Fresnel's reflectance, once it is known.
    pub(super) contrast: f64,
    /// Once the media are known.
    refraction: Refraction,
}

/// What becomes of the refracted ray.
#[derive(Clone, Copy)]
enum Refraction {
    /// It goes into a denser medium, for this index in front / index behind: nothing stops it. Its
    /// direction is worked out if it is asked for: most surfaces let nothing pass.
    Denser(f64),
    /// It goes there.
    Through(DVec3),
    /// Total reflection: there is none.
    Total,
}

impl Surface {
    #[inline(always)]
    pub(super) fn new(at: &Interaction, direction: DVec3) -> Surface {
        let to_eye = -direction;
        let entering = at.geometric_normal.dot(to_eye) >= 0.0;
        let side = if entering { 1.0 } else { -1.0 };
        let geometric = at.geometric_normal * side;
        let smooth = at.shading_normal * side;
        let facing = smooth.dot(to_eye);
        let normal = match at.bumped {
            _ if facing > 0.0 => smooth,
            false => geometric,
            // Flattened to the horizon as the eye sees it.
            true => (smooth - to_eye * facing).try_normalize().unwrap_or(geometric),
        };
        let (contrast, refraction, bumped) = (1.0, Refraction::Total, at.bumped);
        Surface { normal, geometric, to_eye, entering, bumped, contrast, refraction }
    }

    /// Says what is in front and behind: ratios of the indices of refraction, for Snell's law and for
    /// Fresnel's.
    #[inline(always)]
    pub(super) fn between(&mut self, eta: f64, contrast: f64) {
        self.contrast = contrast;
        self.refraction = match eta < 1.0 {
            true => Refraction::Denser(eta),
            false => self.refract(eta).map_or(Refraction::Total, Refraction::Through),
        };
    }

    /// Whether there is no refracted ray.
    #[inline(always)]
    pub(super) fn is_total(&self) -> bool {
        matches!(self.refraction, Refraction::Total)
    }

    /// Direction of the refracted ray, if there is one.
    #[inline(always)]
    pub(super) fn refracted(&self) -> Option<DVec3> {
        match self.refraction {
            Refraction::Denser(eta) => self.refract(eta),
            Refraction::Through(direction) => Some(direction),
            Refraction::Total => None,
        }
    }

    /// The least way out of the surface of a ray that goes on from a bump: flatter ones than the ray
    /// that arrives are not lifted as high.
    #[inline(always)]
    fn least_rise(&self) -> f64 {
        LEAST_RISE.min(0.9 * self.geometric.dot(self.to_eye).max(0.0))
    }

    /// Fresnel's reflectance of the ray that met it.
    #[inline(always)]
    pub(super) fn reflectance(&self) -> f64 {
        match self.is_total() {
            false => lobe::fresnel(self.normal.dot(self.to_eye).min(1.0), self.contrast),
            true => 1.0,
        }
    }

    /// What of a light in front shows where the shading normal is another than the geometric one: 1,
    /// falling to 0 where the light sinks behind the surface, so that the facets of a smooth mesh do
    /// not end in steps (Chiang, Li, Burley, "Taming the Shadow Terminator", SIGGRAPH Talks 2019).
    #[inline(always)]
    pub(super) fn softening(&self, to_light: DVec3) -> f64 {
        if self.normal == self.geometric {
            return 1.0;
        }
        let bent = self.normal.dot(to_light) * self.normal.dot(self.geometric);
        let part = self.geometric.dot(to_light) / bent;
        if bent > 0.0 && part < 1.0 { part * (1.0 + part - part * part) } else { 1.0 }
    }

    /// Direction of the mirror ray, always above the geometric surface.
    #[inline(always)]
    pub(super) fn reflect(&self) -> DVec3 {
        let about = |n: DVec3| n * (2.0 * n.dot(self.to_eye)) - self.to_eye;
        let mirrored = about(self.normal);
        if self.bumped {
            // Lifted as if the normal, half way between it and the eye, were turned back.
            let lack = self.least_rise() - mirrored.dot(self.geometric);
            return (mirrored + self.geometric * lack.max(0.0)).normalize();
        }
        let above = mirrored.dot(self.geometric) > 0.0;
        if above { mirrored } else { about(self.geometric) }.normalize()
    }

    /// Direction of the refracted ray for `eta` = index in front / index behind, always below the
    /// geometric surface; `None` in total reflection. Snell's law in vector form (Heckbert 1989).
    #[inline(always)]
    fn refract(&self, eta: f64) -> Option<DVec3> {
        let through = |n: DVec3| {
            let c = n.dot(self.to_eye);
            let radicand = 1.0 - eta * eta * (1.0 - c * c);
            (radicand >= 0.0).then(|| n * (eta * c - radicand.sqrt()) - self.to_eye * eta)
        };
        if eta == 1.0 {
            return Some(-self.to_eye);
        }
        let bent = through(self.normal)?;
        if self.bumped {
            let lack = self.least_rise() + bent.dot(self.geometric);
            return Some((bent - self.geometric * lack.max(0.0)).normalize());
        }
        let below = bent.dot(self.geometric) < 0.0;
        if below { Some(bent.normalize()) } else { through(self.geometric).map(DVec3::normalize) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn light_fades_before_it_sinks_behind_a_facet() {
        let degrees = |angle: f64| {
            let (sin, cos) = angle.to_radians().sin_cos();
            DVec3::new(sin, 0.0, cos)
        };
        let smooth = met(degrees(20.0), DVec3::Z, false);
        let shown = |angle: f64| smooth.softening(degrees(angle));
        // The facet's horizon is at 90°, where the smooth surface still faces the light.
        assert_eq!([shown(0.0), shown(-60.0)], [1.0; 2]);
        let sweep: Vec<f64> = (10..=90).map(|angle| shown(f64::from(angle))).collect();
        assert!(sweep.is_sorted_by(|a, b| a >= b) && sweep[0] == 1.0, "{sweep:?}");
        assert!(shown(89.999) < 1e-4 && shown(85.0) < 0.5, "{sweep:?}");
        assert_eq!(met(DVec3::Z, DVec3::Z, false).softening(degrees(89.999)), 1.0);
    }

    /// Directions over the upper half, `tilt` from z in equal steps down to the horizon.
    fn above() -> impl Iterator<Item = DVec3> {
        (0..60).flat_map(|i| {
            let tilt = (f64::from(i) + 0.5) / 60.0 * std::f64::consts::FRAC_PI_2;
            (0..24).map(move |k| {
                let turn = f64::from(k) * 15f64.to_radians();
                DVec3::new(tilt.sin() * turn.cos(), tilt.sin() * turn.sin(), tilt.cos())
            })
        })
    }

    fn met(normal: DVec3, to_eye: DVec3, bumped: bool) -> Surface {
        let at = Interaction {
            point: DVec3::ZERO,
            rest: DVec3::ZERO,
            geometric_normal: DVec3::Z,
            shading_normal: normal,
            solid: 0,
            body: 0,
            material: 0,
            slot: 0,
            bumped,
            thin: false,
            primitive: 0,
        };
        Surface::new(&at, -to_eye)
    }

    #[test]
    fn into_what_is_denser_every_ray_goes() {
        for (to_eye, bumped) in above().flat_map(|v| [(v, false), (v, true), (-v, true)]) {
            for eta in [0.0, 1.0 / 2.42, 1.0 / 1.5, 1.0f64.next_down()] {
                let mut surface = met(DVec3::new(0.6, 0.0, 0.8), to_eye, bumped);
                surface.between(eta, eta);
                assert!(!surface.is_total() && surface.refracted().is_some(), "{to_eye} {eta}");
                assert_eq!(surface.refracted(), surface.refract(eta));
            }
        }
        let mut flat = met(DVec3::Z, DVec3::new(0.8, 0.0, 0.6), false);
        flat.between(1.5, 1.5);
        assert!(flat.is_total() && flat.refracted().is_none());
    }

    #[test]
    fn no_ray_from_a_bump_goes_below_what_it_left() {
        let (mut lifted, mut flattened, mut pressed) = (0, 0, 0);
        for to_eye in above().chain(above().map(|v| -v)) {
            let side = to_eye.z.signum();
            for degrees in [5.0f64, 20.0, 60.0] {
                let (sine, cosine) = degrees.to_radians().sin_cos();
                for normal in [DVec3::X, DVec3::Y, -DVec3::X].map(|b| b * sine + DVec3::Z * cosine)
                {
                    let surface = met(normal, to_eye, true);
                    assert!(surface.normal.dot(to_eye) > -1e-15, "the normal faces the eye");
                    flattened += usize::from((surface.normal - normal * side).length() > 1e-9);
                    let mirrored = surface.reflect();
                    let rise = mirrored.z * side;
                    assert!(rise > 0.0, "{to_eye} about {normal}: {mirrored}");
                    let about = surface.normal * (2.0 * surface.normal.dot(to_eye)) - to_eye;
                    lifted += usize::from(about.z * side <= 0.0);
                    for eta in [1.0 / 1.5, 1.5, 1.0] {
                        let Some(through) = surface.refract(eta) else { continue };
                        assert!(through.z * side < 0.0, "{to_eye} through {normal}: {through}");
                        assert!((through.length() - 1.0).abs() < 1e-12);
                        pressed += usize::from(through.z.abs() < 0.0101);
                    }
                }
            }
        }
        assert!(lifted > 500 && flattened > 500 && pressed > 50, "{lifted} {flattened} {pressed}");
    }

    #[test]
    fn glass_refracted_directions_are_of_length_one_and_lead_back() {
        let mut bent = 0;
        for to_eye in above() {
            for n in [1.0001, 1.33, 1.5, 2.42] {
                for eta in [1.0 / n, n] {
                    let Some(through) = met(DVec3::Z, to_eye, false).refract(eta) else { continue };
                    assert!((through.length() - 1.0).abs() <= 4.0 * f64::EPSILON, "{through}");
                    // From below, the way it went.
                    let back = met(DVec3::Z, through, false).refract(1.0 / eta);
                    let Some(back) = back else { panic!("{to_eye} by {eta}: no way back") };
                    let off = (back - to_eye).length();
                    let bound = 1e-14 / to_eye.z.min(-through.z);
                    assert!(off <= bound, "{to_eye} by {eta}: off by {off:e} of {bound:e}");
                    bent += 1;
                }
            }
        }
        assert!(bent > 8000, "{bent}");
    }

    #[test]
    fn a_bump_that_bends_little_changes_little() {
        for to_eye in above() {
            let tilted = DVec3::new(1e-9, 0.0, 1.0).normalize();
            let (even, bumped) = (met(DVec3::Z, to_eye, false), met(tilted, to_eye, true));
            assert!((even.reflect() - bumped.reflect()).length() < 1e-8);
            for eta in [1.0 / 1.5, 1.0] {
                let [a, b] = [&even, &bumped].map(|s| s.refract(eta).unwrap());
                assert!((a - b).length() < 1e-8, "{to_eye}: {a} {b}");
            }
        }
    }

    #[test]
    fn where_nothing_goes_below_the_bump_reflects_as_a_mirror() {
        let normal = DVec3::new(0.1, 0.0, 1.0).normalize();
        let to_eye = DVec3::new(0.3, 0.2, 0.9).normalize();
        let [bumped, smooth] = [true, false].map(|bumped| met(normal, to_eye, bumped).reflect());
        assert_eq!(bumped, smooth);
    }
}
