//! Winograd's convolution with 3x3 filters, two rows of output at a time (Lavin and Gray 2016, "Fast Algorithms for
//! Convolutional Neural Networks", F(2x2, 3x3)).
//!
//! A tile of 2x2 output pixels depends on 4x4 pixels of input. Both the tile and the filter are transformed to 4x4
//! values by sums and differences; of a channel's products there are then 16 instead of 36. The inverse transform of
//! their sums over all channels is the output:
//!
//! ```text
//!      | 1  0 -1  0 |        | 1    0    0  |         | 1  1  1  0 |
//! B' = | 0  1  1  0 |    G = | 1/2  1/2 1/2 |    A' = | 0  1 -1 -1 |
//!      | 0 -1  1  0 |        | 1/2 -1/2 1/2 |
//!      | 0  1  0 -1 |        | 0    0    1  |         output = A' ((G g G') * (B' d B)) A
//! ```
//!
//! Of a map whose pixels are doubled, the third row and column of a transformed tile are zero, as their pixels are equal
//! in pairs: nine products are left.

use super::feature_map::{BLOCK, Block, Output, RowShape};
use super::filter::{POSITIONS, TransformedFilter};
use super::simd::{Task, Vector, unrolled};

/// Tiles that are transformed at once, so that their values stay in the cache of a core: a multiple of what the inner
/// loop computes at once.
const STRIP: usize = 42;

/// The rows of a map around two rows of output, from the one above; none beyond the border.
#[derive(Clone, Copy, Debug)]
pub enum Rows<'a> {
    /// Those of a map of the output's size.
    Same([Option<&'a [Block]>; 4]),
    /// Those of a map of half the size, whose pixels are doubled.
    Doubled([Option<&'a [Block]>; 3]),
}

/// The rows of one of a convolution's maps.
#[derive(Clone, Copy, Debug)]
pub struct Input<'a> {
    /// Shape of the rows.
    pub shape: RowShape,
    /// The rows.
    pub rows: Rows<'a>,
}

/// Buffers for the transformed tiles of a strip.
#[derive(Debug, Default)]
pub struct Scratch {
    /// Transformed input, by position, block and tile.
    tiles: Vec<Block>,
    /// Sums of products, by position, block of output and tile.
    sums: Vec<Block>,
    /// A row beyond the border.
    zeros: Vec<Block>,
}

/// The computation of two rows of output.
#[derive(Debug)]
pub struct RowPair<'a> {
    /// The filter.
    pub filter: &'a TransformedFilter,
    /// The rows of the convolution's maps.
    pub inputs: &'a [Input<'a>],
    /// Negative values become zero.
    pub relu: bool,
    /// The output.
    pub output: Output<'a>,
    /// Buffers.
    pub scratch: &'a mut Scratch,
}

impl Task for RowPair<'_> {
    #[inline(always)]
    fn run<V: Vector, const B: usize, const P: usize>(mut self) {
        self.scratch.resize(self.filter, self.inputs);
        let tiles = self.output.shape.width.div_ceil(2);
        for first in (0..tiles).step_by(STRIP) {
            let count = STRIP.min(tiles - first);
            // Transform the input of a strip of tiles
            self.transform_inputs::<V>(first, count);
            // Sum its products with the filter over all channels, position by position
            for position in 0..POSITIONS {
                self.multiply::<V, B, P>(position, count);
            }
            // Transform the sums to output
            self.transform_outputs::<V>(first, count);
        }
    }
}

impl Scratch {
    /// Makes room for the tiles of a strip.
    fn resize(&mut self, filter: &TransformedFilter, inputs: &[Input<'_>]) {
        let stride = inputs.iter().map(|input| input.shape.stride()).max().unwrap_or(0);
        for (buffer, len) in [
            (&mut self.tiles, POSITIONS * filter.input_blocks() * STRIP),
            (&mut self.sums, POSITIONS * filter.output_blocks() * STRIP),
            (&mut self.zeros, stride),
        ] {
            if buffer.len() < len {
                buffer.resize(len, Block::ZERO);
            }
        }
    }
}

impl RowPair<'_> {
    /// Transforms some tiles of all blocks of input.
    #[inline(always)]
    fn transform_inputs<V: Vector>(&mut self, first: usize, count: usize) {
        let Scratch { tiles, zeros, .. } = &mut *self.scratch;
        let position_stride = self.filter.input_blocks() * STRIP;
        let mut start = 0;
        for input in self.inputs {
            let shape = input.shape;
            for block in 0..shape.blocks {
                let border = &zeros[..shape.stride()];
                let target = &mut tiles[start..];
                match input.rows {
                    Rows::Same(rows) => {
                        let rows = rows.map(|row| row.map_or(border, |row| shape.padded(row, block)));
                        transform_same::<V>(rows, first, count, target, position_stride);
                    }
                    Rows::Doubled(rows) => {
                        let rows = rows.map(|row| row.map_or(border, |row| shape.padded(row, block)));
                        transform_doubled::<V>(rows, first, count, target, position_stride);
                    }
                }
                start += STRIP;
            }
        }
    }

    /// Sums the products of tiles and filter at a position, over all channels: register tiles of `B` blocks of output
    /// and `P` tiles, and of one block for the rest.
    #[inline(always)]
    fn multiply<V: Vector, const B: usize, const P: usize>(&mut self, position: usize, count: usize) {
        let blocks = self.filter.output_blocks();
        let wide = blocks / B * B;
        for block in (0..wide).step_by(B) {
            self.multiply_blocks::<V, B, P>(position, block, count);
        }
        for block in wide..blocks {
            self.multiply_blocks::<V, 1, P>(position, block, count);
        }
    }

    /// As [`RowPair::multiply`], for `B` blocks of output from `block` on.
    #[inline(always)]
    fn multiply_blocks<V: Vector, const B: usize, const P: usize>(
        &mut self,
        position: usize,
        block: usize,
        count: usize,
    ) {
        const { assert!(STRIP.is_multiple_of(P), "a register tile stays in its strip") };
        let (filter, Scratch { tiles, sums, .. }) = (self.filter, &mut *self.scratch);
        let weights: [&[Block]; B] = std::array::from_fn(|b| filter.weights(position, block + b));
        let tiles = &tiles[position * filter.input_blocks() * STRIP..];
        for first in (0..count).step_by(P) {
            let mut accumulators = [[V::ZERO; P]; B];
            let mut start = 0;
            for input_block in filter.input_blocks_at(position) {
                let input = &tiles[input_block.index * STRIP + first..][..P];
                let weights: [&[Block]; B] = std::array::from_fn(|b| &weights[b][start..start + input_block.channels]);
                if input_block.channels == BLOCK {
                    unrolled!(CHANNEL < BLOCK, { add_channel::<V, B, P>(&mut accumulators, input, &weights, CHANNEL) });
                } else {
                    for channel in 0..input_block.channels.min(BLOCK) {
                        add_channel::<V, B, P>(&mut accumulators, input, &weights, channel);
                    }
                }
                start += input_block.channels;
            }
            for b in 0..B {
                let target = &mut sums[(position * filter.output_blocks() + block + b) * STRIP + first..][..P];
                unrolled!(TILE < P, { accumulators[b][TILE].store(&mut target[TILE]) });
            }
        }
    }

    /// Transforms the sums of some tiles to pixels of output.
    #[inline(always)]
    fn transform_outputs<V: Vector>(&mut self, first: usize, count: usize) {
        let (filter, relu, sums) = (self.filter, self.relu, &self.scratch.sums);
        let stride = filter.output_blocks() * STRIP;
        let Output { rows: [upper, lower], shape } = &mut self.output;
        for block in 0..filter.output_blocks() {
            let (bias, sums) = (V::load(filter.bias(block)), &sums[block * STRIP..]);
            if let Some(row) = upper {
                let pixels = &mut shape.pixels_mut(row, block)[2 * first..];
                transform_output_row::<V, 0>(sums, stride, count, (bias, relu), pixels);
            }
            if let Some(row) = lower {
                let pixels = &mut shape.pixels_mut(row, block)[2 * first..];
                transform_output_row::<V, 1>(sums, stride, count, (bias, relu), pixels);
            }
        }
    }
}

/// Stores row `ROW` of A' m A of each tile, where row `i` and column `j` of m are `(4 i + j) stride` later.
#[inline(always)]
fn transform_output_row<V: Vector, const ROW: usize>(
    sums: &[Block],
    stride: usize,
    count: usize,
    (bias, relu): (V, bool),
    pixels: &mut [Block],
) {
    for (tile, pixels) in pixels.chunks_mut(2).take(count).enumerate() {
        let sums = &sums[tile..];
        // A' times the sums, then times A
        let (a, b) = (output_value::<V, ROW>(sums, stride, 0), output_value::<V, ROW>(sums, stride, 1));
        let (c, d) = (output_value::<V, ROW>(sums, stride, 2), output_value::<V, ROW>(sums, stride, 3));
        let values = [a.add(b).add(c), b.subtract(c).subtract(d)];
        for (pixel, value) in pixels.iter_mut().zip(values) {
            let value = value.add(bias);
            let value = if relu { value.relu() } else { value };
            value.store(pixel);
        }
    }
}

/// Returns the value of A' m in row `ROW` and a column.
#[inline(always)]
fn output_value<V: Vector, const ROW: usize>(sums: &[Block], stride: usize, column: usize) -> V {
    let (b, c) = (V::load(&sums[(4 + column) * stride]), V::load(&sums[(8 + column) * stride]));
    if ROW == 0 {
        V::load(&sums[column * stride]).add(b).add(c)
    } else {
        b.subtract(c).subtract(V::load(&sums[(12 + column) * stride]))
    }
}

/// Adds the products of an input channel.
#[inline(always)]
fn add_channel<V: Vector, const B: usize, const P: usize>(
    accumulators: &mut [[V; P]; B],
    input: &[Block],
    weights: &[&[Block]; B],
    channel: usize,
) {
    let weights: [V; B] = std::array::from_fn(|b| V::load(&weights[b][channel]));
    unrolled!(TILE < P, {
        let value = input[TILE].0[channel];
        for b in 0..B {
            accumulators[b][TILE] = accumulators[b][TILE].add_product(weights[b], value);
        }
    });
}

/// Transforms tiles of a block from the rows around them: row `i` and column `j` of the result are stored
/// `(4 i + j) stride` later.
#[inline(always)]
fn transform_same<V: Vector>(rows: [&[Block]; 4], first: usize, count: usize, target: &mut [Block], stride: usize) {
    let [a, b, c, d] = rows.map(|row| &row[2 * first..][..2 * count + 2]);
    transform_same_row::<V, false>(a, c, target, stride);
    transform_same_row::<V, true>(b, c, &mut target[4 * stride..], stride);
    transform_same_row::<V, false>(c, b, &mut target[8 * stride..], stride);
    transform_same_row::<V, false>(b, d, &mut target[12 * stride..], stride);
}

/// Stores a row of B' d B of each tile: that of B' times d is the sum of two rows of pixels, or their difference.
#[inline(always)]
fn transform_same_row<V: Vector, const SUM: bool>(row: &[Block], other: &[Block], target: &mut [Block], stride: usize) {
    for tile in 0..row.len() / 2 - 1 {
        let (a, b) = (combined::<V, SUM>(row, other, 2 * tile), combined::<V, SUM>(row, other, 2 * tile + 1));
        let (c, d) = (combined::<V, SUM>(row, other, 2 * tile + 2), combined::<V, SUM>(row, other, 2 * tile + 3));
        a.subtract(c).store(&mut target[tile]);
        b.add(c).store(&mut target[stride + tile]);
        c.subtract(b).store(&mut target[2 * stride + tile]);
        b.subtract(d).store(&mut target[3 * stride + tile]);
    }
}

/// Transforms tiles of a block of a map whose pixels are doubled, as [`transform_same`] does. Zeros are not stored.
#[inline(always)]
fn transform_doubled<V: Vector>(rows: [&[Block]; 3], first: usize, count: usize, target: &mut [Block], stride: usize) {
    let [a, b, c] = rows.map(|row| &row[first..][..count + 2]);
    transform_doubled_row::<V, false>(a, b, target, stride);
    transform_doubled_row::<V, true>(b, b, &mut target[4 * stride..], stride);
    transform_doubled_row::<V, false>(b, c, &mut target[12 * stride..], stride);
}

/// Stores a row of B' d B of each tile of a map whose pixels are doubled.
#[inline(always)]
fn transform_doubled_row<V: Vector, const SUM: bool>(
    row: &[Block],
    other: &[Block],
    target: &mut [Block],
    stride: usize,
) {
    for tile in 0..row.len() - 2 {
        let (a, b) = (combined::<V, SUM>(row, other, tile), combined::<V, SUM>(row, other, tile + 1));
        let c = combined::<V, SUM>(row, other, tile + 2);
        a.subtract(b).store(&mut target[tile]);
        b.add(b).store(&mut target[stride + tile]);
        b.subtract(c).store(&mut target[3 * stride + tile]);
    }
}

/// Returns the sum of the pixels at `x` in two rows, or their difference.
#[inline(always)]
fn combined<V: Vector, const SUM: bool>(row: &[Block], other: &[Block], x: usize) -> V {
    let (a, b) = (V::load(&row[x]), V::load(&other[x]));
    if SUM { a.add(b) } else { a.subtract(b) }
}
