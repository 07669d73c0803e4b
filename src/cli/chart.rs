//! `rayforest chart`: speed against accuracy of a scene's settings, as pictures and tables in a folder.

use std::path::{Path, PathBuf};

use clap::Args;

use super::watch::watched;
use super::{Common, Failure, print, read_scene, say, set};
use crate::chart::{Chart, Cost, Goal, News, TIME, Wishes, csv, json, measure, png, svg};
use crate::film::write::{atomically, check_writable};

/// What to measure.
#[derive(Debug, Args)]
pub(crate) struct Charted {
    /// A scene file.
    scene: PathBuf,
    /// The folder for chart.svg, chart.png, chart.csv and chart.json; made if there is none.
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    /// Samples per pixel of the reference that others are compared with.
    #[arg(long, value_name = "N", default_value_t = 1024,
          value_parser = clap::value_parser!(u32).range(8..=4096))]
    reference: u32,
    /// The error that is wanted at most: rms of linear light, 1 being white. Without it: one 8-bit
    /// code value of sRGB, rms.
    #[arg(long, value_name = "E", value_parser = parse_error)]
    error: Option<f64>,
    /// Set a parameter first, e.g. trace.cutoff=0; may be repeated.
    #[arg(long, value_name = "PATH=VALUE")]
    set: Vec<String>,
    #[command(flatten)]
    common: Common,
}

/// The files, in the order in which they are written.
const FILES: [&str; 4] = ["chart.svg", "chart.png", "chart.csv", "chart.json"];

impl Charted {
    pub(crate) fn run(self) -> Result<(), Failure> {
        let mut scene = read_scene(&self.scene)?;
        let options = self.common.apply(&mut scene)?;
        for assignment in &self.set {
            let (path, value) = super::render::split(assignment, "--set")?;
            set(&mut scene, path, value, "--set")?;
        }
        let made = std::fs::create_dir_all(&self.output);
        made.map_err(|e| Failure::job(format!("cannot make {}: {e}", self.output.display())))?;
        let files = FILES.map(|name| self.output.join(name));
        for file in &files {
            check_writable(file).map_err(Failure::job)?;
        }
        let goal = self.error.map_or_else(Goal::default, Goal::Linear);
        let wishes = Wishes { reference: self.reference, goal };
        let chart = watched("tracing", |progress| {
            measure(&scene, options, wishes, progress, &mut |news| {
                if let News::Traces { what, done, of } = news {
                    say(&format!("{} of {of}: {what}", done + 1));
                }
            })
        });
        let chart = chart.map_err(Failure::job)?;
        let name = self.scene.file_stem().map_or_else(String::new, |n| n.to_string_lossy().into());
        let table = serde_json::to_string_pretty(&json(&name, &chart)).map_err(Failure::job)?;
        let picture = png(&name, &chart).ok_or_else(|| Failure::job("the chart has no picture"))?;
        let contents =
            [svg(&name, &chart).into_bytes(), picture, csv(&chart).into(), table.into_bytes()];
        for (file, bytes) in files.iter().zip(contents) {
            write(file, &bytes)?;
        }
        summary(&chart).iter().for_each(|line| print(line));
        files.iter().for_each(|file| print(&format!("wrote {}", file.display())));
        Ok(())
    }
}

fn write(file: &Path, bytes: &[u8]) -> Result<(), Failure> {
    atomically(file, |out| out.write_all(bytes).map_err(|e| e.to_string())).map_err(Failure::job)
}

/// What is recommended, for people.
fn summary(chart: &Chart) -> Vec<String> {
    let Chart { goal, present, present_error, sweeps, advice, .. } = chart;
    let line = |what: &str, cost: &Cost, error: Option<crate::chart::Deviation>| {
        let error = error.map_or_else(String::new, |e| {
            format!(", error at most about {:.2e} rms ({:.2} code values)", e.linear, e.codes)
        });
        format!(
            "{what}: {:.3} {TIME}, {:.2} million rays{error}",
            cost.seconds,
            cost.rays as f64 / 1e6
        )
    };
    let heading = match advice.reached {
        true => format!("recommended for an error {goal}"),
        false => format!("nothing measured has an error {goal}; the most accurate"),
    };
    vec![
        line("as it is", present, *present_error),
        line(&format!("{heading}: {}", advice.text(sweeps)), &advice.cost, Some(advice.error)),
    ]
}

fn parse_error(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(error) if error.is_finite() && error > 0.0 => Ok(error),
        _ => Err(format!("`{text}` is not an error above 0")),
    }
}
