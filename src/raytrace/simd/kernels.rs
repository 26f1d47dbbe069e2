//! The interface of the SIMD kernels, which is implemented once for each instruction set.

use super::box_packet::{BoxPacket, SlabRay};
use super::segment_packet::{RibbonRay, SegmentHit, SegmentPacket};
use super::triangle_packet::{ShearedRay, TriangleHit, TrianglePacket};
use crate::math::simd::LANES;

/// The kernels of an instruction set.
pub trait Kernels {
    /// Intersects a ray with eight boxes by the slab method (Kay and Kajiya 1986). Writes the entry distances and
    /// returns a bit for each box that is entered before `t_max`.
    fn intersect_boxes(ray: &SlabRay, boxes: &BoxPacket, t_max: f32, enter: &mut [f32; LANES]) -> u32;

    /// Returns the nearest hit with 0 < t < `t_max` of a ray with eight triangles. Degenerate triangles are never hit.
    fn intersect_triangles(ray: &ShearedRay, triangles: &TrianglePacket, t_max: f32) -> Option<TriangleHit>;

    /// Returns the nearest hit with 0 < t < `t_max` of a ray with eight strand segments.
    fn intersect_segments(ray: &RibbonRay, segments: &SegmentPacket, t_max: f32) -> Option<SegmentHit>;

    /// Returns the first four dimensions of two Owen-scrambled Sobol points, each of an index under 2^16 and a seed.
    fn sobol_4d(indices: [u32; 2], seeds: [u32; 2]) -> [[f32; 4]; 2];
}

/// A computation that is compiled once for each set of kernels. `run` and every function it calls must be
/// `#[inline(always)]`.
pub trait KernelTask {
    /// The result of the computation.
    type Output;

    /// Runs the computation with the given kernels.
    fn run<K: Kernels>(self) -> Self::Output;
}
