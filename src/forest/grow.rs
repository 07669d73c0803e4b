//! The tracer: grows the ray tree of every sample and hands it, node by node, to a sink.

use fearless_simd::{Level, Simd, dispatch};
use glam::DVec3;

use super::camera::View;
use super::counts::SampleMap;
use super::eye::Eye;
use super::kept::{Met, Recall, Recalled};
use super::lobe::{self, Lit, Lobe};
use super::media::{Crossing, Media};
pub use super::rays::RayCounts;
use super::sampling::Sample;
use super::scope::At;
use super::sink::{Side, Sink};
use super::surface::Surface;
use super::tree::{BLOCKED, Branch, Ends, LightHit, NO_FRESNEL, Node, weights};
use crate::film::layout::{LANES, Layout, Place};
use crate::geometry::{Geometry, Hit, Interaction, Leaving, Ray, Stack};
use crate::progress::{Cancelled, Progress};
use crate::scene::factor::{End, Factor, FactorValues, Kind, PathWeight};
use crate::scene::model::Model;
use crate::scene::{LightPlace, Material, Scene};

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
pub const MOST_CROSSED: usize = BLOCKED as usize - 1;

/// All that tracing reads, made once per trace and shared by its workers.
pub struct Grower<'a> {
    pub(super) geometry: &'a Geometry,
    values: FactorValues,
    /// Per solid.
    pub(super) opaque: Vec<bool>,
    /// Directions are of length 1.
    pub(super) lights: Vec<LightPlace>,
    /// Per light the key of its records in kept trees.
    pub(super) keys: Vec<u16>,
    /// Per solid.
    iors: Vec<f64>,
    models: Vec<Model>,
    /// Per material, whether Fresnel weighs its branches.
    weighing: Vec<bool>,
    /// Per solid the index of refraction with which the kept trees were grown.
    iors_before: Vec<f64>,
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
    crossed: Vec<u32>,
    pub(super) media: Media,
    /// Rays that this worker cast: what kept trees answer is not cast.
    pub rays: RayCounts,
}

/// A surface as a ray meets it, and the media on both sides.
pub(super) struct Arrival {
    pub(super) at: Interaction,
    pub(super) surface: Surface,
    pub(super) crossing: Crossing,
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

/// A ray still to be followed.
pub(super) struct Pending {
    pub(super) ray: Ray,
    pub(super) leaving: Option<Leaving>,
    pub(super) path: PathWeight,
    /// Product of Fresnel's reflectances on the path.
    pub(super) geometric: f32,
    pub(super) parent: Option<(u32, Side)>,
    pub(super) medium: u32,
    pub(super) known: Known,
    /// Where it stands in the scope: only what a [scope](super::scope::Scope) names is grown.
    pub(super) scope: At,
}

impl Pending {
    /// A ray from the eye.
    #[inline(always)]
    pub(super) fn eye(ray: Ray, known: Known, scope: At) -> Pending {
        Pending {
            ray,
            leaving: None,
            path: PathWeight::EYE,
            geometric: 1.0,
            parent: None,
            medium: Media::OUTSIDE,
            known,
            scope,
        }
    }
}

/// What kept trees know of a ray.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Known {
    /// Nothing: it is cast.
    Nothing,
    /// Its node is the next one of the kept trees.
    Hit,
    /// It left the scene.
    Missed,
    /// Nothing, but the next node of the kept trees, and all below it, is of no use: in its place
    /// stood another ray.
    Another,
    /// It is followed no longer: the next node, and all below it, is of no use.
    Dropped,
    /// Its node is the next one, and it and all below it stay as they are.
    Kept,
}

/// What kept trees know of the rays of a node's branch, in front of which the same ray arrived. `ray`
/// says whether the branch's ray is the same too, `followed` whether it is wanted.
pub(super) fn known(before: Option<Branch>, ray: bool, followed: bool) -> Known {
    match before {
        Some(Branch::Grown) if !followed => Known::Dropped,
        Some(Branch::Grown) if ray => Known::Hit,
        Some(Branch::Grown) => Known::Another,
        Some(Branch::Missed) if ray => Known::Missed,
        _ => Known::Nothing,
    }
}

impl<'a> Grower<'a> {
    /// Prepares to trace `scene`, of which `geometry` was built.
    pub fn new(scene: &Scene, geometry: &'a Geometry) -> Grower<'a> {
        let keys = (0..).take(scene.lights.len()).collect();
        let iors: Vec<f64> = scene.materials.iter().map(|m| m.ior).collect();
        Grower::recalling(scene, geometry, keys, &geometry.of_solids(&iors))
    }

    /// The same, where kept trees may answer in place of rays: `keys` are the keys of the lights'
    /// records in them, and `iors_before` has for every solid the index of refraction with which
    /// they were grown.
    ///
    /// Kept trees answer for the same ray, found by the same path through the same media; a shadow
    /// ray's answer stands as long as its blocker is opaque.
    pub fn recalling(
        scene: &Scene,
        geometry: &'a Geometry,
        keys: Vec<u16>,
        iors_before: &[f64],
    ) -> Grower<'a> {
        let values = FactorValues::new(scene);
        let iors: Vec<f64> = scene.materials.iter().map(|m| m.ior).collect();
        Grower {
            geometry,
            opaque: geometry.of_solids(&values.opaque()),
            values,
            lights: scene.lights.iter().map(|l| with_unit_direction(&l.place)).collect(),
            models: scene.materials.iter().map(|m| m.model).collect(),
            weighing: scene.materials.iter().map(Material::weighs_branches).collect(),
            keys,
            iors: geometry.of_solids(&iors),
            iors_before: iors_before.to_vec(),
            view: View::new(&scene.camera, scene.picture.size),
            eye: Eye::of(scene),
            layout: Layout::new(scene.picture.size),
            samples: scene.trace.samples,
            map: None,
            level: Level::new(),
        }
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
            media: Media::default(),
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
        self.block_again(worker, at, None, sink, most, progress)
    }

    /// The same from kept trees of the block, if there are any: only rays of which they know
    /// nothing are cast. Gives what [`Grower::block`] gives.
    pub fn block_again<K: Sink>(
        &self,
        worker: &mut Worker,
        (tile, block): (usize, usize),
        mut kept: Option<Recall<'_>>,
        sink: &mut K,
        most: usize,
        progress: &Progress,
    ) -> Result<(), Stop> {
        worker.pending.clear();
        let limits = Limits { most, progress };
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
    fn pixel<S: Simd, K: Sink>(
        &self,
        simd: S,
        worker: &mut Worker,
        place: Place,
        kept: &mut Option<Recall<'_>>,
        sink: &mut K,
        limits: Limits,
    ) -> Result<(), Stop> {
        let pixel = self.layout.pixel(place).expect("a lane with a pixel");
        let count = self.map.map_or(self.samples, |map| map.of(place));
        let known = kept.as_ref().map_or(0, |kept| kept.count(place.lane).unwrap_or(self.samples));
        let eye = self.pixel_eye(pixel, count);
        for index in 0..count {
            let ray = self.eye_ray(eye, Sample { pixel, index }, worker, sink);
            let kept = if index < known { &mut *kept } else { &mut None };
            self.sample(simd, worker, ray, kept, sink, limits)?;
        }
        for _ in count..known {
            if let Some(kept) = kept.as_mut()
                && kept.sample()
            {
                kept.skip();
            }
        }
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
        worker.pending.push(Pending::eye(ray, known, At::ALL));
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
        let hit = match (recalled, next.known) {
            (Some(r), _) => Some(Hit { t: r.node.t, primitive: r.node.primitive }),
            (None, Known::Missed) => None,
            (None, _) => {
                worker.rays.count(next.parent.map(|(_, side)| side));
                self.geometry.closest_hit(simd, &mut worker.stack, &next.ray, next.leaving)
            }
        };
        match (hit, next.parent) {
            (Some(hit), parent) => {
                if parent.is_none() {
                    sink.sample(true);
                }
                self.node(simd, worker, next, (hit, recalled), sink)?;
            }
            (None, Some((node, side))) => sink.missed(node, side),
            (None, None) => sink.sample(false),
        }
        Ok(())
    }

    /// What a ray finds where it meets a surface.
    #[inline(always)]
    pub(super) fn arrive(&self, worker: &mut Worker, from: &Pending, hit: Hit) -> Arrival {
        let at = self.geometry.interaction(&worker.stack, &from.ray, hit);
        let mut surface = Surface::new(&at, from.ray.direction);
        let crossing = worker.media.cross(from.medium, &at, surface.entering);
        let eta = crossing.eta(&self.iors);
        let refracted = surface.refract(eta);
        (surface.contrast, surface.refracted) = (crossing.contrast(&self.iors), refracted);
        Arrival { at, surface, crossing, eta }
    }

    /// Stores a node, asks its lights, and queues its branches.
    #[inline(always)]
    fn node<S: Simd, K: Sink>(
        &self,
        simd: S,
        worker: &mut Worker,
        from: &Pending,
        (hit, mut recalled): (Hit, Option<Recalled<'_>>),
        sink: &mut K,
    ) -> Result<(), Stop> {
        let Arrival { at, surface, crossing, eta } = self.arrive(worker, from, hit);
        let refracted = surface.refracted;
        let total = refracted.is_none();
        let fresnel = self.reflectance(at.material, &surface);
        let [mirrored, passed] = weights(fresnel);
        let follow = |kind, by: f32| self.follow(from, (kind, at.material), by * from.geometric);
        let reflected = follow(if total { Kind::TotalReflect } else { Kind::Reflect }, mirrored);
        let transmitted = (!total).then(|| follow(Kind::Transmit, passed));
        let ends = Ends::new(branch(reflected), transmitted.map_or(Branch::Absent, branch), total);
        let (material, slot) = (at.material, at.slot);
        let node = Node {
            t: hit.t,
            primitive: hit.primitive,
            material,
            lights: 0,
            slot,
            whole: true,
            ends,
            fresnel,
        };
        let name = sink.node(node);
        for (light, place) in self.lights.iter().enumerate() {
            let light = (light as u16, place);
            let met = recalled.as_mut().and_then(|r| r.light(self.keys[light.0 as usize]));
            self.light(simd, worker, (&at, &surface), light, met, sink)?;
        }
        let ends = recalled.map(|r| r.node.ends);
        let mut queue = |direction, (path, by): (PathWeight, f32), side, medium, known| {
            let (ray, leaving) = match known {
                // The direction of a ray that is not followed is of no use.
                Known::Dropped => (from.ray, None),
                _ => {
                    let (ray, leaving) = self.geometry.spawn(&at, direction);
                    (ray, Some(leaving))
                }
            };
            let (parent, geometric) = (Some((name, side)), by * from.geometric);
            let scope = At::ALL;
            worker.pending.push(Pending {
                ray,
                leaving,
                path,
                geometric,
                parent,
                medium,
                known,
                scope,
            });
        };
        let same = ends.is_some() && self.refracts_as_before(&crossing, eta);
        let through = transmitted.and_then(Result::ok).zip(refracted);
        match (through, known(ends.map(Ends::transmitted), same, through.is_some())) {
            (Some((path, direction)), known) => {
                queue(direction, (path, passed), Side::Transmitted, crossing.behind, known);
            }
            (None, Known::Dropped) => {
                queue(at.point, (from.path, 0.0), Side::Transmitted, from.medium, Known::Dropped);
            }
            _ => {}
        }
        match (reflected, known(ends.map(Ends::reflected), true, reflected.is_ok())) {
            (Ok(path), known) => {
                queue(surface.reflect(), (path, mirrored), Side::Reflected, from.medium, known);
            }
            (Err(_), Known::Dropped) => {
                queue(at.point, (from.path, 0.0), Side::Reflected, from.medium, Known::Dropped);
            }
            _ => {}
        }
        Ok(())
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

    /// What a light that shines onto the surface from behind shows of itself: none without Hall.
    #[inline(always)]
    fn behind(&self, material: u16, surface: &Surface, to_light: DVec3) -> Lobe {
        match (self.models[material as usize], surface.refracted) {
            (Model::Hall, Some(through)) if surface.geometric.dot(to_light) < 0.0 => {
                lobe::transmitted(through, to_light, surface.reflectance())
            }
            _ => Lobe::NONE,
        }
    }

    /// Whether a surface bends rays as it did in the kept trees.
    #[inline(always)]
    fn refracts_as_before(&self, crossing: &Crossing, eta: f64) -> bool {
        crossing.eta(&self.iors_before) == eta
    }

    /// Sends a shadow ray to a light in front of the geometric surface, and to one that shines
    /// through it, unless `met` still stands. Where nothing passes, the surface's own solid is what
    /// stops the latter.
    #[inline(always)]
    pub(super) fn light<S: Simd, K: Sink>(
        &self,
        simd: S,
        worker: &mut Worker,
        (at, surface): (&Interaction, &Surface),
        (light, place): (u16, &LightPlace),
        met: Option<Met<'_>>,
        sink: &mut K,
    ) -> Result<(), Stop> {
        let to_light = match place {
            LightPlace::Point(p) => (*p - at.point).normalize_or_zero(),
            LightPlace::Direction(d) => -*d,
        };
        let front = surface.geometric.dot(to_light) > 0.0;
        let behind = if front { Lobe::NONE } else { self.behind(at.material, surface, to_light) };
        if !front && behind == Lobe::NONE {
            return Ok(());
        }
        let stopped = LightHit::stopped(light);
        if !front && self.opaque[at.solid as usize] {
            sink.light(stopped, &[at.solid]);
            return Ok(());
        }
        let blocker = match met {
            Some(Met::Blocker(solid)) if self.opaque[solid as usize] => Some(solid),
            Some(Met::Crossed(solids)) => {
                worker.crossed.clear();
                worker.crossed.extend_from_slice(solids);
                None
            }
            _ => self.cast_shadow(simd, worker, at, to_light, place),
        };
        if let Some(solid) = blocker {
            sink.light(stopped, &[solid]);
            return Ok(());
        }
        let crossed = &mut worker.crossed;
        if crossed.len() > MOST_CROSSED {
            return Err(Stop::Surfaces);
        }
        crossed.sort_unstable();
        let (n_dot_l, Lobe { angle, weight }) = if front {
            let lit = Lit { normal: surface.normal, to_eye: surface.to_eye, to_light };
            let model = self.models[at.material as usize];
            let lobe = lobe::highlight(model, &lit, surface.contrast);
            (surface.normal.dot(to_light) as f32, lobe)
        } else {
            (0.0, behind)
        };
        let crossings = crossed.len() as u16;
        sink.light(LightHit { light, crossed: crossings, n_dot_l, angle, weight }, crossed);
        Ok(())
    }

    /// The opaque solid between a point and a light, or, if there is none, all solids crossed, in
    /// `worker.crossed`.
    #[inline(always)]
    fn cast_shadow<S: Simd>(
        &self,
        simd: S,
        worker: &mut Worker,
        at: &Interaction,
        to_light: DVec3,
        place: &LightPlace,
    ) -> Option<u32> {
        worker.rays.shadow += 1;
        let (ray, leaving) = self.geometry.spawn(at, to_light);
        let t_max = match place {
            LightPlace::Point(p) => (*p - ray.origin).length(),
            LightPlace::Direction(_) => f64::INFINITY,
        };
        let Worker { stack, crossed, .. } = worker;
        self.geometry.occluded(simd, stack, &ray, t_max, Some(leaving), &self.opaque, crossed)
    }
}

/// A light's place, its direction of length 1.
fn with_unit_direction(place: &LightPlace) -> LightPlace {
    match place {
        LightPlace::Point(point) => LightPlace::Point(*point),
        LightPlace::Direction(along) => LightPlace::Direction(along.normalize()),
    }
}

pub(super) fn branch(followed: Result<PathWeight, End>) -> Branch {
    match followed {
        Ok(_) => Branch::Grown,
        Err(End::Zero) => Branch::Zero,
        Err(End::Weight) => Branch::Weight,
        Err(End::Depth) => Branch::Depth,
        Err(End::Faint) => Branch::Faint,
    }
}
