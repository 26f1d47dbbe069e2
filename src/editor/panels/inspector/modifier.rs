//! The modifier rows of a light's inspector: modifier, size, losses, grid and barn doors.

use super::power;
use crate::editor::commands::item_menu::{HIDE_FROM_CAMERA, HIDE_TIP};
use crate::editor::document::catalog::{self, CatalogKind, CatalogTab};
use crate::editor::ui::theme;
use crate::editor::ui::widgets::{NumberField, SIZE_CM, fact, row};
use crate::photo::beam::{Beam, beam_loss_stops};
use crate::photo::emitter::EmitterShape;
use crate::scene::{
    Assets, BarnDoors, Bodies, BodyChoice, Cone, Emitter, HARD_GRIDS_DEG, Light, Modifier, ModifierShape,
    NamedModifier, SOFT_GRIDS_DEG, Scene,
};
use eframe::egui::{ComboBox, RichText, Ui};

const CONE: NumberField = NumberField::new(0.5, 0.5, 180.0, 1, "\u{b0}");
const FLAP: NumberField = NumberField::new(0.5, 0.0, 90.0, 0, "\u{b0}");
const STOPS: NumberField = NumberField::new(0.02, 0.0, 10.0, 1, " stops");

/// Draws the rows of modifier and size.
pub(super) fn kind_rows(ui: &mut Ui, scene: &Scene, assets: &Assets, light: &mut Light) {
    kind_row(ui, scene, assets, light);
    size_rows(ui, &mut light.emitter);
}

/// Draws the rows of losses, grid, barn doors, visibility and body.
pub(super) fn modifier_rows(ui: &mut Ui, scene: &Scene, light: &mut Light) {
    if light.emitter != Emitter::Surround {
        loss_rows(ui, light);
    }
    row(ui, "In the picture", "Mirrors and glass always show it", |ui| {
        ui.checkbox(&mut light.visible_to_camera, "Camera sees it");
    });
    if ModifierShape::of(light).is_some() {
        body_rows(ui, scene, light);
    }
}

/// Draws the rows of the light's body: modifier, head and stand.
fn body_rows(ui: &mut Ui, scene: &Scene, light: &mut Light) {
    let as_studio = format!("As the studio ({})", scene.bodies.label().to_lowercase());
    let label = |choice| match choice {
        BodyChoice::AsStudio => as_studio.as_str(),
        BodyChoice::On => Bodies::On.label(),
        BodyChoice::InReflections => Bodies::InReflections.label(),
        BodyChoice::Off => Bodies::Off.label(),
    };
    let tip = "Modifier, head and stand: what blocks the light of others and shows in chrome";
    row(ui, "Body", tip, |ui| {
        let list = ComboBox::from_id_salt("body").selected_text(label(light.body)).width(ui.available_width() - 8.0);
        list.show_ui(ui, |ui| {
            for choice in BodyChoice::ALL {
                ui.selectable_value(&mut light.body, choice, label(choice));
            }
        });
    });
    if scene.is_body_in_picture(light) {
        row(ui, "", "Some of it is inside of the frame, unless something hides it", |ui| {
            ui.label(RichText::new("It stands in the picture.").color(theme::bad(ui)).small());
            if ui.button(HIDE_FROM_CAMERA).on_hover_text(HIDE_TIP).clicked() {
                light.hide_from_camera();
            }
        });
    }
}

/// Draws the list of named modifiers; other lights show the name of their emitter.
fn kind_row(ui: &mut Ui, scene: &Scene, assets: &Assets, light: &mut Light) {
    let listed = catalog::entries(CatalogTab::Lights).iter();
    let is_current = |e: &catalog::CatalogEntry| matches!(e.kind, CatalogKind::Light(emitter, modifier, _) if emitter == light.emitter && modifier == light.modifier);
    let known = NamedModifier::of(&light.emitter, &light.modifier).map(|named| named.name);
    let known = known.or_else(|| listed.clone().find(|e| is_current(e)).map(|e| e.name));
    // A softbox with another loss keeps its name.
    let by_shape = NamedModifier::ALL.iter().find(|named| {
        let of_same_beam = Modifier { loss_stops: named.modifier.loss_stops, ..light.modifier };
        named.emitter == light.emitter && named.modifier == Modifier { scrim_stops: 0.0, ..of_same_beam }
    });
    let shown = known.or(by_shape.map(|named| named.name)).filter(|_| light.photometric_file.is_none());
    row(ui, "Modifier", "What shapes the light. Choosing another keeps the head's power.", |ui| {
        let current = shown.unwrap_or_else(|| light.emitter.label());
        let width = ui.available_width() - 8.0;
        let list = ComboBox::from_id_salt("emitter").selected_text(current).width(width).height(420.0);
        list.show_ui(ui, |ui| {
            for entry in listed {
                let CatalogKind::Light(emitter, modifier, _) = entry.kind else { continue };
                let label = ui.selectable_label(known == Some(entry.name), entry.name);
                if label.on_hover_text(entry.tip).clicked() {
                    power::change_emitter(scene, assets, light, emitter, modifier);
                }
            }
            if ui.selectable_label(light.emitter == Emitter::Point, "Point").clicked() {
                power::change_emitter(scene, assets, light, Emitter::Point, Modifier::default());
            }
        });
    });
}

fn size_rows(ui: &mut Ui, emitter: &mut Emitter) {
    match emitter {
        Emitter::Point | Emitter::Surround => {}
        Emitter::Sphere { radius_m } => {
            row(ui, "Diameter", "Of the bulb", |ui| SIZE_CM.scaled_ui(ui, radius_m, 200.0));
        }
        Emitter::RectPanel { width_m, height_m } => {
            row(ui, "Size", "Width and height of the shining area", |ui| {
                ui.name_inputs("Width", |ui| SIZE_CM.scaled_ui(ui, width_m, 100.0));
                ui.label("\u{d7}");
                ui.name_inputs("Height", |ui| SIZE_CM.scaled_ui(ui, height_m, 100.0));
            });
        }
        Emitter::RoundPanel { diameter_m } => {
            row(ui, "Diameter", "Of the shining area", |ui| SIZE_CM.scaled_ui(ui, diameter_m, 100.0));
        }
        Emitter::Spot { inner_deg, outer_deg } => {
            row(ui, "Even cone", "Full angle of the even part", |ui| CONE.ui(ui, inner_deg));
            row(ui, "Outer cone", "Full angle where the light ends; equal to the even cone it has a hard edge", |ui| {
                CONE.ui(ui, outer_deg)
            });
            *inner_deg = inner_deg.min(*outer_deg);
        }
        Emitter::Sun { angular_diameter_deg } => {
            let field = NumberField::new(0.02, 0.0, 90.0, 2, "\u{b0}");
            row(ui, "Disc", "Angular diameter: 0.53\u{b0} is the sun, 0 gives hard shadows", |ui| {
                field.ui(ui, angular_diameter_deg)
            });
        }
    }
}

fn loss_rows(ui: &mut Ui, light: &mut Light) {
    let modifier = &mut light.modifier;
    row(ui, "Loss", "Light that cloth, dish or umbrella swallows: 1 to 2 stops for a softbox", |ui| {
        STOPS.ui(ui, &mut modifier.loss_stops)
    });
    row(ui, "Scrim", "Net, silk or frost before it", |ui| {
        STOPS.ui(ui, &mut modifier.scrim_stops);
        for stops in [0.0, 0.5, 1.0, 2.0] {
            if ui.selectable_label(modifier.scrim_stops == stops, format!("{stops}")).clicked() {
                modifier.scrim_stops = stops;
            }
        }
    });
    if light.emitter.is_infinite() {
        return;
    }
    grid_row(ui, &light.emitter, &mut light.modifier);
    if let Some(Cone { inner_deg, outer_deg }) = &mut light.modifier.beam {
        row(ui, "Beam", "Full angles where its dish or tube begins to cut, and where its light ends", |ui| {
            ui.name_inputs("Even beam", |ui| CONE.ui(ui, inner_deg));
            ui.label("to");
            ui.name_inputs("Whole beam", |ui| CONE.ui(ui, outer_deg));
        });
        *inner_deg = inner_deg.min(*outer_deg);
    }
    doors_rows(ui, &mut light.modifier);
    if let Some(beam) = Beam::new(&light.modifier) {
        let lost = beam_loss_stops(&EmitterShape::new(&light.emitter), Some(&beam));
        let tip = "Light that grid, dish or flaps keep from the sides. The axis is as bright as without them.";
        fact(ui, "Beside it", tip, format!("{lost:.1} stops of the light are lost"));
    }
}

fn grid_row(ui: &mut Ui, emitter: &Emitter, modifier: &mut Modifier) {
    let soft = matches!(emitter, Emitter::RectPanel { .. } | Emitter::RoundPanel { .. });
    let sold: &[f32] = if soft { &SOFT_GRIDS_DEG } else { &HARD_GRIDS_DEG };
    row(ui, "Grid", "A honeycomb: keeps light from the sides. The axis stays as it is.", |ui| {
        let text = modifier.grid_deg.map_or("None".to_owned(), |deg| format!("{deg:.0}\u{b0}"));
        ComboBox::from_id_salt("grid").selected_text(text).width(72.0).show_ui(ui, |ui| {
            ui.selectable_value(&mut modifier.grid_deg, None, "None");
            for &deg in sold {
                ui.selectable_value(&mut modifier.grid_deg, Some(deg), format!("{deg:.0}\u{b0}"));
            }
        });
        if let Some(deg) = &mut modifier.grid_deg {
            ui.name_inputs("Grid angle", |ui| CONE.ui(ui, deg));
        }
    });
}

fn doors_rows(ui: &mut Ui, modifier: &mut Modifier) {
    row(ui, "Barn doors", "Four flaps, each opened so far from the axis; 90\u{b0} is out of the way", |ui| {
        let mut mounted = modifier.doors.is_some();
        ui.checkbox(&mut mounted, "Mounted");
        if mounted != modifier.doors.is_some() {
            modifier.doors = mounted.then_some(BarnDoors::HALF_OPEN);
        }
    });
    if let Some(BarnDoors { left_deg, right_deg, top_deg, bottom_deg }) = &mut modifier.doors {
        for (label, one, first, other, second) in [
            ("Left, right", "Left flap", left_deg, "Right flap", right_deg),
            ("Up, down", "Upper flap", top_deg, "Lower flap", bottom_deg),
        ] {
            row(ui, label, "As seen from behind the light", |ui| {
                ui.name_inputs(one, |ui| FLAP.ui(ui, first));
                ui.name_inputs(other, |ui| FLAP.ui(ui, second));
            });
        }
    }
}
