//! The graphics card against the CPU: the same light within rounding, the same picture within a code value.

use rayforest::film::develop::Development;
use rayforest::film::{Film, Frame, clipping};
use rayforest::progress::Progress;
use rayforest::scene::Scene;
use rayforest::scene::tone::Tone;
use rayforest::session::Session;
use rayforest::shade::gpu::{Gpu, GpuError, Limits, Product};

use super::{open, set, shipped};

/// Greatest relative difference of light: a card may fuse and may round a division otherwise.
const LIGHT: f32 = 1e-5;
/// Greatest share of pixels that may differ, by one code value.
const PIXELS: f64 = 1e-3;

fn gpu() -> Gpu {
    Gpu::headless().expect("lavapipe is installed: tests/run installs it")
}

/// Where two films differ by more than rounding.
fn light_difference(cpu: &Film, gpu: &Film) -> Option<String> {
    assert_eq!(cpu.layout, gpu.layout);
    let values = |film: &Film| -> Vec<f32> {
        film.blocks.iter().flat_map(|block| block.0.iter().flatten().copied()).collect()
    };
    let (cpu, gpu) = (values(cpu), values(gpu));
    let alike = |(a, b): (&f32, &f32)| (a - b).abs() <= LIGHT * a.abs().max(b.abs());
    // What is no number is like nothing.
    let at = cpu.iter().zip(&gpu).position(|pair| !alike(pair))?;
    Some(format!("value {at}: {:e} and {:e}", cpu[at], gpu[at]))
}

/// Whether two pictures differ by more than a code value, or in too many pixels.
fn picture_difference(cpu: &Frame, gpu: &Frame) -> Option<String> {
    assert_eq!(cpu.size, gpu.size);
    let most = cpu.bytes.iter().zip(&gpu.bytes).map(|(a, b)| a.abs_diff(*b)).max()?;
    let pairs = cpu.bytes.chunks_exact(4).zip(gpu.bytes.chunks_exact(4));
    let other = pairs.filter(|(a, b)| a != b).count();
    let share = other as f64 / (cpu.bytes.len() / 4) as f64;
    (most > 1 || share > PIXELS).then(|| format!("{most} code values, {other} pixels differ"))
}

/// Holds what a card gives of a session's matrix to what the CPU gives.
fn assert_alike(gpu: &Gpu, product: &mut Product, session: &Session, what: &str) {
    let (transport, values) = (session.transport(), &session.terms().values);
    let film = product.film(transport, values).unwrap();
    if let Some(difference) = light_difference(&session.film(), &film) {
        panic!("{what}: {difference}");
    }
    let development = Development::of(&session.scene().picture);
    let frame = product.frame(transport, values, development).unwrap().read(gpu).unwrap();
    if let Some(difference) = picture_difference(session.frame(), &frame) {
        panic!("{what}: {difference}");
    }
    assert_eq!(gpu.fault(), None, "{what}");
}

fn edit(session: &mut Session, path: &str, value: &str) {
    let mut scene = Scene::clone(session.scene());
    set(&mut scene, path, value);
    session.edit(scene, &Progress::default()).unwrap();
}

#[test]
fn a_card_gives_the_picture_of_the_cpu() {
    let gpu = gpu();
    // One product for all: a scene follows another.
    let mut product = Product::new(gpu.clone());
    for (name, size, samples) in
        [("glass", [203, 117], 4), ("studio", [160, 90], 4), ("gems", [96, 54], 2)]
    {
        let session = open(&shipped(name, size, samples), 2);
        assert_alike(&gpu, &mut product, &session, name);
        assert_eq!(product.parts(), 1, "{name} is small");
    }
}

#[test]
fn a_card_follows_every_class_of_edit() {
    let gpu = gpu();
    let mut product = Product::new(gpu.clone());
    let mut session = open(&shipped("whitted", [190, 101], 4), 2);
    assert_alike(&gpu, &mut product, &session, "as opened");
    for (path, value) in [
        ("materials.tiles.diffuse", "0.35"),
        ("picture.exposure", "1.3"),
        ("picture.tone", "neutral"),
        ("materials.mirror.shininess", "7"),
        ("materials.glass.ior", "1.31"),
        ("materials.tiles.reflect", "0.4"),
        ("trace.depth", "2"),
        ("picture.size", "[77, 64]"),
        ("camera.fov_degrees", "61"),
    ] {
        let before = session.frame().clone();
        edit(&mut session, path, value);
        assert!(*session.frame() != before, "{path} = {value} is seen");
        assert_alike(&gpu, &mut product, &session, path);
    }
}

#[test]
fn a_card_marks_the_clipped_pixels_of_the_cpu() {
    let gpu = gpu();
    let mut product = Product::new(gpu.clone());
    let mut scene = shipped("whitted", [190, 101], 4);
    set(&mut scene, "trace.filter", "mitchell");
    for tone in Tone::NAMES {
        for exposure in ["0", "2.5"] {
            set(&mut scene, "picture.exposure", exposure);
            set(&mut scene, "picture.tone", tone);
            let session = open(&scene, 2);
            let development = Development::of(&session.scene().picture);
            let mut frame = session.frame().clone();
            let clipped = clipping::mark(&session.film(), development, &mut frame);
            // A highlight may be brighter than white at any exposure; the tone curve takes it back.
            let expected = *tone == "none";
            assert_eq!(clipped.over > 0, expected, "{tone} {exposure}: {clipped:?}");
            let (transport, values) = (session.transport(), &session.terms().values);
            product.mark_clipped(true);
            let marked = product.frame(transport, values, development).unwrap();
            let difference = picture_difference(&frame, &marked.read(&gpu).unwrap());
            assert_eq!(difference, None, "{tone} {exposure}");
            assert_eq!(frame != *session.frame(), clipped.over + clipped.under > 0);
            product.mark_clipped(false);
            assert_alike(&gpu, &mut product, &session, tone);
        }
    }
}

#[test]
fn a_matrix_that_is_too_large_for_a_binding_spans_three() {
    let gpu = gpu();
    let session = open(&shipped("glass", [200, 120], 4), 2);
    let (transport, values) = (session.transport(), &session.terms().values);
    let whole = Product::new(gpu.clone()).film(transport, values).unwrap();
    let bytes: u64 = transport.tiles.iter().map(|tile| tile.planes.len() as u64 * 64).sum();
    let largest = transport.tiles.iter().map(|tile| tile.planes.len() as u64 * 64).max().unwrap();
    // A part is filled until no whole tile fits.
    let limits = Limits { binding: bytes / 3 + largest / 2, ..gpu.limits() };
    let mut product = Product::within(gpu.clone(), limits);
    assert_alike(&gpu, &mut product, &session, "in parts");
    assert_eq!(product.parts(), 3);
    let film = product.film(transport, values).unwrap();
    assert_eq!(super::film_difference(&whole, &film), None, "the cut changes no bit");
    // What is larger than a binding in one piece is refused, and nothing else.
    let limits = Limits { binding: largest - 1, ..gpu.limits() };
    let refused = Product::within(gpu, limits).film(transport, values);
    assert!(matches!(refused, Err(GpuError::Failed(_))));
}

#[test]
fn a_picture_that_is_too_large_for_a_texture_is_tiled() {
    let gpu = gpu();
    let session = open(&shipped("plain", [150, 100], 1), 2);
    let limits = Limits { texture_side: 70, ..gpu.limits() };
    let mut product = Product::within(gpu.clone(), limits);
    assert_alike(&gpu, &mut product, &session, "in textures of 64");
    let development = Development::of(&session.scene().picture);
    let picture = product.frame(session.transport(), &session.terms().values, development).unwrap();
    assert_eq!(picture.textures().count(), 6);
}

#[test]
fn a_picture_that_is_held_stays_what_it_is() {
    let gpu = gpu();
    let session = open(&shipped("plain", [70, 40], 1), 1);
    let (transport, values) = (session.transport(), &session.terms().values);
    let mut product = Product::new(gpu.clone());
    let held = product.frame(transport, values, Development::PLAIN).unwrap();
    let before = held.read(&gpu).unwrap();
    for gain in [0.5, 0.25, 2.0] {
        let development = Development { gain, ..Development::PLAIN };
        let other = product.frame(transport, values, development).unwrap().read(&gpu).unwrap();
        assert!(other != before, "gain {gain} is seen");
    }
    assert!(held.read(&gpu).unwrap() == before);
}

#[test]
fn a_card_that_is_lost_says_so() {
    let gpu = gpu();
    let session = open(&shipped("plain", [40, 20], 1), 1);
    let (transport, values) = (session.transport(), &session.terms().values);
    let mut product = Product::new(gpu.clone());
    product.frame(transport, values, Development::PLAIN).unwrap();
    assert_eq!(gpu.fault(), None);
    gpu.lose();
    let lost =
        product.frame(transport, values, Development::PLAIN).err().expect("the card is gone");
    assert!(lost.is_lost(), "{lost:?}");
    assert!(lost.to_string().starts_with("the graphics card was lost ("), "{lost}");
}

#[test]
fn light_that_differs_a_little_is_told_apart() {
    let film = open(&shipped("plain", [40, 20], 1), 1).film();
    assert_eq!(light_difference(&film, &film.clone()), None);
    let changed = |change: &dyn Fn(f32) -> f32| {
        let mut other = film.clone();
        let value = &mut other.blocks[3].0[1][7];
        assert!(*value > 0.0);
        *value = change(*value);
        light_difference(&film, &other)
    };
    assert_eq!(changed(&|value| value * (1.0 + LIGHT / 3.0)), None);
    assert!(changed(&|value| value * (1.0 + 3.0 * LIGHT)).is_some());
    assert!(changed(&|_| f32::NAN).is_some());
}

#[test]
fn pictures_that_differ_a_little_are_told_apart() {
    let frame = open(&shipped("plain", [40, 20], 1), 1).frame().clone();
    assert_eq!(picture_difference(&frame, &frame.clone()), None);
    let changed = |bytes: &[usize], by: u8| {
        let mut other = frame.clone();
        bytes.iter().for_each(|&at| other.bytes[at] = other.bytes[at].wrapping_add(by));
        picture_difference(&frame, &other)
    };
    // Of 800 pixels not one may differ.
    assert!(changed(&[41], 1).is_some());
    assert!(changed(&[41], 2).is_some());
    let mut large = Frame::new([100, 100]);
    let black = large.clone();
    large.bytes[0] = 1;
    assert_eq!(picture_difference(&black, &large), None);
    large.bytes[0] = 2;
    assert!(picture_difference(&black, &large).is_some());
}
