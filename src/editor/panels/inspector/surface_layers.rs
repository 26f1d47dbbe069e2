//! The rows of lacquer, sheen, brushing, frosting and translucency.

use super::unit_slider::unit_slider;
use crate::editor::ui::widgets::{self, NumberField, row};
use crate::scene::{Anisotropy, Clearcoat, Material, Sheen};
use eframe::egui::Ui;

/// Draws the rows of what a surface has besides its base.
pub fn layer_rows(ui: &mut Ui, material: &mut Material) {
    let tip = "A layer of clear lacquer, which reflects by itself: car paint, varnish, glaze";
    if optional_row(ui, "Lacquer", ("Has lacquer", tip), &mut material.clearcoat, Clearcoat::POLISHED)
        && let Some(Clearcoat { amount, roughness }) = &mut material.clearcoat
    {
        unit_slider(ui, "Lacquered", "How much of the surface has the lacquer", amount);
        unit_slider(ui, "Lacquer roughness", "0 is polished, 1 is matte", roughness);
    }
    let tip = "Light of short standing fibres, seen along the edges: velvet, felt, peach skin";
    let sheen = Sheen { color: [0.5; 3], roughness: 0.4 };
    if optional_row(ui, "Sheen", ("Has sheen", tip), &mut material.sheen, sheen)
        && let Some(Sheen { color, roughness }) = &mut material.sheen
    {
        row(ui, "Sheen colour", "The colour along the edges", |ui| widgets::color_ui(ui, color));
        unit_slider(ui, "Sheen width", "0 is a narrow rim, 1 covers all of the surface", roughness);
    }
    let tip = "Highlights are wide across the grooves and narrow along them: brushed and turned metal";
    let anisotropy = Anisotropy { strength: 0.6, rotation_deg: 0.0 };
    if optional_row(ui, "Brushing", ("Is brushed", tip), &mut material.anisotropy, anisotropy)
        && let Some(Anisotropy { strength, rotation_deg }) = &mut material.anisotropy
    {
        unit_slider(ui, "Brushed", "How much wider highlights are across the grooves", strength);
        row(ui, "Across", "Direction across the grooves, from the texture's horizontal", |ui| {
            NumberField::new(1.0, -360.0, 360.0, 0, "\u{b0}").ui(ui, rotation_deg)
        });
    }
    if material.transmission > 0.0 {
        unit_slider(ui, "Frosting", "0 is clear, 0.3 etched or ground glass", &mut material.frosting);
    } else {
        let tip = "How much of the diffuse light leaves on the far side: 0 is opaque, a half tracing paper or a scrim";
        unit_slider(ui, "Translucent", tip, &mut material.translucency);
    }
}

/// Draws the switch of a layer that a surface may have. Returns true if it has it.
fn optional_row<T: Copy>(
    ui: &mut Ui,
    label: &str,
    (text, tip): (&str, &str),
    layer: &mut Option<T>,
    default: T,
) -> bool {
    row(ui, label, tip, |ui| {
        let mut is_there = layer.is_some();
        if ui.checkbox(&mut is_there, text).changed() {
            *layer = is_there.then_some(default);
        }
    });
    layer.is_some()
}
