//! The window's state and one turn of its loop.

use std::sync::{Arc, Mutex};
use std::time::Instant;

use eframe::egui::{CentralPanel, Context, Frame, Margin, Panel, Ui, Vec2, ViewportCommand};

use super::Setup;
use super::carried::Outlined;
use super::chart::ChartPanel;
use super::command::Command;
use super::commands::Run;
use super::compare::Compare;
use super::examples::Copied;
use super::files::Files;
use super::handles::{Handles, Stage};
use super::inspector::{Known, Outcome, Selection, inspector_ui};
use super::looks::Strip;
use super::mass::MassPanel;
use super::menu::{MenuState, menu_ui};
use super::mixer::{Mixer, MixerKnown};
use super::navigate::focused;
use super::notice::Notices;
use super::on_disk::Changes;
use super::outline::{Lists, OutlineOutcome, outline_ui};
use super::palette::Palette;
use super::panels::{Panels, filled};
use super::picture::PictureView;
use super::pixel::PixelPanel;
use super::presets::Presets;
use super::rename::Renaming;
use super::screen::{Screen, wake};
use super::status::status_ui;
use super::style;
use super::thumbs::Noted;
use super::values::{followed, paths};
use super::welcome::Welcome;
use crate::document::arrangement::Part;
use crate::document::recovery::Recovery;
use crate::document::settings::Settings;
use crate::document::{Document, flaw};
use crate::film::layout::Layout;
use crate::scene::{Camera, Scene, path};
use crate::session::live::{Event, Live, Shown};

/// The window: a document, its live session, and what is on the screen.
pub struct App {
    pub(super) document: Document,
    pub(super) live: Live,
    pub(super) selection: Selection,
    pub(super) picture: PictureView,
    pub(super) shown: Option<Shown>,
    pub(super) settings: Settings,
    pub(super) notices: Notices,
    pub(super) files: Files,
    /// What is on disk and not here.
    pub(super) changes: Changes,
    /// The example that the document is a copy of, if it is one.
    pub(super) copied: Option<Copied>,
    pub(super) noted_thumb: Option<Noted>,
    pub(super) welcome: Welcome,
    /// Where unsaved work is kept; `None` if there is no such place, which was said.
    pub(super) recovery: Option<Recovery>,
    /// Index of the solid that was clicked or selected last.
    pub(super) picked: Option<usize>,
    /// The selection, and that, before and after the latest click in the picture.
    latest_pick: Option<[(Selection, Option<usize>); 2]>,
    /// The name that is being changed, if one is.
    pub(super) renaming: Option<Renaming>,
    /// Materials to choose from.
    pub(super) presets: Presets,
    /// The solid that a preset is carried over.
    pub(super) outlined: Outlined,
    /// What the step is called that this turn makes, if it is more than it seems.
    pub(super) step_name: Option<String>,
    pub(super) handles: Handles,
    pub(super) mixer: Mixer,
    pub(super) strip: Strip,
    pub(super) compare: Compare,
    /// Whether the picture shows its sample map instead of itself.
    pub(super) sample_map: bool,
    /// Whether clipped pixels are marked.
    pub(super) clipping: bool,
    pub(super) panels: Panels,
    /// The list of all commands, if it is open.
    pub(super) palette: Option<Palette>,
    /// Whether the list of keys is open.
    pub(super) shows_keys: bool,
    /// Whether the screen shows something else than it should.
    pub(super) is_frame_stale: bool,
    pub(super) chart: ChartPanel,
    pub(super) mass: MassPanel,
    pub(super) pixel: PixelPanel,
    /// The selection whose costs are watched, and how many solids and materials the scene had.
    watched: Option<Vec<String>>,
    /// What lasts over several turns, until then.
    pub(super) run: Option<(Run, Instant)>,
    /// Size of the picture's view in points.
    pub(super) view: Vec2,
    /// The window's title as it was set last.
    pub(super) title: String,
    /// The window that the session wakes.
    pub(super) waker: Arc<Mutex<Context>>,
    /// The graphics card that draws the window, if one does.
    pub(super) screen: Option<Screen>,
    /// The card was lost: the window goes on in another one.
    pub(super) is_moving: bool,
}

impl App {
    /// Opens the scene of `setup`, or the built-in one.
    pub fn new(ctx: &Context, setup: Setup) -> App {
        style::set_up(ctx);
        let waker = Arc::new(Mutex::new(ctx.clone()));
        let woken = waker.clone();
        let live = Live::new(setup.options, move || wake(&woken));
        let mut notices = Notices::default();
        let (settings, fault) = Settings::read(&setup.folders.settings_file());
        if let Some(fault) = fault {
            notices.error(fault);
        }
        style::apply(ctx, &settings);
        let (recovery, found) = match Recovery::start(&setup.folders.recovery) {
            Ok((recovery, found)) => {
                for file in recovery.damaged() {
                    let file = file.display();
                    notices.error(format!("unsaved work in {file} cannot be read; it is kept"));
                }
                (Some(recovery), found)
            }
            Err(error) => {
                notices.error(error.message);
                (None, Vec::new())
            }
        };
        let document = Document::built_in();
        let panels = Panels::new(&settings.arrangement);
        let mut app = App {
            document,
            live,
            selection: Selection::Scene,
            picture: PictureView::new(),
            shown: None,
            settings,
            notices,
            files: Files::new(setup.folders, setup.dialogs),
            changes: Changes::default(),
            copied: None,
            noted_thumb: None,
            welcome: Welcome::default(),
            recovery,
            picked: None,
            latest_pick: None,
            renaming: None,
            presets: Presets::default(),
            outlined: Outlined::default(),
            step_name: None,
            handles: Handles::default(),
            mixer: Mixer::default(),
            strip: Strip::default(),
            compare: Compare::default(),
            sample_map: false,
            clipping: false,
            panels,
            palette: None,
            shows_keys: false,
            is_frame_stale: false,
            chart: ChartPanel::new(setup.options),
            mass: MassPanel::new(setup.options),
            pixel: PixelPanel::default(),
            watched: None,
            run: None,
            view: Vec2::ZERO,
            title: String::new(),
            waker,
            screen: None,
            is_moving: false,
        };
        app.take_layout();
        match setup.scene {
            Some(path) => app.open_in_background(ctx, path),
            None => app.begin(ctx),
        }
        app.files.offer_recovery(found);
        app
    }

    /// One turn: takes what has arrived, shows everything, passes edits on.
    pub fn ui(&mut self, ui: &mut Ui) {
        let ctx = ui.ctx().clone();
        self.receive(ui);
        self.receive_files(&ctx);
        self.receive_material(&ctx);
        self.open_palette(&ctx);
        let mut commands = self.shortcuts(&ctx);
        let mut edited = self.document.scene().clone();
        let mut changed = false;
        self.bars(ui, &mut commands);
        self.make_room(ui.available_height());
        let step = self.mixer_ui(ui, &mut edited, &mut changed);
        let step = step.or(self.chart_ui(ui, &mut edited, &mut changed));
        self.mass_ui(ui);
        self.pixel_ui(ui);
        let strip = self.strip_ui(ui);
        self.welcome_ui(ui, &mut commands);
        let outcome = self.panels(ui, &mut edited, &mut commands);
        let pick = outcome.pick.clone();
        self.note_edit(&ctx, outcome.edit.clone());
        changed |= self.apply_outcome(outcome, &mut edited);
        changed |= self.picture_ui(ui, &mut edited);
        if changed {
            if self.run.take_if(|(run, _)| *run == Run::Exposure).is_some() {
                self.document.end_gesture();
            }
            self.commit(edited);
        }
        if let Some(step) = step.or(self.step_name.take()).filter(|_| changed) {
            self.document.name_step(step);
        }
        self.apply_strip(strip);
        self.end_gesture(&ctx);
        if let Some(place) = pick {
            self.ask_image(&ctx, place);
        }
        self.modals(&ctx);
        commands.extend(self.palette_ui(&ctx));
        self.keys_ui(&ctx);
        for command in commands {
            self.heed(&ctx, command);
        }
        self.watch_costs();
        self.ask_pixels();
        self.watch_glances();
        self.keep_example();
        self.note_thumb();
        self.remember_layout(&ctx);
        self.autosave(&ctx);
        self.set_title(&ctx);
    }

    /// Names the document in the window's title, with a star if it has unsaved changes.
    fn set_title(&mut self, ctx: &Context) {
        let mark = if self.document.is_unsaved() { "*" } else { "" };
        let title = format!("{}{mark} – Rayforest", self.document.title());
        if title != self.title {
            ctx.send_viewport_cmd(ViewportCommand::Title(title.clone()));
            self.title = title;
        }
    }

    /// Takes pictures and events from the session.
    fn receive(&mut self, ui: &Ui) {
        self.look_after_screen();
        if let Some(shown) = self.live.take_shown() {
            self.compare.note(&shown, &self.document.shared_saved_scene());
            self.complete_snapshots(&shown);
            self.shown = Some(shown);
            self.is_frame_stale = true;
        }
        if std::mem::take(&mut self.is_frame_stale) {
            self.set_frame(ui);
        }
        for event in self.live.take_events() {
            match event {
                Event::Exported(path) => self.notices.say(format!("wrote {}", path.display())),
                Event::Kept { path, bytes } => self.kept(&path, bytes),
                Event::Failed(message) => self.failed(message),
            }
        }
    }

    /// Puts the picture shown, or its sample map, on the screen.
    fn set_frame(&mut self, ui: &Ui) {
        let Some(shown) = &self.shown else { return };
        let size = shown.scene.picture.size;
        match shown.map.as_ref().filter(|_| self.sample_map) {
            Some(map) => self.picture.set_frame(ui, &map.picture(Layout::new(size)), size),
            None => match (&shown.card, &mut self.screen) {
                (Some(card), Some(screen)) => {
                    self.picture.set_card(screen.textures(card), size);
                }
                _ => {
                    let marked = shown.marked.as_ref().map(|marked| &marked.frame);
                    if let Some(frame) = marked.or(shown.frame.as_ref()) {
                        self.picture.set_frame(ui, frame, size);
                    }
                }
            },
        }
    }

    pub(super) fn toggle_sample_map(&mut self) {
        self.sample_map = !self.sample_map;
        let none = self.shown.as_ref().is_some_and(|shown| shown.map.is_none());
        if self.sample_map && none {
            self.notices.say("every pixel has all samples: trace.adaptive is 0".into());
        }
        self.is_frame_stale = true;
    }

    /// Menu and status line.
    fn bars(&mut self, ui: &mut Ui, commands: &mut Vec<Command>) {
        let bar = Frame::side_top_panel(ui.style()).inner_margin(Margin::symmetric(8, 4));
        Panel::top("menu").frame(bar).show(ui, |ui| {
            let state = MenuState {
                document: &self.document,
                recent: &self.settings.recent,
                is_on: &|command| self.is_on(command),
                refusal: &|command| self.refusal(command),
                subject: self.subject(),
                keep: self.keep_offer(),
            };
            commands.extend(menu_ui(ui, &state));
        });
        // Ctrl with plus and minus zooms the window by itself: that is remembered too.
        let zoom = (ui.ctx().zoom_factor() * 100.0).round() as u32;
        if zoom != self.settings.zoom_percent {
            self.settings.zoom_percent = zoom;
            self.remember_settings();
        }
        if !self.panels.status {
            return;
        }
        self.panels.panel(ui, Part::Status).frame(bar).show(ui, |ui| {
            let status = self.live.status();
            commands.extend(status_ui(ui, &status, self.shown.as_ref(), self.clipped()));
        });
    }

    /// The light mixer, if it is open; what the step is called, if it is more than it seems.
    fn mixer_ui(&mut self, ui: &mut Ui, edited: &mut Scene, changed: &mut bool) -> Option<String> {
        if !self.mixer.open {
            return None;
        }
        let panel = self.panels.panel(ui, Part::Mixer);
        let costs = self.live.costs();
        let known = MixerKnown { costs: &costs, saved: self.document.saved_scene() };
        let shown =
            panel.show(ui, |ui| filled(ui, |ui| self.mixer.ui(ui, &mut edited.lights, &known)));
        self.panels.note(Part::Mixer, &shown.response);
        let outcome = shown.inner;
        self.mixer.open = !outcome.close;
        self.select(outcome.select);
        self.note_edit(ui.ctx(), outcome.edit);
        *changed |= outcome.changed;
        outcome.step
    }

    /// Selects what was clicked, if anything was.
    pub(super) fn select(&mut self, selection: Option<Selection>) {
        if let Some(selection) = selection {
            self.selection = selection;
        }
        if let Some(Selection::Solid(i)) = selection {
            self.picked = Some(i);
        }
    }

    /// Outline and inspector.
    fn panels(&mut self, ui: &mut Ui, edited: &mut Scene, commands: &mut Vec<Command>) -> Outcome {
        self.selection = self.selection.within(edited);
        self.renaming.take_if(|field| !field.is_in(edited));
        let mut lists = Lists { subject: self.subject(), renaming: &mut self.renaming };
        let mut listed = OutlineOutcome::default();
        if self.panels.outline {
            let panel = self.panels.panel(ui, Part::Outline);
            let shown = panel.show(ui, |ui| outline_ui(ui, edited, &mut lists));
            self.panels.note(Part::Outline, &shown.response);
            listed = shown.inner;
        }
        let mut outcome = Outcome::default();
        if self.panels.inspector {
            let panel = self.panels.panel(ui, Part::Inspector);
            let shown = panel.show(ui, |ui| {
                let costs = self.live.costs();
                let saved = self.document.saved_scene();
                let presets = &self.presets;
                let known = Known { saved, costs: &costs, picked: self.picked, presets };
                inspector_ui(ui, edited, self.selection, &known)
            });
            self.panels.note(Part::Inspector, &shown.response);
            outcome = shown.inner;
        }
        outcome.select = outcome.select.or(listed.select);
        commands.extend(listed.command.or(outcome.command));
        self.step_name = outcome.step.take();
        if let Some(left) = listed.renamed {
            outcome.changed |= self.renamed(left, edited);
        }
        outcome
    }

    /// Takes over what was done in the panels; whether the scene was edited.
    fn apply_outcome(&mut self, outcome: Outcome, edited: &mut Scene) -> bool {
        let mut changed = outcome.changed;
        for (name, value) in outcome.assignments {
            match path::set(edited, &name, &value) {
                Ok(()) => changed = true,
                Err(error) => self.notices.error(error.to_string()),
            }
        }
        self.select(outcome.select);
        changed
    }

    /// The picture and the handles in it; whether the camera or a light was moved.
    fn picture_ui(&mut self, ui: &mut Ui, edited: &mut Scene) -> bool {
        self.prepare_comparison(ui);
        let (outcome, handled, dropped) = CentralPanel::no_frame()
            .show(ui, |ui| {
                self.view = ui.available_size();
                let view = ui.available_rect_before_wrap();
                let outcome = self.picture.ui(ui, &mut edited.camera);
                let place = self.picture.place(view, ui.pixels_per_point());
                self.comparison_ui(ui, place, view);
                let costs = self.live.costs();
                let stage = Stage::new(edited, [place, view], self.selection, &costs);
                let handled = self.handles.ui(ui, &stage, &mut edited.lights);
                self.pixel.mark_ui(ui, [place, view], edited.picture.size);
                let dropped = self.carried_ui(ui, [place, view], edited);
                self.notices.ui(ui);
                self.on_disk_ui(ui);
                (outcome, handled, dropped)
            })
            .inner;
        self.select(handled.select);
        // Where the pointer was last, pixels that are grown again come first.
        if outcome.pointer.is_some() {
            self.live.look_at(outcome.pointer);
        }
        self.pixel.look(outcome.hovered, outcome.clicked, edited.picture.size);
        let mut focused = false;
        if outcome.cropped && outcome.clicked.is_some() {
            // The first click of the two that took the region away was no choice.
            if let Some([before, after]) = self.latest_pick.take()
                && after == (self.selection, self.picked)
            {
                (self.selection, self.picked) = before;
            }
        } else if let Some(point) = outcome.clicked {
            match self.picture.focus_tool {
                true => focused = self.focus(point, &mut edited.camera),
                false => self.pick(point, edited, ui.input(|i| i.modifiers.alt)),
            }
        }
        if outcome.cropped {
            self.set_crop(self.picture.crop.region);
        }
        if outcome.camera_moved && !ui.input(|i| i.pointer.any_down()) {
            self.go_on_with(ui.ctx(), Run::Wheel);
        }
        outcome.camera_moved || handled.changed || focused || dropped
    }

    /// Focuses on what is seen at a point of the picture, once; whether the camera was changed.
    fn focus(&mut self, point: [f64; 2], camera: &mut Camera) -> bool {
        match focused(camera, self.live.pick(point)) {
            Ok(focus) => {
                self.picture.focus_tool = false;
                if camera.aperture == 0.0 {
                    self.notices
                        .say("focused; the lens is a pinhole until aperture is above 0".into());
                }
                let changed = camera.focus != focus;
                camera.focus = focus;
                changed
            }
            Err(why) => {
                self.notices.error(why);
                false
            }
        }
    }

    /// Selects what is seen at a point of the picture: its material, or itself.
    fn pick(&mut self, point: [f64; 2], edited: &Scene, itself: bool) {
        let (Some(picked), Some(shown)) = (self.live.pick(point), &self.shown) else { return };
        let before = (self.selection, self.picked);
        // The picture may show an earlier scene, whose things had other indices.
        let today = |selection: Selection| match selection.within(&shown.scene) {
            Selection::Scene => selection.within(edited),
            known => followed(&shown.scene, edited, known),
        };
        let solid = today(Selection::Solid(picked.solid));
        self.picked = match solid {
            Selection::Solid(i) => Some(i),
            _ => None,
        };
        self.selection = if itself { solid } else { today(Selection::Material(picked.material)) };
        self.latest_pick = Some([before, (self.selection, self.picked)]);
    }

    /// Makes an edited scene the document's, unless it makes no sense.
    pub(super) fn commit(&mut self, edited: Scene) {
        match flaw(self.document.scene(), &edited) {
            Some(message) => self.notices.error(message),
            None => {
                let before = self.document.shared_scene();
                self.document.change(edited);
                self.follow_names(&before);
                self.show_scene();
            }
        }
    }

    /// The same things are selected and picked as before, though others came or went.
    pub(super) fn follow_names(&mut self, before: &Scene) {
        let after = self.document.scene();
        let picked = |solid: usize| match followed(before, after, Selection::Solid(solid)) {
            Selection::Solid(solid) => Some(solid),
            _ => None,
        };
        self.latest_pick = None;
        self.selection = followed(before, after, self.selection);
        self.picked = self.picked.and_then(picked);
    }

    /// Passes the document's scene to the session.
    pub(super) fn show_scene(&mut self) {
        self.live.want(Arc::new(self.document.scene().clone()));
        self.files.touched();
    }

    /// Asks for the costs of what the inspector shows.
    fn watch_costs(&mut self) {
        let scene = self.document.scene();
        let mut wanted = paths(scene, self.selection.within(scene));
        wanted.extend(self.subject().assigned_path(scene));
        wanted.extend(self.mixer.paths(scene));
        wanted.extend(self.handles.hovered.clone());
        if self.watched.as_ref() != Some(&wanted) {
            self.live.watch_costs(wanted.clone());
            self.watched = Some(wanted);
        }
    }

    /// The document, for tests and measurements.
    pub fn document(&self) -> &Document {
        &self.document
    }

    /// The picture on the screen, for tests and measurements.
    pub fn shown(&self) -> Option<&Shown> {
        self.shown.as_ref()
    }

    /// The session, for tests and measurements.
    pub fn live(&self) -> &Live {
        &self.live
    }
}

impl eframe::App for App {
    fn ui(&mut self, ui: &mut Ui, _: &mut eframe::Frame) {
        App::ui(self, ui);
    }

    fn on_exit(&mut self, _: Option<&eframe::glow::Context>) {
        self.leave();
    }
}
