//! Sums of samples whose weights may have signs: what they cancel is told from what none has met.
//!
//! Such sums begin at −0, which no sum of anything is. Stored is 0 where a term does not occur, and −0
//! where it does and its samples cancel each other: to a pixel's sum, which begins at 0, neither adds
//! anything.

use super::transport::Plane;
use crate::film::layout::LANES;

/// Bits of −0.
const NO_SUM: u32 = 1 << 31;

/// A plane to be added to.
#[inline(always)]
pub(super) fn empty(signed: bool) -> Plane {
    if signed { Plane([-0.0; LANES]) } else { Plane::default() }
}

/// Adds to `masks` the lanes of all planes that it has none of.
pub(super) fn note_lanes(planes: &[Plane], signed: bool, masks: &mut Vec<u16>) {
    let new = &planes[masks.len()..];
    match signed {
        true => masks.extend(new.iter().map(|plane| lanes(plane, true))),
        false => masks.extend(new.iter().map(|plane| lanes(plane, false))),
    }
}

/// The lanes of sums in which there is anything: without signs, a sum of positive numbers.
#[inline(always)]
fn lanes(plane: &Plane, signed: bool) -> u16 {
    let lanes = plane.0.iter().enumerate();
    match signed {
        false => lanes.fold(0, |mask, (i, &c)| mask | u16::from(c != 0.0) << i),
        true => lanes.fold(0, |mask, (i, &c)| mask | u16::from(c.to_bits() != NO_SUM) << i),
    }
}

/// Sums as they are stored.
#[inline(always)]
pub(super) fn settled(sums: Plane, signed: bool) -> Plane {
    let settle = |sum: f32| match sum.to_bits() {
        NO_SUM => 0.0,
        0 => -0.0,
        _ => sum,
    };
    if signed { Plane(sums.0.map(settle)) } else { sums }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_cancels_is_there_and_what_was_never_added_is_not() {
        let mut plane = empty(true);
        plane.0[3] += 1.25;
        plane.0[5] += 0.7;
        plane.0[5] -= 0.7;
        assert_eq!(lanes(&plane, true), 1 << 3 | 1 << 5);
        assert_eq!(lanes(&plane, false), 1 << 3, "not seen by its value");
        let Plane(stored) = settled(plane, true);
        let bits = stored.map(f32::to_bits);
        assert_eq!([bits[3], bits[5], bits[6]], [1.25f32.to_bits(), 1 << 31, 0]);
        assert_eq!((0.0f32 + stored[5] * 0.3).to_bits(), 0, "it adds nothing");
        assert_eq!(settled(empty(false), false), Plane::default());
    }
}
