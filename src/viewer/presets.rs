//! Materials to choose from: a click gives the selected material the values of a preset, a drag makes
//! a solid of it. And materials on the clipboard.

use std::cell::OnceCell;
use std::path::Path;

use eframe::egui::{
    CollapsingHeader, Color32, Context, Id, Rect, Response, Role, Sense, Stroke, StrokeKind,
    TextureHandle, TextureOptions, Ui, WidgetInfo, pos2, vec2,
};

use super::app::App;
use super::clipboard;
use super::command::Command;
use super::inspector::Selection;
use super::picture::whole_image;
use crate::document::presets::{self, COLUMNS};
use crate::scene::Material;

/// Side of a thumbnail in points.
const THUMB: f32 = 48.0;

/// The presets and their pictures, made when they are first shown.
#[derive(Default)]
pub(super) struct Presets {
    list: OnceCell<Vec<Material>>,
    sheet: OnceCell<TextureHandle>,
    /// The material that the clipboard is asked for, by its name.
    pasted: Option<String>,
}

/// The preset that is carried to a solid, by its index.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Carried(pub(super) usize);

impl Presets {
    /// All of them.
    pub(super) fn list(&self) -> &[Material] {
        self.list.get_or_init(presets::all)
    }

    /// Lets go of what is on the graphics card.
    pub(super) fn forget_textures(&mut self) {
        self.sheet = OnceCell::new();
    }

    /// Shows the presets below a line that opens them; the one that was clicked.
    pub(super) fn ui(&self, ui: &mut Ui) -> Option<&Material> {
        let mut chosen = None;
        let header = CollapsingHeader::new("Presets").show_unindented(ui, |ui| {
            ui.horizontal_wrapped(|ui| {
                ui.spacing_mut().item_spacing = vec2(4.0, 4.0);
                for (i, preset) in self.list().iter().enumerate() {
                    let thumb = self.thumb_ui(ui, i, &preset.name);
                    if thumb.drag_started() {
                        thumb.dnd_set_drag_payload(Carried(i));
                    }
                    if thumb.clicked() {
                        chosen = Some(preset);
                    }
                }
            });
        });
        let about = "Gold, glass, wood and other materials to begin with";
        header.header_response.on_hover_text(about);
        chosen
    }

    fn thumb_ui(&self, ui: &mut Ui, index: usize, name: &str) -> Response {
        let (rect, response) = ui.allocate_exact_size(vec2(THUMB, THUMB), Sense::click_and_drag());
        response.widget_info(|| WidgetInfo::labeled(Role::Button, true, format!("preset {name}")));
        if ui.is_rect_visible(rect) {
            self.paint(ui, index, rect);
            if response.hovered() || response.has_focus() {
                let color = match response.is_pointer_button_down_on() {
                    true => ui.visuals().hyperlink_color,
                    false => ui.visuals().selection.stroke.color,
                };
                let stroke = Stroke::new(2.0, color);
                ui.painter().rect_stroke(rect, 2.0, stroke, StrokeKind::Inside);
            }
        }
        response.on_hover_ui(|ui| {
            ui.strong(name);
            ui.weak("A click gives this material its values");
            ui.weak("Drag it onto a solid in the picture to make that of it");
        })
    }

    /// The picture of a preset.
    pub(super) fn paint(&self, ui: &Ui, index: usize, rect: Rect) {
        let sheet = self.sheet.get_or_init(|| {
            let image = whole_image(&presets::pictures());
            ui.ctx().load_texture("presets", image, TextureOptions::LINEAR)
        });
        let side = presets::SIDE as f32;
        let size = sheet.size_vec2();
        let (column, row) = (index % COLUMNS as usize, index / COLUMNS as usize);
        let corner = pos2(column as f32 * side, row as f32 * side);
        let part = Rect::from_min_size(corner, vec2(side, side));
        let share = |at: eframe::egui::Pos2| pos2(at.x / size.x, at.y / size.y);
        let part = Rect::from_min_max(share(part.min), share(part.max));
        ui.painter().image(sheet.id(), rect, part, Color32::WHITE);
    }
}

impl App {
    /// Copies the selected material, or asks the clipboard for one to give its values to.
    pub(super) fn run_on_clipboard(&mut self, ctx: &Context, command: Command) {
        let scene = self.document.scene();
        let Selection::Material(i) = self.selection.within(scene) else { return };
        let material = &scene.materials[i];
        if command == Command::CopyMaterial {
            ctx.copy_text(presets::text(material));
            self.notices.say(format!("copied material {}", material.name));
        } else {
            self.presets.pasted = Some(material.name.clone());
            clipboard::ask(ctx, clipboard_id());
        }
    }

    /// Gives the values that were pasted to the material that they were asked for, as one step.
    pub(super) fn receive_material(&mut self, ctx: &Context) {
        if clipboard::is_empty(ctx) {
            self.notices.say("nothing was pasted: the clipboard holds no text".into());
        }
        let Some(text) = clipboard::pasted(ctx, clipboard_id(), false) else { return };
        let Some(name) = self.presets.pasted.take() else { return };
        let file = self.document.path().unwrap_or(Path::new("pasted.toml")).to_owned();
        let what = match presets::parse(&text, &file) {
            Ok(what) => what,
            Err(_) => {
                let text = clipboard::quoted(&text);
                return self.notices.say(format!("{text} was not pasted: it is no material"));
            }
        };
        let mut scene = self.document.scene().clone();
        let Some(material) = scene.materials.iter_mut().find(|m| m.name == name) else { return };
        presets::give(material, &what);
        self.document.end_gesture();
        self.commit(scene);
        self.document.name_step(format!("paste {} on {name}", what.name));
        self.document.end_gesture();
    }
}

/// Who asks the clipboard for a material.
fn clipboard_id() -> Id {
    Id::unique("a material from the clipboard")
}
