//! The scene as a list: what is in it, and what is selected.

use eframe::egui::{CollapsingHeader, Color32, Response, ScrollArea, Sense, Stroke, Ui, vec2};

use super::command::Command;
use super::inspector::Selection;
use super::lists::Subject;
use super::menu::things_ui;
use super::rename::{Left, Renaming};
use super::shapes::add_solid_ui;
use crate::color::Rgb;
use crate::color::notation::bytes;
use crate::document::things::Thing;
use crate::scene::{Light, Material, Scene};

/// What the lists show besides the scene.
pub(super) struct Lists<'a> {
    /// What is selected, and which solid was picked.
    pub(super) subject: Subject,
    /// The name that is being changed.
    pub(super) renaming: &'a mut Option<Renaming>,
}

/// What the person did in the lists.
#[derive(Debug, Default)]
pub(super) struct OutlineOutcome {
    /// Another selection.
    pub(super) select: Option<Selection>,
    /// What is to be done with what is then selected.
    pub(super) command: Option<Command>,
    /// The field of a name was left.
    pub(super) renamed: Option<Left>,
}

/// Shows the lists.
pub(super) fn outline_ui(ui: &mut Ui, scene: &Scene, lists: &mut Lists<'_>) -> OutlineOutcome {
    let mut outcome = OutlineOutcome::default();
    ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
        ui.add_space(4.0);
        let whole = ui.selectable_label(lists.subject.selection == Selection::Scene, "Scene");
        let about = "Picture size and exposure, camera, tracing, background";
        if whole.on_hover_text(about).clicked() {
            outcome.select = Some(Selection::Scene);
        }
        let edits = |thing: Thing| lists.renaming.as_ref().is_some_and(|field| field.is_of(thing));
        let open = [
            (0..scene.materials.len()).any(|i| edits(Thing::Material(i))),
            (0..scene.lights.len()).any(|i| edits(Thing::Light(i))),
            (0..scene.solids.len()).any(|i| edits(Thing::Solid(i))),
        ];
        list_ui(ui, "Materials", (scene.materials.len(), open[0]), |ui, row| {
            let Some(i) = row else { return add_ui(ui, Command::AddMaterial, &mut outcome) };
            let material = &scene.materials[i];
            let about = "Shows this material; or click its surface in the picture. \
                         A double click changes its name";
            let row = RowFace { name: &material.name, about, color: swatch(material) };
            thing_ui(ui, scene, &row, Thing::Material(i), lists, &mut outcome);
        });
        list_ui(ui, "Lights", (scene.lights.len(), open[1]), |ui, row| {
            let Some(i) = row else { return add_ui(ui, Command::AddLight, &mut outcome) };
            let light = &scene.lights[i];
            let about = "Shows this light. A double click changes its name";
            let row = RowFace { name: &light.name, about, color: lamp(light) };
            thing_ui(ui, scene, &row, Thing::Light(i), lists, &mut outcome);
        });
        list_ui(ui, "Solids", (scene.solids.len(), open[2]), |ui, row| {
            let Some(i) = row else {
                return add_solid_ui(ui, lists.subject, scene, &mut outcome.command);
            };
            let solid = &scene.solids[i];
            let color = swatch(&scene.materials[solid.material]);
            let about = "Shows this solid; or click it in the picture with Alt. \
                         A double click changes its name";
            let row = RowFace { name: &solid.name, about, color };
            thing_ui(ui, scene, &row, Thing::Solid(i), lists, &mut outcome);
        });
    });
    outcome
}

/// A list under its title; `row` gets every index, and `None` in the end. It opens if it must.
fn list_ui(
    ui: &mut Ui,
    title: &str,
    (count, must_open): (usize, bool),
    mut row: impl FnMut(&mut Ui, Option<usize>),
) {
    let header = CollapsingHeader::new(title).default_open(true);
    let header = header.open(must_open.then_some(true)).show(ui, |ui| {
        if count == 0 {
            ui.weak("none");
        }
        for i in 0..count {
            row(ui, Some(i));
        }
        row(ui, None);
    });
    header.header_response.on_hover_text("Click to open or close the list");
}

/// The button below a list that makes it longer.
fn add_ui(ui: &mut Ui, command: Command, outcome: &mut OutlineOutcome) {
    let button = ui.small_button(format!("+ {}", command.name()));
    if button.on_hover_text(command.about()).clicked() {
        outcome.command = Some(command);
    }
}

/// What a line of a list shows.
struct RowFace<'a> {
    name: &'a str,
    about: &'a str,
    color: Color32,
}

/// A thing with what can be done with it, or the field of its name.
fn thing_ui(
    ui: &mut Ui,
    scene: &Scene,
    row: &RowFace<'_>,
    thing: Thing,
    lists: &mut Lists<'_>,
    outcome: &mut OutlineOutcome,
) {
    if let Some(field) = lists.renaming.as_mut().filter(|field| field.is_of(thing)) {
        ui.horizontal(|ui| {
            spot_ui(ui, row.color);
            outcome.renamed = field.ui(ui, scene).or(outcome.renamed.take());
        });
        field.refusal_ui(ui, scene);
        return;
    }
    let selection = Selection::from(thing);
    let response = row_ui(ui, row, lists.subject.selection == selection);
    if response.clicked() || response.secondary_clicked() {
        outcome.select = Some(selection);
    }
    if response.double_clicked() {
        outcome.command = Some(Command::Rename);
    }
    let mut chosen = None;
    let subject = Subject { selection, ..lists.subject };
    response.context_menu(|ui| things_ui(ui, subject, scene, &mut chosen));
    if response.has_focus() {
        // The keys of a line that Tab reached: shortcuts are for when nothing has the keyboard.
        let pressed = [Command::Rename, Command::Delete].into_iter().find(|command| {
            let keys = command.shortcut();
            keys.is_some_and(|keys| ui.input_mut(|input| input.consume_shortcut(&keys)))
        });
        chosen = chosen.or(pressed);
    }
    if chosen.is_some() {
        (outcome.select, outcome.command) = (Some(selection), chosen);
    }
}

/// A named line with a spot of colour.
fn row_ui(ui: &mut Ui, row: &RowFace<'_>, selected: bool) -> Response {
    ui.horizontal(|ui| {
        spot_ui(ui, row.color);
        ui.selectable_label(selected, row.name).on_hover_text(row.about)
    })
    .inner
}

fn spot_ui(ui: &mut Ui, color: Color32) {
    let height = ui.spacing().interact_size.y;
    let (rect, _) = ui.allocate_exact_size(vec2(10.0, height), Sense::hover());
    let outline = Stroke::new(1.0, ui.visuals().weak_text_color());
    ui.painter().circle(rect.center(), 5.0, color, outline);
}

/// The colour that stands for a material: what it is seen by most.
pub(super) fn swatch(material: &Material) -> Color32 {
    let color = material.paint.mean();
    let glass = material.transmit.max_channel() > 0.5;
    shown(if glass { material.filter } else { color })
}

/// The colour of a light; none of one that is off.
pub(super) fn lamp(light: &Light) -> Color32 {
    if light.on { shown(light.color) } else { Color32::TRANSPARENT }
}

/// Linear light on the screen, in the bytes that it has in a picture of exposure 0.
pub(super) fn shown(light: Rgb) -> Color32 {
    let [r, g, b] = bytes(light);
    Color32::from_rgb(r, g, b)
}
