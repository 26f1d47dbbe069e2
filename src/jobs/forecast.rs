//! Forecasts of a render's time and noise, from one render of the same studio.
//!
//! Time grows with samples and pixels. Noise falls with the square root of the samples, or faster for stratified
//! samples: the exponent is measured.

/// Time and noise of a render.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// Time from the start to the finished picture, seconds.
    pub seconds: f64,
    /// Noise of a pixel relative to the brightness around it, stops.
    pub noise_stops: f64,
}

/// Measured cost and noise of a studio's picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Forecast {
    /// Time to build BVHs and tables, seconds.
    build_s: f64,
    /// Pixel samples per second, all threads.
    samples_s: f64,
    /// Relative error of a pixel with `spp` samples.
    error: f64,
    spp: f64,
    /// The error falls with the samples to the power of minus this.
    convergence: f64,
}

/// Range of the exponent: that of independent samples, and the best that stratified samples reach in practice.
const CONVERGENCE: [f64; 2] = [0.5, 0.8];

impl Forecast {
    /// Returns the forecast from one render: `spp` samples of `pixels` pixels took `trace_s` seconds and left this
    /// noise. None if nothing was traced or the picture is black.
    pub fn from_render(build_s: f64, trace_s: f64, pixels: u64, spp: u32, noise_stops: f32) -> Option<Self> {
        let (samples, error) = (pixels as f64 * f64::from(spp), relative_error(noise_stops));
        let is_known = samples > 0.0 && trace_s > 0.0 && error > 0.0 && error.is_finite();
        let (samples_s, spp, convergence) = (samples / trace_s, spp.into(), CONVERGENCE[0]);
        is_known.then_some(Forecast { build_s, samples_s, error, spp, convergence })
    }

    /// Measures the convergence from the noise after the first `spp` samples.
    pub(super) fn with_noise_at(self, spp: u32, noise_stops: f32) -> Self {
        let exponent = (relative_error(noise_stops) / self.error).ln() / (self.spp / f64::from(spp.max(1))).ln();
        let [slowest, fastest] = CONVERGENCE;
        let convergence = if exponent.is_finite() { exponent.clamp(slowest, fastest) } else { slowest };
        Forecast { convergence, ..self }
    }

    /// Takes over the convergence of another forecast.
    pub(super) fn with_convergence_of(self, other: Option<&Forecast>) -> Self {
        Forecast { convergence: other.map_or(CONVERGENCE[0], |known| known.convergence), ..self }
    }

    /// Returns time and noise of a render of `pixels` pixels with `spp` samples each.
    pub fn estimate(&self, pixels: u64, spp: u32) -> Estimate {
        let error = self.error * (self.spp / f64::from(spp.max(1))).powf(self.convergence);
        Estimate {
            seconds: self.build_s + pixels as f64 * f64::from(spp) / self.samples_s,
            noise_stops: (1.0 + error).log2(),
        }
    }
}

fn relative_error(noise_stops: f32) -> f64 {
    f64::from(noise_stops).exp2() - 1.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn four_times_the_samples_take_four_times_as_long_and_halve_the_noise() {
        let forecast = Forecast::from_render(0.5, 2.0, 10_000, 16, 0.2).unwrap();
        let same = forecast.estimate(10_000, 16);
        assert!((same.seconds - 2.5).abs() < 1e-9 && (same.noise_stops - 0.2).abs() < 1e-6);
        let four = forecast.estimate(10_000, 64);
        assert!((four.seconds - 8.5).abs() < 1e-9);
        let error = |estimate: Estimate| estimate.noise_stops.exp2() - 1.0;
        assert!((error(four) / error(same) - 0.5).abs() < 1e-9);
        let faster = forecast.with_noise_at(4, 0.5).estimate(10_000, 64);
        assert!(faster.noise_stops < four.noise_stops, "samples that converged faster at first do so later");
        assert_eq!(forecast.with_noise_at(4, f32::INFINITY).convergence, CONVERGENCE[0]);
        assert_eq!(Forecast::from_render(0.5, 2.0, 10_000, 1, f32::INFINITY), None, "one sample has no noise estimate");
        assert_eq!(Forecast::from_render(0.5, 0.0, 10_000, 16, 0.2), None);
    }
}
