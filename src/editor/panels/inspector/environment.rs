//! The rows of a surround's environment map.

use crate::editor::commands::command::Command;
use crate::editor::ui::theme;
use crate::editor::ui::widgets::{NumberField, row};
use crate::scene::{Assets, Emitter, Light};
use eframe::egui::{RichText, Ui};

/// Draws the rows; the file comes from a dialog that a command opens.
pub(super) fn environment_rows(ui: &mut Ui, assets: &Assets, light: &mut Light, out: &mut Vec<Command>) {
    if light.emitter != Emitter::Surround {
        return;
    }
    let tip = "A panorama (HDR or EXR, twice as wide as high) that lights the studio and shows in mirrors. The power is \
               the illuminance on the plane that gets most of its light";
    row(ui, "Environment", tip, |ui| {
        if let Some(path) = &light.environment_map {
            let shown: String = path.rsplit('/').next().unwrap_or(path).chars().take(18).collect();
            ui.label(shown).on_hover_text(path);
        }
        let text = if light.environment_map.is_some() { "Other\u{2026}" } else { "HDR, EXR\u{2026}" };
        if ui.button(text).on_hover_text("Choose a panorama").clicked() {
            out.push(Command::EnvironmentMap(Some(light.id)));
        }
        if light.environment_map.is_some() && ui.button("Remove").on_hover_text("Shine evenly").clicked() {
            light.environment_map = None;
        }
    });
    if light.environment_map.is_none() {
        return;
    }
    if assets.environment(light).is_none() {
        ui.label(RichText::new("The file can't be read; the surround is even.").color(theme::bad(ui)));
    }
    row(ui, "Turned", "To the left, about the vertical", |ui| {
        NumberField::new(1.0, -360.0, 360.0, 0, "\u{b0}").ui(ui, &mut light.roll_deg)
    });
}
