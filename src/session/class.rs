//! What an edit costs, what is to be done for it, and what was done.

use std::fmt;

use super::plan::Plan;
use crate::forest::grow::RayCounts;

/// What an edit cost, from cheapest to dearest.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Class {
    /// Nothing visible changed.
    None,
    /// Terms and product.
    Reshade,
    /// Some materials' coefficients from kept angles, then terms and product.
    Refold,
    /// Some pixels' trees, then all of the above.
    Regrow,
    /// Everything.
    Retrace,
}

impl fmt::Display for Class {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Class::None => "none",
            Class::Reshade => "reshade",
            Class::Refold => "refold",
            Class::Regrow => "regrow",
            Class::Retrace => "retrace",
        })
    }
}

/// What is to be done for an edit.
#[derive(Clone, Debug)]
pub enum Work {
    /// Terms and product, highlights before them.
    Shade,
    /// Some pixels' trees.
    Regrow(Plan),
    /// Everything, for this reason.
    Trace(String),
}

impl Work {
    /// What asks for more than shading.
    pub fn reason(&self) -> &str {
        match self {
            Work::Shade => "nothing",
            Work::Regrow(plan) => &plan.reason,
            Work::Trace(reason) => reason,
        }
    }
}

/// What was done for an edit.
#[derive(Clone, Debug, PartialEq)]
pub struct EditReport {
    /// Its class.
    pub class: Class,
    /// For a trace: what asked for it.
    pub reason: Option<String>,
    /// Rays cast.
    pub rays: RayCounts,
    /// Pixels whose trees were grown.
    pub pixels: u64,
    /// From the edit to the finished 8-bit picture.
    pub milliseconds: f64,
}
