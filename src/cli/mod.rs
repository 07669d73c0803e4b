//! The command line: results on standard output, messages on standard error, exit codes.

mod cached;
mod chart;
mod convert;
mod demo;
mod inspect;
mod language;
mod mass;
mod render;
mod sheet;
mod tiles;
mod watch;

use std::fmt;
use std::io::Write;
use std::path::{Path, PathBuf};

use clap::{Args, Parser, Subcommand, ValueEnum};
use serde_json::Value;

use crate::bench;
use crate::film::embedded::{is_picture, scene_text};
use crate::film::write::check_writable;
use crate::scene::energy::overbright;
use crate::scene::{Scene, path, read, write};
use crate::session::Options;
use crate::shade::gpu::Gpu;
use crate::viewer::{Graphics, Opening, WindowError, measure};

/// Traces a scene once, keeps every pixel's ray tree, and re-shades it exactly after every edit.
#[derive(Debug, Parser)]
#[command(name = "rayforest", version, about, args_conflicts_with_subcommands = true)]
pub struct Arguments {
    /// What to do; without it the scene (or the built-in one) is opened in the window.
    #[command(subcommand)]
    mode: Option<Mode>,
    /// A scene file.
    #[arg(value_parser = parse_scene)]
    scene: Option<PathBuf>,
    /// What draws the picture in the window; chosen by what there is if not given.
    #[arg(long, value_enum)]
    renderer: Option<Renderer>,
    /// Give the graphics card up when there is such a file, as a driver does that fails: for tests.
    #[arg(long, value_name = "FILE", hide = true)]
    lose_graphics: Option<PathBuf>,
}

/// What draws the picture in the window.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum Renderer {
    /// The graphics card
    Gpu,
    /// The processor, shown by the graphics card
    Cpu,
    /// The processor, shown by OpenGL
    Glow,
}

#[derive(Debug, Subcommand)]
enum Mode {
    /// Trace a scene, edit it, write the picture
    Render(render::Render),
    /// Put a picture together from the parts that `render --tile` traced
    Merge(tiles::Merge),
    /// Measure tracing, folding and re-shading
    Bench(Bench),
    /// Chart speed against accuracy of a scene's settings, and recommend some
    Chart(chart::Charted),
    /// Show a pixel's ray tree, its terms and their shares
    Inspect(inspect::Inspect),
    /// Read a scene and report every mistake in it
    Check(Check),
    /// Make a scene of another program's file: OBJ, glTF, GLB or NFF
    Convert(convert::Convert),
    /// Measure volume, centre of mass and moments of inertia of solids
    Mass(mass::Weighed),
    /// Print the reference of scene files: every key with its range, default and cost
    Language(language::Language),
}

#[derive(Debug, Args)]
struct Check {
    /// A scene file.
    scene: PathBuf,
}

/// What to measure.
#[derive(Debug, Args)]
struct Bench {
    /// Scene files.
    #[arg(required_unless_present = "solvers")]
    scenes: Vec<PathBuf>,
    #[command(flatten)]
    common: Common,
    /// Measure ways to meet a torus instead, without a scene: time against errors.
    #[arg(long, conflicts_with_all = ["scenes", "window", "rays"])]
    solvers: bool,
    /// Measure the window instead: from an edit to its picture, and what a turn of its loop costs.
    #[arg(long)]
    window: bool,
    /// Measure rays alone, on one thread: camera, mirror and shadow rays of the scenes, then what the
    /// hierarchy gains for 10 to 1 000 000 spheres.
    #[arg(long, conflicts_with = "window")]
    rays: bool,
    /// Measure the matrix product on the graphics card, by the card's own clock.
    #[arg(long, conflicts_with_all = ["window", "rays"])]
    gpu: bool,
    /// Write the figures to this file; `-` for standard output.
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

/// Options that every mode with a picture has.
#[derive(Debug, Args)]
pub(crate) struct Common {
    /// Size of the picture, e.g. 1920x1080, in place of the scene's.
    #[arg(long, value_name = "WxH", value_parser = parse_size)]
    size: Option<[u32; 2]>,
    /// Samples per pixel in place of the scene's.
    #[arg(long, value_name = "N")]
    samples: Option<u32>,
    /// Threads; all cores if not given.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// Memory for trees, matrix and highlights in GiB; half of the machine's if not given.
    #[arg(long, value_name = "GIB", value_parser = parse_memory)]
    memory: Option<f64>,
}

/// A command that ended without its result.
#[derive(Debug)]
pub struct Failure {
    /// Exit code: 1 where the job failed, 2 where the command or the scene is at fault.
    pub code: u8,
    message: String,
}

impl Failure {
    fn input(message: impl fmt::Display) -> Failure {
        Failure { code: 2, message: message.to_string() }
    }

    fn job(message: impl fmt::Display) -> Failure {
        Failure { code: 1, message: message.to_string() }
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

/// Prints a failure to standard error.
pub fn report(failure: &Failure) {
    say(&format!("error: {failure}"));
}

/// Does what the command line asks for.
pub fn run(arguments: Arguments) -> Result<(), Failure> {
    match arguments.mode {
        None => window(arguments.scene, arguments.renderer, arguments.lose_graphics),
        Some(Mode::Render(render)) => render.run(),
        Some(Mode::Chart(chart)) => chart.run(),
        Some(Mode::Merge(merge)) => merge.run(),
        Some(Mode::Inspect(inspect)) => inspect.run(),
        Some(Mode::Check(check)) => check.run(),
        Some(Mode::Convert(convert)) => convert.run(),
        Some(Mode::Mass(mass)) => mass.run(),
        Some(Mode::Language(language)) => language.run(),
        Some(Mode::Bench(bench)) => bench.run(),
    }
}

/// Opens the window; without a display, renders the scene instead.
fn window(
    scene: Option<PathBuf>,
    renderer: Option<Renderer>,
    lose_at: Option<PathBuf>,
) -> Result<(), Failure> {
    let graphics = match renderer {
        None => Graphics::Auto,
        Some(Renderer::Gpu) => Graphics::Gpu,
        Some(Renderer::Cpu) => Graphics::Cpu,
        Some(Renderer::Glow) => Graphics::Glow,
    };
    let options = Options::default();
    let opening = Opening { scene: scene.clone(), options, graphics, lose_at };
    match crate::viewer::run(opening) {
        Ok(()) => Ok(()),
        Err(error @ WindowError::NoDisplay(_)) => demo::run(scene.as_deref(), &error.to_string()),
        Err(error @ WindowError::NoGraphics(_)) => Err(Failure::job(error)),
    }
}

impl Check {
    fn run(self) -> Result<(), Failure> {
        let scene = read_scene(&self.scene)?;
        for bright in overbright(&scene) {
            say(&format!("warning: {}", bright.sentence(&scene)));
        }
        print(&format!(
            "{}: no mistakes; {} solids, {} materials, {} lights",
            self.scene.display(),
            scene.solids.len(),
            scene.materials.len(),
            scene.lights.len()
        ));
        Ok(())
    }
}

impl Bench {
    fn run(self) -> Result<(), Failure> {
        if let Some(file) = self.json.as_deref().filter(|f| *f != Path::new("-")) {
            check_writable(file).map_err(Failure::job)?;
        }
        // All mistakes are found before the first measurement.
        let mut scenes = Vec::new();
        for file in &self.scenes {
            let mut scene = read_scene(file)?;
            let options = self.common.apply(&mut scene)?;
            scenes.push((file, scene, options));
        }
        let gpu = self.gpu.then(Gpu::headless).transpose().map_err(Failure::job)?;
        let mut rows = Vec::new();
        for (file, scene, options) in scenes {
            let name = file.file_stem().map_or_else(String::new, |n| n.to_string_lossy().into());
            say(&format!("measuring {name} …"));
            rows.push(if self.window {
                measure_window(&name, &scene, options)?
            } else if self.rays {
                let row = bench::rays::measure(&name, &scene);
                say(&bench::rays::summary(&row));
                row
            } else if let Some(gpu) = &gpu {
                let row = bench::gpu::measure(&name, scene, options, gpu).map_err(Failure::job)?;
                say(&bench::gpu::summary(&row));
                row
            } else {
                let row = bench::measure(&name, scene, options).map_err(Failure::job)?;
                say(&bench::summary(&row));
                row
            });
        }
        if self.rays {
            let row = bench::rays::growth(6);
            say(&bench::rays::summary(&row));
            rows.push(row);
        }
        if self.solvers {
            let row = bench::solvers::measure();
            say(&bench::solvers::summary(&row));
            rows.push(row);
        }
        let text = serde_json::to_string_pretty(&rows).map_err(Failure::job)?;
        match self.json {
            Some(file) => write_text(&file, &text),
            None => Ok(()),
        }
    }
}

/// Measures the window with a scene, which is written to a file of its own: the window opens files.
fn measure_window(name: &str, scene: &Scene, options: Options) -> Result<Value, Failure> {
    let folder = tempfile::tempdir().map_err(Failure::job)?;
    let file = folder.path().join(format!("{name}.toml"));
    std::fs::write(&file, write::text(scene)).map_err(Failure::job)?;
    let row = measure::measure(name, scene, &file, options, folder.path());
    say(&measure::summary(&row));
    Ok(row)
}

impl Common {
    /// Applies the options to a scene and gives the session's.
    pub(crate) fn apply(&self, scene: &mut Scene) -> Result<Options, Failure> {
        if let Some([w, h]) = self.size {
            set(scene, "picture.size", &format!("[{w}, {h}]"), "--size")?;
        }
        if let Some(samples) = self.samples {
            set(scene, "trace.samples", &samples.to_string(), "--samples")?;
        }
        let mut options = Options::default();
        if let Some(threads) = self.threads {
            options.threads = usize::from(threads);
        }
        if let Some(gib) = self.memory {
            options.memory = (gib * f64::from(1 << 30)) as u64;
        }
        Ok(options)
    }
}

/// Reads a scene file, or the scene in an exported picture; the failure lists its mistakes.
pub(crate) fn read_scene(file: &Path) -> Result<Scene, Failure> {
    if is_picture(file) {
        let text = scene_text(file).map_err(Failure::input)?;
        return read::text(&text, file).map_err(Failure::input);
    }
    read::file(file).map_err(Failure::input)
}

/// Sets one parameter; the failure names the option that asked for it.
pub(crate) fn set(scene: &mut Scene, name: &str, value: &str, option: &str) -> Result<(), Failure> {
    path::set(scene, name, value).map_err(|e| Failure::input(format!("{option}: {e}")))
}

/// A line of results.
pub(crate) fn print(line: &str) {
    // A reader that closed the pipe has had enough.
    let _ = writeln!(std::io::stdout(), "{line}");
}

/// A message for the person.
pub(crate) fn say(line: &str) {
    let _ = writeln!(std::io::stderr(), "{line}");
}

/// Writes text to a file, or to standard output for `-`.
pub(crate) fn write_text(file: &Path, text: &str) -> Result<(), Failure> {
    if file == Path::new("-") {
        print(text);
        return Ok(());
    }
    crate::film::write::atomically(file, |out| {
        out.write_all(text.as_bytes())
            .and_then(|()| out.write_all(b"\n"))
            .map_err(|e| e.to_string())
    })
    .map_err(Failure::job)
}

fn parse_size(text: &str) -> Result<[u32; 2], String> {
    let parts = text
        .split_once(['x', 'X'])
        .and_then(|(w, h)| Some([w.trim().parse().ok()?, h.trim().parse().ok()?]));
    parts.ok_or_else(|| format!("`{text}` is not a size such as 1920x1080"))
}

/// The scene of a command line without a command: a word that is no file may be a mistyped command.
fn parse_scene(text: &str) -> Result<PathBuf, String> {
    let path = PathBuf::from(text);
    if path.extension().is_none() && !path.exists() {
        return Err("there is neither a command nor a scene file of this name".into());
    }
    Ok(path)
}

fn parse_memory(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(gib) if gib.is_finite() && gib > 0.0 && gib <= 1e6 => Ok(gib),
        _ => Err(format!("`{text}` is not a number of GiB above 0")),
    }
}
