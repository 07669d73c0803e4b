//! Speed against accuracy: each setting of the tracer swept alone, its error and its time, and which values to choose.
//!
//! # What is measured
//!
//! A [`Setting`] goes through its values while all others stay as the scene has them. A value's error
//! is how far its picture is from the setting's *truth*: the same scene with the finest value, for
//! samples that of the reference. A sweep therefore shows the error of its own setting alone: depth
//! and cut-off are not drowned in the noise of few samples, because a sample's rays are the same
//! whatever the depth. The errors of several settings add up at most (they are distances), so the
//! recommended combination is the fastest whose errors together stay below the goal.
//!
//! A value of samples is a quarter of the reference's at most: the first samples of both are the same,
//! and with more of them in common the error would look smaller than it is (13 % at a quarter).

mod advice;
mod draw;
mod measure;
mod tables;

pub use advice::Advice;
pub use draw::{COLORS, about, png, svg};
pub use measure::{News, Wishes, deviation, measure};
pub use tables::{csv, json};

use std::fmt;

use crate::scene::Scene;
use crate::scene::path::parameters;

/// A setting that is swept.
#[derive(Clone, Copy, Debug)]
pub struct Setting {
    /// Its path in the scene.
    pub path: &'static str,
    /// Its name for people.
    pub name: &'static str,
    /// Its values from coarse to fine, for a reference of so many samples; the last is the truth.
    pub ladder: fn(u32) -> Vec<f64>,
    /// What else the truth is traced with: paths and values.
    pub exact: &'static [(&'static str, &'static str)],
}

/// All that are swept; those that a scene does not have are left out.
pub const SETTINGS: &[Setting] = &[
    Setting { path: "trace.samples", name: "samples", ladder: sample_ladder, exact: &[] },
    Setting {
        path: "trace.depth",
        name: "depth",
        ladder: |_| vec![0., 1., 2., 3., 4., 6., 8., 12., 16., 24., 32., 48., 64.],
        exact: &[],
    },
    Setting {
        path: "trace.cutoff",
        name: "cut-off",
        ladder: |_| vec![0.3, 0.1, 0.03, 0.01, 1.0 / 255.0, 0.001, 3e-4, 1e-4],
        exact: &[],
    },
    Setting {
        path: "trace.adaptive",
        name: "adaptive step",
        ladder: |_| vec![1.0, 0.4, 0.2, 0.1, 0.05, 0.02, 0.01, 0.005, 0.0],
        exact: &[],
    },
];

fn sample_ladder(reference: u32) -> Vec<f64> {
    let powers = (0..31).map(|i| 1u32 << i).take_while(|n| *n <= (reference / 4).max(1));
    powers.chain([reference.max(2)]).map(f64::from).collect()
}

impl Setting {
    /// Its value in a scene; `None` if the scene has no such number.
    pub fn present(&self, scene: &Scene) -> Option<f64> {
        let own = parameters(scene).into_iter().find(|parameter| parameter.path == self.path)?;
        own.value.parse().ok()
    }

    /// Its values from coarse to fine, the scene's own among them; the last is the truth.
    fn values(&self, scene: &Scene, reference: u32) -> Option<Vec<f64>> {
        let present = self.present(scene)?;
        let mut values = (self.ladder)(reference);
        let rises = values.first() < values.last();
        let finer = |a: f64, b: f64| if rises { a > b } else { a < b };
        // A scene file holds the shortest number that is read back alike.
        let same = |a: f64| text_of(a) == text_of(present);
        let [.., finest, truth] = values[..] else { return None };
        let known = values.iter().any(|&value| same(value));
        if finer(present, truth) {
            values.push(present);
        } else if !known && finer(finest, present) {
            let at = values.iter().position(|&v| finer(v, present)).unwrap_or(values.len());
            values.insert(at, present);
        }
        Some(values)
    }
}

/// A value as a scene file has it.
pub fn text_of(value: f64) -> String {
    (value as f32).to_string()
}

/// How far one picture is from another: root of the mean square over all pixels and their three
/// channels, after exposure.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Deviation {
    /// Of linear light, 1 being white; not clipped.
    pub linear: f64,
    /// Of sRGB code values of 8 bits before rounding, 255 being white; clipped as in a picture.
    pub codes: f64,
}

/// The error that is wanted at most.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Goal {
    /// Of [`Deviation::linear`].
    Linear(f64),
    /// Of [`Deviation::codes`].
    Codes(f64),
}

impl Default for Goal {
    /// What a picture of 8 bits cannot show.
    fn default() -> Goal {
        Goal::Codes(1.0)
    }
}

impl Goal {
    /// The error that it is about.
    pub fn of(self, error: Deviation) -> f64 {
        match self {
            Goal::Linear(_) => error.linear,
            Goal::Codes(_) => error.codes,
        }
    }

    /// Whether an error is below it.
    pub fn is_met(self, error: Deviation) -> bool {
        let (Goal::Linear(most) | Goal::Codes(most)) = self;
        self.of(error) < most
    }
}

impl fmt::Display for Goal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Goal::Linear(most) => write!(f, "below {most} rms of linear light"),
            Goal::Codes(1.0) => write!(f, "below one 8-bit code value rms"),
            Goal::Codes(most) => write!(f, "below {most} 8-bit code values rms"),
        }
    }
}

/// What is measured as time: what else the machine does changes processor time little.
pub const TIME: &str = if cfg!(unix) { "processor seconds" } else { "wall seconds" };

/// What tracing took.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cost {
    /// [`TIME`] of tracing, folding and shading, without keeping trees: the median of `runs`.
    pub seconds: f64,
    /// How often it was measured.
    pub runs: usize,
    /// Rays of all kinds.
    pub rays: u64,
}

/// One value of a swept setting.
#[derive(Clone, Debug, PartialEq)]
pub struct Point {
    /// The value.
    pub value: f64,
    /// What it took.
    pub cost: Cost,
    /// How far it is from the truth of its sweep.
    pub error: Deviation,
    /// Whether no other value of the sweep is both faster and more accurate.
    pub front: bool,
}

/// A setting's measured values.
#[derive(Clone, Debug)]
pub struct Sweep {
    /// What was swept.
    pub setting: Setting,
    /// The scene's own value.
    pub present: f64,
    /// The value of its truth.
    pub truth: f64,
    /// From coarse to fine. The sweep ends at an error of 0: finer values give the same picture.
    pub points: Vec<Point>,
}

impl Sweep {
    /// The point of a value; that of error 0 stands for all finer values.
    pub fn at(&self, value: f64) -> Option<&Point> {
        let rises = self.points.first().is_some_and(|first| first.value < self.truth);
        let own = self.points.iter().find(|p| text_of(p.value) == text_of(value));
        let exact = self.points.last().filter(|p| p.error == Deviation::default());
        let beyond = |p: &&Point| if rises { p.value < value } else { p.value > value };
        own.or(exact.filter(beyond))
    }
}

/// All that was measured of a scene.
#[derive(Clone, Debug)]
pub struct Chart {
    /// Size of the picture.
    pub size: [u32; 2],
    /// Threads that traced.
    pub threads: usize,
    /// Samples of the reference.
    pub reference: u32,
    /// The error that is wanted.
    pub goal: Goal,
    /// What the scene takes as it is.
    pub present: Cost,
    /// Its error, at most about this, where all its values are among the points.
    pub present_error: Option<Deviation>,
    /// One per setting.
    pub sweeps: Vec<Sweep>,
    /// What to choose.
    pub advice: Advice,
}
