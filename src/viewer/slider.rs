//! The slider: a rail with a handle that is moved by the pointer, the wheel and the keys.

use eframe::egui::accesskit::{Action, ActionData};
use eframe::egui::emath::smart_aim::best_in_range_f64;
use eframe::egui::{
    Color32, Context, CornerRadius, Event, EventFilter, Id, Key, Modifiers, MouseWheelUnit, Rect,
    Response, Sense, Stroke, Ui, Vec2, WidgetInfo, pos2, vec2,
};

use super::hints::Scale;

/// What Shift makes of every movement.
const FINE: f32 = 0.1;
/// How far a line of the wheel moves the handle, in points.
const WHEEL: f32 = 3.0;
/// Points of a trackpad that count as a line of the wheel.
const LINE: f32 = 40.0;
/// The least number above 0 that a logarithmic rail tells apart from 0.
const LEAST: f64 = 1.0;

/// A slider as it is shown; the value is handed to [`Slider::ui`].
pub(super) struct Slider<'a> {
    /// Its accessible name.
    pub(super) name: &'a str,
    /// What the rail covers.
    pub(super) scale: Scale,
    /// Whether the value is a whole number, which a step changes by 1 at least.
    pub(super) whole: bool,
    /// A mark on the rail: the saved value, if the present one is another.
    pub(super) saved: Option<f64>,
    /// Marks below the rail, where an edit stops being instant.
    pub(super) limits: Vec<f64>,
}

/// What was done with a slider besides its [`Response`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Slid {
    /// The value was changed.
    pub(super) changed: bool,
    /// More may follow that belongs to the same edit: turns of the wheel, a second click.
    pub(super) lasting: bool,
    /// A double click: the saved value is wanted back.
    pub(super) reset: bool,
}

/// How the pointer holds the handle: both along the rail, in points.
#[derive(Clone, Debug)]
struct Grip {
    handle: f32,
    pointer: f32,
    /// What the rail covers as long as it is held: a span that follows the value would run from it.
    scale: Scale,
}

impl Slider<'_> {
    /// Shows the slider in the width of `slider_width` and writes into `value`.
    pub(super) fn ui(&self, ui: &mut Ui, value: &mut f64) -> (Response, Slid) {
        let size = vec2(ui.spacing().slider_width, ui.spacing().interact_size.y);
        let (rect, mut response) = ui.allocate_exact_size(size, Sense::click_and_drag());
        let held = grip_of(ui, &response).map(|grip| grip.scale);
        let scale = held.as_ref().unwrap_or(&self.scale);
        let rail = Rail { rect, scale };
        let before = *value;
        let mut slid = Slid::default();
        if response.double_clicked() {
            grip(ui, &response, None);
            slid.reset = true;
        } else {
            self.hold(ui, &response, &rail, value);
            slid.lasting = response.clicked();
        }
        slid.lasting |= self.wheel(ui, &response, &rail, value);
        self.keys(ui, &response, &rail, value);
        slid.changed = *value != before;
        if slid.changed {
            response.mark_changed();
        }
        let (enabled, shown) = (ui.is_enabled(), *value);
        response.widget_info(|| WidgetInfo::slider(enabled, shown, self.name));
        self.declare(ui, &response, shown);
        if ui.is_rect_visible(rect) {
            self.paint(ui, &response, &rail, shown);
        }
        (response, slid)
    }

    /// A press beside the handle moves it there; a drag moves it by as much as the pointer, with
    /// Shift by a tenth of that.
    fn hold(&self, ui: &Ui, response: &Response, rail: &Rail<'_>, value: &mut f64) {
        let (down, fine) = ui.input(|i| (i.pointer.primary_down(), i.modifiers.shift));
        let held = grip_of(ui, response);
        let pressed = response.is_pointer_button_down_on() && down;
        let Some(pointer) = response.interact_pointer_pos().map(|at| at.x) else {
            return grip(ui, response, None);
        };
        let is_new = held.is_none() && (pressed || response.clicked());
        if held.is_none() && !is_new {
            return;
        }
        let handle = rail.position(*value);
        let mut now = held.unwrap_or_else(|| {
            response.request_focus();
            note_focus(ui, response.id);
            let is_on_handle = (pointer - handle).abs() <= rail.radius() + 1.0;
            let handle = if is_on_handle { handle } else { pointer };
            Grip { handle, pointer, scale: rail.scale.clone() }
        });
        let factor = if fine { FINE } else { 1.0 };
        now.handle += (pointer - now.pointer) * factor;
        let moved = pointer != now.pointer || (is_new && now.handle != handle);
        now.pointer = pointer;
        if moved {
            *value = rail.aimed(now.handle, ui.input(|i| i.aim_radius()) * factor);
        }
        grip(ui, response, Some(now).filter(|_| pressed));
    }

    /// Turns of the wheel move the handle of a slider that has the keyboard; whether they did.
    fn wheel(&self, ui: &Ui, response: &Response, rail: &Rail<'_>, value: &mut f64) -> bool {
        if !response.has_focus() || !response.hovered() {
            return false;
        }
        let lines = ui.input_mut(|input| {
            if input.modifiers.command {
                return 0.0;
            }
            // The panel around it stays where it is.
            input.smooth_scroll_delta = Vec2::ZERO;
            let lines = |event: &Event| match event {
                Event::MouseWheel { unit, delta, .. } => match unit {
                    MouseWheelUnit::Line => delta.x + delta.y,
                    MouseWheelUnit::Point => (delta.x + delta.y) / LINE,
                    MouseWheelUnit::Page => 10.0 * (delta.x + delta.y),
                },
                _ => 0.0,
            };
            let factor = if input.modifiers.shift { FINE } else { 1.0 };
            factor * input.events.iter().map(lines).sum::<f32>()
        });
        self.step(rail, value, WHEEL * lines);
        lines != 0.0
    }

    /// The arrows move the handle by a point, with Shift by a tenth; a screen reader may too.
    fn keys(&self, ui: &Ui, response: &Response, rail: &Rail<'_>, value: &mut f64) {
        let mut steps = 0.0;
        if response.has_focus() {
            note_focus(ui, response.id);
            let filter = EventFilter { horizontal_arrows: true, ..EventFilter::default() };
            ui.memory_mut(|memory| memory.set_focus_lock_filter(response.id, filter));
            for (key, way) in [(Key::ArrowLeft, -1.0), (Key::ArrowRight, 1.0)] {
                let count = |modifiers| {
                    ui.input_mut(|input| input.count_and_consume_key(modifiers, key)) as f32
                };
                steps += way * (FINE * count(Modifiers::SHIFT) + count(Modifiers::NONE));
            }
        }
        let wanted = ui.input(|input| {
            let count = |action| input.num_accesskit_action_requests(response.id, action) as f32;
            steps += count(Action::Increment) - count(Action::Decrement);
            let requests = input.accesskit_action_requests(response.id, Action::SetValue);
            let number = |data: &Option<ActionData>| match data {
                Some(ActionData::NumericValue(x)) => Some(*x),
                _ => None,
            };
            requests.filter_map(|request| number(&request.data)).last()
        });
        self.step(rail, value, steps);
        *value = wanted.unwrap_or(*value);
    }

    /// Moves the handle by so many points.
    fn step(&self, rail: &Rail<'_>, value: &mut f64, points: f32) {
        if points == 0.0 {
            return;
        }
        // Round numbers that are nearer to where it goes than to where it was.
        let to = rail.aimed(rail.position(*value) + points, 0.49 * points.abs());
        let whole = *value + f64::from(points.signum());
        *value = if self.whole && to.round() == value.round() { whole } else { to };
        let (low, high) = (rail.scale.span.start(), rail.scale.span.end());
        *value = value.clamp(*low, *high);
    }

    /// Tells a screen reader what can be done.
    fn declare(&self, ui: &Ui, response: &Response, value: f64) {
        let (low, high) = (*self.scale.span.start(), *self.scale.span.end());
        ui.ctx().accesskit_node_builder(response.id, |node| {
            node.set_min_numeric_value(low);
            node.set_max_numeric_value(high);
            node.add_action(Action::SetValue);
            if value < high {
                node.add_action(Action::Increment);
            }
            if value > low {
                node.add_action(Action::Decrement);
            }
        });
    }

    fn paint(&self, ui: &Ui, response: &Response, rail: &Rail<'_>, value: f64) {
        let (painter, visuals) = (ui.painter(), ui.visuals());
        let middle = rail.rect.center().y;
        let half = ui.spacing().slider_rail_height / 2.0;
        let bar = |left: f32, right: f32| {
            Rect::from_min_max(pos2(left, middle - half), pos2(right, middle + half))
        };
        let round = CornerRadius::same(2);
        let (left, right) = (rail.rect.left(), rail.rect.right());
        let handle = rail.position(value);
        painter.rect_filled(bar(left, right), round, visuals.widgets.inactive.bg_fill);
        painter.rect_filled(bar(left, handle), round, visuals.selection.bg_fill);
        for x in self.limits.iter().filter(|x| rail.scale.span.contains(x)) {
            // Below the rail, so that the handle does not hide it.
            let at = rail.position(*x);
            let line = [pos2(at, middle + 4.0), pos2(at, rail.rect.bottom())];
            painter.line_segment(line, Stroke::new(1.5, LIMIT));
        }
        if let Some(saved) = self.saved {
            let at = rail.position(saved);
            let line = [pos2(at, rail.rect.top()), pos2(at, middle - 4.0)];
            painter.line_segment(line, Stroke::new(1.5, visuals.weak_text_color()));
        }
        // The keyboard shows as a ring: only a held handle looks held.
        let look = match (response.is_pointer_button_down_on(), response.hovered()) {
            (true, _) => &visuals.widgets.active,
            (false, true) => &visuals.widgets.hovered,
            (false, false) => &visuals.widgets.inactive,
        };
        let radius = rail.radius() + look.expansion;
        let stroke = match response.has_focus() {
            true => Stroke::new(2.0, visuals.selection.stroke.color),
            false => look.fg_stroke,
        };
        painter.circle(pos2(handle, middle), radius, look.bg_fill, stroke);
    }
}

/// The colour of the marks where an edit stops being instant.
const LIMIT: Color32 = Color32::from_rgb(200, 140, 30);

/// Where the handle may be, and which value is where.
struct Rail<'a> {
    rect: Rect,
    scale: &'a Scale,
}

impl Rail<'_> {
    /// Of the handle.
    fn radius(&self) -> f32 {
        self.rect.height() / 2.5
    }

    fn ends(&self) -> [f32; 2] {
        [self.rect.left() + self.radius(), self.rect.right() - self.radius()]
    }

    /// Where the handle stands for a value: at the nearer end for one that the rail does not cover.
    fn position(&self, value: f64) -> f32 {
        let [left, right] = self.ends();
        left + (right - left) * share_of(self.scale, value) as f32
    }

    /// The value at a position.
    fn value(&self, position: f32) -> f64 {
        let [left, right] = self.ends();
        value_at(self.scale, f64::from((position - left) / (right - left)))
    }

    /// The roundest value within so many points of a position.
    fn aimed(&self, position: f32, radius: f32) -> f64 {
        best_in_range_f64(self.value(position - radius), self.value(position + radius))
    }
}

/// Natural logarithms of the ends of a logarithmic rail.
fn logarithms(scale: &Scale) -> [f64; 2] {
    let (low, high) = (*scale.span.start(), *scale.span.end());
    [(if low > 0.0 { low } else { LEAST.min(high) }).ln(), high.ln()]
}

/// Which share of the rail lies below a value, 0 to 1.
fn share_of(scale: &Scale, value: f64) -> f64 {
    let (low, high) = (*scale.span.start(), *scale.span.end());
    if value <= low || high <= low {
        return 0.0;
    }
    let share = match scale.logarithmic {
        true => {
            let [a, b] = logarithms(scale);
            (value.ln() - a) / (b - a)
        }
        false => (value - low) / (high - low),
    };
    share.clamp(0.0, 1.0)
}

/// Undoes [`share_of`].
fn value_at(scale: &Scale, share: f64) -> f64 {
    let (low, high) = (*scale.span.start(), *scale.span.end());
    if share <= 0.0 {
        low
    } else if share >= 1.0 {
        high
    } else if scale.logarithmic {
        let [a, b] = logarithms(scale);
        (a + (b - a) * share).exp()
    } else {
        low + (high - low) * share
    }
}

fn grip_of(ui: &Ui, response: &Response) -> Option<Grip> {
    ui.data(|data| data.get_temp(response.id))
}

fn grip(ui: &Ui, response: &Response, grip: Option<Grip>) {
    ui.data_mut(|data| {
        data.remove::<Grip>(response.id);
        if let Some(grip) = grip {
            data.insert_temp(response.id, grip);
        }
    });
}

/// Which widget the note about the keyboard belongs to.
#[derive(Clone, Copy, Debug)]
struct Focused(Id);

fn note_focus(ui: &Ui, id: Id) {
    ui.data_mut(|data| data.insert_temp(Id::unique("focused slider"), Focused(id)));
}

/// Whether a slider has the keyboard: it takes the arrows, and leaves all letters to the window.
pub(super) fn has_keyboard(ctx: &Context) -> bool {
    let noted = ctx.data(|data| data.get_temp::<Focused>(Id::unique("focused slider")));
    noted.is_some_and(|Focused(id)| ctx.memory(|memory| memory.has_focus(id)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scale(low: f64, high: f64, logarithmic: bool) -> Scale {
        Scale { span: low..=high, logarithmic }
    }

    #[test]
    fn positions_and_values_undo_each_other() {
        for scale in [
            scale(0.0, 1.0, false),
            scale(-5.0, 5.0, false),
            scale(0.0, 1000.0, true),
            scale(1000.0, 15_000.0, true),
        ] {
            for i in 0..=10 {
                let share = f64::from(i) / 10.0;
                let value = value_at(&scale, share);
                assert!(scale.span.contains(&value), "{scale:?} {share}: {value}");
                assert!((share_of(&scale, value) - share).abs() < 1e-9, "{scale:?} {share}");
            }
            assert_eq!(share_of(&scale, 1e9), 1.0);
            assert_eq!(share_of(&scale, -1e9), 0.0);
        }
        assert_eq!(value_at(&scale(1000.0, 15_000.0, true), 0.0), 1000.0);
        assert_eq!(share_of(&scale(0.0, 1000.0, true), 0.0), 0.0);
        assert_eq!(share_of(&scale(2.0, 2.0, false), 2.0), 0.0, "an empty rail");
    }
}
