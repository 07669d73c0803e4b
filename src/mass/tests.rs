//! Measured mass against formulas: errors, their stated size, and what must not matter.

use std::f64::consts::PI;
use std::sync::Arc;

use glam::{DMat3, DVec3};

use super::*;
use crate::scene::csg::Operation;
use crate::scene::mesh::Mesh;
use crate::scene::{Material, Solid};

fn scene(shape: Shape) -> Scene {
    let solid = Solid::new("it", shape, 0);
    Scene { materials: vec![Material::new("m")], solids: vec![solid], ..Scene::default() }
}

fn measured(scene: &Scene, wishes: Wishes) -> Report {
    let found = measure(scene, 0, wishes, &Progress::default(), &mut |_| {});
    found.unwrap_or_else(|error| panic!("{error}"))
}

fn rays(rays: u64, seed: u64) -> Wishes {
    Wishes { goal: Goal::Rays(rays), seed, ..Wishes::default() }
}

fn ball() -> Shape {
    Shape::Sphere { center: DVec3::ZERO, radius: 1.0 }
}

/// A closed mesh of triangles, outward counter-clockwise.
fn mesh(positions: Vec<DVec3>, triangles: Vec<[u32; 3]>) -> Shape {
    let mesh = Arc::new(Mesh { positions, triangles, ..Mesh::default() });
    Shape::Mesh { file: "m.obj".to_owned(), mesh }
}

/// The faces of a box whose corners are numbered by the bits of x, y, z.
const FACES: [[u32; 3]; 12] = [
    [0, 2, 1],
    [1, 2, 3],
    [4, 5, 6],
    [5, 7, 6],
    [0, 1, 4],
    [1, 5, 4],
    [2, 6, 3],
    [3, 6, 7],
    [0, 4, 2],
    [2, 4, 6],
    [1, 3, 5],
    [3, 7, 5],
];

fn corners(half: DVec3, turn: DMat3) -> Vec<DVec3> {
    let sign = |i: u32, bit: u32| if i >> bit & 1 == 0 { -1.0 } else { 1.0 };
    (0..8).map(|i| turn * (half * DVec3::new(sign(i, 0), sign(i, 1), sign(i, 2)))).collect()
}

/// A box as a mesh that is turned about no axis of the grid.
fn tilted_box(half: DVec3) -> (Shape, DMat3) {
    let turn =
        DMat3::from_rotation_z(0.7) * DMat3::from_rotation_x(0.4) * DMat3::from_rotation_y(1.1);
    (mesh(corners(half, turn), FACES.to_vec()), turn)
}

/// Numbers in 0 … 1.
fn random(state: &mut u64) -> f64 {
    *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*state >> 11) as f64 / (1u64 << 53) as f64
}

fn covers(measured: Measured, truth: f64) -> bool {
    (measured.value - truth).abs() <= measured.error
}

/// Every number of what was measured, with what it should be.
fn pairs(found: &Properties, truth: &Properties) -> Vec<(Measured, f64)> {
    let Properties { volume, mass, center, inertia, principal, axes: _ } = found;
    let mut pairs = vec![(*volume, truth.volume.value), (*mass, truth.mass.value)];
    pairs.extend(center.iter().zip(&truth.center).map(|(a, b)| (*a, b.value)));
    pairs.extend(inertia.iter().zip(&truth.inertia).map(|(a, b)| (*a, b.value)));
    pairs.extend(principal.iter().zip(&truth.principal).map(|(a, b)| (*a, b.value)));
    pairs
}

#[test]
fn plain_primitives_agree_with_their_closed_forms() {
    let shapes =
        [ball(), Shape::Box { min: DVec3::new(1.0, 2.0, 3.0), max: DVec3::new(2.0, 5.0, 3.5) }];
    for shape in shapes {
        let is_box = matches!(shape, Shape::Box { .. });
        let mut scene = scene(shape);
        scene.solids[0].placement.scale = DVec3::new(1.0, 2.0, 0.5);
        scene.solids[0].placement.rotate_degrees = DVec3::new(20.0, 50.0, -70.0);
        scene.solids[0].placement.translate = DVec3::new(3.0, -4.0, 5.0);
        let report = measured(&scene, Wishes { density: Some(2.5), ..rays(60_000, 1) });
        let exact = report.exact.expect("a formula");
        for (found, truth) in pairs(&report.properties, &exact) {
            assert!(covers(found, truth), "{found:?}, not {truth}");
        }
        let error = (report.properties.volume.value / exact.volume.value - 1.0).abs();
        assert!(!is_box || error < 1e-12, "every ray of its box is inside of a box: {error}");
        assert!((exact.mass.value - 2.5 * exact.volume.value).abs() < 1e-12);
    }
}

#[test]
fn closed_forms_are_those_of_the_books() {
    let report = measured(&scene(ball()), rays(600, 1));
    let exact = report.exact.expect("a formula");
    let volume = 4.0 / 3.0 * PI;
    assert!((exact.volume.value - volume).abs() < 1e-14);
    for moment in exact.principal {
        assert!((moment.value - 0.4 * volume).abs() < 1e-14, "2/5 M r²");
    }
    let cuboid = Shape::Box { min: DVec3::ZERO, max: DVec3::new(1.0, 2.0, 3.0) };
    let exact = measured(&scene(cuboid), rays(600, 1)).exact.expect("a formula");
    // M(b² + c²)/12
    let wanted = [2.5, 5.0, 6.5];
    for (found, wanted) in exact.principal.iter().zip(wanted) {
        assert!((found.value - wanted).abs() < 1e-13, "{found:?}, not {wanted}");
    }
    assert_eq!(exact.center.map(|c| c.value), [0.5, 1.0, 1.5]);
}

#[test]
fn the_axes_of_a_turned_box_are_found() {
    let (shape, turn) = tilted_box(DVec3::new(1.0, 2.0, 3.0));
    let report = measured(&scene(shape), rays(800_000, 3));
    // The longest side has the smallest moment.
    let Properties { axes, principal, .. } = report.properties;
    for (axis, side) in axes.iter().zip([turn.z_axis, turn.y_axis, turn.x_axis]) {
        let angle = axis.cross(side).length();
        assert!(angle < 1e-4, "{angle} rad off");
    }
    let [a, b, c] = principal.map(|moment| moment.value);
    assert!(a > 0.0 && a <= b && b <= c && c <= a + b, "{a}, {b}, {c}");
}

#[test]
fn where_a_solid_is_does_not_matter() {
    let (shape, _) = tilted_box(DVec3::new(1.0, 0.3, 0.6));
    let knot = Shape::Knot { turns: [2, 3], tube: 0.2, segments: [60, 12] };
    let flake = Shape::Sphereflake { center: DVec3::ZERO, radius: 1.0, levels: 2 };
    for shape in [shape, knot, flake, ball()] {
        let mut here = scene(shape);
        here.solids[0].placement.rotate_degrees = DVec3::new(10.0, 20.0, 30.0);
        let mut far = here.clone();
        let offset = DVec3::new(1e6, -3e5, 7e5);
        far.solids[0].placement.translate = offset;
        let (a, b) = (measured(&here, rays(20_000, 5)), measured(&far, rays(20_000, 5)));
        let (a, b) = (a.properties, b.properties);
        assert!((a.volume.value / b.volume.value - 1.0).abs() < 1e-9);
        let size = a.principal[2].value;
        for (a, b) in a.inertia.iter().zip(&b.inertia) {
            assert!((a.value - b.value).abs() < 1e-9 * size, "{a:?} and {b:?}");
        }
        for axis in 0..3 {
            let moved = b.center[axis].value - offset[axis];
            assert!((a.center[axis].value - moved).abs() < 1e-9, "{axis}");
        }
    }
}

#[test]
fn where_the_points_of_a_mesh_are_does_not_matter() {
    let (shape, turn) = tilted_box(DVec3::new(1.0, 0.3, 0.6));
    let offset = DVec3::new(1e6, -3e5, 7e5);
    let moved = corners(DVec3::new(1.0, 0.3, 0.6), turn).iter().map(|p| *p + offset).collect();
    let a = measured(&scene(shape), rays(20_000, 5)).properties;
    let b = measured(&scene(mesh(moved, FACES.to_vec())), rays(20_000, 5)).properties;
    assert!(
        (a.volume.value / b.volume.value - 1.0).abs() < 1e-8,
        "points of 1e6 have steps of 1e-10"
    );
    assert!((a.principal[0].value / b.principal[0].value - 1.0).abs() < 1e-8);
}

#[test]
fn overlapping_parts_count_once() {
    let flake = Shape::Sphereflake { center: DVec3::ZERO, radius: 1.0, levels: 2 };
    let report = measured(&scene(flake), rays(200_000, 1));
    // Nine balls of a third of the radius touch the first.
    let truth = 4.0 / 3.0 * PI * (1.0 + 9.0 / 27.0);
    assert!(covers(report.properties.volume, truth), "{:?}", report.properties.volume);
    // Two boxes of side 2 in one mesh, one moved by (1, 1, 1): they share a cube of 1.
    let (half, turn) = (DVec3::ONE, DMat3::IDENTITY);
    let mut positions = corners(half, turn);
    positions.extend(corners(half, turn).iter().map(|p| *p + DVec3::ONE));
    let triangles = FACES.iter().copied().chain(FACES.map(|t| t.map(|i| i + 8))).collect();
    let report = measured(&scene(mesh(positions, triangles)), rays(100_000, 1));
    assert!(covers(report.properties.volume, 15.0), "{:?}", report.properties.volume);
}

#[test]
fn threads_change_no_bit() {
    let knot = Shape::Knot { turns: [2, 3], tube: 0.2, segments: [60, 12] };
    let scene = scene(knot);
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| measured(&scene, rays(20_000, 7)))
    };
    let (one, three) = (with(1), with(3));
    assert_eq!(one, three);
    let bits = |report: &Report| {
        let numbers = pairs(&report.properties, &report.properties);
        numbers.iter().map(|(m, _)| [m.value.to_bits(), m.error.to_bits()]).collect::<Vec<_>>()
    };
    assert_eq!(bits(&one), bits(&three));
    assert_ne!(bits(&one), bits(&measured(&scene, rays(20_000, 8))), "another seed, other rays");
}

/// A tetrahedron at random.
fn tetrahedron(state: &mut u64) -> [DVec3; 4] {
    loop {
        let mut point = || DVec3::new(random(state), random(state), random(state)) * 2.0;
        let mut p = [point(), point(), point(), point()];
        let six = (p[1] - p[0]).cross(p[2] - p[0]).dot(p[3] - p[0]);
        if six < 0.0 {
            p.swap(2, 3);
        }
        if six.abs() > 0.3 {
            return p;
        }
    }
}

/// What a tetrahedron of density 1 weighs: the second moments about its centre are V/20 Σ p·pᵀ.
fn weight_of(p: [DVec3; 4]) -> Properties {
    let volume = (p[1] - p[0]).cross(p[2] - p[0]).dot(p[3] - p[0]).abs() / 6.0;
    let center = p.into_iter().sum::<DVec3>() / 4.0;
    let out = p.map(|p| p - center);
    let second = |a: usize, b: usize| volume / 20.0 * out.iter().map(|p| p[a] * p[b]).sum::<f64>();
    let trace: f64 = (0..3).map(|a| second(a, a)).sum();
    let inertia = |a, b| if a == b { trace - second(a, b) } else { -second(a, b) };
    let rows = [0, 1, 2].map(|a| [0, 1, 2].map(|b| inertia(a, b)));
    let (principal, axes) = eigen::eigen(DMat3::from_cols_array_2d(&rows));
    let exact = |value: f64| Measured { value, error: 0.0 };
    Properties {
        volume: exact(volume),
        mass: exact(volume),
        center: center.to_array().map(exact),
        inertia: [(0, 0), (1, 1), (2, 2), (1, 2), (2, 0), (0, 1)]
            .map(|(a, b)| exact(inertia(a, b))),
        principal: principal.to_array().map(exact),
        axes: [axes.x_axis, axes.y_axis, axes.z_axis],
    }
}

#[test]
fn the_stated_error_covers_the_truth() {
    let count = if std::env::var_os("RAYFOREST_LONG").is_some() { 1000 } else { 150 };
    let mut state = 11;
    let (mut covered, mut squares) = ([0; 14], 0.0);
    for seed in 0..count {
        let corners = (seed % 2 == 0).then(|| tetrahedron(&mut state));
        let mut scene = scene(corners.map_or_else(ball, |corners| {
            mesh(corners.to_vec(), vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
        }));
        let placement = &mut scene.solids[0].placement;
        placement.scale =
            DVec3::new(random(&mut state), random(&mut state), random(&mut state)) + 0.2;
        placement.rotate_degrees = DVec3::new(random(&mut state), random(&mut state), 0.5) * 360.0;
        placement.translate = DVec3::new(random(&mut state), 0.0, -1.0) * 100.0;
        let Placement { translate, rotate_degrees, scale } = placement.clone();
        let placed = |p: DVec3| rotation(rotate_degrees) * (p * scale) + translate;
        let Report { properties: found, exact, .. } = measured(&scene, rays(6000, seed));
        let truth = corners.map(|corners| weight_of(corners.map(placed))).or(exact).unwrap();
        for (count, (number, truth)) in covered.iter_mut().zip(pairs(&found, &truth)) {
            *count += u32::from(covers(number, truth));
        }
        squares += ((found.volume.value - truth.volume.value) / found.volume.error).powi(2);
    }
    println!("of {count}: volume, mass, centre, inertia, principal moments {covered:?}");
    let least = count as u32 * 95 / 100;
    assert!(covered.iter().all(|number| *number >= least), "{covered:?} of {count}");
    // An error that covers everything would be worth nothing: the one stated is of 2.576 deviations.
    let deviations = (squares / count as f64).sqrt() * 2.576;
    println!("{deviations} of the stated deviation");
    assert!((0.75..1.25).contains(&deviations), "{deviations}");
}

/// Root mean square of the relative errors of volumes with n² rays in all, over some seeds.
fn rms(scene: &Scene, truth: f64, side: u64) -> f64 {
    let seeds = 8;
    let squares = (0..seeds).map(|seed| {
        // Of the rays of all grids the last one has three quarters.
        let found = measured(scene, rays(side * side * 4 / 3, seed)).properties.volume.value;
        (found / truth - 1.0).powi(2)
    });
    (squares.sum::<f64>() / seeds as f64).sqrt()
}

#[test]
fn errors_fall_as_the_law_says() {
    let (cube, _) = tilted_box(DVec3::ONE);
    // Jittered rays on curved silhouettes and on slanted edges: n^-2 for n² rays.
    for (shape, truth) in [(ball(), 4.0 / 3.0 * PI), (cube, 8.0)] {
        let scene = scene(shape);
        let (coarse, fine) = (rms(&scene, truth, 64), rms(&scene, truth, 512));
        let exponent = (fine / coarse).ln() / 8f64.ln();
        assert!((-2.3..=-1.7).contains(&exponent), "{exponent}");
    }
}

/// What an operation makes of two or more shapes.
fn made(operation: Operation, shapes: Vec<Shape>) -> Scene {
    let operands = (1..=shapes.len()).collect();
    let mut scene = scene(Shape::Csg { operation, operands });
    let numbered = shapes.into_iter().enumerate();
    scene.solids.extend(numbered.map(|(i, shape)| Solid::new(format!("part {i}"), shape, 0)));
    scene
}

/// Solids of the table of known errors, with their volumes and the error of 512² jittered rays.
fn table() -> Vec<(&'static str, Scene, f64, f64)> {
    let rod =
        |axis: DVec3, radius: f64| Shape::Cylinder { from: axis * -2.0, to: axis * 2.0, radius };
    let at = |x: f64| Shape::Sphere { center: DVec3::X * x, radius: 1.0 };
    let cone = Shape::Cone { from: DVec3::ZERO, to: DVec3::Z, radius: 1.0, tip: 0.0 };
    let (less, common) = (Operation::Difference, Operation::Intersection);
    let steinmetz = vec![rod(DVec3::X, 1.0), rod(DVec3::Y, 1.0)];
    vec![
        ("sphere", scene(ball()), 4.0 / 3.0 * PI, 8.9e-6),
        ("torus", scene(Shape::Torus { major: 1.0, minor: 0.3 }), 1.776_528_792_20, 3.5e-5),
        ("cone", scene(cone), PI / 3.0, 8.9e-6),
        ("cylinder", scene(rod(DVec3::Z, 1.0)), 4.0 * PI, 7.7e-5),
        (
            "drilled ball",
            made(less, vec![ball(), rod(DVec3::Z, 0.5)]),
            2.720_699_046_351_33,
            6.4e-5,
        ),
        ("two cylinders", made(common, steinmetz), 16.0 / 3.0, 9e-5),
        ("lens", made(common, vec![at(-0.5), at(0.5)]), 5.0 * PI / 12.0, 1.5e-5),
    ]
}

#[test]
fn errors_are_at_most_three_times_the_table() {
    for (name, scene, truth, table) in table() {
        let found = rms(&scene, truth, 512);
        assert!(found <= 3.0 * table, "{name}: {found} against {table}");
    }
}

#[test]
fn a_union_weighs_what_its_parts_do_without_what_they_share() {
    let at = |x: f64| Shape::Sphere { center: DVec3::X * x, radius: 1.0 };
    let weigh = |scene: &Scene| measured(scene, rays(60_000, 2)).properties.volume;
    let one = weigh(&scene(ball()));
    let both = |operation| weigh(&made(operation, vec![at(-0.5), at(0.5)]));
    for operation in [Operation::Union, Operation::Merge] {
        let (all, shared) = (both(operation), both(Operation::Intersection));
        let off = (all.value + shared.value - 2.0 * one.value).abs();
        assert!(off <= all.error + shared.error + 2.0 * one.error, "{operation:?}: {off}");
    }
    let mut turned = made(Operation::Difference, vec![ball(), at(1.0)]);
    let plain = measured(&turned, rays(20_000, 1)).properties;
    turned.solids[0].placement.rotate_degrees.z = 90.0;
    turned.solids[0].placement.translate.x = 1e6;
    let moved = measured(&turned, rays(20_000, 1)).properties;
    assert!((moved.center[1].value - plain.center[0].value).abs() < 1e-9, "x turned to y");
    assert!((moved.volume.value / plain.volume.value - 1.0).abs() < 1e-9);
    let endless = made(Operation::Complement, vec![ball()]);
    let refused = measure(&endless, 0, rays(600, 0), &Progress::default(), &mut |_| {});
    assert_eq!(refused, Err(MassError::Endless));
}

/// Mass and centre of what an operation makes of shapes that weigh 1, 10, 100 … per volume.
fn mixed(operation: Operation, shapes: Vec<Shape>) -> (Report, Measured, [Measured; 3]) {
    let mut scene = made(operation, shapes);
    scene.materials = (0..4)
        .map(|k| Material { density: 10f64.powi(k), ..Material::new(format!("m{k}")) })
        .collect();
    for (k, solid) in scene.solids[1..].iter_mut().enumerate() {
        solid.material = k;
    }
    let report = measured(&scene, rays(300_000, 1));
    let Properties { mass, center, .. } = report.properties.clone();
    (report, mass, center)
}

#[test]
fn a_solid_of_several_materials_weighs_what_its_regions_do() {
    let cube = |x: f64, half: f64| Shape::Box {
        min: DVec3::new(x - half, -half, -half),
        max: DVec3::new(x + half, half, half),
    };
    let volume = |report: &Report| report.properties.volume;
    // Where two overlap, the first one is there: 8 of it, and 4 of the other one beside it.
    for operation in [Operation::Merge, Operation::Union] {
        let (report, mass, center) = mixed(operation, vec![cube(0.0, 1.0), cube(1.0, 1.0)]);
        assert!(covers(volume(&report), 12.0) && covers(mass, 48.0), "{operation:?}: {mass:?}");
        // 8 at 0 and 40 at 1.5.
        assert!(covers(center[0], 60.0 / 48.0), "{operation:?}: {center:?}");
        let names: Vec<&str> = report.made_of.iter().map(|s| s.material.as_str()).collect();
        assert_eq!(names, ["m0", "m1"]);
        let (_, mass, _) = mixed(operation, vec![cube(1.0, 1.0), cube(0.0, 1.0)]);
        assert!(covers(mass, 48.0));
    }
    // What is cut out weighs nothing, and of a common part the first operand tells the material.
    let (report, mass, _) = mixed(Operation::Difference, vec![cube(0.0, 1.0), cube(1.0, 1.0)]);
    assert!(covers(mass, 4.0) && report.made_of.len() == 1);
    let (_, mass, _) = mixed(Operation::Intersection, vec![cube(0.0, 1.0), cube(1.0, 1.0)]);
    assert!(covers(mass, 4.0));
    // Of three, the third is there only where neither of the others is.
    let three = vec![cube(0.0, 1.0), cube(1.0, 1.0), cube(0.0, 1.5)];
    let (report, mass, _) = mixed(Operation::Merge, three);
    // Of the second one, half a unit looks out of the third.
    let third = 27.0 - 8.0 - 2.0;
    assert!(covers(volume(&report), 8.0 + 4.0 + third), "{:?}", volume(&report));
    assert!(covers(mass, 8.0 + 40.0 + 100.0 * third), "{mass:?}");
}

#[test]
fn parts_of_parts_keep_their_places_and_materials() {
    let at = |x: f64| Shape::Sphere { center: DVec3::X * x, radius: 1.0 };
    // A pair of balls of 1 and 10, apart, twice as large and moved, with a plane that cuts one off.
    let mut scene = made(Operation::Intersection, vec![Shape::named("plane"), ball()]);
    scene.solids[1].shape = Shape::Plane { normal: DVec3::X, offset: 4.0 };
    scene.solids[2].shape = Shape::Csg { operation: Operation::Merge, operands: vec![3, 4] };
    scene.solids.extend([Solid::new("a", at(0.0), 0), Solid::new("b", at(3.0), 1)]);
    scene.materials.push(Material { density: 10.0, ..Material::new("heavy") });
    scene.solids[0].shape = Shape::Csg { operation: Operation::Intersection, operands: vec![2, 1] };
    scene.solids[2].placement.scale = DVec3::splat(2.0);
    scene.solids[2].placement.translate = DVec3::new(-2.0, 0.0, 0.0);
    // Balls of radius 2 at −2 and 4: of the second, half is left.
    let report = measured(&scene, rays(300_000, 4));
    let one = 32.0 / 3.0 * PI;
    let Properties { volume, mass, center, .. } = report.properties;
    assert!(covers(volume, 1.5 * one), "{volume:?}");
    assert!(covers(mass, one + 5.0 * one), "{mass:?}");
    // Half a ball's centre is 3/8 of the radius from its face.
    assert!(covers(center[0], (-2.0 + 5.0 * 3.25) / 6.0), "{center:?}");
    // The material of the plane counts where it comes first.
    let Shape::Csg { operands, .. } = &mut scene.solids[0].shape else { unreachable!() };
    operands.reverse();
    assert_eq!(measured(&scene, rays(600, 4)).made_of.len(), 1);
}

#[test]
fn a_goal_is_reached_or_said_not_to_be() {
    let mut steps = Vec::new();
    let wishes = Wishes { goal: Goal::Error(1e-3), ..Wishes::default() };
    let scene = scene(ball());
    let report = measure(&scene, 0, wishes, &Progress::default(), &mut |step| steps.push(*step));
    let report = report.unwrap();
    assert_eq!(report.steps, steps);
    assert!(report.reached && steps.len() > 1);
    let Measured { value, error } = report.properties.volume;
    assert!(error <= 1e-3 * value);
    for most in [100, 5_000, 12_345, 60_000] {
        let report = measured(&scene, rays(most, 0));
        assert!(report.rays() <= most && report.rays() * 3 > most, "{} of {most}", report.rays());
    }
    let progress = Progress::default();
    progress.cancel();
    let stopped = measure(&scene, 0, wishes, &progress, &mut |_| {});
    assert_eq!(stopped, Err(MassError::Cancelled));
}

#[test]
fn what_has_no_inside_is_refused() {
    let refused = |shape: Shape| {
        measure(&scene(shape), 0, rays(600, 0), &Progress::default(), &mut |_| {})
            .unwrap_err()
            .to_string()
    };
    assert!(refused(Shape::named("plane")).contains("no end"));
    assert!(refused(Shape::named("polygon")).contains("no thickness"));
    let positions = corners(DVec3::ONE, DMat3::IDENTITY);
    let open = refused(mesh(positions.clone(), FACES[..11].to_vec()));
    assert_eq!(open, "the mesh is not closed: see its edge from [1, 1, -1] to [1, -1, 1]");
    let mut turned = FACES.to_vec();
    turned[0].swap(0, 1);
    assert!(refused(mesh(positions, turned)).contains("not closed"));
}
