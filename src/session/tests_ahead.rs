//! A part that is traced before the rest: everything is traced once, and is what it is without a part.

use std::cell::RefCell;
use std::path::Path;

use super::*;
use crate::film::layout::Layout;
use crate::film::plates::Region;
use crate::progress::Cancelled;
use crate::scene::{path, read};

/// More than the scenes need.
const PLENTY: u64 = 1 << 32;

/// A shipped scene, small, with some values changed.
fn scene(name: &str, values: &[(&str, &str)]) -> Arc<Scene> {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("scenes/{name}.toml"));
    let mut scene = read::file(&file).unwrap();
    for (name, value) in [("picture.size", "[150, 100]")].iter().chain(values) {
        path::set(&mut scene, name, value).unwrap();
    }
    Arc::new(scene)
}

/// What tracing `scene` needs.
fn start(scene: &Arc<Scene>, memory: u64) -> Start {
    let pool = Arc::new(ThreadPoolBuilder::new().num_threads(2).build().unwrap());
    Start {
        scene: scene.clone(),
        geometry: Arc::new(Geometry::build(scene, &Progress::default()).unwrap()),
        pool,
        options: Options { threads: 2, memory },
        kept: Kept::Trees,
        reuse: Forest::default(),
    }
}

fn region(corner: [u32; 2], size: [u32; 2]) -> Region {
    Region { corner, size }
}

/// In one corner, in the middle, of one pixel, and all of it.
fn regions() -> [Region; 4] {
    [
        region([0, 0], [40, 20]),
        region([50, 40], [60, 30]),
        region([149, 99], [1, 1]),
        region([0, 0], [150, 100]),
    ]
}

/// The session of a trace with a region before the rest, and what was shown of it.
fn traced(start: Start, region: Region) -> (Session, Session) {
    let shown = RefCell::new(Vec::new());
    let show = |session| {
        shown.borrow_mut().push(session);
        Ok(())
    };
    let progress = Progress::default();
    let session =
        Session::begin_with(start, Some(Ahead { region, show: &show }), &progress).unwrap();
    let tiles = session.transport.layout.tiles() as u64;
    assert_eq!(progress.steps(), (tiles, tiles), "every tile once");
    let [shown] = <[Session; 1]>::try_from(shown.into_inner()).ok().expect("shown once");
    (session, shown)
}

/// Holds what is shown of a region to the whole picture: its tiles, and nothing else.
fn shows_the_region(shown: &Session, whole: &Session, region: Region, what: &str) {
    let layout = Layout::new(whole.frame().size);
    let within = region.tiles(layout);
    for tile in 0..layout.tiles() {
        let (part, tiles) = (&shown.transport.tiles[tile], &whole.transport.tiles);
        assert!(shown.forest.tiles[tile].is_none(), "{what}: its trees are the trace's");
        let empty = part.terms.is_empty();
        assert_eq!(empty, !within.contains(&tile), "{what}: tile {tile} of {}", tiles.len());
    }
    shown.transport.validate();
    let [width, height] = layout.size;
    for pixel in (0..height).flat_map(|y| (0..width).map(move |x| [x, y])) {
        if within.contains(&layout.place(pixel).tile) {
            assert_eq!(shown.frame().pixel(pixel), whole.frame().pixel(pixel), "{what}: {pixel:?}");
        }
    }
}

/// Holds two sessions to the same picture, matrix, trees and rays.
fn same(a: &Session, b: &Session, what: &str) {
    assert!(a.frame() == b.frame(), "{what}: picture");
    assert!(a.transport.trie == b.transport.trie, "{what}: terms");
    assert!(a.transport.tiles == b.transport.tiles, "{what}: matrix");
    assert!(a.forest == b.forest, "{what}: trees");
    assert!(a.map == b.map, "{what}: numbers of samples");
    let counts = |session: &Session| (session.trace.rays, session.trace.nodes);
    assert_eq!(counts(a), counts(b), "{what}: rays and nodes");
}

#[test]
fn all_is_as_without_a_region_and_no_ray_is_cast_twice() {
    let adaptive = |refine| [("trace.samples", "16"), ("trace.adaptive", "0.2"), refine];
    for (name, scene) in [
        ("glass", scene("glass", &[("trace.samples", "2")])),
        ("motion", scene("motion", &[("trace.samples", "4")])),
        ("adaptive", scene("whitted", &adaptive(("trace.refine", "trees")))),
        ("by contrast", scene("plain", &adaptive(("trace.refine", "contrast")))),
    ] {
        let plain = Session::begin(start(&scene, PLENTY), &Progress::default()).unwrap();
        assert!(plain.trace.rays.total() > 0);
        for region in regions() {
            let what = format!("{name}, {region:?}");
            let (whole, shown) = traced(start(&scene, PLENTY), region);
            same(&whole, &plain, &what);
            shows_the_region(&shown, &whole, region, &what);
        }
    }
}

#[test]
fn memory_of_earlier_trees_and_the_budget_change_no_bit() {
    let scene = scene("glass", &[("trace.samples", "4")]);
    let plain = Session::begin(start(&scene, PLENTY), &Progress::default()).unwrap();
    let trees = plain.forest.bytes() as u64;
    let terms = plain.transport.trie.bytes() as u64;
    let budget = plain.kept_bytes() - terms - trees / 2;
    for (memory, region) in [PLENTY, budget].into_iter().flat_map(|m| regions().map(|r| (m, r))) {
        let mut before = Session::begin(start(&scene, memory), &Progress::default()).unwrap();
        let start = Start { reuse: before.take_trees(), ..start(&scene, memory) };
        let (whole, _) = traced(start, region);
        let what = format!("{memory}, {region:?}");
        assert!(whole.frame() == plain.frame(), "{what}");
        assert!(whole.transport.tiles == plain.transport.tiles || memory == budget, "{what}");
        assert_eq!(whole.trace.rays, plain.trace.rays, "{what}");
        let terms = whole.transport.trie.bytes() as u64;
        assert!(whole.kept_bytes() - terms <= memory, "{what}");
        assert_eq!(whole.forest.released() > 0, memory == budget, "{what}");
        let first = region.tiles(whole.transport.layout)[0];
        assert!(whole.forest.tiles[first].is_some(), "{what}: the region's are released last");
    }
}

#[test]
fn whoever_is_shown_the_region_may_end_the_trace() {
    let scene = scene("plain", &[]);
    let progress = Progress::default();
    let show = |_| Err(Cancelled);
    let ahead = Ahead { region: region([20, 20], [30, 30]), show: &show };
    let ended = Session::begin_with(start(&scene, PLENTY), Some(ahead), &progress);
    assert_eq!(ended.err(), Some(TraceError::Cancelled));
    assert_eq!(progress.steps().0, 4, "no tile of the rest");
}

#[test]
#[should_panic(expected = "rays and nodes")]
fn rays_that_are_cast_again_are_seen() {
    let scene = scene("plain", &[]);
    let once = Session::begin(start(&scene, PLENTY), &Progress::default()).unwrap();
    let mut twice = Session::begin(start(&scene, PLENTY), &Progress::default()).unwrap();
    twice.trace.rays += once.trace.rays;
    same(&once, &twice, "on purpose");
}
