//! Every change to the scene. Menus, shortcuts, panels, gizmos, undo and tests all go through [`Action`].

use crate::scene::{Aim, Camera, Focus, Light, LightId, Meter, Object, ObjectId, Room, Scene};
use glam::Vec3;

/// Something that can be selected.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Item {
    /// The camera.
    Camera,
    /// Floor, walls and ceiling.
    Room,
    /// A mannequin, prop or backdrop.
    Object(ObjectId),
    /// A light.
    Light(LightId),
    /// The light meter.
    Meter,
}

impl Item {
    /// Whether the scene has it. The room counts as there even when it is switched off, so that it can be switched on.
    pub fn exists_in(self, scene: &Scene) -> bool {
        match self {
            Item::Camera | Item::Room => true,
            Item::Object(id) => scene.object(id).is_some(),
            Item::Light(id) => scene.light(id).is_some(),
            Item::Meter => scene.meter.is_some(),
        }
    }

    /// Its name in lists and messages.
    pub fn name(self, scene: &Scene) -> String {
        match self {
            Item::Camera => "Camera".to_owned(),
            Item::Room => "Room".to_owned(),
            Item::Object(id) => scene.object(id).map(|o| o.name.clone()).unwrap_or_default(),
            Item::Light(id) => scene.light(id).map(|l| l.name.clone()).unwrap_or_default(),
            Item::Meter => "Light meter".to_owned(),
        }
    }
}

/// A change to the scene. New objects and lights get their id and a unique name when the action is applied.
#[derive(Clone, Debug, PartialEq)]
pub enum Action {
    /// Puts a mannequin, prop or backdrop into the studio.
    AddObject(Box<Object>),
    /// Puts a light into the studio.
    AddLight(Box<Light>),
    /// Replaces the object of the same id.
    SetObject(Box<Object>),
    /// Replaces the light of the same id.
    SetLight(Box<Light>),
    /// Replaces the camera.
    SetCamera(Box<Camera>),
    /// Replaces the room; none takes it away.
    SetRoom(Option<Box<Room>>),
    /// Puts the light meter up or elsewhere; none takes it away.
    SetMeter(Option<Meter>),
    /// Title and description of the studio.
    SetNotes {
        /// Title.
        name: String,
        /// One line.
        description: String,
    },
    /// Gives an object or a light another name.
    Rename(Item, String),
    /// Takes an object or a light away. What aimed at the object keeps aiming at where it was.
    Delete(Item),
    /// Puts a copy of an object or a light beside it.
    Duplicate(Item),
}

/// Why an action cannot be done, in words for the user.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ActionError {
    /// A name that is empty.
    #[error("A name cannot be empty.")]
    EmptyName,
    /// A name that something else bears.
    #[error("\"{0}\" is taken. Names are unique, so that aims and the file can use them.")]
    NameTaken(String),
    /// The camera and the room are always there, once.
    #[error("The {0} cannot be deleted, duplicated or renamed.")]
    Fixed(&'static str),
    /// There is one meter, and it has no name.
    #[error("There is one light meter in a studio: move it to where you want to read.")]
    Single,
    /// What the action is about has gone.
    #[error("That is no longer in the studio.")]
    Gone,
    /// The result would be a scene that no renderer can take.
    #[error("{0}")]
    Invalid(String),
}

/// How far a copy stands from its original, metres.
const COPY_OFFSET: Vec3 = Vec3::new(0.4, 0.0, 0.0);

impl Action {
    /// What the undo menu calls it.
    pub fn label(&self, scene: &Scene) -> String {
        match self {
            Action::AddObject(object) => format!("Add {}", object.name),
            Action::AddLight(light) => format!("Add {}", light.name),
            Action::SetObject(object) => format!("Change {}", object.name),
            Action::SetLight(light) => light_change_label(scene, light),
            Action::SetCamera(_) => "Change camera".to_owned(),
            Action::SetRoom(_) => "Change room".to_owned(),
            Action::SetMeter(None) => "Take the meter away".to_owned(),
            Action::SetMeter(Some(_)) if scene.meter.is_none() => "Put a meter up".to_owned(),
            Action::SetMeter(Some(_)) => "Change light meter".to_owned(),
            Action::SetNotes { .. } => "Change notes".to_owned(),
            Action::Rename(_, name) => format!("Rename to {name}"),
            Action::Delete(item) => format!("Delete {}", item.name(scene)),
            Action::Duplicate(item) => format!("Duplicate {}", item.name(scene)),
        }
    }

    /// What a drag of this action keeps changing; steps of one drag on the same item are one undo step.
    pub fn target(&self) -> Option<Item> {
        match self {
            Action::SetObject(object) => Some(Item::Object(object.id)),
            Action::SetLight(light) => Some(Item::Light(light.id)),
            Action::SetCamera(_) => Some(Item::Camera),
            Action::SetRoom(_) => Some(Item::Room),
            Action::SetMeter(_) => Some(Item::Meter),
            _ => None,
        }
    }

    /// Changes the scene. Returns what should be selected afterwards, where that is for the action to say. On an error
    /// the scene may be half changed: the caller keeps a copy.
    pub fn apply(self, scene: &mut Scene) -> Result<Option<Item>, ActionError> {
        match self {
            Action::AddObject(object) => Ok(Some(add_object(scene, *object))),
            Action::AddLight(light) => Ok(Some(add_light(scene, *light))),
            Action::SetObject(new) => {
                check_name(scene, Item::Object(new.id), &new.name)?;
                let id = new.id;
                *scene.object_mut(id).ok_or(ActionError::Gone)? = *new;
                Ok(None)
            }
            Action::SetLight(new) => {
                check_name(scene, Item::Light(new.id), &new.name)?;
                let id = new.id;
                *scene.light_mut(id).ok_or(ActionError::Gone)? = *new;
                Ok(None)
            }
            Action::SetCamera(camera) => {
                scene.camera = *camera;
                Ok(None)
            }
            Action::SetRoom(room) => {
                scene.room = room.map(|room| *room);
                Ok(None)
            }
            Action::SetMeter(meter) => {
                let is_new = scene.meter.is_none() && meter.is_some();
                scene.meter = meter;
                Ok(is_new.then_some(Item::Meter))
            }
            Action::SetNotes { name, description } => {
                (scene.name, scene.description) = (name, description);
                Ok(None)
            }
            Action::Rename(item, name) => rename(scene, item, &name).map(|()| None),
            Action::Delete(item) => delete(scene, item).map(|()| None),
            Action::Duplicate(item) => duplicate(scene, item).map(Some),
        }
    }
}

fn light_change_label(scene: &Scene, new: &Light) -> String {
    match scene.light(new.id) {
        Some(old) if old.on != new.on => format!("Switch {} {}", new.name, if new.on { "on" } else { "off" }),
        Some(old) if old.position != new.position => format!("Move {}", new.name),
        _ => format!("Change {}", new.name),
    }
}

fn add_object(scene: &mut Scene, mut object: Object) -> Item {
    object.id = scene.fresh_object_id();
    object.name = scene.unique_name(&object.name);
    let item = Item::Object(object.id);
    scene.objects.push(object);
    item
}

fn add_light(scene: &mut Scene, mut light: Light) -> Item {
    light.id = scene.fresh_light_id();
    light.name = scene.unique_name(&light.name);
    let item = Item::Light(light.id);
    scene.lights.push(light);
    item
}

fn check_name(scene: &Scene, item: Item, name: &str) -> Result<(), ActionError> {
    if name.trim().is_empty() {
        return Err(ActionError::EmptyName);
    }
    let object_has_it = scene.objects.iter().any(|o| o.name == name && item != Item::Object(o.id));
    let light_has_it = scene.lights.iter().any(|l| l.name == name && item != Item::Light(l.id));
    if object_has_it || light_has_it { Err(ActionError::NameTaken(name.to_owned())) } else { Ok(()) }
}

fn rename(scene: &mut Scene, item: Item, name: &str) -> Result<(), ActionError> {
    let name = name.trim();
    check_name(scene, item, name)?;
    match item {
        Item::Object(id) => scene.object_mut(id).ok_or(ActionError::Gone)?.name = name.to_owned(),
        Item::Light(id) => scene.light_mut(id).ok_or(ActionError::Gone)?.name = name.to_owned(),
        Item::Camera => return Err(ActionError::Fixed("camera")),
        Item::Room => return Err(ActionError::Fixed("room")),
        Item::Meter => return Err(ActionError::Single),
    }
    Ok(())
}

fn delete(scene: &mut Scene, item: Item) -> Result<(), ActionError> {
    match item {
        Item::Object(id) => {
            scene.object(id).ok_or(ActionError::Gone)?;
            release_aims(scene, id);
            scene.objects.retain(|o| o.id != id);
        }
        Item::Light(id) => {
            scene.light(id).ok_or(ActionError::Gone)?;
            scene.lights.retain(|l| l.id != id);
        }
        Item::Meter => scene.meter = None,
        Item::Camera => return Err(ActionError::Fixed("camera")),
        Item::Room => return Err(ActionError::Fixed("room")),
    }
    Ok(())
}

/// Turns every aim and focus on an object into one at the same point of the studio.
fn release_aims(scene: &mut Scene, id: ObjectId) {
    let fixed = |scene: &Scene, aim: Aim| match aim {
        Aim::Object { object, .. } if object == id => Aim::Point(scene.aim_point(&aim, Vec3::ZERO)),
        other => other,
    };
    scene.camera.aim = fixed(scene, scene.camera.aim);
    for i in 0..scene.lights.len() {
        scene.lights[i].aim = fixed(scene, scene.lights[i].aim);
    }
    if matches!(scene.camera.focus, Focus::OnObject { object, .. } if object == id) {
        scene.camera.focus = Focus::OnAim;
    }
}

fn duplicate(scene: &mut Scene, item: Item) -> Result<Item, ActionError> {
    match item {
        Item::Object(id) => {
            let mut copy = scene.object(id).ok_or(ActionError::Gone)?.clone();
            copy.transform.position += COPY_OFFSET;
            Ok(add_object(scene, copy))
        }
        Item::Light(id) => {
            let mut copy = scene.light(id).ok_or(ActionError::Gone)?.clone();
            copy.position += COPY_OFFSET;
            Ok(add_light(scene, copy))
        }
        Item::Camera => Err(ActionError::Fixed("camera")),
        Item::Room => Err(ActionError::Fixed("room")),
        Item::Meter => Err(ActionError::Single),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::editor::catalog;

    fn studio() -> (Scene, ObjectId, LightId) {
        let mut scene = Scene::default();
        let object = add_object(&mut scene, catalog::object_named("Box").unwrap());
        let light = add_light(&mut scene, catalog::light_named("Softbox 60 x 90").unwrap());
        match (object, light) {
            (Item::Object(object), Item::Light(light)) => (scene, object, light),
            _ => unreachable!(),
        }
    }

    #[test]
    fn deleting_an_object_leaves_its_lights_aimed_where_it_was() {
        let (mut scene, object, light) = studio();
        scene.object_mut(object).unwrap().transform.position = Vec3::new(1.0, 2.0, 3.0);
        scene.light_mut(light).unwrap().aim = Aim::Object { object, offset: Vec3::Y };
        scene.camera.focus = Focus::OnObject { object, offset: Vec3::ZERO };
        Action::Delete(Item::Object(object)).apply(&mut scene).unwrap();
        assert_eq!(scene.light(light).unwrap().aim, Aim::Point(Vec3::new(1.0, 3.0, 3.0)));
        assert_eq!(scene.camera.focus, Focus::OnAim);
        assert!(scene.objects.is_empty());
    }

    #[test]
    fn names_stay_unique() {
        let (mut scene, object, light) = studio();
        let light_name = scene.light(light).unwrap().name.clone();
        let error = Action::Rename(Item::Object(object), light_name.clone()).apply(&mut scene).unwrap_err();
        assert_eq!(error, ActionError::NameTaken(light_name));
        assert_eq!(Action::Rename(Item::Object(object), "  ".into()).apply(&mut scene), Err(ActionError::EmptyName));
        let copy = Action::Duplicate(Item::Light(light)).apply(&mut scene).unwrap().unwrap();
        assert_ne!(copy, Item::Light(light));
        assert_ne!(copy.name(&scene), Item::Light(light).name(&scene));
    }

    #[test]
    fn the_camera_cannot_be_deleted() {
        let (mut scene, ..) = studio();
        assert_eq!(Action::Delete(Item::Camera).apply(&mut scene), Err(ActionError::Fixed("camera")));
    }
}
