//! The white furnace: in surroundings of 1 everything that loses no light shows 1, and vanishes.

use glam::{DVec2, DVec3};

use rayforest::color::Rgb;
use rayforest::forest::tree::Branch;
use rayforest::scene::{Background, Material, Picture, Placement, Scene, Shape, Solid, Trace};

use super::super::preorder::pixels;
use super::super::stage::open;
use super::{clear, mirror, solid, sphere};

/// f32 may lose this by adding up to four samples of weight ¼ in up to 64 terms.
const EXACT: f64 = 1e-6;

/// One solid in the middle of the picture, everything around it 1.
fn furnace(solid: Solid, material: Material) -> Scene {
    Scene {
        picture: Picture { size: [32, 18], ..Picture::default() },
        background: Background::Color(Rgb::WHITE),
        trace: Trace { samples: 4, depth: 64, cutoff: 0.0, ..Trace::default() },
        materials: vec![material],
        solids: vec![solid],
        ..Scene::default()
    }
}

/// One of every form that encloses something.
fn solids() -> Vec<(&'static str, Solid)> {
    let unit = sphere(DVec3::ZERO, 1.5);
    let cuboid = Shape::Box { min: DVec3::splat(-1.2), max: DVec3::splat(1.2) };
    let knot = Shape::Knot { turns: [2, 3], tube: 0.3, segments: [90, 12] };
    let flake = Shape::Sphereflake { center: DVec3::ZERO, radius: 1.0, levels: 3 };
    let turned = Placement {
        rotate_degrees: DVec3::new(20.0, 30.0, 40.0),
        scale: DVec3::new(1.0, 0.7, 1.3),
        ..Placement::default()
    };
    let (from, to) = (DVec3::new(-0.8, -0.4, -0.9), DVec3::new(0.7, 0.5, 1.0));
    let rod = Shape::Cylinder { from, to, radius: 0.8 };
    let cone = Shape::Cone { from, to, radius: 1.2, tip: 0.3 };
    let Shape::Quadric { squares, products, linear, constant, .. } = Shape::named("quadric") else {
        unreachable!("it is named so")
    };
    let (min, max) = (DVec3::splat(-1.2), DVec3::splat(1.2));
    let spool = Shape::Quadric { squares, products, linear, constant, min, max };
    let outline = [[-1.2, -1.0], [1.1, -1.2], [1.3, 1.0], [0.1, 0.2], [-1.0, 1.1]];
    let hole = [[-0.4, -0.7], [0.5, -0.6], [0.2, -0.2]];
    let outline = vec![outline.map(DVec2::from).to_vec(), hole.map(DVec2::from).to_vec()];
    let prism = Shape::Prism { outline, bottom: -0.7, top: 0.8 };
    let torus = Shape::Torus { major: 1.0, minor: 0.4 };
    vec![
        ("cylinder", solid(rod, 0)),
        ("cone", solid(cone, 0)),
        ("spool", Solid { placement: turned.clone(), ..solid(spool, 0) }),
        ("prism", Solid { placement: turned.clone(), ..solid(prism, 0) }),
        ("torus", Solid { placement: turned.clone(), ..solid(torus, 0) }),
        ("sphere", solid(unit.clone(), 0)),
        ("ellipsoid", Solid { placement: turned.clone(), ..solid(unit, 0) }),
        ("box", solid(cuboid.clone(), 0)),
        ("turned box", Solid { placement: turned, ..solid(cuboid, 0) }),
        ("knot", solid(knot, 0)),
        ("flake", solid(flake, 0)),
    ]
}

/// What was seen: samples that met the solid, those of them that ended at the depth limit, and the
/// worst difference of a pixel from the share of its samples that did not.
struct Seen {
    met: usize,
    ended: usize,
    worst: f64,
}

fn look(scene: Scene) -> Seen {
    let session = open(scene);
    let film = session.film();
    let mut seen = Seen { met: 0, ended: 0, worst: 0.0 };
    for pixel in pixels(&session) {
        let met = pixel.samples.iter().flatten();
        let ended = met.clone().filter(|tree| tree.has_cut(Branch::Depth)).count();
        seen.met += met.count();
        seen.ended += ended;
        let truth = 1.0 - ended as f64 / pixel.samples.len() as f64;
        for channel in film.pixel(pixel.pixel).0 {
            seen.worst = seen.worst.max((f64::from(channel) - truth).abs());
        }
    }
    assert!(seen.met > 100, "the solid is seen by {} samples", seen.met);
    seen
}

#[test]
fn glass_vanishes() {
    for (name, solid) in solids() {
        for ior in [1.0, 1.5, 0.8] {
            let Seen { met, ended, worst } = look(furnace(solid.clone(), clear(ior)));
            assert!(worst <= EXACT, "{name} of index {ior}: a pixel is off by {worst:e}");
            // What is bent, tapers or has many sides may guide a ray for longer than the depth limit.
            let guides = ["knot", "torus", "spool", "prism", "cone"].contains(&name);
            let few = if guides && ior > 1.0 { met / 20 } else { 0 };
            assert!(ended <= few, "{name} of index {ior} keeps {ended} of {met} rays");
        }
    }
}

#[test]
fn mirrors_vanish() {
    for (name, solid) in solids() {
        let Seen { met, ended, worst } = look(furnace(solid, mirror(1.0)));
        assert!(worst <= EXACT, "{name}: a pixel is off by {worst:e}");
        assert!(ended == 0, "{name} keeps {ended} of {met} rays");
    }
}

#[test]
fn white_paint_vanishes() {
    for (name, solid) in solids() {
        let paint = Material { ambient: Rgb::WHITE, ..Material::new("paint") };
        let Seen { met: _, ended, worst } = look(furnace(solid, paint));
        assert!(worst <= EXACT && ended == 0, "{name}: a pixel is off by {worst:e}");
    }
}

/// A glass ball that reflects ¼ and transmits ¾: after the light that enters, every meeting with
/// the surface from inside keeps ¼. The depth limit d cuts ¾·¼^(d−1).
#[test]
fn glass_that_splits_rays_lacks_what_the_depth_limit_cuts() {
    for depth in [1, 2, 5, 12] {
        let material =
            Material { reflect: Rgb::grey(0.25), transmit: Rgb::grey(0.75), ..clear(1.5) };
        let mut scene = furnace(solid(sphere(DVec3::ZERO, 1.5), 0), material);
        scene.trace.depth = depth;
        scene.trace.samples = 1;
        let session = open(scene);
        let truth = 1.0 - 0.75 * 0.25f64.powi(depth as i32 - 1);
        for pixel in pixels(&session).iter().filter(|p| p.samples[0].is_some()) {
            for channel in session.film().pixel(pixel.pixel).0 {
                let off = (f64::from(channel) - truth).abs();
                assert!(off <= EXACT, "depth {depth}, pixel {:?}: off by {off:e}", pixel.pixel);
            }
        }
    }
}

#[test]
fn what_loses_light_is_seen() {
    let ball = || solid(sphere(DVec3::ZERO, 1.5), 0);
    for material in [
        Material { transmit: Rgb([1.0, 1.0, 0.99999]), ..clear(1.5) },
        Material { filter: Rgb([0.99999, 1.0, 1.0]), ..clear(1.5) },
        Material { emission: Rgb::grey(1e-5), ..clear(1.5) },
        mirror(0.99999),
    ] {
        assert!(look(furnace(ball(), material)).worst > EXACT);
    }
}
