//! The list of keys and gestures.

use eframe::egui::{Context, Grid, RichText, Ui};

use super::app::App;
use super::command::{Command, keys_text};
use super::question::{first, question, scroll_up_to};

/// What the pointer does, and keys that are no commands.
const GESTURES: [(&str, &str); 13] = [
    ("Click in the picture", "Selects the material that is seen there"),
    ("Alt-click", "Selects the solid"),
    ("Wheel over the picture", "Enlarges or shrinks it about the pointer"),
    ("Drag in the picture", "Moves it; the middle button always does"),
    ("Drag with “Move camera”", "Turns the camera around its target; with Shift moves both"),
    ("Wheel with “Move camera”", "Moves the camera nearer or farther"),
    ("Drag with “Draw a region”", "What lies in the rectangle is traced first and to its end"),
    ("Double-click in the region", "Takes it away"),
    ("Drag a light's handle", "Moves or turns the light"),
    ("Hold Space", "While pictures are compared: shows the other one alone"),
    ("Drag the edge of a panel", "Makes it larger or smaller"),
    ("Tab, then arrows", "Goes from control to control, and changes a slider"),
    ("Ctrl with + and -", "Larger and smaller text and controls"),
];

impl App {
    /// The list, if it is open.
    pub(super) fn keys_ui(&mut self, ctx: &Context) {
        if !self.shows_keys {
            return;
        }
        let shown = question(ctx, "keys", list_ui);
        self.shows_keys = !shown.inner && !shown.should_close();
    }
}

/// Whether it was closed.
fn list_ui(ui: &mut Ui) -> bool {
    ui.heading("Keys and gestures");
    let height = ui.ctx().content_rect().height() - 140.0;
    scroll_up_to(height).hscroll(false).show(ui, |ui| {
        Grid::new("keys").num_columns(3).spacing([18.0, 4.0]).show(ui, |ui| {
            for (command, keys) in keyed() {
                ui.monospace(keys_text(ui.ctx(), &keys));
                ui.label(command.name());
                ui.weak(first_clause(command.about()));
                ui.end_row();
            }
        });
        ui.separator();
        Grid::new("gestures").num_columns(2).spacing([18.0, 4.0]).show(ui, |ui| {
            for (gesture, about) in GESTURES {
                ui.label(RichText::new(gesture));
                ui.weak(about);
                ui.end_row();
            }
        });
    });
    let close = ui.button("Close").on_hover_text("Goes back to the window");
    first(ui, &close);
    close.clicked()
}

/// Commands with keys, in the order of the menus.
fn keyed() -> impl Iterator<Item = (Command, eframe::egui::KeyboardShortcut)> {
    Command::ALL.into_iter().filter_map(|command| Some((command, command.shortcut()?)))
}

/// What a description says first: the list has one line for each.
fn first_clause(about: &str) -> &str {
    let end = about.find([';', ':', '.']).unwrap_or(about.len());
    &about[..end]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_list_has_a_line_for_every_key() {
        assert_eq!(keyed().count(), Command::with_shortcuts().len());
        assert!(keyed().all(|(command, _)| first_clause(command.about()).len() > 3));
        assert_eq!(first_clause("One; two"), "One");
        assert_eq!(first_clause("One"), "One");
    }
}
