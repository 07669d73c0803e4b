//! Solids that move while the shutter is open: a geometry of their own, at rest, and where it is when.

use std::cell::RefCell;
use std::sync::Arc;

use fearless_simd::{Level, dispatch};
use glam::{DMat3, DVec3};

use super::compile::{Compiled, Primitives};
use super::composite::Lists;
use super::hierarchy::{Hierarchy, STACK};
use super::interaction::Surface;
use super::placement::{Placed, rotation};
use super::query::Query;
use super::surfaces::Surfaces;
use super::traverse::Walk;
use super::uv::Uv;
use super::{Geometry, Hit, Interaction, Ray};
use crate::progress::{Cancelled, Progress};
use crate::scene::motion::Motion;
use crate::scene::{Placement, Solid};

/// A solid that moves. A ray meets it where the ray, taken to the frame in which the solid rests,
/// meets what is compiled there: motion is rigid, so that `t` is the same in both.
#[derive(Debug)]
pub(super) struct Moving {
    /// Scaled, not turned, around its own origin. Its primitives have the numbers of the whole scene's.
    rest: Geometry,
    placement: Placement,
    motion: Motion,
    /// Where it is as the shutter opens.
    opening: Pose,
    /// World corners of a box around it at all times until the shutter closes.
    bounds: [DVec3; 2],
}

/// Where a moving solid is at one time.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pose {
    time: f64,
    /// The linear part of world_from_rest, a rotation.
    turn: DMat3,
    /// World position of the resting frame's origin.
    origin: DVec3,
}

/// A time, and the poses and scratch of what moves; part of a [`Stack`](super::Stack).
#[derive(Debug, Default)]
pub(super) struct Moment {
    /// 0 … 1.
    pub(super) time: f64,
    /// As those of the stack; `None` where no solid has a hierarchy of its own.
    pub(super) entries: Option<Box<[u64; STACK]>>,
    /// For what is made of others.
    pub(super) lists: Lists,
    /// Per moving solid the pose that was asked for last.
    pub(super) poses: Vec<Pose>,
}

impl Moment {
    /// For these solids.
    pub(super) fn new(all: &Primitives, time: f64) -> Moment {
        let moving = all.moving.len();
        let unknown = Pose { time: f64::NAN, turn: DMat3::IDENTITY, origin: DVec3::ZERO };
        let within = moving > 0 || !all.composites.is_empty();
        let entries = within.then(|| Box::new([0; STACK]));
        Moment { time, entries, lists: Lists::default(), poses: vec![unknown; moving] }
    }
}

impl Pose {
    fn point(&self, rest: DVec3) -> DVec3 {
        self.turn * rest + self.origin
    }

    fn ray_to_rest(&self, ray: &Ray) -> Ray {
        let back = self.turn.transpose();
        Ray { origin: back * (ray.origin - self.origin), direction: back * ray.direction }
    }

    /// By how much the origin of a ray at rest may be off: both sums and the two rotations, to the
    /// resting frame and, before, to the surface's point in the world, round terms of this size.
    fn slack(&self, ray: &Ray) -> f64 {
        let size = ray.origin.abs().element_sum() + self.origin.abs().element_sum();
        size * (8.0 * f64::EPSILON)
    }
}

impl Moving {
    /// Compiles a solid that moves until `shutter`; its primitives are numbered from `first` on.
    pub(super) fn new(
        solid: &Solid,
        first: u32,
        shutter: f64,
        level: Level,
        progress: &Progress,
    ) -> Result<Moving, Cancelled> {
        let Solid { name: _, shape: _, material: _, placement, motion } = solid;
        let resting = Placement { scale: placement.scale, ..Placement::default() };
        let resting = Solid { placement: resting, ..solid.clone() };
        let placed = Placed::new(&resting.placement);
        let primitives = Primitives::part(&resting, placed, first, progress)?;
        let hierarchy = Hierarchy::build(&primitives, level, progress)?;
        let bounds = swept(placement, motion, shutter, hierarchy.bounds().unwrap_or_default());
        let (primitives, hierarchy) = (Arc::new(primitives), Arc::new(hierarchy));
        Ok(Moving {
            rest: Geometry { primitives, hierarchy, surfaces: Surfaces::default() },
            placement: placement.clone(),
            motion: motion.clone(),
            opening: pose(placement, motion, 0.0),
            bounds,
        })
    }

    /// The solid at rest.
    pub(super) fn solid(&self) -> &Compiled {
        &self.rest.primitives.solids[0]
    }

    /// World corners of a box around it at all times until the shutter closes.
    pub(super) fn bounds(&self) -> [DVec3; 2] {
        self.bounds
    }

    /// Memory held, in bytes.
    pub(super) fn bytes(&self) -> usize {
        size_of::<Moving>() + self.rest.bytes()
    }

    /// Where it is at the moment; `index` is its place among those that move.
    fn pose(&self, index: u32, moment: &mut Moment) -> Pose {
        let known = &mut moment.poses[index as usize];
        if known.time != moment.time {
            *known = pose(&self.placement, &self.motion, moment.time);
        }
        *known
    }

    /// Offers its crossings to the query.
    #[inline(never)]
    pub(super) fn meet<Q: Query>(&self, level: Level, index: u32, walk: &Walk<'_>, query: &mut Q) {
        let mut moment = walk.moment.borrow_mut();
        let pose = self.pose(index, &mut moment);
        let Some(entries) = &mut moment.entries else { return };
        let ray = pose.ray_to_rest(walk.ray);
        let Compiled { first, count, item: _, thin: _, mesh: _ } = *self.solid();
        let from = (walk.leaving.alone(first, count), pose.slack(walk.ray));
        // Nothing in it moves.
        let resting = RefCell::default();
        let within = Walk::new(&ray, from, &resting);
        dispatch!(level, simd => self.rest.descend(simd, entries, &within, query));
    }

    /// u and v of a point of its surface, with their gradients as the shutter opened.
    pub(super) fn uv(&self, index: u32, moment: &RefCell<Moment>, at: &Interaction) -> Uv {
        let pose = self.pose(index, &mut moment.borrow_mut());
        let back = pose.turn.transpose();
        let point = back * (at.point - pose.origin);
        let geometric_normal = back * at.geometric_normal;
        let uv = self.rest.primitives.uv(0, &Interaction { point, geometric_normal, ..*at });
        Uv { gradients: uv.gradients.map(|gradient| self.opening.turn * gradient), ..uv }
    }

    /// A vector along its surface as the shutter opened, turned as it is at the moment.
    pub(super) fn turned(&self, index: u32, moment: &RefCell<Moment>, v: DVec3) -> DVec3 {
        let pose = self.pose(index, &mut moment.borrow_mut());
        pose.turn * (self.opening.turn.transpose() * v)
    }

    /// Its surface at a hit in the world, and the point at which that part of it was as the shutter
    /// opened: patterns move with it.
    #[inline(never)]
    pub(super) fn surface(
        &self,
        index: u32,
        moment: &RefCell<Moment>,
        ray: &Ray,
        hit: Hit,
    ) -> (Surface, DVec3) {
        let pose = self.pose(index, &mut moment.borrow_mut());
        let ray = pose.ray_to_rest(ray);
        let (point, normal, smooth) = self.rest.primitives.surface(self.solid(), &ray, hit);
        let normal = (pose.turn * normal).normalize();
        let smooth = smooth.map(|n| pose.turn * n);
        ((pose.point(point), normal, smooth), self.opening.point(point))
    }
}

fn pose(placement: &Placement, motion: &Motion, time: f64) -> Pose {
    let Placement { translate, rotate_degrees, scale: _ } = placement.at(motion, time);
    Pose { time, turn: rotation(rotate_degrees), origin: translate }
}

/// Radians per part of a motion: a box around each part is close to it.
const PART: f64 = 0.05;
/// Parts of a motion at most.
const MOST_PARTS: f64 = 1000.0;

/// A world box around a box at rest, at all times from 0 to `shutter`.
///
/// Within a part no point leaves its place of the middle by more than half the way there: the angles
/// about three axes turn it by no more than their sum, and no point of a rotation moves farther than
/// twice its distance from the centre.
fn swept(placement: &Placement, motion: &Motion, shutter: f64, [lo, hi]: [DVec3; 2]) -> [DVec3; 2] {
    let Motion { translate, rotate_degrees } = motion;
    let turn = rotate_degrees.abs().element_sum().to_radians() * shutter;
    let parts = (turn / PART).ceil().clamp(1.0, MOST_PARTS);
    let (middle, half) = ((lo + hi) * 0.5, (hi - lo) * 0.5);
    let reach = lo.abs().max(hi.abs()).length();
    let stray = translate.abs() * (shutter / parts / 2.0) + reach * (turn / parts / 2.0).min(2.0);
    let mut bounds = [DVec3::INFINITY, DVec3::NEG_INFINITY];
    for part in 0..parts as usize {
        let time = shutter * (part as f64 + 0.5) / parts;
        let pose = pose(placement, motion, time);
        let rows = [pose.turn.row(0), pose.turn.row(1), pose.turn.row(2)];
        let extent = DVec3::from(rows.map(|row| (row * half).abs().element_sum())) + stray;
        let center = pose.point(middle);
        // More than all roundings, here and of the solid's own points.
        let margin = (extent.max_element() + reach + pose.origin.abs().max_element()) * 1e-13;
        bounds[0] = bounds[0].min(center - extent - margin);
        bounds[1] = bounds[1].max(center + extent + margin);
    }
    bounds
}
