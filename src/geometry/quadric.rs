//! Surfaces of the second degree, and what they enclose within a box.

use glam::{DMat3, DVec3};

use super::interaction::cuboid_surface;
use super::primitive::{Start, cuboid_faces};
use super::quadratic::{Below, below, below_from_surface};
use super::spans::Spans;

/// All points p of a box where p·A·p + 2 h·p + c ≤ 0, p from the middle of the box.
#[derive(Clone, Copy, Debug)]
pub(super) struct Quadric {
    /// Symmetric.
    a: DMat3,
    /// Its adjugate.
    adjugate: DMat3,
    h: DVec3,
    c: f64,
    /// The middle of the box.
    middle: DVec3,
    /// The box around it, by half its sides.
    half: DVec3,
}

/// The coefficients of x², y², z²; yz, zx, xy; x, y, z; 1.
pub(super) type Coefficients = ([f64; 3], [f64; 3], [f64; 3], f64);

impl Quadric {
    /// From its coefficients around the origin and the corners of its box.
    pub(super) fn new(coefficients: Coefficients, [min, max]: [DVec3; 2]) -> Quadric {
        let (squares, products, linear, constant) = coefficients;
        let [yz, zx, xy] = products.map(|x| 0.5 * x);
        let [xx, yy, zz] = squares;
        let a = DMat3::from_cols_array(&[xx, xy, zx, xy, yy, yz, zx, yz, zz]);
        let row = |r: DVec3, s: DVec3| r.cross(s);
        let adjugate = DMat3::from_cols(
            row(a.y_axis, a.z_axis),
            row(a.z_axis, a.x_axis),
            row(a.x_axis, a.y_axis),
        );
        let half = (max - min) * 0.5;
        let middle = min + half;
        let h = DVec3::from(linear) * 0.5;
        let at_middle = a * middle;
        let c = constant + middle.dot(at_middle + h * 2.0);
        Quadric { a, adjugate, h: h + at_middle, c, middle, half }
    }

    /// The corners of its box.
    pub(super) fn bounds(&self) -> [DVec3; 2] {
        [self.middle - self.half, self.middle + self.half]
    }

    /// Where the whole line of a ray enters and leaves; the direction has any length.
    pub(super) fn spans(&self, o: DVec3, d: DVec3, start: Start) -> Spans {
        let o = o - self.middle;
        let mut spans = match start {
            Start::Elsewhere => {
                let (first, last) = self.faces(o, d);
                if first >= last {
                    return Spans::NONE;
                }
                let shift = -o.dot(d) / d.length_squared();
                let p = o + d * shift;
                let bend = d.dot(self.a * d);
                let slope = d.dot(self.gradient(p));
                let below = below(bend, slope, self.value(p), self.discriminant(p, d, bend));
                within((first, last), shift, below)
            }
            Start::Inside | Start::Outside => self.leaving_surface(o, d, start == Start::Inside),
        };
        spans.start_on_surface(start);
        spans
    }

    /// Appends where the whole line enters and leaves; one that a ray starts on is 0.
    pub(super) fn crossings(&self, o: DVec3, d: DVec3, start: Start, out: &mut Vec<f64>) {
        out.extend_from_slice(self.spans(o, d, start).ends());
    }

    /// The crossings of a ray from its surface: the root 0 is known, or it is a face of the box.
    fn leaving_surface(&self, o: DVec3, d: DVec3, inward: bool) -> Spans {
        let off_box = (o.abs() - self.half).abs();
        let gradient = self.gradient(o);
        let steep = 2.0 * gradient.length();
        let on_quadric = self.value(o).abs() < off_box.min_element() * steep;
        let (first, last) = match self.faces(o, d) {
            faces if faces.0 < faces.1 => faces,
            // Rounding put it outside.
            _ => self.faces(o.clamp(-self.half, self.half), d),
        };
        let bend = d.dot(self.a * d);
        if on_quadric {
            let below = below_from_surface(bend, d.dot(gradient), inward);
            return within((first, last), 0.0, below);
        }
        let slope = d.dot(gradient);
        let below = below(bend, slope, self.value(o), self.discriminant(o, d, bend));
        within(if inward { (0.0, last) } else { (first, 0.0) }, 0.0, below)
    }

    /// b² − ac of the function along a line through `p`, from the line's moment about the middle.
    fn discriminant(&self, p: DVec3, d: DVec3, bend: f64) -> f64 {
        let moment = p.cross(d);
        let along = self.h.dot(d);
        let skew = 2.0 * (self.a * d).cross(self.h).dot(moment);
        (along * along - self.c * bend) + (skew - moment.dot(self.adjugate * moment))
    }

    /// Entry and exit of the box.
    fn faces(&self, o: DVec3, d: DVec3) -> (f64, f64) {
        let (first, last) = cuboid_faces(o, d, &[-self.half, self.half]);
        (first.0, last.0)
    }

    fn value(&self, p: DVec3) -> f64 {
        p.dot(self.a * p + self.h * 2.0) + self.c
    }

    /// Half the gradient.
    fn gradient(&self, p: DVec3) -> DVec3 {
        self.a * p + self.h
    }

    /// Point and unit normal where a ray meets it at `t`.
    pub(super) fn surface(&self, o: DVec3, d: DVec3, t: f64) -> (DVec3, DVec3) {
        let from = o - self.middle;
        let (first, last) = self.faces(from, d);
        if t == first || t == last {
            let (p, normal) = cuboid_surface(from, d, &[-self.half, self.half], t);
            return (self.middle + p, normal);
        }
        let p = from + d * t;
        let gradient = self.gradient(p);
        let squared = gradient.length_squared();
        // At an apex there is no normal: it faces the ray.
        let Some(normal) = gradient.try_normalize() else { return (o + d * t, -d.normalize()) };
        (self.middle + (p - gradient * (0.5 * self.value(p) / squared)), normal)
    }
}

/// What of a line is in the box and below zero; parameters of the latter are counted from `shift`.
fn within((first, last): (f64, f64), shift: f64, below: Below) -> Spans {
    let mut spans = Spans::NONE;
    let mut both = |low: f64, high: f64| spans.push(first.max(shift + low), last.min(shift + high));
    match below {
        Below::Nowhere => {}
        Below::Everywhere => both(f64::NEG_INFINITY, f64::INFINITY),
        Below::Between(low, high) => both(low, high),
        Below::Outside(low, high) => {
            both(f64::NEG_INFINITY, low);
            both(high, f64::INFINITY);
        }
    }
    spans
}
