//! Filters, lens and shutter against closed forms: blur discs, ramps, profiles of edges, slopes.

use glam::DVec3;

use rayforest::color::Rgb;
use rayforest::scene::filter::Filter;
use rayforest::scene::{Background, Camera, Lens, Material, Picture, Scene, Shape, Solid, Trace};

use super::stage::open;

/// A picture of `size` pixels in which only what gives off light is seen, from (0, 0, 0) towards +y.
fn dark(size: [u32; 2], samples: u32, lens: Lens) -> Scene {
    let lamp = Material {
        emission: Rgb::WHITE,
        ambient: Rgb::BLACK,
        diffuse: Rgb::BLACK,
        ..Material::new("lamp")
    };
    Scene {
        picture: Picture { size, ..Picture::default() },
        camera: Camera { eye: DVec3::ZERO, target: DVec3::Y, lens, ..Camera::default() },
        trace: Trace { samples, ..Trace::default() },
        materials: vec![lamp],
        ..Scene::default()
    }
}

/// Row by row the red light of a scene.
fn light(scene: &Scene) -> Vec<Vec<f64>> {
    let film = open(scene.clone()).film();
    let [width, height] = scene.picture.size;
    let row = |y| (0..width).map(|x| f64::from(film.pixel([x, y]).0[0])).collect();
    (0..height).map(row).collect()
}

/// Everything to the left of `x` at a depth gives off light.
fn left_of(x: f64, depth: f64) -> Solid {
    let corner = |x, z| DVec3::new(x, depth, z);
    let points =
        vec![corner(-900.0, -900.0), corner(x, -900.0), corner(x, 900.0), corner(-900.0, 900.0)];
    Solid::new("left", Shape::Polygon { points }, 0)
}

/// Root mean square, and mean with its standard error from rows, of light minus `truth(x)`.
fn errors(scene: &Scene, columns: std::ops::Range<usize>, truth: impl Fn(f64) -> f64) -> [f64; 3] {
    let rows = light(scene);
    let of_row = |row: &Vec<f64>| -> Vec<f64> {
        columns.clone().map(|x| row[x] - truth(x as f64 + 0.5)).collect()
    };
    let all: Vec<Vec<f64>> = rows.iter().map(of_row).collect();
    let count = (all.len() * columns.len()) as f64;
    let rms = (all.iter().flatten().map(|e| e * e).sum::<f64>() / count).sqrt();
    let means: Vec<f64> =
        all.iter().map(|row| row.iter().sum::<f64>() / columns.len() as f64).collect();
    let mean = means.iter().sum::<f64>() / means.len() as f64;
    let spread = means.iter().map(|m| (m - mean).powi(2)).sum::<f64>() / means.len() as f64;
    [rms, mean, (spread / means.len() as f64).sqrt()]
}

/// Slope of the error from 16 to 256 samples, and whether any mean is off by three deviations.
fn converges(
    scene: &Scene,
    columns: std::ops::Range<usize>,
    truth: &dyn Fn(f64) -> f64,
) -> (f64, bool) {
    let mut rms = Vec::new();
    let mut biased = false;
    for samples in [16, 64, 256] {
        let scene = Scene { trace: Trace { samples, ..scene.trace.clone() }, ..scene.clone() };
        let [error, mean, deviation] = errors(&scene, columns.clone(), truth);
        rms.push(error);
        // A picture of exact rows has no deviation but that of single precision.
        biased |= mean.abs() > 3.0 * deviation.max(1e-7);
    }
    ((rms[2] / rms[0]).log2() / 4.0, biased)
}

/// Share of a disc of radius 1 that lies left of x.
fn disc_left_of(x: f64) -> f64 {
    let x = x.clamp(-1.0, 1.0);
    0.5 + (x.asin() + x * (1.0 - x * x).sqrt()) / std::f64::consts::PI
}

/// The mean of a function over a pixel.
fn over_pixel(x: f64, of: impl Fn(f64) -> f64) -> f64 {
    let n = 400;
    (0..n).map(|i| of(x - 0.5 + (f64::from(i) + 0.5) / f64::from(n))).sum::<f64>() / f64::from(n)
}

#[test]
fn a_point_out_of_focus_is_a_disc_of_the_size_that_optics_gives() {
    let fov_degrees = 40.0;
    let height = 2.0 * (f64::to_radians(fov_degrees) / 2.0).tan();
    for (depth, focus) in [(12.0, 5.0), (3.0, 5.0)] {
        let size = 64.0;
        // A|z − f|/z on the plane of focus, in pixels.
        let aperture = 1.2;
        let disc = aperture * f64::abs(depth - focus) / depth / focus / height * size;
        let mut scene = dark([64, 64], 256, Lens::Perspective { fov_degrees });
        (scene.camera.aperture, scene.camera.focus) = (aperture, focus);
        // A flat lamp of 4 pixels' radius, a regular polygon of 64 corners.
        let radius = 4.0 * depth * height / size;
        let corner = |i: u32| f64::from(i) * std::f64::consts::TAU / 64.0;
        let corner = |i| DVec3::new(radius * corner(i).cos(), depth, radius * corner(i).sin());
        let points = (0..64).map(corner).collect();
        scene.solids.push(Solid::new("lamp", Shape::Polygon { points }, 0));
        let rows = light(&scene);
        let (mut mass, mut across, mut down) = (0.0, 0.0, 0.0);
        for (y, row) in rows.iter().enumerate() {
            for (x, light) in row.iter().enumerate() {
                let arm = [x, y].map(|c| c as f64 + 0.5 - 32.0);
                mass += light;
                across += light * arm[0] * arm[0];
                down += light * arm[1] * arm[1];
            }
        }
        // The lamp's own disc, and the pixels that it was counted in.
        let own = 16.0 / 4.0 * (2.0 + (std::f64::consts::TAU / 64.0).cos()) / 3.0 + 1.0 / 12.0;
        for moment in [across, down] {
            let found = moment / mass - own;
            let truth = disc * disc / 16.0;
            assert!((found / truth - 1.0).abs() < 0.02, "z {depth}: {found} and not {truth}");
        }
        // What is in focus stays as small as it is.
        scene.camera.focus = depth;
        let sharp = light(&scene);
        assert!(sharp[32][40] == 0.0 && sharp[32][32] > 0.999, "in focus");
        scene.camera.aperture = 0.0;
        assert_eq!(light(&scene)[32][40], 0.0, "a pinhole");
    }
}

#[test]
fn an_edge_out_of_focus_has_the_profile_of_the_disc() {
    let fov_degrees = 40.0;
    let pixel = 2.0 * (f64::to_radians(fov_degrees) / 2.0).tan() / 48.0;
    // A disc far larger than a pixel: what is summed has an edge in two dimensions.
    let (depth, focus, aperture) = (10.0, 4.0, 6.0);
    let radius = aperture * (depth - focus) / depth / focus / pixel / 2.0;
    let mut scene = dark([40, 48], 64, Lens::Perspective { fov_degrees });
    (scene.camera.aperture, scene.camera.focus) = (aperture, focus);
    scene.solids.push(left_of(0.03, depth));
    let edge = 20.0 + 0.03 / depth / pixel;
    let truth = |x: f64| over_pixel(x, |x| disc_left_of((edge - x) / radius));
    let (slope, biased) = converges(&scene, 14..27, &truth);
    assert!(slope <= -0.7, "slope {slope}");
    assert!(!biased, "biased");
    // A lens of another diameter is seen.
    let wrong = |x: f64| over_pixel(x, |x| disc_left_of((edge - x) / (1.1 * radius)));
    assert!(converges(&scene, 21..27, &wrong).1);
}

#[test]
fn a_moving_edge_is_a_ramp() {
    let mut scene = dark([40, 48], 64, Lens::Parallel { height: 48.0 });
    let mut edge = left_of(-8.3, 5.0);
    edge.motion.translate = DVec3::new(20.0, 0.0, 0.0);
    scene.solids.push(edge);
    for shutter in [1.0, 0.7] {
        scene.camera.shutter = shutter;
        // From 11.7 pixels on, so many in all; one unit is a pixel.
        let way = 20.0 * shutter;
        let truth = |x: f64| over_pixel(x, |x| 1.0 - ((x - 11.7) / way).clamp(0.0, 1.0));
        let (slope, biased) = converges(&scene, 10..34, &truth);
        assert!(slope <= -0.7, "slope {slope}");
        assert!(!biased, "biased");
        let wrong = |x: f64| over_pixel(x, |x| 1.0 - ((x - 11.7) / (1.05 * way)).clamp(0.0, 1.0));
        assert!(converges(&scene, 10..34, &wrong).1, "another way is seen");
    }
    scene.camera.shutter = 0.0;
    let still = light(&scene);
    assert_eq!((still[20][10], still[20][13]), (1.0, 0.0), "a shutter that opens for no time");
}

/// ∫ of a filter left of x, by its formula.
fn filter_left_of(filter: Filter, x: f64) -> f64 {
    let f = |x: f64| match (filter, x.abs()) {
        (Filter::Box, x) => f64::from(u8::from(x < 0.5)),
        (Filter::Tent, x) => (1.0 - x).max(0.0),
        (Filter::Gaussian, x) if x < 1.5 => (-2.0 * x * x).exp(),
        (Filter::Mitchell, x) if x < 1.0 => (7.0 * x.powi(3) - 12.0 * x * x + 16.0 / 3.0) / 6.0,
        (Filter::Mitchell, x) if x < 2.0 => {
            (-7.0 / 3.0 * x.powi(3) + 12.0 * x * x - 20.0 * x + 32.0 / 3.0) / 6.0
        }
        _ => 0.0,
    };
    let steps = 4000;
    let at = |i: i32| -2.0 + 4.0 * (f64::from(i) + 0.5) / f64::from(steps);
    let whole: f64 = (0..steps).map(|i| f(at(i))).sum();
    (0..steps).map(at).filter(|at| *at < x).map(f).sum::<f64>() / whole
}

#[test]
fn an_edge_has_the_profile_of_the_filter() {
    for filter in Filter::ALL {
        let mut scene = dark([40, 48], 64, Lens::Parallel { height: 48.0 });
        scene.trace.filter = filter;
        // The edge lies at 20.3 pixels.
        scene.solids.push(left_of(0.3, 5.0));
        let truth = |x: f64| filter_left_of(filter, 20.3 - x);
        let (slope, _) = converges(&scene, 17..24, &truth);
        assert!(slope <= -0.7, "{filter:?}: slope {slope}");
        let [rms, mean, _] = errors(&scene, 17..24, truth);
        // 64 samples in 7 × 48 pixels; the ratio of signed means is biased by less than 1/64.
        assert!(rms < 0.03 && mean.abs() < 2e-3, "{filter:?}: {rms} {mean}");
        let overshoot = light(&scene)[20].iter().any(|light| *light > 1.005);
        assert_eq!(overshoot, filter == Filter::Mitchell, "{filter:?}");
    }
}

#[test]
fn a_picture_of_one_light_keeps_it_whatever_the_filter() {
    for filter in Filter::ALL {
        for samples in [1, 2, 3, 5, 16, 64] {
            let mut scene = dark([40, 33], samples, Lens::Parallel { height: 48.0 });
            scene.background = Background::Color(Rgb::grey(0.7));
            scene.trace.filter = filter;
            let rows = light(&scene);
            let worst = rows.iter().flatten().map(|l| (l / f64::from(0.7f32) - 1.0).abs());
            // A sum of n equal numbers, each rounded by half an ulp.
            let bound = f64::from(samples) * f64::from(f32::EPSILON);
            assert!(worst.fold(0.0, f64::max) <= bound, "{filter:?} {samples}");
        }
    }
}

#[test]
fn one_sample_is_in_the_middle_of_pixel_lens_and_shutter() {
    let mut scene = dark([40, 33], 1, Lens::Perspective { fov_degrees: 40.0 });
    let mut edge = left_of(0.0, 5.0);
    scene.solids.push(edge.clone());
    let plain = light(&scene);
    (scene.camera.aperture, scene.camera.focus) = (1.0, 2.0);
    scene.trace.filter = Filter::Mitchell;
    assert_eq!(light(&scene), plain);
    edge.placement.translate.x = -1.0;
    edge.motion.translate.x = 2.0;
    scene.solids = vec![edge];
    assert_eq!(light(&scene), plain);
}
