//! The operation of a solid that is made of others, and the list of its operands.

use std::sync::Arc;

use eframe::egui::{Button, ComboBox, Id, Response, Ui};

use super::inspector::{Outcome, Selection};
use super::paints::kind_ui;
use crate::scene::csg::Operation;
use crate::scene::{Scene, Shape};

/// The keys of all operations.
const KEYS: [&str; 5] = ["union", "merge", "intersection", "difference", "complement"];

/// What the person wants done with the list.
enum Wish {
    /// The operand at this place changes places with the next one.
    Exchange(usize),
    /// The operand at this place is one no more.
    Remove(usize),
    /// One more operand, by its index among the solids.
    Add(usize),
}

/// Lets the solid with this index, if it is made of others, be made otherwise.
pub(super) fn operands_ui(ui: &mut Ui, scene: &mut Scene, whole: usize, outcome: &mut Outcome) {
    let Shape::Csg { operation, operands } = &scene.solids[whole].shape else { return };
    let chosen = kind_ui(ui, "operation", operation.key(), &KEYS).and_then(Operation::named);
    let mut wish = None;
    for (place, &operand) in operands.iter().enumerate() {
        let name = scene.solids.get(operand).map_or("?", |solid| solid.name.as_str());
        ui.horizontal(|ui| {
            let link = ui.link(format!("{}. {name}", place + 1));
            if link.on_hover_text("Shows this operand").clicked() {
                outcome.select = Some(Selection::Solid(operand));
            }
            wish = buttons_ui(ui, place, operands.len()).or(wish.take());
        });
    }
    let wish = wish.or(picker_ui(ui, scene, whole).map(Wish::Add));
    if chosen.is_none() && wish.is_none() {
        return;
    }
    let Shape::Csg { operation, operands } = &mut scene.solids[whole].shape else { return };
    *operation = chosen.unwrap_or(*operation);
    match wish {
        Some(Wish::Exchange(place)) => operands.swap(place, place + 1),
        Some(Wish::Remove(place)) => drop(operands.remove(place)),
        Some(Wish::Add(operand)) => operands.push(operand),
        None => {}
    }
    outcome.changed = true;
}

/// What can be done with the operand at a place of a list of so many.
fn buttons_ui(ui: &mut Ui, place: usize, count: usize) -> Option<Wish> {
    let number = place + 1;
    let mut button = |text: &str, name: String, about: &str, refusal: Option<&str>| {
        let button = ui.add_enabled(refusal.is_none(), Button::new(text).small());
        told(button.accessible_name(name), about, refusal.unwrap_or_default()).clicked()
    };
    let first = (place == 0).then_some("It is the first one already");
    let last = (number == count).then_some("It is the last one already");
    let only = (count == 1).then_some("It is the only one: add another one first");
    let up = button(
        "Up",
        format!("move operand {number} up"),
        "Nearer to the first one, which the others are cut out of in a difference",
        first,
    );
    let down = button(
        "Down",
        format!("move operand {number} down"),
        "Farther from the first one, which the others are cut out of in a difference",
        last,
    );
    let remove = button(
        "Remove",
        format!("remove operand {number}"),
        "It is then a solid of its own, unless something else is made of it",
        only,
    );
    match () {
        () if up => Some(Wish::Exchange(place - 1)),
        () if down => Some(Wish::Exchange(place)),
        () if remove => Some(Wish::Remove(place)),
        () => None,
    }
}

/// A list of all other solids, those that cannot be operands with the reason; the one that was chosen.
fn picker_ui(ui: &mut Ui, scene: &Scene, whole: usize) -> Option<usize> {
    let id = Id::unique(("refused operands", whole));
    let mut chosen = None;
    let combo = ComboBox::from_id_salt(("operand", whole)).selected_text("Add operand");
    let list = combo.width(120.0).show_ui(ui, |ui| {
        // Whether a large mesh is closed is looked at once, when the list opens.
        let known = ui.data(|data| data.get_temp::<Arc<Vec<Option<String>>>>(id));
        let refusals = known.unwrap_or_else(|| {
            let all = 0..scene.solids.len();
            Arc::new(all.map(|operand| scene.operand_refusal(whole, operand)).collect())
        });
        for (i, solid) in scene.solids.iter().enumerate().filter(|(i, _)| *i != whole) {
            let refusal = refusals.get(i).and_then(|refusal| refusal.as_deref());
            let line = Button::selectable(false, solid.name.as_str());
            let line = ui.add_enabled(refusal.is_none(), line);
            let line = line.accessible_name(format!("add {}", solid.name));
            let about = "Makes it an operand: it is then not seen by itself";
            if told(line, about, refusal.unwrap_or_default()).clicked() {
                chosen = Some(i);
            }
        }
        ui.data_mut(|data| data.insert_temp(id, refusals));
    });
    if list.inner.is_none() {
        ui.data_mut(|data| data.remove_temp::<Arc<Vec<Option<String>>>>(id));
    }
    let about = "One more solid that it is made of";
    list.response.accessible_name("Add operand").on_hover_text(about);
    chosen
}

fn told(response: Response, about: &str, refusal: &str) -> Response {
    response.on_hover_text(about).on_disabled_hover_text(refusal)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_operation_can_be_chosen() {
        assert_eq!(KEYS, Operation::ALL.map(Operation::key));
    }
}
