//! Where the colours of a paint fall: functions of the point, or of the surface's u-v.

use std::f64::consts::PI;
use std::sync::Arc;

use glam::DVec3;

use super::compile::exact_normalize;
use super::noise::{fractal, noise, seen};
use super::texel;
use super::tone::Tone;
use super::uv::Uv;
use crate::color::Rgb;
use crate::scene::Paint;
use crate::scene::texture::Image;

/// A paint made ready.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Pattern {
    /// Whole slots: one colour, or a checker's.
    Slots,
    /// The share of slot 1 grows from 0 to 1 along `along`, of which 1/length² is kept.
    Gradient {
        from: DVec3,
        along: DVec3,
    },
    Marble {
        size: f64,
        direction: DVec3,
        turbulence: f64,
    },
    Wood {
        size: f64,
        center: DVec3,
        axis: DVec3,
        turbulence: f64,
    },
    Image {
        image: Arc<Image>,
        size: f64,
    },
}

impl Pattern {
    pub(super) fn of(paint: &Paint) -> Pattern {
        match paint {
            Paint::Solid(_) | Paint::Checker { .. } => Pattern::Slots,
            Paint::Gradient { a: _, b: _, from, to } => {
                let (way, largest) = (*to - *from, (*to - *from).abs().max_element());
                // In two steps, so that no square overflows.
                let scaled = way / largest;
                let along = scaled / scaled.length_squared() / largest;
                Pattern::Gradient { from: *from, along }
            }
            Paint::Marble { a: _, b: _, size, direction, turbulence } => {
                let direction = exact_normalize(*direction);
                Pattern::Marble { size: *size, direction, turbulence: *turbulence }
            }
            Paint::Wood { a: _, b: _, size, center, axis, turbulence } => Pattern::Wood {
                size: *size,
                center: *center,
                axis: exact_normalize(*axis),
                turbulence: *turbulence,
            },
            Paint::Image { image, tint: _, size } => {
                Pattern::Image { image: Arc::clone(&image.image), size: *size }
            }
        }
    }

    /// The tone at a point of a surface of which a piece `footprint` wide is looked at; `None` for
    /// whole slots.
    pub(super) fn tone(&self, point: DVec3, footprint: f64, uv: impl Fn() -> Uv) -> Option<Tone> {
        let share = match self {
            Pattern::Slots => return None,
            Pattern::Image { image, size } => {
                let texel = texel::sample(image, &uv(), *size, footprint);
                return Some(Tone::Texel(Rgb(texel.map(|c| c as f32))));
            }
            Pattern::Gradient { from, along } => (point - *from).dot(*along),
            Pattern::Marble { size, direction, turbulence } => {
                marble(point / *size, *direction, *turbulence, footprint / *size)
            }
            Pattern::Wood { size, center, axis, turbulence } => {
                wood((point - *center) / *size, *axis, *turbulence, footprint / *size)
            }
        };
        // A share that is no number would spread over the whole pixel.
        let share = if share > 0.0 { share.min(1.0) } else { 0.0 };
        Some(Tone::Blend { slot: 0, share: share as f32 })
    }
}

/// The share of the veins at a point in units of their distance: 1 in the middle of a vein.
fn marble(p: DVec3, direction: DVec3, turbulence: f64, footprint: f64) -> f64 {
    /// Of (1 − |sin|)² over a period.
    const MEAN: f64 = 1.5 - 4.0 / PI;
    let fold = fractal(p * 0.5, 0.5, footprint * 0.5);
    let layer = p.dot(direction) + turbulence * fold;
    let vein = 1.0 - libm::sin(PI * layer).abs();
    // Veins are thin: they blur before their distance does.
    let sharp = MEAN + (vein * vein - MEAN) * seen(2.0 * footprint);
    // Some run out.
    sharp * (0.7 + 0.5 * noise(p * 0.37 + DVec3::splat(9.1)) * seen(0.37 * footprint))
}

/// The share of late wood at a point in units of the rings' width, from a point of the axis.
fn wood(p: DVec3, axis: DVec3, turbulence: f64, footprint: f64) -> f64 {
    /// Where in a ring the wood is latest.
    const LATEST: f64 = 0.85;
    /// Of the ring's profile.
    const MEAN: f64 = LATEST / 3.0 + (1.0 - LATEST) / 2.0;
    let along = p.dot(axis);
    let radial = p - axis * along;
    // A trunk changes slowly along its axis.
    let wander = fractal(radial * 0.12 + axis * (along * 0.02), 0.5, footprint * 0.12);
    let rings = radial.length() + turbulence * 2.0 * wander;
    let at = rings - rings.floor();
    let profile = match at < LATEST {
        true => (at / LATEST) * (at / LATEST),
        false => (1.0 - at) / (1.0 - LATEST),
    };
    let sharp = MEAN + (profile - MEAN) * seen(2.0 * footprint);
    let fibre = noise(radial * 9.0 + axis * (along * 0.25)) * seen(9.0 * footprint);
    sharp * 0.85 + 0.08 + 0.12 * fibre
}

#[cfg(test)]
mod tests {
    use super::*;

    fn share(pattern: &Pattern, point: DVec3, footprint: f64) -> f32 {
        match pattern.tone(point, footprint, || unreachable!("a solid pattern reads no u-v")) {
            Some(Tone::Blend { slot: 0, share }) => share,
            tone => panic!("{tone:?}"),
        }
    }

    fn points() -> impl Iterator<Item = DVec3> {
        let turn = |i: u32, by: f64| (f64::from(i) * by).fract() * 8.0 - 4.0;
        (0..20_000)
            .map(move |i| DVec3::new(turn(i, 0.618_034), turn(i, 0.754_877), turn(i, 0.569_84)))
    }

    #[test]
    fn a_gradient_is_linear_between_its_ends_and_constant_beyond() {
        let (from, to) = (DVec3::new(1.0, 2.0, 3.0), DVec3::new(3.0, 2.0, 7.0));
        let (a, b) = (Rgb::WHITE, Rgb::BLACK);
        let pattern = Pattern::of(&Paint::Gradient { a, b, from, to });
        for (way, expected) in [(-1.0, 0.0), (0.0, 0.0), (0.25, 0.25), (1.0, 1.0), (7.0, 1.0)] {
            let beside = DVec3::Y * 5.0 + DVec3::new(2.0, 0.0, -1.0);
            let found = share(&pattern, from + (to - from) * way + beside, 0.1);
            assert!((found - expected).abs() < 1e-6, "{way}: {found}");
        }
        let far = Paint::Gradient { a, b, from: DVec3::splat(-1e12), to: DVec3::splat(1e12) };
        assert_eq!(share(&Pattern::of(&far), DVec3::ZERO, 0.1), 0.5);
    }

    #[test]
    fn solid_patterns_use_both_colours_and_stay_within_them() {
        for kind in ["marble", "wood"] {
            let pattern = Pattern::of(&Paint::named(kind));
            let shares: Vec<f32> = points().map(|p| share(&pattern, p, 0.0)).collect();
            assert!(shares.iter().all(|s| (0.0..=1.0).contains(s)));
            let [low, high] = [f32::min, f32::max].map(|m| shares.iter().copied().reduce(m));
            assert!(low < Some(0.1) && high > Some(0.8), "{kind}: {low:?} {high:?}");
        }
    }

    #[test]
    fn patterns_fade_to_their_mean() {
        for (kind, far) in [("marble", 20.0), ("wood", 20.0)] {
            let pattern = Pattern::of(&Paint::named(kind));
            let mean = |footprint: f64| {
                let sum: f64 = points().map(|p| f64::from(share(&pattern, p, footprint))).sum();
                sum / 20_000.0
            };
            let worst = points()
                .map(|p| share(&pattern, p, far))
                .fold([1.0f32, 0.0], |m, s| [m[0].min(s), m[1].max(s)]);
            assert!(worst[1] - worst[0] < 1e-6, "{kind}: not even from afar: {worst:?}");
            assert!((mean(0.0) - mean(far)).abs() < 0.02, "{kind}: {} {}", mean(0.0), mean(far));
        }
    }

    #[test]
    fn veins_and_rings_without_turbulence_are_flat_and_round() {
        let (a, b, turbulence) = (Rgb::WHITE, Rgb::BLACK, 0.0);
        let direction = DVec3::Z * 3.0;
        let marble = Pattern::of(&Paint::Marble { a, b, size: 0.5, direction, turbulence });
        // In a vein, and half way to the next one.
        let at = |z: f64| share(&marble, DVec3::new(0.3, -0.7, z), 0.0);
        assert!(at(0.5) > 0.3 && at(0.75) == 0.0 && at(0.25) == 0.0, "{} {}", at(0.5), at(0.75));
        let (center, axis) = (DVec3::new(1.0, 0.0, 0.0), DVec3::Z);
        let wood = Pattern::of(&Paint::Wood { a, b, size: 0.1, center, axis, turbulence });
        // Fibres apart, the share depends on the distance from the axis alone.
        let at = |turn: f64, z: f64| {
            let p = center + DVec3::new(libm::cos(turn), libm::sin(turn), z) * 0.98;
            share(&wood, p, 0.0)
        };
        let latest = (0..100).map(|i| at(f64::from(i) * 0.1, f64::from(i) * 0.03));
        assert!(latest.into_iter().all(|share| (share - 0.84).abs() < 0.16));
    }

    #[test]
    fn odd_points_give_shares() {
        for kind in ["gradient", "marble", "wood"] {
            let pattern = Pattern::of(&Paint::named(kind));
            for x in [f64::NAN, f64::INFINITY, -1e300, 1e12] {
                let share = share(&pattern, DVec3::splat(x), 1.0);
                assert!((0.0..=1.0).contains(&share), "{kind} at {x}: {share}");
            }
        }
    }
}
