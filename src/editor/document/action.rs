//! The actions: every change of the scene, from menus, shortcuts, panels, handles, undo and tests.

use crate::editor::document::action_error::ActionError;
use crate::editor::document::arrange::{self, MirrorPlane, add_light, add_object};
use crate::editor::document::item::{Item, name_of_all};
use crate::editor::document::switches;
use crate::scene::{Bodies, Camera, Light, LightId, Meter, NameOwner, Object, Room, Scene, VARIANT_LIMIT, VariantId};

/// A change of the scene. New objects and lights get their id and a unique name when the action is applied.
#[derive(Clone, Debug, PartialEq)]
pub enum Action {
    /// Adds a figure, prop or backdrop.
    AddObject(Box<Object>),
    /// Adds a light.
    AddLight(Box<Light>),
    /// Replaces the object of the same id.
    SetObject(Box<Object>),
    /// Replaces the light of the same id.
    SetLight(Box<Light>),
    /// Replaces the camera.
    SetCamera(Box<Camera>),
    /// Replaces the room; none removes it.
    SetRoom(Option<Box<Room>>),
    /// Sets what is there of the bodies of all lights.
    SetBodies(Bodies),
    /// Adds or replaces the light meter; none removes it.
    SetMeter(Option<Meter>),
    /// Sets title and description of the studio.
    SetNotes {
        /// Title.
        name: String,
        /// One line.
        description: String,
    },
    /// Renames an object or a light.
    Rename(Item, String),
    /// Deletes objects, lights or the meter. Aims at a deleted object become aims at the same point of the room.
    Delete(Vec<Item>),
    /// Adds copies of objects and lights beside the originals.
    Duplicate(Vec<Item>),
    /// Adds the lights and objects of another scene.
    Paste(Box<Scene>),
    /// Mirrors items, or copies of them, about a plane.
    Mirror {
        /// The items to mirror.
        items: Vec<Item>,
        /// The mirror plane.
        plane: MirrorPlane,
        /// True to mirror copies and keep the originals.
        copies: bool,
    },
    /// Mutes lights, or unmutes those that were muted.
    Mute(Vec<LightId>, bool),
    /// Solos lights; an empty list ends the solo.
    Solo(Vec<LightId>),
    /// Locks items against moves, or unlocks them.
    Lock(Vec<Item>, bool),
    /// Adds a variant, equal to the shown one, and shows it.
    AddVariant(String),
    /// Renames a variant.
    RenameVariant(VariantId, String),
    /// Deletes a variant.
    DeleteVariant(VariantId),
    /// Makes a variant the studio itself; what was the studio takes its place.
    MakeStudio(VariantId),
    /// Several changes as one undo step, all or none.
    Together {
        /// Label in the undo menu.
        label: String,
        /// The changes, in order.
        actions: Vec<Action>,
    },
}

impl Action {
    /// Returns the label in the undo menu.
    pub fn label(&self, scene: &Scene) -> String {
        match self {
            Action::AddObject(object) => format!("Add {}", object.name),
            Action::AddLight(light) => format!("Add {}", light.name),
            Action::SetObject(object) => format!("Change {}", object.name),
            Action::SetLight(light) => light_change_label(scene, light),
            Action::SetCamera(_) => "Change camera".to_owned(),
            Action::SetRoom(_) => "Change room".to_owned(),
            Action::SetBodies(bodies) => format!("Bodies of lights: {}", bodies.label().to_lowercase()),
            Action::SetMeter(None) => "Take the meter away".to_owned(),
            Action::SetMeter(Some(_)) if scene.meter.is_none() => "Put a meter up".to_owned(),
            Action::SetMeter(Some(_)) => "Change light meter".to_owned(),
            Action::SetNotes { .. } => "Change notes".to_owned(),
            Action::Rename(_, name) => format!("Rename to {name}"),
            Action::Delete(items) => format!("Delete {}", name_of_all(items, scene)),
            Action::Duplicate(items) => format!("Duplicate {}", name_of_all(items, scene)),
            Action::Paste(from) => match from.objects.len() + from.lights.len() {
                1 => "Paste".to_owned(),
                count => format!("Paste {count} things"),
            },
            Action::Mirror { items, copies: false, .. } => format!("Mirror {}", name_of_all(items, scene)),
            Action::Mirror { items, copies: true, .. } => format!("Mirrored copy of {}", name_of_all(items, scene)),
            Action::Mute(lights, true) => format!("Mute {}", name_of_all(&as_items(lights), scene)),
            Action::Mute(lights, false) => format!("Unmute {}", name_of_all(&as_items(lights), scene)),
            Action::Solo(lights) if lights.is_empty() => "End solo".to_owned(),
            Action::Solo(lights) => format!("Solo {}", name_of_all(&as_items(lights), scene)),
            Action::Lock(items, true) => format!("Lock {}", name_of_all(items, scene)),
            Action::Lock(items, false) => format!("Unlock {}", name_of_all(items, scene)),
            Action::AddVariant(name) => format!("Add variant {name}"),
            Action::RenameVariant(_, name) => format!("Rename variant to {name}"),
            Action::DeleteVariant(id) => format!("Delete variant {}", scene.variants.name(*id).unwrap_or_default()),
            Action::MakeStudio(id) => format!("Make {} the studio", scene.variants.name(*id).unwrap_or_default()),
            Action::Together { label, .. } => label.clone(),
        }
    }

    /// Returns the items that a drag of this action changes; the steps of one drag with equal targets are one undo
    /// step.
    pub fn targets(&self) -> Vec<Item> {
        match self {
            Action::SetObject(object) => vec![Item::Object(object.id)],
            Action::SetLight(light) => vec![Item::Light(light.id)],
            Action::SetCamera(_) => vec![Item::Camera],
            Action::SetRoom(_) | Action::SetBodies(_) => vec![Item::Room],
            Action::SetMeter(_) => vec![Item::Meter],
            Action::Together { actions, .. } => actions.iter().flat_map(Action::targets).collect(),
            _ => Vec::new(),
        }
    }

    /// Changes the scene. Returns the items to select; empty keeps the selection. On an error the scene may be half
    /// changed: the caller keeps a copy.
    pub fn apply(self, scene: &mut Scene) -> Result<Vec<Item>, ActionError> {
        match self {
            Action::AddObject(object) => return Ok(vec![add_object(scene, *object)]),
            Action::AddLight(light) => return Ok(vec![add_light(scene, *light)]),
            Action::SetObject(new) => set_object(scene, *new)?,
            Action::SetLight(new) => set_light(scene, *new)?,
            Action::SetCamera(camera) => scene.camera = *camera,
            Action::SetRoom(room) => scene.room = room.map(|room| *room),
            Action::SetBodies(bodies) => scene.bodies = bodies,
            Action::SetMeter(meter) => {
                let is_new = scene.meter.is_none() && meter.is_some();
                scene.meter = meter;
                return Ok(if is_new { vec![Item::Meter] } else { Vec::new() });
            }
            Action::SetNotes { name, description } => (scene.name, scene.description) = (name, description),
            Action::Rename(item, name) => rename(scene, item, &name)?,
            Action::Delete(items) => arrange::delete(scene, &items)?,
            Action::Duplicate(items) => return arrange::duplicate(scene, &items),
            Action::Paste(from) => return Ok(arrange::paste(scene, &from)),
            Action::Mirror { items, plane, copies } => return arrange::mirror(scene, &items, &plane, copies),
            Action::Mute(lights, mute) => switches::mute(scene, &lights, mute)?,
            Action::Solo(lights) => switches::solo(scene, lights)?,
            Action::Lock(items, locked) => switches::lock(scene, &items, locked)?,
            Action::AddVariant(name) => {
                check_variant_name(scene, None, &name)?;
                scene.add_variant(name.trim().to_owned()).ok_or(ActionError::TooManyVariants(VARIANT_LIMIT + 1))?;
            }
            Action::RenameVariant(id, name) => {
                check_variant_name(scene, Some(id), &name)?;
                scene.rename_variant(id, name.trim()).then_some(()).ok_or(ActionError::Gone)?;
            }
            Action::DeleteVariant(id) if id == scene.variants.studio_id => {
                return Err(ActionError::Fixed("studio itself"));
            }
            Action::DeleteVariant(id) => scene.remove_variant(id).then_some(()).ok_or(ActionError::Gone)?,
            Action::MakeStudio(id) => scene.make_studio(id).then_some(()).ok_or(ActionError::Gone)?,
            Action::Together { actions, .. } => {
                let mut selected = Vec::new();
                for action in actions {
                    selected.extend(action.apply(scene)?);
                }
                return Ok(selected);
            }
        }
        Ok(Vec::new())
    }
}

fn check_variant_name(scene: &Scene, id: Option<VariantId>, name: &str) -> Result<(), ActionError> {
    let name = name.trim();
    if name.is_empty() {
        return Err(ActionError::EmptyName);
    }
    match scene.variants.named(name) {
        Some(other) if Some(other) != id => Err(ActionError::VariantNameTaken(name.to_owned())),
        _ => Ok(()),
    }
}

fn as_items(lights: &[LightId]) -> Vec<Item> {
    lights.iter().copied().map(Item::Light).collect()
}

fn set_object(scene: &mut Scene, new: Object) -> Result<(), ActionError> {
    check_name(scene, Item::Object(new.id), &new.name)?;
    let old = scene.object_mut(new.id).ok_or(ActionError::Gone)?;
    if old.locked && old.transform != new.transform {
        return Err(ActionError::Locked(new.name));
    }
    *old = new;
    Ok(())
}

fn set_light(scene: &mut Scene, new: Light) -> Result<(), ActionError> {
    check_name(scene, Item::Light(new.id), &new.name)?;
    let (id, old) = (new.id, scene.light_mut(new.id).ok_or(ActionError::Gone)?);
    if old.locked && (old.position, old.aim, old.roll_deg) != (new.position, new.aim, new.roll_deg) {
        return Err(ActionError::Locked(new.name));
    }
    let switched = old.on != new.on;
    *old = new;
    if switched {
        switches::switched_by_hand(scene, id);
    }
    Ok(())
}

fn light_change_label(scene: &Scene, new: &Light) -> String {
    match scene.light(new.id) {
        Some(old) if old.on != new.on => format!("Switch {} {}", new.name, if new.on { "on" } else { "off" }),
        Some(old) if old.position != new.position => format!("Move {}", new.name),
        _ => format!("Change {}", new.name),
    }
}

fn check_name(scene: &Scene, item: Item, name: &str) -> Result<(), ActionError> {
    if name.trim().is_empty() {
        return Err(ActionError::EmptyName);
    }
    let owner = scene.name_owner(name).map(|owner| match owner {
        NameOwner::Object(id) => Item::Object(id),
        NameOwner::Light(id) => Item::Light(id),
    });
    if owner.is_some_and(|owner| owner != item) { Err(ActionError::NameTaken(name.to_owned())) } else { Ok(()) }
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::editor::document::catalog;
    use crate::scene::{Aim, Focus, ObjectId};
    use glam::Vec3;

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
    fn deleting_an_object_keeps_the_aim_point_of_its_lights() {
        let (mut scene, object, light) = studio();
        scene.object_mut(object).unwrap().transform.position = Vec3::new(1.0, 2.0, 3.0);
        scene.light_mut(light).unwrap().aim = Aim::Object { object, offset: Vec3::Y };
        scene.camera.focus = Focus::OnObject { object, offset: Vec3::ZERO };
        Action::Delete(vec![Item::Object(object)]).apply(&mut scene).unwrap();
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
        let copy = Action::Duplicate(vec![Item::Light(light)]).apply(&mut scene).unwrap()[0];
        assert_ne!(copy, Item::Light(light));
        assert_ne!(copy.name(&scene), Item::Light(light).name(&scene));
        Action::Rename(Item::Light(light), "Octa 120".to_owned()).apply(&mut scene).unwrap();
        let mut copied = |item: Item| Action::Duplicate(vec![item]).apply(&mut scene).unwrap()[0];
        let second = copied(Item::Light(light));
        let third = copied(second);
        let names = [second, third].map(|copy| copy.name(&scene));
        assert_eq!(names, ["Octa 120 2", "Octa 120 3"], "a size is no number of copies");
    }

    #[test]
    fn the_camera_cannot_be_deleted() {
        let (mut scene, ..) = studio();
        assert_eq!(Action::Delete(vec![Item::Camera]).apply(&mut scene), Err(ActionError::Fixed("camera")));
    }

    #[test]
    fn locked_items_cannot_move_but_can_be_dimmed() {
        let (mut scene, object, light) = studio();
        Action::Lock(vec![Item::Object(object), Item::Light(light)], true).apply(&mut scene).unwrap();
        let mut changed = scene.light(light).unwrap().clone();
        changed.power.dial_stops -= 1.0;
        Action::SetLight(Box::new(changed.clone())).apply(&mut scene).unwrap();
        changed.position.x += 1.0;
        let name = changed.name.clone();
        assert_eq!(Action::SetLight(Box::new(changed)).apply(&mut scene), Err(ActionError::Locked(name)));
        let mut changed = scene.object(object).unwrap().clone();
        changed.transform.rotation_deg.y += 1.0;
        let name = changed.name.clone();
        assert_eq!(Action::SetObject(Box::new(changed)).apply(&mut scene), Err(ActionError::Locked(name)));
    }
}
