//! The part of the noisy picture that a denoised one keeps where the network is biased.
//!
//! Where the two differ by more than the noise explains, the rest is bias: blurred edges of lamps in chrome, lost
//! texture. With V for the variance of the noisy picture around a pixel and Q for the mean square of the difference,
//! Q = V + b, where b is the square of the bias, if the denoised picture has no noise of its own. Of all mixtures of the
//! two pictures, that with the part b / (V + b) of the noisy one has the least error. With more and more samples V
//! vanishes and with it the bias.

use crate::color::luminance;
use crate::photo::{AovPicture, Picture};
use glam::Vec3;
use rayon::prelude::*;

/// Pixels around a pixel, to each side, whose variance and difference count, less and less.
const RADIUS: usize = 5;
/// Differences up to so many variances count as noise: estimates of both scatter, and so would the picture if it kept
/// noise by chance.
const EXPLAINED: f32 = 1.5;

/// The part of the noisy picture in each pixel, 0 to 1.
#[derive(Debug)]
pub struct NoisyPart {
    /// Empty where no variance is known: the denoised picture stays as it is.
    parts: Vec<f32>,
}

impl NoisyPart {
    /// Estimates the parts for a picture and its denoised version.
    pub fn new(noisy: &Picture, denoised: &Picture, aovs: &AovPicture) -> Self {
        let (width, height) = (noisy.width as usize, noisy.height as usize);
        let sizes = [noisy.rgb.len(), denoised.rgb.len(), aovs.relative_variance.len()];
        if sizes != [width * height; 3] || aovs.relative_variance.iter().all(|variance| variance.is_infinite()) {
            return NoisyPart { parts: Vec::new() };
        }
        let estimate = |((noisy, denoised), relative): ((&[f32; 3], &[f32; 3]), &f32)| {
            let [noisy, denoised] = [noisy, denoised].map(|rgb| luminance(Vec3::from(*rgb)));
            let variance = if relative.is_finite() { relative * noisy * noisy } else { f32::INFINITY };
            [variance, (denoised - noisy).powi(2)]
        };
        let pixels = noisy.rgb.par_iter().zip(&denoised.rgb).zip(&aovs.relative_variance);
        let around = smoothed(&pixels.map(estimate).collect::<Vec<_>>(), width, height);
        NoisyPart { parts: around.par_iter().map(|[variance, square]| part(square / variance)).collect() }
    }

    /// Mixes the noisy picture into the denoised one. Layers of a picture have its parts.
    pub fn mix(&self, denoised: &mut Picture, noisy: &Picture) {
        let pixels = denoised.rgb.par_iter_mut().zip(&noisy.rgb).zip(&self.parts);
        pixels.filter(|(_, part)| **part > 0.0).for_each(|((denoised, noisy), part)| {
            *denoised = Vec3::from(*denoised).lerp(Vec3::from(*noisy), *part).to_array();
        });
    }
}

/// Returns the part of the noisy picture where the mean square of the differences is so many variances. None for NaN.
fn part(ratio: f32) -> f32 {
    let squared_bias = (ratio - EXPLAINED).max(0.0);
    1.0 - 1.0 / (1.0 + squared_bias)
}

/// Returns weighted means around each pixel, over rows and then over columns, with weights that fall linearly.
fn smoothed(values: &[[f32; 2]], width: usize, height: usize) -> Vec<[f32; 2]> {
    let mean = |length: usize, at: usize, value: &dyn Fn(usize) -> [f32; 2]| {
        let (mut sums, mut weights) = ([0.0; 2], 0.0);
        for index in at.saturating_sub(RADIUS)..(at + RADIUS + 1).min(length) {
            let weight = (RADIUS + 1 - index.abs_diff(at)) as f32;
            let value = value(index);
            sums = [0, 1].map(|i| sums[i] + weight * value[i]);
            weights += weight;
        }
        sums.map(|sum| sum / weights)
    };
    let pixels = || (0..width * height).into_par_iter().map(|pixel| (pixel % width, pixel / width));
    let rows: Vec<_> = pixels().map(|(x, y)| mean(width, x, &|x| values[y * width + x])).collect();
    pixels().map(|(x, y)| mean(height, y, &|y| rows[y * width + x])).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture(width: u32, height: u32, value: impl Fn(u32) -> f32) -> Picture {
        Picture { width, height, rgb: (0..width * height).map(|pixel| [value(pixel); 3]).collect() }
    }

    fn with_variance(picture: &Picture, relative_variance: f32) -> AovPicture {
        let (width, height) = (picture.width, picture.height);
        AovPicture { relative_variance: vec![relative_variance; picture.rgb.len()], ..AovPicture::new(width, height) }
    }

    /// Returns the mixture of two pictures.
    fn mixture(noisy: &Picture, denoised: &Picture, aovs: &AovPicture) -> Picture {
        let mut mixed = denoised.clone();
        NoisyPart::new(noisy, denoised, aovs).mix(&mut mixed, noisy);
        mixed
    }

    #[test]
    fn differences_that_noise_explains_leave_the_denoised_picture_as_it_is() {
        let denoised = picture(20, 10, |_| 1.0);
        let noisy = picture(20, 10, |pixel| if pixel % 2 == 0 { 1.1 } else { 0.9 });
        assert_eq!(mixture(&noisy, &denoised, &with_variance(&noisy, 0.01)), denoised);
        // Without a known variance all of it counts as noise
        assert_eq!(mixture(&noisy, &denoised, &with_variance(&noisy, f32::INFINITY)), denoised);
        assert_eq!(mixture(&noisy, &denoised, &AovPicture::default()), denoised);
    }

    #[test]
    fn bias_is_mixed_with_noise_for_the_least_error() {
        // The denoised picture is 0.3 too dark, the noisy one has a standard error of 0.1: nine variances, of which one
        // and a half count as noise
        let denoised = picture(20, 10, |_| 0.7);
        let noisy = picture(20, 10, |_| 1.0);
        let mixed = mixture(&noisy, &denoised, &with_variance(&noisy, 0.01));
        let expected = 0.7 + 0.3 * 7.5 / 8.5;
        assert!(mixed.rgb.iter().flatten().all(|value| (value - expected).abs() < 1e-4), "{:?}", mixed.rgb[0]);
        // Without noise the noisy picture is the true one
        assert_eq!(mixture(&noisy, &denoised, &with_variance(&noisy, 0.0)), noisy);
    }

    #[test]
    fn what_is_far_away_or_no_number_does_not_count() {
        let denoised = picture(40, 1, |_| 1.0);
        // An edge that the network has lost, at one end
        let mut noisy = picture(40, 1, |pixel| if pixel < 4 { 2.0 } else { 1.0 });
        let aovs = with_variance(&noisy, 1e-4);
        let mixed = mixture(&noisy, &denoised, &aovs);
        assert!(mixed.rgb[0][0] > 1.9 && mixed.rgb[2][0] > 1.9, "{:?}", mixed.rgb);
        assert_eq!(mixed.rgb[12..], denoised.rgb[12..]);
        noisy.rgb[30] = [f32::NAN; 3];
        assert_eq!(mixture(&noisy, &denoised, &aovs).rgb[20..], denoised.rgb[20..]);
        assert_eq!(part(f32::NAN), 0.0);
        assert_eq!(part(f32::INFINITY), 1.0);
    }
}
