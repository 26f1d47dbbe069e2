//! Replicates: independently scrambled estimates, whose scatter is the standard error.

use super::photons::PhotonSum;
use crate::color::luminance;
use crate::photo::meter::LightReading;
use crate::raytrace::film::NonFiniteReport;
use glam::{DVec3, Vec3};

/// Number of replicates: enough to estimate their scatter to a fifth, few enough for good stratification of each.
pub const REPLICATES: u32 = 16;

/// The sums of one replicate.
#[derive(Debug)]
pub struct Replicate {
    /// Its index.
    pub index: u32,
    /// Sum of the direct illuminance from sampled points of each light, and their number.
    pub direct: Vec<(f64, u32)>,
    /// Sum of the light that arrives along the paths after a bounce, for each layer.
    pub bounced: Vec<DVec3>,
    /// Sum of the light that arrives along the paths without a bounce, for each layer.
    pub straight: Vec<DVec3>,
    /// Number of paths.
    pub paths: u32,
    /// Sum of the light of photons at the receptor, for each layer.
    pub caustic: Vec<PhotonSum>,
    /// Number of emitted photons.
    pub photons: u32,
    /// Rays traced.
    pub rays: u64,
    /// Discarded non-finite contributions.
    pub nonfinite: NonFiniteReport,
}

impl Replicate {
    /// An empty replicate for so many lights.
    pub fn new(index: u32, lights: usize) -> Self {
        let zero = vec![DVec3::ZERO; lights + 1];
        Replicate {
            index,
            direct: vec![(0.0, 0); lights],
            bounced: zero.clone(),
            straight: zero,
            paths: 0,
            caustic: vec![PhotonSum::default(); lights + 1],
            photons: 0,
            rays: 0,
            nonfinite: NonFiniteReport::default(),
        }
    }

    /// Mean direct illuminance by light sampling.
    fn sampled(&self, layer: usize) -> f64 {
        let (sum, points) = self.direct.get(layer).copied().unwrap_or_default();
        sum / f64::from(points.max(1))
    }

    /// Mean direct illuminance along the paths, with the colour of the light.
    fn straight_mean(&self, layer: usize, rgb: Vec3) -> f64 {
        mean(self.straight[layer], self.paths, rgb)
    }

    /// Mean bounced illuminance along the paths and by photons, with the colour of the light.
    fn bounced_mean(&self, layer: usize, rgb: Vec3) -> f64 {
        mean(self.bounced[layer], self.paths, rgb) + mean(self.caustic[layer].illuminance, self.photons, rgb)
    }

    /// Direct and bounced illuminance of a layer, with the colour of its light.
    fn illuminance(&self, layer: usize, rgb: Vec3) -> (f64, f64) {
        (self.sampled(layer) + self.straight_mean(layer, rgb), self.bounced_mean(layer, rgb))
    }
}

/// Luminance of the mean of a sum over so many samples, with the colour of its light.
fn mean(sum: DVec3, count: u32, rgb: Vec3) -> f64 {
    let mean = sum / f64::from(count.max(1));
    f64::from(luminance(mean.as_vec3() * rgb))
}

/// Mean of the replicates' values, and its standard error.
fn mean_and_error(values: impl Iterator<Item = f64> + Clone) -> (f64, f64) {
    let n = f64::from(REPLICATES);
    let mean = values.clone().sum::<f64>() / n;
    let square = values.map(|v| (v - mean) * (v - mean)).sum::<f64>();
    (mean, (square / (n * (n - 1.0))).sqrt())
}

/// The reading of a layer, from a blank one.
pub fn reading(blank: &LightReading, rgb: Vec3, layer: usize, replicates: &[Replicate]) -> LightReading {
    let both = replicates.iter().map(|replicate| replicate.illuminance(layer, rgb));
    let (direct, _) = mean_and_error(both.clone().map(|(direct, _)| direct));
    let (bounced, _) = mean_and_error(both.clone().map(|(_, bounced)| bounced));
    let (_, error) = mean_and_error(both.map(|(direct, bounced)| direct + bounced));
    // Where nothing is found, a caustic may be missed for which one photon more would have been found.
    let missed = illuminance_of_one_photon(replicates, layer, rgb);
    let error = if direct + bounced < missed { error.max(missed) } else { error };
    let [direct, bounced, standard_error] = [direct, bounced, error].map(|x| x as f32);
    LightReading { direct, bounced, standard_error, ..blank.clone() }
}

/// Illuminance of a layer that one photon more at the receptor would have added.
fn illuminance_of_one_photon(replicates: &[Replicate], layer: usize, rgb: Vec3) -> f64 {
    let sum = replicates.iter().fold(PhotonSum::default(), |sum, replicate| sum.plus(&replicate.caustic[layer]));
    let emitted: u32 = replicates.iter().map(|replicate| replicate.photons).sum();
    f64::from(luminance(sum.illuminance_of_one(emitted).as_vec3() * rgb))
}

/// Standard error of a light's direct illuminance by light sampling.
pub fn light_sampling_error(replicates: &[Replicate], layer: usize) -> f32 {
    mean_and_error(replicates.iter().map(|replicate| replicate.sampled(layer))).1 as f32
}

/// Standard error of a layer's illuminance by paths and photons.
pub fn path_error(replicates: &[Replicate], layer: usize, rgb: Vec3) -> f32 {
    let by_paths = |r: &Replicate| r.straight_mean(layer, rgb) + r.bounced_mean(layer, rgb);
    let (mean, error) = mean_and_error(replicates.iter().map(by_paths));
    let missed = illuminance_of_one_photon(replicates, layer, rgb);
    let direct = replicates.iter().map(|r| r.sampled(layer)).sum::<f64>();
    if mean + direct < missed { error.max(missed) as f32 } else { error as f32 }
}
