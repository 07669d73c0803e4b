//! Which pixels of a picture a screen cannot show: brighter than white, or darker than black.

use super::develop::Development;
use super::layout::{LANES, TILE_BLOCKS};
use super::{Film, Frame};
use crate::color::Rgb;

/// Colour of the mark on pixels brighter than white, 0xRRGGBB.
pub const OVER: u32 = 0xff_00_50;
/// Colour of the mark on pixels darker than black, 0xRRGGBB.
pub const UNDER: u32 = 0x00_78_ff;

/// How many pixels are clipped.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Clipped {
    /// Pixels with a channel that is 1 or more after exposure and tone.
    pub over: u64,
    /// Other pixels with a channel that is below 0, or no number: filters that sharpen overshoot.
    pub under: u64,
    /// All pixels.
    pub of: u64,
}

/// What is marked in place of a pixel's colour, if it is clipped.
#[inline]
fn mark_of(light: Rgb, development: Development) -> Option<u32> {
    let shown = development.displayed(light);
    let is_lit = |c: f32| c >= 0.0;
    if shown.0.iter().any(|c| *c >= 1.0) {
        Some(OVER)
    } else {
        // The gain changes no sign.
        (!light.0.into_iter().all(is_lit)).then_some(UNDER)
    }
}

/// Marks the clipped pixels of a film in `frame`, which shows it.
pub fn mark(film: &Film, development: Development, frame: &mut Frame) -> Clipped {
    assert_eq!(frame.size, film.layout.size, "a frame of the same picture");
    let layout = film.layout;
    let mut clipped = Clipped { of: layout.pixels(), ..Clipped::default() };
    for (at, block) in film.blocks.iter().enumerate() {
        let [red, green, blue] = &block.0;
        for lane in 0..LANES {
            let light = Rgb([red[lane], green[lane], blue[lane]]);
            let Some(color) = mark_of(light, development) else { continue };
            // Lanes beside the picture hold 0, which is not clipped.
            let place =
                super::layout::Place { tile: at / TILE_BLOCKS, block: at % TILE_BLOCKS, lane };
            let Some([x, y]) = layout.pixel(place) else { continue };
            let at = (y as usize * frame.size[0] as usize + x as usize) * 4;
            let [_, r, g, b] = color.to_be_bytes();
            frame.bytes[at..at + 4].copy_from_slice(&[r, g, b, 255]);
            match color {
                OVER => clipped.over += 1,
                _ => clipped.under += 1,
            }
        }
    }
    clipped
}

#[cfg(test)]
mod tests {
    use super::super::develop;
    use super::super::layout::Layout;
    use super::*;
    use crate::scene::tone::Tone;

    #[test]
    fn clipped_pixels_are_marked_and_counted_and_no_others() {
        let mut film = Film::new(Layout::new([37, 5]));
        let odd = [
            ([0, 0], [0.5, 0.2, 0.1], Some(OVER)),
            ([36, 4], [0.0, 0.0, 9.0], Some(OVER)),
            ([7, 3], [0.3, -1e-6, 0.2], Some(UNDER)),
            ([8, 3], [f32::NAN, 0.0, 0.2], Some(UNDER)),
            ([9, 3], [0.7, -0.1, 0.2], Some(OVER)),
            ([10, 3], [0.4999, 0.2, 0.1], None),
            ([11, 3], [-0.0, 0.0, 0.0], None),
        ];
        odd.iter().for_each(|(pixel, light, _)| film.put(*pixel, Rgb(*light)));
        let development = Development { gain: 2.0, tone: Tone::None };
        let plain = develop::frame(&film, development);
        let mut marked = plain.clone();
        let clipped = mark(&film, development, &mut marked);
        assert_eq!(clipped, Clipped { over: 3, under: 2, of: 37 * 5 });
        for pixel in (0..5).flat_map(|y| (0..37).map(move |x| [x, y])) {
            let known = odd.iter().find(|(at, ..)| *at == pixel).and_then(|(.., mark)| *mark);
            let [r, g, b, _] = marked.pixel(pixel);
            match known {
                Some(mark) => assert_eq!(u32::from_be_bytes([0, r, g, b]), mark, "{pixel:?}"),
                None => assert_eq!(marked.pixel(pixel), plain.pixel(pixel), "{pixel:?}"),
            }
        }
    }

    #[test]
    fn compressed_highlights_are_not_clipped() {
        let mut film = Film::new(Layout::new([1, 1]));
        film.put([0, 0], Rgb([5.0, 3.0, 1.0]));
        let over = |tone| {
            let development = Development { gain: 1.0, tone };
            mark(&film, development, &mut develop::frame(&film, development)).over
        };
        assert_eq!((over(Tone::None), over(Tone::Neutral)), (1, 0));
    }
}
