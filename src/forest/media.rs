//! The solids that a ray is inside of.

use crate::geometry::Interaction;

/// The solids that a ray is inside of, as lists that share their tails: a sample's branches leave
/// from common nodes. Of those with the highest priority the one entered last decides the index of
/// refraction. A solid made of others is one medium, that of the operand by which it was entered.
#[derive(Default)]
pub(super) struct Media {
    entries: Vec<Medium>,
    /// Per solid its priority; empty if all have the same.
    priorities: Vec<u32>,
    /// Scratch: what lies above an entry that is taken out.
    above: Vec<Medium>,
}

#[derive(Clone, Copy)]
struct Medium {
    below: u32,
    /// What was entered: the whole, of a solid made of others.
    body: u32,
    /// Whose index of refraction it has.
    solid: u32,
}

/// What a ray passes from and to at a surface.
#[derive(Clone, Copy)]
pub(super) struct Crossing {
    /// The solids that meet there, in front and behind; `None` is the air.
    solids: [Option<u32>; 2],
    /// The same, but for a thin surface what is in front and the surface itself: it mirrors like the
    /// material that it is of, and bends nothing.
    mirroring: [Option<u32>; 2],
    /// The list of solids in front of the surface.
    pub(super) front: u32,
    /// The list of solids behind the surface.
    pub(super) behind: u32,
    /// Whether the ray left a solid that it was not in, as far as is known.
    pub(super) lost: bool,
}

impl Crossing {
    /// Ratio of the indices of refraction in front of and behind the surface; `iors` has one per
    /// solid.
    #[inline(always)]
    pub(super) fn eta(&self, iors: &[f64]) -> f64 {
        ratio(self.solids, iors)
    }

    /// The same for Fresnel's reflectance.
    #[inline(always)]
    pub(super) fn contrast(&self, iors: &[f64]) -> f64 {
        ratio(self.mirroring, iors)
    }
}

#[inline(always)]
fn ratio(solids: [Option<u32>; 2], iors: &[f64]) -> f64 {
    let [front, behind] = solids.map(|solid| solid.map_or(1.0, |solid| iors[solid as usize]));
    front / behind
}

impl Media {
    /// The empty list.
    pub(super) const OUTSIDE: u32 = u32::MAX;

    /// For solids of these priorities; empty if all have the same.
    pub(super) fn new(priorities: &[u32]) -> Media {
        Media { priorities: priorities.to_vec(), ..Media::default() }
    }

    pub(super) fn clear(&mut self) {
        self.entries.clear();
    }

    /// The priority of a solid.
    pub(super) fn priority_of(&self, solid: u32) -> u32 {
        self.priorities.get(solid as usize).copied().unwrap_or(0)
    }

    /// The highest priority in a list, 0 if it is empty.
    pub(super) fn priority(&self, list: u32) -> u32 {
        self.top(list).map_or(0, |solid| self.priority_of(solid))
    }

    /// Whether a body is in a list.
    pub(super) fn has(&self, mut list: u32, body: u32) -> bool {
        while let Some(medium) = self.entries.get(list as usize) {
            if medium.body == body {
                return true;
            }
            list = medium.below;
        }
        false
    }

    /// The list with a solid entered.
    pub(super) fn with(&mut self, list: u32, at: &Interaction) -> u32 {
        self.entries.push(Medium { below: list, body: at.body, solid: at.solid });
        self.entries.len() as u32 - 1
    }

    /// The solid entered last, of those with the highest priority.
    #[inline(always)]
    fn top(&self, list: u32) -> Option<u32> {
        let first = self.entries.get(list as usize)?;
        if self.priorities.is_empty() { Some(first.solid) } else { self.highest(*first) }
    }

    #[cold]
    fn highest(&self, first: Medium) -> Option<u32> {
        let (mut best, mut at) = (first.solid, first.below);
        while let Some(medium) = self.entries.get(at as usize) {
            if self.priority_of(medium.solid) > self.priority_of(best) {
                best = medium.solid;
            }
            at = medium.below;
        }
        Some(best)
    }

    /// The list without the latest entry of `body`; the same list if it is not in it.
    pub(super) fn without(&mut self, list: u32, body: u32) -> u32 {
        self.above.clear();
        let mut at = list;
        while let Some(&medium) = self.entries.get(at as usize) {
            if medium.body == body {
                let mut rebuilt = medium.below;
                while let Some(above) = self.above.pop() {
                    self.entries.push(Medium { below: rebuilt, ..above });
                    rebuilt = self.entries.len() as u32 - 1;
                }
                return rebuilt;
            }
            self.above.push(medium);
            at = medium.below;
        }
        list
    }

    /// Crosses a surface, coming from `front`, a list of solids.
    #[inline(always)]
    pub(super) fn cross(&mut self, front: u32, at: &Interaction, entering: bool) -> Crossing {
        let behind = match entering {
            _ if at.thin => front,
            true => self.with(front, at),
            false => self.without(front, at.body),
        };
        self.between([front, behind], at, entering)
    }

    /// Crosses a surface between two lists of solids.
    #[inline(always)]
    pub(super) fn between(
        &self,
        [front, behind]: [u32; 2],
        at: &Interaction,
        entering: bool,
    ) -> Crossing {
        let own = Some(at.solid);
        if at.thin {
            // Nothing is refracted: whatever is in front is behind, too.
            let mirroring = [self.top(front), own];
            return Crossing { solids: [None, None], mirroring, front, behind, lost: false };
        }
        // A ray that leaves a solid which it never entered started inside it.
        let lost = !entering && !self.has(front, at.body);
        let solids = [if lost { own } else { self.top(front) }, self.top(behind)];
        Crossing { solids, mirroring: solids, front, behind, lost }
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;

    fn at(body: u32, solid: u32) -> Interaction {
        Interaction {
            point: DVec3::ZERO,
            rest: DVec3::ZERO,
            geometric_normal: DVec3::Z,
            shading_normal: DVec3::Z,
            solid,
            body,
            material: 0,
            slot: 0,
            bumped: false,
            thin: false,
            primitive: 0,
        }
    }

    #[test]
    fn the_highest_priority_decides_and_of_equals_the_last() {
        let mut media = Media::new(&[0, 2, 1, 2]);
        let mut list = Media::OUTSIDE;
        for (solid, top) in [(0, 0), (1, 1), (2, 1), (3, 3)] {
            list = media.with(list, &at(solid, solid));
            assert_eq!(media.top(list), Some(top));
        }
        assert_eq!(media.priority(list), 2);
        for (body, top) in [(3, Some(1)), (1, Some(2)), (0, Some(2)), (2, None)] {
            list = media.without(list, body);
            assert_eq!(media.top(list), top);
        }
        assert_eq!(list, Media::OUTSIDE);
        let mut plain = Media::default();
        let first = plain.with(Media::OUTSIDE, &at(4, 4));
        let second = plain.with(first, &at(2, 2));
        assert_eq!((plain.top(second), plain.top(first)), (Some(2), Some(4)));
    }

    #[test]
    fn a_body_is_one_medium_whatever_operand_it_is_left_by() {
        let mut media = Media::default();
        let within = media.cross(Media::OUTSIDE, &at(9, 4), true);
        assert_eq!(within.eta(&[1.0, 1.0, 1.0, 1.0, 1.5, 3.0]), 1.0 / 1.5);
        let out = media.cross(within.behind, &at(9, 5), false);
        assert_eq!((out.behind, out.lost), (Media::OUTSIDE, false));
        assert_eq!(out.eta(&[1.0, 1.0, 1.0, 1.0, 1.5, 3.0]), 1.5);
        let lost = media.cross(Media::OUTSIDE, &at(9, 5), false);
        assert!(lost.lost && lost.eta(&[1.0, 1.0, 1.0, 1.0, 1.5, 3.0]) == 3.0);
    }

    #[test]
    fn more_solids_than_branches() {
        let mut media = Media::default();
        let list = (0..1000).fold(Media::OUTSIDE, |list, i| media.with(list, &at(i, i)));
        let list = (0..1000).fold(list, |list, i| media.without(list, i));
        assert_eq!(list, Media::OUTSIDE);
    }
}
