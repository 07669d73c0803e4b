//! What the eye gets: a picture in linear floats, its development to 8 bits, and picture files.

pub mod caption;
pub mod clipping;
pub mod develop;
pub mod embedded;
mod hdr;
pub mod layout;
pub mod pixels;
pub mod plates;
pub mod sheet;
pub mod tone;
pub mod write;

use crate::color::Rgb;
use layout::{LANES, Layout, TILE_BLOCKS};

/// The light of the 16 pixels of a block, one row of lanes per channel.
#[repr(align(64))]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FilmBlock(pub [[f32; LANES]; 3]);

/// A picture in scene-linear floats, before exposure, stored in the order of [`Layout`].
///
/// Written by `shade`, read by `develop`, the picture files and the pixel inspector.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Film {
    /// Its cut.
    pub layout: Layout,
    /// 64 blocks per tile; lanes outside the picture hold 0.
    pub blocks: Vec<FilmBlock>,
}

impl Film {
    /// A black picture.
    pub fn new(layout: Layout) -> Film {
        Film { layout, blocks: vec![FilmBlock::default(); layout.tiles() * TILE_BLOCKS] }
    }

    /// The light of one pixel.
    pub fn pixel(&self, pixel: [u32; 2]) -> Rgb {
        let place = self.layout.place(pixel);
        let FilmBlock(rows) = self.blocks[place.tile * TILE_BLOCKS + place.block];
        Rgb([rows[0][place.lane], rows[1][place.lane], rows[2][place.lane]])
    }

    /// Sets the light of one pixel.
    pub fn put(&mut self, pixel: [u32; 2], Rgb(light): Rgb) {
        let place = self.layout.place(pixel);
        let FilmBlock(rows) = &mut self.blocks[place.tile * TILE_BLOCKS + place.block];
        for (row, light) in rows.iter_mut().zip(light) {
            row[place.lane] = light;
        }
    }
}

/// A picture as shown: sRGB bytes, red green blue alpha, rows from the top, alpha 255.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Frame {
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Four bytes per pixel.
    pub bytes: Vec<u8>,
}

impl Frame {
    /// A black picture.
    pub fn new(size: [u32; 2]) -> Frame {
        Frame { size, bytes: vec![0; size[0] as usize * size[1] as usize * 4] }
    }

    /// The bytes of one pixel.
    pub fn pixel(&self, [x, y]: [u32; 2]) -> [u8; 4] {
        let at = (y as usize * self.size[0] as usize + x as usize) * 4;
        [self.bytes[at], self.bytes[at + 1], self.bytes[at + 2], self.bytes[at + 3]]
    }
}
