//! The inner loop of the convolutions, in AVX-512, AVX2 with FMA, and portable Rust.
//!
//! A tile of the loop computes some pixels of some blocks of 16 output channels, all in registers: 14 pixels of two
//! blocks with AVX-512, 6 of one with AVX2. Each input value is multiplied by the weights of all output channels of the
//! tile.
//!
//! Every version adds the products of an output value in the same order. Those with fused multiply-add return the same
//! bits; the portable one rounds products, too.
#![expect(unsafe_code, reason = "intrinsics, and reads without bounds checks in the inner loop")]

use super::feature_map::{BLOCK, Block};
use super::filter::PackedFilter;
use glam::Vec4;
#[cfg(target_arch = "x86_64")]
use std::arch::x86_64::*;

/// A version of the loop.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum InstructionSet {
    /// 512-bit registers.
    Avx512,
    /// 256-bit registers, fused multiply-add.
    Avx2,
    /// Any CPU.
    Portable,
}

impl InstructionSet {
    /// Returns the versions that this CPU can run, the fastest first.
    pub fn supported() -> Vec<InstructionSet> {
        let all = [InstructionSet::Avx512, InstructionSet::Avx2, InstructionSet::Portable];
        all.into_iter().filter(|set| set.is_supported()).collect()
    }

    /// Returns the fastest version that this CPU can run.
    pub fn best() -> InstructionSet {
        Self::supported().first().copied().unwrap_or(InstructionSet::Portable)
    }

    fn is_supported(self) -> bool {
        match self {
            #[cfg(target_arch = "x86_64")]
            InstructionSet::Avx512 => std::arch::is_x86_feature_detected!("avx512f"),
            #[cfg(target_arch = "x86_64")]
            InstructionSet::Avx2 => {
                std::arch::is_x86_feature_detected!("avx2") && std::arch::is_x86_feature_detected!("fma")
            }
            InstructionSet::Portable => true,
            #[cfg(not(target_arch = "x86_64"))]
            _ => false,
        }
    }
}

/// One position of a filter on one block of input channels.
#[derive(Clone, Copy, Debug)]
pub struct Tap<'a> {
    /// The input of the first output pixel, and of those right of it.
    pub input: &'a [Block],
    /// Input channels of the block.
    pub channels: usize,
    /// Index of the tap's first weights in those of an output block.
    pub weights: usize,
}

/// A row of output pixels.
#[derive(Debug)]
pub struct RowTask<'a> {
    /// The weights.
    pub filter: &'a PackedFilter,
    /// Taps whose input advances one pixel for each output pixel.
    pub single: &'a [Tap<'a>],
    /// Taps whose input advances two pixels for each output pixel.
    pub double: &'a [Tap<'a>],
    /// Number of output pixels.
    pub count: usize,
    /// Negative values become zero.
    pub relu: bool,
    /// Output, from the first pixel of the first block on.
    pub output: &'a mut [Block],
    /// Distance between two output pixels.
    pub output_step: usize,
    /// Distance between two output blocks.
    pub output_stride: usize,
}

impl RowTask<'_> {
    /// Computes the row.
    ///
    /// # Panics
    /// If a tap has less input than output pixels and 28 more.
    pub fn run(&mut self, set: InstructionSet) {
        assert!(set.is_supported(), "{set:?} is not supported");
        match set {
            #[cfg(target_arch = "x86_64")]
            // SAFETY: the assertion has checked that the CPU supports it.
            InstructionSet::Avx512 => unsafe { run_avx512(self) },
            #[cfg(target_arch = "x86_64")]
            // SAFETY: the assertion has checked that the CPU supports it.
            InstructionSet::Avx2 => unsafe { run_avx2(self) },
            _ => run::<Portable, 1, 2>(self),
        }
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f")]
fn run_avx512(task: &mut RowTask<'_>) {
    run::<Avx512, 2, 14>(task);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn run_avx2(task: &mut RowTask<'_>) {
    run::<Avx2, 1, 6>(task);
}

/// 16 values in registers. `inline(always)`, so that they are compiled for the instruction set of their caller.
trait Vector: Copy {
    fn load(values: &Block) -> Self;
    fn store(self, values: &mut Block);
    /// Returns `self + weights * input`.
    fn add_product(self, weights: Self, input: f32) -> Self;
    /// Returns 0 for negative values.
    fn relu(self) -> Self;
}

/// Computes tiles of `B` output blocks and `P` pixels, and of one block for the rest.
#[inline(always)]
fn run<V: Vector, const B: usize, const P: usize>(task: &mut RowTask<'_>) {
    let blocks = task.filter.output_blocks();
    let wide = blocks / B * B;
    for block in (0..wide).step_by(B) {
        tiles::<V, B, P>(task, block);
    }
    for block in wide..blocks {
        tiles::<V, 1, P>(task, block);
    }
}

/// Repeats a body for each index below a constant limit of at most 14, as a loop would. The compiler does not unroll a
/// loop as long as this, and without that keeps the sums in memory.
macro_rules! unrolled {
    ($index:ident < $limit:expr, $body:block) => {
        unrolled!($index < $limit, $body, 0 1 2 3 4 5 6 7 8 9 10 11 12 13)
    };
    ($index:ident < $limit:expr, $body:block, $($value:literal)*) => {
        $(if $value < $limit {
            const $index: usize = $value;
            $body
        })*
    };
}

#[inline(always)]
fn tiles<V: Vector, const B: usize, const P: usize>(task: &mut RowTask<'_>, block: usize) {
    let weights: [&[Block]; B] = std::array::from_fn(|b| task.filter.weights(block + b));
    for first in (0..task.count).step_by(P) {
        let mut sums: [[V; P]; B] = std::array::from_fn(|b| [V::load(task.filter.bias(block + b)); P]);
        for tap in task.single {
            add_tap::<V, B, P, 1>(&mut sums, tap, first, &weights);
        }
        for tap in task.double {
            add_tap::<V, B, P, 2>(&mut sums, tap, 2 * first, &weights);
        }
        for (b, sums) in sums.iter().enumerate() {
            let output = &mut task.output[(block + b) * task.output_stride..];
            unrolled!(PIXEL < P, {
                if first + PIXEL < task.count {
                    let value = if task.relu { sums[PIXEL].relu() } else { sums[PIXEL] };
                    value.store(&mut output[(first + PIXEL) * task.output_step]);
                }
            });
        }
    }
}

/// Adds the products of a tap. The input advances `STEP` pixels for each output pixel.
#[inline(always)]
fn add_tap<V: Vector, const B: usize, const P: usize, const STEP: usize>(
    sums: &mut [[V; P]; B],
    tap: &Tap<'_>,
    first: usize,
    weights: &[&[Block]; B],
) {
    let input = &tap.input[first..first + (P - 1) * STEP + 1];
    let channels = tap.channels.min(BLOCK);
    let weights: [&[Block]; B] = std::array::from_fn(|b| &weights[b][tap.weights..tap.weights + channels]);
    for channel in 0..channels {
        // SAFETY: `weights` has `channels` entries.
        let row: [V; B] = std::array::from_fn(|b| V::load(unsafe { weights[b].get_unchecked(channel) }));
        unrolled!(PIXEL < P, {
            // SAFETY: `input` has (P - 1) * STEP + 1 pixels of BLOCK channels.
            let value = unsafe { *input.get_unchecked(PIXEL * STEP).0.get_unchecked(channel) };
            for b in 0..B {
                sums[b][PIXEL] = sums[b][PIXEL].add_product(row[b], value);
            }
        });
    }
}

/// Four registers of four numbers, which any x86-64 CPU (SSE2) and 64-bit ARM (NEON) have.
#[derive(Clone, Copy)]
struct Portable([Vec4; 4]);

impl Vector for Portable {
    #[inline(always)]
    fn load(values: &Block) -> Self {
        let [a, b, c, d] = [0, 4, 8, 12].map(|first| Vec4::from_slice(&values.0[first..first + 4]));
        Portable([a, b, c, d])
    }

    #[inline(always)]
    fn store(self, values: &mut Block) {
        for (quarter, values) in self.0.iter().zip(values.0.chunks_exact_mut(4)) {
            quarter.write_to_slice(values);
        }
    }

    #[inline(always)]
    fn add_product(self, weights: Self, input: f32) -> Self {
        let input = Vec4::splat(input);
        let [a, b, c, d] = self.0;
        let [wa, wb, wc, wd] = weights.0;
        Portable([a + wa * input, b + wb * input, c + wc * input, d + wd * input])
    }

    #[inline(always)]
    fn relu(self) -> Self {
        Portable(self.0.map(|quarter| quarter.max(Vec4::ZERO)))
    }
}

/// One register of AVX-512.
#[cfg(target_arch = "x86_64")]
#[derive(Clone, Copy)]
struct Avx512(__m512);

#[cfg(target_arch = "x86_64")]
impl Vector for Avx512 {
    #[inline(always)]
    fn load(values: &Block) -> Self {
        // SAFETY: 16 floats are read from an array of 16; only code compiled for AVX-512 uses this type.
        Avx512(unsafe { _mm512_loadu_ps(values.0.as_ptr()) })
    }

    #[inline(always)]
    fn store(self, values: &mut Block) {
        // SAFETY: 16 floats are written to an array of 16; only code compiled for AVX-512 uses this type.
        unsafe { _mm512_storeu_ps(values.0.as_mut_ptr(), self.0) };
    }

    #[inline(always)]
    fn add_product(self, weights: Self, input: f32) -> Self {
        // SAFETY: only code compiled for AVX-512 uses this type.
        Avx512(unsafe { _mm512_fmadd_ps(weights.0, _mm512_set1_ps(input), self.0) })
    }

    #[inline(always)]
    fn relu(self) -> Self {
        // SAFETY: only code compiled for AVX-512 uses this type.
        Avx512(unsafe { _mm512_max_ps(self.0, _mm512_setzero_ps()) })
    }
}

/// Two registers of AVX2.
#[cfg(target_arch = "x86_64")]
#[derive(Clone, Copy)]
struct Avx2([__m256; 2]);

#[cfg(target_arch = "x86_64")]
impl Vector for Avx2 {
    #[inline(always)]
    fn load(values: &Block) -> Self {
        let (low, high) = values.0.split_at(8);
        // SAFETY: eight floats are read from each half of 16; only code compiled for AVX2 uses this type.
        Avx2(unsafe { [_mm256_loadu_ps(low.as_ptr()), _mm256_loadu_ps(high.as_ptr())] })
    }

    #[inline(always)]
    fn store(self, values: &mut Block) {
        let (low, high) = values.0.split_at_mut(8);
        // SAFETY: eight floats are written to each half of 16; only code compiled for AVX2 uses this type.
        unsafe {
            _mm256_storeu_ps(low.as_mut_ptr(), self.0[0]);
            _mm256_storeu_ps(high.as_mut_ptr(), self.0[1]);
        }
    }

    #[inline(always)]
    fn add_product(self, weights: Self, input: f32) -> Self {
        // SAFETY: only code compiled for AVX2 and FMA uses this type.
        Avx2(unsafe {
            let input = _mm256_set1_ps(input);
            [_mm256_fmadd_ps(weights.0[0], input, self.0[0]), _mm256_fmadd_ps(weights.0[1], input, self.0[1])]
        })
    }

    #[inline(always)]
    fn relu(self) -> Self {
        // SAFETY: only code compiled for AVX2 uses this type.
        unsafe {
            let zero = _mm256_setzero_ps();
            Avx2([_mm256_max_ps(self.0[0], zero), _mm256_max_ps(self.0[1], zero)])
        }
    }
}
