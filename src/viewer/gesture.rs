//! Edits of sliders that last longer than the pointer is down: turns of the wheel, a click that may
//! become a double click.

use eframe::egui::Context;

use super::app::App;
use super::commands::Run;
use super::number::Edit;

impl App {
    /// Takes note of what was done with a control, before it is made a step of the history.
    pub(super) fn note_edit(&mut self, ctx: &Context, edit: Edit) {
        let Edit { changed, lasting, refused } = edit;
        if let Some(refusal) = refused {
            self.notices.say(refusal);
        }
        let run = lasting.map(Run::Slider);
        // Something else is edited: what lasted is a step of its own.
        if changed && self.run.is_some_and(|(other, _)| Some(other) != run) {
            self.document.end_gesture();
            self.run = None;
        }
        if let Some(run) = run {
            self.go_on_with(ctx, run);
        }
    }
}
