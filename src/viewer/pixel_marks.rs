//! Marks over the picture: the clicked pixel, and the way of the rays to a node of its tree.

use eframe::egui::{Color32, Painter, Pos2, Rect, Stroke, vec2};
use glam::DVec3;

use crate::forest::camera::View;
use crate::session::inspect::PixelTree;

/// Seen on light and on dark ground: a dark line under a light one.
const OUTER: Stroke = Stroke { width: 3.0, color: Color32::from_black_alpha(170) };
const INNER: Stroke = Stroke { width: 1.2, color: Color32::WHITE };

/// Four short lines around a pixel, which stays visible.
pub(super) fn cross(painter: &Painter, pixel: Rect) {
    let center = pixel.center();
    let near = pixel.width().max(6.0) * 0.5 + 3.0;
    for stroke in [OUTER, INNER] {
        for way in [vec2(1.0, 0.0), vec2(-1.0, 0.0), vec2(0.0, 1.0), vec2(0.0, -1.0)] {
            painter.line_segment([center + way * near, center + way * (near + 7.0)], stroke);
        }
    }
}

/// The way of the rays through `points` in world space, with a ring where the last one lies; it begins
/// at the pixel. What is not in front of the eye cannot be shown, and ends it.
pub(super) fn way(
    painter: &Painter,
    tree: &PixelTree,
    points: &[DVec3],
    on_screen: impl Fn(f32, f32) -> Pos2,
    pixel: Pos2,
) {
    let view = View::new(&tree.scene.camera, tree.scene.picture.size);
    let seen = points.iter().skip(1).map_while(|&point| view.project(point));
    let mut spots = vec![pixel];
    spots.extend(seen.map(|seen| on_screen(seen.at[0] as f32, seen.at[1] as f32)));
    for stroke in [OUTER, INNER] {
        for pair in spots.windows(2) {
            painter.line_segment([pair[0], pair[1]], stroke);
        }
    }
    let whole = spots.len() == points.len().max(1);
    if let Some(&last) = spots.last().filter(|_| whole) {
        for stroke in [OUTER, INNER] {
            painter.circle_stroke(last, 9.0, stroke);
        }
    }
}
