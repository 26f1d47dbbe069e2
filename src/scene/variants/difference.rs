//! The difference of one set-up from another, field by field.

use super::setup::StudioSetup;
use crate::scene::{
    Aim, BodyChoice, Camera, ColorSource, Emitter, Focus, Gel, Head, Light, LightId, Modifier, ObjectId, Orientation,
    Output, Role, Sensor,
};
use glam::Vec3;
use std::collections::{BTreeSet, HashMap, HashSet};

/// Declares the difference of one struct from another: each field is `Some` new value where they differ.
macro_rules! difference {
    ($(#[$doc:meta])* $name:ident of $whole:ident { $($field:ident: $type:ty = $($path:ident).+),+ $(,)? }) => {
        $(#[$doc])*
        #[derive(Clone, Debug, Default, PartialEq)]
        pub struct $name {
            $(
                #[doc = concat!("The other `", stringify!($($path).+), "`, if it differs.")]
                pub $field: Option<$type>,
            )+
        }

        impl $name {
            /// Returns the fields of `to` that differ from those of `from`.
            pub fn between(from: &$whole, to: &$whole) -> Self {
                $name { $($field: (from.$($path).+ != to.$($path).+).then(|| to.$($path).+.clone()),)+ }
            }

            /// Changes the fields that differ.
            pub fn apply(&self, to: &mut $whole) {
                $(if let Some(value) = &self.$field {
                    to.$($path).+ = value.clone();
                })+
            }

            /// Returns true if nothing differs.
            pub fn is_empty(&self) -> bool {
                *self == Self::default()
            }
        }
    };
}

difference! {
    /// The difference of one light from another. Id, name and lock are common to all variants.
    LightDifference of Light {
        role: Role = role,
        position: Vec3 = position,
        aim: Aim = aim,
        roll_deg: f32 = roll_deg,
        emitter: Emitter = emitter,
        photometric_file: Option<String> = photometric_file,
        environment_map: Option<String> = environment_map,
        modifier: Modifier = modifier,
        head: Option<Head> = head,
        output: Output = power.output,
        dial_stops: f32 = power.dial_stops,
        source: ColorSource = color.source,
        gel: Gel = color.gel,
        gel_loss_counts: bool = color.gel_loss_counts,
        on: bool = on,
        visible_to_camera: bool = visible_to_camera,
        body: BodyChoice = body,
        muted: bool = muted,
    }
}

difference! {
    /// The difference of one camera from another.
    CameraDifference of Camera {
        position: Vec3 = position,
        aim: Aim = aim,
        roll_deg: f32 = roll_deg,
        sensor: Sensor = sensor,
        orientation: Orientation = orientation,
        focal_length_mm: f32 = focal_length_mm,
        f_number: f32 = f_number,
        shutter_s: f32 = shutter_s,
        iso: f32 = iso,
        white_balance_k: f32 = white_balance_k,
        nd_stops: f32 = nd_stops,
        focus: Focus = focus,
        depth_of_field: bool = depth_of_field,
        focus_breathing: bool = focus_breathing,
        meter_constant: f32 = meter_constant,
    }
}

/// The difference of a variant from the studio. References to lights and objects that are gone have no effect.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SetupDifference {
    /// What differs in the camera.
    pub camera: CameraDifference,
    /// The lights of the studio that differ.
    pub lights: Vec<(LightId, LightDifference)>,
    /// The lights of the studio that the variant does not have.
    pub removed_lights: Vec<LightId>,
    /// The lights that only the variant has.
    pub added_lights: Vec<Light>,
    /// The objects that only the variant hides.
    pub hidden: Vec<ObjectId>,
    /// The objects that the studio hides and the variant does not.
    pub visible: Vec<ObjectId>,
}

impl SetupDifference {
    /// Returns the difference of `to` from `from`, both without a solo.
    pub(super) fn between(from: &StudioSetup, to: &StudioSetup) -> Self {
        let by_id = |setup: &'_ StudioSetup| -> HashMap<LightId, usize> {
            setup.lights.iter().enumerate().map(|(index, light)| (light.id, index)).collect()
        };
        let (of_studio, of_variant) = (by_id(from), by_id(to));
        let in_both = from.lights.iter().filter_map(|light| Some((light, &to.lights[*of_variant.get(&light.id)?])));
        let lights = in_both.map(|(light, other)| (light.id, LightDifference::between(light, other)));
        let removed = from.lights.iter().map(|light| light.id).filter(|id| !of_variant.contains_key(id));
        let added = to.lights.iter().filter(|light| !of_studio.contains_key(&light.id));
        SetupDifference {
            camera: CameraDifference::between(&from.camera, &to.camera),
            lights: lights.filter(|(_, difference)| !difference.is_empty()).collect(),
            removed_lights: removed.collect(),
            added_lights: added.cloned().collect(),
            hidden: without(&to.hidden, &from.hidden),
            visible: without(&from.hidden, &to.hidden),
        }
    }

    /// Returns the set-up of the variant.
    pub(super) fn applied(&self, studio: &StudioSetup) -> StudioSetup {
        let mut setup = studio.clone();
        self.camera.apply(&mut setup.camera);
        let removed: HashSet<LightId> = self.removed_lights.iter().copied().collect();
        let changed: HashMap<LightId, &LightDifference> = self.lights.iter().map(|(id, light)| (*id, light)).collect();
        setup.lights.retain(|light| !removed.contains(&light.id));
        for light in &mut setup.lights {
            if let Some(difference) = changed.get(&light.id) {
                difference.apply(light);
            }
        }
        setup.lights.extend(self.added_lights.iter().cloned());
        setup.hidden = without(&setup.hidden, &self.visible);
        setup.hidden.extend(without(&self.hidden, &studio.hidden));
        setup
    }
}

/// Returns the ids of `some` that are not in `others`, each once, in order.
fn without(some: &[ObjectId], others: &[ObjectId]) -> Vec<ObjectId> {
    let others: HashSet<ObjectId> = others.iter().copied().collect();
    let some: BTreeSet<ObjectId> = some.iter().filter(|id| !others.contains(id)).copied().collect();
    some.into_iter().collect()
}
