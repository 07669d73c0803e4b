//! The value of every term for the present parameters, dead branches being 0.

use crate::color::Rgb;
use crate::fold::trie::{Marks, Trie};
use crate::scene::factor::{FactorValues, Kind, PathWeight};

/// The values of a picture's terms; memory is kept from edit to edit.
#[derive(Clone, Debug, Default)]
pub struct TermValues {
    /// Per trie node red, green, blue, and 1 if any of them is not zero.
    pub values: Vec<[f32; 4]>,
    /// Per trie node that ends in a path factor its weight; dead where `depth` is [`DEAD`].
    weights: Vec<PathWeight>,
    /// The first frontier node that lives, if any: the kept trees lack its branch.
    pub uncovered: Option<u32>,
}

const DEAD: u32 = u32::MAX;

impl TermValues {
    /// Evaluates every term: parents first, one multiplication each, in `f32` and clamped to finite
    /// values, so that a zero coefficient in front of it stays zero.
    pub fn evaluate(&mut self, trie: &Trie, factors: &FactorValues) {
        let nodes = trie.nodes();
        self.values.resize(nodes.len(), [0.0; 4]);
        self.weights.resize(nodes.len(), PathWeight::EYE);
        self.values[0] = [1.0; 4];
        self.weights[0] = PathWeight::EYE;
        self.uncovered = None;
        for (id, node) in nodes.iter().enumerate().skip(1) {
            let parent = node.parent as usize;
            let mut alive = true;
            if node.factor.is_path() {
                let above = self.weights[parent];
                let followed = match above.depth {
                    DEAD => None,
                    _ => factors.follow(above, node.factor).ok(),
                };
                alive = followed.is_some();
                self.weights[id] = followed.unwrap_or(PathWeight { depth: DEAD, ..above });
            }
            let value = product(self.values[parent], factors.value(node.factor));
            self.values[id] = if alive { value } else { [0.0; 4] };
            if node.marks.has(FRONTIERS) && self.uncovered.is_none() {
                let reached = self.weights[parent].depth != DEAD;
                let lives = match node.factor.kind() {
                    Kind::Shadow => reached && !factors.value(node.factor).is_black(),
                    _ => alive,
                };
                self.uncovered = lives.then_some(id as u32);
            }
        }
    }
}

/// Both kinds of frontier.
const FRONTIERS: Marks = Marks::FRONTIER.and(Marks::WITNESS);

#[inline(always)]
fn product([r, g, b, _]: [f32; 4], factor: Rgb) -> [f32; 4] {
    let Rgb([r, g, b]) = (Rgb([r, g, b]) * factor).map(|c| c.min(f32::MAX));
    let lit = r != 0.0 || g != 0.0 || b != 0.0;
    [r, g, b, if lit { 1.0 } else { 0.0 }]
}
