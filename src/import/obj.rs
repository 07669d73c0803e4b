//! Wavefront OBJ: one solid per object (or group, where there are no objects) and material, materials from the MTL files beside it.

use std::collections::{HashMap, HashSet};
use std::path::PathBuf;
use std::sync::Arc;

use glam::DVec3;

use super::job::{Job, Names, of_mesh};
use super::mtl;
use super::mtl_material;
use super::place::{At, ImportError};
use super::words::Word;
use crate::color::Rgb;
use crate::scene::mesh::{self, Mesh};
use crate::scene::{Material, Scene, Shape, Solid};

/// The lists that a corner of a face points into.
const LISTS: [&str; 3] = ["v", "vt", "vn"];

/// More groups than this are no objects: solids are made of materials alone.
const MOST_GROUPS: usize = 500;

/// A corner: an index from 0 into each of the lists, where it has one.
type Corner = [Option<usize>; 3];

/// Faces that become one solid.
#[derive(Debug)]
struct Group {
    object: String,
    /// What `usemtl` said.
    material: Option<String>,
    faces: Vec<Vec<Corner>>,
}

/// What a file holds, apart from its points.
#[derive(Debug, Default)]
struct Outline<'a> {
    /// The arguments of every line of each of the lists.
    lists: [Vec<&'a str>; 3],
    groups: Vec<Group>,
    /// `mtllib`, with the line.
    libraries: Vec<(String, usize)>,
    /// The line of the first `usemtl` of each name.
    uses: Vec<(String, usize)>,
}

/// Reads an OBJ file into a scene without camera and lights; `y` is up.
pub(super) fn read(job: &mut Job<'_>, bytes: &[u8]) -> Result<Scene, ImportError> {
    let text = String::from_utf8_lossy(bytes);
    let joined = joined(&text);
    let text = joined.as_deref().unwrap_or(&text);
    // Finds every fault, with its place: from here on all corners are known to exist.
    let whole = mesh::of_bytes(text.as_bytes(), job.source).map_err(of_mesh)?;
    let outline = outline(job, text, &whole);
    let mut scene = Scene { ambient_light: Rgb::grey(0.1), ..Scene::default() };
    job.note(
        At::File,
        "added: OBJ has no ambient light, its strength is set to 0.1 (ambient_light)",
    );
    let index = materials(job, &outline, &mut scene)?;
    let mut names = Names::default();
    let alone = outline.groups.len() == 1 && joined.is_none();
    for group in &outline.groups {
        let material = index[&group.material];
        let name = match (&group.object, outline.groups.len()) {
            (object, _) if !object.is_empty() => object.clone(),
            (_, 1) => stem(job),
            _ => scene.materials[material].name.clone(),
        };
        let name = names.take(&name, "mesh");
        let shape = if alone {
            Shape::Mesh { file: job.name_of(job.source), mesh: Arc::new(whole.clone()) }
        } else {
            job.mesh(&name, group_text(group, &outline.lists))?
        };
        scene.solids.push(Solid::new(name, shape, material));
    }
    Ok(scene)
}

fn stem(job: &Job<'_>) -> String {
    job.source.file_stem().unwrap_or_default().to_string_lossy().into_owned()
}

/// The text with lines that end in `\` put together, at the first one's place; `None` if there are none.
fn joined(text: &str) -> Option<String> {
    if !text.lines().any(|line| line.ends_with('\\')) {
        return None;
    }
    let (mut out, mut open) = (String::with_capacity(text.len()), 0);
    for line in text.lines() {
        match line.strip_suffix('\\') {
            Some(start) => {
                out.push_str(start);
                out.push(' ');
                open += 1;
            }
            None => {
                out.push_str(line);
                out.push_str(&"\n".repeat(open + 1));
                open = 0;
            }
        }
    }
    Some(out)
}

/// Sorts the faces of a file that is known to be sound.
fn outline<'a>(job: &mut Job<'_>, text: &'a str, whole: &Mesh) -> Outline<'a> {
    let mut outline = Outline::default();
    let mut groups: HashMap<(String, Option<String>), usize> = HashMap::new();
    let (mut object, mut material) = (String::new(), None::<String>);
    let objects = object_key(text);
    for (index, line_text) in text.lines().enumerate() {
        let line = index + 1;
        let words = Word::all(line_text, line);
        let Some((first, rest)) = words.split_first() else { continue };
        match first.text {
            "f" => {
                let face: Vec<Corner> =
                    rest.iter().map(|word| corner(word.text, &outline.lists)).collect();
                concave(job, &face, &outline.lists[0], line);
                let key = (object.clone(), material.clone());
                let next = outline.groups.len();
                let group = *groups.entry(key).or_insert(next);
                if group == next {
                    let (object, material) = (object.clone(), material.clone());
                    outline.groups.push(Group { object, material, faces: Vec::new() });
                }
                outline.groups[group].faces.push(face);
            }
            key if key == objects => object = mtl::rest(line_text, first),
            "usemtl" => {
                let name = mtl::rest(line_text, first);
                if outline.uses.iter().all(|(known, _)| *known != name) {
                    outline.uses.push((name.clone(), line));
                }
                material = Some(name);
            }
            "mtllib" => outline.libraries.push((mtl::rest(line_text, first), line)),
            key => match LISTS.iter().position(|list| *list == key) {
                Some(list) => {
                    if list == 0 && rest.len() > 4 {
                        job.note(
                            At::Line(line),
                            "colours of points are left out: materials colour",
                        );
                    }
                    let code = line_text.split('#').next().unwrap_or_default();
                    outline.lists[list].push(code.trim());
                }
                None => left_out(job, key, rest, line, whole),
            },
        }
    }
    outline
}

/// What begins an object: `o`, or `g` in a file without any `o` and without too many groups.
fn object_key(text: &str) -> &'static str {
    let mut groups = HashSet::new();
    for line in text.lines() {
        let mut words = line.split_whitespace();
        match words.next() {
            Some("o") => return "o",
            Some("g") => {
                groups.insert(words.collect::<Vec<_>>());
            }
            _ => {}
        }
    }
    if groups.len() <= MOST_GROUPS { "g" } else { "o" }
}

/// Remarks on a line that is neither a point, nor a face, nor about materials.
fn left_out(job: &mut Job<'_>, key: &str, rest: &[Word<'_>], line: usize, whole: &Mesh) {
    let why = match key {
        "g" => {
            return job.note(
                At::Line(line),
                "groups (`g`) are joined: solids are made of objects (`o`) and materials",
            );
        }
        "s" => {
            let smooth = rest.first().is_some_and(|word| !["off", "0"].contains(&word.text));
            if smooth && whole.normals.is_empty() {
                job.note(
                    At::Line(line),
                    "smoothing (`s`) is left out: the file has no normals (`vn`)",
                );
            }
            return;
        }
        "l" | "p" => "lines and points have no surface",
        "vp" | "cstype" | "deg" | "bmat" | "step" | "curv" | "curv2" | "surf" | "parm" | "trim"
        | "hole" | "scrv" | "sp" | "end" | "con" => "free-form curves and surfaces are no meshes",
        "mg" | "bevel" | "c_interp" | "d_interp" | "lod" | "ctech" | "stech" => {
            "it is about how other programs draw"
        }
        "shadow_obj" | "trace_obj" | "maplib" | "usemap" | "call" | "csh" => {
            "other files than MTL are not followed"
        }
        _ => "it is no statement of OBJ",
    };
    job.note(At::Line(line), format!("`{key}` is left out: {why}"));
}

/// A corner of a file that is known to be sound; negative indices count back from the last line read.
fn corner(text: &str, lists: &[Vec<&str>; 3]) -> Corner {
    let mut corner = [None; 3];
    for (list, part) in text.split('/').enumerate().take(3) {
        let index = part.parse::<i64>().ok();
        corner[list] = index.map(|index| {
            if index < 0 {
                (lists[list].len() as i64 + index) as usize
            } else {
                (index - 1) as usize
            }
        });
    }
    corner
}

/// Remarks on a face that cutting into a fan spoils.
fn concave(job: &mut Job<'_>, face: &[Corner], points: &[&str], line: usize) {
    if face.len() < 4 {
        return;
    }
    let point = |corner: &Corner| {
        // Points may stand behind the face that uses them: those are not looked at.
        let words = points.get(corner[0]?)?.split_whitespace().skip(1);
        let numbers: Vec<f64> = words.take(3).map(str::parse).collect::<Result<_, _>>().ok()?;
        Some(DVec3::from_slice(numbers.get(..3)?))
    };
    let corners: Option<Vec<DVec3>> = face.iter().map(point).collect();
    if corners.is_some_and(|corners| !super::polygon::is_convex(&corners)) {
        let text = "a concave face is cut into a fan of triangles: cut it before exporting";
        job.note(At::Line(line), text);
    }
}

/// The faces of a group, and of the lists what they use, as a file of their own.
fn group_text(group: &Group, lists: &[Vec<&str>; 3]) -> String {
    let mut out = String::new();
    let mut numbers: [HashMap<usize, usize>; 3] = Default::default();
    for list in 0..3 {
        for index in group.faces.iter().flatten().filter_map(|corner| corner[list]) {
            let next = numbers[list].len() + 1;
            numbers[list].entry(index).or_insert_with(|| {
                out.push_str(lists[list][index]);
                out.push('\n');
                next
            });
        }
    }
    for face in &group.faces {
        out.push('f');
        for corner in face {
            let [v, vt, vn] =
                [0, 1, 2].map(|list| corner[list].map(|index| numbers[list][&index].to_string()));
            out.push(' ');
            out.push_str(&v.unwrap_or_default());
            match (vt, vn) {
                (None, None) => {}
                (Some(vt), None) => out.push_str(&format!("/{vt}")),
                (vt, Some(vn)) => out.push_str(&format!("/{}/{vn}", vt.unwrap_or_default())),
            }
        }
        out.push('\n');
    }
    out
}

/// Adds the materials that faces use; gives the index of each.
fn materials(
    job: &mut Job<'_>,
    outline: &Outline<'_>,
    scene: &mut Scene,
) -> Result<HashMap<Option<String>, usize>, ImportError> {
    let files = libraries(job, &outline.libraries)?;
    let mut found: HashMap<String, Material> = HashMap::new();
    for (path, text) in &files {
        for description in mtl::read(text, path)? {
            let name = description.name.clone();
            let material = mtl_material::material(job, path, &description, name.clone())?;
            if found.insert(name.clone(), material).is_some() {
                let place = super::place::Place::new(path, At::Line(description.line));
                job.note_at(
                    place,
                    format!("the material `{name}` is there twice: the last one counts"),
                );
            }
        }
    }
    let mut names = Names::default();
    let mut index = HashMap::new();
    for group in &outline.groups {
        if index.contains_key(&group.material) {
            continue;
        }
        let written = group.material.clone().unwrap_or_default();
        let name = names.take(&written, "material");
        let material = found.remove(&written).unwrap_or_else(|| {
            let line = outline.uses.iter().find(|(known, _)| *known == written);
            if let Some((name, line)) = line {
                let text = format!("there is no material `{name}`: it is made matt white");
                job.note(At::Line(*line), text);
            }
            Material { ambient: Rgb::grey(0.2), ..Material::new("") }
        });
        index.insert(group.material.clone(), scene.materials.len());
        scene.materials.push(Material { name, ..material });
    }
    let mut unused: Vec<&String> = found.keys().collect();
    unused.sort();
    for name in unused {
        job.note(At::File, format!("the material `{name}` is left out: no face uses it"));
    }
    Ok(index)
}

/// The MTL files that a file names, with their text.
fn libraries(
    job: &Job<'_>,
    named: &[(String, usize)],
) -> Result<Vec<(PathBuf, String)>, ImportError> {
    let mut files: Vec<(PathBuf, String)> = Vec::new();
    for (written, line) in named {
        // One name with spaces, or several names.
        let whole = vec![written.as_str()];
        let apart: Vec<&str> = written.split_whitespace().collect();
        let names = if job.read(&job.path_of(written)).is_ok() { whole } else { apart };
        for name in names {
            let path = job.path_of(name);
            let bytes = job.read(&path).map_err(|error| {
                let cause = format!("the material file `{name}` cannot be read: {error}");
                let way_out = "put it beside the OBJ file, or take the `mtllib` line out";
                job.error(At::Line(*line), cause, way_out)
            })?;
            if files.iter().all(|(known, _)| *known != path) {
                files.push((path, String::from_utf8_lossy(&bytes).into_owned()));
            }
        }
    }
    Ok(files)
}
