//! A triangle mesh as read or generated: positions, and smooth normals where the source has them.

use std::fmt;
use std::path::{Path, PathBuf};

use glam::{DVec2, DVec3};

use super::direction::unit;
use super::obj::{Corners, Scan};

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

/// No number is NaN, so equality is reflexive. With it two `Arc`s of one mesh compare by address:
/// an edit does not walk its vertices.
impl Eq for Mesh {}

/// Why a mesh file cannot be used.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshError {
    /// The mesh file.
    pub file: PathBuf,
    /// Counted from 1; `None` if the fault is not in one line.
    pub line: Option<usize>,
    /// Characters, counted from 1.
    pub column: Option<usize>,
    /// What is wrong, one line.
    pub cause: String,
    /// A way out, one line.
    pub way_out: String,
}

impl MeshError {
    /// `FILE:LINE:COLUMN: cause`, without the way out.
    pub fn what(&self) -> String {
        let number = |n: Option<usize>| n.map_or(String::new(), |n| format!(":{n}"));
        let (line, column) = (number(self.line), number(self.column));
        format!("{}{line}{column}: {}", self.file.display(), self.cause)
    }
}

impl fmt::Display for MeshError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}\n  help: {}", self.what(), self.way_out)
    }
}

impl std::error::Error for MeshError {}

/// Reads a Wavefront OBJ file: the faces of all its objects and groups as one mesh.
///
/// Faces are cut into fans of triangles. Normals are made one long; a triangle that lacks a normal
/// at a corner, or has a zero one, gets its geometric normal instead (`z` if it has no area).
/// A triangle without texture coordinates gets `(0, 0)`. Lines, points and materials are ignored.
pub fn read_obj(path: &Path) -> Result<Mesh, MeshError> {
    let bytes = std::fs::read(path).map_err(|error| {
        let cause = format!("cannot be read: {error}");
        fault(path, [None; 2], cause, "check the name; it is relative to the scene file")
    })?;
    of_bytes(&bytes, path)
}

/// [`read_obj`] of what a file held; `path` is named in errors.
pub fn of_bytes(bytes: &[u8], path: &Path) -> Result<Mesh, MeshError> {
    let fail = |line, column, cause, way_out: &str| fault(path, [line, column], cause, way_out);
    let source = String::from_utf8_lossy(bytes);
    let scan = Scan::of(&source)
        .map_err(|fault| fail(Some(fault.line), Some(fault.column), fault.cause, fault.way_out))?;
    if scan.triangles.is_empty() {
        let way_out = "export the model as polygons, with lines such as `f 1 2 3`";
        return Err(fail(None, None, "there are no faces".to_owned(), way_out));
    }
    let options = tobj::LoadOptions { triangulate: true, ..tobj::LoadOptions::default() };
    let no_materials = |_: &Path| Ok(Default::default());
    let (models, _) = tobj::load_obj_buf(&mut scan.clean.as_bytes(), &options, no_materials)
        .map_err(|error| fail(None, None, error.to_string(), "export the model again"))?;
    // without `o` and `g` lines there is one model
    let model = models.first().expect("a text with faces has a model");
    Ok(assemble(&model.mesh, &scan.triangles))
}

fn fault(
    path: &Path,
    [line, column]: [Option<usize>; 2],
    cause: String,
    way_out: &str,
) -> MeshError {
    MeshError { file: path.to_owned(), line, column, cause, way_out: way_out.to_owned() }
}

/// Puts the mesh together; `corners` says what the file had for each triangle of `source`.
fn assemble(source: &tobj::Mesh, corners: &[Corners]) -> Mesh {
    let mut mesh = Mesh {
        positions: triples(&source.positions).collect(),
        triangles: index_triples(&source.indices).collect(),
        ..Mesh::default()
    };
    if corners.iter().any(|corner| corner.normals) {
        let units: Vec<Option<DVec3>> = triples(&source.normals).map(unit).collect();
        mesh.normals = units.iter().map(|normal| normal.unwrap_or(DVec3::Z)).collect();
        for (index, given) in index_triples(&source.normal_indices).enumerate() {
            let whole = given.iter().all(|&corner| units[corner as usize].is_some());
            mesh.triangle_normals.push(if corners[index].normals && whole {
                given
            } else {
                mesh.normals.push(geometric_normal(&mesh, index));
                [mesh.normals.len() as u32 - 1; 3]
            });
        }
    }
    if corners.iter().any(|corner| corner.uvs) {
        mesh.uvs = source.texcoords.chunks_exact(2).map(DVec2::from_slice).collect();
        let blank = mesh.uvs.len() as u32;
        let given = index_triples(&source.texcoord_indices).zip(corners);
        mesh.triangle_uvs =
            given.map(|(given, has)| if has.uvs { given } else { [blank; 3] }).collect();
        if corners.iter().any(|corner| !corner.uvs) {
            mesh.uvs.push(DVec2::ZERO);
        }
    }
    mesh
}

/// The unit normal of a triangle by its corners; `z` if it has no area.
fn geometric_normal(mesh: &Mesh, triangle: usize) -> DVec3 {
    let [a, b, c] = mesh.triangles[triangle].map(|index| mesh.positions[index as usize]);
    unit((b - a).cross(c - a)).unwrap_or(DVec3::Z)
}

fn triples(numbers: &[f64]) -> impl Iterator<Item = DVec3> {
    numbers.chunks_exact(3).map(DVec3::from_slice)
}

fn index_triples(indices: &[u32]) -> impl Iterator<Item = [u32; 3]> {
    indices.chunks_exact(3).map(|t| [t[0], t[1], t[2]])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Mesh, MeshError> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("m.obj");
        std::fs::write(&path, text).unwrap();
        let relative = |error| MeshError { file: "m.obj".into(), ..error };
        read_obj(&path).map(validated).map_err(relative)
    }

    /// Holds a mesh to its invariants.
    fn validated(mesh: Mesh) -> Mesh {
        let below =
            |list: &[[u32; 3]], len: usize| list.iter().flatten().all(|&i| (i as usize) < len);
        assert!(below(&mesh.triangles, mesh.positions.len()));
        assert!(below(&mesh.triangle_normals, mesh.normals.len()));
        assert!(below(&mesh.triangle_uvs, mesh.uvs.len()));
        for list in [&mesh.triangle_normals, &mesh.triangle_uvs] {
            assert!(list.is_empty() || list.len() == mesh.triangles.len());
        }
        assert!(mesh.normals.iter().all(|normal| (normal.length() - 1.0).abs() < 1e-12));
        mesh
    }

    const CORNERS: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

    fn refused(lines: &str) -> String {
        read(&format!("{CORNERS}{lines}")).unwrap_err().what()
    }

    #[test]
    fn objects_groups_and_polygons_become_one_mesh() {
        let mesh = read(&format!("o a\n{CORNERS}f 1 2 3 4 # a square\ng b\nf -4 -3 -2\nl 1 2 3\n"));
        let mesh = mesh.unwrap();
        assert_eq!(mesh.positions.len(), 4);
        assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3], [0, 1, 2]]);
        assert!(mesh.normals.is_empty() && mesh.triangle_normals.is_empty());
        assert!(mesh.uvs.is_empty() && mesh.triangle_uvs.is_empty());
    }

    #[test]
    fn normals_and_uvs_keep_their_own_indices_and_gaps_are_filled() {
        let lines = "vn 0 0 5\nvn 0 0 0\nvn 1 0 0\nvt 0.5 0.25\nvt 1\n\
                     f 1/1/1 2/2/1 3/1/1\nf 1//1 2//2 3//1\nf 3 2 1\nf 1//3 2//3 3//3\n";
        let mesh = read(&format!("{CORNERS}{lines}")).unwrap();
        let normal = |triangle: usize| {
            mesh.triangle_normals[triangle].map(|index| mesh.normals[index as usize])
        };
        assert_eq!(normal(0), [DVec3::Z; 3]);
        assert_eq!(normal(1), [DVec3::Z; 3]); // a zero normal: the geometric one
        assert_eq!(normal(2), [DVec3::NEG_Z; 3]); // none: the geometric one
        assert_eq!(normal(3), [DVec3::X; 3]);
        let uv =
            |triangle: usize| mesh.triangle_uvs[triangle].map(|index| mesh.uvs[index as usize]);
        assert_eq!(uv(0), [DVec2::new(0.5, 0.25), DVec2::new(1.0, 0.0), DVec2::new(0.5, 0.25)]);
        assert_eq!(uv(2), [DVec2::ZERO; 3]);
    }

    #[test]
    fn weights_and_colours_of_vertices() {
        let text = "v 2 0 0 2\nv 1 0 0 0.5 0.5 0.5\nv 0 1 0\nf 1 2 3\n";
        assert_eq!(read(text).unwrap().positions, [DVec3::X, DVec3::X, DVec3::Y]);
    }

    #[test]
    fn faults_have_line_and_column() {
        for (lines, expected) in [
            ("v 1 nan 0\nf 1 2 3", "m.obj:5:5: `nan` is not a finite number"),
            ("v 1 2 1e13\nf 1 2 3", "m.obj:5:7: the coordinate `1e13` is beyond 1e12"),
            ("v 1 2\nf 1 2 3", "m.obj:5:1: `v` needs 3 numbers, found 2"),
            ("v 1 0 0 0\nf 1 2 3", "m.obj:5:9: the weight of the point is zero"),
            ("vn 0 x 1\nf 1 2 3", "m.obj:5:6: `x` is not a number"),
            ("f 1 2 3\n\nf 1 2 5", "m.obj:7:7: there is no vertex 5; the file has 4"),
            ("f 0 1 2", "m.obj:5:3: there is no vertex 0; the file has 4"),
            ("f 1 2 -5", "m.obj:5:7: there is no vertex -5; the file has 4 so far"),
            ("f 1/1 2 3", "m.obj:5:3: there is no texture coordinate 1; the file has 0"),
            ("f 1//-1 2 3", "m.obj:5:3: there is no normal -1; the file has 0 so far"),
            ("f 1 2", "m.obj:5:1: a face needs at least 3 corners, this one has 2"),
            ("vt 0 0\nvn 0 0 1\nf 1 2 3/1/1/1", "m.obj:7:7: `3/1/1/1` is not a corner"),
            ("f 1 2 a", "m.obj:5:7: `a` is not a corner"),
            ("l 1 2 3", "m.obj: there are no faces"),
        ] {
            assert_eq!(refused(lines), expected, "{lines}");
        }
    }

    #[test]
    fn a_missing_file_is_named() {
        let error = read_obj(Path::new("no/such.obj")).unwrap_err();
        assert_eq!((error.line, error.column), (None, None));
        assert!(error.to_string().starts_with("no/such.obj: cannot be read: "), "{error}");
        assert!(
            error.to_string().ends_with("help: check the name; it is relative to the scene file")
        );
    }
}
