//! The noise estimate of a tile, from two halves of its samples.

/// Mean picture value (8 stops below middle grey) under which a tile is too dark for a noise estimate.
const DARK: f32 = 0.18 / 256.0;

/// Sums of exposed luminance of two disjoint halves of the samples, pixel by pixel.
///
/// The difference of the halves' means estimates the variance of the mean of all samples, without assumptions on how
/// samples within a half correlate.
#[derive(Clone, Debug)]
pub struct HalfBuffers {
    sums: [Vec<f32>; 2],
    /// Samples per pixel in each half.
    samples: [u32; 2],
}

impl HalfBuffers {
    /// Empty halves for so many pixels.
    pub fn new(pixels: usize) -> Self {
        HalfBuffers { sums: [vec![0.0; pixels], vec![0.0; pixels]], samples: [0; 2] }
    }

    /// Discards all samples.
    pub fn clear(&mut self) {
        self.sums.iter_mut().for_each(|half| half.fill(0.0));
        self.samples = [0; 2];
    }

    /// Adds a sample's exposed luminance to a pixel of one half.
    #[inline]
    pub fn add(&mut self, half: usize, pixel: usize, luminance: f32) {
        self.sums[half][pixel] += luminance;
    }

    /// Counts a pass of `samples` samples of every pixel.
    pub fn finish_pass(&mut self, half: usize, samples: u32) {
        self.samples[half] += samples;
    }

    /// Samples per pixel in each half.
    pub fn samples(&self) -> [u32; 2] {
        self.samples
    }

    /// The half with fewer samples.
    pub fn next_half(&self) -> usize {
        usize::from(self.samples[1] < self.samples[0])
    }

    /// Mean exposed luminance of all pixels.
    pub fn mean(&self) -> f32 {
        let [a, b] = self.samples.map(|n| n as f32);
        let sum: f32 = self.sums[0].iter().zip(&self.sums[1]).fold(0.0, |sum, (x, y)| sum + (x + y) / (a + b));
        sum / self.sums[0].len() as f32
    }

    /// Estimates the noise: root mean square error of the pixels over the tile's mean exposed luminance, in stops.
    /// Infinite before both halves have samples; none for tiles darker than eight stops below middle grey.
    pub fn noise_stops(&self, mean: f32) -> Option<f32> {
        let [a, b] = self.samples.map(|n| n as f32);
        if a == 0.0 || b == 0.0 {
            return Some(f32::INFINITY);
        }
        // Var(mean of all) = Var(difference of the halves' means) ab / (a + b)^2.
        let scale = a * b / ((a + b) * (a + b));
        let square = self.sums[0].iter().zip(&self.sums[1]).fold(0.0, |sum, (x, y)| {
            let difference = x / a - y / b;
            sum + difference * difference * scale
        });
        let rms = (square / self.sums[0].len() as f32).sqrt();
        (mean > DARK).then(|| (1.0 + rms / mean).log2())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_estimate_is_the_error_of_the_mean_of_both_halves() {
        let mut halves = HalfBuffers::new(2);
        assert_eq!(halves.noise_stops(1.0), Some(f32::INFINITY));
        for (half, samples, means) in [(0, 1, [1.5, 0.5]), (1, 3, [1.1, 0.9])] {
            assert_eq!(halves.next_half(), half);
            for (pixel, mean) in means.into_iter().enumerate() {
                halves.add(half, pixel, mean * samples as f32);
            }
            halves.finish_pass(half, samples);
        }
        assert!((halves.mean() - 1.0).abs() < 1e-6);
        // Differences of 0.4 with weights 1 and 3: sqrt(3 / 16) * 0.4.
        let expected = (1.0 + 0.4 * (3.0_f32 / 16.0).sqrt()).log2();
        assert!((halves.noise_stops(1.0).unwrap() - expected).abs() < 1e-6);
        assert_eq!(halves.noise_stops(1e-4), None, "too dark");
        halves.clear();
        assert_eq!(halves.samples(), [0, 0]);
    }
}
