//! The strip below the picture: the scene's looks and the snapshots, with thumbnails, to be switched between.

use std::sync::Arc;

use eframe::egui::text::{LayoutJob, TextWrapping};
use eframe::egui::{
    Align2, Color32, FontId, Key, Label, Painter, Pos2, Rect, Response, RichText, Role, ScrollArea,
    Sense, Stroke, StrokeKind, TextEdit, TextureHandle, TextureOptions, Ui, Vec2, WidgetInfo, pos2,
    vec2,
};

use super::app::App;
use super::badge::class_text;
use super::command::Command;
use super::compare::Reference;
use super::picture::whole_image;
use crate::document::arrangement::Part;
use crate::document::looks::{added, free_name, removed};
use crate::film::Frame;
use crate::film::sheet::reduced;
use crate::scene::Scene;
use crate::session::Class;
use crate::session::live::{Glance, Glimpse, Shown, Stage};

/// Largest thumbnail, in pixels.
const THUMB: [u32; 2] = [128, 72];
/// Height of the strip in points: a card and what is around it.
pub(super) const STRIP: f32 = 112.0;
/// Largest number of snapshots: each holds a picture.
const MOST_SNAPSHOTS: usize = 24;

/// Looks and snapshots as the window shows them.
#[derive(Default)]
pub(super) struct Strip {
    /// Whether it shows.
    pub(super) open: bool,
    /// The scene that `looks` were made of.
    of: Option<Arc<Scene>>,
    looks: Vec<LookCard>,
    pub(super) snapshots: Vec<Snapshot>,
    /// How many were taken.
    taken: usize,
    renaming: Option<Renaming>,
}

/// A look, or none, and the scene that wears it.
struct LookCard {
    name: Option<String>,
    scene: Arc<Scene>,
    thumb: Option<Thumb>,
    class: Option<Class>,
}

/// A picture and the settings that gave it.
pub(super) struct Snapshot {
    pub(super) name: String,
    pub(super) scene: Arc<Scene>,
    /// The whole picture of the scene, once the processor has drawn it.
    pub(super) frame: Option<Arc<Frame>>,
    thumb: Option<TextureHandle>,
}

/// A thumbnail on the graphics card, and what it was made of.
struct Thumb {
    frame: Arc<Frame>,
    texture: TextureHandle,
}

/// A look's name being changed.
struct Renaming {
    from: String,
    text: String,
    focused: bool,
    /// Whether Enter was pressed with a name that does not do.
    is_refused: bool,
}

/// What the person did in the strip.
#[derive(Debug, Default, PartialEq)]
pub(super) struct StripOutcome {
    wear: Option<Option<String>>,
    add: bool,
    remove: Option<String>,
    rename: Option<(String, String)>,
    restore: Option<usize>,
    forget: Option<usize>,
    snapshot: bool,
    compare: Option<Reference>,
}

impl Strip {
    /// Forgets what belongs to a scene that is no longer open.
    pub(super) fn forget(&mut self) {
        *self = Strip { open: self.open, ..Strip::default() };
    }

    /// Dresses the scene in every look; scenes that stay the same stay where they are, and so does
    /// what is known of them.
    pub(super) fn follow(&mut self, scene: &Arc<Scene>) {
        if self.of.as_ref().is_some_and(|of| Arc::ptr_eq(of, scene)) {
            return;
        }
        self.of = Some(scene.clone());
        let mut old = std::mem::take(&mut self.looks);
        let names = scene.looks.list.iter().map(|look| Some(look.name.clone()));
        for name in std::iter::once(None).chain(names) {
            // What makes no sense now is told when it is put on.
            let Ok(dressed) = scene.dressed(name.as_deref()) else { continue };
            let known = old.iter().position(|card| card.name == name);
            let known = known.map(|known| old.swap_remove(known));
            let card = match known {
                Some(card) if *card.scene == dressed => card,
                card => LookCard {
                    name,
                    scene: Arc::new(dressed),
                    thumb: card.and_then(|card| card.thumb),
                    class: None,
                },
            };
            self.looks.push(card);
        }
    }

    /// The scene in a look.
    pub(super) fn scene_of(&self, name: &Option<String>) -> Option<Arc<Scene>> {
        self.looks.iter().find(|card| card.name == *name).map(|card| card.scene.clone())
    }

    /// The thumbnails that are wanted.
    pub(super) fn glances(&self) -> Vec<Glance> {
        let glance = |card: &LookCard| Glance {
            scene: card.scene.clone(),
            smaller: smaller(card.scene.picture.size),
        };
        if self.open { self.looks.iter().map(glance).collect() } else { Vec::new() }
    }

    /// Takes over what the session knows of the looks.
    fn take_glimpses(&mut self, ui: &Ui, glimpses: &[Glimpse]) {
        for card in &mut self.looks {
            let wanted =
                Glance { scene: card.scene.clone(), smaller: smaller(card.scene.picture.size) };
            let Some(glimpse) = glimpses.iter().find(|glimpse| glimpse.is_of(&wanted)) else {
                continue;
            };
            card.class = Some(glimpse.class);
            let Some(frame) = &glimpse.frame else {
                // The one before shows other solids, perhaps.
                card.thumb = None;
                continue;
            };
            if card.thumb.as_ref().is_none_or(|thumb| !Arc::ptr_eq(&thumb.frame, frame)) {
                let name = format!("look {:?}", card.name);
                let texture = texture(ui, &name, frame);
                card.thumb = Some(Thumb { frame: frame.clone(), texture });
            }
        }
    }

    /// Shows the cards.
    fn ui(&mut self, ui: &mut Ui, scene: &Scene, reference: &Reference) -> StripOutcome {
        let mut outcome = StripOutcome::default();
        ScrollArea::horizontal().auto_shrink([false, true]).show(ui, |ui| {
            ui.horizontal_top(|ui| {
                self.looks_ui(ui, scene, reference, &mut outcome);
                ui.separator();
                self.snapshots_ui(ui, reference, &mut outcome);
            });
        });
        outcome
    }

    fn looks_ui(
        &mut self,
        ui: &mut Ui,
        scene: &Scene,
        reference: &Reference,
        outcome: &mut StripOutcome,
    ) {
        for card in &self.looks {
            if let Some(name) = &card.name
                && let Some(field) = self.renaming.as_mut().filter(|field| field.from == *name)
            {
                if let Some(left) = ui.vertical(|ui| field.ui(ui, scene)).inner {
                    outcome.rename = left.map(|to| (name.clone(), to));
                    self.renaming = None;
                }
                continue;
            }
            let label =
                card.name.as_ref().map_or("no look".to_owned(), |name| format!("look {name}"));
            let this = Reference::Look(card.name.clone());
            let (class, color) = class_text(card.class, ui.visuals().dark_mode);
            let face = Face {
                label: &label,
                texture: card.thumb.as_ref().map(|thumb| &thumb.texture),
                below: card.name.as_deref().unwrap_or("No look"),
                is_on: scene.looks.worn() == card.name.as_deref(),
                is_dear: card.class.is_some_and(|class| class >= Class::Refold),
                is_compared: *reference == this,
                badge: Some((class, color)),
            };
            let about = match card.name {
                Some(_) => "Puts this look on. A right click offers more",
                None => "Takes the look off. A right click offers more",
            };
            let response = face.ui(ui).on_hover_text(about);
            if response.clicked() {
                outcome.wear = Some(card.name.clone());
            }
            let renaming = &mut self.renaming;
            response.context_menu(|ui| {
                if item(ui, &format!("Compare with {label}"), "A wipe between the two") {
                    outcome.compare = Some(this);
                }
                let Some(name) = &card.name else { return };
                if item(ui, &format!("Rename {label}"), "Changes its name in the scene file") {
                    *renaming = Some(Renaming::of(name));
                }
                if item(ui, &format!("Delete {label}"), "Takes the look out of the scene") {
                    outcome.remove = Some(name.clone());
                }
            });
        }
        let about = "Adds a look: what you then change of materials and lights belongs to it";
        if ui.button("+ Look").on_hover_text(about).clicked() {
            outcome.add = true;
        }
    }

    fn snapshots_ui(&mut self, ui: &mut Ui, reference: &Reference, outcome: &mut StripOutcome) {
        for (i, snapshot) in self.snapshots.iter_mut().enumerate() {
            let this = Reference::Snapshot(snapshot.name.clone());
            if let (None, Some(frame)) = (&snapshot.thumb, &snapshot.frame) {
                let small = reduced(frame, smaller(frame.size));
                snapshot.thumb = Some(texture(ui, &snapshot.name, &small));
            }
            let face = Face {
                label: &snapshot.name,
                texture: snapshot.thumb.as_ref(),
                below: &snapshot.name,
                is_on: false,
                is_dear: false,
                is_compared: *reference == this,
                badge: None,
            };
            let about = "Brings these settings back, as one step. A right click offers more";
            let response = face.ui(ui).on_hover_text(about);
            if response.clicked() {
                outcome.restore = Some(i);
            }
            response.context_menu(|ui| {
                let name = &snapshot.name;
                if item(ui, &format!("Compare with {name}"), "A wipe between the two") {
                    outcome.compare = Some(this);
                }
                if item(ui, &format!("Forget {name}"), "Takes it out of the strip") {
                    outcome.forget = Some(i);
                }
            });
        }
        if ui.button("+ Snapshot").on_hover_text(Command::Snapshot.about()).clicked() {
            outcome.snapshot = true;
        }
    }
}

/// How much smaller the thumbnail of a picture is.
fn smaller(size: [u32; 2]) -> u32 {
    size[0].div_ceil(THUMB[0]).max(size[1].div_ceil(THUMB[1])).max(1)
}

fn texture(ui: &Ui, name: &str, frame: &Frame) -> TextureHandle {
    ui.ctx().load_texture(name, whole_image(frame), TextureOptions::LINEAR)
}

fn item(ui: &mut Ui, name: &str, about: &str) -> bool {
    let clicked = ui.button(name).on_hover_text(about).clicked();
    if clicked {
        ui.close();
    }
    clicked
}

/// What a card shows.
struct Face<'a> {
    /// Its accessible name.
    label: &'a str,
    texture: Option<&'a TextureHandle>,
    below: &'a str,
    is_on: bool,
    /// Whether there is no thumbnail because it needs rays.
    is_dear: bool,
    is_compared: bool,
    badge: Option<(&'a str, Color32)>,
}

impl Face<'_> {
    fn ui(&self, ui: &mut Ui) -> Response {
        let picture = vec2(THUMB[0] as f32, THUMB[1] as f32);
        let line = ui.text_style_height(&eframe::egui::TextStyle::Body) + 2.0;
        let (rect, response) =
            ui.allocate_exact_size(picture + vec2(8.0, 8.0 + line), Sense::click());
        let (label, is_on) = (self.label.to_owned(), self.is_on);
        response.widget_info(|| WidgetInfo::selected(Role::Button, true, is_on, &label));
        let visuals = ui.style().interact_selectable(&response, self.is_on);
        let painter = ui.painter_at(rect);
        painter.rect(rect, 4.0, visuals.weak_bg_fill, visuals.bg_stroke, StrokeKind::Inside);
        let space = Rect::from_min_size(rect.min + Vec2::splat(4.0), picture);
        painter.rect_filled(space, 0.0, Color32::from_gray(40));
        if let Some(texture) = self.texture {
            let size = texture.size_vec2();
            let scale = (picture / size).min_elem();
            let place = Rect::from_center_size(space.center(), size * scale);
            let whole = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
            painter.image(texture.id(), place, whole, Color32::WHITE);
        } else if self.is_dear {
            let light = Color32::from_gray(200);
            let font = FontId::proportional(11.0);
            painter.text(space.center(), Align2::CENTER_CENTER, "shown when put on", font, light);
        }
        if self.is_compared {
            let stroke = Stroke::new(2.0, ui.visuals().selection.bg_fill);
            painter.rect_stroke(space, 0.0, stroke, StrokeKind::Inside);
        }
        let middle = space.bottom() + line / 2.0 + 1.0;
        let mut right = space.right();
        if let Some((text, color)) = self.badge {
            let at = pos2(right, middle);
            let weak = match self.is_on {
                true => visuals.text_color(),
                false => ui.visuals().weak_text_color(),
            };
            let drawn =
                painter.text(at, Align2::RIGHT_CENTER, text, FontId::proportional(11.0), weak);
            painter.circle_filled(pos2(drawn.left() - 6.0, middle), 3.0, color);
            right = drawn.left() - 12.0;
            let cost = ui.interact(drawn, response.id.with("cost"), Sense::hover());
            let label = format!("cost of {}: {text}", self.label);
            cost.widget_info(|| WidgetInfo::labeled(Role::Label, true, &label));
        }
        let room = right - space.left();
        caption(&painter, self.below, pos2(space.left(), middle), room, visuals.text_color());
        response
    }
}

/// Writes what a card is called from `left` on, in no more than `room`: the rest is an ellipsis.
pub(super) fn caption(painter: &Painter, text: &str, left: Pos2, room: f32, color: Color32) {
    let mut job = LayoutJob::simple_singleline(text.to_owned(), FontId::proportional(12.0), color);
    job.wrap = TextWrapping::truncate_at_width(room);
    let galley = painter.layout_job(job);
    let corner = left - vec2(0.0, galley.size().y / 2.0);
    painter.galley(corner, galley, color);
}

impl Renaming {
    fn of(name: &str) -> Renaming {
        let (from, text) = (name.to_owned(), name.to_owned());
        Renaming { from, text, focused: false, is_refused: false }
    }

    /// Shows the field; when it is left, the name, or `None` after Escape. Enter with a name that does
    /// not do leaves it open and says why below it.
    fn ui(&mut self, ui: &mut Ui, scene: &Scene) -> Option<Option<String>> {
        let field = TextEdit::singleline(&mut self.text).desired_width(THUMB[0] as f32);
        let response = ui.add(field).accessible_name(format!("name of look {}", self.from));
        let response = response.on_hover_text("Enter takes the name, Escape keeps the old one");
        if !std::mem::replace(&mut self.focused, true) {
            response.request_focus();
            return None;
        }
        let name = self.text.trim().to_owned();
        let refusal = refusal(scene, &self.from, &name);
        let pressed = |key| ui.input(|input| input.key_pressed(key));
        let (escaped, entered) = (pressed(Key::Escape), pressed(Key::Enter));
        if response.lost_focus() && entered && refusal.is_some() {
            response.request_focus();
            self.is_refused = true;
        } else if response.lost_focus() {
            return Some(Some(name).filter(|name| !escaped && !name.is_empty()));
        }
        if let Some(refusal) = refusal.filter(|_| self.is_refused) {
            ui.set_max_width(THUMB[0] as f32);
            let refusal = RichText::new(refusal).color(ui.visuals().error_fg_color);
            ui.add(Label::new(refusal).wrap());
        }
        None
    }
}

/// What is wrong with another name for a look, if anything.
fn refusal(scene: &Scene, from: &str, to: &str) -> Option<String> {
    if to.is_empty() {
        return Some("a look needs a name".to_owned());
    }
    let is_taken = to != from && scene.looks.find(to).is_some();
    is_taken.then(|| format!("there is a look `{to}` already: choose another name"))
}

impl App {
    /// The strip, if it is open.
    pub(super) fn strip_ui(&mut self, ui: &mut Ui) -> StripOutcome {
        let scene = self.document.shared_scene();
        if self.strip.open || self.compare.needs_looks() {
            self.strip.follow(&scene);
        }
        if !self.strip.open {
            return StripOutcome::default();
        }
        self.strip.take_glimpses(ui, &self.live.glimpses());
        let panel = self.panels.panel(ui, Part::Looks);
        let reference = &self.compare.reference;
        panel.show(ui, |ui| self.strip.ui(ui, &scene, reference)).inner
    }

    /// Does what was chosen in the strip; each edit is a step of its own.
    pub(super) fn apply_strip(&mut self, outcome: StripOutcome) {
        let scene = self.document.shared_scene();
        let StripOutcome { wear, add, remove, rename, restore, forget, snapshot, compare } =
            outcome;
        if let Some(name) = wear {
            match scene.dressed(name.as_deref()) {
                Ok(dressed) => self.step(dressed),
                Err(error) => self.notices.error(error),
            }
        }
        if add {
            match added(&scene, &free_name(&scene)) {
                Ok(scene) => self.step(scene),
                Err(error) => self.notices.error(error),
            }
        }
        if let Some(name) = remove {
            self.step(removed(&scene, &name));
        }
        if let Some((from, to)) = rename.filter(|(from, to)| from != to) {
            self.rename_look(&scene, &from, &to);
        }
        if let Some(snapshot) = restore.and_then(|i| self.strip.snapshots.get(i)) {
            let (scene, name) = ((*snapshot.scene).clone(), snapshot.name.clone());
            self.document.end_gesture();
            self.commit(scene);
            self.document.name_step(name);
            self.document.end_gesture();
        }
        if let Some(i) = forget.filter(|i| *i < self.strip.snapshots.len()) {
            self.strip.snapshots.remove(i);
        }
        if snapshot {
            self.take_snapshot();
        }
        if let Some(reference) = compare {
            self.compare.with(reference);
        }
    }

    fn rename_look(&mut self, scene: &Scene, from: &str, to: &str) {
        if let Some(refusal) = refusal(scene, from, to) {
            return self.notices.error(refusal);
        }
        let mut edited = scene.clone();
        edited.looks.rename(from, to);
        self.step(edited);
    }

    /// Gives snapshots their picture that were taken before the processor had drawn it.
    pub(super) fn complete_snapshots(&mut self, shown: &Shown) {
        let lacking = self.strip.snapshots.iter_mut().filter(|snapshot| snapshot.frame.is_none());
        for snapshot in lacking.filter(|snapshot| Arc::ptr_eq(&snapshot.scene, &shown.scene)) {
            snapshot.frame = shown.frame.clone();
        }
    }

    /// Keeps the picture shown and its settings.
    pub(super) fn take_snapshot(&mut self) {
        let Some(shown) = self.shown.as_ref().filter(|shown| shown.stage == Stage::Whole) else {
            self.notices.say("a snapshot is taken when the picture is whole".into());
            return;
        };
        let strip = &mut self.strip;
        strip.taken += 1;
        let name = format!("snapshot {}", strip.taken);
        self.notices.say(format!("took {name}"));
        let (scene, frame) = (shown.scene.clone(), shown.frame.clone());
        strip.snapshots.push(Snapshot { name, scene, frame, thumb: None });
        if strip.snapshots.len() > MOST_SNAPSHOTS {
            strip.snapshots.remove(0);
        }
        strip.open = true;
    }
}
