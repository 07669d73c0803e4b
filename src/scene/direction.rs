//! Directions: vectors whose length does not matter.

use glam::DVec3;

/// A vector whose components are all below this counts as zero: its square would vanish.
pub(super) const TINY: f64 = 1e-100;

/// `v` in length one; `None` if it is zero (every component below 1e-100) or not finite.
pub(super) fn unit(v: DVec3) -> Option<DVec3> {
    let largest = v.abs().max_element();
    (v.is_finite() && largest >= TINY).then(|| (v / largest).normalize())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unit_survives_the_extremes() {
        assert_eq!(unit(DVec3::new(0.0, 3e-99, 0.0)), Some(DVec3::Y));
        assert_eq!(unit(DVec3::new(0.0, 0.0, -1e300)), Some(DVec3::NEG_Z));
        assert_eq!(unit(DVec3::ZERO), None);
        assert_eq!(unit(DVec3::new(f64::NAN, 1.0, 0.0)), None);
    }
}
