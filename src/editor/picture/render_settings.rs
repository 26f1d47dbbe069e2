//! The settings of the render panel: size, quality and method.

use crate::jobs::{Estimate, Forecast};
use crate::raytrace::{Method, Settings};
use crate::scene::Camera;

/// Part of the noise that the denoiser leaves, at least: a third to a tenth by the README's table, apart from lamps in
/// chrome and hair close up.
const DENOISED_NOISE: f32 = 1.0 / 3.0;

/// The largest number of samples per pixel that can be chosen.
pub const MOST_SAMPLES: u32 = 65_536;

/// The quality of a render: the noise that its picture may have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quality {
    /// To judge the light.
    Draft,
    /// To share.
    Good,
    /// To print.
    Final,
    /// The typed number of samples.
    Custom,
}

impl Quality {
    /// The qualities that are stated as noise, with their labels.
    pub const BY_NOISE: [(Quality, &str); 3] =
        [(Quality::Draft, "Draft"), (Quality::Good, "Good"), (Quality::Final, "Final")];

    /// Returns the noise that the shown picture may have, stops; none for custom.
    pub fn noise_stops(self) -> Option<f32> {
        match self {
            Quality::Draft => Some(0.1),
            Quality::Good => Some(0.03),
            Quality::Final => Some(0.01),
            Quality::Custom => None,
        }
    }

    /// Returns the samples per pixel at most without the denoiser, which parts like hair before a rim light reach; none
    /// for custom.
    fn most_samples(self) -> Option<u32> {
        match self {
            Quality::Draft => Some(16),
            Quality::Good => Some(128),
            Quality::Final => Some(1024),
            Quality::Custom => None,
        }
    }
}

/// Size of the picture, by its longer side or freely.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PictureSize {
    /// The sensor's shape, with this longer side in pixels.
    LongEdge(u32),
    /// Any size; a crop of the sensor where the shape differs.
    Custom(u32, u32),
}

/// The settings of the render panel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RenderSettings {
    /// Size of the picture.
    pub size: PictureSize,
    /// Quality.
    pub quality: Quality,
    /// Samples per pixel, for [`Quality::Custom`].
    pub samples: u32,
    /// Rendering method.
    pub method: Method,
    /// The picture is shown and exported without its noise.
    pub denoise: bool,
}

impl Default for RenderSettings {
    fn default() -> Self {
        RenderSettings {
            size: PictureSize::LongEdge(1080),
            quality: Quality::Draft,
            samples: 64,
            method: Method::Path,
            denoise: true,
        }
    }
}

impl RenderSettings {
    /// Returns width and height, pixels.
    pub fn pixels(&self, camera: &Camera) -> (u32, u32) {
        match self.size {
            PictureSize::LongEdge(edge) => camera.picture_size(edge),
            PictureSize::Custom(width, height) => (width.max(1), height.max(1)),
        }
    }

    /// Returns the traced noise of a picture that is shown with so much, stops.
    pub fn traced_noise_stops(&self, shown_stops: f32) -> f32 {
        if self.denoise { shown_stops / DENOISED_NOISE } else { shown_stops }
    }

    /// Returns the samples per pixel at most: those that leave as much noise in the shown picture with the denoiser as
    /// without it. None for custom.
    pub fn most_samples(&self, quality: Quality) -> Option<u32> {
        let part = if self.denoise { DENOISED_NOISE * DENOISED_NOISE } else { 1.0 };
        quality.most_samples().map(|most| (most as f32 * part).ceil() as u32)
    }

    /// Returns the time from the traced picture to the shown one, seconds.
    pub fn denoiser_s(&self, forecast: &Forecast, pixels: u64) -> f64 {
        if self.denoise { forecast.denoiser_s(pixels) } else { 0.0 }
    }

    /// Returns the estimate of the picture as it is shown, `denoiser_s` seconds after it is traced.
    pub fn shown_estimate(&self, traced: Estimate, denoiser_s: f64) -> Estimate {
        let part = if self.denoise { f64::from(DENOISED_NOISE) } else { 1.0 };
        Estimate { noise_stops: traced.noise_stops * part, seconds: traced.seconds + denoiser_s }
    }

    /// Returns the settings of a render.
    pub(super) fn render_settings(&self, camera: &Camera) -> Settings {
        let (width, height) = self.pixels(camera);
        let noise_stops = self.quality.noise_stops().map(|shown| self.traced_noise_stops(shown));
        let spp = self.most_samples(self.quality).unwrap_or(self.samples.max(1));
        Settings { width, height, method: self.method, spp, noise_stops, aovs: true, ..Settings::default() }
    }
}

/// Returns the name of a method in lists.
pub fn method_label(method: Method) -> &'static str {
    match method {
        Method::Whitted => "Hard shadows, no bounced light",
        Method::Direct => "Direct light only",
        Method::Path => "With bounced light",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_denoiser_takes_a_ninth_of_the_samples_at_three_times_the_noise() {
        let most = |denoise| {
            let settings = RenderSettings { denoise, ..RenderSettings::default() };
            Quality::BY_NOISE.map(|(quality, _)| settings.most_samples(quality))
        };
        assert_eq!(most(false), [16, 128, 1024].map(Some));
        assert_eq!(most(true), [2, 15, 114].map(Some));
        let settings = RenderSettings { denoise: true, ..RenderSettings::default() };
        assert_eq!(settings.most_samples(Quality::Custom), None);
        assert!((settings.traced_noise_stops(0.1) - 0.3).abs() < 1e-6);
    }
}
