//! Choosing what kind of paint, bump and background there is, and picking image files for them.

use std::path::{Path, PathBuf};

use eframe::egui::{ComboBox, Context, Ui};

use super::app::App;
use super::dialog::Purpose;
use super::files::{Done, For};
use super::hints;
use super::inspector::{Outcome, Selection};
use crate::scene::fields::{BACKGROUNDS, BUMPS, bump_key, texture_key};
use crate::scene::texture::{self, Image, ImageError};
use crate::scene::{Background, Bump, ImageFile, Paint, Scene};

/// Kinds of paint, as their keys in a scene file.
const PAINTS: [&str; 6] = ["color", "checker", "gradient", "marble", "wood", "image"];
/// No bump.
const NONE: &str = "none";

/// What an image is picked for.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum ImageFor {
    /// The colours of the material of this name.
    Paint(String),
    /// Its bump.
    Bump(String),
    /// The background.
    Background,
}

impl ImageFor {
    /// What the file at this path of the scene is for, in the inspector of `selection`.
    pub(super) fn of(path: &str, selection: Selection, scene_name: &str) -> Option<ImageFor> {
        match selection {
            Selection::Scene => Some(ImageFor::Background),
            Selection::Material(_) if path.ends_with(".bump.image.file") => {
                Some(ImageFor::Bump(scene_name.to_owned()))
            }
            Selection::Material(_) => Some(ImageFor::Paint(scene_name.to_owned())),
            Selection::Light(_) | Selection::Solid(_) => None,
        }
    }

    /// Puts an image in its place; whether there still is one.
    fn put(&self, scene: &mut Scene, file: ImageFile) -> bool {
        let (ImageFor::Paint(name) | ImageFor::Bump(name)) = self else {
            put_in_background(&mut scene.background, file);
            return true;
        };
        let Some(material) = scene.materials.iter_mut().find(|m| m.name == *name) else {
            return false;
        };
        if let ImageFor::Paint(_) = self {
            if !matches!(material.paint, Paint::Image { .. }) {
                material.paint = Paint::named("image");
            }
            if let Paint::Image { image, .. } = &mut material.paint {
                *image = file;
            }
        } else {
            if !matches!(material.bump, Bump::Image { .. }) {
                material.bump = Bump::named("image");
            }
            if let Bump::Image { image, .. } = &mut material.bump {
                *image = file;
            }
        }
        true
    }
}

fn put_in_background(background: &mut Background, file: ImageFile) {
    if !matches!(background, Background::Image { .. }) {
        *background = Background::named("image");
    }
    if let Background::Image { image, .. } = background {
        *image = file;
    }
}

/// Lists of the kinds that what is selected may be of.
pub(super) fn kinds_ui(
    ui: &mut Ui,
    scene: &mut Scene,
    selection: Selection,
    outcome: &mut Outcome,
) {
    match selection {
        Selection::Material(i) => {
            let material = &mut scene.materials[i];
            let paint = kind_ui(ui, "paint", texture_key(&material.paint), &PAINTS);
            match paint {
                Some("image") => outcome.pick = Some(ImageFor::Paint(material.name.clone())),
                Some(kind) => {
                    material.paint = material.paint.turned_into(kind);
                    outcome.changed = true;
                }
                None => {}
            }
            let kinds: Vec<&'static str> = [NONE].iter().chain(BUMPS).copied().collect();
            let present = match bump_key(&material.bump) {
                "" => NONE,
                key => key,
            };
            match kind_ui(ui, "bump", present, &kinds) {
                Some("image") => outcome.pick = Some(ImageFor::Bump(material.name.clone())),
                Some(kind) => {
                    material.bump = Bump::named(kind);
                    outcome.changed = true;
                }
                None => {}
            }
        }
        Selection::Scene => {
            let present = match scene.background {
                Background::Color(_) => "color",
                Background::Gradient { .. } => "gradient",
                Background::Image { .. } => "image",
            };
            match kind_ui(ui, "background", present, BACKGROUNDS) {
                Some("image") => outcome.pick = Some(ImageFor::Background),
                Some(kind) => {
                    scene.background = Background::named(kind);
                    outcome.changed = true;
                }
                None => {}
            }
        }
        Selection::Light(_) | Selection::Solid(_) => {}
    }
}

/// A list of kinds; the one that was chosen, if it is another.
pub(super) fn kind_ui(
    ui: &mut Ui,
    what: &str,
    present: &'static str,
    kinds: &[&'static str],
) -> Option<&'static str> {
    let mut chosen = present;
    ui.horizontal(|ui| {
        ui.label(what);
        let combo = ComboBox::from_id_salt(("kind", what)).selected_text(present);
        let list = combo.width(120.0).show_ui(ui, |ui| {
            for kind in kinds {
                ui.selectable_value(&mut chosen, kind, *kind).on_hover_text(hints::kind(kind));
            }
        });
        let name = format!("kind of {what}");
        list.response.accessible_name(name).on_hover_text(hints::kind(present));
    });
    (chosen != present).then_some(chosen)
}

impl App {
    /// Asks for an image file.
    pub(super) fn ask_image(&mut self, ctx: &Context, place: ImageFor) {
        self.document.end_gesture();
        self.ask(ctx, Purpose::Image, String::new(), For::Image(place));
    }

    /// Reads an image file in a thread.
    pub(super) fn read_image(&mut self, ctx: &Context, path: PathBuf, place: ImageFor) {
        self.files.work(ctx, move || {
            let result = Box::new(texture::read(&path));
            Done::Image { path, place, result }
        });
    }

    /// Shows an image that was read.
    pub(super) fn image_read(
        &mut self,
        path: &Path,
        place: &ImageFor,
        result: Result<Image, ImageError>,
    ) {
        let image = match result {
            Ok(image) => image.into(),
            Err(error) => return self.notices.error(error.to_string()),
        };
        let mut edited = self.document.scene().clone();
        let file = ImageFile { file: self.document.name_of(path), image };
        if place.put(&mut edited, file) {
            self.commit(edited);
            self.document.end_gesture();
        }
    }
}
