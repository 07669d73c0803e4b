//! The field that takes the place of a name while it is changed.

use eframe::egui::{
    Key, Label, RichText, TextEdit, Ui,
    text::{CCursor, CCursorRange},
};

use crate::document::things::{Thing, named};
use crate::scene::Scene;

/// A name being changed.
pub(super) struct Renaming {
    thing: Thing,
    /// Its name when the field was opened.
    was: String,
    text: String,
    /// Whether the field had the keyboard already.
    focused: bool,
    /// Whether Enter was pressed with a name that does not do.
    is_refused: bool,
}

/// How the field was left.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Left {
    /// With a name; one that does not do is given up, with a message.
    With(Thing, String),
    /// By Escape.
    Without,
}

impl Renaming {
    /// The name of a thing that is in the scene.
    pub(super) fn new(scene: &Scene, thing: Thing) -> Renaming {
        let was = thing.name(scene).to_owned();
        Renaming { thing, text: was.clone(), was, focused: false, is_refused: false }
    }

    /// Whether it is the name of this thing.
    pub(super) fn is_of(&self, thing: Thing) -> bool {
        self.thing == thing
    }

    /// Whether the thing still stands in its place in a scene: an undo may have taken it away.
    pub(super) fn is_in(&self, scene: &Scene) -> bool {
        self.thing.is_in(scene) && self.thing.name(scene) == self.was
    }

    /// Shows the field; says when it is left. Enter with a name that does not do leaves it open, with
    /// what was typed, and says why below it.
    pub(super) fn ui(&mut self, ui: &mut Ui, scene: &Scene) -> Option<Left> {
        let name = format!("name of {} {}", self.thing.kind(), self.thing.name(scene));
        let mut edit = TextEdit::singleline(&mut self.text).desired_width(f32::INFINITY).show(ui);
        let response = edit.response.response.clone().accessible_name(name);
        let response = response.on_hover_text("Enter takes the name, Escape keeps the old one");
        if !self.focused {
            response.request_focus();
            response.scroll_to_me(None);
            let all = CCursorRange::two(CCursor::new(0), CCursor::new(self.text.chars().count()));
            edit.state.cursor.set_char_range(Some(all));
            edit.state.store(ui.ctx(), response.id);
            self.focused = true;
            return None;
        }
        if !response.lost_focus() {
            return None;
        }
        let pressed = |key| ui.input(|input| input.key_pressed(key));
        if pressed(Key::Escape) {
            return Some(Left::Without);
        }
        if pressed(Key::Enter) && named(scene, self.thing, &self.text).is_err() {
            self.is_refused = true;
            response.request_focus();
            return None;
        }
        Some(Left::With(self.thing, std::mem::take(&mut self.text)))
    }

    /// Says below the field why the name was not taken, until it is one that does.
    pub(super) fn refusal_ui(&self, ui: &mut Ui, scene: &Scene) {
        if let Err(refusal) = named(scene, self.thing, &self.text)
            && self.is_refused
        {
            let refusal = RichText::new(refusal).color(ui.visuals().error_fg_color);
            ui.add(Label::new(refusal).wrap()).scroll_to_me(None);
        }
    }
}
