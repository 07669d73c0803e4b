//! From linear light to what is shown: exposure, the tone curve, then the sRGB curve.

use super::layout::{BLOCK, LANES, TILE};
use super::tone::neutral;
use super::{Film, FilmBlock, Frame};
use crate::color::{Rgb, srgb_byte, srgb_code};
use crate::math::exposure_factor;
use crate::scene::Picture;
use crate::scene::tone::Tone;

/// How light becomes what is shown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Development {
    /// Factor of the exposure.
    pub gain: f32,
    /// What happens after it.
    pub tone: Tone,
}

impl Development {
    /// Light as it is.
    pub const PLAIN: Development = Development { gain: 1.0, tone: Tone::None };

    /// As a picture's parameters ask for it.
    pub fn of(picture: &Picture) -> Development {
        let Picture { size: _, exposure, tone } = picture;
        Development { gain: exposure_factor(*exposure), tone: *tone }
    }

    /// Linear light as a screen is to give it off; beyond 0 … 1 it is cut off.
    #[inline(always)]
    pub fn displayed(self, light: Rgb) -> Rgb {
        let Development { gain, tone } = self;
        let exposed = light * gain;
        match tone {
            Tone::None => exposed,
            Tone::Neutral => Rgb(neutral(exposed.0)),
        }
    }
}

/// A row of tiles of a [`Frame`]: the pixel rows that its tiles cover, and no more.
pub struct FrameRows<'a> {
    /// Width of the picture in pixels.
    pub width: usize,
    /// Whole pixel rows, at most [`TILE`] of them.
    pub bytes: &'a mut [u8],
}

/// Cuts a frame into its rows of tiles.
pub fn tile_rows(frame: &mut Frame) -> impl Iterator<Item = FrameRows<'_>> {
    let width = frame.size[0] as usize;
    frame.bytes.chunks_mut(width * 4 * TILE as usize).map(move |bytes| FrameRows { width, bytes })
}

impl FrameRows<'_> {
    /// Writes one block of the `column`-th tile of the row.
    #[inline(always)]
    pub fn put(
        &mut self,
        column: usize,
        block: usize,
        light: &FilmBlock,
        development: Development,
    ) {
        let codes = encode(light, development);
        let x = column * TILE as usize + block % 8 * BLOCK as usize;
        let y = block / 8 * BLOCK as usize;
        let wide = BLOCK as usize * 4;
        for row in 0..BLOCK as usize {
            let source = &codes[row * BLOCK as usize..][..BLOCK as usize];
            let at = ((y + row) * self.width + x) * 4;
            if x + BLOCK as usize <= self.width {
                let Some(out) = self.bytes.get_mut(at..at + wide) else { return };
                for (pixel, code) in out.chunks_exact_mut(4).zip(source) {
                    pixel.copy_from_slice(&code.to_le_bytes());
                }
            } else if x < self.width {
                let Some(out) = self.bytes.get_mut(at..at + (self.width - x) * 4) else { return };
                for (pixel, code) in out.chunks_exact_mut(4).zip(source) {
                    pixel.copy_from_slice(&code.to_le_bytes());
                }
            }
        }
    }
}

/// Sixteen pixels as little-endian red, green, blue, 255.
#[inline(always)]
fn encode(light: &FilmBlock, Development { gain, tone }: Development) -> [u32; LANES] {
    match tone {
        Tone::None => codes(light, gain),
        Tone::Neutral => codes(&toned(light, gain), 1.0),
    }
}

/// Sixteen pixels after exposure and tone curve.
#[inline(always)]
fn toned(FilmBlock([red, green, blue]): &FilmBlock, gain: f32) -> FilmBlock {
    let mut shown = FilmBlock::default();
    for lane in 0..LANES {
        let exposed = [red[lane] * gain, green[lane] * gain, blue[lane] * gain];
        let [r, g, b] = neutral(exposed);
        shown.0[0][lane] = r;
        shown.0[1][lane] = g;
        shown.0[2][lane] = b;
    }
    shown
}

#[inline(always)]
fn codes(light: &FilmBlock, gain: f32) -> [u32; LANES] {
    const ROUND: f32 = 8_388_608.0; // 2^23: adding it leaves a whole number in the low bits
    let mut codes = [0xff00_0000; LANES];
    for (channel, row) in light.0.iter().enumerate() {
        for (code, value) in codes.iter_mut().zip(row) {
            let byte = (srgb_code(*value * gain) + ROUND).to_bits() & 255;
            *code |= byte << (8 * channel);
        }
    }
    codes
}

/// Develops a whole film.
pub fn frame(film: &Film, development: Development) -> Frame {
    let mut frame = Frame::new(film.layout.size);
    let columns = film.layout.grid()[0];
    for (row, mut rows) in tile_rows(&mut frame).enumerate() {
        for column in 0..columns {
            for block in 0..super::layout::TILE_BLOCKS {
                let at = (row * columns + column) * super::layout::TILE_BLOCKS + block;
                rows.put(column, block, &film.blocks[at], development);
            }
        }
    }
    frame
}

/// One pixel as 8-bit sRGB code values: the bytes that are shown and written.
pub fn code8(light: Rgb, development: Development) -> [u8; 3] {
    development.displayed(light).0.map(srgb_byte)
}

/// One pixel as 16-bit sRGB code values, for 16-bit files.
pub fn code16(light: Rgb, development: Development) -> [u16; 3] {
    let code = |c: f32| (f64::from(srgb_code(c)) * 257.0).round() as u16;
    development.displayed(light).0.map(code)
}

#[cfg(test)]
mod tests {
    use super::super::layout::Layout;
    use super::*;

    #[test]
    fn every_pixel_lands_in_its_place_at_ragged_sizes() {
        for size in [[1, 1], [5, 3], [33, 31], [70, 45]] {
            let mut film = Film::new(Layout::new(size));
            let value = |x: u32, y: u32, c: u32| ((x * 7 + y * 13 + c * 29) % 101) as f32 / 100.0;
            for y in 0..size[1] {
                for x in 0..size[0] {
                    let p = film.layout.place([x, y]);
                    let block = &mut film.blocks[p.tile * 64 + p.block];
                    for c in 0..3 {
                        block.0[c as usize][p.lane] = value(x, y, c);
                    }
                }
            }
            for tone in Tone::ALL {
                let development = Development { gain: 2.0, tone };
                let frame = frame(&film, development);
                for (x, y) in (0..size[1]).flat_map(|y| (0..size[0]).map(move |x| (x, y))) {
                    let light = Rgb([0, 1, 2].map(|c| value(x, y, c)));
                    let [r, g, b] = code8(light, development);
                    assert_eq!(frame.pixel([x, y]), [r, g, b, 255], "{x} {y} of {size:?} {tone:?}");
                }
            }
        }
    }

    #[test]
    fn the_tone_curve_comes_between_exposure_and_the_srgb_curve() {
        let light = Rgb([1.0, 0.25, 0.05]);
        let development = Development { gain: 2.0, tone: Tone::Neutral };
        let by_hand = Rgb(neutral([2.0, 0.5, 0.1])).map(|c| f32::from(srgb_byte(c)));
        assert_eq!(code8(light, development).map(f32::from), by_hand.0);
        let plain = Development { tone: Tone::None, ..development };
        assert_ne!(code8(light, development), code8(light, plain));
        let [deep, ..] = code16(light, development);
        assert_eq!((f64::from(deep) / 257.0).round() as u8, code8(light, development)[0]);
    }
}
