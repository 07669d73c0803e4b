//! Solids made of others: their operands are added, removed and moved, and their operation is changed.

use rayforest::scene::Shape;
use rayforest::scene::csg::Operation;

use super::*;
use crate::faces::SCENE;

/// Below the small scene: a block, what is cut out of it, what is made of both, and a polygon.
const PARTS: &str = r#"
block = { box = { min = [-1.4, -1.4, -0.9], max = [0.2, 0.2, 0.4] }, material = "mirror" }
bore = { cylinder = { from = [-0.6, -3, -0.3], to = [-0.6, 3, -0.3], radius = 0.4 }, material = "tiles" }
pane = { polygon = { points = [[0, 5, 0], [1, 5, 0], [0, 5, 1]] }, material = "tiles" }
part = { difference = ["block", "bore"] } # the part
whole = { union = ["part"] } # all
"#;

impl Window {
    fn with_parts() -> Window {
        Window::with_scene(&format!("{SCENE}{PARTS}"), Vec::new())
    }

    /// The operation of a solid, and the names of its operands.
    fn made_of(&self, name: &str) -> (Operation, Vec<String>) {
        let scene = self.app().document().scene();
        let solid = scene.solids.iter().find(|solid| solid.name == name).unwrap();
        let Shape::Csg { operation, operands } = &solid.shape else { panic!("{solid:?}") };
        (*operation, operands.iter().map(|i| scene.solids[*i].name.clone()).collect())
    }

    fn is_disabled(&self, name: &str) -> bool {
        self.harness.get_by_label(name).accesskit_node().is_disabled()
    }
}

#[test]
fn operands_are_added_moved_and_removed_each_as_a_step() {
    let mut window = Window::with_parts();
    window.click("part");
    assert!(window.shows("Its operands keep their materials"));
    let before = window.picture();
    window.click("Add operand");
    window.click("add ball");
    assert_eq!(window.made_of("part").1, ["block", "bore", "ball"]);
    assert_eq!(window.undo_name(), Some("difference of part"));
    window.until_exact();
    assert!(
        window.picture() != before,
        "the ball is no more, and takes a piece of the block along"
    );
    window.click("move operand 3 up");
    assert_eq!(window.made_of("part").1, ["block", "ball", "bore"]);
    window.click("move operand 1 down");
    assert_eq!(window.made_of("part").1, ["ball", "block", "bore"]);
    window.click("remove operand 2");
    assert_eq!(window.made_of("part").1, ["ball", "bore"]);
    window.until_exact();
    window.undo_and_redo_all(4);
    window.assert_live_is_fresh();
    let line = "\npart = { difference = [\"ball\", \"bore\"] } # the part\n";
    assert!(window.scene_text().contains(line), "{}", window.scene_text());
}

#[test]
fn another_operation_keeps_the_operands() {
    let mut window = Window::with_parts();
    window.click("part");
    for (operation, key) in [(Operation::Merge, "merge"), (Operation::Intersection, "intersection")]
    {
        window.click("kind of operation");
        window.click(key);
        assert_eq!(window.made_of("part"), (operation, vec!["block".into(), "bore".into()]));
        assert_eq!(window.undo_name(), Some(format!("{key} of part").as_str()));
        window.until_exact();
    }
    window.undo_and_redo_all(2);
    window.assert_live_is_fresh();
    let line = "\npart = { intersection = [\"block\", \"bore\"] } # the part\n";
    assert!(window.scene_text().contains(line), "{}", window.scene_text());
}

#[test]
fn what_cannot_be_an_operand_says_why_in_the_list() {
    let mut window = Window::with_parts();
    window.click("part");
    assert!(window.is_disabled("move operand 1 up") && window.is_disabled("move operand 2 down"));
    assert!(!window.is_disabled("move operand 2 up") && !window.is_disabled("remove operand 1"));
    window.click("Add operand");
    assert!(window.button("add part").is_none(), "it is no operand of itself");
    for (name, why) in [("add pane", "has no inside to be an operand"), ("add whole", "is made of")]
    {
        assert!(window.is_disabled(name), "{name}");
        let at = window.settled(name);
        window.harness.hover_at(at + vec2(1.0, 0.0));
        window.harness.hover_at(at);
        window.until_text(why);
    }
    assert!(!window.is_disabled("add ball"));
    let at = window.settled("add pane");
    window.click_at(at, Modifiers::NONE);
    assert_eq!((window.made_of("part").1.len(), window.undo_name()), (2, None));
}

#[test]
fn the_last_operand_stays_and_leads_to_itself() {
    let mut window = Window::with_parts();
    window.click("whole");
    assert!(window.is_disabled("remove operand 1"));
    window.click("1. part");
    assert!(window.shows("Solid part") && window.shows("Part of whole"));
    window.click("2. bore");
    assert!(window.shows("Material tiles") && window.shows("Part of part"));
}
