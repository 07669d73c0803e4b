//! What was written is read; what was not written so is refused, whatever it is.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use rayon::ThreadPool;
use twox_hash::XxHash3_64;

use super::codec::Section;
use super::file::{Header, MAGIC, Numbers, Opened, PREFIX, Part, Scratch, pack};
use super::*;
use crate::progress::Progress;
use crate::scene::model::Model;
use crate::scene::{Scene, read as scene_text};
use crate::session::{Options, Session};

/// SplitMix64.
struct Random(u64);

impl Random {
    fn below(&mut self, count: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ self.0 >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ z >> 31) % count as u64) as usize
    }
}

/// How many of some cases to try: more in a long run.
fn cases(count: usize) -> usize {
    if std::env::var_os("RAYFOREST_LONG").is_some() { 20 * count } else { count }
}

/// Glass and mirrors, in four tiles of which three hang over the edge.
fn scene() -> Scene {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/glass.toml");
    let mut scene = scene_text::file(&file).unwrap();
    scene.picture.size = [37, 35];
    scene.trace.samples = 1;
    scene.trace.depth = 3;
    // Highlights with weights and without.
    scene.materials[1].model = Model::Hall;
    scene.materials[2].fresnel = true;
    scene.materials[3].model = Model::CookTorrance;
    scene
}

/// A session, its cache file and the bytes of that.
struct Kept {
    session: Session,
    folder: tempfile::TempDir,
    path: PathBuf,
    bytes: Vec<u8>,
}

fn kept(trees: bool) -> Kept {
    let options = Options { threads: 2, memory: 1 << 30 };
    let session = Session::open(scene(), options, &Progress::default()).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("glass.rayforest-cache");
    let report = write(&session, &path, trees, &Progress::default()).unwrap();
    let bytes = std::fs::read(&path).unwrap();
    assert_eq!(report.file_bytes, bytes.len() as u64);
    assert_eq!((report.lists, report.trees), (4, if trees { 4 } else { 0 }));
    Kept { session, folder, path, bytes }
}

impl Kept {
    /// Reads a file of these bytes.
    fn read(&self, bytes: &[u8]) -> Result<Cached, Fault> {
        std::fs::write(&self.path, bytes).unwrap();
        self.read_within(1 << 30)
    }

    fn read_within(&self, budget: u64) -> Result<Cached, Fault> {
        let session = &self.session;
        let cached = read(&self.path, &session.scene, &session.pool, budget, &Progress::default());
        cached.map_err(|error| {
            assert_eq!(error.file, self.path);
            assert!(error.to_string().lines().count() == 2, "{error}");
            error.fault
        })
    }

    fn header(&self) -> Header {
        std::fs::write(&self.path, &self.bytes).unwrap();
        Opened::open(&self.path, &program()).map_err(|_| ()).unwrap().header
    }

    /// The file with another header, its checksum right.
    fn with_header(&self, change: impl FnOnce(&mut Header)) -> Vec<u8> {
        let mut header = self.header();
        let before = header.bytes().len();
        change(&mut header);
        [&header.bytes(), &self.bytes[before..]].concat()
    }

    /// The file with some part changed, its length and checksum right.
    fn with_part(&self, number: usize, change: impl FnOnce(&mut Vec<u8>)) -> Vec<u8> {
        std::fs::write(&self.path, &self.bytes).unwrap();
        let file = Opened::open(&self.path, &program()).map_err(|_| ()).unwrap();
        let held = file.header.parts[number].held;
        let mut bytes = Vec::new();
        let unread = file.part(number, &mut Scratch::default(), |source| {
            while let Ok(byte) = source.value::<u8>() {
                bytes.push(byte);
            }
            Ok(())
        });
        assert!(matches!(unread, Err(Fault::Damaged { .. })), "arrays were not read as such");
        change(&mut bytes);
        let (stored, part) = pack(&Section { bytes, held });
        let mut header = file.header.clone();
        let mut at = header.bytes().len();
        let mut out = Vec::new();
        for (index, old) in file.header.parts.iter().enumerate() {
            let own = &self.bytes[at..at + old.stored as usize];
            out.extend_from_slice(if index == number { &stored } else { own });
            at += old.stored as usize;
        }
        header.parts[number] = part;
        [header.bytes(), out].concat()
    }
}

fn assert_same(cached: &Cached, session: &Session, what: &str) {
    assert!(cached.scene == *session.scene, "{what}: another scene");
    assert!(cached.transport == session.transport, "{what}: another matrix");
    assert!(cached.trace == session.trace, "{what}: another trace");
}

#[test]
fn all_that_was_kept_comes_back() {
    for trees in [false, true] {
        let kept = kept(trees);
        let cached = kept.read_within(1 << 30).unwrap();
        assert_same(&cached, &kept.session, "as it was");
        let Cached { forest, report, .. } = &cached;
        assert_eq!(forest.released(), if trees { 0 } else { 4 });
        assert_eq!((report.lists, report.trees), (4, 4 - forest.released()));
        assert!(!trees || *forest == kept.session.forest, "other trees");
        assert!(report.file_bytes < report.plain_bytes, "{report:?}");
        let again = kept.folder.path().join("again");
        write(&kept.session, &again, trees, &Progress::default()).unwrap();
        assert!(std::fs::read(again).unwrap() == kept.bytes, "equal sessions give equal files");
        assert_eq!(std::fs::read_dir(kept.folder.path()).unwrap().count(), 2, "left-over files");
    }
}

#[test]
#[should_panic(expected = "another matrix")]
fn a_coefficient_that_differs_is_noticed() {
    let kept = kept(false);
    let mut cached = kept.read_within(1 << 30).unwrap();
    let plane = &mut Arc::make_mut(&mut cached.transport.tiles[0]).planes[0].0[3];
    *plane = f32::from_bits(plane.to_bits() ^ 1);
    assert_same(&cached, &kept.session, "on purpose");
}

#[test]
fn a_small_budget_leaves_out_trees_and_then_highlight_lists() {
    let kept = kept(true);
    let Session { transport, forest, .. } = &kept.session;
    let matrix: usize = transport.tiles.iter().map(|tile| tile.bytes()).sum();
    let needs = [matrix, transport.highlight_bytes(), forest.bytes()].map(|n| n as u64);
    let [matrix, lists, trees] = needs;
    for (budget, some_lists, some_trees) in [
        (matrix + lists + trees, 4..=4, 4..=4),
        (matrix + lists + trees - 1, 4..=4, 1..=3),
        (matrix + lists, 4..=4, 0..=0),
        (matrix + lists - 1, 1..=3, 0..=0),
        (matrix, 0..=0, 0..=0),
    ] {
        let cached = kept.read_within(budget).unwrap();
        let Cached { report, forest, transport, .. } = &cached;
        assert!(some_lists.contains(&report.lists), "{budget}: {report:?}");
        assert!(some_trees.contains(&report.trees), "{budget}: {report:?}");
        let matrix: usize = transport.tiles.iter().map(|tile| tile.bytes()).sum();
        let held = matrix + transport.highlight_bytes() + forest.bytes();
        assert!(held as u64 <= budget, "{budget}: {held}");
    }
    let refused = kept.read_within(matrix - 1).err();
    assert_eq!(refused, Some(Fault::Memory { budget: matrix - 1 }));
}

#[test]
fn files_of_others_and_of_other_programs_are_told_apart() {
    let kept = kept(false);
    for other in [&b""[..], b"RAYFOREST", b"\x89PNG\r\n\x1a\n and so on, and so on", b"version = 1"]
    {
        assert_eq!(kept.read(other).err(), Some(Fault::Foreign), "{other:?}");
    }
    let stale = |bytes: &[u8]| match kept.read(bytes).err() {
        Some(Fault::Stale { what }) => what,
        other => panic!("{other:?}"),
    };
    let mut format = kept.bytes.clone();
    format[MAGIC.len() - 1] += 1;
    assert!(stale(&format).contains("format"));
    let older = kept.with_header(|header| header.program = "0.0.1 1 pdp11".into());
    assert!(stale(&older).contains("0.0.1 1 pdp11"));
    let mesh = kept.with_header(|header| header.meshes.push(7));
    assert!(stale(&mesh).contains("mesh"));
    let fault = |path: &Path| {
        let Kept { session, .. } = &kept;
        read(path, &session.scene, &session.pool, 1, &Progress::default()).err().unwrap().fault
    };
    assert_eq!(fault(&kept.folder.path().join("none")), Fault::Absent);
    assert_eq!(fault(kept.folder.path()), Fault::Io { cause: "it is no file".into() });
}

#[test]
fn a_job_that_is_cancelled_leaves_the_file_of_before() {
    let kept = kept(false);
    let progress = Progress::default();
    progress.cancel();
    let stopped = write(&kept.session, &kept.path, true, &progress).unwrap_err();
    let Fault::Stopped(error) = stopped.fault else { panic!("{stopped}") };
    assert_eq!(error, crate::session::trace::TraceError::Cancelled);
    assert!(std::fs::read(&kept.path).unwrap() == kept.bytes);
    let Session { scene, pool, .. } = &kept.session;
    let read = read(&kept.path, scene, pool, 1 << 30, &progress).err().unwrap();
    assert_eq!(read.fault, stopped.fault);
    assert_eq!(std::fs::read_dir(kept.folder.path()).unwrap().count(), 1, "left-over files");
}

#[test]
fn a_file_that_is_not_finished_leaves_the_one_of_before() {
    let kept = kept(false);
    let files = || std::fs::read_dir(kept.folder.path()).unwrap().count();
    let mut writing = Writing::begin(&kept.session, &kept.path, false).unwrap();
    while !writing.is_complete() {
        assert_eq!(files(), 2);
        assert!(std::fs::read(&kept.path).unwrap() == kept.bytes);
        let written = writing.go_on(&kept.session, 3).unwrap();
        assert!((1..=3).contains(&written));
    }
    drop(writing);
    assert!(std::fs::read(&kept.path).unwrap() == kept.bytes);
    assert_eq!(files(), 1, "left-over files");
    let mut writing = Writing::begin(&kept.session, &kept.path, true).unwrap();
    assert_eq!(writing.go_on(&kept.session, 1000).unwrap() as u64, writing.parts());
    assert_eq!(writing.finish().unwrap().trees, 4);
    assert!(std::fs::read(&kept.path).unwrap().len() > kept.bytes.len());
    assert_eq!(files(), 1, "left-over files");
}

#[test]
#[should_panic(expected = "the session of the beginning")]
fn an_edit_while_a_file_is_written_is_noticed() {
    let mut kept = kept(false);
    let mut writing = Writing::begin(&kept.session, &kept.path, false).unwrap();
    writing.go_on(&kept.session, 1).unwrap();
    let mut scene = kept.session.scene().clone();
    scene.picture.exposure = 1.0;
    kept.session.edit(scene, &Progress::default()).unwrap();
    let _ = writing.go_on(&kept.session, 1);
}

#[test]
fn a_file_that_is_no_cache_is_not_replaced() {
    let kept = kept(false);
    let other = kept.folder.path().join("other");
    for (text, replaced) in [("a note", false), ("", false), ("RAYFOREST CACHE and so on", true)] {
        std::fs::write(&other, text).unwrap();
        let written = write(&kept.session, &other, false, &Progress::default());
        assert_eq!(written.is_ok(), replaced, "{text}");
        assert_eq!(std::fs::read(&other).unwrap() == text.as_bytes(), !replaced, "{text}");
        assert!(replaced || written.unwrap_err().fault == Fault::Foreign);
    }
}

#[test]
fn lengths_that_no_part_has_ask_for_no_memory() {
    let kept = kept(true);
    let last = kept.header().parts.len() - 1;
    let huge = [u64::MAX, u64::MAX / 2, 1 << 62, 1 << 40];
    for number in [Numbers::SCENE, Numbers::TERMS, 2, 6, last] {
        for value in huge {
            let changes: [fn(&mut Part, u64); 4] = [
                |part, value| part.stored = value,
                |part, value| part.plain = value,
                |part, value| part.held = value,
                |part, value| (part.plain, part.held) = (value, value),
            ];
            for change in changes {
                let bytes = kept.with_header(|header| change(&mut header.parts[number], value));
                assert!(kept.read(&bytes).is_err(), "part {number}, {value}");
            }
        }
    }
    for at in MAGIC.len()..MAGIC.len() + 8 {
        let mut bytes = kept.bytes.clone();
        bytes[at] = 0xff;
        assert!(kept.read(&bytes).is_err());
    }
    // An array inside of a part, longer than the part.
    for number in [Numbers::SCENE, Numbers::TERMS, 2, 6, last] {
        let bytes = kept.with_part(number, |plain| plain[6] = 0x7f);
        assert!(matches!(kept.read(&bytes).err(), Some(Fault::Damaged { .. })), "part {number}");
    }
}

#[test]
fn a_file_that_is_cut_or_longer_is_refused() {
    let kept = kept(true);
    let random = &mut Random(3);
    let header = kept.header().bytes().len();
    let some = (0..400).map(|_| random.below(kept.bytes.len()));
    let ends = kept.bytes.len() - 20..kept.bytes.len();
    for length in (0..60).chain(header - 20..header + 20).chain(some).chain(ends) {
        assert!(kept.read(&kept.bytes[..length]).is_err(), "{length} bytes");
    }
    assert!(kept.read(&[&kept.bytes[..], b"x"].concat()).is_err(), "one byte more");
    assert!(kept.read(&kept.bytes).is_ok(), "as it was");
}

#[test]
fn no_changed_byte_gives_another_picture() {
    let kept = kept(true);
    let random = &mut Random(5);
    let length = kept.bytes.len();
    let mut refused = 0;
    for case in 0..cases(2000) {
        let mut bytes = kept.bytes.clone();
        let at = if case < 8 * PREFIX { case / 8 } else { random.below(length) };
        let run = 1 + random.below(300).min(length - at - 1);
        match case % 5 {
            _ if case < 8 * PREFIX => bytes[at] ^= 1 << (case % 8),
            0 => bytes[at] ^= 1 << random.below(8),
            1 => bytes[at] = random.below(256) as u8,
            2 => bytes[at..at + run].fill(0),
            3 => {
                let other = random.below(length - run);
                let copy = bytes[other..other + run].to_vec();
                bytes[at..at + run].copy_from_slice(&copy);
            }
            _ => bytes[at..at + run].rotate_left(run / 2),
        }
        match kept.read(&bytes) {
            Ok(cached) => {
                assert!(bytes == kept.bytes, "case {case}: a change at {at} was not noticed");
                assert_same(&cached, &kept.session, "nothing was changed");
            }
            Err(_) => refused += 1,
        }
    }
    assert!(refused > 1800, "{refused} refused");
}

/// Does everything with a cache that a session does, and panics where something is not sound.
fn exercise(cached: Cached, opened: &Arc<Scene>, pool: &Arc<ThreadPool>) {
    cached.transport.validate();
    let progress = Progress::default();
    let options = Options { threads: 2, memory: 1 << 30 };
    let mut session = Session::from_cached(cached, options, pool.clone());
    for tile in 0..session.forest().tiles.len() {
        let _ = session.trees(tile, &progress);
    }
    let mut shiny = session.scene().clone();
    shiny.materials.iter_mut().for_each(|material| material.shininess = 3.0);
    let _ = session.edit_without_rays(&Arc::new(shiny));
    let mut deep = session.scene().clone();
    deep.trace.depth += 1;
    let _ = session.edit(deep, &progress);
    let mut fewer = session.scene().clone();
    fewer.lights.remove(0);
    let _ = session.edit(fewer, &progress);
    let mut modelled = session.scene().clone();
    modelled.materials[4].model = Model::Blinn;
    let _ = session.edit(modelled, &progress);
    let mut moved = session.scene().clone();
    moved.lights.iter_mut().for_each(|light| light.place = opened.lights[0].place.clone());
    let _ = session.edit(moved, &progress);
    let _ = session.edit(opened.clone(), &progress);
    session.redraw();
    let _ = session.film();
    let _ = crate::session::cost::cost(&mut session, "trace.depth");
}

#[test]
fn what_is_changed_with_a_right_checksum_is_refused_or_harmless() {
    let kept = kept(true);
    let random = &mut Random(7);
    let parts = kept.header().parts.len();
    let mut outcomes = [0, 0];
    for case in 0..cases(1000) {
        let number = if case % 3 == 0 { random.below(2) } else { random.below(parts) };
        let bytes = kept.with_part(number, |plain| {
            for _ in 0..1 + random.below(3) {
                let at = random.below(plain.len());
                match random.below(4) {
                    0 => plain[at] ^= 1 << random.below(8),
                    1 => plain[at] = random.below(256) as u8,
                    2 => plain[at] = plain[at].wrapping_add(1),
                    _ => {
                        let (from, to) = (at / 4 * 4, (at / 4 * 4 + 4).min(plain.len()));
                        let byte = [0, 0xff, 0x7f][random.below(3)];
                        plain[from..to].fill(byte);
                    }
                }
            }
        });
        let read = kept.read(&bytes);
        outcomes[usize::from(read.is_ok())] += 1;
        if let Ok(cached) = read {
            exercise(cached, &kept.session.scene, &kept.session.pool);
        }
    }
    assert!(outcomes.iter().all(|count| *count > 100), "{outcomes:?} refused and read");
}

#[test]
fn a_header_that_is_changed_with_a_right_checksum_is_refused_or_harmless() {
    let kept = kept(true);
    let random = &mut Random(11);
    let header = kept.header().bytes().len();
    for case in 0..cases(500) {
        let mut bytes = kept.bytes.clone();
        for _ in 0..1 + case % 3 {
            let at = PREFIX + random.below(header - PREFIX);
            bytes[at] ^= 1 << random.below(8);
        }
        let checksum = XxHash3_64::oneshot(&bytes[PREFIX..header]);
        bytes[PREFIX - 8..PREFIX].copy_from_slice(&checksum.to_le_bytes());
        if let Ok(cached) = kept.read(&bytes) {
            assert!(cached.scene == *kept.session.scene);
            exercise(cached, &kept.session.scene, &kept.session.pool);
        }
    }
}
