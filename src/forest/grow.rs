//! The tracer: grows the ray tree of every sample and hands it, node by node, to a sink.

use fearless_simd::{Level, Simd, dispatch};
use glam::DVec3;

use super::camera::View;
use super::cone::Cone;
use super::counts::SampleMap;
use super::eye::Eye;
use super::kept::{Recall, Recalled, Recalls};
use super::lamp::Lamp;
use super::media::{Crossing, Media};
use super::pending::{Known, Pending, known};
pub use super::rays::RayCounts;
use super::sampling::{Effect, Sample};
use super::scope::At;
use super::search::{Met, Steps};
use super::sequence::branch_path;
use super::shadow::Site;
use super::sink::{Side, Sink};
use super::surface::Surface;
use super::tree::{BEHIND, Branch, Ends, NO_FRESNEL, Node, weights};
use super::{Before, blur};
use crate::film::layout::{LANES, Layout, Place};
use crate::geometry::{Geometry, Interaction, Ray, Stack, Tone};
use crate::progress::{Cancelled, Progress};
use crate::scene::factor::{End, Factor, FactorValues, Kind, PathWeight};
use crate::scene::model::{Lobes, Model};
use crate::scene::{Material, Scene};

/// Why growing stopped before its end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stop {
    /// It was cancelled.
    Cancelled,
    /// A shadow ray crosses more than [`MOST_CROSSED`] transparent surfaces.
    Surfaces,
    /// The sink holds more than it may.
    Branches,
}

impl From<Cancelled> for Stop {
    fn from(_: Cancelled) -> Stop {
        Stop::Cancelled
    }
}

/// Transparent surfaces that a shadow ray may cross.
pub const MOST_CROSSED: usize = BEHIND as usize - 1;

/// All that tracing reads, made once per trace and shared by its workers.
pub struct Grower<'a> {
    pub(super) geometry: &'a Geometry,
    values: FactorValues,
    /// Per solid.
    pub(super) opaque: Vec<bool>,
    pub(super) lamps: Vec<Lamp>,
    /// Per light the key of its records in kept trees.
    pub(super) keys: Vec<u16>,
    /// Per solid.
    iors: Vec<f64>,
    /// Per solid.
    pub(super) lobes: Vec<Lobes>,
    pub(super) models: Vec<Model>,
    /// Per solid its priority where solids overlap; empty if all have the same.
    pub(super) priorities: Vec<u32>,
    pub(super) least_priority: u32,
    /// Per solid whether it lets light through.
    pub(super) clear: Vec<bool>,
    /// Whether the eye may be in something clear.
    pub(super) surrounded: bool,
    /// Per material, whether Fresnel weighs its branches.
    weighing: Vec<bool>,
    /// With what the kept trees were grown.
    before: Before,
    /// Per solid whether rays go on from it elsewhere than in the kept trees; empty: nowhere.
    bent: Vec<bool>,
    pub(super) cone: Cone,
    pub(super) view: View,
    /// Of a scene whose camera rays are not only the pinhole's within their pixels.
    pub(super) eye: Option<Eye>,
    pub(super) layout: Layout,
    pub(super) samples: u32,
    /// Where sampling is adaptive, the pixels' own numbers of samples.
    pub(super) map: Option<&'a SampleMap>,
    pub(super) level: Level,
}

/// What one thread needs while tracing.
pub struct Worker {
    pub(super) stack: Stack,
    pub(super) pending: Vec<Pending>,
    pub(super) crossed: Vec<u32>,
    pub(super) media: Media,
    pub(super) steps: Steps,
    /// The one that is grown.
    pub(super) sample: Sample,
    /// Rays that this worker cast: what kept trees answer is not cast.
    pub rays: RayCounts,
}

/// A surface as a ray meets it, and the media on both sides.
pub(super) struct Arrival {
    pub(super) at: Interaction,
    /// Of the path from the eye.
    pub(super) length: f64,
    pub(super) tone: Option<Tone>,
    pub(super) surface: Surface,
    pub(super) crossing: Crossing,
    /// Whether other surfaces coincide with it.
    pub(super) touching: bool,
    /// Whether all crossings of the ray were looked at.
    pub(super) searched: bool,
    /// Index of refraction in front over that behind.
    pub(super) eta: f64,
}

/// When to stop.
#[derive(Clone, Copy)]
pub(super) struct Limits<'a> {
    pub(super) most: usize,
    pub(super) progress: &'a Progress,
}

impl Limits<'_> {
    /// Asked before every ray.
    #[inline(always)]
    pub(super) fn check(self, sink: &impl Sink) -> Result<(), Stop> {
        self.progress.check()?;
        if sink.bytes() > self.most { Err(Stop::Branches) } else { Ok(()) }
    }
}

impl<'a> Grower<'a> {
    /// Prepares to trace `scene`, of which `geometry` was built.
    pub fn new(scene: &Scene, geometry: &'a Geometry) -> Grower<'a> {
        let keys = (0..).take(scene.lights.len()).collect();
        Grower::recalling(scene, geometry, keys, &Before::of(scene, geometry))
    }

    /// The same, where kept trees may answer in place of rays: `keys` are the keys of the lights'
    /// records in them, and `before` tells with what they were grown.
    ///
    /// Kept trees answer for the same ray, found by the same path through the same media; a shadow
    /// ray's answer stands as long as its blocker is opaque.
    pub fn recalling(
        scene: &Scene,
        geometry: &'a Geometry,
        keys: Vec<u16>,
        before: &Before,
    ) -> Grower<'a> {
        let values = FactorValues::new(scene);
        let Before { iors, lobes } = Before::of(scene, geometry);
        let priorities: Vec<u32> = scene.materials.iter().map(|m| m.priority).collect();
        let priorities = geometry.of_solids(&priorities);
        let least_priority = priorities.iter().copied().min().unwrap_or(0);
        let same = priorities.iter().all(|priority| *priority == least_priority);
        let clear: Vec<bool> = scene.materials.iter().map(|m| !m.transmit.is_black()).collect();
        Grower {
            geometry,
            priorities: if same { Vec::new() } else { priorities },
            least_priority,
            clear: geometry.of_solids(&clear),
            surrounded: !scene.clear_around_the_eye().is_empty(),
            opaque: geometry.of_solids(&values.opaque()),
            values,
            lamps: scene.lights.iter().map(Lamp::new).collect(),
            models: scene.materials.iter().map(|m| m.model).collect(),
            weighing: scene.materials.iter().map(Material::weighs_branches).collect(),
            keys,
            iors,
            lobes,
            before: before.clone(),
            bent: Vec::new(),
            cone: Cone::new(&scene.camera, scene.picture.size),
            view: View::new(&scene.camera, scene.picture.size),
            eye: Eye::of(scene),
            layout: Layout::new(scene.picture.size),
            samples: scene.trace.samples,
            map: None,
            level: geometry.level(),
        }
    }

    /// The same, where the solids that `bent` names had another bump when the kept trees were grown: no
    /// kept ray goes on from them.
    pub fn with_bent(mut self, bent: Vec<bool>) -> Grower<'a> {
        self.bent = bent;
        self
    }

    /// Per light the key of its records in kept trees.
    pub fn keys(&self) -> &[u16] {
        &self.keys
    }

    /// Scratch for one thread.
    pub fn worker(&self) -> Worker {
        Worker {
            stack: Stack::new(self.geometry),
            pending: Vec::new(),
            crossed: Vec::new(),
            media: Media::new(&self.priorities),
            steps: Steps::default(),
            sample: Sample { pixel: [0, 0], index: 0 },
            rays: RayCounts::default(),
        }
    }

    /// Grows the trees of the 16 pixels of one block, unless `sink` comes to hold more than `most`
    /// bytes. A cancel is obeyed at the next node.
    pub fn block<K: Sink>(
        &self,
        worker: &mut Worker,
        at: (usize, usize),
        sink: &mut K,
        most: usize,
        progress: &Progress,
    ) -> Result<(), Stop> {
        self.block_again(worker, at, Recalls::default(), sink, most, progress)
    }

    /// The same from kept trees of the block, if there are any: only rays of which they know
    /// nothing are cast. Gives what [`Grower::block`] gives.
    pub fn block_again<'k, K: Sink>(
        &self,
        worker: &mut Worker,
        (tile, block): (usize, usize),
        kept: impl Into<Recalls<'k>>,
        sink: &mut K,
        most: usize,
        progress: &Progress,
    ) -> Result<(), Stop> {
        worker.pending.clear();
        let limits = Limits { most, progress };
        let mut kept = kept.into();
        sink.block();
        for lane in 0..LANES {
            let place = Place { tile, block, lane };
            if self.layout.pixel(place).is_some() {
                let kept = &mut kept;
                dispatch!(self.level, simd => self.pixel(simd, worker, place, kept, sink, limits))?;
            }
        }
        Ok(())
    }

    #[inline(always)]
    pub(super) fn pixel<S: Simd, K: Sink>(
        &self,
        simd: S,
        worker: &mut Worker,
        place: Place,
        Recalls { first, rest }: &mut Recalls<'_>,
        sink: &mut K,
        limits: Limits,
    ) -> Result<(), Stop> {
        let pixel = self.layout.pixel(place).expect("a lane with a pixel");
        let count = self.count(place);
        let known = |kept: &Option<Recall>| {
            kept.as_ref().map_or(0, |kept| kept.count(place.lane).unwrap_or(self.samples))
        };
        let (at_first, known) = (known(first), known(rest));
        let skip = |rest: &mut Option<Recall>, samples: std::ops::Range<u32>| {
            samples.for_each(|_| rest.iter_mut().for_each(Recall::skip_sample));
        };
        skip(rest, 0..at_first.min(known));
        let eye = self.pixel_eye(pixel, count);
        for index in 0..count {
            worker.sample = Sample { pixel, index };
            let ray = self.eye_ray(eye, worker.sample, worker, sink);
            let kept = match index {
                index if index < at_first => &mut *first,
                index if index < known => &mut *rest,
                _ => &mut None,
            };
            self.sample(simd, worker, ray, kept, sink, limits)?;
        }
        skip(first, count..at_first);
        skip(rest, count.max(at_first)..known);
        Ok(())
    }

    /// Follows one camera ray to all its ends.
    #[inline(always)]
    fn sample<S: Simd, K: Sink>(
        &self,
        simd: S,
        worker: &mut Worker,
        ray: Ray,
        kept: &mut Option<Recall<'_>>,
        sink: &mut K,
        limits: Limits,
    ) -> Result<(), Stop> {
        worker.media.clear();
        let known = match kept.as_mut().map(Recall::sample) {
            None => Known::Nothing,
            Some(true) => Known::Hit,
            Some(false) => Known::Missed,
        };
        let medium = self.medium_of_eye(simd, worker, &ray);
        worker.pending.push(Pending::eye(ray, medium, known, At::ALL));
        while let Some(next) = worker.pending.pop() {
            limits.check(sink)?;
            self.follow_ray(simd, worker, &next, kept, sink)?;
        }
        Ok(())
    }

    /// Grows the node that a ray meets, if it meets any.
    #[inline(always)]
    pub(super) fn follow_ray<S: Simd, K: Sink>(
        &self,
        simd: S,
        worker: &mut Worker,
        next: &Pending,
        kept: &mut Option<Recall<'_>>,
        sink: &mut K,
    ) -> Result<(), Stop> {
        if let (Known::Another | Known::Dropped, Some(kept)) = (next.known, kept.as_mut()) {
            kept.skip();
        }
        let recalled = match next.known {
            Known::Dropped => return Ok(()),
            Known::Hit => kept.as_mut().map(Recall::node),
            _ => None,
        };
        let met = match (recalled, next.known) {
            (Some(r), _) => Some(self.recall(simd, worker, next, r.node)),
            (None, Known::Missed) => None,
            (None, _) => {
                worker.rays.count(next.parent.map(|(_, side)| side));
                self.meet(simd, worker, next)
            }
        };
        match (met, next.parent) {
            (Some(met), parent) => {
                if parent.is_none() {
                    sink.sample(true);
                }
                self.node(simd, worker, next, (met, recalled), sink)?;
            }
            (None, Some((node, side))) => sink.missed(node, side),
            (None, None) => sink.sample(false),
        }
        if met.is_none() {
            self.sky(&next.ray, sink);
        }
        Ok(())
    }

    /// What a ray finds where it meets a surface.
    #[inline(always)]
    pub(super) fn arrive(&self, worker: &mut Worker, from: &Pending, met: Met) -> Arrival {
        let Met { hit, found } = met;
        let at = self.geometry.interaction(&worker.stack, &from.ray, hit);
        let length = from.length + hit.t;
        let (at, tone) = self.tone(&worker.stack, at, length);
        let mut surface = Surface::new(&at, from.ray.direction);
        let crossing = match found {
            None => worker.media.cross(from.medium, &at, surface.entering),
            Some(found) => worker.media.between(found.media, &at, surface.entering),
        };
        worker.rays.lost += u64::from(crossing.lost);
        let eta = crossing.eta(&self.iors);
        surface.between(eta, crossing.contrast(&self.iors));
        let touching = found.is_some_and(|found| found.touching);
        let searched = found.is_some();
        Arrival { at, length, tone, surface, crossing, touching, searched, eta }
    }

    /// Stores a node, asks its lights, and queues its branches.
    #[inline(always)]
    fn node<S: Simd, K: Sink>(
        &self,
        simd: S,
        worker: &mut Worker,
        from: &Pending,
        (met, mut recalled): (Met, Option<Recalled<'_>>),
        sink: &mut K,
    ) -> Result<(), Stop> {
        let hit = met.hit;
        let Arrival { at, length, tone, surface, crossing, touching, searched, eta } =
            self.arrive(worker, from, met);
        let fresnel = self.reflectance(at.material, &surface);
        let by = weights(fresnel);
        let Branches { followed, directions } =
            self.branches(worker.sample, from, (&at, &surface), by);
        let total = surface.is_total();
        let [reflected, transmitted] = followed.each_ref().map(branch);
        let transmitted = if total { Branch::Absent } else { transmitted };
        let ends = Ends::new(reflected, transmitted, total).found(searched);
        let (material, slot) = (at.material, at.slot);
        let node = Node {
            t: hit.t,
            primitive: hit.primitive,
            material,
            lights: 0,
            slot,
            whole: true,
            toned: tone.is_some(),
            ends,
            fresnel,
        };
        let name = sink.node(node);
        sink.point(at.point);
        if let Some(tone) = tone {
            sink.tone(tone);
        }
        let media = [crossing.front, crossing.behind];
        let site = Site { at: &at, surface: &surface, path: from.way, media, touching };
        for light in 0..self.lamps.len() {
            self.light(simd, worker, &site, light, &mut recalled, sink)?;
        }
        let known = match recalled {
            None => [Known::Nothing; 2],
            Some(recalled) => {
                let same = match recalled.current {
                    true => [true; 2],
                    false => self.same_rays(at.solid as usize, &crossing, eta),
                };
                let ends = recalled.node.ends;
                let known = |before, same, i: usize| known(Some(before), same, followed[i].is_ok());
                [known(ends.reflected(), same[0], 0), known(ends.transmitted(), same[1], 1)]
            }
        };
        let mut queue = |i: usize, side, direction: DVec3, medium| {
            // The ray of what is not followed is of no use.
            let (path, ray, leaving) = match followed[i] {
                Ok(path) => {
                    let (ray, leaving) = self.geometry.spawn(&at, direction);
                    (path, ray, Some(leaving))
                }
                Err(_) if known[i] == Known::Dropped => (from.path, from.ray, None),
                Err(_) => return,
            };
            let next = Pending {
                ray,
                length,
                leaving,
                way: branch_path(from.way, side == Side::Transmitted),
                path,
                geometric: by[i] * from.geometric,
                parent: Some((name, side)),
                medium,
                touching,
                known: known[i],
                scope: At::ALL,
            };
            worker.pending.push(next);
        };
        let [mirror, through] = directions;
        let through = through.unwrap_or(from.ray.direction);
        queue(1, Side::Transmitted, through, crossing.behind);
        let mirror = match followed[0] {
            Ok(_) => mirror.unwrap_or_else(|| surface.reflect()),
            Err(_) => from.ray.direction,
        };
        queue(0, Side::Reflected, mirror, crossing.front);
        Ok(())
    }

    /// Which branches of a node are followed, and where to.
    #[inline(always)]
    fn branches(
        &self,
        sample: Sample,
        from: &Pending,
        (at, surface): (&Interaction, &Surface),
        [mirrored, passed]: [f32; 2],
    ) -> Branches {
        let follow = |kind, by: f32| self.follow(from, (kind, at.material), by * from.geometric);
        let mut followed = match surface.is_total() {
            true => [follow(Kind::TotalReflect, mirrored), Err(End::Zero)],
            false => [follow(Kind::Reflect, mirrored), follow(Kind::Transmit, passed)],
        };
        let through = if followed[1].is_ok() { surface.refracted() } else { None };
        let mut directions = [None, through];
        let lobes = self.lobes[at.solid as usize];
        if lobes != SHARP {
            let (up, sharp) = (surface.geometric, [Some(surface.reflect()), through]);
            for (i, (up, transmitted)) in [(up, false), (-up, true)].into_iter().enumerate() {
                if followed[i].is_ok() {
                    let way = branch_path(from.way, transmitted);
                    directions[i] = sharp[i].and_then(|d| aimed(d, (lobes[i], up), sample, way));
                    if directions[i].is_none() {
                        followed[i] = Err(End::Astray);
                    }
                }
            }
        }
        Branches { followed, directions }
    }

    /// Whether mirror and refracted ray of a node leave as they did in the kept trees, in front of which
    /// the same ray arrived.
    #[inline(always)]
    fn same_rays(&self, solid: usize, crossing: &Crossing, eta: f64) -> [bool; 2] {
        let straight = !self.bent.get(solid).is_some_and(|bent| *bent);
        let [mirror, through] =
            [0, 1].map(|i| straight && self.before.lobes[solid][i] == self.lobes[solid][i]);
        [mirror, through && crossing.eta(&self.before.iors) == eta]
    }

    /// Fresnel's reflectance, or [`NO_FRESNEL`] of a material whose branches it does not weigh.
    #[inline(always)]
    pub(super) fn reflectance(&self, material: u16, surface: &Surface) -> f32 {
        match self.weighing[material as usize] {
            true => surface.reflectance() as f32,
            false => NO_FRESNEL,
        }
    }

    /// The rule of liveness for a branch of this geometric weight.
    #[inline(always)]
    pub(super) fn follow(
        &self,
        from: &Pending,
        (kind, material): (Kind, u16),
        geometric: f32,
    ) -> Result<PathWeight, End> {
        if self.values.faint(geometric) {
            return Err(End::Faint);
        }
        self.values.follow(from.path, Factor::new(kind, material, 0))
    }
}

/// The lobes of a material that does not blur.
const SHARP: Lobes = [0.0; 2];

/// The mirror and the refracted branch of a node.
struct Branches {
    /// Their weights, if they are followed.
    followed: [Result<PathWeight, End>; 2],
    /// Where they go, if they are followed: the mirror ray's is known only of what blurs.
    directions: [Option<DVec3>; 2],
}

/// The direction of a branch: the sharp one, or, with an exponent above 0, one drawn from the lobe
/// around it; `None` if that is not on the side of `up`.
#[inline(always)]
pub(super) fn aimed(
    sharp: DVec3,
    (exponent, up): (f32, DVec3),
    sample: Sample,
    way: u32,
) -> Option<DVec3> {
    match exponent == 0.0 {
        true => Some(sharp),
        false => blur::drawn_above(sharp, (exponent, up), sample.numbers(Effect::Gloss, way)),
    }
}

pub(super) fn branch<T>(followed: &Result<T, End>) -> Branch {
    match followed {
        Ok(_) => Branch::Grown,
        Err(End::Zero) => Branch::Zero,
        Err(End::Weight) => Branch::Weight,
        Err(End::Depth) => Branch::Depth,
        Err(End::Faint) => Branch::Faint,
        Err(End::Astray) => Branch::Astray,
    }
}
