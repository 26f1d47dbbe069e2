//! The camera of the live view.

use crate::raytrace::lens::{Aperture, Lens, PixelCamera};
use crate::raytrace::strand_detail::StrandView;
use crate::scene::{CameraFrame, Room, Scene};
use glam::{Vec2, Vec3};

/// The camera of the live view, with the picture's size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LiveCamera {
    /// Framing, in world space.
    pub frame: CameraFrame,
    /// Pixels across and down.
    pub size: (u32, u32),
    aperture: Aperture,
    /// The tracer's origin in world space.
    origin: Vec3,
    /// Corners of the room relative to the tracer's origin, if the eye is outside of it.
    room: Option<[Vec3; 2]>,
}

/// Distance behind the near wall at which rays from outside the room begin, metres: more than its rounding error.
const CLEAR_OF_WALL_M: f32 = 1e-3;

impl LiveCamera {
    /// A pinhole camera.
    pub fn pinhole(frame: CameraFrame, size: (u32, u32)) -> Self {
        LiveCamera {
            frame,
            size: (size.0.max(1), size.1.max(1)),
            aperture: Aperture::PINHOLE,
            origin: Vec3::ZERO,
            room: None,
        }
    }

    /// The scene's camera, with its depth of field if that is on.
    pub fn through_lens(scene: &Scene, frame: CameraFrame, size: (u32, u32)) -> Self {
        LiveCamera { aperture: Lens::new(scene).aperture(), ..Self::pinhole(frame, size) }
    }

    /// Returns origin and unit direction of the ray through a picture point, world space: (0, 0) is the top left corner,
    /// (1, 1) the bottom right. From an eye outside of a room, it begins behind the near wall.
    pub fn view_ray(frame: &CameraFrame, room: Option<&Room>, point: Vec2) -> (Vec3, Vec3) {
        let (from, direction) = Self::pinhole(*frame, (1, 1)).around(Vec3::ZERO, room).ray(point, Vec2::splat(0.5));
        (from, direction.normalize())
    }

    /// Returns the same view for a tracer with this origin. From outside a room, its near walls are clipped.
    pub(super) fn around(self, origin: Vec3, room: Option<&Room>) -> Self {
        let corners = room.map(|room| room.bounds().map(|corner| corner - origin));
        let eye = self.frame.position() - origin;
        let outside = |[low, high]: &[Vec3; 2]| eye.cmplt(*low).any() || eye.cmpgt(*high).any();
        LiveCamera { origin, room: corners.filter(outside), ..self }
    }

    /// Returns a good origin for the tracer: the eye, clamped to the room.
    pub(super) fn natural_origin(&self, room: Option<&Room>) -> Vec3 {
        let eye = self.frame.position();
        room.map(Room::bounds).map_or(eye, |[low, high]| eye.max(low).min(high))
    }

    /// Returns the scale of depth tolerances at a point, metres: its distance, shortened for long lenses.
    pub(super) fn depth_scale(&self, point: Vec3) -> f32 {
        const NORMAL_LENS_HALF_HEIGHT: f32 = 0.35;
        point.distance(self.eye()) * self.frame.half_extent.y / NORMAL_LENS_HALF_HEIGHT
    }

    /// Returns true if there is depth of field.
    pub(super) fn has_aperture(&self) -> bool {
        self.aperture != Aperture::PINHOLE
    }

    /// The lens centre, relative to the tracer's origin.
    pub(super) fn eye(&self) -> Vec3 {
        self.frame.position() - self.origin
    }

    /// Returns the view for which strands are thinned.
    pub(super) fn strand_view(&self) -> StrandView {
        StrandView { position: self.eye(), pixel_m: self.pixel_m() }
    }

    /// Projects a point relative to the tracer's origin to pixels from the top left; `None` behind the eye.
    pub(super) fn project(&self, point: Vec3) -> Option<Vec2> {
        let size = Vec2::new(self.size.0 as f32, self.size.1 as f32);
        self.frame.project(point + self.origin).map(|position| position * size)
    }
}

impl PixelCamera for LiveCamera {
    fn ray(&self, point_px: Vec2, u: Vec2) -> (Vec3, Vec3) {
        let size = Vec2::new(self.size.0 as f32, self.size.1 as f32);
        let (from, direction) = self.aperture.ray(&self.frame, point_px / size, u);
        let from = from + self.eye();
        (from + direction * self.room.map_or(0.0, |room| entry(from, direction, room)), direction)
    }

    fn size(&self) -> (u32, u32) {
        self.size
    }

    fn pixel_m(&self) -> f32 {
        2.0 * self.frame.half_extent.x / self.size.0 as f32
    }
}

/// Returns the distance at which a ray from outside enters a box; 0 where it misses it.
fn entry(from: Vec3, direction: Vec3, [low, high]: [Vec3; 2]) -> f32 {
    let (a, b) = ((low - from) / direction, (high - from) / direction);
    // A ray in the plane of a side has 0 / 0 there; `max_element` of the ordered pair drops the NaN.
    let (near, far) = (a.min(b).max_element(), a.max(b).min_element());
    if near > 0.0 && near < far { near + CLEAR_OF_WALL_M } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rays_from_outside_begin_behind_the_near_wall() {
        let frame = CameraFrame {
            world_from_camera: glam::Affine3A::from_translation(Vec3::new(0.0, 1.0, 10.0)),
            half_extent: Vec2::splat(0.3),
        };
        let room = Room { size_m: Vec3::new(4.0, 3.0, 6.0), ..Room::default() };
        let camera = LiveCamera::pinhole(frame, (100, 100)).around(Vec3::ZERO, Some(&room));
        let (start, direction) = camera.ray(Vec2::splat(50.0), Vec2::ZERO);
        assert!((start.z - 3.0 + CLEAR_OF_WALL_M).abs() < 1e-4 && direction.z < -0.999, "{start}");
        // A ray beside the room starts at the eye.
        let (start, _) = camera.ray(Vec2::new(0.0, 50.0), Vec2::ZERO);
        assert_eq!(start, Vec3::new(0.0, 1.0, 10.0));
        assert_eq!(camera.natural_origin(Some(&room)), Vec3::new(0.0, 1.0, 3.0));
        let inside = LiveCamera::pinhole(CameraFrame { world_from_camera: glam::Affine3A::IDENTITY, ..frame }, (9, 9));
        assert_eq!(inside.around(Vec3::ZERO, Some(&room)).ray(Vec2::ZERO, Vec2::ZERO).0, Vec3::ZERO);
    }
}
