//! The palette: every command, found by some letters of its name.

use eframe::egui::{
    Button, Context, Event, Key, Label, Modifiers, RichText, ScrollArea, TextEdit, Ui, vec2,
};

use super::app::App;
use super::command::{Command, keys_text};
use super::question::question;
use crate::document::TEMPLATES;
use crate::document::examples::EXAMPLES;

/// Width of the palette in points.
const WIDTH: f32 = 520.0;
/// Height of its list in points.
const HEIGHT: f32 = 340.0;

/// What is typed, and which of what was found is chosen.
#[derive(Default)]
pub(super) struct Palette {
    text: String,
    at: usize,
    /// Enter was pressed before it showed.
    is_entered: bool,
    /// It has shown: its field has the keyboard.
    is_shown: bool,
    /// Arrows went through the list.
    is_led: bool,
}

/// A line of the palette.
struct Entry {
    command: Command,
    title: String,
    /// Why it cannot be done now, if it cannot.
    refusal: Option<String>,
}

/// How well typed letters fit a title, the best 0; `None` if they do not.
fn rank(typed: &str, title: &str) -> Option<u8> {
    let (typed, title) = (typed.trim().to_lowercase(), title.to_lowercase());
    let mut letters = title.chars();
    if title.starts_with(&typed) {
        Some(0)
    } else if title.split(' ').any(|word| word.starts_with(&typed)) {
        Some(1)
    } else if title.contains(&typed) {
        Some(2)
    } else {
        let in_order = |letter: char| letter == ' ' || letters.any(|other| other == letter);
        typed.chars().all(in_order).then_some(3)
    }
}

/// What fits the typed letters, the best first, else in the order of the menus.
fn found(typed: &str, entries: Vec<Entry>) -> Vec<Entry> {
    let ranked = entries.into_iter().filter_map(|entry| Some((rank(typed, &entry.title)?, entry)));
    let mut ranked: Vec<_> = ranked.collect();
    ranked.sort_by_key(|(rank, _)| *rank);
    ranked.into_iter().map(|(_, entry)| entry).collect()
}

impl Palette {
    /// Shows what was found; gives the command that was chosen.
    fn ui(&mut self, ui: &mut Ui, entries: Vec<Entry>) -> Option<Command> {
        ui.set_width(WIDTH);
        let pressed = |key| ui.ctx().input_mut(|input| input.consume_key(Modifiers::NONE, key));
        let [up, down, enter] = [Key::ArrowUp, Key::ArrowDown, Key::Enter].map(pressed);
        if !std::mem::replace(&mut self.is_shown, true) {
            self.text += &ui.ctx().input_mut(|input| typed(&mut input.events));
        }
        let enter = enter || std::mem::take(&mut self.is_entered);
        self.is_led |= up || down;
        let field = TextEdit::singleline(&mut self.text).hint_text("Some letters of a command");
        let field = ui.add(field.desired_width(f32::INFINITY)).accessible_name("find a command");
        let field = field.on_hover_text("Arrows choose, Enter does it, Escape leaves");
        field.request_focus();
        if field.changed() {
            self.at = 0;
        }
        let found = found(&self.text, entries);
        let last = found.len().saturating_sub(1);
        self.at = match (up, down) {
            (true, _) => self.at.saturating_sub(1),
            (_, true) => (self.at + 1).min(last),
            _ => self.at.min(last),
        };
        let moved = up || down || field.changed();
        let clicked = self.list_ui(ui, &found, moved);
        ui.separator();
        let about = match found.get(self.at) {
            Some(Entry { refusal: Some(why), .. }) => why,
            Some(entry) => entry.command.about(),
            None => "No command has these letters in this order",
        };
        // Two lines, so that the list stands still.
        ui.allocate_ui(vec2(WIDTH, 36.0), |ui| {
            ui.set_min_height(36.0);
            ui.add(Label::new(RichText::new(about).weak()).wrap());
        });
        // Enter alone chooses nothing: what stands first was not asked for.
        let is_chosen = enter && (self.is_led || !self.text.trim().is_empty());
        let entered = found.get(self.at).filter(|entry| is_chosen && entry.refusal.is_none());
        clicked.or(entered.map(|entry| entry.command))
    }

    fn list_ui(&self, ui: &mut Ui, found: &[Entry], moved: bool) -> Option<Command> {
        let mut chosen = None;
        let list = ScrollArea::vertical().max_height(HEIGHT).auto_shrink(false);
        list.show(ui, |ui| {
            for (i, Entry { command, title, refusal }) in found.iter().enumerate() {
                let mut button = Button::selectable(i == self.at, title);
                if let Some(keys) = command.shortcut() {
                    button = button.shortcut_text(keys_text(ui.ctx(), &keys));
                }
                let button = button.min_size(vec2(ui.available_width(), 0.0));
                let response = ui.add_enabled(refusal.is_none(), button);
                let why = refusal.as_deref().unwrap_or_default();
                let response = response.on_hover_text(command.about()).on_disabled_hover_text(why);
                if moved && i == self.at {
                    response.scroll_to_me(None);
                }
                if response.clicked() {
                    chosen = Some(*command);
                }
            }
        });
        chosen
    }
}

/// Takes the typed text out of the events of a turn.
fn typed(events: &mut Vec<Event>) -> String {
    let mut text = String::new();
    events.retain(|event| match event {
        Event::Text(letters) => {
            text += letters;
            false
        }
        _ => true,
    });
    text
}

impl App {
    /// Opens the palette if its keys were pressed, with all that was typed behind them in the same
    /// turn: after a long turn that may be a whole command.
    pub(super) fn open_palette(&mut self, ctx: &Context) {
        let Some(keys) = Command::Palette.shortcut().filter(|_| self.takes_keys()) else { return };
        let is_opening = |event: &Event| match event {
            Event::Key { key, pressed: true, modifiers, .. } => {
                *key == keys.logical_key && modifiers.matches_logically(keys.modifiers)
            }
            _ => false,
        };
        let opened = ctx.input_mut(|input| {
            let at = input.events.iter().position(is_opening)?;
            let mut later = input.events.split_off(at);
            let text = typed(&mut later);
            let mut is_entered = false;
            later.retain(|event| {
                let Event::Key { key, pressed, .. } = event else { return true };
                is_entered |= *key == Key::Enter && *pressed;
                false
            });
            input.events.append(&mut later);
            Some(Palette { text, is_entered, ..Palette::default() })
        });
        self.palette = opened.or(self.palette.take());
    }

    /// The palette, if it is open; the command that was chosen.
    pub(super) fn palette_ui(&mut self, ctx: &Context) -> Option<Command> {
        let mut palette = self.palette.take()?;
        let entries = self.palette_entries();
        let shown = question(ctx, "palette", |ui| palette.ui(ui, entries));
        if shown.inner.is_none() && !shown.should_close() {
            self.palette = Some(palette);
        }
        shown.inner
    }

    /// All commands that there are now.
    fn palette_entries(&self) -> Vec<Entry> {
        let entry = |command| {
            let title = self.title_of(command)?;
            Some(Entry { command, title, refusal: self.refusal(command) })
        };
        Command::ALL.into_iter().filter_map(entry).collect()
    }

    /// A command by its whole name; `None` for a file that is not there.
    fn title_of(&self, command: Command) -> Option<String> {
        let name = command.name();
        Some(match command {
            Command::New(i) => format!("{name}: {}", TEMPLATES.get(i)?.0),
            Command::Example(i) => format!("{name}: {}", EXAMPLES.get(i)?.title),
            Command::OpenRecent(i) => {
                let path = self.settings.recent.get(i)?;
                let file = path.file_name().unwrap_or(path.as_os_str());
                format!("{name}: {}", file.to_string_lossy())
            }
            _ => name.to_owned(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn titles(typed: &str) -> Vec<String> {
        let entry =
            |command: Command| Entry { command, title: command.name().to_owned(), refusal: None };
        let entries = Command::ALL.into_iter().map(entry).collect();
        found(typed, entries).into_iter().map(|entry| entry.title).collect()
    }

    #[test]
    fn letters_fit_the_beginning_then_words_then_anywhere() {
        assert_eq!(titles("exp")[..2], ["Export picture…", "Exposure 0"]);
        assert_eq!(titles("cam")[0], "Move camera");
        assert_eq!(titles("LAYOUT")[0], "Reset layout");
        assert_eq!(titles("ltmx")[0], "Light mixer", "letters in this order");
        assert_eq!(titles("qqq"), Vec::<String>::new());
        assert_eq!(titles("").len(), Command::ALL.len());
    }

    #[test]
    fn every_command_is_found_by_its_name() {
        for command in Command::ALL {
            let first = titles(command.name());
            assert_eq!(first.first().map(String::as_str), Some(command.name()), "{command:?}");
        }
    }
}
