//! The parameters that the rule of liveness reads, and how far each may go before shading is not enough.

use super::redecide::is_seen;
use super::{Session, Work};
use crate::color::Rgb;
use crate::fold::trie::ROOT;
use crate::scene::Scene;
use crate::scene::change::Change;
use crate::scene::factor::{Factor, FactorValues, Kind};
use crate::scene::fields::{COEFFICIENT, DEPTH, SHARE, WEIGHT};
use crate::scene::range::Range;
use crate::shade::terms::frontier_lives;

/// A parameter that the rule of liveness reads.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Knob {
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
    pub(super) fn between(scene: &Scene, altered: &Scene) -> Option<Knob> {
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

    /// Steps of the parameter from its present value to the end of its range, each of which lets more
    /// live, or less: the bits of a positive float are in the order of its values.
    fn steps(self, scene: &Scene, way: Way) -> u32 {
        match (self, way) {
            (Knob::Depth, Way::More) => DEPTH.high as u32 - scene.trace.depth,
            (Knob::Depth, Way::Less) => scene.trace.depth,
            (Knob::Cutoff, Way::More) => bits(scene.trace.cutoff) - bits(SHARE.low as f32),
            (Knob::Cutoff, Way::Less) => bits(SHARE.high as f32) - bits(scene.trace.cutoff),
            (_, Way::More) => bits(self.range().high as f32) - self.end(scene, way),
            (_, Way::Less) => self.end(scene, way),
        }
    }

    fn range(self) -> Range {
        if matches!(self, Knob::Filter(_)) { COEFFICIENT } else { WEIGHT }
    }

    /// Bits of the least channel of a coefficient, or of the greatest if it is lowered.
    fn end(self, scene: &Scene, way: Way) -> u32 {
        let Rgb([r, g, b]) = self.coefficient(&mut scene.clone()).map_or(Rgb::BLACK, |c| *c);
        match way {
            Way::More => bits(r.min(g).min(b)),
            Way::Less => bits(r.max(g).max(b)),
        }
    }

    /// The value at a step.
    fn value(self, present: &Scene, way: Way, step: u32) -> f64 {
        let float = |bits: u32| f64::from(f32::from_bits(bits));
        match (self, way) {
            (Knob::Depth, Way::More) => f64::from(present.trace.depth + step),
            (Knob::Depth, Way::Less) => f64::from(present.trace.depth - step),
            (Knob::Cutoff, Way::More) => float(bits(present.trace.cutoff) - step),
            (Knob::Cutoff, Way::Less) => float(bits(present.trace.cutoff) + step),
            (_, Way::More) => float(self.end(present, way) + step),
            (_, Way::Less) => float(self.end(present, way) - step),
        }
    }

    /// All factors, with the parameter at a step.
    fn factors(self, scene: &mut Scene, present: &Scene, way: Way, step: u32) -> FactorValues {
        let value = self.value(present, way, step);
        match self {
            Knob::Depth => scene.trace.depth = value as u32,
            Knob::Cutoff => scene.trace.cutoff = value as f32,
            _ => {
                let moved = |c: f32| match way {
                    Way::More => c.max(value as f32),
                    Way::Less => c.min(value as f32),
                };
                let moved = self.coefficient(&mut present.clone()).map(|c| c.map(moved));
                if let (Some(coefficient), Some(moved)) = (self.coefficient(scene), moved) {
                    *coefficient = moved;
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

    /// The last value that shading is enough for, if there is one before the end of the range, and what
    /// is to be done just beyond it.
    pub(super) fn limit(self, session: &mut Session, way: Way) -> Option<(f64, Work)> {
        let present = session.shared_scene();
        let last = self.steps(&present, way);
        let mut limit = Search::new(self, way, &present, last).limit(session);
        if way == Way::More {
            limit = limit.min(self.stale_from(session).unwrap_or(last));
        }
        if limit == last {
            return None;
        }
        let mut beyond = (*present).clone();
        self.factors(&mut beyond, &present, way, limit + 1);
        let change = Change::between(&present, &beyond);
        let work = session.work(&beyond, &change);
        Some((self.value(&present, way, limit), work))
    }

    /// The last step at which an index of refraction or a lobe that the trees were not grown with does
    /// not matter, if it matters beyond: of this material, or an index of another, which has a denser one
    /// before it as soon as light passes through this one.
    fn stale_from(self, session: &Session) -> Option<u32> {
        let (Knob::Reflect(_) | Knob::Transmit(_)) = self else { return None };
        let present = session.scene();
        if self.steps(present, Way::More) == 0 {
            return None;
        }
        let mut beyond = present.clone();
        self.factors(&mut beyond, present, Way::More, 1);
        let change = Change::between(present, &beyond);
        (!session.stale(&beyond, &change).is_empty()).then_some(0)
    }
}

/// The bits of a float ≥ 0.
fn bits(x: f32) -> u32 {
    (x + 0.0).to_bits()
}

/// Whither a parameter goes: so that more lives, or less.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Way {
    More,
    Less,
}

/// What an edit may wake or end.
#[derive(Clone, Copy)]
enum Watched<'a> {
    /// A branch, or a shadow ray that was stopped, by its factors from the eye on.
    Branch(&'a [Factor]),
    /// A solid in front of a light, by its factor.
    Solid(Factor),
}

impl Watched<'_> {
    fn lives(self, values: &FactorValues) -> bool {
        match self {
            Watched::Branch(factors) => frontier_lives(factors, values),
            Watched::Solid(factor) => !values.value(factor).is_black(),
        }
    }
}

/// The search for the last step up to which everything lives that lives now, and nothing else.
struct Search<'a> {
    knob: Knob,
    way: Way,
    present: &'a Scene,
    scene: Scene,
    now: FactorValues,
    /// The best limit so far.
    best: u32,
    at_best: FactorValues,
}

impl<'a> Search<'a> {
    fn new(knob: Knob, way: Way, present: &'a Scene, last: u32) -> Search<'a> {
        let mut scene = present.clone();
        let at_best = knob.factors(&mut scene, present, way, last);
        let now = FactorValues::new(present);
        Search { knob, way, present, scene, now, best: last, at_best }
    }

    fn limit(mut self, session: &Session) -> u32 {
        if self.way == Way::More {
            for id in session.program.frontier() {
                self.look_at(session, id);
            }
        }
        if session.is_adaptive() {
            let depths = session.path_depths();
            for (id, node) in (0u32..).zip(session.transport.trie.nodes()).skip(1) {
                let (factor, depth) = (node.factor, depths[id as usize]);
                match factor.kind() {
                    kind if !is_seen(kind, depth) => {}
                    Kind::Shadow if self.knob.concerns(factor) => {
                        self.narrow(Watched::Solid(factor));
                    }
                    _ if factor.is_path() => self.look_at(session, id),
                    _ => {}
                }
            }
        }
        self.best
    }

    /// Narrows the limit to that of a branch of a term.
    fn look_at(&mut self, session: &Session, mut id: u32) {
        let nodes = session.transport.trie.nodes();
        let (mut factors, mut concerned) = (Vec::new(), false);
        while id != ROOT {
            let node = &nodes[id as usize];
            concerned |= self.knob.concerns(node.factor);
            factors.push(node.factor);
            id = node.parent;
        }
        if concerned {
            factors.reverse();
            self.narrow(Watched::Branch(&factors));
        }
    }

    /// Lowers the limit to the last step at which this lives as it does now, if it is lower.
    fn narrow(&mut self, watched: Watched) {
        let lives = watched.lives(&self.now);
        if watched.lives(&self.at_best) == lives {
            return;
        }
        let (mut same, mut other) = (0, self.best);
        while other - same > 1 {
            let middle = same + (other - same) / 2;
            let values = self.knob.factors(&mut self.scene, self.present, self.way, middle);
            match watched.lives(&values) == lives {
                true => same = middle,
                false => other = middle,
            }
        }
        self.best = same;
        self.at_best = self.knob.factors(&mut self.scene, self.present, self.way, same);
    }
}
