//! Pictures that surfaces, bumps and backgrounds read: texels, and ever coarser copies of them.

use std::fmt;
use std::io::Cursor;
use std::path::{Path, PathBuf};

use image::{DynamicImage, ImageFormat, ImageReader, Limits};
use zune_jpeg::JpegDecoder;
use zune_jpeg::zune_core::bytestream::ZCursor;
use zune_jpeg::zune_core::colorspace::ColorSpace;
use zune_jpeg::zune_core::options::DecoderOptions;

use crate::color::{linear_of_srgb, srgb_byte};

/// Longest side of an image file, in texels.
pub const MAX_IMAGE_SIDE: u32 = 32_768;
/// Largest number of texels of an image file: 256 MiB of bytes with its coarser copies.
pub const MAX_TEXELS: u64 = 1 << 26;
/// Largest value of a texel, as of a coefficient of a scene.
const BRIGHTEST: f32 = 1e6;

/// A picture in linear Rec. 709, row 0 at its top, with copies of half the size down to one texel.
///
/// # Invariants
/// Every level has `width · height` texels, and each next one half as many columns and rows, rounded
/// up. Texels are finite and ≥ 0. Pictures of 8 bits stay 8 bits: a coarser copy is averaged in linear
/// light and rounded to sRGB bytes, half a code value per level at most.
#[derive(Clone, PartialEq)]
pub struct Image {
    levels: Vec<Level>,
    /// Linear light of every sRGB byte.
    decode: Box<[f32; 256]>,
}

#[derive(Clone, PartialEq)]
struct Level {
    size: [u32; 2],
    texels: Texels,
}

#[derive(Clone, PartialEq)]
enum Texels {
    /// sRGB bytes.
    Bytes(Vec<[u8; 3]>),
    /// Linear light.
    Floats(Vec<[f32; 3]>),
}

/// No texel is NaN, so equality is reflexive. With it two `Arc`s of one image compare by address.
impl Eq for Image {}

/// Short: a scene is printed to be compared.
impl fmt::Debug for Image {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [width, height] = self.size();
        write!(f, "Image({width} × {height})")
    }
}

/// A grey texel: what stands where no file was read yet.
impl Default for Image {
    fn default() -> Image {
        Image::of_bytes([1, 1], vec![[188; 3]])
    }
}

impl Image {
    /// An image of sRGB bytes, rows from the top.
    ///
    /// # Panics
    /// If there are not `width · height` texels, or none.
    pub fn of_bytes(size: [u32; 2], texels: Vec<[u8; 3]>) -> Image {
        Image::new(size, Texels::Bytes(texels))
    }

    /// An image of linear light, rows from the top; what is no number or below 0 becomes 0.
    ///
    /// # Panics
    /// As [`Image::of_bytes`].
    pub fn of_floats(size: [u32; 2], mut texels: Vec<[f32; 3]>) -> Image {
        for value in texels.as_flattened_mut() {
            *value = if *value > 0.0 { value.min(BRIGHTEST) } else { 0.0 };
        }
        Image::new(size, Texels::Floats(texels))
    }

    fn new(size: [u32; 2], texels: Texels) -> Image {
        let count = match &texels {
            Texels::Bytes(texels) => texels.len(),
            Texels::Floats(texels) => texels.len(),
        };
        assert!(count > 0 && count as u64 == size.map(u64::from).iter().product::<u64>(), "texels");
        let decode = Box::new(std::array::from_fn(|code| linear_of_srgb(code as f64 / 255.0)));
        let mut image = Image { levels: vec![Level { size, texels }], decode };
        while let Some(next) = image.coarser() {
            image.levels.push(next);
        }
        image
    }

    /// Width and height of the finest level.
    pub fn size(&self) -> [u32; 2] {
        self.levels[0].size
    }

    /// How many levels there are: 1 for a single texel.
    pub fn levels(&self) -> usize {
        self.levels.len()
    }

    /// Width and height of a level; the coarsest for every level beyond.
    #[inline(always)]
    pub fn size_of(&self, level: usize) -> [u32; 2] {
        self.level(level).size
    }

    /// A texel in linear light, x from the left, y from the top.
    ///
    /// # Panics
    /// If it is outside of the level.
    #[inline(always)]
    pub fn texel(&self, level: usize, [x, y]: [u32; 2]) -> [f32; 3] {
        let level = self.level(level);
        let at = y as usize * level.size[0] as usize + x as usize;
        match &level.texels {
            Texels::Bytes(texels) => texels[at].map(|code| self.decode[usize::from(code)]),
            Texels::Floats(texels) => texels[at],
        }
    }

    fn level(&self, level: usize) -> &Level {
        &self.levels[level.min(self.levels.len() - 1)]
    }

    /// Memory held, in bytes.
    pub fn bytes(&self) -> usize {
        let of = |level: &Level| match &level.texels {
            Texels::Bytes(texels) => size_of_val(&**texels),
            Texels::Floats(texels) => size_of_val(&**texels),
        };
        self.levels.iter().map(of).sum::<usize>() + size_of_val(&*self.decode)
    }

    /// Calls `each` with the size and the bits of every texel of the finest level, for checksums.
    pub fn visit(&self, each: &mut dyn FnMut(&[u8])) {
        let Level { size, texels } = &self.levels[0];
        size.iter().for_each(|side| each(&side.to_le_bytes()));
        match texels {
            Texels::Bytes(texels) => each(texels.as_flattened()),
            Texels::Floats(texels) => {
                for row in texels.chunks(size[0] as usize) {
                    let bits = row.as_flattened().iter().flat_map(|x| x.to_le_bytes());
                    each(&bits.collect::<Vec<u8>>());
                }
            }
        }
    }

    /// A copy of the coarsest level at half its size; `None` of a single texel.
    fn coarser(&self) -> Option<Level> {
        let fine = self.levels.len() - 1;
        let size @ [width, height] = self.size_of(fine);
        let [columns, rows] = size.map(|side| side.div_ceil(2));
        if size == [1, 1] {
            return None;
        }
        let (across, down) = (shares(width, columns), shares(height, rows));
        let mut light = Vec::with_capacity((columns * rows) as usize);
        for row in &down {
            light.extend(across.iter().map(|column| self.mean(fine, column, row)));
        }
        let texels = match &self.levels[fine].texels {
            Texels::Bytes(_) => {
                Texels::Bytes(light.into_iter().map(|l| l.map(|x| srgb_byte(x as f32))).collect())
            }
            Texels::Floats(_) => {
                Texels::Floats(light.into_iter().map(|l| l.map(|x| x as f32)).collect())
            }
        };
        Some(Level { size: [columns, rows], texels })
    }

    /// The mean over a rectangle of texels, each with its shares.
    fn mean(&self, level: usize, column: &Share, row: &Share) -> [f64; 3] {
        let mut sum = [0.0; 3];
        for (y, down) in row.iter() {
            for (x, across) in column.iter() {
                let texel = self.texel(level, [x, y]);
                sum = std::array::from_fn(|c| sum[c] + f64::from(texel[c]) * (across * down));
            }
        }
        sum
    }
}

/// What a texel of the coarser level takes of neighbouring finer ones: the first, and up to three
/// shares of 1.
struct Share {
    first: u32,
    shares: [f64; 3],
}

impl Share {
    fn iter(&self) -> impl Iterator<Item = (u32, f64)> {
        (self.first..).zip(self.shares).filter(|(_, share)| *share > 0.0)
    }
}

/// By length: coarser texel i covers [i, i + 1)·fine/coarse.
fn shares(fine: u32, coarse: u32) -> Vec<Share> {
    let step = f64::from(fine) / f64::from(coarse);
    let of = |i: u32| {
        let (from, to) = (f64::from(i) * step, f64::from(i + 1) * step);
        let first = (from.floor() as u32).min(fine - 1);
        let mut shares = [0.0; 3];
        for (share, at) in shares.iter_mut().zip(first..fine) {
            let (low, high) = (f64::from(at), f64::from(at + 1));
            *share = (to.min(high) - from.max(low)).max(0.0) / step;
        }
        Share { first, shares }
    };
    (0..coarse).map(of).collect()
}

/// Why an image file cannot be used.
#[derive(Clone, Debug, PartialEq)]
pub struct ImageError {
    /// The image file.
    pub file: PathBuf,
    /// What is wrong, one line.
    pub cause: String,
    /// A way out, one line.
    pub way_out: String,
}

impl ImageError {
    /// `FILE: cause`, without the way out.
    pub fn what(&self) -> String {
        format!("{}: {}", self.file.display(), self.cause)
    }
}

impl fmt::Display for ImageError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}\n  help: {}", self.what(), self.way_out)
    }
}

impl std::error::Error for ImageError {}

/// Reads a PNG, JPEG or Radiance HDR file, told apart by their first bytes. Transparency is ignored.
///
/// 8 bits are sRGB; so are 16, which are kept as linear floats; HDR is linear.
pub fn read(path: &Path) -> Result<Image, ImageError> {
    let fail = |cause: String, way_out: &str| ImageError {
        file: path.to_owned(),
        cause,
        way_out: way_out.to_owned(),
    };
    let bytes = std::fs::read(path).map_err(|error| {
        let way_out = "check the name; it is relative to the scene file";
        fail(format!("cannot be read: {error}"), way_out)
    })?;
    of_bytes(&bytes).map_err(|cause| fail(cause, "export it again as PNG, JPEG or HDR"))
}

/// The image in the bytes of a PNG, JPEG or Radiance HDR file, or what is wrong with them.
pub(crate) fn of_bytes(bytes: &[u8]) -> Result<Image, String> {
    match image::guess_format(bytes) {
        Ok(ImageFormat::Jpeg) => jpeg(bytes),
        Ok(format @ (ImageFormat::Png | ImageFormat::Hdr)) => other(bytes, format),
        _ => Err("this is no PNG, JPEG or HDR file".to_owned()),
    }
}

/// Refuses what is too large before memory is taken for it.
fn sized(width: u64, height: u64) -> Result<(), String> {
    let side = u64::from(MAX_IMAGE_SIDE);
    if width > side || height > side || width * height > MAX_TEXELS {
        return Err(format!(
            "{width} × {height} texels are too many: at most {MAX_TEXELS}, and {side} on a side"
        ));
    }
    if width * height == 0 { Err("it has no texels".to_owned()) } else { Ok(()) }
}

/// Whether a JPEG file has an end behind its last scan: the decoder fills up with grey what was cut off.
fn has_end(bytes: &[u8]) -> bool {
    let last = |marker: [u8; 2]| bytes.windows(2).rposition(|pair| pair == marker);
    last([0xff, 0xda]).is_none_or(|scan| last([0xff, 0xd9]).is_some_and(|end| end > scan))
}

fn jpeg(bytes: &[u8]) -> Result<Image, String> {
    if !has_end(bytes) {
        return Err("the file was cut off".to_owned());
    }
    // Without SIMD: its rounding must be the same on every CPU.
    let options = DecoderOptions::new_safe().jpeg_set_out_colorspace(ColorSpace::RGB);
    let side = MAX_IMAGE_SIDE as usize;
    let options = options.set_max_width(side).set_max_height(side);
    let mut decoder = JpegDecoder::new_with_options(ZCursor::new(bytes), options);
    decoder.decode_headers().map_err(|error| error.to_string())?;
    let (width, height) = decoder.dimensions().ok_or("its size is missing")?;
    sized(width as u64, height as u64)?;
    let plain = decoder.decode().map_err(|error| error.to_string())?;
    let texels: Vec<[u8; 3]> = plain.as_chunks::<3>().0.to_vec();
    if texels.len() != width * height {
        return Err("its channels are not red, green and blue".to_owned());
    }
    Ok(Image::of_bytes([width as u32, height as u32], texels))
}

fn other(bytes: &[u8], format: ImageFormat) -> Result<Image, String> {
    let size = ImageReader::with_format(Cursor::new(bytes), format).into_dimensions();
    let (width, height) = size.map_err(|error| error.to_string())?;
    sized(width.into(), height.into())?;
    let mut reader = ImageReader::with_format(Cursor::new(bytes), format);
    let mut limits = Limits::no_limits();
    limits.max_alloc = Some(MAX_TEXELS * 16);
    reader.limits(limits);
    let decoded = reader.decode().map_err(|error| error.to_string())?;
    let size = [width, height];
    Ok(match decoded {
        DynamicImage::ImageRgb32F(_) | DynamicImage::ImageRgba32F(_) => {
            let floats = decoded.into_rgb32f().into_raw();
            Image::of_floats(size, floats.as_chunks::<3>().0.to_vec())
        }
        DynamicImage::ImageLuma16(_)
        | DynamicImage::ImageLumaA16(_)
        | DynamicImage::ImageRgb16(_)
        | DynamicImage::ImageRgba16(_) => {
            let codes = decoded.into_rgb16().into_raw();
            let linear = |code: u16| linear_of_srgb(f64::from(code) / 65_535.0);
            let texels = codes.as_chunks::<3>().0.iter().map(|texel| texel.map(linear));
            Image::of_floats(size, texels.collect())
        }
        bytes => {
            let plain = bytes.into_rgb8().into_raw();
            Image::of_bytes(size, plain.as_chunks::<3>().0.to_vec())
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grey(image: &Image, level: usize, at: [u32; 2]) -> f32 {
        image.texel(level, at)[0]
    }

    #[test]
    fn levels_halve_and_keep_the_mean() {
        for size @ [width, height] in [[8, 4], [7, 5], [1, 9], [3, 1]] {
            let value = |i: u32| (i * 7919 % 31) as f32 / 30.0;
            let texels = (0..width * height).map(|i| [value(i); 3]).collect();
            let image = Image::of_floats(size, texels);
            let mean = |level: usize| {
                let [w, h] = image.size_of(level);
                let sum: f64 = (0..h)
                    .flat_map(|y| (0..w).map(move |x| [x, y]))
                    .map(|at| f64::from(grey(&image, level, at)))
                    .sum();
                sum / f64::from(w * h)
            };
            for level in 1..image.levels() {
                let [w, h] = image.size_of(level - 1);
                assert_eq!(image.size_of(level), [w.div_ceil(2), h.div_ceil(2)]);
                assert!((mean(level) - mean(0)).abs() < 1e-6, "{size:?}, level {level}");
            }
            assert_eq!(image.size_of(image.levels() - 1), [1, 1]);
        }
    }

    #[test]
    fn bytes_stay_bytes_and_are_averaged_in_linear_light() {
        let image = Image::of_bytes([2, 1], vec![[0; 3], [255; 3]]);
        assert_eq!((grey(&image, 0, [0, 0]), grey(&image, 0, [1, 0])), (0.0, 1.0));
        // 188 is the sRGB byte of one half; the mean of the bytes would be 128, a fifth.
        assert!((grey(&image, 1, [0, 0]) - 0.5).abs() < 0.003);
        let large = Image::of_bytes([64, 64], vec![[9; 3]; 4096]);
        assert!(large.bytes() < 4096 * 3 * 4 / 3 + 1200, "{} bytes", large.bytes());
    }

    #[test]
    fn odd_floats_are_made_harmless() {
        let image = Image::of_floats([2, 1], vec![[f32::NAN, -1.0, f32::INFINITY], [0.5; 3]]);
        assert_eq!(image.texel(0, [0, 0]), [0.0, 0.0, 1e6]);
        assert_eq!(image, image.clone());
    }

    fn written(format: ImageFormat, picture: &DynamicImage) -> Image {
        let mut bytes = Cursor::new(Vec::new());
        picture.write_to(&mut bytes, format).unwrap();
        of_bytes(bytes.get_ref()).unwrap()
    }

    #[test]
    fn files_of_every_depth_are_read() {
        let rgb = image::RgbImage::from_raw(2, 1, vec![255, 0, 0, 0, 128, 255]).unwrap();
        let png = written(ImageFormat::Png, &DynamicImage::ImageRgb8(rgb));
        assert_eq!((png.size(), png.texel(0, [0, 0])), ([2, 1], [1.0, 0.0, 0.0]));
        assert!((png.texel(0, [1, 0])[1] - 0.215_86).abs() < 1e-4);
        let deep = image::ImageBuffer::from_raw(1, 1, vec![32_896u16; 3]).unwrap();
        let deep = written(ImageFormat::Png, &DynamicImage::ImageRgb16(deep));
        assert!((grey(&deep, 0, [0, 0]) - 0.215_86).abs() < 1e-4);
        let wide = image::ImageBuffer::from_raw(1, 1, vec![2.5f32, 0.5, 0.25]).unwrap();
        let wide = written(ImageFormat::Hdr, &DynamicImage::ImageRgb32F(wide));
        assert_eq!(wide.texel(0, [0, 0]), [2.5, 0.5, 0.25]);
    }

    /// A JPEG of one 8 × 8 block of one colour, made by hand: only DC coefficients, no AC ones.
    #[test]
    fn a_jpeg_is_read() {
        let image = of_bytes(&tests_jpeg()).unwrap();
        assert_eq!(image.size(), [8, 8]);
        // DC 0: the middle grey, byte 128.
        assert!((grey(&image, 0, [3, 5]) - 0.215_86).abs() < 1e-4);
    }

    /// Quantisation all 1; one Huffman code each: DC length 0 is `0`, AC end of block is `0`.
    fn tests_jpeg() -> Vec<u8> {
        let mut bytes = vec![0xff, 0xd8, 0xff, 0xdb, 0, 67, 0];
        bytes.extend([1; 64]);
        bytes.extend([0xff, 0xc0, 0, 11, 8, 0, 8, 0, 8, 1, 1, 0x11, 0]);
        for class in [0x00, 0x10] {
            bytes.extend([0xff, 0xc4, 0, 20, class, 1]);
            bytes.extend([0; 15]);
            bytes.push(0);
        }
        bytes.extend([0xff, 0xda, 0, 8, 1, 1, 0, 0, 63, 0, 0b0011_1111, 0xff, 0xd9]);
        bytes
    }

    #[test]
    fn what_is_no_image_is_refused_with_place_cause_and_way_out() {
        let missing = read(Path::new("no/such.png")).unwrap_err().to_string();
        assert!(missing.starts_with("no/such.png: cannot be read: "), "{missing}");
        assert!(missing.ends_with("help: check the name; it is relative to the scene file"));
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        for (bytes, cause) in [
            (&b"version = 1"[..], "this is no PNG, JPEG or HDR file"),
            (&b"\x89PNG\r\n\x1a\nbroken"[..], ""),
            (&b"\xff\xd8\xff\xe0broken"[..], ""),
            (&b"#?RADIANCE\nbroken"[..], ""),
        ] {
            std::fs::write(&path, bytes).unwrap();
            let error = read(&path).unwrap_err();
            assert!(error.cause.contains(cause) && !error.cause.is_empty(), "{error}");
            assert_eq!(error.way_out, "export it again as PNG, JPEG or HDR");
        }
        assert!(sized(100_000, 1).is_err() && sized(0, 5).is_err() && sized(8192, 8192).is_ok());
        assert!(sized(8193, 8192).is_err());
    }
}
