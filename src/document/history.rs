//! Steps of editing that can be taken back and done again; the edits of one gesture are one step.

use std::sync::{Arc, OnceLock};

use super::step;
use crate::scene::Scene;
use crate::scene::fields::{self, Need, Visit};
use crate::scene::slot::Slot;

/// The largest number of steps kept; older ones are forgotten.
const MOST_STEPS: usize = 1000;

/// The states of a scene in the order in which they came about.
pub(super) struct History {
    /// Never empty.
    states: Vec<State>,
    /// Index of the present state.
    at: usize,
    /// While a gesture lasts: the states that it made unreachable, if it changes anything.
    gesture: Option<Vec<State>>,
}

struct State {
    scene: Arc<Scene>,
    /// Name of the step from the state before, once somebody asked for it.
    name: OnceLock<String>,
}

impl State {
    fn new(scene: Scene) -> State {
        State { scene: Arc::new(scene), name: OnceLock::new() }
    }
}

impl History {
    pub(super) fn new(scene: Scene) -> History {
        History { states: vec![State::new(scene)], at: 0, gesture: None }
    }

    pub(super) fn scene(&self) -> &Arc<Scene> {
        &self.states[self.at].scene
    }

    pub(super) fn change(&mut self, scene: Scene) {
        if self.gesture.is_some() {
            self.states[self.at] = State::new(scene);
        } else if !same_bits(self.scene(), &scene) {
            self.gesture = Some(self.states.split_off(self.at + 1));
            self.states.push(State::new(scene));
            self.at += 1;
        }
    }

    /// Names the step of the gesture that lasts, until it goes on.
    pub(super) fn name_step(&mut self, name: String) {
        if self.gesture.is_some() {
            self.states[self.at].name = OnceLock::from(name);
        }
    }

    /// Ends a gesture; one that changed nothing leaves no step and takes nothing away from redo.
    pub(super) fn end_gesture(&mut self) {
        let Some(undone) = self.gesture.take() else { return };
        if self.is_idle() {
            self.states.pop();
            self.at -= 1;
            self.states.extend(undone);
        } else if self.at > MOST_STEPS {
            self.states.remove(0);
            self.at -= 1;
        }
    }

    /// Whether the latest step changes nothing.
    fn is_idle(&self) -> bool {
        self.at > 0 && same_bits(&self.states[self.at - 1].scene, self.scene())
    }

    pub(super) fn undo(&mut self) -> bool {
        self.end_gesture();
        let is_there = self.at > 0;
        self.at -= usize::from(is_there);
        is_there
    }

    pub(super) fn redo(&mut self) -> bool {
        self.end_gesture();
        let is_there = self.at + 1 < self.states.len();
        self.at += usize::from(is_there);
        is_there
    }

    pub(super) fn undo_name(&self) -> Option<&str> {
        let is_idle = self.gesture.is_some() && self.is_idle();
        self.name(self.at - usize::from(is_idle))
    }

    pub(super) fn redo_name(&self) -> Option<&str> {
        match &self.gesture {
            Some(_) => None,
            None => self.name(self.at + 1),
        }
    }

    /// Name of the step that leads to a state.
    fn name(&self, index: usize) -> Option<&str> {
        let before = self.states.get(index.checked_sub(1)?)?;
        let State { scene, name } = self.states.get(index)?;
        Some(name.get_or_init(|| step::name(&before.scene, scene)))
    }

    /// Edits every state alike, such as when the scene moves to another folder.
    pub(super) fn edit_all(&mut self, edit: &mut dyn FnMut(&mut Scene)) {
        for state in self.states.iter_mut().chain(self.gesture.iter_mut().flatten()) {
            edit(Arc::make_mut(&mut state.scene));
        }
    }
}

/// Whether two scenes are the same to the last bit: unlike `==`, -0 is not 0.
pub(super) fn same_bits(a: &Scene, b: &Scene) -> bool {
    let bits = |scene: &Scene| {
        let mut bits = Bits(Vec::new());
        fields::scene(&mut scene.clone(), &mut bits);
        bits.0
    };
    a == b && bits(a) == bits(b)
}

/// Notes the bits of every number that has a sign.
struct Bits(Vec<u64>);

impl Visit for Bits {
    fn leaf(&mut self, _: &'static str, _: Need, slot: Slot<'_>) {
        match slot {
            Slot::Coefficient(rgb, _) => {
                self.0.extend(rgb.0.map(|channel| u64::from(channel.to_bits())));
            }
            Slot::Single(x, _) => self.0.push(u64::from(x.to_bits())),
            Slot::Number(x, _) => self.0.push(x.to_bits()),
            Slot::Vector(v, _) | Slot::Scale(v, _) => {
                self.0.extend(v.to_array().map(f64::to_bits));
            }
            Slot::Points(points, _) => {
                self.0.extend(points.iter().flat_map(|p| p.to_array()).map(f64::to_bits));
            }
            Slot::Loops(loops, _) => {
                self.0.extend(loops.iter().flatten().flat_map(|p| p.to_array()).map(f64::to_bits));
            }
            Slot::Whole(..)
            | Slot::Pair(..)
            | Slot::Flag(_)
            | Slot::Choice(_)
            | Slot::Material(_)
            | Slot::Solids(_)
            | Slot::Mesh { .. }
            | Slot::Image(_) => {}
        }
    }

    fn group(&mut self, _: &str, _: Need, body: &mut dyn FnMut(&mut dyn Visit)) {
        body(self);
    }
}
