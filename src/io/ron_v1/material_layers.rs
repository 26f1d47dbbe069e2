//! Lacquer, sheen and brushing in format 1.

use super::defaults::{Triple, is_default};
use crate::scene::{Anisotropy, Clearcoat, Sheen};
use serde::{Deserialize, Serialize};

#[derive(Debug, Serialize, Deserialize)]
#[serde(rename = "Clearcoat", deny_unknown_fields)]
pub(super) struct ClearcoatV1 {
    amount: f32,
    roughness: f32,
}

impl From<ClearcoatV1> for Clearcoat {
    fn from(ClearcoatV1 { amount, roughness }: ClearcoatV1) -> Self {
        Clearcoat { amount, roughness }
    }
}

impl From<Clearcoat> for ClearcoatV1 {
    fn from(Clearcoat { amount, roughness }: Clearcoat) -> Self {
        ClearcoatV1 { amount, roughness }
    }
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(rename = "Sheen", deny_unknown_fields)]
pub(super) struct SheenV1 {
    color: Triple,
    roughness: f32,
}

impl From<SheenV1> for Sheen {
    fn from(SheenV1 { color, roughness }: SheenV1) -> Self {
        Sheen { color, roughness }
    }
}

impl From<Sheen> for SheenV1 {
    fn from(Sheen { color, roughness }: Sheen) -> Self {
        SheenV1 { color, roughness }
    }
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(rename = "Anisotropy", deny_unknown_fields)]
pub(super) struct AnisotropyV1 {
    strength: f32,
    #[serde(default, skip_serializing_if = "is_default")]
    rotation_deg: f32,
}

impl From<AnisotropyV1> for Anisotropy {
    fn from(AnisotropyV1 { strength, rotation_deg }: AnisotropyV1) -> Self {
        Anisotropy { strength, rotation_deg }
    }
}

impl From<Anisotropy> for AnisotropyV1 {
    fn from(Anisotropy { strength, rotation_deg }: Anisotropy) -> Self {
        AnisotropyV1 { strength, rotation_deg }
    }
}
