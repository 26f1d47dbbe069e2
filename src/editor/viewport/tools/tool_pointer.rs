//! The pointer over the view, for tools that have it.

use crate::scene::CameraFrame;
use eframe::egui::{Response, Ui};
use glam::{Vec2, Vec3};

/// The pointer in a frame of the window.
#[derive(Clone, Copy, Debug)]
pub struct ToolPointer {
    /// Origin and direction of the ray through it, world space; none while it is nowhere in the window.
    ray: Option<(Vec3, Vec3)>,
    /// True if it is over the view.
    pub is_inside: bool,
    /// True if the left button was pressed over the view in this frame, and not to navigate.
    pub is_pressed: bool,
    /// True while the left button is down.
    pub is_down: bool,
}

impl ToolPointer {
    /// Returns the pointer over a view with a camera.
    pub fn of(ui: &Ui, response: &Response, frame: &CameraFrame) -> Self {
        let (position, pressed, is_down, alt) = ui.input(|i| {
            let pointer = &i.pointer;
            (pointer.latest_pos(), pointer.primary_pressed(), pointer.primary_down(), i.modifiers.alt)
        });
        let ray = position.map(|position| {
            let point = (position - response.rect.min) / response.rect.size();
            (frame.position(), frame.direction(Vec2::new(point.x, point.y)))
        });
        let is_inside = response.contains_pointer();
        ToolPointer { ray, is_inside, is_pressed: pressed && !alt && is_inside, is_down }
    }

    /// Returns origin and direction of the ray through the pointer while it is over the view, or a drag is under way.
    pub fn ray(&self, is_dragging: bool) -> Option<(Vec3, Vec3)> {
        self.ray.filter(|_| self.is_inside || is_dragging)
    }
}
