//! Registers of 16 values in AVX-512, AVX2 with FMA, and portable Rust.
//!
//! A [`Task`] is compiled for each. A register tile of it, which an inner loop keeps in registers, is as large as these
//! allow: two blocks of 16 channels times 14 positions with AVX-512, one times six with AVX2.
//!
//! No version reorders operations. Those with fused multiply-add return the same bits; the portable one rounds products,
//! too.
#![expect(unsafe_code, reason = "intrinsics")]

use super::feature_map::Block;
use glam::Vec4;
#[cfg(target_arch = "x86_64")]
use std::arch::x86_64::*;

/// A set of registers and instructions for which tasks are compiled.
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
    /// Returns the sets that this CPU supports, the fastest first.
    pub fn supported() -> Vec<InstructionSet> {
        let all = [InstructionSet::Avx512, InstructionSet::Avx2, InstructionSet::Portable];
        all.into_iter().filter(|set| set.is_supported()).collect()
    }

    /// Returns the fastest set that this CPU supports.
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

/// A computation that is compiled for each instruction set. What it calls must be `#[inline(always)]`.
pub trait Task {
    /// Runs the computation with register tiles of `B` blocks of 16 values times `P` positions.
    fn run<V: Vector, const B: usize, const P: usize>(self);
}

/// Runs a task.
///
/// # Panics
/// If the CPU does not support the instruction set.
pub fn run(set: InstructionSet, task: impl Task) {
    assert!(set.is_supported(), "{set:?} is not supported");
    match set {
        #[cfg(target_arch = "x86_64")]
        // SAFETY: the assertion has checked that the CPU supports it.
        InstructionSet::Avx512 => unsafe { run_avx512(task) },
        #[cfg(target_arch = "x86_64")]
        // SAFETY: the assertion has checked that the CPU supports it.
        InstructionSet::Avx2 => unsafe { run_avx2(task) },
        _ => task.run::<Portable, 1, 2>(),
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f")]
fn run_avx512(task: impl Task) {
    task.run::<Avx512, 2, 14>();
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn run_avx2(task: impl Task) {
    task.run::<Avx2, 1, 6>();
}

/// 16 values in registers. `inline(always)`, so that they are compiled for the instruction set of their caller.
pub trait Vector: Copy {
    /// Zero in every value.
    const ZERO: Self;
    /// Returns the values of a block.
    fn load(values: &Block) -> Self;
    /// Stores the values.
    fn store(self, values: &mut Block);
    /// Returns `self + other`.
    fn add(self, other: Self) -> Self;
    /// Returns `self - other`.
    fn subtract(self, other: Self) -> Self;
    /// Returns `self + weights * input`.
    fn add_product(self, weights: Self, input: f32) -> Self;
    /// Returns 0 for negative values.
    fn relu(self) -> Self;
}

/// Repeats a body for each index below a constant limit of at most 16, as a loop would. The compiler does not unroll a
/// loop as long as this, and without that keeps the sums in memory.
macro_rules! unrolled {
    ($index:ident < $limit:expr, $body:block) => {
        unrolled!($index < $limit, $body, 0 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15)
    };
    ($index:ident < $limit:expr, $body:block, $($value:literal)*) => {
        $(if $value < $limit {
            const $index: usize = $value;
            $body
        })*
    };
}
pub(super) use unrolled;

/// Four registers of four numbers, which any x86-64 CPU (SSE2) and 64-bit ARM (NEON) have.
#[derive(Clone, Copy)]
struct Portable([Vec4; 4]);

impl Vector for Portable {
    const ZERO: Self = Portable([Vec4::ZERO; 4]);

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
    fn add(self, other: Self) -> Self {
        Portable(std::array::from_fn(|i| self.0[i] + other.0[i]))
    }

    #[inline(always)]
    fn subtract(self, other: Self) -> Self {
        Portable(std::array::from_fn(|i| self.0[i] - other.0[i]))
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
    // SAFETY: all bits of a register may be zero.
    const ZERO: Self = Avx512(unsafe { std::mem::zeroed() });

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
    fn add(self, other: Self) -> Self {
        // SAFETY: only code compiled for AVX-512 uses this type.
        Avx512(unsafe { _mm512_add_ps(self.0, other.0) })
    }

    #[inline(always)]
    fn subtract(self, other: Self) -> Self {
        // SAFETY: only code compiled for AVX-512 uses this type.
        Avx512(unsafe { _mm512_sub_ps(self.0, other.0) })
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
    // SAFETY: all bits of a register may be zero.
    const ZERO: Self = Avx2(unsafe { std::mem::zeroed() });

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
    fn add(self, other: Self) -> Self {
        // SAFETY: only code compiled for AVX2 and FMA uses this type.
        Avx2(unsafe { [_mm256_add_ps(self.0[0], other.0[0]), _mm256_add_ps(self.0[1], other.0[1])] })
    }

    #[inline(always)]
    fn subtract(self, other: Self) -> Self {
        // SAFETY: only code compiled for AVX2 and FMA uses this type.
        Avx2(unsafe { [_mm256_sub_ps(self.0[0], other.0[0]), _mm256_sub_ps(self.0[1], other.0[1])] })
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
