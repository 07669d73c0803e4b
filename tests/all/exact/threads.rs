//! Same bytes whatever the number of threads; a refold is what a fresh fold is.

use rayforest::forest::kept::KeptTrees;
use rayforest::forest::tree::TileTrees;
use rayforest::progress::Progress;
use rayforest::scene::model::Model;
use rayforest::session::{Class, Session};

use super::{SHIPPED, assert_same_picture, open, set, shipped};

fn validate(session: &Session) {
    let scene = session.scene();
    for tile in 0..session.forest().tiles.len() {
        let trees = session.trees(tile, &Progress::default()).unwrap();
        trees.validate(scene.materials.len(), scene.solids.len(), scene.lights.len());
    }
    session.transport().validate();
}

#[test]
fn one_two_and_seven_threads_give_the_same_bytes_on_every_scene() {
    for name in SHIPPED {
        let scene = shipped(name, [100, 70], 2);
        let one = open(&scene, 1);
        validate(&one);
        for threads in [2, 7] {
            let many = open(&scene, threads);
            assert_same_picture(&one, &many, &format!("{name}, {threads} threads"));
            assert!(one.transport() == many.transport(), "{name}: another matrix");
            assert!(one.forest() == many.forest(), "{name}: other trees");
            assert_eq!(one.trace_report().rays, many.trace_report().rays, "{name}");
        }
    }
}

#[test]
fn a_refold_is_a_fresh_fold_on_every_scene() {
    for name in SHIPPED {
        let mut session = open(&shipped(name, [70, 40], 3), 2);
        let mut scene = session.scene().clone();
        for (index, shininess) in ["3", "0", "77.5", "1e6", "12"].iter().enumerate() {
            let material = scene.materials[index % scene.materials.len()].name.clone();
            set(&mut scene, &format!("materials.{material}.shininess"), shininess);
            let report = session.edit(scene.clone(), &Progress::default()).unwrap();
            assert_eq!((report.class, report.rays.total()), (Class::Refold, 0), "{name}");
            validate(&session);
        }
        let fresh = open(&scene, 2);
        assert!(session.transport() == fresh.transport(), "{name}: refolded, not as folded");
        assert_same_picture(&session, &fresh, name);
    }
}

#[test]
fn a_refold_is_a_fresh_fold_in_every_model() {
    for &model in Model::NAMES {
        let mut scene = shipped("whitted", [70, 40], 3);
        // The glass between them: the others' highlights are weighted where they are seen in it.
        set(&mut scene, "materials.glass.fresnel", "true");
        for material in ["glass", "mirror", "tiles"] {
            set(&mut scene, &format!("materials.{material}.model"), model);
            set(&mut scene, &format!("materials.{material}.specular"), "0.5");
        }
        let mut session = open(&scene, 2);
        let groups = |session: &Session| {
            let tiles = session.transport().tiles.iter();
            let lists = tiles.flat_map(|t| &t.highlights).flat_map(|h| h.groups.clone());
            let weighted: Vec<bool> = lists.map(|g| g.weighted).collect();
            [weighted.contains(&false), weighted.contains(&true)]
        };
        let plain = matches!(model, "phong" | "blinn");
        assert_eq!(groups(&session), [plain, true], "{model}: lists without and with weights");
        let key = if model == "cook_torrance" { "roughness" } else { "shininess" };
        for value in ["0.9", "0.02", "0.25"] {
            for material in ["glass", "mirror"] {
                set(&mut scene, &format!("materials.{material}.{key}"), value);
            }
            let report = session.edit(scene.clone(), &Progress::default()).unwrap();
            assert_eq!((report.class, report.rays.total()), (Class::Refold, 0), "{model}");
            validate(&session);
            let fresh = open(&scene, 2);
            assert!(session.transport() == fresh.transport(), "{model}: not as folded afresh");
            assert_same_picture(&session, &fresh, model);
        }
    }
}

#[test]
fn matrices_of_other_exponents_differ() {
    let scene = shipped("whitted", [40, 22], 1);
    let mut other = scene.clone();
    set(&mut other, "materials.mirror.shininess", "99.9");
    assert!(open(&scene, 1).transport() != open(&other, 1).transport());
    assert!(open(&scene, 1).transport() == open(&scene, 1).transport());
}

#[test]
fn trees_of_a_tile_are_the_kept_ones() {
    let session = open(&shipped("whitted", [70, 40], 2), 2);
    let keys: Vec<u16> = (0..session.scene().lights.len() as u16).collect();
    for (tile, kept) in session.forest().tiles.iter().enumerate() {
        let trees: TileTrees = session.trees(tile, &Progress::default()).unwrap();
        let kept = kept.as_ref().unwrap();
        assert_eq!(trees.nodes.len(), kept.nodes.len());
        let mut again = KeptTrees::default();
        again.push_grown(&trees, &keys);
        assert!((&again.nodes, &again.lights) == (&kept.nodes, &kept.lights));
        assert!(again.crossings == kept.crossings);
    }
}

#[test]
fn tracing_again_into_the_same_memory_changes_nothing() {
    for name in ["whitted", "gems"] {
        let scene = shipped(name, [70, 40], 2);
        let mut session = open(&scene, 2);
        session.trace_again(&Progress::default()).unwrap();
        let fresh = open(&scene, 2);
        assert_same_picture(&session, &fresh, name);
        assert!(session.forest() == fresh.forest() && session.transport() == fresh.transport());
        validate(&session);
    }
}
