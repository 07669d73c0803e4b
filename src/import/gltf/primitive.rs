//! Primitives of a glTF mesh as triangles in world space.

use glam::{DMat3, DMat4, DVec2, DVec3};

use super::buffers::Buffers;
use super::json::Json;
use crate::import::job::Job;
use crate::import::place::ImportError;
use crate::scene::fields;
use crate::scene::mesh::Mesh;

/// The triangles of a primitive; `None`, with a remark, if it is made of points or lines.
pub(super) fn read(
    job: &mut Job<'_>,
    buffers: &Buffers<'_>,
    primitive: &Json<'_>,
    world: DMat4,
) -> Result<Option<Mesh>, ImportError> {
    let mode = primitive.whole_or("mode", 4)?;
    if mode < 4 {
        job.note(primitive.at(), "points and lines are left out: they have no surface");
        return Ok(None);
    }
    let attributes = primitive.need("attributes")?;
    remarks(job, primitive, &attributes);
    let accessor = |key: &str| match attributes.get(key) {
        Some(index) => index.follow(&buffers.root, "accessors").map(Some),
        None => Ok(None),
    };
    let Some(positions) = accessor("POSITION")? else {
        job.note(primitive.at(), "a primitive without POSITION is left out");
        return Ok(None);
    };
    let positions: Vec<DVec3> =
        buffers.elements::<3>(&positions)?.into_iter().map(DVec3::from).collect();
    let count = positions.len();
    let mut mesh =
        Mesh { triangles: triangles(buffers, primitive, mode, count)?, ..Mesh::default() };
    if mesh.triangles.is_empty() {
        job.note(primitive.at(), "a primitive without triangles is left out");
        return Ok(None);
    }
    if let Some(normals) = accessor("NORMAL")? {
        let turn = normal_matrix(world);
        let turned = buffers.elements::<3>(&normals)?;
        mesh.normals = turned.into_iter().map(|n| turn * DVec3::from(n)).collect();
        same_length(&attributes, "NORMAL", mesh.normals.len(), count)?;
        mesh.triangle_normals = mesh.triangles.clone();
    }
    if let Some(uvs) = accessor("TEXCOORD_0")? {
        // v runs down from the image's upper edge, here it runs up.
        let up = |[u, v]: [f64; 2]| DVec2::new(u, 1.0 - v);
        mesh.uvs = buffers.elements::<2>(&uvs)?.into_iter().map(up).collect();
        same_length(&attributes, "TEXCOORD_0", mesh.uvs.len(), count)?;
        mesh.triangle_uvs = mesh.triangles.clone();
    }
    mesh.positions = positions.into_iter().map(|p| world.transform_point3(p)).collect();
    let far = |p: &DVec3| p.to_array().iter().any(|x| !fields::COORDINATE.contains(*x));
    if let Some(index) = mesh.positions.iter().position(far) {
        return Err(attributes.error(format!("point {index} is beyond 1e12")));
    }
    if world.determinant() < 0.0 {
        // A mirror turns triangles inside out.
        let lists = [&mut mesh.triangles, &mut mesh.triangle_normals, &mut mesh.triangle_uvs];
        lists.into_iter().flatten().for_each(|corners| corners.swap(1, 2));
    }
    Ok(Some(mesh))
}

/// Says what of a primitive is left out.
fn remarks(job: &mut Job<'_>, primitive: &Json<'_>, attributes: &Json<'_>) {
    for key in attributes.keys() {
        let why = match key {
            "POSITION" | "NORMAL" | "TEXCOORD_0" => continue,
            // They matter with textures of normals alone, which are remarked upon.
            "TANGENT" => continue,
            key if key.starts_with("COLOR_") => "materials colour surfaces",
            key if key.starts_with("TEXCOORD_") => "a mesh has one set of texture coordinates",
            key if key.starts_with("JOINTS_") || key.starts_with("WEIGHTS_") => {
                "bones move nothing"
            }
            _ => "it is no attribute of glTF 2.0",
        };
        job.note(attributes.at(), format!("`{key}` is left out: {why}"));
    }
    if let Some(targets) = primitive.get("targets") {
        job.note(targets.at(), "`targets` are left out: the shape is as it is before any of them");
    }
    for extension in primitive.get("extensions").iter().flat_map(Json::keys) {
        job.note(primitive.at(), format!("`{extension}` is left out: it is not read"));
    }
}

fn same_length(
    attributes: &Json<'_>,
    key: &str,
    has: usize,
    count: usize,
) -> Result<(), ImportError> {
    if has == count {
        return Ok(());
    }
    Err(attributes.error(format!("{count} of POSITION and {has} of {key} do not fit together")))
}

/// The corners of every triangle.
fn triangles(
    buffers: &Buffers<'_>,
    primitive: &Json<'_>,
    mode: u64,
    count: usize,
) -> Result<Vec<[u32; 3]>, ImportError> {
    let corners: Vec<u32> = match primitive.get("indices") {
        Some(indices) => {
            let accessor = indices.follow(&buffers.root, "accessors")?;
            let listed = buffers.elements::<1>(&accessor)?;
            let bad = listed.iter().position(|[i]| !(*i >= 0.0 && *i < count as f64));
            if let Some(at) = bad {
                let cause = format!("index {at} is {}; there are {count} points", listed[at][0]);
                return Err(accessor.error(cause));
            }
            listed.into_iter().map(|[i]| i as u32).collect()
        }
        None => (0..count as u32).collect(),
    };
    Ok(match mode {
        4 => corners.as_chunks::<3>().0.to_vec(),
        5 => {
            let turned = |(i, t): (usize, &[u32])| {
                if i % 2 == 0 { [t[0], t[1], t[2]] } else { [t[1], t[0], t[2]] }
            };
            corners.windows(3).enumerate().map(turned).collect()
        }
        6 => {
            let Some((first, rest)) = corners.split_first() else { return Ok(Vec::new()) };
            rest.windows(2).map(|pair| [*first, pair[0], pair[1]]).collect()
        }
        other => return Err(primitive.error(format!("there is no mode {other}"))),
    })
}

/// What turns normals: the cofactors, which a flat scale does not spoil.
fn normal_matrix(world: DMat4) -> DMat3 {
    let [x, y, z] = [world.x_axis, world.y_axis, world.z_axis].map(|axis| axis.truncate());
    let cofactors = DMat3::from_cols(y.cross(z), z.cross(x), x.cross(y));
    if DMat3::from_cols(x, y, z).determinant() < 0.0 { cofactors * -1.0 } else { cofactors }
}
