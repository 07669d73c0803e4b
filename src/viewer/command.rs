//! Everything the window can be told to do, listed once: menus, shortcuts and tooltips read this list.

use eframe::egui::{Key, KeyboardShortcut, Modifiers};

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
    /// Copies the selected light or material.
    Duplicate,
    /// Gives the selected light or material another name.
    Rename,
    /// Takes the selected light or material out.
    Delete,
    /// Gives the selected material to the solid clicked last.
    Assign,
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
            Command::Duplicate => "Duplicate",
            Command::Rename => "Rename",
            Command::Delete => "Delete",
            Command::Assign => "Assign to picked solid",
            Command::Fit => "Fit",
            Command::ActualSize => "1:1",
            Command::ZoomIn => "Zoom in",
            Command::ZoomOut => "Zoom out",
            Command::CameraTool => "Move camera",
            Command::FocusTool => "Focus by click",
            Command::Handles => "Light handles",
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
            Command::Duplicate => "Adds a copy under another name",
            Command::Rename => "Changes the name here and wherever the scene file uses it",
            Command::Delete => "Takes it out of the scene; a material must not be in use",
            Command::Assign => "Gives this material to the solid that was clicked last",
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
            | Command::Assign
            | Command::Chart
            | Command::Mass
            | Command::SampleMap
            | Command::Resume => None,
        }
    }

    /// The commands with shortcuts. Those with more modifiers come first, so that Shift-Ctrl-Z is
    /// not taken for Ctrl-Z.
    pub(super) const WITH_SHORTCUTS: [Command; 23] = [
        Command::SaveAs,
        Command::Redo,
        Command::Open,
        Command::Save,
        Command::Export,
        Command::Quit,
        Command::Undo,
        Command::Fit,
        Command::ActualSize,
        Command::ZoomIn,
        Command::ZoomOut,
        Command::CameraTool,
        Command::FocusTool,
        Command::Duplicate,
        Command::Rename,
        Command::Delete,
        Command::Handles,
        Command::Mixer,
        Command::Pixel,
        Command::Looks,
        Command::Snapshot,
        Command::Compare,
        Command::Stop,
    ];

    /// The commands about the selected light or material.
    pub(super) const ON_THINGS: [Command; 4] =
        [Command::Duplicate, Command::Rename, Command::Delete, Command::Assign];
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_two_commands_share_a_shortcut() {
        let keys: Vec<_> = Command::WITH_SHORTCUTS.iter().map(|c| c.shortcut().unwrap()).collect();
        for (i, a) in keys.iter().enumerate() {
            assert!(!keys[..i].contains(a), "{a:?}");
        }
    }
}
