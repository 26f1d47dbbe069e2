//! The joints of a figure as handles: a limb is posed by dragging it.

use crate::editor::document::action::Action;
use crate::editor::viewport::overlays::markers::paint_text;
use crate::editor::viewport::tools::handle_pointer::HandlePointer;
use crate::editor::viewport::tools::handle_view::HandleView;
use crate::figures::{Joint, PosableBody};
use crate::scene::{Figure, Object, Pose, Shape, Torso};
use eframe::egui::{self, Align2, Color32, Pos2, Stroke, vec2};
use glam::{Vec2, Vec3};

/// Radius of a joint's dot, and of the pointer's hits, points.
const RADIUS: f32 = 5.0;
const REACH: f32 = 10.0;

/// A drag of a joint.
#[derive(Clone, Debug)]
struct JointDrag {
    joint: Joint,
    /// The object at the start of the drag.
    start: Object,
    body: PosableBody,
    /// Place of the joint at the start, world space, and of the pointer beside it, points.
    place: Vec3,
    grip: egui::Vec2,
}

/// The joints of the selected figure, and the drag of one.
#[derive(Debug, Default)]
pub struct JointHandles {
    body: Option<PosableBody>,
    /// The joints in the view, with their places on the screen.
    shown: Vec<(Joint, Pos2)>,
    hovered: Option<Joint>,
    drag: Option<JointDrag>,
    /// True after a key ended the drag, until the button is released.
    cancelled: bool,
}

impl JointHandles {
    /// Returns true if the pointer is on a joint or drags one.
    pub fn wants_pointer(&self) -> bool {
        self.hovered.is_some() || self.is_dragging()
    }

    /// Returns true during a drag.
    pub fn is_dragging(&self) -> bool {
        self.drag.is_some() || self.cancelled
    }

    /// Cancels the drag; the button may still be down.
    pub fn cancel(&mut self) {
        self.cancelled = self.is_dragging();
        self.drag = None;
    }

    /// Clears all state, because no figure is posed.
    pub fn reset(&mut self) {
        *self = JointHandles::default();
    }

    /// Handles the pointer; returns the action of a drag.
    pub fn update(&mut self, object: &Object, view: HandleView<'_>, pointer: HandlePointer) -> Option<Action> {
        let Shape::Figure(figure) = &object.shape else { return None };
        self.cancelled &= pointer.down;
        self.show(object, figure, view);
        if !pointer.down {
            self.drag = None;
        }
        let nearest = self.shown.iter().map(|(joint, place)| (place.distance(pointer.position), *joint));
        let nearest = nearest.filter(|(distance, _)| *distance < REACH).min_by(|a, b| a.0.total_cmp(&b.0));
        let may_hover = pointer.is_over && (!pointer.down || pointer.pressed) && !self.cancelled;
        self.hovered = nearest.map(|(_, joint)| joint).filter(|_| may_hover);
        if let (Some(joint), true) = (self.hovered, pointer.pressed) {
            self.drag = self.start(object, joint, pointer.position);
        }
        let drag = self.drag.as_ref()?;
        let pose = drag.body.dragged(drag.joint, drag.target(view, pointer.position)?, drag.across(view));
        let mut posed = drag.start.clone();
        match &mut posed.shape {
            Shape::Figure(figure) => {
                let Torso { gaze_yaw_deg, gaze_pitch_deg, .. } = figure.pose.torso;
                figure.pose = Pose { torso: Torso { gaze_yaw_deg, gaze_pitch_deg, ..pose.torso }, ..pose };
            }
            _ => return None,
        }
        (posed != *object).then(|| Action::SetObject(Box::new(posed)))
    }

    /// Finds the joints on the screen.
    fn show(&mut self, object: &Object, figure: &Figure, view: HandleView<'_>) {
        let body = match self.body.take().filter(|body| body.is_of(figure)) {
            Some(body) => body,
            None => PosableBody::new(figure),
        };
        let world_from_object = object.transform.world_from_object();
        let joints = Joint::ALL.into_iter().filter(|joint| joint.is_part_of(figure));
        let on_screen = |joint: Joint| {
            let place = world_from_object.transform_point3(body.place(joint));
            Some((joint, view.place(place)?))
        };
        self.shown = joints.filter_map(on_screen).collect();
        self.body = Some(body);
    }

    fn start(&self, object: &Object, joint: Joint, pointer: Pos2) -> Option<JointDrag> {
        let body = self.body.clone()?;
        let (_, on_screen) = self.shown.iter().find(|(shown, _)| *shown == joint)?;
        let place = object.transform.world_from_object().transform_point3(body.place(joint));
        Some(JointDrag { joint, start: object.clone(), body, place, grip: pointer - *on_screen })
    }

    /// Draws the joints.
    pub fn paint(&self, painter: &egui::Painter) {
        let active = self.drag.as_ref().map(|drag| drag.joint).or(self.hovered);
        for (joint, place) in &self.shown {
            let is_active = active == Some(*joint);
            let fill = if is_active { Color32::WHITE } else { Color32::from_rgb(250, 190, 90) };
            painter.circle(
                *place,
                if is_active { RADIUS + 2.0 } else { RADIUS },
                fill,
                Stroke::new(1.5, Color32::BLACK),
            );
            if is_active {
                paint_text(painter, *place + vec2(12.0, -12.0), Align2::LEFT_BOTTOM, joint.label(), Color32::WHITE);
            }
        }
    }
}

impl JointDrag {
    /// Returns the point under the pointer at the joint's depth, object space; none if the object has no volume.
    fn target(&self, HandleView { frame, rect }: HandleView<'_>, pointer: Pos2) -> Option<Vec3> {
        let at = (pointer - self.grip - rect.min) / rect.size();
        let depth = (self.place - frame.position()).dot(frame.forward());
        let world = frame.position() + frame.direction(Vec2::new(at.x, at.y)) * depth;
        let target = self.start.transform.world_from_object().inverse().transform_point3(world);
        target.is_finite().then_some(target)
    }

    /// Returns the unit vectors of the screen, to the right and up, in object space.
    fn across(&self, HandleView { frame, .. }: HandleView<'_>) -> [Vec3; 2] {
        let object_from_world = self.start.transform.world_from_object().inverse();
        let axes = frame.world_from_camera.matrix3;
        [axes.x_axis, axes.y_axis].map(|axis| object_from_world.transform_vector3(axis.into()).normalize_or_zero())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::editor::document::studio_document::Document;
    use crate::editor::viewport::studio_view::StudioView;
    use crate::figures::Side;
    use crate::io::find_preset;
    use eframe::egui::Rect;

    #[test]
    fn a_dragged_hand_follows_the_pointer_as_one_undo_step() {
        let loaded = find_preset("group").unwrap().load().unwrap();
        let mut document = Document::new(loaded.scene, loaded.assets, None);
        let id = document.scene().objects[0].id;
        let before = document.scene().clone();
        let frame = StudioView { yaw_rad: 0.2, ..StudioView::default() }.frame(1.5);
        let rect = Rect::from_min_size(egui::pos2(40.0, 30.0), vec2(900.0, 600.0));
        let view = HandleView { frame: &frame, rect };
        let mut handles = JointHandles::default();
        let hand = Joint::Hand(Side::Left);
        let object = |document: &Document| document.scene().object(id).unwrap().clone();
        let place = |handles: &JointHandles| handles.shown.iter().find(|(joint, _)| *joint == hand).unwrap().1;
        let outside = egui::pos2(45.0, 35.0);
        let mut pointer = HandlePointer { position: outside, is_over: true, pressed: false, down: false, snap: false };
        assert!(handles.update(&object(&document), view, pointer).is_none() && !handles.wants_pointer());
        let start = place(&handles) + vec2(3.0, -2.0);
        pointer.position = start;
        handles.update(&object(&document), view, pointer);
        assert!(handles.wants_pointer(), "the pointer is on the hand");
        for (pressed, by) in [(true, vec2(0.0, 0.0)), (false, vec2(20.0, -30.0)), (false, vec2(35.0, -60.0))] {
            pointer = HandlePointer { position: start + by, pressed, down: true, ..pointer };
            if let Some(action) = handles.update(&object(&document), view, pointer) {
                document.apply(action, Some(1)).unwrap();
            }
        }
        pointer = HandlePointer { pressed: false, ..pointer };
        assert!(handles.update(&object(&document), view, pointer).is_none(), "at rest it changes nothing");
        assert!((place(&handles) - pointer.position + vec2(3.0, -2.0)).length() < 2.0);
        assert_eq!(document.undo().as_deref(), Some("Change Woman"));
        assert!(*document.scene() == before, "one undo step");
        handles.cancel();
        assert!(handles.update(&object(&document), view, pointer).is_none(), "a cancelled drag changes nothing");
    }
}
