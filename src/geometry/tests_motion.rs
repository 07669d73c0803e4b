//! Moving solids against the same solids standing where they are at a time.

use fearless_simd::Level;
use glam::DVec3;

use super::query::{Closest, Shadow};
use super::testing::{Random, build, closest, mesh_solid, scene, shadow, solid, triangle_cube};
use super::{Geometry, Hit, Leaving, Ray, Stack};
use crate::progress::Progress;
use crate::scene::motion::Motion;
use crate::scene::{Scene, Shape, Solid};

/// Solids of every kind that move, and two that do not.
fn moving(shutter: f64) -> Scene {
    let mut solids = vec![
        solid(Shape::Sphere { center: DVec3::X, radius: 0.7 }),
        solid(Shape::Box { min: DVec3::NEG_ONE, max: DVec3::new(0.5, 0.2, 1.0) }),
        solid(Shape::Polygon { points: vec![DVec3::ZERO, DVec3::X * 2.0, DVec3::ONE] }),
        mesh_solid(triangle_cube()),
        solid(Shape::Knot { turns: [2, 3], tube: 0.3, segments: [60, 8] }),
        solid(Shape::Sphereflake { center: DVec3::ZERO, radius: 0.6, levels: 3 }),
        solid(Shape::Sphere { center: DVec3::Y, radius: 0.5 }),
        solid(Shape::named("cylinder")),
        solid(Shape::named("cone")),
        solid(Shape::named("torus")),
        solid(Shape::named("ellipsoid")),
        solid(Shape::named("quadric")),
        solid(Shape::named("prism")),
        solid(Shape::Box { min: DVec3::splat(4.0), max: DVec3::splat(5.0) }),
        solid(Shape::Plane { normal: DVec3::Z, offset: -6.0 }),
    ];
    let mut random = Random(11);
    for (i, one) in solids.iter_mut().take(13).enumerate() {
        one.placement.translate = random.in_cube() * 3.0;
        one.placement.rotate_degrees = random.in_cube() * 180.0;
        one.placement.scale = DVec3::splat(1.0 + 0.3 * random.signed());
        if i % 2 == 0 {
            one.placement.scale.y *= 0.6;
        }
        one.motion = Motion { translate: random.in_cube() * 2.0, ..Motion::default() };
        if i != 3 {
            one.motion.rotate_degrees = random.in_cube() * [20.0, 170.0, 900.0][i % 3];
        }
    }
    let mut scene = scene(solids);
    scene.camera.shutter = shutter;
    scene
}

/// The same, standing still as they are at a time.
fn still(mut scene: Scene, time: f64) -> Scene {
    for Solid { placement, motion, .. } in &mut scene.solids {
        *placement = placement.at(motion, time);
        *motion = Motion::default();
    }
    scene
}

fn ray(random: &mut Random) -> Ray {
    let origin = random.direction() * 9.0;
    let target = random.in_cube() * 3.0;
    Ray { origin, direction: (target - origin).normalize() }
}

fn first_hit(geometry: &Geometry, time: f64, ray: &Ray, leaving: Option<Leaving>) -> Option<Hit> {
    let mut query = Closest::new();
    geometry.traverse_all(time, ray, leaving, &mut query);
    query.hit()
}

#[test]
fn at_every_time_rays_meet_what_stands_there() {
    for level in [Level::new(), Level::baseline()] {
        rays_meet_what_stands_there(level);
    }
}

fn rays_meet_what_stands_there(level: Level) {
    let scene = moving(0.8);
    let built = |scene: &Scene| Geometry::build_for(level, scene, &Progress::default()).unwrap();
    let geometry = built(&scene);
    let mut stack = Stack::new(&geometry);
    let opaque = vec![false; scene.solids.len()];
    let (mut random, mut hits) = (Random(5), 0);
    for time in [0.0, 0.13, 0.4, 0.62, 0.8] {
        let standing = built(&still(scene.clone(), time));
        let mut still_stack = Stack::new(&standing);
        stack.set_time(time);
        for _ in 0..1500 {
            let ray = ray(&mut random);
            let found = closest(&geometry, level, &mut stack, &ray, None);
            assert_eq!(found, first_hit(&geometry, time, &ray, None), "the list of all");
            let truth = closest(&standing, level, &mut still_stack, &ray, None);
            let seen = |g, s: &mut Stack| shadow(g, level, s, (&ray, 30.0), None, &opaque);
            assert_eq!(seen(&geometry, &mut stack), seen(&standing, &mut still_stack));
            let (Some(found), Some(truth)) = (found, truth) else {
                assert_eq!(found, truth);
                continue;
            };
            hits += 1;
            assert_eq!(found.primitive, truth.primitive);
            assert!((found.t - truth.t).abs() < 1e-11, "{} {}", found.t, truth.t);
            let a = geometry.interaction(&stack, &ray, found);
            let b = standing.interaction(&still_stack, &ray, truth);
            assert!(a.point.distance(b.point) < 1e-11, "{} {}", a.point, b.point);
            assert!(a.geometric_normal.distance(b.geometric_normal) < 1e-10);
            assert!(a.shading_normal.distance(b.shading_normal) < 1e-10);
            assert_eq!((a.solid, a.material, a.thin), (b.solid, b.material, b.thin));
        }
    }
    assert!(hits > 4000, "{hits}");
}

#[test]
fn a_ray_that_leaves_a_moving_surface_does_not_meet_it_by_rounding() {
    for distance in [0.0, 1e3, 1e6] {
        let mut scene = moving(1.0);
        let away = DVec3::new(distance, -distance, 0.5 * distance);
        scene.solids.iter_mut().for_each(|solid| solid.placement.translate += away);
        let geometry = Geometry::build(&scene, &Progress::default()).unwrap();
        let (mut stack, mut random) = (Stack::new(&geometry), Random(8));
        let mut left = 0;
        for i in 0..4000 {
            stack.set_time(f64::from(i % 50) / 50.0);
            let mut ray = ray(&mut random);
            ray.origin += away;
            let Some(hit) = closest(&geometry, Level::new(), &mut stack, &ray, None) else {
                continue;
            };
            let at = geometry.interaction(&stack, &ray, hit);
            if !geometry.primitives.solid(hit.primitive).mesh || at.thin {
                continue;
            }
            // Out of a closed mesh: whatever of the same mesh is met next is met from outside.
            let side = if at.geometric_normal.dot(ray.direction) < 0.0 { 1.0 } else { -1.0 };
            let mut out = random.direction();
            out *= (out.dot(at.geometric_normal) * side).signum() * side;
            let (next, leaving) = geometry.spawn(&at, out);
            let inside = out.dot(at.geometric_normal) < 0.0;
            left += 1;
            let Some(hit) = closest(&geometry, Level::new(), &mut stack, &next, Some(leaving))
            else {
                assert!(!inside, "{distance}: inside of a closed mesh there is another side");
                continue;
            };
            let then = geometry.interaction(&stack, &next, hit);
            if then.solid == at.solid {
                let leaves = then.geometric_normal.dot(out) > 0.0;
                assert_eq!(leaves, inside, "{distance}: {} after {}", hit.t, at.point);
            }
        }
        assert!(left > 500, "{left}");
    }
}

#[test]
fn what_does_not_move_is_compiled_as_ever() {
    let standing = Geometry::build(&moving(0.0), &Progress::default()).unwrap();
    assert!(standing.primitives.moving.is_empty(), "the shutter opens for no time");
    let geometry = Geometry::build(&moving(0.3), &Progress::default()).unwrap();
    assert_eq!(geometry.primitives.moving.len(), 13);
    assert_eq!(geometry.primitives(), standing.primitives());
    let [a, b] = [&geometry, &standing].map(|g| g.primitives.solid_of.clone());
    assert_eq!(a, b, "primitives keep their numbers");
    let bounds = geometry.bounds().unwrap();
    let first = standing.bounds().unwrap();
    assert!(bounds[0].cmple(first[0] + 1e-9).all() && bounds[1].cmpge(first[1] - 1e-9).all());
    let mut crossed = vec![];
    let opaque = vec![true; 15];
    let mut query = Shadow::new(&geometry.primitives, 99.0, &opaque, &mut crossed);
    let ray = Ray { origin: DVec3::splat(9.0), direction: DVec3::splat(-1.0).normalize() };
    geometry.traverse_all(0.1, &ray, None, &mut query);
    assert!(query.blocker().is_some());
    assert!(build(vec![]).primitives.moving.is_empty());
}

#[test]
fn a_pattern_moves_with_its_solid() {
    let mut cube = solid(Shape::Box { min: DVec3::splat(0.1), max: DVec3::splat(0.9) });
    (cube.material, cube.motion.translate) = (1, DVec3::new(1.0, 0.0, 0.0));
    let geometry = Geometry::build(&scene(vec![cube]), &Progress::default()).unwrap();
    let mut stack = Stack::new(&geometry);
    for (time, x) in [(0.0, 0.5), (0.8, 1.3), (1.0, 1.5)] {
        stack.set_time(time);
        let ray = Ray { origin: DVec3::new(x, 0.5, 5.0), direction: DVec3::NEG_Z };
        let hit = closest(&geometry, Level::new(), &mut stack, &ray, None).unwrap();
        assert_eq!(geometry.interaction(&stack, &ray, hit).slot, 0, "{time}");
    }
}
