//! Materials in format 1: `Preset(Chrome)`, or `Custom(...)` with the values that differ from the default.

use super::defaults::{Triple, default_ior, default_roughness, is_default, is_default_ior, is_unit, unit};
use super::material_layers::{AnisotropyV1, ClearcoatV1, SheenV1};
use super::material_preset::PresetV1;
use super::texture_placement::TexturePlacementV1;
use crate::scene::{
    Alpha, Anisotropy, Clearcoat, Fibre, FibreColor, Material, MaterialPreset, MaterialTextures, Sheen, Subsurface,
    TexturePlacement, TextureRef, TextureSlot,
};
use serde::{Deserialize, Serialize};

#[derive(Debug, Serialize, Deserialize)]
#[serde(rename = "Material", deny_unknown_fields)]
#[expect(clippy::large_enum_variant, reason = "a material is read or written, and not kept")]
pub(super) enum MaterialV1 {
    Preset(PresetV1),
    Custom {
        base_color: Triple,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        base_color_texture: Option<String>,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        base_color_placement: Option<TexturePlacementV1>,
        #[serde(default, skip_serializing_if = "is_default")]
        alpha: AlphaV1,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        metallic_roughness_texture: Option<String>,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        metallic_roughness_placement: Option<TexturePlacementV1>,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        normal_texture: Option<String>,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        normal_placement: Option<TexturePlacementV1>,
        #[serde(default = "unit", skip_serializing_if = "is_unit")]
        normal_scale: f32,
        #[serde(default, skip_serializing_if = "is_default")]
        smooth_gloss: bool,
        #[serde(default, skip_serializing_if = "is_default")]
        dome_radius: f32,
        #[serde(default, skip_serializing_if = "is_default")]
        metallic: f32,
        #[serde(default = "default_roughness")]
        roughness: f32,
        #[serde(default = "default_ior", skip_serializing_if = "is_default_ior")]
        ior: f32,
        #[serde(default, skip_serializing_if = "is_default")]
        transmission: f32,
        #[serde(default, skip_serializing_if = "is_default")]
        absorption_per_m: Triple,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        subsurface: Option<SubsurfaceV1>,
        #[serde(default, skip_serializing_if = "is_default")]
        emission_cd_m2: Triple,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        emission_texture: Option<String>,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        emission_placement: Option<TexturePlacementV1>,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        fibre: Option<FibreV1>,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        clearcoat: Option<ClearcoatV1>,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        sheen: Option<SheenV1>,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        anisotropy: Option<AnisotropyV1>,
        #[serde(default, skip_serializing_if = "is_default")]
        frosting: f32,
        #[serde(default, skip_serializing_if = "is_default")]
        translucency: f32,
    },
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(rename = "Alpha", deny_unknown_fields)]
pub(super) enum AlphaV1 {
    #[default]
    Opaque,
    Mask {
        cutoff: f32,
    },
    Blend {
        #[serde(default = "unit", skip_serializing_if = "is_unit")]
        opacity: f32,
    },
}

impl From<AlphaV1> for Alpha {
    fn from(alpha: AlphaV1) -> Self {
        match alpha {
            AlphaV1::Opaque => Alpha::Opaque,
            AlphaV1::Mask { cutoff } => Alpha::Mask { cutoff },
            AlphaV1::Blend { opacity } => Alpha::Blend { opacity },
        }
    }
}

impl From<Alpha> for AlphaV1 {
    fn from(alpha: Alpha) -> Self {
        match alpha {
            Alpha::Opaque => AlphaV1::Opaque,
            Alpha::Mask { cutoff } => AlphaV1::Mask { cutoff },
            Alpha::Blend { opacity } => AlphaV1::Blend { opacity },
        }
    }
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(rename = "Subsurface", deny_unknown_fields)]
pub(super) struct SubsurfaceV1 {
    mean_free_path_mm: Triple,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(rename = "Fibre", deny_unknown_fields)]
pub(super) struct FibreV1 {
    color: FibreColorV1,
    roughness_along: f32,
    roughness_around: f32,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(rename = "FibreColor", deny_unknown_fields)]
enum FibreColorV1 {
    Melanin { melanin: f32, redness: f32 },
    Dye(Triple),
}

impl From<FibreV1> for Fibre {
    fn from(fibre: FibreV1) -> Self {
        let FibreV1 { color, roughness_along, roughness_around } = fibre;
        let color = match color {
            FibreColorV1::Melanin { melanin, redness } => FibreColor::Melanin { melanin, redness },
            FibreColorV1::Dye(color) => FibreColor::Dye(color),
        };
        Fibre { color, roughness_along, roughness_around }
    }
}

impl From<Fibre> for FibreV1 {
    fn from(fibre: Fibre) -> Self {
        let Fibre { color, roughness_along, roughness_around } = fibre;
        let color = match color {
            FibreColor::Melanin { melanin, redness } => FibreColorV1::Melanin { melanin, redness },
            FibreColor::Dye(color) => FibreColorV1::Dye(color),
        };
        FibreV1 { color, roughness_along, roughness_around }
    }
}

impl From<MaterialV1> for Material {
    fn from(material: MaterialV1) -> Self {
        match material {
            MaterialV1::Preset(preset) => MaterialPreset::from(preset).material(),
            MaterialV1::Custom {
                base_color,
                base_color_texture,
                base_color_placement,
                alpha,
                metallic_roughness_texture,
                metallic_roughness_placement,
                normal_texture,
                normal_placement,
                normal_scale,
                smooth_gloss,
                dome_radius,
                metallic,
                roughness,
                ior,
                transmission,
                absorption_per_m,
                subsurface,
                emission_cd_m2,
                emission_texture,
                emission_placement,
                fibre,
                clearcoat,
                sheen,
                anisotropy,
                frosting,
                translucency,
            } => Material {
                base_color,
                textures: MaterialTextures {
                    base_color: base_color_texture.as_deref().map(TextureRef::parse),
                    metallic_roughness: metallic_roughness_texture.as_deref().map(TextureRef::parse),
                    emission: emission_texture.as_deref().map(TextureRef::parse),
                    normal: normal_texture.as_deref().map(TextureRef::parse),
                    normal_scale,
                    smooth_gloss,
                    dome_radius,
                    placements: TextureSlot::ALL.map(|slot| {
                        let placement = match slot {
                            TextureSlot::BaseColor => base_color_placement,
                            TextureSlot::MetallicRoughness => metallic_roughness_placement,
                            TextureSlot::Emission => emission_placement,
                            TextureSlot::Normal => normal_placement,
                        };
                        placement.map(TexturePlacement::from).unwrap_or_default()
                    }),
                },
                metallic,
                roughness,
                ior,
                transmission,
                absorption_per_m,
                subsurface: subsurface.map(|SubsurfaceV1 { mean_free_path_mm }| Subsurface { mean_free_path_mm }),
                emission_cd_m2,
                fibre: fibre.map(Fibre::from),
                alpha: alpha.into(),
                clearcoat: clearcoat.map(Clearcoat::from),
                sheen: sheen.map(Sheen::from),
                anisotropy: anisotropy.map(Anisotropy::from),
                frosting,
                translucency,
            },
        }
    }
}

impl From<&Material> for MaterialV1 {
    /// Writes a material that equals a preset by the preset's name.
    fn from(material: &Material) -> Self {
        if let Some(preset) = MaterialPreset::ALL.into_iter().find(|preset| preset.material() == *material) {
            return MaterialV1::Preset(preset.into());
        }
        let Material {
            base_color,
            textures,
            metallic,
            roughness,
            ior,
            transmission,
            absorption_per_m,
            subsurface,
            emission_cd_m2,
            fibre,
            alpha,
            clearcoat,
            sheen,
            anisotropy,
            frosting,
            translucency,
        } = material.clone();
        let texture = |slot: TextureSlot| textures.get(slot).map(TextureRef::to_string);
        let placement = |slot: TextureSlot| {
            let placement = *textures.placement(slot);
            (placement != TexturePlacement::default()).then(|| placement.into())
        };
        MaterialV1::Custom {
            base_color,
            base_color_texture: texture(TextureSlot::BaseColor),
            base_color_placement: placement(TextureSlot::BaseColor),
            alpha: alpha.into(),
            metallic_roughness_texture: texture(TextureSlot::MetallicRoughness),
            metallic_roughness_placement: placement(TextureSlot::MetallicRoughness),
            normal_texture: texture(TextureSlot::Normal),
            normal_placement: placement(TextureSlot::Normal),
            normal_scale: textures.normal_scale,
            smooth_gloss: textures.smooth_gloss,
            dome_radius: textures.dome_radius,
            metallic,
            roughness,
            ior,
            transmission,
            absorption_per_m,
            subsurface: subsurface.map(|Subsurface { mean_free_path_mm }| SubsurfaceV1 { mean_free_path_mm }),
            emission_cd_m2,
            emission_texture: texture(TextureSlot::Emission),
            emission_placement: placement(TextureSlot::Emission),
            fibre: fibre.map(FibreV1::from),
            clearcoat: clearcoat.map(ClearcoatV1::from),
            sheen: sheen.map(SheenV1::from),
            anisotropy: anisotropy.map(AnisotropyV1::from),
            frosting,
            translucency,
        }
    }
}
