//! What textures, bumps and backgrounds give to the nodes of a tree.

use super::grow::Grower;
use super::sink::Sink;
use crate::geometry::{Interaction, Ray, Stack, Tone};

impl Grower<'_> {
    /// The hit at the end of a path of this length, its normal bent, and what colours it in place of its
    /// slot.
    #[inline(always)]
    pub(super) fn tone(
        &self,
        stack: &Stack,
        mut at: Interaction,
        length: f64,
    ) -> (Interaction, Option<Tone>) {
        if self.geometry.is_plain() {
            return (at, None);
        }
        let (bent, tone) = self.geometry.finish(stack, at, self.cone.width(length));
        if let Some(normal) = bent {
            (at.shading_normal, at.bumped) = (normal, true);
        }
        (at, tone)
    }

    /// Hands on what a ray saw that left the scene, if the background is not one colour.
    #[inline(always)]
    pub(super) fn sky<K: Sink>(&self, ray: &Ray, sink: &mut K) {
        if self.geometry.is_plain() {
            return;
        }
        if let Some(tone) = self.geometry.sky(ray.direction, self.cone.angle) {
            sink.sky(tone);
        }
    }
}
