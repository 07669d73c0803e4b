//! The menu bar.

use std::path::PathBuf;

use eframe::egui::{Align, Button, Label, Layout, MenuBar, Ui};

use super::command::{Command, TEXT_SIZES, keys_text};
use super::inspector::Selection;
use super::keep::KeepOffer;
use super::lists::{Subject, offer_ui};
use super::shapes::{ADD_SOLID, shapes_ui};
use crate::document::settings::Theme;
use crate::document::{Document, TEMPLATES};
use crate::scene::Scene;

/// What the menu needs to know.
pub(super) struct MenuState<'a> {
    /// For the names of undo and redo.
    pub(super) document: &'a Document,
    /// Files opened before.
    pub(super) recent: &'a [PathBuf],
    /// Whether what a command switches is on.
    pub(super) is_on: &'a dyn Fn(Command) -> bool,
    /// Why a command cannot be done now, if it cannot.
    pub(super) refusal: &'a dyn Fn(Command) -> Option<String>,
    /// What commands about lights, materials and solids are about.
    pub(super) subject: Subject,
    /// Whether what was traced can be kept.
    pub(super) keep: KeepOffer,
}

/// Shows the menu bar and its buttons; gives the command that was chosen.
pub(super) fn menu_ui(ui: &mut Ui, state: &MenuState<'_>) -> Option<Command> {
    let mut chosen = None;
    MenuBar::new().ui(ui, |ui| {
        ui.menu_button("File", |ui| file_menu(ui, state, &mut chosen))
            .response
            .on_hover_text("Open, save, export");
        ui.menu_button("Edit", |ui| edit_menu(ui, state, &mut chosen))
            .response
            .on_hover_text("Undo and redo; lights, materials and solids");
        ui.menu_button("Picture", |ui| items(ui, &PICTURE, state, &mut chosen))
            .response
            .on_hover_text("Brightness, clipping, the part that is traced first");
        ui.menu_button("View", |ui| view_menu(ui, state, &mut chosen))
            .response
            .on_hover_text("Size of the picture, panels, colours of the window");
        ui.menu_button("Help", |ui| items(ui, &HELP, state, &mut chosen)).response.on_hover_text(
            "Examples, all commands, keys and gestures, and what a report of a fault needs",
        );
        ui.separator();
        for (command, name) in [(Command::Undo, "Undo"), (Command::Redo, "Redo")] {
            let step = step(state.document, command);
            let button = ui.add_enabled(step.is_some(), Button::new(name));
            let about = step.map_or_else(|| command.about().to_owned(), |s| format!("{name}: {s}"));
            if button.on_hover_text(&about).on_disabled_hover_text(&about).clicked() {
                chosen = Some(command);
            }
        }
        ui.separator();
        for command in [Command::Fit, Command::ActualSize] {
            if ui.button(command.name()).on_hover_text(command.about()).clicked() {
                chosen = Some(command);
            }
        }
        for command in [Command::CameraTool, Command::Mixer, Command::Looks, Command::Compare] {
            let button = Button::selectable((state.is_on)(command), command.name());
            if ui.add(button).on_hover_text(command.about()).clicked() {
                chosen = Some(command);
            }
        }
        title_ui(ui, state.document);
    });
    chosen
}

/// The document's name at the right end, with a mark if it has unsaved changes.
fn title_ui(ui: &mut Ui, document: &Document) {
    let unsaved = document.is_unsaved();
    let text = if unsaved { format!("{} •", document.title()) } else { document.title() };
    let file =
        document.path().map_or("not saved to a file yet".into(), |p| p.display().to_string());
    ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
        let label = ui.add(Label::new(text).truncate());
        let state = if unsaved { "has unsaved changes" } else { "is saved" };
        label.on_hover_text(format!("{file}; {state}"));
    });
}

/// What undo or redo would do.
fn step(document: &Document, command: Command) -> Option<&str> {
    if command == Command::Undo { document.undo_name() } else { document.redo_name() }
}

fn file_menu(ui: &mut Ui, state: &MenuState<'_>, chosen: &mut Option<Command>) {
    ui.menu_button("New", |ui| {
        for (i, (name, _)) in TEMPLATES.iter().enumerate() {
            if ui.button(*name).on_hover_text(Command::New(i).about()).clicked() {
                *chosen = Some(Command::New(i));
            }
        }
    })
    .response
    .on_hover_text("Starts a scene from a template");
    item(ui, Command::Open, chosen);
    let recent = state.recent;
    ui.add_enabled_ui(!recent.is_empty(), |ui| {
        ui.menu_button("Open recent", |ui| {
            for (i, path) in recent.iter().enumerate() {
                let name = path.file_name().map_or_else(
                    || path.display().to_string(),
                    |name| name.to_string_lossy().into_owned(),
                );
                if ui.button(name).on_hover_text(path.display().to_string()).clicked() {
                    *chosen = Some(Command::OpenRecent(i));
                }
            }
        })
        .response
        .on_hover_text("Files opened or saved before")
    });
    ui.separator();
    item(ui, Command::Import, chosen);
    ui.separator();
    item(ui, Command::Save, chosen);
    item(ui, Command::SaveAs, chosen);
    ui.separator();
    item(ui, Command::Export, chosen);
    keep_item(ui, &state.keep, chosen);
    ui.separator();
    item(ui, Command::Quit, chosen);
}

fn keep_item(ui: &mut Ui, offer: &KeepOffer, chosen: &mut Option<Command>) {
    let button = with_keys(ui, Command::Keep, Command::Keep.name());
    let response = ui.add_enabled(offer.possible, button).on_disabled_hover_text(&offer.about);
    if response.on_hover_text(&offer.about).clicked() {
        *chosen = Some(Command::Keep);
        ui.close();
    }
}

fn edit_menu(ui: &mut Ui, state: &MenuState<'_>, chosen: &mut Option<Command>) {
    for command in [Command::Undo, Command::Redo] {
        let step = step(state.document, command);
        let name = step
            .map_or_else(|| command.name().to_owned(), |step| format!("{} {step}", command.name()));
        ui.add_enabled_ui(step.is_some(), |ui| labelled_item(ui, command, &name, chosen));
    }
    ui.separator();
    item(ui, Command::AddLight, chosen);
    item(ui, Command::AddMaterial, chosen);
    let add = ui.menu_button("Add solid", |ui| {
        shapes_ui(ui, state.subject, state.document.scene(), chosen);
    });
    add.response.on_hover_text(ADD_SOLID);
    ui.separator();
    things_ui(ui, state.subject, state.document.scene(), chosen);
}

/// The commands about a light, a material or a solid, as items of a menu.
pub(super) fn things_ui(
    ui: &mut Ui,
    subject: Subject,
    scene: &Scene,
    chosen: &mut Option<Command>,
) {
    let is_other = matches!(subject.selection, Selection::Light(_) | Selection::Solid(_));
    for command in Command::ON_THINGS {
        if is_other && command.needs_material() {
            continue;
        }
        let offer = subject.offer(command, scene);
        if offer_ui(ui, command, with_keys(ui, command, &offer.name), &offer).clicked() {
            *chosen = Some(command);
            ui.close();
        }
    }
}

/// How a command stands in a menu.
#[derive(Clone, Copy)]
enum Line {
    /// As what it does.
    Act(Command),
    /// As what it switches.
    Switch(Command),
    /// No command: a line between two groups.
    Rule,
}

const PICTURE: [Line; 13] = [
    Line::Act(Command::Brighter),
    Line::Act(Command::Darker),
    Line::Act(Command::NoExposure),
    Line::Rule,
    Line::Switch(Command::Clipping),
    Line::Switch(Command::SampleMap),
    Line::Rule,
    Line::Switch(Command::CropTool),
    Line::Act(Command::ClearCrop),
    Line::Rule,
    Line::Act(Command::Snapshot),
    Line::Switch(Command::Compare),
    Line::Switch(Command::FocusTool),
];

const VIEW: [Line; 19] = [
    Line::Act(Command::Fit),
    Line::Act(Command::ActualSize),
    Line::Act(Command::ZoomIn),
    Line::Act(Command::ZoomOut),
    Line::Rule,
    Line::Switch(Command::CameraTool),
    Line::Switch(Command::Handles),
    Line::Rule,
    Line::Switch(Command::Outline),
    Line::Switch(Command::Inspector),
    Line::Switch(Command::StatusLine),
    Line::Switch(Command::Mixer),
    Line::Switch(Command::Looks),
    Line::Switch(Command::Chart),
    Line::Switch(Command::Mass),
    Line::Switch(Command::Pixel),
    Line::Rule,
    Line::Act(Command::ResetLayout),
    Line::Rule,
];

const HELP: [Line; 7] = [
    Line::Act(Command::Welcome),
    Line::Rule,
    Line::Act(Command::Palette),
    Line::Act(Command::Shortcuts),
    Line::Rule,
    Line::Act(Command::Diagnostics),
    Line::Act(Command::LogFolder),
];

/// Shows lines of a menu.
fn items(ui: &mut Ui, lines: &[Line], state: &MenuState<'_>, chosen: &mut Option<Command>) {
    for line in lines {
        let (command, button) = match *line {
            Line::Rule => {
                ui.separator();
                continue;
            }
            Line::Act(command) => (command, with_keys(ui, command, command.name())),
            Line::Switch(command) => {
                let on = (state.is_on)(command);
                (command, with_keys(ui, command, command.name()).selected(on))
            }
        };
        let refusal = (state.refusal)(command);
        let response = ui.add_enabled(refusal.is_none(), button);
        let response = response.on_disabled_hover_text(refusal.as_deref().unwrap_or_default());
        if response.on_hover_text(command.about()).clicked() {
            *chosen = Some(command);
            ui.close();
        }
    }
}

fn view_menu(ui: &mut Ui, state: &MenuState<'_>, chosen: &mut Option<Command>) {
    items(ui, &VIEW, state, chosen);
    ui.menu_button("Colours and size", |ui| {
        let colours = [Theme::System, Theme::Light, Theme::Dark].map(Command::Colours);
        items(ui, &colours.map(Line::Switch), state, chosen);
        ui.separator();
        let sizes: [Line; TEXT_SIZES.len()] =
            std::array::from_fn(|index| Line::Switch(Command::TextSize(index)));
        items(ui, &sizes, state, chosen);
    })
    .response
    .on_hover_text("Light or dark; the size of text and controls");
}

pub(super) fn item(ui: &mut Ui, command: Command, chosen: &mut Option<Command>) {
    labelled_item(ui, command, command.name(), chosen);
}

fn labelled_item(ui: &mut Ui, command: Command, name: &str, chosen: &mut Option<Command>) {
    let button = with_keys(ui, command, name);
    let response = ui.add(button).on_disabled_hover_text(command.about());
    if response.on_hover_text(command.about()).clicked() {
        *chosen = Some(command);
        ui.close();
    }
}

/// A button with the keys that do the same.
fn with_keys<'a>(ui: &Ui, command: Command, name: &str) -> Button<'a> {
    let button = Button::new(name.to_owned());
    match command.shortcut() {
        Some(shortcut) => button.shortcut_text(keys_text(ui.ctx(), &shortcut)),
        None => button,
    }
}
