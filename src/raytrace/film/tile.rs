//! One tile of a film.

use super::aov::AovTile;
use super::stored::{Stored, invalid};
use super::{LayerSums, NonFiniteGate, NonFiniteReport, SampleBlocks};
use crate::color::luminance;
use crate::raytrace::sampler::SampleId;
use crate::raytrace::sink::{FirstHit, RadianceSink, SeenSurface};
use glam::Vec3;
use std::io::{self, Read, Write};

/// Edge length of a tile, pixels.
pub const TILE: u32 = 32;

/// Rows of a tile that a thread traces. When few tiles are left with too much noise, their bands keep all threads busy.
const BAND: u32 = 4;

/// The samples of a square of pixels.
#[derive(Clone, Debug)]
pub struct FilmTile {
    /// Left edge, pixels.
    pub x: u32,
    /// Upper edge, pixels.
    pub y: u32,
    /// Pixels across; less than [`TILE`] at the right edge.
    pub width: u32,
    /// Sums of the contributions.
    pub sums: LayerSums<Vec3>,
    /// Blocks of the samples, for the noise estimate.
    pub blocks: SampleBlocks,
    /// Albedo, normal, depth and object, if the render has AOVs.
    pub aovs: Option<Box<AovTile>>,
    /// Discarded non-finite contributions.
    pub nonfinite: NonFiniteReport,
    /// Rays that this run has traced for the tile.
    pub rays: u64,
    /// Pixel samples that this run has traced.
    pub traced_samples: u64,
}

impl FilmTile {
    /// An empty tile at a position, of a width and height in pixels.
    pub fn new((x, y): (u32, u32), (width, height): (u32, u32), layers: usize, aovs: bool) -> Self {
        let pixels = (width * height) as usize;
        FilmTile {
            x,
            y,
            width,
            sums: LayerSums::new(pixels, layers),
            blocks: SampleBlocks::new(pixels),
            aovs: aovs.then(|| Box::new(AovTile::new(pixels))),
            nonfinite: NonFiniteReport::default(),
            rays: 0,
            traced_samples: 0,
        }
    }

    /// Writes the samples.
    ///
    /// # Errors
    /// Those of `out`.
    pub fn store(&self, out: &mut dyn Write) -> io::Result<()> {
        self.sums.store(out)?;
        self.blocks.store(out)?;
        self.nonfinite.store(out)?;
        self.aovs.as_deref().map_or(Ok(()), |aovs| aovs.store(out))
    }

    /// Returns the tile with stored samples in the place of its own.
    ///
    /// # Errors
    /// If `from` holds no samples of a tile of this size and layers.
    pub fn with_stored(&self, from: &mut dyn Read) -> io::Result<Self> {
        let (sums, blocks) = (LayerSums::load(from)?, SampleBlocks::load(from)?);
        let nonfinite = NonFiniteReport::load(from)?;
        let aovs = self.aovs.as_ref().map(|_| AovTile::load(from).map(Box::new)).transpose()?;
        let has_aovs = match (&self.aovs, &aovs) {
            (Some(own), Some(stored)) => own.has_shape_of(stored),
            _ => true,
        };
        if !has_aovs || !self.sums.has_shape_of(&sums) || !self.blocks.has_shape_of(&blocks) {
            return Err(invalid());
        }
        Ok(FilmTile { sums, blocks, nonfinite, aovs, ..*self })
    }

    /// Returns copies of its bands of [`BAND`] rows, from top to bottom, which count their own rays and samples. Threads add
    /// samples to bands at the same time; [`FilmTile::set_bands`] puts them back.
    pub fn bands(&self) -> Vec<FilmTile> {
        let step = (BAND * self.width) as usize;
        let band = |first: usize| {
            let pixels = first..(first + step).min(self.pixels());
            FilmTile {
                y: self.y + first as u32 / self.width,
                sums: self.sums.range(pixels.clone()),
                blocks: self.blocks.range(pixels.clone()),
                aovs: self.aovs.as_ref().map(|aovs| Box::new(aovs.range(pixels))),
                nonfinite: NonFiniteReport::default(),
                rays: 0,
                traced_samples: 0,
                ..*self
            }
        };
        (0..self.pixels()).step_by(step).map(band).collect()
    }

    /// Replaces its pixels by those of its bands, and adds what they count.
    pub fn set_bands(&mut self, bands: &[FilmTile]) {
        for band in bands {
            let first = ((band.y - self.y) * self.width) as usize;
            self.sums.set_range(first, &band.sums);
            self.blocks.set_range(first, &band.blocks);
            if let Some((aovs, of_band)) = self.aovs.as_mut().zip(band.aovs.as_ref()) {
                aovs.set_range(first, of_band);
            }
            self.nonfinite.merge(&band.nonfinite);
            self.rays += band.rays;
            self.traced_samples += band.traced_samples;
        }
    }

    /// Takes the only sample of a pixel of another tile as the first one of its own.
    pub fn take_pixel(&mut self, pixel: usize, other: &FilmTile, from: usize) {
        self.sums.set_range(pixel, &other.sums.range(from..from + 1));
        self.blocks.add(pixel, other.blocks.first_sample(from));
        if let Some((aovs, of_other)) = self.aovs.as_mut().zip(other.aovs.as_ref()) {
            aovs.set_range(pixel, &of_other.range(from..from + 1));
        }
    }

    /// Number of pixels.
    pub fn pixels(&self) -> usize {
        self.sums.pixels()
    }

    /// Picture coordinates of a pixel of the tile.
    pub fn position(&self, pixel: usize) -> (u32, u32) {
        (self.x + pixel as u32 % self.width, self.y + pixel as u32 / self.width)
    }

    /// Samples per pixel.
    pub fn spp(&self) -> u32 {
        self.blocks.samples()
    }

    /// Factor from sums to means.
    pub fn per_sample(&self) -> f32 {
        1.0 / self.spp().max(1) as f32
    }

    /// Estimated noise, see [`SampleBlocks::noise_stops`].
    pub fn noise_stops(&self) -> Option<f32> {
        self.blocks.noise_stops(self.mean())
    }

    /// Mean exposed luminance of its pixels.
    pub fn mean(&self) -> f32 {
        self.blocks.mean()
    }

    /// The sink of one sample of a pixel, behind the non-finite gate. `layer_times` are the seconds for which each
    /// layer counts in the exposure, `view_axis` is the unit axis of the camera.
    pub fn sample_sink<'a>(
        &'a mut self,
        pixel: usize,
        sample: SampleId,
        layer_times: &'a [f32],
        view_axis: Vec3,
    ) -> NonFiniteGate<'a, PixelSink<'a>> {
        let FilmTile { sums, aovs, .. } = self;
        let aovs = aovs.as_deref_mut().map(|tile| PixelAovs { tile, sample_index: sample.index, view_axis });
        let sink = PixelSink { sums, pixel, layer_times, luminance: 0.0, aovs };
        NonFiniteGate { sink, sample, report: &mut self.nonfinite }
    }
}

/// Adds the contributions of one sample to a pixel.
#[derive(Debug)]
pub struct PixelSink<'a> {
    sums: &'a mut LayerSums<Vec3>,
    pixel: usize,
    layer_times: &'a [f32],
    /// Time-integrated luminance of the sample, cd s/m2.
    pub luminance: f32,
    aovs: Option<PixelAovs<'a>>,
}

/// The AOVs of a sample.
#[derive(Debug)]
struct PixelAovs<'a> {
    tile: &'a mut AovTile,
    sample_index: u32,
    view_axis: Vec3,
}

impl RadianceSink for PixelSink<'_> {
    #[inline]
    fn add(&mut self, layer: usize, value: Vec3) {
        self.sums.add(layer, self.pixel, value);
        self.luminance += luminance(value) * self.layer_times[layer];
    }

    #[inline]
    fn first_hit(&mut self, hit: impl FnOnce() -> FirstHit) {
        if let Some(PixelAovs { tile, sample_index, view_axis }) = &mut self.aovs {
            tile.add(self.pixel, *sample_index, &hit(), *view_axis);
        }
    }

    #[inline]
    fn seen_surface(&mut self, surface: impl FnOnce() -> SeenSurface) {
        if let Some(PixelAovs { tile, .. }) = &mut self.aovs {
            tile.add_seen(self.pixel, &surface());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bands_hold_all_pixels_and_go_back_to_their_places() {
        let (width, height) = (5, 10);
        let mut tile = FilmTile::new((32, 64), (width, height), 2, true);
        let expected = |x: u32, y: u32| Vec3::new(x as f32, y as f32, 1.0);
        // The second time, samples are added to what the tile has
        for pass in 1..=2 {
            let mut bands = tile.bands();
            let rows: Vec<(u32, usize)> = bands.iter().map(|band| (band.y, band.pixels())).collect();
            assert_eq!(rows, [(64, 20), (68, 20), (72, 10)]);
            for band in &mut bands {
                for pixel in 0..band.pixels() {
                    let (x, y) = band.position(pixel);
                    band.sums.add(1, pixel, expected(x, y));
                    band.blocks.add(pixel, y as f32);
                }
                (band.rays, band.traced_samples) = (7, band.pixels() as u64);
            }
            tile.set_bands(&bands);
            tile.blocks.finish_pass(1);
            assert_eq!((tile.rays, tile.traced_samples), (21 * pass, 50 * pass));
        }
        for pixel in 0..tile.pixels() {
            let (x, y) = tile.position(pixel);
            assert_eq!((tile.sums.at(0, pixel), tile.sums.at(1, pixel)), (Vec3::ZERO, 2.0 * expected(x, y)));
        }
        assert_eq!((tile.spp(), tile.mean()), (2, 68.5));
    }
}
