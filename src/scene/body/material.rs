//! The materials of gear. Their reflectances are typical; no maker states them.

use crate::scene::Material;

/// Black nylon: the outside of softboxes and umbrellas, grids.
pub(super) const BLACK_FABRIC: &str = "black fabric";
/// White cloth: fronts of softboxes, insides of umbrellas, scrims.
pub(super) const WHITE_FABRIC: &str = "white fabric";
/// Black painted metal: heads, barn doors, snoots.
pub(super) const BLACK_METAL: &str = "black metal";
/// White paint: the inside of beauty dishes.
pub(super) const WHITE_PAINT: &str = "white paint";
/// Satin aluminium: the inside of reflectors, frames.
pub(super) const ALUMINIUM: &str = "aluminium";
/// Chromed steel: stands and shafts. It is rougher than a mirror, so that it casts no caustics.
pub(super) const STEEL: &str = "steel";

/// Returns the material of a part of a body.
pub fn body_material(part: &str) -> Material {
    let paint =
        |reflectance: f32, roughness| Material { base_color: [reflectance; 3], roughness, ..Material::default() };
    let metal = |reflectance: f32, roughness| Material { metallic: 1.0, ..paint(reflectance, roughness) };
    match part {
        BLACK_FABRIC => paint(0.025, 0.85),
        WHITE_FABRIC => paint(0.75, 0.9),
        WHITE_PAINT => paint(0.75, 0.5),
        ALUMINIUM => metal(0.75, 0.35),
        STEEL => metal(0.55, 0.25),
        _ => paint(0.035, 0.45),
    }
}
