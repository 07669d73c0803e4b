//! Copies to the clipboard, and gives what was pasted to the one control that asked for it.

use std::time::Duration;

use eframe::egui::{Context, Event, Id, ViewportCommand};

/// How long the clipboard may take to answer.
const PATIENCE: Duration = Duration::from_secs(2);

/// A control that waits for the clipboard.
#[derive(Clone, Copy, Debug)]
struct Asked {
    by: Id,
    /// In seconds of the window's clock.
    at: f64,
}

fn place() -> Id {
    Id::unique("asked for the clipboard")
}

/// Asks for what the clipboard holds; [`pasted`] gives it to the same control, soon.
pub(super) fn ask(ctx: &Context, by: Id) {
    let at = ctx.input(|input| input.time);
    ctx.data_mut(|data| data.insert_temp(place(), Asked { by, at }));
    ctx.send_viewport_cmd(ViewportCommand::RequestPaste);
    ctx.request_repaint_after(PATIENCE);
}

/// Whether a control asked, and the clipboard turned out to hold no text; said once.
pub(super) fn is_empty(ctx: &Context) -> bool {
    let now = ctx.input(|input| input.time);
    let asked = ctx.data(|data| data.get_temp::<Asked>(place()));
    let is_empty = asked.is_some_and(|asked| now - asked.at >= PATIENCE.as_secs_f64());
    if is_empty {
        ctx.data_mut(|data| data.remove::<Asked>(place()));
    }
    is_empty
}

/// What was pasted for this control: it asked for it, or has the keyboard.
pub(super) fn pasted(ctx: &Context, id: Id, has_keyboard: bool) -> Option<String> {
    let now = ctx.input(|input| input.time);
    let asked = ctx.data(|data| data.get_temp::<Asked>(place()));
    let asked = asked.filter(|asked| now - asked.at < PATIENCE.as_secs_f64());
    match asked {
        Some(asked) if asked.by != id => return None,
        None if !has_keyboard => return None,
        _ => {}
    }
    let text = ctx.input_mut(|input| {
        let index = input.events.iter().position(|event| matches!(event, Event::Paste(_)))?;
        match input.events.remove(index) {
            Event::Paste(text) => Some(text),
            _ => None,
        }
    })?;
    ctx.data_mut(|data| data.remove::<Asked>(place()));
    Some(text)
}

/// Whether Ctrl-C was pressed; asked only by who has the keyboard.
pub(super) fn is_copied(ctx: &Context) -> bool {
    ctx.input_mut(|input| {
        let before = input.events.len();
        input.events.retain(|event| !matches!(event, Event::Copy));
        input.events.len() != before
    })
}

/// A text as a message quotes it: its first line, cut short.
pub(super) fn quoted(text: &str) -> String {
    const MOST: usize = 24;
    let line = text.trim().lines().next().unwrap_or_default().trim_end();
    match line.char_indices().nth(MOST) {
        Some((end, _)) => format!("`{}…`", &line[..end]),
        None => format!("`{line}`"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_text_is_quoted_in_short() {
        assert_eq!(quoted(" 1 + 1 \n2"), "`1 + 1`");
        assert_eq!(quoted(&"é".repeat(30)), format!("`{}…`", "é".repeat(24)));
        assert_eq!(quoted(""), "``");
    }
}
