//! What editing a parameter will cost, known before it is touched.

use super::knob::{Knob, Way};
use super::plan::Plan;
use super::{Session, Work};
use crate::film::layout::Layout;
use crate::scene::change::Change;
use crate::scene::refine::Refine;
use crate::scene::{Material, Scene, path};

/// The cost of setting one parameter to another value, all others staying as they are.
///
/// Values of a colour or per-channel coefficient are compared per channel: "up to x" holds if no
/// channel is above the larger of its present value and x; "down to x" if none is below the smaller.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Cost {
    /// Any value is a re-shade.
    Instant,
    /// A re-shade for values ≤ this; rays for values above it, for these pixels just above it.
    InstantUpTo(f64, Pixels),
    /// A re-shade for values ≥ this; rays for values below it, for these pixels just below it.
    InstantDownTo(f64, Pixels),
    /// A re-shade for values from the first to the second; for others the trees of these pixels, just
    /// beyond, are read or grown again.
    InstantWithin([f64; 2], Pixels),
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
    /// Whether fewer may do: those that more samples are given, or fewer, are known when the first ones
    /// were read again.
    pub at_most: bool,
}

impl Pixels {
    /// Those of a plan.
    fn of(plan: &Plan, layout: Layout) -> Pixels {
        let (count, of) = (plan.pixels(), layout.pixels());
        let at_most = plan.unsettled.is_some();
        Pixels { count, of, rays: plan.rays(), released: plan.released > 0, at_most }
    }

    /// All of a picture.
    fn all(layout: Layout) -> Pixels {
        let of = layout.pixels();
        Pixels { count: of, of, rays: 0, released: false, at_most: false }
    }
}

/// What editing the parameter at `path` will cost in a session; `None` if there is no such
/// parameter.
///
/// Where a branch may come alive, the limit is exact to the last bit: liveness rises with every
/// parameter (and falls with the cut-off), so the greatest value is sought at which no term of the
/// frontier lives. So are the pixels.
pub fn cost(session: &mut Session, path: &str) -> Option<Cost> {
    let altered = dearest(session.scene(), path::altered(session.scene(), path)?);
    let special =
        cost_of_refraction(session, &altered).or_else(|| cost_of_falloff(session, &altered));
    if special.is_some() {
        return special;
    }
    Some(match knob(session.scene(), &altered) {
        // Where colours are compared, any other one may give some pixel more samples.
        Some(knob) if !session.compares_colors() => cost_of_knob(session, knob),
        _ => cost_of(session, &altered),
    })
}

/// The altered scene, but where a solid's material is another, one with another priority, if there is
/// one: it costs the most.
fn dearest(scene: &Scene, mut altered: Scene) -> Scene {
    let mut solids = scene.solids.iter().zip(&mut altered.solids);
    if let Some((old, new)) = solids.find(|(old, new)| old.material != new.material) {
        let priority = scene.materials.get(old.material).map(|material| material.priority);
        let other = |material: &Material| Some(material.priority) != priority;
        new.material = scene.materials.iter().position(other).unwrap_or(new.material);
    }
    altered
}

impl Session {
    /// Whether colours decide how many samples pixels get.
    fn compares_colors(&self) -> bool {
        self.is_adaptive() && self.scene.trace.refine == Refine::Contrast
    }
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
    let altered = dearest(session.scene(), path::altered(session.scene(), path)?);
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

/// The cost of what may bring a branch to life, or end one.
fn cost_of_knob(session: &mut Session, knob: Knob) -> Cost {
    let layout = session.transport.layout;
    let mut limit = |way| {
        let (value, work) = knob.limit(session, way)?;
        let pixels = match work {
            Work::Regrow(plan) => Pixels::of(&plan, layout),
            Work::Shade | Work::Trace(_) => Pixels::all(layout),
        };
        Some((value, pixels))
    };
    let (more, less) = (limit(Way::More), limit(Way::Less));
    let (low, high) = if knob == Knob::Cutoff { (more, less) } else { (less, more) };
    match (low, high) {
        (None, None) => Cost::Instant,
        (None, Some((high, pixels))) => Cost::InstantUpTo(high, pixels),
        (Some((low, pixels)), None) => Cost::InstantDownTo(low, pixels),
        (Some((low, below)), Some((high, above))) => {
            let most = if below.count > above.count { below } else { above };
            Cost::InstantWithin([low, high], most)
        }
    }
}
