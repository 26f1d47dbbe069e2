//! The room of the studio.

use super::{Material, MaterialPreset};
use glam::Vec3;

/// A room: floor at y = 0, four walls and a ceiling around the origin, seen from inside.
#[derive(Clone, Debug, PartialEq)]
pub struct Room {
    /// Width (X), height (Y), depth (Z), metres.
    pub size_m: Vec3,
    /// Floor material.
    pub floor: Material,
    /// Wall material.
    pub walls: Material,
    /// Ceiling material.
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
    /// Returns the lower and the upper corner in world space, metres.
    pub fn bounds(&self) -> [Vec3; 2] {
        let half = 0.5 * self.size_m.with_y(0.0);
        [-half, half.with_y(self.size_m.y)]
    }

    /// Returns the material of a part of the room's mesh: `floor`, `walls` or `ceiling`.
    pub fn material_of(&self, part: &str) -> &Material {
        match part {
            "floor" => &self.floor,
            "ceiling" => &self.ceiling,
            _ => &self.walls,
        }
    }
}
