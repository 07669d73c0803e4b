//! Edits in the window: exact, instant where the badge says so, and taken back whole.

use rayforest::color::Rgb;
use rayforest::scene::Paint;
use rayforest::scene::model::Model;

use super::*;
use crate::faces::SCENE;

#[test]
fn a_dragged_slider_changes_the_picture_without_a_ray() {
    let mut window = Window::with_scene(SCENE, Vec::new());
    let before = window.picture();
    window.click("mirror");
    window.drag_slider("diffuse", 0.9);
    window.until_exact();
    let after = window.picture();
    assert_ne!(before, after);
    window.until_text("· 0 rays");
    let undo = window.undo_name().expect("a step").to_owned();
    assert!(undo.starts_with("diffuse of mirror 0.30 → "), "{undo}");

    window.click("Undo");
    window.until_exact();
    assert!(window.picture() == before, "undo gives back the same bytes");
    window.click("Redo");
    window.until_exact();
    assert!(window.picture() == after, "redo too");
}

#[test]
fn a_gesture_is_one_step_and_the_unsaved_mark_goes_and_comes() {
    let mut window = Window::with_scene(SCENE, Vec::new());
    let scene = window.app().document().scene().clone();
    assert!(!window.shows("scene.toml •"));
    window.click("mirror");
    window.drag_slider("diffuse", 0.9);
    assert!(window.app().document().is_unsaved() && window.shows("scene.toml •"));
    window.click("Undo");
    assert!(*window.app().document().scene() == scene, "one undo takes the whole drag back");
    assert_eq!(window.undo_name(), None);
    assert!(!window.shows("scene.toml •"));

    window.click("Redo");
    window.save();
    assert!(!window.shows("scene.toml •"));
    window.click("Undo");
    assert!(*window.app().document().scene() == scene, "undo reaches across a save");
    assert!(window.app().document().is_unsaved() && window.shows("scene.toml •"));
    window.click("Redo");
    assert!(!window.app().document().is_unsaved());
}

#[test]
fn what_many_edits_lead_to_is_what_a_fresh_render_of_the_saved_file_gives() {
    let mut window = Window::with_scene(SCENE, Vec::new());
    window.click("mirror");
    window.drag_slider("reflect", 0.95);
    window.drag_slider("shininess", 0.3);
    window.drag_slider("diffuse", 0.1);
    window.click("tiles");
    window.type_into("a red", "0.25");
    window.click("fill");
    window.drag_slider("intensity red", 0.8);
    window.click("Scene");
    window.type_into("exposure value", "0.5");
    window.click("Undo");
    window.click("Undo");
    window.click("Redo");
    window.until_exact();
    window.save();
    assert!(rgb(&window.picture()) == rendered(window.folder.path(), "scene.toml"));
}

#[test]
fn a_typed_value_may_leave_the_slider_but_not_the_range() {
    let mut window = Window::with_scene(SCENE, Vec::new());
    let mirror = |window: &Window| window.app().document().scene().materials[1].clone();
    window.click("mirror");
    window.type_into("diffuse value", "7.5");
    assert_eq!(mirror(&window).diffuse.0, [7.5; 3]);
    window.type_into("diffuse value", "-2");
    assert_eq!(mirror(&window).diffuse.0, [0.0; 3]);
    window.type_into("shininess value", "1e30");
    let range = rayforest::scene::path::parameters(window.app().document().scene())
        .into_iter()
        .find_map(|p| (p.path == "materials.mirror.shininess").then_some(p.range?));
    assert_eq!(f64::from(mirror(&window).shininess), range.expect("a range").high);
    window.type_into("color red", "0.5");
    assert_eq!(mirror(&window).paint, Paint::Solid(Rgb([0.5, 0.9, 0.95])));

    let before = mirror(&window);
    for text in ["many", "", "nan", "1,5", "--3"] {
        for field in ["diffuse value", "color green", "shininess value"] {
            window.type_into(field, text);
            assert!(mirror(&window) == before, "`{text}` in {field}");
        }
    }
    window.click("Scene");
    for (text, width) in [("nan", 48), ("60", 60), ("0", 1)] {
        window.type_into("size width", text);
        assert_eq!(window.app().document().scene().picture.size, [width, 27], "{text}");
    }
}

#[test]
fn a_changed_value_is_marked_and_taken_back_by_its_name() {
    let mut window = Window::with_scene(SCENE, Vec::new());
    let scene = window.app().document().scene().clone();
    window.click("mirror");
    assert!(window.button("reset diffuse").is_none());
    window.drag_slider("diffuse", 0.9);
    assert!(window.button("reset diffuse").is_some());
    let name = window.rect(Role::Label, "diffuse").center();
    window.click_at(name, Modifiers::NONE);
    assert!(window.app().document().is_unsaved(), "one click does nothing");
    window.double_click_at(name);
    assert!(*window.app().document().scene() == scene);
    assert!(window.button("reset diffuse").is_none());
    assert!(window.undo_name().expect("a step").starts_with("diffuse of mirror"));

    window.drag_slider("reflect", 0.9);
    window.click("reset reflect");
    assert!(*window.app().document().scene() == scene, "the mark does the same");
}

#[test]
fn a_coefficient_unfolds_into_its_channels_and_back() {
    let mut window = Window::with_scene(SCENE, Vec::new());
    let diffuse = |window: &Window| window.app().document().scene().materials[1].diffuse.0;
    window.click("mirror");
    window.click("channels of diffuse");
    window.type_into("diffuse green value", "0.9");
    assert_eq!(diffuse(&window), [0.3, 0.9, 0.3]);
    window.drag_slider("diffuse blue", 0.75);
    let [red, green, blue] = diffuse(&window);
    assert!((red, green) == (0.3, 0.9) && (0.6..0.9).contains(&blue), "{blue}");
    window.click("one value for diffuse");
    let [red, green, blue] = diffuse(&window);
    assert!(red == green && green == blue && (0.6..0.7).contains(&red), "{red}");
    window.click("channels of diffuse");
    assert!(window.harness.query_by_role_and_label(Role::Slider, "diffuse green").is_none());
}

#[test]
fn an_illumination_model_is_chosen_from_a_list() {
    let mut window = Window::with_scene(SCENE, Vec::new());
    let mirror = |window: &Window| window.app().document().scene().materials[1].clone();
    window.click("mirror");
    assert_eq!(mirror(&window).model, Model::Phong);
    window.click("model");
    window.click("cook_torrance");
    assert_eq!(mirror(&window).model, Model::CookTorrance);
    window.until_exact();
    window.save();
    assert!(rgb(&window.picture()) == rendered(window.folder.path(), "scene.toml"));
    window.click("Undo");
    assert_eq!(mirror(&window).model, Model::Phong);
}
