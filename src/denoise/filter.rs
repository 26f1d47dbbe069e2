//! The weights of a filter, transformed for Winograd's convolution, in the order in which the inner loop reads them.

use super::feature_map::{BLOCK, Block};

/// Side of a filter.
pub const SIDE: usize = 3;
/// Values of a transformed tile: 4x4.
pub const POSITIONS: usize = 16;

/// A block of input channels that has products at a position.
#[derive(Clone, Copy, Debug)]
pub struct InputBlock {
    /// Index among the blocks of all maps.
    pub index: usize,
    /// Channels of the block.
    pub channels: usize,
}

/// Transformed weights of a convolution.
#[derive(Debug)]
pub struct TransformedFilter {
    bias: Vec<Block>,
    input_blocks: usize,
    positions: Vec<Position>,
}

/// The weights at a position of a transformed tile.
#[derive(Debug)]
struct Position {
    inputs: Vec<InputBlock>,
    /// For each block of output channels, the weights of each input channel.
    weights: Vec<Block>,
    /// Number of weights of a block of output channels.
    stride: usize,
}

impl TransformedFilter {
    /// Transforms a filter with a bias for each output channel on blocks of at most 16 input channels, of which the first
    /// `doubled` are of a map whose pixels are doubled. `weights(output, input)` are those of a channel, counted over all
    /// blocks.
    pub fn new(
        bias: &[f32],
        channels: &[usize],
        doubled: usize,
        weights: impl Fn(usize, usize) -> [[f32; SIDE]; SIDE],
    ) -> Self {
        let (blocks, inputs) = (bias.len().div_ceil(BLOCK), channels.iter().sum::<usize>());
        let of_block = |block: usize, value: &dyn Fn(usize) -> f32| {
            let channel = |i: usize| block * BLOCK + i;
            Block(std::array::from_fn(|i| if channel(i) < bias.len() { value(channel(i)) } else { 0.0 }))
        };
        let pairs = (0..bias.len()).flat_map(|output| (0..inputs).map(move |input| (output, input)));
        let transformed: Vec<_> = pairs.map(|(output, input)| transformed(&weights(output, input))).collect();
        let position = |position: usize| {
            // Where doubled pixels give zero, there are no products
            let is_zero = |block: usize| block < doubled && (position / 4 == 2 || position % 4 == 2);
            let all = channels.iter().enumerate().map(|(index, &channels)| InputBlock { index, channels });
            let seen: Vec<InputBlock> = all.filter(|block| !is_zero(block.index)).collect();
            let stride = seen.iter().map(|block| block.channels).sum();
            let mut weights = Vec::with_capacity(blocks * stride);
            for block in 0..blocks {
                let weight = |output: usize, input: usize| transformed[output * inputs + input][position];
                weights.extend((inputs - stride..inputs).map(|input| of_block(block, &|output| weight(output, input))));
            }
            Position { inputs: seen, weights, stride }
        };
        TransformedFilter {
            bias: (0..blocks).map(|block| of_block(block, &|output| bias[output])).collect(),
            input_blocks: channels.len(),
            positions: (0..POSITIONS).map(position).collect(),
        }
    }

    /// Number of blocks of input channels.
    pub fn input_blocks(&self) -> usize {
        self.input_blocks
    }

    /// Number of blocks of output channels.
    pub fn output_blocks(&self) -> usize {
        self.bias.len()
    }

    /// The bias of an output block.
    pub fn bias(&self, block: usize) -> &Block {
        &self.bias[block]
    }

    /// Returns the blocks of input that have products at a position.
    #[inline]
    pub fn input_blocks_at(&self, position: usize) -> &[InputBlock] {
        &self.positions[position].inputs
    }

    /// Returns the weights of an output block at a position, for all channels of those blocks of input.
    #[inline]
    pub fn weights(&self, position: usize, block: usize) -> &[Block] {
        let Position { weights, stride, .. } = &self.positions[position];
        &weights[block * stride..(block + 1) * stride]
    }
}

/// Returns G g G', by rows, summed in f64.
fn transformed(filter: &[[f32; SIDE]; SIDE]) -> [f32; POSITIONS] {
    let filter = filter.map(|row| row.map(f64::from));
    let columns: [[f64; 4]; SIDE] = std::array::from_fn(|x| times_g(filter.map(|row| row[x])));
    let rows: [[f64; 4]; 4] = std::array::from_fn(|i| times_g(columns.map(|column| column[i])));
    std::array::from_fn(|position| rows[position / 4][position % 4] as f32)
}

/// Returns G times a column.
fn times_g([a, b, c]: [f64; SIDE]) -> [f64; 4] {
    [a, 0.5 * (a + b + c), 0.5 * (a - b + c), c]
}
