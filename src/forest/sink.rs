//! What receives trees as they are grown.

use glam::DVec3;

use super::tree::{LightHit, Node};
use crate::geometry::Tone;

/// Which branch of a node.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// The mirror ray.
    Reflected,
    /// The refracted ray.
    Transmitted,
}

/// What receives the trees: storage, or nothing, so that tracing with and without keeping is the
/// same code. Nodes arrive in preorder, a node's lights right after it.
pub trait Sink {
    /// Bytes that it holds.
    fn bytes(&self) -> usize;
    /// A block of 16 pixels begins.
    fn block(&mut self);
    /// The weight of the sample that begins next; said of none or of all.
    fn weigh(&mut self, weight: f32);
    /// A sample begins; whether its ray met the scene.
    fn sample(&mut self, hit: bool);
    /// A node; gives the name by which [`Sink::missed`] refers to it.
    fn node(&mut self, node: Node) -> u32;
    /// Where the last node lies, in world space: of no use to most.
    #[inline(always)]
    fn point(&mut self, _: DVec3) {}
    /// What colours the last node in place of its slot.
    fn tone(&mut self, tone: Tone);
    /// The ray of this branch of a node left the scene.
    fn missed(&mut self, node: u32, side: Side);
    /// What the last ray that left the scene saw of a background that is not one colour.
    fn sky(&mut self, tone: Tone);
    /// A light in front of the last node.
    fn light(&mut self, hit: LightHit, crossed: &[u32]);
}

/// Drops what it is given.
pub struct Discard;

impl Sink for Discard {
    #[inline(always)]
    fn bytes(&self) -> usize {
        0
    }
    fn block(&mut self) {}
    fn weigh(&mut self, _: f32) {}
    #[inline(always)]
    fn sample(&mut self, _: bool) {}
    #[inline(always)]
    fn node(&mut self, _: Node) -> u32 {
        0
    }
    #[inline(always)]
    fn missed(&mut self, _: u32, _: Side) {}
    #[inline(always)]
    fn tone(&mut self, _: Tone) {}
    #[inline(always)]
    fn sky(&mut self, _: Tone) {}
    #[inline(always)]
    fn light(&mut self, _: LightHit, _: &[u32]) {}
}
