//! The view that handles lie in: from world space to points of the screen, and from the pointer to lines and planes.

use crate::editor::viewport::overlays::markers::place_of;
use crate::scene::CameraFrame;
use eframe::egui::{Pos2, Rect};
use glam::{DVec3, Vec2, Vec3};

/// Smallest sine of the angle between the line of sight and a line or plane that is followed.
const MIN_ANGLE_SIN: f64 = 1e-3;

/// The view of the handles.
#[derive(Clone, Copy, Debug)]
pub struct HandleView<'a> {
    /// Camera frame of the view.
    pub frame: &'a CameraFrame,
    /// Rectangle of the view, points.
    pub rect: Rect,
}

impl HandleView<'_> {
    /// Returns the screen position of a world-space point; none behind the eye or far outside of the view.
    pub fn place(&self, point: Vec3) -> Option<Pos2> {
        place_of(self.frame, self.rect, point)
    }

    /// Returns the unit direction from a world-space point to the eye.
    pub fn towards_eye(&self, point: Vec3) -> Vec3 {
        (self.frame.position() - point).normalize_or(-self.frame.forward())
    }

    /// Returns the world-space size of a point of the screen at the depth of `place`, metres.
    pub fn metres_a_point(&self, place: Vec3) -> f32 {
        let depth_m = (place - self.frame.position()).dot(self.frame.forward());
        2.0 * self.frame.half_extent.y * depth_m.max(0.01) / self.rect.height().max(1.0)
    }

    /// Returns the eye and the unit direction of sight through a screen position. In double precision: the eye of a
    /// parallel view is kilometres away.
    fn ray(&self, position: Pos2) -> (DVec3, DVec3) {
        let at = (position - self.rect.min) / self.rect.size();
        let direction = self.frame.direction(Vec2::new(at.x, at.y)).as_dvec3();
        (self.frame.position().as_dvec3(), direction.normalize())
    }

    /// Returns the distance along a line, from `origin` in the unit direction `direction`, of its point nearest to the
    /// ray through a screen position, metres; none if the line runs along the line of sight.
    pub fn along_line(&self, origin: Vec3, direction: Vec3, position: Pos2) -> Option<f32> {
        let (eye, sight) = self.ray(position);
        let (direction, from_eye) = (direction.as_dvec3(), origin.as_dvec3() - eye);
        let cos = direction.dot(sight);
        let sin_squared = 1.0 - cos * cos;
        let along = (from_eye.dot(sight) * cos - from_eye.dot(direction)) / sin_squared;
        (sin_squared > MIN_ANGLE_SIN * MIN_ANGLE_SIN && along.is_finite()).then_some(along as f32)
    }

    /// Returns the point of a plane at a screen position, world space; none if the plane is behind the eye there.
    pub fn on_plane(&self, origin: Vec3, normal: Vec3, position: Pos2) -> Option<Vec3> {
        let (eye, sight) = self.ray(position);
        let (origin, normal) = (origin.as_dvec3(), normal.as_dvec3());
        let distance = (origin - eye).dot(normal) / sight.dot(normal);
        // A plane that is seen edge-on gives an infinity or NaN, and none.
        (distance > 0.0 && distance.is_finite()).then(|| (eye + sight * distance).as_vec3())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::editor::commands::choices::ViewSide;
    use crate::editor::viewport::studio_view::StudioView;
    use eframe::egui::{pos2, vec2};

    const RECT: Rect = Rect { min: pos2(40.0, 30.0), max: pos2(940.0, 630.0) };

    #[test]
    fn points_of_lines_and_planes_are_found_under_the_pointer_in_perspective_and_parallel_views() {
        let mut side = StudioView::default();
        side.look_from(ViewSide::Front);
        for (view, error_m) in [(StudioView::default(), 1e-5), (side, 2e-3)] {
            let frame = view.frame(1.5);
            let view = HandleView { frame: &frame, rect: RECT };
            let origin = Vec3::new(0.2, 0.9, -0.3);
            for (direction, along) in [(Vec3::X, 0.7), (Vec3::Y, -0.4), (Vec3::new(0.6, 0.8, 0.0), 0.25)] {
                let place = view.place(origin + direction * along).unwrap();
                let found = view.along_line(origin, direction, place).unwrap();
                assert!((found - along).abs() < error_m, "{found} along {direction}, not {along}");
            }
            let on_plane = origin + Vec3::new(0.5, -0.3, 0.0);
            let found = view.on_plane(origin, Vec3::Z, view.place(on_plane).unwrap()).unwrap();
            assert!((found - on_plane).length() < error_m, "{found}, not {on_plane}");
            let (place, point_m) = (view.place(origin).unwrap(), view.metres_a_point(origin));
            let beside = view.place(origin + Vec3::from(frame.world_from_camera.matrix3.x_axis) * point_m * 50.0);
            assert!((beside.unwrap() - place - vec2(50.0, 0.0)).length() < 0.5);
        }
    }

    #[test]
    fn a_line_along_the_sight_and_a_plane_above_the_horizon_have_no_point() {
        let view = StudioView { pitch_rad: 0.0, ..StudioView::default() };
        let frame = view.frame(1.0);
        let square = Rect::from_min_size(Pos2::ZERO, vec2(400.0, 400.0));
        let handles = HandleView { frame: &frame, rect: square };
        assert_eq!(handles.along_line(view.target, frame.forward(), square.center()), None);
        for y in [0.0, 100.0, 200.0] {
            assert_eq!(handles.on_plane(Vec3::ZERO, Vec3::Y, pos2(200.0, y)), None);
        }
    }
}
