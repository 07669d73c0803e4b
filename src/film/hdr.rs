//! Radiance pictures: linear light with one exponent for the three channels of a pixel.

use std::io::{BufRead, BufReader, Read};
use std::path::Path;

use image::Rgb;
use image::codecs::hdr::HdrEncoder;

use super::Film;
use super::write::{WriteSeek, pixels};

/// Before every line of the scene's text, which stands in the header as comments.
const SCENE: &str = "# scene: ";
/// No header is longer: what comes after it is no text.
const MOST_HEADER: u64 = 64 << 20;

/// Writes linear light before exposure. The channels of a pixel share an exponent: each is exact to
/// 1/128 of the largest; what is negative, as filters may leave it, becomes 0.
pub(super) fn hdr(out: &mut dyn WriteSeek, film: &Film, scene: &str) -> Result<(), String> {
    let [width, height] = film.layout.size;
    let light: Vec<Rgb<f32>> =
        pixels([width, height]).map(|p| Rgb(film.pixel(p).0.map(|c| c.max(0.0)))).collect();
    let mut bytes = Vec::new();
    let encoder = HdrEncoder::new(&mut bytes);
    encoder.encode(&light, width as usize, height as usize).map_err(|e| e.to_string())?;
    let first = 1 + bytes.iter().position(|b| *b == b'\n').ok_or("there is no header")?;
    let (signature, rest) = bytes.split_at(first);
    let mut put = |bytes: &[u8]| out.write_all(bytes).map_err(|e| e.to_string());
    put(signature)?;
    for line in scene.lines() {
        put(format!("{SCENE}{line}\n").as_bytes())?;
    }
    put(rest)
}

/// The text of the scene in such a file.
pub(super) fn scene(path: &Path) -> Result<Option<String>, String> {
    let file = std::fs::File::open(path).map_err(|e| e.to_string())?;
    let mut header = BufReader::new(file.take(MOST_HEADER));
    let mut text = String::new();
    let mut line = Vec::new();
    for number in 0.. {
        line.clear();
        header.read_until(b'\n', &mut line).map_err(|e| e.to_string())?;
        if number == 0 && !line.starts_with(b"#?") {
            return Err("it does not begin as a Radiance picture".into());
        }
        // An empty line ends the header.
        if line.is_empty() || line == b"\n" {
            break;
        }
        if let Some(rest) = line.strip_prefix(SCENE.as_bytes()) {
            text += str::from_utf8(rest).map_err(|e| e.to_string())?;
        }
    }
    Ok(Some(text).filter(|text| !text.is_empty()))
}

#[cfg(test)]
mod tests {
    use super::super::layout::Layout;
    use super::super::plates::Plates;
    use super::super::write::{Format, picture};
    use super::*;
    use crate::color::Rgb as Light;
    use crate::film::develop::Development;
    use crate::scene::tone::Tone;

    /// Light over fourteen powers of two, with dark and bright channels side by side.
    fn film(size: [u32; 2]) -> Film {
        let mut film = Film::new(Layout::new(size));
        for (i, pixel) in pixels(size).enumerate() {
            let strength = ((i * 7 % 29) as f32 / 2.0 - 7.0).exp2();
            film.put(pixel, Light([strength, strength * 0.3, (i % 5) as f32 * strength * 0.01]));
        }
        film
    }

    /// Whether every channel is within 1/128 of its pixel's largest: a mantissa has 8 bits, the largest one
    /// is at least 128, and values are rounded down or to the nearest.
    fn is_within(film: &Film, read: &image::Rgb32FImage) -> bool {
        read.enumerate_pixels().all(|(x, y, read)| {
            let light = film.pixel([x, y]).0.map(|c| c.max(0.0));
            let most = light.into_iter().fold(0.0, f32::max);
            light.iter().zip(read.0).all(|(a, b)| (a - b).abs() <= most / 128.0)
        })
    }

    #[test]
    fn light_comes_back_within_the_format_s_precision_and_the_scene_whole() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.hdr");
        let text = "version = 1 # µ\n\n[picture]\nsize = [9, 5]\n";
        for size in [[9, 5], [40, 3], [1, 1], [7, 2]] {
            let mut film = film(size);
            film.put([0, 0], Light([-0.5, 0.25, 3.0]));
            let format = Format::of(&path, false).unwrap();
            let shown = Development { gain: 4.0, tone: Tone::Neutral };
            picture(&path, format, &Plates::of(film.clone()), shown, text).unwrap();
            assert_eq!(scene(&path).unwrap().as_deref(), Some(text));
            let read = image::open(&path).unwrap().into_rgb32f();
            assert_eq!([read.width(), read.height()], size);
            assert!(is_within(&film, &read), "{size:?}");
            let mut other = film.clone();
            let last = size.map(|side| side - 1);
            other.put(last, film.pixel(last).map(|c| c * 1.03));
            assert!(!is_within(&other, &read), "a difference is seen");
        }
    }

    #[test]
    fn other_files_hold_no_scene() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.hdr");
        std::fs::write(&path, "no picture").unwrap();
        assert!(scene(&path).is_err());
        std::fs::write(&path, "#?RADIANCE\n# made elsewhere\nFORMAT=32-bit_rle_rgbe\n\n").unwrap();
        assert_eq!(scene(&path), Ok(None));
        std::fs::write(&path, "#?RADIANCE").unwrap();
        assert_eq!(scene(&path), Ok(None));
    }
}
