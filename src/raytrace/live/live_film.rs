//! The tiles of a live picture and the picture they make.

use super::camera::LiveCamera;
use super::smooth::Guide;
use super::tile::{LiveTile, Step};
use crate::photo::Picture;
use crate::photo::exposure;
use crate::raytrace::film::{Layer, TILE};
use crate::scene::Scene;
use glam::{Vec2, Vec3, Vec4};
use rayon::prelude::*;

/// Sums of samples, layer by layer, with what each pixel shows.
#[derive(Clone, Debug, Default)]
pub struct LiveFilm {
    size: (u32, u32),
    pub layers: Vec<Layer>,
    /// Rows of tiles from the top.
    pub tiles: Vec<LiveTile>,
}

/// A neighbour that a pixel without a value takes part of its own from.
#[derive(Clone, Copy)]
struct Tap<'a> {
    tile: &'a LiveTile,
    pixel: usize,
    weight: f32,
}

/// Weight of a neighbour that shows another surface: what is left where all of them do.
const OTHER_SURFACE: f32 = 1e-3;

impl LiveFilm {
    /// An empty film.
    pub fn new(size: (u32, u32), layers: Vec<Layer>) -> Self {
        let rows = (0..size.1).step_by(TILE as usize);
        let columns = || (0..size.0).step_by(TILE as usize);
        let tiles =
            rows.flat_map(|y| columns().map(move |x| (x, y))).map(|(x, y)| LiveTile::new(x, y, size, layers.len()));
        LiveFilm { size, tiles: tiles.collect(), layers }
    }

    /// An empty film in the memory of another, where that has the same size.
    pub fn reusing(spare: Option<LiveFilm>, size: (u32, u32), layers: Vec<Layer>) -> Self {
        match spare.filter(|film| film.size == size && film.layers.len() == layers.len()) {
            Some(mut film) => {
                film.tiles.par_iter_mut().for_each(LiveTile::clear);
                film.layers = layers;
                film
            }
            None => LiveFilm::new(size, layers),
        }
    }

    /// The tile and its pixel at picture coordinates, which are whole numbers; none outside.
    pub fn at(&self, place: Vec2) -> Option<(&LiveTile, usize)> {
        let inside = place.cmpge(Vec2::ZERO).all() && place.x < self.size.0 as f32 && place.y < self.size.1 as f32;
        if !inside {
            return None;
        }
        let (x, y) = (place.x as u32, place.y as u32);
        let tile = &self.tiles[(y / TILE * self.size.0.div_ceil(TILE) + x / TILE) as usize];
        Some((tile, ((y - tile.y) * tile.width + x - tile.x) as usize))
    }

    /// Pixels between those that have a value in every layer; none before there are any.
    pub fn stride(&self) -> Option<u32> {
        self.tiles.iter().map(|tile| tile.progress.next()).min().and_then(Step::stride)
    }

    /// Samples that every pixel has in every layer.
    pub fn spp(&self) -> u32 {
        Step::samples(self.tiles.iter().map(|tile| tile.progress.next()).min().unwrap_or(0))
    }

    /// Share of the pixels that took over what was known of them.
    pub fn reused(&self) -> f32 {
        let reused: u32 = self.tiles.iter().map(|tile| tile.reused).sum();
        reused as f32 / (self.size.0 as f32 * self.size.1 as f32)
    }

    /// Gives the film other layers; those of `from` are kept.
    pub fn remap(&mut self, layers: Vec<Layer>, from: &[Option<usize>]) {
        self.tiles.par_iter_mut().for_each(|tile| tile.remap(from));
        self.layers = layers;
    }

    /// The picture with exposure, white balance, and each light's power, colour and switch as in `scene`; `every` pixel of
    /// a row and every row (a divisor of [`TILE`]). Pixels that have no value yet take one from those around that show the
    /// same surface, as far as that is known.
    pub fn develop(&self, scene: &Scene, camera: &LiveCamera, every: u32) -> Picture {
        let scale = exposure::pixel_per_cd_s_m2(&scene.camera);
        let weights: Vec<Vec3> = self.layers.iter().map(|layer| layer.weight(scene) * scale).collect();
        let developed: Vec<Vec<[f32; 3]>> =
            self.tiles.par_iter().map(|tile| self.develop_tile(tile, &weights, camera, every)).collect();
        let mut picture = Picture::new(self.size.0.div_ceil(every), self.size.1.div_ceil(every));
        for (tile, values) in self.tiles.iter().zip(&developed) {
            for (row, values) in values.chunks_exact(tile.width.div_ceil(every) as usize).enumerate() {
                let first = ((tile.y / every) as usize + row) * picture.width as usize + (tile.x / every) as usize;
                picture.rgb[first..first + values.len()].copy_from_slice(values);
            }
        }
        picture
    }

    /// What pixel (x, y) of [`LiveFilm::develop`]'s picture says of its surface.
    pub fn guide(&self, camera: &LiveCamera, every: u32, (x, y): (usize, usize)) -> Guide {
        let place = Vec2::new((x as u32 * every) as f32, (y as u32 * every) as f32);
        let Some((tile, pixel)) = self.at(place) else { return Guide::NONE };
        let layers = 0..self.layers.len();
        let samples = layers.map(|layer| tile.sum(layer, pixel).w).fold(f32::INFINITY, f32::min);
        let shown = tile.shown[pixel];
        let samples = if samples.is_finite() { samples } else { 0.0 };
        Guide { shown, scale: camera.depth_scale(shown.position), samples }
    }

    fn develop_tile(&self, tile: &LiveTile, weights: &[Vec3], camera: &LiveCamera, every: u32) -> Vec<[f32; 3]> {
        let rows = (0..tile.height).step_by(every as usize);
        let columns = || (0..tile.width).step_by(every as usize);
        let pixels = rows.flat_map(|y| columns().map(move |x| (y * tile.width + x) as usize));
        pixels.map(|pixel| self.develop_pixel(tile, pixel, weights, camera).to_array()).collect()
    }

    fn develop_pixel(&self, tile: &LiveTile, pixel: usize, weights: &[Vec3], camera: &LiveCamera) -> Vec3 {
        let mut sum = Vec3::ZERO;
        let mut taps: [Option<[Option<Tap<'_>>; 4]>; 2] = [None; 2];
        for (layer, weight) in weights.iter().enumerate().filter(|(_, weight)| **weight != Vec3::ZERO) {
            let own = tile.sum(layer, pixel);
            if own.w > 0.0 {
                sum += own.truncate() / own.w * *weight;
                continue;
            }
            // A layer that lags has no value where its grid is not yet that fine; the others have theirs.
            for (taps, steps) in taps.iter_mut().zip([tile.progress.main, tile.progress.lagging]) {
                let Some(stride) = Step::stride(steps) else { continue };
                let taps = taps.get_or_insert_with(|| self.taps(tile, pixel, stride, camera));
                if let Some(value) = interpolated(taps, layer) {
                    sum += value * *weight;
                    break;
                }
            }
        }
        sum
    }

    /// The four pixels of a grid around a pixel.
    fn taps(&self, tile: &LiveTile, pixel: usize, stride: u32, camera: &LiveCamera) -> [Option<Tap<'_>>; 4] {
        let (x, y) = tile.place(pixel);
        let corner = Vec2::new((x / stride * stride) as f32, (y / stride * stride) as f32);
        let part = (Vec2::new(x as f32, y as f32) - corner) / stride as f32;
        let shown = &tile.shown[pixel];
        let scale = camera.depth_scale(shown.position);
        [Vec2::ZERO, Vec2::X, Vec2::Y, Vec2::ONE].map(|step| {
            let across = Vec2::ONE - part + step * (2.0 * part - 1.0);
            let (tile, pixel) = self.at(corner + step * stride as f32)?;
            let other = shown.is_known() && !shown.agrees(&tile.shown[pixel], scale);
            let weight = across.x * across.y * if other { OTHER_SURFACE } else { 1.0 };
            Some(Tap { tile, pixel, weight })
        })
    }
}

/// Mean of a layer over the neighbours that have a value.
fn interpolated(taps: &[Option<Tap<'_>>; 4], layer: usize) -> Option<Vec3> {
    let mut sum = Vec4::ZERO;
    for tap in taps.iter().flatten() {
        let there = tap.tile.sum(layer, tap.pixel);
        if there.w > 0.0 {
            sum += (there.truncate() / there.w).extend(1.0) * tap.weight;
        }
    }
    (sum.w > 0.0).then(|| sum.truncate() / sum.w)
}
