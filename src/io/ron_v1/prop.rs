//! Names of props in format 1.

use crate::scene::PropModel;
use serde::{Deserialize, Serialize};

#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[serde(rename = "Prop")]
pub(super) enum PropV1 {
    PosingStool,
    AppleBoxes,
    AcrylicTable,
    WoodTable,
    BlackGlassTable,
    CycloramaCorner,
    Canvas,
    Flag,
    Reflector,
    Scrim,
    DiffusingTent,
    WineBottle,
    PerfumeBottle,
    DrinkingGlass,
    WineGlass,
    CosmeticsJar,
    Watch,
    Lipstick,
    Apple,
    Orange,
    Pear,
    FoldedTextile,
}

same_variants!(PropV1 <=> PropModel {
    PosingStool,
    AppleBoxes,
    AcrylicTable,
    WoodTable,
    BlackGlassTable,
    CycloramaCorner,
    Canvas,
    Flag,
    Reflector,
    Scrim,
    DiffusingTent,
    WineBottle,
    PerfumeBottle,
    DrinkingGlass,
    WineGlass,
    CosmeticsJar,
    Watch,
    Lipstick,
    Apple,
    Orange,
    Pear,
    FoldedTextile,
});
