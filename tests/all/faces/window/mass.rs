//! Mass properties in the window: measured in the background, with the selected solid's figures.

use super::*;
use crate::faces::SCENE;

/// A window whose panel of mass properties is open.
fn weighing() -> Window {
    let dense = SCENE.replace("reflect = 0.5", "reflect = 0.5\ndensity = 2");
    let mut window = Window::with_scene(&dense, Vec::new());
    window.menu(&["View", "Mass properties"]);
    assert!(window.shows("Close mass"));
    window
}

#[test]
fn the_selected_solid_is_measured() {
    let mut window = weighing();
    window.click("ball");
    window.type_into("wanted mass error", "0.001");
    window.click("Measure ball");
    window.until_text("volume by formula");
    window.until_text("4.18879020");
    let texts = window.texts();
    let at = texts.iter().position(|text| text == "mass").expect("a line for the mass");
    let mass: f64 = texts[at + 1].split(" ±").next().unwrap().parse().unwrap();
    assert!((mass - 2.0 * 4.188_790_2).abs() < 0.01, "{mass}");
    assert_eq!(texts[at - 2..at], ["density of mirror", "2"]);
    // The figures stay, and say that they are old, once the solid is another.
    window.type_into("radius value", "1.5");
    window.until_text("ball, before its latest change");
    window.click("Measure ball");
    window.until_text("14.13716694");
    window.click("Close mass");
    assert!(!window.shows("Close mass"));
}

#[test]
fn what_has_no_mass_is_said_and_a_long_measurement_ends() {
    let mut window = weighing();
    window.click("floor");
    window.click("Measure floor");
    window.until_text("it has no end, and so no mass");
    window.click("ball");
    window.type_into("wanted mass error", "0.0000001");
    window.click("Measure ball");
    window.click("Stop measuring mass");
    window.until_text("Measure ball");
    assert!(!window.shows("volume by formula"));
}
