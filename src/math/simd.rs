//! Runtime dispatch of loops that are compiled twice: for the baseline CPU, and for CPUs with AVX2.
//!
//! The compiler turns branch-free loops over arrays into vector instructions: four f32 at a time on any x86-64, eight
//! with AVX2. [`dispatch`] checks which of the two the CPU supports. Neither version fuses or reorders operations, so
//! both return the same bits.

use std::sync::atomic::{AtomicU8, Ordering};

/// Elements that loops process together: the f32 lanes of one AVX2 register.
pub const LANES: usize = 8;

/// Proof that the CPU supports AVX2. Only [`dispatch`] creates it.
#[derive(Clone, Copy, Debug)]
pub struct Avx2(());

/// A loop that is compiled for each instruction set. `run` and every function it calls must be `#[inline(always)]` or a
/// closure defined in it: other functions are compiled for the baseline CPU only.
pub trait SimdTask {
    /// The result of the loop.
    type Output;

    /// Runs the loop. Code in AVX2 intrinsics requires the proof; loops ignore it.
    fn run(self, avx2: Option<Avx2>) -> Self::Output;
}

/// What [`dispatch`] may use: unknown at first.
static WIDTH: AtomicU8 = AtomicU8::new(UNKNOWN);
const UNKNOWN: u8 = 0;
const PORTABLE: u8 = 1;
const WITH_AVX2: u8 = 2;

/// Returns true if the CPU supports AVX2.
pub fn has_avx2() -> bool {
    #[cfg(target_arch = "x86_64")]
    let has_avx2 = std::arch::is_x86_feature_detected!("avx2");
    #[cfg(not(target_arch = "x86_64"))]
    let has_avx2 = false;
    has_avx2
}

/// Runs a function during which all threads use the portable code, to measure it.
pub fn without_avx2<T>(run: impl FnOnce() -> T) -> T {
    WIDTH.store(PORTABLE, Ordering::Relaxed);
    let result = run();
    WIDTH.store(UNKNOWN, Ordering::Relaxed);
    result
}

/// Returns true if AVX2 is to be used: once detected, a read of one byte.
#[inline]
fn uses_avx2() -> bool {
    match WIDTH.load(Ordering::Relaxed) {
        UNKNOWN => {
            let width = if has_avx2() { WITH_AVX2 } else { PORTABLE };
            WIDTH.store(width, Ordering::Relaxed);
            width == WITH_AVX2
        }
        width => width == WITH_AVX2,
    }
}

/// Runs a task with the widest registers that the CPU supports.
#[inline]
pub fn dispatch<T: SimdTask>(task: T) -> T::Output {
    #[cfg(target_arch = "x86_64")]
    if uses_avx2() {
        #[expect(
            unsafe_code,
            reason = "a call into code compiled for AVX2, after the check that the CPU supports it"
        )]
        // SAFETY: `uses_avx2` has detected AVX2.
        return unsafe { compiled_for_avx2(task) };
    }
    task.run(None)
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn compiled_for_avx2<T: SimdTask>(task: T) -> T::Output {
    task.run(Some(Avx2(())))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Sums, quotients, roots and products that a fused multiply-add would round differently.
    struct Lengths<'a>(&'a [[f32; 64]; 3]);

    impl SimdTask for Lengths<'_> {
        type Output = [f32; 64];

        #[inline(always)]
        fn run(self, _: Option<Avx2>) -> [f32; 64] {
            let [x, y, z] = self.0;
            std::array::from_fn(|i| (x[i] * x[i] + y[i] * y[i] + z[i] * z[i]).sqrt() / (1.0 + x[i] * y[i]))
        }
    }

    #[test]
    fn avx2_and_baseline_code_return_the_same_bits() {
        let numbers = [0.1_f32, 0.7, -0.3].map(|a| std::array::from_fn(|i| (a * i as f32).sin()));
        assert_eq!(dispatch(Lengths(&numbers)), Lengths(&numbers).run(None));
    }
}
