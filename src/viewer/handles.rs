//! The handles of the lights over the picture: what they look like, and what moving them does.

use std::collections::BTreeMap;

use eframe::egui::{
    Color32, CursorIcon, EventFilter, Id, Key, Modifiers, Painter, PointerButton, Pos2, Rect,
    Response, Role, Sense, Stroke, Ui, Vec2, WidgetInfo, vec2,
};
use glam::{DVec2, dvec2};

use super::badge;
use super::carry::{Globe, Spot, carried, spot};
use super::inspector::Selection;
use super::outline::shown;
use crate::forest::camera::View;
use crate::scene::path::join;
use crate::scene::{Light, LightPlace, Scene};
use crate::session::cost::Cost;

/// With more lights than this only the selected one has a handle.
const MOST: usize = 200;
/// Below this height of the picture on the screen, in points, handles would only be in the way.
const LOWEST: f32 = 120.0;
/// Radius of a handle in points.
const RADIUS: f32 = 6.0;
/// Length of the arrow of a direction, in points.
const ARROW: f32 = 26.0;
/// What an arrow key moves a handle by, in parts of the picture's height.
const KEY_STEP: f64 = 0.02;

/// The handles and what holds one of them.
#[derive(Default)]
pub(super) struct Handles {
    /// Whether the lights have handles at all.
    pub(super) hidden: bool,
    grip: Option<Grip>,
    /// The path of the place of the light under the pointer: its cost is asked for.
    pub(super) hovered: Option<String>,
}

/// A handle being dragged.
struct Grip {
    /// Index of the light.
    light: usize,
    /// Where the light was when the drag began, or Shift was pressed or released.
    place: LightPlace,
    /// Where the pointer was then, in points.
    from: Pos2,
    /// Whether it moves along the view.
    along: bool,
}

/// Where the picture is, and what else the handles depend on.
pub(super) struct Stage<'a> {
    view: View,
    /// Of the picture, in pixels.
    size: [u32; 2],
    /// The whole picture on the screen, in points.
    picture: Rect,
    /// The part of the screen in which it shows.
    clip: Rect,
    selected: Selection,
    costs: &'a BTreeMap<String, Cost>,
}

impl<'a> Stage<'a> {
    /// The picture of `scene` lies at `picture` on the screen, of which `clip` shows.
    pub(super) fn new(
        scene: &Scene,
        [picture, clip]: [Rect; 2],
        selected: Selection,
        costs: &'a BTreeMap<String, Cost>,
    ) -> Stage<'a> {
        let size = scene.picture.size;
        Stage { view: View::new(&scene.camera, size), size, picture, clip, selected, costs }
    }

    /// A pixel of the picture in points.
    fn on_screen(&self, at: DVec2) -> Pos2 {
        let [width, height] = self.size.map(|side| side as f32);
        self.picture.min + vec2(at.x as f32 / width, at.y as f32 / height) * self.picture.size()
    }

    /// A way in points as pixels of the picture.
    fn in_pixels(&self, way: Vec2) -> DVec2 {
        let scale = f64::from(self.size[1]) / f64::from(self.picture.height());
        dvec2(way.x.into(), way.y.into()) * scale
    }

    fn carried(&self, place: &LightPlace, moved: DVec2, along: bool) -> LightPlace {
        carried(&self.view, self.size, place, moved, along)
    }
}

/// What the person did with the handles.
#[derive(Debug, Default)]
pub(super) struct HandlesOutcome {
    /// A light was moved.
    pub(super) changed: bool,
    /// A light was clicked or taken.
    pub(super) select: Option<Selection>,
}

impl Handles {
    /// Shows the handles over the picture; they write into the lights.
    pub(super) fn ui(
        &mut self,
        ui: &mut Ui,
        stage: &Stage<'_>,
        lights: &mut [Light],
    ) -> HandlesOutcome {
        let mut outcome = HandlesOutcome::default();
        self.hovered = None;
        if self.hidden || stage.picture.height() < LOWEST {
            self.grip = None;
            return outcome;
        }
        let few = lights.len() <= MOST;
        for (i, light) in lights.iter_mut().enumerate() {
            let selected = stage.selected == Selection::Light(i);
            let held = self.grip.as_ref().is_some_and(|grip| grip.light == i);
            let spot = spot(&stage.view, stage.size, &light.place);
            let Some(spot) = spot.filter(|spot| held || spot.inside && (few || selected)) else {
                continue;
            };
            let center = stage.on_screen(spot.at);
            if !held && !stage.clip.contains(center) {
                continue;
            }
            let response = handle_ui(ui, (i, light), center);
            let place = match self.dragged(ui, stage, &response, (i, light)) {
                Some(place) => place,
                None => stepped(ui, stage, &response, light),
            };
            outcome.changed |= place != light.place;
            light.place = place;
            if response.clicked() || response.drag_started() {
                outcome.select = Some(Selection::Light(i));
            }
            let alive = held || response.hovered() || response.has_focus();
            paint(ui, stage, &spot, (light, selected, alive));
            self.explain(response, stage, light);
        }
        outcome
    }

    /// Where a drag brings the light, while there is one.
    fn dragged(
        &mut self,
        ui: &Ui,
        stage: &Stage<'_>,
        response: &Response,
        (i, light): (usize, &Light),
    ) -> Option<LightPlace> {
        if !response.dragged_by(PointerButton::Primary) {
            self.grip.take_if(|grip| grip.light == i);
            return None;
        }
        let pointer = response.interact_pointer_pos()?;
        let along = ui.input(|input| input.modifiers.shift);
        let grip = match self.grip.take().filter(|grip| grip.light == i) {
            Some(grip) if grip.along == along => grip,
            Some(_) => Grip { light: i, place: light.place.clone(), from: pointer, along },
            None => {
                let from = ui.input(|input| input.pointer.press_origin()).unwrap_or(pointer);
                Grip { light: i, place: light.place.clone(), from, along }
            }
        };
        let way = stage.in_pixels(pointer - grip.from);
        let place = match way == DVec2::ZERO {
            true => light.place.clone(),
            false => stage.carried(&grip.place, way, along),
        };
        self.grip = Some(grip);
        Some(place)
    }

    /// A tooltip with what moving the handle does and costs.
    fn explain(&mut self, response: Response, stage: &Stage<'_>, light: &Light) {
        let about = match light.place {
            LightPlace::Direction(_) => DIRECTION,
            LightPlace::Spot { .. } => SPOT,
            LightPlace::Point(_) | LightPlace::Area(_) => POINT,
        };
        if !response.hovered() && !response.has_focus() {
            return;
        }
        let list = join("lights", &light.name);
        let path = light.place.anchor_keys().iter().fold(list, |path, key| join(&path, key));
        response.on_hover_cursor(CursorIcon::Grab).on_hover_ui(|ui| {
            ui.strong(format!("light {}", light.name));
            ui.label(about);
            ui.weak(badge::explanation(stage.costs.get(&path).copied()));
        });
        self.hovered = Some(path);
    }
}

const POINT: &str = "Drag moves it parallel to the picture, Shift-drag farther (up) or nearer (down); \
                     the arrow keys do the same. A click shows its parameters";
const SPOT: &str = "Drag moves it parallel to the picture, Shift-drag farther (up) or nearer (down); it \
                    keeps shining at the same point. The arrow keys do the same. A click shows its \
                    parameters";
const DIRECTION: &str = "It shines from this point of the globe towards the middle. Drag turns it, \
                         beyond the rim to the far side; so do the arrow keys. A click shows its \
                         parameters";

/// What can be taken, clicked, or reached by Tab.
fn handle_ui(ui: &Ui, (i, light): (usize, &Light), center: Pos2) -> Response {
    let rect = Rect::from_center_size(center, Vec2::splat(2.0 * RADIUS + 4.0));
    let id = Id::unique(("light handle", i));
    let response = ui.interact(rect, id, Sense::click_and_drag());
    let name = format!("light {} handle", light.name);
    response.widget_info(|| WidgetInfo::labeled(Role::Button, true, &name));
    let arrows =
        EventFilter { horizontal_arrows: true, vertical_arrows: true, ..EventFilter::default() };
    ui.memory_mut(|memory| memory.set_focus_lock_filter(id, arrows));
    response
}

/// Where the arrow keys bring a light whose handle has the keyboard.
fn stepped(ui: &Ui, stage: &Stage<'_>, response: &Response, light: &Light) -> LightPlace {
    if !response.has_focus() {
        return light.place.clone();
    }
    let ways = [
        (Key::ArrowLeft, dvec2(-1.0, 0.0)),
        (Key::ArrowRight, dvec2(1.0, 0.0)),
        (Key::ArrowUp, dvec2(0.0, -1.0)),
        (Key::ArrowDown, dvec2(0.0, 1.0)),
    ];
    let step = KEY_STEP * f64::from(stage.size[1]);
    let mut place = light.place.clone();
    for (modifiers, along) in [(Modifiers::SHIFT, true), (Modifiers::NONE, false)] {
        for (key, way) in ways {
            let presses = ui.input_mut(|input| input.count_and_consume_key(modifiers, key));
            if presses > 0 {
                place = stage.carried(&place, way * step * presses as f64, along);
            }
        }
    }
    place
}

/// Draws a handle so that it stands out from light and dark pictures: white within black.
fn paint(ui: &Ui, stage: &Stage<'_>, spot: &Spot, (light, selected, alive): (&Light, bool, bool)) {
    let painter = ui.painter_at(stage.clip);
    let center = stage.on_screen(spot.at);
    if let Some(globe) = &spot.globe {
        globe_ui(&painter, stage, globe, center, alive);
    }
    let radius = RADIUS + if alive { 1.5 } else { 0.0 };
    painter.circle_filled(center, radius + if selected { 4.0 } else { 2.0 }, OUTSIDE);
    if selected {
        painter.circle_filled(center, radius + 3.0, SELECTED);
    }
    painter.circle_filled(center, radius + 1.0, Color32::WHITE);
    let inside = if light.on { shown(light.color) } else { Color32::from_gray(40) };
    painter.circle_filled(center, radius - 1.0, inside);
    if spot.globe.is_some_and(|globe| globe.behind) {
        painter.circle_filled(center, 2.5, Color32::BLACK);
        painter.circle_stroke(center, 2.5, Stroke::new(1.0, Color32::WHITE));
    }
}

/// The dark rim around everything white.
const OUTSIDE: Color32 = Color32::from_black_alpha(200);

/// The ring around the handle of the selected light.
const SELECTED: Color32 = Color32::from_rgb(60, 150, 255);

/// The arrow of a direction, and, while it is looked at, the globe.
fn globe_ui(painter: &Painter, stage: &Stage<'_>, globe: &Globe, at: Pos2, alive: bool) {
    let middle = stage.on_screen(globe.center);
    let way = middle - at;
    let arrow = way.normalized() * ARROW.min(way.length());
    let rim = globe.radius as f32 * stage.picture.height() / stage.size[1] as f32;
    for (width, color) in [(3.5, OUTSIDE), (1.5, Color32::WHITE)] {
        let stroke = Stroke::new(width, color);
        if alive {
            painter.circle_stroke(middle, rim, stroke);
            painter.line_segment([at, middle], stroke);
        } else {
            painter.line_segment([at, at + arrow], stroke);
        }
    }
}
