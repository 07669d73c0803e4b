//! The hierarchy against all primitives one by one, on every SIMD level, and the rules of ownership.

use fearless_simd::{Level, Simd};
use glam::DVec3;

use super::query::{Closest, Shadow};
use super::testing::{
    Random, build, closest, mesh_solid, moved, scene, shadow, solid, triangle_cube,
};
use super::{Geometry, Hit, Leaving, Ray, Stack, generate};
use crate::progress::{Cancelled, Progress};
use crate::scene::mesh::Mesh;
use crate::scene::{Shape, Solid};

fn knot() -> Mesh {
    generate::knot([2, 3], 0.25, [120, 16], &Progress::default()).unwrap()
}

/// The best level, the least, and one with vectors of eight, if the processor has it.
fn levels() -> Vec<Level> {
    let mut levels = vec![Level::new(), Level::baseline()];
    #[cfg(target_arch = "x86_64")]
    levels.extend(Level::new().as_avx2().map(|simd| simd.level()));
    levels
}

/// The solids, ready for rays at every level.
fn build_for_all(solids: &[Solid]) -> Vec<Geometry> {
    let scene = scene(solids.to_vec());
    let build = |level| Geometry::build_for(level, &scene, &Progress::default()).unwrap();
    levels().into_iter().map(build).collect()
}

fn brute_closest(geometry: &Geometry, ray: &Ray, leaving: Option<Leaving>) -> Option<Hit> {
    let mut query = Closest::new();
    geometry.traverse_all(0.0, ray, leaving, &mut query);
    query.hit()
}

fn brute_crossed(geometry: &Geometry, ray: &Ray, t_max: f64) -> Vec<u32> {
    let mut crossed = vec![];
    let opaque = vec![false; geometry.materials().len()];
    let mut query = Shadow::new(&geometry.primitives, t_max, &opaque, &mut crossed);
    geometry.traverse_all(0.0, ray, None, &mut query);
    crossed.sort_unstable();
    crossed
}

/// Points worth aiming at: corners of triangles, polygons and boxes, middles of edges, poles.
fn targets(geometry: &Geometry) -> Vec<DVec3> {
    let all = &geometry.primitives;
    let corner = |v: u32| super::shear::point(&all.corners[v as usize]);
    let mut targets = vec![];
    for triangle in all.triangles.iter().step_by(1 + all.triangles.len() / 2000) {
        let [a, b, _] = triangle.corners.map(corner);
        targets.extend([a, (a + b) * 0.5]);
    }
    for sphere in all.spheres.iter().step_by(1 + all.spheres.len() / 500) {
        targets.extend([sphere.center, sphere.center + DVec3::Y * sphere.radius]);
    }
    let [lo, hi] = geometry.bounds().unwrap();
    targets.extend([lo, hi, (lo + hi) * 0.5, DVec3::new(lo.x, hi.y, lo.z)]);
    targets
}

/// A third parallel to an axis with ±0, a third aimed at targets, a third random.
fn mixed_ray(random: &mut Random, geometry: &Geometry, targets: &[DVec3]) -> Ray {
    let [lo, hi] = geometry.bounds().unwrap();
    let (middle, half) = ((lo + hi) * 0.5, (hi - lo) * 0.5);
    let target = targets[random.below(targets.len())];
    let far = if random.below(8) == 0 { 1e5 } else { 1.7 };
    match random.below(3) {
        0 => {
            let axis = random.below(3);
            let zero = |bit: bool| if bit { 0.0 } else { -0.0 };
            let mut d = [zero(random.below(2) == 0), zero(random.below(2) == 0), 0.0];
            d[2] = if random.below(2) == 0 { 1.0 } else { -1.0 };
            d.rotate_left(axis);
            let through =
                if random.below(2) == 0 { target } else { middle + random.in_cube() * half };
            let mut o = through.to_array();
            let (axis, sign) = ((2 + 3 - axis) % 3, d[(2 + 3 - axis) % 3]);
            o[axis] -= sign * far * 2.0 * half.to_array()[axis];
            Ray { origin: o.into(), direction: d.into() }
        }
        1 => {
            let origin = middle + random.direction() * half * far;
            Ray { origin, direction: (target - origin).normalize_or(DVec3::X) }
        }
        _ => Ray { origin: middle + random.in_cube() * half * far, direction: random.direction() },
    }
}

/// The places where the hierarchies and the list of all primitives disagree.
fn disagreements(geometries: &[Geometry], truth: &Geometry, rays: usize, seed: u64) -> usize {
    let best = &geometries[0];
    let (mut random, targets) = (Random(seed), targets(best));
    let mut stacks: Vec<Stack> = geometries.iter().map(Stack::new).collect();
    let [lo, hi] = best.bounds().unwrap();
    let mut wrong = 0;
    let mut hits = 0;
    for i in 0..rays {
        let ray = mixed_ray(&mut random, best, &targets);
        let first = brute_closest(truth, &ray, None);
        let t_max = match first {
            Some(hit) => hit.t * if i % 2 == 0 { 1.0 } else { 1.0 + f64::EPSILON },
            None => (hi - lo).length() * 3.0,
        };
        let crossed = brute_crossed(truth, &ray, t_max);
        hits += usize::from(first.is_some());
        for (geometry, stack) in geometries.iter().zip(&mut stacks) {
            let level = geometry.level();
            let found = closest(geometry, level, stack, &ray, None);
            let same = found.map(|h| (h.t.to_bits(), h.primitive))
                == first.map(|h| (h.t.to_bits(), h.primitive));
            let opaque = vec![false; geometry.materials().len()];
            let seen = shadow(geometry, level, stack, (&ray, t_max), None, &opaque);
            wrong += usize::from(!same || seen.as_ref() != Ok(&crossed));
        }
        // A bounce from the hit.
        if let Some(hit) = first {
            let at = truth.interaction(&stacks[0], &ray, hit);
            let (ray, leaving) = truth.spawn(&at, random.direction());
            let next = brute_closest(truth, &ray, Some(leaving));
            for (geometry, stack) in geometries.iter().zip(&mut stacks) {
                let found = closest(geometry, geometry.level(), stack, &ray, Some(leaving));
                wrong += usize::from(found != next);
            }
        }
    }
    assert!(hits > rays / 20, "only {hits} of {rays} rays hit");
    wrong
}

fn boxes() -> Vec<Solid> {
    let mut random = Random(5);
    let cell = |random: &mut Random| random.below(8) as f64;
    let mut solids = vec![];
    for i in 0..150 {
        let min = DVec3::new(cell(&mut random), cell(&mut random), cell(&mut random));
        let mut one = solid(match i % 5 {
            0 => Shape::Sphere { center: min, radius: 0.5 },
            1 => Shape::Polygon { points: vec![min, min + DVec3::X, min + DVec3::ONE] },
            _ => Shape::Box { min, max: min + DVec3::ONE },
        });
        if i % 3 == 0 {
            one.placement.rotate_degrees = DVec3::new(0.0, 0.0, 30.0 * random.signed());
            one.placement.scale = DVec3::new(1.0, 1.0 + 0.5 * (i % 2) as f64, 1.0);
        }
        one.material = i % 2;
        solids.push(one);
    }
    solids.push(solid(Shape::Plane { normal: DVec3::Z, offset: 1.0 }));
    solids
}

fn flake() -> Vec<Solid> {
    vec![solid(Shape::Sphereflake { center: DVec3::ZERO, radius: 0.5, levels: 4 })]
}

/// Every solid with functions of its own, turned and stretched, close together.
fn bodies() -> Vec<Solid> {
    let mut random = Random(13);
    let keys = ["cylinder", "cone", "torus", "ellipsoid", "quadric", "prism"];
    let body = |i: usize| {
        let mut one = solid(Shape::named(keys[i % keys.len()]));
        one.placement.translate = random.in_cube() * 4.0;
        one.placement.rotate_degrees = random.in_cube() * 90.0;
        one.placement.scale = DVec3::splat(0.4 + 0.3 * random.signed());
        if i.is_multiple_of(4) {
            one.placement.scale.y *= 1.5;
        }
        one
    };
    (0..60).map(body).collect()
}

#[test]
fn bvh_is_the_list_bit_for_bit() {
    let coincident = || (0..300).map(|_| solid(Shape::Sphere { center: DVec3::ONE, radius: 1.0 }));
    let mixed = || {
        let mut all = boxes();
        all.push(mesh_solid(triangle_cube()));
        all.extend(flake());
        all
    };
    let far = DVec3::new(1e6, -1e6, 1e6);
    let scenes: Vec<(Vec<Solid>, usize)> = vec![
        (vec![mesh_solid(knot())], 14_000),
        (moved(vec![mesh_solid(knot())], 1.0, far), 4_000),
        (flake(), 30_000),
        (moved(flake(), 1.0, far), 8_000),
        (boxes(), 40_000),
        (coincident().collect(), 3_000),
        (mixed(), 10_000),
        (bodies(), 8_000),
        (moved(bodies(), 1.0, far), 2_000),
        (moved(mixed(), 1e-3, far * 1e-2), 5_000),
    ];
    for (i, (solids, rays)) in scenes.into_iter().enumerate() {
        let geometries = build_for_all(&solids);
        assert_eq!(disagreements(&geometries, &geometries[0], rays, i as u64), 0, "scene {i}");
    }
}

#[test]
fn bvh_disagreements_are_noticed() {
    let mut solids = flake();
    let geometries = build_for_all(&solids);
    solids.push(solid(Shape::Sphere { center: DVec3::X * 0.6, radius: 0.1 }));
    assert!(disagreements(&geometries, &build(solids), 1000, 1) > 0);
}

#[test]
fn bvh_of_a_hundred_thousand_coincident_spheres() {
    let one = solid(Shape::Sphere { center: DVec3::ONE, radius: 1.0 });
    let geometry = build(vec![one; 100_000]);
    let ray = Ray { origin: DVec3::new(1.0, 1.0, 5.0), direction: DVec3::NEG_Z };
    let hit = closest(&geometry, Level::new(), &mut Stack::new(&geometry), &ray, None);
    assert_eq!(hit, Some(Hit { t: 3.0, primitive: 0 }));
}

#[test]
fn bvh_of_a_million_coincident_triangles() {
    let positions = vec![DVec3::ZERO, DVec3::X, DVec3::Y];
    let triangles = vec![[0, 1, 2]; 1_000_000];
    let geometry = build(vec![mesh_solid(Mesh { positions, triangles, ..Mesh::default() })]);
    assert_eq!(geometry.primitives(), 1_000_000);
    let mut stack = Stack::new(&geometry);
    for (x, hit) in [(0.25, true), (0.75, false)] {
        let ray = Ray { origin: DVec3::new(x, 0.5, 5.0), direction: DVec3::NEG_Z };
        let first = closest(&geometry, Level::new(), &mut stack, &ray, None);
        assert_eq!(first, hit.then_some(Hit { t: 5.0, primitive: 0 }));
    }
}

#[test]
fn bvh_extreme_sizes_together() {
    let tiny = DVec3::splat(1e-30);
    let triangle = |s: f64| Mesh {
        positions: vec![DVec3::ZERO, DVec3::X * s, DVec3::Y * s],
        triangles: vec![[0, 1, 2]],
        ..Mesh::default()
    };
    let geometry = build(vec![mesh_solid(triangle(1e-30)), mesh_solid(triangle(1e30))]);
    let mut stack = Stack::new(&geometry);
    let ray = Ray { origin: tiny * 0.25 + DVec3::Z * 1e-30, direction: DVec3::NEG_Z };
    let hit = closest(&geometry, Level::new(), &mut stack, &ray, None).unwrap();
    assert_eq!(hit.primitive, 0);
    let ray = Ray { origin: DVec3::new(1e29, 1e29, 1e30), direction: DVec3::NEG_Z };
    let hit = closest(&geometry, Level::new(), &mut stack, &ray, None).unwrap();
    assert_eq!(hit.primitive, 1);
}

#[test]
fn nothing_and_cancel() {
    let geometry = build(vec![]);
    let ray = Ray { origin: DVec3::ZERO, direction: DVec3::X };
    assert_eq!(closest(&geometry, Level::new(), &mut Stack::new(&geometry), &ray, None), None);
    assert_eq!((geometry.bounds(), geometry.primitives()), (None, 0));
    let progress = Progress::default();
    progress.cancel();
    assert_eq!(Geometry::build(&scene(flake()), &progress).unwrap_err(), Cancelled);
}

#[test]
fn acne_powers_of_two_change_no_bit() {
    let mut solids = boxes();
    solids.push(mesh_solid(knot()));
    solids.extend(flake());
    for mut body in bodies().into_iter().take(12) {
        body.placement.translate = DVec3::ZERO;
        solids.push(body);
    }
    let one = build(solids.clone());
    let targets = targets(&one);
    let mut stack = Stack::new(&one);
    for exponent in [-20, 7, 20] {
        let k = 2f64.powi(exponent);
        let mut scaled = moved(solids.clone(), k, DVec3::ZERO);
        for solid in &mut scaled {
            // A plane's offset is scaled by its placement.
            assert_eq!(solid.placement.translate, DVec3::ZERO);
        }
        let scaled = build(scaled);
        let mut random = Random(3);
        for _ in 0..4000 {
            let ray = mixed_ray(&mut random, &one, &targets);
            let large = Ray { origin: ray.origin * k, ..ray };
            let a = closest(&one, Level::new(), &mut stack, &ray, None);
            let b = closest(&scaled, Level::new(), &mut stack, &large, None);
            assert_eq!(a.map(|h| (h.t * k, h.primitive)), b.map(|h| (h.t, h.primitive)));
            if let (Some(a), Some(b)) = (a, b) {
                let (p, q) =
                    (one.interaction(&stack, &ray, a), scaled.interaction(&stack, &large, b));
                assert_eq!(p.point * k, q.point);
                assert_eq!(p.geometric_normal, q.geometric_normal);
                assert_eq!(p.shading_normal, q.shading_normal);
            }
        }
    }
}

/// Crossings of a ray through the whole geometry.
fn crossings(geometry: &Geometry, stack: &mut Stack, ray: &Ray) -> usize {
    let ray = (ray, f64::INFINITY);
    let opaque = vec![false; geometry.materials().len()];
    shadow(geometry, Level::new(), stack, ray, None, &opaque).unwrap().len()
}

#[test]
fn mesh_closed_ones_are_crossed_evenly() {
    let mut random = Random(11);
    for mesh in [triangle_cube(), knot()] {
        let geometry = build(vec![mesh_solid(mesh)]);
        let targets = targets(&geometry);
        let mut stack = Stack::new(&geometry);
        for i in 0..60_000 {
            let target = targets[i % targets.len()];
            let origin = match i % 3 {
                0 => target + [DVec3::X, DVec3::Y, DVec3::Z][i % 7 % 3] * 8.0,
                1 => random.direction() * 5.0,
                _ => (DVec3::new(3.0, 4.0, 5.0) + random.in_cube().round()) * 2.0,
            };
            let ray = Ray { origin, direction: (target - origin).normalize() };
            let count = crossings(&geometry, &mut stack, &ray);
            assert_eq!(count % 2, 0, "{count} crossings from {origin} to {target}");
        }
    }
}

/// A ball of 20 · 4^`generations` triangles, whose coordinates f32 holds exactly.
fn icosphere(generations: u32) -> Mesh {
    let golden = (1.0 + 5f64.sqrt()) / 2.0;
    let mut positions = vec![];
    for (a, b) in [(1.0, golden), (-1.0, golden), (1.0, -golden), (-1.0, -golden)] {
        positions.extend([DVec3::new(0.0, a, b), DVec3::new(a, b, 0.0), DVec3::new(b, 0.0, a)]);
    }
    let apart = |i: usize, j: usize, p: &[DVec3]| (p[i] - p[j]).length() < 2.1;
    let mut triangles = vec![];
    for i in 0..12 {
        for j in i + 1..12 {
            for k in j + 1..12 {
                let p = &positions;
                if apart(i, j, p) && apart(j, k, p) && apart(k, i, p) {
                    let out = (p[j] - p[i]).cross(p[k] - p[i]).dot(p[i]) > 0.0;
                    triangles.push(if out { [i, j, k] } else { [i, k, j] }.map(|v| v as u32));
                }
            }
        }
    }
    for _ in 0..generations {
        let mut middles = std::collections::HashMap::new();
        let mut middle = |a: u32, b: u32| {
            *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                positions.push((positions[a as usize] + positions[b as usize]) / 2.0);
                positions.len() as u32 - 1
            })
        };
        let parts = triangles.iter().flat_map(|&[a, b, c]| {
            let [ab, bc, ca] = [middle(a, b), middle(b, c), middle(c, a)];
            [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
        });
        triangles = parts.collect();
    }
    let single = |p: DVec3| p.normalize().as_vec3().as_dvec3();
    let positions = positions.into_iter().map(single).collect();
    Mesh { positions, triangles, ..Mesh::default() }
}

#[test]
fn mesh_aimed_at_vertices_and_edges_of_a_ball_nothing_leaks() {
    let mesh = icosphere(5);
    assert_eq!((mesh.triangles.len(), mesh.positions.len()), (20_480, 10_242));
    let geometry = build(vec![mesh_solid(mesh.clone())]);
    let mut stack = Stack::new(&geometry);
    let mut random = Random(19);
    let rays = if std::env::var_os("RAYFOREST_LONG").is_some() { 1_000_000 } else { 200_000 };
    for i in 0..rays {
        let [a, b, _] = mesh.triangles[random.below(mesh.triangles.len())];
        let [a, b] = [a, b].map(|v| mesh.positions[v as usize]);
        let target = if i % 2 == 0 { a } else { (a + b) / 2.0 };
        let outside = i % 4 < 2;
        let origin = match outside {
            // Well above the horizon: the ray goes in and comes out.
            true => target + (target.normalize() * 1.5 + random.direction()) * 4.0,
            false => random.in_cube() * 0.5,
        };
        let ray = Ray { origin, direction: (target - origin).normalize() };
        let count = crossings(&geometry, &mut stack, &ray);
        assert_eq!(count, if outside { 2 } else { 1 }, "{ray:?} to {target}");
    }
}

#[test]
fn mesh_an_open_one_is_not_crossed_evenly() {
    let mut mesh = triangle_cube();
    mesh.triangles.pop();
    let geometry = build(vec![mesh_solid(mesh)]);
    let mut stack = Stack::new(&geometry);
    let mut random = Random(1);
    let odd = (0..1000).filter(|_| {
        let ray = Ray { origin: random.direction() * 5.0, direction: random.direction() };
        crossings(&geometry, &mut stack, &ray) % 2 == 1
    });
    assert!(odd.count() > 0);
}

#[test]
fn polygon_shared_edges_have_one_owner() {
    // The unit square as a concave and three convex pieces around (1/3, 1/3).
    let p = |x: f64, y: f64| DVec3::new(x, y, 0.25);
    let third = 1.0 / 3.0;
    let pieces = [
        vec![p(0.0, 0.0), p(1.0, 0.0), p(third, third), p(0.0, 1.0)],
        vec![p(1.0, 0.0), p(1.0, 1.0), p(third, third)],
        vec![p(1.0, 1.0), p(0.0, 1.0), p(third, third)],
    ];
    let geometry = build(pieces.map(|points| solid(Shape::Polygon { points })).to_vec());
    let mut stack = Stack::new(&geometry);
    let mut random = Random(2);
    let corners = [p(1.0, 0.0), p(1.0, 1.0), p(0.0, 1.0)];
    for i in 0..30_000 {
        let s = (i % 64) as f64 / 64.0;
        let target = p(third, third).lerp(corners[i % 3], s);
        let origin = if i % 2 == 0 {
            target + DVec3::Z
        } else {
            DVec3::new(random.signed(), random.signed(), 2.0)
        };
        let ray = Ray { origin, direction: (target - origin).normalize() };
        assert_eq!(crossings(&geometry, &mut stack, &ray), 1, "{ray:?}");
    }
}

#[test]
fn checker_on_a_boundary_shows_the_upper_cube() {
    // A plane, a box, a polygon and triangles, all with z = −1 on top.
    let points = [(3.0, 3.0), (4.0, 3.0), (4.0, 4.0), (3.0, 4.0)]
        .map(|(x, y)| DVec3::new(x, y, -1.0))
        .to_vec();
    let mesh = Mesh {
        positions: points.clone(),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..Mesh::default()
    };
    let shapes = [
        solid(Shape::Plane { normal: DVec3::Z * 7.0, offset: -1.0 }),
        solid(Shape::Box { min: DVec3::splat(-9.0), max: DVec3::new(9.0, 9.0, -1.0) }),
        solid(Shape::Polygon { points }),
        mesh_solid(mesh),
    ];
    let mut random = Random(4);
    for mut one in shapes {
        one.material = 1;
        let geometry = build(vec![one]);
        let mut stack = Stack::new(&geometry);
        for _ in 0..2000 {
            let target = DVec3::new(3.5, 3.5, -1.0) + random.in_cube() * DVec3::new(0.5, 0.5, 0.0);
            let origin = random.direction().abs() * 7.0;
            let ray = Ray { origin, direction: (target - origin).normalize() };
            let hit = closest(&geometry, Level::new(), &mut stack, &ray, None).unwrap();
            // 3 + 3 − 1 is odd.
            assert_eq!(geometry.interaction(&stack, &ray, hit).slot, 1, "{target}");
        }
    }
}
