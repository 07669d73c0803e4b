//! The parameters of what is selected, each with a control, its cost, and a mark if it was changed.

use std::collections::{BTreeMap, HashMap};

use eframe::egui::{Button, RichText, ScrollArea, TextWrapMode, Ui};

use super::badge::badge_ui;
use super::command::Command;
use super::control::{BADGE, Row, control_ui};
use super::kind::kind_ui;
use super::lists::{Subject, offer_ui};
use super::number::Edit;
use super::operands::operands_ui;
use super::paints::{ImageFor, kinds_ui};
use super::presets::Presets;
use super::values::{Defaults, same_name, texts, visit};
use crate::document::presets::give;
use crate::document::things::{Thing, users, wholes};
use crate::scene::Scene;
use crate::scene::fields::{self, Need, Visit};
use crate::scene::path::join;
use crate::scene::slot::Slot;
use crate::scene::value::Names;
use crate::session::cost::Cost;

/// What the inspector shows. Indices are valid for the scene beside which it is kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Selection {
    /// Camera, picture, trace, ambient light and background.
    Scene,
    /// The light with this index.
    Light(usize),
    /// The material with this index.
    Material(usize),
    /// The solid with this index.
    Solid(usize),
}

impl From<Thing> for Selection {
    fn from(thing: Thing) -> Selection {
        match thing {
            Thing::Light(i) => Selection::Light(i),
            Thing::Material(i) => Selection::Material(i),
            Thing::Solid(i) => Selection::Solid(i),
        }
    }
}

impl Selection {
    /// The light, material or solid that is selected.
    pub(super) fn thing(self) -> Option<Thing> {
        match self {
            Selection::Light(i) => Some(Thing::Light(i)),
            Selection::Material(i) => Some(Thing::Material(i)),
            Selection::Solid(i) => Some(Thing::Solid(i)),
            Selection::Scene => None,
        }
    }

    /// The same selection, or the whole scene if there is no such thing in it.
    pub(super) fn within(self, scene: &Scene) -> Selection {
        if self.thing().is_none_or(|thing| thing.is_in(scene)) { self } else { Selection::Scene }
    }

    /// What is selected, with its name.
    fn title(self, scene: &Scene) -> String {
        match self {
            Selection::Scene => "Scene".into(),
            Selection::Light(i) => format!("Light {}", scene.lights[i].name),
            Selection::Material(i) => format!("Material {}", scene.materials[i].name),
            Selection::Solid(i) => format!("Solid {}", scene.solids[i].name),
        }
    }
}

/// What the inspector reads besides the scene.
pub(super) struct Known<'a> {
    /// The scene as opened or saved: what "changed" and "reset" refer to.
    pub(super) saved: &'a Scene,
    /// Costs by path.
    pub(super) costs: &'a BTreeMap<String, Cost>,
    /// Index of the solid that was clicked or selected last.
    pub(super) picked: Option<usize>,
    /// Materials to choose from.
    pub(super) presets: &'a Presets,
}

/// What the person did in the inspector.
#[derive(Debug, Default)]
pub(super) struct Outcome {
    /// Whether the scene was edited.
    pub(super) changed: bool,
    /// Parameters to be set to a value, as paths and TOML: resets.
    pub(super) assignments: Vec<(String, String)>,
    /// Another selection.
    pub(super) select: Option<Selection>,
    /// A button was pressed.
    pub(super) command: Option<Command>,
    /// An image file is wanted.
    pub(super) pick: Option<ImageFor>,
    /// What else was done with controls.
    pub(super) edit: Edit,
    /// What the step is called, if it is more than it seems.
    pub(super) step: Option<String>,
}

/// Shows the controls of a selection, which write into `scene`.
pub(super) fn inspector_ui(
    ui: &mut Ui,
    scene: &mut Scene,
    selection: Selection,
    known: &Known<'_>,
) -> Outcome {
    let mut outcome = Outcome::default();
    ui.add_space(4.0);
    ui.heading(selection.title(scene));
    links_ui(ui, scene, selection, &mut outcome);
    things_ui(ui, scene, selection, known, &mut outcome);
    ui.separator();
    if let Selection::Light(i) = selection {
        outcome.changed |= kind_ui(ui, &mut scene.lights[i], known.costs);
    }
    let saved = texts(known.saved, same_name(scene, known.saved, selection));
    ScrollArea::vertical().auto_shrink(false).id_salt(selection).show(ui, |ui| {
        if let Selection::Material(i) = selection
            && let Some(preset) = known.presets.ui(ui)
        {
            give(&mut scene.materials[i], preset);
            outcome.changed = true;
            outcome.step = Some(format!("{} for {}", preset.name, scene.materials[i].name));
        }
        kinds_ui(ui, scene, selection, &mut outcome);
        if let Selection::Solid(i) = selection {
            operands_ui(ui, scene, i, &mut outcome);
        }
        let names = Names::of(scene);
        let defaults = Defaults::new(scene, selection);
        let mut controls = Controls {
            ui,
            selection,
            name: match selection {
                Selection::Material(i) => scene.materials[i].name.clone(),
                _ => String::new(),
            },
            prefix: String::new(),
            table: String::new(),
            depth: 0,
            names: &names,
            saved: saved.into_iter().collect(),
            defaults: &defaults,
            known,
            outcome: &mut outcome,
        };
        visit(scene, selection, &mut controls);
    });
    outcome
}

/// Ways from what is selected to what belongs to it.
fn links_ui(ui: &mut Ui, scene: &Scene, selection: Selection, outcome: &mut Outcome) {
    match selection {
        Selection::Solid(i) => {
            ui.horizontal_wrapped(|ui| {
                // A name goes to the next line as a whole.
                ui.style_mut().wrap_mode = Some(TextWrapMode::Extend);
                solid_links_ui(ui, scene, i, outcome);
            });
        }
        Selection::Material(i) => {
            let users = users(scene, i);
            ui.horizontal_wrapped(|ui| {
                ui.style_mut().wrap_mode = Some(TextWrapMode::Extend);
                if users.is_empty() {
                    ui.weak("No solid is made of it");
                }
                for &solid in users.iter().take(MOST_LINKS) {
                    let link = ui.link(format!("Solid {}", scene.solids[solid].name));
                    if link.on_hover_text("Shows this solid").clicked() {
                        outcome.select = Some(Selection::Solid(solid));
                    }
                }
                if users.len() > MOST_LINKS {
                    ui.weak(format!("and {} more", users.len() - MOST_LINKS));
                }
            });
        }
        Selection::Scene | Selection::Light(_) => {}
    }
}

/// Ways from a solid to its material, and to what is made of it.
fn solid_links_ui(ui: &mut Ui, scene: &Scene, index: usize, outcome: &mut Outcome) {
    let solid = &scene.solids[index];
    match scene.materials.get(solid.material).filter(|_| !solid.shape.is_composite()) {
        Some(material) => {
            let link = ui.link(format!("Material {}", material.name));
            if link.on_hover_text("Shows this material").clicked() {
                outcome.select = Some(Selection::Material(solid.material));
            }
        }
        None => drop(ui.weak("Its operands keep their materials")),
    }
    for i in wholes(scene, index).into_iter().take(MOST_LINKS) {
        let link = ui.link(format!("Part of {}", scene.solids[i].name));
        if link.on_hover_text("Shows the solid that is made of it").clicked() {
            outcome.select = Some(Selection::Solid(i));
        }
    }
}

/// Most solids of a material that are linked to.
const MOST_LINKS: usize = 6;

/// What can be done with the whole light, material or solid.
fn things_ui(
    ui: &mut Ui,
    scene: &Scene,
    selection: Selection,
    known: &Known<'_>,
    outcome: &mut Outcome,
) {
    if selection.thing().is_none() {
        return;
    }
    let subject = Subject { selection, picked: known.picked };
    ui.horizontal_wrapped(|ui| {
        for command in [Command::Duplicate, Command::Rename, Command::Delete] {
            let offer = subject.offer(command, scene);
            if offer_ui(ui, command, Button::new(command.name()), &offer).clicked() {
                outcome.command = Some(command);
            }
        }
    });
    let Selection::Material(_) = selection else { return };
    // A line of its own: what stands below must not move when a click in the picture gives it a cost.
    ui.horizontal_wrapped(|ui| {
        let offer = subject.offer(Command::Assign, scene);
        let button = Button::new(offer.name.clone());
        if offer_ui(ui, Command::Assign, button, &offer).clicked() {
            outcome.command = Some(Command::Assign);
        }
        if offer.refusal.is_none()
            && let Some(path) = subject.assigned_path(scene)
        {
            badge_ui(ui, "assigning", known.costs.get(&path).copied(), BADGE);
        }
    });
}

/// Makes a control of every value that it visits.
struct Controls<'a, 'u> {
    ui: &'u mut Ui,
    selection: Selection,
    /// Of the material that is selected.
    name: String,
    prefix: String,
    /// The innermost table that is no named thing.
    table: String,
    depth: usize,
    names: &'a Names,
    saved: HashMap<String, String>,
    defaults: &'a Defaults,
    known: &'a Known<'a>,
    outcome: &'a mut Outcome,
}

impl Visit for Controls<'_, '_> {
    fn leaf(&mut self, key: &'static str, _: Need, mut slot: Slot<'_>) {
        let path = join(&self.prefix, key);
        let saved = self.saved.get(&path).map(String::as_str);
        let row = Row {
            key,
            table: &self.table,
            path: &path,
            names: self.names,
            saved: saved.filter(|s| *s != slot.text(self.names)),
            default: &|| self.defaults.get(&path),
            cost: self.known.costs.get(&path).copied(),
        };
        let outcome = control_ui(self.ui, &row, &mut slot);
        self.outcome.changed |= outcome.edit.changed;
        self.outcome.edit.join(outcome.edit);
        if outcome.pick {
            self.outcome.pick = ImageFor::of(&path, self.selection, &self.name);
        }
        if outcome.reset
            && let Some(value) = row.saved
        {
            self.outcome.assignments.push((path.clone(), value.to_owned()));
        }
    }

    fn group(&mut self, key: &str, _: Need, body: &mut dyn FnMut(&mut dyn Visit)) {
        let inner = join(&self.prefix, key);
        let outer = std::mem::replace(&mut self.prefix, inner);
        // `materials` and the material's name are the heading already.
        let section = !fields::LISTS.contains(&outer.split('.').next().unwrap_or_default())
            && !fields::LISTS.contains(&key);
        if section || self.depth >= 2 {
            self.ui.add_space(6.0);
            self.ui.label(RichText::new(key).strong());
        }
        let inside = if section || self.depth >= 2 { key } else { "" };
        let around = std::mem::replace(&mut self.table, inside.to_owned());
        self.depth += 1;
        body(self);
        self.depth -= 1;
        self.table = around;
        self.prefix = outer;
    }
}
