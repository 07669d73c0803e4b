//! The lines of a pixel's tree: what each one says, what it stands for, and where it lies.

use eframe::egui::Color32;
use glam::DVec3;

use super::inspector::Selection;
use super::outline::{lamp, shown, swatch};
use super::pixel::Face;
use crate::color::Rgb;
use crate::forest::tree::Branch;
use crate::scene::{Background, Scene};
use crate::session::inspect::{LampShare, Met, Share, TreeNode, Way};

/// One line of the tree.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Line {
    /// How many lines it stands below.
    pub(super) depth: usize,
    /// Index of the line of the node in front, of all but those of the eye's rays.
    pub(super) above: Option<usize>,
    pub(super) text: String,
    pub(super) color: Color32,
    /// What all below it adds too; `None` of what cannot add anything.
    pub(super) share: Option<Share>,
    /// How much of what leaves here reaches the pixel; of nodes alone.
    pub(super) weight: Option<Rgb>,
    /// More about it.
    pub(super) about: String,
    pub(super) target: Option<Target>,
    /// Where it lies, if it is a surface.
    pub(super) point: Option<DVec3>,
}

/// What a line or a bar stands for, by the indices of the scene that was traced.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Target {
    Surface { solid: u32, material: u16 },
    Material(u16),
    Light(u16),
    Background,
}

impl Target {
    /// What is to be selected in the scene of today: things are known by their names. `itself`: the
    /// solid, not its material.
    pub(super) fn selection(
        self,
        traced: &Scene,
        today: &Scene,
        itself: bool,
    ) -> Option<Selection> {
        let material = |i: u16| {
            let name = &traced.materials.get(usize::from(i))?.name;
            let today = today.materials.iter().position(|m| m.name == *name)?;
            Some(Selection::Material(today))
        };
        match self {
            Target::Surface { solid, material: _ } if itself => {
                let name = &traced.solids.get(solid as usize)?.name;
                let today = today.solids.iter().position(|s| s.name == *name)?;
                Some(Selection::Solid(today))
            }
            Target::Surface { solid: _, material: i } | Target::Material(i) => material(i),
            Target::Light(i) => {
                let name = &traced.lights.get(usize::from(i))?.name;
                let today = today.lights.iter().position(|l| l.name == *name)?;
                Some(Selection::Light(today))
            }
            Target::Background => Some(Selection::Scene),
        }
    }
}

impl Face {
    /// The points of the nodes from the eye's first to a line's own.
    pub(super) fn way_to(&self, line: usize) -> Vec<DVec3> {
        let mut points = Vec::new();
        let mut at = Some(line);
        while let Some(line) = at.and_then(|i| self.lines.get(i)) {
            points.extend(line.point);
            at = line.above;
        }
        points.reverse();
        points
    }
}

/// The lines of some nodes and of all below them.
pub(super) fn lines(scene: &Scene, nodes: &[TreeNode]) -> Vec<Line> {
    let mut lines = Vec::new();
    nodes.iter().for_each(|node| add(scene, node, (0, None), &mut lines));
    lines
}

/// A tree is at most 64 deep, and so is the recursion.
fn add(
    scene: &Scene,
    node: &TreeNode,
    (depth, above): (usize, Option<usize>),
    into: &mut Vec<Line>,
) {
    let own = into.len();
    into.push(node_line(scene, node, (depth, above)));
    let Met::Surface { solid, material } = node.met else { return };
    let target = Some(Target::Surface { solid, material });
    if node.itself != Share::default() {
        into.push(Line {
            depth: depth + 1,
            above: Some(own),
            text: "ambient light and glow".into(),
            color: shown(scene.ambient_light),
            share: Some(node.itself),
            weight: None,
            about: "What the surface glows by itself, and scatters of the ambient light".into(),
            target,
            point: None,
        });
    }
    for lamp in &node.lamps {
        into.push(Line { depth: depth + 1, above: Some(own), ..lamp_line(scene, lamp) });
    }
    node.below.iter().for_each(|node| add(scene, node, (depth + 1, Some(own)), into));
}

fn node_line(scene: &Scene, node: &TreeNode, (depth, above): (usize, Option<usize>)) -> Line {
    let way = match node.way {
        Way::Eye => "eye",
        Way::Reflection => "reflection",
        Way::TotalReflection => "total reflection",
        Way::Refraction => "refraction",
    };
    let hits = match node.hits {
        1 => String::new(),
        n => format!(" ×{n}"),
    };
    let line = Line {
        depth,
        above,
        text: String::new(),
        color: Color32::TRANSPARENT,
        share: Some(node.share),
        weight: Some(node.weight),
        about: String::new(),
        target: None,
        point: None,
    };
    match node.met {
        Met::Surface { solid, material } => {
            let (solid_name, material_name) =
                (&scene.solids[solid as usize].name, &scene.materials[usize::from(material)].name);
            let [x, y, z] = node.point.to_array();
            let [r, g, b] = node.weight.0;
            Line {
                text: format!("{way} → {solid_name} ({material_name}){hits}"),
                color: swatch(&scene.materials[usize::from(material)]),
                about: format!(
                    "Of what leaves {solid_name} here, {r:.4} {g:.4} {b:.4} (red green blue) reaches \
                     the pixel.\nIt lies at {x:.3} {y:.3} {z:.3}, {:.3} along its ray. A click shows \
                     its material, with Alt the solid",
                    node.distance
                ),
                target: Some(Target::Surface { solid, material }),
                point: Some(node.point),
                ..line
            }
        }
        Met::Background => Line {
            text: format!("{way} → background{hits}"),
            color: shown(sky(&scene.background)),
            about: "The ray left the scene. A click shows the background's parameters".into(),
            target: Some(Target::Background),
            ..line
        },
        Met::End(end) => Line {
            text: format!("{way} ends: {}{hits}", end_text(end)),
            share: None,
            about: "Nothing is added here".into(),
            ..line
        },
    }
}

fn lamp_line(scene: &Scene, share: &LampShare) -> Line {
    let LampShare { light, blocked, filters, share, highlight } = share;
    let known = scene.lights.get(usize::from(*light));
    let name = known.map_or("a light that is gone", |light| light.name.as_str());
    let names: Vec<_> =
        filters.iter().map(|&m| scene.materials[usize::from(m)].name.as_str()).collect();
    let text = match (blocked, names.as_slice()) {
        (true, names) => format!("light {name}: blocked by {}", names.join(", ")),
        (false, []) => format!("light {name}"),
        (false, names) => format!("light {name} through {}", names.join(", ")),
    };
    let part = match share.luminance() {
        0.0 => 0.0,
        whole => highlight.luminance() / whole * 100.0,
    };
    let about = match blocked {
        true => "An opaque surface stops its shadow ray. A click shows the light".to_owned(),
        false => format!("Of this, {part:.0} % is highlight. A click shows the light"),
    };
    Line {
        depth: 0,
        above: None,
        text,
        color: known.map_or(Color32::TRANSPARENT, lamp),
        share: (!blocked).then_some(*share),
        weight: None,
        about,
        target: known.map(|_| Target::Light(*light)),
        point: None,
    }
}

/// The colour that stands for a background.
pub(super) fn sky(background: &Background) -> Rgb {
    match background {
        Background::Color(color) => *color,
        Background::Gradient { level, .. } => *level,
        Background::Image { tint, .. } => *tint,
    }
}

fn end_text(end: Branch) -> &'static str {
    match end {
        Branch::Zero => "its factor is zero",
        Branch::Weight => "weight below trace.cutoff",
        Branch::Faint => "Fresnel leaves less than trace.cutoff",
        Branch::Depth => "trace.depth",
        Branch::Astray => "blurred to the wrong side",
        Branch::Grown | Branch::Missed | Branch::Absent => "nothing",
    }
}
