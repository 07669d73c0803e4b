//! The tracer: grows the ray tree of every sample and hands it, node by node, to a sink.

use std::ops::AddAssign;

use fearless_simd::{Level, Simd, dispatch};
use glam::DVec3;

use super::camera::View;
use super::lobe::{self, Lit, Lobe};
use super::sampling;
use super::tree::{BLOCKED, Branch, Ends, LightHit, NO_FRESNEL, Node, weights};
use crate::film::layout::{LANES, Layout, Place};
use crate::geometry::{Geometry, Hit, Interaction, Leaving, Ray, Stack};
use crate::progress::{Cancelled, Progress};
use crate::scene::factor::{End, Factor, FactorValues, Kind, PathWeight};
use crate::scene::model::Model;
use crate::scene::{LightPlace, Material, Scene};

/// What receives the trees: storage, or nothing, so that tracing with and without keeping is the
/// same code. Nodes arrive in preorder, a node's lights right after it.
pub trait Sink {
    /// Bytes that it holds.
    fn bytes(&self) -> usize;
    /// A block of 16 pixels begins.
    fn block(&mut self);
    /// A sample begins; whether its ray met the scene.
    fn sample(&mut self, hit: bool);
    /// A node; gives the name by which [`Sink::missed`] refers to it.
    fn node(&mut self, node: Node) -> u32;
    /// The ray of this branch of a node left the scene.
    fn missed(&mut self, node: u32, side: Side);
    /// A light in front of the last node.
    fn light(&mut self, hit: LightHit, crossed: &[u16]);
}

/// Drops what it is given.
pub struct Discard;

impl Sink for Discard {
    #[inline(always)]
    fn bytes(&self) -> usize {
        0
    }
    fn block(&mut self) {}
    #[inline(always)]
    fn sample(&mut self, _: bool) {}
    #[inline(always)]
    fn node(&mut self, _: Node) -> u32 {
        0
    }
    #[inline(always)]
    fn missed(&mut self, _: u32, _: Side) {}
    #[inline(always)]
    fn light(&mut self, _: LightHit, _: &[u16]) {}
}

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

/// Which branch of a node.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// The mirror ray.
    Reflected,
    /// The refracted ray.
    Transmitted,
}

/// Rays cast, by kind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RayCounts {
    /// From the eye.
    pub camera: u64,
    /// Mirror rays, total reflection included.
    pub reflected: u64,
    /// Refracted rays.
    pub transmitted: u64,
    /// Towards lights.
    pub shadow: u64,
}

impl RayCounts {
    /// Rays of every kind.
    pub fn total(self) -> u64 {
        self.camera + self.reflected + self.transmitted + self.shadow
    }
}

impl AddAssign for RayCounts {
    fn add_assign(&mut self, o: RayCounts) {
        let RayCounts { camera, reflected, transmitted, shadow } = o;
        self.camera += camera;
        self.reflected += reflected;
        self.transmitted += transmitted;
        self.shadow += shadow;
    }
}

/// All that tracing reads, made once per trace and shared by its workers.
pub struct Grower<'a> {
    geometry: &'a Geometry,
    values: FactorValues,
    opaque: Vec<bool>,
    /// Directions are of length 1.
    lights: Vec<LightPlace>,
    iors: Vec<f64>,
    models: Vec<Model>,
    /// Per material, whether Fresnel weighs its branches.
    weighing: Vec<bool>,
    view: View,
    layout: Layout,
    samples: u32,
    level: Level,
}

/// What one thread needs while tracing.
pub struct Worker {
    stack: Stack,
    pending: Vec<Pending>,
    crossed: Vec<u16>,
    media: Media,
    /// Rays that this worker cast.
    pub rays: RayCounts,
}

/// When to stop.
#[derive(Clone, Copy)]
struct Limits<'a> {
    most: usize,
    progress: &'a Progress,
}

/// A ray still to be followed.
struct Pending {
    ray: Ray,
    leaving: Option<Leaving>,
    path: PathWeight,
    /// Product of Fresnel's reflectances on the path.
    geometric: f32,
    parent: Option<(u32, Side)>,
    medium: u32,
}

impl<'a> Grower<'a> {
    /// Prepares to trace `scene`, of which `geometry` was built.
    pub fn new(scene: &Scene, geometry: &'a Geometry) -> Grower<'a> {
        let values = FactorValues::new(scene);
        Grower {
            geometry,
            opaque: values.opaque(),
            values,
            lights: scene.lights.iter().map(|l| with_unit_direction(&l.place)).collect(),
            iors: scene.materials.iter().map(|m| m.ior).collect(),
            models: scene.materials.iter().map(|m| m.model).collect(),
            weighing: scene.materials.iter().map(Material::weighs_branches).collect(),
            view: View::new(&scene.camera, scene.picture.size),
            layout: Layout::new(scene.picture.size),
            samples: scene.trace.samples,
            level: Level::new(),
        }
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
        (tile, block): (usize, usize),
        sink: &mut K,
        most: usize,
        progress: &Progress,
    ) -> Result<(), Stop> {
        worker.pending.clear();
        let limits = Limits { most, progress };
        sink.block();
        for lane in 0..LANES {
            if let Some(pixel) = self.layout.pixel(Place { tile, block, lane }) {
                dispatch!(self.level, simd => self.pixel(simd, worker, pixel, sink, limits))?;
            }
        }
        Ok(())
    }

    #[inline(always)]
    fn pixel<S: Simd, K: Sink>(
        &self,
        simd: S,
        worker: &mut Worker,
        pixel: [u32; 2],
        sink: &mut K,
        limits: Limits,
    ) -> Result<(), Stop> {
        for index in 0..self.samples {
            let [u, v] = sampling::in_pixel(pixel, index, self.samples);
            let ray = self.view.ray(f64::from(pixel[0]) + u, f64::from(pixel[1]) + v);
            self.sample(simd, worker, ray, sink, limits)?;
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
        sink: &mut K,
        limits: Limits,
    ) -> Result<(), Stop> {
        worker.media.clear();
        worker.rays.camera += 1;
        let root = Pending {
            ray,
            leaving: None,
            path: PathWeight::EYE,
            geometric: 1.0,
            parent: None,
            medium: Media::OUTSIDE,
        };
        worker.pending.push(root);
        while let Some(next) = worker.pending.pop() {
            limits.progress.check()?;
            if sink.bytes() > limits.most {
                return Err(Stop::Branches);
            }
            let hit = self.geometry.closest_hit(simd, &mut worker.stack, &next.ray, next.leaving);
            match (hit, next.parent) {
                (Some(hit), parent) => {
                    if parent.is_none() {
                        sink.sample(true);
                    }
                    self.node(simd, worker, &next, hit, sink)?;
                }
                (None, Some((node, side))) => sink.missed(node, side),
                (None, None) => sink.sample(false),
            }
        }
        Ok(())
    }

    /// Stores a node, asks its lights, and queues its branches.
    #[inline(always)]
    fn node<S: Simd, K: Sink>(
        &self,
        simd: S,
        worker: &mut Worker,
        from: &Pending,
        hit: Hit,
        sink: &mut K,
    ) -> Result<(), Stop> {
        let at = self.geometry.interaction(&from.ray, hit);
        let mut surface = Surface::new(&at, from.ray.direction);
        let media = self.cross(&mut worker.media, from.medium, &at, &surface);
        surface.contrast = media.contrast;
        surface.refracted = surface.refract(media.eta);
        let refracted = surface.refracted;
        let reflect_kind = match refracted {
            Some(_) => Kind::Reflect,
            None => Kind::TotalReflect,
        };
        let fresnel = if self.weighing[at.material as usize] {
            surface.reflectance() as f32
        } else {
            NO_FRESNEL
        };
        let [mirrored, passed] = weights(fresnel).map(|w| w * from.geometric);
        let follow = |kind, geometric| self.follow(from, (kind, at.material), geometric);
        let reflected = follow(reflect_kind, mirrored);
        let transmitted = refracted.map(|_| follow(Kind::Transmit, passed));
        let ends = Ends::new(
            branch(reflected),
            transmitted.map_or(Branch::Absent, branch),
            refracted.is_none(),
        );
        let (material, slot) = (at.material, at.slot);
        let node =
            Node { t: hit.t, primitive: hit.primitive, material, lights: 0, slot, ends, fresnel };
        let name = sink.node(node);
        for (light, place) in self.lights.iter().enumerate() {
            self.light(simd, worker, &at, &surface, (light as u16, place), sink)?;
        }
        let mut queue = |direction, (path, geometric), side, medium| {
            let (ray, leaving) = self.geometry.spawn(&at, direction);
            let parent = Some((name, side));
            let leaving = Some(leaving);
            worker.pending.push(Pending { ray, leaving, path, geometric, parent, medium });
        };
        if let (Some(direction), Some(Ok(path))) = (refracted, transmitted) {
            worker.rays.transmitted += 1;
            queue(direction, (path, passed), Side::Transmitted, media.behind);
        }
        if let Ok(path) = reflected {
            worker.rays.reflected += 1;
            queue(surface.reflect(), (path, mirrored), Side::Reflected, from.medium);
        }
        Ok(())
    }

    /// The rule of liveness for a branch of this geometric weight.
    #[inline(always)]
    fn follow(
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

    /// Sends a shadow ray to a light in front of the geometric surface, and to one that shines
    /// through it. Where nothing passes, the surface's own material is what stops the latter.
    #[inline(always)]
    fn light<S: Simd, K: Sink>(
        &self,
        simd: S,
        worker: &mut Worker,
        at: &Interaction,
        surface: &Surface,
        (light, place): (u16, &LightPlace),
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
        let stopped = LightHit { light, crossed: BLOCKED, n_dot_l: 0.0, angle: 1.0, weight: 0.0 };
        if !front && self.opaque[at.material as usize] {
            sink.light(stopped, &[at.material]);
            return Ok(());
        }
        worker.rays.shadow += 1;
        let (ray, leaving) = self.geometry.spawn(at, to_light);
        let t_max = match place {
            LightPlace::Point(p) => (*p - ray.origin).length(),
            LightPlace::Direction(_) => f64::INFINITY,
        };
        let Worker { stack, crossed, .. } = worker;
        let leaving = Some(leaving);
        let witness =
            self.geometry.occluded(simd, stack, &ray, t_max, leaving, &self.opaque, crossed);
        if let Some(material) = witness {
            sink.light(stopped, &[material]);
            return Ok(());
        }
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

    /// Which media meet at a surface, and the list of solids behind it.
    #[inline(always)]
    fn cross(
        &self,
        media: &mut Media,
        front: u32,
        at: &Interaction,
        surface: &Surface,
    ) -> Crossing {
        let ior = |solid: Option<(u32, u16)>| solid.map_or(1.0, |(_, m)| self.iors[m as usize]);
        let own = Some((at.solid, at.material));
        let entering = ior(media.top(front)) / ior(own);
        if at.thin {
            Crossing { eta: 1.0, contrast: entering, behind: front }
        } else if surface.entering {
            let behind = media.push(front, at.solid, at.material);
            Crossing { eta: entering, contrast: entering, behind }
        } else {
            let behind = media.without(front, at.solid);
            // A ray that leaves a solid which it never entered started inside it.
            let inside = if behind == front { own } else { media.top(front) };
            let eta = ior(inside) / ior(media.top(behind));
            Crossing { eta, contrast: eta, behind }
        }
    }
}

/// A light's place, its direction of length 1.
fn with_unit_direction(place: &LightPlace) -> LightPlace {
    match place {
        LightPlace::Point(point) => LightPlace::Point(*point),
        LightPlace::Direction(along) => LightPlace::Direction(along.normalize()),
    }
}

fn branch(followed: Result<PathWeight, End>) -> Branch {
    match followed {
        Ok(_) => Branch::Grown,
        Err(End::Zero) => Branch::Zero,
        Err(End::Weight) => Branch::Weight,
        Err(End::Depth) => Branch::Depth,
        Err(End::Faint) => Branch::Faint,
    }
}

/// What meets at a surface.
struct Crossing {
    /// Ratio of the indices in front and behind, by which a ray bends.
    eta: f64,
    /// The same for Fresnel's reflectance: differs for a thin surface, which mirrors like the
    /// material that it is of and bends nothing.
    contrast: f64,
    /// The solids behind.
    behind: u32,
}

/// A surface as seen by the ray that met it: both normals on the ray's side.
struct Surface {
    normal: DVec3,
    geometric: DVec3,
    /// Unit vector back along the ray.
    to_eye: DVec3,
    /// Whether the ray comes from outside.
    entering: bool,
    /// [`Crossing::contrast`], once it is known.
    contrast: f64,
    /// Direction of the refracted ray, once it is known.
    refracted: Option<DVec3>,
}

impl Surface {
    #[inline(always)]
    fn new(at: &Interaction, direction: DVec3) -> Surface {
        let to_eye = -direction;
        let entering = at.geometric_normal.dot(to_eye) >= 0.0;
        let side = if entering { 1.0 } else { -1.0 };
        let geometric = at.geometric_normal * side;
        let smooth = at.shading_normal * side;
        let normal = if smooth.dot(to_eye) > 0.0 { smooth } else { geometric };
        Surface { normal, geometric, to_eye, entering, contrast: 1.0, refracted: None }
    }

    /// Fresnel's reflectance of the ray that met it.
    #[inline(always)]
    fn reflectance(&self) -> f64 {
        match self.refracted {
            Some(_) => lobe::fresnel(self.normal.dot(self.to_eye).min(1.0), self.contrast),
            None => 1.0,
        }
    }

    /// Direction of the mirror ray, always above the geometric surface.
    #[inline(always)]
    fn reflect(&self) -> DVec3 {
        let about = |n: DVec3| n * (2.0 * n.dot(self.to_eye)) - self.to_eye;
        let mirrored = about(self.normal);
        let above = mirrored.dot(self.geometric) > 0.0;
        if above { mirrored } else { about(self.geometric) }.normalize()
    }

    /// Direction of the refracted ray for `eta` = index in front / index behind, always below the
    /// geometric surface; `None` in total reflection. Snell's law in vector form (Heckbert 1989).
    #[inline(always)]
    fn refract(&self, eta: f64) -> Option<DVec3> {
        let through = |n: DVec3| {
            let c = n.dot(self.to_eye);
            let radicand = 1.0 - eta * eta * (1.0 - c * c);
            (radicand >= 0.0).then(|| n * (eta * c - radicand.sqrt()) - self.to_eye * eta)
        };
        if eta == 1.0 {
            return Some(-self.to_eye);
        }
        let bent = through(self.normal)?;
        let below = bent.dot(self.geometric) < 0.0;
        if below { Some(bent.normalize()) } else { through(self.geometric).map(DVec3::normalize) }
    }
}

/// The solids that a ray is inside of, as lists that share their tails: a sample's branches leave
/// from common nodes. The solid entered last decides the index of refraction.
#[derive(Default)]
struct Media {
    entries: Vec<Medium>,
}

#[derive(Clone, Copy)]
struct Medium {
    below: u32,
    solid: u32,
    material: u16,
}

impl Media {
    /// The empty list.
    const OUTSIDE: u32 = u32::MAX;

    fn clear(&mut self) {
        self.entries.clear();
    }

    fn push(&mut self, below: u32, solid: u32, material: u16) -> u32 {
        self.entries.push(Medium { below, solid, material });
        self.entries.len() as u32 - 1
    }

    /// The solid entered last, with its material.
    #[inline(always)]
    fn top(&self, list: u32) -> Option<(u32, u16)> {
        self.entries.get(list as usize).map(|m| (m.solid, m.material))
    }

    /// The list without the latest entry of `solid`; the same list if it is not in it.
    fn without(&mut self, list: u32, solid: u32) -> u32 {
        let mut above = [Medium { below: 0, solid: 0, material: 0 }; 64];
        let (mut at, mut count) = (list, 0);
        while let Some(&medium) = self.entries.get(at as usize) {
            if medium.solid == solid {
                let mut rebuilt = medium.below;
                for m in above[..count].iter().rev() {
                    rebuilt = self.push(rebuilt, m.solid, m.material);
                }
                return rebuilt;
            }
            // A path has at most 64 branches, so a list has at most 64 entries.
            above[count] = medium;
            count += 1;
            at = medium.below;
        }
        list
    }
}
