//! Which points nobody beats, and which combination of values is the fastest that is accurate enough.

use super::{Cost, Deviation, Goal, Point, Sweep, text_of};

/// A recommended combination of values.
#[derive(Clone, Debug, PartialEq)]
pub struct Advice {
    /// Per sweep its value, in the order of the sweeps.
    pub values: Vec<f64>,
    /// At most about this: the errors of the sweeps' points together.
    pub error: Deviation,
    /// What it takes: measured.
    pub cost: Cost,
    /// Whether the goal is reached; otherwise it is the most accurate that was measured.
    pub reached: bool,
}

impl Advice {
    /// Its values by their paths: `trace.samples = 16, trace.depth = 6`.
    pub fn text(&self, sweeps: &[Sweep]) -> String {
        let one = |(sweep, value): (&Sweep, &f64)| {
            format!("{} = {}", sweep.setting.path, text_of(*value))
        };
        sweeps.iter().zip(&self.values).map(one).collect::<Vec<_>>().join(", ")
    }
}

/// Marks the points that no other point of the sweep beats in both time and error. Of points with
/// equal errors the one of the fewest rays is left, whatever the clock said.
pub(super) fn mark_front(points: &mut [Point]) {
    let beats = |a: &Point, b: &Point| match a.error.linear == b.error.linear {
        true => a.cost.rays < b.cost.rays,
        false => a.error.linear < b.error.linear && a.cost.seconds <= b.cost.seconds,
    };
    let front: Vec<bool> =
        points.iter().map(|p| !points.iter().any(|other| beats(other, p))).collect();
    points.iter_mut().zip(front).for_each(|(point, front)| point.front = front);
}

/// A value for some of the sweeps, and what they make of the whole.
#[derive(Clone, Debug)]
struct Choice {
    values: Vec<f64>,
    /// Of the time of the scene as it is.
    share: f64,
    error: Deviation,
}

/// The values that are expected to take the least time with an error that meets the goal, or, where
/// none meet it, to have the least error; with that error, and whether it meets the goal.
///
/// Each setting is taken to change the time by the same factor whatever the others are. With twenty
/// values of four settings that is 160 000 combinations.
pub(super) fn best(sweeps: &[Sweep], present: Cost, goal: Goal) -> (Vec<f64>, Deviation, bool) {
    let mut choices = vec![Choice { values: vec![], share: 1.0, error: Deviation::default() }];
    for sweep in sweeps {
        let with = |choice: &Choice| {
            let front = sweep.points.iter().filter(|point| point.front);
            let more = |point: &Point| choice.with(point, present);
            front.map(more).collect::<Vec<_>>()
        };
        choices = choices.iter().flat_map(with).collect();
    }
    let met = choices.iter().filter(|choice| goal.is_met(choice.error));
    let fastest = met.min_by(|a, b| a.share.total_cmp(&b.share));
    let finest = || {
        let error = |choice: &Choice| goal.of(choice.error);
        choices.iter().min_by(|a, b| error(a).total_cmp(&error(b)))
    };
    let chosen = fastest.or_else(finest).expect("every sweep has a point that none beats");
    (chosen.values.clone(), chosen.error, fastest.is_some())
}

impl Choice {
    fn with(&self, point: &Point, present: Cost) -> Choice {
        let mut values = self.values.clone();
        values.push(point.value);
        let error = Deviation {
            linear: self.error.linear + point.error.linear,
            codes: self.error.codes + point.error.codes,
        };
        Choice { values, share: self.share * point.cost.seconds / present.seconds, error }
    }
}

#[cfg(test)]
mod tests {
    use super::super::SETTINGS;
    use super::*;

    fn point(value: f64, seconds: f64, linear: f64) -> Point {
        let cost = Cost { seconds, runs: 1, rays: (value * 10.0) as u64 };
        Point { value, cost, error: Deviation { linear, codes: linear * 100.0 }, front: false }
    }

    fn sweep(points: &[(f64, f64, f64)]) -> Sweep {
        let mut points: Vec<Point> = points.iter().map(|&(v, s, e)| point(v, s, e)).collect();
        mark_front(&mut points);
        Sweep { setting: SETTINGS[0], present: 1.0, truth: 99.0, points }
    }

    fn front(sweep: &Sweep) -> Vec<f64> {
        sweep.points.iter().filter(|p| p.front).map(|p| p.value).collect()
    }

    #[test]
    fn a_point_that_another_beats_is_not_of_the_front() {
        let all = sweep(&[(1., 1., 0.4), (2., 2., 0.2), (4., 4., 0.1)]);
        assert_eq!(front(&all), [1., 2., 4.]);
        // The second is slower than the third and less accurate.
        let some = sweep(&[(1., 1., 0.4), (2., 5., 0.2), (4., 4., 0.1)]);
        assert_eq!(front(&some), [1., 4.]);
        // Of equal pictures the one of the fewest rays, though the clock said otherwise.
        let flat = sweep(&[(1., 1., 0.4), (2., 5., 0.), (4., 4., 0.), (8., 4.5, 0.)]);
        assert_eq!(front(&flat), [1., 2.]);
    }

    #[test]
    fn the_fastest_combination_whose_errors_add_up_to_less_is_recommended() {
        let present = Cost { seconds: 2.0, runs: 1, rays: 20 };
        let samples = sweep(&[(1., 1., 0.4), (2., 2., 0.2), (4., 4., 0.1), (8., 8., 0.05)]);
        let depth = sweep(&[(3., 1.0, 0.3), (5., 2.0, 0.04), (9., 2.2, 0.)]);
        let sweeps = [samples, depth];
        let best = |goal| best(&sweeps, present, goal);
        let (values, error, met) = best(Goal::Linear(0.15));
        assert_eq!((values, met), (vec![4., 5.], true));
        assert!((error.linear - 0.14).abs() < 1e-12 && (error.codes - 14.0).abs() < 1e-9);
        // 0.1 + 0.04 is not below 0.14: a little more depth is faster than twice the samples.
        assert_eq!(best(Goal::Linear(0.139)).0, [4., 9.]);
        assert_eq!(best(Goal::Codes(50.0)).0, [1., 5.]);
        let (values, error, met) = best(Goal::Linear(0.001));
        assert_eq!((values, error.linear, met), (vec![8., 9.], 0.05, false));
    }
}
