//! Several pictures in one: smaller copies, row by row.

use super::Frame;
use super::caption::{LINE, caption};
use crate::color::{linear_of_srgb, srgb_byte};

/// Pixels between the pictures of a sheet, and around them.
const GAP: u32 = 4;

/// Smaller by a whole number per side: each pixel is the mean of the light of a square of the picture,
/// of those of its pixels that are there at the right and lower edge.
pub fn reduced(frame: &Frame, divisor: u32) -> Frame {
    let divisor = divisor.max(1);
    let size = frame.size.map(|side| side.div_ceil(divisor));
    let mut small = Frame::new(size);
    let light: Vec<f32> = (0..=255u8).map(|byte| linear_of_srgb(f64::from(byte) / 255.0)).collect();
    for (i, pixel) in small.bytes.chunks_exact_mut(4).enumerate() {
        let (x, y) = (i as u32 % size[0] * divisor, i as u32 / size[0] * divisor);
        let [right, below] = [x + divisor, y + divisor];
        let (mut sum, mut count) = ([0.0f32; 3], 0.0);
        for y in y..below.min(frame.size[1]) {
            for x in x..right.min(frame.size[0]) {
                let [r, g, b, _] = frame.pixel([x, y]);
                for (sum, byte) in sum.iter_mut().zip([r, g, b]) {
                    *sum += light[usize::from(byte)];
                }
                count += 1.0;
            }
        }
        let [r, g, b] = sum.map(|sum| srgb_byte(sum / count));
        pixel.copy_from_slice(&[r, g, b, 255]);
    }
    small
}

/// A sheet of pictures of one size with a line of text below each, as many to a row as make it about
/// square; the ground is black. Without memory for a line its picture has none.
pub fn sheet(pictures: &[(Frame, String)]) -> Frame {
    let Some((first, _)) = pictures.first() else { return Frame::default() };
    let columns = (pictures.len() as f64).sqrt().ceil() as u32;
    let rows = (pictures.len() as u32).div_ceil(columns);
    let [width, height] = [first.size[0] + GAP, first.size[1] + LINE + GAP];
    let mut sheet = Frame::new([columns * width + GAP, rows * height + GAP]);
    sheet.bytes.chunks_exact_mut(4).for_each(|pixel| pixel[3] = 255);
    for (i, (picture, name)) in (0..).zip(pictures) {
        assert_eq!(picture.size, first.size, "pictures of one size");
        let [left, top] = [i % columns * width + GAP, i / columns * height + GAP];
        put(&mut sheet, picture, [left, top]);
        if let Some(line) = caption(name, first.size[0]) {
            put(&mut sheet, &line, [left, top + first.size[1]]);
        }
    }
    sheet
}

/// Copies a picture into a larger one.
fn put(sheet: &mut Frame, picture: &Frame, [left, top]: [u32; 2]) {
    let wide = picture.size[0] as usize * 4;
    for (row, line) in picture.bytes.chunks_exact(wide).enumerate() {
        let at = ((top as usize + row) * sheet.size[0] as usize + left as usize) * 4;
        sheet.bytes[at..at + wide].copy_from_slice(line);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grey(size: [u32; 2], value: impl Fn(u32, u32) -> u8) -> Frame {
        let mut frame = Frame::new(size);
        for (i, pixel) in frame.bytes.chunks_exact_mut(4).enumerate() {
            let byte = value(i as u32 % size[0], i as u32 / size[0]);
            pixel.copy_from_slice(&[byte, byte, byte, 255]);
        }
        frame
    }

    #[test]
    fn a_smaller_picture_has_the_mean_light_also_at_its_edge() {
        let small = reduced(&grey([5, 3], |x, _| if x % 2 == 0 { 255 } else { 0 }), 2);
        assert_eq!(small.size, [3, 2]);
        assert_eq!(small.pixel([0, 0]), [188, 188, 188, 255], "half the light");
        assert_eq!(small.pixel([2, 1]), [255; 4], "one pixel alone");
    }

    #[test]
    fn every_picture_of_a_sheet_is_whole() {
        let picture = |i: u8| (grey([6, 2], |x, _| i * 10 + x as u8), "WWW".to_owned());
        let pictures: Vec<_> = (1..=3).map(picture).collect();
        let sheet = sheet(&pictures);
        let below = 2 + LINE + 4;
        assert_eq!(sheet.size, [2 * 10 + 4, 2 * below + 4]);
        let name = (0..LINE).map(|y| sheet.pixel([8, 6 + y])[0]).max();
        assert!(name > Some(100), "its name is below it");
        for (corner, first) in [([4, 4], 10), ([14, 4], 20), ([4, 4 + below], 30)] {
            let [x, y] = corner;
            assert_eq!(sheet.pixel(corner)[0], first);
            assert_eq!(sheet.pixel([x + 5, y + 1])[0], first + 5);
            assert_eq!(sheet.pixel([x + 6, y]), [0, 0, 0, 255]);
        }
        assert_eq!(sheet.pixel([14, 4 + below]), [0, 0, 0, 255]);
    }
}
