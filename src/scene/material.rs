//! Materials: diffuse, metal, dielectric, glass and emissive surfaces in one model.

use super::{Fibre, FibreColor, MaterialTextures};

/// Surface properties. Colours are scene-linear RGB with Rec.709 primaries.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// Diffuse albedo, or the mirror colour of a metal; each channel in [0, 1). Of a transmitting surface, the colour of
    /// what passes a thin pane, or both faces of a body; 1 for clear glass.
    pub base_color: [f32; 3],
    /// Textures, by the property that they vary.
    pub textures: MaterialTextures,
    /// 0 dielectric, 1 metal.
    pub metallic: f32,
    /// 0 mirror, 1 matte; GGX alpha is its square.
    pub roughness: f32,
    /// Index of refraction of the dielectric.
    pub ior: f32,
    /// 0 opaque, 1 clear glass or water.
    pub transmission: f32,
    /// Absorption inside a transmitting object, per metre (Beer-Lambert).
    pub absorption_per_m: [f32; 3],
    /// Scattering under the surface of an opaque body; none for a hard surface.
    pub subsurface: Option<Subsurface>,
    /// Luminance that the surface gives off as it glows, cd/m2, times its RGB.
    pub emission_cd_m2: [f32; 3],
    /// Strands of this material are such fibres; they ignore the properties of surfaces above, emission excepted.
    pub fibre: Option<Fibre>,
    /// Parts of the surface that are not there.
    pub alpha: Alpha,
}

/// The parts of a surface that are not there, by the alpha of its base colour's texture. Light passes them straight and
/// unchanged: leaves and lace, not glass.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub enum Alpha {
    /// All of the surface is there.
    #[default]
    Opaque,
    /// The surface is there where the texture's alpha is at least `cutoff`.
    Mask {
        /// Least alpha that is there.
        cutoff: f32,
    },
    /// The surface covers a part of each point: the texture's alpha times `opacity`.
    Blend {
        /// Factor of the texture's alpha.
        opacity: f32,
    },
}

impl Alpha {
    /// Returns the part of a point that is there, 0 to 1, for the texture's alpha.
    pub fn coverage(self, texture_alpha: f32) -> f32 {
        match self {
            Alpha::Opaque => 1.0,
            Alpha::Mask { cutoff } => f32::from(u8::from(texture_alpha >= cutoff)),
            Alpha::Blend { opacity } => (texture_alpha * opacity).clamp(0.0, 1.0),
        }
    }
}

/// Scattering of light under the surface of skin, wax or marble. The base colour stays the albedo of a thick body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Subsurface {
    /// Mean distance between two scattering events, millimetres: red, green, blue. Scattering is isotropic.
    pub mean_free_path_mm: [f32; 3],
}

impl Subsurface {
    /// Light skin. The reduced scattering coefficients of skin are 0.74, 0.88 and 1.01 per mm (Jensen et al. 2001, "A
    /// Practical Model for Subsurface Light Transport", figure 5, "skin1"); the mean free path is the single-scattering
    /// albedo that gives the preset's colour over them.
    pub const SKIN: Self = Subsurface { mean_free_path_mm: [1.29, 0.99, 0.79] };
    /// Medium skin, from the same coefficients: more is absorbed, so that light goes less far.
    pub const MEDIUM_SKIN: Self = Subsurface { mean_free_path_mm: [1.17, 0.78, 0.55] };
    /// Dark skin, from the same coefficients. Its pigment is taken to be spread evenly; in truth it lies near the
    /// surface, and red light goes further below it.
    pub const DARK_SKIN: Self = Subsurface { mean_free_path_mm: [0.69, 0.36, 0.21] };
}

impl Default for Material {
    fn default() -> Self {
        Material {
            base_color: [0.5; 3],
            textures: MaterialTextures::default(),
            metallic: 0.0,
            roughness: 0.6,
            ior: 1.5,
            transmission: 0.0,
            absorption_per_m: [0.0; 3],
            subsurface: None,
            emission_cd_m2: [0.0; 3],
            fibre: None,
            alpha: Alpha::Opaque,
        }
    }
}

impl Material {
    /// Returns true if the surface emits light.
    pub fn is_emissive(&self) -> bool {
        self.emission_cd_m2 != [0.0; 3]
    }
}

/// A material preset.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MaterialPreset {
    /// Light skin.
    SkinLight,
    /// Medium skin.
    SkinMedium,
    /// Dark skin.
    SkinDark,
    /// Black hair.
    HairBlack,
    /// Dark brown hair.
    HairDarkBrown,
    /// Brown hair.
    HairBrown,
    /// Blond hair.
    HairBlond,
    /// Red hair.
    HairRed,
    /// Grey hair.
    HairGrey,
    /// White hair.
    HairWhite,
    /// Glossy white of an eye.
    Eye,
    /// Cotton.
    MatteFabric,
    /// Satin.
    Satin,
    /// Black velvet.
    BlackVelvet,
    /// Shiny plastic.
    GlossyPlastic,
    /// Chrome.
    Chrome,
    /// Brushed aluminium.
    BrushedAluminium,
    /// Gold.
    Gold,
    /// Clear glass.
    ClearGlass,
    /// Water.
    Water,
    /// White backdrop paper.
    WhitePaper,
    /// Mid-grey backdrop paper.
    GreyPaper,
    /// Black backdrop paper.
    BlackPaper,
    /// 18 % grey card.
    GreyCard,
    /// Painted wall.
    PaintedWall,
    /// Studio floor, dark wood or concrete.
    StudioFloor,
}

impl MaterialPreset {
    /// All presets, in list order.
    pub const ALL: [MaterialPreset; 26] = [
        MaterialPreset::SkinLight,
        MaterialPreset::SkinMedium,
        MaterialPreset::SkinDark,
        MaterialPreset::HairBlack,
        MaterialPreset::HairDarkBrown,
        MaterialPreset::HairBrown,
        MaterialPreset::HairBlond,
        MaterialPreset::HairRed,
        MaterialPreset::HairGrey,
        MaterialPreset::HairWhite,
        MaterialPreset::Eye,
        MaterialPreset::MatteFabric,
        MaterialPreset::Satin,
        MaterialPreset::BlackVelvet,
        MaterialPreset::GlossyPlastic,
        MaterialPreset::Chrome,
        MaterialPreset::BrushedAluminium,
        MaterialPreset::Gold,
        MaterialPreset::ClearGlass,
        MaterialPreset::Water,
        MaterialPreset::WhitePaper,
        MaterialPreset::GreyPaper,
        MaterialPreset::BlackPaper,
        MaterialPreset::GreyCard,
        MaterialPreset::PaintedWall,
        MaterialPreset::StudioFloor,
    ];

    /// Returns the label in lists.
    pub fn label(self) -> &'static str {
        match self {
            MaterialPreset::SkinLight => "Skin, light",
            MaterialPreset::SkinMedium => "Skin, medium",
            MaterialPreset::SkinDark => "Skin, dark",
            MaterialPreset::HairBlack => "Hair, black",
            MaterialPreset::HairDarkBrown => "Hair, dark brown",
            MaterialPreset::HairBrown => "Hair, brown",
            MaterialPreset::HairBlond => "Hair, blond",
            MaterialPreset::HairRed => "Hair, red",
            MaterialPreset::HairGrey => "Hair, grey",
            MaterialPreset::HairWhite => "Hair, white",
            MaterialPreset::Eye => "Eye",
            MaterialPreset::MatteFabric => "Matte fabric",
            MaterialPreset::Satin => "Satin",
            MaterialPreset::BlackVelvet => "Black velvet",
            MaterialPreset::GlossyPlastic => "Glossy plastic",
            MaterialPreset::Chrome => "Chrome",
            MaterialPreset::BrushedAluminium => "Brushed aluminium",
            MaterialPreset::Gold => "Gold",
            MaterialPreset::ClearGlass => "Clear glass",
            MaterialPreset::Water => "Water",
            MaterialPreset::WhitePaper => "White paper",
            MaterialPreset::GreyPaper => "Grey paper",
            MaterialPreset::BlackPaper => "Black paper",
            MaterialPreset::GreyCard => "18 % grey card",
            MaterialPreset::PaintedWall => "Painted wall",
            MaterialPreset::StudioFloor => "Studio floor",
        }
    }

    /// Returns the material.
    pub fn material(self) -> Material {
        let opaque = |base_color, roughness| Material { base_color, roughness, ..Material::default() };
        let metal = |base_color, roughness| Material { metallic: 1.0, ..opaque(base_color, roughness) };
        // Meshes and the outlines of views show the base colour, strands the fibre.
        let hair = |fibre, base_color| Material { fibre: Some(fibre), ..opaque(base_color, 0.5) };
        let skin = |base_color, roughness, subsurface| Material {
            ior: 1.4,
            subsurface: Some(subsurface),
            ..opaque(base_color, roughness)
        };
        let clear = |ior| Material { transmission: 1.0, ior, ..opaque([1.0; 3], 0.0) };
        match self {
            MaterialPreset::SkinLight => skin([0.62, 0.43, 0.34], 0.48, Subsurface::SKIN),
            MaterialPreset::SkinMedium => skin([0.42, 0.25, 0.17], 0.45, Subsurface::MEDIUM_SKIN),
            MaterialPreset::SkinDark => skin([0.15, 0.08, 0.05], 0.42, Subsurface::DARK_SKIN),
            MaterialPreset::HairBlack => hair(Fibre::of_melanin(0.98, 0.0), [0.03; 3]),
            MaterialPreset::HairDarkBrown => hair(Fibre::of_melanin(0.9, 0.1), [0.06, 0.04, 0.03]),
            MaterialPreset::HairBrown => hair(Fibre::of_melanin(0.72, 0.2), [0.15, 0.09, 0.05]),
            MaterialPreset::HairBlond => hair(Fibre::of_melanin(0.27, 0.25), [0.5, 0.38, 0.23]),
            MaterialPreset::HairRed => hair(Fibre::of_melanin(0.7, 0.95), [0.35, 0.13, 0.05]),
            MaterialPreset::HairGrey => {
                hair(Fibre { color: FibreColor::Dye([0.42, 0.41, 0.4]), ..Fibre::default() }, [0.3; 3])
            }
            MaterialPreset::HairWhite => hair(Fibre::of_melanin(0.03, 0.3), [0.7, 0.68, 0.64]),
            MaterialPreset::Eye => Material { ior: 1.38, ..opaque([0.7, 0.68, 0.65], 0.08) },
            MaterialPreset::MatteFabric => opaque([0.25, 0.27, 0.32], 0.95),
            MaterialPreset::Satin => opaque([0.35, 0.05, 0.08], 0.35),
            MaterialPreset::BlackVelvet => Material { ior: 1.1, ..opaque([0.006; 3], 1.0) },
            MaterialPreset::GlossyPlastic => opaque([0.6, 0.08, 0.05], 0.12),
            MaterialPreset::Chrome => metal([0.55, 0.556, 0.554], 0.03),
            MaterialPreset::BrushedAluminium => metal([0.91, 0.92, 0.92], 0.4),
            MaterialPreset::Gold => metal([0.95, 0.64, 0.29], 0.15),
            MaterialPreset::ClearGlass => clear(1.52),
            MaterialPreset::Water => clear(1.333),
            MaterialPreset::WhitePaper => opaque([0.88, 0.88, 0.87], 0.95),
            MaterialPreset::GreyPaper => opaque([0.3; 3], 0.95),
            MaterialPreset::BlackPaper => opaque([0.03; 3], 0.95),
            // Without a specular lobe: the 18 % are the whole reflectance.
            MaterialPreset::GreyCard => Material { ior: 1.0, ..opaque([0.18; 3], 1.0) },
            MaterialPreset::PaintedWall => opaque([0.7, 0.69, 0.67], 0.85),
            MaterialPreset::StudioFloor => opaque([0.2, 0.19, 0.18], 0.55),
        }
    }
}
