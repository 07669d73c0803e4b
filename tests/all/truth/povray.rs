//! Parity with POV-Ray 3.7: its pictures against ours, pixel by pixel, in linear light.
//!
//! Both cast one ray through the centre of each pixel. A picture may differ where such a ray passes
//! an edge within the rounding of either program: few pixels. All others agree to one step of the
//! reference's 16 bits.

use std::path::Path;

use rayforest::scene::{Scene, path};

use super::picture::Picture;
use super::stage::{file, open};

/// What a channel may differ: half a step by which the reference was rounded, and half a step for
/// our f32 and POV-Ray's f32 colours.
fn allowed(_: f64) -> f64 {
    1.0 / 65535.0
}

/// The share of pixels that may differ by more, because they see an edge: 38 of 76 800.
const SHARE: f64 = 0.0005;

/// Holds ours against the reference; both in 0 … 1.
fn judge(ours: &Picture, reference: &Picture) -> Result<(), String> {
    let share = ours.compare(reference, allowed).share;
    match share <= SHARE {
        true => Ok(()),
        false => Err(format!("{:.2} % of the pixels differ", share * 100.0)),
    }
}

fn reference(name: &str) -> Picture {
    let file = format!("tests/pictures/{name}.png");
    Picture::of_png16(&Path::new(env!("CARGO_MANIFEST_DIR")).join(file))
}

fn scene(name: &str) -> Scene {
    file(&format!("tests/pictures/{name}.toml"))
}

fn picture(scene: Scene) -> Picture {
    Picture::of_film(&open(scene).film()).clipped()
}

fn parity(name: &str) {
    let ours = picture(scene(name));
    let reference = reference(name);
    if let Err(why) = judge(&ours, &reference) {
        panic!("{name}: {why}\n{}", ours.leave(&reference, name));
    }
}

#[test]
fn whitted() {
    parity("r1_whitted");
}

#[test]
fn highlight_and_hard_shadow() {
    parity("s01_phong");
}

#[test]
fn mirrors() {
    parity("s02_mirror");
}

#[test]
fn refraction_and_total_reflection() {
    parity("s03_refract_tir");
}

#[test]
fn cones_and_cylinders() {
    parity("s05_cone_cyl");
}

#[test]
fn torus() {
    parity("s06_torus");
}

#[test]
fn a_solid_made_of_others() {
    parity("s04_csg");
}

#[test]
fn glass_cut_to_a_lens() {
    parity("c1_lens");
}

#[test]
fn glass_merged() {
    parity("c2_merge");
}

#[test]
fn a_material_per_operand() {
    parity("c3_bowl");
}

#[test]
fn operations_within_operations() {
    parity("c4_nested");
}

#[test]
fn complements_without_end() {
    parity("c5_inverse");
}

#[test]
fn scenes_that_are_a_little_different_are_refused() {
    for (name, path, value) in [
        ("r1_whitted", "materials.glass.diffuse", "0.008"),
        ("r1_whitted", "materials.glass.reflect", "0.121"),
        ("r1_whitted", "materials.mirror.shininess", "90"),
        ("r1_whitted", "camera.fov_degrees", "45.001"),
        ("s01_phong", "materials.red.specular", "0.802"),
        ("s01_phong", "lights.key.point", "[-4, -5, 6.001]"),
        ("s02_mirror", "trace.depth", "4"),
        ("s02_mirror", "materials.tiles.texture.checker.size", "1.01"),
        ("s03_refract_tir", "materials.glass.ior", "1.501"),
        ("s03_refract_tir", "materials.glass.transmit", "0.999"),
        ("s03_refract_tir", "trace.depth", "2"),
        ("s04_csg", "solids.x.cylinder.radius", "0.551"),
        ("c1_lens", "solids.lens.rotate_degrees", "[0, 0, 35.1]"),
        ("c2_merge", "solids.twin.merge", "[\"left\"]"),
        ("c3_bowl", "solids.inner.material", "blue"),
        ("c4_nested", "solids.bracket.scale", "[1, 1, 0.901]"),
        ("c5_inverse", "solids.rock.intersection", "[\"around\"]"),
        ("s03_refract_tir", "solids.prism.rotate_degrees", "[0, 0, 25.1]"),
        ("s05_cone_cyl", "solids.truncated.cone.tip", "0.501"),
        ("s05_cone_cyl", "solids.pointed.cone.to", "[-1.4, 0, 1.401]"),
        ("s05_cone_cyl", "solids.rod.cylinder.radius", "0.7005"),
        ("s06_torus", "solids.ring.torus.minor", "0.4001"),
        ("s06_torus", "solids.ring.torus.major", "1.1001"),
    ] {
        let mut wrong = scene(name);
        path::set(&mut wrong, path, value).unwrap();
        let verdict = judge(&picture(wrong), &reference(name));
        assert!(verdict.is_err(), "{name} with {path} = {value} passes");
    }
}
