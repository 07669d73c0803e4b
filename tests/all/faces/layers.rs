//! What a picture file holds besides the picture: layers, alpha, a region.

use std::collections::BTreeMap;
use std::path::Path;

use exr::prelude::read_first_flat_layer_from_file;

use super::{decode_png, folder_with_scene, run, succeed};

/// Every channel of an EXR by its name.
fn channels(path: &Path) -> BTreeMap<String, Vec<f32>> {
    let image = read_first_flat_layer_from_file(path).unwrap();
    let channel = |channel: &exr::prelude::AnyChannel<exr::prelude::FlatSamples>| {
        (channel.name.to_string(), channel.sample_data.values_as_f32().collect())
    };
    image.layer_data.channel_data.list.iter().map(channel).collect()
}

#[test]
fn the_channels_of_an_exr_are_named_and_add_up() {
    let folder = folder_with_scene();
    succeed(folder.path(), &["render", "scene.toml", "-o", "a.exr", "--layers"]);
    let all = channels(&folder.path().join("a.exr"));
    for kind in ["light.", "material.", "bounce."] {
        for end in ["R", "G", "B"] {
            let whole = &all[end];
            let of_kind = |name: &str| name.starts_with(kind) && name.ends_with(end);
            let parts: Vec<&Vec<f32>> =
                all.iter().filter(|(name, _)| of_kind(name)).map(|(_, values)| values).collect();
            assert!(parts.len() > 1, "{kind} {:?}", all.keys());
            for (i, whole) in whole.iter().enumerate() {
                let sum: f32 = parts.iter().map(|part| part[i]).sum();
                assert!(
                    (sum - whole).abs() <= 1e-5 * whole.max(1.0),
                    "{kind}{end} {i}: {sum} {whole}"
                );
            }
        }
    }
    assert!(all.contains_key("light.key.R") && all.contains_key("material.mirror.B"));
    assert!(!all.contains_key("A"));
    let ran = run(folder.path(), &["render", "scene.toml", "-o", "a.png", "--layers"]);
    assert!(ran.code == Some(2) && ran.messages.contains(".exr"), "{}", ran.messages);
    let ran = run(folder.path(), &["render", "scene.toml", "-o", "a.hdr", "--alpha"]);
    assert!(ran.code == Some(2) && ran.messages.contains("--alpha"), "{}", ran.messages);
}

#[test]
fn a_region_holds_the_bytes_of_the_whole_picture_there() {
    let folder = folder_with_scene();
    let at = |name: &str| folder.path().join(name);
    succeed(folder.path(), &["render", "scene.toml", "-o", "whole.png"]);
    let region = ["render", "scene.toml", "-o", "part.png", "--region", "10,3,20x7"];
    succeed(folder.path(), &region);
    let (whole, part) =
        (decode_png(&at("whole.png")).unwrap().2, decode_png(&at("part.png")).unwrap());
    assert_eq!(part.0, [20, 7]);
    for row in 0..7 {
        let from = ((row + 3) * 48 + 10) * 3;
        assert!(part.2[row * 60..][..60] == whole[from..][..60], "row {row}");
    }
    let outside = ["render", "scene.toml", "-o", "x.png", "--region", "40,3,20x7"];
    let ran = run(folder.path(), &outside);
    assert!(ran.code == Some(2) && ran.messages.contains("48×27"), "{}", ran.messages);
}

#[test]
fn alpha_is_whole_on_the_floor_and_none_in_the_sky() {
    let folder = folder_with_scene();
    for (name, bits, bytes) in [("8.png", "8", 1), ("16.png", "16", 2)] {
        let arguments = ["render", "scene.toml", "-o", name, "--alpha", "--bits", bits];
        succeed(folder.path(), &arguments);
        let (size, _, data) = decode_png(&folder.path().join(name)).unwrap();
        assert_eq!(data.len(), 48 * 27 * 4 * bytes, "{size:?}");
        let alpha = |x: usize, y: usize| data[((y * 48 + x) * 4 + 3) * bytes];
        assert_eq!((alpha(0, 0), alpha(24, 26)), (0, 255), "{name}");
    }
    let exr = ["render", "scene.toml", "-o", "a.exr", "--alpha"];
    succeed(folder.path(), &exr);
    let all = channels(&folder.path().join("a.exr"));
    assert_eq!((all["A"][0], all["A"][26 * 48 + 24]), (0.0, 1.0));
}
