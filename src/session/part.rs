//! Parts of a huge still: each holds the light of some tiles, traced anywhere, and all together are the picture.
//!
//! ```text
//! magic and format     16 bytes
//! length of the header  8 bytes
//! its checksum          8 bytes
//! header                program, scene, hashes of its meshes, size, exposure, which part
//! tiles                 in rising order, each 12 288 bytes of linear f32 light and a checksum
//! ```

use std::fmt;
use std::fs::File;
use std::io::{BufReader, Read};
use std::path::{Path, PathBuf};
use std::str::FromStr;

use twox_hash::{XxHash3_64, XxHash3_128};

use super::cache::codec::{Section, Source, Unsound};
use super::cache::{file::hashes, program};
use super::still::Still;
use super::trace::{TraceError, TraceReport};
use crate::film::develop::Development;
use crate::film::layout::{LANES, Layout, TILE_BLOCKS};
use crate::film::write::Unfinished;
use crate::film::{Film, FilmBlock};
use crate::math::exposure_factor;
use crate::progress::Progress;
use crate::scene::tone::Tone;
use crate::scene::{MAX_PIXELS, Scene, write};

/// How the file begins; the last byte is the format's version.
const MAGIC: &[u8; 16] = b"RAYFOREST PART \x02";
/// Bytes before the header.
const PREFIX: usize = MAGIC.len() + 16;
/// Bytes of a tile's light.
const TILE_BYTES: usize = TILE_BLOCKS * 3 * LANES * 4;
/// Bytes of a tile in the file, with its checksum.
const STORED_TILE: usize = TILE_BYTES + 8;
/// Tiles that are traced at once: what a cancel or a kill loses at most.
const TILES_AT_ONCE: usize = 1024;

/// Which part of how many, both from 1: `3/8`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Share {
    /// 1 … `of`.
    number: u32,
    of: u32,
}

impl Share {
    /// The tiles of this part, rising: one of every `of` tiles that follow each other, another
    /// one each time, so that each part gets as much of the easy and of the hard as the others. The parts' numbers of tiles differ by at most 1; a part may have none.
    pub fn tiles(self, layout: Layout) -> Vec<usize> {
        let Share { number, of } = self;
        let mine = |tile: usize| {
            let turned = (tile % of as usize) as u64 + turn((tile / of as usize) as u64, of);
            turned % u64::from(of) == u64::from(number - 1)
        };
        let full = layout.tiles() / of as usize * of as usize;
        // What is left over after whole rows is dealt out in order.
        let rest = full + number as usize - 1;
        (0..full).filter(|&t| mine(t)).chain((rest < layout.tiles()).then_some(rest)).collect()
    }
}

/// By how much a row of `of` tiles is turned, 0 … `of` − 1: the golden ratio goes round evenly without
/// ever repeating itself.
fn turn(row: u64, of: u32) -> u64 {
    let share = row.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 32;
    (share * u64::from(of)) >> 32
}

impl FromStr for Share {
    type Err = String;

    fn from_str(text: &str) -> Result<Share, String> {
        let parts = text
            .split_once('/')
            .and_then(|(i, n)| Some([i.trim().parse().ok()?, n.trim().parse().ok()?]));
        match parts {
            Some([number, of]) if 1 <= number && number <= of => Ok(Share { number, of }),
            _ => Err(format!("`{text}` is not a part such as 3/8, from 1/8 to 8/8")),
        }
    }
}

impl fmt::Display for Share {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.number, self.of)
    }
}

/// A part that was not written, or parts that do not make a picture.
#[derive(Clone, Debug, PartialEq)]
pub struct PartError {
    /// The file.
    pub file: PathBuf,
    /// What is wrong, one line.
    pub cause: String,
    /// A way out, one line.
    pub way_out: &'static str,
}

/// What to do about a file that cannot be written.
const WRITE: &str = "check the folder's permissions and the room on its disc";
/// What to do about files that make no picture.
const READ: &str = "give every part of one picture, each as it was written";

impl fmt::Display for PartError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let PartError { file, cause, way_out } = self;
        write!(f, "{}: {cause}\n  help: {way_out}", file.display())
    }
}

impl std::error::Error for PartError {}

/// What a part says about itself.
#[derive(Clone, Debug, PartialEq)]
struct Header {
    picture: Picture,
    share: Share,
}

/// What all parts of one picture have in common.
#[derive(Clone, Debug, PartialEq)]
struct Picture {
    /// What wrote them: bits are the same for the same program.
    program: String,
    /// Of all that the scene is made of, files that it names included.
    hash: u128,
    /// The scene's text.
    scene: String,
    size: [u32; 2],
    exposure: f32,
    tone: Tone,
}

impl Picture {
    fn of(scene: &Scene) -> Picture {
        let text = write::text(scene);
        let mut hasher = XxHash3_128::new();
        hashes(scene).iter().for_each(|hash| hasher.write(&hash.to_le_bytes()));
        hasher.write(text.as_bytes());
        Picture {
            program: program(),
            hash: hasher.finish_128(),
            scene: text,
            size: scene.picture.size,
            exposure: scene.picture.exposure,
            tone: scene.picture.tone,
        }
    }

    /// What differs in another's, in words.
    fn difference(&self, other: &Picture) -> Option<&'static str> {
        let Picture { program, hash, scene, size, exposure, tone } = self;
        let shown_alike = exposure.to_bits() == other.exposure.to_bits() && *tone == other.tone;
        if *program != other.program {
            Some("they come from different versions of the program")
        } else if *size != other.size {
            Some("the pictures have different sizes")
        } else if *scene != other.scene || !shown_alike {
            Some("the scenes differ")
        } else {
            (*hash != other.hash).then_some("a file that the scene names differs")
        }
    }
}

impl Header {
    fn bytes(&self) -> Vec<u8> {
        let Header { picture, share: Share { number, of } } = self;
        let Picture { program, hash, scene, size: [width, height], exposure, tone } = picture;
        let mut section = Section::default();
        section.array(program.as_bytes());
        section.value(*hash);
        section.array(scene.as_bytes());
        section.value(*exposure);
        section.value(*tone as u8);
        [width, height, number, of].into_iter().for_each(|&value| section.value(value));
        let body = section.bytes;
        let mut out = MAGIC.to_vec();
        out.extend((body.len() as u64).to_le_bytes());
        out.extend(XxHash3_64::oneshot(&body).to_le_bytes());
        out.extend(body);
        out
    }

    fn parse(body: &[u8]) -> Result<Header, Unsound> {
        let text = |bytes| String::from_utf8(bytes).map_err(|_| "a text is no text");
        let mut source = Source::new(body);
        let program = text(source.array()?)?;
        let (hash, scene) = (source.value()?, text(source.array()?)?);
        let (exposure, tone) = (source.value()?, source.value::<u8>()?);
        let tone =
            *Tone::ALL.get(usize::from(tone)).ok_or("it holds numbers that no picture has")?;
        let size: [u32; 2] = [source.value()?, source.value()?];
        let share = Share { number: source.value()?, of: source.value()? };
        source.end()?;
        let pixels = Layout::new(size).pixels();
        if pixels == 0 || pixels > MAX_PIXELS || share.number < 1 || share.number > share.of {
            return Err("it holds numbers that no picture has");
        }
        Ok(Header { picture: Picture { program, hash, scene, size, exposure, tone }, share })
    }
}

/// Traces the tiles of a part and writes them; no other tile is traced. What was at `path` before is
/// there until the part is whole.
pub fn write(
    still: &Still,
    share: Share,
    path: &Path,
    progress: &Progress,
) -> Result<TraceReport, PartError> {
    let fail = |cause: String| PartError { file: path.into(), cause, way_out: WRITE };
    let traced = |error: TraceError| fail(format!("not written: {error}"));
    let header = Header { picture: Picture::of(still.scene), share };
    let mut file = Unfinished::begin(path).map_err(|e| fail(e.cause))?;
    file.out().write_all(&header.bytes()).map_err(|e| fail(e.to_string()))?;
    let tiles = share.tiles(Layout::new(still.scene.picture.size));
    progress.begin(tiles.len() as u64);
    let mut report = TraceReport::default();
    for some in tiles.chunks(TILES_AT_ONCE) {
        let (blocks, one) = still.light(some, progress).map_err(traced)?;
        report += one;
        for blocks in blocks.chunks(TILE_BLOCKS) {
            file.out().write_all(&stored(blocks)).map_err(|e| fail(e.to_string()))?;
        }
    }
    file.finish().map_err(|e| fail(e.cause))?;
    Ok(report)
}

/// A tile as it stands in the file.
fn stored(blocks: &[FilmBlock]) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(STORED_TILE);
    let values = blocks.iter().flat_map(|block| block.0.as_flattened());
    values.for_each(|value| bytes.extend(value.to_le_bytes()));
    bytes.extend(XxHash3_64::oneshot(&bytes).to_le_bytes());
    bytes
}

/// The blocks of a tile, unless its checksum is another.
fn restored(bytes: &[u8; STORED_TILE], blocks: &mut [FilmBlock]) -> bool {
    let (light, checksum) = bytes.split_at(TILE_BYTES);
    if XxHash3_64::oneshot(light).to_le_bytes() != *checksum {
        return false;
    }
    let (values, _) = light.as_chunks::<4>();
    let into = blocks.iter_mut().flat_map(|block| block.0.as_flattened_mut());
    into.zip(values).for_each(|(value, bytes)| *value = f32::from_le_bytes(*bytes));
    true
}

/// A part file whose header is sound and whose length is right.
struct Opened {
    path: PathBuf,
    file: BufReader<File>,
    header: Header,
}

impl Opened {
    fn open(path: &Path) -> Result<Opened, PartError> {
        let fail =
            |cause: &str| PartError { file: path.into(), cause: cause.into(), way_out: READ };
        let io = |error: std::io::Error| fail(&error.to_string());
        // Asked first, because opening a pipe waits.
        if !std::fs::metadata(path).map_err(io)?.is_file() {
            return Err(fail("it is no file"));
        }
        let mut file = BufReader::new(File::open(path).map_err(io)?);
        let length = file.get_ref().metadata().map_err(io)?.len();
        let mut prefix = Vec::new();
        Read::by_ref(&mut file).take(PREFIX as u64).read_to_end(&mut prefix).map_err(io)?;
        let Some((magic, rest)) = prefix.split_at_checked(MAGIC.len()) else {
            return Err(fail("this is no part of a picture"));
        };
        let (version, name) = MAGIC.split_last().expect("sixteen bytes");
        if !magic.starts_with(name) {
            return Err(fail("this is no part of a picture"));
        }
        if magic.last() != Some(version) {
            return Err(fail("it has the format of another version of the program"));
        }
        let mut source = Source::new(rest);
        let numbers = source.value::<u64>().and_then(|n| Ok((n, source.value::<u64>()?)));
        let (body_length, checksum) = numbers.map_err(|_| fail("the file was cut"))?;
        if body_length > length - PREFIX as u64 {
            return Err(fail("the file was cut"));
        }
        let mut body = vec![0; body_length as usize];
        file.read_exact(&mut body).map_err(io)?;
        if XxHash3_64::oneshot(&body) != checksum {
            return Err(fail("it is damaged: the header's checksum is another"));
        }
        let header =
            Header::parse(&body).map_err(|what| fail(&format!("it is damaged: {what}")))?;
        let tiles = header.share.tiles(Layout::new(header.picture.size)).len();
        let whole = PREFIX as u64 + body_length + (tiles * STORED_TILE) as u64;
        match length.cmp(&whole) {
            std::cmp::Ordering::Less => Err(fail("the file was cut: trace this part again")),
            std::cmp::Ordering::Greater => Err(fail("something follows its end")),
            std::cmp::Ordering::Equal => Ok(Opened { path: path.into(), file, header }),
        }
    }

    /// Puts its tiles in their places.
    fn read_into(mut self, film: &mut Film) -> Result<(), PartError> {
        let fail = |cause: String| PartError { file: self.path.clone(), cause, way_out: READ };
        let mut bytes = Box::new([0; STORED_TILE]);
        for tile in self.header.share.tiles(film.layout) {
            self.file.read_exact(&mut bytes[..]).map_err(|e| fail(e.to_string()))?;
            let blocks = &mut film.blocks[tile * TILE_BLOCKS..][..TILE_BLOCKS];
            if !restored(&bytes, blocks) {
                let cause = format!("it is damaged: tile {tile}; trace this part again");
                return Err(fail(cause));
            }
        }
        Ok(())
    }
}

/// A picture put together from its parts.
pub struct Merged {
    /// Its light.
    pub film: Film,
    /// The text of its scene.
    pub scene: String,
    /// How it is shown.
    pub development: Development,
}

/// Puts a picture together from all of its parts, in any order.
pub fn merge(paths: &[PathBuf]) -> Result<Merged, PartError> {
    let parts: Vec<Opened> =
        paths.iter().map(|path| Opened::open(path)).collect::<Result<_, _>>()?;
    let first = parts.first().expect("at least one part").header.clone();
    let (first_path, of) = (&paths[0], first.share.of);
    let mut places: Vec<Option<&Path>> = vec![None; parts.len().max(1)];
    for Opened { path, header, .. } in &parts {
        let fail = |cause: String| Err(PartError { file: path.clone(), cause, way_out: READ });
        let other = first_path.display();
        if let Some(what) = first.picture.difference(&header.picture) {
            return fail(format!("it does not belong to {other}: {what}"));
        }
        if header.share.of != of {
            return fail(format!(
                "it is part {}, but {other} is part {}",
                header.share, first.share
            ));
        }
        // With more parts than files some part is missing, which is told below.
        let Some(place) = places.get_mut(header.share.number as usize - 1) else { continue };
        if let Some(before) = place.replace(path) {
            return fail(format!("part {} is given twice: {} too", header.share, before.display()));
        }
    }
    if parts.len() != of as usize {
        let missing = (1..=of).find(|n| !parts.iter().any(|p| p.header.share.number == *n));
        let missing = missing.map_or_else(String::new, |n| format!(": part {n}/{of} is missing"));
        let cause = format!("{} of {of} parts are given{missing}", parts.len());
        return Err(PartError { file: first_path.clone(), cause, way_out: READ });
    }
    let mut film = Film::new(Layout::new(first.picture.size));
    for part in parts {
        part.read_into(&mut film)?;
    }
    let Picture { program: _, hash: _, scene, size: _, exposure, tone } = first.picture;
    Ok(Merged { film, scene, development: Development { gain: exposure_factor(exposure), tone } })
}
