//! What a parameter may hold: the kind of its value and the range of its numbers.

use std::fmt;

use super::toml_text::number;

/// The numbers a parameter may hold; NaN and the infinities are never among them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
    /// Whether `low` itself is allowed.
    pub low_included: bool,
    /// Whether `high` itself is allowed.
    pub high_included: bool,
}

impl Range {
    /// `low ≤ x ≤ high`.
    pub const fn closed(low: f64, high: f64) -> Range {
        Range { low, high, low_included: true, high_included: true }
    }

    /// `low < x ≤ high`.
    pub const fn above(low: f64, high: f64) -> Range {
        Range { low, high, low_included: false, high_included: true }
    }

    /// `low < x < high`.
    pub const fn between(low: f64, high: f64) -> Range {
        Range { low, high, low_included: false, high_included: false }
    }

    /// Whether `x` may be the value.
    pub fn contains(&self, x: f64) -> bool {
        x.is_finite()
            && (x > self.low || (self.low_included && x == self.low))
            && (x < self.high || (self.high_included && x == self.high))
    }

    /// The same for a value in `f32`, which cannot be every end exactly.
    pub fn narrow(&self) -> Range {
        Range { low: f64::from(self.low as f32), high: f64::from(self.high as f32), ..*self }
    }

    /// The nearest number that may be the value; a millionth inside an end that may not. 0, or the
    /// end nearest to it, for NaN.
    pub fn clamp(&self, x: f64) -> f64 {
        let inside = 1e-6 * (self.high - self.low).min(1.0);
        let low = if self.low_included { self.low } else { self.low + inside };
        let high = if self.high_included { self.high } else { self.high - inside };
        if x.is_nan() { 0f64.clamp(low, high) } else { x.clamp(low, high) }
    }

    /// The end of the range that `x` lies beyond, if that end is itself allowed.
    pub(super) fn nearest_end(&self, x: f64) -> Option<f64> {
        if x < self.low && self.low_included {
            Some(self.low)
        } else if x > self.high && self.high_included {
            Some(self.high)
        } else {
            None
        }
    }
}

impl fmt::Display for Range {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let short = |x: f64| if x.abs() >= 1e6 { format!("{x:e}") } else { number(x) };
        let (low, high) = (short(self.low), short(self.high));
        match (self.low_included, self.high_included) {
            (true, true) => write!(f, "{low} to {high}"),
            (false, true) => write!(f, "above {low} and at most {high}"),
            (true, false) => write!(f, "at least {low} and below {high}"),
            (false, false) => write!(f, "above {low} and below {high}"),
        }
    }
}

/// How a value is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A number or `[r, g, b]`.
    Coefficient,
    /// A number.
    Number,
    /// A whole number.
    Whole,
    /// Two whole numbers.
    Pair,
    /// `true` or `false`.
    Flag,
    /// One of these names.
    Choice(&'static [&'static str]),
    /// `[x, y, z]`.
    Vector,
    /// A number or `[x, y, z]`.
    Scale,
    /// `[[x, y, z], …]`.
    Points,
    /// `[[x, y], …]`, or a list of those.
    Loops,
    /// The name of a material.
    Material,
    /// `["a", "b", …]`, names of solids.
    Solids,
    /// The name of a mesh or image file.
    File,
}

impl Kind {
    /// What must be written, as in "must be …".
    pub fn expected(self) -> &'static str {
        match self {
            Kind::Coefficient => "a number or [r, g, b]",
            Kind::Number => "a number",
            Kind::Whole => "a whole number",
            Kind::Pair => "two whole numbers [a, b]",
            Kind::Flag => "true or false",
            Kind::Choice(_) => "one of a list of names",
            Kind::Vector => "three numbers [x, y, z]",
            Kind::Scale => "a number or [x, y, z]",
            Kind::Points => "a list of points [[x, y, z], …]",
            Kind::Loops => "a list of points [[x, y], …], or a list of such lists",
            Kind::Material => "the name of a material",
            Kind::Solids => "a list of names of solids [\"a\", \"b\", …]",
            Kind::File => "the name of a file",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn clamping_always_gives_an_allowed_value() {
        for range in [Range::closed(0.0, 1.0), Range::above(0.0, 1e12), Range::between(0.0, 180.0)]
        {
            for x in [f64::NEG_INFINITY, -1.0, 0.0, 0.5, 180.0, 1e13, f64::INFINITY, f64::NAN] {
                assert!(range.contains(range.clamp(x)), "{range}: {x}");
            }
            assert_eq!(range.clamp(0.5), 0.5);
        }
    }

    #[test]
    fn ranges_say_what_they_hold() {
        assert_eq!(Range::closed(0.0, 1e6).to_string(), "0 to 1e6");
        assert_eq!(Range::between(0.0, 180.0).to_string(), "above 0 and below 180");
        assert!(Range::closed(0.0, 1.0).contains(1.0) && !Range::above(0.0, 1.0).contains(0.0));
        assert!(!Range::closed(0.0, 1.0).contains(f64::NAN));
        assert!(!Range::between(0.0, 180.0).contains(180.0));
        let low = f64::from(0.02f32);
        assert!(!Range::closed(0.02, 1.0).contains(low));
        assert!(Range::closed(0.02, 1.0).narrow().contains(low));
        assert!(!Range::closed(0.02, 1.0).narrow().contains(f64::from(0.02f32.next_down())));
    }
}
