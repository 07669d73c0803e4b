//! A still traced in parts: merged it is the one that was traced at once, and bad parts are refused.

use std::path::{Path, PathBuf};

use rayforest::film::develop::Development;
use rayforest::film::layout::Layout;
use rayforest::forest::grow::RayCounts;
use rayforest::geometry::Geometry;
use rayforest::progress::Progress;
use rayforest::scene::{Scene, write};
use rayforest::session::part::{self, PartError, Share};
use rayforest::session::still::Still;
use rayforest::session::trace::TraceReport;
use rayon::ThreadPoolBuilder;

use super::random::Random;
use super::{PLENTY, SHIPPED, film_difference, open, set, shipped};

fn share(number: usize, of: usize) -> Share {
    format!("{number}/{of}").parse().unwrap()
}

/// Traces one part with so many threads.
fn traced(scene: &Scene, share: Share, threads: usize, path: &Path) -> TraceReport {
    let progress = Progress::default();
    let pool = ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    let geometry = Geometry::build(scene, &progress).unwrap();
    let still = Still { scene, geometry: &geometry, pool: &pool, memory: PLENTY };
    part::write(&still, share, path, &progress).unwrap()
}

/// All parts of a scene's picture, and the rays that each cast.
fn all(scene: &Scene, of: usize, folder: &Path) -> (Vec<PathBuf>, Vec<RayCounts>) {
    let one = |number| {
        let path = folder.join(format!("{number}-of-{of}.part"));
        (path.clone(), traced(scene, share(number, of), 2, &path).rays)
    };
    (1..=of).map(one).unzip()
}

#[test]
fn merged_parts_are_the_picture_and_cast_its_rays_once_on_every_scene() {
    for name in SHIPPED {
        let scene = shipped(name, [130, 100], 2);
        let whole = open(&scene, 2);
        let of = if name == "gems" { 23 } else { 3 };
        let folder = tempfile::tempdir().unwrap();
        let (mut paths, rays) = all(&scene, of, folder.path());
        paths.reverse();
        let merged = part::merge(&paths).unwrap();
        let difference = film_difference(&merged.film, &whole.film());
        assert_eq!(difference, None, "{name} in {of} parts");
        let development = Development::of(&scene.picture);
        assert_eq!((merged.scene, merged.development), (write::text(&scene), development));
        let mut sum = RayCounts::default();
        rays.into_iter().for_each(|rays| sum += rays);
        assert_eq!(sum, whole.trace_report().rays, "{name}: rays of all parts");
    }
}

#[test]
fn parts_of_one_and_of_two_threads_are_equal_files() {
    let folder = tempfile::tempdir().unwrap();
    for name in SHIPPED {
        let scene = shipped(name, [100, 70], 2);
        let bytes = |threads, number| {
            let path = folder.path().join("a.part");
            traced(&scene, share(number, 2), threads, &path);
            std::fs::read(path).unwrap()
        };
        assert!(bytes(1, 2) == bytes(2, 2), "{name}");
        assert!(bytes(1, 1) != bytes(1, 2), "{name}: two parts differ");
    }
}

#[test]
fn every_tile_is_in_one_part_and_parts_are_equally_large() {
    for size in [[1, 1], [33, 31], [640, 360], [1920, 1080], [4096, 32]] {
        let layout = Layout::new(size);
        for of in [1, 2, 3, 7, 16, 60, 5000] {
            let mut times = vec![0; layout.tiles()];
            let counts = (1..=of).map(|number| {
                let tiles = share(number, of).tiles(layout);
                assert!(tiles.is_sorted_by(|a, b| a < b));
                tiles.iter().for_each(|&tile| times[tile] += 1);
                tiles.len()
            });
            let counts: Vec<usize> = counts.collect();
            let (least, most) = (counts.iter().min().unwrap(), counts.iter().max().unwrap());
            assert!(most - least <= 1, "{size:?} in {of}: {least} to {most} tiles");
            assert!(times.iter().all(|&times| times == 1), "{size:?} in {of}");
        }
    }
}

#[test]
fn a_part_is_no_column_of_the_picture() {
    // Sixty tiles wide, in sixty parts: dealt out in rows alone, each part would be a column.
    let layout = Layout::new([1920, 1080]);
    let columns: std::collections::HashSet<usize> =
        share(1, 60).tiles(layout).into_iter().map(|tile| tile % 60).collect();
    assert!(columns.len() > 15, "34 tiles in {} columns", columns.len());
}

fn refusal(paths: &[PathBuf]) -> String {
    let error: PartError = part::merge(paths).err().expect("no picture");
    let text = error.to_string();
    let (cause, way_out) = text.split_once("\n  help: ").expect("a way out");
    assert!(way_out.contains("every part"), "{text}");
    cause.to_owned()
}

/// A picture of six tiles in three parts, its files in the folder.
fn three(folder: &Path) -> (Scene, Vec<PathBuf>) {
    let scene = shipped("whitted", [80, 50], 1);
    let paths = all(&scene, 3, folder).0;
    (scene, paths)
}

#[test]
fn missing_doubled_and_mixed_parts_are_told() {
    let folder = tempfile::tempdir().unwrap();
    let (scene, paths) = three(folder.path());
    assert!(part::merge(&paths).is_ok());
    let [a, b, c] = [0, 1, 2].map(|i| paths[i].clone());
    let text = refusal(&[a.clone(), c.clone()]);
    assert!(text.ends_with("2 of 3 parts are given: part 2/3 is missing"), "{text}");
    assert!(refusal(&[c.clone(), b.clone()]).ends_with("part 1/3 is missing"));
    for twice in [vec![a.clone(), b.clone(), a.clone()], vec![a.clone(), b.clone(), c.clone(), a]] {
        let text = refusal(&twice);
        assert!(text.contains("part 1/3 is given twice: "), "{text}");
    }
    let other = |scene: &Scene, share: Share| {
        let path = folder.path().join("other.part");
        traced(scene, share, 1, &path);
        refusal(&[b.clone(), c.clone(), path])
    };
    assert!(other(&scene, share(1, 4)).contains("it is part 1/4, but "));
    let mut wider = scene.clone();
    set(&mut wider, "picture.size", "[81, 50]");
    assert!(other(&wider, share(1, 3)).ends_with("the pictures have different sizes"));
    let mut redder = scene.clone();
    set(&mut redder, "materials.tiles.diffuse", "0.71");
    assert!(other(&redder, share(1, 3)).ends_with("the scenes differ"));
}

#[test]
fn a_mesh_of_other_corners_is_another_scene() {
    let folder = tempfile::tempdir().unwrap();
    let text = "version = 1\n[picture]\nsize = [40, 20]\n[materials]\nm = {}\n[solids]\n\
                s = { mesh = { file = \"a.obj\" }, material = \"m\" }\n";
    let file = folder.path().join("a.toml");
    std::fs::write(&file, text).unwrap();
    let part = |number: usize, corner: &str| {
        let mesh = format!("v 0 0 0\nv 1 0 0\nv {corner} 1 0\nf 1 2 3\n");
        std::fs::write(folder.path().join("a.obj"), mesh).unwrap();
        let scene = rayforest::scene::read::file(&file).unwrap();
        let path = folder.path().join(format!("{number}{corner}.part"));
        traced(&scene, share(number, 2), 1, &path);
        path
    };
    assert!(part::merge(&[part(1, "0"), part(2, "0")]).is_ok());
    let text = refusal(&[part(1, "0"), part(2, "0.5")]);
    assert!(text.ends_with("a file that the scene names differs"), "{text}");
}

#[test]
fn cut_changed_and_foreign_files_are_no_parts() {
    let folder = tempfile::tempdir().unwrap();
    let (_, paths) = three(folder.path());
    let sound = std::fs::read(&paths[1]).unwrap();
    let whole = part::merge(&paths).unwrap().film;
    let with = |bytes: &[u8]| {
        std::fs::write(&paths[1], bytes).unwrap();
        part::merge(&paths).map(|merged| merged.film)
    };
    assert!(film_difference(&with(&sound).unwrap(), &whole).is_none());
    for length in [0, 5, 16, 20, 32, 40, 200, sound.len() / 2, sound.len() - 1] {
        let error = with(&sound[..length]).expect_err("no picture");
        let cut = error.cause.contains("cut") || error.cause == "this is no part of a picture";
        assert!(cut && error.file == paths[1], "{length} bytes: {error}");
    }
    let mut random = Random(5);
    for _ in 0..400 {
        let mut bytes = sound.clone();
        let at = random.below(bytes.len());
        bytes[at] ^= 1 << random.below(8);
        let error = with(&bytes).expect_err("no picture");
        assert_eq!(error.file, paths[1], "byte {at}: {error}");
    }
    let longer: Vec<u8> = sound.iter().copied().chain([0]).collect();
    assert!(with(&longer).unwrap_err().cause.contains("follows"));
    let error = with(b"version = 1\n[picture]\nsize = [1, 1]\n# a scene is no part").unwrap_err();
    assert_eq!(error.cause, "this is no part of a picture");
    std::fs::remove_file(&paths[1]).unwrap();
    assert!(part::merge(&paths).is_err());
}

#[test]
fn a_cancelled_part_leaves_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let scene = shipped("plain", [80, 50], 1);
    let progress = Progress::default();
    progress.cancel();
    let pool = ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    let geometry = Geometry::build(&scene, &Progress::default()).unwrap();
    let still = Still { scene: &scene, geometry: &geometry, pool: &pool, memory: PLENTY };
    let path = folder.path().join("a.part");
    assert!(part::write(&still, share(1, 2), &path, &progress).is_err());
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
}

#[test]
fn shares_are_read() {
    for text in ["1/1", "3/8", " 8 / 8 "] {
        assert!(text.parse::<Share>().is_ok(), "{text}");
    }
    for text in ["0/8", "9/8", "3", "/", "a/b", "-1/2", "1/0", "1/2/3", "1/4294967296"] {
        assert!(text.parse::<Share>().is_err(), "{text}");
    }
    assert_eq!(share(3, 8).to_string(), "3/8");
}
