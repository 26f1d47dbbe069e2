//! The fields whose surfaces are those of ground, metal and water.
//!
//! A sample is a signed height: in a column that is filled up to some height, linear interpolation between the samples
//! of two cells gives exactly that height, so that water at rest is a plane to the last bit of its level.

use super::FILM;
use super::falling;
use super::nets::Field;
use crate::scene::Mesh;
use crate::water::grid::{FULL, Grid};

/// Cells that water reaches into the ground beside it.
const REACH: usize = 2;
/// Cells count as full from this part on.
const ALMOST_FULL: f32 = 1.0 - 1e-3;
/// How much further metal reaches than ground that it touches, and water less far at the sides of the tank, as a part of
/// a cell: surfaces do not lie in one place.
const INSET: f32 = 0.03;

/// Returns the surfaces of ground, metal and water, in cells from the lowest corner.
pub(super) fn surfaces(grid: &Grid) -> [Mesh; 3] {
    let size = grid.size();
    let part = |cell: usize| f32::from(grid.ground(cell)) / f32::from(FULL);
    let ground: Vec<f32> = (0..size.iter().product()).map(part).collect();
    let metal = |cell: usize| f32::from(u8::from(grid.is_metal(cell)));
    let metal: Vec<f32> = (0..ground.len()).map(metal).collect();
    [
        surface(size, &ground, Content { falling: None, bias: 0.0, side: 1.0 }),
        surface(size, &metal, Content { falling: None, bias: INSET, side: 1.0 }),
        surface(
            size,
            &water_levels(grid),
            Content { falling: falling::field(grid), bias: 0.0, side: 1.0 + 4.0 * INSET },
        ),
    ]
}

/// How the field of a content follows from its parts of the cells.
struct Content {
    /// The field of what falls, in all cells.
    falling: Option<Vec<f32>>,
    /// Added to all samples.
    bias: f32,
    /// Factor of the samples beyond the sides: 1 puts the surface into the sides of the tank, more into their inside.
    side: f32,
}

/// Returns the surface of a content, of which the parts of the cells are filled from below.
fn surface(size: [usize; 3], parts: &[f32], content: Content) -> Mesh {
    if content.falling.is_none() && parts.iter().all(|part| *part <= 0.0) {
        return Mesh::default();
    }
    let [nx, ny, nz] = size;
    // One sample more on each side
    let field = Field::new([nx + 2, ny + 2, nz + 2], |x, z, samples| {
        let nearest = |at: usize, count: usize| at.clamp(1, count) - 1;
        let is_beyond = x != nearest(x, nx) + 1 || z != nearest(z, nz) + 1;
        let bottom = (nearest(z, nz) * nx + nearest(x, nx)) * ny;
        for (y, sample) in samples.iter_mut().enumerate().skip(1) {
            *sample = signed_height(&parts[bottom..][..ny], y - 1) + content.bias;
        }
        if let Some(falling) = &content.falling {
            let fields = samples[1..=ny].iter_mut().zip(&falling[bottom..]);
            fields.for_each(|(sample, falling)| *sample = sample.max(*falling));
        }
        samples[0] = -samples[1].abs() * content.side;
        if is_beyond {
            samples.iter_mut().for_each(|sample| *sample = -sample.abs() * content.side);
        }
    });
    field.surface(-0.5)
}

/// Returns the signed height of a cell's middle below the surface in its column, in cells, clamped to 1.
fn signed_height(column: &[f32], y: usize) -> f32 {
    let part = |y: usize| column.get(y).copied().unwrap_or(0.0);
    let is_full = |y: usize| part(y) >= ALMOST_FULL;
    let own = part(y);
    if is_full(y) {
        0.5 + part(y + 1).min(0.5)
    } else if own > 0.0 {
        own - 0.5
    } else {
        let below = if y > 0 { part(y - 1) } else { 0.0 };
        (below - 1.5).max(-1.0)
    }
}

/// Returns the levels of the water in all cells, with ground that it covers or reaches into as water.
fn water_levels(grid: &Grid) -> Vec<f32> {
    let [nx, ny, nz] = grid.size();
    let full = f32::from(FULL);
    let mut levels = vec![0.0; nx * ny * nz];
    // Cells with water that something carries, and the full cells below them
    for cell in (0..levels.len()).filter(|&cell| !falling::falls(grid, cell)) {
        let water = f32::from(grid.water(cell)) / full;
        let is_on_water = cell % ny > 0 && grid.water(cell - 1) > 0 && grid.level(cell - 1) == FULL;
        if water >= FILM || (water > 0.0 && is_on_water) {
            levels[cell] = f32::from(grid.level(cell)) / full;
            if cell % ny > 0 && grid.level(cell - 1) == FULL {
                levels[cell - 1] = 1.0;
            }
        }
    }
    // The ground beside it, as far as the water reaches, somewhat lower than the ground where both would be level
    let is_wet: Vec<bool> = (0..levels.len()).map(|cell| levels[cell] > 0.0 && grid.water(cell) > 0).collect();
    let mut edge: Vec<usize> = (0..levels.len()).filter(|&cell| is_wet[cell]).collect();
    for _ in 0..REACH {
        let reaches = |&cell: &usize| {
            let level = levels[cell].min(1.0 - INSET);
            let takes = |other: &usize| {
                let ground = f32::from(grid.ground(*other)) / full;
                !is_wet[*other] && ground > 0.0 && ground >= level && levels[*other] < level
            };
            beside(cell, grid.size())
                .into_iter()
                .flatten()
                .filter(takes)
                .map(move |other| (other, level))
                .collect::<Vec<_>>()
        };
        let reached: Vec<(usize, f32)> = edge.iter().flat_map(reaches).collect();
        for &(cell, level) in &reached {
            levels[cell] = level.max(levels[cell]);
            if cell % ny > 0 && grid.ground(cell - 1) == FULL {
                levels[cell - 1] = 1.0;
            }
        }
        edge = reached.into_iter().map(|(cell, _)| cell).collect();
    }
    levels
}

/// Returns the four cells beside a cell in its layer.
fn beside(cell: usize, [nx, ny, nz]: [usize; 3]) -> [Option<usize>; 4] {
    let column = cell / ny;
    let (x, z) = (column % nx, column / nx);
    [
        (x > 0).then(|| cell - ny),
        (x + 1 < nx).then(|| cell + ny),
        (z > 0).then(|| cell - nx * ny),
        (z + 1 < nz).then(|| cell + nx * ny),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_column_has_exactly_the_height_to_which_it_is_filled() {
        for height in [0.05_f32, 0.4, 0.5, 0.6, 0.95, 1.0, 1.02, 1.5, 2.7, 3.0] {
            let column: Vec<f32> = (0..5).map(|y| (height - y as f32).clamp(0.0, 1.0)).collect();
            let samples: Vec<f32> = (0..5).map(|y| signed_height(&column, y)).collect();
            let below = samples.iter().rposition(|sample| *sample > 0.0);
            // Below the middle of the lowest cell the sample beneath the tank counts
            let found = match below {
                Some(y) => y as f32 + 0.5 + samples[y] / (samples[y] - samples[y + 1]),
                None => 0.5 + samples[0],
            };
            assert!((found - height).abs() < 2e-3, "{found} for {height}: {samples:?}");
        }
    }
}
