//! What to export: format and size.

use std::path::Path;

use eframe::egui::{DragValue, Ui};

use super::control::typed;
use crate::film::write::Format;
use crate::scene::MAX_SIDE;

/// A picture file that is being asked for.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct ExportForm {
    format: Format,
    /// In pixels.
    pub(super) size: [u32; 2],
    /// The size of the picture shown.
    own_size: [u32; 2],
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
        ExportForm { format: Format::Png8, size: own_size, own_size }
    }

    /// How the name of the file ends.
    pub(super) fn ending(&self) -> &'static str {
        match self.format {
            Format::Png8 | Format::Png16 => "png",
            Format::Exr => "exr",
        }
    }

    /// The format for a file: its name has the last word.
    pub(super) fn format_for(&self, path: &Path) -> Result<Format, String> {
        Format::of(path, self.format == Format::Png16).map_err(|e| e.to_string())
    }

    /// Shows the form.
    pub(super) fn ui(&mut self, ui: &mut Ui) -> Option<ExportChoice> {
        ui.heading("Export the picture");
        ui.horizontal(|ui| {
            for (format, name, about) in [
                (Format::Png8, "PNG, 8 bits", "As shown, sRGB: for screens and the web"),
                (Format::Png16, "PNG, 16 bits", "As shown, sRGB, in fine steps"),
                (Format::Exr, "OpenEXR", "Linear light before exposure, 32-bit floats"),
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
        let own = self.size == self.own_size;
        ui.weak(if own {
            "The file holds exactly the bytes of the picture shown."
        } else {
            "Another size is traced anew; the window stays usable meanwhile."
        });
        let mut choice = None;
        ui.horizontal(|ui| {
            if ui.button("Choose file…").on_hover_text("Asks where to write it").clicked() {
                choice = Some(ExportChoice::GoOn);
            }
            if ui.button("Cancel").on_hover_text("Writes nothing").clicked() {
                choice = Some(ExportChoice::Cancel);
            }
        });
        choice
    }
}
