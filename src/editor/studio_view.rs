//! The free view of the studio: an eye that orbits, pans, zooms and flies.

use crate::math;
use crate::scene::CameraFrame;
use glam::{Quat, Vec2, Vec3};

/// Half the vertical field of view, as a tangent: a 35 mm lens on full frame.
const HALF_HEIGHT: f32 = 12.0 / 35.0;
/// Radians a point of mouse travel.
const ORBIT_SPEED: f32 = 0.008;
/// Steepest look up or down, radians: straight would make left and right meaningless.
const STEEPEST: f32 = 1.55;

/// An eye on a sphere about a target.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StudioView {
    /// What the eye turns about, metres.
    pub target: Vec3,
    /// Around the vertical, radians: 0 looks from the front (+Z), growing to the right.
    pub yaw_rad: f32,
    /// Above the level, radians.
    pub pitch_rad: f32,
    /// From eye to target, metres.
    pub distance_m: f32,
}

impl Default for StudioView {
    fn default() -> Self {
        StudioView { target: Vec3::new(0.0, 1.1, 0.0), yaw_rad: 0.7, pitch_rad: 0.3, distance_m: 5.5 }
    }
}

impl StudioView {
    /// A view from `eye` that looks at `target`.
    pub fn looking(eye: Vec3, target: Vec3) -> Self {
        let away = eye - target;
        let distance_m = away.length().max(0.05);
        let up = (away.y / distance_m).clamp(-1.0, 1.0);
        StudioView {
            target,
            yaw_rad: away.x.atan2(away.z),
            pitch_rad: (std::f32::consts::FRAC_PI_2 - math::safe_acos(up)).clamp(-STEEPEST, STEEPEST),
            distance_m,
        }
    }

    /// Unit direction from the target to the eye.
    fn away(&self) -> Vec3 {
        let (sin, cos) = self.pitch_rad.sin_cos();
        Vec3::new(self.yaw_rad.sin() * cos, sin, self.yaw_rad.cos() * cos)
    }

    /// Where the eye is, metres.
    pub fn eye(&self) -> Vec3 {
        self.target + self.away() * self.distance_m
    }

    /// The frame for a view of `aspect` (width / height).
    pub fn frame(&self, aspect: f32) -> CameraFrame {
        CameraFrame {
            world_from_camera: math::look_at(self.eye(), self.target, 0.0),
            half_extent: Vec2::new(HALF_HEIGHT * aspect.max(1e-3), HALF_HEIGHT),
        }
    }

    /// Turns about the target, by mouse travel in points.
    pub fn orbit(&mut self, travel: Vec2) {
        self.yaw_rad -= travel.x * ORBIT_SPEED;
        self.pitch_rad = (self.pitch_rad + travel.y * ORBIT_SPEED).clamp(-STEEPEST, STEEPEST);
    }

    /// Looks around from where the eye is.
    pub fn look(&mut self, travel: Vec2) {
        let eye = self.eye();
        self.orbit(0.5 * travel);
        self.target = eye - self.away() * self.distance_m;
    }

    /// Shifts sideways and up, so that what lies at the target follows the mouse. Travel and height in points.
    pub fn pan(&mut self, travel: Vec2, view_height: f32) {
        let metres = 2.0 * HALF_HEIGHT * self.distance_m / view_height.max(1.0);
        let frame = self.frame(1.0).world_from_camera.matrix3;
        self.target += (Vec3::from(frame.y_axis) * travel.y - Vec3::from(frame.x_axis) * travel.x) * metres;
    }

    /// Goes closer (positive) or farther; 1 is about a notch of a wheel.
    pub fn zoom(&mut self, notches: f32) {
        self.distance_m = (self.distance_m * (-0.12 * notches).exp()).clamp(0.05, 200.0);
    }

    /// Flies: right, up and ahead in metres.
    pub fn fly(&mut self, right_up_ahead: Vec3) {
        let level = Quat::from_rotation_y(self.yaw_rad);
        let step = level * Vec3::X * right_up_ahead.x + Vec3::Y * right_up_ahead.y - self.away() * right_up_ahead.z;
        self.target += step;
    }

    /// Brings a box into view without turning.
    pub fn frame_box(&mut self, low: Vec3, high: Vec3) {
        self.target = 0.5 * (low + high);
        let radius = (0.5 * (high - low).length()).max(0.1);
        self.distance_m = (1.15 * radius / HALF_HEIGHT.atan().sin()).clamp(0.3, 200.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_view_made_from_eye_and_target_looks_that_way() {
        let (eye, target) = (Vec3::new(1.0, 2.0, 3.0), Vec3::new(-1.0, 0.5, 0.2));
        let view = StudioView::looking(eye, target);
        assert!((view.eye() - eye).length() < 1e-5);
        assert!((view.frame(1.5).forward() - (target - eye).normalize()).length() < 1e-5);
    }

    #[test]
    fn looking_around_keeps_the_eye_and_orbiting_keeps_the_target() {
        let mut view = StudioView::default();
        let eye = view.eye();
        view.look(Vec2::new(40.0, -25.0));
        assert!((view.eye() - eye).length() < 1e-5);
        let target = view.target;
        view.orbit(Vec2::new(-70.0, 9000.0));
        assert_eq!(view.target, target);
        assert!(view.frame(1.0).world_from_camera.is_finite());
    }

    #[test]
    fn panning_keeps_the_target_under_the_mouse() {
        let mut view = StudioView::default();
        let before = view.target;
        view.pan(Vec2::new(100.0, 50.0), 500.0);
        let place = view.frame(1.0).project(before).unwrap();
        assert!((place - Vec2::new(0.5 + 0.2, 0.5 + 0.1)).length() < 1e-4, "{place}");
    }

    #[test]
    fn a_framed_box_fits_the_view() {
        let mut view = StudioView::default();
        let (low, high) = (Vec3::new(-1.0, 0.0, -0.5), Vec3::new(1.0, 1.8, 0.5));
        view.frame_box(low, high);
        for i in 0..8 {
            let corner = Vec3::new([low.x, high.x][i & 1], [low.y, high.y][i >> 1 & 1], [low.z, high.z][i >> 2]);
            let place = view.frame(1.0).project(corner).unwrap();
            assert!(place.min_element() > 0.0 && place.max_element() < 1.0, "{corner} at {place}");
        }
    }
}
