//! Checks the aim of the camera and of lights.

use super::check::{Allowed, Check, POSITION, TURN};
use crate::scene::{Aim, Scene};
use glam::Vec3;

/// Checks an aim. With `has_direction`, aiming at the own position is an error.
pub(super) fn check_aim(scene: &Scene, aim: &Aim, position: Vec3, has_direction: bool, check: &mut Check) {
    match *aim {
        Aim::Point(point) => check.vector("aim", point, POSITION),
        Aim::Object { object, offset } => {
            check.vector("aim.offset", offset, POSITION);
            if scene.object(object).is_none() {
                return check.error("aim", "the object aimed at is not in the scene".to_owned());
            }
        }
        Aim::Angles { yaw_deg, pitch_deg } => {
            check.number("aim.yaw_deg", yaw_deg, TURN);
            check.number("aim.pitch_deg", pitch_deg, Allowed::between(-90.0, 90.0, "degrees"));
        }
    }
    let offset = scene.aim_vector(aim, position);
    if has_direction && position.is_finite() && offset.is_finite() && offset.length() < 1e-5 {
        check.error("aim", format!("it aims at its own place {position}, which is no direction"));
    }
}
