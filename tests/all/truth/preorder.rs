//! The trees read once more, by a reader of the tests' own, into plain recursive values.

use rayforest::film::layout::{LANES, Place, TILE_BLOCKS};
use rayforest::forest::tree::{BEHIND, BLOCKED, Branch, TileTrees, entries};
use rayforest::geometry::Tone;
use rayforest::progress::Progress;
use rayforest::session::Session;

/// A node with what grows from it.
pub(super) struct Tree {
    pub(super) t: f64,
    pub(super) primitive: u32,
    pub(super) material: usize,
    pub(super) slot: usize,
    /// What colours it in place of the slot.
    pub(super) tone: Option<Tone>,
    /// Fresnel's reflectance, if it weighs the branches.
    pub(super) fresnel: Option<f64>,
    /// Whether the mirror ray is that of total reflection.
    pub(super) total: bool,
    pub(super) lights: Vec<Lit>,
    pub(super) reflected: Limb,
    pub(super) transmitted: Limb,
}

/// A light before a surface.
pub(super) struct Lit {
    pub(super) light: usize,
    pub(super) n_dot_l: f64,
    /// 1 − cosine, or tan² α of Cook-Torrance's facets.
    pub(super) angle: f64,
    /// What multiplies the highlight; 0 if there is none.
    pub(super) weight: f64,
    /// The materials that the shadow ray crossed; `None`: something opaque stood in its way.
    pub(super) crossed: Option<Vec<usize>>,
}

/// What became of a branch.
pub(super) enum Limb {
    Grown(Box<Tree>),
    /// It saw the background: this of it, if that is not one colour.
    Missed(Option<Tone>),
    /// Not followed: its factor is zero, or a weight, or the depth limit, forbade it.
    Cut(Branch),
    Absent,
}

/// A pixel with one tree per sample; `None` where the sample's ray left the scene.
pub(super) struct PixelTrees {
    pub(super) pixel: [u32; 2],
    pub(super) samples: Vec<Option<Tree>>,
    /// What each counts; their mean is 1.
    pub(super) weights: Vec<f64>,
    /// Per sample what it saw of the background, if it left the scene and that is not one colour.
    pub(super) skies: Vec<Option<Tone>>,
}

/// The trees of every pixel of a session.
pub(super) fn pixels(session: &Session) -> Vec<PixelTrees> {
    let (layout, samples) = (session.transport().layout, session.transport().samples);
    let solids = &session.scene().solids;
    let materials: Vec<usize> = solids.iter().map(|solid| solid.material).collect();
    let mut list = Vec::new();
    for tile in 0..layout.tiles() {
        let trees = &session.trees(tile, &Progress::default()).expect("trees within the budget");
        let mut cursor = Cursor { trees, materials: &materials, at: Places::default() };
        for block in 0..TILE_BLOCKS {
            for lane in 0..LANES {
                if let Some(pixel) = layout.pixel(Place { tile, block, lane }) {
                    let weights = (0..samples as usize).map(|i| cursor.weight(i)).collect();
                    let (samples, skies) = (0..samples).map(|_| cursor.sample()).unzip();
                    list.push(PixelTrees { pixel, samples, weights, skies });
                }
            }
        }
        cursor.assert_at_end();
    }
    list
}

struct Cursor<'a> {
    trees: &'a TileTrees,
    /// Per solid.
    materials: &'a [usize],
    at: Places,
}

/// How much was read of every list.
#[derive(Debug, Default, PartialEq)]
struct Places {
    sample: usize,
    node: usize,
    light: usize,
    crossing: usize,
    tone: usize,
    sky: usize,
}

impl Cursor<'_> {
    /// The weight of the sample that comes so many later.
    fn weight(&self, later: usize) -> f64 {
        self.trees.weights.get(self.at.sample + later).map_or(1.0, |weight| f64::from(*weight))
    }

    fn sample(&mut self) -> (Option<Tree>, Option<Tone>) {
        self.at.sample += 1;
        match self.trees.hits[self.at.sample - 1] {
            true => (Some(self.tree()), None),
            false => (None, self.sky()),
        }
    }

    /// What the next ray saw that left the scene; `None` if all of them see one colour.
    fn sky(&mut self) -> Option<Tone> {
        let tone = *self.trees.skies.get(self.at.sky)?;
        self.at.sky += 1;
        Some(tone)
    }

    /// A tree is at most 64 branches deep, and so is the recursion.
    fn tree(&mut self) -> Tree {
        let node = self.trees.nodes[self.at.node];
        self.at.node += 1;
        let tone = node.toned.then(|| self.trees.tones[self.at.tone]);
        self.at.tone += usize::from(node.toned);
        let lights = (0..node.lights).filter_map(|_| self.lit()).collect();
        let reflected = self.limb(node.ends.reflected());
        let transmitted = self.limb(node.ends.transmitted());
        Tree {
            t: node.t,
            primitive: node.primitive,
            material: node.material.into(),
            slot: node.slot.into(),
            tone,
            fresnel: (node.fresnel >= 0.0).then_some(node.fresnel.into()),
            total: node.ends.total(),
            lights,
            reflected,
            transmitted,
        }
    }

    /// The next light; none where a ray had nothing to show.
    fn lit(&mut self) -> Option<Lit> {
        let hit = self.trees.lights[self.at.light];
        self.at.light += 1;
        let blocked = hit.crossed == BLOCKED;
        let count = entries(hit.crossed);
        let solids = &self.trees.crossings[self.at.crossing..][..count];
        self.at.crossing += count;
        let mut materials: Vec<usize> =
            solids.iter().map(|&solid| self.materials[solid as usize]).collect();
        materials.sort_unstable();
        let lit = Lit {
            light: hit.light.into(),
            n_dot_l: hit.n_dot_l.into(),
            angle: hit.angle.into(),
            weight: hit.weight.into(),
            crossed: (!blocked).then_some(materials),
        };
        (hit.crossed != BEHIND).then_some(lit)
    }

    fn limb(&mut self, branch: Branch) -> Limb {
        match branch {
            Branch::Grown => Limb::Grown(Box::new(self.tree())),
            Branch::Missed => Limb::Missed(self.sky()),
            Branch::Absent | Branch::Astray => Limb::Absent,
            Branch::Zero | Branch::Weight | Branch::Depth | Branch::Faint => Limb::Cut(branch),
        }
    }

    fn assert_at_end(&self) {
        let TileTrees { blocks: _, hits, weights, nodes, lights, crossings, tones, skies } =
            self.trees;
        assert!(weights.is_empty() || weights.len() == hits.len(), "weights of all samples");
        let end = Places {
            sample: hits.len(),
            node: nodes.len(),
            light: lights.len(),
            crossing: crossings.len(),
            tone: tones.len(),
            sky: skies.len(),
        };
        assert_eq!(self.at, end, "what was read of every list, and how much there is");
    }
}

impl Tree {
    /// The nodes of a tree whose every node has at most one branch grown, from the eye on.
    pub(super) fn chain(&self) -> Vec<&Tree> {
        let mut chain = vec![self];
        let mut at = self;
        loop {
            at = match (&at.reflected, &at.transmitted) {
                (Limb::Grown(_), Limb::Grown(_)) => panic!("a node with two branches"),
                (Limb::Grown(next), _) | (_, Limb::Grown(next)) => next,
                _ => return chain,
            };
            chain.push(at);
        }
    }

    /// Calls `visit` for every node.
    pub(super) fn each(&self, visit: &mut impl FnMut(&Tree)) {
        visit(self);
        for limb in [&self.reflected, &self.transmitted] {
            if let Limb::Grown(tree) = limb {
                tree.each(visit);
            }
        }
    }

    /// Whether a branch anywhere in the tree ended for this reason.
    pub(super) fn has_cut(&self, why: Branch) -> bool {
        let mut found = false;
        self.each(&mut |tree| {
            let cut = |limb: &Limb| matches!(limb, Limb::Cut(branch) if *branch == why);
            found |= cut(&tree.reflected) || cut(&tree.transmitted);
        });
        found
    }
}
