//! The graphics card that draws the window: it draws the picture too, and may be lost.

use std::sync::{Arc, Mutex, PoisonError, Weak};

use eframe::egui::{Context, TextureId};
use eframe::egui_wgpu::RenderState;
use eframe::wgpu;

use super::{App, style};
use crate::shade::gpu::{Gpu, GpuError, Picture, Piece, Watch};

/// What draws the picture, and the window.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Graphics {
    /// The graphics card; but the processor where it only pretends to be one, because its own product
    /// is faster.
    #[default]
    Auto,
    /// The graphics card, whatever it is.
    Gpu,
    /// The processor; the card only shows it.
    Cpu,
    /// The processor, in a window that OpenGL draws.
    Glow,
}

/// The card of the window, and which pictures of the session's it knows.
pub(super) struct Screen {
    state: RenderState,
    watch: Watch,
    /// The fault that was told of.
    told: Option<GpuError>,
    known: Vec<Known>,
}

/// A picture that the window can draw. The session uses few of them again and again.
struct Known {
    picture: Weak<Picture>,
    textures: Vec<(TextureId, Piece)>,
}

impl Screen {
    /// What the window calls the textures of a picture.
    pub(super) fn textures(&mut self, picture: &Arc<Picture>) -> &[(TextureId, Piece)] {
        self.forget_dropped();
        let is_it = |known: &Known| known.picture.as_ptr() == Arc::as_ptr(picture);
        let at = self.known.iter().position(is_it).unwrap_or_else(|| {
            let mut renderer = self.state.renderer.write();
            let textures = picture.textures().map(|(view, piece)| {
                let sharp = sampler();
                let device = &self.state.device;
                let id = renderer.register_native_texture_with_sampler_options(device, view, sharp);
                (id, piece)
            });
            let textures = textures.collect();
            self.known.push(Known { picture: Arc::downgrade(picture), textures });
            self.known.len() - 1
        });
        &self.known[at].textures
    }

    /// What it says of itself.
    pub(super) fn adapter(&self) -> wgpu::AdapterInfo {
        self.state.adapter.get_info()
    }

    fn forget_dropped(&mut self) {
        let (kept, dropped): (Vec<Known>, Vec<Known>) =
            self.known.drain(..).partition(|known| known.picture.strong_count() > 0);
        self.known = kept;
        let mut renderer = self.state.renderer.write();
        for (id, _) in dropped.iter().flat_map(|known| &known.textures) {
            renderer.free_texture(id);
        }
    }
}

/// Enlarged pixels stay sharp squares, as those that are copied.
fn sampler() -> wgpu::SamplerDescriptor<'static> {
    wgpu::SamplerDescriptor {
        label: Some("picture"),
        mag_filter: wgpu::FilterMode::Nearest,
        min_filter: wgpu::FilterMode::Linear,
        ..wgpu::SamplerDescriptor::default()
    }
}

/// Lets the window turn.
pub(super) fn wake(window: &Mutex<Context>) {
    window.lock().unwrap_or_else(PoisonError::into_inner).request_repaint();
}

impl App {
    /// The window is drawn by a card, which from now on also draws the picture, if `graphics` wants it
    /// to and it can. The processor's picture is there all the same.
    pub fn draw_on(&mut self, ctx: &Context, state: &RenderState, graphics: Graphics) {
        let waker = ctx.clone();
        let watch = Watch::new(&state.device, move || waker.request_repaint());
        let info = state.adapter.get_info();
        log::info!("the window is drawn by {} through {:?}", info.name, info.backend);
        let software = info.device_type == wgpu::DeviceType::Cpu;
        let wanted = match graphics {
            Graphics::Gpu => true,
            Graphics::Auto => !software,
            Graphics::Cpu | Graphics::Glow => false,
        };
        if wanted {
            match Gpu::new(state.device.clone(), state.queue.clone(), watch.clone()) {
                Ok(gpu) => self.live.draw_on(Some(gpu)),
                Err(error) if graphics == Graphics::Gpu => {
                    self.notices.error(format!("{error}: the processor draws the picture"));
                }
                // It is as good: nobody asked for the card.
                Err(_) => {}
            }
        }
        self.screen = Some(Screen { state: state.clone(), watch, told: None, known: Vec::new() });
    }

    /// Says what went wrong with the card. If it is gone, nothing on it is used any more.
    pub(super) fn look_after_screen(&mut self) {
        let Some(screen) = &mut self.screen else { return };
        let fault = screen.watch.fault();
        if fault == screen.told {
            return;
        }
        screen.told = fault.clone();
        match fault {
            Some(fault @ GpuError::Lost(_)) => {
                self.screen = None;
                self.live.draw_on(None);
                self.forget_textures();
                self.is_moving = true;
                self.notices.error(format!("{fault}; nothing of your work is lost"));
            }
            Some(fault) => self.notices.error(fault.to_string()),
            None => {}
        }
    }

    /// Lets go of all pictures on the card.
    fn forget_textures(&mut self) {
        self.picture.forget_textures();
        self.presets.forget_textures();
        self.compare.painted = None;
        self.is_frame_stale = true;
    }

    /// Whether the card of this window is gone: what shows is not seen any more.
    pub fn is_moving(&self) -> bool {
        self.is_moving
    }

    /// Goes on in another window.
    pub(super) fn move_to(&mut self, ctx: &Context) {
        style::set_up(ctx);
        style::apply(ctx, &self.settings);
        *self.waker.lock().unwrap_or_else(PoisonError::into_inner) = ctx.clone();
        self.forget_textures();
        self.title.clear();
        self.is_moving = false;
    }

    /// Gives the card up, as a driver does that fails.
    pub(super) fn lose_screen(&self) {
        if let Some(Screen { state, .. }) = &self.screen {
            state.device.destroy();
            let _ = state.device.poll(wgpu::PollType::wait_indefinitely());
        }
    }
}
