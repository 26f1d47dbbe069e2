//! The tiles of the live view, and their resolve to a picture.

use super::atrous_filter::FilterInput;
use super::camera::LiveCamera;
use super::live_tile::LiveTile;
use super::refinement::RefinementStep;
use crate::photo::Picture;
use crate::photo::exposure;
use crate::raytrace::film::{Layer, TILE};
use crate::scene::Scene;
use glam::{Vec2, Vec3, Vec4};
use rayon::prelude::*;

/// Sums of samples in layers, with the primary hit of each pixel.
#[derive(Clone, Debug, Default)]
pub struct LiveFilm {
    size: (u32, u32),
    /// The layers, in the order of the sums.
    pub layers: Vec<Layer>,
    /// Rows of tiles from the top.
    pub tiles: Vec<LiveTile>,
}

/// A neighbour from which a pixel without a value is interpolated.
#[derive(Clone, Copy)]
struct FilterTap<'a> {
    tile: &'a LiveTile,
    pixel: usize,
    weight: f32,
}

/// Weight of a neighbour that shows another surface: it counts only where all four do.
const OTHER_SURFACE_WEIGHT: f32 = 1e-3;

impl LiveFilm {
    /// An empty film.
    pub fn new(size: (u32, u32), layers: Vec<Layer>) -> Self {
        let rows = (0..size.1).step_by(TILE as usize);
        let columns = || (0..size.0).step_by(TILE as usize);
        let tiles =
            rows.flat_map(|y| columns().map(move |x| (x, y))).map(|(x, y)| LiveTile::new(x, y, size, layers.len()));
        LiveFilm { size, tiles: tiles.collect(), layers }
    }

    /// An empty film in the memory of another one of the same size.
    pub fn recycling(recycled: Option<LiveFilm>, size: (u32, u32), layers: Vec<Layer>) -> Self {
        match recycled.filter(|film| film.size == size && film.layers.len() == layers.len()) {
            Some(mut film) => {
                film.tiles.par_iter_mut().for_each(LiveTile::clear);
                film.layers = layers;
                film
            }
            None => LiveFilm::new(size, layers),
        }
    }

    /// Returns the tile and the index in it of the pixel at whole picture coordinates; `None` outside.
    pub fn pixel_at(&self, position: Vec2) -> Option<(&LiveTile, usize)> {
        let is_inside =
            position.cmpge(Vec2::ZERO).all() && position.x < self.size.0 as f32 && position.y < self.size.1 as f32;
        if !is_inside {
            return None;
        }
        let (x, y) = (position.x as u32, position.y as u32);
        let tile = &self.tiles[(y / TILE * self.size.0.div_ceil(TILE) + x / TILE) as usize];
        Some((tile, ((y - tile.y) * tile.width + x - tile.x) as usize))
    }

    /// Steps that every tile has completed in every layer; 0 without tiles.
    pub fn completed_steps(&self) -> u32 {
        self.tiles.iter().map(|tile| tile.progress.completed()).min().unwrap_or(0)
    }

    /// Spacing of the pixels that have a value in every layer; `None` before there are any.
    pub fn stride(&self) -> Option<u32> {
        RefinementStep::stride(self.completed_steps())
    }

    /// Samples that every pixel has in every layer.
    pub fn spp(&self) -> u32 {
        RefinementStep::samples(self.completed_steps())
    }

    /// Fraction of the pixels that took their value from the history.
    pub fn reprojected_fraction(&self) -> f32 {
        let reprojected: u32 = self.tiles.iter().map(|tile| tile.reprojected).sum();
        reprojected as f32 / (self.size.0 as f32 * self.size.1 as f32)
    }

    /// Replaces the layers: `from` names the former layer of each new one, `None` for one that is retraced.
    pub fn remap(&mut self, layers: Vec<Layer>, from: &[Option<usize>]) {
        self.tiles.par_iter_mut().for_each(|tile| tile.remap(from));
        self.layers = layers;
    }

    /// Develops the picture with the exposure, white balance, and each light's power, colour and switch in `scene`;
    /// every `stride`th pixel of every `stride`th row (a divisor of [`TILE`]). Pixels without a value are interpolated
    /// from neighbours that show the same surface.
    pub fn develop(&self, scene: &Scene, camera: &LiveCamera, stride: u32) -> Picture {
        // Weight of each layer, from means to picture values
        let scale = exposure::pixel_per_cd_s_m2(scene);
        let weights: Vec<Vec3> = self.layers.iter().map(|layer| layer.weight(scene) * scale).collect();

        // Resolve the tiles in parallel. The mean of a few samples of skin may be negative: it is shown black
        let resolve = |tile: &LiveTile| -> Vec<[f32; 3]> {
            let pixels = tile.grid(stride);
            pixels.map(|pixel| self.resolve_pixel(tile, pixel, &weights, camera).max(Vec3::ZERO).to_array()).collect()
        };
        let resolved: Vec<Vec<[f32; 3]>> = self.tiles.par_iter().map(resolve).collect();

        // Copy the rows of the tiles into the picture
        let mut picture = Picture::new(self.size.0.div_ceil(stride), self.size.1.div_ceil(stride));
        for (tile, values) in self.tiles.iter().zip(&resolved) {
            for (row, values) in values.chunks_exact(tile.width.div_ceil(stride) as usize).enumerate() {
                let first = ((tile.y / stride) as usize + row) * picture.width as usize + (tile.x / stride) as usize;
                picture.rgb[first..first + values.len()].copy_from_slice(values);
            }
        }
        picture
    }

    /// Returns the edge-aware filter's input for pixel (x, y) of a picture developed with `stride`.
    pub fn filter_input(&self, camera: &LiveCamera, stride: u32, (x, y): (usize, usize)) -> FilterInput {
        let position = Vec2::new((x as u32 * stride) as f32, (y as u32 * stride) as f32);
        let Some((tile, pixel)) = self.pixel_at(position) else { return FilterInput::BACKGROUND };
        let layers = 0..self.layers.len();
        let samples = layers.map(|layer| tile.sums.at(layer, pixel).w).fold(f32::INFINITY, f32::min);
        let samples = if samples.is_finite() { samples } else { 0.0 };
        let hit = tile.primary_hits[pixel];
        FilterInput { hit, depth_scale_m: camera.depth_scale(hit.position), samples }
    }

    fn resolve_pixel(&self, tile: &LiveTile, pixel: usize, weights: &[Vec3], camera: &LiveCamera) -> Vec3 {
        let mut sum = Vec3::ZERO;
        let mut taps: [Option<[Option<FilterTap<'_>>; 4]>; 2] = [None; 2];
        for (layer, weight) in weights.iter().enumerate().filter(|(_, weight)| **weight != Vec3::ZERO) {
            // Take the mean of the pixel's own samples
            let own = tile.sums.at(layer, pixel);
            if own.w > 0.0 {
                sum += own.truncate() / own.w * *weight;
                continue;
            }

            // Interpolate from the finest grid that has values in this layer: that of retraced lights is coarser
            for (taps, steps) in taps.iter_mut().zip([tile.progress.kept, tile.progress.retraced]) {
                let Some(stride) = RefinementStep::stride(steps) else { continue };
                let taps = taps.get_or_insert_with(|| self.taps(tile, pixel, stride, camera));
                if let Some(value) = interpolate(taps, layer) {
                    sum += value * *weight;
                    break;
                }
            }
        }
        sum
    }

    /// Returns the four pixels of a grid around a pixel, with bilinear weights that stop at edges.
    fn taps(&self, tile: &LiveTile, pixel: usize, stride: u32, camera: &LiveCamera) -> [Option<FilterTap<'_>>; 4] {
        let (x, y) = tile.position(pixel);
        let corner = Vec2::new((x / stride * stride) as f32, (y / stride * stride) as f32);
        let fraction = (Vec2::new(x as f32, y as f32) - corner) / stride as f32;
        let hit = &tile.primary_hits[pixel];
        let depth_scale_m = camera.depth_scale(hit.position);
        [Vec2::ZERO, Vec2::X, Vec2::Y, Vec2::ONE].map(|offset| {
            let bilinear = Vec2::ONE - fraction + offset * (2.0 * fraction - 1.0);
            let (tile, pixel) = self.pixel_at(corner + offset * stride as f32)?;
            let is_other = hit.is_traced() && !hit.is_same_surface(&tile.primary_hits[pixel], depth_scale_m);
            let weight = bilinear.x * bilinear.y * if is_other { OTHER_SURFACE_WEIGHT } else { 1.0 };
            Some(FilterTap { tile, pixel, weight })
        })
    }
}

/// Returns the weighted mean of a layer over the neighbours that have a value.
fn interpolate(taps: &[Option<FilterTap<'_>>; 4], layer: usize) -> Option<Vec3> {
    let mut sum = Vec4::ZERO;
    for tap in taps.iter().flatten() {
        let neighbour = tap.tile.sums.at(layer, tap.pixel);
        if neighbour.w > 0.0 {
            sum += (neighbour.truncate() / neighbour.w).extend(1.0) * tap.weight;
        }
    }
    (sum.w > 0.0).then(|| sum.truncate() / sum.w)
}
