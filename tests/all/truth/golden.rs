//! Small pictures of every shipped scene as they were when somebody last looked at them: exact to
//! the last bit of 16, whatever the CPU.
//!
//! A change that is meant: `RAYFOREST_UPDATE_GOLDENS=1 cargo test golden`, then look at the pictures.

use std::path::{Path, PathBuf};

use rayforest::film::develop::Development;
use rayforest::film::plates::Plates;
use rayforest::film::write::{Format, picture};

use super::picture::Picture;
use super::stage::{open, shipped, shipped_names};

fn place(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("tests/pictures/golden/{name}.png"))
}

/// Writes what a scene shows now and reads it back as 16-bit code values.
fn shown(name: &str, diffuse: f32, to: &Path) -> Picture {
    let mut scene = shipped(name);
    scene.materials[0].diffuse = scene.materials[0].diffuse * diffuse;
    let film = open(scene).film();
    picture(to, Format::Png16, &Plates::of(film), Development::PLAIN, "")
        .expect("a writable folder");
    Picture::of_png16(to)
}

fn judge(ours: &Picture, golden: &Picture) -> bool {
    ours.compare(golden, |_| 0.0).share == 0.0
}

#[test]
fn every_scene_shows_what_it_showed() {
    let folder = tempfile::tempdir().unwrap();
    for name in shipped_names() {
        if std::env::var_os("RAYFOREST_UPDATE_GOLDENS").is_some() {
            shown(&name, 1.0, &place(&name));
        }
        let ours = shown(&name, 1.0, &folder.path().join("ours.png"));
        let golden = Picture::of_png16(&place(&name));
        assert!(judge(&ours, &golden), "{name}\n{}", ours.leave(&golden, &name));
        let bytes = std::fs::metadata(place(&name)).unwrap().len();
        assert!(bytes <= 64 << 10, "{name}: {bytes} bytes");
    }
}

#[test]
fn a_difference_of_a_thousandth_is_seen() {
    let folder = tempfile::tempdir().unwrap();
    let ours = shown("plain", 1.001, &folder.path().join("ours.png"));
    assert!(!judge(&ours, &Picture::of_png16(&place("plain"))));
}
