//! Forecasts of a render's time and noise, from one render of the same studio.
//!
//! Time grows with samples and pixels. Noise falls with the square root of the samples, or faster for stratified
//! samples: the exponent is measured. A render that ends by its noise takes more samples where there is more of it, so
//! a forecast knows the noise of each tile.

use crate::raytrace::{Film, NoiseTarget};

/// Time and noise of a render.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// Time from the start to the finished picture, seconds.
    pub seconds: f64,
    /// Noise of a pixel relative to the brightness around it, stops: the median of the tiles.
    pub noise_stops: f64,
}

/// Measured cost and noise of a studio's picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Forecast {
    /// Time to build BVHs and tables, seconds.
    build_s: f64,
    /// Pixel samples per second, all threads.
    samples_s: f64,
    /// The tiles that are bright enough for an estimate, by error.
    tiles: Vec<TileError>,
    /// Part of the tiles that are too dark for one.
    dark: f64,
    /// The error falls with the samples to the power of minus this.
    convergence: f64,
    /// Time of the denoiser for a pixel, seconds.
    denoiser_s: f64,
}

/// Error of the pixels of a tile.
#[derive(Clone, Copy, Debug, PartialEq)]
struct TileError {
    /// Relative to the brightness.
    error: f64,
    /// Samples per pixel.
    spp: f64,
}

impl TileError {
    fn at(&self, spp: f64, convergence: f64) -> f64 {
        self.error * (self.spp / spp.max(1.0)).powf(convergence)
    }

    /// Returns the samples per pixel at which the error is this small.
    fn spp_for(&self, error: f64, convergence: f64) -> f64 {
        self.spp * (self.error / error).powf(1.0 / convergence)
    }
}

/// Range of the exponent: that of independent samples, and the best that stratified samples reach in practice.
const CONVERGENCE: [f64; 2] = [0.5, 0.8];

impl Forecast {
    /// Returns the forecast from one render that took `trace_s` seconds. None if nothing was traced, if the picture is
    /// black, and if it has too few samples for an estimate of its noise.
    pub fn from_render(build_s: f64, trace_s: f64, film: &Film) -> Option<Self> {
        let noise = film.tile_noise();
        let error = |(spp, noise): (u32, Option<f32>)| {
            noise.map(|noise| TileError { error: relative_error(noise), spp: spp.into() })
        };
        let tiles = noise.iter().copied().filter_map(error).collect();
        let samples = film.mean_spp() * f64::from(film.width()) * f64::from(film.height());
        Self::new(build_s, samples / trace_s, tiles, noise.len())
    }

    fn new(build_s: f64, samples_s: f64, mut tiles: Vec<TileError>, count: usize) -> Option<Self> {
        let is_known = |tile: &TileError| tile.error.is_finite() && tile.spp > 0.0;
        let has_noise = tiles.iter().any(|tile| tile.error > 0.0);
        let is_timed = samples_s > 0.0 && samples_s.is_finite();
        if !has_noise || !is_timed || !tiles.iter().all(is_known) {
            return None;
        }
        let convergence = CONVERGENCE[0];
        tiles.sort_by(|a, b| a.at(1.0, convergence).total_cmp(&b.at(1.0, convergence)));
        let dark = 1.0 - tiles.len() as f64 / count as f64;
        Some(Forecast { build_s, samples_s, tiles, dark, convergence, denoiser_s: 0.0 })
    }

    /// Returns the noise of the render, stops: the median of its tiles.
    pub fn noise_stops(&self) -> f64 {
        let mut errors: Vec<f64> = self.tiles.iter().map(|tile| tile.error).collect();
        median_stops(&mut errors)
    }

    /// Measures the convergence from the noise after the first `spp` samples.
    pub(super) fn with_noise_at(self, spp: u32, noise_stops: f32) -> Self {
        let median = self.tiles[self.tiles.len() / 2];
        let exponent = (relative_error(noise_stops) / median.error).ln() / (median.spp / f64::from(spp.max(1))).ln();
        let [slowest, fastest] = CONVERGENCE;
        let convergence = if exponent.is_finite() { exponent.clamp(slowest, fastest) } else { slowest };
        Forecast { convergence, ..self }
    }

    /// Takes over what a pilot measures and a render does not: the convergence, and the denoiser's time.
    pub(super) fn with_pilot(self, pilot: Option<&Forecast>) -> Self {
        let Some(&Forecast { convergence, denoiser_s, .. }) = pilot else { return self };
        Forecast { convergence, denoiser_s, ..self }
    }

    /// Takes over the denoiser's time for a pixel, seconds.
    pub(super) fn with_denoiser(self, seconds: f64) -> Self {
        Forecast { denoiser_s: seconds, ..self }
    }

    /// Returns the denoiser's time for a picture of so many pixels, seconds; 0 if it is not known.
    pub fn denoiser_s(&self, pixels: u64) -> f64 {
        self.denoiser_s * pixels as f64
    }

    /// Returns time and noise of a render of `pixels` pixels with `spp` samples each.
    pub fn estimate(&self, pixels: u64, spp: u32) -> Estimate {
        self.estimate_by(pixels, f64::from(spp), &|_| f64::from(spp))
    }

    /// Returns the samples per pixel that a render of `pixels` pixels takes in so many seconds, at most; 0 where one of
    /// every pixel takes longer.
    pub fn samples_in(&self, pixels: u64, seconds: f64) -> u32 {
        ((seconds - self.build_s) * self.samples_s / pixels.max(1) as f64).max(0.0) as u32
    }

    /// Returns time and noise of a render of `pixels` pixels that ends when each tile has no more noise than `target`, or
    /// so many samples.
    pub fn estimate_by_noise(&self, pixels: u64, target: NoiseTarget, most_spp: u32) -> Estimate {
        let least = f64::from(target.least_spp());
        let error = relative_error(target.limit_stops());
        let most = f64::from(most_spp).max(least);
        self.estimate_by(pixels, least, &|tile| tile.spp_for(error, self.convergence).clamp(least, most))
    }

    /// Returns the estimate for samples per pixel by tile, and for dark tiles.
    fn estimate_by(&self, pixels: u64, dark_spp: f64, spp: &dyn Fn(&TileError) -> f64) -> Estimate {
        let samples: f64 = self.tiles.iter().map(spp).sum::<f64>() / self.tiles.len() as f64;
        let samples = samples * (1.0 - self.dark) + dark_spp * self.dark;
        let mut errors: Vec<f64> = self.tiles.iter().map(|tile| tile.at(spp(tile), self.convergence)).collect();
        Estimate {
            seconds: self.build_s + pixels as f64 * samples / self.samples_s,
            noise_stops: median_stops(&mut errors),
        }
    }
}

/// Returns the median of relative errors, which are at least one, in stops.
fn median_stops(errors: &mut [f64]) -> f64 {
    errors.sort_by(f64::total_cmp);
    (1.0 + errors[errors.len() / 2]).log2()
}

fn relative_error(noise_stops: f32) -> f64 {
    f64::from(noise_stops).exp2() - 1.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::raytrace::Settings;

    fn forecast(noise_stops: &[f32], spp: u32) -> Option<Forecast> {
        let tile = |&noise: &f32| TileError { error: relative_error(noise), spp: spp.into() };
        Forecast::new(0.5, 80_000.0, noise_stops.iter().map(tile).collect(), noise_stops.len())
    }

    fn target(noise_stops: f32) -> NoiseTarget {
        NoiseTarget::of(&Settings { noise_stops: Some(noise_stops), ..Settings::default() }).unwrap()
    }

    fn error(estimate: Estimate) -> f64 {
        estimate.noise_stops.exp2() - 1.0
    }

    #[test]
    fn four_times_the_samples_take_four_times_as_long_and_halve_the_noise() {
        let forecast = forecast(&[0.2], 16).unwrap();
        let same = forecast.estimate(10_000, 16);
        assert!((same.seconds - 2.5).abs() < 1e-9 && (same.noise_stops - 0.2).abs() < 1e-6);
        let four = forecast.estimate(10_000, 64);
        assert!((four.seconds - 8.5).abs() < 1e-9);
        assert!((error(four) / error(same) - 0.5).abs() < 1e-9);
        // 3 s less the half second of preparation are 20 samples of every pixel
        assert_eq!([0.1, 0.6, 3.0].map(|seconds| forecast.samples_in(10_000, seconds)), [0, 0, 20]);
        assert_eq!(forecast.denoiser_s(1000), 0.0);
        let denoised = forecast.clone().with_denoiser(0.002);
        assert_eq!([&denoised, &forecast.clone().with_pilot(Some(&denoised))].map(|f| f.denoiser_s(1000)), [2.0; 2]);
        let faster = forecast.clone().with_noise_at(4, 0.5).estimate(10_000, 64);
        assert!(faster.noise_stops < four.noise_stops, "samples that converged faster at first do so later");
        assert_eq!(forecast.with_noise_at(4, f32::INFINITY).convergence, CONVERGENCE[0]);
    }

    #[test]
    fn noisy_tiles_take_the_samples_that_a_noise_limit_needs() {
        // Half of the tiles have a quarter of the noise of the others
        let [quiet, noisy] = [0.05, 0.2].map(|error: f32| (1.0 + error).log2());
        let forecast = forecast(&[quiet, noisy], 16).unwrap();
        let estimate = forecast.estimate_by_noise(10_000, target((1.1_f32).log2()), 1024);
        // 64 samples for the noisy ones; the quiet ones have less noise than that after the least number, 8
        assert!((estimate.seconds - 0.5 - 10_000.0 * 36.0 / 80_000.0).abs() < 1e-3, "{estimate:?}");
        assert!((error(estimate) - 0.1).abs() < 1e-4, "{estimate:?}");
        let capped = forecast.estimate_by_noise(10_000, target((1.1_f32).log2()), 16);
        assert!((capped.seconds - 0.5 - 10_000.0 * 12.0 / 80_000.0).abs() < 1e-3, "{capped:?}");
        let even = forecast.estimate(10_000, 64);
        assert!(even.seconds > 1.6 * estimate.seconds && error(even) < 0.1 + 1e-4);
    }

    #[test]
    fn renders_without_light_or_noise_estimate_have_no_forecast() {
        assert_eq!(forecast(&[f32::INFINITY], 1), None, "one sample has no noise estimate");
        assert_eq!(forecast(&[], 16), None, "all is black");
        assert_eq!(Forecast::new(0.5, f64::INFINITY, vec![TileError { error: 0.1, spp: 1.0 }], 1), None);
    }
}
