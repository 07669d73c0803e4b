//! Where a ray enters and leaves a solid made of others.
//!
//! Crossings of all leaves that matter are sorted along the *whole* line, so that what the ray starts
//! in is known; a leaf that the ray starts on is crossed at exactly 0. Crossings that f64 cannot tell
//! apart are one: all complements and ends first, then all beginnings; if the whole is there before
//! and after, or neither, there is no surface. This is what operators ask for at faces that coincide:
//! union drops the inner ones, a difference leaves no skin, an intersection keeps one.

use std::cmp::Ordering;

use fearless_simd::{Level, dispatch};

use super::boxes::{Line, WIDTH};
use super::leaf::{Leaf, Part, Places};
use super::{Child, Composite, NO_PARENT};
use crate::geometry::hierarchy::STACK;
use crate::geometry::motion::Moment;
use crate::geometry::primitive::Start;
use crate::geometry::query::{Gather, Query};
use crate::geometry::traverse::{Departure, Walk};
use crate::geometry::{Hit, Ray};

/// Crossings nearer to each other than this share of `t` and coordinates are one.
const TIE: f64 = 8.0 * f64::EPSILON;

/// How much farther apart they may be where the line is nearly parallel to both surfaces.
const GRAZING: f64 = 1e6;

/// A ray's origin adds this share of its coordinates to the boxes' margins.
const AWAY: f64 = 1e-14;

/// Scratch of one thread.
#[derive(Debug, Default)]
pub(in crate::geometry) struct Lists {
    /// Of the leaf that is asked.
    roots: Vec<f64>,
    /// The same of a mesh, with its triangles.
    hits: Vec<(f64, u32)>,
    events: Vec<Event>,
    /// Of leaves that move.
    places: Places,
    /// Per gate how many of its children are there, per leaf how often it is.
    gates: Vec<i32>,
    leaves: Vec<i32>,
}

/// A crossing of a leaf.
#[derive(Clone, Copy, Debug)]
struct Event {
    t: f64,
    leaf: u32,
    primitive: u32,
    /// Whether the leaf, or its complement if that is meant, begins.
    begins: bool,
}

/// A part of a line that matters.
#[derive(Clone, Copy, Debug)]
pub(super) struct Clip {
    pub(super) from: f64,
    pub(super) to: f64,
}

impl Clip {
    const NOTHING: Clip = Clip { from: f64::INFINITY, to: f64::NEG_INFINITY };

    fn around(self, other: Clip) -> Clip {
        Clip { from: self.from.min(other.from), to: self.to.max(other.to) }
    }

    fn within(self, other: Clip) -> Clip {
        Clip { from: self.from.max(other.from), to: self.to.min(other.to) }
    }
}

/// A composite as a ray sees it.
struct Sight<'a> {
    whole: &'a Composite,
    ray: &'a Ray,
    departure: &'a Departure,
    time: f64,
    level: Level,
    entries: Option<&'a mut [u64; STACK]>,
    lists: &'a mut Lists,
    line: Line,
    /// No coordinate that is computed with is larger, but for `t`.
    size: f64,
}

impl Composite {
    /// Offers its surfaces to the query.
    #[inline(never)]
    pub(in crate::geometry) fn meet<Q: Query>(&self, level: Level, walk: &Walk<'_>, query: &mut Q) {
        let mut moment = walk.moment.borrow_mut();
        let Moment { time, entries, lists, poses: _ } = &mut *moment;
        let ray = walk.ray;
        lists.events.clear();
        let mut sight = Sight {
            whole: self,
            ray,
            departure: &walk.leaving,
            time: *time,
            level,
            entries: entries.as_deref_mut(),
            lists,
            line: Line::new(level, ray, ray.origin.abs().element_sum() * AWAY),
            size: self.size + ray.origin.abs().max_element(),
        };
        if sight.gate(0, Clip { from: 0.0, to: query.limit() }).is_some() {
            sight.sort();
            sight.offer(query);
        }
    }
}

impl Sight<'_> {
    /// Collects the crossings of a gate's leaves within a part of the line; gives the part of it in
    /// which the gate changes, `None` if it is throughout what it is at first.
    fn gate(&mut self, index: u32, mut clip: Clip) -> Option<Clip> {
        let whole = self.whole;
        let gate = &whole.gates[index as usize];
        let begin = self.lists.events.len();
        let mut reach = if gate.all { clip } else { Clip::NOTHING };
        let mut changes = false;
        for (eight, boxes) in gate.children.chunks(WIDTH).zip(&gate.boxes) {
            let Some(within) = boxes.meet(&self.line, clip) else {
                self.lists.events.truncate(begin);
                return None;
            };
            let mut met = within.met;
            while met != 0 {
                let lane = met.trailing_zeros() as usize & (WIDTH - 1);
                met &= met - 1;
                let child = &eight[lane];
                let there_first = whole.is_there_first(child);
                let changing = match child {
                    _ if !within.is_within(lane, clip) => None,
                    Child::Leaf(leaf) => self.leaf(&whole.leaves[*leaf as usize]),
                    Child::Gate(gate) => self.gate(*gate, clip),
                };
                match changing {
                    // One that is never there makes "all of" nothing, one that always is "any of" all.
                    None if there_first != gate.all => {
                        self.lists.events.truncate(begin);
                        return None;
                    }
                    None => {}
                    Some(part) => {
                        changes = true;
                        if gate.all && !there_first {
                            clip = clip.within(part);
                            reach = reach.within(part);
                        } else if !gate.all {
                            reach = reach.around(part);
                        }
                    }
                }
            }
        }
        changes.then_some(reach)
    }

    /// The same as [`Sight::gate`] of a leaf whose box the line meets.
    fn leaf(&mut self, leaf: &Leaf) -> Option<Clip> {
        let start = self.departure.start_in(leaf.first, leaf.count(), leaf.complement);
        let (origin, direction) = match leaf.placed(self.time, &mut self.lists.places) {
            None => (self.ray.origin, self.ray.direction),
            Some(placed) => placed.ray_to_object(self.ray.origin, self.ray.direction),
        };
        let roots = &mut self.lists.roots;
        roots.clear();
        match &leaf.part {
            Part::Sphere(sphere) => sphere.crossings(origin, direction, start, roots),
            Part::Plane(plane) => plane.crossings(origin, direction, start, roots),
            Part::Form(form) => form.crossings(origin, direction, start, roots),
            Part::Mesh => return self.mesh(leaf, &Ray { origin, direction }, start),
            Part::Nothing => return None,
        }
        let (&from, &to) = (roots.first()?, roots.last()?);
        debug_assert!(roots.len().is_multiple_of(2) && roots.is_sorted(), "{roots:?}");
        for (i, &t) in self.lists.roots.iter().enumerate() {
            if t < f64::INFINITY {
                let begins = (i % 2 == 0) != leaf.complement;
                let (number, primitive) = (leaf.number, leaf.first);
                self.lists.events.push(Event { t, leaf: number, primitive, begins });
            }
        }
        Some(Clip { from, to })
    }

    /// Crossings of a closed mesh, all triangles of which are asked from before the mesh on: they
    /// are even in number, whatever rounding does. One that the ray starts on is the nearest to it
    /// that leads to the side to which the ray goes.
    fn mesh(&mut self, leaf: &Leaf, ray: &Ray, start: Start) -> Option<Clip> {
        let length = ray.direction.length();
        let direction = ray.direction / length;
        let [lo, hi] = leaf.rest.bounds()?;
        let middle = (lo + hi) * 0.5;
        // From here on all of it is ahead.
        let back = (ray.origin - middle).dot(direction) + (hi - lo).length();
        let back = back.max(0.0);
        let moved = Ray { origin: ray.origin - direction * back, direction };
        let hits = &mut self.lists.hits;
        hits.clear();
        let entries = self.entries.as_deref_mut()?;
        let nobody = Departure::NONE;
        let resting = std::cell::RefCell::default();
        let walk = Walk::new(&moved, (nobody, 0.0), &resting);
        let level = self.level;
        let mut all = Gather { hits, t_max: f64::INFINITY };
        dispatch!(level, simd => leaf.rest.descend(simd, entries, &walk, &mut all));
        hits.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        hits.iter_mut().for_each(|(t, _)| *t = (*t - back) / length);
        if start != Start::Elsewhere {
            begin_on(hits, start, leaf.first);
        }
        let (from, to) = (hits.first()?.0, hits.last()?.0);
        for (i, &(t, primitive)) in self.lists.hits.iter().enumerate() {
            let begins = (i % 2 == 0) != leaf.complement;
            self.lists.events.push(Event { t, leaf: leaf.number, primitive, begins });
        }
        Some(Clip { from, to })
    }

    /// Sorts all crossings; those that cannot be told from the one that the ray starts on are at 0.
    fn sort(&mut self) {
        // −0 is 0 here.
        self.lists.events.iter_mut().for_each(|event| event.t += 0.0);
        if self.departure.start_in(self.whole.first, self.whole.count, false) != Start::Elsewhere {
            self.gather_at_start();
        }
        let order = |a: &Event, b: &Event| a.t.total_cmp(&b.t).then(a.primitive.cmp(&b.primitive));
        self.lists.events.sort_unstable_by(order);
    }

    /// Puts crossings that cannot be told from the one that the ray starts on at 0.
    #[cold]
    fn gather_at_start(&mut self) {
        let mut events = std::mem::take(&mut self.lists.events);
        let left = |event: &&Event| {
            let leaf = &self.whole.leaves[event.leaf as usize];
            let start = self.departure.start_in(leaf.first, leaf.count(), leaf.complement);
            event.t == 0.0 && start != Start::Elsewhere
        };
        if let Some(zero) = events.iter().find(left).copied() {
            for event in events.iter_mut().filter(|event| event.t != 0.0) {
                if self.is_one(&zero, event) {
                    event.t = 0.0;
                }
            }
        }
        self.lists.events = events;
    }

    /// Whether two crossings cannot be told apart: their surfaces are, along their normals, no farther
    /// from each other than coordinates round.
    fn is_one(&self, a: &Event, b: &Event) -> bool {
        let apart = (b.t - a.t).abs();
        if a.t == b.t {
            return true;
        }
        let least = TIE * (a.t.abs().max(b.t.abs()) + self.size);
        if !apart.is_finite() || apart > least * GRAZING {
            return false;
        }
        apart <= least || (a.leaf != b.leaf && apart * self.slope(a).max(self.slope(b)) <= least)
    }

    /// The cosine between the ray and the normal at a crossing.
    #[cold]
    fn slope(&self, event: &Event) -> f64 {
        let leaf = &self.whole.leaves[event.leaf as usize];
        let hit = Hit { t: event.t, primitive: event.primitive };
        let ((_, normal, _), _) = leaf.surface(self.time, self.ray, hit);
        normal.dot(self.ray.direction).abs()
    }

    /// Offers the surfaces of the whole.
    fn offer<Q: Query>(&mut self, query: &mut Q) {
        let whole = self.whole;
        let mut events = std::mem::take(&mut self.lists.events);
        let [gates, leaves] = &whole.first_counts;
        self.lists.gates.clear();
        self.lists.gates.extend_from_slice(gates);
        self.lists.leaves.clear();
        self.lists.leaves.extend_from_slice(leaves);
        let (mut there, mut from) = (whole.gates[0].is_there_first(), 0);
        while let Some(first) = events.get(from) {
            if first.t > query.limit() {
                break;
            }
            let others = events[from + 1..].iter().take_while(|event| self.is_one(first, event));
            let to = from + 1 + others.count();
            let one = &mut events[from..to];
            if one.len() > 1 {
                one.sort_unstable_by(|a, b| match a.begins.cmp(&b.begins) {
                    Ordering::Equal => a.primitive.cmp(&b.primitive),
                    ends_first => ends_first,
                });
            }
            let (before, mut causes) = (there, [None; 2]);
            for event in one.iter() {
                if let Some(now) = self.cross(event) {
                    (there, causes[usize::from(now)]) = (now, Some(*event));
                }
            }
            if there != before
                && let Some(Event { t, primitive, .. }) = causes[usize::from(there)]
                && t > 0.0
            {
                query.offer(t, primitive);
                if !Q::ALL || query.is_done() {
                    break;
                }
            }
            from = to;
        }
        self.lists.events = events;
    }

    /// Crosses a leaf; whether the whole is there from now on, if that changes.
    #[inline(always)]
    fn cross(&mut self, event: &Event) -> Option<bool> {
        let whole = self.whole;
        let step = |begins: bool| if begins { 1 } else { -1 };
        let count = &mut self.lists.leaves[event.leaf as usize];
        let before = *count > 0;
        *count += step(event.begins);
        let now = *count > 0;
        if now == before {
            return None;
        }
        let mut gate = whole.leaves[event.leaf as usize].gate;
        while gate != NO_PARENT {
            let need = whole.gates[gate as usize].need();
            let count = &mut self.lists.gates[gate as usize];
            let before = *count >= need;
            *count += step(now);
            if (*count >= need) == before {
                return None;
            }
            gate = whole.gates[gate as usize].parent;
        }
        Some(now)
    }
}

/// Puts the crossing that a ray starts on at 0, and all others on their sides of it.
fn begin_on(hits: &mut Vec<(f64, u32)>, start: Start, first: u32) {
    let odd = usize::from(start == Start::Outside);
    if hits.is_empty() {
        // It touches the mesh in one point.
        hits.extend([(0.0, first); 2]);
        return;
    }
    let places = (odd..hits.len()).step_by(2);
    let near = |&a: &usize, &b: &usize| hits[a].0.abs().total_cmp(&hits[b].0.abs());
    let Some(at) = places.min_by(near) else { return };
    for (place, (t, _)) in hits.iter_mut().enumerate() {
        *t = match place.cmp(&at) {
            Ordering::Less => t.min(0.0),
            Ordering::Equal => 0.0,
            Ordering::Greater => t.max(0.0),
        };
    }
}
