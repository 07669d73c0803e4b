//! Surfaces where solids touch or overlap: all that a ray crosses is looked at one by one.
//!
//! Most rays meet one surface, and the list of solids that they are in tells both media. This is for
//! the others. Where faces of two solids coincide, the ray crosses both at once, from the medium in
//! front of both to the one behind both. Where solids of several priorities overlap, a surface inside
//! a solid of higher priority is not there: the ray passes, and only its list changes. A camera inside
//! something clear begins with the list of what it is in.

use fearless_simd::Simd;

use super::grow::{Grower, Worker};
use super::kept::KeptNode;
use super::media::Media;
use super::pending::Pending;
use crate::geometry::{Hit, Interaction, Leaving, Ray};

/// Surfaces nearer to each other, along their normals, than this share of the coordinates are one.
const TIE: f64 = 16.0 * f64::EPSILON;

/// How much farther apart their crossings may be where the ray is nearly parallel to them.
const GRAZING: f64 = 1e6;

/// A surface that a ray meets.
#[derive(Clone, Copy)]
pub(super) struct Met {
    pub(super) hit: Hit,
    /// Where all crossings were looked at: what the ray is in, in front of and behind it.
    pub(super) found: Option<Found>,
}

/// What is about a surface.
#[derive(Clone, Copy)]
pub(super) struct Found {
    /// Lists of solids.
    pub(super) media: [u32; 2],
    /// Whether surfaces of other solids coincide with it.
    pub(super) touching: bool,
}

/// A crossing that is looked at.
pub(super) struct Step {
    t: f64,
    at: Interaction,
    entering: bool,
    /// Cosine between the ray and the normal.
    slope: f64,
}

/// Lists of one thread.
#[derive(Default)]
pub(super) struct Steps {
    hits: Vec<(f64, u32)>,
    steps: Vec<Step>,
}

/// A ray whose crossings are looked at.
#[derive(Clone, Copy)]
pub(super) struct Sought<'a> {
    pub(super) ray: &'a Ray,
    pub(super) leaving: Option<Leaving>,
    /// Crossings from here on do not count.
    pub(super) t_max: f64,
    /// Whether other surfaces coincide with the one that it starts on.
    pub(super) touching: bool,
    /// The list of solids that it starts in.
    pub(super) medium: u32,
}

impl Sought<'_> {
    fn of(next: &Pending) -> Sought<'_> {
        let Pending { ray, leaving, touching, medium, .. } = next;
        let (leaving, t_max) = (*leaving, f64::INFINITY);
        Sought { ray, leaving, t_max, touching: *touching, medium: *medium }
    }

    /// How far from it a coordinate may be rounded at `t`.
    fn rounding(&self, t: f64) -> f64 {
        TIE * (t.abs() + self.ray.origin.abs().max_element())
    }
}

impl Grower<'_> {
    /// The surface that a ray meets, if any: casts it.
    #[inline(always)]
    pub(super) fn meet<S: Simd>(
        &self,
        simd: S,
        worker: &mut Worker,
        next: &Pending,
    ) -> Option<Met> {
        let met = self.geometry.first_two(simd, &mut worker.stack, &next.ray, next.leaving);
        let (hit, second) = met?;
        let sought = Sought::of(next);
        let near = GRAZING * sought.rounding(hit.t);
        let passes =
            !self.priorities.is_empty() && worker.media.priority(next.medium) > self.least_priority;
        if second - hit.t > near && !passes && !(next.touching && hit.t <= near) {
            return Some(Met { hit, found: None });
        }
        self.search(simd, worker, sought)
    }

    /// The list of solids that a camera ray starts in.
    #[inline(always)]
    pub(super) fn medium_of_eye<S: Simd>(&self, simd: S, worker: &mut Worker, ray: &Ray) -> u32 {
        if self.surrounded { self.surroundings(simd, worker, ray) } else { Media::OUTSIDE }
    }

    /// What met the ray of a kept node.
    #[inline(always)]
    pub(super) fn recall<S: Simd>(
        &self,
        simd: S,
        worker: &mut Worker,
        next: &Pending,
        node: &KeptNode,
    ) -> Met {
        let plain = Met { hit: Hit { t: node.t, primitive: node.primitive }, found: None };
        if !node.ends.searched() {
            return plain;
        }
        self.search(simd, worker, Sought::of(next)).unwrap_or(plain)
    }

    /// The first surface on a ray that is there, with what is about it.
    #[inline(never)]
    fn search<S: Simd>(&self, simd: S, worker: &mut Worker, sought: Sought<'_>) -> Option<Met> {
        self.look(simd, worker, &sought);
        let steps = std::mem::take(&mut worker.steps.steps);
        let (mut front, mut from, mut met) = (sought.medium, 0, None);
        while met.is_none() && from < steps.len() {
            let one = one(&steps[from..], &sought);
            let behind = cross(&mut worker.media, front, one);
            if let Some(seen) = visible(&worker.media, [front, behind], one) {
                let thin = seen.at.thin;
                let own = |step: &&Step| !step.at.thin && step.at.body != seen.at.body;
                let touching = !thin && one.iter().any(|step| own(&step));
                // Beyond a sheet that lies on a solid, that solid is met next.
                let behind = if thin { front } else { behind };
                let hit = Hit { t: seen.t, primitive: seen.at.primitive };
                met = Some(Met { hit, found: Some(Found { media: [front, behind], touching }) });
            }
            front = behind;
            from += one.len();
        }
        worker.steps.steps = steps;
        met
    }

    /// What stands before a light, where surfaces may not be there: as
    /// [`Geometry::occluded`](crate::geometry::Geometry::occluded).
    #[inline(never)]
    pub(super) fn search_shadow<S: Simd>(
        &self,
        simd: S,
        worker: &mut Worker,
        sought: Sought<'_>,
    ) -> Option<u32> {
        self.look(simd, worker, &sought);
        worker.crossed.clear();
        let steps = std::mem::take(&mut worker.steps.steps);
        let (mut front, mut from, mut blocker) = (sought.medium, 0, None);
        while blocker.is_none() && from < steps.len() {
            let one = one(&steps[from..], &sought);
            let behind = cross(&mut worker.media, front, one);
            for step in one.iter().filter(|step| is_there(&worker.media, [front, behind], step)) {
                match self.opaque[step.at.solid as usize] {
                    true => blocker = blocker.or(Some(step.at.solid)),
                    false => worker.crossed.push(step.at.solid),
                }
            }
            front = behind;
            from += one.len();
        }
        worker.steps.steps = steps;
        blocker
    }

    /// The list of clear solids that the origin of a camera ray is in: those which it leaves before it
    /// enters them.
    #[inline(never)]
    pub(super) fn surroundings<S: Simd>(&self, simd: S, worker: &mut Worker, ray: &Ray) -> u32 {
        let (leaving, t_max) = (None, f64::INFINITY);
        let sought = Sought { ray, leaving, t_max, touching: false, medium: Media::OUTSIDE };
        self.look(simd, worker, &sought);
        let mut steps = std::mem::take(&mut worker.steps.steps);
        let mut seen = Vec::new();
        steps.retain(|step| {
            let first = !step.at.thin && !seen.contains(&step.at.body);
            if first {
                seen.push(step.at.body);
            }
            first && !step.entering && self.clear[step.at.solid as usize]
        });
        // What is left last was entered first.
        let enter = |list, step: &Step| worker.media.with(list, &step.at);
        let list = steps.iter().rev().fold(Media::OUTSIDE, enter);
        worker.steps.steps = steps;
        list
    }

    /// Collects all crossings that count, in order.
    fn look<S: Simd>(&self, simd: S, worker: &mut Worker, sought: &Sought<'_>) {
        let Worker { stack, steps: Steps { hits, steps }, .. } = worker;
        let Sought { ray, leaving, t_max, touching, medium: _ } = *sought;
        self.geometry.crossings(simd, stack, ray, t_max, leaving, hits);
        steps.clear();
        steps.extend(hits.iter().map(|&(t, primitive)| {
            let at = self.geometry.interaction(stack, ray, Hit { t, primitive });
            let slope = at.geometric_normal.dot(ray.direction);
            Step { t, at, entering: slope < 0.0, slope: slope.abs() }
        }));
        if touching {
            // What coincides with the surface that the ray starts on is crossed already.
            let least = sought.rounding(0.0);
            steps.retain(|step| step.t > GRAZING * least || step.t * step.slope.min(1.0) > least);
        }
    }
}

/// The crossings at the beginning that cannot be told apart from the first.
fn one<'a>(steps: &'a [Step], sought: &Sought<'_>) -> &'a [Step] {
    let first = &steps[0];
    let least = sought.rounding(first.t);
    let same = |step: &&Step| {
        let apart = step.t - first.t;
        apart <= GRAZING * least && apart * step.slope.max(first.slope) <= least
    };
    &steps[..1 + steps[1..].iter().take_while(same).count()]
}

/// The list behind some surfaces that are crossed at once.
fn cross(media: &mut Media, front: u32, one: &[Step]) -> u32 {
    let solid = |step: &&Step| !step.at.thin;
    let twice = |step: &&Step| {
        let other = |o: &Step| o.at.body == step.at.body && o.entering != step.entering;
        !one.iter().any(other)
    };
    let leaves = one.iter().filter(solid).filter(twice).filter(|step| !step.entering);
    let list = leaves.fold(front, |list, step| media.without(list, step.at.body));
    let enters = one.iter().filter(solid).filter(twice).filter(|step| step.entering);
    enters.fold(list, |list, step| media.with(list, &step.at))
}

/// Whether a surface between two lists of solids is there: no solid of higher priority is.
fn is_there(media: &Media, [front, behind]: [u32; 2], step: &Step) -> bool {
    let within = if step.entering { behind } else { front };
    step.at.thin || media.priority_of(step.at.solid) >= media.priority(within)
}

/// Which of some surfaces that are crossed at once is seen: one that is entered before one that is
/// left, the highest priority, the lowest primitive.
fn visible<'a>(media: &Media, lists: [u32; 2], one: &'a [Step]) -> Option<&'a Step> {
    one.iter().filter(|step| is_there(media, lists, step)).min_by_key(|step| {
        let left = !step.entering && !step.at.thin;
        (left, u32::MAX - media.priority_of(step.at.solid), step.at.primitive)
    })
}
