//! Volume, centre of mass and moments of inertia of a solid, by parallel rays, each with its error.
//!
//! A solid is looked at alone, unturned, with the middle of its box at the origin. Jittered grids of
//! rays along the three axes find where it is; moments up to the second are integrated exactly along
//! each ray. Every cell of a grid gets two independent rays, and how much they differ states the error.
//! Plain primitives have their closed form beside it. What is made of several materials is a region of
//! each (see `regions`).

mod closed_form;
mod eigen;
mod grid;
mod moments;
mod properties;
mod regions;
#[cfg(test)]
mod tests;

use std::fmt;

use glam::DVec3;

use crate::geometry::{Geometry, MARGIN, rotation};
use crate::progress::{Cancelled, Progress};
use crate::scene::seams::Seams;
use crate::scene::{Placement, Scene, Shape, Solid};
use grid::{Found, Grid, Region};
use properties::Frame;
pub use properties::{Measured, Properties};

/// Rounding of sums, relative to what is summed.
const ROUNDING: f64 = 1e-12;
/// Cells along an axis of the first grid.
const FIRST: u32 = 8;
/// Most cells along an axis: 6·4096² are 10⁸ rays.
const MOST: u32 = 4096;

/// When to stop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Goal {
    /// As soon as the error of the volume is at most this share of it.
    Error(f64),
    /// Before more than this many rays are cast.
    Rays(u64),
}

/// How to measure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wishes {
    /// When to stop.
    pub goal: Goal,
    /// Mass per cubic world unit, > 0, in place of that of the materials.
    pub density: Option<f64>,
    /// Other rays for another one.
    pub seed: u64,
}

impl Default for Wishes {
    fn default() -> Wishes {
        Wishes { goal: Goal::Error(1e-4), density: None, seed: 0 }
    }
}

/// One grid of a measurement; each next one has four times the rays.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    /// Rays of this grid.
    pub rays: u64,
    /// What it found.
    pub volume: Measured,
}

/// What was measured.
#[derive(Clone, Debug, PartialEq)]
pub struct Report {
    /// By the last grid.
    pub properties: Properties,
    /// All grids.
    pub steps: Vec<Step>,
    /// Whether the error that was wanted is reached; true of a number of rays.
    pub reached: bool,
    /// The materials that it is made of, in the order of its parts.
    pub made_of: Vec<Stuff>,
    /// Rays of the last grid whose crossings did not add up.
    pub torn: u64,
    /// By formulas, if there are any for this shape.
    pub exact: Option<Properties>,
}

/// A material as far as it matters here.
#[derive(Clone, Debug, PartialEq)]
pub struct Stuff {
    /// Its name.
    pub material: String,
    /// What it was taken to weigh per cubic world unit.
    pub density: f64,
}

impl Report {
    /// Rays of all grids.
    pub fn rays(&self) -> u64 {
        self.steps.iter().map(|step| step.rays).sum()
    }
}

/// Why a solid has no mass.
#[derive(Clone, Debug, PartialEq)]
pub enum MassError {
    /// It has no end, as a plane or a complement.
    Endless,
    /// It has no thickness, as a polygon.
    Thin,
    /// It is a mesh that is not closed at the edge between these points, which are in its own space.
    Open([DVec3; 2]),
    /// No ray was inside of it.
    Empty,
    /// The job was cancelled.
    Cancelled,
}

impl fmt::Display for MassError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            MassError::Endless => f.write_str("it has no end, and so no mass"),
            MassError::Thin => f.write_str("it has no thickness, and so no mass"),
            MassError::Open([a, b]) => write!(
                f,
                "the mesh is not closed: see its edge from [{}, {}, {}] to [{}, {}, {}]",
                a.x, a.y, a.z, b.x, b.y, b.z
            ),
            MassError::Empty => f.write_str("no ray was inside of it: it has no volume"),
            MassError::Cancelled => f.write_str("cancelled"),
        }
    }
}

impl std::error::Error for MassError {}

impl From<Cancelled> for MassError {
    fn from(_: Cancelled) -> MassError {
        MassError::Cancelled
    }
}

/// Measures a solid of a valid scene where it is as the shutter opens; `news` hears of every grid.
pub fn measure(
    scene: &Scene,
    solid: usize,
    wishes: Wishes,
    progress: &Progress,
    news: &mut dyn FnMut(&Step),
) -> Result<Report, MassError> {
    let Wishes { goal, density, seed } = wishes;
    check(scene, solid)?;
    let (alone, middle, half) = centred(scene, solid, progress)?;
    let placement = &scene.solids[solid].placement;
    let turn = rotation(placement.rotate_degrees);
    let translation = turn * middle + placement.translate;
    let rounding = rounding(&scene.solids[solid].shape, half);
    let frame = Frame { rotation: turn, translation, half, rounding };
    let (regions, made_of) = regions::regions(alone, density, progress)?;
    let grid = Grid { regions: &regions, half, seed };
    let (mut steps, mut n) = (Vec::new(), first(goal));
    loop {
        let Found { estimate, torn } = grid.cast(n, progress)?;
        let rays = 6 * u64::from(n).pow(2);
        let found = properties::properties(&estimate, &frame);
        let volume = found.as_ref().map_or(Measured::default(), |found| found.volume);
        let step = Step { rays, volume };
        news(&step);
        steps.push(step);
        let done = match goal {
            Goal::Error(error) => volume.value > 0.0 && volume.error <= error * volume.value,
            Goal::Rays(most) => (n * 2) > last(most),
        };
        if done || n >= MOST {
            let properties = found.ok_or(MassError::Empty)?;
            let exact = exact(&scene.solids[solid], &regions, &frame, middle);
            return Ok(Report { properties, steps, reached: done, torn, made_of, exact });
        }
        n *= 2;
    }
}

/// What rounding makes of sums, relative to what is summed. Boxes around what is made of others are a
/// little too large, and no ray may come where they are.
fn rounding(shape: &Shape, half: DVec3) -> f64 {
    let slack = 4.0 * half.max_element() / half.min_element();
    if shape.is_composite() { ROUNDING + slack * MARGIN } else { ROUNDING }
}

/// By formulas, of a plain solid.
fn exact(solid: &Solid, regions: &[Region], frame: &Frame, middle: DVec3) -> Option<Properties> {
    let [Region { geometry: _, density }] = regions else { return None };
    let scale = solid.placement.scale;
    let moments = closed_form::moments(&solid.shape, *density, scale, middle)?;
    properties::properties(&moments, frame)
}

/// Cells along an axis of the first grid.
fn first(goal: Goal) -> u32 {
    let Goal::Rays(most) = goal else { return FIRST };
    let mut n = last(most);
    while n / 2 >= FIRST && n.is_multiple_of(2) {
        n /= 2;
    }
    n
}

/// Cells along an axis of the last grid of a number of rays: it and those before it, a third of its
/// rays together, do not take more. Of the form 2ᵏ times a small number, so that there are some.
fn last(most: u64) -> u32 {
    let n = ((most as f64 / 8.0).sqrt() as u32).clamp(2, MOST);
    let steps = (n / FIRST).max(1).ilog2();
    (n >> steps) << steps
}

/// Whether the solid has an inside.
fn check(scene: &Scene, solid: usize) -> Result<(), MassError> {
    match &scene.solids[solid].shape {
        Shape::Plane { .. } => Err(MassError::Endless),
        Shape::Polygon { .. } => Err(MassError::Thin),
        Shape::Mesh { file: _, mesh } => match mesh.seams() {
            Seams::Closed => Ok(()),
            Seams::Empty => Err(MassError::Empty),
            Seams::Open(edge) => Err(MassError::Open(edge.map(|i| mesh.positions[i as usize]))),
        },
        _ => Ok(()),
    }
}

/// The solid alone, at rest and unturned, with the middle of its box at the origin; where that was,
/// and half the sides of the box.
fn centred(
    scene: &Scene,
    solid: usize,
    progress: &Progress,
) -> Result<(Scene, DVec3, DVec3), MassError> {
    let mut alone = Scene {
        materials: scene.materials.clone(),
        solids: regions::with_operands(scene, solid),
        ..Scene::default()
    };
    let placement = &mut alone.solids[0].placement;
    *placement = Placement { scale: placement.scale, ..Placement::default() };
    let bounds = |scene: &Scene| -> Result<[DVec3; 2], MassError> {
        Geometry::build(scene, progress)?.bounds().ok_or(MassError::Endless)
    };
    let [low, high] = bounds(&alone)?;
    let middle = low + (high - low) / 2.0;
    alone.solids[0].placement.translate = -middle;
    let [low, high] = bounds(&alone)?;
    // Rounding may leave the box a little beside the origin.
    let half = low.abs().max(high.abs());
    if half.min_element() > 0.0 { Ok((alone, middle, half)) } else { Err(MassError::Empty) }
}
