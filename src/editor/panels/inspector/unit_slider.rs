//! The row of a slider from 0 to 1.

use crate::editor::ui::widgets::row;
use eframe::egui::{Slider, SliderClamping, Ui};

/// Draws a slider from 0 to 1.
pub fn unit_slider(ui: &mut Ui, label: &str, tip: &str, value: &mut f32) {
    row(ui, label, tip, |ui| {
        ui.spacing_mut().slider_width = (ui.available_width() - 64.0).max(60.0);
        let mut shown = *value;
        let slider = Slider::new(&mut shown, 0.0..=1.0).max_decimals(2).clamping(SliderClamping::Edits);
        if ui.add(slider.update_while_editing(false)).changed() && shown.is_finite() {
            *value = shown;
        }
    });
}
