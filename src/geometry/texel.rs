//! Reads an image at a point of u-v: between texels, and between its levels by the footprint.

use super::uv::Uv;
use crate::scene::texture::Image;

/// The image where it covers `size` × `size` in u-v, seen through a footprint of this width in the
/// world: bilinear within a level, linear between the two levels whose texels are next to the
/// footprint's larger extent in u or v.
///
/// u runs to the right, v up; the image is repeated, but not across a sphere's poles.
pub(super) fn sample(image: &Image, uv: &Uv, size: f64, footprint: f64) -> [f64; 3] {
    let width = |axis: usize| footprint * uv.gradients[axis].length() / size;
    read(image, uv.at.map(|c| c / size), [width(0), width(1)], uv.poles.then(|| 1.0 / size))
}

/// The same in units of the image, and of a width there; `end` is where v ends, if it does.
pub(super) fn read(image: &Image, at: [f64; 2], widths: [f64; 2], end: Option<f64>) -> [f64; 3] {
    let [columns, rows] = image.size().map(f64::from);
    let texels = (widths[0] * columns).max(widths[1] * rows);
    let coarsest = (image.levels() - 1) as f64;
    let level = match texels < 1.0 {
        true => 0.0,
        false => libm::log2(texels).min(coarsest),
    };
    let fine = level.floor();
    let between = level - fine;
    let first = bilinear(image, fine as usize, at, end);
    if between == 0.0 {
        return first;
    }
    let second = bilinear(image, fine as usize + 1, at, end);
    std::array::from_fn(|c| first[c] + (second[c] - first[c]) * between)
}

fn bilinear(image: &Image, level: usize, [u, v]: [f64; 2], end: Option<f64>) -> [f64; 3] {
    let size @ [columns, rows] = image.size_of(level);
    let [width, height] = size.map(f64::from);
    let v = match end {
        Some(end) => {
            let half = (0.5 / height).min(end / 2.0);
            v.max(half).min(end - half)
        }
        None => v,
    };
    // Row 0 is the image's upper edge.
    let (left, across) = split(u * width - 0.5, columns);
    let (upper, down) = split(-v * height - 0.5, rows);
    let (right, lower) = ((left + 1) % columns, (upper + 1) % rows);
    let texel = |x, y| image.texel(level, [x, y]).map(f64::from);
    let mix = |a: [f64; 3], b: [f64; 3], t: f64| std::array::from_fn(|c| a[c] + (b[c] - a[c]) * t);
    let above = mix(texel(left, upper), texel(right, upper), across);
    mix(above, mix(texel(left, lower), texel(right, lower), across), down)
}

/// The texel at or before `x` in a row that repeats, and the way to the next one.
fn split(x: f64, count: u32) -> (u32, f64) {
    let floor = x.floor();
    let index = floor.rem_euclid(f64::from(count));
    // Not a number becomes 0; rounding may give `count` itself.
    let index = (index as u32) % count;
    let way = x - floor;
    (index, if way > 0.0 { way } else { 0.0 })
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;

    /// Columns 0 … 3 have red 0, 1, 2, 3; rows 0, 1 (upper, lower) green 0, 1.
    fn image() -> Image {
        let texel = |i: u32| [(i % 4) as f32, (i / 4) as f32, 0.5];
        Image::of_floats([4, 2], (0..8).map(texel).collect())
    }

    fn at(u: f64, v: f64) -> [f64; 3] {
        read(&image(), [u, v], [0.0; 2], None)
    }

    #[test]
    fn texels_are_met_in_their_middle_and_mixed_between() {
        assert_eq!(at(0.125, 0.75), [0.0, 0.0, 0.5]);
        assert_eq!(at(0.875, 0.25), [3.0, 1.0, 0.5]);
        assert_eq!(at(0.25, 0.75), [0.5, 0.0, 0.5]);
        assert_eq!(at(0.375, 0.5), [1.0, 0.5, 0.5]);
    }

    #[test]
    fn it_repeats_without_a_seam() {
        for (u, v) in [(0.3, 0.6), (0.0, 0.0), (0.99, 0.01)] {
            for (du, dv) in [(1.0, 0.0), (-2.0, 5.0), (0.0, -1.0)] {
                let (a, b) = (at(u, v), at(u + du, v + dv));
                assert!((0..3).all(|c| (a[c] - b[c]).abs() < 1e-12), "{a:?} {b:?}");
            }
        }
        assert_eq!(at(0.0, 0.75), [1.5, 0.0, 0.5], "the last column and the first one");
    }

    #[test]
    fn poles_do_not_see_the_other_pole() {
        let end = Some(1.0);
        assert_eq!(read(&image(), [0.125, 1.0], [0.0; 2], end)[1], 0.0);
        assert_eq!(read(&image(), [0.125, 0.0], [0.0; 2], end)[1], 1.0);
        assert_eq!(at(0.125, 1.0)[1], 0.5);
    }

    #[test]
    fn the_footprint_chooses_the_level() {
        let texel = |i: u32| [((i % 64 + i / 64) % 2) as f32; 3];
        let board = Image::of_floats([64, 64], (0..4096).map(texel).collect());
        let seen = |texels: f64| read(&board, [0.5 / 64.0; 2], [texels / 64.0; 2], None)[0];
        assert_eq!((seen(0.0), seen(1.0)), (1.0, 1.0));
        assert_eq!((seen(2.0), seen(4.0), seen(1e9), seen(f64::INFINITY)), (0.5, 0.5, 0.5, 0.5));
        assert!((seen(2f64.sqrt()) - 0.75).abs() < 1e-12, "half way between two levels");
        // The larger extent decides.
        assert_eq!(read(&board, [0.5 / 64.0; 2], [0.0, 2.0 / 64.0], None)[0], 0.5);
    }

    #[test]
    fn the_size_is_that_of_one_image_in_uv() {
        let uv = |u, v| Uv { at: [u, v], gradients: [DVec3::X, DVec3::Y], poles: false };
        assert_eq!(sample(&image(), &uv(0.25, 1.5), 2.0, 0.0), [0.0, 0.0, 0.5]);
        // One unit of u is a half image, two texels: a footprint of 1 reads level 1.
        let coarse = sample(&image(), &uv(0.5, 1.0), 2.0, 1.0);
        assert_eq!(coarse[0], 0.5);
    }

    #[test]
    fn odd_places_give_texels() {
        for x in [f64::NAN, f64::INFINITY, -1e300, 1e16] {
            assert!(at(x, x).iter().all(|c| (0.0..=3.0).contains(c)));
            assert!(read(&image(), [0.1, x], [x, 0.0], Some(1.0)).iter().all(|c| c.is_finite()));
        }
    }
}
