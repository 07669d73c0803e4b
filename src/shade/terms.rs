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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fold::trie::ROOT;
    use crate::scene::factor::Factor;
    use crate::scene::{Light, Material, Scene};

    /// Material 0 reflects, material 1 is lit by light 0, seen directly and in one and two mirrors.
    fn scene(reflect: f32) -> Scene {
        let mut scene = Scene::default();
        let mut mirror = Material::new("mirror");
        mirror.reflect = Rgb::grey(reflect);
        let mut matte = Material::new("matte");
        matte.diffuse = Rgb([0.5, 0.25, 0.0]);
        scene.materials = vec![mirror, matte];
        scene.lights = vec![Light::new("lamp")];
        scene
    }

    fn trie() -> (Trie, [u32; 3]) {
        let mut trie = Trie::default();
        let mut path = ROOT;
        let ids = [0, 1, 2].map(|_| {
            let light = trie.intern(path, Factor::new(Kind::Light, 0, 0));
            let id = trie.intern(light, Factor::new(Kind::Diffuse, 1, 0));
            trie.mark(id, Marks::TERM);
            path = trie.intern(path, Factor::new(Kind::Reflect, 0, 0));
            id
        });
        trie.mark(path, Marks::FRONTIER);
        (trie, ids)
    }

    fn evaluate(scene: &Scene) -> TermValues {
        let mut values = TermValues::default();
        values.evaluate(&trie().0, &FactorValues::new(scene));
        values
    }

    #[test]
    fn a_term_is_the_product_of_its_factors() {
        let values = evaluate(&scene(0.5));
        let [a, b, c] = trie().1.map(|id| values.values[id as usize]);
        assert_eq!(a, [0.5, 0.25, 0.0, 1.0]);
        assert_eq!(b, [0.25, 0.125, 0.0, 1.0]);
        assert_eq!(c, [0.125, 0.0625, 0.0, 1.0]);
    }

    #[test]
    fn branches_die_by_zero_weight_and_depth_and_only_then() {
        let lit = |scene: &Scene| {
            let values = evaluate(scene);
            trie().1.map(|id| values.values[id as usize][3] != 0.0)
        };
        assert_eq!(lit(&scene(0.5)), [true, true, true]);
        assert_eq!(lit(&scene(0.0)), [true, false, false]);
        let mut cut = scene(0.5);
        cut.trace.cutoff = 0.3;
        assert_eq!(lit(&cut), [true, true, false]);
        let mut shallow = scene(0.5);
        shallow.trace.depth = 1;
        assert_eq!(lit(&shallow), [true, true, false]);
    }

    #[test]
    fn a_frontier_that_lives_is_found() {
        let mut scene = scene(0.5);
        scene.trace.cutoff = 0.2;
        assert_eq!(evaluate(&scene).uncovered, None);
        scene.trace.cutoff = 0.125;
        assert!(evaluate(&scene).uncovered.is_some());
        scene.trace.depth = 2;
        assert_eq!(evaluate(&scene).uncovered, None);
    }

    #[test]
    fn huge_products_stay_finite() {
        let mut scene = scene(10.0);
        scene.lights[0].intensity = Rgb::grey(1e6);
        let mut trie = Trie::default();
        let path = (0..60).fold(ROOT, |p, _| trie.intern(p, Factor::new(Kind::Reflect, 0, 0)));
        scene.trace.depth = 64;
        let mut values = TermValues::default();
        values.evaluate(&trie, &FactorValues::new(&scene));
        assert_eq!(values.values[path as usize][0], f32::MAX);
    }
}
