//! Pictures of which some pixels are grown again, while that happens and after.

use super::*;
use crate::film::layout::{LANES, Layout, Place, TILE_BLOCKS};
use crate::scene::Material;
use crate::session::Work;
use crate::session::plan::Plan;

/// A plan for an edit of a whole picture.
fn plan(scene: &Scene, edited: &Scene) -> Plan {
    match fresh(scene).edit_without_rays(&Arc::new(edited.clone())) {
        Err(Work::Regrow(plan)) => plan,
        other => panic!("{other:?}"),
    }
}

/// Whether every pixel that `plan` does not name is the same in two frames, and how many there are.
fn same_beside(plan: &Plan, a: &Frame, b: &Frame) -> (bool, usize) {
    let layout = Layout::new(a.size);
    let (mut same, mut count) = (a.size == b.size, 0);
    for tile in 0..layout.tiles() {
        let named = plan.tiles.iter().find(|planned| planned.tile == tile);
        for (block, lane) in (0..TILE_BLOCKS).flat_map(|b| (0..LANES).map(move |l| (b, l))) {
            let Some([x, y]) = layout.pixel(Place { tile, block, lane }) else { continue };
            if named.is_none_or(|planned| planned.lanes[block] >> lane & 1 == 0) {
                let at = (y * a.size[0] + x) as usize * 4;
                same &= a.bytes[at..at + 4] == b.bytes[at..at + 4];
                count += 1;
            }
        }
    }
    (same, count)
}

/// Takes every picture until the wish is shown; those that came while pixels were pending.
fn pictures(window: &mut Window) -> Vec<(Shown, u64)> {
    let mut seen = Vec::new();
    let begun = Instant::now();
    loop {
        window.status = window.live.status();
        if let Some(shown) = window.live.take_shown() {
            seen.push((shown.clone(), window.status.pending));
            window.newest = Some(shown);
        }
        if window.status.in_step {
            seen.retain(|(shown, _)| shown.stage == Stage::Mending);
            return seen;
        }
        let left = PATIENCE.saturating_sub(begun.elapsed());
        window.woken.recv_timeout(left).expect("the wish is shown at last");
    }
}

#[test]
fn pixels_beside_a_plan_are_final_from_the_first_picture_on() {
    let scene = scene("whitted", [400, 225], 8);
    let edited = with(&with(&scene, "materials.mirror.transmit", "0.4"), "picture.exposure", "0.3");
    let plan = plan(&scene, &edited);
    let expected = fresh(&edited);
    let mut window = Window::showing(&scene);
    window.live.look_at(Some([300.0, 20.0]));
    window.want(&edited);
    let seen = pictures(&mut window);
    assert!(!seen.is_empty(), "a picture while pixels are pending");
    for (shown, pending) in &seen {
        assert_eq!(*shown.scene, edited);
        let (same, count) = same_beside(&plan, shown.frame.as_ref().unwrap(), expected.frame());
        assert!(same, "a pixel that the plan does not name");
        assert!(count > 500, "{count} pixels that it does not name");
        assert!(*pending <= plan.pixels(), "{pending}");
    }
    assert!(seen.iter().any(|(_, pending)| *pending > 0), "pending pixels are counted");
    window.shows_whole(&edited);
    let report = window.last();
    assert_eq!((report.class, report.pixels), (Class::Regrow, plan.pixels()));
    assert_eq!((report.rays.camera, window.live.status().pending), (0, 0));
    assert!(report.rays.total() < expected.trace_report().rays.total() / 2);
    let mut other = expected.frame().clone();
    other.bytes.iter_mut().for_each(|byte| *byte ^= 1);
    assert!(!same_beside(&plan, &other, expected.frame()).0, "other pixels are found");
}

/// A branch that dies leaves its pixels, and their neighbours, with other numbers of samples.
#[test]
fn numbers_of_samples_change_in_pending_pixels_alone() {
    let scene = with(&scene("whitted", [400, 225], 12), "trace.adaptive", "0.1");
    let edited = with(&scene, "materials.mirror.reflect", "0");
    let plan = plan(&scene, &edited);
    let expected = fresh(&edited);
    assert!(expected.sample_map() != fresh(&scene).sample_map());
    let mut window = Window::showing(&scene);
    window.want(&edited);
    let seen = pictures(&mut window);
    assert!(!seen.is_empty(), "a picture while pixels are pending");
    for (shown, _) in &seen {
        let (same, count) = same_beside(&plan, shown.frame.as_ref().unwrap(), expected.frame());
        assert!(same && count > 500, "{count} pixels that the plan does not name");
    }
    window.shows_whole(&edited);
    assert_eq!(window.last().pixels, plan.pixels());
    for value in ["0.7", "0.05", "0.6", "0", "0.3"] {
        window.want(&with(&scene, "materials.mirror.reflect", value));
        std::thread::sleep(Duration::from_millis(20));
    }
    window.wait("the last of them", |w| w.status.in_step);
    window.shows_whole(&with(&scene, "materials.mirror.reflect", "0.3"));
}

#[test]
fn a_cancel_leaves_all_trees_as_they_were_and_resume_goes_on() {
    let scene = slow();
    let moved = with(&scene, "lights.key.point", "[-2, -4, 9]");
    let mut window = Window::showing(&scene);
    window.want(&moved);
    window
        .wait("pixels are grown", |w| w.newest.as_ref().is_some_and(|s| s.stage == Stage::Mending));
    window.live.cancel();
    window.wait("held", |w| w.status.held);
    window.wait("the old picture", |w| w.shown().stage == Stage::Whole);
    window.shows_whole(&scene);
    assert_eq!(window.status.pending, 0);
    let brighter = with(&scene, "materials.tiles.diffuse", "0.9");
    window.want(&brighter);
    window.wait("an edit of the old picture", |w| w.status.in_step);
    window.shows_whole(&brighter);
    window.want(&moved);
    window.wait("moved at last", |w| w.status.in_step);
    window.shows_whole(&moved);
}

#[test]
fn a_light_that_is_dragged_ends_where_it_is_dropped() {
    let scene = scene("whitted", [320, 180], 4);
    let at = |i: usize| with(&scene, "lights.key.point", &format!("[-4, {}, 7]", i as f64 * 0.1));
    let mut window = Window::showing(&scene);
    for i in 0..40 {
        window.want(&at(i));
        std::thread::sleep(Duration::from_millis(12));
        window.wait("nothing", |_| true);
    }
    window.wait("the last place", |w| w.status.in_step);
    window.shows_whole(&at(39));
    assert_eq!(window.last().rays.camera, 0);
}

/// A light that was moved has no place in the matrix yet: without it all would be dark.
#[test]
fn a_light_that_is_dragged_never_goes_out() {
    let scene = with(&scene("whitted", [320, 180], 4), "lights.key.intensity", "[3, 3, 3]");
    let at = |i: usize| with(&scene, "lights.key.point", &format!("[-4, {}, 7]", i as f64 * 0.05));
    let mean = |frame: &Frame| {
        let bytes = frame.bytes.iter().map(|byte| u64::from(*byte));
        bytes.sum::<u64>() as f64 / frame.bytes.len() as f64
    };
    let dark = mean(fresh(&with(&scene, "lights.key.on", "false")).frame());
    let bright = mean(fresh(&scene).frame());
    let bound = (dark + bright) / 2.0;
    assert!(dark < 0.8 * bright, "{dark} {bright}");
    let mut window = Window::showing(&scene);
    let mut count = 0;
    for i in 0..40 {
        window.want(&at(i));
        std::thread::sleep(Duration::from_millis(12));
        while let Some(shown) = window.live.take_shown() {
            let mean = mean(shown.frame.as_ref().unwrap());
            assert!(mean > bound, "{:?} at {i}: {mean}, lit {bright}, dark {dark}", shown.stage);
            count += usize::from(shown.stage != Stage::Whole);
            window.newest = Some(shown);
        }
    }
    assert!(count > 3, "{count} pictures on the way");
    window.wait("the last place", |w| w.status.in_step);
    window.shows_whole(&at(39));
}

#[test]
fn edits_while_pixels_are_grown_end_as_a_fresh_session() {
    let scene = slow();
    let mut window = Window::showing(&scene);
    let mut edited = with(&scene, "materials.ruby.ior", "1.31");
    window.want(&edited);
    for i in 0..20 {
        let value = format!("{:.2}", 0.2 + 0.03 * f64::from(i));
        edited = with(&edited, "materials.tiles.diffuse", &value);
        edited = with(&edited, "materials.amber.shininess", &format!("{}", 10 + i));
        window.want(&edited);
        std::thread::sleep(Duration::from_millis(15));
    }
    window.wait("all edits", |w| w.status.in_step);
    window.shows_whole(&edited);
    // What comes alive after a wish that is still being grown is grown next.
    edited = with(&edited, "materials.tiles.reflect", "0.1");
    window.want(&edited);
    edited = with(&edited, "materials.tiles.reflect", "0.9");
    window.want(&edited);
    window.wait("both wishes", |w| w.status.in_step);
    window.shows_whole(&edited);
    // And back, at once.
    window.want(&scene);
    window.wait("the first scene", |w| w.status.in_step);
    window.shows_whole(&scene);
}

#[test]
fn an_export_waits_for_the_last_pending_pixel() {
    let folder = folder();
    let path = folder.path().join("moved.png");
    let scene = slow();
    let moved = with(&scene, "lights.key.point", "[-2, -4, 9]");
    let mut window = Window::showing(&scene);
    window.want(&moved);
    export(&mut window, path.clone(), scene.picture.size);
    assert_eq!(decoded(&path).0, opaque(fresh(&moved).frame()));
}

#[test]
fn things_that_come_and_go_while_pixels_are_grown() {
    let mut scene = slow();
    scene.materials.insert(1, Material::new("spare"));
    scene.solids.iter_mut().filter(|s| s.material >= 1).for_each(|s| s.material += 1);
    let mut window = Window::showing(&scene);
    let mut edited = with(&scene, "lights.key.point", "[-2, -4, 9]");
    window.want(&edited);
    let begun = |w: &Window| w.newest.as_ref().is_some_and(|s| s.stage == Stage::Mending);
    window.wait("pixels are grown", begun);
    edited.materials.remove(1);
    edited.solids.iter_mut().filter(|s| s.material > 1).for_each(|s| s.material -= 1);
    window.want(&edited);
    window.wait("a look", |_| true);
    edited.lights.remove(0);
    window.want(&edited);
    window.wait("all of it", |w| w.status.in_step);
    window.shows_whole(&edited);
    assert!(window.events.is_empty(), "{:?}", window.events);
}

#[test]
fn a_regrow_that_does_not_fit_brings_the_old_picture_back() {
    let scene = scene("whitted", [320, 180], 4);
    let matrix = fresh(&scene).transport().bytes() as u64;
    let mut window = Window::new(Options { memory: matrix + matrix / 20, ..OPTIONS });
    window.want(&scene);
    window.wait("the first picture", |w| w.status.in_step);
    let mut edited = with(&scene, "materials.tiles.reflect", "0.9");
    edited.trace.cutoff = 1e-6;
    window.want(&edited);
    window.wait("a failure", |w| w.status.held && !w.events.is_empty());
    assert!(matches!(&window.events[..], [Event::Failed(text)] if text.contains("GiB")));
    window.wait("the old picture", |w| w.shown().stage == Stage::Whole);
    window.shows_whole(&scene);
}
