//! Parallel rays through a solid: a jittered grid along each of the three axes of its box.

use fearless_simd::{Level, Simd, dispatch};
use glam::DVec3;
use rayon::prelude::*;

use super::moments::{COUNT, Estimate, Moments, dense, of_interval};
use crate::geometry::{Geometry, Hit, Ray, Stack};
use crate::progress::{Cancelled, Progress};

/// A ray that meets an edge so that the crossings do not add up is cast anew this many times.
const MOST_TRIES: u64 = 8;

/// A region of one density.
pub(super) struct Region {
    pub(super) geometry: Geometry,
    pub(super) density: f64,
}

/// The solid, alone, with the middle of its box at the origin.
pub(super) struct Grid<'a> {
    /// That do not overlap, and are all of it.
    pub(super) regions: &'a [Region],
    /// Half the sides of the box.
    pub(super) half: DVec3,
    /// Other rays for another one.
    pub(super) seed: u64,
}

/// What some rays of a grid found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Found {
    pub(super) estimate: Estimate,
    /// Rays that found no sense in any try; they count as if they had missed.
    pub(super) torn: u64,
}

/// What a thread needs.
struct Scratch {
    /// Per region.
    stacks: Vec<Stack>,
    /// `t` and primitive of each.
    hits: Vec<(f64, u32)>,
}

impl Grid<'_> {
    fn scratch(&self) -> Scratch {
        let stacks = self.regions.iter().map(|region| Stack::new(&region.geometry)).collect();
        Scratch { stacks, hits: Vec::new() }
    }

    /// Casts `2·n²` rays along every axis, two in every cell of a grid of n by n.
    ///
    /// Rows of cells are summed by themselves and then in their order: the bits do not depend on the
    /// threads.
    pub(super) fn cast(&self, n: u32, progress: &Progress) -> Result<Found, Cancelled> {
        let level = Level::new();
        let rows: Result<Vec<Found>, Cancelled> = (0..3 * n)
            .into_par_iter()
            .map_init(
                || self.scratch(),
                |scratch, row| {
                    progress.check()?;
                    let (axis, row) = ((row / n) as usize, row % n);
                    Ok(dispatch!(level, simd => self.row(simd, scratch, (axis, n, row))))
                },
            )
            .collect();
        let rows = rows?;
        let mut torn = 0;
        let axes: Vec<Estimate> = rows
            .chunks(n as usize)
            .map(|rows| {
                let mut sum = Estimate::ZERO;
                for Found { estimate, torn: more } in rows {
                    sum += *estimate;
                    torn += more;
                }
                sum
            })
            .collect();
        Ok(Found { estimate: Estimate::mean_of(&axes), torn })
    }

    /// One row of cells: those with the same place along the axis behind `axis`.
    #[inline(always)]
    fn row<S: Simd>(&self, simd: S, scratch: &mut Scratch, at: (usize, u32, u32)) -> Found {
        let (axis, n, row) = at;
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        let cell = [2.0 * self.half[u] / f64::from(n), 2.0 * self.half[v] / f64::from(n)];
        let mut found = Found { estimate: Estimate::ZERO, torn: 0 };
        for column in 0..n {
            let mut pair = [[0.0; COUNT]; 2];
            for (which, moments) in pair.iter_mut().enumerate() {
                let number = ((axis as u64 * u64::from(n) + u64::from(row)) * u64::from(n)
                    + u64::from(column))
                    * 2
                    + which as u64;
                let whole = (0..MOST_TRIES).find_map(|again| {
                    let [a, b] = self.jitter(n, number, again);
                    let across = [
                        cell[0] * (f64::from(row) + a) - self.half[u],
                        cell[1] * (f64::from(column) + b) - self.half[v],
                    ];
                    self.ray(simd, scratch, axis, across)
                });
                match whole {
                    Some(whole) => *moments = whole,
                    None => found.torn += 1,
                }
            }
            found.estimate.add_pair(cell[0] * cell[1], &pair[0], &pair[1]);
        }
        found
    }

    /// The moments of all that a ray meets; `None` if its crossings do not add up.
    #[inline(always)]
    fn ray<S: Simd>(
        &self,
        simd: S,
        scratch: &mut Scratch,
        axis: usize,
        across: [f64; 2],
    ) -> Option<Moments> {
        let Scratch { stacks, hits } = scratch;
        let mut origin = DVec3::ZERO;
        origin[(axis + 1) % 3] = across[0];
        origin[(axis + 2) % 3] = across[1];
        // Well outside of the box.
        let start = -2.0 * self.half[axis];
        origin[axis] = start;
        let mut direction = DVec3::ZERO;
        direction[axis] = 1.0;
        let ray = Ray { origin, direction };
        let mut sum = [0.0; COUNT];
        for (Region { geometry, density }, stack) in self.regions.iter().zip(stacks) {
            geometry.all_hits(simd, stack, &ray, hits);
            // Solids may overlap, as the balls of a flake do: the ray is inside while it has entered
            // more often than it has left.
            let (mut depth, mut entered) = (0, 0.0);
            for &(t, primitive) in &*hits {
                let hit = Hit { t, primitive };
                let normal = geometry.interaction(stack, &ray, hit).geometric_normal;
                if normal[axis] < 0.0 {
                    if depth == 0 {
                        entered = t;
                    }
                    depth += 1;
                } else {
                    depth -= 1;
                    if depth == 0 {
                        let part = of_interval(axis, across, start + entered, start + t);
                        let part = dense(part, *density);
                        sum.iter_mut().zip(part).for_each(|(sum, x)| *sum += x);
                    }
                }
                if depth < 0 {
                    return None;
                }
            }
            if depth != 0 {
                return None;
            }
        }
        Some(sum)
    }

    /// Two numbers in (0, 1) for a ray.
    fn jitter(&self, n: u32, number: u64, again: u64) -> [f64; 2] {
        let mut state = self.seed ^ (u64::from(n) << 40) ^ (again << 32);
        for word in [number, u64::from(n)] {
            state = mixed(state.wrapping_add(word.wrapping_mul(0x9e37_79b9_7f4a_7c15)));
        }
        [state, mixed(state ^ 0x5851_f42d_4c95_7f2d)]
            .map(|bits| ((bits >> 11) as f64 + 0.5) / (1u64 << 53) as f64)
    }
}

/// A bijection of 64 bits that mixes them well (splitmix64; Steele, Lea and Flood 2014).
fn mixed(mut bits: u64) -> u64 {
    bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    bits ^ (bits >> 31)
}
