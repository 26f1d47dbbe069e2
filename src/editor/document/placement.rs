//! Placement of new items: position, aim and power relative to the subject and the camera.

use crate::editor::document::item::Item;
use crate::editor::document::readout;
use crate::figures::{self, Joint, PosableBody};
use crate::scene::{Aim, Assets, Light, MaterialPreset, Object, ObjectId, PropModel, Role, Scene, Shape};
use glam::{Quat, Vec2, Vec3};

/// Distance between the subject's middle and the opening of a V-flat beside it, metres.
const BESIDE_M: f32 = 0.45;
/// Depth that a reflector and a flag count with beside the subject, metres.
const BOARD_M: f32 = 0.3;
/// Height of a face over the middle of a reflector for it, and the reflector's radius, metres.
const BELOW_FACE_M: f32 = 0.3;
const REFLECTOR_RADIUS_M: f32 = 0.56;
/// Radius of a stool, metres.
const STOOL_RADIUS_M: f32 = 0.17;
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

/// Returns the subject: the selected object, else the first figure, else the first object. Backdrops, and what stands beside
/// a subject for its light, are none.
pub fn subject(scene: &Scene, selected: Option<Item>) -> Option<ObjectId> {
    let is_subject = |object: &&Object| !object.shape.is_sheet() && depth_beside(&object.shape).is_none();
    let selected = match selected {
        Some(Item::Object(id)) => scene.object(id).filter(is_subject),
        _ => None,
    };
    selected
        .or_else(|| scene.objects.iter().find(|o| matches!(o.shape, Shape::Figure(_))))
        .or_else(|| scene.objects.iter().find(is_subject))
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
    let stops = readout::dial_for(scene, assets, light, stops).min(0.0);
    light.power.dial_stops = light.head.as_ref().map_or(stops, |head| head.dial.nearest(stops));
}

/// Positions a new object: figures and props on free floor, backdrops behind the subject and facing the camera.
pub fn place_object(scene: &Scene, selected: Option<Item>, object: &mut Object) {
    if matches!(object.shape, Shape::Sweep { .. }) || matches!(object.shape, Shape::Prop(model) if model.is_backdrop())
    {
        let middle = subject(scene, selected)
            .and_then(|id| scene.object(id))
            .map_or(Vec3::ZERO, |o| Vec3::new(o.transform.position.x, 0.0, o.transform.position.z));
        let front = towards_camera(scene, middle);
        // Slightly above the floor, to avoid coplanar surfaces.
        object.transform.position = middle - front * 1.5 + Vec3::Y * 0.002;
        object.transform.rotation_deg.y = front.x.atan2(front.z).to_degrees();
        return;
    }
    if let Some(depth_m) = depth_beside(&object.shape) {
        place_beside(scene, subject(scene, selected), depth_m, object);
        return;
    }
    let step = if matches!(object.shape, Shape::Figure(_)) { 0.9 } else { 0.5 };
    let height_m = object.transform.position.y;
    let free = (0..64).map(|i| row_place(i, step)).find(|place| is_free(scene, *place, step)).unwrap_or(Vec3::ZERO);
    object.transform.position = free + Vec3::Y * height_m;
}

/// Returns a round stool that fits under a seated figure, up to what is lowest over it; none for anything else.
pub fn stool_under(object: &Object, assets: &Assets) -> Option<Object> {
    let Shape::Figure(figure) = &object.shape else { return None };
    let seat_m = figure.pose.seat_m?;
    let hips = PosableBody::new(figure).place(Joint::Hips);
    let place = object.transform.world_from_object().transform_point3(Vec3::new(hips.x, 0.0, hips.z));
    let is_over = |point: &&Vec3| Vec2::new(point.x - hips.x, point.z - hips.z).length() < STOOL_RADIUS_M;
    let mesh = assets.coarse_mesh_of(&object.shape);
    let over = mesh.iter().flat_map(|mesh| mesh.positions.iter()).filter(is_over).map(|point| point.y);
    let lowest_m = over.reduce(f32::min).unwrap_or(seat_m).clamp(0.5 * seat_m, 1.2 * seat_m);
    let height_m = lowest_m * object.transform.scale.y.abs();
    let shape = Shape::Cylinder { radius_m: STOOL_RADIUS_M, height_m };
    let mut stool = Object { material: MaterialPreset::MatteFabric.material(), ..Object::new("Stool", shape) };
    stool.transform.position = place + Vec3::Y * (0.5 * height_m);
    Some(stool)
}

/// Returns the depth of what stands beside the subject and changes its light, metres: V-flats, reflectors and flags. None
/// for anything else.
fn depth_beside(shape: &Shape) -> Option<f32> {
    match *shape {
        Shape::VFlat { wing_m, angle_deg, .. } => Some(wing_m * (0.5 * angle_deg.to_radians()).cos()),
        Shape::Prop(PropModel::Reflector | PropModel::Flag) => Some(BOARD_M),
        _ => None,
    }
}

/// Puts what changes the light beside the subject, open to it: on the side away from the key light, or on the other if
/// something is there. A reflector is held below the face. `depth_m` is its depth.
fn place_beside(scene: &Scene, subject: Option<ObjectId>, depth_m: f32, object: &mut Object) {
    let subject = subject.and_then(|id| scene.object(id));
    let middle = subject.map_or(Vec3::ZERO, |subject| subject.transform.position);
    let front = towards_camera(scene, middle);
    let right = Vec3::Y.cross(front);
    let key = scene.lights.iter().find(|light| light.role == Role::Key && !light.emitter.is_infinite());
    let from_key = key.map_or(1.0, |key| -(key.position - middle).dot(right).signum());
    let places = [from_key, -from_key].map(|side| (right * side, middle + right * (side * (depth_m + BESIDE_M))));
    let is_free = |place: Vec3| {
        scene.objects.iter().filter(|o| depth_beside(&o.shape).is_some()).all(|o| {
            let apart = o.transform.position - place;
            apart.x.hypot(apart.z) > BESIDE_M
        })
    };
    let (away, place) = places.into_iter().find(|(_, place)| is_free(*place)).unwrap_or(places[0]);
    (object.transform.position.x, object.transform.position.z) = (place.x, place.z);
    object.transform.rotation_deg.y = (-away.x).atan2(-away.z).to_degrees();
    if let (Shape::Prop(PropModel::Reflector), Some(Shape::Figure(figure))) =
        (&object.shape, subject.map(|subject| &subject.shape))
    {
        let face_m = middle.y + figures::face_point(figure).y;
        object.transform.position.y = (face_m - BELOW_FACE_M - REFLECTOR_RADIUS_M).max(0.0);
    }
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
    use crate::scene::{Asset, AssetRef, Figure};

    /// Adds an object as the shelf does: the last one is selected.
    fn add(scene: &mut Scene, name: &str) {
        let mut object = catalog::object_named(name).unwrap();
        let selected = scene.objects.last().map(|object| Item::Object(object.id));
        place_object(scene, selected, &mut object);
        Action::AddObject(Box::new(object)).apply(scene).unwrap();
    }

    #[test]
    fn a_stool_fits_under_a_seated_person() {
        let mut person = catalog::object_named("Boy, 10, short hair").unwrap();
        assert!(stool_under(&person, &Assets::default()).is_none(), "a standing person needs none");
        person.transform.position = Vec3::new(1.0, 0.0, -0.5);
        person.transform.rotation_deg.y = 90.0;
        let Shape::Figure(figure) = &mut person.shape else { panic!("a figure") };
        figure.pose = figures::NamedPose::Seated.pose();
        let seat_m = figure.pose.seat_m.unwrap();
        let meshes = figures::build(figure);
        let mut assets = Assets::default();
        let key = AssetRef::figure(std::borrow::Cow::Owned(Figure::clone(figure)));
        assets.insert(key, Asset::Figure(meshes.clone()));
        let stool = stool_under(&person, &assets).unwrap();
        let Shape::Cylinder { height_m, radius_m } = stool.shape else { panic!("a round stool") };
        assert!((0.8 * seat_m..1.05 * seat_m).contains(&height_m), "{height_m} m for a seat of {seat_m} m");
        assert_eq!(stool.transform.position.y, 0.5 * height_m, "it stands on the floor");
        let to_world = person.transform.world_from_object();
        let over = |point: &Vec3| {
            let from = to_world.transform_point3(*point) - stool.transform.position;
            from.x.hypot(from.z) < radius_m
        };
        let trunk: Vec<f32> = meshes.fine.positions.iter().filter(|point| over(point)).map(|point| point.y).collect();
        let lowest = trunk.iter().copied().fold(f32::INFINITY, f32::min);
        assert!(trunk.len() > 100 && (lowest - height_m).abs() < 0.01, "{lowest} m over the floor, stool {height_m} m");
    }

    #[test]
    fn a_reflector_is_held_beside_the_face_and_a_flag_stands_on_the_other_side() {
        let mut scene = Scene::default();
        add(&mut scene, "Man, 30, crop");
        add(&mut scene, "Reflector, white");
        add(&mut scene, "Flag on a stand");
        let [person, reflector, flag] = [0, 1, 2].map(|index| &scene.objects[index]);
        let from_person = |board: &Object| (board.transform.position - person.transform.position).with_y(0.0);
        for board in [reflector, flag] {
            let faces = board.transform.world_from_object().transform_vector3(Vec3::Z);
            assert!(faces.dot(from_person(board).normalize()) < -0.99, "{} faces the person", board.name);
            assert!((0.6..1.2).contains(&from_person(board).length()), "{}", from_person(board));
        }
        assert!(from_person(reflector).dot(from_person(flag)) < 0.0, "one on each side");
        let middle_m = reflector.transform.position.y + REFLECTOR_RADIUS_M;
        assert!((1.1..1.6).contains(&middle_m), "{middle_m} m, for a face at {:?}", person.shape.label());
        assert_eq!(flag.transform.position.y, 0.0, "on its stand");
    }

    #[test]
    fn v_flats_stand_beside_the_subject_open_to_it_first_on_the_side_away_from_the_key() {
        let mut scene = Scene::default();
        add(&mut scene, "Boy, 10, short hair");
        let mut key = catalog::light_named("Softbox 60 x 90").unwrap();
        place_light(&scene, &Assets::default(), None, &mut key);
        Action::AddLight(Box::new(key)).apply(&mut scene).unwrap();
        let person = scene.objects[0].transform.position;
        let to_key = scene.lights[0].position - person;
        for (name, is_away) in [("V-flat, white", true), ("V-flat, black", false)] {
            add(&mut scene, name);
            let flat = scene.objects.last().unwrap();
            let from_person = (flat.transform.position - person) * Vec3::new(1.0, 0.0, 1.0);
            assert_eq!(from_person.dot(to_key) < 0.0, is_away, "{name}");
            assert!((1.0..1.6).contains(&from_person.length()), "{from_person}");
            let opens = flat.transform.world_from_object().transform_vector3(Vec3::Z);
            assert!(opens.dot(from_person) < -1.0, "{name} opens to the person: {opens}");
        }
        let [white, black] = [1, 2].map(|index| scene.objects[index].transform.position - person);
        assert!(white.x * black.x < 0.0 || white.z * black.z < 0.0, "one on each side");
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
        let over = |i: usize| {
            readout::stops_over_camera(&scene, readout::at_aim(&scene, &Assets::default(), &scene.lights[i]).lux_s)
        };
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
