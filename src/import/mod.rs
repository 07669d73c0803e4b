//! Files of other programs made into scenes: Wavefront OBJ with MTL, glTF 2.0 and GLB, NFF.
//!
//! A reader gives an ordinary [`Scene`], files that belong beside it, and remarks on everything that
//! has no place in it. Nothing in a file is trusted: every length and index is checked before use, and
//! every fault has its place. Coordinates stay as they are.

mod frame;
mod gltf;
mod job;
mod mesh_text;
mod mtl;
mod mtl_material;
mod nff;
mod obj;
mod place;
mod polygon;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod tests_broken;
mod words;

use std::io;
use std::path::{Path, PathBuf};

use glam::DVec3;

use crate::film::write::{WriteError, durably};
use crate::scene::energy::overbright;
use crate::scene::{Scene, check, read, write};
pub use job::Part;
use job::{Fetch, Job};
pub use place::{At, ImportError, Note, Place};

/// Endings of the files that are read, without the dot.
pub const ENDINGS: [&str; 4] = ["obj", "gltf", "glb", "nff"];

/// What becomes of what, for people.
pub const MAPPING: &str = "\
OBJ   o (or else g) and usemtl make solids (meshes), mtllib materials; s, l, p, curves are left out
MTL   Kd = color·diffuse, Ka = color·ambient, Ks = specular (model blinn), Ns = shininess,
      Ke = emission, Ni = ior, d = kloc and 1 - transmit, Tr = 1 - d, Tf = filter, Pm = metallic,
      map_Kd = texture.image, bump = bump.image;
      illum 3 … 7 reflect by Ks, 5 and 7 with fresnel, 6 and 7 refract
glTF  meshes of the shown scene with their nodes' places, first camera, KHR_lights_punctual
      (candela and lux / π); base colour and texture = color or texture.image, metallic and roughness =
      model cook_torrance, metallic, roughness, reflect and gloss of smooth ones; transmission =
      transmit with filter, ior and fresnel; emissive factor and strength = emission;
      alphaMode BLEND = kloc and transmit without refraction
NFF   v = camera, b = background, l = lights.point, f = materials (T = transmit, Ks = specular and
      reflect), s = spheres, c = cones and cylinders, p and pp = meshes
A camera and a light are added where there are none.";

/// A scene made of another program's file; nothing is written yet.
#[derive(Clone, Debug)]
pub struct Imported {
    /// Ordinary, valid, and the same bit for bit once it is written and read again.
    pub scene: Scene,
    /// Files that it needs and that are not there yet.
    pub parts: Vec<Part>,
    /// What was left out, guessed or added.
    pub notes: Vec<Note>,
}

/// Reads another program's file, told by its ending, into a scene that will stand at `target`.
pub fn file(source: &Path, target: &Path) -> Result<Imported, ImportError> {
    from(source, target, &|path| std::fs::read(path))
}

/// [`file()`] with files from elsewhere.
fn from(source: &Path, target: &Path, fetch: Fetch<'_>) -> Result<Imported, ImportError> {
    let mut job = Job::new(source, target, fetch);
    let ending = source.extension().unwrap_or_default().to_string_lossy().to_lowercase();
    if !ENDINGS.contains(&ending.as_str()) {
        let cause = format!("files that end in `.{ending}` are not read");
        return Err(job.error(At::File, cause, "OBJ, glTF, GLB and NFF files are"));
    }
    let bytes = job.read(source).map_err(|error: io::Error| {
        let way_out = "check the name of the file and its permissions";
        job.error(At::File, format!("cannot be read: {error}"), way_out)
    })?;
    let (mut scene, up) = match ending.as_str() {
        "obj" => (obj::read(&mut job, &bytes)?, DVec3::Y),
        "nff" => (nff::read(&mut job, &bytes)?, DVec3::Z),
        _ => (gltf::read(&mut job, &bytes)?, DVec3::Y),
    };
    if scene.solids.is_empty() {
        return Err(job.error(At::File, "there is nothing to be seen in it", "export solids too"));
    }
    frame::complete(&mut job, &mut scene, up);
    if let Some(flaw) = check::validate(&scene).first() {
        let cause =
            format!("the scene would be wrong at {}: {}", flaw.path.join("."), flaw.message);
        return Err(job.error(At::File, cause, &flaw.help));
    }
    for bright in overbright(&scene) {
        job.note(At::File, bright.sentence(&scene));
    }
    let Job { notes, parts, .. } = job;
    Ok(Imported { scene, parts, notes })
}

impl Imported {
    /// Writes the scene to `target`, and its parts beside it; reads it back and compares.
    pub fn write(&self, target: &Path) -> Result<(), WriteError> {
        let Imported { scene, parts, notes: _ } = self;
        let folder = target.parent().unwrap_or(Path::new(""));
        let fail = |path: PathBuf, cause: String| WriteError { path, cause };
        for Part { name, bytes } in parts {
            let path = folder.join(name);
            let within = path.parent().unwrap_or(Path::new(""));
            std::fs::create_dir_all(within).map_err(|e| fail(within.to_owned(), e.to_string()))?;
            durably(&path, None, bytes)?;
        }
        durably(target, None, write::text(scene).as_bytes())?;
        match read::file(target) {
            Ok(back) if back == *scene => Ok(()),
            Ok(_) => Err(fail(target.to_owned(), "it reads back as another scene".to_owned())),
            Err(error) => Err(fail(target.to_owned(), format!("it cannot be read back: {error}"))),
        }
    }
}
