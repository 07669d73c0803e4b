//! The region of the picture that is traced first: drawn by a drag, taken away by a double-click.

use eframe::egui::{
    Color32, Painter, PointerButton, Pos2, Rect, Response, Stroke, StrokeKind, Ui, pos2, vec2,
};

use super::app::App;
use crate::film::plates::Region;

/// A drag that covers less than this, in pixels of the picture, draws nothing.
const LEAST: f32 = 4.0;

/// The region, and the tool that draws it.
#[derive(Default)]
pub(super) struct Crop {
    /// Whether the next drag in the picture draws the region.
    pub(super) tool: bool,
    /// What is traced first, in pixels of the picture.
    pub(super) region: Option<Region>,
    /// Where the drag began, in points.
    from: Option<Pos2>,
}

/// The part of a picture of `size` pixels, shown at `place`, between two points of the screen.
fn region_between(a: Pos2, b: Pos2, place: Rect, size: [u32; 2]) -> Option<Region> {
    let [width, height] = size.map(|n| n as f32);
    let pixel = |at: Pos2| (at - place.min) / place.size() * vec2(width, height);
    let (a, b) = (pixel(a), pixel(b));
    let (low, high) = (a.min(b), a.max(b));
    let corner = [low.x.clamp(0.0, width - 1.0).floor(), low.y.clamp(0.0, height - 1.0).floor()];
    let end = [high.x.clamp(0.0, width).ceil(), high.y.clamp(0.0, height).ceil()];
    let side = [end[0] - corner[0], end[1] - corner[1]];
    let is_drawn = side[0] >= LEAST && side[1] >= LEAST;
    is_drawn.then(|| Region { corner: corner.map(|n| n as u32), size: side.map(|n| n as u32) })
}

impl Crop {
    /// Takes the pointer's part of it; whether the region is another one now.
    pub(super) fn follow(
        &mut self,
        ui: &Ui,
        response: &Response,
        place: Rect,
        size: [u32; 2],
    ) -> bool {
        let at = response.interact_pointer_pos();
        if response.double_clicked()
            && let (Some(at), Some(region)) = (at, self.region)
            && on_screen(region, place, size).contains(at)
        {
            self.region = None;
            return true;
        }
        if self.tool && response.drag_started_by(PointerButton::Primary) {
            self.from = ui.input(|i| i.pointer.press_origin());
        }
        let (Some(from), Some(at)) = (self.from, at) else { return false };
        let drawn = region_between(from, at, place, size);
        if !response.drag_stopped() {
            self.region = drawn.or(self.region);
            return false;
        }
        (self.from, self.tool, self.region) = (None, false, drawn);
        true
    }

    /// Outlines the region.
    pub(super) fn paint(&self, painter: &Painter, place: Rect, size: [u32; 2]) {
        let Some(region) = self.region.and_then(|region| region.within(size)) else { return };
        let rect = on_screen(region, place, size);
        // Dark and light: one of them is seen on every picture.
        painter.rect_stroke(
            rect,
            0.0,
            Stroke::new(3.0, Color32::from_black_alpha(160)),
            StrokeKind::Outside,
        );
        painter.rect_stroke(
            rect.expand(1.0),
            0.0,
            Stroke::new(1.0, Color32::WHITE),
            StrokeKind::Outside,
        );
    }
}

/// Where a region lies on the screen, in points.
fn on_screen(Region { corner: [x, y], size: [w, h] }: Region, place: Rect, size: [u32; 2]) -> Rect {
    let whole = vec2(size[0] as f32, size[1] as f32);
    let point =
        |x: u32, y: u32| place.min + pos2(x as f32, y as f32).to_vec2() / whole * place.size();
    Rect::from_min_max(point(x, y), point(x + w, y + h))
}

impl App {
    /// Makes another part of the picture the one that is traced first.
    pub(super) fn set_crop(&mut self, region: Option<Region>) {
        self.picture.crop.region = region;
        self.live.look_first(region);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_drag_in_any_direction_gives_the_pixels_that_it_covers() {
        let place = Rect::from_min_size(pos2(100.0, 50.0), vec2(320.0, 180.0));
        let drawn = |a, b| region_between(a, b, place, [640, 360]);
        let (a, b) = (pos2(110.0, 60.0), pos2(150.2, 70.0));
        let expected = Some(Region { corner: [20, 20], size: [81, 20] });
        assert_eq!((drawn(a, b), drawn(b, a)), (expected, expected));
        assert_eq!(drawn(pos2(150.2, 60.0), pos2(110.0, 70.0)), expected);
        let all = Some(Region { corner: [0, 0], size: [640, 360] });
        assert_eq!(drawn(pos2(-9.0, 0.0), pos2(900.0, 900.0)), all, "cut at the edges");
        assert_eq!(drawn(a, a + vec2(1.0, 30.0)), None, "too narrow to be meant");
        assert_eq!(drawn(pos2(0.0, 0.0), pos2(20.0, 40.0)), None, "beside the picture");
        let Some(region) = expected else { return };
        assert_eq!(on_screen(region, place, [640, 360]).min, a);
    }
}
