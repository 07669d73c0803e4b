//! A picture while some of its pixels are grown again: the finished ones exact, the others marked.

use std::sync::Arc;

use crate::film::Frame;
use crate::film::layout::{BLOCK, LANES, Layout, Place, TILE, TILE_BLOCKS};
use crate::film::plates::Region;
use crate::scene::Scene;
use crate::scene::change::Change;
use crate::session::Session;
use crate::session::plan::{Plan, PlanTile};
use crate::session::regrow::{Patch, Regrow};

/// What is shown of a plan that is carried out. Pixels that the plan does not name show the wanted
/// scene exactly; those that it names show a coarse picture of it, and one of sixteen is a mark,
/// until they are grown.
pub(super) struct Mending {
    pub(super) regrow: Arc<Regrow>,
    /// The scene shown: the wanted one, if it needs no other rays than the plan's.
    pub(super) scene: Arc<Scene>,
    patches: Vec<Patch>,
    /// Per tile the lanes of its blocks that are not final.
    pending: Vec<Option<Box<[u16; TILE_BLOCKS]>>>,
    frame: Arc<Frame>,
}

impl Mending {
    /// Begins a plan of `whole`: the tiles of the region first, then those nearest to the cursor, in
    /// pixels. Until a coarse picture of the plan's scene comes, the one before it stands in.
    pub(super) fn new(
        whole: &mut Session,
        scene: Arc<Scene>,
        mut plan: Plan,
        (region, cursor): (Option<Region>, Option<[f64; 2]>),
        before: Option<&Frame>,
    ) -> Mending {
        let layout = whole.transport().layout;
        if let Some(cursor) = cursor {
            plan.tiles.sort_by(|a, b| {
                let far = |tile: &PlanTile| distance2(layout, tile.tile, cursor);
                far(a).total_cmp(&far(b))
            });
        }
        if let Some(region) = region.and_then(|region| region.within(layout.size)) {
            let first = region.tiles(layout);
            plan.tiles.sort_by_key(|tile| !first.contains(&tile.tile));
        }
        let change = Change::between(whole.scene(), &scene);
        let regrow = Arc::new(whole.regrow(scene.clone(), &change, plan.clone()));
        let frame = Arc::new(Frame::new(layout.size));
        // Without lights that are elsewhere now the picture ahead would flash dark.
        let old = (before.is_none() && change.shadows).then(|| {
            whole.catch_up();
            whole.shared_frame()
        });
        let mut mending =
            Mending { regrow, scene: scene.clone(), patches: Vec::new(), pending: vec![], frame };
        mending.show(whole, scene, &plan, before.or(old.as_deref()));
        mending
    }

    /// How many pixels are not final.
    pub(super) fn pixels(&self) -> u64 {
        let tiles = self.pending.iter().flatten();
        tiles.flat_map(|lanes| lanes.iter()).map(|lanes| u64::from(lanes.count_ones())).sum()
    }

    /// The picture.
    pub(super) fn frame(&self) -> Arc<Frame> {
        self.frame.clone()
    }

    /// What was grown.
    pub(super) fn into_patches(self) -> Vec<Patch> {
        self.patches
    }

    /// Draws everything anew for a scene that `plan` brings `whole` to; the coarse picture stands in
    /// for what is not grown yet.
    pub(super) fn show(
        &mut self,
        whole: &mut Session,
        scene: Arc<Scene>,
        plan: &Plan,
        coarse: Option<&Frame>,
    ) {
        self.scene = scene;
        let layout = whole.transport().layout;
        self.pending = vec![None; layout.tiles()];
        for PlanTile { tile, lanes, rays: _ } in &plan.tiles {
            self.pending[*tile] = Some(lanes.clone());
        }
        let change = Change::between(whole.scene(), &self.scene);
        let is_planned = self.is_planned();
        let frame = Arc::make_mut(&mut self.frame);
        whole.draw_ahead(&self.scene, &change, frame);
        if !change.refold.is_empty() {
            // Highlights of another exponent are not drawn ahead.
            for (tile, lanes) in self.pending.iter_mut().enumerate() {
                *lanes = Some(Box::new(std::array::from_fn(|block| layout.lanes(tile, block))));
            }
        }
        if is_planned {
            for patch in &self.patches {
                patch.draw(&self.regrow, frame);
                forget(&mut self.pending, patch);
            }
        }
        self.mark(coarse);
    }

    /// Takes what was grown.
    pub(super) fn take(&mut self, patch: Patch) {
        if self.is_planned() {
            patch.draw(&self.regrow, Arc::make_mut(&mut self.frame));
            forget(&mut self.pending, &patch);
        }
        self.patches.push(patch);
    }

    /// Whether the scene shown is the plan's own. A patch holds whole blocks as the plan's scene has
    /// them: a later wish may want branches of theirs that it lacks, or name lights and materials
    /// otherwise, so that it is seen only when all are in place.
    fn is_planned(&self) -> bool {
        *self.scene == *self.regrow.scene
    }

    /// Draws the coarse picture, if there is one, and the marks into what is not final.
    pub(super) fn mark(&mut self, coarse: Option<&Frame>) {
        let layout = Layout::new(self.frame.size);
        let frame = Arc::make_mut(&mut self.frame);
        for (tile, lanes) in self.pending.iter().enumerate() {
            let Some(lanes) = lanes else { continue };
            for (block, &lanes) in lanes.iter().enumerate() {
                for lane in (0..LANES).filter(|lane| lanes >> lane & 1 != 0) {
                    let Some(pixel) = layout.pixel(Place { tile, block, lane }) else { continue };
                    draw_pending(frame, pixel, coarse);
                }
            }
        }
    }
}

fn forget(pending: &mut [Option<Box<[u16; TILE_BLOCKS]>>], patch: &Patch) {
    let Some(lanes) = &mut pending[patch.tile()] else { return };
    for (block, lanes) in lanes.iter_mut().enumerate() {
        if patch.blocks() >> block & 1 != 0 {
            *lanes = 0;
        }
    }
}

/// A pixel that is not final: of the coarse picture, or a mark. On a coarse picture, which looks
/// coarse, marks are faint.
fn draw_pending(frame: &mut Frame, [x, y]: [u32; 2], coarse: Option<&Frame>) {
    let [width, height] = frame.size;
    let at = (y as usize * width as usize + x as usize) * 4;
    if let Some(coarse) = coarse {
        let [w, h] = coarse.size;
        let [cx, cy] = [x * w / width, y * h / height];
        let from = (cy as usize * w as usize + cx as usize) * 4;
        frame.bytes[at..at + 4].copy_from_slice(&coarse.bytes[from..from + 4]);
    }
    if x % BLOCK == 1 && y % BLOCK == 1 {
        let contrast = if coarse.is_some() { 32 } else { 96 };
        for byte in &mut frame.bytes[at..at + 3] {
            *byte = if *byte < 128 { *byte + contrast } else { *byte - contrast };
        }
    }
}

/// Square of the distance between a tile's middle and a point.
fn distance2(layout: Layout, tile: usize, [x, y]: [f64; 2]) -> f64 {
    let columns = layout.grid()[0];
    let middle = |index: usize| (index as f64 + 0.5) * f64::from(TILE);
    let (dx, dy) = (middle(tile % columns) - x, middle(tile / columns) - y);
    dx * dx + dy * dy
}
