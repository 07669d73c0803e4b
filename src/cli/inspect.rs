//! `rayforest inspect`: why is this pixel this colour.

use std::path::PathBuf;

use clap::Args;

use super::{Common, Failure, print, read_scene};
use crate::color::Rgb;
use crate::film::develop::{Development, code8};
use crate::forest::tree::Branch;
use crate::geometry::Geometry;
use crate::progress::Progress;
use crate::scene::Scene;
use crate::session::inspect::{Base, InspectedLight, InspectedNode, Inspection, pixel};

#[derive(Debug, Args)]
pub(crate) struct Inspect {
    /// A scene file.
    scene: PathBuf,
    /// The pixel, counted from the upper left corner, e.g. 640,360.
    #[arg(long, value_name = "X,Y", value_parser = parse_pixel)]
    pixel: [u32; 2],
    /// Show the trees of all samples, not of the first alone.
    #[arg(long)]
    all_samples: bool,
    #[command(flatten)]
    common: Common,
}

impl Inspect {
    pub(crate) fn run(self) -> Result<(), Failure> {
        let mut scene = read_scene(&self.scene)?;
        self.common.apply(&mut scene)?;
        let [w, h] = scene.picture.size;
        let [x, y] = self.pixel;
        if x >= w || y >= h {
            let message =
                format!("--pixel {x},{y} is outside the picture: 0,0 … {},{}", w - 1, h - 1);
            return Err(Failure::input(message));
        }
        let progress = Progress::default();
        let cancelled = |_| Failure::job("cancelled");
        let geometry = Geometry::build(&scene, &progress).map_err(cancelled)?;
        let inspection = pixel(&scene, &geometry, self.pixel, &progress).map_err(Failure::job)?;
        let shown = if self.all_samples { inspection.samples.len() } else { 1 };
        for (number, tree) in inspection.samples.iter().enumerate().take(shown) {
            print(&format!("sample {} of {}", number + 1, inspection.samples.len()));
            match tree {
                Some(node) => print_node(&scene, node, "eye ray", 1),
                None => print("  eye ray → background"),
            }
        }
        print_terms(&scene, &inspection);
        Ok(())
    }
}

fn print_terms(scene: &Scene, inspection: &Inspection) {
    let [r, g, b] = code8(inspection.light, Development::of(&scene.picture));
    let samples = inspection.samples.len();
    print(&format!("shown: sRGB {r} {g} {b}, #{r:02X}{g:02X}{b:02X}; {samples} samples"));
    print("terms: coefficient, light added (red green blue), share of the pixel, product");
    let whole = luminance(inspection.light);
    for term in &inspection.terms {
        let names: Vec<_> = term.factors.iter().map(|f| f.describe(scene)).collect();
        let share = if whole > 0.0 { luminance(term.share) / whole * 100.0 } else { 0.0 };
        print(&format!(
            "  {:9.6}  {}  {share:5.1} %  {}",
            term.coefficient,
            text(term.share),
            names.join(" · ")
        ));
    }
    print(&format!("pixel: {} linear, before exposure", text(inspection.light)));
}

fn print_node(scene: &Scene, node: &InspectedNode, by: &str, depth: usize) {
    let indent = "  ".repeat(depth);
    let [x, y, z] = node.point.to_array();
    let (solid, material) =
        (&scene.solids[node.solid as usize], &scene.materials[node.material as usize]);
    print(&format!(
        "{indent}{by} → solid {}, material {}, slot {}, distance {:.6}, at {x:.6} {y:.6} {z:.6}",
        solid.name, material.name, node.slot, node.t
    ));
    for light in &node.lights {
        print(&format!("{indent}  {}", light_text(scene, light)));
    }
    let mirror = if node.total { "total reflection" } else { "reflection" };
    for (name, (branch, child)) in [(mirror, &node.reflected), ("refraction", &node.transmitted)] {
        match (branch, child) {
            (_, Some(child)) => print_node(scene, child, name, depth + 1),
            (Branch::Absent, None) => {}
            (branch, None) => print(&format!("{indent}  {name} {}", end_text(*branch))),
        }
    }
}

fn light_text(scene: &Scene, light: &InspectedLight) -> String {
    let name = &scene.lights[light.light as usize].name;
    let materials: Vec<_> =
        light.crossed.iter().map(|&m| scene.materials[m as usize].name.as_str()).collect();
    if light.blocked {
        return format!("light {name}: blocked by {}", materials.join(", "));
    }
    let through = match materials.as_slice() {
        [] => String::new(),
        names => format!(", through {}", names.join(", ")),
    };
    let base = match light.base {
        Base::Mirrored => "R·V",
        Base::Halfway => "N·H",
        Base::Through => "T·L",
    };
    format!("light {name}: N·L {:.4}, {base} {:.4}{through}", light.n_dot_l, light.cosine)
}

fn end_text(branch: Branch) -> &'static str {
    match branch {
        Branch::Missed => "→ background",
        Branch::Zero => "ends: its factor is zero",
        Branch::Weight => "ends: weight below trace.cutoff",
        Branch::Faint => "ends: Fresnel leaves less than trace.cutoff",
        Branch::Depth => "ends: trace.depth",
        Branch::Astray => "is black: the blurred ray went to the wrong side of the surface",
        Branch::Grown | Branch::Absent => "",
    }
}

fn luminance(light: Rgb) -> f32 {
    let [r, g, b] = light.0;
    0.2126 * r + 0.7152 * g + 0.0722 * b
}

fn text(light: Rgb) -> String {
    let [r, g, b] = light.0;
    format!("{r:9.6} {g:9.6} {b:9.6}")
}

fn parse_pixel(text: &str) -> Result<[u32; 2], String> {
    let parts = text
        .split_once(',')
        .and_then(|(x, y)| Some([x.trim().parse().ok()?, y.trim().parse().ok()?]));
    parts.ok_or_else(|| format!("`{text}` is not a pixel such as 640,360"))
}
