//! How wide a pixel is where its ray arrives: what textures and bumps even out.

use crate::scene::{Camera, Lens};

/// The cone around a camera ray that a pixel covers.
///
/// Its width is the path's length times the pixel's angle in the middle of the picture, as if mirrors
/// and glass were flat, whatever the angle under which a surface is met: samples do the rest. It does
/// not depend on their number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Cone {
    /// World units at the eye.
    base: f64,
    /// World units per world unit of path: radians.
    pub(super) angle: f64,
}

impl Cone {
    /// That of one pixel.
    pub(super) fn new(camera: &Camera, size: [u32; 2]) -> Cone {
        let rows = f64::from(size[1]);
        match camera.lens {
            Lens::Perspective { fov_degrees } => {
                let height = 2.0 * libm::tan(fov_degrees.to_radians() / 2.0);
                Cone { base: 0.0, angle: height / rows }
            }
            Lens::Parallel { height } => Cone { base: height / rows, angle: 0.0 },
        }
    }

    /// Its width after a path of this length.
    #[inline(always)]
    pub(super) fn width(&self, length: f64) -> f64 {
        self.base + self.angle * length
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_as_wide_as_a_pixel() {
        let of = |lens| Cone::new(&Camera { lens, ..Camera::default() }, [200, 100]);
        let cone = of(Lens::Perspective { fov_degrees: 90.0 });
        // At distance 5 the picture is 10 high.
        assert!((cone.width(5.0) - 0.1).abs() < 1e-15);
        assert_eq!(of(Lens::Parallel { height: 4.0 }).width(5.0), 0.04);
    }
}
