//! The list of gear in format 1.

use super::defaults::is_default;
use super::head::HeadDialV1;
use super::{EmitterV1, ModifierV1, OutputV1};
use crate::gear::{GearList, HeadModel, ModifierModel, Support, SupportKind};
use crate::scene::{Head, NamedModifier};
use serde::{Deserialize, Serialize};

/// A list of gear.
#[derive(Debug, Serialize, Deserialize)]
#[serde(rename = "Gear", deny_unknown_fields)]
pub(in crate::io) struct GearV1 {
    format: u32,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    heads: Vec<HeadModelV1>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    modifiers: Vec<ModifierModelV1>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    supports: Vec<SupportV1>,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(rename = "HeadModel", deny_unknown_fields)]
struct HeadModelV1 {
    name: String,
    output: OutputV1,
    #[serde(default = "daylight")]
    kelvin: f32,
    dial: HeadDialV1,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    sync_s: Option<f32>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    hss_loss_stops: Option<f32>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    t01_s: Option<f32>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    front: Option<EmitterV1>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    weight_kg: Option<f32>,
    #[serde(default = "typical")]
    source: String,
    #[serde(default, skip_serializing_if = "is_default")]
    owned: u32,
}

/// A modifier. Without an emitter it is one of [`NamedModifier::ALL`].
#[derive(Debug, Serialize, Deserialize)]
#[serde(rename = "ModifierModel", deny_unknown_fields)]
struct ModifierModelV1 {
    name: String,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    emitter: Option<EmitterV1>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    modifier: Option<ModifierV1>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    weight_kg: Option<f32>,
    #[serde(default = "typical")]
    source: String,
    #[serde(default, skip_serializing_if = "is_default")]
    owned: u32,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(rename = "Support", deny_unknown_fields)]
struct SupportV1 {
    name: String,
    kind: SupportKindV1,
    reach_m: f32,
    load_kg: f32,
    #[serde(default = "typical")]
    source: String,
    #[serde(default, skip_serializing_if = "is_default")]
    owned: u32,
}

#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[serde(rename = "SupportKind")]
enum SupportKindV1 {
    Stand,
    Boom,
}

fn daylight() -> f32 {
    5500.0
}

fn typical() -> String {
    "typical".to_owned()
}

/// Converts a file.
///
/// # Errors
/// The name of a modifier that is not known and has no emitter.
pub(in crate::io) fn gear_from_v1(file: GearV1) -> Result<GearList, String> {
    Ok(GearList {
        heads: file.heads.into_iter().map(head_model_from).collect(),
        modifiers: file.modifiers.into_iter().map(modifier_model_from).collect::<Result<_, _>>()?,
        supports: file.supports.into_iter().map(support_from).collect(),
    })
}

fn head_model_from(file: HeadModelV1) -> HeadModel {
    HeadModel {
        head: Head {
            name: file.name,
            dial: file.dial.into(),
            sync_s: file.sync_s,
            hss_loss_stops: file.hss_loss_stops,
            t01_s: file.t01_s,
        },
        output: file.output.into(),
        kelvin: file.kelvin,
        front: file.front.map(Into::into),
        weight_kg: file.weight_kg,
        source: file.source,
        owned: file.owned,
    }
}

fn modifier_model_from(file: ModifierModelV1) -> Result<ModifierModel, String> {
    let ModifierModelV1 { name, emitter, modifier, weight_kg, source, owned } = file;
    let named = NamedModifier::named(&name);
    let emitter = emitter.map(Into::into).or(named.map(|named| named.emitter)).ok_or_else(|| name.clone())?;
    let modifier = modifier.map(Into::into).or(named.map(|named| named.modifier)).unwrap_or_default();
    Ok(ModifierModel { name, emitter, modifier, weight_kg, source, owned })
}

fn support_from(file: SupportV1) -> Support {
    let kind = match file.kind {
        SupportKindV1::Stand => SupportKind::Stand,
        SupportKindV1::Boom => SupportKind::Boom,
    };
    let SupportV1 { name, kind: _, reach_m, load_kg, source, owned } = file;
    Support { name, kind, reach_m, load_kg, source, owned }
}

/// Converts a list to a file.
pub(in crate::io) fn v1_from_gear(gear: &GearList) -> GearV1 {
    let head = |HeadModel { head, output, kelvin, front, weight_kg, source, owned }: &HeadModel| HeadModelV1 {
        name: head.name.clone(),
        output: (*output).into(),
        kelvin: *kelvin,
        dial: head.dial.into(),
        sync_s: head.sync_s,
        hss_loss_stops: head.hss_loss_stops,
        t01_s: head.t01_s,
        front: front.map(Into::into),
        weight_kg: *weight_kg,
        source: source.clone(),
        owned: *owned,
    };
    let modifier = |ModifierModel { name, emitter, modifier, weight_kg, source, owned }: &ModifierModel| {
        let is_named =
            NamedModifier::named(name).is_some_and(|named| named.emitter == *emitter && named.modifier == *modifier);
        ModifierModelV1 {
            name: name.clone(),
            emitter: (!is_named).then(|| (*emitter).into()),
            modifier: (!is_named).then(|| (*modifier).into()),
            weight_kg: *weight_kg,
            source: source.clone(),
            owned: *owned,
        }
    };
    let support = |Support { name, kind, reach_m, load_kg, source, owned }: &Support| SupportV1 {
        name: name.clone(),
        kind: match kind {
            SupportKind::Stand => SupportKindV1::Stand,
            SupportKind::Boom => SupportKindV1::Boom,
        },
        reach_m: *reach_m,
        load_kg: *load_kg,
        source: source.clone(),
        owned: *owned,
    };
    GearV1 {
        format: 1,
        heads: gear.heads.iter().map(head).collect(),
        modifiers: gear.modifiers.iter().map(modifier).collect(),
        supports: gear.supports.iter().map(support).collect(),
    }
}
