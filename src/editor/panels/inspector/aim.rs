//! The aim rows of lights and camera.

use crate::editor::document::placement::{aim_offset, angles_towards, subject};
use crate::editor::ui::widgets::{self, DEGREES, METRES, row};
use crate::scene::{Aim, Assets, Scene};
use eframe::egui::{ComboBox, Ui};
use glam::Vec3;

/// Draws the rows of an aim from `position`.
pub fn aim_rows(ui: &mut Ui, scene: &Scene, assets: &Assets, position: Vec3, aim: &mut Aim) {
    let now = scene.aim_point(aim, position);
    row(ui, "Aims at", "What it points at. Aimed at a thing, it follows the thing.", |ui| {
        let current = match aim {
            Aim::Point(_) => "A point".to_owned(),
            Aim::Angles { .. } => "Fixed angles".to_owned(),
            Aim::Object { object, .. } => {
                scene.object(*object).map_or_else(|| "Nothing".to_owned(), |o| o.name.clone())
            }
        };
        ComboBox::from_id_salt("aim").selected_text(current).width(ui.available_width() - 8.0).show_ui(ui, |ui| {
            if ui.selectable_label(matches!(aim, Aim::Point(_)), "A point").clicked() {
                *aim = Aim::Point(now);
            }
            if ui.selectable_label(matches!(aim, Aim::Angles { .. }), "Fixed angles").clicked() {
                *aim = angles_towards(now - position);
            }
            ui.separator();
            for object in &scene.objects {
                let is_it = matches!(aim, Aim::Object { object: at, .. } if *at == object.id);
                if ui.selectable_label(is_it, &object.name).clicked() && !is_it {
                    *aim = Aim::Object { object: object.id, offset: aim_offset(object, assets) };
                }
            }
        });
    });
    lock_row(ui, scene, now, aim);
    match aim {
        Aim::Point(point) => {
            row(ui, "Aim point", "Where it points, in the room", |ui| widgets::vec3_ui(ui, "Aim point", METRES, point));
        }
        Aim::Object { offset, .. } => {
            let tip = "The point on the thing, from its origin along its own axes: a face, say";
            row(ui, "Point on it", tip, |ui| widgets::vec3_ui(ui, "Point on it", METRES, offset));
        }
        Aim::Angles { yaw_deg, pitch_deg } => {
            row(ui, "Turn", "To the left seen from above, from the back of the room", |ui| DEGREES.ui(ui, yaw_deg));
            row(ui, "Tilt", "Upwards", |ui| DEGREES.ui(ui, pitch_deg));
        }
    }
}

/// Draws the lock that keeps an aim on its object.
fn lock_row(ui: &mut Ui, scene: &Scene, now: Vec3, aim: &mut Aim) {
    let held = if let Aim::Object { object, .. } = aim { Some(*object) } else { None };
    let subject = held.or_else(|| subject(scene, None)).and_then(|id| scene.object(id));
    let Some(subject) = subject else { return };
    row(ui, "Aim lock", "Keeps it on its point of the thing, whichever of the two moves", |ui| {
        let mut locked = held.is_some();
        ui.checkbox(&mut locked, format!("Stays on {}", subject.name));
        if locked == held.is_some() {
            return;
        }
        let offset = subject.transform.world_from_object().inverse().transform_point3(now);
        *aim = if locked && offset.is_finite() { Aim::Object { object: subject.id, offset } } else { Aim::Point(now) };
    });
}
