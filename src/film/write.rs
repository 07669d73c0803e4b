//! Picture files: PNG with 8 or 16 bits as shown, OpenEXR and Radiance with linear light; written whole or not at all.

use std::fmt;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

use super::develop::{self, Development, code8, code16};
use super::hdr::hdr;
use super::plates::Plates;
use super::{Film, Frame};
use crate::color::Rgb;

/// A picture format and its depth.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// PNG, 8 bits, sRGB.
    Png8,
    /// PNG, 16 bits, sRGB.
    Png16,
    /// OpenEXR, 32-bit linear floats, before exposure.
    Exr,
    /// Radiance, linear light before exposure, 8 bits per channel and an exponent per pixel.
    Hdr,
}

impl Format {
    /// Whether a file of it says how much of a pixel is covered.
    pub fn holds_alpha(self) -> bool {
        self != Format::Hdr
    }

    /// The format that a file's name asks for; `deep` chooses 16 bits for PNG.
    pub fn of(path: &Path, deep: bool) -> Result<Format, WriteError> {
        let ending = path.extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase);
        match ending.as_deref() {
            Some("png") if deep => Ok(Format::Png16),
            Some("png") => Ok(Format::Png8),
            Some("exr") => Ok(Format::Exr),
            Some("hdr") => Ok(Format::Hdr),
            _ => Err(WriteError {
                path: path.into(),
                cause: "the name must end in .png, .exr or .hdr".into(),
            }),
        }
    }
}

/// A picture that could not be written; what was at the path before is untouched.
#[derive(Debug)]
pub struct WriteError {
    /// Where it was to be.
    pub path: PathBuf,
    /// What the system says.
    pub cause: String,
}

impl fmt::Display for WriteError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "cannot write {}: {}", self.path.display(), self.cause)
    }
}

impl std::error::Error for WriteError {}

/// Writes a picture. `scene` is the text of the scene it shows and is kept inside the file, so that
/// equal scenes give equal bytes: no time and no history is stored.
pub fn picture(
    path: &Path,
    format: Format,
    plates: &Plates,
    development: Development,
    scene: &str,
) -> Result<(), WriteError> {
    let Plates { film, coverage, layers: _ } = plates;
    atomically(path, |out| match (format, coverage) {
        (Format::Png8, None) => png8(out, &develop::frame(film, development), scene),
        (Format::Png8, Some(_)) => png_of(out, png::BitDepth::Eight, plates, development, scene),
        (Format::Png16, _) => png_of(out, png::BitDepth::Sixteen, plates, development, scene),
        (Format::Exr, _) => exr_floats(out, plates, scene),
        (Format::Hdr, _) => hdr(out, film, scene),
    })
}

/// Writes a picture of bytes as PNG.
pub fn frame(path: &Path, frame: &Frame) -> Result<(), WriteError> {
    atomically(path, |out| png8(out, frame, ""))
}

/// Writes a file beside its place and renames it: a reader sees the old file or the new one, and a
/// process killed while writing leaves the old one.
pub fn atomically(
    path: &Path,
    write: impl FnOnce(&mut dyn WriteSeek) -> Result<(), String>,
) -> Result<(), WriteError> {
    let mut file = Unfinished::begin(path)?;
    write(file.out()).map_err(|cause| WriteError { path: path.into(), cause })?;
    file.finish()
}

/// A file in the making: what is in its place stays until it is finished. Dropped before that, it
/// leaves nothing behind.
pub struct Unfinished {
    path: PathBuf,
    out: BufWriter<tempfile::NamedTempFile>,
}

impl Unfinished {
    /// Begins a file that will be at `path`.
    pub fn begin(path: &Path) -> Result<Unfinished, WriteError> {
        Ok(Unfinished { path: path.into(), out: BufWriter::new(beside(path)?) })
    }

    /// Where its bytes go.
    pub fn out(&mut self) -> &mut dyn WriteSeek {
        &mut self.out
    }

    /// Puts it in its place.
    pub fn finish(self) -> Result<(), WriteError> {
        let Unfinished { path, out } = self;
        let fail = |cause: String| WriteError { path: path.clone(), cause };
        let file = out.into_inner().map_err(|e| fail(e.to_string()))?;
        file.persist(&path).map_err(|e| fail(e.error.to_string()))?;
        Ok(())
    }
}

/// [`atomically`] for what nobody can compute again: it is on the disc before it replaces the file
/// before it, and from its first byte has `permissions`, if they are given.
pub fn durably(
    path: &Path,
    permissions: Option<std::fs::Permissions>,
    bytes: &[u8],
) -> Result<(), WriteError> {
    let fail = |error: std::io::Error| WriteError { path: path.into(), cause: error.to_string() };
    let mut file = beside(path)?;
    if let Some(permissions) = permissions {
        file.as_file().set_permissions(permissions).map_err(fail)?;
    }
    file.write_all(bytes).map_err(fail)?;
    file.as_file().sync_all().map_err(fail)?;
    file.persist(path).map_err(|e| fail(e.error))?;
    Ok(())
}

/// Whether a file can be written there: asked before a long job, so that its result is not lost.
pub fn check_writable(path: &Path) -> Result<(), WriteError> {
    beside(path).map(drop)
}

/// A file of no lasting name in the folder of `path`; it is removed unless it is renamed.
fn beside(path: &Path) -> Result<tempfile::NamedTempFile, WriteError> {
    let fail = |cause: String| WriteError { path: path.into(), cause };
    let folder = match path.parent() {
        Some(p) if !p.as_os_str().is_empty() => p,
        _ => Path::new("."),
    };
    if path.is_dir() {
        return Err(fail("it is a folder".into()));
    }
    if !folder.is_dir() {
        return Err(fail(format!("there is no folder {}", folder.display())));
    }
    let mut builder = tempfile::Builder::new();
    builder.prefix(".rayforest-").suffix(".part");
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    builder.tempfile_in(folder).map_err(|e| fail(format!("{} ({})", e.kind(), folder.display())))
}

/// Where picture bytes go.
pub trait WriteSeek: Write + std::io::Seek {}
impl<T: Write + std::io::Seek> WriteSeek for T {}

/// Keyword of the text in a PNG.
pub(super) const SCENE_KEY: &str = "rayforest scene";

fn png8(out: &mut dyn WriteSeek, frame: &Frame, scene: &str) -> Result<(), String> {
    let rgb: Vec<u8> = frame.bytes.chunks_exact(4).flat_map(|p| [p[0], p[1], p[2]]).collect();
    png_file(out, frame.size, (png::BitDepth::Eight, false), &rgb, scene)
}

/// Of samples of `depth`, with alpha if it is known. Colours are not multiplied by it: PNG says so.
fn png_of(
    out: &mut dyn WriteSeek,
    depth: png::BitDepth,
    plates: &Plates,
    development: Development,
    scene: &str,
) -> Result<(), String> {
    let size = plates.film.layout.size;
    let has_alpha = plates.coverage.is_some();
    let mut data = Vec::with_capacity(size[0] as usize * size[1] as usize * 8);
    for pixel in pixels(size) {
        let (light, alpha) = uncovered(plates, pixel);
        let alpha = has_alpha.then_some(alpha);
        if depth == png::BitDepth::Eight {
            data.extend(code8(light, development));
            data.extend(alpha.map(|alpha| (alpha * 255.0).round() as u8));
        } else {
            let alpha = alpha.map(|alpha| (alpha * 65_535.0).round() as u16);
            let samples = code16(light, development).into_iter().chain(alpha);
            data.extend(samples.flat_map(u16::to_be_bytes));
        }
    }
    png_file(out, size, (depth, has_alpha), &data, scene)
}

/// The pixels of a picture, row by row.
pub(super) fn pixels([width, height]: [u32; 2]) -> impl Iterator<Item = [u32; 2]> {
    (0..height).flat_map(move |y| (0..width).map(move |x| [x, y]))
}

/// The light of what covers a pixel, and how much of it is covered.
fn uncovered(plates: &Plates, pixel: [u32; 2]) -> (Rgb, f32) {
    let (light, alpha) = (plates.film.pixel(pixel), plates.alpha(pixel));
    let whole = if plates.coverage.is_some() && alpha > 0.0 { 1.0 / alpha } else { 1.0 };
    (light.map(|channel| channel * whole), alpha)
}

fn png_file(
    out: &mut dyn WriteSeek,
    size: [u32; 2],
    (depth, has_alpha): (png::BitDepth, bool),
    data: &[u8],
    scene: &str,
) -> Result<(), String> {
    let text = |e: png::EncodingError| e.to_string();
    let mut encoder = png::Encoder::new(out, size[0], size[1]);
    encoder.set_color(if has_alpha { png::ColorType::Rgba } else { png::ColorType::Rgb });
    encoder.set_depth(depth);
    encoder.set_source_srgb(png::SrgbRenderingIntent::RelativeColorimetric);
    encoder.add_itxt_chunk(SCENE_KEY.into(), scene.into()).map_err(text)?;
    let mut writer = encoder.write_header().map_err(text)?;
    writer.write_image_data(data).map_err(text)?;
    writer.finish().map_err(text)
}

/// Channels `R`, `G`, `B`, `A` of the picture, multiplied by alpha as EXR has it, and those of every
/// layer behind its name.
fn exr_floats(out: &mut dyn WriteSeek, plates: &Plates, scene: &str) -> Result<(), String> {
    use exr::prelude::{AnyChannel, AnyChannels, FlatSamples, Image, Text, WritableImage};
    let [width, height] = plates.film.layout.size;
    let mut channels = Vec::new();
    let mut add = |name: &str, film: &Film, channel: usize| {
        let values = pixels([width, height]).map(|pixel| film.pixel(pixel).0[channel]);
        channels.push(AnyChannel::new(name, FlatSamples::F32(values.collect())));
    };
    for (i, name) in ["R", "G", "B"].into_iter().enumerate() {
        add(name, &plates.film, i);
        for layer in &plates.layers {
            add(&format!("{}.{name}", layer.name), &layer.film, i);
        }
    }
    if plates.coverage.is_some() {
        let alpha = pixels([width, height]).map(|pixel| plates.alpha(pixel));
        channels.push(AnyChannel::new("A", FlatSamples::F32(alpha.collect())));
    }
    let channels = AnyChannels::sort(channels.into());
    let mut image = Image::from_channels((width as usize, height as usize), channels);
    // The attribute is bytes; readers show them as UTF-8.
    image.layer_data.attributes.comments = Some(Text::from_slice_unchecked(scene.as_bytes()));
    image.write().non_parallel().to_buffered(out).map_err(|e| e.to_string())
}

#[cfg(test)]
mod tests {
    use super::super::layout::Layout;
    use super::*;
    use crate::scene::tone::Tone;

    fn film() -> Film {
        let mut film = Film::new(Layout::new([9, 5]));
        for (i, block) in film.blocks.iter_mut().enumerate() {
            for (lane, value) in block.0[0].iter_mut().enumerate() {
                *value = (i * 16 + lane) as f32 / 400.0;
            }
            block.0[2] = [0.25; 16];
        }
        film
    }

    /// Half a stop brighter.
    fn development() -> Development {
        Development { gain: crate::math::exposure_factor(0.5), tone: Tone::Neutral }
    }

    #[test]
    fn equal_pictures_give_equal_files_and_the_scene_is_inside() {
        let folder = tempfile::tempdir().unwrap();
        for (name, deep) in [("a.png", false), ("b.png", true), ("c.exr", false)] {
            let path = folder.path().join(name);
            let write = || {
                let format = Format::of(&path, deep).unwrap();
                picture(&path, format, &Plates::of(film()), development(), "version = 1 # µ")
                    .unwrap();
                std::fs::read(&path).unwrap()
            };
            let first = write();
            assert_eq!(first, write(), "{name}");
            let text = "version = 1 # µ".as_bytes();
            assert!(first.windows(text.len()).any(|w| w == text), "{name} lacks the scene");
        }
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 3, "left-over files");
    }

    #[test]
    fn png_holds_the_developed_pixels() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        picture(&path, Format::Png8, &Plates::of(film()), development(), "").unwrap();
        let file = std::io::BufReader::new(std::fs::File::open(&path).unwrap());
        let mut reader = png::Decoder::new(file).read_info().unwrap();
        let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut bytes).unwrap();
        let frame = develop::frame(&film(), development());
        let rgb: Vec<u8> = frame.bytes.chunks(4).flat_map(|p| p[..3].to_vec()).collect();
        assert_eq!(bytes, rgb);
    }

    #[test]
    fn a_failed_write_leaves_the_old_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("old.png");
        std::fs::write(&path, "old").unwrap();
        let error = atomically(&path, |_| Err("disc full".into())).unwrap_err();
        assert!(error.to_string().ends_with("old.png: disc full"), "{error}");
        assert_eq!(std::fs::read(&path).unwrap(), b"old");
        let missing = folder.path().join("no/such/folder.png");
        assert!(picture(&missing, Format::Png8, &Plates::of(film()), development(), "").is_err());
        assert!(Format::of(Path::new("a.jpg"), false).is_err());
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1, "left-over files");
    }
}
