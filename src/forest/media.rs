//! The solids that a ray is inside of.

use crate::geometry::Interaction;

/// The solids that a ray is inside of, as lists that share their tails: a sample's branches leave
/// from common nodes. The solid entered last decides the index of refraction.
#[derive(Default)]
pub(super) struct Media {
    entries: Vec<Medium>,
}

#[derive(Clone, Copy)]
struct Medium {
    below: u32,
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
    /// The list of solids behind the surface.
    pub(super) behind: u32,
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

    pub(super) fn clear(&mut self) {
        self.entries.clear();
    }

    fn push(&mut self, below: u32, solid: u32) -> u32 {
        self.entries.push(Medium { below, solid });
        self.entries.len() as u32 - 1
    }

    /// The solid entered last.
    #[inline(always)]
    fn top(&self, list: u32) -> Option<u32> {
        self.entries.get(list as usize).map(|m| m.solid)
    }

    /// The list without the latest entry of `solid`; the same list if it is not in it.
    fn without(&mut self, list: u32, solid: u32) -> u32 {
        let mut above = [Medium { below: 0, solid: 0 }; 64];
        let (mut at, mut count) = (list, 0);
        while let Some(&medium) = self.entries.get(at as usize) {
            if medium.solid == solid {
                let mut rebuilt = medium.below;
                for m in above[..count].iter().rev() {
                    rebuilt = self.push(rebuilt, m.solid);
                }
                return rebuilt;
            }
            // A path has at most 64 branches, so a list has at most 64 entries.
            above[count] = medium;
            count += 1;
            at = medium.below;
        }
        list
    }

    /// Crosses a surface, coming from `front`, a list of solids.
    #[inline(always)]
    pub(super) fn cross(&mut self, front: u32, at: &Interaction, entering: bool) -> Crossing {
        let own = Some(at.solid);
        if at.thin {
            // Nothing is refracted: whatever is in front is behind, too.
            let mirroring = [self.top(front), own];
            return Crossing { solids: [None, None], mirroring, behind: front };
        }
        if entering {
            let behind = self.push(front, at.solid);
            let solids = [self.top(front), own];
            Crossing { solids, mirroring: solids, behind }
        } else {
            let behind = self.without(front, at.solid);
            // A ray that leaves a solid which it never entered started inside it.
            let inside = if behind == front { own } else { self.top(front) };
            let solids = [inside, self.top(behind)];
            Crossing { solids, mirroring: solids, behind }
        }
    }
}
