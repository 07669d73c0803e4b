//! What is asked of a ray: the closest hit, or what stands before a light.

use std::cell::Cell;

use super::Hit;
use super::compile::Primitives;

/// Collects crossings while the hierarchy is walked.
pub(super) trait Query: Sized {
    /// Whether every crossing of a primitive counts, and not only its first.
    const ALL: bool;

    /// Crossings beyond this `t` are of no use; those at it may be.
    fn limit(&self) -> f64;

    /// A crossing at `t > 0`, finite if all count.
    fn offer(&mut self, t: f64, primitive: u32);

    /// Whether the answer is known.
    fn is_done(&self) -> bool;

    /// Hands it to code that is not inlined. What is asked of every ray lends a copy and takes it
    /// back, so that the walk's own stays in registers.
    #[inline(always)]
    fn lend(&mut self, to: impl FnOnce(&mut Self)) {
        to(self);
    }
}

/// All crossings, in no order.
#[derive(Debug)]
pub(super) struct Gather<'a> {
    /// `t` and primitive of each.
    pub(super) hits: &'a mut Vec<(f64, u32)>,
    /// Crossings from here on do not count.
    pub(super) t_max: f64,
}

impl Query for Gather<'_> {
    const ALL: bool = true;

    fn limit(&self) -> f64 {
        self.t_max
    }

    fn offer(&mut self, t: f64, primitive: u32) {
        if t < self.t_max {
            self.hits.push((t, primitive));
        }
    }

    fn is_done(&self) -> bool {
        false
    }
}

/// Crossings up to so many times the smallest `t` are looked at, so that equal ones are not missed.
const HARDLY_FARTHER: f64 = 1.0 + 1e-8;

/// The smallest `t`; of equal ones the lowest primitive.
#[derive(Clone, Copy, Debug)]
pub(super) struct Closest {
    t: f64,
    primitive: u32,
    /// The nearest of those that are not the closest, if it is hardly farther.
    second: f64,
}

impl Closest {
    /// Nothing met yet.
    #[inline(always)]
    pub(super) fn new() -> Closest {
        Closest { t: f64::INFINITY, primitive: u32::MAX, second: f64::INFINITY }
    }

    /// What was met.
    #[inline(always)]
    pub(super) fn hit(&self) -> Option<Hit> {
        let Closest { t, primitive, second: _ } = *self;
        (t < f64::INFINITY).then_some(Hit { t, primitive })
    }

    /// The `t` of the second one: right if it is larger by less than one part in 10⁸.
    #[inline(always)]
    pub(super) fn second(&self) -> f64 {
        self.second
    }
}

impl Query for Closest {
    const ALL: bool = false;

    #[inline(always)]
    fn limit(&self) -> f64 {
        self.t * HARDLY_FARTHER
    }

    #[inline(always)]
    fn offer(&mut self, t: f64, primitive: u32) {
        if t < self.t || (t == self.t && primitive < self.primitive) {
            *self = Closest { t, primitive, second: self.t };
        } else if t < self.second {
            self.second = t;
        }
    }

    #[inline(always)]
    fn is_done(&self) -> bool {
        false
    }

    #[inline(always)]
    fn lend(&mut self, to: impl FnOnce(&mut Self)) {
        let mut copy = *self;
        to(&mut copy);
        *self = copy;
    }
}

/// The solids before a light at `t_max`, until one is opaque.
#[derive(Clone, Copy)]
pub(super) struct Shadow<'a> {
    primitives: &'a Primitives,
    t_max: f64,
    /// Per solid.
    opaque: &'a [bool],
    crossed: &'a Cell<Vec<u32>>,
    blocker: Option<u32>,
}

impl<'a> Shadow<'a> {
    /// Nothing met yet; `crossed` is empty.
    #[inline(always)]
    pub(super) fn new(
        primitives: &'a Primitives,
        t_max: f64,
        opaque: &'a [bool],
        crossed: &'a mut Vec<u32>,
    ) -> Shadow<'a> {
        Shadow { primitives, t_max, opaque, crossed: Cell::from_mut(crossed), blocker: None }
    }

    /// The opaque solid that was met.
    #[inline(always)]
    pub(super) fn blocker(&self) -> Option<u32> {
        self.blocker
    }
}

impl Query for Shadow<'_> {
    const ALL: bool = true;

    #[inline(always)]
    fn limit(&self) -> f64 {
        self.t_max
    }

    #[inline(always)]
    fn offer(&mut self, t: f64, primitive: u32) {
        if t < self.t_max {
            let solid = self.primitives.solid_index(primitive);
            if self.opaque[solid as usize] {
                self.blocker = Some(solid);
            } else {
                let mut crossed = self.crossed.take();
                crossed.push(solid);
                self.crossed.set(crossed);
            }
        }
    }

    #[inline(always)]
    fn is_done(&self) -> bool {
        self.blocker.is_some()
    }

    #[inline(always)]
    fn lend(&mut self, to: impl FnOnce(&mut Self)) {
        let mut copy = *self;
        to(&mut copy);
        *self = copy;
    }
}
