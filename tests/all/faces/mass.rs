//! `rayforest mass`: figures with their errors, as text and as JSON.

use serde_json::Value;

use super::{folder_with_scene, run, succeed};

/// 4π/3
const BALL: f64 = 4.188_790_204_786_391;

#[test]
fn a_ball_weighs_what_the_formula_says() {
    let folder = folder_with_scene();
    let arguments = ["mass", "scene.toml", "ball", "--error", "1e-3", "--density", "2", "--json"];
    let ran = succeed(folder.path(), &arguments);
    let rows: Value = serde_json::from_str(&ran.results).unwrap();
    let ball = &rows[0];
    assert_eq!(ball["solid"], "ball");
    let number = |pointer: &str| ball.pointer(pointer).and_then(Value::as_f64).expect(pointer);
    assert!((number("/exact/volume/value") - BALL).abs() < 1e-12);
    let (volume, error) = (number("/volume/value"), number("/volume/error"));
    assert!(error <= 1e-3 * volume && (volume - BALL).abs() <= error, "{volume} ± {error}");
    assert_eq!(number("/mass/value"), 2.0 * volume);
    // 2/5 M r²
    assert!((number("/principal/2/value") - 0.8 * BALL).abs() <= number("/principal/2/error"));
    let steps = ball["steps"].as_array().unwrap();
    let rays: Vec<u64> = steps.iter().map(|step| step["rays"].as_u64().unwrap()).collect();
    assert!(rays.len() > 1 && rays.is_sorted_by(|a, b| a < b), "{rays:?}");
    assert_eq!(ball["rays"].as_u64(), Some(rays.iter().sum()));
    assert_eq!(ball["made_of"][0]["material"], "mirror");
    assert_eq!(number("/made_of/0/density"), 2.0);
    // Of the material, where none is given.
    let dense = ["mass", "scene.toml", "ball", "--rays", "3000", "--set"];
    let ran = succeed(folder.path(), &[&dense[..], &["materials.mirror.density=2.5"]].concat());
    assert!(ran.results.contains("density           2.5 (mirror)"), "{}", ran.results);
    assert!(ran.results.contains("mass              10.4"), "{}", ran.results);
    // A bigger ball by an edit, and fewer rays.
    let arguments =
        ["mass", "scene.toml", "ball", "--set", "solids.ball.scale=2", "--rays", "3000"];
    let ran = succeed(folder.path(), &arguments);
    assert!(ran.results.contains("by formula        volume 33.510321638"), "{}", ran.results);
}

#[test]
fn what_has_no_mass_is_said() {
    let folder = folder_with_scene();
    let ran = succeed(folder.path(), &["mass", "scene.toml", "--rays", "3000"]);
    assert!(ran.messages.contains("floor: it has no end"), "{}", ran.messages);
    assert!(ran.results.starts_with("ball: "), "{}", ran.results);
    for (arguments, words) in [
        (&["floor"] as &[&str], "solid floor: it has no end"),
        (&["bal"], "did you mean `ball`?"),
        (&["ball", "--error", "2"], "`2` is not a share above 0 and below 1"),
        (&["ball", "--rays", "9", "--json"], "9 is not in 96"),
        (&["ball", "--density", "0"], "`0` is not a density above 0"),
    ] {
        let ran = run(folder.path(), &[&["mass", "scene.toml"], arguments].concat());
        assert_eq!((ran.code, ran.results.as_str()), (Some(2), ""), "{arguments:?}");
        assert!(ran.messages.contains(words), "{arguments:?}: {}", ran.messages);
    }
}

#[test]
fn an_open_mesh_names_an_edge() {
    let folder = tempfile::tempdir().unwrap();
    let text = "version = 1\n[materials.m]\n[solids.sheet]\nmesh = { file = \"m.obj\" }\nmaterial = \"m\"\n";
    std::fs::write(folder.path().join("scene.toml"), text).unwrap();
    std::fs::write(folder.path().join("m.obj"), "v 0 0 0\nv 2 0 0\nv 0 3 0\nf 1 2 3\n").unwrap();
    let ran = run(folder.path(), &["mass", "scene.toml", "sheet"]);
    assert_eq!(ran.code, Some(2));
    let edge = "see its edge from [0, 0, 0] to [2, 0, 0]";
    assert!(ran.messages.contains(edge), "{}", ran.messages);
}
