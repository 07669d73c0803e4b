//! Lights leave each other alone: which ones a scene has besides changes no ray of a light.

use std::path::Path;

use rayforest::progress::Progress;
use rayforest::scene::{Light, Scene, read};

use super::table::LAMPS;
use super::{open, set};

fn scene() -> Scene {
    read::text(LAMPS, Path::new("lamps.toml")).unwrap_or_else(|e| panic!("{e}"))
}

/// The records of the light of this name at every node of every tree: their numbers to the last bit,
/// and what was crossed.
fn records(scene: &Scene, name: &str) -> Vec<(usize, [u32; 4], Vec<u32>)> {
    let index = scene.lights.iter().position(|light| light.name == name).unwrap();
    let session = open(scene, 2);
    let mut records = Vec::new();
    let mut node_index = 0;
    for tile in 0..session.transport().layout.tiles() {
        let trees = session.trees(tile, &Progress::default()).unwrap();
        let mut reader = trees.read(0);
        for _ in &trees.hits {
            reader.sample();
        }
        for _ in &trees.nodes {
            let lights = reader.node().lights;
            for _ in 0..lights {
                let (hit, crossed) = reader.light();
                if usize::from(hit.light) == index {
                    let numbers = [hit.n_dot_l, hit.angle, hit.weight].map(f32::to_bits);
                    let [n_dot_l, angle, weight] = numbers;
                    let bits = [n_dot_l, angle, weight, hit.crossed.into()];
                    records.push((node_index, bits, crossed.to_vec()));
                }
            }
            node_index += 1;
        }
    }
    records
}

#[test]
fn other_lights_change_no_record_of_a_light() {
    let scene = scene();
    type Alteration = fn(&mut Scene);
    let others: [(&str, Alteration); 5] = [
        ("one more, the first", |s| s.lights.insert(0, Light::new("zero"))),
        ("another order", |s| s.lights.reverse()),
        ("others gone", |s| s.lights.retain(|l| l.name == "panel" || l.name == "ball")),
        ("more rays to another", |s| set(s, "lights.lamp.samples", "9")),
        ("another darker", |s| set(s, "lights.cone.intensity", "0")),
    ];
    for name in ["panel", "ball"] {
        let alone = records(&scene, name);
        assert!(alone.len() > 1000, "{name}: {} records", alone.len());
        for (what, alter) in others {
            let mut altered = scene.clone();
            alter(&mut altered);
            assert!(records(&altered, name) == alone, "{name}: {what}");
        }
    }
    // The comparison can fail.
    for (path, value) in [
        ("lights.panel.samples", "4"),
        ("lights.panel.area.rectangle.center", "[-2, -3, 4.01]"),
        ("materials.mirror.gloss", "201"),
    ] {
        let mut altered = scene.clone();
        set(&mut altered, path, value);
        assert!(records(&altered, "panel") != records(&scene, "panel"), "{path}");
    }
}

/// A light with several rays has a record for each at every node where any has something to show, in
/// the order of its rays.
#[test]
fn records_are_of_all_rays_of_a_light_or_of_none() {
    let scene = scene();
    for (name, rays) in [("panel", 5), ("lamp", 3), ("ball", 1), ("cone", 1), ("key", 1)] {
        let records = records(&scene, name);
        let behind = records.iter().filter(|r| r.1[3] == u32::from(u16::MAX - 1)).count();
        for node in records.chunk_by(|a, b| a.0 == b.0) {
            assert_eq!(node.len(), rays, "{name}, node {}", node[0].0);
        }
        assert_eq!(behind > 0, rays > 1, "{name}: {behind} rays behind a surface");
    }
}
