//! Replicates: independently scrambled estimates, whose scatter is the standard error.

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
            rays: 0,
            nonfinite: NonFiniteReport::default(),
        }
    }

    /// Mean direct illuminance by light sampling.
    fn sampled(&self, layer: usize) -> f64 {
        let (sum, points) = self.direct.get(layer).copied().unwrap_or_default();
        sum / f64::from(points.max(1))
    }

    /// Mean illuminance of a sum over the paths, with the colour of its light.
    fn path_mean(&self, sum: DVec3, rgb: Vec3) -> f64 {
        let mean = sum / f64::from(self.paths.max(1));
        f64::from(luminance(mean.as_vec3() * rgb))
    }

    /// Direct and bounced illuminance of a layer, with the colour of its light.
    fn illuminance(&self, layer: usize, rgb: Vec3) -> (f64, f64) {
        let straight = self.path_mean(self.straight[layer], rgb);
        (self.sampled(layer) + straight, self.path_mean(self.bounced[layer], rgb))
    }
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
    let [direct, bounced, standard_error] = [direct, bounced, error].map(|x| x as f32);
    LightReading { direct, bounced, standard_error, ..blank.clone() }
}

/// Standard error of a light's direct illuminance by light sampling.
pub fn light_sampling_error(replicates: &[Replicate], layer: usize) -> f32 {
    mean_and_error(replicates.iter().map(|replicate| replicate.sampled(layer))).1 as f32
}

/// Standard error of a layer's illuminance by paths.
pub fn path_error(replicates: &[Replicate], layer: usize, rgb: Vec3) -> f32 {
    let by_paths = |r: &Replicate| r.path_mean(r.bounced[layer] + r.straight[layer], rgb);
    mean_and_error(replicates.iter().map(by_paths)).1 as f32
}
