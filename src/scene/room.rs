//! The studio's walls.

use super::{Material, MaterialPreset};
use glam::Vec3;

/// A box of floor, four walls and ceiling around the origin, floor at y = 0, seen from inside.
#[derive(Clone, Debug, PartialEq)]
pub struct Room {
    /// Width (X), height (Y), depth (Z), metres.
    pub size_m: Vec3,
    /// Floor surface.
    pub floor: Material,
    /// Wall surface.
    pub walls: Material,
    /// Ceiling surface.
    pub ceiling: Material,
}

impl Default for Room {
    fn default() -> Self {
        Room {
            size_m: Vec3::new(7.0, 3.2, 9.0),
            floor: MaterialPreset::StudioFloor.material(),
            walls: MaterialPreset::PaintedWall.material(),
            ceiling: MaterialPreset::PaintedWall.material(),
        }
    }
}

impl Room {
    /// The surface of a part of the room's mesh: `floor`, `walls` or `ceiling`.
    pub fn material_of(&self, part: &str) -> &Material {
        match part {
            "floor" => &self.floor,
            "ceiling" => &self.ceiling,
            _ => &self.walls,
        }
    }
}
