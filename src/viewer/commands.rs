//! What commands do, which of them can be done, and the keys that give them.

use std::time::{Duration, Instant};

use eframe::egui::{Context, Id, Popup, ViewportCommand};

use super::app::App;
use super::command::{Command, TEXT_SIZES};
use super::palette::Palette;
use super::shapes::addition_refusal;
use super::slider;
use super::style;

/// How long wheel and keys may rest within one gesture.
pub(super) const REST: Duration = Duration::from_millis(400);

/// What lasts over several turns and is one step of the history.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Run {
    /// Turns of the wheel that move the camera.
    Wheel,
    /// Presses of the keys of the exposure.
    Exposure,
    /// Turns of the wheel over this slider, or a click on it that may become a double click.
    Slider(Id),
}

impl App {
    /// Whether keys belong to the window and not to a question over it.
    pub(super) fn takes_keys(&self) -> bool {
        !self.files.is_modal() && self.palette.is_none() && !self.shows_keys
    }

    /// The commands whose keys were pressed, each as often as they were: a long turn brings many.
    pub(super) fn shortcuts(&self, ctx: &Context) -> Vec<Command> {
        if !self.takes_keys() {
            return Vec::new();
        }
        let focused = ctx.egui_wants_keyboard_input() && !slider::has_keyboard(ctx);
        // A text field has an undo of its own.
        let typing = ctx.text_edit_focused();
        // Escape closes an open menu first.
        let open = Popup::is_any_open(ctx) || self.renaming.is_some();
        let own = |command| typing && matches!(command, Command::Undo | Command::Redo);
        // Escape closes the welcome, too, before it stops anything.
        let closes = |command| command == Command::Stop && self.welcome.is_open();
        let pressed = Command::with_shortcuts().into_iter().flat_map(|(command, keys)| {
            let plain = (focused || open) && keys.modifiers.is_none();
            let count = match plain || own(command) || closes(command) {
                true => 0,
                false => {
                    ctx.input_mut(|i| i.count_and_consume_key(keys.modifiers, keys.logical_key))
                }
            };
            std::iter::repeat_n(command, count)
        });
        pressed.collect()
    }

    /// Does what a command says, or says why it cannot be done: keys are pressed whatever there is.
    pub(super) fn heed(&mut self, ctx: &Context, command: Command) {
        match self.refusal(command) {
            // Escape leaves whatever there is to leave, also nothing.
            Some(why) if command != Command::Stop => self.notices.say(why),
            _ => self.run(ctx, command),
        }
    }

    /// A gesture ends when no button is down, and wheel and keys rest.
    pub(super) fn end_gesture(&mut self, ctx: &Context) {
        let lasts = self.run.is_some_and(|(_, until)| Instant::now() < until);
        if !lasts && !ctx.input(|i| i.pointer.any_down()) {
            self.run = None;
            self.document.end_gesture();
        }
    }

    /// Begins or prolongs a gesture of several turns; one of another kind ends.
    pub(super) fn go_on_with(&mut self, ctx: &Context, run: Run) {
        if self.run.is_some_and(|(other, _)| other != run) {
            self.document.end_gesture();
        }
        self.run = Some((run, Instant::now() + REST));
        ctx.request_repaint_after(REST);
    }

    /// Does what a command says.
    fn run(&mut self, ctx: &Context, command: Command) {
        let dots = ctx.pixels_per_point();
        if let Some(part) = command.part() {
            let open = self.open_flag(part);
            *open = !*open;
            return;
        }
        match command {
            Command::Undo | Command::Redo => {
                self.document.end_gesture();
                let undo = command == Command::Undo;
                let before = self.document.shared_scene();
                if if undo { self.document.undo() } else { self.document.redo() } {
                    self.follow_names(&before);
                    self.show_scene();
                }
            }
            Command::Fit => self.picture.fit(),
            Command::ActualSize => self.picture.actual_size(),
            Command::ZoomIn => self.picture.zoom_by(1.25, self.view, dots),
            Command::ZoomOut => self.picture.zoom_by(0.8, self.view, dots),
            Command::CameraTool => self.picture.camera_tool = !self.picture.camera_tool,
            Command::FocusTool => self.picture.focus_tool = !self.picture.focus_tool,
            Command::Handles => self.handles.hidden = !self.handles.hidden,
            Command::Snapshot => self.take_snapshot(),
            Command::Compare => self.compare.wipe = !self.compare.wipe,
            Command::SampleMap => self.toggle_sample_map(),
            Command::Brighter | Command::Darker | Command::NoExposure => {
                self.change_exposure(ctx, command);
            }
            Command::Clipping => self.toggle_clipping(),
            Command::CropTool => self.picture.crop.tool = !self.picture.crop.tool,
            Command::ClearCrop => self.set_crop(None),
            Command::ResetLayout => self.reset_layout(),
            Command::Welcome => self.open_welcome(ctx),
            Command::Diagnostics => self.copy_diagnostics(ctx),
            Command::LogFolder => self.show_log_folder(),
            Command::Palette => self.palette = Some(Palette::default()),
            Command::Shortcuts => self.shows_keys = true,
            // Escape leaves the tool first.
            Command::Stop if self.picture.crop.tool => self.picture.crop.tool = false,
            Command::Stop => self.live.cancel(),
            Command::Resume => self.live.resume(),
            Command::Quit => ctx.send_viewport_cmd(ViewportCommand::Close),
            other => self.run_elsewhere(ctx, other),
        }
    }

    /// The commands about the window's look, about lights, materials and solids, and about files.
    fn run_elsewhere(&mut self, ctx: &Context, command: Command) {
        match command {
            Command::Colours(theme) => {
                self.settings.theme = theme;
                self.apply_settings(ctx);
            }
            Command::TextSize(index) => {
                if let Some((percent, _)) = TEXT_SIZES.get(index) {
                    self.settings.zoom_percent = *percent;
                    self.apply_settings(ctx);
                }
            }
            Command::AddLight
            | Command::AddMaterial
            | Command::Duplicate
            | Command::Rename
            | Command::Delete
            | Command::Assign => {
                // The name is changed in the list.
                self.panels.outline |= command == Command::Rename;
                self.run_on_things(command);
            }
            Command::AddSolid(kind) => self.add_solid(ctx, kind),
            Command::CopyMaterial | Command::PasteMaterial => self.run_on_clipboard(ctx, command),
            _ => self.run_file_command(ctx, command),
        }
    }

    fn apply_settings(&mut self, ctx: &Context) {
        style::apply(ctx, &self.settings);
        self.remember_settings();
    }

    /// Moves the exposure to the next third of a stop, or to 0; presses without a rest are one step.
    fn change_exposure(&mut self, ctx: &Context, command: Command) {
        let mut scene = self.document.scene().clone();
        let present = scene.picture.exposure;
        scene.picture.exposure = match command {
            Command::Brighter => next_third(present, 1.0),
            Command::Darker => next_third(present, -1.0),
            _ => 0.0,
        };
        if self.run.is_none() {
            self.document.end_gesture();
        }
        self.go_on_with(ctx, Run::Exposure);
        self.commit(scene);
    }

    /// Why a command cannot be done now, if it cannot.
    pub(super) fn refusal(&self, command: Command) -> Option<String> {
        let why = match command {
            Command::Undo if self.document.undo_name().is_none() => "Nothing was changed",
            Command::Redo if self.document.redo_name().is_none() => "Nothing was taken back",
            Command::Keep => {
                let offer = self.keep_offer();
                return (!offer.possible).then_some(offer.about);
            }
            Command::Duplicate
            | Command::Rename
            | Command::Delete
            | Command::Assign
            | Command::CopyMaterial
            | Command::PasteMaterial => {
                self.subject().offer(command, self.document.scene()).refusal?
            }
            Command::AddSolid(kind) => {
                addition_refusal(self.subject(), kind, self.document.scene())?
            }
            Command::Stop if self.live.status().job.is_none() => "Nothing runs",
            Command::Resume if !self.live.status().held => "Nothing was stopped",
            Command::NoExposure if self.document.scene().picture.exposure == 0.0 => {
                "The exposure is 0"
            }
            Command::ClearCrop if self.picture.crop.region.is_none() => "No region is set",
            _ => return None,
        };
        Some(why.to_owned())
    }

    /// Whether what a command switches is on.
    pub(super) fn is_on(&self, command: Command) -> bool {
        match command {
            Command::CameraTool => self.picture.camera_tool,
            Command::FocusTool => self.picture.focus_tool,
            Command::CropTool => self.picture.crop.tool,
            Command::Handles => !self.handles.hidden,
            Command::Compare => self.compare.wipe,
            Command::SampleMap => self.sample_map,
            Command::Clipping => self.clipping,
            Command::Outline => self.panels.outline,
            Command::Inspector => self.panels.inspector,
            Command::StatusLine => self.panels.status,
            Command::Mixer => self.mixer.open,
            Command::Looks => self.strip.open,
            Command::Chart => self.chart.open,
            Command::Mass => self.mass.open,
            Command::Pixel => self.pixel.open,
            Command::Colours(theme) => self.settings.theme == theme,
            Command::TextSize(index) => {
                TEXT_SIZES.get(index).is_some_and(|size| size.0 == self.settings.zoom_percent)
            }
            _ => false,
        }
    }
}

/// The next whole third of a stop in a direction, 1 or -1, in two digits, within what a scene takes.
fn next_third(stops: f32, direction: f32) -> f32 {
    // 0.33 and 0.67 are thirds.
    let thirds = (stops * direction * 3.0 + 0.05).floor() + 1.0;
    let stops = (thirds * direction / 3.0).clamp(-30.0, 30.0);
    (stops * 100.0).round() / 100.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exposure_goes_by_thirds_of_a_stop() {
        let mut stops = 0.0;
        for expected in [0.33, 0.67, 1.0, 1.33] {
            stops = next_third(stops, 1.0);
            assert_eq!(stops, expected);
        }
        for expected in [1.0, 0.67, 0.33, 0.0, -0.33, -0.67, -1.0] {
            stops = next_third(stops, -1.0);
            assert_eq!(stops, expected);
        }
        assert_eq!((next_third(0.5, 1.0), next_third(0.5, -1.0)), (0.67, 0.33));
        assert_eq!((next_third(30.0, 1.0), next_third(-30.0, -1.0)), (30.0, -30.0));
    }
}
