//! A colour that can be edited: a swatch that opens a picker, and three numbers in linear light.

use eframe::egui::{
    Color32, CornerRadius, Id, Popup, PopupCloseBehavior, Rect, Response, Role, Sense, Stroke,
    StrokeKind, Ui, WidgetInfo, vec2,
};

use super::clipboard;
use super::color_picker::picker_ui;
use super::number::{Choice, Edit, Menu, menu_ui, refusal};
use super::outline::shown;
use crate::color::Rgb;
use crate::color::notation::{bytes, hex, of_bytes, read_hex};
use crate::scene::range::Range;
use crate::scene::toml_text::rgb as rgb_text;

/// A colour as its controls show it; the value itself is handed to them.
pub(super) struct ColorField<'a> {
    /// Its accessible name.
    pub(super) name: String,
    /// What each channel may be.
    pub(super) range: Range,
    /// The saved colour, if the present one is another.
    pub(super) saved: Option<Rgb>,
    /// The colour that the scene file need not state, if there is one.
    pub(super) default: Box<dyn Fn() -> Option<Rgb> + 'a>,
    /// Whether the colour is that of a light, which may have a temperature.
    pub(super) kelvin: bool,
    /// The tooltip.
    pub(super) about: Box<dyn Fn(&mut Ui) + 'a>,
}

impl ColorField<'_> {
    /// The swatch; a click opens the picker, a right click the menu. Nothing but an edit changes the
    /// colour: what it shows in bytes is not what it is.
    pub(super) fn swatch_ui(&self, ui: &mut Ui, color: &mut Rgb) -> Edit {
        let before = *color;
        let mut edit = Edit::default();
        let response = swatch_ui(ui, &self.name, *color);
        let id = response.id;
        self.menu_ui(&response, color, &mut edit);
        let popup = Popup::menu(&response).id(id.with("picker"));
        let popup = popup.close_behavior(PopupCloseBehavior::CloseOnClickOutside);
        popup.show(|ui| edit.join(picker_ui(ui, id, self, color)));
        response.on_hover_ui(|ui| {
            (self.about)(ui);
            ui.weak(format!("{} · linear {}", hex(before), rgb_text(before)));
            ui.weak("click to pick, right-click to copy and paste");
        });
        edit.changed = *color != before;
        edit
    }

    /// What a hexadecimal text makes of a colour: one that shows these bytes already stays as it is.
    pub(super) fn take_bytes(&self, wanted: [u8; 3], color: &mut Rgb) {
        if bytes(*color) != wanted {
            *color = of_bytes(wanted);
        }
    }

    fn menu_ui(&self, response: &Response, color: &mut Rgb, edit: &mut Edit) {
        let has_keyboard = response.has_focus();
        let ctx = &response.ctx;
        if has_keyboard && clipboard::is_copied(ctx) {
            ctx.copy_text(hex(*color));
        }
        if let Some(text) = clipboard::pasted(ctx, response.id, has_keyboard) {
            match (read_hex(&text), rgb_of(&text)) {
                (Some(wanted), _) => self.take_bytes(wanted, color),
                (None, Some(wanted)) => *color = self.within(wanted),
                (None, None) => edit.refused = Some(refusal(&text, "colour")),
            }
        }
        let id = response.id;
        response.context_menu(|ui| {
            let menu = Menu {
                copied: &[
                    ("Copy colour", "As #rrggbb: what it shows on the screen"),
                    ("Copy linear colour", "As the scene file writes it, with all its digits"),
                ],
                paste: ("Paste colour", "Takes #rrggbb, #rgb, or [r, g, b] of linear light"),
                saved: self.saved.map(hex),
                default: (self.default)().map(|default| (hex(default), default)),
            };
            match menu_ui(ui, &menu, |default| default == *color) {
                Some(Choice::Copy(0)) => ui.copy_text(hex(*color)),
                Some(Choice::Copy(_)) => ui.copy_text(rgb_text(*color)),
                Some(Choice::Paste) => clipboard::ask(ui.ctx(), id),
                Some(Choice::Saved) => *color = self.saved.unwrap_or(*color),
                Some(Choice::Default(default)) => *color = default,
                None => {}
            }
        });
    }

    fn within(&self, color: Rgb) -> Rgb {
        color.map(|channel| self.range.clamp(f64::from(channel)) as f32)
    }
}

/// `[r, g, b]` or a number, of linear light.
fn rgb_of(text: &str) -> Option<Rgb> {
    let text = text.trim();
    let inside = text.strip_prefix('[').and_then(|text| text.strip_suffix(']')).unwrap_or(text);
    let channels: Option<Vec<f32>> =
        inside.split(',').map(|part| part.trim().parse().ok()).collect();
    let color = match channels?.as_slice() {
        [grey] => Rgb::grey(*grey),
        [r, g, b] => Rgb([*r, *g, *b]),
        _ => return None,
    };
    color.0.iter().all(|channel| channel.is_finite()).then_some(color)
}

/// A button in the colour that the film shows for linear light.
fn swatch_ui(ui: &mut Ui, name: &str, color: Rgb) -> Response {
    let (rect, response) = ui.allocate_exact_size(ui.spacing().interact_size, Sense::click());
    response.widget_info(|| {
        let mut info = WidgetInfo::labeled(Role::ColorWell, true, name);
        info.current_text_value = Some(hex(color));
        info
    });
    if ui.is_rect_visible(rect) {
        let visuals = ui.style().interact(&response);
        paint_swatch(ui, rect, color, visuals.fg_stroke.color);
    }
    response
}

/// A patch of a colour, with a line around it.
pub(super) fn paint_swatch(ui: &Ui, rect: Rect, color: Rgb, line: Color32) {
    let corner = CornerRadius::same(2);
    ui.painter().rect_filled(rect, corner, shown(color));
    let stroke = Stroke::new(1.0, line.gamma_multiply(0.5));
    ui.painter().rect_stroke(rect, corner, stroke, StrokeKind::Inside);
}

/// What the picker remembers of a colour as long as it is open.
pub(super) fn memory_of(swatch: Id) -> Id {
    swatch.with("picked")
}

/// Width of the picker's areas, in points.
pub(super) const PICKER: f32 = 230.0;

/// The size of the field of saturation and value.
pub(super) fn area_size() -> eframe::egui::Vec2 {
    vec2(PICKER, 150.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn field() -> ColorField<'static> {
        ColorField {
            name: "color".into(),
            range: crate::scene::fields::COEFFICIENT,
            saved: None,
            default: Box::new(|| None),
            kelvin: false,
            about: Box::new(|_| {}),
        }
    }

    #[test]
    fn bytes_that_show_already_change_no_bit() {
        let mut color = Rgb([0.123_456_7, 0.5, 2.5]);
        let before = color;
        field().take_bytes(bytes(color), &mut color);
        assert_eq!(color, before);
        field().take_bytes([1, 2, 3], &mut color);
        assert_eq!(bytes(color), [1, 2, 3]);
    }

    #[test]
    fn linear_colours_are_read_as_the_scene_file_writes_them() {
        let color = Rgb([0.1, 1.0 / 3.0, 2.5]);
        assert_eq!(rgb_of(&rgb_text(color)), Some(color));
        assert_eq!(rgb_of(" 0.5 "), Some(Rgb::grey(0.5)));
        for text in ["", "[1, 2]", "[a, b, c]", "nan", "[1, 2, inf]", "1 2 3"] {
            assert_eq!(rgb_of(text), None, "{text}");
        }
    }
}
