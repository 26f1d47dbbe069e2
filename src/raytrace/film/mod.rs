//! The film: sums of samples in tiles, with one layer per light, so that lights can be dimmed and coloured after the
//! render.

mod aov;
mod from_layers;
mod gate;
mod layer;
mod noise;
mod stored;
mod sums;
mod tile;

use aov::AovTile;
pub use gate::{NonFiniteGate, NonFiniteReport};
pub use layer::{Layer, MAX_LIGHT_LAYERS, assign_layers, share_layers};
pub use noise::{MIN_ESTIMATE_SPP, MIN_ROUGH_ESTIMATE_SPP, MIN_VARIANCE_SPP, SampleBlocks};
pub use sums::LayerSums;
pub use tile::{FilmTile, TILE};

use super::approximations::Approximations;
use super::settings::{Method, Settings};
use crate::photo::{AovPicture, LazyPicture, Picture, exposure};
use crate::scene::Scene;
use glam::Vec3;
use std::io::{self, Read, Write};
use std::sync::Arc;

/// The sums of samples of a picture, layer by layer.
///
/// A clone is a cheap snapshot: it shares the tiles, and a running render copies a shared tile, on the thread that adds
/// samples to it, before it writes. A snapshot can be developed and relit while the render goes on.
#[derive(Clone, Debug)]
pub struct Film {
    width: u32,
    height: u32,
    layers: Vec<Layer>,
    method: Method,
    approximations: Approximations,
    /// Rows of tiles from the top.
    tiles: Vec<Arc<FilmTile>>,
}

impl Film {
    /// An empty film for a render with these approximations.
    pub fn new(settings: &Settings, layers: Vec<Layer>, approximations: Approximations) -> Self {
        let Settings { width, height, method, aovs, .. } = *settings;
        let mut tiles = Vec::new();
        for y in (0..height).step_by(TILE as usize) {
            for x in (0..width).step_by(TILE as usize) {
                let (tile_width, tile_height) = (TILE.min(width - x), TILE.min(height - y));
                tiles.push(Arc::new(FilmTile::new((x, y), (tile_width, tile_height), layers.len(), aovs)));
            }
        }
        Film { width, height, layers, method, approximations, tiles }
    }

    /// Returns the memory of a film with so many layers, bytes.
    pub fn bytes(settings: &Settings, layers: usize) -> u64 {
        let aovs = if settings.aovs { AovTile::BYTES_PER_PIXEL } else { 0 };
        settings.pixels() * (layers * size_of::<Vec3>() + SampleBlocks::BYTES_PER_PIXEL + aovs) as u64
    }

    /// Writes the samples of all tiles, with every bit that a render needs to go on from them.
    ///
    /// # Errors
    /// Those of `out`.
    pub fn store(&self, out: &mut dyn Write) -> io::Result<()> {
        self.tiles.iter().try_for_each(|tile| tile.store(out))
    }

    /// Returns the film with stored samples in the place of its own.
    ///
    /// # Errors
    /// If `from` holds no film of this size, layers and AOVs.
    pub fn with_stored(&self, from: &mut dyn Read) -> io::Result<Film> {
        let tiles = self.tiles.iter().map(|tile| tile.with_stored(from).map(Arc::new)).collect::<io::Result<_>>()?;
        if from.read(&mut [0])? > 0 {
            return Err(stored::invalid());
        }
        Ok(Film { tiles, layers: self.layers.clone(), ..*self })
    }

    /// Samples per pixel of the tile that has most.
    pub(super) fn most_spp(&self) -> u32 {
        self.tiles.iter().map(|tile| tile.spp()).max().unwrap_or(0)
    }

    /// Pixels across.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Pixels down.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// Returns the name of the method with its approximations, for the picture's file.
    pub fn method(&self) -> String {
        self.approximations.describe(match self.method {
            Method::Whitted => "whitted",
            Method::Direct => "direct",
            Method::Path => "path",
        })
    }

    /// Returns how light was approximated.
    pub fn approximations(&self) -> Approximations {
        self.approximations
    }

    /// Samples that every pixel has. Some have more after adaptive sampling or an interrupted pass.
    pub fn spp(&self) -> u32 {
        self.tiles.iter().map(|tile| tile.spp()).min().unwrap_or(0)
    }

    /// Mean samples per pixel.
    pub fn mean_spp(&self) -> f64 {
        let samples: u64 = self.tiles.iter().map(|tile| tile.pixels() as u64 * u64::from(tile.spp())).sum();
        samples as f64 / (f64::from(self.width) * f64::from(self.height)).max(1.0)
    }

    /// Adds a report of contributions that were discarded elsewhere.
    pub(super) fn report_nonfinite(&mut self, report: &NonFiniteReport) {
        if let Some(tile) = self.tiles.first_mut().filter(|_| report.count > 0) {
            Arc::make_mut(tile).nonfinite.merge(report);
        }
    }

    /// Returns the rays that this run has traced for the pixels, without those for photons and caches.
    pub fn traced_rays(&self) -> u64 {
        self.tiles.iter().map(|tile| tile.rays).sum()
    }

    /// The layers, in the order of [`Film::develop_layers`].
    pub fn layers(&self) -> &[Layer] {
        &self.layers
    }

    /// The non-finite contributions that were discarded and are shown black.
    pub fn nonfinite(&self) -> NonFiniteReport {
        self.tiles.iter().map(|tile| &tile.nonfinite).collect()
    }

    /// Returns the estimated noise: the median of the tiles' noise, in stops. Infinite before there are
    /// [`MIN_ESTIMATE_SPP`] samples; 0 when every tile is too dark.
    pub fn noise_stops(&self) -> f32 {
        let mut noise: Vec<f32> = self.tiles.iter().filter_map(|tile| tile.noise_stops()).collect();
        noise.sort_by(f32::total_cmp);
        noise.get(noise.len() / 2).copied().unwrap_or(0.0)
    }

    /// Returns the estimated noise of each tile of [`TILE`] pixels, stops, in rows from the top. Infinite before there
    /// are [`MIN_ESTIMATE_SPP`] samples; none for tiles that are too dark.
    pub fn tile_noise_stops(&self) -> Vec<Option<f32>> {
        self.tiles.iter().map(|tile| tile.noise_stops()).collect()
    }

    /// Returns samples per pixel and roughly estimated noise of each tile: as [`Film::tile_noise_stops`], but from two
    /// samples on.
    pub fn tile_noise(&self) -> Vec<(u32, Option<f32>)> {
        self.tiles.iter().map(|tile| (tile.spp(), tile.blocks.rough_noise_stops(tile.mean()))).collect()
    }

    /// The tiles.
    pub(super) fn tiles(&self) -> &[Arc<FilmTile>] {
        &self.tiles
    }

    /// The tiles, to add samples to; see [`Arc::make_mut`].
    pub(super) fn tiles_mut(&mut self) -> &mut [Arc<FilmTile>] {
        &mut self.tiles
    }

    /// Develops the picture with the exposure, white balance, and each light's power, colour and switch in `scene`.
    /// Lights that were off when the render began have no layer and stay dark.
    pub fn develop(&self, scene: &Scene) -> Picture {
        let weights = self.weights(scene);
        self.picture(|tile, pixel| {
            let sums = weights.iter().enumerate().map(|(layer, weight)| tile.sums.at(layer, pixel) * *weight);
            sums.sum::<Vec3>() * tile.per_sample()
        })
    }

    /// Develops each layer by itself; their sum is [`Film::develop`], but for pixels of few samples that are negative.
    pub fn develop_layers(&self, scene: &Scene) -> Vec<(String, Picture)> {
        self.lazy_layers(scene).into_iter().map(|(name, layer)| (name, layer.collect())).collect()
    }

    /// As [`Film::develop_layers`], pixel by pixel as it is read.
    pub fn lazy_layers(&self, scene: &Scene) -> Vec<(String, LazyPicture<'_>)> {
        let layers = self.layers.iter().zip(self.weights(scene)).enumerate();
        let one = |(layer, (info, weight)): (usize, (&Layer, Vec3))| {
            let picture = LazyPicture::new((self.width, self.height), move |x, y| {
                let (tile, pixel) = self.pixel_at(x, y);
                (tile.sums.at(layer, pixel) * weight * tile.per_sample()).max(Vec3::ZERO).to_array()
            });
            (info.name.clone(), picture)
        };
        layers.map(one).collect()
    }

    /// Returns the tile of a pixel and its index there.
    pub(super) fn pixel_at(&self, x: u32, y: u32) -> (&FilmTile, usize) {
        let tile = &self.tiles[((y / TILE) * self.width.div_ceil(TILE) + x / TILE) as usize];
        (tile, ((y % TILE) * tile.width + x % TILE) as usize)
    }

    /// Returns the mean albedo of the surfaces in a pixel; none unless [`Settings::aovs`] asked for it.
    pub fn albedo_at(&self, x: u32, y: u32) -> Option<[f32; 3]> {
        let (tile, pixel) = self.pixel_at(x, y);
        tile.aovs.as_ref().map(|aovs| aovs.albedo(pixel, tile.per_sample()))
    }

    /// Returns the factor of each layer from a picture with the lights of `from` to one with those of `to`. None if a
    /// light that is off in `from` is on in `to`.
    pub fn relight_factors(&self, from: &Scene, to: &Scene) -> Option<Vec<Vec3>> {
        let factor = |from: f32, to: f32| match (from > 0.0, to > 0.0) {
            (true, _) => Some(to / from),
            (false, true) => None,
            (false, false) => Some(0.0),
        };
        let factors = self
            .weights(from)
            .into_iter()
            .zip(self.weights(to))
            .map(|(from, to)| Some(Vec3::new(factor(from.x, to.x)?, factor(from.y, to.y)?, factor(from.z, to.z)?)));
        factors.collect()
    }

    /// Returns true if it has AOVs.
    pub fn has_aovs(&self) -> bool {
        self.tiles.iter().all(|tile| tile.aovs.is_some())
    }

    /// Returns the AOVs; none unless [`Settings::aovs`] asked for them.
    pub fn aovs(&self) -> Option<AovPicture> {
        let mut picture = AovPicture::new(self.width, self.height);
        for tile in &self.tiles {
            let aovs = tile.aovs.as_ref()?;
            for pixel in 0..tile.pixels() {
                let (x, y) = tile.position(pixel);
                let at = y as usize * self.width as usize + x as usize;
                aovs.write(pixel, tile.per_sample(), &mut picture, at);
                picture.relative_variance[at] = tile.blocks.relative_variance(pixel);
            }
        }
        Some(picture)
    }

    /// Factor of each layer from means to picture values.
    pub(super) fn weights(&self, scene: &Scene) -> Vec<Vec3> {
        let scale = exposure::pixel_per_cd_s_m2(scene);
        self.layers.iter().map(|layer| layer.weight(scene) * scale).collect()
    }

    /// Collects pixel values. The mean of a few samples of skin may be negative (`subsurface`): it is noise, and shown
    /// black.
    fn picture(&self, value: impl Fn(&FilmTile, usize) -> Vec3) -> Picture {
        let mut picture = Picture::new(self.width, self.height);
        for tile in &self.tiles {
            for pixel in 0..tile.pixels() {
                let (x, y) = tile.position(pixel);
                picture.rgb[y as usize * self.width as usize + x as usize] =
                    value(tile, pixel).max(Vec3::ZERO).to_array();
            }
        }
        picture
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::raytrace::{RenderControl, prepare, render};
    use crate::scene::{Assets, Emitter, Light, Output, Room};
    use std::ops::ControlFlow;

    #[test]
    fn a_snapshot_keeps_its_samples_while_the_render_continues() {
        let light = Light { position: Vec3::Y * 2.0, ..Light::new(Emitter::Point, Output::Lumens(1000.0)) };
        let scene = Scene { room: Some(Room::default()), lights: vec![light], ..Scene::default() };
        let prepared = prepare(&scene, &Assets::default()).unwrap();
        let settings = Settings { width: 40, height: 20, spp: 4, ..Settings::default() };
        let mut snapshots = Vec::new();
        let film = render(&prepared, &settings, &RenderControl::new(), &mut |film| {
            let snapshot = film.clone();
            assert!(snapshot.tiles.iter().zip(&film.tiles).all(|(a, b)| Arc::ptr_eq(a, b)), "the tiles are shared");
            snapshots.push(snapshot);
            ControlFlow::Continue(())
        });
        assert_eq!(snapshots.iter().map(Film::spp).collect::<Vec<_>>(), [1, 2, 4]);
        for snapshot in &snapshots {
            let settings = Settings { spp: snapshot.spp(), ..settings.clone() };
            let alone = render(&prepared, &settings, &RenderControl::new(), &mut |_| ControlFlow::Continue(()));
            assert_eq!(snapshot.develop(&scene), alone.develop(&scene));
        }
        assert_eq!(film.develop(&scene), snapshots[2].develop(&scene));
    }
}
