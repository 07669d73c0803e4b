//! What is done with whole lights, materials and solids: added, copied, renamed, deleted, assigned.

use eframe::egui::{Button, Response, Ui};

use super::app::App;
use super::carry;
use super::command::Command;
use super::inspector::Selection;
use super::rename::{Left, Renaming};
use crate::document::things::{Thing, add_light, add_material, duplicate, remove, rename};
use crate::forest::camera::View;
use crate::scene::Scene;
use crate::scene::path::join;

/// What a command about a light, a material or a solid would do now.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Offer {
    /// Such as `Delete light key`.
    pub(super) name: String,
    /// Why it cannot be done, if it cannot.
    pub(super) refusal: Option<&'static str>,
}

/// What commands about lights, materials and solids are about.
#[derive(Clone, Copy, Debug)]
pub(super) struct Subject {
    /// What is selected.
    pub(super) selection: Selection,
    /// Index of the solid that was clicked or selected last.
    pub(super) picked: Option<usize>,
}

impl Subject {
    /// What one of the commands [`Command::ON_THINGS`] would do.
    pub(super) fn offer(self, command: Command, scene: &Scene) -> Offer {
        let verb = command.name();
        if command == Command::Assign {
            return self.assignment(scene);
        }
        let selection = self.selection.within(scene);
        if command.needs_material() {
            return match selection {
                Selection::Material(i) => {
                    let name = format!("{verb} {}", scene.materials[i].name);
                    Offer { name, refusal: None }
                }
                _ => Offer { name: verb.into(), refusal: Some("Select a material first") },
            };
        }
        match selection.thing() {
            Some(thing) => {
                let name = format!("{verb} {} {}", thing.kind(), thing.name(scene));
                Offer { name, refusal: None }
            }
            None => {
                let refusal = Some("Select a light, a material or a solid first");
                Offer { name: verb.into(), refusal }
            }
        }
    }

    fn assignment(self, scene: &Scene) -> Offer {
        let solid = self.picked.and_then(|i| scene.solids.get(i));
        let verb = Command::Assign.name();
        if solid.is_some_and(|solid| solid.shape.is_composite()) {
            let refusal = Some("A solid that is made of others has their materials");
            return Offer { name: verb.into(), refusal };
        }
        match (self.selection.within(scene), solid) {
            (Selection::Material(i), Some(solid)) => Offer {
                name: format!("Assign {} to {}", scene.materials[i].name, solid.name),
                refusal: (solid.material == i).then_some("The solid is made of it already"),
            },
            (Selection::Material(_), None) => {
                Offer { name: verb.into(), refusal: Some("Click a solid in the picture first") }
            }
            _ => Offer { name: verb.into(), refusal: Some("Select a material first") },
        }
    }

    /// The path of what [`Command::Assign`] would set.
    pub(super) fn assigned_path(self, scene: &Scene) -> Option<String> {
        let solid = &scene.solids[self.picked.filter(|i| *i < scene.solids.len())?];
        let Selection::Material(_) = self.selection.within(scene) else { return None };
        Some(join(&join("solids", &solid.name), "material"))
    }
}

/// Shows the button of a command, and why it cannot be pressed.
pub(super) fn offer_ui(
    ui: &mut Ui,
    command: Command,
    button: Button<'_>,
    offer: &Offer,
) -> Response {
    let response = ui.add_enabled(offer.refusal.is_none(), button);
    let about = offer.refusal.unwrap_or(command.about());
    response.on_hover_text(command.about()).on_disabled_hover_text(about)
}

impl App {
    /// What commands about lights, materials and solids are about.
    pub(super) fn subject(&self) -> Subject {
        Subject { selection: self.selection, picked: self.picked }
    }

    /// Does what a command about lights, materials and solids says, as one step.
    pub(super) fn run_on_things(&mut self, command: Command) {
        let mut scene = self.document.scene().clone();
        let selection = self.selection.within(&scene);
        let select = match (command, selection.thing()) {
            (Command::AddLight, _) => {
                let view = View::new(&scene.camera, scene.picture.size);
                let place = carry::fresh(&view, &scene.camera, scene.picture.size);
                add_light(&mut scene, place).into()
            }
            (Command::AddMaterial, _) => add_material(&mut scene).into(),
            (Command::Duplicate, Some(thing)) => duplicate(&mut scene, thing).into(),
            (Command::Delete, Some(thing)) => match remove(&mut scene, thing) {
                Ok(()) => neighbour(selection, &scene),
                Err(refusal) => return self.notices.error(refusal),
            },
            (Command::Rename, Some(thing)) => {
                self.renaming = Some(Renaming::new(&scene, thing));
                return;
            }
            (Command::Assign, Some(Thing::Material(material))) => {
                let Some(solid) = self.picked.and_then(|i| scene.solids.get_mut(i)) else { return };
                solid.material = material;
                selection
            }
            _ => return,
        };
        self.step(scene);
        self.select(Some(select.within(self.document.scene())));
    }

    /// Takes an edit as a step of its own.
    pub(super) fn step(&mut self, scene: Scene) {
        self.document.end_gesture();
        self.commit(scene);
        self.document.end_gesture();
    }

    /// Takes the name over that was typed; whether it changed anything.
    pub(super) fn renamed(&mut self, left: Left, edited: &mut Scene) -> bool {
        self.renaming = None;
        let Left::With(thing, name) = left else { return false };
        if let Err(refusal) = rename(edited, thing, &name) {
            self.notices.error(refusal);
        }
        true
    }
}

/// What is selected when the selected thing is gone.
fn neighbour(selection: Selection, scene: &Scene) -> Selection {
    let before = |i: usize, count: usize| count.checked_sub(1).map(|last| i.min(last));
    let next = match selection {
        Selection::Light(i) => before(i, scene.lights.len()).map(Selection::Light),
        Selection::Material(i) => before(i, scene.materials.len()).map(Selection::Material),
        Selection::Solid(i) => before(i, scene.solids.len()).map(Selection::Solid),
        other => Some(other),
    };
    next.unwrap_or(Selection::Scene)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Light, Material, Shape, Solid};

    fn scene() -> Scene {
        let materials = vec![Material::new("red"), Material::new("blue")];
        let solids = vec![Solid::new("ball", Shape::named("sphere"), 0)];
        Scene { lights: vec![Light::new("key")], materials, solids, ..Scene::default() }
    }

    #[test]
    fn an_offer_says_what_it_is_about_and_why_it_cannot_be() {
        let scene = scene();
        let offer =
            |selection, picked, command| Subject { selection, picked }.offer(command, &scene);
        let delete = offer(Selection::Light(0), None, Command::Delete);
        assert_eq!(delete, Offer { name: "Delete light key".into(), refusal: None });
        assert!(offer(Selection::Light(7), None, Command::Delete).refusal.is_some());
        let duplicate = offer(Selection::Solid(0), None, Command::Duplicate);
        assert_eq!(duplicate, Offer { name: "Duplicate solid ball".into(), refusal: None });
        assert!(offer(Selection::Scene, None, Command::Duplicate).refusal.is_some());
        let assign = offer(Selection::Material(1), Some(0), Command::Assign);
        assert_eq!(assign, Offer { name: "Assign blue to ball".into(), refusal: None });
        assert!(offer(Selection::Material(0), Some(0), Command::Assign).refusal.is_some());
        assert!(offer(Selection::Material(1), Some(4), Command::Assign).refusal.is_some());
        assert!(offer(Selection::Light(0), Some(0), Command::Assign).refusal.is_some());
    }

    #[test]
    fn the_neighbour_of_what_is_gone_is_selected() {
        let mut scene = scene();
        assert_eq!(neighbour(Selection::Material(2), &scene), Selection::Material(1));
        assert_eq!(neighbour(Selection::Material(0), &scene), Selection::Material(0));
        assert_eq!(neighbour(Selection::Solid(1), &scene), Selection::Solid(0));
        scene.lights.clear();
        assert_eq!(neighbour(Selection::Light(0), &scene), Selection::Scene);
    }
}
