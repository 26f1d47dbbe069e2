//! The gel rows of a light's inspector.

use crate::editor::ui::widgets::{self, NumberField, fact, row};
use crate::scene::{Gel, GelFamily};
use eframe::egui::{ComboBox, Ui};

/// Draws the gel rows.
pub(super) fn gel_rows(ui: &mut Ui, gel: &mut Gel) {
    let current = gel.name().unwrap_or(match gel {
        Gel::None => "None",
        Gel::Mired(_) => "Other mired shift",
        Gel::Tint(_) => "Other colour",
    });
    row(ui, "Gel", "A filter before the light: CTO warms, CTB cools, plus and minus green, party colours", |ui| {
        ComboBox::from_id_salt("gel").selected_text(current).height(420.0).show_ui(ui, |ui| {
            ui.selectable_value(gel, Gel::None, "None");
            let mut family = None;
            for named in Gel::NAMED {
                if family != Some(named.family) {
                    family = Some(named.family);
                    ui.separator();
                    ui.weak(family_label(named.family));
                }
                ui.selectable_value(gel, named.gel, named.name);
            }
            ui.separator();
            if ui.selectable_label(current == "Other mired shift", "Other mired shift").clicked() {
                *gel = Gel::Mired(50.0);
            }
            if ui.selectable_label(current == "Other colour", "Other colour").clicked() {
                *gel = Gel::Tint([0.9, 0.1, 0.1]);
            }
        });
        let named = gel.name().is_some();
        match gel {
            Gel::Tint(rgb) => drop(widgets::color_ui(ui, rgb)),
            Gel::Mired(shift) if !named => {
                let field = NumberField::new(1.0, -400.0, 400.0, 0, " mired");
                ui.name_inputs("Mired shift", |ui| field.ui(ui, shift));
            }
            _ => {}
        }
    });
    if *gel != Gel::None {
        let tip =
            "What the real filter takes from white light. It is not taken from the power here: turn up the head by it.";
        fact(ui, "Gel costs", tip, format!("{:.1} stops on the set", gel.loss_stops()));
    }
}

fn family_label(family: GelFamily) -> &'static str {
    match family {
        GelFamily::Temperature => "Colour temperature",
        GelFamily::Green => "Green correction",
        GelFamily::Party => "Party colours",
    }
}
