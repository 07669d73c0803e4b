//! Folding of small made-up trees against sums done by hand.

use super::*;
use crate::color::Rgb;
use crate::forest::sink::{Side, Sink};
use crate::forest::tree::{Ends, NO_FRESNEL, TileTrees};
use crate::scene::model::Measure;

/// Two samples in every lane.
const ALL: [u32; LANES] = [2; LANES];

fn node(material: u16, reflected: Branch) -> Node {
    let ends = Ends::new(reflected, Branch::Zero, false);
    let (t, primitive, lights, slot, fresnel) = (1.0, 0, 0, 0, NO_FRESNEL);
    Node { t, primitive, material, lights, slot, whole: true, toned: false, ends, fresnel }
}

/// The peak of Phong's exponent.
fn power(exponent: f32) -> Option<Peak> {
    Some(Peak { exponent, scale: 1.0, measure: Measure::Cosine })
}

fn lit(light: u16, n_dot_l: f32, angle: f32, crossed: u16) -> LightHit {
    LightHit { light, crossed, n_dot_l, angle, weight: 1.0 }
}

/// A block whose lane `i` has two samples: a mirror that sees a matte surface through material 2 if
/// `i` is below `mirrors`, else the background; and a miss.
fn block(mirrors: usize) -> TileTrees {
    let mut trees = TileTrees::default();
    trees.block();
    for lane in 0..LANES {
        trees.sample(true);
        if lane < mirrors {
            trees.node(node(0, Branch::Grown));
            trees.node(node(1, Branch::Zero));
            trees.light(lit(0, 0.5, 0.25, 2), &[2, 2]);
        } else {
            let name = trees.node(node(0, Branch::Grown));
            trees.missed(name, Side::Reflected);
        }
        trees.sample(false);
    }
    trees.validate(3, 3, 1);
    trees
}

/// Solid i is of material i.
fn names() -> Names {
    Names::new(&[0, 1, 2], 1)
}

fn folded(trees: &TileTrees) -> (Trie, TransportTile) {
    let mut folder = Folder::default();
    folder.begin_tile();
    folder.block(&mut trees.read(0), &ALL, &names());
    let Folded { trie, tile } = folder.finish_tile(0.5, &[8.0, 2.0, 1.0].map(power));
    (trie.clone(), tile)
}

/// The coefficient of a product at every lane, wherever it is stored.
fn coefficients(trie: &Trie, tile: &TransportTile, product: &[Factor]) -> [f32; LANES] {
    let mut found = [0.0; LANES];
    let is = |entry: usize| trie.factors(tile.terms[entry]) == product;
    let block = tile.block(0);
    for (&entry, plane) in block.entries.iter().zip(block.planes) {
        if is(entry as usize) {
            found = plane.0;
        }
    }
    for single in block.singles.iter().filter(|s| is(s.entry())) {
        found[single.lane()] = single.coefficient;
    }
    found
}

fn f(kind: Kind, index: u16) -> Factor {
    Factor::new(kind, index, 0)
}

#[test]
fn coefficients_are_the_sums_over_the_samples() {
    for mirrors in [2, 9] {
        let (trie, tile) = folded(&block(mirrors));
        let at = |product: &[Factor]| coefficients(&trie, &tile, product);
        let below = |value: f32, rest: f32| -> [f32; LANES] {
            std::array::from_fn(|i| if i < mirrors { value } else { rest })
        };
        assert_eq!(at(&[f(Kind::Background, 0)]), [0.5; LANES]);
        assert_eq!(at(&[f(Kind::Ambient, 0)]), [0.5; LANES]);
        assert_eq!(at(&[f(Kind::Reflect, 0), f(Kind::Background, 0)]), below(0.0, 0.5));
        let arriving =
            [f(Kind::Reflect, 0), f(Kind::Light, 0), f(Kind::Shadow, 2), f(Kind::Shadow, 2)];
        let [a, b, c, d] = arriving;
        assert_eq!(at(&[a, b, c, d, f(Kind::Diffuse, 1)]), below(0.25, 0.0));
        // 0.75² by the kernel: exact up to its rounding.
        let highlight = at(&[a, b, c, d, f(Kind::Specular, 1)]);
        for (found, truth) in highlight.iter().zip(below(0.5 * 0.5625, 0.0)) {
            assert!((found - truth).abs() < 1e-7, "{found} {truth}");
        }
    }
}

#[test]
fn few_lanes_are_singles_and_many_are_planes() {
    let (_, few) = folded(&block(SPARSE_LANES as usize));
    let (_, many) = folded(&block(SPARSE_LANES as usize + 1));
    assert!(!few.singles.is_empty());
    assert_eq!(many.singles.len(), 0);
    assert!(many.planes.len() > few.planes.len());
}

#[test]
fn ends_of_branches_are_marked_as_frontier() {
    let (trie, _) = folded(&block(3));
    let marked: Vec<Vec<Factor>> = (1..trie.nodes().len() as u32)
        .filter(|&id| trie.nodes()[id as usize].marks.has(Marks::FRONTIER))
        .map(|id| trie.factors(id))
        .collect();
    assert_eq!(marked.len(), 3, "{marked:?}");
    assert!(marked.contains(&vec![f(Kind::Transmit, 0)]));
    assert!(marked.contains(&vec![f(Kind::Reflect, 0), f(Kind::Reflect, 1)]));
    assert!(marked.contains(&vec![f(Kind::Reflect, 0), f(Kind::Transmit, 1)]));
}

#[test]
fn a_colored_coefficient_is_a_term_per_channel() {
    let mut folder = Folder::default();
    folder.begin_tile();
    let term = folder.find(ROOT, f(Kind::Background, 0));
    for lane in 0..LANES {
        folder.add_colored(term, lane, Rgb([0.5, 0.25, 0.125]));
        folder.add_colored(term, lane, Rgb([0.5, 0.5, 0.5]));
    }
    folder.end_block();
    let Folded { trie, tile } = folder.finish_tile(0.5, &[]);
    for (channel, sum) in [(0, 0.5), (1, 0.375), (2, 0.3125)] {
        let product = [f(Kind::Background, 0), f(Kind::Channel, channel)];
        assert_eq!(coefficients(trie, &tile, &product), [sum; LANES]);
    }
}

#[test]
fn a_new_exponent_gives_what_a_fresh_fold_gives() {
    let trees = block(9);
    let (_, mut kept) = folded(&trees);
    let mut folder = Folder::default();
    folder.begin_tile();
    folder.block(&mut trees.read(0), &ALL, &names());
    let fresh = folder.finish_tile(0.5, &[8.0, 31.0, 1.0].map(power)).tile;
    assert_ne!(kept, fresh);
    let peaks = [None, power(31.0), None];
    assert!(HighlightPower::default().refold(&mut kept, &peaks, 0.5), "coefficients changed");
    assert_eq!(kept, fresh);
    assert!(!HighlightPower::default().refold(&mut kept, &peaks, 0.5), "nothing more changes");
}

/// A node of material 0 with a tone, lit by light 0 from the front, that reflects the sky.
fn toned(tone: Tone, sky: Option<Tone>) -> TileTrees {
    let mut trees = TileTrees::default();
    trees.block();
    for _ in 0..LANES {
        trees.sample(true);
        let name = trees.node(Node { toned: true, ..node(0, Branch::Grown) });
        trees.tone(tone);
        trees.light(lit(0, 0.5, 0.25, 0), &[]);
        trees.missed(name, Side::Reflected);
        trees.sample(false);
        // The tree's ray first, then the sample's.
        for sky in sky.into_iter().flat_map(|sky| [sky, Tone::Texel(Rgb([8.0, 4.0, 0.0]))]) {
            trees.sky(sky);
        }
    }
    trees.validate(3, 3, 1);
    trees
}

fn slot(kind: Kind, slot: u8) -> Factor {
    Factor::new(kind, 0, slot)
}

#[test]
fn a_blend_is_two_terms_whose_coefficients_make_one() {
    let (trie, tile) = folded(&toned(Tone::Blend { slot: 0, share: 0.25 }, None));
    let at = |product: &[Factor]| coefficients(&trie, &tile, product)[3];
    // Two samples of weight ½: the node of one of them.
    assert_eq!(at(&[slot(Kind::Ambient, 0)]), 0.375);
    assert_eq!(at(&[slot(Kind::Ambient, 1)]), 0.125);
    let light = f(Kind::Light, 0);
    assert_eq!(at(&[light, slot(Kind::Diffuse, 1)]), 0.0625);
    // A highlight of 0.75^8, Phong's, times its share.
    let whole = at(&[light, slot(Kind::Specular, 0)]) + at(&[light, slot(Kind::Specular, 1)]);
    assert!((whole - 0.5 * 0.75f32.powi(8)).abs() < 1e-6, "{whole}");
    assert_eq!(at(&[f(Kind::Reflect, 0), f(Kind::Background, 0)]), 0.5);
    let pure = folded(&toned(Tone::Blend { slot: 0, share: 0.0 }, None));
    let product = [slot(Kind::Ambient, 1)];
    assert_eq!(coefficients(&pure.0, &pure.1, &product), [0.0; LANES]);
    let is_term = |id: &u32| pure.0.factors(*id) == product;
    assert!(!pure.1.terms.iter().any(is_term), "no share, no term");
}

#[test]
fn a_texel_is_a_term_per_channel_beside_what_it_does_not_multiply() {
    let texel = Tone::Texel(Rgb([0.5, 0.0, 2.0]));
    let (trie, tile) = folded(&toned(texel, Some(Tone::Blend { slot: 1, share: 0.5 })));
    let at = |product: &[Factor]| coefficients(&trie, &tile, product)[3];
    let channels =
        |before: &[Factor]| [0, 1, 2].map(|c| at(&[before, &[f(Kind::Channel, c)]].concat()));
    assert_eq!(channels(&[slot(Kind::Ambient, 0)]), [0.25, 0.0, 1.0]);
    assert_eq!(at(&[slot(Kind::Ambient, 1)]), 0.5);
    let light = f(Kind::Light, 0);
    assert_eq!(channels(&[light, slot(Kind::Diffuse, 0)]), [0.125, 0.0, 0.5]);
    assert_eq!(at(&[light, slot(Kind::Diffuse, 1)]), 0.0);
    let white = at(&[light, slot(Kind::Specular, 1)]);
    let tinted = channels(&[light, slot(Kind::Specular, 0)]);
    assert!(white > 0.0 && tinted == [0.5 * white, 0.0, 2.0 * white], "{white} {tinted:?}");
    // What was reflected saw a blend, the other sample a texel.
    let mirrored = |slot_| at(&[f(Kind::Reflect, 0), slot(Kind::Background, slot_)]);
    assert_eq!([mirrored(0), mirrored(1), mirrored(2)], [0.0, 0.25, 0.25]);
    assert_eq!(channels(&[slot(Kind::Background, 0)]), [4.0, 2.0, 0.0]);
    assert_eq!(at(&[slot(Kind::Background, 1)]), 0.5);
}
