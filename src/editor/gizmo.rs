//! Handles for moving, turning and sizing the selected thing, over the viewport.

use super::action::{Action, Item};
use super::command::Handle;
use super::floor_handle::FloorHandle;
use crate::math;
use crate::scene::{Aim, Camera, CameraFrame, Emitter, Light, Meter, Object, Scene};
use eframe::egui::{self, Color32, Rect, Rgba};
use glam::{Quat, Vec3};
use transform_gizmo::math::{Pos2, Transform};
use transform_gizmo::{EnumSet, Gizmo, GizmoConfig, GizmoInteraction, GizmoMode, GizmoOrientation, GizmoVisuals, mint};

/// Steps with Ctrl: metres, degrees, part of the scale.
const STEP_M: f32 = 0.1;
const STEP_DEG: f32 = 5.0;
const STEP_SCALE: f32 = 0.1;
/// Depths between which handles can be, metres.
const NEAR_M: f64 = 0.02;
const FAR_M: f64 = 500.0;

/// What the mouse does over the handles.
#[derive(Clone, Copy, Debug)]
pub struct Pointer {
    /// Where it is, points.
    pub position: egui::Pos2,
    /// Nothing covers the viewport there, and the mouse is not navigating.
    pub is_over: bool,
    /// The left button went down just now.
    pub pressed: bool,
    /// The left button is down.
    pub down: bool,
    /// In steps.
    pub snap: bool,
}

/// The handles of the selection.
#[derive(Debug, Default)]
pub struct Handles {
    gizmo: Gizmo,
    active: bool,
    /// Whether the selection has handles of the kind on show.
    shown: bool,
    /// What a light was when the drag began: sizes are told from there.
    start: Option<Emitter>,
    floor: FloorHandle,
}

impl Handles {
    /// Whether the pointer is on a handle or drags one.
    pub fn wants_pointer(&self) -> bool {
        self.active || (self.shown && (self.gizmo.is_focused() || self.floor.wants_pointer()))
    }

    /// Takes the pointer in; returns the change that a drag makes.
    pub fn update(
        &mut self,
        scene: &Scene,
        item: Item,
        handle: Handle,
        frame: &CameraFrame,
        rect: Rect,
        pointer: Pointer,
    ) -> Option<Action> {
        let target = Target::of(scene, item, handle);
        self.shown = target.is_some();
        let Some(target) = target else {
            self.reset();
            return None;
        };
        let mut config = config(handle, frame, rect, pointer.snap);
        if matches!(item, Item::Object(_)) {
            config.modes.remove(GizmoMode::TranslateView);
        }
        self.gizmo.update_config(config);
        if let (Item::Object(id), Handle::Move) = (item, handle) {
            // The ring in the middle slides things over the floor; the library's own would lift them off it.
            if !self.gizmo.is_focused() || self.floor.is_dragged() {
                let moved = self.floor.update(target.position, frame, rect, pointer);
                if self.floor.wants_pointer() {
                    self.gizmo.update(GizmoInteraction::default(), &[target.transform()]);
                    let mut object = scene.object(id)?.clone();
                    object.transform.position = moved?;
                    return Some(Action::SetObject(Box::new(object)));
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
        let result = self.gizmo.update(interaction, &[target.transform()]);
        let began = result.is_some() && !self.active;
        self.active = result.is_some();
        if began {
            self.start = emitter_of(scene, item);
        }
        let moved = *result?.1.first()?;
        target.moved(scene, item, handle, &moved, self.start)
    }

    /// Forgets a drag, because there is nothing selected that has handles.
    pub fn reset(&mut self) {
        *self = Handles::default();
    }

    /// Draws them.
    pub fn paint(&self, painter: &egui::Painter) {
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
    }
}

fn emitter_of(scene: &Scene, item: Item) -> Option<Emitter> {
    match item {
        Item::Light(id) => scene.light(id).map(|light| light.emitter),
        _ => None,
    }
}

/// Place, turn and scale of what the handles hold.
#[derive(Clone, Copy, Debug)]
struct Target {
    position: Vec3,
    rotation: Quat,
    scale: Vec3,
}

impl Target {
    /// The selection as the handles see it; none where there is nothing to hold.
    fn of(scene: &Scene, item: Item, handle: Handle) -> Option<Self> {
        match item {
            Item::Object(id) => {
                let t = &scene.object(id)?.transform;
                Some(Target { position: t.position, rotation: t.rotation(), scale: t.scale })
            }
            Item::Light(id) => {
                let light = scene.light(id)?;
                let has_place = !matches!(light.emitter, Emitter::Surround);
                let has_size = !matches!(light.emitter, Emitter::Point | Emitter::Sun { .. });
                let rotation = Quat::from_mat3a(&scene.light_frame(light).matrix3);
                let target = Target { position: light.position, rotation, scale: Vec3::ONE };
                (has_place && (handle != Handle::Size || has_size)).then_some(target)
            }
            Item::Camera => {
                let rotation = Quat::from_mat3a(&scene.camera_frame(1.0).world_from_camera.matrix3);
                let target = Target { position: scene.camera.position, rotation, scale: Vec3::ONE };
                (handle != Handle::Size).then_some(target)
            }
            Item::Meter => {
                let position = scene.meter?.position;
                let target = Target { position, rotation: Quat::IDENTITY, scale: Vec3::ONE };
                (handle == Handle::Move).then_some(target)
            }
            Item::Room => None,
        }
    }

    fn transform(&self) -> Transform {
        let [x, y, z] = self.position.as_dvec3().to_array();
        let [sx, sy, sz] = self.scale.as_dvec3().to_array();
        let q = self.rotation.as_dquat();
        Transform::from_scale_rotation_translation(
            mint::Vector3 { x: sx, y: sy, z: sz },
            mint::Quaternion { s: q.w, v: mint::Vector3 { x: q.x, y: q.y, z: q.z } },
            mint::Vector3 { x, y, z },
        )
    }

    /// The action that brings the selection to where the handles are now.
    fn moved(
        &self,
        scene: &Scene,
        item: Item,
        handle: Handle,
        to: &Transform,
        start: Option<Emitter>,
    ) -> Option<Action> {
        let position = Vec3::new(to.translation.x as f32, to.translation.y as f32, to.translation.z as f32);
        let v = to.rotation.v;
        let rotation = Quat::from_xyzw(v.x as f32, v.y as f32, v.z as f32, to.rotation.s as f32).normalize();
        let scale = Vec3::new(to.scale.x as f32, to.scale.y as f32, to.scale.z as f32);
        if !(position.is_finite() && rotation.is_finite() && scale.is_finite()) {
            return None;
        }
        match item {
            Item::Object(id) => {
                let mut object: Object = scene.object(id)?.clone();
                match handle {
                    Handle::Move => object.transform.position = position,
                    Handle::Turn => object.transform.set_rotation(rotation),
                    Handle::Size => object.transform.scale = scale.max(Vec3::splat(0.001)),
                }
                Some(Action::SetObject(Box::new(object)))
            }
            Item::Light(id) => {
                let mut light: Light = scene.light(id)?.clone();
                match handle {
                    Handle::Move => light.position = position,
                    Handle::Turn => {
                        let reach = (scene.aim_point(&light.aim, light.position) - light.position).length();
                        let (aim, roll_rad) = aim_of(light.position, rotation, reach);
                        (light.aim, light.roll_deg) = (aim, roll_rad.to_degrees());
                    }
                    Handle::Size => {
                        light.emitter = start.unwrap_or(light.emitter);
                        resize(&mut light.emitter, scale);
                    }
                }
                Some(Action::SetLight(Box::new(light)))
            }
            Item::Camera => {
                let mut camera: Camera = scene.camera.clone();
                if handle == Handle::Move {
                    camera.position = position;
                } else {
                    let reach = (scene.aim_point(&camera.aim, camera.position) - camera.position).length();
                    let (aim, roll_rad) = aim_of(camera.position, rotation, reach);
                    // A camera's roll is clockwise as seen from behind, a frame's is not.
                    (camera.aim, camera.roll_deg) = (aim, -roll_rad.to_degrees());
                }
                Some(Action::SetCamera(Box::new(camera)))
            }
            Item::Meter => Some(Action::SetMeter(Some(Meter { position, ..scene.meter? }))),
            Item::Room => None,
        }
    }
}

/// The aim point at a distance along a rotation's -Z, and the roll that completes it.
fn aim_of(position: Vec3, rotation: Quat, reach_m: f32) -> (Aim, f32) {
    let target = position - rotation * Vec3::Z * reach_m.max(0.1);
    let level = math::look_at(position, target, 0.0).matrix3;
    let right = rotation * Vec3::X;
    let roll = right.dot(level.y_axis.into()).atan2(right.dot(level.x_axis.into()));
    // Handles turn by small steps: what is left of them by rounding is no roll.
    (Aim::Point(target), if roll.abs() < 1e-4 { 0.0 } else { roll })
}

/// Makes an emitter larger or smaller by factors along its own axes.
fn resize(emitter: &mut Emitter, scale: Vec3) {
    let scale = scale.clamp(Vec3::splat(0.01), Vec3::splat(100.0));
    // The axis that is pulled says how much for things with one size.
    let most = [scale.x, scale.y].into_iter().max_by(|a, b| a.ln().abs().total_cmp(&b.ln().abs())).unwrap_or(1.0);
    match emitter {
        Emitter::RectPanel { width_m, height_m } => {
            *width_m = (*width_m * scale.x).clamp(0.01, 20.0);
            *height_m = (*height_m * scale.y).clamp(0.01, 20.0);
        }
        Emitter::RoundPanel { diameter_m } => *diameter_m = (*diameter_m * most).clamp(0.01, 20.0),
        Emitter::Sphere { radius_m } => *radius_m = (*radius_m * most).clamp(0.002, 10.0),
        Emitter::Spot { inner_deg, outer_deg } => {
            let factor = most.clamp(0.5 / outer_deg.max(0.5), 179.0 / outer_deg.max(0.5));
            (*inner_deg, *outer_deg) = (*inner_deg * factor, *outer_deg * factor);
        }
        Emitter::Point | Emitter::Sun { .. } | Emitter::Surround => {}
    }
}

fn config(handle: Handle, frame: &CameraFrame, rect: Rect, snap: bool) -> GizmoConfig {
    let modes: EnumSet<GizmoMode> = match handle {
        Handle::Move => GizmoMode::all_translate(),
        Handle::Turn => GizmoMode::all_rotate(),
        Handle::Size => GizmoMode::all_scale(),
    };
    GizmoConfig {
        view_matrix: rows(frame.world_from_camera.inverse()),
        projection_matrix: projection(frame),
        viewport: transform_gizmo::Rect::from_min_max(
            Pos2::new(rect.min.x, rect.min.y),
            Pos2::new(rect.max.x, rect.max.y),
        ),
        modes,
        orientation: if handle == Handle::Size { GizmoOrientation::Local } else { GizmoOrientation::Global },
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

/// The frame's projection with depth from -1 to 1, which the handles' library expects.
fn projection(frame: &CameraFrame) -> mint::RowMatrix4<f64> {
    let (x, y) = (1.0 / f64::from(frame.half_extent.x), 1.0 / f64::from(frame.half_extent.y));
    let (a, b) = ((FAR_M + NEAR_M) / (NEAR_M - FAR_M), 2.0 * FAR_M * NEAR_M / (NEAR_M - FAR_M));
    [[x, 0.0, 0.0, 0.0], [0.0, y, 0.0, 0.0], [0.0, 0.0, a, b], [0.0, 0.0, -1.0, 0.0]].into()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::editor::catalog;
    use crate::editor::studio_view::StudioView;

    fn scene_with_light() -> (Scene, Item) {
        let mut scene = Scene::default();
        let mut light = catalog::light_named("Softbox 60 x 90").unwrap();
        light.position = Vec3::new(0.0, 1.1, 0.0);
        light.aim = Aim::Point(Vec3::new(0.0, 1.1, -2.0));
        let item = Action::AddLight(Box::new(light)).apply(&mut scene).unwrap().unwrap();
        (scene, item)
    }

    #[test]
    fn dragging_the_middle_of_the_handles_moves_a_light_with_the_pointer() {
        let (mut scene, item) = scene_with_light();
        let view = StudioView::default();
        let rect = Rect::from_min_size(egui::pos2(100.0, 50.0), egui::vec2(800.0, 600.0));
        let frame = view.frame(800.0 / 600.0);
        let mut handles = Handles::default();
        let start = rect.center();
        let mut pointer = Pointer { position: start, is_over: true, pressed: false, down: false, snap: false };
        handles.update(&scene, item, Handle::Move, &frame, rect, pointer);
        assert!(handles.wants_pointer(), "the pointer is on the middle handle");
        for (pressed, x) in [(true, 0.0), (false, 30.0), (false, 60.0)] {
            pointer = Pointer { position: start + egui::vec2(x, 0.0), pressed, down: true, ..pointer };
            if let Some(action) = handles.update(&scene, item, Handle::Move, &frame, rect, pointer) {
                action.apply(&mut scene).unwrap();
            }
        }
        let place = frame.project(scene.lights[0].position).unwrap();
        assert!((place - glam::Vec2::new(0.5 + 60.0 / 800.0, 0.5)).length() < 5e-3, "{place}");
    }

    #[test]
    fn an_aim_and_a_roll_make_the_same_frame() {
        let rotation = Quat::from_euler(glam::EulerRot::YXZ, 0.7, -0.4, 0.3);
        let (aim, roll) = aim_of(Vec3::ONE, rotation, 2.0);
        let Aim::Point(target) = aim else { unreachable!() };
        let frame = math::look_at(Vec3::ONE, target, roll);
        assert!(Quat::from_mat3a(&frame.matrix3).angle_between(rotation) < 1e-3);
    }

    #[test]
    fn sizes_stay_sane() {
        let mut panel = Emitter::RectPanel { width_m: 0.6, height_m: 0.9 };
        resize(&mut panel, Vec3::new(2.0, 1.0, 1.0));
        assert_eq!(panel, Emitter::RectPanel { width_m: 1.2, height_m: 0.9 });
        let mut spot = Emitter::Spot { inner_deg: 40.0, outer_deg: 70.0 };
        resize(&mut spot, Vec3::splat(50.0));
        assert!(matches!(spot, Emitter::Spot { outer_deg, .. } if outer_deg < 180.0));
    }
}
