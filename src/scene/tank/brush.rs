//! Strokes of the brush in a water tank.

use super::{CellContent, Tank};
use glam::Vec3;

/// A stroke of the brush: the cells about a path, filled with one content at the start.
#[derive(Clone, Debug, PartialEq)]
pub struct BrushStroke {
    /// The content.
    pub content: CellContent,
    /// Distance from the path up to which cells are filled, metres.
    pub radius_m: f32,
    /// Points of the path, metres from the middle of the tank's underside.
    pub path_m: Vec<Vec3>,
}

impl BrushStroke {
    /// Largest radius, cells.
    pub const MAX_RADIUS_CELLS: f32 = 16.0;

    /// Returns the numbers that the cells depend on, as bits.
    pub(super) fn key(&self) -> impl Iterator<Item = u32> {
        let BrushStroke { content, radius_m, path_m } = self;
        let numbers = std::iter::once(*radius_m).chain(path_m.iter().flat_map(Vec3::to_array));
        [*content as u32, path_m.len() as u32].into_iter().chain(numbers.map(|number| (number + 0.0).to_bits()))
    }
}

impl Tank {
    /// Largest number of strokes.
    pub const MAX_STROKES: usize = 256;
    /// Largest number of points of all strokes.
    pub const MAX_STROKE_POINTS: usize = 4096;

    /// Returns the number of points of all strokes.
    pub fn stroke_points(&self) -> usize {
        self.strokes.iter().map(|stroke| stroke.path_m.len()).sum()
    }

    /// Returns true if another point, or a stroke of one, has room.
    pub fn has_room_for_strokes(&self) -> bool {
        self.strokes.len() < Self::MAX_STROKES && self.stroke_points() < Self::MAX_STROKE_POINTS
    }
}
