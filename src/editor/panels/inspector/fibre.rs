//! The rows of a fibre: the hair that strands of a material are.

use super::unit_slider::unit_slider;
use crate::editor::ui::widgets::{self, row};
use crate::scene::{Fibre, FibreColor};
use eframe::egui::{ComboBox, Ui};

/// Roughness along the fibre of hair without shine, and of the shiniest.
const SHINE: [f32; 2] = [0.8, 0.1];

/// Draws the rows of a fibre.
pub fn fibre_rows(ui: &mut Ui, fibre: &mut Option<Fibre>) {
    let tip = "Strands of this material are hair, which lets light through and shines along the strand. Surfaces of it \
               show the colour above";
    row(ui, "Hair", tip, |ui| {
        let mut is_hair = fibre.is_some();
        if ui.checkbox(&mut is_hair, "Strands are hair").changed() {
            *fibre = is_hair.then(Fibre::default);
        }
    });
    let Some(fibre) = fibre else { return };
    color_rows(ui, &mut fibre.color);
    // Roughness outside of the range, from a file, stays until the slider is moved
    let mut shine = ((fibre.roughness_along - SHINE[0]) / (SHINE[1] - SHINE[0])).clamp(0.0, 1.0);
    let before = shine;
    unit_slider(ui, "Shine", "0 is dull, 0.7 healthy, 1 wet or oiled hair", &mut shine);
    if shine != before {
        fibre.roughness_along = SHINE[0] + shine * (SHINE[1] - SHINE[0]);
    }
    let tip = "How wide light spreads around each strand: 0.1 is nylon, 0.3 human hair, 1 wool";
    unit_slider(ui, "Softness", tip, &mut fibre.roughness_around);
    fibre.roughness_around = fibre.roughness_around.max(0.05);
}

fn color_rows(ui: &mut Ui, color: &mut FibreColor) {
    row(ui, "Hair colour", "Natural pigment, or a dye", |ui| {
        let is_dye = matches!(color, FibreColor::Dye(_));
        let name = |is_dye| if is_dye { "Dyed" } else { "Natural" };
        ComboBox::from_id_salt("hair colour").selected_text(name(is_dye)).show_ui(ui, |ui| {
            if ui.selectable_label(!is_dye, name(false)).clicked() && is_dye {
                *color = Fibre::default().color;
            }
            if ui.selectable_label(is_dye, name(true)).clicked() && !is_dye {
                *color = FibreColor::Dye([0.5, 0.1, 0.15]);
            }
        });
    });
    match color {
        FibreColor::Melanin { melanin, redness } => {
            let tip = "Amount of pigment: 0 is white, 0.25 blond, 0.7 brown, 1 black hair";
            unit_slider(ui, "Melanin", tip, melanin);
            unit_slider(ui, "Redness", "Part of red pigment: 0 is ash, 0.2 warm, 1 ginger", redness);
        }
        FibreColor::Dye(dye) => {
            row(ui, "Dye", "The colour of a full head of such hair in white light", |ui| {
                widgets::color_ui(ui, dye);
            });
            *dye = dye.map(|c| c.min(0.99));
        }
    }
}
