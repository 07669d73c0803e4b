//! What all questions over the window have in common: they take the keyboard, and cover the rest.

use eframe::egui::{Context, Id, Modal, ModalResponse, PointerState, Response, ScrollArea, Ui};

/// Shows a question over the window; `name` tells it apart from other questions.
pub(super) fn question<T>(
    ctx: &Context,
    name: &str,
    add: impl FnOnce(&mut Ui) -> T,
) -> ModalResponse<T> {
    if ctx.memory(|memory| memory.top_modal_layer().is_none()) {
        // What the pointer rests on is covered from now on. egui keeps a tooltip as long as the
        // pointer rests, even above the question: it forgets the pointer until it moves.
        ctx.input_mut(|input| input.pointer = PointerState::default());
    }
    Modal::new(Id::unique(name)).show(ctx, add)
}

/// Makes a button of a question the one that Enter presses, unless the person has gone to another
/// control of the question.
pub(super) fn first(ui: &Ui, button: &Response) {
    let focused = ui.memory(|memory| memory.focused()).and_then(|id| ui.ctx().read_response(id));
    if focused.is_none_or(|focused| focused.layer_id != ui.layer_id()) {
        button.request_focus();
    }
}

/// A part of a question that scrolls from so many points of height on. It has its height at once: a
/// question is as tall as it was a moment before, and would grow into a taller one bit by bit.
pub(super) fn scroll_up_to(height: f32) -> ScrollArea {
    ScrollArea::both().max_height(height).min_scrolled_height(height).auto_shrink([true, true])
}
