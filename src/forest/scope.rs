//! Which products of parameters an edit gives other coefficients, where most of the matrix stays.

use crate::scene::factor::{Factor, Kind};

/// A set of terms whose coefficients are found anew, as an automaton over the factors of a path.
///
/// Growing follows it down the kept trees and leaves alone what it does not reach; folding adds the
/// terms of the set and no others. Every sample's part of such a term is found again, so that a sum
/// is the one that a fresh trace gives. Written by `session`, read by `forest` and `fold`.
#[derive(Clone, Debug, PartialEq)]
pub struct Scope {
    states: Vec<State>,
    /// Per light whether it is in the set where [`Scope::has_lights`] says so; lights that are not
    /// listed are.
    lights: Vec<bool>,
}

/// Where a path stands in a [`Scope`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct At(u32);

impl At {
    /// Every term of the path and below it is in the set.
    pub const ALL: At = At(u32::MAX);
    /// None is.
    pub const NONE: At = At(u32::MAX - 1);
}

#[derive(Clone, Debug, PartialEq)]
struct State {
    /// By factor.
    next: Vec<(Factor, At)>,
    /// For every other factor.
    otherwise: At,
    lights: bool,
}

impl Scope {
    /// Where the path from the eye begins.
    pub const EYE: At = At(0);

    /// The terms of these lights at every node; `lights` has one entry per light.
    pub fn of_lights(lights: Vec<bool>) -> Scope {
        let state = State { next: Vec::new(), otherwise: Scope::EYE, lights: true };
        Scope { states: vec![state], lights }
    }

    /// The terms that begin with any of these lists of factors, each of which ends in a path factor,
    /// or in that of a solid that stopped a shadow ray: then all light at the path before it is meant.
    pub fn below(branches: impl IntoIterator<Item = Vec<Factor>>) -> Scope {
        let mut scope = Scope { states: vec![State::deaf()], lights: Vec::new() };
        for factors in branches {
            scope.add(&factors);
        }
        scope
    }

    fn add(&mut self, factors: &[Factor]) {
        let Some((last, path)) = factors.split_last() else { return };
        let mut at = Scope::EYE;
        for &factor in path {
            at = match self.next(at, factor) {
                At::ALL => return,
                At::NONE => {
                    self.states.push(State::deaf());
                    let new = At(self.states.len() as u32 - 1);
                    self.set(at, factor, new);
                    new
                }
                known => known,
            };
        }
        match last.kind() {
            Kind::Shadow => self.states[at.0 as usize].lights = true,
            _ => self.set(at, *last, At::ALL),
        }
    }

    fn set(&mut self, at: At, factor: Factor, to: At) {
        let next = &mut self.states[at.0 as usize].next;
        match next.binary_search_by_key(&factor, |entry| entry.0) {
            Ok(known) => next[known].1 = to,
            Err(place) => next.insert(place, (factor, to)),
        }
    }

    /// Where a path stands that goes on with `factor`.
    #[inline(always)]
    pub fn next(&self, at: At, factor: Factor) -> At {
        let Some(state) = self.states.get(at.0 as usize) else { return at };
        match state.next.binary_search_by_key(&factor, |entry| entry.0) {
            Ok(known) => state.next[known].1,
            Err(_) => state.otherwise,
        }
    }

    /// Whether light that arrives at the path is in the set: all of it, or that of
    /// [some lights](Scope::has_light).
    #[inline(always)]
    pub fn has_lights(&self, at: At) -> bool {
        at == At::ALL || self.states.get(at.0 as usize).is_some_and(|state| state.lights)
    }

    /// Whether this light's terms are in the set where lights are.
    #[inline(always)]
    pub fn has_light(&self, light: usize) -> bool {
        self.lights.get(light).copied().unwrap_or(true)
    }
}

impl State {
    fn deaf() -> State {
        State { next: Vec::new(), otherwise: At::NONE, lights: false }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn f(kind: Kind, index: u16) -> Factor {
        Factor::new(kind, index, 0)
    }

    #[test]
    fn what_begins_with_a_branch_is_below_it() {
        let (a, b) = (f(Kind::Reflect, 0), f(Kind::Transmit, 1));
        let scope = Scope::below([vec![a, b], vec![b], vec![a, b, a]]);
        let below_a = scope.next(Scope::EYE, a);
        assert!(below_a != At::ALL && below_a != At::NONE);
        assert_eq!(scope.next(below_a, b), At::ALL);
        assert_eq!(scope.next(below_a, a), At::NONE);
        assert_eq!(scope.next(Scope::EYE, b), At::ALL);
        assert_eq!(scope.next(At::ALL, a), At::ALL);
        assert_eq!(scope.next(At::NONE, b), At::NONE);
        assert!(!scope.has_lights(Scope::EYE) && !scope.has_lights(At::NONE));
        assert!(scope.has_lights(At::ALL) && scope.has_light(3));
    }

    #[test]
    fn a_branch_that_comes_later_swallows_what_is_below_it() {
        let (a, b) = (f(Kind::Reflect, 0), f(Kind::Transmit, 1));
        let scope = Scope::below([vec![a, b], vec![a]]);
        assert_eq!(scope.next(Scope::EYE, a), At::ALL);
    }

    #[test]
    fn a_solid_that_stopped_light_means_the_light_at_its_path() {
        let (a, shadow) = (f(Kind::Reflect, 0), f(Kind::Shadow, 2));
        let scope = Scope::below([vec![a, shadow]]);
        let below_a = scope.next(Scope::EYE, a);
        assert!(scope.has_lights(below_a) && !scope.has_lights(Scope::EYE));
        assert_eq!(scope.next(below_a, a), At::NONE);
    }

    #[test]
    fn lights_are_meant_at_every_node() {
        let scope = Scope::of_lights(vec![false, true]);
        assert_eq!(scope.next(Scope::EYE, f(Kind::Reflect, 5)), Scope::EYE);
        assert!(scope.has_lights(Scope::EYE));
        assert!(!scope.has_light(0) && scope.has_light(1));
    }
}
