//! Colours, spacing and text sizes of the window.

use eframe::egui::{
    Color32, Context, FontDefinitions, FontFamily, FontId, Style, TextStyle, Theme as EguiTheme,
    ThemePreference, Visuals, vec2,
};

use crate::document::settings::{Settings, Theme};

/// Gives the window its look; once, at the start.
pub(super) fn set_up(ctx: &Context) {
    ctx.set_fonts(fonts());
    // Who presses slowly, or on a machine that draws slowly, has clicked all the same.
    ctx.options_mut(|options| options.input_options.max_click_duration = 2.0);
    for theme in [EguiTheme::Dark, EguiTheme::Light] {
        ctx.style_mut_of(theme, |style| {
            spacing(style);
            style.visuals = visuals(theme);
        });
    }
}

/// Applies what the person chose.
pub(super) fn apply(ctx: &Context, settings: &Settings) {
    ctx.set_theme(match settings.theme {
        Theme::System => ThemePreference::System,
        Theme::Light => ThemePreference::Light,
        Theme::Dark => ThemePreference::Dark,
    });
    ctx.set_zoom_factor(settings.zoom_percent.clamp(50, 300) as f32 / 100.0);
}

/// The arrows in the names of steps stand in the monospaced font alone.
fn fonts() -> FontDefinitions {
    let mut fonts = FontDefinitions::default();
    fonts.families.entry(FontFamily::Proportional).or_default().push("Hack".into());
    fonts
}

fn spacing(style: &mut Style) {
    style.spacing.item_spacing = vec2(6.0, 5.0);
    style.spacing.button_padding = vec2(7.0, 2.0);
    style.spacing.interact_size = vec2(36.0, 20.0);
    style.spacing.slider_rail_height = 4.0;
    style.spacing.indent = 14.0;
    style.text_styles = [
        (TextStyle::Small, 11.0),
        (TextStyle::Body, 13.0),
        (TextStyle::Button, 13.0),
        (TextStyle::Heading, 15.5),
    ]
    .into_iter()
    .map(|(style, size)| (style, FontId::new(size, FontFamily::Proportional)))
    .chain([(TextStyle::Monospace, FontId::new(12.5, FontFamily::Monospace))])
    .collect();
}

/// Neutral greys, so that the eye judges the picture and not its frame; text keeps a contrast of
/// 4.5 : 1 on every ground it stands on.
fn visuals(theme: EguiTheme) -> Visuals {
    let grey = Color32::from_gray;
    let mut v = theme.default_visuals();
    let (panel, text, weak) = match theme {
        EguiTheme::Dark => (grey(32), grey(222), grey(165)),
        EguiTheme::Light => (grey(245), grey(25), grey(85)),
    };
    (v.panel_fill, v.window_fill) = (panel, panel);
    v.weak_text_color = Some(weak);
    v.override_text_color = None;
    v.widgets.noninteractive.fg_stroke.color = text;
    v.widgets.inactive.fg_stroke.color = text;
    v.widgets.open.fg_stroke.color = text;
    if theme == EguiTheme::Light {
        // The rail of a slider, which would hardly stand out from the panel.
        v.widgets.inactive.bg_fill = grey(200);
        v.hyperlink_color = Color32::from_rgb(0, 95, 190);
        v.selection.bg_fill = Color32::from_rgb(170, 205, 245);
        v.selection.stroke.color = grey(10);
        v.error_fg_color = Color32::from_rgb(180, 20, 10);
    } else {
        v.selection.bg_fill = Color32::from_rgb(25, 85, 140);
        v.selection.stroke.color = grey(245);
        v.error_fg_color = Color32::from_rgb(255, 125, 115);
    }
    v
}

#[cfg(test)]
mod tests {
    use super::*;

    /// WCAG 2.2: relative luminance of an opaque colour.
    fn luminance(color: Color32) -> f64 {
        let linear = |c: u8| {
            let c = f64::from(c) / 255.0;
            if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
        };
        0.2126 * linear(color.r()) + 0.7152 * linear(color.g()) + 0.0722 * linear(color.b())
    }

    fn contrast(a: Color32, b: Color32) -> f64 {
        let (a, b) = (luminance(a), luminance(b));
        (a.max(b) + 0.05) / (a.min(b) + 0.05)
    }

    #[test]
    fn text_stands_out_from_every_ground() {
        assert!((contrast(Color32::BLACK, Color32::WHITE) - 21.0).abs() < 1e-9);
        assert!(contrast(Color32::from_gray(120), Color32::from_gray(60)) < 4.5, "it can fail");
        for theme in [EguiTheme::Dark, EguiTheme::Light] {
            let v = visuals(theme);
            let grounds = [v.panel_fill, v.window_fill, v.faint_bg_color, v.extreme_bg_color];
            for ground in grounds.into_iter().filter(Color32::is_opaque) {
                for text in [v.text_color(), v.weak_text_color(), v.hyperlink_color] {
                    let got = contrast(text, ground);
                    assert!(got >= 4.5, "{theme:?}: {text:?} on {ground:?}: {got:.2}");
                }
            }
            for (_, widget) in [
                ("inactive", v.widgets.inactive),
                ("hovered", v.widgets.hovered),
                ("active", v.widgets.active),
                ("open", v.widgets.open),
            ] {
                let got = contrast(widget.fg_stroke.color, widget.weak_bg_fill);
                assert!(got >= 4.5, "{theme:?}: {widget:?}: {got:.2}");
            }
            assert!(contrast(v.selection.stroke.color, v.selection.bg_fill) >= 4.5);
            assert!(contrast(v.error_fg_color, v.panel_fill) >= 4.5);
        }
    }
}
