//! The request for a meter reading.

use crate::photo::meter::Receptor;
use glam::Vec3;

/// Position, direction and kind of the receptor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeterPoint {
    /// World position, metres.
    pub position: Vec3,
    /// Unit direction that the receptor faces.
    pub facing: Vec3,
    /// Flat or dome.
    pub receptor: Receptor,
}

/// Accuracy and budget of a reading; with the scene and the point they determine the result.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeterEffort {
    /// Number of paths, rounded up to a multiple of 16; none samples until the error is small.
    pub paths: Option<u32>,
    /// Relative standard error of each light at which sampling stops. For lights under 1 % of the total it is relative
    /// to 1 % of the total.
    pub tolerance: f32,
    /// Number of rays after which no further round begins; a round at most doubles it.
    pub rays: u64,
    /// Seed of the random numbers.
    pub seed: u32,
}

impl Default for MeterEffort {
    /// A standard error of 0.15 % where that is possible within a few seconds.
    fn default() -> Self {
        MeterEffort { paths: None, tolerance: 0.0015, rays: 1_500_000, seed: 0 }
    }
}

impl MeterEffort {
    /// Effort for a readout that follows the mouse.
    pub fn quick() -> Self {
        MeterEffort { tolerance: 0.01, rays: 100_000, ..MeterEffort::default() }
    }
}
