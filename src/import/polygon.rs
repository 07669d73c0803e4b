//! Polygons cut into triangles.

use glam::{DVec2, DVec3};

/// More corners than this are cut into a fan: cutting ears takes the square of their number.
const MOST_EARS: usize = 4096;

/// Twice the area along the normal (Newell's sum about the first corner).
fn newell(points: &[DVec3]) -> DVec3 {
    let Some(&origin) = points.first() else { return DVec3::ZERO };
    points.windows(2).map(|pair| (pair[0] - origin).cross(pair[1] - origin)).sum()
}

/// Whether no corner turns against the others, up to a share of 1e-9 of the area.
pub(super) fn is_convex(points: &[DVec3]) -> bool {
    let normal = newell(points);
    let least = -1e-9 * normal.length_squared();
    let count = points.len();
    (0..count).all(|i| {
        let (a, b, c) = (points[i], points[(i + 1) % count], points[(i + 2) % count]);
        (b - a).cross(c - b).dot(normal) >= least
    })
}

/// Triangles that cover a polygon, as indices of its corners, in its sense of rotation.
///
/// Convex polygons are cut into a fan, others by ears. What has no area, crosses itself, or has more
/// than 4096 corners becomes a fan too: second value `false` if that may not cover it.
pub(super) fn triangles(points: &[DVec3]) -> (Vec<[u32; 3]>, bool) {
    let count = points.len() as u32;
    let fan = || (2..count).map(|i| [0, i - 1, i]).collect();
    if is_convex(points) {
        return (fan(), true);
    }
    if points.len() > MOST_EARS {
        return (fan(), false);
    }
    match ears(&flat(points)) {
        Some(ears) => (ears, true),
        None => (fan(), false),
    }
}

/// The polygon as seen along the axis in which its normal is longest, counter-clockwise.
fn flat(points: &[DVec3]) -> Vec<DVec2> {
    let normal = newell(points);
    let size = normal.abs();
    points
        .iter()
        .map(|p| {
            let (u, v, along) = if size.z >= size.x && size.z >= size.y {
                (p.x, p.y, normal.z)
            } else if size.x >= size.y {
                (p.y, p.z, normal.x)
            } else {
                (p.z, p.x, normal.y)
            };
            if along < 0.0 { DVec2::new(v, u) } else { DVec2::new(u, v) }
        })
        .collect()
}

/// Cuts ears off a simple polygon that is counter-clockwise; `None` if there is none to cut.
fn ears(points: &[DVec2]) -> Option<Vec<[u32; 3]>> {
    let turn =
        |a: usize, b: usize, c: usize| (points[b] - points[a]).perp_dot(points[c] - points[a]);
    let mut left: Vec<usize> = (0..points.len()).collect();
    let mut triangles = Vec::with_capacity(points.len());
    while left.len() > 3 {
        let count = left.len();
        let ear = (0..count).find(|&i| {
            let [a, b, c] = [left[(i + count - 1) % count], left[i], left[(i + 1) % count]];
            let inside = |&&p: &&usize| {
                ![a, b, c].contains(&p)
                    && turn(a, b, p) >= 0.0
                    && turn(b, c, p) >= 0.0
                    && turn(c, a, p) >= 0.0
            };
            turn(a, b, c) > 0.0 && left.iter().find(inside).is_none()
        })?;
        let [a, b, c] = [left[(ear + count - 1) % count], left[ear], left[(ear + 1) % count]];
        triangles.push([a as u32, b as u32, c as u32]);
        left.remove(ear);
    }
    triangles.push([left[0] as u32, left[1] as u32, left[2] as u32]);
    Some(triangles)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn area(points: &[DVec3], triangles: &[[u32; 3]]) -> f64 {
        let of = |t: &[u32; 3]| newell(&t.map(|i| points[i as usize])).length() / 2.0;
        triangles.iter().map(of).sum()
    }

    #[test]
    fn concave_polygons_are_covered_once() {
        let star: Vec<DVec3> =
            [[0., 3.], [1., 1.], [3., 0.], [1., -1.], [0., -3.], [-1., -1.], [-3., 0.], [-1., 1.]]
                .iter()
                .map(|[x, y]| DVec3::new(*x, 2.0, *y))
                .collect();
        for points in [star.clone(), star.into_iter().rev().collect()] {
            assert!(!is_convex(&points));
            let (found, whole) = triangles(&points);
            assert!(whole && found.len() == 6);
            let outline = newell(&points);
            assert!((area(&points, &found) - outline.length() / 2.0).abs() < 1e-12);
            for t in found {
                assert!(newell(&t.map(|i| points[i as usize])).dot(outline) > 0.0);
            }
        }
    }

    #[test]
    fn convex_ones_are_fans_and_bow_ties_are_no_trouble() {
        let square = [DVec3::ZERO, DVec3::X, DVec3::new(1., 1., 0.), DVec3::Y];
        assert_eq!(triangles(&square), (vec![[0, 1, 2], [0, 2, 3]], true));
        let bow = [DVec3::ZERO, DVec3::new(1., 1., 0.), DVec3::X, DVec3::new(0., 1.5, 0.)];
        assert_eq!(triangles(&bow).0.len(), 2);
        assert_eq!(triangles(&[DVec3::ZERO; 4]).0.len(), 2);
    }
}
