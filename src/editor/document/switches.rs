//! Mute, solo and lock. They leave power, colour and position unchanged, so that they can be reverted.

use crate::editor::document::action_error::ActionError;
use crate::editor::document::item::Item;
use crate::scene::{LightId, Scene, Solo};

/// Updates mute and solo after a light was switched directly: it is unmuted, and the end of a solo keeps the switch.
pub fn switched_by_hand(scene: &mut Scene, id: LightId) {
    let Some(light) = scene.light_mut(id) else { return };
    light.muted = false;
    let on = light.on;
    if let Some(solo) = &mut scene.solo {
        solo.restores.retain(|other| *other != id);
        solo.restores.extend(on.then_some(id));
    }
}

/// Mutes the lights that are on, or unmutes the muted ones. Lights that are off stay off.
pub fn mute(scene: &mut Scene, lights: &[LightId], mute: bool) -> Result<(), ActionError> {
    for &id in lights {
        let shines_alone = scene.solo.as_ref().is_none_or(|solo| solo.lights.contains(&id));
        let held_back = scene.solo.as_ref().is_some_and(|solo| solo.restores.contains(&id));
        let light = scene.light_mut(id).ok_or(ActionError::Gone)?;
        if mute && (light.on || held_back) {
            (light.on, light.muted) = (false, true);
        } else if !mute && light.muted && !light.on {
            (light.on, light.muted) = (shines_alone, false);
        } else {
            continue;
        }
        if let Some(solo) = &mut scene.solo {
            solo.restores.retain(|other| *other != id);
            solo.restores.extend((!mute).then_some(id));
        }
    }
    Ok(())
}

/// Solos these lights; an empty list ends the solo and restores the switches.
pub fn solo(scene: &mut Scene, lights: Vec<LightId>) -> Result<(), ActionError> {
    scene.end_solo();
    if lights.is_empty() {
        return Ok(());
    }
    if lights.iter().any(|id| scene.light(*id).is_none()) {
        return Err(ActionError::Gone);
    }
    let restores = scene.lights.iter().filter(|light| light.on).map(|light| light.id).collect();
    for light in &mut scene.lights {
        light.on = lights.contains(&light.id);
    }
    scene.solo = Some(Solo { lights, restores });
    Ok(())
}

/// Removes deleted lights from the solo and ends it with its last light.
pub fn remove_deleted_lights(scene: &mut Scene) {
    let known: Vec<LightId> = scene.lights.iter().map(|light| light.id).collect();
    let Some(solo) = &mut scene.solo else { return };
    solo.lights.retain(|id| known.contains(id));
    solo.restores.retain(|id| known.contains(id));
    if solo.lights.is_empty() {
        scene.end_solo();
    }
}

/// Locks items against moves, or unlocks them.
pub fn lock(scene: &mut Scene, items: &[Item], locked: bool) -> Result<(), ActionError> {
    for item in items {
        match *item {
            Item::Object(id) => scene.object_mut(id).ok_or(ActionError::Gone)?.locked = locked,
            Item::Light(id) => scene.light_mut(id).ok_or(ActionError::Gone)?.locked = locked,
            Item::Camera => return Err(ActionError::Fixed("camera")),
            Item::Room => return Err(ActionError::Fixed("room")),
            Item::Meter => return Err(ActionError::Single),
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Emitter, Light, Output};

    /// Four lights of which the first two are on.
    fn four_lights() -> (Scene, [LightId; 4]) {
        let ids = [0, 1, 2, 3].map(LightId);
        let light = |id| Light { id, on: id.0 < 2, ..Light::new(Emitter::Point, Output::Lumens(1000.0)) };
        (Scene { lights: ids.map(light).to_vec(), ..Scene::default() }, ids)
    }

    fn on(scene: &Scene) -> Vec<u32> {
        scene.lights.iter().filter(|l| l.on).map(|l| l.id.0).collect()
    }

    #[test]
    fn ending_a_solo_restores_the_switches() {
        let (mut scene, ids) = four_lights();
        let before = scene.clone();
        solo(&mut scene, vec![ids[2]]).unwrap();
        assert_eq!(on(&scene), [2]);
        solo(&mut scene, vec![ids[0]]).unwrap();
        assert_eq!(on(&scene), [0], "another solo replaces the first");
        solo(&mut scene, Vec::new()).unwrap();
        assert_eq!(scene, before);
    }

    #[test]
    fn a_switch_during_a_solo_outlasts_it() {
        let (mut scene, ids) = four_lights();
        solo(&mut scene, vec![ids[0]]).unwrap();
        scene.lights[3].on = true;
        switched_by_hand(&mut scene, ids[3]);
        scene.lights[0].on = false;
        switched_by_hand(&mut scene, ids[0]);
        solo(&mut scene, Vec::new()).unwrap();
        assert_eq!(on(&scene), [1, 3]);
    }

    #[test]
    fn muting_all_and_unmuting_all_leaves_off_what_was_off() {
        let (mut scene, ids) = four_lights();
        let before = scene.clone();
        mute(&mut scene, &ids, true).unwrap();
        assert_eq!((on(&scene), scene.lights.iter().filter(|l| l.muted).count()), (vec![], 2));
        mute(&mut scene, &ids, false).unwrap();
        assert_eq!(scene, before);
    }

    #[test]
    fn a_light_muted_before_or_during_a_solo_is_muted_after_it() {
        let (mut scene, ids) = four_lights();
        mute(&mut scene, &[ids[0]], true).unwrap();
        solo(&mut scene, vec![ids[0]]).unwrap();
        assert_eq!(on(&scene), [0], "a solo is heard over a mute");
        mute(&mut scene, &[ids[1]], true).unwrap();
        solo(&mut scene, Vec::new()).unwrap();
        assert_eq!(on(&scene), Vec::<u32>::new());
        assert!(scene.lights[0].muted && scene.lights[1].muted);
        mute(&mut scene, &ids, false).unwrap();
        assert_eq!(on(&scene), [0, 1]);
    }

    #[test]
    fn a_solo_ends_with_its_last_light() {
        let (mut scene, ids) = four_lights();
        solo(&mut scene, vec![ids[1]]).unwrap();
        scene.lights.remove(1);
        remove_deleted_lights(&mut scene);
        assert_eq!((on(&scene), &scene.solo), (vec![0], &None));
    }
}
