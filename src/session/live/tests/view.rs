//! What concerns the view alone: marks on clipped pixels, and the region that is traced first.

use super::*;
use crate::film::layout::Layout;

#[test]
fn marks_follow_edits_and_leave_the_picture_alone() {
    let scene = with(&scene("whitted", [96, 54], 2), "picture.exposure", "3");
    let mut window = Window::showing(&scene);
    assert!(window.shown().marked.is_none(), "nobody asked");
    window.live.mark_clipped(true);
    window.wait("marks", |w| w.shown().marked.is_some());
    window.shows_whole(&scene);
    let marked = window.shown().marked.clone().unwrap();
    let differing = |marked: &Marked, shown: &Shown| {
        let pairs = marked.frame.bytes.chunks(4).zip(shown.frame.as_ref().unwrap().bytes.chunks(4));
        pairs.filter(|(a, b)| a != b).count() as u64
    };
    let Clipped { over, under, of } = marked.clipped;
    assert!(over > 100 && under == 0 && of == 96 * 54, "{:?}", marked.clipped);
    assert_eq!(differing(&marked, window.shown()), over);

    let toned = with(&scene, "picture.tone", "neutral");
    window.want(&toned);
    window.wait("the edit", |w| w.status.in_step);
    window.shows_whole(&toned);
    let marked = window.shown().marked.clone().unwrap();
    assert_eq!(marked.clipped, Clipped { over: 0, under: 0, of });
    assert_eq!(differing(&marked, window.shown()), 0);

    window.live.mark_clipped(false);
    window.wait("no marks", |w| w.shown().marked.is_none());
    window.shows_whole(&toned);
}

/// How many pixels of a frame are not those of a fresh trace, within the tiles of a region and
/// elsewhere.
fn other_pixels(shown: &Shown, region: Region) -> [usize; 2] {
    let fresh = fresh(&shown.scene);
    let layout = Layout::new(fresh.frame().size);
    let within = region.tiles(layout);
    let [width, height] = layout.size;
    let mut counts = [0; 2];
    for pixel in (0..height).flat_map(|y| (0..width).map(move |x| [x, y])) {
        let outside = !within.contains(&layout.place(pixel).tile);
        counts[usize::from(outside)] +=
            usize::from(shown.frame.as_ref().unwrap().pixel(pixel) != fresh.frame().pixel(pixel));
    }
    counts
}

#[test]
fn a_region_is_whole_before_the_rest_and_follows_edits() {
    let scene = scene("glass", [240, 135], 48);
    let region = Region { corner: [100, 40], size: [60, 50] };
    let mut window = Window::new(OPTIONS);
    window.live.look_first(Some(region));
    window.want(&scene);
    window.wait("the region", |w| w.newest.as_ref().is_some_and(|s| s.stage >= Stage::Region));
    assert_eq!(window.shown().stage, Stage::Region);
    let first = window.shown().clone();
    // Shininess is another highlight, colour another term.
    let edited =
        with(&with(&scene, "lights.key.color", "[0.9, 0.5, 0.4]"), "picture.exposure", "1");
    let edited = with(&edited, "materials.ruby.shininess", "7");
    window.want(&edited);
    window.wait("the edit", |w| *w.shown().scene == edited);
    let second = window.shown().clone();
    for shown in [first, second] {
        let [within, outside] = other_pixels(&shown, region);
        assert_eq!(within, 0, "{:?}", shown.stage);
        // The second may have come after the whole picture.
        assert!(outside > 1000 || shown.stage == Stage::Whole, "{outside}");
    }
    window.wait("all of it", |w| w.status.in_step);
    window.shows_whole(&edited);
}

#[test]
fn a_region_that_is_drawn_while_all_is_traced_is_whole_before_the_rest_all_the_same() {
    let scene = scene("glass", [160, 96], 32);
    let region = Region { corner: [64, 32], size: [40, 30] };
    let mut window = Window::new(OPTIONS);
    window.want(&scene);
    window.wait("one sample", |w| w.newest.as_ref().is_some_and(|s| s.stage >= Stage::OneSample));
    assert_eq!(window.shown().stage, Stage::OneSample);
    window.live.look_first(Some(region));
    window.wait("the region", |w| w.shown().stage >= Stage::Region);
    assert_eq!(window.shown().stage, Stage::Region);
    assert_eq!(other_pixels(window.shown(), region)[0], 0);
    window.wait("all of it", |w| w.status.in_step);
    window.shows_whole(&scene);
    assert_eq!(window.last().rays, fresh(&scene).trace_report().rays);
}

/// A window in which a region of a scene is just shown, the rest is being traced, and the camera of
/// which will have moved.
fn tracing_beside_a_region(options: Options) -> (Window, Scene) {
    let mut window = Window::new(options);
    let scene = scene("glass", [160, 96], 24);
    window.want(&scene);
    window.wait("the first picture", |w| w.status.in_step);
    window.live.look_first(Some(Region { corner: [64, 32], size: [40, 30] }));
    let moved = with(&scene, "camera.fov_degrees", "30");
    window.want(&moved);
    window.wait("the region", |w| w.shown().stage == Stage::Region);
    (window, moved)
}

#[test]
fn a_region_costs_no_ray_and_another_one_may_be_named_while_it_is_traced() {
    let (mut window, moved) = tracing_beside_a_region(OPTIONS);
    window.live.look_first(Some(Region { corner: [0, 0], size: [160, 96] }));
    window.wait("the rest", |w| w.status.in_step);
    window.shows_whole(&moved);
    assert_eq!(window.last().rays, fresh(&moved).trace_report().rays);
    let again = with(&moved, "camera.fov_degrees", "33");
    window.want(&again);
    window.wait("again", |w| w.status.in_step && *w.shown().scene == again);
    window.shows_whole(&again);
    assert_eq!(window.last().rays, fresh(&again).trace_report().rays);
    // What it kept of the region answers as everything else does.
    let mirror = with(&again, "materials.tiles.reflect", "0.3");
    window.want(&mirror);
    window.wait("grown", |w| w.status.in_step && *w.shown().scene == mirror);
    window.shows_whole(&mirror);
    assert_eq!((window.last().class, window.last().rays.camera), (Class::Regrow, 0));
}

#[test]
fn a_cancel_beside_a_region_brings_the_whole_picture_back() {
    let (mut window, moved) = tracing_beside_a_region(OPTIONS);
    window.live.cancel();
    window.wait("held", |w| w.status.held && w.shown().stage == Stage::Whole);
    window.shows_whole(&with(&moved, "camera.fov_degrees", "24"));
    window.live.resume();
    window.wait("resumed", |w| w.status.in_step);
    window.shows_whole(&moved);
}

#[test]
fn a_camera_that_moves_on_beside_a_region_ends_as_a_fresh_session() {
    let (mut window, moved) = tracing_beside_a_region(OPTIONS);
    let mut last = moved;
    for degrees in ["31", "32", "34", "36"] {
        last = with(&last, "camera.fov_degrees", degrees);
        window.want(&last);
        window.want(&with(&last, "materials.tiles.diffuse", "0.3"));
    }
    window.want(&last);
    window.wait("the last", |w| w.status.in_step && *w.shown().scene == last);
    window.shows_whole(&last);
}

#[test]
fn a_region_is_within_the_budget() {
    let whole = fresh(&scene("glass", [160, 96], 24));
    let memory = whole.kept_bytes() - whole.forest().bytes() as u64 * 3 / 4;
    let (mut window, moved) = tracing_beside_a_region(Options { memory, ..OPTIONS });
    let edited = with(&moved, "materials.tiles.diffuse", "0.3");
    window.want(&edited);
    window.wait("the rest", |w| w.status.in_step);
    window.shows_whole(&edited);
    assert!(window.status.bytes - window.status.matrix_bytes <= memory, "{:?}", window.status);
}

#[test]
fn a_region_beside_the_picture_is_no_stage() {
    let scene = scene("glass", [240, 135], 8);
    let mut window = Window::new(OPTIONS);
    window.live.look_first(Some(Region { corner: [500, 500], size: [10, 10] }));
    window.want(&scene);
    window.wait("the picture", |w| w.status.in_step);
    assert!(!window.stages.contains(&Stage::Region), "{:?}", window.stages);
    window.shows_whole(&scene);
}
