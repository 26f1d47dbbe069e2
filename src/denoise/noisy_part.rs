//! The part of the noisy picture that a denoised one keeps where the network is biased.
//!
//! Where the two differ by more than the noise explains, the rest is bias: blurred edges of lamps in chrome, lost
//! texture. With V for the variance of the noisy picture around a pixel and Q for the mean square of the difference,
//! Q = V + b, where b is the square of the bias, if the denoised picture has no noise of its own. Of all mixtures of the
//! two pictures, that with the part b / (V + b) of the noisy one has the least error. With more and more samples V
//! vanishes and with it the bias.
//!
//! A single bright sample has a large difference, and its variance may be small by chance. So a pixel has at least the
//! relative variance of its neighbourhood, and both halves of the neighbouring pixels must tell of bias: the lower one
//! of their estimates counts. Where the difference is little more than the noise, it counts in part: by chance, some
//! pixels of any large picture differ by twice the variance, and would be specks on skin.

use crate::color::luminance;
use crate::photo::{AovPicture, Picture};
use glam::Vec3;
use rayon::prelude::*;

/// Pixels around a pixel, to each side, whose variance and difference count, less and less.
const RADIUS: usize = 5;
/// Mean square difference over the variance up to which nothing counts as bias, and from which all that the noise does
/// not explain does.
const DOUBTFUL: f32 = 1.25;
const SURE: f32 = 2.25;
/// The estimates of a pixel of which nothing is known, or that is no number: all of it counts as noise.
const UNKNOWN: [f32; 3] = [f32::INFINITY, 1.0, 0.0];

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
        // Estimate the variance, the square of the luminance and the square of the difference
        let estimate = |((noisy, denoised), relative): ((&[f32; 3], &[f32; 3]), &f32)| {
            let [noisy, denoised] = [noisy, denoised].map(|rgb| luminance(Vec3::from(*rgb)));
            let (variance, square) = (relative * noisy * noisy, (denoised - noisy).powi(2));
            if variance.is_finite() && square.is_finite() { [variance, noisy * noisy, square] } else { UNKNOWN }
        };
        let pixels = noisy.rgb.par_iter().zip(&denoised.rgb).zip(&aovs.relative_variance);
        let estimates: Vec<_> = pixels.map(estimate).collect();

        // Sort variance and difference by the halves of the neighbouring pixels
        let around = smoothed(&estimates, width, height);
        let in_halves = |(pixel, (estimate, around)): (usize, (&[f32; 3], &[f32; 3]))| {
            let [variance, luminance_square, square] = *estimate;
            let least_variance = around[0] / around[1] * luminance_square;
            let values = [variance.max(least_variance), square];
            // Lines along rows, columns and diagonals have pixels of both halves
            let (x, y) = (pixel % width, pixel / width);
            if (x + y / 2) % 2 == 0 { [values[0], values[1], 0.0, 0.0] } else { [0.0, 0.0, values[0], values[1]] }
        };
        let halves: Vec<_> = estimates.par_iter().zip(&around).enumerate().map(in_halves).collect();
        let part_of = |[variance, square, other_variance, other_square]: &[f32; 4]| {
            part((square / variance).min(other_square / other_variance))
        };
        NoisyPart { parts: smoothed(&halves, width, height).par_iter().map(part_of).collect() }
    }

    /// Mixes the noisy picture into the denoised one. Layers of a picture have its parts.
    pub fn mix(&self, denoised: &mut Picture, noisy: &Picture) {
        let pixels = denoised.rgb.par_iter_mut().zip(&noisy.rgb).zip(&self.parts);
        pixels.filter(|(_, part)| **part > 0.0).for_each(|((denoised, noisy), part)| {
            *denoised = Vec3::from(*denoised).lerp(Vec3::from(*noisy), *part).to_array();
        });
    }
}

/// Returns the part of the noisy picture where the mean square of the differences is so many variances; 0 for NaN.
fn part(ratio: f32) -> f32 {
    let ratio = ratio.max(1.0);
    let squared_bias = ratio - 1.0;
    let certainty = ((ratio - DOUBTFUL) / (SURE - DOUBTFUL)).clamp(0.0, 1.0);
    certainty * (1.0 - 1.0 / (1.0 + squared_bias))
}

/// Returns weighted means around each pixel, over rows and then over columns, with weights that fall linearly.
fn smoothed<const N: usize>(values: &[[f32; N]], width: usize, height: usize) -> Vec<[f32; N]> {
    let add = |sum: &mut [f32; N], value: &[f32; N], weight: f32| {
        sum.iter_mut().zip(value).for_each(|(sum, value)| *sum += weight * value);
    };
    let mut rows = vec![[0.0; N]; values.len()];
    rows.par_chunks_mut(width).zip(values.par_chunks(width)).for_each(|(sums, row)| {
        for (x, sum) in sums.iter_mut().enumerate() {
            weights_around(x, width).for_each(|(x, weight)| add(sum, &row[x], weight));
        }
    });
    let mut means = vec![[0.0; N]; values.len()];
    means.par_chunks_mut(width).enumerate().for_each(|(y, sums)| {
        for (y, weight) in weights_around(y, height) {
            sums.iter_mut().zip(&rows[y * width..]).for_each(|(sum, value)| add(sum, value, weight));
        }
    });
    means
}

/// Returns the positions around one on an axis of `length` pixels, with weights that sum to one.
fn weights_around(position: usize, length: usize) -> impl Iterator<Item = (usize, f32)> {
    let range = position.saturating_sub(RADIUS)..(position + RADIUS + 1).min(length);
    let weight = move |index: usize| (RADIUS + 1 - index.abs_diff(position)) as f32;
    let sum: f32 = range.clone().map(weight).sum();
    range.map(move |index| (index, weight(index) / sum))
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
        let noisy = picture(20, 10, |pixel| if pixel % 2 == 0 { 1.09 } else { 0.91 });
        assert_eq!(mixture(&noisy, &denoised, &with_variance(&noisy, 0.01)), denoised);
        // Without a known variance all of it counts as noise
        assert_eq!(mixture(&noisy, &denoised, &with_variance(&noisy, f32::INFINITY)), denoised);
        assert_eq!(mixture(&noisy, &denoised, &AovPicture::default()), denoised);
    }

    #[test]
    fn bias_is_mixed_with_noise_for_the_least_error() {
        // The denoised picture is 0.3 too dark, the noisy one has a standard error of 0.1: nine variances, one of noise
        let denoised = picture(20, 10, |_| 0.7);
        let noisy = picture(20, 10, |_| 1.0);
        let mixed = mixture(&noisy, &denoised, &with_variance(&noisy, 0.01));
        let expected = 0.7 + 0.3 * 8.0 / 9.0;
        assert!(mixed.rgb.iter().flatten().all(|value| (value - expected).abs() < 1e-4), "{:?}", mixed.rgb[0]);
        // Without noise the noisy picture is the true one
        assert_eq!(mixture(&noisy, &denoised, &with_variance(&noisy, 0.0)), noisy);
    }

    #[test]
    fn differences_little_above_the_noise_leave_the_denoised_picture_as_it_is() {
        let denoised = picture(20, 10, |_| 1.0);
        let noisy = |error: f32| picture(20, 10, |pixel| if pixel % 2 == 0 { 1.0 + error } else { 1.0 - error });
        // 1.2 variances
        let noise = noisy(0.1 * 1.2_f32.sqrt());
        assert_eq!(mixture(&noise, &denoised, &with_variance(&noise, 0.01)), denoised);
        // The part grows without steps
        assert!(part(DOUBTFUL + 1e-3) < 1e-3 && (part(SURE - 1e-3) - part(SURE)).abs() < 1e-3);
    }

    #[test]
    fn a_single_bright_sample_is_no_bias() {
        // Both blocks of its samples happen to be the same
        let denoised = picture(21, 21, |_| 1.0);
        let (middle, mut noisy) = (10 * 21 + 10, denoised.clone());
        noisy.rgb[middle] = [20.0; 3];
        let mut aovs = with_variance(&noisy, 0.01);
        aovs.relative_variance[middle] = 0.0;
        assert_eq!(mixture(&noisy, &denoised, &aovs), denoised);
    }

    #[test]
    fn lines_that_the_network_has_lost_come_back() {
        let denoised = picture(31, 31, |_| 1.0);
        let is_line: [fn(u32, u32) -> bool; 4] = [|x, _| x == 15, |_, y| y == 15, |x, y| x == y, |x, y| x + y == 30];
        for is_line in is_line {
            let noisy = picture(31, 31, |pixel| if is_line(pixel % 31, pixel / 31) { 2.0 } else { 1.0 });
            let mixed = mixture(&noisy, &denoised, &with_variance(&noisy, 1e-4));
            let on_line = (0..961).filter(|pixel| is_line(pixel % 31, pixel / 31));
            assert!(on_line.into_iter().all(|pixel| mixed.rgb[pixel as usize][0] > 1.9));
        }
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
