//! The sample pass for which photons are traced.

/// Maximum number of photons of a pass: some 120 MB while they are sorted.
pub const MAX_PHOTONS: u64 = 1 << 20;
/// Minimum number of photons of a render's pass.
pub const MIN_PHOTONS: u64 = 1 << 14;

/// The sample pass for which photons are traced.
#[derive(Clone, Copy, Debug)]
pub struct PhotonPass {
    /// Samples per pixel before the pass.
    pub first_sample: u32,
    /// Samples per pixel in the pass.
    pub samples: u32,
    /// Number of photons, rounded up to whole tasks.
    pub photons: u64,
    /// Seed of the render.
    pub seed: u32,
}

impl PhotonPass {
    /// Maximum samples per pixel of a pass: each has one photon.
    pub fn max_samples(pixels: u64) -> u32 {
        (MAX_PHOTONS / pixels.max(1)).clamp(1, 1 << 16) as u32
    }

    /// Factor of the gather radii, which shrink from pass to pass.
    pub fn shrink(&self) -> f32 {
        ((self.first_sample + 1) as f32).powf(-1.0 / 6.0)
    }
}
