//! The choice of what kind of light a light is.

use std::collections::BTreeMap;

use eframe::egui::{ComboBox, Ui};

use super::badge::explanation;
use super::hints;
use crate::scene::path::join;
use crate::scene::{Light, LightPlace};
use crate::session::cost::Cost;

/// Lets a light become another kind, which costs what moving it costs; whether it did.
pub(super) fn kind_ui(ui: &mut Ui, light: &mut Light, costs: &BTreeMap<String, Cost>) -> bool {
    let before = light.place.kind();
    let mut chosen = before;
    ui.horizontal(|ui| {
        ui.label("kind");
        let combo = ComboBox::from_id_salt("kind of light").selected_text(before);
        let combo = combo.show_ui(ui, |ui| {
            for kind in LightPlace::KINDS {
                ui.selectable_value(&mut chosen, kind, kind).on_hover_text(hints::choice(kind));
            }
        });
        let path = join("lights", &light.name);
        let path = light.place.anchor_keys().iter().fold(path, |path, key| join(&path, key));
        let cost = explanation(costs.get(&path).copied());
        let about = format!("What kind of light it is. {cost}");
        combo.response.accessible_name("kind").on_hover_text(about);
    });
    if chosen != before {
        light.place = light.place.turned_into(chosen);
    }
    chosen != before
}
