//! Plot and table of what was measured of speed against accuracy.

use eframe::egui::{Color32, Grid, RichText, ScrollArea, Sense, Ui};
use egui_plot::{GridInput, GridMark, HoverPosition, Line, MarkerShape, Plot, PlotPoints, Points};

use crate::chart::{COLORS, Chart, Cost, Deviation, Goal, Point, SETTINGS, TIME, about, text_of};
use crate::scene::Scene;

/// What was measured of one setting.
#[derive(Clone, Debug)]
pub(super) struct Curve {
    /// Path of the setting.
    pub(super) path: &'static str,
    /// From coarse to fine.
    pub(super) points: Vec<Point>,
}

impl Curve {
    /// The curve of a setting; a new one if there is none yet.
    pub(super) fn of<'a>(curves: &'a mut Vec<Curve>, path: &'static str) -> &'a mut Curve {
        let known = curves.iter().position(|curve| curve.path == path);
        let at = known.unwrap_or_else(|| {
            curves.push(Curve { path, points: Vec::new() });
            curves.len() - 1
        });
        &mut curves[at]
    }

    /// The points, by the values that their names show.
    fn about(&self, index: usize) -> Option<String> {
        let Point { value, cost, error, front } = self.points.get(index)?;
        let front = if *front { "\nnothing beats it in both" } else { "" };
        let name = format!("{} = {}", self.path, text_of(*value));
        Some(about(&name, *cost, *error).replacen(": ", "\n", 1) + front)
    }
}

/// A mark beside the curves: the scene as it is, or what is recommended.
struct Mark {
    name: &'static str,
    cost: Cost,
    error: Deviation,
    shape: MarkerShape,
}

fn marks(chart: &Chart) -> Vec<Mark> {
    let advice = &chart.advice;
    let present = chart.present_error.map(|error| Mark {
        name: "the scene as it is",
        cost: chart.present,
        error,
        shape: MarkerShape::Square,
    });
    let recommended = Mark {
        name: "recommended",
        cost: advice.cost,
        error: advice.error,
        shape: MarkerShape::Diamond,
    };
    present.into_iter().chain([recommended]).collect()
}

fn color(index: usize) -> Color32 {
    let [r, g, b] = COLORS[index % COLORS.len()];
    Color32::from_rgb(r, g, b)
}

/// Shows time to the right and error upward, both logarithmic; a point tells its numbers when the
/// pointer rests on it.
pub(super) fn plot_ui(ui: &mut Ui, width: f32, curves: &[Curve], chart: Option<&Chart>) {
    let marks = chart.map(marks).unwrap_or_default();
    let floor = floor(curves);
    let place = |cost: Cost, error: Deviation| {
        let error = if error.linear > 0.0 { error.linear.log10() } else { floor };
        [cost.seconds.max(1e-9).log10(), error]
    };
    let label = |position: &HoverPosition| {
        let HoverPosition::NearDataPoint { plot_name, index, .. } = position else { return None };
        if let Some(mark) = marks.iter().find(|mark| mark.name == *plot_name) {
            return Some(about(mark.name, mark.cost, mark.error).replacen(": ", "\n", 1));
        }
        curves.iter().find(|curve| curve.path == *plot_name)?.about(*index)
    };
    let dark = ui.visuals().text_color();
    Plot::new("speed and accuracy")
        .width(width)
        .height(ui.available_height())
        .sense(Sense::hover())
        .allow_zoom(false)
        .allow_scroll(false)
        .allow_drag(false)
        .allow_boxed_zoom(false)
        .x_axis_label(TIME)
        .y_axis_label("error: rms of linear light")
        .x_grid_spacer(decades)
        .y_grid_spacer(decades)
        .x_axis_formatter(|mark, _| power(mark))
        .y_axis_formatter(|mark, _| power(mark))
        .label_formatter(label)
        .show(ui, |plot| {
            for (i, curve) in curves.iter().enumerate() {
                let all = curve.points.iter();
                let mut front: Vec<[f64; 2]> =
                    all.clone().filter(|p| p.front).map(|p| place(p.cost, p.error)).collect();
                front.sort_by(|a, b| a[0].total_cmp(&b[0]));
                let line = Line::new("", PlotPoints::from(front)).color(color(i));
                plot.line(line.allow_hover(false));
                let points: Vec<[f64; 2]> = all.map(|p| place(p.cost, p.error)).collect();
                plot.add(Points::new(curve.path, points).color(color(i)).radius(4.0));
            }
            for mark in &marks {
                let points = Points::new(mark.name, vec![place(mark.cost, mark.error)]);
                plot.add(points.shape(mark.shape).filled(false).radius(8.0).color(dark));
            }
        });
}

/// log10 of where an error of 0 stands: below all others.
fn floor(curves: &[Curve]) -> f64 {
    let errors = curves.iter().flat_map(|curve| &curve.points).map(|point| point.error.linear);
    let least = errors.filter(|e| *e > 0.0).min_by(f64::total_cmp);
    least.map_or(-6.0, |least| least.log10() - 0.5)
}

/// Lines at one to nine of every power of ten.
fn decades(input: GridInput) -> Vec<GridMark> {
    let (low, high) = input.bounds;
    let all = (low.floor() as i32..=high.ceil() as i32)
        .flat_map(|decade| (1..10).map(move |digit| (decade, digit)));
    let marks = all.map(|(decade, digit)| GridMark {
        value: f64::from(decade) + f64::from(digit).log10(),
        step_size: match digit {
            1 => 1.0,
            2 | 5 => 0.3,
            _ => 0.1,
        },
    });
    marks.filter(|mark| (low..=high).contains(&mark.value)).collect()
}

/// The number at a line: one digit and a power of ten. Lines between have none.
fn power(mark: GridMark) -> String {
    if mark.step_size < 0.2 {
        return String::new();
    }
    let text = format!("{:.0e}", 10f64.powf(mark.value));
    text.parse().map_or(text, |value: f64| value.to_string())
}

/// One line per point, with a button that sets its value; what was pressed.
pub(super) fn table_ui(
    ui: &mut Ui,
    scene: &Scene,
    curves: &[Curve],
    chart: Option<&Chart>,
    goal: Goal,
) -> Option<(String, String)> {
    let mut chosen = None;
    ScrollArea::both().auto_shrink(false).id_salt("points").show(ui, |ui| {
        Grid::new("points").num_columns(6).striped(true).show(ui, |ui| {
            for (i, curve) in curves.iter().enumerate() {
                let setting = SETTINGS.iter().find(|setting| setting.path == curve.path);
                let present = setting.and_then(|setting| setting.present(scene)).map(text_of);
                let advised = chart.and_then(|chart| {
                    let place = chart.sweeps.iter().position(|s| s.setting.path == curve.path)?;
                    chart.advice.values.get(place).copied().map(text_of)
                });
                ui.label(RichText::new("●").color(color(i)));
                ui.strong(setting.map_or(curve.path, |setting| setting.name));
                for head in ["seconds", "rays", "error", "codes"] {
                    ui.weak(head);
                }
                ui.end_row();
                for Point { value, cost, error, front: _ } in &curve.points {
                    let text = text_of(*value);
                    let is = |other: &Option<String>| other.as_ref() == Some(&text);
                    let button = ui.button("Apply").on_hover_text("Sets this value in the scene");
                    let name = format!("apply {} = {text}", curve.path);
                    if button.accessible_name(name).clicked() {
                        chosen = Some((curve.path.to_owned(), text.clone()));
                    }
                    let marks = match (is(&present), is(&advised)) {
                        (true, true) => " now, recommended",
                        (true, false) => " now",
                        (false, true) => " recommended",
                        (false, false) => "",
                    };
                    ui.label(format!("{text}{marks}"));
                    ui.label(format!("{:.4}", cost.seconds));
                    ui.label(format!("{:.2} M", cost.rays as f64 / 1e6));
                    ui.label(format!("{:.2e}", error.linear));
                    let codes = RichText::new(format!("{:.2}", error.codes));
                    let met = goal.is_met(*error);
                    let codes = ui.label(if met { codes.strong() } else { codes.weak() });
                    codes.on_hover_text("Error in code values of 8 bits; strong: as wanted");
                    ui.end_row();
                }
            }
        });
    });
    chosen
}
