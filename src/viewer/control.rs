//! One row of the inspector: name, control, cost.

use eframe::egui::{
    Align, Button, Checkbox, ComboBox, DragValue, Label, Layout, Rect, Response, RichText, Sense,
    Ui, UiBuilder, vec2,
};
use glam::DVec3;

use super::badge::badge_ui;
use super::coefficient::{channels_ui, coefficient_ui, color_ui, shows_channels};
use super::corners::{loops_ui, points_ui};
use super::hints;
use super::number::{Edit, FIELD, Face, Number, Precision, part, typed};
use crate::scene::range::Range;
use crate::scene::slot::{Choice, Slot};
use crate::scene::value::Names;
use crate::session::cost::Cost;

/// Width of the names.
const NAME: f32 = 98.0;
/// Width of the button that unfolds channels; kept free beside other sliders, so that all align.
pub(super) const TOGGLE: f32 = 30.0;
/// Width of the badge.
pub(super) const BADGE: f32 = 108.0;

/// What a row shows besides its value.
pub(super) struct Row<'a> {
    /// The parameter's key.
    pub(super) key: &'static str,
    /// The table in which it stands; empty for that of a light, a material or a solid.
    pub(super) table: &'a str,
    /// Its whole path.
    pub(super) path: &'a str,
    /// Names of the materials.
    pub(super) names: &'a Names,
    /// The saved value as TOML, if the present one differs.
    pub(super) saved: Option<&'a str>,
    /// The value as TOML that the scene file need not state, if there is one.
    pub(super) default: &'a dyn Fn() -> Option<String>,
    /// What an edit costs, if it is known.
    pub(super) cost: Option<Cost>,
}

/// What the person did in a row.
#[derive(Debug, Default)]
pub(super) struct RowOutcome {
    /// What became of the value.
    pub(super) edit: Edit,
    /// The saved value is wanted back.
    pub(super) reset: bool,
    /// Another file is wanted.
    pub(super) pick: bool,
}

impl Row<'_> {
    /// The controls of the number in this place of the row's value.
    pub(super) fn number(
        &self,
        name: String,
        place: usize,
        range: Range,
        precision: Precision,
    ) -> Number<'_> {
        let saved = self.saved.and_then(|text| part(text, place, precision));
        let Row { cost, default, .. } = *self;
        Number {
            scale: hints::scale(self.key, range, 0.0),
            name,
            bare: false,
            range,
            precision,
            face: Face::Plain,
            saved,
            default: Box::new(move || part(&default()?, place, precision)),
            limits: limits(cost),
            about: Box::new(move |ui| about_ui(ui, self, Some(range))),
        }
    }

    /// The same with a slider that covers the present value `x`.
    pub(super) fn slider_ui(&self, ui: &mut Ui, x: &mut f64, number: Number<'_>) -> Edit {
        let number = Number { scale: hints::scale(self.key, number.range, *x), ..number };
        number.both_ui(ui, x, TOGGLE + ui.spacing().item_spacing.x)
    }
}

/// Where an edit stops being instant.
fn limits(cost: Option<Cost>) -> Vec<f64> {
    use Cost::{InstantDownTo, InstantUpTo, InstantWithin, RereadBelow};
    match cost {
        Some(InstantUpTo(x, _) | InstantDownTo(x, _) | RereadBelow(x, _)) => vec![x],
        Some(InstantWithin(ends, _)) => ends.to_vec(),
        _ => Vec::new(),
    }
}

/// Shows the control of one value and writes into it.
pub(super) fn control_ui(ui: &mut Ui, row: &Row<'_>, slot: &mut Slot<'_>) -> RowOutcome {
    let mut outcome = RowOutcome::default();
    if let Slot::Points(points, _) = slot {
        outcome.edit = points_ui(ui, row, points);
        return outcome;
    }
    if let Slot::Loops(loops, range) = slot {
        outcome.edit = loops_ui(ui, row, loops, *range);
        return outcome;
    }
    let (name, value, badge) = columns(ui);
    if let Slot::Image(image) = slot {
        column_ui(ui, name, |ui| explained(ui.label(row.key), row, None));
        outcome.pick = column_ui(ui, value, |ui| image_ui(ui, row, &image.file));
        return outcome;
    }
    column_ui(ui, name, |ui| name_ui(ui, row, slot, &mut outcome));
    column_ui(ui, value, |ui| outcome.edit.join(value_ui(ui, row, slot)));
    // The name of a mesh file is not edited here.
    if !matches!(slot, Slot::Mesh { .. }) {
        column_ui(ui, badge, |ui| badge_ui(ui, row.key, row.cost, BADGE));
    }
    if let Slot::Coefficient(color, range) = slot
        && shows_channels(ui, row, color)
    {
        outcome.edit.join(channels_ui(ui, row, color, *range));
    }
    outcome
}

/// Takes a row of the panel's width and cuts it into name, value and badge: the same in every row,
/// whatever is in it.
pub(super) fn columns(ui: &mut Ui) -> (Rect, Rect, Rect) {
    let gap = ui.spacing().item_spacing.x;
    let size = vec2(ui.available_width(), ui.spacing().interact_size.y);
    let (row, _) = ui.allocate_exact_size(size, Sense::hover());
    let (left, right) = (row.left() + NAME, (row.right() - BADGE).max(row.left() + NAME + 80.0));
    let span = |from: f32, to: f32| Rect::from_x_y_ranges(from..=to, row.y_range());
    (span(row.left(), left), span(left + gap, right - gap), span(right, right + BADGE))
}

/// Fills one column of a row.
pub(super) fn column_ui<R>(ui: &mut Ui, column: Rect, body: impl FnOnce(&mut Ui) -> R) -> R {
    let layout = Layout::left_to_right(Align::Center);
    body(&mut ui.new_child(UiBuilder::new().max_rect(column).layout(layout)))
}

/// The name, which takes the saved value back when it is double-clicked.
fn name_ui(ui: &mut Ui, row: &Row<'_>, slot: &Slot<'_>, outcome: &mut RowOutcome) {
    ui.spacing_mut().item_spacing.x = 3.0;
    if row.saved.is_some() {
        let mark = Button::new(RichText::new("•").strong()).frame(false).small();
        let name = format!("reset {}", row.key);
        let mark = ui.add(mark).accessible_name(name);
        outcome.reset |= explained(mark, row, slot.range()).clicked();
    }
    let label = Label::new(row.key).truncate().sense(Sense::click());
    outcome.reset |= explained(ui.add(label), row, slot.range()).double_clicked();
}

/// The control itself.
fn value_ui(ui: &mut Ui, row: &Row<'_>, slot: &mut Slot<'_>) -> Edit {
    let name = || row.key.to_owned();
    let changed = match slot {
        Slot::Coefficient(color, range) if hints::is_color(row.key) => {
            return color_ui(ui, row, color, *range);
        }
        Slot::Coefficient(color, range) => return coefficient_ui(ui, row, color, *range),
        Slot::Single(x, range) => {
            let mut wide = f64::from(**x);
            let number = row.number(name(), 0, *range, Precision::Single);
            let edit = row.slider_ui(ui, &mut wide, number);
            if edit.changed {
                **x = wide as f32;
            }
            return edit;
        }
        Slot::Number(x, range) => {
            let number = row.number(name(), 0, *range, Precision::Double);
            return match has_slider(row.key) {
                true => row.slider_ui(ui, x, number),
                false => number.field_ui(ui, x, FIELD),
            };
        }
        Slot::Whole(n, range) => {
            let mut wide = f64::from(**n);
            let number = row.number(name(), 0, *range, Precision::Whole);
            let mut edit = row.slider_ui(ui, &mut wide, number);
            edit.changed &= wide as u32 != **n;
            **n = wide as u32;
            return edit;
        }
        Slot::Vector(v, range) | Slot::Scale(v, range) => {
            return vector_ui(ui, row, (row.key, 0), v, *range);
        }
        Slot::Pair(pair, range) => pair_ui(ui, row, pair, *range),
        Slot::Flag(on) => {
            let checkbox = Checkbox::without_text(on);
            let response = ui.add(checkbox).accessible_name(row.key);
            explained(response, row, None).changed()
        }
        Slot::Choice(choice) => choice_ui(ui, row, *choice),
        Slot::Material(index) => material_ui(ui, row, index),
        Slot::Mesh { file, .. } => {
            let label = ui.add(Label::new(file.as_str()).truncate());
            explained(label, row, None);
            false
        }
        // The list itself stands above: see `operands.rs`.
        Slot::Solids(_) => {
            let text = slot.text(row.names);
            let label = ui.add(Label::new(text.as_str()).truncate());
            explained(label.on_hover_text(text), row, None);
            false
        }
        Slot::Points(..) | Slot::Loops(..) | Slot::Image(_) => false,
    };
    Edit { changed, ..Edit::default() }
}

/// Whether a geometric number has a natural span for a slider.
fn has_slider(key: &str) -> bool {
    matches!(
        key,
        "ior" | "fov_degrees" | "shutter" | "falloff" | "angle_degrees" | "edge" | "turbulence"
    )
}

fn pair_ui(ui: &mut Ui, row: &Row<'_>, pair: &mut [u32; 2], range: Range) -> bool {
    let names = if row.key == "size" { ["width", "height"] } else { ["first", "second"] };
    let mut changed = false;
    for (n, part) in pair.iter_mut().zip(names) {
        let field = DragValue::new(n)
            .range(range.low as u32..=range.high as u32)
            .custom_parser(typed)
            .update_while_editing(false);
        let response = ui.add(field).accessible_name(format!("{} {part}", row.key));
        changed |= explained(response, row, Some(range)).changed();
    }
    changed
}

/// The numbers of a point or direction, of which the first is at this place of the row's value.
pub(super) fn vector_ui(
    ui: &mut Ui,
    row: &Row<'_>,
    (name, place): (&str, usize),
    v: &mut DVec3,
    range: Range,
) -> Edit {
    let mut edit = Edit::default();
    for (i, (x, axis)) in
        [(&mut v.x, "x"), (&mut v.y, "y"), (&mut v.z, "z")].into_iter().enumerate()
    {
        let number = row.number(format!("{name} {axis}"), place + i, range, Precision::Double);
        edit.join(number.field_ui(ui, x, FIELD));
    }
    edit
}

fn choice_ui(ui: &mut Ui, row: &Row<'_>, choice: &mut dyn Choice) -> bool {
    let (names, before) = (choice.names(), choice.chosen());
    let mut index = before;
    let combo = ComboBox::from_id_salt(row.path).selected_text(names[before]);
    let response = combo.width(ui.available_width()).show_ui(ui, |ui| {
        for (i, name) in names.iter().enumerate() {
            ui.selectable_value(&mut index, i, *name).on_hover_text(hints::choice(name));
        }
    });
    explained(response.response.accessible_name(row.key), row, None);
    if index != before {
        choice.choose(index);
    }
    index != before
}

fn material_ui(ui: &mut Ui, row: &Row<'_>, index: &mut usize) -> bool {
    let before = *index;
    let names = row.names.materials();
    let name = |i: usize| names.get(i).map_or("?", String::as_str);
    let combo = ComboBox::from_id_salt(row.path).selected_text(name(before));
    let response = combo.width(ui.available_width()).show_ui(ui, |ui| {
        for i in 0..names.len() {
            ui.selectable_value(index, i, name(i)).on_hover_text("Gives the solid this material");
        }
    });
    explained(response.response.accessible_name(row.key), row, None);
    *index != before
}

/// The name of an image file on a button; whether another one is wanted.
fn image_ui(ui: &mut Ui, row: &Row<'_>, file: &str) -> bool {
    let button = ui.add(Button::new(file).truncate()).accessible_name("pick an image file");
    explained(button, row, None).clicked()
}

/// A tooltip with what the parameter is for, its range, its path and its saved value.
pub(super) fn explained(response: Response, row: &Row<'_>, range: Option<Range>) -> Response {
    response.on_hover_ui(|ui| about_ui(ui, row, range))
}

pub(super) fn about_ui(ui: &mut Ui, row: &Row<'_>, range: Option<Range>) {
    ui.label(hints::about(row.table, row.key));
    if let Some(range) = range {
        ui.weak(format!("range: {range}"));
    }
    ui.weak(row.path);
    if let Some(saved) = row.saved {
        ui.weak(format!("saved: {saved}; double-click the name to take it back"));
    }
}
