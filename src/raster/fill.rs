//! Triangles to pixels: exact integer edges, the top-left rule, and the nearest of all that cover a pixel's centre.
//!
//! The picture is cut into tiles that are filled in parallel. A tile first finds which triangle each of its pixels
//! shows, and then shades each pixel once.

use super::Drawing;
use super::batch::{self, Batch, NONE};
use super::row::{LANES, ROOM, Row, WIDTH};
use super::series::at_least;
use super::shade::{Scratch, Shader};
use super::triangle::{Screen, ScreenTriangle, centre, edge};
use crate::math::simd::{self, Avx2, SimdTask};
use glam::Vec3;
use rayon::prelude::*;
use std::ops::Range;

/// Size of a tile, pixels.
pub(super) const TILE_WIDTH: usize = WIDTH;
pub(super) const TILE_HEIGHT: usize = 16;
/// Longest side of a triangle whose pixels are asked one by one, pixels: its edges' products have 31 bits.
const SMALL: i32 = 48;

/// Columns and rows of tiles.
pub(super) fn tiles(screen: Screen) -> (usize, usize) {
    ((screen.width as usize).div_ceil(TILE_WIDTH), (screen.height as usize).div_ceil(TILE_HEIGHT))
}

/// Fills and shades the tiles, a row of tiles at a time.
pub(super) fn draw(screen: Screen, batches: &[Batch], shader: &Shader, drawing: &mut Drawing) {
    let row = screen.width as usize * TILE_HEIGHT;
    let pixels = drawing.picture.rgb.par_chunks_mut(row).zip(drawing.objects.par_chunks_mut(row));
    let pixels = pixels.zip(drawing.inverse_depths.par_chunks_mut(row));
    pixels.enumerate().for_each(|(row, ((rgb, objects), inverse_depths))| {
        simd::dispatch(TileRow { screen, row, batches, shader, rgb, objects, inverse_depths });
    });
}

/// A row of tiles, and their part of the picture.
struct TileRow<'a> {
    screen: Screen,
    row: usize,
    batches: &'a [Batch],
    shader: &'a Shader<'a>,
    rgb: &'a mut [[f32; 3]],
    objects: &'a mut [u32],
    inverse_depths: &'a mut [f32],
}

impl SimdTask for TileRow<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self, _: Option<Avx2>) {
        let TileRow { screen, row, batches, shader, .. } = self;
        let mut shown = Row::new(shader.nothing());
        let mut scratch = Scratch::new();
        let (columns, _) = tiles(screen);
        for column in 0..columns {
            let mut tile = Tile::new(screen, column, row);
            for batch in batches {
                for (number, triangle) in batch.of_tile(row * columns + column) {
                    tile.fill(triangle, number);
                }
            }
            for y in 0..tile.height {
                let first = y * screen.width as usize + tile.x;
                let pixels = first..first + tile.width;
                self.inverse_depths[pixels.clone()].copy_from_slice(&tile.nearness[y][..tile.width]);
                tile.show(y, batches, shader, &mut shown, &mut self.objects[pixels.clone()]);
                shader.shade(&shown, &mut scratch, &mut self.rgb[pixels]);
            }
        }
    }
}

/// A part of the picture.
struct Tile {
    x: usize,
    y: usize,
    width: usize,
    height: usize,
    /// 1/w, nearer is greater; 0 where there is nothing.
    nearness: [[f32; ROOM]; TILE_HEIGHT],
    shown: [[u32; ROOM]; TILE_HEIGHT],
}

impl Tile {
    #[inline(always)]
    fn new(screen: Screen, column: usize, row: usize) -> Self {
        let (x, y) = (column * TILE_WIDTH, row * TILE_HEIGHT);
        Tile {
            x,
            y,
            width: TILE_WIDTH.min(screen.width as usize - x),
            height: TILE_HEIGHT.min(screen.height as usize - y),
            nearness: [[0.0; ROOM]; TILE_HEIGHT],
            shown: [[NONE; ROOM]; TILE_HEIGHT],
        }
    }

    /// Columns and rows of the tile in which a triangle may cover pixels, if there are any.
    #[inline(always)]
    fn part_of(&self, triangle: &ScreenTriangle) -> Option<(Range<usize>, Range<usize>)> {
        let within = |pixels: Range<usize>, from: usize, count: usize| {
            pixels.start.max(from) - from..pixels.end.min(from + count).max(from) - from
        };
        let columns = within(triangle.pixels(0), self.x, self.width);
        let rows = within(triangle.pixels(1), self.y, self.height);
        (!columns.is_empty() && !rows.is_empty()).then_some((columns, rows))
    }

    /// Keeps the triangle where it is nearer than what is there.
    #[inline(always)]
    fn fill(&mut self, triangle: &ScreenTriangle, number: u32) {
        match self.part_of(triangle) {
            Some(part) if triangle.is_within(SMALL) => self.fill_small(triangle, part, number),
            Some(part) => self.fill_large(triangle, part, number),
            None => {}
        }
    }

    /// Asks eight pixels at a time whether they lie inside.
    #[inline(always)]
    fn fill_small(&mut self, triangle: &ScreenTriangle, (columns, rows): (Range<usize>, Range<usize>), number: u32) {
        let (x, y) = (self.x + columns.start, self.y + rows.start);
        let edges = Edge::all(triangle, x, y);
        let [mut first, right, down] = triangle.over_distance(x, y).map(Vec3::element_sum);
        let mut starts = edges.each_ref().map(|edge| edge.start as i32);
        let [a, b, c] = edges.each_ref().map(|edge| edge.per_pixel as i32);
        for y in rows {
            for from in columns.clone().step_by(LANES) {
                // Always so; the compiler knows it, too, and asks no more.
                let from = from.min(WIDTH);
                let passed = (from - columns.start) as i32;
                let nearest = &mut self.nearness[y][from..from + LANES];
                let shown = &mut self.shown[y][from..from + LANES];
                for lane in 0..LANES {
                    let i = passed + lane as i32;
                    let sides = (starts[0] + a * i) | (starts[1] + b * i) | (starts[2] + c * i);
                    let here = first + right * i as f32;
                    keep_nearest(if sides >= 0 { here } else { 0.0 }, number, &mut nearest[lane], &mut shown[lane]);
                }
            }
            starts.iter_mut().zip(&edges).for_each(|(start, edge)| *start += edge.per_row as i32);
            first += down;
        }
    }

    /// Finds the run of pixels inside in each row.
    #[inline(always)]
    fn fill_large(&mut self, triangle: &ScreenTriangle, (columns, rows): (Range<usize>, Range<usize>), number: u32) {
        let (x, y) = (self.x + columns.start, self.y + rows.start);
        let mut edges = Edge::all(triangle, x, y);
        let [first, right, down] = triangle.over_distance(x, y).map(Vec3::element_sum);
        for (row, y) in rows.enumerate() {
            let (mut low, mut high) = (0, columns.len() as i64);
            edges.iter().for_each(|edge| edge.narrow(&mut low, &mut high));
            if low < high {
                let run = columns.start + low as usize..columns.start + high as usize;
                let first = first + down * row as f32;
                let nearest = self.nearness[y][run.clone()].iter_mut();
                for ((nearest, shown), i) in nearest.zip(&mut self.shown[y][run]).zip(low as i32..) {
                    keep_nearest(first + right * i as f32, number, nearest, shown);
                }
            }
            edges.iter_mut().for_each(|edge| edge.start += edge.per_row);
        }
    }

    /// Collects what each pixel of a row shows, run by run.
    #[inline(always)]
    fn show(&self, y: usize, batches: &[Batch], shader: &Shader, row: &mut Row, objects: &mut [u32]) {
        let mut first = 0;
        for same in self.shown[y][..self.width].chunk_by(|a, b| a == b) {
            let pixels = first..first + same.len();
            first = pixels.end;
            objects[pixels.clone()].fill(match batch::find(batches, same[0]) {
                Some(triangle) => shader.show(row, &triangle.run(self.x, self.y + y, pixels), triangle),
                None => shader.show_nothing(row, pixels),
            });
        }
    }
}

/// The depth test of one pixel, without a jump, so that a loop can take eight. Triangles come in the order of their
/// numbers: the last that was nearer has the largest.
#[inline(always)]
fn keep_nearest(here: f32, number: u32, nearest: &mut f32, shown: &mut u32) {
    *shown = (*shown).max(if here > *nearest { number } else { NONE });
    *nearest = at_least(here, *nearest);
}

/// An edge function over the screen, with the top-left rule: a pixel centre on the edge counts where the edge is the
/// top or the left one, so that of two neighbours exactly one has it.
struct Edge {
    /// At the first pixel of a row.
    start: i64,
    per_pixel: i64,
    per_row: i64,
}

impl Edge {
    /// Those of a triangle, in rows that start at pixel (x, y).
    #[inline(always)]
    fn all(triangle: &ScreenTriangle, x: usize, y: usize) -> [Self; 3] {
        triangle.edges().map(|[from, to]| Edge::new(from, to, x, y))
    }

    #[inline(always)]
    fn new(from: [i32; 2], to: [i32; 2], x: usize, y: usize) -> Self {
        let (dx, dy) = (i64::from(to[0] - from[0]), i64::from(to[1] - from[1]));
        let top_or_left = dy < 0 || (dy == 0 && dx > 0);
        let bias = if top_or_left { 0 } else { -1 };
        let subpixels = i64::from(super::triangle::SUBPIXELS);
        Edge { start: edge(from, to, centre(x, y)) + bias, per_pixel: -dy * subpixels, per_row: dx * subpixels }
    }

    /// Narrows a run of pixels of a row to those inside.
    #[inline(always)]
    fn narrow(&self, low: &mut i64, high: &mut i64) {
        match self.per_pixel {
            0 if self.start < 0 => *high = *low,
            0 => {}
            // start + per_pixel x >= 0.
            rise if rise > 0 => *low = (*low).max((-self.start + rise - 1).div_euclid(rise)),
            fall => *high = (*high).min(self.start.div_euclid(-fall) + 1),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::raster::triangle::tests::{SCREEN, on_screen};

    /// What each pixel shows of triangles numbered from 1.
    fn shown(triangles: &[ScreenTriangle], fill: impl Fn(&mut Tile, &ScreenTriangle, u32)) -> Vec<u32> {
        let (columns, rows) = tiles(SCREEN);
        let mut shown = vec![NONE; (SCREEN.width * SCREEN.height) as usize];
        for index in 0..columns * rows {
            let mut tile = Tile::new(SCREEN, index % columns, index / columns);
            triangles.iter().zip(1..).for_each(|(triangle, number)| fill(&mut tile, triangle, number));
            for y in 0..tile.height {
                let first = (tile.y + y) * SCREEN.width as usize + tile.x;
                shown[first..first + tile.width].copy_from_slice(&tile.shown[y][..tile.width]);
            }
        }
        shown
    }

    #[test]
    fn neighbours_leave_no_crack_and_fill_no_pixel_twice() {
        // Fans about points on, beside and between pixel centres, over the whole screen.
        for centre in [(40.5, 30.5), (40.0, 30.0), (40.25, 30.73), (3.001, 58.999)] {
            let (w, h) = (SCREEN.width as f32, SCREEN.height as f32);
            let rim = [(0.0, 0.0), (33.3, 0.0), (w, 0.0), (w, 20.7), (w, h), (60.5, h), (0.0, h), (0.0, 17.5)];
            let fan: Vec<_> =
                (0..rim.len()).filter_map(|i| on_screen([centre, rim[i], rim[(i + 1) % rim.len()]], 1.0)).collect();
            let mut counts = vec![0; (SCREEN.width * SCREEN.height) as usize];
            for triangle in fan.chunks(1) {
                let shown = shown(triangle, |tile, triangle, number| tile.fill(triangle, number));
                counts.iter_mut().zip(shown).for_each(|(count, number)| *count += number);
            }
            assert!(counts.iter().all(|count| *count == 1), "about {centre:?}");
        }
    }

    #[test]
    fn a_pixel_is_inside_when_its_centre_is() {
        let corner = on_screen([(10.0, 10.0), (20.0, 10.0), (10.0, 20.0)], 1.0).unwrap();
        let counted: u32 = shown(&[corner], |tile, triangle, number| tile.fill(triangle, number)).iter().sum();
        // Centres with x + y < 10 of a ten by ten square; those on the long side belong to the neighbour.
        assert_eq!(counted, 45);
    }

    #[test]
    fn asking_pixels_and_dividing_for_runs_find_the_same_ones_and_the_nearest() {
        // Triangles of all directions, over each other, nearer and farther.
        let corner = |i: usize, k: usize| {
            let (angle, size) = ((i * 7 + k * 13) as f32 * 0.157, (i % 19 + 1) as f32);
            (48.0 + 0.3 * i as f32 * angle.cos() + size * (angle * 1.7).sin(), 30.0 + size * angle.cos())
        };
        let triangles: Vec<_> = (0..100)
            .filter_map(|i| on_screen([corner(i, 0), corner(i, 1), corner(i, 2)], 1.0 + (i * 37 % 100) as f32))
            .collect();
        let asked = |tile: &mut Tile, triangle: &ScreenTriangle, number| {
            if let Some(area) = tile.part_of(triangle) {
                tile.fill_small(triangle, area, number);
            }
        };
        let divided = |tile: &mut Tile, triangle: &ScreenTriangle, number| {
            if let Some(area) = tile.part_of(triangle) {
                tile.fill_large(triangle, area, number);
            }
        };
        let (asked, divided) = (shown(&triangles, asked), shown(&triangles, divided));
        let differ: Vec<_> =
            (0..asked.len()).filter(|&i| asked[i] != divided[i]).map(|i| (i, asked[i], divided[i])).collect();
        assert_eq!(differ, []);
        let covered = asked.iter().filter(|number| **number != NONE).count();
        assert!(covered > 300, "{covered}");
    }
}
