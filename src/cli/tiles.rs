//! `rayforest render --tile` and `rayforest merge`: a huge still in parts, traced on as many machines as there are.

use std::path::{Path, PathBuf};

use clap::Args;
use rayon::ThreadPoolBuilder;
use serde_json::{Value, json};

use super::render::rays;
use super::watch::watched;
use super::{Failure, print};
use crate::film::layout::Layout;
use crate::film::plates::Plates;
use crate::film::write::{Format, check_writable, picture};
use crate::geometry::Geometry;
use crate::progress::Progress;
use crate::scene::Scene;
use crate::session::Options;
use crate::session::part::{self, Share};
use crate::session::still::Still;
use crate::session::trace::TraceError;

/// How the name of a part ends.
const ENDING: &str = "part";

/// Parts of one picture.
#[derive(Debug, Args)]
pub(crate) struct Merge {
    /// All parts of the picture, in any order.
    #[arg(required = true)]
    parts: Vec<PathBuf>,
    /// The picture: .png, .exr or .hdr.
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    /// Bits per channel of a PNG.
    #[arg(long, default_value = "8", value_parser = ["8", "16"])]
    bits: String,
}

impl Merge {
    pub(crate) fn run(self) -> Result<(), Failure> {
        let format = Format::of(&self.output, self.bits == "16").map_err(Failure::input)?;
        check_writable(&self.output).map_err(Failure::job)?;
        let merged = part::merge(&self.parts).map_err(Failure::input)?;
        let part::Merged { film, scene, development } = merged;
        let [width, height] = film.layout.size;
        let plates = Plates::of(film);
        picture(&self.output, format, &plates, development, &scene).map_err(Failure::job)?;
        let (shown, parts) = (self.output.display(), self.parts.len());
        print(&format!("{shown}: {width}×{height} from {parts} parts"));
        Ok(())
    }
}

/// Whether a file is named as a part: a picture's name would promise what it does not hold.
pub(crate) fn check_part_name(file: &Path) -> Result<(), Failure> {
    if file.extension().is_some_and(|ending| ending == ENDING) {
        return Ok(());
    }
    let file = file.display();
    Err(Failure::input(format!("{file}: with --tile the name must end in .{ENDING}")))
}

/// Traces one part of a scene's picture into a file. Gives its statistics, and a line about it.
pub(crate) fn trace(
    scene: &Scene,
    options: Options,
    share: Share,
    file: &Path,
) -> Result<(Value, String), Failure> {
    let Options { threads, memory } = options;
    let pool = ThreadPoolBuilder::new().num_threads(threads).build();
    let pool = pool.map_err(|_| Failure::job(TraceError::Threads { threads }))?;
    let geometry = Geometry::build(scene, &Progress::default());
    let geometry = geometry.map_err(|_| Failure::job(TraceError::Cancelled))?;
    let still = Still { scene, geometry: &geometry, pool: &pool, memory };
    let written = watched("tracing", |progress| part::write(&still, share, file, progress));
    let report = written.map_err(Failure::job)?;
    let layout = Layout::new(scene.picture.size);
    let tiles = share.tiles(layout).len();
    let stats = json!({
        "size": scene.picture.size,
        "samples": scene.trace.samples,
        "threads": threads,
        "memory_budget": memory,
        "part": share.to_string(),
        "tiles": tiles,
        "of_tiles": layout.tiles(),
        "trace_s": report.seconds,
        "rays": rays(report.rays),
    });
    let line = format!(
        "{}: part {share}, {tiles} of {} tiles, traced in {:.2} s, {:.2} million rays",
        file.display(),
        layout.tiles(),
        report.seconds,
        report.rays.total() as f64 / 1e6
    );
    Ok((stats, line))
}
