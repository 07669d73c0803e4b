//! How a picture is cut: tiles of 32×32 pixels, each of 64 blocks of 4×4, a pixel being one of the
//! 16 lanes of its block.
//!
//! Everything that has a value per pixel follows this order: tiles row by row, blocks of a tile row
//! by row, lanes of a block row by row. Tiles and blocks at the right and lower edge of the picture
//! may hang over it; such lanes hold no pixel.

/// Side of a tile in pixels.
pub const TILE: u32 = 32;
/// Side of a block in pixels.
pub const BLOCK: u32 = 4;
/// Pixels of a block: the lanes of the product.
pub const LANES: usize = 16;
/// Blocks of a tile, whole tiles only.
pub const TILE_BLOCKS: usize = 64;

/// The cut of a picture of a given size.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Layout {
    /// Pixels, width and height.
    pub size: [u32; 2],
}

/// Where a pixel's value lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Place {
    /// Index of the tile.
    pub tile: usize,
    /// Index of the block within its tile.
    pub block: usize,
    /// Lane within the block.
    pub lane: usize,
}

impl Layout {
    /// The cut of a picture of `size` pixels.
    pub fn new(size: [u32; 2]) -> Layout {
        Layout { size }
    }

    /// Tiles per row and per column.
    pub fn grid(self) -> [usize; 2] {
        self.size.map(|side| side.div_ceil(TILE) as usize)
    }

    /// Number of tiles.
    pub fn tiles(self) -> usize {
        self.grid()[0] * self.grid()[1]
    }

    /// Number of pixels.
    pub fn pixels(self) -> u64 {
        u64::from(self.size[0]) * u64::from(self.size[1])
    }

    /// The pixel at a lane, or `None` where the block hangs over the picture's edge.
    #[inline(always)]
    pub fn pixel(self, place: Place) -> Option<[u32; 2]> {
        let columns = self.grid()[0];
        let (tx, ty) = ((place.tile % columns) as u32, (place.tile / columns) as u32);
        let (b, lane) = (place.block as u32, place.lane as u32);
        let x = tx * TILE + b % 8 * BLOCK + lane % BLOCK;
        let y = ty * TILE + b / 8 * BLOCK + lane / BLOCK;
        (x < self.size[0] && y < self.size[1]).then_some([x, y])
    }

    /// Which lanes of a block hold a pixel.
    pub fn covered(self, tile: usize, block: usize) -> [bool; LANES] {
        std::array::from_fn(|lane| self.pixel(Place { tile, block, lane }).is_some())
    }

    /// The same as a mask: bit i for lane i.
    pub fn lanes(self, tile: usize, block: usize) -> u16 {
        let covered = self.covered(tile, block).into_iter().enumerate();
        covered.fold(0, |mask, (lane, covered)| mask | u16::from(covered) << lane)
    }

    /// Where the pixel (x, y) lies.
    ///
    /// # Panics
    /// If the pixel is outside the picture.
    pub fn place(self, [x, y]: [u32; 2]) -> Place {
        assert!(x < self.size[0] && y < self.size[1], "pixel ({x}, {y}) is outside the picture");
        let tile = (y / TILE) as usize * self.grid()[0] + (x / TILE) as usize;
        let block = (y % TILE / BLOCK * 8 + x % TILE / BLOCK) as usize;
        let lane = (y % BLOCK * BLOCK + x % BLOCK) as usize;
        Place { tile, block, lane }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn place_and_pixel_are_inverse_and_cover_the_picture_once() {
        let layout = Layout::new([77, 35]);
        let mut seen = 0;
        for tile in 0..layout.tiles() {
            for block in 0..TILE_BLOCKS {
                for lane in 0..LANES {
                    let place = Place { tile, block, lane };
                    if let Some(pixel) = layout.pixel(place) {
                        assert_eq!(layout.place(pixel), place);
                        seen += 1;
                    }
                }
            }
        }
        assert_eq!(seen, layout.pixels());
    }
}
