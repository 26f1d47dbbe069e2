//! A direction sampled from a BSDF.

use super::polarisation::Polarisation;
use glam::Vec3;

/// A direction sampled from a BSDF.
#[derive(Clone, Copy, Debug)]
pub struct BsdfSample {
    /// Unit direction, world space.
    pub direction: Vec3,
    /// BSDF times cosine over pdf.
    pub weight: Vec3,
    /// Solid angle density, 1/sr; undefined for `specular` samples.
    pub pdf: f32,
    /// True for samples of a delta lobe, which no other technique can find.
    pub specular: bool,
    /// Factor on radiance by the squared relative index of refraction of the interface. Russian roulette leaves it out.
    pub eta_scale: f32,
    /// Polarisation that the path accepts from here on.
    pub polarisation: Polarisation,
    /// True if the path passes a face of a body or a clear thin pane. False for diffuse light to the far side of a
    /// translucent sheet, and for frosted panes.
    pub is_transmission: bool,
    /// True for transmission by a thin pane, which does not change the direction: other techniques find the light
    /// behind it as if there were no pane.
    pub is_undeviated: bool,
}

impl BsdfSample {
    /// Returns a sample of a lobe that is not a delta function.
    pub fn non_specular(direction: Vec3, weight: Vec3, pdf: f32) -> Self {
        BsdfSample { weight, pdf, specular: false, ..BsdfSample::specular(direction) }
    }

    /// Returns a sample of a delta lobe, of weight 1.
    pub fn specular(direction: Vec3) -> Self {
        BsdfSample {
            direction,
            weight: Vec3::ONE,
            pdf: 0.0,
            specular: true,
            eta_scale: 1.0,
            polarisation: Polarisation::NONE,
            is_transmission: false,
            is_undeviated: false,
        }
    }
}
