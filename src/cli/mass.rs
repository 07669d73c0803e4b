//! `rayforest mass`: volume, centre of mass and inertia of solids, each with its error.

use std::path::PathBuf;

use clap::Args;
use serde_json::{Value, json};

use super::watch::watched;
use super::{Failure, print, read_scene, say, set};
use crate::mass::{Goal, MassError, Measured, Properties, Report, Step, Stuff, Wishes, measure};
use crate::scene::{Scene, problem::suggestion};

/// What to measure.
#[derive(Debug, Args)]
pub(crate) struct Weighed {
    /// A scene file.
    scene: PathBuf,
    /// A solid of the scene; all that have a mass if not given.
    solid: Option<String>,
    /// Cast at most this many rays.
    #[arg(long, value_name = "N", conflicts_with = "error",
          value_parser = clap::value_parser!(u64).range(96..=1_000_000_000))]
    rays: Option<u64>,
    /// Go on until the volume is known up to this share of it.
    #[arg(long, value_name = "E", default_value = "1e-4", value_parser = parse_share)]
    error: f64,
    /// Mass per cubic unit of length, in place of that of the materials.
    #[arg(long, value_name = "D", value_parser = parse_density)]
    density: Option<f64>,
    /// Other rays for another number.
    #[arg(long, value_name = "N", default_value_t = 0)]
    seed: u64,
    /// Set a parameter first, e.g. solids.ball.scale=2; may be repeated.
    #[arg(long, value_name = "PATH=VALUE")]
    set: Vec<String>,
    /// Print the figures as JSON.
    #[arg(long)]
    json: bool,
}

impl Weighed {
    pub(crate) fn run(self) -> Result<(), Failure> {
        let mut scene = read_scene(&self.scene)?;
        for assignment in &self.set {
            let (path, value) = super::render::split(assignment, "--set")?;
            set(&mut scene, path, value, "--set")?;
        }
        let goal = self.rays.map_or(Goal::Error(self.error), Goal::Rays);
        let wishes = Wishes { goal, density: self.density, seed: self.seed };
        let mut rows = Vec::new();
        for solid in self.solids(&scene)? {
            let name = &scene.solids[solid].name;
            let found = watched("measuring", |progress| {
                measure(&scene, solid, wishes, progress, &mut |_| {})
            });
            match found {
                Ok(report) if self.json => rows.push(row(name, &report)),
                Ok(report) => lines(name, &report).iter().for_each(|line| print(line)),
                // Of a whole scene the floor is no reason to fail.
                Err(error) if self.solid.is_none() && error != MassError::Cancelled => {
                    say(&format!("{name}: {error}"));
                }
                Err(error) => return Err(Failure::input(format!("solid {name}: {error}"))),
            }
        }
        if self.json {
            print(&serde_json::to_string_pretty(&rows).map_err(Failure::job)?);
        }
        Ok(())
    }

    /// Indices of what is measured.
    fn solids(&self, scene: &Scene) -> Result<Vec<usize>, Failure> {
        let Some(wanted) = &self.solid else { return Ok((0..scene.solids.len()).collect()) };
        let names = scene.solids.iter().map(|solid| solid.name.as_str());
        match names.clone().position(|name| name == wanted) {
            Some(index) => Ok(vec![index]),
            None => {
                let help = suggestion(wanted, "solids", names);
                Err(Failure::input(format!("there is no solid `{wanted}`\n  help: {help}")))
            }
        }
    }
}

/// A number with its error, for people.
fn shown(measured: Measured) -> String {
    let Measured { value, error } = measured;
    format!("{value:.9} ± {error:.1e}")
}

fn three(numbers: &[Measured]) -> String {
    numbers.iter().map(|x| shown(*x)).collect::<Vec<_>>().join(", ")
}

/// What it is made of, for people.
fn materials(made_of: &[Stuff]) -> String {
    let one = |Stuff { material, density }: &Stuff| format!("{density} ({material})");
    made_of.iter().map(one).collect::<Vec<_>>().join(", ")
}

/// What is measured, for people.
fn lines(name: &str, report: &Report) -> Vec<String> {
    let Report { properties, steps: _, reached, torn, made_of, exact } = report;
    let Properties { volume, mass, center, inertia, principal, axes } = properties;
    let mut lines = vec![
        format!("{name}: {} rays", report.rays()),
        format!("  volume            {}", shown(*volume)),
        format!("  density           {}", materials(made_of)),
        format!("  mass              {}", shown(*mass)),
        format!("  centre of mass    {}", three(center)),
        format!("  inertia xx yy zz  {}", three(&inertia[..3])),
        format!("  inertia yz zx xy  {}", three(&inertia[3..])),
    ];
    for (moment, axis) in principal.iter().zip(axes) {
        let [x, y, z] = axis.to_array();
        lines
            .push(format!("  principal moment  {} about ({x:.6}, {y:.6}, {z:.6})", shown(*moment)));
    }
    if let Some(exact) = exact {
        let [a, b, c] = exact.principal.map(|x| x.value);
        lines.push(format!(
            "  by formula        volume {:.9}, principal moments {a:.9}, {b:.9}, {c:.9}",
            exact.volume.value
        ));
    }
    if *torn > 0 {
        lines
            .push(format!("  {torn} rays found crossings that do not add up, and count as misses"));
    }
    if !reached {
        lines.push("  the error that was asked for is not reached".to_owned());
    }
    lines
}

fn number(measured: &Measured) -> Value {
    let Measured { value, error } = measured;
    json!({ "value": value, "error": error })
}

fn figures(properties: &Properties) -> Value {
    let Properties { volume, mass, center, inertia, principal, axes } = properties;
    let list = |numbers: &[Measured]| numbers.iter().map(number).collect::<Vec<_>>();
    let [xx, yy, zz, yz, zx, xy] = inertia;
    json!({
        "volume": number(volume),
        "mass": number(mass),
        "center": list(center),
        "inertia": [
            list(&[*xx, *xy, *zx]),
            list(&[*xy, *yy, *yz]),
            list(&[*zx, *yz, *zz]),
        ],
        "principal": list(principal),
        "axes": axes.map(|axis| axis.to_array()),
    })
}

fn row(name: &str, report: &Report) -> Value {
    let Report { properties, steps, reached, torn, made_of, exact } = report;
    let step = |step: &Step| json!({ "rays": step.rays, "volume": number(&step.volume) });
    let mut row = figures(properties);
    let stuff =
        |Stuff { material, density }: &Stuff| json!({ "material": material, "density": density });
    row["solid"] = name.into();
    row["made_of"] = made_of.iter().map(stuff).collect();
    row["rays"] = report.rays().into();
    row["torn_rays"] = (*torn).into();
    row["reached"] = (*reached).into();
    row["steps"] = steps.iter().map(step).collect();
    row["exact"] = exact.as_ref().map_or(Value::Null, figures);
    row
}

fn parse_share(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(share) if share > 0.0 && share < 1.0 => Ok(share),
        _ => Err(format!("`{text}` is not a share above 0 and below 1")),
    }
}

fn parse_density(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(density) if density > 0.0 && density <= 1e12 => Ok(density),
        _ => Err(format!("`{text}` is not a density above 0")),
    }
}
