//! Materials in format 1: `Preset(Chrome)`, or `Custom(...)` with the values that differ from the default.

use super::defaults::{Triple, default_ior, default_roughness, is_default, is_default_ior};
use crate::scene::{Fibre, FibreColor, Material, MaterialPreset, MaterialTextures, Subsurface, TextureRef};
use serde::{Deserialize, Serialize};

#[derive(Debug, Serialize, Deserialize)]
#[serde(rename = "Material", deny_unknown_fields)]
pub(super) enum MaterialV1 {
    Preset(PresetV1),
    Custom {
        base_color: Triple,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        base_color_texture: Option<String>,
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
        fibre: Option<FibreV1>,
    },
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

/// Declares the presets' names in the file and both conversions.
macro_rules! presets {
    ($($name:ident),+ $(,)?) => {
        #[derive(Clone, Copy, Debug, Serialize, Deserialize)]
        #[serde(rename = "Preset")]
        pub(super) enum PresetV1 { $($name),+ }

        impl From<PresetV1> for MaterialPreset {
            fn from(preset: PresetV1) -> Self {
                match preset { $(PresetV1::$name => MaterialPreset::$name),+ }
            }
        }

        impl From<MaterialPreset> for PresetV1 {
            fn from(preset: MaterialPreset) -> Self {
                match preset { $(MaterialPreset::$name => PresetV1::$name),+ }
            }
        }
    };
}

presets!(
    SkinLight,
    SkinMedium,
    SkinDark,
    HairBlack,
    HairDarkBrown,
    HairBrown,
    HairBlond,
    HairRed,
    HairGrey,
    HairWhite,
    Eye,
    MatteFabric,
    Satin,
    BlackVelvet,
    GlossyPlastic,
    Chrome,
    BrushedAluminium,
    Gold,
    ClearGlass,
    Water,
    WhitePaper,
    GreyPaper,
    BlackPaper,
    GreyCard,
    PaintedWall,
    StudioFloor,
);

impl From<MaterialV1> for Material {
    fn from(material: MaterialV1) -> Self {
        match material {
            MaterialV1::Preset(preset) => MaterialPreset::from(preset).material(),
            MaterialV1::Custom {
                base_color,
                base_color_texture,
                metallic,
                roughness,
                ior,
                transmission,
                absorption_per_m,
                subsurface,
                emission_cd_m2,
                fibre,
            } => Material {
                base_color,
                textures: MaterialTextures { base_color: base_color_texture.as_deref().map(TextureRef::parse) },
                metallic,
                roughness,
                ior,
                transmission,
                absorption_per_m,
                subsurface: subsurface.map(|SubsurfaceV1 { mean_free_path_mm }| Subsurface { mean_free_path_mm }),
                emission_cd_m2,
                fibre: fibre.map(Fibre::from),
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
            textures: MaterialTextures { base_color: base_color_texture },
            metallic,
            roughness,
            ior,
            transmission,
            absorption_per_m,
            subsurface,
            emission_cd_m2,
            fibre,
        } = material.clone();
        MaterialV1::Custom {
            base_color,
            base_color_texture: base_color_texture.map(|texture| texture.to_string()),
            metallic,
            roughness,
            ior,
            transmission,
            absorption_per_m,
            subsurface: subsurface.map(|Subsurface { mean_free_path_mm }| SubsurfaceV1 { mean_free_path_mm }),
            emission_cd_m2,
            fibre: fibre.map(FibreV1::from),
        }
    }
}
