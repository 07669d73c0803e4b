//! The trees of one pixel alone, with the point at which every node lies.

use fearless_simd::dispatch;
use glam::DVec3;

use super::grow::{Grower, Limits, Stop, Worker};
use super::kept::{Recall, Recalls};
use super::sink::{Side, Sink};
use super::tree::{LightHit, Node, TileTrees};
use crate::film::layout::Place;
use crate::geometry::Tone;
use crate::progress::Progress;

/// Trees and where their nodes lie. Written by `grow`, read by the inspector.
#[derive(Default)]
pub struct Located {
    /// The trees.
    pub trees: TileTrees,
    /// Per node its point in world space.
    pub points: Vec<DVec3>,
}

impl Sink for Located {
    fn bytes(&self) -> usize {
        self.trees.bytes() + size_of_val(&*self.points)
    }
    fn block(&mut self) {
        self.trees.block();
    }
    fn weigh(&mut self, weight: f32) {
        self.trees.weigh(weight);
    }
    fn sample(&mut self, hit: bool) {
        self.trees.sample(hit);
    }
    fn node(&mut self, node: Node) -> u32 {
        self.trees.node(node)
    }
    fn point(&mut self, point: DVec3) {
        self.points.push(point);
    }
    fn tone(&mut self, tone: Tone) {
        self.trees.tone(tone);
    }
    fn missed(&mut self, node: u32, side: Side) {
        self.trees.missed(node, side);
    }
    fn sky(&mut self, tone: Tone) {
        self.trees.sky(tone);
    }
    fn light(&mut self, hit: LightHit, crossed: &[u32]) {
        self.trees.light(hit, crossed);
    }
}

impl Grower<'_> {
    /// Grows the trees of one pixel, as if its block had no other: of kept trees of the block, if there
    /// are any, only those rays are cast of which they know nothing. Stops once there are more than
    /// `most` bytes.
    ///
    /// # Panics
    /// If the place holds no pixel.
    pub fn one_pixel(
        &self,
        worker: &mut Worker,
        place: Place,
        mut kept: Option<Recall<'_>>,
        into: &mut Located,
        (most, progress): (usize, &Progress),
    ) -> Result<(), Stop> {
        if let Some(kept) = &mut kept {
            for lane in (0..place.lane).filter(|&lane| self.has_pixel(Place { lane, ..place })) {
                let samples = kept.count(lane).unwrap_or(self.samples);
                (0..samples).for_each(|_| kept.skip_sample());
            }
        }
        let kept = &mut Recalls::from(kept);
        worker.pending.clear();
        into.block();
        let limits = Limits { most, progress };
        dispatch!(self.level, simd => self.pixel(simd, worker, place, kept, into, limits))
    }

    fn has_pixel(&self, place: Place) -> bool {
        self.layout.pixel(place).is_some()
    }
}
