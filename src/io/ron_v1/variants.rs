//! Converts the variants of a studio to and from format 1.

use super::convert::{aim_to, focus_to, light_from, light_to};
use super::defaults::is_studio_name;
use super::head::{head_change_from, head_change_to};
use super::names::{LightIds, ObjectIds, UnknownName};
use super::{CameraDifferenceV1, LightDifferenceV1, PhotometricFileChangeV1, VariantV1, VariantsV1};
use crate::scene::{
    CameraDifference, Gel, Light, LightDifference, LightId, ObjectId, Scene, SetupDifference, Variant, VariantId,
    Variants,
};
use glam::Vec3;
use std::collections::HashMap;

/// Converts the variants of a file; `studio` are the lights of the studio itself. Returns the shown one, too.
pub(super) fn variants_from(
    file: Option<VariantsV1>,
    objects: &ObjectIds,
    lights: &LightIds,
    studio_lights: &[Light],
) -> Result<(Variants, Option<VariantId>), UnknownName> {
    let Some(VariantsV1 { studio, shown, others }) = file else { return Ok((Variants::default(), None)) };
    let others = (1..).zip(others).map(|(id, variant)| variant_from(variant, id, objects, lights, studio_lights));
    let variants = Variants::new(studio, others.collect::<Result<_, _>>()?);
    let Some(name) = shown else { return Ok((variants, None)) };
    match variants.named(&name) {
        Some(id) => Ok((variants, Some(id))),
        None => {
            let known = variants.list().map(|(_, name)| name.to_owned()).collect();
            Err(UnknownName { kind: "variant", place: "variants.shown".to_owned(), name, known })
        }
    }
}

fn variant_from(
    file: VariantV1,
    id: u32,
    objects: &ObjectIds,
    lights: &LightIds,
    studio_lights: &[Light],
) -> Result<Variant, UnknownName> {
    let VariantV1 { name, camera, lights: changed, removed_lights, added_lights, hidden, visible } = file;
    let place = format!("variants.others[{}] {name:?} ", id - 1);
    let at = |list: &str, index: usize| format!("{place}{list}[{index}]");
    let object_ids = |list: &str, names: Vec<String>| {
        let ids = names.iter().enumerate().map(|(i, name)| objects.id(name, &at(list, i)));
        ids.collect::<Result<Vec<_>, _>>()
    };
    let changed = changed.into_iter().enumerate().map(|(i, light)| {
        let place = at("lights", i);
        let id = lights.id(&light.light, &format!("{place}.light"))?;
        let changed = studio_lights.iter().find(|light| light.id == id);
        Ok((id, light_difference_from(light, changed, &format!("{place}."), objects)?))
    });
    let removed = removed_lights.iter().enumerate().map(|(i, name)| lights.id(name, &at("removed_lights", i)));
    let added = added_lights.into_iter().enumerate().map(|(i, light)| {
        let place = format!("{}.", at("added_lights", i));
        let id = lights.added_id(&light.name, &place)?;
        light_from(light, id, &place, objects)
    });
    let difference = SetupDifference {
        camera: camera_difference_from(camera, &format!("{place}camera."), objects)?,
        lights: changed.collect::<Result<_, _>>()?,
        removed_lights: removed.collect::<Result<_, _>>()?,
        added_lights: added.collect::<Result<_, _>>()?,
        hidden: object_ids("hidden", hidden)?,
        visible: object_ids("visible", visible)?,
    };
    Ok(Variant { id: VariantId(id), name, difference })
}

fn camera_difference_from(
    file: CameraDifferenceV1,
    place: &str,
    objects: &ObjectIds,
) -> Result<CameraDifference, UnknownName> {
    Ok(CameraDifference {
        position: file.position.map(Vec3::from),
        aim: file.aim.map(|aim| objects.aim(aim, place)).transpose()?,
        roll_deg: file.roll_deg,
        sensor: file.sensor.map(Into::into),
        orientation: file.orientation.map(Into::into),
        focal_length_mm: file.focal_length_mm,
        f_number: file.f_number,
        shutter_s: file.shutter_s,
        iso: file.iso,
        white_balance_k: file.white_balance_k,
        nd_stops: file.nd_stops,
        focus: file.focus.map(|focus| objects.focus(focus, place)).transpose()?,
        depth_of_field: file.depth_of_field,
        focus_breathing: file.focus_breathing,
        meter_constant: file.meter_constant,
    })
}

/// Converts the difference from a light of the studio, if it is one.
fn light_difference_from(
    file: LightDifferenceV1,
    changed: Option<&Light>,
    place: &str,
    objects: &ObjectIds,
) -> Result<LightDifference, UnknownName> {
    let gel: Option<Gel> = file.gel.map(Into::into);
    // A gel without the field is older than it: the light makes up for its loss
    let older = gel.filter(|gel| *gel != Gel::None).map(|_| false);
    let counts = file.gel_loss_counts.or(older);
    Ok(LightDifference {
        role: file.role.map(Into::into),
        position: file.position.map(Vec3::from),
        aim: file.aim.map(|aim| objects.aim(aim, place)).transpose()?,
        roll_deg: file.roll_deg,
        emitter: file.emitter.map(Into::into),
        photometric_file: file.photometric_file.map(Into::into),
        environment_map: file.environment_map.map(Into::into),
        modifier: file.modifier.map(Into::into),
        head: file.head.map(head_change_from),
        output: file.output.map(Into::into),
        dial_stops: file.dial_stops,
        source: file.color.map(Into::into),
        gel,
        gel_loss_counts: counts.filter(|counts| changed.is_none_or(|light| light.color.gel_loss_counts != *counts)),
        on: file.on,
        visible_to_camera: file.visible_to_camera,
        body: file.body.map(Into::into),
        muted: file.muted,
    })
}

/// Converts the variants of a scene that shows the studio itself; none without any. `shown` is noted if it is another.
pub(super) fn variants_to(scene: &Scene, shown: VariantId) -> Option<VariantsV1> {
    let Variants { studio_id, studio_name, others, .. } = &scene.variants;
    let shown = scene.variants.name(shown).filter(|_| shown != *studio_id);
    let is_plain = others.is_empty() && is_studio_name(studio_name);
    (!is_plain).then(|| VariantsV1 {
        studio: studio_name.clone(),
        shown: shown.map(str::to_owned),
        others: {
            let names = Names::of(scene);
            others.iter().map(|variant| variant_to(scene, &names, variant)).collect()
        },
    })
}

/// Lights and names of objects by id: a linear search for each would be quadratic.
struct Names<'a> {
    lights: HashMap<LightId, &'a Light>,
    objects: HashMap<ObjectId, &'a str>,
}

impl<'a> Names<'a> {
    fn of(scene: &'a Scene) -> Self {
        Names {
            lights: scene.lights.iter().map(|light| (light.id, light)).collect(),
            objects: scene.objects.iter().map(|object| (object.id, object.name.as_str())).collect(),
        }
    }
}

fn variant_to(scene: &Scene, names: &Names<'_>, Variant { id: _, name, difference }: &Variant) -> VariantV1 {
    let SetupDifference { camera, lights, removed_lights, added_lights, hidden, visible } = difference;
    let light_name = |id: &LightId| Some(names.lights.get(id)?.name.clone());
    let object_names =
        |ids: &[ObjectId]| ids.iter().filter_map(|id| Some((*names.objects.get(id)?).to_owned())).collect();
    VariantV1 {
        name: name.clone(),
        camera: camera_difference_to(scene, camera),
        lights: lights
            .iter()
            .filter_map(|(id, light)| Some(light_difference_to(scene, names.lights.get(id)?, light)))
            .collect(),
        removed_lights: removed_lights.iter().filter_map(light_name).collect(),
        added_lights: added_lights.iter().map(|light| light_to(scene, light)).collect(),
        hidden: object_names(hidden),
        visible: object_names(visible),
    }
}

fn camera_difference_to(scene: &Scene, camera: &CameraDifference) -> CameraDifferenceV1 {
    let position = camera.position.unwrap_or(scene.camera.position);
    CameraDifferenceV1 {
        position: camera.position.map(|position| position.to_array()),
        aim: camera.aim.map(|aim| aim_to(scene, &aim, position)),
        roll_deg: camera.roll_deg,
        sensor: camera.sensor.map(Into::into),
        orientation: camera.orientation.map(Into::into),
        focal_length_mm: camera.focal_length_mm,
        f_number: camera.f_number,
        shutter_s: camera.shutter_s,
        iso: camera.iso,
        white_balance_k: camera.white_balance_k,
        nd_stops: camera.nd_stops,
        focus: camera.focus.map(|focus| focus_to(scene, focus)),
        depth_of_field: camera.depth_of_field,
        focus_breathing: camera.focus_breathing,
        meter_constant: camera.meter_constant,
    }
}

impl From<PhotometricFileChangeV1> for Option<String> {
    fn from(change: PhotometricFileChangeV1) -> Self {
        match change {
            PhotometricFileChangeV1::NoFile => None,
            PhotometricFileChangeV1::File(path) => Some(path),
        }
    }
}

impl From<Option<String>> for PhotometricFileChangeV1 {
    fn from(path: Option<String>) -> Self {
        path.map_or(PhotometricFileChangeV1::NoFile, PhotometricFileChangeV1::File)
    }
}

/// Converts the difference from a light of the studio.
fn light_difference_to(scene: &Scene, light: &Light, difference: &LightDifference) -> LightDifferenceV1 {
    let position = difference.position.unwrap_or(light.position);
    LightDifferenceV1 {
        light: light.name.clone(),
        role: difference.role.map(Into::into),
        position: difference.position.map(|position| position.to_array()),
        aim: difference.aim.map(|aim| aim_to(scene, &aim, position)),
        roll_deg: difference.roll_deg,
        emitter: difference.emitter.map(Into::into),
        photometric_file: difference.photometric_file.clone().map(Into::into),
        environment_map: difference.environment_map.clone().map(Into::into),
        modifier: difference.modifier.map(Into::into),
        head: difference.head.as_ref().map(|head| head_change_to(head.as_ref())),
        output: difference.output.map(Into::into),
        dial_stops: difference.dial_stops,
        color: difference.source.map(Into::into),
        gel: difference.gel.map(Into::into),
        // A gel is written with what its loss does
        gel_loss_counts: difference.gel_loss_counts.or(difference.gel.map(|_| light.color.gel_loss_counts)),
        on: difference.on,
        visible_to_camera: difference.visible_to_camera,
        body: difference.body.map(Into::into),
        muted: difference.muted,
    }
}
