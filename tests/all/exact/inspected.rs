//! A pixel taken apart: the shares of its nodes add up to its colour, in bits, in every grouping.

use rayforest::color::Rgb;
use rayforest::scene::Material;
use rayforest::session::inspect::{Bars, Met, PixelTree, Share, TreeNode, bars, merged};

use super::*;

/// What is wrong with a tree's sums, beside the light that the picture holds.
fn fault(tree: &PixelTree, light: Rgb) -> Option<String> {
    let bits = |light: Rgb| light.0.map(f32::to_bits);
    let mut sums = vec![("its own light", tree.light)];
    let total = |nodes: &[TreeNode]| nodes.iter().map(|n| n.share).sum::<Share>().rounded();
    sums.push(("its samples", total(&tree.samples)));
    let together = merged(tree.samples.clone());
    sums.push(("its samples put together", total(&together)));
    let parts = |nodes: &[TreeNode]| nodes.iter().map(parts_of).sum::<Share>().rounded();
    sums.push(("the parts of its samples", parts(&tree.samples)));
    sums.push(("their parts put together", parts(&together)));
    let Bars { materials, sources, bounces } = bars(&together);
    sums.push(("materials", materials.iter().map(|(_, s)| *s).sum::<Share>().rounded()));
    sums.push(("sources", sources.iter().map(|(_, s)| *s).sum::<Share>().rounded()));
    sums.push(("bounces", bounces.iter().map(|(_, s)| *s).sum::<Share>().rounded()));
    let wrong = sums.into_iter().find(|(_, sum)| bits(*sum) != bits(light));
    wrong.map(|(what, sum)| format!("{what}: {sum:?} instead of {light:?}"))
}

/// What a node and all below it show of themselves.
fn parts_of(node: &TreeNode) -> Share {
    node.own() + node.below.iter().map(parts_of).sum()
}

/// Holds some pixels of a session's picture to the sums of their parts; the nodes in them.
fn hold(session: &Session, what: &str) -> usize {
    let film = session.film();
    let [width, height] = session.scene().picture.size;
    let mut nodes = 0;
    for y in (0..height).step_by(5) {
        for x in (y % 3..width).step_by(7) {
            let tree = session.inspect([x, y], &Progress::default()).unwrap();
            let samples = session.samples_of([x, y]) as usize;
            assert_eq!(tree.samples.len(), samples, "{what}: samples of {x}, {y}");
            if let Some(fault) = fault(&tree, film.pixel([x, y])) {
                panic!("{what}, pixel {x}, {y}: {fault}");
            }
            nodes += tree.samples.iter().map(count).sum::<usize>();
        }
    }
    nodes
}

fn count(node: &TreeNode) -> usize {
    1 + node.below.iter().map(count).sum::<usize>()
}

#[test]
fn shares_of_every_shipped_scene_add_up_to_its_picture() {
    for name in SHIPPED {
        let session = open(&shipped(name, [48, 27], 3), 2);
        assert!(hold(&session, name) > 50, "{name} has trees");
    }
}

#[test]
fn shares_follow_edits_and_need_no_kept_tree() {
    let scene = shipped("glass", [64, 36], 5);
    let mut session = open(&scene, 2);
    let light = scene.lights[0].name.clone();
    let material = scene.materials[0].name.clone();
    let mut edited = scene.clone();
    for (path, value) in [
        (format!("lights.{light}.intensity"), "0.3"),
        (format!("materials.{material}.shininess"), "11.5"),
        (format!("materials.{material}.reflect"), "0.7"),
        (format!("materials.{material}.reflect"), "0"),
        (format!("lights.{light}.on"), "false"),
    ] {
        set(&mut edited, &path, value);
        session.edit(edited.clone(), &Progress::default()).unwrap();
        hold(&session, &format!("{path} = {value}"));
    }
    // Indices change, and places in the list of factors get gaps.
    let mut moved = edited.clone();
    moved.lights.remove(0);
    session.edit(moved.clone(), &Progress::default()).unwrap();
    hold(&session, "a light is gone");
    moved.materials.insert(0, Material::new("spare"));
    moved.solids.iter_mut().for_each(|solid| solid.material += 1);
    session.edit(moved, &Progress::default()).unwrap();
    hold(&session, "a material came first");
    session.edit(edited.clone(), &Progress::default()).unwrap();
    hold(&session, "both as before");
    let whole = open(&edited, 2);
    let memory = whole.kept_bytes() - whole.forest().bytes() as u64;
    let poor = Options { threads: 2, memory };
    let released = Session::open(edited, poor, &Progress::default()).unwrap();
    assert!(released.forest().tiles.iter().any(Option::is_none), "some trees were released");
    hold(&released, "released");
    let at = [31, 20];
    let [a, b] = [&session, &released].map(|s| s.inspect(at, &Progress::default()).unwrap());
    assert_eq!((a.light, a.samples), (b.light, b.samples), "kept trees answer as rays do");
}

#[test]
fn shares_of_weighted_samples_add_up_too() {
    let mut scene = shipped("whitted", [48, 27], 16);
    set(&mut scene, "trace.filter", "\"mitchell\"");
    hold(&open(&scene, 2), "a filter that subtracts");
    let mut scene = shipped("whitted", [48, 27], 16);
    set(&mut scene, "trace.adaptive", "0.1");
    hold(&open(&scene, 2), "adaptive sampling");
}

#[test]
fn a_node_says_where_it_lies_and_what_it_is() {
    let scene = shipped("whitted", [64, 36], 1);
    let session = open(&scene, 1);
    let mut met = 0;
    for x in (0..64).step_by(4) {
        let tree = session.inspect([x, 20], &Progress::default()).unwrap();
        let root = &tree.samples[0];
        if let Met::Surface { solid, material } = root.met {
            met += 1;
            assert_eq!(scene.solids[solid as usize].material, usize::from(material));
            let length = (root.point - scene.camera.eye).length();
            assert!((length - root.distance).abs() < 1e-9 * length, "{length}");
            assert_eq!(root.weight, Rgb::WHITE, "the eye's ray is all of the only sample");
        }
    }
    assert!(met > 4);
}

#[test]
fn a_lost_share_is_found() {
    let session = open(&shipped("whitted", [64, 36], 2), 1);
    let film = session.film();
    let pixel = (0..64).map(|x| [x, 20]).find(|at| {
        let tree = session.inspect(*at, &Progress::default()).unwrap();
        tree.samples[0].share.luminance() > 0.0
    });
    let pixel = pixel.expect("a pixel that is not black");
    let tree = session.inspect(pixel, &Progress::default()).unwrap();
    let light = film.pixel(pixel);
    assert_eq!(fault(&tree, light), None);
    let mut lost = tree.clone();
    lost.samples.remove(0);
    assert!(fault(&lost, light).unwrap().starts_with("its samples"));
    let mut other = light;
    other.0[1] = f32::from_bits(other.0[1].to_bits() ^ 1);
    assert!(fault(&tree, other).is_some(), "one bit counts");
}
