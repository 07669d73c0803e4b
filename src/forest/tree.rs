//! Ray trees as flat arrays: nodes in preorder, the light that reached them, what shadows crossed.

use super::sink::{Side, Sink};
use crate::geometry::Tone;

/// What became of a branch of a node.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Branch {
    /// Its node follows in preorder.
    Grown,
    /// The ray left the scene: it shows the background.
    Missed,
    /// Frontier: its factor is zero.
    Zero,
    /// Frontier: its parameter weight, which follows from the factors of its path, is below the
    /// cut-off.
    Weight,
    /// Frontier: the depth limit.
    Depth,
    /// There is no such ray: nothing is refracted in total reflection.
    Absent,
    /// Frontier: its geometric weight, a product of Fresnel's reflectances, is below the cut-off,
    /// whatever the parameters are.
    Faint,
    /// There is no such ray: the direction drawn from the lobe of a blurred one lies on the wrong
    /// side of the surface. It counts as black.
    Astray,
}

const BRANCHES: [Branch; 8] = [
    Branch::Grown,
    Branch::Missed,
    Branch::Zero,
    Branch::Weight,
    Branch::Depth,
    Branch::Absent,
    Branch::Faint,
    Branch::Astray,
];

/// Both branches of a node in a byte: the reflected one in bits 0…2, the transmitted one in bits
/// 3…5, bit 6 set in total reflection, bit 7 if the surface was searched for. `0b0_010_000`: reflected
/// grown, transmitted `Zero`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Ends(u8);

impl Ends {
    /// Packs both branches.
    pub fn new(reflected: Branch, transmitted: Branch, total: bool) -> Ends {
        Ends(reflected as u8 | (transmitted as u8) << 3 | u8::from(total) << 6)
    }

    /// The ends with these bits, or `None` if no ends have them.
    pub fn from_bits(bits: u8) -> Option<Ends> {
        // Three bits name each of the eight branches; the other two say yes or no.
        Some(Ends(bits))
    }

    /// The bits, for files.
    pub fn bits(self) -> u8 {
        self.0
    }

    /// The mirror ray's branch.
    #[inline(always)]
    pub fn reflected(self) -> Branch {
        BRANCHES[(self.0 & 7) as usize]
    }

    /// The refracted ray's branch.
    #[inline(always)]
    pub fn transmitted(self) -> Branch {
        BRANCHES[(self.0 >> 3 & 7) as usize]
    }

    /// The same with another branch on this side.
    #[inline(always)]
    pub fn with(self, side: Side, branch: Branch) -> Ends {
        match side {
            Side::Reflected => Ends::new(branch, self.transmitted(), self.total()),
            Side::Transmitted => Ends::new(self.reflected(), branch, self.total()),
        }
        .found(self.searched())
    }

    /// The same of a surface that was found by looking at all crossings of its ray, or not.
    #[inline(always)]
    pub fn found(self, searched: bool) -> Ends {
        Ends(self.0 & 127 | u8::from(searched) << 7)
    }

    /// Whether all crossings of the ray were looked at: surfaces coincide there, or some were passed.
    /// Then that is done again where kept trees answer.
    #[inline(always)]
    pub fn searched(self) -> bool {
        self.0 & 128 != 0
    }

    /// Whether the mirror ray carries the factor of total reflection.
    #[inline(always)]
    pub fn total(self) -> bool {
        self.0 & 64 != 0
    }
}

/// A point where a ray of the seen path met a surface: 24 bytes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Node {
    /// Distance along the ray, world units.
    pub t: f64,
    /// The primitive of the geometry that was met.
    pub primitive: u32,
    /// Its material.
    pub material: u16,
    /// Number of [`LightHit`]s that belong to this node.
    pub lights: u16,
    /// Slot of the material's paint at the point.
    pub slot: u8,
    /// Whether what it shows of itself is to be folded too; otherwise only its lights and branches.
    pub whole: bool,
    /// Whether a [`Tone`] colours it in place of the slot.
    pub toned: bool,
    /// What became of its branches.
    pub ends: Ends,
    /// Fresnel's reflectance F, or [`NO_FRESNEL`].
    pub fresnel: f32,
}

/// [`Node::fresnel`] of a material whose branches are not weighted.
pub const NO_FRESNEL: f32 = -1.0;

impl Node {
    /// Geometric weights of the mirror and the refracted ray: F and 1 − F, or both 1.
    #[inline(always)]
    pub fn weights(&self) -> [f32; 2] {
        weights(self.fresnel)
    }
}

/// [`Node::weights`] of a node with this reflectance.
#[inline(always)]
pub fn weights(fresnel: f32) -> [f32; 2] {
    if fresnel == NO_FRESNEL { [1.0; 2] } else { [fresnel, 1.0 - fresnel] }
}

/// A light in front of a node's geometric surface, or, in Hall's model, behind it, and what its
/// shadow ray met: 16 bytes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightHit {
    /// Index of the light.
    pub light: u16,
    /// How many entries of `crossings` belong to it; or [`BLOCKED`], or [`BEHIND`].
    pub crossed: u16,
    /// N·L with the shading normal, times the ray's share of the light: may be ≤ 0 where normals are
    /// smoothed; 0 for a light behind.
    pub n_dot_l: f32,
    /// [`Lobe::angle`](super::lobe::Lobe) of the highlight.
    pub angle: f32,
    /// [`Lobe::weight`](super::lobe::Lobe) of the highlight times the same share, 0 if there is none.
    pub weight: f32,
}

impl LightHit {
    /// A light whose shadow ray an opaque solid stopped.
    pub fn stopped(light: u16) -> LightHit {
        LightHit { light, crossed: BLOCKED, n_dot_l: 0.0, angle: 1.0, weight: 0.0 }
    }

    /// A ray that has nothing to show, beside others to the same light that have.
    pub fn idle(light: u16) -> LightHit {
        LightHit { crossed: BEHIND, ..LightHit::stopped(light) }
    }

    /// Whether it is the transmitted highlight of a light behind the surface.
    #[inline(always)]
    pub fn is_behind(&self) -> bool {
        self.n_dot_l <= 0.0 && self.weight > 0.0
    }
}

/// [`LightHit::crossed`] of a shadow ray that an opaque solid stopped: one entry, the witness.
pub const BLOCKED: u16 = u16::MAX;
/// [`LightHit::crossed`] of a ray that was not cast, because it has nothing to show, beside others to
/// the same light that were: no entry.
pub const BEHIND: u16 = u16::MAX - 1;

/// How many entries of `crossings` belong to a record with this [`LightHit::crossed`].
#[inline(always)]
pub fn entries(crossed: u16) -> usize {
    match crossed {
        BLOCKED => 1,
        BEHIND => 0,
        count => count as usize,
    }
}

/// The trees of one tile, in the order of its pixels and their samples.
///
/// # Invariants ([`TileTrees::validate`])
/// Nodes of a sample stand in preorder, the reflected branch before the transmitted one; a node's
/// lights stand in the order of the nodes and of the scene's lights; crossings in the order of the
/// lights; tones in the order of the nodes that have one. Every ray that left the scene has a tone of
/// the sky, in the order in which they were followed, or none has. Written by `grow`, read by `fold` and the inspector; [`KeptTrees`](super::kept::KeptTrees)
/// are what stays of them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TileTrees {
    /// Where each of the tile's 64 blocks begins.
    pub blocks: Vec<Start>,
    /// Per sample, whether its ray met the scene.
    pub hits: Vec<bool>,
    /// Per sample its weight; empty if that of every one is 1.
    pub weights: Vec<f32>,
    /// Nodes of all samples.
    pub nodes: Vec<Node>,
    /// Light records of all nodes.
    pub lights: Vec<LightHit>,
    /// Solids that shadow rays crossed, or witnesses that stopped them.
    pub crossings: Vec<u32>,
    /// What colours nodes that show no single slot.
    pub tones: Vec<Tone>,
    /// What rays saw that left the scene, if the background is not one colour.
    pub skies: Vec<Tone>,
}

/// A position in all arrays of a [`TileTrees`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Start {
    /// Index into `hits`.
    pub sample: u32,
    /// Index into `nodes`.
    pub node: u32,
    /// Index into `lights`.
    pub light: u32,
    /// Index into `crossings`.
    pub crossing: u32,
    /// Index into `tones`.
    pub tone: u32,
    /// Index into `skies`.
    pub sky: u32,
}

impl TileTrees {
    /// Empties it and keeps its memory.
    pub fn clear(&mut self) {
        let TileTrees { blocks, hits, weights, nodes, lights, crossings, tones, skies } = self;
        tones.clear();
        skies.clear();
        blocks.clear();
        hits.clear();
        weights.clear();
        nodes.clear();
        lights.clear();
        crossings.clear();
    }

    /// Allocated bytes of all arrays.
    pub fn bytes(&self) -> usize {
        let TileTrees { blocks, hits, weights, nodes, lights, crossings, tones, skies } = self;
        blocks.capacity() * size_of::<Start>()
            + hits.capacity()
            + weights.capacity() * 4
            + nodes.capacity() * size_of::<Node>()
            + lights.capacity() * size_of::<LightHit>()
            + crossings.capacity() * 4
            + (tones.capacity() + skies.capacity()) * size_of::<Tone>()
    }

    /// Bytes of what is stored, without room for more.
    pub fn used_bytes(&self) -> usize {
        let TileTrees { blocks, hits, weights, nodes, lights, crossings, tones, skies } = self;
        size_of_val(&**blocks)
            + hits.len()
            + size_of_val(&**weights)
            + size_of_val(&**nodes)
            + size_of_val(&**lights)
            + size_of_val(&**crossings)
            + size_of_val(&**tones)
            + size_of_val(&**skies)
    }

    /// A reader that begins at a block.
    pub fn read(&self, block: usize) -> Reader<'_> {
        Reader { trees: self, at: self.blocks[block] }
    }

    /// Checks every invariant.
    ///
    /// # Panics
    /// With what is wrong.
    pub fn validate(&self, materials: usize, solids: usize, lights: usize) {
        assert!([0, self.hits.len()].contains(&self.weights.len()), "a weight per sample");
        let mut reader = Reader { trees: self, at: Start::default() };
        for (i, &hit) in self.hits.iter().enumerate() {
            if let Some(block) = self.blocks.iter().find(|b| b.sample as usize == i) {
                assert_eq!(*block, reader.at, "a block starts elsewhere than its samples");
            }
            reader.at.sample += 1;
            let mut open = usize::from(hit);
            let mut missed = usize::from(!hit);
            while open > 0 {
                let node = reader.node();
                assert!(node.t > 0.0 && node.t.is_finite(), "distance {}", node.t);
                if node.toned {
                    validate_tone(reader.tone());
                }
                assert!((node.material as usize) < materials, "material {}", node.material);
                let ends = node.ends;
                let known = (0.0..=1.0).contains(&node.fresnel) || node.fresnel == NO_FRESNEL;
                assert!(known, "reflectance {}", node.fresnel);
                assert_eq!(ends.total(), ends.transmitted() == Branch::Absent, "total reflection");
                assert_ne!(ends.reflected(), Branch::Absent, "every node has a mirror ray");
                let children = [ends.reflected(), ends.transmitted()];
                open += children.iter().filter(|&&b| b == Branch::Grown).count();
                open -= 1;
                missed += children.iter().filter(|&&b| b == Branch::Missed).count();
                let mut previous = None;
                for _ in 0..node.lights {
                    let (hit, crossed) = reader.light();
                    // A light has as many records as rays.
                    assert!(previous <= Some(hit.light), "lights out of order");
                    assert!((hit.light as usize) < lights, "light {}", hit.light);
                    assert!(crossed.iter().all(|&s| (s as usize) < solids), "crossed solid");
                    let finite = hit.n_dot_l.is_finite() && hit.angle.is_finite();
                    assert!(finite && hit.angle >= 0.0, "cosines of {hit:?}");
                    assert!(hit.weight >= 0.0 && hit.weight.is_finite(), "weight of {hit:?}");
                    previous = Some(hit.light);
                }
            }
            (0..missed).filter_map(|_| reader.sky()).for_each(validate_tone);
        }
        let end = reader.at;
        assert_eq!(end.node as usize, self.nodes.len(), "nodes left over");
        assert_eq!(end.light as usize, self.lights.len(), "lights left over");
        assert_eq!(end.crossing as usize, self.crossings.len(), "crossings left over");
        assert_eq!(end.tone as usize, self.tones.len(), "tones left over");
        assert_eq!(end.sky as usize, self.skies.len(), "skies left over");
    }
}

fn validate_tone(tone: Tone) {
    match tone {
        Tone::Blend { slot: _, share } => assert!((0.0..=1.0).contains(&share), "{tone:?}"),
        Tone::Texel(texel) => {
            assert!(texel.0.iter().all(|c| *c >= 0.0 && c.is_finite()), "{tone:?}");
        }
    }
}

/// Reads a tile's trees in order.
pub struct Reader<'a> {
    trees: &'a TileTrees,
    at: Start,
}

impl<'a> Reader<'a> {
    /// Whether samples have weights of their own.
    pub fn is_weighted(&self) -> bool {
        !self.trees.weights.is_empty()
    }

    /// The weight of the present sample.
    #[inline(always)]
    pub fn weight(&self) -> f32 {
        let weights = &self.trees.weights;
        weights.get(self.at.sample.wrapping_sub(1) as usize).copied().unwrap_or(1.0)
    }

    /// Whether the next sample's ray met the scene; its nodes follow.
    #[inline(always)]
    pub fn sample(&mut self) -> bool {
        self.at.sample += 1;
        self.trees.hits[self.at.sample as usize - 1]
    }

    /// The next node; its lights follow.
    #[inline(always)]
    pub fn node(&mut self) -> &'a Node {
        self.at.node += 1;
        &self.trees.nodes[self.at.node as usize - 1]
    }

    /// The tone of the present node, which has one.
    pub fn tone(&mut self) -> Tone {
        self.at.tone += 1;
        self.trees.tones[self.at.tone as usize - 1]
    }

    /// Whether the background is one colour: then rays that left the scene have no tone.
    #[inline(always)]
    pub fn is_sky_even(&self) -> bool {
        self.trees.skies.is_empty()
    }

    /// The tone of the next ray that left the scene, in the order in which branches are followed: what
    /// a node reflects, with all below it, before what it transmits. `None` if the background is one
    /// colour.
    pub fn sky(&mut self) -> Option<Tone> {
        if self.is_sky_even() {
            return None;
        }
        self.at.sky += 1;
        Some(self.trees.skies[self.at.sky as usize - 1])
    }

    /// The next light of the present node, with the solids crossed, or the one that blocked it.
    #[inline(always)]
    pub fn light(&mut self) -> (&'a LightHit, &'a [u32]) {
        let hit = &self.trees.lights[self.at.light as usize];
        let from = self.at.crossing as usize;
        let count = entries(hit.crossed);
        self.at.light += 1;
        self.at.crossing += count as u32;
        (hit, &self.trees.crossings[from..from + count])
    }
}

impl Sink for TileTrees {
    fn block(&mut self) {
        self.blocks.push(Start {
            sample: self.hits.len() as u32,
            node: self.nodes.len() as u32,
            light: self.lights.len() as u32,
            crossing: self.crossings.len() as u32,
            tone: self.tones.len() as u32,
            sky: self.skies.len() as u32,
        });
    }

    #[inline(always)]
    fn bytes(&self) -> usize {
        self.used_bytes()
    }

    fn weigh(&mut self, weight: f32) {
        self.weights.push(weight);
    }

    #[inline(always)]
    fn sample(&mut self, hit: bool) {
        self.hits.push(hit);
    }

    #[inline(always)]
    fn node(&mut self, node: Node) -> u32 {
        self.nodes.push(node);
        self.nodes.len() as u32 - 1
    }

    #[inline(always)]
    fn missed(&mut self, parent: u32, side: Side) {
        let ends = &mut self.nodes[parent as usize].ends;
        *ends = ends.with(side, Branch::Missed);
    }

    fn tone(&mut self, tone: Tone) {
        self.tones.push(tone);
    }

    fn sky(&mut self, tone: Tone) {
        self.skies.push(tone);
    }

    #[inline(always)]
    fn light(&mut self, hit: LightHit, crossed: &[u32]) {
        self.lights.push(hit);
        self.crossings.extend_from_slice(crossed);
        let last = self.nodes.len() - 1;
        self.nodes[last].lights += 1;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn small() -> TileTrees {
        let mut trees = TileTrees::default();
        trees.block();
        trees.sample(true);
        let node = Node {
            t: 1.0,
            primitive: 0,
            material: 0,
            lights: 0,
            slot: 0,
            whole: true,
            toned: false,
            ends: Ends::new(Branch::Grown, Branch::Zero, false),
            fresnel: NO_FRESNEL,
        };
        trees.node(node);
        let lit = LightHit { light: 0, crossed: 2, n_dot_l: 0.5, angle: 0.25, weight: 1.0 };
        trees.light(lit, &[0, 1]);
        trees.node(Node { ends: Ends::new(Branch::Zero, Branch::Grown, false), ..node });
        trees.node(Node { ends: Ends::new(Branch::Grown, Branch::Absent, true), ..node });
        trees.missed(2, Side::Reflected);
        trees.sample(false);
        trees
    }

    #[test]
    fn branches_pack_and_unpack() {
        for a in BRANCHES {
            for b in BRANCHES {
                for total in [false, true] {
                    let ends = Ends::new(a, b, total);
                    assert_eq!((ends.reflected(), ends.transmitted(), ends.total()), (a, b, total));
                    assert_eq!(Ends::from_bits(ends.bits()), Some(ends));
                    let found = ends.found(true);
                    assert!(found.searched() && !ends.searched());
                    let taken = found.with(Side::Reflected, Branch::Zero).found(false);
                    assert!(!taken.searched());
                    assert!(found.with(Side::Reflected, Branch::Zero).searched());
                }
            }
        }
        let sound = (0..=255).filter(|bits| Ends::from_bits(*bits).is_some()).count();
        assert_eq!(sound, 4 * BRANCHES.len() * BRANCHES.len());
        assert_eq!(size_of::<Node>(), 24);
        assert_eq!(size_of::<LightHit>(), 16);
    }

    #[test]
    fn a_sound_tile_validates() {
        small().validate(2, 2, 1);
    }

    #[test]
    #[should_panic(expected = "nodes left over")]
    fn a_lost_branch_is_found() {
        let mut trees = small();
        trees.nodes[0].ends = Ends::new(Branch::Zero, Branch::Zero, false);
        trees.validate(2, 2, 1);
    }

    #[test]
    #[should_panic(expected = "crossed solid")]
    fn an_unknown_solid_is_found() {
        let mut trees = small();
        trees.crossings[1] = 7;
        trees.validate(2, 2, 1);
    }
}
