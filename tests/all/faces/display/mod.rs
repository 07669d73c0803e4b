//! The real program on a real display, driven by pointer and keyboard and judged by what the screen shows.

mod absent;
mod closing;
mod edits;
mod export;
mod graphics;
mod looks;
mod pictures;
mod pixel;
mod presets;
mod recovery;
mod server;
mod twin;

use std::fs::File;
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitStatus};
use std::time::{Duration, Instant};

use eframe::egui::accesskit::Role;
use eframe::egui::{Pos2, Rect};
use serde_json::Value;

use server::{Ending, Server, Shot};
use twin::Twin;

/// Longest wait for anything: the machine may be busy.
const PATIENCE: Duration = Duration::from_secs(60);
/// The twin is drawn again after this time: costs arrive by themselves.
const AGAIN: Duration = Duration::from_millis(500);
/// Size of most screens.
const SIZE: [u16; 2] = [1280, 720];
/// Where the pointer rests: under the outline's lists, where nothing reacts to it.
const REST: Pos2 = Pos2::new(90.0, 640.0);

/// A small scene with comments, which saving has to keep.
const COMMENTED: &str = r#"# Two balls for the tests of the window.
version = 1

[picture]
size = [320, 180] # small, so that it is traced at once

[trace]
samples = 2

[lights]
key = { point = [-4, -5, 7], intensity = 0.8 } # from the left

[materials.tiles]
texture = { checker = { a = [0.9, 0.8, 0.2], b = 0.2, size = 0.7 } }

# The one that is edited.
[materials.mirror]
color = [0.9, 0.9, 0.95]
diffuse = 0.3 # by a slider
specular = 0.6
reflect = 0.5

[solids]
floor = { plane = { normal = [0, 0, 1], offset = -1 }, material = "tiles" }
ball = { sphere = { center = [0, 0, 0], radius = 1 }, material = "mirror" }
"#;

/// A display with a person before it, and a folder in which the program keeps all that it keeps.
struct Desk {
    // ends before the display does
    program: Option<Ending>,
    server: Server,
    folder: tempfile::TempDir,
    /// More variables for the program.
    variables: Vec<(&'static str, &'static str)>,
    /// Arguments before the scene.
    arguments: Vec<&'static str>,
    /// Whether a panic is expected, which the program survives.
    panics: bool,
}

impl Desk {
    /// A desk with the commented scene in `scene.toml`.
    fn new(size: [u16; 2]) -> Desk {
        let folder = tempfile::tempdir().unwrap();
        for name in ["run", "home", "no-programs"] {
            std::fs::create_dir(folder.path().join(name)).unwrap();
        }
        let private = std::fs::Permissions::from_mode(0o700);
        std::fs::set_permissions(folder.path().join("run"), private).unwrap();
        std::fs::write(folder.path().join("scene.toml"), COMMENTED).unwrap();
        let (variables, arguments) = (Vec::new(), Vec::new());
        Desk {
            program: None,
            server: Server::start(size),
            folder,
            variables,
            arguments,
            panics: false,
        }
    }

    /// A desk where the program shows `scene.toml` as its twin does.
    fn with_scene() -> (Desk, Twin) {
        let mut desk = Desk::new(SIZE);
        desk.start();
        let mut twin = Twin::new(&desk.file("scene.toml"), None);
        desk.show_one_to_one(&mut twin);
        (desk, twin)
    }

    /// Waits for the window, and shows one pixel of the picture on one of the screen: what is
    /// enlarged is rounded to the screen's pixels in a way of the driver's own.
    fn show_one_to_one(&mut self, twin: &mut Twin) {
        let button = twin.place("1:1");
        self.until_part_like(twin, button, "the window draws");
        // the first picture is shown as large as the window allows, whatever was asked for before
        let middle = twin.rect(Role::Image, "picture").center();
        self.until("a picture shows", |desk| desk.server.shot().pixel(middle) != EMPTY);
        twin.click(button.center());
        self.click(button.center());
        let mut lower = twin.rect(Role::Image, "picture");
        *lower.top_mut() = lower.center().y;
        self.until_part_like(twin, lower, "the picture has its own size");
        self.rest(twin);
    }

    /// Moves the pointer to where it touches nothing, and waits for the twin to agree.
    fn rest(&mut self, twin: &mut Twin) {
        twin.hover(REST);
        self.point(REST);
        self.until_like(twin, "the pointer rests");
    }

    fn file(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn scene_text(&self) -> String {
        std::fs::read_to_string(self.file("scene.toml")).unwrap()
    }

    /// Starts the program with `scene.toml` and lets its window fill the screen.
    fn start(&mut self) {
        self.start_with(&["scene.toml"]);
    }

    /// Starts the program with a scene or without.
    fn start_with(&mut self, scene: &[&str]) {
        let mut command = Command::new(env!("CARGO_BIN_EXE_rayforest"));
        command.args(&self.arguments).args(scene).current_dir(self.folder.path());
        // neither a portal nor zenity: no dialog service answers
        for name in ["WAYLAND_DISPLAY", "WAYLAND_SOCKET", "DBUS_SESSION_BUS_ADDRESS"] {
            command.env_remove(name);
        }
        command.env("PATH", self.file("no-programs")).env("DISPLAY", &self.server.name);
        command.env("XDG_RUNTIME_DIR", self.file("run")).env("HOME", self.file("home"));
        for name in ["CONFIG", "STATE", "DATA", "CACHE"] {
            command.env(format!("XDG_{name}_HOME"), self.file(&name.to_lowercase()));
        }
        command.envs(self.variables.iter().copied());
        command.stdout(File::create(self.file("results")).unwrap());
        command.stderr(File::create(self.file("messages")).unwrap());
        self.program = Some(Ending(command.spawn().unwrap()));
        self.show_window(None);
    }

    /// Waits for a window that is not `known`, lets it fill the screen, and says which it is.
    fn show_window(&mut self, known: Option<u32>) -> u32 {
        let start = Instant::now();
        let window = loop {
            if let Some(window) = self.server.window().filter(|window| Some(*window) != known) {
                break window;
            }
            self.check_alive("the window opens");
            assert!(start.elapsed() < PATIENCE, "no window: {}", self.messages());
            std::thread::sleep(Duration::from_millis(10));
        };
        self.server.show_whole(window);
        self.point(REST);
        window
    }

    /// What the program wrote to standard error.
    fn messages(&self) -> String {
        std::fs::read_to_string(self.file("messages")).unwrap()
    }

    fn check_alive(&mut self, what: &str) {
        let program = self.program.as_mut().expect("a program was started");
        if let Some(status) = program.0.try_wait().unwrap() {
            panic!("the program ended ({status}) before {what}: {}", self.messages());
        }
        let calm = self.panics || !self.messages().contains("panicked");
        assert!(calm, "{}", self.messages());
    }

    /// Waits until something holds of the desk.
    fn until(&mut self, what: &str, holds: impl Fn(&Desk) -> bool) {
        let start = Instant::now();
        while !holds(self) {
            self.check_alive(what);
            if start.elapsed() > PATIENCE {
                let shot = self.server.shot().keep("display-waiting");
                panic!("still not so: {what}; see {}\n{}", shot.display(), self.messages());
            }
            std::thread::sleep(Duration::from_millis(15));
        }
    }

    /// Waits until the screen shows what the twin shows, the status line apart: it tells times.
    fn until_like(&mut self, twin: &mut Twin, what: &str) {
        let part = Rect::from_min_max(Pos2::ZERO, status_line().right_top());
        self.until_part_like(twin, part, what);
    }

    /// Waits until a part of the screen shows what the twin shows there.
    fn until_part_like(&mut self, twin: &mut Twin, part: Rect, what: &str) {
        let start = Instant::now();
        let mut wanted = twin.shot();
        let mut again = start + AGAIN;
        loop {
            if Instant::now() > again {
                (wanted, again) = (twin.shot(), Instant::now() + AGAIN);
            }
            let shot = self.server.shot();
            let different = shot.differences(&wanted, part, &[], TOLERANCE);
            if different.is_empty() {
                return;
            }
            self.check_alive(what);
            if start.elapsed() > PATIENCE {
                let (real, twin) = (shot.keep("display-real"), wanted.keep("display-twin"));
                panic!(
                    "{what}: {} and {} differ in {} pixels, first {:?}",
                    real.display(),
                    twin.display(),
                    different.len(),
                    different[0]
                );
            }
            std::thread::sleep(Duration::from_millis(15));
        }
    }

    /// Waits until the screen differs from `before` within `part`.
    fn until_changed(&mut self, before: &Shot, part: Rect, what: &str) {
        self.until(what, |desk| !desk.server.shot().differences(before, part, &[], 0).is_empty());
    }

    fn point(&self, at: Pos2) {
        self.server.move_to(at);
    }

    /// Does something with the pointer, and waits until the screen answers around a point: what
    /// comes faster than the window draws may be taken for one event.
    fn watched(&mut self, at: Pos2, what: &str, act: impl Fn(&Desk)) {
        let around = Rect::from_center_size(at, [24.0, 24.0].into());
        let before = self.server.shot();
        act(self);
        self.until_changed(&before, around, what);
    }

    /// Clicks, and leaves the pointer there: the caller waits for what the click does.
    fn click(&mut self, at: Pos2) {
        self.watched(at, "it lights up", |desk| desk.point(at));
        // a button that is held for long is not clicked
        self.server.xdotool(&["mousedown", "1", "mouseup", "1"]);
    }

    /// Presses keys, such as `ctrl+s`.
    fn press(&self, keys: &str) {
        self.server.xdotool(&["key", keys]);
    }

    /// Drags a handle with the pointer.
    fn drag(&mut self, from: Pos2, to: Pos2) {
        self.watched(from, "the handle lights up", |desk| desk.point(from));
        self.watched(from, "it is held", |desk| desk.server.xdotool(&["mousedown", "1"]));
        self.watched(to, "it moves", |desk| desk.point(to));
        self.watched(to, "it is let go", |desk| desk.server.xdotool(&["mouseup", "1"]));
        self.point(REST);
    }

    /// Kills the program as a failing machine would.
    fn kill(&mut self) {
        self.program = None;
    }

    /// Waits until the program ends by itself.
    fn until_ended(&mut self) -> ExitStatus {
        let start = Instant::now();
        loop {
            let program = self.program.as_mut().expect("a program was started");
            if let Some(status) = program.0.try_wait().unwrap() {
                assert!(!self.messages().contains("panicked"), "{}", self.messages());
                return status;
            }
            if start.elapsed() > PATIENCE {
                let shot = self.server.shot().keep("display-waiting");
                panic!("the program does not end; see {}", shot.display());
            }
            std::thread::sleep(Duration::from_millis(10));
        }
    }

    /// The unsaved work that is kept: each file is whole.
    fn kept_work(&self) -> Vec<Value> {
        let folder = self.file("state/rayforest/unsaved");
        let Ok(files) = std::fs::read_dir(folder) else { return Vec::new() };
        let names = files.map(|file| file.unwrap().path());
        let work = names.filter(|name| name.extension().is_some_and(|e| e == "json"));
        work.map(|name| serde_json::from_slice(&std::fs::read(name).unwrap()).unwrap()).collect()
    }
}

/// The ground on which the picture lies.
const EMPTY: [u8; 3] = [40; 3];

/// What two ways of drawing the same window may differ by, in steps of 255: glyphs and rounded
/// corners are blended in other places of the pipeline.
const TOLERANCE: u8 = 2;

/// The line at the lower edge.
fn status_line() -> Rect {
    let [width, height] = SIZE.map(f32::from);
    Rect::from_min_max(Pos2::new(0.0, height - 30.0), Pos2::new(width, height))
}

/// The bytes that a fresh render of a scene file gives.
fn rendered(folder: &Path, file: &str) -> Vec<u8> {
    super::succeed(folder, &["render", file, "-o", "fresh.png"]);
    super::decode_png(&folder.join("fresh.png")).unwrap().2
}
