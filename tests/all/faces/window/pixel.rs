//! The panel of a pixel: its numbers, its ray tree, the way into a reflection, and the bars.

use eframe::egui::{Shape, pos2};

use super::*;
use crate::faces::SCENE;

/// A pixel of the ball in which the floor is reflected, of the scene's 48×27.
const MIRRORED: [u32; 2] = [24, 16];
const REFLECTION: &str = "reflection → floor (tiles)";

/// A window whose panel shows the tree of a pixel.
fn looking_at([x, y]: [u32; 2]) -> Window {
    let mut window = Window::with_scene(SCENE, Vec::new());
    window.menu(&["View", "Pixel and its rays"]);
    window.until_text("Click a pixel of the picture");
    let at = window.at(x as f32 + 0.5, y as f32 + 0.5);
    window.click_at(at, Modifiers::NONE);
    window.until_text("By bounce");
    window.harness.run_steps(3);
    window
}

impl Window {
    /// The value beside a name among the pixel's numbers.
    fn number(&self, name: &str) -> String {
        let texts = self.texts();
        let at = texts.iter().position(|text| text == name);
        texts[at.unwrap_or_else(|| panic!("no number `{name}` in {texts:#?}")) + 1].clone()
    }

    /// The bytes of a pixel of the picture shown, as the panel writes them.
    fn hex(&self, pixel: [u32; 2]) -> String {
        let [r, g, b, _] =
            self.app().shown().expect("a picture").frame.as_ref().expect("drawn").pixel(pixel);
        format!("#{r:02X}{g:02X}{b:02X}")
    }

    /// Rings that are drawn over the picture.
    fn rings(&mut self) -> Vec<Pos2> {
        self.harness.step();
        let view = self.rect(Role::Image, "picture");
        let shapes = self.harness.output().shapes.iter();
        let rings = shapes.filter_map(|clipped| match &clipped.shape {
            Shape::Circle(circle) if circle.radius == 9.0 => Some(circle.center),
            _ => None,
        });
        rings.filter(|at| view.contains(*at)).collect()
    }
}

#[test]
fn a_clicked_pixel_shows_its_numbers() {
    let mut window = looking_at(MIRRORED);
    assert_eq!(window.number("pixel"), "24, 16");
    assert_eq!(window.number("object"), "ball");
    assert_eq!(window.number("material"), "mirror");
    assert_eq!(window.number("samples"), "2");
    assert_eq!(window.number("hex"), window.hex(MIRRORED));
    let linear: Vec<f32> = window.number("linear").split(' ').map(|c| c.parse().unwrap()).collect();
    assert!(linear.len() == 3 && linear.iter().all(|c| *c > 0.0), "{linear:?}");
    // The pointer elsewhere shows that pixel's numbers; the tree stays.
    let floor = window.at(24.5, 25.5);
    window.harness.hover_at(floor);
    let start = Instant::now();
    while window.number("object") != "floor" {
        assert!(start.elapsed() < PATIENCE, "{:#?}", window.texts());
        window.harness.step();
    }
    assert_eq!(window.number("hex"), window.hex([24, 25]));
    assert!(window.button(REFLECTION).is_some());
    window.click("Close pixel");
    assert!(!window.shows("By bounce"));
}

#[test]
fn a_step_into_a_reflection_leads_to_the_material_found_there() {
    let mut window = looking_at(MIRRORED);
    assert!(window.shows("Material mirror"), "the click selected what is seen");
    window.click(REFLECTION);
    assert!(window.shows("Material tiles"), "{:#?}", window.texts());
    let before = (window.number("linear"), window.hex(MIRRORED));
    window.type_into("diffuse value", "0.2");
    window.until_exact();
    let start = Instant::now();
    while window.number("linear") == before.0 {
        assert!(start.elapsed() < PATIENCE, "the numbers follow the edit");
        window.harness.step();
    }
    assert_ne!(window.hex(MIRRORED), before.1, "the reflection is another");
    assert_eq!(window.number("hex"), window.hex(MIRRORED));
    // With Alt the solid, and a light by the line of its light.
    let line = window.settled(REFLECTION);
    window.click_at(line, Modifiers::ALT);
    assert!(window.shows("Solid floor"));
    window.click("By light: key");
    assert!(window.shows("Light key"));
    window.click("By material: mirror");
    assert!(window.shows("Material mirror"));
}

#[test]
fn a_line_under_the_pointer_is_marked_in_the_picture() {
    let mut window = looking_at(MIRRORED);
    let outside = window.rect(Role::Image, "picture").left_top() + vec2(5.0, 5.0);
    window.harness.hover_at(outside);
    window.harness.run_steps(2);
    assert_eq!(window.rings(), []);
    let line = window.settled(REFLECTION);
    window.harness.hover_at(line);
    window.harness.run_steps(2);
    let rings = window.rings();
    assert_eq!(rings.len(), 2, "a dark ring under a light one");
    // What the ball reflects there lies on the floor before it: lower than the pixel.
    let pixel = window.at(MIRRORED[0] as f32 + 0.5, MIRRORED[1] as f32 + 0.5);
    assert!(rings[0].y > pixel.y, "{rings:?} {pixel}");
    window.harness.hover_at(pos2(2.0, 2.0));
    window.harness.run_steps(2);
    assert_eq!(window.rings(), []);
}

#[test]
fn one_sample_shows_alone() {
    let mut window = looking_at(MIRRORED);
    assert!(window.shows("×2"), "both samples are one line");
    window.type_into("sample number", "2");
    assert!(!window.shows("×2") && window.button(REFLECTION).is_some());
    window.click("All samples");
    assert!(window.shows("×2"));
}
