//! Refraction, by rays whose last leg is measured: where it meets planes beyond tells where it
//! starts and where it goes.

use glam::{DMat3, DQuat, DVec3};

use rayforest::color::Rgb;
use rayforest::scene::{Background, Material, Placement, Scene, Shape, Solid, Trace};

use super::super::preorder::{Limb, pixels};
use super::super::stage::{open, shipped};
use super::{clear, light, mirror, one_ray, slab, solid, sphere, tree};

/// Glass.
const N: f64 = 1.5;

/// What the closed forms are held to.
const EXACT: f64 = 1e-12;

/// A point and a unit direction.
#[derive(Clone, Copy)]
struct Leg {
    origin: DVec3,
    direction: DVec3,
}

impl Leg {
    /// The larger of the distances of origins and of directions.
    fn off(self, other: Leg) -> f64 {
        (self.origin - other.origin).length().max((self.direction - other.direction).length())
    }

    /// How far a point is from the line.
    fn distance(self, point: DVec3) -> f64 {
        (point - self.origin).cross(self.direction).length()
    }
}

/// Clear solids and a ray into them.
fn through(ray: Leg, solids: &[(Shape, f64)]) -> Scene {
    let mut scene = one_ray(ray.origin, ray.direction);
    for (shape, ior) in solids {
        scene.solids.push(solid(shape.clone(), scene.materials.len()));
        scene.materials.push(clear(*ior));
    }
    scene
}

/// The last leg of the ray of a scene, which goes about `toward`.
///
/// An opaque plane with normal n at two distances, beyond everything, gives n·direction and
/// n·origin; three normals give both vectors. They come out within 1e-13.
fn last_leg(scene: &Scene, toward: DVec3) -> Leg {
    const NEAR: f64 = 32.0;
    const FAR: f64 = 32.0 + 1024.0;
    let (a, b) = toward.any_orthonormal_pair();
    let normals = [toward, toward + a * 0.5, toward + b * 0.5].map(DVec3::normalize);
    let measured = normals.map(|normal| {
        let [near, far] = [NEAR, FAR].map(|distance| last_length(scene, normal, distance));
        let along = (FAR - NEAR) / (far - near);
        (NEAR - near * along, along)
    });
    let [x, y, z] = normals;
    let solve = DMat3::from_cols(x, y, z).transpose().inverse();
    Leg {
        origin: solve * DVec3::from_array(measured.map(|m| m.0)),
        direction: solve * DVec3::from_array(measured.map(|m| m.1)),
    }
}

/// Length of the last leg of the ray, which ends at the plane.
fn last_length(scene: &Scene, normal: DVec3, distance: f64) -> f64 {
    let mut scene = scene.clone();
    // The half-space beyond: its normal points to the ray's side.
    let plane = Shape::Plane { normal: -normal, offset: -distance };
    scene.solids.push(solid(plane, scene.materials.len()));
    scene.materials.push(mirror(0.0));
    let session = open(scene);
    let tree = tree(&session);
    let chain = tree.chain();
    let last = chain[chain.len() - 1];
    let plane = session.geometry().primitives() as u32 - 1;
    assert_eq!(last.primitive, plane, "the ray does not reach the plane");
    last.t
}

/// A ray down to a point, at an angle with −z.
fn down(to: DVec3, angle: f64) -> Leg {
    let direction = DVec3::new(angle.sin(), 0.0, -angle.cos());
    Leg { origin: to - direction * 4.0, direction }
}

#[test]
fn the_measurement_is_accurate() {
    for angle in [0.0, 0.3, 1.2] {
        let ray = down(DVec3::new(0.3, 0.2, 0.1), angle);
        let leg = last_leg(&through(ray, &[]), ray.direction);
        assert!(leg.off(ray) < 1e-13, "off by {:e}", leg.off(ray));
        let bent = Leg { direction: DQuat::from_rotation_y(1e-12) * ray.direction, ..ray };
        assert!(leg.off(bent) > 5e-13, "a picoradian is measured");
    }
}

#[test]
fn snell() {
    for (degrees, ior, refracted) in [
        (45.0f64, 1.5, Some(28.125_505_702_055_7)),
        (0.0, 1.5, Some(0.0)),
        (80.0, 1.5, None),
        (45.0, 1.33, None),
        (80.0, 2.42, None),
        (89.9, 1.5, None),
        (45.0, 0.8, None),
    ] {
        let ray = down(DVec3::ZERO, degrees.to_radians());
        let angle = (degrees.to_radians().sin() / ior).asin();
        if let Some(refracted) = refracted {
            assert!((angle.to_degrees() - refracted).abs() < 1e-12, "{}", angle.to_degrees());
        }
        let truth = Leg { origin: DVec3::ZERO, ..down(DVec3::ZERO, angle) };
        let half_space = Shape::Plane { normal: DVec3::Z, offset: 0.0 };
        let glass = [(half_space, ior)];
        let leg = last_leg(&through(ray, &glass), truth.direction);
        // The angle within is as sensitive to rounding as dθt/dθi or its inverse say.
        let off = leg.off(truth);
        assert!(off < 1e-13, "{degrees}° into {ior}: off by {off:e}");
        // And back the way it came.
        let back = Leg { origin: truth.direction * 4.0, direction: -truth.direction };
        let leg = last_leg(&through(back, &glass), -ray.direction);
        let came = Leg { origin: DVec3::ZERO, direction: -ray.direction };
        let off = leg.off(came) * ray.direction.z.abs();
        assert!(off < 1e-13, "back to {degrees}° from {ior}: off by {off:e}");
    }
}

#[test]
fn a_slab_shifts_and_does_not_turn() {
    for (degrees, table) in [(30.0f64, 0.193_813_782), (60.0, 0.512_472_013), (80.0, 0.833_663_850)]
    {
        let angle = degrees.to_radians();
        let (sin, cos) = angle.sin_cos();
        let shift = sin * (1.0 - cos / (N * N - sin * sin).sqrt());
        assert!((shift - table).abs() < 1e-9);
        for turn in [0.0f64, 30.0, -77.0] {
            let turned = DQuat::from_rotation_y(turn.to_radians());
            let flat = down(DVec3::Z, angle);
            let ray = Leg { origin: turned * flat.origin, direction: turned * flat.direction };
            let mut scene = through(ray, &[(slab(0.0, 1.0), N)]);
            let rotate_degrees = DVec3::new(0.0, turn, 0.0);
            scene.solids[0].placement = Placement { rotate_degrees, ..Placement::default() };
            let leg = last_leg(&scene, ray.direction);
            let bent = (leg.direction - ray.direction).length();
            assert!(bent < EXACT, "{degrees}° into a slab at {turn}°: turned by {bent:e}");
            let off = ray.distance(leg.origin) - shift;
            assert!(off.abs() < EXACT, "{degrees}° into a slab at {turn}°: off by {off:e}");
        }
    }
}

/// A slab of water within a slab of glass: every layer shifts by its thickness times tan θ, and the
/// direction is the first one in the end.
#[test]
fn layers_within_layers() {
    for degrees in [0.0f64, 30.0, 60.0, 80.0] {
        let layers = [(slab(0.0, 4.0), 1.5), (slab(1.0, 3.5), 1.33), (slab(2.0, 2.25), 2.42)];
        let ray = down(DVec3::new(0.0, 0.0, 4.0), degrees.to_radians());
        let tan = |ior: f64| (degrees.to_radians().sin() / ior).asin().tan();
        let glass = tan(1.5) * (0.5 + 1.0);
        let exit = glass + tan(1.33) * (1.25 + 1.0) + tan(2.42) * 0.25;
        let truth = Leg { origin: DVec3::new(exit, 0.0, 0.0), direction: ray.direction };
        let off = last_leg(&through(ray, &layers), ray.direction).off(truth);
        assert!(off < EXACT, "{degrees}°: off by {off:e}");
    }
}

/// Water of thickness 1 on glass of thickness 2, three ways to say it, and both orders in the file.
fn stack(gap: f64, degrees: f64, glass_first: bool) -> Result<(), String> {
    let mut layers = vec![(slab(0.0, 2.0), N), (slab(2.0 + gap, 3.0), 1.33)];
    if !glass_first {
        layers.reverse();
    }
    let ray = down(DVec3::new(0.0, 0.0, 3.0), degrees.to_radians());
    let tan = |ior: f64| (degrees.to_radians().sin() / ior).asin().tan();
    let truth =
        Leg { origin: DVec3::new(tan(1.33) + 2.0 * tan(N), 0.0, 0.0), direction: ray.direction };
    let off = last_leg(&through(ray, &layers), ray.direction).off(truth);
    let exact = if gap > 0.0 { 1e-5 } else { EXACT };
    match off < exact {
        true => Ok(()),
        false => Err(format!("{degrees}°, glass first: {glass_first}: off by {off:e}")),
    }
}

const ANGLES: [f64; 4] = [0.0, 30.0, 60.0, 80.0];

#[test]
fn a_thin_gap_between_layers() {
    for degrees in ANGLES {
        stack(1e-7, degrees, true).unwrap();
        stack(1e-7, degrees, false).unwrap();
    }
}

/// The solid entered last decides the index: where the layers overlap there is glass.
#[test]
fn layers_that_overlap() {
    for degrees in ANGLES {
        stack(-0.25, degrees, true).unwrap();
        stack(-0.25, degrees, false).unwrap();
    }
}

#[test]
fn layers_in_exact_contact() {
    for degrees in ANGLES {
        stack(0.0, degrees, true).unwrap();
        stack(0.0, degrees, false).unwrap();
    }
}

/// A clear box that stands on a floor shows the floor, whichever the file names first.
fn box_on_floor(box_first: bool) {
    let mut scene = through(down(DVec3::Z, 0.5), &[(slab(0.0, 1.0), N)]);
    scene.solids.push(solid(Shape::Plane { normal: DVec3::Z, offset: 0.0 }, 1));
    scene.materials.push(Material { emission: Rgb::WHITE, ..mirror(0.0) });
    if !box_first {
        scene.solids.reverse();
    }
    assert_eq!(light(&open(scene)), [1.0; 3]);
}

#[test]
fn a_clear_box_on_a_floor_named_before_it() {
    box_on_floor(false);
}

#[test]
fn a_clear_box_on_a_floor_named_after_it() {
    box_on_floor(true);
}

#[test]
fn a_ball_turns_by_twice_the_difference_of_angles() {
    for (degrees, table) in [(30.0f64, 21.057_559), (60.0, 49.471_221), (85.0, 86.768_799)] {
        let angle = degrees.to_radians();
        let turn = 2.0 * (angle - (angle.sin() / N).asin());
        assert!((turn.to_degrees() - table).abs() < 1e-6);
        // Straight down beside the middle: the ball turns the ray inwards.
        let ray = down(DVec3::new(angle.sin(), 0.0, 4.0), 0.0);
        let truth = DQuat::from_rotation_y(turn) * ray.direction;
        let ball = [(sphere(DVec3::ZERO, 1.0), N)];
        let leg = last_leg(&through(ray, &ball), truth);
        let off = (leg.direction - truth).length();
        assert!(off < EXACT, "{degrees}°: off by {off:e}");
        assert!((leg.origin.length() - 1.0).abs() < EXACT);
    }
}

#[test]
fn a_ball_within_a_ball_of_the_same_glass_does_not_bend() {
    let ball = |radius| (sphere(DVec3::ZERO, radius), N);
    for i in 0..40 {
        let ray = down(DVec3::new(0.015 * f64::from(i), 0.1, 4.0), 0.0);
        let one = through(ray, &[ball(1.0)]);
        let leg = last_leg(&one, DVec3::NEG_Z);
        let nested = [ball(1.0), ball(0.9), ball(0.5), ball(0.1)];
        let off = last_leg(&through(ray, &nested), DVec3::NEG_Z).off(leg);
        assert!(off < 1e-13, "ray {i}: off by {off:e}");
        let hollow = [ball(1.0), (sphere(DVec3::ZERO, 0.9), 1.0)];
        let other = last_leg(&through(ray, &hollow), DVec3::NEG_Z);
        assert!(i == 0 || other.off(leg) > 1e-3, "ray {i}: another inside bends otherwise");
    }
}

#[test]
fn a_sheet_does_not_bend() {
    let corners = [[-9.0, -9.0], [9.0, -9.0], [9.0, 9.0], [-9.0, 9.0]];
    let points = corners.map(|[x, y]| DVec3::new(x, y, 0.0)).to_vec();
    let ray = down(DVec3::ZERO, 1.0);
    let leg = last_leg(&through(ray, &[(Shape::Polygon { points }, N)]), ray.direction);
    assert!(leg.off(Leg { origin: DVec3::ZERO, ..ray }) < 1e-13);
}

/// A ray within glass that meets its surface at an angle, for a plane, a box and a ball.
fn from_within(angle: f64) -> [(&'static str, Leg, Shape); 3] {
    let up = down(DVec3::ZERO, angle).direction * DVec3::new(1.0, 1.0, -1.0);
    let flat = Leg { origin: up * -2.0, direction: up };
    let across = Leg { origin: DVec3::new(angle.sin(), 0.0, 0.0), direction: DVec3::Z };
    let half_space = Shape::Plane { normal: DVec3::Z, offset: 0.0 };
    [
        ("plane", flat, half_space),
        ("box", flat, slab(-50.0, 0.0)),
        ("ball", across, sphere(DVec3::ZERO, 1.0)),
    ]
}

#[test]
fn glass_total_reflection_begins_at_the_critical_angle() {
    let critical = (1.0 / N).asin();
    assert!((critical.to_degrees() - 41.810_314_895_778_596).abs() < 1e-13);
    for beyond in [-0.1, -1e-6, -1e-9, 1e-9, 1e-6, 0.1] {
        for (name, ray, shape) in from_within(critical + beyond) {
            let mut scene = through(ray, &[(shape, N)]);
            let (kr, kt, filter) = (Rgb([0.3, 0.5, 0.9]), Rgb([0.4, 0.5, 0.6]), Rgb::grey(0.5));
            let glass = &mut scene.materials[0];
            *glass = Material { reflect: kr, transmit: kt, filter, ..glass.clone() };
            scene.trace.depth = 1;
            scene.background = Background::Color(Rgb::WHITE);
            let session = open(scene);
            let tree = tree(&session);
            let total = beyond > 0.0;
            assert_eq!(tree.total, total, "{name} at {beyond:e} beyond the critical angle");
            assert_eq!(matches!(tree.transmitted, Limb::Absent), total);
            if name == "plane" {
                // The mirror ray, and the refracted one if there is one, see the background.
                let [r, t] = [kr, kt].map(|k| k.0.map(f64::from));
                let all = [0, 1, 2].map(|c| match total {
                    true => (r[c] + t[c]).min(1.0),
                    false => r[c] + 0.5 * t[c],
                });
                for (ours, truth) in light(&session).iter().zip(all) {
                    assert!((ours - truth).abs() < 1e-6, "{beyond:e}: {ours}, not {truth}");
                }
            }
        }
    }
}

#[test]
fn a_ball_never_reflects_totally_what_entered_it() {
    let mut scene = shipped("whitted");
    let glass = Material { reflect: Rgb::grey(0.3), transmit: Rgb::grey(0.7), ..clear(N) };
    scene.materials = vec![glass];
    scene.solids = vec![solid(sphere(DVec3::ZERO, 1.3), 0)];
    scene.trace = Trace { samples: 4, depth: 12, cutoff: 0.0, ..Trace::default() };
    let inside = |solids: Vec<Solid>| {
        let session = open(Scene { solids, ..scene.clone() });
        let (mut nodes, mut total) = (0, 0);
        for tree in pixels(&session).iter().flat_map(|p| p.samples.iter().flatten()) {
            tree.each(&mut |node| {
                nodes += 1;
                total += usize::from(node.total);
            });
        }
        (nodes, total)
    };
    let (nodes, total) = inside(scene.solids.clone());
    assert!(nodes > 10_000 && total == 0, "{total} of {nodes} nodes reflect totally");
    let cube = Shape::Box { min: DVec3::NEG_ONE, max: DVec3::ONE };
    assert!(inside(vec![solid(cube, 0)]).1 > 1000, "in a box many do");
}
