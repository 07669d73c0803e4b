//! One pixel in detail: its ray trees, its terms, and each term's share of its light.

mod shares;
mod tree;

pub use shares::Share;
pub use tree::{Bars, LampShare, Met, PixelTree, Source, TreeNode, Way, bars, merged};

use glam::DVec3;

use super::pilots::Pilots;
use super::trace::TraceError;
use crate::color::Rgb;
use crate::film::layout::{LANES, Layout, TILE_BLOCKS};
use crate::film::pixels::PixelSet;
use crate::fold::{Folder, Names};
use crate::forest::grow::Grower;
use crate::forest::located::Located;
use crate::forest::tree::{BEHIND, BLOCKED, Branch, Reader, TileTrees};
use crate::geometry::Geometry;
use crate::progress::Progress;
use crate::scene::Scene;
use crate::scene::factor::{Factor, FactorValues};
use crate::scene::model::{Measure, Model, Peak};
use crate::shade::terms::{TermProgram, TermValues};

/// All that is known of a pixel.
pub struct Inspection {
    /// Its light, before exposure: the sum of all shares.
    pub light: Rgb,
    /// The trees of its samples.
    pub samples: Vec<Option<InspectedNode>>,
    /// Its terms, in the order of summation.
    pub terms: Vec<TermShare>,
}

/// A term and what it adds to the pixel.
pub struct TermShare {
    /// Its factors.
    pub factors: Vec<Factor>,
    /// The coefficient in front of it.
    pub coefficient: f32,
    /// Coefficient times value.
    pub share: Rgb,
}

/// A node with its branches.
pub struct InspectedNode {
    /// Where it lies, in world space.
    pub point: DVec3,
    /// Distance along the ray.
    pub t: f64,
    /// Index of the solid.
    pub solid: u32,
    /// Index of the material.
    pub material: u16,
    /// Slot of its paint.
    pub slot: u8,
    /// The lights before the surface.
    pub lights: Vec<InspectedLight>,
    /// The mirror ray's branch and node.
    pub reflected: (Branch, Option<Box<InspectedNode>>),
    /// The refracted ray's branch and node.
    pub transmitted: (Branch, Option<Box<InspectedNode>>),
    /// Whether the mirror ray carries the factor of total reflection.
    pub total: bool,
    /// Geometric weights of the mirror and the refracted ray.
    pub weights: [f32; 2],
}

/// A light and what its shadow ray met.
pub struct InspectedLight {
    /// Index of the light.
    pub light: u16,
    /// Whether an opaque solid, of the one material in `crossed`, stopped it.
    pub blocked: bool,
    /// N·L times the ray's share of the light.
    pub n_dot_l: f32,
    /// Which cosine the highlight depends on.
    pub base: Base,
    /// That cosine, 0 where there is no highlight.
    pub cosine: f32,
    /// Materials crossed.
    pub crossed: Vec<u16>,
}

/// What a highlight is a power, or a distribution, of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Base {
    /// R·V: Phong.
    Mirrored,
    /// N·H: all other models.
    Halfway,
    /// T·L: Hall's, of a light behind the surface.
    Through,
}

/// Memory for the trees of a pixel and its fifteen neighbours.
const MOST_BYTES: usize = 1 << 30;

/// Traces one pixel of a scene and takes it apart.
///
/// # Panics
/// If the pixel is outside the picture.
pub fn pixel(
    scene: &Scene,
    geometry: &Geometry,
    pixel: [u32; 2],
    progress: &Progress,
) -> Result<Inspection, TraceError> {
    let layout = Layout::new(scene.picture.size);
    let place = layout.place(pixel);
    let mut lanes = [0; TILE_BLOCKS];
    lanes[place.block] = layout.lanes(place.tile, place.block);
    let mut block = PixelSet::new(layout);
    block.add(place.tile, &lanes);
    let pilots = Pilots::trace((scene, &block), geometry, None, 0, progress)?;
    let grower = Grower::new(scene, geometry).with_map(pilots.map.as_deref());
    let mut located = Located::default();
    let at = (place.tile, place.block);
    let grown = grower.block(&mut grower.worker(), at, &mut located, MOST_BYTES, progress);
    grown.map_err(|stop| TraceError::of(stop, MOST_BYTES))?;
    let counts = grower.counts(at);
    let before = counts[..place.lane].iter().sum::<u32>();
    let mut walk = Walk::new(&located, geometry, scene);
    for _ in 0..before {
        walk.sample();
    }
    let samples_trees = (0..counts[place.lane]).map(|_| walk.sample()).collect();
    let names = Names::new(geometry.materials(), scene.lights.len());
    let (terms, light) = terms(scene, &located.trees, &counts, place.lane, &names);
    Ok(Inspection { light, samples: samples_trees, terms })
}

/// The terms of one lane of a block, and their sum.
fn terms(
    scene: &Scene,
    trees: &TileTrees,
    counts: &[u32; LANES],
    lane: usize,
    names: &Names,
) -> (Vec<TermShare>, Rgb) {
    let peaks: Vec<_> = scene.materials.iter().map(|m| Some(Peak::of(m))).collect();
    let mut folder = Folder::default();
    folder.begin_tile();
    folder.block(&mut trees.read(0), counts, names);
    let weight = 1.0 / scene.trace.samples as f32;
    let folded = folder.finish_tile(weight, &peaks);
    let mut values = TermValues::default();
    values.evaluate(&TermProgram::new(folded.trie), &FactorValues::new(scene));
    let block = folded.tile.block(0);
    let planes = block.entries.iter().zip(block.planes);
    let mut rows: Vec<_> = planes.map(|(&e, plane)| (e as usize, plane.0[lane])).collect();
    let dense = rows.len();
    let singles = block.singles.iter().filter(|s| s.lane() == lane);
    rows.extend(singles.map(|s| (s.entry(), s.coefficient)));
    let shares = rows.iter().map(|&(entry, coefficient)| {
        let id = folded.tile.terms[entry];
        let [r, g, b, _] = values.values[id as usize];
        let share = Rgb([r, g, b]) * coefficient;
        TermShare { factors: folded.trie.factors(id), coefficient, share }
    });
    let mut terms: Vec<TermShare> = shares.collect();
    let sum = |terms: &[TermShare]| terms.iter().fold(Rgb::BLACK, |sum, t| sum + t.share);
    let light = sum(&terms[..dense]) + sum(&terms[dense..]);
    terms.retain(|t| t.coefficient != 0.0);
    (terms, light)
}

/// Reads nodes in preorder and builds them into trees.
struct Walk<'a> {
    reader: Reader<'a>,
    points: std::slice::Iter<'a, DVec3>,
    geometry: &'a Geometry,
    scene: &'a Scene,
}

impl<'a> Walk<'a> {
    /// Begins at the first sample.
    fn new(located: &'a Located, geometry: &'a Geometry, scene: &'a Scene) -> Walk<'a> {
        let Located { trees, points } = located;
        Walk { reader: trees.read(0), points: points.iter(), geometry, scene }
    }

    /// The tree of the next sample, if its ray met the scene.
    fn sample(&mut self) -> Option<InspectedNode> {
        self.reader.sample().then(|| self.node())
    }

    /// The next tree. A tree is at most 64 deep, and so is the recursion.
    fn node(&mut self) -> InspectedNode {
        let node = self.reader.node();
        let point = *self.points.next().expect("a point of every node");
        let lights = (0..node.lights).filter_map(|_| self.light(node.material)).collect();
        let reflected = self.branch(node.ends.reflected());
        let transmitted = self.branch(node.ends.transmitted());
        InspectedNode {
            point,
            t: node.t,
            solid: self.geometry.solid(node.primitive),
            material: node.material,
            slot: node.slot,
            lights,
            reflected,
            transmitted,
            total: node.ends.total(),
            weights: node.weights(),
        }
    }

    fn branch(&mut self, branch: Branch) -> (Branch, Option<Box<InspectedNode>>) {
        let grown = branch == Branch::Grown;
        (branch, grown.then(|| Box::new(self.node())))
    }

    fn materials(&self, solids: &[u32]) -> Vec<u16> {
        let of_solids = self.geometry.materials();
        let mut materials: Vec<u16> = solids.iter().map(|&s| of_solids[s as usize]).collect();
        materials.sort_unstable();
        materials
    }

    /// The next light; none where a ray had nothing to show.
    fn light(&mut self, material: u16) -> Option<InspectedLight> {
        let (hit, crossed) = self.reader.light();
        if hit.crossed == BEHIND {
            return None;
        }
        let material = &self.scene.materials[material as usize];
        let base = match material.model {
            _ if hit.is_behind() => Base::Through,
            Model::Phong => Base::Mirrored,
            Model::Blinn | Model::CookTorrance | Model::Hall => Base::Halfway,
        };
        let cosine = match Peak::of(material).measure {
            _ if hit.weight == 0.0 => 0.0,
            Measure::Cosine => 1.0 - hit.angle,
            Measure::Tangent => 1.0 / (1.0 + hit.angle).sqrt(),
        };
        Some(InspectedLight {
            light: hit.light,
            blocked: hit.crossed == BLOCKED,
            n_dot_l: hit.n_dot_l,
            base,
            cosine,
            crossed: self.materials(crossed),
        })
    }
}
