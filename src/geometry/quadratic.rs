//! Where a·s² + 2b·s + c is not above zero, for every a, b and c.

/// The parameters at which a quadratic function is not above zero; `low ≤ high`, infinite ones allowed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Below {
    /// Nowhere, or only where it touches zero.
    Nowhere,
    /// From one to the other.
    Between(f64, f64),
    /// Up to the first and from the second on.
    Outside(f64, f64),
    /// Everywhere.
    Everywhere,
}

/// Solves a·s² + 2b·s + c ≤ 0 with the discriminant b² − a·c, which whoever knows where the numbers
/// come from can form without cancellation.
///
/// The root that suffers no cancellation is q/a, the other one c/q (STABILITY Q4): no 0/0 as a → 0,
/// where q/a runs to infinity on its own.
#[inline(always)]
pub(super) fn below(a: f64, b: f64, c: f64, discriminant: f64) -> Below {
    if discriminant > 0.0 {
        let root = discriminant.sqrt();
        let q = if b > 0.0 { -b - root } else { root - b };
        let (first, second) = (q / a, c / q);
        let (low, high) = if first < second { (first, second) } else { (second, first) };
        if a > 0.0 {
            Below::Between(low, high)
        } else if a < 0.0 {
            Below::Outside(low, high)
        } else {
            half_line(b, second)
        }
    } else if a < 0.0 || (a == 0.0 && c < 0.0) {
        Below::Everywhere
    } else {
        Below::Nowhere
    }
}

/// The same of a line: 2b·s + c ≤ 0, whose root is known.
#[inline(always)]
fn half_line(b: f64, root: f64) -> Below {
    if b > 0.0 {
        Below::Between(f64::NEG_INFINITY, root)
    } else {
        Below::Between(root, f64::INFINITY)
    }
}

/// Solves a·s² + 2b·s ≤ 0 where the surface is known to be crossed at 0, inwards or outwards: rounding
/// does not turn the crossing around.
#[inline(always)]
pub(super) fn below_from_surface(a: f64, b: f64, inward: bool) -> Below {
    let b = if inward { b.min(0.0) } else { b.max(0.0) };
    let other = if b == 0.0 { 0.0 } else { -2.0 * (b / a) };
    if a > 0.0 {
        if inward { Below::Between(0.0, other) } else { Below::Between(other, 0.0) }
    } else if a < 0.0 {
        if inward { Below::Outside(other, 0.0) } else { Below::Outside(0.0, other) }
    } else if inward {
        Below::Between(0.0, f64::INFINITY)
    } else {
        Below::Between(f64::NEG_INFINITY, 0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(a: f64, b: f64, c: f64) -> Below {
        below(a, b, c, b * b - a * c)
    }

    #[test]
    fn quadrics_every_kind_of_function() {
        assert_eq!(of(1.0, 0.0, -4.0), Below::Between(-2.0, 2.0));
        assert_eq!(of(1.0, -3.0, 5.0), Below::Between(1.0, 5.0));
        assert_eq!(of(-1.0, 3.0, -5.0), Below::Outside(1.0, 5.0));
        assert_eq!(of(0.0, 1.0, -4.0), Below::Between(f64::NEG_INFINITY, 2.0));
        assert_eq!(of(0.0, -1.0, -4.0), Below::Between(-2.0, f64::INFINITY));
        assert_eq!(of(-1.0, 0.0, -1.0), Below::Everywhere);
        assert_eq!(of(0.0, 0.0, -1.0), Below::Everywhere);
        for touched in [of(1.0, 0.0, 0.0), of(1.0, 0.0, 1.0), of(0.0, 0.0, 1.0)] {
            assert_eq!(touched, Below::Nowhere);
        }
        assert_eq!(below_from_surface(2.0, -1.0, true), Below::Between(0.0, 1.0));
        assert_eq!(below_from_surface(2.0, 1.0, false), Below::Between(-1.0, 0.0));
        assert_eq!(below_from_surface(-2.0, -1.0, true), Below::Outside(-1.0, 0.0));
        // Grazing, turned around by rounding.
        assert_eq!(below_from_surface(2.0, 1e-17, true), Below::Between(0.0, 0.0));
    }

    #[test]
    fn quadrics_as_the_square_vanishes() {
        // a·s² + 2s − 1: the root near ½ stays, the other runs off to −2/a.
        for a in [1e-3, 1e-9, 1e-16, 1e-300, 0.0] {
            let Below::Between(low, high) = of(a, 1.0, -1.0) else { panic!("{a}") };
            assert!((high - 0.5).abs() < 0.5 * a + 1e-16 && low <= -1.9 / a);
            let Below::Between(low, high) = of(a, -1.0, -1.0) else { panic!("{a}") };
            assert!((low + 0.5).abs() < 0.5 * a + 1e-16 && high >= 1.9 / a);
        }
    }
}
