//! How many samples every pixel gets where sampling is adaptive.

use super::grow::Grower;
use super::signature::{PILOTS, Signature, Solids};
use super::tree::TileTrees;
use crate::film::Frame;
use crate::film::layout::{LANES, Layout, Place, TILE_BLOCKS};

/// Places of a tile for pixels.
const TILE_PLACES: usize = TILE_BLOCKS * LANES;

/// What is known of some tiles' pixels, by block and lane.
type Tiles<T> = Vec<Option<Box<[T; TILE_PLACES]>>>;

/// The number of samples of every pixel of some tiles: [`PILOTS`] or all.
///
/// A function of the scene: it follows from what the pixels' first samples saw, and their
/// neighbours'. Written by `session` before it traces, read by `grow` and `fold`.
#[derive(Clone, Debug, PartialEq)]
pub struct SampleMap {
    samples: u32,
    tiles: Tiles<u16>,
}

/// What the first samples of some tiles' pixels saw.
#[derive(Clone, Debug)]
pub struct Signatures {
    layout: Layout,
    tiles: Tiles<Signature>,
}

impl SampleMap {
    /// [`PILOTS`] for every pixel.
    pub fn of_pilots(layout: Layout) -> SampleMap {
        let tile = || Some(Box::new([PILOTS as u16; TILE_PLACES]));
        SampleMap { samples: PILOTS, tiles: (0..layout.tiles()).map(|_| tile()).collect() }
    }

    /// The numbers of a whole picture, tile after tile, for files.
    pub fn to_list(&self) -> Vec<u16> {
        self.tiles.iter().flatten().flat_map(|tile| tile.iter().copied()).collect()
    }

    /// What [`SampleMap::to_list`] gave of a picture where a pixel has at most `samples`; `None` if it
    /// cannot have given it.
    pub fn from_list(layout: Layout, samples: u32, list: &[u16]) -> Option<SampleMap> {
        let known = |&count: &u16| [PILOTS, samples].contains(&u32::from(count));
        if list.len() != layout.tiles() * TILE_PLACES || !list.iter().all(known) {
            return None;
        }
        let tile = |tile: &[u16]| <[u16; TILE_PLACES]>::try_from(tile).ok().map(Box::new);
        Some(SampleMap { samples, tiles: list.chunks(TILE_PLACES).map(tile).collect() })
    }

    /// A picture of it: white where a pixel has all samples, darker with fewer.
    pub fn picture(&self, layout: Layout) -> Frame {
        let mut frame = Frame::new(layout.size);
        let [width, height] = layout.size;
        let pixels = (0..height).flat_map(|y| (0..width).map(move |x| [x, y]));
        for (pixel, bytes) in pixels.zip(frame.bytes.chunks_exact_mut(4)) {
            let level = (255 * self.of(layout.place(pixel)) / self.samples) as u8;
            bytes.copy_from_slice(&[level, level, level, 255]);
        }
        frame
    }

    /// The numbers of a tile's pixels, by block and lane.
    pub fn tile(&self, tile: usize) -> &[u16] {
        self.tiles[tile].as_ref().map_or(&[], |tile| tile.as_slice())
    }

    /// Samples of a pixel that has all of them.
    pub fn most(&self) -> u32 {
        self.samples
    }

    /// Samples of a pixel.
    ///
    /// # Panics
    /// If nothing is known of its tile.
    #[inline(always)]
    pub fn of(&self, Place { tile, block, lane }: Place) -> u32 {
        let counts = self.tiles[tile].as_ref().expect("the counts of a tile to be grown");
        u32::from(counts[block * LANES + lane])
    }
}

impl Signatures {
    /// Nothing is known yet.
    pub fn new(layout: Layout) -> Signatures {
        Signatures { layout, tiles: vec![None; layout.tiles()] }
    }

    /// Notes what was found in a tile, block after block.
    pub fn put(&mut self, tile: usize, found: &[Signature]) {
        let mut own = Box::new([Signature::default(); TILE_PLACES]);
        own.copy_from_slice(found);
        self.tiles[tile] = Some(own);
    }

    fn of(&self, pixel: [u32; 2]) -> Option<Signature> {
        let Place { tile, block, lane } = self.layout.place(pixel);
        self.tiles[tile].as_ref().map(|tile| tile[block * LANES + lane])
    }

    /// Decides for some tiles, whose neighbours are known too: a pixel gets all samples if its own
    /// first ones differ, or differ from those of any of its eight neighbours, or if `thin` says so.
    pub fn decide(
        &self,
        tiles: &[usize],
        samples: u32,
        step: f32,
        thin: impl Fn([u32; 2]) -> bool,
    ) -> SampleMap {
        let mut map = SampleMap { samples, tiles: vec![None; self.layout.tiles()] };
        for &tile in tiles {
            let mut counts = Box::new([PILOTS as u16; TILE_PLACES]);
            for block in 0..TILE_BLOCKS {
                for lane in 0..LANES {
                    let pixel = self.layout.pixel(Place { tile, block, lane });
                    if pixel.is_some_and(|pixel| thin(pixel) || self.is_busy(pixel, step)) {
                        counts[block * LANES + lane] = samples as u16;
                    }
                }
            }
            map.tiles[tile] = Some(counts);
        }
        map
    }

    fn is_busy(&self, pixel: [u32; 2], step: f32) -> bool {
        let Some(own) = self.of(pixel) else { return false };
        own.is_mixed(step)
            || neighbours(pixel, self.layout.size)
                .any(|other| self.of(other).is_some_and(|other| own.differs(other, step)))
    }
}

/// The pixels beside and at the corners of a pixel, and itself.
fn neighbours([x, y]: [u32; 2], [width, height]: [u32; 2]) -> impl Iterator<Item = [u32; 2]> {
    let rows = y.saturating_sub(1)..=(y + 1).min(height - 1);
    rows.flat_map(move |y| (x.saturating_sub(1)..=(x + 1).min(width - 1)).map(move |x| [x, y]))
}

impl<'a> Grower<'a> {
    /// The same where pixels have their own numbers of samples.
    pub fn with_map(mut self, map: Option<&'a SampleMap>) -> Grower<'a> {
        self.map = map;
        self
    }

    /// Whether pixels have their own numbers of samples.
    pub fn is_adaptive(&self) -> bool {
        self.map.is_some()
    }

    /// The number of samples of every lane of a block: 0 where there is no pixel.
    pub fn counts(&self, (tile, block): (usize, usize)) -> [u32; LANES] {
        let covered = self.layout.covered(tile, block);
        std::array::from_fn(|lane| match (covered[lane], self.map) {
            (false, _) => 0,
            (true, None) => self.samples,
            (true, Some(map)) => map.of(Place { tile, block, lane }),
        })
    }

    /// What the first samples of a block just grown saw, all lanes having [`PILOTS`].
    pub fn signatures(&self, grown: &TileTrees, at: (usize, usize)) -> [Signature; LANES] {
        let mut reader = grown.read(0);
        self.counts(at).map(|count| Signature::read(&mut reader, count, self))
    }
}

impl Solids for Grower<'_> {
    fn solid(&self, primitive: u32) -> u32 {
        self.geometry.solid(primitive)
    }

    fn is_opaque(&self, solid: u32) -> bool {
        self.opaque[solid as usize]
    }
}
