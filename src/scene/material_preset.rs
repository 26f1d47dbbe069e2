//! Named materials.

use super::surface_layers::metal_color;
use super::{Anisotropy, Clearcoat, Fibre, FibreColor, Material, Sheen, Subsurface};

/// Complex indices of refraction n, k of gold at 611, 549 and 464 nm, interpolated in the table of Johnson and Christy
/// 1972, "Optical Constants of the Noble Metals". The reflectances at normal incidence are 0.925, 0.789, 0.404.
pub const GOLD: [[f32; 2]; 3] = [[0.222, 3.208], [0.428, 2.461], [1.335, 1.872]];
/// As [`GOLD`], from the same source, of silver: 0.987, 0.983, 0.979.
pub const SILVER: [[f32; 2]; 3] = [[0.058, 4.106], [0.060, 3.590], [0.046, 2.795]];
/// As [`GOLD`], from the same source, of copper: 0.876, 0.621, 0.549.
pub const COPPER: [[f32; 2]; 3] = [[0.362, 3.127], [1.015, 2.579], [1.246, 2.453]];
/// As [`GOLD`], of aluminium, from Rakic 1995, "Algorithm for the Determination of Intrinsic Optical Constants of Metal
/// Films: Application to Aluminum": 0.910, 0.915, 0.921.
pub const ALUMINIUM: [[f32; 2]; 3] = [[1.322, 7.311], [1.011, 6.617], [0.683, 5.625]];

/// Roughness of skin of any tone: its facets' slopes have a root mean square of 0.3, the square of this, which d'Eon and
/// Luebke 2007, "Advanced Techniques for Realistic Real-Time Skin Rendering", use for the faces that Weyrich et al. 2006
/// measured.
const SKIN_ROUGHNESS: f32 = 0.55;

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
    /// Gold, polished: measured n and k.
    PolishedGold,
    /// Silver, polished: measured n and k.
    PolishedSilver,
    /// Copper, polished: measured n and k.
    PolishedCopper,
    /// Aluminium, polished: measured n and k.
    PolishedAluminium,
    /// Steel, brushed along the texture's V axis.
    BrushedSteel,
    /// Clear acrylic glass.
    Acrylic,
    /// Crown glass (N-BK7).
    CrownGlass,
    /// Glass with ground or etched faces.
    FrostedGlass,
    /// Black glass or black acrylic, polished.
    BlackGlass,
    /// Red paint with metal flakes under lacquer.
    CarPaint,
    /// Red velvet.
    Velvet,
    /// Translucent paper or a diffusion cloth of one stop and a half.
    TracingPaper,
    /// White diffusion cloth, about 1 1/4 stops.
    ScrimSilk,
    /// White glazed ceramic.
    Ceramic,
    /// Black leather.
    Leather,
    /// Oiled oak.
    Wood,
    /// Red wine.
    WineRed,
    /// Green bottle glass.
    BottleGlass,
}

impl MaterialPreset {
    /// All presets, in list order.
    pub const ALL: [MaterialPreset; 44] = [
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
        MaterialPreset::PolishedGold,
        MaterialPreset::PolishedSilver,
        MaterialPreset::PolishedCopper,
        MaterialPreset::PolishedAluminium,
        MaterialPreset::BrushedSteel,
        MaterialPreset::Acrylic,
        MaterialPreset::CrownGlass,
        MaterialPreset::FrostedGlass,
        MaterialPreset::BlackGlass,
        MaterialPreset::CarPaint,
        MaterialPreset::Velvet,
        MaterialPreset::TracingPaper,
        MaterialPreset::ScrimSilk,
        MaterialPreset::Ceramic,
        MaterialPreset::Leather,
        MaterialPreset::Wood,
        MaterialPreset::WineRed,
        MaterialPreset::BottleGlass,
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
            MaterialPreset::PolishedGold => "Gold, polished",
            MaterialPreset::PolishedSilver => "Silver, polished",
            MaterialPreset::PolishedCopper => "Copper, polished",
            MaterialPreset::PolishedAluminium => "Aluminium, polished",
            MaterialPreset::BrushedSteel => "Brushed steel",
            MaterialPreset::Acrylic => "Acrylic",
            MaterialPreset::CrownGlass => "Crown glass",
            MaterialPreset::FrostedGlass => "Frosted glass",
            MaterialPreset::BlackGlass => "Black glass",
            MaterialPreset::CarPaint => "Car paint",
            MaterialPreset::Velvet => "Velvet, red",
            MaterialPreset::TracingPaper => "Tracing paper",
            MaterialPreset::ScrimSilk => "Scrim silk",
            MaterialPreset::Ceramic => "Ceramic, glazed",
            MaterialPreset::Leather => "Leather, black",
            MaterialPreset::Wood => "Wood, oiled",
            MaterialPreset::WineRed => "Red wine",
            MaterialPreset::BottleGlass => "Bottle glass, green",
        }
    }

    /// Returns the material.
    pub fn material(self) -> Material {
        let opaque = |base_color, roughness| Material { base_color, roughness, ..Material::default() };
        let metal = |base_color, roughness| Material { metallic: 1.0, ..opaque(base_color, roughness) };
        // Meshes and the outlines of views show the base colour, strands the fibre.
        let hair = |fibre, base_color| Material { fibre: Some(fibre), ..opaque(base_color, 0.5) };
        let skin = |base_color, subsurface| Material {
            ior: 1.4,
            subsurface: Some(subsurface),
            ..opaque(base_color, SKIN_ROUGHNESS)
        };
        let clear = |ior| Material { transmission: 1.0, ior, ..opaque([1.0; 3], 0.0) };
        // Cloth and paper without a specular lobe: the albedo is that of both sides together
        let translucent = |base_color, translucency| Material { translucency, ior: 1.0, ..opaque(base_color, 1.0) };
        match self {
            MaterialPreset::SkinLight => skin([0.62, 0.43, 0.34], Subsurface::SKIN),
            MaterialPreset::SkinMedium => skin([0.42, 0.25, 0.17], Subsurface::MEDIUM_SKIN),
            MaterialPreset::SkinDark => skin([0.15, 0.08, 0.05], Subsurface::DARK_SKIN),
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
            MaterialPreset::PolishedGold => metal(metal_color(GOLD), 0.08),
            MaterialPreset::PolishedSilver => metal(metal_color(SILVER), 0.08),
            MaterialPreset::PolishedCopper => metal(metal_color(COPPER), 0.1),
            MaterialPreset::PolishedAluminium => metal(metal_color(ALUMINIUM), 0.1),
            MaterialPreset::BrushedSteel => {
                let anisotropy = Some(Anisotropy { strength: 0.6, rotation_deg: 0.0 });
                Material { anisotropy, ..metal([0.56, 0.54, 0.52], 0.28) }
            }
            // PMMA at 589 nm
            MaterialPreset::Acrylic => clear(1.491),
            // Schott N-BK7 at 588 nm
            MaterialPreset::CrownGlass => clear(1.5168),
            MaterialPreset::FrostedGlass => Material { frosting: 0.35, ..clear(1.5168) },
            MaterialPreset::BlackGlass => Material { ior: 1.5168, ..opaque([0.004; 3], 0.02) },
            MaterialPreset::CarPaint => {
                Material { metallic: 0.4, clearcoat: Some(Clearcoat::POLISHED), ..opaque([0.42, 0.02, 0.02], 0.45) }
            }
            MaterialPreset::Velvet => {
                let sheen = Some(Sheen { color: [0.6, 0.12, 0.12], roughness: 0.4 });
                Material { sheen, ior: 1.1, ..opaque([0.11, 0.005, 0.008], 1.0) }
            }
            MaterialPreset::TracingPaper => translucent([0.86, 0.86, 0.84], 0.4),
            MaterialPreset::ScrimSilk => translucent([0.9, 0.9, 0.89], 0.47),
            MaterialPreset::Ceramic => {
                Material { clearcoat: Some(Clearcoat::POLISHED), ..opaque([0.82, 0.81, 0.78], 0.6) }
            }
            MaterialPreset::Leather => {
                let clearcoat = Some(Clearcoat { amount: 0.5, roughness: 0.45 });
                Material { clearcoat, ..opaque([0.025, 0.024, 0.023], 0.6) }
            }
            MaterialPreset::Wood => {
                let clearcoat = Some(Clearcoat { amount: 0.4, roughness: 0.35 });
                Material { clearcoat, ..opaque([0.36, 0.22, 0.11], 0.6) }
            }
            MaterialPreset::WineRed => Material { absorption_per_m: [12.0, 160.0, 120.0], ..clear(1.343) },
            MaterialPreset::BottleGlass => Material { absorption_per_m: [190.0, 70.0, 240.0], ..clear(1.52) },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::surface_layers::metal_reflectance;

    #[test]
    fn polished_metals_have_the_reflectances_of_their_measured_indices() {
        // The comments state them to three digits
        for (indices, stated) in [
            (GOLD, [0.925, 0.789, 0.404]),
            (SILVER, [0.987, 0.983, 0.979]),
            (COPPER, [0.876, 0.621, 0.549]),
            (ALUMINIUM, [0.910, 0.915, 0.921]),
        ] {
            for (index, stated) in indices.into_iter().zip(stated) {
                assert!((metal_reflectance(index) - stated).abs() < 1e-3, "{index:?} is not {stated}");
            }
        }
        // Without absorption it is the reflectance of a dielectric
        assert!((metal_reflectance([1.5, 0.0]) - 0.04).abs() < 1e-6);
        assert_eq!(MaterialPreset::PolishedSilver.material().base_color, metal_color(SILVER));
    }
}
