//! What a swatch opens: areas of hue, saturation and value, and the colour in several notations.

use eframe::egui::{
    Color32, Grid, Id, Key, Mesh, Rect, Response, Role, Sense, Shape, Stroke, TextEdit, Ui, Vec2,
    WidgetInfo, pos2, vec2,
};

use super::color_field::{ColorField, PICKER, area_size, memory_of, paint_swatch};
use super::hints::Scale;
use super::kelvin::Kelvin;
use super::number::{Edit, FIELD, Face, Number, Precision};
use super::outline::shown;
use crate::color::Rgb;
use crate::color::notation::{Hsv, hex, read_hex};
use crate::scene::range::Range;

/// Cells of the area of saturation and value along a side: colours between are mixed by the painter.
const CELLS: usize = 16;

/// Hue, saturation and value with the colour that came of them: as long as the scene has that colour,
/// they are kept, so that a grey does not forget its hue.
#[derive(Clone, Copy, Debug)]
struct Picked {
    hsv: Hsv,
    color: Rgb,
}

/// Shows the picker of a swatch and writes into `color` what is picked, and nothing else.
pub(super) fn picker_ui(ui: &mut Ui, swatch: Id, field: &ColorField<'_>, color: &mut Rgb) -> Edit {
    ui.set_width(PICKER);
    ui.spacing_mut().interact_size.y = 20.0;
    let mut edit = Edit::default();
    let name = field.name.as_str();
    // A colour brighter than white is picked as if it were not, and keeps its strength.
    let strength = color.max_channel().max(1.0);
    let known = ui.data(|data| data.get_temp::<Picked>(memory_of(swatch)));
    let known = known.filter(|known| known.color == *color);
    let before = known.map_or_else(|| Hsv::of(*color * (1.0 / strength)), |known| known.hsv);
    let mut hsv = before;
    area_ui(ui, name, &mut hsv);
    hue_ui(ui, name, &mut hsv);
    hex_ui(ui, field, color);
    if strength > 1.0 {
        ui.weak(format!("brighter than white: {strength:.3} times what is picked"));
    }
    Grid::new("notations").spacing(vec2(6.0, 4.0)).show(ui, |ui| {
        edit.join(hsv_ui(ui, name, &mut hsv));
        ui.end_row();
        edit.join(linear_ui(ui, field, color));
        ui.end_row();
    });
    if field.kelvin {
        edit.join(kelvin_ui(ui, name, color));
    }
    if hsv != before {
        *color = hsv.rgb() * strength;
        let picked = Picked { hsv, color: *color };
        ui.data_mut(|data| data.insert_temp(memory_of(swatch), picked));
    }
    edit
}

/// The area of saturation, to the right, and value, upwards.
fn area_ui(ui: &mut Ui, name: &str, hsv: &mut Hsv) {
    let response = sensor_ui(ui, area_size(), format!("saturation and value of {name}"));
    let rect = response.rect;
    if let Some([x, y]) = held(&response) {
        (hsv.saturation, hsv.value) = (x, 1.0 - y);
    }
    let mut mesh = Mesh::default();
    let share = |i: usize| i as f64 / CELLS as f64;
    for row in 0..=CELLS {
        for column in 0..=CELLS {
            let (x, y) = (share(column), share(row));
            let color = Hsv { saturation: x, value: 1.0 - y, ..*hsv };
            mesh.colored_vertex(rect.lerp_inside(vec2(x as f32, y as f32)), coded(color));
        }
    }
    for row in 0..CELLS {
        for column in 0..CELLS {
            let corner = (row * (CELLS + 1) + column) as u32;
            let below = corner + CELLS as u32 + 1;
            mesh.add_triangle(corner, corner + 1, below);
            mesh.add_triangle(corner + 1, below, below + 1);
        }
    }
    ui.painter().add(Shape::mesh(mesh));
    let at = rect.lerp_inside(vec2(hsv.saturation as f32, 1.0 - hsv.value as f32));
    let ring =
        if hsv.value > 0.6 && hsv.saturation < 0.6 { Color32::BLACK } else { Color32::WHITE };
    ui.painter().circle(at, 5.0, coded(*hsv), Stroke::new(1.5, ring));
    response.on_hover_text("Saturation to the right, value upwards: press and drag");
}

/// The bar of hues.
fn hue_ui(ui: &mut Ui, name: &str, hsv: &mut Hsv) {
    let response = sensor_ui(ui, vec2(PICKER, 18.0), format!("hue of {name}"));
    let rect = response.rect;
    if let Some([x, _]) = held(&response) {
        // The right end is red again, as the left end is.
        hsv.hue = x.min(0.999_999);
    }
    let mut mesh = Mesh::default();
    for i in 0..=6u32 {
        let x = i as f32 / 6.0;
        let color = coded(Hsv { hue: f64::from(x), saturation: 1.0, value: 1.0 });
        mesh.colored_vertex(rect.lerp_inside(vec2(x, 0.0)), color);
        mesh.colored_vertex(rect.lerp_inside(vec2(x, 1.0)), color);
        if i > 0 {
            mesh.add_triangle(2 * i - 2, 2 * i - 1, 2 * i);
            mesh.add_triangle(2 * i - 1, 2 * i, 2 * i + 1);
        }
    }
    ui.painter().add(Shape::mesh(mesh));
    let x = rect.left() + rect.width() * hsv.hue as f32;
    let mark = Rect::from_min_max(pos2(x - 2.0, rect.top()), pos2(x + 2.0, rect.bottom()));
    let stroke = Stroke::new(1.5, Color32::BLACK);
    ui.painter().rect(mark, 1.0, Color32::WHITE, stroke, eframe::egui::StrokeKind::Outside);
    response.on_hover_text("Hue: press and drag");
}

/// Space that is pressed and dragged in.
fn sensor_ui(ui: &mut Ui, size: Vec2, name: String) -> Response {
    let (_, response) = ui.allocate_exact_size(size, Sense::click_and_drag());
    response.widget_info(|| WidgetInfo::labeled(Role::Slider, true, &name));
    response
}

/// Where the pointer holds an area, as shares of its width and height.
fn held(response: &Response) -> Option<[f64; 2]> {
    let is_held = response.is_pointer_button_down_on() || response.clicked() || response.dragged();
    let at = response.interact_pointer_pos().filter(|_| is_held)?;
    let share = (at - response.rect.min) / response.rect.size();
    Some([share.x, share.y].map(|x| f64::from(x).clamp(0.0, 1.0)))
}

/// The field of `#rrggbb` beside the colour itself.
fn hex_ui(ui: &mut Ui, field: &ColorField<'_>, color: &mut Rgb) {
    ui.horizontal(|ui| {
        let (rect, _) = ui.allocate_exact_size(vec2(60.0, 20.0), Sense::hover());
        let line = ui.visuals().text_color();
        paint_swatch(ui, rect, *color, line);
        ui.label("sRGB");
        let id = ui.next_auto_id().with("hex");
        let typing = ui.data(|data| data.get_temp::<String>(id));
        let mut text = typing.unwrap_or_else(|| hex(*color));
        let edit = TextEdit::singleline(&mut text).desired_width(80.0).char_limit(16);
        let response = ui.add(edit).accessible_name(format!("hex of {}", field.name));
        if response.lost_focus() {
            let is_kept = ui.input(|input| input.key_pressed(Key::Escape));
            if let Some(wanted) = read_hex(&text).filter(|_| !is_kept) {
                field.take_bytes(wanted, color);
            }
        }
        let has_keyboard = response.has_focus();
        ui.data_mut(|data| {
            data.remove::<String>(id);
            if has_keyboard {
                data.insert_temp(id, text);
            }
        });
        let about = "The colour on the screen: #rrggbb, rrggbb, #rgb or rgb; Enter takes it";
        response.on_hover_text(about);
    });
}

/// Hue in degrees, saturation and value in per cent.
fn hsv_ui(ui: &mut Ui, name: &str, hsv: &mut Hsv) -> Edit {
    let mut edit = Edit::default();
    let Hsv { hue, saturation, value } = hsv;
    let parts = [("H", "hue", hue, 360.0), ("S", "saturation", saturation, 100.0)];
    for (letter, what, part, whole) in parts.into_iter().chain([("V", "value", value, 100.0)]) {
        ui.label(letter);
        let about = match what {
            "hue" => "Hue in degrees: 0 red, 120 green, 240 blue",
            "saturation" => "Saturation in per cent: 0 grey, 100 pure",
            _ => "Value in per cent: the largest of the three sRGB channels",
        };
        let number = plain(format!("{what} of {name}"), Range::closed(0.0, whole), about);
        let mut shown = *part * whole;
        let done = number.field_ui(ui, &mut shown, FIELD);
        if done.changed {
            *part = (shown / whole).min(if what == "hue" { 0.999_999 } else { 1.0 });
        }
        edit.join(done);
    }
    edit
}

/// Red, green and blue of linear light.
fn linear_ui(ui: &mut Ui, field: &ColorField<'_>, color: &mut Rgb) -> Edit {
    let mut edit = Edit::default();
    for (channel, (letter, what)) in
        color.0.iter_mut().zip([("R", "red"), ("G", "green"), ("B", "blue")])
    {
        ui.label(letter);
        let about = "Linear light, Rec. 709: 1 is white; what the scene file holds";
        let number = plain(format!("{what} of {}", field.name), field.range, about);
        let mut wide = f64::from(*channel);
        let done = number.field_ui(ui, &mut wide, FIELD);
        if done.changed {
            *channel = wide as f32;
        }
        edit.join(done);
    }
    edit
}

fn kelvin_ui(ui: &mut Ui, name: &str, color: &mut Rgb) -> Edit {
    ui.horizontal(|ui| {
        let mut kelvin = Kelvin::of(*color, format!("kelvin of {name}"));
        let width = PICKER - 70.0 - ui.spacing().item_spacing.x;
        let mut edit = kelvin.slider_ui(ui, width);
        edit.join(kelvin.field_ui(ui, 70.0));
        if edit.changed {
            *color = kelvin.color();
        }
        edit
    })
    .inner
}

/// A field without saved value and default.
fn plain(name: String, range: Range, about: &'static str) -> Number<'static> {
    Number {
        name,
        bare: true,
        range,
        precision: Precision::Single,
        face: Face::Plain,
        scale: Scale { span: 0.0..=1.0, logarithmic: false },
        saved: None,
        default: Box::new(|| None),
        limits: Vec::new(),
        about: Box::new(move |ui| drop(ui.label(about))),
    }
}

/// A picked colour on the screen.
fn coded(hsv: Hsv) -> Color32 {
    shown(hsv.rgb())
}
