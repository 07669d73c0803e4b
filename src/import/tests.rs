//! Readers against files of other programs and small ones made here: what is mapped, what is remarked.

use std::collections::HashMap;
use std::io;
use std::path::Path;

use glam::DVec3;

use super::*;
use crate::color::Rgb;
use crate::scene::model::Model;
use crate::scene::{Background, Bump, Lens, LightPlace, Material, Paint, Shape};

/// A folder in memory.
pub(super) type Folder = HashMap<String, Vec<u8>>;

/// Imports a file of a folder as if the scene were to stand beside it.
pub(super) fn import(folder: &Folder, name: &str) -> Result<Imported, ImportError> {
    let fetch = |path: &Path| {
        let name = path.to_string_lossy().into_owned();
        folder.get(&name).cloned().ok_or_else(|| io::Error::from(io::ErrorKind::NotFound))
    };
    from(Path::new(name), Path::new("out.toml"), &fetch)
}

pub(super) fn folder(files: &[(&str, &[u8])]) -> Folder {
    files.iter().map(|(name, bytes)| ((*name).to_owned(), bytes.to_vec())).collect()
}

/// The files of other programs, with what they need beside them.
pub(super) fn samples() -> Vec<(&'static str, Folder)> {
    macro_rules! sample {
        ($name:literal $(, $beside:literal)*) => {
            ($name, folder(&[
                ($name, include_bytes!(concat!("../../tests/imports/", $name))),
                $(($beside, include_bytes!(concat!("../../tests/imports/", $beside))),)*
            ]))
        };
    }
    vec![
        sample!("assimp_scene.obj", "assimp_scene.mtl"),
        sample!("trimesh_box.obj", "trimesh_box.mtl"),
        sample!("meshio_cube.obj"),
        sample!("assimp_scene.gltf", "assimp_scene.bin"),
        sample!("trimesh_two.glb"),
        sample!("gltfpack_two.glb"),
        sample!("spd_teapot.nff"),
        sample!("spd_tetra.nff"),
        sample!("spd_balls.nff"),
    ]
}

fn sample(name: &str) -> Imported {
    let (_, folder) = samples().into_iter().find(|(sample, _)| *sample == name).unwrap();
    import(&folder, name).unwrap_or_else(|error| panic!("{error}"))
}

fn texts(imported: &Imported) -> Vec<String> {
    imported.notes.iter().map(Note::to_string).collect()
}

#[track_caller]
fn assert_noted(imported: &Imported, words: &str) {
    assert!(
        texts(imported).iter().any(|text| text.contains(words)),
        "{words}: {:#?}",
        texts(imported)
    );
}

fn triangles(imported: &Imported) -> Vec<usize> {
    let count = |solid: &crate::scene::Solid| match &solid.shape {
        Shape::Mesh { file: _, mesh } => mesh.triangles.len(),
        _ => 0,
    };
    imported.scene.solids.iter().map(count).collect()
}

#[test]
fn obj_of_other_programs() {
    let found = sample("assimp_scene.obj");
    assert_eq!(triangles(&found), [2, 6]);
    let names: Vec<&str> = found.scene.solids.iter().map(|s| s.name.as_str()).collect();
    assert_eq!(names, ["floor", "pyramid"], "groups are objects where there are none");
    let names: Vec<&str> = found.scene.materials.iter().map(|m| m.name.as_str()).collect();
    assert_eq!(names, ["tiles", "glass"]);
    let glass = &found.scene.materials[1];
    assert_eq!((glass.transmit, glass.kloc), (Rgb::grey(0.8), Rgb::grey(0.2)));
    assert_noted(&found, "the material `DefaultMaterial` is left out: no face uses it");
    assert_eq!(found.parts.len(), 2, "a file for each solid");
    let found = sample("trimesh_box.obj");
    assert_eq!((triangles(&found), found.parts.len()), (vec![12], 0));
    let box_ = &found.scene.materials[0];
    assert_eq!((box_.specular, box_.shininess), (Rgb::grey(0.352_941_2), 50.0));
    let found = sample("meshio_cube.obj");
    assert_eq!((triangles(&found), found.scene.lights.len()), (vec![12], 1));
    assert_noted(&found, "added: a camera");
}

#[test]
fn gltf_of_other_programs() {
    let found = sample("assimp_scene.gltf");
    assert_eq!(triangles(&found).iter().sum::<usize>(), 8);
    assert_noted(&found, "`FB_ngon_encoding` is left out");
    assert_noted(&found, "`KHR_materials_pbrSpecularGlossiness` is left out");
    let plain = sample("trimesh_two.glb");
    assert_eq!(triangles(&plain), [12, 80]);
    let [red, glass] = &plain.scene.materials[..] else { panic!("two materials") };
    assert_eq!((red.name.as_str(), red.metallic, red.diffuse), ("red metal", 1.0, Rgb::BLACK));
    assert_eq!((glass.transmit, glass.ior), (Rgb::grey(0.6), 1.0));
    assert_noted(&plain, "cameras: they are left out");
    // The same scene in whole numbers: its points are at most a step of the grid elsewhere.
    let packed = sample("gltfpack_two.glb");
    assert_eq!(triangles(&packed), [12, 80]);
    let bounds = |found: &Imported, solid: usize| match &found.scene.solids[solid].shape {
        Shape::Mesh { file: _, mesh } => mesh
            .positions
            .iter()
            .fold([DVec3::INFINITY, DVec3::NEG_INFINITY], |[a, b], p| [a.min(*p), b.max(*p)]),
        _ => panic!("a mesh"),
    };
    for solid in 0..2 {
        for (a, b) in bounds(&plain, solid).iter().zip(bounds(&packed, solid)) {
            assert!((*a - b).abs().max_element() < 2e-4, "solid {solid}: {a} and {b}");
        }
    }
}

#[test]
fn nff_of_other_programs() {
    let found = sample("spd_teapot.nff");
    assert_eq!(triangles(&found), [2, 6]);
    assert_eq!(found.scene.background, Background::Color(Rgb([0.078, 0.361, 0.753])));
    assert_eq!(
        (found.scene.camera.eye, found.scene.picture.size),
        (DVec3::new(4.86, 7.2, 5.4), [512, 512])
    );
    assert_eq!(found.scene.lights.len(), 2);
    assert!((found.scene.lights[0].intensity.0[0] - 0.5f32.sqrt()).abs() < 1e-6);
    assert_noted(&found, "2 lights without a strength");
    let pot = &found.scene.materials[2];
    assert_eq!(
        (pot.diffuse, pot.reflect, pot.shininess),
        (Rgb::grey(0.75), Rgb::grey(0.25), 3.0827)
    );
    let found = sample("spd_tetra.nff");
    assert_eq!(triangles(&found), [4]);
    let Shape::Mesh { file: _, mesh } = &found.scene.solids[0].shape else { panic!("a mesh") };
    assert_eq!(mesh.positions.len(), 4, "shared corners are one");
    let found = sample("spd_balls.nff");
    assert_eq!(found.scene.solids.len(), 11);
}

#[test]
fn what_is_written_reads_back_as_the_same_scene() {
    for (name, files) in samples() {
        let disk = tempfile::tempdir().unwrap();
        for (file, bytes) in &files {
            std::fs::write(disk.path().join(file), bytes).unwrap();
        }
        let target = disk.path().join("deep/scene.toml");
        std::fs::create_dir(disk.path().join("deep")).unwrap();
        let imported = file(&disk.path().join(name), &target).unwrap();
        imported.write(&target).unwrap_or_else(|error| panic!("{name}: {error}"));
        assert_eq!(read::file(&target).unwrap(), imported.scene, "{name}");
    }
}

#[test]
fn a_scene_that_reads_back_as_another_is_an_error() {
    let disk = tempfile::tempdir().unwrap();
    let mut imported = sample("trimesh_two.glb");
    imported.scene.solids[0].name = imported.scene.solids[1].name.clone();
    assert!(imported.write(&disk.path().join("a.toml")).is_err());
    let mut imported = sample("trimesh_two.glb");
    imported.parts[0].bytes.extend(b"f 1 2 3\n");
    let error = imported.write(&disk.path().join("b.toml")).unwrap_err();
    assert_eq!(error.cause, "it reads back as another scene");
}

const TRIANGLE: &str = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl m\nf 1 2 3\n";

fn with_mtl(lines: &str) -> Imported {
    let mtl = format!("newmtl m\n{lines}");
    let files = folder(&[("a.obj", TRIANGLE.as_bytes()), ("a.mtl", mtl.as_bytes())]);
    import(&files, "a.obj").unwrap_or_else(|error| panic!("{error}"))
}

fn material(lines: &str) -> Material {
    with_mtl(lines).scene.materials[0].clone()
}

#[test]
fn every_key_of_mtl_is_mapped_or_remarked_upon() {
    let m = material("Ka 0.1 0.05 0\nKd 0.8 0.4 0\nKs 0.5\nKe 2 1 0\nNs 60\nNi 1.4\nPm 0.25");
    assert_eq!((m.paint, m.diffuse), (Paint::Solid(Rgb([1.0, 0.5, 0.0])), Rgb::grey(0.8)));
    assert_eq!(m.ambient, Rgb([0.1, 0.1, 0.0]));
    assert_eq!((m.specular, m.shininess, m.model), (Rgb::grey(0.5), 60.0, Model::Blinn));
    assert_eq!((m.emission, m.ior, m.metallic), (Rgb([2.0, 1.0, 0.0]), 1.4, 0.25));
    // No room for Ka in a colour that is black: the coefficients take all of it.
    let m = material("Ka 0.3\nKd 0 0 0.5");
    assert_eq!(
        (m.paint, m.diffuse, m.ambient),
        (Paint::Solid(Rgb::WHITE), Rgb([0.0, 0.0, 0.5]), Rgb::grey(0.3))
    );
    let white = material("Kd xyz 0.950456 1 1.089058").diffuse;
    assert!(white.0.iter().all(|x| (x - 1.0).abs() < 2e-4), "{white:?}");
    for key in [
        "map_Ka",
        "map_Ks",
        "map_Ns",
        "map_d",
        "map_Tr",
        "map_Ke",
        "decal",
        "disp",
        "norm",
        "refl",
        "map_aat",
        "sharpness",
        "Pr",
        "Ps",
        "Pc",
        "Pcr",
        "aniso",
        "anisor",
        "map_Pr",
        "nonsense",
    ] {
        let found = with_mtl(&format!("Kd 1\n{key} 1\n"));
        assert_noted(&found, &format!("a.mtl:3: `{key}` is left out"));
    }
    assert_noted(&with_mtl("Kd spectral a.rfl"), "a.mtl:2: `Kd spectral` is left out");
    assert_noted(&with_mtl("d -halo 0.5"), "`-halo` is left out");
    assert_noted(&with_mtl("Ns -3"), "`Ns` is brought into its range, 0 in place of -3");
}

#[test]
fn transparency_by_d_tr_and_illum() {
    assert_noted(&with_mtl("d 0.3\nTr 0.3"), "a.mtl:3: `Tr` is 0.3 and `d` is 0.3");
    assert!(!texts(&with_mtl("d 0.3\nTr 0.7")).iter().any(|text| text.contains("`Tr`")));
    assert_eq!(material("Tr 0.25").kloc, Rgb::grey(0.75));
    let cases = [
        ("illum 1\nKs 1", [0.0, 0.0, 0.0], false),
        ("illum 2\nKs 0.5", [0.5, 0.0, 0.0], false),
        ("illum 3\nKs 0.5", [0.5, 0.5, 0.0], false),
        ("illum 5\nKs 0.5", [0.5, 0.5, 0.0], true),
        ("illum 6\nKs 0.5\nd 0.25", [0.5, 0.5, 0.75], false),
        ("illum 7\nKs 0.5\nd 0.25", [0.5, 0.5, 0.75], true),
    ];
    for (lines, [specular, reflect, transmit], fresnel) in cases {
        let m = material(lines);
        let wanted = (Rgb::grey(specular), Rgb::grey(reflect), Rgb::grey(transmit), fresnel);
        assert_eq!((m.specular, m.reflect, m.transmit, m.fresnel), wanted, "{lines}");
    }
    assert_eq!(material("Ni 1.5\nd 0.5\nillum 4").ior, 1.0);
    assert_eq!(material("Ni 1.5\nd 0.5\nillum 6").ior, 1.5);
    let glass = material("Ks 0.1\nTf 0.9 1 0.9\nNi 1.5\nillum 7");
    assert_eq!(
        (glass.transmit, glass.filter, glass.kloc),
        (Rgb::WHITE, Rgb([0.9, 1.0, 0.9]), Rgb::BLACK)
    );
    let flat = material("Kd 0.5\nillum 0");
    assert_eq!((flat.emission, flat.diffuse), (Rgb::grey(0.5), Rgb::BLACK));
}

#[test]
fn images_of_mtl() {
    let png = one_texel();
    let mtl =
        b"newmtl m\nKd 0.5\nmap_Kd -s 2 2 2 tex\\a.png\nbump -bm 0.5 tex/a.png\nmap_Kd b.tga\n";
    let files = folder(&[("a.obj", TRIANGLE.as_bytes()), ("a.mtl", mtl), ("tex/a.png", &png)]);
    let found = import(&files, "a.obj").unwrap();
    let Paint::Image { image, tint, size } = &found.scene.materials[0].paint else {
        panic!("image")
    };
    assert_eq!((image.file.as_str(), *tint, *size), ("tex/a.png", Rgb::WHITE, 0.5));
    let Bump::Image { height, .. } = &found.scene.materials[0].bump else { panic!("bump") };
    assert_eq!(*height, 0.01);
    assert_noted(&found, "a.mtl:5: the image `b.tga` is left out");
}

fn one_texel() -> Vec<u8> {
    let mut png = Vec::new();
    let mut encoder = png::Encoder::new(&mut png, 1, 1);
    encoder.set_color(png::ColorType::Rgb);
    encoder.write_header().unwrap().write_image_data(&[200, 100, 50]).unwrap();
    png
}

#[test]
fn obj_is_split_by_object_and_material() {
    let text = "v 0 0 0\nv 1 0 0 \\\n 1\nv 0 1 0\nv 0 0 1\nvn 0 0 1\no a\nusemtl x\nf 1//1 2//1 3//1\n\
                usemtl y\nf -2 -3 -4\no b\nusemtl x\nf 1 2 4\ng c\nl 1 2\nusemtl x\nf 1 3 4\n";
    let found = import(&folder(&[("a.obj", text.as_bytes())]), "a.obj").unwrap();
    let solids: Vec<_> = found.scene.solids.iter().map(|s| (s.name.as_str(), s.material)).collect();
    assert_eq!(solids, [("a", 0), ("a 2", 1), ("b", 0)]);
    assert_eq!(triangles(&found), [1, 1, 2]);
    let Shape::Mesh { file, mesh } = &found.scene.solids[1].shape else { panic!("a mesh") };
    assert_eq!(file, "out-parts/a_2.obj");
    assert_eq!(mesh.positions, [DVec3::Y, DVec3::X, DVec3::ZERO]);
    assert_noted(&found, "a.obj:8: there is no material `x`: it is made matt white");
    assert_noted(&found, "a.obj:16: `l` is left out: lines and points have no surface");
}

/// A glTF file of one triangle, with more keys of the root, of the node and of the primitive.
fn gltf(root: &str, node: &str, primitive: &str) -> Result<Imported, ImportError> {
    let text = format!(
        r#"{{"asset":{{"version":"2.0"}},"scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0{node}}}],
        "meshes":[{{"name":"t","primitives":[{{"attributes":{{"POSITION":0}}{primitive}}}]}}],
        "buffers":[{{"byteLength":36,"uri":"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}}],
        "bufferViews":[{{"buffer":0,"byteLength":36}}],
        "accessors":[{{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}}]{root}}}"#
    );
    import(&folder(&[("a.gltf", text.as_bytes())]), "a.gltf")
}

#[test]
fn gltf_nodes_cameras_and_lights() {
    let root = r#","cameras":[{"type":"perspective","perspective":{"yfov":1.0,"znear":0.1,"aspectRatio":2.0}}],
        "extensions":{"KHR_lights_punctual":{"lights":[{"type":"spot","intensity":6.283185307179586,
        "color":[1,0.5,0.25],"range":3,"spot":{"innerConeAngle":0.25,"outerConeAngle":0.5}}]}},
        "animations":[{}]"#;
    let node = r#","camera":0,"translation":[0,0,4],"scale":[-1,1,1],"extensions":{"KHR_lights_punctual":{"light":0}}"#;
    let found = gltf(root, node, "").unwrap();
    let scene = &found.scene;
    assert_eq!((scene.camera.eye, scene.camera.target), (DVec3::Z * 4.0, DVec3::Z * 3.0));
    assert_eq!(scene.camera.lens, Lens::Perspective { fov_degrees: 1f64.to_degrees() });
    assert_eq!((scene.picture.size, scene.camera.up), ([720, 360], DVec3::Y));
    let light = &scene.lights[0];
    assert_eq!(
        (light.intensity, light.color, light.falloff),
        (Rgb::grey(2.0), Rgb([1.0, 0.5, 0.25]), 1.0)
    );
    let LightPlace::Spot { at, edge, .. } = light.place else { panic!("a spot") };
    assert_eq!((at, edge), (DVec3::Z * 4.0, 0.5));
    let Shape::Mesh { file: _, mesh } = &scene.solids[0].shape else { panic!("a mesh") };
    let [a, b, c] = mesh.triangles[0].map(|index| mesh.positions[index as usize]);
    assert_eq!([a, b, c], [DVec3::Z * 4.0, DVec3::new(0.0, 1.0, 4.0), DVec3::new(-1.0, 0.0, 4.0)]);
    assert!((b - a).cross(c - a).z > 0.0, "a mirror keeps the outer side");
    assert_noted(&found, "animations: 1 of `animations` are left out");
    assert_noted(&found, "extensions.KHR_lights_punctual.lights[0].range: `range` is left out");
}

#[test]
fn gltf_materials() {
    let of = |material: &str| {
        let root = format!(r#","materials":[{{"name":"m",{material}}}]"#);
        let found = gltf(&root, "", r#","material":0"#).unwrap();
        (found.scene.materials[0].clone(), found)
    };
    let (m, found) = of(
        r#""emissiveFactor":[1,0.5,0],"normalTexture":{"index":0},"alphaMode":"MASK",
        "extensions":{"KHR_materials_emissive_strength":{"emissiveStrength":4},"KHR_materials_sheen":{}}"#,
    );
    assert_eq!((m.emission, m.metallic), (Rgb([4.0, 2.0, 0.0]), 1.0));
    assert_noted(&found, "materials[0].normalTexture: `normalTexture` is left out");
    assert_noted(&found, "materials[0].alphaMode: `alphaMode` MASK is left out");
    assert_noted(&found, "materials[0]: `KHR_materials_sheen` is left out");
    let (m, _) = of(r#""pbrMetallicRoughness":{"metallicFactor":0,"roughnessFactor":0,
        "baseColorFactor":[0.9,1,0.9,1]},"extensions":{"KHR_materials_transmission":
        {"transmissionFactor":1},"KHR_materials_ior":{"ior":1.33}}"#);
    assert_eq!((m.transmit, m.filter, m.ior), (Rgb::WHITE, Rgb([0.9, 1.0, 0.9]), 1.33));
    assert!(m.fresnel && m.kloc.is_black());
    assert_eq!(crate::scene::energy::overbright(&gltf("", "", "").unwrap().scene), []);
}

#[test]
fn nff_spheres_and_what_is_not_known() {
    let text = "l 1 2 3 0.5 0.25 1\nf 1 0 0 .5 .2 10 .3 1.5 .1\nQ 7\ns 0 0 0 2\nc\n0 0 0 0.5\n0 0 1 1\nc 0 0 0 1 0 0 1 1\n\
                p 4\n0 0 0\n1 0 0\n1 1 0\n0 1 0.5\n";
    let found = import(&folder(&[("a.nff", text.as_bytes())]), "a.nff").unwrap();
    let m = &found.scene.materials[0];
    assert_eq!((m.transmit, m.ior, m.ambient), (Rgb::grey(0.3), 1.5, Rgb::grey(0.1)));
    assert_eq!(found.scene.lights[0].intensity, Rgb([0.5, 0.25, 1.0]));
    assert_eq!(found.scene.solids[0].shape, Shape::Sphere { center: DVec3::ZERO, radius: 2.0 });
    assert_noted(&found, "a.nff:3:1: `Q` is left out");
    assert_noted(&found, "a.nff:5: cones and cylinders are open in NFF");
    let (from, to) = (DVec3::ZERO, DVec3::Z);
    let cone = Shape::Cone { from: to, to: from, radius: 1.0, tip: 0.5 };
    assert_eq!(found.scene.solids[1].shape, cone);
    assert_eq!(found.scene.solids[2].shape, Shape::Cylinder { from, to, radius: 1.0 });
    assert_eq!(triangles(&found), [0, 0, 0, 2]);
}
