//! A mesh as the text of an OBJ file.

use std::fmt::Write;

use glam::DVec3;

use crate::scene::mesh::Mesh;

/// The text of a mesh. Numbers are the shortest decimals that read back as the same bits; the reader
/// puts points into the order in which triangles use them.
pub(super) fn text(mesh: &Mesh) -> String {
    let Mesh { positions, normals, uvs, triangles, triangle_normals, triangle_uvs } = mesh;
    let mut out = String::new();
    for DVec3 { x, y, z } in positions {
        line(&mut out, format_args!("v {x} {y} {z}"));
    }
    for uv in uvs {
        line(&mut out, format_args!("vt {} {}", uv.x, uv.y));
    }
    for DVec3 { x, y, z } in normals {
        line(&mut out, format_args!("vn {x} {y} {z}"));
    }
    for (index, triangle) in triangles.iter().enumerate() {
        let (uv, normal) = (triangle_uvs.get(index), triangle_normals.get(index));
        let corner = |k: usize| {
            let v = triangle[k] + 1;
            match (uv, normal) {
                (None, None) => format!("{v}"),
                (Some(uv), None) => format!("{v}/{}", uv[k] + 1),
                (None, Some(normal)) => format!("{v}//{}", normal[k] + 1),
                (Some(uv), Some(normal)) => format!("{v}/{}/{}", uv[k] + 1, normal[k] + 1),
            }
        };
        line(&mut out, format_args!("f {} {} {}", corner(0), corner(1), corner(2)));
    }
    out
}

fn line(out: &mut String, text: std::fmt::Arguments<'_>) {
    writeln!(out, "{text}").expect("text takes every line");
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use glam::DVec2;

    use super::*;
    use crate::scene::mesh;

    #[test]
    fn a_mesh_comes_back_bit_for_bit() {
        let mesh = Mesh {
            positions: vec![DVec3::new(0.1, -1e-7, 1.0 / 3.0), DVec3::X * 1e11, DVec3::Y],
            normals: vec![DVec3::Z, DVec3::X],
            uvs: vec![DVec2::new(0.25, 1.0 / 7.0)],
            triangles: vec![[0, 1, 2], [2, 1, 0]],
            triangle_normals: vec![[0, 0, 1], [1, 1, 1]],
            triangle_uvs: vec![[0; 3]; 2],
        };
        let bare = Mesh {
            positions: mesh.positions.clone(),
            triangles: mesh.triangles.clone(),
            ..Mesh::default()
        };
        for mesh in [mesh, bare] {
            assert_eq!(mesh::of_bytes(text(&mesh).as_bytes(), Path::new("m.obj")), Ok(mesh));
        }
    }
}
