//! A pixel's tree as indented lines: swatch, name, weight, and a bar of the share.

use eframe::egui::{
    Align, Align2, Button, Color32, FontId, Layout, Rect, Response, ScrollArea, Sense, Stroke,
    StrokeKind, TextStyle, TextWrapMode, Ui, UiBuilder, vec2,
};

use super::inspector::Selection;
use super::panels::LINE;
use super::pixel::Face;
use super::pixel_lines::{Line, Target};
use crate::scene::Scene;
use crate::session::inspect::Share;

/// Width of a bar in points.
const BAR: f32 = 64.0;
/// Width of the numbers beside it.
const NUMBER: f32 = 54.0;
/// What a level is indented by.
const INDENT: f32 = 14.0;
/// Deeper lines are not indented more.
const DEEPEST: usize = 12;

/// What the person did with the lines.
#[derive(Debug, Default)]
pub(super) struct RowsOutcome {
    pub(super) clicked: Option<Target>,
    /// Index of the line under the pointer.
    pub(super) hovered: Option<usize>,
}

/// Shows the lines; only those that are visible are drawn. Lines of what is selected are marked.
pub(super) fn rows_ui(
    ui: &mut Ui,
    face: &Face,
    scene: &Scene,
    selection: Selection,
) -> RowsOutcome {
    let mut outcome = RowsOutcome::default();
    ui.spacing_mut().item_spacing.y = 1.0;
    let width = ui.available_width();
    columns_ui(ui, width);
    let height = ui.spacing().interact_size.y;
    let tree = ScrollArea::vertical().id_salt("tree of the pixel").auto_shrink(false);
    tree.min_scrolled_height(LINE).show_rows(ui, height, face.lines.len(), |ui, range| {
        for i in range {
            let line = &face.lines[i];
            let chosen = |target: Target| {
                let itself = matches!(selection, Selection::Solid(_));
                target.selection(&face.tree.scene, scene, itself) == Some(selection)
            };
            let selected = line.target.is_some_and(chosen);
            let (clicked, hovered) = row_ui(ui, line, face.whole, selected);
            if clicked {
                outcome.clicked = line.target;
            }
            if hovered {
                outcome.hovered = Some(i);
            }
        }
    });
    outcome
}

/// What the columns are.
fn columns_ui(ui: &mut Ui, width: f32) {
    let (rect, _) = ui.allocate_exact_size(vec2(width, 15.0), Sense::hover());
    let (font, color) = (TextStyle::Small.resolve(ui.style()), ui.visuals().weak_text_color());
    let right = rect.right() - SCROLL;
    let text = |x: f32, align: Align2, text: &str| {
        ui.painter().text([x, rect.center().y].into(), align, text, font.clone(), color);
    };
    text(rect.left(), Align2::LEFT_CENTER, "ray → what it met");
    text(right - BAR - NUMBER - 12.0, Align2::RIGHT_CENTER, "weight");
    text(right - BAR - 6.0, Align2::RIGHT_CENTER, "share");
}

/// Room for the scroll bar.
const SCROLL: f32 = 14.0;

/// Shows one line; whether it was clicked, and whether the pointer is on it.
fn row_ui(ui: &mut Ui, line: &Line, whole: f64, selected: bool) -> (bool, bool) {
    ui.horizontal(|ui| {
        let full = ui.available_width() - SCROLL;
        let left = ui.min_rect().left();
        ui.add_space(line.depth.min(DEEPEST) as f32 * INDENT);
        swatch_ui(ui, line.color);
        let right = left + full;
        let room = right - BAR - 2.0 * NUMBER - 18.0 - ui.cursor().left();
        let button = Button::selectable(selected, &line.text);
        let (place, response) = named_ui(ui, room.max(60.0), button);
        let response = response.on_hover_text(&line.about);
        numbers(ui, line, whole, (right, place.center().y));
        let line = place.with_max_x(right).expand2(vec2(0.0, 1.0));
        let over = ui.rect_contains_pointer(line) || response.hovered() || response.has_focus();
        (response.clicked(), over)
    })
    .inner
}

/// What a line or a bar is called, at the left end of a space of this width.
pub(super) fn named_ui(ui: &mut Ui, width: f32, button: Button<'_>) -> (Rect, Response) {
    let height = ui.spacing().interact_size.y;
    let (place, _) = ui.allocate_exact_size(vec2(width, height), Sense::hover());
    let from_left = Layout::left_to_right(Align::Center);
    let mut inside = ui.new_child(UiBuilder::new().max_rect(place).layout(from_left));
    (place, inside.add(button.wrap_mode(TextWrapMode::Truncate)))
}

/// Weight, share and bar, at the right end of a line.
fn numbers(ui: &Ui, line: &Line, whole: f64, (right, y): (f32, f32)) {
    let font = FontId::monospace(11.5);
    let text = |x: f32, text: String, color: Color32| {
        ui.painter().text([x, y].into(), Align2::RIGHT_CENTER, text, font.clone(), color);
    };
    if let Some(weight) = line.weight {
        let [r, g, b] = weight.0.map(f64::from);
        let mean = Share([r, g, b]).luminance();
        let color = ui.visuals().weak_text_color();
        text(right - BAR - NUMBER - 12.0, format!("{mean:.3}"), color);
    }
    let Some(share) = line.share else { return };
    let part = part_of(share, whole);
    text(right - BAR - 6.0, percent(part), ui.visuals().text_color());
    let bar = Rect::from_min_size([right - BAR, y - 5.0].into(), vec2(BAR, 10.0));
    bar_at(ui, bar, part);
}

/// A part of a whole, 0 of nothing.
pub(super) fn part_of(share: Share, whole: f64) -> f64 {
    if whole > 0.0 { share.luminance() / whole } else { 0.0 }
}

pub(super) fn percent(part: f64) -> String {
    format!("{:.1} %", part * 100.0)
}

/// A bar that is full at 1.
pub(super) fn bar_at(ui: &Ui, rect: Rect, part: f64) {
    let painter = ui.painter();
    painter.rect_filled(rect, 2.0, ui.visuals().widgets.inactive.bg_fill.gamma_multiply(0.6));
    let mut filled = rect;
    filled.set_width(rect.width() * part.clamp(0.0, 1.0) as f32);
    painter.rect_filled(filled, 2.0, Color32::from_rgb(0x3a, 0x86, 0xc8));
}

/// A small square of colour; the place of one, of what has none.
pub(super) fn swatch_ui(ui: &mut Ui, color: Color32) {
    let height = ui.spacing().interact_size.y;
    let (rect, _) = ui.allocate_exact_size(vec2(10.0, height), Sense::hover());
    if color == Color32::TRANSPARENT {
        return;
    }
    let square = Rect::from_center_size(rect.center(), vec2(10.0, 10.0));
    ui.painter().rect_filled(square, 2.0, color);
    let outline = Stroke::new(1.0, ui.visuals().weak_text_color());
    ui.painter().rect_stroke(square, 2.0, outline, StrokeKind::Inside);
}
