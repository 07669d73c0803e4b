//! glTF 2.0 and GLB: meshes, nodes, cameras, punctual lights, materials with their base colours.

mod buffers;
mod json;
mod light;
mod material;
mod primitive;

use std::collections::HashSet;

use glam::{DMat4, DQuat, DVec3};
use serde_json::Value;

use super::job::{Job, Names};
use super::place::{At, ImportError};
use crate::scene::{Lens, Scene, Solid};
use buffers::Buffers;
use json::Json;

/// First bytes of a GLB file.
const MAGIC: &[u8] = b"glTF";
/// Length of a GLB file's header, and of a chunk's.
const HEADER: usize = 12;
const CHUNK_HEADER: usize = 8;

/// Extensions that a file may require.
const KNOWN: [&str; 8] = [
    "KHR_lights_punctual",
    "KHR_materials_transmission",
    "KHR_materials_ior",
    "KHR_materials_emissive_strength",
    "KHR_materials_unlit",
    "KHR_materials_volume",
    "KHR_mesh_quantization",
    "KHR_texture_transform",
];

/// Reads a glTF or GLB file; `y` is up.
pub(super) fn read(job: &mut Job<'_>, bytes: &[u8]) -> Result<Scene, ImportError> {
    let (text, binary) = if bytes.starts_with(MAGIC) { chunks(job, bytes)? } else { (bytes, None) };
    let document: Value = serde_json::from_slice(text).map_err(|error| {
        let at = At::Column(error.line(), error.column());
        let way_out = "the file was cut off or is no glTF: export it again";
        job.error(at, format!("this is not JSON: {error}"), way_out)
    })?;
    let root = Json::root(&document, job.source);
    version(job, &root)?;
    let buffers = Buffers::read(job, &root, binary)?;
    let materials = material::materials(job, &buffers)?;
    let scene = Scene { materials, ..Scene::default() };
    let mut walk =
        Walk { job, buffers, scene, names: Names::default(), camera: None, met: HashSet::new() };
    walk.scene_nodes(&root)?;
    let Walk { job, scene, camera, .. } = walk;
    remarks(job, &root)?;
    unplaced(job, root.get("cameras"), usize::from(camera.is_some()))?;
    let lights = root.extension("KHR_lights_punctual").and_then(|all| all.get("lights"));
    unplaced(job, lights, scene.lights.len())?;
    Ok(without_unused(scene))
}

/// The JSON and the binary part of a GLB file.
fn chunks<'b>(job: &Job<'_>, bytes: &'b [u8]) -> Result<(&'b [u8], Option<&'b [u8]>), ImportError> {
    let broken = |at: usize, cause: String| {
        job.error(At::Byte(at), cause, "the file was cut off: export it again")
    };
    let number = |at: usize| -> Result<usize, ImportError> {
        let four = bytes.get(at..at + 4).and_then(|four| four.try_into().ok());
        let four = four.ok_or_else(|| broken(at, "the file ends within a header".to_owned()))?;
        Ok(u32::from_le_bytes(four) as usize)
    };
    let (version, length) = (number(4)?, number(8)?);
    if version != 2 {
        return Err(broken(4, format!("version {version} of GLB is not read, 2 is")));
    }
    if length > bytes.len() {
        let has = bytes.len();
        return Err(broken(8, format!("{length} bytes are promised, the file has {has}")));
    }
    let (mut at, mut text, mut binary) = (HEADER, None, None);
    while at + CHUNK_HEADER <= length {
        let (size, kind) = (number(at)?, number(at + 4)?);
        let start = at + CHUNK_HEADER;
        let end = start.checked_add(size).filter(|end| *end <= length);
        let end = end.ok_or_else(|| {
            broken(at, format!("a chunk of {size} bytes is promised, {} are left", length - start))
        })?;
        match kind.to_le_bytes() {
            [b'J', b'S', b'O', b'N', ..] if text.is_none() => text = Some(&bytes[start..end]),
            [b'B', b'I', b'N', 0, ..] if binary.is_none() => binary = Some(&bytes[start..end]),
            _ => {}
        }
        at = end;
    }
    let text = text.ok_or_else(|| broken(HEADER, "there is no JSON chunk".to_owned()))?;
    Ok((text, binary))
}

fn version(job: &Job<'_>, root: &Json<'_>) -> Result<(), ImportError> {
    let version = root.need("asset")?.need("version")?;
    if !version.text()?.starts_with("2.") {
        let cause = format!("version {} of glTF is not read, 2.0 is", version.text()?);
        return Err(job.error(version.at(), cause, "export it as glTF 2.0"));
    }
    for required in root.list("extensionsRequired")? {
        let name = required.text()?;
        if !KNOWN.contains(&name) {
            let cause = format!("the file requires `{name}`, which is not read");
            return Err(job.error(required.at(), cause, "export it without this extension"));
        }
    }
    Ok(())
}

/// Says what of the document has no place in a scene.
fn remarks(job: &mut Job<'_>, root: &Json<'_>) -> Result<(), ImportError> {
    for (key, why) in [
        ("animations", "the scene is as it is before any animation"),
        ("skins", "meshes are as they are before their bones move them"),
    ] {
        if let Some(list) = root.get(key) {
            let count = list.items()?.len();
            job.note(list.at(), format!("{count} of `{key}` are left out: {why}"));
        }
    }
    for extension in root.list("extensionsUsed")? {
        let name = extension.text()?;
        let of_material = name.starts_with("KHR_materials_");
        if !KNOWN.contains(&name) && !of_material {
            job.note(extension.at(), format!("`{name}` is left out: it is not read"));
        }
    }
    Ok(())
}

/// Says that cameras or lights stand in no node that is shown, and so nowhere.
fn unplaced(job: &mut Job<'_>, list: Option<Json<'_>>, used: usize) -> Result<(), ImportError> {
    if let Some(list) = list
        && used == 0
        && !list.items()?.is_empty()
    {
        job.note(list.at(), "they are left out: no node says where they are");
    }
    Ok(())
}

/// The scene without materials that no solid has.
fn without_unused(mut scene: Scene) -> Scene {
    let mut index = vec![None; scene.materials.len()];
    let mut kept = Vec::new();
    for solid in &mut scene.solids {
        let next = kept.len();
        let place = *index[solid.material].get_or_insert(next);
        if place == next {
            kept.push(scene.materials[solid.material].clone());
        }
        solid.material = place;
    }
    scene.materials = kept;
    scene
}

/// The nodes of a scene, on the way to solids, lights and a camera.
struct Walk<'j, 'a, 'b> {
    job: &'j mut Job<'a>,
    buffers: Buffers<'b>,
    scene: Scene,
    names: Names,
    /// The key of the camera that was taken.
    camera: Option<String>,
    /// Nodes that were met: each has one parent at most.
    met: HashSet<u64>,
}

impl<'b> Walk<'_, '_, 'b> {
    /// Visits the scene that the file shows, or else its first one.
    fn scene_nodes(&mut self, root: &Json<'b>) -> Result<(), ImportError> {
        let scenes = root.list("scenes")?;
        let shown = match root.get("scene") {
            Some(index) => Some(index.follow(root, "scenes")?),
            None => scenes.first().cloned(),
        };
        if scenes.len() > 1 {
            let text = format!("{} other scenes are left out: one is shown", scenes.len() - 1);
            self.job.note(At::Key("scenes".to_owned()), text);
        }
        let Some(shown) = shown else {
            return Err(root.error("there is no scene"));
        };
        // Not by recursion: a long chain of nodes is no reason to fail.
        let mut open: Vec<(Json<'b>, DMat4)> = Vec::new();
        for node in shown.list("nodes")?.into_iter().rev() {
            open.push((node, DMat4::IDENTITY));
        }
        while let Some((index, parent)) = open.pop() {
            let node = index.follow(root, "nodes")?;
            let number = index.whole()?;
            if !self.met.insert(number) {
                return Err(index.error(format!("node {number} has two parents, or is its own")));
            }
            let world = parent * transform(&node)?;
            if !world.is_finite() {
                return Err(node.error("its place is beyond all numbers"));
            }
            self.node(root, &node, world)?;
            for child in node.list("children")?.into_iter().rev() {
                open.push((child, world));
            }
        }
        Ok(())
    }

    fn node(&mut self, root: &Json<'b>, node: &Json<'b>, world: DMat4) -> Result<(), ImportError> {
        if let Some(mesh) = node.get("mesh") {
            let mesh = mesh.follow(root, "meshes")?;
            self.mesh(node, &mesh, world)?;
        }
        if let Some(camera) = node.get("camera") {
            let camera = camera.follow(root, "cameras")?;
            self.camera(node, &camera, world)?;
        }
        if let Some(light) = node.extension("KHR_lights_punctual") {
            let index = light.need("light")?;
            let lights = root.extension("KHR_lights_punctual");
            let lights = lights.ok_or_else(|| index.error("the file has no lights"))?;
            let light = index.follow(&lights, "lights")?;
            let light = light::light(self.job, &light, world, self.scene.lights.len())?;
            self.scene.lights.push(light);
        }
        for extension in node.get("extensions").iter().flat_map(Json::keys) {
            if extension != "KHR_lights_punctual" {
                let text = format!("`{extension}` is left out: nodes have no place for it");
                self.job.note(node.at(), text);
            }
        }
        Ok(())
    }

    fn mesh(&mut self, node: &Json<'b>, mesh: &Json<'b>, world: DMat4) -> Result<(), ImportError> {
        let named = if node.name().is_empty() { mesh.name() } else { node.name() };
        for primitive in mesh.need("primitives")?.items()? {
            let read = primitive::read(self.job, &self.buffers, &primitive, world)?;
            let Some(triangles) = read else { continue };
            let material = match primitive.get("material") {
                Some(material) => {
                    material.follow(&self.buffers.root, "materials")?;
                    material.whole()? as usize
                }
                None => self.scene.materials.len() - 1,
            };
            let name = self.names.take(named, "mesh");
            let shape = self.job.mesh_of(&name, &triangles)?;
            self.scene.solids.push(Solid::new(name, shape, material));
        }
        Ok(())
    }

    /// The first camera is taken: it looks along its node's -z, and y is up.
    fn camera(
        &mut self,
        node: &Json<'b>,
        camera: &Json<'b>,
        world: DMat4,
    ) -> Result<(), ImportError> {
        if let Some(taken) = &self.camera {
            let text = format!("a further camera is left out: that of {taken} is taken");
            self.job.note(node.at(), text);
            return Ok(());
        }
        let (mut lens, mut aspect) = (Lens::Perspective { fov_degrees: 45.0 }, None);
        if let Some(view) = camera.get("perspective") {
            let fov_degrees = view.need("yfov")?.number()?.to_degrees().clamp(1e-3, 179.9);
            lens = Lens::Perspective { fov_degrees };
            aspect = view.get("aspectRatio").map(|ratio| ratio.number()).transpose()?;
        } else if let Some(view) = camera.get("orthographic") {
            let (x, y) = (view.need("xmag")?.number()?, view.need("ymag")?.number()?);
            lens = Lens::Parallel { height: (2.0 * y.abs()).clamp(1e-9, 1e12) };
            aspect = Some((x / y).abs());
        }
        let own = &mut self.scene.camera;
        own.eye = world.transform_point3(DVec3::ZERO);
        own.target = own.eye + world.transform_vector3(DVec3::NEG_Z).normalize_or(DVec3::NEG_Z);
        own.up = world.transform_vector3(DVec3::Y).normalize_or(DVec3::Y);
        own.lens = lens;
        if let Some(aspect) = aspect.filter(|aspect| (0.05..=20.0).contains(aspect)) {
            let height = self.scene.picture.size[1];
            self.scene.picture.size[0] = (f64::from(height) * aspect).round() as u32;
        }
        self.camera = Some(node.key().to_owned());
        Ok(())
    }
}

/// parent_from_node.
fn transform(node: &Json<'_>) -> Result<DMat4, ImportError> {
    if let Some(matrix) = node.numbers::<16>("matrix")? {
        let matrix = DMat4::from_cols_array(&matrix);
        if matrix.row(3).to_array() != [0.0, 0.0, 0.0, 1.0] {
            return Err(node.error("the last row of `matrix` is not 0, 0, 0, 1"));
        }
        return Ok(matrix);
    }
    let translation = node.numbers("translation")?.unwrap_or([0.0; 3]);
    let [x, y, z, w] = node.numbers("rotation")?.unwrap_or([0.0, 0.0, 0.0, 1.0]);
    let scale = node.numbers("scale")?.unwrap_or([1.0; 3]);
    let rotation = DQuat::from_xyzw(x, y, z, w);
    let length = rotation.length();
    if length < 1e-15 || !length.is_finite() {
        return Err(node.error("`rotation` is zero or endless, which is no rotation"));
    }
    let rotation = rotation / length;
    Ok(DMat4::from_scale_rotation_translation(scale.into(), rotation, translation.into()))
}
