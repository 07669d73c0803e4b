//! Broken files: cut off, bits flipped, false lengths. Every fault has its place, and nothing panics.

use super::tests::{Folder, folder, import, samples};

/// Cuts of each file, and flips of each file.
const TRIES: usize = 150;

#[track_caller]
fn refused(files: &[(&str, &[u8])], expected: &str) {
    let error = import(&folder(files), files[0].0).unwrap_err().to_string();
    assert!(error.starts_with(expected), "{error}");
    assert!(error.contains("\n  help: "), "{error}");
}

#[test]
fn every_fault_has_its_place() {
    let corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    let obj = |lines: &str, expected: &str| {
        refused(&[("a.obj", format!("{corners}{lines}").as_bytes())], expected);
    };
    obj("f 1 2 4", "a.obj:4:7: there is no vertex 4; the file has 3");
    obj("v nan 0 0\nf 1 2 3", "a.obj:4:3: `nan` is not a finite number");
    obj("mtllib no.mtl\nf 1 2 3", "a.obj:4: the material file `no.mtl` cannot be read");
    obj("f 1 2", "a.obj:4:1: a face needs at least 3 corners");
    let triangle = format!("{corners}mtllib a.mtl\nf 1 2 3");
    let mtl = |text: &str, expected: &str| {
        refused(&[("a.obj", triangle.as_bytes()), ("a.mtl", text.as_bytes())], expected);
    };
    mtl("Kd 1 1 1", "a.mtl:1: `Kd` stands before the first `newmtl`");
    mtl("newmtl a\nKd 1 x 1", "a.mtl:2:6: `x` is not a number");
    mtl("newmtl a\nNs inf", "a.mtl:2:4: `inf` is not a finite number");
    mtl("newmtl a\nKd 1 1", "a.mtl:2: `Kd` needs 1 or 3 numbers, found 2");
    let nff = |text: &str, expected: &str| refused(&[("a.nff", text.as_bytes())], expected);
    nff("p 4000000000\n0 0 0\n1 0 0\n", "a.nff:1: `p 4000000000` is no number of corners");
    nff("p 900000000\n0 0 0\n1 0 0\n", "a.nff:3: the file ends within `p`");
    nff("s 0 0 nan 1", "a.nff:1:7: `nan` is not a finite number");
    nff("s 0 0 0 0", "a.nff:1: a sphere of radius 0 has no size");
    nff("f 1 0 0 1", "a.nff:1: `f` needs 8 or 9 numbers, found 4");
    nff("1 2 3", "a.nff:1:1: `1` is no entity of NFF");
    nff("v\nfrom 1 1 1\nat 1 1 1\ns 0 0 0 1", "a.nff: the scene would be wrong at camera.target");
    refused(&[("a.stl", b"solid")], "a.stl: files that end in `.stl` are not read");
    refused(&[("a.nff", b"")], "a.nff: there is nothing to be seen in it");
}

/// A glTF document with `old` replaced by `new`.
fn changed(old: &str, new: &str) -> String {
    let (_, files) = samples().into_iter().find(|(name, _)| *name == "assimp_scene.gltf").unwrap();
    let text: String =
        String::from_utf8_lossy(&files["assimp_scene.gltf"]).split_whitespace().collect();
    assert!(text.contains(old), "{old} is not in {text}");
    let mut files = files.clone();
    files.insert("a.gltf".to_owned(), text.replacen(old, new, 1).into_bytes());
    import(&files, "a.gltf").unwrap_err().to_string()
}

#[test]
fn false_numbers_of_gltf_are_found_where_they_stand() {
    for (old, new, expected) in [
        (
            "\"count\":4",
            "\"count\":4294967295",
            "a.gltf: accessors[0]: 4294967295 elements are promised",
        ),
        ("\"count\":4", "\"count\":5000000000000", "a.gltf: accessors[0]: 5000000000000 elements"),
        ("\"count\":4", "\"count\":-4", "a.gltf: accessors[0].count: this is no whole number"),
        (
            "\"byteLength\":284",
            "\"byteLength\":4294967295",
            "a.gltf: buffers[0]: 4294967295 bytes are promised",
        ),
        ("\"byteOffset\":0", "\"byteOffset\":18446744073709551615", "a.gltf: accessors[0]"),
        (
            "\"componentType\":5126",
            "\"componentType\":1",
            "a.gltf: accessors[0].componentType: there is no component",
        ),
        (
            "\"bufferView\":0",
            "\"bufferView\":99",
            "a.gltf: accessors[0].bufferView: there is no bufferViews[99]",
        ),
        ("\"version\":\"2.0\"", "\"version\":\"1.0\"", "a.gltf: asset.version: version 1.0"),
        ("assimp_scene.bin", "no.bin", "a.gltf: buffers[0].uri: `no.bin` cannot be read"),
    ] {
        let error = changed(old, new);
        assert!(error.starts_with(expected), "{new}: {error}");
    }
    let loops = r#"{"asset":{"version":"2.0"},"scenes":[{"nodes":[0]}],"nodes":[{"children":[1]},{"children":[0]}]}"#;
    refused(
        &[("a.gltf", loops.as_bytes())],
        "a.gltf: nodes[1].children[0]: node 0 has two parents",
    );
    let required =
        r#"{"asset":{"version":"2.0"},"extensionsRequired":["KHR_draco_mesh_compression"]}"#;
    refused(&[("a.gltf", required.as_bytes())], "a.gltf: extensionsRequired[0]: the file requires");
    refused(&[("a.gltf", b"{\"asset\":")], "a.gltf:1:9: this is not JSON");
    let mut glb = samples().into_iter().find(|(name, _)| *name == "trimesh_two.glb").unwrap().1["trimesh_two.glb"].clone();
    glb[8..12].copy_from_slice(&u32::MAX.to_le_bytes());
    refused(&[("a.glb", &glb)], "a.glb: byte 8: 4294967295 bytes are promised");
    let length = glb.len() as u32;
    glb[8..12].copy_from_slice(&length.to_le_bytes());
    glb[12..16].copy_from_slice(&u32::MAX.to_le_bytes());
    refused(&[("a.glb", &glb)], "a.glb: byte 12: a chunk of 4294967295 bytes is promised");
}

/// Every sample, every one of its files broken in turn; `change` gets a number of its own each time.
fn break_all(change: impl Fn(usize, &mut Vec<u8>)) -> (usize, usize) {
    let (mut read, mut refused) = (0, 0);
    for (name, files) in samples() {
        let parts: Vec<String> = files.keys().cloned().collect();
        for part in parts {
            for number in 0..TRIES {
                let mut broken: Folder = files.clone();
                change(number, broken.get_mut(&part).unwrap());
                match import(&broken, name) {
                    Ok(_) => read += 1,
                    Err(error) => {
                        assert!(!error.cause.is_empty() && !error.way_out.is_empty());
                        refused += 1;
                    }
                }
            }
        }
    }
    (read, refused)
}

#[test]
fn files_cut_off_anywhere_do_not_panic() {
    let (read, refused) = break_all(|number, bytes| bytes.truncate(bytes.len() * number / TRIES));
    // A list of spheres may be cut after any of them; a binary file may not.
    assert!(read > 50 && refused > 500, "{read} read, {refused} refused");
}

#[test]
fn flipped_bits_do_not_panic() {
    let (read, refused) = break_all(|number, bytes| {
        let mut state = number as u64 + 1;
        for _ in 0..=number % 4 {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            let at = (state >> 33) as usize % bytes.len();
            bytes[at] ^= 1 << (state >> 60 & 7);
        }
    });
    assert!(read > 200 && refused > 200, "{read} read, {refused} refused");
}
