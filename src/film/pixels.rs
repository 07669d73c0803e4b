//! Sets of a picture's pixels, kept tile by tile as masks of lanes.

use super::layout::{BLOCK, LANES, Layout, Place, TILE, TILE_BLOCKS};

/// Per block bit i for lane i.
pub type Lanes = [u16; TILE_BLOCKS];

/// Some pixels of a picture.
///
/// # Invariants
/// No tile is empty, and no lane outside the picture is in it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PixelSet {
    layout: Layout,
    tiles: Vec<Option<Box<Lanes>>>,
}

impl PixelSet {
    /// No pixel.
    pub fn new(layout: Layout) -> PixelSet {
        PixelSet { layout, tiles: vec![None; layout.tiles()] }
    }

    /// All pixels of some tiles.
    pub fn of_tiles(layout: Layout, tiles: impl IntoIterator<Item = usize>) -> PixelSet {
        let mut set = PixelSet::new(layout);
        for tile in tiles {
            set.add(tile, &[u16::MAX; TILE_BLOCKS]);
        }
        set
    }

    /// Adds pixels of a tile; lanes without a pixel are left out.
    pub fn add(&mut self, tile: usize, lanes: &Lanes) {
        let [columns, rows] = self.layout.grid();
        let at_edge = tile % columns == columns - 1 || tile / columns == rows - 1;
        let mut own = self.tiles[tile].take().unwrap_or_else(|| Box::new([0; TILE_BLOCKS]));
        for (block, (own, lanes)) in own.iter_mut().zip(lanes).enumerate() {
            let covered = if at_edge { self.layout.lanes(tile, block) } else { u16::MAX };
            *own |= lanes & covered;
        }
        self.tiles[tile] = own.iter().any(|&lanes| lanes != 0).then_some(own);
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.tiles.iter().all(Option::is_none)
    }

    /// Those of a tile, if there are any.
    pub fn tile(&self, tile: usize) -> Option<&Lanes> {
        self.tiles[tile].as_deref()
    }

    /// The tiles that have any, rising, with theirs.
    pub fn tiles(&self) -> impl Iterator<Item = (usize, &Lanes)> {
        self.tiles.iter().enumerate().filter_map(|(tile, lanes)| Some((tile, lanes.as_deref()?)))
    }

    /// The place of each.
    pub fn places(&self) -> impl Iterator<Item = Place> {
        let blocks = |tile| (0..TILE_BLOCKS).map(move |block| (tile, block));
        let blocks = self.tiles().flat_map(move |(tile, _)| blocks(tile));
        blocks.flat_map(|(tile, block)| self.places_of(tile, block))
    }

    /// The places of those in a block.
    pub fn places_of(&self, tile: usize, block: usize) -> impl Iterator<Item = Place> {
        let lanes = self.tile(tile).map_or(0, |lanes| lanes[block]);
        let set = (0..LANES).filter(move |lane| lanes >> lane & 1 != 0);
        set.map(move |lane| Place { tile, block, lane })
    }

    /// Adds one pixel.
    pub fn insert(&mut self, Place { tile, block, lane }: Place) {
        let own = self.tiles[tile].get_or_insert_with(|| Box::new([0; TILE_BLOCKS]));
        own[block] |= 1 << lane;
    }

    /// They and their eight neighbours.
    pub fn widened(&self) -> PixelSet {
        let [columns, rows] = self.layout.grid();
        let own: Vec<Option<Box<Rows>>> =
            self.tiles.iter().map(|lanes| lanes.as_deref().map(rows_of)).collect();
        let at = |column: usize, row: usize| match column < columns && row < rows {
            true => own[row * columns + column].as_deref(),
            false => None,
        };
        let mut set = PixelSet::new(self.layout);
        for tile in 0..own.len() {
            let (column, row) = (tile % columns, tile / columns);
            // Of a column of tiles the row y, from that above this tile to that below it.
            let line = |column: usize, y: usize| match y {
                0 => at(column, row.wrapping_sub(1)).map_or(0, |rows| rows[ROWS - 1]),
                y if y <= ROWS => at(column, row).map_or(0, |rows| rows[y - 1]),
                _ => at(column, row + 1).map_or(0, |rows| rows[0]),
            };
            let wide = |y: usize| {
                let [left, own, right] =
                    [column.wrapping_sub(1), column, column + 1].map(|c| line(c, y));
                own | own << 1 | own >> 1 | left >> (TILE - 1) | right << (TILE - 1)
            };
            let wide: [u32; ROWS + 2] = std::array::from_fn(wide);
            if wide.iter().any(|&row| row != 0) {
                let tall: Rows = std::array::from_fn(|y| wide[y] | wide[y + 1] | wide[y + 2]);
                set.add(tile, &lanes_of(&tall));
            }
        }
        set
    }
}

const ROWS: usize = TILE as usize;
/// The rows of a tile, from above: bit x for column x.
type Rows = [u32; ROWS];

/// Where a lane's row of four stands: the row of the tile, and by how many bits it is shifted.
fn place(block: usize, row: u32) -> (usize, u32) {
    let block = block as u32;
    ((block / (TILE / BLOCK) * BLOCK + row) as usize, block % (TILE / BLOCK) * BLOCK)
}

fn rows_of(lanes: &Lanes) -> Box<Rows> {
    let mut rows = Box::new([0; ROWS]);
    for (block, &lanes) in lanes.iter().enumerate() {
        for row in 0..LANES as u32 / BLOCK {
            let (y, shift) = place(block, row);
            rows[y] |= (u32::from(lanes) >> (row * BLOCK) & 0xf) << shift;
        }
    }
    rows
}

fn lanes_of(rows: &Rows) -> Lanes {
    std::array::from_fn(|block| {
        (0..LANES as u32 / BLOCK).fold(0, |lanes, row| {
            let (y, shift) = place(block, row);
            lanes | ((rows[y] >> shift & 0xf) as u16) << (row * BLOCK)
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn set_of(layout: Layout, pixels: &[[u32; 2]]) -> PixelSet {
        let mut set = PixelSet::new(layout);
        for &pixel in pixels {
            set.insert(layout.place(pixel));
        }
        set
    }

    #[test]
    fn a_set_is_widened_by_one_pixel_over_all_borders_and_not_over_the_edge() {
        let layout = Layout::new([75, 70]);
        let centres: [[u32; 2]; 7] =
            [[0, 0], [31, 31], [32, 40], [63, 32], [74, 69], [40, 64], [10, 69]];
        for centre in centres {
            let mut near = Vec::new();
            for y in centre[1].saturating_sub(1)..=(centre[1] + 1).min(69) {
                near.extend(
                    (centre[0].saturating_sub(1)..=(centre[0] + 1).min(74)).map(|x| [x, y]),
                );
            }
            let wide = set_of(layout, &[centre]).widened();
            assert_eq!(wide, set_of(layout, &near), "{centre:?}");
        }
        let all = PixelSet::of_tiles(layout, 0..layout.tiles());
        assert_eq!(all.widened(), all);
        assert!(PixelSet::new(layout).widened().is_empty());
    }
}
