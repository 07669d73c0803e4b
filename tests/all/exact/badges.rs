//! The cost shown before an edit is the class of the edit, for every parameter of every scene.

use rayforest::progress::Progress;
use rayforest::scene::path::{self, Parameter, parameters};
use rayforest::scene::range::Kind;
use rayforest::scene::{Scene, check};
use rayforest::session::cost::{Cost, Pixels, cost};
use rayforest::session::{Class, Options, Session};

use super::{SHIPPED, open, set, shipped};

const NONE: Pixels = Pixels { count: 0, of: 1, rays: 0, released: false, at_most: false };

/// The numbers of a TOML value.
fn numbers(value: &str) -> Vec<f64> {
    let inside = value.trim_matches(['[', ']']);
    inside.split(',').map(|n| n.trim().parse().unwrap()).collect()
}

/// The scene with every channel of a parameter raised to at least `value`, or the number itself
/// set, if it is one that counts or bounds.
fn raised(scene: &Scene, parameter: &Parameter, value: f64) -> Scene {
    moved(scene, parameter, value, f64::max)
}

/// The same, channels lowered to at most `value`.
fn lowered(scene: &Scene, parameter: &Parameter, value: f64) -> Scene {
    moved(scene, parameter, value, f64::min)
}

fn moved(scene: &Scene, parameter: &Parameter, value: f64, to: fn(f64, f64) -> f64) -> Scene {
    let mut moved = scene.clone();
    let text = match parameter.kind {
        Kind::Coefficient => {
            let channels = numbers(&parameter.value).into_iter().cycle().take(3);
            format!("{:?}", channels.map(|c| to(c, value)).collect::<Vec<_>>())
        }
        Kind::Whole => format!("{}", value as u32),
        _ => format!("{value:?}"),
    };
    set(&mut moved, &parameter.path, &text);
    moved
}

/// Values on both sides of a limit: those that need no ray, and those that do.
fn around(parameter: &Parameter, limit: f64, up: bool) -> (f64, f64) {
    if parameter.path.ends_with(".ior") {
        return (limit, limit.next_down());
    }
    let single = limit as f32;
    assert_eq!(f64::from(single), limit, "{}: a limit between two values", parameter.path);
    let beyond = match (parameter.kind, up) {
        (Kind::Whole, true) => limit + 1.0,
        (Kind::Whole, false) => limit - 1.0,
        (_, true) => f64::from(single.next_up()),
        (_, false) => f64::from(single.next_down()),
    };
    (limit, beyond)
}

/// Some other legal values of a parameter.
fn others(scene: &Scene, parameter: &Parameter) -> Vec<Scene> {
    let mut values: Vec<String> = ["0", "0.004", "0.37", "1", "2", "5", "10", "false", "true"]
        .into_iter()
        .chain(["[0.1, 0.2, 0.3]", "[0, 2, 0.5]", "[3, 5]", "[9, 31]", "1e6"])
        .map(str::to_owned)
        .collect();
    let ranks = scene.materials.iter().filter(|m| m.priority != scene.materials[0].priority);
    values.extend(scene.materials.iter().take(2).chain(ranks.take(1)).map(|m| m.name.clone()));
    let legal = values.into_iter().filter_map(|value| {
        let mut other = scene.clone();
        path::set(&mut other, &parameter.path, &value).ok()?;
        (other != *scene && check::validate(&other).is_empty()).then_some(other)
    });
    legal.collect()
}

/// What a cost claims, held to the classes of edits; what is wrong with it.
fn lie(session: &mut Session, parameter: &Parameter, cost: Cost) -> Option<String> {
    let scene = session.scene().clone();
    let range = parameter.range;
    let mut class = |edited: &Scene| session.class_of(edited);
    let mut claim = |edited: &Scene, holds: &dyn Fn(Class) -> bool| {
        let class = class(edited);
        let path = &parameter.path;
        (!holds(class)).then(|| format!("{path} is {cost:?}, but an edit is {class}"))
    };
    let instant = |class: Class| class <= Class::Reshade;
    // Below the limit of an index of refraction nothing is cast where nothing is let through.
    let reread = matches!(cost, Cost::RereadBelow(..));
    let traced = |class: Class| class == Class::Regrow || (reread && class == Class::Refold);
    match cost {
        Cost::InstantUpTo(limit, _)
        | Cost::InstantDownTo(limit, _)
        | Cost::RereadBelow(limit, _) => {
            let up = matches!(cost, Cost::InstantUpTo(..));
            let (within, beyond) = around(parameter, limit, up);
            let lowers = !up && parameter.kind != Kind::Number;
            let raised = if lowers { lowered } else { raised };
            let half = match (up, reread) {
                (true, _) => within / 2.0,
                (false, true) => within * 2.0,
                (false, false) if parameter.kind == Kind::Whole => within,
                (false, false) => within.midpoint(1.0),
            };
            claim(&raised(&scene, parameter, within), &instant)
                .or_else(|| claim(&raised(&scene, parameter, beyond), &traced))
                .or_else(|| claim(&raised(&scene, parameter, half), &instant))
        }
        Cost::InstantWithin([low, high], _) => {
            let [below, above] = [(low, false), (high, true)].map(|(limit, up)| {
                let (within, beyond) = around(parameter, limit, up);
                let to = if up { raised } else { lowered };
                claim(&to(&scene, parameter, within), &instant)
                    .or_else(|| claim(&to(&scene, parameter, beyond), &traced))
            });
            below.or(above)
        }
        Cost::Instant => {
            let numeric = matches!(parameter.kind, Kind::Coefficient | Kind::Number);
            let ends = range.filter(|_| numeric).into_iter().flat_map(|range| {
                [range.low, range.high].into_iter().filter(move |end| range.contains(*end))
            });
            let ends = ends.map(|end| raised(&scene, parameter, end));
            let values: Vec<Scene> = ends.chain(others(&scene, parameter)).collect();
            values.iter().find_map(|edited| claim(edited, &instant))
        }
        Cost::InstantAboveZero(_) => others(&scene, parameter).iter().find_map(|edited| {
            let falls_off = |scene: &Scene| scene.lights.iter().filter(|l| l.falls_off()).count();
            let as_before = falls_off(edited) == falls_off(&scene);
            claim(edited, &|class| instant(class) == as_before)
        }),
        Cost::Refold => {
            others(&scene, parameter).iter().find_map(|e| claim(e, &|c| c == Class::Refold))
        }
        Cost::Reread(_) => {
            others(&scene, parameter).iter().find_map(|e| claim(e, &|c| c >= Class::Refold))
        }
        Cost::Regrow(_) => {
            let grown = |class: Class| class == Class::Regrow || class == Class::Refold;
            others(&scene, parameter).iter().find_map(|e| claim(e, &grown))
        }
        // Only materials that have another priority trace all.
        Cost::TraceAll if parameter.kind == Kind::Material => {
            let mut classes = others(&scene, parameter).into_iter().map(|e| class(&e));
            let some = classes.any(|class| class == Class::Retrace);
            (!some).then(|| format!("{} is {cost:?}, but no edit is", parameter.path))
        }
        Cost::TraceAll => {
            others(&scene, parameter).iter().find_map(|e| claim(e, &|c| c == Class::Retrace))
        }
    }
}

/// Holds the costs of all parameters; how many of each kind there are.
fn hold(session: &mut Session, what: &str) -> [usize; 10] {
    let mut kinds = [0; 10];
    for parameter in parameters(&session.scene().clone()) {
        let path = &parameter.path;
        let cost = cost(session, path).unwrap_or_else(|| panic!("{what}: {path} has no cost"));
        if let Some(lie) = lie(session, &parameter, cost) {
            panic!("{what}: {lie}");
        }
        kinds[match cost {
            Cost::Instant => 0,
            Cost::InstantUpTo(..) => 1,
            Cost::InstantDownTo(..) => 2,
            Cost::Refold => 3,
            Cost::RereadBelow(..) => 7,
            Cost::Reread(_) => 4,
            Cost::InstantAboveZero(_) => 8,
            Cost::Regrow(_) => 5,
            Cost::TraceAll => 6,
            Cost::InstantWithin(..) => 9,
        }] += 1;
    }
    kinds
}

#[test]
fn every_badge_of_every_scene_is_the_class_of_the_edit() {
    let mut all = [0; 10];
    for name in SHIPPED {
        let mut session = open(&shipped(name, [48, 32], 2), 2);
        for (sum, kind) in all.iter_mut().zip(hold(&mut session, name)) {
            *sum += kind;
        }
    }
    assert!(all[..9].iter().all(|&kind| kind >= 3), "kinds of costs met: {all:?}");
    assert_eq!(all[9], 0, "what dies is no matter without adaptive sampling");
}

#[test]
fn badges_hold_with_adaptive_sampling() {
    let mut all = [0; 10];
    for name in ["whitted", "glass", "mesh", "gallery"] {
        let mut scene = shipped(name, [48, 32], 12);
        set(&mut scene, "trace.adaptive", "0.1");
        let mut session = open(&scene, 2);
        assert!(session.is_adaptive());
        for (sum, kind) in all.iter_mut().zip(hold(&mut session, name)) {
            *sum += kind;
        }
        // Sliders that were moved to both sides.
        for (path, value) in [("trace.depth", "2"), ("trace.cutoff", "0.03")] {
            set(&mut scene, path, value);
            session.edit(scene.clone(), &Progress::default()).unwrap();
            hold(&mut session, path);
        }
    }
    let [instant, .., within] = all;
    assert!(instant > 20 && within > 3, "kinds of costs met: {all:?}");
    let mut scene = shipped("plain", [48, 32], 12);
    set(&mut scene, "trace.adaptive", "0.1");
    set(&mut scene, "trace.refine", "contrast");
    hold(&mut open(&scene, 2), "contrast");
}

#[test]
fn badges_hold_after_edits_too() {
    let mut session = open(&shipped("glass", [48, 32], 2), 2);
    for (path, value) in [
        ("materials.ruby.reflect", "[0.3, 0, 0.1]"),
        ("materials.amber.transmit", "0"),
        ("trace.cutoff", "0.02"),
        ("trace.depth", "3"),
    ] {
        let mut edited = session.scene().clone();
        set(&mut edited, path, value);
        session.edit(edited, &Progress::default()).unwrap();
        hold(&mut session, path);
    }
}

#[test]
fn highlights_that_were_released_are_traced() {
    let scene = shipped("whitted", [96, 64], 16);
    let matrix = open(&scene, 1).transport().bytes() as u64;
    let budget = Options { threads: 1, memory: matrix + matrix / 10 };
    let mut session = Session::open(scene, budget, &Progress::default()).unwrap();
    let shown = cost(&mut session, "materials.tiles.shininess");
    assert!(matches!(shown, Some(Cost::Regrow(pixels)) if pixels.count > 0), "{shown:?}");
    hold(&mut session, "released");
}

#[test]
fn what_is_no_parameter_has_no_cost() {
    let mut session = open(&shipped("mesh", [16, 9], 1), 1);
    assert_eq!(cost(&mut session, "materials.slate.shine"), None);
    assert_eq!(cost(&mut session, "materials"), None);
}

#[test]
fn a_cost_that_lies_is_caught() {
    let mut session = open(&shipped("whitted", [48, 32], 2), 2);
    let all = parameters(session.scene());
    let mut lies = |path: &str, claimed: Cost| {
        let parameter = all.iter().find(|p| p.path == path).unwrap();
        assert_ne!(cost(&mut session, path), Some(claimed), "{path}: a lie is wanted");
        assert!(lie(&mut session, parameter, claimed).is_some(), "{path}: {claimed:?} passed");
    };
    lies("materials.glass.diffuse", Cost::InstantUpTo(0.5, NONE));
    lies("materials.glass.diffuse", Cost::TraceAll);
    lies("materials.glass.shininess", Cost::Instant);
    lies("materials.tiles.reflect", Cost::Instant);
    lies("camera.eye", Cost::Instant);
    lies("camera.eye", Cost::Refold);
    lies("trace.cutoff", Cost::InstantDownTo(0.5, NONE));
    lies("trace.depth", Cost::InstantUpTo(64.0 - 1.0, NONE));
    let Some(Cost::InstantUpTo(limit, pixels)) = cost(&mut session, "materials.tiles.reflect")
    else {
        panic!("tiles may become a mirror");
    };
    for wrong in [(limit as f32).next_up(), (limit as f32).next_down()] {
        let parameter = all.iter().find(|p| p.path == "materials.tiles.reflect").unwrap();
        let claimed = Cost::InstantUpTo(f64::from(wrong), pixels);
        assert!(lie(&mut session, parameter, claimed).is_some(), "{claimed:?} passed");
    }
}
