//! The place of a light as a photographer says it: distance from the subject, angle round from the camera, angle up.

use crate::scene::Scene;
use glam::Vec3;

/// Sine of the angle from the vertical within which a camera is straight above or below the subject.
const STRAIGHT: f32 = 1e-3;

/// The place of a light about a subject.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightBearing {
    /// Distance, metres.
    pub distance_m: f32,
    /// Angle round from the camera's direction, degrees, positive to the camera's right.
    pub azimuth_deg: f32,
    /// Angle up from the horizontal, degrees.
    pub elevation_deg: f32,
}

impl LightBearing {
    /// Returns the place of a light at `position` about a subject, both in world space, metres.
    pub fn new(scene: &Scene, position: Vec3, subject: Vec3) -> Self {
        let (away, mut front) = (position - subject, scene.camera.position - subject);
        if front.x.hypot(front.z) < STRAIGHT * front.length() {
            // Straight above or below the subject: the bottom of the picture is in front
            front = -Vec3::from(scene.camera_frame(1.0).world_from_camera.matrix3.y_axis);
        }
        let angle = away.x.atan2(away.z) - front.x.atan2(front.z);
        let (sin, cos) = angle.sin_cos();
        LightBearing {
            distance_m: away.length(),
            azimuth_deg: sin.atan2(cos).to_degrees(),
            elevation_deg: away.y.atan2(away.x.hypot(away.z)).to_degrees(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn azimuths_are_relative_to_the_camera() {
        let (scene, subject) = (Scene::default(), Vec3::new(0.0, 1.5, 0.0));
        let place = LightBearing::new(&scene, subject + Vec3::new(1.0, 0.0, 1.0), subject);
        assert!((place.azimuth_deg - 45.0).abs() < 1e-3 && place.elevation_deg.abs() < 1e-3, "{place:?}");
        let place = LightBearing::new(&scene, subject + Vec3::new(0.0, 1.0, 1.0), subject);
        assert!((place.elevation_deg - 45.0).abs() < 1e-3 && place.azimuth_deg.abs() < 1e-3, "{place:?}");
        assert!((place.distance_m - 2.0_f32.sqrt()).abs() < 1e-6);
        let mut above = scene.clone();
        (above.camera.position, above.camera.aim) = (subject + Vec3::Y * 2.0, crate::scene::Aim::Point(subject));
        let top = -Vec3::from(above.camera_frame(1.0).world_from_camera.matrix3.y_axis);
        let place = LightBearing::new(&above, subject + top, subject);
        assert!(place.azimuth_deg.abs() < 0.1, "{place:?}");
    }
}
