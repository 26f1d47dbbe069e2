//! The destination of radiance that a sample collects.

use glam::Vec3;

/// Receives the contributions of one sample.
pub trait RadianceSink {
    /// Adds white luminance (coloured, time-integrated luminance in shared layers) to a film layer.
    fn add(&mut self, layer: usize, value: Vec3);
}
