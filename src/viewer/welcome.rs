//! The welcome: ways to begin, recent files and the examples, below the picture, which goes on by itself.

use std::path::PathBuf;
use std::time::{Duration, Instant};

use eframe::egui::{
    Align, Color32, Context, Key, Layout, Modifiers, Panel, Popup, Rect, Response, Role,
    ScrollArea, Sense, StrokeKind, TextStyle, TextureHandle, Ui, Vec2, WidgetInfo, pos2, vec2,
};

use super::app::App;
use super::command::Command;
use super::looks::caption;
use super::panels::WELCOME;
use super::thumbs::{texture, thumb_of};
use crate::document::TEMPLATES;
use crate::document::examples::EXAMPLES;

/// Size of a card's picture, in points.
const PICTURE: Vec2 = vec2(144.0, 81.0);

/// How long pictures are loaded in one turn.
const TURN: Duration = Duration::from_millis(3);

/// The welcome, and the pictures of its cards.
#[derive(Default)]
pub(super) struct Welcome {
    open: bool,
    /// Whether there was unsaved work when it was opened.
    over_work: bool,
    recent: Vec<Recent>,
    examples: Vec<Option<TextureHandle>>,
}

/// A file that was open before and is still there.
struct Recent {
    /// Its number in the settings.
    number: usize,
    path: PathBuf,
    thumb: Option<TextureHandle>,
}

/// What a card shows.
struct Card<'a> {
    label: &'a str,
    about: &'a str,
    thumb: Option<&'a TextureHandle>,
}

impl Welcome {
    pub(super) fn is_open(&self) -> bool {
        self.open
    }

    pub(super) fn close(&mut self) {
        *self = Welcome::default();
    }

    /// Loads pictures for a moment; what is left, in the next turn.
    fn load(&mut self, ctx: &Context) {
        let begun = Instant::now();
        while let Some(example) = EXAMPLES.get(self.examples.len()) {
            if begun.elapsed() > TURN {
                return ctx.request_repaint();
            }
            // What is built in is a picture: a test reads them all.
            let thumb = texture(ctx, example.name, example.thumbnail);
            self.examples.push(thumb);
        }
    }

    /// The cards; the command of the one that was clicked.
    fn cards_ui(&self, ui: &mut Ui) -> Option<Command> {
        let mut chosen = None;
        ScrollArea::vertical().auto_shrink([false, false]).show(ui, |ui| {
            ui.horizontal_wrapped(|ui| {
                for Recent { number, path, thumb } in &self.recent {
                    let name = path.file_name().unwrap_or_default().to_string_lossy();
                    let about = format!("Opens {} again", path.display());
                    let card = Card { label: &name, about: &about, thumb: thumb.as_ref() };
                    if card.ui(ui).clicked() {
                        chosen = Some(Command::OpenRecent(*number));
                    }
                }
                for (i, example) in EXAMPLES.iter().enumerate() {
                    let thumb = self.examples.get(i).and_then(Option::as_ref);
                    let about = format!("{}. Opens a copy of this example", example.about);
                    if (Card { label: example.title, about: &about, thumb }).ui(ui).clicked() {
                        chosen = Some(Command::Example(i));
                    }
                }
            });
        });
        chosen
    }
}

impl Card<'_> {
    fn ui(&self, ui: &mut Ui) -> Response {
        let line = ui.text_style_height(&TextStyle::Body) + 2.0;
        let (rect, response) =
            ui.allocate_exact_size(PICTURE + vec2(8.0, 8.0 + line), Sense::click());
        let label = format!("card {}", self.label);
        response.widget_info(|| WidgetInfo::labeled(Role::Button, true, &label));
        let visuals = ui.style().interact(&response);
        let painter = ui.painter_at(rect);
        painter.rect(rect, 4.0, visuals.weak_bg_fill, visuals.bg_stroke, StrokeKind::Inside);
        let space = Rect::from_min_size(rect.min + Vec2::splat(4.0), PICTURE);
        painter.rect_filled(space, 0.0, Color32::from_gray(40));
        if let Some(thumb) = self.thumb {
            let size = thumb.size_vec2();
            let place = Rect::from_center_size(space.center(), size * (PICTURE / size).min_elem());
            let whole = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
            painter.image(thumb.id(), place, whole, Color32::WHITE);
        }
        let left = space.left_bottom() + vec2(0.0, line / 2.0 + 1.0);
        caption(&painter, self.label, left, space.width(), visuals.text_color());
        response.on_hover_text(self.about)
    }
}

impl App {
    /// Begins without a scene file: with the first example, and the welcome if it is wanted.
    pub(super) fn begin(&mut self, ctx: &Context) {
        self.show_copied(0);
        if self.settings.welcome {
            self.open_welcome(ctx);
        }
    }

    /// Opens the welcome.
    pub(super) fn open_welcome(&mut self, ctx: &Context) {
        self.welcome.close();
        (self.welcome.open, self.welcome.over_work) = (true, self.document.is_unsaved());
        let cache = &self.files.folders.cache;
        for (number, path) in self.settings.recent.iter().enumerate().filter(|(_, p)| p.is_file()) {
            let thumb = std::fs::read(thumb_of(cache, path)).ok();
            let thumb = thumb.and_then(|png| texture(ctx, "recent", &png));
            self.welcome.recent.push(Recent { number, path: path.clone(), thumb });
        }
    }

    /// Shows the welcome, if it is open. It goes by itself once work begins, and with Escape.
    pub(super) fn welcome_ui(&mut self, ui: &mut Ui, commands: &mut Vec<Command>) {
        if !self.welcome.open {
            return;
        }
        let ctx = ui.ctx().clone();
        let busy =
            !self.takes_keys() || ctx.egui_wants_keyboard_input() || Popup::is_any_open(&ctx);
        let escaped = !busy && ctx.input_mut(|i| i.consume_key(Modifiers::NONE, Key::Escape));
        // Not while a gesture lasts: nothing may move under the pointer.
        let is_new = self.document.is_unsaved() && !self.welcome.over_work;
        let begun = is_new && !ctx.input(|i| i.pointer.any_down());
        if escaped || begun {
            return self.welcome.close();
        }
        self.welcome.load(&ctx);
        let mut closed = false;
        let height = (0.4 * ui.available_height()).clamp(WELCOME, 276.0);
        let panel = Panel::bottom("welcome").resizable(true).default_size(height).min_size(WELCOME);
        panel.show(ui, |ui| {
            closed = self.welcome_head_ui(ui, commands);
            commands.extend(self.welcome.cards_ui(ui));
        });
        if closed {
            self.welcome.close();
        }
    }

    /// The line above the cards; whether the welcome was closed.
    fn welcome_head_ui(&mut self, ui: &mut Ui, commands: &mut Vec<Command>) -> bool {
        let mut closed = false;
        ui.horizontal(|ui| {
            ui.heading("Welcome to Rayforest");
            ui.menu_button("New scene", |ui| {
                for (i, (name, _)) in TEMPLATES.iter().enumerate() {
                    if ui.button(*name).on_hover_text(Command::New(i).about()).clicked() {
                        commands.push(Command::New(i));
                    }
                }
            })
            .response
            .on_hover_text("Starts a scene from a template");
            for (command, name) in
                [(Command::Open, "Open a file…"), (Command::Import, "Import a model…")]
            {
                if ui.button(name).on_hover_text(command.about()).clicked() {
                    commands.push(command);
                }
            }
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                let about = "Goes on with the scene that shows; Help opens this again";
                closed = ui.button("Close welcome").on_hover_text(about).clicked();
                let about = "Whether a start without a scene shows this";
                let shows = ui.checkbox(&mut self.settings.welcome, "Show at the start");
                if shows.on_hover_text(about).changed() {
                    self.remember_settings();
                }
            });
        });
        closed
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_example_has_a_thumbnail() {
        for example in EXAMPLES {
            let thumb = texture(&Context::default(), example.name, example.thumbnail);
            assert!(thumb.is_some(), "{}", example.name);
        }
    }
}
