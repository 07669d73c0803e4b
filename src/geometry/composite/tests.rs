//! Solids made of others, against the definition: what is inside, point by point.

use fearless_simd::Level;
use glam::DVec3;

use crate::geometry::placement::Placed;
use crate::geometry::query::Gather;
use crate::geometry::testing::{Random, build, closest, solid};
use crate::geometry::{Geometry, Ray, Stack};
use crate::scene::csg::Operation;
use crate::scene::{Placement, Shape, Solid};

use Operation::{Complement, Difference, Intersection, Merge, Union};

pub(super) fn csg(operation: Operation, operands: &[usize]) -> Solid {
    solid(Shape::Csg { operation, operands: operands.to_vec() })
}

pub(super) fn ball(center: DVec3, radius: f64) -> Solid {
    solid(Shape::Sphere { center, radius })
}

fn block(min: DVec3, max: DVec3) -> Solid {
    solid(Shape::Box { min, max })
}

pub(super) fn cube(half: f64) -> Solid {
    block(DVec3::splat(-half), DVec3::splat(half))
}

fn below(height: f64) -> Solid {
    solid(Shape::Plane { normal: DVec3::Z, offset: height })
}

/// Every crossing of a ray, in order, by the hierarchy; without it they are the same.
pub(super) fn crossings(geometry: &Geometry, ray: &Ray) -> Vec<(f64, u32)> {
    let mut stack = Stack::new(geometry);
    let (mut met, mut all) = (Vec::new(), Vec::new());
    let simd = Level::new();
    fearless_simd::dispatch!(simd, simd =>
        geometry.traverse(simd, &mut stack, ray, None, &mut Gather { hits: &mut met, t_max: f64::INFINITY }));
    geometry.traverse_all(0.0, ray, None, &mut Gather { hits: &mut all, t_max: f64::INFINITY });
    let order = |a: &(f64, u32), b: &(f64, u32)| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1));
    met.sort_by(order);
    all.sort_by(order);
    assert_eq!(met, all, "the hierarchy leaves something out");
    met
}

fn ts(solids: &[Solid], ray: &Ray) -> Vec<f64> {
    crossings(&build(solids.to_vec()), ray).into_iter().map(|(t, _)| t).collect()
}

/// A ray from within a cube to a point near the middle.
pub(super) fn ray(random: &mut Random, reach: f64) -> Ray {
    let (origin, to) = (random.in_cube() * reach, random.in_cube() * 0.8);
    Ray { origin, direction: (to - origin).normalize() }
}

/// Whether a point is in a solid; `None` where a surface is nearer than `margin`.
fn contains(solids: &[Solid], index: usize, point: DVec3, margin: f64) -> Option<bool> {
    let Solid { shape, placement, .. } = &solids[index];
    let placed = Placed::new(placement);
    let p = placed.point_to_object(point);
    // Of how far p is inside, in object units.
    let sided =
        |depth: f64| (depth.abs() > margin / placement.scale.min_element()).then_some(depth > 0.0);
    match shape {
        Shape::Sphere { center, radius } => sided(radius - (p - *center).length()),
        Shape::Box { min, max } => sided((p - *min).min(*max - p).min_element()),
        Shape::Plane { normal, offset } => sided(offset - normal.normalize().dot(p)),
        Shape::Ellipsoid { center, radii } => {
            sided((1.0 - ((p - *center) / *radii).length()) * radii.min_element())
        }
        Shape::Torus { major, minor } => sided(minor - (p.truncate().length() - major).hypot(p.z)),
        Shape::Cylinder { from, to, radius } => sided(frustum(p, [*from, *to], [*radius; 2])),
        Shape::Cone { from, to, radius, tip } => sided(frustum(p, [*from, *to], [*radius, *tip])),
        Shape::Csg { operation, operands } => {
            let inside = |&i: &usize| contains(solids, i, p, margin);
            let of: Option<Vec<bool>> = operands.iter().map(inside).collect();
            let of = of?;
            Some(match operation {
                Union | Merge => of.contains(&true),
                Intersection => !of.contains(&false),
                Difference => of[0] && !of[1..].contains(&true),
                Complement => !of.contains(&true),
            })
        }
        _ => panic!("no rule for {shape:?}"),
    }
}

/// How far a point is inside a cone that is cut off: from its side, or from an end.
fn frustum(p: DVec3, [from, to]: [DVec3; 2], [first, last]: [f64; 2]) -> f64 {
    let length = (to - from).length();
    let axis = (to - from) / length;
    let z = (p - from).dot(axis);
    let slope = (last - first) / length;
    let side = first + slope * z - (p - from - axis * z).length();
    (side / 1f64.hypot(slope)).min(z).min(length - z)
}

/// One of seven kinds of plain solids, of about size 1.
fn random_body(random: &mut Random) -> Solid {
    let (a, b) = (random.in_cube(), random.in_cube());
    let size = 0.6 + 0.4 * random.signed();
    let (from, to) = (a, b + (b - a).normalize_or(DVec3::X) * 0.2);
    solid(match random.below(7) {
        0 => Shape::Sphere { center: a, radius: size },
        1 => Shape::Box { min: a.min(b) - 0.1, max: a.max(b) + 0.1 },
        2 => Shape::Plane { normal: random.direction(), offset: a.x },
        3 => Shape::Cylinder { from, to, radius: size },
        4 => Shape::Cone { from, to, radius: size, tip: [0.0, a.x.abs()][random.below(2)] },
        5 => Shape::Torus { major: 0.9, minor: size },
        _ => Shape::Ellipsoid { center: a, radii: DVec3::splat(size) + b.abs() * 0.5 },
    })
}

/// A random tree of operations over such solids, added to the list.
fn random_tree(random: &mut Random, depth: u32, solids: &mut Vec<Solid>) -> usize {
    let mut made = if depth == 0 || random.below(5) == 0 {
        random_body(random)
    } else {
        let count = 1 + random.below(3);
        let operands: Vec<usize> =
            (0..count).map(|_| random_tree(random, depth - 1, solids)).collect();
        csg([Merge, Intersection, Difference, Complement][random.below(4)], &operands)
    };
    if random.below(2) == 0 {
        made.placement = Placement {
            translate: random.in_cube() * 0.5,
            rotate_degrees: random.in_cube() * 180.0,
            scale: DVec3::ONE + random.in_cube() * [0.0, 0.2][random.below(2)],
        };
    }
    solids.push(made);
    solids.len() - 1
}

/// A random solid made of at most `depth` generations of others, added to the list.
fn random_solid(random: &mut Random, depth: u32, solids: &mut Vec<Solid>) -> usize {
    let mut made = match random.below(if depth > 0 { 6 } else { 2 }) {
        0 => ball(random.in_cube(), 0.6 + 0.4 * random.signed()),
        1 if random.below(4) == 0 => {
            solid(Shape::Plane { normal: random.direction(), offset: random.signed() })
        }
        1 => {
            let (a, b) = (random.in_cube(), random.in_cube());
            block(a.min(b) - 0.1, a.max(b) + 0.1)
        }
        kind => {
            let count = 1 + random.below(4);
            let operands: Vec<usize> =
                (0..count).map(|_| random_solid(random, depth - 1, solids)).collect();
            csg(Operation::ALL[[1, 2, 3, 4][kind - 2]], &operands)
        }
    };
    if random.below(2) == 0 {
        made.placement = Placement {
            translate: random.in_cube() * 0.5,
            rotate_degrees: random.in_cube() * 180.0,
            scale: DVec3::ONE + random.in_cube() * [0.0, 0.4][random.below(2)],
        };
    }
    solids.push(made);
    solids.len() - 1
}

#[test]
fn csg_midpoints_of_intervals_are_members() {
    let mut random = Random(7);
    let (mut tested, mut inside_seen) = (0, 0);
    for _ in 0..400 {
        let mut solids = Vec::new();
        let whole = random_solid(&mut random, 4, &mut solids);
        if !solids[whole].shape.is_composite() {
            continue;
        }
        let geometry = build(solids.clone());
        for _ in 0..40 {
            let ray = ray(&mut random, 3.0);
            let [all, inside] = walk(&solids, whole, &geometry, &ray, [1e-12, 1e-9]);
            (tested, inside_seen) = (tested + all, inside_seen + inside);
        }
    }
    assert!(tested > 10_000 && inside_seen > 3_000, "{tested} {inside_seen}");
}

/// Holds what is between the crossings of a ray to the definition: the middle of every interval, and
/// seven points of it, by their margins. Gives how many middles were decided, and how many are inside.
fn walk(
    solids: &[Solid],
    whole: usize,
    geometry: &Geometry,
    ray: &Ray,
    margins: [f64; 2],
) -> [usize; 2] {
    let mut ts = vec![0.0];
    ts.extend(crossings(geometry, ray).iter().map(|(t, _)| *t));
    ts.push(ts[ts.len() - 1] + 3.0);
    let (mut before, mut counts) = (None, [0, 0]);
    let at = |t: f64, margin: f64| contains(solids, whole, ray.origin + ray.direction * t, margin);
    for pair in ts.windows(2) {
        let inside = at((pair[0] + pair[1]) * 0.5, margins[0]);
        counts[0] += usize::from(inside.is_some());
        counts[1] += usize::from(inside == Some(true));
        if let (Some(before), Some(inside)) = (before, inside) {
            assert_ne!(before, inside, "nothing begins or ends between {pair:?} of {solids:?}");
        }
        before = inside;
        // And nothing is missing in between.
        for k in 1..8 {
            let t = pair[0] + (pair[1] - pair[0]) * f64::from(k) / 8.0;
            let at = at(t, margins[1]);
            assert!(at.is_none() || inside.is_none() || at == inside, "{t} of {solids:?}");
        }
    }
    counts
}

/// 16 ε (|t| + |centre|) of what is up to ten away from the origin of rays within three.
const SIXTEEN_ROUNDINGS: f64 = 16.0 * f64::EPSILON * 30.0;

#[test]
fn csg_trees_of_seven_kinds_six_deep_agree_with_membership() {
    let mut random = Random(17);
    let trees = if std::env::var_os("RAYFOREST_LONG").is_some() { 2_500 } else { 400 };
    let mut sum = [0, 0];
    for _ in 0..trees {
        let mut solids = Vec::new();
        let whole = random_tree(&mut random, 6, &mut solids);
        if !solids[whole].shape.is_composite() {
            continue;
        }
        let geometry = build(solids.clone());
        for _ in 0..40 {
            let ray = ray(&mut random, 3.0);
            let counts = walk(&solids, whole, &geometry, &ray, [SIXTEEN_ROUNDINGS; 2]);
            sum = [sum[0] + counts[0], sum[1] + counts[1]];
        }
    }
    assert!(sum[0] > 40 * trees && sum[1] > 8 * trees, "{sum:?} of {trees}");
}

#[test]
fn csg_tangents_are_crossed_evenly() {
    // Past a ball, a rod and a ring, just within and just beyond, each less something far below.
    let ring = Shape::Torus { major: 0.75, minor: 0.25 };
    let rod = Shape::Cylinder { from: DVec3::NEG_Z, to: DVec3::Z, radius: 1.0 };
    for body in [ball(DVec3::ZERO, 1.0), solid(rod), solid(ring)] {
        let solids = [body, below(-9.0), csg(Difference, &[0, 1])];
        for exponent in 2..=15 {
            for sign in [-1.0, 1.0] {
                let x = 1.0 + sign * 10f64.powi(-exponent);
                let ray = Ray { origin: DVec3::new(x, -5.0, 0.0), direction: DVec3::Y };
                let count = ts(&solids, &ray).len();
                let clear = exponent < 14;
                assert!(count.is_multiple_of(2) && count <= 2, "{count} at {x}");
                assert!(!clear || (count == 2) == (sign < 0.0), "{count} at {x}");
            }
        }
    }
}

#[test]
fn csg_a_membership_that_is_wrong_is_seen() {
    let solids = [cube(1.0), ball(DVec3::ZERO, 1.2), csg(Difference, &[0, 1])];
    assert_eq!(contains(&solids, 2, DVec3::splat(0.9), 1e-9), Some(true));
    assert_eq!(contains(&solids, 2, DVec3::ZERO, 1e-9), Some(false));
    assert_eq!(contains(&solids, 2, DVec3::new(1.0, 0.8, 0.8), 1e-9), None);
}

#[test]
fn csg_normals_point_out_of_the_whole_and_rays_leave_as_they_were_met() {
    let mut random = Random(11);
    let mut met = 0;
    for _ in 0..300 {
        let mut solids = Vec::new();
        let whole = random_solid(&mut random, 3, &mut solids);
        if !solids[whole].shape.is_composite() {
            continue;
        }
        let geometry = build(solids.clone());
        let mut stack = Stack::new(&geometry);
        for _ in 0..30 {
            let from = ray(&mut random, 3.0);
            let all = crossings(&geometry, &from);
            let (mut ray, mut leaving, mut way) = (from, None, 0.0);
            for (t, primitive) in all {
                let hit = closest(&geometry, Level::new(), &mut stack, &ray, leaving).unwrap();
                assert_eq!(hit.primitive, primitive, "{solids:?}");
                assert!((way + hit.t - t).abs() < 1e-12, "{} {t}", way + hit.t);
                let at = geometry.interaction(&stack, &ray, hit);
                let entering = at.geometric_normal.dot(ray.direction) < 0.0;
                let step = at.geometric_normal * 1e-7;
                let [out, within] =
                    [step, -step].map(|s| contains(&solids, whole, at.point + s, 1e-10));
                if let (Some(out), Some(within)) = (out, within) {
                    assert!(!out && within, "the normal points in: {solids:?}");
                    met += 1;
                }
                assert_eq!(at.body as usize, whole);
                let (next, left) = geometry.spawn(&at, ray.direction);
                assert_eq!(left.inside, entering);
                (ray, leaving, way) = (next, Some(left), way + hit.t);
            }
            assert_eq!(
                closest(&geometry, Level::new(), &mut stack, &ray, leaving),
                None,
                "{solids:?}"
            );
        }
    }
    assert!(met > 800, "{met}");
}

/// The crossings of solids with these ways to make a last one of them must be the same, to the bit.
fn same(solids: &[Solid], ways: &[Vec<Solid>], random: &mut Random) {
    let geometries: Vec<Geometry> =
        ways.iter().map(|way| build(solids.iter().chain(way).cloned().collect())).collect();
    let mut met = 0;
    for _ in 0..300 {
        let ray = ray(random, 3.0);
        let first: Vec<f64> = crossings(&geometries[0], &ray).iter().map(|(t, _)| *t).collect();
        met += first.len();
        for (other, way) in geometries.iter().zip(ways) {
            let ts: Vec<f64> = crossings(other, &ray).iter().map(|(t, _)| *t).collect();
            assert_eq!(ts, first, "{way:?}");
        }
    }
    assert!(met > 100, "the rays meet it");
}

#[test]
fn csg_laws_of_the_algebra() {
    let mut random = Random(3);
    let mut turned = cube(0.9);
    turned.placement.rotate_degrees = DVec3::new(20.0, 30.0, 40.0);
    let solids = [ball(DVec3::new(0.3, 0.0, 0.0), 1.0), turned, ball(DVec3::Y * 0.7, 0.8)];
    let (a, b, c) = (0, 1, 2);
    // A ∩ A = A ∪ A = A.
    same(
        &solids[..1],
        &[vec![csg(Merge, &[a])], vec![csg(Merge, &[a, a])], vec![csg(Intersection, &[a, a])]],
        &mut random,
    );
    // A − B = A ∩ ¬B.
    same(
        &solids[..2],
        &[vec![csg(Difference, &[a, b])], vec![csg(Complement, &[b]), csg(Intersection, &[a, 2])]],
        &mut random,
    );
    // De Morgan, twice: ¬(A ∪ B) = ¬A ∩ ¬B, ¬(A ∩ B) = ¬A ∪ ¬B.
    let [not_a, not_b] = [csg(Complement, &[a]), csg(Complement, &[b])];
    same(
        &solids[..2],
        &[
            vec![csg(Merge, &[a, b]), csg(Complement, &[2])],
            vec![csg(Complement, &[a, b])],
            vec![not_a.clone(), not_b.clone(), csg(Intersection, &[2, 3])],
        ],
        &mut random,
    );
    same(
        &solids[..2],
        &[
            vec![csg(Intersection, &[a, b]), csg(Complement, &[2])],
            vec![not_a.clone(), not_b.clone(), csg(Merge, &[2, 3])],
        ],
        &mut random,
    );
    // Any order, any nesting.
    for operation in [Merge, Intersection] {
        same(
            &solids,
            &[
                vec![csg(operation, &[a, b, c])],
                vec![csg(operation, &[c, a, b])],
                vec![csg(operation, &[a, b]), csg(operation, &[3, c])],
                vec![csg(operation, &[b, c]), csg(operation, &[a, 3])],
            ],
            &mut random,
        );
    }
    // (A − B) − C = A − (B ∪ C); A ∩ (B ∪ C) = (A ∩ B) ∪ (A ∩ C); ¬¬A = A.
    same(
        &solids,
        &[
            vec![csg(Difference, &[a, b]), csg(Difference, &[3, c])],
            vec![csg(Merge, &[b, c]), csg(Difference, &[a, 3])],
        ],
        &mut random,
    );
    same(
        &solids,
        &[
            vec![csg(Merge, &[b, c]), csg(Intersection, &[a, 3])],
            vec![csg(Intersection, &[a, b]), csg(Intersection, &[a, c]), csg(Merge, &[3, 4])],
        ],
        &mut random,
    );
    same(
        &solids[..1],
        &[vec![csg(Merge, &[a])], vec![csg(Complement, &[a]), csg(Complement, &[1])]],
        &mut random,
    );
}

#[test]
fn csg_what_is_cut_from_itself_is_nothing() {
    let mut random = Random(5);
    for _ in 0..30 {
        let mut solids = Vec::new();
        let a = random_solid(&mut random, 3, &mut solids);
        solids.push(csg(Difference, &[a, a]));
        let not = solids.len();
        solids.push(csg(Complement, &[a]));
        let mut everything = solids.clone();
        everything[not - 1] = csg(Merge, &[a, not]);
        let [nothing, everything] = [solids[..not].to_vec(), everything].map(build);
        for _ in 0..50 {
            let ray = ray(&mut random, 3.0);
            assert_eq!(crossings(&nothing, &ray), [], "{solids:?}");
            assert_eq!(crossings(&everything, &ray), [], "{solids:?}");
        }
    }
}

/// A pocket and a through hole whose faces lie in the block's own, everything turned and moved, each
/// solid by a placement of its own: no ray sees a skin.
#[test]
fn csg_coincident_faces_leave_no_skin() {
    let mut random = Random(13);
    let (mut floors, mut through, mut walls) = (0, 0, 0);
    for round in 0..1000 {
        let offset = random.in_cube() * [0.0, 1.0, 1e3, 1e6][round % 4];
        let turn = random.in_cube() * 180.0;
        let place = |mut solid: Solid, scale: f64| {
            solid.placement =
                Placement { translate: offset, rotate_degrees: turn, scale: DVec3::splat(scale) };
            solid
        };
        let hole = place(block(DVec3::new(0.25, -0.25, -0.5), DVec3::new(0.75, 0.25, 0.5)), 2.0);
        let pocket = place(block(DVec3::new(-0.75, -0.5, 0.0), DVec3::new(0.0, 0.5, 1.0)), 1.0);
        let solids = vec![place(cube(1.0), 1.0), pocket, hole, csg(Difference, &[0, 1, 2])];
        let placed = Placed::new(&solids[0].placement);
        let geometry = build(solids);
        let mut stack = Stack::new(&geometry);
        for _ in 0..50 {
            // From above into the pocket and into the hole, at all angles down to 0.01.
            let steep =
                DVec3::new(random.signed(), random.signed(), -10f64.powf(random.signed() - 1.0));
            let direction = steep.normalize();
            let entry = DVec3::new(-0.4 + 0.3 * random.signed(), 0.4 * random.signed(), 1.0);
            let wide = DVec3::new(1.0 + 0.45 * random.signed(), 0.45 * random.signed(), 1.0);
            for (into_hole, entry) in [(false, entry), (true, wide)] {
                let origin = placed.point(entry - direction * 3.0);
                let ray = Ray { origin, direction: (placed.point(entry) - origin).normalize() };
                let hit = closest(&geometry, Level::new(), &mut stack, &ray, None);
                let Some(hit) = hit else {
                    assert!(into_hole, "the pocket has a floor");
                    through += 1;
                    continue;
                };
                let at = placed.point_to_object(ray.origin + ray.direction * hit.t);
                let slack = 1e-12 * (1.0 + offset.length());
                assert!(at.z < 1.0 - slack, "a skin at {at} with offset {offset}");
                match (at.z < slack, into_hole) {
                    (true, false) => floors += 1,
                    _ => walls += 1,
                }
            }
        }
    }
    assert!(floors > 800 && through > 500 && walls > 5000, "{floors} {through} {walls}");
}

#[test]
fn csg_a_thin_plate_is_kept() {
    for thickness in [1e-6, 1e-9, 1e-12] {
        let cut = block(DVec3::splat(-2.0), DVec3::new(2.0, 2.0, 1.0 - thickness));
        let solids = [cube(1.0), cut, csg(Difference, &[0, 1])];
        let ray = Ray { origin: DVec3::new(0.1, 0.2, 10.0), direction: DVec3::NEG_Z };
        let ts = ts(&solids, &ray);
        assert_eq!(ts.len(), 2, "a plate of {thickness}");
        assert!((ts[1] - ts[0] - thickness).abs() < 1e-14);
    }
}

#[test]
fn csg_faces_that_touch_vanish_in_a_merge_and_stay_in_a_union() {
    let [left, right] =
        [-1.0, 0.0].map(|x| block(DVec3::new(x, 0.0, 0.0), DVec3::new(x + 1.0, 1.0, 1.0)));
    let ray = Ray { origin: DVec3::new(-2.0, 0.3, 0.4), direction: DVec3::X };
    for (operation, expected) in [(Merge, vec![1.0, 3.0]), (Union, vec![1.0, 2.0, 2.0, 3.0])] {
        assert_eq!(ts(&[left.clone(), right.clone(), csg(operation, &[0, 1])], &ray), expected);
    }
    // An edge and a corner of two blocks touch: nothing is there in between.
    let apart = block(DVec3::new(0.0, 1.0, 0.0), DVec3::new(1.0, 2.0, 1.0));
    let solids = [left, apart, csg(Intersection, &[0, 1])];
    assert_eq!(
        ts(&solids, &Ray { origin: DVec3::new(0.0, 0.0, 0.5), direction: DVec3::Y }),
        [0.0; 0]
    );
}

#[test]
fn csg_overlapping_balls_merge_to_two_crossings_and_unite_to_four() {
    let balls = [ball(DVec3::ZERO, 1.0), ball(DVec3::X, 1.0)];
    let ray = Ray { origin: DVec3::X * -5.0, direction: DVec3::X };
    for (operation, expected) in [(Merge, vec![4.0, 7.0]), (Union, vec![4.0, 5.0, 6.0, 7.0])] {
        let solids = [balls[0].clone(), balls[1].clone(), csg(operation, &[0, 1])];
        assert_eq!(ts(&solids, &ray), expected, "{operation:?}");
        let nested = [balls[0].clone(), balls[1].clone(), csg(Union, &[0, 1]), csg(Merge, &[2])];
        assert_eq!(ts(&nested, &ray), [4.0, 7.0], "within others a union is a merge");
    }
}

#[test]
fn csg_a_union_moves_its_operands() {
    let mut made = csg(Union, &[0, 1]);
    made.placement = Placement {
        translate: DVec3::new(0.0, 0.0, 5.0),
        rotate_degrees: DVec3::new(0.0, 0.0, 90.0),
        scale: DVec3::splat(2.0),
    };
    let ray = Ray { origin: DVec3::new(0.0, -10.0, 5.0), direction: DVec3::Y };
    let solids = [ball(DVec3::ZERO, 1.0), ball(DVec3::X * 3.0, 0.5), made.clone()];
    assert_eq!(ts(&solids, &ray), [8.0, 12.0, 15.0, 17.0]);
    // What it has twice is there twice.
    made.shape = Shape::Csg { operation: Union, operands: vec![0, 2] };
    let mut away = csg(Merge, &[0]);
    away.placement.translate.x = 4.0;
    assert_eq!(
        ts(&[ball(DVec3::ZERO, 1.0), made.clone(), away.clone()], &ray),
        [8.0, 12.0, 16.0, 20.0]
    );
    // Stretched, a ball is an ellipsoid.
    made.placement.scale = DVec3::new(3.0, 1.0, 1.0);
    let stretched = ts(&[ball(DVec3::ZERO, 1.0), made, away], &ray);
    let expected = [7.0, 13.0, 19.0, 25.0];
    assert!(stretched.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12), "{stretched:?}");
}

#[test]
fn csg_half_spaces_and_complements_have_no_end() {
    let slab = [below(1.0), below(-1.0), csg(Difference, &[0, 1])];
    let down = Ray { origin: DVec3::new(0.3, 0.4, 5.0), direction: DVec3::NEG_Z };
    assert_eq!(ts(&slab, &down), [4.0, 6.0]);
    let along = Ray { origin: DVec3::new(0.3, 0.4, 0.5), direction: DVec3::X };
    assert_eq!(ts(&slab, &along), [0.0; 0]);
    let cave = [below(1.0), ball(DVec3::ZERO, 0.5), csg(Difference, &[0, 1])];
    let hole = Ray { origin: DVec3::new(0.0, 0.0, 5.0), direction: DVec3::NEG_Z };
    assert_eq!(ts(&cave, &hole), [4.0, 4.5, 5.5]);
    let world = [ball(DVec3::ZERO, 1.0), csg(Complement, &[0])];
    assert_eq!(ts(&world, &hole), [4.0, 6.0]);
    let geometry = build(world.to_vec());
    let mut stack = Stack::new(&geometry);
    let hit = closest(&geometry, Level::new(), &mut stack, &hole, None).unwrap();
    let at = geometry.interaction(&stack, &hole, hit);
    assert_eq!(at.geometric_normal, DVec3::NEG_Z, "out of the complement is into the ball");
}

#[test]
fn csg_nothing_is_made_of_what_is_apart() {
    let balls = [ball(DVec3::ZERO, 1.0), ball(DVec3::X * 5.0, 1.0)];
    let solids = vec![balls[0].clone(), balls[1].clone(), csg(Intersection, &[0, 1])];
    let geometry = build(solids);
    assert_eq!(geometry.bounds(), None);
    let mut random = Random(1);
    for _ in 0..100 {
        assert_eq!(crossings(&geometry, &ray(&mut random, 5.0)), []);
    }
    let gone = vec![ball(DVec3::ZERO, 1.0), cube(2.0), csg(Difference, &[0, 1])];
    let geometry = build(gone);
    for _ in 0..100 {
        assert_eq!(crossings(&geometry, &ray(&mut random, 5.0)), []);
    }
}

#[test]
fn csg_the_bounds_of_a_difference_are_those_of_its_first() {
    let bounds = |solids: &[Solid]| build(solids.to_vec()).bounds().unwrap();
    let big = ball(DVec3::ZERO, 100.0);
    let near = |a: [DVec3; 2], half: f64| {
        (a[0] + half).abs().max_element() < 1e-6 && (a[1] - half).abs().max_element() < 1e-6
    };
    assert!(near(bounds(&[cube(1.0), big.clone(), csg(Difference, &[0, 1])]), 1.0));
    assert!(near(bounds(&[cube(1.0), big.clone(), csg(Intersection, &[0, 1])]), 1.0));
    assert!(near(bounds(&[cube(1.0), big, csg(Merge, &[0, 1])]), 100.0));
    assert!(near(bounds(&[cube(1.0), below(0.0), csg(Intersection, &[0, 1])]), 1.0));
}
