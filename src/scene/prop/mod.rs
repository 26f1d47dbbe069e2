//! Props: things that stand about a set or are photographed, generated here from profiles and boxes.
//!
//! | file | contents |
//! |---|---|
//! | `solid` | the builder: turned solids, rods, boxes, cloth |
//! | `furniture` | stools, boxes and tables |
//! | `set` | backdrops, flags, reflectors, scrims |
//! | `glassware` | bottles, glasses and jars with their drinks |
//! | `small` | a watch, a lipstick, fruit, textile |
//! | `material` | the materials of their parts |
//!
//! A new prop needs a variant of [`PropModel`] with its label and mesh here, its materials in `material`, its name in
//! `io/ron_v1/prop.rs` and an entry in `editor/document/prop_list.rs`.

mod furniture;
mod glassware;
mod material;
mod set;
mod small;
mod solid;

use super::{Material, Mesh};

/// A prop of a fixed form; the scale of its object changes its size.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum PropModel {
    /// Round stool of 55 cm.
    PosingStool,
    /// A full and a half apple box.
    AppleBoxes,
    /// Table of clear acrylic.
    AcrylicTable,
    /// Table of oiled wood.
    WoodTable,
    /// Table of black glass.
    BlackGlassTable,
    /// Corner of a cyclorama.
    CycloramaCorner,
    /// Hand-painted canvas.
    Canvas,
    /// Flag on a stand.
    Flag,
    /// Round reflector.
    Reflector,
    /// Frame with diffusion cloth.
    Scrim,
    /// Tent of diffusion cloth.
    DiffusingTent,
    /// Bottle of wine.
    WineBottle,
    /// Bottle of perfume.
    PerfumeBottle,
    /// Tumbler of water.
    DrinkingGlass,
    /// Tumbler without a drink.
    EmptyGlass,
    /// Glass of red wine.
    WineGlass,
    /// Jar of cream.
    CosmeticsJar,
    /// Wrist watch.
    Watch,
    /// Lipstick.
    Lipstick,
    /// Apple.
    Apple,
    /// Orange.
    Orange,
    /// Pear.
    Pear,
    /// Stack of folded cloths.
    FoldedTextile,
}

impl PropModel {
    /// All models, in list order.
    pub const ALL: [PropModel; 23] = [
        PropModel::PosingStool,
        PropModel::AppleBoxes,
        PropModel::AcrylicTable,
        PropModel::WoodTable,
        PropModel::BlackGlassTable,
        PropModel::CycloramaCorner,
        PropModel::Canvas,
        PropModel::Flag,
        PropModel::Reflector,
        PropModel::Scrim,
        PropModel::DiffusingTent,
        PropModel::WineBottle,
        PropModel::PerfumeBottle,
        PropModel::DrinkingGlass,
        PropModel::EmptyGlass,
        PropModel::WineGlass,
        PropModel::CosmeticsJar,
        PropModel::Watch,
        PropModel::Lipstick,
        PropModel::Apple,
        PropModel::Orange,
        PropModel::Pear,
        PropModel::FoldedTextile,
    ];

    /// Returns the label in lists.
    pub fn label(self) -> &'static str {
        match self {
            PropModel::PosingStool => "Posing stool",
            PropModel::AppleBoxes => "Apple boxes",
            PropModel::AcrylicTable => "Acrylic table",
            PropModel::WoodTable => "Wood table",
            PropModel::BlackGlassTable => "Black glass table",
            PropModel::CycloramaCorner => "Cyclorama corner",
            PropModel::Canvas => "Painted canvas",
            PropModel::Flag => "Flag on a stand",
            PropModel::Reflector => "Reflector",
            PropModel::Scrim => "Scrim",
            PropModel::DiffusingTent => "Diffusing tent",
            PropModel::WineBottle => "Wine bottle",
            PropModel::PerfumeBottle => "Perfume bottle",
            PropModel::DrinkingGlass => "Drinking glass",
            PropModel::EmptyGlass => "Empty glass",
            PropModel::WineGlass => "Wine glass",
            PropModel::CosmeticsJar => "Cosmetics jar",
            PropModel::Watch => "Watch",
            PropModel::Lipstick => "Lipstick",
            PropModel::Apple => "Apple",
            PropModel::Orange => "Orange",
            PropModel::Pear => "Pear",
            PropModel::FoldedTextile => "Folded textile",
        }
    }

    /// Returns true for backdrops, which stand behind a subject.
    pub fn is_backdrop(self) -> bool {
        matches!(self, PropModel::CycloramaCorner | PropModel::Canvas)
    }

    /// Returns the mesh, standing on the floor: the lowest point is at a height of 0.
    pub fn mesh(self) -> Mesh {
        match self {
            PropModel::PosingStool => furniture::posing_stool(),
            PropModel::AppleBoxes => furniture::apple_boxes(),
            PropModel::AcrylicTable => furniture::acrylic_table(),
            PropModel::WoodTable => furniture::wood_table(),
            PropModel::BlackGlassTable => furniture::black_glass_table(),
            PropModel::CycloramaCorner => set::cyclorama_corner(),
            PropModel::Canvas => set::canvas(),
            PropModel::Flag => set::flag(),
            PropModel::Reflector => set::reflector(),
            PropModel::Scrim => set::scrim(),
            PropModel::DiffusingTent => set::tent(),
            PropModel::WineBottle => glassware::wine_bottle(),
            PropModel::PerfumeBottle => glassware::perfume_bottle(),
            PropModel::DrinkingGlass => glassware::drinking_glass(),
            PropModel::EmptyGlass => glassware::empty_glass(),
            PropModel::WineGlass => glassware::wine_glass(),
            PropModel::CosmeticsJar => glassware::cosmetics_jar(),
            PropModel::Watch => small::watch(),
            PropModel::Lipstick => small::lipstick(),
            PropModel::Apple => small::apple(),
            PropModel::Orange => small::orange(),
            PropModel::Pear => small::pear(),
            PropModel::FoldedTextile => small::folded_textile(),
        }
    }

    /// Returns the materials of its parts: the first is that of the whole.
    pub fn materials(self) -> Vec<(&'static str, Material)> {
        material::of(self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn props_stand_on_the_floor_and_every_part_has_a_material() {
        for model in PropModel::ALL {
            let mesh = model.mesh();
            let (low, high) = mesh.bounds();
            assert!(low.y.abs() < 3e-3, "{model:?} starts at {} m", low.y);
            assert!(low.is_finite() && high.is_finite() && (high - low).max_element() < 8.0, "{model:?}");
            assert!(mesh.triangles.len() < 120_000, "{model:?} has {} triangles", mesh.triangles.len());
            assert_eq!(mesh.normals.len(), mesh.positions.len(), "{model:?}");
            assert!(mesh.normals.iter().all(|normal| (normal.length() - 1.0).abs() < 1e-3), "{model:?}");
            let parts: BTreeSet<&str> = mesh.part_names().collect();
            let materials: BTreeSet<&str> = model.materials().iter().map(|(part, _)| *part).collect();
            assert_eq!(parts, materials, "{model:?}");
        }
    }

    #[test]
    fn what_is_of_glass_is_closed_so_that_light_refracts_in_it() {
        for model in PropModel::ALL {
            let clear = model.materials().iter().any(|(_, material)| material.transmission > 0.0);
            let mesh = model.mesh();
            assert!(!clear || mesh.is_closed(), "{model:?} is open");
            // Solids enclose a positive volume: their front faces are outside
            let volume: f32 =
                (0..mesh.triangles.len()).map(|t| mesh.corners(t)).map(|[a, b, c]| a.dot(b.cross(c))).sum();
            assert!(!mesh.is_closed() || volume > 0.0, "{model:?} is inside out");
        }
    }
}
