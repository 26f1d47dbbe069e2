//! Eight axis-aligned boxes as a structure of arrays, and a ray prepared for the slab test against them.

use crate::math::gamma;
use crate::math::simd::LANES;
use glam::Vec3;

/// Factor on exit distances: covers the rounding of both products, so that the slab test misses no box (Ize 2013,
/// "Robust BVH Ray Traversal").
pub const SLAB_EXIT_SCALE: f32 = 1.0 + 2.0 * gamma(3);

/// Eight axis-aligned boxes. Unused lanes hold an inverted box, which no ray hits.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub struct BoxPacket {
    /// `corners[0]` lower and `corners[1]` upper corners, by axis and lane.
    corners: [[[f32; LANES]; 3]; 2],
}

impl BoxPacket {
    /// A packet without boxes.
    pub const EMPTY: BoxPacket = BoxPacket { corners: [[[f32::INFINITY; LANES]; 3], [[f32::NEG_INFINITY; LANES]; 3]] };

    /// Stores a box in a lane.
    pub fn set(&mut self, lane: usize, low: Vec3, high: Vec3) {
        for axis in 0..3 {
            self.corners[0][axis][lane] = low[axis];
            self.corners[1][axis][lane] = high[axis];
        }
    }

    /// Returns the near and far planes of all boxes along an axis.
    #[inline(always)]
    pub fn slabs(&self, ray: &SlabRay, axis: usize) -> (&[f32; LANES], &[f32; LANES]) {
        let near = ray.near[axis] & 1;
        (&self.corners[near][axis], &self.corners[near ^ 1][axis])
    }
}

/// A ray prepared for the slab test: origin, inverse direction, and the near corner of each axis.
///
/// A direction component of zero gives an infinite inverse. The kernels drop the NaN of `0 * inf`, so that a ray along
/// the face of a box is tested by the other axes alone.
#[derive(Clone, Copy, Debug)]
pub struct SlabRay {
    pub(super) origin: [f32; 3],
    /// Reciprocal of the direction, negated: kernels subtract the planes from the origin.
    pub(super) minus_inverse: [f32; 3],
    /// 0 where the lower corner is near, 1 where the upper one is.
    near: [usize; 3],
}

impl SlabRay {
    /// Prepares a ray.
    #[inline(always)]
    pub fn new(origin: Vec3, direction: Vec3) -> Self {
        let inverse = direction.recip();
        let near = inverse.to_array().map(|x| usize::from(x.is_sign_negative()));
        SlabRay { origin: origin.to_array(), minus_inverse: (-inverse).to_array(), near }
    }
}
