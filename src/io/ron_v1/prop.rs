//! Names of props in format 1.

use crate::scene::PropModel;

named_variants!(PropV1 as "Prop" <=> PropModel {
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
    EmptyGlass,
    WineGlass,
    CosmeticsJar,
    Watch,
    Lipstick,
    Apple,
    Orange,
    Pear,
    FoldedTextile,
});
