//! Lights and materials added, copied, renamed, deleted and assigned; names of all things.

use super::*;
use crate::faces::SCENE;

impl Window {
    fn lights(&self) -> Vec<String> {
        self.app().document().scene().lights.iter().map(|light| light.name.clone()).collect()
    }

    fn materials(&self) -> Vec<String> {
        let materials = &self.app().document().scene().materials;
        materials.iter().map(|material| material.name.clone()).collect()
    }

    /// Opens the menu of a line of the lists.
    pub(super) fn right_click(&mut self, name: &str) {
        let at = self.settled(name);
        self.harness.event(Event::PointerMoved(at));
        for pressed in [true, false] {
            let (button, modifiers) = (PointerButton::Secondary, Modifiers::NONE);
            self.harness.event(Event::PointerButton { pos: at, button, pressed, modifiers });
        }
        self.harness.run_steps(3);
    }

    /// Types a name into the field that just opened, and leaves it by a key.
    pub(super) fn type_name(&mut self, name: &str, end: Key) {
        self.harness.run_steps(3);
        self.write(name);
        self.key(Modifiers::NONE, end);
    }

    /// What the badge beside `Assign` says, once it is known.
    fn cost_of_assigning(&mut self) -> String {
        let start = Instant::now();
        loop {
            let texts = self.texts();
            let told = texts.iter().find_map(|text| text.strip_prefix("cost of assigning: "));
            match told {
                Some(told) if told != "…" => return told.to_owned(),
                _ => assert!(start.elapsed() < PATIENCE, "no cost: {told:?}"),
            }
            self.harness.step();
            std::thread::sleep(Duration::from_millis(3));
        }
    }

    /// Undoes everything: the scene is as it was opened, and then as it was again.
    pub(super) fn undo_and_redo_all(&mut self, steps: usize) {
        let edited = self.app().document().scene().clone();
        for _ in 0..steps {
            assert!(self.undo_name().is_some());
            self.key(Modifiers::COMMAND, Key::Z);
        }
        assert!(self.undo_name().is_none() && !self.app().document().is_unsaved());
        for _ in 0..steps {
            self.key(Modifiers::COMMAND | Modifiers::SHIFT, Key::Z);
        }
        assert!(*self.app().document().scene() == edited);
    }

    /// What is saved renders afresh to what the window shows.
    pub(super) fn assert_live_is_fresh(&mut self) {
        self.until_exact();
        self.save();
        assert!(rgb(&self.picture()) == rendered(self.folder.path(), "scene.toml"));
    }
}

#[test]
fn lights_and_materials_are_added_behind_the_others() {
    let mut window = Window::with_scene(SCENE, Vec::new());
    window.click("+ Add light");
    assert_eq!(window.undo_name(), Some("add light light"));
    assert!(window.shows("Light light"), "it is selected");
    assert!(window.shows("light light handle"), "it can be seen");
    window.menu(&["Edit", "Add light"]);
    window.click("+ Add material");
    assert_eq!(window.undo_name(), Some("add material material"));
    assert!(window.shows("Material material"));
    assert_eq!(window.lights(), ["key", "fill", "light", "light 2"]);
    assert_eq!(window.materials(), ["tiles", "mirror", "material"]);
    window.undo_and_redo_all(3);
    window.assert_live_is_fresh();
    let text = window.scene_text();
    assert!(
        text.contains("0.3] }\nlight = { point = [") && text.contains("\"light 2\" ="),
        "{text}"
    );
    assert!(text.contains("[materials.material]"), "{text}");
}

#[test]
fn a_copy_is_made_from_the_menu_of_a_line_and_by_its_keys() {
    let mut window = Window::with_scene(SCENE, Vec::new());
    window.right_click("key");
    window.click("Duplicate light key");
    assert_eq!(window.lights(), ["key", "fill", "key 2"]);
    assert_eq!(window.undo_name(), Some("add light key 2"));
    assert!(window.shows("Light key 2"), "the copy is selected");
    window.key(Modifiers::COMMAND, Key::D);
    assert_eq!(window.lights(), ["key", "fill", "key 2", "key 3"]);
    window.click("mirror");
    window.click("Duplicate");
    assert_eq!(window.materials(), ["tiles", "mirror", "mirror 2"]);
    window.undo_and_redo_all(3);
    window.assert_live_is_fresh();
    let line = "\"key 2\" = { point = [-4, -5, 7], intensity = 0.8 }";
    assert!(window.scene_text().contains(line), "{}", window.scene_text());
}

#[test]
fn a_name_is_changed_in_its_line_and_wherever_it_stands() {
    let mut window = Window::with_scene(SCENE, Vec::new());
    window.click("mirror");
    window.key(Modifiers::NONE, Key::F2);
    window.type_name("chrome ball", Key::Enter);
    assert_eq!(window.materials(), ["tiles", "chrome ball"]);
    assert_eq!(window.undo_name(), Some("rename material mirror → chrome ball"));
    assert!(window.shows("Material chrome ball"));
    let line = window.settled("key");
    window.double_click_at(line);
    window.type_name("main", Key::Enter);
    assert_eq!(window.lights(), ["main", "fill"]);
    window.click("main");
    window.click("Rename");
    window.type_name("other", Key::Escape);
    assert_eq!(window.lights(), ["main", "fill"], "Escape keeps the name");
    window.click("Rename");
    window.type_name("fill", Key::Escape);
    window.undo_and_redo_all(2);
    window.save();
    let wanted = SCENE.replace("key =", "main =").replace(".mirror]", ".\"chrome ball\"]");
    assert_eq!(window.scene_text(), wanted.replace("\"mirror\"", "\"chrome ball\""));
}

#[test]
fn a_name_that_is_taken_stays_in_its_field_with_the_reason_below() {
    let taken = "there is another light with the name fill";
    let mut window = Window::with_scene(SCENE, Vec::new());
    let typed = |window: &Window| {
        let field = Role::TextInput;
        let node = window.harness.query_by_role_and_label(field, "name of light key")?;
        node.accesskit_node().value()
    };
    window.click("key");
    window.key(Modifiers::NONE, Key::F2);
    window.type_name("fill", Key::Enter);
    assert!(window.shows(taken) && window.button("Close").is_none(), "below the field");
    assert_eq!(typed(&window).as_deref(), Some("fill"));
    window.key(Modifiers::NONE, Key::Enter);
    assert!(window.shows(taken) && typed(&window).is_some(), "it is still there");
    window.write("er");
    window.harness.run_steps(2);
    assert!(!window.shows(taken), "this one is free");
    assert_eq!(typed(&window).as_deref(), Some("filler"));
    for _ in 0..2 {
        window.key(Modifiers::NONE, Key::Backspace);
    }
    assert!(window.shows(taken));
    window.key(Modifiers::NONE, Key::Escape);
    assert!(!window.shows(taken) && typed(&window).is_none(), "Escape leaves it");
    window.key(Modifiers::NONE, Key::F2);
    window.type_name(" ", Key::Enter);
    assert!(window.shows("a light needs a name"));
    window.write("fill");
    window.click("Scene");
    assert!(window.shows("there is another light with the name") && typed(&window).is_none());
    assert!(window.button("Close").is_some(), "given up, with a message");
    assert_eq!((window.lights(), window.undo_name()), (vec!["key".into(), "fill".into()], None));
}

#[test]
fn a_name_being_typed_is_no_shortcut_and_a_click_elsewhere_takes_it() {
    let mut window = Window::with_scene(SCENE, Vec::new());
    window.click("key");
    window.click("Rename");
    window.harness.run_steps(3);
    window.write("h");
    window.key(Modifiers::NONE, Key::Delete);
    window.key(Modifiers::NONE, Key::L);
    assert_eq!(window.lights(), ["key", "fill"], "the light is still there");
    assert!(!window.shows("Close the light mixer"));
    window.click("Scene");
    assert_eq!(window.lights(), ["h", "fill"]);
}

#[test]
fn a_material_in_use_stays_and_says_by_whom() {
    let mut window = Window::with_scene(SCENE, Vec::new());
    window.click("mirror");
    window.click("Delete");
    window.until_text("material mirror is used by ball: give it another material first");
    assert!(!window.app().document().is_unsaved());
    window.click("Close");

    window.click("Solid ball");
    window.click("material");
    window.harness.run_steps(3);
    let at = window.harness.get_all_by_label("tiles").last().expect("an item").rect().center();
    window.click_at(at, Modifiers::NONE);
    assert_eq!(window.undo_name(), Some("material of ball mirror → tiles"));
    window.right_click("mirror");
    window.click("Delete material mirror");
    assert_eq!(window.materials(), ["tiles"]);
    assert_eq!(window.undo_name(), Some("remove material mirror"));
    window.undo_and_redo_all(2);
    window.assert_live_is_fresh();
    assert!(!window.scene_text().contains("mirror"), "{}", window.scene_text());
}

#[test]
fn lights_are_deleted_by_a_key_and_the_next_one_is_selected() {
    let mut window = Window::with_scene(SCENE, Vec::new());
    window.key(Modifiers::NONE, Key::Delete);
    assert_eq!(window.lights().len(), 2, "the scene itself is not deleted");
    window.click("key");
    window.key(Modifiers::NONE, Key::Delete);
    assert_eq!(window.lights(), ["fill"]);
    assert!(window.shows("Light fill"));
    window.key(Modifiers::NONE, Key::Delete);
    assert!(window.lights().is_empty() && window.undo_name() == Some("remove light fill"));
    window.undo_and_redo_all(2);
    window.assert_live_is_fresh();
}

#[test]
fn a_material_is_assigned_to_the_solid_that_was_clicked() {
    let mut window = Window::with_scene(SCENE, Vec::new());
    let made_of = |window: &Window| window.app().document().scene().solids[1].material;
    window.click("tiles");
    window.click("Assign to picked solid");
    assert_eq!(window.undo_name(), None, "nothing was picked yet");
    let middle = window.rect(Role::Image, "picture").center();
    window.click_at(middle, Modifiers::NONE);
    assert!(window.shows("Material mirror"));
    window.click("tiles");
    let cost = window.cost_of_assigning();
    assert!(cost != "instant", "it moves more than colours: {cost}");
    window.click("Assign tiles to ball");
    assert_eq!(made_of(&window), 0);
    assert_eq!(window.undo_name(), Some("material of ball mirror → tiles"));
    window.undo_and_redo_all(1);
    window.assert_live_is_fresh();
    assert!(window.scene_text().contains("radius = 1 }, material = \"tiles\""));
}
