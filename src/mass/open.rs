//! Finds an edge at which a mesh is not closed.

use std::collections::HashMap;
use std::fmt;

use glam::DVec3;

use crate::scene::mesh::Mesh;

/// An edge that does not lie between exactly two triangles that run along it in opposite directions.
#[derive(Clone, Debug, PartialEq)]
pub struct OpenEdge {
    /// The ends, in the mesh's own space.
    pub ends: [DVec3; 2],
    /// How many triangles run along it, in its direction and against it.
    pub triangles: [u32; 2],
}

impl fmt::Display for OpenEdge {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let OpenEdge { ends: [a, b], triangles: [with, against] } = self;
        let show = |p: &DVec3| format!("({}, {}, {})", p.x, p.y, p.z);
        let what = match (with, against) {
            (1, 0) | (0, 1) => "belongs to one triangle alone".to_owned(),
            (2, 0) | (0, 2) => "lies between two triangles of opposite sense".to_owned(),
            (with, against) => format!("belongs to {} triangles", with + against),
        };
        write!(f, "the mesh is not closed: the edge from {} to {} {what}", show(a), show(b))
    }
}

/// The first edge, by its points, at which the mesh is not closed.
pub(super) fn open_edge(mesh: &Mesh) -> Option<OpenEdge> {
    let mut edges: HashMap<[u32; 2], [u32; 2]> = HashMap::new();
    for [a, b, c] in &mesh.triangles {
        if a == b || b == c || c == a {
            continue;
        }
        for [from, to] in [[*a, *b], [*b, *c], [*c, *a]] {
            let sides = edges.entry([from.min(to), from.max(to)]).or_default();
            sides[usize::from(from > to)] += 1;
        }
    }
    let open = edges.into_iter().filter(|(_, sides)| *sides != [1, 1]);
    let (ends, triangles) = open.min_by_key(|(ends, _)| *ends)?;
    Some(OpenEdge { ends: ends.map(|index| mesh.positions[index as usize]), triangles })
}
