//! The items of a studio that can be selected: camera, room, objects, lights, meter.

use crate::scene::{Emitter, LightId, ObjectId, Scene};
use glam::Vec3;

/// A selectable item of the studio.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Item {
    /// The camera.
    Camera,
    /// Floor, walls and ceiling.
    Room,
    /// A figure, prop or backdrop.
    Object(ObjectId),
    /// A light.
    Light(LightId),
    /// The light meter.
    Meter,
}

impl Item {
    /// Returns true if the scene has the item. The room always exists, so that it can be switched on.
    pub fn exists_in(self, scene: &Scene) -> bool {
        match self {
            Item::Camera | Item::Room => true,
            Item::Object(id) => scene.object(id).is_some(),
            Item::Light(id) => scene.light(id).is_some(),
            Item::Meter => scene.meter.is_some(),
        }
    }

    /// Returns the name in lists and messages.
    pub fn name(self, scene: &Scene) -> String {
        match self {
            Item::Camera => "Camera".to_owned(),
            Item::Room => "Room".to_owned(),
            Item::Object(id) => scene.object(id).map(|o| o.name.clone()).unwrap_or_default(),
            Item::Light(id) => scene.light(id).map(|l| l.name.clone()).unwrap_or_default(),
            Item::Meter => "Light meter".to_owned(),
        }
    }

    /// Returns the position, metres; none for the room, surround light and missing items.
    pub fn position(self, scene: &Scene) -> Option<Vec3> {
        match self {
            Item::Camera => Some(scene.camera.position),
            Item::Room => None,
            Item::Object(id) => scene.object(id).map(|o| o.transform.position),
            Item::Light(id) => scene.light(id).filter(|l| l.emitter != Emitter::Surround).map(|l| l.position),
            Item::Meter => scene.meter.map(|meter| meter.position),
        }
    }

    /// Returns true if the item is locked against moves.
    pub fn is_locked(self, scene: &Scene) -> bool {
        match self {
            Item::Object(id) => scene.object(id).is_some_and(|o| o.locked),
            Item::Light(id) => scene.light(id).is_some_and(|l| l.locked),
            Item::Camera | Item::Room | Item::Meter => false,
        }
    }

    /// Returns true for objects and lights, which can be copied.
    pub fn can_be_copied(self) -> bool {
        matches!(self, Item::Object(_) | Item::Light(_))
    }
}

/// Returns `Key`, or `3 things` for several items.
pub fn name_of_all(items: &[Item], scene: &Scene) -> String {
    match items {
        [one] => one.name(scene),
        several if several.iter().all(|item| matches!(item, Item::Light(_))) => format!("{} lights", several.len()),
        several => format!("{} things", several.len()),
    }
}
