//! The ring that moves an object horizontally at its height.

use crate::editor::viewport::overlays::markers::place_of;
use crate::editor::viewport::tools::handle_pointer::{HandlePointer, STEP_M};
use crate::scene::CameraFrame;
use eframe::egui::{self, Color32, Pos2, Rect, Stroke};
use glam::{Vec2, Vec3};

/// Radius of the ring, and of the pointer's hits, points.
const RADIUS: f32 = 12.0;
const REACH: f32 = 15.0;
/// Largest move of one drag, metres: near the horizon a pixel is a long distance.
const MAX_DRAG_M: f32 = 60.0;

/// The floor handle and its drag.
#[derive(Clone, Copy, Debug, Default)]
pub struct FloorHandle {
    place: Option<Pos2>,
    hovered: bool,
    /// Position of the object, and point at its height under the pointer, at the start of the drag.
    grip: Option<(Vec3, Vec3)>,
}

impl FloorHandle {
    /// Returns true if the pointer is on the ring or drags it.
    pub fn wants_pointer(&self) -> bool {
        self.hovered || self.grip.is_some()
    }

    /// Returns true during a drag.
    pub fn is_dragged(&self) -> bool {
        self.grip.is_some()
    }

    /// Handles the pointer; returns the move since the start of the drag of the object now at `position`.
    pub fn update(&mut self, position: Vec3, frame: &CameraFrame, rect: Rect, pointer: HandlePointer) -> Option<Vec3> {
        self.place = place_of(frame, rect, position);
        let on_ring = self.place.is_some_and(|place| place.distance(pointer.position) < REACH);
        self.hovered = on_ring && pointer.is_over && !(pointer.down && self.grip.is_none() && !pointer.pressed);
        if !pointer.down {
            self.grip = None;
        }
        if self.hovered && pointer.pressed {
            self.grip = floor_point(position.y, frame, rect, pointer.position).map(|point| (position, point));
        }
        let (start, gripped) = self.grip?;
        let by = floor_point(start.y, frame, rect, pointer.position)? - gripped;
        if by.length() > MAX_DRAG_M {
            return None;
        }
        // Snapping is to room coordinates, so that objects line up.
        let snap = |from: f32, by: f32| {
            if pointer.snap { ((from + by) / STEP_M).round() * STEP_M - from } else { by }
        };
        Some(Vec3::new(snap(start.x, by.x), 0.0, snap(start.z, by.z)))
    }

    /// Draws the ring.
    pub fn paint(&self, painter: &egui::Painter) {
        let Some(place) = self.place else { return };
        let strong = self.wants_pointer();
        let color = if strong { Color32::WHITE } else { Color32::from_gray(205) };
        painter.circle_stroke(place, RADIUS, Stroke::new(if strong { 3.5 } else { 2.5 }, color));
    }
}

/// Returns the point at height `height_m` under the pointer; none above the horizon.
fn floor_point(height_m: f32, frame: &CameraFrame, rect: Rect, pointer: Pos2) -> Option<Vec3> {
    let at = (pointer - rect.min) / rect.size();
    let (eye, direction) = (frame.position(), frame.direction(Vec2::new(at.x, at.y)));
    let distance = (height_m - eye.y) / direction.y;
    // A horizontal direction gives an infinity or NaN, and none.
    (distance > 0.0 && distance.is_finite()).then(|| eye + direction * distance)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::editor::viewport::studio_view::StudioView;

    #[test]
    fn a_dragged_object_follows_the_pointer_at_its_height() {
        let frame = StudioView::default().frame(1.5);
        let rect = Rect::from_min_size(Pos2::new(10.0, 20.0), egui::vec2(900.0, 600.0));
        let mut position = Vec3::new(0.2, 0.3, -0.4);
        let from = place_of(&frame, rect, position).unwrap() + egui::vec2(4.0, -3.0);
        let mut handle = FloorHandle::default();
        let pointer = HandlePointer { position: from, is_over: true, pressed: true, down: true, snap: false };
        assert_eq!(handle.update(position, &frame, rect, pointer), Some(Vec3::ZERO), "a press moves nothing");
        let to = from + egui::vec2(120.0, 60.0);
        position +=
            handle.update(position, &frame, rect, HandlePointer { position: to, pressed: false, ..pointer }).unwrap();
        assert_eq!(position.y, 0.3);
        let place = place_of(&frame, rect, position).unwrap();
        assert!((place - to).length() < 6.0, "the thing is under the pointer");
        handle.update(position, &frame, rect, HandlePointer { down: false, pressed: false, ..pointer });
        assert!(!handle.is_dragged());
    }

    #[test]
    fn points_above_the_horizon_have_no_floor_point() {
        let view = StudioView { pitch_rad: 0.0, ..StudioView::default() };
        let rect = Rect::from_min_size(Pos2::ZERO, egui::vec2(400.0, 400.0));
        for y in [0.0, 100.0, 200.0] {
            assert_eq!(floor_point(0.0, &view.frame(1.0), rect, Pos2::new(200.0, y)), None);
        }
    }
}
