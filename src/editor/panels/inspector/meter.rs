//! The inspector of the light meter.

use super::{InspectorContext, title};
use crate::editor::commands::command::Command;
use crate::editor::document::action::Action;
use crate::editor::document::item::Item;
use crate::editor::document::placement::angles_towards;
use crate::editor::ui::widgets::{self, DEGREES, METRES, row, section};
use crate::scene::{Aim, Facing, Meter, Receptor, Role, Scene};
use eframe::egui::Ui;

/// Draws the inspector of the light meter.
pub(super) fn meter_ui(ui: &mut Ui, context: &mut InspectorContext<'_>) {
    let scene = context.document.scene();
    let Some(before) = scene.meter else { return };
    let mut meter = before;
    title(ui, "Light meter", "");
    section(ui, "Receptor", true, |ui| {
        let kinds = [
            (Receptor::Flat, "Flat", "Cosine law: for ratios, and for flat things"),
            (Receptor::Dome, "Dome", "Takes light from all round but straight behind: for faces"),
        ];
        row(ui, "Kind", "What gathers the light", |ui| widgets::choice(ui, &mut meter.receptor, &kinds));
    });
    section(ui, "Place", true, |ui| {
        row(ui, "Position", "Centre of the receptor, in the room", |ui| {
            widgets::vec3_ui(ui, "Position", METRES, &mut meter.position)
        });
        facing_rows(ui, scene, &mut meter);
    });
    if ui.button("Take the meter away").clicked() {
        context.out.push(Command::Apply(Action::Delete(vec![Item::Meter])));
    }
    if meter != before {
        context.out.push(Command::Apply(Action::SetMeter(Some(meter))));
    }
}

fn facing_rows(ui: &mut Ui, scene: &Scene, meter: &mut Meter) {
    row(ui, "Faces", "Where it looks", |ui| {
        let mut follows = meter.facing == Facing::Camera;
        let ways = [(true, "The camera", "Wherever that is"), (false, "Fixed angles", "A direction of its own")];
        widgets::choice(ui, &mut follows, &ways);
        if follows != (meter.facing == Facing::Camera) {
            meter.facing = if follows { Facing::Camera } else { facing(meter.direction(scene)) };
        }
        let key = scene.lights.iter().find(|l| l.on && l.role == Role::Key && !l.emitter.is_infinite());
        let Some(key) = key.filter(|key| key.position != meter.position) else { return };
        if ui.button("To the key").on_hover_text("Turns it towards the key light as that stands now").clicked() {
            meter.facing = facing(key.position - meter.position);
        }
    });
    if let Facing::Angles { yaw_deg, pitch_deg } = &mut meter.facing {
        row(ui, "Turn", "To the left seen from above, from the back of the room", |ui| DEGREES.ui(ui, yaw_deg));
        row(ui, "Tilt", "Upwards", |ui| DEGREES.ui(ui, pitch_deg));
    }
}

fn facing(direction: glam::Vec3) -> Facing {
    match angles_towards(direction) {
        Aim::Angles { yaw_deg, pitch_deg } => Facing::Angles { yaw_deg, pitch_deg },
        Aim::Point(_) | Aim::Object { .. } => Facing::Camera,
    }
}
