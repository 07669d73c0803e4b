//! Cylinders, cones, tori, quadrics and prisms: crossings against truths and against the functions that
//! define them.

use glam::{DVec2, DVec3};

use super::frustum::Frustum;
use super::primitive::{Start, sphere_roots};
use super::prism::Prism;
use super::quadric::Quadric;
use super::shear::product_error;
use super::testing::Random;
use super::torus::Torus;

const EPS: f64 = f64::EPSILON;

/// Where a line enters and leaves.
type Crossings = Box<dyn Fn(DVec3, DVec3, Start) -> Vec<f64>>;
/// Below 0 inside, above outside; around 0 about the distance from the surface.
type Inside = Box<dyn Fn(DVec3) -> f64>;

fn listed(fill: impl Fn(DVec3, DVec3, Start, &mut Vec<f64>) + 'static) -> Crossings {
    Box::new(move |o, d, start| {
        let mut out = vec![];
        fill(o, d, start, &mut out);
        out
    })
}

fn frustum(radii: [f64; 2], height: f64) -> (Crossings, Inside) {
    let solid = Frustum { radii, height };
    let slope = (radii[1] - radii[0]) / height;
    let inside = move |p: DVec3| {
        let side = p.truncate().length() - (radii[0] + slope * p.z);
        let side = side / (1.0 + slope * slope).sqrt();
        side.max(-p.z).max(p.z - height)
    };
    (listed(move |o, d, start, out| solid.crossings(o, d, start, out)), Box::new(inside))
}

fn torus(major: f64, minor: f64) -> (Crossings, Inside) {
    let solid = Torus { major, minor };
    let inside = move |p: DVec3| DVec2::new(p.truncate().length() - major, p.z).length() - minor;
    (listed(move |o, d, start, out| solid.crossings(o, d, start, out)), Box::new(inside))
}

fn quadric(
    coefficients: super::quadric::Coefficients,
    [min, max]: [DVec3; 2],
) -> (Crossings, Inside) {
    let solid = Quadric::new(coefficients, [min, max]);
    let ([xx, yy, zz], [yz, zx, xy], linear, constant) = coefficients;
    let inside = move |p: DVec3| {
        let squares = xx * p.x * p.x + yy * p.y * p.y + zz * p.z * p.z;
        let products = yz * p.y * p.z + zx * p.z * p.x + xy * p.x * p.y;
        let value = squares + products + p.dot(DVec3::from(linear)) + constant;
        let off = (min - p).max(p - max).max_element();
        value.max(off)
    };
    (listed(move |o, d, start, out| solid.crossings(o, d, start, out)), Box::new(inside))
}

/// A comb with a hole, none of its sides parallel to an axis.
fn comb() -> Vec<Vec<DVec2>> {
    let outline = [
        [-1.2, -1.0],
        [1.1, -0.9],
        [1.0, 0.8],
        [0.6, 1.1],
        [0.5, 0.1],
        [0.2, 0.15],
        [0.15, 1.0],
        [-0.2, 0.9],
        [-0.25, 0.1],
        [-0.6, 0.05],
        [-0.7, 1.2],
        [-1.1, 0.7],
    ];
    let hole = [[-0.5, -0.7], [0.6, -0.6], [0.1, -0.2]];
    let points = |list: &[[f64; 2]]| list.iter().copied().map(DVec2::from).collect();
    vec![points(&outline), points(&hole)]
}

fn prism(loops: Vec<Vec<DVec2>>, heights: [f64; 2]) -> (Crossings, Inside) {
    let solid = Prism::new(&loops, heights);
    let edges: Vec<(DVec2, DVec2)> = loops
        .iter()
        .flat_map(|l| l.iter().copied().zip(l.iter().copied().cycle().skip(1)))
        .collect();
    let inside = move |p: DVec3| {
        let mut odd = false;
        let mut nearest = f64::INFINITY;
        for &(a, b) in &edges {
            if (a.y > p.y) != (b.y > p.y) {
                odd ^= p.x < a.x + (b.x - a.x) * ((p.y - a.y) / (b.y - a.y));
            }
            let along = ((p.truncate() - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
            nearest = nearest.min((p.truncate() - a.lerp(b, along)).length());
        }
        let flat = if odd { -nearest } else { nearest };
        flat.max(heights[0] - p.z).max(p.z - heights[1])
    };
    (listed(move |o, d, start, out| solid.crossings(o, d, start, out)), Box::new(inside))
}

/// Every kind of solid, of about size 1 around the origin.
fn all() -> Vec<(&'static str, Crossings, Inside)> {
    let cube = [DVec3::NEG_ONE, DVec3::new(1.0, 1.1, 0.9)];
    let none = [0.0; 3];
    let named = |name, (crossings, inside)| (name, crossings, inside);
    vec![
        named("cylinder", frustum([0.7; 2], 1.3)),
        named("wire", frustum([0.02; 2], 1.5)),
        named("cone", frustum([1.0, 0.0], 1.4)),
        named("cone on its tip", frustum([0.0, 0.8], 0.9)),
        named("truncated cone", frustum([0.9, 0.3], 1.0)),
        named("flat cone", frustum([1.0, 0.0], 0.01)),
        named("torus", torus(1.0, 0.3)),
        named("thin torus", torus(1.0, 0.02)),
        named("horn torus", torus(0.6, 0.6)),
        named("spindle torus", torus(0.4, 0.7)),
        named("almost a sphere", torus(1e-3, 0.9)),
        named("ellipsoid", quadric(([1.5, 2.0, 4.0], none, none, -1.0), cube)),
        named("hyperboloid", quadric(([1.0, 1.0, -1.0], none, none, -0.2), cube)),
        named("two sheets", quadric(([1.0, 1.0, -1.0], none, none, 0.1), cube)),
        named("outside of a ball", quadric(([-1.0, -1.0, -1.0], none, none, 0.8), cube)),
        named("paraboloid", quadric(([1.0, 1.0, 0.0], none, [0.0, 0.0, -1.0], -0.4), cube)),
        named("saddle", quadric(([1.0, -1.0, 0.0], none, [0.0, 0.0, 1.0], 0.0), cube)),
        named(
            "tilted",
            quadric(([1.0, 0.3, -0.5], [0.4, -0.7, 0.9], [0.2, 0.1, -0.3], -0.1), cube),
        ),
        named("half-space", quadric((none, none, [1.0, 2.0, -1.0], 0.1), cube)),
        named("comb", prism(comb(), [-0.4, 0.5])),
    ]
}

/// A third along an axis or a plane, a third aimed close to the middle from far away, a third random.
fn ray(random: &mut Random) -> (DVec3, DVec3) {
    let far = [1.5, 3.0, 1e3, 1e6][random.below(4)];
    match random.below(3) {
        0 => {
            let mut d = random.direction().to_array();
            d[random.below(3)] = 0.0;
            if random.below(2) == 0 {
                d[random.below(3)] = -0.0;
            }
            let d = DVec3::from(d).normalize_or(DVec3::X);
            ((random.in_cube() * 8.0).round() / 8.0 - d * far, d)
        }
        1 => {
            let o = random.direction() * far;
            (o, (random.in_cube() * 0.8 - o).normalize())
        }
        _ => (random.in_cube() * 2.0, random.direction() * (1.0 + 0.5 * random.signed())),
    }
}

/// What is wrong with a list of crossings of a line by the solid's own function; the distance within
/// which rounding may decide otherwise is `margin`.
fn fault(ends: &[f64], o: DVec3, d: DVec3, inside: &Inside, margin: f64) -> Option<String> {
    if !ends.len().is_multiple_of(2) || ends.iter().any(|t| t.is_nan()) {
        return Some(format!("{ends:?}"));
    }
    if ends.windows(2).any(|pair| pair[0] > pair[1]) {
        return Some(format!("not sorted: {ends:?}"));
    }
    let at = |t: f64| inside(o + d * t);
    for (i, t) in ends.iter().enumerate() {
        if t.is_finite() && at(*t).abs() > margin {
            return Some(format!("crossing {i} of {ends:?} is {:e} off the surface", at(*t)));
        }
    }
    // A walk over the whole solid.
    let middle = -o.dot(d) / d.length_squared();
    let reach = 3.0 / d.length();
    (0..=200).find_map(|step| {
        let t = middle + reach * (f64::from(step) / 100.0 - 1.0);
        let listed = ends.iter().filter(|end| **end < t).count() % 2 == 1;
        let value = at(t);
        let wrong = listed != (value < 0.0) && value.abs() > margin;
        wrong.then(|| format!("at {t} inside is {listed}, but {value:e}; {ends:?}"))
    })
}

/// By how much a point on a line that far out may be off.
fn margin(o: DVec3) -> f64 {
    64.0 * EPS * (o.length() + 2.0)
}

#[test]
fn quadrics_torus_and_prisms_by_sign_walks() {
    for (name, crossings, inside) in all() {
        let mut random = Random(17);
        let mut met = 0;
        for _ in 0..20_000 {
            let (o, d) = ray(&mut random);
            let ends = crossings(o, d, Start::Elsewhere);
            met += usize::from(!ends.is_empty());
            if let Some(what) = fault(&ends, o, d, &inside, margin(o)) {
                panic!("{name}: {what}\n from {o:?} along {d:?}");
            }
        }
        assert!(met > 200, "{name}: {met}");
    }
}

#[test]
fn wrong_crossings_are_noticed() {
    let (_, inside) = torus(1.0, 0.3);
    let (o, d) = (DVec3::new(-5.0, 0.0, 0.0), DVec3::X);
    let of = |ends: &[f64]| fault(ends, o, d, &inside, margin(o));
    assert_eq!(of(&[3.7, 4.3, 5.7, 6.3]), None);
    assert!(of(&[3.7, 4.3]).is_some(), "lost");
    assert!(of(&[3.7, 4.3, 5.7]).is_some(), "odd");
    assert!(of(&[3.7, 4.3, 4.3001, 4.3002, 5.7, 6.3]).is_some(), "invented");
    assert!(of(&[3.7, 4.3, 5.7, 6.3 + 1e-12]).is_some(), "imprecise");
}

/// An unevaluated sum of two numbers: about 32 digits (Dekker, 1971).
#[derive(Clone, Copy)]
struct Wide(f64, f64);

impl Wide {
    fn sum(a: f64, b: f64) -> Wide {
        let sum = a + b;
        let part = sum - a;
        Wide(sum, (a - (sum - part)) + (b - part))
    }

    fn product(a: f64, b: f64) -> Wide {
        Wide(a * b, product_error(a, b))
    }

    fn plus(self, other: Wide) -> Wide {
        let Wide(sum, error) = Wide::sum(self.0, other.0);
        Wide::sum(sum, error + self.1 + other.1)
    }

    fn minus(self, other: Wide) -> Wide {
        self.plus(Wide(-other.0, -other.1))
    }

    fn squared(self) -> Wide {
        let Wide(square, error) = Wide::product(self.0, self.0);
        Wide::sum(square, error + 2.0 * self.0 * self.1)
    }
}

/// How much farther than r a line passes the origin, and how far points of it are from |p| = r.
fn beside(o: DVec3, d: DVec3, r: f64, ts: &[f64]) -> (f64, Vec<f64>) {
    let add = |[a, b, c]: [Wide; 3]| a.plus(b).plus(c);
    let moment = |i: usize, j: usize| Wide::product(o[i], d[j]).minus(Wide::product(o[j], d[i]));
    let moments = add([moment(1, 2), moment(2, 0), moment(0, 1)].map(Wide::squared));
    let lengths = add([0, 1, 2].map(|i| Wide::product(d[i], d[i])));
    let Wide(high, low) = Wide::product(r, r);
    let reach = Wide(high * lengths.0, product_error(high, lengths.0));
    let reach = reach.plus(Wide(high * lengths.1 + low * lengths.0, 0.0));
    let passed = (moments.0 / lengths.0).sqrt();
    let beyond = moments.minus(reach).0 / (lengths.0 * (passed + r));
    let off = |t: &f64| {
        let at = |i: usize| Wide::sum(o[i], 0.0).plus(Wide::product(*t, d[i])).squared();
        add([at(0), at(1), at(2)]).minus(Wide(high, low)).0 / (2.0 * r)
    };
    (beyond, ts.iter().map(off).collect())
}

#[test]
fn quadrics_spheres_of_all_sizes_and_distances_are_decided_within_eight_roundings() {
    let mut random = Random(37);
    let (mut decided, mut met, mut worst) = (0, 0, 0.0f64);
    for i in 0..200_000 {
        let r = 10f64.powi(i % 9 - 4) * (1.0 + 0.5 * random.signed());
        let far = r * 10f64.powf(4.0 + 3.7 * random.signed());
        let o = random.direction() * far;
        // At the rim and about it, by all powers of ten.
        let rim = o.cross(random.direction()).normalize() * r;
        let beside_rim = 1.0 + random.signed() * 10f64.powi(-(random.below(17) as i32));
        let d = (rim * beside_rim - o).normalize();
        let roots = sphere_roots(o, d, 1.0, r, Start::Elsewhere);
        let ts =
            [roots.near, roots.far].map(|t| if t.is_nan() { vec![] } else { vec![t] }).concat();
        let (beyond, off) = beside(o, d, r, &ts);
        assert!(ts.len() != 1, "{ts:?}");
        if beyond.abs() > 8.0 * EPS * far {
            assert_eq!(ts.len() == 2, beyond < 0.0, "{beyond:e} beside {r} from {far}");
            decided += 1;
            met += usize::from(!ts.is_empty());
        }
        worst = off.iter().fold(worst, |worst, off| worst.max(off.abs() / (EPS * far.max(r))));
    }
    assert!(worst <= 4.0, "a point is {worst} ε·max(d, r) off");
    assert!(decided > 100_000 && met > 30_000, "{decided} {met}");
}

#[test]
fn quadrics_a_wrong_decision_is_noticed() {
    let (o, d) = (DVec3::new(1.0, 0.0, -1e6), DVec3::Z);
    let (beyond, off) = beside(o, d, 1.0 + EPS, &[1e6, 1e6 + 1e-6]);
    assert!((beyond + EPS).abs() < 1e-20, "{beyond:e}");
    assert!((off[0] + EPS).abs() < 1e-20 && (off[1] / 5e-13 - 1.0).abs() < 1e-2, "{off:?}");
}

#[test]
fn quadrics_cylinder_along_its_axis() {
    // In the plane y = 0: the side is left at x = 1, so t = (1 − x)/sin δ.
    let tall = Frustum { radii: [1.0; 2], height: 1e10 };
    let cut = Frustum { radii: [1.0; 2], height: 2.0 };
    for exponent in 1..=9 {
        let delta = 10f64.powi(-exponent);
        for x in [-0.75, 0.25, 0.5] {
            let o = DVec3::new(x, 0.0, -3.0);
            let d = DVec3::new(delta, 0.0, (1.0 - delta * delta).sqrt());
            let mut ends = vec![];
            tall.crossings(o, d, Start::Elsewhere, &mut ends);
            let out = (1.0 - x) / delta;
            let enter = (3.0 / d.z).max((-1.0 - x) / delta);
            if out <= enter {
                assert!(ends.is_empty(), "the side is left before the end is met");
                continue;
            }
            let wrong = ((ends[1] - out) / out).abs();
            assert!(wrong <= 16.0 * EPS / delta, "δ {delta}: {wrong:e}");
            assert!(((ends[0] - enter) / enter).abs() <= 4.0 * EPS);
        }
    }
    // Along the axis only the ends answer.
    for (x, hit) in [(0.0, true), (0.999, true), (1.0 + 1e-9, false), (-2.0, false)] {
        for d in [DVec3::Z, DVec3::new(0.0, -0.0, -1.0)] {
            let mut ends = vec![];
            cut.crossings(DVec3::new(x, 0.0, 1.0), d, Start::Elsewhere, &mut ends);
            assert_eq!(ends, if hit { vec![-1.0, 1.0] } else { vec![] });
        }
    }
}

#[test]
fn quadrics_far_away_are_decided_by_a_margin_of_rounding() {
    // Rays parallel to y past a cylinder and a cone: x = 1 − margin hits.
    let cylinder = Frustum { radii: [1.0; 2], height: 2.0 };
    let cone = Frustum { radii: [2.0, 0.0], height: 2.0 };
    for exponent in 0..=8 {
        let far = 10f64.powi(exponent);
        let margin = 8.0 * EPS * far;
        for solid in [cylinder, cone] {
            let count = |x: f64| {
                let mut ends = vec![];
                solid.crossings(DVec3::new(x, -far, 1.0), DVec3::Y, Start::Elsewhere, &mut ends);
                for t in &ends {
                    let off = DVec2::new(x, -far + t).length() - 1.0;
                    assert!(off.abs() <= 4.0 * EPS * far.max(1.0), "{far}: {off:e}");
                }
                ends.len()
            };
            assert_eq!((count(1.0 - margin), count(1.0 + margin)), (2, 0), "{far}");
            assert_eq!(count(0.3), 2);
        }
    }
}

#[test]
fn quadrics_rims_and_the_apex_are_crossed_twice_or_not_at_all() {
    let mut random = Random(23);
    let solids = [
        Frustum { radii: [1.0; 2], height: 1.0 },
        Frustum { radii: [1.0, 0.5], height: 1.0 },
        Frustum { radii: [1.0, 0.0], height: 1.0 },
    ];
    let mut counts = [0; 2];
    for i in 0..60_000 {
        let solid = solids[i % 3];
        // Rim points with coordinates that f64 holds exactly.
        let (x, y) = [(0.6f64, 0.8f64), (1.0, 0.0), (0.28, 0.96), (0.0, -1.0)][random.below(4)];
        let target = match random.below(3) {
            0 => DVec3::new(x, y, 0.0),
            1 => DVec3::new(x * solid.radii[1], y * solid.radii[1], 1.0),
            _ => DVec3::Z,
        };
        let o = match random.below(3) {
            0 => target + random.direction() * 3.0,
            1 => target + (random.in_cube() * 4.0).round(),
            _ => target + [DVec3::X, DVec3::Y, DVec3::Z][random.below(3)] * 2.0,
        };
        let d = (target - o).normalize_or(DVec3::X);
        let mut ends = vec![];
        solid.crossings(o, d, Start::Elsewhere, &mut ends);
        assert!(ends.is_empty() || ends.len() == 2, "{ends:?}");
        counts[ends.len() / 2] += 1;
    }
    assert!(counts[0] > 1000 && counts[1] > 1000, "{counts:?}");
    // The apex has the axis for a normal.
    let (p, normal) = solids[2].surface(DVec3::new(0.0, -5.0, 1.0), DVec3::Y, 5.0);
    assert!(normal.is_finite() && (p - DVec3::Z).length() < 1e-12);
    assert_eq!(solids[2].surface(DVec3::new(0.0, 0.0, 9.0), DVec3::NEG_Z, 8.0).1, DVec3::Z);
}

#[test]
fn quadrics_ellipsoids_by_three_roads() {
    // As a quadric, as a stretched sphere, and as the quadric turned by exact quarter turns.
    let radii = DVec3::new(1.0, 0.5, 0.25);
    let (one, _) =
        quadric(([1.0, 4.0, 16.0], [0.0; 3], [0.0; 3], -1.0), [-radii, radii].map(|r| r * 2.0));
    let (turned, _) = quadric(
        ([16.0, 1.0, 4.0], [0.0; 3], [0.0; 3], -1.0),
        [DVec3::splat(-3.0), DVec3::splat(3.0)],
    );
    let mut random = Random(3);
    for _ in 0..20_000 {
        let o = random.direction() * 5.0;
        let d = (random.in_cube() * radii * 0.5 - o).normalize();
        let sphere = super::primitive::sphere_roots(
            o / radii,
            d / radii,
            (d / radii).length_squared(),
            1.0,
            Start::Elsewhere,
        );
        let swap = |v: DVec3| DVec3::new(v.z, v.x, v.y);
        for ends in [one(o, d, Start::Elsewhere), turned(swap(o), swap(d), Start::Elsewhere)] {
            // The condition of the stretching is 4.
            let wrong = (ends[0] - sphere.near).abs().max((ends[1] - sphere.far).abs());
            assert!(wrong <= 16.0 * EPS * 5.0 * 16.0, "{wrong:e}");
        }
    }
}

/// A ray that starts on a surface found by another one, and what it meets.
#[test]
fn acne_a_ray_starts_at_exactly_one_crossing() {
    for (name, crossings, inside) in all() {
        let mut random = Random(29);
        let mut started = 0;
        for _ in 0..8_000 {
            let (o, d) = ray(&mut random);
            let ends = crossings(o, d, Start::Elsewhere);
            let Some(index) = (!ends.is_empty()).then(|| random.below(ends.len())) else {
                continue;
            };
            let p = o + d * ends[index];
            // Which way is in, by the function itself.
            let out = random.direction();
            let step = 1e-6;
            let (before, after) = (inside(p - out * step), inside(p + out * step));
            let turns = before.signum() != after.signum() && before.abs().min(after.abs()) > 1e-8;
            if !turns {
                continue;
            }
            started += 1;
            let start = if after < 0.0 { Start::Inside } else { Start::Outside };
            let ends = crossings(p, out, start);
            let zeros: Vec<usize> = (0..ends.len()).filter(|i| ends[*i] == 0.0).collect();
            let odd = usize::from(start == Start::Outside);
            assert!(zeros.len() == 1 && zeros[0] % 2 == odd, "{name}: {start:?} {ends:?}");
            let what = fault(&ends, p, out, &inside, margin(o));
            assert_eq!(what, None, "{name}: from {p:?} along {out:?}");
            // No other crossing is the same one, a rounding further.
            let nearest = ends.iter().filter(|t| **t != 0.0).map(|t| t.abs()).fold(9.0, f64::min);
            assert!(nearest > 1e-7, "{name}: {ends:?}");
        }
        assert!(started > 50, "{name}: {started}");
    }
}

#[test]
fn fuzz_no_numbers_make_an_odd_count() {
    let mut random = Random(31);
    let odd = [0.0, -0.0, 1.0, 1e-30, 1e30, 1e-12, 1e12, 1e-300];
    let any = |random: &mut Random| {
        let x = odd[random.below(odd.len())];
        if random.below(2) == 0 {
            random.signed()
        } else {
            x * if random.below(2) == 0 { 1.0 } else { -1.0 }
        }
    };
    let positive = |x: f64| if x == 0.0 { 0.5 } else { x.abs() };
    for _ in 0..100_000 {
        let three = |random: &mut Random| [any(random), any(random), any(random)];
        let (o, d) = (DVec3::from(three(&mut random)), DVec3::from(three(&mut random)));
        if d == DVec3::ZERO {
            continue;
        }
        let [a, b, c] = three(&mut random).map(positive);
        let start = [Start::Elsewhere, Start::Inside, Start::Outside][random.below(3)];
        let (low, high) = (DVec3::from(three(&mut random)), DVec3::from([a, b, c]));
        let coefficients =
            (three(&mut random), three(&mut random), three(&mut random), three(&mut random)[0]);
        let loops =
            vec![(0..5).map(|_| DVec3::from(three(&mut random)).truncate()).collect::<Vec<_>>()];
        let solids: [(&str, Crossings); 4] = [
            ("frustum", frustum([a, b], c).0),
            ("torus", torus(a, b).0),
            ("quadric", quadric(coefficients, [low, low + high]).0),
            ("prism", prism(loops, [0.0, c]).0),
        ];
        for (name, crossings) in solids {
            let ends = crossings(o, d, start);
            let sorted = ends.windows(2).all(|pair| pair[0] <= pair[1]);
            assert!(
                ends.len().is_multiple_of(2) && sorted,
                "{name}: {ends:?} {o:?} {d:?} {start:?}"
            );
        }
    }
}
