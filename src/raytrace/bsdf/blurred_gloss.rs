//! A coat that is rougher than its material says, and reflects as much: for path regularisation.

use super::albedo::{AlbedoTable, AlbedoTables};

/// The rougher coat, with its directional albedo.
#[derive(Debug)]
pub struct BlurredGloss {
    /// GGX roughness.
    pub alpha: f32,
    ior: f32,
    albedo: AlbedoTable,
}

impl BlurredGloss {
    /// Tabulates the coat of an index of refraction for the user's roughness.
    pub fn new(ior: f32, roughness: f32) -> Self {
        let alpha = roughness * roughness;
        BlurredGloss { alpha, ior, albedo: AlbedoTables::new(ior, alpha).coat }
    }

    /// Returns the index of refraction.
    pub fn ior(&self) -> f32 {
        self.ior
    }

    /// Returns the factor with which it reflects as much as a coat of this directional albedo at this cosine.
    pub fn factor(&self, albedo: f32, cos: f32) -> f32 {
        albedo / self.albedo.at(cos).max(1e-6)
    }
}
