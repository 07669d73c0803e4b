//! The chart of speed against accuracy on the command line: four files that tell the same.

use std::path::Path;

use rayforest::scene::{path, read};
use rayforest::session::{Options, Session};
use serde_json::Value;

use super::{SCENE, decode_png, folder_with_scene, names_in, run, succeed};

fn charted(folder: &Path, reference: &str, more: &[&str]) -> (Value, String) {
    let mut arguments = vec!["chart", "scene.toml", "-o", "out", "--reference", reference];
    arguments.extend(more);
    let ran = succeed(folder, &arguments);
    let text = std::fs::read(folder.join("out/chart.json")).unwrap();
    (serde_json::from_slice(&text).unwrap(), ran.results)
}

/// The values of a sweep, and its errors.
fn sweep(chart: &Value, number: usize) -> (Vec<f64>, Vec<f64>) {
    let points = chart["settings"][number]["points"].as_array().unwrap();
    let of = |pointer: &str| -> Vec<f64> {
        points.iter().map(|p| p.pointer(pointer).unwrap().as_f64().unwrap()).collect()
    };
    (of("/value"), of("/error/rms_linear"))
}

#[test]
fn a_chart_is_four_files_that_agree() {
    let folder = folder_with_scene();
    let (chart, results) = charted(folder.path(), "64", &["--error", "0.05"]);
    let out = folder.path().join("out");
    assert_eq!(names_in(&out), ["chart.csv", "chart.json", "chart.png", "chart.svg"]);
    assert!(results.contains("recommended for an error below 0.05 rms of linear light: trace."));

    let paths: Vec<&str> =
        chart["settings"].as_array().unwrap().iter().map(|s| s["path"].as_str().unwrap()).collect();
    assert_eq!(paths[..3], ["trace.samples", "trace.depth", "trace.cutoff"]);
    let (samples, errors) = sweep(&chart, 0);
    assert_eq!(samples, [1., 2., 4., 8., 16.]);
    assert!(errors.is_sorted_by(|a, b| a > b) && errors[4] > 0.0, "{errors:?}");
    assert_eq!(chart["settings"][0]["truth"], 64);
    let (depths, errors) = sweep(&chart, 1);
    // A ball that mirrors a floor: nothing is reflected twice.
    assert_eq!(depths, [0., 1.]);
    assert!(errors.is_sorted_by(|a, b| a > b), "{errors:?}");
    assert_eq!(errors.last(), Some(&0.0), "deeper pictures are the same");
    let rays = |point: usize| {
        chart["settings"][0]["points"][point]["cost"]["rays"].as_u64().unwrap() as f64
    };
    assert!((rays(4) / rays(0) - 16.0).abs() < 1.0, "{} and {} rays", rays(4), rays(0));

    let table = std::fs::read_to_string(out.join("chart.csv")).unwrap();
    let lines: Vec<&str> = table.lines().collect();
    let points: usize = (0..paths.len()).map(|number| sweep(&chart, number).0.len()).sum();
    assert_eq!(lines.len(), 1 + points + 2, "{table}");
    let columns = lines[0].split(',').count();
    assert!(lines.iter().all(|line| line.split(',').count() == columns), "{table}");
    assert!(lines[1].starts_with("trace.samples,1,"));

    let drawing = std::fs::read_to_string(out.join("chart.svg")).unwrap();
    // With the legend's, of which there is one for each setting.
    assert_eq!(drawing.matches("<circle").count(), points + paths.len());
    assert!(drawing.contains("<title>trace.samples = 4: "));
    let (size, bits, bytes) = decode_png(&out.join("chart.png")).unwrap();
    assert_eq!((size, bits), ([1440, 1020], 8));
    let (pixels, _) = bytes.as_chunks::<4>();
    let blue = pixels.iter().filter(|p| **p == [0x00, 0x72, 0xb2, 255]).count();
    assert!(blue > 100, "{blue} pixels in the colour of the samples");
}

/// The rms of the difference of two pictures in linear light.
fn rms(a: &Session, b: &Session) -> f64 {
    let (a, b, [width, height]) = (a.film(), b.film(), a.scene().picture.size);
    let places = (0..height).flat_map(|y| (0..width).map(move |x| [x, y]));
    let square = |place| {
        let pairs = a.pixel(place).0.into_iter().zip(b.pixel(place).0);
        pairs.map(|(a, b)| f64::from(a - b) * f64::from(a - b)).sum::<f64>()
    };
    (places.map(square).sum::<f64>() / f64::from(width * height * 3)).sqrt()
}

#[test]
fn what_is_recommended_has_the_wanted_error_against_the_finest_of_everything() {
    let folder = folder_with_scene();
    let open = |settings: &[(&str, String)]| {
        let mut scene = read::text(SCENE, Path::new("scene.toml")).unwrap();
        settings.iter().for_each(|(name, value)| path::set(&mut scene, name, value).unwrap());
        Session::open(scene, Options::default(), &Default::default()).unwrap()
    };
    let finest = [("trace.samples", "2048"), ("trace.depth", "64"), ("trace.cutoff", "0")];
    let finest = open(&finest.map(|(name, value)| (name, value.to_owned())));
    for wanted in ["0.03", "0.012"] {
        let (chart, results) = charted(folder.path(), "1024", &["--error", wanted]);
        let advised = chart["recommended"]["values"].as_object().unwrap();
        assert_eq!(chart["recommended"]["reaches_goal"], true, "{results}");
        let settings: Vec<(&str, String)> =
            advised.iter().map(|(name, value)| (name.as_str(), value.to_string())).collect();
        let error = rms(&open(&settings), &finest);
        let wanted: f64 = wanted.parse().unwrap();
        assert!(error < wanted, "{error} with {settings:?}");
        assert!(results.contains(&format!("below {wanted} rms of linear light")), "{results}");
    }
    assert!(rms(&open(&[]), &finest) > 0.012, "two samples are not as good");
}

#[test]
fn a_goal_out_of_reach_is_told() {
    let folder = folder_with_scene();
    let (chart, results) = charted(folder.path(), "16", &["--error", "1e-9", "--size", "40x20"]);
    assert_eq!(chart["recommended"]["reaches_goal"], false);
    assert_eq!(chart["size"], serde_json::json!([40, 20]));
    assert!(results.contains("nothing measured has an error below 0.000000001 rms"), "{results}");
}

#[test]
fn charts_that_cannot_be_are_refused() {
    let folder = folder_with_scene();
    let refused = |arguments: &[&str], word: &str| {
        let ran = run(folder.path(), &[&["chart", "scene.toml"], arguments].concat());
        assert!(ran.code == Some(2) && ran.results.is_empty(), "{arguments:?}: {}", ran.results);
        assert!(ran.messages.contains(word), "{}", ran.messages);
        assert_eq!(names_in(folder.path()), ["scene.toml"], "{arguments:?}");
    };
    refused(&[], "--output");
    refused(&["-o", "out", "--reference", "4"], "--reference");
    refused(&["-o", "out", "--error", "0"], "--error");
    refused(&["-o", "out", "--set", "trace.deep=3"], "trace.depth");
    let ran = run(folder.path(), &["chart", "scene.toml", "-o", "scene.toml"]);
    assert!(ran.code == Some(1) && ran.messages.contains("cannot make scene.toml"));
}
