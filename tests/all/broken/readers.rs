//! Every reader of files, with whole files to begin with and what it promises about broken ones.

use std::fmt::Display;
use std::path::Path;
use std::sync::OnceLock;

use rayforest::import;
use rayforest::progress::Progress;
use rayforest::scene::read::{Known, text_with};
use rayforest::scene::{Scene, mesh, read, texture, write};
use rayforest::session::still::Still;
use rayforest::session::{Options, Session, cache, part};

/// A reader, and how it is tried.
pub(super) struct Reader {
    pub(super) name: &'static str,
    /// How the broken file is called.
    pub(super) file: &'static str,
    /// Which file is opened: the broken one, or one that names it.
    pub(super) opened: &'static str,
    /// Whole files.
    pub(super) samples: fn() -> Vec<Vec<u8>>,
    /// Whole files that stand beside it.
    pub(super) beside: &'static [(&'static str, &'static [u8])],
    /// Repairs checksums, so that what is behind them is read.
    pub(super) seal: fn(&mut [u8]),
    /// Whether the file was read; panics if a promise is not kept.
    pub(super) read: fn(&Path) -> bool,
    /// Broken files to try in a short run.
    pub(super) cases: usize,
    /// Whether some of them must be read: not where nearly every byte has a checksum.
    pub(super) reads_some: bool,
}

macro_rules! bytes {
    ($name:literal) => {
        include_bytes!(concat!("../../../", $name)) as &[u8]
    };
}

const PLAIN: Reader = Reader {
    name: "",
    file: "",
    opened: "",
    samples: Vec::new,
    beside: &[],
    seal: |_| {},
    read: |_| true,
    cases: 1000,
    reads_some: true,
};

/// All readers.
pub(super) const READERS: &[Reader] = &[
    Reader {
        name: "scene",
        file: "a.toml",
        opened: "a.toml",
        samples: scenes,
        read: scene,
        cases: 1500,
        ..PLAIN
    },
    Reader {
        name: "mesh",
        file: "a.obj",
        opened: "a.obj",
        samples: objs,
        read: |path| promised(path, mesh::read_obj(path).map(drop)),
        cases: 2000,
        ..PLAIN
    },
    Reader {
        name: "obj",
        file: "a.obj",
        opened: "a.obj",
        samples: objs,
        beside: &[("assimp_scene.mtl", bytes!("tests/imports/assimp_scene.mtl"))],
        read: imported,
        cases: 1500,
        ..PLAIN
    },
    Reader {
        name: "mtl",
        file: "assimp_scene.mtl",
        opened: "a.obj",
        samples: || {
            vec![
                bytes!("tests/imports/assimp_scene.mtl").to_vec(),
                bytes!("tests/imports/trimesh_box.mtl").to_vec(),
                b"newmtl tiles\nKd 1 0 0\nmap_Kd -s 2 2 2 -clamp on globe.png\nTr 0.2\nd 0.3\nbump -bm 2 globe.png\nillum 7\n"
                    .to_vec(),
            ]
        },
        beside: &[
            ("a.obj", bytes!("tests/imports/assimp_scene.obj")),
            ("globe.png", bytes!("assets/globe.png")),
        ],
        read: imported,
        ..PLAIN
    },
    Reader {
        name: "gltf",
        file: "a.gltf",
        opened: "a.gltf",
        samples: || vec![bytes!("tests/imports/assimp_scene.gltf").to_vec()],
        beside: &[("assimp_scene.bin", bytes!("tests/imports/assimp_scene.bin"))],
        read: imported,
        cases: 2000,
        ..PLAIN
    },
    Reader {
        name: "gltf buffer",
        file: "assimp_scene.bin",
        opened: "a.gltf",
        samples: || vec![bytes!("tests/imports/assimp_scene.bin").to_vec()],
        beside: &[("a.gltf", bytes!("tests/imports/assimp_scene.gltf"))],
        read: imported,
        cases: 500,
        ..PLAIN
    },
    Reader {
        name: "glb",
        file: "a.glb",
        opened: "a.glb",
        samples: || {
            vec![
                bytes!("tests/imports/trimesh_two.glb").to_vec(),
                bytes!("tests/imports/gltfpack_two.glb").to_vec(),
            ]
        },
        read: imported,
        cases: 2000,
        ..PLAIN
    },
    Reader {
        name: "nff",
        file: "a.nff",
        opened: "a.nff",
        samples: || {
            vec![
                bytes!("tests/imports/spd_tetra.nff").to_vec(),
                bytes!("tests/imports/spd_balls.nff").to_vec(),
                b"v\nfrom 2 1 3\nat 0 0 0\nup 0 0 1\nangle 45\nhither 0\nresolution 8 8\nb 0.1 0.2 0.3\nl 4 3 2 1 1 1\nf 1 0.9 0.7 0.5 0.5 30 0.2 1.5\nc\n0 0 0 1\n0 0 1 0.5\npp 3\n0 0 0 0 0 1\n1 0 0 0 0 1\n0 1 0 0 0 1\np 3\n0 0 0\n1 0 0\n0 1 0\n".to_vec(),
            ]
        },
        read: imported,
        ..PLAIN
    },
    Reader {
        name: "image",
        file: "a.png",
        opened: "a.png",
        samples: images,
        read: |path| promised(path, texture::read(path).map(drop)),
        ..PLAIN
    },
    Reader {
        name: "part",
        file: "a.part",
        opened: "a.part",
        samples: || vec![whole_part()],
        seal,
        read: |path| promised(path, part::merge(&[path.to_owned()]).map(drop)),
        ..PLAIN
    },
    Reader {
        name: "cache",
        file: "a.rayforest-cache",
        opened: "a.rayforest-cache",
        samples: || vec![kept().1.clone()],
        seal,
        read: cached,
        cases: 500,
        reads_some: false,
        ..PLAIN
    },
];

/// Whether a file was read. An error names the file, says in one line what is wrong, and in another
/// one what to do.
fn promised<E: Display>(path: &Path, found: Result<(), E>) -> bool {
    let Err(error) = found else { return true };
    let text = error.to_string();
    let folder = path.parent().expect("a folder").to_string_lossy().into_owned();
    assert!(text.starts_with(&folder), "no file is named: {text}");
    let (_, help) = text.split_once("\n  help: ").unwrap_or_else(|| panic!("no way out: {text}"));
    assert!(!help.trim().is_empty(), "no way out: {text}");
    let cause = text[folder.len()..].split_once(": ").map_or("", |(_, cause)| cause);
    assert!(!cause.trim().is_empty() && !cause.starts_with('\n'), "no cause: {text}");
    false
}

/// A scene that was read is written as text that is the same scene.
fn same_again(scene: &Scene) {
    let text = write::text(scene);
    let back = text_with(&text, Path::new("again.toml"), Known::of(scene));
    let back = back.unwrap_or_else(|error| panic!("it cannot be read again: {error}\n{text}"));
    assert!(back == *scene, "it reads back as another scene:\n{text}");
}

fn scene(path: &Path) -> bool {
    let found = read::file(path);
    if let Ok(scene) = &found {
        same_again(scene);
    } else if let Err(error) = &found {
        assert!(!error.problems.is_empty());
        assert!(error.problems.iter().all(|p| p.place.is_some()), "no place: {error}");
    }
    promised(path, found.map(drop))
}

fn imported(path: &Path) -> bool {
    let target = path.with_file_name("out.toml");
    let found = import::file(path, &target);
    if let Ok(import::Imported { scene, parts: _, notes }) = &found {
        same_again(scene);
        assert!(notes.iter().all(|note| !note.text.is_empty()));
    }
    promised(path, found.map(drop))
}

fn cached(path: &Path) -> bool {
    let (session, _) = kept();
    let progress = Progress::default();
    let found = cache::read(path, session.scene(), session.pool(), 1 << 26, &progress);
    promised(path, found.map(drop))
}

fn scenes() -> Vec<Vec<u8>> {
    let mut all: Vec<Vec<u8>> = vec![
        bytes!("scenes/whitted.toml").to_vec(),
        bytes!("scenes/studio.toml").to_vec(),
        bytes!("scenes/motion.toml").to_vec(),
        bytes!("scenes/csg_part.toml").to_vec(),
        bytes!("tests/pictures/c1_lens.toml").to_vec(),
    ];
    let texts = crate::exact::texts_of_all_kinds();
    all.extend(texts.into_iter().map(String::into_bytes));
    all
}

fn objs() -> Vec<Vec<u8>> {
    let small = "o a\nv 0 0 0 1\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0 0\nvt 1 1\nvn 0 0 1\ns 1\ng b c\nusemtl tiles\nmtllib assimp_scene.mtl\nf 1/1/1 2/2/1 3/3/1 4//1\nf -4 -3 -2\nl 1 2\np 1\n";
    vec![
        bytes!("tests/imports/assimp_scene.obj").to_vec(),
        bytes!("tests/imports/meshio_cube.obj").to_vec(),
        small.as_bytes().to_vec(),
    ]
}

/// The least of a PNG, a JPEG and a Radiance file.
fn images() -> Vec<Vec<u8>> {
    let mut hdr = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 9\n".to_vec();
    for line in 0..2u8 {
        hdr.extend([2, 2, 0, 9]);
        for channel in 0..4 {
            hdr.extend([128 + 5, 100 + channel + line, 4, 1, 2, 3, 4]);
        }
    }
    vec![bytes!("assets/globe.png").to_vec(), bytes!("assets/dunes.jpg").to_vec(), hdr]
}

/// Glass, mirrors and a checker in one tile.
fn small() -> Scene {
    let text = std::str::from_utf8(bytes!("scenes/whitted.toml")).expect("text");
    let mut scene = read::text(text, Path::new("whitted.toml")).expect("a scene");
    scene.picture.size = [20, 12];
    scene.trace.samples = 1;
    scene.trace.depth = 3;
    scene
}

/// The only part of a picture.
fn whole_part() -> Vec<u8> {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a.part");
    let (session, _) = kept();
    let (scene, geometry, pool) = (session.scene(), session.geometry(), session.pool());
    let still = Still { scene, geometry, pool, memory: 1 << 28 };
    let share = "1/1".parse().expect("a share");
    part::write(&still, share, &path, &Progress::default()).expect("a part");
    std::fs::read(path).expect("its bytes")
}

/// A session and its cache.
fn kept() -> &'static (Session, Vec<u8>) {
    static KEPT: OnceLock<(Session, Vec<u8>)> = OnceLock::new();
    KEPT.get_or_init(|| {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.rayforest-cache");
        let options = Options { threads: 1, memory: 1 << 28 };
        let session = Session::open(small(), options, &Progress::default()).expect("a session");
        cache::write(&session, &path, true, &Progress::default()).expect("a cache");
        let bytes = std::fs::read(path).expect("its bytes");
        (session, bytes)
    })
}

/// Sets the length and checksum of the header as those files have them: behind 16 bytes, the length
/// of the header and its checksum. Leaves alone what is too short.
fn seal(bytes: &mut [u8]) {
    const PREFIX: usize = 32;
    let Some(length) = bytes.get(16..24).and_then(|l| l.try_into().ok()).map(u64::from_le_bytes)
    else {
        return;
    };
    let end = usize::try_from(length).ok().and_then(|length| PREFIX.checked_add(length));
    let Some(body) = end.and_then(|end| bytes.get(PREFIX..end)) else { return };
    let checksum = twox_hash::XxHash3_64::oneshot(body);
    bytes[24..PREFIX].copy_from_slice(&checksum.to_le_bytes());
}

/// Readers that break one promise each.
pub(super) const BAD: &[Reader] = &[
    Reader { name: "panics", read: |_| panic!("on purpose"), ..BROKEN },
    Reader { name: "silent", read: |path| promised(path, Err("nothing to say")), ..BROKEN },
    Reader {
        name: "hangs",
        read: |_| loop {
            std::thread::sleep(std::time::Duration::from_millis(50));
        },
        ..BROKEN
    },
    Reader {
        name: "hoards",
        read: |path| {
            let claimed = std::hint::black_box(2_000_000_000 + path.as_os_str().len());
            std::hint::black_box(vec![1u8; claimed]).len() > 1
        },
        ..BROKEN
    },
    Reader { name: "reads all", read: |_| true, ..BROKEN },
];

const BROKEN: Reader =
    Reader { file: "a", opened: "a", samples: || vec![b"a 1\nb 2\n".to_vec()], cases: 30, ..PLAIN };
