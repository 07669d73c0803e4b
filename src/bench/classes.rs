//! What edits of every class cost, beside what they may cost.

use std::time::Instant;

use serde_json::{Value, json};

use super::{EDIT_SECONDS, Random, Spread, random_edit};
use crate::progress::Progress;
use crate::scene::path::{parameters, set};
use crate::scene::range::Kind;
use crate::scene::{Light, LightPlace, Scene};
use crate::session::cost::{Cost, cost};
use crate::session::trace::TraceError;
use crate::session::{Class, Session};

/// Seconds after which no further edit that regrows is measured.
const REGROW_SECONDS: f64 = 20.0;

/// Times that edits are held against.
pub(super) struct Yardstick {
    /// A trace with all that is kept, in milliseconds.
    pub(super) trace: f64,
    /// Its rays.
    pub(super) rays: f64,
    /// A full re-shade to 8 bits, in milliseconds.
    pub(super) reshade: f64,
    /// The 99th percentile of the same: what else the machine does is in it, as in that of edits.
    pub(super) reshade_p99: f64,
}

/// One row per class: exponents, random edits without rays, edits that regrow, badges.
pub(super) fn measure(session: &mut Session, by: &Yardstick) -> Result<Value, TraceError> {
    let badges = badges(session);
    let (mut regrows, mut left_out) = (Vec::new(), Vec::new());
    let started = Instant::now();
    for (what, scene) in regrowing(session) {
        if started.elapsed().as_secs_f64() > REGROW_SECONDS {
            left_out.push(what);
            continue;
        }
        let back = session.shared_scene();
        regrows.push(regrow(session, &what, scene, by)?);
        regrows.push(regrow(session, &format!("{what}, undone"), (*back).clone(), by)?);
    }
    let exponents = exponents(session, by)?;
    let refold = exponents["ms"]["median"].as_f64().unwrap_or(f64::NAN);
    let random = random_edits(session, by, refold)?;
    Ok(json!({
        "exponents": exponents, "random": random, "badges": badges, "regrow": regrows,
        "left_out": left_out,
    }))
}

/// The exponents of all materials at once.
fn exponents(session: &mut Session, by: &Yardstick) -> Result<Value, TraceError> {
    let mut times = Vec::new();
    for run in 0..15 {
        let mut edited = session.scene().clone();
        for material in &mut edited.materials {
            material.shininess = 5.0 + 7.0 * run as f32;
        }
        times.push(session.edit(edited, &Progress::default())?.milliseconds);
    }
    let times = Spread::of(times);
    Ok(json!({ "ms": times.json(), "of_trace": times.median / by.trace }))
}

/// Up to a thousand random edits of one parameter each that cast no ray.
fn random_edits(session: &mut Session, by: &Yardstick, refold: f64) -> Result<Value, TraceError> {
    let kinds = [Kind::Coefficient, Kind::Number, Kind::Flag];
    let all = parameters(session.scene()).into_iter().filter(|p| kinds.contains(&p.kind));
    let names: Vec<String> = all.map(|p| p.path).collect();
    let mut random = Random(0xed17);
    let (mut reshades, mut refolds) = (Vec::new(), Vec::new());
    let started = Instant::now();
    for _ in 0..20_000 {
        let late = started.elapsed().as_secs_f64() > EDIT_SECONDS;
        if reshades.len() + refolds.len() == 1000 || names.is_empty() || late {
            break;
        }
        let name = &names[random.below(names.len())];
        let Some(edited) = random_edit(session.scene(), name, &mut random) else { continue };
        let edited = std::sync::Arc::new(edited);
        let start = Instant::now();
        match session.edit_without_rays(&edited).map(|report| report.class) {
            Ok(Class::Reshade) => reshades.push(start.elapsed().as_secs_f64() * 1e3),
            Ok(Class::Refold) => refolds.push(start.elapsed().as_secs_f64() * 1e3),
            _ => {}
        }
    }
    let (reshades, refolds) = (Spread::of(reshades), Spread::of(refolds));
    Ok(json!({
        "reshade_ms": reshades.json(), "p99_over_full_reshade": reshades.p99 / by.reshade,
        "p99_over_p99_of_full_reshade": reshades.p99 / by.reshade_p99,
        "refold_ms": refolds.json(), "p99_over_full_refold": refolds.p99 / refold,
    }))
}

/// The time to know what every parameter costs.
fn badges(session: &mut Session) -> Value {
    let mut times = Vec::new();
    let mut slowest = (0.0, String::new());
    for parameter in parameters(&session.scene().clone()) {
        let start = Instant::now();
        cost(session, &parameter.path);
        let time = start.elapsed().as_secs_f64() * 1e3;
        if time > slowest.0 {
            slowest = (time, parameter.path);
        }
        times.push(time);
    }
    json!({ "ms": Spread::of(times).json(), "slowest": slowest.1, "slowest_ms": slowest.0 })
}

/// Edits that read trees again or grow them.
fn regrowing(session: &mut Session) -> Vec<(String, Scene)> {
    let scene = session.scene().clone();
    let mut edits = Vec::new();
    let mut edit = |what: String, change: &dyn Fn(&mut Scene)| {
        let mut edited = scene.clone();
        change(&mut edited);
        edits.push((what, edited));
    };
    if let Some(LightPlace::Point(point)) = scene.lights.first().map(|light| light.place.clone()) {
        edit("a light moved".into(), &|s| {
            s.lights[0].place = LightPlace::Point(point * 0.9);
        });
    }
    edit("a light added".into(), &|s| s.lights.push(Light::new("bench light")));
    if !scene.lights.is_empty() {
        edit("a light removed".into(), &|s| drop(s.lights.remove(0)));
    }
    for (i, material) in scene.materials.iter().enumerate().take(4) {
        let name = &material.name;
        if scene.ior_matters(i) {
            edit(format!("ior of {name}"), &|s| s.materials[i].ior *= 1.1);
        }
        for (key, value) in [("reflect", "0.5"), ("transmit", "0.5")] {
            let path = format!("materials.{name}.{key}");
            if let Some(Cost::InstantUpTo(limit, _)) = cost(session, &path)
                && limit < 0.5
            {
                edit(format!("{key} of {name}"), &|s| drop(set(s, &path, value)));
            }
        }
    }
    edit("depth".into(), &|s| s.trace.depth += 1);
    edit("cut-off".into(), &|s| s.trace.cutoff /= 2.0);
    if scene.materials.len() > 1 && !scene.solids.is_empty() {
        let other = (scene.solids[0].material + 1) % scene.materials.len();
        edit("material of a solid".into(), &|s| s.solids[0].material = other);
    }
    edits
}

fn regrow(
    session: &mut Session,
    what: &str,
    scene: Scene,
    by: &Yardstick,
) -> Result<Value, TraceError> {
    let class = session.class_of(&scene);
    let report = session.edit(scene, &Progress::default())?;
    let share = report.rays.total() as f64 / by.rays;
    let allowed = 1.3 * share * by.trace + by.reshade + 5.0;
    Ok(json!({
        "edit": what, "class_beforehand": class.to_string(), "class": report.class.to_string(),
        "pixels": report.pixels, "rays": report.rays.total(), "share_of_rays": share,
        "ms": report.milliseconds, "allowed_ms": allowed,
        "over_allowed": report.milliseconds / allowed,
        "of_trace": report.milliseconds / by.trace,
    }))
}

/// A few lines for people.
pub(super) fn summary(classes: &Value) -> String {
    let number = |path: &str| classes.pointer(path).and_then(Value::as_f64).unwrap_or(f64::NAN);
    let mut text = format!(
        "\n  exponents {:.2} ms ({:.4} of the trace); random edits: re-shade p99 {:.2} ms ({:.2} × \
         full), refold p99 {:.2} ms ({:.2} × full); badge {:.3} ms, slowest {:.2} ms",
        number("/exponents/ms/median"),
        number("/exponents/of_trace"),
        number("/random/reshade_ms/p99"),
        number("/random/p99_over_full_reshade"),
        number("/random/refold_ms/p99"),
        number("/random/p99_over_full_refold"),
        number("/badges/ms/median"),
        number("/badges/slowest_ms"),
    );
    for row in classes["regrow"].as_array().into_iter().flatten() {
        let number = |key: &str| row[key].as_f64().unwrap_or(f64::NAN);
        text += &format!(
            "\n  {}: {}, {:.1} M pixels, {:.1} % of the rays, {:.0} ms ({:.2} of the trace, {:.2} × \
             allowed)",
            row["edit"].as_str().unwrap_or("?"),
            row["class"].as_str().unwrap_or("?"),
            number("pixels") / 1e6,
            number("share_of_rays") * 100.0,
            number("ms"),
            number("of_trace"),
            number("over_allowed"),
        );
    }
    text
}
