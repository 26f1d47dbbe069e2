//! The theme: colours and text styles. Dark and neutral, so that the eye judges the picture.

use crate::scene::Role;
use eframe::egui::{self, Color32, CornerRadius, FontFamily, FontId, Stroke, TextStyle, Theme, vec2};

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

/// Sets the style of the whole window.
pub fn install(ctx: &egui::Context) {
    ctx.set_theme(Theme::Dark);
    ctx.style_mut_of(Theme::Dark, |style| {
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
        colors(&mut style.visuals);
    });
}

fn colors(visuals: &mut egui::Visuals) {
    let gray = Color32::from_gray;
    visuals.panel_fill = gray(34);
    visuals.window_fill = gray(40);
    visuals.extreme_bg_color = gray(24);
    visuals.faint_bg_color = gray(40);
    visuals.window_stroke = Stroke::new(1.0, gray(64));
    visuals.slider_trailing_fill = true;
    visuals.selection.bg_fill = Color32::from_rgb(112, 78, 24);
    visuals.selection.stroke = Stroke::new(1.0, Color32::from_rgb(255, 226, 176));
    visuals.hyperlink_color = ACCENT;
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
    for state in [&mut widgets.noninteractive, &mut widgets.inactive, &mut widgets.hovered, &mut widgets.active] {
        state.corner_radius = CornerRadius::same(4);
    }
}
