//! A plain solid of which others are made: its own geometry, and where it is when.

use std::sync::Arc;

use fearless_simd::Level;
use glam::DVec3;

use super::build::Chain;
use crate::geometry::compile::{Kind, Primitives};
use crate::geometry::hierarchy::Hierarchy;
use crate::geometry::interaction::Surface;
use crate::geometry::placement::Placed;
use crate::geometry::primitive::{Form, Plane, Sphere};
use crate::geometry::surfaces::Surfaces;
use crate::geometry::uv::Uv;
use crate::geometry::{Geometry, Hit, Interaction, Ray};
use crate::progress::{Cancelled, Progress};
use crate::scene::{Placement, Scene};

/// Boxes around leaves are larger by this share of their coordinates: more than all roundings of
/// crossings and of tests against them.
pub(crate) const MARGIN: f64 = 1e-9;

/// A plain solid of a composite.
#[derive(Debug)]
pub(in crate::geometry) struct Leaf {
    /// For crossings; in the world, or in its object space if it moves.
    pub(super) part: Part,
    /// World corners of a box around it at all times, infinite where it is.
    pub(super) bounds: [DVec3; 2],
    /// Whether the complement is meant.
    pub(super) complement: bool,
    /// Its index among the composite's leaves.
    pub(super) number: u32,
    /// The gate that it is a child of.
    pub(super) gate: u32,
    /// How many primitives it has.
    count: u32,
    /// Number of its first primitive.
    pub(in crate::geometry) first: u32,
    /// Its index in `Scene::solids`.
    pub(in crate::geometry) solid: u32,
    /// Its primitives alone, with their numbers in the whole scene.
    pub(super) rest: Geometry,
    /// Where it is, if it moves.
    course: Option<Box<Course>>,
}

/// What gives a leaf's crossings.
#[derive(Debug)]
pub(super) enum Part {
    Sphere(Sphere),
    Plane(Plane),
    Form(Form),
    /// A closed mesh: its triangles are asked.
    Mesh,
    /// What has no inside, which no scene that was checked holds.
    Nothing,
}

/// Where a leaf is at every time.
#[derive(Debug)]
struct Course {
    chain: Chain,
    /// As the shutter opens.
    opening: Placed,
}

impl Leaf {
    /// Compiles a solid; `gate` says whose child it is, and whether its complement is meant.
    pub(super) fn new(
        (scene, solid, chain, shutter): (&Scene, usize, &Chain, Option<f64>),
        (number, first): (u32, u32),
        (gate, complement): (u32, bool),
        level: Level,
        progress: &Progress,
    ) -> Result<Leaf, Cancelled> {
        let moves = shutter.filter(|_| chain.moves());
        let placed = match moves {
            Some(_) => Placed::new(&Placement::default()),
            None => chain.at(0.0),
        };
        let primitives = Primitives::part(&scene.solids[solid], placed, first, progress)?;
        let hierarchy = Hierarchy::build(&primitives, level, progress)?;
        let part = Part::of(&primitives);
        let still = hierarchy.bounds().unwrap_or([DVec3::NEG_INFINITY, DVec3::INFINITY]);
        let bounds = moves.map_or(still, |shutter| swept(chain, shutter, still));
        let margin = finite_size(bounds) * MARGIN;
        let opening = chain.at(0.0);
        let course = moves.map(|_| Box::new(Course { chain: chain.clone(), opening }));
        Ok(Leaf {
            part,
            bounds: [bounds[0] - margin, bounds[1] + margin],
            complement,
            number,
            gate,
            count: primitives.count() as u32,
            first,
            solid: solid as u32,
            rest: Geometry {
                primitives: Arc::new(primitives),
                hierarchy: Arc::new(hierarchy),
                surfaces: Surfaces::default(),
            },
            course,
        })
    }

    /// How many primitives it has.
    pub(in crate::geometry) fn count(&self) -> u32 {
        self.count
    }

    /// The largest coordinate of its box, 0 if it is infinite.
    pub(super) fn size(&self) -> f64 {
        finite_size(self.bounds)
    }

    /// Memory held, in bytes.
    pub(super) fn bytes(&self) -> usize {
        size_of::<Leaf>() + self.rest.bytes()
    }

    /// world_from_object at a time, if it moves.
    #[inline(always)]
    pub(super) fn placed(&self, time: f64, known: &mut Places) -> Option<Placed> {
        self.course.as_ref().map(|course| known.of(self.first, time, &course.chain))
    }

    /// The surface at a hit, and the point at which that part of it was as the shutter opened. The
    /// normals are those of the composite: of a complement they are turned.
    pub(in crate::geometry) fn surface(&self, time: f64, ray: &Ray, hit: Hit) -> (Surface, DVec3) {
        let all = &self.rest.primitives;
        let solid = &all.solids[0];
        let ((point, normal, smooth), rest) = match &self.course {
            None => {
                let surface = all.surface(solid, ray, hit);
                (surface, surface.0)
            }
            Some(course) => {
                let placed = course.chain.at(time);
                let (origin, direction) = placed.ray_to_object(ray.origin, ray.direction);
                let (point, normal, smooth) = all.surface(solid, &Ray { origin, direction }, hit);
                let normal = placed.normal(normal).normalize();
                let smooth = smooth.map(|n| placed.normal(n));
                ((placed.point(point), normal, smooth), course.opening.point(point))
            }
        };
        let side = if self.complement { -1.0 } else { 1.0 };
        ((point, normal * side, smooth), rest)
    }

    /// u and v of a point of its surface, with their gradients as the shutter opened.
    pub(in crate::geometry) fn uv(&self, time: f64, at: &Interaction) -> Uv {
        let side = if self.complement { -1.0 } else { 1.0 };
        let geometric_normal = at.geometric_normal * side;
        let all = &self.rest.primitives;
        let Some(course) = &self.course else {
            return all.uv(0, &Interaction { geometric_normal, ..*at });
        };
        let placed = course.chain.at(time);
        let point = placed.point_to_object(at.point);
        let geometric_normal = placed.normal_to_object(geometric_normal);
        let uv = all.uv(0, &Interaction { point, geometric_normal, ..*at });
        Uv { gradients: uv.gradients.map(|gradient| course.opening.normal(gradient)), ..uv }
    }

    /// A gradient along its surface as the shutter opened, as it is at a time.
    pub(in crate::geometry) fn turned(&self, time: f64, gradient: DVec3) -> DVec3 {
        match &self.course {
            None => gradient,
            Some(course) => course.chain.at(time).normal(course.opening.normal_to_object(gradient)),
        }
    }
}

/// Places that are remembered at once.
const MOST_PLACES: usize = 64;

/// Where moving leaves were when they were asked last: most rays of a thread are of one time each, but
/// ask a leaf more than once.
#[derive(Debug, Default)]
pub(super) struct Places {
    /// By the number of a leaf's first primitive, modulo their number: that number, a time, the place.
    list: Vec<(u32, f64, Placed)>,
}

impl Places {
    fn of(&mut self, first: u32, time: f64, chain: &Chain) -> Placed {
        if self.list.is_empty() {
            let nowhere = (0, f64::NAN, Placed::new(&Placement::default()));
            self.list.resize(MOST_PLACES, nowhere);
        }
        let known = &mut self.list[first as usize % MOST_PLACES];
        if (known.0, known.1) != (first, time) {
            *known = (first, time, chain.at(time));
        }
        known.2
    }
}

impl Part {
    /// What a compiled solid is.
    fn of(all: &Primitives) -> Part {
        let solid = &all.solids[0];
        let index = solid.item.index as usize;
        match solid.item.kind {
            _ if solid.thin => Part::Nothing,
            Kind::Sphere if solid.count == 1 => Part::Sphere(all.spheres[index]),
            Kind::Plane => Part::Plane(all.planes[index]),
            Kind::Shape if solid.count == 1 => Part::Form(all.shapes[index].form.clone()),
            Kind::Triangle => Part::Mesh,
            Kind::Sphere | Kind::Shape | Kind::Moving | Kind::Leaf => Part::Nothing,
        }
    }
}

/// The largest coordinate of a box, 0 if it is infinite.
fn finite_size([lo, hi]: [DVec3; 2]) -> f64 {
    let size = lo.abs().max(hi.abs()).max_element();
    if size.is_finite() { size } else { 0.0 }
}

/// Radians, or shares of its size, that something moves from one look at where it is to the next.
const PART: f64 = 0.05;
/// Looks at most.
const MOST_PARTS: f64 = 1000.0;

/// A world box around a box in object space, at all times from 0 to `shutter`: around its place in
/// the middle of each part, with how far any of it strays until the part ends.
fn swept(chain: &Chain, shutter: f64, [lo, hi]: [DVec3; 2]) -> [DVec3; 2] {
    if !(lo.is_finite() && hi.is_finite()) {
        return [lo, hi];
    }
    let reach = lo.abs().max(hi.abs()).length();
    let way = chain.speed(reach, shutter) * shutter;
    let extent = chain.at(0.0).box_extent((hi - lo) * 0.5).max_element();
    let parts = (way / (extent * PART).max(f64::MIN_POSITIVE)).ceil().clamp(1.0, MOST_PARTS);
    let mut bounds = [DVec3::INFINITY, DVec3::NEG_INFINITY];
    for part in 0..parts as usize {
        let placed = chain.at(shutter * (part as f64 + 0.5) / parts);
        let half = (hi - lo) * 0.5;
        let extent = placed.box_extent(half) + way / parts * 0.5;
        let center = placed.point(lo + half);
        bounds = [bounds[0].min(center - extent), bounds[1].max(center + extent)];
    }
    bounds
}
