//! Two mirrors face each other and glow: what is seen is a geometric series, cut where the depth
//! limit or the cut-off says.

use glam::DVec3;

use rayforest::color::Rgb;
use rayforest::scene::{Background, Material, Scene, Shape, Solid};

use super::super::preorder::{Limb, Tree};
use super::super::stage::open;
use super::{clear, light, mirror, one_ray, solid, sphere, tree};

/// Light that a mirror gives off.
const GLOW: f32 = 0.25;

/// Half the distance of the mirrors.
const HALF: f64 = 1.0;

/// Infinite planes, or polygons, at y = ±[`HALF`].
fn mirrors(polygons: bool) -> Vec<Solid> {
    let wall = |y: f64| {
        let normal = DVec3::new(0.0, -y.signum(), 0.0);
        let corner = |x: f64, z: f64| DVec3::new(x, y, z);
        let points = vec![
            corner(-100.0, -100.0),
            corner(100.0, -100.0),
            corner(100.0, 100.0),
            corner(-100.0, 100.0),
        ];
        let plane = Shape::Plane { normal, offset: -y.abs() };
        solid(if polygons { Shape::Polygon { points } } else { plane }, 0)
    };
    vec![wall(-HALF), wall(HALF)]
}

/// The corridor seen by one ray that makes this angle with its axis.
fn corridor(kr: f32, angle: f64, polygons: bool) -> Scene {
    let direction = DVec3::new(0.3 * angle.sin(), angle.cos(), angle.sin());
    let glowing = Material { emission: Rgb::grey(GLOW), ..mirror(kr) };
    Scene {
        materials: vec![glowing],
        solids: mirrors(polygons),
        ..one_ray(DVec3::ZERO, direction.normalize())
    }
}

/// Relative error that f32 may add to a sum of `n` + 1 terms, each of up to `n` + 2 factors: half an
/// ulp for every product and every addition.
fn rounding(n: i32) -> f64 {
    f64::from(2 * n + 3) * 2f64.powi(-24)
}

#[test]
fn recursion_facing_mirrors_show_the_geometric_series() {
    for kr in [0.5f32, 0.9, 0.99] {
        for (depth, cutoff) in
            [(0, 0.0), (1, 0.0), (5, 0.0), (20, 1.0 / 255.0), (64, 1.0 / 255.0), (64, 0.0)]
        {
            for (angle, polygons) in [(0.0, false), (0.0, true), (0.3, false), (0.3, true)] {
                let mut scene = corridor(kr, angle, polygons);
                scene.trace.depth = depth;
                scene.trace.cutoff = cutoff;
                let (r, e, c) = (f64::from(kr), f64::from(GLOW), f64::from(cutoff));
                let n = (1..=depth as i32).take_while(|&k| r.powi(k) >= c).last().unwrap_or(0);
                let truth = e * (1.0 - r.powi(n + 1)) / (1.0 - r);
                let what = format!("kr {kr}, depth {depth}, cut-off {cutoff}, angle {angle}");
                let session = open(scene);
                for channel in light(&session) {
                    let off = channel / truth - 1.0;
                    assert!(off.abs() <= rounding(n), "{what}: off by {off:e}");
                    // All that is lost of the endless series is what a cut-off may lose, or what
                    // the depth limit does.
                    let lost = 1.0 - channel * (1.0 - r) / e;
                    let bound = c.max(r.powi(depth as i32 + 1));
                    assert!(lost <= bound + rounding(n), "{what}: {lost} of the series is lost");
                }
                check_distances(&tree(&session), n as usize + 1, &what);
            }
        }
    }
}

/// Every reflection crosses the corridor along the same slant.
fn check_distances(tree: &Tree, nodes: usize, what: &str) {
    let chain = tree.chain();
    assert_eq!(chain.len(), nodes, "{what}: nodes");
    for node in &chain[1..] {
        let off = node.t / (2.0 * chain[0].t) - 1.0;
        assert!(off.abs() < 1e-13, "{what}: a crossing is off by {off:e}");
    }
}

#[test]
fn recursion_another_series_is_seen() {
    let session = open(corridor(0.9, 0.0, false));
    let n = 64;
    let other = f64::from(GLOW) * (1.0 - 0.9f64.powi(n)) / 0.1;
    assert!((light(&session)[0] / other - 1.0).abs() > rounding(n));
}

/// A ray through 32 concentric shells meets 64 surfaces, the most a path may have branches.
#[test]
fn recursion_sixty_four_branches_are_followed_and_no_more() {
    for (shells, seen) in [(31, true), (32, true), (33, false)] {
        let kt = 0.95f32;
        let material = Material { transmit: Rgb::grey(kt), ..clear(1.3) };
        let balls = (1..=shells).map(|i| solid(sphere(DVec3::ZERO, f64::from(i)), 0));
        let mut scene = one_ray(DVec3::new(0.4, -40.0, 0.3), DVec3::Y);
        scene.materials = vec![material];
        scene.solids = balls.collect();
        scene.background = Background::Color(Rgb::WHITE);
        let session = open(scene);
        let surfaces = 2 * shells;
        let truth = if seen { f64::from(kt).powi(surfaces) } else { 0.0 };
        let off = (light(&session)[0] - truth).abs();
        assert!(off <= truth * rounding(surfaces), "{shells} shells: off by {off:e}");
        let tree = tree(&session);
        let chain = tree.chain();
        assert_eq!(chain.len(), surfaces.min(65) as usize);
        let last = chain[chain.len() - 1];
        assert_eq!(matches!(last.transmitted, Limb::Missed(_)), seen);
    }
}
