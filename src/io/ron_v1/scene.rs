//! Converts whole scenes to and from format 1. Ids follow the order of the file.

use super::convert::{camera_from, camera_to, light_from, light_to, object_from, object_to};
use super::names::{LightIds, ObjectIds, UnknownName};
use super::variants::{variants_from, variants_to};
use super::{MeterV1, RoomV1, SceneV1, SoloV1};
use crate::scene::{Light, LightId, Meter, Room, Scene, Solo, VariantId};

/// Converts a file to a scene that shows the studio itself, and returns the variant that is to be shown, if any. The
/// scene may have equal names and other errors, which `scene::validate` finds.
pub(in crate::io) fn scene_from_v1(file: SceneV1) -> Result<(Scene, Option<VariantId>), UnknownName> {
    let ids = ObjectIds::of(&file.objects);
    let added = file.variants.as_ref().map_or(&[][..], |variants| &variants.others);
    let light_ids = LightIds::of(&file.lights, added);
    let solo = file.solo.map(|solo| solo_from(solo, &light_ids)).transpose()?;
    let lights: Vec<Light> = (0..)
        .zip(file.lights)
        .map(|(index, light)| {
            let place = format!("lights[{index}] {:?} ", light.name);
            light_from(light, LightId(index), &place, &ids)
        })
        .collect::<Result<_, _>>()?;
    let (variants, shown) = variants_from(file.variants, &ids, &light_ids, &lights)?;
    let scene = Scene {
        name: file.name,
        description: file.description,
        camera: camera_from(file.camera, &ids)?,
        room: file.room.map(Room::from),
        objects: (0..)
            .zip(file.objects)
            .map(|(index, object)| object_from(object, index, &light_ids))
            .collect::<Result<_, _>>()?,
        lights,
        bodies: file.bodies.into(),
        meter: file.meter.map(Meter::from),
        solo,
        variants,
    };
    Ok((scene, shown))
}

/// Resolves the names of soloed lights to ids.
fn solo_from(file: SoloV1, lights: &LightIds) -> Result<Solo, UnknownName> {
    let ids = |names: Vec<String>, place: &str| {
        names.iter().map(|name| lights.id(name, place)).collect::<Result<Vec<_>, _>>()
    };
    Ok(Solo { lights: ids(file.lights, "solo.lights")?, restores: ids(file.restores, "solo.restores")? })
}

fn solo_to(scene: &Scene, solo: &Solo) -> SoloV1 {
    let names = |ids: &[LightId]| ids.iter().filter_map(|id| Some(scene.light(*id)?.name.clone())).collect();
    SoloV1 { lights: names(&solo.lights), restores: names(&solo.restores) }
}

/// Converts a scene with unique names, which shows the studio itself, to a file in which variant `shown` is to be shown.
/// An aim at a deleted object becomes a point.
pub(in crate::io) fn v1_from_scene(scene: &Scene, shown: VariantId) -> SceneV1 {
    SceneV1 {
        format: 1,
        name: scene.name.clone(),
        description: scene.description.clone(),
        camera: camera_to(scene),
        room: scene.room.as_ref().map(RoomV1::from),
        objects: scene.objects.iter().map(|object| object_to(scene, object)).collect(),
        lights: scene.lights.iter().map(|light| light_to(scene, light)).collect(),
        bodies: scene.bodies.into(),
        meter: scene.meter.map(MeterV1::from),
        solo: scene.solo.as_ref().map(|solo| solo_to(scene, solo)),
        variants: variants_to(scene, shown),
    }
}
