//! The field of water that nothing carries: streams, falls and what runs down steep ground.
//!
//! It falls cell by cell in portions. The field is their mean over the neighbours, by binomial weights, of the space that
//! the ground leaves: portions join to streams that cling to the ground.

use crate::water::blur::blur;
use crate::water::grid::{FULL, Grid};

/// Part of the space from which on falling water is drawn: thinner is spray.
const THINNEST: f32 = 0.1;
/// Slope of the field where the part of the space changes: the field is in cells.
const SLOPE: f32 = 5.0;
/// Cells count as full from this level on, in units.
const ALMOST_FULL: u16 = FULL - FULL / 1000;

/// Returns true for a cell whose water falls.
pub(super) fn falls(grid: &Grid, cell: usize) -> bool {
    let is_lowest = cell.is_multiple_of(grid.size()[1]);
    grid.water(cell) > 0 && !is_lowest && grid.level(cell - 1) < ALMOST_FULL
}

/// Returns the field of falling water in all cells, positive inside; none if there is none.
pub(super) fn field(grid: &Grid) -> Option<Vec<f32>> {
    let [nx, ny, nz] = grid.size();
    let count = nx * ny * nz;
    if !(0..count).any(|cell| falls(grid, cell)) {
        return None;
    }
    let falling = |cell| if falls(grid, cell) { f32::from(grid.water(cell)) / f32::from(FULL) } else { 0.0 };
    let mut water: Vec<f32> = (0..count).map(falling).collect();
    let mut space: Vec<f32> = (0..count).map(|cell| 1.0 - f32::from(grid.ground(cell)) / f32::from(FULL)).collect();
    for values in [&mut water, &mut space] {
        blur(values, 1, ny);
        blur(values, ny, nx);
        blur(values, ny * nx, nz);
    }
    let signed = |(water, space): (&f32, &f32)| ((water / space.max(0.2) - THINNEST) * SLOPE).clamp(-1.0, 1.0);
    Some(water.iter().zip(&space).map(signed).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stream_in_portions_is_one_stream() {
        let mut grid = Grid::new([7, 20, 7]);
        // Every other cell of a column, down to a floor
        for y in (1..20).step_by(2) {
            let cell = grid.index([3, y, 3]);
            grid.add_water(cell, u64::from(FULL));
        }
        let field = field(&grid).unwrap();
        let at = |x, y| field[grid.index([x, y, 3])];
        assert!((2..18).all(|y| at(3, y) > 0.0), "without a gap");
        assert!((2..18).all(|y| at(1, y) < 0.0), "and no wider than three cells");
        assert!(super::field(&Grid::new([3, 3, 3])).is_none());
    }
}
