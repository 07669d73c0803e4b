//! The panel of one pixel: its colour, its ray tree with every node's share, and bars of where its
//! light comes from.

use std::collections::BTreeMap;
use std::sync::Arc;

use eframe::egui::{
    Align, Button, Color32, DragValue, Grid, Layout, Pos2, Rect, ScrollArea, Sense, Ui, vec2,
};

use super::app::App;
use super::inspector::Selection;
use super::panels::{LINE, filled};
use super::pixel_bars::bars_ui;
use super::pixel_lines::{Line, Target, lines};
use super::pixel_rows::rows_ui;
use crate::document::arrangement::Part;
use crate::film::develop::{Development, code8};
use crate::scene::Scene;
use crate::session::inspect::{Bars, Met, PixelTree, TreeNode, bars, merged};
use crate::session::live::Inspected;

/// What the panel remembers from turn to turn.
#[derive(Default)]
pub(super) struct PixelPanel {
    /// Whether it shows.
    pub(super) open: bool,
    /// The pixel that was clicked.
    pinned: Option<[u32; 2]>,
    /// The pixel under the pointer.
    hovered: Option<[u32; 2]>,
    /// The sample whose tree shows, from 0; `None`: all of them put together.
    sample: Option<usize>,
    /// What was asked of the session.
    asked: Vec<[u32; 2]>,
    /// What shows of the clicked pixel.
    face: Option<Face>,
    /// Index of the line under the pointer.
    line: Option<usize>,
}

/// The clicked pixel, ready to be drawn.
pub(super) struct Face {
    pub(super) tree: Arc<PixelTree>,
    sample: Option<usize>,
    pub(super) lines: Vec<Line>,
    pub(super) bars: Bars,
    /// Brightness of all that shows: shares are parts of it.
    pub(super) whole: f64,
}

impl Face {
    fn new(tree: Arc<PixelTree>, sample: Option<usize>) -> Face {
        let nodes: Vec<TreeNode> = match sample.and_then(|i| tree.samples.get(i)) {
            Some(node) => vec![node.clone()],
            None => merged(tree.samples.iter().cloned()),
        };
        let whole = nodes.iter().map(|node| node.share.luminance()).sum();
        let (lines, bars) = (lines(&tree.scene, &nodes), bars(&nodes));
        Face { tree, sample, lines, bars, whole }
    }

    fn is_of(&self, tree: &Arc<PixelTree>, sample: Option<usize>) -> bool {
        Arc::ptr_eq(&self.tree, tree) && self.sample == sample
    }
}

/// What the person did in the panel.
#[derive(Debug, Default)]
pub(super) struct PixelOutcome {
    /// What a line or bar stands for was clicked.
    pub(super) clicked: Option<Target>,
    close: bool,
}

impl PixelPanel {
    /// Forgets a scene that is no longer open.
    pub(super) fn forget(&mut self) {
        (self.pinned, self.hovered, self.face, self.line) = (None, None, None, None);
    }

    /// Takes what the person points at in a picture of `size` pixels, and what was clicked.
    pub(super) fn look(
        &mut self,
        hovered: Option<[f64; 2]>,
        clicked: Option<[f64; 2]>,
        [width, height]: [u32; 2],
    ) {
        let pixel = |[x, y]: [f64; 2]| [(x as u32).min(width - 1), (y as u32).min(height - 1)];
        self.pinned = self.pinned.filter(|[x, y]| *x < width && *y < height);
        self.hovered = hovered.map(pixel).filter(|_| self.open);
        if let Some(clicked) = clicked.filter(|_| self.open) {
            self.pinned = Some(pixel(clicked));
            self.sample = None;
        }
    }

    /// The pixels that are to be taken apart, if they are others than before.
    fn newly_wanted(&mut self) -> Option<Vec<[u32; 2]>> {
        let mut wanted: Vec<[u32; 2]> = Vec::new();
        if self.open {
            wanted.extend(self.pinned);
            wanted.extend(self.hovered.filter(|hovered| Some(*hovered) != self.pinned));
        }
        (wanted != self.asked).then(|| {
            self.asked.clone_from(&wanted);
            wanted
        })
    }

    /// Makes what is known of the clicked pixel ready to be drawn.
    fn receive(&mut self, known: &BTreeMap<[u32; 2], Inspected>) {
        let pinned = self.pinned.and_then(|pixel| known.get(&pixel));
        match pinned {
            Some(Ok(tree)) => {
                if !self.face.as_ref().is_some_and(|face| face.is_of(tree, self.sample)) {
                    self.face = Some(Face::new(tree.clone(), self.sample));
                }
            }
            // What was known stays until more is known of the same pixel.
            Some(Err(_)) => self.face = None,
            None => self.face = self.face.take().filter(|f| Some(f.tree.pixel) == self.pinned),
        }
        if self.face.is_none() {
            self.line = None;
        }
    }

    fn ui(
        &mut self,
        ui: &mut Ui,
        known: &BTreeMap<[u32; 2], Inspected>,
        (scene, selection): (&Scene, Selection),
    ) -> PixelOutcome {
        self.receive(known);
        let mut outcome = PixelOutcome::default();
        ui.horizontal(|ui| self.head_ui(ui, &mut outcome));
        let size = ui.available_size();
        // In the least width "after 10 bounces" stands beside its number and its bar.
        let [left, right] = [220.0, (size.x * 0.24).clamp(295.0, 460.0)];
        let spaces = 2.0 * (ui.spacing().item_spacing.x * 2.0 + 6.0);
        let middle = (size.x - left - right - spaces).clamp(200.0, 760.0);
        ui.horizontal_top(|ui| {
            column_ui(ui, "pixel values", left, |ui| self.values_ui(ui, known));
            ui.separator();
            let error = self.pinned.and_then(|pixel| known.get(&pixel)?.as_ref().err());
            if let Some(error) = error {
                ui.colored_label(ui.visuals().error_fg_color, error);
            }
            let Some(face) = &self.face else {
                if error.is_none() {
                    ui.weak(match self.pinned {
                        None => "Click a pixel of the picture: its ray tree shows here",
                        Some(_) => "The tree shows as soon as the picture is exact",
                    });
                }
                return;
            };
            ui.allocate_ui_with_layout(vec2(middle, size.y), top_down(), |ui| {
                let rows = rows_ui(ui, face, scene, selection);
                (outcome.clicked, self.line) = (rows.clicked, rows.hovered);
            });
            ui.separator();
            column_ui(ui, "bars", right, |ui| {
                outcome.clicked = outcome.clicked.or(bars_ui(ui, face));
            });
        });
        outcome
    }

    /// Which pixel and sample, and the button that closes the panel.
    fn head_ui(&mut self, ui: &mut Ui, outcome: &mut PixelOutcome) {
        ui.strong("Pixel");
        if let Some([x, y]) = self.pinned {
            ui.label(format!("{x}, {y}"));
        }
        if let Some(face) = &self.face {
            let count = face.tree.samples.len();
            self.sample = self.sample.filter(|i| *i < count);
            let about = "Puts the trees of all samples together: what met the same on the same way \
                         is one line";
            let all = Button::selectable(self.sample.is_none(), "All samples");
            if ui.add(all).on_hover_text(about).clicked() {
                self.sample = None;
            }
            let mut number = self.sample.map_or(1, |i| i + 1);
            let field = DragValue::new(&mut number).range(1..=count).speed(0.05);
            ui.label("sample");
            let response = ui.add(field).accessible_name("sample number");
            let about = format!("Shows the tree of one sample alone: 1 … {count}");
            if response.on_hover_text(about).changed() {
                self.sample = Some(number - 1);
            }
            ui.label(format!("of {count}"));
        }
        let close = |ui: &mut Ui| {
            let button = ui.small_button("Close").on_hover_text("Closes the panel");
            button.accessible_name("Close pixel").clicked()
        };
        outcome.close = ui.with_layout(Layout::right_to_left(Align::Center), close).inner;
    }

    /// The numbers of the pixel under the pointer, or else of the clicked one.
    fn values_ui(&self, ui: &mut Ui, known: &BTreeMap<[u32; 2], Inspected>) {
        let pixel = self.hovered.or(self.pinned);
        let tree = pixel.and_then(|pixel| known.get(&pixel)?.as_ref().ok());
        let tree = tree.or(self.face.as_ref().map(|face| &face.tree));
        match tree {
            Some(tree) => numbers_ui(ui, tree),
            None => {
                ui.weak("Point at a pixel: its numbers show here");
            }
        }
    }

    /// Draws into the picture, which lies at `place` on the screen: the clicked pixel, and the way to
    /// the node of the line under the pointer.
    pub(super) fn mark_ui(&self, ui: &Ui, [place, clip]: [Rect; 2], size: [u32; 2]) {
        let Some([x, y]) = self.pinned.filter(|_| self.open) else { return };
        let painter = ui.painter_at(clip);
        let scale = vec2(place.width() / size[0] as f32, place.height() / size[1] as f32);
        let on_screen = |x: f32, y: f32| -> Pos2 { place.min + vec2(x, y) * scale };
        let pixel = Rect::from_min_max(
            on_screen(x as f32, y as f32),
            on_screen(x as f32 + 1.0, y as f32 + 1.0),
        );
        super::pixel_marks::cross(&painter, pixel);
        let (Some(face), Some(line)) = (&self.face, self.line) else { return };
        let points = face.way_to(line);
        super::pixel_marks::way(&painter, &face.tree, &points, on_screen, pixel.center());
    }
}

fn top_down() -> Layout {
    Layout::top_down(Align::Min)
}

/// A column of a fixed width that scrolls.
fn column_ui(ui: &mut Ui, name: &str, width: f32, body: impl FnOnce(&mut Ui)) {
    let size = vec2(width, ui.available_height());
    ui.allocate_ui_with_layout(size, top_down(), |ui| {
        ui.set_width(width);
        let column = ScrollArea::vertical().id_salt(name).auto_shrink(false);
        column.min_scrolled_height(LINE).show(ui, body);
    });
}

/// A pixel's colour as bytes, as it is shown and written.
fn shown_bytes(tree: &PixelTree) -> [u8; 3] {
    code8(tree.light, Development::of(&tree.scene.picture))
}

fn numbers_ui(ui: &mut Ui, tree: &PixelTree) {
    let PixelTree { pixel: [x, y], scene, light, samples } = tree;
    let [r, g, b] = shown_bytes(tree);
    let mut rows = vec![("pixel", format!("{x}, {y}"))];
    let [lr, lg, lb] = light.0;
    rows.push(("linear", format!("{lr:.4} {lg:.4} {lb:.4}")));
    rows.push(("sRGB", format!("{r} {g} {b}")));
    rows.push(("hex", format!("#{r:02X}{g:02X}{b:02X}")));
    let surface = samples.iter().find_map(|node| match node.met {
        Met::Surface { solid, material } => Some((node, solid, material)),
        _ => None,
    });
    match surface {
        Some((node, solid, material)) => {
            let [px, py, pz] = node.point.to_array();
            rows.push(("object", scene.solids[solid as usize].name.clone()));
            rows.push(("material", scene.materials[material as usize].name.clone()));
            rows.push(("position", format!("{px:.3} {py:.3} {pz:.3}")));
            rows.push(("distance", format!("{:.4}", node.distance)));
        }
        None => rows.push(("object", "background".into())),
    }
    rows.push(("samples", samples.len().to_string()));
    let (rect, _) = ui.allocate_exact_size(vec2(ui.available_width() - 12.0, 16.0), Sense::hover());
    ui.painter().rect_filled(rect, 2.0, Color32::from_rgb(r, g, b));
    let grid = Grid::new("pixel numbers").num_columns(2).min_row_height(16.0);
    grid.spacing(vec2(8.0, 3.0)).show(ui, |ui| {
        for (name, value) in rows {
            ui.weak(name);
            ui.monospace(value);
            ui.end_row();
        }
    });
}

impl App {
    /// The panel of a pixel, if it is open.
    pub(super) fn pixel_ui(&mut self, ui: &mut Ui) {
        if !self.pixel.open {
            return;
        }
        let panel = self.panels.panel(ui, Part::Pixel);
        let known = self.live.inspected();
        let today = (self.document.scene(), self.selection);
        let shown = panel.show(ui, |ui| filled(ui, |ui| self.pixel.ui(ui, &known, today)));
        self.panels.note(Part::Pixel, &shown.response);
        let outcome = shown.inner;
        self.pixel.open = !outcome.close;
        if let (Some(target), Some(face)) = (outcome.clicked, &self.pixel.face) {
            let itself = ui.input(|i| i.modifiers.alt);
            let selection = target.selection(&face.tree.scene, self.document.scene(), itself);
            if let (Target::Surface { .. }, Some(Selection::Solid(solid))) =
                (target, target.selection(&face.tree.scene, self.document.scene(), true))
            {
                self.picked = Some(solid);
            }
            self.select(selection);
        }
    }

    /// Asks for the pixels that the panel shows.
    pub(super) fn ask_pixels(&mut self) {
        if let Some(wanted) = self.pixel.newly_wanted() {
            self.live.inspect(wanted);
        }
    }
}
