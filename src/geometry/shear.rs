//! Triangles and polygons seen along the ray: exact orientation signs, so that shared edges and
//! vertices belong to exactly one face.
//!
//! The corners are sheared into the space where the ray is the z axis and starts at 0 (Woop, Benthin
//! and Wald, "Watertight Ray/Triangle Intersection", JCGT 2(1), 2013). A corner is rounded once per
//! ray, whichever faces share it; from there on every decision is the *exact* sign of a 2 × 2
//! determinant, and a zero is decided as if the ray passed at (ε, ε²), the same for all faces. What
//! the ray hits is therefore what it would hit in a slightly bent but whole surface: closed meshes
//! are crossed an even number of times.

use glam::DVec3;

use super::Ray;

/// A corner as it is stored: x, y, z and a zero that makes every index `& 3` valid.
pub(super) type Corner = [f64; 4];

/// Stores a point as a corner.
pub(super) fn corner(p: DVec3) -> Corner {
    [p.x, p.y, p.z, 0.0]
}

/// The point of a corner.
#[inline(always)]
pub(super) fn point(&[x, y, z, _]: &Corner) -> DVec3 {
    DVec3::new(x, y, z)
}

/// A ray prepared for corners. `axis[2]` is the largest component of the direction.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shear {
    axis: [usize; 3],
    origin: [f64; 3],
    slope: [f64; 2],
    /// One over the largest component of the direction.
    per_depth: f64,
}

/// A corner in ray space; z is not yet divided by the direction.
#[derive(Clone, Copy, Debug)]
struct Seen {
    x: f64,
    y: f64,
    z: f64,
}

/// Where a ray crosses a triangle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Crossing {
    /// Along the ray.
    pub(super) t: f64,
    /// Shares of the three corners, each ≥ 0, their sum 1 up to rounding.
    pub(super) weights: [f64; 3],
}

impl Shear {
    /// The direction may have any length but zero.
    #[inline(always)]
    pub(super) fn new(ray: &Ray) -> Shear {
        let d = ray.direction.to_array();
        let size = ray.direction.abs();
        let z = if size.x >= size.y && size.x >= size.z {
            0
        } else if size.y >= size.z {
            1
        } else {
            2
        };
        let (x, y) = ([1, 2, 0][z], [2, 0, 1][z]);
        let o = ray.origin.to_array();
        let per_depth = 1.0 / d[z];
        Shear {
            axis: [x, y, z],
            origin: [o[x], o[y], o[z]],
            slope: [d[x] * per_depth, d[y] * per_depth],
            per_depth,
        }
    }

    #[inline(always)]
    fn see(&self, p: &Corner) -> Seen {
        let z = p[self.axis[2] & 3] - self.origin[2];
        Seen {
            x: (p[self.axis[0] & 3] - self.origin[0]) - self.slope[0] * z,
            y: (p[self.axis[1] & 3] - self.origin[1]) - self.slope[1] * z,
            z,
        }
    }

    /// Where the ray's line crosses the triangle, at any `t`.
    #[inline(always)]
    pub(super) fn triangle(&self, [a, b, c]: [&Corner; 3]) -> Option<Crossing> {
        let (a, b, c) = (self.see(a), self.see(b), self.see(c));
        let (u, v, w) = (side(b, c), side(c, a), side(a, b));
        if (u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0) {
            return None;
        }
        if u == 0.0 || v == 0.0 || w == 0.0 {
            return triangle_on_edge([a, b, c], self.per_depth);
        }
        crossing([a, b, c], [u, v, w], self.per_depth)
    }

    /// Whether the ray's line passes through the polygon, by the even-odd rule.
    #[inline(always)]
    pub(super) fn polygon(&self, corners: &[Corner]) -> bool {
        let Some(last) = corners.last() else { return false };
        let mut inside = false;
        let mut p = self.see(last);
        for q in corners {
            let q = self.see(q);
            // The ray is at y = ε²: a corner at 0 lies below it.
            if (p.y > 0.0) != (q.y > 0.0) {
                inside ^= left_of(p, q) == (q.y > 0.0);
            }
            p = q;
        }
        inside
    }
}

/// The ray passes, as far as rounded products tell, through an edge.
#[cold]
#[inline(never)]
fn triangle_on_edge([a, b, c]: [Seen; 3], per_depth: f64) -> Option<Crossing> {
    let sides = [exact_side(b, c), exact_side(c, a), exact_side(a, b)];
    let left = [left_of(b, c), left_of(c, a), left_of(a, b)];
    let inside = left == [true; 3] || left == [false; 3];
    if inside { crossing([a, b, c], sides, per_depth) } else { None }
}

#[inline(always)]
fn crossing([a, b, c]: [Seen; 3], [u, v, w]: [f64; 3], per_depth: f64) -> Option<Crossing> {
    let scale = 1.0 / (u + v + w);
    let weights = [u * scale, v * scale, w * scale];
    let t = (weights[0] * a.z + weights[1] * b.z + weights[2] * c.z) * per_depth;
    t.is_finite().then_some(Crossing { t, weights })
}

/// Twice the area of the triangle (0, p, q). The sign is exact unless the value is 0: rounding keeps
/// the order of the two products. Swapping p and q negates it exactly.
#[inline(always)]
fn side(p: Seen, q: Seen) -> f64 {
    p.x * q.y - p.y * q.x
}

/// [`side`] with what rounding took from the two products where they are equal.
fn exact_side(p: Seen, q: Seen) -> f64 {
    let value = side(p, q);
    if value == 0.0 { product_error(p.x, q.y) - product_error(p.y, q.x) } else { value }
}

/// Whether (ε, ε²) lies on the left of the line from p to q; of the two directions of an edge,
/// exactly one says yes unless p equals q.
#[inline(always)]
fn left_of(p: Seen, q: Seen) -> bool {
    let value = side(p, q);
    if value != 0.0 { value > 0.0 } else { left_of_by_error(p, q) }
}

#[cold]
#[inline(never)]
fn left_of_by_error(p: Seen, q: Seen) -> bool {
    let value = exact_side(p, q);
    if value != 0.0 {
        value > 0.0
    } else if p.y != q.y {
        p.y > q.y
    } else {
        q.x > p.x
    }
}

/// a·b minus its rounded value, exact unless it underflows (Dekker, 1971).
pub(super) fn product_error(a: f64, b: f64) -> f64 {
    let product = a * b;
    let ((a1, a2), (b1, b2)) = (halves(a), halves(b));
    ((a1 * b1 - product) + a1 * b2 + a2 * b1) + a2 * b2
}

/// The upper 26 bits of a number and the rest.
fn halves(a: f64) -> (f64, f64) {
    let high = f64::from_bits(a.to_bits() & !((1 << 27) - 1));
    (high, a - high)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn seen(x: f64, y: f64) -> Seen {
        Seen { x, y, z: 1.0 }
    }

    #[test]
    fn products_are_taken_apart_exactly() {
        let (a, b) = (1.0 + f64::EPSILON, 1.0 - f64::EPSILON / 2.0);
        // (1 + e)(1 − e/2) = 1 + e/2 − e²/2; rounded to 1.
        assert_eq!(a * b, 1.0);
        let e = f64::EPSILON;
        assert_eq!(product_error(a, b), e / 2.0 - e * e / 2.0);
        assert_eq!(product_error(3.0, 7.0), 0.0);
    }

    #[test]
    fn mesh_an_edge_has_exactly_one_left_side() {
        let e = f64::EPSILON;
        let points = [
            seen(1.0 + e, 1.0),
            seen(1.0, 1.0 - e / 2.0),
            seen(-1.0, -1.0),
            seen(2.0, 2.0),
            seen(0.0, 0.0),
            seen(0.0, 3.0),
            seen(-4.0, 0.0),
        ];
        for (i, p) in points.iter().enumerate() {
            for q in &points[..i] {
                assert_ne!(left_of(*p, *q), left_of(*q, *p), "{p:?} {q:?}");
            }
        }
    }

    #[test]
    fn mesh_a_fan_around_a_vertex_has_one_owner() {
        let ray = Ray { origin: DVec3::new(0.1, 0.2, 5.0), direction: DVec3::NEG_Z };
        let shear = Shear::new(&ray);
        let hub = corner(DVec3::new(0.1, 0.2, 0.0));
        for n in 3..20 {
            let rim: Vec<Corner> = (0..n)
                .map(|i| {
                    let angle = std::f64::consts::TAU * f64::from(i) / f64::from(n);
                    corner(DVec3::new(0.1 + angle.cos(), 0.2 + angle.sin(), 0.0))
                })
                .collect();
            let next = |i: usize| &rim[(i + 1) % rim.len()];
            let triangles =
                (0..rim.len()).filter(|i| shear.triangle([&hub, &rim[*i], next(*i)]).is_some());
            assert_eq!(triangles.count(), 1);
            let polygons =
                (0..rim.len()).filter(|i| shear.polygon(&[*next(*i), hub, rim[*i]])).count();
            assert_eq!(polygons, 1);
        }
    }

    #[test]
    fn polygon_a_concave_one_is_even_odd() {
        let u = [
            (0.0, 0.0),
            (3.0, 0.0),
            (3.0, 3.0),
            (2.0, 3.0),
            (2.0, 1.0),
            (1.0, 1.0),
            (1.0, 3.0),
            (0.0, 3.0),
        ];
        let corners = u.map(|(x, y)| corner(DVec3::new(x, y, 0.0)));
        let inside = |x, y| {
            let ray = Ray { origin: DVec3::new(x, y, 1.0), direction: DVec3::NEG_Z };
            Shear::new(&ray).polygon(&corners)
        };
        assert!(inside(0.5, 2.0) && inside(2.5, 2.0) && inside(1.5, 0.5));
        assert!(!inside(1.5, 2.0) && !inside(-0.5, 2.0) && !inside(1.5, -0.1));
    }
}
