//! Edits of sliders that last longer than the pointer is down: turns of the wheel, a click that may
//! become a double click.

use std::time::Instant;

use eframe::egui::Context;

use super::app::{App, WHEEL_REST};
use super::number::Edit;

impl App {
    /// Takes note of what was done with a control, before it is made a step of the history.
    pub(super) fn note_edit(&mut self, ctx: &Context, edit: Edit) {
        let Edit { changed, lasting, refused } = edit;
        if let Some(refusal) = refused {
            self.notices.say(refusal);
        }
        // Something else is edited: what lasted is a step of its own.
        if changed && self.lasting.is_some() && lasting != self.lasting {
            self.document.end_gesture();
            (self.lasting, self.wheel_until) = (None, None);
        }
        if lasting.is_some() {
            self.lasting = lasting;
            self.wheel_until = Some(Instant::now() + WHEEL_REST);
            ctx.request_repaint_after(WHEEL_REST);
        }
    }
}
