//! Points of flat emitters that are sampled uniformly by area.

use glam::Vec3;

/// Returns the density of the direction of the vector `to` a point that is sampled uniformly by area, 1/sr. Infinite or
/// no number where the emitter is seen edge-on.
#[inline(always)]
pub fn area_pdf(to: Vec3, normal: Vec3, area: f32) -> f32 {
    let distance2 = to.length_squared();
    // The cosine is the height over the distance
    distance2 * distance2.sqrt() / (to.dot(normal).abs() * area)
}
