//! The traversal compiled twice: once for every processor, once for those with 256-bit vectors.
//!
//! The loops over eight boxes and four triangles are plain Rust that the compiler vectorises. Inlined into a function
//! with AVX2 enabled they use twice the width. Nothing else changes: no operation is fused or reordered, so both give
//! the same bits, and the plain one is the twin that tests compare with.
#![expect(unsafe_code, reason = "calling code made for AVX2 is unsafe; the check stands before the call")]

/// Runs `work`, compiled for AVX2 where the processor has it. `work` and all it calls must be `#[inline(always)]` to
/// profit.
#[inline]
pub fn widest<R>(work: impl FnOnce() -> R) -> R {
    #[cfg(target_arch = "x86_64")]
    if std::arch::is_x86_feature_detected!("avx2") {
        // SAFETY: the processor has AVX2; it was asked on the line above.
        return unsafe { with_avx2(work) };
    }
    work()
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn with_avx2<R>(work: impl FnOnce() -> R) -> R {
    work()
}
