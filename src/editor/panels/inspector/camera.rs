//! The inspector of the camera.

use super::light::kelvin_row;
use super::{InspectorContext, aim, title};
use crate::editor::commands::command::Command;
use crate::editor::document::action::Action;
use crate::editor::document::placement::aim_offset;
use crate::editor::ui::widgets::{self, DEGREES, DISTANCE, METRES, NumberField, dial_ui, fact, row, section};
use crate::photo::exposure;
use crate::photo::thirds::Dial;
use crate::scene::{Assets, Camera, Focus, Orientation, Scene, Sensor};
use eframe::egui::{ComboBox, Ui};

/// Draws the inspector of the camera.
pub(super) fn camera_ui(ui: &mut Ui, context: &mut InspectorContext<'_>) {
    let (scene, assets) = (context.document.scene(), context.document.assets());
    let mut camera = scene.camera.clone();
    title(ui, "Camera", "");
    section(ui, "Exposure", true, |ui| exposure_rows(ui, &mut camera));
    section(ui, "Lens and sensor", true, |ui| lens_rows(ui, scene, &mut camera));
    section(ui, "Place and aim", true, |ui| {
        row(ui, "Position", "Centre of the lens, in the room", |ui| {
            widgets::vec3_ui(ui, "Position", METRES, &mut camera.position)
        });
        distance_row(ui, scene, &mut camera);
        aim::aim_rows(ui, scene, assets, camera.position, &mut camera.aim);
        row(ui, "Roll", "Turn about the lens axis, clockwise", |ui| DEGREES.ui(ui, &mut camera.roll_deg));
    });
    section(ui, "Focus", true, |ui| focus_rows(ui, scene, assets, &mut camera));
    section(ui, "Meter", false, |ui| {
        let field = NumberField::new(1.0, 50.0, 1000.0, 0, " lx s");
        let tip = "Calibration constant C of the incident meter: 250 for a flat receptor, 340 for many domes";
        row(ui, "Constant C", tip, |ui| field.ui(ui, &mut camera.meter_constant));
    });
    if camera != scene.camera {
        context.out.push(Command::Apply(Action::SetCamera(Box::new(camera))));
    }
}

fn exposure_rows(ui: &mut Ui, camera: &mut Camera) {
    row(ui, "Aperture", "f-number, in thirds of a stop", |ui| {
        dial_ui(ui, "Aperture", Dial::FNumber, &mut camera.f_number)
    });
    let tip = "Exposure time. It does not change the light of a flash, only continuous light.";
    row(ui, "Shutter", tip, |ui| dial_ui(ui, "Shutter", Dial::Shutter, &mut camera.shutter_s));
    row(ui, "ISO", "Speed of the sensor", |ui| dial_ui(ui, "ISO", Dial::Iso, &mut camera.iso));
    kelvin_row(ui, "White balance", &mut camera.white_balance_k);
    let c = camera.meter_constant;
    let lux_s = c * camera.f_number * camera.f_number / camera.iso;
    let ev = exposure::ev100(lux_s / camera.shutter_s, c);
    let tip = "What a grey card needs at these settings: exposure value at ISO 100, lux of continuous light, lux seconds of flash";
    let lux = widgets::three_digits(lux_s / camera.shutter_s);
    fact(ui, "Needs", tip, format!("EV {ev:.1}  ({lux} lx, or {} lx s)", widgets::three_digits(lux_s)));
}

/// Focal lengths of prime lenses, millimetres.
const PRIMES: [f32; 12] = [14.0, 20.0, 24.0, 28.0, 35.0, 50.0, 70.0, 85.0, 105.0, 135.0, 200.0, 300.0];

fn lens_rows(ui: &mut Ui, scene: &Scene, camera: &mut Camera) {
    row(ui, "Lens", "Focal length", |ui| {
        NumberField::new(0.5, 4.0, 2000.0, 1, " mm").ui(ui, &mut camera.focal_length_mm);
        let menu = ui.menu_button("Primes", |ui| {
            for mm in PRIMES {
                if ui.button(format!("{mm} mm")).clicked() {
                    camera.focal_length_mm = mm;
                }
            }
        });
        menu.response.on_hover_text("The lengths that lenses come in");
    });
    row(ui, "Sensor", "Size of the picture area", |ui| {
        let named = Sensor::NAMED.iter().find(|(_, each)| *each == camera.sensor);
        let current = named.map_or("Custom", |(name, _)| *name);
        ComboBox::from_id_salt("sensor").selected_text(current).width(ui.available_width() - 8.0).show_ui(ui, |ui| {
            for (name, each) in Sensor::NAMED {
                ui.selectable_value(&mut camera.sensor, each, name);
            }
            if ui.selectable_label(named.is_none(), "Custom").clicked() {
                let size = camera.sensor.size_mm();
                camera.sensor = Sensor::Custom { width_mm: size.x, height_mm: size.y };
            }
        });
    });
    if let Sensor::Custom { width_mm, height_mm } = &mut camera.sensor {
        row(ui, "Size", "Long and short side", |ui| {
            let field = NumberField::new(0.1, 1.0, 300.0, 1, " mm");
            ui.name_inputs("Sensor width", |ui| field.ui(ui, width_mm));
            ui.name_inputs("Sensor height", |ui| field.ui(ui, height_mm));
        });
    }
    let held = [
        (Orientation::Landscape, "Landscape", "Long side level"),
        (Orientation::Portrait, "Portrait", "Turned upright"),
    ];
    row(ui, "Held", "How the camera is held", |ui| widgets::choice(ui, &mut camera.orientation, &held));
    let target = scene.aim_point(&camera.aim, camera.position);
    let field = camera.frame(target, camera.aspect()).half_extent * 2.0 * (target - camera.position).length();
    fact(
        ui,
        "Field",
        "What fits into the picture at the distance of the aim",
        format!("{:.2} \u{d7} {:.2} m", field.x, field.y),
    );
}

fn distance_row(ui: &mut Ui, scene: &Scene, camera: &mut Camera) {
    let target = scene.aim_point(&camera.aim, camera.position);
    let away = camera.position - target;
    let (before, mut distance) = (away.length(), away.length());
    let tip = "To the subject: changing it moves the camera along the lens axis";
    row(ui, "Distance", tip, |ui| DISTANCE.ui(ui, &mut distance));
    if distance != before && before > 1e-3 {
        camera.position = target + away * (distance / before);
    }
}

fn focus_rows(ui: &mut Ui, scene: &Scene, assets: &Assets, camera: &mut Camera) {
    row(ui, "Blur", "Whether the aperture blurs what is out of focus", |ui| {
        ui.checkbox(&mut camera.depth_of_field, "Depth of field")
            .on_hover_text("On: a real lens. Off: everything is sharp, and renders have less noise.");
    });
    let at = focus_distance(scene, camera);
    row(ui, "Focus on", "What is sharp", |ui| {
        let current = match camera.focus {
            Focus::OnAim => "The aim".to_owned(),
            Focus::Distance(_) => "A distance".to_owned(),
            Focus::OnObject { object, .. } => scene.object(object).map_or_else(String::new, |o| o.name.clone()),
        };
        ComboBox::from_id_salt("focus").selected_text(current).width(ui.available_width() - 8.0).show_ui(ui, |ui| {
            ui.selectable_value(&mut camera.focus, Focus::OnAim, "The aim");
            if ui.selectable_label(matches!(camera.focus, Focus::Distance(_)), "A distance").clicked() {
                camera.focus = Focus::Distance(at);
            }
            for object in &scene.objects {
                let is_it = matches!(camera.focus, Focus::OnObject { object: on, .. } if on == object.id);
                if ui.selectable_label(is_it, &object.name).clicked() {
                    camera.focus = Focus::OnObject { object: object.id, offset: aim_offset(object, assets) };
                }
            }
        });
    });
    match &mut camera.focus {
        Focus::Distance(distance) => drop(row(ui, "At", "Along the lens axis", |ui| DISTANCE.ui(ui, distance))),
        Focus::OnAim | Focus::OnObject { .. } => fact(ui, "At", "Along the lens axis", format!("{at:.2} m")),
    }
    if camera.depth_of_field {
        let (near, far) = sharp_range(camera, at);
        let far = if far.is_finite() { format!("{far:.2} m") } else { "infinity".to_owned() };
        let tip = "Blur circles up to 1/1500 of the sensor's diagonal";
        fact(ui, "Sharp", tip, format!("{near:.2} m to {far}"));
    }
}

/// Returns the distance of the plane of focus along the optical axis, metres.
fn focus_distance(scene: &Scene, camera: &Camera) -> f32 {
    let target = scene.aim_point(&camera.aim, camera.position);
    let point = match camera.focus {
        Focus::Distance(distance) => return distance,
        Focus::OnAim => target,
        Focus::OnObject { object, offset } => {
            scene.aim_point(&crate::scene::Aim::Object { object, offset }, camera.position)
        }
    };
    let axis = camera.frame(target, 1.0).forward();
    (point - camera.position).dot(axis).max(0.01)
}

/// Returns the near and far limit of the depth of field for focus at `distance_m`: thin lens, circle of confusion of
/// 1/1500 of the diagonal. The far limit is infinite from the hyperfocal distance on.
fn sharp_range(camera: &Camera, distance_m: f32) -> (f32, f32) {
    let focal_m = camera.focal_length_mm * 1e-3;
    let circle_m = camera.sensor.size_mm().length() / 1500.0 * 1e-3;
    let hyperfocal = focal_m * focal_m / (camera.f_number * circle_m) + focal_m;
    let reach = distance_m - focal_m;
    let near = hyperfocal * distance_m / (hyperfocal + reach);
    let far = if reach < hyperfocal { hyperfocal * distance_m / (hyperfocal - reach) } else { f32::INFINITY };
    (near, far)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn depth_of_field_matches_lens_tables() {
        // 85 mm f/5.6 at 3 m on full frame, c = 0.029 mm: 2.83 to 3.20 m.
        let (near, far) = sharp_range(&Camera::default(), 3.0);
        assert!((near - 2.81).abs() < 0.03 && (far - 3.21).abs() < 0.03, "{near} {far}");
        let wide = Camera { focal_length_mm: 20.0, f_number: 16.0, ..Camera::default() };
        assert_eq!(sharp_range(&wide, 3.0).1, f32::INFINITY);
    }
}
