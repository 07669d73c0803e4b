//! `rayforest render`: trace, edit as a slider would, write the picture and the statistics.

use std::path::{Path, PathBuf};

use clap::Args;
use serde_json::{Value, json};

use super::cached::{self, OpenedScene};
use super::tiles::{self, check_part_name};
use super::watch::watched;
use super::{Common, Failure, print, read_scene, say, set, sheet, write_text};
use crate::film::develop::Development;
use crate::film::plates::Region;
use crate::film::write::{self as files, Format, check_writable, picture};
use crate::forest::grow::RayCounts;
use crate::scene::{Scene, write};
use crate::session::cache::OpenedCache;
use crate::session::layers::Extras;
use crate::session::part::Share;
use crate::session::{Class, EditReport, Options, Session};

#[derive(Debug, Args)]
pub(crate) struct Render {
    /// A scene file.
    scene: PathBuf,
    /// The picture: .png, .exr or .hdr; with --tile a .part.
    #[arg(short, long, value_name = "FILE", required_unless_present = "looks")]
    output: Option<PathBuf>,
    /// The look to put on, of those in the scene file, before --set; '' for none.
    #[arg(long, value_name = "NAME")]
    look: Option<String>,
    /// Write a contact sheet as PNG: the scene without a look and with each, row by row, each a third
    /// as large; what each cost is told.
    #[arg(long, value_name = "FILE", conflicts_with_all = ["tile", "look", "edit"])]
    looks: Option<PathBuf>,
    /// Bits per channel of a PNG.
    #[arg(long, default_value = "8", value_parser = ["8", "16"])]
    bits: String,
    /// Set a parameter before the trace, e.g. materials.tiles.diffuse=0.5; may be repeated.
    #[arg(long, value_name = "PATH=VALUE")]
    set: Vec<String>,
    /// Set a parameter after the trace, as a slider would; may be repeated.
    #[arg(long, value_name = "PATH=VALUE")]
    edit: Vec<String>,
    /// Write what was done, and for every edit its class, rays and time, as JSON; `-` for
    /// standard output.
    #[arg(long, value_name = "FILE")]
    stats: Option<PathBuf>,
    /// Use what an earlier run has kept beside the scene (NAME.rayforest-cache), so that nothing is
    /// traced that need not be; keep it there otherwise.
    #[arg(long)]
    cache: bool,
    /// With --cache, keep the ray trees too: larger, but edits after the next opening that grow them
    /// cast fewer rays.
    #[arg(long, requires = "cache")]
    cache_trees: bool,
    /// Trace part I of N of the picture alone, into a file `NAME.part`; `rayforest merge` puts the
    /// parts together.
    #[arg(long, value_name = "I/N", conflicts_with_all = ["edit", "cache", "bits"])]
    tile: Option<Share>,
    /// Write a picture of where adaptive sampling (trace.adaptive) spent its rays, as PNG: white pixels
    /// have all samples.
    #[arg(long, value_name = "FILE", conflicts_with = "tile")]
    sample_map: Option<PathBuf>,
    /// Leave out the background that the eye sees, and write how much of each pixel is covered.
    #[arg(long, requires = "output", conflicts_with = "tile")]
    alpha: bool,
    /// Write a layer per light, per material and per bounce into the EXR, beside the picture.
    #[arg(long, requires = "output", conflicts_with = "tile")]
    layers: bool,
    /// Write this part of the picture alone: left, top, width and height in pixels, e.g. 0,0,640x360.
    #[arg(long, value_name = "X,Y,WxH", value_parser = parse_region, requires = "output",
          conflicts_with = "tile")]
    region: Option<Region>,
    #[command(flatten)]
    common: Common,
}

impl Render {
    pub(crate) fn run(self) -> Result<(), Failure> {
        if let Some(share) = self.tile {
            return self.part(share);
        }
        let format = self.output.as_deref().map(|file| Format::of(file, self.bits == "16"));
        let format = format.transpose().map_err(Failure::input)?;
        if self.layers && format != Some(Format::Exr) {
            return Err(Failure::input("--layers: the name of the picture must end in .exr"));
        }
        if self.alpha && format.is_some_and(|format| !format.holds_alpha()) {
            return Err(Failure::input(
                "--alpha: the name of the picture must end in .png or .exr",
            ));
        }
        let (scene, options) = self.prepare()?;
        // A mistake in an edit is found before the trace, not after it.
        let edits = self.edits(&scene)?;
        let OpenedScene { mut session, opened, stats: cache } = self.open(scene, options)?;
        let mut stats = opening_stats(&session);
        if self.cache {
            stats["cache"] = cache;
        }
        let mut reports = Vec::new();
        for (assignment, edited) in edits {
            let edit = watched("tracing", |progress| session.edit(edited, progress));
            let report = edit.map_err(Failure::job)?;
            say(&edit_line(assignment, &report));
            reports.push(edit_stats(assignment, &report));
        }
        stats["edits"] = Value::Array(reports);
        if let Some((file, format)) = self.output.as_deref().zip(format) {
            let text = write::text(session.scene());
            let development = Development::of(&session.scene().picture);
            let plates = session.plates(self.extras()).map_err(Failure::input)?;
            picture(file, format, &plates, development, &text).map_err(Failure::job)?;
        }
        self.write_sample_map(&session)?;
        if let Some(file) = &self.looks {
            stats["looks"] = sheet::write(&mut session, file)?;
        }
        self.write_stats(&stats)?;
        if let Some(file) = self.output.as_ref().or(self.looks.as_ref())
            && !self.stats_are_results()
        {
            let shown = file.display();
            let (how, seconds, rays) = match &opened {
                Some(OpenedCache { cache, edit }) if edit.class < Class::Retrace => {
                    ("opened", cache.seconds + edit.milliseconds / 1e3, edit.rays)
                }
                _ => ("traced", session.trace_report().seconds, session.trace_report().rays),
            };
            let rays = rays.total() as f64 / 1e6;
            print(&format!("{shown}: {how} in {seconds:.2} s, {rays:.2} million rays"));
        }
        Ok(())
    }

    /// Checks where results go, and reads the scene with all that is set before the trace.
    fn prepare(&self) -> Result<(Scene, Options), Failure> {
        for file in self.output.iter().chain(&self.looks) {
            check_writable(file).map_err(Failure::job)?;
        }
        if let Some(file) = self.stats.as_deref().filter(|f| *f != Path::new("-")) {
            check_writable(file).map_err(Failure::job)?;
        }
        let mut scene = read_scene(&self.scene)?;
        if let Some(name) = &self.look {
            let name = Some(name.as_str()).filter(|name| !name.is_empty());
            let dressed = scene.dressed(name);
            scene = dressed.map_err(|error| Failure::input(format!("--look: {error}")))?;
        }
        let options = self.common.apply(&mut scene)?;
        for assignment in &self.set {
            let (path, value) = split(assignment, "--set")?;
            set(&mut scene, path, value, "--set")?;
        }
        let within = self.region.map_or(Ok(()), |region| region.check(scene.picture.size));
        within.map_err(|error| Failure::input(format!("--region: {error}")))?;
        Ok((scene, options))
    }

    /// What else than the picture its file shall hold.
    fn extras(&self) -> Extras {
        Extras { alpha: self.alpha, layers: self.layers, region: self.region }
    }

    /// Traces one part of the picture.
    fn part(&self, share: Share) -> Result<(), Failure> {
        // With --tile there is always one: --looks excludes it.
        let Some(output) = &self.output else { return Ok(()) };
        check_part_name(output)?;
        let (scene, options) = self.prepare()?;
        let (stats, line) = tiles::trace(&scene, options, share, output)?;
        self.write_stats(&stats)?;
        if !self.stats_are_results() {
            print(&line);
        }
        Ok(())
    }

    fn write_sample_map(&self, session: &Session) -> Result<(), Failure> {
        let Some(path) = &self.sample_map else { return Ok(()) };
        let map = session.sample_map().ok_or_else(|| {
            Failure::input("--sample-map: every pixel has all samples; set trace.adaptive above 0")
        })?;
        let frame = map.picture(session.transport().layout);
        files::frame(path, &frame).map_err(Failure::job)
    }

    fn write_stats(&self, stats: &Value) -> Result<(), Failure> {
        let Some(file) = &self.stats else { return Ok(()) };
        write_text(file, &serde_json::to_string_pretty(stats).map_err(Failure::job)?)
    }

    /// Whether standard output belongs to the statistics.
    fn stats_are_results(&self) -> bool {
        self.stats.as_deref() == Some(Path::new("-"))
    }

    /// Traces the scene, or opens it with what is kept of it.
    fn open(&self, scene: Scene, options: Options) -> Result<OpenedScene, Failure> {
        if self.cache {
            return cached::open(&self.scene, scene, options, self.cache_trees);
        }
        let opened = watched("tracing", |progress| Session::open(scene, options, progress));
        let session = opened.map_err(Failure::job)?;
        Ok(OpenedScene { session, opened: None, stats: Value::Null })
    }

    /// The scene after every edit, in order.
    fn edits(&self, scene: &Scene) -> Result<Vec<(&str, Scene)>, Failure> {
        let mut scene = scene.clone();
        let mut edits = Vec::new();
        for assignment in &self.edit {
            let (path, value) = split(assignment, "--edit")?;
            set(&mut scene, path, value, "--edit")?;
            edits.push((assignment.as_str(), scene.clone()));
        }
        Ok(edits)
    }
}

fn parse_region(text: &str) -> Result<Region, String> {
    let parts = || {
        let (x, rest) = text.split_once(',')?;
        let (y, size) = rest.split_once(',')?;
        let corner = [x.trim().parse().ok()?, y.trim().parse().ok()?];
        Some(Region { corner, size: super::parse_size(size).ok()? })
    };
    parts().ok_or_else(|| format!("`{text}` is not a region such as 0,0,640x360"))
}

/// Path and value of an assignment; the failure names the option that it came with.
pub(crate) fn split<'a>(assignment: &'a str, option: &str) -> Result<(&'a str, &'a str), Failure> {
    assignment.split_once('=').map(|(p, v)| (p.trim(), v.trim())).ok_or_else(|| {
        Failure::input(format!("{option}: `{assignment}` is not of the form PATH=VALUE"))
    })
}

/// One line about an edit.
pub(crate) fn edit_line(assignment: &str, report: &EditReport) -> String {
    let mut line = format!(
        "{assignment}: {} in {:.2} ms, {} rays",
        report.class,
        report.milliseconds,
        report.rays.total()
    );
    if let Some(reason) = &report.reason {
        line += &format!(" ({reason})");
    }
    line
}

fn opening_stats(session: &Session) -> Value {
    let report = session.trace_report();
    let (scene, options) = (session.scene(), session.options());
    json!({
        "size": scene.picture.size,
        "samples": scene.trace.samples,
        "threads": options.threads,
        "memory_budget": options.memory,
        "primitives": session.geometry().primitives(),
        "geometry_s": session.geometry_seconds(),
        "trace_s": report.seconds,
        "fold_s": report.fold_seconds,
        "rays": rays(report.rays),
        "nodes": report.nodes,
        "distinct_terms": session.transport().tiles.iter().flat_map(|t| &t.terms)
            .collect::<std::collections::HashSet<_>>().len(),
        "bytes": {
            "forest": session.forest().bytes(),
            "transport": session.transport().bytes(),
            "highlights": session.transport().highlight_bytes(),
        },
        "released_tiles": session.forest().released(),
    })
}

fn edit_stats(assignment: &str, report: &EditReport) -> Value {
    json!({
        "edit": assignment,
        "class": report.class.to_string(),
        "reason": report.reason,
        "rays": rays(report.rays),
        "pixels": report.pixels,
        "milliseconds": report.milliseconds,
    })
}

/// Ray counts as JSON.
pub(crate) fn rays(counts: RayCounts) -> Value {
    let RayCounts { camera, reflected, transmitted, shadow, lost } = counts;
    json!({
        "total": counts.total(),
        "camera": camera,
        "reflected": reflected,
        "transmitted": transmitted,
        "shadow": shadow,
        "lost": lost,
    })
}
