//! Solids added, copied, renamed and deleted.

use rayforest::scene::Solid;
use rayforest::scene::fields::SHAPES;

use super::*;
use crate::faces::SCENE;

/// Below the small scene: a block, what is cut out of it, and what is made of both.
const PARTS: &str = r#"
block = { box = { min = [-1.4, -1.4, -0.9], max = [0.2, 0.2, 0.4] }, material = "mirror" } # of wood
bore = { cylinder = { from = [-0.6, -3, -0.3], to = [-0.6, 3, -0.3], radius = 0.4 }, material = "tiles" }
part = { difference = ["block", "bore"] } # the part

[looks.swapped]
solids.ball.material = "tiles"
solids.block.material = "tiles"
"#;

impl Window {
    fn solids(&self) -> Vec<&str> {
        self.scene().solids.iter().map(|solid| solid.name.as_str()).collect()
    }

    fn solid(&self, name: &str) -> &Solid {
        self.scene().solids.iter().find(|solid| solid.name == name).expect("there is one")
    }

    /// What the one look of the scene sets.
    fn look(&self) -> Vec<&str> {
        let look = &self.scene().looks.list[0];
        look.settings.iter().map(|setting| setting.path.as_str()).collect()
    }

    /// The name of the solid that mass would be measured of: the one that is picked.
    fn is_picked(&self, name: &str) -> bool {
        self.button(&format!("Measure {name}")).is_some()
    }
}

#[test]
fn a_solid_is_added_where_it_is_seen_and_made_of_what_is_selected() {
    let mut window = Window::with_scene(SCENE, Vec::new());
    let before = window.picture();
    window.menu(&["+ Add solid", "Add box"]);
    assert_eq!(window.undo_name(), Some("add solid box"));
    assert!(window.shows("Solid box"), "it is selected");
    assert_eq!(window.solid("box").material, 0, "the first one");
    window.until_exact();
    assert!(window.picture() != before, "it is seen");
    let at = window.solid("box").placement.translate;
    assert!(at.x > 1.0, "beside the ball, which stands where the camera looks at: {at}");
    window.click("mirror");
    window.menu(&["Edit", "Add solid", "Add sphere"]);
    window.until_exact();
    window.menu(&["Edit", "Add solid", "Add sphere"]);
    let [a, b, c] = ["box", "sphere", "sphere 2"].map(|n| window.solid(n).placement.translate);
    assert!(a != b && b != c && c != a, "each at a place of its own: {a} {b} {c}");
    assert_eq!(window.solids(), ["floor", "ball", "box", "sphere", "sphere 2"]);
    let made_of = ["sphere", "sphere 2"].map(|name| window.solid(name).material);
    assert_eq!(made_of, [1, 1], "of the selected material, and of that of the selected solid");
    window.undo_and_redo_all(3);
    window.assert_live_is_fresh();
    assert!(window.scene_text().starts_with(SCENE), "{}", window.scene_text());
    let line = "\nbox = { box = { min = [-1, -1, -1], max = [1, 1, 1] }, material = \"tiles\", ";
    assert!(window.scene_text().contains(line), "{}", window.scene_text());
}

/// A window with the small scene and a mesh beside it, so tall that no list need be scrolled. Whoever
/// asks for a file gets the mesh.
fn with_mesh() -> Window {
    let folder = tempfile::tempdir().unwrap();
    let (path, mesh) = (folder.path().join("scene.toml"), folder.path().join("flag.obj"));
    std::fs::write(&path, SCENE).unwrap();
    std::fs::write(&mesh, "v 0 0 0\nv 40 0 0\nv 0 0 40\nf 1 2 3\n").unwrap();
    let answers = vec![Answer::File(mesh)];
    let size = vec2(1280.0, 1400.0);
    let mut window = Window::of_size(size, folder, Some(path.clone()), answers);
    window.until("the scene is open", |app| app.document().path() == Some(&path));
    window.until_exact();
    window
}

#[test]
fn every_kind_of_solid_is_offered_and_can_be_added() {
    let mut window = with_mesh();
    for (i, key) in SHAPES.iter().enumerate() {
        window.click("ball");
        window.menu(&["+ Add solid", &format!("Add {key}")]);
        let added = |app: &App| app.document().scene().solids.len() == 3 + i;
        window.until("the solid is there", added);
        assert_eq!(window.undo_name(), Some(format!("add solid {key}").as_str()));
        assert_eq!(window.solids().last(), Some(key));
    }
    window.undo_and_redo_all(SHAPES.len());
    window.assert_live_is_fresh();
}

#[test]
fn a_mesh_is_asked_for_and_as_large_as_other_new_solids() {
    let mut window = with_mesh();
    let before = window.picture();
    window.menu(&["+ Add solid", "Add mesh"]);
    window.until("the mesh is there", |app| app.document().scene().solids.len() == 3);
    assert_eq!(window.solid("mesh").placement.scale.x, 0.03);
    window.undo_and_redo_all(1);
    window.assert_live_is_fresh();
    assert!(window.picture() != before, "it is seen");
    let text = window.scene_text();
    assert!(text.contains("mesh = { mesh = { file = \"flag.obj\" }, material ="), "{text}");
    // Without an answer there is none.
    window.menu(&["+ Add solid", "Add mesh"]);
    window.harness.run_steps(5);
    assert_eq!(window.solids(), ["floor", "ball", "mesh"]);
}

#[test]
fn what_is_made_of_others_needs_one_to_begin_with_and_says_so() {
    let mut window = Window::with_scene(SCENE, Vec::new());
    window.click("+ Add solid");
    let at = window.settled("Add difference");
    assert!(window.harness.get_by_label("Add difference").accesskit_node().is_disabled());
    window.harness.hover_at(at + vec2(1.0, 0.0));
    window.harness.hover_at(at);
    window.until_text("Select a solid first");
    window.key(Modifiers::NONE, Key::Escape);
    window.click("ball");
    window.menu(&["+ Add solid", "Add difference"]);
    assert_eq!(window.solid("difference").shape.operands(), [1]);
    assert!(window.shows("1. ball"));
    // A sheet has no inside: nothing is added, and what is selected stays so.
    window.menu(&["+ Add solid", "Add polygon"]);
    window.menu(&["+ Add solid", "Add union"]);
    window.until_text("has no inside to be an operand");
    assert_eq!(window.solids(), ["floor", "ball", "difference", "polygon"]);
    assert!(window.shows("Solid polygon"));
    window.undo_and_redo_all(2);
    window.assert_live_is_fresh();
}

#[test]
fn the_first_solid_of_an_empty_scene_comes_with_a_material_in_one_step() {
    let light = "key = { point = [-4, -5, 7], intensity = 0.8 }";
    let empty = format!("version = 1\n[picture]\nsize = [48, 27]\n[lights]\n{light}\n");
    let mut window = Window::with_scene(&empty, Vec::new());
    window.menu(&["+ Add solid", "Add torus"]);
    assert_eq!((window.scene().materials.len(), window.solids()), (1, vec!["torus"]));
    assert_eq!(window.undo_name(), Some("add solid torus"));
    window.undo_and_redo_all(1);
    window.assert_live_is_fresh();
    assert!(window.picture().iter().any(|byte| *byte > 40 && *byte < 255), "it is seen");
}

#[test]
fn a_copy_stands_beside_its_original_and_is_selected() {
    let mut window = Window::with_scene(&format!("{SCENE}{PARTS}"), Vec::new());
    window.right_click("ball");
    window.click("Duplicate solid ball");
    assert_eq!(window.undo_name(), Some("add solid ball 2"));
    assert!(window.shows("Solid ball 2"), "the copy is selected");
    assert_eq!(window.solid("ball 2").placement.translate.x, 2.2);
    window.key(Modifiers::COMMAND, Key::D);
    assert_eq!(window.solid("ball 3").placement.translate.x, 4.4);
    window.click("part");
    window.click("Duplicate");
    assert_eq!(window.solid("part 2").shape.operands(), window.solid("part").shape.operands());
    assert_eq!(window.look(), ["solids.ball.material", "solids.block.material"]);
    window.undo_and_redo_all(3);
    window.assert_live_is_fresh();
    let line = "\n\"ball 2\" = { sphere = { center = [0, 0, 0], radius = 1 }, \
                material = \"mirror\", translate = [2.2, 0, 0] }\n";
    assert!(window.scene_text().contains(line), "{}", window.scene_text());
    assert!(
        window.scene_text().contains("# of wood") && window.scene_text().contains("# the part")
    );
}

#[test]
fn a_solid_is_renamed_wherever_it_stands() {
    let mut window = Window::with_scene(&format!("{SCENE}{PARTS}"), Vec::new());
    window.click("block");
    window.key(Modifiers::NONE, Key::F2);
    window.type_name("log", Key::Enter);
    assert_eq!(window.undo_name(), Some("rename solid block → log"));
    assert!(window.shows("Solid log"));
    let line = window.settled("ball");
    window.double_click_at(line);
    window.type_name("globe", Key::Enter);
    assert_eq!(window.look(), ["solids.globe.material", "solids.log.material"]);
    window.key(Modifiers::COMMAND, Key::Z);
    assert!(window.shows("Solid ball"), "what was selected is, by its old name");
    window.key(Modifiers::COMMAND | Modifiers::SHIFT, Key::Z);
    window.undo_and_redo_all(2);
    window.assert_live_is_fresh();
    let text = format!("{SCENE}{PARTS}").replace("block", "log").replace("ball", "globe");
    assert_eq!(window.scene_text(), text);
}

#[test]
fn an_operand_stays_until_the_whole_is_deleted_which_frees_it() {
    let mut window = Window::with_scene(&format!("{SCENE}{PARTS}"), Vec::new());
    window.click("block");
    window.click("Delete");
    window.until_text("solid block is part of part: take it out there first");
    assert!(!window.app().document().is_unsaved());
    window.click("Close");
    window.right_click("part");
    window.click("Delete solid part");
    assert_eq!(window.undo_name(), Some("remove solid part"));
    assert_eq!(window.solids(), ["floor", "ball", "block", "bore"]);
    assert!(window.shows("Solid bore"), "the next one is selected");
    window.until_exact();
    window.click("block");
    window.key(Modifiers::NONE, Key::Delete);
    assert_eq!(window.look(), ["solids.ball.material"]);
    window.undo_and_redo_all(2);
    window.assert_live_is_fresh();
    assert!(!window.scene_text().contains("block"), "{}", window.scene_text());
}

#[test]
fn the_same_solids_are_selected_and_picked_when_others_go_and_come_back() {
    let mut window = Window::with_scene(&format!("{SCENE}{PARTS}"), Vec::new());
    window.menu(&["View", "Mass properties"]);
    window.click("ball");
    window.key(Modifiers::NONE, Key::Delete);
    window.click("part");
    assert!(window.is_picked("part"));
    window.key(Modifiers::COMMAND, Key::Z);
    assert!(window.shows("Solid part") && window.is_picked("part"), "the ball is back before it");
    window.key(Modifiers::COMMAND | Modifiers::SHIFT, Key::Z);
    assert!(window.shows("Solid part") && window.is_picked("part"), "and gone again");
    window.key(Modifiers::COMMAND, Key::Z);
    window.key(Modifiers::COMMAND, Key::D);
    assert!(window.shows("Solid part 2"));
    window.key(Modifiers::COMMAND, Key::Z);
    assert!(
        !window.shows("Solid part") && !window.is_picked("part"),
        "what is gone is not selected"
    );
}

#[test]
fn all_solids_may_be_deleted() {
    let mut window = Window::with_scene(SCENE, Vec::new());
    window.click("floor");
    window.key(Modifiers::NONE, Key::Delete);
    assert!(window.shows("Solid ball"));
    window.key(Modifiers::NONE, Key::Delete);
    assert_eq!(window.solids(), [""; 0]);
    window.key(Modifiers::NONE, Key::Delete);
    window.until_text("Select a light, a material or a solid first");
    window.undo_and_redo_all(2);
    window.assert_live_is_fresh();
    let none = SCENE.split("[solids]").next().unwrap();
    assert!(window.scene_text().starts_with(none), "{}", window.scene_text());
    window.menu(&["+ Add solid", "Add knot"]);
    window.assert_live_is_fresh();
}

#[test]
fn keys_that_can_do_nothing_say_why() {
    let mut window = Window::with_scene(SCENE, Vec::new());
    let keys = [
        (Modifiers::COMMAND, Key::D, "Select a light, a material or a solid first"),
        (Modifiers::COMMAND, Key::Z, "Nothing was changed"),
        (Modifiers::COMMAND | Modifiers::SHIFT, Key::Z, "Nothing was taken back"),
        (Modifiers::NONE, Key::Num0, "The exposure is 0"),
    ];
    for (modifiers, key, why) in keys {
        assert!(!window.shows(why));
        window.key(modifiers, key);
        window.key(modifiers, key);
        let said = window.texts().iter().filter(|text| *text == why).count();
        assert_eq!(said, 1, "{why}");
    }
    assert!(!window.app().document().is_unsaved());
    let before = window.texts().len();
    window.key(Modifiers::NONE, Key::Escape);
    assert!(window.texts().len() <= before && !window.shows("Nothing runs"));
}
