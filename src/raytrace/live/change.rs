//! What an edit costs a live picture: nothing, some lights' layers, or everything.

use crate::raytrace::film::{Layer, MAX_LIGHT_LAYERS};
use crate::scene::{Assets, Light, LightId, Scene};
use std::collections::HashMap;
use std::hash::Hash;
use std::sync::Arc;

/// What must be traced anew.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Change {
    /// What developing the film can follow: power, colour and switch of lights that have a layer, exposure, names.
    Nothing,
    /// These lights shine differently, or are new; or others are gone. All else is as it was.
    Lights(Vec<LightId>),
    /// Things, surfaces, the room.
    Everything,
}

/// The scene to trace so that a film of `layers`, traced from `traced`, shows `now`; and what of it is new. Where a light
/// has a layer, its power, colour and switch are those that were traced: developing makes them what they are.
pub fn between(traced: &Scene, layers: &[Layer], now: &Scene) -> (Scene, Change) {
    let everything = || (now.clone(), Change::Everything);
    let on = |scene: &Scene| scene.lights.iter().filter(|light| light.on).count();
    if on(now).max(on(traced)) > MAX_LIGHT_LAYERS && !is_same_picture(traced, now) {
        return everything();
    }
    let mut wanted = without_words(now, traced);
    wanted.camera = traced.camera.clone();
    let glows = traced.has_emissive_material();
    if wanted.room != traced.room
        || wanted.objects != traced.objects
        || (glows && now.camera.shutter_s != traced.camera.shutter_s)
    {
        return everything();
    }
    let has_layer = |id: LightId| layers.iter().any(|layer| layer.light == Some(id));
    let mut changed = Vec::new();
    for light in &mut wanted.lights {
        let Some(old) = traced.light(light.id) else {
            if light.on && light.visible_to_camera {
                return everything();
            }
            changed.extend(light.on.then_some(light.id));
            continue;
        };
        if !light.on && !old.on {
            *light = old.clone();
            continue;
        }
        // The camera sees the emitter itself, and what it hides.
        if (light.visible_to_camera || old.visible_to_camera) && (light.on != old.on || !shines_alike(light, old)) {
            return everything();
        }
        if has_layer(light.id) && (!light.on || shines_alike(light, old)) {
            *light = old.clone();
        } else if light != old {
            changed.push(light.id);
        }
    }
    let gone = traced.lights.iter().filter(|old| now.light(old.id).is_none());
    if gone.clone().any(|old| old.on && old.visible_to_camera) {
        return everything();
    }
    let nothing = changed.is_empty() && gone.count() == 0;
    (wanted, if nothing { Change::Nothing } else { Change::Lights(changed) })
}

/// Whether two lights differ only in what developing a film can change.
fn shines_alike(light: &Light, old: &Light) -> bool {
    let mut light = light.clone();
    (light.power, light.color, light.on) = (old.power, old.color, old.on);
    (light.modifier.loss_stops, light.modifier.scrim_stops) = (old.modifier.loss_stops, old.modifier.scrim_stops);
    light == *old
}

/// A scene with the names, words, meter, locks and solo of another, which no picture shows: only what is on counts.
fn without_words(now: &Scene, other: &Scene) -> Scene {
    let mut scene = now.clone();
    (scene.name, scene.description, scene.meter) = (other.name.clone(), other.description.clone(), other.meter);
    scene.solo = other.solo.clone();
    for light in &mut scene.lights {
        if let Some(old) = other.light(light.id) {
            (light.name, light.role) = (old.name.clone(), old.role);
            (light.muted, light.locked) = (old.muted, old.locked);
        }
    }
    for object in &mut scene.objects {
        if let Some(old) = other.object(object.id) {
            (object.name, object.locked) = (old.name.clone(), old.locked);
        }
    }
    scene
}

/// Whether two scenes show the same but for the camera's place and exposure, all lights as they are.
fn is_same_picture(traced: &Scene, now: &Scene) -> bool {
    let mut scene = without_words(now, traced);
    let held = (now.camera.shutter_s, now.camera.white_balance_k);
    scene.camera = traced.camera.clone();
    // Roles choose the layers that many lights share.
    let roles = now.lights.iter().map(|l| l.role).eq(traced.lights.iter().map(|l| l.role));
    roles && scene == *traced && held == (traced.camera.shutter_s, traced.camera.white_balance_k)
}

/// Whether two collections hold the very same meshes and textures.
pub fn same_assets(a: &Assets, b: &Assets) -> bool {
    fn same<K: Eq + Hash, V>(a: &HashMap<K, Arc<V>>, b: &HashMap<K, Arc<V>>) -> bool {
        a.len() == b.len() && a.iter().all(|(key, value)| b.get(key).is_some_and(|other| Arc::ptr_eq(value, other)))
    }
    same(&a.meshes, &b.meshes) && same(&a.mannequins, &b.mannequins) && same(&a.textures, &b.textures)
}
