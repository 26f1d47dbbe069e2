//! Checks the camera and the light meter.

use super::aim::check_aim;
use super::check::{Allowed, Check, POSITION, TURN};
use crate::scene::{Facing, Focus, Meter, Scene, Sensor};

pub(super) fn check_camera(scene: &Scene, check: &mut Check) {
    let camera = &scene.camera;
    check.enter("camera.".to_owned());
    check.vector("position", camera.position, POSITION);
    check_aim(scene, &camera.aim, camera.position, true, check);
    check.number("roll_deg", camera.roll_deg, TURN);
    if let Sensor::Custom { width_mm, height_mm } = camera.sensor {
        check.number("sensor.width_mm", width_mm, Allowed::between(1.0, 1000.0, "mm"));
        check.number("sensor.height_mm", height_mm, Allowed::between(1.0, 1000.0, "mm"));
    }
    check.number("focal_length_mm", camera.focal_length_mm, Allowed::between(1.0, 5000.0, "mm"));
    check.number("f_number", camera.f_number, Allowed::between(0.5, 1000.0, ""));
    check.number("shutter_s", camera.shutter_s, Allowed::between(1e-6, 1e5, "s"));
    check.number("iso", camera.iso, Allowed::between(1.0, 1e7, ""));
    check.number("nd_stops", camera.nd_stops, Allowed::between(0.0, 30.0, "stops"));
    check.number("white_balance_k", camera.white_balance_k, Allowed::between(1000.0, 25_000.0, "K"));
    match camera.focus {
        Focus::OnAim => {}
        Focus::OnObject { object, offset } => {
            check.vector("focus.offset", offset, POSITION);
            if scene.object(object).is_none() {
                check.error("focus", "the object in focus is not in the scene".to_owned());
            }
        }
        Focus::Distance(distance) => check.number("focus[0]", distance, Allowed::between(1e-3, 1e6, "m")),
    }
    check.number("meter_constant", camera.meter_constant, Allowed::between(1.0, 1e4, "lux s"));
    warn_of_nearest_focus(scene, check);
}

fn warn_of_nearest_focus(scene: &Scene, check: &mut Check) {
    let lens = scene.focused_lens();
    if let Some(focus_m) = lens.focus_m.filter(|_| lens.is_at_nearest_focus()) {
        let mm = scene.camera.focal_length_mm;
        let message = format!(
            "nearer than a lens of {mm} mm focuses; it stays at {focus_m:.3} m from the lens, {:.0}:1",
            lens.magnification
        );
        check.warning("focus", message);
    }
}

pub(super) fn check_meter(meter: &Meter, check: &mut Check) {
    check.enter("meter.".to_owned());
    check.vector("position", meter.position, POSITION);
    if let Facing::Angles { yaw_deg, pitch_deg } = meter.facing {
        check.number("facing.yaw_deg", yaw_deg, TURN);
        check.number("facing.pitch_deg", pitch_deg, Allowed::between(-90.0, 90.0, "degrees"));
    }
}
