//! The Help menu.

use eframe::egui::Ui;

use super::command::Command;
use super::menu::item;

/// Shows its items.
pub(super) fn help_menu(ui: &mut Ui, chosen: &mut Option<Command>) {
    item(ui, Command::Welcome, chosen);
    ui.separator();
    item(ui, Command::Diagnostics, chosen);
    item(ui, Command::LogFolder, chosen);
}
