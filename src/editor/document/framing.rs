//! The camera before a person: framed as portraits are, and set up at the face.

use crate::editor::document::action::Action;
use crate::figures;
use crate::scene::{Aim, Assets, Camera, Facing, Figure, Focus, Meter, Object, ObjectId, Receptor, Scene, Shape};
use glam::Vec3;

/// Stature for which the lengths of [`Framing::below_eyes_m`] are stated, metres.
const STATURE_M: f32 = 1.7;
/// Least width of a frame for that stature: head and most of the shoulders, metres.
const SHOULDERS_M: f32 = 0.4;
/// Space over the head, and under the feet of a full figure, as parts of the frame's height.
const OVER_HEAD: f32 = 0.1;
const UNDER_FEET: f32 = 0.05;
/// Distance of the meter's dome from the middle of the face, metres: before the nose.
const METER_M: f32 = 0.06;
/// Least distance of the camera from a wall, metres.
const FROM_WALL_M: f32 = 0.15;
/// Shortest focal length that a small room may force, millimetres.
const SHORTEST_MM: f32 = 14.0;

/// The part of a person in the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Framing {
    /// From the middle of the chest.
    HeadAndShoulders,
    /// From the hips.
    HalfLength,
    /// With the feet.
    FullLength,
}

impl Framing {
    /// All framings, from close to far.
    pub const ALL: [Framing; 3] = [Framing::HeadAndShoulders, Framing::HalfLength, Framing::FullLength];

    /// Returns the label in menus and on buttons.
    pub fn label(self) -> &'static str {
        match self {
            Framing::HeadAndShoulders => "Head and shoulders",
            Framing::HalfLength => "Half length",
            Framing::FullLength => "Full length",
        }
    }

    /// Returns how far below the eyes the picture ends, for a person of [`STATURE_M`], metres; none for the feet.
    fn below_eyes_m(self) -> Option<f32> {
        match self {
            Framing::HeadAndShoulders => Some(0.42),
            Framing::HalfLength => Some(0.78),
            Framing::FullLength => None,
        }
    }
}

/// Returns the figure of an object.
fn figure_of(scene: &Scene, id: ObjectId) -> Option<(&Object, &Figure)> {
    let object = scene.object(id)?;
    if let Shape::Figure(figure) = &object.shape { Some((object, figure)) } else { None }
}

/// Returns the action that moves the camera before a person, from the side on which it is, at the height of the middle of
/// the picture, and lets it aim and focus at the person. In a room that is too small the focal length becomes shorter.
/// None for other objects.
pub fn frame_figure(scene: &Scene, assets: &Assets, id: ObjectId, framing: Framing) -> Option<Action> {
    let (object, figure) = figure_of(scene, id)?;
    let (low, high) = assets.object_bounds(object)?;
    let world_from_object = object.transform.world_from_object();
    let eyes = world_from_object.transform_point3(figures::eye_point(figure));
    let size = figure.body.height_m * object.transform.scale.y.abs() / STATURE_M;
    let (bottom, under) = match framing.below_eyes_m() {
        Some(below_m) => ((eyes.y - below_m * size).max(low.y), 0.0),
        None => (low.y, UNDER_FEET),
    };
    let camera = &scene.camera;
    let half_extent = scene.camera_frame(camera.aspect()).half_extent;
    let least_m = SHOULDERS_M * size * half_extent.y / half_extent.x;
    let height_m = ((high.y - bottom).max(0.1) / (1.0 - OVER_HEAD - under)).max(least_m);
    let middle = Vec3::new(eyes.x, high.y + (OVER_HEAD - 0.5) * height_m, eyes.z);
    let face = world_from_object.transform_vector3(figures::face_direction(figure));
    let flat = |way: Vec3| way.with_y(0.0).try_normalize();
    let direction = flat(camera.position - eyes).or(flat(face)).unwrap_or(Vec3::Z);
    let wanted_m = 0.5 * height_m / half_extent.y;
    let room_m = scene.room.as_ref().map_or(f32::INFINITY, |room| {
        let reach = |way: f32, from: f32, half: f32| match way.abs() {
            along if along > 1e-6 => (half - FROM_WALL_M - from * way.signum()) / along,
            _ => f32::INFINITY,
        };
        let half = 0.5 * room.size_m;
        reach(direction.x, middle.x, half.x).min(reach(direction.z, middle.z, half.z)).max(0.3)
    });
    let distance_m = wanted_m.min(room_m);
    let focal_length_mm = (camera.focal_length_mm * distance_m / wanted_m).max(SHORTEST_MM.min(camera.focal_length_mm));
    let local = world_from_object.inverse();
    let framed = Camera {
        position: middle + direction * distance_m,
        aim: Aim::Object { object: id, offset: local.transform_point3(middle) },
        focus: Focus::OnObject { object: id, offset: figures::eye_point(figure) },
        focal_length_mm,
        ..camera.clone()
    };
    let actions = vec![Action::SetCamera(Box::new(framed))];
    Some(Action::Together { label: format!("{} of {}", framing.label(), object.name), actions })
}

/// Returns the action that aims and focuses the camera at a face and holds the meter before it. None for other objects.
pub fn face_action(scene: &Scene, id: ObjectId) -> Option<Action> {
    let (object, figure) = figure_of(scene, id)?;
    let camera = Camera {
        aim: Aim::Object { object: id, offset: figures::face_point(figure) },
        focus: Focus::OnObject { object: id, offset: figures::eye_point(figure) },
        ..scene.camera.clone()
    };
    let world_from_object = object.transform.world_from_object();
    let ahead = world_from_object.transform_vector3(figures::face_direction(figure)).normalize_or(Vec3::Z);
    let position = world_from_object.transform_point3(figures::face_point(figure)) + ahead * METER_M;
    let meter = Meter { position, facing: Facing::Camera, receptor: Receptor::Dome };
    let actions = vec![Action::SetCamera(Box::new(camera)), Action::SetMeter(Some(meter))];
    Some(Action::Together { label: format!("Aim, focus and meter at the face of {}", object.name), actions })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::find_preset;
    use glam::Vec2;

    /// Returns where a point of the world is in the picture.
    fn in_picture(scene: &Scene, point: Vec3) -> Vec2 {
        scene.camera_frame(scene.camera.aspect()).project(point).unwrap()
    }

    #[test]
    fn people_are_framed_from_chest_hips_or_feet() {
        let loaded = find_preset("three_point").unwrap().load().unwrap();
        let person = loaded.scene.objects.iter().find(|object| matches!(object.shape, Shape::Figure(_))).unwrap();
        let (low, high) = loaded.assets.object_bounds(person).unwrap();
        let (_, figure) = figure_of(&loaded.scene, person.id).unwrap();
        let eyes = person.transform.world_from_object().transform_point3(figures::eye_point(figure));
        let mut last_m = 0.0;
        for framing in Framing::ALL {
            let mut scene = loaded.scene.clone();
            frame_figure(&scene, &loaded.assets, person.id, framing).unwrap().apply(&mut scene).unwrap();
            let [top, feet] = [high.y, low.y].map(|y| in_picture(&scene, eyes.with_y(y)).y);
            assert!((top - OVER_HEAD).abs() < 0.02, "{framing:?}: the head ends at {top}");
            assert_eq!(framing == Framing::FullLength, feet < 1.0, "{framing:?}: feet at {feet}");
            let across = in_picture(&scene, eyes);
            assert!((across.x - 0.5).abs() < 1e-3 && (0.1..0.45).contains(&across.y), "{framing:?}: eyes at {across}");
            let room = scene.room.as_ref().unwrap().size_m;
            assert!(scene.camera.position.z.abs() < 0.5 * room.z && scene.camera.position.x.abs() < 0.5 * room.x);
            let distance_m = (scene.camera.position - eyes).length() / scene.camera.focal_length_mm;
            assert!(distance_m > last_m, "farther, or of a shorter lens");
            last_m = distance_m;
            assert!((scene.aim_point(&scene.camera.aim, Vec3::ZERO).y - scene.camera.position.y).abs() < 1e-4);
        }
        let paper = loaded.scene.objects.iter().find(|object| !matches!(object.shape, Shape::Figure(_))).unwrap();
        assert!(frame_figure(&loaded.scene, &loaded.assets, paper.id, Framing::HalfLength).is_none());
        assert!(face_action(&loaded.scene, paper.id).is_none());
    }

    #[test]
    fn the_meter_is_held_before_a_face_that_the_camera_aims_at() {
        let loaded = find_preset("three_point").unwrap().load().unwrap();
        let mut scene = loaded.scene.clone();
        let person = scene.objects.iter().find(|object| matches!(object.shape, Shape::Figure(_))).unwrap().clone();
        scene.camera.aim = Aim::Point(Vec3::new(1.0, 0.2, 0.0));
        face_action(&scene, person.id).unwrap().apply(&mut scene).unwrap();
        let (_, figure) = figure_of(&scene, person.id).unwrap();
        let face = person.transform.world_from_object().transform_point3(figures::face_point(figure));
        assert!((in_picture(&scene, face) - 0.5).length() < 1e-3);
        let meter = scene.meter.unwrap();
        assert!((meter.position - face).length() < 0.1 && meter.receptor == Receptor::Dome);
        assert!(matches!(scene.camera.focus, Focus::OnObject { object, .. } if object == person.id));
    }
}
