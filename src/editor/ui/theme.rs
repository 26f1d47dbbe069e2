//! The themes: colours and text styles. Neutral, so that the eye judges the picture, which lies on dark grey in both.

use crate::scene::Role;
use eframe::egui::{self, Color32, CornerRadius, FontFamily, FontId, Stroke, TextStyle, Theme, Ui, vec2};

/// Accent colour: selection, render button.
pub const ACCENT: Color32 = Color32::from_rgb(232, 166, 60);
/// Muted lights.
pub const MUTED: Color32 = Color32::from_rgb(226, 104, 92);
/// Success.
pub const GOOD: Color32 = Color32::from_rgb(120, 176, 120);
/// Errors.
pub const BAD: Color32 = Color32::from_rgb(224, 96, 84);
/// Around the picture and behind it.
pub const SURROUND: Color32 = Color32::from_gray(22);

/// Returns the colour of a role.
pub fn role_color(role: Role) -> Color32 {
    let [r, g, b] = role.srgb8();
    Color32::from_rgb(r, g, b)
}

/// Sets the styles of the whole window: dark, and light.
pub fn install(ctx: &egui::Context) {
    for theme in [Theme::Dark, Theme::Light] {
        ctx.style_mut_of(theme, |style| {
            sizes(style);
            match theme {
                Theme::Dark => dark(&mut style.visuals),
                Theme::Light => light(&mut style.visuals),
            }
        });
    }
}

/// Draws what follows in `ui` in the dark theme: it lies over the picture.
pub fn draw_over_picture(ui: &mut Ui) {
    *ui.visuals_mut() = ui.ctx().style_of(Theme::Dark).visuals.clone();
}

/// Returns the accent colour of texts and lines on panels.
pub fn accent(ui: &Ui) -> Color32 {
    ui.visuals().warn_fg_color
}

/// Returns the colour of errors on panels.
pub fn bad(ui: &Ui) -> Color32 {
    ui.visuals().error_fg_color
}

fn sizes(style: &mut egui::Style) {
    style.text_styles = [
        (TextStyle::Small, FontId::new(11.0, FontFamily::Proportional)),
        (TextStyle::Body, FontId::new(13.0, FontFamily::Proportional)),
        (TextStyle::Button, FontId::new(13.0, FontFamily::Proportional)),
        (TextStyle::Heading, FontId::new(16.0, FontFamily::Proportional)),
        (TextStyle::Monospace, FontId::new(12.5, FontFamily::Monospace)),
    ]
    .into();
    let spacing = &mut style.spacing;
    spacing.item_spacing = vec2(8.0, 6.0);
    spacing.button_padding = vec2(8.0, 3.0);
    spacing.interact_size.y = 22.0;
    spacing.slider_width = 120.0;
    spacing.combo_width = 120.0;
    spacing.tooltip_width = 320.0;
    style.interaction.tooltip_delay = 0.4;
}

fn dark(visuals: &mut egui::Visuals) {
    let gray = Color32::from_gray;
    visuals.panel_fill = gray(34);
    visuals.window_fill = gray(40);
    visuals.extreme_bg_color = gray(24);
    visuals.faint_bg_color = gray(40);
    visuals.window_stroke = Stroke::new(1.0, gray(64));
    visuals.selection.bg_fill = Color32::from_rgb(112, 78, 24);
    visuals.selection.stroke = Stroke::new(1.0, Color32::from_rgb(255, 226, 176));
    visuals.warn_fg_color = ACCENT;
    visuals.error_fg_color = BAD;
    let widgets = &mut visuals.widgets;
    widgets.noninteractive.bg_stroke = Stroke::new(1.0, gray(52));
    widgets.noninteractive.fg_stroke = Stroke::new(1.0, gray(188));
    widgets.inactive.weak_bg_fill = gray(54);
    widgets.inactive.bg_fill = gray(58);
    widgets.inactive.fg_stroke = Stroke::new(1.0, gray(212));
    widgets.hovered.weak_bg_fill = gray(68);
    widgets.hovered.bg_fill = gray(72);
    widgets.active.weak_bg_fill = gray(82);
    shared(visuals);
}

fn light(visuals: &mut egui::Visuals) {
    let gray = Color32::from_gray;
    visuals.panel_fill = gray(226);
    visuals.window_fill = gray(236);
    visuals.extreme_bg_color = gray(250);
    visuals.faint_bg_color = gray(218);
    visuals.window_stroke = Stroke::new(1.0, gray(160));
    visuals.selection.bg_fill = Color32::from_rgb(250, 206, 132);
    visuals.selection.stroke = Stroke::new(1.0, Color32::from_rgb(66, 40, 0));
    visuals.warn_fg_color = Color32::from_rgb(138, 80, 0);
    visuals.error_fg_color = Color32::from_rgb(176, 32, 22);
    let widgets = &mut visuals.widgets;
    widgets.noninteractive.bg_stroke = Stroke::new(1.0, gray(190));
    widgets.noninteractive.fg_stroke = Stroke::new(1.0, gray(48));
    widgets.inactive.weak_bg_fill = gray(206);
    widgets.inactive.bg_fill = gray(190);
    widgets.inactive.fg_stroke = Stroke::new(1.0, gray(32));
    widgets.hovered.weak_bg_fill = gray(194);
    widgets.hovered.bg_fill = gray(178);
    widgets.active.weak_bg_fill = gray(178);
    shared(visuals);
}

fn shared(visuals: &mut egui::Visuals) {
    visuals.slider_trailing_fill = true;
    visuals.hyperlink_color = visuals.warn_fg_color;
    let widgets = &mut visuals.widgets;
    for state in [&mut widgets.noninteractive, &mut widgets.inactive, &mut widgets.hovered, &mut widgets.active] {
        state.corner_radius = CornerRadius::same(4);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the relative luminance of a colour (WCAG 2.1).
    fn luminance(color: Color32) -> f32 {
        let [r, g, b, _] = egui::Rgba::from(color).to_array();
        0.2126 * r + 0.7152 * g + 0.0722 * b
    }

    #[test]
    fn texts_of_both_themes_stand_out_from_panels_fields_and_selections() {
        let ctx = egui::Context::default();
        install(&ctx);
        for theme in [Theme::Dark, Theme::Light] {
            let style = ctx.style_of(theme);
            let visuals = &style.visuals;
            let text = visuals.text_color();
            for (text, ground) in [
                (text, visuals.panel_fill),
                (text, visuals.window_fill),
                (visuals.strong_text_color(), visuals.panel_fill),
                (visuals.warn_fg_color, visuals.panel_fill),
                (visuals.error_fg_color, visuals.panel_fill),
                (visuals.widgets.inactive.fg_stroke.color, visuals.widgets.inactive.weak_bg_fill),
                (visuals.widgets.inactive.fg_stroke.color, visuals.extreme_bg_color),
                (visuals.selection.stroke.color, visuals.selection.bg_fill),
            ] {
                let (a, b) = (luminance(text), luminance(ground));
                // WCAG asks for 4.5 to 1
                let contrast = (a.max(b) + 0.05) / (a.min(b) + 0.05);
                assert!(contrast >= 4.2, "{theme:?}: {text:?} on {ground:?}: {contrast:.1}");
            }
        }
    }
}
