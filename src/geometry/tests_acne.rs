//! Rays that leave a surface: never stopped by it, always by what lies just above it.

use crate::progress::Progress;
use fearless_simd::Level;
use glam::{DVec2, DVec3};

use super::generate;
use super::shear::point;
use super::testing::{Random, build, closest, mesh_solid, moved, shadow, solid, triangle_cube};
use super::{Geometry, Hit, Interaction, Ray, Stack};
use crate::scene::mesh::Mesh;
use crate::scene::{Placement, Shape, Solid};

const OPAQUE: [bool; 2] = [true; 2];

/// Convex bodies of about size 1 around the origin. No ray that leaves one outward meets it again.
fn convex() -> Vec<(&'static str, Solid)> {
    let corner = DVec3::new(0.8, 0.9, 1.0);
    let cuboid = || solid(Shape::Box { min: -corner, max: corner });
    let sphere = || solid(Shape::Sphere { center: DVec3::ZERO, radius: 1.0 });
    let turned = |mut solid: Solid, scale: DVec3| {
        let rotate_degrees = DVec3::new(20.0, 30.0, 40.0);
        solid.placement = Placement { rotate_degrees, scale, ..Placement::default() };
        solid
    };
    let cone = Shape::Cone { from: corner, to: -corner, radius: 0.9, tip: 0.4 };
    let half_space = Shape::Quadric {
        squares: DVec3::ZERO,
        products: DVec3::ZERO,
        linear: DVec3::new(1.0, 2.0, 1.0),
        constant: -1.2,
        min: -corner,
        max: corner,
    };
    let outline = [[-0.9, -0.7], [0.8, -0.8], [1.0, 0.3], [0.1, 0.9], [-0.8, 0.6]];
    let outline = vec![outline.map(DVec2::from).to_vec()];
    vec![
        ("sphere", sphere()),
        ("ellipsoid", turned(sphere(), DVec3::new(1.0, 0.5, 0.8))),
        ("box", cuboid()),
        ("turned box", turned(cuboid(), DVec3::ONE)),
        ("cylinder", turned(solid(Shape::named("cylinder")), DVec3::new(0.6, 0.6, 0.9))),
        ("cone", turned(solid(Shape::named("cone")), DVec3::ONE)),
        ("truncated cone", solid(cone)),
        ("stretched cone", turned(solid(Shape::named("cone")), DVec3::new(1.0, 0.8, 0.9))),
        ("block of a quadric", turned(solid(half_space), DVec3::ONE)),
        ("prism", turned(solid(Shape::Prism { outline, bottom: -0.8, top: 0.9 }), DVec3::ONE)),
        ("cube of triangles", turned(mesh_solid(triangle_cube()), DVec3::ONE)),
        ("ball of triangles", mesh_solid(ball())),
    ]
}

/// A convex closed mesh with poles, smooth enough for flat angles between its triangles.
fn ball() -> Mesh {
    let (rows, columns) = (24, 40);
    let mut mesh = Mesh { positions: vec![DVec3::Z, DVec3::NEG_Z], ..Mesh::default() };
    for i in 1..rows {
        let a = std::f64::consts::PI * f64::from(i) / f64::from(rows);
        for j in 0..columns {
            let b = std::f64::consts::TAU * f64::from(j) / f64::from(columns);
            mesh.positions.push(DVec3::new(a.sin() * b.cos(), a.sin() * b.sin(), a.cos()));
        }
    }
    let at = |i: u32, j: u32| 2 + (i - 1) * columns + j % columns;
    for j in 0..columns {
        mesh.triangles.push([0, at(1, j), at(1, j + 1)]);
        mesh.triangles.push([1, at(rows - 1, j + 1), at(rows - 1, j)]);
        for i in 1..rows - 1 {
            mesh.triangles.push([at(i, j), at(i + 1, j), at(i + 1, j + 1)]);
            mesh.triangles.push([at(i, j), at(i + 1, j + 1), at(i, j + 1)]);
        }
    }
    mesh
}

/// Scales and offsets whose bodies are at least 2^20 steps of f64 coordinates large; smaller ones
/// (1e-6 at 1e4 and beyond) are below what the coordinates can tell apart.
fn resolvable() -> Vec<(f64, DVec3)> {
    let mut all = vec![];
    for scale in [1e-6, 1e-3, 1.0, 1e3, 1e6] {
        for offset in [0.0, 1e2, 1e4, 1e6] {
            if scale > offset * f64::EPSILON * 2f64.powi(20) {
                all.push((scale, DVec3::new(offset, -offset, offset)));
            }
        }
    }
    all
}

/// A point of the surface as seen from around; if `aimed`, a third of them on a vertex or an edge.
fn surface_point(
    geometry: &Geometry,
    stack: &mut Stack,
    random: &mut Random,
    (scale, offset): (f64, DVec3),
    aimed: bool,
) -> Option<Interaction> {
    let origin = offset + random.direction() * (scale * 3.0);
    let all = &geometry.primitives;
    let target = if aimed && !all.corners.is_empty() && random.below(3) == 0 {
        let triangle = &all.triangles[random.below(all.triangles.len())];
        let [a, b, _] = all.triangle_corners(triangle).map(point);
        a.lerp(b, random.below(3) as f64 / 2.0)
    } else {
        offset + random.in_cube() * (scale * 0.6)
    };
    let ray = Ray { origin, direction: (target - origin).normalize() };
    let hit = closest(geometry, Level::new(), stack, &ray, None)?;
    Some(geometry.interaction(stack, &ray, hit))
}

/// Of `count` rays that leave a surface to the outside, how many are stopped.
fn self_shadows(geometry: &Geometry, place: (f64, DVec3), count: usize, seed: u64) -> usize {
    let (mut random, mut stack) = (Random(seed), Stack::new(geometry));
    let (mut tried, mut stopped) = (0, 0);
    while tried < count {
        let Some(at) = surface_point(geometry, &mut stack, &mut random, place, true) else {
            continue;
        };
        let mut direction = random.direction();
        if random.below(3) == 0 {
            // Grazing, but steeper than the folds that rounded corners put into flat faces.
            let n = at.geometric_normal;
            let slope = 1e-7 + 64.0 * f64::EPSILON * place.1.length() / place.0;
            direction = ((direction - n * n.dot(direction)).normalize() + n * slope).normalize();
        }
        if direction.dot(at.geometric_normal) < 0.0 {
            direction = -direction;
        }
        let (ray, leaving) = geometry.spawn(&at, direction);
        let light = (&ray, f64::INFINITY);
        let seen = shadow(geometry, Level::new(), &mut stack, light, Some(leaving), &OPAQUE);
        stopped += usize::from(seen.is_err());
        tried += 1;
    }
    stopped
}

#[test]
fn acne_convex_bodies_never_shadow_themselves() {
    for (scale, offset) in resolvable() {
        for (name, body) in convex() {
            let geometry = build(moved(vec![body], scale, offset));
            let rays = if std::env::var_os("RAYFOREST_LONG").is_some() { 100_000 } else { 15_000 };
            let stopped = self_shadows(&geometry, (scale, offset), rays, 9);
            assert_eq!(stopped, 0, "{name} of size {scale} at {offset}");
        }
    }
}

#[test]
fn acne_self_shadows_are_noticed() {
    let body = |x| {
        let center = DVec3::X * x;
        solid(Shape::Sphere { center, radius: 1.0 })
    };
    let geometry = build(vec![body(0.0), body(0.5)]);
    assert!(self_shadows(&geometry, (1.0, DVec3::ZERO), 1000, 9) > 0);
}

#[test]
fn acne_what_goes_in_comes_out() {
    for (scale, offset) in resolvable() {
        for (name, body) in convex() {
            let geometry = build(moved(vec![body], scale, offset));
            let (mut random, mut stack) = (Random(3), Stack::new(&geometry));
            for _ in 0..2_000 {
                let place = (scale, offset);
                let Some(at) = surface_point(&geometry, &mut stack, &mut random, place, true)
                else {
                    continue;
                };
                // Towards somewhere well inside.
                let target = offset + random.in_cube() * (scale * 0.2);
                let direction = (target - at.point).normalize();
                let (ray, leaving) = geometry.spawn(&at, direction);
                assert!(leaving.inside);
                let out = closest(&geometry, Level::new(), &mut stack, &ray, Some(leaving));
                let out = out.unwrap_or_else(|| panic!("{name} {scale} {offset}: lost inside"));
                assert!(out.t > 0.1 * scale, "{name} of size {scale} at {offset}: {}", out.t);
                let normal = geometry.interaction(&stack, &ray, out).geometric_normal;
                assert!(normal.dot(direction) > 0.0);
            }
        }
    }
}

#[test]
fn acne_planes_and_polygons_never_shadow_themselves() {
    let points = vec![DVec3::NEG_ONE, DVec3::new(1.0, -1.0, 0.3), DVec3::ONE];
    let shapes = [
        Shape::Plane { normal: DVec3::new(1.0, 2.0, 3.0), offset: 0.1 },
        Shape::Plane { normal: DVec3::Z, offset: 0.1 },
        Shape::Polygon { points },
    ];
    for (scale, offset) in resolvable() {
        for shape in shapes.clone() {
            let geometry = build(moved(vec![solid(shape)], scale, offset));
            assert_eq!(self_shadows(&geometry, (scale, offset), 6_000, 5), 0);
        }
    }
}

#[test]
fn acne_rays_from_a_knot_meet_it_only_elsewhere() {
    // Not convex: a ray may meet it again, but only from the side that it is on. Not aimed at edges:
    // there rounding decides whether a ray that goes into one face and out of the other is inside.
    let knot =
        || mesh_solid(generate::knot([2, 3], 0.25, [120, 16], &Progress::default()).unwrap());
    for (scale, offset) in resolvable() {
        let geometry = build(moved(vec![knot()], scale, offset));
        let (mut random, mut stack) = (Random(3), Stack::new(&geometry));
        for _ in 0..6_000 {
            let place = (scale, offset);
            let Some(at) = surface_point(&geometry, &mut stack, &mut random, place, false) else {
                continue;
            };
            let (ray, leaving) = geometry.spawn(&at, random.direction());
            let Some(hit) = closest(&geometry, Level::new(), &mut stack, &ray, Some(leaving))
            else {
                assert!(!leaving.inside, "lost inside");
                continue;
            };
            let facing =
                geometry.interaction(&stack, &ray, hit).geometric_normal.dot(ray.direction);
            assert_eq!(facing > 0.0, leaving.inside, "size {scale} at {offset}: {}", hit.t);
        }
    }
}

/// Bodies that a ray may meet again after it left them.
fn hollow() -> Vec<(&'static str, Solid)> {
    let star = |i: u32| {
        let angle = f64::from(i) * std::f64::consts::PI / 7.0;
        DVec2::from_angle(angle) * if i.is_multiple_of(2) { 1.0 } else { 0.45 }
    };
    let hole = [[-0.2, -0.2], [0.3, -0.1], [0.0, 0.3]].map(DVec2::from).to_vec();
    let outline = vec![(0..14).map(star).collect(), hole];
    vec![
        ("torus", solid(Shape::Torus { major: 0.7, minor: 0.3 })),
        ("thin torus", solid(Shape::Torus { major: 0.8, minor: 0.05 })),
        ("torus without a hole", solid(Shape::Torus { major: 0.4, minor: 0.6 })),
        ("hyperboloid", solid(Shape::named("quadric"))),
        ("star", solid(Shape::Prism { outline, bottom: -0.6, top: 0.7 })),
    ]
}

#[test]
fn acne_rays_from_hollow_bodies_meet_them_only_elsewhere() {
    for (scale, offset) in resolvable() {
        for (i, (name, mut body)) in hollow().into_iter().enumerate() {
            body.placement.rotate_degrees = DVec3::new(20.0, 30.0, 40.0);
            if i % 2 == 0 {
                body.placement.scale = DVec3::new(1.0, 0.8, 1.1);
            }
            let geometry = build(moved(vec![body], scale, offset));
            let (mut random, mut stack) = (Random(3), Stack::new(&geometry));
            let mut left = 0;
            while left < 3_000 {
                let place = (scale, offset);
                let Some(at) = surface_point(&geometry, &mut stack, &mut random, place, false)
                else {
                    continue;
                };
                left += 1;
                let (ray, leaving) = geometry.spawn(&at, random.direction());
                let Some(hit) = closest(&geometry, Level::new(), &mut stack, &ray, Some(leaving))
                else {
                    assert!(!leaving.inside, "{name} of size {scale} at {offset}: lost inside");
                    continue;
                };
                let normal = geometry.interaction(&stack, &ray, hit).geometric_normal;
                let leaves = normal.dot(ray.direction) > 0.0;
                assert_eq!(leaves, leaving.inside, "{name} of size {scale} at {offset}: {}", hit.t);
            }
        }
    }
}

#[test]
fn acne_none_on_the_outer_half_of_a_torus() {
    // There the surface is convex: what leaves it does not come back.
    for (scale, offset) in resolvable() {
        let body = solid(Shape::Torus { major: 0.7, minor: 0.3 });
        let geometry = build(moved(vec![body], scale, offset));
        let (mut random, mut stack) = (Random(5), Stack::new(&geometry));
        let mut left = 0;
        while left < 8_000 {
            let place = (scale, offset);
            let Some(at) = surface_point(&geometry, &mut stack, &mut random, place, false) else {
                continue;
            };
            if (at.point - offset).truncate().length() < 0.705 * scale {
                continue;
            }
            let mut direction = random.direction();
            direction *= direction.dot(at.geometric_normal).signum();
            let (ray, leaving) = geometry.spawn(&at, direction);
            let light = (&ray, f64::INFINITY);
            let seen = shadow(&geometry, Level::new(), &mut stack, light, Some(leaving), &OPAQUE);
            assert_eq!(seen, Ok(vec![]), "size {scale} at {offset}: {at:?} {direction}");
            left += 1;
        }
    }
}

#[test]
fn acne_an_occluder_just_above_still_shadows() {
    // A lid over the top of each body, 1e-9 of its size above it, at every resolvable offset.
    for offset in [0.0, 1e2, 1e4, 1e6] {
        let offset = DVec3::splat(offset);
        let gap = 1e-9;
        // Lies on its outer equator.
        let mut torus = solid(Shape::Torus { major: 0.7, minor: 0.3 });
        torus.placement.rotate_degrees = DVec3::new(90.0, 0.0, 0.0);
        torus.placement.translate = DVec3::NEG_Z;
        for body in [
            solid(Shape::Sphere { center: DVec3::NEG_Z, radius: 1.0 }),
            solid(Shape::Box { min: DVec3::new(-1.0, -1.0, -1.0), max: DVec3::new(1.0, 1.0, 0.0) }),
            solid(Shape::Plane { normal: DVec3::Z, offset: 0.0 }),
            solid(Shape::Cylinder { from: DVec3::NEG_Z, to: DVec3::ZERO, radius: 1.0 }),
            solid(Shape::Cylinder {
                from: DVec3::new(-1.0, 0.0, -1.0),
                to: DVec3::new(1.0, 0.0, -1.0),
                radius: 1.0,
            }),
            torus,
            mesh_solid(Mesh {
                positions: triangle_cube().positions.iter().map(|p| *p - DVec3::Z).collect(),
                ..triangle_cube()
            }),
        ] {
            let lids = [
                Shape::Box { min: DVec3::new(-2.0, -2.0, gap), max: DVec3::new(2.0, 2.0, 1.0) },
                Shape::Polygon {
                    points: [(-2.0, -2.0), (2.0, -2.0), (2.0, 2.0), (-2.0, 2.0)]
                        .map(|(x, y)| DVec3::new(x, y, gap))
                        .to_vec(),
                },
            ];
            for lid in lids {
                lid_shadows(moved(vec![body.clone(), solid(lid)], 1.0, offset), offset);
            }
        }
    }
}

fn lid_shadows(solids: Vec<Solid>, offset: DVec3) {
    let bare = build(solids[..1].to_vec());
    let geometry = build(solids);
    let (mut random, mut stack) = (Random(6), Stack::new(&geometry));
    for _ in 0..500 {
        // Near the top, where the gap is still the gap.
        let origin = offset + random.in_cube() * DVec3::new(1e-6, 1e-6, 0.0) + DVec3::Z * 3.0;
        let ray = Ray { origin, direction: DVec3::NEG_Z };
        let hit: Hit = closest(&bare, Level::new(), &mut stack, &ray, None).unwrap();
        let at = bare.interaction(&stack, &ray, hit);
        let direction = (DVec3::Z * 1.5 + random.in_cube()).normalize();
        let (ray, leaving) = geometry.spawn(&at, direction);
        let light = (&ray, f64::INFINITY);
        let seen = shadow(&geometry, Level::new(), &mut stack, light, Some(leaving), &OPAQUE);
        // The lid.
        assert_eq!(seen, Err(1), "{ray:?}");
    }
}
