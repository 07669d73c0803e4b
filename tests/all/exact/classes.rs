//! Every parameter of a scene of all kinds costs what the table says, and gives the exact picture.

use std::path::Path;

use rayforest::color::Rgb;
use rayforest::progress::Progress;
use rayforest::scene::path::{Parameter, parameters};
use rayforest::scene::{Lens, Light, Material, Paint, Scene, read};
use rayforest::session::{Class, Session};

use super::comes_alive::comes_alive;
use super::table::{GLOSSY, LAMPS, LENS, MODELS, OPEN, ROWS, Row, SCENE, SOLIDS};
use super::{assert_same_picture, open, set};

fn all_kinds() -> Scene {
    read::text(SCENE, Path::new("all-kinds.toml")).unwrap_or_else(|e| panic!("{e}"))
}

/// Lights of the other kinds, and blurred rays.
fn lamps() -> Scene {
    read::text(LAMPS, Path::new("lamps.toml")).unwrap_or_else(|e| panic!("{e}"))
}

/// The same with solids of the other kinds.
pub(super) fn solids() -> Scene {
    let text = format!("{SCENE}{SOLIDS}");
    read::text(&text, Path::new("solids.toml")).unwrap_or_else(|e| panic!("{e}"))
}

/// The same from infinitely far away.
fn parallel() -> Scene {
    let mut scene = all_kinds();
    scene.camera.lens = Lens::Parallel { height: 4.5 };
    // No ray begins below the floor.
    scene.camera.eye.z = 4.5;
    scene
}

/// The same with other illumination models.
fn glossy() -> Scene {
    let mut scene = all_kinds();
    for (path, value) in MODELS {
        set(&mut scene, path, value);
    }
    scene
}

fn matches(pattern: &str, path: &str) -> bool {
    let (pattern, path): (Vec<_>, Vec<_>) =
        (pattern.split('.').collect(), path.split('.').collect());
    pattern.len() == path.len() && pattern.iter().zip(&path).all(|(p, s)| *p == "*" || p == s)
}

pub(super) fn row_of<'a>(rows: &'a [Row], path: &str) -> Result<&'a Row, String> {
    rows.iter().find(|row| matches(row.path, path)).ok_or(format!("`{path}` has no row"))
}

/// Makes one edit and holds it to its class, its rays, and the exact picture.
pub(super) fn edit_is(session: &mut Session, scene: Scene, expected: Class, what: &str) {
    let expected = if scene == *session.scene() { Class::None } else { expected };
    let kept = session.forest().clone();
    assert_eq!(session.class_of(&scene), expected, "{what}: class beforehand");
    let report = session.edit(scene, &Progress::default()).unwrap();
    assert_eq!(report.class, expected, "{what}: {:?}", report.reason);
    let fresh = open(session.scene(), 2);
    assert_same_picture(session, &fresh, what);
    if expected == Class::Retrace {
        assert_eq!(report.rays, fresh.trace_report().rays, "{what}: rays");
        assert_eq!(report.pixels, session.transport().layout.pixels(), "{what}: pixels");
        assert!(session.forest() == fresh.forest(), "{what}: the trees are not the fresh ones");
        assert!(
            session.transport() == fresh.transport(),
            "{what}: the matrix is not the fresh one"
        );
        if report.reason.is_some_and(|reason| reason.contains("comes alive")) {
            assert!(
                comes_alive(&kept, fresh.forest(), session.scene()),
                "{what}: traced for nothing"
            );
        }
    } else if report.pixels > 0 {
        let rays = report.rays;
        assert_eq!(rays.camera, 0, "{what}: the kept trees know where eye rays end");
        assert!(report.class == Class::Regrow || rays.total() == 0, "{what}: {rays:?}");
        assert!(rays.total() < fresh.trace_report().rays.total(), "{what}: {rays:?}");
        if report.reason.is_some_and(|reason| reason.contains("comes alive")) {
            assert!(comes_alive(&kept, fresh.forest(), session.scene()), "{what}: for nothing");
        }
    } else {
        assert_eq!(report.rays.total(), 0, "{what}: rays without pixels");
        assert!(*session.forest() == kept, "{what}: trees were touched");
        assert!(
            !comes_alive(&kept, fresh.forest(), session.scene()),
            "{what}: trees lack a branch"
        );
    }
    session.transport().validate();
}

/// Takes every parameter of a scene through the steps of its row.
fn hold_to_table(scene: &Scene) {
    let first = open(scene, 2);
    // Its aperture is refused.
    let parallel = matches!(scene.camera.lens, Lens::Parallel { .. });
    for parameter in parameters(scene) {
        if parallel && parameter.path == "camera.aperture" {
            continue;
        }
        let row = row_of(ROWS, &parameter.path).unwrap_or_else(|e| panic!("{e}"));
        take_steps(&first, &parameter, row);
    }
}

/// Takes one parameter through the steps of its row, from `first` on.
pub(super) fn take_steps(first: &Session, parameter: &Parameter, row: &Row) {
    let mut session = open(first.scene(), 2);
    for (step, (value, class)) in row.steps.iter().enumerate() {
        let original = *value == "@";
        let value = if original { parameter.value.as_str() } else { value };
        let what = format!("{} = {value} (step {step})", parameter.path);
        let mut edited = session.scene().clone();
        set(&mut edited, &parameter.path, value);
        edit_is(&mut session, edited, *class, &what);
        if original {
            assert_same_picture(&session, first, &format!("{what}, the first picture"));
        }
    }
}

#[test]
fn models_decide_what_their_parameters_cost() {
    let first = open(&glossy(), 2);
    let all = parameters(first.scene());
    for row in GLOSSY {
        let parameter = all.iter().find(|p| p.path == row.path).expect("a parameter of the row");
        take_steps(&first, parameter, row);
    }
}

#[test]
fn lens_shutter_and_filter_cost_a_trace_and_all_else_what_it_costs_without_them() {
    let mut scene = all_kinds();
    for (path, value) in OPEN {
        set(&mut scene, path, value);
    }
    let first = open(&scene, 2);
    let all = parameters(first.scene());
    for row in LENS {
        let parameter = all.iter().find(|p| p.path == row.path).expect("a parameter of the row");
        take_steps(&first, parameter, row);
    }
}

#[test]
fn every_parameter_costs_what_the_table_says() {
    hold_to_table(&all_kinds());
}

#[test]
fn from_infinitely_far_away_too() {
    hold_to_table(&parallel());
}

/// Of lights of all kinds, and of materials whose rays are blurred.
#[test]
fn lights_and_lobes_cost_what_the_table_says() {
    let first = open(&lamps(), 2);
    for parameter in parameters(&lamps()) {
        if parameter.path.starts_with("lights.") {
            take_steps(&first, &parameter, row_of(ROWS, &parameter.path).unwrap());
        }
    }
}

#[test]
fn solids_of_the_other_kinds_cost_what_the_table_says() {
    let first = open(&solids(), 2);
    let known = parameters(&all_kinds());
    let instant =
        ["materials.brass.diffuse", "materials.glass.filter", "materials.mirror.specular"];
    for parameter in parameters(&solids()) {
        let new = known.iter().all(|known| known.path != parameter.path);
        let shape = parameter.path.split('.').count() == 4;
        if instant.contains(&parameter.path.as_str()) || (new && shape) {
            take_steps(&first, &parameter, row_of(ROWS, &parameter.path).unwrap());
        }
    }
}

/// While nothing is mirrored a lobe costs nothing; it is made up for when something is.
#[test]
fn a_lobe_that_did_not_matter() {
    let mut session = open(&all_kinds(), 2);
    let mut scene = all_kinds();
    let mut edit = |path: &str, value: &str, class: Class| {
        set(&mut scene, path, value);
        edit_is(&mut session, scene.clone(), class, &format!("{path} = {value}"));
    };
    edit("materials.mirror.reflect", "0", Class::Reshade);
    edit("materials.mirror.gloss", "30", Class::None);
    edit("materials.mirror.reflect", "0.3", Class::Regrow);
    edit("materials.mirror.reflect", "0", Class::Reshade);
    edit("materials.mirror.gloss", "9", Class::None);
    edit("lights.key.point", "[-4, -5, 7.5]", Class::Regrow);
    edit("materials.mirror.gloss", "30", Class::None);
    edit("materials.mirror.reflect", "0.5", Class::Regrow);
    edit("materials.glass.translucency", "50", Class::Regrow);
    edit("materials.glass.transmit", "0", Class::Reshade);
    edit("materials.glass.translucency", "0", Class::None);
    edit("materials.tiles.reflect", "0.3", Class::Regrow);
    edit("materials.tiles.gloss", "12", Class::Regrow);
    edit("materials.glass.transmit", "0.7", Class::Regrow);
    edit("solids.cube.material", "mirror", Class::Regrow);
}

#[test]
fn every_row_is_the_row_of_a_parameter() {
    let mut paths: Vec<String> = parameters(&all_kinds()).into_iter().map(|p| p.path).collect();
    paths.extend(parameters(&parallel()).into_iter().map(|p| p.path));
    paths.extend(parameters(&lamps()).into_iter().map(|p| p.path));
    paths.extend(parameters(&solids()).into_iter().map(|p| p.path));
    for row in ROWS {
        let used = paths.iter().any(|p| row_of(ROWS, p).is_ok_and(|r| r.path == row.path));
        assert!(used, "row `{}` is for nothing", row.path);
    }
}

#[test]
fn a_parameter_without_a_row_is_found() {
    let without: Vec<Row> = ROWS
        .iter()
        .filter(|row| row.path != "materials.*.kloc")
        .map(|row| Row { path: row.path, steps: row.steps })
        .collect();
    let lacking: Vec<String> = parameters(&all_kinds())
        .iter()
        .filter_map(|parameter| row_of(&without, &parameter.path).err())
        .collect();
    assert_eq!(lacking.len(), 6, "{lacking:?}");
    assert_eq!(lacking[0], "`materials.tiles.kloc` has no row");
}

#[test]
#[should_panic(expected = "class beforehand")]
fn an_edit_of_another_class_than_expected_is_found() {
    let mut session = open(&all_kinds(), 1);
    let mut edited = session.scene().clone();
    set(&mut edited, "materials.plain.shininess", "3");
    edit_is(&mut session, edited, Class::Reshade, "on purpose");
}

#[test]
fn names_cost_nothing() {
    let mut session = open(&all_kinds(), 2);
    let before = session.frame().clone();
    let mut renamed = session.scene().clone();
    renamed.lights.iter_mut().for_each(|light| light.name.push_str(" light"));
    renamed.materials.iter_mut().rev().enumerate().for_each(|(i, m)| m.name = format!("m{i}"));
    renamed.solids.iter_mut().for_each(|solid| solid.name.insert(0, 'a'));
    edit_is(&mut session, renamed.clone(), Class::None, "names");
    assert!(*session.scene() == renamed && *session.frame() == before);
}

#[test]
fn what_is_added_removed_or_exchanged() {
    use Class::{Refold, Regrow, Reshade, Retrace};
    let scene = all_kinds();
    type Alteration = fn(&mut Scene);
    let changes: [(&str, Alteration, Class, Class); 13] = [
        ("a light more", |s| s.lights.push(Light::new("third")), Regrow, Reshade),
        ("a light more, the first", |s| s.lights.insert(0, Light::new("zero")), Regrow, Reshade),
        ("a light more, in between", |s| s.lights.insert(1, Light::new("mid")), Regrow, Reshade),
        ("a light less", |s| drop(s.lights.pop()), Reshade, Regrow),
        ("the first light less", |s| drop(s.lights.remove(0)), Reshade, Regrow),
        ("no light", |s| s.lights.clear(), Reshade, Regrow),
        ("lights exchanged", |s| s.lights.swap(0, 1), Regrow, Regrow),
        ("a material more", |s| s.materials.push(Material::new("new")), Class::None, Class::None),
        ("a solid less", |s| drop(s.solids.remove(1)), Retrace, Retrace),
        ("another order of solids", |s| s.solids.swap(0, 3), Retrace, Retrace),
        (
            "a point becomes a direction",
            |s| s.lights[0].place = s.lights[1].place.clone(),
            Regrow,
            Regrow,
        ),
        (
            "another kind of texture",
            |s| s.materials[0].paint = Paint::Solid(Rgb::grey(0.4)),
            Refold,
            Refold,
        ),
        ("a parallel view", |s| s.camera.lens = Lens::Parallel { height: 4.5 }, Retrace, Retrace),
    ];
    let mut session = open(&scene, 2);
    for (what, change, there, back) in changes {
        let mut edited = scene.clone();
        change(&mut edited);
        edit_is(&mut session, edited, there, what);
        edit_is(&mut session, scene.clone(), back, &format!("{what}, undone"));
    }
}

/// A light that is gone leaves a gap in the list of factors; what comes after finds its place.
#[test]
fn lights_come_and_go() {
    let mut session = open(&all_kinds(), 2);
    let mut scene = all_kinds();
    let third = Light { intensity: Rgb([0.1, 0.4, 0.2]), ..Light::new("third") };
    scene.lights.insert(1, third);
    edit_is(&mut session, scene.clone(), Class::Regrow, "three lights");
    scene.lights.remove(0);
    edit_is(&mut session, scene.clone(), Class::Reshade, "two of three");
    set(&mut scene, "lights.sun.intensity", "0.9");
    edit_is(&mut session, scene.clone(), Class::Reshade, "brighter");
    set(&mut scene, "materials.tiles.reflect", "0.4");
    edit_is(&mut session, scene.clone(), Class::Regrow, "a mirror below them");
    set(&mut scene, "lights.third.point", "[0, -3, 4]");
    edit_is(&mut session, scene.clone(), Class::Regrow, "moved");
    scene.lights.swap(0, 1);
    scene.lights.push(Light::new("fourth"));
    edit_is(&mut session, scene.clone(), Class::Regrow, "another order, and one more");
    scene.lights.remove(1);
    set(&mut scene, "materials.glass.ior", "1.3");
    edit_is(&mut session, scene.clone(), Class::Regrow, "one less, and another glass");
    scene.lights.clear();
    edit_is(&mut session, scene, Class::Reshade, "in the dark");
}

/// Materials that no solid has come and go without work, and others keep their surfaces.
#[test]
fn materials_come_and_go() {
    let mut session = open(&all_kinds(), 2);
    let mut scene = all_kinds();
    scene.materials.insert(1, Material::new("unused"));
    scene.solids.iter_mut().filter(|s| s.material >= 1).for_each(|s| s.material += 1);
    edit_is(&mut session, scene.clone(), Class::None, "one in between");
    set(&mut scene, "materials.glass.shininess", "9");
    edit_is(&mut session, scene.clone(), Class::Refold, "a refold under another index");
    set(&mut scene, "materials.plain.reflect", "0.3");
    edit_is(&mut session, scene.clone(), Class::Regrow, "a branch under another index");
    scene.materials.swap_remove(1);
    assert_eq!(scene.materials[1].name, "brass");
    for solid in &mut scene.solids {
        solid.material = match solid.material {
            0 => 0,
            6 => 1,
            other => other,
        };
    }
    edit_is(&mut session, scene.clone(), Class::Refold, "another order");
    set(&mut scene, "solids.cube.material", "brass");
    edit_is(&mut session, scene.clone(), Class::Regrow, "another material");
    let plain = scene.materials.iter().position(|m| m.name == "plain").unwrap();
    scene.materials.remove(plain);
    scene.solids.iter_mut().filter(|s| s.material > plain).for_each(|s| s.material -= 1);
    edit_is(&mut session, scene.clone(), Class::None, "one that no solid has any more");
    let mirror = scene.materials.iter().position(|m| m.name == "mirror").unwrap();
    scene.materials.remove(mirror);
    for solid in &mut scene.solids {
        solid.material = match solid.material {
            m if m == mirror => 0,
            m if m > mirror => m - 1,
            m => m,
        };
    }
    edit_is(&mut session, scene, Class::Regrow, "one that some solids had");
}

/// While nothing passes through a material its index of refraction costs nothing; it is made up for
/// when something does.
#[test]
fn an_index_of_refraction_that_did_not_matter() {
    let mut session = open(&all_kinds(), 2);
    let mut scene = all_kinds();
    let mut edit = |path: &str, value: &str, class: Class| {
        set(&mut scene, path, value);
        edit_is(&mut session, scene.clone(), class, &format!("{path} = {value}"));
    };
    edit("materials.glass.transmit", "0", Class::Reshade);
    edit("materials.glass.ior", "1.7", Class::None);
    edit("materials.tiles.reflect", "0.3", Class::Regrow);
    edit("materials.glass.ior", "1.5", Class::None);
    edit("materials.glass.transmit", "0.001", Class::Regrow);
    edit("materials.glass.transmit", "0.7", Class::Regrow);
    edit("materials.brass.ior", "1.7", Class::None);
    // Thinner than the glass, it reflects totally within it, and thinner than the air everywhere.
    edit("materials.brass.ior", "1.4", Class::Refold);
    edit("materials.brass.ior", "0.7", Class::Refold);
    edit("materials.glass.ior", "1.3", Class::Regrow);
}

#[test]
fn several_parameters_at_once_cost_what_the_dearest_costs() {
    let mut session = open(&all_kinds(), 2);
    let mut edited = session.scene().clone();
    set(&mut edited, "materials.plain.diffuse", "0.1");
    set(&mut edited, "picture.exposure", "-1");
    edit_is(&mut session, edited.clone(), Class::Reshade, "two");
    set(&mut edited, "materials.mirror.shininess", "5");
    set(&mut edited, "materials.glass.shininess", "5");
    set(&mut edited, "materials.mirror.reflect", "0.1");
    edit_is(&mut session, edited.clone(), Class::Refold, "three");
    set(&mut edited, "materials.mirror.shininess", "50");
    set(&mut edited, "materials.tiles.reflect", "0.5");
    edit_is(&mut session, edited.clone(), Class::Regrow, "two with a branch");
    set(&mut edited, "lights.key.on", "false");
    set(&mut edited, "camera.fov_degrees", "41");
    edit_is(&mut session, edited, Class::Retrace, "two with the camera");
}

/// A light behind Hall's glass, seen through another glass: its highlight is 0 for a high exponent,
/// and still names what the light came through.
#[test]
fn a_highlight_from_behind_that_is_flushed_is_not_forgotten() {
    let mut scene = all_kinds();
    for (path, value) in [
        ("materials.glass.model", "hall"),
        ("materials.glass.shininess", "1e6"),
        ("materials.brass.transmit", "0.5"),
        ("materials.lamp.transmit", "0.25"),
        ("lights.key.point", "[3, 6, 4]"),
    ] {
        set(&mut scene, path, value);
    }
    let mut session = open(&scene, 2);
    set(&mut scene, "solids.ring.material", "lamp");
    edit_is(&mut session, scene.clone(), Class::Regrow, "another glass before the light");
    set(&mut scene, "materials.glass.shininess", "1");
    edit_is(&mut session, scene.clone(), Class::Refold, "a highlight that was flushed");
    set(&mut scene, "materials.lamp.filter", "[1, 0.2, 0.1]");
    edit_is(&mut session, scene, Class::Reshade, "the colour that it passes through");
}

/// A file saved after a material was deleted and a branch came alive is opened by one edit.
#[test]
fn a_material_that_goes_as_a_branch_comes_alive() {
    let mut scene = all_kinds();
    scene.materials.insert(0, Material::new("spare"));
    scene.solids.iter_mut().for_each(|solid| solid.material += 1);
    let mut session = open(&scene, 2);
    let mut edited = all_kinds();
    set(&mut edited, "materials.brass.reflect", "0.9");
    edit_is(&mut session, edited, Class::Regrow, "both at once");
}
