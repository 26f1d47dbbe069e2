//! SIMD kernels: a ray against eight boxes, eight triangles or eight strand segments, two sets of Sobol points.
//!
//! [`Avx2`](avx2::Avx2) is written in intrinsics, [`Scalar`] in portable Rust. Neither fuses or reorders operations, so
//! both return the same bits; tests compare them. A [`KernelTask`] is compiled once for each, and [`dispatch`] runs
//! the version that the CPU supports ([`crate::math::simd`]).
//!
//! A new kernel needs a function in [`Kernels`] and its implementation in `avx2.rs` and `scalar.rs`.

#[cfg(target_arch = "x86_64")]
mod avx2;
mod box_packet;
mod kernels;
mod scalar;
mod segment_packet;
#[cfg(target_arch = "x86_64")]
mod sobol;
#[cfg(test)]
mod tests;
mod triangle_packet;

use crate::math;
pub use box_packet::{BoxPacket, SlabRay};
pub use kernels::{KernelTask, Kernels};
pub use math::simd::LANES;
pub use scalar::Scalar;
pub use segment_packet::{RibbonRay, SegmentHit, SegmentPacket};
pub use triangle_packet::{ShearedRay, TriangleHit, TrianglePacket};

/// Runs a task with the widest kernels that the CPU supports.
#[inline]
pub fn dispatch<T: KernelTask>(task: T) -> T::Output {
    math::simd::dispatch(WithKernels(task))
}

struct WithKernels<T>(T);

impl<T: KernelTask> math::simd::SimdTask for WithKernels<T> {
    type Output = T::Output;

    #[inline(always)]
    fn run(self, proof: Option<math::simd::Avx2>) -> T::Output {
        match proof {
            #[cfg(target_arch = "x86_64")]
            Some(_) => self.0.run::<avx2::Avx2>(),
            _ => self.0.run::<Scalar>(),
        }
    }
}
