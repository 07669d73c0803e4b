//! Opens the window: on Vulkan and its kin, else on OpenGL, else it says that there is no display.

use std::fmt;
use std::path::PathBuf;
use std::sync::Arc;

use eframe::egui::ViewportBuilder;
use eframe::egui_wgpu::{WgpuConfiguration, WgpuSetup, WgpuSetupCreateNew};
use eframe::{NativeOptions, Renderer, wgpu};

use super::dialog::SystemDialogs;
use super::{App, Folders, Setup};
use crate::session::Options;

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

/// Opens the window and returns when it is closed.
pub fn run(scene: Option<PathBuf>, options: Options) -> Result<(), WindowError> {
    match open(Renderer::Wgpu, scene.clone(), options) {
        // The same process may try again with another renderer.
        Err(eframe::Error::Wgpu(first)) => {
            open(Renderer::Glow, scene, options).map_err(|second| match second {
                eframe::Error::WinitEventLoop(e) => no_display(&e.to_string()),
                second => WindowError::NoGraphics(format!("{first}; {second}")),
            })
        }
        Err(eframe::Error::WinitEventLoop(e)) => Err(no_display(&e.to_string())),
        Err(other) => Err(WindowError::NoGraphics(other.to_string())),
        Ok(()) => Ok(()),
    }
}

/// winit begins with the place in its own source, which tells the person nothing.
fn no_display(message: &str) -> WindowError {
    let after = message.split_once(".rs:").and_then(|(_, rest)| rest.split_once(": "));
    let cause = after.map_or(message, |(_, cause)| cause);
    let line = cause.lines().next().unwrap_or_default();
    WindowError::NoDisplay(line.trim_end_matches('.').to_owned())
}

fn open(renderer: Renderer, scene: Option<PathBuf>, options: Options) -> eframe::Result {
    let viewport = ViewportBuilder::default()
        .with_title("Rayforest")
        .with_app_id("rayforest")
        .with_inner_size([1280.0, 720.0])
        .with_min_inner_size([800.0, 500.0]);
    let native = NativeOptions {
        viewport,
        renderer,
        wgpu_options: wgpu_options(),
        // The picture reaches the screen as it is.
        dithering: false,
        ..NativeOptions::default()
    };
    let setup = move |context: &eframe::CreationContext<'_>| {
        let setup = Setup {
            options,
            folders: Folders::of_platform(),
            dialogs: Box::new(SystemDialogs::default()),
            scene,
        };
        Ok(Box::new(App::new(&context.egui_ctx, setup)) as Box<dyn eframe::App>)
    };
    eframe::run_native("rayforest", native, Box::new(setup))
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
    fn the_cause_is_told_without_its_place_in_a_source_file() {
        let told = |message| no_display(message).to_string();
        assert_eq!(
            told("os error at /x/winit/mod.rs:765: neither DISPLAY nor another is set."),
            "no display to open a window on (neither DISPLAY nor another is set)"
        );
        assert_eq!(told("no such thing"), "no display to open a window on (no such thing)");
    }
}
