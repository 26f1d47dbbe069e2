//! The gel rows of a light's inspector.

use crate::editor::ui::widgets::{self, NumberField, row};
use crate::scene::{Gel, GelFamily, LightColor};
use eframe::egui::{ComboBox, Ui};

/// Draws the gel rows.
pub(super) fn gel_rows(ui: &mut Ui, color: &mut LightColor) {
    let gel = &mut color.gel;
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
        let loss = gel.loss_stops();
        let tip = format!("The filter takes {loss:.1} stops from white light");
        row(ui, "Its loss", &tip, |ui| {
            let choices = [
                (true, "Counts", "As mounted: the meter shows the light behind the gel"),
                (false, "Made up for", "The head is turned up by the loss on the set; the meter stays"),
            ];
            widgets::choice(ui, &mut color.gel_loss_counts, &choices);
            ui.label(format!("{loss:.1} stops"));
        });
    }
}

fn family_label(family: GelFamily) -> &'static str {
    match family {
        GelFamily::Temperature => "Colour temperature",
        GelFamily::Green => "Green correction",
        GelFamily::Party => "Party colours",
    }
}
