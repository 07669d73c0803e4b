//! Looks on the command line: a look is what setting its values by hand gives, and a sheet shows all.

use super::{SCENE, decode_png, run, succeed};

const LOOKS: &str = "
[looks.night]
lights.key.on = false
materials.mirror.diffuse = 0.1

[looks.dull]
materials.mirror.shininess = 3
materials.tiles.texture.checker.b = [0.1, 0.4, 0.2]

[looks.below]
camera.eye = [0, -6, 3]
";

fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("scene.toml"), format!("{SCENE}{LOOKS}")).unwrap();
    folder
}

#[test]
fn a_look_gives_the_picture_of_its_settings() {
    let folder = folder();
    let picture = |name: &str| decode_png(&folder.path().join(name)).unwrap().2;
    let render = |name: &str, options: &[&str]| {
        let arguments = [&["render", "scene.toml", "-o", name], options].concat();
        succeed(folder.path(), &arguments);
    };
    render("look.png", &["--look", "night"]);
    let set = ["--set", "lights.key.on=false", "--set", "materials.mirror.diffuse=0.1"];
    render("set.png", &set);
    render("plain.png", &["--look", ""]);
    assert!(picture("look.png") == picture("set.png"));
    assert!(picture("look.png") != picture("plain.png"));
    let file = std::fs::read(folder.path().join("look.png")).unwrap();
    let named = b"look = \"night\"";
    assert!(file.windows(named.len()).any(|w| w == named), "the file tells the look");
}

#[test]
fn an_unknown_look_is_refused_with_a_way_out() {
    let folder = folder();
    let ran = run(folder.path(), &["render", "scene.toml", "-o", "a.png", "--look", "nigth"]);
    assert_eq!(ran.code, Some(2));
    let expected = "--look: the scene has no look `nigth`\n  help: did you mean `night`?";
    assert!(ran.messages.contains(expected), "{}", ran.messages);
    assert!(!folder.path().join("a.png").exists());
}

#[test]
fn a_contact_sheet_tells_what_each_look_costs() {
    let folder = folder();
    let arguments = ["render", "scene.toml", "--looks", "sheet.png", "--stats", "-"];
    let ran = succeed(folder.path(), &arguments);
    let stats: serde_json::Value = serde_json::from_str(&ran.results).unwrap();
    let classes: Vec<&str> =
        stats["looks"].as_array().unwrap().iter().map(|l| l["class"].as_str().unwrap()).collect();
    assert_eq!(classes, ["none", "reshade", "refold", "retrace"]);
    assert!(ran.messages.contains("2. night: reshade, 0 rays"), "{}", ran.messages);
    let (size, _, _) = decode_png(&folder.path().join("sheet.png")).unwrap();
    assert_eq!(size, [2 * (16 + 4) + 4, 2 * (9 + 20 + 4) + 4]);
}
