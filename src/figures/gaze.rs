//! Turns the eyes of figures to what they follow.

use super::head_frame;
use crate::scene::{Figure, Gaze, Object, ParameterSet, Scene, Shape, Torso, VariantId};
use glam::Vec3;

/// Angles are rounded to this, degrees: a smaller turn is not seen, and each other angle is another mesh.
const STEP_DEG: f32 = 0.25;
/// Distance of a sun for the eyes, metres.
const FAR_M: f32 = 1000.0;

/// Turns the eyes of every figure that follows the camera or a light to it, as far as eyes turn. What a figure follows
/// and is not there leaves them as they are.
pub fn follow_gazes(scene: &mut Scene) {
    for index in 0..scene.objects.len() {
        let Some([yaw_deg, pitch_deg]) = gaze_angles(scene, &scene.objects[index]) else { continue };
        let Shape::Figure(figure) = &mut scene.objects[index].shape else { continue };
        let torso = &mut figure.pose.torso;
        let turned = Torso { gaze_yaw_deg: yaw_deg, gaze_pitch_deg: pitch_deg, ..Torso::default() }.clamped();
        (torso.gaze_yaw_deg, torso.gaze_pitch_deg) = (turned.gaze_yaw_deg, turned.gaze_pitch_deg);
    }
}

/// Shows a variant of a studio, and turns the eyes that follow its camera or its lights. Returns false if there is no such
/// variant.
pub fn show_variant(scene: &mut Scene, id: VariantId) -> bool {
    let is_there = scene.show_variant(id);
    follow_gazes(scene);
    is_there
}

/// Returns the scene with a variant shown. None if there is no such variant.
pub fn as_variant(scene: &Scene, id: VariantId) -> Option<Scene> {
    let mut scene = scene.clone();
    show_variant(&mut scene, id).then_some(scene)
}

/// Returns true if a figure's eyes are turned as far as they go and still do not meet what they follow.
pub fn gaze_falls_short(scene: &Scene, object: &Object) -> bool {
    let Shape::Figure(figure) = &object.shape else { return false };
    let torso = &figure.pose.torso;
    gaze_angles(scene, object).is_some_and(|wanted| wanted != [torso.gaze_yaw_deg, torso.gaze_pitch_deg])
}

/// Returns the angles of the eyes, to the figure's left and downwards, that meet what they follow, degrees. None for
/// the angles of the pose.
fn gaze_angles(scene: &Scene, object: &Object) -> Option<[f32; 2]> {
    let Shape::Figure(figure) = &object.shape else { return None };
    let target = gaze_target(scene, figure.gaze)?;
    let head_from_world = (object.transform.world_from_object() * head_frame(figure)).inverse();
    let local = head_from_world.transform_point3(target);
    let angles = [local.x.atan2(local.z), (-local.y).atan2(local.x.hypot(local.z))];
    let rounded = angles.map(|angle| (angle.to_degrees() / STEP_DEG).round() * STEP_DEG + 0.0);
    rounded.iter().all(|angle| angle.is_finite()).then_some(rounded)
}

/// Returns the point that a gaze meets, world space, metres.
fn gaze_target(scene: &Scene, gaze: Gaze) -> Option<Vec3> {
    match gaze {
        Gaze::Pose => None,
        Gaze::Camera => Some(scene.camera.position),
        Gaze::Light(light) => {
            let light = scene.light_of_any_variant(light)?;
            let away = scene.aim_vector(&light.aim, light.position).normalize_or_zero() * FAR_M;
            Some(if light.emitter.is_infinite() { light.position - away } else { light.position })
        }
    }
}

/// Returns the figure with eyes straight ahead that follow nothing: all that is left of the gaze in a head's place.
pub(super) fn without_gaze(figure: &Figure) -> Figure {
    let mut ahead = *figure;
    ahead.gaze = Gaze::Pose;
    (ahead.pose.torso.gaze_yaw_deg, ahead.pose.torso.gaze_pitch_deg) = (0.0, 0.0);
    ahead
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figures::{build, build_from, corneas, eye_point};
    use crate::scene::{Emitter, Light, LightId, ObjectId, Output};

    /// Returns a person before the camera, and a lamp beside it.
    fn portrait() -> Scene {
        let object = Object::new("Person", Shape::Figure(Box::default()));
        let mut scene = Scene {
            objects: vec![object],
            lights: vec![Light::new(Emitter::Point, Output::Lumens(1000.0))],
            ..Scene::default()
        };
        scene.camera.position = Vec3::new(0.2, 1.6, 2.0);
        scene
    }

    fn figure(scene: &mut Scene) -> &mut Figure {
        match &mut scene.objects[0].shape {
            Shape::Figure(figure) => figure,
            _ => panic!("the first object is a person"),
        }
    }

    /// Returns the angle between the direction of the eyes and a target, degrees.
    fn error_deg(scene: &Scene, target: Vec3) -> f32 {
        let Shape::Figure(figure) = &scene.objects[0].shape else { panic!() };
        let world_from_object = scene.objects[0].transform.world_from_object();
        let eyes = world_from_object.transform_point3(eye_point(figure));
        let [left, right] = corneas(figure).map(|cornea| world_from_object.transform_vector3(cornea.axis));
        assert!(left.distance(right) < 1e-5);
        left.angle_between(target - eyes).to_degrees()
    }

    #[test]
    fn eyes_follow_the_camera_and_a_light_whatever_moves() {
        let mut scene = portrait();
        figure(&mut scene).gaze = Gaze::Camera;
        for step in 0..4 {
            scene.camera.position += Vec3::new(0.1, 0.05 * step as f32, -0.1);
            scene.objects[0].transform.rotation_deg.y += 3.0;
            figure(&mut scene).pose.torso.head_yaw_deg -= 2.0;
            follow_gazes(&mut scene);
            assert!(error_deg(&scene, scene.camera.position) < 0.5, "{}", error_deg(&scene, scene.camera.position));
            assert!(!gaze_falls_short(&scene, &scene.objects[0]));
        }
        let key = &mut scene.lights[0];
        key.position = scene.camera.position + Vec3::new(-0.4, 0.3, 0.0);
        let (id, position) = (key.id, key.position);
        figure(&mut scene).gaze = Gaze::Light(id);
        follow_gazes(&mut scene);
        assert!(error_deg(&scene, position) < 0.5, "{}", error_deg(&scene, position));
    }

    #[test]
    fn eyes_stop_at_their_limits_and_stay_when_a_light_is_gone() {
        let mut scene = portrait();
        let behind = scene.objects[0].transform.position + Vec3::new(1.0, 1.6, -2.0);
        scene.lights.push(Light { id: LightId(99), position: behind, ..scene.lights[0].clone() });
        figure(&mut scene).gaze = Gaze::Light(LightId(99));
        follow_gazes(&mut scene);
        assert_eq!(figure(&mut scene).pose.torso.gaze_yaw_deg, 35.0);
        assert!(gaze_falls_short(&scene, &scene.objects[0]));
        scene.lights.pop();
        let before = scene.clone();
        follow_gazes(&mut scene);
        assert_eq!(scene.objects[0].id, ObjectId(0));
        assert!(scene == before);
    }

    #[test]
    fn meshes_with_other_gaze_are_those_of_a_build() {
        let mut scene = portrait();
        let before = *figure(&mut scene);
        let mut after = before;
        (after.pose.torso.gaze_yaw_deg, after.pose.torso.gaze_pitch_deg) = (-20.0, 10.0);
        let (built, fresh) = (build(&before), build(&after));
        let turned = build_from(&before, &built, &after).unwrap();
        for (turned, fresh) in [(&turned.fine, &fresh.fine), (&turned.coarse, &fresh.coarse)] {
            assert!(turned.positions == fresh.positions && turned.normals == fresh.normals);
            assert!(turned.triangles == fresh.triangles);
        }
        assert!(built.fine.positions != turned.fine.positions);
        after.expression.smile = 0.5;
        assert!(build_from(&before, &built, &after).is_none());
    }
}
