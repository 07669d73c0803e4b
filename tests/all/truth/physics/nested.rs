//! Solids within, upon and across each other: which medium is where, and that every way out is found.

use glam::DVec3;

use rayforest::color::Rgb;
use rayforest::forest::grow::Grower;
use rayforest::forest::sink::Discard;
use rayforest::geometry::Geometry;
use rayforest::progress::Progress;
use rayforest::scene::csg::Operation;
use rayforest::scene::{
    Background, Lens, Light, LightPlace, Material, Placement, Scene, Shape, Solid,
};

use super::super::preorder::{Limb, Tree};
use super::super::stage::open;
use super::{clear, light, mirror, one_ray, slab, solid, sphere, tree};

const GLASS: f64 = 1.5;
const WATER: f64 = 1.33;

/// A ray straight down from a height, and solids with their indices and priorities.
fn down(height: f64, tilt: f64, solids: &[(Shape, f64, u32)]) -> Scene {
    let mut scene = one_ray(DVec3::new(0.0, 0.0, height), DVec3::new(tilt.sin(), 0.0, -tilt.cos()));
    for (shape, ior, priority) in solids {
        scene.solids.push(solid(shape.clone(), scene.materials.len()));
        scene.materials.push(Material { priority: *priority, ..clear(*ior) });
    }
    scene.background = Background::Color(Rgb::WHITE);
    scene
}

/// Primitive and distance of every surface on the way.
fn way(scene: Scene) -> Vec<(u32, f64)> {
    tree(&open(scene)).chain().iter().map(|node| (node.primitive, node.t)).collect()
}

fn met(scene: Scene) -> Vec<u32> {
    way(scene).into_iter().map(|(primitive, _)| primitive).collect()
}

/// Rays that left a solid which they were not in.
fn lost(scene: &Scene) -> u64 {
    let progress = Progress::default();
    let geometry = Geometry::build(scene, &progress).expect("nobody cancels");
    let grower = Grower::new(scene, &geometry);
    let mut worker = grower.worker();
    let grown = grower.block(&mut worker, (0, 0), &mut Discard, usize::MAX, &progress);
    assert_eq!(grown, Ok(()));
    worker.rays.lost
}

#[test]
fn a_surface_within_a_higher_priority_is_not_there() {
    // Ice across the surface of water: two boxes, 0 … 2 and 1 … 3.
    let layers =
        |ice: u32, water: u32| [(slab(1.0, 3.0), 1.31, ice), (slab(0.0, 2.0), WATER, water)];
    for tilt in [0.0, 0.5, 1.2] {
        // The ice is whole: in at 3, out into water at 1, out at 0.
        assert_eq!(met(down(5.0, tilt, &layers(1, 0))), [0, 0, 1]);
        // The water is whole: in at 3, into water at 2, out at 0.
        assert_eq!(met(down(5.0, tilt, &layers(0, 1))), [0, 1, 1]);
        // Of equals every surface is there.
        assert_eq!(met(down(5.0, tilt, &layers(1, 1))), [0, 1, 0, 1]);
    }
    let heights = |scene| {
        let mut height = 5.0;
        way(scene)
            .iter()
            .map(|(_, t)| {
                height -= t;
                height
            })
            .collect::<Vec<f64>>()
    };
    assert_eq!(heights(down(5.0, 0.0, &layers(1, 0))), [3.0, 1.0, 0.0]);
    assert_eq!(heights(down(5.0, 0.0, &layers(0, 1))), [3.0, 2.0, 0.0]);
}

/// What is seen through a stack whose layers overlap is what is seen through one without overlap.
#[test]
fn an_overlap_with_priorities_bends_as_a_cut_one() {
    let last = |scene: Scene| {
        let session = open(scene);
        tree(&session).chain().iter().map(|node| node.t).sum::<f64>()
    };
    for tilt in [0.0, 0.4, 0.9, 1.3] {
        let cut = [(slab(1.0, 3.0), GLASS, 0), (slab(0.0, 1.0 - 1e-9), WATER, 0)];
        let overlapping = [(slab(1.0, 3.0), GLASS, 7), (slab(0.0, 2.5), WATER, 3)];
        let [a, b] = [&cut, &overlapping].map(|layers| last(down(5.0, tilt, layers)));
        assert!((a - b).abs() < 1e-7, "{a} and {b} at {tilt}");
        let other =
            last(down(5.0, tilt, &[(slab(1.0, 3.0), GLASS, 3), (slab(0.0, 2.5), WATER, 7)]));
        assert!(tilt == 0.0 || (a - other).abs() > 1e-3, "the other priority is another picture");
    }
}

/// A shadow ray is filtered by the surfaces that are there.
#[test]
fn shadows_pass_what_is_not_there() {
    let shadow = |priorities: [u32; 2]| {
        let layers = [(slab(1.0, 3.0), 1.0, priorities[0]), (slab(2.0, 2.5), 1.0, priorities[1])];
        let mut scene = down(0.5, 0.0, &layers);
        scene.solids.push(solid(Shape::Plane { normal: DVec3::Z, offset: 0.0 }, 2));
        scene.materials.push(Material { diffuse: Rgb::WHITE, ..mirror(0.0) });
        scene.materials[0].filter = Rgb::grey(0.5);
        scene.materials[1].filter = Rgb::grey(0.25);
        let place = LightPlace::Direction(DVec3::NEG_Z);
        scene.lights = vec![Light { place, ..Light::new("sun") }];
        light(&open(scene))[0]
    };
    assert_eq!(shadow([0, 0]), 0.25 / 16.0);
    assert_eq!(shadow([1, 0]), 0.25, "the inner one is not there");
    assert_eq!(shadow([0, 1]), 0.25 / 16.0, "the inner one is there");
    let opaque = |priorities: [u32; 2]| {
        let layers = [(slab(1.0, 3.0), 1.0, priorities[0]), (slab(2.0, 2.5), 1.0, priorities[1])];
        let mut scene = down(0.5, 0.0, &layers);
        scene.solids.push(solid(Shape::Plane { normal: DVec3::Z, offset: 0.0 }, 2));
        scene.materials.push(Material { diffuse: Rgb::WHITE, ..mirror(0.0) });
        scene.materials[1].transmit = Rgb::BLACK;
        let place = LightPlace::Direction(DVec3::NEG_Z);
        scene.lights = vec![Light { place, ..Light::new("sun") }];
        light(&open(scene))[0]
    };
    assert_eq!([opaque([0, 0]), opaque([1, 0])], [0.0, 1.0]);
}

/// The eye in water, in the air of a bubble, in the glass of a bowl: what it is in is known, and what
/// is met next bends accordingly.
#[test]
fn the_eye_in_the_middle_of_things() {
    // Water 0 … 4, in it a slab of glass 1 … 2; the eye at 3 looks down.
    for tilt in [0.0f64, 0.3, 0.7] {
        let layers = [(slab(0.0, 4.0), WATER, 0), (slab(1.0, 2.0), GLASS, 0)];
        let scene = down(3.0, tilt, &layers);
        assert_eq!(lost(&scene), 0);
        let cos = |ior: f64| (1.0 - (WATER * tilt.sin() / ior).powi(2)).sqrt();
        let truth = [1.0 / cos(WATER), 1.0 / cos(GLASS), 1.0 / cos(WATER)];
        let way = way(scene);
        assert_eq!(way.iter().map(|w| w.0).collect::<Vec<_>>(), [1, 1, 0]);
        for ((_, t), truth) in way.iter().zip(truth) {
            assert!((t - truth).abs() < 1e-12, "{t} of {truth}");
        }
    }
    // In both, the inner one first or last in the file; and in a solid made of others.
    let pair = [(slab(0.0, 4.0), WATER, 0), (slab(1.0, 3.5), GLASS, 0)];
    for order in [[0, 1], [1, 0]] {
        let layers = order.map(|i| pair[i].clone());
        let scene = down(3.0, 0.5, &layers);
        assert_eq!(lost(&scene), 0);
        let refracted = (GLASS / WATER * 0.5f64.sin()).asin().cos();
        let way = way(scene);
        assert!((way[1].1 - 1.0 / refracted).abs() < 1e-12);
    }
}

/// An opaque room is no medium.
#[test]
fn an_opaque_room_bends_nothing() {
    let room = (Shape::Box { min: DVec3::splat(-10.0), max: DVec3::splat(10.0) }, 1.5, 0);
    let mut scene = down(3.0, 0.5, &[(slab(0.0, 1.0), GLASS, 0), room]);
    scene.materials[1].transmit = Rgb::BLACK;
    let t = way(scene)[1].1;
    let truth = 1.0 / (0.5f64.sin() / GLASS).asin().cos();
    assert!((t - truth).abs() < 1e-12, "{t} of {truth}");
}

/// Many rays through five nested balls, and through five that overlap: each is left as often as it
/// was entered.
#[test]
fn glass_nested_balls_are_left_as_they_were_entered() {
    for (step, shrink) in [(0.0, 0.8), (0.15, 0.85), (0.5, 1.0)] {
        for priorities in [[0; 5], [0, 1, 2, 3, 4], [3, 1, 4, 1, 5]] {
            let mut scene = down(9.0, 0.0, &[]);
            scene.picture.size = [4, 4];
            scene.trace.samples = 64;
            scene.trace.depth = 12;
            for (i, priority) in priorities.into_iter().enumerate() {
                let center = DVec3::new(step * i as f64, 0.0, 0.0);
                let ball = sphere(center, 2.0 * f64::powi(shrink, i as i32));
                scene.solids.push(solid(ball, i));
                let material = Material { reflect: Rgb::grey(0.1), ..clear(1.1 + 0.13 * i as f64) };
                scene.materials.push(Material { priority, ..material });
            }
            scene.camera.lens = Lens::Parallel { height: 3.9 };
            assert_eq!(lost(&scene), 0, "{step} {priorities:?}");
            scene.camera.eye = DVec3::new(0.1, 0.2, 0.05);
            scene.camera.target = DVec3::new(1.0, 0.3, -0.2);
            scene.camera.up = DVec3::Z;
            scene.camera.lens = Lens::Perspective { fov_degrees: 120.0 };
            assert_eq!(lost(&scene), 0, "from within: {step} {priorities:?}");
        }
    }
}

/// The counter of rays that are lost counts: a mesh that is open on one side is entered by nobody.
#[test]
fn what_is_lost_is_counted() {
    let mut scene = down(9.0, 0.0, &[(sphere(DVec3::ZERO, 1.0), 1.5, 0)]);
    assert_eq!(lost(&scene), 0);
    // The eye is in it, and nobody knows: it lets nothing through.
    scene.camera.eye = DVec3::new(0.0, 0.0, 0.5);
    scene.camera.target = DVec3::ZERO;
    scene.materials[0].transmit = Rgb::BLACK;
    assert_eq!(lost(&scene), 1);
}

/// Two balls of glass made one: two surfaces on the way, one medium, whichever operand is left.
#[test]
fn a_solid_made_of_others_is_one_medium() {
    let balls = [-0.5, 0.5].map(|x| sphere(DVec3::X * x, 1.0));
    let scene = |operation, iors: [f64; 2]| {
        let mut scene = one_ray(DVec3::new(-5.0, 0.35, 0.1), DVec3::X);
        scene.background = Background::Color(Rgb::WHITE);
        for (ball, ior) in balls.iter().zip(iors) {
            scene.solids.push(solid(ball.clone(), scene.materials.len()));
            scene.materials.push(clear(ior));
        }
        let operands = vec![0, 1];
        scene.solids.push(Solid::new("made", Shape::Csg { operation, operands }, 0));
        scene
    };
    assert_eq!(met(scene(Operation::Merge, [GLASS; 2])), [0, 1]);
    assert_eq!(met(scene(Operation::Union, [GLASS; 2])), [0, 1, 0, 1]);
    assert_eq!(met(scene(Operation::Intersection, [GLASS; 2])), [1, 0]);
    // The operand entered decides: the ray bends as in glass throughout.
    let [same, other] =
        [[GLASS, GLASS], [GLASS, 2.4]].map(|iors| way(scene(Operation::Merge, iors)));
    assert_eq!(same, other);
    assert_eq!(lost(&scene(Operation::Merge, [GLASS, 2.4])), 0);
    let reverse = way(scene(Operation::Merge, [2.4, GLASS]));
    assert!((reverse[1].1 - same[1].1).abs() > 1e-3);
}

/// A block of clear matter with a cavity cut out by a ball: light goes in, through air, and out.
#[test]
fn a_cavity_is_air() {
    let mut scene = one_ray(DVec3::new(-5.0, 0.1, 0.2), DVec3::X);
    let block = Shape::Box { min: DVec3::splat(-2.0), max: DVec3::splat(2.0) };
    scene.solids.push(solid(block, 0));
    scene.solids.push(solid(sphere(DVec3::ZERO, 1.0), 0));
    let shape = Shape::Csg { operation: Operation::Difference, operands: vec![0, 1] };
    scene.solids.push(Solid::new("made", shape, 0));
    scene.materials.push(clear(GLASS));
    assert_eq!(lost(&scene), 0);
    let cut = way(scene.clone());
    assert_eq!(cut.iter().map(|w| w.0).collect::<Vec<_>>(), [0, 1, 1, 0]);
    // The same as a ball of air in the glass.
    scene.solids.pop();
    scene.solids[1].material = 1;
    scene.materials.push(clear(1.0));
    let nested = way(scene);
    for (a, b) in cut.iter().zip(&nested) {
        assert!((a.1 - b.1).abs() < 1e-12, "{cut:?} {nested:?}");
    }
}

/// Glass on water, sharing a face, turned anyhow, each solid by a placement of its own: one surface
/// between them, and the light that a mirror of it sends back stays in its medium.
#[test]
fn faces_that_coincide_are_one_surface() {
    for k in 0..60 {
        let angle = f64::from(k) * 37.7;
        let rotate_degrees = DVec3::new(angle, angle * 0.7, angle * 1.3);
        let translate = DVec3::new(0.1, -0.2, 0.3) * f64::from(k % 4) * 10.0;
        let place = |shape: Shape, material: usize, scale: f64| {
            let scale = DVec3::splat(scale);
            let placement = Placement { translate, rotate_degrees, scale };
            Solid { placement, ..solid(shape, material) }
        };
        let turned = place(slab(0.0, 1.0), 0, 1.0);
        // The object's −z and a point above it, in the world.
        let mut probe = one_ray(DVec3::ZERO, DVec3::X);
        probe.solids = vec![turned.clone()];
        let world = |p: DVec3| {
            let [x, y, z] = rotate_degrees.to_array().map(f64::to_radians);
            let turn = glam::DMat3::from_rotation_z(z)
                * glam::DMat3::from_rotation_y(y)
                * glam::DMat3::from_rotation_x(x);
            turn * p + translate
        };
        for tilt in [0.0f64, 0.6, 1.4] {
            let direction = DVec3::new(tilt.sin(), 0.0, -tilt.cos());
            let from = DVec3::new(0.3, 0.2, 2.0) - direction * 3.0;
            let (origin, to) = (world(from), world(from + direction));
            let mut scene = one_ray(origin, to - origin);
            scene.background = Background::Color(Rgb::WHITE);
            // Glass 0 … 1 and water 1 … 2, made twice as large from 0.5 … 1.
            scene.solids = vec![turned.clone(), place(slab(0.5, 1.0), 1, 2.0)];
            let half = |ior| Material { reflect: Rgb::grey(0.2), ..clear(ior) };
            scene.materials = vec![half(GLASS), half(WATER)];
            scene.trace.depth = 4;
            assert_eq!(lost(&scene), 0, "{k} {tilt}");
            let session = open(scene);
            let tree = tree(&session);
            let through: Vec<u32> = straight(&tree);
            assert_eq!(through, [1, 0, 0], "{k} {tilt}: water, glass, and out of it");
            // Back from the face between them the light leaves by the water's top.
            let Limb::Grown(inner) = &tree.transmitted else { panic!("{k} {tilt}") };
            assert_eq!(inner.primitive, 0);
            let Limb::Grown(back) = &inner.reflected else { panic!("{k} {tilt}") };
            assert_eq!((back.primitive, back.t > 0.9), (1, true), "{k} {tilt}");
        }
    }
}

/// The primitives along the refracted rays.
fn straight(tree: &Tree) -> Vec<u32> {
    let mut all = vec![tree.primitive];
    if let Limb::Grown(next) = &tree.transmitted {
        all.extend(straight(next));
    }
    all
}
