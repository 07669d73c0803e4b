//! Grows again the part of kept trees that a scope names, and leaves the rest alone.

use fearless_simd::{Simd, dispatch};
use glam::DVec3;

use super::grow::{Arrival, Grower, Limits, Stop, Worker, aimed, branch};
use super::kept::{KeptLight, KeptNode, KeptTrees, Recall, Recalled};
use super::pending::{Known, Pending, known};
use super::sampling::Sample;
use super::scope::{At, Scope};
use super::sequence::branch_path;
use super::shadow::Site;
use super::sink::{Side, Sink};
use super::tree::{BLOCKED, Branch, Ends, LightHit, Node, TileTrees, weights};
use crate::film::layout::{LANES, Place};
use crate::geometry::Tone;
use crate::progress::Progress;
use crate::scene::factor::{End, Factor, Kind, PathWeight};

/// Trees that are grown again in part.
#[derive(Default)]
pub struct Again {
    /// Of one block what is to be folded: the nodes on the way to the scope's terms, with the lights
    /// and branches that are in it. All else is left out, as if there were no such branch.
    pub grown: TileTrees,
    /// The whole new trees, block after block.
    pub kept: KeptTrees,
    /// Per node of `grown` its index in `kept`.
    places: Vec<u32>,
    /// Per light the key of its records.
    keys: Vec<u16>,
}

/// What becomes of a node's branch.
struct Next {
    /// In what is folded.
    folded: Branch,
    /// In what is kept.
    kept: Branch,
    /// How its ray goes on and where to, and where it stands in the scope.
    ray: Option<(PathWeight, DVec3, Known, At)>,
}

impl Again {
    /// Begins with trees of a tile of which nothing is there yet, in the memory of `kept`.
    pub fn begin(&mut self, mut kept: KeptTrees, keys: &[u16]) {
        kept.clear();
        self.kept = kept;
        self.keys.clear();
        self.keys.extend_from_slice(keys);
    }

    /// A node whose branches end differently in what is folded and in what is kept.
    fn part(&mut self, node: Node, kept: Ends) -> u32 {
        let name = self.node(node);
        self.last().ends = kept;
        name
    }

    /// In what is folded there is no such branch.
    fn leave_out(&mut self, branch: &Pending) {
        if let Some((node, side)) = branch.parent {
            let ends = &mut self.grown.nodes[node as usize].ends;
            *ends = ends.with(side, Branch::Absent);
        }
    }

    /// The node pushed last.
    fn last(&mut self) -> &mut KeptNode {
        self.kept.nodes.last_mut().expect("a node before its lights")
    }

    /// A light record of the last node that stays as it is. What stopped a shadow ray is folded again:
    /// it does not tell which light's.
    fn record(&mut self, light: u16, (record, crossings): (KeptLight, &[u32])) {
        self.kept.lights.push(record);
        self.kept.crossings.extend_from_slice(crossings);
        self.last().lights += 1;
        if record.crossed == BLOCKED {
            self.grown.light(LightHit::stopped(light), crossings);
        }
    }

    /// All light records of the last node stay as they are.
    fn records(&mut self, recalled: &Recalled) {
        let (lights, crossings) = recalled.records();
        self.kept.lights.extend_from_slice(lights);
        self.kept.crossings.extend_from_slice(crossings);
        self.last().lights = lights.len() as u16;
    }
}

impl Sink for Again {
    #[inline(always)]
    fn bytes(&self) -> usize {
        self.grown.bytes()
    }

    fn block(&mut self) {
        self.grown.clear();
        self.places.clear();
        self.grown.block();
    }

    fn weigh(&mut self, weight: f32) {
        self.grown.weigh(weight);
    }

    #[inline(always)]
    fn sample(&mut self, hit: bool) {
        self.grown.sample(hit);
    }

    #[inline(always)]
    fn node(&mut self, node: Node) -> u32 {
        self.places.push(self.kept.nodes.len() as u32);
        self.kept.nodes.push(KeptNode::of(&node));
        self.grown.node(node)
    }

    #[inline(always)]
    fn missed(&mut self, node: u32, side: Side) {
        self.grown.missed(node, side);
        let ends = &mut self.kept.nodes[self.places[node as usize] as usize].ends;
        *ends = ends.with(side, Branch::Missed);
    }

    #[inline(always)]
    fn tone(&mut self, tone: Tone) {
        self.grown.tone(tone);
    }

    #[inline(always)]
    fn sky(&mut self, tone: Tone) {
        self.grown.sky(tone);
    }

    #[inline(always)]
    fn light(&mut self, hit: LightHit, crossed: &[u32]) {
        let key = self.keys[hit.light as usize];
        self.kept.lights.push(KeptLight { key, crossed: hit.crossed });
        self.kept.crossings.extend_from_slice(crossed);
        self.last().lights += 1;
        self.grown.light(hit, crossed);
    }
}

impl Grower<'_> {
    /// Grows the part of a block's trees that `scope` names: into `sink.grown`, and, with all that
    /// stays as it is in `old`, at the end of `sink.kept`.
    ///
    /// What is grown is what [`Grower::block_again`] grows, as far as it belongs to a term of the scope.
    /// Every pixel has as many samples as it had.
    pub fn block_part(
        &self,
        worker: &mut Worker,
        (tile, block): (usize, usize),
        (old, scope): (&KeptTrees, &Scope),
        sink: &mut Again,
        most: usize,
        progress: &Progress,
    ) -> Result<(), Stop> {
        worker.pending.clear();
        let limits = Limits { most, progress };
        let mut kept = Some(old.recall(block));
        sink.block();
        for lane in 0..LANES {
            let place = Place { tile, block, lane };
            if self.layout.pixel(place).is_some() {
                let trees = (&mut kept, scope);
                dispatch!(self.level, simd => {
                    self.pixel_part(simd, worker, place, trees, sink, limits)
                })?;
            }
        }
        sink.kept.end_block_as(old, block);
        Ok(())
    }

    #[inline(always)]
    fn pixel_part<S: Simd>(
        &self,
        simd: S,
        worker: &mut Worker,
        place: Place,
        (trees, scope): (&mut Option<Recall<'_>>, &Scope),
        sink: &mut Again,
        limits: Limits,
    ) -> Result<(), Stop> {
        let pixel = self.layout.pixel(place).expect("a lane with a pixel");
        let count = self.count(place);
        let eye = self.pixel_eye(pixel, count);
        for index in 0..count {
            let at = Sample { pixel, index };
            // Weights stand beside all samples.
            let weighed = (!eye.is_plain()).then(|| self.eye_ray(eye, at, worker, sink));
            let kept = trees.as_mut().expect("kept trees");
            let hit = kept.sample();
            if hit && self.is_untouched(scope, Scope::EYE, kept.peek()) {
                kept.copy(&mut sink.kept);
                sink.sample(false);
                continue;
            }
            sink.sample(hit);
            if !hit {
                continue;
            }
            worker.media.clear();
            worker.sample = at;
            let ray = weighed.unwrap_or_else(|| self.eye_ray(eye, at, worker, sink));
            let medium = self.medium_of_eye(simd, worker, &ray);
            worker.pending.push(Pending::eye(ray, medium, Known::Hit, Scope::EYE));
            while let Some(next) = worker.pending.pop() {
                limits.check(sink)?;
                if next.scope == At::ALL {
                    self.follow_ray(simd, worker, &next, trees, sink)?;
                    continue;
                }
                let kept = trees.as_mut().expect("kept trees");
                if next.known == Known::Kept {
                    kept.copy(&mut sink.kept);
                } else if self.is_untouched(scope, next.scope, kept.peek()) {
                    kept.copy(&mut sink.kept);
                    sink.leave_out(&next);
                } else {
                    self.node_part(simd, worker, &next, (kept, scope), sink)?;
                }
            }
        }
        Ok(())
    }

    /// Whether nothing of a node and all below it is in the scope.
    #[inline(always)]
    fn is_untouched(&self, scope: &Scope, at: At, node: &KeptNode) -> bool {
        let [reflect, transmit] = self.states(scope, at, node);
        !scope.has_lights(at) && reflect == At::NONE && transmit == At::NONE
    }

    /// Where the mirror and the refracted ray of a node stand.
    #[inline(always)]
    fn states(&self, scope: &Scope, at: At, node: &KeptNode) -> [At; 2] {
        let material = self.geometry.material(node.primitive);
        let next = |kind| scope.next(at, Factor::new(kind, material, 0));
        match node.ends.total() {
            true => [next(Kind::TotalReflect), At::NONE],
            false => [next(Kind::Reflect), next(Kind::Transmit)],
        }
    }

    /// Grows what of a known node is in the scope, and queues its branches.
    #[inline(always)]
    fn node_part<S: Simd>(
        &self,
        simd: S,
        worker: &mut Worker,
        from: &Pending,
        (kept, scope): (&mut Recall<'_>, &Scope),
        sink: &mut Again,
    ) -> Result<(), Stop> {
        let recalled = kept.node();
        let KeptNode { t, primitive, lights: _, ends } = *recalled.node;
        let met = self.recall(simd, worker, from, recalled.node);
        let Arrival { at, length, tone, surface, crossing, touching, searched, eta: _ } =
            self.arrive(worker, from, met);
        let fresnel = self.reflectance(at.material, &surface);
        let [mirrored, passed] = weights(fresnel);
        let [to_mirrored, to_passed] = self.states(scope, from.scope, recalled.node);
        let mirror = if ends.total() { Kind::TotalReflect } else { Kind::Reflect };
        let ways = [false, true].map(|transmitted| branch_path(from.way, transmitted));
        let [gloss, translucency] = self.lobes[at.solid as usize];
        let (sample, up) = (worker.sample, surface.geometric);
        let reflected = self.next(
            from,
            (mirror, at.material, mirrored),
            (ends.reflected(), to_mirrored),
            || aimed(surface.reflect(), (gloss, up), sample, ways[0]),
        );
        // There is a ray: only a file can say of a total reflection that it is none.
        let sharp = || surface.refracted().unwrap_or(from.ray.direction);
        let transmitted = self.next(
            from,
            (Kind::Transmit, at.material, passed),
            (ends.transmitted(), to_passed),
            || aimed(sharp(), (translucency, -up), sample, ways[1]),
        );
        let of = |branch: fn(&Next) -> Branch| {
            Ends::new(branch(&reflected), branch(&transmitted), ends.total()).found(searched)
        };
        let (material, slot, lights) = (at.material, at.slot, 0);
        let (folded, toned) = (of(|next| next.folded), tone.is_some());
        let node = Node {
            t,
            primitive,
            material,
            lights,
            slot,
            whole: false,
            toned,
            ends: folded,
            fresnel,
        };
        let name = sink.part(node, of(|next| next.kept));
        if let Some(tone) = tone {
            sink.tone(tone);
        }
        if scope.has_lights(from.scope) {
            let media = [crossing.front, crossing.behind];
            let site = Site { at: &at, surface: &surface, path: from.way, media, touching };
            let mut recalled = Some(recalled);
            for light in 0..self.lamps.len() {
                if scope.has_light(light) {
                    self.light(simd, worker, &site, light, &mut recalled, sink)?;
                    continue;
                }
                let key = self.keys[light];
                while let Some(record) = recalled.as_mut().and_then(|r| r.record(key)) {
                    sink.record(light as u16, record);
                }
            }
        } else {
            sink.records(&recalled);
        }
        let spawn = |direction| {
            let (ray, leaving) = self.geometry.spawn(&at, direction);
            (ray, Some(leaving))
        };
        let mut queue = |next: Next, side, by: f32, medium| {
            let Some((path, direction, known, scope)) = next.ray else { return };
            let (ray, leaving) = match known {
                // The direction of a ray that is not followed is of no use.
                Known::Kept | Known::Dropped => (from.ray, None),
                _ => spawn(direction),
            };
            let way = ways[usize::from(side == Side::Transmitted)];
            let (parent, geometric) = (Some((name, side)), by * from.geometric);
            let next = Pending {
                ray,
                length,
                leaving,
                way,
                path,
                geometric,
                parent,
                medium,
                touching,
                known,
                scope,
            };
            worker.pending.push(next);
        };
        queue(transmitted, Side::Transmitted, passed, crossing.behind);
        queue(reflected, Side::Reflected, mirrored, crossing.front);
        Ok(())
    }

    /// What becomes of a branch that ended as `before` says and now stands at `to`; `aimed` gives the
    /// direction of its ray, if it has one.
    #[inline(always)]
    fn next(
        &self,
        from: &Pending,
        (kind, material, by): (Kind, u16, f32),
        (before, to): (Branch, At),
        aimed: impl Fn() -> Option<DVec3>,
    ) -> Next {
        let (grown, idle) = (before == Branch::Grown, from.ray.direction);
        if to == At::NONE {
            let ray = grown.then_some((from.path, idle, Known::Kept, to));
            return Next { folded: Branch::Absent, kept: before, ray };
        }
        let followed = self.follow(from, (kind, material), by * from.geometric);
        if to != At::ALL {
            // Whether it is alive today is not asked: what is kept of it stays.
            let ray = grown.then(|| {
                let path = followed.unwrap_or(from.path);
                (path, aimed().unwrap_or(idle), Known::Hit, to)
            });
            let folded = if grown { Branch::Grown } else { Branch::Absent };
            return Next { folded, kept: before, ray };
        }
        let followed = followed.and_then(|path| Ok((path, aimed().ok_or(End::Astray)?)));
        let end = branch(&followed);
        let ray = match (followed, known(Some(before), true, followed.is_ok())) {
            (Ok((path, direction)), known) => Some((path, direction, known, to)),
            (Err(_), Known::Dropped) => Some((from.path, idle, Known::Dropped, to)),
            _ => None,
        };
        Next { folded: end, kept: end, ray }
    }
}
