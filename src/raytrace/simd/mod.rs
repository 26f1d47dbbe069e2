//! The inner kernels for the processor at hand: a ray against eight boxes, a ray against eight triangles, two sets of
//! random numbers.
//!
//! [`Avx2`](avx2::Avx2) is written in intrinsics, [`Scalar`] in portable Rust. Nothing is fused or reordered in either,
//! so both give the same bits, and tests compare them. A [`KernelTask`] is compiled once for each; [`dispatch`] takes
//! the one that the processor can run, by [`crate::math::simd`].

#[cfg(target_arch = "x86_64")]
mod avx2;
mod scalar;
#[cfg(target_arch = "x86_64")]
mod sobol;

use super::bvh::{Node, Slabs};
use super::triangle::{Packet, ShearedRay, TriangleHit};
use crate::math::{self, simd::SimdTask};
pub use scalar::Scalar;

/// Boxes in a node and triangles in a packet.
pub const WIDTH: usize = 8;

/// What a set of vector instructions must be able to do.
pub trait Kernels {
    /// Entry distances into a node's boxes, and a bit for each box that is entered before `t_max`.
    fn boxes(slabs: &Slabs, node: &Node, t_max: f32, enter: &mut [f32; WIDTH]) -> u32;

    /// The nearest triangle hit with 0 < t < `t_max`. Triangles of no area are never hit.
    fn triangles(packet: &Packet, ray: &ShearedRay, t_max: f32) -> Option<TriangleHit>;

    /// The first four dimensions of the Owen-scrambled Sobol point `index` (under 2^16), for each of two seeds.
    fn sobol(index: u32, seeds: [u32; 2]) -> [[f32; 4]; 2];
}

/// SimdTask that is compiled once for each set of instructions. `run` and all it calls must be `#[inline(always)]`.
pub trait KernelTask {
    /// What comes out.
    type Output;

    /// Does the work with the given kernels.
    fn run<K: Kernels>(self) -> Self::Output;
}

/// Runs a query with the dispatch instructions that the processor has.
#[inline]
pub fn dispatch<Q: KernelTask>(query: Q) -> Q::Output {
    math::simd::dispatch(WithKernels(query))
}

struct WithKernels<Q>(Q);

impl<Q: KernelTask> SimdTask for WithKernels<Q> {
    type Output = Q::Output;

    #[inline(always)]
    fn run(self, proof: Option<math::simd::Avx2>) -> Q::Output {
        match proof {
            #[cfg(target_arch = "x86_64")]
            Some(_) => self.0.run::<avx2::Avx2>(),
            _ => self.0.run::<Scalar>(),
        }
    }
}
