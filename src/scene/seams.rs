//! Whether a mesh is closed, and where it is not.

use super::mesh::Mesh;
use crate::progress::{Cancelled, Progress};

/// Elements handled between two looks at the cancel flag.
const CHECK_EVERY: usize = 1 << 14;

/// Whether every edge of a mesh is shared by exactly two triangles that run along it in opposite
/// directions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Seams {
    /// All are: the mesh encloses something.
    Closed,
    /// This one, between two vertices, is not.
    Open([u32; 2]),
    /// There are none.
    Empty,
}

impl Mesh {
    /// Whether it is closed.
    pub fn seams(&self) -> Seams {
        // Nobody cancels what nobody else knows.
        seams(&self.triangles, &Progress::default()).unwrap_or(Seams::Empty)
    }
}

/// Looks at the edges of all triangles; those of triangles with a vertex twice do not count.
pub fn seams(triangles: &[[u32; 3]], progress: &Progress) -> Result<Seams, Cancelled> {
    let edges = |[a, b, c]: [u32; 3]| {
        let degenerate = a == b || b == c || c == a;
        [(a, b), (b, c), (c, a)].into_iter().filter(move |_| !degenerate)
    };
    // Edges in buckets by their lower vertex: where each bucket ends, then what is in it.
    let vertices = triangles.iter().flatten().max().map_or(0, |v| *v as usize + 1);
    let mut ends = vec![0usize; vertices];
    for chunk in triangles.chunks(CHECK_EVERY) {
        progress.check()?;
        chunk.iter().copied().flat_map(edges).for_each(|(p, q)| ends[p.min(q) as usize] += 1);
    }
    let mut total = 0;
    for end in &mut ends {
        (*end, total) = (total, total + *end);
    }
    let mut bucketed = vec![(0, false); total];
    for chunk in triangles.chunks(CHECK_EVERY) {
        progress.check()?;
        for (p, q) in chunk.iter().copied().flat_map(edges) {
            let end = &mut ends[p.min(q) as usize];
            bucketed[*end] = (p.max(q), p < q);
            *end += 1;
        }
    }
    let mut begin = 0;
    for (low, end) in ends.into_iter().enumerate() {
        if low % CHECK_EVERY == 0 {
            progress.check()?;
        }
        let bucket = &mut bucketed[begin..end];
        bucket.sort_unstable();
        if let Some(high) = unpaired(bucket) {
            return Ok(Seams::Open([low as u32, high]));
        }
        begin = end;
    }
    Ok(if total > 0 { Seams::Closed } else { Seams::Empty })
}

/// The other vertex of an edge that is not there exactly once each way; `bucket` is sorted.
fn unpaired(bucket: &[(u32, bool)]) -> Option<u32> {
    let opposite = |pair: &[(u32, bool)]| matches!(pair, [(a, false), (b, true)] if a == b);
    let repeated = bucket.windows(2).find(|pair| pair[0] == pair[1]).map(|pair| pair[0].0);
    repeated.or_else(|| bucket.chunks(2).find(|pair| !opposite(pair)).map(|pair| pair[0].0))
}

#[cfg(test)]
mod tests {
    use super::*;

    const TETRAHEDRON: [[u32; 3]; 4] = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];

    #[test]
    fn closed_means_every_edge_twice_and_opposite() {
        let seams = |t: &[[u32; 3]]| seams(t, &Progress::default()).unwrap();
        assert_eq!(seams(&TETRAHEDRON), Seams::Closed);
        assert_eq!(seams(&TETRAHEDRON[..3]), Seams::Open([0, 2]));
        let mut turned = TETRAHEDRON;
        turned[2].swap(0, 1);
        assert!(matches!(seams(&turned), Seams::Open(_)));
        let doubled = [TETRAHEDRON, TETRAHEDRON].concat();
        assert!(matches!(seams(&doubled), Seams::Open(_)));
        assert_eq!(seams(&[]), Seams::Empty);
    }
}
