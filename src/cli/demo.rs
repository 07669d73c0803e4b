//! The program without a command and without a display: renders a scene, re-shades it by some edits, prints both times.

use std::path::{Path, PathBuf};

use super::render::edit_line;
use super::watch::watched;
use super::{Failure, print, read_scene, say};
use crate::document::BUILT_IN;
use crate::film::develop::Development;
use crate::film::plates::Plates;
use crate::film::write::{Format, check_writable, picture};
use crate::scene::path::set;
use crate::scene::{Scene, read, write};
use crate::session::{Options, Session};

/// Where the first picture goes: into the present folder.
const PICTURE: &str = "rayforest.png";

/// Renders a scene file, or the built-in scene; `why` there is no window.
pub(crate) fn run(file: Option<&Path>, why: &str) -> Result<(), Failure> {
    let scene = match file {
        Some(file) => read_scene(file)?,
        None => read::text(BUILT_IN.1, Path::new("whitted.toml")).map_err(Failure::input)?,
    };
    check_writable(Path::new(PICTURE)).map_err(Failure::job)?;
    say(&format!("{why}: rendering to {PICTURE} instead"));
    let opened = watched("tracing", |p| Session::open(scene, Options::default(), p));
    let mut session = opened.map_err(Failure::job)?;
    let report = session.trace_report();
    let [width, height] = session.scene().picture.size;
    print(&format!(
        "traced {width}×{height}, {} samples per pixel, {:.1} million rays: {:.0} ms",
        session.scene().trace.samples,
        report.rays.total() as f64 / 1e6,
        report.seconds * 1e3
    ));
    save(&session, PICTURE.into())?;
    let traced = report.seconds;
    for (number, (assignment, edited)) in edits(session.scene()).into_iter().enumerate() {
        let edit = watched("tracing", |progress| session.edit(edited, progress));
        let report = edit.map_err(Failure::job)?;
        let gain = traced * 1e3 / report.milliseconds;
        print(&format!("{}, {gain:.0} times faster", edit_line(&assignment, &report)));
        save(&session, format!("rayforest-edit-{}.png", number + 1).into())?;
    }
    Ok(())
}

fn save(session: &Session, file: PathBuf) -> Result<(), Failure> {
    let scene = session.scene();
    let text = write::text(scene);
    let development = Development::of(&scene.picture);
    picture(&file, Format::Png8, &Plates::of(session.film()), development, &text)
        .map_err(Failure::job)?;
    print(&format!("wrote {}", file.display()));
    Ok(())
}

/// Edits that show what stays live: a light, a surface, a highlight. Each builds on the one before.
fn edits(scene: &Scene) -> Vec<(String, Scene)> {
    let mut wishes = Vec::new();
    if let Some(light) = scene.lights.first() {
        wishes.push((format!("lights.{}.color", light.name), "[1.0, 0.75, 0.5]"));
    }
    if let Some(material) = scene.materials.first() {
        wishes.push((format!("materials.{}.diffuse", material.name), "0.35"));
    }
    if let Some(material) = scene.materials.iter().find(|m| !m.specular.is_black()) {
        wishes.push((format!("materials.{}.shininess", material.name), "12"));
    }
    if let Some(material) = scene.materials.iter().rev().find(|m| !m.reflect.is_black()) {
        wishes.push((format!("materials.{}.reflect", material.name), "[0.2, 0.3, 0.5]"));
    }
    let mut scene = scene.clone();
    let mut edits = Vec::new();
    for (path, value) in wishes {
        // A path that a strange name makes unreadable is left out, not an error.
        if set(&mut scene, &path, value).is_ok() {
            edits.push((format!("{path} = {value}"), scene.clone()));
        }
    }
    edits
}
