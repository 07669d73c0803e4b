//! The picture on the screen: what a click selects, and where it lies after a zoom.

use eframe::egui::{MouseWheelSource, MouseWheelUnit, Shape, TextureId, TouchPhase, pos2};

use super::*;
use crate::faces::SCENE;

impl Window {
    /// Where the picture lies on the screen, in points, from what was painted.
    pub(super) fn place(&mut self) -> Rect {
        self.harness.step();
        let view = self.rect(Role::Image, "picture");
        let meshes =
            self.harness.output().shapes.iter().filter_map(|clipped| match &clipped.shape {
                Shape::Mesh(mesh) if mesh.texture_id != TextureId::default() => {
                    Some((clipped.clip_rect, mesh.calc_bounds()))
                }
                _ => None,
            });
        let inside: Vec<_> =
            meshes.filter(|(clip, _)| view.expand(1.0).contains_rect(*clip)).collect();
        assert_eq!(inside.len(), 1, "one picture");
        inside[0].1
    }

    /// A pixel of the picture on the screen.
    pub(super) fn at(&mut self, x: f32, y: f32) -> Pos2 {
        let place = self.place();
        place.min + vec2(x / 48.0, y / 27.0) * place.size()
    }

    fn wheel(&mut self, at: Pos2, notches: f32) {
        self.harness.event(Event::PointerMoved(at));
        self.harness.event(Event::MouseWheel {
            unit: MouseWheelUnit::Line,
            delta: vec2(0.0, notches),
            modifiers: Modifiers::NONE,
            phase: TouchPhase::Move,
            source: MouseWheelSource::Wheel,
        });
        self.harness.step();
        self.harness.run_steps(10);
    }
}

#[test]
fn a_click_selects_the_material_under_it_and_with_alt_the_solid() {
    let mut window = Window::with_scene(SCENE, Vec::new());
    let (ball, floor) = (window.at(24.0, 13.5), window.at(24.0, 25.5));
    window.click_at(ball, Modifiers::NONE);
    assert!(window.shows("Material mirror"));
    window.click_at(floor, Modifiers::NONE);
    assert!(window.shows("Material tiles"));
    window.click_at(ball, Modifiers::ALT);
    assert!(window.shows("Solid ball"));
    let outside = window.rect(Role::Image, "picture").left_top() + vec2(5.0, 5.0);
    window.click_at(outside, Modifiers::NONE);
    assert!(window.shows("Solid ball"), "a click beside the picture selects nothing else");
}

#[test]
fn a_zoom_keeps_what_is_under_the_pointer() {
    let mut window = Window::with_scene(SCENE, Vec::new());
    let fit = window.place();
    let view = window.rect(Role::Image, "picture");
    assert!(view.expand(1.0).contains_rect(fit) && fit.width() > 0.95 * view.width());
    let pointer = fit.min + vec2(0.7, 0.3) * fit.size();
    for (notches, larger) in [(3.0, true), (2.0, true), (-4.0, false)] {
        let before = window.place();
        window.wheel(pointer, notches);
        let after = window.place();
        assert_eq!(after.width() > before.width(), larger, "{before} {after}");
        let under = |place: Rect| (pointer - place.min) / place.size();
        let moved = (under(after) - under(before)) * after.size();
        // The corner lies on a whole pixel of the screen.
        assert!(moved.length() < 1.0, "{moved}");
    }
    window.click("1:1");
    assert_eq!(window.place().size(), vec2(48.0, 27.0));
    window.click("Fit");
    assert_eq!(window.place(), fit);
    window.key(Modifiers::NONE, Key::Num1);
    assert_eq!(window.place().size(), vec2(48.0, 27.0));
    window.menu(&["View", "Zoom in"]);
    assert_eq!(window.place().size(), vec2(60.0, 33.75));
    window.key(Modifiers::NONE, Key::F);
    assert_eq!(window.place(), fit);
}

#[test]
fn a_drag_moves_the_enlarged_picture() {
    let mut window = Window::with_scene(SCENE, Vec::new());
    window.click("1:1");
    let before = window.place();
    window.drag(before.center(), before.center() + vec2(40.0, -25.0));
    assert_eq!(window.place().min, before.min + vec2(40.0, -25.0));
    assert!(window.place().min != pos2(0.0, 0.0));
}
