//! Moves, rotations and scalings of the selection, computed from its state at the start of a drag, so that rounding
//! does not accumulate and typed amounts are exact.

use crate::editor::commands::choices::HandleMode;
use crate::editor::document::action::Action;
use crate::editor::document::item::{Item, name_of_all};
use crate::editor::document::placement::{angles_towards, wrap_deg};
use crate::editor::document::selection::centre;
use crate::math;
use crate::scene::{Aim, Camera, Emitter, Light, Meter, Object, Scene};
use glam::{Quat, Vec3};

/// The transform of a drag.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DragTransform {
    /// Translation, metres.
    Move(Vec3),
    /// Rotation about the pivot: unit axis, and angle in radians.
    Rotate(Vec3, f32),
    /// Scaling of one item along its own axes.
    Scale(Vec3),
}

/// The dragged items and the scene at the start of the drag.
#[derive(Clone, Debug)]
pub struct DragSelection {
    items: Vec<Item>,
    scene: Scene,
    pivot: Vec3,
}

impl DragSelection {
    /// Starts a drag; none if the items have no such handles.
    pub fn new(scene: &Scene, items: &[Item], handle: HandleMode) -> Option<Self> {
        Some(DragSelection { items: items.to_vec(), pivot: pivot(scene, items, handle)?, scene: scene.clone() })
    }

    /// Returns the action that transforms the items.
    pub fn changed(&self, change: DragTransform) -> Option<Action> {
        let finite = match change {
            DragTransform::Move(by) => by.is_finite(),
            DragTransform::Rotate(axis, angle_rad) => axis.is_finite() && angle_rad.is_finite(),
            DragTransform::Scale(factor) => factor.is_finite(),
        };
        if !finite {
            return None;
        }
        let mut actions: Vec<Action> = self.items.iter().filter_map(|item| self.changed_item(*item, change)).collect();
        if actions.len() < 2 {
            return actions.pop();
        }
        let verb = match change {
            DragTransform::Move(_) => "Move",
            DragTransform::Rotate(..) => "Turn",
            DragTransform::Scale(_) => "Size",
        };
        Some(Action::Together { label: format!("{verb} {}", name_of_all(&self.items, &self.scene)), actions })
    }

    fn changed_item(&self, item: Item, change: DragTransform) -> Option<Action> {
        match item {
            Item::Object(id) => {
                let object = changed_object(self.scene.object(id)?, self.pivot, change);
                Some(Action::SetObject(Box::new(object)))
            }
            Item::Light(id) => Some(Action::SetLight(Box::new(self.changed_light(self.scene.light(id)?, change)))),
            Item::Camera => self.changed_camera(change).map(|camera| Action::SetCamera(Box::new(camera))),
            Item::Meter => {
                let meter = self.scene.meter?;
                let position = match change {
                    DragTransform::Move(by) => meter.position + by,
                    DragTransform::Rotate(axis, angle) => turned_about(self.pivot, axis, angle, meter.position),
                    DragTransform::Scale(_) => return None,
                };
                Some(Action::SetMeter(Some(Meter { position, ..meter })))
            }
            Item::Room => None,
        }
    }

    /// Returns true if aim points move with the items: when objects are among several items.
    fn moves_aim_points(&self) -> bool {
        self.items.len() > 1 && self.items.iter().any(|item| matches!(item, Item::Object(_)))
    }

    fn changed_light(&self, start: &Light, change: DragTransform) -> Light {
        let mut light = start.clone();
        match change {
            DragTransform::Move(by) => {
                light.position += by;
                if let (Aim::Point(point), true) = (&mut light.aim, self.moves_aim_points()) {
                    *point += by;
                }
            }
            DragTransform::Rotate(axis, angle) => {
                let frame = self.scene.light_frame(start);
                light.position = turned_about(self.pivot, axis, angle, start.position);
                let (aim, roll_rad) = self.turned_aim(&start.aim, start.position, frame, axis, angle);
                (light.aim, light.roll_deg) = (aim, settled(roll_rad.to_degrees(), start.roll_deg));
            }
            DragTransform::Scale(factor) => resize(&mut light.emitter, factor),
        }
        light
    }

    fn changed_camera(&self, change: DragTransform) -> Option<Camera> {
        let start = &self.scene.camera;
        let mut camera = start.clone();
        match change {
            DragTransform::Move(by) => {
                camera.position += by;
                if let (Aim::Point(point), true) = (&mut camera.aim, self.moves_aim_points()) {
                    *point += by;
                }
            }
            DragTransform::Rotate(axis, angle) => {
                let frame = self.scene.camera_frame(1.0).world_from_camera;
                camera.position = turned_about(self.pivot, axis, angle, start.position);
                let (aim, roll_rad) = self.turned_aim(&start.aim, start.position, frame, axis, angle);
                // A camera's roll is clockwise as seen from behind, a frame's is counter-clockwise.
                (camera.aim, camera.roll_deg) = (aim, settled(-roll_rad.to_degrees(), start.roll_deg));
            }
            DragTransform::Scale(_) => return None,
        }
        Some(camera)
    }

    /// Returns aim and roll (radians) of an item at `position` with this frame, rotated about the pivot. An aim at an
    /// object is kept.
    fn turned_aim(&self, aim: &Aim, position: Vec3, frame: glam::Affine3A, axis: Vec3, angle: f32) -> (Aim, f32) {
        let turn = Quat::from_axis_angle(axis, angle);
        let new_position = self.pivot + turn * (position - self.pivot);
        let ahead = turn * -Vec3::from(frame.matrix3.z_axis);
        let new_aim = match *aim {
            Aim::Object { .. } => *aim,
            Aim::Point(point) => Aim::Point(self.pivot + turn * (point - self.pivot)),
            Aim::Angles { .. } => angles_towards(ahead),
        };
        let level = math::look_along(Vec3::ZERO, self.aimed_along(&new_aim, new_position, ahead), 0.0).matrix3;
        let right = turn * Vec3::from(frame.matrix3.x_axis);
        (new_aim, right.dot(level.y_axis.into()).atan2(right.dot(level.x_axis.into())))
    }

    fn aimed_along(&self, aim: &Aim, position: Vec3, otherwise: Vec3) -> Vec3 {
        // If the subject is rotated as well, only the frame gives the new direction.
        match aim {
            Aim::Object { object, .. } if self.items.contains(&Item::Object(*object)) => otherwise,
            _ => self.scene.aim_vector(aim, position),
        }
    }
}

/// Returns the position of the handles, which is the pivot of rotations: the mean position of the items. A single light
/// aimed at an object rotates about its aim point. None if the items have no such handles.
pub fn pivot(scene: &Scene, items: &[Item], handle: HandleMode) -> Option<Vec3> {
    let [item] = items else {
        return centre(items, scene).filter(|_| handle != HandleMode::Scale);
    };
    let place = item.position(scene)?;
    let light = if let Item::Light(id) = item { scene.light(*id) } else { None };
    match (handle, item) {
        (HandleMode::Move | HandleMode::Pose, _)
        | (HandleMode::Rotate, Item::Object(_) | Item::Camera)
        | (HandleMode::Scale, Item::Object(_)) => Some(place),
        (HandleMode::Rotate, _) => light.map(|light| match light.aim {
            Aim::Object { .. } => scene.aim_point(&light.aim, place),
            Aim::Point(_) | Aim::Angles { .. } => place,
        }),
        (HandleMode::Scale, _) => {
            light.filter(|light| !matches!(light.emitter, Emitter::Point | Emitter::Sun { .. })).map(|_| place)
        }
    }
}

fn turned_about(pivot: Vec3, axis: Vec3, angle_rad: f32, point: Vec3) -> Vec3 {
    pivot + Quat::from_axis_angle(axis, angle_rad) * (point - pivot)
}

/// Returns the original roll if the new one differs by rounding only.
fn settled(roll_deg: f32, start_deg: f32) -> f32 {
    if (roll_deg - start_deg).abs() < 0.01 { start_deg } else { roll_deg }
}

fn changed_object(start: &Object, pivot: Vec3, change: DragTransform) -> Object {
    let mut object = start.clone();
    match change {
        DragTransform::Move(by) => object.transform.position += by,
        DragTransform::Rotate(axis, angle) => {
            object.transform.position = turned_about(pivot, axis, angle, start.transform.position);
            let upright = start.transform.rotation_deg.x == 0.0 && start.transform.rotation_deg.z == 0.0;
            if upright && axis.abs() == Vec3::Y {
                // A rotation about the vertical of an upright object changes its yaw only.
                object.transform.rotation_deg.y =
                    wrap_deg(start.transform.rotation_deg.y + (angle * axis.y).to_degrees());
            } else {
                object.transform.set_rotation(Quat::from_axis_angle(axis, angle) * start.transform.rotation());
            }
        }
        DragTransform::Scale(factor) => {
            object.transform.scale = (start.transform.scale * factor).max(Vec3::splat(0.001))
        }
    }
    object
}

/// Scales an emitter by factors along its own axes.
fn resize(emitter: &mut Emitter, factor: Vec3) {
    let factor = factor.clamp(Vec3::splat(0.01), Vec3::splat(100.0));
    // Emitters of one size use the factor of the dragged axis.
    let most = [factor.x, factor.y].into_iter().max_by(|a, b| a.ln().abs().total_cmp(&b.ln().abs())).unwrap_or(1.0);
    match emitter {
        Emitter::RectPanel { width_m, height_m } => {
            *width_m = (*width_m * factor.x).clamp(0.01, 20.0);
            *height_m = (*height_m * factor.y).clamp(0.01, 20.0);
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::editor::document::catalog;
    use crate::scene::{LightId, ObjectId};
    use std::f32::consts::FRAC_PI_2;

    /// A bust, a softbox aimed at it and a bulb aimed at a point in front of it.
    fn studio() -> (Scene, [Item; 3]) {
        let mut scene = Scene::default();
        let mut bust = catalog::object_named("Boy, 10, short hair").unwrap();
        bust.transform.position = Vec3::new(0.4, 0.0, 0.2);
        Action::AddObject(Box::new(bust)).apply(&mut scene).unwrap();
        let mut softbox = catalog::light_named("Softbox 60 x 90").unwrap();
        softbox.aim = Aim::Object { object: ObjectId(0), offset: Vec3::new(0.0, 0.4, 0.1) };
        let mut bulb = catalog::light_named("Bare bulb").unwrap();
        (bulb.position, bulb.aim) = (Vec3::new(1.5, 2.0, 1.0), Aim::Point(Vec3::new(0.4, 0.4, 0.6)));
        for light in [softbox, bulb] {
            Action::AddLight(Box::new(light)).apply(&mut scene).unwrap();
        }
        (scene, [Item::Object(ObjectId(0)), Item::Light(LightId(0)), Item::Light(LightId(1))])
    }

    fn after(scene: &Scene, items: &[Item], handle: HandleMode, change: DragTransform) -> Scene {
        let mut scene = scene.clone();
        DragSelection::new(&scene, items, handle).unwrap().changed(change).unwrap().apply(&mut scene).unwrap();
        scene
    }

    /// Returns a world-space point in the space of a light.
    fn seen_by(scene: &Scene, light: usize, point: Vec3) -> Vec3 {
        scene.light_frame(&scene.lights[light]).inverse().transform_point3(point)
    }

    #[test]
    fn rotating_or_moving_a_whole_set_up_keeps_its_lighting() {
        let (scene, items) = studio();
        let face =
            |scene: &Scene| scene.objects[0].transform.world_from_object().transform_point3(Vec3::new(0.03, 0.4, 0.1));
        let turn = DragTransform::Rotate(Vec3::Y, 0.8);
        for (handle, change) in
            [(HandleMode::Rotate, turn), (HandleMode::Move, DragTransform::Move(Vec3::new(1.0, 0.2, -0.7)))]
        {
            let moved = after(&scene, &items, handle, change);
            for light in 0..2 {
                let (now, before) = (seen_by(&moved, light, face(&moved)), seen_by(&scene, light, face(&scene)));
                assert!((now - before).length() < 1e-5, "{change:?} light {light}: {now}, not {before}");
            }
        }
    }

    #[test]
    fn a_light_aimed_at_an_object_rotates_about_it() {
        let (scene, [_, softbox, _]) = studio();
        let target = scene.aim_point(&scene.lights[0].aim, Vec3::ZERO);
        let rotated = after(&scene, &[softbox], HandleMode::Rotate, DragTransform::Rotate(Vec3::Y, FRAC_PI_2));
        let (now, before) = (rotated.lights[0].position - target, scene.lights[0].position - target);
        assert!((now - Vec3::new(before.z, before.y, -before.x)).length() < 1e-5, "{now} from {before}");
        assert_eq!((rotated.lights[0].aim, rotated.lights[0].roll_deg), (scene.lights[0].aim, 0.0));
    }

    #[test]
    fn a_light_aimed_at_a_point_rotates_in_place() {
        let (scene, [.., bulb]) = studio();
        let turned = after(&scene, &[bulb], HandleMode::Rotate, DragTransform::Rotate(Vec3::X, 0.3));
        let (now, before) = (&turned.lights[1], &scene.lights[1]);
        assert_eq!(now.position, before.position);
        let turn = Quat::from_axis_angle(Vec3::X, 0.3);
        let ahead = |scene: &Scene| -Vec3::from(scene.light_frame(&scene.lights[1]).matrix3.z_axis);
        assert!((ahead(&turned) - turn * ahead(&scene)).length() < 1e-5);
        let up = |scene: &Scene| Vec3::from(scene.light_frame(&scene.lights[1]).matrix3.y_axis);
        assert!((up(&turned) - turn * up(&scene)).length() < 1e-4, "the roll completes the turn");
    }

    #[test]
    fn aim_points_are_kept_when_only_lights_move() {
        let (scene, [_, softbox, bulb]) = studio();
        let by = Vec3::new(0.0, 0.5, 0.0);
        let moved = after(&scene, &[softbox, bulb], HandleMode::Move, DragTransform::Move(by));
        assert_eq!(moved.lights[1].aim, scene.lights[1].aim);
        assert_eq!(moved.lights[1].position, scene.lights[1].position + by);
    }

    #[test]
    fn scaled_sizes_stay_in_range() {
        let mut panel = Emitter::RectPanel { width_m: 0.6, height_m: 0.9 };
        resize(&mut panel, Vec3::new(2.0, 1.0, 1.0));
        assert_eq!(panel, Emitter::RectPanel { width_m: 1.2, height_m: 0.9 });
        let mut spot = Emitter::Spot { inner_deg: 40.0, outer_deg: 70.0 };
        resize(&mut spot, Vec3::splat(50.0));
        assert!(matches!(spot, Emitter::Spot { outer_deg, .. } if outer_deg < 180.0));
    }
}
