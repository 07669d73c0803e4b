//! Held at the faces: what a person or a script sees of the program.

mod bad_input;
mod bad_solids;
mod cache;
mod card;
mod chart;
mod command_line;
mod convert;
#[cfg(target_os = "linux")]
mod display;
mod examples;
mod killed;
mod language;
mod layers;
mod looks;
mod mass;
mod parts;
mod presets;
mod window;

use std::path::Path;
use std::process::{Command, Output};

/// A small scene of a ball on a floor, with mistakes to be made in it.
const SCENE: &str = r#"version = 1

[picture]
size = [48, 27]

[trace]
samples = 2

[lights]
key = { point = [-4, -5, 7], intensity = 0.8 }
fill = { direction = [-0.5, 0.4, -1], intensity = [0.2, 0.25, 0.3] }

[materials.tiles]
texture = { checker = { a = [0.9, 0.8, 0.2], b = 0.2, size = 0.7 } }

[materials.mirror]
color = [0.9, 0.9, 0.95]
diffuse = 0.3
specular = 0.6
reflect = 0.5

[solids]
floor = { plane = { normal = [0, 0, 1], offset = -1 }, material = "tiles" }
ball = { sphere = { center = [0, 0, 0], radius = 1 }, material = "mirror" }
"#;

/// The variables that name a display.
const DISPLAYS: [&str; 3] = ["DISPLAY", "WAYLAND_DISPLAY", "WAYLAND_SOCKET"];

/// The program with its working folder, on a machine without a display.
fn rayforest(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_rayforest"));
    command.current_dir(folder).args(arguments);
    // Its log is nobody's.
    command.env("XDG_STATE_HOME", env!("CARGO_TARGET_TMPDIR"));
    for display in DISPLAYS {
        command.env_remove(display);
    }
    command
}

/// What a finished run printed.
struct Ran {
    code: Option<i32>,
    results: String,
    messages: String,
}

fn run(folder: &Path, arguments: &[&str]) -> Ran {
    let Output { status, stdout, stderr } = rayforest(folder, arguments).output().unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).expect("UTF-8");
    let ran = Ran { code: status.code(), results: text(stdout), messages: text(stderr) };
    assert!(!ran.messages.contains("panicked"), "{arguments:?}: {}", ran.messages);
    ran
}

/// Runs what must succeed.
fn succeed(folder: &Path, arguments: &[&str]) -> Ran {
    let ran = run(folder, arguments);
    assert_eq!(ran.code, Some(0), "{arguments:?}: {}", ran.messages);
    ran
}

/// A folder with the small scene in `scene.toml`.
fn folder_with_scene() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("scene.toml"), SCENE).unwrap();
    folder
}

/// The names of what is in a folder, sorted.
fn names_in(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).unwrap();
    let mut names: Vec<String> =
        entries.map(|e| e.unwrap().file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

/// Decodes a whole PNG: its size, bits per channel, and bytes.
fn decode_png(path: &Path) -> Result<([u32; 2], u8, Vec<u8>), String> {
    let file = std::fs::File::open(path).map_err(|e| e.to_string())?;
    let decoder = png::Decoder::new(std::io::BufReader::new(file));
    let mut reader = decoder.read_info().map_err(|e| e.to_string())?;
    let mut bytes = vec![0; reader.output_buffer_size().ok_or("too large")?];
    reader.next_frame(&mut bytes).map_err(|e| e.to_string())?;
    reader.finish().map_err(|e| e.to_string())?;
    let header = reader.info();
    Ok(([header.width, header.height], header.bit_depth as u8, bytes))
}

#[test]
fn half_a_png_is_not_a_picture() {
    let folder = folder_with_scene();
    succeed(folder.path(), &["render", "scene.toml", "-o", "a.png"]);
    let path = folder.path().join("a.png");
    let (size, bits, _) = decode_png(&path).unwrap();
    assert_eq!((size, bits), ([48, 27], 8));
    let bytes = std::fs::read(&path).unwrap();
    for length in [0, 20, bytes.len() / 2, bytes.len() - 1] {
        std::fs::write(&path, &bytes[..length]).unwrap();
        assert!(decode_png(&path).is_err(), "{length} of {} bytes", bytes.len());
    }
}
