//! Short messages over the picture: what was done, and what went wrong.

use std::time::{Duration, Instant};

use eframe::egui::{Align, Area, Frame, Id, Label, Layout, Order, Ui, pos2, vec2};

/// How long a message stays that needs no answer.
const STAY: Duration = Duration::from_secs(6);
/// Most messages at a time; the oldest goes first.
const MOST: usize = 4;

/// The messages that show.
#[derive(Default)]
pub(super) struct Notices {
    list: Vec<Notice>,
}

struct Notice {
    text: String,
    /// `None` stays until it is closed.
    until: Option<Instant>,
}

impl Notices {
    /// Something was done, or cannot be. What is said again is not said twice at a time.
    pub(super) fn say(&mut self, text: String) {
        log::info!("{text}");
        self.list.retain(|n| n.until.is_none() || n.text != text);
        self.add(Notice { text, until: Some(Instant::now() + STAY) });
    }

    /// Something went wrong: stays until it is closed.
    pub(super) fn error(&mut self, text: String) {
        if !self.list.iter().any(|n| n.text == text) {
            log::warn!("{text}");
            self.add(Notice { text, until: None });
        }
    }

    fn add(&mut self, notice: Notice) {
        self.list.push(notice);
        if self.list.len() > MOST {
            self.list.remove(0);
        }
    }

    /// Shows the messages at the lower edge of `ui`'s space.
    pub(super) fn ui(&mut self, ui: &Ui) {
        let now = Instant::now();
        self.list.retain(|n| n.until.is_none_or(|until| until > now));
        if self.list.is_empty() {
            return;
        }
        if self.list.iter().any(|n| n.until.is_some()) {
            ui.ctx().request_repaint_after(Duration::from_millis(500));
        }
        let space = ui.max_rect();
        let corner = pos2(space.left() + 12.0, space.bottom() - 12.0);
        let area = Area::new(Id::unique("notices")).order(Order::Foreground);
        let mut closed = None;
        area.pivot(eframe::egui::Align2::LEFT_BOTTOM).fixed_pos(corner).show(ui.ctx(), |ui| {
            ui.set_max_width((space.width() - 24.0).min(640.0));
            for (i, notice) in self.list.iter().enumerate() {
                if notice_ui(ui, notice) {
                    closed = Some(i);
                }
            }
        });
        if let Some(i) = closed {
            self.list.remove(i);
        }
    }
}

/// One message; whether it was closed.
fn notice_ui(ui: &mut Ui, notice: &Notice) -> bool {
    let mut closed = false;
    Frame::popup(ui.style()).show(ui, |ui| {
        ui.with_layout(Layout::left_to_right(Align::Min), |ui| {
            if ui.small_button("Close").on_hover_text("Closes this message").clicked() {
                closed = true;
            }
            let color = match notice.until {
                Some(_) => ui.visuals().text_color(),
                None => ui.visuals().error_fg_color,
            };
            ui.spacing_mut().item_spacing = vec2(6.0, 2.0);
            let mut text = eframe::egui::RichText::new(&notice.text).color(color);
            if notice.text.contains('\n') {
                text = text.monospace();
            }
            ui.add(Label::new(text).wrap().selectable(true));
        });
    });
    closed
}
