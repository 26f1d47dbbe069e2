//! Placement of new items: position, aim and power relative to the subject and the camera.

use crate::editor::document::item::Item;
use crate::editor::document::readout;
use crate::figures;
use crate::scene::{Aim, Assets, Light, Object, ObjectId, Role, Scene, Shape};
use glam::{Quat, Vec3};

/// Height of the aim point without a subject, metres.
const NOTHING_HEIGHT_M: f32 = 1.3;

/// Returns the point of an object that lights and camera aim at, object space: a figure's face, the middle of any
/// other.
pub fn aim_offset(object: &Object, assets: &Assets) -> Vec3 {
    match &object.shape {
        Shape::Figure(figure) => figures::face_point(figure),
        Shape::Sweep { height_m, depth_m, .. } => Vec3::new(0.0, 0.5 * height_m, 0.2 * depth_m),
        _ => assets.mesh_of(&object.shape).map_or(Vec3::ZERO, |mesh| {
            let (low, high) = mesh.bounds();
            0.5 * (low + high)
        }),
    }
}

/// Returns the subject: the selected object, else the first figure, else the first object that is no backdrop.
pub fn subject(scene: &Scene, selected: Option<Item>) -> Option<ObjectId> {
    let is_backdrop = |object: &Object| matches!(object.shape, Shape::Sweep { .. } | Shape::Plane { .. });
    let selected = match selected {
        Some(Item::Object(id)) => scene.object(id).filter(|o| !is_backdrop(o)),
        _ => None,
    };
    selected
        .or_else(|| scene.objects.iter().find(|o| matches!(o.shape, Shape::Figure(_))))
        .or_else(|| scene.objects.iter().find(|o| !is_backdrop(o)))
        .map(|o| o.id)
}

/// Returns the aim at a subject's face or middle; a point over the origin without a subject.
pub fn aim_at(scene: &Scene, assets: &Assets, subject: Option<ObjectId>) -> Aim {
    match subject.and_then(|id| scene.object(id)) {
        Some(object) => Aim::Object { object: object.id, offset: aim_offset(object, assets) },
        None => Aim::Point(Vec3::Y * NOTHING_HEIGHT_M),
    }
}

/// Returns the aim along a direction as angles; horizontal to the back for the zero vector.
pub fn angles_towards(direction: Vec3) -> Aim {
    let d = direction.try_normalize().unwrap_or(Vec3::NEG_Z);
    Aim::Angles { yaw_deg: (-d.x).atan2(-d.z).to_degrees(), pitch_deg: 90.0 - crate::math::safe_acos(d.y).to_degrees() }
}

/// Returns the angle wrapped to (-180, 180] degrees.
pub fn wrap_deg(angle: f32) -> f32 {
    let wrapped = angle.rem_euclid(360.0);
    if wrapped > 180.0 { wrapped - 360.0 } else { wrapped }
}

/// Returns the horizontal unit direction from a point to the camera; +Z if the camera is straight above.
fn towards_camera(scene: &Scene, point: Vec3) -> Vec3 {
    let direction = scene.camera.position - point;
    Vec3::new(direction.x, 0.0, direction.z).try_normalize().unwrap_or(Vec3::Z)
}

/// Sets the first unused role of a new light, its position, its aim at the subject and a power that matches the
/// camera's exposure.
pub fn place_light(scene: &Scene, assets: &Assets, selected: Option<Item>, light: &mut Light) {
    let has = |role| scene.lights.iter().any(|l| l.role == role);
    // Azimuth from the camera's direction (positive: from the camera's right), elevation, distance, stops over the key.
    let (role, azimuth_deg, elevation_deg, distance_m, stops) = if !has(Role::Key) {
        (Role::Key, -40.0_f32, 35.0_f32, 1.6, 0.0)
    } else if !has(Role::Fill) {
        (Role::Fill, 40.0, 10.0, 2.0, -2.0)
    } else if !has(Role::Rim) {
        (Role::Rim, 150.0, 30.0, 1.8, 0.0)
    } else {
        (Role::Accent, -140.0, 35.0, 1.8, -0.5)
    };
    light.role = role;
    light.aim = aim_at(scene, assets, subject(scene, selected));
    let target = scene.aim_point(&light.aim, light.position);
    let (sin, cos) = elevation_deg.to_radians().sin_cos();
    let around = Quat::from_rotation_y(azimuth_deg.to_radians()) * towards_camera(scene, target);
    light.position = target + (around * cos + Vec3::Y * sin) * distance_m;
    light.position.y = light.position.y.max(0.1);
    // The dial ends at full power.
    light.power.dial_stops = readout::dial_for(scene, light, stops).min(0.0);
}

/// Positions a new object: figures and props on free floor, backdrops behind the subject and facing the camera.
pub fn place_object(scene: &Scene, selected: Option<Item>, object: &mut Object) {
    if matches!(object.shape, Shape::Sweep { .. }) {
        let middle = subject(scene, selected)
            .and_then(|id| scene.object(id))
            .map_or(Vec3::ZERO, |o| Vec3::new(o.transform.position.x, 0.0, o.transform.position.z));
        let front = towards_camera(scene, middle);
        // Slightly above the floor, to avoid coplanar surfaces.
        object.transform.position = middle - front * 1.5 + Vec3::Y * 0.002;
        object.transform.rotation_deg.y = front.x.atan2(front.z).to_degrees();
        return;
    }
    let step = if matches!(object.shape, Shape::Figure(_)) { 0.9 } else { 0.5 };
    let height_m = object.transform.position.y;
    let free = (0..64).map(|i| row_place(i, step)).find(|place| is_free(scene, *place, step)).unwrap_or(Vec3::ZERO);
    object.transform.position = free + Vec3::Y * height_m;
}

/// Returns the candidate position `i`: in a row outwards from the middle, then in further rows towards the front.
fn row_place(i: u32, step: f32) -> Vec3 {
    let (row, column) = (i / 8, i % 8);
    let side = if column % 2 == 1 { 1.0 } else { -1.0 };
    Vec3::new(side * column.div_ceil(2) as f32 * step, 0.0, row as f32 * step)
}

fn is_free(scene: &Scene, place: Vec3, step: f32) -> bool {
    scene.objects.iter().filter(|o| !matches!(o.shape, Shape::Sweep { .. })).all(|o| {
        let apart = o.transform.position - place;
        apart.x.hypot(apart.z) > 0.9 * step
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::editor::document::action::Action;
    use crate::editor::document::catalog;

    fn add(scene: &mut Scene, name: &str) {
        let mut object = catalog::object_named(name).unwrap();
        place_object(scene, None, &mut object);
        Action::AddObject(Box::new(object)).apply(scene).unwrap();
    }

    #[test]
    fn aim_angles_reproduce_the_direction() {
        let scene = Scene::default();
        for direction in [Vec3::new(1.0, 2.0, -3.0), Vec3::new(-0.2, -5.0, 1.0), Vec3::X] {
            let aimed = scene.aim_point(&angles_towards(direction), Vec3::ZERO);
            assert!((aimed - direction.normalize()).length() < 1e-5, "{direction} became {aimed}");
        }
    }

    #[test]
    fn three_lights_become_key_fill_and_rim_at_their_ratio() {
        let mut scene = Scene::default();
        add(&mut scene, "Boy, 10, short hair");
        for _ in 0..3 {
            let mut light = catalog::light_named("Softbox 60 x 90").unwrap();
            place_light(&scene, &Assets::default(), None, &mut light);
            Action::AddLight(Box::new(light)).apply(&mut scene).unwrap();
        }
        let roles: Vec<Role> = scene.lights.iter().map(|l| l.role).collect();
        assert_eq!(roles, [Role::Key, Role::Fill, Role::Rim]);
        let over = |i: usize| readout::stops_over_camera(&scene, readout::at_aim(&scene, &scene.lights[i]).lux_s);
        assert!(over(0).abs() < 0.2 && (over(1) + 2.0).abs() < 0.2, "{} {}", over(0), over(1));
        assert!(scene.lights[0].position.x < 0.0, "the key comes from the camera's left");
        assert!(scene.lights[2].position.z < 0.0, "the rim comes from behind");
    }

    #[test]
    fn new_objects_do_not_overlap() {
        let mut scene = Scene::default();
        for name in ["Boy, 10, short hair", "Man, 30, crop", "Chrome ball", "Can", "Box"] {
            add(&mut scene, name);
        }
        for (i, a) in scene.objects.iter().enumerate() {
            for b in &scene.objects[..i] {
                let apart = a.transform.position - b.transform.position;
                assert!(apart.x.hypot(apart.z) > 0.4, "{} in {}", a.name, b.name);
            }
        }
    }

    #[test]
    fn a_backdrop_is_placed_behind_the_subject_and_faces_the_camera() {
        let mut scene = Scene::default();
        add(&mut scene, "Boy, 10, short hair");
        scene.camera.position = Vec3::new(3.0, 1.4, 0.0);
        add(&mut scene, "Grey paper 2.72 m");
        let paper = &scene.objects[1].transform;
        assert!((paper.position - Vec3::new(-1.5, 0.002, 0.0)).length() < 1e-5, "{}", paper.position);
        assert!((paper.rotation() * Vec3::Z - Vec3::X).length() < 1e-5);
    }
}
