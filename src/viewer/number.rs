//! A number that can be edited: slider, field, and a menu that copies, pastes and resets it.

use eframe::egui::{Button, DragValue, Id, Response, Ui, vec2};

use super::clipboard;
use super::hints::Scale;
use super::slider::Slider;
use crate::scene::range::Range;
use crate::scene::toml_text;

/// Width of a number field.
pub(super) const FIELD: f32 = 58.0;

/// In which precision a scene holds a number; it is copied in that, to the last bit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Precision {
    /// `f32`.
    Single,
    /// `f64`.
    Double,
    /// A whole number.
    Whole,
}

impl Precision {
    /// As the scene file writes it.
    pub(super) fn text(self, x: f64) -> String {
        match self {
            Precision::Single => toml_text::number(x as f32),
            Precision::Double => toml_text::number(x),
            Precision::Whole => format!("{}", x.round()),
        }
    }

    /// What a number of the scene file is in this precision.
    pub(super) fn read(self, text: &str) -> Option<f64> {
        match self {
            Precision::Single => text.parse::<f32>().ok().map(f64::from),
            Precision::Double | Precision::Whole => text.parse().ok(),
        }
    }
}

/// How a number is shown and typed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Face {
    /// Five digits.
    Plain,
    /// Stops above or below 1; those at or below this number are dark.
    Stops(Option<f64>),
    /// Kelvin; this number stands for a colour that has no temperature.
    Kelvin(Option<f64>),
}

impl Face {
    fn text(self, x: f64) -> String {
        match self {
            Face::Plain => shown(x),
            Face::Stops(Some(dark)) if x <= dark => "dark".into(),
            Face::Stops(_) => format!("{x:+.2}"),
            Face::Kelvin(Some(none)) if x == none => "—".into(),
            Face::Kelvin(_) => format!("{x:.0} K"),
        }
    }

    fn read(self, text: &str) -> Option<f64> {
        match self {
            Face::Plain | Face::Stops(_) => typed(text),
            Face::Kelvin(_) => typed(text.trim_end_matches(['K', ' '])),
        }
    }

    /// What a drag across a point changes.
    fn speed(self, x: f64) -> f64 {
        match self {
            Face::Plain => 0.005 * x.abs().max(0.2),
            Face::Stops(_) => 0.02,
            Face::Kelvin(_) => 10.0,
        }
    }
}

/// A number as its controls show it. The value itself is handed to them.
pub(super) struct Number<'a> {
    /// Its accessible name.
    pub(super) name: String,
    /// Whether there is no slider, so that the field bears that name; else it has ` value` behind it.
    pub(super) bare: bool,
    /// What it may be.
    pub(super) range: Range,
    /// How the scene holds it.
    pub(super) precision: Precision,
    /// How it is shown.
    pub(super) face: Face,
    /// What the slider covers.
    pub(super) scale: Scale,
    /// The saved value, if the present one is another.
    pub(super) saved: Option<f64>,
    /// The value that the scene file need not state, if there is one.
    pub(super) default: Box<dyn Fn() -> Option<f64> + 'a>,
    /// Where an edit stops being instant.
    pub(super) limits: Vec<f64>,
    /// The tooltip.
    pub(super) about: Box<dyn Fn(&mut Ui) + 'a>,
}

/// What was done with a control, besides what it wrote into the scene.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Edit {
    /// The value was changed.
    pub(super) changed: bool,
    /// The control whose edits go on, by wheel or by a second click, after the pointer is let go.
    pub(super) lasting: Option<Id>,
    /// Why what was pasted was not taken.
    pub(super) refused: Option<String>,
}

impl Edit {
    /// Both.
    pub(super) fn join(&mut self, other: Edit) {
        let Edit { changed, lasting, refused } = other;
        self.changed |= changed;
        self.lasting = lasting.or(self.lasting);
        self.refused = refused.or(self.refused.take());
    }
}

impl Number<'_> {
    /// A slider in all the space but `reserve` points, and the field behind it.
    pub(super) fn both_ui(&self, ui: &mut Ui, x: &mut f64, reserve: f32) -> Edit {
        let space = ui.available_width() - FIELD - ui.spacing().item_spacing.x - reserve;
        let mut edit = self.slider_ui(ui, x, space.max(40.0));
        edit.join(self.field_ui(ui, x, FIELD));
        edit
    }

    /// The slider alone. Typed and pasted numbers may leave its span, not the range.
    pub(super) fn slider_ui(&self, ui: &mut Ui, x: &mut f64, width: f32) -> Edit {
        ui.spacing_mut().slider_width = width;
        let slider = Slider {
            name: &self.name,
            scale: self.scale.clone(),
            whole: self.precision == Precision::Whole,
            saved: self.saved,
            limits: self.limits.clone(),
        };
        let before = *x;
        let (response, slid) = slider.ui(ui, x);
        if slid.changed {
            *x = self.fitting(*x);
        }
        if slid.reset {
            *x = self.saved.unwrap_or(*x);
        }
        let mut edit = Edit::default();
        if response.has_focus() && clipboard::is_copied(ui.ctx()) {
            ui.copy_text(self.precision.text(*x));
        }
        let has_keyboard = response.has_focus();
        let id = response.id;
        self.menu_ui(response, x, has_keyboard, &mut edit);
        edit.changed = *x != before;
        edit.lasting = (slid.lasting || slid.reset).then_some(id);
        edit
    }

    /// The field: drag it, or click and type. One that is left without an edit keeps every bit, also
    /// those that it does not show.
    pub(super) fn field_ui(&self, ui: &mut Ui, x: &mut f64, width: f32) -> Edit {
        let (before, face) = (*x, self.face);
        let field = DragValue::new(x)
            .speed(face.speed(before))
            .update_while_editing(false)
            .custom_parser(move |text| face.read(text))
            .custom_formatter(move |x, _| face.text(x));
        let response = ui.add_sized(vec2(width, ui.spacing().interact_size.y), field);
        let changed = response.changed() && face.text(before) != face.text(*x);
        *x = if changed { self.fitting(*x) } else { before };
        let response = match self.bare {
            true => response.accessible_name(&self.name),
            false => response.accessible_name(format!("{} value", self.name)),
        };
        let mut edit = Edit::default();
        self.menu_ui(response, x, false, &mut edit);
        edit.changed = *x != before;
        edit
    }

    /// The nearest number that it may be.
    fn fitting(&self, x: f64) -> f64 {
        let x = if self.precision == Precision::Whole { x.round() } else { x };
        self.range.clamp(x)
    }

    /// The tooltip and the menu of a right click; takes what is pasted.
    fn menu_ui(&self, response: Response, x: &mut f64, has_keyboard: bool, edit: &mut Edit) {
        let id = response.id;
        let response = response.on_hover_ui(|ui| (self.about)(ui));
        if let Some(text) = clipboard::pasted(&response.ctx, id, has_keyboard) {
            match self.face.read(&text) {
                Some(number) => {
                    *x = self.fitting(self.precision.read(text.trim()).unwrap_or(number))
                }
                None => edit.refused = Some(refusal(&text, "number")),
            }
        }
        response.context_menu(|ui| {
            let chosen = Menu {
                copied: &[("Copy value", "The number as the scene file writes it")],
                paste: ("Paste value", "Takes the number that was copied last, here or elsewhere"),
                saved: self.saved.map(|x| self.face.text(x)),
                default: (self.default)().map(|x| (self.face.text(x), x)),
            };
            match menu_ui(ui, &chosen, |default| default == *x) {
                Some(Choice::Copy(_)) => ui.copy_text(self.precision.text(*x)),
                Some(Choice::Paste) => clipboard::ask(ui.ctx(), id),
                Some(Choice::Saved) => *x = self.saved.unwrap_or(*x),
                Some(Choice::Default(default)) => *x = default,
                None => {}
            }
        });
    }
}

/// What to say of a text that is not what was wanted.
pub(super) fn refusal(text: &str, kind: &str) -> String {
    format!("{} was not pasted: it is no {kind}", clipboard::quoted(text))
}

/// What a right click on a value offers.
pub(super) struct Menu<'a, T> {
    /// Ways to copy it: name and what they do.
    pub(super) copied: &'a [(&'a str, &'a str)],
    /// Name of the way to paste it, and what it does.
    pub(super) paste: (&'a str, &'a str),
    /// The saved value as it is shown, if the present one is another.
    pub(super) saved: Option<String>,
    /// The default as it is shown, and itself.
    pub(super) default: Option<(String, T)>,
}

/// What was chosen of a [`Menu`].
pub(super) enum Choice<T> {
    /// The way of copying with this index.
    Copy(usize),
    /// Take what the clipboard holds.
    Paste,
    /// Back to what was saved.
    Saved,
    /// Back to the default.
    Default(T),
}

/// Shows a menu; `is_present` says whether the default is the present value already.
pub(super) fn menu_ui<T>(
    ui: &mut Ui,
    menu: &Menu<'_, T>,
    is_present: impl Fn(T) -> bool,
) -> Option<Choice<T>>
where
    T: Copy,
{
    let mut chosen = None;
    let item = |ui: &mut Ui, name: &str, about: Result<&str, &str>| {
        let button = ui.add_enabled(about.is_ok(), Button::new(name));
        let text = about.unwrap_or_else(|refusal| refusal);
        let button = button.on_hover_text(text).on_disabled_hover_text(text);
        if button.clicked() {
            ui.close();
        }
        button.clicked()
    };
    for (i, (name, about)) in menu.copied.iter().enumerate() {
        if item(ui, name, Ok(about)) {
            chosen = Some(Choice::Copy(i));
        }
    }
    if item(ui, menu.paste.0, Ok(menu.paste.1)) {
        chosen = Some(Choice::Paste);
    }
    ui.separator();
    let about = menu.saved.as_ref().map(|text| format!("Back to {text}; or a double click"));
    let about = about.as_deref().ok_or("It is what the scene file holds");
    if item(ui, "Reset to saved", about) {
        chosen = Some(Choice::Saved);
    }
    let about = match &menu.default {
        Some((_, default)) if is_present(*default) => Err("It is the default already".to_owned()),
        Some((text, _)) => Ok(format!("Back to {text}, which a scene file need not state")),
        None => Err("It has no default: a scene file must state it".to_owned()),
    };
    let about = about.as_deref().map_err(|refusal| refusal.as_str());
    if item(ui, "Reset to default", about)
        && let Some((_, default)) = menu.default
    {
        chosen = Some(Choice::Default(default));
    }
    chosen
}

/// What a typed text means, if it is a number: spaces do not count, a printed minus does.
pub(super) fn typed(text: &str) -> Option<f64> {
    let text: String = text.chars().filter(|c| !c.is_whitespace()).collect();
    text.replace('−', "-").parse().ok().filter(|x: &f64| !x.is_nan())
}

/// The `index`-th number of a value of the scene file; of a single number, which stands for all of
/// its parts, that one.
pub(super) fn part(value: &str, index: usize, precision: Precision) -> Option<f64> {
    let numbers = value.split(['[', ']', ',']).map(str::trim).filter(|text| !text.is_empty());
    let numbers: Vec<&str> = numbers.collect();
    let text = if numbers.len() == 1 { numbers.first() } else { numbers.get(index) };
    text.and_then(|text| precision.read(text))
}

/// Five significant digits at most, and no more than five after the point.
pub(super) fn shown(x: f64) -> String {
    if x == 0.0 {
        return "0".into();
    }
    let magnitude = x.abs().log10().floor() as i32;
    if !(-4..9).contains(&magnitude) {
        return format!("{x:.2e}");
    }
    let text = format!("{x:.*}", (4 - magnitude).clamp(0, 5) as usize);
    match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
        false => text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_numbers_are_taken_for_numbers() {
        for (text, x) in
            [("0.5", Some(0.5)), (" −1 000 ", Some(-1000.0)), ("NaN", None), ("1,5", None)]
        {
            assert_eq!(typed(text), x, "{text}");
        }
    }

    #[test]
    fn numbers_are_shown_with_five_digits() {
        for (x, text) in [
            (0.0, "0"),
            (0.7, "0.7"),
            (f64::from(0.7f32), "0.7"),
            (-5.25, "-5.25"),
            (1.0 / 3.0, "0.33333"),
            (123_456.7, "123457"),
            (1000.0, "1000"),
            (1.0 / 255.0, "0.00392"),
            (1e-9, "1.00e-9"),
            (1e12, "1.00e12"),
        ] {
            assert_eq!(shown(x), text);
        }
    }

    #[test]
    fn a_copied_number_has_all_its_bits() {
        for bits in [0x3eaa_aaabu32, 0x3dcc_cccd, 0x0000_0001, 0x7f7f_ffff] {
            let x = f64::from(f32::from_bits(bits));
            assert_eq!(Precision::Single.read(&Precision::Single.text(x)), Some(x));
        }
        assert_eq!(Precision::Single.text(f64::from(0.1f32)), "0.1");
        assert_ne!(Precision::Double.text(f64::from(0.1f32)), "0.1");
        assert_eq!(Precision::Double.read("0.1"), Some(0.1));
        assert_eq!(Precision::Whole.text(16.0), "16");
    }

    #[test]
    fn parts_of_a_value_are_found() {
        let single = Precision::Single;
        assert_eq!(part("0.5", 2, single), Some(0.5));
        assert_eq!(part("[0.5, 1, 2e-3]", 2, single), Some(f64::from(2e-3f32)));
        assert_eq!(part("[[1, 2, 3], [4, 5, 6]]", 4, Precision::Double), Some(5.0));
        assert_eq!(part("[1, 2]", 5, single), None);
        assert_eq!(part("true", 0, single), None);
    }

    #[test]
    fn faces_read_what_they_show() {
        for (face, x, text) in [
            (Face::Stops(None), 1.5, "+1.50"),
            (Face::Stops(Some(-24.0)), -24.0, "dark"),
            (Face::Kelvin(None), 6504.2, "6504 K"),
            (Face::Kelvin(Some(6504.0)), 6504.0, "—"),
        ] {
            assert_eq!(face.text(x), text);
        }
        assert_eq!(Face::Kelvin(None).read("3000 K"), Some(3000.0));
        assert_eq!(Face::Stops(None).read("+2"), Some(2.0));
        assert_eq!(Face::Plain.read("hot"), None);
    }
}
