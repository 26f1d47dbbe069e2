//! The free view of the studio: orbit, pan, zoom and flight of its eye, and the parallel views from the sides.

use crate::editor::commands::choices::ViewSide;
use crate::math;
use crate::scene::CameraFrame;
use glam::{Affine3A, Quat, Vec2, Vec3};
use std::f32::consts::FRAC_PI_2;

/// Half the vertical field of view, as a tangent: a 35 mm lens on full frame.
const HALF_HEIGHT: f32 = 12.0 / 35.0;
/// Radians per point of mouse travel.
const ORBIT_SPEED: f32 = 0.008;
/// Largest pitch, radians; at 90 degrees the yaw would be undefined.
const MAX_PITCH_RAD: f32 = 1.55;

/// Distance of the eye of a parallel view from its target, metres. With the matching field of view, a point 3 m before
/// or behind the target shifts by less than a thousandth of its distance from the middle (0.7 pixels at the edge of
/// 900), while single precision still resolves 0.1 mm.
const PARALLEL_EYE_M: f32 = 2000.0;

/// A view from an eye on a sphere about a target.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StudioView {
    /// Target, metres.
    pub target: Vec3,
    /// Yaw of the eye about the vertical, radians: 0 is the front (+Z), positive to the right.
    pub yaw_rad: f32,
    /// Pitch of the eye above the horizontal, radians.
    pub pitch_rad: f32,
    /// Distance from eye to target, metres.
    pub distance_m: f32,
    /// True for parallel projection.
    pub parallel: bool,
    /// Side of the view; none after an orbit.
    pub side: Option<ViewSide>,
}

impl Default for StudioView {
    fn default() -> Self {
        StudioView {
            target: Vec3::new(0.0, 1.1, 0.0),
            yaw_rad: 0.7,
            pitch_rad: 0.3,
            distance_m: 5.5,
            parallel: false,
            side: None,
        }
    }
}

impl StudioView {
    /// Returns a view from `eye` towards `target`.
    pub fn looking(eye: Vec3, target: Vec3) -> Self {
        let away = eye - target;
        let distance_m = away.length().max(0.05);
        let up = (away.y / distance_m).clamp(-1.0, 1.0);
        StudioView {
            target,
            yaw_rad: away.x.atan2(away.z),
            pitch_rad: (FRAC_PI_2 - math::safe_acos(up)).clamp(-MAX_PITCH_RAD, MAX_PITCH_RAD),
            distance_m,
            ..StudioView::default()
        }
    }

    /// Returns the unit direction from the target to the eye.
    fn away(&self) -> Vec3 {
        let (sin, cos) = self.pitch_rad.sin_cos();
        Vec3::new(self.yaw_rad.sin() * cos, sin, self.yaw_rad.cos() * cos)
    }

    /// Returns the position of the eye, metres.
    pub fn eye(&self) -> Vec3 {
        self.target + self.away() * self.distance_m
    }

    /// Returns half the height of the view at its target, metres.
    pub fn half_height_m(&self) -> f32 {
        HALF_HEIGHT * self.distance_m
    }

    /// Returns the rotation world from view: columns right, up, back. Defined even straight up and down.
    fn rotation(&self) -> Quat {
        Quat::from_rotation_y(self.yaw_rad) * Quat::from_rotation_x(-self.pitch_rad)
    }

    /// Returns the camera frame for a view of `aspect` (width / height).
    pub fn frame(&self, aspect: f32) -> CameraFrame {
        let (eye_m, half_height) = match self.parallel {
            false => (self.distance_m, HALF_HEIGHT),
            true => (PARALLEL_EYE_M, self.half_height_m() / PARALLEL_EYE_M),
        };
        let eye = self.target + self.away() * eye_m;
        CameraFrame {
            world_from_camera: Affine3A::from_rotation_translation(self.rotation(), eye),
            half_extent: Vec2::new(half_height * aspect.max(1e-3), half_height),
        }
    }

    /// Switches to the parallel view from a side, at the same scale.
    pub fn look_from(&mut self, side: ViewSide) {
        (self.yaw_rad, self.pitch_rad) = side.angles();
        (self.parallel, self.side) = (true, Some(side));
    }

    /// Switches between perspective and parallel projection and keeps the direction.
    pub fn toggle_parallel(&mut self) {
        (self.parallel, self.side) = (!self.parallel, None);
    }

    /// Orbits about the target, by mouse travel in points.
    pub fn orbit(&mut self, travel: Vec2) {
        self.orbit_about(self.target, travel);
    }

    /// Orbits about a point, whose screen position is kept. A view from a side returns to perspective.
    pub fn orbit_about(&mut self, pivot: Vec3, travel: Vec2) {
        if travel == Vec2::ZERO {
            return;
        }
        if self.side.take().is_some() {
            self.parallel = false;
        }
        let before = self.rotation();
        self.yaw_rad -= travel.x * ORBIT_SPEED;
        self.pitch_rad = (self.pitch_rad + travel.y * ORBIT_SPEED).clamp(-MAX_PITCH_RAD, MAX_PITCH_RAD);
        let turn = self.rotation() * before.inverse();
        if pivot != self.target {
            self.target = pivot + turn * (self.target - pivot);
        }
    }

    /// Turns the view about the eye; pans a view from a side.
    pub fn look(&mut self, travel: Vec2, view_height: f32) {
        if self.side.is_some() {
            self.pan(travel, view_height);
            return;
        }
        let eye = self.eye();
        self.orbit(0.5 * travel);
        self.target = eye - self.away() * self.distance_m;
    }

    /// Pans, so that the target follows the mouse. Travel and height in points.
    pub fn pan(&mut self, travel: Vec2, view_height: f32) {
        let metres = 2.0 * self.half_height_m() / view_height.max(1.0);
        self.target += self.rotation() * Vec3::new(-travel.x, travel.y, 0.0) * metres;
    }

    /// Zooms in (positive) or out; 1 is about a notch of a wheel.
    pub fn zoom(&mut self, notches: f32) {
        self.distance_m = (self.distance_m * (-0.12 * notches).exp()).clamp(0.05, 200.0);
    }

    /// Moves the view right, up and ahead, metres. In a parallel view, ahead is up.
    pub fn fly(&mut self, right_up_ahead: Vec3) {
        if self.parallel {
            let up = right_up_ahead.y + right_up_ahead.z;
            self.target += self.rotation() * Vec3::new(right_up_ahead.x, up, 0.0);
            return;
        }
        let level = Quat::from_rotation_y(self.yaw_rad);
        let step = level * Vec3::X * right_up_ahead.x + Vec3::Y * right_up_ahead.y - self.away() * right_up_ahead.z;
        self.target += step;
    }

    /// Frames a box and keeps the direction.
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
    fn a_view_from_eye_and_target_reproduces_both() {
        let (eye, target) = (Vec3::new(1.0, 2.0, 3.0), Vec3::new(-1.0, 0.5, 0.2));
        let view = StudioView::looking(eye, target);
        assert!((view.eye() - eye).length() < 1e-5);
        assert!((view.frame(1.5).forward() - (target - eye).normalize()).length() < 1e-5);
    }

    #[test]
    fn looking_around_keeps_the_eye_and_orbiting_keeps_the_target() {
        let mut view = StudioView::default();
        let eye = view.eye();
        view.look(Vec2::new(40.0, -25.0), 600.0);
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

    #[test]
    fn views_from_a_side_are_parallel_projections() {
        for side in ViewSide::ALL {
            let mut view = StudioView { target: Vec3::new(0.3, 1.0, -0.4), ..StudioView::default() };
            view.look_from(side);
            let frame = view.frame(1.5);
            assert!((frame.forward() + side.away()).length() < 1e-6, "{side:?} looks along {}", frame.forward());
            let axes = frame.world_from_camera.matrix3;
            let corner = Vec3::from(axes.x_axis) + Vec3::from(axes.y_axis);
            let at = |depth: f32| frame.project(view.target + corner + side.away() * depth).unwrap() - 0.5;
            // Less than a pixel in a view of 900.
            assert!((at(3.0) - at(-3.0)).length() * 900.0 < 1.0, "{side:?}: {} and {}", at(3.0), at(-3.0));
            let expected = Vec2::new(1.0 / 1.5, -1.0) / (2.0 * view.half_height_m());
            assert!((at(0.0) - expected).length() < 1e-4, "{side:?}: a metre is a metre, {} not {expected}", at(0.0));
        }
    }

    #[test]
    fn the_plan_has_the_back_of_the_room_up_and_the_right_on_the_right() {
        let mut view = StudioView::default();
        view.look_from(ViewSide::Top);
        let axes = view.frame(1.0).world_from_camera.matrix3;
        assert!((Vec3::from(axes.x_axis) - Vec3::X).length() < 1e-6);
        assert!((Vec3::from(axes.y_axis) - Vec3::NEG_Z).length() < 1e-6);
        view.orbit(Vec2::new(1.0, 0.0));
        assert_eq!((view.parallel, view.side), (false, None), "an orbit returns to perspective");
    }

    #[test]
    fn the_pivot_of_an_orbit_keeps_its_screen_position() {
        let mut view = StudioView::default();
        let pivot = Vec3::new(0.8, 1.7, -0.5);
        let before = view.frame(1.5).project(pivot).unwrap();
        view.orbit_about(pivot, Vec2::new(130.0, -40.0));
        let after = view.frame(1.5).project(pivot).unwrap();
        assert!((after - before).length() < 1e-4, "{before} became {after}");
    }
}
