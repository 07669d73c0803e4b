//! A pixel's ray tree with what every node of it adds to the pixel: why it has its colour.

use std::collections::HashMap;
use std::sync::Arc;

use glam::DVec3;

use super::shares::{Pieces, Share, row};
use super::{InspectedLight, InspectedNode, Walk};
use crate::color::Rgb;
use crate::film::layout::Place;
use crate::forest::located::Located;
use crate::forest::tree::Branch;
use crate::progress::Progress;
use crate::scene::Scene;
use crate::scene::factor::{Factor, FactorValues, Kind};
use crate::scene::model::Peak;
use crate::session::Session;
use crate::session::trace::TraceError;

/// A pixel's trees, with shares that add up to the light that the picture holds.
#[derive(Clone, Debug, PartialEq)]
pub struct PixelTree {
    /// Which one, from the upper left corner.
    pub pixel: [u32; 2],
    /// What was traced; indices of solids, materials and lights are its own.
    pub scene: Arc<Scene>,
    /// The pixel's light, before exposure, bit for bit.
    pub light: Rgb,
    /// The tree of every sample.
    pub samples: Vec<TreeNode>,
}

/// By which ray a node was found.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Way {
    /// From the eye.
    Eye,
    /// The mirror ray.
    Reflection,
    /// The mirror ray, in total reflection.
    TotalReflection,
    /// The refracted ray.
    Refraction,
}

/// What a ray met.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Met {
    /// A surface.
    Surface {
        /// Index of the solid.
        solid: u32,
        /// Index of its material.
        material: u16,
    },
    /// Nothing: it shows the background.
    Background,
    /// It was not followed, or what it would show is black.
    End(Branch),
}

/// A node of one sample's tree, or of several samples' that met the same on the same way.
#[derive(Clone, Debug, PartialEq)]
pub struct TreeNode {
    /// By which ray it was found.
    pub way: Way,
    /// What is there.
    pub met: Met,
    /// How many samples' nodes it stands for.
    pub hits: u32,
    /// Where the first of them lies, in world space; 0 without a surface.
    pub point: DVec3,
    /// The length of the ray to it, world units; 0 without a surface.
    pub distance: f64,
    /// How much of the light that leaves it here reaches the pixel: the product of all factors of its
    /// way, of Fresnel's weights, and of the samples' shares of the pixel.
    pub weight: Rgb,
    /// What it glows by itself and scatters of the ambient light; of the background its light.
    pub itself: Share,
    /// What lamps add to it.
    pub lamps: Vec<LampShare>,
    /// Its own share with that of all below it.
    pub share: Share,
    /// What its rays found.
    pub below: Vec<TreeNode>,
}

/// The light of a lamp that a node sends towards the eye.
#[derive(Clone, Debug, PartialEq)]
pub struct LampShare {
    /// Index of the light.
    pub light: u16,
    /// Whether an opaque solid, of the one material in `filters`, stops it.
    pub blocked: bool,
    /// Materials of the surfaces that its shadow ray crossed, rising.
    pub filters: Vec<u16>,
    /// What it adds to the pixel.
    pub share: Share,
    /// The part of that which is highlight.
    pub highlight: Share,
}

impl TreeNode {
    /// What it adds without what is below it.
    pub fn own(&self) -> Share {
        self.itself + self.lamps.iter().map(|lamp| lamp.share).sum()
    }

    fn new(way: Way, met: Met, weight: Rgb) -> TreeNode {
        TreeNode {
            way,
            met,
            hits: 1,
            point: DVec3::ZERO,
            distance: 0.0,
            weight,
            itself: Share::default(),
            lamps: Vec::new(),
            share: Share::default(),
            below: Vec::new(),
        }
    }
}

/// Memory for the trees of one pixel.
const MOST_BYTES: usize = 1 << 26;

impl Session {
    /// Takes a pixel apart, as it is shaded now. Where trees were released, its own are grown again.
    ///
    /// # Panics
    /// If the pixel is outside the picture.
    pub fn inspect(&self, pixel: [u32; 2], progress: &Progress) -> Result<PixelTree, TraceError> {
        let place = self.transport.layout.place(pixel);
        let grower = self.grower();
        let mut located = Located::default();
        let kept = self.forest.tiles[place.tile].as_ref().map(|kept| kept.recall(place.block));
        let limits = (MOST_BYTES, progress);
        let grown = grower.one_pixel(&mut grower.worker(), place, kept, &mut located, limits);
        grown.map_err(|stop| TraceError::of(stop, MOST_BYTES))?;
        let (light, shares) = self.shares(place, &located);
        let mut walk = Walk::new(&located, &self.geometry, &self.scene);
        let values = FactorValues::new(&self.scene);
        let one = 1.0 / self.transport.samples as f32;
        let tree = |shares| {
            let (node, weight) = (walk.sample(), walk.reader.weight() * one);
            let planter = Planter { values: &values, lights: &self.names.lights, shares };
            planter.plant(node.as_ref(), weight)
        };
        let samples = shares.into_iter().map(tree).collect();
        Ok(PixelTree { pixel, scene: self.scene.clone(), light, samples })
    }

    /// The pixel's light, and per sample what its terms add, sorted by the way to the node.
    fn shares(&self, place: Place, located: &Located) -> (Rgb, Vec<ByPath>) {
        let Located { trees, points: _ } = located;
        let tile = &self.transport.tiles[place.tile];
        let (light, row) = row(tile, place, &self.terms.values);
        let factors = |(id, share)| (self.transport.trie.factors(id), share);
        let row: HashMap<Vec<Factor>, Share> = row.into_iter().map(factors).collect();
        let peaks: Vec<_> = self.scene.materials.iter().map(|m| Some(Peak::of(m))).collect();
        let weight = 1.0 / self.transport.samples as f32;
        let pieces = Pieces::fold(trees, &self.names, &peaks, weight);
        let by_path = |terms: Vec<(usize, Share)>| {
            let mut paths = ByPath::new();
            for (term, share) in terms {
                let factors = &pieces.terms[term];
                let steps = factors.iter().take_while(|factor| factor.is_path()).count();
                let (path, rest) = factors.split_at(steps);
                paths.entry(path.to_vec()).or_default().push((rest.to_vec(), share));
            }
            paths
        };
        (light, pieces.shared(&row).into_iter().map(by_path).collect())
    }
}

/// By the factors of the way to a node: the other factors of its terms, with their shares.
type ByPath = HashMap<Vec<Factor>, Vec<(Vec<Factor>, Share)>>;

/// Builds the tree of one sample: what rays met, joined with what its terms add.
struct Planter<'a> {
    values: &'a FactorValues,
    /// Per light its place in the list of factors.
    lights: &'a [u16],
    shares: ByPath,
}

impl Planter<'_> {
    fn plant(mut self, root: Option<&InspectedNode>, weight: f32) -> TreeNode {
        let weight = Rgb::grey(weight);
        match root {
            Some(node) => self.node(node, Way::Eye, &mut Vec::new(), weight),
            None => self.background(Way::Eye, &[], weight),
        }
    }

    fn background(&mut self, way: Way, path: &[Factor], weight: Rgb) -> TreeNode {
        let terms = self.shares.remove(path).unwrap_or_default();
        let share: Share = terms.into_iter().map(|(_, share)| share).sum();
        TreeNode { itself: share, share, ..TreeNode::new(way, Met::Background, weight) }
    }

    /// A node with all below it. A tree is at most 64 deep, and so is the recursion.
    fn node(
        &mut self,
        node: &InspectedNode,
        way: Way,
        path: &mut Vec<Factor>,
        weight: Rgb,
    ) -> TreeNode {
        let (solid, material) = (node.solid, node.material);
        let mut grown = TreeNode::new(way, Met::Surface { solid, material }, weight);
        (grown.point, grown.distance) = (node.point, node.t);
        node.lights.iter().for_each(|light| grown.light(light));
        for (rest, share) in self.shares.remove(&path[..]).unwrap_or_default() {
            self.give(&mut grown, &rest, share);
        }
        let (mirror, mirrored) = match node.total {
            true => (Kind::TotalReflect, Way::TotalReflection),
            false => (Kind::Reflect, Way::Reflection),
        };
        let sides = [
            (mirror, mirrored, &node.reflected, node.weights[0]),
            (Kind::Transmit, Way::Refraction, &node.transmitted, node.weights[1]),
        ];
        for (kind, way, (branch, child), by) in sides {
            let factor = Factor::new(kind, material, 0);
            let weight = weight * self.values.value(factor) * by;
            path.push(factor);
            grown.below.extend(match (branch, child) {
                (_, Some(child)) => Some(self.node(child, way, path, weight)),
                (Branch::Missed, None) => Some(self.background(way, path, weight)),
                // What a surface does not do at all is not worth a line.
                (Branch::Absent | Branch::Zero | Branch::Grown, None) => None,
                (end, None) => Some(TreeNode::new(way, Met::End(*end), weight)),
            });
            path.pop();
        }
        grown.share = grown.own() + grown.below.iter().map(|node| node.share).sum();
        grown
    }

    /// Adds what a term, of which these factors follow the way to the node, adds to the pixel.
    fn give(&self, node: &mut TreeNode, rest: &[Factor], share: Share) {
        let Some(first) = rest.first().filter(|first| first.kind() == Kind::Light) else {
            node.itself += share;
            return;
        };
        let light = self.lights.iter().position(|&place| usize::from(place) == first.index());
        let crossed = rest.iter().filter(|factor| factor.kind() == Kind::Shadow);
        let filters = crossed.map(|factor| factor.index() as u16).collect();
        let gloss = |f: &Factor| matches!(f.kind(), Kind::Specular | Kind::Through);
        let highlight = if rest.iter().any(gloss) { share } else { Share::default() };
        // The light of a lamp that is gone is black, and all of it is alike.
        let light = light.map_or(u16::MAX, |light| light as u16);
        node.lamp(LampShare { light, blocked: false, filters, share, highlight });
    }
}

impl TreeNode {
    /// Notes a light before the surface, whatever it adds.
    fn light(&mut self, light: &InspectedLight) {
        let nothing = Share::default();
        self.lamp(LampShare {
            light: light.light,
            blocked: light.blocked,
            filters: light.crossed.clone(),
            share: nothing,
            highlight: nothing,
        });
    }

    /// Adds to what is known of a lamp.
    fn lamp(&mut self, lamp: LampShare) {
        let LampShare { light, blocked, filters, share, highlight } = &lamp;
        let same =
            |l: &&mut LampShare| (l.light, l.blocked, &l.filters) == (*light, *blocked, filters);
        match self.lamps.iter_mut().find(same) {
            Some(known) => {
                known.share += *share;
                known.highlight += *highlight;
            }
            None => self.lamps.push(lamp),
        }
    }

    /// Adds a node that met the same on the same way.
    fn join(&mut self, other: TreeNode) {
        // They are the same, or, of where it lies, the first one's stay.
        let TreeNode {
            way: _,
            met: _,
            hits,
            point: _,
            distance: _,
            weight,
            itself,
            lamps,
            share,
            below,
        } = other;
        self.hits += hits;
        self.weight = self.weight + weight;
        self.itself += itself;
        self.share += share;
        lamps.into_iter().for_each(|lamp| self.lamp(lamp));
        self.below.extend(below);
    }
}

/// The nodes with those put together, on every level, that met the same on the same way; those that
/// add most come first.
pub fn merged(nodes: impl IntoIterator<Item = TreeNode>) -> Vec<TreeNode> {
    let mut together: Vec<TreeNode> = Vec::new();
    for node in nodes {
        match together.iter_mut().find(|n| (n.way, n.met) == (node.way, node.met)) {
            Some(known) => known.join(node),
            None => together.push(node),
        }
    }
    for node in &mut together {
        node.below = merged(std::mem::take(&mut node.below));
        let brightness = |lamp: &LampShare| lamp.share.luminance();
        node.lamps.sort_by(|a, b| brightness(b).total_cmp(&brightness(a)));
    }
    together.sort_by(|a, b| b.share.luminance().total_cmp(&a.share.luminance()));
    together
}

/// Where light comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Source {
    /// The lamp with this index.
    Lamp(u16),
    /// Ambient light, and what glows by itself.
    Ambient,
    /// The background.
    Background,
}

/// A pixel's light in three ways; each adds up to it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Bars {
    /// By the material of the surface that sends it on its way to the eye; `None`: the background.
    pub materials: Vec<(Option<u16>, Share)>,
    /// By where it comes from.
    pub sources: Vec<(Source, Share)>,
    /// By how many rays after the eye's it takes: 0 is seen directly.
    pub bounces: Vec<(usize, Share)>,
}

/// The light of nodes and all below them, by material, source and bounce: what adds most first,
/// bounces in order.
pub fn bars(nodes: &[TreeNode]) -> Bars {
    let mut bars = Bars::default();
    nodes.iter().for_each(|node| bars.add(node, 0));
    let brightest = |a: Share, b: Share| b.luminance().total_cmp(&a.luminance());
    bars.materials.sort_by(|a, b| brightest(a.1, b.1));
    bars.sources.sort_by(|a, b| brightest(a.1, b.1));
    bars.bounces.sort_by_key(|(bounce, _)| *bounce);
    bars
}

impl Bars {
    fn add(&mut self, node: &TreeNode, bounce: usize) {
        let (material, source) = match node.met {
            Met::Surface { solid: _, material } => (Some(material), Source::Ambient),
            Met::Background => (None, Source::Background),
            Met::End(_) => return,
        };
        let own = node.own();
        add_to(&mut self.materials, material, own);
        add_to(&mut self.bounces, bounce, own);
        if node.itself != Share::default() {
            add_to(&mut self.sources, source, node.itself);
        }
        for lamp in node.lamps.iter().filter(|lamp| !lamp.blocked) {
            add_to(&mut self.sources, Source::Lamp(lamp.light), lamp.share);
        }
        node.below.iter().for_each(|node| self.add(node, bounce + 1));
    }
}

fn add_to<K: PartialEq>(list: &mut Vec<(K, Share)>, key: K, share: Share) {
    match list.iter_mut().find(|(known, _)| *known == key) {
        Some((_, sum)) => *sum += share,
        None => list.push((key, share)),
    }
}
