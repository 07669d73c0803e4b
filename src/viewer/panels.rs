//! The panels around the picture: where each lies, how large it is, and whether it shows.

use eframe::egui::{Context, Panel, Response, Sense, Ui, UiBuilder};

use super::app::App;
use super::command::Command;
use super::looks::STRIP;
use crate::document::arrangement::{Arrangement, Part};

/// Share of the height that is left which a panel below the picture may take.
const MOST: f32 = 0.6;
/// Least height of what scrolls in a panel, in points.
pub(super) const LINE: f32 = 20.0;
/// Least height of the welcome in points.
pub(super) const WELCOME: f32 = 120.0;
/// Least height of the picture in points.
const PICTURE: f32 = 100.0;

/// The panels below the picture, from the lowest up.
const BELOW: [Part; 5] = [Part::Mixer, Part::Chart, Part::Mass, Part::Pixel, Part::Looks];

/// Least size of a panel that can be resized, in points; of one that cannot, what it takes.
fn least(part: Part) -> f32 {
    match part {
        Part::Outline => 120.0,
        Part::Inspector => 380.0,
        Part::Status => 0.0,
        Part::Mixer => 60.0,
        Part::Looks => STRIP,
        Part::Chart => 120.0,
        Part::Mass => 90.0,
        Part::Pixel => 120.0,
    }
}

/// What is remembered of the panels while the window is open.
pub(super) struct Panels {
    /// Whether the list of what the scene holds shows.
    pub(super) outline: bool,
    /// Whether the parameters of what is selected show.
    pub(super) inspector: bool,
    /// Whether the status line shows.
    pub(super) status: bool,
    /// The sizes that were dragged; whether panels show is said elsewhere.
    given: Arrangement,
    /// Sizes in the latest turn in which each showed, in points.
    seen: [f32; Part::ALL.len()],
    /// The panels below the picture that are open, those first that were opened first.
    open: Vec<Part>,
    /// How often the layout was reset: panels of another round forget their sizes.
    round: u32,
    /// How often panels below the picture came or went: the others then have their own heights again,
    /// as far as there is room.
    shift: u32,
}

impl Panels {
    /// Panels as they were left.
    pub(super) fn new(left: &Arrangement) -> Panels {
        Panels {
            outline: left.shows(Part::Outline),
            inspector: left.shows(Part::Inspector),
            status: left.shows(Part::Status),
            given: left.clone(),
            seen: [0.0; Part::ALL.len()],
            open: Vec::new(),
            round: 0,
            shift: 0,
        }
    }

    /// A panel in its place in `ui`. One below the picture takes no more than [`MOST`] of the height
    /// that is left, and leaves what the picture and the panels above it need.
    pub(super) fn panel(&self, ui: &Ui, part: Part) -> Panel {
        let (name, first) = match part {
            Part::Outline => ("outline", 180.0),
            Part::Inspector => ("inspector", 440.0),
            Part::Status => ("status", 0.0),
            Part::Mixer => ("mixer", 130.0),
            Part::Looks => ("strip", 0.0),
            Part::Chart => ("chart", 300.0),
            Part::Mass => ("mass", 260.0),
            Part::Pixel => ("pixel", 270.0),
        };
        let shift = if BELOW.contains(&part) { self.shift } else { 0 };
        let id = (name, self.round, shift);
        let panel = match part {
            Part::Outline => Panel::left(id),
            Part::Inspector => Panel::right(id),
            _ => Panel::bottom(id),
        };
        if first == 0.0 {
            return panel.resizable(false);
        }
        let size = self.given.size(part).map_or(first, |points| points as f32);
        let panel = panel.resizable(true).default_size(size);
        match part {
            Part::Outline | Part::Inspector => panel.min_size(least(part)),
            _ => {
                let left = ui.available_height();
                let above = BELOW.into_iter().skip_while(|other| *other != part).skip(1);
                let above = above.filter(|other| self.open.contains(other)).map(least);
                let most = (left * MOST).min(left - PICTURE - above.sum::<f32>());
                panel.size_range(least(part)..=most.max(least(part)))
            }
        }
    }

    /// Looks at a panel that was shown: a size that changed under a pressed pointer was dragged.
    pub(super) fn note(&mut self, part: Part, shown: &Response) {
        let size = match part {
            Part::Outline | Part::Inspector => shown.rect.width(),
            _ => shown.rect.height(),
        };
        let seen = std::mem::replace(&mut self.seen[part as usize], size);
        let dragged = shown.ctx.input(|i| i.pointer.any_down() || i.pointer.any_released());
        if dragged && seen != 0.0 && seen != size {
            self.given.set_size(part, size.round() as u32);
        }
    }
}

/// Shows what is in a panel, which takes all of the panel's height and no more: a panel that egui finds
/// too small for what is in it is drawn over by the next.
pub(super) fn filled<T>(ui: &mut Ui, add: impl FnOnce(&mut Ui) -> T) -> T {
    let space = ui.available_rect_before_wrap();
    let shown = add(&mut ui.new_child(UiBuilder::new().max_rect(space)));
    ui.allocate_rect(space, Sense::hover());
    shown
}

impl App {
    /// What says whether a panel shows.
    pub(super) fn open_flag(&mut self, part: Part) -> &mut bool {
        match part {
            Part::Outline => &mut self.panels.outline,
            Part::Inspector => &mut self.panels.inspector,
            Part::Status => &mut self.panels.status,
            Part::Mixer => &mut self.mixer.open,
            Part::Looks => &mut self.strip.open,
            Part::Chart => &mut self.chart.open,
            Part::Mass => &mut self.mass.open,
            Part::Pixel => &mut self.pixel.open,
        }
    }

    /// Closes the panels below the picture that were opened first, as long as the others and the
    /// picture do not fit into the height.
    pub(super) fn make_room(&mut self, height: f32) {
        let before = self.panels.open.clone();
        for part in BELOW {
            let is_open = *self.open_flag(part);
            let known = self.panels.open.iter().position(|open| *open == part);
            match (is_open, known) {
                (true, None) => self.panels.open.push(part),
                (false, Some(at)) => drop(self.panels.open.remove(at)),
                _ => {}
            }
        }
        let others = PICTURE + if self.welcome.is_open() { WELCOME } else { 0.0 };
        let need = |open: &[Part]| open.iter().copied().map(least).sum::<f32>() + others;
        while self.panels.open.len() > 1 && need(&self.panels.open) > height {
            let part = self.panels.open.remove(0);
            *self.open_flag(part) = false;
            let command = Command::ALL.into_iter().find(|command| command.part() == Some(part));
            let name = command.map_or("", Command::name);
            self.notices.say(format!("“{name}” made room: the window is not high enough for all"));
        }
        if self.panels.open != before {
            self.panels.shift += 1;
            // What moves by itself was not dragged.
            BELOW.into_iter().for_each(|part| self.panels.seen[part as usize] = 0.0);
        }
    }

    /// Shows the panels that were open when the window was closed.
    pub(super) fn take_layout(&mut self) {
        let left = self.settings.arrangement.clone();
        Part::ALL.into_iter().for_each(|part| *self.open_flag(part) = left.shows(part));
    }

    /// Every panel as it was at first.
    pub(super) fn reset_layout(&mut self) {
        let round = self.panels.round + 1;
        self.panels = Panels { round, ..Panels::new(&Arrangement::default()) };
        Part::ALL.into_iter().for_each(|part| *self.open_flag(part) = part.shows_at_first());
    }

    /// Opens every panel there is.
    pub(super) fn open_all_panels(&mut self) {
        Part::ALL.into_iter().for_each(|part| *self.open_flag(part) = true);
    }

    /// Writes the layout to the settings when it is another one, not while it is being dragged.
    pub(super) fn remember_layout(&mut self, ctx: &Context) {
        let mut now = self.panels.given.clone();
        Part::ALL.into_iter().for_each(|part| now.set_shows(part, *self.open_flag(part)));
        if now != self.settings.arrangement && !ctx.input(|i| i.pointer.any_down()) {
            self.settings.arrangement = now;
            self.remember_settings();
        }
    }
}
