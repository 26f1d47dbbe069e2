//! The noise estimate of a tile, from differences between successive blocks of its samples.
//!
//! The samples of a pixel are stratified together: those of a second half fill the gaps of the first, and the means of
//! two halves differ by more than twice the error of the mean of all. With V(n) for the variance of the mean of n
//! samples, and blocks of p and q samples with means A and B,
//!
//! ```text
//! D = (p q / n) E (A - B)2 = p V(p) + q V(q) - n V(n),  n = p + q
//! ```
//!
//! since the weighted squares of A and B exceed that of their weighted mean by (p q / n2) (A - B)2. Without
//! stratification n V(n) is D. With it, n V(n) and D fall as the samples double, the more the smoother what they sample
//! is (Owen 1997, "Scrambled Net Variance for Integrals of Smooth Functions"). How much n V(n) is below D no single
//! difference tells; on the shipped studios it is, within 5 %, as far below as D is below the difference of half the
//! samples. So the estimate is the last difference, reduced once more by the ratio of the last two. With 4, 8, 16 ...
//! 64 samples it is within 10 % of the error on every shipped studio.

use super::stored::stored_fields;
use crate::photo::MIDDLE_GREY;
use std::f64::consts::LN_2;
use std::ops::Range;

/// Mean picture value (8 stops below middle grey) under which a tile is too dark for a noise estimate.
const DARK: f32 = MIDDLE_GREY / 256.0;

/// Samples per pixel from which the noise is estimated: fewer have no two differences.
pub const MIN_ESTIMATE_SPP: u32 = 4;
/// Samples per pixel from which the noise is estimated roughly, by one difference: 0.81 to 1.23 of the error on the
/// shipped studios.
pub const MIN_ROUGH_ESTIMATE_SPP: u32 = 2;
/// Samples per pixel from which the variance of a single pixel is estimated.
pub const MIN_VARIANCE_SPP: u32 = 8;
/// Logarithm of n V(n) over the difference, before a second difference tells how they fall: the mean of the shipped
/// studios.
const FIRST_LOG_RATIO: f64 = -0.30;
/// Factor of this logarithm from a doubling of the samples to the next, as stratification runs out.
const FADING: f64 = 0.75;
/// Weight of an observed ratio of differences beside the expected one: the difference of a tile has noise, too.
const OBSERVED_WEIGHT: f64 = 0.6;
/// Least logarithm of a ratio that counts as observed: a lower one follows a single bright sample.
const LEAST_LOG_RATIO: f64 = -1.2;

/// Sums of exposed luminance of two successive blocks of samples, pixel by pixel, and the differences so far.
#[derive(Clone, Debug)]
pub struct SampleBlocks {
    /// Samples up to the last doubling, and since.
    sums: [Vec<f32>; 2],
    /// Samples per pixel in each block.
    samples: [u32; 2],
    trend: DifferenceTrend,
}

/// What is known of the samples of a pixel.
#[derive(Clone, Copy, Debug)]
pub struct PixelNoise {
    /// Mean exposed luminance.
    pub luminance: f32,
    /// Variance of the mean, divided by the square of the mean; infinite where it is not known.
    pub relative_variance: f32,
}

/// A difference D of two blocks.
#[derive(Clone, Copy, Debug)]
struct BlockDifference {
    value: f64,
    /// Samples per pixel in both.
    samples: f64,
}

/// The differences so far.
#[derive(Clone, Copy, Debug, Default)]
struct DifferenceTrend {
    /// The last one.
    last: Option<BlockDifference>,
    /// Estimated logarithm of n V(n) over it.
    log_ratio: f64,
}

impl SampleBlocks {
    /// Memory of a pixel, bytes.
    pub const BYTES_PER_PIXEL: usize = 2 * size_of::<f32>();

    /// Empty blocks for so many pixels.
    pub fn new(pixels: usize) -> Self {
        SampleBlocks {
            sums: [vec![0.0; pixels], vec![0.0; pixels]],
            samples: [0; 2],
            trend: DifferenceTrend::default(),
        }
    }

    /// Discards all samples.
    pub fn clear(&mut self) {
        self.sums.iter_mut().for_each(|block| block.fill(0.0));
        (self.samples, self.trend) = ([0; 2], DifferenceTrend::default());
    }

    /// Replaces all samples by so many with this noise: in two blocks, or in one if the noise of a pixel is not known.
    pub fn set(&mut self, samples: u32, pixels: &[PixelNoise]) {
        let is_known = samples > 1 && pixels.iter().all(|pixel| pixel.relative_variance.is_finite());
        let first = if is_known { samples / 2 } else { 0 };
        (self.samples, self.trend) = ([first, samples - first], DifferenceTrend::default());
        let [p, q] = self.samples.map(|samples| samples as f32);
        let [before, since] = &mut self.sums;
        for ((before, since), pixel) in before.iter_mut().zip(since).zip(pixels) {
            let PixelNoise { luminance, relative_variance } = *pixel;
            // The difference of the blocks' means of which `relative_variance` makes this variance
            let difference = if is_known { luminance * (p + q) * (relative_variance / (p * q)).sqrt() } else { 0.0 };
            *before = p * luminance + difference * p * q / (p + q);
            *since = q * luminance - difference * p * q / (p + q);
        }
    }

    /// Begins a pass. If the samples have doubled, a new block begins.
    pub fn begin_pass(&mut self) {
        if self.samples[1] < self.samples[0].max(1) {
            return;
        }
        if let Some(difference) = self.difference() {
            self.trend = self.trend.with(difference);
        }
        let [before, since] = &mut self.sums;
        for (before, since) in before.iter_mut().zip(since) {
            *before += std::mem::take(since);
        }
        self.samples = [self.samples[0] + self.samples[1], 0];
    }

    /// Adds a sample's exposed luminance to a pixel.
    #[inline]
    pub fn add(&mut self, pixel: usize, luminance: f32) {
        self.sums[1][pixel] += luminance;
    }

    /// Returns the exposed luminance of a pixel's only sample.
    pub fn first_sample(&self, pixel: usize) -> f32 {
        self.sums[1][pixel]
    }

    /// Returns a copy of some pixels.
    pub fn range(&self, pixels: Range<usize>) -> Self {
        let sums = [0, 1].map(|block| self.sums[block][pixels.clone()].to_vec());
        SampleBlocks { sums, ..*self }
    }

    /// Replaces the pixels from `first` on by those of a copy.
    pub fn set_range(&mut self, first: usize, range: &Self) {
        for (sums, values) in self.sums.iter_mut().zip(&range.sums) {
            sums[first..first + values.len()].copy_from_slice(values);
        }
    }

    /// Counts a pass of `samples` samples of every pixel.
    pub fn finish_pass(&mut self, samples: u32) {
        self.samples[1] += samples;
    }

    /// Returns true if both have the same number of pixels.
    pub fn has_shape_of(&self, other: &Self) -> bool {
        [0, 1].iter().all(|&block| self.sums[block].len() == other.sums[block].len())
    }

    /// Samples per pixel.
    pub fn samples(&self) -> u32 {
        self.samples[0] + self.samples[1]
    }

    /// Mean exposed luminance of all pixels.
    pub fn mean(&self) -> f32 {
        let samples = self.samples() as f32;
        let sum: f32 = self.sums[0].iter().zip(&self.sums[1]).fold(0.0, |sum, (x, y)| sum + (x + y) / samples);
        sum / self.sums[0].len() as f32
    }

    /// Estimates the variance of a pixel's mean, divided by the square of the mean, by the difference of the two blocks.
    /// The estimate is too large, as samples are stratified. Infinite before there are [`MIN_VARIANCE_SPP`] samples, in
    /// both blocks.
    pub fn relative_variance(&self, pixel: usize) -> f32 {
        let [p, q] = self.samples.map(|samples| samples as f32);
        if self.samples() < MIN_VARIANCE_SPP || p == 0.0 || q == 0.0 {
            return f32::INFINITY;
        }
        let [before, since] = [self.sums[0][pixel], self.sums[1][pixel]];
        let difference = before / p - since / q;
        if difference == 0.0 { 0.0 } else { difference.powi(2) * p * q / (before + since).powi(2) }
    }

    /// Estimates the noise: root mean square error of the pixels over the tile's mean exposed luminance, in stops.
    /// Infinite before there are [`MIN_ESTIMATE_SPP`] samples; none for tiles darker than eight stops below middle grey.
    pub fn noise_stops(&self, mean: f32) -> Option<f32> {
        if self.samples() < MIN_ESTIMATE_SPP {
            return Some(f32::INFINITY);
        }
        self.rough_noise_stops(mean)
    }

    /// Estimates the noise as [`SampleBlocks::noise_stops`] does, from [`MIN_ROUGH_ESTIMATE_SPP`] samples on.
    pub fn rough_noise_stops(&self, mean: f32) -> Option<f32> {
        if self.samples() < MIN_ROUGH_ESTIMATE_SPP {
            return Some(f32::INFINITY);
        }
        stops_of(self.variance(), mean)
    }

    /// Predicts the noise after `samples` samples per pixel, at least as many as there are: the variance times samples
    /// falls as its trend says, less and less with each doubling.
    pub fn predicted_noise_stops(&self, samples: u32, mean: f32) -> Option<f32> {
        let now = f64::from(self.samples());
        if self.samples() < MIN_ROUGH_ESTIMATE_SPP {
            return Some(f32::INFINITY);
        }
        let doublings = (f64::from(samples) / now).log2().max(0.0);
        // The sum of FADING^k for k from 1 to the number of doublings
        let faded = FADING * (1.0 - FADING.powf(doublings)) / (1.0 - FADING);
        let variance = self.variance() * (self.current_trend().log_ratio * faded - doublings * LN_2).exp();
        stops_of(variance, mean)
    }

    /// Estimates the mean over the pixels of the variance of their means.
    fn variance(&self) -> f64 {
        self.current_trend().variance(f64::from(self.samples()))
    }

    /// Returns the trend with the difference of the present blocks.
    fn current_trend(&self) -> DifferenceTrend {
        // A block much shorter than the one before it says little
        let [before, since] = self.samples;
        let current = self.difference().filter(|_| 2 * since >= before);
        current.map_or(self.trend, |difference| self.trend.with(difference))
    }

    /// Returns the mean difference of the blocks; none before both have samples.
    fn difference(&self) -> Option<BlockDifference> {
        let [p, q] = self.samples.map(f64::from);
        let (scale_p, scale_q) = (1.0 / self.samples[0] as f32, 1.0 / self.samples[1] as f32);
        let squares = self.sums[0].iter().zip(&self.sums[1]).fold(0.0, |sum, (x, y)| {
            let difference = x * scale_p - y * scale_q;
            sum + f64::from(difference * difference)
        });
        let samples = p + q;
        let value = squares / self.sums[0].len() as f64 * (p * q / samples);
        (p > 0.0 && q > 0.0).then_some(BlockDifference { value, samples })
    }
}

/// Converts the variance of a tile's pixels to stops. None where the mean is too dark.
fn stops_of(variance: f64, mean: f32) -> Option<f32> {
    let rms = variance.sqrt() as f32;
    (mean > DARK).then(|| (1.0 + rms / mean).log2())
}

impl DifferenceTrend {
    /// Returns the trend with a further difference.
    fn with(self, difference: BlockDifference) -> Self {
        let Some(before) = self.last else {
            return DifferenceTrend { last: Some(difference), log_ratio: FIRST_LOG_RATIO };
        };
        let doublings = (difference.samples / before.samples).log2();
        let expected = self.log_ratio * FADING.powf(doublings);
        // Differences without noise say nothing about the ratio
        let is_observed = before.value > 0.0 && difference.value > 0.0;
        let weight = if is_observed { OBSERVED_WEIGHT * doublings } else { 0.0 };
        let observed = ((difference.value / before.value).ln() / doublings).clamp(LEAST_LOG_RATIO, 0.0);
        let log_ratio = if weight > 0.0 { expected + weight * (observed - expected) } else { expected };
        DifferenceTrend { last: Some(difference), log_ratio }
    }

    /// Returns the variance of the mean of n samples.
    fn variance(&self, n: f64) -> f64 {
        let Some(last) = self.last else { return 0.0 };
        let doublings = (n / last.samples).log2();
        last.value * (self.log_ratio * (1.0 + FADING * doublings)).exp() / n
    }
}

stored_fields!(SampleBlocks { sums, samples, trend });
stored_fields!(BlockDifference { value, samples });
stored_fields!(DifferenceTrend { last, log_ratio });

#[cfg(test)]
mod tests {
    use super::*;
    use crate::raytrace::sampler::{Dimensions, Sampler};
    use crate::statistics::TestRng;

    const PIXELS: usize = 1024;

    /// Adds passes of 1, 1, 2, 4 ... up to 16 samples, and returns the mean squared error and the estimate after so
    /// many.
    fn errors(truth: f32, spp: u32, mut sample: impl FnMut(usize, u32) -> f32) -> (f64, f64) {
        let mut blocks = SampleBlocks::new(PIXELS);
        let mut sums = vec![0.0_f64; PIXELS];
        while blocks.samples() < spp {
            let (first, pass) = (blocks.samples(), blocks.samples().clamp(1, 16).min(spp - blocks.samples()));
            blocks.begin_pass();
            for (pixel, sum) in sums.iter_mut().enumerate() {
                for index in first..first + pass {
                    let value = sample(pixel, index);
                    blocks.add(pixel, value);
                    *sum += f64::from(value);
                }
            }
            blocks.finish_pass(pass);
        }
        let mean_square = sums.iter().map(|sum| (sum / f64::from(spp) - f64::from(truth)).powi(2)).sum::<f64>();
        (mean_square / PIXELS as f64, blocks.variance())
    }

    #[test]
    fn the_noise_of_independent_samples_is_that_of_their_mean() {
        let mut rng = TestRng::new(71);
        // The prior expects stratified samples; it is outweighed as samples come. The estimate of 1024 pixels itself
        // has a standard error of 3 %.
        for (spp, lowest) in [(4, 0.7), (8, 0.82), (16, 0.88), (48, 0.88), (64, 0.88), (80, 0.88), (256, 0.88)] {
            let (truth, estimate) = errors(0.5, spp, |_, _| rng.uniform());
            let ratio = (estimate / truth).sqrt();
            assert!(ratio > lowest && ratio < 1.1, "{spp} samples: {ratio} of the error");
        }
    }

    #[test]
    fn the_variance_of_a_pixel_is_that_of_its_mean() {
        let mut rng = TestRng::new(73);
        let mut blocks = SampleBlocks::new(PIXELS);
        assert_eq!(blocks.relative_variance(0), f32::INFINITY);
        for pass in [1, 1, 2, 4, 8, 3] {
            assert_eq!(blocks.relative_variance(0).is_infinite(), blocks.samples() < MIN_VARIANCE_SPP);
            blocks.begin_pass();
            (0..PIXELS * pass).for_each(|sample| blocks.add(sample % PIXELS, 1.0 + rng.uniform()));
            blocks.finish_pass(pass as u32);
        }
        // Nineteen numbers from 1 to 2, of a variance of 1/12; the estimate of 1024 pixels has an error of 5 %
        let estimate = (0..PIXELS).map(|pixel| blocks.relative_variance(pixel)).sum::<f32>() / PIXELS as f32;
        let expected = 1.0 / 12.0 / 19.0 / 1.5_f32.powi(2);
        assert!((estimate / expected - 1.0).abs() < 0.15, "{estimate} for {expected}");
    }

    #[test]
    fn the_noise_of_stratified_samples_was_overstated_by_a_quarter() {
        // A smooth function of stratified numbers, and a random number. With the difference of two halves alone, the
        // estimate would be 1.3 times the error of 4 samples.
        let mut rng = TestRng::new(72);
        for spp in [4, 8, 16, 32, 48, 64] {
            let (truth, estimate) = errors(0.5, spp, |pixel, index| {
                let set = Sampler::new(pixel as u32, 0, index, 1).set(Dimensions::Camera);
                set[0] * set[1] + 0.5 * rng.uniform()
            });
            let ratio = (estimate / truth).sqrt();
            assert!(ratio > 0.85 && ratio < 1.15, "{spp} samples: {ratio} of the error");
        }
    }

    #[test]
    fn the_estimate_is_infinite_before_four_samples_and_none_in_the_dark() {
        let mut blocks = SampleBlocks::new(2);
        let add = |blocks: &mut SampleBlocks, means: [f32; 2]| {
            assert_eq!(blocks.noise_stops(1.0), Some(f32::INFINITY));
            blocks.begin_pass();
            means.into_iter().enumerate().for_each(|(pixel, mean)| blocks.add(pixel, mean));
            blocks.finish_pass(1);
        };
        [[1.5, 0.5], [1.1, 0.9]].into_iter().for_each(|means| add(&mut blocks, means));
        assert!((blocks.mean() - 1.0).abs() < 1e-6 && blocks.samples() == 2);
        // Differences of 0.4: an error of 0.2 of the mean of independent samples, reduced by the first ratio
        let expected = 0.2 * (0.5 * FIRST_LOG_RATIO).exp();
        assert!(
            (blocks.variance().sqrt() / expected - 1.0).abs() < 1e-3,
            "{} for {expected}",
            blocks.variance().sqrt()
        );
        [[1.3, 0.7], [1.3, 0.7]].into_iter().for_each(|means| add(&mut blocks, means));
        assert!(blocks.noise_stops(1.0).is_some_and(|noise| (0.0..1.0).contains(&noise)));
        assert_eq!(blocks.noise_stops(1e-4), None, "too dark");
        blocks.clear();
        assert_eq!(blocks.samples(), 0);
        // Without any difference there is no noise.
        for _ in 0..4 {
            blocks.begin_pass();
            blocks.add(0, 1.0);
            blocks.add(1, 2.0);
            blocks.finish_pass(1);
        }
        assert_eq!(blocks.noise_stops(1.5), Some(0.0));
    }
}
