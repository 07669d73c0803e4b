//! Speed and accuracy in the window: measured while it stays usable, and applied as one step.

use super::*;
use crate::faces::SCENE;

impl Window {
    /// A window whose panel of speed and accuracy is open.
    fn charting(scene: &str) -> Window {
        let mut window = Window::with_scene(scene, Vec::new());
        window.menu(&["View", "Speed and accuracy"]);
        assert!(window.shows("Close speed and accuracy"));
        window
    }

    /// Measures against a reference of so many samples, until it is done.
    fn measure(&mut self, reference: &str) {
        self.type_into("chart reference", reference);
        self.type_into("wanted error", "15");
        self.click("Measure");
        self.until_text("Recommended for an error");
        self.harness.run_steps(3);
    }

    fn trace(&self) -> rayforest::scene::Trace {
        self.app().document().scene().trace.clone()
    }
}

#[test]
fn what_is_recommended_is_applied_as_one_step() {
    let mut window = Window::charting(SCENE);
    let before = window.app().document().scene().clone();
    window.measure("64");
    let line = window.texts().into_iter().find(|text| text.starts_with("Recommended for an error"));
    let line = line.expect("a line");
    assert!(line.contains("below 15 8-bit code values rms: trace.samples = "), "{line}");
    let said = |path: &str| {
        let rest = &line[line.find(path).expect("a value") + path.len() + 3..];
        rest.split([',', ';']).next().expect("a value").parse::<f64>().expect("a number")
    };
    window.click("Apply recommended");
    let trace = window.trace();
    assert_eq!(f64::from(trace.samples), said("trace.samples"));
    assert_eq!(f64::from(trace.depth), said("trace.depth"));
    assert_eq!(trace.cutoff, said("trace.cutoff") as f32);
    assert!(trace != before.trace, "{trace:?}");
    assert_eq!(window.undo_name(), Some("recommended settings"));
    window.until_exact();
    window.key(Modifiers::COMMAND, Key::Z);
    assert!(*window.app().document().scene() == before, "one step");
}

#[test]
fn every_point_can_be_applied() {
    let mut window = Window::charting(SCENE);
    window.measure("32");
    window.click("apply trace.samples = 8");
    assert_eq!(window.trace().samples, 8);
    let name = window.undo_name().expect("a step").to_owned();
    assert!(name.contains("samples") && name.contains('8'), "{name}");
    assert!(window.shows("8 now"));
    window.key(Modifiers::COMMAND, Key::Z);
    assert_eq!(window.trace().samples, 2);
}

#[test]
fn the_window_is_used_while_it_is_measured_and_the_measurement_is_stopped() {
    let mut window = Window::charting(SCENE);
    window.type_into("chart size", "4096");
    window.type_into("chart reference", "4096");
    // Larger than the picture is not measured: this takes long because of the samples alone.
    window.click("Measure");
    window.until_text("of ");
    window.click("mirror");
    window.drag_slider("diffuse", 0.9);
    window.until_exact();
    assert!(window.button("Stop measuring").is_some(), "it still runs");
    window.click("Stop measuring");
    window.until_button("Measure");
    assert!(!window.shows("Recommended"));
    window.click("Close speed and accuracy");
    assert!(!window.shows("Measure"));
}

#[test]
fn a_window_that_closes_while_it_measures_ends_it() {
    let mut window = Window::charting(SCENE);
    window.type_into("chart reference", "4096");
    window.click("Measure");
    window.until_text("trace.samples");
    let start = Instant::now();
    drop(window);
    assert!(start.elapsed() < Duration::from_secs(10));
}

#[test]
fn a_point_tells_its_numbers_when_the_pointer_rests_on_it() {
    let mut window = Window::charting(SCENE);
    window.measure("32");
    let left = window.rect(Role::Button, "Measure").left();
    let right = window.rect(Role::Button, "apply trace.samples = 1").left();
    let (top, bottom) = (window.rect(Role::Button, "Measure").bottom(), 719.0);
    let mut told = Vec::new();
    // Steps that no point's reach falls between.
    let (columns, rows) = (((right - left) / 5.0) as usize, ((bottom - top) / 5.0) as usize);
    'search: for row in 0..rows {
        for column in 0..columns {
            let at = Pos2::new(left + column as f32 * 5.0, top + row as f32 * 5.0);
            window.harness.hover_at(at);
            window.harness.step();
            told = tips(&window);
            if told.iter().any(|text| text.contains("trace.") && text.contains(" rays, rms ")) {
                break 'search;
            }
        }
    }
    assert!(told.iter().any(|text| text.contains(" rays, rms ")), "{told:?}");
}

/// All texts that are drawn, those in a plot too.
fn tips(window: &Window) -> Vec<String> {
    let shapes = window.harness.output().shapes.iter();
    shapes.flat_map(|shape| texts_of(&shape.shape)).collect()
}

fn texts_of(shape: &eframe::egui::Shape) -> Vec<String> {
    use eframe::egui::Shape;
    match shape {
        Shape::Text(text) => vec![text.galley.text().to_owned()],
        Shape::Vec(shapes) => shapes.iter().flat_map(texts_of).collect(),
        _ => Vec::new(),
    }
}
