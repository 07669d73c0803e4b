//! A chart as a picture: time to the right, error upward, both logarithmic.

use std::fmt::Write;

use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::Tree;

use super::{Chart, Cost, Deviation, Goal, Point, Sweep, TIME, text_of};
use crate::film::caption::{drawing_options, escaped};

/// Size of the picture in its own units, and of the PNG in pixels per unit.
const SIZE: [f64; 2] = [960.0, 680.0];
const PIXELS: f32 = 1.5;
/// Where the axes are: left, top, right, bottom.
const AREA: [f64; 4] = [84.0, 128.0, 936.0, 580.0];
/// Red, green and blue of the sweeps, one after the other: told apart by most eyes, also by those that
/// see fewer colours (Okabe and Ito).
pub const COLORS: [[u8; 3]; 6] =
    [[0, 114, 178], [213, 94, 0], [0, 158, 115], [204, 121, 167], [86, 180, 233], [230, 159, 0]];

/// A logarithmic axis.
struct Axis {
    /// log10 of its ends.
    span: [f64; 2],
    /// Where these are in the picture.
    ends: [f64; 2],
}

impl Axis {
    /// That shows all of some positive values, with some air; a decade around 1 if there are none.
    fn over(values: impl Iterator<Item = f64>, ends: [f64; 2]) -> Axis {
        let logs: Vec<f64> = values.filter(|v| *v > 0.0).map(f64::log10).collect();
        let low = logs.iter().copied().min_by(f64::total_cmp).unwrap_or(-0.5);
        let high = logs.iter().copied().max_by(f64::total_cmp).unwrap_or(0.5);
        let air = 0.05 * (high - low) + 0.1;
        Axis { span: [low - air, high + air], ends }
    }

    /// Where a value is; 0 is at the lower end.
    fn at(&self, value: f64) -> f64 {
        let [low, high] = self.span;
        let share = ((value.log10() - low) / (high - low)).clamp(0.0, 1.0);
        self.ends[0] + share * (self.ends[1] - self.ends[0])
    }

    /// Values with a line, and whether it has a number: the powers of ten, and 2 and 5 where the axis
    /// is short.
    fn ticks(&self) -> Vec<(f64, bool)> {
        let [low, high] = self.span;
        let numbered: &[i32] = if high - low < 1.8 { &[1, 2, 5] } else { &[1] };
        let decades = low.floor() as i32..=high.ceil() as i32;
        let all = decades.flat_map(|decade| (1..10).map(move |digit| (decade, digit)));
        let ticks = all.map(|(decade, digit)| {
            // Of its text, so that 10^-3 is 0.001 and nothing beside it.
            let value: f64 = format!("{digit}e{decade}").parse().unwrap_or(1.0);
            (value, numbered.contains(&digit))
        });
        ticks.filter(|(value, _)| (low..=high).contains(&value.log10())).collect()
    }
}

/// The chart of a scene as SVG; a point's numbers show where the pointer rests on it.
pub fn svg(name: &str, chart: &Chart) -> String {
    let [width, height] = SIZE;
    let points = || chart.sweeps.iter().flat_map(|sweep| &sweep.points);
    let marked =
        [(chart.present, chart.present_error), (chart.advice.cost, Some(chart.advice.error))];
    let goal = match chart.goal {
        Goal::Linear(most) => Some(most),
        Goal::Codes(_) => None,
    };
    let [left, top, right, bottom] = AREA;
    let seconds = points().map(|p| p.cost.seconds).chain(marked.map(|(cost, _)| cost.seconds));
    let errors = points().map(|p| p.error.linear);
    let errors = errors.chain(marked.into_iter().filter_map(|(_, e)| Some(e?.linear))).chain(goal);
    let axes = [Axis::over(seconds, [left, right]), Axis::over(errors, [bottom, top])];
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" \
         width=\"{width}\" height=\"{height}\" font-family=\"sans-serif\" font-size=\"12\">\n\
         <rect width=\"{width}\" height=\"{height}\" fill=\"white\"/>\n"
    );
    frame(&mut out, &axes);
    head(&mut out, name, chart);
    if let Some(most) = goal {
        let y = axes[1].at(most);
        line(&mut out, [left, y], [right, y], "#888888\" stroke-dasharray=\"6 4");
        text(&mut out, [right - 4.0, y - 4.0], "end", "wanted");
    }
    for (sweep, color) in chart.sweeps.iter().zip(colors()) {
        swept(&mut out, chart, sweep, &color, &axes);
    }
    marks(&mut out, chart, &axes);
    out + "</svg>\n"
}

/// The same as a PNG, in the font of the window.
///
/// `None` if there is no memory for it.
pub fn png(name: &str, chart: &Chart) -> Option<Vec<u8>> {
    let tree = Tree::from_str(&svg(name, chart), &drawing_options()?).ok()?;
    let [width, height] = SIZE.map(|side| (side as f32 * PIXELS) as u32);
    let mut pixmap = Pixmap::new(width, height)?;
    resvg::render(&tree, Transform::from_scale(PIXELS, PIXELS), &mut pixmap.as_mut());
    pixmap.encode_png().ok()
}

/// The colours as SVG writes them, again and again.
fn colors() -> impl Iterator<Item = String> {
    COLORS.iter().cycle().map(|[r, g, b]| format!("#{r:02x}{g:02x}{b:02x}"))
}

/// Appends a line of text; writing into a string does not fail.
fn put(out: &mut String, line: std::fmt::Arguments<'_>) {
    let _ = out.write_fmt(line);
    out.push('\n');
}

fn line(out: &mut String, [x1, y1]: [f64; 2], [x2, y2]: [f64; 2], color: &str) {
    put(
        out,
        format_args!(
            "<line x1=\"{x1:.1}\" y1=\"{y1:.1}\" x2=\"{x2:.1}\" y2=\"{y2:.1}\" stroke=\"{color}\"/>"
        ),
    );
}

fn text(out: &mut String, [x, y]: [f64; 2], anchor: &str, words: &str) {
    let words = escaped(words);
    put(
        out,
        format_args!("<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\">{words}</text>"),
    );
}

/// Grid, numbers and names of the axes.
fn frame(out: &mut String, [time, error]: &[Axis; 2]) {
    let [left, top, right, bottom] = AREA;
    for (value, numbered) in time.ticks() {
        let x = time.at(value);
        line(out, [x, top], [x, bottom], if numbered { "#cccccc" } else { "#eeeeee" });
        if numbered {
            text(out, [x, bottom + 18.0], "middle", &value.to_string());
        }
    }
    for (value, numbered) in error.ticks() {
        let y = error.at(value);
        line(out, [left, y], [right, y], if numbered { "#cccccc" } else { "#eeeeee" });
        if numbered {
            text(out, [left - 6.0, y + 4.0], "end", &value.to_string());
        }
    }
    put(
        out,
        format_args!(
            "<rect x=\"{left}\" y=\"{top}\" width=\"{}\" height=\"{}\" fill=\"none\" \
             stroke=\"black\"/>",
            right - left,
            bottom - top
        ),
    );
    text(out, [(left + right) / 2.0, bottom + 38.0], "middle", TIME);
    let middle = (top + bottom) / 2.0;
    put(
        out,
        format_args!(
            "<text transform=\"translate(18 {middle}) rotate(-90)\" text-anchor=\"middle\">error: \
             rms of linear light</text>"
        ),
    );
}

/// What is shown, and of what.
fn head(out: &mut String, name: &str, chart: &Chart) {
    let Chart { size: [width, height], threads, goal, advice, sweeps, .. } = chart;
    put(
        out,
        format_args!(
            "<text x=\"84\" y=\"28\" font-size=\"18\">{}: speed against accuracy</text>",
            escaped(name)
        ),
    );
    let about = format!(
        "{width}×{height}. Error: over all pixels and the three channels, after exposure, 1 = white. \
         Time: {TIME} of tracing, {threads} threads."
    );
    text(out, [84.0, 48.0], "start", &about);
    let filled = format!("Filled: error {goal}. Lines join what nothing beats in both.");
    text(out, [84.0, 66.0], "start", &filled);
    let mut x = 84.0;
    for (sweep, color) in sweeps.iter().zip(colors()) {
        let legend = format!("{}, against {}", sweep.setting.name, text_of(sweep.truth));
        circle(out, [x + 5.0, 84.0], &color, true, "");
        text(out, [x + 14.0, 88.0], "start", &legend);
        x += 34.0 + 6.2 * legend.chars().count() as f64;
    }
    square(out, [x + 5.0, 84.0], "");
    text(out, [x + 16.0, 88.0], "start", "the scene as it is");
    diamond(out, [x + 139.0, 84.0], "");
    text(out, [x + 150.0, 88.0], "start", "recommended");
    let reached = if advice.reached { "" } else { " (the most accurate; the goal is not reached)" };
    let text_of_advice =
        format!("Recommended for an error {goal}: {}{reached}", advice.text(sweeps));
    text(out, [84.0, 112.0], "start", &text_of_advice);
    let about_sums = "The errors of the scene and of the recommendation are the sums of those of their \
                      values: they are at most about that. An error of 0 stands on the lower edge.";
    text(out, [84.0, 660.0], "start", about_sums);
}

fn circle(out: &mut String, [x, y]: [f64; 2], color: &str, filled: bool, about: &str) {
    let fill = if filled { color } else { "white" };
    let about = escaped(about);
    put(
        out,
        format_args!(
            "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"4.5\" fill=\"{fill}\" stroke=\"{color}\" \
             stroke-width=\"1.5\"><title>{about}</title></circle>"
        ),
    );
}

fn square(out: &mut String, [x, y]: [f64; 2], about: &str) {
    let (x, y, about) = (x - 6.0, y - 6.0, escaped(about));
    put(
        out,
        format_args!(
            "<rect x=\"{x:.1}\" y=\"{y:.1}\" width=\"12\" height=\"12\" fill=\"none\" \
             stroke=\"black\" stroke-width=\"1.5\" pointer-events=\"all\"><title>{about}</title></rect>"
        ),
    );
}

fn diamond(out: &mut String, [x, y]: [f64; 2], about: &str) {
    let about = escaped(about);
    put(
        out,
        format_args!(
            "<path d=\"M {x:.1} {:.1} l 8 8 l -8 8 l -8 -8 z\" fill=\"none\" stroke=\"black\" \
             stroke-width=\"2\" pointer-events=\"all\"><title>{about}</title></path>",
            y - 8.0
        ),
    );
}

/// One setting: what nothing beats as a line, all values as circles with their numbers.
fn swept(out: &mut String, chart: &Chart, sweep: &Sweep, color: &str, [time, error]: &[Axis; 2]) {
    let place = |point: &Point| [time.at(point.cost.seconds), error.at(point.error.linear)];
    let mut front: Vec<&Point> = sweep.points.iter().filter(|p| p.front).collect();
    front.sort_by(|a, b| a.cost.seconds.total_cmp(&b.cost.seconds));
    let corners: Vec<String> = front
        .iter()
        .map(|point| {
            let [x, y] = place(point);
            format!("{x:.1},{y:.1}")
        })
        .collect();
    let corners = corners.join(" ");
    put(out, format_args!("<polyline points=\"{corners}\" fill=\"none\" stroke=\"{color}\"/>"));
    for point in &sweep.points {
        let value = text_of(point.value);
        let about = about(&format!("{} = {value}", sweep.setting.path), point.cost, point.error);
        let [x, y] = place(point);
        circle(out, [x, y], color, chart.goal.is_met(point.error), &about);
        text(out, [x + 6.0, y - 6.0], "start", &short(point.value));
    }
}

/// A value in three digits.
fn short(value: f64) -> String {
    format!("{value:.2e}").parse().map_or_else(|_| text_of(value), text_of)
}

/// A point in words.
pub fn about(name: &str, cost: Cost, error: Deviation) -> String {
    let (Cost { seconds, runs: _, rays }, Deviation { linear, codes }) = (cost, error);
    format!(
        "{name}: {seconds:.4} s, {rays} rays, rms {linear:.3e} of linear light, {codes:.3} code values"
    )
}

/// The scene as it is, and what is recommended.
fn marks(out: &mut String, chart: &Chart, [time, error]: &[Axis; 2]) {
    let place = |cost: Cost, far: Deviation| [time.at(cost.seconds), error.at(far.linear)];
    if let Some(far) = chart.present_error {
        let about = about("the scene as it is", chart.present, far);
        square(out, place(chart.present, far), &about);
    }
    let (cost, far) = (chart.advice.cost, chart.advice.error);
    let name = format!("recommended: {}", chart.advice.text(&chart.sweeps));
    diamond(out, place(cost, far), &about(&name, cost, far));
}
