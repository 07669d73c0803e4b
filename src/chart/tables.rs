//! A chart as a table and as JSON, for other programs.

use serde_json::{Value, json};

use super::{Chart, Cost, Deviation, Goal, Point, Sweep, TIME, text_of};

/// One line per point, and one each for the scene as it is and for what is recommended.
pub fn csv(chart: &Chart) -> String {
    let mut text = String::from(
        "setting,value,seconds,runs,rays,rms_linear,rms_code_values,front,meets_goal\n",
    );
    let mut line = |name: &str, value: &str, cost: Cost, error: Option<Deviation>, front: &str| {
        let Cost { seconds, runs, rays } = cost;
        let (linear, codes) = match error {
            Some(Deviation { linear, codes }) => (linear.to_string(), codes.to_string()),
            None => Default::default(),
        };
        let meets = error.map_or_else(String::new, |error| chart.goal.is_met(error).to_string());
        text +=
            &format!("{name},{value},{seconds},{runs},{rays},{linear},{codes},{front},{meets}\n");
    };
    for Sweep { setting, points, .. } in &chart.sweeps {
        for Point { value, cost, error, front } in points {
            let front = front.to_string();
            line(setting.path, &text_of(*value), *cost, Some(*error), &front);
        }
    }
    line("present", "", chart.present, chart.present_error, "");
    line("recommended", "", chart.advice.cost, Some(chart.advice.error), "");
    text
}

/// Everything that was measured.
pub fn json(name: &str, chart: &Chart) -> Value {
    let Chart { size, threads, reference, goal, present, present_error, sweeps, advice } = chart;
    let values = sweeps.iter().zip(&advice.values);
    let values: serde_json::Map<String, Value> =
        values.map(|(s, value)| (s.setting.path.to_owned(), number(*value))).collect();
    let goal = match goal {
        Goal::Linear(most) => json!({ "rms_linear": most }),
        Goal::Codes(most) => json!({ "rms_code_values": most }),
    };
    json!({
        "scene": name,
        "size": size,
        "threads": threads,
        "reference_samples": reference,
        "error": "rms over pixels and channels after exposure, against the truth of each setting",
        "time": format!("{TIME} of tracing on all threads, median of the runs"),
        "goal": goal,
        "present": { "cost": cost(present), "error_at_most_about": present_error.map(error) },
        "settings": sweeps.iter().map(|s| swept(s, chart.goal)).collect::<Vec<_>>(),
        "recommended": {
            "values": values,
            "cost": cost(&advice.cost),
            "error_at_most_about": error(advice.error),
            "reaches_goal": advice.reached,
        },
    })
}

fn swept(sweep: &Sweep, goal: Goal) -> Value {
    let Sweep { setting, present, truth, points } = sweep;
    let point = |Point { value, cost: took, error: far, front }: &Point| {
        json!({
            "value": number(*value),
            "cost": cost(took),
            "error": error(*far),
            "front": front,
            "meets_goal": goal.is_met(*far),
        })
    };
    json!({
        "path": setting.path,
        "present": number(*present),
        "truth": number(*truth),
        "points": points.iter().map(point).collect::<Vec<_>>(),
    })
}

/// As in a scene file: the shortest decimal of the f32 that it is there.
fn number(value: f64) -> Value {
    text_of(value).parse::<serde_json::Number>().map_or(Value::Null, Value::Number)
}

fn cost(&Cost { seconds, runs, rays }: &Cost) -> Value {
    json!({ "seconds": seconds, "runs": runs, "rays": rays })
}

fn error(Deviation { linear, codes }: Deviation) -> Value {
    json!({ "rms_linear": linear, "rms_code_values": codes })
}
