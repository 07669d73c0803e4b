//! Pictures in linear light and their comparison; one that fails leaves picture, reference and
//! difference as PNG files and says where.

use std::fs::File;
use std::io::{BufReader, BufWriter};
use std::path::{Path, PathBuf};

use rayforest::color::srgb_byte;
use rayforest::film::Film;

/// Linear light, row by row from the top.
#[derive(Clone)]
pub(super) struct Picture {
    pub(super) size: [u32; 2],
    pub(super) pixels: Vec<[f64; 3]>,
}

/// How far two pictures are apart.
pub(super) struct Comparison {
    /// Share of the pixels that differ by more than is allowed.
    pub(super) share: f64,
    /// The worst channel: its difference in units of what is allowed, and its pixel.
    pub(super) worst: (f64, [u32; 2]),
}

impl Picture {
    /// A picture from a function of the pixel.
    pub(super) fn from_fn(size: [u32; 2], mut light: impl FnMut([u32; 2]) -> [f64; 3]) -> Picture {
        let places = (0..size[1]).flat_map(|y| (0..size[0]).map(move |x| [x, y]));
        Picture { size, pixels: places.map(&mut light).collect() }
    }

    /// What a session shows.
    pub(super) fn of_film(film: &Film) -> Picture {
        Picture::from_fn(film.layout.size, |pixel| film.pixel(pixel).0.map(f64::from))
    }

    /// The values of a PNG with 16 bits per channel, 65535 being 1, without any curve.
    pub(super) fn of_png16(path: &Path) -> Picture {
        let file = File::open(path).expect("a reference picture");
        let mut reader = png::Decoder::new(BufReader::new(file)).read_info().expect("a PNG");
        let mut bytes = vec![0; reader.output_buffer_size().expect("a size")];
        let frame = reader.next_frame(&mut bytes).expect("a whole PNG");
        let kind = (frame.color_type, frame.bit_depth);
        assert_eq!(kind, (png::ColorType::Rgb, png::BitDepth::Sixteen), "{}", path.display());
        let value = |b: &[u8]| f64::from(u16::from_be_bytes([b[0], b[1]])) / 65535.0;
        let pixels = bytes.chunks_exact(6).map(|p| [value(p), value(&p[2..]), value(&p[4..])]);
        Picture { size: [frame.width, frame.height], pixels: pixels.collect() }
    }

    /// The same with every channel in 0 … 1.
    pub(super) fn clipped(&self) -> Picture {
        let pixels = self.pixels.iter().map(|p| p.map(|c| c.clamp(0.0, 1.0))).collect();
        Picture { size: self.size, pixels }
    }

    /// Compares with a reference; `allowed` gives, for a reference value, by how much a channel may
    /// differ. A value that is not a number differs.
    pub(super) fn compare(&self, reference: &Picture, allowed: impl Fn(f64) -> f64) -> Comparison {
        assert_eq!(self.size, reference.size, "pictures of one size");
        let mut comparison = Comparison { share: 0.0, worst: (0.0, [0, 0]) };
        let mut beyond = 0;
        for (at, (ours, theirs)) in (0..).zip(self.pixels.iter().zip(&reference.pixels)) {
            let pixel = [at % self.size[0], at / self.size[0]];
            let mut within = true;
            for (a, b) in ours.iter().zip(theirs) {
                let difference = (a - b).abs();
                let units = if difference == 0.0 { 0.0 } else { difference / allowed(*b) };
                within &= units <= 1.0;
                if units > comparison.worst.0 || units.is_nan() {
                    comparison.worst = (units, pixel);
                }
            }
            beyond += u32::from(!within);
        }
        comparison.share = f64::from(beyond) / self.pixels.len() as f64;
        comparison
    }

    /// Leaves three files and gives a message that names them.
    pub(super) fn leave(&self, reference: &Picture, name: &str) -> String {
        let difference = self.difference(reference);
        let parts = [("picture", self), ("reference", reference), ("difference", &difference)];
        let paths = parts.map(|(part, picture)| picture.write(&format!("{name}-{part}")));
        let [picture, reference, difference] = paths.map(|p| p.display().to_string());
        format!("picture: {picture}\nreference: {reference}\ndifference: {difference}")
    }

    /// The difference of every channel, stretched so that the largest one is 1.
    fn difference(&self, reference: &Picture) -> Picture {
        let pairs = || self.pixels.iter().zip(&reference.pixels);
        let apart = |(a, b): (&[f64; 3], &[f64; 3])| [0, 1, 2].map(|c| (a[c] - b[c]).abs());
        let largest = pairs().flat_map(apart).fold(0.0, f64::max);
        let scale = if largest > 0.0 { 1.0 / largest } else { 1.0 };
        let pixels = pairs().map(|pair| apart(pair).map(|c| c * scale)).collect();
        Picture { size: self.size, pixels }
    }

    /// Writes `target/test-pictures/name.png`.
    fn write(&self, name: &str) -> PathBuf {
        let target = Path::new(env!("CARGO_TARGET_TMPDIR")).parent().expect("a target folder");
        let folder = target.join("test-pictures");
        std::fs::create_dir_all(&folder).expect("a folder for pictures");
        let path = folder.join(format!("{name}.png"));
        let file = BufWriter::new(File::create(&path).expect("a picture file"));
        let mut encoder = png::Encoder::new(file, self.size[0], self.size[1]);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_depth(png::BitDepth::Eight);
        let codes: Vec<u8> =
            self.pixels.iter().flatten().map(|&channel| srgb_byte(channel as f32)).collect();
        let mut writer = encoder.write_header().expect("a PNG header");
        writer.write_image_data(&codes).expect("a picture");
        writer.finish().expect("a whole picture");
        path
    }
}

#[test]
fn every_kind_of_difference_is_found() {
    let flat = Picture::from_fn([5, 3], |_| [0.5; 3]);
    let strict = |_: f64| 1e-3;
    assert_eq!(flat.compare(&flat, strict).share, 0.0);
    for (value, found) in [(0.5005, false), (0.4995, false), (0.502, true), (f64::NAN, true)] {
        for channel in 0..3 {
            let mut other = flat.clone();
            other.pixels[7][channel] = value;
            for comparison in [flat.compare(&other, strict), other.compare(&flat, strict)] {
                assert_eq!(comparison.share, if found { 1.0 / 15.0 } else { 0.0 }, "{value}");
                assert_eq!(comparison.worst.1, [2, 1]);
                let worst = comparison.worst.0;
                assert_eq!(worst > 1.0 || worst.is_nan(), found, "{value}");
            }
        }
    }
}

#[test]
fn a_failure_leaves_three_pictures() {
    let ours = Picture::from_fn([4, 2], |[x, y]| [f64::from(x) / 4.0, f64::from(y), 0.0]);
    let mut other = ours.clone();
    other.pixels[3][2] = 0.25;
    let message = ours.leave(&other, "self-test");
    for (line, blue) in message.lines().zip([0, 137, 255]) {
        let (_, path) = line.split_once(": ").unwrap();
        let file = BufReader::new(File::open(path).unwrap());
        let mut reader = png::Decoder::new(file).read_info().unwrap();
        let mut bytes = [1; 24];
        reader.next_frame(&mut bytes).unwrap();
        assert_eq!(bytes[3 * 3 + 2], blue, "{path}");
    }
    assert_eq!(message.lines().count(), 3);
}
