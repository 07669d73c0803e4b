//! Ways to find where a line meets a torus, and lines for which that is known: what tests and `bench`
//! hold them to.

use glam::DVec3;

use super::primitive::Start;
use super::torus::Torus;

/// The distance from 1 to the next larger number.
pub(crate) const EPS: f64 = f64::EPSILON;

/// A way to find where a line meets a torus of major radius 1, from its minor radius and the line's
/// origin and direction.
pub(crate) type Solver = fn(f64, DVec3, DVec3) -> Roots;

/// At most six numbers, in any order.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Roots {
    list: [f64; 6],
    count: usize,
}

impl Roots {
    /// The first six of some numbers.
    pub(crate) fn of(all: impl IntoIterator<Item = f64>) -> Roots {
        let mut roots = Roots::default();
        for (place, t) in roots.list.iter_mut().zip(all) {
            *place = t;
            roots.count += 1;
        }
        roots
    }

    /// The numbers.
    pub(crate) fn all(&self) -> &[f64] {
        &self.list[..self.count]
    }

    fn sorted(mut self) -> Roots {
        self.list[..self.count].sort_unstable_by(f64::total_cmp);
        self
    }
}

/// Every solver by its name, the program's own first.
pub(crate) const SOLVERS: [(&str, Solver); 4] = [
    ("between turning points (ours)", ours),
    ("Ferrari at the closest approach", ferrari_shifted),
    ("the same with two steps of Newton", ferrari_polished),
    ("Ferrari from the ray's origin", ferrari_raw),
];

/// The program's own way: roots are sought between the turning points of the quartic.
pub(crate) fn ours(minor: f64, o: DVec3, d: DVec3) -> Roots {
    let spans = Torus { major: 1.0, minor }.spans(o, d, Start::Elsewhere);
    Roots::of(spans.ends().iter().copied())
}

/// A line with what it meets.
pub(crate) struct Case {
    pub(crate) minor: f64,
    pub(crate) o: DVec3,
    pub(crate) d: DVec3,
    pub(crate) roots: Vec<f64>,
    /// What a root may be off.
    tolerance: f64,
}

/// Lines that are hard for one reason.
pub(crate) struct Category {
    pub(crate) name: String,
    pub(crate) cases: Vec<Case>,
}

/// A line along y at a height, at a distance from the plane x = 0, seen from `far` away. It meets two
/// circles.
fn level(minor: f64, x: f64, z: f64, far: f64) -> Case {
    let half = ((minor - z) * (minor + z)).max(0.0).sqrt();
    let mut roots = vec![];
    for rho in [1.0 + half, 1.0 - half] {
        let squared = (rho - x) * (rho + x);
        if z.abs() < minor && squared > 0.0 && rho > 0.0 {
            roots.extend([far - squared.sqrt(), far + squared.sqrt()]);
        }
    }
    case(minor, DVec3::new(x, -far, z), DVec3::Y, roots)
}

/// A line in the plane y = 0 through (x, z) along (a, b), seen from `far` away. It meets two circles.
fn meridian(minor: f64, (x, z): (f64, f64), (a, b): (f64, f64), far: f64) -> Case {
    let squared = a * a + b * b;
    let mut spans = vec![];
    for center in [1.0, -1.0] {
        let (x, middle) = (x - center, -((x - center) * a + z * b) / squared);
        let distance = (x * b - z * a).abs() / squared.sqrt();
        if distance < minor {
            let half = ((minor - distance) * (minor + distance) / squared).sqrt();
            spans.push([far + middle - half, far + middle + half]);
        }
    }
    // Where both circles overlap, the tube has no hole.
    let roots = match spans[..] {
        [[a, b], [c, d]] if a <= d && c <= b => vec![a.min(c), b.max(d)],
        _ => spans.concat(),
    };
    let (o, d) = (DVec3::new(x - a * far, 0.0, z - b * far), DVec3::new(a, 0.0, b));
    case(minor, o, d, roots)
}

fn case(minor: f64, o: DVec3, d: DVec3, mut roots: Vec<f64>) -> Case {
    roots.sort_unstable_by(f64::total_cmp);
    let apart = roots.windows(2).map(|pair| pair[1] - pair[0]).fold(1.0, f64::min);
    // Roots that are close together turn an error of the line by ε into one of ε/√δ.
    let tolerance = 4.0 * EPS * (1.0 + o.length()) / (d.length() * apart.min(1.0));
    Case { minor, o, d, roots, tolerance }
}

/// Lines whose crossings are known, by what makes them hard, from numbers at random in −1 … 1. Nothing in
/// them is rounded.
pub(crate) fn lines(signed: &mut dyn FnMut() -> f64) -> Vec<Category> {
    let mut dyadic = |scale: f64| (signed() * 4096.0).round() / 4096.0 * scale;
    let mut all = vec![];
    for minor in [0.3, 0.1, 1e-2, 1e-3, 1e-4, 0.999] {
        let near = |w: f64| if minor < 0.2 { w * minor } else { w };
        let mut cases = vec![];
        for _ in 0..300 {
            cases.push(level(minor, dyadic(1.0) + near(dyadic(0.5)), near(dyadic(0.5)), 4.0));
            let through = (1.0 + near(dyadic(0.25)), near(dyadic(0.25)));
            cases.push(meridian(minor, through, (dyadic(1.0), dyadic(1.0) + 1.5), 4.0));
        }
        all.push(Category { name: format!("minor radius {minor}"), cases });
    }
    for exponent in [6, 10, 14, 20] {
        let far = 2f64.powi(exponent);
        let mut cases = vec![];
        for _ in 0..300 {
            cases.push(level(0.3, dyadic(1.0), dyadic(0.25), far));
            cases.push(meridian(0.3, (1.0 + dyadic(0.25), dyadic(0.25)), (dyadic(1.0), 0.75), far));
        }
        all.push(Category { name: format!("from 2^{exponent}"), cases });
    }
    let mut cases = vec![];
    for minor in [1.0, 1.25, 1.5, 4.0] {
        for _ in 0..200 {
            cases.push(meridian(minor, (dyadic(1.0), dyadic(0.5)), (dyadic(1.0), 0.75), 4.0));
            cases.push(level(minor, dyadic(2.0), dyadic(0.25), 4.0));
        }
    }
    all.push(Category { name: "no hole".into(), cases });
    let axis = |x: f64| meridian(0.3, (x, 0.0), (0.0, 1.0), 4.0);
    let cases = (0..300).map(|_| axis(dyadic(1.5))).collect();
    all.push(Category { name: "along the axis".into(), cases });
    for exponent in [2, 4, 6, 8, 10, 12] {
        let delta = 10f64.powi(-exponent);
        let mut inside = vec![];
        let mut outside = vec![];
        for side in [-1.0, 1.0] {
            // The outer equator, the inner one, and the plane on top, by a little.
            inside.push(level(0.3, (1.3 - delta) * side, 0.0, 4.0));
            outside.push(level(0.3, (1.3 + delta) * side, 0.0, 4.0));
            inside.push(level(0.3, (0.7 - delta) * side, 0.0, 4.0));
            outside.push(level(0.3, (0.7 + delta) * side, 0.0, 4.0));
            inside.push(level(0.3, 0.25, (0.3 - delta) * side, 4.0));
            outside.push(level(0.3, 0.25, (0.3 + delta) * side, 4.0));
        }
        for case in inside.iter_mut().chain(&mut outside) {
            case.tolerance = case.tolerance.min(8.0 * EPS * 4.0 / delta.sqrt()).max(1e-14);
        }
        all.push(Category { name: format!("tangent inside by 1e-{exponent}"), cases: inside });
        all.push(Category { name: format!("tangent outside by 1e-{exponent}"), cases: outside });
    }
    all
}

/// How a solver did.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Found {
    /// Lines with a wrong number of crossings.
    pub(crate) wrong: usize,
    /// How far the worst crossing of the other lines is off.
    pub(crate) error: f64,
    /// The same in units of what it may be off.
    pub(crate) share: f64,
}

/// Holds a solver to what is known.
pub(crate) fn judge(solver: Solver, cases: &[Case]) -> Found {
    let mut all = Found::default();
    for Case { minor, o, d, roots, tolerance } in cases {
        let found = solver(*minor, *o, *d);
        if found.all().len() != roots.len() {
            all.wrong += 1;
            continue;
        }
        for (a, b) in found.all().iter().zip(roots) {
            let off = (a - b).abs();
            all.error = all.error.max(off);
            all.share = all.share.max(off / tolerance);
        }
    }
    all
}

/// The quartic's coefficients for a line that was moved to its closest approach, and by how much.
fn shifted(minor: f64, o: DVec3, d: DVec3) -> ([f64; 3], f64, DVec3) {
    let t0 = -o.dot(d) / d.length_squared();
    let p = o + d * t0;
    let again = -p.dot(d) / d.length_squared();
    let p = p + d * again;
    let a = 2.0 * (p.length_squared() - 1.0 - minor * minor) + 4.0 * d.z * d.z;
    let b = 8.0 * p.z * d.z;
    let rho = p.truncate().length();
    let g = |sign: f64| (rho + sign).powi(2) + p.z * p.z - minor * minor;
    ([a, b, g(-1.0) * g(1.0)], t0 + again, p)
}

/// Ferrari's solution of s⁴ + a s² + b s + c.
fn ferrari([a, b, c]: [f64; 3]) -> Roots {
    // A positive root of m³ + a m² + (a²/4 − c) m − b²/8.
    let value = |m: f64| ((m + a) * m + (a * a / 4.0 - c)) * m - b * b / 8.0;
    let slope = |m: f64| (3.0 * m + 2.0 * a) * m + (a * a / 4.0 - c);
    if b == 0.0 {
        let half = (a * a / 4.0 - c).sqrt();
        let both = [-a / 2.0 - half, -a / 2.0 + half].into_iter().filter(|square| *square >= 0.0);
        return Roots::of(both.flat_map(|square| [-square.sqrt(), square.sqrt()])).sorted();
    }
    let mut m = a.abs() + (b * b).cbrt() + c.abs().sqrt();
    for _ in 0..60 {
        let next = m - value(m) / slope(m);
        if next >= m {
            break;
        }
        m = next;
    }
    let root = (2.0 * m.max(0.0)).sqrt();
    let pair = |sign: f64| {
        let rest = -2.0 * (a + m) - sign * (2.0 * b / root);
        let two = [(sign * root - rest.sqrt()) / 2.0, (sign * root + rest.sqrt()) / 2.0];
        two.into_iter().filter(move |_| rest >= 0.0)
    };
    Roots::of([-1.0, 1.0].into_iter().flat_map(pair)).sorted()
}

/// Ferrari's solution from the point of the line nearest to the centre.
pub(crate) fn ferrari_shifted(minor: f64, o: DVec3, d: DVec3) -> Roots {
    let (coefficients, t0, _) = shifted(minor, o, d);
    Roots::of(ferrari(coefficients).all().iter().map(|s| s + t0))
}

fn ferrari_polished(minor: f64, o: DVec3, d: DVec3) -> Roots {
    let (coefficients, t0, p) = shifted(minor, o, d);
    let polish = |s: f64| {
        let mut s = s;
        for _ in 0..2 {
            let at = p + d * s;
            let rho = at.truncate().length();
            let value = (rho - 1.0).powi(2) + at.z * at.z - minor * minor;
            let slope = (rho - 1.0) * at.truncate().dot(d.truncate()) / rho + at.z * d.z;
            s -= value / (2.0 * slope);
        }
        s + t0
    };
    Roots::of(ferrari(coefficients).all().iter().map(|s| polish(*s)))
}

/// The textbook: the quartic as it is, its cubic term taken out.
fn ferrari_raw(minor: f64, o: DVec3, d: DVec3) -> Roots {
    let [dd, od] = [d.length_squared(), o.dot(d)];
    let k = o.length_squared() + 1.0 - minor * minor;
    let flat = |a: DVec3, b: DVec3| a.x * b.x + a.y * b.y;
    // t⁴ + b t³ + c t² + d t + e after division.
    let lead = dd * dd;
    let third = 4.0 * dd * od / lead;
    let second = (2.0 * dd * k + 4.0 * od * od - 4.0 * flat(d, d)) / lead;
    let first = (4.0 * k * od - 8.0 * flat(o, d)) / lead;
    let zeroth = (k * k - 4.0 * flat(o, o)) / lead;
    let move_by = third / 4.0;
    let square = third * third;
    let a = second - 3.0 / 8.0 * square;
    let b = first - third * second / 2.0 + square * third / 8.0;
    let c = zeroth - third * first / 4.0 + square * second / 16.0 - 3.0 / 256.0 * square * square;
    Roots::of(ferrari([a, b, c]).all().iter().map(|s| s - move_by))
}
