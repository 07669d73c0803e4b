//! Questions about work that would be lost.

use super::*;
use crate::faces::SCENE;

/// A window with an edit that is not saved.
fn edited() -> Window {
    let mut window = Window::with_scene(SCENE, Vec::new());
    window.click("mirror");
    window.drag_slider("diffuse", 0.9);
    window
}

#[test]
fn unsaved_work_is_asked_about_before_it_is_replaced() {
    let mut window = edited();
    let scene = window.app().document().scene().clone();
    let question = "Save the changes to scene.toml?";
    window.menu(&["File", "New", "Material ball"]);
    window.until_text(question);
    window.click("Cancel");
    assert!(!window.shows(question));
    assert!(*window.app().document().scene() == scene && window.app().document().is_unsaved());

    window.menu(&["File", "New", "Material ball"]);
    window.key(Modifiers::NONE, Key::Escape);
    assert!(!window.shows(question), "Escape is Cancel");
    assert!(*window.app().document().scene() == scene);

    window.menu(&["File", "New", "Material ball"]);
    window.click("Save");
    window.until("the template", |app| app.document().title() == "Material ball");
    assert!(window.scene_text() != SCENE, "it was saved first");
}

#[test]
fn changes_may_be_given_up() {
    let mut window = edited();
    window.menu(&["File", "New", "Glass on a table"]);
    window.click("Do not save");
    window.until("the template", |app| app.document().title() == "Glass on a table");
    assert_eq!(window.scene_text(), SCENE);
    window.menu(&["File", "New", "Empty stage"]);
    assert_eq!(window.app().document().title(), "Empty stage", "nothing to ask about");
}

#[test]
fn closing_asks_too() {
    let mut window = edited();
    let close = |window: &mut Window| {
        let input = window.harness.input_mut();
        let viewport = input.viewports.get_mut(&eframe::egui::ViewportId::ROOT).unwrap();
        viewport.events.push(eframe::egui::ViewportEvent::Close);
        window.harness.step();
        let output = window.harness.output();
        let commands = &output.viewport_output[&eframe::egui::ViewportId::ROOT].commands;
        commands.contains(&eframe::egui::ViewportCommand::CancelClose)
    };
    assert!(close(&mut window), "the window stays");
    window.harness.run_steps(2);
    window.until_text("Save the changes to scene.toml?");
    window.click("Cancel");
    window.save();
    assert!(!close(&mut window), "nothing holds it any more");
}

#[test]
fn a_file_that_another_program_changed_is_not_replaced_silently() {
    let mut window = edited();
    let foreign = format!("{SCENE}\n# by another program\n");
    std::fs::write(window.file("scene.toml"), &foreign).unwrap();
    window.key(Modifiers::COMMAND, Key::S);
    window.until_text("The file was changed by another program");
    window.click("Cancel");
    assert!(window.app().document().is_unsaved() && window.scene_text() == foreign);

    window.key(Modifiers::COMMAND, Key::S);
    window.until_text("The file was changed by another program");
    window.click("Overwrite");
    window.until("it is saved", |app| !app.document().is_unsaved());
    assert!(window.scene_text() != foreign);
    assert_eq!(std::fs::read_to_string(window.file("scene.toml~")).unwrap(), foreign);
}

impl Window {
    /// Presses the slider of diffuse, which keeps the keyboard, and waits for its tooltip.
    fn use_a_slider(&mut self) {
        self.drag_slider("diffuse", 0.9);
        let at = self.rect(Role::Slider, "diffuse").center();
        self.harness.hover_at(at + vec2(2.0, 0.0));
        self.harness.hover_at(at);
        self.harness.run_steps(10);
        assert_eq!(self.tooltips(), 1, "the slider explains itself");
    }

    fn tooltips(&self) -> usize {
        let layers = self.harness.ctx.memory(|m| m.areas().visible_layer_ids());
        layers.iter().filter(|layer| layer.order == eframe::egui::Order::Tooltip).count()
    }
}

#[test]
fn enter_answers_a_question_whatever_had_the_keyboard() {
    let mut window = Window::with_scene(SCENE, vec![Answer::NoService]);
    window.click("mirror");
    window.use_a_slider();
    window.key(Modifiers::COMMAND, Key::E);
    window.until_text("Export the picture");
    window.harness.run_steps(3);
    assert_eq!(window.tooltips(), 0, "nothing of the window stays above the question");
    window.key(Modifiers::NONE, Key::Enter);
    window.until_text("The system offers no file dialog here");
    let file = window.file("entered.png");
    window.key(Modifiers::COMMAND, Key::A);
    window.write(&file.display().to_string());
    window.key(Modifiers::NONE, Key::Enter);
    window.until_text("wrote ");
    assert!(file.exists());

    window.use_a_slider();
    window.menu(&["File", "New", "Empty stage"]);
    window.until_text("Save the changes to");
    window.key(Modifiers::NONE, Key::Enter);
    window.until("it is saved and replaced", |app| app.document().title() == "Empty stage");
    assert!(window.scene_text() != SCENE);
}

#[test]
fn another_control_of_a_question_may_have_the_keyboard() {
    let mut window = Window::with_scene(SCENE, Vec::new());
    window.key(Modifiers::COMMAND, Key::E);
    window.until_text("Export the picture");
    window.harness.run_steps(3);
    window.key(Modifiers::NONE, Key::Tab);
    window.key(Modifiers::NONE, Key::Enter);
    assert!(!window.shows("Export the picture"), "Cancel follows, and was pressed");

    window.key(Modifiers::NONE, Key::Questionmark);
    window.until_text("Keys and gestures");
    window.harness.run_steps(3);
    window.key(Modifiers::NONE, Key::Enter);
    assert!(!window.shows("Keys and gestures"), "Close had the keyboard");
}
