//! Triangles that follow one another in a mesh: set up for the screen and sorted by the tiles that they may touch, each
//! batch by itself, so that batches go side by side.

use super::fill::{self, TILE_HEIGHT, TILE_WIDTH};
use super::triangle::{Screen, ScreenTriangle};
use std::ops::Range;

/// Triangles of a mesh in a batch, at most.
pub(super) const TRIANGLES: usize = 4096;
/// Bits of a number that tell the triangle in the batch: cut at six planes, one can become seven.
const BITS: u32 = 15;

/// No triangle.
pub(super) const NONE: u32 = 0;

/// Triangles on the screen. Keeps its memory from one picture to the next.
#[derive(Debug, Default)]
pub(super) struct Batch {
    triangles: Vec<ScreenTriangle>,
    /// Their numbers, those of the first tile first. A tile has its triangles in their order, whatever the threads did.
    sorted: Vec<u32>,
    /// Where the numbers of each tile end.
    ends: Vec<u32>,
}

/// A triangle by its number: greater than those of all before it.
#[inline(always)]
pub(super) fn find(batches: &[Batch], number: u32) -> Option<&ScreenTriangle> {
    let index = (number & ((1 << BITS) - 1)).checked_sub(1)?;
    batches.get((number >> BITS) as usize)?.triangles.get(index as usize)
}

impl Batch {
    /// Takes what `set_up` puts on the screen, in place of what there was.
    pub fn fill(&mut self, batch: usize, screen: Screen, set_up: impl FnOnce(&mut Vec<ScreenTriangle>)) {
        self.triangles.clear();
        set_up(&mut self.triangles);
        self.sort(screen, ((batch as u32) << BITS) + 1);
    }

    /// Counts each tile's triangles, then puts every number in its place.
    fn sort(&mut self, screen: Screen, first: u32) {
        let Batch { triangles, sorted, ends } = self;
        let (columns, rows) = fill::tiles(screen);
        ends.clear();
        ends.resize(columns * rows, 0);
        let touched = |triangle: &ScreenTriangle| {
            let tiles = |pixels: Range<usize>, size: usize| pixels.start / size..(pixels.end - 1) / size + 1;
            let across = tiles(triangle.pixels(0), TILE_WIDTH);
            let down = tiles(triangle.pixels(1), TILE_HEIGHT);
            down.flat_map(move |row| across.clone().map(move |column| row * columns + column))
        };
        triangles.iter().flat_map(touched).for_each(|tile| ends[tile] += 1);
        let mut sum = 0;
        for end in ends.iter_mut() {
            // For now, where they begin.
            (sum, *end) = (sum + *end, sum);
        }
        sorted.clear();
        sorted.resize(sum as usize, NONE);
        for (number, triangle) in (first..).zip(triangles.iter()) {
            for tile in touched(triangle) {
                sorted[ends[tile] as usize] = number;
                ends[tile] += 1;
            }
        }
    }

    /// Numbers of a tile's triangles, and they themselves.
    #[inline(always)]
    pub fn of_tile(&self, tile: usize) -> impl Iterator<Item = (u32, &ScreenTriangle)> {
        let first = if tile == 0 { 0 } else { self.ends[tile - 1] };
        let numbers = &self.sorted[first as usize..self.ends[tile] as usize];
        numbers.iter().map(|&number| (number, &self.triangles[(number & ((1 << BITS) - 1)) as usize - 1]))
    }
}
