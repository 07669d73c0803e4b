//! How a matrix is cut for a graphics card, and which bytes of it lie where.

use std::ops::Range;
use std::sync::{Arc, Weak};

use crate::film::layout::{Layout, TILE, TILE_BLOCKS};
use crate::fold::transport::{BlockStart, Plane, Single, Transport, TransportTile};

/// What a graphics card takes at most.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Bytes of one binding.
    pub binding: u64,
    /// Tiles of one dispatch.
    pub tiles: u32,
    /// Longest side of a texture in pixels.
    pub texture_side: u32,
}

/// What the shader reads as a struct: members of four bytes each, one after another.
pub(super) trait Record: Sized {
    /// Name of the struct here and in the shader.
    #[cfg(test)]
    const NAME: &'static str;
    /// Names of its members and where they lie.
    #[cfg(test)]
    const MEMBERS: &'static [(&'static str, usize)];
    /// Appends its bytes.
    fn write(&self, out: &mut Vec<u8>);
}

/// Implements [`Record`] of one list of members: it cannot forget one, nor change their order.
macro_rules! record {
    ($name:ident { $($member:ident),* }) => {
        impl Record for $name {
            #[cfg(test)]
            const NAME: &'static str = stringify!($name);
            #[cfg(test)]
            const MEMBERS: &'static [(&'static str, usize)] =
                &[$((stringify!($member), std::mem::offset_of!($name, $member))),*];
            fn write(&self, out: &mut Vec<u8>) {
                let $name { $($member),* } = self;
                $(out.extend($member.to_le_bytes());)*
            }
        }
    };
}

/// What is shown of the light.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub(super) struct Look {
    /// Factor of the exposure.
    pub(super) gain: f32,
    /// Index of the tone curve.
    pub(super) tone: u32,
    /// Whether clipped pixels are marked: 0 or 1.
    pub(super) marks: u32,
}

/// The first pixel of a tile, counted from the corner of its texture.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub(super) struct Corner {
    pub(super) x: u32,
    pub(super) y: u32,
}

record!(Look { gain, tone, marks });
record!(Corner { x, y });
record!(BlockStart { plane, single });
record!(Single { place, coefficient });

/// A rectangle of the picture that is one texture, its corner a tile's.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Piece {
    /// Left and upper edge in pixels.
    pub corner: [u32; 2],
    /// Width and height in pixels.
    pub size: [u32; 2],
}

/// Cuts a picture into textures, row by row.
pub(super) fn pieces(size: [u32; 2], limits: Limits) -> Vec<Piece> {
    // Whole tiles; a card that cannot hold one does not exist.
    let side = (limits.texture_side / TILE * TILE).max(TILE);
    let mut pieces = Vec::new();
    for y in (0..size[1]).step_by(side as usize) {
        for x in (0..size[0]).step_by(side as usize) {
            let size = [side.min(size[0] - x), side.min(size[1] - y)];
            pieces.push(Piece { corner: [x, y], size });
        }
    }
    pieces
}

/// The arrays of a part that grow with the matrix.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Starts,
    Entries,
    Planes,
    Singles,
}

impl Kind {
    /// Every one, in the order of the shader's bindings.
    pub(super) const ALL: [Kind; 4] = [Kind::Starts, Kind::Entries, Kind::Planes, Kind::Singles];
}

/// How many elements a tile has in each array.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Counts {
    planes: usize,
    singles: usize,
}

impl Counts {
    fn of(tile: &TransportTile) -> Counts {
        Counts { planes: tile.planes.len(), singles: tile.singles.len() }
    }

    fn bytes(self, kind: Kind) -> u64 {
        let bytes = match kind {
            Kind::Starts => (TILE_BLOCKS + 1) * size_of::<BlockStart>(),
            Kind::Entries => self.planes * size_of::<u32>(),
            Kind::Planes => self.planes * size_of::<Plane>(),
            Kind::Singles => self.singles * size_of::<Single>(),
        };
        bytes as u64
    }
}

/// Some tiles of one piece, whose arrays and light each fit a binding.
#[derive(Clone, Debug)]
pub(super) struct Part {
    /// Index of its piece.
    pub(super) piece: usize,
    /// Its tiles, in the order of its arrays.
    pub(super) tiles: Vec<usize>,
    /// Which of the matrix each was when its bytes were written. The tile itself is not kept: whoever
    /// changes it would have to copy it first.
    known: Vec<Weak<TransportTile>>,
    counts: Vec<Counts>,
    /// Per tile where its bytes begin in each array, and the end.
    begins: Vec<[u64; 4]>,
}

/// Bytes of a tile's light.
pub(super) const LIGHT: u64 = (TILE_BLOCKS * size_of::<crate::film::FilmBlock>()) as u64;

/// Cuts a matrix into parts; `None` if a tile alone is too large.
pub(super) fn parts(transport: &Transport, pieces: &[Piece], limits: Limits) -> Option<Vec<Part>> {
    let mut parts = Vec::new();
    let columns = transport.layout.grid()[0];
    for (index, piece) in pieces.iter().enumerate() {
        let mut part = Part::new(index);
        let [left, top] = piece.corner.map(|c| (c / TILE) as usize);
        let [wide, tall] = Layout::new(piece.size).grid();
        let rows = (top..top + tall).flat_map(|y| (left..left + wide).map(move |x| (x, y)));
        for tile in rows.map(|(x, y)| y * columns + x) {
            let own = &transport.tiles[tile];
            if !part.takes(own, limits) {
                parts.push(std::mem::replace(&mut part, Part::new(index)));
                if !part.takes(own, limits) {
                    return None;
                }
            }
            part.add(tile, own);
        }
        parts.push(part);
    }
    Some(parts)
}

impl Part {
    fn new(piece: usize) -> Part {
        let (tiles, known, counts) = (Vec::new(), Vec::new(), Vec::new());
        Part { piece, tiles, known, counts, begins: vec![[0; 4]] }
    }

    fn end(&self) -> [u64; 4] {
        self.begins[self.begins.len() - 1]
    }

    /// Where its bytes would end with another tile.
    fn end_with(&self, counts: Counts) -> [u64; 4] {
        let (end, mut kinds) = (self.end(), Kind::ALL.into_iter());
        end.map(|at| at + kinds.next().map_or(0, |kind| counts.bytes(kind)))
    }

    fn takes(&self, tile: &TransportTile, limits: Limits) -> bool {
        let tiles = self.tiles.len() as u64 + 1;
        let fits = |bytes: u64| bytes <= limits.binding;
        let arrays = self.end_with(Counts::of(tile)).into_iter().all(fits);
        arrays && fits(tiles * LIGHT) && tiles <= u64::from(limits.tiles)
    }

    fn add(&mut self, index: usize, tile: &Arc<TransportTile>) {
        let counts = Counts::of(tile);
        self.begins.push(self.end_with(counts));
        self.tiles.push(index);
        self.known.push(Arc::downgrade(tile));
        self.counts.push(counts);
    }

    /// Bytes of an array.
    pub(super) fn bytes(&self, kind: Kind) -> u64 {
        self.end()[kind as usize]
    }

    /// Where the bytes of some tiles lie in an array.
    pub(super) fn place(&self, kind: Kind, tiles: &Range<usize>) -> Range<u64> {
        self.begins[tiles.start][kind as usize]..self.begins[tiles.end][kind as usize]
    }

    /// Appends an array's bytes of some tiles, counted within the part.
    pub(super) fn write(
        &self,
        kind: Kind,
        tiles: Range<usize>,
        transport: &Transport,
        out: &mut Vec<u8>,
    ) {
        for at in tiles {
            let tile = &transport.tiles[self.tiles[at]];
            match kind {
                Kind::Starts => self.write_starts(at, tile, out),
                Kind::Entries => {
                    let terms = tile.entries.iter().map(|&entry| tile.terms[entry as usize]);
                    out.extend(terms.flat_map(u32::to_le_bytes));
                }
                Kind::Planes => tile.planes.iter().for_each(|Plane(plane)| {
                    plane.iter().for_each(|c| out.extend_from_slice(&c.to_le_bytes()));
                }),
                Kind::Singles => tile.singles.iter().for_each(|single| {
                    let term = tile.terms[single.entry()];
                    Single::new(term, single.lane(), single.coefficient).write(out);
                }),
            }
        }
    }

    fn write_starts(&self, at: usize, tile: &TransportTile, out: &mut Vec<u8>) {
        let first = |kind: Kind, each: usize| (self.begins[at][kind as usize] / each as u64) as u32;
        let plane = first(Kind::Planes, size_of::<Plane>());
        let single = first(Kind::Singles, size_of::<Single>());
        for start in &tile.starts {
            let BlockStart { plane: p, single: s } = start;
            BlockStart { plane: plane + p, single: single + s }.write(out);
        }
    }

    /// The corners of its tiles, as bytes.
    pub(super) fn corners(&self, layout: Layout, piece: &Piece) -> Vec<u8> {
        let columns = layout.grid()[0];
        let mut out = Vec::new();
        for &tile in &self.tiles {
            let [x, y] = [tile % columns, tile / columns].map(|n| n as u32 * TILE);
            Corner { x: x - piece.corner[0], y: y - piece.corner[1] }.write(&mut out);
        }
        out
    }

    /// Whether every tile takes as many bytes as it did.
    pub(super) fn fits(&self, transport: &Transport) -> bool {
        let tiles = self.tiles.iter().map(|&tile| transport.tiles.get(tile));
        tiles.zip(&self.counts).all(|(tile, c)| tile.is_some_and(|t| Counts::of(t) == *c))
    }

    /// Notes which tiles the matrix has now, and gives those that it did not have, as runs.
    pub(super) fn renew(&mut self, transport: &Transport) -> Vec<Range<usize>> {
        let mut runs: Vec<Range<usize>> = Vec::new();
        for (at, &tile) in self.tiles.iter().enumerate() {
            let tile = &transport.tiles[tile];
            // An allocation that is watched is never used for another tile, nor changed in place.
            if std::ptr::eq(self.known[at].as_ptr(), Arc::as_ptr(tile)) {
                continue;
            }
            self.known[at] = Arc::downgrade(tile);
            match runs.last_mut() {
                Some(run) if run.end == at => run.end = at + 1,
                _ => runs.push(at..at + 1),
            }
        }
        runs
    }
}
