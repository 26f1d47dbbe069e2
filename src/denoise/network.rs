//! The network: a U-Net of 16 convolutions with ReLU, four times halved by 2x2 max pooling and doubled again, as trained
//! for Intel Open Image Denoise.
//!
//! ```text
//! input ----------------------------------------------------- dec 1a, 1b, 0 -> output
//!   enc 0, 1, pool --------------------------------- dec 2a, 2b
//!     enc 2, pool -------------------------- dec 3a, 3b
//!       enc 3, pool ----------------- dec 4a, 4b
//!         enc 4, pool -- enc 5a, 5b
//! ```
//!
//! The rows between the convolutions of full size (enc 0, 1 and dec 1a, 1b, 0) are kept only as long as the next one
//! needs them, so that they stay in the cache of the core that made them.

use super::convolution::{Convolution, Kernel, around, around_half};
use super::feature_map::{Block, FeatureMap, Output, RowRing, RowShape};
use super::simd::InstructionSet;
use super::weight_file::{WeightError, WeightFile};
use super::winograd::Scratch;
use rayon::prelude::*;

/// Channels of the input: colour, albedo and normal.
pub const INPUT_CHANNELS: usize = 9;
/// Number by which width and height of the input are divisible: the network halves them four times.
pub const ALIGNMENT: usize = 16;
/// Pixels by which a picture can be shifted without a change of its bits: a tile of a convolution at a sixteenth of the
/// size.
pub const PERIOD: usize = 2 * ALIGNMENT;
/// Rows that a thread computes at once in the stages of full size. The first ones repeat rows of the band above.
const BAND: usize = 64;

/// The convolutions with their weights.
#[derive(Debug)]
pub struct Network {
    set: InstructionSet,
    encoder_0: Convolution,
    encoder_1: Convolution,
    /// enc 2, 3, 4.
    encoders: [Convolution; 3],
    /// enc 5a, 5b.
    bottom: [Convolution; 2],
    /// dec 4, 3, 2: the first convolution of each on two maps, then one on its result.
    decoders: [(Convolution, Convolution); 3],
    decoder_1a: Convolution,
    decoder_1b: Convolution,
    decoder_0: Convolution,
}

/// A stop of the computation, because its result is no longer wanted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cancelled;

impl Network {
    /// Returns the network with weights from a file.
    ///
    /// # Errors
    /// If weights are missing or do not fit together.
    pub fn new(file: &WeightFile, set: InstructionSet) -> Result<Self, WeightError> {
        let plain =
            |name: &str, inputs: usize| Kernel::read(file, name, inputs).map(|kernel| Convolution::new(kernel, 0));
        let upsampling = |name: &str, coarse: usize, fine: usize| {
            Kernel::read(file, name, coarse + fine).map(|kernel| Convolution::new(kernel, coarse))
        };
        let encoder_0 = plain("enc_conv0", INPUT_CHANNELS)?;
        let encoder_1 = plain("enc_conv1", encoder_0.outputs())?;
        let encoder_2 = plain("enc_conv2", encoder_1.outputs())?;
        let encoder_3 = plain("enc_conv3", encoder_2.outputs())?;
        let encoder_4 = plain("enc_conv4", encoder_3.outputs())?;
        let bottom_a = plain("enc_conv5a", encoder_4.outputs())?;
        let bottom_b = plain("enc_conv5b", bottom_a.outputs())?;
        let decoder_4a = upsampling("dec_conv4a", bottom_b.outputs(), encoder_3.outputs())?;
        let decoder_4b = plain("dec_conv4b", decoder_4a.outputs())?;
        let decoder_3a = upsampling("dec_conv3a", decoder_4b.outputs(), encoder_2.outputs())?;
        let decoder_3b = plain("dec_conv3b", decoder_3a.outputs())?;
        let decoder_2a = upsampling("dec_conv2a", decoder_3b.outputs(), encoder_1.outputs())?;
        let decoder_2b = plain("dec_conv2b", decoder_2a.outputs())?;
        let decoder_1a = upsampling("dec_conv1a", decoder_2b.outputs(), INPUT_CHANNELS)?;
        let decoder_1b = plain("dec_conv1b", decoder_1a.outputs())?;
        let decoder_0 = plain("dec_conv0", decoder_1b.outputs())?;
        Ok(Network {
            set,
            encoder_0,
            encoder_1,
            encoders: [encoder_2, encoder_3, encoder_4],
            bottom: [bottom_a, bottom_b],
            decoders: [(decoder_4a, decoder_4b), (decoder_3a, decoder_3b), (decoder_2a, decoder_2b)],
            decoder_1a,
            decoder_1b,
            decoder_0,
        })
    }

    /// Computes three channels of each input pixel. Width and height are multiples of [`ALIGNMENT`].
    ///
    /// # Errors
    /// Once `is_cancelled` returns true.
    pub fn run(
        &self,
        input: &FeatureMap,
        is_cancelled: &(dyn Fn() -> bool + Sync),
    ) -> Result<Vec<[f32; 3]>, Cancelled> {
        let check = || if is_cancelled() { Err(Cancelled) } else { Ok(()) };
        // Encode
        let mut pools = vec![self.first_stage(input)];
        for encoder in &self.encoders {
            check()?;
            let pooled = self.pooled(encoder, &pools[pools.len() - 1]);
            pools.push(pooled);
        }
        // Convolve at a sixteenth of the size
        check()?;
        let Some(deepest) = pools.pop() else { return Err(Cancelled) };
        let mut features = self.plain(&self.bottom[1], &self.plain(&self.bottom[0], &deepest));
        drop(deepest);
        // Decode, each time with the features of the same size
        for (first, second) in &self.decoders {
            check()?;
            let Some(same_size) = pools.pop() else { return Err(Cancelled) };
            let upsampled = self.upsampled(first, &features, &same_size);
            check()?;
            features = self.plain(second, &upsampled);
        }
        check()?;
        let output = self.last_stage(&features, input, is_cancelled);
        check().map(|()| output)
    }

    /// Convolves a map.
    fn plain(&self, convolution: &Convolution, input: &FeatureMap) -> FeatureMap {
        let mut output = FeatureMap::new(input.shape.width, input.height, convolution.outputs());
        let shape = output.shape;
        let pairs = output.data_mut().par_chunks_mut(2 * shape.len()).enumerate();
        pairs.for_each_init(Scratch::default, |scratch, (pair, rows)| {
            let input = around(input.shape, 2 * pair as isize, |y| input.row(y));
            convolution.rows(self.set, true, &[input], Output::of(rows, shape), scratch);
        });
        output
    }

    /// Convolves a map and halves the result.
    fn pooled(&self, convolution: &Convolution, input: &FeatureMap) -> FeatureMap {
        let shape = RowShape::new(input.shape.width, convolution.outputs());
        let mut output = FeatureMap::new(input.shape.width / 2, input.height / 2, convolution.outputs());
        let half = output.shape;
        let buffers = || (shape.zeros(2), Scratch::default());
        let rows = output.data_mut().par_chunks_mut(half.len()).enumerate();
        rows.for_each_init(buffers, |(buffer, scratch), (y, pooled)| {
            let input = around(input.shape, 2 * y as isize, |y| input.row(y));
            convolution.rows(self.set, true, &[input], Output::of(buffer, shape), scratch);
            max_pool(shape, buffer, half, pooled);
        });
        output
    }

    /// Convolves a map of half the size, doubled, together with one of full size.
    fn upsampled(&self, convolution: &Convolution, coarse: &FeatureMap, fine: &FeatureMap) -> FeatureMap {
        let mut output = FeatureMap::new(fine.shape.width, fine.height, convolution.outputs());
        let shape = output.shape;
        let pairs = output.data_mut().par_chunks_mut(2 * shape.len()).enumerate();
        pairs.for_each_init(Scratch::default, |scratch, (pair, rows)| {
            let y = 2 * pair as isize;
            let inputs = [around_half(coarse.shape, y, |y| coarse.row(y)), around(fine.shape, y, |y| fine.row(y))];
            convolution.rows(self.set, true, &inputs, Output::of(rows, shape), scratch);
        });
        output
    }

    /// enc 0 and 1, halved.
    fn first_stage(&self, input: &FeatureMap) -> FeatureMap {
        let (width, height) = (input.shape.width, input.height);
        let first = RowShape::new(width, self.encoder_0.outputs());
        let second = RowShape::new(width, self.encoder_1.outputs());
        let mut output = FeatureMap::new(width / 2, height / 2, self.encoder_1.outputs());
        let half = output.shape;
        let bands = output.data_mut().par_chunks_mut(half.len() * BAND / 2).enumerate();
        bands.for_each_init(Scratch::default, |scratch, (band, pooled)| {
            let (mut ring, mut buffer) = (RowRing::new(first), second.zeros(2));
            let top = (band * BAND) as isize;
            let mut made = top - 2;
            for (pooled, y) in pooled.chunks_mut(half.len()).zip((top..).step_by(2)) {
                // Each pair of rows needs the rows from the one above to the one below
                for y in (made.max(0)..(y + 4).min(height as isize)).step_by(2) {
                    let rows = around(input.shape, y, |y| input.row(y));
                    self.encoder_0.rows(self.set, true, &[rows], ring.next(y), scratch);
                }
                made = y + 4;
                let rows = around(first, y, |y| ring.row(y));
                self.encoder_1.rows(self.set, true, &[rows], Output::of(&mut buffer, second), scratch);
                max_pool(second, &buffer, half, pooled);
            }
        });
        output
    }

    /// dec 1a, 1b and 0.
    fn last_stage(
        &self,
        features: &FeatureMap,
        input: &FeatureMap,
        is_cancelled: &(dyn Fn() -> bool + Sync),
    ) -> Vec<[f32; 3]> {
        let (width, height) = (input.shape.width, input.height as isize);
        let first = RowShape::new(width, self.decoder_1a.outputs());
        let second = RowShape::new(width, self.decoder_1b.outputs());
        let third = RowShape::new(width, self.decoder_0.outputs());
        let mut output = vec![[0.0; 3]; width * input.height];
        let bands = output.par_chunks_mut(width * BAND).enumerate();
        bands.for_each_init(Scratch::default, |scratch, (band, output)| {
            if is_cancelled() {
                return;
            }
            let (mut ring_1a, mut ring_1b) = (RowRing::new(first), RowRing::new(second));
            let mut last = third.zeros(2);
            let top = (band * BAND) as isize;
            let bottom = top + (output.len() / width.max(1)) as isize;
            // Each pair of rows of a convolution is made as soon as the rows around it are
            for step in (top - 4..bottom + 4).step_by(2) {
                let (y_1a, y_1b, y_0) = (step, step - 2, step - 4);
                if (0..height).contains(&y_1a) {
                    let coarse = around_half(features.shape, y_1a, |y| features.row(y));
                    let inputs = [coarse, around(input.shape, y_1a, |y| input.row(y))];
                    self.decoder_1a.rows(self.set, true, &inputs, ring_1a.next(y_1a), scratch);
                }
                if (0..height).contains(&y_1b) && y_1b >= top - 2 {
                    let rows = around(first, y_1b, |y| ring_1a.row(y));
                    self.decoder_1b.rows(self.set, true, &[rows], ring_1b.next(y_1b), scratch);
                }
                if y_0 >= top {
                    let rows = around(second, y_0, |y| ring_1b.row(y));
                    self.decoder_0.rows(self.set, false, &[rows], Output::of(&mut last, third), scratch);
                    let rows = output.chunks_mut(width).skip((y_0 - top).unsigned_abs());
                    for (pixels, row) in rows.zip(last.chunks(third.len())) {
                        for (pixel, value) in pixels.iter_mut().zip(third.pixels(row, 0)) {
                            *pixel = [value.0[0], value.0[1], value.0[2]];
                        }
                    }
                }
            }
        });
        output
    }
}

/// Stores the largest values of 2x2 pixels.
fn max_pool(shape: RowShape, rows: &[Block], half: RowShape, output: &mut [Block]) {
    let (upper, lower) = rows.split_at(shape.len());
    for block in 0..shape.blocks {
        let (upper, lower) =
            (shape.pixels(upper, block).as_chunks::<2>().0, shape.pixels(lower, block).as_chunks::<2>().0);
        for ((pixel, [a, b]), [c, d]) in half.pixels_mut(output, block).iter_mut().zip(upper).zip(lower) {
            *pixel = a.max(*b).max(c.max(*d));
        }
    }
}
