//! Names of material presets in format 1.

use crate::scene::MaterialPreset;
use serde::{Deserialize, Serialize};

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
    PolishedGold,
    PolishedSilver,
    PolishedCopper,
    PolishedAluminium,
    BrushedSteel,
    Acrylic,
    CrownGlass,
    FrostedGlass,
    BlackGlass,
    CarPaint,
    Velvet,
    TracingPaper,
    ScrimSilk,
    Ceramic,
    Leather,
    Wood,
    WineRed,
    BottleGlass,
);
