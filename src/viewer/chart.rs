//! The panel of speed against accuracy: measures the open scene in the background, recommends, and applies.

use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread::JoinHandle;

use eframe::egui::{Align, Button, Context, DragValue, Layout, ProgressBar, Ui};

use super::app::App;
use super::chart_plot::{Curve, plot_ui, table_ui};
use super::number::typed;
use super::panels::filled;
use crate::chart::{Advice, Chart, Goal, News, Wishes, measure, text_of};
use crate::document::arrangement::Part;
use crate::progress::Progress;
use crate::scene::Scene;
use crate::scene::path::set;
use crate::session::Options;
use crate::session::trace::TraceError;

/// Longest sides of the measured picture, in pixels.
const SIDES: std::ops::RangeInclusive<u32> = 16..=4096;
/// Samples of the reference.
const REFERENCES: std::ops::RangeInclusive<u32> = 8..=4096;

/// What the panel remembers from turn to turn.
pub(super) struct ChartPanel {
    /// Whether it shows.
    pub(super) open: bool,
    options: Options,
    /// Longest side of the measured picture: smaller ones are faster to measure.
    side: u32,
    reference: u32,
    /// The wanted error in code values of 8 bits.
    wanted: f64,
    job: Option<Job>,
    /// What was measured so far, sweep by sweep.
    curves: Vec<Curve>,
    chart: Option<Chart>,
    failure: Option<TraceError>,
}

/// What the person did in the panel.
#[derive(Default)]
pub(super) struct ChartOutcome {
    /// Paths and values to set.
    pub(super) assignments: Vec<(String, String)>,
    /// What the step is called, if it is more than it seems.
    step: Option<String>,
    close: bool,
}

/// A measurement that runs. Dropped, it ends.
struct Job {
    progress: Arc<Progress>,
    messages: Receiver<Message>,
    thread: Option<JoinHandle<()>>,
    what: String,
    done: usize,
    of: usize,
}

enum Message {
    News(News),
    Ended(Box<Result<Chart, TraceError>>),
}

impl Drop for Job {
    fn drop(&mut self) {
        self.progress.cancel();
        if let Some(thread) = self.thread.take() {
            // What it may have died of leaves nothing behind.
            let _ = thread.join();
        }
    }
}

impl Job {
    fn start(ctx: &Context, scene: Scene, options: Options, wishes: Wishes) -> Job {
        let progress = Arc::new(Progress::default());
        let (sender, messages) = channel();
        let (watched, ctx) = (progress.clone(), ctx.clone());
        let body = move || run(&scene, options, wishes, &watched, &sender, &ctx);
        let builder = std::thread::Builder::new().name("chart".to_owned());
        let thread = Some(builder.spawn(body).expect("the system gives a thread"));
        Job { progress, messages, thread, what: String::new(), done: 0, of: 1 }
    }

    /// How much of all is done: of pictures, and of the present one.
    fn share(&self) -> f32 {
        let (tiles, of_tiles) = self.progress.steps();
        let present = tiles as f32 / of_tiles.max(1) as f32;
        (self.done as f32 + present.min(1.0)) / self.of.max(1) as f32
    }
}

fn run(
    scene: &Scene,
    options: Options,
    wishes: Wishes,
    progress: &Progress,
    sender: &Sender<Message>,
    ctx: &Context,
) {
    // Nobody receives once the panel has let go.
    let send = |message| {
        let _ = sender.send(message);
        ctx.request_repaint();
    };
    let chart = measure(scene, options, wishes, progress, &mut |news| send(Message::News(news)));
    send(Message::Ended(Box::new(chart)));
}

impl ChartPanel {
    /// That measures with as many threads and as much memory as the window has.
    pub(super) fn new(options: Options) -> ChartPanel {
        ChartPanel {
            open: false,
            options,
            side: 320,
            reference: 256,
            wanted: 1.0,
            job: None,
            curves: Vec::new(),
            chart: None,
            failure: None,
        }
    }

    /// Forgets a scene that is no longer open.
    pub(super) fn forget(&mut self) {
        self.job = None;
        self.curves.clear();
        self.chart = None;
        self.failure = None;
    }

    /// Measures a scene, at the size of the panel.
    fn start(&mut self, ctx: &Context, scene: &Scene) {
        self.forget();
        let mut small = scene.clone();
        let longest = small.picture.size[0].max(small.picture.size[1]);
        let side = self.side.min(longest);
        small.picture.size = small.picture.size.map(|own| {
            let scaled = u64::from(own) * u64::from(side) / u64::from(longest);
            (scaled as u32).max(1)
        });
        let wishes = Wishes { reference: self.reference, goal: Goal::Codes(self.wanted) };
        self.job = Some(Job::start(ctx, small, self.options, wishes));
    }

    /// Takes what the measurement has sent.
    fn receive(&mut self) {
        let Some(job) = &mut self.job else { return };
        let mut ended = None;
        for message in job.messages.try_iter() {
            match message {
                Message::News(News::Traces { what, done, of }) => {
                    (job.what, job.done, job.of) = (what, done, of);
                }
                Message::News(News::Measured(path, point)) => {
                    Curve::of(&mut self.curves, path).points.push(point);
                }
                Message::Ended(result) => ended = Some(*result),
            }
        }
        match ended {
            None => return,
            Some(Ok(chart)) => {
                let curve = |sweep: &crate::chart::Sweep| Curve {
                    path: sweep.setting.path,
                    points: sweep.points.clone(),
                };
                self.curves = chart.sweeps.iter().map(curve).collect();
                self.chart = Some(chart);
            }
            Some(Err(TraceError::Cancelled)) => {}
            Some(Err(error)) => self.failure = Some(error),
        }
        self.job = None;
    }

    /// Shows the panel.
    fn ui(&mut self, ui: &mut Ui, scene: &Scene) -> ChartOutcome {
        self.receive();
        let mut outcome = ChartOutcome::default();
        ui.horizontal(|ui| self.head_ui(ui, scene, &mut outcome));
        if let Some(failure) = &self.failure {
            ui.colored_label(ui.visuals().error_fg_color, failure.to_string());
        }
        if let Some(chart) = &self.chart {
            ui.horizontal_wrapped(|ui| advice_ui(ui, chart, &mut outcome));
        }
        if self.curves.is_empty() {
            ui.weak(
                "Measures how samples, depth and cut-off change the error and the time of this scene",
            );
            return outcome;
        }
        let goal = Goal::Codes(self.wanted);
        ui.horizontal_top(|ui| {
            let width = (ui.available_width() * 0.55).max(200.0);
            plot_ui(ui, width, &self.curves, self.chart.as_ref());
            let assigned = table_ui(ui, scene, &self.curves, self.chart.as_ref(), goal);
            outcome.assignments.extend(assigned);
        });
        outcome
    }

    /// What is measured, and how far that is.
    fn head_ui(&mut self, ui: &mut Ui, scene: &Scene, outcome: &mut ChartOutcome) {
        ui.strong("Speed and accuracy");
        match &self.job {
            None => {
                let about =
                    "Traces this scene many times in the background; it can be edited meanwhile";
                if ui.button("Measure").on_hover_text(about).clicked() {
                    self.start(ui.ctx(), scene);
                }
            }
            Some(job) => {
                ui.ctx().request_repaint_after(std::time::Duration::from_millis(200));
                let about = "Ends the measurement; what is there stays";
                let stop = ui.add(Button::new("Stop measuring")).on_hover_text(about).clicked();
                let share = job.share();
                let bar = ProgressBar::new(share).desired_width(120.0);
                ui.add(bar.text(format!("{:.0} %", share * 100.0)));
                ui.label(format!("{} of {}: {}", job.done + 1, job.of, job.what));
                if stop {
                    job.progress.cancel();
                }
            }
        }
        ui.add_enabled_ui(self.job.is_none(), |ui| self.wishes_ui(ui));
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            let button =
                ui.small_button("Close").on_hover_text("Closes the panel; what was measured stays");
            outcome.close = button.accessible_name("Close speed and accuracy").clicked();
        });
    }

    fn wishes_ui(&mut self, ui: &mut Ui) {
        let field = |ui: &mut Ui, label: &str, name: &str, field: DragValue, about: &str| {
            ui.label(label);
            let field = field.update_while_editing(false).custom_parser(typed);
            let response = ui.add(field).accessible_name(name.to_owned());
            response.on_hover_text(about).on_disabled_hover_text(about);
        };
        let about = "Longest side of the measured picture in pixels, at most the scene's own; edges \
                     take a greater share of small pictures, and with them errors";
        field(ui, "at", "chart size", DragValue::new(&mut self.side).range(SIDES), about);
        let about = "Samples per pixel of the reference; the best point has a quarter of them";
        let reference = DragValue::new(&mut self.reference).range(REFERENCES);
        field(ui, "px, against", "chart reference", reference, about);
        let about = "The wanted error: rms in code values of 8 bits, over all pixels and channels";
        let wanted = DragValue::new(&mut self.wanted).range(0.01..=50.0).speed(0.01);
        field(ui, "samples, wanted error", "wanted error", wanted, about);
    }
}

/// What is recommended, and a button that does it.
fn advice_ui(ui: &mut Ui, chart: &Chart, outcome: &mut ChartOutcome) {
    let Chart { advice, sweeps, goal, present, .. } = chart;
    let Advice { values, error, cost, reached } = advice;
    let about = "Sets all of these values, as one step of undo";
    if ui.button("Apply recommended").on_hover_text(about).clicked() {
        let pairs = sweeps.iter().zip(values);
        let assigned = pairs.map(|(sweep, value)| (sweep.setting.path.into(), text_of(*value)));
        outcome.assignments.extend(assigned);
        outcome.step = Some("recommended settings".to_owned());
    }
    let times = cost.seconds / present.seconds;
    let for_what = match reached {
        true => format!("Recommended for an error {goal}"),
        false => format!("Nothing measured has an error {goal}; the most accurate"),
    };
    ui.label(format!(
        "{for_what}: {}; {times:.2} × the time of the scene, error at most about {:.2} code values",
        advice.text(sweeps),
        error.codes
    ));
}

impl App {
    /// The panel of speed against accuracy, if it is open; what the step is called, if it is more
    /// than it seems.
    pub(super) fn chart_ui(
        &mut self,
        ui: &mut Ui,
        edited: &mut Scene,
        changed: &mut bool,
    ) -> Option<String> {
        if !self.chart.open {
            return None;
        }
        let panel = self.panels.panel(ui, Part::Chart);
        let shown = panel.show(ui, |ui| filled(ui, |ui| self.chart.ui(ui, edited)));
        self.panels.note(Part::Chart, &shown.response);
        let outcome = shown.inner;
        let ChartOutcome { assignments, step, close } = outcome;
        self.chart.open = !close;
        for (name, value) in assignments {
            match set(edited, &name, &value) {
                Ok(()) => *changed = true,
                Err(error) => self.notices.error(error.to_string()),
            }
        }
        step
    }
}
