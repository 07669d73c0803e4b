//! Khronos PBR Neutral, the tone curve that leaves colours alone which a screen can show.

/// Reflectance of an unpolished surface seen from the front, which the curve takes off (F90 of the
/// specification: 0.04).
const SHEEN: f32 = 0.04;
/// Where compression starts, the sheen taken off.
const START: f32 = 0.8 - SHEEN;
/// How fast compressed colours lose saturation.
const DESATURATION: f32 = 0.15;
/// Light beyond this is white all the same: what is infinite has no quotient.
const MOST: f32 = 1e9;

/// Exposed light to what is shown, all channels in 0 … 1.
///
/// Domain: any three numbers; what is below 0 or no number counts as 0. Where the least channel is
/// ≥ 0.08 and the greatest ≤ 0.8, each channel loses 0.04 and nothing else happens. The order of the
/// channels stays, greys stay grey, and white is reached only where rounding does.
///
/// Khronos Group, "Khronos PBR Neutral Tone Mapper" (2024), with its names: x the least channel, p the
/// peak after the offset, d = 1 − start of compression. Written without branches, for vector lanes; the
/// steps are those of `neutral` in `shade.wgsl`.
#[inline(always)]
pub fn neutral(exposed: [f32; 3]) -> [f32; 3] {
    let [r, g, b] = exposed.map(|c| {
        let c = if c > 0.0 { c } else { 0.0 };
        if c < MOST { c } else { MOST }
    });
    let x = r.min(g).min(b);
    let offset = if x < 2.0 * SHEEN { x - 6.25 * x * x } else { SHEEN };
    let (r, g, b) = (r - offset, g - offset, b - offset);
    let p = r.max(g).max(b);
    let d = 1.0 - START;
    let peak = 1.0 - d * d / (p + d - START);
    let scale = peak / p;
    let white = 1.0 - 1.0 / (DESATURATION * (p - peak) + 1.0);
    let compressed = |c: f32| {
        let scaled = c * scale;
        scaled + (peak - scaled) * white
    };
    // Where p is 0 the quotient is no number; it is not used.
    let shown = |c: f32| if p < START { c } else { compressed(c) };
    [shown(r), shown(g), shown(b)]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn near(a: [f32; 3], b: [f32; 3]) -> bool {
        a.iter().zip(b).all(|(a, b)| (a - b).abs() < 2e-6)
    }

    #[test]
    fn what_a_screen_can_show_loses_the_sheen_alone() {
        for color in [[0.5, 0.3, 0.1], [0.08, 0.08, 0.08], [0.2, 0.799, 0.4]] {
            assert!(near(neutral(color), color.map(|c| c - 0.04)), "{color:?}");
        }
        // below, the offset x − 6.25 x² leaves 6.25 x² of the least channel
        assert!(near(neutral([0.04, 0.24, 0.44]), [0.01, 0.21, 0.41]));
        assert_eq!(neutral([0.0; 3]), [0.0; 3]);
        assert_eq!(neutral([0.0, 0.7, 0.0]), [0.0, 0.7, 0.0], "nothing to take off");
        assert!(!near(neutral([0.9; 3]), [0.86; 3]), "compressed, so that the helper can fail");
    }

    #[test]
    fn greys_above_the_start_follow_the_hyperbola() {
        // p = 0.04 d's above the start: 1 − d² / (p + d − start), d = 0.24
        for (grey, shown) in [(0.8, 0.76), (1.04, 0.88), (2.0, 1.0 - 0.0576 / 1.44)] {
            assert!(near(neutral([grey; 3]), [shown; 3]), "{grey}: {:?}", neutral([grey; 3]));
        }
    }

    #[test]
    fn bright_colours_are_those_of_the_specification_worked_by_hand() {
        // (2, 0.5, 0.1): offset 0.04, p = 1.96, peak = 1 − 0.0576/1.44 = 0.96,
        // scale = 24/49, white = 1 − 1/1.15 = 3/23.
        let hand = [1.96, 0.46, 0.06].map(|c: f64| {
            let scaled = c * 24.0 / 49.0;
            (scaled + (0.96 - scaled) * 3.0 / 23.0) as f32
        });
        assert!(near(neutral([2.0, 0.5, 0.1]), hand));
    }

    #[test]
    fn it_rises_without_a_jump_and_stays_below_white() {
        for hue in [[1.0, 1.0, 1.0], [1.0, 0.5, 0.2], [0.1, 0.0, 1.0]] {
            let mut before = neutral([0.0; 3]);
            for step in 1..=40_000 {
                let shown = neutral(hue.map(|c: f32| c * step as f32 / 10_000.0));
                let peak = |c: [f32; 3]| c[0].max(c[1]).max(c[2]);
                assert!(peak(shown) >= peak(before), "{hue:?} {step}");
                let jump = shown.iter().zip(before).map(|(a, b)| (a - b).abs());
                assert!(jump.fold(0.0, f32::max) < 2.5e-4, "{hue:?} {step}");
                assert!(shown.iter().all(|c| (0.0..1.0).contains(c)), "{hue:?} {step}");
                before = shown;
            }
        }
    }

    #[test]
    fn greys_stay_grey_and_channels_keep_their_order() {
        for step in 0..2000 {
            let value = step as f32 / 100.0;
            let [r, g, b] = neutral([value; 3]);
            assert!(r == g && g == b, "{value}");
            let [r, g, b] = neutral([value * 1.5, value, value * 0.5]);
            assert!(r >= g && g >= b, "{value}");
        }
    }

    #[test]
    fn what_is_no_light_has_a_colour() {
        assert_eq!(neutral([-1.0, f32::NAN, -0.0]), [0.0; 3]);
        assert_eq!(neutral([f32::INFINITY; 3]), [1.0; 3]);
        assert_eq!(neutral([f32::MAX; 3]), neutral([1e9; 3]));
    }
}
