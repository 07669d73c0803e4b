//! Solids made of others: one entry of the hierarchy, whose surfaces are those of its leaves.
//!
//! Every operation is written with "all of" and "any of" over plain solids and their complements, so
//! that the whole is monotone in its leaves: where a line enters or leaves it, one leaf is crossed
//! that says so, and the normal of a leaf whose complement is meant is turned once and for all.
//! Crossings that f64 cannot tell apart are one (see [`walk`]).

mod boxes;
mod build;
mod leaf;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod tests_rays;
mod walk;

use glam::DVec3;

use boxes::Boxes;
pub(super) use build::{Chain, Parts};
pub(super) use leaf::Leaf;
pub(crate) use leaf::MARGIN;
pub(super) use walk::Lists;

/// A solid made of others.
#[derive(Debug)]
pub(super) struct Composite {
    /// Parents before their children; the first is the whole.
    gates: Vec<Gate>,
    /// In the order of their primitives.
    pub(super) leaves: Vec<Leaf>,
    /// Its index in `Scene::solids`.
    pub(super) solid: u32,
    /// Number of its first primitive.
    first: u32,
    /// How many primitives it has.
    count: u32,
    /// No coordinate of the leaves' surfaces is larger, but those of planes.
    size: f64,
    /// At the beginning of every line: per gate how many of its children are there, per leaf how often
    /// it is.
    first_counts: [Vec<i32>; 2],
}

/// All of some sets, or any of them.
#[derive(Debug)]
struct Gate {
    /// Whether all of its children must be there, or one.
    all: bool,
    /// [`NO_PARENT`] of the first.
    parent: u32,
    /// Solids before complements: what the line misses is found early.
    children: Vec<Child>,
    /// Around each child where it is not what it is at first.
    boxes: Vec<Boxes>,
    /// How many of its children are there at the beginning of every line, unless crossings at −∞ say
    /// otherwise.
    start: i32,
    /// World corners of a box around it, infinite where it is.
    bounds: [DVec3; 2],
    /// The same of a box beyond which it is what it is at first.
    changes: [DVec3; 2],
}

/// The parent of the whole.
const NO_PARENT: u32 = u32::MAX;

/// An index into the gates or the leaves.
#[derive(Clone, Copy, Debug)]
enum Child {
    Leaf(u32),
    Gate(u32),
}

impl Gate {
    /// How many of its children make it be there.
    fn need(&self) -> i32 {
        if self.all { self.children.len() as i32 } else { 1 }
    }

    /// Whether it is there at the beginning of every line.
    fn is_there_first(&self) -> bool {
        self.start >= self.need()
    }
}

impl Composite {
    /// World corners of a box around it, infinite where it is; lowest above highest if it is empty.
    pub(super) fn bounds(&self) -> [DVec3; 2] {
        self.gates[0].bounds
    }

    /// Whether a child of a gate is there at the beginning of every line.
    fn is_there_first(&self, child: &Child) -> bool {
        match child {
            Child::Leaf(leaf) => self.leaves[*leaf as usize].complement,
            Child::Gate(gate) => self.gates[*gate as usize].is_there_first(),
        }
    }

    /// Memory held, in bytes.
    pub(super) fn bytes(&self) -> usize {
        let gate = |gate: &Gate| size_of_val(&*gate.children) + size_of_val(&*gate.boxes);
        let gates = self.gates.iter().map(gate).sum::<usize>();
        let counts = self.first_counts.iter().map(|counts| size_of_val(&**counts)).sum::<usize>();
        let leaves = self.leaves.iter().map(Leaf::bytes).sum::<usize>();
        size_of_val(&*self.gates) + gates + leaves + counts
    }
}
