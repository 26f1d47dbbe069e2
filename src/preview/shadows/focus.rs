//! Focusing of shadow maps on the visible receivers: a close-up of a ring on a table gets a map of the surroundings of
//! the ring alone, with correspondingly smaller texels.
//!
//! A focused map covers a cell of a fixed grid over the full extent, so that small camera motion keeps the cached maps.

use crate::preview::geometry::oriented_box::{FACES, OrientedBox};
use crate::scene::{CameraFrame, ROOM_STANDS_BACK_M, Room};
use glam::{Affine3A, Vec2, Vec3};

/// Maximum number of times that an extent is halved.
const MAX_HALVINGS: f32 = 6.0;
/// Near distance of the camera frustum, metres.
const NEAR_M: f32 = 1e-3;

/// Vertices of the surfaces that may receive visible shadows, clipped to the camera frustum. Without any, maps are not
/// focused.
#[derive(Clone, Debug, Default)]
pub(crate) struct VisibleReceivers {
    points: Vec<Vec3>,
}

impl VisibleReceivers {
    /// Clips the boxes around the casters and the room to the frustum of `frame`.
    pub fn new(frame: &CameraFrame, casters: &[OrientedBox], room: Option<&Room>) -> Self {
        let camera_from_world = frame.world_from_camera.inverse();
        let boxes = casters.iter().map(OrientedBox::corners);
        let points = boxes.chain(room.map(room_corners)).flat_map(|corners| {
            let corners = corners.map(|corner| camera_from_world.transform_point3(corner));
            FACES.iter().flat_map(move |face| clip_to_frustum(face.map(|i| corners[i]), frame.half_extent))
        });
        VisibleReceivers { points: points.map(|point| frame.world_from_camera.transform_point3(point)).collect() }
    }

    /// Returns the smallest grid cell of the extent from `low` to `high` that contains all receivers with a margin on
    /// each side; the whole extent if there is none. `project` maps a world point to the extent's plane.
    pub fn focused(
        &self,
        (low, high): (Vec2, Vec2),
        margin: Vec2,
        project: impl Fn(Vec3) -> Option<Vec2>,
    ) -> (Vec2, Vec2) {
        // Compute the bounds of the projected receivers, within the extent
        let projected: Option<Vec<Vec2>> = self.points.iter().map(|point| project(*point)).collect();
        let (first, last) = projected
            .unwrap_or_default()
            .into_iter()
            .fold((Vec2::INFINITY, Vec2::NEG_INFINITY), |(first, last), at| {
                (first.min(at - margin), last.max(at + margin))
            });
        let (first, last) = (first.max(low), last.min(high));
        let extent = high - low;
        let fraction = ((last - first) / extent).max_element();
        if !(first.cmplt(last).all() && fraction > 0.0) {
            return (low, high);
        }
        // Choose the cell: cells overlap by half their size, so that one of them contains any bounds of at most half a
        // cell
        let halvings = (0.5 / fraction).log2().floor().clamp(0.0, MAX_HALVINGS);
        let cell = extent * (-halvings).exp2();
        let start = low + ((first - low) / (0.5 * cell)).floor() * 0.5 * cell;
        let start = start.min(high - cell);
        if halvings > 0.0 { (start, start + cell) } else { (low, high) }
    }

    /// Returns true if all receivers with their margin project into an extent, and there are receivers.
    pub fn is_within(&self, (low, high): (Vec2, Vec2), margin: Vec2, project: impl Fn(Vec3) -> Option<Vec2>) -> bool {
        self.bounds(margin, project).is_some_and(|(first, last)| first.cmpge(low).all() && last.cmple(high).all())
    }

    /// Returns the bounds of the projected receivers; none if a point has no projection, or there are none.
    fn bounds(&self, margin: Vec2, project: impl Fn(Vec3) -> Option<Vec2>) -> Option<(Vec2, Vec2)> {
        let mut bounds = (Vec2::INFINITY, Vec2::NEG_INFINITY);
        for point in &self.points {
            let at = project(*point)?;
            bounds = (bounds.0.min(at - margin), bounds.1.max(at + margin));
        }
        bounds.0.cmple(bounds.1).all().then_some(bounds)
    }
}

fn room_corners(room: &Room) -> [Vec3; 8] {
    let half = 0.5 * room.size_m + ROOM_STANDS_BACK_M;
    let centre = Vec3::Y * (0.5 * room.size_m.y);
    OrientedBox { world_from_object: Affine3A::from_translation(centre), low: -half, high: half, body_of: None }
        .corners()
}

/// Clips a polygon in camera space to the frustum (Sutherland and Hodgman 1974).
fn clip_to_frustum(polygon: [Vec3; 4], half_extent: Vec2) -> Vec<Vec3> {
    // Side planes through the eye and the near plane; visible points have positive heights above them.
    let sides = [
        (Vec3::new(1.0, 0.0, -half_extent.x), 0.0),
        (Vec3::new(-1.0, 0.0, -half_extent.x), 0.0),
        (Vec3::new(0.0, 1.0, -half_extent.y), 0.0),
        (Vec3::new(0.0, -1.0, -half_extent.y), 0.0),
        (Vec3::NEG_Z, -NEAR_M),
    ];
    sides.iter().fold(polygon.to_vec(), |polygon, (normal, offset)| {
        let height = |point: Vec3| point.dot(*normal) + offset;
        let edges = polygon.iter().zip(polygon.iter().cycle().skip(1));
        edges
            .flat_map(|(&from, &to)| {
                let (start, end) = (height(from), height(to));
                let crossing = ((start < 0.0) != (end < 0.0)).then(|| from.lerp(to, start / (start - end)));
                [(start >= 0.0).then_some(from), crossing]
            })
            .flatten()
            .collect()
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::look_at;

    fn table_top() -> OrientedBox {
        OrientedBox {
            world_from_object: Affine3A::IDENTITY,
            low: Vec3::new(-1.0, -0.1, -1.0),
            high: Vec3::new(1.0, 0.0, 1.0),
            body_of: None,
        }
    }

    fn close_up(offset_x_m: f32) -> CameraFrame {
        let target = Vec3::new(offset_x_m, 0.0, 0.0);
        let eye = target + Vec3::new(0.0, 0.2, 0.1);
        CameraFrame { world_from_camera: look_at(eye, target, 0.0), half_extent: Vec2::new(0.18, 0.12) }
    }

    /// Returns the extent of a focused map that looks straight down.
    fn focused_from_above(receivers: &VisibleReceivers, margin_m: f32) -> (Vec2, Vec2) {
        let project = |point: Vec3| Some(Vec2::new(point.x, -point.z));
        receivers.focused((Vec2::NEG_ONE, Vec2::ONE), Vec2::splat(margin_m), project)
    }

    #[test]
    fn a_close_up_gets_a_small_extent_that_contains_all_visible_points() {
        let frame = close_up(0.3);
        let (low, high) = focused_from_above(&VisibleReceivers::new(&frame, &[table_top()], None), 0.0);
        assert!((high - low).max_element() <= 0.5, "{low} {high}");
        for corner in [Vec2::ZERO, Vec2::X, Vec2::Y, Vec2::ONE] {
            let direction = frame.direction(corner);
            let shown = frame.position() - direction * (frame.position().y / direction.y);
            let at = Vec2::new(shown.x, -shown.z);
            assert!(at.cmpge(low).all() && at.cmple(high).all(), "{at} beyond {low} {high}");
        }
    }

    #[test]
    fn small_camera_motion_mostly_keeps_the_extent() {
        let extent = |step: i32| {
            focused_from_above(&VisibleReceivers::new(&close_up(step as f32 * 1e-3), &[table_top()], None), 0.0)
        };
        let changes = (0..100).filter(|step| extent(*step) != extent(step + 1)).count();
        assert!(changes <= 3, "{changes} of 100 millimetres");
    }

    #[test]
    fn the_map_is_not_focused_where_all_is_visible_or_the_penumbra_is_wide_or_a_point_has_no_projection() {
        let whole = (Vec2::NEG_ONE, Vec2::ONE);
        let far = CameraFrame {
            world_from_camera: look_at(Vec3::new(0.0, 3.0, 3.0), Vec3::ZERO, 0.0),
            half_extent: Vec2::splat(0.5),
        };
        assert_eq!(focused_from_above(&VisibleReceivers::new(&far, &[table_top()], None), 0.0), whole);
        let near = VisibleReceivers::new(&close_up(0.0), &[table_top()], None);
        assert_eq!(focused_from_above(&near, 0.3), whole);
        assert_eq!(near.focused(whole, Vec2::ZERO, |_| None), whole);
        assert_eq!(focused_from_above(&VisibleReceivers::default(), 0.0), whole);
        let room = Room { size_m: Vec3::splat(3.0), ..Room::default() };
        assert_ne!(focused_from_above(&VisibleReceivers::new(&close_up(0.0), &[], Some(&room)), 0.0), whole);
    }

    #[test]
    fn a_camera_inside_a_box_has_visible_receivers() {
        let inside = CameraFrame {
            world_from_camera: look_at(Vec3::Y * -0.05, Vec3::new(0.0, -0.05, -1.0), 0.0),
            half_extent: Vec2::splat(0.1),
        };
        let receivers = VisibleReceivers::new(&inside, &[table_top()], None);
        assert!(!receivers.points.is_empty() && receivers.points.iter().all(|point| point.z < 0.0), "{receivers:?}");
    }
}
