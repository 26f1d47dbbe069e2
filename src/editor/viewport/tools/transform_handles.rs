//! The transform handles in the viewport: move, rotate and scale the selection.

use crate::editor::commands::choices::HandleMode;
use crate::editor::document::action::Action;
use crate::editor::document::item::Item;
use crate::editor::ui::lengths;
use crate::editor::viewport::overlays::markers::paint_text;
use crate::editor::viewport::tools::handle_drag::HandleDrag;
use crate::editor::viewport::tools::handle_part::{HandleAxes, HandlePart, HandleShape, part_at, parts};
use crate::editor::viewport::tools::handle_pointer::HandlePointer;
use crate::editor::viewport::tools::handle_view::HandleView;
use crate::editor::viewport::tools::transform_selection::{DragSelection, pivot};
use crate::scene::Scene;
use eframe::egui::{self, Align2, Color32, Event, vec2};

/// The transform handles of the selection.
#[derive(Debug, Default)]
pub struct TransformHandles {
    shapes: Vec<HandleShape>,
    hovered: Option<HandlePart>,
    drag: Option<HandleDrag>,
    /// True after a key ended the drag, until the button is released.
    cancelled: bool,
}

impl TransformHandles {
    /// Returns true if the pointer is on a handle or drags one.
    pub fn wants_pointer(&self) -> bool {
        self.is_dragging() || self.hovered.is_some()
    }

    /// Returns true during a drag, when keys are numbers.
    pub fn is_dragging(&self) -> bool {
        self.drag.is_some() || self.cancelled
    }

    /// Handles pointer and keys; returns the action of a drag.
    pub fn update(
        &mut self,
        scene: &Scene,
        items: &[Item],
        handle: HandleMode,
        view: HandleView<'_>,
        pointer: HandlePointer,
        keys: &[Event],
    ) -> Option<Action> {
        let Some(place) = pivot(scene, items, handle) else {
            self.reset();
            return None;
        };
        self.cancelled &= pointer.down;
        if !pointer.down {
            self.drag = None;
        }
        let axes = HandleAxes::new(scene, items, handle, place);
        let parts = parts(items, handle, &axes, view);
        self.shapes = parts.into_iter().filter_map(|part| HandleShape::new(part, &axes, view)).collect();
        let may_hover = pointer.is_over && (!pointer.down || pointer.pressed) && !self.cancelled;
        self.hovered = part_at(&self.shapes, pointer.position).filter(|_| may_hover);
        if let (Some(part), true) = (self.hovered, pointer.pressed) {
            let held = DragSelection::new(scene, items, handle)?;
            self.drag = HandleDrag::new(part, axes, held, view, pointer.position);
        }
        let drag = self.drag.as_mut()?;
        drag.follow(view, pointer);
        drag.typed.take(keys);
        let action = drag.action();
        if drag.typed.is_finished() {
            self.cancel();
        }
        action
    }

    /// Cancels the drag; the button may still be down.
    pub fn cancel(&mut self) {
        self.cancelled = self.is_dragging();
        self.drag = None;
    }

    /// Clears all state, because no selected item has handles.
    pub fn reset(&mut self) {
        *self = TransformHandles::default();
    }

    /// Draws the handles, during a drag the dragged one alone, and the amount of the drag.
    pub fn paint(&self, painter: &egui::Painter, pointer: Option<egui::Pos2>) {
        let dragged = self.drag.as_ref().map(HandleDrag::part);
        let active = dragged.or(self.hovered);
        let shown = self.shapes.iter().filter(|shape| dragged.is_none_or(|part| part == shape.part));
        for shape in shown {
            shape.paint(painter, active == Some(shape.part));
        }
        let Some(pointer) = pointer else { return };
        let text = match (&self.drag, active) {
            (Some(drag), _) => drag.amount(lengths::units(painter.ctx())),
            (None, Some(HandlePart::MoveAlongAim)) => "Nearer or farther, at the same angle".to_owned(),
            _ => return,
        };
        paint_text(painter, pointer + vec2(18.0, -18.0), Align2::LEFT_BOTTOM, &text, Color32::WHITE);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::editor::document::catalog;
    use crate::editor::viewport::studio_view::StudioView;
    use crate::scene::Aim;
    use eframe::egui::{Pos2, Rect, pos2};
    use glam::Vec3;

    const RECT: Rect = Rect { min: pos2(100.0, 50.0), max: pos2(900.0, 650.0) };

    /// A studio with a softbox and a chrome ball, and the two items.
    fn studio() -> (Scene, [Item; 2]) {
        let mut scene = Scene::default();
        let mut light = catalog::light_named("Softbox 60 x 90").unwrap();
        light.position = Vec3::new(0.0, 1.1, 0.0);
        light.aim = Aim::Point(Vec3::new(0.0, 1.1, -2.0));
        let light = Action::AddLight(Box::new(light)).apply(&mut scene).unwrap()[0];
        let mut ball = catalog::object_named("Chrome ball").unwrap();
        ball.transform.position = Vec3::new(0.2, 0.3, -0.4);
        let ball = Action::AddObject(Box::new(ball)).apply(&mut scene).unwrap()[0];
        (scene, [light, ball])
    }

    /// Drags from one place to another and back to rest; returns the handles.
    fn drag(scene: &mut Scene, item: Item, handle: HandleMode, view: HandleView<'_>, path: [Pos2; 2]) {
        let mut handles = TransformHandles::default();
        let mut pointer = HandlePointer { position: path[0], is_over: true, pressed: false, down: false, snap: false };
        handles.update(scene, &[item], handle, view, pointer, &[]);
        assert!(handles.wants_pointer(), "the pointer is on a handle");
        for (pressed, along) in [(true, 0.0), (false, 0.5), (false, 1.0)] {
            pointer = HandlePointer { position: path[0].lerp(path[1], along), pressed, down: true, ..pointer };
            if let Some(action) = handles.update(scene, &[item], handle, view, pointer, &[]) {
                action.apply(scene).unwrap();
            }
        }
        assert!(handles.is_dragging());
        pointer.down = false;
        assert!(handles.update(scene, &[item], handle, view, pointer, &[]).is_none() && !handles.is_dragging());
    }

    #[test]
    fn dragging_the_middle_of_the_handles_moves_a_light_with_the_pointer() {
        let (mut scene, [light, _]) = studio();
        let frame = StudioView::default().frame(800.0 / 600.0);
        let start = RECT.center();
        let view = HandleView { frame: &frame, rect: RECT };
        drag(&mut scene, light, HandleMode::Move, view, [start, start + vec2(60.0, 0.0)]);
        let place = frame.project(scene.lights[0].position).unwrap();
        assert!((place - glam::Vec2::new(0.5 + 60.0 / 800.0, 0.5)).length() < 1e-4, "{place}");
    }

    #[test]
    fn a_dragged_object_follows_the_pointer_at_its_height() {
        let (mut scene, [_, ball]) = studio();
        let frame = StudioView::default().frame(800.0 / 600.0);
        let view = HandleView { frame: &frame, rect: RECT };
        let before = scene.objects[0].transform.position;
        let from = view.place(before).unwrap() + vec2(4.0, -3.0);
        let by = vec2(120.0, 60.0);
        drag(&mut scene, ball, HandleMode::Move, view, [from, from + by]);
        let position = scene.objects[0].transform.position;
        assert_eq!(position.y, before.y);
        assert!((view.place(position).unwrap() - from - by).length() < 6.0, "the ball is under the pointer");
    }

    #[test]
    fn the_knob_on_the_aim_line_moves_a_light_nearer_and_keeps_its_angle() {
        let (mut scene, [light, _]) = studio();
        let frame = StudioView::default().frame(800.0 / 600.0);
        let view = HandleView { frame: &frame, rect: RECT };
        let before = scene.lights[0].clone();
        let knob = 104.0 * view.metres_a_point(before.position);
        let path = [knob, knob + 0.5].map(|along| view.place(before.position + Vec3::NEG_Z * along).unwrap());
        drag(&mut scene, light, HandleMode::Move, view, path);
        let after = &scene.lights[0];
        assert!((after.position - before.position - Vec3::NEG_Z * 0.5).length() < 1e-4, "{}", after.position);
        assert_eq!((after.aim, after.roll_deg), (before.aim, before.roll_deg));
    }

    #[test]
    fn every_part_of_the_handles_can_be_taken_where_it_is_drawn() {
        let (scene, items) = studio();
        let views = [StudioView::default(), StudioView { pitch_rad: 1.5, yaw_rad: 0.0, ..StudioView::default() }];
        for (view, item, handle) in views.into_iter().flat_map(|view| {
            let modes = [HandleMode::Move, HandleMode::Rotate, HandleMode::Scale];
            items.into_iter().flat_map(move |item| modes.map(|handle| (view, item, handle)))
        }) {
            let frame = view.frame(800.0 / 600.0);
            let view = HandleView { frame: &frame, rect: RECT };
            let place = pivot(&scene, &[item], handle).unwrap();
            let axes = HandleAxes::new(&scene, &[item], handle, place);
            let parts = parts(&[item], handle, &axes, view);
            let shapes: Vec<_> = parts.iter().filter_map(|part| HandleShape::new(*part, &axes, view)).collect();
            assert!(shapes.len() >= 2, "{item:?} {handle:?}: {} parts", shapes.len());
            for shape in &shapes {
                let taken = shape.outline().iter().any(|at| part_at(&shapes, *at) == Some(shape.part));
                assert!(taken, "{:?} of {item:?} is hidden under others", shape.part);
            }
        }
    }
}
