//! Every control has a name and a tooltip: a walk over all that can be pressed, dragged or typed into.

use eframe::egui::{Button, Checkbox, Order, Slider, Ui};

use super::*;
use crate::faces::SCENE;

/// A control that shows: its role and name, and where it is.
#[derive(Clone, Debug, PartialEq)]
struct Control {
    role: Role,
    name: String,
    rect: Rect,
}

/// All that can be pressed, dragged or typed into. The dividers between panels are left out: they
/// are egui's own, which gives them a name but no tooltip; the pointer shows what they do.
fn controls<S>(harness: &Harness<'_, S>) -> Vec<Control> {
    let nodes = harness.root().children_recursive();
    let inputs = nodes.filter(|node| {
        let node = node.accesskit_node();
        is_input(node.role()) && node.role() != Role::Splitter && !node.is_hidden()
    });
    let control = |node: egui_kittest::Node<'_>| {
        let (role, name) = (node.accesskit_node().role(), node.accesskit_node().label());
        Control { role, name: name.unwrap_or_default(), rect: node.rect() }
    };
    inputs.map(control).collect()
}

/// What of some controls has no name, or no tooltip when the pointer rests on it.
fn faults<S>(harness: &mut Harness<'_, S>, controls: &[Control]) -> Vec<String> {
    let mut faults = Vec::new();
    for Control { role, name, rect } in controls {
        if name.trim().is_empty() {
            faults.push(format!("{role:?} at {rect} has no name"));
        }
        if !explains_itself(harness, rect.center()) {
            faults.push(format!("{role:?} `{name}` at {rect} has no tooltip"));
        }
    }
    faults
}

/// Whether a tooltip, or the menu behind a line of a menu, shows while the pointer rests at a point.
fn explains_itself<S>(harness: &mut Harness<'_, S>, at: Pos2) -> bool {
    let shown = |harness: &Harness<'_, S>, order: Order| {
        let layers = harness.ctx.memory(|m| m.areas().visible_layer_ids());
        layers.iter().filter(|layer| layer.order == order).count()
    };
    for _ in 0..20 {
        harness.remove_cursor();
        harness.step();
        if shown(harness, Order::Tooltip) == 0 {
            break;
        }
    }
    assert_eq!(shown(harness, Order::Tooltip), 0, "the tooltip before it goes away");
    let popups = shown(harness, Order::Foreground);
    // A little to the side first: a pointer that rests at once was never moved.
    harness.hover_at(at + vec2(1.0, 0.0));
    harness.hover_at(at);
    harness.step();
    (0..8).any(|_| {
        harness.step();
        shown(harness, Order::Tooltip) > 0 || shown(harness, Order::Foreground) > popups
    })
}

#[test]
fn the_walk_finds_what_has_no_name_or_no_tooltip() {
    let ui = |ui: &mut Ui| {
        let (mut x, mut on) = (0.5, true);
        let _ = ui.button("told").on_hover_text("about it");
        let _ = ui.button("untold");
        let slider = Slider::new(&mut x, 0.0..=1.0).show_value(false);
        ui.add(slider).on_hover_text("about it").accessible_name("half");
        let _ = ui.add_enabled(false, Button::new("off")).on_hover_text("about it");
        ui.add(Checkbox::without_text(&mut on));
    };
    let builder = Harness::builder().with_accessibility_check(false);
    let mut harness = builder.build_ui(ui);
    let controls = controls(&harness);
    assert_eq!(controls.len(), 5, "{controls:?}");
    let faults = faults(&mut harness, &controls);
    let found = |part: &str, end: &str| {
        faults.iter().filter(|f| f.contains(part) && f.ends_with(end)).count() == 1
    };
    assert!(found("`untold`", "no tooltip") && found("`off`", "no tooltip"), "{faults:#?}");
    assert!(found("CheckBox", "no name") && found("CheckBox", "no tooltip"), "{faults:#?}");
    assert_eq!(faults.len(), 4, "`told` and `half` are in order: {faults:#?}");
}

/// A window so tall that nothing has to be scrolled.
fn tall() -> Window {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.toml");
    let pane = "pane = { polygon = { points = [[0, 5, 0], [1, 5, 0], [0, 5, 1]] }, \
                material = \"tiles\" }\nwhole = { merge = [\"ball\"] }\n";
    std::fs::write(&path, format!("{SCENE}{pane}")).unwrap();
    let answers = vec![Answer::NoService];
    let mut window = Window::of_size(vec2(1280.0, 1400.0), folder, Some(path.clone()), answers);
    window.until("the scene is open", |app| app.document().path() == Some(&path));
    window.until_exact();
    window
}

impl Window {
    /// Walks over what shows and did not show `before`: at least so many controls.
    #[track_caller]
    fn walk(&mut self, before: &[Control], least: usize) {
        let mut controls = controls(&self.harness);
        controls.retain(|control| !before.contains(control));
        assert!(controls.len() >= least, "{} controls were walked", controls.len());
        let faults = faults(&mut self.harness, &controls);
        assert!(faults.is_empty(), "{faults:#?}");
    }

    fn controls(&self) -> Vec<Control> {
        controls(&self.harness)
    }
}

#[test]
fn every_control_of_the_panels_has_a_name_and_a_tooltip() {
    let mut window = tall();
    window.walk(&[], 40);
    let lines = ["mirror", "tiles", "key", "fill", "floor", "ball", "whole", "pane"];
    for (line, least) in lines.into_iter().zip([30, 30, 6, 6, 8, 8, 8, 8]) {
        window.click(line);
        match line {
            "mirror" => {
                window.drag_slider("diffuse", 0.9);
                window.click("channels of reflect");
                window.type_into("specular value", "0.25");
                assert!(window.button("reset specular").is_some());
            }
            "fill" => assert!(window.button("one value for intensity").is_some()),
            "pane" => window.click("points (3)"),
            _ => {}
        }
        let left = window.rect(Role::Image, "picture").right();
        let mut others = window.controls();
        others.retain(|control| control.rect.left() < left);
        window.walk(&others, least);
    }
    let before = window.controls();
    window.click("material");
    window.walk(&before, 2);
}

#[test]
fn every_control_of_the_mixer_has_a_name_and_a_tooltip() {
    let mut window = tall();
    let before = window.controls();
    window.key(Modifiers::NONE, Key::L);
    window.harness.run_steps(3);
    // What moved to make room is not new.
    let mut others = window.controls();
    others.retain(|control| before.iter().any(|old| old.name == control.name));
    window.walk(&others, 15);
}

#[test]
fn every_control_of_speed_and_accuracy_has_a_name_and_a_tooltip() {
    let mut window = tall();
    let before = window.controls();
    window.menu(&["View", "Speed and accuracy"]);
    window.type_into("chart reference", "8");
    window.click("Measure");
    window.until_text("Apply recommended");
    window.harness.run_steps(3);
    // What moved to make room is not new.
    let panel = window.rect(Role::Button, "Measure").top();
    let mut others = window.controls();
    others.retain(|control| before.iter().any(|old| old.name == control.name));
    let below = |control: &Control| control.rect.center().y > 1380.0 || control.rect.top() < panel;
    let hidden = window.controls().into_iter().filter(below);
    others.extend(hidden);
    window.walk(&others, 8);
}

#[test]
fn every_control_of_mass_has_a_name_and_a_tooltip() {
    let mut window = tall();
    window.click("ball");
    let before = window.controls();
    window.menu(&["View", "Mass properties"]);
    window.harness.run_steps(3);
    // What moved to make room is not new.
    let mut others = window.controls();
    others.retain(|control| before.iter().any(|old| old.name == control.name));
    window.walk(&others, 3);
}

#[test]
fn every_control_of_a_pixel_has_a_name_and_a_tooltip() {
    let mut window = tall();
    let before = window.controls();
    window.key(Modifiers::NONE, Key::I);
    window.until_text("Click a pixel of the picture");
    let picture = window.rect(Role::Image, "picture").center();
    window.click_at(picture, Modifiers::NONE);
    window.until_text("By bounce");
    window.harness.run_steps(3);
    // What moved to make room, or came with another selection, is not new.
    let panel = window.rect(Role::Button, "Close pixel").top() - 10.0;
    let mut others = window.controls();
    let is_old = |c: &Control| before.iter().any(|old| old.name == c.name);
    let below = |c: &Control| c.rect.center().y > 1380.0;
    others.retain(|control| is_old(control) || control.rect.top() < panel || below(control));
    window.walk(&others, 8);
}

#[test]
fn every_control_of_the_welcome_has_a_name_and_a_tooltip() {
    let mut window = tall();
    let before = window.controls();
    window.menu(&["Help", "Welcome"]);
    window.harness.run_steps(30);
    // What moved to make room is not new.
    let mut others = window.controls();
    others.retain(|control| before.iter().any(|old| old.name == control.name));
    window.walk(&others, 18);
}

#[test]
fn every_control_of_a_file_that_changed_on_disk_has_a_name_and_a_tooltip() {
    let mut window = tall();
    window.click("mirror");
    window.drag_slider("diffuse", 0.9);
    let before = window.controls();
    let changed = SCENE.replace("samples = 2", "samples = 3");
    std::fs::write(window.file("scene.toml"), changed).unwrap();
    window.until_button("Load theirs");
    let mut others = window.controls();
    others.retain(|control| before.iter().any(|old| old.name == control.name));
    window.walk(&others, 2);
}

#[test]
fn every_item_of_the_menu_of_a_line_has_a_name_and_a_tooltip() {
    let mut window = tall();
    for (line, least) in [("mirror", 4), ("ball", 3), ("fill", 3)] {
        window.click(line);
        let before = window.controls();
        window.right_click(line);
        window.walk(&before, least);
        window.key(Modifiers::NONE, Key::Escape);
    }
    window.key(Modifiers::NONE, Key::F2);
    window.harness.run_steps(3);
    let field = window.controls().into_iter().find(|control| control.role == Role::TextInput);
    assert_eq!(field.expect("a field").name, "name of light fill");
}

#[test]
fn every_control_of_the_colour_picker_has_a_name_and_a_tooltip() {
    let mut window = tall();
    for (line, swatch, least) in [("mirror", "color", 9), ("key", "color", 11)] {
        window.click(line);
        let before = window.controls();
        let swatch = window.rect(Role::ColorWell, swatch).center();
        window.click_at(swatch, Modifiers::NONE);
        window.walk(&before, least);
        window.key(Modifiers::NONE, Key::Escape);
    }
}

#[test]
fn every_preset_has_a_name_and_a_tooltip() {
    let mut window = tall();
    window.click("mirror");
    let before = window.controls();
    window.click("Presets");
    // What moved to make room is not new.
    let mut others = window.controls();
    others.retain(|control| before.iter().any(|old| old.name == control.name));
    window.walk(&others, 20);
}

#[test]
fn every_item_of_the_menu_of_a_value_has_a_name_and_a_tooltip() {
    let mut window = tall();
    window.click("mirror");
    let before = window.controls();
    for (role, name, least) in [
        (Role::Slider, "diffuse", 4),
        (Role::SpinButton, "ior value", 4),
        (Role::ColorWell, "color", 5),
    ] {
        let at = window.rect(role, name).center();
        window.right_click_at(at);
        window.walk(&before, least);
        window.key(Modifiers::NONE, Key::Escape);
    }
}

#[test]
fn every_item_of_the_menus_has_a_name_and_a_tooltip() {
    let mut window = tall();
    let paths: [(&[&str], usize); 10] = [
        (&["File"], 7),
        (&["Edit"], 9),
        (&["Edit", "Add solid"], 18),
        (&["+ Add solid"], 18),
        (&["Picture"], 10),
        (&["View"], 16),
        (&["Help"], 5),
        (&["File", "New"], 3),
        (&["File", "Open recent"], 1),
        (&["View", "Colours and size"], 8),
    ];
    for (path, least) in paths {
        window.menu(&path[..path.len() - 1]);
        let before = window.controls();
        window.click(path[path.len() - 1]);
        window.walk(&before, least);
        window.key(Modifiers::NONE, Key::Escape);
        window.key(Modifiers::NONE, Key::Escape);
        assert!(!window.shows("Open…") && !window.shows("Reset layout"), "{path:?} is closed");
    }
}

#[test]
fn every_line_of_the_palette_has_a_name_and_a_tooltip() {
    let mut window = tall();
    let before = window.controls();
    window.key(Modifiers::COMMAND, Key::K);
    window.write("z");
    window.harness.run_steps(3);
    window.walk(&before, 5);
}

#[test]
fn the_button_of_the_list_of_keys_has_a_name_and_a_tooltip() {
    let mut window = tall();
    let before = window.controls();
    window.key(Modifiers::NONE, Key::Questionmark);
    window.until_text("Keys and gestures");
    window.harness.run_steps(3);
    window.walk(&before, 1);
}

#[test]
fn every_button_of_the_questions_has_a_name_and_a_tooltip() {
    let mut window = tall();
    let before = window.controls();
    window.key(Modifiers::COMMAND, Key::E);
    window.until_text("Export the picture");
    window.harness.run_steps(3);
    window.walk(&before, 8);
    window.click("Choose file…");
    window.until_text("The system offers no file dialog here");
    window.until_button("config/");
    window.walk(&before, 4);
    window.click("Cancel");
    window.key(Modifiers::NONE, Key::Escape);

    window.click("mirror");
    window.drag_slider("diffuse", 0.9);
    window.harness.run_steps(3);
    let before = window.controls();
    window.menu(&["File", "New", "Empty stage"]);
    window.until_text("Save the changes to");
    window.harness.run_steps(3);
    window.walk(&before, 3);
    window.click("Cancel");

    std::fs::write(window.file("scene.toml"), "changed").unwrap();
    window.key(Modifiers::COMMAND, Key::S);
    window.until_text("The file was changed by another program");
    window.harness.run_steps(3);
    window.walk(&before, 3);
}
