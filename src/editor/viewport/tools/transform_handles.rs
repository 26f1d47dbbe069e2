//! The transform handles in the viewport: move, rotate and scale the selection.

use crate::editor::commands::choices::HandleMode;
use crate::editor::document::action::Action;
use crate::editor::document::item::Item;
use crate::editor::viewport::overlays::markers::paint_text;
use crate::editor::viewport::tools::floor_handle::FloorHandle;
use crate::editor::viewport::tools::handle_pointer::{HandlePointer, STEP_DEG, STEP_M};
use crate::editor::viewport::tools::transform_selection::{DragSelection, DragTransform, pivot};
use crate::editor::viewport::tools::typed_number::TypedNumber;
use crate::scene::{CameraFrame, Scene};
use eframe::egui::{self, Align2, Color32, Event, Rect, Rgba, vec2};
use glam::{DVec3, Quat, Vec3};
use transform_gizmo::math::{Pos2, Transform};
use transform_gizmo::{
    EnumSet, Gizmo, GizmoConfig, GizmoInteraction, GizmoMode, GizmoOrientation, GizmoResult, GizmoVisuals, mint,
};

const STEP_SCALE: f32 = 0.1;
/// Near plane of the handles, metres.
const NEAR_M: f64 = 0.02;
/// Smallest sine of the view's pitch at which objects are moved over the floor.
const MIN_PITCH_SIN: f32 = 0.1;

/// The view of the handles.
#[derive(Clone, Copy, Debug)]
pub struct HandleView<'a> {
    /// Camera frame of the view.
    pub frame: &'a CameraFrame,
    /// Rectangle of the view, points.
    pub rect: Rect,
}

/// A drag of a handle.
#[derive(Clone, Debug)]
struct HandleDrag {
    held: DragSelection,
    change: DragTransform,
    typed: TypedNumber,
}

impl HandleDrag {
    /// Returns the transform with the typed amount, if any, in the direction of the drag.
    fn with_typed_amount(&self) -> DragTransform {
        let Some(amount) = self.typed.value() else { return self.change };
        match self.change {
            DragTransform::Move(by) => DragTransform::Move(by.normalize_or_zero() * amount),
            DragTransform::Rotate(axis, angle) => {
                DragTransform::Rotate(axis, amount.to_radians() * if angle < 0.0 { -1.0 } else { 1.0 })
            }
            DragTransform::Scale(factor) => {
                let by = (factor - Vec3::ONE).abs();
                DragTransform::Scale(Vec3::ONE + by / by.max_element().max(1e-6) * (amount - 1.0))
            }
        }
    }
}

/// The transform handles of the selection.
#[derive(Debug, Default)]
pub struct TransformHandles {
    gizmo: Gizmo,
    drag: Option<HandleDrag>,
    /// True after a key ended the drag, until the button is released.
    cancelled: bool,
    /// True if the selection has handles of the current kind.
    shown: bool,
    floor: FloorHandle,
}

impl TransformHandles {
    /// Returns true if the pointer is on a handle or drags one.
    pub fn wants_pointer(&self) -> bool {
        self.is_dragging() || (self.shown && (self.gizmo.is_focused() || self.floor.wants_pointer()))
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
        let place = pivot(scene, items, handle);
        self.shown = place.is_some();
        let Some(place) = place else {
            self.reset();
            return None;
        };
        self.cancelled &= pointer.down;
        let change = self.dragged(scene, items, handle, place, view, pointer).filter(|_| !self.cancelled);
        let Some(change) = change else {
            self.drag = None;
            return None;
        };
        if self.drag.is_none() {
            let held = DragSelection::new(scene, items, handle)?;
            self.drag = Some(HandleDrag { held, change, typed: TypedNumber::default() });
        }
        let drag = self.drag.as_mut()?;
        drag.change = change;
        drag.typed.take(keys);
        let action = drag.held.changed(drag.with_typed_amount());
        if drag.typed.is_finished() {
            self.cancel();
        }
        action
    }

    /// Returns the transform since the start of the drag.
    fn dragged(
        &mut self,
        scene: &Scene,
        items: &[Item],
        handle: HandleMode,
        place: Vec3,
        HandleView { frame, rect }: HandleView<'_>,
        pointer: HandlePointer,
    ) -> Option<DragTransform> {
        let mut config = config(handle, frame, rect, pointer.snap, place);
        let on_floor = matches!(handle, HandleMode::Move | HandleMode::Pose)
            && items.iter().any(|item| matches!(item, Item::Object(_)))
            && frame.forward().y.abs() > MIN_PITCH_SIN;
        if on_floor {
            config.modes.remove(GizmoMode::TranslateView);
        }
        self.gizmo.update_config(config);
        let target = target(scene, items, handle, place);
        if on_floor {
            // The ring in the middle moves objects over the floor; the library's own handle moves in the plane of the
            // screen.
            if !self.gizmo.is_focused() || self.floor.is_dragged() {
                let moved = self.floor.update(place, frame, rect, pointer);
                if self.floor.wants_pointer() {
                    self.gizmo.update(GizmoInteraction::default(), &[target]);
                    return moved.map(DragTransform::Move);
                }
            }
        } else {
            self.floor = FloorHandle::default();
        }
        let interaction = GizmoInteraction {
            cursor_pos: (pointer.position.x, pointer.position.y),
            hovered: pointer.is_over,
            drag_started: pointer.is_over && pointer.pressed,
            dragging: pointer.down,
        };
        self.gizmo.update(interaction, &[target]).map(|(result, _)| change_of(result))
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

    /// Draws the handles and the amount of a drag.
    pub fn paint(&self, painter: &egui::Painter, pointer: Option<egui::Pos2>) {
        if !self.shown {
            return;
        }
        let data = self.gizmo.draw();
        let vertices = data.vertices.iter().zip(&data.colors).map(|(pos, [r, g, b, a])| egui::epaint::Vertex {
            pos: egui::pos2(pos[0], pos[1]),
            uv: egui::epaint::WHITE_UV,
            color: Color32::from(Rgba::from_rgba_premultiplied(*r, *g, *b, *a)),
        });
        let mesh = egui::Mesh { indices: data.indices.clone(), vertices: vertices.collect(), ..egui::Mesh::default() };
        painter.add(mesh);
        self.floor.paint(painter);
        if let (Some(drag), Some(at)) = (&self.drag, pointer) {
            paint_text(painter, at + vec2(18.0, -18.0), Align2::LEFT_BOTTOM, &amount(drag), Color32::WHITE);
        }
    }
}

/// Returns the amount of a drag as text, typed or measured.
fn amount(drag: &HandleDrag) -> String {
    let unit = match drag.change {
        DragTransform::Move(_) => " m",
        DragTransform::Rotate(..) => "\u{b0}",
        DragTransform::Scale(_) => " times",
    };
    let number = match drag.change {
        _ if !drag.typed.text().is_empty() => return format!("{}{unit}    Enter sets it", drag.typed.text()),
        DragTransform::Move(by) => format!("{:.2}", by.length()),
        DragTransform::Rotate(_, angle) => format!("{:.1}", angle.to_degrees().abs()),
        DragTransform::Scale(factor) => {
            let most = factor.to_array().into_iter().max_by(|a, b| (a - 1.0).abs().total_cmp(&(b - 1.0).abs()));
            format!("{:.2}", most.unwrap_or(1.0))
        }
    };
    format!("{number}{unit}")
}

fn change_of(result: GizmoResult) -> DragTransform {
    let vector = |v: mint::Vector3<f64>| DVec3::new(v.x, v.y, v.z).as_vec3();
    match result {
        GizmoResult::Translation { total, .. } => DragTransform::Move(vector(total)),
        // The library measures the angle on the screen, with the opposite sign.
        GizmoResult::Rotation { axis, total, .. } => {
            DragTransform::Rotate(vector(axis).normalize_or(Vec3::Y), -total as f32)
        }
        GizmoResult::Scale { total } => DragTransform::Scale(vector(total)),
        GizmoResult::Arcball { total, .. } => {
            let turn = Quat::from_xyzw(total.v.x as f32, total.v.y as f32, total.v.z as f32, total.s as f32);
            let (axis, angle) = turn.normalize().to_axis_angle();
            DragTransform::Rotate(axis, angle)
        }
    }
}

/// Returns the transform of the handles: position, and the axes of a scaled item.
fn target(scene: &Scene, items: &[Item], handle: HandleMode, place: Vec3) -> Transform {
    let rotation = match (handle, items) {
        (HandleMode::Scale, [Item::Object(id)]) => scene.object(*id).map(|object| object.transform.rotation()),
        (HandleMode::Scale, [Item::Light(id)]) => {
            scene.light(*id).map(|light| Quat::from_mat3a(&scene.light_frame(light).matrix3))
        }
        _ => None,
    };
    let (q, [x, y, z]) = (rotation.unwrap_or(Quat::IDENTITY).as_dquat(), place.as_dvec3().to_array());
    Transform::from_scale_rotation_translation(
        mint::Vector3 { x: 1.0, y: 1.0, z: 1.0 },
        mint::Quaternion { s: q.w, v: mint::Vector3 { x: q.x, y: q.y, z: q.z } },
        mint::Vector3 { x, y, z },
    )
}

fn config(handle: HandleMode, frame: &CameraFrame, rect: Rect, snap: bool, place: Vec3) -> GizmoConfig {
    let modes: EnumSet<GizmoMode> = match handle {
        HandleMode::Move | HandleMode::Pose => GizmoMode::all_translate(),
        HandleMode::Rotate => GizmoMode::all_rotate(),
        HandleMode::Scale => GizmoMode::all_scale(),
    };
    GizmoConfig {
        view_matrix: rows(frame.world_from_camera.inverse()),
        projection_matrix: projection(frame, f64::from((place - frame.position()).length())),
        viewport: transform_gizmo::Rect::from_min_max(
            Pos2::new(rect.min.x, rect.min.y),
            Pos2::new(rect.max.x, rect.max.y),
        ),
        modes,
        orientation: if handle == HandleMode::Scale { GizmoOrientation::Local } else { GizmoOrientation::Global },
        snapping: snap,
        snap_angle: STEP_DEG.to_radians(),
        snap_distance: STEP_M,
        snap_scale: STEP_SCALE,
        visuals: GizmoVisuals { gizmo_size: 70.0, stroke_width: 3.5, ..GizmoVisuals::default() },
        ..GizmoConfig::default()
    }
}

fn rows(affine: glam::Affine3A) -> mint::RowMatrix4<f64> {
    let m = glam::Mat4::from(affine).as_dmat4();
    [m.row(0).to_array(), m.row(1).to_array(), m.row(2).to_array(), m.row(3).to_array()].into()
}

/// Returns the projection with clip depth -1 to 1, as the library expects, for handles at this distance.
fn projection(frame: &CameraFrame, distance_m: f64) -> mint::RowMatrix4<f64> {
    let (x, y) = (1.0 / f64::from(frame.half_extent.x), 1.0 / f64::from(frame.half_extent.y));
    let far = 2.0 * distance_m + 100.0;
    let (a, b) = ((far + NEAR_M) / (NEAR_M - far), 2.0 * far * NEAR_M / (NEAR_M - far));
    [[x, 0.0, 0.0, 0.0], [0.0, y, 0.0, 0.0], [0.0, 0.0, a, b], [0.0, 0.0, -1.0, 0.0]].into()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::editor::document::catalog;
    use crate::editor::viewport::studio_view::StudioView;
    use crate::scene::Aim;

    fn scene_with_light() -> (Scene, Item) {
        let mut scene = Scene::default();
        let mut light = catalog::light_named("Softbox 60 x 90").unwrap();
        light.position = Vec3::new(0.0, 1.1, 0.0);
        light.aim = Aim::Point(Vec3::new(0.0, 1.1, -2.0));
        let item = Action::AddLight(Box::new(light)).apply(&mut scene).unwrap()[0];
        (scene, item)
    }

    #[test]
    fn dragging_the_middle_of_the_handles_moves_a_light_with_the_pointer() {
        let (mut scene, item) = scene_with_light();
        let view = StudioView::default();
        let rect = Rect::from_min_size(egui::pos2(100.0, 50.0), vec2(800.0, 600.0));
        let frame = view.frame(800.0 / 600.0);
        let mut handles = TransformHandles::default();
        let start = rect.center();
        let mut pointer = HandlePointer { position: start, is_over: true, pressed: false, down: false, snap: false };
        let view = HandleView { frame: &frame, rect };
        handles.update(&scene, &[item], HandleMode::Move, view, pointer, &[]);
        assert!(handles.wants_pointer(), "the pointer is on the middle handle");
        for (pressed, x) in [(true, 0.0), (false, 30.0), (false, 60.0)] {
            pointer = HandlePointer { position: start + vec2(x, 0.0), pressed, down: true, ..pointer };
            if let Some(action) = handles.update(&scene, &[item], HandleMode::Move, view, pointer, &[]) {
                action.apply(&mut scene).unwrap();
            }
        }
        let place = frame.project(scene.lights[0].position).unwrap();
        assert!((place - glam::Vec2::new(0.5 + 60.0 / 800.0, 0.5)).length() < 5e-3, "{place}");
    }

    #[test]
    fn a_typed_number_keeps_the_direction_of_the_drag() {
        let (scene, item) = scene_with_light();
        let held = DragSelection::new(&scene, &[item], HandleMode::Move).unwrap();
        let mut drag =
            HandleDrag { held, change: DragTransform::Move(Vec3::new(0.0, -0.2, 0.0)), typed: TypedNumber::default() };
        assert_eq!(drag.with_typed_amount(), drag.change);
        drag.typed.take(&[Event::Text("1.5".into())]);
        assert_eq!(drag.with_typed_amount(), DragTransform::Move(Vec3::new(0.0, -1.5, 0.0)));
        drag.change = DragTransform::Rotate(Vec3::Y, -0.1);
        assert_eq!(drag.with_typed_amount(), DragTransform::Rotate(Vec3::Y, -1.5_f32.to_radians()));
        drag.change = DragTransform::Scale(Vec3::new(1.0, 0.8, 1.0));
        assert_eq!(drag.with_typed_amount(), DragTransform::Scale(Vec3::new(1.0, 1.5, 1.0)));
        drag.change = DragTransform::Scale(Vec3::splat(1.2));
        assert_eq!(drag.with_typed_amount(), DragTransform::Scale(Vec3::splat(1.5)));
    }
}
