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
        let (away, front) = (position - subject, front(scene, subject));
        let angle = away.x.atan2(away.z) - front.x.atan2(front.z);
        let (sin, cos) = angle.sin_cos();
        LightBearing {
            distance_m: away.length(),
            azimuth_deg: sin.atan2(cos).to_degrees(),
            elevation_deg: away.y.atan2(away.x.hypot(away.z)).to_degrees(),
        }
    }

    /// Returns the unit direction from a subject to a light at such angles, degrees.
    pub fn direction(scene: &Scene, subject: Vec3, azimuth_deg: f32, elevation_deg: f32) -> Vec3 {
        let front = front(scene, subject);
        let azimuth = front.x.atan2(front.z) + azimuth_deg.to_radians();
        let (sin_up, cos_up) = elevation_deg.to_radians().sin_cos();
        Vec3::new(azimuth.sin() * cos_up, sin_up, azimuth.cos() * cos_up)
    }
}

/// Returns the direction from a subject that counts as azimuth 0: to the camera.
fn front(scene: &Scene, subject: Vec3) -> Vec3 {
    let front = scene.camera.position - subject;
    if front.x.hypot(front.z) < STRAIGHT * front.length() {
        // Straight above or below the subject: the bottom of the picture is in front
        -Vec3::from(scene.camera_frame(1.0).world_from_camera.matrix3.y_axis)
    } else {
        front
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
        let away = LightBearing::direction(&scene, subject, -100.0, 20.0);
        let place = LightBearing::new(&scene, subject + away * 3.0, subject);
        let expected = LightBearing { distance_m: 3.0, azimuth_deg: -100.0, elevation_deg: 20.0 };
        assert!((place.azimuth_deg - expected.azimuth_deg).abs() < 1e-3, "{place:?}");
        assert!((place.elevation_deg - expected.elevation_deg).abs() < 1e-3, "{place:?}");
        let mut above = scene.clone();
        (above.camera.position, above.camera.aim) = (subject + Vec3::Y * 2.0, crate::scene::Aim::Point(subject));
        let top = -Vec3::from(above.camera_frame(1.0).world_from_camera.matrix3.y_axis);
        let place = LightBearing::new(&above, subject + top, subject);
        assert!(place.azimuth_deg.abs() < 0.1, "{place:?}");
    }
}
