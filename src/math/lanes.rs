//! Vectors side by side, one a lane, for loops that the compiler turns into vector instructions ([`simd`](super::simd)).

use super::simd::LANES;
use glam::Vec3;

/// Vectors, component by component.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vec3Lanes {
    x: [f32; LANES],
    y: [f32; LANES],
    z: [f32; LANES],
}

impl Vec3Lanes {
    /// Zero in all lanes.
    pub const ZERO: Self = Vec3Lanes { x: [0.0; LANES], y: [0.0; LANES], z: [0.0; LANES] };

    /// Returns the vector of a lane.
    #[inline(always)]
    pub fn lane(&self, lane: usize) -> Vec3 {
        Vec3::new(self.x[lane], self.y[lane], self.z[lane])
    }

    /// Sets the vector of a lane.
    #[inline(always)]
    pub fn set_lane(&mut self, lane: usize, v: Vec3) {
        (self.x[lane], self.y[lane], self.z[lane]) = (v.x, v.y, v.z);
    }
}
