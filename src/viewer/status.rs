//! The status line: what the last edit cost, what runs, how much is kept.

use eframe::egui::{Align, Button, Layout, ProgressBar, Ui};

use super::clip::clipped_text;
use super::command::Command;
use crate::film::clipping::Clipped;
use crate::session::live::{Shown, Stage, Status};
use crate::session::{Class, EditReport};

/// Shows the status line; gives a command if one of its buttons was pressed.
pub(super) fn status_ui(
    ui: &mut Ui,
    status: &Status,
    shown: Option<&Shown>,
    clipped: Option<Clipped>,
) -> Option<Command> {
    let mut command = None;
    ui.horizontal(|ui| {
        ui.label(stage_text(status, shown)).on_hover_text(STAGE);
        ui.separator();
        match &status.job {
            Some(job) => {
                let (done, total) = job.steps;
                let share = done as f32 / total.max(1) as f32;
                let bar = ProgressBar::new(share).desired_width(120.0);
                ui.add(bar.text(format!("{:.0} %", share * 100.0)))
                    .on_hover_text("How much of the work is done");
                if ui.add(Button::new("Stop")).on_hover_text(Command::Stop.about()).clicked() {
                    command = Some(Command::Stop);
                }
                ui.label(&job.what).on_hover_text("What runs, and what asked for it");
            }
            None if status.held => {
                if ui.button("Trace now").on_hover_text(Command::Resume.about()).clicked() {
                    command = Some(Command::Resume);
                }
                let text = match shown.map(|shown| shown.stage) {
                    Some(Stage::Whole) => {
                        "stopped: the picture shows the scene before the last change"
                    }
                    _ => "stopped before the picture was whole",
                };
                ui.label(text);
            }
            None => {
                if let Some(last) = &status.last {
                    ui.label(edit_text(last, status.opened)).on_hover_text(edit_about(last));
                }
            }
        }
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            ui.label(cache_text(status)).on_hover_text(cache_about(status));
            if let Some(clipped) = clipped {
                ui.separator();
                ui.label(clipped_text(clipped)).on_hover_text(CLIPPED);
            }
        });
    });
    command
}

const STAGE: &str = "A new picture comes coarse first, then with one sample per pixel or a region, then whole; \
                     dotted pixels are still to be grown again, the others are exact";
const CLIPPED: &str = "Pixels with a channel brighter than the screen can show, marked red; and with one \
                       darker than black, marked blue";
const CACHE: &str = "Kept ray trees, matrix and highlight lists, of the memory that they may take";

fn stage_text(status: &Status, shown: Option<&Shown>) -> String {
    match shown.map(|s| s.stage) {
        None => "no picture yet".into(),
        Some(Stage::Coarse) => "coarse".into(),
        Some(Stage::OneSample) => "one sample".into(),
        Some(Stage::Region) => "the region".into(),
        Some(Stage::Mending) => pending_text(status.pending),
        Some(Stage::Whole) if status.in_step => "exact".into(),
        Some(Stage::Whole) => "earlier scene".into(),
    }
}

/// How many pixels are still to be grown again.
fn pending_text(pixels: u64) -> String {
    match pixels {
        n if n < 10_000 => format!("{n} pixels pending"),
        n if n < 1_000_000 => format!("{} k pixels pending", n / 1000),
        n => format!("{:.1} M pixels pending", n as f64 / 1e6),
    }
}

/// The last edit, or opening, in one line: class, time, rays.
fn edit_text(report: &EditReport, opened: bool) -> String {
    let rays = report.rays.total();
    let time = match report.milliseconds {
        ms if ms < 1000.0 => format!("{ms:.1} ms"),
        ms => format!("{:.1} s", ms / 1e3),
    };
    let cast = match rays {
        0 => "0 rays".to_owned(),
        n if n < 10_000 => format!("{n} rays"),
        n => format!("{:.2} million rays", n as f64 / 1e6),
    };
    let class = match opened {
        true => "opened from what was kept".to_owned(),
        false => report.class.to_string(),
    };
    format!("{class} · {time} · {cast}")
}

fn edit_about(report: &EditReport) -> String {
    let done = match report.class {
        Class::None => "Nothing visible changed",
        Class::Reshade => "Shading was evaluated again from the kept ray trees",
        Class::Refold => "Kept angles or ray trees were folded again, then shaded",
        Class::Regrow => "Some pixels' ray trees were grown again; kept ones answered the rest",
        Class::Retrace => "Everything was traced",
    };
    match &report.reason {
        Some(reason) => format!("{done}: {reason}"),
        None => done.to_owned(),
    }
}

fn megabytes(bytes: u64) -> f64 {
    bytes as f64 / 1e6
}

fn cache_text(status: &Status) -> String {
    format!("kept {:.0} MB of {:.0} MB", megabytes(status.bytes), megabytes(status.budget))
}

fn cache_about(status: &Status) -> String {
    match status.card_bytes {
        0 => CACHE.to_owned(),
        bytes => format!("{CACHE}; {:.0} MB more on the graphics card", megabytes(bytes)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::forest::grow::RayCounts;

    #[test]
    fn pending_pixels_are_counted_in_few_digits() {
        assert_eq!(pending_text(0), "0 pixels pending");
        assert_eq!(pending_text(9_999), "9999 pixels pending");
        assert_eq!(pending_text(123_456), "123 k pixels pending");
        assert_eq!(pending_text(2_073_600), "2.1 M pixels pending");
    }

    #[test]
    fn an_edit_is_told_with_class_time_and_rays() {
        let report = EditReport {
            class: Class::Reshade,
            reason: None,
            rays: RayCounts::default(),
            pixels: 0,
            milliseconds: 3.24,
        };
        assert_eq!(edit_text(&report, false), "reshade · 3.2 ms · 0 rays");
        let opened = "opened from what was kept · 3.2 ms · 0 rays";
        assert_eq!(edit_text(&report, true), opened);
        let slow = EditReport { class: Class::Retrace, milliseconds: 2345.0, ..report };
        assert_eq!(edit_text(&slow, false), "retrace · 2.3 s · 0 rays");
    }
}
