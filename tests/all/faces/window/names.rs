//! Every control has a name and a tooltip: a walk over all that can be pressed, dragged or typed into.

use eframe::egui::accessibility::is_input;
use eframe::egui::{Button, Order, Slider, Ui, WidgetInfo};

use super::*;

/// A scene with every kind of light, solid and camera is not needed: a control's kind decides.
const SCENE: &str = crate::faces::SCENE;

/// What of all that shows has no name, or no tooltip when the pointer rests on it. `within` leaves
/// out what is not of interest.
fn faults<S>(harness: &mut Harness<'_, S>, within: impl Fn(Rect) -> bool) -> (usize, Vec<String>) {
    let inputs: Vec<(String, Rect)> = harness
        .root()
        .children_recursive()
        .filter(|node| is_input(node.accesskit_node().role()) && !node.accesskit_node().is_hidden())
        .map(|node| {
            let name = node.accesskit_node().label().unwrap_or_default();
            (format!("{:?} `{name}`", node.accesskit_node().role()), node.rect())
        })
        .filter(|(_, rect)| within(*rect))
        .collect();
    let mut faults = Vec::new();
    for (name, rect) in &inputs {
        if name.ends_with("``") {
            faults.push(format!("{name} at {rect} has no name"));
        }
        if !has_tooltip(harness, rect.center()) {
            faults.push(format!("{name} at {rect} has no tooltip"));
        }
    }
    (inputs.len(), faults)
}

/// Whether something shows over all else while the pointer rests at a point.
fn has_tooltip<S>(harness: &mut Harness<'_, S>, at: Pos2) -> bool {
    let shows = |harness: &Harness<'_, S>| {
        let layers = harness.ctx.memory(|m| m.areas().visible_layer_ids());
        layers.iter().any(|layer| layer.order == Order::Tooltip)
    };
    for _ in 0..20 {
        harness.remove_cursor();
        harness.step();
        if !shows(harness) {
            break;
        }
    }
    assert!(!shows(harness), "the tooltip before it goes away");
    // A little to the side first: a pointer that rests at once was never moved.
    harness.hover_at(at + vec2(1.0, 0.0));
    harness.step();
    harness.hover_at(at);
    for _ in 0..8 {
        harness.step();
        if shows(harness) {
            return true;
        }
    }
    false
}

fn tall() -> Window {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.toml");
    let pane = "pane = { polygon = { points = [[0, 5, 0], [1, 5, 0], [0, 5, 1]] }, \
                material = \"tiles\" }\n";
    std::fs::write(&path, format!("{SCENE}{pane}")).unwrap();
    let mut window =
        Window::of_size(vec2(1280.0, 1400.0), folder, Some(path.clone()), vec![Answer::NoService]);
    window.until("the scene is open", |app| app.document().path() == Some(&path));
    window.until_exact();
    window
}

impl Window {
    #[track_caller]
    fn walk(&mut self, least: usize, within: impl Fn(Rect) -> bool) {
        let (count, faults) = faults(&mut self.harness, within);
        assert!(count >= least, "{count} controls were walked");
        assert!(faults.is_empty(), "{faults:#?}");
    }

    /// Closes what is open.
    fn close(&mut self) {
        self.key(Modifiers::NONE, Key::Escape);
        self.harness.run_steps(2);
    }
}

#[test]
fn the_walk_finds_what_has_no_name_or_no_tooltip() {
    let ui = |ui: &mut Ui| {
        let mut x = 0.5;
        let _ = ui.button("told").on_hover_text("about it");
        let _ = ui.button("untold");
        ui.add(Slider::new(&mut x, 0.0..=1.0).show_value(false)).on_hover_text("about it");
        let _ = ui.add_enabled(false, Button::new("off")).on_hover_text("about it");
        let nameless = ui.button("").on_hover_text("about it");
        nameless.widget_info(|| WidgetInfo::new(eframe::egui::Role::Button));
    };
    let builder = Harness::builder().with_accessibility_check(false);
    let (count, faults) = faults(&mut builder.build_ui(ui), |_| true);
    assert_eq!(count, 5);
    assert!(!faults.iter().any(|f| f.contains("`told`")), "{faults:#?}");
    assert!(faults.iter().any(|f| f.contains("`untold`") && f.ends_with("no tooltip")));
    assert!(faults.iter().any(|f| f.contains("`off`") && f.ends_with("no tooltip")));
    assert!(faults.iter().any(|f| f.contains("Slider") && f.ends_with("no name")), "{faults:#?}");
    assert!(faults.iter().filter(|f| f.contains("Button") && f.ends_with("no name")).count() == 1);
}

#[test]
fn every_control_of_the_panels_has_a_name_and_a_tooltip() {
    let mut window = tall();
    window.walk(40, |_| true);
    let inspector = |window: &Window| {
        let left = window.rect(Role::Image, "picture").right();
        move |rect: Rect| rect.left() >= left
    };
    for (line, least) in [
        ("mirror", 30),
        ("tiles", 30),
        ("key", 6),
        ("fill", 6),
        ("floor", 8),
        ("ball", 8),
        ("pane", 8),
    ] {
        window.click(line);
        if line == "mirror" {
            window.drag_slider("diffuse", 0.9);
            window.click("channels of reflect");
            window.type_into("specular value", "0.25");
        }
        if line == "fill" {
            assert!(window.button("one value for intensity").is_some());
        }
        if line == "pane" {
            window.click("points (3)");
        }
        let within = inspector(&window);
        window.walk(least, within);
    }
    window.click("mirror");
    window.harness.get_by_role_and_label(Role::ColorWell, "color").click();
    window.harness.run_steps(3);
    let shown = window.harness.ctx.memory(|m| m.areas().visible_layer_ids());
    assert!(shown.iter().any(|l| l.order == Order::Foreground), "the picker is open");
    let nameless = window.harness.unnamed_widgets();
    assert!(nameless.is_empty(), "{nameless:#?}");
}

#[test]
fn every_item_of_the_menus_has_a_name_and_a_tooltip() {
    let mut window = tall();
    for (menu, least) in [("File", 7), ("Edit", 2), ("View", 12)] {
        window.click(menu);
        let bar = window.rect(Role::Button, "Move camera").bottom() + 4.0;
        let right = window.rect(Role::Button, menu).left() + 190.0;
        let popup = move |rect: Rect| rect.top() > bar && rect.center().x < right;
        let _ = popup;
        let areas = window.popups();
        window.walk(least, move |rect| areas.iter().any(|area| area.contains_rect(rect)));
        window.close();
    }
    for submenu in ["New", "Open recent"] {
        window.menu(&["File", submenu]);
        let areas = window.popups();
        assert_eq!(areas.len(), 2, "{submenu} is open");
        window.walk(1, move |rect| areas[1].contains_rect(rect));
        window.close();
    }
}

impl Window {
    /// The places of open menus and questions, in the order in which they opened.
    fn popups(&self) -> Vec<Rect> {
        self.harness.ctx.memory(|m| {
            let layers = m.areas().visible_layer_ids().into_iter();
            let open = layers.filter(|l| l.order == Order::Foreground);
            open.filter_map(|l| m.area_rect(l.id)).collect()
        })
    }
}

#[test]
fn every_button_of_the_questions_has_a_name_and_a_tooltip() {
    let mut window = tall();
    window.key(Modifiers::COMMAND, Key::E);
    window.until_text("Export the picture");
    window.walk_popup(8);
    window.click("Choose file…");
    window.until_text("The system offers no file dialog here");
    window.walk_popup(4);
    window.click("Cancel");

    window.click("mirror");
    window.drag_slider("diffuse", 0.9);
    window.menu(&["File", "New", "Empty stage"]);
    window.until_text("Save the changes to");
    window.walk_popup(3);
    window.click("Cancel");

    std::fs::write(window.file("scene.toml"), "changed").unwrap();
    window.key(Modifiers::COMMAND, Key::S);
    window.until_text("The file was changed by another program");
    window.walk_popup(3);
}

impl Window {
    #[track_caller]
    fn walk_popup(&mut self, least: usize) {
        let areas = self.popups();
        self.walk(least, move |rect| areas.iter().any(|area| area.expand(2.0).contains_rect(rect)));
    }
}
