//! Unevenness of a surface: the gradient of a height, by which its shading normal is bent.

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use glam::DVec3;

use super::noise::fractal;
use super::texel;
use super::uv::Uv;
use crate::scene::Bump;
use crate::scene::texture::Image;

/// A height over a surface, made ready; lengths in world units.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Relief {
    /// None, or of height 0: the same.
    Flat,
    Noise {
        height: f64,
        scale: f64,
    },
    Waves {
        height: f64,
        scale: f64,
        center: DVec3,
    },
    Image {
        image: Arc<Image>,
        height: f64,
        size: f64,
    },
}

/// How much weaker each finer octave of a noise is: slopes shrink a little, too.
const GAIN: f64 = 0.45;

impl Relief {
    pub(super) fn of(bump: &Bump) -> Relief {
        match bump {
            Bump::Noise { height, .. }
            | Bump::Waves { height, .. }
            | Bump::Image { height, .. }
                if *height == 0.0 =>
            {
                Relief::Flat
            }
            Bump::None => Relief::Flat,
            Bump::Noise { height, scale } => Relief::Noise { height: *height, scale: *scale },
            Bump::Waves { height, scale, center } => {
                Relief::Waves { height: *height, scale: *scale, center: *center }
            }
            Bump::Image { image, height, size } => {
                Relief::Image { image: Arc::clone(&image.image), height: *height, size: *size }
            }
        }
    }

    /// The gradient of the height at a point of a surface of which a piece `footprint` wide is looked
    /// at: a difference across that piece, so that what is finer evens out.
    pub(super) fn gradient(&self, point: DVec3, footprint: f64, uv: impl Fn() -> Uv) -> DVec3 {
        match self {
            Relief::Flat => DVec3::ZERO,
            Relief::Noise { height, scale } => {
                noise_gradient(point / *scale, footprint / *scale) * (*height / *scale)
            }
            Relief::Waves { height, scale, center } => {
                rings(point - *center, *scale, footprint) * *height
            }
            Relief::Image { image, height, size } => {
                image_gradient(image, &uv(), *size, footprint) * *height
            }
        }
    }
}

fn noise_gradient(p: DVec3, footprint: f64) -> DVec3 {
    /// Half a step, in units of the noise, where the footprint is smaller: far below the finest
    /// octave, far above rounding.
    const LEAST: f64 = 1e-3;
    let half = (footprint / 2.0).max(LEAST);
    let slope = |axis: DVec3| {
        let side = |at: DVec3| fractal(at, GAIN, footprint);
        (side(p + axis * half) - side(p - axis * half)) / (2.0 * half)
    };
    DVec3::new(slope(DVec3::X), slope(DVec3::Y), slope(DVec3::Z))
}

/// The difference of sin(2π·distance/scale) over a footprint, in closed form: the slope times
/// sinc(π·footprint/scale). 0 in the centre.
fn rings(arm: DVec3, scale: f64, footprint: f64) -> DVec3 {
    let distance = arm.length();
    if distance == 0.0 || !distance.is_finite() {
        return DVec3::ZERO;
    }
    let half = PI * footprint / scale;
    let evened = match half {
        h if h < 1e-4 => 1.0,
        h if h < PI => libm::sin(h) / h,
        // Less than a wave is not told from its neighbours.
        _ => return DVec3::ZERO,
    };
    arm * (TAU / scale * libm::cos(TAU * (distance / scale)) * evened / distance)
}

/// The gradient of the mean of an image's channels, by differences of at least a texel.
fn image_gradient(image: &Image, uv: &Uv, size: f64, footprint: f64) -> DVec3 {
    let at = uv.at.map(|c| c / size);
    let widths = uv.gradients.map(|gradient| footprint * gradient.length() / size);
    let end = uv.poles.then(|| 1.0 / size);
    let sides = image.size().map(f64::from);
    let slope = |axis: usize| {
        let half = (widths[axis].max(1.0 / sides[axis]) / 2.0).min(0.5);
        let height = |by: f64| {
            let mut place = at;
            place[axis] += by;
            texel::read(image, place, widths, end).iter().sum::<f64>() / 3.0
        };
        (height(half) - height(-half)) / (2.0 * half)
    };
    (uv.gradients[0] * slope(0) + uv.gradients[1] * slope(1)) / size
}

/// The unit normal of a surface whose unit normal is `normal` and over which a height with this
/// gradient lies: N − ∇h along the surface, at unit length (Blinn, "Simulation of Wrinkled Surfaces",
/// 1978). It stays on the side of `normal`. `None` where it is `normal` itself, or no number.
pub(super) fn bent(normal: DVec3, gradient: DVec3) -> Option<DVec3> {
    let along = gradient - normal * gradient.dot(normal);
    let steep2 = along.length_squared();
    (steep2 > 0.0 && steep2 < f64::INFINITY).then(|| (normal - along).normalize())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn no_uv() -> Uv {
        unreachable!("it is a function of the point")
    }

    /// A plane through the origin tilted by this much over x is the level plane with that slope.
    #[test]
    fn a_tilted_plane_has_the_normal_of_its_tilt() {
        for degrees in [-60.0f64, -10.0, 0.01, 5.0, 45.0, 89.0] {
            let (sine, cosine) = degrees.to_radians().sin_cos();
            let slope = DVec3::X * (sine / cosine);
            for (normal, slope, expected) in [
                (DVec3::Z, slope, DVec3::new(-sine, 0.0, cosine)),
                // What of the gradient points out of the surface does not count.
                (DVec3::Z, slope + DVec3::Z * 3.0, DVec3::new(-sine, 0.0, cosine)),
                (-DVec3::Z, slope, DVec3::new(-sine, 0.0, -cosine)),
                (DVec3::Y, slope, DVec3::new(-sine, cosine, 0.0)),
            ] {
                let found = bent(normal, slope).unwrap();
                assert!((found - expected).length() < 1e-12, "{degrees}°: {found}");
            }
            // Tilted back about an oblique plane: the slope of the level plane over it.
            let oblique = DVec3::new(sine, 0.0, cosine);
            let across = DVec3::new(cosine, 0.0, -sine);
            let back = bent(oblique, across * (sine / cosine)).unwrap();
            assert!((back - DVec3::Z).length() < 1e-12, "{degrees}°: {back}");
        }
        assert_eq!(bent(DVec3::Z, DVec3::Z * 5.0), None);
        assert_eq!(bent(DVec3::Z, DVec3::ZERO), None);
        assert_eq!(bent(DVec3::Z, DVec3::NAN), None);
    }

    #[test]
    fn waves_are_the_difference_over_the_footprint() {
        let (scale, center) = (0.7, DVec3::new(1.0, -2.0, 0.5));
        let relief = Relief::of(&Bump::Waves { height: 0.1, scale, center });
        for (point, footprint) in [
            (DVec3::new(3.0, 1.0, 0.0), 1e-3),
            (DVec3::new(-2.0, 5.0, 1.0), 0.2),
            (DVec3::new(1.0, 0.0, 0.5), 0.65),
        ] {
            let out = (point - center).normalize();
            let height = |at: DVec3| 0.1 * (TAU * at.distance(center) / scale).sin();
            let step = out * (footprint / 2.0);
            let expected = (height(point + step) - height(point - step)) / footprint;
            let found = relief.gradient(point, footprint, no_uv);
            assert!((found - out * expected).length() < 1e-10, "{found} {}", out * expected);
        }
        assert_eq!(relief.gradient(center, 0.1, no_uv), DVec3::ZERO);
        assert_eq!(relief.gradient(DVec3::ZERO, 0.8, no_uv), DVec3::ZERO);
    }

    #[test]
    fn noise_slopes_are_those_of_its_height_and_even_out() {
        let relief = Relief::of(&Bump::Noise { height: 0.3, scale: 2.0 });
        let point = DVec3::new(0.7, -1.1, 4.2);
        let height = |p: DVec3| 0.3 * fractal(p / 2.0, GAIN, 1e-6);
        let found = relief.gradient(point, 2e-6, no_uv);
        for axis in DVec3::AXES {
            let expected = (height(point + axis * 2e-3) - height(point - axis * 2e-3)) / 4e-3;
            assert!((found.dot(axis) - expected).abs() < 1e-9);
        }
        assert!(found.length() > 0.01);
        assert_eq!(relief.gradient(point, 2.0, no_uv), DVec3::ZERO, "nothing is seen of it");
    }

    #[test]
    fn a_ramp_of_texels_is_a_slope() {
        // 8 columns, red = green = blue = column / 8: height 1 over a u of 1, but for the seam.
        let texels = (0..8).map(|i| [i as f32 / 8.0; 3]).collect();
        let image = Arc::new(Image::of_floats([8, 1], texels));
        let file = crate::scene::ImageFile { file: "ramp.hdr".into(), image };
        let relief = Relief::of(&Bump::Image { image: file, height: 0.5, size: 2.0 });
        let gradients = [DVec3::X * 3.0, DVec3::Y];
        let uv = || Uv { at: [0.9, 0.3], gradients, poles: false };
        let found = relief.gradient(DVec3::ZERO, 0.0, uv);
        assert!((found - DVec3::X * (3.0 * 0.5 / 2.0)).length() < 1e-12, "{found}");
    }

    #[test]
    fn no_height_is_no_bump() {
        for key in crate::scene::fields::BUMPS {
            let mut bump = Bump::named(key);
            assert_ne!(Relief::of(&bump), Relief::Flat);
            match &mut bump {
                Bump::None => {}
                Bump::Noise { height, .. }
                | Bump::Waves { height, .. }
                | Bump::Image { height, .. } => *height = -0.0,
            }
            assert_eq!(Relief::of(&bump), Relief::Flat);
        }
    }
}
