//! A graphics card that draws beside the processor: the same picture after every edit, and no harm if it fails.

use super::*;
use crate::shade::gpu::Gpu;

fn card() -> Gpu {
    Gpu::headless().expect("lavapipe is installed: tests/run installs it")
}

/// A window that shows the whole picture of a scene, drawn by a card too.
fn on_card(gpu: &Gpu, scene: &Scene) -> Window {
    let window = Window::new(OPTIONS);
    window.live.draw_on(Some(gpu.clone()));
    window.want(scene);
    reached(window)
}

fn reached(mut window: Window) -> Window {
    window.wait("the picture is whole and drawn by both", |w| {
        w.status.in_step && w.newest.as_ref().is_some_and(|shown| shown.frame.is_some())
    });
    window
}

/// By how many code values the card's picture differs from the processor's, and in how many pixels.
fn difference(gpu: &Gpu, shown: &Shown) -> (u8, usize) {
    let card = shown.card.as_ref().expect("a picture of the card's").read(gpu).unwrap();
    let frame = shown.frame.as_ref().expect("a picture of the processor's");
    assert_eq!(card.size, frame.size);
    let most = card.bytes.iter().zip(&frame.bytes).map(|(a, b)| a.abs_diff(*b)).max();
    let pairs = card.bytes.chunks_exact(4).zip(frame.bytes.chunks_exact(4));
    (most.unwrap_or(0), pairs.filter(|(a, b)| a != b).count())
}

fn assert_alike(gpu: &Gpu, window: &Window, scene: &Scene) {
    window.shows_whole(scene);
    let (most, pixels) = difference(gpu, window.shown());
    let all = window.frame().bytes.len() / 4;
    assert!(most <= 1 && pixels * 1000 <= all, "{most} code values, {pixels} of {all} pixels");
}

#[test]
fn the_card_follows_edits_of_every_class() {
    let gpu = card();
    let scene = scene("whitted", [190, 100], 4);
    let mut window = on_card(&gpu, &scene);
    assert_alike(&gpu, &window, &scene);
    let mut edited = scene.clone();
    for (path, value) in [
        ("materials.tiles.diffuse", "0.3"),
        ("materials.mirror.shininess", "7"),
        ("picture.exposure", "0.5"),
        ("materials.tiles.reflect", "0.4"),
        ("materials.tiles.reflect", "0.0"),
        ("picture.size", "[64, 70]"),
    ] {
        let before = window.shown().clone();
        edited = with(&edited, path, value);
        window.want(&edited);
        window = reached(window);
        assert_alike(&gpu, &window, &edited);
        // What was held stays what it was.
        assert!(difference(&gpu, &before).0 <= 1, "{path}");
        assert!(Some(window.frame()) != before.frame, "{path} = {value} is seen");
    }
    assert_eq!(window.events, []);
}

#[test]
fn a_picture_that_waits_is_drawn_when_it_is_asked_for() {
    let scene = scene("whitted", [70, 40], 4);
    let mut session = fresh(&scene);
    session.defer(true);
    let before = session.shared_frame();
    let mut edited = scene.clone();
    // Of different materials: what waits of the first is not forgotten for the second.
    for (path, value) in [("materials.tiles.diffuse", "0.3"), ("materials.mirror.specular", "0.1")]
    {
        edited = with(&edited, path, value);
        session.edit_without_rays(&Arc::new(edited.clone())).unwrap();
        assert!(session.owes_frame(), "{path}");
    }
    session.catch_up();
    assert!(!session.owes_frame() && *session.frame() != *before);
    assert!(*session.frame() == *fresh(&edited).frame());
}

#[test]
fn pictures_before_the_whole_one_are_the_processors() {
    let gpu = card();
    let mut window = Window::new(OPTIONS);
    window.live.draw_on(Some(gpu));
    // Too many rays to be traced whole at once.
    window.want(&scene("glass", [128, 72], 8));
    while !window.status.in_step {
        let taken = window.stages.len();
        window.wait("a picture", |w| w.stages.len() > taken || w.status.in_step);
        let Some(shown) = &window.newest else { continue };
        assert!(shown.card.is_some() || shown.frame.is_some());
        assert_eq!(shown.card.is_some(), shown.stage == Stage::Whole, "{:?}", shown.stage);
    }
    assert!(window.stages.len() > 1, "{:?}", window.stages);
}

#[test]
fn a_card_that_comes_late_draws_what_is_shown_and_goes_when_it_is_told_to() {
    let gpu = card();
    let scene = scene("plain", [80, 45], 2);
    let mut window = Window::showing(&scene);
    assert!(window.shown().card.is_none());
    window.live.draw_on(Some(gpu.clone()));
    window.wait("the card draws", |w| w.shown().card.is_some());
    assert_alike(&gpu, &window, &scene);
    let pixels = u64::from(scene.picture.size[0] * scene.picture.size[1]);
    window.wait("its bytes are told", |w| w.status.card_bytes > 4 * pixels);
    window.live.draw_on(None);
    window.wait("the card rests", |w| w.shown().card.is_none());
    window.wait("nothing is on it", |w| w.status.card_bytes == 0);
    window.shows_whole(&scene);
}

#[test]
fn a_lost_card_costs_no_picture() {
    let gpu = card();
    let scene = scene("plain", [80, 45], 2);
    let mut window = on_card(&gpu, &scene);
    gpu.lose();
    let edited = with(&scene, "picture.exposure", "0.7");
    window.want(&edited);
    window.wait("the edit is shown", |w| w.status.in_step && *w.shown().scene == edited);
    window.shows_whole(&edited);
    assert!(window.shown().card.is_none());
    assert!(gpu.fault().is_some_and(|fault| fault.is_lost()));
    // A new one takes over.
    let other = card();
    window.live.draw_on(Some(other.clone()));
    window.wait("the new card draws", |w| w.shown().card.is_some());
    assert_alike(&other, &window, &edited);
}
