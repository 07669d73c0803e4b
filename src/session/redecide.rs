//! Which pixels' first samples see something else after an edit: found in the matrix, without a ray.

use super::Session;
use super::plan::{Concern, Sought};
use crate::film::pixels::PixelSet;
use crate::forest::signature::LEVELS;
use crate::scene::change::Change;
use crate::scene::factor::{FactorValues, Kind};
use crate::scene::refine::Refine;
use crate::scene::{Paint, Scene};

impl Session {
    /// The pixels, if there are any, whose own samples may see something else in `scene` than what
    /// their numbers of samples were decided by: those and their neighbours are decided again. `concern`
    /// is what is grown again anyway, `asked` whether anything is.
    pub(super) fn unsettled(
        &mut self,
        scene: &Scene,
        change: &Change,
        concern: &Concern,
        asked: bool,
    ) -> Option<PixelSet> {
        let layout = self.transport.layout;
        self.map.as_ref()?;
        if scene.trace.refine == Refine::Contrast {
            let others = asked || change.terms || !change.refold.is_empty();
            return others.then(|| PixelSet::of_tiles(layout, 0..layout.tiles()));
        }
        let seen = self.seen_otherwise(scene, change, concern);
        if seen.is_nothing() {
            return None;
        }
        let mut set = PixelSet::new(layout);
        for found in seen.find(self) {
            set.add(found.tile, &found.lanes);
        }
        (!set.is_empty()).then_some(set)
    }

    /// What of `concern` shows in signatures, and what else does: branches that begin or cease to live,
    /// solids that begin or cease to be opaque, lights that are gone.
    fn seen_otherwise(&mut self, scene: &Scene, change: &Change, concern: &Concern) -> Concern {
        let depths = self.path_depths();
        let flips = if change.terms { self.flips(scene, change, &depths) } else { Vec::new() };
        let nodes = self.transport.trie.nodes();
        let flips_at = |id: usize| flips.get(id).copied().unwrap_or(false);
        let sought = |id: usize| concern.terms.get(id).copied().unwrap_or(Sought::No);
        let lights_gone = change.lights.len() != self.scene.lights.len();
        // Where an image is black, the matrix does not say which lights reach it.
        let shadows_differ = !concern.terms.is_empty()
            || (0..nodes.len()).any(|id| flips_at(id) && !nodes[id].factor.is_path());
        let is_image = |m: usize| matches!(self.scene.materials[m].paint, Paint::Image { .. });
        let mut terms = vec![Sought::No; nodes.len()];
        for (id, node) in nodes.iter().enumerate().skip(1) {
            let kind = node.factor.kind();
            let surface = kind == Kind::Ambient
                && (lights_gone || shadows_differ && is_image(node.factor.index()));
            let below = terms[node.parent as usize] != Sought::No;
            terms[id] = match sought(id) {
                Sought::No if below || surface || flips_at(id) => Sought::of(kind),
                known => known,
            };
        }
        let shows =
            |(id, &ends): (usize, &bool)| ends && is_seen(nodes[id].factor.kind(), depths[id]);
        let frontier = concern.frontier.iter().enumerate().map(shows).collect();
        Concern { layout: concern.layout, terms, unlisted: Vec::new(), frontier }
    }

    /// Per term how many branches its path has.
    pub(super) fn path_depths(&self) -> Vec<usize> {
        let nodes = self.transport.trie.nodes();
        let mut depths = vec![0; nodes.len()];
        for (id, node) in nodes.iter().enumerate().skip(1) {
            depths[id] = depths[node.parent as usize] + usize::from(node.factor.is_path());
        }
        depths
    }

    /// Per term whether signatures tell that its branch begins or ceases to live, or its solid to be
    /// opaque.
    fn flips(&mut self, scene: &Scene, change: &Change, depths: &[usize]) -> Vec<bool> {
        let old = FactorValues::new(&self.scene);
        let new = self.factors_after(scene, change);
        let [before, after] = [&old, &new].map(|values| self.terms.living(&self.program, values));
        let nodes = self.transport.trie.nodes().iter().enumerate();
        let flips = nodes.map(|(id, node)| {
            let (kind, factor) = (node.factor.kind(), node.factor);
            is_seen(kind, depths[id])
                && match kind {
                    Kind::Shadow => old.value(factor).is_black() != new.value(factor).is_black(),
                    _ => before[id] != after[id],
                }
        });
        flips.collect()
    }
}

/// Whether signatures tell what becomes of such a factor, at the end of a path of so many branches.
pub(super) fn is_seen(kind: Kind, depth: usize) -> bool {
    match kind {
        Kind::Shadow => depth < LEVELS,
        _ => depth <= LEVELS,
    }
}
