//! Measures the window, no display needed: from an edit to its picture, and what a turn of its loop costs.

use std::path::Path;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};

use eframe::egui::{Context, Event, Pos2, RawInput, Rect, pos2, vec2};
use serde_json::{Value, json};

use super::dialog::ScriptedDialogs;
use super::{App, Folders, Setup};
use crate::bench::Spread;
use crate::clock::thread_seconds;
use crate::scene::Scene;
use crate::session::Options;
use crate::session::live::{Live, Stage};

/// Edits that are timed.
const EDITS: usize = 100;
/// Size of the window in points.
const WINDOW: [f32; 2] = [1280.0, 720.0];
/// Longest wait for a picture.
const PATIENCE: Duration = Duration::from_secs(600);

/// Measures the window with a scene; `folder` holds its settings and is given up afterwards.
pub fn measure(name: &str, scene: &Scene, file: &Path, options: Options, folder: &Path) -> Value {
    let (first, edits) = edit_to_picture(scene, options);
    let plain = turns(file, options, (folder, false));
    let full = turns(file, options, (folder, true));
    json!({
        "scene": name,
        "size": scene.picture.size,
        "samples": scene.trace.samples,
        "threads": options.threads,
        "first_coarse_ms": first.coarse,
        "first_whole_ms": first.whole,
        "edit_to_picture_ms": edits.json(),
        "turn_processor_ms": plain.processor.json(),
        "turn_wall_ms": plain.wall.json(),
        "full_turn_processor_ms": full.processor.json(),
        "full_turn_wall_ms": full.wall.json(),
    })
}

/// A few lines for people.
pub fn summary(row: &Value) -> String {
    let number = |path: &str| row.pointer(path).and_then(Value::as_f64).unwrap_or(f64::NAN);
    format!(
        "{}: first picture coarse after {:.0} ms, whole after {:.0} ms\n  edit to picture {:.1} ms, \
         p99 {:.1}\n  a turn of the window while tracing: {:.2} ms of processor, p99 {:.2}; wall \
         {:.2} ms, p99 {:.2}\n  with every panel open: {:.2} ms of processor, p99 {:.2}; wall {:.2} ms, p99 {:.2}",
        row["scene"].as_str().unwrap_or("?"),
        number("/first_coarse_ms"),
        number("/first_whole_ms"),
        number("/edit_to_picture_ms/median"),
        number("/edit_to_picture_ms/p99"),
        number("/turn_processor_ms/median"),
        number("/turn_processor_ms/p99"),
        number("/turn_wall_ms/median"),
        number("/turn_wall_ms/p99"),
        number("/full_turn_processor_ms/median"),
        number("/full_turn_processor_ms/p99"),
        number("/full_turn_wall_ms/median"),
        number("/full_turn_wall_ms/p99"),
    )
}

struct First {
    coarse: f64,
    whole: f64,
}

/// Times from the wish for a scene to its finished 8-bit picture.
fn edit_to_picture(scene: &Scene, options: Options) -> (First, Spread) {
    let (send, woken) = channel();
    let live = Live::new(options, move || {
        // The receiver is gone only once the session is.
        let _ = send.send(());
    });
    let start = Instant::now();
    let mut wanted = Arc::new(scene.clone());
    live.want(wanted.clone());
    let coarse = until(&live, &woken, start, |_| true);
    let whole = until(&live, &woken, start, |stage| stage == Stage::Whole);
    let mut times = Vec::new();
    for i in 0..EDITS {
        let mut edited = Scene::clone(&wanted);
        // All colours at once: every tile is shaded anew.
        let strength = 0.5 + (i % 17) as f32 / 20.0;
        for light in &mut edited.lights {
            light.intensity = crate::color::Rgb::grey(strength);
        }
        edited.background =
            crate::scene::Background::Color(crate::color::Rgb::grey(0.1 * strength));
        wanted = Arc::new(edited);
        let start = Instant::now();
        live.want(wanted.clone());
        times.push(until_shown(&live, &woken, start, &wanted));
    }
    (First { coarse, whole }, Spread::of(times))
}

/// Milliseconds until a picture of a wanted stage arrives.
fn until(live: &Live, woken: &Receiver<()>, start: Instant, enough: impl Fn(Stage) -> bool) -> f64 {
    loop {
        if live.take_shown().is_some_and(|shown| enough(shown.stage)) {
            return start.elapsed().as_secs_f64() * 1e3;
        }
        woken.recv_timeout(PATIENCE).expect("a session gives a picture");
    }
}

/// Milliseconds until the picture of `wanted` arrives.
fn until_shown(live: &Live, woken: &Receiver<()>, start: Instant, wanted: &Arc<Scene>) -> f64 {
    loop {
        if live.take_shown().is_some_and(|shown| *shown.scene == **wanted) {
            return start.elapsed().as_secs_f64() * 1e3;
        }
        woken.recv_timeout(PATIENCE).expect("a session gives a picture");
    }
}

struct Turns {
    processor: Spread,
    wall: Spread,
}

/// Turns of the window's loop, tessellation included, from its start to the end of its first trace;
/// `full` with every panel open.
fn turns(file: &Path, options: Options, (folder, full): (&Path, bool)) -> Turns {
    let ctx = Context::default();
    let setup = Setup {
        options,
        folders: Folders::within(folder),
        dialogs: Box::new(ScriptedDialogs::default()),
        scene: Some(file.to_owned()),
    };
    let mut app = App::new(&ctx, setup);
    if full {
        app.open_all_panels();
    }
    let (mut processor, mut wall) = (Vec::new(), Vec::new());
    let start = Instant::now();
    for turn in 0.. {
        let input = input(turn, start);
        let (processor_before, wall_before) = (thread_seconds(), Instant::now());
        let output = ctx.run_ui(input, |ui| app.ui(ui));
        let shapes = ctx.tessellate(output.shapes, output.pixels_per_point);
        let spent = (thread_seconds() - processor_before) * 1e3;
        drop(shapes);
        // The first turns lay fonts out and open the scene.
        if turn > 10 {
            processor.push(spent);
            wall.push(wall_before.elapsed().as_secs_f64() * 1e3);
        }
        let opened = app.document().path().is_some();
        let done = opened && app.live().status().in_step;
        if (done && turn > 100) || start.elapsed() > PATIENCE {
            break;
        }
        std::thread::sleep(Duration::from_millis(8));
    }
    Turns { processor: Spread::of(processor), wall: Spread::of(wall) }
}

/// A pointer that wanders over the window, so that everything is hovered in turn.
fn input(turn: u64, start: Instant) -> RawInput {
    let (x, y) = (turn as f32 * 13.7 % WINDOW[0], turn as f32 * 7.3 % WINDOW[1]);
    RawInput {
        screen_rect: Some(Rect::from_min_size(Pos2::ZERO, vec2(WINDOW[0], WINDOW[1]))),
        time: Some(start.elapsed().as_secs_f64()),
        events: vec![Event::PointerMoved(pos2(x, y))],
        ..RawInput::default()
    }
}
