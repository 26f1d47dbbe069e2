//! The raster and fragment stages of a tile: coverage by edge functions, the depth test, the G-buffer and shading.
//!
//! Tiles are drawn in parallel. A tile first finds the visible triangle of each pixel, and then shades each pixel once.
//! Where the framebuffer holds an earlier chunk, pixels of the tile that nothing nearer covers stay as they are.

use super::binning::{NO_TRIANGLE, TriangleBatch, triangle_of_key};
use super::framebuffer::Framebuffer;
use super::gbuffer_row::{GBufferRow, LANES, PADDED_WIDTH, WIDTH};
use super::shade::{FragmentShader, ShadingScratch};
use super::triangle::ScreenTriangle;
use super::viewport::{TILE_HEIGHT, TILE_WIDTH, Viewport};
use crate::math::approx::max;
use crate::math::simd::{self, Avx2, SimdTask};
use glam::Vec3;
use rayon::prelude::*;
use std::ops::Range;

/// Longest side of the bounding box of a triangle whose pixels are tested one by one, pixels: products of its edges
/// have 31 bits.
const SMALL_TRIANGLE: i32 = 48;

/// Draws all tiles, a row of tiles per parallel task.
pub(super) fn draw(viewport: Viewport, batches: &[TriangleBatch], shader: &FragmentShader, target: &mut Framebuffer) {
    let pixels = viewport.width as usize * TILE_HEIGHT;
    let rows = target.picture.rgb.par_chunks_mut(pixels).zip(target.objects.par_chunks_mut(pixels));
    let rows = rows.zip(target.inverse_depths.par_chunks_mut(pixels));
    rows.enumerate().for_each(|(row, ((rgb, objects), inverse_depths))| {
        simd::dispatch(TileRowTask { viewport, row, batches, shader, rgb, objects, inverse_depths });
    });
}

/// The drawing of a row of tiles into its part of the framebuffer.
struct TileRowTask<'a> {
    viewport: Viewport,
    row: usize,
    batches: &'a [TriangleBatch],
    shader: &'a FragmentShader<'a>,
    rgb: &'a mut [[f32; 3]],
    objects: &'a mut [u32],
    inverse_depths: &'a mut [f32],
}

impl SimdTask for TileRowTask<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self, _: Option<Avx2>) {
        let TileRowTask { viewport, row, batches, shader, .. } = self;
        let mut gbuffer = GBufferRow::new(shader.background());
        let mut scratch = ShadingScratch::new();
        let mut shaded = [[0.0; 3]; WIDTH];
        let (columns, _) = viewport.tile_counts();
        for column in 0..columns {
            // Rasterize the binned triangles with a depth test
            let mut tile = Tile::new(viewport, column, row);
            tile.load_depths(viewport, self.inverse_depths);
            for batch in batches {
                for (key, triangle) in batch.triangles_in_tile(row * columns + column) {
                    match shader.has_holes().then(|| shader.hole_test(triangle.id)).flatten() {
                        Some(is_there) => tile.rasterize_with_holes(triangle, key, is_there),
                        None => tile.rasterize(triangle, key),
                    }
                }
            }
            for y in (0..tile.height).filter(|y| tile.is_covered(*y)) {
                let pixels = tile.pixels(viewport, y);
                self.inverse_depths[pixels.clone()].copy_from_slice(&tile.inverse_w[y][..tile.width]);
                // Fill the G-buffer row from the visible triangles
                tile.write_gbuffer(y, batches, shader, &mut gbuffer, &mut self.objects[pixels.clone()]);
                // Shade the row
                let shaded = &mut shaded[..tile.width];
                shader.shade(&gbuffer, &mut scratch, shaded);
                for ((rgb, shaded), key) in self.rgb[pixels].iter_mut().zip(shaded).zip(&tile.visible[y]) {
                    *rgb = if *key == NO_TRIANGLE { *rgb } else { *shaded };
                }
            }
        }
    }
}

/// The depth buffer and visibility buffer of a tile.
struct Tile {
    x: usize,
    y: usize,
    width: usize,
    height: usize,
    /// 1/w, larger is nearer; 0 where there is nothing.
    inverse_w: [[f32; PADDED_WIDTH]; TILE_HEIGHT],
    /// Key of the visible triangle.
    visible: [[u32; PADDED_WIDTH]; TILE_HEIGHT],
}

impl Tile {
    #[inline(always)]
    fn new(viewport: Viewport, column: usize, row: usize) -> Self {
        let (x, y) = (column * TILE_WIDTH, row * TILE_HEIGHT);
        Tile {
            x,
            y,
            width: TILE_WIDTH.min(viewport.width as usize - x),
            height: TILE_HEIGHT.min(viewport.height as usize - y),
            inverse_w: [[0.0; PADDED_WIDTH]; TILE_HEIGHT],
            visible: [[NO_TRIANGLE; PADDED_WIDTH]; TILE_HEIGHT],
        }
    }

    /// Returns the place of a row of the tile in a row of tiles of the framebuffer.
    #[inline(always)]
    fn pixels(&self, viewport: Viewport, y: usize) -> Range<usize> {
        let first = y * viewport.width as usize + self.x;
        first..first + self.width
    }

    /// Takes the depths of what is drawn already, in a row of tiles of the framebuffer.
    #[inline(always)]
    fn load_depths(&mut self, viewport: Viewport, inverse_depths: &[f32]) {
        for y in 0..self.height {
            let drawn = &inverse_depths[self.pixels(viewport, y)];
            self.inverse_w[y][..self.width].copy_from_slice(drawn);
        }
    }

    /// Returns true if a triangle is visible in a row.
    #[inline(always)]
    fn is_covered(&self, y: usize) -> bool {
        self.visible[y][..self.width].iter().any(|key| *key != NO_TRIANGLE)
    }

    /// Returns the columns and rows of the tile that a triangle's bounding box overlaps; none where it does not.
    #[inline(always)]
    fn overlap(&self, triangle: &ScreenTriangle) -> Option<(Range<usize>, Range<usize>)> {
        let within = |pixels: Range<usize>, from: usize, count: usize| {
            pixels.start.max(from) - from..pixels.end.min(from + count).max(from) - from
        };
        let columns = within(triangle.pixel_bounds(0), self.x, self.width);
        let rows = within(triangle.pixel_bounds(1), self.y, self.height);
        (!columns.is_empty() && !rows.is_empty()).then_some((columns, rows))
    }

    /// Rasterizes a triangle with a depth test.
    #[inline(always)]
    fn rasterize(&mut self, triangle: &ScreenTriangle, key: u32) {
        match self.overlap(triangle) {
            Some(area) if triangle.fits_within(SMALL_TRIANGLE) => self.rasterize_pixels(triangle, area, key),
            Some(area) => self.rasterize_scanlines(triangle, area, key),
            None => {}
        }
    }

    /// Rasterizes a triangle with a depth test at those pixels that pass another test: of their barycentric coordinates
    /// over w and their place on the screen.
    fn rasterize_with_holes(
        &mut self,
        triangle: &ScreenTriangle,
        key: u32,
        is_there: impl Fn(Vec3, (usize, usize)) -> bool,
    ) {
        let Some((columns, rows)) = self.overlap(triangle) else { return };
        let mut edges = triangle.edge_functions(self.x + columns.start, self.y + rows.start);
        let [inverse_w, step_right, step_down] =
            triangle.barycentric_over_w(self.x + columns.start, self.y + rows.start).map(Vec3::element_sum);
        for (row, y) in rows.enumerate() {
            let (mut low, mut high) = (0, columns.len() as i64);
            edges.iter().for_each(|edge| edge.narrow(&mut low, &mut high));
            edges.iter_mut().for_each(|edge| edge.start += edge.per_row);
            if low >= high {
                continue;
            }
            let pixels = columns.start + low as usize..columns.start + high as usize;
            let span = triangle.span(self.x, self.y + y, pixels.clone());
            for i in pixels.clone() {
                let over_w = span.start + span.step * (i - pixels.start) as f32;
                if is_there(over_w, (self.x + i, self.y + y)) {
                    let here = inverse_w + step_down * row as f32 + step_right * (i - columns.start) as f32;
                    depth_test(here, key, &mut self.inverse_w[y][i], &mut self.visible[y][i]);
                }
            }
        }
    }

    /// Evaluates the edge functions of a small triangle at every pixel, eight at a time, in 32-bit integers.
    #[inline(always)]
    fn rasterize_pixels(&mut self, triangle: &ScreenTriangle, (columns, rows): (Range<usize>, Range<usize>), key: u32) {
        // Edge functions and 1/w at the first pixel, and their steps
        let (x, y) = (self.x + columns.start, self.y + rows.start);
        let edges = triangle.edge_functions(x, y);
        let [mut inverse_w, step_right, step_down] = triangle.barycentric_over_w(x, y).map(Vec3::element_sum);
        let mut starts = edges.each_ref().map(|edge| edge.start as i32);
        let [a, b, c] = edges.each_ref().map(|edge| edge.per_pixel as i32);
        for y in rows {
            for from in columns.clone().step_by(LANES) {
                // Always true; it lets the compiler drop the bounds checks.
                let from = from.min(WIDTH);
                let offset = (from - columns.start) as i32;
                let nearest = &mut self.inverse_w[y][from..from + LANES];
                let visible = &mut self.visible[y][from..from + LANES];
                for lane in 0..LANES {
                    let i = offset + lane as i32;
                    // The sign bit is set where a pixel is outside of any edge
                    let sides = (starts[0] + a * i) | (starts[1] + b * i) | (starts[2] + c * i);
                    let here = inverse_w + step_right * i as f32;
                    depth_test(if sides >= 0 { here } else { 0.0 }, key, &mut nearest[lane], &mut visible[lane]);
                }
            }
            starts.iter_mut().zip(&edges).for_each(|(start, edge)| *start += edge.per_row as i32);
            inverse_w += step_down;
        }
    }

    /// Computes the span of pixels of each scanline between the edges of a large triangle.
    #[inline(always)]
    fn rasterize_scanlines(
        &mut self,
        triangle: &ScreenTriangle,
        (columns, rows): (Range<usize>, Range<usize>),
        key: u32,
    ) {
        let (x, y) = (self.x + columns.start, self.y + rows.start);
        let mut edges = triangle.edge_functions(x, y);
        let [inverse_w, step_right, step_down] = triangle.barycentric_over_w(x, y).map(Vec3::element_sum);
        for (row, y) in rows.enumerate() {
            let (mut low, mut high) = (0, columns.len() as i64);
            edges.iter().for_each(|edge| edge.narrow(&mut low, &mut high));
            if low < high {
                let span = columns.start + low as usize..columns.start + high as usize;
                let row_start = inverse_w + step_down * row as f32;
                let nearest = self.inverse_w[y][span.clone()].iter_mut();
                for ((nearest, visible), i) in nearest.zip(&mut self.visible[y][span]).zip(low as i32..) {
                    depth_test(row_start + step_right * i as f32, key, nearest, visible);
                }
            }
            edges.iter_mut().for_each(|edge| edge.start += edge.per_row);
        }
    }

    /// Writes the G-buffer row and the object indices of a row, span by span.
    #[inline(always)]
    fn write_gbuffer(
        &self,
        y: usize,
        batches: &[TriangleBatch],
        shader: &FragmentShader,
        row: &mut GBufferRow,
        objects: &mut [u32],
    ) {
        let mut first = 0;
        for same in self.visible[y][..self.width].chunk_by(|a, b| a == b) {
            let pixels = first..first + same.len();
            first = pixels.end;
            match triangle_of_key(batches, same[0]) {
                Some(triangle) => {
                    let span = triangle.span(self.x, self.y + y, pixels.clone());
                    objects[pixels].fill(shader.write_span(row, &span, triangle.id));
                }
                None => shader.write_background(row, pixels),
            }
        }
    }
}

/// Tests the depth of one pixel without a branch, so that a loop vectorizes. Keys ascend: the last triangle that was
/// nearer has the largest.
#[inline(always)]
fn depth_test(inverse_w: f32, key: u32, nearest: &mut f32, visible: &mut u32) {
    *visible = (*visible).max(if inverse_w > *nearest { key } else { NO_TRIANGLE });
    *nearest = max(inverse_w, *nearest);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::raster::triangle::TEST_VIEWPORT as VIEWPORT;

    /// Returns the key of the visible triangle of each pixel, of triangles with keys from 1.
    fn visible(triangles: &[ScreenTriangle], rasterize: impl Fn(&mut Tile, &ScreenTriangle, u32)) -> Vec<u32> {
        let (columns, rows) = VIEWPORT.tile_counts();
        let mut visible = vec![NO_TRIANGLE; (VIEWPORT.width * VIEWPORT.height) as usize];
        for index in 0..columns * rows {
            let mut tile = Tile::new(VIEWPORT, index % columns, index / columns);
            triangles.iter().zip(1..).for_each(|(triangle, key)| rasterize(&mut tile, triangle, key));
            for y in 0..tile.height {
                let first = (tile.y + y) * VIEWPORT.width as usize + tile.x;
                visible[first..first + tile.width].copy_from_slice(&tile.visible[y][..tile.width]);
            }
        }
        visible
    }

    #[test]
    fn adjacent_triangles_cover_every_pixel_exactly_once() {
        // Fans around points on, beside and between pixel centres, over the whole screen.
        for centre in [(40.5, 30.5), (40.0, 30.0), (40.25, 30.73), (3.001, 58.999)] {
            let (w, h) = (VIEWPORT.width as f32, VIEWPORT.height as f32);
            let rim = [(0.0, 0.0), (33.3, 0.0), (w, 0.0), (w, 20.7), (w, h), (60.5, h), (0.0, h), (0.0, 17.5)];
            let fan: Vec<_> = (0..rim.len())
                .filter_map(|i| ScreenTriangle::at_depth([centre, rim[i], rim[(i + 1) % rim.len()]], 1.0))
                .collect();
            let mut counts = vec![0; (VIEWPORT.width * VIEWPORT.height) as usize];
            for triangle in fan.chunks(1) {
                let covered = visible(triangle, |tile, triangle, key| tile.rasterize(triangle, key));
                counts.iter_mut().zip(covered).for_each(|(count, key)| *count += key);
            }
            assert!(counts.iter().all(|count| *count == 1), "around {centre:?}");
        }
    }

    #[test]
    fn a_pixel_is_covered_when_its_centre_is_inside() {
        let triangle = ScreenTriangle::at_depth([(10.0, 10.0), (20.0, 10.0), (10.0, 20.0)], 1.0).unwrap();
        let covered: u32 = visible(&[triangle], |tile, triangle, key| tile.rasterize(triangle, key)).iter().sum();
        // Centres with x + y < 10 of a ten by ten square; those on the hypotenuse belong to the neighbour.
        assert_eq!(covered, 45);
    }

    #[test]
    fn pixel_tests_and_scanline_spans_give_the_same_visibility() {
        // Triangles of all orientations, overlapping, at several depths.
        let vertex = |i: usize, k: usize| {
            let (angle, size) = ((i * 7 + k * 13) as f32 * 0.157, (i % 19 + 1) as f32);
            (48.0 + 0.3 * i as f32 * angle.cos() + size * (angle * 1.7).sin(), 30.0 + size * angle.cos())
        };
        let triangles: Vec<_> = (0..100)
            .filter_map(|i| {
                ScreenTriangle::at_depth([vertex(i, 0), vertex(i, 1), vertex(i, 2)], 1.0 + (i * 37 % 100) as f32)
            })
            .collect();
        let by_pixel = visible(&triangles, |tile, triangle, key| {
            if let Some(area) = tile.overlap(triangle) {
                tile.rasterize_pixels(triangle, area, key);
            }
        });
        let by_scanline = visible(&triangles, |tile, triangle, key| {
            if let Some(area) = tile.overlap(triangle) {
                tile.rasterize_scanlines(triangle, area, key);
            }
        });
        let pairs = by_pixel.iter().zip(&by_scanline).enumerate();
        let different: Vec<_> = pairs.filter(|(_, (pixel, scanline))| pixel != scanline).collect();
        assert_eq!(different, []);
        let covered = by_pixel.iter().filter(|key| **key != NO_TRIANGLE).count();
        assert!(covered > 300, "{covered}");
    }
}
