//! Tile binning: the screen triangles of a batch, sorted by the tiles that their bounding boxes touch. Batches are
//! binned independently and in parallel.

use super::triangle::ScreenTriangle;
use super::viewport::{TILE_HEIGHT, TILE_WIDTH, Viewport};
use std::ops::Range;

/// Largest number of mesh triangles in a batch.
pub(super) const BATCH_TRIANGLES: usize = 4096;
/// Bits of a key for the triangle in its batch: clipped at six planes, one can become seven.
const TRIANGLE_BITS: u32 = 15;
const TRIANGLE_MASK: u32 = (1 << TRIANGLE_BITS) - 1;

/// The key of no triangle.
pub(super) const NO_TRIANGLE: u32 = 0;

/// The binned triangles of a batch. Its memory is reused from frame to frame.
#[derive(Debug, Default)]
pub(super) struct TriangleBatch {
    triangles: Vec<ScreenTriangle>,
    /// Keys of the triangles of the first tile, of the second, and so on; in scene order within a tile.
    keys: Vec<u32>,
    /// End of each tile's keys.
    tile_ends: Vec<u32>,
}

/// Returns a triangle by its key. Keys ascend in scene order.
#[inline(always)]
pub(super) fn triangle_of_key(batches: &[TriangleBatch], key: u32) -> Option<&ScreenTriangle> {
    let index = (key & TRIANGLE_MASK).checked_sub(1)?;
    batches.get((key >> TRIANGLE_BITS) as usize)?.triangles.get(index as usize)
}

impl TriangleBatch {
    /// Replaces the triangles by those that `set_up` appends, and bins them.
    pub fn fill(&mut self, batch: usize, viewport: Viewport, set_up: impl FnOnce(&mut Vec<ScreenTriangle>)) {
        self.triangles.clear();
        set_up(&mut self.triangles);
        self.bin(viewport, ((batch as u32) << TRIANGLE_BITS) + 1);
    }

    /// Bins the triangles by a counting sort.
    fn bin(&mut self, viewport: Viewport, first_key: u32) {
        let TriangleBatch { triangles, keys, tile_ends } = self;
        let (columns, rows) = viewport.tile_counts();
        let touched_tiles = |triangle: &ScreenTriangle| {
            let tiles = |pixels: Range<usize>, size: usize| pixels.start / size..(pixels.end - 1) / size + 1;
            let tile_columns = tiles(triangle.pixel_bounds(0), TILE_WIDTH);
            let tile_rows = tiles(triangle.pixel_bounds(1), TILE_HEIGHT);
            tile_rows.flat_map(move |row| tile_columns.clone().map(move |column| row * columns + column))
        };
        // Count the triangles of each tile
        tile_ends.clear();
        tile_ends.resize(columns * rows, 0);
        triangles.iter().flat_map(touched_tiles).for_each(|tile| tile_ends[tile] += 1);
        // Turn counts into the start of each tile's keys
        let mut sum = 0;
        for start in tile_ends.iter_mut() {
            (sum, *start) = (sum + *start, sum);
        }
        // Write the keys; each start moves to its tile's end
        keys.clear();
        keys.resize(sum as usize, NO_TRIANGLE);
        for (key, triangle) in (first_key..).zip(triangles.iter()) {
            for tile in touched_tiles(triangle) {
                keys[tile_ends[tile] as usize] = key;
                tile_ends[tile] += 1;
            }
        }
    }

    /// Returns the keys and triangles of a tile, in scene order.
    #[inline(always)]
    pub fn triangles_in_tile(&self, tile: usize) -> impl Iterator<Item = (u32, &ScreenTriangle)> {
        let first = if tile == 0 { 0 } else { self.tile_ends[tile - 1] };
        let keys = &self.keys[first as usize..self.tile_ends[tile] as usize];
        keys.iter().map(|&key| (key, &self.triangles[(key & TRIANGLE_MASK) as usize - 1]))
    }
}
