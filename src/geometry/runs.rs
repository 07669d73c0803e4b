//! Runs of a polygon's edges, each with a box around it: a line asks only those that it may cross.

use std::ops::Range;

use glam::DVec2;

/// Edges that are asked one by one.
const MOST_EDGES: usize = 8;

/// More than the roundings of a corner's side of a line and of a box's, as a share of their terms.
const ROUNDING: f64 = 16.0 * f64::EPSILON;

/// A run of edges, or one that two shorter ones follow, which are it.
///
/// # Invariants
/// In a list of runs each stands before those within it, and those in the order of their edges.
#[derive(Clone, Debug)]
pub(super) struct Run {
    /// The middle of a box around all of its corners.
    middle: DVec2,
    /// From there to the box's sides.
    half: DVec2,
    /// The corner before its first edge's end.
    pub(super) from: u32,
    /// The corners at which its edges end; empty if shorter runs follow.
    first: u32,
    end: u32,
    /// The run behind it and all within it.
    pub(super) next: u32,
}

impl Run {
    /// Whether all of its corners are, as they are decided one by one, on the same side of the line
    /// through `p`. Where rounding leaves a doubt, it is not.
    #[inline(always)]
    pub(super) fn is_beside(&self, along: DVec2, p: DVec2) -> bool {
        let out = self.middle - p;
        let (a, b) = (along.x * out.y, along.y * out.x);
        let reach = along.x.abs() * self.half.y + along.y.abs() * self.half.x;
        (a - b).abs() > reach + ROUNDING * (a.abs() + b.abs() + reach)
    }

    /// The corners at which its own edges end.
    #[inline(always)]
    pub(super) fn edges(&self) -> Range<usize> {
        self.first as usize..self.end as usize
    }

    /// A run for each loop, beside no line.
    #[cfg(test)]
    pub(super) fn all(ends: &[usize]) -> Box<[Run]> {
        let begins = [0].into_iter().chain(ends.iter().copied());
        let numbered = begins.zip(ends).zip(1..);
        let run = |((begin, &end), next): ((usize, &usize), u32)| Run {
            middle: DVec2::ZERO,
            half: DVec2::INFINITY,
            from: end as u32 - 1,
            first: begin as u32,
            end: end as u32,
            next,
        };
        numbered.map(run).collect()
    }

    /// Makes it be beside every line.
    #[cfg(test)]
    pub(super) fn hide(&mut self) {
        self.half = DVec2::splat(-1e300);
    }
}

/// The runs of all loops, whose corners end where `ends` says.
pub(super) fn runs(corners: &[DVec2], ends: &[usize]) -> Box<[Run]> {
    let mut all = Vec::new();
    let mut begin = 0;
    for &end in ends {
        split(corners, end - 1, begin..end, &mut all);
        begin = end;
    }
    all.into_boxed_slice()
}

/// Appends the run of the edges that end at these corners, and those within it.
fn split(corners: &[DVec2], from: usize, edges: Range<usize>, all: &mut Vec<Run>) {
    let own = corners[edges.clone()].iter().chain([&corners[from]]);
    let nowhere = [DVec2::INFINITY, DVec2::NEG_INFINITY];
    let [lo, hi] = own.fold(nowhere, |[lo, hi], p| [lo.min(*p), hi.max(*p)]);
    let middle = (lo + hi) * 0.5;
    let half = (hi - middle).max(middle - lo);
    let index = all.len();
    let is_short = edges.len() <= MOST_EDGES;
    let own = if is_short { edges.clone() } else { 0..0 };
    let (first, end) = (own.start as u32, own.end as u32);
    all.push(Run { middle, half, from: from as u32, first, end, next: 0 });
    if !is_short {
        let cut = edges.start + edges.len() / 2;
        split(corners, from, edges.start..cut, all);
        split(corners, cut - 1, cut..edges.end, all);
    }
    all[index].next = all.len() as u32;
}
