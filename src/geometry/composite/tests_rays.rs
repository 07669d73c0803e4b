//! Solids made of others as rays meet them: meshes among them, what moves, rays from their surfaces.

use fearless_simd::Level;
use glam::DVec3;

use super::tests::{ball, crossings, csg, cube, ray};
use crate::geometry::query::Gather;
use crate::geometry::testing::{Random, build, closest, mesh_solid, triangle_cube};
use crate::geometry::{Geometry, Hit, Leaving, Ray, Stack};
use crate::scene::csg::Operation;
use crate::scene::motion::Motion;
use crate::scene::{Placement, Solid};

use Operation::{Difference, Intersection, Merge, Union};

/// A cube of triangles is the cube: bored, boring, and left by rays from every side.
#[test]
fn csg_a_closed_mesh_is_a_solid() {
    let mut random = Random(21);
    for _ in 0..60 {
        let place = Placement {
            translate: random.in_cube(),
            rotate_degrees: random.in_cube() * 180.0,
            scale: DVec3::ONE + random.in_cube() * 0.4,
        };
        let made = |mut cube: Solid| {
            cube.placement = place.clone();
            let ball = ball(place.translate, 0.9);
            let operation = csg(Difference, &[0, 1]);
            [
                build(vec![cube.clone(), ball.clone(), operation.clone()]),
                build(vec![ball, cube, operation]),
            ]
        };
        let (boxes, meshes) = (made(cube(1.0)), made(mesh_solid(triangle_cube())));
        for (of_box, of_mesh) in boxes.iter().zip(&meshes) {
            let mut stack = Stack::new(of_mesh);
            for _ in 0..40 {
                let mut ray = ray(&mut random, 3.0);
                let [a, b] = [of_box, of_mesh].map(|geometry| crossings(geometry, &ray));
                assert_eq!(a.len(), b.len());
                let mut leaving = None;
                let mut way = 0.0;
                for ((t, _), (u, primitive)) in a.iter().zip(b) {
                    assert!((t - u).abs() < 1e-12);
                    let hit = closest(of_mesh, Level::new(), &mut stack, &ray, leaving).unwrap();
                    assert_eq!(hit.primitive, primitive);
                    way += hit.t;
                    assert!((way - u).abs() < 1e-12);
                    let at = of_mesh.interaction(&stack, &ray, hit);
                    let (next, left) = of_mesh.spawn(&at, ray.direction);
                    (ray, leaving) = (next, Some(left));
                }
                assert_eq!(closest(of_mesh, Level::new(), &mut stack, &ray, leaving), None);
            }
        }
    }
}

/// From a wall of a bore, at every angle, the wall itself is not met; its other side is.
#[test]
fn acne_none_in_a_bore() {
    let mut random = Random(2);
    for scale in [1e-6, 1.0, 1e6] {
        for offset in [0.0, 1e2, 1e4, 1e6].map(|o| DVec3::splat(o * scale)) {
            let place = |mut solid: Solid| {
                (solid.placement.translate, solid.placement.scale) = (offset, DVec3::splat(scale));
                solid
            };
            let geometry =
                build(vec![place(cube(1.0)), place(ball(DVec3::Z, 0.8)), csg(Difference, &[0, 1])]);
            let mut stack = Stack::new(&geometry);
            for _ in 0..500 {
                let above = DVec3::new(0.5 * random.signed(), 0.5 * random.signed(), 3.0);
                let down = Ray { origin: offset + above * scale, direction: DVec3::NEG_Z };
                let hit = closest(&geometry, Level::new(), &mut stack, &down, None).unwrap();
                let at = geometry.interaction(&stack, &down, hit);
                assert_eq!(hit.primitive, 1, "the ball's surface");
                let mut up = random.direction();
                up *= up.dot(at.geometric_normal).signum();
                let (ray, leaving) = geometry.spawn(&at, up);
                let met = closest(&geometry, Level::new(), &mut stack, &ray, Some(leaving));
                if let Some(hit) = met {
                    // The ball is hollow: the ray crosses it.
                    let across = 1.6 * scale * up.dot(at.geometric_normal);
                    let slack = 1e-9 * (scale + offset.length() * 1e-3);
                    assert!((hit.t - across).abs() < slack, "{} of {across}", hit.t);
                }
                let into = Leaving { inside: true, ..leaving };
                let within = Ray { direction: -up, ..ray };
                let Hit { t, primitive } =
                    closest(&geometry, Level::new(), &mut stack, &within, Some(into)).unwrap();
                assert!(primitive == 0 && t > 0.0, "it leaves by the block's faces");
            }
        }
    }
}

/// What moves, within what moves, is met where it is at the ray's time; patterns stay where they were
/// as the shutter opened.
#[test]
fn csg_operands_are_where_they_are_at_the_time_of_the_ray() {
    let mut random = Random(31);
    let mut met = 0;
    for round in 0..40 {
        let mut solids = vec![
            if round % 2 == 0 { cube(0.8) } else { mesh_solid(triangle_cube()) },
            ball(DVec3::new(0.5, 0.2, 0.6), 0.7),
            csg([Difference, Merge, Intersection, Union][round % 4], &[0, 1]),
        ];
        for solid in &mut solids {
            solid.placement = Placement {
                translate: random.in_cube() * 0.2,
                rotate_degrees: random.in_cube() * 90.0,
                scale: DVec3::ONE + random.in_cube() * 0.3,
            };
            solid.motion = Motion {
                translate: random.in_cube(),
                rotate_degrees: random.in_cube() * [0.0, 200.0][random.below(2)],
            };
        }
        let at = |time: f64| {
            let mut still = solids.clone();
            for solid in &mut still {
                solid.placement = solid.placement.at(&solid.motion, time);
                solid.motion = Motion::default();
            }
            build(still)
        };
        let moving = build(solids.clone());
        let (mut stack, opening) = (Stack::new(&moving), at(0.0));
        for time in [0.0, 0.37, 1.0] {
            let still = at(time);
            stack.set_time(time);
            for _ in 0..40 {
                let ray = ray(&mut random, 4.0);
                let [a, b] = [(&moving, &mut stack), (&still, &mut Stack::new(&still))].map(
                    |(geometry, stack)| {
                        let hit = closest(geometry, Level::new(), stack, &ray, None)?;
                        Some((hit, geometry.interaction(stack, &ray, hit)))
                    },
                );
                let (Some((hit, a)), Some((same, b))) = (a, b) else {
                    assert!(a.is_none() && b.is_none(), "{a:?} {b:?}");
                    continue;
                };
                assert_eq!(hit.primitive, same.primitive);
                assert!((hit.t - same.t).abs() < 1e-11, "{} {}", hit.t, same.t);
                assert!((a.geometric_normal - b.geometric_normal).length() < 1e-9);
                if time == 0.0 {
                    assert!((a.rest - b.rest).length() < 1e-11);
                } else {
                    // Where it was, the same surface was.
                    let from = a.rest - ray.direction;
                    let back = Ray { origin: from, direction: ray.direction };
                    let all = all_crossings(&opening, &back);
                    let near = all.iter().any(|(t, _)| (t - 1.0).abs() < 1e-6);
                    let covered = round % 4 != 3;
                    assert!(near || covered, "{all:?}");
                }
                met += 1;
            }
        }
    }
    assert!(met > 1000, "{met}");
}

/// Every crossing, by brute force.
fn all_crossings(geometry: &Geometry, ray: &Ray) -> Vec<(f64, u32)> {
    let mut all = Vec::new();
    geometry.traverse_all(0.0, ray, None, &mut Gather { hits: &mut all, t_max: f64::INFINITY });
    all
}
