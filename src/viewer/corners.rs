//! The corners of polygons and outlines, one row each.

use eframe::egui::{CollapsingHeader, Ui};
use glam::{DVec2, DVec3};

use super::badge::badge_ui;
use super::control::{BADGE, Row, explained, vector_ui};
use super::number::{Edit, FIELD, Precision};
use crate::scene::fields::COORDINATE;
use crate::scene::range::Range;

/// A polygon's corners.
pub(super) fn points_ui(ui: &mut Ui, row: &Row<'_>, points: &mut [DVec3]) -> Edit {
    let mut edit = Edit::default();
    let title = format!("{} ({})", row.key, points.len());
    let header = CollapsingHeader::new(title).id_salt(row.path);
    let header = header.show(ui, |ui| {
        badge_ui(ui, row.key, row.cost, BADGE);
        for (i, point) in points.iter_mut().enumerate() {
            ui.horizontal(|ui| {
                let name = format!("{} {i}", row.key);
                ui.label(i.to_string());
                edit.join(vector_ui(ui, row, (&name, 3 * i), point, COORDINATE));
            });
        }
    });
    explained(header.header_response, row, None);
    edit
}

/// The corners of an outline's loops.
pub(super) fn loops_ui(ui: &mut Ui, row: &Row<'_>, loops: &mut [Vec<DVec2>], range: Range) -> Edit {
    let (mut edit, mut place) = (Edit::default(), 0);
    let title = format!("{} ({})", row.key, loops.iter().map(Vec::len).sum::<usize>());
    let header = CollapsingHeader::new(title).id_salt(row.path);
    let header = header.show(ui, |ui| {
        badge_ui(ui, row.key, row.cost, BADGE);
        for (l, points) in loops.iter_mut().enumerate() {
            for (i, point) in points.iter_mut().enumerate() {
                ui.horizontal(|ui| {
                    ui.label(format!("{l}.{i}"));
                    for (x, axis) in [(&mut point.x, "x"), (&mut point.y, "y")] {
                        let name = format!("{} {l}.{i} {axis}", row.key);
                        let number = row.number(name, place, range, Precision::Double);
                        edit.join(number.field_ui(ui, x, FIELD));
                        place += 1;
                    }
                });
            }
        }
    });
    explained(header.header_response, row, None);
    edit
}
