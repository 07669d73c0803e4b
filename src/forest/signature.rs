//! What samples of a pixel saw, from which follows whether it needs more of them.

use crate::color::Rgb;
pub use crate::scene::PILOTS;

use super::tree::{BEHIND, BLOCKED, Branch, LightHit, Node, Reader};
use crate::geometry::Tone;

/// Levels of a tree that count: the surface seen, what it mirrors or shows behind it, and what that
/// does.
pub const LEVELS: usize = 3;

/// What is compared as a number, in the range that the samples of a pixel have of it.
const VALUES: usize = 3;

/// What the first samples of one pixel saw: 16 bytes.
///
/// Colours, coefficients and the strength of lights do not enter, only which branches live: an edit
/// of them leaves it alone. Numbers are in 4096ths, at most 16.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Signature {
    /// Bits 1…31 stand for solids, places in textures, lights and branches; bit 0 is set if samples
    /// of the pixel differ in them.
    seen: u32,
    low: [u16; VALUES],
    high: [u16; VALUES],
}

/// What a scene says about its solids.
pub trait Solids {
    /// The solid of a primitive.
    fn solid(&self, primitive: u32) -> u32;
    /// Whether it lets no light through.
    fn is_opaque(&self, solid: u32) -> bool;
}

impl Signature {
    /// Reads the next `samples` trees, those of one pixel.
    pub fn read(reader: &mut Reader, samples: u32, solids: &impl Solids) -> Signature {
        let mut all: Option<Signature> = None;
        for _ in 0..samples {
            let one = of_sample(reader, solids);
            all = Some(all.map_or(one, |all| all.and(one)));
        }
        all.unwrap_or_default()
    }

    /// The colours of a pixel's samples, given in linear light; compared are their square roots, which
    /// differ about as much as the eye sees them differ.
    pub fn of_colors(colors: &[Rgb]) -> Signature {
        let one = |color: &Rgb| {
            let values = color.0.map(|c| in_units(c.clamp(0.0, 200.0).sqrt()));
            Signature { seen: 0, low: values, high: values }
        };
        colors.iter().map(one).reduce(Signature::and).unwrap_or_default()
    }

    fn and(self, other: Signature) -> Signature {
        let mixed = (self.seen ^ other.seen) & !1 != 0;
        Signature {
            seen: self.seen | u32::from(mixed),
            low: std::array::from_fn(|i| self.low[i].min(other.low[i])),
            high: std::array::from_fn(|i| self.high[i].max(other.high[i])),
        }
    }

    /// Whether samples saw different things.
    pub fn is_torn(self) -> bool {
        self.seen & 1 != 0
    }

    /// Whether the numbers of its samples differ by more than `step`.
    pub fn is_spread(self, step: f32) -> bool {
        self.spread() > in_units(step)
    }

    /// Whether the samples of two pixels differ, in numbers by more than `step`.
    pub fn differs(self, other: Signature, step: f32) -> bool {
        let both = self.and(other);
        both.is_torn() || both.is_spread(step)
    }

    fn spread(self) -> u16 {
        let each = self.high.iter().zip(self.low).map(|(high, low)| high - low);
        each.max().unwrap_or(0)
    }
}

/// A number ≥ 0 in 4096ths.
fn in_units(x: f32) -> u16 {
    (x * 4096.0) as u16
}

/// Reads one tree.
fn of_sample(reader: &mut Reader, solids: &impl Solids) -> Signature {
    let mut hash = Hash(0x9e37_79b9_7f4a_7c15);
    let mut values = [0.0f32; VALUES];
    // Whether there is a node, or a ray that left the scene; where all of those see one colour, they
    // are left out.
    let mut levels = vec![(0usize, reader.sample())];
    if reader.is_sky_even() {
        levels.retain(|(_, met)| *met);
    }
    while let Some((level, met)) = levels.pop() {
        let share = 1.0 / (1 << level.min(LEVELS)) as f32;
        let counts = level < LEVELS;
        if !met {
            let tone = reader.sky().map_or(0.0, shade);
            values[2] += if counts { share * tone } else { 0.0 };
            continue;
        }
        let node = *reader.node();
        if node.toned {
            let tone = shade(reader.tone());
            values[2] += if counts { share * tone } else { 0.0 };
        }
        if counts {
            hash.node(&node, solids);
        }
        for _ in 0..node.lights {
            let (hit, crossed) = reader.light();
            if counts && hash.light(hit, crossed, solids) {
                values[0] += share * hit.n_dot_l.max(0.0);
                values[1] += share * shine(hit);
            }
        }
        let below = [node.ends.transmitted(), node.ends.reflected()];
        let even = reader.is_sky_even();
        levels.extend(below.iter().filter_map(|branch| match branch {
            Branch::Grown => Some((level + 1, true)),
            Branch::Missed if !even => Some((level + 1, false)),
            _ => None,
        }));
    }
    let values = values.map(in_units);
    Signature { seen: (hash.0 >> 32) as u32 & !1, low: values, high: values }
}

/// One number for a tone: where in its palette it is, or how bright its texel is.
fn shade(tone: Tone) -> f32 {
    match tone {
        Tone::Blend { slot, share } => f32::from(slot) + share,
        Tone::Texel(Rgb([r, g, b])) => ((r + g + b) / 3.0).min(1.0),
    }
}

/// How near a light is to the middle of its highlight, whatever the exponent: a half where a cosine
/// to the power of 64 is.
fn shine(hit: &LightHit) -> f32 {
    if hit.weight > 0.0 { 1.0 / (1.0 + 64.0 * hit.angle) } else { 0.0 }
}

struct Hash(u64);

impl Hash {
    fn add(&mut self, word: u32) {
        self.0 = (self.0 ^ u64::from(word)).wrapping_mul(0xd6e8_feb8_6659_fd93);
        self.0 ^= self.0 >> 29;
    }

    fn node(&mut self, node: &Node, solids: &impl Solids) {
        // What a branch that is not followed would need to live is no matter.
        let end = |branch| match branch {
            Branch::Grown => 1,
            Branch::Missed => 2,
            _ => 0,
        };
        let ends = end(node.ends.reflected()) | end(node.ends.transmitted()) << 2;
        self.add(solids.solid(node.primitive));
        self.add(u32::from(node.slot) << 8 | ends << 1 | u32::from(node.ends.total()));
    }

    /// Gives whether the light arrives.
    fn light(&mut self, hit: &LightHit, crossed: &[u32], solids: &impl Solids) -> bool {
        // A light that shows nothing counts as if something stood before it, whatever does.
        let idle = hit.n_dot_l <= 0.0 && !hit.is_behind();
        let stopped = idle
            || [BLOCKED, BEHIND].contains(&hit.crossed)
            || crossed.iter().any(|&solid| solids.is_opaque(solid));
        self.add(u32::from(hit.light) << 1 | u32::from(stopped));
        if !stopped {
            crossed.iter().for_each(|&solid| self.add(solid));
        }
        !stopped
    }
}
