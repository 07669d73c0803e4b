//! Everything the window can be told to do, listed once: menus, shortcuts, palette and tooltips read this list.

use eframe::egui::{Context, Key, KeyboardShortcut, Modifiers};

use super::shapes::KINDS;
use crate::document::arrangement::Part;
use crate::document::settings::Theme;

/// A command of the window.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Command {
    /// A new scene from the template with this index.
    New(usize),
    /// Asks for a scene file and opens it.
    Open,
    /// Opens a copy of the example with this index.
    Example(usize),
    /// Opens the recent file with this index.
    OpenRecent(usize),
    /// Asks for another program's file and makes a scene of it.
    Import,
    /// Saves to the document's file; asks for one if there is none.
    Save,
    /// Asks for a file and saves to it.
    SaveAs,
    /// Asks how and where to write a picture.
    Export,
    /// Writes what was traced beside the scene file.
    Keep,
    /// Leaves the program.
    Quit,
    /// Takes the latest step back.
    Undo,
    /// Does it again.
    Redo,
    /// Adds a light.
    AddLight,
    /// Adds a material.
    AddMaterial,
    /// Adds a solid of the kind with this index in [`KINDS`].
    AddSolid(usize),
    /// Copies the selected light, material or solid.
    Duplicate,
    /// Gives it another name.
    Rename,
    /// Takes it out.
    Delete,
    /// Gives the selected material to the solid clicked last.
    Assign,
    /// Puts the selected material on the clipboard.
    CopyMaterial,
    /// Gives the selected material the values of the one on the clipboard.
    PasteMaterial,
    /// The whole picture in the window.
    Fit,
    /// One pixel of the picture on one pixel of the screen.
    ActualSize,
    /// Enlarges the picture on the screen.
    ZoomIn,
    /// Shrinks the picture on the screen.
    ZoomOut,
    /// Whether dragging in the picture moves the camera.
    CameraTool,
    /// Whether the next click in the picture focuses the camera.
    FocusTool,
    /// Whether the lights have handles in the picture.
    Handles,
    /// Raises the exposure to the next third of a stop.
    Brighter,
    /// Lowers it.
    Darker,
    /// Makes it 0.
    NoExposure,
    /// Whether clipped pixels are marked.
    Clipping,
    /// Whether the next drag in the picture draws the part that is traced first.
    CropTool,
    /// Takes that part away.
    ClearCrop,
    /// Whether the list of what the scene holds shows.
    Outline,
    /// Whether the parameters of what is selected show.
    Inspector,
    /// Whether the status line shows.
    StatusLine,
    /// All panels as they were at first.
    ResetLayout,
    /// Colours of the window.
    Colours(Theme),
    /// Text and controls as large as [`TEXT_SIZES`] has it at this index.
    TextSize(usize),
    /// A list of all commands to choose from by typing.
    Palette,
    /// The list of keys and gestures.
    Shortcuts,
    /// Whether the light mixer shows.
    Mixer,
    /// Whether looks and snapshots show.
    Looks,
    /// Keeps the picture and its settings in the strip.
    Snapshot,
    /// Whether the picture is compared with another one.
    Compare,
    /// Whether the chart of speed against accuracy shows.
    Chart,
    /// Whether the panel of mass properties shows.
    Mass,
    /// Whether the panel of a pixel and its ray tree shows.
    Pixel,
    /// Whether the picture shows how many samples its pixels have.
    SampleMap,
    /// Shows ways to begin, recent files and examples.
    Welcome,
    /// Copies what a report of a fault needs.
    Diagnostics,
    /// Shows where the log is.
    LogFolder,
    /// Stops the running trace, export or keeping.
    Stop,
    /// Traces what a stop left out.
    Resume,
}

/// Keys as they are printed on a keyboard: egui spells some of them.
pub(super) fn keys_text(ctx: &Context, keys: &KeyboardShortcut) -> String {
    let sign = match keys.logical_key {
        Key::OpenBracket => "[",
        Key::CloseBracket => "]",
        Key::Plus => "+",
        Key::Minus => "-",
        Key::Questionmark => "?",
        _ => return ctx.format_shortcut(keys),
    };
    sign.to_owned()
}

/// Sizes of text and controls to choose from: per cent, and what they are called.
pub(super) const TEXT_SIZES: [(u32, &str); 5] = [
    (80, "Size of text 80 %"),
    (100, "Size of text 100 %"),
    (125, "Size of text 125 %"),
    (150, "Size of text 150 %"),
    (200, "Size of text 200 %"),
];

const CTRL: Modifiers = Modifiers::COMMAND;

impl Command {
    /// What menus and buttons call it.
    pub(super) fn name(self) -> &'static str {
        match self {
            Command::New(_) => "New",
            Command::Open => "Open…",
            Command::Example(_) => "Open example",
            Command::OpenRecent(_) => "Open recent",
            Command::Import => "Import…",
            Command::Save => "Save",
            Command::SaveAs => "Save as…",
            Command::Export => "Export picture…",
            Command::Keep => "Keep traced",
            Command::Quit => "Quit",
            Command::Undo => "Undo",
            Command::Redo => "Redo",
            Command::AddLight => "Add light",
            Command::AddMaterial => "Add material",
            Command::AddSolid(kind) => KINDS.get(kind).map_or("Add solid", |kind| kind.name),
            Command::Duplicate => "Duplicate",
            Command::Rename => "Rename",
            Command::Delete => "Delete",
            Command::Assign => "Assign to picked solid",
            Command::CopyMaterial => "Copy material",
            Command::PasteMaterial => "Paste material",
            Command::Fit => "Fit",
            Command::ActualSize => "1:1",
            Command::ZoomIn => "Zoom in",
            Command::ZoomOut => "Zoom out",
            Command::CameraTool => "Move camera",
            Command::FocusTool => "Focus by click",
            Command::Handles => "Light handles",
            Command::Brighter => "Brighter",
            Command::Darker => "Darker",
            Command::NoExposure => "Exposure 0",
            Command::Clipping => "Mark clipped pixels",
            Command::CropTool => "Draw a region",
            Command::ClearCrop => "Clear the region",
            Command::Outline => "Outline",
            Command::Inspector => "Inspector",
            Command::StatusLine => "Status line",
            Command::ResetLayout => "Reset layout",
            Command::Colours(Theme::System) => "Colours as the system",
            Command::Colours(Theme::Light) => "Light colours",
            Command::Colours(Theme::Dark) => "Dark colours",
            Command::TextSize(index) => TEXT_SIZES.get(index).map_or("Size of text", |s| s.1),
            Command::Palette => "All commands…",
            Command::Shortcuts => "Keys and gestures",
            Command::Mixer => "Light mixer",
            Command::Looks => "Looks",
            Command::Snapshot => "Take a snapshot",
            Command::Compare => "Compare",
            Command::Chart => "Speed and accuracy",
            Command::Mass => "Mass properties",
            Command::Pixel => "Pixel and its rays",
            Command::SampleMap => "Sample map",
            Command::Welcome => "Welcome",
            Command::Diagnostics => "Copy diagnostics",
            Command::LogFolder => "Show log folder",
            Command::Stop => "Stop",
            Command::Resume => "Trace now",
        }
    }

    /// What it does, one sentence.
    pub(super) fn about(self) -> &'static str {
        match self {
            Command::New(_) => "Starts a scene from this template",
            Command::Open => "Opens a scene file",
            Command::Example(_) => "Opens a copy of this example",
            Command::OpenRecent(_) => "Opens this file again",
            Command::Import => "Makes a scene of an OBJ, glTF, GLB or NFF file and opens it",
            Command::Save => "Writes the changed values into the scene file; its comments stay",
            Command::SaveAs => "Saves to another file; paths of meshes are adapted",
            Command::Export => {
                "Writes the picture as PNG, OpenEXR or Radiance HDR, at its own size or another"
            }
            Command::Keep => {
                "Writes what was traced beside the scene file, so that the next opening casts no ray"
            }
            Command::Quit => "Closes the window",
            Command::Undo => "Takes the latest change back",
            Command::Redo => "Makes the change again that was taken back last",
            Command::AddLight => "Adds a white light at the upper left of the picture",
            Command::AddMaterial => "Adds a matt white material, which no solid uses yet",
            Command::AddSolid(kind) => KINDS.get(kind).map_or("", |kind| kind.about),
            Command::Duplicate => {
                "Adds a copy under another name; a solid's stands beside it, made of the same"
            }
            Command::Rename => "Changes the name here and wherever the scene file uses it",
            Command::Delete => {
                "Takes it out of the scene; a material must not be in use, a solid no part of another. \
                 What a deleted solid was made of stays, as solids of their own"
            }
            Command::Assign => "Gives this material to the solid that was clicked last",
            Command::CopyMaterial => "Copies its values, as a scene file writes them",
            Command::PasteMaterial => {
                "Gives it the values of the material that was copied; it keeps its name"
            }
            Command::Fit => "Shows the whole picture",
            Command::ActualSize => "Shows one picture pixel on one pixel of the screen",
            Command::ZoomIn => "Enlarges the picture; or turn the wheel over it",
            Command::ZoomOut => "Shrinks the picture; or turn the wheel over it",
            Command::CameraTool => {
                "Drag orbits, Shift-drag pans, the wheel dollies; every move traces the picture anew"
            }
            Command::FocusTool => {
                "The next click in the picture puts what is there into focus; the camera's aperture \
                 says how much the rest is blurred"
            }
            Command::Handles => "Handles in the picture that move and turn the lights",
            Command::Brighter => "Raises the exposure to the next third of a stop",
            Command::Darker => "Lowers the exposure to the next third of a stop",
            Command::NoExposure => "Shows the light as it is",
            Command::Clipping => {
                "Marks pixels that the screen cannot show: red where a channel is too bright, blue where it \
                 is darker than black. On the screen only; the status line says how many"
            }
            Command::CropTool => {
                "Drag a rectangle in the picture: what lies in it is traced first and to its end"
            }
            Command::ClearCrop => "Traces the picture evenly again; or double-click the region",
            Command::Outline => "The list of lights, materials and solids at the left",
            Command::Inspector => "The parameters of what is selected, at the right",
            Command::StatusLine => "What runs, and what the last edit cost, below",
            Command::ResetLayout => {
                "Every panel as large as it was at first, and shown or hidden so"
            }
            Command::Colours(_) => "Colours of the window",
            Command::TextSize(_) => "Size of text and controls; also Ctrl with + and -",
            Command::Palette => "Finds a command by some letters of its name",
            Command::Shortcuts => "What keys and the pointer do",
            Command::Mixer => "All lights side by side: on, solo, stops, colour, temperature",
            Command::Looks => "Looks and snapshots below the picture, to be switched between",
            Command::Snapshot => "Keeps picture and settings until the window closes",
            Command::Compare => {
                "A wipe between the picture and what was saved, a look or a snapshot; \
                 hold Space to see that alone"
            }
            Command::Chart => {
                "Measures samples, depth, cut-off and adaptive step here, and recommends settings"
            }
            Command::Mass => "Volume, centre of mass and inertia of the selected solid, by rays",
            Command::Pixel => {
                "Colour, ray tree and shares of the pixel that is clicked: why it has this colour"
            }
            Command::SampleMap => {
                "Where adaptive sampling (trace.adaptive) spends its rays: white pixels have all samples"
            }
            Command::Welcome => "New scenes, recent files and examples, below the picture",
            Command::Diagnostics => {
                "Copies version, system, graphics card, settings and the end of the log, for a report"
            }
            Command::LogFolder => "Opens the folder in which the log file is",
            Command::Stop => "Stops what runs; the last whole picture stays",
            Command::Resume => "Traces the picture that was stopped",
        }
    }

    /// The keys that give it.
    pub(super) fn shortcut(self) -> Option<KeyboardShortcut> {
        let keys = |modifiers, key| Some(KeyboardShortcut::new(modifiers, key));
        match self {
            Command::Open => keys(CTRL, Key::O),
            Command::Save => keys(CTRL, Key::S),
            Command::SaveAs => keys(CTRL | Modifiers::SHIFT, Key::S),
            Command::Export => keys(CTRL, Key::E),
            Command::Quit => keys(CTRL, Key::Q),
            Command::Undo => keys(CTRL, Key::Z),
            Command::Redo => keys(CTRL | Modifiers::SHIFT, Key::Z),
            Command::Fit => keys(Modifiers::NONE, Key::F),
            Command::ActualSize => keys(Modifiers::NONE, Key::Num1),
            Command::CameraTool => keys(Modifiers::NONE, Key::C),
            Command::FocusTool => keys(Modifiers::NONE, Key::D),
            Command::ZoomIn => keys(Modifiers::NONE, Key::Plus),
            Command::ZoomOut => keys(Modifiers::NONE, Key::Minus),
            Command::Stop => keys(Modifiers::NONE, Key::Escape),
            Command::Duplicate => keys(CTRL, Key::D),
            Command::Rename => keys(Modifiers::NONE, Key::F2),
            Command::Delete => keys(Modifiers::NONE, Key::Delete),
            Command::Handles => keys(Modifiers::NONE, Key::H),
            Command::Brighter => keys(Modifiers::NONE, Key::CloseBracket),
            Command::Darker => keys(Modifiers::NONE, Key::OpenBracket),
            Command::NoExposure => keys(Modifiers::NONE, Key::Num0),
            Command::Clipping => keys(Modifiers::NONE, Key::X),
            Command::CropTool => keys(Modifiers::NONE, Key::R),
            Command::Outline => keys(Modifiers::NONE, Key::O),
            Command::Inspector => keys(Modifiers::NONE, Key::N),
            Command::Palette => keys(CTRL, Key::K),
            Command::Shortcuts => keys(Modifiers::NONE, Key::Questionmark),
            Command::Mixer => keys(Modifiers::NONE, Key::L),
            Command::Pixel => keys(Modifiers::NONE, Key::I),
            Command::Looks => keys(Modifiers::NONE, Key::K),
            Command::Snapshot => keys(Modifiers::NONE, Key::S),
            Command::Compare => keys(Modifiers::NONE, Key::W),
            Command::New(_)
            | Command::Example(_)
            | Command::OpenRecent(_)
            | Command::Welcome
            | Command::Diagnostics
            | Command::LogFolder
            | Command::Import
            | Command::Keep
            | Command::AddLight
            | Command::AddMaterial
            | Command::AddSolid(_)
            | Command::Assign
            | Command::CopyMaterial
            | Command::PasteMaterial
            | Command::Chart
            | Command::Mass
            | Command::SampleMap
            | Command::ClearCrop
            | Command::StatusLine
            | Command::ResetLayout
            | Command::Colours(_)
            | Command::TextSize(_)
            | Command::Resume => None,
        }
    }

    /// The commands with shortcuts. Those with more modifiers come first, so that Shift-Ctrl-Z is
    /// not taken for Ctrl-Z.
    pub(super) fn with_shortcuts() -> Vec<(Command, KeyboardShortcut)> {
        let keyed = Command::ALL.into_iter().filter_map(|c| Some((c, c.shortcut()?)));
        let mut keyed: Vec<_> = keyed.collect();
        let modifiers = |keys: &KeyboardShortcut| {
            let Modifiers { alt, ctrl, shift, mac_cmd, command } = keys.modifiers;
            [alt, ctrl, shift, mac_cmd, command].into_iter().filter(|down| *down).count()
        };
        keyed.sort_by_key(|(_, keys)| std::cmp::Reverse(modifiers(keys)));
        keyed
    }

    /// The panel that it shows or hides.
    pub(super) fn part(self) -> Option<Part> {
        match self {
            Command::Outline => Some(Part::Outline),
            Command::Inspector => Some(Part::Inspector),
            Command::StatusLine => Some(Part::Status),
            Command::Mixer => Some(Part::Mixer),
            Command::Looks => Some(Part::Looks),
            Command::Chart => Some(Part::Chart),
            Command::Mass => Some(Part::Mass),
            Command::Pixel => Some(Part::Pixel),
            _ => None,
        }
    }

    /// Every command, in the order of the menus.
    pub(super) const ALL: [Command; 102] = [
        Command::New(0),
        Command::New(1),
        Command::New(2),
        Command::Open,
        Command::OpenRecent(0),
        Command::OpenRecent(1),
        Command::OpenRecent(2),
        Command::OpenRecent(3),
        Command::OpenRecent(4),
        Command::OpenRecent(5),
        Command::OpenRecent(6),
        Command::OpenRecent(7),
        Command::OpenRecent(8),
        Command::OpenRecent(9),
        Command::Example(0),
        Command::Example(1),
        Command::Example(2),
        Command::Example(3),
        Command::Example(4),
        Command::Example(5),
        Command::Example(6),
        Command::Example(7),
        Command::Example(8),
        Command::Example(9),
        Command::Example(10),
        Command::Example(11),
        Command::Example(12),
        Command::Example(13),
        Command::Import,
        Command::Save,
        Command::SaveAs,
        Command::Export,
        Command::Keep,
        Command::Quit,
        Command::Undo,
        Command::Redo,
        Command::AddLight,
        Command::AddMaterial,
        Command::AddSolid(0),
        Command::AddSolid(1),
        Command::AddSolid(2),
        Command::AddSolid(3),
        Command::AddSolid(4),
        Command::AddSolid(5),
        Command::AddSolid(6),
        Command::AddSolid(7),
        Command::AddSolid(8),
        Command::AddSolid(9),
        Command::AddSolid(10),
        Command::AddSolid(11),
        Command::AddSolid(12),
        Command::AddSolid(13),
        Command::AddSolid(14),
        Command::AddSolid(15),
        Command::AddSolid(16),
        Command::AddSolid(17),
        Command::Duplicate,
        Command::Rename,
        Command::Delete,
        Command::Assign,
        Command::CopyMaterial,
        Command::PasteMaterial,
        Command::Fit,
        Command::ActualSize,
        Command::ZoomIn,
        Command::ZoomOut,
        Command::CameraTool,
        Command::FocusTool,
        Command::Handles,
        Command::Snapshot,
        Command::Compare,
        Command::Brighter,
        Command::Darker,
        Command::NoExposure,
        Command::Clipping,
        Command::CropTool,
        Command::ClearCrop,
        Command::SampleMap,
        Command::Outline,
        Command::Inspector,
        Command::StatusLine,
        Command::Mixer,
        Command::Looks,
        Command::Chart,
        Command::Mass,
        Command::Pixel,
        Command::ResetLayout,
        Command::Colours(Theme::System),
        Command::Colours(Theme::Light),
        Command::Colours(Theme::Dark),
        Command::TextSize(0),
        Command::TextSize(1),
        Command::TextSize(2),
        Command::TextSize(3),
        Command::TextSize(4),
        Command::Welcome,
        Command::Palette,
        Command::Shortcuts,
        Command::Diagnostics,
        Command::LogFolder,
        Command::Stop,
        Command::Resume,
    ];

    /// The commands about the selected light, material or solid.
    pub(super) const ON_THINGS: [Command; 6] = [
        Command::Duplicate,
        Command::Rename,
        Command::Delete,
        Command::Assign,
        Command::CopyMaterial,
        Command::PasteMaterial,
    ];

    /// Whether it is about materials alone.
    pub(super) fn needs_material(self) -> bool {
        matches!(self, Command::Assign | Command::CopyMaterial | Command::PasteMaterial)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::TEMPLATES;
    use crate::document::examples::EXAMPLES;
    use crate::document::settings::MOST_RECENT;

    #[test]
    fn no_two_commands_share_a_shortcut() {
        let keys: Vec<_> = Command::with_shortcuts().into_iter().map(|(_, keys)| keys).collect();
        assert!(keys.len() > 25);
        for (i, a) in keys.iter().enumerate() {
            assert!(!keys[..i].contains(a), "{a:?}");
        }
    }

    #[test]
    fn shortcuts_with_more_modifiers_are_asked_for_first() {
        let order: Vec<_> = Command::with_shortcuts().into_iter().map(|(c, _)| c).collect();
        let at = |command| order.iter().position(|c| *c == command).expect("it has keys");
        assert!(
            at(Command::SaveAs) < at(Command::Save) && at(Command::Save) < at(Command::Snapshot)
        );
        assert!(at(Command::Redo) < at(Command::Undo));
    }

    /// The names of the variants, as this file's text has them.
    fn variants() -> Vec<&'static str> {
        let text = include_str!("command.rs");
        let body = text.split("enum Command {").nth(1).and_then(|rest| rest.split("\n}").next());
        let lines = body.expect("the enum").lines().map(str::trim);
        let names = lines.filter(|line| line.starts_with(char::is_uppercase));
        names.map(|line| line.split(['(', ',']).next().unwrap_or_default()).collect()
    }

    #[test]
    fn every_variant_is_in_the_list_once_per_value() {
        let listed: Vec<String> = Command::ALL.iter().map(|c| format!("{c:?}")).collect();
        let variants = variants();
        assert!(variants.len() > 50 && variants.contains(&"New") && variants.contains(&"Resume"));
        for name in &variants {
            let is_it = |debug: &&String| debug.split('(').next() == Some(name);
            assert!(listed.iter().any(|debug| is_it(&debug)), "{name} is not in ALL");
        }
        for (i, command) in Command::ALL.iter().enumerate() {
            assert!(!Command::ALL[..i].contains(command), "{command:?} twice");
        }
    }

    #[test]
    fn every_value_of_a_command_with_values_is_in_the_list() {
        let count =
            |is_it: &dyn Fn(&Command) -> bool| Command::ALL.iter().filter(|c| is_it(c)).count();
        assert_eq!(count(&|c| matches!(c, Command::New(_))), TEMPLATES.len());
        assert_eq!(count(&|c| matches!(c, Command::OpenRecent(_))), MOST_RECENT);
        assert_eq!(count(&|c| matches!(c, Command::Example(_))), EXAMPLES.len());
        assert_eq!(count(&|c| matches!(c, Command::TextSize(_))), TEXT_SIZES.len());
        assert_eq!(count(&|c| matches!(c, Command::AddSolid(_))), KINDS.len());
        assert_eq!(count(&|c| c.part().is_some()), Part::ALL.len());
    }
}
