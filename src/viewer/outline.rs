//! The scene as a list: what is in it, and what is selected.

use eframe::egui::{CollapsingHeader, Color32, Rgba, ScrollArea, Sense, Stroke, Ui, vec2};

use super::inspector::Selection;
use crate::color::Rgb;
use crate::scene::{Light, Material, Paint, Scene};

/// Shows the lists; gives another selection if one was made.
pub(super) fn outline_ui(ui: &mut Ui, scene: &Scene, selected: Selection) -> Option<Selection> {
    let mut chosen = None;
    ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
        ui.add_space(4.0);
        let whole = ui.selectable_label(selected == Selection::Scene, "Scene");
        let about = "Picture size and exposure, camera, tracing, background";
        if whole.on_hover_text(about).clicked() {
            chosen = Some(Selection::Scene);
        }
        list_ui(ui, "Materials", scene.materials.len(), |ui, i| {
            let material = &scene.materials[i];
            let is_selected = selected == Selection::Material(i);
            let about = "Shows this material; or click its surface in the picture";
            if row_ui(ui, &material.name, about, is_selected, swatch(material)) {
                chosen = Some(Selection::Material(i));
            }
        });
        list_ui(ui, "Lights", scene.lights.len(), |ui, i| {
            let light = &scene.lights[i];
            let is_selected = selected == Selection::Light(i);
            if row_ui(ui, &light.name, "Shows this light", is_selected, lamp(light)) {
                chosen = Some(Selection::Light(i));
            }
        });
        list_ui(ui, "Solids", scene.solids.len(), |ui, i| {
            let solid = &scene.solids[i];
            let is_selected = selected == Selection::Solid(i);
            let color = swatch(&scene.materials[solid.material]);
            let about = "Shows this solid; or click it in the picture with Alt";
            if row_ui(ui, &solid.name, about, is_selected, color) {
                chosen = Some(Selection::Solid(i));
            }
        });
    });
    chosen
}

fn list_ui(ui: &mut Ui, title: &str, count: usize, mut row: impl FnMut(&mut Ui, usize)) {
    let header = CollapsingHeader::new(title).default_open(true);
    let header = header.show(ui, |ui| {
        if count == 0 {
            ui.weak("none");
        }
        for i in 0..count {
            row(ui, i);
        }
    });
    header.header_response.on_hover_text("Click to open or close the list");
}

/// A named line with a spot of colour; whether it was clicked.
fn row_ui(ui: &mut Ui, name: &str, about: &str, selected: bool, color: Color32) -> bool {
    ui.horizontal(|ui| {
        let height = ui.spacing().interact_size.y;
        let (rect, _) = ui.allocate_exact_size(vec2(10.0, height), Sense::hover());
        let outline = Stroke::new(1.0, ui.visuals().weak_text_color());
        ui.painter().circle(rect.center(), 5.0, color, outline);
        ui.selectable_label(selected, name).on_hover_text(about).clicked()
    })
    .inner
}

/// The colour that stands for a material: what it is seen by most.
fn swatch(material: &Material) -> Color32 {
    let color = match material.paint {
        Paint::Solid(color) => color,
        Paint::Checker { a, b, size: _ } => (a + b) * 0.5,
    };
    let glass = material.transmit.max_channel() > 0.5;
    shown(if glass { material.filter } else { color })
}

fn lamp(light: &Light) -> Color32 {
    if light.on { shown(light.color) } else { Color32::TRANSPARENT }
}

fn shown(Rgb([r, g, b]): Rgb) -> Color32 {
    Color32::from(Rgba::from_rgb(r.min(1.0), g.min(1.0), b.min(1.0)))
}
