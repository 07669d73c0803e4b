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
    assert!(!window.stages.contains(&Stage::OneSample), "{:?}", window.stages);
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
fn a_region_beside_the_picture_is_no_stage() {
    let scene = scene("glass", [240, 135], 8);
    let mut window = Window::new(OPTIONS);
    window.live.look_first(Some(Region { corner: [500, 500], size: [10, 10] }));
    window.want(&scene);
    window.wait("the picture", |w| w.status.in_step);
    assert!(!window.stages.contains(&Stage::Region), "{:?}", window.stages);
    window.shows_whole(&scene);
}
