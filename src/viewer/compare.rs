//! Before and after: a wipe between the picture and another one, or the other one while Space is held.

use std::sync::Arc;

use eframe::egui::{
    Color32, Context, CursorIcon, FontId, Id, Key, Pos2, Rect, Role, Sense, Stroke, Ui, Vec2,
    WidgetInfo, pos2, vec2,
};

use super::app::App;
use super::picture::Beside;
use super::slider::has_keyboard;
use crate::film::Frame;
use crate::scene::Scene;
use crate::session::live::{Glance, Shown, Stage};

/// What the picture is compared with.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) enum Reference {
    /// The scene as it was opened or last saved.
    #[default]
    Saved,
    /// The scene in a look, or in none: edits of the scene are seen in it too.
    Look(Option<String>),
    /// The snapshot of this name.
    Snapshot(String),
}

impl Reference {
    fn name(&self) -> String {
        match self {
            Reference::Saved => "as saved".into(),
            Reference::Look(None) => "no look".into(),
            Reference::Look(Some(name)) => format!("look {name}"),
            Reference::Snapshot(name) => name.clone(),
        }
    }
}

/// The comparison, as it is set and as it shows.
pub(super) struct Compare {
    /// Whether there is a wipe.
    pub(super) wipe: bool,
    pub(super) reference: Reference,
    /// Where the wipe stands, as a share of the picture's width.
    share: f32,
    /// Whether Space is held.
    held: bool,
    /// The whole picture of the saved scene, since it was shown.
    saved: Option<(Arc<Scene>, Arc<Frame>)>,
    /// Whether the other picture needs rays, so that it cannot be shown.
    needs_rays: bool,
    /// What is on the graphics card.
    pub(super) painted: Option<Arc<Frame>>,
    /// What the session was told last to look at.
    wanted: Vec<Glance>,
}

impl Default for Compare {
    fn default() -> Compare {
        Compare {
            wipe: false,
            reference: Reference::Saved,
            share: 0.5,
            held: false,
            saved: None,
            needs_rays: false,
            painted: None,
            wanted: Vec::new(),
        }
    }
}

impl Compare {
    /// Begins a wipe.
    pub(super) fn with(&mut self, reference: Reference) {
        (self.reference, self.wipe) = (reference, true);
    }

    /// Forgets what belongs to a scene that is no longer open.
    pub(super) fn forget(&mut self) {
        *self = Compare {
            share: self.share,
            wanted: std::mem::take(&mut self.wanted),
            ..Compare::default()
        };
    }

    fn is_active(&self) -> bool {
        self.wipe || self.held
    }

    /// Whether it shows a look, which follows edits.
    pub(super) fn needs_looks(&self) -> bool {
        self.is_active() && matches!(self.reference, Reference::Look(_))
    }

    /// Notes the saved scene's picture when it is shown.
    pub(super) fn note(&mut self, shown: &Shown, saved: &Arc<Scene>) {
        let is_known = |(scene, _): &(Arc<Scene>, _)| Arc::ptr_eq(scene, saved);
        if let Some(frame) = shown.frame.as_ref().filter(|_| shown.stage == Stage::Whole)
            && !self.saved.as_ref().is_some_and(is_known)
            && shown.scene == *saved
        {
            self.saved = Some((saved.clone(), frame.clone()));
        }
    }
}

impl App {
    /// What the comparison needs of the session, and the thumbnails of the strip.
    pub(super) fn watch_glances(&mut self) {
        let mut wanted = Vec::new();
        if self.compare.is_active() && self.known_frame().is_none() {
            wanted.extend(self.reference_scene().map(|scene| Glance { scene, smaller: 1 }));
        }
        wanted.extend(self.strip.glances());
        let same =
            |(a, b): (&Glance, &Glance)| Arc::ptr_eq(&a.scene, &b.scene) && a.smaller == b.smaller;
        let old = &self.compare.wanted;
        if wanted.len() != old.len() || !wanted.iter().zip(old).all(same) {
            self.live.glance(wanted.clone());
            self.compare.wanted = wanted;
        }
    }

    fn reference_scene(&self) -> Option<Arc<Scene>> {
        match &self.compare.reference {
            Reference::Saved => Some(self.document.shared_saved_scene()),
            Reference::Look(name) => self.strip.scene_of(name),
            Reference::Snapshot(name) => {
                let found = self.strip.snapshots.iter().find(|s| s.name == *name);
                found.map(|snapshot| snapshot.scene.clone())
            }
        }
    }

    /// The other picture, if it was shown before.
    fn known_frame(&self) -> Option<Arc<Frame>> {
        match &self.compare.reference {
            Reference::Saved => {
                let saved = self.document.shared_saved_scene();
                let (scene, frame) = self.compare.saved.as_ref()?;
                Arc::ptr_eq(scene, &saved).then(|| frame.clone())
            }
            Reference::Look(_) => None,
            Reference::Snapshot(name) => {
                let found = self.strip.snapshots.iter().find(|s| s.name == *name);
                found.and_then(|snapshot| snapshot.frame.clone())
            }
        }
    }

    /// Before the picture is painted: how much of the other one is seen, and which it is.
    pub(super) fn prepare_comparison(&mut self, ui: &Ui) {
        self.compare.held = is_space_held(ui.ctx());
        if !self.compare.is_active() {
            self.picture.beside = Beside::Nothing;
            return;
        }
        let glimpsed = || {
            let glance = Glance { scene: self.reference_scene()?, smaller: 1 };
            let glimpses = self.live.glimpses();
            glimpses.iter().find(|glimpse| glimpse.is_of(&glance)).map(|g| g.frame.clone())
        };
        let other = match self.known_frame() {
            Some(frame) => Some(Some(frame)),
            None => glimpsed(),
        };
        self.compare.needs_rays = matches!(other, Some(None));
        match other {
            Some(Some(frame)) => {
                let painted = self.compare.painted.as_ref();
                if !painted.is_some_and(|painted| Arc::ptr_eq(painted, &frame)) {
                    self.picture.set_other(ui, &frame);
                    self.compare.painted = Some(frame);
                }
                self.picture.beside = match self.compare.held {
                    true => Beside::Whole,
                    false => Beside::Left(self.compare.share),
                };
            }
            // While it is made, the one before it stays; what needs rays is not shown.
            None => {}
            Some(None) => (self.picture.beside, self.compare.painted) = (Beside::Nothing, None),
        }
    }

    /// The line of the wipe and the names of both sides, over the picture at `place`.
    pub(super) fn comparison_ui(&mut self, ui: &mut Ui, place: Rect, view: Rect) {
        if !self.compare.is_active() {
            return;
        }
        let name = self.compare.reference.name();
        let seen = place.intersect(view);
        let text = match (self.compare.needs_rays, self.compare.held) {
            (true, _) => {
                format!("{name}: needs rays from here; a snapshot can be compared with")
            }
            (_, true) => format!("before: {name}"),
            (_, false) => format!("{name} | now"),
        };
        let split = place.left() + place.width() * self.compare.share;
        tag_ui(ui, pos2(seen.left() + 8.0, seen.top() + 8.0), &text);
        if self.compare.held || self.picture.beside == Beside::Nothing {
            return;
        }
        let x = split.clamp(seen.left(), seen.right());
        let line = Rect::from_min_max(pos2(x - 6.0, seen.top()), pos2(x + 6.0, seen.bottom()));
        let response = ui.interact(line, Id::unique("wipe"), Sense::drag());
        response.widget_info(|| WidgetInfo::labeled(Role::Splitter, true, "wipe"));
        if let Some(at) = response.interact_pointer_pos().filter(|_| response.dragged()) {
            self.compare.share = ((at.x - place.left()) / place.width()).clamp(0.0, 1.0);
        }
        let painter = ui.painter_at(view);
        painter.line_segment(
            [line.center_top(), line.center_bottom()],
            Stroke::new(3.0, Color32::BLACK),
        );
        painter.line_segment(
            [line.center_top(), line.center_bottom()],
            Stroke::new(1.0, Color32::WHITE),
        );
        let (radius, fill) = match (response.dragged(), response.hovered()) {
            (true, _) => (8.0, Color32::from_rgb(0x6a, 0xb0, 0xf0)),
            (false, true) => (8.0, Color32::WHITE),
            (false, false) => (6.0, Color32::WHITE),
        };
        painter.circle(line.center(), radius, fill, Stroke::new(1.5, Color32::BLACK));
        response.on_hover_and_drag_cursor(CursorIcon::ResizeHorizontal);
    }
}

/// Whether Space is held, and not for a widget.
fn is_space_held(ctx: &Context) -> bool {
    let free = !ctx.egui_wants_keyboard_input() || has_keyboard(ctx);
    free && ctx.input(|i| i.key_down(Key::Space))
}

/// Light text on dark ground, which reads over every picture.
fn tag_ui(ui: &mut Ui, at: Pos2, text: &str) {
    let font = FontId::proportional(13.0);
    let galley = ui.painter().layout_no_wrap(text.to_owned(), font, Color32::WHITE);
    let rect = Rect::from_min_size(at, galley.size() + vec2(12.0, 6.0));
    ui.painter().rect_filled(rect, 4.0, Color32::from_black_alpha(200));
    ui.painter().galley(at + Vec2::new(6.0, 3.0), galley, Color32::WHITE);
    let response = ui.interact(rect, Id::unique("comparison"), Sense::hover());
    let text = text.to_owned();
    response.widget_info(|| WidgetInfo::labeled(Role::Label, true, &text));
}
