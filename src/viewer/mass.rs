//! The panel of mass properties: measures the selected solid in the background and draws how it converges.

use std::sync::Arc;
use std::sync::mpsc::{Receiver, channel};
use std::thread::JoinHandle;

use eframe::egui::{Align, Color32, Context, DragValue, Grid, Layout, ScrollArea, Sense, Ui};
use egui_plot::{HLine, Line, Plot, PlotPoints, Points};

use super::app::App;
use super::inspector::Selection;
use super::number::typed;
use super::panels::{LINE, filled};
use crate::document::arrangement::Part;
use crate::mass::{Goal, MassError, Measured, Properties, Report, Step, Stuff, Wishes, measure};
use crate::progress::Progress;
use crate::scene::Scene;
use crate::scene::change::Change;
use crate::session::Options;

/// What the panel remembers from turn to turn.
pub(super) struct MassPanel {
    /// Whether it shows.
    pub(super) open: bool,
    threads: usize,
    /// The wanted error of the volume, as a share of it.
    wanted: f64,
    job: Option<Job>,
    /// What is measured or was, and its grids so far.
    subject: Option<Subject>,
    steps: Vec<Step>,
    found: Option<Result<Report, MassError>>,
}

/// A solid as it was when its measurement began.
#[derive(Clone, PartialEq)]
struct Subject {
    scene: Arc<Scene>,
    solid: usize,
}

impl Subject {
    fn name(&self) -> &str {
        self.scene.solids.get(self.solid).map_or("", |solid| solid.name.as_str())
    }
}

/// A measurement that runs. Dropped, it ends.
struct Job {
    progress: Arc<Progress>,
    messages: Receiver<Message>,
    thread: Option<JoinHandle<()>>,
}

enum Message {
    Step(Step),
    Ended(Box<Result<Report, MassError>>),
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
    fn start(ctx: &Context, subject: &Subject, wishes: Wishes, threads: usize) -> Job {
        let progress = Arc::new(Progress::default());
        let (sender, messages) = channel();
        let (watched, ctx) = (progress.clone(), ctx.clone());
        let Subject { scene, solid } = subject.clone();
        let body = move || {
            // Nobody receives once the panel has let go.
            let send = |message| {
                let _ = sender.send(message);
                ctx.request_repaint();
            };
            let mut news = |step: &Step| send(Message::Step(*step));
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            let found = pool
                .expect("the system gives threads")
                .install(|| measure(&scene, solid, wishes, &watched, &mut news));
            send(Message::Ended(Box::new(found)));
        };
        let builder = std::thread::Builder::new().name("mass".to_owned());
        let thread = Some(builder.spawn(body).expect("the system gives a thread"));
        Job { progress, messages, thread }
    }
}

impl MassPanel {
    /// That measures with as many threads as the window has.
    pub(super) fn new(options: Options) -> MassPanel {
        MassPanel {
            open: false,
            threads: options.threads,
            wanted: 1e-4,
            job: None,
            subject: None,
            steps: Vec::new(),
            found: None,
        }
    }

    /// Forgets a scene that is no longer open.
    pub(super) fn forget(&mut self) {
        self.job = None;
        self.subject = None;
        self.steps.clear();
        self.found = None;
    }

    /// Takes what the measurement has sent.
    fn receive(&mut self) {
        let Some(job) = &self.job else { return };
        let mut ended = None;
        for message in job.messages.try_iter() {
            match message {
                Message::Step(step) => self.steps.push(step),
                Message::Ended(found) => ended = Some(*found),
            }
        }
        if let Some(found) = ended {
            self.found = (found != Err(MassError::Cancelled)).then_some(found);
            self.job = None;
        }
    }

    /// Shows the panel; whether it is to be closed.
    fn ui(&mut self, ui: &mut Ui, scene: &Scene, solid: Option<usize>) -> bool {
        self.receive();
        let close = ui.horizontal(|ui| self.head_ui(ui, scene, solid)).inner;
        if let Some(Err(error)) = &self.found {
            ui.colored_label(ui.visuals().error_fg_color, error.to_string());
        }
        if self.steps.is_empty() {
            ui.weak("Choose a solid: its volume, centre of mass and moments of inertia are measured by parallel rays");
            return close;
        }
        ui.horizontal_top(|ui| {
            let width = (ui.available_width() * 0.45).max(200.0);
            convergence_ui(ui, width, &self.steps);
            if let Some(Ok(report)) = &self.found {
                let figures = ScrollArea::both().id_salt("mass figures");
                figures.min_scrolled_height(LINE).show(ui, |ui| figures_ui(ui, report));
            }
        });
        close
    }

    /// What is measured; whether the panel is to be closed.
    fn head_ui(&mut self, ui: &mut Ui, scene: &Scene, solid: Option<usize>) -> bool {
        ui.strong("Mass");
        let name = solid.and_then(|i| scene.solids.get(i)).map(|solid| solid.name.as_str());
        if self.job.is_some() {
            let about = "Ends the measurement";
            if ui.button("Stop measuring mass").on_hover_text(about).clicked() {
                self.job = None;
            }
            ui.spinner();
        } else {
            let about =
                "Casts parallel rays through the selected solid, until the error is reached";
            let text = name.map_or("Measure a solid".to_owned(), |name| format!("Measure {name}"));
            let button = ui.add_enabled_ui(name.is_some(), |ui| ui.button(text)).inner;
            let disabled = "Select a solid, or click one in the picture";
            if button.on_hover_text(about).on_disabled_hover_text(disabled).clicked()
                && let Some(solid) = solid
            {
                self.start(ui.ctx(), scene, solid);
            }
        }
        ui.add_enabled_ui(self.job.is_none(), |ui| self.wishes_ui(ui));
        if let Some(subject) = &self.subject {
            let same = weighs_like(scene, &subject.scene);
            let old = if same { "" } else { ", before its latest change" };
            let rays: u64 = self.steps.iter().map(|step| step.rays).sum();
            ui.label(format!("{}{old}: {rays} rays", subject.name()));
        }
        let close = |ui: &mut Ui| {
            let button = ui.small_button("Close").on_hover_text("Closes the panel");
            button.accessible_name("Close mass").clicked()
        };
        ui.with_layout(Layout::right_to_left(Align::Center), close).inner
    }

    fn start(&mut self, ctx: &Context, scene: &Scene, solid: usize) {
        self.forget();
        let subject = Subject { scene: Arc::new(scene.clone()), solid };
        let wishes = Wishes { goal: Goal::Error(self.wanted), ..Wishes::default() };
        self.job = Some(Job::start(ctx, &subject, wishes, self.threads));
        self.subject = Some(subject);
    }

    fn wishes_ui(&mut self, ui: &mut Ui) {
        ui.label("error");
        let about = "The wanted error of the volume, as a share of it";
        let wanted = DragValue::new(&mut self.wanted).range(1e-7..=0.1).speed(1e-6);
        let wanted = wanted.max_decimals(7).update_while_editing(false).custom_parser(typed);
        let response = ui.add(wanted).accessible_name("wanted mass error");
        response.on_hover_text(about).on_disabled_hover_text(about);
    }
}

/// Whether all solids are as they were, and as dense.
fn weighs_like(new: &Scene, old: &Scene) -> bool {
    fn densities(scene: &Scene) -> impl Iterator<Item = Option<f64>> {
        scene.solids.iter().map(|solid| Some(scene.materials.get(solid.material)?.density))
    }
    !Change::between(old, new).geometry && densities(old).eq(densities(new))
}

/// Volume over the number of rays, with its error on both sides.
fn convergence_ui(ui: &mut Ui, width: f32, steps: &[Step]) {
    let place = |step: &Step, sign: f64| {
        let Measured { value, error } = step.volume;
        [(step.rays as f64).log10(), value + sign * error]
    };
    let curve = |sign: f64| steps.iter().map(|step| place(step, sign)).collect::<Vec<_>>();
    let faint = ui.visuals().weak_text_color();
    let color = Color32::from_rgb(0x3a, 0x86, 0xc8);
    Plot::new("convergence of the volume")
        .width(width)
        .height(ui.available_height())
        .sense(Sense::hover())
        .allow_zoom(false)
        .allow_scroll(false)
        .allow_drag(false)
        .allow_boxed_zoom(false)
        .x_axis_label("rays of a grid, log10")
        .y_axis_label("volume")
        .show(ui, |plot| {
            for sign in [-1.0, 1.0] {
                let line = Line::new("error", PlotPoints::from(curve(sign)));
                plot.line(line.color(faint).allow_hover(false));
            }
            if let Some(last) = steps.last() {
                plot.hline(HLine::new("latest", last.volume.value).color(faint).allow_hover(false));
            }
            plot.line(Line::new("", PlotPoints::from(curve(0.0))).color(color).allow_hover(false));
            plot.points(Points::new("volume", curve(0.0)).color(color).radius(4.0));
        });
}

/// A number with its error.
fn shown(measured: Measured) -> String {
    let Measured { value, error } = measured;
    format!("{value:.8} ± {error:.1e}")
}

fn figures_ui(ui: &mut Ui, report: &Report) {
    let Report { properties, steps: _, reached, torn, made_of, exact } = report;
    let Properties { volume, mass, center, inertia, principal, axes } = properties;
    let mut rows = vec![("volume".to_owned(), shown(*volume))];
    let stuff = |s: &Stuff| (format!("density of {}", s.material), s.density.to_string());
    rows.extend(made_of.iter().map(stuff));
    rows.push(("mass".to_owned(), shown(*mass)));
    let axes_names = ["x", "y", "z"];
    rows.extend(
        center.iter().zip(axes_names).map(|(c, axis)| (format!("centre {axis}"), shown(*c))),
    );
    let names = ["xx", "yy", "zz", "yz", "zx", "xy"];
    rows.extend(inertia.iter().zip(names).map(|(i, name)| (format!("inertia {name}"), shown(*i))));
    rows.extend(principal.iter().zip(axes).map(|(moment, axis)| {
        let [x, y, z] = axis.to_array();
        let name = format!("principal about ({x:.4}, {y:.4}, {z:.4})");
        (name, shown(*moment))
    }));
    if let Some(exact) = exact {
        rows.push(("volume by formula".to_owned(), format!("{:.8}", exact.volume.value)));
    }
    if *torn > 0 {
        rows.push(("rays that count as misses".to_owned(), torn.to_string()));
    }
    if !reached {
        rows.push(("the wanted error".to_owned(), "is not reached".to_owned()));
    }
    Grid::new("mass figures").num_columns(2).striped(true).show(ui, |ui| {
        for (name, value) in rows {
            ui.label(name);
            ui.monospace(value);
            ui.end_row();
        }
    });
}

impl App {
    /// The panel of mass properties, if it is open.
    pub(super) fn mass_ui(&mut self, ui: &mut Ui) {
        if !self.mass.open {
            return;
        }
        let solid = match self.selection {
            Selection::Solid(solid) => Some(solid),
            _ => self.picked,
        };
        let panel = self.panels.panel(ui, Part::Mass);
        let scene = self.document.scene();
        let shown = panel.show(ui, |ui| filled(ui, |ui| self.mass.ui(ui, scene, solid)));
        self.panels.note(Part::Mass, &shown.response);
        self.mass.open = !shown.inner;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::Document;

    #[test]
    fn figures_are_old_once_a_solid_weighs_otherwise() {
        let old = Document::built_in().scene().clone();
        let after = |change: &dyn Fn(&mut Scene)| {
            let mut new = old.clone();
            change(&mut new);
            weighs_like(&new, &old)
        };
        assert!(after(&|_| {}));
        assert!(after(&|scene| scene.materials[0].shininess = 7.0));
        assert!(!after(&|scene| scene.materials[0].density = 7.0));
        assert!(!after(&|scene| scene.solids[1].placement.scale.x = 7.0));
    }
}
