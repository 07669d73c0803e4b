//! A cancel is obeyed at once and leaves the session as it was.

use std::thread;
use std::time::{Duration, Instant};

use rayforest::progress::Progress;
use rayforest::scene::{Scene, Shape, Solid};
use rayforest::session::trace::TraceError;
use rayforest::session::{Class, Session};

use super::{assert_same_picture, open, options, set, shipped};

/// Runs a job that is cancelled after `delay`, before its start if that is zero: what it gave, and how long after the cancel.
/// Promised are 100 ms; a busy machine is given a second.
fn cancelled_after<T>(
    delay: Duration,
    job: impl FnOnce(&Progress) -> Result<T, TraceError>,
) -> (Result<T, TraceError>, Duration) {
    let progress = Progress::default();
    if delay.is_zero() {
        progress.cancel();
    }
    thread::scope(|scope| {
        let killer = scope.spawn(|| {
            thread::sleep(delay);
            progress.cancel();
            Instant::now()
        });
        let outcome = job(&progress);
        let ended = Instant::now();
        let cancelled = killer.join().unwrap();
        (outcome, ended.saturating_duration_since(cancelled))
    })
}

/// Cancels a trace of a scene at several times; how many of them came before its end.
fn stop_often(scene: &Scene, delays_ms: &[u64], what: &str) -> usize {
    let mut stopped = 0;
    for &delay in delays_ms {
        let job = |progress: &Progress| Session::open(scene.clone(), options(2), progress);
        let (outcome, late) = cancelled_after(Duration::from_millis(delay), job);
        eprintln!("{what}, cancelled after {delay} ms: {:.1} ms late", late.as_secs_f64() * 1e3);
        match outcome {
            Err(error) => {
                assert_eq!(error, TraceError::Cancelled, "{what}, {delay} ms");
                assert!(late < Duration::from_secs(1), "{what}: {late:?} after the cancel");
                stopped += 1;
            }
            Ok(_) => assert!(delay > 0, "{what}: a cancel before the start"),
        }
    }
    stopped
}

#[test]
fn a_trace_obeys_a_cancel() {
    let scene = shipped("gems", [320, 180], 16);
    assert!(stop_often(&scene, &[0, 3, 30, 150, 400], "trace") >= 3);
}

#[test]
fn compiling_a_large_knot_obeys_a_cancel() {
    let mut scene = shipped("mesh", [32, 18], 1);
    set(&mut scene, "solids.knot.knot.segments", "[3000, 200]");
    assert!(stop_often(&scene, &[0, 10, 60, 150, 300], "large knot") >= 3);
}

#[test]
fn compiling_many_solids_obeys_a_cancel() {
    let mut scene = shipped("plain", [32, 18], 1);
    let flake = |i: usize| Solid::new(format!("f{i}"), Shape::named("sphereflake"), 0);
    scene.solids.extend((0..4).map(flake));
    for solid in &mut scene.solids {
        if let Shape::Sphereflake { levels, .. } = &mut solid.shape {
            *levels = 6;
        }
    }
    assert!(stop_often(&scene, &[0, 10, 60, 150], "many spheres") >= 2);
}

#[test]
fn a_job_that_ends_before_the_cancel_is_told_from_one_that_obeys() {
    let scene = shipped("plain", [8, 8], 1);
    assert_eq!(stop_often(&scene, &[300], "at leisure"), 0);
    assert_eq!(stop_often(&scene, &[0], "at once"), 1);
}

#[test]
fn a_cancelled_edit_leaves_scene_and_picture_and_the_next_ones_are_exact() {
    let scene = shipped("glass", [160, 90], 8);
    let mut session = open(&scene, 2);
    let (frame, film) = (session.frame().clone(), session.film());
    let mut moved = scene.clone();
    set(&mut moved, "camera.fov_degrees", "40");
    let mut stopped = 0;
    for delay in [0, 5, 40, 120] {
        let job = |progress: &Progress| session.edit(moved.clone(), progress);
        let (outcome, late) = cancelled_after(Duration::from_millis(delay), job);
        if outcome.is_ok() {
            session = open(&scene, 2);
            continue;
        }
        stopped += 1;
        assert!(late < Duration::from_secs(1), "{late:?} after the cancel");
        assert_eq!(outcome.unwrap_err(), TraceError::Cancelled);
        assert!(*session.scene() == scene, "another scene after a cancel at {delay} ms");
        assert!(*session.frame() == frame && session.film() == film, "another picture");
    }
    assert!(stopped >= 2, "{stopped} edits were cancelled");
    let edits = [
        ("materials.ruby.filter", "[0.4, 0.2, 0.3]", Class::Reshade),
        ("materials.amber.shininess", "12", Class::Refold),
        ("materials.tiles.reflect", "0.3", Class::Regrow),
        ("materials.tiles.reflect", "0.1", Class::Reshade),
        ("camera.fov_degrees", "40", Class::Retrace),
    ];
    for (path, value, class) in edits {
        let mut edited = session.scene().clone();
        set(&mut edited, path, value);
        let report = session.edit(edited, &Progress::default()).unwrap();
        assert_eq!(report.class, class, "{path}");
        let fresh = open(session.scene(), 2);
        assert_same_picture(&session, &fresh, &format!("{path} after a cancel"));
    }
}
