//! The value of every term for the present parameters, dead branches being 0.

use crate::color::Rgb;
use crate::fold::trie::{Marks, Trie, TrieNode};
use crate::scene::factor::{Factor, FactorValues, Kind, PathWeight};

/// The terms of a picture as straight-line code: made once per trace, run at every edit.
///
/// Path nodes come first, because liveness runs along them; then all others need one multiplication
/// each, without a decision. Parents stand before their children in both lists.
#[derive(Clone, Debug, Default)]
pub struct TermProgram {
    terms: usize,
    factors: Vec<Factor>,
    paths: Vec<Step>,
    products: Vec<Step>,
    frontier: Vec<Frontier>,
}

/// `values[id] = values[parent] · factors[factor]`.
#[derive(Clone, Copy, Debug)]
struct Step {
    id: u32,
    parent: u32,
    factor: u32,
}

/// Where the kept trees end: a branch that was not followed, or a shadow ray that was stopped.
#[derive(Clone, Copy, Debug)]
struct Frontier {
    id: u32,
    parent: u32,
    factor: Factor,
}

impl TermProgram {
    /// Compiles the terms of a trie.
    pub fn new(trie: &Trie) -> TermProgram {
        let nodes = trie.nodes();
        let mut factors: Vec<Factor> = nodes.iter().skip(1).map(|n| n.factor).collect();
        factors.sort_unstable();
        factors.dedup();
        let mut program = TermProgram { terms: nodes.len(), factors, ..TermProgram::default() };
        for (id, node) in (0u32..).zip(nodes).skip(1) {
            program.add(id, node);
        }
        program
    }

    fn add(&mut self, id: u32, &TrieNode { parent, factor, marks }: &TrieNode) {
        let index = self.factors.partition_point(|&f| f < factor) as u32;
        let list = if factor.is_path() { &mut self.paths } else { &mut self.products };
        list.push(Step { id, parent, factor: index });
        if marks.has(Marks::FRONTIER.and(Marks::WITNESS)) {
            self.frontier.push(Frontier { id, parent, factor });
        }
    }

    /// Ids of the terms at which the kept trees end.
    pub fn frontier(&self) -> impl Iterator<Item = u32> {
        self.frontier.iter().map(|f| f.id)
    }

    /// Allocated bytes.
    pub fn bytes(&self) -> usize {
        let TermProgram { terms: _, factors, paths, products, frontier } = self;
        factors.capacity() * size_of::<Factor>()
            + (paths.capacity() + products.capacity()) * size_of::<Step>()
            + frontier.capacity() * size_of::<Frontier>()
    }
}

/// The values of a picture's terms; memory is kept from edit to edit.
#[derive(Clone, Debug, Default)]
pub struct TermValues {
    /// Per trie node red, green, blue, and not 0 if any of them is not.
    pub values: Vec<[f32; 4]>,
    /// Per trie node that ends in a path factor its weight; dead where `depth` is [`DEAD`].
    weights: Vec<PathWeight>,
    table: Vec<[f32; 4]>,
}

const DEAD: u32 = u32::MAX;

impl TermValues {
    /// Allocated bytes.
    pub fn bytes(&self) -> usize {
        let TermValues { values, weights, table } = self;
        (values.capacity() + table.capacity()) * size_of::<[f32; 4]>()
            + weights.capacity() * size_of::<PathWeight>()
    }

    /// Evaluates every term: parents first, one multiplication each, in `f32` and clamped to finite
    /// values, so that a zero coefficient in front of it stays zero.
    pub fn evaluate(&mut self, program: &TermProgram, factors: &FactorValues) {
        self.follow_paths(program, factors);
        self.values.resize(program.terms, [0.0; 4]);
        self.table.clear();
        self.table.extend(program.factors.iter().map(|&f| {
            let Rgb([r, g, b]) = factors.value(f);
            [r, g, b, r.max(g).max(b)]
        }));
        self.values[0] = [1.0; 4];
        for &Step { id, parent, factor } in &program.paths {
            let alive = self.weights[id as usize].depth != DEAD;
            let value = product(self.values[parent as usize], self.table[factor as usize]);
            self.values[id as usize] = if alive { value } else { [0.0; 4] };
        }
        for &Step { id, parent, factor } in &program.products {
            self.values[id as usize] =
                product(self.values[parent as usize], self.table[factor as usize]);
        }
    }

    /// Applies the rule of liveness to every path, and gives the frontier that lives: the kept trees
    /// lack its branches. Values are left alone.
    pub fn uncovered(
        &mut self,
        program: &TermProgram,
        factors: &FactorValues,
    ) -> impl Iterator<Item = u32> {
        self.follow_paths(program, factors);
        let lives = move |f: &&Frontier| match f.factor.kind() {
            Kind::Shadow => {
                let reached = self.weights[f.parent as usize].depth != DEAD;
                reached && !factors.value(f.factor).is_black()
            }
            _ => self.weights[f.id as usize].depth != DEAD,
        };
        program.frontier.iter().filter(lives).map(|f| f.id)
    }

    /// Per trie node whether it ends in a path factor whose branch lives. Values are left alone.
    pub fn living(&mut self, program: &TermProgram, factors: &FactorValues) -> Vec<bool> {
        self.follow_paths(program, factors);
        let mut living = vec![false; program.terms];
        for &Step { id, .. } in &program.paths {
            living[id as usize] = self.weights[id as usize].depth != DEAD;
        }
        living
    }

    fn follow_paths(&mut self, program: &TermProgram, factors: &FactorValues) {
        self.weights.resize(program.terms, PathWeight::EYE);
        self.weights[0] = PathWeight::EYE;
        for &Step { id, parent, factor } in &program.paths {
            let above = self.weights[parent as usize];
            let dead = PathWeight { depth: DEAD, ..above };
            self.weights[id as usize] = match above.depth {
                DEAD => dead,
                _ => factors.follow(above, program.factors[factor as usize]).unwrap_or(dead),
            };
        }
    }
}

/// Whether the branch or shadow ray of one term of the frontier, given by its factors from the eye
/// on, lives: what [`TermValues::uncovered`] asks of all of them.
pub fn frontier_lives(factors: &[Factor], values: &FactorValues) -> bool {
    let follow = |path: PathWeight, &factor: &Factor| match factor.kind() {
        Kind::Shadow if values.value(factor).is_black() => None,
        Kind::Shadow => Some(path),
        _ => values.follow(path, factor).ok(),
    };
    factors.iter().try_fold(PathWeight::EYE, follow).is_some()
}

/// The fourth component only tells zero from not zero, and may be too large, never too small.
#[inline(always)]
fn product(a: [f32; 4], b: [f32; 4]) -> [f32; 4] {
    std::array::from_fn(|i| (a[i] * b[i]).min(f32::MAX))
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
        values.evaluate(&TermProgram::new(&trie().0), &FactorValues::new(scene));
        values
    }

    fn uncovered(scene: &Scene) -> Option<u32> {
        let program = TermProgram::new(&trie().0);
        TermValues::default().uncovered(&program, &FactorValues::new(scene)).next()
    }

    #[test]
    fn a_term_is_the_product_of_its_factors() {
        let values = evaluate(&scene(0.5));
        let [a, b, c] = trie().1.map(|id| values.values[id as usize]);
        assert_eq!(a[..3], [0.5, 0.25, 0.0]);
        assert_eq!(b[..3], [0.25, 0.125, 0.0]);
        assert_eq!(c[..3], [0.125, 0.0625, 0.0]);
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
        assert_eq!(uncovered(&scene), None);
        scene.trace.cutoff = 0.125;
        assert!(uncovered(&scene).is_some());
        scene.trace.depth = 2;
        assert_eq!(uncovered(&scene), None);
    }

    #[test]
    fn one_frontier_alone_lives_as_among_all() {
        let program = TermProgram::new(&trie().0);
        let ids: Vec<u32> = program.frontier().collect();
        assert_eq!(ids.len(), 1);
        let factors = trie().0.factors(ids[0]);
        let mut both = [0, 0];
        for (reflect, cutoff, depth) in
            [(0.5, 0.2, 3), (0.5, 0.125, 3), (0.5, 0.125, 2), (0.0, 0.0, 64), (0.6, 0.2, 3)]
        {
            let mut scene = scene(reflect);
            (scene.trace.cutoff, scene.trace.depth) = (cutoff, depth);
            let values = FactorValues::new(&scene);
            let lives = TermValues::default().uncovered(&program, &values).next().is_some();
            assert_eq!(frontier_lives(&factors, &values), lives, "{reflect} {cutoff} {depth}");
            both[usize::from(lives)] += 1;
        }
        assert_eq!(both, [3, 2]);
    }

    #[test]
    fn huge_products_stay_finite() {
        let mut scene = scene(10.0);
        scene.lights[0].intensity = Rgb::grey(1e6);
        let mut trie = Trie::default();
        let path = (0..60).fold(ROOT, |p, _| trie.intern(p, Factor::new(Kind::Reflect, 0, 0)));
        scene.trace.depth = 64;
        let mut values = TermValues::default();
        values.evaluate(&TermProgram::new(&trie), &FactorValues::new(&scene));
        assert_eq!(values.values[path as usize][0], f32::MAX);
    }
}
