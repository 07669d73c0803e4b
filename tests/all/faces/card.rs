//! The graphics card on the command line: chosen for the window, measured by the bench.

use serde_json::Value;

use super::{folder_with_scene, run, succeed};

#[test]
fn the_bench_measures_a_card_by_its_own_clock() {
    let folder = folder_with_scene();
    let ran = succeed(folder.path(), &["bench", "--gpu", "scene.toml", "--json", "-"]);
    let rows: Value = serde_json::from_str(&ran.results).unwrap();
    let row = &rows[0];
    let number = |path: &str| {
        let value = row.pointer(path).and_then(Value::as_f64);
        value.unwrap_or_else(|| panic!("{path} of {row:#}"))
    };
    for time in ["matrix_upload", "dispatch", "edit_call", "processor"] {
        assert!(number(&format!("/{time}_ms/median")) > 0.0, "{time}");
    }
    // So few bytes may take no time that the card can tell.
    assert!(number("/values_upload_ms/median") >= 0.0);
    assert_eq!((number("/size/0"), number("/size/1")), (48.0, 27.0));
    assert_eq!(number("/bindings"), 1.0);
    assert!(number("/terms") > 1.0 && number("/transport_bytes") > 48.0 * 27.0);
    assert!(number("/differing_share") <= 1e-3 && number("/largest_difference") <= 1.0);
    assert!(!row["device"].as_str().unwrap().is_empty());
    assert!(ran.messages.contains("scene on "), "{}", ran.messages);
}

#[test]
fn only_renderers_that_there_are_are_taken() {
    let folder = folder_with_scene();
    let ran = run(folder.path(), &["--renderer", "metal", "scene.toml"]);
    assert_eq!(ran.code, Some(2), "{}", ran.messages);
    assert!(ran.messages.contains("[possible values: gpu, cpu, glow]"), "{}", ran.messages);
    let ran = run(folder.path(), &["bench", "--gpu", "--rays", "scene.toml"]);
    assert_eq!(ran.code, Some(2), "{}", ran.messages);
}
