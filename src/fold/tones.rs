//! Folds what a palette mixes or an image tints: several terms in place of one.

use super::Folder;
use super::lists::HighlightSample;
use crate::color::Rgb;
use crate::forest::tree::{LightHit, Node, Reader};
use crate::geometry::Tone;
use crate::scene::factor::{Factor, Kind};

/// The slot of an image's factor that its texels multiply.
const TINTED: u8 = 0;
/// The slot of an image's factor that they do not: emission, white highlights, and nothing at all, which
/// says where the image is seen.
const PLAIN: u8 = 1;
/// Marks a path on the stack whose ray left the scene: tries have fewer nodes.
pub(super) const MISSED: u32 = 1 << 31;

/// The slots that a blend shows, with their shares; a share of 0 is no term.
fn shares(slot: u8, share: f32) -> impl Iterator<Item = (u8, f32)> {
    [(slot, 1.0 - share), (slot + 1, share)].into_iter().filter(|(_, share)| *share > 0.0)
}

impl Folder {
    /// Adds what a ray saw that left the scene, of a background that is not one colour.
    pub(super) fn sky(&mut self, reader: &mut Reader, path: u32, lane: usize, weight: f32) {
        match reader.sky() {
            None => self.background(path, lane, weight),
            Some(tone) => self.toned(path, (Kind::Background, 0), tone, lane, weight),
        }
    }

    /// Adds `value` in front of a factor of a node's colour.
    pub(super) fn toned(
        &mut self,
        parent: u32,
        (kind, index): (Kind, u16),
        tone: Tone,
        lane: usize,
        value: f32,
    ) {
        match tone {
            Tone::Blend { slot, share } => {
                for (slot, share) in shares(slot, share) {
                    self.add(parent, Factor::new(kind, index, slot), lane, value * share);
                }
            }
            Tone::Texel(texel) => {
                let tinted = self.find(parent, Factor::new(kind, index, TINTED));
                self.add_colored(tinted, lane, texel * value);
                // All light of lamps that is scattered is tinted.
                if kind != Kind::Diffuse {
                    self.add(parent, Factor::new(kind, index, PLAIN), lane, value);
                }
            }
        }
    }

    /// Adds a coefficient of three numbers, as where a path meets a texel: a term per channel.
    pub fn add_colored(&mut self, term: u32, lane: usize, values: Rgb) {
        for (channel, value) in (0u16..).zip(values.0) {
            self.add(term, Factor::new(Kind::Channel, channel, 0), lane, value);
        }
    }

    /// Adds the matt light and the highlight of a light in front of a toned node.
    pub(super) fn toned_light(
        &mut self,
        arriving: u32,
        (node, tone): (&Node, Tone),
        hit: &LightHit,
        lane: usize,
        weight: f32,
    ) {
        self.toned(arriving, (Kind::Diffuse, node.material), tone, lane, hit.n_dot_l * weight);
        if hit.weight <= 0.0 {
            return;
        }
        let specular = |slot| Factor::new(Kind::Specular, node.material, slot);
        let mut sample = HighlightSample {
            slot: 0,
            material: node.material,
            lane: lane as u16,
            angle: hit.angle,
            weight: 0.0,
        };
        match tone {
            Tone::Blend { slot, share } => {
                for (slot, share) in shares(slot, share) {
                    sample.slot = self.term(arriving, specular(slot));
                    sample.weight = hit.weight * weight * share;
                    self.highlights.push(sample);
                }
            }
            Tone::Texel(texel) => {
                let tinted = self.find(arriving, specular(TINTED));
                for (channel, value) in (0u16..).zip(texel.0).filter(|(_, value)| *value > 0.0) {
                    sample.slot = self.term(tinted, Factor::new(Kind::Channel, channel, 0));
                    sample.weight = hit.weight * weight * value;
                    self.highlights.push(sample);
                }
                sample.slot = self.term(arriving, specular(PLAIN));
                sample.weight = hit.weight * weight;
                self.highlights.push(sample);
            }
        }
    }
}
