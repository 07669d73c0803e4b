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
