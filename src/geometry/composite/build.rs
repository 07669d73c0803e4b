//! From the tree of operations to gates and leaves.

use fearless_simd::Level;
use glam::DVec3;

use super::boxes::{Boxes, WIDTH};
use super::leaf::Leaf;
use super::{Child, Composite, Gate, NO_PARENT};
use crate::geometry::placement::Placed;
use crate::progress::{Cancelled, Progress};
use crate::scene::csg::Operation;
use crate::scene::motion::Motion;
use crate::scene::{Placement, Scene, Shape};

/// Where a solid is within those that are made of it: placements and motions, the outermost first.
#[derive(Clone, Debug, Default)]
pub(in crate::geometry) struct Chain {
    links: Vec<(Placement, Motion)>,
}

impl Chain {
    /// The same, with a solid's own placement in it.
    pub(super) fn with(&self, scene: &Scene, solid: usize) -> Chain {
        let solid = &scene.solids[solid];
        let mut links = self.links.clone();
        links.push((solid.placement.clone(), solid.motion.clone()));
        Chain { links }
    }

    /// Whether anything of it moves.
    pub(in crate::geometry) fn moves(&self) -> bool {
        self.links.iter().any(|(_, motion)| !motion.is_none())
    }

    /// Whether the solid is in no other one.
    pub(in crate::geometry) fn is_single(&self) -> bool {
        self.links.len() == 1
    }

    /// world_from_object at a time.
    pub(in crate::geometry) fn at(&self, time: f64) -> Placed {
        let placed = |(placement, motion): &(Placement, Motion)| {
            let moves = time != 0.0 && !motion.is_none();
            if moves { Placed::new(&placement.at(motion, time)) } else { Placed::new(placement) }
        };
        let mut links = self.links.iter();
        let first = links.next().map_or_else(|| Placed::new(&Placement::default()), placed);
        links.fold(first, |outer, link| outer.of(&placed(link)))
    }

    /// By how much, at most, a point of an object at most `reach` from its origin moves per unit of
    /// time until `shutter`.
    pub(super) fn speed(&self, mut reach: f64, shutter: f64) -> f64 {
        let mut speed = 0.0;
        for (placement, motion) in self.links.iter().rev() {
            let largest = placement.scale.max_element();
            let turn = motion.rotate_degrees.abs().element_sum().to_radians();
            (reach, speed) = (reach * largest, speed * largest);
            speed += reach * turn + motion.translate.length();
            reach += placement.translate.length() + motion.translate.length() * shutter;
        }
        speed
    }
}

/// What a scene's solids are seen as.
#[derive(Debug, Default)]
pub(in crate::geometry) struct Parts {
    /// Per solid where it is, if it is seen as it is.
    pub(in crate::geometry) plain: Vec<Option<Chain>>,
    /// Per solid what is to be made of others on its behalf: another solid, or itself, and where.
    pub(in crate::geometry) made: Vec<Vec<(usize, Chain)>>,
}

impl Parts {
    /// Those of a scene: a solid that no other is made of is seen, but for a union, of which the
    /// operands are.
    pub(in crate::geometry) fn of(scene: &Scene) -> Parts {
        let moving = scene.shutter_time().is_some();
        let count = scene.solids.len();
        let mut parts = Parts { plain: vec![None; count], made: vec![Vec::new(); count] };
        let mut uses = vec![0u32; count];
        let operands = scene.solids.iter().flat_map(|solid| solid.shape.operands());
        operands.for_each(|&operand| uses[operand] += 1);
        for root in (0..count).filter(|&solid| uses[solid] == 0) {
            let mut open = vec![(root, Chain::default().with(scene, root))];
            while let Some((solid, chain)) = open.pop() {
                match &scene.solids[solid].shape {
                    Shape::Csg { operation: Operation::Union, operands } => {
                        let within = |&operand| (operand, chain.with(scene, operand));
                        open.extend(operands.iter().rev().map(within));
                    }
                    Shape::Csg { .. } => parts.made[root].push((solid, chain)),
                    // What is there twice, or moves within what moves, is made of itself.
                    _ if solid != root && (uses[solid] > 1 || (moving && chain.moves())) => {
                        parts.made[root].push((solid, chain));
                    }
                    _ => parts.plain[solid] = Some(chain),
                }
            }
        }
        parts
    }
}

/// A composite while it is built.
struct Builder<'a> {
    scene: &'a Scene,
    /// Until when things move.
    shutter: Option<f64>,
    /// At which rays are asked about.
    level: Level,
    /// The number of the next primitive.
    next: u32,
    gates: Vec<Gate>,
    leaves: Vec<Leaf>,
}

impl Composite {
    /// Makes `solid`, whose primitives are numbered from `first` on.
    pub(in crate::geometry) fn new(
        scene: &Scene,
        (solid, chain): (usize, Chain),
        first: u32,
        level: Level,
        progress: &Progress,
    ) -> Result<Composite, Cancelled> {
        let shutter = scene.shutter_time();
        let mut builder =
            Builder { scene, shutter, level, next: first, gates: Vec::new(), leaves: Vec::new() };
        let all = operation(&scene.solids[solid].shape, false).is_none_or(|(all, _)| all);
        builder.gates.push(Gate::new(all, NO_PARENT));
        builder.add(0, solid, &chain, false, progress)?;
        let Builder { scene: _, shutter: _, level: _, next, mut gates, mut leaves } = builder;
        for gate in 0..gates.len() {
            cluster(&mut gates, &mut leaves, gate);
        }
        finish(&mut gates, &leaves);
        let size = leaves.iter().map(Leaf::size).fold(0.0, f64::max);
        let count = next - first;
        let gate_counts = gates.iter().map(|gate| gate.start).collect();
        let leaf_counts = leaves.iter().map(|leaf| i32::from(leaf.complement)).collect();
        let first_counts = [gate_counts, leaf_counts];
        Ok(Composite { gates, leaves, solid: solid as u32, first, count, size, first_counts })
    }
}

/// Whether a solid made of others, or its complement, is all of its operands or any of them, and of
/// which operands the complement is meant; `None` of a plain solid.
fn operation(shape: &Shape, complement: bool) -> Option<(bool, Vec<(usize, bool)>)> {
    let Shape::Csg { operation, operands } = shape else { return None };
    let turned = |place: usize| match operation {
        Operation::Union | Operation::Merge | Operation::Intersection => false,
        Operation::Difference => place > 0,
        Operation::Complement => true,
    };
    let all = !matches!(operation, Operation::Union | Operation::Merge);
    let signed = operands.iter().enumerate();
    let signed = signed.map(|(place, &operand)| (operand, turned(place) != complement));
    Some((all != complement, signed.collect()))
}

impl Builder<'_> {
    /// Adds a solid, or its complement, to a gate.
    fn add(
        &mut self,
        gate: u32,
        solid: usize,
        chain: &Chain,
        complement: bool,
        progress: &Progress,
    ) -> Result<(), Cancelled> {
        progress.check()?;
        let Some((all, operands)) = operation(&self.scene.solids[solid].shape, complement) else {
            let made = (self.scene, solid, chain, self.shutter);
            let number = self.leaves.len() as u32;
            let leaf =
                Leaf::new(made, (number, self.next), (gate, complement), self.level, progress)?;
            self.next += leaf.count();
            self.gates[gate as usize].children.push(Child::Leaf(number));
            self.leaves.push(leaf);
            return Ok(());
        };
        let mut within = gate;
        if all != self.gates[gate as usize].all {
            within = self.gates.len() as u32;
            self.gates[gate as usize].children.push(Child::Gate(within));
            self.gates.push(Gate::new(all, gate));
        }
        for (operand, complement) in operands {
            let chain = chain.with(self.scene, operand);
            self.add(within, operand, &chain, complement, progress)?;
        }
        Ok(())
    }
}

impl Gate {
    fn new(all: bool, parent: u32) -> Gate {
        let (bounds, changes) = (EVERYWHERE, EVERYWHERE);
        Gate { all, parent, children: Vec::new(), boxes: Vec::new(), start: 0, bounds, changes }
    }
}

const EVERYWHERE: [DVec3; 2] = [DVec3::NEG_INFINITY, DVec3::INFINITY];

/// A box that holds nothing.
const NOWHERE: [DVec3; 2] = [DVec3::INFINITY, DVec3::NEG_INFINITY];

/// Gathers the many leaves of a gate that a line mostly misses, what is cut out or joined, in gates of
/// their own by place, which change nothing but that they are left out together.
fn cluster(gates: &mut Vec<Gate>, leaves: &mut [Leaf], index: usize) {
    let all = gates[index].all;
    let children = std::mem::take(&mut gates[index].children);
    let idle = |child: &Child| match child {
        Child::Leaf(leaf) => leaves[*leaf as usize].complement == all,
        Child::Gate(_) => false,
    };
    let (mut idle, mut others): (Vec<Child>, Vec<Child>) = children.into_iter().partition(idle);
    if idle.is_empty() || others.len() + idle.len() <= WIDTH {
        others.append(&mut idle);
    } else {
        others.extend(clustered(gates, leaves, index as u32, idle));
    }
    gates[index].children = others;
}

/// Gates below `parent`, of a few leaves or gates each: at most as many as are tested together.
fn clustered(
    gates: &mut Vec<Gate>,
    leaves: &mut [Leaf],
    parent: u32,
    mut children: Vec<Child>,
) -> Vec<Child> {
    let parts = sorted_parts(leaves, &mut children);
    let mut within = Vec::with_capacity(parts.len());
    for part in parts {
        let gate = gates.len() as u32;
        let new = Gate::new(gates[parent as usize].all, parent);
        gates.push(new);
        let children = if part.len() > WIDTH {
            clustered(gates, leaves, gate, part)
        } else {
            for child in &part {
                if let Child::Leaf(leaf) = child {
                    leaves[*leaf as usize].gate = gate;
                }
            }
            part
        };
        gates[gate as usize].children = children;
        within.push(Child::Gate(gate));
    }
    within
}

/// At most eight parts of some leaves by place, cut in halves across the longest way.
fn sorted_parts(leaves: &[Leaf], children: &mut Vec<Child>) -> Vec<Vec<Child>> {
    let mut parts = vec![std::mem::take(children)];
    while parts.len() < WIDTH {
        let most = (0..parts.len()).max_by_key(|&part| parts[part].len()).unwrap_or(0);
        if parts[most].len() <= WIDTH / 2 {
            break;
        }
        let mut lower = parts.swap_remove(most);
        let upper = halve(leaves, &mut lower);
        parts.extend([lower, upper]);
    }
    parts
}

/// Takes the upper half of some leaves along the axis in which their middles differ most.
fn halve(leaves: &[Leaf], children: &mut Vec<Child>) -> Vec<Child> {
    let middle = |child: &Child| match child {
        // What has no end comes last.
        Child::Leaf(leaf) => {
            let [lo, hi] = leaves[*leaf as usize].bounds;
            let middle = (lo + hi) * 0.5;
            if middle.is_finite() { middle } else { DVec3::INFINITY }
        }
        Child::Gate(_) => DVec3::INFINITY,
    };
    let middles = children.iter().map(middle).filter(|middle| middle.is_finite());
    let [lo, hi] = middles.fold(NOWHERE, |[a, b], m| [a.min(m), b.max(m)]);
    let extent = hi - lo;
    let axis = (0..3).max_by(|&a, &b| extent[a].total_cmp(&extent[b])).unwrap_or(0);
    children.sort_by(|a, b| middle(a)[axis].total_cmp(&middle(b)[axis]));
    children.split_off(children.len() / 2)
}

/// Orders children, and finds out what is there at the beginning and where, children first.
fn finish(gates: &mut [Gate], leaves: &[Leaf]) {
    for i in (0..gates.len()).rev() {
        let of = |child: &Child| match child {
            Child::Leaf(leaf) => {
                let leaf = &leaves[*leaf as usize];
                let bounds = if leaf.complement { EVERYWHERE } else { leaf.bounds };
                (leaf.complement, bounds, leaf.bounds)
            }
            Child::Gate(gate) => {
                let gate = &gates[*gate as usize];
                (gate.is_there_first(), gate.bounds, gate.changes)
            }
        };
        let all = gates[i].all;
        let known: Vec<(bool, [DVec3; 2], [DVec3; 2])> = gates[i].children.iter().map(of).collect();
        let around = |[a, b]: [DVec3; 2], [lo, hi]: [DVec3; 2]| [a.min(lo), b.max(hi)];
        let within = |[a, b]: [DVec3; 2], [lo, hi]: [DVec3; 2]| [a.max(lo), b.min(hi)];
        let bounds = known.iter().map(|(_, bounds, _)| *bounds);
        let bounds =
            if all { bounds.fold(EVERYWHERE, within) } else { bounds.fold(NOWHERE, around) };
        let changes = known.iter().map(|(_, _, changes)| *changes).fold(NOWHERE, around);
        let start = known.iter().filter(|(there, _, _)| *there).count() as i32;
        let mut order: Vec<usize> = (0..known.len()).collect();
        let is_gate = |child: &Child| matches!(child, Child::Gate(_));
        order.sort_by_key(|&k| (known[k].0, is_gate(&gates[i].children[k])));
        // One that is never there makes "all of" nothing, one that always is "any of" all.
        let of = |&k: &usize| (known[k].2, known[k].0 != all);
        let boxes = Boxes::around(&order.iter().map(of).collect::<Vec<_>>());
        let children = order.into_iter().map(|k| gates[i].children[k]).collect();
        let new = Gate::new(all, gates[i].parent);
        let gate = Gate { children, boxes, start, bounds, changes, ..new };
        // What is not there at first is there only in its bounds.
        let changes = if gate.is_there_first() { changes } else { within(changes, bounds) };
        gates[i] = Gate { changes, ..gate };
    }
}
