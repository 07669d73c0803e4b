//! The picture on the screen: zoom to the pointer, pan, 1:1, clicks that pick, drags that move the camera.

use eframe::egui::{
    Color32, ColorImage, CursorIcon, Painter, PointerButton, Pos2, Rect, Response, Role, Sense,
    TextureHandle, TextureId, TextureOptions, Ui, Vec2, WidgetInfo, pos2, vec2,
};

use super::crop::Crop;
use super::navigate;
use crate::film::Frame;
use crate::scene::Camera;
use crate::shade::gpu::Piece as CardPiece;

/// How large the picture is shown.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Zoom {
    /// As large as the window allows.
    Fit,
    /// This many pixels of the screen per pixel of the picture.
    Scale(f32),
}

/// Least and greatest scale.
const SCALES: std::ops::RangeInclusive<f32> = 0.02..=64.0;
/// Longest side of one texture: every driver takes it, and larger pictures are cut.
const TEXTURE_SIDE: usize = 2048;
/// What a drag across the height of the window turns the camera by, in radians.
const ORBIT_SPEED: f64 = 3.0;

/// One part of the picture on the graphics card.
struct Piece {
    texture: Texture,
    /// In pixels of the frame.
    rect: Rect,
}

/// Where a part of the picture comes from.
enum Texture {
    /// Copied from a frame of the processor's.
    Copied(TextureHandle),
    /// Drawn by the graphics card itself.
    Drawn(TextureId),
}

impl Texture {
    fn id(&self) -> TextureId {
        match self {
            Texture::Copied(handle) => handle.id(),
            Texture::Drawn(id) => *id,
        }
    }
}

/// A picture on the graphics card.
#[derive(Default)]
struct Layer {
    pieces: Vec<Piece>,
    frame_size: [u32; 2],
}

impl Layer {
    /// Takes a frame of a picture of `size` pixels.
    fn set(&mut self, ui: &Ui, name: &str, frame: &Frame, size: [u32; 2]) {
        let sharp = options(frame.size == size);
        if self.frame_size != frame.size {
            self.frame_size = frame.size;
            self.pieces.clear();
        }
        self.pieces.retain(|piece| matches!(piece.texture, Texture::Copied(_)));
        let side = ui.input(|i| i.max_texture_side).min(TEXTURE_SIDE);
        for (i, &rect) in pieces(frame.size, side).iter().enumerate() {
            let image = image(frame, rect);
            match self.pieces.get_mut(i) {
                Some(Piece { texture: Texture::Copied(handle), rect: place }) => {
                    handle.set(image, sharp);
                    *place = bounds(rect);
                }
                _ => {
                    let texture = ui.ctx().load_texture(format!("{name} {i}"), image, sharp);
                    let texture = Texture::Copied(texture);
                    self.pieces.push(Piece { texture, rect: bounds(rect) });
                }
            }
        }
    }

    /// Takes a picture of `size` pixels that the card has drawn.
    fn set_drawn(&mut self, textures: &[(TextureId, CardPiece)], size: [u32; 2]) {
        self.frame_size = size;
        let piece = |&(id, CardPiece { corner, size }): &(TextureId, CardPiece)| {
            let [[left, top], [width, height]] = [corner, size].map(|n| n.map(|n| n as usize));
            let rect = bounds([left, top, left + width, top + height]);
            Piece { texture: Texture::Drawn(id), rect }
        };
        self.pieces = textures.iter().map(piece).collect();
    }

    /// Paints it into `place`.
    fn paint(&self, painter: &Painter, place: Rect) {
        let frame = vec2(self.frame_size[0] as f32, self.frame_size[1] as f32);
        let whole = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
        for piece in &self.pieces {
            let min = place.min + piece.rect.min.to_vec2() / frame * place.size();
            let max = place.min + piece.rect.max.to_vec2() / frame * place.size();
            let rect = Rect::from_min_max(min, max);
            painter.image(piece.texture.id(), rect, whole, Color32::WHITE);
        }
    }
}

/// How much of the other picture is seen.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) enum Beside {
    /// Nothing.
    #[default]
    Nothing,
    /// What is left of this share of the picture's width.
    Left(f32),
    /// All of it.
    Whole,
}

/// The picture and how it is looked at.
pub(super) struct PictureView {
    zoom: Zoom,
    /// The point of the picture in the middle of the view, in pixels of the picture.
    center: Pos2,
    /// `picture.size` of the scene that is shown.
    size: Vec2,
    picture: Layer,
    other: Layer,
    /// How much of the other picture is seen.
    pub(super) beside: Beside,
    /// Whether drags move the camera.
    pub(super) camera_tool: bool,
    /// Whether a click focuses the camera.
    pub(super) focus_tool: bool,
    /// The region that is traced first.
    pub(super) crop: Crop,
}

/// What the person did in the picture.
#[derive(Debug, Default, PartialEq)]
pub(super) struct PictureOutcome {
    /// A click, in pixels of the picture.
    pub(super) clicked: Option<[f64; 2]>,
    /// Whether the camera was moved.
    pub(super) camera_moved: bool,
    /// Whether another region was drawn, or the one before taken away.
    pub(super) cropped: bool,
    /// Where the pointer is, in pixels of the picture.
    pub(super) pointer: Option<[f64; 2]>,
    /// The same, if nothing lies between.
    pub(super) hovered: Option<[f64; 2]>,
}

impl PictureView {
    /// A view without a picture.
    pub(super) fn new() -> PictureView {
        PictureView {
            zoom: Zoom::Fit,
            center: Pos2::ZERO,
            size: Vec2::ZERO,
            picture: Layer::default(),
            other: Layer::default(),
            beside: Beside::Nothing,
            camera_tool: false,
            focus_tool: false,
            crop: Crop::default(),
        }
    }

    /// Takes a new frame of a picture of `size` pixels; a coarse frame has fewer.
    pub(super) fn set_frame(&mut self, ui: &Ui, frame: &Frame, size: [u32; 2]) {
        self.take_size(size);
        self.picture.set(ui, "picture", frame, size);
    }

    /// Takes the picture to compare with.
    pub(super) fn set_other(&mut self, ui: &Ui, frame: &Frame) {
        self.other.set(ui, "other picture", frame, frame.size);
    }

    /// Takes a picture of `size` pixels that the graphics card has drawn.
    pub(super) fn set_card(&mut self, textures: &[(TextureId, CardPiece)], size: [u32; 2]) {
        self.take_size(size);
        self.picture.set_drawn(textures, size);
    }

    /// Lets go of everything on the graphics card.
    pub(super) fn forget_textures(&mut self) {
        self.picture.pieces.clear();
        self.other.pieces.clear();
    }

    fn take_size(&mut self, size: [u32; 2]) {
        let new_size = vec2(size[0] as f32, size[1] as f32);
        if new_size != self.size {
            (self.size, self.zoom, self.center) = (new_size, Zoom::Fit, (new_size / 2.0).to_pos2());
        }
    }

    /// The whole picture.
    pub(super) fn fit(&mut self) {
        self.zoom = Zoom::Fit;
        self.center = (self.size / 2.0).to_pos2();
    }

    /// One pixel of the picture per pixel of the screen.
    pub(super) fn actual_size(&mut self) {
        self.zoom = Zoom::Scale(1.0);
    }

    /// Enlarges by a factor about the middle of the view; `space` is the view's size in points.
    pub(super) fn zoom_by(&mut self, factor: f32, space: Vec2, pixels_per_point: f32) {
        let scale = self.scale(space, pixels_per_point);
        self.zoom = Zoom::Scale((scale * factor).clamp(*SCALES.start(), *SCALES.end()));
    }

    /// Pixels of the screen per pixel of the picture.
    pub(super) fn scale(&self, space: Vec2, pixels_per_point: f32) -> f32 {
        match self.zoom {
            Zoom::Scale(scale) => scale,
            Zoom::Fit if self.size.min_elem() > 0.0 => {
                (space * pixels_per_point / self.size).min_elem()
            }
            Zoom::Fit => 1.0,
        }
    }

    /// Where the picture lies in the space `view`, in points.
    pub(super) fn place(&self, view: Rect, pixels_per_point: f32) -> Rect {
        let scale = self.scale(view.size(), pixels_per_point) / pixels_per_point;
        let corner = view.center() - self.center.to_vec2() * scale;
        // At 1:1 the pixels of the picture lie on those of the screen.
        let snapped = (corner * pixels_per_point).round() / pixels_per_point;
        Rect::from_min_size(snapped, self.size * scale)
    }

    /// Shows the picture in all the space there is.
    pub(super) fn ui(&mut self, ui: &mut Ui, camera: &mut Camera) -> PictureOutcome {
        let view = ui.available_rect_before_wrap();
        let response = ui.allocate_rect(view, Sense::click_and_drag());
        response.widget_info(|| WidgetInfo::labeled(Role::Image, true, "picture"));
        let dots = ui.pixels_per_point();
        let mut outcome = PictureOutcome::default();
        self.wheel(ui, &response, camera, &mut outcome);
        if !self.crop.tool {
            self.drag(ui, &response, camera, &mut outcome);
        }
        let place = self.place(view, dots);
        let pixels = [self.size.x as u32, self.size.y as u32];
        outcome.cropped = self.crop.follow(ui, &response, place, pixels);
        let pixel = |at: Pos2| {
            let point = (at - place.min) / place.size() * self.size;
            place.contains(at).then_some([f64::from(point.x), f64::from(point.y)])
        };
        if response.clicked() {
            outcome.clicked = response.interact_pointer_pos().and_then(pixel);
        }
        outcome.pointer = ui.input(|i| i.pointer.latest_pos()).and_then(pixel);
        outcome.hovered = response.hover_pos().and_then(pixel);
        self.paint(ui, view, place);
        let cursor = match (self.camera_tool, response.dragged()) {
            _ if self.crop.tool => CursorIcon::Crosshair,
            (true, _) => CursorIcon::Move,
            (false, false) if self.focus_tool => CursorIcon::Cell,
            (false, true) => CursorIcon::Grabbing,
            (false, false) => CursorIcon::Crosshair,
        };
        response.on_hover_and_drag_cursor(cursor);
        outcome
    }

    fn paint(&self, ui: &Ui, view: Rect, place: Rect) {
        let painter = ui.painter_at(view);
        painter.rect_filled(view, 0.0, Color32::from_gray(40));
        self.picture.paint(&painter, place);
        match self.beside {
            Beside::Nothing => {}
            Beside::Left(share) => {
                let right = place.left() + place.width() * share;
                let clip = Rect::from_min_max(view.min, pos2(right, view.bottom()));
                self.other.paint(&painter.with_clip_rect(clip.intersect(view)), place);
            }
            Beside::Whole => self.other.paint(&painter, place),
        }
        self.crop.paint(&painter, place, [self.size.x as u32, self.size.y as u32]);
    }

    /// The wheel zooms to the pointer, or moves the camera.
    fn wheel(
        &mut self,
        ui: &Ui,
        response: &Response,
        camera: &mut Camera,
        outcome: &mut PictureOutcome,
    ) {
        let Some(pointer) = response.hover_pos() else { return };
        let (scroll, pinch) = ui.input(|i| (i.smooth_scroll_delta.y, i.zoom_delta()));
        let factor = (scroll / 300.0).exp() * pinch;
        if factor == 1.0 {
            return;
        }
        if self.camera_tool {
            navigate::dolly(camera, f64::from(1.0 / factor));
            outcome.camera_moved = true;
            return;
        }
        let dots = ui.pixels_per_point();
        let scale = self.scale(response.rect.size(), dots);
        let wanted = (scale * factor).clamp(*SCALES.start(), *SCALES.end());
        // The point under the pointer stays where it is.
        let arm = (pointer - response.rect.center()) * dots;
        self.center += arm / scale - arm / wanted;
        self.zoom = Zoom::Scale(wanted);
    }

    /// A drag pans the picture, or moves the camera; the middle button always pans the picture.
    fn drag(
        &mut self,
        ui: &Ui,
        response: &Response,
        camera: &mut Camera,
        outcome: &mut PictureOutcome,
    ) {
        let delta = response.drag_delta();
        if delta == Vec2::ZERO {
            return;
        }
        let primary = response.dragged_by(PointerButton::Primary);
        if primary && self.camera_tool {
            let turn = delta / response.rect.height();
            let (x, y) = (f64::from(turn.x), f64::from(turn.y));
            if ui.input(|i| i.modifiers.shift) {
                navigate::pan(camera, x, y);
            } else {
                navigate::orbit(camera, x * ORBIT_SPEED, y * ORBIT_SPEED);
            }
            outcome.camera_moved = true;
        } else if primary || response.dragged_by(PointerButton::Middle) {
            let dots = ui.pixels_per_point();
            let scale = self.scale(response.rect.size(), dots);
            self.zoom = Zoom::Scale(scale);
            self.center -= delta * dots / scale;
        }
    }
}

/// Enlarged pixels stay sharp squares; a coarse picture is smoothed.
fn options(whole: bool) -> TextureOptions {
    if whole {
        TextureOptions {
            magnification: eframe::egui::TextureFilter::Nearest,
            ..TextureOptions::LINEAR
        }
    } else {
        TextureOptions::LINEAR
    }
}

/// Cuts a frame into rectangles `[left, top, right, bottom]` no longer than `side`.
fn pieces(size: [u32; 2], side: usize) -> Vec<[usize; 4]> {
    let [width, height] = size.map(|n| n as usize);
    let mut cut = Vec::new();
    for top in (0..height).step_by(side) {
        for left in (0..width).step_by(side) {
            let right = (left + side).min(width);
            cut.push([left, top, right, (top + side).min(height)]);
        }
    }
    cut
}

fn bounds([left, top, right, bottom]: [usize; 4]) -> Rect {
    Rect::from_min_max(pos2(left as f32, top as f32), pos2(right as f32, bottom as f32))
}

/// A small frame as egui wants it.
pub(super) fn whole_image(frame: &Frame) -> ColorImage {
    let [width, height] = frame.size.map(|n| n as usize);
    image(frame, [0, 0, width, height])
}

/// One piece of a frame as egui wants it.
fn image(frame: &Frame, [left, top, right, bottom]: [usize; 4]) -> ColorImage {
    let width = frame.size[0] as usize;
    let mut pixels = Vec::with_capacity((right - left) * (bottom - top));
    for y in top..bottom {
        let row = &frame.bytes[(y * width + left) * 4..(y * width + right) * 4];
        let (colors, _) = row.as_chunks::<4>();
        pixels.extend(colors.iter().map(|&[r, g, b, a]| {
            // Alpha is 255: premultiplied and plain are the same.
            Color32::from_rgba_premultiplied(r, g, b, a)
        }));
    }
    ColorImage::new([right - left, bottom - top], pixels)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_large_frame_is_cut_into_pieces_that_cover_it_once() {
        assert_eq!(pieces([2048, 1], 2048), [[0, 0, 2048, 1]]);
        let cut = pieces([5000, 2500], 2048);
        assert_eq!(cut.len(), 6);
        let area: usize = cut.iter().map(|[l, t, r, b]| (r - l) * (b - t)).sum();
        assert_eq!(area, 5000 * 2500);
        assert!(cut.iter().all(|[l, t, r, b]| r - l <= 2048 && b - t <= 2048));
    }

    #[test]
    fn a_piece_holds_the_bytes_of_its_part() {
        let mut frame = Frame::new([3, 2]);
        for (i, byte) in frame.bytes.iter_mut().enumerate() {
            *byte = i as u8;
        }
        let part = image(&frame, [1, 1, 3, 2]);
        assert_eq!(part.size, [2, 1]);
        assert_eq!(part.pixels[0], Color32::from_rgba_premultiplied(16, 17, 18, 19));
    }

    #[test]
    fn fit_shows_all_and_one_to_one_lies_on_whole_pixels() {
        let mut view = PictureView::new();
        (view.size, view.center) = (vec2(640.0, 360.0), pos2(320.0, 180.0));
        let window = Rect::from_min_size(pos2(10.0, 20.0), vec2(333.0, 333.0));
        let place = view.place(window, 1.25);
        assert!(window.expand(0.5).contains_rect(place) && place.width() > 332.0);
        view.actual_size();
        let place = view.place(window, 1.25);
        assert_eq!(place.size(), vec2(512.0, 288.0));
        assert!(((place.min.x * 1.25).fract()).abs() < 1e-4);
    }
}
