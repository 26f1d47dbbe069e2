//! The materials of props. Colours are typical of such things; metals and glass have measured constants.

use super::PropModel;
use crate::scene::{Clearcoat, Material, MaterialPreset, Sheen};

/// Returns the materials of a model's parts; the first is that of the whole.
pub(super) fn of(model: PropModel) -> Vec<(&'static str, Material)> {
    use MaterialPreset as Preset;
    let preset = |part, preset: Preset| (part, preset.material());
    match model {
        PropModel::PosingStool => vec![preset("cushion", Preset::Leather), preset("metal", Preset::Chrome)],
        PropModel::AppleBoxes => vec![("wood", birch()), preset("hole", Preset::BlackPaper)],
        PropModel::AcrylicTable => vec![preset("acrylic", Preset::Acrylic), preset("legs", Preset::BrushedSteel)],
        PropModel::WoodTable => vec![preset("wood", Preset::Wood), preset("legs", Preset::Wood)],
        PropModel::BlackGlassTable => vec![preset("glass", Preset::BlackGlass), preset("legs", Preset::BrushedSteel)],
        PropModel::CycloramaCorner => vec![("paint", matte([0.82, 0.82, 0.81]))],
        PropModel::Canvas => vec![("canvas", matte([0.34, 0.33, 0.33]))],
        PropModel::Flag => vec![preset("cloth", Preset::BlackVelvet), preset("metal", Preset::BrushedSteel)],
        PropModel::Reflector => vec![preset("face", Preset::WhitePaper), preset("rim", Preset::BlackPaper)],
        PropModel::Scrim => vec![preset("cloth", Preset::ScrimSilk), preset("metal", Preset::BrushedSteel)],
        PropModel::DiffusingTent => vec![
            preset("cloth", Preset::TracingPaper),
            preset("floor", Preset::WhitePaper),
            preset("rods", Preset::WhitePaper),
        ],
        PropModel::WineBottle => vec![
            preset("glass", Preset::BottleGlass),
            preset("drink", Preset::WineRed),
            ("label", matte([0.78, 0.73, 0.62])),
            ("foil", Material { metallic: 0.6, ..plastic([0.22, 0.02, 0.03], 0.35) }),
        ],
        PropModel::PerfumeBottle => vec![
            preset("glass", Preset::CrownGlass),
            ("drink", drink([2.0, 11.0, 38.0], 1.36)),
            preset("metal", Preset::PolishedGold),
            ("cap", plastic([0.012, 0.012, 0.013], 0.08)),
        ],
        PropModel::DrinkingGlass => vec![preset("glass", Preset::CrownGlass), preset("drink", Preset::Water)],
        PropModel::EmptyGlass => vec![preset("glass", Preset::CrownGlass)],
        PropModel::WineGlass => vec![preset("glass", Preset::CrownGlass), preset("drink", Preset::WineRed)],
        PropModel::CosmeticsJar => vec![
            preset("glass", Preset::FrostedGlass),
            ("cream", matte([0.85, 0.82, 0.76])),
            preset("metal", Preset::PolishedAluminium),
        ],
        PropModel::Watch => vec![
            preset("case", Preset::BrushedSteel),
            ("bezel", Material { roughness: 0.06, anisotropy: None, ..Preset::BrushedSteel.material() }),
            ("dial", lacquered([0.012, 0.025, 0.075], 0.5)),
            ("hands", Material { roughness: 0.12, ..Preset::PolishedAluminium.material() }),
            preset("crystal", Preset::CrownGlass),
            ("strap", Material { base_color: [0.1, 0.042, 0.018], ..Preset::Leather.material() }),
        ],
        PropModel::Lipstick => vec![
            ("case", plastic([0.012, 0.012, 0.012], 0.12)),
            preset("metal", Preset::PolishedGold),
            ("stick", Material { ior: 1.45, ..plastic([0.45, 0.02, 0.035], 0.32) }),
        ],
        // Vertex colours are factors of white skin
        PropModel::Apple => vec![("skin", lacquered([0.72; 3], 0.5)), stem()],
        PropModel::Orange => vec![
            (
                "skin",
                Material {
                    clearcoat: Some(Clearcoat { amount: 0.6, roughness: 0.4 }),
                    ..plastic([0.8, 0.3, 0.025], 0.6)
                },
            ),
            stem(),
        ],
        PropModel::Pear => vec![
            (
                "skin",
                Material {
                    clearcoat: Some(Clearcoat { amount: 0.5, roughness: 0.35 }),
                    ..plastic([0.62, 0.58, 0.2], 0.6)
                },
            ),
            stem(),
        ],
        PropModel::FoldedTextile => {
            vec![
                ("under", towel([0.55, 0.5, 0.42])),
                ("middle", towel([0.16, 0.2, 0.24])),
                ("over", towel([0.5, 0.16, 0.12])),
            ]
        }
    }
}

fn matte(base_color: [f32; 3]) -> Material {
    Material { base_color, roughness: 0.95, ..Material::default() }
}

fn plastic(base_color: [f32; 3], roughness: f32) -> Material {
    Material { base_color, roughness, ..Material::default() }
}

fn lacquered(base_color: [f32; 3], roughness: f32) -> Material {
    Material { clearcoat: Some(Clearcoat { amount: 1.0, roughness: 0.18 }), ..plastic(base_color, roughness) }
}

/// Birch plywood, varnished.
fn birch() -> Material {
    Material { clearcoat: Some(Clearcoat { amount: 0.5, roughness: 0.4 }), ..plastic([0.52, 0.36, 0.2], 0.7) }
}

/// Something clear to drink or to smell, by its absorption per metre.
fn drink(absorption_per_m: [f32; 3], ior: f32) -> Material {
    Material { absorption_per_m, ior, ..MaterialPreset::Water.material() }
}

fn stem() -> (&'static str, Material) {
    ("stem", matte([0.11, 0.065, 0.03]))
}

/// Terry cloth: standing loops.
fn towel(base_color: [f32; 3]) -> Material {
    let sheen = Some(Sheen { color: base_color.map(|c| 0.4 + 0.5 * c), roughness: 0.6 });
    Material { sheen, ior: 1.1, roughness: 1.0, base_color, ..Material::default() }
}
