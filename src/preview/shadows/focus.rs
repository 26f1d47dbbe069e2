//! The part of a light's map that a view needs: all of the studio from afar, and close to a ring on a table only what
//! lies around the ring, with texels as much smaller.
//!
//! A narrower field is a cell of a fixed grid over the whole one, so that a camera that moves a little finds the maps
//! that are there.

use crate::preview::geometry::oriented_box::{FACES, OrientedBox};
use crate::scene::{CameraFrame, ROOM_STANDS_BACK_M, Room};
use glam::{Affine3A, Vec2, Vec3};

/// A field is halved so many times at most.
const MOST_HALVINGS: f32 = 6.0;
/// What is nearer to the eye than this is taken as not seen, metres.
const NEAR_M: f32 = 1e-3;

/// Corners of the surfaces that a view may show, cut at the edges of its picture. Without any, the view is unknown and
/// needs everything.
#[derive(Clone, Debug, Default)]
pub(crate) struct VisibleReceivers {
    points: Vec<Vec3>,
}

impl VisibleReceivers {
    /// Of the boxes around things, and of the room.
    pub fn new(frame: &CameraFrame, casters: &[OrientedBox], room: Option<&Room>) -> Self {
        let camera_from_world = frame.world_from_camera.inverse();
        let things = casters.iter().map(OrientedBox::corners);
        let points = things.chain(room.map(room_corners)).flat_map(|corners| {
            let corners = corners.map(|corner| camera_from_world.transform_point3(corner));
            FACES.iter().flat_map(move |face| in_picture(face.map(|i| corners[i]), frame.half_extent))
        });
        VisibleReceivers { points: points.map(|point| frame.world_from_camera.transform_point3(point)).collect() }
    }

    /// The cell of a field from `low` to `high` that holds what is seen, with so much margin on each side; the whole
    /// field where no smaller cell does. `place` tells where in the field a point falls, if it does.
    pub fn narrowed(
        &self,
        (low, high): (Vec2, Vec2),
        margin: Vec2,
        place: impl Fn(Vec3) -> Option<Vec2>,
    ) -> (Vec2, Vec2) {
        let places: Option<Vec<Vec2>> = self.points.iter().map(|point| place(*point)).collect();
        let (first, last) = places
            .unwrap_or_default()
            .into_iter()
            .fold((Vec2::INFINITY, Vec2::NEG_INFINITY), |(first, last), place| {
                (first.min(place - margin), last.max(place + margin))
            });
        let (first, last) = (first.max(low), last.min(high));
        let field = high - low;
        let part = ((last - first) / field).max_element();
        if !(first.cmplt(last).all() && part > 0.0) {
            return (low, high);
        }
        // Cells begin at every half of their size: of two that overlap, one holds what is no larger than a half.
        let halvings = (0.5 / part).log2().floor().clamp(0.0, MOST_HALVINGS);
        let cell = field * (-halvings).exp2();
        let start = low + ((first - low) / (0.5 * cell)).floor() * 0.5 * cell;
        let start = start.min(high - cell);
        if halvings > 0.0 { (start, start + cell) } else { (low, high) }
    }

    /// Whether all that is seen falls into a field, with the margin.
    pub fn is_within(&self, (low, high): (Vec2, Vec2), margin: Vec2, place: impl Fn(Vec3) -> Option<Vec2>) -> bool {
        self.extent(margin, place).is_some_and(|(first, last)| first.cmpge(low).all() && last.cmple(high).all())
    }

    /// Where in a field it all falls; none if one point does not, or there is none.
    fn extent(&self, margin: Vec2, place: impl Fn(Vec3) -> Option<Vec2>) -> Option<(Vec2, Vec2)> {
        let mut extent = (Vec2::INFINITY, Vec2::NEG_INFINITY);
        for point in &self.points {
            let place = place(*point)?;
            extent = (extent.0.min(place - margin), extent.1.max(place + margin));
        }
        extent.0.cmple(extent.1).all().then_some(extent)
    }
}

fn room_corners(room: &Room) -> [Vec3; 8] {
    let half = 0.5 * room.size_m + ROOM_STANDS_BACK_M;
    let middle = Vec3::Y * (0.5 * room.size_m.y);
    OrientedBox { world_from_object: Affine3A::from_translation(middle), low: -half, high: half }.corners()
}

/// What is left of a polygon in the camera's space inside the picture's edges (Sutherland and Hodgman 1974).
fn in_picture(polygon: [Vec3; 4], half_extent: Vec2) -> Vec<Vec3> {
    // Planes through the eye, and one before it; what is seen has positive heights over them.
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

    fn table() -> OrientedBox {
        OrientedBox {
            world_from_object: Affine3A::IDENTITY,
            low: Vec3::new(-1.0, -0.1, -1.0),
            high: Vec3::new(1.0, 0.0, 1.0),
        }
    }

    fn close_up(aside_m: f32) -> CameraFrame {
        let target = Vec3::new(aside_m, 0.0, 0.0);
        let eye = target + Vec3::new(0.0, 0.2, 0.1);
        CameraFrame { world_from_camera: look_at(eye, target, 0.0), half_extent: Vec2::new(0.18, 0.12) }
    }

    /// The field of a map that looks straight down.
    fn from_above(seen: &VisibleReceivers, margin_m: f32) -> (Vec2, Vec2) {
        let place = |point: Vec3| Some(Vec2::new(point.x, -point.z));
        seen.narrowed((Vec2::NEG_ONE, Vec2::ONE), Vec2::splat(margin_m), place)
    }

    #[test]
    fn a_close_up_gets_a_small_field_that_holds_all_it_shows() {
        let frame = close_up(0.3);
        let (low, high) = from_above(&VisibleReceivers::new(&frame, &[table()], None), 0.0);
        assert!((high - low).max_element() <= 0.5, "{low} {high}");
        for corner in [Vec2::ZERO, Vec2::X, Vec2::Y, Vec2::ONE] {
            let direction = frame.direction(corner);
            let shown = frame.position() - direction * (frame.position().y / direction.y);
            let place = Vec2::new(shown.x, -shown.z);
            assert!(place.cmpge(low).all() && place.cmple(high).all(), "{place} beyond {low} {high}");
        }
    }

    #[test]
    fn a_step_aside_mostly_finds_the_field_that_is_there() {
        let field =
            |step: i32| from_above(&VisibleReceivers::new(&close_up(step as f32 * 1e-3), &[table()], None), 0.0);
        let changes = (0..100).filter(|step| field(*step) != field(step + 1)).count();
        assert!(changes <= 3, "{changes} of 100 millimetres");
    }

    #[test]
    fn the_whole_is_kept_where_all_is_seen_or_the_penumbra_is_wide_or_a_point_cannot_be_placed() {
        let whole = (Vec2::NEG_ONE, Vec2::ONE);
        let far = CameraFrame {
            world_from_camera: look_at(Vec3::new(0.0, 3.0, 3.0), Vec3::ZERO, 0.0),
            half_extent: Vec2::splat(0.5),
        };
        assert_eq!(from_above(&VisibleReceivers::new(&far, &[table()], None), 0.0), whole);
        let near = VisibleReceivers::new(&close_up(0.0), &[table()], None);
        assert_eq!(from_above(&near, 0.3), whole);
        assert_eq!(near.narrowed(whole, Vec2::ZERO, |_| None), whole);
        assert_eq!(from_above(&VisibleReceivers::default(), 0.0), whole);
        let room = Room { size_m: Vec3::splat(3.0), ..Room::default() };
        assert_ne!(from_above(&VisibleReceivers::new(&close_up(0.0), &[], Some(&room)), 0.0), whole);
    }

    #[test]
    fn a_camera_inside_a_box_sees_its_walls() {
        let inside = CameraFrame {
            world_from_camera: look_at(Vec3::Y * -0.05, Vec3::new(0.0, -0.05, -1.0), 0.0),
            half_extent: Vec2::splat(0.1),
        };
        let seen = VisibleReceivers::new(&inside, &[table()], None);
        assert!(!seen.points.is_empty() && seen.points.iter().all(|point| point.z < 0.0), "{seen:?}");
    }
}
