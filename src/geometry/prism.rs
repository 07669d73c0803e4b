//! Prisms: any number of loops in the plane, swept between two heights along z.

use glam::{DVec2, DVec3};

use super::primitive::{Start, cuboid_faces};
use super::runs::{Run, runs};
use super::spans::{slab, start_on_surface};

/// All points between two heights over a region of the plane: where an odd number of loops is around.
///
/// A line's crossings with the loops are counted by which side of it each corner is on, decided once
/// per corner: their number is even whatever rounding does.
#[derive(Clone, Debug)]
pub(super) struct Prism {
    /// Lower and upper height.
    heights: [f64; 2],
    /// The corners of all loops.
    corners: Box<[DVec2]>,
    /// Runs of the loops' edges: a line asks those that it may cross.
    runs: Box<[Run]>,
    /// Where each loop's corners end.
    ends: Box<[usize]>,
    /// Per loop whether the solid is to the right of its edges.
    turned: Box<[bool]>,
    /// Per corner how far along its loop it is, 0 … 1.
    shares: Box<[f64]>,
    /// Lowest and highest corner around all loops.
    bounds: [DVec2; 2],
}

/// An edge that a line crosses.
struct Crossed {
    t: f64,
    /// Index of the edge's first corner, and of its second one.
    from: usize,
    to: usize,
    /// How far along the edge, 0 … 1.
    share: f64,
}

impl Prism {
    /// From loops of three corners or more, none crossing itself or another.
    pub(super) fn new(loops: &[Vec<DVec2>], heights: [f64; 2]) -> Prism {
        let all = || loops.iter().flatten().copied();
        let bounds = all()
            .fold([DVec2::INFINITY, DVec2::NEG_INFINITY], |[lo, hi], p| [lo.min(p), hi.max(p)]);
        let end = |end: &mut usize, l: &Vec<DVec2>| {
            *end += l.len();
            Some(*end)
        };
        let corners: Box<[DVec2]> = all().collect();
        let ends: Box<[usize]> = loops.iter().scan(0, end).collect();
        Prism {
            heights,
            runs: runs(&corners, &ends),
            corners,
            ends,
            turned: (0..loops.len()).map(|index| is_turned(loops, index)).collect(),
            shares: loops.iter().flat_map(|l| shares(l)).collect(),
            bounds,
        }
    }

    /// Lowest and highest corner of the box around it.
    pub(super) fn bounds(&self) -> [DVec3; 2] {
        let [lo, hi] = self.bounds;
        [lo.extend(self.heights[0]), hi.extend(self.heights[1])]
    }

    /// Memory beyond its own size, in bytes.
    pub(super) fn bytes(&self) -> usize {
        let Prism { heights: _, corners, runs, ends, turned, shares, bounds: _ } = self;
        size_of_val(&**corners)
            + size_of_val(&**runs)
            + size_of_val(&**ends)
            + size_of_val(&**turned)
            + size_of_val(&**shares)
    }

    /// Appends where the whole line enters and leaves; one that a ray starts on is 0.
    pub(super) fn crossings(&self, o: DVec3, d: DVec3, start: Start, out: &mut Vec<f64>) {
        let begin = out.len();
        self.each(o, d, |t| out.push(t));
        out[begin..].sort_unstable_by(f64::total_cmp);
        start_on_surface(out, begin, start);
    }

    /// Calls `offer` with the first crossing beyond 0, or with all of them. One that a ray from the
    /// surface meets again by rounding is told by parity: with it, the ray would be on the wrong side.
    #[inline(always)]
    pub(super) fn ahead(
        &self,
        o: DVec3,
        d: DVec3,
        start: Start,
        all: bool,
        mut offer: impl FnMut(f64),
    ) {
        if start == Start::Elsewhere && self.is_far_from(o, d) {
            return;
        }
        let (mut first, mut second, mut count) = (f64::INFINITY, f64::INFINITY, 0usize);
        self.each(o, d, |t| {
            if t > 0.0 {
                count += 1;
                if t < first {
                    (first, second) = (t, first);
                } else if t < second {
                    second = t;
                }
            }
        });
        let mut skip = match start {
            Start::Elsewhere => false,
            Start::Inside => count > 0 && count.is_multiple_of(2),
            Start::Outside => !count.is_multiple_of(2),
        };
        if !all {
            let t = if skip { second } else { first };
            if t < f64::INFINITY {
                offer(t);
            }
        } else if count > 0 {
            self.each(o, d, |t| {
                if t > 0.0 && !(t == first && std::mem::take(&mut skip)) {
                    offer(t);
                }
            });
        }
    }

    /// Whether a ray misses the box around it: most rays that come here do.
    #[inline(always)]
    fn is_far_from(&self, o: DVec3, d: DVec3) -> bool {
        let (first, last) = cuboid_faces(o, d, &self.bounds());
        !(first.0 <= last.0 && last.0 > 0.0)
    }

    /// Calls `found` with every crossing of the line, in no order.
    #[inline(always)]
    fn each(&self, o: DVec3, d: DVec3, mut found: impl FnMut(f64)) {
        let Some((first, last)) = slab(self.heights, o.z, d.z) else { return };
        let (mut at_first, mut at_last) = (false, false);
        if d.x == 0.0 && d.y == 0.0 {
            at_first = self.contains(o.truncate());
            at_last = at_first;
        } else {
            self.each_edge(o, d, |Crossed { t, .. }| {
                at_first ^= t <= first;
                at_last ^= t <= last;
                if first < t && t <= last {
                    found(t);
                }
            });
        }
        if at_first {
            found(first);
        }
        if at_last {
            found(last);
        }
    }

    /// Calls `found` with every edge that the line crosses, seen along z; it is not parallel to z.
    #[inline(always)]
    fn each_edge(&self, o: DVec3, d: DVec3, mut found: impl FnMut(Crossed)) {
        let along = d.truncate();
        let squared = along.length_squared();
        // From the point nearest to the middle: the corners' distances from the line do not cancel.
        let middle = (self.bounds[0] + self.bounds[1]) * 0.5;
        let shift = (middle - o.truncate()).dot(along) / squared;
        let p = o.truncate() + along * shift;
        let side = |corner: DVec2| along.perp_dot(corner - p);
        let mut index = 0;
        while let Some(run) = self.runs.get(index) {
            if run.is_beside(along, p) {
                index = run.next as usize;
                continue;
            }
            index += 1;
            let mut from = run.from as usize;
            let mut from_side = side(self.corners[from]);
            for to in run.edges() {
                let to_side = side(self.corners[to]);
                if (from_side > 0.0) != (to_side > 0.0) {
                    let share = from_side / (from_side - to_side);
                    let at = self.corners[from].lerp(self.corners[to], share);
                    let t = shift + (at - p).dot(along) / squared;
                    found(Crossed { t, from, to, share });
                }
                (from, from_side) = (to, to_side);
            }
        }
    }

    /// Whether an odd number of loops is around a point of the plane.
    fn contains(&self, p: DVec2) -> bool {
        let mut begin = 0;
        let mut inside = false;
        for &end in &self.ends {
            inside ^= is_around(&self.corners[begin..end], p);
            begin = end;
        }
        inside
    }

    /// Point and unit normal where a ray meets it at `t`, and how far around its loop.
    fn met(&self, o: DVec3, d: DVec3, t: f64) -> (DVec3, DVec3) {
        let [low, high] = self.heights;
        if let Some((first, last)) = slab(self.heights, o.z, d.z)
            && (t == first || t == last)
        {
            let top = (d.z > 0.0) == (t == last);
            let p = (o + d * t).truncate().clamp(self.bounds[0], self.bounds[1]);
            return if top { (p.extend(high), DVec3::Z) } else { (p.extend(low), DVec3::NEG_Z) };
        }
        let z = (o.z + d.z * t).clamp(low, high);
        let mut met: Option<Crossed> = None;
        self.each_edge(o, d, |crossed| {
            let off = |c: &Crossed| (c.t - t).abs();
            if met.as_ref().is_none_or(|best| off(&crossed) < off(best)) {
                met = Some(crossed);
            }
        });
        let Some(Crossed { t: _, from, to, share }) = met else {
            return ((o + d * t).truncate().extend(z), -d.normalize());
        };
        let (a, b) = (self.corners[from], self.corners[to]);
        let turned = self.turned[self.ends.partition_point(|end| *end <= to)];
        let out = if turned { (b - a).perp() } else { -(b - a).perp() };
        (a.lerp(b, share).extend(z), super::compile::exact_normalize(out.extend(0.0)))
    }

    /// Point and unit normal where a ray meets it at `t`.
    pub(super) fn surface(&self, o: DVec3, d: DVec3, t: f64) -> (DVec3, DVec3) {
        self.met(o, d, t)
    }

    /// On the sides u along the loop and v upwards; an end shows the image in the rectangle around it.
    /// With their gradients.
    pub(super) fn uv(&self, p: DVec3, normal: DVec3) -> ([f64; 2], [DVec3; 2]) {
        let ([low, high], size) = (self.heights, self.bounds[1] - self.bounds[0]);
        if normal.z.abs() > normal.x.abs().max(normal.y.abs()) {
            let top = normal.z > 0.0;
            let u = if top { DVec3::X / size.x } else { DVec3::NEG_X / size.x };
            let v = DVec3::Y / size.y;
            let x = if top { self.bounds[0].x } else { self.bounds[1].x };
            let from = p - DVec3::new(x, self.bounds[0].y, 0.0);
            return ([from.dot(u), from.dot(v)], [u, v]);
        }
        let (u, along) = self.around(p.truncate());
        ([u, (p.z - low) / (high - low)], [along.extend(0.0), DVec3::Z / (high - low)])
    }

    /// How far around its loop the nearest point of an edge is, and the gradient of that.
    fn around(&self, p: DVec2) -> (f64, DVec2) {
        let mut nearest = (f64::INFINITY, 0.0, DVec2::ZERO);
        let mut begin = 0;
        for &end in &self.ends {
            for from in begin..end {
                let to = if from + 1 == end { begin } else { from + 1 };
                let edge = self.corners[to] - self.corners[from];
                let squared = edge.length_squared();
                if squared == 0.0 {
                    continue;
                }
                let out = p - self.corners[from];
                let share = (out.dot(edge) / squared).clamp(0.0, 1.0);
                let off = (out - edge * share).length_squared();
                if off < nearest.0 {
                    let last = if to == begin { 1.0 } else { self.shares[to] };
                    let width = last - self.shares[from];
                    nearest = (off, self.shares[from] + width * share, edge * (width / squared));
                }
            }
            begin = end;
        }
        (nearest.1, nearest.2)
    }
}

/// Per corner how far along the loop it is, of the loop's length.
fn shares(corners: &[DVec2]) -> Vec<f64> {
    let next = corners.iter().cycle().skip(1);
    let lengths: Vec<f64> = corners.iter().zip(next).map(|(a, b)| a.distance(*b)).collect();
    let whole: f64 = lengths.iter().sum();
    let mut sum = 0.0;
    lengths.iter().map(|length| (sum / whole, sum += length).0).collect()
}

/// Whether a loop is around a point, by the crossings of the half-line from it along x.
fn is_around(corners: &[DVec2], p: DVec2) -> bool {
    let Some(mut from) = corners.last() else { return false };
    let mut inside = false;
    for to in corners {
        if (from.y > p.y) != (to.y > p.y) {
            let share = (p.y - from.y) / (to.y - from.y);
            inside ^= p.x < from.x + (to.x - from.x) * share;
        }
        from = to;
    }
    inside
}

/// Whether the solid is to the right of a loop's edges: it turns clockwise, or an odd number of other
/// loops is around it.
fn is_turned(loops: &[Vec<DVec2>], index: usize) -> bool {
    let corners = &loops[index];
    let first = corners[0];
    let next = corners.iter().cycle().skip(1);
    let area: f64 = corners.iter().zip(next).map(|(a, b)| (*a - first).perp_dot(*b - first)).sum();
    let middle = (corners[0] + corners[1]) * 0.5;
    let others = loops.iter().enumerate().filter(|(other, _)| *other != index);
    let around = others.filter(|(_, other)| is_around(other, middle)).count();
    (area < 0.0) != (around % 2 == 1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::testing::Random;

    /// A star of many corners around a hole of many.
    fn star(corners: usize) -> Prism {
        let mut random = Random(corners as u64);
        let mut ring = |low: f64, count: usize| -> Vec<DVec2> {
            let angle = |k: usize| std::f64::consts::TAU * k as f64 / count as f64;
            (0..count)
                .map(|k| DVec2::from_angle(angle(k)) * (low + 0.2 + 0.2 * random.signed()))
                .map(|corner| (corner * 64.0).round() / 64.0)
                .collect()
        };
        Prism::new(&[ring(0.6, corners), ring(0.1, corners / 2)], [-0.3, 0.4])
    }

    /// The same prism, all edges of which are asked.
    fn plain(prism: &Prism) -> Prism {
        Prism { runs: Run::all(&prism.ends), ..prism.clone() }
    }

    fn bits(prism: &Prism, o: DVec3, d: DVec3) -> (Vec<u64>, Vec<[u64; 6]>) {
        let mut all = Vec::new();
        prism.crossings(o, d, Start::Elsewhere, &mut all);
        let met = |t: &f64| {
            let (p, n) = prism.surface(o, d, *t);
            [p.x, p.y, p.z, n.x, n.y, n.z].map(f64::to_bits)
        };
        (all.iter().map(|t| t.to_bits()).collect(), all.iter().map(met).collect())
    }

    #[test]
    fn runs_of_edges_change_no_bit() {
        let mut random = Random(3);
        let (mut hits, mut odd) = (0, 0);
        for corners in [3, 7, 8, 9, 40, 144, 1000] {
            let prism = star(corners.max(6));
            let plain = plain(&prism);
            for case in 0..3000 {
                let corner = |r: &mut Random| {
                    let index = (r.signed().abs() * prism.corners.len() as f64) as usize;
                    prism.corners[index.min(prism.corners.len() - 1)]
                };
                // Through two corners, along an axis through a corner, or anywhere; from far too.
                let a = corner(&mut random);
                let (through, along) = match case % 4 {
                    0 => (a, corner(&mut random) - a),
                    1 => (a, if case % 8 == 1 { DVec2::X } else { DVec2::NEG_Y }),
                    _ => (random.direction().truncate(), random.direction().truncate()),
                };
                let d = along.extend(random.signed() * 0.3 * f64::from(u8::from(case % 3 > 0)));
                let back = 4f64.powi(case % 13);
                let o = through.extend(random.signed() * 0.4) - d * back;
                let found = bits(&prism, o, d);
                assert_eq!(found, bits(&plain, o, d), "{corners} corners, from {o} along {d}");
                hits += found.0.len();
                odd += found.0.len() % 2;
            }
        }
        assert!(hits > 20_000 && odd == 0, "{hits} crossings, {odd} odd lists");
    }

    #[test]
    fn a_run_that_is_left_out_is_noticed() {
        let prism = star(144);
        let mut broken = prism.clone();
        // Every edge of the first half is far away.
        broken.runs[1].next = broken.runs[0].next;
        broken.runs[1].hide();
        let mut random = Random(5);
        let differs = (0..300).any(|_| {
            let (o, d) = (random.direction() * 3.0, random.direction());
            let d = (random.direction() * 0.5 - o + d * 0.0).normalize();
            bits(&prism, o, d) != bits(&broken, o, d)
        });
        assert!(differs);
    }
}
