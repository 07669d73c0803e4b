//! The cost of a control, shown beside it before it is touched.

use eframe::egui::{Align2, Color32, FontId, Role, Sense, Ui, Vec2, WidgetInfo, vec2};

use crate::session::Class;
use crate::session::cost::{Cost, Pixels};

/// How dear an edit is, for its colour.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Price {
    Free,
    Mixed,
    Dear,
    Unknown,
}

/// What the badge says.
pub(super) fn text(cost: Option<Cost>) -> String {
    match cost {
        None => "…".into(),
        Some(Cost::Instant) => "instant".into(),
        Some(Cost::InstantUpTo(x, _)) => format!("instant ≤ {}", rounded(x, f64::floor)),
        Some(Cost::InstantDownTo(x, _) | Cost::RereadBelow(x, _)) => {
            format!("instant ≥ {}", rounded(x, f64::ceil))
        }
        Some(Cost::InstantWithin([low, high], _)) => {
            format!("instant {}…{}", rounded(low, f64::ceil), rounded(high, f64::floor))
        }
        Some(Cost::InstantAboveZero(_)) => "instant > 0".into(),
        Some(Cost::Refold) => "refold".into(),
        Some(Cost::Reread(pixels)) => format!("rereads {}", share(pixels)),
        Some(Cost::Regrow(pixels)) => format!("traces {}", share(pixels)),
        Some(Cost::TraceAll) => "traces all".into(),
    }
}

/// The badge in full.
pub(super) fn explanation(cost: Option<Cost>) -> String {
    match cost {
        None => "The cost is being worked out".into(),
        Some(Cost::Instant) => "Instant: no ray is cast, whatever the value".into(),
        Some(Cost::InstantUpTo(x, pixels)) => format!(
            "Instant up to {}; above that branches of the ray trees come alive that were not \
             traced: traces {} of the pixels, and with higher values perhaps more{}",
            rounded(x, f64::floor),
            share(pixels),
            rays(pixels)
        ),
        Some(Cost::InstantDownTo(x, pixels)) => format!(
            "Instant down to {}; below that branches of the ray trees come alive that were not \
             traced: traces {} of the pixels, and with lower values perhaps more{}",
            rounded(x, f64::ceil),
            share(pixels),
            rays(pixels)
        ),
        Some(Cost::InstantWithin([low, high], pixels)) => format!(
            "Instant from {} to {}; beyond, branches of the ray trees begin or cease to live: adaptive \
             sampling is decided again for {} of the pixels, which traces rays where more samples are \
             needed{}",
            rounded(low, f64::ceil),
            rounded(high, f64::floor),
            share(pixels),
            rays(pixels)
        ),
        Some(Cost::RereadBelow(x, pixels)) => format!(
            "Instant down to {}; below that total reflection may show: the kept ray trees of {} of \
             the pixels are read again{}",
            rounded(x, f64::ceil),
            share(pixels),
            rays(pixels)
        ),
        Some(Cost::InstantAboveZero(pixels)) => format!(
            "Instant for every distance; 0, which is no falloff, reads the kept ray trees of {} of the \
             pixels again{}",
            share(pixels),
            rays(pixels)
        ),
        Some(Cost::Reread(pixels)) => format!(
            "The kept ray trees of {} of the pixels are read again; no ray is cast",
            share(pixels)
        ),
        Some(Cost::Regrow(pixels)) => format!(
            "Traces new rays for {} of the pixels; the kept ray trees answer all others{}",
            share(pixels),
            rays(pixels)
        ),
        Some(Cost::Refold) => "Highlights are summed again from kept angles; no ray is cast".into(),
        Some(Cost::TraceAll) => "Moves rays: the picture is traced anew, coarse first".into(),
    }
}

/// How many rays there will be, as far as it is known.
fn rays(pixels: Pixels) -> String {
    let least = match pixels.rays {
        0 => String::new(),
        n if n < 10_000 => format!("; at least {n} rays"),
        n => format!("; at least {:.2} million rays", n as f64 / 1e6),
    };
    let released = "; some trees were released for memory, and are traced whole";
    least + if pixels.released { released } else { "" }
}

/// Per cent of the picture, never 0 for some and never 100 for not all.
fn share(Pixels { count, of, at_most, .. }: Pixels) -> String {
    let percent = count as f64 * 100.0 / of as f64;
    let most = if at_most { "≤ " } else { "" };
    match () {
        () if count == 0 => "0 %".into(),
        () if percent < 1.0 => "< 1 %".into(),
        () if count < of => format!("{most}{} %", percent.round().min(99.0)),
        () => format!("{most}100 %"),
    }
}

/// Three significant digits, rounded to the safe side, so that what is said is true.
fn rounded(x: f64, to: fn(f64) -> f64) -> String {
    if x == 0.0 || x.abs() >= 1e6 {
        return format!("{x}");
    }
    let digits = (2 - x.abs().log10().floor() as i32).max(0);
    let unit = 10f64.powi(digits);
    let decimals = digits as usize;
    let text = format!("{:.decimals$}", to(x * unit) / unit);
    match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
        false => text,
    }
}

fn price(cost: Option<Cost>) -> Price {
    match cost {
        None => Price::Unknown,
        Some(Cost::Instant) => Price::Free,
        Some(Cost::InstantUpTo(..) | Cost::InstantDownTo(..)) => Price::Mixed,
        Some(Cost::InstantWithin(..)) => Price::Mixed,
        Some(Cost::RereadBelow(..) | Cost::InstantAboveZero(_)) => Price::Mixed,
        Some(Cost::Refold | Cost::Reread(_)) => Price::Mixed,
        Some(Cost::Regrow(_) | Cost::TraceAll) => Price::Dear,
    }
}

fn dot_color(price: Price, dark: bool) -> Color32 {
    match (price, dark) {
        (Price::Free, true) => Color32::from_rgb(96, 200, 120),
        (Price::Free, false) => Color32::from_rgb(30, 140, 60),
        (Price::Mixed, true) => Color32::from_rgb(230, 180, 80),
        (Price::Mixed, false) => Color32::from_rgb(180, 110, 0),
        (Price::Dear, true) => Color32::from_rgb(235, 110, 100),
        (Price::Dear, false) => Color32::from_rgb(190, 40, 30),
        (Price::Unknown, _) => Color32::GRAY,
    }
}

/// A line about what switching to another scene costs, with the colour of its dot.
pub(super) fn class_text(class: Option<Class>, dark: bool) -> (&'static str, Color32) {
    let (text, price) = match class {
        None => ("…", Price::Unknown),
        Some(Class::None) => ("shown", Price::Free),
        Some(Class::Reshade) => ("instant", Price::Free),
        Some(Class::Refold) => ("refold", Price::Mixed),
        Some(Class::Regrow) => ("traces some", Price::Dear),
        Some(Class::Retrace) => ("traces all", Price::Dear),
    };
    (text, dot_color(price, dark))
}

/// Draws the badge of the control `name`, `width` wide.
pub(super) fn badge_ui(ui: &mut Ui, name: &str, cost: Option<Cost>, width: f32) {
    let size = vec2(width, ui.spacing().interact_size.y);
    let (rect, response) = ui.allocate_exact_size(size, Sense::hover());
    let price = price(cost);
    let center = rect.left_center() + vec2(7.0, 0.0);
    ui.painter().circle_filled(center, 3.0, dot_color(price, ui.visuals().dark_mode));
    let (font, color) = (FontId::proportional(11.5), ui.visuals().weak_text_color());
    let at = center + Vec2::new(8.0, 0.0);
    ui.painter().text(at, Align2::LEFT_CENTER, text(cost), font, color);
    response.widget_info(|| {
        WidgetInfo::labeled(Role::Label, true, format!("cost of {name}: {}", text(cost)))
    });
    response.on_hover_ui(|ui| {
        ui.label(explanation(cost));
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    const SOME: Pixels = Pixels { count: 3, of: 16, rays: 0, released: false, at_most: false };

    #[test]
    fn a_threshold_is_rounded_to_the_safe_side() {
        assert_eq!(text(Some(Cost::InstantUpTo(0.447_91, SOME))), "instant ≤ 0.447");
        assert_eq!(text(Some(Cost::InstantDownTo(0.001_234_5, SOME))), "instant ≥ 0.00124");
        assert_eq!(
            text(Some(Cost::InstantWithin([0.158_2, 0.447_9], SOME))),
            "instant 0.159…0.447"
        );
        assert_eq!(text(Some(Cost::InstantUpTo(0.0, SOME))), "instant ≤ 0");
        assert_eq!(text(Some(Cost::InstantUpTo(10.0, SOME))), "instant ≤ 10");
        assert_eq!(text(Some(Cost::InstantUpTo(120.0, SOME))), "instant ≤ 120");
    }

    #[test]
    fn a_share_is_neither_none_nor_all_unless_it_is() {
        let of = |count| share(Pixels { count, of: 1000, ..SOME });
        assert_eq!(
            [0, 1, 9, 10, 126, 999, 1000].map(of),
            ["0 %", "< 1 %", "< 1 %", "1 %", "13 %", "99 %", "100 %"]
        );
        let most = Pixels { count: 126, of: 1000, at_most: true, ..SOME };
        assert_eq!(text(Some(Cost::Regrow(most))), "traces ≤ 13 %");
    }
}
