//! A preset that is carried over the picture: the solid under the pointer is outlined, and made of it
//! where the preset is dropped.

use std::sync::{Arc, Mutex, PoisonError};

use eframe::egui::{
    Align2, Color32, Context, DragAndDrop, FontId, Painter, Pos2, Rect, Stroke, Ui, pos2, vec2,
};

use super::app::App;
use super::inspector::Selection;
use super::presets::Carried;
use crate::document::presets::provide;
use crate::scene::Scene;
use crate::session::live::Eye;

/// Most points that are looked at along a side of the picture to find an outline.
const MOST_POINTS: f64 = 240.0;

/// An outline: lines in pixels of the picture.
type Lines = Vec<[Pos2; 2]>;

/// The outline of the solid under the pointer, once a thread has found it.
#[derive(Default)]
pub(super) struct Outlined {
    solid: Option<usize>,
    lines: Arc<Mutex<Option<Lines>>>,
}

impl Outlined {
    /// Sees to it that the outline of a solid is found; `None` forgets it.
    fn follow(&mut self, ctx: &Context, eye: &Eye, solid: Option<usize>) {
        if self.solid == solid {
            return;
        }
        *self = Outlined { solid, ..Outlined::default() };
        let Some(solid) = solid else { return };
        let (eye, lines, ctx) = (eye.clone(), self.lines.clone(), ctx.clone());
        // Nobody waits for it: where the system gives no thread there is no outline.
        let thread = std::thread::Builder::new().name("outline".into());
        drop(thread.spawn(move || {
            let found = found(&eye, solid);
            *lines.lock().unwrap_or_else(PoisonError::into_inner) = Some(found);
            ctx.request_repaint();
        }));
    }

    fn paint(&self, painter: &Painter, place: Rect, size: [u32; 2]) {
        let lines = self.lines.lock().unwrap_or_else(PoisonError::into_inner);
        let scale = place.size() / vec2(size[0] as f32, size[1] as f32);
        let on_screen = |at: Pos2| place.min + at.to_vec2() * scale;
        for (width, color) in [(4.0, Color32::from_black_alpha(140)), (1.5, Color32::WHITE)] {
            for line in lines.iter().flatten() {
                painter.line_segment(line.map(on_screen), Stroke::new(width, color));
            }
        }
    }
}

/// The outline of what is seen of a solid.
fn found(eye: &Eye, solid: usize) -> Lines {
    let [width, height] = eye.size().map(f64::from);
    let step = (width.max(height) / MOST_POINTS).max(1.0);
    let count = [width, height].map(|side| (side / step).ceil() as i32);
    let at = |i: i32| (f64::from(i) + 0.5) * step;
    let is_seen =
        |x: i32, y: i32| eye.pick([at(x), at(y)]).is_some_and(|picked| picked.solid == solid);
    let row = |y: i32| -> Vec<bool> { (0..count[0]).map(|x| is_seen(x, y)).collect() };
    let mask: Vec<Vec<bool>> = (0..count[1]).map(row).collect();
    let to_pixels = |at: Pos2| pos2((at.x + 0.5) * step as f32, (at.y + 0.5) * step as f32);
    contour(&mask).into_iter().map(|line| line.map(to_pixels)).collect()
}

/// The lines between what is in a mask and what is not, in its own units: marching squares.
fn contour(mask: &[Vec<bool>]) -> Lines {
    let (width, height) = (mask.first().map_or(0, Vec::len) as i32, mask.len() as i32);
    let is_in = |x: i32, y: i32| {
        let row = usize::try_from(y).ok().and_then(|y| mask.get(y));
        let cell = row.and_then(|row| usize::try_from(x).ok().and_then(|x| row.get(x)));
        cell.copied().unwrap_or(false)
    };
    let mut lines = Lines::new();
    for y in -1..height {
        for x in -1..width {
            let corners = [is_in(x, y), is_in(x + 1, y), is_in(x + 1, y + 1), is_in(x, y + 1)];
            let (left, top) = (x as f32, y as f32);
            let middles = [
                pos2(left + 0.5, top),
                pos2(left + 1.0, top + 0.5),
                pos2(left + 0.5, top + 1.0),
                pos2(left, top + 0.5),
            ];
            let crossed = (0..4).filter(|i| corners[*i] != corners[(i + 1) % 4]);
            let crossed: Vec<Pos2> = crossed.map(|i| middles[i]).collect();
            let (pairs, _) = crossed.as_chunks::<2>();
            lines.extend(pairs);
        }
    }
    lines
}

impl App {
    /// Shows where a preset would be dropped; whether one was, so that a solid is made of it.
    pub(super) fn carried_ui(
        &mut self,
        ui: &Ui,
        [place, view]: [Rect; 2],
        edited: &mut Scene,
    ) -> bool {
        let ctx = ui.ctx().clone();
        let Some(Carried(index)) = DragAndDrop::payload::<Carried>(&ctx).map(|held| *held) else {
            self.outlined = Default::default();
            return false;
        };
        let (Some(eye), Some(at)) = (self.live.eye(), ctx.pointer_latest_pos()) else {
            return false;
        };
        let size = eye.size();
        let share = (at - place.min) / place.size();
        let point = [share.x * size[0] as f32, share.y * size[1] as f32].map(f64::from);
        let is_over = view.contains(at);
        let picked = eye.pick(point).filter(|_| is_over);
        // The picture may show an earlier scene, whose solids had other indices.
        let name = picked.and_then(|picked| eye.solid_name(picked.solid));
        let solid = edited.solids.iter().position(|solid| Some(solid.name.as_str()) == name);
        self.outlined.follow(&ctx, &eye, picked.map(|picked| picked.solid));
        let painter = ui.painter_at(view);
        self.outlined.paint(&painter, place, size);
        let Some(preset) = self.presets.list().get(index) else { return false };
        let thumb = Rect::from_min_size(at + vec2(14.0, 14.0), vec2(32.0, 32.0));
        if is_over {
            self.presets.paint(ui, index, thumb);
            let text = match name {
                Some(name) => format!("{name} of {}", preset.name),
                None => "no solid here".to_owned(),
            };
            label(&painter, thumb.right_center() + vec2(6.0, 0.0), &text);
        }
        if !ui.input(|input| input.pointer.any_released()) {
            return false;
        }
        DragAndDrop::clear_payload(&ctx);
        self.outlined = Default::default();
        let Some(solid) = solid else { return false };
        let preset = preset.clone();
        let material = provide(edited, &preset);
        let changed = edited.solids[solid].material != material;
        edited.solids[solid].material = material;
        self.select(Some(Selection::Material(material)));
        self.picked = Some(solid);
        self.step_name = Some(format!("{} of {}", edited.solids[solid].name, preset.name));
        changed
    }
}

fn label(painter: &Painter, at: Pos2, text: &str) {
    let text = painter.layout_no_wrap(text.to_owned(), FontId::proportional(13.0), Color32::WHITE);
    let rect = Align2::LEFT_CENTER.anchor_size(at, text.size());
    painter.rect_filled(rect.expand(4.0), 3.0, Color32::from_black_alpha(190));
    painter.galley(rect.min, text, Color32::WHITE);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_contour_goes_round_what_is_in_a_mask() {
        assert_eq!(contour(&[]), Lines::new());
        let mut mask = vec![vec![false; 4]; 3];
        assert_eq!(contour(&mask), Lines::new());
        mask[1][2] = true;
        let lines = contour(&mask);
        assert_eq!(lines.len(), 4, "a diamond: {lines:?}");
        for [a, b] in &lines {
            assert!(((*a - pos2(2.0, 1.0)).length() - 0.5).abs() < 1e-6, "{a:?} {b:?}");
        }
        let all = vec![vec![true; 4]; 3];
        let around = contour(&all);
        assert_eq!(around.len(), 2 * (4 + 3), "the mask's own edge is an outline");
        let crossed = vec![vec![true, false], vec![false, true]];
        assert_eq!(contour(&crossed).len(), 8, "two diamonds that touch");
    }
}
