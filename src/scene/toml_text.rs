//! Numbers, vectors, strings and keys as TOML.

use std::fmt;

use glam::DVec3;

use crate::color::Rgb;

/// The shortest decimal that reads back as the same bits.
pub(crate) fn number<T: Copy + Into<f64> + fmt::Display + fmt::LowerExp>(x: T) -> String {
    let wide: f64 = x.into();
    if wide == 0.0 && wide.is_sign_negative() {
        "-0.0".to_owned()
    } else if wide == 0.0 || !wide.is_finite() || (1e-5..1e15).contains(&wide.abs()) {
        format!("{x}").replace("NaN", "nan")
    } else {
        format!("{x:e}")
    }
}

pub(super) fn vector(v: &DVec3) -> String {
    let DVec3 { x, y, z } = *v;
    format!("[{}, {}, {}]", number(x), number(y), number(z))
}

pub(super) fn one_or_three<T, B>(values: [T; 3], bits: [B; 3]) -> String
where
    T: Copy + Into<f64> + fmt::Display + fmt::LowerExp,
    B: PartialEq,
{
    let [x, y, z] = values.map(number);
    if bits[0] == bits[1] && bits[1] == bits[2] { x } else { format!("[{x}, {y}, {z}]") }
}

/// A number, or `[r, g, b]` where channels differ.
pub(crate) fn rgb(Rgb(channels): Rgb) -> String {
    one_or_three(channels, channels.map(f32::to_bits))
}

/// A TOML basic string.
pub(crate) fn quoted(text: &str) -> String {
    let mut out = String::with_capacity(text.len() + 2);
    out.push('"');
    for c in text.chars() {
        match c {
            '"' => out.push_str("\\\""),
            '\\' => out.push_str("\\\\"),
            c if c.is_control() => out.push_str(&format!("\\u{:04X}", u32::from(c))),
            c => out.push(c),
        }
    }
    out.push('"');
    out
}

/// A TOML key: bare if that is possible.
pub(crate) fn bare_or_quoted(key: &str) -> String {
    let bare = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
    if !key.is_empty() && key.chars().all(bare) { key.to_owned() } else { quoted(key) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_are_quoted_only_if_needed() {
        assert_eq!(bare_or_quoted("tiles-2_b"), "tiles-2_b");
        assert_eq!(bare_or_quoted("my tiles"), "\"my tiles\"");
        assert_eq!(bare_or_quoted(""), "\"\"");
        assert_eq!(quoted("a\"b\\c\n"), "\"a\\\"b\\\\c\\u000A\"");
    }
}
