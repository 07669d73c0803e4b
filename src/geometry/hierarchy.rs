//! The hierarchy of boxes: its space, what is in it, and the scratch of its queries.

use std::cell::RefCell;

use fearless_simd::Level;
use glam::DVec3;

use super::binary::{Aabb, BinaryTree};
use super::compile::{Item, Kind, Primitives};
use super::lanes;
use super::motion::Moment;
use super::plan::Plan;
use super::primitive::Form;
use super::shear::point;
use super::wide::Wide;
use crate::progress::{Cancelled, Progress};

/// Entries of a [`Stack`]; a power of two.
pub(super) const STACK: usize = 1024;

/// Scratch for the queries of one thread, made once: zeroing one per ray costs a third.
#[derive(Debug)]
pub struct Stack {
    /// Distance bits above, child reference below: ordered by distance.
    pub(super) entries: Box<[u64; STACK]>,
    /// Where what moves is; only that asks.
    pub(super) moment: RefCell<Moment>,
}

impl Stack {
    /// Scratch for the queries of `geometry` alone: it remembers where what moves in it was.
    pub fn new(geometry: &super::Geometry) -> Stack {
        let moment = RefCell::new(Moment::new(&geometry.primitives, 0.0));
        Stack { moment, ..Stack::default() }
    }

    /// The time of the rays that are asked about from now on, 0 … 1; 0 at first. Of no matter where
    /// nothing moves.
    pub fn set_time(&mut self, time: f64) {
        self.moment.get_mut().time = time;
    }

    /// The time of the rays that are asked about.
    pub(super) fn time(&self) -> f64 {
        self.moment.borrow().time
    }
}

impl Default for Stack {
    fn default() -> Stack {
        Stack { entries: Box::new([0; STACK]), moment: RefCell::default() }
    }
}

/// The space of the hierarchy: centred on what it holds and scaled by a power of two to coordinates
/// within −1 … 1, so that f32 boxes stay sharp at any offset and size.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame {
    /// World position of the origin.
    pub(super) center: DVec3,
    /// local = (world − center) · scale.
    pub(super) scale: f64,
}

/// Everything but the planes, ready for rays.
#[derive(Debug)]
pub(super) struct Hierarchy {
    /// At which it is walked.
    pub(super) level: Level,
    pub(super) frame: Frame,
    tree: Tree,
    bounds: Option<[DVec3; 2]>,
}

/// As wide as the vectors of the level.
#[derive(Debug)]
enum Tree {
    Eight(Wide<8>),
    Sixteen(Wide<16>),
}

impl Hierarchy {
    /// Builds the hierarchy over all primitives but the planes, for rays at a level.
    pub(super) fn build(
        all: &Primitives,
        level: Level,
        progress: &Progress,
    ) -> Result<Hierarchy, Cancelled> {
        let items = items(all);
        let (frame, bounds) = Frame::around(all, &items);
        let mut boxes = Vec::with_capacity(items.len());
        for chunk in items.chunks(1 << 14) {
            progress.check()?;
            boxes.extend(chunk.iter().map(|item| frame.local_box(all, *item)));
        }
        let binary = BinaryTree::build(&boxes, progress)?;
        let of = (&frame, all);
        let tree = if lanes::has_sixteen(level) {
            Tree::Sixteen(Wide::build(&Plan::new(&binary, &items, progress)?, of, progress)?)
        } else {
            Tree::Eight(Wide::build(&Plan::new(&binary, &items, progress)?, of, progress)?)
        };
        Ok(Hierarchy { level, frame, tree, bounds })
    }

    /// The tree, for a level with vectors of eight or less.
    #[inline(always)]
    pub(super) fn eight(&self) -> &Wide<8> {
        match &self.tree {
            Tree::Eight(wide) => wide,
            Tree::Sixteen(_) => wrong_level(),
        }
    }

    /// The tree, for a level with vectors of sixteen.
    #[inline(always)]
    pub(super) fn sixteen(&self) -> &Wide<16> {
        match &self.tree {
            Tree::Sixteen(wide) => wide,
            Tree::Eight(_) => wrong_level(),
        }
    }

    /// World bounds of what it holds.
    pub(super) fn bounds(&self) -> Option<[DVec3; 2]> {
        self.bounds
    }

    /// Memory held, in bytes.
    pub(super) fn bytes(&self) -> usize {
        match &self.tree {
            Tree::Eight(wide) => wide.bytes(),
            Tree::Sixteen(wide) => wide.bytes(),
        }
    }
}

#[cold]
fn wrong_level() -> ! {
    panic!("rays are asked about at the level of their geometry, which its hierarchy is built for")
}

/// All items of the hierarchy, kind by kind.
fn items(all: &Primitives) -> Vec<Item> {
    let run = |kind, count| (0..count as u32).map(move |index| Item { kind, index });
    run(Kind::Sphere, all.spheres.len())
        .chain(run(Kind::Triangle, all.triangles.len()))
        .chain(run(Kind::Shape, all.shapes.len()))
        .collect()
}

impl Frame {
    /// The frame around some items, and their world bounds.
    fn around(all: &Primitives, items: &[Item]) -> (Frame, Option<[DVec3; 2]>) {
        let (mut lo, mut hi) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for item in items {
            let [a, b] = box_about(all, *item, DVec3::ZERO);
            (lo, hi) = (lo.min(a), hi.max(b));
        }
        if items.is_empty() {
            return (Frame { center: DVec3::ZERO, scale: 1.0 }, None);
        }
        let half = (hi - lo) * 0.5;
        (Frame { center: lo + half, scale: scale_to_one(half.max_element()) }, Some([lo, hi]))
    }

    /// A box in the frame around an item, rounded outward.
    fn local_box(&self, all: &Primitives, item: Item) -> Aabb {
        let [lo, hi] = box_about(all, item, self.center);
        let (lo, hi) = ((lo * self.scale).to_array(), (hi * self.scale).to_array());
        Aabb { lo: lo.map(|x| (x as f32).next_down()), hi: hi.map(|x| (x as f32).next_up()) }
    }

    /// A world point in the frame.
    pub(super) fn local(&self, p: DVec3) -> DVec3 {
        (p - self.center) * self.scale
    }
}

/// The power of two that brings `size` into 0.5 … 1.
fn scale_to_one(size: f64) -> f64 {
    if size == 0.0 || !size.is_finite() {
        return 1.0;
    }
    let (_, exponent) = libm::frexp(size);
    libm::ldexp(1.0, (-exponent).clamp(-1000, 1000))
}

/// Lowest and highest corner of an item, relative to `center`.
fn box_about(all: &Primitives, item: Item, center: DVec3) -> [DVec3; 2] {
    let index = item.index as usize;
    let around = |middle: DVec3, half: DVec3| [middle - center - half, middle - center + half];
    match item.kind {
        Kind::Sphere => {
            let sphere = &all.spheres[index];
            around(sphere.center, DVec3::splat(sphere.radius))
        }
        Kind::Triangle => {
            box_of_points(all.triangle_corners(&all.triangles[index]).map(|c| point(c) - center))
        }
        Kind::Shape => match &all.shapes[index].form {
            Form::Cuboid(corners) => corners.map(|c| c - center),
            Form::PlacedCuboid(placed, [min, max]) => {
                let half = (*max - *min) * 0.5;
                around(placed.point(*min + half), placed.box_extent(half))
            }
            Form::Ellipsoid(placed, middle, radius) => {
                around(placed.point(*middle), placed.sphere_extent(*radius))
            }
            Form::Polygon(corners, _) => box_of_points(corners.iter().map(|c| point(c) - center)),
            Form::Closed(closed) => closed.bounds().map(|c| c - center),
            Form::Moving(index) => all.moving[*index as usize].bounds().map(|c| c - center),
            Form::Composite(index) => all.composites[*index as usize].bounds().map(|c| c - center),
        },
        Kind::Plane | Kind::Moving | Kind::Leaf => {
            unreachable!("none is an item of the hierarchy")
        }
    }
}

fn box_of_points(points: impl IntoIterator<Item = DVec3>) -> [DVec3; 2] {
    points
        .into_iter()
        .fold([DVec3::INFINITY, DVec3::NEG_INFINITY], |[lo, hi], p| [lo.min(p), hi.max(p)])
}
