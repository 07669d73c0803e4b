//! Other ways to name a colour: sRGB bytes in hexadecimal, and hue, saturation and value.

use super::{Rgb, linear_of_srgb, srgb_byte, srgb_of_linear};

/// What a linear colour shows on the screen, by the film's own curve; channels above 1 are cut.
pub fn bytes(color: Rgb) -> [u8; 3] {
    color.0.map(srgb_byte)
}

/// The linear colour of sRGB bytes.
pub fn of_bytes(bytes: [u8; 3]) -> Rgb {
    Rgb(bytes.map(|byte| linear_of_srgb(f64::from(byte) / 255.0)))
}

/// `#rrggbb` of what a linear colour shows.
pub fn hex(color: Rgb) -> String {
    let [r, g, b] = bytes(color);
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// The bytes of `#rrggbb`, `rrggbb`, `#rgb` or `rgb`; spaces around them do not count.
pub fn read_hex(text: &str) -> Option<[u8; 3]> {
    let text = text.trim();
    let text = text.strip_prefix('#').unwrap_or(text);
    if !text.bytes().all(|c| c.is_ascii_hexdigit()) {
        return None;
    }
    let digit = |i: usize| u8::from_str_radix(&text[i..=i], 16).ok();
    match text.len() {
        3 => Some([digit(0)? * 17, digit(1)? * 17, digit(2)? * 17]),
        6 => {
            let pair = |i: usize| Some(digit(i)? * 16 + digit(i + 1)?);
            Some([pair(0)?, pair(2)?, pair(4)?])
        }
        _ => None,
    }
}

/// A colour by hue, saturation and value of its sRGB channels, as painting programs and CSS count
/// them (A. R. Smith, "Color gamut transform pairs", SIGGRAPH 1978).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Hsv {
    /// In turns, 0 to 1: red, yellow, green, cyan, blue, magenta at the sixths. Of a grey, 0.
    pub hue: f64,
    /// 0 is grey, 1 is pure. Of black, 0.
    pub saturation: f64,
    /// The largest channel, 0 to 1.
    pub value: f64,
}

impl Hsv {
    /// Of a linear colour whose channels are at most 1; those above count as 1.
    pub fn of(color: Rgb) -> Hsv {
        // The curve's own 1 is one ulp below.
        let srgb = |c: f32| if c >= 1.0 { 1.0 } else { srgb_of_linear(f64::from(c)) };
        let [r, g, b] = color.0.map(srgb);
        let (most, least) = (r.max(g).max(b), r.min(g).min(b));
        let spread = most - least;
        if spread <= 0.0 {
            return Hsv { hue: 0.0, saturation: 0.0, value: most };
        }
        let sixths = if most == r {
            (g - b) / spread
        } else if most == g {
            2.0 + (b - r) / spread
        } else {
            4.0 + (r - g) / spread
        };
        let hue = (sixths / 6.0).rem_euclid(1.0);
        Hsv { hue, saturation: spread / most, value: most }
    }

    /// Its sRGB channels, 0 to 1.
    pub fn srgb(self) -> [f64; 3] {
        let Hsv { hue, saturation, value } = self;
        let sixths = hue.rem_euclid(1.0) * 6.0;
        [5.0, 3.0, 1.0].map(|offset: f64| {
            let at = (offset + sixths) % 6.0;
            let away = at.min(4.0 - at).clamp(0.0, 1.0);
            value * (1.0 - saturation * away)
        })
    }

    /// The linear colour.
    pub fn rgb(self) -> Rgb {
        Rgb(self.srgb().map(linear_of_srgb))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hexadecimal_comes_back_as_the_same_bytes() {
        for step in 0..=255u8 {
            let all = [step, 255 - step, step ^ 0x5a];
            assert_eq!(bytes(of_bytes(all)), all);
            assert_eq!(read_hex(&hex(of_bytes(all))), Some(all));
        }
        assert_eq!(hex(Rgb([7.0, 0.0, -1.0])), "#ff0000");
    }

    #[test]
    fn hexadecimal_is_read_in_every_form_and_nothing_else_is() {
        for text in ["#ff8000", "ff8000", "FF8000", " #fF8000\n"] {
            assert_eq!(read_hex(text), Some([255, 128, 0]), "{text}");
        }
        for text in ["#f80", "f80"] {
            assert_eq!(read_hex(text), Some([255, 136, 0]), "{text}");
        }
        for text in ["", "#", "#ff80", "ff80000", "0x1234", "red", "#gg0000", "é12", "+12", "##fff"]
        {
            assert_eq!(read_hex(text), None, "{text}");
        }
    }

    #[test]
    fn pure_colours_have_their_hues() {
        let pure = [
            ([1.0, 0.0, 0.0], 0.0),
            ([1.0, 1.0, 0.0], 1.0),
            ([0.0, 1.0, 0.0], 2.0),
            ([0.0, 1.0, 1.0], 3.0),
            ([0.0, 0.0, 1.0], 4.0),
            ([1.0, 0.0, 1.0], 5.0),
        ];
        for (color, sixths) in pure {
            let hsv = Hsv { hue: sixths / 6.0, saturation: 1.0, value: 1.0 };
            let found = Hsv::of(Rgb(color));
            assert!((found.hue - hsv.hue).abs() < 1e-12 && found.saturation == 1.0, "{found:?}");
            let back = hsv.rgb().0;
            assert!((0..3).all(|i| (back[i] - color[i]).abs() < 1e-6), "{back:?}");
        }
        assert_eq!(Hsv::of(Rgb::BLACK), Hsv::default());
        assert_eq!(Hsv::of(Rgb::WHITE), Hsv { value: 1.0, ..Hsv::default() });
        assert_eq!(Hsv::of(Rgb::grey(9.0)).value, 1.0);
    }

    #[test]
    fn a_colour_comes_back_from_hue_saturation_and_value() {
        for i in 0..1000u32 {
            let color = [i % 10, i / 10 % 10, i / 100].map(|n| n as f32 / 9.0);
            let back = Hsv::of(Rgb(color)).rgb().0;
            assert!((0..3).all(|c| (back[c] - color[c]).abs() < 1e-6), "{color:?} {back:?}");
            assert_eq!(bytes(Rgb(back)), bytes(Rgb(color)));
        }
    }
}
