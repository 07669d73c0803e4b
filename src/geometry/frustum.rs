//! Cylinders and cones with flat ends, in a frame whose z axis is their own.

use glam::{DVec2, DVec3};

use super::primitive::{Roots, Start};
use super::quadratic::{Below, below, below_from_surface};
use super::spans::slab;

/// A right circular cone from z = 0 to `height`, cut off where its radius is not 0; a cylinder if both
/// radii are equal. Convex.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frustum {
    /// At z = 0 and at z = height; ≥ 0, not both 0.
    pub(super) radii: [f64; 2],
    /// > 0.
    pub(super) height: f64,
}

/// A ray and the line that it lies on, at one of the ray's points.
struct Along {
    /// A point of the line close to the solid.
    p: DVec3,
    /// Its parameter.
    t: f64,
}

impl Frustum {
    /// Entry and exit of a ray; the direction has any length. From the surface outwards there is none,
    /// inwards only the exit.
    #[inline(always)]
    pub(super) fn roots(&self, o: DVec3, d: DVec3, start: Start) -> Roots {
        match start {
            Start::Outside => Roots::NONE,
            Start::Inside => {
                Roots { near: f64::NAN, far: self.interval_from_surface(o, d, true).1 }
            }
            Start::Elsewhere => match self.interval(o, d) {
                Some((near, far)) => Roots { near, far },
                None => Roots::NONE,
            },
        }
    }

    /// Appends where the whole line enters and leaves; one that a ray starts on is 0.
    pub(super) fn crossings(&self, o: DVec3, d: DVec3, start: Start, out: &mut Vec<f64>) {
        let interval = match start {
            Start::Elsewhere => self.interval(o, d),
            Start::Inside => Some(self.interval_from_surface(o, d, true)),
            Start::Outside => Some(self.interval_from_surface(o, d, false)),
        };
        out.extend(interval.into_iter().flat_map(|(near, far)| [near, far]));
    }

    /// Where the line is inside, if it is anywhere. A line that only touches is not.
    ///
    /// Position error ≈ ε·distance; ε/δ at an angle δ to the axis (STABILITY Q1, Q3).
    fn interval(&self, o: DVec3, d: DVec3) -> Option<(f64, f64)> {
        let (first, last) = slab([0.0, self.height], o.z, d.z)?;
        let at = nearest(o, d, first, last);
        let (low, high) = self.side(&at, d)?;
        let (near, far) = (first.max(at.t + low), last.min(at.t + high));
        (near < far).then_some((near, far))
    }

    /// Where the line is inside the unbounded cylinder, or the cone's nappe that the solid is of, from
    /// the point of the line on.
    ///
    /// The cone ρ² − R² ≤ 0 is a quadratic form of signature (+, +, −) in (x, y, R): its discriminant is
    /// |p·R′ − R·d|² − (p × d)², cross products that factor, in place of b² − ac.
    #[inline(always)]
    fn side(&self, at: &Along, d: DVec3) -> Option<(f64, f64)> {
        let (p, flat) = (at.p.truncate(), d.truncate());
        let (radius, slope) = (self.radius(at.p.z), self.slope() * d.z);
        let a = flat.length_squared() - slope * slope;
        let b = p.dot(flat) - radius * slope;
        let distance = p.length();
        let c = (distance - radius) * (distance + radius);
        let (u, w) = ((p * slope - flat * radius).length(), p.perp_dot(flat).abs());
        match below(a, b, c, (u - w) * (u + w)) {
            Below::Nowhere => None,
            Below::Everywhere => Some((f64::NEG_INFINITY, f64::INFINITY)),
            Below::Between(low, high) => Some((low, high)),
            Below::Outside(_, high) if slope > 0.0 => Some((high, f64::INFINITY)),
            Below::Outside(low, _) => Some((f64::NEG_INFINITY, low)),
        }
    }

    /// Where a line that goes in, or out, at 0 is inside: the interval begins, or ends, with 0.
    fn interval_from_surface(&self, o: DVec3, d: DVec3, inward: bool) -> (f64, f64) {
        // As where surfaces are told apart, but of a ray along an end that rounding put outside.
        let (first, last) =
            slab([0.0, self.height], o.z, d.z).unwrap_or((f64::NEG_INFINITY, f64::INFINITY));
        let o = DVec3::new(o.x, o.y, o.z.clamp(0.0, self.height));
        let from_axis = o.truncate().length();
        let off_side = (from_axis - self.radius(o.z)).abs();
        let (low, high) = if off_side < o.z.min(self.height - o.z) {
            let (flat, slope) = (d.truncate(), self.slope() * d.z);
            let a = flat.length_squared() - slope * slope;
            let b = o.truncate().dot(flat) - from_axis * slope;
            match below_from_surface(a, b, inward) {
                Below::Between(low, high) => (low, high),
                _ => (f64::NEG_INFINITY, f64::INFINITY),
            }
        } else {
            let at = nearest(o, d, first, last);
            let side = self.side(&at, d);
            side.map_or((0.0, 0.0), |(low, high)| (at.t + low, at.t + high))
        };
        if inward { (0.0, last.min(high).max(0.0)) } else { (first.max(low).min(0.0), 0.0) }
    }

    /// Point and unit normal where a ray meets it at `t`.
    pub(super) fn surface(&self, o: DVec3, d: DVec3, t: f64) -> (DVec3, DVec3) {
        let p = o + d * t;
        let flat = p.truncate();
        let distance = flat.length();
        if let Some((first, last)) = slab([0.0, self.height], o.z, d.z)
            && (t == first || t == last)
        {
            let top = (d.z > 0.0) == (t == last);
            let (z, radius) = if top { (self.height, self.radii[1]) } else { (0.0, self.radii[0]) };
            let within = if distance > radius { flat * (radius / distance) } else { flat };
            return (within.extend(z), if top { DVec3::Z } else { DVec3::NEG_Z });
        }
        let z = p.z.clamp(0.0, self.height);
        let slope = self.slope();
        if distance == 0.0 {
            // The apex has no normal but the axis.
            return (DVec3::new(0.0, 0.0, z), DVec3::Z * (-slope).signum());
        }
        let out = flat / distance;
        ((out * self.radius(z)).extend(z), out.extend(-slope).normalize())
    }

    /// Radius at a height, exactly that of a cylinder, exactly 0 at an apex.
    #[inline(always)]
    fn radius(&self, z: f64) -> f64 {
        self.radii[0] + (self.radii[1] - self.radii[0]) * (z / self.height)
    }

    /// By how much the radius grows with the height.
    #[inline(always)]
    fn slope(&self) -> f64 {
        (self.radii[1] - self.radii[0]) / self.height
    }

    /// Centres and radii of the discs that it is the hull of.
    pub(super) fn ends(&self) -> [(DVec3, f64); 2] {
        let [bottom, top] = self.radii;
        [(DVec3::ZERO, bottom), (DVec3::Z * self.height, top)]
    }

    /// u around from +x towards +y and v upwards; an end shows the image in the square around it.
    /// With their gradients.
    pub(super) fn uv(&self, p: DVec3, normal: DVec3) -> ([f64; 2], [DVec3; 2]) {
        let steepest = self.slope().abs().max(1.0);
        if normal.truncate().length() * (2.0 * steepest) < normal.z.abs() {
            let top = normal.z > 0.0;
            let size = 2.0 * if top { self.radii[1] } else { self.radii[0] };
            let right = if top { DVec3::X } else { DVec3::NEG_X };
            let axes = [right / size, DVec3::Y / size];
            return (axes.map(|axis| 0.5 + p.dot(axis)), axes);
        }
        let (u, around) = super::uv::longitude(p.truncate());
        ([u, p.z / self.height], [around, DVec3::Z / self.height])
    }
}

/// The point of a line that is nearest to the axis between two of its parameters.
#[inline(always)]
fn nearest(o: DVec3, d: DVec3, first: f64, last: f64) -> Along {
    let flat: DVec2 = d.truncate();
    let squared = flat.length_squared();
    let t = if squared > 0.0 { -o.truncate().dot(flat) / squared } else { first };
    let t = t.max(first).min(last);
    Along { p: o + d * t, t }
}
