//! Convolutions with 3x3 filters, a row of output at a time. Beyond the border of a map everything is zero.

use super::feature_map::{BLOCK, Block, LEFT, RowShape};
use super::filter::PackedFilter;
use super::simd::{InstructionSet, RowTask, Tap};
use super::weight_file::{WeightError, WeightFile};

/// Side of a filter.
const SIDE: usize = 3;

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

    fn weight(self, output: usize, input: usize, [ky, kx]: [usize; 2]) -> f32 {
        self.weights[((output * self.inputs + input) * SIDE + ky) * SIDE + kx]
    }
}

/// Returns the numbers of channels of the blocks that hold `channels`.
fn block_channels(channels: usize) -> impl Iterator<Item = usize> {
    (0..channels).step_by(BLOCK).map(move |first| (channels - first).min(BLOCK))
}

/// A filter position: the first channel and the number of channels of an input block, row and column.
#[derive(Clone, Copy)]
struct Position {
    channel: usize,
    channels: usize,
    at: [usize; 2],
}

/// Returns the positions of a filter with `rows` x `columns` on `channels` channels, block by block.
fn positions(channels: usize, [rows, columns]: [usize; 2]) -> Vec<Position> {
    let blocks = block_channels(channels).enumerate();
    let all = blocks.flat_map(|(block, channels)| {
        let places = (0..rows).flat_map(move |ky| (0..columns).map(move |kx| [ky, kx]));
        places.map(move |at| Position { channel: block * BLOCK, channels, at })
    });
    all.collect()
}

/// Where a row of output goes.
#[derive(Debug)]
pub struct Output<'a> {
    /// The row.
    pub row: &'a mut [Block],
    /// Its shape.
    pub shape: RowShape,
}

impl Output<'_> {
    /// Computes the pixels `start`, `start + step` and so on.
    fn compute(&mut self, set: InstructionSet, relu: bool, pixels: Pixels, filter: &PackedFilter, taps: &Taps<'_>) {
        let Pixels { start, step } = pixels;
        let task = RowTask {
            filter,
            single: &taps.single,
            double: &taps.double,
            count: self.shape.width.saturating_sub(start).div_ceil(step),
            relu,
            output: &mut self.row[LEFT + start..],
            output_step: step,
            output_stride: self.shape.stride(),
        };
        let mut task = task;
        task.run(set);
    }
}

/// Every `step`th pixel from `start` on.
#[derive(Clone, Copy)]
struct Pixels {
    start: usize,
    step: usize,
}

#[derive(Default)]
struct Taps<'a> {
    single: Vec<Tap<'a>>,
    double: Vec<Tap<'a>>,
}

/// Rows of input above, at and below a row of output; none beyond the border.
pub type InputRows<'a> = [Option<&'a [Block]>; SIDE];

/// A convolution of one map.
#[derive(Debug)]
pub struct Convolution {
    positions: Vec<PositionOf>,
    filter: PackedFilter,
    outputs: usize,
}

/// A tap of a packed filter: block of input, row and column.
#[derive(Clone, Copy, Debug)]
struct PositionOf {
    block: usize,
    at: [usize; 2],
}

impl From<&Position> for PositionOf {
    fn from(position: &Position) -> Self {
        PositionOf { block: position.channel / BLOCK, at: position.at }
    }
}

impl Convolution {
    /// Packs a kernel.
    pub fn new(kernel: Kernel<'_>) -> Self {
        let positions = positions(kernel.inputs, [SIDE, SIDE]);
        let channels = positions.iter().map(|position| position.channels).collect();
        let filter = PackedFilter::new(kernel.bias, channels, |output, tap, input| {
            kernel.weight(output, positions[tap].channel + input, positions[tap].at)
        });
        let positions = positions.iter().map(PositionOf::from).collect();
        Convolution { positions, filter, outputs: kernel.outputs() }
    }

    /// Number of output channels.
    pub fn outputs(&self) -> usize {
        self.outputs
    }

    /// Computes a row of output from the rows of a map of `shape`.
    pub fn row(&self, set: InstructionSet, relu: bool, shape: RowShape, rows: InputRows<'_>, output: &mut Output<'_>) {
        let tap = |(tap, position): (usize, &PositionOf)| {
            let [ky, kx] = position.at;
            let input = &shape.padded(rows[ky]?, position.block)[kx..];
            Some(Tap { input, channels: self.filter.tap_channels(tap), weights: self.filter.tap_start(tap) })
        };
        let single = self.positions.iter().enumerate().filter_map(tap).collect();
        let pixels = Pixels { start: 0, step: 1 };
        output.compute(set, relu, pixels, &self.filter, &Taps { single, double: Vec::new() });
    }
}

/// A convolution of two maps: one of half the size, whose pixels are doubled, and one of full size.
///
/// Of three neighbouring pixels of a doubled row, two are equal. Their weights are added beforehand, so that each output
/// pixel needs 2x2 pixels of the coarse map instead of 3x3: which ones depends on whether its row and column are even or
/// odd.
#[derive(Debug)]
pub struct UpsamplingConvolution {
    /// Positions on the coarse map, then those on the fine one.
    coarse: Vec<PositionOf>,
    fine: Vec<PositionOf>,
    /// Filters by parity of row and column.
    filters: [[PackedFilter; 2]; 2],
    outputs: usize,
}

/// Coarse pixels of a row or column of output of each parity, relative to its own: first and number.
const COARSE: usize = 2;

/// Returns the positions of a 3x3 filter that fall on one of the two coarse pixels of an output row of this parity.
///
/// An even row `2i` has the rows `2i - 1`, `2i`, `2i + 1` of the doubled map: the coarse rows `i - 1`, `i`, `i`. An odd
/// one has `i`, `i`, `i + 1`.
fn merged(parity: usize, coarse: usize) -> std::ops::Range<usize> {
    match (parity, coarse) {
        (0, 0) => 0..1,
        (0, _) => 1..3,
        (_, 0) => 0..2,
        _ => 2..3,
    }
}

impl UpsamplingConvolution {
    /// Packs a kernel whose first `coarse_channels` inputs are those of the coarse map.
    pub fn new(kernel: Kernel<'_>, coarse_channels: usize) -> Self {
        let coarse = positions(coarse_channels, [COARSE, COARSE]);
        let fine = positions(kernel.inputs.saturating_sub(coarse_channels), [SIDE, SIDE]);
        let channels: Vec<usize> = coarse.iter().chain(&fine).map(|position| position.channels).collect();
        let filter = |row_parity: usize, column_parity: usize| {
            PackedFilter::new(kernel.bias, channels.clone(), |output, tap, input| match coarse.get(tap) {
                Some(position) => {
                    let rows = merged(row_parity, position.at[0]);
                    let places = rows.flat_map(|ky| merged(column_parity, position.at[1]).map(move |kx| [ky, kx]));
                    places.map(|at| kernel.weight(output, position.channel + input, at)).sum()
                }
                None => {
                    let position = fine[tap - coarse.len()];
                    kernel.weight(output, coarse_channels + position.channel + input, position.at)
                }
            })
        };
        let filters = [0, 1].map(|row| [0, 1].map(|column| filter(row, column)));
        let of = |positions: &[Position]| positions.iter().map(PositionOf::from).collect();
        UpsamplingConvolution { coarse: of(&coarse), fine: of(&fine), filters, outputs: kernel.outputs() }
    }

    /// Number of output channels.
    pub fn outputs(&self) -> usize {
        self.outputs
    }

    /// Computes row `y` of output from maps with rows of these shapes.
    pub fn row<'a>(
        &self,
        set: InstructionSet,
        y: isize,
        coarse: (RowShape, &dyn Fn(isize) -> Option<&'a [Block]>),
        fine: (RowShape, InputRows<'a>),
        output: &mut Output<'_>,
    ) {
        let row_parity = y.rem_euclid(2).unsigned_abs();
        let first_row = y.div_euclid(2) - 1 + row_parity as isize;
        let coarse_rows = [coarse.1(first_row), coarse.1(first_row + 1)];
        for column_parity in 0..2 {
            let filter = &self.filters[row_parity][column_parity];
            let tap =
                |tap: usize, input| Tap { input, channels: filter.tap_channels(tap), weights: filter.tap_start(tap) };
            let single = self.coarse.iter().enumerate().filter_map(|(index, position)| {
                let [row, column] = position.at;
                // The border holds the pixel at -1, the first coarse pixel of an even column.
                let input = &coarse.0.padded(coarse_rows[row]?, position.block)[column_parity + column..];
                Some(tap(index, input))
            });
            let double = self.fine.iter().enumerate().filter_map(|(index, position)| {
                let [ky, kx] = position.at;
                let input = &fine.0.padded(fine.1[ky]?, position.block)[column_parity + kx..];
                Some(tap(self.coarse.len() + index, input))
            });
            let taps = Taps { single: single.collect(), double: double.collect() };
            output.compute(set, true, Pixels { start: column_parity, step: 2 }, filter, &taps);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::feature_map::FeatureMap;
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
            for ky in 0..SIDE {
                for kx in 0..SIDE {
                    let value = input(channel, x + kx as isize - 1, y + ky as isize - 1);
                    sum += f64::from(kernel.weight(output, channel, [ky, kx])) * f64::from(value);
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
            for (width, inputs, outputs) in [(16, 9, 32), (45, 20, 48), (1, 1, 3), (30, 33, 17)] {
                let (weights, bias) = (numbers(7, outputs * inputs * 9), numbers(8, outputs));
                let kernel = Kernel { inputs, weights: &weights, bias: &bias };
                let convolution = Convolution::new(kernel);
                let planes = Planes::new(9, width, 3, inputs);
                let map = planes.map();
                let shape = RowShape::new(width, outputs);
                for y in 0..3 {
                    let mut row = shape.zeros();
                    let rows = [map.row(y - 1), map.row(y), map.row(y + 1)];
                    convolution.row(set, false, map.shape, rows, &mut Output { row: &mut row, shape });
                    let expected = |output, x| naive(kernel, |c, x, y| planes.at(c, x, y), output, x, y);
                    compare(&row, shape, outputs, 9 * inputs, expected);
                    let mut positive = shape.zeros();
                    convolution.row(set, true, map.shape, rows, &mut Output { row: &mut positive, shape });
                    compare(&positive, shape, outputs, 9 * inputs, |output, x| expected(output, x).max(0.0));
                }
            }
        }
    }

    #[test]
    fn convolutions_of_doubled_maps_are_those_of_a_naive_loop() {
        for set in InstructionSet::supported() {
            for (width, coarse_channels, fine_channels, outputs) in [(16, 32, 9, 32), (46, 20, 17, 48), (2, 1, 1, 3)] {
                let inputs = coarse_channels + fine_channels;
                let (weights, bias) = (numbers(1, outputs * inputs * 9), numbers(2, outputs));
                let kernel = Kernel { inputs, weights: &weights, bias: &bias };
                let convolution = UpsamplingConvolution::new(kernel, coarse_channels);
                let coarse = Planes::new(3, width / 2, 2, coarse_channels);
                let fine = Planes::new(4, width, 4, fine_channels);
                let (coarse_map, fine_map) = (coarse.map(), fine.map());
                let input = |channel: usize, x: isize, y: isize| match channel.checked_sub(coarse_channels) {
                    None => coarse.at(channel, x.div_euclid(2), y.div_euclid(2)),
                    Some(channel) => fine.at(channel, x, y),
                };
                let shape = RowShape::new(width, outputs);
                for y in 0..4 {
                    let mut row = shape.zeros();
                    let rows = [fine_map.row(y - 1), fine_map.row(y), fine_map.row(y + 1)];
                    let coarse_rows = (coarse_map.shape, &|y: isize| coarse_map.row(y) as Option<&[Block]>);
                    let mut output = Output { row: &mut row, shape };
                    convolution.row(set, y, (coarse_rows.0, coarse_rows.1), (fine_map.shape, rows), &mut output);
                    let expected = |output, x| naive(kernel, input, output, x, y).max(0.0);
                    compare(&row, shape, outputs, 9 * inputs, expected);
                }
            }
        }
    }
}
