//! Adds, deletes, duplicates and mirrors items of a scene.

use crate::editor::document::action_error::ActionError;
use crate::editor::document::item::Item;
use crate::editor::document::placement::angles_towards;
use crate::editor::document::switches;
use crate::figures;
use crate::scene::{Aim, BarnDoors, Emitter, Facing, Focus, Gaze, Light, LightId, Object, ObjectId, Scene, Shape};
use glam::{Quat, Vec3};
use std::collections::HashMap;

/// Offset of a copy from its original, metres.
const COPY_OFFSET: Vec3 = Vec3::new(0.4, 0.0, 0.0);

/// Adds an object with a new id and a unique name.
pub fn add_object(scene: &mut Scene, mut object: Object) -> Item {
    object.id = scene.fresh_object_id();
    object.name = scene.unique_name(&object.name);
    let item = Item::Object(object.id);
    scene.objects.push(object);
    item
}

/// Adds a light with a new id and a unique name.
pub fn add_light(scene: &mut Scene, mut light: Light) -> Item {
    light.id = scene.fresh_light_id();
    light.name = scene.unique_name(&light.name);
    let item = Item::Light(light.id);
    scene.lights.push(light);
    item
}

/// Deletes items. Aims at a deleted object become aims at the same point of the room.
pub fn delete(scene: &mut Scene, items: &[Item]) -> Result<(), ActionError> {
    for &item in items {
        if item.is_locked(scene) {
            return Err(ActionError::Locked(item.name(scene)));
        }
        match item {
            Item::Object(id) => {
                scene.object(id).ok_or(ActionError::Gone)?;
                release_aims(scene, id);
                scene.forget_in_variants(id);
                scene.objects.retain(|o| o.id != id);
            }
            Item::Light(id) => {
                scene.light(id).ok_or(ActionError::Gone)?;
                scene.lights.retain(|l| l.id != id);
                // A light that is added later may get its id
                scene.drop_equal_parts_of_variants();
                if scene.light_of_any_variant(id).is_none() {
                    release_gazes(scene, id);
                }
            }
            Item::Meter => scene.meter = None,
            Item::Camera => return Err(ActionError::Fixed("camera")),
            Item::Room => return Err(ActionError::Fixed("room")),
        }
    }
    switches::remove_deleted_lights(scene);
    Ok(())
}

/// Replaces every aim and focus on an object, in all variants, by one at the same point of the room.
fn release_aims(scene: &mut Scene, id: ObjectId) {
    let fixed = |scene: &Scene, aim: Aim| match aim {
        Aim::Object { object, .. } if object == id => Aim::Point(scene.aim_point(&aim, Vec3::ZERO)),
        other => other,
    };
    scene.camera.aim = fixed(scene, scene.camera.aim);
    for i in 0..scene.lights.len() {
        scene.lights[i].aim = fixed(scene, scene.lights[i].aim);
    }
    let mut variants = std::mem::take(&mut scene.variants);
    variants.stored_aims_mut().for_each(|aim| *aim = fixed(scene, *aim));
    for focus in variants.stored_focuses_mut().chain([&mut scene.camera.focus]) {
        if matches!(*focus, Focus::OnObject { object, .. } if object == id) {
            *focus = Focus::OnAim;
        }
    }
    scene.variants = variants;
}

/// Lets the eyes of figures that follow a light rest where they are.
fn release_gazes(scene: &mut Scene, id: LightId) {
    for object in &mut scene.objects {
        if let Shape::Figure(figure) = &mut object.shape
            && figure.gaze == Gaze::Light(id)
        {
            figure.gaze = Gaze::Pose;
        }
    }
}

/// Adds copies beside the items; copied lights aim at the copies of their subjects. Returns the copies.
pub fn duplicate(scene: &mut Scene, items: &[Item]) -> Result<Vec<Item>, ActionError> {
    let copies = copy(scene, items)?;
    for &item in &copies {
        match item {
            Item::Object(id) => {
                scene.object_mut(id).ok_or(ActionError::Gone)?.transform.position += COPY_OFFSET;
            }
            Item::Light(id) => scene.light_mut(id).ok_or(ActionError::Gone)?.position += COPY_OFFSET,
            Item::Camera | Item::Room | Item::Meter => {}
        }
    }
    Ok(copies)
}

/// Adds unlocked copies at the same positions; returns them in the order of the originals.
fn copy(scene: &mut Scene, items: &[Item]) -> Result<Vec<Item>, ActionError> {
    let (mut objects, mut lights) = (Vec::new(), Vec::new());
    for item in items {
        match item {
            Item::Object(id) => objects.push(scene.object(*id).ok_or(ActionError::Gone)?.clone()),
            Item::Light(id) => lights.push(scene.light(*id).ok_or(ActionError::Gone)?.clone()),
            Item::Camera => return Err(ActionError::Fixed("camera")),
            Item::Room => return Err(ActionError::Fixed("room")),
            Item::Meter => return Err(ActionError::Single),
        }
    }
    let copies = add_copies(scene, &objects, &lights);
    if let Some(solo) = &mut scene.solo {
        for list in [&mut solo.lights, &mut solo.restores] {
            let new: Vec<LightId> = list.iter().filter_map(|light| copies.lights.get(light).copied()).collect();
            list.extend(new);
        }
    }
    Ok(items.iter().filter_map(|item| copies.of(*item)).collect())
}

/// Adds the lights and objects of another scene, unlocked, and returns them. Aims and gazes among them are kept. They
/// keep their positions, or move aside until none is at a position that is taken.
pub fn paste(scene: &mut Scene, from: &Scene) -> Vec<Item> {
    fn positions(scene: &Scene) -> impl Iterator<Item = Vec3> {
        let objects = scene.objects.iter().map(|object| object.transform.position);
        objects.chain(scene.lights.iter().map(|light| light.position))
    }
    let taken: Vec<Vec3> = positions(scene).collect();
    let mut offset = Vec3::ZERO;
    while positions(from).any(|position| taken.iter().any(|taken| taken.distance(position + offset) < 1e-3)) {
        offset += COPY_OFFSET;
    }
    let (mut objects, mut lights) = (from.objects.clone(), from.lights.clone());
    objects.iter_mut().for_each(|object| object.transform.position += offset);
    lights.iter_mut().for_each(|light| light.position += offset);
    let copies = add_copies(scene, &objects, &lights);
    let objects = from.objects.iter().map(|object| Item::Object(object.id));
    let lights = from.lights.iter().map(|light| Item::Light(light.id));
    objects.chain(lights).filter_map(|item| copies.of(item)).collect()
}

/// Copies by the ids of their originals.
struct Copies {
    objects: HashMap<ObjectId, ObjectId>,
    lights: HashMap<LightId, LightId>,
}

impl Copies {
    /// Returns the copy of an object or a light.
    fn of(&self, original: Item) -> Option<Item> {
        match original {
            Item::Object(id) => self.objects.get(&id).copied().map(Item::Object),
            Item::Light(id) => self.lights.get(&id).copied().map(Item::Light),
            Item::Camera | Item::Room | Item::Meter => None,
        }
    }
}

/// Adds unlocked copies of objects and lights. Copies aim and look at the copies of what the originals do.
fn add_copies(scene: &mut Scene, objects: &[Object], lights: &[Light]) -> Copies {
    let mut copies = Copies { objects: HashMap::new(), lights: HashMap::new() };
    for object in objects {
        if let Item::Object(new) = add_object(scene, Object { locked: false, ..object.clone() }) {
            copies.objects.insert(object.id, new);
        }
    }
    for light in lights {
        let mut copied = Light { locked: false, ..light.clone() };
        if let Aim::Object { object, .. } = &mut copied.aim {
            *object = copies.objects.get(object).copied().unwrap_or(*object);
        }
        if let Item::Light(new) = add_light(scene, copied) {
            copies.lights.insert(light.id, new);
        }
    }
    for object in copies.objects.values() {
        if let Some(Shape::Figure(figure)) = scene.object_mut(*object).map(|object| &mut object.shape)
            && let Gaze::Light(light) = &mut figure.gaze
        {
            *light = copies.lights.get(light).copied().unwrap_or(*light);
        }
    }
    copies
}

/// A vertical mirror plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MirrorPlane {
    /// A point of the plane, metres.
    pub point: Vec3,
    /// Horizontal unit normal.
    pub normal: Vec3,
}

impl MirrorPlane {
    /// Returns the vertical plane through a subject's face along its facing direction; other objects face their own +Z.
    /// None for a subject that faces straight up or down.
    pub fn of_subject(subject: &Object) -> Option<MirrorPlane> {
        let own = match subject.shape {
            Shape::Figure(ref figure) => figures::face_direction(figure),
            _ => Vec3::Z,
        };
        let face = match subject.shape {
            Shape::Figure(ref figure) => figures::face_point(figure),
            _ => Vec3::ZERO,
        };
        let looks = subject.transform.rotation() * own;
        let normal = Vec3::Y.cross(looks).try_normalize()?;
        Some(MirrorPlane { point: subject.transform.world_from_object().transform_point3(face), normal })
    }

    /// Returns the mirror image of a point.
    pub fn mirror_point(&self, point: Vec3) -> Vec3 {
        point - 2.0 * (point - self.point).dot(self.normal) * self.normal
    }

    /// Returns the mirror image of a direction.
    pub fn mirror_direction(&self, direction: Vec3) -> Vec3 {
        direction - 2.0 * direction.dot(self.normal) * self.normal
    }

    /// Returns the mirrored rotation of an object that is symmetric about its own X = 0 plane, as figures (but for
    /// their poses), panels and papers are.
    fn mirror_rotation(&self, rotation: Quat) -> Quat {
        // The reflection of the room times that of the object's own X is a rotation.
        let [x, y, z] = [-Vec3::X, Vec3::Y, Vec3::Z].map(|axis| self.mirror_direction(rotation * axis));
        Quat::from_mat3(&glam::Mat3::from_cols(x, y, z)).normalize()
    }
}

/// Mirrors items, or copies of them, about a plane: position, orientation and aim. Returns the mirrored items.
pub fn mirror(scene: &mut Scene, items: &[Item], plane: &MirrorPlane, copies: bool) -> Result<Vec<Item>, ActionError> {
    let items = if copies { copy(scene, items)? } else { items.to_vec() };
    let before = scene.clone();
    for &item in &items {
        if item.is_locked(scene) {
            return Err(ActionError::Locked(item.name(scene)));
        }
        match item {
            Item::Object(id) => {
                let object = scene.object_mut(id).ok_or(ActionError::Gone)?;
                let rotation = plane.mirror_rotation(object.transform.rotation());
                object.transform.set_rotation(rotation);
                object.transform.position = plane.mirror_point(object.transform.position);
            }
            Item::Light(id) => {
                let mirrored = mirrored_light(&before, before.light(id).ok_or(ActionError::Gone)?, &items, plane);
                *scene.light_mut(id).ok_or(ActionError::Gone)? = mirrored;
            }
            Item::Meter => {
                let meter = scene.meter.as_mut().ok_or(ActionError::Gone)?;
                let direction = plane.mirror_direction(meter.direction(&before));
                meter.position = plane.mirror_point(meter.position);
                if let (Facing::Angles { .. }, Aim::Angles { yaw_deg, pitch_deg }) =
                    (meter.facing, angles_towards(direction))
                {
                    meter.facing = Facing::Angles { yaw_deg, pitch_deg };
                }
            }
            Item::Camera => return Err(ActionError::Fixed("camera")),
            Item::Room => return Err(ActionError::Fixed("room")),
        }
    }
    Ok(items)
}

/// Returns the mirror image of a light. An aim at an object that is mirrored as well is kept; any other aim is
/// mirrored.
fn mirrored_light(scene: &Scene, light: &Light, together: &[Item], plane: &MirrorPlane) -> Light {
    let target = plane.mirror_point(scene.aim_point(&light.aim, light.position));
    let aim = match light.aim {
        Aim::Point(_) => Aim::Point(target),
        Aim::Angles { .. } => angles_towards(plane.mirror_direction(scene.aim_vector(&light.aim, light.position))),
        // In the space of a subject that is mirrored as well, the aim point only changes the sign of x.
        Aim::Object { object, offset } if together.contains(&Item::Object(object)) => {
            Aim::Object { object, offset: offset * Vec3::new(-1.0, 1.0, 1.0) }
        }
        Aim::Object { object, offset } => {
            let world_from_object = scene.object(object).map(|o| o.transform.world_from_object());
            let inverse = world_from_object.map(|m| m.inverse()).filter(|m| m.is_finite());
            Aim::Object { object, offset: inverse.map_or(offset, |m| m.transform_point3(target)) }
        }
    };
    let mut mirrored = Light {
        position: plane.mirror_point(light.position),
        aim,
        roll_deg: if light.roll_deg == 0.0 { 0.0 } else { -light.roll_deg },
        ..light.clone()
    };
    if let Some(doors) = &mut mirrored.modifier.doors {
        let BarnDoors { left_deg, right_deg, .. } = *doors;
        (doors.left_deg, doors.right_deg) = (right_deg, left_deg);
    }
    if mirrored.emitter == Emitter::Surround {
        return light.clone();
    }
    mirrored
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::editor::document::catalog;
    use crate::scene::LightId;

    /// A man turned 30 degrees to his left, with a strip light on his right.
    fn studio() -> (Scene, ObjectId, LightId) {
        let mut scene = Scene::default();
        let mut man = catalog::object_named("Man, 30, crop").unwrap();
        man.transform.position = Vec3::new(0.5, 0.0, -0.3);
        man.transform.rotation_deg.y = 30.0;
        let Item::Object(man) = add_object(&mut scene, man) else { unreachable!() };
        let mut strip = catalog::light_named("Strip 30 x 120").unwrap();
        strip.position = Vec3::new(-1.3, 1.9, 1.1);
        strip.aim = Aim::Object { object: man, offset: Vec3::new(0.04, 1.6, 0.1) };
        strip.roll_deg = 20.0;
        strip.modifier.doors = Some(BarnDoors { left_deg: 10.0, right_deg: 40.0, top_deg: 90.0, bottom_deg: 90.0 });
        let Item::Light(strip) = add_light(&mut scene, strip) else { unreachable!() };
        (scene, man, strip)
    }

    #[test]
    fn a_mirrored_light_is_symmetric_about_the_subjects_face() {
        let (mut scene, man, strip) = studio();
        let plane = MirrorPlane::of_subject(scene.object(man).unwrap()).unwrap();
        let face = |scene: &Scene| scene.object(man).unwrap().transform.world_from_object().inverse();
        let (before, seen_before) = (scene.clone(), face(&scene).transform_point3(scene.lights[0].position));
        mirror(&mut scene, &[Item::Light(strip)], &plane, false).unwrap();
        // In the man's own space only x changes its sign: of position, aim and the panel's axes.
        let flip = Vec3::new(-1.0, 1.0, 1.0);
        let seen = face(&scene).transform_point3(scene.lights[0].position);
        assert!((seen - seen_before * flip).length() < 1e-5, "{seen} of {seen_before}");
        let aim = |scene: &Scene| scene.aim_point(&scene.lights[0].aim, Vec3::ZERO);
        let aims = [&scene, &before].map(|s| face(s).transform_point3(aim(s)));
        assert!((aims[0] - aims[1] * flip).length() < 1e-5, "{aims:?}");
        let upright = [&scene, &before].map(|s| Vec3::from(s.light_frame(&s.lights[0]).matrix3.y_axis));
        assert!((upright[0] - plane.mirror_direction(upright[1])).length() < 1e-5, "the strip leans to the other side");
        let doors = scene.lights[0].modifier.doors.unwrap();
        assert_eq!((doors.left_deg, doors.right_deg), (40.0, 10.0));
        mirror(&mut scene, &[Item::Light(strip)], &plane, false).unwrap();
        assert!((scene.lights[0].position - before.lights[0].position).length() < 1e-5, "twice is back");
    }

    #[test]
    fn a_mirrored_copy_leaves_the_original() {
        let (mut scene, man, strip) = studio();
        let plane = MirrorPlane::of_subject(scene.object(man).unwrap()).unwrap();
        let original = scene.lights[0].clone();
        let made = mirror(&mut scene, &[Item::Light(strip)], &plane, true).unwrap();
        assert_eq!((scene.lights.len(), &scene.lights[0]), (2, &original));
        assert_eq!(made, [Item::Light(scene.lights[1].id)]);
        assert!((scene.lights[1].position - plane.mirror_point(original.position)).length() < 1e-6);
    }

    #[test]
    fn a_copied_light_aims_at_the_copy_of_its_subject() {
        let (mut scene, man, strip) = studio();
        let copies = duplicate(&mut scene, &[Item::Light(strip), Item::Object(man)]).unwrap();
        let [Item::Light(light), Item::Object(object)] = copies[..] else { panic!("{copies:?}") };
        assert!(matches!(scene.light(light).unwrap().aim, Aim::Object { object: at, .. } if at == object && at != man));
        let alone = duplicate(&mut scene, &[Item::Light(strip)]).unwrap();
        let [Item::Light(light)] = alone[..] else { panic!("{alone:?}") };
        assert!(matches!(scene.light(light).unwrap().aim, Aim::Object { object: at, .. } if at == man));
    }

    #[test]
    fn locked_items_are_neither_deleted_nor_mirrored() {
        let (mut scene, man, strip) = studio();
        scene.lights[0].locked = true;
        let plane = MirrorPlane::of_subject(scene.object(man).unwrap()).unwrap();
        let name = scene.lights[0].name.clone();
        assert_eq!(delete(&mut scene, &[Item::Light(strip)]), Err(ActionError::Locked(name.clone())));
        assert_eq!(mirror(&mut scene, &[Item::Light(strip)], &plane, false), Err(ActionError::Locked(name)));
        assert!(!scene.light(strip).unwrap().position.x.is_sign_positive());
    }
}
