//! The temperature of a colour as a number: a slider and a field that give the colour of a glowing body.

use eframe::egui::Ui;

use super::hints::Scale;
use super::number::{Edit, Face, Number, Precision};
use crate::color::{self, Rgb, blackbody, temperature};
use crate::scene::range::Range;

/// Daylight: where the slider stands for a colour without a temperature.
const DAYLIGHT: f64 = 6504.0;

/// The temperature of one colour.
pub(super) struct Kelvin {
    number: Number<'static>,
    present: Option<f64>,
    wanted: f64,
}

impl Kelvin {
    /// Of a colour; `name` is the control's accessible name.
    pub(super) fn of(color: Rgb, name: String) -> Kelvin {
        let present = temperature(color);
        let about = match present {
            Some(_) => {
                "Temperature of the glowing body with the nearest colour; gives the light that colour"
            }
            None => "No glowing body has this colour; a temperature gives the light another one",
        };
        let number = Number {
            name,
            bare: false,
            range: Range::closed(*color::KELVINS.start(), *color::KELVINS.end()),
            precision: Precision::Whole,
            face: Face::Kelvin(present.is_none().then_some(DAYLIGHT)),
            scale: Scale { span: color::KELVINS, logarithmic: true },
            saved: None,
            default: Box::new(|| Some(DAYLIGHT)),
            limits: Vec::new(),
            about: Box::new(move |ui| drop(ui.label(about))),
        };
        Kelvin { number, present, wanted: present.unwrap_or(DAYLIGHT) }
    }

    /// The slider.
    pub(super) fn slider_ui(&mut self, ui: &mut Ui, width: f32) -> Edit {
        if self.present.is_none() {
            ui.multiply_opacity(0.35);
        }
        self.number.slider_ui(ui, &mut self.wanted, width)
    }

    /// The field.
    pub(super) fn field_ui(&mut self, ui: &mut Ui, width: f32) -> Edit {
        self.number.field_ui(ui, &mut self.wanted, width)
    }

    /// The colour of the temperature that was wanted.
    pub(super) fn color(&self) -> Rgb {
        blackbody(self.wanted.round())
    }
}
