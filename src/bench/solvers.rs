//! Measures ways to find where a ray meets a torus: nanoseconds against errors.

use std::hint::black_box;

use glam::DVec3;
use serde_json::{Value, json};

use super::{Random, Spread};
use crate::clock::thread_seconds;
use crate::geometry::solvers::{Category, Found, SOLVERS, Solver, judge, lines};

/// Rays that are timed, most of which meet the torus, and times that they are asked.
const RAYS: usize = 20_000;
const RUNS: usize = 9;
/// Its minor radius.
const MINOR: f64 = 0.3;

/// One row per solver: nanoseconds of processor time per ray, and what it makes of lines whose
/// crossings are known: how many it gets wrong, and how far off the worst of the others is.
pub fn measure() -> Value {
    let mut random = Random(41);
    let mut signed = || 2.0 * random.unit() - 1.0;
    let rays: Vec<(DVec3, DVec3)> = (0..RAYS).map(|_| ray(&mut signed)).collect();
    let categories = lines(&mut signed);
    let rows = SOLVERS.map(|(name, solver)| {
        json!({
            "solver": name,
            "ns_per_ray": nanoseconds(solver, &rays),
            "usual": row(solver, &categories, |name| name == "minor radius 0.3"),
            "far": row(solver, &categories, |name| name.starts_with("from")),
            "tangent": row(solver, &categories, |name| name.starts_with("tangent")),
            "all": row(solver, &categories, |_| true),
        })
    });
    json!({ "torus": rows })
}

/// From a distance of about 4 towards the solid.
fn ray(signed: &mut dyn FnMut() -> f64) -> (DVec3, DVec3) {
    let mut point = || DVec3::new(signed(), signed(), signed());
    let from = loop {
        let p = point();
        if (0.1..1.0).contains(&p.length_squared()) {
            break p.normalize() * 4.0;
        }
    };
    let to = point() * DVec3::new(1.2, 1.2, 0.4);
    (from, (to - from).normalize())
}

fn nanoseconds(solver: Solver, rays: &[(DVec3, DVec3)]) -> f64 {
    let run = |_| {
        let before = thread_seconds();
        for (o, d) in rays {
            black_box(solver(MINOR, *o, *d));
        }
        1e9 * (thread_seconds() - before) / rays.len() as f64
    };
    Spread::of((0..RUNS).map(run).collect()).median
}

/// What a solver makes of the lines of some categories.
fn row(solver: Solver, categories: &[Category], wanted: impl Fn(&str) -> bool) -> Value {
    let (mut lines, mut all) = (0, Found::default());
    for Category { name: _, cases } in categories.iter().filter(|c| wanted(&c.name)) {
        let Found { wrong, error, share } = judge(solver, cases);
        lines += cases.len();
        all.wrong += wrong;
        all.error = all.error.max(error);
        all.share = all.share.max(share);
    }
    let Found { wrong, error, share } = all;
    json!({ "lines": lines, "wrong": wrong, "worst_error": error, "of_allowed": share })
}

/// A table for people.
pub fn summary(measured: &Value) -> String {
    let number = |value: &Value| value.as_f64().unwrap_or(f64::NAN);
    let line = |row: &Value| {
        let of = |kind: &str| {
            let row = &row[kind];
            format!("{} / {:.0e}", row["wrong"], number(&row["worst_error"]))
        };
        let name = row["solver"].as_str().unwrap_or("?");
        let ns = number(&row["ns_per_ray"]);
        let [usual, far, tangent] = ["usual", "far", "tangent"].map(of);
        format!("\n  {name:<34} {ns:>5.0} {usual:>14} {far:>14} {tangent:>14}")
    };
    let rows = measured["torus"].as_array().into_iter().flatten();
    let head = ["torus", "ns", "usual lines", "far", "tangent"];
    let [name, ns, usual, far, tangent] = head;
    format!(
        "lines with wrong crossings / worst error of the others:\n  {name:<34} {ns:>5} {usual:>14} \
         {far:>14} {tangent:>14}{}",
        rows.map(line).collect::<String>()
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_solver_has_a_row() {
        let row = measure();
        let all = row["torus"].as_array().unwrap();
        assert_eq!(all.len(), SOLVERS.len());
        assert!(all.iter().all(|row| row["ns_per_ray"].as_f64().is_some_and(|ns| ns > 0.0)));
        assert_eq!(all[0]["all"]["wrong"], 0);
        assert!(all[3]["far"]["wrong"].as_u64() > Some(0));
        assert!(summary(&row).contains("between turning points (ours)"), "{}", summary(&row));
    }
}
