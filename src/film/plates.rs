//! What a picture file may hold besides the picture: how much of a pixel is covered, layers, a region.

use super::Film;
use super::layout::{Layout, TILE};

/// A rectangle of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Region {
    /// Left and top, in pixels.
    pub corner: [u32; 2],
    /// Width and height, in pixels, at least 1.
    pub size: [u32; 2],
}

impl Region {
    /// What of it lies within a picture of this size, if anything does.
    pub fn within(self, size: [u32; 2]) -> Option<Region> {
        let Region { corner, size: own } = self;
        let side = |i: usize| own[i].min(size[i].saturating_sub(corner[i]));
        let region = Region { corner, size: [side(0), side(1)] };
        (region.size[0] > 0 && region.size[1] > 0).then_some(region)
    }

    /// The tiles of a picture that it touches; it must lie within.
    pub fn tiles(self, layout: Layout) -> Vec<usize> {
        let columns = layout.grid()[0];
        let Region { corner, size } = self;
        let side = |i: usize| {
            let last = corner[i] + size[i] - 1;
            (corner[i] / TILE) as usize..(last / TILE) as usize + 1
        };
        side(1).flat_map(|y| side(0).map(move |x| y * columns + x)).collect()
    }

    /// Whether it lies within a picture of this size; if not, what is wrong, and a way out.
    pub fn check(self, [width, height]: [u32; 2]) -> Result<(), String> {
        let Region { corner: [x, y], size: [w, h] } = self;
        let ends = |from: u32, side: u32, whole: u32| {
            side > 0 && u64::from(from) + u64::from(side) <= u64::from(whole)
        };
        if ends(x, w, width) && ends(y, h, height) {
            return Ok(());
        }
        Err(format!(
            "the region {x},{y} {w}×{h} is not within the picture\n  \
             help: the picture has {width}×{height} pixels, counted from the upper left"
        ))
    }
}

/// A part of the picture's light; its name is that of its channels, as in `light.key`.
#[derive(Clone, Debug, PartialEq)]
pub struct Layer {
    /// Without `.R`, `.G`, `.B`.
    pub name: String,
    /// Its light.
    pub film: Film,
}

/// The content of a picture file. All films have one size.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Plates {
    /// The picture; without what is seen of the background where `coverage` is given.
    pub film: Film,
    /// How much of a pixel is not background, in all channels; less than 0 and more than 1 where the
    /// reconstruction filter has negative weights.
    pub coverage: Option<Film>,
    /// Parts of the picture, for EXR. Those whose names begin alike add up to it.
    pub layers: Vec<Layer>,
}

impl Plates {
    /// A picture and nothing else.
    pub fn of(film: Film) -> Plates {
        Plates { film, ..Plates::default() }
    }

    /// What lies in a region, which must be within the picture.
    pub fn cropped(self, region: Region) -> Plates {
        let crop = |film: Film| film.cropped(region);
        let layer = |Layer { name, film }: Layer| Layer { name, film: crop(film) };
        Plates {
            film: crop(self.film),
            coverage: self.coverage.map(crop),
            layers: self.layers.into_iter().map(layer).collect(),
        }
    }

    /// How much of a pixel is covered, 0 … 1; all of it where nobody asked.
    pub fn alpha(&self, pixel: [u32; 2]) -> f32 {
        self.coverage.as_ref().map_or(1.0, |film| film.pixel(pixel).0[0].clamp(0.0, 1.0))
    }
}

impl Film {
    /// A rectangle of it, which must be within it.
    fn cropped(&self, Region { corner: [x, y], size }: Region) -> Film {
        let mut film = Film::new(Layout::new(size));
        for row in 0..size[1] {
            for column in 0..size[0] {
                film.put([column, row], self.pixel([x + column, y + row]));
            }
        }
        film
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::color::Rgb;

    #[test]
    fn a_region_holds_its_pixels() {
        let mut film = Film::new(Layout::new([40, 37]));
        for y in 0..37 {
            for x in 0..40 {
                film.put([x, y], Rgb([x as f32, y as f32, 1.0]));
            }
        }
        let region = Region { corner: [3, 30], size: [35, 7] };
        assert_eq!(region.check([40, 37]), Ok(()));
        let part = film.cropped(region);
        assert_eq!(part.layout.size, [35, 7]);
        assert_eq!(part.pixel([0, 0]), Rgb([3.0, 30.0, 1.0]));
        assert_eq!(part.pixel([34, 6]), Rgb([37.0, 36.0, 1.0]));
        for (corner, size) in [([6, 0], [35, 1]), ([0, 0], [0, 5]), ([u32::MAX, 0], [2, 2])] {
            assert!(Region { corner, size }.check([40, 37]).is_err(), "{corner:?} {size:?}");
        }
    }
}
