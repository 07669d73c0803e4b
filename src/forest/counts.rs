//! How many samples every pixel gets where sampling is adaptive.

use super::grow::Grower;
use super::signature::{PILOTS, Signature, Solids};
use super::thin::ThinPixels;
use super::tree::TileTrees;
use crate::film::Frame;
use crate::film::layout::{LANES, Layout, Place, TILE_BLOCKS};
use crate::film::pixels::PixelSet;

/// Places of a tile for pixels.
const TILE_PLACES: usize = TILE_BLOCKS * LANES;

/// What is known of some tiles' pixels, by block and lane.
type Tiles<T> = Vec<Option<Box<[T; TILE_PLACES]>>>;

/// The number of samples of every pixel of some tiles: [`PILOTS`], twice as many, and so on, or all.
///
/// A function of the scene: it follows from what the pixels' samples saw, and their neighbours' first
/// ones. Written by `session` before it traces, read by `grow` and `fold`.
#[derive(Clone, Debug, PartialEq)]
pub struct SampleMap {
    samples: u32,
    tiles: Tiles<u16>,
}

/// What the first samples of some pixels saw.
#[derive(Clone, Debug)]
pub struct Signatures {
    layout: Layout,
    tiles: Tiles<Signature>,
}

/// By what is decided how many samples pixels get.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rule {
    /// Samples of a pixel that has all of them.
    pub samples: u32,
    /// Numbers may differ by this much among the first samples.
    pub step: f32,
}

impl Rule {
    /// The number of samples of a pixel whose first `count` saw `own`.
    ///
    /// The more samples there are, the more they may differ: so does the error of their mean.
    pub fn verdict(self, own: Signature, count: u32) -> u32 {
        let step = self.step * (count as f32 / PILOTS as f32).sqrt();
        match () {
            () if own.is_torn() => self.samples,
            () if own.is_spread(step) => self.after(count),
            () => count,
        }
    }

    /// The number of samples after this one.
    pub fn after(self, count: u32) -> u32 {
        (2 * count).min(self.samples)
    }

    /// Whether some pixel may have so many.
    fn allows(self, count: u32) -> bool {
        count == self.samples
            || count < self.samples
                && (count / PILOTS).is_power_of_two()
                && count.is_multiple_of(PILOTS)
    }
}

impl SampleMap {
    /// Nothing is known of any tile; pixels have at most `samples`.
    pub fn unknown(layout: Layout, samples: u32) -> SampleMap {
        SampleMap { samples, tiles: vec![None; layout.tiles()] }
    }

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
        let rule = Rule { samples, step: 0.0 };
        let known = |&count: &u16| rule.allows(count.into());
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

    /// Gives a pixel so many samples; all others of a tile of which nothing was known have [`PILOTS`].
    pub fn set(&mut self, Place { tile, block, lane }: Place, count: u32) {
        let tile = &mut self.tiles[tile];
        let counts = tile.get_or_insert_with(|| Box::new([PILOTS as u16; TILE_PLACES]));
        counts[block * LANES + lane] = count as u16;
    }
}

impl Signatures {
    /// Nothing is known yet.
    pub fn new(layout: Layout) -> Signatures {
        Signatures { layout, tiles: vec![None; layout.tiles()] }
    }

    /// Notes what was found in a block.
    pub fn put(&mut self, (tile, block): (usize, usize), found: &[Signature; LANES]) {
        let tile = &mut self.tiles[tile];
        let own = tile.get_or_insert_with(|| Box::new([Signature::default(); TILE_PLACES]));
        own[block * LANES..][..LANES].copy_from_slice(found);
    }

    fn of(&self, pixel: [u32; 2]) -> Signature {
        let Place { tile, block, lane } = self.layout.place(pixel);
        let known = self.tiles[tile].as_ref().expect("signatures of all that is compared");
        known[block * LANES + lane]
    }

    /// Decides for some pixels, of which and of whose neighbours the first [`PILOTS`] samples are known:
    /// those whose own differ get more, and those that differ from any of their eight neighbours, or that
    /// see something thin.
    pub fn decide(&self, wanted: &PixelSet, rule: Rule, thin: &ThinPixels, map: &mut SampleMap) {
        for place in wanted.places() {
            let Some(pixel) = self.layout.pixel(place) else { continue };
            let own = self.of(pixel);
            let count = match rule.verdict(own, PILOTS) {
                _ if thin.contains(pixel) => rule.samples,
                PILOTS if self.stands_out(pixel, own, rule.step) => rule.after(PILOTS),
                count => count,
            };
            map.set(place, count);
        }
    }

    fn stands_out(&self, pixel: [u32; 2], own: Signature, step: f32) -> bool {
        neighbours(pixel, self.layout.size).any(|other| own.differs(self.of(other), step))
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

    /// The number of samples of a pixel.
    #[inline(always)]
    pub(super) fn count(&self, place: Place) -> u32 {
        self.map.map_or(self.samples, |map| map.of(place))
    }

    /// What the samples of a block just grown saw.
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
