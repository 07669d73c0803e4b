//! A triangle mesh as read or generated: positions, and smooth normals where the source has them.

use glam::{DVec2, DVec3};

/// Triangles over shared vertices, in object space.
///
/// # Invariants
/// Every index is below the length of the list it points into; every number is finite.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// Vertex positions.
    pub positions: Vec<DVec3>,
    /// Unit vertex normals; empty if the mesh has none.
    pub normals: Vec<DVec3>,
    /// Texture coordinates; empty if the mesh has none.
    pub uvs: Vec<DVec2>,
    /// Three positions per triangle, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// Three normals per triangle; empty, or as long as `triangles`.
    pub triangle_normals: Vec<[u32; 3]>,
    /// Three texture coordinates per triangle; empty, or as long as `triangles`.
    pub triangle_uvs: Vec<[u32; 3]>,
}
