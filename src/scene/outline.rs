//! Whether loops in the plane bound a region: large enough, and none crossing itself or another.

use glam::DVec2;

use super::direction::TINY;

/// Smallest area of a loop, as a share of the square of its extent.
const AREA: f64 = 1e-12;

/// An edge: its ends, its loop and its place there, counted from 1.
#[derive(Clone, Copy)]
struct Edge {
    a: DVec2,
    b: DVec2,
    place: (usize, usize),
}

/// What is wrong with the outline of a prism, with a way out.
pub(super) fn flaw(loops: &[Vec<DVec2>]) -> Option<(String, String)> {
    if loops.is_empty() {
        let help = "for example `outline = [[0, 0], [1, 0], [0, 1]]`".to_owned();
        return Some(("the outline has no points".to_owned(), help));
    }
    let name = |index: usize| match loops.len() {
        1 => "the outline".to_owned(),
        _ => format!("loop {} of the outline", index + 1),
    };
    loops
        .iter()
        .enumerate()
        .find_map(|(index, points)| degenerate(points, &name(index)))
        .or_else(|| crossing(loops))
}

fn degenerate(points: &[DVec2], name: &str) -> Option<(String, String)> {
    if points.len() < 3 {
        let message = format!("{name} needs at least 3 points, it has {}", points.len());
        return Some((message, "add points, in order around the edge".to_owned()));
    }
    let first = points[0];
    let extent = points.iter().map(|p| (*p - first).abs().max_element()).fold(0.0, f64::max);
    let size = extent.max(f64::MIN_POSITIVE);
    let corners: Vec<DVec2> = points.iter().map(|p| (*p - first) / size).collect();
    let next = corners.iter().cycle().skip(1);
    let doubled: f64 = corners.iter().zip(next).map(|(a, b)| a.perp_dot(*b)).sum();
    (extent < TINY || doubled.abs() <= 2.0 * AREA).then(|| {
        let help = "move its points apart, in order around the edge".to_owned();
        (format!("{name} has no area"), help)
    })
}

/// Two edges that cross, if there are such. Edges that only touch do not.
fn crossing(loops: &[Vec<DVec2>]) -> Option<(String, String)> {
    let mut edges: Vec<Edge> = Vec::new();
    for (index, points) in loops.iter().enumerate() {
        let next = points.iter().cycle().skip(1);
        edges.extend(points.iter().zip(next).enumerate().map(|(place, (a, b))| Edge {
            a: *a,
            b: *b,
            place: (index + 1, place + 1),
        }));
    }
    let low = |edge: &Edge| edge.a.x.min(edge.b.x);
    edges.sort_by(|p, q| low(p).total_cmp(&low(q)));
    edges.iter().enumerate().find_map(|(index, p)| {
        let high = p.a.x.max(p.b.x);
        let rivals = edges[index + 1..].iter().take_while(|q| low(q) <= high);
        let q = rivals.into_iter().find(|q| cross(p, q))?;
        let (p, q) = if p.place < q.place { (p.place, q.place) } else { (q.place, p.place) };
        let side = |(index, place): (usize, usize)| match loops.len() {
            1 => format!("{place}"),
            _ => format!("{place} of loop {index}"),
        };
        let message =
            format!("the outline crosses itself: edge {} meets edge {}", side(p), side(q));
        Some((message, "move its points, in order around the edge".to_owned()))
    })
}

/// Whether two edges cross between their ends.
fn cross(p: &Edge, q: &Edge) -> bool {
    let side = |e: &Edge, point: DVec2| (e.b - e.a).perp_dot(point - e.a);
    side(p, q.a) * side(p, q.b) < 0.0 && side(q, p.a) * side(q, p.b) < 0.0
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(loops: &[&[[f64; 2]]]) -> Option<String> {
        let loops: Vec<Vec<DVec2>> =
            loops.iter().map(|l| l.iter().copied().map(DVec2::from).collect()).collect();
        flaw(&loops).map(|(what, _)| what)
    }

    const SQUARE: [[f64; 2]; 4] = [[0., 0.], [4., 0.], [4., 4.], [0., 4.]];

    #[test]
    fn outlines_are_simple() {
        let hole = [[1., 1.], [2., 1.], [2., 2.], [1., 2.]];
        let out = [[1., 1.], [5., 1.], [5., 2.]];
        assert_eq!(of(&[&SQUARE]), None);
        assert_eq!(of(&[&SQUARE, &hole]), None);
        assert_eq!(of(&[]).unwrap(), "the outline has no points");
        assert_eq!(of(&[&SQUARE[..2]]).unwrap(), "the outline needs at least 3 points, it has 2");
        assert_eq!(
            of(&[&SQUARE, &[]]).unwrap(),
            "loop 2 of the outline needs at least 3 points, it has 0"
        );
        assert_eq!(of(&[&[[0., 0.], [1., 1.], [2., 2.]]]).unwrap(), "the outline has no area");
        let bow = [[0., 0.], [4., 0.], [1., 4.], [4., 4.]];
        assert_eq!(of(&[&bow]).unwrap(), "the outline crosses itself: edge 2 meets edge 4");
        let message = of(&[&SQUARE, &out]).unwrap();
        assert_eq!(message, "the outline crosses itself: edge 2 of loop 1 meets edge 1 of loop 2");
    }

    #[test]
    fn an_outline_may_touch_itself() {
        let touching = [[0., 0.], [4., 0.], [2., 2.], [4., 4.], [0., 4.], [2., 2.]];
        assert_eq!(of(&[&touching]), None);
    }
}
