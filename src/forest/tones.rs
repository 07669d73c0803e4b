//! What textures, bumps and backgrounds give to the nodes of a tree.

use super::grow::Grower;
use super::sink::Sink;
use crate::geometry::{Interaction, Ray, Stack, Tone};

impl Grower<'_> {
    /// Bends the normal at a hit at the end of a path of this length, and gives what colours it in place
    /// of its slot.
    #[inline(always)]
    pub(super) fn tone(&self, stack: &Stack, at: &mut Interaction, length: f64) -> Option<Tone> {
        match self.geometry.is_plain() {
            true => None,
            false => self.geometry.finish(stack, at, self.cone.width(length)),
        }
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
