//! Convolutions with 3x3 filters, two rows of output at a time. Beyond the border of a map everything is zero.

use super::feature_map::{BLOCK, Block, Output, RowShape};
use super::filter::{SIDE, TransformedFilter};
use super::simd::{self, InstructionSet};
use super::weight_file::{WeightError, WeightFile};
use super::winograd::{Input, RowPair, Rows, Scratch};

/// The weights of a convolution as they are stored: output channel, input channel, row, column.
#[derive(Clone, Copy, Debug)]
pub struct Kernel<'a> {
    inputs: usize,
    weights: &'a [f32],
    bias: &'a [f32],
}

impl<'a> Kernel<'a> {
    /// Returns the kernel of a number of input channels from `name.weight` and `name.bias`.
    ///
    /// # Errors
    /// If one is missing or has another shape.
    pub fn read(file: &'a WeightFile, name: &str, inputs: usize) -> Result<Self, WeightError> {
        let (weight_name, bias_name) = (format!("{name}.weight"), format!("{name}.bias"));
        let (shape, weights) = file.tensor::<4>(&weight_name)?;
        let ([outputs], bias) = file.tensor::<1>(&bias_name)?;
        if shape != [outputs, inputs, SIDE, SIDE] || outputs == 0 {
            return Err(WeightError::Shape(weight_name, shape.to_vec()));
        }
        Ok(Kernel { inputs, weights, bias })
    }

    /// Number of output channels.
    pub fn outputs(self) -> usize {
        self.bias.len()
    }

    /// Returns the weights of an input channel for an output channel.
    fn filter(self, output: usize, input: usize) -> [[f32; SIDE]; SIDE] {
        let start = (output * self.inputs + input) * SIDE * SIDE;
        std::array::from_fn(|y| std::array::from_fn(|x| self.weights[start + y * SIDE + x]))
    }
}

/// Returns the numbers of channels of the blocks that hold `channels`.
fn block_channels(channels: usize) -> impl Iterator<Item = usize> {
    (0..channels).step_by(BLOCK).map(move |first| (channels - first).min(BLOCK))
}

/// A convolution of one map, or of two: one of half the size, whose pixels are doubled, and one of full size.
#[derive(Debug)]
pub struct Convolution {
    filter: TransformedFilter,
    outputs: usize,
}

impl Convolution {
    /// Transforms a kernel whose first inputs are the `doubled` channels of a map of half the size.
    pub fn new(kernel: Kernel<'_>, doubled: usize) -> Self {
        let coarse: Vec<usize> = block_channels(doubled).collect();
        let fine = block_channels(kernel.inputs.saturating_sub(doubled));
        let channels: Vec<usize> = coarse.iter().copied().chain(fine).collect();
        let filter =
            TransformedFilter::new(kernel.bias, &channels, coarse.len(), |output, input| kernel.filter(output, input));
        Convolution { filter, outputs: kernel.outputs() }
    }

    /// Number of output channels.
    pub fn outputs(&self) -> usize {
        self.outputs
    }

    /// Computes two rows of output from the rows of each map.
    pub fn rows(
        &self,
        set: InstructionSet,
        relu: bool,
        inputs: &[Input<'_>],
        output: Output<'_>,
        scratch: &mut Scratch,
    ) {
        simd::run(set, RowPair { filter: &self.filter, inputs, relu, output, scratch });
    }
}

/// Returns the rows around rows `y` and `y + 1`.
pub fn around<'a>(shape: RowShape, y: isize, row: impl Fn(isize) -> Option<&'a [Block]>) -> Input<'a> {
    Input { shape, rows: Rows::Same([row(y - 1), row(y), row(y + 1), row(y + 2)]) }
}

/// Returns the rows of a map of half the size around rows `y` and `y + 1`, with `y` even.
pub fn around_half<'a>(shape: RowShape, y: isize, row: impl Fn(isize) -> Option<&'a [Block]>) -> Input<'a> {
    let half = y.div_euclid(2);
    Input { shape, rows: Rows::Doubled([row(half - 1), row(half), row(half + 1)]) }
}

#[cfg(test)]
mod tests {
    use super::super::feature_map::{FeatureMap, LEFT};
    use super::*;

    /// Returns pseudo-random numbers from -1 to 1.
    fn numbers(seed: u32, count: usize) -> Vec<f32> {
        let next = |state: &u32| Some(state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223));
        let states = std::iter::successors(next(&seed), next).take(count);
        states.map(|state| (state >> 8) as f32 / (1 << 23) as f32 - 1.0).collect()
    }

    /// A map as planes of channels, for the naive loops.
    struct Planes {
        width: usize,
        height: usize,
        channels: usize,
        values: Vec<f32>,
    }

    impl Planes {
        fn new(seed: u32, width: usize, height: usize, channels: usize) -> Self {
            Planes { width, height, channels, values: numbers(seed, width * height * channels) }
        }

        fn at(&self, channel: usize, x: isize, y: isize) -> f32 {
            let inside = (0..self.width as isize).contains(&x) && (0..self.height as isize).contains(&y);
            let index = (channel * self.height) as isize * self.width as isize + y * self.width as isize + x;
            if inside { self.values[index as usize] } else { 0.0 }
        }

        fn map(&self) -> FeatureMap {
            let mut map = FeatureMap::new(self.width, self.height, self.channels);
            let shape = map.shape;
            for (y, row) in map.data_mut().chunks_mut(shape.len()).enumerate() {
                for channel in 0..self.channels {
                    let pixels = shape.pixels_mut(row, channel / BLOCK);
                    for (x, pixel) in pixels.iter_mut().enumerate() {
                        pixel.0[channel % BLOCK] = self.at(channel, x as isize, y as isize);
                    }
                }
            }
            map
        }
    }

    /// Sums the products of a 3x3 filter one by one, in f64.
    fn naive(kernel: Kernel<'_>, input: impl Fn(usize, isize, isize) -> f32, output: usize, x: isize, y: isize) -> f64 {
        let mut sum = f64::from(kernel.bias[output]);
        for channel in 0..kernel.inputs {
            let filter = kernel.filter(output, channel);
            for (ky, row) in (-1..).zip(filter) {
                for (kx, weight) in (-1..).zip(row) {
                    sum += f64::from(weight) * f64::from(input(channel, x + kx, y + ky));
                }
            }
        }
        sum
    }

    /// Compares a row with the naive sums. Rounding of n terms below 1: at most n times epsilon, here n = 9 * channels.
    fn compare(row: &[Block], shape: RowShape, outputs: usize, terms: usize, expected: impl Fn(usize, isize) -> f64) {
        for output in 0..outputs {
            for (x, pixel) in shape.pixels(row, output / BLOCK).iter().enumerate() {
                let (value, expected) = (pixel.0[output % BLOCK], expected(output, x as isize));
                let error = (f64::from(value) - expected).abs();
                assert!(error < terms as f64 * f64::from(f32::EPSILON), "{output} {x}: {value}, not {expected}");
            }
        }
        for block in 0..shape.blocks {
            let padded = shape.padded(row, block);
            let border = padded[..LEFT].iter().chain(&padded[LEFT + shape.width..]);
            assert!(border.clone().all(|pixel| *pixel == Block::ZERO), "the border stays zero");
        }
    }

    #[test]
    fn convolutions_are_those_of_a_naive_loop() {
        for set in InstructionSet::supported() {
            // One buffer for all: what it holds is of no account
            let mut scratch = Scratch::default();
            for (width, inputs, outputs) in [(16, 9, 32), (245, 20, 48), (1, 1, 3), (30, 33, 17)] {
                let (weights, bias) = (numbers(7, outputs * inputs * 9), numbers(8, outputs));
                let kernel = Kernel { inputs, weights: &weights, bias: &bias };
                let convolution = Convolution::new(kernel, 0);
                let planes = Planes::new(9, width, 3, inputs);
                let map = planes.map();
                let shape = RowShape::new(width, outputs);
                for relu in [false, true] {
                    let mut rows = shape.zeros(3);
                    for (pair, rows) in rows.chunks_mut(2 * shape.len()).enumerate() {
                        let input = around(map.shape, 2 * pair as isize, |y| map.row(y));
                        convolution.rows(set, relu, &[input], Output::of(rows, shape), &mut scratch);
                    }
                    for (y, row) in rows.chunks(shape.len()).enumerate() {
                        compare(row, shape, outputs, 9 * inputs, |output, x| {
                            let sum = naive(kernel, |c, x, y| planes.at(c, x, y), output, x, y as isize);
                            if relu { sum.max(0.0) } else { sum }
                        });
                    }
                }
            }
        }
    }

    #[test]
    fn convolutions_of_doubled_maps_are_those_of_a_naive_loop() {
        for set in InstructionSet::supported() {
            let mut scratch = Scratch::default();
            for (width, coarse_channels, fine_channels, outputs) in [(16, 32, 9, 32), (146, 20, 17, 48), (2, 1, 1, 3)] {
                let inputs = coarse_channels + fine_channels;
                let (weights, bias) = (numbers(1, outputs * inputs * 9), numbers(2, outputs));
                let kernel = Kernel { inputs, weights: &weights, bias: &bias };
                let convolution = Convolution::new(kernel, coarse_channels);
                let coarse = Planes::new(3, width / 2, 2, coarse_channels);
                let fine = Planes::new(4, width, 4, fine_channels);
                let (coarse_map, fine_map) = (coarse.map(), fine.map());
                let input = |channel: usize, x: isize, y: isize| match channel.checked_sub(coarse_channels) {
                    None => coarse.at(channel, x.div_euclid(2), y.div_euclid(2)),
                    Some(channel) => fine.at(channel, x, y),
                };
                let shape = RowShape::new(width, outputs);
                for y in [0, 2] {
                    let mut rows = shape.zeros(2);
                    let coarse_rows = around_half(coarse_map.shape, y, |y| coarse_map.row(y));
                    let inputs_of_pair = [coarse_rows, around(fine_map.shape, y, |y| fine_map.row(y))];
                    convolution.rows(set, true, &inputs_of_pair, Output::of(&mut rows, shape), &mut scratch);
                    for (y, row) in (y..).zip(rows.chunks(shape.len())) {
                        let expected = |output, x| naive(kernel, input, output, x, y).max(0.0);
                        compare(row, shape, outputs, 9 * inputs, expected);
                    }
                }
            }
        }
    }
}
