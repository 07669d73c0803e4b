//! The menu bar.

use eframe::egui::{Align, Button, Label, Layout, MenuBar, Ui};

use super::command::Command;
use super::help::help_menu;
use super::inspector::Selection;
use super::keep::KeepOffer;
use super::lists::{Subject, offer_ui};
use crate::document::settings::{Settings, Theme};
use crate::document::{Document, TEMPLATES};
use crate::scene::Scene;

/// What the menu needs to know.
pub(super) struct MenuState<'a> {
    /// For the names of undo and redo.
    pub(super) document: &'a Document,
    /// Whether drags move the camera.
    pub(super) camera_tool: bool,
    /// Whether a click focuses the camera.
    pub(super) focus_tool: bool,
    /// Whether the lights have handles.
    pub(super) handles: bool,
    /// Whether the light mixer shows.
    pub(super) mixer: bool,
    /// Whether looks and snapshots show.
    pub(super) looks: bool,
    /// Whether the picture is compared with another one.
    pub(super) compare: bool,
    /// Whether the sample map shows in the picture's place.
    pub(super) sample_map: bool,
    /// Whether the chart of speed against accuracy shows.
    pub(super) chart: bool,
    /// Whether the panel of mass properties shows.
    pub(super) mass: bool,
    /// Whether the panel of a pixel shows.
    pub(super) pixel: bool,
    /// What commands about lights and materials are about.
    pub(super) subject: Subject,
    /// Whether what was traced can be kept.
    pub(super) keep: KeepOffer,
}

/// Shows the menu bar and its buttons; gives the command that was chosen. Theme and zoom are set at
/// once.
pub(super) fn menu_ui(
    ui: &mut Ui,
    state: &MenuState<'_>,
    settings: &mut Settings,
) -> Option<Command> {
    let mut chosen = None;
    MenuBar::new().ui(ui, |ui| {
        ui.menu_button("File", |ui| file_menu(ui, state, settings, &mut chosen))
            .response
            .on_hover_text("Open, save, export");
        ui.menu_button("Edit", |ui| edit_menu(ui, state, &mut chosen))
            .response
            .on_hover_text("Undo and redo; lights and materials");
        ui.menu_button("View", |ui| view_menu(ui, state, settings, &mut chosen))
            .response
            .on_hover_text("Size of the picture, lights, colours of the window");
        ui.menu_button("Help", |ui| help_menu(ui, &mut chosen))
            .response
            .on_hover_text("Examples, and what a report of a fault needs");
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
        for (command, on) in [
            (Command::CameraTool, state.camera_tool),
            (Command::Mixer, state.mixer),
            (Command::Looks, state.looks),
            (Command::Compare, state.compare),
        ] {
            let button = Button::selectable(on, command.name());
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

fn file_menu(
    ui: &mut Ui,
    state: &MenuState<'_>,
    settings: &Settings,
    chosen: &mut Option<Command>,
) {
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
    let recent = &settings.recent;
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
    ui.separator();
    things_ui(ui, state.subject, state.document.scene(), chosen);
}

/// The commands about a light or a material, as items of a menu.
pub(super) fn things_ui(
    ui: &mut Ui,
    subject: Subject,
    scene: &Scene,
    chosen: &mut Option<Command>,
) {
    let is_light = matches!(subject.selection, Selection::Light(_));
    for command in Command::ON_THINGS {
        if is_light && command == Command::Assign {
            continue;
        }
        let offer = subject.offer(command, scene);
        if offer_ui(ui, command, with_keys(ui, command, &offer.name), &offer).clicked() {
            *chosen = Some(command);
            ui.close();
        }
    }
}

fn view_menu(
    ui: &mut Ui,
    state: &MenuState<'_>,
    settings: &mut Settings,
    chosen: &mut Option<Command>,
) {
    for command in [Command::Fit, Command::ActualSize, Command::ZoomIn, Command::ZoomOut] {
        item(ui, command, chosen);
    }
    item(ui, Command::CameraTool, chosen);
    item(ui, Command::Snapshot, chosen);
    ui.separator();
    for (command, on) in [
        (Command::FocusTool, state.focus_tool),
        (Command::Handles, state.handles),
        (Command::Mixer, state.mixer),
        (Command::Looks, state.looks),
        (Command::Compare, state.compare),
        (Command::Chart, state.chart),
        (Command::Mass, state.mass),
        (Command::Pixel, state.pixel),
        (Command::SampleMap, state.sample_map),
    ] {
        let button = with_keys(ui, command, command.name()).selected(on);
        if ui.add(button).on_hover_text(command.about()).clicked() {
            *chosen = Some(command);
            ui.close();
        }
    }
    ui.separator();
    for (theme, name) in
        [(Theme::System, "As the system"), (Theme::Light, "Light"), (Theme::Dark, "Dark")]
    {
        let button = Button::selectable(settings.theme == theme, name);
        if ui.add(button).on_hover_text("Colours of the window").clicked() {
            settings.theme = theme;
        }
    }
    ui.separator();
    for percent in [80, 100, 125, 150, 200] {
        let button = Button::selectable(settings.zoom_percent == percent, format!("{percent} %"));
        if ui.add(button).on_hover_text("Size of text and controls").clicked() {
            settings.zoom_percent = percent;
        }
    }
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
        Some(shortcut) => button.shortcut_text(ui.ctx().format_shortcut(&shortcut)),
        None => button,
    }
}
