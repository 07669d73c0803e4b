//! The kinds of solids that can be added: their list, and how one comes into the scene.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use eframe::egui::containers::menu::MenuButton;
use eframe::egui::{Button, Context, Ui};

use super::app::App;
use super::command::Command;
use super::dialog::Purpose;
use super::files::{Done, For};
use super::inspector::Selection;
use super::lists::Subject;
use crate::document::placing::Stand;
use crate::document::things::{Thing, add_solid};
use crate::scene::Scene;
use crate::scene::csg::Operation;
use crate::scene::fields::SHAPES;
use crate::scene::mesh::{Mesh, MeshError, read_obj};

/// What the menu of all kinds is about.
pub(super) const ADD_SOLID: &str =
    "Adds a solid in the middle of the picture, of the selected material or the first one";

/// A kind of solid, in a menu.
#[derive(Clone, Copy, Debug)]
pub(super) struct Kind {
    /// Such as `Add sphere`.
    pub(super) name: &'static str,
    /// One sentence.
    pub(super) about: &'static str,
}

const fn kind(name: &'static str, about: &'static str) -> Kind {
    Kind { name, about }
}

/// All kinds, in the order of [`SHAPES`].
pub(super) const KINDS: [Kind; 18] = [
    kind("Add sphere", "A ball"),
    kind("Add plane", "A floor without end, and all that is below it"),
    kind("Add box", "A box along the axes; rotate_degrees turns it"),
    kind("Add cylinder", "A round rod with flat ends"),
    kind("Add cone", "A cone, whose tip may be cut off"),
    kind("Add torus", "A ring"),
    kind("Add ellipsoid", "A ball with a radius of its own along each axis"),
    kind("Add quadric", "A surface of the second degree, cut off by a box"),
    kind("Add prism", "An outline, swept upwards"),
    kind("Add polygon", "A flat sheet without thickness, which faces the camera"),
    kind("Add mesh", "Triangles from an OBJ file; you are asked for it"),
    kind("Add knot", "A knotted tube"),
    kind("Add sphereflake", "A ball that carries smaller balls, which carry smaller ones"),
    kind("Add union", "A group that begins with the selected solid: every surface stays"),
    kind("Add merge", "One solid that begins with the selected one: only its outside is a surface"),
    kind(
        "Add intersection",
        "What the selected solid and others, still to be named, have in common",
    ),
    kind("Add difference", "The selected solid, out of which others, still to be named, are cut"),
    kind("Add complement", "All that the selected solid is not"),
];

/// Why a solid of this kind cannot be added now, if it cannot.
pub(super) fn addition_refusal(
    subject: Subject,
    kind: usize,
    scene: &Scene,
) -> Option<&'static str> {
    let is_whole = SHAPES.get(kind).is_some_and(|key| Operation::named(key).is_some());
    let refused = is_whole && operand(subject, scene).is_none();
    refused.then_some("Select a solid first: the new one is made of it")
}

/// What a solid begins with that is made of others: the selected solid, or the one picked last.
fn operand(subject: Subject, scene: &Scene) -> Option<usize> {
    match subject.selection.within(scene) {
        Selection::Solid(solid) => Some(solid),
        _ => subject.picked.filter(|solid| *solid < scene.solids.len()),
    }
}

/// The button below the list of solids, which opens the list of kinds.
pub(super) fn add_solid_ui(
    ui: &mut Ui,
    subject: Subject,
    scene: &Scene,
    chosen: &mut Option<Command>,
) {
    let button = MenuButton::from_button(Button::new("+ Add solid").small());
    let (response, _) = button.ui(ui, |ui| shapes_ui(ui, subject, scene, chosen));
    response.on_hover_text(ADD_SOLID);
}

/// The kinds as items of a menu.
pub(super) fn shapes_ui(
    ui: &mut Ui,
    subject: Subject,
    scene: &Scene,
    chosen: &mut Option<Command>,
) {
    for (i, key) in SHAPES.iter().enumerate() {
        if Operation::named(key) == Some(Operation::ALL[0]) {
            ui.separator();
        }
        let command = Command::AddSolid(i);
        let refusal = addition_refusal(subject, i, scene);
        let response = ui.add_enabled(refusal.is_none(), Button::new(command.name()));
        let response = response.on_disabled_hover_text(refusal.unwrap_or_default());
        if response.on_hover_text(command.about()).clicked() {
            *chosen = Some(command);
            ui.close();
        }
    }
}

impl App {
    /// Adds a solid of the kind with this index as one step, or asks for the file that it needs.
    pub(super) fn add_solid(&mut self, ctx: &Context, kind: usize) {
        match SHAPES.get(kind) {
            Some(&"mesh") => {
                self.document.end_gesture();
                self.ask(ctx, Purpose::Mesh, String::new(), For::Mesh);
            }
            Some(key) => self.put_solid(key, None),
            None => {}
        }
    }

    /// Reads the mesh of a new solid in a thread.
    pub(super) fn read_mesh(&mut self, ctx: &Context, path: PathBuf) {
        self.files.work(ctx, move || {
            let result = read_obj(&path);
            Done::Mesh { path, result }
        });
    }

    /// Adds a solid with a mesh that was read.
    pub(super) fn mesh_read(&mut self, path: &Path, result: Result<Mesh, MeshError>) {
        match result {
            Ok(mesh) => {
                let file = self.document.name_of(path);
                self.put_solid("mesh", Some((file, Arc::new(mesh))));
            }
            Err(error) => {
                self.notices.error(format!("{}\n  help: {}", error.what(), error.way_out))
            }
        }
    }

    /// Adds a solid where it is seen, and selects it; a mesh with its file's name.
    fn put_solid(&mut self, key: &str, mesh: Option<(String, Arc<Mesh>)>) {
        let mut scene = self.document.scene().clone();
        let subject = self.subject();
        let operand = operand(subject, &scene);
        if let Some(operand) = operand.filter(|_| Operation::named(key).is_some())
            && let Some(refusal) = scene.operand_refusal(scene.solids.len(), operand)
        {
            return self.notices.error(refusal);
        }
        let material = match subject.selection.within(&scene) {
            Selection::Material(material) => material,
            Selection::Solid(solid) => scene.solids[solid].material,
            Selection::Scene | Selection::Light(_) => 0,
        };
        let size = scene.picture.size;
        let seen = |at: [f64; 2]| self.live.pick(at).map(|picked| picked.depth);
        let stand = Stand::new(&scene.camera, size, &seen);
        let solid = add_solid(&mut scene, key, stand, material, operand.unwrap_or(0));
        if let (Thing::Solid(solid), Some((file, mesh))) = (solid, mesh) {
            stand.fit(&mut scene.solids[solid], file, mesh);
        }
        let step = format!("add {} {}", solid.kind(), solid.name(&scene));
        self.document.end_gesture();
        self.commit(scene);
        // A material that comes with it is no news.
        self.document.name_step(step);
        self.document.end_gesture();
        if solid.is_in(self.document.scene()) {
            self.select(Some(solid.into()));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Material, Shape, Solid};

    #[test]
    fn every_shape_of_a_scene_file_can_be_added() {
        assert_eq!(KINDS.len(), SHAPES.len());
        for (kind, key) in KINDS.iter().zip(SHAPES) {
            assert_eq!(kind.name, format!("Add {key}"));
            assert!(kind.about.len() > 5, "{key}");
        }
    }

    #[test]
    fn what_is_made_of_others_begins_with_one() {
        let solids = vec![Solid::new("ball", Shape::named("sphere"), 0)];
        let scene = Scene { materials: vec![Material::new("m")], solids, ..Scene::default() };
        let refused = |selection, picked| -> Vec<&str> {
            let refused =
                |i: &usize| addition_refusal(Subject { selection, picked }, *i, &scene).is_some();
            (0..SHAPES.len()).filter(refused).map(|i| SHAPES[i]).collect()
        };
        let wholes = Operation::ALL.map(Operation::key);
        assert_eq!(refused(Selection::Scene, None), wholes);
        assert_eq!(refused(Selection::Light(0), Some(1)), wholes);
        assert_eq!(refused(Selection::Scene, Some(0)), [""; 0]);
        assert_eq!(refused(Selection::Solid(0), None), [""; 0]);
    }
}
