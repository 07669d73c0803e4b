//! What a ray sees that leaves the scene, by its direction.

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use glam::DVec3;

use super::compile::exact_normalize;
use super::texel;
use super::tone::Tone;
use super::uv::longitude_latitude;
use crate::color::Rgb;
use crate::scene::Background;
use crate::scene::texture::Image;

/// A background made ready.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) enum Sky {
    /// One colour.
    #[default]
    Even,
    /// `up` is of length 1.
    Gradient { up: DVec3 },
    /// `turn` is a share of a whole turn.
    Image { image: Arc<Image>, turn: f64 },
}

impl Sky {
    pub(super) fn of(background: &Background) -> Sky {
        match background {
            Background::Color(_) => Sky::Even,
            Background::Gradient { below: _, level: _, above: _, up } => {
                Sky::Gradient { up: exact_normalize(*up) }
            }
            Background::Image { image, tint: _, turn_degrees } => {
                let turn = turn_degrees.rem_euclid(360.0) / 360.0;
                Sky::Image { image: Arc::clone(&image.image), turn }
            }
        }
    }

    /// The tone in a unit direction, of which a cone `angle` radians wide is looked at; `None` of one
    /// colour.
    pub(super) fn tone(&self, direction: DVec3, angle: f64) -> Option<Tone> {
        match self {
            Sky::Even => None,
            Sky::Gradient { up } => {
                let height = direction.dot(*up).clamp(-1.0, 1.0);
                let (slot, share) = if height < 0.0 { (0, 1.0 + height) } else { (1, height) };
                Some(Tone::Blend { slot, share: share as f32 })
            }
            Sky::Image { image, turn } => {
                let flat = (direction.x * direction.x + direction.y * direction.y).sqrt();
                let [longitude, v] = longitude_latitude(direction, flat);
                // Seen from inside, longitudes grow to the left.
                let u = 0.75 - longitude + *turn;
                let widths = [angle / (TAU * flat), angle / PI];
                let texel = texel::read(image, [u, v], widths, Some(1.0));
                Some(Tone::Texel(Rgb(texel.map(|c| c as f32))))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::ImageFile;

    #[test]
    fn a_gradient_has_its_colours_at_the_poles_and_between() {
        let sky = Sky::of(&Background::named("gradient"));
        for (direction, slot, share) in [
            (DVec3::Z, 1, 1.0),
            (DVec3::Y, 1, 0.0),
            (-DVec3::Z, 0, 0.0),
            (DVec3::new(0.6, 0.0, -0.8), 0, 0.2),
            (DVec3::new(0.0, 0.6, 0.8), 1, 0.8),
        ] {
            let Some(Tone::Blend { slot: s, share: found }) = sky.tone(direction, 0.0) else {
                panic!("a blend");
            };
            assert!(s == slot && (found - share).abs() < 1e-7, "{direction}: {s} {found}");
        }
        assert_eq!(Sky::of(&Background::default()).tone(DVec3::X, 0.0), None);
    }

    /// Columns count from the left, rows from above.
    fn panorama(turn_degrees: f64) -> Sky {
        let texel = |i: u32| [(i % 8) as f32, (i / 8) as f32, 0.0];
        let image = Arc::new(Image::of_floats([8, 4], (0..32).map(texel).collect()));
        let image = ImageFile { file: "sky.hdr".into(), image };
        Sky::of(&Background::Image { image, tint: Rgb::WHITE, turn_degrees })
    }

    fn seen(sky: &Sky, direction: DVec3) -> [f32; 2] {
        match sky.tone(direction.normalize(), 0.0) {
            Some(Tone::Texel(Rgb([column, row, _]))) => [column, row],
            tone => panic!("{tone:?}"),
        }
    }

    #[test]
    fn a_panorama_has_y_in_its_middle_and_x_to_the_right() {
        let sky = panorama(0.0);
        let at = |direction| seen(&sky, direction).map(|x| (x * 1e4).round() / 1e4);
        assert_eq!(at(DVec3::Y), [3.5, 1.5]);
        assert_eq!(at(DVec3::X), [5.5, 1.5]);
        assert_eq!(at(-DVec3::X), [1.5, 1.5]);
        assert_eq!(at(DVec3::Z)[1], 0.0);
        assert_eq!(at(-DVec3::Z)[1], 3.0);
        // Turned to the left by a quarter, +x is where +y was.
        let turned = panorama(90.0);
        assert!((seen(&turned, DVec3::Y)[0] - 5.5).abs() < 1e-4);
    }

    #[test]
    fn the_seam_behind_is_none() {
        let sky = panorama(0.0);
        let (left, right) = (DVec3::new(-1e-9, -1.0, 0.3), DVec3::new(1e-9, -1.0, 0.3));
        let (a, b) = (seen(&sky, left), seen(&sky, right));
        assert!((a[0] - b[0]).abs() < 1e-4 && (a[1] - b[1]).abs() < 1e-4, "{a:?} {b:?}");
        assert!((a[0] - 3.5).abs() < 1e-4, "half of the first and half of the last column");
    }

    #[test]
    fn wide_cones_see_means() {
        let Some(Tone::Texel(Rgb([column, row, _]))) = panorama(0.0).tone(DVec3::Y, 10.0) else {
            panic!("a texel");
        };
        assert!((column - 3.5).abs() < 1e-4 && (row - 1.5).abs() < 1e-4);
    }
}
