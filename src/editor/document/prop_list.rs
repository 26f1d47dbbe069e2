//! The catalog's props that are generated models, and the backdrops that are.

use crate::scene::{MaterialPreset, Object, PropModel, Shape};

/// An entry of a model.
#[derive(Clone, Copy, Debug)]
pub(super) struct ModelEntry {
    /// Name of the entry and of the object.
    pub name: &'static str,
    /// Tooltip.
    pub tip: &'static str,
    /// The model.
    pub model: PropModel,
    /// Material of the whole, where it is not the model's own.
    pub whole: Option<MaterialPreset>,
}

/// Returns the entry of a model with its own materials.
const fn model(name: &'static str, tip: &'static str, model: PropModel) -> ModelEntry {
    ModelEntry { name, tip, model, whole: None }
}

/// Returns the entry of a reflector with a face of this material.
const fn reflector(name: &'static str, tip: &'static str, face: MaterialPreset) -> ModelEntry {
    ModelEntry { name, tip, model: PropModel::Reflector, whole: Some(face) }
}

/// The props.
pub(super) const MODELS: [ModelEntry; 23] = [
    model("Posing stool", "A round stool of 55 cm with a leather seat.", PropModel::PosingStool),
    model("Apple boxes", "A full and a half box of birch plywood: to sit or to stand on.", PropModel::AppleBoxes),
    model("Wood table", "A table of oiled wood.", PropModel::WoodTable),
    model(
        "Acrylic table",
        "A product table of clear acrylic, 75 cm high: light from below passes it.",
        PropModel::AcrylicTable,
    ),
    model("Black glass table", "A table of black glass: it mirrors what stands on it.", PropModel::BlackGlassTable),
    model("Flag on a stand", "A black flag of 60 x 90 cm: it keeps light away.", PropModel::Flag),
    reflector("Reflector, white", "A round reflector of 1.1 m: soft fill.", MaterialPreset::WhitePaper),
    reflector(
        "Reflector, silver",
        "A round reflector of 1.1 m: more fill, and harder.",
        MaterialPreset::BrushedAluminium,
    ),
    reflector("Reflector, gold", "A round reflector of 1.1 m: warm fill.", MaterialPreset::Gold),
    model(
        "Scrim 1.2 x 1.2 m",
        "A frame of 1.2 m with diffusion cloth: a light behind it becomes a panel.",
        PropModel::Scrim,
    ),
    model(
        "Diffusing tent",
        "A tent of 80 cm for products: lights outside of it become soft.",
        PropModel::DiffusingTent,
    ),
    model("Wine bottle", "A bottle of red wine.", PropModel::WineBottle),
    model("Perfume bottle", "A block of glass with a golden collar.", PropModel::PerfumeBottle),
    model("Drinking glass", "A tumbler of water.", PropModel::DrinkingGlass),
    model("Empty glass", "A tumbler for a fluid that is poured into it.", PropModel::EmptyGlass),
    model("Wine glass", "A glass of red wine.", PropModel::WineGlass),
    model("Cosmetics jar", "A jar of frosted glass with a lid of aluminium.", PropModel::CosmeticsJar),
    model("Lipstick", "An open lipstick with its cap.", PropModel::Lipstick),
    model("Watch", "A wrist watch of 40 mm: steel, lacquer and crystal.", PropModel::Watch),
    model("Apple", "An apple, red on one side.", PropModel::Apple),
    model("Orange", "An orange.", PropModel::Orange),
    model("Pear", "A ripe pear.", PropModel::Pear),
    model("Folded textile", "Three folded towels.", PropModel::FoldedTextile),
];

/// The backdrops.
pub(super) const MODEL_BACKDROPS: [ModelEntry; 2] = [
    model("Painted canvas", "A hand-painted canvas of 2.4 x 2.7 m, lighter in its middle.", PropModel::Canvas),
    model("Cyclorama corner", "Two white walls and a floor without an edge, 4 x 4 m.", PropModel::CycloramaCorner),
];

/// Returns the object of a model, whose whole has another material if one is given.
pub(super) fn new_model(name: &str, model: PropModel, whole: Option<MaterialPreset>) -> Object {
    let mut object = Object::new(name, Shape::Prop(model));
    let mut materials = model.materials().into_iter();
    if let Some((_, material)) = materials.next() {
        object.material = whole.map_or(material, MaterialPreset::material);
    }
    object.part_materials = materials.map(|(part, material)| (part.to_owned(), material)).collect();
    object
}
