//! Why a pixel has its colour: bars of its light by material, by light and by bounce.

use eframe::egui::{Align2, Button, Color32, FontId, Rect, RichText, Ui, vec2};

use super::outline::{lamp, shown, swatch};
use super::pixel::Face;
use super::pixel_lines::{Target, sky};
use super::pixel_rows::{bar_at, named_ui, part_of, percent, swatch_ui};
use crate::session::inspect::{Bars, Share, Source};

/// Most bars of one kind: the rest is one more.
const MOST: usize = 12;

/// A bar and what it stands for.
struct Bar {
    name: String,
    color: Color32,
    share: Share,
    target: Option<Target>,
}

/// Shows the bars; what was clicked.
pub(super) fn bars_ui(ui: &mut Ui, face: &Face) -> Option<Target> {
    let scene = &face.tree.scene;
    let Bars { materials, sources, bounces } = &face.bars;
    let materials = materials.iter().map(|&(material, share)| match material {
        Some(i) => {
            let material = &scene.materials[usize::from(i)];
            let target = Some(Target::Material(i));
            Bar { name: material.name.clone(), color: swatch(material), share, target }
        }
        None => background(face, share),
    });
    let sources = sources.iter().map(|&(source, share)| match source {
        Source::Lamp(i) => match scene.lights.get(usize::from(i)) {
            Some(light) => {
                let target = Some(Target::Light(i));
                Bar { name: light.name.clone(), color: lamp(light), share, target }
            }
            None => Bar { name: "gone".into(), color: Color32::BLACK, share, target: None },
        },
        Source::Ambient => {
            let (name, color) = ("ambient and glow".into(), shown(scene.ambient_light));
            Bar { name, color, share, target: None }
        }
        Source::Background => background(face, share),
    });
    let bounces = bounces.iter().map(|&(bounce, share)| {
        let name = match bounce {
            0 => "seen directly".into(),
            1 => "after 1 bounce".into(),
            n => format!("after {n} bounces"),
        };
        Bar { name, color: Color32::TRANSPARENT, share, target: None }
    });
    let lists = [
        ("By material", materials.collect::<Vec<_>>()),
        ("By light", sources.collect()),
        ("By bounce", bounces.collect()),
    ];
    let mut clicked = None;
    ui.spacing_mut().item_spacing.y = 1.0;
    for (title, bars) in lists {
        ui.label(RichText::new(title).strong());
        for bar in bars.iter().take(MOST) {
            if bar_ui(ui, title, bar, face.whole) {
                clicked = bar.target;
            }
        }
        if bars.len() > MOST {
            let rest: Share = bars[MOST..].iter().map(|bar| bar.share).sum();
            let name = format!("{} more", bars.len() - MOST);
            let bar = Bar { name, color: Color32::TRANSPARENT, share: rest, target: None };
            bar_ui(ui, title, &bar, face.whole);
        }
        ui.add_space(4.0);
    }
    clicked
}

fn background(face: &Face, share: Share) -> Bar {
    let color = shown(sky(&face.tree.scene.background));
    Bar { name: "background".into(), color, share, target: Some(Target::Background) }
}

/// Shows a bar; whether it was clicked.
fn bar_ui(ui: &mut Ui, list: &str, bar: &Bar, whole: f64) -> bool {
    const NUMBER: f32 = 54.0;
    const LONG: f32 = 80.0;
    ui.horizontal(|ui| {
        let right = ui.min_rect().left() + ui.available_width();
        swatch_ui(ui, bar.color);
        let room = (right - LONG - NUMBER - 12.0 - ui.cursor().left()).max(40.0);
        let part = part_of(bar.share, whole);
        let (place, response) = named_ui(ui, room, Button::selectable(false, &bar.name));
        let about = match bar.target {
            Some(_) => "What it adds to the pixel. A click shows its parameters",
            None => "What it adds to the pixel",
        };
        let name = format!("{list}: {}", bar.name);
        let clicked = response.on_hover_text(about).accessible_name(name).clicked();
        let number = [right - LONG - 6.0, place.center().y];
        let (font, color) = (FontId::monospace(11.5), ui.visuals().text_color());
        ui.painter().text(number.into(), Align2::RIGHT_CENTER, percent(part), font, color);
        let size = vec2(LONG, 10.0);
        bar_at(ui, Rect::from_min_size([right - LONG, number[1] - 5.0].into(), size), part);
        clicked
    })
    .inner
}
