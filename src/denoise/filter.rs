//! The weights of a filter, in the order in which the inner loop reads them.

use super::feature_map::{BLOCK, Block};

/// Weights of a convolution: for each block of output channels, tap by tap, the weights of each input channel.
#[derive(Debug)]
pub struct PackedFilter {
    bias: Vec<Block>,
    weights: Vec<Block>,
    /// Input channels of each tap.
    tap_channels: Vec<usize>,
    /// Index of each tap's first weights in those of an output block; at the end, the number of weights of a block.
    tap_starts: Vec<usize>,
}

impl PackedFilter {
    /// Packs a filter with a bias for each output channel and taps of at most 16 input channels each.
    /// `weight(output, tap, input)` is the weight of a channel.
    pub fn new(bias: &[f32], tap_channels: Vec<usize>, weight: impl Fn(usize, usize, usize) -> f32) -> Self {
        let of_block = |block: usize, value: &dyn Fn(usize) -> f32| {
            let channel = |i: usize| block * BLOCK + i;
            Block(std::array::from_fn(|i| if channel(i) < bias.len() { value(channel(i)) } else { 0.0 }))
        };
        let blocks = bias.len().div_ceil(BLOCK);
        let mut weights = Vec::new();
        for block in 0..blocks {
            for (tap, channels) in tap_channels.iter().enumerate() {
                weights.extend((0..*channels).map(|input| of_block(block, &|output| weight(output, tap, input))));
            }
        }
        let mut tap_starts = vec![0];
        tap_starts.extend(tap_channels.iter().scan(0, |sum, channels| {
            *sum += channels;
            Some(*sum)
        }));
        let bias = (0..blocks).map(|block| of_block(block, &|output| bias[output])).collect();
        PackedFilter { bias, weights, tap_channels, tap_starts }
    }

    /// Number of blocks of output channels.
    pub fn output_blocks(&self) -> usize {
        self.bias.len()
    }

    /// The bias of an output block.
    pub fn bias(&self, block: usize) -> &Block {
        &self.bias[block]
    }

    /// The weights of an output block, for all taps.
    #[inline]
    pub fn weights(&self, block: usize) -> &[Block] {
        let count = self.tap_starts[self.tap_channels.len()];
        &self.weights[block * count..(block + 1) * count]
    }

    /// Index of a tap's first weights in those of an output block.
    pub fn tap_start(&self, tap: usize) -> usize {
        self.tap_starts[tap]
    }

    /// Input channels of a tap.
    pub fn tap_channels(&self, tap: usize) -> usize {
        self.tap_channels[tap]
    }
}
