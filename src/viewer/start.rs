//! Opens the window: on Vulkan and its kin, else on OpenGL, else it says that there is no display.

use std::cell::RefCell;
use std::fmt;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::path::PathBuf;
use std::rc::Rc;
use std::sync::Arc;
use std::time::Duration;

use eframe::egui::{IconData, Ui, ViewportBuilder, ViewportCommand, Visuals};
use eframe::egui_wgpu::{WgpuConfiguration, WgpuSetup, WgpuSetupCreateNew};
use eframe::{NativeOptions, Renderer, wgpu};

use super::dialog::SystemDialogs;
use super::journal;
use super::{App, Folders, Graphics, Setup};
use crate::session::Options;

/// As a PNG.
const ICON: &[u8] = include_bytes!("../../assets/icon.png");

/// Why there is no window.
#[derive(Debug)]
pub enum WindowError {
    /// There is no display to open it on.
    NoDisplay(String),
    /// There is a display, but neither wgpu nor OpenGL draws on it.
    NoGraphics(String),
}

impl fmt::Display for WindowError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            WindowError::NoDisplay(cause) => write!(f, "no display to open a window on ({cause})"),
            WindowError::NoGraphics(cause) => {
                write!(f, "neither Vulkan nor OpenGL draws on this display: {cause}")
            }
        }
    }
}

/// What the window is opened with.
#[derive(Clone, Debug)]
pub struct Opening {
    /// The scene to open; the built-in one if there is none.
    pub scene: Option<PathBuf>,
    /// Threads and memory of its session.
    pub options: Options,
    /// What draws it.
    pub graphics: Graphics,
    /// Gives the window's graphics card up, as a driver does that fails, when there is such a file,
    /// and takes the file away: for tests.
    pub lose_at: Option<PathBuf>,
}

/// The application, which outlives its window.
type Kept = Rc<RefCell<Option<App>>>;

/// Opens the window and returns when it is closed. Where wgpu does not draw, OpenGL does; where the
/// graphics card is lost, the window opens again without asking it for the picture, and, if that is
/// lost too, by OpenGL.
pub fn run(opening: Opening) -> Result<(), WindowError> {
    let version = env!("CARGO_PKG_VERSION");
    journal::start(&Folders::of_platform().log);
    log::info!("Rayforest {version} begins");
    let ended = keep_open(opening);
    match &ended {
        Ok(()) => log::info!("Rayforest ends"),
        Err(error) => log::error!("no window: {error}"),
    }
    ended
}

fn keep_open(mut opening: Opening) -> Result<(), WindowError> {
    let kept = Kept::default();
    let mut refused = String::new();
    loop {
        let opened = or_lost(&kept, || open(&opening, &kept));
        let lost = kept.borrow().as_ref().is_some_and(App::is_moving);
        opening.graphics = match (opened, opening.graphics) {
            (Ok(()), Graphics::Auto | Graphics::Gpu) if lost => Graphics::Cpu,
            (Ok(()), Graphics::Cpu) if lost => Graphics::Glow,
            (Ok(()), _) => return Ok(()),
            // The same process may try again with another renderer.
            (Err(eframe::Error::Wgpu(cause)), Graphics::Auto | Graphics::Gpu | Graphics::Cpu) => {
                refused = format!("{cause}; ");
                Graphics::Glow
            }
            (Err(eframe::Error::WinitEventLoop(e)), _) => return Err(no_display(&e.to_string())),
            (Err(other), _) => return Err(WindowError::NoGraphics(format!("{refused}{other}"))),
        };
    }
}

/// What a window gives. egui's painter panics when the card is lost in the middle of a turn: then the
/// application, which is whole, moves; any other panic goes on.
fn or_lost(kept: &Kept, window: impl FnOnce() -> eframe::Result) -> eframe::Result {
    catch_unwind(AssertUnwindSafe(window)).unwrap_or_else(|cause| {
        let mut kept = kept.borrow_mut();
        let Some(app) = kept.as_mut() else { resume_unwind(cause) };
        app.look_after_screen();
        match app.is_moving() {
            true => Ok(()),
            false => resume_unwind(cause),
        }
    })
}

/// winit begins with the place in its own source, which tells the person nothing.
fn no_display(message: &str) -> WindowError {
    let after = message.split_once(".rs:").and_then(|(_, rest)| rest.split_once(": "));
    let cause = after.map_or(message, |(_, cause)| cause);
    let line = cause.lines().next().unwrap_or_default();
    WindowError::NoDisplay(line.trim_end_matches('.').to_owned())
}

/// The picture by which desktops show the program.
fn icon() -> IconData {
    // What is built in is a picture: a test reads it.
    eframe::icon_data::from_png_bytes(ICON).unwrap_or_default()
}

fn open(opening: &Opening, kept: &Kept) -> eframe::Result {
    let Opening { scene, options, graphics, lose_at } = opening.clone();
    let viewport = ViewportBuilder::default()
        .with_title("Rayforest")
        .with_app_id("rayforest")
        .with_icon(icon())
        .with_inner_size([1280.0, 720.0])
        .with_min_inner_size([800.0, 500.0]);
    let native = NativeOptions {
        viewport,
        renderer: if graphics == Graphics::Glow { Renderer::Glow } else { Renderer::Wgpu },
        wgpu_options: wgpu_options(),
        // The picture reaches the screen as it is.
        dithering: false,
        ..NativeOptions::default()
    };
    let kept = kept.clone();
    let setup = move |context: &eframe::CreationContext<'_>| {
        let ctx = &context.egui_ctx;
        let mut app = kept.borrow_mut();
        let app = match &mut *app {
            Some(app) => {
                app.move_to(ctx);
                app
            }
            none => {
                let dialogs = Box::new(SystemDialogs::default());
                let folders = Folders::of_platform();
                none.insert(App::new(ctx, Setup { options, folders, dialogs, scene }))
            }
        };
        if let Some(state) = &context.wgpu_render_state {
            app.draw_on(ctx, state, graphics);
        }
        Ok(Box::new(Shell { kept: kept.clone(), lose_at }) as Box<dyn eframe::App>)
    };
    eframe::run_native("rayforest", native, Box::new(setup))
}

/// A window of the application's, as eframe wants it.
struct Shell {
    kept: Kept,
    /// The file at which its card is given up.
    lose_at: Option<PathBuf>,
}

impl eframe::App for Shell {
    fn ui(&mut self, ui: &mut Ui, frame: &mut eframe::Frame) {
        let mut kept = self.kept.borrow_mut();
        let Some(app) = kept.as_mut() else { return };
        if let Some(file) = &self.lose_at {
            ui.ctx().request_repaint_after(Duration::from_millis(50));
            match std::fs::read(file) {
                // In the middle of a turn.
                Ok(when) if when == b"late" && std::fs::remove_file(file).is_ok() => {
                    eframe::App::ui(app, ui, frame);
                    return app.lose_screen();
                }
                Ok(_) if std::fs::remove_file(file).is_ok() => app.lose_screen(),
                _ => {}
            }
        }
        app.look_after_screen();
        match app.is_moving() {
            // What egui would upload to a card that is gone ends the program: nothing is shown.
            true => ui.ctx().send_viewport_cmd(ViewportCommand::Close),
            false => eframe::App::ui(app, ui, frame),
        }
    }

    /// What shows in the hair between panels whose edges lie between two pixels.
    fn clear_color(&self, visuals: &Visuals) -> [f32; 4] {
        visuals.panel_fill.to_normalized_gamma_f32()
    }

    fn on_exit(&mut self, gl: Option<&eframe::glow::Context>) {
        let mut kept = self.kept.borrow_mut();
        if let Some(app) = kept.as_mut().filter(|app| !app.is_moving()) {
            eframe::App::on_exit(app, gl);
        }
    }
}

/// Asks for what the adapter has: the default asks a GL adapter for more than it can give.
fn wgpu_options() -> WgpuConfiguration {
    let device = |adapter: &wgpu::Adapter| wgpu::DeviceDescriptor {
        label: Some("rayforest"),
        required_limits: adapter.limits(),
        ..wgpu::DeviceDescriptor::default()
    };
    let setup = WgpuSetupCreateNew {
        device_descriptor: Arc::new(device),
        ..WgpuSetupCreateNew::without_display_handle()
    };
    WgpuConfiguration { wgpu_setup: WgpuSetup::CreateNew(setup), ..WgpuConfiguration::default() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_icon_is_a_picture() {
        let icon = icon();
        assert_eq!([icon.width, icon.height], [256, 256]);
        assert!(icon.rgba.chunks(4).any(|pixel| pixel[3] == 0), "its ground is clear");
    }

    #[test]
    fn the_cause_is_told_without_its_place_in_a_source_file() {
        let told = |message| no_display(message).to_string();
        assert_eq!(
            told("os error at /x/winit/mod.rs:765: neither DISPLAY nor another is set."),
            "no display to open a window on (neither DISPLAY nor another is set)"
        );
        assert_eq!(told("no such thing"), "no display to open a window on (no such thing)");
    }
}
