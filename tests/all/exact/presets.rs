//! From preset to preset and back by edits: the picture is the one that a fresh trace gives.

use rayforest::document::presets::{all, stage};

use super::*;

/// The stage of a preset, small enough for many traces.
fn small(material: &rayforest::scene::Material) -> Scene {
    let mut scene = stage(material);
    set(&mut scene, "picture.size", "[24, 24]");
    set(&mut scene, "trace.samples", "2");
    scene
}

#[test]
fn every_preset_by_an_edit_is_what_a_fresh_trace_gives() {
    let presets = all();
    let mut live = open(&small(&presets[0]), 2);
    // Forwards, then backwards: every pair of neighbours is crossed both ways.
    for preset in presets.iter().chain(presets.iter().rev()) {
        let scene = small(preset);
        live.edit(scene.clone(), &Progress::default()).unwrap_or_else(|e| panic!("{e}"));
        assert_same_picture(&live, &open(&scene, 1), &preset.name);
    }
}
