//! The field that takes the place of a name while it is changed.

use eframe::egui::{
    Key, TextEdit, Ui,
    text::{CCursor, CCursorRange},
};

use crate::document::things::Thing;
use crate::scene::Scene;

/// A name being changed.
pub(super) struct Renaming {
    thing: Thing,
    /// Its name when the field was opened.
    was: String,
    text: String,
    /// Whether the field had the keyboard already.
    focused: bool,
}

/// How the field was left.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Left {
    /// With a name, which may not do.
    With(Thing, String),
    /// By Escape.
    Without,
}

impl Renaming {
    /// The name of a thing that is in the scene.
    pub(super) fn new(scene: &Scene, thing: Thing) -> Renaming {
        let was = thing.name(scene).to_owned();
        Renaming { thing, text: was.clone(), was, focused: false }
    }

    /// Whether it is the name of this thing.
    pub(super) fn is_of(&self, thing: Thing) -> bool {
        self.thing == thing
    }

    /// Whether the thing still stands in its place in a scene: an undo may have taken it away.
    pub(super) fn is_in(&self, scene: &Scene) -> bool {
        let there = match self.thing {
            Thing::Light(i) => i < scene.lights.len(),
            Thing::Material(i) => i < scene.materials.len(),
        };
        there && self.thing.name(scene) == self.was
    }

    /// Shows the field; says when it is left.
    pub(super) fn ui(&mut self, ui: &mut Ui, present: &str) -> Option<Left> {
        let name = format!("name of {} {present}", self.thing.kind());
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
        let escaped = ui.input(|input| input.key_pressed(Key::Escape));
        let text = std::mem::take(&mut self.text);
        Some(if escaped { Left::Without } else { Left::With(self.thing, text) })
    }
}
