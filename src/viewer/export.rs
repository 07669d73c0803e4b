//! What to export: format and size.

use std::path::Path;

use eframe::egui::{Checkbox, DragValue, Ui};

use super::number::typed;
use super::question::first;
use crate::film::plates::Region;
use crate::film::write::Format;
use crate::scene::MAX_SIDE;
use crate::session::layers::Extras;

/// Of the form in points, whatever it says.
const WIDTH: f32 = 560.0;

/// A picture file that is being asked for.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct ExportForm {
    format: Format,
    /// In pixels.
    pub(super) size: [u32; 2],
    /// The size of the picture shown.
    own_size: [u32; 2],
    alpha: bool,
    layers: bool,
    /// Whether only `region` is written.
    cut: bool,
    region: Region,
}

/// What the person decided.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ExportChoice {
    /// To choose a file.
    GoOn,
    /// Not to export.
    Cancel,
}

impl ExportForm {
    /// 8 bits at the picture's own size.
    pub(super) fn new(own_size: [u32; 2]) -> ExportForm {
        let region = Region { corner: [0, 0], size: own_size };
        let (alpha, layers, cut) = (false, false, false);
        ExportForm { format: Format::Png8, size: own_size, own_size, alpha, layers, cut, region }
    }

    /// What else the file shall hold, in the format that its name asks for.
    pub(super) fn extras(&self, format: Format) -> Extras {
        Extras {
            alpha: self.alpha && format.holds_alpha(),
            layers: self.layers && format == Format::Exr,
            region: self.cut.then_some(self.region),
        }
    }

    /// How the name of the file ends.
    pub(super) fn ending(&self) -> &'static str {
        match self.format {
            Format::Png8 | Format::Png16 => "png",
            Format::Exr => "exr",
            Format::Hdr => "hdr",
        }
    }

    /// The format for a file: its name has the last word.
    pub(super) fn format_for(&self, path: &Path) -> Result<Format, String> {
        Format::of(path, self.format == Format::Png16).map_err(|e| e.to_string())
    }

    /// Shows the form.
    pub(super) fn ui(&mut self, ui: &mut Ui) -> Option<ExportChoice> {
        ui.set_width(WIDTH);
        ui.heading("Export the picture");
        ui.horizontal(|ui| {
            for (format, name, about) in [
                (Format::Png8, "PNG, 8 bits", "As shown, sRGB: for screens and the web"),
                (Format::Png16, "PNG, 16 bits", "As shown, sRGB, in fine steps"),
                (Format::Exr, "OpenEXR", "Linear light before exposure, 32-bit floats"),
                (
                    Format::Hdr,
                    "Radiance HDR",
                    "Linear light before exposure, small, exact to 1/128",
                ),
            ] {
                ui.radio_value(&mut self.format, format, name).on_hover_text(about);
            }
        });
        ui.horizontal(|ui| {
            ui.label("Size");
            for (side, name) in self.size.iter_mut().zip(["width", "height"]) {
                let field = DragValue::new(side).range(1..=MAX_SIDE).custom_parser(typed);
                let field = field.update_while_editing(false);
                let response = ui.add(field).accessible_name(format!("export {name}"));
                response.on_hover_text("In pixels");
            }
            if ui.button("As shown").on_hover_text("The size of the picture").clicked() {
                self.size = self.own_size;
            }
        });
        self.extras_ui(ui);
        let own = self.size == self.own_size && !self.alpha && !self.cut;
        let linear = matches!(self.format, Format::Exr | Format::Hdr);
        ui.weak(if own && linear {
            "The file holds the light of the picture shown, without exposure and tone, and its scene: \
             opening the picture opens the scene."
        } else if own {
            "The file holds exactly the bytes of the picture shown, and its scene: opening the \
             picture opens the scene."
        } else if self.size == self.own_size {
            "No ray is cast. The file holds its scene, too: opening the picture opens the scene."
        } else {
            "Another size is traced anew; the window stays usable meanwhile."
        });
        let mut choice = None;
        ui.horizontal(|ui| {
            let go_on = ui.button("Choose file…").on_hover_text("Asks where to write it");
            first(ui, &go_on);
            if go_on.clicked() {
                choice = Some(ExportChoice::GoOn);
            }
            if ui.button("Cancel").on_hover_text("Writes nothing").clicked() {
                choice = Some(ExportChoice::Cancel);
            }
        });
        choice
    }

    fn extras_ui(&mut self, ui: &mut Ui) {
        ui.horizontal(|ui| {
            let about = "Leaves out the background that the eye sees, and writes how much of each \
                         pixel is covered";
            let alpha = Checkbox::new(&mut self.alpha, "Transparent background");
            let response = ui.add_enabled(self.format.holds_alpha(), alpha);
            response.on_hover_text(about).on_disabled_hover_text("Radiance holds no coverage");
            let layers = Checkbox::new(&mut self.layers, "Layers");
            let about = "A layer per light, per material and per bounce, in one OpenEXR file";
            let response = ui.add_enabled(self.format == Format::Exr, layers);
            response.on_hover_text(about).on_disabled_hover_text("OpenEXR alone holds layers");
        });
        ui.horizontal(|ui| {
            let about = "Writes a part of the picture alone";
            ui.checkbox(&mut self.cut, "Region").on_hover_text(about);
            let Region { corner: [left, top], size: [width, height] } = &mut self.region;
            let [whole_width, whole_height] = self.size;
            for (value, most, name) in [
                (left, whole_width, "left"),
                (top, whole_height, "top"),
                (width, whole_width, "width"),
                (height, whole_height, "height"),
            ] {
                let least = u32::from(name == "width" || name == "height");
                let field = DragValue::new(value).range(least..=most).custom_parser(typed);
                let response = ui.add_enabled(self.cut, field.update_while_editing(false));
                let response = response.accessible_name(format!("region {name}"));
                let about = "In pixels of the picture, from its upper left";
                response.on_hover_text(about).on_disabled_hover_text("Tick Region first");
            }
        });
        if self.cut
            && let Err(wrong) = self.region.check(self.size)
        {
            ui.colored_label(ui.visuals().error_fg_color, wrong);
        }
    }
}
