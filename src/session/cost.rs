//! What editing a parameter will cost, known before it is touched.

use super::plan::Plan;
use super::{Session, Work};
use crate::color::Rgb;
use crate::film::layout::Layout;
use crate::fold::trie::ROOT;
use crate::scene::change::Change;
use crate::scene::factor::{Factor, FactorValues, Kind};
use crate::scene::fields::{COEFFICIENT, DEPTH, SHARE, WEIGHT};
use crate::scene::{Scene, path};
use crate::shade::terms::frontier_lives;

/// The cost of setting one parameter to another value, all others staying as they are.
///
/// Values of a colour or per-channel coefficient are compared per channel: "up to x" holds if no
/// channel is above the larger of its present value and x.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Cost {
    /// Any value is a re-shade.
    Instant,
    /// A re-shade for values ≤ this; rays for values above it, for these pixels just above it.
    InstantUpTo(f64, Pixels),
    /// A re-shade for values ≥ this; rays for values below it, for these pixels just below it.
    InstantDownTo(f64, Pixels),
    /// A re-shade for values ≥ this; for values below it the kept trees of these pixels are read
    /// again.
    RereadBelow(f64, Pixels),
    /// A re-shade for values above 0; for 0 the kept trees of these pixels are read again.
    InstantAboveZero(Pixels),
    /// Highlights are folded again, no ray is cast.
    Refold,
    /// The kept trees of these pixels are read and folded again, no ray is cast.
    Reread(Pixels),
    /// The trees of these pixels are grown again.
    Regrow(Pixels),
    /// Everything is traced.
    TraceAll,
}

/// Some of the pixels of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pixels {
    /// How many.
    pub count: u64,
    /// Of how many.
    pub of: u64,
    /// Branches and shadow rays that come alive in them: at least so many rays are cast, but for blurred
    /// ones that go to the wrong side of their surface.
    pub rays: u64,
    /// Whether the kept trees of some of them were released for memory: there every ray is cast.
    pub released: bool,
}

impl Pixels {
    /// Those of a plan.
    fn of(plan: &Plan, layout: Layout) -> Pixels {
        let (count, of) = (plan.pixels(), layout.pixels());
        Pixels { count, of, rays: plan.rays(), released: plan.released > 0 }
    }

    /// All of a picture.
    fn all(layout: Layout) -> Pixels {
        let of = layout.pixels();
        Pixels { count: of, of, rays: 0, released: false }
    }
}

/// What editing the parameter at `path` will cost in a session; `None` if there is no such
/// parameter.
///
/// Where a branch may come alive, the limit is exact to the last bit: liveness rises with every
/// parameter (and falls with the cut-off), so the greatest value is sought at which no term of the
/// frontier lives. So are the pixels.
pub fn cost(session: &mut Session, path: &str) -> Option<Cost> {
    let altered = path::altered(session.scene(), path)?;
    let special =
        cost_of_refraction(session, &altered).or_else(|| cost_of_falloff(session, &altered));
    if special.is_some() {
        return special;
    }
    Some(match knob(session.scene(), &altered) {
        // Which pixels get all samples may change with any branch that begins or ceases to live.
        Some(_) if session.is_adaptive() => Cost::TraceAll,
        Some(knob) => knob.cost(session),
        None => cost_of(session, &altered),
    })
}

/// The cost of an index of refraction that does not show as it is; `None` for other parameters.
fn cost_of_refraction(session: &mut Session, altered: &Scene) -> Option<Cost> {
    let scene = session.shared_scene();
    let mut pairs = scene.materials.iter().zip(&altered.materials);
    let material = pairs.position(|(a, b)| a.ior != b.ior)?;
    let limit = scene.ior_matters_below(material)?;
    if scene.materials[material].ior < limit {
        return None;
    }
    let mut beyond = (*scene).clone();
    beyond.materials[material].ior = limit.next_down();
    let layout = session.transport.layout;
    let change = Change::between(&scene, &beyond);
    Some(match session.work(&beyond, &change) {
        Work::Regrow(plan) => Cost::RereadBelow(limit, Pixels::of(&plan, layout)),
        Work::Shade => Cost::Instant,
        Work::Trace(_) => Cost::RereadBelow(limit, Pixels::all(layout)),
    })
}

/// The cost of a distance at which a light falls off, if it does; `None` for other parameters.
fn cost_of_falloff(session: &mut Session, altered: &Scene) -> Option<Cost> {
    let scene = session.shared_scene();
    let mut pairs = scene.lights.iter().zip(&altered.lights);
    let light = pairs.position(|(a, b)| a.falloff != b.falloff)?;
    if !scene.lights[light].falls_off() {
        return None;
    }
    let mut without = (*scene).clone();
    without.lights[light].falloff = 0.0;
    let layout = session.transport.layout;
    let change = Change::between(&scene, &without);
    Some(Cost::InstantAboveZero(match session.work(&without, &change) {
        Work::Regrow(plan) => Pixels::of(&plan, layout),
        Work::Shade | Work::Trace(_) => Pixels::all(layout),
    }))
}

/// The same while the scene is still traced or grown and `session` holds a preview of it: `None` also
/// where only the whole picture's trees can tell.
pub fn cost_of_preview(session: &mut Session, path: &str) -> Option<Cost> {
    let altered = path::altered(session.scene(), path)?;
    let falls_off = cost_of_falloff(session, &altered).is_some();
    let (old, new) = (&session.scene().trace, &altered.trace);
    // With the samples of a preview nothing is adaptive.
    let sampling = old.adaptive != new.adaptive || old.refine != new.refine;
    if sampling || falls_off || knob(session.scene(), &altered).is_some() {
        return None;
    }
    let cost = cost_of(session, &altered);
    (!matches!(cost, Cost::Reread(_) | Cost::Regrow(_))).then_some(cost)
}

/// What may bring a branch to life, unless everything is traced anyway.
fn knob(scene: &Scene, altered: &Scene) -> Option<Knob> {
    let moves_rays = Change::between(scene, altered).moves_rays.is_some();
    Knob::between(scene, altered).filter(|_| !moves_rays)
}

/// The cost of an edit that brings no branch to life.
fn cost_of(session: &mut Session, altered: &Scene) -> Cost {
    let change = Change::between(session.scene(), altered);
    let layout = session.transport.layout;
    match session.work(altered, &change) {
        Work::Trace(_) => Cost::TraceAll,
        Work::Regrow(plan) if plan.casts => Cost::Regrow(Pixels::of(&plan, layout)),
        Work::Regrow(plan) => Cost::Reread(Pixels::of(&plan, layout)),
        Work::Shade if !change.refold.is_empty() => Cost::Refold,
        Work::Shade => Cost::Instant,
    }
}

/// A parameter that the rule of liveness reads.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Knob {
    /// Of the material with this index.
    Reflect(usize),
    /// Of the material with this index.
    Transmit(usize),
    /// Of the material with this index.
    Filter(usize),
    /// The limit of depth.
    Depth,
    /// The limit of weight: lower values let more live.
    Cutoff,
}

impl Knob {
    /// The one that differs.
    fn between(scene: &Scene, altered: &Scene) -> Option<Knob> {
        let (old, new) = (&scene.trace, &altered.trace);
        if old.depth != new.depth {
            return Some(Knob::Depth);
        }
        if old.cutoff != new.cutoff {
            return Some(Knob::Cutoff);
        }
        let mut pairs = scene.materials.iter().zip(&altered.materials).enumerate();
        pairs.find_map(|(i, (a, b))| {
            let reflect = (a.reflect != b.reflect).then_some(Knob::Reflect(i));
            let transmit = (a.transmit != b.transmit).then_some(Knob::Transmit(i));
            reflect.or(transmit).or((a.filter != b.filter).then_some(Knob::Filter(i)))
        })
    }

    /// The coefficient that it sets.
    fn coefficient(self, scene: &mut Scene) -> Option<&mut Rgb> {
        match self {
            Knob::Reflect(i) => Some(&mut scene.materials[i].reflect),
            Knob::Transmit(i) => Some(&mut scene.materials[i].transmit),
            Knob::Filter(i) => Some(&mut scene.materials[i].filter),
            Knob::Depth | Knob::Cutoff => None,
        }
    }

    /// Steps of the parameter that let ever more live, from its present value to the end of its
    /// range: the bits of a positive float are in the order of its values.
    fn steps(self, scene: &Scene) -> [u32; 2] {
        let bits = |x: f32| (x + 0.0).to_bits();
        match self {
            Knob::Depth => [scene.trace.depth, DEPTH.high as u32],
            Knob::Cutoff => {
                let top = bits(SHARE.high as f32);
                [top - bits(scene.trace.cutoff), top - bits(SHARE.low as f32)]
            }
            _ => {
                let range = if matches!(self, Knob::Filter(_)) { COEFFICIENT } else { WEIGHT };
                let present = self.coefficient(&mut scene.clone()).map_or(Rgb::BLACK, |c| *c);
                let Rgb([r, g, b]) = present;
                [bits(r.min(g).min(b)), bits(range.high as f32)]
            }
        }
    }

    /// The value at a step.
    fn value(self, step: u32) -> f64 {
        match self {
            Knob::Depth => f64::from(step),
            Knob::Cutoff => f64::from(f32::from_bits((SHARE.high as f32).to_bits() - step)),
            _ => f64::from(f32::from_bits(step)),
        }
    }

    /// All factors, with the parameter at a step.
    fn factors(self, scene: &mut Scene, present: &Scene, step: u32) -> FactorValues {
        let value = self.value(step);
        match self {
            Knob::Depth => scene.trace.depth = step,
            Knob::Cutoff => scene.trace.cutoff = value as f32,
            _ => {
                let before = self.coefficient(&mut present.clone()).map(|c| *c);
                let raised = before.map(|c| c.map(|c| c.max(value as f32)));
                if let (Some(coefficient), Some(raised)) = (self.coefficient(scene), raised) {
                    *coefficient = raised;
                }
            }
        }
        FactorValues::new(scene)
    }

    /// Whether a factor depends on it.
    fn concerns(self, factor: Factor) -> bool {
        let mirror = matches!(factor.kind(), Kind::Reflect | Kind::TotalReflect);
        let through = matches!(factor.kind(), Kind::Transmit | Kind::Shadow | Kind::TotalReflect);
        match self {
            Knob::Reflect(material) => mirror && factor.index() == material,
            Knob::Transmit(material) => through && factor.index() == material,
            Knob::Filter(material) => through && factor.index() == material,
            Knob::Depth | Knob::Cutoff => true,
        }
    }

    fn cost(self, session: &mut Session) -> Cost {
        let [first, last] = self.steps(session.scene());
        let limit = Search::new(self, session.scene(), first, last).limit(session);
        let limit = limit.min(self.stale_from(session, first).unwrap_or(last));
        if limit == last {
            return Cost::Instant;
        }
        let mut beyond = session.scene().clone();
        self.factors(&mut beyond, session.scene(), limit + 1);
        let change = Change::between(session.scene(), &beyond);
        let layout = session.transport.layout;
        let pixels = match session.work(&beyond, &change) {
            Work::Regrow(plan) => Pixels::of(&plan, layout),
            Work::Shade | Work::Trace(_) => Pixels::all(layout),
        };
        match self {
            Knob::Cutoff => Cost::InstantDownTo(self.value(limit), pixels),
            _ => Cost::InstantUpTo(self.value(limit), pixels),
        }
    }

    /// The last step at which an index of refraction or a lobe that the trees were not grown with does
    /// not matter, if it matters beyond: of this material, or an index of another, which has a denser one
    /// before it as soon as light passes through this one.
    fn stale_from(self, session: &Session, first: u32) -> Option<u32> {
        let (Knob::Reflect(_) | Knob::Transmit(_)) = self else { return None };
        let present = session.scene();
        let mut beyond = present.clone();
        self.factors(&mut beyond, present, first + 1);
        let change = Change::between(present, &beyond);
        (!session.stale(&beyond, &change).is_empty()).then_some(first)
    }
}

/// The search for the greatest step at which no term of the frontier lives.
struct Search<'a> {
    knob: Knob,
    present: &'a Scene,
    scene: Scene,
    /// Nothing lives here.
    first: u32,
    /// The best limit so far.
    best: u32,
    at_best: FactorValues,
}

impl<'a> Search<'a> {
    fn new(knob: Knob, present: &'a Scene, first: u32, last: u32) -> Search<'a> {
        let mut scene = present.clone();
        let at_best = knob.factors(&mut scene, present, last);
        Search { knob, present, scene, first, best: last, at_best }
    }

    fn limit(mut self, session: &Session) -> u32 {
        let nodes = session.transport.trie.nodes();
        let mut factors = Vec::new();
        for mut id in session.program.frontier() {
            factors.clear();
            let mut concerned = false;
            while id != ROOT {
                let node = &nodes[id as usize];
                concerned |= self.knob.concerns(node.factor);
                factors.push(node.factor);
                id = node.parent;
            }
            if concerned {
                factors.reverse();
                self.lower(&factors);
            }
        }
        self.best
    }

    /// Lowers the limit to the last step at which the given term does not live, if it is lower.
    fn lower(&mut self, factors: &[Factor]) {
        if !frontier_lives(factors, &self.at_best) {
            return;
        }
        let (mut dead, mut alive) = (self.first, self.best);
        while alive - dead > 1 {
            let middle = dead + (alive - dead) / 2;
            let values = self.knob.factors(&mut self.scene, self.present, middle);
            if frontier_lives(factors, &values) {
                alive = middle;
            } else {
                dead = middle;
            }
        }
        self.best = dead;
        self.at_best = self.knob.factors(&mut self.scene, self.present, dead);
    }
}
