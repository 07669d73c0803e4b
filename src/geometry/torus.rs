//! Tori around the z axis: the roots of a quartic, found between its turning points.
//!
//! The ray is moved to its closest approach first: the cubic term vanishes, and so does what it would
//! cancel (STABILITY §3). Roots are counted by the signs of the solid's own function at the turning
//! points, and the ray's ends are outside by definition, so that their number is even.

use glam::DVec3;

use super::primitive::Start;
use super::spans::{Spans, slab};

/// All points within `minor` of a circle of radius `major` around the z axis. If `minor` exceeds
/// `major` it has no hole: the lens-shaped part that the tube covers twice is inside.
#[derive(Clone, Copy, Debug)]
pub(super) struct Torus {
    /// Of the circle in the middle of the tube, > 0.
    pub(super) major: f64,
    /// Of the tube, > 0.
    pub(super) minor: f64,
}

/// A line by a point and a unit direction.
#[derive(Clone, Copy)]
struct Line {
    p: DVec3,
    d: DVec3,
}

/// A parameter on a line, and whether it is inside the solid there.
#[derive(Clone, Copy)]
struct Mark {
    s: f64,
    inside: bool,
}

/// A step of a search is the last one if it is below this share of the solid's size: the next one
/// would be below the rounding.
const LAST_STEP: f64 = 1e-9;
/// Steps at most; they are halvings where Newton's go astray.
const MOST_STEPS: usize = 100;

impl Torus {
    /// Where the whole line of a ray enters and leaves; the direction has any length.
    pub(super) fn spans(&self, o: DVec3, d: DVec3, start: Start) -> Spans {
        let length = d.length();
        let d = d / length;
        match start {
            Start::Elsewhere => {
                let shift = -o.dot(d);
                let p = o + d * shift;
                let again = -p.dot(d);
                let line = Line { p: p + d * again, d };
                self.whole(line, |s| (s + (shift + again)) / length)
            }
            Start::Inside | Start::Outside => {
                let inward = start == Start::Inside;
                let mut spans = self.leaving_surface(Line { p: o, d }, inward, |s| s / length);
                spans.start_on_surface(start);
                spans
            }
        }
    }

    /// Appends where the whole line enters and leaves; one that a ray starts on is 0.
    pub(super) fn crossings(&self, o: DVec3, d: DVec3, start: Start, out: &mut Vec<f64>) {
        out.extend_from_slice(self.spans(o, d, start).ends());
    }

    /// The crossings of a line at its closest approach to the centre.
    #[inline(always)]
    fn whole(&self, line: Line, t: impl Fn(f64) -> f64) -> Spans {
        let Some((low, high)) = self.reach(&line) else { return Spans::NONE };
        // s⁴ + a s² + b s + c, in which p·d = 0 has made −8R²(pₓdₓ + p_y d_y) one product.
        let r2 = self.major * self.major;
        let a = 2.0 * (line.p.length_squared() - r2 - self.minor * self.minor)
            + 4.0 * r2 * (line.d.z * line.d.z);
        let b = 8.0 * r2 * (line.p.z * line.d.z);
        let mut marks = Marks::from(low);
        let mark = |s: f64| {
            let within = low < s && s < high;
            within.then(|| Mark { s, inside: self.value(&line, s) < 0.0 })
        };
        match turning_points(a, b) {
            Turns::One(s) => marks.extend(mark(s)),
            Turns::Three([first, middle, last]) => {
                let (first, last) = (mark(first), mark(last));
                marks.extend(first);
                // It separates two stretches inside; a tube without a hole is hard to tell apart there.
                let both = first.zip(last).is_some_and(|(a, b)| a.inside && b.inside);
                if both || self.minor >= self.major {
                    marks.extend(mark(middle));
                }
                marks.extend(last);
            }
        }
        marks.extend(Some(Mark { s: high, inside: false }));
        self.spans_between(&line, &marks, t)
    }

    /// The crossings of a line that goes through the surface at 0: the quartic without that root.
    fn leaving_surface(&self, line: Line, inward: bool, t: impl Fn(f64) -> f64) -> Spans {
        let (low, high) = self.reach_around(&line);
        let Line { p, d } = line;
        let (r2, n) = (self.major * self.major, p.dot(d));
        let rho = p.truncate().length();
        // s³ + e s² + a s + b; b is the slope of the quartic, from the gradient of the tube.
        let e = 4.0 * n;
        let m = p.length_squared() + (self.major - self.minor) * (self.major + self.minor);
        let a = 4.0 * n * n + 2.0 * m - 4.0 * r2 * (1.0 - d.z * d.z);
        let outward = (rho - self.major) * p.truncate().dot(d.truncate()) + rho * (p.z * d.z);
        let b = 8.0 * self.major * outward;
        let b = if inward { b.min(0.0) } else { b.max(0.0) };
        let inside = |s: f64| {
            let quartic = s * (((s + e) * s + a) * s + b);
            quartic < 0.0 || self.is_covered_twice(line.p + line.d * s)
        };
        let mut marks = Marks::from(low);
        let turns = turns_of_cubic(e, a);
        let within = |s: &f64| low < *s && *s < high;
        let mark = |s: f64| Mark { s, inside: inside(s) };
        marks.extend(turns.into_iter().filter(|s| within(s) && *s < 0.0).map(mark));
        marks.extend([Mark { s: 0.0, inside: !inward }, Mark { s: 0.0, inside: inward }]);
        marks.extend(turns.into_iter().filter(|s| within(s) && *s > 0.0).map(mark));
        marks.extend([Mark { s: high, inside: false }]);
        self.spans_between(&line, &marks, t)
    }

    /// Turns every change between marks into a crossing.
    #[inline(always)]
    fn spans_between(&self, line: &Line, marks: &Marks, t: impl Fn(f64) -> f64) -> Spans {
        let mut spans = Spans::NONE;
        let mut entered = 0.0;
        for pair in marks.list[..marks.count.min(MOST_MARKS)].windows(2) {
            let (from, to) = (pair[0], pair[1]);
            if from.inside == to.inside {
                continue;
            }
            let s = if from.s == to.s { from.s } else { self.crossing(line, from, to) };
            if to.inside {
                entered = t(s);
            } else {
                spans.push(entered, t(s));
            }
        }
        spans
    }

    /// The one crossing between two marks, by Newton's steps on the tube's own function, held between
    /// them: its rounding is that of the distance to the circle, not of a quartic.
    #[inline(always)]
    fn crossing(&self, line: &Line, from: Mark, to: Mark) -> f64 {
        let (mut low, mut high) = (from.s, to.s);
        let small = LAST_STEP * (self.major + self.minor);
        let mut s = self.guess(line, from, to);
        for _ in 0..MOST_STEPS {
            let (value, step) = self.newton(line, s);
            if (value < 0.0) == from.inside {
                low = s;
            } else {
                high = s;
            }
            let next = s - step;
            let stays = low <= next && next <= high;
            let next = if stays { next } else { low + (high - low) * 0.5 };
            let last = (next - s).abs() <= small && stays || next == low || next == high;
            s = next;
            if last {
                break;
            }
        }
        s
    }

    /// Where to begin: the function is close to a parabola around where the line is deepest inside.
    #[inline(always)]
    fn guess(&self, line: &Line, from: Mark, to: Mark) -> f64 {
        let deepest = if from.inside { from.s } else { to.s };
        let p = line.p + line.d * deepest;
        let rho2 = p.x * p.x + p.y * p.y;
        let rho = rho2.sqrt();
        let depth = self.value_at(rho, p.z);
        let radial = (p.x * line.d.x + p.y * line.d.y) / rho;
        let flat = line.d.x * line.d.x + line.d.y * line.d.y;
        // Half the second derivative of (ρ − R)² + z².
        let bend = 1.0 - self.major * (flat - radial * radial) / rho;
        let half = (-depth / bend).sqrt();
        let s = if from.inside { deepest + half } else { deepest - half };
        if from.s < s && s < to.s { s } else { from.s + (to.s - from.s) * 0.5 }
    }

    /// (ρ − R)² + z² − r² at a point of a line: below 0 inside, also where the tube covers it twice.
    #[inline(always)]
    fn value(&self, line: &Line, s: f64) -> f64 {
        let p = line.p + line.d * s;
        self.value_at((p.x * p.x + p.y * p.y).sqrt(), p.z)
    }

    #[inline(always)]
    fn value_at(&self, rho: f64, z: f64) -> f64 {
        let across = rho - self.major;
        across * across + (z - self.minor) * (z + self.minor)
    }

    /// The same with its quotient by its derivative along the line.
    #[inline(always)]
    fn newton(&self, line: &Line, s: f64) -> (f64, f64) {
        let p = line.p + line.d * s;
        let rho = (p.x * p.x + p.y * p.y).sqrt();
        let value = self.value_at(rho, p.z);
        let radial = p.x * line.d.x + p.y * line.d.y;
        let slope = (rho - self.major) * radial + p.z * line.d.z * rho;
        (value, value * rho / (2.0 * slope))
    }

    /// Whether a point lies where a tube without a hole overlaps itself.
    fn is_covered_twice(&self, p: DVec3) -> bool {
        let across = p.truncate().length() + self.major;
        across * across + (p.z - self.minor) * (p.z + self.minor) < 0.0
    }

    /// Where a line at its closest approach is within the ball and the slab around the solid.
    #[inline(always)]
    fn reach(&self, line: &Line) -> Option<(f64, f64)> {
        let (radius, distance) = (self.major + self.minor, line.p.length());
        if distance >= radius {
            return None;
        }
        let half = ((radius - distance) * (radius + distance)).sqrt();
        let (first, last) = slab([-self.minor, self.minor], line.p.z, line.d.z)?;
        let (low, high) = (first.max(-half), last.min(half));
        (low < high).then_some((low, high))
    }

    /// The same of a line through a point of the surface; 0 is within.
    fn reach_around(&self, line: &Line) -> (f64, f64) {
        let whole = 2.0 * (self.major + self.minor);
        let (first, last) = slab([-self.minor, self.minor], line.p.z, line.d.z)
            .unwrap_or((f64::NEG_INFINITY, f64::INFINITY));
        (first.max(-whole).min(0.0), last.min(whole).max(0.0))
    }

    /// Point and unit normal where a ray meets it at `t`.
    pub(super) fn surface(&self, o: DVec3, d: DVec3, t: f64) -> (DVec3, DVec3) {
        let p = o + d * t;
        let rho = p.truncate().length();
        // On the axis, where a tube without a hole is pointed, any radius is as good.
        let out = if rho > 0.0 { p.truncate() / rho } else { glam::DVec2::ZERO };
        let ring = out.extend(0.0) * self.major;
        let normal = (p - ring).normalize_or(DVec3::Z);
        (ring + normal * self.minor, normal)
    }

    /// u around the axis from +x towards +y; v around the tube, ½ on the outer equator, growing
    /// upwards there. With their gradients.
    pub(super) fn uv(&self, p: DVec3) -> ([f64; 2], [DVec3; 2]) {
        let (u, around) = super::uv::longitude(p.truncate());
        let rho = p.truncate().length();
        let (across, out) = (rho - self.major, p.truncate() / rho.max(f64::MIN_POSITIVE));
        let size2 = across * across + p.z * p.z;
        let upward = (out * -p.z).extend(across) / (std::f64::consts::TAU * size2);
        let v = 0.5 + libm::atan2(p.z, across) / std::f64::consts::TAU;
        ([u, v], [around, if upward.is_finite() { upward } else { DVec3::ZERO }])
    }
}

/// Marks at most: two ends, two of the root that is known, three turning points.
const MOST_MARKS: usize = 7;

/// Parameters on a line, in order.
struct Marks {
    list: [Mark; MOST_MARKS],
    count: usize,
}

impl Marks {
    /// Begins outside.
    #[inline(always)]
    fn from(low: f64) -> Marks {
        Marks { list: [Mark { s: low, inside: false }; MOST_MARKS], count: 1 }
    }

    #[inline(always)]
    fn extend(&mut self, marks: impl IntoIterator<Item = Mark>) {
        for mark in marks {
            if self.count < MOST_MARKS {
                self.list[self.count] = mark;
                self.count += 1;
            }
        }
    }
}

/// Where a quartic without a cubic term turns, in ascending order, as exactly as half the digits: there
/// it is flat.
enum Turns {
    One(f64),
    Three([f64; 3]),
}

/// Those of s⁴ + a s² + b s + c: the roots of s³ + 3A s + 2B with A = a/6, B = b/8.
///
/// Newton's steps from guesses within 2 % (three roots) and 32 % (one), as many as half the digits
/// need at most.
#[inline(always)]
fn turning_points(a: f64, b: f64) -> Turns {
    let (third, half) = (a / 6.0, b / 8.0);
    let width = (-third).max(0.0).sqrt();
    let limit = width * width * width;
    if half.abs() < limit {
        // x³ − 3x + 2τ = 0 in units of the width.
        let tau = half / limit;
        let outer = |tau: f64| {
            let mut x = 1.0 + 0.732_050_8 * (1.0 - tau).sqrt();
            for _ in 0..3 {
                let square = x * x;
                x -= (x * (square - 3.0) + 2.0 * tau) / (3.0 * (square - 1.0));
            }
            x * width
        };
        let (first, last) = (-outer(-tau), outer(tau));
        return Turns::Three([first, -(first + last), last]);
    }
    let root = libm::cbrt(2.0 * half.abs());
    let mut x = if third < 0.0 {
        root - third / root
    } else if third > 0.0 {
        root.min(2.0 * half.abs() / (3.0 * third))
    } else {
        root
    };
    for _ in 0..5 {
        let square = x * x;
        let slope = 3.0 * (square + third);
        if slope > 0.0 {
            x -= (x * (square + 3.0 * third) - 2.0 * half.abs()) / slope;
        }
    }
    Turns::One(if half > 0.0 { -x } else { x })
}

/// Where s⁴ + e s³ + … without its root at 0, a cubic s³ + e s² + a s + b, turns.
fn turns_of_cubic(e: f64, a: f64) -> [f64; 2] {
    let discriminant = e * e - 3.0 * a;
    // NaN is within nothing.
    let q = -(e + discriminant.sqrt().copysign(e));
    let (one, other) = (q / 3.0, a / q);
    if one < other { [one, other] } else { [other, one] }
}
