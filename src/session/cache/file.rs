//! The bytes of a cache file: a header with a table of parts, and the parts, compressed one by one.
//!
//! ```text
//! magic and format     16 bytes
//! length of the header  8 bytes
//! its checksum          8 bytes
//! header                program, hashes of meshes, times, table of parts
//! parts                 one after the other to the end of the file, each LZ4 or, where that saves
//!                       little, as it is
//! ```

use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};

use lz4_flex::block;
use twox_hash::{XxHash3_64, XxHash3_128};

use super::codec::{Section, Source, Unsound, record};
use super::error::Fault;
use crate::scene::mesh::Mesh;
use crate::scene::{ImageFile, Scene, Shape};
use crate::session::trace::TraceReport;

/// How the file begins; the last byte is the format's version.
pub(super) const MAGIC: &[u8; 16] = b"RAYFOREST CACHE\x01";
/// The same without the version.
const NAME: &[u8] = MAGIC.split_last().unwrap().1;
/// Bytes before the header.
pub(super) const PREFIX: usize = MAGIC.len() + 16;
/// An array's length in a section takes as much.
const LENGTH: u64 = 8;
/// More arrays than any part has.
const MOST_ARRAYS: u64 = 64;
/// No item takes more than so many times its bytes in a section when it is in memory.
const MOST_PADDING: u64 = 4;
/// A part is compressed if that saves one of so many bytes: angles, of which it saves fewer, would
/// take more time to unpack than to read.
const LEAST_GAIN: usize = 8;
/// LZ4 makes nothing more than this many times smaller.
const MOST_RATIO: u64 = 255;

/// Where a part stands in the table, and its length.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Part {
    /// Bytes in the file; 0 if there is no such part.
    pub(super) stored: u64,
    /// Bytes of the section; as many as `stored` if it is not compressed.
    pub(super) plain: u64,
    /// Bytes of memory that its arrays take.
    pub(super) held: u64,
    /// Of the bytes in the file.
    pub(super) checksum: u64,
}
record!(Part { stored: u64, plain: u64, held: u64, checksum: u64 });

impl Part {
    /// Whether there is one.
    pub(super) fn is_there(&self) -> bool {
        self.stored > 0
    }

    /// Whether its lengths are such as a section has: nothing larger is asked from the system.
    fn is_plausible(&self) -> bool {
        let Part { stored, plain, held, checksum: _ } = *self;
        let packed = stored <= plain && plain <= stored.saturating_mul(MOST_RATIO);
        let room = LENGTH * MOST_ARRAYS;
        packed && plain <= held.saturating_add(room) && held <= plain.saturating_mul(MOST_PADDING)
    }
}

/// Numbers of the parts: the scene, the terms, then per tile its matrix, then per tile its highlight
/// lists, then per tile its trees.
#[derive(Clone, Copy)]
pub(super) struct Numbers {
    /// Tiles of the picture.
    pub(super) tiles: usize,
}

impl Numbers {
    pub(super) const SCENE: usize = 0;
    pub(super) const TERMS: usize = 1;

    pub(super) fn matrix(self, tile: usize) -> usize {
        2 + tile
    }

    pub(super) fn lists(self, tile: usize) -> usize {
        2 + self.tiles + tile
    }

    pub(super) fn trees(self, tile: usize) -> usize {
        2 + 2 * self.tiles + tile
    }

    /// How many there are.
    pub(super) fn count(self) -> usize {
        2 + 3 * self.tiles
    }

    /// In words.
    pub(super) fn name(self, number: usize) -> String {
        match number {
            Self::SCENE => "the scene".into(),
            Self::TERMS => "the terms".into(),
            _ if self.tiles == 0 => format!("part {number}"),
            _ => {
                let (kind, tile) = ((number - 2) / self.tiles, (number - 2) % self.tiles);
                let what = ["the matrix", "the highlights", "the trees"].get(kind);
                format!("{} of tile {tile}", what.unwrap_or(&"a part"))
            }
        }
    }
}

/// What the file says about itself.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Header {
    /// The program that wrote it: [`super::program`].
    pub(super) program: String,
    /// Of the meshes of the scene's solids and of its images, in their order.
    pub(super) meshes: Vec<u128>,
    /// Of the trace that made it.
    pub(super) trace: TraceReport,
    /// By number.
    pub(super) parts: Vec<Part>,
}

impl Header {
    /// The beginning of the file.
    pub(super) fn bytes(&self) -> Vec<u8> {
        let Header { program, meshes, trace, parts } = self;
        let mut section = Section::default();
        section.array(program.as_bytes());
        section.array(meshes);
        section.value(*trace);
        section.array(parts);
        let body = section.bytes;
        let mut out = MAGIC.to_vec();
        out.extend((body.len() as u64).to_le_bytes());
        out.extend(XxHash3_64::oneshot(&body).to_le_bytes());
        out.extend(body);
        out
    }

    /// From a sound body; one that another version of the program wrote is stale, however it looks.
    fn parse(body: &[u8], program: &str) -> Result<Header, Fault> {
        let fault = |what: Unsound| Fault::damaged("the header", what);
        let mut source = Source::new(body);
        let written = String::from_utf8(source.array().map_err(fault)?);
        let written = written.map_err(|_| fault("a name is no text"))?;
        if written != program {
            return Err(Fault::stale(format!("the program was {written}, it is {program}")));
        }
        let header = Header {
            program: written,
            meshes: source.array().map_err(fault)?,
            trace: source.value().map_err(fault)?,
            parts: source.array().map_err(fault)?,
        };
        source.end().map_err(fault)?;
        Ok(header)
    }
}

/// The hash of everything that a mesh holds.
pub(super) fn hash(mesh: &Mesh) -> u128 {
    let Mesh { positions, normals, uvs, triangles, triangle_normals, triangle_uvs } = mesh;
    let mut hasher = XxHash3_128::new();
    for list in [positions, normals] {
        hash_list(&mut hasher, list, |p| p.to_array().map(f64::to_le_bytes).concat());
    }
    hash_list(&mut hasher, uvs, |p| p.to_array().map(f64::to_le_bytes).concat());
    for list in [triangles, triangle_normals, triangle_uvs] {
        hash_list(&mut hasher, list, |t| t.map(u32::to_le_bytes).concat());
    }
    hasher.finish_128()
}

fn hash_list<T, B: AsRef<[u8]>>(hasher: &mut XxHash3_128, list: &[T], bytes: impl Fn(&T) -> B) {
    let mut some = (list.len() as u64).to_le_bytes().to_vec();
    for items in list.chunks(256) {
        items.iter().for_each(|item| some.extend_from_slice(bytes(item).as_ref()));
        hasher.write(&some);
        some.clear();
    }
    hasher.write(&some);
}

/// The hashes of the meshes of a scene's solids, in their order, and of its images; a mesh of several
/// solids is read once.
pub(in crate::session) fn hashes(scene: &Scene) -> Vec<u128> {
    let mut known: Vec<(&Arc<Mesh>, u128)> = Vec::new();
    let mut hashes = Vec::new();
    for solid in &scene.solids {
        let Shape::Mesh { file: _, mesh } = &solid.shape else { continue };
        let before = known.iter().find(|(other, _)| Arc::ptr_eq(other, mesh));
        let found = before.map_or_else(|| hash(mesh), |(_, hash)| *hash);
        if before.is_none() {
            known.push((mesh, found));
        }
        hashes.push(found);
    }
    let image = |file: &ImageFile| {
        let mut hasher = XxHash3_128::new();
        file.image.visit(&mut |bytes| hasher.write(bytes));
        hasher.finish_128()
    };
    hashes.extend(scene.images().map(image));
    hashes
}

/// Compresses a section. Gives what stands in the file, and its place in the table but for the
/// offset.
pub(super) fn pack(section: &Section) -> (Vec<u8>, Part) {
    let (plain, packed) = (&section.bytes, block::compress(&section.bytes));
    let worth = packed.len() < plain.len() - plain.len() / LEAST_GAIN;
    let stored = if worth { packed } else { plain.clone() };
    let part = Part {
        stored: stored.len() as u64,
        plain: section.bytes.len() as u64,
        held: section.held,
        checksum: XxHash3_64::oneshot(&stored),
    };
    (stored, part)
}

/// Memory for reading parts, used again and again.
#[derive(Default)]
pub(super) struct Scratch {
    stored: Vec<u8>,
    plain: Vec<u8>,
}

/// Whether there is a file that is no cache of this program.
pub(super) fn is_foreign(path: &Path) -> Result<bool, Fault> {
    if !path.is_file() {
        return Ok(false);
    }
    let mut begin = Vec::new();
    File::open(path)?.take(NAME.len() as u64).read_to_end(&mut begin)?;
    Ok(begin != NAME)
}

/// A cache file that was opened, its header sound.
pub(super) struct Opened {
    file: Mutex<File>,
    /// What it says about itself.
    pub(super) header: Header,
    /// Where each part begins.
    offsets: Vec<u64>,
    /// Bytes of the whole file.
    pub(super) length: u64,
}

impl Opened {
    /// Opens a file that `program` has written.
    pub(super) fn open(path: &Path, program: &str) -> Result<Opened, Fault> {
        // Asked first, because opening a pipe waits.
        if !std::fs::metadata(path)?.is_file() {
            return Err(Fault::Io { cause: "it is no file".into() });
        }
        let mut file = File::open(path)?;
        let length = file.metadata()?.len();
        let mut prefix = Vec::new();
        Read::by_ref(&mut file).take(PREFIX as u64).read_to_end(&mut prefix)?;
        let (magic, rest) = prefix.split_at(MAGIC.len().min(prefix.len()));
        if !magic.starts_with(NAME) {
            return Err(Fault::Foreign);
        }
        if magic.len() == MAGIC.len() && magic != MAGIC {
            return Err(Fault::stale("it has the format of another version of the program"));
        }
        let fault = |what: Unsound| Fault::damaged("the header", what);
        let mut source = Source::new(rest);
        let body_length: u64 = source.value().map_err(fault)?;
        let checksum: u64 = source.value().map_err(fault)?;
        if body_length > length - PREFIX as u64 {
            return Err(fault("it is longer than the file"));
        }
        let mut body = vec![0; usize::try_from(body_length).map_err(|_| fault("too long"))?];
        file.read_exact(&mut body)?;
        if XxHash3_64::oneshot(&body) != checksum {
            return Err(fault("its checksum is another"));
        }
        let header = Header::parse(&body, program)?;
        let offsets = offsets(&header.parts, PREFIX as u64 + body_length, length)?;
        Ok(Opened { file: Mutex::new(file), header, offsets, length })
    }

    /// Reads a part, which is there, and gives its section to `take`, which must read all of it.
    pub(super) fn part<T>(
        &self,
        number: usize,
        scratch: &mut Scratch,
        take: impl FnOnce(&mut Source) -> Result<T, Unsound>,
    ) -> Result<T, Fault> {
        let tiles = self.header.parts.len().saturating_sub(2) / 3;
        let fault = |what: Unsound| Fault::damaged(Numbers { tiles }.name(number), what);
        let part = *self.header.parts.get(number).ok_or_else(|| fault("there is none"))?;
        if !part.is_there() {
            return Err(fault("there is none"));
        }
        let Scratch { stored, plain } = scratch;
        self.read(self.offsets[number], part.stored as usize, stored)?;
        if XxHash3_64::oneshot(stored) != part.checksum {
            return Err(fault("its checksum is another"));
        }
        let section = if part.stored == part.plain {
            &*stored
        } else {
            plain.resize(part.plain as usize, 0);
            let length = block::decompress_into(stored, plain);
            if length.ok() != Some(plain.len()) {
                return Err(fault("it cannot be decompressed"));
            }
            &*plain
        };
        let mut source = Source::new(section);
        let value = take(&mut source).map_err(fault)?;
        if source.held != part.held {
            return Err(fault("it takes other memory than it says"));
        }
        source.end().map_err(fault)?;
        Ok(value)
    }

    fn read(&self, offset: u64, length: usize, into: &mut Vec<u8>) -> Result<(), Fault> {
        into.resize(length, 0);
        // Whoever panicked here left no half-read value behind: every reader seeks first.
        let mut file = self.file.lock().unwrap_or_else(PoisonError::into_inner);
        file.seek(SeekFrom::Start(offset))?;
        file.read_exact(into)?;
        Ok(())
    }
}

/// Where parts begin that stand one after the other from `first` to the end of the file. Their
/// lengths are found plausible.
fn offsets(parts: &[Part], first: u64, length: u64) -> Result<Vec<u64>, Fault> {
    if !parts.iter().all(Part::is_plausible) {
        return Err(Fault::damaged("the header", "a part has a length that none has"));
    }
    let mut offsets = Vec::with_capacity(parts.len());
    let mut end = Some(first);
    for part in parts {
        offsets.push(end.unwrap_or(u64::MAX));
        end = end.and_then(|end| end.checked_add(part.stored));
    }
    match end {
        Some(end) if end == length => Ok(offsets),
        Some(end) if end < length => Err(Fault::damaged("the end", "something follows it")),
        _ => Err(Fault::damaged("the end", "the file was cut")),
    }
}
