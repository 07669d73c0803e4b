//! Rows of coefficients and colours: one slider, three of them, or a swatch.

use eframe::egui::{Align, Button, Id, Layout, RichText, Ui, UiBuilder, vec2};

use super::color_field::ColorField;
use super::control::{Row, TOGGLE, about_ui, column_ui, columns};
use super::hints;
use super::number::{Edit, Number, Precision, part, shown};
use crate::color::Rgb;
use crate::scene::range::Range;

/// Red, green and blue.
const CHANNELS: [&str; 3] = ["red", "green", "blue"];

/// A grey coefficient has one slider; a coloured one has three, in rows of their own.
pub(super) fn coefficient_ui(ui: &mut Ui, row: &Row<'_>, color: &mut Rgb, range: Range) -> Edit {
    let Rgb([r, g, b]) = *color;
    if r != g || g != b {
        return mean_ui(ui, row, color);
    }
    let id = channels_id(row);
    let mut open = ui.data(|data| data.get_temp::<bool>(id)).unwrap_or(false);
    let mut wide = f64::from(r);
    let number = row.number(row.key.to_owned(), 0, range, Precision::Single);
    let edit = row.slider_ui(ui, &mut wide, number);
    let toggle = Button::selectable(open, RichText::new("rgb").small()).small();
    let toggle = ui.add_sized(vec2(TOGGLE, ui.spacing().interact_size.y), toggle);
    let toggle = toggle.accessible_name(format!("channels of {}", row.key));
    if toggle.on_hover_text("One slider for each of red, green and blue").clicked() {
        open = !open;
        ui.data_mut(|data| data.insert_temp(id, open));
    }
    if edit.changed {
        *color = Rgb::grey(wide as f32);
    }
    edit
}

/// Three different channels in short; a click makes them one.
fn mean_ui(ui: &mut Ui, row: &Row<'_>, color: &mut Rgb) -> Edit {
    let [r, g, b] = color.0.map(f64::from);
    let text = format!("r {} · g {} · b {}", shown(r), shown(g), shown(b));
    let grey = ui.add(Button::new(RichText::new(text).small()).small());
    let grey = grey.accessible_name(format!("one value for {}", row.key));
    let about = "Three different channels; click to give all of them their mean";
    let changed = grey.on_hover_text(about).clicked();
    if changed {
        *color = Rgb::grey(((r + g + b) / 3.0) as f32);
    }
    Edit { changed, ..Edit::default() }
}

/// The same wherever in the row it is asked for.
fn channels_id(row: &Row<'_>) -> Id {
    Id::unique(("channels", row.path))
}

/// Whether the three channels have rows of their own.
pub(super) fn shows_channels(ui: &Ui, row: &Row<'_>, color: &Rgb) -> bool {
    let Rgb([r, g, b]) = *color;
    let opened = ui.data(|data| data.get_temp::<bool>(channels_id(row)));
    !hints::is_color(row.key) && (r != g || g != b || opened.unwrap_or(false))
}

/// A row with a slider for each channel.
pub(super) fn channels_ui(ui: &mut Ui, row: &Row<'_>, color: &mut Rgb, range: Range) -> Edit {
    let mut edit = Edit::default();
    for (place, (channel, name)) in color.0.iter_mut().zip(CHANNELS).enumerate() {
        let (label, value, _) = columns(ui);
        let right_to_left = Layout::right_to_left(Align::Center);
        ui.new_child(UiBuilder::new().max_rect(label).layout(right_to_left)).weak(name);
        column_ui(ui, value, |ui| {
            let mut wide = f64::from(*channel);
            let name = format!("{} {name}", row.key);
            let number = row.number(name, place, range, Precision::Single);
            let done = row.slider_ui(ui, &mut wide, number);
            if done.changed {
                *channel = wide as f32;
            }
            edit.join(done);
        });
    }
    edit
}

/// A swatch with a picker, and three numbers in linear light.
pub(super) fn color_ui(ui: &mut Ui, row: &Row<'_>, color: &mut Rgb, range: Range) -> Edit {
    let channels = |text: &str| {
        let channel = |place| part(text, place, Precision::Single).map(|x| x as f32);
        Some(Rgb([channel(0)?, channel(1)?, channel(2)?]))
    };
    let field = ColorField {
        name: row.key.to_owned(),
        range,
        saved: row.saved.and_then(channels),
        default: Box::new(move || channels(&(row.default)()?)),
        kelvin: row.key == "color" && row.path.starts_with("lights."),
        about: Box::new(move |ui| about_ui(ui, row, Some(range))),
    };
    let mut edit = field.swatch_ui(ui, color);
    let width = ((ui.available_width() - 2.0 * ui.spacing().item_spacing.x) / 3.0).max(30.0);
    for (place, (channel, name)) in color.0.iter_mut().zip(CHANNELS).enumerate() {
        let mut wide = f64::from(*channel);
        let name = format!("{} {name}", row.key);
        let number = row.number(name, place, range, Precision::Single);
        let done = Number { bare: true, ..number }.field_ui(ui, &mut wide, width);
        if done.changed {
            *channel = wide as f32;
        }
        edit.join(done);
    }
    edit
}
