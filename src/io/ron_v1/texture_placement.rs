//! How a texture lies on a surface, in format 1.

use super::defaults::is_default;
use crate::scene::{TexturePlacement, Wrap};
use serde::{Deserialize, Serialize};

#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[serde(rename = "TexturePlacement", deny_unknown_fields)]
pub(super) struct TexturePlacementV1 {
    #[serde(default, skip_serializing_if = "is_default")]
    offset: (f32, f32),
    #[serde(default, skip_serializing_if = "is_default")]
    rotation_deg: f32,
    #[serde(default = "no_scale", skip_serializing_if = "is_no_scale")]
    scale: (f32, f32),
    #[serde(default, skip_serializing_if = "is_default")]
    wrap: (WrapV1, WrapV1),
    #[serde(default, skip_serializing_if = "is_default")]
    nearest: bool,
    #[serde(default, skip_serializing_if = "is_default")]
    second_uvs: bool,
}

fn no_scale() -> (f32, f32) {
    (1.0, 1.0)
}

fn is_no_scale(scale: &(f32, f32)) -> bool {
    *scale == no_scale()
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(rename = "Wrap")]
enum WrapV1 {
    #[default]
    Repeat,
    Mirror,
    Clamp,
}

impl From<WrapV1> for Wrap {
    fn from(wrap: WrapV1) -> Self {
        match wrap {
            WrapV1::Repeat => Wrap::Repeat,
            WrapV1::Mirror => Wrap::Mirror,
            WrapV1::Clamp => Wrap::Clamp,
        }
    }
}

impl From<Wrap> for WrapV1 {
    fn from(wrap: Wrap) -> Self {
        match wrap {
            Wrap::Repeat => WrapV1::Repeat,
            Wrap::Mirror => WrapV1::Mirror,
            Wrap::Clamp => WrapV1::Clamp,
        }
    }
}

impl From<TexturePlacementV1> for TexturePlacement {
    fn from(placement: TexturePlacementV1) -> Self {
        let TexturePlacementV1 { offset, rotation_deg, scale, wrap, nearest, second_uvs } = placement;
        TexturePlacement {
            offset: offset.into(),
            rotation_deg,
            scale: scale.into(),
            wrap: [wrap.0.into(), wrap.1.into()],
            nearest,
            second_uvs,
        }
    }
}

impl From<TexturePlacement> for TexturePlacementV1 {
    fn from(placement: TexturePlacement) -> Self {
        let TexturePlacement { offset, rotation_deg, scale, wrap: [across, down], nearest, second_uvs } = placement;
        TexturePlacementV1 {
            offset: offset.into(),
            rotation_deg,
            scale: scale.into(),
            wrap: (across.into(), down.into()),
            nearest,
            second_uvs,
        }
    }
}
