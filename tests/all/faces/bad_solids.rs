//! Solids that cannot be, meshes and images that are cut or lie about their size: each is refused with
//! its place and a way out, and costs neither memory nor the scene.

use std::path::Path;
use std::process::Command;

use super::bad_input::{assert_says, mistake_beside, refused};
use super::{SCENE, decode_png, folder_with_scene};

/// What is replaced in the small scene; it stands in line 24, from column 8 on.
const BALL: &str = "sphere = { center = [0, 0, 0], radius = 1 }";

/// A pattern in the small scene; it stands in line 14.
const CHECKER: &str = "checker = { a = [0.9, 0.8, 0.2], b = 0.2, size = 0.7 }";

#[test]
fn solids_without_a_size_or_inside_out_are_refused_in_their_place() {
    for (shape, says) in [
        ("sphere = { center = [0, 0, 0], radius = 0 }", "`radius` is 0"),
        ("sphere = { center = [0, 0, 0], radius = -1 }", "`radius` is -1"),
        ("box = { min = [0, 0, 0], max = [1, 1, 0] }", "on z they are 0 and 0"),
        ("box = { min = [0, 0, 0], max = [1, -1, 1] }", "on y they are -1 and 0"),
        ("cylinder = { from = [1, 1, 1], to = [1, 1, 1], radius = 1 }", "no length"),
        ("cylinder = { from = [0, 0, 0], to = [0, 0, 1], radius = 0 }", "`radius` is 0"),
        ("cone = { from = [1, 1, 1], to = [1, 1, 1], radius = 1 }", "no length"),
        ("cone = { from = [0, 0, 0], to = [0, 0, 1], radius = 1, tip = -1 }", "`tip` is -1"),
        ("torus = { major = 0, minor = 1 }", "`major` is 0"),
        ("torus = { major = 1, minor = -0.1 }", "`minor` is -0.1"),
        ("ellipsoid = { center = [0, 0, 0], radii = [1, 0, 1] }", "`radii` is 0"),
        (
            "quadric = { squares = [1, 1, 1], constant = -1, min = [1, 1, 1], max = [-1, 1, 1] }",
            "on x they are -1 and 1",
        ),
        (
            "quadric = { squares = [0, 0, 0], constant = -1, min = [0, 0, 0], max = [1, 1, 1] }",
            "there is no surface",
        ),
        (
            "prism = { outline = [[0, 0], [1, 0], [0, 1]], bottom = 1, top = 1 }",
            "`top` must exceed `bottom`",
        ),
        ("prism = { outline = [[0, 0], [1, 0]], bottom = 0, top = 1 }", "needs at least 3 points"),
        ("prism = { outline = [[0, 0], [1, 0], [2, 0]], bottom = 0, top = 1 }", "outline"),
        ("polygon = { points = [[0, 0, 0], [1, 0, 0], [2, 0, 0]] }", "no area"),
        ("plane = { normal = [0, 0, 0], offset = 0 }", "`normal` is zero"),
        ("knot = { turns = [2, 3], tube = 0, segments = [9, 9] }", "`tube` is 0"),
        ("sphereflake = { center = [0, 0, 0], radius = 0, levels = 2 }", "`radius` is 0"),
    ] {
        let message = mistake_beside(BALL, shape, &[]);
        assert_says(&message, &["scene.toml:24:", says, "help: "]);
    }
    let flat = mistake_beside(BALL, &format!("{BALL}, scale = [1, 0, 1]"), &[]);
    assert_says(&flat, &["scene.toml:24:", "`scale` is 0", "help: "]);
}

#[test]
fn an_open_mesh_among_operands_is_refused_with_its_edge() {
    let open = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\n";
    let lines = "mesh = { file = \"open.obj\" }, material = \"mirror\" }\n\
                 cut = { difference = [\"ball\"] }\nwhole = { merge = [\"cut\"] }\n#";
    let message = mistake_beside(&format!("{BALL}, material"), lines, &[("open.obj", open)]);
    assert_says(
        &message,
        &[
            "scene.toml:25:",
            "the mesh of `ball` is not closed",
            "see its edge from [0, 0, 0] to [0, 1, 0]",
            "help: close the mesh",
        ],
    );
}

#[test]
fn names_that_go_round_in_a_circle_are_refused() {
    let lines = format!(
        "{BALL}, material = \"mirror\" }}\na = {{ difference = [\"ball\", \"b\"] }}\n\
         b = {{ union = [\"c\"] }}\nc = {{ merge = [\"ball\", \"a\"] }}\n#"
    );
    let message = mistake_beside(&format!("{BALL}, material"), &lines, &[]);
    let circle = "a solid cannot be made of itself: `a` of `b` of `c` of `a`";
    assert_says(&message, &["scene.toml:25:", circle, "help: take one of them out"]);
}

fn asset(name: &str) -> Vec<u8> {
    std::fs::read(Path::new(env!("CARGO_MANIFEST_DIR")).join("assets").join(name)).unwrap()
}

/// What is said of a scene with an image of this name and these bytes.
fn image(name: &str, bytes: &[u8]) -> String {
    let pattern = format!("image = {{ file = \"{name}\" }}");
    mistake_beside(CHECKER, &pattern, &[(name, bytes)])
}

#[test]
fn files_cut_in_half_are_refused_where_they_are_named() {
    for name in ["globe.png", "dunes.jpg"] {
        let whole = asset(name);
        let message = image(name, &whole[..whole.len() / 2]);
        assert_says(&message, &["scene.toml:14:", name, "help: export it again"]);
    }
    let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 3 2\n";
    for (length, place) in [(13, "cut.obj:2:"), (20, "cut.obj:3:"), (29, "cut.obj:4:")] {
        let half = [("cut.obj", &text.as_bytes()[..length])];
        let message = mistake_beside(BALL, "mesh = { file = \"cut.obj\" }", &half);
        assert_says(&message, &["scene.toml:24:", place, "help: "]);
    }
    let folder = folder_with_scene();
    let mut refusals = 0;
    for tenth in 1..10 {
        let half = &SCENE[..SCENE.len() * tenth / 10];
        std::fs::write(folder.path().join("half.toml"), half).unwrap();
        // A file that was cut between two tables may be a scene.
        if super::run(folder.path(), &["check", "half.toml"]).code != Some(0) {
            let message = refused(folder.path(), &["check", "half.toml"], 2);
            assert_says(&message, &["half.toml:", "help: "]);
            refusals += 1;
        }
    }
    assert!(refusals > 5, "{refusals}");
}

/// The check sum of PNG's chunks.
fn crc32(bytes: &[u8]) -> u32 {
    let step = |crc: u32| if crc & 1 == 1 { crc >> 1 ^ 0xedb8_8320 } else { crc >> 1 };
    !bytes.iter().fold(!0, |crc, byte| (0..8).fold(crc ^ u32::from(*byte), |crc, _| step(crc)))
}

#[test]
fn images_that_promise_four_gigabytes_are_refused() {
    let mut png = asset("globe.png");
    assert_eq!(crc32(&png[12..29]).to_be_bytes(), png[29..33], "the header's own check sum");
    png[16..24].copy_from_slice(&[0, 0, 255, 255, 0, 0, 255, 255]);
    let sum = crc32(&png[12..29]).to_be_bytes();
    png[29..33].copy_from_slice(&sum);
    let mut jpeg = asset("dunes.jpg");
    let frame = jpeg.windows(2).position(|pair| pair == [0xff, 0xc0] || pair == [0xff, 0xc2]);
    let frame = frame.expect("a frame header");
    jpeg[frame + 5..frame + 9].fill(255);
    let hdr = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 65535 +X 65535\n".to_vec();
    for (name, bytes) in [("a.png", png), ("a.jpg", jpeg), ("a.hdr", hdr)] {
        let message = image(name, &bytes);
        assert_says(&message, &["scene.toml:14:", name, "help: "]);
        let folder = folder_with_scene();
        let scene = SCENE.replace(CHECKER, &format!("image = {{ file = \"{name}\" }}"));
        std::fs::write(folder.path().join("scene.toml"), scene).unwrap();
        std::fs::write(folder.path().join(name), &bytes).unwrap();
        let within = limited(folder.path(), &["check", "scene.toml"]);
        assert_eq!(within.status.code(), Some(2), "{within:?}");
        assert_eq!(String::from_utf8_lossy(&within.stderr), message);
    }
}

/// The program with at most 2 GiB of memory, where a shell can see to that.
fn limited(folder: &Path, arguments: &[&str]) -> std::process::Output {
    let mut command = Command::new("sh");
    let limit = "ulimit -v 2097152; exec \"$0\" \"$@\"";
    command.current_dir(folder).args(["-c", limit, env!("CARGO_BIN_EXE_rayforest")]);
    command.args(arguments).output().unwrap()
}

#[test]
fn a_million_coincident_triangles_are_rendered_within_two_gigabytes() {
    let folder = folder_with_scene();
    let scene = SCENE.replace(BALL, "mesh = { file = \"same.obj\" }");
    std::fs::write(folder.path().join("scene.toml"), scene).unwrap();
    let faces = "f 1 2 3\n".repeat(1_000_000);
    let mesh = format!("v -2 0 -1\nv 2 0 -1\nv 0 0 2\n{faces}");
    std::fs::write(folder.path().join("same.obj"), mesh).unwrap();
    let arguments = [
        "render",
        "scene.toml",
        "-o",
        "a.png",
        "--threads",
        "2",
        "--memory",
        "0.25",
        "--size",
        "16x9",
    ];
    let ran = limited(folder.path(), &arguments);
    let messages = String::from_utf8_lossy(&ran.stderr);
    assert_eq!(ran.status.code(), Some(0), "{messages}");
    let (size, _, bytes) = decode_png(&folder.path().join("a.png")).unwrap();
    assert_eq!(size, [16, 9]);
    assert!(bytes.chunks(3).any(|pixel| pixel != &bytes[..3]), "the triangles are seen");
}
