//! A part of a picture's samples, to be merged with the others: sums without rounding, so that the picture does not
//! depend on how its samples were divided.

use super::exact_sum::ExactSum;
use super::film::{Film, Layer, MIN_VARIANCE_SPP, NonFiniteReport, TILE};
use crate::color::luminance;
use crate::photo::{AovPicture, LazyPicture, Picture};
use crate::raytrace::settings::Settings;
use crate::scene::Scene;
use glam::{DVec3, Vec3};
use rayon::prelude::*;

/// Red, green and blue of a pixel, or the components of a vector.
pub type PixelSum = [ExactSum; 3];

/// The sums of a light's layer.
#[derive(Clone, Debug, PartialEq)]
pub struct PartLayer {
    /// The layer's name.
    pub name: String,
    /// Factor from means to picture values: the light's power and colour, white balance, exposure.
    pub weight: Vec3,
    /// Sums of the samples, rows from the top.
    pub sums: Vec<PixelSum>,
}

/// The first surface that each pixel shows.
#[derive(Clone, Debug, PartialEq)]
pub struct PartAovs {
    /// Sums of the samples' albedo.
    pub albedo: Vec<PixelSum>,
    /// Sums of the samples' normals.
    pub normal: Vec<PixelSum>,
    /// Sums of the albedo of what the samples see directly or by mirrors and clear glass.
    pub seen_albedo: Vec<PixelSum>,
    /// Sums of the normals, as `seen_albedo`.
    pub seen_normal: Vec<PixelSum>,
    /// Depth of the picture's first sample, metres; infinite in parts without it.
    pub depth_m: Vec<f32>,
    /// Object of the picture's first sample; none in parts without it.
    pub object_id: Vec<u32>,
}

/// Sums over some of the samples of a picture.
#[derive(Clone, Debug, PartialEq)]
pub struct FilmPart {
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
    /// Samples of each pixel.
    pub samples: u32,
    /// The layers, one per light.
    pub layers: Vec<PartLayer>,
    /// Sums of the squared luminance of the samples as picture values.
    pub squares: Vec<ExactSum>,
    /// Albedo, normal, depth and object, if the render has AOVs.
    pub aovs: Option<PartAovs>,
    /// Discarded non-finite contributions.
    pub nonfinite: NonFiniteReport,
}

impl FilmPart {
    /// Returns the memory of a part with so many layers, bytes.
    pub fn bytes(settings: &Settings, layers: usize) -> u64 {
        let (sum, square) = (size_of::<PixelSum>(), size_of::<ExactSum>());
        let aovs = if settings.aovs { 4 * sum + size_of::<f32>() + size_of::<u32>() } else { 0 };
        settings.pixels() * (layers * sum + square + aovs) as u64
    }

    /// Returns a part without samples, for a film developed as in `scene`.
    pub fn new(film: &Film, scene: &Scene, aovs: bool) -> Self {
        let pixels = film.width() as usize * film.height() as usize;
        let sums = || vec![PixelSum::default(); pixels];
        let layer = |(layer, weight): (&Layer, Vec3)| PartLayer { name: layer.name.clone(), weight, sums: sums() };
        let first = AovPicture::new(film.width(), film.height());
        let (depth_m, object_id) = (first.depth_m, first.object_id);
        FilmPart {
            width: film.width(),
            height: film.height(),
            samples: 0,
            layers: film.layers().iter().zip(film.weights(scene)).map(layer).collect(),
            squares: vec![ExactSum::default(); pixels],
            aovs: aovs.then(|| PartAovs {
                albedo: sums(),
                normal: sums(),
                seen_albedo: sums(),
                seen_normal: sums(),
                depth_m,
                object_id,
            }),
            nonfinite: NonFiniteReport::default(),
        }
    }

    /// Adds a film of one sample a pixel.
    pub fn add(&mut self, sample: &Film) {
        let width = self.width as usize;
        let tiles_across = width.div_ceil(TILE as usize).max(1);
        let band = width * TILE as usize;
        let in_row = |pixel: (u32, u32)| (pixel.1 % TILE) as usize * width + pixel.0 as usize;
        // Add the layers, in bands as high as a tile
        let rows = || sample.tiles().par_chunks(tiles_across);
        for (index, layer) in self.layers.iter_mut().enumerate() {
            layer.sums.par_chunks_mut(band).zip(rows()).for_each(|(sums, tiles)| {
                for tile in tiles {
                    for pixel in 0..tile.pixels() {
                        add(&mut sums[in_row(tile.position(pixel))], tile.sums.at(index, pixel).to_array());
                    }
                }
            });
        }
        // Add the squares
        let weights: Vec<Vec3> = self.layers.iter().map(|layer| layer.weight).collect();
        self.squares.par_chunks_mut(band).zip(rows()).for_each(|(squares, tiles)| {
            for tile in tiles {
                for pixel in 0..tile.pixels() {
                    let weighted =
                        weights.iter().enumerate().map(|(layer, weight)| tile.sums.at(layer, pixel) * *weight);
                    squares[in_row(tile.position(pixel))].add(luminance(weighted.sum::<Vec3>()).powi(2));
                }
            }
        });
        if let (Some(aovs), Some(first_hits)) = (&mut self.aovs, sample.aovs()) {
            aovs.add(&first_hits);
        }
        self.nonfinite.merge(&sample.nonfinite());
        self.samples += 1;
    }

    /// Adds the samples of another part of the same render. Returns false, and adds nothing, if it has another shape.
    pub fn merge(&mut self, other: &FilmPart) -> bool {
        if !self.has_shape_of(other) {
            return false;
        }
        for (own, others) in self.layers.iter_mut().zip(&other.layers) {
            merge(&mut own.sums, &others.sums);
        }
        self.squares.iter_mut().zip(&other.squares).for_each(|(own, other)| own.merge(*other));
        if let (Some(own), Some(others)) = (&mut self.aovs, &other.aovs) {
            own.merge(others);
        }
        self.nonfinite.merge(&other.nonfinite);
        self.samples += other.samples;
        true
    }

    fn has_shape_of(&self, other: &FilmPart) -> bool {
        let layers = |part: &FilmPart| -> Vec<_> {
            part.layers.iter().map(|layer| (layer.name.clone(), layer.weight, layer.sums.len())).collect()
        };
        let shape = |part: &FilmPart| (part.width, part.height, part.squares.len(), part.aovs.is_some());
        shape(self) == shape(other) && layers(self) == layers(other)
    }

    /// Develops the picture.
    pub fn develop(&self) -> Picture {
        let rgb = (0..self.squares.len()).map(|pixel| self.develop_pixel(pixel));
        Picture { width: self.width, height: self.height, rgb: rgb.collect() }
    }

    /// Develops one pixel of the picture, by its index in rows from the top.
    pub fn develop_pixel(&self, pixel: usize) -> [f32; 3] {
        shown(self.layers.iter().map(|layer| self.mean(layer, pixel)).sum())
    }

    /// Develops each layer by itself, pixel by pixel as it is read.
    pub fn lazy_layers(&self) -> Vec<(String, LazyPicture<'_>)> {
        let one = |layer| {
            let pixel = move |x, y| y as usize * self.width as usize + x as usize;
            let picture = LazyPicture::new((self.width, self.height), move |x, y| shown(self.mean(layer, pixel(x, y))));
            (layer.name.clone(), picture)
        };
        self.layers.iter().map(one).collect()
    }

    /// Returns the AOVs, if the render has them.
    pub fn develop_aovs(&self) -> Option<AovPicture> {
        let aovs = self.aovs.as_ref()?;
        let mean = |sums: &[PixelSum]| -> Vec<[f32; 3]> {
            sums.iter().map(|sum| (value(*sum) * self.per_sample()).as_vec3().to_array()).collect()
        };
        let relative_variance = |pixel: usize| {
            let (mean, variance) = self.mean_and_variance(pixel);
            let is_known = self.samples >= MIN_VARIANCE_SPP;
            if !is_known {
                f32::INFINITY
            } else if variance > 0.0 {
                (variance / (mean * mean)) as f32
            } else {
                0.0
            }
        };
        Some(AovPicture {
            width: self.width,
            height: self.height,
            albedo: mean(&aovs.albedo),
            normal: mean(&aovs.normal),
            seen_albedo: mean(&aovs.seen_albedo),
            seen_normal: mean(&aovs.seen_normal),
            depth_m: aovs.depth_m.clone(),
            object_id: aovs.object_id.clone(),
            relative_variance: (0..self.squares.len()).map(relative_variance).collect(),
        })
    }

    /// Returns the noise in stops that the scatter of the samples explains: the root mean square of the pixels'
    /// standard errors over the mean luminance. Samples of a pixel are stratified together, so that its error is
    /// smaller: this is an upper bound. None before there are two samples, and for a black picture.
    pub fn noise_stops(&self) -> Option<f64> {
        let (mut mean, mut variance) = (0.0, 0.0);
        for pixel in 0..self.squares.len() {
            let own = self.mean_and_variance(pixel);
            (mean, variance) = (mean + own.0, variance + own.1);
        }
        let pixels = self.squares.len() as f64;
        let relative = (variance / pixels).sqrt() / (mean / pixels);
        (self.samples > 1 && relative.is_finite()).then(|| (1.0 + relative).log2())
    }

    /// Returns the mean luminance of a pixel, and the variance of that by the scatter of the samples; no number before
    /// there are two.
    fn mean_and_variance(&self, pixel: usize) -> (f64, f64) {
        let samples = f64::from(self.samples);
        let rgb: DVec3 = self.layers.iter().map(|layer| self.mean(layer, pixel)).sum();
        let mean = f64::from(luminance(rgb.as_vec3()));
        (mean, (self.squares[pixel].value() / samples - mean * mean).max(0.0) / (samples - 1.0))
    }

    fn per_sample(&self) -> f64 {
        1.0 / f64::from(self.samples.max(1))
    }

    fn mean(&self, layer: &PartLayer, pixel: usize) -> DVec3 {
        value(layer.sums[pixel]) * layer.weight.as_dvec3() * self.per_sample()
    }
}

/// Returns a pixel as it is shown: as in [`Film::develop`], negative noise is black.
fn shown(rgb: DVec3) -> [f32; 3] {
    rgb.as_vec3().max(Vec3::ZERO).to_array()
}

impl PartAovs {
    /// Returns true if mirrors or clear glass show what is not hit first.
    pub fn has_mirrors(&self) -> bool {
        (&self.seen_albedo, &self.seen_normal) != (&self.albedo, &self.normal)
    }

    fn add(&mut self, sample: &AovPicture) {
        // A part has its own size and noise
        let AovPicture {
            width: _,
            height: _,
            albedo,
            normal,
            seen_albedo,
            seen_normal,
            depth_m,
            object_id,
            relative_variance: _,
        } = sample;
        for (sums, values) in self.vectors_mut().into_iter().zip([albedo, normal, seen_albedo, seen_normal]) {
            sums.iter_mut().zip(values).for_each(|(sum, value)| add(sum, *value));
        }
        self.keep_first(depth_m, object_id);
    }

    fn merge(&mut self, other: &PartAovs) {
        let PartAovs { albedo, normal, seen_albedo, seen_normal, depth_m, object_id } = other;
        for (own, others) in self.vectors_mut().into_iter().zip([albedo, normal, seen_albedo, seen_normal]) {
            merge(own, others);
        }
        self.keep_first(depth_m, object_id);
    }

    /// Returns the sums of albedo and normal, of first hits and then of what is seen.
    fn vectors_mut(&mut self) -> [&mut Vec<PixelSum>; 4] {
        [&mut self.albedo, &mut self.normal, &mut self.seen_albedo, &mut self.seen_normal]
    }

    /// Takes over depth and object where the picture's first sample has hit something.
    fn keep_first(&mut self, depth_m: &[f32], object_id: &[u32]) {
        let own = self.depth_m.iter_mut().zip(&mut self.object_id);
        for ((own_depth, own_id), (depth, id)) in own.zip(depth_m.iter().zip(object_id)) {
            if depth.is_finite() {
                (*own_depth, *own_id) = (*depth, *id);
            }
        }
    }
}

fn add(sum: &mut PixelSum, value: [f32; 3]) {
    sum.iter_mut().zip(value).for_each(|(sum, value)| sum.add(value));
}

fn merge(own: &mut [PixelSum], others: &[PixelSum]) {
    for (own, other) in own.iter_mut().zip(others) {
        own.iter_mut().zip(other).for_each(|(own, other)| own.merge(*other));
    }
}

fn value(sum: PixelSum) -> DVec3 {
    DVec3::from_array(sum.map(ExactSum::value))
}
