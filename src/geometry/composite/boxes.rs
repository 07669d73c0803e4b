//! Boxes of a gate's children, eight side by side: what a line surely misses is left out.

use fearless_simd::{Level, Simd, dispatch, f64x8, prelude::*};
use glam::DVec3;

use super::walk::Clip;
use crate::geometry::Ray;

/// Children whose boxes are tested together.
pub(super) const WIDTH: usize = 8;

/// Direction components are kept at least this far from zero: over the lengths that f64 tells from
/// infinity, the change is far below the boxes' padding.
const LEAST_COMPONENT: f64 = 1e-200;

/// Eight boxes in world space, infinite where what is in them has no end.
///
/// # Invariants
/// Unused places, and boxes of what is nowhere, are lo = +∞, hi = −∞, which no line meets, because
/// planes are chosen by the direction's sign and never sorted.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub(super) struct Boxes {
    /// By axis, then lowest and highest.
    bounds: [[[f64; WIDTH]; 2]; 3],
    /// A bit for every place that the line must not miss: else the gate never changes.
    vital: u32,
}

/// A line, for tests against boxes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Line {
    level: Level,
    reciprocal: [f64; 3],
    /// The origin, moved by the padding so that the nearer plane is nearer, and the farther farther.
    origin: [[f64; 3]; 2],
    /// Per axis: which plane of a box is the nearer one.
    nearer: [usize; 3],
}

/// Which of eight boxes a line meets, and where it is in each.
#[derive(Clone, Copy, Debug)]
pub(super) struct Within {
    /// A bit for every box met.
    pub(super) met: u32,
    from: [f64; WIDTH],
    to: [f64; WIDTH],
}

impl Line {
    /// The line of a ray; boxes are larger by `padding`, in world units.
    pub(super) fn new(level: Level, ray: &Ray, padding: f64) -> Line {
        let (o, d) = (ray.origin.to_array(), ray.direction.to_array());
        let away = d.map(|d| d.abs().max(LEAST_COMPONENT).copysign(d));
        let pads = d.map(|d| padding.copysign(d));
        let near = [o[0] + pads[0], o[1] + pads[1], o[2] + pads[2]];
        let far = [o[0] - pads[0], o[1] - pads[1], o[2] - pads[2]];
        let nearer = d.map(|d| usize::from(d.is_sign_negative()));
        Line { level, reciprocal: away.map(f64::recip), origin: [near, far], nearer }
    }
}

impl Boxes {
    /// Boxes around some things, eight at a time, of which some are vital.
    pub(super) fn around(things: &[([DVec3; 2], bool)]) -> Vec<Boxes> {
        things.chunks(WIDTH).map(Boxes::of).collect()
    }

    fn of(things: &[([DVec3; 2], bool)]) -> Boxes {
        let nowhere = [[f64::INFINITY; WIDTH], [f64::NEG_INFINITY; WIDTH]];
        let mut boxes = Boxes { bounds: [nowhere; 3], vital: 0 };
        for (lane, (ends, vital)) in things.iter().enumerate() {
            boxes.vital |= u32::from(*vital) << lane;
            for (axis, lanes) in boxes.bounds.iter_mut().enumerate() {
                for (end, lanes) in lanes.iter_mut().enumerate() {
                    lanes[lane] = ends[end][axis];
                }
            }
        }
        boxes
    }

    /// Where a line is in each; `None` if it misses a vital one within `clip`.
    pub(super) fn meet(&self, line: &Line, clip: Clip) -> Option<Within> {
        let within = dispatch!(line.level, simd => self.meet_by(simd, line, clip));
        (self.vital & !within.met == 0).then_some(within)
    }

    #[inline(always)]
    fn meet_by<S: Simd>(&self, simd: S, line: &Line, clip: Clip) -> Within {
        let Line { level: _, reciprocal, origin: [near, far], nearer } = line;
        let mut from = f64x8::splat(simd, clip.from);
        let mut to = f64x8::splat(simd, clip.to);
        for axis in 0..3 {
            let planes = &self.bounds[axis];
            let (first, last) = (&planes[nearer[axis] & 1], &planes[!nearer[axis] & 1]);
            let reciprocal = f64x8::splat(simd, reciprocal[axis]);
            let first = f64x8::from_slice(simd, first) - f64x8::splat(simd, near[axis]);
            let last = f64x8::from_slice(simd, last) - f64x8::splat(simd, far[axis]);
            from = from.max(first * reciprocal);
            to = to.min(last * reciprocal);
        }
        let met = from.simd_le(to).to_bitmask() as u32;
        Within { met, from: from.into(), to: to.into() }
    }
}

impl Within {
    /// Whether a box that is met is met within `clip`.
    #[inline(always)]
    pub(super) fn is_within(&self, lane: usize, clip: Clip) -> bool {
        let lane = lane & (WIDTH - 1);
        self.from[lane] <= clip.to && self.to[lane] >= clip.from
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: Clip = Clip { from: f64::NEG_INFINITY, to: f64::INFINITY };

    /// The part of a line that is in a box, if any, by the box's place among eight.
    fn part(bounds: [DVec3; 2], origin: DVec3, direction: DVec3, padding: f64) -> Option<[f64; 2]> {
        let nowhere = [DVec3::INFINITY, DVec3::NEG_INFINITY];
        let things = [nowhere, [DVec3::ZERO, DVec3::ONE], bounds].map(|bounds| (bounds, false));
        let line = Line::new(Level::new(), &Ray { origin, direction }, padding);
        let within = Boxes::around(&things)[0].meet(&line, ALL).expect("nothing is vital");
        assert_eq!(within.met & 0b1111_1001, 0, "an empty box is met by {direction}");
        (within.met & 0b100 != 0).then_some([within.from[2], within.to[2]])
    }

    #[test]
    fn a_line_is_in_a_box_from_its_nearer_planes_to_its_farther() {
        let bounds = [DVec3::new(1.0, -1.0, -1.0), DVec3::new(3.0, 1.0, 1.0)];
        for zero in [0.0, -0.0, 1e-300] {
            let along = DVec3::new(1.0, zero, -zero);
            assert_eq!(part(bounds, DVec3::ZERO, along, 0.0), Some([1.0, 3.0]));
            assert_eq!(part(bounds, DVec3::ZERO, -along, 0.5), Some([-3.5, -0.5]));
            assert_eq!(part(bounds, DVec3::new(0.0, 1.5, 0.0), along, 0.0), None);
        }
    }

    #[test]
    fn a_box_without_end_is_met_by_every_line() {
        let bounds = [DVec3::NEG_INFINITY, DVec3::INFINITY.with_z(2.0)];
        for direction in [DVec3::X, -DVec3::Z, DVec3::new(0.6, 0.0, 0.8)] {
            assert!(part(bounds, DVec3::ZERO, direction, 0.0).is_some(), "{direction}");
        }
    }

    #[test]
    fn a_vital_box_is_missed_by_lines_that_meet_it_elsewhere() {
        let box_at = |x: f64| [DVec3::new(x, -1.0, -1.0), DVec3::new(x + 1.0, 1.0, 1.0)];
        let boxes = &Boxes::around(&[(box_at(0.0), false), (box_at(5.0), true)])[0];
        let ray = Ray { origin: DVec3::ZERO, direction: DVec3::X };
        let line = Line::new(Level::new(), &ray, 0.0);
        let meet = |from, to| boxes.meet(&line, Clip { from, to });
        assert!(meet(2.0, 4.0).is_none());
        let within = meet(-1.0, 5.5).expect("it is met");
        assert_eq!(within.met, 0b11);
        assert!(within.is_within(1, Clip { from: 5.0, to: 5.0 }));
        assert!(!within.is_within(0, Clip { from: 2.0, to: 9.0 }));
    }
}
