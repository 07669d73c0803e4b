//! Looks and snapshots in the strip, and the comparison with what was.

use eframe::egui::pos2;

use super::*;
use crate::faces::{SCENE, decode_png, succeed};

const LOOKS: &str = "
[looks.night]
lights.key.on = false
materials.mirror.diffuse = 0.1

[looks.below]
camera.eye = [0, -6, 3]
";

impl Window {
    fn with_looks() -> Window {
        let mut window = Window::with_scene(&format!("{SCENE}{LOOKS}"), Vec::new());
        window.key(Modifiers::NONE, Key::K);
        assert!(window.shows("look night"));
        window
    }

    fn worn(&self) -> Option<&str> {
        self.app().document().scene().looks.worn()
    }

    /// Chooses from the menu of a card.
    fn card_menu(&mut self, card: &str, item: &str) {
        let pos = self.settled(card);
        self.harness.event(Event::PointerMoved(pos));
        for pressed in [true, false] {
            let (button, modifiers) = (PointerButton::Secondary, Modifiers::NONE);
            self.harness.event(Event::PointerButton { pos, button, pressed, modifiers });
        }
        self.harness.run_steps(3);
        self.click(item);
    }
}

#[test]
fn a_click_puts_a_look_on_without_rays_and_undo_takes_it_off() {
    let mut window = Window::with_looks();
    let plain = window.picture();
    window.until_text("cost of look night: instant");
    window.until_text("cost of look below: traces all");
    window.click("look night");
    window.until_exact();
    assert_eq!((window.worn(), window.undo_name()), (Some("night"), Some("look night")));
    window.until_text("· 0 rays");
    let render = ["render", "scene.toml", "-o", "night.png", "--look", "night"];
    succeed(window.folder.path(), &render);
    assert!(rgb(&window.picture()) == decode_png(&window.file("night.png")).unwrap().2);
    assert!(window.picture() != plain);
    window.key(Modifiers::COMMAND, Key::Z);
    window.until_exact();
    assert!(window.worn().is_none() && window.picture() == plain);
    assert!(!window.app().document().is_unsaved());
}

#[test]
fn what_is_edited_while_a_look_is_worn_is_saved_in_it() {
    let mut window = Window::with_looks();
    window.click("look night");
    window.click("mirror");
    window.type_into("specular value", "0.25");
    window.until_exact();
    window.save();
    let text = window.scene_text();
    assert!(text.contains("diffuse = 0.1\nmaterials.mirror.specular = 0.25\n"), "{text}");
    assert!(text.contains("specular = 0.6\n") && text.contains("\nlook = \"night\"\n"), "{text}");
    assert!(rgb(&window.picture()) == rendered(window.folder.path(), "scene.toml"));
    window.click("no look");
    window.until_exact();
    window.save();
    let expected = format!("{SCENE}{LOOKS}")
        .replace("diffuse = 0.1\n", "diffuse = 0.1\nmaterials.mirror.specular = 0.25\n");
    assert_eq!(window.scene_text(), expected);
}

/// The field in which the look that was just added gets another name.
const NAME_FIELD: &str = "name of look look 1";

#[test]
fn looks_are_added_renamed_and_deleted() {
    let mut window = Window::with_looks();
    window.click("+ Look");
    assert_eq!(window.worn(), Some("look 1"));
    window.card_menu("look look 1", "Rename look look 1");
    window.key(Modifiers::COMMAND, Key::A);
    window.write("dusk");
    window.key(Modifiers::NONE, Key::Enter);
    assert_eq!(
        (window.worn(), window.undo_name()),
        (Some("dusk"), Some("rename look look 1 → dusk"))
    );
    window.click("+ Look");
    window.card_menu("look look 1", "Rename look look 1");
    for (name, why) in [("dusk", "there is a look `dusk` already"), (" ", "a look needs a name")] {
        window.key(Modifiers::COMMAND, Key::A);
        window.write(name);
        window.key(Modifiers::NONE, Key::Enter);
        assert!(window.shows(why) && window.button("Close").is_none(), "below the field: {why}");
        assert!(window.harness.query_by_role_and_label(Role::TextInput, NAME_FIELD).is_some());
    }
    window.key(Modifiers::NONE, Key::Escape);
    assert!(window.harness.query_by_role_and_label(Role::TextInput, NAME_FIELD).is_none());
    assert_eq!(window.worn(), Some("look 1"));
    window.card_menu("look look 1", "Delete look look 1");
    window.card_menu("look dusk", "Delete look dusk");
    assert_eq!((window.worn(), window.undo_name()), (None, Some("remove look dusk")));
}

#[test]
fn a_snapshot_brings_its_settings_back_as_one_step() {
    let mut window = Window::with_scene(SCENE, Vec::new());
    let (scene, picture) = (window.app().document().scene().clone(), window.picture());
    window.key(Modifiers::NONE, Key::S);
    window.click("mirror");
    window.drag_slider("diffuse", 0.9);
    window.drag_slider("specular", 0.1);
    window.until_exact();
    assert!(window.picture() != picture);
    window.click("snapshot 1");
    window.until_exact();
    assert!(*window.app().document().scene() == scene && window.picture() == picture);
    assert_eq!(window.undo_name(), Some("snapshot 1"));
    window.key(Modifiers::COMMAND, Key::Z);
    assert!(*window.app().document().scene() != scene);
}

#[test]
fn the_wipe_shows_the_look_beside_the_picture_and_follows_edits() {
    let mut window = Window::with_looks();
    window.card_menu("look night", "Compare with look night");
    window.until_text("look night | now");
    let wipe = window.harness.get_by_label("wipe").rect();
    let picture = window.rect(Role::Image, "picture");
    assert!((wipe.center().x - picture.center().x).abs() < 2.0, "it begins in the middle");
    let (from, to) = (wipe.center(), pos2(picture.left() + 60.0, wipe.center().y));
    window.drag(from, to);
    let moved = window.harness.get_by_label("wipe").rect();
    assert!((moved.center().x - to.x).abs() < 8.0, "{moved:?} at {to:?}");
    assert!(window.undo_name().is_none(), "nothing was edited");
    window.key(Modifiers::NONE, Key::W);
    assert!(!window.shows("look night | now"));
}

#[test]
fn space_shows_the_picture_as_saved_while_it_is_held() {
    let mut window = Window::with_scene(SCENE, Vec::new());
    window.click("mirror");
    window.drag_slider("diffuse", 0.9);
    window.until_exact();
    let key = |pressed| Event::Key {
        key: Key::Space,
        physical_key: None,
        pressed,
        repeat: false,
        modifiers: Modifiers::NONE,
    };
    window.harness.event(key(true));
    window.until_text("before: as saved");
    window.harness.event(key(false));
    window.harness.run_steps(2);
    assert!(!window.shows("before: as saved"));
}

#[test]
fn an_exported_picture_opens_its_scene() {
    let mut window = Window::with_looks();
    window.click("look night");
    window.until_exact();
    window.save();
    for name in ["a.png", "a.exr"] {
        succeed(window.folder.path(), &["render", "scene.toml", "-o", name]);
        let file = window.file(name);
        let opened = rayforest::document::Document::open(&file).unwrap();
        assert!(opened.scene() == window.app().document().scene(), "{name}");
        assert!(opened.path().is_none() && opened.title() == name.split(".").next().unwrap());
    }
    succeed(window.folder.path(), &["render", "a.exr", "-o", "again.png"]);
    let bytes = |name: &str| decode_png(&window.file(name)).unwrap().2;
    assert!(bytes("again.png") == bytes("a.png"));
}
