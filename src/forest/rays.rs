//! How many rays were cast.

use std::ops::AddAssign;

use super::sink::Side;

/// Rays cast, by kind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RayCounts {
    /// From the eye.
    pub camera: u64,
    /// Mirror rays, total reflection included.
    pub reflected: u64,
    /// Refracted rays.
    pub transmitted: u64,
    /// Towards lights.
    pub shadow: u64,
    /// Of none of these kinds: how often one left a solid that it was not in, as far as is known.
    pub lost: u64,
}

impl RayCounts {
    /// Counts a ray of the seen path: from the eye, or of a node's branch.
    #[inline(always)]
    pub(super) fn count(&mut self, branch: Option<Side>) {
        match branch {
            None => self.camera += 1,
            Some(Side::Reflected) => self.reflected += 1,
            Some(Side::Transmitted) => self.transmitted += 1,
        }
    }

    /// Rays of every kind.
    pub fn total(self) -> u64 {
        self.camera + self.reflected + self.transmitted + self.shadow
    }
}

impl AddAssign for RayCounts {
    fn add_assign(&mut self, o: RayCounts) {
        let RayCounts { camera, reflected, transmitted, shadow, lost } = o;
        self.camera += camera;
        self.reflected += reflected;
        self.transmitted += transmitted;
        self.shadow += shadow;
        self.lost += lost;
    }
}
