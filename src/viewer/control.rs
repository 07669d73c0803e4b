//! One row of the inspector: name, control, cost.

use eframe::egui::{Align, CollapsingHeader, Id, Stroke};
use eframe::egui::{
    Button, Checkbox, Color32, ComboBox, DragValue, Label, Layout, Rect, Response, RichText, Sense,
    Slider, SliderClamping, Ui, UiBuilder, pos2, vec2,
};
use glam::{DVec2, DVec3};

use super::badge::badge_ui;
use super::hints;
use crate::color::Rgb;
use crate::scene::range::Range;
use crate::scene::slot::{Choice, Slot};
use crate::scene::value::Names;
use crate::session::cost::Cost;

/// Width of the names.
const NAME: f32 = 98.0;
/// Width of a number field.
const FIELD: f32 = 58.0;
/// Width of the button that unfolds channels; kept free beside other sliders, so that all align.
const TOGGLE: f32 = 30.0;
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
    /// What an edit costs, if it is known.
    pub(super) cost: Option<Cost>,
}

/// What the person did in a row.
#[derive(Debug, Default)]
pub(super) struct RowOutcome {
    /// The value was edited.
    pub(super) changed: bool,
    /// The saved value is wanted back.
    pub(super) reset: bool,
    /// Another file is wanted.
    pub(super) pick: bool,
}

/// Shows the control of one value and writes into it.
pub(super) fn control_ui(ui: &mut Ui, row: &Row<'_>, slot: &mut Slot<'_>) -> RowOutcome {
    let mut outcome = RowOutcome::default();
    if let Slot::Points(points, _) = slot {
        points_ui(ui, row, points, &mut outcome);
        return outcome;
    }
    if let Slot::Loops(loops, range) = slot {
        loops_ui(ui, row, loops, *range, &mut outcome);
        return outcome;
    }
    let (name, value, badge) = columns(ui);
    if let Slot::Image(image) = slot {
        column_ui(ui, name, |ui| explained(ui.label(row.key), row, None));
        outcome.pick = column_ui(ui, value, |ui| image_ui(ui, row, &image.file));
        return outcome;
    }
    column_ui(ui, name, |ui| name_ui(ui, row, slot, &mut outcome));
    column_ui(ui, value, |ui| outcome.changed |= value_ui(ui, row, slot));
    // The name of a mesh file is not edited here.
    if !matches!(slot, Slot::Mesh { .. }) {
        column_ui(ui, badge, |ui| badge_ui(ui, row.key, row.cost, BADGE));
    }
    if let Slot::Coefficient(color, range) = slot
        && shows_channels(ui, row, color)
    {
        outcome.changed |= channels_ui(ui, row, color, *range);
    }
    outcome
}

/// Takes a row of the panel's width and cuts it into name, value and badge: the same in every row,
/// whatever is in it.
fn columns(ui: &mut Ui) -> (Rect, Rect, Rect) {
    let gap = ui.spacing().item_spacing.x;
    let size = vec2(ui.available_width(), ui.spacing().interact_size.y);
    let (row, _) = ui.allocate_exact_size(size, Sense::hover());
    let (left, right) = (row.left() + NAME, (row.right() - BADGE).max(row.left() + NAME + 80.0));
    let span = |from: f32, to: f32| Rect::from_x_y_ranges(from..=to, row.y_range());
    (span(row.left(), left), span(left + gap, right - gap), span(right, right + BADGE))
}

/// Fills one column of a row.
fn column_ui<R>(ui: &mut Ui, column: Rect, body: impl FnOnce(&mut Ui) -> R) -> R {
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

/// The control itself; whether the value changed.
fn value_ui(ui: &mut Ui, row: &Row<'_>, slot: &mut Slot<'_>) -> bool {
    match slot {
        Slot::Coefficient(color, range) if hints::is_color(row.key) => {
            color_ui(ui, row, color, *range)
        }
        Slot::Coefficient(color, range) => coefficient_ui(ui, row, color, *range),
        Slot::Single(x, range) => {
            let mut wide = f64::from(**x);
            let changed = number_ui(ui, row, row.key, &mut wide, *range);
            if changed {
                **x = wide as f32;
            }
            changed
        }
        Slot::Number(x, range) if has_slider(row.key) => number_ui(ui, row, row.key, x, *range),
        Slot::Number(x, range) => field_ui(ui, row, row.key, x, *range),
        Slot::Whole(n, range) => {
            let mut wide = f64::from(**n);
            let changed = whole_ui(ui, row, &mut wide, *range);
            if changed {
                **n = wide as u32;
            }
            changed
        }
        Slot::Pair(pair, range) => pair_ui(ui, row, pair, *range),
        Slot::Flag(on) => {
            let checkbox = Checkbox::without_text(on);
            let response = ui.add(checkbox).accessible_name(row.key);
            explained(response, row, None).changed()
        }
        Slot::Vector(v, range) | Slot::Scale(v, range) => vector_ui(ui, row, row.key, v, *range),
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
    }
}

/// Whether a geometric number has a natural span for a slider.
fn has_slider(key: &str) -> bool {
    matches!(
        key,
        "ior" | "fov_degrees" | "shutter" | "falloff" | "angle_degrees" | "edge" | "turbulence"
    )
}

/// A slider with a number field. Typed numbers may leave the slider's span, not the range.
fn number_ui(ui: &mut Ui, row: &Row<'_>, name: &str, x: &mut f64, range: Range) -> bool {
    slider_ui(ui, row, name, x, range) | field_ui(ui, row, name, x, range)
}

fn slider_ui(ui: &mut Ui, row: &Row<'_>, name: &str, x: &mut f64, range: Range) -> bool {
    let hints::Scale { span, logarithmic } = hints::scale(row.key, range, *x);
    let space = ui.available_width() - FIELD - TOGGLE - 2.0 * ui.spacing().item_spacing.x;
    ui.spacing_mut().slider_width = space.max(40.0);
    let (low, high) = (*span.start(), *span.end());
    let slider = Slider::new(x, span).show_value(false).clamping(SliderClamping::Never);
    let slider = slider.logarithmic(logarithmic).smallest_positive(1.0).trailing_fill(true);
    let response = ui.add(slider).accessible_name(name);
    if !logarithmic {
        thresholds_ui(ui, &response, row.cost, low, high);
    }
    let changed = response.changed();
    explained(response, row, Some(range));
    if changed {
        *x = range.clamp(*x);
    }
    changed
}

/// Ticks on the slider where an edit stops being instant.
fn thresholds_ui(ui: &Ui, slider: &Response, cost: Option<Cost>, low: f64, high: f64) {
    use Cost::{InstantDownTo, InstantUpTo, InstantWithin, RereadBelow};
    let limits = match cost {
        Some(InstantUpTo(x, _) | InstantDownTo(x, _) | RereadBelow(x, _)) => vec![x],
        Some(InstantWithin(ends, _)) => ends.to_vec(),
        _ => return,
    };
    for x in limits.into_iter().filter(|x| (low..=high).contains(x) && high > low) {
        let rect = slider.rect.shrink2(vec2(slider.rect.height() / 2.5, 0.0));
        let at = rect.left() + rect.width() * ((x - low) / (high - low)) as f32;
        let stroke = Stroke::new(1.5, Color32::from_rgb(200, 140, 30));
        // Below the rail, so that the handle does not hide it.
        let line = [pos2(at, rect.center().y + 4.0), pos2(at, rect.bottom())];
        ui.painter().line_segment(line, stroke);
    }
}

/// A number field: drag it, or click and type.
fn field_ui(ui: &mut Ui, row: &Row<'_>, name: &str, x: &mut f64, range: Range) -> bool {
    let speed = 0.005 * x.abs().max(0.2);
    let before = *x;
    let field = DragValue::new(x)
        .speed(speed)
        .update_while_editing(false)
        .custom_parser(typed)
        .custom_formatter(|x, _| shown(x));
    let response = ui.add_sized(vec2(FIELD, ui.spacing().interact_size.y), field);
    // A field that is left without an edit keeps every bit, also those that it does not show.
    let changed = response.changed() && shown(before) != shown(*x);
    *x = if changed { range.clamp(*x) } else { before };
    explained(response.accessible_name(format!("{name} value")), row, Some(range));
    changed
}

fn whole_ui(ui: &mut Ui, row: &Row<'_>, x: &mut f64, range: Range) -> bool {
    let mut edited = *x;
    let changed = number_ui(ui, row, row.key, &mut edited, range);
    edited = range.clamp(edited.round());
    let differs = changed && edited != *x;
    *x = edited;
    differs
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

fn vector_ui(ui: &mut Ui, row: &Row<'_>, name: &str, v: &mut DVec3, range: Range) -> bool {
    let mut changed = false;
    for (x, axis) in [(&mut v.x, "x"), (&mut v.y, "y"), (&mut v.z, "z")] {
        changed |= field_ui(ui, row, &format!("{name} {axis}"), x, range);
    }
    changed
}

/// A grey coefficient has one slider; a coloured one has three, in rows of their own.
fn coefficient_ui(ui: &mut Ui, row: &Row<'_>, color: &mut Rgb, range: Range) -> bool {
    let Rgb([r, g, b]) = *color;
    if r != g || g != b {
        let mean = (f64::from(r) + f64::from(g) + f64::from(b)) / 3.0;
        let text = format!("r {} · g {} · b {}", shown(r.into()), shown(g.into()), shown(b.into()));
        let grey = ui.add(Button::new(RichText::new(text).small()).small());
        let grey = grey.accessible_name(format!("one value for {}", row.key));
        if grey
            .on_hover_text("Three different channels; click to give all of them their mean")
            .clicked()
        {
            *color = Rgb::grey(mean as f32);
            return true;
        }
        return false;
    }
    let id = channels_id(row);
    let mut open = ui.data(|data| data.get_temp::<bool>(id)).unwrap_or(false);
    let mut wide = f64::from(r);
    let changed = number_ui(ui, row, row.key, &mut wide, range);
    let toggle = Button::selectable(open, RichText::new("rgb").small()).small();
    let toggle = ui.add_sized(vec2(TOGGLE, ui.spacing().interact_size.y), toggle);
    let toggle = toggle.accessible_name(format!("channels of {}", row.key));
    if toggle.on_hover_text("One slider for each of red, green and blue").clicked() {
        open = !open;
        ui.data_mut(|data| data.insert_temp(id, open));
    }
    if changed {
        *color = Rgb::grey(wide as f32);
    }
    changed
}

/// The same wherever in the row it is asked for.
fn channels_id(row: &Row<'_>) -> Id {
    Id::unique(("channels", row.path))
}

/// Whether the three channels have rows of their own.
fn shows_channels(ui: &Ui, row: &Row<'_>, color: &Rgb) -> bool {
    let Rgb([r, g, b]) = *color;
    let opened = ui.data(|data| data.get_temp::<bool>(channels_id(row)));
    !hints::is_color(row.key) && (r != g || g != b || opened.unwrap_or(false))
}

fn channels_ui(ui: &mut Ui, row: &Row<'_>, color: &mut Rgb, range: Range) -> bool {
    let mut changed = false;
    for (channel, name) in color.0.iter_mut().zip(["red", "green", "blue"]) {
        let (label, value, _) = columns(ui);
        let right_to_left = Layout::right_to_left(Align::Center);
        ui.new_child(UiBuilder::new().max_rect(label).layout(right_to_left)).weak(name);
        column_ui(ui, value, |ui| {
            let mut wide = f64::from(*channel);
            if number_ui(ui, row, &format!("{} {name}", row.key), &mut wide, range) {
                *channel = wide as f32;
                changed = true;
            }
        });
    }
    changed
}

/// A swatch with a picker, and three numbers in linear light.
fn color_ui(ui: &mut Ui, row: &Row<'_>, color: &mut Rgb, range: Range) -> bool {
    let before = *color;
    let space = ui.spacing().item_spacing.x;
    let response = ui.color_edit_button_rgb(&mut color.0);
    let mut changed = response.changed();
    // The picker gives back what it was given through sRGB bytes: only a real edit counts.
    if !changed {
        *color = before;
    }
    explained(response.accessible_name(row.key), row, Some(range));
    let width = ((ui.available_width() - 2.0 * space) / 3.0).max(30.0);
    for (channel, name) in color.0.iter_mut().zip(["red", "green", "blue"]) {
        let mut wide = f64::from(*channel);
        let field = DragValue::new(&mut wide)
            .speed(0.003)
            .update_while_editing(false)
            .custom_parser(typed)
            .custom_formatter(|x, _| shown(x));
        let response = ui.add_sized(vec2(width, ui.spacing().interact_size.y), field);
        let edited = response.changed() && shown(wide) != shown(f64::from(*channel));
        explained(response.accessible_name(format!("{} {name}", row.key)), row, Some(range));
        if edited {
            *channel = range.clamp(wide) as f32;
            changed = true;
        }
    }
    changed
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

/// A polygon's corners, one row each.
fn points_ui(ui: &mut Ui, row: &Row<'_>, points: &mut [DVec3], outcome: &mut RowOutcome) {
    let title = format!("{} ({})", row.key, points.len());
    let header = CollapsingHeader::new(title).id_salt(row.path);
    let header = header.show(ui, |ui| {
        badge_ui(ui, row.key, row.cost, BADGE);
        for (i, point) in points.iter_mut().enumerate() {
            ui.horizontal(|ui| {
                let name = format!("{} {i}", row.key);
                ui.label(i.to_string());
                outcome.changed |=
                    vector_ui(ui, row, &name, point, crate::scene::fields::COORDINATE);
            });
        }
    });
    explained(header.header_response, row, None);
}

/// The corners of an outline's loops, one row each.
fn loops_ui(
    ui: &mut Ui,
    row: &Row<'_>,
    loops: &mut [Vec<DVec2>],
    range: Range,
    outcome: &mut RowOutcome,
) {
    let title = format!("{} ({})", row.key, loops.iter().map(Vec::len).sum::<usize>());
    let header = CollapsingHeader::new(title).id_salt(row.path);
    let header = header.show(ui, |ui| {
        badge_ui(ui, row.key, row.cost, BADGE);
        for (l, points) in loops.iter_mut().enumerate() {
            for (i, point) in points.iter_mut().enumerate() {
                ui.horizontal(|ui| {
                    ui.label(format!("{l}.{i}"));
                    for (x, axis) in [(&mut point.x, "x"), (&mut point.y, "y")] {
                        let name = format!("{} {l}.{i} {axis}", row.key);
                        outcome.changed |= field_ui(ui, row, &name, x, range);
                    }
                });
            }
        }
    });
    explained(header.header_response, row, None);
}

/// A tooltip with what the parameter is for, its range, its path and its saved value.
fn explained(response: Response, row: &Row<'_>, range: Option<Range>) -> Response {
    response.on_hover_ui(|ui| {
        ui.label(hints::about(row.table, row.key));
        if let Some(range) = range {
            ui.weak(format!("range: {range}"));
        }
        ui.weak(row.path);
        if let Some(saved) = row.saved {
            ui.weak(format!("saved: {saved}; double-click the name to take it back"));
        }
    })
}

/// What a typed text means, if it is a number: spaces do not count, a printed minus does.
pub(super) fn typed(text: &str) -> Option<f64> {
    let text: String = text.chars().filter(|c| !c.is_whitespace()).collect();
    text.replace('−', "-").parse().ok().filter(|x: &f64| !x.is_nan())
}

/// Five significant digits at most, and no more than five after the point.
fn shown(x: f64) -> String {
    if x == 0.0 {
        return "0".into();
    }
    let magnitude = x.abs().log10().floor() as i32;
    if !(-4..9).contains(&magnitude) {
        return format!("{x:.2e}");
    }
    let text = format!("{x:.*}", (4 - magnitude).clamp(0, 5) as usize);
    match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
        false => text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_numbers_are_taken_for_numbers() {
        for (text, x) in
            [("0.5", Some(0.5)), (" −1 000 ", Some(-1000.0)), ("NaN", None), ("1,5", None)]
        {
            assert_eq!(typed(text), x, "{text}");
        }
    }

    #[test]
    fn numbers_are_shown_with_five_digits() {
        for (x, text) in [
            (0.0, "0"),
            (0.7, "0.7"),
            (f64::from(0.7f32), "0.7"),
            (-5.25, "-5.25"),
            (1.0 / 3.0, "0.33333"),
            (123_456.7, "123457"),
            (1000.0, "1000"),
            (1.0 / 255.0, "0.00392"),
            (1e-9, "1.00e-9"),
            (1e12, "1.00e12"),
        ] {
            assert_eq!(shown(x), text);
        }
    }
}
