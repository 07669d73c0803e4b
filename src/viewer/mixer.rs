//! The light mixer: one line per light with switch, solo, strength, colour and temperature.

use std::collections::BTreeMap;
use std::ops::Range;

use eframe::egui::{Align, Button, Checkbox, Layout, Rect, ScrollArea, Sense, Ui, UiBuilder, vec2};

use super::badge::badge_ui;
use super::color_field::ColorField;
use super::hints::Scale;
use super::inspector::Selection;
use super::kelvin::Kelvin;
use super::number::{Edit, Face, Number, Precision};
use super::panels::LINE;
use crate::color::Rgb;
use crate::scene::fields::COEFFICIENT;
use crate::scene::path::join;
use crate::scene::range::Range as Limits;
use crate::scene::{Light, Scene};
use crate::session::cost::Cost;

/// Stops that the slider covers; typed values may lie outside.
const STOPS: [f64; 2] = [-10.0, 6.0];
/// What counts as dark: the least strength in stops.
const DARKEST: f64 = -24.0;
/// The strength of the largest intensity that a scene may hold, in stops.
const BRIGHTEST: f64 = 20.0;
/// Least widths of the columns in points: switch, solo, name, stops, their number, colour,
/// temperature, its number, cost.
const COLUMNS: [f32; 9] = [22.0, 26.0, 110.0, 120.0, 64.0, 40.0, 120.0, 70.0, 108.0];
/// The columns of the sliders, which share the space that is left.
const SLIDERS: [usize; 2] = [3, 6];
/// What a slider takes at most, in points.
const WIDEST: f32 = 320.0;

/// What the mixer remembers from turn to turn.
#[derive(Default)]
pub(super) struct Mixer {
    /// Whether it shows.
    pub(super) open: bool,
    solo: Option<Solo>,
    /// The lights whose lines show.
    visible: Range<usize>,
}

/// What the mixer reads besides the lights.
pub(super) struct MixerKnown<'a> {
    /// Costs by path.
    pub(super) costs: &'a BTreeMap<String, Cost>,
    /// The scene as opened or saved.
    pub(super) saved: &'a Scene,
}

/// What the person did in the mixer.
#[derive(Debug, Default)]
pub(super) struct MixerOutcome {
    /// A light was edited.
    pub(super) changed: bool,
    /// What else was done with sliders and fields.
    pub(super) edit: Edit,
    /// What the step is called, if it is more than it seems.
    pub(super) step: Option<String>,
    /// Another selection.
    pub(super) select: Option<Selection>,
    /// It was closed.
    pub(super) close: bool,
}

/// A light that shines alone, and which lights shone before.
#[derive(Clone, Debug, PartialEq)]
struct Solo {
    /// Index in `before`.
    light: usize,
    /// Name and switch of every light, in the order of the scene.
    before: Vec<(String, bool)>,
}

impl Solo {
    /// Lets one light shine alone.
    fn begin(lights: &mut [Light], light: usize) -> Solo {
        let before = lights.iter().map(|light| (light.name.clone(), light.on)).collect();
        shine_alone(lights, light);
        Solo { light, before }
    }

    /// The index in `before` of a light of today: by its place as long as there are as many lights,
    /// then by its name.
    fn index(&self, lights: &[Light], light: usize) -> Option<usize> {
        if lights.len() == self.before.len() {
            return Some(light);
        }
        self.before.iter().position(|(name, _)| *name == lights[light].name)
    }

    /// Whether this light shines alone because of it: not after an undo, nor if another was lit.
    fn holds(&self, lights: &[Light], light: usize) -> bool {
        self.index(lights, light) == Some(self.light)
            && lights.iter().enumerate().all(|(i, other)| other.on == (i == light))
    }

    /// Gives the lights back what they were; those that are new since stay as they are.
    fn end(self, lights: &mut [Light]) {
        for i in 0..lights.len() {
            if let Some(known) = self.index(lights, i) {
                lights[i].on = self.before[known].1;
            }
        }
    }
}

fn shine_alone(lights: &mut [Light], light: usize) {
    for (i, other) in lights.iter_mut().enumerate() {
        other.on = i == light;
    }
}

/// Strength of a light in stops: 0 if its largest channel is 1; `None` if it gives no light.
fn stops(intensity: Rgb) -> Option<f64> {
    let most = f64::from(intensity.max_channel());
    (most > 0.0).then(|| most.log2().max(DARKEST))
}

/// The intensity of a strength, its channels in the ratio of `intensity`; grey if that is black.
fn with_stops(intensity: Rgb, stops: f64) -> Rgb {
    let ratio = if intensity.is_black() { Rgb::WHITE } else { intensity };
    let most = stops.max(DARKEST).exp2().min(COEFFICIENT.high);
    let scale = most / f64::from(ratio.max_channel());
    ratio.map(|channel| (f64::from(channel) * scale) as f32)
}

impl Mixer {
    /// Forgets the lights of a scene that is no longer open.
    pub(super) fn forget(&mut self) {
        self.solo = None;
    }

    /// The parameters whose costs the mixer shows.
    pub(super) fn paths(&self, scene: &Scene) -> Vec<String> {
        if !self.open {
            return Vec::new();
        }
        let visible = scene.lights.get(self.visible.clone()).unwrap_or_default();
        visible.iter().flat_map(|light| KEYS.map(|key| path(light, key))).collect()
    }

    /// Shows a line per light, which writes into it.
    pub(super) fn ui(
        &mut self,
        ui: &mut Ui,
        lights: &mut [Light],
        known: &MixerKnown<'_>,
    ) -> MixerOutcome {
        let mut outcome = MixerOutcome::default();
        head_ui(ui, &mut outcome);
        if lights.is_empty() {
            ui.weak("The scene has no lights");
        }
        let height = ui.spacing().interact_size.y;
        let scroll = ScrollArea::both().auto_shrink(false).min_scrolled_height(LINE);
        let count = lights.len();
        scroll.show_rows(ui, height, count, |ui, range| {
            self.visible = range.clone();
            for i in range {
                ui.push_id(i, |ui| self.line_ui(ui, lights, i, known, &mut outcome));
            }
        });
        outcome
    }

    fn line_ui(
        &mut self,
        ui: &mut Ui,
        lights: &mut [Light],
        i: usize,
        known: &MixerKnown<'_>,
        outcome: &mut MixerOutcome,
    ) {
        let mut columns = Columns::of(ui);
        let name = lights[i].name.clone();
        columns.next(ui, |ui| {
            let switch = ui.add(Checkbox::without_text(&mut lights[i].on));
            let switch = switch.accessible_name(format!("{name} on"));
            outcome.changed |= switch.on_hover_text("Whether the light shines").changed();
        });
        columns.next(ui, |ui| self.solo_ui(ui, lights, i, outcome));
        let light = &mut lights[i];
        columns.next(ui, |ui| {
            let button = ui.add(Button::new(&name).frame(false).truncate());
            let button = button.on_hover_text("Shows this light's parameters");
            if button.accessible_name(format!("show {name}")).clicked() {
                outcome.select = Some(Selection::Light(i));
            }
        });
        let saved = known.saved.lights.iter().find(|saved| saved.name == name);
        let mut edit = stops_ui(ui, &mut columns, light, saved);
        edit.join(columns.next(ui, |ui| swatch_ui(ui, light, saved)));
        edit.join(kelvin_ui(ui, &mut columns, light));
        outcome.changed |= edit.changed;
        outcome.edit.join(edit);
        let cost = dearest(KEYS.map(|key| known.costs.get(&path(light, key)).copied()));
        columns.next(ui, |ui| badge_ui(ui, &name, cost, COLUMNS[8]));
    }

    fn solo_ui(&mut self, ui: &mut Ui, lights: &mut [Light], i: usize, outcome: &mut MixerOutcome) {
        let held = self.solo.as_ref().is_some_and(|solo| solo.holds(lights, i));
        let button = ui.add(Button::new("S").selected(held));
        let name = lights[i].name.clone();
        let about = "Solo: this light alone; once more gives the others back what they were";
        let button = button.accessible_name(format!("solo {name}")).on_hover_text(about);
        if !button.clicked() {
            return;
        }
        outcome.changed = true;
        if held && let Some(solo) = self.solo.take() {
            solo.end(lights);
            outcome.step = Some(format!("end of solo {name}"));
            return;
        }
        outcome.step = Some(format!("solo {name}"));
        let other = (0..lights.len())
            .find(|other| self.solo.as_ref().is_some_and(|solo| solo.holds(lights, *other)));
        match self.solo.take().filter(|_| other.is_some()) {
            // From solo to solo: what was before the first comes back in the end.
            Some(solo) => {
                let light = solo.index(lights, i);
                shine_alone(lights, i);
                self.solo = light.map(|light| Solo { light, ..solo });
            }
            None => self.solo = Some(Solo::begin(lights, i)),
        }
    }
}

/// What the mixer sets, as keys of a light.
const KEYS: [&str; 3] = ["on", "intensity", "color"];

fn path(light: &Light, key: &str) -> String {
    join(&join("lights", &light.name), key)
}

/// The cost of a line: known if all are, instant if all are.
fn dearest(costs: [Option<Cost>; 3]) -> Option<Cost> {
    let all: Option<Vec<Cost>> = costs.into_iter().collect();
    let all = all?;
    all.iter().copied().find(|cost| *cost != Cost::Instant).or(all.first().copied())
}

fn head_ui(ui: &mut Ui, outcome: &mut MixerOutcome) {
    ui.horizontal(|ui| {
        ui.strong("Light mixer");
        ui.weak("stops: 0 is intensity 1, each stop doubles; K: temperature of a glowing body");
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            let close = ui.small_button("Close").on_hover_text("Closes the light mixer");
            outcome.close |= close.accessible_name("Close the light mixer").clicked();
        });
    });
}

/// Cuts a line into columns.
struct Columns {
    rest: Rect,
    widths: std::array::IntoIter<f32, 9>,
}

impl Columns {
    fn of(ui: &mut Ui) -> Columns {
        let gaps = ui.spacing().item_spacing.x * (COLUMNS.len() - 1) as f32;
        let mut widths = COLUMNS;
        let spare = ui.available_width() - gaps - COLUMNS.iter().sum::<f32>();
        for slider in SLIDERS {
            let more = spare.max(0.0) / SLIDERS.len() as f32;
            widths[slider] = (widths[slider] + more).min(WIDEST);
        }
        let size = vec2(widths.iter().sum::<f32>() + gaps, ui.spacing().interact_size.y);
        let (rest, _) = ui.allocate_exact_size(size, Sense::hover());
        Columns { rest, widths: widths.into_iter() }
    }

    fn next<R>(&mut self, ui: &mut Ui, body: impl FnOnce(&mut Ui) -> R) -> R {
        let width = self.widths.next().unwrap_or(0.0);
        let column = self.rest.with_max_x(self.rest.left() + width);
        self.rest.min.x = column.right() + ui.spacing().item_spacing.x;
        let layout = Layout::left_to_right(Align::Center);
        body(&mut ui.new_child(UiBuilder::new().max_rect(column).layout(layout)))
    }
}

/// Slider and number of the strength.
fn stops_ui(ui: &mut Ui, columns: &mut Columns, light: &mut Light, saved: Option<&Light>) -> Edit {
    let present = stops(light.intensity);
    let before = present.unwrap_or(DARKEST);
    let (low, high) = (STOPS[0].min(before), STOPS[1].max(before));
    // A light without light stands at the lower end of the slider.
    let mut wanted = if present.is_some() { before } else { low };
    let was = saved.filter(|saved| saved.intensity != light.intensity);
    let number = Number {
        name: format!("{} stops", light.name),
        bare: false,
        range: Limits::closed(DARKEST, BRIGHTEST),
        precision: Precision::Double,
        face: Face::Stops(present.is_none().then_some(low)),
        scale: Scale { span: low..=high, logarithmic: false },
        saved: was.map(|saved| stops(saved.intensity).unwrap_or(DARKEST)),
        default: Box::new(|| Some(0.0)),
        limits: Vec::new(),
        about: Box::new(|ui| {
            ui.label(
                "Strength in stops: +1 doubles the intensity, -1 halves it; the ratio of its \
                 channels stays",
            );
        }),
    };
    let mut edit = columns.next(ui, |ui| {
        let width = ui.available_width();
        number.slider_ui(ui, &mut wanted, width)
    });
    edit.join(columns.next(ui, |ui| number.field_ui(ui, &mut wanted, COLUMNS[4])));
    if edit.changed {
        // What was saved comes back with all its bits.
        light.intensity = match was.filter(|_| number.saved == Some(wanted)) {
            Some(saved) => saved.intensity,
            None => with_stops(light.intensity, wanted),
        };
    }
    edit
}

/// The colour with a picker.
fn swatch_ui(ui: &mut Ui, light: &mut Light, saved: Option<&Light>) -> Edit {
    let field = ColorField {
        name: format!("{} colour", light.name),
        range: COEFFICIENT,
        saved: saved.map(|saved| saved.color).filter(|color| *color != light.color),
        default: Box::new(|| Some(Rgb::WHITE)),
        kelvin: true,
        about: Box::new(|ui| drop(ui.label("Colour of the light"))),
    };
    field.swatch_ui(ui, &mut light.color)
}

/// Slider and number of the temperature.
fn kelvin_ui(ui: &mut Ui, columns: &mut Columns, light: &mut Light) -> Edit {
    let mut kelvin = Kelvin::of(light.color, format!("{} kelvin", light.name));
    let mut edit = columns.next(ui, |ui| {
        let width = ui.available_width();
        kelvin.slider_ui(ui, width)
    });
    edit.join(columns.next(ui, |ui| kelvin.field_ui(ui, COLUMNS[7])));
    if edit.changed {
        light.color = kelvin.color();
    }
    edit
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lights(on: &[bool]) -> Vec<Light> {
        let light = |(i, on): (usize, &bool)| Light { on: *on, ..Light::new(format!("l{i}")) };
        on.iter().enumerate().map(light).collect()
    }

    fn switches(lights: &[Light]) -> Vec<bool> {
        lights.iter().map(|light| light.on).collect()
    }

    #[test]
    fn solo_gives_back_what_was() {
        let mut list = lights(&[true, false, true]);
        let solo = Solo::begin(&mut list, 1);
        assert_eq!(switches(&list), [false, true, false]);
        assert!(solo.holds(&list, 1) && !solo.holds(&list, 0));
        list[2].on = true;
        assert!(!solo.holds(&list, 1), "another was lit");
        list[2].on = false;
        list[0].name = "renamed".into();
        assert!(solo.holds(&list, 1));
        solo.end(&mut list);
        assert_eq!(switches(&list), [true, false, true]);
    }

    #[test]
    fn solo_knows_lights_by_name_when_their_number_changed() {
        let mut list = lights(&[true, false, true]);
        let solo = Solo::begin(&mut list, 2);
        list.push(Light { on: false, ..Light::new("new") });
        list.remove(0);
        list.remove(0);
        assert!(solo.holds(&list, 0), "l2 is the first now");
        list.insert(0, Light { on: false, ..Light::new("l0") });
        list.push(Light { on: false, ..Light::new("newer") });
        solo.end(&mut list);
        assert_eq!(switches(&list), [true, true, false, false], "l0, l2, and the new ones");
    }

    #[test]
    fn stops_keep_the_ratio_of_the_channels() {
        let intensity = Rgb([0.2, 0.25, 0.5]);
        assert_eq!(stops(intensity), Some(-1.0));
        assert_eq!(with_stops(intensity, 1.0), Rgb([0.8, 1.0, 2.0]));
        assert_eq!(with_stops(Rgb::grey(0.3), 2.0), Rgb::grey(4.0));
        assert_eq!((stops(Rgb::BLACK), with_stops(Rgb::BLACK, 0.0)), (None, Rgb::WHITE));
        let bright = with_stops(intensity, 500.0);
        assert!(bright.max_channel() <= 1e6 && bright.max_channel() > 0.9e6, "{bright:?}");
        assert!(with_stops(intensity, -500.0).max_channel() > 0.0, "the ratio is not lost");
    }

    #[test]
    fn a_line_is_as_dear_as_its_dearest() {
        let instant = Some(Cost::Instant);
        assert_eq!(dearest([instant; 3]), instant);
        assert_eq!(dearest([instant, Some(Cost::TraceAll), instant]), Some(Cost::TraceAll));
        assert_eq!(dearest([instant, None, Some(Cost::TraceAll)]), None);
    }
}
